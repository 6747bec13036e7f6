//! Named columns of a table: numbers over time in SI, and uniform times in place of the times of the table.

use super::clock::ClockTime;
use super::columns::{Columns, FirstRow, Header};
use super::dialect::Dialect;
use super::format::{Delimiter, Reading, TableFormat};
use super::heading::{
    ACCELERATION, ANGLE, ANGLES, CARRIAGE, DISPLACEMENT, Heading, PATH_X, PATH_Y, Quantity, TIME,
    VELOCITY, find,
};
use super::input::{Place, TableError, quoted};
use super::motion_begins::MotionBegins;
use super::rows::read_rows_as;
use super::uniform::{MIN_SAMPLES, Uniform, steps_of, without_last};
use crate::numeric::{SplineEnds, TimeGrid};
use crate::recording::{Digits, Rounding, jitter};
use crate::response::HistoryError;
use crate::result::Remark;
use crate::text::{plain, significant};

/// Longest number that a message shows in full.
const LONGEST_SHOWN: usize = 60;

/// Notation of numbers, for hints.
const NUMBERS: &str = "write a point before decimals, and nothing between thousands";

/// Option for numbers with decimal commas, for hints.
const COMMAS: &str = "--decimal comma reads decimal commas";

/// Remedy for names beyond the fields of the rows, for hints.
const NO_FIELD: &str = "the rows have no field for the last names: --skip N leaves the names out, and --columns \
                        QUANTITY=NUMBER names the columns";

/// Remedy for names divided by blanks, for hints.
const WORDS: &str = "blanks divide names of several words, too: --skip N leaves the names out, and --columns \
                     QUANTITY=NUMBER names the columns";

/// Remedies for rows that a spline does not need, for hints.
const BY_RESAMPLING: &str =
    "--resample STEP leaves out rows without a value and rows that repeat a time, and counts them";

/// Remedy for times that are not read, for hints.
const CLOCKS: &str = "a time is a number, or reads like 17:24:05.123 or 2026-11-30T17:24:05.123; --sample-rate RATE takes \
                      the place of the column";

/// Remedy for lines between the names and the samples, for hints.
const ABOVE: &str =
    "--skip N leaves out lines above the samples; --columns QUANTITY=NUMBER then names the columns";

/// Remedy for times off a uniform grid, for hints.
const OFF_GRID: &str =
    "write times with more decimals, or let --resample STEP make uneven times uniform";

/// Words that begin the heading of a segment in a file of `LabVIEW`.
const SEGMENTS: [&str; 2] = ["Channels", "LabVIEW Measurement"];

/// Share of the rows that may be left out.
const MOST_LEFT_OUT: f64 = 0.1;

/// Step in s from which times without a unit may be in another one.
const SLOW_S: f64 = 0.1;

