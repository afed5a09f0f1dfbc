//! Names of files: URIs in the protocol, paths here.

use lsp_types::Uri;
use std::path::{Path, PathBuf};

/// The path of a `file:` URI; `None` for any other.
pub(crate) fn path(uri: &Uri) -> Option<PathBuf> {
    let rest = uri.as_str().strip_prefix("file://")?;
    // A host is before the first slash; ours is empty or `localhost`.
    let rest = rest.strip_prefix("localhost").unwrap_or(rest);
    if !rest.starts_with('/') {
        return None;
    }
    let mut bytes = Vec::new();
    let mut left = rest.bytes();
    while let Some(byte) = left.next() {
        bytes.push(match byte {
            b'%' => {
                let digit = |byte: Option<u8>| char::from(byte?).to_digit(16);
                let (high, low) = (digit(left.next())?, digit(left.next())?);
                (high * 16 + low) as u8
            }
            other => other,
        });
    }
    let text = String::from_utf8(bytes).ok()?;
    // `/c:/folder` on Windows.
    let drive = text.as_bytes().get(2) == Some(&b':') && cfg!(windows);
    let text = if drive { text.get(1..)? } else { &text };
    (!text.contains('\0')).then(|| PathBuf::from(text))
}

/// The `file:` URI of a path.
pub(crate) fn uri(path: &Path) -> Option<Uri> {
    let mut text = "file://".to_owned();
    let path = path.to_str()?.replace('\\', "/");
    if !path.starts_with('/') {
        text.push('/');
    }
    for byte in path.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                text.push(char::from(byte))
            }
            _ => text.push_str(&format!("%{byte:02X}")),
        }
    }
    text.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_go_to_uris_and_back() {
        for name in ["/home/me/cell.st", "/with space/ä%41#?.st"] {
            let there = uri(Path::new(name)).unwrap();
            assert_eq!(path(&there), Some(PathBuf::from(name)), "{}", there.as_str());
        }
        let local: Uri = "file://localhost/a.st".parse().unwrap();
        assert_eq!(path(&local), Some(PathBuf::from("/a.st")));
        for other in [
            "untitled:Untitled-1",
            "http://x/a.st",
            "file://host/a.st",
            "file:///%00",
        ] {
            assert_eq!(path(&other.parse().unwrap()), None, "{other}");
        }
    }
}
