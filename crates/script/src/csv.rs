//! Tables as text: rows of numbers under the names of their fields, as spreadsheets save them.
//!
//! The first line names the fields in any order; absent fields are 0. Without such a line two columns are
//! the first two fields. Empty lines and lines that begin with `#` are skipped. Commas or semicolons
//! separate columns; numbers have a decimal point, never a decimal comma. Cells may be in quotation
//! marks.

use crate::error::quoted;
use standstill_fb::{Pin, PinType, TableInfo};
use std::fmt;

/// The type of the tables of cams; scripts call it by that of a row.
pub const CAM_TABLE: &str = "MC_CAM_REF";

/// The required columns of a cam.
const CAM_NEEDS: [&str; 2] = ["Master", "Slave"];

/// Headers of other systems by column, and the law of their rows: CODESYS (XYVA), and the motion points of TwinCAT.
const OTHERS: [(&[(&str, &str)], i32); 2] = [
    (
        &[
            ("X", "Master"),
            ("Y", "Slave"),
            ("V", "Slope"),
            ("A", "Curvature"),
        ],
        2,
    ),
    (
        &[
            ("MasterPos", "Master"),
            ("SlavePos", "Slave"),
            ("SlaveVelo", "Slope"),
            ("SlaveAcc", "Curvature"),
            ("SlaveJerk", "Third"),
        ],
        1,
    ),
];

/// A fault and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CsvFault {
    /// Line, from 1; 0 if none is at fault.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The fault, one sentence without a full stop.
    pub message: String,
    /// The remedy.
    pub help: String,
}

impl fmt::Display for CsvFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}:{}: {}; {}",
            self.line, self.column, self.message, self.help
        )
    }
}

/// A cell and its place.
#[derive(Clone, Copy)]
struct Cell<'a> {
    text: &'a str,
    line: usize,
    column: usize,
}

impl Cell<'_> {
    /// The begin of a line.
    const fn begin_of(line: usize) -> Self {
        Self {
            text: "",
            line,
            column: 1,
        }
    }

    fn fault(&self, message: String, help: &str) -> CsvFault {
        CsvFault {
            line: self.line,
            column: self.column,
            message,
            help: help.to_owned(),
        }
    }
}

/// The rows of a table, each with a number for every field.
///
/// # Errors
/// The first [`CsvFault`].
pub fn read(bytes: &[u8], info: &TableInfo) -> Result<Vec<Vec<f64>>, CsvFault> {
    read_with_lines(bytes, info).map(|(rows, _)| rows)
}

/// The same as [`read`]; also returns the line of each row, from 1.
///
/// # Errors
/// As [`read`].
pub fn read_with_lines(bytes: &[u8], info: &TableInfo) -> Result<(Vec<Vec<f64>>, Vec<usize>), CsvFault> {
    let text = decoded(bytes)?;
    let mut lines = text.lines().enumerate().filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    let Some((first, header)) = lines.next() else {
        return Err(CsvFault {
            line: 0,
            column: 0,
            message: "the file has no rows".to_owned(),
            help: "give a line with the names of the fields, then a line for each row".to_owned(),
        });
    };
    let separator = if header.contains(';') { ';' } else { ',' };
    let cells = split(header, first + 1, separator);
    let (places, law, mut rows) = if cells.iter().all(|cell| cell.text.parse::<f64>().is_ok()) {
        if cells.len() != 2 {
            let message = format!("{} columns without a line that names them", cells.len());
            let help =
                "two columns need no names, they are the first two fields; name others in a first line";
            let at = cells.first().copied().unwrap_or(Cell::begin_of(first + 1));
            return Err(at.fault(message, &comma_help(&cells, separator, help)));
        }
        let places = vec![0, 1];
        let row = row(&cells, &places, info, separator)?;
        (places, None, vec![row])
    } else {
        let (places, law) = named(&cells, info)?;
        (places, law, Vec::new())
    };
    let law_place = info.fields.iter().position(|field| field.name == "Law");
    let law = law.zip(law_place).filter(|(_, place)| !places.contains(place));
    let mut lines_of = vec![first + 1; rows.len()];
    for (number, line) in lines {
        let cells = split(line, number + 1, separator);
        rows.push(row(&cells, &places, info, separator)?);
        lines_of.push(number + 1);
        if rows.len() > info.most {
            let at = Cell::begin_of(number + 1);
            let message = format!("more than {} rows, which are the most", info.most);
            return Err(at.fault(message, "leave rows out where the curve hardly bends"));
        }
    }
    if let Some((law, place)) = law {
        for row in &mut rows {
            if let Some(cell) = row.get_mut(place) {
                *cell = f64::from(law);
            }
        }
    }
    if info.name == CAM_TABLE {
        check_cam(&rows, &lines_of, &places)?;
    }
    Ok((rows, lines_of))
}

