//! The picture of the README: the tutorial's test, failing.

use crate::Generated;
use standstill_picture::{Theme, failing, themed};
use standstill_script::{read, run};
use standstill_trace::Trace;

/// The test.
const SCRIPT: &str = "scan-tests/tutorial/abort.scan.json";

/// Its title in the picture.
const NAME: &str = "abort.scan.json";

/// The change that makes it fail, step 4 of the tutorial.
const CHANGE: [&str; 2] = [
    r#""Position": 0, "Velocity": 100}"#,
    r#""Position": 0, "Velocity": 100, "BufferMode": "mcBuffered"}"#,
];

/// The picture for light and for dark pages. A page chooses one, because a picture itself knows only the
/// reader's system.
pub fn pictures() -> [Generated; 2] {
    let text = crate::read(SCRIPT);
    let [before, after] = CHANGE;
    let changed = text.replacen(before, after, 1);
    assert_ne!(text, changed, "{SCRIPT} has no `{before}`");
    let (expected, found) = (traced(&text), traced(&changed));
    let picture = failing(NAME, &expected, &found);
    [("light", Theme::Light), ("dark", Theme::Dark)].map(|(name, theme)| Generated {
        path: format!("docs/pictures/failing-{name}.svg"),
        text: themed(&picture, theme),
    })
}

fn traced(text: &str) -> Trace {
    let script = read(text, NAME, &[]).unwrap_or_else(|error| panic!("{error}"));
    run(&script)
        .unwrap_or_else(|error| panic!("{SCRIPT}: {error}"))
        .trace
}
