//! The C library without `std` as a bare-metal image. All its functions are called with values that the
//! compiler does not know. Its panic handler calls a function that does not exist, so the image links if,
//! and only if, no panic is reachable.
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]

#[cfg(target_os = "none")]
mod bare_metal {
    #![allow(unsafe_code)]

    use core::hint::black_box;
    use standstill_capi as c;

    /// Keeps a function of any type, as if a host might call it.
    fn keep<F>(function: F) {
        black_box(function);
    }

    macro_rules! keep_blocks {
        ($($group:ident :: $name:ident :: $block:ident)*) => {
            $(keep::<unsafe extern "C" fn(*mut c::Runtime, *mut u64, *const u8, *mut u8) -> i32>(c::$name);)*
        };
    }

    // SAFETY: nothing else in the image has this name, and nothing calls it: the image is linked and
    // examined, never run.
    #[unsafe(no_mangle)]
    extern "C" fn _start() -> ! {
        keep::<extern "C" fn() -> u32>(c::standstill_abi_version);
        keep::<extern "C" fn(i32) -> *const core::ffi::c_char>(c::standstill_result_text);
        keep::<unsafe extern "C" fn(_, _) -> _>(c::standstill_runtime_size);
        keep::<unsafe extern "C" fn(_, _, _, _, _) -> _>(c::standstill_runtime_init);
        keep::<unsafe extern "C" fn(_) -> _>(c::standstill_runtime_close);
        keep::<unsafe extern "C" fn(_) -> _>(c::standstill_axis_defaults);
        keep::<unsafe extern "C" fn(_) -> _>(c::standstill_drive_defaults);
        keep::<unsafe extern "C" fn(_, _, _, _) -> _>(c::standstill_axis_add);
        keep::<unsafe extern "C" fn(_, _) -> _>(c::standstill_config_error);
        keep::<unsafe extern "C" fn(_, _) -> _>(c::standstill_tick_begin);
        keep::<unsafe extern "C" fn(_) -> _>(c::standstill_tick_end);
        keep::<unsafe extern "C" fn(_) -> _>(c::standstill_stop);
        keep::<unsafe extern "C" fn(_) -> _>(c::standstill_start);
        keep::<unsafe extern "C" fn(_, _) -> _>(c::standstill_instance_release);
        keep::<unsafe extern "C" fn(_, _, _) -> _>(c::standstill_axis_read);
        keep::<unsafe extern "C" fn(_, _, _) -> _>(c::standstill_feedback_write);
        keep::<unsafe extern "C" fn(_, _, _) -> _>(c::standstill_command_read);
        keep::<unsafe extern "C" fn(_, _, _, _) -> _>(c::standstill_simulate);
        keep::<unsafe extern "C" fn(_, _, _, _) -> _>(c::standstill_simulate_input);
        keep::<unsafe extern "C" fn(_, _, _, _, _) -> _>(c::standstill_simulate_probe);
        keep::<unsafe extern "C" fn(_, _, _) -> _>(c::standstill_simulate_push);
        keep::<unsafe extern "C" fn(_, _, _, _) -> _>(c::standstill_simulate_report);
        keep::<unsafe extern "C" fn(_, _, _, _, _, _) -> _>(c::standstill_log_read);
        keep::<unsafe extern "C" fn(_, _, _, _, _, _) -> _>(c::standstill_recorder_size);
        keep::<unsafe extern "C" fn(_, _, _, _, _, _, _) -> _>(c::standstill_recorder_init);
        keep::<unsafe extern "C" fn(_) -> _>(c::standstill_recorder_end);
        keep::<unsafe extern "C" fn(_) -> _>(c::standstill_recorder_trip);
        keep::<unsafe extern "C" fn(_) -> _>(c::standstill_recorder_arm);
        keep::<unsafe extern "C" fn(_, _) -> _>(c::standstill_recorder_state);
        keep::<unsafe extern "C" fn(_, _, _, _, _) -> _>(c::standstill_recorder_read);
        keep::<unsafe extern "C" fn(_, _, _) -> _>(c::standstill_instance_make);
        keep::<unsafe extern "C" fn(_, _, _) -> _>(c::standstill_cams_size);
        keep::<unsafe extern "C" fn(_, _, _, _, _) -> _>(c::standstill_cams_init);
        standstill_blocks::for_every_block!(keep_blocks);
        #[cfg(feature = "reachable-panic")]
        assert!(black_box(true), "on purpose");
        loop {}
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
