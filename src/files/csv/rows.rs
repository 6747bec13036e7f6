//! Rows of CSV text with their lines, and tables of any numbers and words.

use std::borrow::Cow;

use csv::{ReaderBuilder, StringRecord, Trim};

use super::dialect::Dialect;
use super::encoding::decoded;
use super::format::{Decimal, TableFormat};
use super::heading::check_separator;
use super::input::{Place, TableError, disguise, quoted, remedy, sha256};
use super::unit_name::in_brackets;
use crate::compare::{Cell, Table, TableColumn};

/// Reads the CSV text `bytes` of `file`: `first` makes a value from the first row, `next` updates it with each further
/// row. `None` for a text without rows.
///
/// Both receive the line of the row and its trimmed fields; comments, blank lines and a byte order mark are skipped.
/// Commas divide the fields.
///
/// # Errors
/// Those of `first` and `next`, and [`TableError`] for text that is not UTF-8 or not CSV.
pub(crate) fn read_rows<T>(
    file: &str,
    bytes: &[u8],
    first: impl Fn(u64, &[&str]) -> Result<T, TableError>,
    next: impl Fn(&mut T, u64, &[&str]) -> Result<(), TableError>,
) -> Result<Option<T>, TableError> {
    utf8(file, bytes)?;
    let first = |_: &Dialect, line, fields: &[&str]| first(line, fields);
    read_rows_as(file, bytes, |_| Ok(Dialect::default()), first, next)
}

/// [`read_rows`] for a text in the dialect that `detect` finds; decimal commas become points.
///
/// # Errors
/// Those of [`read_rows`] and of `detect`.
pub(super) fn read_rows_as<T>(
    file: &str,
    bytes: &[u8],
    detect: impl Fn(&str) -> Result<Dialect, TableError>,
    first: impl Fn(&Dialect, u64, &[&str]) -> Result<T, TableError>,
    next: impl Fn(&mut T, u64, &[&str]) -> Result<(), TableError>,
) -> Result<Option<T>, TableError> {
    let mut table = None;
    let mut read = || {
        let Some((text, encoding)) = decoded(bytes) else { return utf8(file, bytes).map(|_| ()) };
        let text = &*text;
        check_line_ends(file, text)?;
        let mut dialect = detect(text)?;
        dialect.found.extend(encoding.map(|name| format!("{name} as encoding")));
        dialect.found.rotate_right(usize::from(encoding.is_some()));
        if let Some((line, names)) = &dialect.names {
            let fields: Vec<&str> = names.iter().map(String::as_str).collect();
            table = Some(first(&dialect, *line, &fields)?);
        }
        each_row(file, text, &dialect, |line, fields| {
            match &mut table {
                None => table = Some(first(&dialect, line, fields)?),
                Some(table) => next(table, line, fields)?,
            }
            Ok(())
        })
    };
    read().map_err(|error| match disguise(bytes) {
        Some(remedy) => error.with_hint(remedy.to_owned()),
        None => error,
    })?;
    Ok(table)
}

/// The text of a file.
///
/// # Errors
/// [`TableError`] names the line of the first byte that is not UTF-8.
pub(crate) fn utf8<'a>(file: &str, bytes: &'a [u8]) -> Result<&'a str, TableError> {
    std::str::from_utf8(bytes).map_err(|error| {
        let good = error.valid_up_to();
        let line = Some(1 + line_ends(bytes, 0, good));
        Place { file, line }
            .refuse("text", format!("byte 0x{:02x}", bytes[good]), "must be UTF-8")
            .with_hint(remedy(bytes).to_owned())
    })
}

/// Takes every row after the lines that the dialect skips.
fn each_row(
    file: &str,
    text: &str,
    dialect: &Dialect,
    mut take: impl FnMut(u64, &[&str]) -> Result<(), TableError>,
) -> Result<(), TableError> {
    let body = &text[dialect.start..];
    let take = |line: u64, fields: &[&str]| {
        let line = line + dialect.lines;
        match dialect.decimal {
            Decimal::Point => take(line, fields),
            Decimal::Comma => {
                let place = Place { file, line: Some(line) };
                let points = fields.iter().map(|field| with_point(field, place));
                let points = points.collect::<Result<Vec<_>, _>>()?;
                take(line, &points.iter().map(AsRef::as_ref).collect::<Vec<_>>())
            }
        }
    };
    match dialect.delimiter.byte() {
        None => each_blank_row(file, body, take),
        Some(b',') if is_plain(body) => each_plain_row::<b','>(body, take),
        Some(b';') if is_plain(body) => each_plain_row::<b';'>(body, take),
        Some(b'\t') if is_plain(body) => each_plain_row::<b'\t'>(body, take),
        Some(byte) => each_quoted_row(file, body, byte, take),
    }
}

