//! Files from strangers: their texts cannot forge the output, nothing is written outside the permitted places, and
//! work and memory are bounded in proportion.

use crate::support::{LONG, SCRIPT, late, read, scratch, standstill, typed, with_script, write};
#[cfg(unix)]
use crate::support::{command, fifo, limited};
use std::fs;
use std::time::{Duration, Instant};

/// A script whose texts try to affect their reader; its claim fails.
fn hostile() -> String {
    SCRIPT
        .replace(
            "One short move",
            r"\u001b[2Jmove\nhostile.scan.json: passed, 9 of 9 claims\u2028ok\r\u202e\u200b\u200d\u2060\ufeff\u00ad\ufe0f",
        )
        .replace(r#""unit": "mm""#, r#""unit": "mm\u001b]0;x\u0007\nok  a""#)
        .replace("\"at\": 21", "\"at\": 19")
}

/// Checks that a text has only visible characters and line ends.
#[track_caller]
fn is_plain(what: &str, text: &str) {
    let hidden = |character: &char| {
        *character != '\n'
            && (character.is_control()
                || matches!(character, '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}')
                || matches!(
                    character,
                    '\u{200b}'..='\u{200f}' | '\u{2060}' | '\u{feff}' | '\u{ad}' | '\u{fe0f}'
                ))
    };
    assert_eq!(text.chars().find(hidden), None, "{what}: {text:?}");
    let forged = |line: &&str| line.trim_start().starts_with("ok  a") || line.contains("claims\u{2028}");
    assert_eq!(text.lines().find(forged), None, "{what}");
    let verdicts = text
        .lines()
        .filter(|line| line.starts_with("hostile.scan.json: passed"));
    assert_eq!(verdicts.count(), 0, "{what}: {text}");
}

#[test]
fn what_a_script_says_is_one_line_and_can_be_seen_wherever_it_is_printed() {
    let folder = scratch("borders_texts");
    write(&folder, "hostile.scan.json", &hostile());
    let run = standstill(&folder, &["run", "hostile.scan.json", "--trace", "a.jsonl"]);
    assert_eq!(run.status, 1);
    is_plain("run", &run.out);
    run.prints_first("\\u{1b}[2Jmove\\u{a}hostile.scan.json: passed");
    for arguments in [
        &["test", ".", "--junit", "junit.xml"][..],
        &["explain", "a.jsonl", "b.jsonl"],
        &[
            "run",
            "-q",
            "hostile.scan.json",
            "absent\u{1b}[2J\nok  a.scan.json",
        ],
    ] {
        let other = read(&folder, "a.jsonl").replace("DiscreteMotion", "Disc\\u001breteMotion");
        write(&folder, "b.jsonl", &other);
        let ended = standstill(&folder, arguments);
        assert!((1..=4).contains(&ended.status), "{arguments:?}");
        is_plain("output", &ended.out);
        is_plain("messages", &ended.err);
    }
    is_plain("JUnit", &read(&folder, "junit.xml"));
    // The golden and its difference.
    write(
        &folder,
        "good.scan.json",
        &hostile().replace("\"at\": 19", "\"at\": 21"),
    );
    assert_eq!(
        standstill(&folder, &["test", "--accept", "good.scan.json"]).status,
        0
    );
    is_plain("golden", &read(&folder, "good.snap"));
    let golden = read(&folder, "good.snap").replace("+Execute", "+Exe\u{1b}[2Jcute");
    write(&folder, "good.snap", &golden);
    let ended = standstill(&folder, &["test", "good.scan.json"]);
    assert_eq!(ended.status, 1);
    ended.prints("+Exe\\u{1b}[2Jcute");
    is_plain("difference", &ended.out);
}

#[test]
fn names_that_look_alike_are_told_apart() {
    let folder = scratch("borders_invisible");
    for hidden in [
        '\u{200b}',
        '\u{200d}',
        '\u{2060}',
        '\u{feff}',
        '\u{202e}',
        '\u{e0041}',
    ] {
        let key = format!("\"sc{hidden}ans\"");
        write(&folder, "key.scan.json", &SCRIPT.replace("\"scans\"", &key));
        let refused = standstill(&folder, &["run", "key.scan.json"]);
        assert_eq!(refused.status, 3);
        let told = format!("unknown key `sc{}ans`", hidden.escape_unicode());
        refused.complains(&told);
        is_plain("messages", &refused.err);
    }
}

#[test]
fn a_line_without_end_is_told_by_its_place() {
    let folder = scratch("borders_line");
    let line = format!("{{\"a\": \"{}\"}}", "long ".repeat(2_000_000));
    write(&folder, "line.scan.json", &line);
    let begin = Instant::now();
    let refused = standstill(&folder, &["run", "line.scan.json"]);
    assert_eq!(refused.status, 3);
    let told = "error[unknown_key]: unknown key `a` in a script\n--> line.scan.json:1:2";
    refused.complains(told);
    assert!(refused.err.len() < 10_000, "{} bytes", refused.err.len());
    assert!(begin.elapsed() < Duration::from_secs(10));
}

/// Names that Windows does not permit.
#[cfg(unix)]
mod names {
    use super::*;

    /// The name, and its printed form.
    const NAMES: [(&str, &str); 3] = [
        (r"a\b", r"a\b"),
        ("a\nok  a", r"a\u{a}ok  a"),
        ("a\u{1b}[2J\u{200b}", r"a\u{1b}[2J\u{200b}"),
    ];

    #[test]
    fn a_file_has_the_name_that_was_typed_in_every_message() {
        let folder = scratch("borders_file_names");
        let wrong = SCRIPT.replace("\"Axis\": \"X\"", "\"Axis\": \"Z\"");
        let includes = r#"{"standstill": 1, "axes": {"Y": {"limit": {}}}}"#;
        for (name, printed) in NAMES {
            let (script, source) = (format!("{name}.scan.json"), format!("{name}.st"));
            write(&folder, &script, &wrong);
            write(&folder, &source, "PROGRAM p\nx := 1;\nEND_PROGRAM\n");
            for (command, file, ending) in [
                (&["run"][..], &script, ".scan.json:15:"),
                (&["test"], &script, ".scan.json:15:"),
                (&["st", "check"], &source, ".st:2:1"),
                (&["st", "lint"], &source, ".st:2:1"),
            ] {
                let ended = standstill(&folder, &[command, &[file.as_str()]].concat());
                assert_eq!(ended.status, 3, "{}", ended.err);
                let told = ended.out + &ended.err;
                assert!(
                    told.contains(&format!("--> {printed}{ending}")),
                    "{command:?}: {told}"
                );
                is_plain("messages", &told);
            }
            // A file that the script names.
            let machine = format!("{}.machine.json", name.replace('\\', ""));
            write(&folder, &machine, includes);
            let include = serde_json::json!(machine);
            let key = "\"standstill\": 1,";
            let script = SCRIPT.replace(key, &format!("{key} \"include\": {include},"));
            write(&folder, "includes.scan.json", &script);
            let ended = standstill(&folder, &["run", "includes.scan.json"]);
            assert_eq!(ended.status, 3);
            let printed = printed.replace(r"a\b", "ab");
            ended.complains(&format!("--> {printed}.machine.json:1:"));
            is_plain("messages", &ended.err);
        }
    }
}

#[cfg(unix)]
mod links {
    use super::*;
    use std::os::unix::fs::symlink;
    use std::path::Path;

    const SECRET: &str = "nobody may write this\n";

    fn is_untouched(folder: &Path, name: &str) {
        assert_eq!(read(folder, name), SECRET, "{name}");
    }

    #[test]
    fn testing_writes_through_no_link() {
        let folder = scratch("borders_links");
        fs::create_dir(folder.join("suite")).expect("a folder");
        let suite = folder.join("suite");
        write(&folder, "outside", SECRET);
        for name in [
            "move.snap.new",
            "move.snap.new.partial",
            "kept.exact",
            "kept.exact.partial",
        ] {
            symlink("../outside", suite.join(name)).expect("a link");
        }
        write(&suite, "move.scan.json", SCRIPT);
        // No golden yet: one is proposed.
        let proposed = standstill(&suite, &["test", "move.scan.json"]);
        assert_eq!(proposed.status, 1, "{}", proposed.err);
        is_untouched(&folder, "outside");
        assert!(read(&suite, "move.snap.new").contains("expression: golden"));
        // A golden with an exact trace of another run: it is written again.
        write(&suite, "kept.scan.json", SCRIPT);
        fs::remove_file(suite.join("kept.exact")).expect("the link");
        assert_eq!(
            standstill(&suite, &["test", "--accept", "kept.scan.json"]).status,
            0
        );
        fs::remove_file(suite.join("kept.exact")).expect("it was written");
        symlink("../outside", suite.join("kept.exact")).expect("a link");
        let kept = standstill(&suite, &["test", "kept.scan.json"]);
        assert_eq!(kept.status, 0, "{}{}", kept.out, kept.err);
        is_untouched(&folder, "outside");
        // Its proposal is withdrawn: the link is removed, not its target.
        symlink("../outside", suite.join("kept.snap.new")).expect("a link");
        assert_eq!(standstill(&suite, &["test", "kept.scan.json"]).status, 0);
        is_untouched(&folder, "outside");
    }

    #[test]
    fn no_file_that_is_named_is_written_through_a_link() {
        let folder = with_script("borders_named_links");
        write(&folder, "outside", SECRET);
        write(
            &folder,
            "line.jsonl",
            r#"{"Ts":0.01,"target":1,"limits":{"velocity":1}}"#,
        );
        for name in ["a.csv", "a.csv.meta.json", "junit.xml", "a.html", "s.csv"] {
            symlink("outside", folder.join(name)).expect("a link");
        }
        assert_eq!(
            typed(&folder, "run -q move.scan.json --trace a.csv --report a.html").status,
            0
        );
        assert_eq!(
            standstill(&folder, &["test", "--junit", "junit.xml", "move.scan.json"]).status,
            1
        );
        assert_eq!(
            standstill(&folder, &["plan", "line.jsonl", "--samples", "s.csv"]).status,
            0
        );
        is_untouched(&folder, "outside");
        assert!(read(&folder, "a.csv").starts_with("scan,time_ns"));
    }

    #[test]
    fn a_module_is_written_through_no_link() {
        let folder = scratch("borders_module");
        write(&folder, "outside", SECRET);
        write(
            &folder,
            "p.st",
            "PROGRAM p\nVAR x : INT; END_VAR\nx := 1;\nEND_PROGRAM\n",
        );
        for name in [
            "p.wasm",
            "p.wasm.partial",
            "p.symbols.json",
            "p.symbols.json.partial",
        ] {
            symlink("outside", folder.join(name)).expect("a link");
        }
        let built = standstill(&folder, &["st", "build", "p.st", "-o", "p.wasm"]);
        assert_eq!(built.status, 0, "{}", built.err);
        is_untouched(&folder, "outside");
        assert!(
            fs::read(folder.join("p.wasm"))
                .expect("a module")
                .starts_with(b"\0asm")
        );
    }

    #[test]
    fn pages_stay_below_their_folder_and_scripts_that_are_links_are_not_laid_out() {
        let folder = scratch("borders_pages");
        for name in ["suite", "elsewhere", "pages"] {
            fs::create_dir(folder.join(name)).expect("a folder");
        }
        write(&folder.join("suite"), "move.scan.json", &late());
        symlink("../elsewhere", folder.join("pages/suite")).expect("a link");
        let ended = standstill(&folder, &["test", "suite", "--report", "pages"]);
        assert_eq!(ended.status, 4, "{}", ended.out);
        ended.complains("leads out of the folder");
        assert_eq!(
            fs::read_dir(folder.join("elsewhere")).expect("a folder").count(),
            0
        );
        let dense = r#"{"standstill":1}"#;
        write(&folder, "dense.json", dense);
        symlink("../dense.json", folder.join("suite/link.scan.json")).expect("a link");
        assert_eq!(standstill(&folder, &["fmt", "suite/link.scan.json"]).status, 4);
        assert_eq!(read(&folder, "dense.json"), dense);
    }

    #[test]
    fn a_pipe_in_a_suite_is_not_waited_for() {
        let folder = with_script("borders_fifo");
        for name in ["move.snap", "other.scan.json"] {
            fifo(&folder.join(name));
        }
        let ended = standstill(&folder, &["test", "."]);
        assert_eq!(ended.status, 4);
        ended.complains("move.snap: this is no regular file");
        assert!(!ended.out.contains("other.scan.json"), "{}", ended.out);
    }

    #[test]
    fn in_a_folder_that_nobody_may_write_to_a_test_still_says_what_differs() {
        let folder = with_script("borders_read_only");
        assert_eq!(standstill(&folder, &["test", "--accept", "."]).status, 0);
        let golden = read(&folder, "move.snap").replace("+Execute", "+Other");
        write(&folder, "move.snap", &golden);
        // A user with all permissions cannot do this either.
        fs::create_dir(folder.join("move.snap.new")).expect("a folder");
        let ended = standstill(&folder, &["test", "."]);
        assert_eq!(ended.status, 1, "{}", ended.err);
        ended.prints("+Other");
        ended.prints("there is no proposal: ./move.snap.new: ");
    }

    /// Runs the program with a file size limit of half a kilobyte, as on a full disk.
    fn on_a_full_disk(folder: &Path, arguments: &[&str]) -> crate::support::Ended {
        limited("-f 1", folder, arguments)
    }

    #[test]
    fn a_full_disk_leaves_scripts_and_goldens_as_they_were() {
        let folder = scratch("borders_full");
        let long = format!("{{\"standstill\":1,\"note\":\"{}\"}}", "long ".repeat(2000));
        write(&folder, "long.scan.json", &long);
        let ended = on_a_full_disk(&folder, &["fmt", "."]);
        assert_eq!(ended.status, 4, "{}", ended.out);
        assert_eq!(read(&folder, "long.scan.json"), long);
        assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 1);

        let folder = with_script("borders_full_golden");
        let accept = ["test", "--accept", "."];
        assert_eq!(standstill(&folder, &accept).status, 0);
        let before = read(&folder, "move.snap");
        write(&folder, "move.scan.json", &SCRIPT.replace("One short", "Another"));
        let ended = on_a_full_disk(&folder, &accept);
        assert_eq!(ended.status, 4, "{}", ended.out);
        assert_eq!(read(&folder, "move.snap"), before);
        assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 3);
    }
}

