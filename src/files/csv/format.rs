//! The user's options for a table's form, the deviations from the standard form that a reader found, and the dialect of
//! a table: the delimiter of its fields, and the decimal sign.

use std::fmt;
use std::str::FromStr;

use super::heading::{ANGLES, Measure, QUANTITIES, Quantity, TIME, nearest};
use super::input::{Place, TableError, quoted};
use super::unit_name::{UnitName, in_brackets};

/// Delimiter of the fields in a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Delimiter {
    /// `,`
    #[default]
    Comma,
    /// `;`
    Semicolon,
    /// A tabulator.
    Tab,
    /// One or more blanks; a tabulator counts as a blank.
    Blanks,
}

/// Decimal sign of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Decimal {
    /// `.`
    #[default]
    Point,
    /// `,`
    Comma,
}

impl Delimiter {
    const ALL: [Self; 4] = [Self::Comma, Self::Semicolon, Self::Tab, Self::Blanks];

    /// The byte between two fields; `None` for blanks, which may be several.
    pub(super) fn byte(self) -> Option<u8> {
        match self {
            Self::Comma => Some(b','),
            Self::Semicolon => Some(b';'),
            Self::Tab => Some(b'\t'),
            Self::Blanks => None,
        }
    }

    /// Delimiter of a line `sep=;`.
    pub(super) fn of_sign(sign: &str) -> Option<Self> {
        let byte = |known: &Self| known.byte().unwrap_or(b' ');
        Self::ALL.into_iter().find(|known| sign.as_bytes() == [byte(known)])
    }

    /// Fields of a line without regard to quotes: enough to recognise numbers.
    pub(super) fn split(self, line: &str) -> Vec<&str> {
        match self.byte() {
            Some(byte) => line.split(char::from(byte)).map(str::trim).collect(),
            None => in_brackets(line),
        }
    }
}

/// Text as for `--delimiter`.
impl fmt::Display for Delimiter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Comma => ",",
            Self::Semicolon => ";",
            Self::Tab => "tab",
            Self::Blanks => "blanks",
        })
    }
}

impl FromStr for Delimiter {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let named = Self::ALL.into_iter().find(|known| known.to_string() == text);
        named.or_else(|| Self::of_sign(text)).ok_or("must be `,`, `;`, tab or blanks")
    }
}

/// Text as for `--decimal`.
impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Point => "point",
            Self::Comma => "comma",
        })
    }
}

impl FromStr for Decimal {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "point" | "." => Ok(Self::Point),
            "comma" | "," => Ok(Self::Comma),
            _ => Err("must be point or comma"),
        }
    }
}

/// The user's options for a table's form. The reader finds the rest in the table.
///
/// The standard form is a row of exact names, then rows of numbers with decimal points and commas between them. A
/// reader also finds other delimiters, decimal commas and common names, and reports them in a [`Reading`].
///
/// ```
/// use flexlink::csv::{TableFormat, read_motion_table_as};
/// let format = TableFormat { columns: vec!["time=1".parse()?, "displacement=3".parse()?], ..Default::default() };
/// let file = b"0;7;0\n0,5;7;1,25\n1;7;2\n1,5;7;3\n";
/// let motion = read_motion_table_as("move.csv", file, &[1.5], &format)?;
/// assert_eq!(motion.columns().unwrap().displacement_m.as_deref(), Some(&[0.0, 1.25, 2.0, 3.0][..]));
/// let note = motion.reading().note();
/// assert_eq!(note.as_deref(), Some("read ; as delimiter, decimal comma, time from column 1, \
///     displacement from column 3 in m"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TableFormat {
    /// Number of lines to skip at the beginning of the file.
    pub skip: usize,
    /// Delimiter of the fields in a row.
    pub delimiter: Option<Delimiter>,
    /// Decimal sign.
    pub decimal: Option<Decimal>,
    /// Columns of chosen quantities.
    pub columns: Vec<ColumnChoice>,
    /// Factors on the numbers of columns.
    pub scales: Vec<ColumnScale>,
    /// Unit of the times.
    pub time_unit: Option<UnitName>,
    /// Unit of the column of motion or torque with its dimension.
    pub unit: Option<UnitName>,
    /// True if samples far from their neighbours' prediction are replaced by it.
    pub drop_outliers: bool,
}

impl TableFormat {
    /// The user's unit and factor for a quantity.
    pub(super) fn measure(&self, quantity: Quantity) -> Measure<'_> {
        let fits = |unit: &&UnitName| unit.unit.dimension() == quantity.dimension;
        let unit = if quantity == TIME { &self.time_unit } else { &self.unit };
        let scale = self.scales.iter().find(|scale| scale.quantity == quantity);
        Measure { unit: unit.as_ref().filter(fits), factor: scale.map(|scale| scale.factor) }
    }
}

/// Column of a quantity, as in `--columns`: `displacement=3` or `displacement=pos`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnChoice {
    pub(super) quantity: Quantity,
    pub(super) column: ColumnName,
}

impl ColumnChoice {
    /// True for the column of the quantity with this name.
    pub fn is_of(&self, word: &str) -> bool {
        self.quantity.word == word
    }
}

/// A column by its number or its heading.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum ColumnName {
    /// Number of the column, from 1.
    Number(usize),
    /// Heading with or without its unit, in any case.
    Heading(String),
}

/// Factor on the numbers of a quantity's column, as in `--scale`: `displacement=1.5e-6`.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnScale {
    pub(super) quantity: Quantity,
    pub(super) factor: f64,
}

impl fmt::Display for ColumnChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = self.quantity.word;
        match &self.column {
            ColumnName::Number(number) => write!(f, "{word}={number}"),
            ColumnName::Heading(heading) => write!(f, "{word}={heading}"),
        }
    }
}

