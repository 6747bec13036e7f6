//! Input files, read whole and within bounds, and errors that name the line of a table.

use std::cell::OnceCell;
use std::fmt::Write as _;
use std::fs::File;
use std::io::Read;
use std::path::{Component, Path};
use std::{fs, io};

use sha2::{Digest as _, Sha256};
use thiserror::Error;

use super::encoding::first_foreign;
use crate::system::available_memory;
use crate::text::{excerpt, visible};

/// Longest line of an input in bytes: longer than in any table or link file, but soon reached by a device or a file
/// that is not text.
const LONGEST_LINE: usize = 1 << 24;

/// Largest link file, or file of tolerances, in bytes: some million segments.
const LONGEST_TOML: u64 = 1 << 28;

/// Number of bytes in one read.
const CHUNK: usize = 1 << 20;

/// An input file, read whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputFile {
    /// The file as the user named it, for messages.
    pub shown: String,
    /// Name of the file without its folder, for the record of a run.
    pub name: String,
    /// Content of the file.
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

/// The system's text for an error, without its number.
pub fn system_words(cause: &io::Error) -> String {
    let text = cause.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}

impl InputError {
    pub(crate) fn new(shown: String, cause: io::Error) -> Self {
        Self { shown, cause, hint: None }
    }

    /// Error with a cause in words of this program.
    fn because(shown: &str, cause: String, hint: Option<&'static str>) -> Self {
        Self { hint, ..Self::new(shown.to_owned(), io::Error::other(cause)) }
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        self.hint
    }
}

impl InputFile {
    /// Reads a file, or standard input for `-`.
    ///
    /// # Errors
    /// [`InputError`] with the system's text; also for more than a megabyte that does not begin with text, for a line
    /// longer than 16 MiB, and for content beyond half the available memory.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        Self::read_within(path, u64::MAX)
    }

    /// Reads a link file or a file of tolerances, which are short.
    ///
    /// # Errors
    /// Those of [`InputFile::read`]; also more than 256 MiB.
    pub fn read_toml(path: &Path) -> Result<Self, InputError> {
        Self::read_within(path, LONGEST_TOML)
    }

    /// Reads a file named in another file, in its folder or below.
    ///
    /// # Errors
    /// Those of [`InputFile::read`]; also a name that leads elsewhere, and anything but a file, such as a pipe.
    pub fn read_beside(file: &Path, name: &str) -> Result<Self, InputError> {
        let path = file.with_file_name(name);
        let shown = path.display().to_string();
        let is_below = |part: Component| matches!(part, Component::Normal(_) | Component::CurDir);
        if !Path::new(name).components().all(is_below) {
            let cause = format!("must be in the folder of {} or below", file.display());
            return Err(InputError::because(&shown, cause, Some("move the file there")));
        }
        // Opening a pipe would wait for its writer.
        let about = fs::metadata(&path).map_err(|cause| InputError::new(shown.clone(), cause))?;
        if !about.is_file() {
            return Err(InputError::because(&shown, "must be a file".to_owned(), None));
        }
        Self::read(&path)
    }

    fn read_within(path: &Path, most: u64) -> Result<Self, InputError> {
        let is_standard_input = path.as_os_str() == "-";
        let shown = if is_standard_input {
            "standard input".to_owned()
        } else {
            path.display().to_string()
        };
        let bytes = if is_standard_input {
            read_whole(&shown, io::stdin().lock(), 0, most)?
        } else {
            let file = File::open(path).map_err(|cause| InputError::new(shown.clone(), cause))?;
            let len = file.metadata().map_or(0, |about| about.len());
            read_whole(&shown, file, len, most)?
        };
        let name = path.file_name().map_or_else(|| shown.clone(), |n| n.to_string_lossy().into());
        Ok(Self { shown, name, bytes })
    }

    /// Content as text.
    ///
    /// # Errors
    /// [`InputError`] if it is not UTF-8.
    pub fn text(&self) -> Result<&str, InputError> {
        std::str::from_utf8(&self.bytes).map_err(|error| {
            let cause = format!("not UTF-8 from byte {} on", error.valid_up_to() + 1);
            InputError::because(&self.shown, cause, Some(remedy(&self.bytes)))
        })
    }

    /// Remedy for a file that seems to have another format than text in UTF-8.
    pub fn disguise(&self) -> Option<&'static str> {
        disguise(&self.bytes)
    }

    /// SHA-256 of the content, in hexadecimal.
    pub fn sha256(&self) -> String {
        sha256(&self.bytes)
    }
}

