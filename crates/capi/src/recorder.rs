//! The flight recorder: the last scans of a runtime, in memory of its host, and their text.

use crate::runtime::{NOBODY, Slot};
use crate::storage::{ALIGN, List};
use crate::{Code, NAME, Recorded, RecorderConfig, RecorderStatus, UNIT};
use core::alloc::Layout;
use core::ffi::c_char;
use core::fmt::{self, Write};
use core::str;
use standstill_axis::{self as axis, Axis, AxisConfig, AxisState, Log};
use standstill_fb::{AnyInstance, BlockInfo, axis_number};
use standstill_record::text::{Called, Form, line};
use standstill_record::{AXIS_WORDS, Ring, Setup, State, Trigger};

/// The largest number of scans and of records of a recorder.
const MOST: u32 = 1 << 24;

/// A text of at most `N` bytes.
#[derive(Clone, Copy)]
struct Text<const N: usize> {
    bytes: [u8; N],
    len: usize,
}

impl<const N: usize> Text<N> {
    const EMPTY: Self = Self {
        bytes: [0; N],
        len: 0,
    };

    /// A name from C, which ends in 0 within its room. None if it does not, or is not UTF-8.
    fn of(name: &[c_char; N]) -> Option<Self> {
        let bytes = name.map(|byte| byte as u8);
        let len = bytes.iter().position(|byte| *byte == 0)?;
        str::from_utf8(bytes.get(..len)?).ok()?;
        Some(Self { bytes, len })
    }

    fn get(&self) -> &str {
        let bytes = self.bytes.get(..self.len).unwrap_or_default();
        str::from_utf8(bytes).unwrap_or_default()
    }

    /// Whether it is an IEC identifier, as names of trace columns must be.
    fn is_name(&self) -> bool {
        let mut bytes = self.get().bytes();
        let starts = bytes
            .next()
            .is_some_and(|byte| byte.is_ascii_alphabetic() || byte == b'_');
        starts && bytes.all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
    }

    /// Whether a JSON text can hold it without escapes.
    fn is_plain(&self) -> bool {
        self.get()
            .chars()
            .all(|letter| !letter.is_control() && letter != '"' && letter != '\\')
    }
}

impl<const N: usize> Write for Text<N> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            // The last byte stays 0.
            let place = self
                .bytes
                .get_mut(self.len)
                .filter(|_| self.len + 1 < N)
                .ok_or(fmt::Error)?;
            *place = byte;
            self.len += 1;
        }
        Ok(())
    }
}

/// The name of an axis.
struct AxisName {
    name: Text<NAME>,
    unit: Text<UNIT>,
}

/// An instance that is recorded.
struct Recording {
    name: Text<NAME>,
    key: u64,
    block: &'static BlockInfo,
}

/// A recorder in its storage.
pub(crate) struct Recorder {
    ring: Ring,
    width: usize,
    names: List<AxisName>,
    instances: List<Recording>,
    states: List<AxisState>,
    words: List<u64>,
    records: List<Option<axis::Record>>,
}

/// The places of all parts in the storage.
struct Plan {
    whole: Layout,
    names: usize,
    instances: usize,
    states: usize,
    words: usize,
    records: usize,
    width: usize,
}

/// The checked settings of a recorder.
pub(crate) struct Order<'a> {
    pub config: RecorderConfig,
    pub axes: &'a [Axis],
    pub slots: &'a [Slot],
}

