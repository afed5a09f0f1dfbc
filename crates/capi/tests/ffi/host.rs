//! The shortest possible host.

use standstill_capi::*;
use std::ffi::CStr;
use std::mem::MaybeUninit;
use std::ptr::null_mut;

/// A runtime in memory of this test.
pub struct Host {
    pub runtime: *mut Runtime,
    _storage: Vec<u128>,
}

pub fn config(axes: u32, instances: u32) -> RuntimeConfig {
    RuntimeConfig {
        size: size_of::<RuntimeConfig>() as u32,
        axes,
        instances,
        history: 0,
        cycle_ns: 1_000_000,
    }
}

pub fn size_of_runtime(config: &RuntimeConfig) -> usize {
    let mut bytes = 0;
    // SAFETY: both pointers are valid for their types.
    assert_eq!(unsafe { standstill_runtime_size(config, &mut bytes) }, 0);
    bytes
}

/// A structure of the library with its size; everything else is 0.
///
/// # Safety
/// `T` begins with a `u32`, and all bits are a value of it.
pub unsafe fn sized<T>() -> T {
    let mut made = MaybeUninit::<T>::zeroed();
    // SAFETY: the caller's contract.
    unsafe {
        made.as_mut_ptr().cast::<u32>().write(size_of::<T>() as u32);
        made.assume_init()
    }
}

impl Host {
    pub fn new(axes: u32, instances: u32) -> Self {
        Self::made(&config(axes, instances))
    }

    pub fn made(config: &RuntimeConfig) -> Self {
        let bytes = size_of_runtime(config);
        let mut storage = vec![0_u128; bytes.div_ceil(16)];
        let mut runtime = null_mut();
        // SAFETY: the storage is as long and as aligned as asked for, and lives as long as the handle.
        let code =
            unsafe { standstill_runtime_init(1, storage.as_mut_ptr().cast(), bytes, config, &mut runtime) };
        assert_eq!(code, 0);
        Self {
            runtime,
            _storage: storage,
        }
    }

    pub fn setup() -> (AxisSetup, DriveSetup) {
        // SAFETY: two structures of the library.
        unsafe {
            let (mut axis, mut drive) = (sized::<AxisSetup>(), sized::<DriveSetup>());
            assert_eq!(standstill_axis_defaults(&mut axis), 0);
            assert_eq!(standstill_drive_defaults(&mut drive), 0);
            (axis.velocity, axis.acceleration) = (10.0, 100.0);
            (axis, drive)
        }
    }

    pub fn add(&self, axis: &AxisSetup, drive: &DriveSetup) -> Result<i32, i32> {
        let mut number = 0;
        // SAFETY: all pointers are valid for their types.
        match unsafe { standstill_axis_add(self.runtime, axis, drive, &mut number) } {
            0 => Ok(number),
            code => Err(code),
        }
    }

    /// With one powered axis.
    pub fn powered() -> Self {
        let host = Self::new(1, 4);
        let (mut axis, drive) = Self::setup();
        axis.start_powered = 1;
        assert_eq!(host.add(&axis, &drive), Ok(1));
        host
    }

    pub fn begin(&self, now: i64) -> i32 {
        // SAFETY: a handle.
        unsafe { standstill_tick_begin(self.runtime, now) }
    }

    pub fn end(&self) -> i32 {
        // SAFETY: a handle.
        unsafe { standstill_tick_end(self.runtime) }
    }

    pub fn close(&self) -> i32 {
        // SAFETY: a handle.
        unsafe { standstill_runtime_close(self.runtime) }
    }

    pub fn stop(&self) -> i32 {
        // SAFETY: a handle.
        unsafe { standstill_stop(self.runtime) }
    }

    pub fn status(&self) -> AxisStatus {
        self.status_of(1)
    }

    pub fn status_of(&self, axis: i32) -> AxisStatus {
        // SAFETY: a handle, and a structure of the library.
        unsafe {
            let mut status = sized();
            assert_eq!(standstill_axis_read(self.runtime, axis, &mut status), 0);
            status
        }
    }

    /// The key and the value of the last refused configuration.
    pub fn fault(&self) -> (String, f64) {
        // SAFETY: a handle, and a structure of the library; the key ends in 0.
        unsafe {
            let mut fault = sized::<ConfigFault>();
            assert_eq!(standstill_config_error(self.runtime, &mut fault), 0);
            let key = CStr::from_ptr(fault.key.as_ptr()).to_str().unwrap();
            (key.to_owned(), fault.value)
        }
    }

    pub fn simulate(&self, axis: i32, mishap: i32, code: u16) -> i32 {
        // SAFETY: a handle.
        unsafe { standstill_simulate(self.runtime, axis, mishap, code) }
    }

    pub fn release(&self, key: &mut u64) -> i32 {
        // SAFETY: a handle and a key.
        unsafe { standstill_instance_release(self.runtime, key) }
    }

    /// Ticks until every axis is off, and closes. Returns the largest step of a position.
    pub fn run_down(&self, from: i64) -> f64 {
        let mut largest = 0.0_f64;
        for scan in from..from + 2000 {
            if self.close() == 0 {
                return largest;
            }
            let before = self.status().position;
            assert_eq!((self.begin(scan * 1_000_000), self.end()), (0, 0));
            largest = largest.max((self.status().position - before).abs());
        }
        panic!("the axis does not switch off");
    }
}
