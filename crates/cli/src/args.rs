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
    /// End the command with status 1 after this time, and say what it was at
    #[arg(long, global = true, value_name = "TIME", value_parser = period)]
    pub time_limit: Option<u64>,
    /// What to do.
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
    /// Open scripts of a folder in a browser, on this machine alone; they run again whenever one is saved
    Serve(ServeArguments),
    /// Hold scripts against their claims and goldens
    Test {
        /// Scripts, and folders of them [default: scan-tests, or this folder where there is none]
        #[arg(value_name = "PATH")]
        paths: Vec<PathBuf>,
        /// Only scripts whose path has this in it, without regard to case
        #[arg(short = 'k', value_name = "WORD")]
        word: Option<String>,
        /// Judge nothing; print the paths of the scripts
        #[arg(long, conflicts_with_all = ["accept", "strict", "json", "mutate", "golden", "abs", "rel", "junit", "report", "recording", "watch"])]
        list: bool,
        /// Judge again whenever a file below the paths is saved, first what failed; until it is interrupted
        #[arg(long, conflicts_with_all = ["accept", "json", "mutate", "junit", "recording"])]
        watch: bool,
        /// Take the runs as they are for goldens, where all claims hold
        #[arg(long)]
        accept: bool,
        /// Show what differs from a golden where all claims hold, and ask whether to take it; the answer comes from standard input
        #[arg(long, conflicts_with_all = ["accept", "list", "json", "mutate", "watch", "strict", "junit", "coverage", "report", "recording", "threads"])]
        review: bool,
        /// Fail for what tests nothing and for values that were clamped, too
        #[arg(long)]
        strict: bool,
        /// Print the outcome as one JSON object
        #[arg(long)]
        json: bool,
        /// Change the programs of the scripts in small ways, and say which changes no claim notices
        #[arg(long, conflicts_with_all = ["accept", "golden", "abs", "rel", "report", "junit", "recording", "strict"])]
        mutate: bool,
        /// With --mutate: of a script with very many changes those are tried that follow from it
        #[arg(long, value_name = "S", default_value_t = 1, requires = "mutate")]
        seed: u64,
        /// How exactly a run must be as its golden: to the bit, its events to the scan and its set-points within
        /// --abs and --rel, or not at all
        #[arg(long, value_enum, value_name = "HOW", default_value_t = Golden::Exact)]
        golden: Golden,
        /// With --golden events: how far a set-point may be off, in its own unit [default: 1e-6]
        #[arg(long, value_name = "X", value_parser = tolerance)]
        abs: Option<f64>,
        /// With --golden events: how far it may be off besides, as a share of the expected value [default: 1e-9]
        #[arg(long, value_name = "Y", value_parser = tolerance)]
        rel: Option<f64>,
        /// Write the outcome to this file, as JUnit XML
        #[arg(long, value_name = "FILE.xml")]
        junit: Option<PathBuf>,
        /// Write which statements and branches of Structured Text the scripts execute to this file
        #[arg(long, value_name = "FILE.lcov", conflicts_with_all = ["list", "mutate", "recording"])]
        coverage: Option<PathBuf>,
        /// Write a page of every script that fails into this folder: golden and run over each other
        #[arg(long, value_name = "FOLDER")]
        report: Option<PathBuf>,
        /// Judge the script's claims on this trace (.csv, .jsonl, .exact) instead of a run of its own: on what a flight
        /// recorder kept, say
        #[arg(long, value_name = "TRACE", conflicts_with_all = ["accept", "golden", "abs", "rel", "report"])]
        recording: Option<PathBuf>,
        /// Judge on so many threads instead of on all processors; what is printed is the same
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), conflicts_with_all = ["mutate", "recording"])]
        threads: Option<u16>,
        /// Files beside those of the script's folder
        #[command(flatten)]
        outside: Outside,
    },
    /// Draw traces: a page to look into, a picture, a waveform
    Report {
        /// The traces (.csv, .jsonl, .exact); several are laid over each other
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
    /// Show where two traces part
    Explain {
        /// The trace as it should be (.csv, .jsonl, .exact)
        expected: PathBuf,
        /// The trace as it is
        found: PathBuf,
        /// As one JSON object
        #[arg(long)]
        json: bool,
    },
    /// Hold a trace against the recording of a machine
    Compare {
        /// The recording: CSV as a scope, a PLC's trace or a logger exports it
        #[arg(value_name = "REF")]
        recording: PathBuf,
        /// The trace (.csv, .jsonl, .exact)
        trace: PathBuf,
        /// What stands where in the recording, and what may differ
        #[arg(long, value_name = "MAP.json")]
        map: PathBuf,
    },
    /// Find the frequency and the damping with which a machine swings, from a trace or a recording
    Identify(IdentifyArguments),
    /// Plan moves: one JSON object a line in, one a line out
    Plan {
        /// The lines; standard input if absent or `-`
        file: Option<PathBuf>,
        /// Write the set-points of every scan of every plan to this file, as CSV
        #[arg(long, value_name = "FILE")]
        samples: Option<PathBuf>,
        /// Write a picture of the plans over each other to this file, of the first six
        #[arg(long, value_name = "FILE")]
        svg: Option<PathBuf>,
        /// Write them as a self-contained HTML page to this file; they must have the same Ts
        #[arg(long, value_name = "FILE.html")]
        report: Option<PathBuf>,
    },
    /// Plan moves with every method, and compare them as CSV
    ComparePlanners {
        /// Lines as `plan` takes them, each with an optional `n_star`; standard input if `-`
        #[arg(value_name = "CASES.jsonl")]
        cases: PathBuf,
    },
    /// Run a script with many values of its parameters, and write a row of figures a case
    Sweep(SweepArguments),
    /// Try random cases for as long as wanted
    Soak {
        /// What to try
        #[command(subcommand)]
        what: Soak,
    },
    /// Write a first test into a folder: a machine file, a script, what editors and CI need
    ///
    /// If a file of that name is there already nothing is written.
    Init {
        /// The folder; it is made if it is not there
        #[arg(value_name = "FOLDER", default_value = ".")]
        folder: PathBuf,
    },
    /// Hold a cam against its axes, draw it, or write the rows of a usual law
    Cam {
        /// What to do
        #[command(subcommand)]
        what: Cam,
    },
    /// List the function blocks and their pins
    Blocks {
        /// These blocks only
        #[arg(value_name = "NAME")]
        names: Vec<String>,
        /// As JSON
        #[arg(long)]
        json: bool,
        /// Say instead what an ErrorID means and what to do about it; its number or its name
        #[arg(long, value_name = "N", conflicts_with_all = ["names", "json"])]
        error: Option<String>,
    },
    /// Say what an ErrorID means and what to do about it
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
        /// The folder for them; it is made if it is not there
        #[arg(value_name = "FOLDER")]
        folder: PathBuf,
    },
    /// Write what a host needs to call the blocks: headers, shims, imports, a library
    Export {
        /// For whom
        #[arg(value_enum)]
        target: ExportTarget,
        /// Write the files into this folder
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
        /// What all names in C begin with
        #[arg(long, value_name = "P", default_value = "standstill")]
        prefix: String,
        /// Call pins and number enumerations in shims as another system does
        #[arg(long, value_name = "NAME")]
        dialect: Option<String>,
    },
    /// Serve an editor on standard input and output: mistakes, declarations and completions in Structured Text and scan scripts
    Lsp {
        /// Understand names and numbers of this system, too: codesys, twincat or omron
        #[arg(long, value_name = "NAME")]
        dialect: Option<String>,
        /// What editors say of their own accord; it is the only way
        #[arg(long, hide = true)]
        stdio: bool,
    },
    /// Let an agent check, run, explain and plan, over the Model Context Protocol on standard input and output
    Mcp(McpArguments),
    /// Check, lint or compile programs in Structured Text
    St {
        /// What to do
        #[command(subcommand)]
        what: St,
    },
    /// Print the JSON Schema of scripts, of machine files, of the maps of `compare`, or of sweeps
    Schema {
        /// Of what
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

/// The shells that complete the command line.
#[cfg(feature = "pages")]
pub use clap_complete::Shell;
#[cfg(not(feature = "pages"))]
pub type Shell = String;

/// How exactly `test` holds runs against goldens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Golden {
    /// To the bit
    Exact,
    /// Events to the scan, set-points within tolerances
    Events,
    /// Claims decide alone
    None,
}

