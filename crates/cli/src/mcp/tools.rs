//! The tools: their names, their arguments, and their answers.

use super::bounded::{self, Said};
use super::place::Place;
use super::rows::{self, Wanted};
use crate::exit::{Exit, Failure};
use crate::{blocks, errors};
use rmcp::model::{JsonObject, Tool, ToolAnnotations};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};
use standstill_script::ErrorId;
use std::fs;
use std::io::Write;
use std::path::Path;

/// The answer of a tool.
#[derive(Debug)]
pub enum Answer {
    /// For people.
    Text(String),
    /// One object.
    Json(Value),
}

/// The name in messages of a script given as text.
const AS_TEXT: &str = "script.scan.json";

/// All tools, as a client lists them.
pub fn all(place: &Place) -> Vec<Tool> {
    let script = json!({
        "path": {"type": "string", "description": "A scan script (*.scan.json) in the server's folder"},
        "script": {"type": ["object", "string"], "description": "Instead of `path`: the script itself, as JSON. What it includes it names by absolute paths in the server's folder"},
        "set": {"type": "object", "additionalProperties": {"type": "number"}, "description": "Other values for the script's `parameters`"}
    });
    let check = json!({
        "path": {"type": "string", "description": "A scan script, a folder of them, or a file of Structured Text (.st) in the server's folder; the whole folder if absent"},
        "script": script["script"],
        "strict": {"type": "boolean", "description": "Fail for claims, steps and wires that test nothing, too"},
        "word": {"type": "string", "description": "Only scripts whose path has this in it"}
    });
    let mut run = script.clone();
    let more = json!({
        "signals": {"type": "array", "items": {"type": "string"}, "description": "Columns of the trace to answer with, such as X.Position, X.State or move.Done"},
        "from": {"type": "integer", "minimum": 0, "description": "First scan of these rows"},
        "to": {"type": "integer", "minimum": 0, "description": "Last scan of these rows"},
        "every": {"type": "integer", "minimum": 1, "description": "One row every so many scans"}
    });
    join(&mut run, more);
    if place.writes() {
        join(
            &mut run,
            json!({
                "report": {"type": "string", "description": "Write a page of the run under this name (.html)"},
                "svg": {"type": "string", "description": "Write a picture of the run under this name (.svg)"},
                "trace": {"type": "string", "description": "Write the trace under this name (.csv or .jsonl)"}
            }),
        );
    }
    let explain = json!({
        "expected": {"type": "string", "description": "A trace (.csv, .jsonl, .exact), or a script, which is run"},
        "found": {"type": "string", "description": "The other trace or script; may be the same script"},
        "set": {"type": "object", "additionalProperties": {"type": "number"}, "description": "Other values for the parameters of the script `found`"}
    });
    let plan = json!({
        "lines": {"type": "array", "minItems": 1, "maxItems": 1000, "items": {"type": "object"}, "description": "Each as a line of `standstill plan`: {\"Ts\": 0.001, \"target\": 0.02, \"limits\": {\"velocity\": 1, \"acceleration\": 20, \"jerk\": 2000}}, optionally id, method, position, velocity, acceleration, end_velocity"}
    });
    let blocks = json!({
        "names": {"type": "array", "items": {"type": "string"}, "description": "Blocks to tell of with all pins; without it all blocks are listed with a sentence each"}
    });
    let errors = json!({
        "error": {"type": ["integer", "string"], "description": "An ErrorID by number or name; without it all are listed"}
    });
    vec![
        tool(
            "check",
            "Judge scripts by their claims and goldens, and say every mistake in them with its place; check Structured Text",
            check,
            &[],
            false,
        ),
        tool(
            "run",
            "Run a script; answers claims, why one failed, warnings and, if asked for, rows of signals",
            run,
            &[],
            place.writes(),
        ),
        tool(
            "explain",
            "Say where two runs part, by how much, and what is likely behind it",
            explain,
            &["expected", "found"],
            false,
        ),
        tool(
            "plan",
            "Plan single moves without blocks: duration, segments, peaks, or why it is refused",
            plan,
            &["lines"],
            false,
        ),
        tool(
            "blocks",
            "Look up function blocks and their pins",
            blocks,
            &[],
            false,
        ),
        tool(
            "errors",
            "Look up what an ErrorID means and what to do about it",
            errors,
            &[],
            false,
        ),
    ]
}