/// SHA-256 of bytes, in hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// Refuses a long input whose beginning is not text.
fn check_text(shown: &str, bytes: &[u8]) -> Result<(), InputError> {
    first_foreign(bytes).map_or(Ok(()), |at| {
        let cause = format!("not a text file: byte {} is {:#04x}", at + 1, bytes[at]);
        Err(InputError::because(shown, cause, Some(remedy(bytes))))
    })
}

/// Largest number of lines of an input: more than the samples of any period.
const MOST_LINES: usize = (1 << 24) + 1024;

/// Reads all of an input of about `len` bytes. It refuses the input as soon as a line, the number of lines or the
/// content exceeds its bound, `most` bytes for the content, because the input may never end.
fn read_whole(
    shown: &str,
    mut input: impl Read,
    len: u64,
    most: u64,
) -> Result<Vec<u8>, InputError> {
    let refuse = |cause: String| Err(InputError::because(shown, cause, None));
    let room = OnceCell::new();
    let mut bytes = Vec::new();
    // `len` may be huge but untrue, as for a sparse file.
    bytes.reserve_exact(usize::try_from(len).unwrap_or(usize::MAX).min(LONGEST_LINE));
    let (mut lines, mut line_start) = (0_usize, 0);
    loop {
        let before = bytes.len();
        let read = input.by_ref().take(CHUNK as u64).read_to_end(&mut bytes);
        if read.map_err(|cause| InputError::new(shown.to_owned(), cause))? == 0 {
            return Ok(bytes);
        }
        // For an input that ends within its first block, the reader of the table names the line.
        if before == CHUNK {
            check_text(shown, &bytes[..CHUNK])?;
        }
        for (k, byte) in bytes.iter().enumerate().skip(before) {
            if matches!(byte, b'\n' | b'\r') {
                (lines, line_start) = (lines + 1, k + 1);
            }
        }
        if lines > MOST_LINES {
            return refuse(format!("longer than {MOST_LINES} lines"));
        }
        if bytes.len() - line_start > LONGEST_LINE {
            return refuse(format!("line {} is longer than 16 MiB", lines + 1));
        }
        if bytes.len() <= LONGEST_LINE {
            continue;
        }
        if bytes.len() as u64 > most {
            return refuse(format!("longer than {} MiB", most >> 20));
        }
        // The numbers read from the text need as much again, and a growing vector briefly needs twice its size.
        let room = *room.get_or_init(|| available_memory().map_or(u64::MAX, |bytes| bytes / 2));
        if bytes.len() as u64 > room {
            let megabytes = room / 1_000_000;
            return refuse(format!(
                "more than {megabytes} MB, half of the memory that is available"
            ));
        }
    }
}

/// Number of bytes that show whether letters take two bytes.
const HEAD: usize = 32;

/// Remedy for bytes that are not UTF-8.
pub(super) fn remedy(bytes: &[u8]) -> &'static str {
    disguise(bytes).unwrap_or("save the file as text in UTF-8")
}

/// Apparent format of bytes that are not a text in UTF-8, with a remedy.
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

/// Error in a CSV file.
///
/// The text reads `traj.csv:17: displacement = nan, but must be a finite number`.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{place}: {message}")]
pub struct TableError {
    /// The file, and the faulty line if there is one.
    place: String,
    message: String,
    hint: Option<String>,
}

