//! `lsp`: whole sessions of an editor over pipes, and inputs that are no session.

use crate::support::{command, scratch};
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

const VALVE: &str = "FUNCTION_BLOCK Valve
VAR_INPUT
  Open : BOOL; // opens it
END_VAR
END_FUNCTION_BLOCK
";

const CELL: &str = "PROGRAM Cell
VAR
  Feed : Valve; (* 😀 *) Count : INT;
  Mv : MC_MoveAbsolute;
  X : AXIS_REF;
END_VAR
Mv(Axis := X, Execute := Count > 3, Error => Feed.Open);
Feed();
END_PROGRAM
";

const SCRIPT: &str = r#"{
  "standstill": 1,
  "cycle": "T#1ms",
  "scans": 10,
  "axes": {"X": {"limits": {"velocity": 50, "acceleration": 200}}},
  "inputs": {"GO": false},
  "blocks": [
    {"name": "move", "type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": {"from": "GO"}, "Position": 1, "Velocity": 5}}
  ],
  "programs": {"cell": {"st": ["valve.st", "cell.st"]}},
  "steps": [{"at": 1, "set": {"GO": true}}],
  "expect": [{"never": {"cell.Count": 5}}, {"always": "=NOT move.Error OR cell.Count > 7"}]
}
"#;

/// An editor: the server, and the messages in both directions.
struct Editor {
    server: Child,
    to: Option<ChildStdin>,
    from: BufReader<ChildStdout>,
    folder: PathBuf,
    requests: i64,
}

