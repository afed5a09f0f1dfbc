//! Links that contain a script, in the fragment of an address, which no browser sends to a server.

use crate::bounds::{BYTES_MAX, LINK_MAX};
use crate::project::refused;
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;
use serde_json::{Value, json};

/// The begin of a fragment: the version of its form, then a dot.
const VERSION: u32 = 1;

/// The level with the best compression.
const LEVEL: u8 = 10;

/// Packs an object into a link, or unpacks one: `{"pack": {..}}` is answered by `{"link": ".."}`,
/// `{"unpack": ".."}` by `{"content": {..}}`; a failure by `{"refused": ".."}`.
#[must_use]
pub fn share(request: &str) -> String {
    let answer = match serde_json::from_str::<Value>(request) {
        Ok(Value::Object(members)) => match (members.get("pack"), members.get("unpack")) {
            (Some(content @ Value::Object(_)), None) => packed(content).map(|link| json!({"link": link})),
            (None, Some(Value::String(link))) => unpacked(link).map(|content| json!({"content": content})),
            _ => Err("`pack` with an object or `unpack` with a text is needed".to_owned()),
        },
        _ => Err("an object is needed".to_owned()),
    };
    answer.unwrap_or_else(|why| refused(&why)).to_string()
}

fn packed(content: &Value) -> Result<String, String> {
    let text = content.to_string();
    if text.len() > BYTES_MAX {
        return Err(format!(
            "{} bytes are more than the {BYTES_MAX} of a link",
            text.len()
        ));
    }
    let link = format!(
        "{VERSION}.{}",
        URL_SAFE_NO_PAD.encode(compress_to_vec(text.as_bytes(), LEVEL))
    );
    check_length(&link)?;
    Ok(link)
}

fn check_length(link: &str) -> Result<(), String> {
    match link.len() {
        0..=LINK_MAX => Ok(()),
        len => Err(format!(
            "a link of {len} characters is more than the {LINK_MAX} that are read"
        )),
    }
}

fn unpacked(link: &str) -> Result<Value, String> {
    let broken = || "this link is broken: it was cut short or altered on its way".to_owned();
    check_length(link)?;
    let (version, rest) = link.split_once('.').ok_or_else(broken)?;
    let version: u32 = version.parse().map_err(|_| broken())?;
    if version > VERSION {
        return Err(format!(
            "this link was made by a later version (form {version}, this page reads {VERSION}); reload the page, or open it where the link was made"
        ));
    }
    let bytes = URL_SAFE_NO_PAD.decode(rest).map_err(|_| broken())?;
    let text = decompress_to_vec_with_limit(&bytes, BYTES_MAX).map_err(|_| broken())?;
    match serde_json::from_slice(&text) {
        Ok(content @ Value::Object(_)) => Ok(content),
        _ => Err(broken()),
    }
}
