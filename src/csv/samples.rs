use crate::response::HistoryError;

use super::error::{Place, TableError, quoted};
use super::heading::Quantity;
use super::heading::{Header, Heading};
use super::rows::read_rows;

/// Fewest samples that a table may have.
pub(super) const MIN_SAMPLES: usize = 4;

/// Longest number that a message shows whole.
const LONGEST_SHOWN: usize = 60;

/// The notation of numbers, for hints.
const NUMBERS: &str = "decimals follow a point, and nothing divides thousands";

/// The columns of a table over time that the program reads, in SI, with the line of each sample.
pub(super) struct Samples {
    header: Header,
    /// Index of the time among the headings.
    time: usize,
    /// The values of each heading.
    values: Vec<Vec<f64>>,
    pub(super) lines: Vec<u64>,
    /// The last time as written.
    time_text: String,
}

impl Samples {
    /// Reads a table; `read_header` reads its first row. One of the columns is the time.
    pub(super) fn read(
        name: &str,
        bytes: &[u8],
        read_header: impl Fn(&[&str], Place) -> Result<Header, TableError>,
    ) -> Result<Self, TableError> {
        let whole = Place { file: name, line: None };
        let at = |line| Place { line: Some(line), ..whole };
        let samples = read_rows(
            name,
            bytes,
            |line, fields| Ok(Self::new(read_header(fields, at(line))?)),
            |samples: &mut Self, line, fields| samples.push(fields, line, at(line)),
        )?;
        let samples = samples.ok_or_else(|| {
            let must = format!("must hold a row of names and {MIN_SAMPLES} samples or more");
            whole.refuse("content", "nothing", must)
        })?;
        if samples.lines.len() < MIN_SAMPLES {
            let found = samples.lines.len().to_string();
            return Err(whole.refuse("samples", found, format!("must be {MIN_SAMPLES} or more")));
        }
        Ok(samples)
    }

    /// Takes the column of a quantity, if there is one.
    pub(super) fn take(&mut self, quantity: Quantity) -> Option<Vec<f64>> {
        let is_wanted = |heading: &Heading| heading.quantity == quantity;
        let place = self.header.headings.iter().position(is_wanted)?;
        Some(std::mem::take(&mut self.values[place]))
    }

    /// An error of the history made of these samples, with file and line.
    pub(super) fn refuse_history(&self, name: &str, error: &HistoryError) -> TableError {
        let line = error.sample().map(|sample| self.lines[sample]);
        let place = Place { file: name, line };
        place.refuse_whole(error.to_string()).with_hint(error.hint().map(str::to_owned))
    }

    fn new(header: Header) -> Self {
        let is_time = |heading: &Heading| heading.quantity == Quantity::Time;
        Self {
            time: header.headings.iter().position(is_time).unwrap_or(0),
            values: vec![Vec::new(); header.headings.len()],
            header,
            lines: Vec::new(),
            time_text: String::new(),
        }
    }

    fn push(&mut self, fields: &[&str], line: u64, place: Place) -> Result<(), TableError> {
        let Header { width, headings } = &self.header;
        if fields.len() != *width {
            let must = format!("must be {width}, as many as there are columns");
            let hint = (fields.len() > *width && fields.iter().all(|field| is_digits(field)))
                .then(|| format!("{NUMBERS}, and one comma divides two fields"));
            return Err(place.refuse("fields", fields.len().to_string(), must).with_hint(hint));
        }
        for (heading, values) in headings.iter().zip(&mut self.values) {
            values.push(read_number(fields[heading.index], heading, place)?);
        }
        let time_text = fields[headings[self.time].index];
        self.check_time(time_text, place)?;
        time_text.clone_into(&mut self.time_text);
        self.lines.push(line);
        Ok(())
    }

    /// Refuses a time, written as `text`, that is not above the one before it.
    fn check_time(&self, text: &str, place: Place) -> Result<(), TableError> {
        let (&[.., before, now], Some(line)) = (&self.values[self.time][..], self.lines.last())
        else {
            return Ok(());
        };
        if now > before {
            return Ok(());
        }
        let Heading { name, unit_text, .. } = &self.header.headings[self.time];
        let must = format!("must be above {} {unit_text} of line {line}", self.time_text);
        Err(place.refuse(name, format!("{text} {unit_text}"), must))
    }
}

/// One field of a column, in SI.
fn read_number(field: &str, heading: &Heading, place: Place) -> Result<f64, TableError> {
    let finite = "must be a finite number";
    if field.is_empty() {
        return Err(place.refuse(&heading.name, "nothing", finite));
    }
    let Ok(number) = field.parse::<f64>() else {
        let hint = hint_for(field, heading);
        return Err(place.refuse(&heading.name, quoted(field), "must be a number").with_hint(hint));
    };
    let value = heading.to_si(number);
    if value.is_finite() {
        Ok(value)
    } else {
        Err(place.refuse(&heading.name, shown(field), finite))
    }
}

/// A number in a message: it may have millions of digits.
fn shown(field: &str) -> String {
    if field.len() <= LONGEST_SHOWN { field.to_owned() } else { quoted(field) }
}

/// What the user may have meant by a field that is not a number.
fn hint_for(field: &str, heading: &Heading) -> Option<String> {
    let has_clock = field.contains(':') || field.matches(['-', '/', '.']).count() == 2;
    if heading.quantity == Quantity::Time
        && has_clock
        && field.starts_with(|c: char| c.is_ascii_digit())
    {
        return Some("time is a number from any start, 0.25 for a quarter of a second".to_owned());
    }
    let plain = field.replace([',', ' ', '\'', '_', '\u{a0}', '\u{202f}'], "");
    (plain != field && plain.parse::<f64>().is_ok()).then(|| NUMBERS.to_owned())
}

/// True if a field could be a part of a number that commas divide.
fn is_digits(field: &str) -> bool {
    let digits = field.strip_prefix(['-', '+']).unwrap_or(field);
    !digits.is_empty()
        && digits.bytes().all(|byte| byte.is_ascii_digit() || b".eE-".contains(&byte))
}