impl Editor {
    fn started(folder: PathBuf, arguments: &[&str]) -> Self {
        let mut server = command(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        Self {
            to: server.stdin.take(),
            from: BufReader::new(server.stdout.take().unwrap()),
            server,
            folder,
            requests: 0,
        }
    }

    /// After the handshake, with these files beside each other.
    fn open(name: &str, files: &[(&str, &str)]) -> Self {
        let folder = scratch(name);
        for (name, text) in files {
            fs::write(folder.join(name), text).unwrap();
        }
        let folder = fs::canonicalize(folder).unwrap();
        let mut editor = Self::started(folder, &["lsp", "--stdio"]);
        let capabilities = editor.ask(
            "initialize",
            json!({"capabilities": {}, "processId": null, "rootUri": null}),
        );
        assert_eq!(capabilities["capabilities"]["hoverProvider"], true);
        assert_eq!(capabilities["serverInfo"]["name"], "standstill");
        editor.tell("initialized", json!({}));
        editor
    }

    fn raw(&mut self, bytes: &[u8]) {
        let to = self.to.as_mut().unwrap();
        to.write_all(bytes).unwrap();
        to.flush().unwrap();
    }

    fn send(&mut self, message: &Value) {
        let text = message.to_string();
        self.raw(format!("Content-Length: {}\r\n\r\n{text}", text.len()).as_bytes());
    }

    fn receive(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(self.from.read_line(&mut line).unwrap() > 0, "the server has gone");
            match line.trim().split_once(": ") {
                Some((_, value)) => length = value.parse().unwrap(),
                None => break,
            }
        }
        let mut bytes = vec![0; length];
        self.from.read_exact(&mut bytes).unwrap();
        serde_json::from_slice(&bytes).unwrap()
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({"jsonrpc": "2.0", "method": method, "params": params}));
    }

    /// The answer to a request; other messages before it are skipped.
    fn answer(&mut self, method: &str, params: Value) -> Value {
        self.requests += 1;
        let id = self.requests;
        self.send(&json!({"jsonrpc": "2.0", "id": id, "method": method, "params": params}));
        loop {
            let message = self.receive();
            if message["id"] == id {
                return message;
            }
        }
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        let answer = self.answer(method, params);
        assert!(answer.get("error").is_none(), "{answer}");
        answer["result"].clone()
    }

    fn refused(&mut self, method: &str, params: Value) -> i64 {
        self.answer(method, params)["error"]["code"].as_i64().unwrap()
    }

    fn uri(&self, name: &str) -> String {
        format!("file://{}", self.folder.join(name).display())
    }

    fn did_open(&mut self, name: &str, text: &str) {
        let uri = self.uri(name);
        self.tell(
            "textDocument/didOpen",
            json!({"textDocument": {"uri": uri, "languageId": "x", "version": 1, "text": text}}),
        );
    }

    fn did_change(&mut self, name: &str, version: i32, text: &str) {
        let uri = self.uri(name);
        self.tell(
            "textDocument/didChange",
            json!({"textDocument": {"uri": uri, "version": version}, "contentChanges": [{"text": text}]}),
        );
    }

    /// The next published diagnostics of a document: first lines, columns and messages.
    fn diagnostics(&mut self, name: &str) -> Vec<(u64, u64, String)> {
        let uri = self.uri(name);
        loop {
            let message = self.receive();
            let params = &message["params"];
            if message["method"] == "textDocument/publishDiagnostics" && params["uri"] == uri {
                let each = params["diagnostics"].as_array().unwrap().iter();
                return each
                    .map(|it| {
                        let start = &it["range"]["start"];
                        (
                            start["line"].as_u64().unwrap(),
                            start["character"].as_u64().unwrap(),
                            it["message"].as_str().unwrap().to_owned(),
                        )
                    })
                    .collect();
            }
        }
    }

    /// Sends a request for the mark in a text, which becomes the document's text.
    fn at(&mut self, method: &str, name: &str, marked: &str) -> Value {
        let at = marked.find('|').expect("a mark");
        let text = marked.replacen('|', "", 1);
        let before = &marked[..at];
        let line = before.matches('\n').count();
        let column = before.rsplit('\n').next().unwrap().encode_utf16().count();
        self.did_change(name, 2, &text);
        let uri = self.uri(name);
        self.ask(
            method,
            json!({"textDocument": {"uri": uri}, "position": {"line": line, "character": column}}),
        )
    }

    fn labels(&mut self, name: &str, marked: &str) -> Vec<String> {
        let found = self.at("textDocument/completion", name, marked);
        let items = found.as_array().unwrap().iter();
        items.map(|it| it["label"].as_str().unwrap().to_owned()).collect()
    }

    fn hover(&mut self, name: &str, marked: &str) -> String {
        let found = self.at("textDocument/hover", name, marked);
        found["contents"]["value"].as_str().unwrap_or_default().to_owned()
    }

    /// The file and the line, from 0, to which a definition leads.
    fn definition(&mut self, name: &str, marked: &str) -> (String, u64) {
        let found = self.at("textDocument/definition", name, marked);
        let path = found["uri"].as_str().unwrap_or_default().to_owned();
        let name = Path::new(&path).file_name().unwrap_or_default();
        (
            name.to_string_lossy().into_owned(),
            found["range"]["start"]["line"].as_u64().unwrap_or(99),
        )
    }

    /// Ends the session; returns the status and the text on standard error.
    fn end(mut self) -> (i32, String) {
        drop(self.to.take());
        let mut rest = Vec::new();
        self.from.read_to_end(&mut rest).unwrap();
        let ended = self.server.wait_with_output().unwrap();
        (
            ended.status.code().unwrap(),
            String::from_utf8(ended.stderr).unwrap(),
        )
    }

    fn shut_down(mut self) {
        assert_eq!(self.ask("shutdown", Value::Null), Value::Null);
        self.tell("exit", Value::Null);
        assert_eq!(self.end(), (0, String::new()));
    }
}

