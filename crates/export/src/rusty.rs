//! Shims for rusty: declarations with `{external}`, and a C file with their bodies.
//!
//! There an instance is a C structure: first a pointer to a table, then pins in the order of declaration,
//! VAR_IN_OUT as pointers. The C file asserts the offset of each pin, so a compiler with another layout
//! refuses the file.

use crate::File;
use crate::c::c_type;
use crate::dialect::Dialect;
use crate::names::{Prefix, function, pou, snake};
use crate::st::{self, Syntax};
use standstill_blocks::REGISTRY;
use standstill_fb::{BlockInfo, Direction, Pin, PinType};
use std::fmt::Write as _;

const SYNTAX: Syntax = Syntax {
    numbered_enumerations: true,
};

pub(crate) fn files(prefix: &Prefix, dialect: &Dialect) -> Vec<File> {
    let mut text = st::notice(
        "The function blocks of standstill for rusty.\n\n   Link standstill_rusty.c and the library of standstill.",
        dialect,
    );
    text += &st::types(dialect, SYNTAX);
    for info in REGISTRY {
        let _ = write!(
            text,
            "{{external}}\n{}  VAR\n    Standstill_Key : ULINT;\n  END_VAR\nEND_FUNCTION_BLOCK\n\n",
            st::head(info, dialect, SYNTAX)
        );
    }
    vec![
        File::new(prefix, "_shim.h", &st::shim_header("", dialect)),
        File::new(prefix, "_rusty.st", &text),
        File::new(prefix, "_rusty.c", &bodies(dialect)),
    ]
}

fn bodies(dialect: &Dialect) -> String {
    let mut out = format!(
        "/* The bodies of the function blocks of standstill for rusty.\n *\n{} */\n\n\
         #include \"standstill_shim.h\"\n#include <stddef.h>\n\n\
         struct standstill_reference {{\n    int32_t number;\n}};\n\n",
        crate::c::NOTICE
    );
    for table in crate::c::tables() {
        let name = snake(table.name);
        let _ = write!(
            out,
            "struct standstill_{name}_array {{\n    int32_t count;\n    struct standstill_{name} records[{}];\n}};\n\n",
            table.most
        );
    }
    for info in REGISTRY {
        block(&mut out, info, dialect);
    }
    out
}

fn block(out: &mut String, info: &BlockInfo, dialect: &Dialect) {
    let name = function(info);
    let _ = writeln!(out, "struct standstill_{name}_fb {{\n    void *table;");
    // The first of two pointers is the table; the rest follows the rules of C for 64 bits.
    let mut asserts = String::new();
    let mut at = 8;
    for pin in info.pins() {
        let (ty, size) = member(pin);
        at = at.max(8_usize).next_multiple_of(size);
        let _ = writeln!(out, "    {ty}{};", pin.field);
        let _ = writeln!(
            asserts,
            "STANDSTILL_ASSERT(rusty_{name}_{0}, sizeof(void *) != 8 || offsetof(struct standstill_{name}_fb, {0}) == {at});",
            pin.field
        );
        at += size;
    }
    // After the pins: the result of the library, and the key.
    let result = at.max(8).next_multiple_of(4);
    let key = (result + 4).next_multiple_of(8);
    let _ = writeln!(
        asserts,
        "STANDSTILL_ASSERT(rusty_{name}_key, sizeof(void *) != 8 || (offsetof(struct standstill_{name}_fb, result) == {result} && \
         offsetof(struct standstill_{name}_fb, key) == {key} && sizeof(struct standstill_{name}_fb) == {}));",
        key + 8
    );
    let _ = writeln!(
        out,
        "    int32_t result;\n    uint64_t key;\n}};\n{asserts}\nvoid {0}(struct standstill_{name}_fb *self);\n\n\
         void {0}(struct standstill_{name}_fb *self) {{\n    \
         struct standstill_{name}_in in = standstill_{name}_in_default();\n    \
         struct standstill_{name}_out out = standstill_{name}_out_default();",
        pou(info)
    );
    for pin in info.inputs() {
        let field = pin.field;
        let _ = match pin.ty {
            PinType::Axis(_) => writeln!(
                out,
                "    in.{field} = self->{field} != NULL ? self->{field}->number : 0;"
            ),
            PinType::Table(_) => writeln!(
                out,
                "    if (self->{field} != NULL) {{\n        in.{field} = self->{field}->records;\n        \
                 in.{field}_count = (uint32_t)self->{field}->count;\n    }}"
            ),
            PinType::Enum(of) => {
                // VAR_IN_OUT is a pointer for any type.
                let value = if pin.direction == Direction::InOut {
                    format!("(self->{field} != NULL ? *self->{field} : 0)")
                } else {
                    format!("self->{field}")
                };
                writeln!(out, "    in.{field} = {};", st::translated(&of, &value, dialect))
            }
            _ => writeln!(out, "    in.{field} = self->{field};"),
        };
    }
    let _ = writeln!(
        out,
        "    self->result = standstill_{name}(STANDSTILL_RUNTIME &self->key, &in, &out);\n    \
         if (self->result == 0) {{"
    );
    for pin in info.outputs() {
        let _ = writeln!(out, "        self->{0} = out.{0};", pin.field);
    }
    *out += "    }\n}\n\n";
}

/// The C type of a member with its declarator, and its size, which is also its alignment.
fn member(pin: &Pin) -> (String, usize) {
    match (pin.ty, pin.ty.scalar()) {
        (PinType::Axis(_), _) => ("struct standstill_reference *".to_owned(), 8),
        (PinType::Table(table), _) => (format!("struct standstill_{}_array *", snake(table.name)), 8),
        (_, Some(scalar)) if pin.direction == Direction::InOut => (format!("{} *", c_type(scalar)), 8),
        (_, Some(scalar)) => (format!("{} ", c_type(scalar)), scalar.size()),
        (_, None) => (String::new(), 1),
    }
}
