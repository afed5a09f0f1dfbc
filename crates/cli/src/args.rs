//! The arguments of the program.

mod values;

use clap::{Args, Parser, Subcommand};
use standstill_script::suite::Allowed;
#[cfg(feature = "sweep")]
use standstill_sweep::Shard;
use std::path::PathBuf;
use values::{axis, cycle, delimiter, parameter, period, size, tolerance};

/// A PLCopen motion runtime: run scan scripts, check their claims, plan moves.
#[derive(Debug, Parser)]
#[command(name = "standstill", version, arg_required_else_help = true, after_help = EXIT_STATUSES)]
pub struct Arguments {
    /// End the command with status 1 after this time, and report its work at that moment
    #[arg(long, global = true, value_name = "TIME", value_parser = period)]
    pub time_limit: Option<u64>,
    /// The command.
    #[command(subcommand)]
    pub command: Command,
}

/// Shown below the help.
const EXIT_STATUSES: &str = "Exit status: 0 passed, 1 a claim, golden or plan failed, 2 bad usage, \
3 bad script or trace, 4 I/O, 70 internal fault";

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run scripts and show their events, curves and extremes
    Run(RunArguments),
    /// Run a script in the terminal: step it, stop at events and claims, change its inputs
    Watch(WatchArguments),
    /// Run a script as a cyclic task, one scan a period of the wall clock (Linux)
    Live(LiveArguments),
    /// Open scripts of a folder in a browser, on this machine only; a saved script runs again
    Serve(ServeArguments),
    /// Check scripts against their claims and goldens
    Test(TestArguments),
    /// Draw traces: an interactive page, a picture, a waveform
    Report {
        /// The traces (.csv, .jsonl, .exact); several are drawn over each other
        #[arg(value_name = "TRACE", required = true)]
        traces: Vec<PathBuf>,
        /// Write a self-contained HTML page to this file
        #[arg(long, short, value_name = "FILE.html")]
        output: Option<PathBuf>,
        /// Write a picture to this file
        #[arg(long, value_name = "FILE")]
        svg: Option<PathBuf>,
        /// Write a waveform for GTKWave or Surfer to this file
        #[arg(long, value_name = "FILE")]
        vcd: Option<PathBuf>,
    },
    /// Show the first difference of two traces, and its likely cause
    Explain {
        /// The expected trace (.csv, .jsonl, .exact)
        expected: PathBuf,
        /// The actual trace
        found: PathBuf,
        /// Print one JSON object
        #[arg(long)]
        json: bool,
    },
    /// Compare a trace with the recording of a machine
    Compare {
        /// The recording: CSV as exported by an oscilloscope, a PLC trace or a logger
        #[arg(value_name = "REF")]
        recording: PathBuf,
        /// The trace (.csv, .jsonl, .exact)
        trace: PathBuf,
        /// The map: the columns of the recording, and the permitted differences
        #[arg(long, value_name = "MAP.json")]
        map: PathBuf,
    },
    /// Find frequency and damping of a machine's vibration, from a trace or a recording
    Identify(IdentifyArguments),
    /// Plan moves: one JSON object a line in, one a line out
    Plan {
        /// The lines; standard input if absent or `-`
        file: Option<PathBuf>,
        /// Write the set-points of every scan of every plan to this file, as CSV
        #[arg(long, value_name = "FILE")]
        samples: Option<PathBuf>,
        /// Draw the first six plans over each other in this picture
        #[arg(long, value_name = "FILE")]
        svg: Option<PathBuf>,
        /// Write these plans as a self-contained HTML page to this file; they must have the same Ts
        #[arg(long, value_name = "FILE.html")]
        report: Option<PathBuf>,
    },
    /// Plan moves with every method, and compare them as CSV
    ComparePlanners {
        /// Lines as `plan` takes them, each with an optional `n_star`; standard input if `-`
        #[arg(value_name = "CASES.jsonl")]
        cases: PathBuf,
    },
    /// Run a script with many values of its parameters, and write a row of figures for each case
    Sweep(SweepArguments),
    /// Try random cases without end
    Soak {
        /// The kind of cases
        #[command(subcommand)]
        what: Soak,
    },
    /// Write a first test into a folder: a machine file, a script, files for editors and CI
    ///
    /// Nothing is written if one of the files already exists.
    Init {
        /// The folder; it is created if it does not exist
        #[arg(value_name = "FOLDER", default_value = ".")]
        folder: PathBuf,
    },
    /// Check a cam against its axes, draw it, or write the rows of a usual law
    Cam {
        /// The task
        #[command(subcommand)]
        what: Cam,
    },
    /// List the function blocks and their pins
    Blocks {
        /// Only these blocks
        #[arg(value_name = "NAME")]
        names: Vec<String>,
        /// As JSON
        #[arg(long)]
        json: bool,
        /// Print the meaning and the remedy of an ErrorID instead, given by number or name
        #[arg(long, value_name = "N", conflicts_with_all = ["names", "json"])]
        error: Option<String>,
    },
    /// Print the meaning and the remedy of an ErrorID
    ExplainError {
        /// Its number or its name
        #[arg(value_name = "N")]
        error: String,
    },
    /// Print completions of the command line for a shell
    Completions {
        /// The shell
        #[arg(value_name = "SHELL")]
        shell: Shell,
    },
    /// Write manual pages
    Man {
        /// The folder for them; it is created if it does not exist
        #[arg(value_name = "FOLDER")]
        folder: PathBuf,
    },
    /// Write the files that a host needs to call the blocks: headers, shims, imports, a library
    Export {
        /// The target
        #[arg(value_enum)]
        target: ExportTarget,
        /// Write the files into this folder
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
        /// The prefix of all names in C
        #[arg(long, value_name = "P", default_value = "standstill")]
        prefix: String,
        /// Name pins and number enumerations in shims as another system does
        #[arg(long, value_name = "NAME")]
        dialect: Option<String>,
    },
    /// Serve an editor on standard input and output: mistakes, declarations and completions in Structured Text and scan scripts
    Lsp {
        /// Also accept names and numbers of this system: codesys, twincat or omron
        #[arg(long, value_name = "NAME")]
        dialect: Option<String>,
        /// Accepted because editors pass it; there is no other transport
        #[arg(long, hide = true)]
        stdio: bool,
    },
    /// Let an agent check, run, explain and plan, over the Model Context Protocol on standard input and output
    Mcp(McpArguments),
    /// Check, lint or compile programs in Structured Text
    St {
        /// The task
        #[command(subcommand)]
        what: St,
    },
    /// Print the JSON Schema of scripts, of machine files, of the maps of `compare`, or of sweeps
    Schema {
        /// The format
        #[arg(value_enum, default_value_t = Schema::Script)]
        of: Schema,
    },
    /// Lay out scripts in their canonical form
    Fmt {
        /// Scripts, and folders of them; `-` lays out standard input to standard output
        #[arg(value_name = "PATH", default_value = SCRIPTS)]
        paths: Vec<PathBuf>,
        /// Write nothing; fail if a script would change
        #[arg(long)]
        check: bool,
    },
}

