//! The selected cams: a fixed number of slots and pieces, in memory that the owner of the axes sets up.
//!
//! A selection copies its table. A cam that is selected again gets another slot. The old one stays until no axis is
//! on it, so a cam never changes under a moving slave.

use crate::{AxisId, IecEnum, command::iec_enum};
use standstill_planner::{Cam, CamBuild, CamFault, CamHead, CamPiece, CamRow, CamShape};

/// Default number of slots of a store.
pub const CAM_SLOTS: usize = 16;

/// Default number of pieces of a store. A cam takes one piece less than it has rows.
pub const CAM_PIECES: usize = 2048;

/// Rows of a table that are checked in one call.
pub const CAM_ROWS_PER_CALL: usize = 32;

iec_enum! {
    /// The curve of a cam from one row to the next (MC_CAM_LAW, vendor specific).
    CamCurve = "MC_CAM_LAW" {
        /// Derivatives are estimated from neighbours.
        Through = "mcCamThrough", 0;
        /// Degree 7, with all derivatives of both rows.
        Poly7 = "mcCamPoly7", 1;
        /// Degree 5, with slope and curvature of both rows.
        Poly5 = "mcCamPoly5", 2;
        /// Straight.
        Line = "mcCamLine", 3;
        /// Degree 7 from rest to rest.
        Rest7 = "mcCamRest7", 4;
        /// Degree 5 from rest to rest.
        Rest5 = "mcCamRest5", 5;
    }
}

impl CamCurve {
    /// The same law for the planner.
    pub const fn shape(self) -> CamShape {
        match self {
            Self::Through => CamShape::Through,
            Self::Poly7 => CamShape::Poly7,
            Self::Poly5 => CamShape::Poly5,
            Self::Line => CamShape::Line,
            Self::Rest7 => CamShape::Rest7,
            Self::Rest5 => CamShape::Rest5,
        }
    }
}

iec_enum! {
    /// The position at which MC_CamIn places a cam (MC_START_MODE, numbers in the standard's order). In every mode
    /// the slave gets onto the cam within its limits.
    StartMode = "MC_START_MODE" {
        /// As it was selected.
        Absolute = "mcAbsolute", 0;
        /// At the present position of the slave.
        Relative = "mcRelative", 1;
        /// As mcAbsolute.
        RampIn = "mcRampIn", 2;
    }
}

/// A selected cam (CamTableID): its slot, and the number of times the slot was used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CamId(u32);

impl CamId {
    /// No cam.
    pub const NONE: Self = Self(0);

    /// The number at a pin: 0 for none.
    pub const fn number(self) -> u32 {
        self.0
    }

    /// The cam of that number, if there is one.
    pub const fn from_number(number: u32) -> Self {
        Self(number)
    }

    fn new(slot: usize, generation: u16) -> Self {
        let slot = u32::try_from(slot).unwrap_or(u32::MAX);
        Self((u32::from(generation) << 16) | (slot.wrapping_add(1) & 0xFFFF))
    }

    fn slot(self) -> Option<usize> {
        let slot = usize::try_from(self.0 & 0xFFFF).unwrap_or_default();
        slot.checked_sub(1)
    }

    const fn generation(self) -> u16 {
        (self.0 >> 16) as u16
    }
}

/// How a table was selected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CamSelection {
    /// The axes it was checked for.
    pub master: AxisId,
    /// The slave.
    pub slave: AxisId,
    /// The cam repeats: after its last row it continues at its first.
    pub periodic: bool,
    /// Its master positions are absolute, not relative to the master's position at the start.
    pub master_absolute: bool,
    /// Its slave positions are absolute.
    pub slave_absolute: bool,
}

/// The content of a slot.
#[derive(Clone, Copy, Debug, Default)]
enum Content {
    #[default]
    Free,
    /// Rows are being checked.
    Made(CamBuild),
    /// A cam.
    Ready(CamHead),
}