impl Order<'_> {
    fn setup(&self) -> Result<Setup, Code> {
        let RecorderConfig {
            scans,
            after,
            records,
            trigger,
            reserved,
            ..
        } = self.config;
        let fits = (1..=MOST).contains(&scans) && after < scans && records <= MOST && reserved == 0;
        let trigger = match trigger {
            0 => Trigger::ErrorStop,
            1 => Trigger::Host,
            _ => return Err(Code::BadValue),
        };
        if !fits {
            return Err(Code::BadValue);
        }
        Ok(Setup {
            scans: scans as usize,
            after: after as usize,
            records: records as usize,
            trigger,
        })
    }

    /// The block of the instance with this key.
    fn block(&self, key: u64) -> Result<&'static BlockInfo, Code> {
        instance(self.slots, key)
            .map(AnyInstance::info)
            .ok_or(Code::UnknownKey)
    }

    fn plan(&self, given: impl Iterator<Item = Recorded>) -> Result<Plan, Code> {
        let setup = self.setup()?;
        let (mut width, mut instances) = (self.axes.len() * AXIS_WORDS, 0);
        for recorded in given {
            if recorded.axis == 0 {
                width += self.block(recorded.key)?.pins().count();
                instances += 1;
            }
        }
        fn behind<T>(before: Layout, count: usize) -> Result<(Layout, usize), Code> {
            let list = Layout::array::<T>(count).map_err(|_| Code::BadValue)?;
            before.extend(list).map_err(|_| Code::BadValue)
        }
        let words = width.checked_mul(setup.scans).ok_or(Code::BadValue)?;
        let (whole, names) = behind::<AxisName>(Layout::new::<Recorder>(), self.axes.len())?;
        let (whole, instances) = behind::<Recording>(whole, instances)?;
        let (whole, states) = behind::<AxisState>(whole, self.axes.len())?;
        let (whole, words) = behind::<u64>(whole, words)?;
        let (whole, records) = behind::<Option<axis::Record>>(whole, setup.records)?;
        Ok(Plan {
            whole: whole.pad_to_align(),
            names,
            instances,
            states,
            words,
            records,
            width,
        })
    }

    /// Bytes that a recorder of these signals needs.
    pub fn size(&self, given: impl Iterator<Item = Recorded>) -> Result<usize, Code> {
        Ok(self.plan(given)?.whole.size())
    }

    /// Makes the recorder in its storage, and returns it as a list.
    ///
    /// # Safety
    /// `storage` is not null, `bytes` bytes can be read and written there, and nothing but the recorder
    /// uses them while it exists.
    pub unsafe fn make(
        &self,
        given: impl Iterator<Item = Recorded> + Clone,
        storage: *mut u8,
        bytes: usize,
    ) -> Result<List<Recorder>, Code> {
        let plan = self.plan(given.clone())?;
        if plan.whole.size() > bytes || !storage.addr().is_multiple_of(ALIGN) {
            return Err(Code::Storage);
        }
        let ring = Ring::new(self.setup()?);
        let scans = ring.setup().scans;
        let count = given.clone().filter(|recorded| recorded.axis == 0).count();
        // SAFETY: the plan's places lie inside the storage, disjoint, each aligned for its type relative to a start
        // that is aligned to at least the largest alignment; nothing else uses the storage.
        let mut recorder = unsafe {
            Recorder {
                ring,
                width: plan.width,
                names: List::new(storage.add(plan.names).cast(), self.axes.len()),
                instances: List::new(storage.add(plan.instances).cast(), count),
                states: List::new(storage.add(plan.states).cast(), self.axes.len()),
                words: List::new(storage.add(plan.words).cast(), plan.width * scans),
                records: List::new(storage.add(plan.records).cast(), ring.setup().records),
            }
        };
        for axis in self.axes {
            let mut name = Text::EMPTY;
            // It has room for any number.
            write!(name, "axis{}", axis_number(axis.id())).map_err(|_| Code::BadValue)?;
            recorder.names.push(AxisName {
                name,
                unit: Text::EMPTY,
            });
            recorder.states.push(AxisState::Disabled);
        }
        for (state, axis) in recorder.states.slice_mut().iter_mut().zip(self.axes) {
            *state = axis.state();
        }
        for recorded in given {
            recorder.call(&recorded, self)?;
        }
        recorder.check_names()?;
        for _ in 0..plan.width * scans {
            recorder.words.push(0);
        }
        for _ in 0..ring.setup().records {
            recorder.records.push(None);
        }
        // SAFETY: the head is at the start of the storage. The plan made it long and aligned enough.
        let mut head = unsafe { List::new(storage.cast(), 1) };
        head.push(recorder);
        Ok(head)
    }
}

// The host is given only one alignment.
const _: () = assert!(align_of::<Recorder>() <= ALIGN && align_of::<Option<axis::Record>>() <= ALIGN);

/// The instance with this key.
fn instance(slots: &[Slot], key: u64) -> Option<&dyn AnyInstance> {
    let slot = slots.get((key as u32 as usize).wrapping_sub(1))?;
    let block = slot
        .block
        .as_ref()
        .filter(|_| slot.generation == (key >> 32) as u32)?;
    Some(block)
}

impl Recorder {
    /// Takes the host's name for an axis or an instance.
    fn call(&mut self, recorded: &Recorded, order: &Order<'_>) -> Result<(), Code> {
        let name = Text::of(&recorded.name)
            .filter(Text::is_name)
            .ok_or(Code::BadValue)?;
        let unit = Text::of(&recorded.unit)
            .filter(Text::is_plain)
            .ok_or(Code::BadValue)?;
        if recorded.axis == 0 {
            self.instances.push(Recording {
                name,
                key: recorded.key,
                block: order.block(recorded.key)?,
            });
            return Ok(());
        }
        let place = usize::try_from(recorded.axis).map_or(usize::MAX, |number| number.wrapping_sub(1));
        let axis = self.names.slice_mut().get_mut(place).ok_or(Code::UnknownAxis)?;
        *axis = AxisName { name, unit };
        Ok(())
    }

    /// Checks that no two have the same name, because columns are found by name. Cost: the square of
    /// their number.
    fn check_names(&self) -> Result<(), Code> {
        let all = || {
            let axes = self.names.slice().iter().map(|axis| &axis.name);
            axes.chain(self.instances.slice().iter().map(|instance| &instance.name))
        };
        for (place, name) in all().enumerate() {
            if all()
                .skip(place + 1)
                .any(|other| other.get().eq_ignore_ascii_case(name.get()))
            {
                return Err(Code::BadValue);
            }
        }
        Ok(())
    }

    /// Called after all blocks and before the motion step.
    pub fn observe(&mut self, axes: &[Axis]) {
        self.ring.observe(self.states.slice_mut(), axes);
    }

