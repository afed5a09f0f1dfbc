//! Sweeps from outside: tables, shards, interruptions, and invalid files.

use crate::support::{SCRIPT, read, root, scratch, standstill, with_script, write};
use std::fs;
use std::path::{Path, PathBuf};

/// Six cases of the move of 1 mm; the first of its claims needs 10 mm/s.
const SWEEP: &str = r#"{
  "standstill_sweep": 1,
  "script": "move.scan.json",
  "grid": {"v": [4, 5, 8, 10, 16, 20]},
  "measure": {"done": {"first": "move.Done"}, "busy": {"count": "move.Busy"}, "end": {"last": "X.Position"}}
}
"#;

fn folder(name: &str) -> PathBuf {
    let folder = with_script(name);
    write(&folder, "move.sweep.json", SWEEP);
    folder
}

/// The fields of a column, by case.
fn column<'t>(table: &'t str, name: &str) -> Vec<&'t str> {
    let mut lines = table.lines();
    let header: Vec<_> = lines.next().unwrap().split(',').collect();
    let at = header.iter().position(|column| *column == name);
    let at = at.unwrap_or_else(|| panic!("no column {name} in {header:?}"));
    lines.map(|line| line.split(',').nth(at).unwrap()).collect()
}

#[test]
fn a_row_tells_what_came_of_its_case() {
    let folder = folder("sweep_rows");
    let ended = standstill(&folder, &["sweep", "move.sweep.json"]);
    // Below 10 mm/s the move does not end in time.
    assert_eq!((ended.status, ended.err.as_str()), (1, ""));
    let table = &ended.out;
    assert_eq!(column(table, "case"), ["0", "1", "2", "3", "4", "5"]);
    assert_eq!(column(table, "v"), ["4.0", "5.0", "8.0", "10.0", "16.0", "20.0"]);
    assert_eq!(
        column(table, "verdict"),
        ["failed", "failed", "failed", "passed", "passed", "passed"]
    );
    assert_eq!(column(table, "held"), ["1", "1", "1", "2", "2", "2"]);
    // 10 scans of 10 ms to 10 mm/s and 10 back again make 1 mm, and whole scans make 8 mm/s a little less.
    assert_eq!(column(table, "done")[3], "21");
    assert_eq!(column(table, "busy")[3], "20");
    assert_eq!(
        column(table, "X.velocity")[1..],
        ["5.0", "7.692307692307692", "10.0", "10.0", "10.0"]
    );
    assert_eq!(column(table, "X.velocity_margin")[1], "0.75");
    assert_eq!(
        column(table, "X.deceleration")[1],
        "",
        "its limit is that of acceleration"
    );
    assert_eq!(column(table, "X.jerk_margin")[1], "", "there is no limit");
    assert!(column(table, "end").iter().all(|end| *end == "1.0"));
    assert!(table.lines().nth(1).unwrap().contains("expect[0].that.move.Done"));
    // The digest is that of `run`.
    let run = standstill(&folder, &["run", "-q", "move.scan.json", "--set", "v=5"]);
    let digest = column(table, "digest")[1];
    assert!(
        run.out.contains(&format!("digest {digest}")),
        "{}\n{table}",
        run.out
    );
}

