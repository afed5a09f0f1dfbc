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

/// A number for the calling thread, not 0.
///
/// The address of its thread control block: the ABI of this system keeps it at `fs:0`. A variable of the thread would do,
/// too, but in a static library its address comes from a function, around which every call of a block saves registers: a
/// fifth of a call that finds nothing to do.
#[cfg(all(
    feature = "std",
    target_os = "linux",
    target_arch = "x86_64",
    target_pointer_width = "64",
    not(miri)
))]
#[inline(always)]
fn me() -> usize {
    let me;
    // SAFETY: reads a word that is there in every thread of this system, and changes nothing.
    unsafe {
        core::arch::asm!("mov {}, fs:[0]", out(reg) me, options(pure, readonly, nostack, preserves_flags))
    };
    me
}

/// A number for the calling thread, not 0: the address of a variable that each has.
#[cfg(all(
    feature = "std",
    not(all(
        target_os = "linux",
        target_arch = "x86_64",
        target_pointer_width = "64",
        not(miri)
    ))
))]
#[inline(always)]
fn me() -> usize {
    std::thread_local! {
        static ME: u8 = const { 0 };
    }
    ME.with(|me| core::ptr::from_ref(me).addr())
}

/// Without `std` threads cannot be told apart; that two are inside at a time can, see [`Busy`].
#[cfg(not(feature = "std"))]
#[inline(always)]
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
#[inline(always)]
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
#[inline(always)]
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
#[inline(always)]
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

/// What a glance at a call says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Glance {
    /// That was all there is to do.
    Done,
    /// There is more to do, and nothing wrong with it.
    Wakes,
    /// It has to be looked at.
    Other,
}

/// Does `glance` on the runtime at `runtime` if it has a tick of this thread open, and `rest` unless that was all there is
/// to do. `rest` is told whether the glance saw that nothing is wrong; if not it finds the reason, by name. Both are
/// guarded against panics; `rest` stands in a function of its own, which comes last, and is handed the pointers, so that
/// it need not capture anything.
///
/// # Safety
/// As [`enter`].
#[inline(always)]
pub(crate) unsafe fn in_tick(
    runtime: *mut Runtime,
    key: *mut u64,
    inputs: *const u8,
    outputs: *mut u8,
    glance: impl FnOnce(&mut Inner) -> Glance,
    rest: impl FnOnce(&mut Inner, *mut u64, *const u8, *mut u8, bool) -> Result<(), Code>,
) -> i32 {
    // SAFETY: passed on.
    match unsafe { glanced(runtime, glance) } {
        Glance::Done => Code::Ok as i32,
        // SAFETY: passed on.
        Glance::Wakes => unsafe { finish(runtime, key, inputs, outputs, true, rest) },
        // SAFETY: passed on.
        Glance::Other => unsafe { finish(runtime, key, inputs, outputs, false, rest) },
    }
}

/// The first half of [`in_tick`].
///
/// # Safety
/// As [`enter`].
#[inline(always)]
unsafe fn glanced(runtime: *mut Runtime, glance: impl FnOnce(&mut Inner) -> Glance) -> Glance {
    // SAFETY: passed on.
    let Ok(runtime) = (unsafe { there(runtime) }) else {
        return Glance::Other;
    };
    #[cfg(not(feature = "std"))]
    let Ok(_busy) = Busy::new(runtime) else {
        return Glance::Other;
    };
    if runtime.owner.load(Relaxed) != me() {
        return Glance::Other;
    }
    // SAFETY: as in `try_enter`.
    let inner = unsafe { &mut *runtime.inner.get() };
    caught(inner, |inner| Ok(glance(inner))).unwrap_or(Glance::Other)
}

/// The second half of [`in_tick`].
///
/// # Safety
/// As [`enter`]; if `checked`, this thread has a tick open.
// As C calls, so that no panic comes out and it can be the last thing its caller does.
#[inline(never)]
unsafe extern "C" fn finish<W: FnOnce(&mut Inner, *mut u64, *const u8, *mut u8, bool) -> Result<(), Code>>(
    runtime: *mut Runtime,
    key: *mut u64,
    inputs: *const u8,
    outputs: *mut u8,
    checked: bool,
    rest: W,
) -> i32 {
    let runtime = if checked {
        // SAFETY: it has a tick open, so it is there.
        unsafe { &*runtime }
    } else {
        // SAFETY: passed on.
        match unsafe { there(runtime) } {
            Ok(runtime) => runtime,
            Err(code) => return code as i32,
        }
    };
    #[cfg(not(feature = "std"))]
    let _busy = match Busy::new(runtime) {
        Ok(busy) => busy,
        Err(code) => return code as i32,
    };
    if !checked {
        let owner = runtime.owner.load(Relaxed);
        if owner != me() {
            return not_in_tick(owner) as i32;
        }
    }
    // SAFETY: as in `try_enter`.
    let inner = unsafe { &mut *runtime.inner.get() };
    match caught(inner, |inner| rest(inner, key, inputs, outputs, checked)) {
        Ok(()) => Code::Ok as i32,
        Err(code) => left(runtime, code),
    }
}

/// Gives up the runtime if its tick was ended by a panic.
#[cold]
#[inline(never)]
extern "C" fn left(runtime: &Runtime, code: Code) -> i32 {
    // SAFETY: the thread still owns the runtime, and uses nothing else of its inner part.
    if !unsafe { &*runtime.inner.get() }.ticking {
        runtime.owner.store(0, Release);
    }
    code as i32
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
#[inline(always)]
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
#[inline(always)]
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

    /// A block's call has two halves, and neither lets a panic out or keeps the runtime for its thread.
    #[test]
    fn a_panic_in_either_half_of_a_call_ends_the_tick_and_stops_the_resource() {
        for in_glance in [true, false] {
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
            let (key, inputs, outputs) = (core::ptr::null_mut(), core::ptr::null(), core::ptr::null_mut());
            let call = |rests: bool| {
                let glance = |_: &mut Inner| {
                    assert!(!in_glance, "on purpose");
                    if rests { Glance::Done } else { Glance::Other }
                };
                let rest = |inner: &mut Inner, _, _, _, _| {
                    running(inner)?;
                    assert!(in_glance, "on purpose");
                    Ok(())
                };
                // SAFETY: the runtime made above; nothing uses the pointers.
                unsafe { in_tick(runtime, key, inputs, outputs, glance, rest) }
            };
            // SAFETY: the runtime made above.
            let begin = || unsafe { enter(runtime, When::Outside, |inner| inner.begin(0)) };
            assert_eq!(call(true), Code::NotInTick as i32);
            assert_eq!(begin(), 0);
            if !in_glance {
                assert_eq!(call(true), 0, "the other half is not come to");
            }
            assert_eq!(call(false), Code::Internal as i32);
            assert_eq!(call(false), Code::NotInTick as i32, "the tick has ended");
            assert_eq!(begin(), 0, "the runtime is free, but");
            // SAFETY: the runtime made above.
            let after = unsafe { enter(runtime, When::InTick, |inner| running(inner)) };
            assert_eq!(after, Code::Internal as i32, "it stays stopped");
        }
    }
}