/// The shells that can complete the command line.
#[cfg(feature = "pages")]
pub use clap_complete::Shell;
#[cfg(not(feature = "pages"))]
pub type Shell = String;

/// How `test` compares runs with goldens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Golden {
    /// To the bit
    Exact,
    /// Events to the scan, set-points within tolerances
    Events,
    /// Only claims decide
    None,
}

/// The targets of `export`.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub enum ExportTarget {
    /// Headers for hosts in C and C++
    C,
    /// Structured Text for matiec and Beremiz
    StMatiec,
    /// Structured Text for STruC++ and OpenPLC
    StStrucpp,
    /// Structured Text and C for rusty
    StRusty,
    /// Imports of guests in WebAssembly, and a header for those in C
    Wasm,
    /// A library of interfaces for IDEs
    PlcopenXml,
}

/// The formats that `schema` describes.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub enum Schema {
    /// Scan scripts
    Script,
    /// Machine files that scripts include
    Machine,
    /// Maps for `compare`
    Map,
    /// Sweeps
    Sweep,
    /// The output of `test --json` and `run --json`
    Json,
}

/// The kinds of cases of `soak`.
#[derive(Debug, Subcommand)]
pub enum Soak {
    /// Replan from random moving states, and check every plan against its limits and its goal
    ///
    /// A failing replan is printed as a line of `standstill plan`. The figures at the end are the worst of all
    /// plans that pass.
    Planner {
        /// The seed of all replans
        #[arg(long, value_name = "S", default_value_t = 1)]
        seed: u64,
        /// Number of replans
        #[arg(long, value_name = "N", default_value_t = 100_000)]
        count: u64,
        /// Keep the state of the run in this file, and continue from it if it exists
        #[arg(long, value_name = "FILE")]
        resume: Option<PathBuf>,
    },
    /// Run random programs of blocks over random axes, and check every rule in every scan
    ///
    /// A failing program is made as small as possible and written as a scan script.
    Blocks {
        /// The seed of all programs
        #[arg(long, value_name = "S", default_value_t = 1)]
        seed: u64,
        /// Number of scans
        #[arg(long, value_name = "N", default_value_t = 100_000)]
        count: u64,
        /// Keep the state of the run in this file, and continue from it if it exists
        #[arg(long, value_name = "FILE")]
        resume: Option<PathBuf>,
        /// Write failing programs into this folder
        #[arg(long, value_name = "FOLDER", default_value = FAILURES)]
        failures: PathBuf,
    },
}

