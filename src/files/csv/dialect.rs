//! The dialect of a table: the lines above it, the delimiter of its fields, and the decimal sign.

use super::format::{Decimal, Delimiter, TableFormat, is_plain_number};
use super::head::Head;
use super::input::{Place, TableError, quoted};

/// The dialect of a text.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Dialect {
    /// Index of the first byte of the table.
    pub(super) start: usize,
    /// Number of lines before it.
    pub(super) lines: u64,
    pub(super) delimiter: Delimiter,
    pub(super) decimal: Decimal,
    /// Names of the columns above `start`, and their line.
    pub(super) names: Option<(u64, Vec<String>)>,
    /// True if the rows may have no field for the last name.
    pub(super) is_long: bool,
    /// First time and step in s, where the first column counts the samples.
    pub(super) sequence: Option<[f64; 2]>,
    /// Deviations of the text from the standard form, for the user.
    pub(super) found: Vec<String>,
}

impl Dialect {
    /// Finds the dialect of a text without a byte order mark.
    ///
    /// # Errors
    /// [`TableError`] for an ambiguous text, with the option that decides.
    pub(super) fn detect(file: &str, text: &str, given: &TableFormat) -> Result<Self, TableError> {
        let mut dialect = Self::after(text, given.skip);
        let named = dialect.take_sep_line(file, text)?;
        let body = &text[dialect.start..];
        let head = Head::of(body, line_end(text), given, given.delimiter.or(named));
        let shown = head.map(|head| dialect.take_head(text, head));
        let body = &text[dialect.start..];
        let Some((_, first)) = rows(body).next() else { return Ok(dialect) };
        let shown = || shown.unwrap_or_else(|| Delimiter::of_row(first));
        dialect.delimiter = given.delimiter.or(named).unwrap_or_else(shown);
        if given.delimiter.is_none() && dialect.delimiter != Delimiter::Comma {
            dialect.found.push(format!("{} as delimiter", dialect.delimiter));
        }
        let place = |line| Place { file, line: Some(line + dialect.lines) };
        dialect.decimal = match given.decimal {
            Some(decimal) => decimal,
            None if dialect.delimiter != Delimiter::Comma => {
                let decimal = decimal_of(rows(body), dialect.delimiter, place)?;
                if decimal == Decimal::Comma {
                    dialect.found.push("decimal comma".to_owned());
                }
                decimal
            }
            None => {
                if dialect.names.is_none() {
                    refuse_doubtful_commas(body, first, place)?;
                }
                Decimal::Point
            }
        };
        Ok(dialect)
    }

    /// The standard dialect after some lines.
    fn after(text: &str, skip: usize) -> Self {
        let mut dialect = Self::default();
        // A text has at most as many lines as bytes.
        for _ in 0..skip.min(text.len()) {
            dialect.pass_line(text);
        }
        dialect.lines = skip as u64;
        dialect
    }

    fn pass_line(&mut self, text: &str) {
        let rest = &text[self.start..];
        self.start += rest.find(line_end(text)).map_or(rest.len(), |end| end + 1);
        self.lines += 1;
    }

    /// Skips the lines of a heading and takes its names; returns the delimiter.
    fn take_head(&mut self, text: &str, head: Head) -> Delimiter {
        let before = self.lines;
        (0..head.above).for_each(|_| self.pass_line(text));
        self.names = Some((before + head.line, head.names));
        self.is_long = head.is_long;
        self.sequence = head.sequence;
        self.found = head.found;
        head.delimiter
    }

