//! Cyclic synchronous torque, mode 10: the controller's side.

use super::node::{Inputs, MODE_CSP, MODE_CST};
use crate::nearest;
use standstill_axis::{TorqueOrder, TorqueReport};

/// The profile has torque in thousandths of the rated torque.
const THOUSAND: f64 = 1000.0;

/// Converts torque and velocity between an axis and a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueScale {
    /// 6076h, the rated torque, in the unit of the program; above 0.
    pub rated: f64,
    /// Increments per unit of the axis; negative if the node counts the other way. Not 0.
    pub increments: f64,
    /// Keeps the velocity bounds of a torque (torque s/u, above 0): the torque for each unit per second between
    /// velocity and bound. For a motor of inertia J in scans of T it is at most J/(2T); J/(4T) stays within the
    /// bound without oscillation.
    pub gain: f64,
}

/// The controller's side. A torque is sent once mode 10 is acknowledged (CI-7). The way back ends once mode 8 is
/// acknowledged.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Link {
    scale: Option<TorqueScale>,
    order: Option<TorqueOrder>,
    /// Mode 10 has been asked for, and mode 8 is not in force again yet.
    leads: bool,
    /// The torque last sent differs from the one ordered.
    limited: bool,
}

impl Link {
    pub fn set_scale(&mut self, scale: TorqueScale) {
        self.scale = Some(scale);
    }

    pub fn order(&mut self, order: Option<TorqueOrder>) {
        self.order = order.filter(|_| self.scale.is_some());
        self.leads |= self.order.is_some();
    }

    pub fn take(&mut self, inputs: &Inputs) {
        self.leads &= self.order.is_some() || inputs.mode != MODE_CSP;
    }

    /// Whether the drive may be in a mode other than 8 because of this request.
    pub fn leads(&self) -> bool {
        self.leads
    }

    /// Mode 10 is requested.
    pub fn is_wanted(&self) -> bool {
        self.order.is_some()
    }

    /// Mode 8 is requested, and mode 10 may still be in force.
    pub fn is_on_way_back(&self) -> bool {
        self.leads && self.order.is_none()
    }

    /// 6071h (thousandths of the rated torque); 0 if the node holds no torque. Between the velocity
    /// bounds it is the torque ordered. It falls as the velocity comes near a bound, and reverses beyond
    /// it.
    pub fn give(&mut self, inputs: &Inputs, most: u16) -> i16 {
        let (Some(scale), Some(order)) = (&self.scale, &self.order) else {
            self.limited = false;
            return 0;
        };
        if inputs.mode != MODE_CST {
            self.limited = true;
            return 0;
        }
        let velocity = f64::from(inputs.velocity) / scale.increments;
        let (least, largest) = order.velocity;
        let bound = scale.most(most);
        let within = order
            .torque
            .min(scale.gain * (largest - velocity))
            .max(scale.gain * (least - velocity))
            .max(-bound)
            .min(bound);
        self.limited = within != order.torque;
        // Within 6072h, a u16. Values beyond an i16 cannot be sent.
        let sent = nearest(scale.sign() * within * (THOUSAND / scale.rated));
        sent.clamp(-i64::from(i16::MAX), i64::from(i16::MAX)) as i16
    }

    /// The report for the axis. `most` is 6072h, 0 for a node that holds no torque.
    pub fn report(&self, inputs: &Inputs, most: u16) -> Option<TorqueReport> {
        self.scale.as_ref().map(|scale| TorqueReport {
            actual: scale.sign() * f64::from(inputs.torque) * (scale.rated / THOUSAND),
            most: scale.most(most),
            limited: self.limited,
        })
    }
}

impl TorqueScale {
    fn sign(&self) -> f64 {
        1.0_f64.copysign(self.increments)
    }

    /// 6072h in the unit of the program.
    fn most(&self, thousandths: u16) -> f64 {
        f64::from(thousandths) * (self.rated / THOUSAND)
    }
}
