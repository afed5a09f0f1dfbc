//! `--time-limit`: ends any command that takes too long.

use crate::exit::{Exit, Failure, complain};
use crate::{out, outcome};
use standstill_trace::time_literal;
use std::process;
use std::sync::{Mutex, MutexGuard};
use std::thread;
use std::time::Duration;

/// The present work of the command.
static DOING: Mutex<String> = Mutex::new(String::new());

/// Actions before the program ends.
static FIRST: Mutex<Option<fn()>> = Mutex::new(None);

fn locked<T>(mutex: &'static Mutex<T>) -> MutexGuard<'static, T> {
    mutex.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Stores the present work of the command, for the message when the time is up.
pub fn doing(what: impl Into<String>) {
    *locked(&DOING) = what.into();
}

/// Registers `first`, which is called before the program ends: a terminal that was taken over must be
/// restored.
#[cfg(all(feature = "watch", any(unix, windows)))]
pub fn before_end(first: fn()) {
    *locked(&FIRST) = Some(first);
}

/// Ends the program after this time, unless it has ended by itself. A command with a JSON answer has not answered
/// yet; it then gives the reason.
pub fn start(limit_ns: u64, as_json: Option<String>) -> Result<(), Failure> {
    let watch = move || {
        thread::sleep(Duration::from_nanos(limit_ns));
        let at = locked(&DOING).clone();
        let text = format!(
            "error: --time-limit {}: the time is up; it was at {at}",
            time_literal(limit_ns)
        );
        let answer = as_json
            .as_deref()
            .map(|command| outcome::refused(command, Exit::Failed, &text) + "\n");
        out::end_if_free(&answer.unwrap_or_default());
        if let Some(first) = *locked(&FIRST) {
            first();
        }
        complain(&text);
        process::exit(i32::from(Exit::Failed as u8));
    };
    thread::Builder::new()
        .name("time-limit".to_owned())
        .spawn(watch)
        .map(drop)
        .map_err(|error| Failure::usage(&format!("--time-limit needs a thread of its own: {error}")))
}