    /// Skips a first line such as `sep=;`, which spreadsheets write and read, and returns its delimiter.
    fn take_sep_line(&mut self, file: &str, text: &str) -> Result<Option<Delimiter>, TableError> {
        let line = text[self.start..].split(line_end(text)).next().unwrap_or_default();
        let line = line.trim_end_matches('\r').trim_matches('"');
        let Some(sign) = line.strip_prefix("sep=") else { return Ok(None) };
        let delimiter = Delimiter::of_sign(sign).ok_or_else(|| {
            let place = Place { file, line: Some(self.lines + 1) };
            let error = place.refuse("sep", quoted(sign), "must be a comma, `;`, a tab or a blank");
            error.with_hint(
                "leave the line out with --skip 1, or name the sign with --delimiter SIGN"
                    .to_owned(),
            )
        })?;
        self.pass_line(text);
        Ok(Some(delimiter))
    }
}

/// Sign at the end of every line: CR only if there is no LF.
fn line_end(text: &str) -> char {
    if text.contains('\n') || !text.contains('\r') { '\n' } else { '\r' }
}

/// Rows of a text, without comments and blank lines, with their numbers from 1.
fn rows(text: &str) -> impl Iterator<Item = (u64, &str)> {
    let lines = (1..).zip(text.split(line_end(text)));
    lines.filter(|(_, line)| !(line.starts_with('#') || line.trim().is_empty()))
}

