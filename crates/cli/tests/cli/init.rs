//! `init`: a first test in an empty folder; existing files are not overwritten.

#[cfg(unix)]
use crate::support::limited;
use crate::support::{read, scratch, standstill, write};
use std::fs;
use std::path::Path;

/// All files below a folder with their bytes, in order of their paths.
fn below(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().display().to_string();
                all.push((name, fs::read(path).unwrap()));
            }
        }
    }
    all.sort();
    all
}

#[test]
fn what_it_writes_passes_at_once_and_kills_its_mutants() {
    let folder = scratch("init_empty");
    let begun = standstill(&folder, &["init"]);
    assert_eq!((begun.status, begun.err.as_str()), (0, ""));
    assert_eq!(begun.out.matches("wrote     ").count(), below(&folder).len());
    begun.prints_last("\nnext: standstill test --strict\n");
    let tested = standstill(&folder, &["test", "--strict"]);
    assert_eq!((tested.status, tested.err.as_str()), (0, ""), "{}", tested.out);
    assert_eq!(
        tested.out,
        "ok        scan-tests/out_and_back.scan.json\n1 script: 1 passed\n"
    );
    assert_eq!(standstill(&folder, &["fmt", "--check"]).status, 0);
    let mutants = standstill(&folder, &["test", "--mutate"]);
    assert!(!mutants.out.contains("survived"), "{}", mutants.out);
}

#[test]
fn editors_find_the_schemas_and_ci_is_strict() {
    let folder = scratch("init_wired");
    let begun = standstill(&folder, &["init", "new/cell"]);
    assert_eq!(begun.status, 0, "{}", begun.err);
    let next = "next: standstill test --strict new/cell/scan-tests\n";
    begun.prints_last(next);
    let cell = folder.join("new/cell");
    let settings: serde_json::Value = serde_json::from_str(&read(&cell, ".vscode/settings.json")).unwrap();
    let jetbrains = read(&cell, ".idea/jsonSchemas.xml");
    for (wired, kind) in settings["json.schemas"]
        .as_array()
        .unwrap()
        .iter()
        .zip(["script", "machine"])
    {
        let path = wired["url"].as_str().unwrap().trim_start_matches("./");
        let schema = standstill(&folder, &["schema", kind]).out;
        assert_eq!(read(&cell, path), schema);
        assert!(jetbrains.contains(&format!("value=\"{path}\"")), "{path}");
        let pattern = wired["fileMatch"][0].as_str().unwrap();
        assert!(jetbrains.contains(&format!("value=\"{pattern}\"")), "{pattern}");
    }
    for name in ["out_and_back.scan.json", "slide.machine.json"] {
        let text = read(&cell, &format!("scan-tests/{name}"));
        let script: serde_json::Value = serde_json::from_str(&text).unwrap();
        let schema = script["$schema"].as_str().unwrap();
        assert!(cell.join("scan-tests").join(schema).is_file(), "{schema}");
    }
    let workflow = read(&cell, ".github/workflows/motion.yml");
    assert!(workflow.contains("standstill test --strict"), "{workflow}");
    assert!(workflow.contains(concat!("VERSION: v", env!("CARGO_PKG_VERSION"), "\n")));
    assert!(read(&cell, "scan-tests/.gitattributes").contains("*.exact binary"));
}

#[test]
fn it_overwrites_nothing_and_writes_nothing_beside_what_stands_there() {
    let folder = scratch("init_twice");
    write(&folder, "main.st", "(* mine *)");
    assert_eq!(standstill(&folder, &["init"]).status, 0);
    write(&folder, "scan-tests/out_and_back.scan.json", "mine");
    let before = below(&folder);
    let again = standstill(&folder, &["init"]);
    assert_eq!((again.status, again.out.as_str()), (2, ""));
    for (name, _) in before.iter().filter(|(name, _)| name != "main.st") {
        again.complains(&format!("./{name}"));
    }
    again.complains("nothing was written");
    assert_eq!(below(&folder), before);
    // One file is enough, and so is a file where a folder would be.
    for name in [".vscode/settings.json", ".github", "scan-tests"] {
        let folder = scratch("init_clash");
        fs::create_dir(folder.join(".vscode")).unwrap();
        write(&folder, name, "mine");
        let clash = standstill(&folder, &["init"]);
        let told = format!("error: ./{name} exists already: nothing was written");
        assert_eq!(clash.status, 2);
        clash.complains_first(&told);
        assert_eq!(below(&folder), [(name.to_owned(), b"mine".to_vec())]);
    }
    let file = scratch("init_file");
    write(&file, "cell", "mine");
    let clash = standstill(&file, &["init", "cell"]);
    assert_eq!(clash.status, 2);
    clash.complains_first("error: cell exists already and is no folder");
    assert_eq!(read(&file, "cell"), "mine");
}

#[cfg(unix)]
#[test]
fn no_link_is_followed_and_what_cannot_be_written_leaves_nothing() {
    let folder = scratch("init_link");
    fs::create_dir(folder.join("elsewhere")).unwrap();
    fs::create_dir(folder.join("cell")).unwrap();
    std::os::unix::fs::symlink("../elsewhere", folder.join("cell/.idea")).unwrap();
    let link = standstill(&folder, &["init", "cell"]);
    assert_eq!(link.status, 2);
    link.complains("cell/.idea exists already");
    assert_eq!(below(&folder).len(), 0);
    // A folder that nobody may write to, not even root.
    if Path::new("/proc/self").is_dir() {
        let refused = standstill(&folder, &["init", "/proc/self"]);
        assert_eq!((refused.status, refused.out.as_str()), (4, ""));
        refused.complains("/proc/self/scan-tests");
    }
    // Files of at most 4 KiB: the schema is the first that is longer.
    let limited = limited("-f 8", &folder, &["init", "full"]);
    assert_eq!(limited.status, 4, "{}", limited.err);
    limited.complains("scan-script.schema.json");
    assert!(!folder.join("full").exists());
}
