//! The screen.

use crate::app::{App, Mode, Over};
use crate::help::KEYS;
use crate::panes;
use crate::program::View;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Clear, Paragraph};
use standstill_trace::time_literal;

/// The smallest screen with room for everything: columns and lines.
pub const LEAST: (u16, u16) = (80, 24);

/// The style. Without colour, no information depends on colour alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    color: bool,
}

impl Look {
    fn tinted(self, color: Color) -> Style {
        if self.color {
            Style::new().fg(color)
        } else {
            Style::new()
        }
    }

    /// Active parts.
    pub(crate) fn on(self) -> Style {
        self.tinted(Color::Green).add_modifier(Modifier::BOLD)
    }

    /// Faulty parts.
    pub(crate) fn bad(self) -> Style {
        self.tinted(Color::Red).add_modifier(Modifier::BOLD)
    }

    /// The style of highlighted parts.
    pub(crate) fn lit(self) -> Style {
        Style::new().add_modifier(Modifier::REVERSED)
    }

    /// The style of minor parts.
    pub(crate) fn dim(self) -> Style {
        Style::new().add_modifier(Modifier::DIM)
    }
}

/// Draws the screen; without colour on request.
pub fn draw(frame: &mut Frame<'_>, app: &App<'_>, color: bool) {
    let look = Look { color };
    let area = frame.area();
    let (columns, lines) = LEAST;
    if area.width < columns || area.height < lines {
        return too_small(frame, area);
    }
    if let Some(view) = &app.view {
        program_view(frame, area, app, view, look);
        return over(frame, area, app);
    }
    let [head, top, bottom, foot] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Length(10),
        Constraint::Min(12),
        Constraint::Length(1),
    ])
    .areas(area);
    let [states, values] = Layout::horizontal([Constraint::Length(22), Constraint::Min(58)]).areas(top);
    let [pins, right] =
        Layout::horizontal([Constraint::Percentage(45), Constraint::Percentage(55)]).areas(bottom);
    let claims = u16::try_from(app.script.claims.len()).unwrap_or(u16::MAX);
    let claims = claims.saturating_add(2).clamp(3, (right.height * 2 / 5).max(5));
    let [events, claims] = Layout::vertical([Constraint::Min(5), Constraint::Length(claims)]).areas(right);
    header(frame, head, app, look);
    panes::states(frame, states, app, look);
    panes::values(frame, values, app, look);
    panes::pins(frame, pins, app, look);
    panes::events(frame, events, app);
    panes::claims(frame, claims, app, look);
    footer(frame, foot, app, look);
    over(frame, area, app);
}

/// A program: its text and its variables.
fn program_view(frame: &mut Frame<'_>, area: Rect, app: &App<'_>, view: &View, look: Look) {
    let [head, main, foot] =
        Layout::vertical([Constraint::Length(1), Constraint::Min(12), Constraint::Length(1)]).areas(area);
    let [source, variables] =
        Layout::horizontal([Constraint::Percentage(58), Constraint::Percentage(42)]).areas(main);
    header(frame, head, app, look);
    panes::source(frame, source, app, view, look);
    panes::variables(frame, variables, view, look);
    footer(frame, foot, app, look);
}

/// A window over the screen.
fn over(frame: &mut Frame<'_>, area: Rect, app: &App<'_>) {
    match &app.over {
        Over::Nothing => {}
        Over::Help => help(frame, area),
        Over::Edit(point, text) => edit(frame, area, &app.name_of(*point), text),
    }
}

fn too_small(frame: &mut Frame<'_>, area: Rect) {
    let (columns, lines) = LEAST;
    let text = format!(
        "The terminal has {}x{}, this needs {columns}x{lines}: make it larger, or q to end.",
        area.width, area.height
    );
    let paragraph = Paragraph::new(text).wrap(ratatui::widgets::Wrap { trim: true });
    frame.render_widget(paragraph, area);
}

fn header(frame: &mut Frame<'_>, area: Rect, app: &App<'_>, look: Look) {
    let done = app.scans();
    let time = match done.checked_sub(1) {
        // The last row is the scan before the count of those done.
        Some(scan) => {
            let ns = app.script.cycle_ns.unsigned_abs().saturating_mul(scan);
            format!("scan {scan} of {}  {}", app.script.scans, time_literal(ns))
        }
        None => format!("before scan 0 of {}", app.script.scans),
    };
    let speed = match app.speed() {
        speed if speed.is_infinite() => "as fast as it can".to_owned(),
        speed => format!("x{speed}"),
    };
    let mode = match app.mode {
        _ if app.session.is_over() => "OVER".to_owned(),
        Mode::Paused => format!("PAUSED {speed}"),
        Mode::Running => format!("RUNNING {speed}"),
        Mode::ToEvent => "TO AN EVENT".to_owned(),
        Mode::ToClaim => "TO A CLAIM".to_owned(),
    };
    let right = format!(" {time}  {mode} ");
    let title = if app.script.title.is_empty() {
        &app.name
    } else {
        &app.script.title
    };
    let room = usize::from(area.width).saturating_sub(right.chars().count() + 1);
    let line = Line::from(vec![
        Span::raw(" "),
        Span::styled(
            format!("{:<room$}", panes::cut(title, room)),
            Style::new().add_modifier(Modifier::BOLD),
        ),
        Span::raw(right),
    ]);
    frame.render_widget(Paragraph::new(line).style(look.lit()), area);
}

fn footer(frame: &mut Frame<'_>, area: Rect, app: &App<'_>, look: Look) {
    let keys = " space run  s step  e event  c claim  enter change  ? help  q end";
    let line = match (app.message.as_str(), app.broken) {
        ("", _) => Line::styled(keys, look.dim()),
        (message, true) => Line::styled(format!(" {message}"), look.bad()),
        (message, false) => Line::raw(format!(" {message}")),
    };
    frame.render_widget(Paragraph::new(line), area);
}

/// A box of this size in the middle, with nothing below it.
fn middle(frame: &mut Frame<'_>, area: Rect, width: u16, height: u16, title: &str) -> Rect {
    let area = area.centered(Constraint::Length(width), Constraint::Length(height));
    let block = Block::bordered().title(format!(" {title} "));
    let inner = block.inner(area);
    frame.render_widget(Clear, area);
    frame.render_widget(block, area);
    inner
}

fn help(frame: &mut Frame<'_>, area: Rect) {
    let height = u16::try_from(KEYS.len()).unwrap_or(u16::MAX).saturating_add(2);
    let inner = middle(frame, area, 52, height, "keys");
    let lines: Vec<Line<'_>> = KEYS
        .iter()
        .map(|(key, what)| Line::raw(format!(" {key:<9}{what}")))
        .collect();
    frame.render_widget(Paragraph::new(lines), inner);
}

fn edit(frame: &mut Frame<'_>, area: Rect, name: &str, text: &str) {
    let inner = middle(frame, area, 60, 5, name);
    let lines = vec![
        Line::raw(format!(" {text}_")),
        Line::raw(""),
        Line::raw(" enter takes it, esc does not; as in scripts: 1.5 T#20ms"),
    ];
    frame.render_widget(Paragraph::new(lines), inner);
}
