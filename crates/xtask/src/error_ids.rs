//! `docs/error-ids.md` from the table of errors.

use crate::{Generated, NOTICE};
use standstill_axis::{ErrorId, RETIRED};
use std::fmt::Write;

pub fn page() -> Generated {
    let mut text = format!(
        "{NOTICE}# ErrorIDs\n\n\
         Every number a block can show at `ErrorID` or `AxisErrorID`. Numbers are interface: they are never\n\
         reused and never change their meaning. The hundreds say what an error is about: 1 a pin's value,\n\
         2 the axis state, 3 the command buffer, 4 the axis, 5 the drive, 6 the communication, 7 not\n\
         supported yet, 9 a defect of standstill. What each looks like in a trace: [faults.md](faults.md).\n\n\
         | ErrorID | name | cause | remedy |\n| ---: | --- | --- | --- |\n"
    );
    for id in ErrorId::ALL {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} |",
            id.number(),
            id.name(),
            id.cause(),
            id.remedy()
        );
    }
    text.push_str("\n## Out of use\n\n| ErrorID | what it said |\n| ---: | --- |\n");
    for (number, meaning) in RETIRED {
        let _ = writeln!(text, "| {number} | {meaning} |");
    }
    Generated {
        path: "docs/error-ids.md".into(),
        text,
    }
}
