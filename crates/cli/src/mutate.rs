//! `standstill test --mutate`: the small changes of a script's program that no claim detects.

use crate::cores;
use crate::exit::{Exit, Failure, go_on};
use crate::json::{Object, list, string};
use crate::limit;
use crate::outcome;
use crate::progress::Progress;
use standstill_script::Outcome;
use standstill_script::model::Script;
use standstill_script::mutate::{Fate, Mutant, mutants};
use standstill_script::suite::{self, Allowed};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Largest number of mutants of one script that are tried.
const MUTANTS_MOST: usize = 500;

/// The results of a script's mutants.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    killed: usize,
    survived: usize,
    /// The run was not different, or was not possible.
    left: usize,
}

/// Tries the mutants of every script at the paths. A score is no verdict: only scripts that fail by
/// themselves fail.
pub fn mutate(
    scripts: &[PathBuf],
    seed: u64,
    allowed: &Allowed,
    json: bool,
    out: &mut dyn Write,
) -> Result<Exit, Failure> {
    let (mut exit, mut told, mut total) = (Exit::Passed, Vec::new(), Score::default());
    for script in scripts {
        let one = one(
            script,
            seed,
            allowed,
            &mut told,
            &mut total,
            (!json).then_some(&mut *out),
        );
        if let Err(Failure::Told(_, text)) = &one {
            told.push(outcome::broken(&suite::shown(script), text));
        }
        exit = exit.max(go_on(one, out)?);
    }
    if json {
        writeln!(out, "{}", outcome::whole("test", exit, &[], &told))?;
    } else if scripts.len() > 1 {
        writeln!(out, "\n{} scripts: {}", scripts.len(), total.text())?;
    }
    Ok(exit)
}

fn one(
    path: &Path,
    seed: u64,
    allowed: &Allowed,
    told: &mut Vec<Object>,
    total: &mut Score,
    out: Option<&mut dyn Write>,
) -> Result<Exit, Failure> {
    let name = suite::shown(path);
    limit::doing(format!("{name}: mutants"));
    let (script, original) = suite::run_script(path, &[], allowed, |_| {})?;
    if !original.passed() {
        if let Some(out) = out {
            writeln!(out, "FAILED    {name}\n    its claims fail without a change")?;
        }
        told.push(outcome::broken(&name, "its claims fail without a change"));
        return Ok(Exit::Failed);
    }
    let all = mutants(&script, seed, MUTANTS_MOST);
    let fates = judged(&name, &script, &original, &all)?;
    let mut score = Score::default();
    for fate in &fates {
        match fate {
            Fate::Killed(_) => score.killed += 1,
            Fate::Survived => score.survived += 1,
            Fate::Same | Fate::Impossible => score.left += 1,
        }
    }
    if let Some(out) = out {
        for (mutant, fate) in all.iter().zip(&fates) {
            let (path, says) = (&mutant.path, &mutant.says);
            match fate {
                Fate::Killed(claim) => writeln!(out, "killed    {path}: {says} ({claim})")?,
                Fate::Survived => writeln!(out, "survived  {path}: {says}")?,
                Fate::Same | Fate::Impossible => {}
            }
        }
        writeln!(out, "{name}: {}", score.text())?;
    }
    told.push(as_json(&name, &all, &fates, score));
    total.killed += score.killed;
    total.survived += score.survived;
    total.left += score.left;
    Ok(Exit::Passed)
}

/// The fate of every mutant, in their order; on all processors.
fn judged(name: &str, script: &Script, original: &Outcome, all: &[Mutant]) -> Result<Vec<Fate>, Failure> {
    let mut fates = Vec::with_capacity(all.len());
    let mut progress = Progress::new(true);
    let judge = |index: usize| all[index].judge(script, original);
    let take = |index, fate| {
        progress.show(|| format!("{name}: {index} of {} mutants", all.len()));
        fates.extend(fate);
        Ok(())
    };
    cores::in_order(all.len(), cores::processors(), judge, take)?;
    Ok(fates)
}

impl Score {
    /// `18 of 20 killed (90.0 %), 4 change nothing`
    fn text(self) -> String {
        let Self {
            killed,
            survived,
            left,
        } = self;
        let counted = killed + survived;
        let share = match counted {
            0 => String::new(),
            counted => format!(" ({:.1} %)", 100.0 * killed as f64 / counted as f64),
        };
        let change = if left == 1 { "changes" } else { "change" };
        format!("{killed} of {counted} mutants killed{share}, {left} {change} nothing")
    }
}

fn as_json(name: &str, all: &[Mutant], fates: &[Fate], score: Score) -> Object {
    let counted = all.iter().zip(fates).filter_map(|(mutant, fate)| {
        let object = Object::new()
            .with("path", string(&mutant.path))
            .with("change", string(&mutant.says));
        match fate {
            Fate::Killed(claim) => Some(
                object
                    .with("verdict", string("killed"))
                    .with("claim", string(claim)),
            ),
            Fate::Survived => Some(object.with("verdict", string("survived"))),
            Fate::Same | Fate::Impossible => None,
        }
    });
    outcome::named(name, "passed")
        .with("killed", score.killed.to_string())
        .with("survived", score.survived.to_string())
        .with("mutants", list(counted.map(Object::text)))
}
