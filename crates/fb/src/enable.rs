//! The core of Enable-type blocks: `Enable` in, `Valid` with values or an error out.
//!
//! Source: PLCopen Motion Control Part 1, section on Enable/Valid; rules R15 and R52 to R59.

use crate::Context;
use standstill_axis::{Axis, AxisId, ErrorId, Planner, Scope};

/// What an Enable-type block shows. Outputs are derived from it, so Valid and Error cannot be TRUE at once
/// (R53).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reading<T> {
    /// Not enabled: no outputs are set (R55, R59).
    #[default]
    Off,
    /// Valid, with these values.
    Valid(T),
    /// An error that passes: values return by themselves when its cause is gone (R56).
    Recoverable(ErrorId),
    /// An error that stays until the next rising edge of Enable (R57).
    Failed(ErrorId),
}

impl<T: Default> Reading<T> {
    /// `Valid`.
    pub fn is_valid(&self) -> bool {
        matches!(self, Self::Valid(_))
    }

    /// `Busy`.
    pub fn is_busy(&self) -> bool {
        matches!(self, Self::Valid(_) | Self::Recoverable(_))
    }

    /// `Error`.
    pub fn is_error(&self) -> bool {
        matches!(self, Self::Recoverable(_) | Self::Failed(_))
    }

    /// `ErrorID`.
    pub fn error_id(&self) -> ErrorId {
        match self {
            Self::Off | Self::Valid(_) => ErrorId::None,
            Self::Recoverable(id) | Self::Failed(id) => *id,
        }
    }

    /// The values; FALSE and 0 if there are none.
    pub fn value(self) -> T {
        if let Self::Valid(value) = self {
            value
        } else {
            T::default()
        }
    }
}

/// State kept between calls.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnableCore {
    /// The error that ended the reading. It stays until Enable falls.
    failed: Option<ErrorId>,
}

impl EnableCore {
    /// One call: reads the axis at the pin with `read`, whose errors are recoverable. A missing axis is
    /// not recoverable, because it is a wiring error.
    pub fn scan<P: Planner, T>(
        &mut self,
        enable: bool,
        axis: AxisId,
        context: &Context<'_, P>,
        read: impl FnOnce(&Axis<P>) -> Result<T, ErrorId>,
    ) -> Reading<T> {
        self.answer(enable, || context.axes.get(axis.index()).map(read))
    }

    /// The same for a block that writes.
    pub fn write<P: Planner, T>(
        &mut self,
        enable: bool,
        axis: AxisId,
        context: &mut Context<'_, P>,
        write: impl FnOnce(&mut Axis<P>, &mut Scope<'_>) -> Result<T, ErrorId>,
    ) -> Reading<T> {
        self.answer(enable, || {
            let (axis, scope) = context.axis(axis).ok()?;
            Some(write(axis, scope))
        })
    }

    /// The result of `ask` while enabled; `None` if there is no such axis.
    fn answer<T>(&mut self, enable: bool, ask: impl FnOnce() -> Option<Result<T, ErrorId>>) -> Reading<T> {
        if !enable {
            self.failed = None;
            return Reading::Off;
        }
        if let Some(id) = self.failed {
            return Reading::Failed(id);
        }
        match ask() {
            Some(Ok(value)) => Reading::Valid(value),
            Some(Err(id)) => Reading::Recoverable(id),
            None => {
                self.failed = Some(ErrorId::AxisUnknown);
                Reading::Failed(ErrorId::AxisUnknown)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use standstill_axis::{AxisConfig, Limits, Log, Standard};

    const HERE: AxisId = AxisId::new(0);
    const STALE: ErrorId = ErrorId::CommunicationLost;

    /// The result of one call, from Enable, the axis at the pin and the reading.
    struct Bench {
        core: EnableCore,
        axes: [Axis; 1],
        log: Log,
    }

    impl Bench {
        fn new() -> Self {
            let limits = Limits {
                velocity: 1.0,
                acceleration: 1.0,
                deceleration: 1.0,
                jerk: f64::INFINITY,
                snap: f64::INFINITY,
            };
            let axis = Axis::new(HERE, AxisConfig::new(limits), Standard::new(0.001));
            Self {
                core: EnableCore::default(),
                axes: [axis.unwrap()],
                log: Log::default(),
            }
        }

        fn call(&mut self, enable: bool, axis: AxisId, read: Result<u8, ErrorId>) -> Reading<u8> {
            let context = Context {
                now_ns: 0,
                scope: Scope::new(0, &mut self.log),
                axes: &mut self.axes,
                tables: &[],
            };
            self.core.scan(enable, axis, &context, |_| read)
        }
    }

    /// The cases of a call: Enable FALSE, values, a passing error, no axis.
    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Input {
        Disabled,
        Fine,
        Stale,
        NoAxis,
    }

    /// Covers: R52, R53, R54, R55, R56, R57, R58, R59, T39e, T39f
    #[test]
    fn every_sequence_of_five_calls_shows_what_the_last_ones_demand() {
        use Input::{Disabled, Fine, NoAxis, Stale};
        let kinds = [Disabled, Fine, Stale, NoAxis];
        for number in 0..4_usize.pow(5) {
            let mut bench = Bench::new();
            let mut ended = false;
            for place in 0..5 {
                let input = kinds[number / 4_usize.pow(place) % 4];
                let axis = if input == NoAxis { AxisId::NONE } else { HERE };
                let read = if input == Stale { Err(STALE) } else { Ok(7) };
                let shown = bench.call(input != Disabled, axis, read);
                // Only Enable FALSE ends a failure.
                ended = input != Disabled && (ended || input == NoAxis);
                let expected = match input {
                    Disabled => Reading::Off,
                    _ if ended => Reading::Failed(ErrorId::AxisUnknown),
                    Stale => Reading::Recoverable(STALE),
                    Fine | NoAxis => Reading::Valid(7),
                };
                assert_eq!(shown, expected, "{number}, call {place}");
            }
        }
    }

    /// Covers: R34, R53, R56, R57, R59
    #[test]
    fn outputs_of_each_reading() {
        let rows = [
            (Reading::Off, (false, false, false, ErrorId::None, 0)),
            (Reading::Valid(7), (true, true, false, ErrorId::None, 7)),
            (Reading::Recoverable(STALE), (false, true, true, STALE, 0)),
            (Reading::Failed(STALE), (false, false, true, STALE, 0)),
        ];
        for (reading, expected) in rows {
            let shown = (
                reading.is_valid(),
                reading.is_busy(),
                reading.is_error(),
                reading.error_id(),
                reading.value(),
            );
            assert_eq!(shown, expected, "{reading:?}");
        }
    }
}