/// For whom `export` writes.
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

/// What `schema` describes.
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
    /// What `test --json` and `run --json` print
    Json,
}

/// What `soak` tries.
#[derive(Debug, Subcommand)]
pub enum Soak {
    /// Replan from random moving states, and hold every plan against its limits and its goal
    ///
    /// A failing replan is printed as a line of `standstill plan`; the figures at the end are the worst of
    /// all that hold.
    Planner {
        /// All replans follow from it
        #[arg(long, value_name = "S", default_value_t = 1)]
        seed: u64,
        /// How many replans
        #[arg(long, value_name = "N", default_value_t = 100_000)]
        count: u64,
        /// Keep the state of the run in this file, and go on from there if it exists
        #[arg(long, value_name = "FILE")]
        resume: Option<PathBuf>,
    },
    /// Run random programs of blocks over random axes, and hold every rule in every scan
    ///
    /// A failing program is made as small as it gets and written as a scan script.
    Blocks {
        /// All programs follow from it
        #[arg(long, value_name = "S", default_value_t = 1)]
        seed: u64,
        /// How many scans
        #[arg(long, value_name = "N", default_value_t = 100_000)]
        count: u64,
        /// Keep the state of the run in this file, and go on from there if it exists
        #[arg(long, value_name = "FILE")]
        resume: Option<PathBuf>,
        /// Write failing programs into this folder
        #[arg(long, value_name = "FOLDER", default_value = FAILURES)]
        failures: PathBuf,
    },
}

