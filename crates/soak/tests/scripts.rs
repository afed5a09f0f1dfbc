//! The scripts of `scan-tests` under the rules of random programs.

use standstill_script::suite::{self, Allowed};
use standstill_soak::monkey::judge;
use standstill_testkit::stride;
use std::path::Path;

/// The slave catches up along its cam: its positions are rounded more than once, which the script also allows for.
const ROUNDED: &str = "cams/the_master_turns_back_while_a_slave_catches_up";

#[test]
fn the_scripts_of_the_repository_break_no_rule() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scan-tests");
    let mut broken = Vec::new();
    for path in suite::find(&folder).expect("scripts").iter().step_by(stride()) {
        let name = suite::name(&folder, path);
        let (script, _) = suite::read_file(path, &[], &Allowed::default()).expect("a script");
        let (seen, failure) = judge(&script);
        assert!(seen.scans > 0, "{name}");
        if name != ROUNDED
            && let Some(failure) = failure
        {
            broken.push(format!("{name}: {failure:?}"));
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}
