//! Cells of CSV files.

/// A JSON value as a cell: a string as its text, `null` as nothing, anything else unchanged.
pub fn cell_of_json(json: &str) -> String {
    match serde_json::from_str(json) {
        Ok(serde_json::Value::String(text)) => cell(&text),
        Ok(serde_json::Value::Null) => String::new(),
        _ => cell(json),
    }
}

/// A text as a cell, in quotation marks where it needs them.
pub fn cell(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) || text.starts_with('#') {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_become_cells_of_their_own() {
        let ids = [r#""a,b""#, r#""say \"a\"""#, "null", "3", r#"{"a":1,"b":2}"#];
        let cells = ids.map(cell_of_json);
        assert_eq!(
            cells,
            ["\"a,b\"", "\"say \"\"a\"\"\"", "", "3", r#""{""a"":1,""b"":2}""#]
        );
    }
}
