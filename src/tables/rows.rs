use csv::{Reader, ReaderBuilder, StringRecord, Trim};

use super::table_error::{Place, TableError};

/// The rows of a CSV text, each with its line; comments and blank lines are passed over.
pub(super) struct Rows<'a> {
    file: &'a str,
    text: &'a str,
    reader: Reader<&'a [u8]>,
    record: StringRecord,
    /// Place up to which lines have been counted, in bytes.
    counted: usize,
    line: u64,
}

impl<'a> Rows<'a> {
    /// Takes the content of `file`, which must be UTF-8; a byte order mark is passed over.
    pub(super) fn new(file: &'a str, bytes: &'a [u8]) -> Result<Self, TableError> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let good = error.valid_up_to();
            let line = Some(1 + line_ends(bytes, 0, good));
            Place { file, line }
                .refuse("text", format!("byte 0x{:02x}", bytes[good]), "must be UTF-8")
                .with_hint("save the file as text in UTF-8".to_owned())
        })?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        check_line_ends(file, text)?;
        let reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        Ok(Self { file, text, reader, record: StringRecord::new(), counted: 0, line: 1 })
    }

    /// The next row's line and fields, trimmed; `None` after the last.
    pub(super) fn next(&mut self) -> Result<Option<(u64, Vec<&str>)>, TableError> {
        loop {
            match self.reader.read_record(&mut self.record) {
                Ok(false) => return Ok(None),
                Ok(true) => self.count_lines(),
                Err(error) => {
                    return Err(self.place().refuse("row", error.to_string(), "must be CSV"));
                }
            }
            let blank = self.record.len() == 1 && self.record[0].is_empty();
            if !blank {
                break;
            }
        }
        Ok(Some((self.line, self.record.iter().map(unquoted).collect())))
    }

    /// The row read last.
    fn place(&self) -> Place<'a> {
        Place { file: self.file, line: Some(self.line) }
    }

    /// Moves the line count to the row just read.
    ///
    /// The reader tells where it began to look for the row: before the comments, the blank lines
    /// and the rest of the line end that it then passed over.
    fn count_lines(&mut self) {
        let bytes = self.text.as_bytes();
        let looked_from = self.record.position().map_or(0, csv::Position::byte);
        let mut start = usize::try_from(looked_from).unwrap_or(bytes.len());
        loop {
            match bytes.get(start) {
                Some(b'\n' | b'\r') => start += 1,
                Some(b'#') => start += bytes[start..].iter().take_while(|&&b| b != b'\n').count(),
                _ => break,
            }
        }
        self.line += line_ends(bytes, self.counted, start);
        self.counted = start;
    }
}

/// Refuses a comment in a file whose lines end in CR alone: it would never end.
fn check_line_ends(file: &str, text: &str) -> Result<(), TableError> {
    let comments = text.split('\r').any(|line| line.starts_with('#'));
    if text.contains('\n') || !text.contains('\r') || !comments {
        return Ok(());
    }
    let must = "must be LF or CR LF where there are comments";
    let hint = "save the file with the line ends of Unix or Windows";
    Err(Place { file, line: Some(1) }.refuse("line end", "CR", must).with_hint(hint.to_owned()))
}

/// Number of line ends, LF, CR LF or CR, in `bytes[from..to]`.
fn line_ends(bytes: &[u8], from: usize, to: usize) -> u64 {
    let ends = |&k: &usize| match bytes[k] {
        b'\n' => true,
        b'\r' => bytes.get(k + 1) != Some(&b'\n'),
        _ => false,
    };
    (from..to).filter(ends).map(|_| 1).sum()
}

/// A field without the quotes that stay where a blank stands before them.
fn unquoted(field: &str) -> &str {
    let inner = field.strip_prefix('"').and_then(|f| f.strip_suffix('"'));
    inner.map_or(field, str::trim)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(text: &str) -> Vec<(u64, Vec<String>)> {
        let mut rows = Rows::new("t.csv", text.as_bytes()).unwrap();
        let mut all = Vec::new();
        while let Some((line, fields)) = rows.next().unwrap() {
            all.push((line, fields.into_iter().map(str::to_owned).collect()));
        }
        all
    }

    fn lines(text: &str) -> Vec<u64> {
        rows(text).into_iter().map(|(line, _)| line).collect()
    }

    #[test]
    fn lines_are_those_an_editor_shows() {
        assert_eq!(lines("a,b\n1,2\n3,4\n"), [1, 2, 3]);
        assert_eq!(lines("# c\n\n# d\na,b\n\n1,2\n#\n\n3,4"), [4, 6, 9]);
        assert_eq!(lines("\u{feff}# c\r\na,b\r\n\r\n1,2\r\n# x\r\n3,4\r\n"), [2, 4, 6]);
        assert_eq!(lines("a,b\r1,2\r3,4\r"), [1, 2, 3]);
        assert_eq!(lines("a,\"b\nc\"\n1,2\n  \n3,4\n"), [1, 3, 5]);
    }

    #[test]
    fn fields_are_trimmed_and_freed_of_quotes() {
        let expected = vec!["a".to_owned(), "b, c".to_owned(), "d".to_owned()];
        assert_eq!(rows(" a ,\"b, c\", \" d \"\n"), [(1, expected)]);
    }
}
