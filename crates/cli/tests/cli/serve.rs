//! `serve`: its answers over HTTP, and its refusals. A site of three small files replaces the page.

use crate::support::{SCRIPT, command, scratch, standstill, write};
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// The serving program; it is ended when this is dropped.
struct Served {
    child: Child,
    port: u16,
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The answer received.
#[derive(Debug)]
struct Got {
    status: u16,
    head: String,
    body: String,
}

impl Got {
    fn header(&self, name: &str) -> Option<&str> {
        let mut lines = self.head.lines().filter_map(|line| line.split_once(": "));
        lines.find_map(|(field, value)| field.eq_ignore_ascii_case(name).then_some(value))
    }

    fn json(&self) -> Value {
        assert_eq!(self.status, 200, "{}", self.body);
        assert_eq!(self.header("Content-Type"), Some("application/json"));
        serde_json::from_str(&self.body).expect("JSON")
    }
}

impl Served {
    fn new(folder: &Path, arguments: &[&str]) -> Self {
        let mut child = command(&["serve", "--port", "0", "--site", "site"])
            .args(arguments)
            .current_dir(folder)
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut line = String::new();
        let stderr = child.stderr.take().expect("a pipe");
        BufReader::new(stderr).read_line(&mut line).expect("a line");
        let port = line
            .split_once("http://127.0.0.1:")
            .and_then(|(_, rest)| rest.split_once('/'));
        let port = port.and_then(|(port, _)| port.parse().ok());
        let port = port.unwrap_or_else(|| panic!("no address in {line:?}"));
        Self { child, port }
    }

    /// Sends this text unchanged; returns the whole answer.
    fn send(&self, request: &str) -> Got {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("it listens");
        stream
            .set_read_timeout(Some(Duration::from_secs(20)))
            .expect("a time");
        stream.write_all(request.as_bytes()).expect("it reads");
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).expect("an answer");
        let text = String::from_utf8_lossy(&bytes);
        let (head, body) = text.split_once("\r\n\r\n").unwrap_or((&text, ""));
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok());
        Got {
            status: status.unwrap_or(0),
            head: head.to_owned(),
            body: body.to_owned(),
        }
    }

    fn ask(&self, method: &str, path: &str, more: &str) -> Got {
        let port = self.port;
        self.send(&format!(
            "{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n{more}\r\n"
        ))
    }

    fn get(&self, path: &str) -> Got {
        self.ask("GET", path, "")
    }
}

/// A folder with a small site in it.
fn with_site(name: &str) -> PathBuf {
    let folder = scratch(name);
    fs::create_dir_all(folder.join("site/playground")).expect("a folder");
    fs::create_dir_all(folder.join("cells")).expect("a folder");
    write(&folder, "site/playground/index.html", "<!doctype html>the page");
    write(&folder, "site/playground/a.wasm", "\0asm");
    write(
        &folder,
        "site/playground/scripts.json",
        r#"[{"group": "gallery", "label": "Gallery", "scripts": []}]"#,
    );
    write(&folder, "secret.txt", "a secret");
    write(&folder, "cells/move.scan.json", SCRIPT);
    folder
}

const MACHINE: &str = r#"{"standstill": 1, "axes": {"X": {"limits": {"velocity": 20, "acceleration": 100}, "state": "Standstill"}}}"#;
const INCLUDES: &str =
    r#"{"standstill": 1, "cycle": "T#10ms", "scans": 30, "include": "x.machine.json", "blocks": []}"#;

