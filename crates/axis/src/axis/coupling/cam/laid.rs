//! The place of an axis's cam, for drawing.

use super::Axis;
use crate::CamId;
use standstill_planner::{Anchor, Cam, CamLaw, Place, Planner, Setpoint};

/// A cam at its place between a slave and its master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamLaid {
    /// The cam.
    pub cam: CamId,
    law: CamLaw,
    anchor: Anchor,
}

impl CamLaid {
    /// The present turn of `master`, for [`CamLaid::begin`].
    pub fn turn_of<P: Planner>(&self, master: &Axis<P>) -> i64 {
        master.place().turns
    }

    /// Place of the master at the first row (u of the master), counted from the turn with this number.
    pub fn begin(&self, cam: &Cam<'_>, turn: i64) -> f64 {
        let from = self.first_row(cam);
        let turns = from.turns.wrapping_sub(turn);
        from.position + self.law.master_turn.unwrap_or_default() * turns as f64
    }

    /// Distance of the master from the first row to the last (u of the master); negative if the master moves back.
    pub fn length(&self, cam: &Cam<'_>) -> f64 {
        (cam.head.end - cam.head.begin) * self.law.master_scaling
    }

    /// Place of the slave (u) at this part of the distance from the first row (0) to the last (1); not reduced to one
    /// turn.
    pub fn slave_at(&self, cam: &Cam<'_>, part: f64) -> f64 {
        let from = self.first_row(cam);
        let place = from.moved_to(from.position + part * self.length(cam));
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
    /// The cam of the owner, once it has a place.
    pub fn cam_laid(&self) -> Option<CamLaid> {
        let on_cam = self.on_cam()?;
        Some(CamLaid {
            cam: on_cam.camming.cam,
            law: on_cam.camming.law,
            anchor: on_cam.anchor?,
        })
    }
}