/// Longest gap between samples that a spline may fill, and longest one without a remark, in usual steps.
const LONGEST_GAP: f64 = 10.0;
const TOLD_GAP: f64 = 2.5;

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
    /// Number of rows so far, and the line of the last one.
    rows: usize,
    last_line: u64,
    /// Samples in a second, of a table without times.
    rate_hz: Option<f64>,
    /// Time in s at which the column of the time is 0.
    start_s: f64,
    since: Option<ClockTime>,
    clock: Option<Clock>,
    /// Step in s of uniform times.
    resample_s: Option<f64>,
    without_value: LeftOut,
    repeated: LeftOut,
    /// Rows that repeat a time with other values.
    differing: LeftOut,
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
            let mut headings = columns.headings;
            let mut start_s = 0.0;
            if let (Some([first_s, step_s]), Some(time)) = (dialect.sequence, headings.first_mut())
                && (time.quantity, time.index) == (TIME, 0)
            {
                start_s = first_s;
                *time = time.clone().counting(step_s);
            }
            let mut samples = Self {
                file: name.to_owned(),
                width: fields.len(),
                is_long: dialect.is_long,
                rows: 0,
                last_line: line,
                rate_hz: format.sample_rate.as_ref().map(|rate| rate.hertz),
                start_s,
                since: format.since.clone(),
                clock: None,
                resample_s: format.resample_s,
                without_value: LeftOut::default(),
                repeated: LeftOut::default(),
                differing: LeftOut::default(),
                row: Vec::new(),
                has_blanks: dialect.delimiter == Delimiter::Blanks,
                values: vec![Vec::new(); headings.len()],
                digits: vec![Digits::default(); headings.len()],
                headings,
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
        samples.doubt_times();
        samples.shift(MotionBegins::find(bytes));
        Ok(samples)
    }

    /// Shifts the times to those of the motion's file, where a comment says when the motion begins.
    fn shift(&mut self, begins: Option<MotionBegins>) {
        self.reading.begins = begins;
        let shift_s = begins.map(MotionBegins::shift_s).filter(|shift_s| *shift_s != 0.0);
        let Some((shift_s, time)) = shift_s.zip(self.time()) else { return };
        self.values[time].iter_mut().for_each(|time_s| *time_s += shift_s);
        let shift = plain(shift_s);
        self.reading
            .found
            .push(format!("times shifted by {shift} s, to those of the motion's file"));
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
        let left_out = self.without_value.count + self.repeated.count + self.differing.count;
        if left_out as f64 > MOST_LEFT_OUT * self.rows as f64 {
            let found = format!("{left_out} of {}", self.rows);
            let error =
                place.refuse("rows that --resample leaves out", found, "must be at most a tenth");
            let hint = "rows without a value and rows that repeat a time are left out: remove them, or choose a column \
                        without gaps with --columns QUANTITY=COLUMN";
            return Err(error.with_hint(hint.to_owned()));
        }
        let repeated = self.repeated.told(["repeats a time", "repeat a time"]);
        self.reading.found.extend(repeated);
        let differing = ["repeats a time with other values", "repeat a time with other values"];
        self.reading.found.extend(self.differing.told(differing));
        let empty = self.without_value.told(["lacks a value", "lack a value"]);
        self.reading.found.extend(empty);
        Ok(())
    }

    /// Tells of times without a unit whose step in s is longer than those of loggers.
    fn doubt_times(&mut self) {
        let Some(time) = self.time().filter(|_| self.clock.is_none()) else { return };
        let (heading, times_s) = (&self.headings[time], &self.values[time]);
        let (first_s, last_s) = (times_s[0], times_s[times_s.len() - 1]);
        let step_s = (last_s - first_s) / (times_s.len() - 1) as f64;
        if heading.has_measure() || heading.is_counted || step_s < SLOW_S {
            return;
        }
        let (name, step) = (quoted(&heading.name), significant(step_s, 3));
        let whole = significant(last_s - first_s, 3);
        self.reading.slow = Some(format!(
            "{name} has no unit and counts as seconds: a sample every {step} s, {whole} s in all"
        ));
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
        find(&self.headings, quantity).map_or(1.0, |heading| heading.to_si(1.0))
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
    /// Those of [`steps_of`].
    pub(super) fn make_uniform(
        &mut self,
        time_s: Vec<f64>,
        columns: Vec<&mut Vec<f64>>,
    ) -> Result<Vec<f64>, TableError> {
        let uniform = if let Some(step_s) = self.resample_s {
            let (steps, left_s) = steps_of(&time_s, step_s, &self.file)?;
            self.reading.found.extend(without_last(left_s));
            self.check_longest_gap(&time_s)?;
            let uniform = Uniform::of(&time_s, steps, step_s);
            self.reading.is_interpolated = !uniform.is_known();
            self.lines = uniform.lines(&self.lines);
            uniform
        } else {
            let decides = columns.first().map(|column| column.as_slice());
            let Some(steps) = jitter(&time_s, decides) else { return Ok(time_s) };
            let uniform = Uniform::over(&time_s);
            let step_s = uniform.step_s;
            self.reading.jitter = Some(Remark::Jitter { steps, step_s }.to_string());
            uniform
        };
        for column in columns {
            *column = uniform.interpolated(column, SplineEnds::NotAKnot);
        }
        Ok(uniform.times_s)
    }

    /// Refuses times with a long gap, which a spline would fill with numbers that nobody measured, and tells a short one.
    fn check_longest_gap(&mut self, time_s: &[f64]) -> Result<(), TableError> {
        let mut steps_s: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let longest = (0..steps_s.len()).max_by(|a, b| steps_s[*a].total_cmp(&steps_s[*b]));
        let Some((k, longest_s)) = longest.map(|k| (k, steps_s[k])) else { return Ok(()) };
        let middle = steps_s.len() / 2;
        let usual_s = *steps_s.select_nth_unstable_by(middle, f64::total_cmp).1;
        let steps = longest_s / usual_s;
        let line = self.lines.get(k).copied();
        if steps > LONGEST_GAP {
            let place = Place { file: &self.file, line };
            let found = format!("{} s after this row", significant(longest_s, 3));
            let most = significant(LONGEST_GAP * usual_s, 3);
            let must = format!("must be at most {most} s, {LONGEST_GAP} usual steps");
            let hint = "fill the gap, or leave out the samples before or after it";
            return Err(place.refuse("gap", found, must).with_hint(hint.to_owned()));
        }
        if steps > TOLD_GAP {
            let line = line.map_or(String::new(), |line| format!(" after line {line}"));
            let longest = significant(longest_s, 3);
            self.reading.found.push(format!("a gap of {longest} s{line} interpolated"));
        }
        Ok(())
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
            let is_of_times = matches!(error, HistoryError::NotUniform(_));
            let hint = if is_of_times { Some(OFF_GRID) } else { error.hint() };
            refuse_samples(&self.file, &self.lines, error.sample(), &error, hint)
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
        let first = fields.first().copied().unwrap_or_default();
        if self.rows > 0 && SEGMENTS.contains(&first) {
            let above = place.line.unwrap_or_default() - 1;
            let hint = format!(
                "--skip {above} reads this segment; write each one to a file of its own to read the others"
            );
            let error = place.refuse_whole("a further segment begins, but a table has one");
            return Err(error.with_hint(hint));
        }
        self.check_width(fields, place)?;
        self.check_line(place)?;
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
                let mut pairs = self.row.iter().zip(&self.values);
                let is_copy = pairs.all(|(own, before)| before.last() == Some(own));
                if is_copy { &mut self.repeated } else { &mut self.differing }.count(place);
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

    /// Refuses a line without a sample between samples whose number is their time.
    fn check_line(&mut self, place: Place) -> Result<(), TableError> {
        let line = place.line.unwrap_or_default();
        let before = std::mem::replace(&mut self.last_line, line);
        if self.rate_hz.is_none() || self.rows == 0 || line <= before + 1 {
            return Ok(());
        }
        let place = Place { line: Some(before + 1), ..place };
        let message = "has no sample, but must have one: --sample-rate counts samples for the time";
        let hint = "write \"\" for a missing sample, and leave out comments between samples";
        Err(place.refuse_whole(message).with_hint(hint.to_owned()))
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
        // MATLAB writes the unit of a duration into each field.
        let field = match field.rsplit_once(' ') {
            Some((number, unit)) if is_first && heading.takes_unit(unit) => {
                self.reading.found.push(format!("time in {unit}, as its fields say"));
                number
            }
            Some((number, unit)) if unit == heading.unit_text => number,
            _ => field,
        };
        let notes = is_first.then_some(&mut self.reading.found);
        let number = field.parse().ok();
        let read = match number {
            Some(number) => heading.instant((field, number), notes),
            None => ClockTime::parse(field),
        };
        let now = match (read, &self.clock) {
            (Some(now), Some(_)) => now,
            (Some(now), None) if is_first => now,
            (None, Some(clock)) => {
                let must = format!("must be a time as in line {}", clock.first_line);
                return Err(place.refuse(&heading.name, quoted(field), must));
            }
            (_, None) => return Ok(self.start_s + read_number(field, heading, place)?),
        };
        if heading.has_measure() && number.is_none() {
            let must = format!("must be a number of {}", heading.unit_text);
            let error = place.refuse(&heading.name, quoted(field), must);
            let hint = "a date or a time of day has no unit and no factor: leave them out";
            return Err(error.with_hint(hint.to_owned()));
        }
        let clock = self.clock.get_or_insert_with(|| {
            let since = self.since.clone().filter(|since| now.since(since).is_some());
            let first_line = place.line.unwrap_or_default();
            let since = since.unwrap_or(now.clone());
            // The table before may begin on the day before.
            let midnights = i64::from(now.is_past_midnight(&since));
            Clock { since, first_line, last: now.clone(), midnights }
        });
        let now = now.in_order_of(&clock.since).later_by(clock.midnights);
        let is_next_day = now.is_past_midnight(&clock.last);
        clock.midnights += i64::from(is_next_day);
        let now = now.later_by(i64::from(is_next_day));
        let time_s = now.since(&clock.since).ok_or_else(|| {
            let first = quoted(&clock.since.to_string());
            let must = if now.is_doubtful() || clock.since.is_doubtful() {
                format!(
                    "must show the order of day and month, as in 2026-11-30, to count from {first}"
                )
            } else {
                format!("must have a date and a zone as {first} has them")
            };
            place.refuse(&heading.name, quoted(field), must)
        })?;
        clock.last = now;
        Ok(time_s)
    }
}

/// True for a field without a value: empty, or a word of instruments for no number and for one beyond their range.
fn is_gap(field: &str) -> bool {
    let field = field.trim_start_matches(['-', '+']);
    ["", "nan", "inf", "infinity", "\u{221e}"].iter().any(|own| field.eq_ignore_ascii_case(own))
}

/// True for quantities that a motion or a path prescribes, whose digits show how exact they are.
fn is_followed(quantity: Quantity) -> bool {
    let of_a_tip = [ACCELERATION, VELOCITY, DISPLACEMENT, ANGLE, PATH_X, PATH_Y];
    of_a_tip.contains(&quantity) || quantity == CARRIAGE || ANGLES.contains(&quantity)
}

/// The uniform grid of times in a file with these `lines`.
pub(super) fn grid_of(time_s: &[f64], file: &str, lines: &[u64]) -> Result<TimeGrid, TableError> {
    TimeGrid::through(time_s)
        .map_err(|error| refuse_samples(file, lines, Some(error.sample), &error, Some(OFF_GRID)))
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
    let by_resampling = || BY_RESAMPLING.to_owned();
    if field.is_empty() {
        let error = place.refuse(&heading.name, "an empty field", finite);
        return Err(error.with_hint(by_resampling()));
    }
    if is_gap(field) {
        return Err(place.refuse(&heading.name, field, finite).with_hint(by_resampling()));
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