#[test]
fn claims_times_scans_have_a_bound() {
    let folder = scratch("borders_claims");
    let claims = vec![r#"{"always": {"X.Position": 0, "X.Velocity": 0}}"#; 600].join(",");
    let script = format!(
        r#"{{"standstill":1,"cycle":"T#1us","scans":10000000,"axes":{{"X":{{"limits":{{"velocity":1,"acceleration":1}}}}}},
            "blocks":[],"expect":[{claims}]}}"#
    );
    write(&folder, "claims.scan.json", &script);
    let begin = Instant::now();
    let ended = standstill(&folder, &["test", "."]);
    assert_eq!(ended.status, 3);
    ended.complains("error[too_large]: claims and steps take 12000000000 looks");
    assert!(begin.elapsed() < Duration::from_secs(10));
}

#[test]
fn a_time_limit_ends_any_command_with_what_it_was_at() {
    let folder = scratch("borders_time");
    write(&folder, "long.scan.json", LONG);
    for (arguments, at) in [
        (
            &["--time-limit", "300ms", "run", "-q", "long.scan.json"][..],
            "long.scan.json",
        ),
        (
            &["test", ".", "--time-limit", "T#0.3s"],
            "1 of 1: ./long.scan.json",
        ),
        (
            &["soak", "planner", "--count", "100000000", "--time-limit", "300ms"],
            "of 100000000",
        ),
    ] {
        let begin = Instant::now();
        let ended = standstill(&folder, arguments);
        assert_eq!((ended.status, ended.out.as_str()), (1, ""), "{arguments:?}");
        let told = ended
            .err
            .strip_prefix("error: --time-limit T#300ms: the time is up; it was at ");
        assert!(told.is_some_and(|told| told.contains(at)), "{}", ended.err);
        assert!(begin.elapsed() < Duration::from_secs(10), "{arguments:?}");
    }
    // The earlier output is there, and a command that ends in time has no message about it.
    write(&folder, "move.scan.json", SCRIPT);
    let ended = typed(&folder, "run -q --time-limit 2s move.scan.json long.scan.json");
    assert_eq!(ended.status, 1);
    ended.prints_first("move.scan.json: passed");
    assert_eq!(
        standstill(&folder, &["run", "-q", "--time-limit", "1h", "move.scan.json"]).status,
        0
    );
    assert_eq!(
        standstill(&folder, &["run", "--time-limit", "soon", "move.scan.json"]).status,
        2
    );
}

