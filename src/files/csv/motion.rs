//! Motions and paths, from a table or from arrays of a program. Arrays have no file and no lines, but get the same checks,
//! digits and remedies.

use std::fmt::Write as _;
use std::io;
use std::io::Write;

use super::format::{Reading, TableFormat};
use super::heading::{
    ACCELERATION, ANGLE, ANGLES, CARRIAGE, DISPLACEMENT, PATH_X, PATH_Y, Quantity, TIME, VELOCITY,
};
use super::input::{Place, TableError};
use super::motion_columns::{motion_columns, path_columns, take_angle};
use super::number::Digits;
use super::quality::{Judged, digits_of, settle};
use super::samples::{Samples, grid_of, refuse_samples};
use super::table::{Column, ColumnGroup, group, write_over_time};
use super::uniform::{MIN_SAMPLES, Uniform, steps_of, without_last};
use crate::link::Link;
use crate::motion::{
    Ends, MotionColumns, PathColumn, PathColumns, Recording, TipTarget, Uncertainty, refuse_jump,
};
use crate::numeric::{SplineEnds, TimeGrid};
use crate::recording;
use crate::recording::{Change, Rounding, jitter};
use crate::result::Remark;
use crate::text::significant;

/// A wanted motion of a link's tip, or the path of an arm, read from a file or arrays, in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionTable {
    pub(super) sampled: Sampled,
    pub(super) rows: SampleRows,
    pub(super) reading: Reading,
    pub(super) ends: Ends,
}

/// The columns of a motion.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a program has few tables")]
pub(super) enum Sampled {
    /// The tip of one link along its arc.
    Tip {
        columns: MotionColumns,
        /// Quality of the samples.
        recording: Recording,
        /// The first angle in rad, if the displacement comes from angles.
        first_angle_rad: Option<f64>,
    },
    /// Places of an arm's tip, or directions of its links, and the lengths of the links.
    Path { columns: PathColumns, lengths_m: Vec<f64> },
}

/// File and line of each sample, for messages.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleRows {
    pub(super) name: String,
    pub(super) lines: Vec<u64>,
}

impl SampleRows {
    /// Samples of a program, without a file.
    pub fn of_arrays(name: &str) -> Self {
        Self { name: name.to_owned(), lines: Vec::new() }
    }

    /// The file as the user named it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Sets the file's name.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        Self { name: name.to_owned(), ..self }
    }

    /// Error about one of the samples, or all of them, for the reason `why`.
    pub fn refused(
        &self,
        sample: Option<usize>,
        why: &impl ToString,
        hint: Option<&str>,
    ) -> TableError {
        refuse_samples(&self.name, &self.lines, sample, why, hint)
    }
}

impl MotionTable {
    /// Deviations of the file from the standard form.
    pub fn reading(&self) -> &Reading {
        &self.reading
    }

    /// File and line of each sample.
    pub fn rows(&self) -> &SampleRows {
        &self.rows
    }

    /// Line of a sample in the file, from 1; for a resampled motion, the line of the file's last sample that is not
    /// later. `None` if there is no such sample.
    pub fn line_of(&self, sample: usize) -> Option<u64> {
        self.rows.lines.get(sample).copied()
    }

    /// True if the displacement comes from angles, and so belongs to one link.
    pub fn is_of_angle(&self) -> bool {
        matches!(self.sampled, Sampled::Tip { first_angle_rad: Some(_), .. })
    }

    /// The samples of a link's tip; `None` for a path.
    pub fn columns(&self) -> Option<&MotionColumns> {
        match &self.sampled {
            Sampled::Tip { columns, .. } => Some(columns),
            Sampled::Path { .. } => None,
        }
    }

    /// The samples of an arm's path; `None` for a link's tip.
    pub fn path_columns(&self) -> Option<&PathColumns> {
        match &self.sampled {
            Sampled::Tip { .. } => None,
            Sampled::Path { columns, .. } => Some(columns),
        }
    }

