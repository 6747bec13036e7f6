//! Named columns of a table: numbers over time in SI, and uniform times in place of the times of the table.

use super::columns::{Columns, FirstRow, Header};
use super::format::{Delimiter, Dialect, Reading, TableFormat};
use super::heading::{
    ACCELERATION, ANGLE, ANGLES, CARRIAGE, DISPLACEMENT, Heading, PATH_X, PATH_Y, Quantity, TIME,
    VELOCITY,
};
use super::input::{Place, TableError, quoted};
use super::rows::read_rows_as;
use crate::numeric::{CubicSpline, SplineEnds, TimeGrid};
use crate::recording::{Digits, LARGEST_JITTER, Rounding, jitter};
use crate::response::HistoryError;
use crate::result::Remark;
use crate::text::given;

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
    pub(super) fn history<T>(
        &self,
        of: Quantity,
        made: Result<T, HistoryError>,
    ) -> Result<T, TableError> {
        made.map_err(|mut error| {
            if let HistoryError::Shape { column, .. } = &mut error {
                *column = of.word;
            }
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
    of_a_tip.contains(&quantity) || quantity == CARRIAGE || ANGLES.contains(&quantity)
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

/// Fewest samples of a table.
pub(super) const MIN_SAMPLES: usize = 4;

/// Largest number of samples of a resampled motion.
const MAX_SAMPLES: f64 = 1e7;

/// Difference of times, in steps, below which they are equal.
const SAME_TIME: f64 = 1e-6;

/// Uniform times that start at the first of known times.
#[expect(clippy::struct_field_names, reason = "their units end alike")]
pub(super) struct Uniform<'a> {
    known_s: &'a [f64],
    pub(super) step_s: f64,
    pub(super) times_s: Vec<f64>,
}

impl<'a> Uniform<'a> {
    /// As many uniform times as there are known ones, from the first of these to the last.
    pub(super) fn over(known_s: &'a [f64]) -> Self {
        let last = known_s.len() - 1;
        let mut uniform = Self::of(known_s, last, (known_s[last] - known_s[0]) / last as f64);
        uniform.times_s[last] = known_s[last];
        uniform
    }

    /// Times of this number of steps.
    pub(super) fn of(known_s: &'a [f64], steps: usize, step_s: f64) -> Self {
        let times_s = (0..=steps).map(|k| known_s[0] + k as f64 * step_s).collect();
        Self { known_s, step_s, times_s }
    }

    /// Interpolates values at the known times by a cubic spline.
    pub(super) fn interpolated(&self, values: &[f64], ends: SplineEnds) -> Vec<f64> {
        let spline = CubicSpline::new(self.known_s, values, ends);
        let (steps, last_s) = (self.times_s.len() - 1, self.known_s[self.known_s.len() - 1]);
        // The motion rests at its end, so that a twentieth of a step does not matter.
        let at = |(k, t): (usize, &f64)| if k == steps { last_s } else { t.min(last_s) };
        self.times_s.iter().enumerate().map(|time| spline.value(at(time))).collect()
    }

    /// For each time, the line of the last known time that is not later; empty for samples without lines.
    pub(super) fn lines(&self, lines: &[u64]) -> Vec<u64> {
        let line = |time_s: &f64| {
            let is_not_later = |known_s: &f64| *known_s <= time_s + SAME_TIME * self.step_s;
            lines.get(self.known_s.partition_point(is_not_later).saturating_sub(1)).copied()
        };
        self.times_s.iter().filter_map(line).collect()
    }
}

/// Number of steps from the first known time to the last.
///
/// # Errors
/// [`TableError`] unless it is whole.
pub(super) fn whole_steps(known_s: &[f64], step_s: f64, file: &str) -> Result<usize, TableError> {
    let place = Place { file, line: None };
    let duration_s = known_s[known_s.len() - 1] - known_s[0];
    let refuse = |must: String| place.refuse("resampling step", format!("{step_s} s"), must);
    if !(step_s.is_finite() && step_s > 0.0) {
        return Err(refuse("must be finite and above 0".to_owned()));
    }
    let ratio = duration_s / step_s;
    let steps = ratio.round();
    let fewest = (MIN_SAMPLES - 1) as f64;
    if steps < fewest {
        let longest = duration_s / fewest;
        let must =
            format!("must be at most {} s, which gives {MIN_SAMPLES} samples", given(longest));
        return Err(refuse(must));
    }
    if steps >= MAX_SAMPLES {
        let shortest = duration_s / (MAX_SAMPLES - 1.0);
        let must =
            format!("must be at least {} s, which gives {MAX_SAMPLES:e} samples", given(shortest));
        return Err(refuse(must));
    }
    if (ratio - steps).abs() > LARGEST_JITTER {
        let below = ratio.floor().max(fewest);
        let (long, short) = (duration_s / below, duration_s / (below + 1.0));
        let must = format!("must divide the motion's {} s into whole steps", given(duration_s));
        // With all digits, so that the user can copy one of them.
        let hint = format!("the nearest steps that do are {short} s and {long} s");
        return Err(refuse(must).with_hint(hint));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a whole number from 3 to 1e7"
    )]
    Ok(steps as usize)
}