fn join(object: &mut Value, more: Value) {
    if let (Value::Object(object), Value::Object(more)) = (object, more) {
        object.extend(more);
    }
}

fn tool(name: &'static str, says: &'static str, properties: Value, required: &[&str], writes: bool) -> Tool {
    let mut schema = JsonObject::new();
    schema.insert("type".to_owned(), json!("object"));
    schema.insert("properties".to_owned(), properties);
    schema.insert("required".to_owned(), json!(required));
    schema.insert("additionalProperties".to_owned(), json!(false));
    let about = ToolAnnotations::new()
        .read_only(!writes)
        .destructive(false)
        .open_world(false);
    Tool::new(name, says, schema).with_annotations(about)
}

/// Answers a call; an error is text for the caller.
pub async fn call(name: &str, arguments: Value, place: &Place) -> Result<Answer, String> {
    match name {
        "check" => check(asked(name, arguments)?, place).await,
        "run" => run(asked(name, arguments)?, place).await,
        "explain" => explain(asked(name, arguments)?, place).await,
        "plan" => plan(asked(name, arguments)?, place).await,
        "blocks" => look_up_blocks(&asked(name, arguments)?),
        "errors" => look_up_errors(asked(name, arguments)?),
        _ => Err(format!(
            "there is no tool {name}; there are check, run, explain, plan, blocks and errors"
        )),
    }
}

