//! Path of an arm: places of its tip, or directions of its links, over time.

use std::io::{self, Write};

use super::columns::{Beside, Columns, Header};
use super::format::{Reading, TableFormat};
use super::heading::{
    ANGLES, PATH_X, PATH_Y, Quantity, TIME, Vocabulary, joined, names, refuse_missing,
};
use super::motion_columns::{check_places, unread};
use super::number::Digits;
use super::outliers::settle;
use super::place::TableError;
use super::quality::of_spline_m;
use super::samples::{Samples, refuse_samples};
use super::table::{Column, ColumnGroup, write_over_time};
use super::uniform::{Uniform, whole_steps};
use crate::motion::{
    ArmPath, MotionError, PathColumn, PathColumns, Recording, Uncertainty, refuse_jump,
};
use crate::numeric::SplineEnds;

const PATH: Vocabulary = Vocabulary {
    quantities: &joined::<12>(&[&[TIME, PATH_X, PATH_Y], &ANGLES]),
    prefix: "tip_",
    example: "time,x,y",
    choice: None,
    by_option: BY_OPTION,
};

/// Hint about a choice of columns: after a choice of one quantity, others are not searched.
const BY_OPTION: &str = "--columns time=1,x=2,y=3 names the columns";

/// A path read from a file, in SI, with the line of each sample.
#[derive(Debug, Clone, PartialEq)]
pub struct PathTable {
    pub(super) columns: PathColumns,
    pub(super) name: String,
    pub(super) lines: Vec<u64>,
    pub(super) reading: Reading,
}

impl PathTable {
    /// Deviations of the file from the standard form.
    pub fn reading(&self) -> &Reading {
        &self.reading
    }

    /// The columns of the file.
    pub fn columns(&self) -> &PathColumns {
        &self.columns
    }

    /// The path of an arm with links of these lengths.
    ///
    /// # Errors
    /// [`TableError`] names the file, and the faulty line and column.
    pub fn path(&self, lengths_m: &[f64]) -> Result<ArmPath, TableError> {
        ArmPath::new(self.columns.clone(), lengths_m)
            .map_err(|error| self.refused(error.sample(), &error, error.hint()))
    }

    /// Multiplies the path's duration by a factor; the first sample's time stays.
    ///
    /// # Errors
    /// Those of [`PathColumns::slowed`].
    pub fn slowed(&self, factor: f64) -> Result<Self, MotionError> {
        Ok(Self { columns: self.columns.clone().slowed(factor)?, ..self.clone() })
    }

    /// The path on a uniform grid from its first time to its last, by cubic splines that are at rest at both ends.
    ///
    /// ```
    /// use flexlink::csv::read_path_table;
    /// let file = b"time,angle1,angle2\n0,0,1\n0.1,0.2,1\n0.3,0.8,1\n0.4,1,1\n";
    /// let path = read_path_table("path.csv", file, &Default::default())?.resampled(0.05)?;
    /// assert_eq!(path.columns().time_s.len(), 9);
    /// # Ok::<(), flexlink::csv::TableError>(())
    /// ```
    ///
    /// # Errors
    /// [`TableError`] like [`MotionTable::resampled`](super::MotionTable::resampled); also for an angle that jumps,
    /// because a spline would turn the link through the jump.
    pub fn resampled(mut self, step_s: f64) -> Result<Self, TableError> {
        for column in self.columns.angles.iter().flatten() {
            refuse_jump(column)
                .map_err(|error| self.refused(error.sample(), &error, error.hint()))?;
        }
        let PathColumns { time_s, tip, angles } = &mut self.columns;
        let steps = whole_steps(time_s, step_s, &self.name)?;
        let uniform = Uniform::of(time_s, steps, step_s);
        for column in tip.iter_mut().flatten().chain(angles.iter_mut().flatten()) {
            let recording = &mut column.recording;
            let spline_m = of_spline_m(time_s, &column.values, SplineEnds::Clamped);
            recording.between.spline_m = recording.between.spline_m.max(spline_m);
            recording.spacing_s = Some(Uniform::over(time_s).step_s);
            column.values = uniform.interpolated(&column.values, SplineEnds::Clamped);
        }
        self.lines = uniform.lines(&self.lines);
        *time_s = uniform.times_s;
        Ok(self)
    }

    /// Sets the file's name in errors.
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

/// Reads the path of an arm: `time` with `x` and `y` of the tip, `angle1`, `angle2`, … of the links, or both; a row of
/// names, then a row for each sample.
///
/// ```
/// use flexlink::csv::read_path_table;
/// let file = b"time [ms],x [cm],y [cm]\n0,60,0\n1,60,0.2\n2,60,1.8\n3,60,2\n";
/// let path = read_path_table("path.csv", file, &Default::default())?.path(&[0.5, 0.4])?;
/// assert_eq!(path.grid().len, 4);
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names the file, and the faulty line and column.
pub fn read_path_table(
    name: &str,
    bytes: &[u8],
    format: &TableFormat,
) -> Result<PathTable, TableError> {
    let mut samples = Samples::read(name, bytes, format, path_columns)?;
    settle(&mut samples, name, format)?;
    let mut column = |quantity: Quantity| {
        let uncertainty = samples
            .rounding_of(quantity)
            .map(|own| Uncertainty::Rounded { decimals: own.decimals, step_m: own.step });
        let recording = Recording { uncertainty, ..Recording::default() };
        let values = samples.take(quantity)?;
        Some(PathColumn { name: quantity.word.to_owned(), values, recording })
    };
    let tip = column(PATH_X).zip(column(PATH_Y)).map(|(x, y)| [x, y]);
    let angles = ANGLES.map(&mut column).into();
    let time_s = samples.take(TIME).unwrap_or_default();
    let Samples { lines, reading, .. } = samples;
    let columns = PathColumns { time_s, tip, angles };
    Ok(PathTable { columns, name: name.to_owned(), lines, reading })
}

/// Writes a path in the form of [`read_path_table`]: the time, x and y of the tip and directions of the links if
/// present, all in SI.
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
    let groups = [tip, angles].map(|columns| ColumnGroup { columns });
    write_over_time(out, ("time", &columns.time_s), &groups, digits)
}

/// Reads the first row, and checks that its columns describe a path.
fn path_columns(header: Header) -> Result<Columns, TableError> {
    let Header { fields, place, .. } = header;
    let mut columns = Columns::find(&PATH, header, Beside::Time)?;
    columns.require(TIME, header).map_err(|error| error.or_hint(BY_OPTION.to_owned()))?;
    let hint =
        format!("the path of an arm has time, x and y, or time, angle1, angle2, …; {BY_OPTION}");
    check_places(&columns, header, BY_OPTION, &hint)?;
    if !columns.has(PATH_X) && !ANGLES.iter().any(|quantity| columns.has(*quantity)) {
        return Err(refuse_missing(&names(fields), "x and y, or angle1", place).with_hint(hint));
    }
    columns.reading.unread = unread(&columns, fields, &PATH, BY_OPTION);
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(file: &str) -> String {
        let read = read_path_table("p.csv", file.as_bytes(), &TableFormat::default());
        read.and_then(|table| table.path(&[0.5, 0.4])).unwrap_err().to_string()
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
}
