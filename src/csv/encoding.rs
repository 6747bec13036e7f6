//! What a file seems to be that holds no text in UTF-8.

/// Bytes that are looked at: names of columns, or keys of a link file.
const HEAD: usize = 32;

/// What to do about bytes that are no UTF-8.
pub(crate) fn remedy(bytes: &[u8]) -> &'static str {
    disguise(bytes).unwrap_or("save the file as text in UTF-8")
}

/// What bytes seem to be, whether they are UTF-8 or not, and what to do about it.
pub(super) fn disguise(bytes: &[u8]) -> Option<&'static str> {
    const UTF_16: &str = "it seems to be UTF-16: save the file as text in UTF-8";
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") || is_utf_16(bytes) {
        return Some(UTF_16);
    }
    let known: [(&[u8], &str); 5] = [
        (b"PK\x03\x04", "it seems to be a spreadsheet or an archive: export the table as CSV"),
        (b"\xd0\xcf\x11\xe0", "it seems to be a spreadsheet: export the table as CSV"),
        (b"\x1f\x8b", "it seems to be compressed by gzip: unpack it first"),
        (b"\x28\xb5\x2f\xfd", "it seems to be compressed by zstd: unpack it first"),
        (b"\xfd7zXZ\0", "it seems to be compressed by xz: unpack it first"),
    ];
    known.into_iter().find(|(mark, _)| bytes.starts_with(mark)).map(|(_, remedy)| remedy)
}

/// Whether every other byte of the beginning is a NUL, as where letters take two bytes each.
fn is_utf_16(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD)];
    let (pairs, _) = head.as_chunks::<2>();
    let all = |is: fn(&[u8; 2]) -> bool| pairs.len() >= 2 && pairs.iter().all(is);
    all(|[low, high]| *low != 0 && *high == 0) || all(|[high, low]| *low != 0 && *high == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_and_zeros_are_in_no_disguise() {
        for bytes in [&b""[..], b"time,acceleration\n", "αβγδ".as_bytes(), &[0; 64], b"a\0b"] {
            assert_eq!(disguise(bytes), None, "{bytes:?}");
        }
    }

    #[test]
    fn two_bytes_a_letter_are_utf_16_with_and_without_a_mark() {
        for text in ["\u{feff}time,a\n", "time,a\n"] {
            let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
            let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
            assert!(disguise(&little).is_some_and(|remedy| remedy.contains("UTF-16")));
            assert!(disguise(&big).is_some_and(|remedy| remedy.contains("UTF-16")));
        }
    }
}
