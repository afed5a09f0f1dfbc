//! `standstill cam`: checks a table against its axes, draws it, and writes rows of the usual laws.

use crate::apart;
use crate::args::{Cam, CamCheckArguments, CamLaw, CamLawArguments, Outside};
use crate::exit::{Exit, Failure};
use crate::is_standard;
use crate::json::{Object, list, number, string};
use crate::limit;
use crate::outcome;
use standstill_picture as picture;
use standstill_script::cam::{Asked, CamError, CamTable, Curve, Finding, Fit, Law, Lift, Stretch, csv, fit};
use standstill_script::model::{Axis, Script};
use standstill_script::suite::{EXTENSION, read_axes, read_file, shown};
use standstill_trace::file::replace;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Digits of a figure for people.
const DIGITS: usize = 6;

/// Runs one of the tasks.
pub fn cam(what: &Cam, out: &mut dyn Write) -> Result<Exit, Failure> {
    match what {
        Cam::Check(arguments) => check(arguments, out),
        Cam::Plot {
            file,
            svg,
            periodic,
            outside,
        } => {
            apart::checked(&apart::written("--svg", Some(svg)), [split(file).0.as_path()])?;
            plot(file, svg, *periodic, outside)
        }
        Cam::Law(arguments) => law(arguments, out),
    }
}

fn failure(error: CamError) -> Failure {
    match error {
        CamError::Suite(error) => error.into(),
        table @ CamError::Table { .. } => Failure::Told(Exit::BadInput, format!("error: {table}")),
    }
}

/// The file, and the name of a table of a script behind `#`.
fn split(file: &Path) -> (PathBuf, Option<&str>) {
    match file.to_str().and_then(|file| file.rsplit_once('#')) {
        Some((script, table)) if script.ends_with(EXTENSION) => (PathBuf::from(script), Some(table)),
        _ => (file.to_owned(), None),
    }
}

/// The table of a CSV file, or of a script.
fn table(file: &Path, outside: &Outside) -> Result<CamTable, Failure> {
    let name = shown(file);
    let (path, table) = split(file);
    limit::doing(format!("reading {name}"));
    if path.to_string_lossy().ends_with(EXTENSION) {
        let (script, _) = read_file(&path, &[], &outside.allowed())?;
        return CamTable::of_script(&shown(&path), &script, table).map_err(failure);
    }
    if is_standard(file) {
        let mut bytes = Vec::new();
        let read = io::stdin().lock().read_to_end(&mut bytes);
        read.map_err(|error| Failure::io("standard input", &error))?;
        return CamTable::of_csv("standard input", &bytes).map_err(failure);
    }
    let bytes = fs::read(file).map_err(|error| Failure::io(&name, &error))?;
    CamTable::of_csv(&name, &bytes).map_err(failure)
}

/// An axis of a file that was read.
fn axis_of<'a>(script: &'a Script, (path, name): &(PathBuf, String)) -> Result<&'a Axis, Failure> {
    let mut axes = script.axes.iter();
    axes.find(|axis| axis.name.eq_ignore_ascii_case(name))
        .ok_or_else(|| {
            let names: Vec<&str> = script.axes.iter().map(|axis| axis.name.as_str()).collect();
            let help = if names.is_empty() {
                "name a file that has axes".to_owned()
            } else {
                format!("the axes are {}", names.join(", "))
            };
            let text = format!("error: {}: there is no axis `{name}`\nhelp: {help}", shown(path));
            Failure::Told(Exit::BadInput, text)
        })
}

fn check(arguments: &CamCheckArguments, out: &mut dyn Write) -> Result<Exit, Failure> {
    let CamCheckArguments {
        file,
        axis,
        master,
        periodic,
        relative,
        json,
        outside,
    } = arguments;
    let table = table(file, outside)?;
    let allowed = outside.allowed();
    let slaves = read_axes(&axis.0, &allowed)?;
    let masters = master
        .as_ref()
        .map(|master| read_axes(&master.0, &allowed))
        .transpose()?;
    let of_master = masters.as_ref().zip(master.as_ref());
    let asked = Asked {
        slave: axis_of(&slaves, axis)?,
        master: of_master
            .map(|(script, named)| axis_of(script, named))
            .transpose()?,
        periodic: *periodic,
        slave_absolute: !relative,
    };
    let fit = fit(&table, asked).map_err(failure)?;
    let exit = Exit::of(fit.findings.is_empty());
    if *json {
        writeln!(out, "{}", as_json(&table, asked, &fit, exit))?;
    } else {
        write!(out, "{}", as_text(&table, asked, &fit))?;
    }
    Ok(exit)
}

