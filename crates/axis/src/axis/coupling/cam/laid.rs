//! How the cam of an axis lies, for who draws it.

use super::Axis;
use crate::CamId;
use standstill_planner::{Anchor, Cam, CamLaw, Place, Planner, Setpoint};

/// A cam as it lies between a slave and its master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamLaid {
    /// The cam.
    pub cam: CamId,
    law: CamLaw,
    anchor: Anchor,
}

impl CamLaid {
    /// The turn that `master` is in now, for [`CamLaid::begin`].
    pub fn turn_of<P: Planner>(&self, master: &Axis<P>) -> i64 {
        master.place().turns
    }

    /// Place of the master at the first row (u of the master), counted on from its turn of this number.
    pub fn begin(&self, cam: &Cam<'_>, turn: i64) -> f64 {
        let from = self.first_row(cam);
        let turns = from.turns.wrapping_sub(turn);
        from.position + self.law.master_turn.unwrap_or_default() * turns as f64
    }

    /// Way of the master from the first row to the last (u of the master); below 0 if it goes back for that.
    pub fn length(&self, cam: &Cam<'_>) -> f64 {
        (cam.head.end - cam.head.begin) * self.law.master_scaling
    }

    /// Place of the slave (u) at this part of the way from the first row, 0, to the last, 1; turns are not taken off.
    pub fn slave_at(&self, cam: &Cam<'_>, part: f64) -> f64 {
        let from = self.first_row(cam);
        let place = Place {
            position: from.position + part * self.length(cam),
            ..from
        };
        let law = CamLaw {
            slave_turn: None,
            ..self.law
        };
        law.at(cam, &self.anchor, place, &Setpoint::default(), 0)
            .place
            .position
    }

    fn first_row(&self, cam: &Cam<'_>) -> Place {
        let anchor = self.anchor.master;
        Place {
            turns: anchor.turns,
            position: anchor.position
                + anchor.phase
                + (cam.head.begin - self.law.origin) * self.law.master_scaling,
            phase: 0.0,
        }
    }
}

impl<P: Planner> Axis<P> {
    /// The cam that the owner is on, once it lies somewhere.
    pub fn cam_laid(&self) -> Option<CamLaid> {
        let on_cam = self.follower.on_cam.as_ref()?;
        Some(CamLaid {
            cam: on_cam.camming.cam,
            law: on_cam.camming.law,
            anchor: on_cam.anchor?,
        })
    }
}
