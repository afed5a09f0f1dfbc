//! Bytes of files as text.

/// The text of a file that another program wrote: UTF-8, UTF-16 with a byte order mark, otherwise
/// Windows' Latin letters (old tools write `µs` and `°` in them). `None` if it is no text.
#[must_use]
pub fn decode(bytes: &[u8]) -> Option<String> {
    let text = match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes)?,
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes)?,
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => text.strip_prefix('\u{feff}').unwrap_or(text).to_owned(),
            Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
        },
    };
    (!text.contains('\0')).then_some(text)
}

fn utf16(bytes: &[u8], word: fn([u8; 2]) -> u16) -> Option<String> {
    let words = bytes.chunks(2).map(|pair| pair.try_into().ok().map(word));
    String::from_utf16(&words.collect::<Option<Vec<u16>>>()?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_encodings_of_common_tools_are_read() {
        for bytes in [
            &b"\xef\xbb\xbf\xc2\xb5s"[..],
            b"\xc2\xb5s",
            b"\xb5s",
            b"\xff\xfe\xb5\0s\0",
            b"\xfe\xff\0\xb5\0s",
        ] {
            assert_eq!(decode(bytes).as_deref(), Some("µs"), "{bytes:?}");
        }
        for bytes in [&b"PK\x03\x04\0\0"[..], b"\xff\xfe\xb5"] {
            assert_eq!(decode(bytes), None, "{bytes:?}");
        }
    }
}
