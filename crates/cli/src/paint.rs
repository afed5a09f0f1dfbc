//! Colours on a terminal. They are added to whole lines of text when these are written, so commands need
//! no code for them, and pipes and files get none.

use anstream::stream::RawStream;
use anstream::{AutoStream, ColorChoice};
use anstyle::{AnsiColor, Style};

/// Whether a stream gets colours: it is a terminal, and none of `NO_COLOR`, `CLICOLOR=0` and `TERM=dumb`
/// is set. `CLICOLOR_FORCE` adds them in any case.
pub fn wanted(stream: &impl RawStream) -> bool {
    AutoStream::choice(stream) != ColorChoice::Never
}

const GOOD: Style = AnsiColor::Green.on_default();
const BAD: Style = AnsiColor::Red.on_default().bold();
const DOUBTFUL: Style = AnsiColor::Yellow.on_default().bold();
const HELP: Style = AnsiColor::Cyan.on_default();
const PLACE: Style = AnsiColor::BrightBlue.on_default();

/// The beginnings of lines, and their styles.
const HEADS: [(&str, Style); 10] = [
    ("ok  ", GOOD),
    ("accepted", GOOD),
    ("passed", GOOD),
    ("FAILED", BAD),
    ("BROKEN", BAD),
    ("ORPHAN", DOUBTFUL),
    ("error", BAD),
    ("warning", DOUBTFUL),
    ("note", HELP),
    ("help", HELP),
];

/// The words that a line may have after `: `, such as the last line of a run.
const VERDICTS: [(&str, Style); 2] = [("passed, ", GOOD), ("FAILED, ", BAD)];

/// Whole lines with colours.
pub fn lines(text: &str) -> String {
    text.split_inclusive('\n').map(line).collect()
}

fn line(line: &str) -> String {
    let is_word = |rest: &str| rest.starts_with(|next: char| next.is_alphanumeric() || next == '_');
    let begins = |head: &str| line.strip_prefix(head).is_some_and(|rest| !is_word(rest));
    let head = HEADS.iter().find(|(head, _)| begins(head));
    if let Some((head, style)) = head {
        return over(line, 0, head.trim_end().len(), *style);
    }
    for (verdict, style) in VERDICTS {
        if let Some(at) = line.find(&format!(": {verdict}")) {
            return over(line, at + 2, verdict.len() - 2, style);
        }
    }
    // The margin of an excerpt: `  --> file:3:5`, `3 | text`, `  |  ^^^`.
    let margin = line.trim_start_matches(|character: char| character == ' ' || character.is_ascii_digit());
    let width = line.len() - margin.len();
    match margin.split_inclusive(' ').next() {
        Some("--> ") => over(line, 0, width + 3, PLACE),
        Some("| " | "|\n" | "|") if width > 0 => over(line, 0, width + 1, PLACE),
        _ => line.to_owned(),
    }
}

/// A line with a style over some of its bytes.
fn over(line: &str, from: usize, length: usize, style: Style) -> String {
    let (before, rest) = line.split_at(from);
    let (styled, after) = rest.split_at(length);
    format!("{before}{style}{styled}{style:#}{after}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_messages_and_margins_are_coloured_and_nothing_else() {
        let text = "ok        a.scan.json\nFAILED    b.scan.json\n    okay\nerror[unknown_key]: no key `a`\n --> a.scan.json:3:5\n  |\n3 | text\na.scan.json: passed, 2 of 2 claims\nokay: no\nerrors\n";
        let green = |text: &str| format!("\u{1b}[32m{text}\u{1b}[0m");
        let red = |text: &str| format!("\u{1b}[1m\u{1b}[31m{text}\u{1b}[0m");
        let blue = |text: &str| format!("\u{1b}[94m{text}\u{1b}[0m");
        let expected = format!(
            "{}        a.scan.json\n{}    b.scan.json\n    okay\n{}[unknown_key]: no key `a`\n{} a.scan.json:3:5\n{}\n{} text\na.scan.json: {}, 2 of 2 claims\nokay: no\nerrors\n",
            green("ok"),
            red("FAILED"),
            red("error"),
            blue(" -->"),
            blue("  |"),
            blue("3 |"),
            green("passed"),
        );
        assert_eq!(lines(text), expected);
        let plain: String = anstream::adapter::strip_str(&lines(text)).to_string();
        assert_eq!(plain, text);
    }
}