    /// Times in s.
    pub(super) fn time_s(&self) -> &Vec<f64> {
        match &self.sampled {
            Sampled::Tip { columns, .. } => &columns.time_s,
            Sampled::Path { columns, .. } => &columns.time_s,
        }
    }

    /// The displacement as a target for comparison.
    ///
    /// A target need not be at rest at its ends. Other columns than the displacement are ignored.
    ///
    /// ```
    /// use flexlink::csv::read_motion_table;
    /// let file = b"time,displacement\n0,0\n0.5,1\n1,2\n1.5,3\n";
    /// let table = read_motion_table("tip.csv", file, 1.5)?;
    /// assert!(table.clone().into_motion().is_err(), "it starts and ends at full speed");
    /// let target = table.into_target()?;
    /// assert_eq!((target.grid().step_s, target.displacement_m()[3]), (0.5, 3.0));
    /// # Ok::<(), flexlink::csv::TableError>(())
    /// ```
    ///
    /// # Errors
    /// [`TableError`] if there is no displacement, or a time is off the uniform grid.
    pub fn into_target(self) -> Result<TipTarget, TableError> {
        let Self { sampled, rows, .. } = self;
        let Sampled::Tip {
            columns: MotionColumns { time_s, displacement_m: Some(at_m), .. },
            recording,
            ..
        } = sampled
        else {
            let hint = "add a column of the displacement, as tip.csv of `flexlink solve` has: an acceleration does \
                        not show where the tip is";
            let place = Place { file: &rows.name, line: None };
            let error = place.refuse_whole("a target needs displacement or angle, but has neither");
            return Err(error.with_hint(hint.to_owned()));
        };
        let grid = grid_of(&time_s, &rows.name, &rows.lines)?;
        Ok(TipTarget::new(grid, at_m).from_angle(recording.start_angle_rad))
    }

    /// The motion on a uniform grid from its first time to its last, by cubic splines.
    ///
    /// The splines of places and angles are at rest at both ends; those of velocity and acceleration are not-a-knot. A
    /// velocity without other columns is integrated first. A motion that rests after its last time fills the last step
    /// with this rest; of another one the time after the last whole step is left out.
    ///
    /// ```
    /// use flexlink::csv::{read_motion_table, read_motion_table_as};
    /// let file = b"time,displacement\n0,0\n0.1,0.2\n0.3,0.8\n0.4,1\n";
    /// let motion = read_motion_table("move.csv", file, 1.5)?.resampled(0.05)?;
    /// assert_eq!(motion.columns().map(|columns| columns.time_s.len()), Some(9));
    /// let file = b"time,angle1,angle2\n0,0,1\n0.1,0.2,1\n0.3,0.8,1\n0.4,1,1\n";
    /// let path = read_motion_table_as("path.csv", file, &[0.5, 0.4], &Default::default())?;
    /// let path = path.resampled(0.05)?;
    /// assert_eq!(path.path_columns().map(|columns| columns.time_s.len()), Some(9));
    /// # Ok::<(), flexlink::csv::TableError>(())
    /// ```
    ///
    /// # Errors
    /// [`TableError`] unless the step is above 0 and gives from 4 to 1e7 samples; also for a link's direction that jumps,
    /// because a spline would turn it through the jump.
    pub fn resampled(mut self, step_s: f64) -> Result<Self, TableError> {
        self.refuse_jump()?;
        let (steps, left_s) = steps_of(self.time_s(), step_s, &self.rows.name)?;
        let velocity = self.columns().and_then(|columns| columns.velocity_m_s.as_deref());
        let rests = left_s > 0.0 && self.ends.said_by(velocity) == Ends::AtRest;
        let rest = significant(step_s - left_s, 3);
        let told = if rests {
            Some(format!("{rest} s of rest added after the last row"))
        } else {
            without_last(left_s)
        };
        self.reading.found.extend(told);
        Ok(self.with_integral().at_steps(steps + usize::from(rests), step_s))
    }

