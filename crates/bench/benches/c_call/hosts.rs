//! The two hosts: one in C, as a separate program, and one in Rust.

use standstill_axis::{
    Axis, AxisConfig, AxisId, ConfigError, DrivePosition, InstanceId, Log, Scope, Standard, StartState,
};
use standstill_bench::{CYCLE, LIMITS, TARGET, feedback};
use standstill_blocks::BlockInstance;
use standstill_fb::Context;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// A host in Rust that has its instances in a list, like one that reads its program from a file.
#[derive(Debug)]
pub struct RustHost {
    axes: [Axis; 1],
    log: Log,
    blocks: Vec<BlockInstance>,
}

impl RustHost {
    /// A powered axis, and an instance of the block of this name.
    ///
    /// # Errors
    /// None with these constants.
    pub fn new(block: &str) -> Result<Self, ConfigError> {
        let config = AxisConfig {
            start: StartState::Standstill,
            ..AxisConfig::new(LIMITS)
        };
        let mut axis = Axis::new(AxisId::new(0), config, Standard::new(CYCLE))?;
        let mut log = Log::default();
        let feedback = feedback(DrivePosition::Units(0.0));
        axis.follow_feedback(&feedback, &mut Scope::new(0, &mut log));
        Ok(Self {
            axes: [axis],
            log,
            blocks: BlockInstance::new(block).into_iter().collect(),
        })
    }

    /// The instance at an index, and the context that blocks are called with.
    #[inline(always)]
    pub fn parts(&mut self, place: usize) -> (Option<&mut BlockInstance>, Context<'_>) {
        let context = Context {
            now_ns: 0,
            scope: Scope {
                scan: 0,
                instance: InstanceId(1),
                log: &mut self.log,
                cams: standstill_axis::Cams::default(),
                history: &mut [],
            },
            axes: &mut self.axes,
            tables: &[],
        };
        (self.blocks.get_mut(place), context)
    }
}

/// The running host in C: `host.c`, compiled by `cc -O2` and linked with the static library.
#[derive(Debug)]
pub struct CHost {
    child: Child,
    asked: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl CHost {
    /// Builds the library and the host and starts it.
    ///
    /// # Errors
    /// The part that cannot be built or started, as a text.
    pub fn start() -> Result<Self, String> {
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        let capi = here.join("../capi");
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c_call");
        let library = library(&capi, &folder)?;
        let program = folder.join("host");
        let mut cc = Command::new("cc");
        cc.args(["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-I"])
            .arg(capi.join("include"))
            .arg(here.join("benches/c_call/host.c"))
            .arg("-o")
            .arg(&program)
            .arg(library)
            .args(["-lpthread", "-ldl", "-lm"]);
        let output = cc.output().map_err(|error| format!("cc: {error}"))?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into_owned());
        }
        let limits = [
            LIMITS.velocity,
            LIMITS.acceleration,
            LIMITS.jerk,
            LIMITS.snap,
            TARGET,
        ];
        let mut child = Command::new(&program)
            .args(limits.map(|limit| format!("{limit:?}")))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| format!("{}: {error}", program.display()))?;
        let (Some(asked), Some(answers)) = (child.stdin.take(), child.stdout.take()) else {
            return Err("the host in C has no pipes".to_owned());
        };
        Ok(Self {
            child,
            asked,
            answers: BufReader::new(answers),
        })
    }

    /// Nanoseconds of one of so many calls of this measure; none if the host has ended.
    pub fn time(&mut self, measure: &str, calls: u64) -> Option<f64> {
        writeln!(self.asked, "{measure} {calls}").ok()?;
        let mut line = String::new();
        self.answers.read_line(&mut line).ok()?;
        line.trim().parse().ok()
    }

    /// Lets it end.
    pub fn end(self) -> bool {
        let Self {
            mut child,
            asked,
            answers,
        } = self;
        drop((asked, answers));
        child.wait().is_ok_and(|status| status.success())
    }
}

/// The static library, as it is shipped.
fn library(capi: &Path, folder: &Path) -> Result<PathBuf, String> {
    let output = Command::new(env!("CARGO"))
        .args([
            "rustc",
            "--offline",
            "--quiet",
            "--profile",
            "dist",
            "--lib",
            "--crate-type",
            "staticlib",
        ])
        .arg("--manifest-path")
        .arg(capi.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(folder)
        .output()
        .map_err(|error| format!("cargo: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    Ok(folder.join("dist/libstandstill_capi.a"))
}