/// The tasks of `st`.
#[derive(Debug, Subcommand)]
pub enum St {
    /// Report errors and warnings for the files of a project
    Check {
        /// The project
        #[command(flatten)]
        sources: StSources,
        /// As JSON
        #[arg(long)]
        json: bool,
    },
    /// Report code that works but is probably not intended, especially with motion
    Lint {
        /// The project
        #[command(flatten)]
        sources: StSources,
        /// As JSON
        #[arg(long)]
        json: bool,
    },
    /// Lay out files: indentation, spaces, the case of keywords
    Fmt {
        /// The files
        #[arg(value_name = "FILE.st", required = true)]
        files: Vec<PathBuf>,
        /// Write nothing; fail if a file would change
        #[arg(long)]
        check: bool,
    },
    /// Compile a project to a guest in WebAssembly, with a file of its symbols beside it
    Build {
        /// The project
        #[command(flatten)]
        sources: StSources,
        /// Write the module to this file, and its symbols to FILE.symbols.json
        #[arg(long, short, value_name = "FILE.wasm")]
        output: PathBuf,
        /// A name of an axis, the first one is number 1: variables of type AXIS_REF with that name start as this
        /// axis
        #[arg(long, value_name = "NAME")]
        axis: Vec<String>,
    },
}

/// The tasks of `cam`.
#[derive(Debug, Subcommand)]
pub enum Cam {
    /// Check whether a slave can follow a cam, and how fast its master may be
    Check(CamCheckArguments),
    /// Draw a cam and its derivatives by the master
    Plot {
        /// The table: a CSV file, or SCRIPT.scan.json#TABLE; `-` is standard input
        #[arg(value_name = "FILE")]
        file: PathBuf,
        /// Write the picture to this file
        #[arg(long, value_name = "OUT.svg")]
        svg: PathBuf,
        /// The cam continues with its first row after its last one
        #[arg(long)]
        periodic: bool,
        /// Files outside the script's folder
        #[command(flatten)]
        outside: Outside,
    },
    /// Write the rows of a law from rest to rest, as CSV
    Law(CamLawArguments),
}

