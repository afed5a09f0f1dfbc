//! The answers of the server.

use http_body_util::Full;
use hyper::body::Bytes;
use hyper::header::{HeaderName, HeaderValue};
use hyper::{Response, StatusCode};
use serde_json::Value;
use standstill_trace::printable;

/// The headers of every answer. Its type is as declared, no other page may read or frame it, and the browser must
/// request it again each time.
const ALWAYS: [(&str, &str); 5] = [
    ("x-content-type-options", "nosniff"),
    ("cross-origin-resource-policy", "same-origin"),
    ("content-security-policy", "frame-ancestors 'none'"),
    ("referrer-policy", "no-referrer"),
    ("cache-control", "no-cache"),
];

/// An answer to a request.
pub struct Answer {
    status: u16,
    headers: Vec<(&'static str, String)>,
    body: Vec<u8>,
}

impl Answer {
    /// Bytes of this type.
    pub fn bytes(kind: &str, bytes: Vec<u8>) -> Self {
        Self {
            status: 200,
            headers: vec![("content-type", kind.to_owned())],
            body: bytes,
        }
    }

    /// JSON.
    pub fn json(value: &Value) -> Self {
        Self::bytes("application/json", value.to_string().into_bytes())
    }

    /// The requested page is at another path.
    pub fn elsewhere(path: &str) -> Self {
        plain(302, path).with("location", path.to_owned())
    }

    /// The requested page has not changed.
    pub fn unchanged(tag: &str) -> Self {
        Self {
            status: 304,
            ..Self::bytes("application/json", Vec::new())
        }
        .with("etag", tag.to_owned())
    }

    /// Adds a header; its name is in lower case.
    pub fn with(mut self, name: &'static str, value: String) -> Self {
        self.headers.push((name, value));
        self
    }

    /// The response in the form of the HTTP library.
    pub fn response(self) -> Response<Full<Bytes>> {
        let mut response = Response::new(Full::from(self.body));
        *response.status_mut() =
            StatusCode::from_u16(self.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let fixed = ALWAYS.iter().map(|(name, value)| (*name, (*value).to_owned()));
        for (name, value) in fixed.chain(self.headers) {
            // An invalid header value is left out; ours are all valid.
            if let Ok(value) = HeaderValue::try_from(value) {
                response
                    .headers_mut()
                    .append(HeaderName::from_static(name), value);
            }
        }
        response
    }
}

/// A line of text, for people.
pub fn plain(status: u16, text: &str) -> Answer {
    Answer {
        status,
        ..Answer::bytes(
            "text/plain; charset=utf-8",
            format!("{}\n", printable(text)).into_bytes(),
        )
    }
}
