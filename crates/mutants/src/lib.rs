//! Finds changes that the tests do not detect. It changes the sources of the axis, the blocks and their
//! core a little, one change at a time, and runs the scan scripts and then the Rust tests to see whether
//! one fails.
//!
//! All sampled changes are in one build, in a copy below `target/mutants`; an environment variable
//! chooses one.

mod copy;
mod judge;
mod points;

use clap::Parser;
use copy::Copy;
use judge::{Trial, Verdict, judge};
use points::Point;
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Changes that no test can see, each with the reason.
const EQUIVALENTS: &str = "crates/mutants/equivalents.txt";

#[derive(Parser)]
#[command(about = "Changes the code a little and asks whether a test sees it")]
struct Args {
    /// The seed of the sample
    #[arg(long, default_value_t = 15)]
    seed: u64,
    /// The number of changes in the sample
    #[arg(long, default_value_t = 400)]
    count: usize,
    /// Judge only these, by their numbers in the last report
    #[arg(long, value_delimiter = ',')]
    only: Vec<usize>,
    /// Instead of a sample, judge all changes whose line in a report contains one of these
    #[arg(long)]
    of: Vec<String>,
    /// Judge by scripts only
    #[arg(long)]
    scripts: bool,
    /// Judge nothing; print all possible changes
    #[arg(long)]
    list: bool,
}

/// Runs the command line.
///
/// # Errors
/// The reason for a failure.
pub fn run() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .canonicalize()?;
    let mut points = all_points(&root)?;
    let equivalents = Equivalents::read(&root.join(EQUIVALENTS))?;
    let all = points.len();
    if !args.of.is_empty() {
        points.retain(|point| args.of.iter().any(|text| point.key.contains(text)));
    }
    if args.list {
        for point in &points {
            println!("line {}, {}", point.line, point.key);
        }
    }
    equivalents.check(&points)?;
    if args.list {
        return Ok(());
    }

    // A change elsewhere in the sources moves no point into or out of the sample.
    points.sort_by_cached_key(|point| drawn(args.seed, &point.key));
    let (copy, program) = loop {
        let copy = Copy::new(&root, &points[..args.count.min(points.len())])?;
        match copy.build()? {
            Ok(program) => break (copy, program),
            Err(broken) => {
                for number in broken.into_iter().rev() {
                    let point = points.remove(number - 1);
                    println!("does not compile: {}", point.key);
                }
            }
        }
    };
    points.truncate(args.count);

    let mut numbers: Vec<_> = (1..=points.len()).collect();
    numbers.retain(|number| args.only.is_empty() || args.only.contains(number));
    println!("{} of {all} points, seed {}", points.len(), args.seed);
    let by_script = judge(&mut Trial::scripts(&program, &copy.root)?, &numbers)?;
    let seen = |verdict: &Verdict| matches!(verdict, Verdict::SeenBy(_));
    let unseen = numbers
        .iter()
        .zip(&by_script)
        .filter(|(_, verdict)| !seen(verdict));
    let unseen: Vec<_> = unseen.map(|(number, _)| *number).collect();
    println!(
        "scripts do not see {} of {}: {unseen:?}",
        unseen.len(),
        numbers.len()
    );
    let mut by_test = BTreeMap::new();
    if !args.scripts {
        let verdicts = judge(&mut Trial::tests(copy.build_tests()?), &unseen)?;
        by_test.extend(unseen.into_iter().zip(verdicts));
    }

    let judged = numbers.iter().zip(by_script).map(|(number, script)| Judged {
        number: *number,
        point: &points[number - 1],
        equivalent: equivalents.0.contains_key(&points[number - 1].key),
        by_script: seen(&script),
        seen: seen(&script) || by_test.get(number).is_some_and(seen),
        verdicts: (script, by_test.get(number).cloned()),
    });
    let judged: Vec<_> = judged.collect();
    let report = report(&judged);
    fs::write(root.join("target/mutants/report.txt"), &report)?;
    print!("{report}");
    match judged.iter().find(|judged| judged.equivalent && judged.seen) {
        Some(judged) => Err(format!("listed as equivalent, but seen: {}", judged.point.key).into()),
        None => Ok(()),
    }
}

struct Judged<'a> {
    number: usize,
    point: &'a Point,
    equivalent: bool,
    by_script: bool,
    seen: bool,
    /// Of the scripts, and of the tests if they were run.
    verdicts: (Verdict, Option<Verdict>),
}