/// The arguments of `cam check`.
#[derive(Args, Debug)]
pub struct CamCheckArguments {
    /// The table: a CSV file, or SCRIPT.scan.json#TABLE; `-` is standard input
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// The slave: an axis of a machine file or a script
    #[arg(long, value_name = "MACHINE.json#NAME", value_parser = axis)]
    pub axis: (PathBuf, String),
    /// The master; the slave must follow it up to its velocity limit
    #[arg(long, value_name = "MACHINE.json#NAME", value_parser = axis)]
    pub master: Option<(PathBuf, String)>,
    /// The cam continues with its first row after its last one
    #[arg(long)]
    pub periodic: bool,
    /// The cam begins at the position of the slave (selected without SlaveAbsolute): software limits are not
    /// checked
    #[arg(long)]
    pub relative: bool,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// Files outside the machine file's folder
    #[command(flatten)]
    pub outside: Outside,
}

/// The arguments of `cam law`.
#[derive(Args, Debug)]
pub struct CamLawArguments {
    /// The law
    #[arg(value_enum, value_name = "LAW")]
    pub law: CamLaw,
    /// Travel of the slave, below 0 for the way back
    #[arg(long, value_name = "Y", allow_negative_numbers = true)]
    pub lift: f64,
    /// Travel of the master
    #[arg(long, value_name = "U", allow_negative_numbers = true)]
    pub width: f64,
    /// First position of the master
    #[arg(long, value_name = "U", allow_negative_numbers = true, default_value_t = 0.0)]
    pub begin: f64,
    /// First position of the slave
    #[arg(long, value_name = "Y", allow_negative_numbers = true, default_value_t = 0.0)]
    pub from: f64,
    /// Write the rows to this file instead of standard output
    #[arg(long, short, value_name = "FILE.csv")]
    pub output: Option<PathBuf>,
}

/// The laws that `cam law` writes.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub enum CamLaw {
    /// Modified sine: low torque, the jerk steps at the ends
    ModifiedSine,
    /// Sinoid (cycloidal): the acceleration is one sine, the jerk steps at the ends
    Sinoid,
    /// 3-4-5 polynomial: the jerk steps at the ends
    Poly345,
    /// 4-5-6-7 polynomial: the jerk doesn't step, for slaves with a snap limit
    Poly4567,
    /// Modified acceleration trapezoid: the least acceleration, the jerk steps at the ends
    Trapezoid,
}

/// The files of a project in Structured Text.
#[derive(Args, Debug)]
pub struct StSources {
    /// All files of the project
    #[arg(value_name = "FILE.st", required = true)]
    pub files: Vec<PathBuf>,
    /// Also accept names and numbers of this system: codesys, twincat or omron
    #[arg(long, value_name = "NAME")]
    pub dialect: Option<String>,
    /// The PROGRAM to run in every scan, if there are several and no CONFIGURATION
    #[arg(long, value_name = "NAME")]
    pub program: Option<String>,
}

/// The arguments of `mcp`.
#[derive(Args, Debug)]
pub struct McpArguments {
    /// The folder whose scripts and traces may be read; nothing outside may be read
    #[arg(value_name = "FOLDER", default_value = ".")]
    pub folder: PathBuf,
    /// Calls may write pages, pictures and traces into this folder; without it nothing is written
    #[arg(long, value_name = "FOLDER")]
    pub write: Option<PathBuf>,
    /// End a call after this time
    #[arg(long, value_name = "TIME", value_parser = period, default_value = "30s")]
    pub call_time: u64,
    /// Memory limit of a call, such as 256MiB (Linux)
    #[arg(long, value_name = "SIZE", value_parser = size, default_value = "1GiB")]
    pub call_memory: u64,
}

/// The folder into which `soak blocks` writes failing programs.
const FAILURES: &str = "soak-failures";

/// The folder with the scripts of a repository.
pub const SCRIPTS: &str = "scan-tests";