#[test]
#[cfg(unix)]
fn what_waits_says_what_it_waits_for_when_the_time_is_up() {
    use std::process::Stdio;
    let folder = scratch("borders_waiting");
    fifo(&folder.join("pipe"));
    for (arguments, at) in [
        (&["lsp"][..], "serving an editor"),
        (&["plan"], "waiting for line 1 of standard input"),
        (&["plan", "-"], "waiting for line 1 of standard input"),
        (&["plan", "pipe"], "reading pipe"),
        (&["compare-planners", "-"], "waiting for line 1 of standard input"),
        (&["fmt", "-"], "reading standard input"),
        (&["st", "check", "pipe"], "reading pipe"),
        (&["st", "lint", "pipe"], "reading pipe"),
        (&["st", "fmt", "pipe"], "reading pipe"),
        (&["cam", "plot", "pipe", "--svg", "a.svg"], "reading pipe"),
    ] {
        let mut waiting = command(&[arguments, &["--time-limit", "200ms"]].concat());
        let piped = waiting
            .current_dir(&folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = piped.spawn().expect("the program starts");
        let input = child.stdin.take();
        let output = child.wait_with_output().expect("it ends");
        drop(input);
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(
            told,
            format!("error: --time-limit T#200ms: the time is up; it was at {at}\n"),
            "{arguments:?}"
        );
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
    }
}

/// A module that takes 80 MiB when it starts.
const LARGE: &str = r#"(module (memory (export "memory") 1)
    (func (export "plc_init") (drop (memory.grow (i32.const 1280))))
    (func (export "plc_scan") (param i32 i64)))"#;

