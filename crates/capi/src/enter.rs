//! The only way into a runtime: one thread at a time, inside or outside a tick, and no panic gets out.

use crate::Code;
use crate::runtime::{Inner, MAGIC, Mode, Runtime};
use core::sync::atomic::Ordering::{Acquire, Relaxed, Release};

/// When a function may be called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum When {
    /// Between begin and end, on the thread that began the tick.
    InTick,
    /// Not during a tick.
    Outside,
    /// At any time.
    Any,
}

/// A non-zero number for the calling thread: the address of a thread-local variable.
#[cfg(feature = "std")]
fn me() -> usize {
    std::thread_local! {
        static ME: u8 = const { 0 };
    }
    ME.with(|me| core::ptr::from_ref(me).addr())
}

/// Without `std` threads cannot be distinguished. Two calls at a time can be detected, see [`Busy`].
#[cfg(not(feature = "std"))]
#[inline]
fn me() -> usize {
    1
}

/// Marks a call as in progress.
#[cfg(not(feature = "std"))]
struct Busy<'a>(&'a Runtime);

#[cfg(not(feature = "std"))]
impl<'a> Busy<'a> {
    fn new(runtime: &'a Runtime) -> Result<Self, Code> {
        if runtime.busy.swap(true, Acquire) {
            return Err(Code::OtherThread);
        }
        Ok(Self(runtime))
    }
}

#[cfg(not(feature = "std"))]
impl Drop for Busy<'_> {
    fn drop(&mut self) {
        self.0.busy.store(false, Release);
    }
}

/// Runs `work` on the runtime at `runtime`, if this is allowed now.
///
/// # Safety
/// `runtime` is null, or four bytes can be read there. If a [`Runtime`] was made there, it still exists.
#[inline]
pub(crate) unsafe fn enter(
    runtime: *mut Runtime,
    when: When,
    work: impl FnOnce(&mut Inner) -> Result<(), Code>,
) -> i32 {
    // SAFETY: passed on.
    let result = unsafe { try_enter(runtime, when, work) };
    result.map_or_else(|code| code as i32, |()| Code::Ok as i32)
}

/// The runtime at this address.
///
/// # Safety
/// As [`enter`].
#[inline]
unsafe fn there<'a>(runtime: *mut Runtime) -> Result<&'a Runtime, Code> {
    if runtime.is_null() {
        return Err(Code::NullPointer);
    }
    if !runtime.is_aligned() {
        return Err(Code::NoRuntime);
    }
    // SAFETY: aligned, and readable for the length of the magic, which comes first. Any bits are a valid
    // atomic number.
    if unsafe { &(*runtime).magic }.load(Acquire) != MAGIC {
        return Err(Code::NoRuntime);
    }
    // SAFETY: a runtime was made here and not closed, so all of it exists. Its shared parts are atomic;
    // the rest is in a cell.
    Ok(unsafe { &*runtime })
}

/// # Safety
/// As [`enter`].
#[inline]
unsafe fn try_enter(
    runtime: *mut Runtime,
    when: When,
    work: impl FnOnce(&mut Inner) -> Result<(), Code>,
) -> Result<(), Code> {
    // SAFETY: passed on.
    let runtime = unsafe { there(runtime)? };
    #[cfg(not(feature = "std"))]
    let _busy = Busy::new(runtime)?;
    let me = me();
    // Equal to `me` only if this thread wrote it, so no memory ordering is needed.
    let owner = runtime.owner.load(Relaxed);
    match (owner == me, when) {
        (true, When::Outside) => return Err(Code::InTick),
        (true, When::InTick | When::Any) => {}
        (false, When::InTick) => return Err(not_in_tick(owner)),
        (false, When::Outside | When::Any) => {
            if runtime.owner.compare_exchange(0, me, Acquire, Relaxed).is_err() {
                return Err(Code::OtherThread);
            }
        }
    }
    // SAFETY: this thread is the owner, set here or when its tick began. No other thread passes the check
    // above until the owner is 0 again. In this thread no call is under way, because no function calls
    // back into the host.
    let inner = unsafe { &mut *runtime.inner.get() };
    let result = caught(inner, work);
    if !inner.ticking {
        runtime.owner.store(0, Release);
    }
    result
}