/// The arguments of `run`.
#[derive(Args, Debug)]
pub struct RunArguments {
    /// The scripts, run in this order; or the files of one program in Structured Text
    #[arg(value_name = "SCRIPT", required = true)]
    pub scripts: Vec<PathBuf>,
    /// The machine file with the axes of a program in Structured Text
    #[arg(long, value_name = "MACHINE.json")]
    pub axes: Option<PathBuf>,
    /// For such a program: the PROGRAM that runs
    #[arg(long, value_name = "NAME")]
    pub program: Option<String>,
    /// For such a program: the length of a scan; T#1ms if absent
    #[arg(long, value_name = "TIME", value_parser = cycle)]
    pub cycle: Option<i64>,
    /// For such a program: the number of scans; 1000 if absent
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    pub scans: Option<u64>,
    /// Write the trace to this file; its ending selects the format
    #[arg(long, value_name = "FILE(.csv|.jsonl)")]
    pub trace: Option<PathBuf>,
    /// The separator of the cells of a CSV trace: `,` `;` `|` or `tab`
    #[arg(long, value_name = "CHARACTER", value_parser = delimiter, requires = "trace")]
    pub delimiter: Option<char>,
    /// Write numbers of a CSV trace with a decimal comma; the default separator is then `;`
    #[arg(long, requires = "trace")]
    pub decimal_comma: bool,
    /// Write a self-contained HTML page to this file
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
    /// Write a picture to this file
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// Write a waveform for GTKWave or Surfer to this file
    #[arg(long, value_name = "FILE")]
    pub vcd: Option<PathBuf>,
    /// Replace the value of a parameter of the script
    #[arg(long, value_name = "NAME=VALUE", value_parser = parameter)]
    pub set: Vec<(String, f64)>,
    /// Files outside the script's folder
    #[command(flatten)]
    pub outside: Outside,
    /// Print failing claims and one line for each script
    #[arg(long, short)]
    pub quiet: bool,
    /// Print the result as one JSON object
    #[arg(long, conflicts_with = "quiet")]
    pub json: bool,
}

/// The arguments of `test`.
#[derive(Args, Debug)]
pub struct TestArguments {
    /// Scripts, and folders of them [default: scan-tests, or this folder where there is none]
    #[arg(value_name = "PATH")]
    pub paths: Vec<PathBuf>,
    /// Only scripts whose path contains this, without regard to case
    #[arg(short = 'k', value_name = "WORD")]
    pub word: Option<String>,
    /// Run nothing; print the paths of the scripts
    #[arg(long, conflicts_with_all = ["accept", "strict", "json", "mutate", "golden", "abs", "rel", "junit", "report", "recording", "watch"])]
    pub list: bool,
    /// Judge again when a file below the paths is saved, failed scripts first; runs until interrupted
    #[arg(long, conflicts_with_all = ["accept", "json", "mutate", "junit", "recording"])]
    pub watch: bool,
    /// Accept the runs as goldens if all claims hold
    #[arg(long)]
    pub accept: bool,
    /// Show the differences from a golden if all claims hold, and ask whether to accept the run; answers come
    /// from standard input
    #[arg(long, conflicts_with_all = ["accept", "list", "json", "mutate", "watch", "strict", "junit", "coverage", "report", "recording", "threads"])]
    pub review: bool,
    /// Also fail for items that test nothing and for values that were clamped
    #[arg(long)]
    pub strict: bool,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
    /// Make small changes to the programs of the scripts, and report the changes that no claim detects
    #[arg(long, conflicts_with_all = ["accept", "golden", "abs", "rel", "report", "junit", "recording", "strict"])]
    pub mutate: bool,
    /// With --mutate: the seed that selects the changes of a script with very many
    #[arg(long, value_name = "S", default_value_t = 1, requires = "mutate")]
    pub seed: u64,
    /// How a run must agree with its golden: to the bit, its events to the scan and its set-points within --abs
    /// and --rel, or not at all
    #[arg(long, value_enum, value_name = "HOW", default_value_t = Golden::Exact)]
    pub golden: Golden,
    /// With --golden events: largest difference of a set-point, in its own unit [default: 1e-6]
    #[arg(long, value_name = "X", value_parser = tolerance)]
    pub abs: Option<f64>,
    /// With --golden events: additional difference, as a share of the expected value [default: 1e-9]
    #[arg(long, value_name = "Y", value_parser = tolerance)]
    pub rel: Option<f64>,
    /// Write the result to this file, as JUnit XML
    #[arg(long, value_name = "FILE.xml")]
    pub junit: Option<PathBuf>,
    /// Write the statements and branches of Structured Text that the scripts execute to this file
    #[arg(long, value_name = "FILE.lcov", conflicts_with_all = ["list", "mutate", "recording"])]
    pub coverage: Option<PathBuf>,
    /// Write a page for every script that fails into this folder: golden and run in one drawing
    #[arg(long, value_name = "FOLDER")]
    pub report: Option<PathBuf>,
    /// Judge the script's claims on this trace (.csv, .jsonl, .exact) instead of a run, for example on the
    /// contents of a flight recorder
    #[arg(long, value_name = "TRACE", conflicts_with_all = ["accept", "golden", "abs", "rel", "report"])]
    pub recording: Option<PathBuf>,
    /// Judge on this number of threads instead of on all processors; the output is the same
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), conflicts_with_all = ["mutate", "recording"])]
    pub threads: Option<u16>,
    /// Files outside the script's folder
    #[command(flatten)]
    pub outside: Outside,
}

