//! `docs/bad-input.md`, from the tables that `blocks/tests/bad_input` tests the blocks with.

use crate::{Generated, NOTICE, read};
use standstill_axis::ErrorId;
use std::fmt::Write;

/// The columns of the table `states`.
pub const STATES: [&str; 8] = [
    "Disabled",
    "Standstill",
    "Homing",
    "Stopping",
    "DiscreteMotion",
    "ContinuousMotion",
    "ErrorStop",
    "switching off",
];

pub fn page() -> Generated {
    let mut text = format!(
        "{NOTICE}# Bad input\n\n\
         What every block does with values it cannot use. A test tries each of them and fails for a pin or a\n\
         block that has no row. *ok*: accepted. *clamp*: lowered to the axis limit and recorded; an axis set to\n\
         `above_limit` `error` refuses instead. A number is the [ErrorID](error-ids.md) in the call that sees\n\
         the value. The axis and other instances stay as they are; blocks with Execute show the error until\n\
         Execute falls and take good values at the next edge, blocks with Enable recover as soon as the value is good.\n\n\
         An `Axis` that does not exist is error {} of every block; blocks with Enable then need a new edge, too.\n\n\
         The window of MC_TouchProbe is not read without WindowOnly; its rows are with it, and with the pin that is not\n\
         named at 0, if first, or at the largest number. MC_PhasingAbsolute and MC_PhasingRelative find their slave in gear.\n\n\
         ## Numbers\n\n\
         | block | pin | NaN | +infinity | -infinity | 0 | -1 | 1e300 |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- |\n",
        ErrorId::AxisUnknown.number()
    );
    let pins = table("pins");
    rows(&mut text, &pins, 6);
    text.push_str(
        "\n## Integers and times\n\n| block | pin | 0 | -1 | largest |\n| --- | --- | --- | --- | --- |\n",
    );
    rows(&mut text, &pins, 3);
    text.push_str("\n## Undefined enumeration numbers\n\n| block | pin | any |\n| --- | --- | --- |\n");
    rows(&mut text, &pins, 1);
    let _ = write!(
        text,
        "\n## States\n\n\
         The last column is the ramp on the way to Disabled, in state Stopping.\n\n\
         | block | BufferMode | {} |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
        STATES.join(" | ")
    );
    rows(&mut text, &table("states"), 8);
    Generated {
        path: "docs/bad-input.md".into(),
        text,
    }
}

/// The rows of the table `pins` or `states`, split into words.
pub fn table(name: &str) -> Vec<Vec<String>> {
    read(&format!("blocks/tests/bad_input/{name}.txt"))
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split_whitespace().map(Into::into).collect())
        .collect()
}

/// Writes those with `cells` cells.
fn rows(text: &mut String, table: &[Vec<String>], cells: usize) {
    for row in table.iter().filter(|row| row.len() == cells + 2) {
        let _ = writeln!(text, "| {} |", row.join(" | "));
    }
}