    /// Refuses a direction of a link that jumps.
    pub(super) fn refuse_jump(&self) -> Result<(), TableError> {
        let Some(columns) = self.path_columns() else { return Ok(()) };
        let refused = columns.angles.iter().flatten().try_for_each(refuse_jump);
        refused.map_err(|error| self.rows.refused(error.sample(), &error, error.hint()))
    }

    /// Sets the ends of a tip that is not at rest there.
    #[must_use]
    pub fn with_ends(self, ends: Ends) -> Self {
        Self { ends, ..self }
    }
}

/// Reads a tip trajectory: a row of names, then a row for each sample.
///
/// An angle defines the displacement, `angle · link_length_m`; so does the direction of places `x` and `y`, whose
/// distance from the hub must be the link's length. Times must increase, but need not be uniform.
///
/// ```
/// use flexlink::csv::read_motion_table;
/// let file = b"time [ms],displacement [cm]\n0,0\n1,0.5\n2,1.5\n3,2\n";
/// let motion = read_motion_table("move.csv", file, 1.5)?;
/// let displacement_m = motion.columns().and_then(|own| own.displacement_m.as_deref());
/// assert!((displacement_m.unwrap()[3] - 0.02).abs() < 1e-15);
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names the file, and the faulty line and column.
pub fn read_motion_table(
    name: &str,
    bytes: &[u8],
    link_length_m: f64,
) -> Result<MotionTable, TableError> {
    read_motion_table_as(name, bytes, &[link_length_m], &TableFormat::default())
}

/// Reads the motion of an arm with links of these lengths, with the user's options for its form: of one link a tip
/// trajectory, of several a path, `time` with `x` and `y` of the tip, `angle1`, `angle2`, … of the links, or both.
///
/// ```
/// use flexlink::csv::read_motion_table_as;
/// let file = b"time [ms],x [cm],y [cm]\n0,60,0\n1,60,0.2\n2,60,1.8\n3,60,2\n";
/// let path = read_motion_table_as("path.csv", file, &[0.5, 0.4], &Default::default())?.into_motion()?;
/// assert_eq!(path.grid().len, 4);
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// Those of [`read_motion_table`]; also options that do not fit the table.
pub fn read_motion_table_as(
    name: &str,
    bytes: &[u8],
    lengths_m: &[f64],
    format: &TableFormat,
) -> Result<MotionTable, TableError> {
    let columns = if lengths_m.len() == 1 { motion_columns } else { path_columns };
    let mut samples = Samples::read(name, bytes, format, columns)?;
    settle(&mut samples, name, format)?;
    let sampled = match lengths_m {
        [length_m] => tip_samples(&mut samples, name, *length_m)?,
        _ => path_samples(&mut samples, lengths_m),
    };
    let Samples { lines, reading, .. } = samples;
    let rows = SampleRows { name: name.to_owned(), lines };
    Ok(MotionTable { sampled, rows, reading, ends: Ends::default() })
}

/// Places of the tip and directions of the links.
fn path_samples(samples: &mut Samples, lengths_m: &[f64]) -> Sampled {
    let mut dropped = samples.reading.dropped;
    let mut column = |quantity: Quantity| {
        let uncertainty = samples
            .rounding_of(quantity)
            .map(|own| Uncertainty::Rounded { decimals: own.decimals, step_m: own.step });
        let values = samples.take(quantity)?;
        // The first column has the count of all.
        let recording = Recording {
            uncertainty,
            dropped: std::mem::take(&mut dropped),
            ..Recording::default()
        };
        Some(PathColumn { name: quantity.word.to_owned(), values, recording })
    };
    let tip = column(PATH_X).zip(column(PATH_Y)).map(|(x, y)| [x, y]);
    let angles = ANGLES.map(&mut column).into();
    let carriage = column(CARRIAGE);
    let time_s = samples.take(TIME).unwrap_or_default();
    let columns = PathColumns { time_s, tip, angles, carriage };
    Sampled::Path { columns, lengths_m: lengths_m.to_vec() }
}

