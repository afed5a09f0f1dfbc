//! A line on standard error that shows a person the progress of a long command.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

/// Shorter commands show nothing.
const PATIENCE: Duration = Duration::from_millis(500);

/// Time between two updates of the line.
const PERIOD: Duration = Duration::from_millis(100);

/// Erases the line: return, then erase to its end.
const ERASE: &str = "\r\x1b[K";

/// The line. It is erased when this is dropped.
#[derive(Debug)]
pub struct Progress {
    /// The next time to write the line; never without a terminal.
    next: Option<Instant>,
    shown: bool,
}

impl Progress {
    /// A line that will show once the command has taken a while, if standard error is a terminal.
    pub fn new(wanted: bool) -> Self {
        let watched = wanted && io::stderr().is_terminal();
        Self {
            next: watched.then(|| Instant::now() + PATIENCE),
            shown: false,
        }
    }

    /// Shows `text` if it is time to.
    pub fn show(&mut self, text: impl FnOnce() -> String) {
        let now = Instant::now();
        if self.next.is_some_and(|next| now >= next) {
            self.next = Some(now + PERIOD);
            self.shown = true;
            // Nothing depends on its being seen.
            let _ = write!(io::stderr(), "{ERASE}{}", text());
        }
    }

    /// Erases the line, so that other text can be written.
    pub fn clear(&mut self) {
        if self.shown {
            self.shown = false;
            let _ = write!(io::stderr(), "{ERASE}");
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.clear();
    }
}
