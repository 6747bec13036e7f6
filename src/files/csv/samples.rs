//! Named columns of a table: numbers over time in SI, or any numbers and words.

use super::columns::{Columns, FirstRow, Header};
use super::dialect::Dialect;
use super::format::{Delimiter, Reading, TableFormat};
use super::heading::{
    ACCELERATION, ANGLE, ANGLES, DISPLACEMENT, Heading, PATH_X, PATH_Y, Quantity, TIME, VELOCITY,
    check_separator,
};
use super::rows::{Place, TableError, quoted, read_rows, read_rows_as};
use super::uniform::{MIN_SAMPLES, Uniform};
use crate::compare::{Cell, Table, TableColumn};
use crate::numeric::{SplineEnds, TimeGrid};
use crate::recording::{Digits, Rounding, jitter};
use crate::response::HistoryError;
use crate::result::Remark;

/// Longest number that a message shows in full.
const LONGEST_SHOWN: usize = 60;

/// Notation of numbers, for hints.
const NUMBERS: &str = "write a point before decimals, and nothing between thousands";

/// Option for numbers with decimal commas, for hints.
const COMMAS: &str = "--decimal comma reads decimal commas";

/// Remedy for names beyond the fields of the rows, for hints.
const NO_FIELD: &str = "the rows have no field for the last names: --skip leaves the names out, and --columns \
                        time=1,displacement=2 names the columns";

/// Remedy for names divided by blanks, for hints.
const WORDS: &str = "blanks divide names of several words, too: --skip leaves the names out, and --columns \
                     time=1,displacement=2 names the columns";

/// Columns of a table over time that the program uses, in SI, with the line of each sample.
pub(super) struct Samples {
    /// The file as the user named it.
    file: String,
    /// Number of all columns of the table.
    width: usize,
    pub(super) headings: Vec<Heading>,
    /// Values of each heading.
    pub(super) values: Vec<Vec<f64>>,
    pub(super) lines: Vec<u64>,
    /// True if blanks divide the fields.
    has_blanks: bool,
    /// Last time as written.
    time_text: String,
    /// Digits of each heading, counted for prescribed quantities.
    digits: Vec<Digits>,
    /// Deviations of the table from the standard form.
    pub(super) reading: Reading,
}

impl Samples {
    /// Reads a table; `read_columns` finds the columns, including the time, from its first row.
    pub(super) fn read(
        name: &str,
        bytes: &[u8],
        format: &TableFormat,
        read_columns: impl Fn(Header) -> Result<Columns, TableError>,
    ) -> Result<Self, TableError> {
        let whole = Place { file: name, line: None };
        let at = |line| Place { line: Some(line), ..whole };
        let begin = |dialect: &Dialect, line, fields: &[&str]| {
            let place = at(line);
            let columns = read_columns(Header { fields, format, place })?;
            let mut reading = columns.reading.clone();
            if columns.is_guessed || !dialect.found.is_empty() || !reading.found.is_empty() {
                let found = dialect.found.iter().cloned().chain(columns.told());
                reading.found = found.chain(reading.found).collect();
            }
            let mut samples = Self {
                file: name.to_owned(),
                width: fields.len(),
                has_blanks: dialect.delimiter == Delimiter::Blanks,
                values: vec![Vec::new(); columns.headings.len()],
                digits: vec![Digits::default(); columns.headings.len()],
                headings: columns.headings,
                lines: Vec::new(),
                time_text: String::new(),
                reading,
            };
            if columns.first == FirstRow::Samples {
                samples.push(fields, place)?;
            }
            Ok(samples)
        };
        let push = |samples: &mut Self, line, fields: &[&str]| samples.push(fields, at(line));
        let detect = |text: &str| Dialect::detect(name, text, format);
        let samples = read_rows_as(name, bytes, detect, begin, push)?.ok_or_else(|| {
            let must = format!("must hold a row of names and {MIN_SAMPLES} samples or more");
            whole.refuse_whole(&format!("has no rows, but {must}"))
        })?;
        if samples.lines.len() < MIN_SAMPLES {
            let found = samples.lines.len().to_string();
            return Err(whole.refuse("samples", found, format!("must be {MIN_SAMPLES} or more")));
        }
        Ok(samples)
    }

