//! JSON as the interface writes it: keys in a fixed order, numbers in shortest round-trip form.
//!
//! `serde_json` writes `1e21` as `1e+21`; every other text of the product has Rust's own form.

/// A finite number in the shortest form that reads back as the same number, -0.0 as `0.0`. Other values become
/// their word, as a string.
pub fn number(value: f64) -> String {
    if value.is_nan() {
        string("NaN")
    } else if value == f64::INFINITY {
        string("Infinity")
    } else if value == f64::NEG_INFINITY {
        string("-Infinity")
    } else {
        // Adding 0.0 removes the sign of zero and changes nothing else.
        format!("{:?}", value + 0.0)
    }
}

/// A string in quotation marks, escaped.
pub fn string(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// A list of values in JSON form.
pub fn list(values: impl IntoIterator<Item = String>) -> String {
    format!("[{}]", values.into_iter().collect::<Vec<_>>().join(","))
}

/// An object with its keys in the order in which they were added.
#[derive(Clone, Debug, Default)]
pub struct Object {
    members: String,
}

impl Object {
    /// An object without members.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a member with a value in JSON form.
    pub fn with(mut self, key: &str, json: impl AsRef<str>) -> Self {
        if !self.members.is_empty() {
            self.members.push(',');
        }
        self.members.push_str(&string(key));
        self.members.push(':');
        self.members.push_str(json.as_ref());
        self
    }

    /// Adds a member unless there is no value.
    pub fn with_some(self, key: &str, json: Option<String>) -> Self {
        match json {
            Some(json) => self.with(key, json),
            None => self,
        }
    }

    /// The text, on one line.
    pub fn text(self) -> String {
        format!("{{{}}}", self.members)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_form_of_traces() {
        let texts = [1e21, 1e-7, 10.0, -0.0, 0.1, f64::NAN, f64::NEG_INFINITY].map(number);
        assert_eq!(
            texts,
            ["1e21", "1e-7", "10.0", "0.0", "0.1", "\"NaN\"", "\"-Infinity\""]
        );
    }

    #[test]
    fn objects_keep_their_order_and_escape_their_keys() {
        let object = Object::new()
            .with("z", "1")
            .with_some("y", None)
            .with("a\"", list(["2".to_owned()]));
        assert_eq!(object.text(), r#"{"z":1,"a\"":[2]}"#);
    }
}
