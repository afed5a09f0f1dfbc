//! The door to a runtime: one thread at a time, in a tick or outside of it, and no panic goes through it.

use crate::Code;
use crate::runtime::{Inner, MAGIC, Mode, Runtime};
use core::sync::atomic::Ordering::{Acquire, Relaxed, Release};

/// When a function may be called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum When {
    /// Between begin and end, by the thread that began.
    InTick,
    /// Not then.
    Outside,
    /// At any time.
    Any,
}

/// A number for the calling thread, not 0: the address of a variable that each has.
#[cfg(feature = "std")]
fn me() -> usize {
    std::thread_local! {
        static ME: u8 = const { 0 };
    }
    ME.with(|me| core::ptr::from_ref(me).addr())
}

/// Without `std` threads cannot be told apart; that two are inside at a time can, see [`Busy`].
#[cfg(not(feature = "std"))]
#[inline]
fn me() -> usize {
    1
}

/// Marks a call as under way.
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

/// Does `work` on the runtime at `runtime`, if it may be done now.
///
/// # Safety
/// `runtime` is null, or four bytes can be read there; if a [`Runtime`] was made there it is still in place.
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

/// The runtime at this place.
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
    // SAFETY: aligned, and readable for as long as the magic is, which comes first; any bits are an atomic number.
    if unsafe { &(*runtime).magic }.load(Acquire) != MAGIC {
        return Err(Code::NoRuntime);
    }
    // SAFETY: a runtime was made here and not closed, so all of it is there; what threads share of it is atomic, the rest
    // in a cell.
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
    // Equal to `me` only if this thread wrote it, so nothing has to be ordered before it.
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
    // SAFETY: the owner is this thread, set here or when its tick began, and no other thread comes past the check above
    // until it is 0 again. In this thread nothing is under way: no function calls back into the host.
    let inner = unsafe { &mut *runtime.inner.get() };
    let result = caught(inner, work);
    if !inner.ticking {
        runtime.owner.store(0, Release);
    }
    result
}

/// Why a function for the open tick is refused.
fn not_in_tick(owner: usize) -> Code {
    if owner == 0 {
        Code::NotInTick
    } else {
        Code::OtherThread
    }
}

/// Does `work`; a panic ends the tick, and the resource is stopped.
#[cfg(feature = "std")]
#[inline]
fn caught<T>(inner: &mut Inner, work: impl FnOnce(&mut Inner) -> Result<T, Code>) -> Result<T, Code> {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    // What it leaves behind is asked for nothing but to ramp down.
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

    /// What a defect of ours would do: no panic comes out, and the axis is ramped down in the ticks that follow.
    #[test]
    fn a_caught_panic_stops_the_resource_and_the_axis_switches_off() {
        let config = RuntimeConfig {
            size: size_of::<RuntimeConfig>() as u32,
            axes: 1,
            instances: 1,
            reserved: 0,
            cycle_ns: 1_000_000,
        };
        let bytes = storage::size(&config).unwrap();
        let mut memory = vec![0_u128; bytes.div_ceil(16)];
        // SAFETY: as long and as aligned as asked for, and alive until the end of the test.
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
