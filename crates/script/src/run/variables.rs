//! All variables of a program in Structured Text, for viewing a run.

use crate::model::Program;
use crate::read::time;
use standstill_guest::Guest;
use standstill_st::{Elementary, Symbol, Value};
use standstill_trace::shortest;

/// Largest number of variables of a program that are shown.
const MOST: usize = 2000;

/// A variable and its value, as text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    /// Its path: `Units[1].Mv.Done`.
    pub path: String,
    /// In the form of a trace; TIME as a literal.
    pub value: String,
}

/// The variables of a program as they are now, at most 2000, in the order of memory.
pub(super) fn shown(program: &Program, guest: &Guest) -> Vec<Shown> {
    let Some(text) = &program.text else {
        return Vec::new();
    };
    let leaves = text.symbols.leaves(MOST).into_iter();
    let shown = leaves.filter_map(|symbol| {
        let bits = guest.bits(symbol.address, symbol.ty.size() as usize)?;
        Some(Shown {
            path: text.symbols.short(&symbol.path).to_owned(),
            value: value_text(&symbol, bits),
        })
    });
    shown.collect()
}

fn value_text(symbol: &Symbol, bits: u64) -> String {
    use Elementary as E;
    let unused = 64 - 8 * symbol.ty.size();
    let signed = (bits.cast_signed() << unused) >> unused;
    match symbol.ty {
        E::Bool => if bits == 0 { "FALSE" } else { "TRUE" }.to_owned(),
        E::Real => shortest(f64::from(f32::from_bits(bits as u32))),
        E::Lreal => shortest(f64::from_bits(bits)),
        E::Time | E::Ltime => time::literal(signed),
        E::Sint | E::Int | E::Dint | E::Lint => named(symbol, signed.into()),
        _ => named(symbol, bits.into()),
    }
}

/// The element of an enumeration, or the number.
fn named(symbol: &Symbol, number: i128) -> String {
    let elements = match &symbol.value {
        Value::Element(elements) => elements.as_slice(),
        _ => &[],
    };
    let element = elements.iter().find(|(_, it)| *it == number);
    element.map_or_else(|| number.to_string(), |(name, _)| name.clone())
}