/// The reason why a function that needs an open tick is refused.
fn not_in_tick(owner: usize) -> Code {
    if owner == 0 {
        Code::NotInTick
    } else {
        Code::OtherThread
    }
}

/// Runs `work`. A panic ends the tick and stops the resource.
#[cfg(feature = "std")]
#[inline]
fn caught<T>(inner: &mut Inner, work: impl FnOnce(&mut Inner) -> Result<T, Code>) -> Result<T, Code> {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    // After a panic, the state is used only to ramp down.
    catch_unwind(AssertUnwindSafe(|| work(inner))).unwrap_or_else(|_| broken(inner))
}

#[cfg(feature = "std")]
#[cold]
fn broken<T>(inner: &mut Inner) -> Result<T, Code> {
    inner.ticking = false;
    inner.mode = Mode::Broken;
    inner.off_pending = true;
    Err(Code::Internal)
}

#[cfg(not(feature = "std"))]
#[inline]
fn caught<T>(inner: &mut Inner, work: impl FnOnce(&mut Inner) -> Result<T, Code>) -> Result<T, Code> {
    work(inner)
}

/// Refuses to call a block in a resource that was stopped.
pub(crate) fn running(inner: &Inner) -> Result<(), Code> {
    match inner.mode {
        Mode::Running | Mode::Recorded => Ok(()),
        Mode::Stopped => Err(Code::Stopped),
        Mode::Broken => Err(Code::Internal),
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use crate::{AxisSetup, DriveSetup, RuntimeConfig, storage};

    /// Simulates a defect of ours: no panic gets out, and the axis is ramped down in the next ticks.
    #[test]
    fn a_caught_panic_stops_the_resource_and_the_axis_switches_off() {
        let config = RuntimeConfig {
            size: size_of::<RuntimeConfig>() as u32,
            axes: 1,
            instances: 1,
            history: 0,
            cycle_ns: 1_000_000,
        };
        let bytes = storage::size(&config).unwrap();
        let mut memory = vec![0_u128; bytes.div_ceil(16)];
        // SAFETY: as long and as aligned as required, and alive until the end of the test.
        let runtime = unsafe { storage::init(memory.as_mut_ptr().cast(), bytes, &config) }.unwrap();
        // SAFETY: the runtime made above.
        let with = |when, work: &mut dyn FnMut(&mut Inner) -> Result<(), Code>| unsafe {
            enter(runtime, when, work)
        };
        let axis = AxisSetup {
            start_powered: 1,
            velocity: 10.0,
            acceleration: 100.0,
            ..AxisSetup::defaults(size_of::<AxisSetup>() as u32)
        };
        let drive = DriveSetup::defaults(size_of::<DriveSetup>() as u32);
        assert_eq!(
            with(When::Outside, &mut |inner| inner
                .add_axis(&axis, &drive)
                .map(|_| ())),
            0
        );
        assert_eq!(with(When::Outside, &mut |inner| inner.begin(0)), 0);
        assert_eq!(
            with(When::InTick, &mut |_| panic!("on purpose")),
            Code::Internal as i32
        );
        assert_eq!(
            with(When::InTick, &mut |_| Ok(())),
            Code::NotInTick as i32,
            "the tick has ended"
        );
        for scan in 1..10 {
            assert_eq!(with(When::Outside, &mut |inner| inner.begin(scan * 1_000_000)), 0);
            assert_eq!(
                with(When::InTick, &mut |inner| running(inner)),
                Code::Internal as i32
            );
            assert_eq!(
                with(When::InTick, &mut |inner| {
                    inner.end();
                    Ok(())
                }),
                0
            );
        }
        assert_eq!(with(When::Outside, &mut |inner| inner.check_off()), 0);
        assert_eq!(
            with(When::Outside, &mut |inner| inner.start()),
            Code::Internal as i32,
            "it stays so"
        );
    }
}
