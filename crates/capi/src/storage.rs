//! The memory of a runtime: one block from the host, divided into a head and five lists.

use crate::drive::AnyDrive;
use crate::runtime::{AXES, CAM_PIECES, CAM_SLOTS, HISTORY, INSTANCES, Inner, MAGIC, Runtime, Slot};
use crate::{Code, RuntimeConfig};
use core::alloc::Layout;
use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU32, AtomicUsize};
use core::{ptr, slice};
use standstill_axis::{Axis, CamPiece, CamSlot, Cams, DriveFeedback, Setpoint};

/// The alignment that storage must have.
pub(crate) const ALIGN: usize = 16;

/// A list of fixed capacity in the storage.
pub(crate) struct List<T> {
    /// Room for `capacity` values; the first `len` are valid.
    at: *mut T,
    len: usize,
    capacity: usize,
}

impl<T> List<T> {
    /// An empty list.
    ///
    /// # Safety
    /// `at` is aligned for `T`, has room for `capacity` of them, and nothing else uses it while the list lives.
    pub unsafe fn new(at: *mut T, capacity: usize) -> Self {
        Self { at, len: 0, capacity }
    }

    /// A list without capacity.
    pub const fn none() -> Self {
        Self {
            at: ptr::dangling_mut(),
            len: 0,
            capacity: 0,
        }
    }

    pub fn len(&self) -> usize {
        self.len
    }

    pub fn is_full(&self) -> bool {
        self.len >= self.capacity
    }

    /// Adds a value if there is room.
    pub fn push(&mut self, value: T) {
        if !self.is_full() {
            // SAFETY: `len` is below the capacity, so the place is inside the room that `new` was
            // promised. The place was never written, so nothing needs dropping.
            unsafe { self.at.add(self.len).write(value) };
            self.len += 1;
        }
    }

    #[inline]
    pub fn slice(&self) -> &[T] {
        // SAFETY: `len` values were written by `push`, and only this list gives access to them.
        unsafe { slice::from_raw_parts(self.at, self.len) }
    }

    #[inline]
    pub fn slice_mut(&mut self) -> &mut [T] {
        // SAFETY: as for `slice`, and `self` is borrowed exclusively.
        unsafe { slice::from_raw_parts_mut(self.at, self.len) }
    }
}

/// Adds memory behind the existing layout. Returns the new layout and where the memory begins.
fn behind<T>(before: Layout, count: u32) -> Result<(Layout, usize), Code> {
    let list = Layout::array::<T>(count as usize).map_err(|_| Code::NoRoom)?;
    before.extend(list).map_err(|_| Code::NoRoom)
}

/// The store of cams, in storage of its own.
pub(crate) struct CamStore {
    slots: List<CamSlot>,
    pieces: List<CamPiece>,
}

impl CamStore {
    /// A store without room for a cam.
    pub const fn none() -> Self {
        Self {
            slots: List::none(),
            pieces: List::none(),
        }
    }

    pub fn is_there(&self) -> bool {
        self.slots.len() > 0
    }

    /// The cams, for a call or a motion step.
    pub fn lend(&mut self) -> Cams<'_> {
        Cams::new(self.slots.slice_mut(), self.pieces.slice_mut())
    }

    fn layout(slots: u32, pieces: u32) -> Result<(Layout, usize), Code> {
        if !((1..=CAM_SLOTS).contains(&slots) && (1..=CAM_PIECES).contains(&pieces)) {
            return Err(Code::BadValue);
        }
        let slots = Layout::array::<CamSlot>(slots as usize).map_err(|_| Code::NoRoom)?;
        let (whole, pieces) = behind::<CamPiece>(slots, pieces)?;
        Ok((whole.pad_to_align(), pieces))
    }

    /// Bytes that a store of this many slots and pieces needs.
    pub fn size(slots: u32, pieces: u32) -> Result<usize, Code> {
        Ok(Self::layout(slots, pieces)?.0.size())
    }

    /// Makes the store in its storage.
    ///
    /// # Safety
    /// `storage` is not null, `bytes` bytes can be read and written there, and nothing but the store uses
    /// them while it exists.
    pub unsafe fn make(slots: u32, pieces: u32, storage: *mut u8, bytes: usize) -> Result<Self, Code> {
        let (whole, place) = Self::layout(slots, pieces)?;
        if whole.size() > bytes || !storage.addr().is_multiple_of(ALIGN) {
            return Err(Code::Storage);
        }
        // SAFETY: both places lie inside the storage, are disjoint, and are aligned for their types.
        // Nothing else uses the storage.
        let mut store = unsafe {
            Self {
                slots: List::new(storage.cast(), slots as usize),
                pieces: List::new(storage.add(place).cast(), pieces as usize),
            }
        };
        for _ in 0..slots {
            store.slots.push(CamSlot::default());
        }
        for _ in 0..pieces {
            store.pieces.push(CamPiece::default());
        }
        Ok(store)
    }
}

