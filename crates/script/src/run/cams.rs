//! The positions of the cams that axes are on, for the header of the trace, so that pictures can draw the table's
//! curve.

use super::bench::ScriptMachine;
use crate::model::Script;
use standstill_axis::CamLaid;
use standstill_trace::{Cam, Trace};

/// A curve is written at its first master position and at this number of further ones.
const STEPS: u16 = 128;

/// The known state after the last row, for each axis of the script.
pub(super) struct Cams {
    /// The position of its cam, and its index in the header.
    known: Vec<Option<(CamLaid, Option<usize>)>>,
}

impl Cams {
    pub(super) fn new(script: &Script) -> Self {
        let on_cam = script.axes.iter().rposition(|axis| axis.on_cam);
        Self {
            known: vec![None; on_cam.map_or(0, |last| last + 1)],
        }
    }

    /// Writes the cams as they are after the last row. Cost: an unchanged one is only compared.
    pub(super) fn look(&mut self, machine: &mut ScriptMachine, trace: &mut Trace) {
        let Some(scan) = trace.scans().checked_sub(1) else {
            return;
        };
        for (slave, known) in self.known.iter_mut().enumerate() {
            let laid = machine.axes().get(slave).and_then(|axis| axis.cam_laid());
            *known = laid.map(|laid| match known {
                Some((before, place)) if *before == laid => (laid, *place),
                _ => {
                    let cam = told(machine, slave, laid, scan);
                    (laid, cam.and_then(|cam| trace.push_cam(cam)))
                }
            });
            if let Some((_, Some(place))) = known {
                trace.cam_lay_until(*place, scan);
            }
        }
    }
}

/// The cam of an axis at its position in this scan, in numbers; none if one of them is too large to draw.
fn told(machine: &mut ScriptMachine, slave: usize, laid: CamLaid, scan: usize) -> Option<Cam> {
    let master = machine.axes().get(slave)?.coupled()?.master.index();
    // The store is borrowed as a whole, so the values of the master are read first.
    let from = laid.turn_of(machine.axes().get(master)?);
    let cams = machine.cams();
    let cam = cams.cam(laid.cam)?;
    let first = laid.slave_at(&cam, 0.0);
    let points: Vec<f64> = (0..=STEPS)
        .map(|step| rounded(laid.slave_at(&cam, f64::from(step) / f64::from(STEPS)) - first))
        .collect();
    let told = Cam {
        slave,
        master,
        scans: [scan; 2],
        begin: laid.begin(&cam, from),
        length: laid.length(&cam),
        periodic: cam.head.periodic,
        from: first,
        points,
    };
    let are_finite = told.points.iter().all(|point| point.is_finite());
    (are_finite && told.begin.is_finite() && told.length.is_finite() && first.is_finite()).then_some(told)
}

/// The number rounded to a 32-bit float: enough to draw, and short as text.
fn rounded(place: f64) -> f64 {
    (place as f32).to_string().parse().unwrap_or(place)
}
