//! The state of the view, and the effect of keys. It reads no clock and no terminal, so tests can drive
//! it.

use crate::points::{Line, lines};
use crate::program::{self, Side, View};
use standstill_script::model::{Point, Script};
use standstill_script::{Outcome, RunError, Session, Standing};
use standstill_trace::{Event, EventLog};

/// Number of visible program lines that is assumed to centre the line of a fault.
const LINES_AROUND: usize = 16;

/// Largest number of events in the list.
const EVENTS_KEPT: usize = 1000;

/// Speeds of a run, in cycles of the script per cycle of the clock; the last is as fast as possible.
pub const SPEEDS: [f64; 6] = [0.01, 0.1, 1.0, 10.0, 100.0, f64::INFINITY];

/// A key with a meaning, independent of the terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// A character.
    Char(char),
    /// Enter.
    Enter,
    /// Escape.
    Escape,
    /// Backspace.
    Backspace,
    /// Tab.
    Tab,
    /// An arrow or page key: this many lines down.
    Down(i32),
}

/// The mode of the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Waits for a key.
    Paused,
    /// Scans at its speed.
    Running,
    /// Scans as fast as possible until an event.
    ToEvent,
    /// Scans as fast as possible until a claim is decided.
    ToClaim,
}

/// The box over the screen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Over {
    Nothing,
    Help,
    /// The text for a point so far.
    Edit(Point, String),
}

/// Saves the changed script; returns the message.
pub type Save<'a> = Box<dyn FnMut(&[standstill_script::Change]) -> Result<String, String> + 'a>;

/// A script being watched.
pub struct App<'a> {
    pub(crate) script: &'a Script,
    pub(crate) name: String,
    pub(crate) session: Session<'a>,
    log: EventLog,
    pub(crate) events: Vec<Event>,
    pub(crate) standings: Vec<Standing>,
    /// The text of every claim.
    pub(crate) says: Vec<String>,
    pub(crate) mode: Mode,
    speed: usize,
    /// Scans that the clock requires and that are not done yet.
    owed: f64,
    pub(crate) axis: usize,
    pub(crate) lines: Vec<Line>,
    pub(crate) selected: usize,
    pub(crate) over: Over,
    pub(crate) message: String,
    pub(crate) broken: bool,
    /// The program in view, if any.
    pub(crate) view: Option<View>,
    quit: bool,
    save: Save<'a>,
}

impl<'a> App<'a> {
    /// A script before its first scan, with its name on the screen.
    ///
    /// # Errors
    /// [`RunError`]: the script cannot be set up.
    pub fn new(script: &'a Script, name: &str, save: Save<'a>) -> Result<Self, RunError> {
        let lines = lines(script);
        let session = Session::new(script)?;
        Ok(Self {
            script,
            name: name.to_owned(),
            says: session.claims(),
            session,
            log: EventLog::default(),
            events: Vec::new(),
            standings: vec![Standing::Open; script.claims.len()],
            mode: Mode::Paused,
            speed: 2,
            owed: 0.0,
            axis: 0,
            selected: lines.iter().position(|line| line.point.is_some()).unwrap_or(0),
            lines,
            over: Over::Nothing,
            message: "? for help".to_owned(),
            broken: false,
            view: None,
            quit: false,
            save,
        })
    }

    /// Whether the view is to end.
    #[must_use]
    pub const fn is_done(&self) -> bool {
        self.quit
    }

    /// The state of the run.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// Scans done.
    #[must_use]
    pub const fn scans(&self) -> u64 {
        self.session.scans()
    }

    pub(crate) fn speed(&self) -> f64 {
        SPEEDS.get(self.speed).copied().unwrap_or(1.0)
    }

    /// The claims that hold, fail and are open.
    #[must_use]
    pub fn tally(&self) -> (usize, usize, usize) {
        let count = |is: fn(&Standing) -> bool| self.standings.iter().filter(|standing| is(standing)).count();
        (
            count(|standing| matches!(standing, Standing::Held(_))),
            count(|standing| matches!(standing, Standing::Failed(_))),
            count(|standing| matches!(standing, Standing::Open)),
        )
    }

    /// The reason why the run ended early, if it did.
    #[must_use]
    pub fn broken(&self) -> Option<&str> {
        self.broken.then_some(self.message.as_str())
    }