/// The arguments of `sweep`.
#[derive(Args, Debug)]
pub struct SweepArguments {
    /// The sweep file: the parameters that vary, and the figures of every run
    #[arg(value_name = "SWEEP.json")]
    pub sweep: PathBuf,
    /// Write the table to this file; continue from FILE.csv.part of an interrupted run
    #[arg(long, short, value_name = "FILE.csv")]
    pub output: Option<PathBuf>,
    /// Compute only every N-th case, beginning with the I-th
    #[cfg(feature = "sweep")]
    #[arg(long, value_name = "I/N", default_value_t = Shard::ALL, conflicts_with = "merge")]
    pub shard: Shard,
    /// Compute on this number of threads instead of on all processors
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), conflicts_with = "merge")]
    pub threads: Option<u16>,
    /// Compute nothing: merge the tables of all shards
    #[arg(long, value_name = "SHARD.csv", num_args = 1..)]
    pub merge: Vec<PathBuf>,
    /// Files outside the script's folder
    #[command(flatten)]
    pub outside: Outside,
}

/// The arguments of `watch`.
#[derive(Args, Debug)]
pub struct WatchArguments {
    /// The script
    #[arg(value_name = "SCRIPT")]
    pub script: PathBuf,
    /// Replace the value of a parameter of the script
    #[arg(long, value_name = "NAME=VALUE", value_parser = parameter)]
    pub set: Vec<(String, f64)>,
    /// Files outside the script's folder
    #[command(flatten)]
    pub outside: Outside,
}

/// The arguments of `serve`.
#[derive(Args, Debug)]
pub struct ServeArguments {
    /// The folder with the scripts [default: scan-tests, or this folder where there is none]
    #[arg(value_name = "FOLDER")]
    pub folder: Option<PathBuf>,
    /// The port of the loopback address; 0 selects a free one
    #[arg(long, value_name = "N", default_value_t = 7480)]
    pub port: u16,
    /// The page, as `bash .ci/site` builds it [default: target/site, or `site` beside the program]
    #[arg(long, value_name = "FOLDER")]
    pub site: Option<PathBuf>,
    /// Scripts may also read files (machine files, programs) from this folder
    #[arg(long, value_name = "FOLDER")]
    pub include_from: Vec<PathBuf>,
}

