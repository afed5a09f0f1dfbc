//! The parts of the screen.

use crate::app::App;
use crate::program::{Row, Side, View, rows};
use crate::view::Look;
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Paragraph};
use standstill_axis::AxisState;
use standstill_script::Standing;
use standstill_trace::{Cell, printable, shortest};

/// Characters of a bar.
const BAR: usize = 8;

/// The first characters of a text that fit into the room; two points replace the rest.
pub(crate) fn cut(text: &str, room: usize) -> String {
    // A control character would move the cursor.
    let text = printable(text);
    if text.chars().count() <= room {
        return text.into_owned();
    }
    let kept: String = text.chars().take(room.saturating_sub(2)).collect();
    if room < 2 { kept } else { format!("{kept}..") }
}

fn boxed(frame: &mut Frame<'_>, area: Rect, title: &str) -> Rect {
    let room = usize::from(area.width).saturating_sub(4);
    let block = Block::bordered().title(format!(" {} ", cut(title, room)));
    let inner = block.inner(area);
    frame.render_widget(block, area);
    inner
}

impl App<'_> {
    /// The cell of an axis signal in the last row.
    fn axis_cell(&self, signal: &str) -> Option<Cell<'_>> {
        let trace = self.session.trace();
        let axis = self.script.axes.get(self.axis)?;
        let column = trace.column(&format!("{}.{signal}", axis.name))?;
        trace.cell(trace.scans().checked_sub(1)?, column)
    }

    pub(crate) fn name_of(&self, point: standstill_script::model::Point) -> String {
        let mut lines = self.lines.iter();
        let line = lines.find(|line| line.point == Some(point));
        line.map_or_else(String::new, |line| line.full.clone())
    }
}

/// The state machine: all states, with the axis's state highlighted.
pub(crate) fn states(frame: &mut Frame<'_>, area: Rect, app: &App<'_>, look: Look) {
    let name = app
        .script
        .axes
        .get(app.axis)
        .map_or("no axis", |axis| axis.name.as_str());
    let of = match app.script.axes.len() {
        0 | 1 => String::new(),
        count => format!(" ({} of {count})", app.axis + 1),
    };
    let inner = boxed(frame, area, &format!("{name}{of}"));
    let now = match app.axis_cell("State") {
        Some(Cell::Name(name)) => name,
        _ => "",
    };
    let lines: Vec<Line<'_>> = AxisState::ALL
        .iter()
        .map(|state| {
            let here = state.name() == now;
            let style = match (here, state) {
                (true, AxisState::ErrorStop) => look.bad().patch(look.lit()),
                (true, _) => look.on().patch(look.lit()),
                (false, _) => Style::new(),
            };
            let mark = if here { '>' } else { ' ' };
            Line::styled(format!("{mark} {:<18}", state.name()), style)
        })
        .collect();
    frame.render_widget(Paragraph::new(lines), inner);
}

/// The values of the axis, each with its limit.
pub(crate) fn values(frame: &mut Frame<'_>, area: Rect, app: &App<'_>, look: Look) {
    let trace = app.session.trace();
    let axis = trace.header().axes.get(app.axis);
    let unit = axis.map_or("", |axis| axis.unit.as_str());
    let inner = boxed(frame, area, if unit.is_empty() { "set-point" } else { unit });
    let Some(axis) = axis else { return };
    let limits = &axis.limits;
    let slowing = match (app.axis_cell("Velocity"), app.axis_cell("Acceleration")) {
        (Some(Cell::Real(velocity)), Some(Cell::Real(acceleration))) => velocity * acceleration < 0.0,
        _ => false,
    };
    let rate = if slowing {
        limits.deceleration
    } else {
        limits.acceleration
    };
    let lines: Vec<Line<'_>> = [
        ("Position", None),
        ("Velocity", limits.velocity),
        ("Acceleration", rate),
        ("Jerk", limits.jerk),
        ("Snap", limits.snap),
        ("ActualPosition", None),
    ]
    .into_iter()
    .map(|(signal, limit)| {
        let value = match app.axis_cell(signal) {
            Some(Cell::Real(value)) => Some(value),
            _ => None,
        };
        let number = value.map_or_else(|| "-".to_owned(), number);
        let (bar, beyond) = match (value, limit) {
            (Some(value), Some(limit)) => (bar(value.abs() / limit), value.abs() > limit * 1.000_000_001),
            _ => (String::new(), false),
        };
        let limit = limit.map_or_else(String::new, |limit| format!(" of {}", shortest(limit)));
        let style = if beyond { look.bad() } else { Style::new() };
        Line::from(vec![
            Span::raw(format!(" {signal:<14}")),
            Span::styled(format!("{number:>15}"), style),
            Span::raw(format!("  {bar}{limit}")),
        ])
    })
    .chain(ends(limits))
    .collect();
    frame.render_widget(Paragraph::new(lines), inner);
}

fn ends(limits: &standstill_trace::Limits) -> Option<Line<'static>> {
    let text = |end: Option<f64>| end.map_or_else(|| "none".to_owned(), shortest);
    let (min, max) = (limits.position_min, limits.position_max);
    (min.is_some() || max.is_some())
        .then(|| Line::raw(format!(" Software limits {} to {}", text(min), text(max))))
}

/// A number with a constant width; very large and very small ones in exponents.
fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || (1e-3..1e8).contains(&magnitude) {
        format!("{value:.6}")
    } else {
        format!("{value:.6e}")
    }
}

/// `[####    ]`
fn bar(share: f64) -> String {
    let full = (share.clamp(0.0, 1.0) * BAR as f64).round() as usize;
    format!("[{:<BAR$}]", "#".repeat(full))
}

