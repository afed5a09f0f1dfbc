//! Bytes as calls of the C library: any function, in any order, with any structure in its place. There
//! must be no undefined behaviour and no panic, every result must be a code of the list, and a refused
//! call must write nothing.
#![no_main]

use libfuzzer_sys::fuzz_target;
use standstill_capi::*;
use std::ffi::c_char;
use std::ptr::{from_mut, from_ref, null_mut};

/// The rest of the input; zeros when it has run out.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    fn number(&mut self) -> u64 {
        u64::from_le_bytes(std::array::from_fn(|_| self.byte()))
    }

    /// A structure of these bytes. Most of its words are doubles of a realistic size, and in most cases
    /// the size field is right.
    fn fill(&mut self, words: &mut [u64], size: usize) {
        for word in words.iter_mut() {
            *word = match self.byte() {
                0..=99 => 0,
                100..=199 => (f64::from(self.byte()) * 0.25 - 8.0).to_bits(),
                200..=229 => u64::from(self.byte()) << 32 | u64::from(self.byte()),
                _ => self.number(),
            };
        }
        if self.byte() < 240 {
            words[0] = words[0] & !0xFFFF_FFFF | size as u64;
        } else {
            // Never more than exists.
            words[0] = words[0] & !0xFFFF_FFFF | u64::from(self.byte()) % (8 * words.len() as u64 + 1);
        }
    }
}

type Call = unsafe extern "C" fn(*mut Runtime, *mut u64, *const u8, *mut u8) -> i32;

macro_rules! table {
    ($($group:ident :: $name:ident :: $block:ident)*) => {
        const CALLS: &[Call] = &[$($name),*];
    };
}

standstill_blocks::for_every_block!(table);

/// Words of the largest structure, and then some.
const WORDS: usize = 48;