/// What `st` does.
#[derive(Debug, Subcommand)]
pub enum St {
    /// Say what is wrong or doubtful in the files of a project
    Check {
        /// The project
        #[command(flatten)]
        sources: StSources,
        /// As JSON
        #[arg(long)]
        json: bool,
    },
    /// Say what works and is probably not meant, where motion is concerned above all
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
        /// A name of an axis, the first one is number 1: variables of type AXIS_REF with that name begin as it
        #[arg(long, value_name = "NAME")]
        axis: Vec<String>,
    },
}

/// What `cam` does.
#[derive(Debug, Subcommand)]
pub enum Cam {
    /// Say whether a slave can go along a cam, and how fast its master may be
    Check(CamCheckArguments),
    /// Draw a cam and its derivatives by the master
    Plot {
        /// The table: a CSV file, or SCRIPT.scan.json#TABLE; `-` is standard input
        #[arg(value_name = "FILE")]
        file: PathBuf,
        /// Write the picture to this file
        #[arg(long, value_name = "OUT.svg")]
        svg: PathBuf,
        /// Behind its last row the cam goes on as at its first
        #[arg(long)]
        periodic: bool,
        /// Files beside those of the script's folder
        #[command(flatten)]
        outside: Outside,
    },
    /// Write the rows of a law from rest to rest, as CSV
    Law(CamLawArguments),
}

/// What `cam check` takes.
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
    /// Behind its last row the cam goes on as at its first
    #[arg(long)]
    pub periodic: bool,
    /// The cam begins where the slave is (selected without SlaveAbsolute): software limits don't tell
    #[arg(long)]
    pub relative: bool,
    /// As one JSON object
    #[arg(long)]
    pub json: bool,
    /// Files beside those of the machine file's folder
    #[command(flatten)]
    pub outside: Outside,
}

/// What `cam law` takes.
#[derive(Args, Debug)]
pub struct CamLawArguments {
    /// The law
    #[arg(value_enum, value_name = "LAW")]
    pub law: CamLaw,
    /// Way of the slave, below 0 for the way back
    #[arg(long, value_name = "Y", allow_negative_numbers = true)]
    pub lift: f64,
    /// Way of the master
    #[arg(long, value_name = "U", allow_negative_numbers = true)]
    pub width: f64,
    /// First place of the master
    #[arg(long, value_name = "U", allow_negative_numbers = true, default_value_t = 0.0)]
    pub begin: f64,
    /// First place of the slave
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
    /// Understand names and numbers of this system, too: codesys, twincat or omron
    #[arg(long, value_name = "NAME")]
    pub dialect: Option<String>,
    /// The PROGRAM to run in every scan, if neither a CONFIGURATION says nor there is only one
    #[arg(long, value_name = "NAME")]
    pub program: Option<String>,
}

