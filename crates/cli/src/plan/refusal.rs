//! The reason why a line was not planned.

use crate::json::{Object, number, string};
use crate::plan::fields::Fields;
use standstill_planner::PlanError;

/// The kinds of refusals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Code {
    /// The line cannot be read, or a value in it cannot be used.
    InvalidInput,
    /// The move takes more scans than a plan can count.
    TooLong,
    /// The goal cannot be reached with the given path.
    Unreachable,
}

impl Code {
    const fn name(self) -> &'static str {
        match self {
            Self::InvalidInput => "invalid_input",
            Self::TooLong => "too_long",
            Self::Unreachable => "unreachable",
        }
    }
}

/// The answer to a line that was not planned.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    code: Code,
    field: Option<String>,
    /// JSON.
    value: Option<String>,
    /// JSON.
    nearest: Option<String>,
    message: String,
}

impl Refusal {
    /// A refusal of a line as a whole.
    pub fn of_line(message: impl Into<String>) -> Self {
        Self {
            code: Code::InvalidInput,
            field: None,
            value: None,
            nearest: None,
            message: message.into(),
        }
    }

    /// A refusal of one field. Its value is that of the line, if it has one.
    pub fn of_field(code: Code, fields: &Fields<'_>, field: &str, message: impl Into<String>) -> Self {
        Self {
            code,
            field: Some(field.to_owned()),
            value: fields.echo(field),
            nearest: None,
            message: message.into(),
        }
    }

    /// The same for an object of a list: the field belongs to that object.
    pub fn inside(mut self, list: &str, place: usize) -> Self {
        self.field = self.field.map(|field| format!("{list}[{place}].{field}"));
        self
    }

    /// Adds the refused value, as JSON.
    pub fn value(mut self, json: &str) -> Self {
        self.value = Some(json.to_owned());
        self
    }

    /// Adds the nearest permitted value.
    pub fn nearest(mut self, json: Option<String>) -> Self {
        self.nearest = json;
        self
    }

    /// A refusal by the planner.
    pub fn of_plan_error(fields: &Fields<'_>, error: PlanError) -> Self {
        let (code, field, value, nearest) = match error {
            PlanError::InvalidInput { field, value } => (Code::InvalidInput, field.name(), Some(value), None),
            PlanError::TooLong { field, value } => (Code::TooLong, field.name(), Some(value), None),
            PlanError::Unbounded => (Code::InvalidInput, "limits", None, None),
            PlanError::OutOfRange {
                field,
                value,
                nearest,
            } => (Code::InvalidInput, field.name(), Some(value), Some(nearest)),
            PlanError::Unreachable {
                field,
                value,
                nearest,
            } => (Code::Unreachable, field.name(), Some(value), Some(nearest)),
            // The planner may have further reasons that this program does not know yet.
            other => return Self::of_line(other.to_string()),
        };
        let mut refusal = Self::of_field(code, fields, field, error.to_string());
        refusal.value = refusal.value.or(value.map(number));
        refusal.nearest(nearest.map(number))
    }

    /// The code in answers.
    pub const fn code(&self) -> &'static str {
        self.code.name()
    }

    /// The refused field; none if the line as a whole was refused.
    pub fn field(&self) -> Option<&str> {
        self.field.as_deref()
    }

    /// The refused value, as JSON.
    pub fn value_json(&self) -> Option<&str> {
        self.value.as_deref()
    }

    /// The nearest permitted value, as JSON.
    pub fn nearest_json(&self) -> Option<&str> {
        self.nearest.as_deref()
    }

    /// The reason, for people.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The line to write; `id` is JSON.
    pub fn line(&self, id: &str) -> String {
        let null = || "null".to_owned();
        let error = Object::new()
            .with("code", string(self.code.name()))
            .with("field", self.field.as_deref().map_or_else(null, string))
            .with("value", self.value.clone().unwrap_or_else(null))
            .with_some("nearest", self.nearest.clone())
            .with("message", string(&self.message));
        Object::new().with("id", id).with("error", error.text()).text()
    }
}
