//! Runs programs with one point chosen, until one of them fails.

use crate::copy::{CHOICE, Test};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Something that passes or fails.
#[derive(Debug)]
pub struct Trial {
    pub name: String,
    program: PathBuf,
    arguments: Vec<String>,
    folder: PathBuf,
    /// After this long it hangs.
    limit: Duration,
    /// How many points it has seen so far: those that see most are asked first.
    kills: AtomicUsize,
}

impl Trial {
    fn new(name: String, program: PathBuf, arguments: Vec<String>, folder: PathBuf) -> Self {
        Self {
            name,
            program,
            arguments,
            folder,
            limit: Duration::from_secs(600),
            kills: AtomicUsize::new(0),
        }
    }

    /// One for each folder of scripts: the first that fails ends a judgement early.
    pub fn scripts(program: &Path, root: &Path) -> std::io::Result<Vec<Self>> {
        let mut trials = Vec::new();
        for entry in std::fs::read_dir(root.join("scan-tests"))? {
            let folder = entry?.file_name().to_string_lossy().into_owned();
            // What other scripts include are no scripts.
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
            let name = test.program.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let name = name.rsplit_once('-').map_or(name.clone(), |(name, _)| name.to_owned());
            Self::new(name, test.program, vec!["--quiet".to_owned()], test.folder)
        };
        tests.into_iter().map(of).collect()
    }

    /// Whether all is well with the point of this number.
    fn passes(&self, number: usize) -> bool {
        let mut child = Command::new(&self.program)
            .args(&self.arguments)
            .current_dir(&self.folder)
            .env(CHOICE, number.to_string())
            // Both processors are taken by judgements; nothing may write a golden.
            .envs([("RAYON_NUM_THREADS", "1"), ("RUST_TEST_THREADS", "1"), ("INSTA_UPDATE", "no")])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("a program that was built");
        let until = Instant::now() + self.limit;
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

    /// Without a change it must pass; gives it ten times as long as that takes from then on.
    fn prove(&mut self) -> Result<(), String> {
        let start = Instant::now();
        if !self.passes(0) {
            return Err(format!("{} fails without any change", self.name));
        }
        self.limit = (10 * start.elapsed()).max(Duration::from_secs(10));
        Ok(())
    }
}

/// For each of `numbers`, the first of `trials` that fails.
pub fn judge(trials: &mut [Trial], numbers: &[usize]) -> Result<Vec<Option<String>>, String> {
    trials.iter_mut().try_for_each(Trial::prove)?;
    let trials = &*trials;
    let (next, verdicts) = (AtomicUsize::new(0), Mutex::new(vec![None; numbers.len()]));
    let work = || {
        while let Some((at, number)) = numbers.iter().enumerate().nth(next.fetch_add(1, Ordering::Relaxed)) {
            let mut order: Vec<_> = trials.iter().collect();
            order.sort_by_key(|trial| usize::MAX - trial.kills.load(Ordering::Relaxed));
            let killer = order.into_iter().find(|trial| !trial.passes(*number));
            if let Some(trial) = killer {
                trial.kills.fetch_add(1, Ordering::Relaxed);
            }
            verdicts.lock().expect("no panic")[at] = killer.map(|trial| trial.name.clone());
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    Ok(verdicts.into_inner().expect("no panic"))
}
