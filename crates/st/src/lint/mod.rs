//! Constructs that work but are probably not intended, especially with motion. They are searched for in programs
//! without mistakes.
//!
//! A lint is switched off in the text: `{lint off ST55}` from there to the end of the file, or to
//! `{lint on ST55}`.

mod facts;
mod paths;
mod rules;

use crate::check::Program;
use crate::error::{Diagnostic, Found};
use crate::source::Sources;

/// Searches for all lints. Cost: linear in the program, except for the calls of one instance in one unit.
pub(crate) fn lint(program: &Program<'_>, sources: &Sources, found: &mut Found) {
    let told = rules::all(program, &facts::gather(program));
    tell(told, sources, found);
}

/// Variables of type AXIS_REF of PROGRAMs, and global ones, that name no axis. `image` is the initial memory. No
/// statement gives any variable of this type another value.
pub(crate) fn without_axis(program: &Program<'_>, image: &[u8], sources: &Sources, found: &mut Found) {
    let told = rules::without_axis(program, &facts::gather(program), image);
    tell(told, sources, found);
}

fn tell(told: Vec<Diagnostic>, sources: &Sources, found: &mut Found) {
    let off = Off::new(sources);
    for diagnostic in told.into_iter().filter(|it| !off.holds(it)) {
        found.add(diagnostic);
    }
}

/// The ranges in which lints are switched off: the name, the first byte, and the end.
struct Off(Vec<(String, u32, u32)>);

impl Off {
    fn new(sources: &Sources) -> Self {
        let mut pieces = Vec::new();
        for file in 0..sources.count() {
            let (text, start) = sources.text_of(file);
            let mut open: Vec<(String, u32)> = Vec::new();
            for (place, _) in text.match_indices("{lint") {
                let inner = text.get(place + 1..).and_then(|rest| rest.split_once('}'));
                let words: Vec<&str> =
                    inner.map_or(Vec::new(), |(inner, _)| inner.split_whitespace().collect());
                let at = start + place as u32;
                match words.as_slice() {
                    ["lint", "off", names @ ..] => {
                        open.extend(names.iter().map(|name| (name.to_ascii_uppercase(), at)));
                    }
                    ["lint", "on", names @ ..] => {
                        for name in names {
                            let known = open.iter().position(|(open, _)| open.eq_ignore_ascii_case(name));
                            if let Some((name, from)) = known.map(|known| open.remove(known)) {
                                pieces.push((name, from, at));
                            }
                        }
                    }
                    _ => {}
                }
            }
            let end = start + text.len() as u32;
            pieces.extend(open.into_iter().map(|(name, from)| (name, from, end)));
        }
        Self(pieces)
    }

    fn holds(&self, diagnostic: &Diagnostic) -> bool {
        let at = diagnostic.span.start;
        let mut pieces = self.0.iter();
        pieces.any(|(name, from, to)| name == diagnostic.code.name() && *from <= at && at < *to)
    }
}