/// Input variables and pins; outputs are marked, the selected one has a pointer.
pub(crate) fn pins(frame: &mut Frame<'_>, area: Rect, app: &App<'_>, look: Look) {
    let inner = boxed(frame, area, "blocks");
    let height = usize::from(inner.height);
    let width = usize::from(inner.width);
    // The selected line stays in the middle if possible.
    let last = app.lines.len().saturating_sub(height);
    let first = app.selected.saturating_sub(height / 2).min(last);
    let shown = app.lines.iter().enumerate().skip(first).take(height);
    let lines: Vec<Line<'_>> = shown
        .map(|(index, line)| {
            let Some(point) = line.point else {
                return Line::styled(cut(&line.full, width), look.on());
            };
            let value = app.value(point).unwrap_or_default();
            let mark = if index == app.selected { '>' } else { ' ' };
            let kind = match (line.output, line.wired) {
                (true, _) => '<',
                (false, true) => '~',
                (false, false) => ' ',
            };
            let room = width.saturating_sub(value.chars().count() + 5);
            let name = cut(&line.name, room);
            let style = match (index == app.selected, value.as_str(), line.name.as_str()) {
                (true, ..) => look.lit(),
                (false, "TRUE", "Error" | "CommandAborted") => look.bad(),
                (false, "TRUE", _) => look.on(),
                _ => Style::new(),
            };
            let name = format!("{name:<room$}");
            Line::styled(cut(&format!("{mark}{kind} {name} {value} "), width), style)
        })
        .collect();
    frame.render_widget(Paragraph::new(lines), inner);
}

/// The last events, the newest at the end.
pub(crate) fn events(frame: &mut Frame<'_>, area: Rect, app: &App<'_>) {
    let inner = boxed(frame, area, "events");
    let first = app.events.len().saturating_sub(usize::from(inner.height));
    let shown = app.events.get(first..).unwrap_or_default();
    let lines: Vec<Line<'_>> = shown
        .iter()
        .map(|event| {
            let text = format!("{:>5} {} {}", event.scan, event.subject, event.text);
            Line::raw(cut(&text, usize::from(inner.width)))
        })
        .collect();
    frame.render_widget(Paragraph::new(lines), inner);
}

/// The claims: failed ones first, then the ones decided last.
pub(crate) fn claims(frame: &mut Frame<'_>, area: Rect, app: &App<'_>, look: Look) {
    let (held, failed, open) = app.tally();
    let inner = boxed(
        frame,
        area,
        &format!("claims: {held} hold, {failed} fail, {open} open"),
    );
    let mut claims: Vec<_> = app.says.iter().zip(&app.standings).collect();
    claims.sort_by_key(|(_, standing)| match standing {
        Standing::Failed(scan) => (0, *scan),
        Standing::Held(scan) => (1, u64::MAX - *scan),
        Standing::Open => (2, 0),
    });
    let lines: Vec<Line<'_>> = claims
        .iter()
        .take(usize::from(inner.height))
        .map(|(says, standing)| {
            let (word, style) = match standing {
                Standing::Failed(scan) => (format!("FAILS {scan}"), look.bad()),
                Standing::Held(scan) => (format!("holds {scan}"), look.on()),
                Standing::Open => ("open".to_owned(), Style::new()),
            };
            let room = usize::from(inner.width).saturating_sub(14);
            Line::from(vec![
                Span::styled(format!("{word:<13} "), style),
                Span::raw(cut(says, room)),
            ])
        })
        .collect();
    frame.render_widget(Paragraph::new(lines), inner);
}

/// The text of a program; lines that were executed in the last scan are marked.
pub(crate) fn source(frame: &mut Frame<'_>, area: Rect, app: &App<'_>, view: &View, look: Look) {
    let name = app
        .script
        .programs
        .get(view.program)
        .map_or("", |program| &program.name);
    let mark = if view.side == Side::Source { "> " } else { "" };
    let inner = boxed(frame, area, &format!("{mark}{name}: the source"));
    let width = usize::from(inner.width);
    let rows = rows(app.script, view.program);
    let shown = rows.iter().skip(view.top[0]).take(usize::from(inner.height));
    let lines: Vec<Line<'_>> = shown
        .map(|row| match row {
            Row::File(name) => Line::styled(cut(name, width), look.on()),
            Row::Line(file, number, text) => {
                let ran = view.ran.contains(&((*file).to_owned(), *number));
                let mark = if ran { '>' } else { ' ' };
                // A tab has no width of its own.
                let text = text.replace('\t', "    ");
                let style = if ran { look.on() } else { Style::new() };
                Line::styled(cut(&format!("{number:>4}{mark} {text}"), width), style)
            }
        })
        .collect();
    frame.render_widget(Paragraph::new(lines), inner);
}

/// The variables of a program; those that changed in the last scan are marked.
pub(crate) fn variables(frame: &mut Frame<'_>, area: Rect, view: &View, look: Look) {
    let mark = if view.side == Side::Variables { "> " } else { "" };
    let inner = boxed(frame, area, &format!("{mark}variables"));
    let width = usize::from(inner.width);
    let shown = view.variables.iter().enumerate().skip(view.top[1]);
    let lines: Vec<Line<'_>> = shown
        .take(usize::from(inner.height))
        .map(|(index, variable)| {
            let changed = view.changed.contains(&index);
            let mark = if changed { '*' } else { ' ' };
            let room = width.saturating_sub(variable.value.chars().count() + 3);
            let name = cut(&variable.path, room);
            let style = if changed { look.on() } else { Style::new() };
            Line::styled(
                cut(&format!("{mark}{name:<room$} {}", variable.value), width),
                style,
            )
        })
        .collect();
    frame.render_widget(Paragraph::new(lines), inner);
}
