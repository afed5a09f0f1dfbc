//! The fields of a line: their names and values.

use crate::json::Object;
use crate::plan::methods::{self, MethodInfo};
use crate::plan::refusal::{Code, Refusal};
use crate::suggest::nearest;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use standstill_planner::{DirectedLimits, Field, Limits, Setpoint};
use std::borrow::Cow;
use std::fmt;

/// The fields that every method takes. The table of methods has those that only some take.
const COMMON: [&str; 12] = [
    "id",
    "Ts",
    "target",
    "position",
    "velocity",
    "acceleration",
    "jerk",
    "end_velocity",
    "end_acceleration",
    "limits",
    "method",
    "vibration",
];

/// The fields of `limits`.
const LIMITS: [&str; 5] = ["velocity", "acceleration", "deceleration", "jerk", "snap"];

/// The fields of `velocity_limits`.
const DIRECTIONS: [&str; 2] = ["positive", "negative"];

/// The fields of one line, each with its text. The keys are known and unique.
#[derive(Clone, Debug)]
pub struct Fields<'a> {
    members: Members<'a>,
    limits: Members<'a>,
    limits_before: Members<'a>,
    velocity_limits: Members<'a>,
}

/// Start and limits of a move, which every method reads.
#[derive(Clone, Copy, Debug)]
pub struct Problem {
    /// The start of the move (u and derivatives).
    pub start: Setpoint,
    /// Velocity at the target (u/s).
    pub end_velocity: f64,
    /// Acceleration at the target (u/s^2).
    pub end_acceleration: f64,
    /// The limits; infinite if not given.
    pub limits: Limits,
}

impl Problem {
    /// The first field that is not at rest, and its value.
    pub fn first_motion(&self) -> Option<(Field, f64)> {
        first_motion(&self.start, self.end_velocity, self.end_acceleration)
    }
}

/// The first part of a start or an end that is not at rest, and its value.
pub fn first_motion(start: &Setpoint, end_velocity: f64, end_acceleration: f64) -> Option<(Field, f64)> {
    let parts = [
        (Field::Velocity, start.velocity),
        (Field::Acceleration, start.acceleration),
        (Field::Jerk, start.jerk),
        (Field::EndVelocity, end_velocity),
        (Field::EndAcceleration, end_acceleration),
    ];
    parts.into_iter().find(|(_, value)| *value != 0.0)
}

impl<'a> Fields<'a> {
    /// Reads a line: it must be a JSON object without duplicate keys.
    pub fn of_line(line: &'a [u8]) -> Result<Self, Refusal> {
        let text = std::str::from_utf8(line).map_err(|_| Refusal::of_line("the line is no UTF-8"))?;
        match serde_json::from_str(text) {
            Ok(Members(members)) => Ok(Self::of_members(members)),
            Err(error) => Err(match serde_json::from_str::<&RawValue>(text) {
                Ok(value) => Refusal::of_line("the line is no JSON object").value(value.get()),
                Err(_) => Refusal::of_line(format!("the line is no JSON: {}", cause(&error))),
            }),
        }
    }

    /// The fields from a host that has them separately. Keys are checked as those of a line are.
    pub fn of_members(members: Vec<Member<'a>>) -> Self {
        Self {
            members: Members(members),
            limits: Members::default(),
            limits_before: Members::default(),
            velocity_limits: Members::default(),
        }
    }

