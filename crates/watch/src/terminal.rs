//! The terminal around the screen: taken over, given back on every way out, a panic and a signal among them.

use crate::app::{App, Key, Mode};
use crate::view::draw;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use signal_hook::consts::{SIGINT, SIGTERM};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Time between two screens while the run goes on.
const FRAME: Duration = Duration::from_millis(40);

/// Time between two looks for a signal while nothing goes on.
const IDLE: Duration = Duration::from_millis(100);

/// Of a frame the run gets so much at most; the rest is for the screen.
const WORK: Duration = Duration::from_millis(30);

/// How the watching ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// By a key.
    Quit,
    /// By this signal. Terminals are restored; the caller owes the signal its effect.
    Signal(i32),
}

impl Ended {
    /// Ends the program as the signal would have, if it was one. Returns only if it was none.
    ///
    /// # Errors
    /// What the system says.
    pub fn pass_on(self) -> io::Result<()> {
        match self {
            Self::Quit => Ok(()),
            Self::Signal(signal) => signal_hook::low_level::emulate_default_handler(signal),
        }
    }
}

/// Gives the terminal back when it is dropped.
struct Taken;

impl Drop for Taken {
    fn drop(&mut self) {
        // Nothing can be done about it on the way out.
        let _ = ratatui::try_restore();
    }
}

/// Watches until a key or a signal ends it; `color` says whether colours may be used.
///
/// # Errors
/// What the system says of the terminal.
pub fn watch(app: &mut App<'_>, color: bool) -> io::Result<Ended> {
    let signals = signals()?;
    // Takes the terminal back in a panic, too, before its message is printed.
    let mut terminal = ratatui::try_init()?;
    let _taken = Taken;
    let mut before = Instant::now();
    // A screen is drawn when it may have changed: over a slow line nothing is sent while nothing happens.
    let mut stale = true;
    while !app.is_done() {
        match signals.load(Ordering::Relaxed) {
            0 => {}
            signal => return Ok(Ended::Signal(i32::try_from(signal).unwrap_or(SIGTERM))),
        }
        if std::mem::take(&mut stale) {
            terminal.draw(|frame| draw(frame, app, color))?;
        }
        let wait = if app.mode() == Mode::Paused {
            IDLE
        } else {
            FRAME.saturating_sub(WORK)
        };
        if event::poll(wait)? {
            stale = true;
            if take(app, &event::read()?) {
                return Ok(Ended::Signal(SIGINT));
            }
        }
        let now = Instant::now();
        app.elapsed((now - before).as_secs_f64());
        before = now;
        let (scans, broken) = (app.scans(), app.broken().is_some());
        while app.work() && now.elapsed() < WORK {}
        stale |= app.scans() != scans || app.broken().is_some() != broken;
    }
    Ok(Ended::Quit)
}

/// The last signal that asked the program to end; 0 if none did.
fn signals() -> io::Result<Arc<AtomicUsize>> {
    let flag = Arc::new(AtomicUsize::new(0));
    #[cfg(unix)]
    let all = [SIGINT, SIGTERM, signal_hook::consts::SIGHUP];
    #[cfg(not(unix))]
    let all = [SIGINT, SIGTERM];
    for signal in all {
        let number = usize::try_from(signal).unwrap_or_default();
        signal_hook::flag::register_usize(signal, Arc::clone(&flag), number)?;
    }
    Ok(flag)
}

/// Takes an event; TRUE for Ctrl-C, which a terminal that is taken over gives as a key.
fn take(app: &mut App<'_>, event: &Event) -> bool {
    let Event::Key(KeyEvent {
        code,
        modifiers,
        kind: KeyEventKind::Press | KeyEventKind::Repeat,
        ..
    }) = *event
    else {
        return false;
    };
    if modifiers.contains(KeyModifiers::CONTROL) {
        return code == KeyCode::Char('c');
    }
    let key = match code {
        KeyCode::Char(character) => Key::Char(character),
        KeyCode::Right => Key::Char('s'),
        KeyCode::Enter => Key::Enter,
        KeyCode::Esc => Key::Escape,
        KeyCode::Backspace => Key::Backspace,
        KeyCode::Tab => Key::Tab,
        KeyCode::Down => Key::Down(1),
        KeyCode::Up => Key::Down(-1),
        KeyCode::PageDown => Key::Down(8),
        KeyCode::PageUp => Key::Down(-8),
        _ => return false,
    };
    app.key(key);
    false
}
