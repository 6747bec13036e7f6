use std::cell::OnceCell;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use sha2::{Digest as _, Sha256};
use thiserror::Error;

use super::memory::available_memory;

/// Longest line of an input in bytes: longer than in any table or link file, but soon reached by a
/// device or a file that is not text.
const LONGEST_LINE: usize = 1 << 24;

/// Longest link file, or file of tolerances, in bytes: some million segments.
const LONGEST_TOML: u64 = 1 << 28;

/// Bytes that are read at a time.
const CHUNK: usize = 1 << 20;

/// An input file, read whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputFile {
    /// The file as the user named it, for messages.
    pub shown: String,
    /// The file's own name, without its folder, for the record of a run.
    pub name: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// An input that cannot be read.
#[derive(Debug, Error)]
#[error("{shown}: cannot read: {}", system_words(cause))]
pub struct InputError {
    shown: String,
    cause: io::Error,
    hint: Option<&'static str>,
}

/// The system's text for an error, without the error's number.
pub fn system_words(cause: &io::Error) -> String {
    let text = cause.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}

impl InputError {
    pub(crate) fn new(shown: String, cause: io::Error) -> Self {
        Self { shown, cause, hint: None }
    }

    /// What the user may do.
    pub fn hint(&self) -> Option<&'static str> {
        self.hint
    }
}

impl InputFile {
    /// Reads a file, or standard input for `-`.
    ///
    /// # Errors
    /// [`InputError`] with the system's text; also if more than a megabyte begins with bytes that are not
    /// text, if a line is longer than 16 MiB, or if the content exceeds half the available memory.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        Self::read_within(path, u64::MAX)
    }

    /// Reads a link file or a file of tolerances, which are short.
    ///
    /// # Errors
    /// As [`InputFile::read`], and for more than 256 MiB.
    pub fn read_toml(path: &Path) -> Result<Self, InputError> {
        Self::read_within(path, LONGEST_TOML)
    }

    fn read_within(path: &Path, most: u64) -> Result<Self, InputError> {
        let standard_input = path.as_os_str() == "-";
        let shown =
            if standard_input { "standard input".to_owned() } else { path.display().to_string() };
        let read = if standard_input {
            read_whole(io::stdin().lock(), 0, most)
        } else {
            let opened = File::open(path).map_err(Unread::from);
            opened.and_then(|file| {
                let len = file.metadata().map_or(0, |about| about.len());
                read_whole(file, len, most)
            })
        };
        let bytes = match read {
            Ok(bytes) => bytes,
            Err(Unread { cause, hint }) => return Err(InputError { shown, cause, hint }),
        };
        let name = path.file_name().map_or_else(|| shown.clone(), |n| n.to_string_lossy().into());
        Ok(Self { shown, name, bytes })
    }

    /// The bytes as text.
    ///
    /// # Errors
    /// [`InputError`] if they are not UTF-8.
    pub fn text(&self) -> Result<&str, InputError> {
        std::str::from_utf8(&self.bytes).map_err(|error| {
            let cause = format!("not UTF-8 from byte {} on", error.valid_up_to() + 1);
            let error = InputError::new(self.shown.clone(), io::Error::other(cause));
            InputError { hint: Some(remedy(&self.bytes)), ..error }
        })
    }

    /// What to do about the file if it seems to be another format than text in UTF-8.
    pub fn disguise(&self) -> Option<&'static str> {
        disguise(&self.bytes)
    }

    /// SHA-256 of the bytes, in hexadecimal.
    pub fn sha256(&self) -> String {
        sha256(&self.bytes)
    }
}

/// SHA-256 of bytes, in hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// Why an input is not read.
#[derive(Debug)]
struct Unread {
    cause: io::Error,
    hint: Option<&'static str>,
}

impl From<io::Error> for Unread {
    fn from(cause: io::Error) -> Self {
        Self { cause, hint: None }
    }
}

impl Unread {
    fn because(cause: String) -> Self {
        io::Error::other(cause).into()
    }
}

/// Refuses a long input whose beginning is not text.
fn check_text(bytes: &[u8]) -> Result<(), Unread> {
    let nul = bytes.iter().position(|byte| *byte == 0);
    let foreign = std::str::from_utf8(bytes).err();
    // The beginning may end within a letter.
    let foreign = foreign.filter(|error| error.error_len().is_some());
    let foreign = foreign.map(|error| error.valid_up_to());
    match nul.into_iter().chain(foreign).min() {
        None => Ok(()),
        Some(at) => {
            let cause = format!("not a text file: byte {} is {:#04x}", at + 1, bytes[at]);
            Err(Unread { cause: io::Error::other(cause), hint: Some(remedy(bytes)) })
        }
    }
}

