//! `crates/xtask/guides.txt`: the guides of each block.

use crate::read;
use standstill_blocks::REGISTRY;
use std::collections::BTreeMap;

/// The guides of each block, as links from a page of `docs/blocks/`; empty for `none`.
pub fn guides() -> BTreeMap<String, String> {
    let link = |target: &str| format!("[{}](../{target})", title(target));
    let links = |words: Vec<&str>| match words[..] {
        ["none"] => String::new(),
        _ => words.into_iter().map(link).collect::<Vec<_>>().join(", "),
    };
    lines(&read(FILE))
        .map(|(block, words)| (block.into(), links(words)))
        .collect()
}

/// The faults: a block without a line or with two, a line of an unknown block, a line without a page.
pub fn problems() -> Vec<String> {
    problems_of(&read(FILE))
}

const FILE: &str = "crates/xtask/guides.txt";

/// The name of a block and the words behind it.
fn lines(text: &str) -> impl Iterator<Item = (&str, Vec<&str>)> {
    let lines = text
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.map(|line| {
        let mut words = line.split_whitespace();
        (words.next().unwrap_or_default(), words.collect())
    })
}

fn problems_of(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for info in REGISTRY {
        match lines(text).filter(|(block, _)| *block == info.name).count() {
            0 => found.push(format!(
                "{FILE}: no line for {}: name its guides, or `none`",
                info.name
            )),
            1 => {}
            _ => found.push(format!("{FILE}: {} has more than one line", info.name)),
        }
    }
    for (block, words) in lines(text) {
        if REGISTRY.iter().all(|info| info.name != block) {
            found.push(format!("{FILE}: `{block}` is not a block"));
        }
        if words.is_empty() {
            found.push(format!("{FILE}: {block} has no guide: name one, or `none`"));
        }
    }
    found
}

/// The heading at a target `page.md` or `page.md#section`.
fn title(target: &str) -> String {
    let (page, anchor) = target.split_once('#').unwrap_or((target, ""));
    let text = read(&format!("docs/{page}"));
    let is_it = |line: &&str| {
        if anchor.is_empty() {
            line.starts_with("# ")
        } else {
            line.starts_with('#') && slug(heading(line)) == anchor
        }
    };
    let found = text.lines().find(is_it).map(heading);
    found
        .unwrap_or_else(|| panic!("{FILE}: docs/{target} has no such heading"))
        .into()
}

fn heading(line: &str) -> &str {
    line.trim_start_matches('#').trim()
}

fn slug(heading: &str) -> String {
    let kept = heading
        .chars()
        .filter(|it| it.is_alphanumeric() || " -_".contains(*it));
    kept.map(|it| if it == ' ' { '-' } else { it.to_ascii_lowercase() })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_of_problem_is_found() {
        let text = read(FILE);
        let rows = [
            (text.clone(), ""),
            (text.replace("\nMC_Jog jogging.md", ""), "no line for MC_Jog"),
            (
                text.replace("\nMC_Jog jogging.md", "\nMC_Jog"),
                "MC_Jog has no guide",
            ),
            (
                format!("{text}MC_Jog homing.md\n"),
                "MC_Jog has more than one line",
            ),
            (format!("{text}MC_Jig none\n"), "`MC_Jig` is not a block"),
        ];
        for (text, expected) in rows {
            let problems = problems_of(&text).join("\n");
            assert_eq!(problems.is_empty(), expected.is_empty(), "{problems}");
            assert!(problems.contains(expected), "{problems}");
        }
    }
}