    /// Ends a tick.
    pub fn record(&mut self, scan: u64, axes: &[Axis], slots: &[Slot], log: &Log) {
        let (instances, records) = (self.instances.slice(), self.records.slice_mut());
        let pins = |mut rest: &mut [u64]| {
            for recording in instances {
                let count = recording.block.pins().count();
                let Some((words, others)) = rest.split_at_mut_checked(count) else {
                    return;
                };
                match instance(slots, recording.key) {
                    Some(instance) => instance.put_words(words),
                    // It was released.
                    None => words.fill(0),
                }
                rest = others;
            }
        };
        let keep = |place: usize, record: &axis::Record| {
            if let Some(slot) = records.get_mut(place) {
                *slot = Some(*record);
            }
        };
        let (states, words) = (self.states.slice(), self.words.slice_mut());
        self.ring.record(scan, (axes, states), log, words, pins, keep);
    }

    /// Trips for a reason of the host's own.
    pub fn trip(&mut self) {
        self.ring.trip(None);
    }

    /// Forgets everything.
    pub fn arm(&mut self) {
        self.ring.arm();
    }

    pub fn status(&self) -> RecorderStatus {
        let (first, scans) = self.ring.scans();
        let (tripped_at, axis) = self.ring.tripped().unwrap_or_default();
        RecorderStatus {
            size: size_of::<RecorderStatus>() as u32,
            state: match self.ring.state() {
                State::Armed => 0,
                State::Tripped { .. } => 1,
                State::Frozen => 2,
            },
            first,
            scans: scans as u64,
            tripped_at,
            axis: axis.map_or(0, |place| place as i32 + 1),
            left: match self.ring.state() {
                State::Tripped { left } => left as u32,
                _ => 0,
            },
        }
    }

    /// A number that changes with what a dump would hold.
    pub fn stamp(&self) -> u64 {
        self.ring.stamp()
    }

    /// Fills `room` with the text of a form from line `line` on, without its first `skip` bytes. Returns
    /// the line and the bytes to continue with, and the number of bytes written.
    pub fn read(
        &self,
        axes: &[Axis],
        form: Form,
        cycle_ns: i64,
        mut at: (u64, u64),
        room: &mut [u8],
    ) -> (u64, u64, usize) {
        let told = Told { recorder: self, axes };
        let lines = form.lines(&told);
        let mut len = 0;
        while at.0 < lines {
            let mut window = Window {
                skip: at.1,
                room: room.get_mut(len..).unwrap_or_default(),
                len: 0,
            };
            let cycle_ns = cycle_ns.unsigned_abs();
            let whole = line(&mut window, form, at.0, &told, "flight recorder", cycle_ns).is_ok();
            len += window.len;
            if !whole {
                return (at.0, at.1 + window.len as u64, len);
            }
            at = (at.0 + 1, 0);
        }
        (at.0, at.1, len)
    }
}

/// A part of a text: `skip` bytes are left out, then as many bytes follow as there is room for.
struct Window<'a> {
    skip: u64,
    room: &'a mut [u8],
    len: usize,
}

impl Write for Window<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let skipped = self.skip.min(text.len() as u64);
        self.skip -= skipped;
        let bytes = text.as_bytes().get(skipped as usize..).unwrap_or_default();
        for byte in bytes {
            let place = self.room.get_mut(self.len).ok_or(fmt::Error)?;
            *place = *byte;
            self.len += 1;
        }
        Ok(())
    }
}

/// A recorder and the axes it belongs to.
struct Told<'a> {
    recorder: &'a Recorder,
    axes: &'a [Axis],
}

impl Called for Told<'_> {
    fn axis(&self, place: usize) -> &str {
        self.recorder
            .names
            .slice()
            .get(place)
            .map_or("", |axis| axis.name.get())
    }

    fn instance(&self, number: u16) -> Option<&str> {
        if number == NOBODY.0 {
            return None;
        }
        let instances = self.recorder.instances.slice();
        let found = instances.iter().find(|instance| instance.key as u16 == number)?;
        Some(found.name.get())
    }
}

impl standstill_record::text::Recorded for Told<'_> {
    fn ring(&self) -> &Ring {
        &self.recorder.ring
    }

    fn axis_setup(&self, place: usize) -> Option<(&str, &AxisConfig)> {
        let named = self.recorder.names.slice().get(place)?;
        Some((named.unit.get(), self.axes.get(place)?.config()))
    }

    fn instance_setup(&self, place: usize) -> Option<(&str, &'static BlockInfo)> {
        let found = self.recorder.instances.slice().get(place)?;
        Some((found.name.get(), found.block))
    }

    fn row(&self, place: usize) -> &[u64] {
        let first = place * self.recorder.width;
        let row = self
            .recorder
            .words
            .slice()
            .get(first..first + self.recorder.width);
        row.unwrap_or_default()
    }

    fn record(&self, place: usize) -> Option<&axis::Record> {
        self.recorder.records.slice().get(place)?.as_ref()
    }
}