#[test]
fn threads_shards_and_interruptions_leave_no_trace_in_a_table() {
    let folder = folder("sweep_shards");
    write(
        &folder,
        "move.sweep.json",
        r#"{"standstill_sweep": 1, "script": "move.scan.json",
            "sample": {"seed": 5, "count": 60, "of": {"v": {"from": 1, "to": 20, "scale": "log"}}}}"#,
    );
    let sweep = |arguments: &[&str]| {
        let all = [&["sweep", "move.sweep.json"], arguments].concat();
        let ended = standstill(&folder, &all);
        assert_eq!(ended.status, 1, "{}", ended.err);
        ended
    };
    let whole = sweep(&["-o", "all.csv", "--threads", "1"]);
    let all = read(&folder, "all.csv");
    whole.prints_first("all.csv: 60 cases, ");
    sweep(&["-o", "two.csv", "--threads", "2"]);
    assert_eq!(read(&folder, "two.csv"), all);
    assert_eq!(sweep(&[]).out, all);

    let shards = ["s1.csv", "s2.csv", "s3.csv"];
    for (shard, name) in ["1/3", "2/3", "3/3"].iter().zip(shards) {
        sweep(&["--shard", shard, "-o", name]);
    }
    let merged = sweep(&["-o", "merged.csv", "--merge", "s3.csv", "s1.csv", "s2.csv"]);
    assert_eq!(read(&folder, "merged.csv"), all);
    assert_eq!(merged.out.replace("merged.csv", "all.csv"), whole.out);

    // An interruption: some rows are there, in any order, the last one torn.
    let key = part_key(&folder);
    let rows: Vec<_> = all.lines().skip(1).collect();
    let torn = format!("{key}\n{}\n{}\n{}", rows[7], rows[2], &rows[9][..20]);
    write(&folder, "again.csv.part", &torn);
    let again = sweep(&["-o", "again.csv"]);
    assert_eq!(again.err, "2 of 60 cases are there from an interrupted run\n");
    assert_eq!(read(&folder, "again.csv"), all);
    assert!(!folder.join("again.csv.part").exists());
    // Existing rows are not computed again: a changed row stays as it is.
    let marked = rows[7].replacen("failed", "refused", 1);
    write(&folder, "again.csv.part", &format!("{key}\n{marked}\n"));
    let ended = standstill(&folder, &["sweep", "move.sweep.json", "-o", "again.csv"]);
    assert_eq!(ended.status, 3);
    assert!(read(&folder, "again.csv").contains(&marked));
}

/// The first line of a part, as an interrupted run leaves it.
fn part_key(folder: &Path) -> String {
    // A table that cannot be put into its place leaves its part behind.
    fs::create_dir_all(folder.join("key.csv/in")).unwrap();
    let ended = standstill(folder, &["sweep", "move.sweep.json", "-o", "key.csv"]);
    assert_eq!(ended.status, 4, "{}", ended.err);
    let part = read(folder, "key.csv.part");
    assert_eq!(part.lines().count(), 61, "every row is kept");
    part.lines().next().unwrap().to_owned()
}