/// Most lines of an input: more than a period may have samples.
const MOST_LINES: usize = (1 << 24) + 1024;

/// Reads all of an input of about `len` bytes. Refuses it as soon as a line, the number of lines or the
/// content, `most` bytes, exceeds its bound: the input may never end.
fn read_whole(mut input: impl Read, len: u64, most: u64) -> Result<Vec<u8>, Unread> {
    let room = OnceCell::new();
    let mut bytes = Vec::new();
    // `len` may be huge without being true, as of a sparse file.
    bytes.reserve_exact(usize::try_from(len).unwrap_or(usize::MAX).min(LONGEST_LINE));
    let (mut lines, mut line_start) = (0_usize, 0);
    loop {
        let before = bytes.len();
        if input.by_ref().take(CHUNK as u64).read_to_end(&mut bytes)? == 0 {
            return Ok(bytes);
        }
        // For an input that ends within its first block, the reader of the table names the line.
        if before == CHUNK {
            check_text(&bytes[..CHUNK])?;
        }
        for (k, _) in bytes[before..].iter().enumerate().filter(|(_, b)| matches!(b, b'\n' | b'\r'))
        {
            (lines, line_start) = (lines + 1, before + k + 1);
        }
        if lines > MOST_LINES {
            return Err(Unread::because(format!("longer than {MOST_LINES} lines")));
        }
        if bytes.len() - line_start > LONGEST_LINE {
            let line = lines + 1;
            return Err(Unread::because(format!("line {line} is longer than 16 MiB")));
        }
        if bytes.len() <= LONGEST_LINE {
            continue;
        }
        if bytes.len() as u64 > most {
            return Err(Unread::because(format!("longer than {} MiB", most >> 20)));
        }
        // The numbers read from the text take as much again, and a growing vector takes twice its size
        // for a moment.
        let room = room.get_or_init(|| available_memory().map_or(u64::MAX, |bytes| bytes / 2));
        if bytes.len() as u64 > *room {
            let megabytes = room / 1_000_000;
            let cause = format!("more than {megabytes} MB, half of the memory that is available");
            return Err(Unread::because(cause));
        }
    }
}

/// Bytes as text, two digits each.
fn hexadecimal(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(2 * bytes.len());
    for byte in bytes {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
    }
    text
}

/// Bytes that show whether letters take two bytes.
const HEAD: usize = 32;

/// What to do about bytes that are not UTF-8.
pub(crate) fn remedy(bytes: &[u8]) -> &'static str {
    disguise(bytes).unwrap_or("save the file as text in UTF-8")
}

/// What the bytes seem to be if not a text in UTF-8, and what to do about it.
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

/// True if every other byte of the beginning is 0, as in UTF-16.
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
    fn fingerprints_are_those_of_the_standard() {
        let abc = InputFile { shown: "x".into(), name: "x".into(), bytes: b"abc".to_vec() };
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(abc.sha256(), expected);
    }

    #[test]
    fn a_missing_file_is_told_in_the_systems_words() {
        let error = InputFile::read(Path::new("no/such.toml")).unwrap_err();
        let text = error.to_string();
        let words = text.strip_prefix("no/such.toml: cannot read: ").unwrap();
        assert!(words.len() > 5 && !words.contains("os error"), "{text}");
    }

    #[test]
    fn an_input_without_end_that_is_no_text_is_told_from_its_first_block() {
        /// Counts what is read of a stream that never ends.
        struct Endless<'a>(&'a [u8], usize);
        impl Read for Endless<'_> {
            fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
                for byte in out.iter_mut() {
                    *byte = self.0[self.1 % self.0.len()];
                    self.1 += 1;
                }
                Ok(out.len())
            }
        }
        for (pattern, words) in [
            (&b"1,2\n\0"[..], "not a text file: byte 5 is 0x00"),
            (b"time,a\n\xff\xfe", "not a text file: byte 8 is 0xff"),
            (b"\0", "not a text file: byte 1 is 0x00"),
        ] {
            let mut endless = Endless(pattern, 0);
            let refused = read_whole(&mut endless, 0, u64::MAX).unwrap_err();
            assert_eq!(refused.cause.to_string(), words);
            assert!(endless.1 <= 2 * CHUNK, "{} bytes were read", endless.1);
        }
        // A letter may lie across the end of the block.
        let text = format!("#{}\n", "µ".repeat(CHUNK));
        assert_eq!(read_whole(text.as_bytes(), 0, u64::MAX).unwrap(), text.as_bytes());
    }

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