#[test]
fn a_program_is_checked_as_it_is_typed() {
    let mut editor = Editor::open("lsp_text", &[("valve.st", VALVE), ("cell.st", CELL)]);
    editor.did_open("cell.st", CELL);
    assert_eq!(editor.diagnostics("cell.st"), []);
    // In UTF-16 the column of `Count` is 25: the emoji is two units, four bytes, one character.
    editor.did_change("cell.st", 2, &CELL.replace("Count : INT", "Count : ITN"));
    let wrong = editor.diagnostics("cell.st");
    assert_eq!((wrong.len(), wrong[0].0, wrong[0].1), (1, 2, 33), "{wrong:?}");
    assert!(
        wrong[0].2.contains("there is no type or function block `ITN`")
            && wrong[0].2.contains("did you mean `INT`?"),
        "{wrong:?}"
    );
    editor.did_change("cell.st", 3, &CELL.replace("Count > 3,", "Count = 3;"));
    assert!(!editor.diagnostics("cell.st").is_empty());
    // A lint is a warning.
    editor.did_change("cell.st", 4, &CELL.replace("Count > 3", "TRUE"));
    let lint = editor.diagnostics("cell.st");
    assert!(
        lint.iter()
            .any(|it| it.0 == 6 && it.2.contains("Execute is always TRUE")),
        "{lint:?}"
    );
    editor.did_change("cell.st", 5, CELL);
    assert_eq!(editor.diagnostics("cell.st"), []);
    editor.shut_down();
}

#[test]
fn names_of_a_program_are_told_found_and_offered() {
    let mut editor = Editor::open("lsp_names", &[("valve.st", VALVE), ("cell.st", CELL)]);
    editor.did_open("cell.st", CELL);
    let told = editor.hover("cell.st", &CELL.replace("> 3", "> 3 AND Feed.Op|en"));
    assert!(
        told.contains("Open : BOOL  // VAR_INPUT of Valve") && told.contains("opens it"),
        "{told}"
    );
    // Behind the emoji.
    let told = editor.hover("cell.st", &CELL.replace("Count : INT", "Co|unt : INT"));
    assert!(told.contains("Count : INT"), "{told}");
    let pin = editor.hover("cell.st", &CELL.replace("Execute", "Exe|cute"));
    assert!(pin.contains("Execute : BOOL"), "{pin}");
    assert_eq!(
        editor.definition("cell.st", &CELL.replace("Feed.Open", "Feed.Op|en")),
        ("valve.st".to_owned(), 2)
    );
    assert_eq!(
        editor.definition("cell.st", &CELL.replace("Feed : Valve", "Feed : Va|lve")),
        ("valve.st".to_owned(), 0)
    );
    assert_eq!(
        editor.labels("cell.st", &CELL.replace("Mv(Axis", "Feed.|\nMv(Axis")),
        ["Open"]
    );
    let pins = editor.labels(
        "cell.st",
        &CELL.replace("Execute := Count > 3, Error => Feed.Open);", "|"),
    );
    assert_eq!(pins[..3], ["Axis", "Execute", "ContinuousUpdate"], "{pins:?}");
    assert!(
        editor
            .labels("cell.st", &CELL.replace("Count : INT", "Count : |"))
            .contains(&"TON".to_owned())
    );
    // The offered text replaces the typed one.
    let found = editor.at(
        "textDocument/completion",
        "cell.st",
        &CELL.replace("Mv(Axis", "Cou|\nMv(Axis"),
    );
    let items = found.as_array().unwrap();
    let count = items.iter().find(|it| it["label"] == "Count").unwrap();
    assert_eq!(
        count["textEdit"],
        json!({"newText": "Count", "range": {"start": {"line": 6, "character": 0}, "end": {"line": 6, "character": 3}}})
    );
    let uri = editor.uri("cell.st");
    editor.did_change("cell.st", 9, &CELL.to_lowercase());
    let edits = editor.ask(
        "textDocument/formatting",
        json!({"textDocument": {"uri": uri}, "options": {"tabSize": 4, "insertSpaces": true}}),
    );
    assert!(
        edits[0]["newText"]
            .as_str()
            .unwrap()
            .starts_with("PROGRAM cell\nVAR\n")
    );
    editor.shut_down();
}

