//! The input of a touch probe between two feedbacks.

use standstill_axis::Edge;

/// Changes of a level that are kept for one interval.
const CHANGES: usize = 4;

/// A level and its changes within the interval that ends with the next feedback.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wire {
    level: bool,
    /// Part of the interval, and the level from there on. The first `count` are valid, in time order.
    changes: [(f64, bool); CHANGES],
    count: usize,
}

impl Wire {
    /// Sets the level from the part `at` (0 to 1) of the interval on. If there are more changes than are
    /// kept, the last one counts.
    pub fn set(&mut self, at: f64, level: bool) {
        let change = (at.clamp(0.0, 1.0), level);
        self.count = (self.count + 1).min(CHANGES);
        let Some(kept) = self.changes.get_mut(..self.count) else {
            return;
        };
        if let Some(last) = kept.last_mut() {
            *last = change;
        }
        // A later change at the same instant goes behind.
        for slot in (1..kept.len()).rev() {
            if let Some([before, after]) = kept.get_mut(slot - 1..=slot)
                && before.0 > after.0
            {
                core::mem::swap(before, after);
            }
        }
    }

    /// Ends the interval: calls `seen` for each edge, in time order.
    pub fn take(&mut self, mut seen: impl FnMut(f64, Edge)) {
        for (at, level) in self.changes.iter().take(self.count) {
            match (self.level, *level) {
                (false, true) => seen(*at, Edge::Rising),
                (true, false) => seen(*at, Edge::Falling),
                _ => {}
            }
            self.level = *level;
        }
        self.count = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn edges_come_in_the_order_of_time_and_no_change_is_none() {
        let mut wire = Wire::default();
        let edges = |wire: &mut Wire| {
            let mut seen = Vec::new();
            wire.take(|at, edge| seen.push((at, edge)));
            seen
        };
        wire.set(0.75, false);
        wire.set(0.25, true);
        assert_eq!(edges(&mut wire), [(0.25, Edge::Rising), (0.75, Edge::Falling)]);
        assert_eq!(edges(&mut wire), []);
        wire.set(0.5, false);
        assert_eq!(edges(&mut wire), []);
        for (at, level) in [(0.1, true), (0.2, false), (0.3, true), (0.4, false), (2.0, true)] {
            wire.set(at, level);
        }
        let expected = [(0.1, Edge::Rising), (0.2, Edge::Falling), (0.3, Edge::Rising)];
        assert_eq!(edges(&mut wire), expected, "the fourth was replaced by the fifth");
    }
}