/// The whole result for people.
fn as_text(table: &CamTable, asked: Asked<'_>, fit: &Fit) -> String {
    let head = &fit.curve.head;
    let slave = &asked.slave.name;
    let periodic = if asked.periodic { ", periodic" } else { "" };
    let limits = match asked.slave.config.software_limits {
        _ if !asked.slave_absolute => "not looked at: the cam begins where the slave is".to_owned(),
        None => "none".to_owned(),
        Some(_) if fit.inside => "kept".to_owned(),
        Some(_) => "broken".to_owned(),
    };
    let master = asked.master.map_or_else(String::new, |master| {
        let limit = figure(master.config.limits.velocity);
        format!(", limit of {} {limit}", master.name)
    });
    let facts = [
        (
            "rows",
            format!(
                "{}, master {} to {}{periodic}",
                table.rows.len(),
                figure(head.begin),
                figure(head.end)
            ),
        ),
        (
            "slave",
            format!("{} to {}", figure(head.range.0), figure(head.range.1)),
        ),
        ("software limits", limits),
        (
            "continuity",
            format!("{}, {slave} needs {}", fit.continuity, fit.needed),
        ),
        ("MaxMasterVelocity", format!("{}{master}", figure(fit.highest))),
    ];
    let stops: Vec<_> = fit.stops_at.iter().map(usize::to_string).collect();
    let stops = (!stops.is_empty()).then(|| ("rests at", format!("rows {}", stops.join(", "))));
    let mut text = format!("{} on {slave}\n", table.name);
    for (what, fact) in facts.into_iter().chain(stops) {
        text.push_str(&format!("  {what:<17}  {fact}\n"));
    }
    let heads = [
        "rows", "master", "law", "highest", "by", "worst at", "F1", "F2", "F3", "F4",
    ];
    let mut lines = vec![heads.map(str::to_owned)];
    lines.extend(fit.stretches.iter().enumerate().map(line));
    text.push_str(&columns(&lines));
    for finding in &fit.findings {
        text.push_str(&format!(
            "{}{}\n  help: {}\n",
            error_of(finding),
            finding.message,
            finding.remedy
        ));
    }
    text.push_str(match fit.findings[..] {
        [] => "passed\n",
        _ => "failed\n",
    });
    text
}

/// The error of MC_CamTableSelect for a finding.
fn error_of(finding: &Finding) -> String {
    let error = finding.error;
    error.map_or_else(String::new, |error| {
        format!("error {} {}: ", error.number(), error.name())
    })
}

/// A stretch as a line of the table.
fn line((index, stretch): (usize, &Stretch)) -> [String; 10] {
    let bounds = &stretch.bounds;
    let (by, worst) = match stretch.worst {
        None => ("-".to_owned(), "-".to_owned()),
        Some((limiting, place, _)) => (limiting.name().to_owned(), figure(place)),
    };
    [
        format!("{}-{}", index + 1, index + 2),
        format!("{}..{}", figure(stretch.ends.0), figure(stretch.ends.1)),
        stretch.law.to_owned(),
        figure(stretch.highest),
        by,
        worst,
        figure(bounds.first),
        figure(bounds.second),
        figure(bounds.third),
        figure(bounds.fourth),
    ]
}

/// Lines with aligned columns.
fn columns(lines: &[[String; 10]]) -> String {
    let mut widths = [0; 10];
    for line in lines {
        for (width, cell) in widths.iter_mut().zip(line) {
            *width = cell.chars().count().max(*width);
        }
    }
    let told = lines.iter().map(|line| {
        let cells = line
            .iter()
            .zip(widths)
            .map(|(cell, width)| format!("{cell:<width$}"));
        let cells: Vec<String> = cells.collect();
        format!("{}\n", cells.join("  ").trim_end())
    });
    told.collect()
}

/// A number with some digits.
fn figure(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let rough = format!("{value:.*e}", DIGITS - 1);
    // An infinite one has no power.
    let Some((digits, power)) = rough.split_once('e') else {
        return rough;
    };
    match power.parse() {
        Ok(power @ -4..=5) => {
            let decimals = usize::try_from(DIGITS as i32 - 1 - power).unwrap_or_default();
            without_zeros(&format!("{value:.decimals$}")).to_owned()
        }
        _ => format!("{}e{power}", without_zeros(digits)),
    }
}

/// A number without the zeros behind its point.
fn without_zeros(digits: &str) -> &str {
    match digits.contains('.') {
        true => digits.trim_end_matches('0').trim_end_matches('.'),
        false => digits,
    }
}

