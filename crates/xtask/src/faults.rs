//! `docs/faults.md`: every ErrorID with its cause, its appearance in a trace, and its remedy.
//!
//! Cause and remedy come from the table of errors, the traces from the goldens, the texts between them
//! from `crates/xtask/faults.txt`.

mod golden;

use crate::{Generated, NOTICE, read};
use golden::{Event, Golden, goldens};
use standstill_axis::ErrorId;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// The errors of one hundred, with its title and introduction.
#[derive(Debug)]
struct Class {
    number: u16,
    title: String,
    about: String,
    errors: Vec<Section>,
}

/// The text of the file about one error.
#[derive(Debug)]
struct Section {
    number: u16,
    shown: Shown,
    looks: String,
    remedy: String,
}

/// The golden that shows an error.
#[derive(Debug)]
enum Shown {
    /// In no golden.
    Never,
    /// In the first golden that has it.
    Anywhere,
    Scene(Scene),
}

/// Events of a golden around the scan that first shows an error.
#[derive(Debug)]
struct Scene {
    /// Below `scan-tests/`, without extension.
    script: String,
    subjects: Vec<String>,
    before: usize,
    after: usize,
}

/// The sources of the guide.
#[derive(Debug)]
pub struct Faults {
    classes: Vec<Class>,
    goldens: BTreeMap<String, Golden>,
}

/// The errors a block can show.
fn errors() -> impl Iterator<Item = ErrorId> {
    ErrorId::ALL.iter().copied().filter(|id| *id != ErrorId::None)
}

impl Faults {
    /// Reads the file and every golden.
    pub fn read() -> Self {
        Self {
            classes: Self::read_classes(),
            goldens: goldens(),
        }
    }

    fn read_classes() -> Vec<Class> {
        classes(&read("crates/xtask/faults.txt"))
    }

    fn section(&self, number: u16) -> Option<&Section> {
        let mut sections = self.classes.iter().flat_map(|class| &class.errors);
        sections.find(|section| section.number == number)
    }

    /// The scene of an error: the file's, or the first golden that shows it.
    fn scene(&self, id: ErrorId) -> Option<Scene> {
        if let Some(Shown::Scene(scene)) = self.section(id.number()).map(|section| &section.shown) {
            return Some(Scene {
                script: scene.script.clone(),
                subjects: scene.subjects.clone(),
                ..*scene
            });
        }
        // A refusal at the edge is clearer than the end of a waiting command.
        self.first(|event| event.text.starts_with("+Execute") && event.shows(id.number()))
            .or_else(|| self.first(|event| event.shows(id.number())))
    }

    /// The first such event of the goldens in the order of their names, alone.
    fn first(&self, is_wanted: impl Fn(&Event) -> bool) -> Option<Scene> {
        self.goldens.iter().find_map(|(script, golden)| {
            let event = golden.events.iter().find(|event| is_wanted(event))?;
            Some(Scene {
                script: script.clone(),
                subjects: vec![event.subject.clone()],
                before: 0,
                after: 0,
            })
        })
    }

    /// The golden and the lines of a scene; none if its subjects do not show the error there.
    fn play(&self, scene: &Scene, number: u16) -> Option<(&Golden, Vec<&Event>)> {
        let golden = self.goldens.get(&scene.script)?;
        let of_subjects = || {
            golden
                .events
                .iter()
                .filter(|event| scene.subjects.contains(&event.subject))
        };
        let at = of_subjects().find(|event| event.shows(number))?.scan;
        let range = at.saturating_sub(scene.before)..=at + scene.after;
        let lines = of_subjects().filter(|event| range.contains(&event.scan));
        Some((golden, lines.collect()))
    }

