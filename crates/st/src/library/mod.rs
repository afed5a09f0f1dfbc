//! The library of every program: functions here, blocks and types from the table of blocks in [`blocks`].

pub(crate) mod blocks;

use crate::source::{SOURCES_MOST, Source, total};
use crate::types::Elementary;

macro_rules! functions {
    ($($variant:ident = $name:literal, $inputs:expr;)*) => {
        /// The functions other than conversions and operators.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Function { $($variant,)* }

        impl Function {
            pub(crate) const ALL: &'static [Self] = &[$(Self::$variant),*];

            pub(crate) const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// The names of its inputs; `IN1` alone stands for any number of them.
            pub(crate) const fn inputs(self) -> &'static [&'static str] {
                match self { $(Self::$variant => $inputs,)* }
            }
        }
    };
}

functions! {
    Abs = "ABS", &["IN"];
    Sqrt = "SQRT", &["IN"];
    Ln = "LN", &["IN"];
    Log = "LOG", &["IN"];
    Exp = "EXP", &["IN"];
    Expt = "EXPT", &["IN1", "IN2"];
    Sin = "SIN", &["IN"];
    Cos = "COS", &["IN"];
    Tan = "TAN", &["IN"];
    Asin = "ASIN", &["IN"];
    Acos = "ACOS", &["IN"];
    Atan = "ATAN", &["IN"];
    Atan2 = "ATAN2", &["Y", "X"];
    Trunc = "TRUNC", &["IN"];
    Round = "ROUND", &["IN"];
    Floor = "FLOOR", &["IN"];
    Ceil = "CEIL", &["IN"];
    Min = "MIN", &["IN1"];
    Max = "MAX", &["IN1"];
    Limit = "LIMIT", &["MN", "IN", "MX"];
    Sel = "SEL", &["G", "IN0", "IN1"];
    Mux = "MUX", &["K", "IN0"];
    Move = "MOVE", &["IN"];
    Shl = "SHL", &["IN", "N"];
    Shr = "SHR", &["IN", "N"];
    Rol = "ROL", &["IN", "N"];
    Ror = "ROR", &["IN", "N"];
    Time = "TIME", &[];
    Len = "LEN", &["IN"];
    Left = "LEFT", &["IN", "L"];
    Right = "RIGHT", &["IN", "L"];
    Mid = "MID", &["IN", "L", "P"];
    Concat = "CONCAT", &["IN1"];
    Insert = "INSERT", &["IN1", "IN2", "P"];
    Delete = "DELETE", &["IN", "L", "P"];
    Replace = "REPLACE", &["IN1", "IN2", "L", "P"];
    Find = "FIND", &["IN1", "IN2"];
}

impl Function {
    pub(crate) fn find(name: &str) -> Option<Self> {
        Self::ALL
            .iter()
            .copied()
            .find(|it| it.name().eq_ignore_ascii_case(name))
    }

    /// The function of the host that computes it, with numbers of 64 bits.
    pub(crate) const fn import(self) -> Option<&'static str> {
        Some(match self {
            Self::Ln => "math_ln",
            Self::Log => "math_log",
            Self::Exp => "math_exp",
            Self::Expt => "math_pow",
            Self::Sin => "math_sin",
            Self::Cos => "math_cos",
            Self::Tan => "math_tan",
            Self::Asin => "math_asin",
            Self::Acos => "math_acos",
            Self::Atan => "math_atan",
            Self::Atan2 => "math_atan2",
            _ => return None,
        })
    }

    /// Whether it takes any number of inputs.
    pub(crate) const fn is_open(self) -> bool {
        matches!(self, Self::Min | Self::Max | Self::Mux | Self::Concat)
    }
}

/// The functions that are operators with another name.
pub(crate) const OPERATORS: &[(&str, crate::syntax::Operator)] = {
    use crate::syntax::Operator as O;
    &[
        ("ADD", O::Add),
        ("SUB", O::Subtract),
        ("MUL", O::Multiply),
        ("DIV", O::Divide),
        ("MOD", O::Modulo),
        ("GT", O::Greater),
        ("GE", O::GreaterEqual),
        ("EQ", O::Equal),
        ("LE", O::LessEqual),
        ("LT", O::Less),
        ("NE", O::NotEqual),
        ("AND", O::And),
        ("OR", O::Or),
        ("XOR", O::Xor),
    ]
};