/// The motion of a tip along the arc of a link of this length.
fn tip_samples(
    samples: &mut Samples,
    name: &str,
    link_length_m: f64,
) -> Result<Sampled, TableError> {
    let [acceleration, velocity, displacement, angle] =
        [ACCELERATION, VELOCITY, DISPLACEMENT, ANGLE].map(|quantity| samples.rounding_of(quantity));
    let (angle, rounding) = match take_angle(samples, name, link_length_m)? {
        Some((angle, rounding)) => (Some(angle), rounding),
        None => (samples.take(ANGLE), displacement.or(angle)),
    };
    let mut per_value = 1.0;
    let mut first_angle_rad = None;
    let arc = angle.map(|mut angle| {
        first_angle_rad = angle.first().copied();
        for value in &mut angle {
            *value *= link_length_m;
        }
        per_value = link_length_m;
        angle
    });
    let in_place = rounding.map(|Rounding { decimals, step }| Uncertainty::Rounded {
        decimals,
        step_m: step * per_value,
    });
    let columns = MotionColumns {
        time_s: samples.take(TIME).unwrap_or_default(),
        acceleration_m_s2: samples.take(ACCELERATION),
        velocity_m_s: samples.take(VELOCITY),
        displacement_m: samples.take(DISPLACEMENT).or(arc),
    };
    let recording = Recording {
        dropped: samples.reading.dropped,
        ..digits_of(&columns, in_place, [acceleration, velocity])
    };
    Ok(Sampled::Tip { columns, recording, first_angle_rad })
}

/// Reads a displacement for comparison with the user's options for its form, with [`MotionTable::into_target`]. Times up to a twentieth of a step off a
/// uniform grid are interpolated like those of a motion. With gravity angles are absolute.
///
/// # Errors
/// Those of [`read_motion_table`], [`MotionTable::of_link`] and [`MotionTable::into_target`].
pub fn read_target(
    name: &str,
    bytes: &[u8],
    link: &Link,
    format: &TableFormat,
) -> Result<(TipTarget, Reading), TableError> {
    // An option of the motion alone.
    let corrected = |error: TableError| match error.hint() {
        Some(hint) if hint.contains("--drop-outliers") => {
            error.with_hint("correct the sample".to_owned())
        }
        _ => error,
    };
    let table = read_motion_table_as(name, bytes, &[link.output_m()], format).map_err(corrected)?;
    let table = table.of_link(link)?;
    let is_placed = table.columns().is_some_and(|columns| columns.displacement_m.is_some());
    let table = match format.resample_s.filter(|_| is_placed) {
        // A target need not rest at its ends.
        Some(step_s) => table.with_ends(Ends::Moving).resampled(step_s)?,
        None => table,
    };
    let mut reading = table.reading.clone();
    let Sampled::Tip { columns, recording, .. } = &table.sampled else {
        return Ok((table.into_target()?, reading));
    };
    let MotionColumns { time_s, displacement_m, .. } = columns;
    let jitter = jitter(time_s, displacement_m.as_deref());
    let Some((steps, displacement)) = jitter.zip(displacement_m.as_deref()) else {
        return Ok((table.into_target()?, reading));
    };
    let uniform = Uniform::over(time_s);
    let step_s = uniform.step_s;
    reading.jitter = Some(Remark::Jitter { steps, step_s }.to_string());
    let grid = TimeGrid { origin_s: time_s[0], step_s, first: 0, len: time_s.len() };
    let target = TipTarget::new(grid, uniform.interpolated(displacement, SplineEnds::NotAKnot));
    Ok((target.from_angle(recording.start_angle_rad), reading))
}

/// Writes a trajectory in the form of [`read_motion_table`]: the time, and acceleration, velocity and displacement if
/// present, all in SI.
///
/// # Errors
/// Those of `out`.
pub fn write_trajectory(
    out: &mut (impl Write + Send),
    columns: &MotionColumns,
    digits: Digits,
) -> io::Result<()> {
    let given = [
        ("acceleration", &columns.acceleration_m_s2),
        ("velocity", &columns.velocity_m_s),
        ("displacement", &columns.displacement_m),
    ];
    let given = given.into_iter().filter_map(|(name, values)| Some((name, values.as_deref()?)));
    let groups: Vec<_> = given.map(|column| group([column])).collect();
    write_over_time(out, ("time", &columns.time_s), &groups, digits)
}

