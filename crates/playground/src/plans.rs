//! Lines of plans.

use crate::bounds;
use crate::project::refused;

/// Answers every line as `standstill plan` does; `{"refused": ".."}` for too many of them.
///
/// Work: that of the lines, each bounded by its method.
#[must_use]
pub fn plan(lines: &str) -> String {
    let many = lines.lines().filter(|line| !line.trim().is_empty()).count();
    if let Err(why) = bounds::bytes(lines.len()).and_then(|()| bounds::lines(many)) {
        return refused(&why).to_string();
    }
    let mut answers = Vec::new();
    // Refusals are part of the answers; writing to memory cannot fail.
    let _ = standstill_cli::plan::plan(&mut lines.as_bytes(), "lines", &mut answers);
    String::from_utf8_lossy(&answers).into_owned()
}