/// `X_TO_Y`, `TO_Y`: the source type, if given, and the target type.
pub(crate) fn conversion(name: &str) -> Option<(Option<&str>, Elementary)> {
    if let Some(to) = name.strip_prefix("TO_") {
        return Some((None, Elementary::find(to)?));
    }
    let (from, to) = name.rsplit_once("_TO_")?;
    Some((Some(from), Elementary::find(to)?))
}

/// The parts that the table of blocks does not have, in Structured Text: counters for numbers of other
/// widths than INT, and conversions to strings and back. Each is included only if a source may name it,
/// because checking them takes longer than checking a short program. Cost: linear in the sources.
pub(crate) fn prelude(sources: &[Source<'_>]) -> String {
    if total(sources) > SOURCES_MOST {
        // They are refused without being read.
        return String::new();
    }
    let counts = names(sources, &["CTU_", "CTD_", "CTUD_"]);
    let converts = names(sources, &["TO_STRING", "STRING_TO"]);
    let counters = if counts { counters() } else { String::new() };
    let strings = if converts { strings() } else { String::new() };
    [counters, strings].join("\n")
}

/// Whether one of these pieces of names is in a source, in letters of any case.
fn names(sources: &[Source<'_>], pieces: &[&str]) -> bool {
    let stands = |bytes: &[u8], place: usize, piece: &str| {
        let before = piece.find('_').unwrap_or(0);
        let from = place.checked_sub(before);
        let found = from.and_then(|from| bytes.get(from..from + piece.len()));
        found.is_some_and(|found| found.eq_ignore_ascii_case(piece.as_bytes()))
    };
    sources.iter().any(|source| {
        let mut underscores = source.bytes.iter().enumerate().filter(|(_, byte)| **byte == b'_');
        underscores.any(|(place, _)| pieces.iter().any(|piece| stands(source.bytes, place, piece)))
    })
}

fn counters() -> String {
    use Elementary::{Dint, Lint, Udint, Ulint};
    let each = [Dint, Lint, Udint, Ulint].map(|ty| {
        let (lowest, highest) = ty.range();
        include_str!("counters.st")
            .replace("LOWEST", &lowest.to_string())
            .replace("HIGHEST", &highest.to_string())
            .replace("NUMBER", ty.name())
    });
    each.concat()
}

fn strings() -> String {
    use Elementary::{Byte, Dint, Dword, Int, Lword, Sint, Udint, Uint, Usint, Word};
    let signed = [(Sint, "LINT"), (Int, "LINT"), (Dint, "LINT")];
    let unsigned = [Usint, Uint, Udint, Byte, Word, Dword, Lword].map(|ty| (ty, "ULINT"));
    let conversions = signed.iter().chain(&unsigned).map(|(ty, widest)| {
        include_str!("string_of.st")
            .replace("WIDEST", widest)
            .replace("NUMBER", ty.name())
    });
    let back = "FUNCTION STRING_TO_ULINT : ULINT VAR_INPUT IN : STRING[254]; END_VAR
        STRING_TO_ULINT := LINT_TO_ULINT(STRING_TO_LINT(IN)); END_FUNCTION";
    [
        include_str!("strings.st").to_owned(),
        back.to_owned(),
        conversions.collect(),
    ]
    .join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_in_text_is_there_where_it_is_named() {
        let named = |text: &str| {
            let source = Source {
                name: "",
                bytes: text.as_bytes(),
            };
            let prelude = prelude(&[source]);
            (prelude.contains("CTUD_LINT"), prelude.contains("DINT_TO_STRING"))
        };
        assert_eq!(named("a : INT; END_VAR _ STRING TO CTU"), (false, false));
        assert_eq!(named("c : ctu_Dint;"), (true, false));
        assert_eq!(named("s := To_String(3);"), (false, true));
        assert_eq!(named("i := STRING_TO_INT(s); c : CTUD_"), (true, true));
    }

    #[test]
    fn names_of_conversions_are_taken_apart_at_the_last_to() {
        assert_eq!(conversion("INT_TO_REAL"), Some((Some("INT"), Elementary::Real)));
        assert_eq!(
            conversion("WAY_TO_GO_TO_INT"),
            Some((Some("WAY_TO_GO"), Elementary::Int))
        );
        assert_eq!(conversion("TO_LREAL"), Some((None, Elementary::Lreal)));
        assert_eq!(conversion("INT_TO_AXIS"), None);
        assert_eq!(conversion("ABS"), None);
    }
}
