//! The standard function blocks of IEC 61131-3, exact to the call.
//!
//! Choices that the standard leaves open: counters count past PV to the limits of INT; F_TRIG sees no
//! edge in its first call; timers use the time of the call and not the number of calls.

pub mod ctd;
pub mod ctu;
pub mod ctud;
pub mod f_trig;
pub mod r_trig;
pub mod rs;
pub mod sr;
pub mod tof;
pub mod ton;
pub mod tp;

use standstill_fb::Time;

/// Whether `signal` has risen since the last call; `memory` is FALSE before the first.
fn rising(memory: &mut bool, signal: bool) -> bool {
    let edge = signal && !*memory;
    *memory = signal;
    edge
}

/// The time since `start_ns`, at most `pt`, and whether `pt` has passed. A negative `pt` counts as 0.
fn elapsed(start_ns: i64, now_ns: i64, pt: Time) -> (Time, bool) {
    let since = Time(now_ns.saturating_sub(start_ns));
    let pt = pt.max(Time(0));
    (since.min(pt), since >= pt)
}

#[cfg(test)]
mod testing {
    use standstill_axis::{Log, Scope, Standard};
    use standstill_fb::{Block, Context};

    /// One call of a block that needs no axis.
    pub fn call<B: Block>(block: &mut B, inputs: &B::Inputs, now_ns: i64) -> B::Outputs {
        let mut log = Log::default();
        let mut context = Context::<Standard> {
            now_ns,
            scope: Scope::new(0, &mut log),
            axes: &mut [],
            tables: &[],
        };
        block.call(inputs, &mut context)
    }
}
