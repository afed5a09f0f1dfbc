//! The list of blocks in `docs/continuous-update.md`, from the registry.

use crate::{Generated, read, replace_part};
use standstill_blocks::REGISTRY;

/// The page; everything else in it is written by hand.
const PAGE: &str = "docs/continuous-update.md";

/// The page with its list made anew.
pub fn page() -> Generated {
    let blocks: Vec<_> = REGISTRY
        .iter()
        .filter(|info| info.pin("ContinuousUpdate").is_some())
        .map(|info| format!("- [{}](blocks/{}.md)\n", info.name, info.name.to_lowercase()))
        .collect();
    let mut text = read(PAGE);
    replace_part(
        PAGE,
        &mut text,
        "blocks with ContinuousUpdate",
        &format!("\n{}\n", blocks.concat()),
    );
    Generated {
        path: PAGE.to_owned(),
        text,
    }
}
