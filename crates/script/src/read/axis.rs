//! Axes and their drives.

use super::json::{Json, Key, Node};
use super::value::Fields;
use super::{Reader, shape};
use crate::error::{Code, Diagnostic};
use crate::model::{Axis, Span};
use standstill_axis::{
    AboveLimit, AxisConfig, AxisState, Defaults, EdgeWhileBusy, Following, InPosition, JogAtLimit, Limits,
    ModuloTargets, MoveProfile, OnLimit, OnMasterLost, PowerOff, QUEUE_MAX, Scaling, StartState, StopLimits,
};

pub(crate) const ABOVE_LIMIT: [(&str, AboveLimit); 2] =
    [("clamp", AboveLimit::Clamp), ("error", AboveLimit::Error)];
pub(crate) const PROFILES: [(&str, MoveProfile); MoveProfile::ALL.len()] = {
    let mut words = [("", MoveProfile::Overlapped); MoveProfile::ALL.len()];
    let mut index = 0;
    while index < words.len() {
        let profile = MoveProfile::ALL[index];
        words[index] = (profile.name(), profile);
        index += 1;
    }
    words
};
pub(crate) const ON_POWER_OFF: [(&str, PowerOff); 3] = [
    ("ramp", PowerOff::Ramp),
    ("coast", PowerOff::Coast),
    ("drive", PowerOff::Drive),
];
pub(crate) const ON_LIMIT: [(&str, OnLimit); 3] = [
    ("lag", OnLimit::Lag),
    ("error", OnLimit::Error),
    ("slow_master", OnLimit::SlowMaster),
];
pub(crate) const ON_MASTER_LOST: [(&str, OnMasterLost); 2] =
    [("error", OnMasterLost::Error), ("hold", OnMasterLost::Hold)];
pub(crate) const JOG_AT_LIMIT: [(&str, JogAtLimit); 2] =
    [("error", JogAtLimit::Error), ("stop", JogAtLimit::Stop)];
pub(crate) const MODULO_TARGETS: [(&str, ModuloTargets); 2] =
    [("error", ModuloTargets::Error), ("wrap", ModuloTargets::Wrap)];
pub(crate) const EDGE_WHILE_BUSY: [(&str, EdgeWhileBusy); 2] = [
    ("restart", EdgeWhileBusy::Restart),
    ("ignore", EdgeWhileBusy::Ignore),
];
pub(crate) const START_STATES: [(&str, StartState); 2] = [
    ("Disabled", StartState::Disabled),
    ("Standstill", StartState::Standstill),
];

impl Reader {
    pub(super) fn axes(&mut self, fields: &Fields<'_>) -> Option<Vec<Axis>> {
        let node = self.require(fields, "axes", "a script")?;
        let members = self.map(node, "`axes`")?;
        self.check_count(members.iter().count(), node, "axes");
        let axes: Vec<Option<Axis>> = (0..)
            .zip(members.iter())
            .map(|(index, (key, node))| self.axis(index, key, node))
            .collect();
        axes.into_iter().collect()
    }

    fn axis(&mut self, index: usize, key: &Key, node: &Node) -> Option<Axis> {
        let fields = self.fields(node, &shape::AXIS)?;
        let limits = self.limits(&fields);
        // Without limits nothing below could be compared with them, but its own mistakes still show.
        let mut config = AxisConfig::new(limits.unwrap_or(Limits::NONE));
        let good = self.fill(&fields, &mut config);
        let unit = fields
            .get("unit")
            .map_or(Some(""), |node| self.text(node, "`unit`"));
        let place = self.stands_at(key.span, &fields);
        let drive = self.drive(&fields, config.scaling.is_some());
        self.drives
            .push(drive.map(|drive| (drive, config.scaling.is_some())));
        limits?;
        good?;
        if let Err(error) = config.check() {
            self.report(Diagnostic::new(
                Code::BadValue,
                place_of(key, node, error.key()),
                error.to_string(),
            ));
            return None;
        }
        self.check_turn(&fields, &config)?;
        Some(Axis {
            name: key.text.clone(),
            unit: unit?.to_owned(),
            config,
            drive: drive?,
            masters: self.masters_of(index),
            superimposed: self.is_superimposed(index),
            on_cam: self.on_cams.contains(&index),
            place,
        })
    }

