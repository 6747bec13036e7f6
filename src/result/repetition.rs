//! Comparison of a run with its repetition, byte for byte.

use std::io::{self, BufRead, Read as _};

/// Longest line in bytes; a longer one counts as several.
const LONGEST_LINE: u64 = 1 << 24;

/// One file of a run, or of its repetition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RepeatedFile {
    /// Its name.
    pub name: String,
    /// The result.
    pub outcome: Repeated,
}

/// The result for a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Repeated {
    /// The run and its repetition have the same bytes.
    Same,
    /// Both have it, with other bytes.
    Differs(LineDifference),
    /// It is missing from the run.
    Missing,
    /// Only the run has it.
    Extra,
}

/// Where two texts differ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LineDifference {
    /// Number of the first line that differs, from 1.
    pub line: u64,
    /// That line of the run with its line end; none if its text has ended.
    pub run: Option<Vec<u8>>,
    /// That line of the repetition.
    pub repetition: Option<Vec<u8>>,
    /// Number of lines that differ from the line of the same number.
    pub differing: u64,
    /// Number of lines of the longer text.
    pub lines: u64,
}

/// Compares the text of a run with that of its repetition, line by line; none if all bytes are the
/// same.
///
/// ```
/// use flexlink::result::line_difference;
/// let found = line_difference(&b"a\nb\nc\n"[..], &b"a\nB\n"[..])?.unwrap();
/// assert_eq!((found.line, found.differing, found.lines), (2, 2, 3));
/// assert_eq!(found.run.as_deref(), Some(&b"b\n"[..]));
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// Those of the readers.
pub fn line_difference(
    mut run: impl BufRead,
    mut repetition: impl BufRead,
) -> io::Result<Option<LineDifference>> {
    let mut found: Option<LineDifference> = None;
    let (mut a, mut b) = (Vec::new(), Vec::new());
    for line in 1.. {
        read_line(&mut run, &mut a)?;
        read_line(&mut repetition, &mut b)?;
        if a.is_empty() && b.is_empty() {
            break;
        }
        if let Some(found) = &mut found {
            found.differing += u64::from(a != b);
            found.lines = line;
        } else if a != b {
            let some = |text: &[u8]| (!text.is_empty()).then(|| text.to_vec());
            let (run, repetition) = (some(&a), some(&b));
            found = Some(LineDifference { line, run, repetition, differing: 1, lines: line });
        }
    }
    Ok(found)
}

/// Reads the next line with its end; nothing if the text has ended.
fn read_line(text: &mut impl BufRead, line: &mut Vec<u8>) -> io::Result<usize> {
    line.clear();
    text.take(LONGEST_LINE).read_until(b'\n', line)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn difference(run: &str, repetition: &str) -> Option<LineDifference> {
        line_difference(run.as_bytes(), repetition.as_bytes()).unwrap()
    }

    #[test]
    fn the_same_bytes_have_no_difference() {
        for text in ["", "a", "a\n", "a\n\nb\r\n"] {
            assert_eq!(difference(text, text), None);
        }
    }

    #[test]
    fn the_first_line_that_differs_is_told_and_all_are_counted() {
        let found = difference("a\nb\nc\nd\n", "a\nB\nc\nD\n").unwrap();
        assert_eq!((found.line, found.differing, found.lines), (2, 2, 4));
        assert_eq!(found.run.as_deref(), Some(&b"b\n"[..]));
        assert_eq!(found.repetition.as_deref(), Some(&b"B\n"[..]));
    }

    #[test]
    fn a_text_that_ends_early_or_without_a_line_end_differs() {
        let found = difference("a\n", "a\nb\nc\n").unwrap();
        assert_eq!((found.line, found.differing, found.lines), (2, 2, 3));
        assert_eq!((found.run, found.repetition.as_deref()), (None, Some(&b"b\n"[..])));
        let found = difference("a\nb\n", "a\nb").unwrap();
        assert_eq!((found.line, found.differing, found.lines), (2, 1, 2));
        let found = difference("a\r\n", "a\n").unwrap();
        assert_eq!(found.line, 1);
    }
}