#[test]
fn the_page_and_the_scripts_of_the_folder_are_given_out() {
    let folder = with_site("serve_page");
    fs::create_dir_all(folder.join("cells/Ä b")).expect("a folder");
    write(&folder, "cells/Ä b/one.scan.json", INCLUDES);
    write(&folder, "cells/Ä b/x.machine.json", MACHINE);
    let served = Served::new(&folder, &["cells"]);
    let first = served.get("/");
    assert_eq!(
        (first.status, first.header("Location")),
        (302, Some("/playground/"))
    );
    assert_eq!(served.get("/playground").header("Location"), Some("/playground/"));
    let page = served.get("/playground/?script=move.scan.json");
    assert_eq!(
        (page.status, page.body.as_str()),
        (200, "<!doctype html>the page")
    );
    assert_eq!(page.header("Content-Type"), Some("text/html; charset=utf-8"));
    let module = served.get("/playground/a.wasm");
    assert_eq!(module.header("Content-Type"), Some("application/wasm"));
    assert_eq!(
        (module.header("Content-Length"), module.body.as_str()),
        (Some("4"), "\0asm")
    );
    let head = served.ask("HEAD", "/playground/a.wasm", "");
    assert_eq!((head.status, head.body.as_str()), (200, ""));
    let list = served.get("/playground/scripts.json").json();
    assert_eq!(
        (&list[0]["label"], &list[0]["served"]),
        (&"cells".into(), &true.into())
    );
    let names: Vec<_> = list[0]["scripts"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|one| &one["name"])
        .collect();
    assert_eq!(names, ["move.scan.json", "Ä b/one.scan.json"]);
    assert_eq!(list[1]["label"], "Gallery");
    let script = served.get("/folder/move.scan.json").json();
    assert_eq!(
        (&script["name"], &script["text"]),
        (&"move.scan.json".into(), &SCRIPT.into())
    );
    let with_files = served.get("/folder/%C3%84%20b/one.scan.json").json();
    assert_eq!(with_files["files"]["x.machine.json"], MACHINE);
}

#[test]
fn a_saved_file_is_another_answer_and_nothing_else_is() {
    let folder = with_site("serve_saved");
    write(&folder, "cells/one.scan.json", INCLUDES);
    let served = Served::new(&folder, &["cells"]);
    let ask = |tag: &str| {
        served.ask(
            "GET",
            "/folder/one.scan.json",
            &format!("If-None-Match: {tag}\r\n"),
        )
    };
    let missing = ask("\"none\"");
    let tag = missing.header("ETag").expect("a tag").to_owned();
    assert_eq!(missing.json()["lacks"]["x.machine.json"], "there is no such file");
    let same = ask(&tag);
    assert_eq!((same.status, same.body.as_str()), (304, ""));
    write(&folder, "cells/one.scan.json.bak", "beside it");
    assert_eq!(ask(&tag).status, 304);
    // A file that the script names is created, and changes.
    write(&folder, "cells/x.machine.json", MACHINE);
    let there = ask(&tag);
    assert_eq!(there.json()["files"]["x.machine.json"], MACHINE);
    let tag = there.header("ETag").expect("a tag").to_owned();
    write(&folder, "cells/x.machine.json", &MACHINE.replace("20", "200"));
    assert_eq!(ask(&tag).status, 200);
    fs::remove_file(folder.join("cells/one.scan.json")).expect("it was there");
    let gone = ask(&tag);
    assert_eq!(
        (gone.status, gone.body.trim()),
        (404, "one.scan.json: there is no such file")
    );
}

#[test]
fn other_names_of_this_machine_and_other_methods_are_refused() {
    let served = Served::new(&with_site("serve_names"), &["cells"]);
    let port = served.port;
    let get = |head: &str| {
        served.send(&format!(
            "GET /folder/move.scan.json HTTP/1.1\r\n{head}Connection: close\r\n\r\n"
        ))
    };
    for good in [
        format!("Host: localhost:{port}\r\n"),
        format!("Host: 127.0.0.1:{port}\r\n"),
    ] {
        assert_eq!(get(&good).status, 200, "{good}");
    }
    for wrong in [
        "Host: evil.example\r\n".to_owned(),
        format!("Host: evil.example:{port}\r\n"),
        format!("Host: localhost.evil.example:{port}\r\n"),
        "Host: 127.0.0.1\r\n".to_owned(),
        format!("Host: localhost:{port}\r\nHost: evil.example\r\n"),
        String::new(),
    ] {
        let got = get(&wrong);
        assert_eq!(got.status, 421, "{wrong}");
        assert!(got.body.contains("and no other name"), "{}", got.body);
    }
    for method in ["POST", "PUT", "DELETE", "OPTIONS", "PATCH"] {
        let got = served.ask(method, "/folder/move.scan.json", "Content-Length: 0\r\n");
        assert_eq!(got.status, 405, "{method}");
        assert!(got.body.contains("nothing is written"), "{}", got.body);
    }
    // Another page in the same browser can neither read an answer nor frame it.
    let got = served.ask("GET", "/folder/move.scan.json", "Origin: http://evil.example\r\n");
    assert_eq!(got.header("Access-Control-Allow-Origin"), None);
    assert_eq!(got.header("Cross-Origin-Resource-Policy"), Some("same-origin"));
    assert_eq!(got.header("X-Content-Type-Options"), Some("nosniff"));
    assert_eq!(
        got.header("Content-Security-Policy"),
        Some("frame-ancestors 'none'")
    );
}