/// The whole result as one object.
fn as_json(table: &CamTable, asked: Asked<'_>, fit: &Fit, exit: Exit) -> String {
    let head = &fit.curve.head;
    let range = |(low, high): (f64, f64)| list([number(low), number(high)]);
    let slave = &asked.slave;
    let mut object = outcome::begun("cam check", exit)
        .with("file", string(&table.name))
        .with("rows", table.rows.len().to_string())
        .with("periodic", asked.periodic.to_string())
        .with("axis", string(&slave.name))
        .with("master_range", range((head.begin, head.end)))
        .with("slave_range", range(head.range));
    if let Some(limits) = slave.config.software_limits {
        let part = Object::new()
            .with("limits", range(limits))
            .with("judged", asked.slave_absolute.to_string())
            .with("inside", fit.inside.to_string());
        object = object.with("software_limits", part.text());
    }
    let continuity = Object::new()
        .with("found", fit.continuity.to_string())
        .with("needed", fit.needed.to_string());
    object = object.with("continuity", continuity.text());
    if !fit.stops_at.is_empty() {
        object = object.with("stops_at", list(fit.stops_at.iter().map(usize::to_string)));
    }
    object = object
        .with("bounds", bounds(&head.bounds))
        .with("max_master_velocity", number(fit.highest));
    if let Some(master) = asked.master {
        let limit = master.config.limits.velocity;
        let part = Object::new()
            .with("axis", string(&master.name))
            .with("velocity", number(limit))
            .with("fast_enough", (fit.highest >= limit).to_string());
        object = object.with("master", part.text());
    }
    let error = fit.refused.map(|error| error.number().to_string());
    object
        .with_some("error_id", error)
        .with("stretches", list(fit.stretches.iter().enumerate().map(stretch)))
        .with("findings", list(fit.findings.iter().map(finding)))
        .text()
}

fn bounds(bounds: &standstill_script::cam::CamBounds) -> String {
    Object::new()
        .with("first", number(bounds.first))
        .with("second", number(bounds.second))
        .with("third", number(bounds.third))
        .with("fourth", number(bounds.fourth))
        .text()
}

fn stretch((index, stretch): (usize, &Stretch)) -> String {
    let worst = stretch.worst.map(|(limiting, place, value)| {
        Object::new()
            .with("by", string(limiting.name()))
            .with("at", number(place))
            .with("value", number(value))
            .text()
    });
    Object::new()
        .with("row", (index + 1).to_string())
        .with("law", string(stretch.law))
        .with("master", list([number(stretch.ends.0), number(stretch.ends.1)]))
        .with("bounds", bounds(&stretch.bounds))
        .with("max_master_velocity", number(stretch.highest))
        .with_some("worst", worst)
        .text()
}

fn finding(finding: &Finding) -> String {
    Object::new()
        .with_some("error_id", finding.error.map(|error| error.number().to_string()))
        .with_some("error", finding.error.map(|error| string(error.name())))
        .with_some("row", finding.row.map(|row| row.to_string()))
        .with_some("line", finding.line.map(|line| line.to_string()))
        .with("message", string(&finding.message))
        .with("value", number(finding.value))
        .with("limit", number(finding.limit))
        .with("remedy", string(&finding.remedy))
        .text()
}

fn plot(file: &Path, svg: &Path, periodic: bool, outside: &Outside) -> Result<Exit, Failure> {
    let table = table(file, outside)?;
    let curve = Curve::new(&table, periodic).map_err(failure)?;
    let rows: Vec<[f64; 2]> = table.rows.iter().map(|row| [row.master, row.slave]).collect();
    // Without its folder, so that the picture does not depend on the place of the file.
    let title = table.name.rsplit('/').next().unwrap_or_default();
    let picture = picture::cam(title, &curve.course(), &rows);
    replace(svg, |out| out.write_all(picture.as_bytes()))?;
    Ok(Exit::Passed)
}

fn law(arguments: &CamLawArguments, out: &mut dyn Write) -> Result<Exit, Failure> {
    let law = match arguments.law {
        CamLaw::ModifiedSine => Law::ModifiedSine,
        CamLaw::Sinoid => Law::Sinoid,
        CamLaw::Poly345 => Law::Poly345,
        CamLaw::Poly4567 => Law::Poly4567,
        CamLaw::Trapezoid => Law::Trapezoid,
    };
    let lift = Lift {
        begin: arguments.begin,
        width: arguments.width,
        from: arguments.from,
        lift: arguments.lift,
    };
    let text = csv(law, &lift).map_err(|error| Failure::usage(&error))?;
    match &arguments.output {
        Some(path) => replace(path, |file| file.write_all(text.as_bytes()))?,
        None => write!(out, "{text}")?,
    }
    Ok(Exit::Passed)
}

#[cfg(test)]
mod tests {
    use super::figure;

    #[test]
    fn figures_have_six_digits() {
        let texts = [
            0.0,
            -0.0,
            1.0,
            328.951_234,
            1e-9,
            -0.000_123_456_7,
            123_456.7,
            1_234_567.0,
            f64::INFINITY,
        ];
        assert_eq!(
            texts.map(figure),
            [
                "0",
                "0",
                "1",
                "328.951",
                "1e-9",
                "-0.000123457",
                "123457",
                "1.23457e6",
                "inf"
            ]
        );
    }
}