    fn limits(&mut self, axis: &Fields<'_>) -> Option<Limits> {
        let node = self.require(axis, "limits", "an axis")?;
        let fields = self.fields(node, &shape::LIMITS)?;
        let velocity = self.needed_limit(&fields, "velocity");
        let acceleration = self.needed_limit(&fields, "acceleration");
        let deceleration = self.limit(&fields, "deceleration");
        let jerk = self.limit(&fields, "jerk");
        let snap = self.limit(&fields, "snap");
        Some(Limits {
            velocity: velocity?,
            acceleration: acceleration?,
            deceleration: deceleration?.or(acceleration)?,
            jerk: jerk?.unwrap_or(f64::INFINITY),
            snap: snap?.unwrap_or(f64::INFINITY),
        })
    }

    /// A limit that may be absent or null.
    fn limit(&mut self, fields: &Fields<'_>, key: &str) -> Option<Option<f64>> {
        match fields.get(key) {
            None | Some(Node { json: Json::Null, .. }) => Some(None),
            Some(node) => self.finite(node, &format!("`limits.{key}`")).map(Some),
        }
    }

    fn needed_limit(&mut self, fields: &Fields<'_>, key: &str) -> Option<f64> {
        let limit = self.limit(fields, key)?;
        if limit.is_none() {
            let span = fields.entry(key).map_or(fields.brace(), |(_, node)| node.span);
            self.report(
                Diagnostic::new(Code::MissingKey, span, format!("`limits` needs a `{key}`"))
                    .help("only deceleration, jerk and snap may be left out"),
            );
        }
        limit
    }

    /// A number that may be absent, in `Some`; `None` if it was refused.
    pub(super) fn optional(&mut self, fields: &Fields<'_>, key: &str, what: &str) -> Option<Option<f64>> {
        match fields.get(key) {
            None => Some(None),
            Some(node) => self.finite(node, what).map(Some),
        }
    }

    /// Reads the keys that stand directly in an axis; reports all mistakes before it gives up.
    fn fill(&mut self, fields: &Fields<'_>, config: &mut AxisConfig) -> Option<()> {
        let defaults = self.defaults(fields);
        let position = self.optional(fields, "position", "`position`");
        let stop_deceleration = self.optional(fields, "stop_deceleration", "`stop_deceleration`");
        let stop_jerk = self.optional(fields, "stop_jerk", "`stop_jerk`");
        let start = fields
            .get("state")
            .map_or(Some(StartState::default()), |node| self.start_state(node));
        let above_limit = fields
            .get("above_limit")
            .map_or(Some(AboveLimit::default()), |node| {
                self.choice(node, "`above_limit`", &ABOVE_LIMIT)
            });
        let profile = fields
            .get("profile")
            .map_or(Some(MoveProfile::default()), |node| {
                self.choice(node, "`profile`", &PROFILES)
            });
        let on_power_off = fields
            .get("on_power_off")
            .map_or(Some(PowerOff::default()), |node| {
                self.choice(node, "`on_power_off`", &ON_POWER_OFF)
            });
        let queue = fields.get("queue").map_or(Some(config.queue as i64), |node| {
            self.whole(node, "`queue`", 0..=QUEUE_MAX as i64)
        });
        let needs_homed = fields
            .get("needs_homed")
            .map_or(Some(false), |node| self.boolean(node, "`needs_homed`"));
        let hardware_limits = fields
            .get("hardware_limits")
            .map_or(Some(config.hardware_limits), |node| {
                self.boolean(node, "`hardware_limits`")
            });
        let homing = self.homing(fields);
        let override_max = self.optional(fields, "override_max", "`override_max`");
        let max_following_error = self.optional(fields, "max_following_error", "`max_following_error`");
        let in_position = self.in_position(fields);
        let following = self.coupling(fields);
        let power_timeout = fields
            .get("power_timeout")
            .map_or(Some(None), |node| self.scans(node, "`power_timeout`").map(Some));
        let scaling = self.scaling(fields);
        let modulo = self.optional(fields, "modulo", "`modulo`");
        let application_limits = self.application_limits(fields, &config.limits);
        let stop = self.stop(fields);
        let jog_at_limit = fields
            .get("jog_at_limit")
            .map_or(Some(JogAtLimit::default()), |node| {
                self.choice(node, "`jog_at_limit`", &JOG_AT_LIMIT)
            });
        let modulo_targets = fields
            .get("modulo_targets")
            .map_or(Some(ModuloTargets::default()), |node| {
                self.choice(node, "`modulo_targets`", &MODULO_TARGETS)
            });
        let edge_while_busy = fields
            .get("edge_while_busy")
            .map_or(Some(EdgeWhileBusy::default()), |node| {
                self.choice(node, "`edge_while_busy`", &EDGE_WHILE_BUSY)
            });
        let software_limits = self.software_limits(fields);

        config.defaults = defaults?;
        config.position = position?.unwrap_or(0.0);
        config.stop_deceleration = stop_deceleration?;
        config.stop_jerk = stop_jerk?;
        config.start = start?;
        config.above_limit = above_limit?;
        config.profile = profile?;
        config.on_power_off = on_power_off?;
        config.queue = usize::try_from(queue?).ok()?;
        config.needs_homed = needs_homed?;
        config.hardware_limits = hardware_limits?;
        config.homing = homing?;
        config.override_max = override_max?.unwrap_or(config.override_max);
        config.max_following_error = max_following_error?;
        config.in_position = in_position?;
        config.following = following?;
        config.power_timeout = power_timeout?;
        config.scaling = scaling?;
        config.modulo = modulo?;
        config.software_limits = software_limits?;
        config.application_limits = application_limits?;
        config.stop = stop?;
        config.jog_at_limit = jog_at_limit?;
        config.modulo_targets = modulo_targets?;
        config.edge_while_busy = edge_while_busy?;
        Some(())
    }

