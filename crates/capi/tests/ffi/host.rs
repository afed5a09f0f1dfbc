//! The shortest possible host.

use standstill_capi::*;
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
        let (mut axis, mut drive) = (
            MaybeUninit::<AxisSetup>::zeroed(),
            MaybeUninit::<DriveSetup>::zeroed(),
        );
        // SAFETY: all of their fields are numbers, so zeros are values; the sizes are set before they are read.
        unsafe {
            axis.assume_init_mut().size = size_of::<AxisSetup>() as u32;
            drive.assume_init_mut().size = size_of::<DriveSetup>() as u32;
            assert_eq!(standstill_axis_defaults(axis.as_mut_ptr()), 0);
            assert_eq!(standstill_drive_defaults(drive.as_mut_ptr()), 0);
            let mut axis = axis.assume_init();
            (axis.velocity, axis.acceleration) = (10.0, 100.0);
            (axis, drive.assume_init())
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
        let mut status = MaybeUninit::<AxisStatus>::zeroed();
        // SAFETY: all fields are numbers, and the size is set.
        unsafe {
            status.assume_init_mut().size = size_of::<AxisStatus>() as u32;
            assert_eq!(standstill_axis_read(self.runtime, axis, status.as_mut_ptr()), 0);
            status.assume_init()
        }
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
