//! Shims for matiec: bodies in C between `{{` and `}}`, pins through `GetFbVar` and `SetFbVar`.
//!
//! These two respect forcing, do not depend on the layout of an instance, and work in a guest, too.

use crate::File;
use crate::dialect::Dialect;
use crate::names::{Prefix, function, snake};
use crate::st::{self, Syntax};
use standstill_blocks::REGISTRY;
use standstill_fb::{BlockInfo, PinType};
use std::fmt::Write as _;

const SYNTAX: Syntax = Syntax {
    numbered_enumerations: false,
};

const TIME: &str = "\
/* TIME is a structure of seconds and nanoseconds there. */
#define STANDSTILL_NS(time) ((int64_t)(time).tv_sec * INT64_C(1000000000) + (time).tv_nsec)

";

pub(crate) fn files(prefix: &Prefix, dialect: &Dialect) -> Vec<File> {
    let mut text = st::notice(
        "The function blocks of standstill for matiec and Beremiz.\n\n   Compile the C files with \
         -include standstill_shim.h and link the library of standstill.",
        dialect,
    );
    text += &st::types(dialect, SYNTAX);
    for info in REGISTRY {
        block(&mut text, info, dialect);
    }
    vec![
        File {
            name: format!("{}_shim.h", prefix.lower()),
            text: prefix.applied(&st::shim_header(TIME, dialect)),
        },
        File {
            name: format!("{}_matiec.st", prefix.lower()),
            text: prefix.applied(&text),
        },
    ]
}

fn block(out: &mut String, info: &BlockInfo, dialect: &Dialect) {
    let name = function(info);
    *out += &st::head(info, dialect, SYNTAX);
    // Names are upper-cased in the generated C. A private variable has a name no pin has.
    *out += "  VAR\n    Standstill_Key : ULINT;\n  END_VAR\n  {{\n";
    let _ = writeln!(
        out,
        "    struct standstill_{name}_in in = standstill_{name}_in_default();\n    \
         struct standstill_{name}_out out = standstill_{name}_out_default();\n    \
         uint64_t key = GetFbVar(STANDSTILL_KEY);"
    );
    for pin in info.inputs() {
        let (field, there) = (pin.field, dialect.pin(info, pin).to_ascii_uppercase());
        match pin.ty {
            PinType::Table(table) => {
                let record = snake(table.name);
                let _ = writeln!(
                    out,
                    "    struct standstill_{record} {field}_records[{0}];\n    \
                     memset({field}_records, 0, sizeof {field}_records);\n    \
                     in.{field} = {field}_records;\n    \
                     in.{field}_count = (uint32_t)GetFbVar({there},.COUNT);\n    \
                     for (uint32_t i = 0; i < in.{field}_count && i < {0}; i++) {{",
                    table.most
                );
                for column in table.fields {
                    let value = format!(
                        "GetFbVar({there},.RECORDS.table[i].{})",
                        column.name.to_ascii_uppercase()
                    );
                    let value = taken(column.ty, &value, dialect);
                    let _ = writeln!(out, "        {field}_records[i].{} = {value};", column.field);
                }
                *out += "    }\n";
            }
            PinType::Axis(_) => {
                let _ = writeln!(out, "    in.{field} = GetFbVar({there},.NUMBER);");
            }
            ty => {
                let value = taken(ty, &format!("GetFbVar({there})"), dialect);
                let _ = writeln!(out, "    in.{field} = {value};");
            }
        }
    }
    let _ = writeln!(
        out,
        "    SetFbVar(RESULT, standstill_{name}(standstill_default, &key, &in, &out));\n    \
         SetFbVar(STANDSTILL_KEY, key);\n    if (GetFbVar(RESULT) == 0) {{"
    );
    for pin in info.outputs() {
        let (field, there) = (pin.field, dialect.pin(info, pin).to_ascii_uppercase());
        let _ = match pin.ty {
            PinType::Time => writeln!(
                out,
                "        TIME {field} = {{(long)(out.{field} / 1000000000), (long)(out.{field} % 1000000000)}};\n        \
                 SetFbVar({there}, {field});"
            ),
            _ => writeln!(out, "        SetFbVar({there}, out.{field});"),
        };
    }
    *out += "    }\n  }}\nEND_FUNCTION_BLOCK\n\n";
}

/// How a value of the program becomes a field.
fn taken(ty: PinType, value: &str, dialect: &Dialect) -> String {
    match ty {
        PinType::Time => format!("STANDSTILL_NS({value})"),
        PinType::Enum(of) => st::translated(&of, value, dialect),
        _ => value.to_owned(),
    }
}
