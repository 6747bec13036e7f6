//! Text of a table from its bytes: UTF-8, UTF-16 with its mark, or Windows-1252.

use std::borrow::Cow;

/// Letters of Windows-1252 from 0x80 to 0x9f; below and above it is Latin-1. `\0` stands for no letter.
const WINDOWS: [char; 32] = [
    '€', '\0', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\0', 'Ž', '\0', '\0', '‘',
    '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\0', 'ž', 'Ÿ',
];

/// Letter of Windows-1252; `None` for a byte that no text has.
fn letter(byte: u8) -> Option<char> {
    match byte {
        b'\t' | b'\n' | b'\r' | 0x0c => Some(char::from(byte)),
        0..0x20 | 0x7f => None,
        0x80..0xa0 => Some(WINDOWS[usize::from(byte - 0x80)]).filter(|letter| *letter != '\0'),
        _ => Some(char::from(byte)),
    }
}

/// Index of the first byte that belongs to no text in UTF-8, UTF-16 with its mark, or Windows-1252.
pub(super) fn first_foreign(bytes: &[u8]) -> Option<usize> {
    if mark_of_utf_16(bytes).is_some() {
        return None;
    }
    let nul = bytes.iter().position(|byte| *byte == 0);
    // The bytes may end inside a letter.
    let is_utf_8 =
        std::str::from_utf8(bytes).map_or_else(|error| error.error_len().is_none(), |_| true);
    let foreign = || bytes.iter().position(|byte| letter(*byte).is_none());
    nul.or_else(|| if is_utf_8 { None } else { foreign() })
}

/// True for the big end first; `None` without the mark of UTF-16.
fn mark_of_utf_16(bytes: &[u8]) -> Option<bool> {
    match bytes {
        [0xfe, 0xff, ..] => Some(true),
        [0xff, 0xfe, ..] => Some(false),
        _ => None,
    }
}

/// The text of bytes without a byte order mark, and the name of an encoding other than UTF-8; `None` for bytes that are no
/// text.
pub(super) fn decoded(bytes: &[u8]) -> Option<(Cow<'_, str>, Option<&'static str>)> {
    if let Some(is_big) = mark_of_utf_16(bytes) {
        let (pairs, rest) = bytes[2..].as_chunks::<2>();
        let unit = |pair: &[u8; 2]| {
            if is_big { u16::from_be_bytes(*pair) } else { u16::from_le_bytes(*pair) }
        };
        let letters = char::decode_utf16(pairs.iter().map(unit));
        let text: Option<String> = letters.map(Result::ok).collect();
        let text = text.filter(|text| rest.is_empty() && !text.contains('\0'))?;
        return Some((text.into(), Some("UTF-16")));
    }
    if let Ok(text) = std::str::from_utf8(bytes) {
        return Some((text.strip_prefix('\u{feff}').unwrap_or(text).into(), None));
    }
    let text: Option<String> = bytes.iter().map(|byte| letter(*byte)).collect();
    Some((text?.into(), Some("Windows-1252")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_text_is_read_from_three_encodings() {
        let text = "Prüfstand;Weg [µm];„x“ – 5 €\n";
        let of_windows = b"Pr\xfcfstand;Weg [\xb5m];\x84x\x93 \x96 5 \x80\n";
        let units: Vec<u16> = std::iter::once(0xfeff).chain(text.encode_utf16()).collect();
        let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
        let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
        let marked = format!("\u{feff}{text}");
        for (bytes, encoding) in [
            (text.as_bytes(), None),
            (marked.as_bytes(), None),
            (of_windows, Some("Windows-1252")),
            (&big, Some("UTF-16")),
            (&little, Some("UTF-16")),
        ] {
            assert_eq!(decoded(bytes), Some((text.into(), encoding)));
            assert_eq!(first_foreign(bytes), None);
        }
    }

    #[test]
    fn bytes_of_no_text_are_named() {
        for (bytes, at) in [
            (&b"time\n0\x001"[..], 6),
            (b"caf\xe9\x01", 4),
            (b"caf\xe9 \x81", 5),
            (b"\x89PNG\r\n\x1a\n", 6),
        ] {
            assert_eq!(first_foreign(bytes), Some(at), "{bytes:?}");
            assert!(at == 6 && bytes[0] == b't' || decoded(bytes).is_none(), "{bytes:?}");
        }
        assert_eq!(decoded(b"\xff\xfea"), None, "half a letter");
        assert_eq!(decoded(b"\xff\xfe\x00\xd8"), None, "half a pair");
    }
}
