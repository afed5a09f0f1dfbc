//! `standstill identify`: the oscillation of a machine, from a trace or a recording.

use crate::args::IdentifyArguments;
use crate::exit::{Exit, Failure};
use crate::json::{Object, list, number, string};
use crate::report::load;
use crate::{limit, outcome};
use standstill_script::suite::shown;
use standstill_trace::foreign::{self, Channel, Layout, Place, Reading, Times, Wanted};
use standstill_trace::ring_down::{self, NoRingDown, RingDown};
use standstill_trace::{Cell, Kind, Trace, printable};
use std::fmt::Write as _;
use std::fs;
use std::io::Write;

/// A stretch of a signal, and the result for it.
struct Stretch {
    signal: String,
    /// Times (ns) of the first and the last sample.
    times: (i64, i64),
    found: Result<RingDown, NoRingDown>,
}

/// Finds the oscillation in every requested signal, and prints it.
pub fn identify(arguments: &IdentifyArguments, out: &mut dyn Write) -> Result<Exit, Failure> {
    let name = shown(&arguments.trace);
    if let (Some(from), Some(to)) = (arguments.from, arguments.to)
        && to <= from
    {
        return Err(Failure::usage("--to is not after --from"));
    }
    let stretches = match &arguments.time {
        Some(time) => vec![of_recording(arguments, time)?],
        None => {
            let (_, loaded) = load(&arguments.trace)?;
            limit::doing(format!("looking for a swing in {name}"));
            of_trace(arguments, &loaded.trace)?
        }
    };
    let exit = Exit::of(stretches.iter().any(|stretch| stretch.found.is_ok()));
    if arguments.json {
        let object = outcome::begun("identify", exit)
            .with("trace", string(&name))
            .with("signals", list(stretches.iter().map(Stretch::json)));
        writeln!(out, "{}", object.text())?;
    } else {
        for stretch in &stretches {
            write!(out, "{}", stretch.text())?;
        }
    }
    Ok(exit)
}

/// The named signal; otherwise for each axis the distance from its set-point while that is at rest.
fn of_trace(arguments: &IdentifyArguments, trace: &Trace) -> Result<Vec<Stretch>, Failure> {
    let cycle = i64::try_from(trace.header().cycle_ns).unwrap_or(i64::MAX);
    let window = arguments.window();
    let within = |scan: usize| window.0 <= scan as i64 * cycle && scan as i64 * cycle <= window.1;
    let scans: Vec<usize> = (0..trace.scans()).filter(|scan| within(*scan)).collect();
    let first = scans.first().copied().unwrap_or_default();
    if let Some(signal) = &arguments.signal {
        let column = numbers(trace, signal)?;
        let samples: Vec<f64> = scans
            .iter()
            .filter_map(|scan| real(trace, *scan, column))
            .collect();
        return Ok(vec![stretch(signal.clone(), &samples, first, cycle)]);
    }
    let axes = trace.columns().iter().filter_map(|column| {
        let axis = column.name.strip_suffix(".ActualPosition")?;
        Some((
            axis,
            trace.column(&column.name)?,
            trace.column(&format!("{axis}.Position"))?,
        ))
    });
    let mut found = Vec::new();
    for (axis, actual, set) in axes {
        let at = |scan: usize| Some((real(trace, scan, set)?, real(trace, scan, actual)?));
        let rows: Vec<(f64, f64)> = scans.iter().filter_map(|scan| at(*scan)).collect();
        let (begin, end) = longest_rest(&rows);
        let samples: Vec<f64> = rows
            .get(begin..end)
            .unwrap_or_default()
            .iter()
            .map(|(set, actual)| actual - set)
            .collect();
        let signal = format!("{axis}.ActualPosition - {axis}.Position");
        found.push(stretch(signal, &samples, first + begin, cycle));
    }
    if found.is_empty() {
        return Err(bad(
            arguments,
            "it has no axis with an ActualPosition; `--signal NAME` takes another column",
        ));
    }
    Ok(found)
}

/// The rows (from, to; the last one excluded) of the longest stretch in which the set-point is at rest after a
/// motion. Without a motion before any stretch, the longest of all.
fn longest_rest(rows: &[(f64, f64)]) -> (usize, usize) {
    let mut best = (0, 0);
    let mut begin = 0;
    let mut has_moved = false;
    for place in 1..=rows.len() {
        let goes_on = match (rows.get(place - 1), rows.get(place)) {
            (Some((before, _)), Some((now, _))) => before == now,
            _ => false,
        };
        if goes_on {
            continue;
        }
        // Rows before the first motion show no response to one.
        let is_later = begin > 0 && !has_moved && place - begin > 1;
        if is_later || place - begin > best.1 - best.0 {
            best = (begin, place);
        }
        has_moved = has_moved || is_later;
        begin = place;
    }
    best
}

