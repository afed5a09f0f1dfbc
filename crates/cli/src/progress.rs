//! A line that tells how far a long command is, on standard error and only for a person.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

/// Shorter commands show nothing.
const PATIENCE: Duration = Duration::from_millis(500);

/// Time between two looks of the line.
const PERIOD: Duration = Duration::from_millis(100);

/// Takes the line back: return, then erase to its end.
const ERASE: &str = "\r\x1b[K";

/// The line. It is taken back when this is dropped.
#[derive(Debug)]
pub struct Progress {
    /// When the line may be written next; never if nobody watches.
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
            // Nothing depends on it being seen.
            let _ = write!(io::stderr(), "{ERASE}{}", text());
        }
    }

    /// Takes the line back, so that something else can be written.
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