    /// The `id` as it is on the line; `null` if there is none.
    pub fn id(&self) -> &'a str {
        match self.members.get("id") {
            Some(Given::Json(text)) => text,
            // A host keeps the `id` itself.
            Some(Given::Number(_) | Given::Object(_)) | None => "null",
        }
    }

    /// Removes a field of this name; returns its text, if it occurs once.
    pub fn take(&mut self, name: &str) -> Option<Cow<'a, str>> {
        let index = self.members.0.iter().position(|(key, _)| key == name)?;
        let (_, value) = self.members.0.remove(index);
        Some(value.json())
    }

    /// Opens `limits` and checks that all keys exist and are unique.
    pub fn checked(&self) -> Result<Self, Refusal> {
        let known = COMMON.into_iter().chain(methods::extra_fields());
        self.check_keys(&self.members, "", known)?;
        let opened = Self {
            members: self.members.clone(),
            limits: self.opened("limits")?,
            limits_before: self.opened("limits_before")?,
            velocity_limits: self.opened("velocity_limits")?,
        };
        opened.check_keys(&opened.limits, "limits.", LIMITS.into_iter())?;
        opened.check_keys(&opened.limits_before, "limits_before.", LIMITS.into_iter())?;
        let directions = DIRECTIONS.into_iter();
        opened.check_keys(&opened.velocity_limits, "velocity_limits.", directions)?;
        Ok(opened)
    }

    /// The members of a field that is an object. None if it is null or absent.
    fn opened(&self, field: &str) -> Result<Members<'a>, Refusal> {
        let wrong = || self.invalid(field, format!("`{field}` must be an object of numbers"));
        match self.members.get(field) {
            None | Some(Given::Json("null")) => Ok(Members::default()),
            Some(Given::Json(text)) => serde_json::from_str(text).map_err(|_| wrong()),
            Some(Given::Object(members)) => Ok(Members(members.to_vec())),
            Some(Given::Number(_)) => Err(wrong()),
        }
    }

    /// The fields of each object of a list, each of them `known`. None if the list is null or absent.
    pub fn list(
        &self,
        field: &str,
        known: impl Iterator<Item = &'static str> + Clone,
    ) -> Result<Vec<Self>, Refusal> {
        let wrong = || self.invalid(field, format!("`{field}` must be a list of objects"));
        let texts: Vec<&RawValue> = match self.members.get(field) {
            None | Some(Given::Json("null")) => Vec::new(),
            Some(Given::Json(text)) => serde_json::from_str(text).map_err(|_| wrong())?,
            Some(Given::Number(_) | Given::Object(_)) => return Err(wrong()),
        };
        let opened = |(place, text): (usize, &'a RawValue)| {
            let Members(members) = serde_json::from_str(text.get()).map_err(|_| wrong())?;
            let fields = Self::of_members(members);
            let checked = fields.check_keys(&fields.members, "", known.clone());
            checked.map_err(|refusal| refusal.inside(field, place))?;
            Ok(fields)
        };
        texts.into_iter().enumerate().map(opened).collect()
    }

    fn check_keys(
        &self,
        members: &Members<'_>,
        path: &str,
        known: impl Iterator<Item = &'static str> + Clone,
    ) -> Result<(), Refusal> {
        for (index, (key, _)) in members.0.iter().enumerate() {
            let field = || format!("{path}{key}");
            if !known.clone().any(|name| name == key) {
                let field = field();
                let hint = nearest(key, known)
                    .map_or(String::new(), |name| format!("; did you mean `{path}{name}`?"));
                return Err(self.invalid(&field, format!("there is no field `{field}`{hint}")));
            }
            if members.0.iter().skip(index + 1).any(|(later, _)| later == key) {
                let field = field();
                return Err(self.invalid(&field, format!("`{field}` is given twice")));
            }
        }
        Ok(())
    }

    /// A refusal of `field` for its value.
    pub fn invalid(&self, field: &str, message: String) -> Refusal {
        Refusal::of_field(Code::InvalidInput, self, field, message)
    }

    /// The value of a field as JSON, for an answer; `limits.jerk` is a field of `limits`.
    pub fn echo(&self, field: &str) -> Option<String> {
        let text = self.given(field)?.json();
        // A number that no f64 can hold would make the answer unreadable to many programs, so it is
        // written as a string.
        let readable = serde_json::from_str::<serde_json::Value>(&text).is_ok();
        Some(if readable {
            text.into_owned()
        } else {
            crate::json::string(&text)
        })
    }

    fn given(&self, field: &str) -> Option<Given<'a>> {
        match field.split_once('.') {
            Some(("limits", name)) => self.limits.get(name),
            Some(("limits_before", name)) => self.limits_before.get(name),
            Some(("velocity_limits", name)) => self.velocity_limits.get(name),
            _ => self.members.get(field),
        }
    }

    /// A finite number, if the field is present.
    pub fn number(&self, field: &str) -> Result<Option<f64>, Refusal> {
        let text = match self.given(field) {
            None => return Ok(None),
            Some(Given::Number(value)) if value.is_finite() => return Ok(Some(value)),
            Some(given) => &*given.json(),
        };
        if ["\"NaN\"", "\"Infinity\"", "\"-Infinity\""].contains(&text) {
            let remedy = if field.starts_with("limits") || field.starts_with("velocity_limits") {
                "; leave it out for no limit"
            } else {
                ""
            };
            return Err(self.invalid(field, format!("`{field}` must be finite{remedy}")));
        }
        if !text.starts_with(|c: char| c == '-' || c.is_ascii_digit()) {
            return Err(self.invalid(field, format!("`{field}` must be a number")));
        }
        match serde_json::from_str(text) {
            Ok(value) => Ok(Some(value)),
            Err(_) => Err(self.invalid(field, format!("`{field}` is too large for a 64-bit float"))),
        }
    }

    /// A finite number that must be present.
    pub fn required(&self, field: &str) -> Result<f64, Refusal> {
        self.number(field)?
            .ok_or_else(|| self.invalid(field, format!("`{field}` is missing")))
    }

    /// A string, if the field is present.
    pub fn string(&self, field: &str) -> Result<Option<String>, Refusal> {
        let given = self.given(field).map(Given::json);
        let read = given.as_deref().map(serde_json::from_str).transpose();
        read.map_err(|_| self.invalid(field, format!("`{field}` must be a string")))
    }

    /// A list of pairs of finite numbers, if the field is present.
    pub fn pairs(&self, field: &str) -> Result<Option<Vec<(f64, f64)>>, Refusal> {
        let given = self.given(field).map(Given::json);
        let read = given.as_deref().map(serde_json::from_str).transpose();
        read.map_err(|_| self.invalid(field, format!("`{field}` must be a list of pairs of numbers")))
    }

    /// A bound of `limits`; `absent` if it is null or not given.
    fn limit(&self, field: &str, absent: f64) -> Result<f64, Refusal> {
        if self.given(field).is_some_and(Given::is_null) {
            return Ok(absent);
        }
        Ok(self.number(field)?.unwrap_or(absent))
    }

    /// Start state, velocity at the end and limits. The planner checks whether they are valid.
    pub fn problem(&self) -> Result<Problem, Refusal> {
        let state = |field| Ok(self.number(field)?.unwrap_or(0.0));
        Ok(Problem {
            start: Setpoint {
                position: state("position")?,
                velocity: state("velocity")?,
                acceleration: state("acceleration")?,
                jerk: state("jerk")?,
                snap: 0.0,
            },
            end_velocity: state("end_velocity")?,
            end_acceleration: state("end_acceleration")?,
            limits: self.limits("limits", &Limits::NONE)?,
        })
    }

    /// The limits of the motion so far; limits that are not given are as in `limits`.
    pub fn limits_before(&self, limits: &Limits) -> Result<Limits, Refusal> {
        if self.limits_before.0.is_empty() {
            return Ok(*limits);
        }
        for name in LIMITS {
            let field = format!("limits_before.{name}");
            if !(self.limit(&field, f64::INFINITY)? > 0.0) {
                return Err(self.invalid(&field, format!("`{field}` must be positive")));
            }
        }
        self.limits("limits_before", limits)
    }

    /// `limits` with a velocity bound for each direction: the lower one of its own bound and that in
    /// `velocity_limits`.
    pub fn directed(&self, limits: &Limits) -> Result<DirectedLimits, Refusal> {
        let side = |name: &str| {
            let field = format!("velocity_limits.{name}");
            let bound = self.limit(&field, f64::INFINITY)?;
            if bound > 0.0 {
                return Ok(bound.min(limits.velocity));
            }
            let message = format!("`{field}` must be positive: it is the largest speed in its direction");
            let nearest = (bound < 0.0).then(|| crate::json::number(-bound));
            Err(self.invalid(&field, message).nearest(nearest))
        };
        if self.velocity_limits.0.is_empty() {
            return Ok(DirectedLimits::from(*limits));
        }
        Ok(DirectedLimits {
            positive: side("positive")?,
            negative: side("negative")?,
            limits: *limits,
        })
    }

    /// Whether the line has a field.
    pub fn has(&self, field: &str) -> bool {
        self.members.get(field).is_some()
    }

    /// The limits of an object; limits that it does not give are those of `absent`.
    fn limits(&self, object: &str, absent: &Limits) -> Result<Limits, Refusal> {
        let bound = |name: &str, absent| self.limit(&format!("{object}.{name}"), absent);
        let acceleration = bound("acceleration", absent.acceleration)?;
        let given = self.given(&format!("{object}.acceleration")).is_some();
        let deceleration = if given { acceleration } else { absent.deceleration };
        Ok(Limits {
            velocity: bound("velocity", absent.velocity)?,
            acceleration,
            deceleration: bound("deceleration", deceleration)?,
            jerk: bound("jerk", absent.jerk)?,
            snap: bound("snap", absent.snap)?,
        })
    }

    /// The method the line names, if it names one.
    pub fn method(&self) -> Result<Option<&'static MethodInfo>, Refusal> {
        let Some(name) = self.string("method")? else {
            return Ok(None);
        };
        if let Some(found) = methods::find(&name) {
            return Ok(Some(found));
        }
        let near = nearest(&name, methods::names());
        let hint = match near {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("there are {}", methods::names().collect::<Vec<_>>().join(", ")),
        };
        let refusal = self.invalid("method", format!("there is no such method; {hint}"));
        Err(refusal.nearest(near.map(crate::json::string)))
    }

    /// The names of all fields on the line.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.members.0.iter().map(|(key, _)| &**key)
    }
}