/// Writes a path in the form of [`read_motion_table_as`]: the time, and x and y of the tip, directions of the links and
/// places of the carriage if present, all in SI.
///
/// # Errors
/// Those of `out`.
pub fn write_path(
    out: &mut (impl Write + Send),
    columns: &PathColumns,
    digits: Digits,
) -> io::Result<()> {
    fn column(own: &PathColumn) -> Column<'_> {
        Column { name: own.name.clone(), values: &own.values }
    }
    let tip = columns.tip.iter().flatten().map(column).collect();
    let angles = columns.angles.iter().flatten().map(column).collect();
    let carriage = columns.carriage.iter().map(column).collect();
    let groups = [tip, angles, carriage].map(|columns| ColumnGroup { columns });
    write_over_time(out, ("time", &columns.time_s), &groups, digits)
}

impl MotionTable {
    /// Makes a table of a program's samples, with all functions of a file's table: make times uniform, set the noise of
    /// the samples. Errors call it `name`. Displacements have the decimals of the shortest text that reads back to
    /// each, as in a file of these texts.
    ///
    /// ```
    /// use flexlink::csv::MotionTable;
    /// use flexlink::motion::MotionColumns;
    /// let time_s = vec![0.0, 0.1, 0.2, 0.3, 0.4];
    /// let acceleration_m_s2 = Some(vec![0.0, 1.0, 0.0, -1.0, 0.0]);
    /// let columns = MotionColumns { time_s, acceleration_m_s2, ..MotionColumns::default() };
    /// let motion = MotionTable::of_columns("motion", columns)?.into_motion()?;
    /// assert_eq!(motion.grid().len, 5);
    /// # Ok::<(), flexlink::csv::TableError>(())
    /// ```
    ///
    /// # Errors
    /// [`TableError`] for fewer than four samples, times that do not increase, a column of another length, and a number
    /// that is not finite.
    pub fn of_columns(name: &str, columns: MotionColumns) -> Result<Self, TableError> {
        let MotionColumns { time_s, acceleration_m_s2, velocity_m_s, displacement_m } = &columns;
        let given = [
            ("acceleration", acceleration_m_s2),
            ("velocity", velocity_m_s),
            ("displacement", displacement_m),
        ];
        let given = given.into_iter().filter_map(|(own, values)| Some((own, values.as_deref()?)));
        check(name, time_s, given.collect())?;
        let in_place = columns.displacement_m.as_deref().and_then(|own| rounded(own, 1.0));
        Ok(Self::of_tip(name, columns, (in_place, None)))
    }

    fn of_tip(
        name: &str,
        columns: MotionColumns,
        (in_place, first_angle_rad): (Option<Uncertainty>, Option<f64>),
    ) -> Self {
        let integrated = [&columns.acceleration_m_s2, &columns.velocity_m_s]
            .map(|own| own.as_deref().and_then(rounding));
        let recording = digits_of(&columns, in_place, integrated);
        Self::of_arrays(name, Sampled::Tip { columns, recording, first_angle_rad })
    }

    fn of_arrays(name: &str, sampled: Sampled) -> Self {
        let (reading, ends) = (Reading::default(), Ends::default());
        Self { sampled, rows: SampleRows::of_arrays(name), reading, ends }
    }

    /// [`MotionTable::of_columns`] for the angle of the tip, whose arc is the displacement.
    ///
    /// # Errors
    /// Those of [`MotionTable::of_columns`].
    pub fn of_angle(
        name: &str,
        time_s: Vec<f64>,
        angle_rad: &[f64],
        link_length_m: f64,
    ) -> Result<Self, TableError> {
        check(name, &time_s, vec![("angle", angle_rad)])?;
        let displacement_m = Some(angle_rad.iter().map(|angle| angle * link_length_m).collect());
        let columns = MotionColumns { time_s, displacement_m, ..MotionColumns::default() };
        let first_angle_rad = angle_rad.first().copied();
        let in_place = rounded(angle_rad, link_length_m);
        Ok(Self::of_tip(name, columns, (in_place, first_angle_rad)))
    }

