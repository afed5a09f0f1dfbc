//! Standard output, and its end when its reader has gone.

use crate::paint;
use standstill_trace::printable_lines;
use std::io::{self, BufWriter, ErrorKind, Stdout, Write};
use std::sync::{LazyLock, Mutex, MutexGuard};

/// Text for standard output that is not written yet. It is global, so that it can be written when
/// `--time-limit` ends the program from another thread.
static STANDARD: LazyLock<Mutex<Standard>> = LazyLock::new(|| {
    Mutex::new(Standard {
        out: BufWriter::new(io::stdout()),
        closed: false,
        colours: paint::wanted(&io::stdout()),
        line: String::new(),
    })
});

struct Standard {
    out: BufWriter<Stdout>,
    /// The reader has gone, as in `standstill test | head -1`.
    closed: bool,
    /// Text gets colours.
    colours: bool,
    /// Text of an incomplete line: colours are put on whole lines.
    line: String,
}

impl Standard {
    /// Writes to the output. Text for a reader that is gone is dropped. The command continues: its status is its
    /// result, with or without a reader.
    fn with(&mut self, write: impl FnOnce(&mut BufWriter<Stdout>) -> io::Result<()>) -> io::Result<()> {
        if self.closed {
            return Ok(());
        }
        match write(&mut self.out) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                self.closed = true;
                Ok(())
            }
            other => other,
        }
    }

    /// Writes text, with colours if they are wanted.
    fn text(&mut self, text: &str) -> io::Result<()> {
        if !self.colours {
            return self.with(|out| out.write_all(text.as_bytes()));
        }
        self.line.push_str(text);
        let whole = self.line.rfind('\n').map_or(0, |end| end + 1);
        let lines: String = self.line.drain(..whole).collect();
        self.with(|out| out.write_all(paint::lines(&lines).as_bytes()))
    }

    /// Writes the waiting text.
    fn flush(&mut self) -> io::Result<()> {
        let rest = std::mem::take(&mut self.line);
        self.with(|out| {
            out.write_all(rest.as_bytes())?;
            out.flush()
        })
    }
}

fn standard() -> MutexGuard<'static, Standard> {
    STANDARD.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Whether the reader of standard output is gone, for commands that would otherwise continue as long as they
/// receive input.
pub fn is_closed() -> bool {
    standard().closed
}

/// Writes the waiting text and a last one, unless another thread is writing.
pub fn end_if_free(last: &str) {
    if let Ok(mut standard) = STANDARD.try_lock() {
        // The program ends in any case.
        let _ = standard.with(|out| out.write_all(last.as_bytes()));
        let _ = standard.flush();
    }
}

/// Standard output.
#[derive(Debug)]
pub struct Out {
    is_data: bool,
}

impl Out {
    /// For people: characters with an effect on a terminal are shown in escaped form, see
    /// [`printable_lines`].
    pub const fn text() -> Self {
        Self { is_data: false }
    }

    /// For programs: JSON, CSV and scripts, unchanged.
    pub const fn data() -> Self {
        Self { is_data: true }
    }
}

impl Write for Out {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match str::from_utf8(bytes) {
            Ok(text) if !self.is_data => standard().text(&printable_lines(text)),
            _ => standard().with(|out| out.write_all(bytes)),
        }?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        standard().flush()
    }
}
