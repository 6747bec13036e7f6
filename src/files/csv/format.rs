//! The user's options for a table's form, and the deviations from the standard form that a reader found.

use std::fmt;
use std::str::FromStr;

use super::clock::ClockTime;
use super::heading::{Measure, QUANTITIES, Quantity, TIME, all_quantities, nearest};
use super::motion_begins::MotionBegins;
use super::unit_name::{UnitName, in_brackets};
use crate::numeric::parse_hertz;

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

    /// Delimiter of a row.
    pub(super) fn of_row(row: &str) -> Delimiter {
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
}

/// True for a row such as `0,1 0,2`: numbers if divided by blanks, but not if divided by commas.
fn has_decimal_commas(row: &str) -> bool {
    let words: Vec<&str> = row.split_whitespace().collect();
    let is_number = |word: &&str| word.replace(',', ".").parse::<f64>().is_ok();
    words.len() > 1 && words.iter().all(is_number) && !row.split(',').all(is_plain_number)
}

pub(super) fn is_plain_number(field: &str) -> bool {
    field.trim().parse::<f64>().is_ok()
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
    /// Samples in a second, of a table without a column of the time.
    pub sample_rate: Option<SampleRate>,
    /// Step in s of uniform times, by a cubic spline. Rows without a value, and rows that repeat the time of the row
    /// before, are left out and counted. Of a motion and of a recording for comparison only these rows are left out:
    /// [`MotionTable::resampled`](super::MotionTable::resampled) makes the times of a motion uniform.
    pub resample_s: Option<f64>,
    /// Instant from which dates and times of day count; by default that of the first row.
    pub since: Option<ClockTime>,
}

/// Number of samples in a second, as in `--sample-rate`: `1000` or `1 kHz`.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleRate {
    text: String,
    pub(super) hertz: f64,
}

impl SampleRate {
    /// A rate in Hz; `None` unless it is above 0.
    pub fn of_hertz(hertz: f64) -> Option<Self> {
        format!("{hertz} Hz").parse().ok()
    }
}

impl fmt::Display for SampleRate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl FromStr for SampleRate {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const MUST: &str = "must be a rate above 0, such as 1000 or '1 kHz'";
        // Instruments count samples, 1 kS/s.
        let in_hertz = text.replace("S/s", "Hz");
        let hertz = text.trim().parse().ok().or_else(|| parse_hertz(&in_hertz)).ok_or(MUST)?;
        let is_rate = hertz.is_normal() && hertz > 0.0 && (1.0 / hertz).is_normal();
        is_rate.then(|| Self { text: text.trim().to_owned(), hertz }).ok_or(MUST)
    }
}

impl TableFormat {
    /// The user's unit and factor for a quantity.
    pub(super) fn measure(&self, quantity: Quantity) -> Measure<'_> {
        let fits = |unit: &&UnitName| quantity.takes(unit);
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
    let found = all_quantities().find(|quantity| [&*word, plain].contains(&quantity.word));
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
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Reading {
    pub(super) found: Vec<String>,
    /// Unread columns, and a remedy.
    pub(super) unread: Option<(String, String)>,
    /// Treatment of times off a uniform grid.
    pub(super) jitter: Option<String>,
    /// True if `--resample` moved the samples to other times by a spline.
    pub(super) is_interpolated: bool,
    /// Remark on samples that do not follow their neighbours, in a table that is used unchanged.
    pub(super) doubt: Option<String>,
    /// Remark on times without a unit that are slow as seconds.
    pub(super) slow: Option<String>,
    /// Number of samples replaced by their neighbours' prediction.
    pub(super) dropped: usize,
    /// Instant of the time 0, of a table of dates or times of day.
    pub(super) since: Option<ClockTime>,
    /// When the motion begins by a comment above the table, which shifted its times.
    pub(super) begins: Option<MotionBegins>,
}

impl Reading {
    /// Description of the reading, if any of it was a guess.
    pub fn note(&self) -> Option<String> {
        (!self.found.is_empty()).then(|| format!("read {}", self.found.join(", ")))
    }

    /// Instant of the time 0, of a table of dates or times of day.
    pub fn since(&self) -> Option<&ClockTime> {
        self.since.as_ref()
    }

    /// True if a comment says when the motion begins: the times are shifted to those of the motion's file.
    pub fn has_beginning(&self) -> bool {
        self.begins.is_some()
    }

    /// True if a comment says that each row is for a converter or a drive that holds it to the next one.
    pub fn is_held(&self) -> bool {
        self.begins.is_some_and(|begins| begins.is_held)
    }

    /// Treatment of times off a uniform grid, and a remedy.
    pub fn jitter(&self) -> Option<(&str, &str)> {
        Some((self.jitter.as_deref()?, "resample the file to a uniform step"))
    }

    /// True if a spline through the samples has values at other times, which are wrong beside a step.
    pub fn is_interpolated(&self) -> bool {
        self.is_interpolated || self.jitter.is_some()
    }

    /// Number of samples far from their neighbours' prediction, which replaced them.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// Unread columns, and a remedy.
    pub fn remark(&self) -> Option<(&str, &str)> {
        self.unread.as_ref().map(|(unread, hint)| (unread.as_str(), hint.as_str()))
    }

    /// All remarks on the table, each with a remedy: unread columns, uneven times, samples that do not follow their
    /// neighbours, and times that may not be in s.
    pub fn remarks(&self) -> impl Iterator<Item = (&str, &str)> {
        let hint = "correct a bad reading; a pulse of one step may stay";
        let doubt = self.doubt.as_deref().map(|doubt| (doubt, hint));
        let slow =
            self.slow.as_deref().map(|slow| (slow, "--time-unit ms, us or s states the unit"));
        self.remark().into_iter().chain(self.jitter()).chain(doubt).chain(slow)
    }
}