/// The offsets of all parts in the storage.
struct Plan {
    whole: Layout,
    axes: usize,
    drives: usize,
    feedback: usize,
    slots: usize,
    history: usize,
}

impl Plan {
    fn new(config: &RuntimeConfig) -> Result<Self, Code> {
        let fits = (1..=AXES).contains(&config.axes)
            && config.instances <= INSTANCES
            && config.cycle_ns > 0
            && config.history <= HISTORY;
        if !fits {
            return Err(Code::BadValue);
        }
        let (whole, axes) = behind::<Axis>(Layout::new::<Runtime>(), config.axes)?;
        let (whole, drives) = behind::<AnyDrive>(whole, config.axes)?;
        let (whole, feedback) = behind::<DriveFeedback>(whole, config.axes)?;
        let (whole, slots) = behind::<Slot>(whole, config.instances)?;
        let (whole, history) = behind::<Setpoint>(whole, config.history)?;
        Ok(Self {
            whole: whole.pad_to_align(),
            axes,
            drives,
            feedback,
            slots,
            history,
        })
    }
}

// The host is given one alignment for all configurations.
const _: () = assert!(align_of::<Runtime>() <= ALIGN && align_of::<Axis>() <= ALIGN);
const _: () = assert!(align_of::<AnyDrive>() <= ALIGN && align_of::<Slot>() <= ALIGN);
const _: () = assert!(align_of::<CamSlot>() <= ALIGN && align_of::<CamPiece>() <= ALIGN);

/// Bytes a runtime of this configuration needs.
pub(crate) fn size(config: &RuntimeConfig) -> Result<usize, Code> {
    Ok(Plan::new(config)?.whole.size())
}

/// Makes a runtime in the storage.
///
/// # Safety
/// `storage` is not null, `bytes` bytes can be read and written there, and only the runtime uses them until it is
/// closed.
pub(crate) unsafe fn init(
    storage: *mut u8,
    bytes: usize,
    config: &RuntimeConfig,
) -> Result<*mut Runtime, Code> {
    let plan = Plan::new(config)?;
    if plan.whole.size() > bytes || !storage.addr().is_multiple_of(ALIGN) {
        return Err(Code::Storage);
    }
    let (axes, instances) = (config.axes as usize, config.instances as usize);
    // SAFETY: the plan's places lie inside the storage, disjoint, each aligned for its type relative to a start that is
    // aligned to at least the largest alignment; nothing else uses the storage.
    let (axes, drives, feedback, mut slots, mut history) = unsafe {
        (
            List::new(storage.add(plan.axes).cast(), axes),
            List::new(storage.add(plan.drives).cast(), axes),
            List::new(storage.add(plan.feedback).cast(), axes),
            List::new(storage.add(plan.slots).cast(), instances),
            List::new(storage.add(plan.history).cast(), config.history as usize),
        )
    };
    for _ in 0..config.history {
        history.push(Setpoint::default());
    }
    for _ in 0..instances {
        slots.push(Slot {
            generation: 1,
            block: None,
        });
    }
    let runtime: *mut Runtime = storage.cast();
    // SAFETY: the head is at the start of the storage, long and aligned enough for it by the plan.
    unsafe {
        ptr::write(
            runtime,
            Runtime {
                magic: AtomicU32::new(MAGIC),
                owner: AtomicUsize::new(0),
                #[cfg(not(feature = "std"))]
                busy: core::sync::atomic::AtomicBool::new(false),
                inner: UnsafeCell::new(Inner::new(
                    axes,
                    drives,
                    feedback,
                    slots,
                    history,
                    config.cycle_ns,
                )),
            },
        );
    }
    Ok(runtime)
}
