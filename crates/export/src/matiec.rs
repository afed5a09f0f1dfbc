//! Shims for matiec: bodies in C between `{{` and `}}`, pins through `GetFbVar` and `SetFbVar`, and the
//! code that runs a program.
//!
//! These two respect forcing, do not depend on the layout of an instance, and also work in a guest.

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

/// The functions that a host calls, and those that matiec expects from it.
const MAIN: &str = r#"
#include "standstill_shim.h"
#include "iec_types_all.h"
#include <stddef.h>

/* Variables of VAR_GLOBAL are read and written from outside by address and type: the value comes first. */
_Static_assert(sizeof(BOOL) == 1 && offsetof(__IEC_BOOL_t, value) == 0, "bool");
_Static_assert(sizeof(INT) == 2 && offsetof(__IEC_INT_t, value) == 0, "int");
_Static_assert(sizeof(WORD) == 2 && offsetof(__IEC_WORD_t, value) == 0, "word");
_Static_assert(sizeof(DINT) == 4 && offsetof(__IEC_DINT_t, value) == 0, "dint");
_Static_assert(sizeof(DWORD) == 4 && offsetof(__IEC_DWORD_t, value) == 0, "dword");
_Static_assert(sizeof(ULINT) == 8 && offsetof(__IEC_ULINT_t, value) == 0, "ulint");
_Static_assert(sizeof(LREAL) == 8 && offsetof(__IEC_LREAL_t, value) == 0, "lreal");

#ifdef __wasm__
#define STANDSTILL_EXPORT(name) __attribute__((export_name(#name)))
#else
#define STANDSTILL_EXPORT(name)
#endif

TIME __CURRENT_TIME;
BOOL __DEBUG;

extern unsigned long greatest_tick_count__;
void config_init__(void);
void config_run__(unsigned long tick);

void plc_init(void);
void plc_scan(int32_t tick, int64_t now_ns);

static unsigned long standstill_tick;

/* Sets all variables; before the first scan. */
STANDSTILL_EXPORT(plc_init) void plc_init(void) {
    standstill_tick = 0;
    config_init__();
}

/* Runs the tasks that are due. The host calls it every common_ticktime__ ns, between tick_begin and tick_end. */
STANDSTILL_EXPORT(plc_scan) void plc_scan(int32_t tick, int64_t now_ns) {
    (void)tick;
    __CURRENT_TIME.tv_sec = now_ns / 1000000000;
    __CURRENT_TIME.tv_nsec = now_ns % 1000000000;
    config_run__(standstill_tick++);
    if (greatest_tick_count__ != 0 && standstill_tick >= greatest_tick_count__) standstill_tick = 0;
}
"#;

const TIME: &str = "\
/* TIME is a structure of seconds and nanoseconds there. */
#define STANDSTILL_NS(time) ((int64_t)(time).tv_sec * INT64_C(1000000000) + (time).tv_nsec)

";

pub(crate) fn files(prefix: &Prefix, dialect: &Dialect) -> Vec<File> {
    let mut text = st::notice(
        "The function blocks of standstill for matiec and Beremiz.\n\n   Compile the C files with \
         -include standstill_shim.h, standstill_matiec_main.c with them, and link the library of standstill,\n   or \
         nothing for a guest in WebAssembly.",
        dialect,
    );
    text += &st::types(dialect, SYNTAX);
    for info in REGISTRY {
        block(&mut text, info, dialect);
    }
    vec![
        File::new(prefix, "_shim.h", &st::shim_header(TIME, dialect)),
        File::new(prefix, "_matiec.st", &text),
        File::new(
            prefix,
            "_matiec_main.c",
            &format!(
                "/* A program that matiec translated, as a guest in WebAssembly or linked to a host in C: plc_init and plc_scan.\n \
                 *\n{} */\n{MAIN}",
                crate::c::NOTICE
            ),
        ),
    ]
}

fn block(out: &mut String, info: &BlockInfo, dialect: &Dialect) {
    let name = function(info);
    *out += &st::head(info, dialect, SYNTAX);
    // SetFbVar does not evaluate its value for a forced pin, so the call is a statement of its own. Names
    // are upper-cased in the generated C. A private variable has a name that no pin has.
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
        "    int32_t result = standstill_{name}(STANDSTILL_RUNTIME &key, &in, &out);\n    \
         SetFbVar(STANDSTILL_KEY, key);\n    SetFbVar(RESULT, result);\n    if (result == 0) {{"
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