#[test]
fn a_script_is_served_with_the_programs_it_names() {
    let files = [("valve.st", VALVE), ("cell.st", CELL), ("a.scan.json", SCRIPT)];
    let mut editor = Editor::open("lsp_script", &files);
    editor.did_open("a.scan.json", SCRIPT);
    assert_eq!(editor.diagnostics("a.scan.json"), []);
    editor.did_change(
        "a.scan.json",
        2,
        &SCRIPT.replace("\"Velocity\": 5", "\"Velocty\": 5"),
    );
    let wrong = editor.diagnostics("a.scan.json");
    assert!(
        wrong
            .iter()
            .any(|it| it.0 == 7 && it.2.contains("Velocty") && it.2.contains("Velocity")),
        "{wrong:?}"
    );
    // A mistake in a program shows in the script, too, even one that is not saved.
    editor.did_change("a.scan.json", 3, SCRIPT);
    assert_eq!(editor.diagnostics("a.scan.json"), []);
    editor.did_open("cell.st", &CELL.replace("Count > 3", "Cont > 3"));
    let wrong = editor.diagnostics("a.scan.json");
    assert!(
        wrong[0].0 == 9 && wrong[0].2.contains("have a mistake"),
        "{wrong:?}"
    );
    editor.did_change("cell.st", 2, CELL);
    assert_eq!(editor.diagnostics("a.scan.json"), []);

    let pins = editor.labels("a.scan.json", &SCRIPT.replace("\"Velocity\": 5", "\"|\""));
    assert!(
        pins.contains(&"Jerk".to_owned()) && !pins.contains(&"Position".to_owned()),
        "{pins:?}"
    );
    let types = editor.labels("a.scan.json", &SCRIPT.replace("MC_MoveAbsolute", "MC_|"));
    assert!(types.contains(&"MC_GearIn".to_owned()));
    assert_eq!(
        editor.labels(
            "a.scan.json",
            &SCRIPT.replace("\"Axis\": \"X\"", "\"Axis\": \"|\"")
        ),
        ["X"]
    );
    let set = editor.labels(
        "a.scan.json",
        &SCRIPT.replace("\"set\": {\"GO\"", "\"set\": {\"|\""),
    );
    assert!(set.contains(&"GO".to_owned()) && set.contains(&"move.Velocity".to_owned()));
    assert!(!set.contains(&"move.Done".to_owned()) && !set.contains(&"X.Position".to_owned()));
    let signals = editor.labels(
        "a.scan.json",
        &SCRIPT.replace("\"never\": {\"cell.Count\"", "\"never\": {\"|\""),
    );
    for name in [
        "move.Done",
        "X.Position.d4",
        "cell.Count",
        "cell.Mv.Done",
        "cell.Feed.Open",
    ] {
        assert!(signals.contains(&name.to_owned()), "{name}");
    }
    let words = editor.labels("a.scan.json", &SCRIPT.replace("=NOT move.Error", "=NOT mo|"));
    assert!(words.contains(&"move.Error".to_owned()) && words.contains(&"Standstill".to_owned()));

    let told = editor.hover("a.scan.json", &SCRIPT.replace("move.Error OR", "move.Er|ror OR"));
    assert!(told.contains("move.Error : BOOL"), "{told}");
    let told = editor.hover(
        "a.scan.json",
        &SCRIPT.replace("\"cell.Count\": 5", "\"cell.Co|unt\": 5"),
    );
    assert!(told.contains("Count : INT"), "{told}");
    let told = editor.hover("a.scan.json", &SCRIPT.replace("\"Velocity\"", "\"Velo|city\""));
    assert!(told.contains("Unit: u/s"), "{told}");
    let told = editor.hover("a.scan.json", &SCRIPT.replace("\"scans\"", "\"sc|ans\""));
    assert!(told.contains("a whole number from 1 to 10000000"), "{told}");

    for (from, to, file, line) in [
        ("\"cell.Count\": 5", "\"cell.Co|unt\": 5", "cell.st", 2),
        ("cell.Count > 7", "cell.Cou|nt > 7", "cell.st", 2),
        ("{\"from\": \"GO\"}", "{\"from\": \"G|O\"}", "a.scan.json", 5),
        ("move.Error OR", "mo|ve.Error OR", "a.scan.json", 7),
        ("\"valve.st\"", "\"val|ve.st\"", "valve.st", 0),
        ("\"Axis\": \"X\"", "\"Axis\": \"|X\"", "a.scan.json", 4),
    ] {
        assert_eq!(
            editor.definition("a.scan.json", &SCRIPT.replace(from, to)),
            (file.to_owned(), line),
            "{to}"
        );
    }
    editor.shut_down();
}