    fn defaults(&mut self, axis: &Fields<'_>) -> Option<Defaults> {
        let Some(node) = axis.get("defaults") else {
            return Some(Defaults::default());
        };
        let fields = self.fields(node, &shape::DEFAULTS)?;
        let mut one = |key: &str| self.optional(&fields, key, &format!("`defaults.{key}`"));
        let (acceleration, deceleration) = (one("acceleration"), one("deceleration"));
        let (jerk, snap) = (one("jerk"), one("snap"));
        Some(Defaults {
            acceleration: acceleration?,
            deceleration: deceleration?,
            jerk: jerk?,
            snap: snap?,
        })
    }

    /// What is left out, or null, is the limit of the axis, given as `limits`.
    fn application_limits(&mut self, axis: &Fields<'_>, limits: &Limits) -> Option<Option<Limits>> {
        let Some(node) = axis.get("application_limits") else {
            return Some(None);
        };
        let fields = self.fields(node, &shape::APPLICATION_LIMITS)?;
        let mut one = |key: &str| match fields.get(key) {
            None | Some(Node { json: Json::Null, .. }) => Some(None),
            Some(node) => self
                .finite(node, &format!("`application_limits.{key}`"))
                .map(Some),
        };
        let (velocity, acceleration) = (one("velocity"), one("acceleration"));
        let (deceleration, jerk, snap) = (one("deceleration"), one("jerk"), one("snap"));
        let acceleration = acceleration?;
        Some(Some(Limits {
            velocity: velocity?.unwrap_or(limits.velocity),
            acceleration: acceleration.unwrap_or(limits.acceleration),
            // As in `limits` the acceleration stands for it, as far as the axis has that.
            deceleration: deceleration?.unwrap_or_else(|| {
                acceleration
                    .unwrap_or(limits.deceleration)
                    .min(limits.deceleration)
            }),
            jerk: jerk?.unwrap_or(limits.jerk),
            snap: snap?.unwrap_or(limits.snap),
        }))
    }

    fn stop(&mut self, axis: &Fields<'_>) -> Option<Option<StopLimits>> {
        let Some(node) = axis.get("stop") else {
            return Some(None);
        };
        let fields = self.fields(node, &shape::STOP)?;
        let mut one = |key: &str| self.optional(&fields, key, &format!("`stop.{key}`"));
        let (deceleration, jerk, snap) = (one("deceleration"), one("jerk"), one("snap"));
        Some(Some(StopLimits {
            deceleration: deceleration?,
            jerk: jerk?,
            snap: snap?,
        }))
    }