fn asked<T: DeserializeOwned>(name: &str, arguments: Value) -> Result<T, String> {
    serde_json::from_value(arguments).map_err(|error| format!("arguments of {name}: {error}"))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Check {
    path: Option<String>,
    script: Option<Value>,
    #[serde(default)]
    strict: bool,
    word: Option<String>,
}

async fn check(asked: Check, place: &Place) -> Result<Answer, String> {
    let mut command = arguments(&["test", "--json"]);
    if let Some(path) = &asked.path
        && asked.script.is_none()
        && Path::new(path).extension().is_some_and(|ending| ending == "st")
    {
        let command = line(&["st", "check", "--json"], &[place.readable(path)?]);
        return told(bounded::run(place, place.root(), &command, &[]).await?).map(Answer::Json);
    }
    if asked.strict {
        command.push("--strict".to_owned());
    }
    if let Some(word) = asked.word {
        command.extend(["-k".to_owned(), word]);
    }
    let whole_folder = || asked.script.is_none().then(|| ".".to_owned());
    let path = asked.path.or_else(whole_folder);
    let at = Script::of(path, asked.script, place)?;
    if at.is_text() {
        // It has no golden, and may state that it needs none.
        command.extend(arguments(&["--golden", "none"]));
    }
    told(at.run(place, command).await?).map(Answer::Json)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Run {
    path: Option<String>,
    script: Option<Value>,
    #[serde(default)]
    set: Map<String, Value>,
    #[serde(default)]
    signals: Vec<String>,
    #[serde(default)]
    from: u64,
    to: Option<u64>,
    every: Option<u64>,
    report: Option<String>,
    svg: Option<String>,
    trace: Option<String>,
}

async fn run(asked: Run, place: &Place) -> Result<Answer, String> {
    let mut command = arguments(&["run", "--json"]);
    command.extend(set(&asked.set)?);
    let mut written = Vec::new();
    for (option, name) in [
        ("--report", &asked.report),
        ("--svg", &asked.svg),
        ("--trace", &asked.trace),
    ] {
        if let Some(name) = name {
            command.push(format!("{option}={}", text(&place.writable(name)?)?));
            written.push(name.clone());
        }
    }
    let wanted = Wanted {
        signals: asked.signals,
        from: asked.from,
        to: asked.to,
        every: asked.every,
    };
    let scratch = scratch()?;
    let rows = scratch.path().join("rows.jsonl");
    if !wanted.signals.is_empty() {
        if asked.trace.is_some() {
            return Err("`signals` and `trace` are two traces: ask for one of them".to_owned());
        }
        command.push(format!("--trace={}", text(&rows)?));
    }
    let at = Script::of(asked.path, asked.script, place)?;
    let mut answer = told(at.run(place, command).await?)?;
    if !wanted.signals.is_empty() && rows.exists() {
        join(&mut answer, json!({"rows": rows::rows(&rows, &wanted)?}));
    }
    if !written.is_empty() {
        join(&mut answer, json!({"written": written}));
    }
    Ok(Answer::Json(answer))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Explain {
    expected: String,
    found: String,
    #[serde(default)]
    set: Map<String, Value>,
}

async fn explain(asked: Explain, place: &Place) -> Result<Answer, String> {
    let scratch = scratch()?;
    let none = Map::new();
    let target = |name| scratch.path().join(name);
    let expected = trace(&asked.expected, &none, &target("expected.jsonl"), place).await?;
    let found = trace(&asked.found, &asked.set, &target("found.jsonl"), place).await?;
    let command = line(&["explain", "--json"], &[expected, found]);
    let mut answer = told(bounded::run(place, place.root(), &command, &[]).await?)?;
    // The requested names, because the run used temporary files.
    join(
        &mut answer,
        json!({"expected": asked.expected, "found": asked.found}),
    );
    Ok(Answer::Json(answer))
}

/// The trace at a path, or that of the script at the path, which is then run.
async fn trace(
    path: &str,
    changes: &Map<String, Value>,
    target: &Path,
    place: &Place,
) -> Result<String, String> {
    let is_script = path.ends_with(standstill_script::suite::EXTENSION);
    if !is_script && !changes.is_empty() {
        return Err(format!("{path}: `set` is for a script"));
    }
    if !is_script {
        return place.readable(path);
    }
    let mut command = arguments(&["run", "--json"]);
    command.extend(set(changes)?);
    command.push(format!("--trace={}", text(target)?));
    // Claims may fail: the failure is the subject of the question.
    let ran = Script::of(Some(path.to_owned()), None, place)?
        .run(place, command)
        .await?;
    let ran = told(ran)?;
    if target.exists() {
        return text(target);
    }
    Err(match ran["scripts"][0]["error"].as_str() {
        Some(error) => error.to_owned(),
        None => format!("{path}: it has no trace"),
    })
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Plan {
    lines: Vec<Map<String, Value>>,
}

async fn plan(asked: Plan, place: &Place) -> Result<Answer, String> {
    const MOST: usize = 1000;
    if asked.lines.is_empty() || asked.lines.len() > MOST {
        return Err(format!(
            "`lines` has {} lines; a call plans 1 to {MOST}",
            asked.lines.len()
        ));
    }
    let lines: String = asked
        .lines
        .iter()
        .map(|line| format!("{}\n", Value::Object(line.clone())))
        .collect();
    let said = bounded::run(place, place.root(), &arguments(&["plan"]), lines.as_bytes()).await?;
    judged(&said)?;
    let answers: Result<Vec<Value>, _> = said.out.lines().map(serde_json::from_str).collect();
    let answers = answers.map_err(|error| format!("the program did not answer in JSON: {error}"))?;
    Ok(Answer::Json(json!({"answers": answers})))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Blocks {
    #[serde(default)]
    names: Vec<String>,
}

fn look_up_blocks(asked: &Blocks) -> Result<Answer, String> {
    let list = printed(|out| blocks::json(&asked.names, out))?;
    let mut list: Value = serde_json::from_str(&list).map_err(|error| error.to_string())?;
    if asked.names.is_empty() {
        let all = list.as_array_mut().into_iter().flatten();
        for block in all.filter_map(Value::as_object_mut) {
            block.retain(|key, _| matches!(key.as_str(), "name" | "group" | "doc"));
        }
    }
    Ok(Answer::Json(json!({"blocks": list})))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Errors {
    error: Option<Value>,
}

fn look_up_errors(asked: Errors) -> Result<Answer, String> {
    match asked.error {
        Some(Value::String(name)) => printed(|out| errors::explain(&name, out)).map(Answer::Text),
        Some(number) => printed(|out| errors::explain(&number.to_string(), out)).map(Answer::Text),
        None => {
            let all = ErrorId::ALL.iter();
            let all = all
                .map(|error| json!({"number": error.number(), "name": error.name(), "cause": error.cause()}));
            Ok(Answer::Json(json!({"errors": all.collect::<Vec<_>>()})))
        }
    }
}

/// The output of a command of this program that needs no file.
fn printed(command: impl FnOnce(&mut dyn Write) -> Result<Exit, Failure>) -> Result<String, String> {
    let mut out = Vec::new();
    match command(&mut out) {
        Ok(_) => Ok(String::from_utf8_lossy(&out).into_owned()),
        Err(Failure::Told(_, text)) => Err(text),
        Err(Failure::Output(error)) => Err(error.to_string()),
    }
}

/// A script of a call.
enum Script {
    /// A file in the folder.
    Path(String),
    /// A file from text, in a temporary folder that is removed with this value.
    Text(tempfile::TempDir),
}

impl Script {
    fn of(path: Option<String>, script: Option<Value>, place: &Place) -> Result<Self, String> {
        let text = match (path, script) {
            (Some(path), None) => return place.readable(&path).map(Self::Path),
            (None, Some(Value::String(text))) => text,
            (None, Some(script @ Value::Object(_))) => format!("{script:#}\n"),
            (None, Some(_)) => return Err("`script` is a JSON object, or its text".to_owned()),
            (Some(_), Some(_)) => return Err("`path` and `script` are two scripts: name one".to_owned()),
            (None, None) => return Err("name a script by `path`, or give one as `script`".to_owned()),
        };
        let folder = scratch()?;
        fs::write(folder.path().join(AS_TEXT), text).map_err(|error| format!("{AS_TEXT}: {error}"))?;
        Ok(Self::Text(folder))
    }

    const fn is_text(&self) -> bool {
        matches!(self, Self::Text(_))
    }

    /// Runs a command on it, with files of the server's folder at its disposal.
    async fn run(&self, place: &Place, mut command: Vec<String>) -> Result<Said, String> {
        command.push(format!("--include-from={}", text(place.root())?));
        let (folder, path) = match self {
            Self::Path(path) => (place.root(), path.as_str()),
            Self::Text(folder) => (folder.path(), AS_TEXT),
        };
        command.extend(["--".to_owned(), path.to_owned()]);
        bounded::run(place, folder, &command, &[]).await
    }
}

/// A folder for the time of a call.
fn scratch() -> Result<tempfile::TempDir, String> {
    tempfile::TempDir::with_prefix("standstill-").map_err(|error| format!("no folder for a call: {error}"))
}

fn text(path: &Path) -> Result<String, String> {
    let text = path.to_str().map(str::to_owned);
    text.ok_or_else(|| format!("{}: its name is not UTF-8", path.display()))
}

fn arguments(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

/// A command with files behind its options.
fn line(words: &[&str], files: &[String]) -> Vec<String> {
    let mut line = arguments(words);
    line.push("--".to_owned());
    line.extend_from_slice(files);
    line
}

fn set(values: &Map<String, Value>) -> Result<Vec<String>, String> {
    let one = |(name, value): (&String, &Value)| match value {
        Value::Number(number) => Ok(format!("--set={name}={number}")),
        other => Err(format!("`set`: {name} is {other}, and a parameter is a number")),
    };
    values.iter().map(one).collect()
}

/// Whether a command could do its work. A negative result is no failure of the call.
fn judged(said: &Said) -> Result<(), String> {
    let (passed, failed) = (i32::from(Exit::Passed as u8), i32::from(Exit::Failed as u8));
    match said.status {
        Some(status) if status == passed => Ok(()),
        // A time-out has the same status, and no text on standard output.
        Some(status) if status == failed && !said.out.is_empty() => Ok(()),
        Some(_) => Err(said.err.trim_end().to_owned()),
        None => Err(format!(
            "it was ended by the system, as one is that needs more memory than it may have\n{}",
            said.err.trim_end()
        )),
    }
}

/// The output of a command with `--json`. It is an error if the command could not run at all; failures of single
/// scripts are in the answer.
fn told(said: Said) -> Result<Value, String> {
    match serde_json::from_str::<Value>(&said.out) {
        Ok(value) => match value["error"].as_str() {
            Some(error) => Err(error.to_owned()),
            None => Ok(value),
        },
        Err(error) => {
            judged(&said)?;
            Err(format!("the program did not answer in JSON: {error}"))
        }
    }
}