/// What `mcp` takes.
#[derive(Args, Debug)]
pub struct McpArguments {
    /// The folder whose scripts and traces may be read; nothing outside it is
    #[arg(value_name = "FOLDER", default_value = ".")]
    pub folder: PathBuf,
    /// Let calls write pages, pictures and traces into this folder; without it nothing is written
    #[arg(long, value_name = "FOLDER")]
    pub write: Option<PathBuf>,
    /// End a call after this time
    #[arg(long, value_name = "TIME", value_parser = period, default_value = "30s")]
    pub call_time: u64,
    /// Let a call have so much memory, such as 256MiB (Linux)
    #[arg(long, value_name = "SIZE", value_parser = size, default_value = "1GiB")]
    pub call_memory: u64,
}

/// Where `soak blocks` writes failing programs.
const FAILURES: &str = "soak-failures";

/// Where the scripts of a repository stand.
pub const SCRIPTS: &str = "scan-tests";

/// What `run` takes.
#[derive(Args, Debug)]
pub struct RunArguments {
    /// The scripts, run in this order; or the files of one program in Structured Text
    #[arg(value_name = "SCRIPT", required = true)]
    pub scripts: Vec<PathBuf>,
    /// The machine file with the axes of a program in Structured Text
    #[arg(long, value_name = "MACHINE.json")]
    pub axes: Option<PathBuf>,
    /// Of such a program: the PROGRAM that runs
    #[arg(long, value_name = "NAME")]
    pub program: Option<String>,
    /// Of such a program: the length of a scan; T#1ms if absent
    #[arg(long, value_name = "TIME", value_parser = cycle)]
    pub cycle: Option<i64>,
    /// Of such a program: how many scans; 1000 if absent
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    pub scans: Option<u64>,
    /// Write the trace to this file; its ending says how
    #[arg(long, value_name = "FILE(.csv|.jsonl)")]
    pub trace: Option<PathBuf>,
    /// What stands between the cells of a CSV trace: `,` `;` `|` or `tab`
    #[arg(long, value_name = "CHARACTER", value_parser = delimiter, requires = "trace")]
    pub delimiter: Option<char>,
    /// Write numbers of a CSV trace with a decimal comma; cells then stand between `;` unless told otherwise
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
    /// Files beside those of the script's folder
    #[command(flatten)]
    pub outside: Outside,
    /// Print failing claims and one line a script
    #[arg(long, short)]
    pub quiet: bool,
    /// Print the outcome as one JSON object
    #[arg(long, conflicts_with = "quiet")]
    pub json: bool,
}

/// What `sweep` takes.
#[derive(Args, Debug)]
pub struct SweepArguments {
    /// What varies, and what is taken of every run
    #[arg(value_name = "SWEEP.json")]
    pub sweep: PathBuf,
    /// Write the table to this file, and go on from what an interrupted run left in FILE.csv.part
    #[arg(long, short, value_name = "FILE.csv")]
    pub output: Option<PathBuf>,
    /// Compute every N-th case only, beginning with the I-th
    #[cfg(feature = "sweep")]
    #[arg(long, value_name = "I/N", default_value_t = Shard::ALL, conflicts_with = "merge")]
    pub shard: Shard,
    /// Compute on so many threads instead of on all processors
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), conflicts_with = "merge")]
    pub threads: Option<u16>,
    /// Compute nothing: put the tables of all shards together
    #[arg(long, value_name = "SHARD.csv", num_args = 1..)]
    pub merge: Vec<PathBuf>,
    /// Files beside those of the script's folder
    #[command(flatten)]
    pub outside: Outside,
}

/// What `watch` takes.
#[derive(Args, Debug)]
pub struct WatchArguments {
    /// The script
    #[arg(value_name = "SCRIPT")]
    pub script: PathBuf,
    /// Replace the value of a parameter of the script
    #[arg(long, value_name = "NAME=VALUE", value_parser = parameter)]
    pub set: Vec<(String, f64)>,
    /// Files beside those of the script's folder
    #[command(flatten)]
    pub outside: Outside,
}

