//! The program `standstill`: arguments, exit statuses, printing. The contents come from the libraries.
//!
//! Standard output is the same on every machine; messages and progress go to standard error. The library
//! beside the program lets a fuzzer and a page call the reader of plan lines.
#![forbid(unsafe_code)]

mod apart;
mod args;
mod blocks;
mod cam;
mod compare;
mod cores;
mod coverage;
mod errors;
pub mod exit;
mod explain;
mod export;
mod failing;
mod fmt;
mod identify;
mod init;
mod json;
mod junit;
mod limit;
#[cfg(feature = "live")]
mod live;
mod long;
#[cfg(feature = "lsp")]
mod lsp;
#[cfg(feature = "mcp")]
mod mcp;
mod mutate;
mod out;
mod outcome;
#[cfg(feature = "pages")]
mod pages;
mod paint;
pub mod plan;
mod progress;
mod report;
mod run;
mod saved;
#[cfg(feature = "serve")]
mod serve;
#[cfg(feature = "soak")]
mod soak;
#[cfg(feature = "st")]
mod st;
mod suggest;
#[cfg(feature = "sweep")]
mod sweep;
mod table;
mod test;
#[cfg(feature = "watch")]
mod watch;

pub use run::verdict;

#[cfg(feature = "soak")]
use args::Soak;
#[cfg(feature = "st")]
use args::St;
use args::{Arguments, Cam, Command, Schema};
use clap::{ArgMatches, CommandFactory, FromArgMatches};
use exit::{Exit, Failure};
use out::Out;
use standstill_script::suite::shown;
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufRead, BufReader, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

/// The program: takes the arguments of the process, and returns its exit status.
pub fn main() -> ExitCode {
    outlive_a_limit_on_files();
    status_of(std::env::args_os()).into()
}

/// A file that would exceed the system's size limit becomes an error of the write, which is reported. Otherwise it
/// would end the program.
fn outlive_a_limit_on_files() {
    #[cfg(all(unix, feature = "signals"))]
    {
        // On a system without this signal, such a file ends the program.
        let _ = signal_hook::flag::register(signal_hook::consts::signal::SIGXFSZ, std::sync::Arc::default());
    }
}

/// Runs the program with these arguments, the first of which is its name, and returns its exit status. It
/// may end the process itself, as `--time-limit` does.
pub fn status_of(arguments: impl IntoIterator<Item = OsString>) -> Exit {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    exit::guarded(|| program(&arguments))
}

fn program(arguments: &[OsString]) -> Exit {
    let given = arguments;
    let parsed = Arguments::command().try_get_matches_from(given);
    let parsed = parsed.and_then(|matches| Ok((as_json(&matches), Arguments::from_arg_matches(&matches)?)));
    let (as_json, arguments) = match parsed {
        Ok(parsed) => parsed,
        Err(error) => return explained(&error, given),
    };
    let limit = arguments.time_limit;
    if let Some(Err(failure)) = limit.map(|limit| limit::start(limit, as_json.clone())) {
        return failure.report();
    }
    limit::doing("reading the arguments");
    let mut out = if as_json.is_some() || is_data(&arguments.command) {
        Out::data()
    } else {
        Out::text()
    };
    let mut result = dispatch(&arguments.command, &mut out);
    if let (Some(command), Err(Failure::Told(exit, text))) = (as_json, &result)
        && let Err(error) = writeln!(out, "{}", outcome::refused(&command, *exit, text))
    {
        result = Err(error.into());
    }
    // Text printed before must come before the message that follows from it.
    let flushed = out.flush().map_err(Failure::from);
    match result.and_then(|exit| flushed.map(|()| exit)) {
        Ok(exit) => exit,
        Err(failure) => failure.report(),
    }
}

/// The name of the command given, if it answers with JSON.
fn as_json(arguments: &ArgMatches) -> Option<String> {
    let (mut names, mut given) = (Vec::new(), arguments);
    while let Some((name, below)) = given.subcommand() {
        names.push(name);
        given = below;
    }
    // Of a command without --json that is an error.
    let is_wanted = given.try_get_one("json").ok().flatten() == Some(&true);
    is_wanted.then(|| names.join(" "))
}

