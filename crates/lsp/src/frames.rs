//! Frames of the protocol: a header with the number of bytes, then that many bytes of JSON. We read them ourselves,
//! because `lsp-server` accepts any length in a header.

use lsp_server::Message;
use std::fmt;
use std::io::{self, BufRead, Read, Write};

/// Largest number of bytes of a frame.
pub const FRAME_MOST: u64 = 64 << 20;

/// Largest number of bytes of a line of a header.
const LINE_MOST: u64 = 4096;

/// Largest number of lines of a header.
const LINES_MOST: usize = 16;

/// The reason why no further frame can be found.
#[derive(Debug)]
pub enum FrameError {
    /// The text in place of a header.
    Header(String),
    /// A header requests this number of bytes.
    TooLarge(u64),
    /// The input ended within a frame, or failed.
    Io(io::Error),
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Header(line) => write!(
                f,
                "{line:?} stands where a header of the Language Server Protocol belongs, such as `Content-Length: 42`"
            ),
            Self::TooLarge(bytes) => write!(
                f,
                "a header announces {bytes} bytes, more than the {FRAME_MOST} that a message may have"
            ),
            Self::Io(error) => write!(f, "standard input: {error}"),
        }
    }
}

impl std::error::Error for FrameError {}

/// The next frame's bytes; `None` at the end of the input.
fn frame(input: &mut impl BufRead) -> Result<Option<Vec<u8>>, FrameError> {
    let mut length = None;
    for lines in 0..LINES_MOST {
        let mut line = Vec::new();
        input
            .take(LINE_MOST)
            .read_until(b'\n', &mut line)
            .map_err(FrameError::Io)?;
        let text = String::from_utf8_lossy(&line);
        let shown = || text.chars().take(60).collect::<String>();
        match (text.trim_end(), lines) {
            _ if line.is_empty() && lines == 0 => return Ok(None),
            _ if !line.ends_with(b"\n") => return Err(FrameError::Header(shown())),
            ("", _) => {
                let length = length.ok_or_else(|| FrameError::Header(shown()))?;
                let mut bytes = Vec::new();
                let got = input
                    .take(length)
                    .read_to_end(&mut bytes)
                    .map_err(FrameError::Io)?;
                if (got as u64) < length {
                    return Err(FrameError::Io(io::ErrorKind::UnexpectedEof.into()));
                }
                return Ok(Some(bytes));
            }
            (line, _) => {
                let (name, value) = line.split_once(':').ok_or_else(|| FrameError::Header(shown()))?;
                if name.eq_ignore_ascii_case("Content-Length") {
                    let bytes = value.trim().parse().map_err(|_| FrameError::Header(shown()))?;
                    if bytes > FRAME_MOST {
                        return Err(FrameError::TooLarge(bytes));
                    }
                    length = Some(bytes);
                }
            }
        }
    }
    Err(FrameError::Header("a header without an end".to_owned()))
}

/// Reads messages until the input ends or `put` says that the receiver has gone. A frame without a message is answered
/// with the JSON-RPC error for it, and the next one is read.
pub(crate) fn read_all(input: &mut impl BufRead, put: impl Fn(Message) -> bool) -> Result<(), FrameError> {
    while let Some(bytes) = frame(input)? {
        match serde_json::from_slice(&bytes) {
            Ok(message) => {
                let over = matches!(&message, Message::Notification(it) if it.method == "exit");
                if !put(message) || over {
                    return Ok(());
                }
            }
            Err(error) => answer_to_nonsense(&error).map_err(FrameError::Io)?,
        }
    }
    Ok(())
}

fn answer_to_nonsense(error: &serde_json::Error) -> io::Result<()> {
    let code = if error.is_data() { -32600 } else { -32700 };
    let answer = serde_json::json!({
        "jsonrpc": "2.0",
        "id": null,
        "error": {"code": code, "message": format!("this is no message: {error}")},
    });
    let text = answer.to_string();
    let mut out = io::stdout().lock();
    write!(out, "Content-Length: {}\r\n\r\n{text}", text.len())?;
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<Option<Vec<u8>>, FrameError> {
        frame(&mut io::Cursor::new(bytes))
    }

    #[test]
    fn frames_are_as_long_as_their_header_says() {
        assert_eq!(read(b"").unwrap(), None);
        let two = b"Content-Type: x; charset=utf-8\r\ncontent-length: 2\r\n\r\n{}rest";
        assert_eq!(read(two).unwrap().unwrap(), b"{}");
        assert_eq!(read(b"Content-Length: 0\n\n").unwrap().unwrap(), b"");
    }

    #[test]
    fn what_is_no_frame_is_said() {
        for (bytes, wrong) in [
            (
                &b"GET / HTTP/1.1\r\n\r\n"[..],
                "\"GET / HTTP/1.1\\r\\n\" stands where a header",
            ),
            (b"\r\n", "stands where a header"),
            (b"Content-Length: -1\r\n\r\n", "stands where a header"),
            (
                b"Content-Length: 99999999999999\r\n\r\n",
                "99999999999999 bytes, more than the 67108864",
            ),
            (
                b"Content-Length: 5\r\n\r\n{}",
                "standard input: unexpected end of file",
            ),
            (b"Content-Length: 5", "stands where a header"),
            (b"\xFF\xFE\n", "stands where a header"),
        ] {
            let told = read(bytes).unwrap_err().to_string();
            assert!(told.contains(wrong), "{told}");
        }
        let endless = "a: b\r\n".repeat(100);
        assert!(read(endless.as_bytes()).is_err());
        let long = vec![b'a'; 1 << 20];
        assert!(read(&long).is_err());
    }
}