    /// Number of the column of the time.
    pub(super) fn time(&self) -> Option<usize> {
        self.headings.iter().position(|heading| heading.quantity == TIME)
    }

    /// Takes the column of a quantity, if present.
    pub(super) fn take(&mut self, quantity: Quantity) -> Option<Vec<f64>> {
        let index = self.headings.iter().position(|heading| heading.quantity == quantity)?;
        Some(std::mem::take(&mut self.values[index]))
    }

    /// Unit of a quantity's column in SI; 1 without such a column.
    pub(super) fn unit(&self, quantity: Quantity) -> f64 {
        let heading = self.headings.iter().find(|heading| heading.quantity == quantity);
        heading.map_or(1.0, |heading| heading.to_si(1.0))
    }

    /// Takes all samples for a reader that needs uniform times: the times, then the column of each quantity.
    ///
    /// If the times are off the uniform grid by more than their digits explain, but by at most [`LARGEST_JITTER`]
    /// steps, a spline through the samples yields values at uniform times from the first to the last. Other times stay
    /// as they are, and are refused later.
    ///
    /// [`LARGEST_JITTER`]: crate::recording::LARGEST_JITTER
    pub(super) fn take_uniform(
        &mut self,
        quantities: &[Quantity],
    ) -> (Vec<f64>, Vec<Option<Vec<f64>>>) {
        let time_s = self.take(TIME).unwrap_or_default();
        let mut columns: Vec<_> = quantities.iter().map(|quantity| self.take(*quantity)).collect();
        let uniform_s = self.make_uniform(time_s, columns.iter_mut().flatten().collect());
        (uniform_s, columns)
    }

    /// Interpolates columns at uniform times, if their times are off the uniform grid; returns the times.
    pub(super) fn make_uniform(
        &mut self,
        time_s: Vec<f64>,
        columns: Vec<&mut Vec<f64>>,
    ) -> Vec<f64> {
        let decides = columns.first().map(|column| column.as_slice());
        let Some(steps) = jitter(&time_s, decides) else { return time_s };
        let uniform = Uniform::over(&time_s);
        for column in columns {
            *column = uniform.interpolated(column, SplineEnds::NotAKnot);
        }
        let step_s = uniform.step_s;
        self.reading.jitter = Some(Remark::Jitter { steps, step_s }.to_string());
        uniform.times_s
    }

    /// The uniform grid of the times from a sample on.
    pub(super) fn grid_from(&self, sample: usize, time_s: &[f64]) -> Result<TimeGrid, TableError> {
        grid_of(time_s, &self.file, &self.lines[sample..])
    }

    /// A history of the samples, or its error with the file and the line.
    pub(super) fn history<T>(&self, made: Result<T, HistoryError>) -> Result<T, TableError> {
        made.map_err(|error| {
            refuse_samples(&self.file, &self.lines, error.sample(), &error, error.hint())
        })
    }

    /// Rounding of a prescribed quantity, with its step in SI.
    pub(super) fn rounding_of(&self, quantity: Quantity) -> Option<Rounding> {
        let is_meant = |(heading, _): &(&Heading, &Digits)| heading.quantity == quantity;
        let (heading, digits) = self.headings.iter().zip(&self.digits).find(is_meant)?;
        // A negative factor of --scale turns the sign.
        digits.rounding().map(|own| Rounding { step: heading.to_si(own.step).abs(), ..own })
    }