/// A slot of the store.
#[derive(Clone, Copy, Debug, Default)]
pub struct CamSlot {
    content: Content,
    generation: u16,
    /// Selected again, or no longer needed: free as soon as no axis is on it.
    retired: bool,
    first: usize,
    count: usize,
    selection: CamSelection,
}

impl CamSlot {
    fn is_free(&self) -> bool {
        matches!(self.content, Content::Free)
    }
}

/// The reason why a store has no room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRoom {
    /// No slot for another cam; the store has this many.
    Slots(usize),
    /// No gap for this many pieces in a row, of this many in all.
    Pieces(usize, usize),
}

/// The store of cams, lent for a call or a motion step.
#[derive(Debug)]
pub struct Cams<'a> {
    slots: &'a mut [CamSlot],
    pieces: &'a mut [CamPiece],
}

impl Default for Cams<'_> {
    fn default() -> Self {
        Self::new(&mut [], &mut [])
    }
}

impl<'a> Cams<'a> {
    /// A store in this memory; slots beyond 65535 are not used.
    pub fn new(slots: &'a mut [CamSlot], pieces: &'a mut [CamPiece]) -> Self {
        Self { slots, pieces }
    }

    /// The same store for a shorter time.
    pub fn lend(&mut self) -> Cams<'_> {
        Cams {
            slots: self.slots,
            pieces: self.pieces,
        }
    }

    fn slot(&self, id: CamId) -> Option<&CamSlot> {
        let slot = self.slots.get(id.slot()?)?;
        (slot.generation == id.generation() && !slot.is_free()).then_some(slot)
    }

    fn slot_mut(&mut self, id: CamId) -> Option<&mut CamSlot> {
        let slot = self.slots.get_mut(id.slot()?)?;
        (slot.generation == id.generation() && !slot.is_free()).then_some(slot)
    }

    /// The cam of that number, even if it was selected again since.
    pub fn cam(&self, id: CamId) -> Option<Cam<'_>> {
        let slot = self.slot(id)?;
        let Content::Ready(head) = &slot.content else {
            return None;
        };
        let pieces = self.pieces.get(slot.first..slot.first.checked_add(slot.count)?)?;
        Some(Cam { head, pieces })
    }

    /// The selection of that number; none if the cam is not complete, or was selected again.
    pub fn selection(&self, id: CamId) -> Option<CamSelection> {
        let slot = self.slot(id).filter(|slot| !slot.retired)?;
        matches!(slot.content, Content::Ready(_)).then_some(slot.selection)
    }

    /// Its owner no longer needs it. It stays for the axes that are on it.
    pub fn retire(&mut self, id: CamId) {
        if let Some(slot) = self.slot_mut(id) {
            slot.retired = true;
        }
    }

    /// Begins a cam of `rows` rows. `is_used` returns whether an axis is on a cam, or has a waiting
    /// command for it.
    ///
    /// Cost: for each slot, a comparison with all others and a call of `is_used`.
    ///
    /// # Errors
    /// The rows make no cam ([`CamFault`] in the outer result), or there is no room ([`NoRoom`] in the
    /// inner one).
    pub fn begin(
        &mut self,
        rows: usize,
        selection: CamSelection,
        is_used: impl Fn(CamId) -> bool,
    ) -> Result<Result<CamId, NoRoom>, CamFault> {
        let build = CamBuild::new(rows, selection.periodic)?;
        let count = rows.saturating_sub(1);
        for (index, slot) in self.slots.iter_mut().enumerate() {
            if slot.retired && !slot.is_free() && !is_used(CamId::new(index, slot.generation)) {
                slot.content = Content::Free;
            }
        }
        let usable = self.slots.len().min(0xFFFF);
        let Some(free) = self.slots.iter().take(usable).position(CamSlot::is_free) else {
            return Ok(Err(NoRoom::Slots(usable)));
        };
        let Some(first) = self.gap(count) else {
            return Ok(Err(NoRoom::Pieces(count, self.pieces.len())));
        };
        let Some(slot) = self.slots.get_mut(free) else {
            return Ok(Err(NoRoom::Slots(usable)));
        };
        // Generation 0 is never used, so the number of a cam is never 0 or small.
        let generation = slot.generation.wrapping_add(1).max(1);
        *slot = CamSlot {
            content: Content::Made(build),
            generation,
            retired: false,
            first,
            count,
            selection,
        };
        Ok(Ok(CamId::new(free, generation)))
    }

    /// The first place with room for this many pieces: the beginning, or the end of a cam.
    fn gap(&self, count: usize) -> Option<usize> {
        let taken = || self.slots.iter().filter(|slot| !slot.is_free());
        let is_gap = |first: usize| {
            let end = first.saturating_add(count);
            let overlaps = |slot: &CamSlot| first < slot.first + slot.count && slot.first < end;
            end <= self.pieces.len() && !taken().any(overlaps)
        };
        let ends = taken().map(|slot| slot.first + slot.count);
        core::iter::once(0)
            .chain(ends)
            .filter(|first| is_gap(*first))
            .min()
    }

    /// Checks the next rows of a cam that was begun, at most [`CAM_ROWS_PER_CALL`]. Returns the
    /// properties of the cam once it is complete. After a fault the slot is free again.
    ///
    /// # Errors
    /// The rows make no cam.
    pub fn go_on(
        &mut self,
        id: CamId,
        row: &dyn Fn(usize) -> Option<CamRow>,
    ) -> Result<Option<CamHead>, CamFault> {
        let Some(index) = self.slot(id).and(id.slot()) else {
            return Ok(None);
        };
        let Some(slot) = self.slots.get_mut(index) else {
            return Ok(None);
        };
        let Content::Made(build) = &mut slot.content else {
            return Ok(None);
        };
        let end = slot.first.saturating_add(slot.count);
        let pieces = self.pieces.get_mut(slot.first..end).unwrap_or_default();
        // A piece belongs to the row at its end; the first call also checks the first row.
        let most = if build.is_new() {
            CAM_ROWS_PER_CALL - 1
        } else {
            CAM_ROWS_PER_CALL
        };
        match build.go_on(row, pieces, most) {
            Ok(Some(head)) => {
                slot.content = Content::Ready(head);
                Ok(Some(head))
            }
            Ok(None) => Ok(None),
            Err(fault) => {
                slot.content = Content::Free;
                Err(fault)
            }
        }
    }

    /// Frees the slot of a cam that was refused for a reason outside its rows.
    pub fn give_back(&mut self, id: CamId) {
        if let Some(slot) = self.slot_mut(id) {
            slot.content = Content::Free;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(index: usize) -> Option<CamRow> {
        Some(CamRow {
            master: index as f64,
            slave: (index & 1) as f64,
            shape: CamShape::Rest7,
            ..CamRow::default()
        })
    }

    fn select(cams: &mut Cams<'_>, rows: usize, used: &[CamId]) -> Result<CamId, NoRoom> {
        let id = cams
            .begin(rows, CamSelection::default(), |id| used.contains(&id))
            .unwrap()?;
        for _ in 0..rows.div_ceil(CAM_ROWS_PER_CALL).max(1) {
            if cams.go_on(id, &row).unwrap().is_some() {
                return Ok(id);
            }
        }
        panic!("more calls than one for each 32 rows");
    }

    /// Covers: G74
    #[test]
    fn a_cam_in_use_outlives_its_selection_and_a_stale_number_names_none() {
        let (mut slots, mut pieces) = ([CamSlot::default(); 3], [CamPiece::default(); 40]);
        let mut cams = Cams::new(&mut slots, &mut pieces);
        let first = select(&mut cams, 11, &[]).unwrap();
        cams.retire(first);
        assert!(cams.selection(first).is_none() && cams.cam(first).is_some());
        let second = select(&mut cams, 11, &[first]).unwrap();
        assert_eq!(cams.cam(first).unwrap().pieces.len(), 10);
        // No axis is on it now.
        let third = select(&mut cams, 11, &[]).unwrap();
        assert!(cams.cam(first).is_none() && cams.cam(second).is_some());
        assert_ne!(first, third);
        assert_eq!(first.slot(), third.slot());
    }

    /// Covers: G80
    #[test]
    fn a_full_store_says_what_it_lacks_and_a_gap_is_used_again() {
        let (mut slots, mut pieces) = ([CamSlot::default(); 3], [CamPiece::default(); 30]);
        let mut cams = Cams::new(&mut slots, &mut pieces);
        let ids = [11, 11, 6].map(|rows| select(&mut cams, rows, &[]).unwrap());
        assert_eq!(select(&mut cams, 2, &ids), Err(NoRoom::Slots(3)));
        cams.give_back(ids[1]);
        assert_eq!(select(&mut cams, 12, &ids), Err(NoRoom::Pieces(11, 30)));
        let between = select(&mut cams, 11, &ids).unwrap();
        assert_eq!(between.slot(), ids[1].slot());
        assert_ne!(between, ids[1]);
        for id in [ids[0], ids[2], between] {
            let cam = cams.cam(id).unwrap();
            assert_eq!(cam.head.begin, 0.0);
            assert_eq!(cam.head.end, cam.pieces.len() as f64);
        }
    }

    /// A table with the most rows causes no peak in a scan, for any law: the rows checked and the pieces
    /// made per call are bounded.
    ///
    /// Covers: G79
    #[test]
    fn a_long_table_is_looked_at_in_calls_of_the_same_work() {
        let shapes = [
            (CamShape::Rest7, 213),
            (CamShape::Poly7, 213),
            (CamShape::Poly5, 213),
            (CamShape::Line, 213),
            (CamShape::Through, 3604),
        ];
        for (shape, most) in shapes {
            let (mut slots, mut pieces) = ([CamSlot::default(); 1], [CamPiece::default(); 511]);
            let mut cams = Cams::new(&mut slots, &mut pieces);
            let selection = CamSelection {
                periodic: true,
                ..CamSelection::default()
            };
            let id = cams.begin(512, selection, |_| false).unwrap().unwrap();
            let looks = core::cell::Cell::new(0);
            let row = |index: usize| {
                looks.set(looks.get() + 1);
                let slave = if index == 511 { 0 } else { index & 3 };
                Some(CamRow {
                    master: index as f64,
                    slave: slave as f64,
                    shape,
                    ..CamRow::default()
                })
            };
            let mut calls = std::vec::Vec::new();
            let is_made = |cams: &Cams<'_>| {
                let made = cams
                    .pieces
                    .iter()
                    .filter(|piece| piece.bounds() != CamPiece::default().bounds());
                made.count()
            };
            loop {
                let (before, made) = (looks.get(), is_made(&cams));
                let found = cams.go_on(id, &row).unwrap();
                assert!(is_made(&cams) - made <= CAM_ROWS_PER_CALL);
                calls.push(looks.get() - before);
                if found.is_some() {
                    break;
                }
            }
            assert_eq!(calls.len(), 16, "{shape:?}");
            let largest = calls.iter().max().copied().unwrap_or_default();
            assert!(largest <= most, "{shape:?}: {calls:?}");
        }
    }

    #[test]
    fn rows_that_make_no_cam_leave_the_slot_free() {
        let (mut slots, mut pieces) = ([CamSlot::default(); 1], [CamPiece::default(); 60]);
        let mut cams = Cams::new(&mut slots, &mut pieces);
        let begun = cams
            .begin(50, CamSelection::default(), |_| true)
            .unwrap()
            .unwrap();
        assert!(cams.cam(begun).is_none());
        let falls_back = |index: usize| row(if index == 40 { 3 } else { index });
        assert_eq!(cams.go_on(begun, &falls_back), Ok(None));
        assert!(cams.go_on(begun, &falls_back).is_err());
        assert!(select(&mut cams, 50, &[]).is_ok());
        assert!(cams.begin(1, CamSelection::default(), |_| true).is_err());
    }
}