/// The arguments of `live`.
#[derive(Args, Debug)]
pub struct LiveArguments {
    /// The script
    #[arg(value_name = "SCRIPT")]
    pub script: PathBuf,
    /// Time between two scans; it must be the cycle of the script
    #[arg(long, value_name = "TIME", value_parser = period)]
    pub period: u64,
    /// Write the trace to this file; its ending selects the format
    #[arg(long, value_name = "FILE(.csv|.jsonl)")]
    pub trace: Option<PathBuf>,
    /// Write the start and the duration of each scan to this file
    #[arg(long, value_name = "FILE.json")]
    pub timing: Option<PathBuf>,
    /// The reaction to a scan that is not finished when the next one is due
    #[arg(long, value_enum, value_name = "WHAT", default_value_t = OnOverrun::Continue)]
    pub on_overrun: OnOverrun,
    /// Replace the value of a parameter of the script
    #[arg(long, value_name = "NAME=VALUE", value_parser = parameter)]
    pub set: Vec<(String, f64)>,
    /// Files outside the script's folder
    #[command(flatten)]
    pub outside: Outside,
}

/// The reactions of `live` to an overrun.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum OnOverrun {
    /// Count it, and skip the periods that have passed
    Continue,
    /// Stop the programs; the axes stop and switch off
    Stop,
}

/// Permissions of scripts beyond those of any script.
#[derive(Args, Debug)]
pub struct Outside {
    /// Scripts may also read files (machine files, programs) from this folder
    #[arg(long, value_name = "FOLDER")]
    include_from: Vec<PathBuf>,
    /// Scripts may read files from anywhere
    #[arg(long)]
    allow_outside: bool,
    /// Memory limit for all guest programs of a script together, such as 256MiB
    #[arg(long, value_name = "SIZE", value_parser = size, default_value = "64MiB")]
    guest_memory: u64,
}

impl Outside {
    /// Permissions of scripts beyond those of any script.
    pub fn allowed(&self) -> Allowed {
        let mut folders = self.include_from.clone();
        if self.allow_outside {
            folders.push(PathBuf::from(std::path::MAIN_SEPARATOR_STR));
        }
        Allowed {
            folders,
            guest_memory: self.guest_memory,
            ..Allowed::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        Arguments::command().debug_assert();
    }
}

/// The arguments of `identify`.
#[derive(Debug, clap::Args)]
pub struct IdentifyArguments {
    /// The trace (.csv, .jsonl, .exact), or with --time the recording of a machine (CSV)
    pub trace: PathBuf,
    /// The column of the vibration [default: of each axis ActualPosition - Position, in the longest time at rest of
    /// the set-point after a motion]
    #[arg(long, value_name = "NAME")]
    pub signal: Option<String>,
    /// Ignore samples before this time
    #[arg(long, value_name = "TIME", value_parser = period)]
    pub from: Option<u64>,
    /// Ignore samples after this time
    #[arg(long, value_name = "TIME", value_parser = period)]
    pub to: Option<u64>,
    /// The trace is a recording, with its times in this column
    #[arg(long, value_name = "NAME", requires = "signal")]
    pub time: Option<String>,
    /// The unit of these times
    #[arg(long, value_enum, default_value_t = TimeUnit::Seconds, requires = "time")]
    pub unit: TimeUnit,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

impl IdentifyArguments {
    /// The first and the last time (ns) to evaluate.
    pub fn window(&self) -> (i64, i64) {
        let ns =
            |time: Option<u64>, absent| time.map_or(absent, |time| i64::try_from(time).unwrap_or(i64::MAX));
        (ns(self.from, 0), ns(self.to, i64::MAX))
    }
}

/// The units of the times of a recording.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub enum TimeUnit {
    /// Seconds
    #[value(name = "s")]
    Seconds,
    /// Milliseconds
    #[value(name = "ms")]
    Milliseconds,
    /// Microseconds
    #[value(name = "us")]
    Microseconds,
    /// Nanoseconds
    #[value(name = "ns")]
    Nanoseconds,
}

impl From<TimeUnit> for standstill_trace::foreign::Unit {
    fn from(unit: TimeUnit) -> Self {
        match unit {
            TimeUnit::Seconds => Self::Seconds,
            TimeUnit::Milliseconds => Self::Milliseconds,
            TimeUnit::Microseconds => Self::Microseconds,
            TimeUnit::Nanoseconds => Self::Nanoseconds,
        }
    }
}