/// The same for arguments that do not parse.
fn json_of(arguments: &[OsString]) -> Option<String> {
    let all = Arguments::command();
    let (mut names, mut command) = (Vec::new(), &all);
    for word in arguments.iter().skip(1) {
        if let Some(below) = command.find_subcommand(word) {
            names.push(below.get_name());
            command = below;
        }
    }
    let has_json = command
        .get_arguments()
        .any(|argument| argument.get_long() == Some("json"));
    let is_wanted = has_json && arguments.iter().any(|word| word == "--json");
    is_wanted.then(|| names.join(" "))
}

/// Whether the output of a command is for programs, also without --json.
fn is_data(command: &Command) -> bool {
    match command {
        Command::Plan { .. }
        | Command::ComparePlanners { .. }
        | Command::Sweep(_)
        | Command::Blocks { .. }
        | Command::Completions { .. }
        | Command::Schema { .. } => true,
        Command::Fmt { paths, .. } => paths.iter().any(|path| is_standard(path)),
        Command::Cam { what } => matches!(what, Cam::Law(_)),
        Command::Run(_)
        | Command::Test(_)
        | Command::Explain { .. }
        | Command::Identify(_)
        | Command::St { .. }
        | Command::Live(_)
        | Command::Watch(_)
        | Command::Serve(_)
        | Command::Lsp { .. }
        | Command::Mcp(_)
        | Command::Report { .. }
        | Command::Compare { .. }
        | Command::Init { .. }
        | Command::ExplainError { .. }
        | Command::Man { .. }
        | Command::Soak { .. }
        | Command::Export { .. } => false,
    }
}

/// Prints clap's text: help and version on standard output, mistakes on standard error.
fn explained(error: &clap::Error, arguments: &[OsString]) -> Exit {
    if error.use_stderr()
        && let Some(command) = json_of(arguments)
    {
        let text = error.render().to_string();
        // Its reader may be gone; the status is that of the mistake.
        let _ = writeln!(io::stdout(), "{}", outcome::refused(&command, Exit::Usage, &text));
    }
    match error.print() {
        // An error remains an error even if its message has no reader.
        _ if error.use_stderr() => Exit::Usage,
        Ok(()) => Exit::Passed,
        Err(error) => Failure::from(error).report(),
    }
}