    /// The faults: an error that nothing shows without a reason; a scene that does not show its error or
    /// has a subject without events; a section for an unused number; a class without introduction.
    pub fn problems(&self) -> Vec<String> {
        let mut found = Vec::new();
        for id in errors() {
            let number = id.number();
            let never = matches!(
                self.section(number),
                Some(Section {
                    shown: Shown::Never,
                    ..
                })
            );
            let played = self.scene(id).and_then(|scene| {
                let (_, lines) = self.play(&scene, number)?;
                let is_shown = |subject: &String| lines.iter().any(|event| event.subject == *subject);
                scene.subjects.iter().all(is_shown).then_some(())
            });
            match (never, played) {
                (false, None) => found.push(format!(
                    "{number}: no golden shows it as crates/xtask/faults.txt says; name another scene, or `never` and the \
                     reason"
                )),
                (true, Some(())) => found.push(format!("{number}: a golden shows it; take `never` out of faults.txt")),
                (false, Some(())) | (true, None) => {}
            }
            if self.classes.iter().all(|class| class.number != number / 100) {
                found.push(format!("{number}: faults.txt has no `class {}`", number / 100));
            }
        }
        for section in self.classes.iter().flat_map(|class| &class.errors) {
            if errors().all(|id| id.number() != section.number) {
                found.push(format!("faults.txt: {} is not in use", section.number));
            }
        }
        found
    }

    /// The anchor of an error in the guide, and its cause.
    pub(crate) fn entry(&self, number: u16) -> (String, &'static str) {
        let id = errors().find(|id| id.number() == number);
        let id = id.unwrap_or_else(|| panic!("{number} is not an ErrorID in use"));
        (format!("{number}-{}", id.name().to_lowercase()), id.cause())
    }

    /// The errors that goldens show at the pin `ErrorID` of each block, with the first script that shows it.
    pub(crate) fn by_block(&self) -> BTreeMap<(String, u16), String> {
        let mut found = BTreeMap::new();
        for (script, golden) in &self.goldens {
            let types = golden::blocks(script);
            for event in &golden.events {
                let Some(block) = types.get(&event.subject) else {
                    continue;
                };
                let numbers = event
                    .text
                    .split(' ')
                    .filter_map(|word| word.strip_prefix("ErrorID="));
                for number in numbers
                    .filter_map(|number| number.parse().ok())
                    .filter(|it| *it != 0)
                {
                    found
                        .entry((block.clone(), number))
                        .or_insert_with(|| script.clone());
                }
            }
        }
        found
    }

    /// The words with which notes of goldens begin, such as `refused`; a changed pin or state is not a note.
    pub fn words_of_events(&self) -> BTreeSet<String> {
        let events = self.goldens.values().flat_map(|golden| &golden.events);
        let words = events.filter_map(|event| event.text.split([' ', ':']).next());
        words
            .filter(|word| !word.is_empty() && word.chars().all(|letter| letter.is_ascii_lowercase()))
            .map(str::to_owned)
            .collect()
    }

    /// The page.
    pub fn page(&self) -> Generated {
        let mut text = format!(
            "{NOTICE}# Fault guide\n\n\
             Every ErrorID: its cause, what it looks like, and what to do. The traces are lines of real runs, as\n\
             `standstill run SCRIPT` prints them: scan, instance or axis, and what changed (`+` a pin that became\n\
             TRUE, `-` one that became FALSE). The list alone, with the numbers that are out of use:\n\
             [error-ids.md](error-ids.md).\n\n\
             `ErrorID` at a block says why that block failed; `AxisErrorID` of MC_ReadAxisError says what is wrong\n\
             with the axis. Start with the axis: while it is in ErrorStop, commands given to it only say 202.\n"
        );
        for class in &self.classes {
            let _ = write!(
                text,
                "\n## {}: {}\n\n{}",
                class.number * 100,
                class.title,
                class.about
            );
            for id in errors().filter(|id| id.number() / 100 == class.number) {
                self.error(&mut text, id);
            }
        }
        Generated {
            path: "docs/faults.md".into(),
            text,
        }
    }

    fn error(&self, text: &mut String, id: ErrorId) {
        let number = id.number();
        let _ = write!(text, "\n### {number} {}\n\n{}\n", id.name(), id.cause());
        let section = self.section(number);
        if let Some(section) = section.filter(|section| !section.looks.is_empty()) {
            let _ = write!(text, "\n{}", section.looks);
        }
        if let Some(scene) = self.scene(id)
            && let Some((golden, lines)) = self.play(&scene, number)
        {
            let width = lines.iter().map(|event| event.subject.len()).max().unwrap_or(0);
            text.push_str("\n```text\n");
            for Event {
                scan,
                subject,
                text: what,
            } in lines
            {
                let _ = writeln!(text, "{scan:>5}  {subject:<width$}  {what}");
            }
            let _ = write!(
                text,
                "```\n\nFrom [{}](../scan-tests/{}.scan.json).\n",
                golden.title, scene.script
            );
        }
        let more = section.map_or("", |section| &section.remedy);
        let _ = write!(text, "\n**Remedy.** {}\n{more}", id.remedy());
    }
}