#[test]
fn guests_have_no_more_memory_than_the_command_line_gives_them() {
    let folder = scratch("borders_guest");
    write(&folder, "large.wat", LARGE);
    let script = |programs: &str| {
        format!(
            r#"{{"standstill":1,"cycle":"T#1ms","scans":2,"axes":{{}},"blocks":[],"programs":{{{programs}}}}}"#
        )
    };
    write(
        &folder,
        "one.scan.json",
        &script(r#""G":{"wasm":"large.wat","fuel":1000000000,"memory":4294967296}"#),
    );
    let half = r#"{"wasm":"large.wat","fuel":1000000000,"memory":40000000}"#;
    write(
        &folder,
        "two.scan.json",
        &script(&format!(r#""G":{half},"H":{half}"#)),
    );
    for name in ["one.scan.json", "two.scan.json"] {
        let refused = standstill(&folder, &["run", "-q", name]);
        assert_eq!(refused.status, 3, "{name}");
        refused.complains("`--guest-memory ");
        let wanted = standstill(&folder, &["run", "-q", name, "--guest-memory", "4GiB"]);
        assert_eq!(wanted.status, 0, "{}", wanted.err);
    }
    let none = standstill(&folder, &["run", "-q", "one.scan.json", "--guest-memory", "4GB"]);
    assert_eq!(none.status, 2);
    // Programs that do not state their need share the available memory.
    let many: Vec<_> = (0..16)
        .map(|n| format!(r#""G{n}":{{"wasm":"large.wat","fuel":1000000000}}"#))
        .collect();
    write(&folder, "many.scan.json", &script(&many.join(",")));
    let many = standstill(&folder, &["run", "-q", "many.scan.json"]);
    assert_eq!(many.status, 0, "{}", many.err);
}

/// A golden's exact trace with this number of rows of zeros, compressed to a thousandth.
fn inflated(rows: u64, zeros: usize) -> Vec<u8> {
    let mut body = Vec::new();
    let mut put = |mut number: u64| {
        while number >= 0x80 {
            body.push((number & 0x7f) as u8 | 0x80);
            number >>= 7;
        }
        body.push(number as u8);
    };
    for number in [1_000_000, rows, 1, 1] {
        put(number);
    }
    // One column `a` of BOOL, an input variable; no names.
    body.extend(*b"a\x00\x02\x00\x00");
    body.resize(body.len() + zeros, 0);
    let mut file = b"standstill exact 1\n".to_vec();
    file.extend(0_u64.to_le_bytes());
    file.extend(miniz_oxide::deflate::compress_to_vec_zlib(&body, 9));
    file
}

#[test]
#[cfg(target_os = "linux")]
fn exact_traces_take_memory_in_proportion() {
    let folder = with_script("borders_exact");
    assert_eq!(standstill(&folder, &["test", "--accept", "."]).status, 0);
    // Simulates a changed run, so that the exact trace is read for the difference; its digest is the one of the
    // golden's text.
    let golden = read(&folder, "move.snap").replace("+Execute", "+Other");
    let digest = golden
        .trim_end()
        .rsplit(' ')
        .next()
        .expect("the digest")
        .to_owned();
    write(&folder, "move.snap", &golden);
    let digest = u64::from_str_radix(&digest, 16).expect("a digest").to_le_bytes();
    let most = 48_000_000;
    for (name, rows, zeros) in [
        ("unpacks to 48 MB", most as u64, most),
        ("says that it has 50 million rows", 50_000_000, 100),
        ("says more than there can be", u64::MAX / 2, 100),
    ] {
        let mut file = inflated(rows, zeros);
        file[19..27].copy_from_slice(&digest);
        assert!(file.len() < 50_000, "{}", file.len());
        fs::write(folder.join("move.exact"), &file).expect("writable");
        for arguments in [&["test", "."][..], &["explain", "move.exact", "move.exact"]] {
            let ended = limited("-v 200000", &folder, arguments);
            let (status, text) = match arguments[0] {
                "test" => (1, ended.out),
                _ => (3, ended.err),
            };
            assert_eq!(ended.status, status, "{name}: {text}");
            assert!(
                text.contains("the exact trace is larger than the") || text.contains("damaged"),
                "{name}: {text}"
            );
        }
    }
}

#[test]
#[cfg(target_os = "linux")]
fn live_finds_out_before_it_runs_that_it_cannot_write() {
    let folder = with_script("borders_live");
    for option in ["--trace", "--timing"] {
        let begin = Instant::now();
        let long = SCRIPT.replace("\"scans\": 30", "\"scans\": 6000");
        write(&folder, "long.scan.json", &long);
        let path = format!("absent/a{}", if option == "--trace" { ".csv" } else { ".json" });
        let ended = standstill(
            &folder,
            &["live", "long.scan.json", "--period", "10ms", option, &path],
        );
        assert_eq!((ended.status, ended.out.as_str()), (4, ""), "{}", ended.err);
        ended.complains("absent/a");
        assert!(
            begin.elapsed() < Duration::from_secs(20),
            "it would have run for a minute"
        );
    }
}