/// Rewrites a number with a decimal comma with a point; other fields stay unchanged.
fn with_point<'a>(field: &'a str, place: Place) -> Result<Cow<'a, str>, TableError> {
    if !field.contains(['.', ',']) {
        return Ok(field.into());
    }
    if field.parse::<f64>().is_ok() {
        let error = place.refuse("field", quoted(field), "must have a comma before its decimals");
        let hint = "use --decimal point to read points; write nothing between thousands";
        return Err(error.with_hint(hint.to_owned()));
    }
    let point = field.replace(',', ".");
    let is_number = !field.contains('.') && point.parse::<f64>().is_ok();
    Ok(if is_number { point.into() } else { field.into() })
}

/// True if every line feed ends a line and every delimiter a field: reading such text is several times faster.
fn is_plain(text: &str) -> bool {
    !text.as_bytes().contains(&b'"') && !has_lone_return(text)
}

/// True if a carriage return is not followed by a line feed.
fn has_lone_return(text: &str) -> bool {
    let lone = |k: usize| text.as_bytes().get(k + 1) != Some(&b'\n');
    text.match_indices('\r').any(|(k, _)| lone(k))
}

fn each_plain_row<const DELIMITER: u8>(
    text: &str,
    mut take: impl FnMut(u64, &[&str]) -> Result<(), TableError>,
) -> Result<(), TableError> {
    let mut fields = Vec::new();
    for (line, row) in (1..).zip(text.split('\n')) {
        if row.starts_with('#') || row.trim().is_empty() {
            continue;
        }
        fields.clear();
        let mut start = 0;
        for (place, byte) in row.bytes().enumerate() {
            if byte == DELIMITER {
                fields.push(row[start..place].trim());
                start = place + 1;
            }
        }
        fields.push(row[start..].trim());
        take(line, &fields)?;
    }
    Ok(())
}

/// Takes the rows of a text with blanks between its fields.
fn each_blank_row(
    file: &str,
    text: &str,
    mut take: impl FnMut(u64, &[&str]) -> Result<(), TableError>,
) -> Result<(), TableError> {
    if has_lone_return(text) {
        return Err(returns(file, "must be LF or CR LF where blanks divide the fields"));
    }
    for (line, row) in (1..).zip(text.split('\n')) {
        if !(row.starts_with('#') || row.trim().is_empty()) {
            take(line, &in_brackets(row))?;
        }
    }
    Ok(())
}

fn each_quoted_row(
    file: &str,
    text: &str,
    delimiter: u8,
    mut take: impl FnMut(u64, &[&str]) -> Result<(), TableError>,
) -> Result<(), TableError> {
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(Trim::All)
        .comment(Some(b'#'))
        .delimiter(delimiter)
        .from_reader(text.as_bytes());
    let mut record = StringRecord::new();
    let (mut counted, mut line) = (0, 1);
    loop {
        let is_row = reader.read_record(&mut record).map_err(|error| {
            let place = Place { file, line: Some(line) };
            place.refuse("row", error.to_string(), "must be CSV")
        })?;
        if !is_row {
            return Ok(());
        }
        let start = start_of(&record, text.as_bytes());
        line += line_ends(text.as_bytes(), counted, start);
        counted = start;
        if record.len() > 1 || !record[0].is_empty() {
            let fields: Vec<&str> = record.iter().map(unquoted).collect();
            take(line, &fields)?;
        }
    }
}

/// Index in `bytes` of the start of a row. The record's position precedes the comments, blank lines and line ends that
/// the reader skipped.
fn start_of(record: &StringRecord, bytes: &[u8]) -> usize {
    let looked_from = record.position().map_or(0, csv::Position::byte);
    let mut start = usize::try_from(looked_from).unwrap_or(bytes.len());
    loop {
        match bytes.get(start) {
            Some(b'\n' | b'\r') => start += 1,
            Some(b'#') => start += bytes[start..].iter().take_while(|&&b| b != b'\n').count(),
            _ => return start,
        }
    }
}

/// Refuses comments in a file with CR line ends, because the reader ends a comment only at LF.
fn check_line_ends(file: &str, text: &str) -> Result<(), TableError> {
    let comments = text.split('\r').any(|line| line.starts_with('#'));
    if text.contains('\n') || !text.contains('\r') || !comments {
        return Ok(());
    }
    Err(returns(file, "must be LF or CR LF where there are comments"))
}

