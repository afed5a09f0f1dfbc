//! The program move.wat, in Rust.
#![no_std]
#![no_main]
#![allow(static_mut_refs)]

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}

#[link(wasm_import_module = "standstill")]
unsafe extern "C" {
    fn mc_power(key: *mut u64, inputs: *const PowerIn, outputs: *mut PowerOut) -> i32;
    fn mc_move_absolute(key: *mut u64, inputs: *const MoveIn, outputs: *mut MoveOut) -> i32;
}

#[repr(C, align(8))]
struct PowerIn { size: u32, axis: i32, enable: u8, enable_positive: u8, enable_negative: u8 }

#[repr(C, align(8))]
struct PowerOut { size: u32, status: u8, valid: u8, error: u8, error_id: u16 }

#[repr(C, align(8))]
struct MoveIn {
    size: u32, axis: i32, execute: u8, continuous_update: u8, position: f64, velocity: f64, acceleration: f64,
    deceleration: f64, jerk: f64, direction: i32, buffer_mode: i32, snap: f64,
}

#[repr(C, align(8))]
struct MoveOut { size: u32, done: u8, busy: u8, active: u8, command_aborted: u8, error: u8, error_id: u16 }

static mut POWER: (u64, PowerIn, PowerOut) = (
    0,
    PowerIn { size: 16, axis: 1, enable: 1, enable_positive: 1, enable_negative: 1 },
    PowerOut { size: 16, status: 0, valid: 0, error: 0, error_id: 0 },
);
static mut MOVE: (u64, MoveIn, MoveOut) = (
    0,
    MoveIn {
        size: 72, axis: 1, execute: 0, continuous_update: 0, position: 0.0, velocity: 50.0, acceleration: 0.0,
        deceleration: 0.0, jerk: 0.0, direction: 0, buffer_mode: 0, snap: 0.0,
    },
    MoveOut { size: 16, done: 0, busy: 0, active: 0, command_aborted: 0, error: 0, error_id: 0 },
);

#[unsafe(no_mangle)]
pub static mut go: u8 = 0;
#[unsafe(no_mangle)]
pub static mut done: u8 = 0;
#[unsafe(no_mangle)]
pub static mut target: f64 = 10.0;

#[unsafe(no_mangle)]
pub extern "C" fn plc_scan(_tick: i32, _now_ns: i64) {
    // SAFETY: a guest has one thread, and the host writes between calls only.
    unsafe {
        mc_power(&mut POWER.0, &POWER.1, &mut POWER.2);
        MOVE.1.execute = u8::from((&raw const go).read_volatile() != 0 && POWER.2.status != 0);
        MOVE.1.position = (&raw const target).read_volatile();
        mc_move_absolute(&mut MOVE.0, &MOVE.1, &mut MOVE.2);
        done = MOVE.2.done;
    }
}