/// What `serve` takes.
#[derive(Args, Debug)]
pub struct ServeArguments {
    /// The folder with the scripts [default: scan-tests, or this folder where there is none]
    #[arg(value_name = "FOLDER")]
    pub folder: Option<PathBuf>,
    /// The port, of the loopback address; 0 takes one that is free
    #[arg(long, value_name = "N", default_value_t = 7480)]
    pub port: u16,
    /// The page, as `bash .ci/site` builds it [default: target/site, or `site` beside the program]
    #[arg(long, value_name = "FOLDER")]
    pub site: Option<PathBuf>,
    /// Let scripts read files (machine files, programs) from this folder, too
    #[arg(long, value_name = "FOLDER")]
    pub include_from: Vec<PathBuf>,
}

/// What `live` takes.
#[derive(Args, Debug)]
pub struct LiveArguments {
    /// The script
    #[arg(value_name = "SCRIPT")]
    pub script: PathBuf,
    /// Time between two scans, which must be the cycle of the script
    #[arg(long, value_name = "TIME", value_parser = period)]
    pub period: u64,
    /// Write the trace to this file; its ending says how
    #[arg(long, value_name = "FILE(.csv|.jsonl)")]
    pub trace: Option<PathBuf>,
    /// Write when scans began and how long they took to this file
    #[arg(long, value_name = "FILE.json")]
    pub timing: Option<PathBuf>,
    /// What to do when a scan is not over before the next one is due
    #[arg(long, value_enum, value_name = "WHAT", default_value_t = OnOverrun::Continue)]
    pub on_overrun: OnOverrun,
    /// Replace the value of a parameter of the script
    #[arg(long, value_name = "NAME=VALUE", value_parser = parameter)]
    pub set: Vec<(String, f64)>,
    /// Files beside those of the script's folder
    #[command(flatten)]
    pub outside: Outside,
}

/// What an overrun of `live` leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum OnOverrun {
    /// Count it, and skip the periods that have passed
    Continue,
    /// Stop the programs; the axes stop and switch off
    Stop,
}

/// What scripts may do beyond what any script may.
#[derive(Args, Debug)]
pub struct Outside {
    /// Let scripts read files (machine files, programs) from this folder, too
    #[arg(long, value_name = "FOLDER")]
    include_from: Vec<PathBuf>,
    /// Let scripts read files from anywhere
    #[arg(long)]
    allow_outside: bool,
    /// Let the guest programs of a script have so much memory in all, such as 256MiB
    #[arg(long, value_name = "SIZE", value_parser = size, default_value = "64MiB")]
    guest_memory: u64,
}

impl Outside {
    /// What scripts may do beyond what any script may.
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

/// What is looked at for a swing.
#[derive(Debug, clap::Args)]
pub struct IdentifyArguments {
    /// The trace (.csv, .jsonl, .exact), or with --time the recording of a machine (CSV)
    pub trace: PathBuf,
    /// The column that swings [default: of each axis ActualPosition - Position, in the longest rest of the set-point after a
    /// motion]
    #[arg(long, value_name = "NAME")]
    pub signal: Option<String>,
    /// Look at nothing before this time
    #[arg(long, value_name = "TIME", value_parser = period)]
    pub from: Option<u64>,
    /// Look at nothing after this time
    #[arg(long, value_name = "TIME", value_parser = period)]
    pub to: Option<u64>,
    /// It is a recording, whose times stand in this column
    #[arg(long, value_name = "NAME", requires = "signal")]
    pub time: Option<String>,
    /// What these times count
    #[arg(long, value_enum, default_value_t = TimeUnit::Seconds, requires = "time")]
    pub unit: TimeUnit,
    /// As one JSON object
    #[arg(long)]
    pub json: bool,
}

impl IdentifyArguments {
    /// The times (ns) that are looked at, first and last.
    pub fn window(&self) -> (i64, i64) {
        let ns =
            |time: Option<u64>, absent| time.map_or(absent, |time| i64::try_from(time).unwrap_or(i64::MAX));
        (ns(self.from, 0), ns(self.to, i64::MAX))
    }
}

/// What the times of a recording count.
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
