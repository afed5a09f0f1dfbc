//! The files of a project as one sequence of bytes, and places in it.

use crate::error::{Code, Diagnostic, Found};

/// Largest number of bytes of all sources together.
pub const SOURCES_MOST: usize = 16 << 20;

/// A file to be compiled.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// Its name in messages, with `/`.
    pub name: &'a str,
    /// Its contents; must be UTF-8.
    pub bytes: &'a [u8],
}

/// A piece of the sources: bytes from `start` up to `end` in the sequence of all files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// Behind the last byte.
    pub end: u32,
}

impl Span {
    /// From the first byte of `self` to the last one of `other`.
    pub(crate) fn to(self, other: Self) -> Self {
        Self {
            start: self.start,
            end: other.end.max(self.start),
        }
    }

    /// The place right behind it.
    pub(crate) const fn after(self) -> Self {
        Self {
            start: self.end,
            end: self.end,
        }
    }

    /// The place right before it.
    pub(crate) const fn before(self) -> Self {
        Self {
            start: self.start,
            end: self.start,
        }
    }
}

/// The position of a character: line and column from 1, the column in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    /// Line.
    pub line: u32,
    /// Column.
    pub column: u32,
}

#[derive(Clone, Debug)]
struct File {
    name: String,
    text: String,
    /// Offset of its first byte in the sequence of all files.
    start: u32,
    /// The offsets of its lines.
    lines: Vec<u32>,
}

