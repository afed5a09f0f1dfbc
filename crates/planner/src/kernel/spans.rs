//! Lists of constant-input spans.

/// A stretch of time in which the highest derivative is constant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Span {
    /// Its duration; never negative.
    pub duration: f64,
    /// The constant highest derivative.
    pub input: f64,
}

impl Span {
    /// The span in `parts` of the same length.
    pub(crate) fn split(&self, parts: usize) -> impl Iterator<Item = Self> + use<> {
        let part = Self {
            duration: self.duration / parts as f64,
            ..*self
        };
        core::iter::repeat_n(part, parts)
    }
}

/// Up to `N` spans in order of time, without heap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spans<const N: usize> {
    list: [Span; N],
    len: usize,
}

impl<const N: usize> Spans<N> {
    /// No spans.
    pub const fn new() -> Self {
        const EMPTY: Span = Span {
            duration: 0.0,
            input: 0.0,
        };
        Self {
            list: [EMPTY; N],
            len: 0,
        }
    }

    /// Appends a span. A span of no length is dropped; one with the input of the last span lengthens that.
    ///
    /// Callers choose `N` as the sum of what they append, so the list is never full. If it were full, the span
    /// would be dropped.
    pub fn push(&mut self, duration: f64, input: f64) {
        if !(duration > 0.0) {
            return;
        }
        let last = self.len.checked_sub(1).and_then(|i| self.list.get_mut(i));
        if let Some(last) = last
            && last.input == input
        {
            last.duration += duration;
        } else if let Some(slot) = self.list.get_mut(self.len) {
            *slot = Span { duration, input };
            self.len += 1;
        } else {
            debug_assert!(false, "a list of {N} spans is full");
        }
    }

    /// Appends all of `other`.
    pub fn extend<const M: usize>(&mut self, other: &Spans<M>) {
        self.towards(1.0).extend(other.as_slice());
    }

    /// The list, for appending the spans of a problem that is mirrored if `side` is -1.
    pub(crate) const fn towards(&mut self, side: f64) -> Appended<'_, N> {
        Appended { spans: self, side }
    }

    /// The spans in order of time.
    pub fn iter(&self) -> impl Iterator<Item = &Span> {
        self.list.iter().take(self.len)
    }

    /// The spans in order of time.
    pub(crate) fn as_slice(&self) -> &[Span] {
        self.list.get(..self.len).unwrap_or_default()
    }

    /// Removes the first `time` of the spans.
    pub(crate) fn advance(&mut self, time: f64) {
        if let Some(first) = self.list.first_mut()
            && first.duration > time
        {
            first.duration -= time;
        } else if let Some(spans @ [_, ..]) = self.list.get_mut(..self.len) {
            spans.rotate_left(1);
            self.len -= 1;
        }
    }

    /// The spans in order of time, each in `parts` of the same length.
    pub fn split(&self, parts: usize) -> impl Iterator<Item = Span> {
        self.iter().flat_map(move |span| span.split(parts))
    }

    /// Number of spans.
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no span.
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The part of the spans before `time`. If they end earlier, a span without input fills the rest.
    #[must_use]
    pub fn until<const M: usize>(&self, time: f64) -> Spans<M> {
        let mut left = time;
        let mut first = Spans::new();
        for span in self.iter() {
            first.push(span.duration.min(left), span.input);
            left -= span.duration;
        }
        first.push(left, 0.0);
        first
    }

    /// The spans with every input multiplied by `factor`.
    #[must_use]
    pub fn amplified(mut self, factor: f64) -> Self {
        for span in self.list.iter_mut().take(self.len) {
            span.input *= factor;
        }
        self
    }

    /// The spans from the last to the first, with every input multiplied by `factor`.
    #[must_use]
    pub fn backwards(&self, factor: f64) -> Self {
        let mut backwards = Self::new();
        for span in self.list.iter().take(self.len).rev() {
            backwards.push(span.duration, factor * span.input);
        }
        backwards
    }

    /// Sum of all durations.
    pub fn duration(&self) -> f64 {
        self.iter().map(|span| span.duration).sum()
    }

    /// The spans of the mirrored problem.
    #[must_use]
    pub fn mirrored(mut self) -> Self {
        for span in self.list.iter_mut().take(self.len) {
            span.input = -span.input;
        }
        self
    }

    /// Removes all spans.
    pub const fn clear(&mut self) {
        self.len = 0;
    }
}

/// A list to which spans are appended, each with its input times `side`.
///
/// To mirror the list afterwards would take longer: the sign of a number is changed in a single byte, and a processor
/// that reads the whole number next waits until that byte is in its cache.
pub(crate) struct Appended<'a, const N: usize> {
    spans: &'a mut Spans<N>,
    side: f64,
}

impl<const N: usize> Appended<'_, N> {
    /// The same for the mirrored problem.
    pub(crate) const fn mirrored(&mut self) -> Appended<'_, N> {
        self.spans.towards(-self.side)
    }

    /// Appends a span.
    pub(crate) fn push(&mut self, duration: f64, input: f64) {
        self.spans.push(duration, self.side * input);
    }

    /// Appends all of `other`.
    pub(crate) fn extend(&mut self, other: &[Span]) {
        for span in other {
            self.push(span.duration, span.input);
        }
    }

    /// Number of spans in the list.
    pub(crate) const fn len(&self) -> usize {
        self.spans.len()
    }
}

impl<const N: usize> Default for Spans<N> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn what_is_over_is_left_out() {
        let mut spans = Spans::<3>::new();
        spans.advance(1.0);
        assert!(spans.is_empty());
        spans.push(2.0, 1.0);
        spans.push(3.0, -1.0);
        spans.advance(0.5);
        let durations = |spans: &Spans<3>| spans.iter().map(|span| span.duration).collect::<Vec<_>>();
        assert_eq!(durations(&spans), [1.5, 3.0]);
        spans.advance(1.5);
        assert_eq!(durations(&spans), [3.0]);
    }
}