/// A column of a recording. Its times may be slightly uneven.
fn of_recording(arguments: &IdentifyArguments, time: &str) -> Result<Stretch, Failure> {
    let name = shown(&arguments.trace);
    limit::doing(format!("looking for a swing in {name}"));
    let Some(signal) = &arguments.signal else {
        return Err(Failure::usage(
            "a recording needs `--signal NAME`: the column that swings",
        ));
    };
    let bytes = fs::read(&arguments.trace).map_err(|error| Failure::io(&name, &error))?;
    let text = foreign::decode(&bytes)
        .ok_or_else(|| bad(arguments, "this is no text: export the recording as CSV"))?;
    let layout = Layout {
        delimiter: None,
        decimal: None,
        times: Times::Column {
            place: Place::Name(time.to_owned()),
            unit: arguments.unit.into(),
        },
    };
    let wanted = Wanted {
        signal: signal.clone(),
        place: Place::Name(signal.clone()),
        reading: Reading::Curve,
    };
    let recording =
        foreign::read(&text, &layout, &[wanted]).map_err(|error| bad(arguments, &error.to_string()))?;
    let window = arguments.window();
    let samples: Vec<(i64, f64)> = match recording.channels.into_iter().next() {
        Some(Channel::Curve(samples)) => samples
            .into_iter()
            .filter(|(ns, _)| window.0 <= *ns && *ns <= window.1)
            .collect(),
        _ => Vec::new(),
    };
    let (Some((begin, _)), Some((end, _))) = (samples.first(), samples.last()) else {
        return Err(bad(arguments, "no sample lies between --from and --to"));
    };
    let step = (end - begin) as f64 / (samples.len() - 1).max(1) as f64;
    Ok(Stretch {
        signal: signal.clone(),
        times: (*begin, *end),
        found: ring_down::identify(&even(&samples, *begin, step), 1e-9 * step),
    })
}

/// Samples at distances of `step` (ns), on straight lines between the existing ones.
fn even(samples: &[(i64, f64)], begin: i64, step: f64) -> Vec<f64> {
    let mut pairs = samples.windows(2).peekable();
    let at = |place: usize| {
        let time = place as f64 * step;
        while pairs
            .next_if(|pair| ((pair[1].0 - begin) as f64) < time)
            .is_some()
            && pairs.peek().is_some()
        {}
        match pairs.peek() {
            Some([(before, low), (after, high)]) => {
                let part = (time - (before - begin) as f64) / (after - before) as f64;
                low + (high - low) * part.clamp(0.0, 1.0)
            }
            _ => samples.last().map_or(0.0, |(_, value)| *value),
        }
    };
    (0..samples.len()).map(at).collect()
}

fn numbers(trace: &Trace, signal: &str) -> Result<usize, Failure> {
    let reals = trace.columns().iter().filter(|column| column.kind == Kind::Real);
    let known: Vec<&str> = reals.map(|column| column.name.as_str()).collect();
    if known.contains(&signal) {
        return Ok(trace.column(signal).unwrap_or_default());
    }
    let near = crate::suggest::nearest(signal, known.iter().copied());
    let help = near.map_or_else(
        || format!("it has {}", known.join(", ")),
        |near| format!("did you mean `{near}`?"),
    );
    Err(Failure::Told(
        Exit::Usage,
        format!(
            "error: --signal {}: the trace has no numbers of this name; {}",
            printable(signal),
            printable(&help)
        ),
    ))
}

fn real(trace: &Trace, scan: usize, column: usize) -> Option<f64> {
    match trace.cell(scan, column) {
        Some(Cell::Real(value)) => Some(value),
        _ => None,
    }
}

fn stretch(signal: String, samples: &[f64], first: usize, cycle: i64) -> Stretch {
    let last = first + samples.len().saturating_sub(1);
    Stretch {
        signal,
        times: (first as i64 * cycle, last as i64 * cycle),
        found: ring_down::identify(samples, 1e-9 * cycle as f64),
    }
}

fn bad(arguments: &IdentifyArguments, message: &str) -> Failure {
    let name = shown(&arguments.trace);
    Failure::Told(Exit::BadInput, format!("error: {name}: {}", printable(message)))
}

impl Stretch {
    fn text(&self) -> String {
        let seconds = |ns: i64| 1e-9 * ns as f64;
        let mut text = format!(
            "{}, {:.6} s to {:.6} s\n",
            printable(&self.signal),
            seconds(self.times.0),
            seconds(self.times.1)
        );
        let added = match &self.found {
            Ok(found) => write!(
                text,
                "  frequency  {} Hz\n  damping    {}{}\n  swing      {:.3e} at the start\n  explained  {:.1} % of what moves, over {:.1} periods\n",
                with_error(found.frequency, found.frequency_within),
                with_error(found.damping, found.damping_within),
                if found.damping < -found.damping_within {
                    ": it grows, the loops feed it"
                } else {
                    ""
                },
                found.swing,
                100.0 * found.explained,
                found.periods
            ),
            Err(why) => writeln!(text, "  no swing: {why}"),
        };
        // Writing to a string cannot fail.
        let _ = added;
        text
    }

    fn json(&self) -> String {
        let ns = |value: i64| value.to_string();
        let object = Object::new()
            .with("signal", string(&self.signal))
            .with("from_ns", ns(self.times.0))
            .with("to_ns", ns(self.times.1))
            .with("found", self.found.is_ok().to_string());
        match &self.found {
            Ok(found) => object
                .with("frequency", number(found.frequency))
                .with("frequency_within", number(found.frequency_within))
                .with("damping", number(found.damping))
                .with("damping_within", number(found.damping_within))
                .with("swing", number(found.swing))
                .with("explained", number(found.explained))
                .with("periods", number(found.periods)),
            Err(why) => object.with("why", string(&why.to_string())),
        }
        .text()
    }
}

/// A value with its error. It has as many decimals as two digits of the error need, at most nine.
fn with_error(value: f64, within: f64) -> String {
    let (mut decimals, mut digits) = (0, within);
    while decimals < 9 && digits < 10.0 {
        (decimals, digits) = (decimals + 1, 10.0 * digits);
    }
    format!("{value:.decimals$} +- {within:.decimals$}")
}