    fn push(&mut self, fields: &[&str], place: Place) -> Result<(), TableError> {
        place.check_width(fields.len(), self.width).map_err(|error| {
            let hint = (fields.len() > self.width && fields.iter().all(|field| is_digits(field)))
                .then(|| format!("{NUMBERS}, and one comma divides two fields"));
            let is_short = fields.len() < self.width;
            let of_blanks =
                if self.has_blanks { Some(WORDS) } else { is_short.then_some(NO_FIELD) };
            let of_names = of_blanks.filter(|_| self.lines.is_empty());
            error.with_hint(hint.or(of_names.map(str::to_owned)))
        })?;
        let columns = self.headings.iter().zip(&mut self.values).zip(&mut self.digits);
        for ((heading, values), digits) in columns {
            let value = read_number(fields[heading.index], heading, place)?;
            if heading.quantity == TIME {
                let text = fields[heading.index];
                if let (Some(before), Some(line)) = (values.last(), self.lines.last())
                    && value <= *before
                {
                    let Heading { name, unit_text, .. } = heading;
                    let must =
                        format!("must be above {} {unit_text} of line {line}", self.time_text);
                    return Err(place.refuse(name, format!("{text} {unit_text}"), must));
                }
                text.clone_into(&mut self.time_text);
            }
            if is_followed(heading.quantity) {
                digits.count(fields[heading.index], value);
            }
            values.push(value);
        }
        self.lines.extend(place.line);
        Ok(())
    }
}

/// True for quantities that a motion or a path prescribes, whose digits show how exact they are.
fn is_followed(quantity: Quantity) -> bool {
    let of_a_tip = [ACCELERATION, VELOCITY, DISPLACEMENT, ANGLE, PATH_X, PATH_Y];
    of_a_tip.contains(&quantity) || ANGLES.contains(&quantity)
}

/// The uniform grid of times in a file with these `lines`.
pub(super) fn grid_of(time_s: &[f64], file: &str, lines: &[u64]) -> Result<TimeGrid, TableError> {
    TimeGrid::through(time_s).map_err(|error| {
        refuse_samples(file, lines, Some(error.sample), &error, Some(error.hint()))
    })
}

/// Error about one of the samples with these `lines`, or all of them, for the reason `why`.
pub(super) fn refuse_samples(
    file: &str,
    lines: &[u64],
    sample: Option<usize>,
    why: &impl ToString,
    hint: Option<&str>,
) -> TableError {
    // Samples without a file have no lines.
    let place = Place { file, line: sample.and_then(|sample| lines.get(sample).copied()) };
    place.refuse_whole(&why.to_string()).with_hint(hint.map(str::to_owned))
}

/// Reads a field of a column in SI.
fn read_number(field: &str, heading: &Heading, place: Place) -> Result<f64, TableError> {
    let finite = "must be a finite number";
    if field.is_empty() {
        return Err(place.refuse(&heading.name, "an empty field", finite));
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

/// Text of a number in a message: it may have millions of digits.
fn shown(field: &str) -> String {
    if field.len() <= LONGEST_SHOWN { field.to_owned() } else { quoted(field) }
}

/// Possible meaning of a field that is not a number.
fn hint_for(field: &str, heading: &Heading) -> Option<String> {
    let has_clock = field.contains(':') || field.matches(['-', '/', '.']).count() == 2;
    if heading.quantity == TIME && has_clock && field.starts_with(|c: char| c.is_ascii_digit()) {
        return Some("time is a number from any start, 0.25 for a quarter of a second".to_owned());
    }
    let plain = field.replace([',', ' ', '\'', '_', '\u{a0}', '\u{202f}'], "");
    (plain != field && plain.parse::<f64>().is_ok()).then(|| {
        let is_decimal = field.matches(',').count() == 1 && !field.contains('.');
        if is_decimal { format!("{NUMBERS}; {COMMAS}") } else { NUMBERS.to_owned() }
    })
}

/// True if a field could be part of a number divided by commas.
fn is_digits(field: &str) -> bool {
    let digits = field.strip_prefix(['-', '+']).unwrap_or(field);
    !digits.is_empty()
        && digits.bytes().all(|byte| byte.is_ascii_digit() || b".eE-".contains(&byte))
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
    table.ok_or_else(|| {
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
    }
}
