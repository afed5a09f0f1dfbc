//! The keys and values that the JSON Schema of scripts permits at a place.

use crate::tree::{Node, Step};
use serde_json::Value;
use std::sync::OnceLock;

/// Largest number of schemas that are read for one place.
const MOST: usize = 2000;

fn schema() -> &'static Value {
    static SCHEMA: OnceLock<Value> = OnceLock::new();
    SCHEMA.get_or_init(|| serde_json::from_str(&standstill_script::schema()).unwrap_or_default())
}

/// All permitted schemas at one place.
#[derive(Debug, Default)]
pub(crate) struct Allowed {
    schemas: Vec<&'static Value>,
    names: Vec<&'static str>,
}

/// The permitted schemas at the end of a path; `tree` decides if the value of one key determines another
/// one.
pub(crate) fn allowed(tree: &Node, path: &[Step]) -> Allowed {
    let mut here = Allowed::default();
    here.add(schema(), Some(tree), 0);
    let mut node = Some(tree);
    for step in path {
        let mut next = Allowed::default();
        node = node.and_then(|node| node.at(std::slice::from_ref(step)));
        for schema in here.schemas {
            let inner = match step {
                Step::Key(key) => schema
                    .get("properties")
                    .and_then(|it| it.get(key))
                    .or_else(|| schema.get("additionalProperties").filter(|it| it.is_object())),
                Step::Item(_) => schema.get("items"),
            };
            if let Some(inner) = inner {
                next.add(inner, node, 0);
            }
        }
        here = next;
    }
    here
}

impl Allowed {
    /// Adds a schema and all schemas it refers to.
    fn add(&mut self, schema: &'static Value, node: Option<&Node>, depth: usize) {
        const DEPTH_MOST: usize = 16;
        if depth > DEPTH_MOST || self.schemas.len() >= MOST {
            return;
        }
        self.schemas.push(schema);
        if let Some(name) = schema.get("$ref").and_then(Value::as_str)
            && let Some(name) = name.strip_prefix("#/$defs/")
        {
            self.names.push(name);
            if let Some(inner) = self::schema().get("$defs").and_then(|it| it.get(name)) {
                self.add(inner, node, depth + 1);
            }
        }
        for key in ["anyOf", "oneOf", "allOf"] {
            for inner in schema.get(key).and_then(Value::as_array).into_iter().flatten() {
                self.add(inner, node, depth + 1);
            }
        }
        if let (Some(condition), Some(then)) = (schema.get("if"), schema.get("then"))
            && holds(condition, node)
        {
            self.add(then, node, depth + 1);
        }
    }

    /// Whether one of the schemas is this definition.
    pub(crate) fn is(&self, name: &str) -> bool {
        self.names.contains(&name)
    }

    /// The keys of objects, and their permitted values.
    pub(crate) fn keys(&self) -> impl Iterator<Item = (&'static str, &'static Value)> {
        let objects = self
            .schemas
            .iter()
            .filter_map(|it| it.get("properties")?.as_object());
        objects.flatten().map(|(key, schema)| (key.as_str(), schema))
    }

    /// The values that are listed.
    pub(crate) fn values(&self) -> impl Iterator<Item = &'static Value> {
        let lists = self
            .schemas
            .iter()
            .filter_map(|it| it.get("enum")?.as_array())
            .flatten();
        let single = self.schemas.iter().filter_map(|it| it.get("const"));
        lists.chain(single)
    }

    /// Whether true and false are allowed there.
    pub(crate) fn has_booleans(&self) -> bool {
        self.schemas.iter().any(|it| match it.get("type") {
            Some(Value::String(ty)) => ty == "boolean",
            Some(Value::Array(types)) => types.iter().any(|ty| ty == "boolean"),
            _ => false,
        })
    }

    /// The description of the place.
    pub(crate) fn description(&self) -> Option<&'static str> {
        self.schemas.iter().find_map(|it| it.get("description")?.as_str())
    }

    /// The permitted kinds of values, in a few words.
    pub(crate) fn kinds(&self) -> String {
        const SHOWN: usize = 12;
        let mut words: Vec<String> = Vec::new();
        for schema in &self.schemas {
            let range = |schema: &Value| match (schema.get("minimum"), schema.get("maximum")) {
                (Some(low), Some(high)) => format!(" from {low} to {high}"),
                (Some(low), None) => format!(" from {low} on"),
                _ => String::new(),
            };
            match schema.get("type") {
                Some(Value::String(ty)) if ty != "null" => {
                    words.push(format!("{}{}", kind(ty), range(schema)))
                }
                Some(Value::Array(types)) => {
                    words.extend(types.iter().filter_map(|ty| Some(kind(ty.as_str()?).to_owned())));
                }
                _ => {}
            }
        }
        for name in &self.names {
            let word = match *name {
                "time_literal" => "a time, `T#10ms`",
                "wire" => "a wire, `{\"from\": \"signal\"}`",
                "expression" => "an expression, `\"=a AND NOT b\"`",
                "parameter" => "a parameter, `{\"param\": \"name\"}`",
                "conditions" => "conditions, `{\"signal\": value}`",
                _ => continue,
            };
            words.push(word.to_owned());
        }
        words.extend(self.values().take(SHOWN).map(|it| format!("`{it}`")));
        let mut seen = Vec::new();
        words.retain(|word| {
            let new = !seen.contains(word);
            seen.push(word.clone());
            new
        });
        words.join(", ")
    }
}

fn kind(ty: &str) -> &str {
    match ty {
        "boolean" => "true or false",
        "number" => "a number",
        "integer" => "a whole number",
        "string" => "a text",
        "object" => "an object",
        "array" => "a list",
        other => other,
    }
}

/// Whether a condition of the form `{"properties": {key: {"const": value}}}` holds.
fn holds(condition: &Value, node: Option<&Node>) -> bool {
    let Some(properties) = condition.get("properties").and_then(Value::as_object) else {
        return false;
    };
    properties.iter().all(|(key, schema)| {
        let found = node.and_then(|node| node.get(key)).and_then(Node::as_text);
        found.is_some() && found == schema.get("const").and_then(Value::as_str)
    })
}
