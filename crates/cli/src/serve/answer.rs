//! What is sent back.

use serde_json::Value;
use standstill_trace::printable;
use std::fs::File;
use std::io::{Cursor, Read};
use tiny_http::{Header, Response, StatusCode};

/// What holds for every answer: it is what it says it is, no other page may read or frame it, and the next time it is asked for anew.
const ALWAYS: [(&str, &str); 5] = [
    ("X-Content-Type-Options", "nosniff"),
    ("Cross-Origin-Resource-Policy", "same-origin"),
    ("Content-Security-Policy", "frame-ancestors 'none'"),
    ("Referrer-Policy", "no-referrer"),
    ("Cache-Control", "no-cache"),
];

/// An answer to a request.
pub struct Answer {
    status: u16,
    headers: Vec<(&'static str, String)>,
    body: Box<dyn Read + Send>,
    length: usize,
}

impl Answer {
    /// Bytes of this type.
    pub fn bytes(kind: &str, bytes: Vec<u8>) -> Self {
        Self {
            status: 200,
            headers: vec![("Content-Type", kind.to_owned())],
            length: bytes.len(),
            body: Box::new(Cursor::new(bytes)),
        }
    }

    /// An open file of this type and length.
    pub fn file(kind: &str, file: File, length: usize) -> Self {
        Self {
            length,
            // A file that grows on the way is cut: its length was promised.
            body: Box::new(file.take(length as u64)),
            ..Self::bytes(kind, Vec::new())
        }
    }

    /// JSON.
    pub fn json(value: &Value) -> Self {
        Self::bytes("application/json", value.to_string().into_bytes())
    }

    /// What was asked for stands at another path.
    pub fn elsewhere(path: &str) -> Self {
        Self {
            status: 302,
            ..plain(302, path)
        }
        .with("Location", path.to_owned())
    }

    /// What was asked for is as it was.
    pub fn unchanged(tag: &str) -> Self {
        Self {
            status: 304,
            ..Self::bytes("application/json", Vec::new())
        }
        .with("ETag", tag.to_owned())
    }

    /// With one more header.
    pub fn with(mut self, name: &'static str, value: String) -> Self {
        self.headers.push((name, value));
        self
    }

    /// As the server sends it.
    pub fn response(self) -> Response<Box<dyn Read + Send>> {
        let fixed = ALWAYS.iter().map(|(name, value)| (*name, (*value).to_owned()));
        let headers = fixed.chain(self.headers).filter_map(|(name, value)| {
            // A value that no header may have is left out; of ours none is.
            Header::from_bytes(name, value).ok()
        });
        let status = StatusCode(self.status);
        Response::new(status, headers.collect(), self.body, Some(self.length), None)
            .with_chunked_threshold(usize::MAX)
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