impl TableError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&str> {
        self.hint.as_deref()
    }

    /// Sets the hint.
    pub(crate) fn with_hint(self, hint: impl Into<Option<String>>) -> Self {
        let hint = hint.into().map(|hint| visible(&hint).into_owned());
        Self { hint, ..self }
    }

    /// Adapts the error to a table without options of the reader: removes mentions of options.
    pub(super) fn of_named_file(self, hint: &str) -> Self {
        let message = ["columns", "scale", "unit"]
            .iter()
            .fold(self.message, |text, key| text.replace(&format!("--{key}"), key));
        let speaks_of_option = self.hint.as_deref().is_some_and(|hint| hint.contains("--"));
        let is_of_unit = message.contains("unit of") || message.contains("unit in brackets");
        // A hint about the required unit helps here too, as does any other hint without an option.
        let helps = |own: &String| !speaks_of_option && (own.starts_with("write ") || !is_of_unit);
        let own = self.hint.filter(helps);
        let hint = match own {
            None if speaks_of_option || is_of_unit => Some(hint.to_owned()),
            own => own,
        };
        Self { place: self.place, message, hint }
    }

    /// Sets the hint unless the error has one.
    pub(crate) fn or_hint(self, hint: String) -> Self {
        let hint = self.hint.clone().or(Some(hint));
        self.with_hint(hint)
    }
}

/// Remedy for a file without options of the reader, for hints.
pub(super) const BY_HEADINGS: &str =
    "this file is read by its headings alone: correct its names, with units in brackets";

/// Place in a file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place<'a> {
    /// The file, as the user named it.
    pub(crate) file: &'a str,
    /// Line from 1; `None` for the whole file.
    pub(crate) line: Option<u64>,
}

impl Place<'_> {
    /// Error with the text *place: subject = found, but must*.
    pub(crate) fn refuse(
        &self,
        subject: impl Into<String>,
        found: impl Into<String>,
        must: impl Into<String>,
    ) -> TableError {
        let message = format!("{} = {}, but {}", subject.into(), found.into(), must.into());
        self.refuse_whole(&message)
    }

    /// Error with the text *place: column N = "name", but must*; `number` counts columns from 0.
    pub(crate) fn refuse_column(
        &self,
        number: usize,
        name: &str,
        must: impl Into<String>,
    ) -> TableError {
        self.refuse(format!("column {}", number + 1), quoted(name), must)
    }

    /// Refuses a row with another number of fields than columns.
    pub(crate) fn check_width(self, fields: usize, columns: usize) -> Result<(), TableError> {
        if fields == columns {
            return Ok(());
        }
        let must = format!("must be {columns}, as many as there are columns");
        Err(self.refuse("fields", fields.to_string(), must))
    }

    /// Error with the text *place: message*. Control characters are escaped, because a message may name columns of the
    /// file.
    pub(crate) fn refuse_whole(&self, message: &str) -> TableError {
        let place = match self.line {
            Some(line) => format!("{}:{line}", self.file),
            None => self.file.to_owned(),
        };
        TableError { place, message: visible(message).into_owned(), hint: None }
    }
}

/// A quoted excerpt of the file for a message, with escaped control characters.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", excerpt(text).escape_debug())
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
        /// Counts the bytes read from an endless stream.
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
            (b"time,a\n\xff\x81", "not a text file: byte 9 is 0x81"),
            (b"\0", "not a text file: byte 1 is 0x00"),
        ] {
            let mut endless = Endless(pattern, 0);
            let refused = read_whole("x", &mut endless, 0, u64::MAX).unwrap_err();
            assert_eq!(refused.cause.to_string(), words);
            assert!(endless.1 <= 2 * CHUNK, "{} bytes were read", endless.1);
        }
        // A letter may lie across the end of the block.
        let text = format!("#{}\n", "µ".repeat(CHUNK));
        assert_eq!(read_whole("x", text.as_bytes(), 0, u64::MAX).unwrap(), text.as_bytes());
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