    /// Judges the run so far.
    #[must_use]
    pub fn finish(self) -> Outcome {
        self.session.finish()
    }

    /// Adds elapsed time (s). [`App::work`] does the scans that are then due.
    pub fn elapsed(&mut self, seconds: f64) {
        self.owed = match self.mode {
            Mode::Paused => 0.0,
            Mode::ToEvent | Mode::ToClaim => f64::INFINITY,
            Mode::Running => {
                let cycle = self.script.cycle_ns as f64 / 1e9;
                // Time lost by a slow terminal is not made up.
                self.owed.min(1.0) + seconds * self.speed() / cycle
            }
        };
    }

    /// Does one scan if one is due; FALSE if there is nothing to do.
    pub fn work(&mut self) -> bool {
        if self.mode == Mode::Paused || self.owed < 1.0 {
            return false;
        }
        self.owed -= 1.0;
        let open = self.tally().2;
        let events = self.scan();
        let is_there = match self.mode {
            Mode::ToEvent => events,
            Mode::ToClaim => self.tally().2 != open,
            Mode::Paused | Mode::Running => false,
        };
        if is_there || self.session.is_over() {
            self.mode = Mode::Paused;
        }
        self.mode != Mode::Paused
    }

    /// One scan; returns whether it had an event.
    fn scan(&mut self) -> bool {
        match self.session.advance() {
            Ok(true) => {}
            Ok(false) => return false,
            Err(error) => {
                self.message = format!("the run ended: {error}");
                self.broken = true;
                return false;
            }
        }
        if let Some(view) = &mut self.view {
            view.look(&self.session);
        }
        let events = self.log.take(self.session.trace());
        self.tell_fault(&events);
        let some = !events.is_empty();
        self.events.extend(events);
        let surplus = self.events.len().saturating_sub(EVENTS_KEPT);
        self.events.drain(..surplus);
        self.standings = self.session.standings().to_vec();
        if self.session.is_over() {
            let (held, failed, _) = self.tally();
            self.message = format!("the run is over: {held} claims hold, {failed} fail; r starts again");
        }
        some
    }

    /// Reports where a program faulted, and shows the line.
    fn tell_fault(&mut self, events: &[Event]) {
        let fault = events.iter().find(|event| event.text.starts_with("faults: "));
        let Some(event) = fault else { return };
        let text = event.text.trim_start_matches("faults: ");
        let text = text.split("; the resource").next().unwrap_or(text);
        self.message = format!("scan {}: {text}", event.scan);
        let named = |program: &standstill_script::model::Program| program.name == event.subject;
        let program = self.script.programs.iter().position(named);
        if let (Some(program), Some(view)) = (program, &mut self.view)
            && view.program == program
            && let Some(row) = program::fault_row(self.script, program, &event.text)
        {
            view.go_to(row, LINES_AROUND);
        }
    }

    /// The next program; after the last one the axes again.
    fn next_view(&mut self) {
        let after = self.view.as_ref().map(|view| view.program);
        let next = program::next(self.script, after);
        if after.is_none() && next.is_none() {
            "this script has no program in Structured Text".clone_into(&mut self.message);
        }
        self.view = next.map(|program| View::new(program, &self.session));
    }

    /// The effect of keys while a program is in view; FALSE if they have their usual effect.
    fn view_key(&mut self, key: Key) -> bool {
        let Some(view) = &mut self.view else {
            return false;
        };
        let rows = || program::rows(self.script, view.program).len();
        match key {
            Key::Tab => {
                view.side = match view.side {
                    Side::Source => Side::Variables,
                    Side::Variables => Side::Source,
                };
            }
            Key::Down(lines) => view.scroll(lines, rows()),
            Key::Char('j') => view.scroll(1, rows()),
            Key::Char('k') => view.scroll(-1, rows()),
            Key::Enter => {
                "inputs are changed where the blocks are; v leads there".clone_into(&mut self.message)
            }
            _ => return false,
        }
        true
    }

    /// Takes a key.
    pub fn key(&mut self, key: Key) {
        match std::mem::replace(&mut self.over, Over::Nothing) {
            Over::Nothing => self.command(key),
            // Any key closes the help.
            Over::Help => {}
            Over::Edit(point, text) => self.edit(point, text, key),
        }
    }

