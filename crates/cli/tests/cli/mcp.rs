//! `mcp` over pipes: requests and answers of a client, and refused ones.

use crate::support::{SCRIPT, command, fed, read, with_script, write};
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

/// A server and the pipes to it.
struct Client {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
    id: u64,
}

impl Client {
    fn of(folder: &Path, arguments: &[&str]) -> Self {
        let mut words = vec!["mcp"];
        words.extend(arguments);
        let mut command = command(&words);
        let piped = command
            .current_dir(folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        let mut child = piped.spawn().unwrap();
        let mut client = Self {
            input: child.stdin.take(),
            output: BufReader::new(child.stdout.take().unwrap()),
            child,
            id: 0,
        };
        let begun = client.ask(
            "initialize",
            json!({"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "test", "version": "1"}}),
        );
        assert_eq!(begun["serverInfo"]["name"], "standstill");
        assert_eq!(begun["serverInfo"]["version"], env!("CARGO_PKG_VERSION"));
        client.send(&json!({"jsonrpc": "2.0", "method": "notifications/initialized"}));
        client
    }

    fn send(&mut self, message: &Value) {
        writeln!(self.input.as_mut().unwrap(), "{message}").unwrap();
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.id += 1;
        self.send(&json!({"jsonrpc": "2.0", "id": self.id, "method": method, "params": params}));
        let mut line = String::new();
        self.output.read_line(&mut line).unwrap();
        let answer: Value = serde_json::from_str(&line).unwrap_or_else(|_| panic!("{line}"));
        assert_eq!(answer["id"], self.id, "{line}");
        answer["result"].clone()
    }

    /// The answer of a tool that could do its work.
    fn call(&mut self, tool: &str, arguments: Value) -> Value {
        let result = self.ask("tools/call", json!({"name": tool, "arguments": arguments}));
        assert_eq!(result["isError"], false, "{result}");
        result
            .get("structuredContent")
            .unwrap_or(&result["content"][0]["text"])
            .clone()
    }

    /// The message of a tool that could not do its work.
    fn refused(&mut self, tool: &str, arguments: Value) -> String {
        let result = self.ask("tools/call", json!({"name": tool, "arguments": arguments}));
        assert_eq!(result["isError"], true, "{result}");
        result["content"][0]["text"].as_str().unwrap().to_owned()
    }

    /// Disconnects the client; returns the status of the server.
    fn leave(mut self) -> Option<i32> {
        drop(self.input.take());
        self.child.wait().unwrap().code()
    }
}

#[test]
fn an_agent_checks_runs_explains_plans_and_looks_up() {
    let folder = with_script("mcp_tools");
    let mut client = Client::of(&folder, &[]);
    let tools = client.ask("tools/list", json!({}));
    let names: Vec<&str> = tools["tools"]
        .as_array()
        .unwrap()
        .iter()
        .map(|tool| tool["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["check", "run", "explain", "plan", "blocks", "errors"]);
    assert_eq!(tools["tools"][1]["annotations"]["readOnlyHint"], true);

    // Without a golden it fails, and none is proposed.
    let checked = client.call("check", json!({"path": "move.scan.json"}));
    assert_eq!(
        (&checked["passed"], &checked["scripts"][0]["golden"]["verdict"]),
        (&json!(false), &json!("failed"))
    );
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    // As text the claims decide.
    let script: Value = serde_json::from_str(SCRIPT).unwrap();
    let checked = client.call("check", json!({"script": script}));
    assert_eq!(
        (
            &checked["passed"],
            checked["scripts"][0]["claims"].as_array().unwrap().len()
        ),
        (&json!(true), 2)
    );
    let mistaken = client.call(
        "check",
        json!({"script": SCRIPT.replace("\"Velocity\"", "\"Velocty\"")}),
    );
    let error = mistaken["scripts"][0]["error"].as_str().unwrap();
    assert!(
        error.contains("script.scan.json:15:") && error.contains("Velocity"),
        "{error}"
    );

    let run = client.call(
        "run",
        json!({"path": "move.scan.json", "set": {"v": 5}, "signals": ["X.Position", "X.State"], "from": 0, "to": 20, "every": 10}),
    );
    assert_eq!(run["scripts"][0]["verdict"], "failed");
    assert_eq!(run["rows"]["columns"], json!(["scan", "X.Position", "X.State"]));
    assert_eq!(run["rows"]["rows"][0], json!([0, 0.0, "Standstill"]));
    assert_eq!(run["rows"]["rows"].as_array().unwrap().len(), 3);
    let unknown = client.refused("run", json!({"path": "move.scan.json", "signals": ["X.Positon"]}));
    assert_eq!(
        unknown,
        "there is no signal X.Positon; did you mean `X.Position`?"
    );

    let story = client.call(
        "explain",
        json!({"expected": "move.scan.json", "found": "move.scan.json", "set": {"v": 5}}),
    );
    let causes = story["story"]["causes"].to_string();
    assert!(
        causes.contains("move.Velocity is given 5.0 instead of 10.0"),
        "{causes}"
    );

    let planned = client.call(
        "plan",
        json!({"lines": [{"Ts": 0.001, "target": 0.02, "limits": {"velocity": 1, "acceleration": 20, "jerk": 2000}}, {"target": 1}]}),
    );
    assert_eq!(
        (
            &planned["answers"][0]["scans"],
            &planned["answers"][1]["error"]["field"]
        ),
        (&json!(75), &json!("Ts"))
    );

    let all = client.call("blocks", json!({}));
    let probe = all["blocks"]
        .as_array()
        .unwrap()
        .iter()
        .find(|block| block["name"] == "MC_TouchProbe")
        .unwrap();
    assert!(probe.get("inputs").is_none(), "{probe}");
    let one = client.call("blocks", json!({"names": ["mc_stop"]}));
    assert_eq!(one["blocks"][0]["in_outs"][0]["name"], "Axis");
    assert!(
        client
            .refused("blocks", json!({"names": ["MC_Stpo"]}))
            .contains("did you mean `MC_Stop`?")
    );
    for error in [json!(201), json!("NotPowered")] {
        assert!(
            client
                .call("errors", json!({"error": error}))
                .as_str()
                .unwrap()
                .starts_with("201 NotPowered\n")
        );
    }
    assert!(
        client.call("errors", json!({}))["errors"]
            .as_array()
            .unwrap()
            .len()
            > 50
    );

    assert!(
        client
            .refused("run", json!({"path": "move.scan.json", "sets": {}}))
            .starts_with("arguments of run: unknown field `sets`")
    );
    assert!(
        client
            .refused("run", json!({}))
            .contains("name a script by `path`")
    );
    assert!(
        client
            .refused("move", json!({}))
            .contains("there is no tool move")
    );
    // Nothing of all that was written.
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    assert_eq!(client.leave(), Some(0));
}

#[test]
fn nothing_is_read_or_written_outside_the_folders_that_are_named() {
    let outer = with_script("mcp_folders");
    fs::create_dir(outer.join("cell")).unwrap();
    fs::create_dir(outer.join("out")).unwrap();
    write(&outer, "cell/-in.scan.json", SCRIPT);
    let mut client = Client::of(&outer, &["cell"]);
    for path in [
        "../move.scan.json",
        outer.join("move.scan.json").to_str().unwrap(),
    ] {
        let refused = client.refused("run", json!({"path": path}));
        assert!(
            refused.contains("it is outside the folder of this server"),
            "{refused}"
        );
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../move.scan.json", outer.join("cell/link.scan.json")).unwrap();
        let refused = client.refused("check", json!({"path": "link.scan.json"}));
        assert!(
            refused.contains("it is outside the folder of this server"),
            "{refused}"
        );
        fs::remove_file(outer.join("cell/link.scan.json")).unwrap();
    }
    assert!(
        client
            .refused("check", json!({"path": "gone"}))
            .starts_with("gone: ")
    );
    // A name like an option is a name.
    assert_eq!(
        client.call("run", json!({"path": "-in.scan.json"}))["passed"],
        true
    );
    let refused = client.refused("run", json!({"path": "-in.scan.json", "report": "a.html"}));
    assert!(refused.contains("standstill mcp --write FOLDER"), "{refused}");
    client.leave();

    let mut client = Client::of(&outer, &["cell", "--write", "out"]);
    for name in ["../a.html", "/tmp/a.html", ".a.html", "b/a.html", ""] {
        let refused = client.refused("run", json!({"path": "-in.scan.json", "report": name}));
        assert!(refused.contains("under a plain name"), "{refused}");
    }
    let run = client.call(
        "run",
        json!({"path": "-in.scan.json", "report": "a.html", "trace": "a.csv"}),
    );
    assert_eq!(run["written"], json!(["a.html", "a.csv"]));
    assert!(read(&outer, "out/a.html").contains("</html>"));
    assert!(read(&outer, "out/a.csv").starts_with("scan,time_ns,X.State"));
    assert_eq!(fs::read_dir(outer.join("cell")).unwrap().count(), 1);
    client.leave();
    // A folder that is not there.
    let gone = fed(&["mcp", "/gone/away"], b"");
    assert_eq!(gone.status, 4);
    gone.complains_first("error: /gone/away: ");
}

#[test]
fn a_call_takes_no_more_than_it_may() {
    let folder = with_script("mcp_bounds");
    let long = SCRIPT.replace("\"scans\": 30", "\"scans\": 370000000");
    write(&folder, "long.scan.json", &long);
    let mut client = Client::of(&folder, &["--call-time", "1s"]);
    let refused = client.refused("run", json!({"path": "long.scan.json"}));
    assert!(refused.contains("the time is up; it was at "), "{refused}");
    // It continues to serve, and refuses more than fits.
    let lines: Vec<Value> = (0..1001).map(|_| json!({})).collect();
    assert!(
        client
            .refused("plan", json!({"lines": lines}))
            .contains("a call plans 1 to 1000")
    );
    assert_eq!(client.leave(), Some(0));
    #[cfg(target_os = "linux")]
    {
        // The largest number of scans of which all rows are kept. Constant signals take no memory, so many signals
        // change all the time.
        let reader = |number| {
            format!(
                r#"{{"name": "r{number}", "type": "MC_ReadActualPosition", "pins": {{"Axis": "X", "Enable": true}}}},"#
            )
        };
        let readers: String = (0..9).map(reader).collect();
        let kept = SCRIPT
            .replace("\"scans\": 30", "\"scans\": 1000000")
            .replace("\"Position\": 1,", "\"Position\": 1e6,")
            .replace("\"blocks\": [", &format!("\"blocks\": [{readers}"));
        write(&folder, "kept.scan.json", &kept);
        let mut client = Client::of(&folder, &["--call-memory", "64MiB", "--call-time", "5m"]);
        let refused = client.refused("run", json!({"path": "kept.scan.json"}));
        assert!(refused.contains("it was ended by the system"), "{refused}");
        assert_eq!(client.leave(), Some(0));
    }
    let mut client = Client::of(&folder, &["--call-time", "5m"]);
    write(
        &folder,
        "middle.scan.json",
        &SCRIPT.replace("\"scans\": 30", "\"scans\": 20000"),
    );
    let signals = json!(["X.Position", "X.Velocity", "X.Acceleration"]);
    let refused = client.refused("run", json!({"path": "middle.scan.json", "signals": signals}));
    assert!(
        refused.contains("ask for fewer signals, or for fewer scans"),
        "{refused}"
    );
    client.leave();
}

#[test]
fn a_client_that_does_not_keep_the_protocol_ends_it() {
    assert_eq!(fed(&["mcp"], b"").status, 0);
    let wrong = fed(
        &["mcp"],
        b"{\"jsonrpc\": \"2.0\", \"id\": 1, \"method\": \"tools/list\", \"params\": {}}\n",
    );
    assert!(matches!(wrong.status, 0 | 4), "{wrong:?}");
}