#[test]
fn a_table_without_digests_is_the_same_but_for_them() {
    let folder = folder("sweep_bare");
    let refused = SCRIPT.replace("\"velocity\": 20", "\"velocity\": {\"param\": \"v\"}");
    write(&folder, "refused.scan.json", &refused);
    let turn = root().join("docs/sweeps");
    for name in ["turn.scan.json", "turn.sweep.json"] {
        write(&folder, name, &read(&turn, name));
    }
    let claims = read(&turn, "turn.scan.json").replace(
        "\"expect\": [",
        r#""stop_when": {"turn.Done": true},
  "expect": [
    {"within_limits": "X"},
    {"at": 20, "that": {"X.State": "DiscreteMotion"}},
    {"never": {"X.Position.d2": {"gt": 30}}, "while": {"power.Status": true}},
    {"once": {"turn.Done": true}, "from": {"when": {"turn.Busy": true}}},
    {"always": {"torque.Torque": {"same_as": "torque.Torque"}}},"#,
    );
    write(&folder, "claims.scan.json", &claims);
    let other = |name: &str| read(&turn, "turn.sweep.json").replace("turn.scan.json", name);
    for (sweep, verdicts) in [
        (SWEEP.to_owned(), "3 passed, 3 failed, 0 refused"),
        (
            SWEEP
                .replace("move.scan", "refused.scan")
                .replace("[4, 5,", "[0, 10,"),
            "4 passed, 1 failed, 1 refused",
        ),
        (other("turn.scan.json"), "11 passed, 4 failed, 0 refused"),
        (other("claims.scan.json"), "5 passed, 10 failed, 0 refused"),
    ] {
        write(&folder, "all.sweep.json", &sweep);
        let bare = sweep.replacen("\"script\"", "\"digest\": false, \"script\"", 1);
        write(&folder, "bare.sweep.json", &bare);
        let all = standstill(&folder, &["sweep", "all.sweep.json", "-o", "all.csv"]);
        let bare = standstill(&folder, &["sweep", "bare.sweep.json", "-o", "bare.csv"]);
        assert!(all.out.contains(verdicts), "{}{}", all.out, all.err);
        assert!(bare.out.contains(verdicts), "{}{}", bare.out, bare.err);
        let all = read(&folder, "all.csv");
        let digest = all
            .lines()
            .next()
            .unwrap()
            .split(',')
            .position(|name| name == "digest");
        // Only cells behind digests may have commas of their own.
        let without = |line: &str| {
            let mut fields: Vec<&str> = line.splitn(digest.unwrap() + 2, ',').collect();
            fields.remove(digest.unwrap());
            fields.join(",") + "\n"
        };
        assert_eq!(
            read(&folder, "bare.csv"),
            all.lines().map(without).collect::<String>()
        );
    }
}

#[test]
fn a_part_of_another_sweep_is_not_gone_on_with() {
    let folder = folder("sweep_other");
    write(&folder, "a.csv.part", "standstill-sweep,0123456789abcdef,1/1\n");
    let ended = standstill(&folder, &["sweep", "move.sweep.json", "-o", "a.csv"]);
    assert_eq!((ended.status, ended.out.as_str()), (3, ""));
    let told =
        "a.csv.part: it was begun with another sweep, script, shard or version: delete it to begin anew";
    ended.complains(told);
    assert!(!folder.join("a.csv").exists());
}

#[test]
fn shards_that_do_not_make_a_whole_are_refused() {
    let folder = folder("sweep_merge");
    for (shard, name) in [("1/2", "one.csv"), ("2/2", "two.csv")] {
        standstill(
            &folder,
            &["sweep", "move.sweep.json", "--shard", shard, "-o", name],
        );
    }
    write(
        &folder,
        "other.csv",
        &read(&folder, "one.csv").replace("4.0", "4.5"),
    );
    write(&folder, "columns.csv", "case,v\n0,4.0\n");
    for (files, why) in [
        (
            &["one.csv"][..],
            "one.csv: case 1 stands in none of them; 3 of 6 cases are there",
        ),
        (
            &["one.csv", "two.csv", "one.csv"],
            "one.csv: case 0 stands in one.csv, too: give each shard once",
        ),
        (
            &["two.csv", "other.csv"],
            "other.csv: case 0 had other parameters: this table is of another sweep",
        ),
        (
            &["columns.csv"],
            "columns.csv: these are not the columns of this sweep",
        ),
        (&["gone.csv"], "gone.csv: "),
    ] {
        let arguments = [&["sweep", "move.sweep.json", "-o", "all.csv", "--merge"], files].concat();
        let ended = standstill(&folder, &arguments);
        assert_eq!(
            ended.status,
            if files == ["gone.csv"] { 4 } else { 3 },
            "{}",
            ended.err
        );
        ended.complains_first(&format!("error: {why}"));
        assert!(!folder.join("all.csv").exists());
    }
}

#[test]
fn a_case_that_cannot_be_run_is_a_row_and_the_others_go_on() {
    let folder = folder("sweep_refused");
    // No axis can have a limit of 0.
    let script = SCRIPT.replace("\"velocity\": 20", "\"velocity\": {\"param\": \"v\"}");
    write(&folder, "move.scan.json", &script);
    write(&folder, "move.sweep.json", &SWEEP.replace("[4, 5,", "[0, 10,"));
    let ended = standstill(&folder, &["sweep", "move.sweep.json"]);
    assert_eq!(ended.status, 3);
    assert_eq!(column(&ended.out, "verdict")[..2], ["refused", "passed"]);
    let refused = ended.out.lines().nth(1).unwrap();
    assert!(refused.contains("velocity"), "it says why: {refused}");
    assert_eq!(column(&ended.out, "digest")[0], "");
}

#[test]
fn what_a_sweep_names_must_be_there() {
    let folder = folder("sweep_wrong");
    fs::create_dir_all(folder.join("in")).unwrap();
    for (from, to, place, told) in [
        (
            "\"v\": [4",
            "\"w\": [4",
            "4:12",
            "move.scan.json has no parameter `w`",
        ),
        (
            "move.Done",
            "move.Down",
            "5:33",
            "the trace has no signal `move.Down`",
        ),
        (
            "\"first\": \"move.Done\"",
            "\"first\": \"X.Position\"",
            "5:33",
            "`first` is taken of a BOOL",
        ),
        (
            "\"busy\": {",
            "\"v\": {",
            "5:47",
            "the table has a column `v` already",
        ),
        (
            "\"end\": {",
            "\"case\": {",
            "5:79",
            "the table has a column `case` already",
        ),
        (
            "move.scan.json",
            "gone.scan.json",
            "3:13",
            "cannot be had: there is no such file",
        ),
        ("[4, 5, 8, 10, 16, 20]", "[]", "4:17", "`v` has no values"),
        (
            "[4, 5, 8, 10, 16, 20]",
            "5",
            "4:17",
            "`v` takes a list of values or a range",
        ),
        (
            "[4, 5, 8, 10, 16, 20]",
            "{\"from\": 0, \"to\": 1, \"count\": 3, \"scale\": \"log\"}",
            "4:26",
            "0.0 is on no logarithmic scale",
        ),
        (
            "[4, 5, 8, 10, 16, 20]",
            "{\"from\": 0, \"to\": 1}",
            "4:17",
            "a range of a grid needs the key `count`",
        ),
        (
            "[4, 5, 8, 10, 16, 20]",
            "{\"from\": 0, \"to\": 1, \"count\": 1}",
            "4:47",
            "`count` is 1:",
        ),
        ("\"grid\"", "\"grit\"", "4:3", "unknown key `grit`"),
        (
            "\"grid\"",
            "\"digest\": \"false\", \"grid\"",
            "4:13",
            "`digest` takes true or false",
        ),
        (
            "sweep\": 1",
            "sweep\": 2",
            "2:23",
            "version 2 of the sweep format is not supported",
        ),
    ] {
        assert!(SWEEP.contains(from), "{from}");
        write(&folder, "move.sweep.json", &SWEEP.replacen(from, to, 1));
        let ended = standstill(&folder, &["sweep", "move.sweep.json", "-o", "a.csv"]);
        assert_eq!((ended.status, ended.out.as_str()), (3, ""), "{}", ended.err);
        let place = format!("--> move.sweep.json:{place}");
        assert!(
            ended.err.contains(&place) && ended.err.contains(told),
            "{to}: {}",
            ended.err
        );
        assert!(!folder.join("a.csv.part").exists(), "{to}");
    }
    // The script of a sweep must be below its folder.
    write(
        &folder,
        "in/move.sweep.json",
        &SWEEP.replace("move.scan", "../move.scan"),
    );
    let ended = standstill(&folder, &["sweep", "in/move.sweep.json"]);
    assert_eq!(ended.status, 3);
    ended.complains("outside the sweep's folder");
    let allowed = standstill(&folder, &["sweep", "in/move.sweep.json", "--include-from", "."]);
    assert_eq!(allowed.status, 1, "{}", allowed.err);
}

#[test]
fn a_sweep_without_end_is_refused_before_it_begins() {
    let folder = scratch("sweep_large");
    write(&folder, "move.scan.json", SCRIPT);
    let range = |name: &str| format!("\"{name}\": {{\"from\": 0, \"to\": 1, \"count\": 10000000}}");
    let text = format!(
        "{{\"standstill_sweep\": 1, \"script\": \"move.scan.json\", \"grid\": {{{}, {}, {}}}}}",
        range("a"),
        range("b"),
        range("c")
    );
    write(&folder, "large.sweep.json", &text);
    let ended = standstill(&folder, &["sweep", "large.sweep.json"]);
    assert_eq!(ended.status, 3);
    ended.complains("more than 10000000 cases");
    for arguments in [
        &["sweep", "large.sweep.json", "--shard", "0/4"][..],
        &["sweep", "large.sweep.json", "--shard", "5/4"],
        &["sweep", "large.sweep.json", "--threads", "0"],
        &["sweep", "large.sweep.json", "--shard", "1/2", "--merge", "a.csv"],
    ] {
        assert_eq!(standstill(&folder, arguments).status, 2, "{arguments:?}");
    }
}
