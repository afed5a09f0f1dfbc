//! The homing of an axis.

use super::json::Node;
use super::value::Fields;
use super::{Reader, shape};
use standstill_axis::{BlockDetection, HomeDirection, Homing, Procedure, SwitchEdge};

pub(crate) const PROCEDURES: [(&str, Procedure); Procedure::ALL.len()] = {
    let mut words = [("", Procedure::Direct); Procedure::ALL.len()];
    let mut index = 0;
    while index < words.len() {
        let procedure = Procedure::ALL[index];
        words[index] = (procedure.name(), procedure);
        index += 1;
    }
    words
};
pub(crate) const HOME_DIRECTIONS: [(&str, HomeDirection); 4] = [
    ("positive", HomeDirection::Positive),
    ("negative", HomeDirection::Negative),
    ("switch_positive", HomeDirection::SwitchPositive),
    ("switch_negative", HomeDirection::SwitchNegative),
];
pub(crate) const SWITCH_EDGES: [(&str, SwitchEdge); 4] = [
    ("rising", SwitchEdge::Rising),
    ("falling", SwitchEdge::Falling),
    ("switch_positive", SwitchEdge::SwitchPositive),
    ("switch_negative", SwitchEdge::SwitchNegative),
];

impl Reader {
    pub(super) fn homing(&mut self, axis: &Fields<'_>) -> Option<Homing> {
        let Some(node) = axis.get("homing") else {
            return Some(Homing::DIRECT);
        };
        let fields = self.fields(node, &shape::HOMING)?;
        let procedure = self
            .require(&fields, "procedure", "`homing`")
            .and_then(|node| self.choice(node, "`homing.procedure`", &PROCEDURES));
        let direction = fields
            .get("direction")
            .map_or(Some(HomeDirection::default()), |node| {
                self.choice(node, "`homing.direction`", &HOME_DIRECTIONS)
            });
        let edge = fields.get("edge").map_or(Some(SwitchEdge::default()), |node| {
            self.choice(node, "`homing.edge`", &SWITCH_EDGES)
        });
        let velocity = self.optional(&fields, "velocity", "`homing.velocity`");
        let creep = self.optional(&fields, "creep", "`homing.creep`");
        let pulse = fields
            .get("pulse")
            .map_or(Some(false), |node| self.boolean(node, "`homing.pulse`"));
        let block = fields
            .get("block")
            .map_or(Some(None), |node| self.block_detection(node).map(Some));
        let time_limit = fields.get("time_limit").map_or(Some(None), |node| {
            self.scans(node, "`homing.time_limit`").map(Some)
        });
        let distance_limit = self.optional(&fields, "distance_limit", "`homing.distance_limit`");
        Some(Homing {
            procedure: procedure?,
            direction: direction?,
            edge: edge?,
            velocity: velocity?.unwrap_or(0.0),
            creep: creep?,
            pulse: pulse?,
            block: block?,
            time_limit: time_limit?,
            distance_limit: distance_limit?,
        })
    }

    fn block_detection(&mut self, node: &Node) -> Option<BlockDetection> {
        let fields = self.fields(node, &shape::BLOCK_DETECTION)?;
        let velocity = self
            .require(&fields, "velocity", "`block`")
            .and_then(|node| self.finite(node, "`block.velocity`"));
        let scans = self
            .require(&fields, "time", "`block`")
            .and_then(|node| self.scans(node, "`block.time`"));
        Some(BlockDetection {
            velocity: velocity?,
            scans: u32::try_from(scans?).unwrap_or(u32::MAX),
        })
    }
}