/// The classes of the file, in its order.
fn classes(text: &str) -> Vec<Class> {
    let mut classes: Vec<Class> = Vec::new();
    for line in text
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
    {
        if let Some(head) = line.strip_prefix("class ") {
            let (number, title) = head.split_once(' ').unwrap_or((head, ""));
            classes.push(Class {
                number: count(number),
                title: title.into(),
                about: String::new(),
                errors: Vec::new(),
            });
            continue;
        }
        let class = classes
            .last_mut()
            .unwrap_or_else(|| panic!("faults.txt: `{line}` stands before the first class"));
        if let Some(head) = line.strip_prefix("error ") {
            class.errors.push(section(head));
            continue;
        }
        let (place, line) = match (class.errors.last_mut(), line.strip_prefix("+ ")) {
            (Some(section), Some(line)) => (&mut section.remedy, line),
            (Some(section), None) => (&mut section.looks, line),
            (None, _) => (&mut class.about, line),
        };
        place.push_str(line);
        place.push('\n');
    }
    classes
}

fn section(head: &str) -> Section {
    let mut words = head.split(' ');
    let number = count(words.next().unwrap_or_default());
    let shown = match words.next() {
        None => Shown::Anywhere,
        Some("never") => Shown::Never,
        Some(script) => {
            let (numbers, subjects): (Vec<&str>, Vec<&str>) =
                words.partition(|word| word.starts_with(['+', '-']));
            let scans = |sign| {
                let word = numbers.iter().find_map(|word| word.strip_prefix(sign));
                usize::from(word.map_or(0, count))
            };
            Shown::Scene(Scene {
                script: script.into(),
                subjects: subjects.into_iter().map(Into::into).collect(),
                before: scans('-'),
                after: scans('+'),
            })
        }
    };
    Section {
        number,
        shown,
        looks: String::new(),
        remedy: String::new(),
    }
}

fn count(word: &str) -> u16 {
    word.parse()
        .unwrap_or_else(|_| panic!("faults.txt: `{word}` is not a number"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The problems of the file once it is edited, and of all goldens, which are read once.
    fn problems(goldens: &mut BTreeMap<String, Golden>, edit: impl Fn(&mut Vec<Class>)) -> String {
        let mut classes = Faults::read_classes();
        edit(&mut classes);
        let faults = Faults {
            classes,
            goldens: std::mem::take(goldens),
        };
        let told = faults.problems().join("\n");
        *goldens = faults.goldens;
        told
    }

    /// The problems if this line replaces the text of the file about the error.
    fn with(goldens: &mut BTreeMap<String, Golden>, line: &str) -> String {
        problems(goldens, |classes| {
            let new = section(line);
            for class in &mut *classes {
                class.errors.retain(|old| old.number != new.number);
            }
            classes[0].errors.push(new);
        })
    }

    #[test]
    fn each_kind_of_problem_is_found() {
        let goldens = &mut goldens();
        assert_eq!(problems(goldens, |_| {}), "");
        assert_eq!(with(goldens, "102"), "");
        let rows = [
            ("102 never", "102: a golden shows it"),
            ("102 no/such_script x", "102: no golden shows it"),
            (
                "102 bad_numbers/mc_move_absolute position",
                "102: no golden shows it",
            ),
            (
                "102 bad_numbers/mc_move_absolute velocity nobody",
                "102: no golden shows it",
            ),
            ("901", "901: no golden shows it"),
            ("999", "faults.txt: 999 is not in use"),
        ];
        for (line, expected) in rows {
            let told = with(goldens, line);
            assert!(told.contains(expected), "{line}: {told}");
        }
        let no_class = problems(goldens, |classes| classes.retain(|class| class.number != 6));
        assert!(
            no_class.contains("601: faults.txt has no `class 6`"),
            "{no_class}"
        );
    }

    #[test]
    fn every_error_in_use_has_a_section_with_a_trace_or_a_reason() {
        let faults = Faults::read();
        let page = faults.page().text;
        for id in errors() {
            let head = format!("\n### {} {}\n", id.number(), id.name());
            assert_eq!(page.matches(&head).count(), 1, "{head}");
        }
    }
}