fn dispatch(command: &Command, out: &mut dyn Write) -> Result<Exit, Failure> {
    match command {
        Command::Run(arguments) => run::run(arguments, out),
        #[cfg(feature = "live")]
        Command::Live(arguments) => live::live(arguments, out),
        #[cfg(feature = "watch")]
        Command::Watch(arguments) => watch::watch(arguments, out),
        #[cfg(feature = "serve")]
        Command::Serve(arguments) => serve::serve(arguments),
        #[cfg(not(feature = "serve"))]
        Command::Serve(_) => Err(Failure::left_out("serve")),
        #[cfg(feature = "lsp")]
        Command::Lsp { dialect, .. } => lsp::lsp(dialect.as_deref()),
        #[cfg(not(feature = "lsp"))]
        Command::Lsp { .. } => Err(Failure::left_out("lsp")),
        #[cfg(feature = "mcp")]
        Command::Mcp(arguments) => mcp::mcp(arguments),
        #[cfg(not(feature = "mcp"))]
        Command::Mcp(_) => Err(Failure::left_out("mcp")),
        #[cfg(not(feature = "live"))]
        Command::Live(_) => Err(Failure::left_out("live")),
        #[cfg(not(feature = "watch"))]
        Command::Watch(_) => Err(Failure::left_out("watch")),
        Command::Test(arguments) => test::test(arguments, out),
        Command::Report {
            traces,
            output,
            svg,
            vcd,
        } => {
            let targets = report::Targets {
                html: output.as_deref(),
                svg: svg.as_deref(),
                vcd: vcd.as_deref(),
            };
            report::report(traces, targets)
        }
        Command::Explain {
            expected,
            found,
            json,
        } => explain::explain(expected, found, *json, out),
        Command::Compare {
            recording,
            trace,
            map,
        } => compare::compare(recording, trace, map, out),
        Command::Identify(arguments) => identify::identify(arguments, out),
        Command::Plan {
            file,
            samples,
            svg,
            report,
        } => {
            let file = file.as_deref().unwrap_or(Path::new("-"));
            let files = plan::Files {
                samples: samples.as_deref(),
                svg: svg.as_deref(),
                report: report.as_deref(),
            };
            let writes = [
                apart::written("--samples", samples.as_deref()),
                apart::written("--svg", svg.as_deref()),
                apart::written("--report", report.as_deref()),
            ];
            let reads = Some(file).filter(|file| !is_standard(file));
            apart::checked(&writes.concat(), reads)?;
            with_lines(file, |lines, name| plan::plan_to_files(lines, name, files, out))
        }
        Command::ComparePlanners { cases } => {
            with_lines(cases, |lines, name| plan::compare(lines, name, out))
        }
        #[cfg(feature = "sweep")]
        Command::Sweep(arguments) => sweep::sweep(arguments, out),
        #[cfg(not(feature = "sweep"))]
        Command::Sweep(_) => Err(Failure::left_out("sweep")),
        #[cfg(feature = "soak")]
        Command::Soak {
            what: Soak::Planner { seed, count, resume },
        } => soak::planner(*seed, *count, resume.as_deref(), out),
        #[cfg(feature = "soak")]
        Command::Soak {
            what:
                Soak::Blocks {
                    seed,
                    count,
                    resume,
                    failures,
                },
        } => soak::blocks(*seed, *count, resume.as_deref(), failures, out),
        #[cfg(not(feature = "soak"))]
        Command::Soak { .. } => Err(Failure::left_out("soak")),
        Command::Init { folder } => init::init(folder, out),
        Command::Cam { what } => cam::cam(what, out),
        Command::Blocks {
            error: Some(error), ..
        }
        | Command::ExplainError { error } => errors::explain(error, out),
        Command::Blocks {
            names, json: true, ..
        } => blocks::json(names, out),
        Command::Blocks { names, .. } => blocks::table(names, out),
        #[cfg(feature = "pages")]
        Command::Completions { shell } => pages::completions(*shell, out),
        #[cfg(feature = "pages")]
        Command::Man { folder } => pages::man(folder, out),
        #[cfg(not(feature = "pages"))]
        Command::Completions { .. } | Command::Man { .. } => Err(Failure::left_out("pages")),
        Command::Export {
            target,
            out: folder,
            prefix,
            dialect,
        } => export::export(*target, folder, prefix, dialect.as_deref(), out),
        #[cfg(not(feature = "st"))]
        Command::St { .. } => Err(Failure::left_out("st")),
        #[cfg(feature = "st")]
        Command::St {
            what: St::Check { sources, json },
        } => st::check(sources, *json, false, out),
        #[cfg(feature = "st")]
        Command::St {
            what: St::Lint { sources, json },
        } => st::check(sources, *json, true, out),
        #[cfg(feature = "st")]
        Command::St {
            what: St::Fmt { files, check },
        } => st::lay_out(files, *check, out),
        #[cfg(feature = "st")]
        Command::St {
            what:
                St::Build {
                    sources,
                    output,
                    axis,
                },
        } => st::build(sources, output, axis, out),
        Command::Schema { of } => {
            let text = match of {
                Schema::Script => standstill_script::schema(),
                Schema::Machine => standstill_script::machine_schema(),
                Schema::Map => standstill_script::map_schema(),
                Schema::Sweep => standstill_script::sweep_schema(),
                Schema::Json => outcome::schema(),
            };
            write!(out, "{text}")?;
            Ok(Exit::Passed)
        }
        Command::Fmt { paths, check } if paths.iter().all(|path| is_standard(path)) => {
            fmt::filter(*check, out)
        }
        Command::Fmt { paths, check } => fmt::files(paths, *check, out),
    }
}

/// Whether a path means standard input.
fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
}

/// Calls `command` with the lines of a file, or of standard input, and its name for messages.
fn with_lines(
    path: &Path,
    command: impl FnOnce(&mut dyn BufRead, &str) -> Result<Exit, Failure>,
) -> Result<Exit, Failure> {
    if is_standard(path) {
        limit::doing("reading standard input");
        return command(&mut standard_input(), "standard input");
    }
    let name = shown(path);
    limit::doing(format!("reading {name}"));
    let file = File::open(path).map_err(|error| Failure::io(&name, &error))?;
    command(&mut BufReader::new(file), &name)
}

/// Standard input. On a terminal a message says that the program waits for it.
fn standard_input() -> impl BufRead {
    if io::stdin().is_terminal() {
        exit::complain("reading from the terminal, one JSON object a line");
    }
    io::stdin().lock()
}
