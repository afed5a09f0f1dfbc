//! Runs programs with one point chosen, until one of them fails.

use crate::copy::{CHOICE, REACHED, Test};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use std::{env, fs, process, thread};

/// A program that passes or fails.
#[derive(Debug)]
pub struct Trial {
    pub name: String,
    program: PathBuf,
    arguments: Vec<String>,
    folder: PathBuf,
    /// Its duration without a change.
    takes: Duration,
    /// The points that it reaches: it can see only these.
    reached: BTreeSet<usize>,
    /// The number of points it has seen so far.
    kills: AtomicUsize,
}

impl Trial {
    fn new(name: String, program: PathBuf, arguments: Vec<String>, folder: PathBuf) -> Self {
        Self {
            name,
            program,
            arguments,
            folder,
            takes: Duration::from_secs(60),
            reached: BTreeSet::new(),
            kills: AtomicUsize::new(0),
        }
    }

    /// One for each folder of scripts: the first that fails ends a judgement early.
    pub fn scripts(program: &Path, root: &Path) -> std::io::Result<Vec<Self>> {
        let mut trials = Vec::new();
        for entry in fs::read_dir(root.join("scan-tests"))? {
            let folder = entry?.file_name().to_string_lossy().into_owned();
            // Files that other scripts include are not scripts.
            if folder != "include" {
                let arguments = vec!["test".to_owned(), format!("scan-tests/{folder}")];
                trials.push(Self::new(folder, program.to_owned(), arguments, root.to_owned()));
            }
        }
        trials.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(trials)
    }

    pub fn tests(tests: Vec<Test>) -> Vec<Self> {
        let of = |test: Test| {
            let name = test
                .program
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            let name = name
                .rsplit_once('-')
                .map_or(name.clone(), |(name, _)| name.to_owned());
            Self::new(name, test.program, vec!["--quiet".to_owned()], test.folder)
        };
        tests.into_iter().map(of).collect()
    }

    fn command(&self) -> Command {
        let mut command = Command::new(&self.program);
        command
            .args(&self.arguments)
            .current_dir(&self.folder)
            // Judgements already use all processors; nothing may write a golden.
            .envs([
                ("RAYON_NUM_THREADS", "1"),
                ("RUST_TEST_THREADS", "1"),
                ("INSTA_UPDATE", "no"),
            ])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        command
    }

    /// Whether it passes; a program that takes ten times as long as without a change counts as hanging.
    fn passes(&self, mut command: Command) -> bool {
        let mut child = command.spawn().expect("a program that was built");
        let until = Instant::now() + (10 * self.takes).max(Duration::from_secs(10));
        loop {
            if let Some(status) = child.try_wait().expect("a child") {
                return status.success();
            }
            if Instant::now() > until {
                let _ = child.kill();
                let _ = child.wait();
                return false;
            }
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// Without a change it must pass; notes its duration and the points it reaches.
    fn prove(&mut self) -> Result<(), String> {
        let (path, start) = (
            env::temp_dir().join(format!("reached-{}", process::id())),
            Instant::now(),
        );
        let mut command = self.command();
        command.env(REACHED, &path);
        if !self.passes(command) {
            return Err(format!("{} fails without any change", self.name));
        }
        self.takes = start.elapsed();
        let reached = fs::read_to_string(&path).unwrap_or_default();
        let _ = fs::remove_file(&path);
        self.reached = reached.lines().filter_map(|line| line.parse().ok()).collect();
        Ok(())
    }

    /// Whether it fails with the point of this number.
    fn sees(&self, number: usize) -> bool {
        let mut command = self.command();
        command.env(CHOICE, number.to_string());
        let seen = !self.passes(command);
        if seen {
            self.kills.fetch_add(1, Ordering::Relaxed);
        }
        seen
    }

    /// The average time to see a point.
    fn price(&self) -> Duration {
        self.takes / (1 + self.kills.load(Ordering::Relaxed) as u32)
    }
}

/// The verdict on a point.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// No trial reaches it.
    NotReached,
    /// No trial fails.
    NotSeen,
    /// This one does.
    SeenBy(String),
}

/// The verdict of `trials` on each of `numbers`. Trials that see most per second come first.
pub fn judge(trials: &mut [Trial], numbers: &[usize]) -> Result<Vec<Verdict>, String> {
    trials.iter_mut().try_for_each(Trial::prove)?;
    let trials = &*trials;
    let (next, verdicts) = (
        AtomicUsize::new(0),
        Mutex::new(vec![Verdict::NotReached; numbers.len()]),
    );
    let work = || {
        while let Some((at, number)) = numbers
            .iter()
            .enumerate()
            .nth(next.fetch_add(1, Ordering::Relaxed))
        {
            let mut order: Vec<_> = trials
                .iter()
                .filter(|trial| trial.reached.contains(number))
                .collect();
            if order.is_empty() {
                continue;
            }
            order.sort_by_cached_key(|trial| trial.price());
            let seen_by = order.into_iter().find(|trial| trial.sees(*number));
            let verdict = seen_by.map_or(Verdict::NotSeen, |trial| Verdict::SeenBy(trial.name.clone()));
            verdicts.lock().expect("no panic")[at] = verdict;
            if at % 20 == 19 {
                eprintln!("{} of {}", at + 1, numbers.len());
            }
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    Ok(verdicts.into_inner().expect("no panic"))
}