/// Error for line ends of the old Macintosh.
fn returns(file: &str, must: &str) -> TableError {
    let hint = "save the file with the line ends of Unix or Windows";
    Place { file, line: Some(1) }.refuse("line end", "CR", must).with_hint(hint.to_owned())
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

/// Removes quotes that the reader leaves after a blank.
fn unquoted(field: &str) -> &str {
    let inner = field.strip_prefix('"').and_then(|f| f.strip_suffix('"'));
    inner.map_or(field, str::trim)
}

/// Name of the last column of an unfinished sweep: the first digits of the SHA-256 of the row before it, which reveal a
/// changed number.
pub(crate) const CHECK: &str = "check";

const CHECK_DIGITS: usize = 8;

/// Adds a check to the end of each row; an incomplete row gets none.
pub fn checked_rows(rows: &str) -> String {
    let checked = |row: &str| match row.strip_suffix('\n') {
        Some(row) => format!("{row},{}\n", check_of(row)),
        None => row.to_owned(),
    };
    rows.split_inclusive('\n').map(checked).collect()
}

/// Names of the columns of checked rows, with the line end.
pub fn checked_header(header: &str) -> String {
    format!("{},{CHECK}\n", header.trim_end())
}

/// Removes the last column, the check, from all lines.
pub(crate) fn without_checks(text: &str) -> String {
    text.lines()
        .flat_map(|line| [line.rsplit_once(',').map_or(line, |(row, _)| row), "\n"])
        .collect()
}

fn check_of(row: &str) -> String {
    let mut digits = sha256(row.as_bytes());
    digits.truncate(CHECK_DIGITS);
    digits
}

/// Refuses a row whose check does not match its content.
pub(crate) fn check_content(row: &str, check: &str, place: Place) -> Result<(), TableError> {
    let must = check_of(row);
    if check == must {
        return Ok(());
    }
    Err(place.refuse(CHECK, quoted(check), format!("must be {} for this row", quoted(&must))))
}

/// Reads any CSV table: a row of names, then rows of numbers or words, `#` before comments.
///
/// If the first row has only numbers, it is data, and the columns are called `column 1`, `column 2` and so on; so is a
/// column without a name. Errors call the file `name`.
///
/// # Errors
/// [`TableError`] names the line of a row with another number of fields than columns, of a repeated name, and of text
/// that is not CSV in UTF-8; an empty table is an error, too.
pub fn read_table(name: &str, bytes: &[u8]) -> Result<Table, TableError> {
    let whole = Place { file: name, line: None };
    let at = |line| Place { line: Some(line), ..whole };
    let table = read_rows(
        name,
        bytes,
        |line, fields| begun(fields, line, at(line)),
        |table, line, fields| push(table, fields, line, at(line)),
    )?;
    let table: Table = table.ok_or_else(|| {
        whole.refuse_whole("has no rows, but must hold a row of names or of numbers")
    })?;
    if let ([column], [line, ..]) = (&table.columns[..], &table.lines[..])
        && column.text(0).split_whitespace().filter(|word| word.parse::<f64>().is_ok()).count() > 1
    {
        let row = quoted(&column.text(0));
        return Err(at(*line).refuse("row", row, "must have commas between its fields"));
    }
    Ok(table)
}

/// [`read_table`] with the user's options for its form; also returns its deviations from the standard form.
///
/// # Errors
/// Those of [`read_table`]; also an ambiguous form.
pub(super) fn read_table_as(
    name: &str,
    bytes: &[u8],
    format: &TableFormat,
) -> Result<(Table, Vec<String>), TableError> {
    let whole = Place { file: name, line: None };
    let at = |line| Place { line: Some(line), ..whole };
    let begin = |dialect: &Dialect, line, fields: &[&str]| {
        let table = match dialect.names {
            Some(_) => columns(fields, at(line))?,
            None => begun(fields, line, at(line))?,
        };
        Ok((table, dialect.found.clone()))
    };
    let detect = |text: &str| Dialect::detect(name, text, format);
    let next =
        |(table, _): &mut (Table, _), line, fields: &[&str]| push(table, fields, line, at(line));
    let read = read_rows_as(name, bytes, detect, begin, next)?;
    read.ok_or_else(|| {
        whole.refuse_whole("has no rows, but must hold a row of names or of numbers")
    })
}

/// Starts a table with its first row, of names or of numbers.
fn begun(fields: &[&str], line: u64, place: Place) -> Result<Table, TableError> {
    check_separator(fields, place)?;
    if fields.iter().any(|field| field.parse::<f64>().is_err()) {
        return columns(fields, place);
    }
    let mut table = columns(&vec![""; fields.len()], place)?;
    push(&mut table, fields, line, place)?;
    Ok(table)
}

/// A table of these columns without rows.
fn columns(names: &[&str], place: Place) -> Result<Table, TableError> {
    let mut table = Table::default();
    for (index, name) in names.iter().enumerate() {
        let number = format!("column {}", index + 1);
        let own = if name.is_empty() { &number } else { *name };
        if let Some(earlier) = table.names().position(|earlier| earlier == own) {
            let must = format!("must not repeat column {}", earlier + 1);
            return Err(place.refuse(number.as_str(), quoted(own), must));
        }
        table.columns.push(TableColumn::new(own.to_owned()));
    }
    Ok(table)
}

fn push(table: &mut Table, fields: &[&str], line: u64, place: Place) -> Result<(), TableError> {
    place.check_width(fields.len(), table.columns.len())?;
    for (column, field) in table.columns.iter_mut().zip(fields) {
        column.push(field.parse().map_or(Cell::Word(field), Cell::Number));
    }
    table.lines.push(line);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    type Rows = Vec<(u64, Vec<String>)>;

    fn collected(
        each: impl FnOnce(
            &mut dyn FnMut(u64, &[&str]) -> Result<(), TableError>,
        ) -> Result<(), TableError>,
    ) -> Rows {
        let mut all = Vec::new();
        each(&mut |line, fields| {
            all.push((line, fields.iter().map(|&field| field.to_owned()).collect()));
            Ok(())
        })
        .unwrap();
        all
    }

    fn rows(text: &str) -> Rows {
        collected(|take| {
            each_row("t.csv", text.trim_start_matches('\u{feff}'), &Dialect::default(), take)
        })
    }

    #[test]
    fn plain_text_is_read_as_the_parser_of_quoted_text_reads_it() {
        for text in [
            "a,b\n1,2\n3,4\n",
            "a , b\r\n 1,\t2 \r\n\r\n3,4",
            "# c\n\n# d\na,b\n\n1,2\n#\n\n  \n3,4\n\n",
            "a,b,\n,,\n , \n1\n",
            " # no comment, b\n#,\n1,2",
            "ä,\u{a0}b\u{a0}\n1,2\n",
            "",
            "\n",
        ] {
            assert!(is_plain(text), "{text:?}");
            let plain = collected(|take| each_plain_row::<b','>(text, take));
            let quoted = collected(|take| each_quoted_row("t.csv", text, b',', take));
            assert_eq!(plain, quoted, "{text:?}");
        }
        assert!(!is_plain("a,b\r1,2\n") && !is_plain("a,\"b\"\n"));
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

    fn refused(text: &str) -> String {
        read_table("t.csv", text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn names_words_and_numbers_are_read_as_they_stand() {
        let text = "\u{feff}# made by hand\r\n time_s ,\"a, b\",\r\n0,x,1e3\r\n\r\n.5,,-inf\r\n";
        let table = read_table("t.csv", text.as_bytes()).unwrap();
        assert_eq!(table.names().collect::<Vec<_>>(), ["time_s", "a, b", "column 3"]);
        assert_eq!(table.lines, [3, 5]);
        let row = |row| table.columns.iter().map(|column| column.cell(row)).collect::<Vec<_>>();
        assert_eq!(row(0), [Cell::Number(0.0), Cell::Word("x"), Cell::Number(1000.0)]);
        assert_eq!(row(1), [Cell::Number(0.5), Cell::Word(""), Cell::Number(f64::NEG_INFINITY)]);
    }

    #[test]
    fn a_first_row_of_numbers_is_data() {
        let table = read_table("t.csv", b"# time, torque\n1,2\n3,4\n").unwrap();
        assert_eq!(table.names().collect::<Vec<_>>(), ["column 1", "column 2"]);
        assert_eq!(table.lines, [2, 3]);
    }

    #[test]
    fn a_table_of_names_alone_has_no_rows() {
        assert!(read_table("t.csv", b"a,b\n").unwrap().lines.is_empty());
    }

    #[test]
    fn what_is_no_table_is_refused() {
        let nothing = "t.csv: has no rows, but must hold a row of names or of numbers";
        assert_eq!(refused(""), nothing);
        assert_eq!(refused("# only a remark\n\n"), nothing);
        let ragged = "fields = 1, but must be 2, as many as there are columns";
        assert_eq!(refused("a,b\n1,2\n\n3\n"), format!("t.csv:4: {ragged}"));
        assert_eq!(refused("1,2\n3\n"), format!("t.csv:2: {ragged}"));
        let twice = "t.csv:1: column 3 = \"a\", but must not repeat column 1";
        assert_eq!(refused("a,b, a\n"), twice);
        let utf8 = "t.csv:2: text = byte 0xff, but must be UTF-8";
        assert_eq!(read_table("t.csv", b"a\n\xff\n").unwrap_err().to_string(), utf8);
        let commas = "must name columns that are separated by commas";
        assert_eq!(refused("a;b\n1;2\n"), format!("t.csv:1: first row = \"a;b\", but {commas}"));
        let commas = "must have commas between its fields";
        assert_eq!(refused("a b\n1 2\n"), format!("t.csv:2: row = \"1 2\", but {commas}"));
    }
}
