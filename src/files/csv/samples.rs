//! Named columns of a table: numbers over time in SI, and uniform times in place of the times of the table.

use super::clock::ClockTime;
use super::columns::{Columns, FirstRow, Header};
use super::dialect::Dialect;
use super::format::{Delimiter, Reading, TableFormat};
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

/// Remedies for rows that a spline does not need, for hints.
const BY_RESAMPLING: &str =
    "--resample STEP leaves out rows without a value and rows that repeat a time, and counts them";

/// Remedy for times that are not read, for hints.
const CLOCKS: &str = "a time is a number, or reads like 17:24:05.123 or 2026-11-30T17:24:05.123; --sample-rate RATE takes \
                      the place of the column";

/// Remedy for lines between the names and the samples, for hints.
const ABOVE: &str = "--skip N leaves out lines above the samples; --columns time=1,displacement=2 then names the columns";

/// Share of the rows that may be left out.
const MOST_LEFT_OUT: f64 = 0.1;

/// Rows that are left out, with the line of the first.
#[derive(Debug, Clone, Default)]
struct LeftOut {
    count: usize,
    first_line: u64,
}

impl LeftOut {
    fn count(&mut self, place: Place) {
        self.count += 1;
        if self.count == 1 {
            self.first_line = place.line.unwrap_or_default();
        }
    }

    /// Description for the user: these rows `that` do something.
    fn told(&self, that: [&str; 2]) -> Option<String> {
        let Self { count, first_line } = self;
        match count {
            0 => None,
            1 => Some(format!("without line {first_line}, which {}", that[0])),
            _ => Some(format!("without {count} rows that {}, from line {first_line} on", that[1])),
        }
    }
}

/// Times of day or dates in the column of the time.
#[derive(Debug, Clone)]
struct Clock {
    since: ClockTime,
    first_line: u64,
    last: ClockTime,
    /// Number of midnights that a time without a date has passed.
    midnights: i64,
}

/// The columns of quantities, where the table has them.
type Taken = Vec<Option<Vec<f64>>>;