#[test]
fn no_path_leads_out_of_the_folders() {
    let served = Served::new(&with_site("serve_paths"), &["cells"]);
    for path in [
        "/../secret.txt",
        "/playground/../../secret.txt",
        "/playground/%2e%2e/%2e%2e/secret.txt",
        "/playground/..%2f..%2fsecret.txt",
        "/playground/..%5c..%5csecret.txt",
        "/folder/../secret.txt",
        "/folder/%2e%2e/secret.txt",
        "/folder/%2e%2e/other/move.scan.json",
        "/folder//etc/x.scan.json",
        "/folder/%00.scan.json",
        "/folder/a%0d%0aSet-Cookie:x.scan.json",
        "/folder/c:move.scan.json",
        "/folder/secret.txt",
        "/folder/",
        "/folder/%ff.scan.json",
        "//etc/passwd",
        "/nothing/there.html",
    ] {
        let got = served.get(path);
        assert!((400..=404).contains(&got.status), "{path}: {got:?}");
        assert!(
            !got.body.contains("a secret") && got.header("Set-Cookie").is_none(),
            "{path}: {got:?}"
        );
        assert_eq!(
            got.header("Content-Type"),
            Some("text/plain; charset=utf-8"),
            "{path}"
        );
    }
    for odd in [
        "no request\r\n\r\n",
        "GET http://evil.example/ HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n",
        "GET / HTTP/7\r\n\r\n",
    ] {
        assert!(served.send(odd).status >= 400, "{odd}");
    }
    // It answers as before.
    assert_eq!(served.get("/playground/").status, 200);
}

#[test]
fn large_files_and_what_is_no_text_are_refused() {
    let folder = with_site("serve_large");
    write(&folder, "cells/large.scan.json", &" ".repeat((1 << 20) + 1));
    fs::write(folder.join("cells/latin.scan.json"), b"{\"title\": \"\xe4\"}").expect("a file");
    fs::write(folder.join("cells/p.wasm"), b"\0asm\x01\0\0\0").expect("a file");
    fs::write(folder.join("cells/q.st"), " ".repeat((1 << 20) + 1)).expect("a file");
    let programs = r#""programs": {"p": {"wasm": "p.wasm"}, "q": {"st": "q.st"}}, "cycle""#;
    write(
        &folder,
        "cells/guests.scan.json",
        &INCLUDES
            .replace("\"cycle\"", programs)
            .replace("x.machine", "../x.machine"),
    );
    write(&folder, "x.machine.json", MACHINE);
    let served = Served::new(&folder, &["cells"]);
    let large = served.get("/folder/large.scan.json");
    assert!(
        large.status == 413 && large.body.contains("more than the 1048576 bytes"),
        "{large:?}"
    );
    let latin = served.get("/folder/latin.scan.json");
    assert!(
        latin.status == 415 && latin.body.contains("save it as UTF-8"),
        "{latin:?}"
    );
    let guests = served.get("/folder/guests.scan.json").json();
    let outside = guests["lacks"]["../x.machine.json"].as_str();
    assert!(
        outside.is_some_and(|why| why.contains("outside the script's folder")),
        "{guests}"
    );
    drop(served);
    let served = Served::new(&folder, &["cells", "--include-from", "."]);
    let guests = served.get("/folder/guests.scan.json").json();
    assert_eq!(guests["files"]["p.wasm"]["base64"], "AGFzbQEAAAA=");
    assert_eq!(guests["files"]["../x.machine.json"], MACHINE);
    let large = guests["lacks"]["q.st"].as_str();
    assert!(
        large.is_some_and(|why| why.contains("`standstill run` takes it")),
        "{guests}"
    );
}

