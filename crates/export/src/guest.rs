//! What a guest in WebAssembly imports: as data for those who write hosts and compilers, as a header for guests in C.

use crate::File;
use crate::c::{NOTICE, types};
use crate::names::{Prefix, function};
use standstill_blocks::REGISTRY;
use standstill_fb::flat::{Layout, Pointer, Scalar};
use standstill_fb::{Pin, PinType};
use std::fmt::Write as _;

pub(crate) fn files(prefix: &Prefix) -> Vec<File> {
    vec![
        File {
            name: format!("{}_guest.h", prefix.lower()),
            text: prefix.applied(&header(prefix)),
        },
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
    out + "#ifdef __cplusplus\n}\n#endif\n\n#endif /* STANDSTILL_GUEST_H */\n"
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
         {{\"name\": \"log\", \"params\": [\"i32\", \"i32\"], \"results\": []}}",
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
    out + "\n  ]\n}\n"
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
