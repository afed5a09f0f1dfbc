//! The terminal around the screen. It is taken over, and restored on every way out, including a panic and
//! a signal.

use crate::app::{App, Key, Mode};
use crate::view::draw;
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use signal_hook::consts::{SIGINT, SIGTERM};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Time between two screens while the run continues.
const FRAME: Duration = Duration::from_millis(40);

/// Time between two checks for a signal while nothing happens.
const IDLE: Duration = Duration::from_millis(100);

/// The part of a frame that the run may use; the rest is for the screen.
const WORK: Duration = Duration::from_millis(30);

/// Number of [`IDLE`] checks after which a view must have ended after a request to end.
const PATIENCE: u32 = 3;

/// The end of the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// By a key.
    Quit,
    /// By this signal. Terminals are restored; the caller must still perform the effect of the signal.
    Signal(i32),
}

impl Ended {
    /// By the signal that [`signals`] keeps.
    fn of(signal: usize) -> Self {
        Self::Signal(i32::try_from(signal).unwrap_or(SIGTERM))
    }

    /// Ends the program as the signal would have, if there was one. Returns only if there was none.
    ///
    /// # Errors
    /// An error of the system.
    pub fn pass_on(self) -> io::Result<()> {
        match self {
            Self::Quit => Ok(()),
            Self::Signal(signal) => signal_hook::low_level::emulate_default_handler(signal),
        }
    }
}

/// Restores the terminal when it is dropped, and ends the guard.
struct Taken {
    guard: Arc<Guard>,
}

impl Drop for Taken {
    fn drop(&mut self) {
        self.guard.is_over.store(true, Ordering::Relaxed);
        // An error here has no remedy.
        let _ = ratatui::try_restore();
    }
}

/// Restores the terminal from any thread, as far as it accepts output, even while the view is blocked.
pub fn give_back() {
    let _ = ratatui::crossterm::terminal::disable_raw_mode();
    #[cfg(unix)]
    line::leave();
}

/// Ends the program when the view cannot: it may be blocked by a long scan, or by a terminal that accepts
/// no output or is gone. After a hang-up crossterm reads from the terminal for ever.
struct Guard {
    signals: Arc<AtomicUsize>,
    is_over: AtomicBool,
}

impl Guard {
    /// Begins to check for signals and for the end of the terminal.
    fn start(signals: Arc<AtomicUsize>) -> io::Result<Arc<Self>> {
        let guard = Arc::new(Self {
            signals,
            is_over: AtomicBool::new(false),
        });
        let own = Arc::clone(&guard);
        thread::Builder::new()
            .name("terminal".to_owned())
            .spawn(move || own.look())?;
        Ok(guard)
    }

    fn look(&self) {
        let mut asked = 0;
        while !self.is_over.load(Ordering::Relaxed) {
            thread::sleep(IDLE);
            #[cfg(unix)]
            if line::is_hung_up() {
                let hangup = usize::try_from(signal_hook::consts::SIGHUP).unwrap_or_default();
                let _first = self
                    .signals
                    .compare_exchange(0, hangup, Ordering::Relaxed, Ordering::Relaxed);
            }
            let signal = self.signals.load(Ordering::Relaxed);
            asked += u32::from(signal != 0);
            if asked > PATIENCE && !self.is_over.load(Ordering::Relaxed) {
                give_back();
                // Returns only if the system refuses; nothing more can be done then.
                let _ = Ended::of(signal).pass_on();
                std::process::exit(1);
            }
        }
    }
}

/// The line to the terminal, which crossterm does not check.
#[cfg(unix)]
mod line {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    use std::io;
    use std::time::Duration;

    /// The events of the line within `wait`.
    fn ready(fd: &impl rustix::fd::AsFd, wanted: PollFlags, wait: Duration) -> PollFlags {
        let mut fds = [PollFd::new(fd, wanted)];
        let wait = Timespec::try_from(wait).ok();
        // After an interruption by a signal there are no events.
        match poll(&mut fds, wait.as_ref()) {
            Ok(_) => fds[0].revents(),
            Err(_) => PollFlags::empty(),
        }
    }

    /// Whether the other end is closed.
    pub fn is_hung_up() -> bool {
        ready(&io::stdin(), PollFlags::empty(), Duration::ZERO).contains(PollFlags::HUP)
    }

    /// Waits for input; returns whether the other end is open.
    pub fn wait(time: Duration) -> bool {
        !ready(&io::stdin(), PollFlags::IN, time).contains(PollFlags::HUP)
    }

    /// Leaves the alternate screen and shows the cursor, if that can be written at once.
    pub fn leave() {
        let out = io::stdout();
        if ready(&out, PollFlags::OUT, Duration::ZERO).contains(PollFlags::OUT) {
            let _ = rustix::io::write(&out, b"\x1b[?1049l\x1b[?25h");
        }
    }
}

/// Runs the view until a key, a signal or the end of the terminal ends it; `color` says whether colours
/// may be used.
///
/// # Errors
/// The error of the terminal.
pub fn watch(app: &mut App<'_>, color: bool) -> io::Result<Ended> {
    let signals = signals()?;
    let guard = Guard::start(Arc::clone(&signals))?;
    let taken = Taken { guard };
    // Also in a panic, restores the terminal before the message is printed.
    let mut terminal = ratatui::try_init()?;
    let ended = run(app, color, &mut terminal, &signals);
    drop(taken);
    #[cfg(unix)]
    if line::is_hung_up() {
        // Its drop would show the cursor and report a failure on standard error, which is a panic if that
        // is gone.
        std::mem::forget(terminal);
    }
    match ended {
        // An error of a terminal that is gone is its end.
        #[cfg(unix)]
        Err(_) if line::is_hung_up() => Ok(Ended::Signal(signal_hook::consts::SIGHUP)),
        ended => ended,
    }
}

fn run(
    app: &mut App<'_>,
    color: bool,
    terminal: &mut DefaultTerminal,
    signals: &AtomicUsize,
) -> io::Result<Ended> {
    let mut before = Instant::now();
    // The screen is drawn when it may have changed, so that nothing is sent over a slow line while
    // nothing happens.
    let mut stale = true;
    while !app.is_done() {
        match signals.load(Ordering::Relaxed) {
            0 => {}
            signal => return Ok(Ended::of(signal)),
        }
        if std::mem::take(&mut stale) {
            terminal.draw(|frame| draw(frame, app, color))?;
        }
        let wait = if app.mode() == Mode::Paused {
            IDLE
        } else {
            FRAME.saturating_sub(WORK)
        };
        #[cfg(unix)]
        let wait = match line::wait(wait) {
            true => Duration::ZERO,
            false => return Ok(Ended::Signal(signal_hook::consts::SIGHUP)),
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

/// Takes an event; TRUE for Ctrl-C, which is a key in this mode of the terminal.
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