fn play(bytes: &mut Bytes<'_>) {
    let config = RuntimeConfig {
        size: size_of::<RuntimeConfig>() as u32,
        axes: 2,
        instances: 4,
        history: 0,
        cycle_ns: 1_000_000,
    };
    let mut needed = 0;
    let mut runtime = null_mut();
    // SAFETY: here and below all pointers are null or valid for their types; size fields are never larger
    // than the memory, and arrays are as long as their counts.
    unsafe {
        assert_eq!(standstill_runtime_size(&config, &mut needed), 0);
        let mut storage = vec![0_u128; needed.div_ceil(16)];
        let at = storage.as_mut_ptr().cast();
        assert_eq!(standstill_runtime_init(1, at, needed, &config, &mut runtime), 0);
        assert_eq!(standstill_cams_size(3, 40, &mut needed), 0);
        let mut cams = vec![0_u128; needed.div_ceil(16)];
        let at = cams.as_mut_ptr().cast();
        assert_eq!(standstill_cams_init(runtime, at, needed, 3, 40), 0);
        let mut keys = [0_u64; 6];
        let mut now = 0_i64;
        let mut next = 0;
        // Of recorders: a removed one is not freed before the runtime.
        let mut memories = Vec::new();
        for _ in 0..600 {
            if bytes.0.is_empty() {
                break;
            }
            let mut given = [0_u64; WORDS];
            let mut taken = [0_u64; WORDS];
            let code = match bytes.byte() % 16 {
                0 | 1 => {
                    let mut axis = [0_u64; WORDS];
                    let mut drive = [0_u64; WORDS];
                    axis[0] = size_of::<AxisSetup>() as u64;
                    drive[0] = size_of::<DriveSetup>() as u64;
                    standstill_axis_defaults(from_mut(&mut axis).cast());
                    standstill_drive_defaults(from_mut(&mut drive).cast());
                    // Valid limits, then a few random words.
                    for (word, limit) in axis[1..6].iter_mut().zip([10.0, 100.0, 100.0, 1000.0, 20_000.0_f64]) {
                        *word = limit.to_bits();
                    }
                    axis[0] |= u64::from(bytes.byte() % 2) << 32;
                    drive[0] = drive[0] & 0xFFFF_FFFF | u64::from(bytes.byte() % 5) << 32;
                    for _ in 0..bytes.byte() % 4 {
                        let place = 1 + usize::from(bytes.byte()) % (WORDS - 1);
                        axis[place] = bytes.number();
                        drive[1 + place % 30] = bytes.number();
                    }
                    let mut number = 0;
                    standstill_axis_add(runtime, from_ref(&axis).cast(), from_ref(&drive).cast(), &mut number)
                }
                2..=4 => {
                    now = now.wrapping_add(i64::from(bytes.byte()) * 100_000 - 1_000_000);
                    standstill_tick_begin(runtime, now)
                }
                5..=7 => standstill_tick_end(runtime),
                8..=11 => {
                    let call = usize::from(bytes.byte()) % CALLS.len();
                    let info = &standstill_blocks::REGISTRY[call];
                    let size = info.flat_inputs(standstill_fb::flat::Pointer::NATIVE).size;
                    bytes.fill(&mut given, size);
                    if given[0] as u32 as usize >= 8 {
                        given[0] = given[0] & 0xFFFF_FFFF | u64::from(bytes.byte() % 4) << 32;
                    }
                    // Arrays of existing words, with counts that fit or that the library refuses.
                    let records = [0x3FF0_0000_0000_0000_u64; 40 * 5];
                    let layout = info.flat_inputs(standstill_fb::flat::Pointer::NATIVE);
                    for (index, _) in info.tables() {
                        let raw: *mut u8 = given.as_mut_ptr().cast();
                        let place = raw.add(layout.offset(index));
                        let nothing = bytes.byte() % 8 == 0;
                        let first = if nothing { std::ptr::null() } else { records.as_ptr() };
                        place.cast::<*const u64>().write_unaligned(first);
                        let count = [0, 1, 2, 32, 40, 41, u32::MAX][usize::from(bytes.byte()) % 7];
                        place.add(8).cast::<u32>().write_unaligned(count);
                    }
                    taken[0] = if bytes.byte() < 250 { 8 * WORDS as u64 } else { 3 };
                    let before = taken;
                    let key = usize::from(bytes.byte()) % keys.len();
                    if bytes.byte() > 250 {
                        keys[key] = bytes.number();
                    }
                    let code = CALLS[call](
                        runtime,
                        &mut keys[key],
                        from_ref(&given).cast(),
                        from_mut(&mut taken).cast(),
                    );
                    assert!(code == 0 || taken == before, "a refused call wrote its outputs");
                    code
                }
                12 => {
                    bytes.fill(&mut given, size_of::<Feedback>());
                    standstill_feedback_write(runtime, i32::from(bytes.byte() % 4), from_ref(&given).cast())
                }
                13 => {
                    taken[0] = if bytes.byte() < 250 { 8 * WORDS as u64 } else { 3 };
                    let axis = i32::from(bytes.byte() % 4) - 1;
                    match bytes.byte() % 3 {
                        0 => standstill_command_read(runtime, axis, from_mut(&mut taken).cast()),
                        1 => standstill_axis_read(runtime, axis, from_mut(&mut taken).cast()),
                        _ => standstill_config_error(runtime, from_mut(&mut taken).cast()),
                    }
                }
                14 => {
                    let mut copied = 0;
                    let room = u32::from(bytes.byte() % 4);
                    standstill_log_read(runtime, &mut next, from_mut(&mut taken).cast(), 96, room, &mut copied)
                }
                _ => match bytes.byte() % 15 {
                    0 => standstill_stop(runtime),
                    1 => standstill_start(runtime),
                    2 => standstill_instance_release(runtime, &mut keys[usize::from(bytes.byte()) % 6]),
                    3 => standstill_simulate(runtime, 1, i32::from(bytes.byte() % 10), bytes.byte().into()),
                    4 => standstill_simulate_input(runtime, 1, (bytes.byte() % 40).into(), bytes.byte() % 2),
                    5 => {
                        let at = f64::from(bytes.byte()) / 250.0;
                        standstill_simulate_probe(runtime, 2, (bytes.byte() % 4).into(), at, bytes.byte() % 2)
                    }
                    6 => standstill_simulate_push(runtime, 1, f64::from_bits(bytes.number())),
                    14 => {
                        let quantity = i32::from(bytes.byte() % 4) - 1;
                        standstill_simulate_report(runtime, 1, quantity, f64::from_bits(bytes.number()))
                    }
                    7 | 8 => {
                        let config = RecorderConfig {
                            size: size_of::<RecorderConfig>() as u32,
                            scans: (bytes.byte() % 9).into(),
                            after: (bytes.byte() % 4).into(),
                            records: (bytes.byte() % 4).into(),
                            trigger: i32::from(bytes.byte() % 3),
                            reserved: 0,
                        };
                        let mut name = [0; NAME];
                        (name[0], name[1]) = (b'a' as c_char, bytes.byte() as c_char);
                        let recorded = Recorded {
                            key: keys[usize::from(bytes.byte()) % 6],
                            axis: i32::from(bytes.byte() % 4) - 1,
                            reserved: 0,
                            name,
                            unit: [bytes.byte() as c_char; UNIT],
                        };
                        let (count, size) = ((bytes.byte() % 2).into(), size_of::<Recorded>() as u32);
                        let mut needed = 0;
                        match standstill_recorder_size(runtime, &config, &recorded, size, count, &mut needed) {
                            0 => {
                                memories.push(vec![0_u128; needed.div_ceil(16)]);
                                let at = memories.last_mut().map_or(null_mut(), |memory| memory.as_mut_ptr().cast());
                                standstill_recorder_init(runtime, at, needed, &config, &recorded, size, count)
                            }
                            code => code,
                        }
                    }
                    9 => standstill_recorder_end(runtime),
                    10 => standstill_recorder_trip(runtime),
                    11 => standstill_recorder_arm(runtime),
                    12 => {
                        bytes.fill(&mut given, size_of::<Dump>());
                        let room = usize::from(bytes.byte());
                        let mut length = 0;
                        let code = standstill_recorder_read(
                            runtime,
                            from_mut(&mut given).cast(),
                            from_mut(&mut taken).cast(),
                            room,
                            &mut length,
                        );
                        assert!(length <= room);
                        code
                    }
                    _ => match standstill_runtime_close(runtime) {
                        0 => return,
                        code => code,
                    },
                },
            };
            assert!(code == -21 || (-19..=0).contains(&code), "{code}: a panic was caught, or there is no such code");
        }
    }
}

fuzz_target!(|data: &[u8]| play(&mut Bytes(data)));
