//! The keys, as the help shows them.

/// A key and its effect.
pub const KEYS: [(&str, &str); 14] = [
    ("space", "run, pause"),
    ("s  S", "a scan, ten scans"),
    ("e", "to the next event"),
    ("c", "until a claim is decided"),
    ("+  -", "faster, slower"),
    ("tab", "the next axis"),
    ("up down", "select a pin (also k j, page keys)"),
    ("enter", "change it: a BOOL turns over"),
    ("v", "the next program, or the axes"),
    ("w", "write the changed run as a script"),
    ("r", "start again"),
    ("?", "this help; any key closes it"),
    ("q esc", "end"),
    ("", "Changes apply in the next scan."),
];