/// Columns of a table over time that the program uses, in SI, with the line of each sample.
pub(super) struct Samples {
    /// The file as the user named it.
    file: String,
    /// Number of all columns of the table.
    width: usize,
    /// True if a row may have no field for the last column.
    is_long: bool,
    /// Number of rows so far.
    rows: usize,
    /// Samples in a second, of a table without times.
    rate_hz: Option<f64>,
    since: Option<ClockTime>,
    clock: Option<Clock>,
    /// Step in s of uniform times.
    resample_s: Option<f64>,
    without_value: LeftOut,
    repeated: LeftOut,
    /// Values of the row that is read.
    row: Vec<f64>,
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
                is_long: dialect.is_long,
                rows: 0,
                rate_hz: format.sample_rate.as_ref().map(|rate| rate.hertz),
                since: format.since.clone(),
                clock: None,
                resample_s: format.resample_s,
                without_value: LeftOut::default(),
                repeated: LeftOut::default(),
                row: Vec::new(),
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
        let mut samples = read_rows_as(name, bytes, detect, begin, push)?.ok_or_else(|| {
            let must = format!("must hold a row of names and {MIN_SAMPLES} samples or more");
            whole.refuse_whole(&format!("has no rows, but {must}"))
        })?;
        if samples.lines.len() < MIN_SAMPLES {
            let found = samples.lines.len().to_string();
            return Err(whole.refuse("samples", found, format!("must be {MIN_SAMPLES} or more")));
        }
        samples.tell_rows(whole)?;
        Ok(samples)
    }

    /// Adds the clock and the rows left out to the description of the table.
    ///
    /// # Errors
    /// [`TableError`] if more than a tenth of the rows are left out.
    fn tell_rows(&mut self, place: Place) -> Result<(), TableError> {
        if let Some(Clock { since, first_line, midnights, .. }) = &self.clock {
            let line = if self.since.as_ref() == Some(since) {
                ", as the table before it".to_owned()
            } else {
                format!(" in line {first_line}")
            };
            self.reading.found.push(format!("time in s since {since}{line}"));
            self.reading.found.extend((*midnights > 0).then(|| "past midnight".to_owned()));
            self.reading.since = Some(since.clone());
        }
        let left_out = self.without_value.count + self.repeated.count;
        if left_out as f64 > MOST_LEFT_OUT * self.rows as f64 {
            let found = format!("{left_out} of {}", self.rows);
            let error =
                place.refuse("rows that --resample leaves out", found, "must be at most a tenth");
            let hint = "rows without a value and rows that repeat a time are left out: remove them, or choose a column \
                        without gaps with --columns";
            return Err(error.with_hint(hint.to_owned()));
        }
        let repeated = self.repeated.told(["repeats a time", "repeat a time"]);
        self.reading.found.extend(repeated);
        let empty = self.without_value.told(["lacks a value", "lack a value"]);
        self.reading.found.extend(empty);
        Ok(())
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
    ) -> Result<(Vec<f64>, Taken), TableError> {
        let time_s = self.take(TIME).unwrap_or_default();
        let mut columns: Vec<_> = quantities.iter().map(|quantity| self.take(*quantity)).collect();
        let uniform_s = self.make_uniform(time_s, columns.iter_mut().flatten().collect())?;
        Ok((uniform_s, columns))
    }

    /// Interpolates columns at uniform times, if their times are off the uniform grid or the user sets the step; returns
    /// the times.
    ///
    /// # Errors
    /// Those of [`whole_steps`].
    pub(super) fn make_uniform(
        &mut self,
        time_s: Vec<f64>,
        columns: Vec<&mut Vec<f64>>,
    ) -> Result<Vec<f64>, TableError> {
        if let Some(step_s) = self.resample_s {
            let steps = whole_steps(&time_s, step_s, &self.file)?;
            let uniform = Uniform::of(&time_s, steps, step_s);
            for column in columns {
                *column = uniform.interpolated(column, SplineEnds::NotAKnot);
            }
            self.lines = uniform.lines(&self.lines);
            return Ok(uniform.times_s);
        }
        let decides = columns.first().map(|column| column.as_slice());
        let Some(steps) = jitter(&time_s, decides) else { return Ok(time_s) };
        let uniform = Uniform::over(&time_s);
        for column in columns {
            *column = uniform.interpolated(column, SplineEnds::NotAKnot);
        }
        let step_s = uniform.step_s;
        self.reading.jitter = Some(Remark::Jitter { steps, step_s }.to_string());
        Ok(uniform.times_s)
    }

    /// The uniform grid of the times of all samples.
    pub(super) fn grid(&self, time_s: &[f64]) -> Result<TimeGrid, TableError> {
        grid_of(time_s, &self.file, &self.lines)
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
        self.check_width(fields, place)?;
        self.row.clear();
        for column in 0..self.headings.len() {
            let heading = &self.headings[column];
            let field = fields.get(heading.index).copied().unwrap_or_default();
            let is_time = heading.quantity == TIME;
            if self.resample_s.is_some() && is_gap(field) && !(is_time && self.rate_hz.is_some()) {
                self.rows += 1;
                self.without_value.count(place);
                return Ok(());
            }
            let value = if is_time {
                self.read_time(column, field, place)?
            } else {
                read_number(field, heading, place).map_err(|error| match self.rows {
                    0 => error.or_hint(ABOVE.to_owned()),
                    _ => error,
                })?
            };
            self.row.push(value);
        }
        self.rows += 1;
        if let Some(time) = self.time()
            && let (Some(before), Some(line)) = (self.values[time].last(), self.lines.last())
            && self.row[time] <= *before
        {
            let is_same = self.row[time].total_cmp(before).is_eq();
            if is_same && self.resample_s.is_some() {
                self.repeated.count(place);
                return Ok(());
            }
            let Heading { name, unit_text, index, .. } = &self.headings[time];
            let unit = if self.clock.is_some() { "" } else { unit_text };
            let shown = |text: &str| format!("{text} {unit}").trim_end().to_owned();
            let must = format!("must be above {} of line {line}", shown(&self.time_text));
            let error = place.refuse(name, shown(fields[*index]), must);
            return Err(error.with_hint(is_same.then(|| BY_RESAMPLING.to_owned())));
        }
        for (column, heading) in self.headings.iter().enumerate() {
            let text = fields.get(heading.index).copied().unwrap_or_default();
            if heading.quantity == TIME {
                text.clone_into(&mut self.time_text);
            }
            let value = self.row[column];
            if is_followed(heading.quantity) {
                self.digits[column].count(text, value);
            }
            self.values[column].push(value);
        }
        self.lines.extend(place.line);
        Ok(())
    }

    /// Refuses a row with another number of fields than columns.
    fn check_width(&self, fields: &[&str], place: Place) -> Result<(), TableError> {
        if self.is_long && fields.len() + 1 == self.width {
            return Ok(());
        }
        place.check_width(fields.len(), self.width).map_err(|error| {
            let hint = (fields.len() > self.width && fields.iter().all(|field| is_digits(field)))
                .then(|| format!("{NUMBERS}, and one comma divides two fields"));
            let is_short = fields.len() < self.width;
            let of_blanks =
                if self.has_blanks { Some(WORDS) } else { is_short.then_some(NO_FIELD) };
            let of_names = of_blanks.filter(|_| self.lines.is_empty());
            error.with_hint(hint.or(of_names.map(str::to_owned)))
        })
    }

    /// Reads the time in s of a row. A column that begins with a date or a time of day has only these.
    fn read_time(&mut self, column: usize, field: &str, place: Place) -> Result<f64, TableError> {
        if let Some(rate_hz) = self.rate_hz {
            return Ok(self.rows as f64 / rate_hz);
        }
        let heading = &mut self.headings[column];
        let is_first = self.lines.is_empty();
        if is_first && let Some(unit) = heading.guess_epoch(field) {
            self.reading.found.push(format!("time in {unit} since 1970, by its size"));
        }
        let count = heading.instant(field);
        let is_count = count.is_some();
        let read = count.or_else(|| {
            let is_number = field.parse::<f64>().is_ok();
            if is_number { None } else { ClockTime::parse(field) }
        });
        let now = match (read, &self.clock) {
            (Some(now), Some(_)) => now,
            (Some(now), None) if is_first => now,
            (None, Some(clock)) => {
                let must = format!("must be a time as in line {}", clock.first_line);
                return Err(place.refuse(&heading.name, quoted(field), must));
            }
            (_, None) => return read_number(field, heading, place),
        };
        if heading.has_measure() && !is_count {
            let must = format!("must be a number of {}", heading.unit_text);
            let error = place.refuse(&heading.name, quoted(field), must);
            let hint = "a date or a time of day has no unit and no factor: leave them out";
            return Err(error.with_hint(hint.to_owned()));
        }
        let clock = self.clock.get_or_insert_with(|| {
            let since = self.since.clone().filter(|since| now.since(since).is_some());
            let first_line = place.line.unwrap_or_default();
            Clock {
                since: since.unwrap_or(now.clone()),
                first_line,
                last: now.clone(),
                midnights: 0,
            }
        });
        let now = now.later_by(clock.midnights);
        let is_next_day = now.is_past_midnight(&clock.last);
        clock.midnights += i64::from(is_next_day);
        let now = now.later_by(i64::from(is_next_day));
        let time_s = now.since(&clock.since).ok_or_else(|| {
            let must = format!(
                "must have a date and a zone as {} has them",
                quoted(&clock.since.to_string())
            );
            place.refuse(&heading.name, quoted(field), must)
        })?;
        clock.last = now;
        Ok(time_s)
    }
}

/// True for a field without a value.
fn is_gap(field: &str) -> bool {
    let field = field.trim_start_matches(['-', '+']);
    field.is_empty() || field.eq_ignore_ascii_case("nan")
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
    let by_resampling = || is_gap(field).then(|| BY_RESAMPLING.to_owned());
    if field.is_empty() {
        let error = place.refuse(&heading.name, "an empty field", finite);
        return Err(error.with_hint(by_resampling()));
    }
    let Ok(number) = field.parse::<f64>() else {
        let hint = hint_for(field, heading);
        return Err(place.refuse(&heading.name, quoted(field), "must be a number").with_hint(hint));
    };
    let value = heading.to_si(number);
    if value.is_finite() {
        Ok(value)
    } else {
        Err(place.refuse(&heading.name, shown(field), finite).with_hint(by_resampling()))
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
        return Some(CLOCKS.to_owned());
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