    fn start_state(&mut self, node: &Node) -> Option<StartState> {
        if let Json::Text(text) = &node.json
            && AxisState::ALL.iter().any(|state| state.name() == text)
            && START_STATES.iter().all(|(name, _)| name != text)
        {
            let message = format!("an axis cannot start in {text}");
            self.report(
                Diagnostic::new(Code::BadValue, node.span, message)
                    .help("it starts in `Disabled` or `Standstill`"),
            );
            return None;
        }
        let names = START_STATES.map(|(name, _)| name);
        let name = self.state_name(node, "`state`", &names)?;
        START_STATES
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, state)| *state)
    }

    fn scaling(&mut self, axis: &Fields<'_>) -> Option<Option<Scaling>> {
        let Some(node) = axis.get("scaling") else {
            return Some(None);
        };
        let fields = self.fields(node, &shape::SCALING)?;
        let mut count = |key: &str| {
            let node = self.require(&fields, key, "`scaling`")?;
            let value = self.whole(node, &format!("`scaling.{key}`"), 1..=i64::from(u32::MAX))?;
            u32::try_from(value).ok()
        };
        let (increments, units) = (count("increments"), count("units"));
        let invert = fields
            .get("invert")
            .map_or(Some(false), |node| self.boolean(node, "`scaling.invert`"));
        let offset = self.optional(&fields, "offset", "`scaling.offset`");
        match Scaling::new(increments?, units?, invert?, offset?.unwrap_or(0.0)) {
            Ok(scaling) => Some(Some(scaling)),
            Err(error) => {
                self.report(Diagnostic::new(Code::BadValue, node.span, error.to_string()));
                None
            }
        }
    }

    fn software_limits(&mut self, axis: &Fields<'_>) -> Option<Option<(f64, f64)>> {
        let Some(node) = axis.get("software_limits") else {
            return Some(None);
        };
        let fields = self.fields(node, &shape::SOFTWARE_LIMITS)?;
        let min = self.optional(&fields, "min", "`software_limits.min`");
        let max = self.optional(&fields, "max", "`software_limits.max`");
        let (min, max) = (min?, max?);
        if min.is_none() && max.is_none() {
            let message = "`software_limits` needs `min`, `max` or both";
            self.report(Diagnostic::new(Code::MissingKey, fields.brace(), message));
            return None;
        }
        Some(Some((
            min.unwrap_or(f64::NEG_INFINITY),
            max.unwrap_or(f64::INFINITY),
        )))
    }

    fn in_position(&mut self, axis: &Fields<'_>) -> Option<Option<InPosition>> {
        let Some(node) = axis.get("in_position") else {
            return Some(None);
        };
        let fields = self.fields(node, &shape::IN_POSITION)?;
        let window = self
            .require(&fields, "window", "`in_position`")
            .and_then(|node| self.finite(node, "`in_position.window`"));
        let scans = fields
            .get("time")
            .map_or(Some(0), |node| self.scans(node, "`in_position.time`"));
        Some(Some(InPosition {
            window: window?,
            scans: u32::try_from(scans?).unwrap_or(u32::MAX),
        }))
    }

    fn coupling(&mut self, axis: &Fields<'_>) -> Option<Following> {
        let Some(node) = axis.get("coupling") else {
            return Some(Following::default());
        };
        let fields = self.fields(node, &shape::COUPLING)?;
        let on_limit = fields.get("on_limit").map_or(Some(OnLimit::default()), |node| {
            self.choice(node, "`coupling.on_limit`", &ON_LIMIT)
        });
        let max_deviation = self.optional(&fields, "max_deviation", "`coupling.max_deviation`");
        let on_master_lost = fields
            .get("on_master_lost")
            .map_or(Some(OnMasterLost::default()), |node| {
                self.choice(node, "`coupling.on_master_lost`", &ON_MASTER_LOST)
            });
        let actual_filter = fields
            .get("actual_filter")
            .map_or(Some(Following::DEFAULT.actual_filter.into()), |node| {
                self.scans(node, "`coupling.actual_filter`")
            });
        let actual_lead = fields
            .get("actual_lead")
            .map_or(Some(false), |node| self.boolean(node, "`coupling.actual_lead`"));
        Some(Following {
            on_limit: on_limit?,
            max_deviation: max_deviation?,
            on_master_lost: on_master_lost?,
            actual_filter: u32::try_from(actual_filter?).unwrap_or(u32::MAX),
            actual_lead: actual_lead?,
        })
    }

    /// An axis that goes half a turn in a scan could have gone either way.
    fn check_turn(&mut self, axis: &Fields<'_>, config: &AxisConfig) -> Option<()> {
        let (Some(node), Some(length), Some(cycle_ns)) = (axis.get("modulo"), config.modulo, self.cycle_ns)
        else {
            return Some(());
        };
        let way = config.limits.velocity * (cycle_ns as f64 / 1e9);
        if way < length / 2.0 {
            return Some(());
        }
        let message = format!(
            "`modulo` is {length:?}, and at its velocity limit the axis goes {way:?} in a cycle: half a turn or more, so positions would not tell which way"
        );
        self.report(
            Diagnostic::new(Code::BadValue, node.span, message)
                .help("lower `limits.velocity`, or give a longer turn or a shorter `cycle`"),
        );
        None
    }
}

/// Where the configuration key `path`, such as `limits.jerk`, stands in the axis `node`: its value, or the
/// name of the axis if it was left out.
fn place_of(axis: &Key, node: &Node, path: &str) -> Span {
    let mut place = node;
    for part in path.split('.') {
        let member = match &place.json {
            Json::Map(members) => members.iter().find(|(key, _)| key.text == part),
            _ => None,
        };
        match member {
            Some((_, value)) => place = value,
            None => return axis.span,
        }
    }
    place.span
}
