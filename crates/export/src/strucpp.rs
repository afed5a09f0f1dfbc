//! Shims for STruC++: bodies in C++ behind `{external`, pins as values with `get` and `set`.

use crate::File;
use crate::dialect::Dialect;
use crate::names::{Prefix, function, snake};
use crate::st::{self, Syntax};
use standstill_blocks::REGISTRY;
use standstill_fb::{BlockInfo, PinType, TableInfo};
use std::fmt::Write as _;

const SYNTAX: Syntax = Syntax {
    numbered_enumerations: true,
};

const VALUES: &str = "\
#include <type_traits>
#include <utility>

/* Pins and members of structures are wrapped there, enumerations twice; what is in the wrappers counts. */
template <class T, class = void> struct standstill_is_wrapped : std::false_type {};
template <class T>
struct standstill_is_wrapped<T, std::void_t<decltype(std::declval<const T &>().get())>> : std::true_type {};
template <class T> auto standstill_get(const T &value) {
    if constexpr (standstill_is_wrapped<T>::value) {
        return standstill_get(value.get());
    } else {
        return value;
    }
}
#define STANDSTILL_GET(value) standstill_get(value)

";

pub(crate) fn files(prefix: &Prefix, dialect: &Dialect) -> Vec<File> {
    let mut text = st::notice(
        "The function blocks of standstill for STruC++ and OpenPLC.\n\n   Compile the C++ files with \
         -include standstill_shim.h and link the library of standstill. Leave out the bundled\n   motion library, or \
         export with a prefix of your own: two blocks of one name are refused.",
        dialect,
    );
    text += &st::types(dialect, SYNTAX);
    for info in REGISTRY {
        block(&mut text, info, dialect);
    }
    vec![
        File::new(prefix, "_shim.h", &st::shim_header(VALUES, dialect)),
        File::new(prefix, "_strucpp.st", &text),
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
        let (field, there) = (pin.field, dialect.pin(info, pin).to_ascii_uppercase());
        let _ = match pin.ty {
            PinType::Table(table) => {
                records(out, field, &there, &table, dialect);
                Ok(())
            }
            PinType::Axis(_) => writeln!(out, "    in.{field} = STANDSTILL_GET({there}.NUMBER);"),
            ty => writeln!(out, "    in.{field} = {};", taken(ty, &there, dialect)),
        };
    }
    let _ = writeln!(
        out,
        "    int32_t result = standstill_{name}(STANDSTILL_RUNTIME &key, &in, &out);\n    \
         STANDSTILL_KEY.set(key);\n    RESULT.set(result);\n    if (result == 0) {{"
    );
    for pin in info.outputs() {
        let there = dialect.pin(info, pin).to_ascii_uppercase();
        let _ = writeln!(out, "        {there}.set(out.{});", pin.field);
    }
    *out += "    }\n  }\nEND_FUNCTION_BLOCK\n\n";
}

/// Copies the records of an array into a plain one.
fn records(out: &mut String, field: &str, there: &str, table: &TableInfo, dialect: &Dialect) {
    let (record, most) = (snake(table.name), table.most);
    let _ = writeln!(
        out,
        "    struct standstill_{record} {field}_records[{most}] = {{}};\n    \
         in.{field} = {field}_records;\n    \
         in.{field}_count = (uint32_t)STANDSTILL_GET({there}.COUNT);\n    \
         for (uint32_t i = 0; i < in.{field}_count && i < {most}; i++) {{"
    );
    for column in table.fields {
        let value = format!("{there}.RECORDS[i].{}", column.name.to_ascii_uppercase());
        let value = taken(column.ty, &value, dialect);
        let _ = writeln!(out, "        {field}_records[i].{} = {value};", column.field);
    }
    *out += "    }\n";
}

/// How a value of the program becomes a field.
fn taken(ty: PinType, there: &str, dialect: &Dialect) -> String {
    let value = format!("STANDSTILL_GET({there})");
    match ty {
        PinType::Enum(of) => st::translated(&of, &value, dialect),
        _ => value,
    }
}
