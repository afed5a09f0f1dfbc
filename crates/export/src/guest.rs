//! The imports of a WebAssembly guest: as data for authors of hosts and compilers, and as a header for
//! guests in C.

use crate::File;
use crate::c::{NOTICE, types};
use crate::names::{Prefix, function};
use standstill_blocks::REGISTRY;
use standstill_fb::flat::{Layout, Pointer, Scalar};
use standstill_fb::{Pin, PinType, ring};
use std::fmt::Write as _;

pub(crate) fn files(prefix: &Prefix) -> Vec<File> {
    vec![
        File::new(prefix, "_guest.h", &header(prefix)),
        File {
            name: format!("{}_imports.json", prefix.lower()),
            text: imports(prefix),
        },
    ]
}

fn header(prefix: &Prefix) -> String {
    let mut out = format!(
        "/* The function blocks of standstill, for guests in WebAssembly: compile with clang --target=wasm32.\n *\n\
         {NOTICE} */\n\n#ifndef STANDSTILL_GUEST_H\n#define STANDSTILL_GUEST_H\n\n#include <stdint.h>\n\
         #include <string.h>\n\n#ifdef __cplusplus\n#define _Static_assert static_assert\nextern \"C\" {{\n#endif\n\n\
         #define STANDSTILL_IMPORT(name) \\\n    __attribute__((import_module(\"{}\"), import_name(#name)))\n\n",
        prefix.lower()
    );
    out += &types(false);
    for info in REGISTRY {
        let name = function(info);
        let _ = write!(
            out,
            "/** One call of {}. A key of 0 makes the instance. */\n\
             STANDSTILL_IMPORT({name}) int32_t standstill_{name}(uint64_t *key,\n    \
             const struct standstill_{name}_in *in, struct standstill_{name}_out *out);\n\n",
            info.name
        );
    }
    out += "/** Tells the host something: `bytes` bytes of UTF-8. */\n\
            STANDSTILL_IMPORT(log) void standstill_log(const char *text, uint32_t bytes);\n\n";
    out += &ring();
    out + "#ifdef __cplusplus\n}\n#endif\n\n#endif /* STANDSTILL_GUEST_H */\n"
}

/// The diagnostic ring in C: the record is that of `standstill.h`.
fn ring() -> String {
    let mut out = "/** One entry of the diagnostic ring, which keeps the last 64. */\ntypedef struct standstill_record {\n"
        .to_owned();
    for (name, ty, doc, _) in ring::FIELDS {
        let ty = match ty {
            "f64" => "double",
            "u64" => "uint64_t",
            "u32" => "uint32_t",
            "i32" => "int32_t",
            _ => "char",
        };
        let many = if ty == "char" {
            format!("[{}]", ring::NAME_SIZE)
        } else {
            String::new()
        };
        let mut lines = vec![String::new()];
        for word in doc.split(' ') {
            if lines.last().is_some_and(|line| line.len() + word.len() > 100) {
                lines.push(String::new());
            }
            if let Some(line) = lines.last_mut() {
                *line += word;
                line.push(' ');
            }
        }
        let doc = lines.join("\n     *  ").replace(" \n", "\n");
        let _ = writeln!(out, "    /** {doc}*/\n    {ty} {name}{many};");
    }
    let _ = write!(
        out,
        "}} standstill_record;\n_Static_assert(sizeof(standstill_record) == {}, \"standstill_record\");\n\n\
         /** Copies records of the diagnostic ring, oldest first, from number `*next` on; `*next` becomes the number to go\n \
         *  on from, and `*copied` how many there are. Records that were overwritten meanwhile are left out.\n \
         *  `record_size` is sizeof(standstill_record), `room` how many records fit. */\n\
         STANDSTILL_IMPORT(log_read) int32_t standstill_log_read(uint64_t *next, standstill_record *records,\n    \
         uint32_t record_size, uint32_t room, uint32_t *copied);\n\n",
        ring::RECORD_SIZE
    );
    out
}

const fn scalar_name(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::U8 => "u8",
        Scalar::I16 => "i16",
        Scalar::U16 => "u16",
        Scalar::U32 => "u32",
        Scalar::I32 => "i32",
        Scalar::I64 => "i64",
        Scalar::F64 => "f64",
    }
}

/// The imports as JSON. Names are identifiers and IEC names, so nothing in them needs an escape.
fn imports(prefix: &Prefix) -> String {
    let mut out = format!(
        "{{\n  \"abi_version\": 1,\n  \"module\": \"{}\",\n  \"exports\": {{\n    \
         \"plc_init\": {{\"params\": [], \"results\": []}},\n    \
         \"plc_scan\": {{\"params\": [\"i32\", \"i64\"], \"results\": []}}\n  }},\n  \"imports\": [\n    \
         {{\"name\": \"log\", \"params\": [\"i32\", \"i32\"], \"results\": []}},\n    \
         {{\"name\": \"log_read\", \"params\": [\"i32\", \"i32\", \"i32\", \"i32\", \"i32\"], \"results\": [\"i32\"]}}",
        prefix.lower()
    );
    for info in REGISTRY {
        let _ = write!(
            out,
            ",\n    {{\"name\": \"{}\", \"block\": \"{}\", \"params\": [\"i32\", \"i32\", \"i32\"], \
             \"results\": [\"i32\"],",
            function(info),
            info.name
        );
        structure(&mut out, "in", info.inputs());
        out.push(',');
        structure(&mut out, "out", info.outputs());
        out.push('}');
    }
    out += "\n  ],\n  \"records\": [";
    for (index, table) in crate::c::tables().iter().enumerate() {
        let layout = Layout::of_record(table.fields);
        let _ = write!(
            out,
            "{}\n    {{\"type\": \"{}\", \"most\": {}, \"size\": {}, \"fields\": [",
            if index > 0 { "," } else { "" },
            table.name,
            table.most,
            layout.size
        );
        members(&mut out, table.fields, &layout);
        out += "]}";
    }
    let _ = write!(
        out,
        "\n  ],\n  \"log_record\": {{\"size\": {}, \"fields\": [",
        ring::RECORD_SIZE
    );
    for (index, (name, ty, _, offset)) in ring::FIELDS.into_iter().enumerate() {
        let _ = write!(
            out,
            "{}\n    {{\"name\": \"{name}\", \"offset\": {offset}, \"type\": \"{ty}\"}}",
            if index > 0 { "," } else { "" },
        );
    }
    out + "]}\n}\n"
}

fn structure(out: &mut String, name: &str, pins: &[Pin]) {
    let layout = Layout::of_pins(pins, Pointer::Bits32);
    let _ = write!(
        out,
        "\n      \"{name}\": {{\"size\": {}, \"fields\": [",
        layout.size
    );
    members(out, pins, &layout);
    out.push_str("]}");
}

fn members(out: &mut String, pins: &[Pin], layout: &Layout) {
    for (index, pin) in pins.iter().enumerate() {
        let ty = match (pin.ty, pin.ty.scalar()) {
            (PinType::Table(table), _) => format!("array of {}", table.name),
            (_, Some(scalar)) => scalar_name(scalar).to_owned(),
            (_, None) => continue,
        };
        let _ = write!(
            out,
            "{}\n        {{\"name\": \"{}\", \"offset\": {}, \"type\": \"{ty}\", \"iec\": \"{}\"}}",
            if index > 0 { "," } else { "" },
            pin.name,
            layout.offset(index),
            pin.ty.iec_name()
        );
    }
}
