//! The list of input variables and pins.

use standstill_fb::Direction;
use standstill_script::model::{Point, Script};

/// A line of the list: a heading, or a variable or pin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Line {
    /// Its name below its heading.
    pub(crate) name: String,
    /// Its name in scripts.
    pub(crate) full: String,
    /// Nothing for a heading.
    pub(crate) point: Option<Point>,
    /// It is an output.
    pub(crate) output: bool,
    /// Whether it is an input with a wire.
    pub(crate) wired: bool,
}

/// The lines of a script: input variables, then every instance with its pins, in call order.
pub(crate) fn lines(script: &Script) -> Vec<Line> {
    let heading = |text: String| Line {
        full: text.clone(),
        name: text,
        point: None,
        output: false,
        wired: false,
    };
    let mut lines = Vec::new();
    if !script.inputs.is_empty() {
        lines.push(heading("inputs".to_owned()));
    }
    for (index, input) in script.inputs.iter().enumerate() {
        lines.push(Line {
            name: input.name.clone(),
            full: input.name.clone(),
            point: Some(Point::Input(index)),
            output: false,
            wired: false,
        });
    }
    for (index, instance) in script.blocks.iter().enumerate() {
        lines.push(heading(format!("{} {}", instance.name, instance.block.name)));
        for (number, pin) in instance.block.pins().enumerate() {
            lines.push(Line {
                name: pin.name.to_owned(),
                full: format!("{}.{}", instance.name, pin.name),
                point: Some(Point::Pin(index, number)),
                output: pin.direction == Direction::Output,
                wired: instance.wires.iter().any(|(wired, _)| *wired == number),
            });
        }
    }
    for (index, program) in script.programs.iter().enumerate() {
        lines.push(heading(format!("{} PROGRAM", program.name)));
        for (number, symbol) in program.symbols.iter().enumerate() {
            lines.push(Line {
                name: symbol.name.clone(),
                full: format!("{}.{}", program.name, symbol.name),
                point: Some(Point::Symbol(index, number)),
                output: number == 0,
                wired: false,
            });
        }
    }
    lines
}