#[cfg(unix)]
#[test]
fn links_that_lead_out_and_pipes_are_refused() {
    use std::os::unix::fs::symlink;
    let folder = with_site("serve_links");
    write(&folder, "out.scan.json", SCRIPT);
    symlink(folder.join("out.scan.json"), folder.join("cells/out.scan.json")).expect("a link");
    symlink(
        folder.join("cells/move.scan.json"),
        folder.join("cells/in.scan.json"),
    )
    .expect("a link");
    symlink(&folder, folder.join("cells/up")).expect("a link");
    symlink(
        folder.join("secret.txt"),
        folder.join("site/playground/secret.txt"),
    )
    .expect("a link");
    symlink("loop.scan.json", folder.join("cells/loop.scan.json")).expect("a link");
    crate::support::fifo(&folder.join("cells/pipe.scan.json"));
    let served = Served::new(&folder, &["cells"]);
    for (path, why) in [
        ("/folder/out.scan.json", "it leads out of the folder"),
        ("/folder/up/out.scan.json", "it leads out of the folder"),
        ("/playground/secret.txt", "it leads out of the folder"),
        ("/folder/pipe.scan.json", "it is no regular file"),
    ] {
        let got = served.get(path);
        assert!(got.status == 403 && got.body.contains(why), "{path}: {got:?}");
    }
    assert!(served.get("/folder/loop.scan.json").status >= 400);
    assert_eq!(served.get("/folder/in.scan.json").json()["text"], SCRIPT);
    // Links and pipes are not listed.
    let list = served.get("/playground/scripts.json").json();
    assert_eq!(list[0]["scripts"].as_array().map(Vec::len), Some(1), "{list}");
}

#[test]
fn it_says_what_is_missing_before_it_serves() {
    let folder = with_site("serve_missing");
    let serve = |arguments: &[&str]| standstill(&folder, &[&["serve", "--port", "0"], arguments].concat());
    let nowhere = serve(&["cells", "--site", "elsewhere"]);
    assert_eq!((nowhere.status, nowhere.out.as_str()), (4, ""));
    assert!(
        nowhere.err.contains("error: elsewhere: the page is not there")
            && nowhere.err.contains("bash .ci/site page"),
        "{}",
        nowhere.err
    );
    let no_folder = serve(&["nothing", "--site", "site"]);
    assert!(
        no_folder.status == 4 && no_folder.err.contains("error: nothing: "),
        "{}",
        no_folder.err
    );
    let file = serve(&["cells/move.scan.json", "--site", "site"]);
    assert!(
        file.status == 2 && file.err.contains("it is no folder"),
        "{}",
        file.err
    );
    assert_eq!(serve(&["--port", "70000"]).status, 2);
    let served = Served::new(&folder, &["cells"]);
    let port = served.port.to_string();
    let taken = standstill(&folder, &["serve", "--port", &port, "--site", "site", "cells"]);
    assert_eq!(taken.status, 4);
    taken.complains(&format!(
        "error: port {port}: another program has it; `--port N` takes another one"
    ));
}

#[test]
fn many_at_once_are_answered_and_one_that_says_nothing_stops_nobody() {
    let served = Served::new(&with_site("serve_many"), &["cells"]);
    let silent: Vec<_> = (0..200)
        .map(|_| TcpStream::connect(("127.0.0.1", served.port)).expect("it listens"))
        .collect();
    let begin = Instant::now();
    thread::scope(|scope| {
        for _ in 0..20 {
            scope.spawn(|| assert_eq!(served.get("/folder/move.scan.json").status, 200));
        }
    });
    assert!(begin.elapsed() < Duration::from_secs(15));
    drop(silent);
}
