//! A library in PLCopen XML (TC6 2.01): interfaces of the blocks, so that IDEs show them.

use crate::File;
use crate::c::{comment, tables};
use crate::dialect::{Dialect, enumerations};
use crate::names::{Prefix, pou};
use crate::st::{Syntax, initial, record_name};
use standstill_blocks::REGISTRY;
use standstill_fb::{BlockInfo, Direction, Pin, PinType};
use std::fmt::Write as _;

/// The schema requires a date; a file that is the same every day has this one.
const DATE: &str = "2026-01-01T00:00:00";

/// Its enumerations have numbers.
const SYNTAX: Syntax = Syntax {
    numbered_enumerations: true,
};

pub(crate) fn files(prefix: &Prefix, dialect: &Dialect) -> Vec<File> {
    vec![File {
        name: format!("{}.xml", prefix.lower()),
        text: library(prefix, dialect),
    }]
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

fn library(prefix: &Prefix, dialect: &Dialect) -> String {
    let name = escaped(prefix.lower());
    let mut out = format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n\
         <project xmlns=\"http://www.plcopen.org/xml/tc6_0201\" xmlns:xhtml=\"http://www.w3.org/1999/xhtml\">\n  \
         <fileHeader companyName=\"standstill\" productName=\"standstill\" productVersion=\"1\" \
         creationDateTime=\"{DATE}\" contentDescription=\"Not a safety function: read docs/safety.md\"/>\n  \
         <contentHeader name=\"{name}\" modificationDateTime=\"{DATE}\">\n    <coordinateInfo>\n"
    );
    for language in ["fbd", "ld", "sfc"] {
        let _ = writeln!(
            out,
            "      <{language}>\n        <scaling x=\"1\" y=\"1\"/>\n      </{language}>"
        );
    }
    out += "    </coordinateInfo>\n  </contentHeader>\n  <types>\n    <dataTypes>\n";
    for reference in ["AXIS_REF", "MC_INPUT_REF", "MC_OUTPUT_REF"] {
        structure(
            &mut out,
            reference,
            "          <variable name=\"Number\"><type><DINT/></type></variable>\n",
        );
    }
    for info in enumerations() {
        let _ = writeln!(
            out,
            "      <dataType name=\"{}\">\n        <baseType>\n          <enum>\n            <values>",
            info.name
        );
        for (element, number, _) in dialect.elements(&info) {
            let _ = writeln!(
                out,
                "              <value name=\"{element}\" value=\"{number}\"/>"
            );
        }
        out += "            </values>\n          </enum>\n        </baseType>\n      </dataType>\n";
    }
    for table in tables() {
        let record = record_name(&table);
        let members: String = table
            .fields
            .iter()
            .map(|field| {
                format!(
                    "          <variable name=\"{}\"><type>{}</type></variable>\n",
                    field.name,
                    ty(field.ty)
                )
            })
            .collect();
        structure(&mut out, &record, &members);
        let array = format!(
            "          <variable name=\"Count\"><type><DINT/></type></variable>\n          \
             <variable name=\"Records\"><type><array><dimension lower=\"0\" upper=\"{}\"/><baseType>\
             <derived name=\"{record}\"/></baseType></array></type></variable>\n",
            table.most - 1
        );
        structure(&mut out, table.name, &array);
    }
    out += "    </dataTypes>\n    <pous>\n";
    for info in REGISTRY {
        block(&mut out, info, prefix, dialect);
    }
    out + "    </pous>\n  </types>\n  <instances>\n    <configurations/>\n  </instances>\n</project>\n"
}

fn structure(out: &mut String, name: &str, members: &str) {
    let _ = write!(
        out,
        "      <dataType name=\"{name}\">\n        <baseType>\n          <struct>\n{}          </struct>\n        \
         </baseType>\n      </dataType>\n",
        members.replace("          <variable", "            <variable")
    );
}

/// A type as an element.
fn ty(ty: PinType) -> String {
    match ty {
        PinType::Axis(_) | PinType::Enum(_) | PinType::Table(_) => {
            format!("<derived name=\"{}\"/>", ty.iec_name())
        }
        _ => format!("<{}/>", ty.iec_name()),
    }
}

fn block(out: &mut String, info: &BlockInfo, prefix: &Prefix, dialect: &Dialect) {
    let _ = writeln!(
        out,
        "      <pou name=\"{}\" pouType=\"functionBlock\">\n        <interface>",
        prefix.applied(&pou(info))
    );
    // The order of the sections in the schema's examples; the schema itself requires no order.
    for (direction, section) in [
        (Direction::InOut, "inOutVars"),
        (Direction::Input, "inputVars"),
        (Direction::Output, "outputVars"),
    ] {
        let pins: Vec<_> = info
            .pins()
            .enumerate()
            .filter(|(_, pin)| pin.direction == direction)
            .collect();
        if pins.is_empty() {
            continue;
        }
        let _ = writeln!(out, "          <{section}>");
        for (index, pin) in pins {
            variable(out, info, index, pin, dialect);
        }
        let _ = writeln!(out, "          </{section}>");
    }
    let _ = writeln!(
        out,
        "        </interface>\n        <body>\n          <ST>\n            <xhtml:p>(* {} The body is native code: \
         docs/export.md. *)</xhtml:p>\n          </ST>\n        </body>\n      </pou>",
        escaped(info.doc.trim())
    );
}

fn variable(out: &mut String, info: &BlockInfo, index: usize, pin: &Pin, dialect: &Dialect) {
    let initial = initial(info, index, pin, dialect, SYNTAX).map_or_else(String::new, |value| {
        format!("<initialValue><simpleValue value=\"{value}\"/></initialValue>")
    });
    let _ = writeln!(
        out,
        "            <variable name=\"{}\"><type>{}</type>{initial}<documentation><xhtml:p>{}</xhtml:p></documentation>\
         </variable>",
        dialect.pin(info, pin),
        ty(pin.ty),
        escaped(&comment(pin))
    );
}