impl FromStr for ColumnChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (quantity, column) = pair(text, "displacement=3 or displacement=pos")?;
        let column = match column.parse() {
            Ok(0) => return Err("columns are numbered from 1".to_owned()),
            Ok(number) => ColumnName::Number(number),
            Err(_) if column.is_empty() => return Err("names no column".to_owned()),
            Err(_) => ColumnName::Heading(column.to_owned()),
        };
        Ok(Self { quantity, column })
    }
}

impl fmt::Display for ColumnScale {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={:?}", self.quantity.word, self.factor)
    }
}

impl FromStr for ColumnScale {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (quantity, factor) = pair(text, "displacement=1.5e-6")?;
        let factor = factor.parse().ok().filter(|factor: &f64| factor.is_normal());
        let factor = factor.ok_or("the factor must be a finite number other than 0")?;
        Ok(Self { quantity, factor })
    }
}

/// A quantity, and the text after its equals sign.
fn pair<'a>(text: &'a str, example: &str) -> Result<(Quantity, &'a str), String> {
    let (word, value) = text.split_once('=').ok_or_else(|| format!("must read like {example}"))?;
    let (word, value) = (word.trim().to_lowercase(), value.trim());
    // Motion, deflection and acceleration are those of the tip.
    let plain = word.strip_prefix("tip_").unwrap_or(&word);
    let mut known = QUANTITIES.into_iter().chain(ANGLES);
    let found = known.find(|quantity| [&*word, plain].contains(&quantity.word));
    let quantity = found.ok_or_else(|| {
        let words = QUANTITIES.map(|quantity| quantity.word);
        match nearest(&word, words) {
            Some(near) => format!("did you mean {near}?"),
            None => format!("the quantity must be one of {}, angle1 to angle9", words.join(", ")),
        }
    })?;
    Ok((quantity, value))
}

/// Deviations of a table from the standard form, as a reader found them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Reading {
    pub(super) found: Vec<String>,
    /// Unread columns, and a remedy.
    pub(super) unread: Option<(String, String)>,
    /// Treatment of times off a uniform grid.
    pub(super) jitter: Option<String>,
    /// Remark on samples that do not follow their neighbours, in a table that is used unchanged.
    pub(super) doubt: Option<String>,
    /// Number of samples replaced by their neighbours' prediction.
    pub(super) dropped: usize,
}

impl Reading {
    /// Description of the reading, if any of it was a guess.
    pub fn note(&self) -> Option<String> {
        (!self.found.is_empty()).then(|| format!("read {}", self.found.join(", ")))
    }

    /// Treatment of times off a uniform grid, and a remedy.
    pub fn jitter(&self) -> Option<(&str, &str)> {
        Some((self.jitter.as_deref()?, "resample the file to a uniform step"))
    }

    /// Number of samples far from their neighbours' prediction, which replaced them.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// Unread columns, and a remedy.
    pub fn remark(&self) -> Option<(&str, &str)> {
        self.unread.as_ref().map(|(unread, hint)| (unread.as_str(), hint.as_str()))
    }

    /// All remarks on the table, each with a remedy: unread columns, uneven times, and samples that do not follow their
    /// neighbours.
    pub fn remarks(&self) -> impl Iterator<Item = (&str, &str)> {
        let hint = "correct a bad reading; a pulse of one step may stay";
        let doubt = self.doubt.as_deref().map(|doubt| (doubt, hint));
        self.remark().into_iter().chain(self.jitter()).chain(doubt)
    }
}

/// The dialect of a text.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Dialect {
    /// Index of the first byte of the table.
    pub(super) start: usize,
    /// Number of lines before it.
    pub(super) lines: u64,
    pub(super) delimiter: Delimiter,
    pub(super) decimal: Decimal,
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
        let Some((_, first)) = rows(body).next() else { return Ok(dialect) };
        let shown = || delimiter_of(first);
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
                refuse_doubtful_commas(body, first, place)?;
                Decimal::Point
            }
        };
        Ok(dialect)
    }

    /// The standard dialect after some lines.
    fn after(text: &str, skip: usize) -> Self {
        let mut dialect = Self::default();
        for _ in 0..skip {
            dialect.pass_line(text);
        }
        dialect
    }

    fn pass_line(&mut self, text: &str) {
        let rest = &text[self.start..];
        self.start += rest.find(line_end(text)).map_or(rest.len(), |end| end + 1);
        self.lines += 1;
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
                "leave the line out with --skip 1, or name the sign with --delimiter".to_owned(),
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

/// Delimiter of a table's first row.
fn delimiter_of(row: &str) -> Delimiter {
    // Text in quotes is one field, which may continue in the next line.
    let parts: Vec<&str> = row.split('"').collect();
    if parts.len().is_multiple_of(2) {
        return Delimiter::Comma;
    }
    let bare: String = parts.into_iter().step_by(2).collect::<Vec<_>>().join("x");
    let fields = Delimiter::Comma.split(&bare);
    if fields.iter().any(|field| field.contains(';')) {
        Delimiter::Semicolon
    } else if fields.iter().any(|field| field.contains('\t')) {
        Delimiter::Tab
    } else if fields.len() < 2 || has_decimal_commas(&bare) {
        Delimiter::Blanks
    } else {
        Delimiter::Comma
    }
}

/// True for a row such as `0,1 0,2`: numbers if divided by blanks, but not if divided by commas.
fn has_decimal_commas(row: &str) -> bool {
    let words: Vec<&str> = row.split_whitespace().collect();
    let is_number = |word: &&str| word.replace(',', ".").parse::<f64>().is_ok();
    words.len() > 1 && words.iter().all(is_number) && !row.split(',').all(is_plain_number)
}

fn is_plain_number(field: &str) -> bool {
    field.trim().parse::<f64>().is_ok()
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