/// Decimal sign in the rows of a table with another delimiter than the comma.
///
/// # Errors
/// [`TableError`] for both signs in one table, and for a sign that may also separate thousands in every number that has
/// it.
fn decimal_of<'a, 'b>(
    rows: impl Iterator<Item = (u64, &'b str)>,
    delimiter: Delimiter,
    place: impl Fn(u64) -> Place<'a>,
) -> Result<Decimal, TableError> {
    let mut seen: Option<(Decimal, u64, &str)> = None;
    let mut may_be_thousands = true;
    for (line, row) in rows {
        for field in delimiter.split(row) {
            let field = field.trim_matches('"');
            let Some(decimal) = decimal_in(field) else { continue };
            may_be_thousands &= is_grouped(field);
            match seen {
                None => seen = Some((decimal, line, field)),
                Some((other, _, earlier)) if other != decimal => {
                    let must = format!("must have the decimal sign of {}", quoted(earlier));
                    let error = place(line).refuse("field", quoted(field), must);
                    let hint = "state it with --decimal comma or --decimal point; write nothing between thousands";
                    return Err(error.with_hint(hint.to_owned()));
                }
                Some(_) => {}
            }
        }
    }
    let Some((decimal, line, field)) = seen else { return Ok(Decimal::Point) };
    if !may_be_thousands {
        return Ok(decimal);
    }
    let sign = if decimal == Decimal::Comma { "comma" } else { "point" };
    let must = format!("must show whether the {sign} stands before decimals or between thousands");
    let hint =
        format!("use --decimal {sign} if decimals follow it; write nothing between thousands");
    Err(place(line).refuse("field", quoted(field), must).with_hint(hint))
}

/// Decimal sign of a number that has one.
fn decimal_in(field: &str) -> Option<Decimal> {
    let (decimal, other) = match field.find([',', '.']).map(|at| field.as_bytes()[at])? {
        b',' => (Decimal::Comma, field.replacen(',', ".", 1)),
        _ => (Decimal::Point, field.to_owned()),
    };
    other.parse::<f64>().is_ok().then_some(decimal)
}

/// True for a number such as `10.000`, whose sign may separate thousands: three digits after it, one to three before
/// it, and no leading zero.
fn is_grouped(number: &str) -> bool {
    let number = number.strip_prefix(['-', '+']).unwrap_or(number);
    let Some((whole, behind)) = number.split_once([',', '.']) else { return false };
    let are_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    (1..=3).contains(&whole.len())
        && !whole.starts_with('0')
        && behind.len() == 3
        && are_digits(whole)
        && are_digits(behind)
}

/// Refuses rows such as `0,1,0,5` without names: four whole numbers, or two with decimal commas.
fn refuse_doubtful_commas<'a>(
    body: &str,
    first: &str,
    place: impl Fn(u64) -> Place<'a>,
) -> Result<(), TableError> {
    let fields = Delimiter::Comma.split(first);
    if fields.len() < 4
        || !fields.len().is_multiple_of(2)
        || !fields.iter().all(|f| is_plain_number(f))
    {
        return Ok(());
    }
    let is_whole = |(at, field): (usize, &str)| {
        let digits =
            if at.is_multiple_of(2) { field.trim_start_matches(['-', '+']) } else { field };
        !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
    };
    let is_doubtful = |row: &str| Delimiter::Comma.split(row).into_iter().enumerate().all(is_whole);
    if !rows(body).all(|(_, row)| is_doubtful(row)) {
        return Ok(());
    }
    let (line, _) = rows(body).next().unwrap_or_default();
    let must = "must show whether a comma divides fields or stands before decimals";
    let error = place(line).refuse("row", quoted(first.trim()), must);
    Err(error.with_hint(
        "use --decimal point if these are whole numbers; else write ; between fields".to_owned(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Delimiter {
        Dialect::detect("t.csv", text, &TableFormat::default()).unwrap().delimiter
    }

    #[test]
    fn the_first_row_shows_the_delimiter() {
        for (text, delimiter) in [
            ("time,a\n0;0\n", Delimiter::Comma),
            ("\"a\nb\",time\n", Delimiter::Comma),
            ("\"a;b\",time\n", Delimiter::Comma),
            ("time,\ta\n", Delimiter::Comma),
            ("0, 1\n", Delimiter::Comma),
            ("# a;b\n\ntime;a,b\n", Delimiter::Semicolon),
            ("time\ta, b\n", Delimiter::Tab),
            ("  time   a\n", Delimiter::Blanks),
            ("0,1 0,2\n", Delimiter::Blanks),
        ] {
            assert_eq!(found(text), delimiter, "{text:?}");
        }
    }

    #[test]
    fn lines_are_left_out_and_counted() {
        for (text, skip, start, lines) in [
            ("x\r\ny\nsep=;\na;b\n", 2, 11, 3),
            ("x\ra,b\r0,1\r", 1, 2, 1),
            ("sep=,\na,b\n", 0, 6, 1),
            ("a", 3, 1, 3),
        ] {
            let given = TableFormat { skip, ..TableFormat::default() };
            let dialect = Dialect::detect("t.csv", text, &given).unwrap();
            assert_eq!((dialect.start, dialect.lines), (start, lines), "{text:?}");
        }
    }

    fn decimal(text: &str) -> Result<Decimal, TableError> {
        Dialect::detect("t.csv", text, &TableFormat::default()).map(|dialect| dialect.decimal)
    }

    #[test]
    fn any_row_may_show_the_decimal_sign() {
        for (text, sign) in [
            ("a;b\n0;0\n1;0,5\n", Decimal::Comma),
            ("a;b\n0;\"-0,5e-3\"\n", Decimal::Comma),
            ("a;b\n0;1.2.2024\n1;x,5\n", Decimal::Point),
            ("a b\n0 0.5\n", Decimal::Point),
            ("a;b\n0,5;10,000\n", Decimal::Comma),
        ] {
            assert_eq!(decimal(text).unwrap(), sign, "{text:?}");
        }
    }

    #[test]
    fn a_sign_that_may_stand_between_thousands_in_all_numbers_is_refused() {
        for shown in ["0.125", "-0.125", "1.25", "1.2345", "1234.567", "1.234e3", ".125"] {
            assert_eq!(
                decimal(&format!("a;b\n0;10.000\n1;{shown}")),
                Ok(Decimal::Point),
                "{shown}"
            );
        }
        for text in
            ["a;b\n0;10.000\n10;1", "a;b\n0;10,000\n", "a;b\n0;-1.234\n", "a;b\n1.000;+1.234"]
        {
            let error = decimal(text).unwrap_err();
            assert!(error.to_string().contains("between thousands"), "{error}");
            assert!(error.hint().unwrap().starts_with("use --decimal "), "{text:?}");
        }
    }
}