/// Every point of the crates, in the order of the files.
fn all_points(root: &Path) -> Result<Vec<Point>, Box<dyn Error>> {
    let mut files = Vec::new();
    for (folder, _) in copy::CRATES {
        for path in sources(&root.join(folder).join("src"))? {
            let text = fs::read_to_string(&path)?;
            let parsed = syn::parse_file(&text)?;
            let name = path.strip_prefix(root)?.to_string_lossy().into_owned();
            files.push((name, text, parsed));
        }
    }
    let variants = points::variants(&files);
    let of =
        |(name, text, parsed): &(String, String, syn::File)| points::points(name, text, parsed, &variants);
    Ok(files.iter().flat_map(of).collect())
}

fn sources(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut paths = fs::read_dir(folder)?
        .map(|entry| Ok(entry?.path()))
        .collect::<std::io::Result<Vec<_>>>()?;
    paths.sort();
    let mut sources_in = Vec::new();
    for path in paths {
        if path.is_dir() {
            sources_in.extend(sources(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            sources_in.push(path);
        }
    }
    Ok(sources_in)
}

/// A number for the draw: FNV-1a of the key, then the mixing function of splitmix64.
fn drawn(seed: u64, key: &str) -> u64 {
    let fold = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    let hash = key.bytes().fold(0xcbf2_9ce4_8422_2325, fold);
    let mut z = hash.wrapping_add((seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Keys, and the reason for each.
struct Equivalents(BTreeMap<String, String>);

impl Equivalents {
    /// A line for each key, and indented below it the reason.
    fn read(path: &Path) -> Result<Self, Box<dyn Error>> {
        let mut entries = BTreeMap::new();
        let mut key = String::new();
        for line in fs::read_to_string(path)?
            .lines()
            .filter(|line| !line.is_empty() && !line.starts_with('#'))
        {
            if !line.starts_with(' ') {
                key = line.to_owned();
            }
            let reason: &mut String = entries.entry(key.clone()).or_default();
            if line.starts_with(' ') {
                *reason += line;
            }
        }
        match entries.iter().find(|(_, reason)| reason.is_empty()) {
            Some((key, _)) => Err(format!("no reason is given for {key}").into()),
            None => Ok(Self(entries)),
        }
    }

    /// Each must be a change that is possible today.
    fn check(&self, points: &[Point]) -> Result<(), String> {
        let keys: BTreeSet<_> = points.iter().map(|point| &point.key).collect();
        let stale: Vec<_> = self.0.keys().filter(|key| !keys.contains(key)).cloned().collect();
        if stale.is_empty() {
            return Ok(());
        }
        Err(format!("{EQUIVALENTS} is stale:\n{}", stale.join("\n")))
    }
}

fn report(judged: &[Judged]) -> String {
    let mut out = String::new();
    let mut list = |title: &str, of: &dyn Fn(&Judged) -> bool| {
        let _ = writeln!(out, "\n{title}:");
        for judged in judged.iter().filter(|judged| of(judged)) {
            let Judged { number, point, .. } = judged;
            let by = match &judged.verdicts {
                (_, Some(Verdict::SeenBy(test))) => format!("  [{test}]"),
                (Verdict::NotReached, None | Some(Verdict::NotReached)) => "  [not reached]".to_owned(),
                (Verdict::NotReached, _) => "  [not reached by scripts]".to_owned(),
                _ => String::new(),
            };
            let _ = writeln!(out, "{number:4}  line {}, {}{by}", point.line, point.key);
        }
    };
    list("equivalent", &|judged| judged.equivalent);
    list("seen by Rust tests only", &|judged| {
        judged.seen && !judged.by_script
    });
    list("not seen", &|judged| !judged.seen && !judged.equivalent);
    let _ = writeln!(
        out,
        "\n{:12} {:>7} {:>10} {:>8} {:>14} {:>14}",
        "crate", "changes", "equivalent", "the rest", "by scripts", "by all tests"
    );
    for (folder, _) in copy::CRATES.iter().chain([&("", "")]) {
        let within: Vec<_> = judged
            .iter()
            .filter(|judged| judged.point.file.starts_with(folder))
            .collect();
        let rest: Vec<_> = within.iter().filter(|judged| !judged.equivalent).collect();
        let share = |seen: usize| format!("{seen} ({:.1} %)", 100.0 * seen as f64 / rest.len().max(1) as f64);
        let scripts = rest.iter().filter(|judged| judged.by_script).count();
        let tests = rest.iter().filter(|judged| judged.seen).count();
        let name = if folder.is_empty() { "all" } else { folder };
        let _ = writeln!(
            out,
            "{name:12} {:7} {:10} {:8} {:>14} {:>14}",
            within.len(),
            within.len() - rest.len(),
            rest.len(),
            share(scripts),
            share(tests)
        );
    }
    out
}