/// The bytes of all of them.
pub(crate) fn total(sources: &[Source<'_>]) -> usize {
    sources.iter().map(|source| source.bytes.len()).sum()
}

/// The files of a project.
#[derive(Clone, Debug)]
pub struct Sources {
    files: Vec<File>,
}

/// The bytes of the first tag of a file of an IDE, and where the Structured Text is in it.
fn markup(text: &str) -> Option<(u32, &'static str)> {
    const BEGINNINGS: [&str; 3] = ["<?xml", "<TcPlcObject", "<project"];
    let beginning = BEGINNINGS
        .iter()
        .find(|beginning| text.starts_with(**beginning))?;
    let help = if text.contains("<TcPlcObject") {
        "put what stands in its <Declaration> and <ST>, between `<![CDATA[` and `]]>`, into a file .st, and END_PROGRAM, \
         END_FUNCTION_BLOCK or END_FUNCTION behind it"
    } else {
        "put the Structured Text in it into a file .st: the declarations, the statements from <ST>, and the end, such as \
         END_PROGRAM"
    };
    Some((beginning.len() as u32, help))
}

impl Sources {
    /// Takes the files; a byte order mark is left out. Reports text that is no UTF-8, and too much text.
    pub(crate) fn new(sources: &[Source<'_>], found: &mut Found) -> Self {
        let mut files = Vec::new();
        let mut start = 0_u32;
        let total = total(sources);
        for source in sources {
            let bytes = source.bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(source.bytes);
            let bytes: &[u8] = if total > SOURCES_MOST { &[] } else { bytes };
            let (text, bad) = match std::str::from_utf8(bytes) {
                Ok(text) => (text.to_owned(), None),
                Err(error) => {
                    let good = bytes.get(..error.valid_up_to()).unwrap_or_default();
                    (
                        String::from_utf8_lossy(good).into_owned(),
                        Some(error.valid_up_to()),
                    )
                }
            };
            // One further than the text, because a message may point at the end of a file.
            let after = start + text.len() as u32 + 1;
            if let Some(at) = bad {
                let at = start + at as u32;
                found.add(
                    Diagnostic::error(
                        Code::Encoding,
                        Span { start: at, end: at },
                        "the text is not UTF-8 from here on",
                    )
                    .help("save the file as UTF-8: in most editors under Save As, Encoding"),
                );
            }
            if let Some((length, help)) = markup(&text) {
                let span = Span {
                    start,
                    end: start + length,
                };
                let message = "this file is XML, not Structured Text";
                found.add(Diagnostic::error(Code::Syntax, span, message).help(help));
            }
            let starts = text.bytes().zip(1..).filter(|(byte, _)| *byte == b'\n');
            let lines = std::iter::once(0).chain(starts.map(|(_, at)| at)).collect();
            files.push(File {
                name: source.name.to_owned(),
                text,
                start,
                lines,
            });
            start = after;
        }
        if total > SOURCES_MOST {
            found.add(
                Diagnostic::error(
                    Code::TooLarge,
                    Span::default(),
                    format!("the sources have {total} bytes, more than the {SOURCES_MOST} that are read"),
                )
                .help("leave out files that are no part of the program"),
            );
        }
        if files.is_empty() {
            files.push(File {
                name: String::new(),
                text: String::new(),
                start: 0,
                lines: vec![0],
            });
        }
        Self { files }
    }

    /// The number of files.
    pub(crate) fn count(&self) -> usize {
        self.files.len()
    }

    /// The number of the file that a place is in.
    pub(crate) fn file_index(&self, span: Span) -> usize {
        self.index(span.start)
    }

    /// Whether a place is in the library's own text, which is the last file.
    pub(crate) fn in_library(&self, span: Span) -> bool {
        self.file_index(span) + 1 == self.count()
    }

    /// The text of a file, and the place of its first byte.
    pub(crate) fn text_of(&self, file: usize) -> (&str, u32) {
        self.files
            .get(file)
            .map_or(("", 0), |file| (&file.text, file.start))
    }

    /// The name of a file without folder and ending.
    pub(crate) fn stem(&self, file: usize) -> &str {
        let name = self.files.get(file).map_or("", |file| file.name.as_str());
        let name = name.rsplit('/').next().unwrap_or(name);
        name.split('.').next().unwrap_or(name)
    }

    fn index(&self, place: u32) -> usize {
        self.files
            .partition_point(|file| file.start <= place)
            .saturating_sub(1)
    }

    fn file(&self, place: u32) -> &File {
        &self.files[self.index(place)]
    }

    /// The text at a place.
    pub(crate) fn text(&self, span: Span) -> &str {
        let file = self.file(span.start);
        let range = (span.start - file.start) as usize..span.end.saturating_sub(file.start) as usize;
        file.text.get(range).unwrap_or_default()
    }

    /// The name of the file that a place is in.
    #[must_use]
    pub fn file_name(&self, span: Span) -> &str {
        &self.file(span.start).name
    }

    /// The number of the file that a place is in, and its bytes in that file; a byte order mark does not count.
    #[must_use]
    pub fn locate(&self, span: Span) -> (usize, std::ops::Range<usize>) {
        let index = self.index(span.start);
        let start = self.files.get(index).map_or(0, |file| file.start);
        let from = span.start.saturating_sub(start) as usize;
        (index, from..span.end.saturating_sub(start) as usize)
    }

    /// The comment behind a declaration on its line, otherwise the one on the lines before it.
    pub(crate) fn remark(&self, span: Span) -> String {
        let file = self.file(span.start);
        let at = (span.start - file.start) as usize;
        let before = file.text.get(..at).unwrap_or_default();
        let behind = file.text.get(at..).unwrap_or_default();
        let line = behind.lines().next().unwrap_or_default();
        if let Some((_, comment)) = line.split_once("//") {
            return comment.trim().to_owned();
        }
        if let Some((_, comment)) = line.split_once("(*")
            && let Some((comment, _)) = comment.split_once("*)")
        {
            return comment.trim().to_owned();
        }
        let mut lines: Vec<&str> = Vec::new();
        for line in before.lines().rev().skip(usize::from(!before.ends_with('\n'))) {
            let line = line.trim();
            let comment = line
                .strip_prefix("//")
                .or_else(|| line.strip_prefix("(*")?.strip_suffix("*)"));
            match comment {
                Some(comment) => lines.push(comment.trim()),
                None => break,
            }
        }
        lines.reverse();
        lines.join(" ")
    }

    /// Line and column of a byte. Cost: logarithmic in the lines, linear in the length of this one.
    #[must_use]
    pub fn position(&self, place: u32) -> Position {
        let file = self.file(place);
        let at = place - file.start;
        let line = file.lines.partition_point(|start| *start <= at);
        let start = file.lines.get(line.saturating_sub(1)).copied().unwrap_or(0);
        let before = file.text.get(start as usize..at as usize).unwrap_or_default();
        Position {
            line: line as u32,
            column: before.chars().count() as u32 + 1,
        }
    }

    /// The lines around a piece: their text, the number of the first, and the piece within them. `None` if a line is
    /// too long to be shown.
    pub(crate) fn excerpt(&self, span: Span) -> Option<(&str, u32, std::ops::Range<usize>)> {
        const LONGEST: usize = 2000;
        let file = self.file(span.start);
        let (from, to) = (span.start - file.start, span.end.max(span.start) - file.start);
        let first = file
            .lines
            .partition_point(|start| *start <= from)
            .saturating_sub(1);
        let last = file.lines.partition_point(|start| *start <= to).saturating_sub(1);
        let begin = file.lines.get(first).copied()? as usize;
        let end = file
            .lines
            .get(last + 1)
            .map_or(file.text.len(), |next| *next as usize);
        let text = file.text.get(begin..end)?;
        if text.len() > LONGEST {
            return None;
        }
        let text = text.trim_end_matches(['\n', '\r']);
        let at = |place: u32| (place as usize - begin).min(text.len());
        Some((text, first as u32 + 1, at(from)..at(to)))
    }
}