fn decoded(bytes: &[u8]) -> Result<&str, CsvFault> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let good = bytes.get(..error.valid_up_to()).unwrap_or_default();
        let good = String::from_utf8_lossy(good);
        let byte = bytes.get(error.valid_up_to()).copied().unwrap_or_default();
        CsvFault {
            line: good.matches('\n').count() + 1,
            column: good.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1,
            message: format!("the byte 16#{byte:02X} is no UTF-8"),
            help: "save the file as UTF-8 (in a spreadsheet: \"CSV UTF-8\")".to_owned(),
        }
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// The cells of a line, without the blanks around them.
fn split(line: &str, number: usize, separator: char) -> Vec<Cell<'_>> {
    let mut column = 1;
    let cells = line.split(separator).map(|text| {
        let blanks = text.chars().take_while(|c| c.is_whitespace()).count();
        let plain = text.trim();
        let quoted = plain.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
        let cell = Cell {
            text: quoted.map_or(plain, str::trim),
            line: number,
            column: column + blanks,
        };
        column += text.chars().count() + 1;
        cell
    });
    cells.collect()
}

/// The remedy for a line with too many columns, usually because of decimal commas, or too few, usually
/// because of another separator.
fn comma_help(cells: &[Cell<'_>], separator: char, otherwise: &str) -> String {
    let is_part = |text: &str| text.parse::<f64>().is_ok() && !text.contains('.');
    let are_parts = cells.iter().all(|cell| is_part(cell.text.trim_matches('"')));
    if separator == ',' && are_parts && cells.len() > 2 {
        "if these are decimal commas: write a decimal point, 1.5 for 1,5".to_owned()
    } else if separator == ';' && cells.iter().any(|cell| cell.text.contains(',')) {
        "columns are parted by `;` as in the first line, and numbers have a decimal point, 1.5 for 1,5"
            .to_owned()
    } else {
        otherwise.to_owned()
    }
}

/// Whether a text is a number with a decimal comma.
fn has_decimal_comma(text: &str) -> bool {
    text.contains(',') && text.replacen(',', ".", 1).parse::<f64>().is_ok()
}

/// The field of each column, and the law of rows with the names of another system.
fn named(cells: &[Cell<'_>], info: &TableInfo) -> Result<(Vec<usize>, Option<i32>), CsvFault> {
    let field = |name: &str| {
        let mut fields = info.fields.iter();
        fields.position(|field: &Pin| field.name.eq_ignore_ascii_case(name))
    };
    // Then it is a line of numbers and not of names.
    if let Some(cell) = cells.iter().find(|cell| has_decimal_comma(cell.text)) {
        let message = format!("{} is no number", quoted(cell.text));
        return Err(cell.fault(message, "write a decimal point, 1.5 for 1,5"));
    }
    let mut law = None;
    let mut places = Vec::with_capacity(cells.len());
    for cell in cells {
        let other = OTHERS.iter().find_map(|(columns, law)| {
            let (_, own) = columns
                .iter()
                .find(|(name, _)| name.eq_ignore_ascii_case(cell.text))?;
            Some((field(own)?, *law))
        });
        let own = field(cell.text);
        let Some(place) = own.or(other.filter(|_| info.name == CAM_TABLE).map(|(place, _)| place)) else {
            let names: Vec<&str> = info.fields.iter().map(|field| field.name).collect();
            let message = format!("there is no field {}", quoted(cell.text));
            return Err(cell.fault(message, &format!("the fields are {}", names.join(", "))));
        };
        if places.contains(&place) {
            let message = format!("two columns for {}", quoted(cell.text));
            return Err(cell.fault(message, "leave one of them out"));
        }
        if own.is_none() {
            law = law.or(other.map(|(_, law)| law));
        }
        places.push(place);
    }
    if info.name == CAM_TABLE {
        for needed in CAM_NEEDS {
            let place = field(needed).unwrap_or_default();
            if !places.contains(&place) {
                let at = cells.first().copied().unwrap_or(Cell::begin_of(1));
                let message = format!("the column {} is missing", quoted(needed));
                return Err(at.fault(message, "name it in the first line, and give it in each row"));
            }
        }
    }
    Ok((places, law))
}

fn row(
    cells: &[Cell<'_>],
    places: &[usize],
    info: &TableInfo,
    separator: char,
) -> Result<Vec<f64>, CsvFault> {
    let at = cells.first().copied().unwrap_or(Cell::begin_of(1));
    if cells.len() != places.len() {
        let message = format!("{} columns where there are {}", cells.len(), places.len());
        let help = comma_help(
            cells,
            separator,
            "give each row a value for each column; 0 where there is none",
        );
        return Err(at.fault(message, &help));
    }
    let mut row = vec![0.0; info.fields.len()];
    for (cell, place) in cells.iter().zip(places) {
        let (Some(field), Some(slot)) = (info.fields.get(*place), row.get_mut(*place)) else {
            continue;
        };
        *slot = number(cell, field)?;
    }
    Ok(row)
}

fn number(cell: &Cell<'_>, field: &Pin) -> Result<f64, CsvFault> {
    let what = || format!("{} ({})", quoted(field.name), field.ty.iec_name());
    if let PinType::Enum(info) = field.ty
        && let Some(number) = info.number_of(cell.text)
    {
        return Ok(number.into());
    }
    if let (PinType::Bool, Some(value)) = (field.ty, boolean(cell.text)) {
        return Ok(f64::from(u8::from(value)));
    }
    if cell.text.contains(',') {
        let message = format!("{} is no number for {}", quoted(cell.text), what());
        return Err(cell.fault(message, "write a decimal point, 1.5 for 1,5"));
    }
    let plain = cell
        .text
        .chars()
        .all(|c| c.is_ascii_digit() || "+-.eE".contains(c));
    let Some(value) = cell
        .text
        .parse::<f64>()
        .ok()
        .filter(|value| plain && value.is_finite())
    else {
        let message = format!("{} is no number for {}", quoted(cell.text), what());
        let help = match field.ty {
            PinType::Enum(info) => {
                let names: Vec<&str> = info.elements.iter().map(|(name, _)| *name).collect();
                format!("it is one of {}, or its number", names.join(", "))
            }
            _ => "write a finite number with a decimal point".to_owned(),
        };
        return Err(cell.fault(message, &help));
    };
    let is_whole = !matches!(field.ty, PinType::Lreal);
    if is_whole && (value.trunc() != value || value.abs() > 2e9) {
        let message = format!("{} is no whole number for {}", quoted(cell.text), what());
        return Err(cell.fault(message, "write a whole number"));
    }
    Ok(value)
}

fn boolean(text: &str) -> Option<bool> {
    [("TRUE", true), ("FALSE", false)]
        .into_iter()
        .find(|(word, _)| word.eq_ignore_ascii_case(text))
        .map(|(_, value)| value)
}

/// Checks that the positions of the master rise from row to row, and that there are at least two rows.
fn check_cam(rows: &[Vec<f64>], lines: &[usize], places: &[usize]) -> Result<(), CsvFault> {
    let master = |row: &Vec<f64>| row.first().copied().unwrap_or_default();
    let column = places.iter().position(|place| *place == 0).unwrap_or_default() + 1;
    if let ([_] | [], line) = (rows, lines.last().copied().unwrap_or(1)) {
        return Err(CsvFault {
            line,
            column: 1,
            message: match rows.len() {
                1 => "1 row is no cam".to_owned(),
                count => format!("{count} rows are no cam"),
            },
            help: "give 2 rows at least".to_owned(),
        });
    }
    let mut pairs = rows.iter().zip(rows.iter().skip(1)).zip(lines.iter().skip(1));
    let falls = pairs.find(|((before, row), _)| !(master(row) > master(before)));
    falls.map_or(Ok(()), |((before, row), line)| {
        Err(CsvFault {
            line: *line,
            column: 1,
            message: format!(
                "`Master` (column {column}) is {:?} after {:?} in the row before",
                master(row),
                master(before)
            ),
            help: "places of the master rise from row to row".to_owned(),
        })
    })
}

/// The type of a table by the name that scripts give it: that of the pin, or of a row.
#[must_use]
pub fn table_info(name: &str) -> Option<TableInfo> {
    let name = if name == "MC_CAM_POINT" { CAM_TABLE } else { name };
    let pins = standstill_blocks::REGISTRY.iter().flat_map(|info| info.pins());
    let mut tables = pins.filter_map(|pin| match pin.ty {
        PinType::Table(info) => Some(info),
        _ => None,
    });
    tables.find(|info| info.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cam(text: &str) -> Result<Vec<Vec<f64>>, String> {
        let info = table_info("MC_CAM_POINT").expect("cams have tables");
        read(text.as_bytes(), &info).map_err(|fault| fault.to_string())
    }

    #[test]
    fn columns_come_in_any_order_and_absent_ones_are_0() {
        let rows =
            cam("# made by hand\r\nSlave, Law, Master\r\n0, mcCamRest7, 0\r\n\r\n1.5, 3, 180\r\n").unwrap();
        assert_eq!(
            rows,
            [[0.0, 0.0, 0.0, 0.0, 0.0, 4.0], [180.0, 1.5, 0.0, 0.0, 0.0, 3.0]]
        );
        assert_eq!(
            cam("\"Master\",\"Slave\"\n\"0\",1\n90,\" 2.5 \"").unwrap()[1][1],
            2.5
        );
        assert_eq!(cam("0;1\n90;2.5").unwrap()[1][..2], [90.0, 2.5]);
        assert_eq!(cam("\u{feff}master;slave\n0;1\n90;-2e1").unwrap()[1][1], -20.0);
    }

    #[test]
    fn columns_of_other_systems_have_their_law() {
        let rows = cam("X;Y;V;A\n0;0;1;0\n90;2;1;0.5").unwrap();
        assert_eq!(rows[1], [90.0, 2.0, 1.0, 0.5, 0.0, 2.0]);
        let rows = cam("MasterPos,SlavePos,SlaveVelo,SlaveAcc,SlaveJerk\n0,0,1,0,0\n90,2,1,0.5,7").unwrap();
        assert_eq!(rows[1], [90.0, 2.0, 1.0, 0.5, 7.0, 1.0]);
    }

    #[test]
    fn what_is_wrong_has_a_line_a_column_and_a_remedy() {
        for (text, expected) in [
            (
                "",
                "0:0: the file has no rows; give a line with the names of the fields, then a line for each row",
            ),
            (
                "Master,Slave\n0,0\n90",
                "3:1: 1 columns where there are 2; give each row a value for each column; 0 where there is none",
            ),
            (
                "Master;Slave\n0;0\n90;1,5",
                "3:4: `1,5` is no number for `Slave` (LREAL); write a decimal point, 1.5 for 1,5",
            ),
            (
                "Master,Slave\n0,0,1,5\n",
                "2:1: 4 columns where there are 2; if these are decimal commas: write a decimal point, 1.5 for 1,5",
            ),
            (
                "Master,Slave\n0,1,5\n",
                "2:1: 3 columns where there are 2; if these are decimal commas: write a decimal point, 1.5 for 1,5",
            ),
            (
                "Master,Slave\n0,\"1,5\"\n",
                "2:1: 3 columns where there are 2; if these are decimal commas: write a decimal point, 1.5 for 1,5",
            ),
            (
                "0;1,5\n",
                "1:3: `1,5` is no number; write a decimal point, 1.5 for 1,5",
            ),
            (
                "Master;Slave\n0,5\n",
                "2:1: 1 columns where there are 2; columns are parted by `;` as in the first line, and numbers have a decimal point, 1.5 for 1,5",
            ),
            (
                "0,0,1,5\n",
                "1:1: 4 columns without a line that names them; if these are decimal commas: write a decimal point, 1.5 for 1,5",
            ),
            (
                "Master\n0",
                "1:1: the column `Slave` is missing; name it in the first line, and give it in each row",
            ),
            (
                "Master,Slave,Slop\n",
                "1:14: there is no field `Slop`; the fields are Master, Slave, Slope, Curvature, Third, Law",
            ),
            (
                "Master,Slave,master\n",
                "1:14: two columns for `master`; leave one of them out",
            ),
            (
                "Master,Slave\n0,0\n0,1\n",
                "3:1: `Master` (column 1) is 0.0 after 0.0 in the row before; places of the master rise from row to row",
            ),
            (
                "Master,Slave\n0,0\n",
                "2:1: 1 row is no cam; give 2 rows at least",
            ),
            (
                "Master,Slave\n0,nan\n",
                "2:3: `nan` is no number for `Slave` (LREAL); write a finite number with a decimal point",
            ),
            (
                "Master,Slave,Law\n0,0,mcCamSine\n",
                "2:5: `mcCamSine` is no number for `Law` (MC_CAM_LAW); it is one of mcCamThrough, mcCamPoly7, mcCamPoly5, mcCamLine, mcCamRest7, mcCamRest5, or its number",
            ),
            (
                "Master,Slave,Law\n0,0,1.5\n",
                "2:5: `1.5` is no whole number for `Law` (MC_CAM_LAW); write a whole number",
            ),
        ] {
            assert_eq!(cam(text).unwrap_err(), expected, "{text}");
        }
        let info = table_info(CAM_TABLE).expect("cams have tables");
        let fault = read(b"Master,Slave\n0,\xFC\n", &info).unwrap_err();
        assert_eq!((fault.line, fault.column), (2, 3));
        assert!(fault.message.contains("16#FC"), "{fault}");
        let long: String = (0..600).map(|row| format!("{row},0\n")).collect();
        let fault = read(long.as_bytes(), &info).unwrap_err();
        assert_eq!(
            (fault.line, fault.message.as_str()),
            (513, "more than 512 rows, which are the most")
        );
    }
}
