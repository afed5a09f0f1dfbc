//! Standard output, and the end of it when nobody reads it any more.

use standstill_trace::printable_lines;
use std::io::{self, BufWriter, ErrorKind, Stdout, Write};
use std::sync::{LazyLock, Mutex, MutexGuard};

/// What is on its way to standard output. It is here for all, so that what was printed is there when `--time-limit` ends
/// the program from another thread.
static STANDARD: LazyLock<Mutex<Standard>> = LazyLock::new(|| {
    Mutex::new(Standard {
        out: BufWriter::new(io::stdout()),
        closed: false,
    })
});

struct Standard {
    out: BufWriter<Stdout>,
    /// The reader has gone, as in `standstill test | head -1`.
    closed: bool,
}

impl Standard {
    /// Does something with the output; what a reader who has gone would have got is dropped. A command goes on: its status
    /// is that of what it finds, whether or not somebody reads it.
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
}

fn standard() -> MutexGuard<'static, Standard> {
    STANDARD.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Whether nobody reads standard output any more: for commands that would go on for as long as they get input.
pub fn is_closed() -> bool {
    standard().closed
}

/// Sends out what is on its way, if nobody is just writing.
pub fn flush_if_free() {
    if let Ok(mut standard) = STANDARD.try_lock() {
        // The program ends, whatever becomes of it.
        let _ = standard.with(BufWriter::flush);
    }
}

/// Standard output.
#[derive(Debug)]
pub struct Out {
    is_data: bool,
}

impl Out {
    /// For people: what could do something to a terminal is shown instead, see [`printable_lines`].
    pub const fn text() -> Self {
        Self { is_data: false }
    }

    /// For programs: JSON, CSV and scripts as they are.
    pub const fn data() -> Self {
        Self { is_data: true }
    }
}

impl Write for Out {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        standard().with(|out| match str::from_utf8(bytes) {
            Ok(text) if !self.is_data => out.write_all(printable_lines(text).as_bytes()),
            _ => out.write_all(bytes),
        })?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        standard().with(BufWriter::flush)
    }
}