    /// [`MotionTable::of_columns`] for the path of an arm with links of these lengths.
    ///
    /// # Errors
    /// Those of [`MotionTable::of_columns`].
    pub fn of_path(
        name: &str,
        mut columns: PathColumns,
        lengths_m: &[f64],
    ) -> Result<Self, TableError> {
        let given = columns.each().map(|column| (column.name.as_str(), &column.values[..]));
        check(name, &columns.time_s, given.collect())?;
        for (own, _) in columns.each_mut(lengths_m) {
            let uncertainty = &mut own.recording.uncertainty;
            *uncertainty = uncertainty.or_else(|| rounded(&own.values, 1.0));
        }
        Ok(Self::of_arrays(name, Sampled::Path { columns, lengths_m: lengths_m.to_vec() }))
    }
}

/// Rounding of places.
fn rounded(values: &[f64], metres_per_value: f64) -> Option<Uncertainty> {
    let Rounding { decimals, step } = rounding(values)?;
    Some(Uncertainty::Rounded { decimals, step_m: step * metres_per_value })
}

/// Rounding of numbers, from the shortest text of each that reads back to it.
fn rounding(values: &[f64]) -> Option<Rounding> {
    let mut digits = recording::Digits::default();
    let mut text = String::new();
    for value in values {
        text.clear();
        // Writing to a string cannot fail.
        let _ = write!(text, "{value}");
        digits.count(&text, *value);
    }
    digits.rounding()
}