#[test]
fn what_is_wrong_is_answered_and_the_session_goes_on() {
    let mut editor = Editor::started(fs::canonicalize(scratch("lsp_wrong")).unwrap(), &["lsp"]);
    assert_eq!(editor.refused("textDocument/hover", json!({})), -32002);
    editor.ask("initialize", json!({"capabilities": {}}));
    assert_eq!(editor.refused("initialize", json!({"capabilities": {}})), -32600);
    assert_eq!(editor.refused("textDocument/rename", json!({})), -32601);
    assert_eq!(
        editor.refused("textDocument/hover", json!({"position": "here"})),
        -32602
    );
    editor.raw(b"Content-Length: 5\r\n\r\n{nope");
    assert_eq!(editor.receive()["error"]["code"], -32700);
    editor.raw(b"Content-Length: 2\r\n\r\n[]");
    assert_eq!(editor.receive()["error"]["code"], -32600);
    editor.tell("textDocument/didChange", json!({"textDocument": 7}));
    editor.tell("$/unknown", json!({}));
    // The document is neither a file nor a known text.
    for uri in ["untitled:1", "file:///nowhere/at/all.st", "file:///x.txt"] {
        let at =
            json!({"textDocument": {"uri": uri}, "position": {"line": 4_000_000_000_u32, "character": 7}});
        for method in ["textDocument/hover", "textDocument/definition"] {
            assert_eq!(editor.ask(method, at.clone()), Value::Null, "{uri}");
        }
    }
    // More than the server reads: it reports this and continues.
    editor.did_open("huge.st", &"x".repeat(17 << 20));
    let message = editor.receive();
    assert_eq!(message["method"], "window/showMessage");
    assert!(
        message["params"]["message"]
            .as_str()
            .unwrap()
            .contains("17825792 bytes, more than the 16777216")
    );
    editor.did_open(
        "deep.st",
        &format!("PROGRAM P VAR a : INT; END_VAR a := {};", "(".repeat(100_000)),
    );
    assert!(!editor.diagnostics("deep.st").is_empty());
    editor.shut_down();
}

#[test]
fn an_end_without_goodbye_is_a_failure() {
    let mut editor = Editor::open("lsp_exit", &[]);
    editor.tell("exit", Value::Null);
    assert_eq!(editor.end().0, 1);
    let editor = Editor::open("lsp_closed", &[]);
    assert_eq!(editor.end().0, 1);
}

#[test]
fn what_is_no_frame_ends_the_session_with_a_message() {
    for (bytes, message) in [
        (
            &b"hello\r\n\r\n"[..],
            "where a header of the Language Server Protocol belongs",
        ),
        (
            b"Content-Length: 99999999999\r\n\r\n",
            "99999999999 bytes, more than",
        ),
        (b"Content-Length: 10\r\n\r\n{}", "standard input"),
    ] {
        let mut editor = Editor::open("lsp_frame", &[]);
        editor.raw(bytes);
        let (status, told) = editor.end();
        assert_eq!(status, 4);
        assert!(told.contains(message), "{told}");
    }
}
