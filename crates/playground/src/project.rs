//! A script with the files it names, and its faults.

use crate::bounds;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Deserialize;
use serde_json::{Value, json};
use standstill_script::model::{Script, Span};
use standstill_script::{Code, DIAGNOSTICS_SHOWN, ScriptError, read_with_programs};
use std::collections::BTreeMap;

/// The input of every function on a script.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Project {
    /// Name of the script, for messages and pages.
    name: String,
    /// Its text.
    text: String,
    /// The files it names, by their paths relative to it.
    #[serde(default)]
    files: BTreeMap<String, File>,
    /// The reasons why other files are missing.
    #[serde(default)]
    lacks: BTreeMap<String, String>,
    /// Values that replace its own parameters.
    #[serde(default)]
    set: BTreeMap<String, f64>,
}

/// A file that a script names.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum File {
    Text(String),
    /// Of a program that is no text.
    Bytes {
        base64: String,
    },
}

impl File {
    /// The number of bytes received.
    fn len(&self) -> usize {
        match self {
            Self::Text(text) | Self::Bytes { base64: text } => text.len(),
        }
    }

    fn text(&self) -> Result<String, String> {
        match self {
            Self::Text(text) => Ok(text.clone()),
            Self::Bytes { .. } => Err("it is no text".to_owned()),
        }
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        match self {
            Self::Text(text) => Ok(text.clone().into_bytes()),
            Self::Bytes { base64 } => STANDARD
                .decode(base64)
                .map_err(|_| "it came damaged: no base64".to_owned()),
        }
    }
}

impl Project {
    /// Reads a request.
    pub fn read(request: &str) -> Result<Self, Value> {
        let project: Self =
            serde_json::from_str(request).map_err(|error| refused(&format!("no project: {error}")))?;
        let texts = project.files.values().map(File::len).sum::<usize>();
        bounds::bytes(project.text.len().saturating_add(texts)).map_err(|why| refused(&why))?;
        Ok(project)
    }

    /// Name of the script.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The script.
    pub fn script(&self) -> Result<Script, Value> {
        let set: Vec<(String, f64)> = self
            .set
            .iter()
            .map(|(name, value)| (name.clone(), *value))
            .collect();
        let file = |path: &str| {
            let why = || self.lacks.get(path).map(String::as_str);
            let file = self.files.get(path);
            file.ok_or_else(|| why().unwrap_or("there is no such file here; add it").to_owned())
        };
        let script = read_with_programs(
            &self.text,
            &self.name,
            &set,
            &mut |path| file(path)?.text(),
            &mut |path| file(path)?.bytes(),
        );
        let script = script.map_err(|error| {
            if needs_guests(&error) {
                json!({"needs": "guests"})
            } else {
                wrong(&error)
            }
        })?;
        bounds::script(&script).map_err(|why| refused(&why))?;
        Ok(script)
    }
}

/// The faults of a script: `{"diagnostics": [..]}`, or `{"refused": ".."}`, or `{}`.
///
/// A diagnostic has `code`, `message`, `label`, `help`, `file`, and, if it refers to a place, `from` and
/// `to`: line and column from 1. Columns count characters. A build without guests answers
/// `{"needs": "guests"}` to a script that has some. Work: proportional to the text.
#[must_use]
pub fn check(request: &str) -> String {
    match Project::read(request).and_then(|project| project.script()) {
        Ok(_) => json!({}),
        Err(wrong) => wrong,
    }
    .to_string()
}

/// Whether the module with guests may read a script that this one cannot.
fn needs_guests(error: &ScriptError) -> bool {
    let mut codes = error.diagnostics().iter().map(|found| found.code);
    codes.any(|code| code == Code::NotBuilt)
}

/// The answer to a refused request.
pub fn refused(why: &str) -> Value {
    json!({"refused": why})
}

/// The answer to a script that cannot be read.
fn wrong(error: &ScriptError) -> Value {
    let place = |span: Span| {
        let end = Span {
            start: span.end,
            end: span.end,
        };
        let (from, to) = (error.line_column(span), error.line_column(end));
        json!({"file": error.file_of(span), "from": [from.0, from.1], "to": [to.0, to.1]})
    };
    let own = error.diagnostics().iter().take(DIAGNOSTICS_SHOWN).map(|found| {
        let mut told = found.span.map_or_else(|| json!({}), place);
        let related = found.related.as_deref().map(|(span, label)| {
            let mut related = place(*span);
            related["label"] = json!(label);
            related
        });
        told["code"] = json!(found.code.name());
        told["message"] = json!(found.message);
        told["label"] = json!(found.label);
        told["help"] = json!(found.help);
        told["related"] = json!(related);
        told
    });
    let programs = error.reports().iter().flat_map(|report| {
        report.diagnostics().iter().map(|found| {
            let (from, to) = report.positions(found.span);
            json!({
                "file": report.file_name(found.span),
                "from": [from.line, from.column],
                "to": [to.line, to.column],
                "code": found.code.name(),
                "message": found.message,
                "label": found.label,
                "help": found.help,
            })
        })
    });
    let diagnostics: Vec<Value> = own.chain(programs).collect();
    json!({"diagnostics": diagnostics})
}