/// Refuses samples that a reader of files would have refused in a row.
fn check(name: &str, time_s: &[f64], given: Vec<(&str, &[f64])>) -> Result<(), TableError> {
    let place = Place { file: name, line: None };
    let refuse = |subject: String, found: String, must| Err(place.refuse(subject, found, must));
    let samples = time_s.len();
    if given.is_empty() {
        return Err(place.refuse_whole("samples are missing beside the time"));
    }
    if samples < MIN_SAMPLES {
        let must = format!("must be {MIN_SAMPLES} or more");
        return refuse("samples".to_owned(), samples.to_string(), must);
    }
    for (column, values) in [("time", time_s)].into_iter().chain(given.iter().copied()) {
        if values.len() != samples {
            let must = format!("must be {samples}, as many as times");
            return refuse(format!("samples of {column}"), values.len().to_string(), must);
        }
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            let must = "must be a finite number".to_owned();
            return refuse(format!("{column}[{at}]"), values[at].to_string(), must);
        }
    }
    if let Some(at) = time_s.windows(2).position(|two| two[1] <= two[0]) {
        let must = format!("must be above time[{at}], {} s", time_s[at]);
        return refuse(format!("time[{}]", at + 1), format!("{} s", time_s[at + 1]), must);
    }
    given.into_iter().try_for_each(|(column, values)| {
        let jumps = ["acceleration", "velocity"].contains(&column);
        let change = if jumps { Change::Jumping } else { Change::Continuous };
        let judged =
            Judged { name: column, unit: ("", 1.0), change, is_command: false, time_s, values };
        judged.check(name, &[])
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::motion::read_motion_table;
    use super::*;

    /// A table over uneven times, with the line number twice the sample's.
    fn table(time_s: &[f64], value: impl Fn(f64) -> [f64; 3]) -> MotionTable {
        let column = |index: usize| Some(time_s.iter().map(|&t| value(t)[index]).collect());
        let columns = MotionColumns {
            displacement_m: column(0),
            velocity_m_s: column(1),
            acceleration_m_s2: column(2),
            time_s: time_s.to_vec(),
        };
        let recording = Recording::default();
        let lines = (0..time_s.len() as u64).map(|k| 2 * k).collect();
        MotionTable {
            sampled: Sampled::Tip { columns, recording, first_angle_rad: None },
            rows: SampleRows { name: "t.csv".to_owned(), lines },
            reading: Reading::default(),
            ends: Ends::AtRest,
        }
    }

    fn versine(t: f64) -> [f64; 3] {
        let (sin, cos) = (TAU * t).sin_cos();
        [0.5 * (1.0 - cos), 0.5 * TAU * sin, 0.5 * TAU * TAU * cos]
    }

    fn worst(table: &MotionTable) -> f64 {
        let columns = table.columns().unwrap();
        let wrong = |column: &Option<Vec<f64>>, index: usize| {
            let values = column.as_ref().unwrap().iter().zip(&columns.time_s);
            let errors = values.map(|(value, &t)| (value - versine(t)[index]).abs());
            errors.fold(0.0, f64::max)
        };
        let displacement = wrong(&columns.displacement_m, 0);
        let velocity = wrong(&columns.velocity_m_s, 1);
        displacement.max(velocity).max(wrong(&columns.acceleration_m_s2, 2))
    }

    fn uneven(n: u32) -> Vec<f64> {
        let even = (0..=n).map(|k| f64::from(k) / f64::from(n));
        even.map(|u| u + 0.05 * (TAU * u).sin() / TAU).collect()
    }

    #[test]
    fn all_columns_follow_the_motion_with_the_fourth_power_of_the_spacing() {
        let error = |n| worst(&table(&uneven(n), versine).resampled(0.001).unwrap());
        let order = (error(100) / error(200)).log2();
        assert!((3.8..4.2).contains(&order), "order {order}");
    }

    #[test]
    fn the_motion_ends_where_it_ended() {
        let resampled = table(&uneven(50), |t| [t * t * (3.0 - 2.0 * t); 3]);
        let resampled = resampled.resampled(0.01).unwrap();
        let displacement_m = resampled.columns().unwrap().displacement_m.as_ref().unwrap();
        assert_eq!((displacement_m.len(), displacement_m[100]), (101, 1.0));
    }

    #[test]
    fn a_line_is_that_of_the_last_sample_not_later() {
        let resampled = table(&[0.0, 0.1, 0.3, 0.6], versine).resampled(0.1).unwrap();
        let lines: Vec<u64> = (0..7).filter_map(|k| resampled.line_of(k)).collect();
        assert_eq!(lines, [0, 2, 2, 4, 4, 4, 6]);
    }

    /// A cubic with clamped ends is its own spline, so that the samples are exact on both sides of the end.
    #[test]
    fn a_rest_fills_the_last_step_and_a_moving_end_is_cut() {
        let cubic = |t: f64| t * t * (3.0 - 2.0 * t);
        let times: Vec<f64> = uneven(10);
        let displacement_m = Some(times.iter().map(|t| cubic(*t)).collect());
        let columns = MotionColumns { time_s: times, displacement_m, ..MotionColumns::default() };
        let motion = MotionTable::of_columns("m", columns).unwrap();
        let places = |table: &MotionTable| {
            let columns = table.columns().unwrap();
            (columns.time_s.clone(), columns.displacement_m.clone().unwrap())
        };
        let rested = motion.clone().resampled(0.03).unwrap();
        let note = "read 0.0200 s of rest added after the last row";
        assert_eq!(rested.reading().note().as_deref(), Some(note));
        let (times, displacement_m) = places(&rested);
        assert!((times[34] - 1.02).abs() < 1e-12 && times.len() == 35);
        for (t, own) in times.iter().zip(displacement_m) {
            assert!((own - cubic(t.min(1.0))).abs() < 1e-12, "{t}: {own}");
        }
        let cut = motion.with_ends(Ends::Moving).resampled(0.03).unwrap();
        let note = "read without the last 0.0100 s, less than a step";
        assert_eq!(cut.reading().note().as_deref(), Some(note));
        let (times, displacement_m) = places(&cut);
        assert!((times[33] - 0.99).abs() < 1e-12 && times.len() == 34);
        assert!((displacement_m[33] - cubic(0.99)).abs() < 1e-12, "{}", displacement_m[33]);
    }

    fn refused(file: &str) -> String {
        let format = TableFormat::default();
        let read = read_motion_table_as("p.csv", file.as_bytes(), &[0.5, 0.4], &format);
        read.and_then(MotionTable::into_motion).unwrap_err().to_string()
    }

    #[test]
    fn what_is_no_path_is_refused_where_it_is() {
        let rows = "0,1\n1,2\n2,3\n3,4\n";
        assert!(refused(&format!("time,x\n{rows}")).starts_with("p.csv:1: "), "y is missing");
        assert!(refused(&format!("time,displacement\n{rows}")).contains("x and y, or angle1"));
        assert!(refused(&format!("time,angle1\n{rows}")).contains("angle2 is missing"));
        let jump = "time,angle1 [deg],angle2\n0,170,1\n1,170,1\n2,-175,1\n3,-175,1\n";
        let message = refused(jump);
        assert!(message.starts_with("p.csv:4: angle1 = -3.054326 rad"), "{message}");
    }

    fn refused_arrays(time_s: &[f64], displacement_m: &[f64]) -> String {
        let displacement_m = Some(displacement_m.to_vec());
        let columns =
            MotionColumns { time_s: time_s.to_vec(), displacement_m, ..MotionColumns::default() };
        MotionTable::of_columns("motion", columns).unwrap_err().to_string()
    }

    #[test]
    fn what_no_file_may_hold_is_refused_with_its_index() {
        let times = [0.0, 0.1, 0.2, 0.3];
        assert_eq!(
            refused_arrays(&times[..3], &[0.0; 3]),
            "motion: samples = 3, but must be 4 or more"
        );
        let short = refused_arrays(&times, &[0.0; 3]);
        assert_eq!(short, "motion: samples of displacement = 3, but must be 4, as many as times");
        let not_a_number = refused_arrays(&times, &[0.0, f64::NAN, 0.0, 0.0]);
        assert_eq!(not_a_number, "motion: displacement[1] = NaN, but must be a finite number");
        let turned = refused_arrays(&[0.0, 0.2, 0.1, 0.3], &[0.0; 4]);
        assert_eq!(turned, "motion: time[2] = 0.1 s, but must be above time[1], 0.2 s");
    }

    #[test]
    fn numbers_have_the_decimals_of_a_file_of_them() {
        let wave = |k: u32| 0.5 - 0.5 * libm::cos(f64::from(k) / 10.0);
        for unit in [1e4, 1e17] {
            let values: Vec<f64> = (0..=31).map(|k| (wave(k) * unit).round() / unit).collect();
            let time_s: Vec<f64> = (0..=31).map(f64::from).collect();
            let rows = time_s.iter().zip(&values).map(|(t, x)| format!("{t},{x}\n"));
            let rows: String = rows.collect();
            let read = |head: &str| {
                let file = format!("{head}{rows}");
                read_motion_table("motion", file.as_bytes(), 1.5).unwrap().sampled
            };
            let displacement_m = Some(values.clone());
            let columns = MotionColumns {
                time_s: time_s.clone(),
                displacement_m,
                ..MotionColumns::default()
            };
            let given = MotionTable::of_columns("motion", columns).unwrap();
            assert_eq!(given.sampled, read("time,displacement\n"));
            let given = MotionTable::of_angle("motion", time_s, &values, 1.5).unwrap();
            assert_eq!(given.sampled, read("time,angle\n"));
        }
    }

    #[test]
    fn a_time_off_the_grid_is_refused_without_a_line() {
        let columns = MotionColumns {
            time_s: vec![0.0, 0.1, 0.3, 0.4, 0.5],
            acceleration_m_s2: Some(vec![0.0, 1.0, 0.0, -1.0, 0.0]),
            ..MotionColumns::default()
        };
        let error = MotionTable::of_columns("motion", columns).unwrap().into_motion().unwrap_err();
        assert!(error.to_string().starts_with("motion: time = 0.3 s, but must be"), "{error}");
    }
}