    fn command(&mut self, key: Key) {
        if !self.broken {
            self.message.clear();
        }
        if self.view_key(key) {
            return;
        }
        match key {
            Key::Char('q') | Key::Escape => self.quit = true,
            Key::Char('v') => self.next_view(),
            Key::Char('?' | 'h') => self.over = Over::Help,
            Key::Char(' ') => self.go(if self.mode == Mode::Paused {
                Mode::Running
            } else {
                Mode::Paused
            }),
            Key::Char('s') => self.steps(1),
            Key::Char('S') => self.steps(10),
            Key::Char('e') => self.go(Mode::ToEvent),
            Key::Char('c') => self.go(Mode::ToClaim),
            Key::Char('+') => self.speed = (self.speed + 1).min(SPEEDS.len() - 1),
            Key::Char('-') => self.speed = self.speed.saturating_sub(1),
            Key::Char('r') => self.restart(),
            Key::Char('w') => self.write(),
            Key::Tab => self.axis = (self.axis + 1) % self.script.axes.len().max(1),
            Key::Down(lines) => self.select(lines),
            Key::Char('j') => self.select(1),
            Key::Char('k') => self.select(-1),
            Key::Enter => self.begin_edit(),
            Key::Char(_) | Key::Backspace => "no such key; ? for help".clone_into(&mut self.message),
        }
    }

    fn go(&mut self, mode: Mode) {
        if self.session.is_over() {
            if !self.broken {
                "the run is over; r starts again".clone_into(&mut self.message);
            }
            return;
        }
        (self.mode, self.owed) = (mode, 0.0);
    }

    fn steps(&mut self, scans: u32) {
        self.go(Mode::Paused);
        for _ in 0..scans {
            self.scan();
        }
    }

    fn restart(&mut self) {
        match Session::new(self.script) {
            Ok(session) => self.session = session,
            // It was possible before.
            Err(error) => {
                self.message = error.to_string();
                return;
            }
        }
        self.log = EventLog::default();
        self.events.clear();
        self.standings.fill(Standing::Open);
        (self.mode, self.owed, self.broken) = (Mode::Paused, 0.0, false);
        self.view = self
            .view
            .take()
            .map(|view| View::new(view.program, &self.session));
        "from the start, without the changes".clone_into(&mut self.message);
    }

    fn write(&mut self) {
        self.message = match self.session.changes() {
            [] => "nothing was changed, so there is nothing to write".to_owned(),
            changes => (self.save)(changes).unwrap_or_else(|why| format!("not written: {why}")),
        };
    }

    /// Moves the selection, over points only.
    fn select(&mut self, lines: i32) {
        for _ in 0..lines.unsigned_abs() {
            let points = |index: &usize| self.lines.get(*index).is_some_and(|line| line.point.is_some());
            let next = if lines > 0 {
                (self.selected + 1..self.lines.len()).find(points)
            } else {
                (0..self.selected).rev().find(points)
            };
            self.selected = next.unwrap_or(self.selected);
        }
    }

    /// Inverts a BOOL; opens the input of any other value.
    fn begin_edit(&mut self) {
        let Some(line) = self.lines.get(self.selected) else {
            return;
        };
        let Some(point) = line.point else { return };
        if let Some(obstacle) = self.session.obstacle(point) {
            self.message = format!("{}: {obstacle}", line.full);
            return;
        }
        match self.value(point).as_deref() {
            Some("TRUE") => self.change(point, "FALSE"),
            Some("FALSE") => self.change(point, "TRUE"),
            _ => self.over = Over::Edit(point, String::new()),
        }
    }

    fn edit(&mut self, point: Point, mut text: String, key: Key) {
        match key {
            Key::Enter => return self.change(point, &text),
            Key::Escape => return,
            Key::Backspace => {
                text.pop();
            }
            Key::Char(character) if !character.is_control() => text.push(character),
            Key::Char(_) | Key::Tab | Key::Down(_) => {}
        }
        self.over = Over::Edit(point, text);
    }

    fn change(&mut self, point: Point, text: &str) {
        self.message = match self.session.change(point, text) {
            Ok(()) => match self.session.changes().last() {
                Some(change) => format!(
                    "{} = {} from scan {} on; w writes a script",
                    change.name, change.json, change.scan
                ),
                None => String::new(),
            },
            Err(why) => why,
        };
    }

    /// The value at a point as text: that of the last row, or the one that it will have in the first.
    pub(crate) fn value(&self, point: Point) -> Option<String> {
        self.session.text(point)
    }
}
