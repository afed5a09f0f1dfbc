//! The cam that the runtime makes of a table, built by the runtime's own store, 32 rows per call, as by
//! MC_CamTableSelect.

use super::table::{CamError, CamTable};
use standstill_axis::{
    Anchor, CAM_ROWS_PER_CALL, Cam, CamHead, CamLaw, CamPiece, CamSelection, CamSlot, Cams, Place, Setpoint,
};

/// Number of points of a stretch that are drawn.
const STEPS: u32 = 32;

/// A cam in its own numbers, without axes.
const AS_IT_IS: CamLaw = CamLaw {
    master_scaling: 1.0,
    slave_scaling: 1.0,
    origin: 0.0,
    master_turn: None,
    slave_turn: None,
};

/// Its properties as a whole.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Its properties as a whole.
    pub head: CamHead,
    pieces: Vec<CamPiece>,
}

impl Curve {
    /// The cam of a table.
    ///
    /// # Errors
    /// [`CamError::Table`] if its rows make no cam.
    pub fn new(table: &CamTable, periodic: bool) -> Result<Self, CamError> {
        let count = table.rows.len();
        let mut slots = [CamSlot::default()];
        let mut pieces = vec![CamPiece::default(); count.saturating_sub(1)];
        let mut cams = Cams::new(&mut slots, &mut pieces);
        let selection = CamSelection {
            periodic,
            ..CamSelection::default()
        };
        let fault = |fault| table.fault(&fault);
        let full = || CamError::Table {
            place: table.name.clone(),
            message: format!("the store has no room for {count} rows"),
            help: "leave rows out where the curve hardly bends".to_owned(),
        };
        let id = cams
            .begin(count, selection, |_| false)
            .map_err(fault)?
            .map_err(|_| full())?;
        let row = |index: usize| table.rows.get(index).copied();
        for _ in 0..=count.div_ceil(CAM_ROWS_PER_CALL) {
            if let Some(head) = cams.go_on(id, &row).map_err(fault)? {
                return Ok(Self { head, pieces });
            }
        }
        Err(full())
    }

    /// Its pieces, in order.
    #[must_use]
    pub fn pieces(&self) -> &[CamPiece] {
        &self.pieces
    }

    /// The rows, from 1, at which one of the first `order` derivatives jumps. The last row of a cam with periods is its first.
    #[must_use]
    pub fn corners(&self, order: usize) -> Vec<usize> {
        let rows = self.pieces.len() + usize::from(!self.head.periodic);
        let jumps = |row: &usize| self.cam().jumps_at(row - 1, order).is_some();
        (1..=rows).filter(jumps).collect()
    }

    fn cam(&self) -> Cam<'_> {
        Cam {
            head: &self.head,
            pieces: &self.pieces,
        }
    }

    /// The begin and the end of piece `index`, from 0 (u of the master).
    #[must_use]
    pub fn ends_of(&self, index: usize) -> (f64, f64) {
        self.cam().ends_of(u16::try_from(index).unwrap_or(u16::MAX))
    }

    /// The position of the slave for its master at `place` (u), and its derivatives by the master, as position to
    /// snap.
    #[must_use]
    pub fn at(&self, place: f64) -> [f64; 5] {
        // The first row is the origin, so no rounding occurs there.
        let master = Place {
            position: place,
            ..Place::default()
        };
        let moving = Setpoint {
            velocity: 1.0,
            ..Setpoint::default()
        };
        let at = AS_IT_IS
            .at(&self.cam(), &Anchor::default(), master, &moving, 0)
            .state;
        [at.position, at.velocity, at.acceleration, at.jerk, at.snap]
    }

    /// The whole cam, piece by piece: position of the master, of the slave, four derivatives. Where a derivative
    /// jumps, two points have the same position.
    #[must_use]
    pub fn course(&self) -> Vec<[f64; 6]> {
        let pieces = 0..self.pieces.len();
        let moments = pieces.flat_map(|index| {
            let (from, to) = self.ends_of(index);
            (0..=STEPS).map(move |step| {
                let within = match step {
                    0 => from,
                    STEPS => to.next_down(),
                    _ => from + (to - from) * (f64::from(step) / f64::from(STEPS)),
                };
                let place = if step == STEPS { to } else { within };
                let [y, first, second, third, fourth] = self.at(within);
                [place, y, first, second, third, fourth]
            })
        });
        moments.collect()
    }
}