/// The error of serde_json without the line number, because every line is its line 1.
fn cause(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    let what = text.strip_suffix(&place).unwrap_or(&text);
    format!("{what} at column {}", error.column())
}

/// The value of a field, as it was given.
#[derive(Clone, Copy, Debug)]
pub enum Given<'a> {
    /// JSON.
    Json(&'a str),
    /// A number from a host.
    Number(f64),
    /// An object from a host that has its members separately.
    Object(&'a [Member<'a>]),
}

/// A field of a line, or of an object on it: its key and its value.
pub type Member<'a> = (Cow<'a, str>, Given<'a>);

impl<'a> Given<'a> {
    /// As JSON.
    fn json(self) -> Cow<'a, str> {
        match self {
            Self::Json(text) => text.into(),
            Self::Number(value) => crate::json::number(value).into(),
            Self::Object(members) => {
                let with = |object: Object, (key, value): &Member<'_>| object.with(key, value.json());
                members.iter().fold(Object::new(), with).text().into()
            }
        }
    }

    fn is_null(self) -> bool {
        matches!(self, Self::Json("null"))
    }
}

/// The members of an object in the order of the text, duplicates included.
#[derive(Clone, Debug, Default)]
struct Members<'a>(Vec<Member<'a>>);

impl<'a> Members<'a> {
    fn get(&self, key: &str) -> Option<Given<'a>> {
        self.0
            .iter()
            .find(|(name, _)| name == key)
            .map(|(_, value)| *value)
    }
}

impl<'de: 'a, 'a> Deserialize<'de> for Members<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Collect;

        impl<'de> Visitor<'de> for Collect {
            type Value = Vec<Member<'de>>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut members = Vec::new();
                while let Some((key, value)) = map.next_entry::<Cow<'de, str>, &RawValue>()? {
                    members.push((key, Given::Json(value.get())));
                }
                Ok(members)
            }
        }

        deserializer.deserialize_map(Collect).map(Members)
    }
}
