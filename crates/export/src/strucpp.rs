//! Shims for STruC++: bodies in C++ behind `{external`, pins as values with `get` and `set`.

use crate::File;
use crate::dialect::Dialect;
use crate::names::{Prefix, function};
use crate::st::{self, Syntax};
use standstill_blocks::REGISTRY;
use standstill_fb::{BlockInfo, PinType};
use std::fmt::Write as _;

const SYNTAX: Syntax = Syntax {
    numbered_enumerations: true,
    tables: false,
};

const VALUES: &str = "\
/* Pins are wrapped there; members of structures may be or not. */
template <class T> auto standstill_get(const T &value, int) -> decltype(value.get()) { return value.get(); }
template <class T> const T &standstill_get(const T &value, long) { return value; }
#define STANDSTILL_GET(value) standstill_get((value), 0)

";

pub(crate) fn files(prefix: &Prefix, dialect: &Dialect) -> Vec<File> {
    let mut text = st::notice(
        "The function blocks of standstill for STruC++ and OpenPLC.\n\n   Compile the C++ files with \
         -include standstill_shim.h and link the library of standstill. Leave out the bundled\n   motion library, or \
         export with a prefix of your own: two blocks of one name are refused.\n\n   \
         Blocks with arrays of structures are not here: how they lie in C++ there is not published.",
        dialect,
    );
    text += &st::types(dialect, SYNTAX);
    for info in REGISTRY.iter().filter(|info| !info.has_tables()) {
        block(&mut text, info, dialect);
    }
    vec![
        File {
            name: format!("{}_shim.h", prefix.lower()),
            text: prefix.applied(&st::shim_header(VALUES, dialect)),
        },
        File {
            name: format!("{}_strucpp.st", prefix.lower()),
            text: prefix.applied(&text),
        },
    ]
}

fn block(out: &mut String, info: &BlockInfo, dialect: &Dialect) {
    let name = function(info);
    *out += &st::head(info, dialect, SYNTAX);
    *out += "  VAR\n    Standstill_Key : ULINT;\n  END_VAR\n  {external\n";
    let _ = writeln!(
        out,
        "    auto in = standstill_{name}_in_default();\n    auto out = standstill_{name}_out_default();\n    \
         uint64_t key = STANDSTILL_GET(STANDSTILL_KEY);"
    );
    for pin in info.inputs() {
        let there = dialect.pin(info, pin).to_ascii_uppercase();
        let value = match pin.ty {
            PinType::Axis(_) => format!("STANDSTILL_GET({there}.NUMBER)"),
            PinType::Enum(of) => st::translated(&of, &format!("STANDSTILL_GET({there})"), dialect),
            _ => format!("STANDSTILL_GET({there})"),
        };
        let _ = writeln!(out, "    in.{} = {value};", pin.field);
    }
    let _ = writeln!(
        out,
        "    int32_t result = standstill_{name}(standstill_default, &key, &in, &out);\n    \
         STANDSTILL_KEY.set(key);\n    RESULT.set(result);\n    if (result == 0) {{"
    );
    for pin in info.outputs() {
        let there = dialect.pin(info, pin).to_ascii_uppercase();
        let _ = writeln!(out, "        {there}.set(out.{});", pin.field);
    }
    *out += "    }\n  }\nEND_FUNCTION_BLOCK\n\n";
}
