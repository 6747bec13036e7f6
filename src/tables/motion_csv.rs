use crate::motion::{MotionColumns, TipMotion};

use super::header::{Heading, Quantity, read_header};
use super::rows::Rows;
use super::table_error::{Place, TableError, quoted};

/// Fewest samples that a trajectory may have.
pub(super) const MIN_SAMPLES: usize = 4;

/// A tip motion as read from a file, in SI, with the line of every sample.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionTable {
    /// The samples.
    pub columns: MotionColumns,
    pub(super) name: String,
    pub(super) lines: Vec<u64>,
}

impl MotionTable {
    /// Line of a sample in its file, from 1; of a resampled motion the line of the last sample
    /// read that is not later.
    ///
    /// # Panics
    /// If there is no such sample.
    pub fn line_of(&self, sample: usize) -> u64 {
        self.lines[sample]
    }

    /// Checks the samples and makes a motion of them.
    ///
    /// # Errors
    /// What [`TipMotion::new`] refuses, with file and line.
    pub fn into_motion(self) -> Result<TipMotion, TableError> {
        let Self { columns, name, lines } = self;
        TipMotion::new(columns).map_err(|error| {
            let line = error.sample().map(|sample| lines[sample]);
            let place = Place { file: &name, line };
            place.refuse_whole(error.to_string()).with_hint(error.hint().map(str::to_owned))
        })
    }

    /// The file, as the user named it.
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// Reads a tip trajectory: a row that names the columns, then a row for every sample.
///
/// An angle stands for the displacement, `angle · link_length_m`. That time advances is checked
/// here; that it is uniform, is not.
///
/// ```
/// use flexlink::tables::read_motion_table;
/// let file = b"time [ms],displacement [cm]\n0,0\n1,0.5\n2,1.5\n3,2\n";
/// let motion = read_motion_table("move.csv", file, 1.5)?;
/// let displacement_m = motion.columns.displacement_m.as_deref();
/// assert!((displacement_m.unwrap()[3] - 0.02).abs() < 1e-15);
/// # Ok::<(), flexlink::tables::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names the file, and line and column where they are at fault.
pub fn read_motion_table(
    name: &str,
    bytes: &[u8],
    link_length_m: f64,
) -> Result<MotionTable, TableError> {
    let whole = Place { file: name, line: None };
    let mut rows = Rows::new(name, bytes)?;
    let Some((line, fields)) = rows.next()? else {
        let must = format!("must hold a row of names and {MIN_SAMPLES} samples or more");
        return Err(whole.refuse("content", "nothing", must));
    };
    let place = Place { line: Some(line), ..whole };
    let mut samples = Samples::new(read_header(&fields, place)?);
    while let Some((line, fields)) = rows.next()? {
        let place = Place { line: Some(line), ..whole };
        samples.push(&fields, line, place)?;
    }
    if samples.lines.len() < MIN_SAMPLES {
        let found = samples.lines.len().to_string();
        return Err(whole.refuse("samples", found, format!("must be {MIN_SAMPLES} or more")));
    }
    Ok(samples.into_table(name, link_length_m))
}

/// The samples read so far.
struct Samples {
    headings: Vec<Heading>,
    /// Which of the columns is the time.
    time: usize,
    /// One column a heading, in SI.
    values: Vec<Vec<f64>>,
    lines: Vec<u64>,
    /// The last time as written.
    time_text: String,
}

impl Samples {
    fn new(headings: Vec<Heading>) -> Self {
        let is_time = |heading: &Heading| heading.quantity == Quantity::Time;
        Self {
            time: headings.iter().position(is_time).unwrap_or(0),
            values: vec![Vec::new(); headings.len()],
            headings,
            lines: Vec::new(),
            time_text: String::new(),
        }
    }

    fn push(&mut self, fields: &[&str], line: u64, place: Place) -> Result<(), TableError> {
        if fields.len() != self.headings.len() {
            let names = self.headings.len();
            let must = format!("must be {names}, as many as there are columns");
            return Err(place.refuse("fields", fields.len().to_string(), must));
        }
        for ((field, heading), values) in fields.iter().zip(&self.headings).zip(&mut self.values) {
            values.push(read_number(field, heading, place)?);
        }
        self.check_time(fields[self.time], place)?;
        fields[self.time].clone_into(&mut self.time_text);
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
        let Heading { name, unit_text, .. } = &self.headings[self.time];
        let must = format!("must be above {} {unit_text} of line {line}", self.time_text);
        Err(place.refuse(name, format!("{text} {unit_text}"), must))
    }

    fn into_table(self, name: &str, link_length_m: f64) -> MotionTable {
        let mut columns = MotionColumns::default();
        for (heading, mut values) in self.headings.iter().zip(self.values) {
            match heading.quantity {
                Quantity::Time => columns.time_s = values,
                Quantity::Acceleration => columns.acceleration_m_s2 = Some(values),
                Quantity::Velocity => columns.velocity_m_s = Some(values),
                Quantity::Displacement => columns.displacement_m = Some(values),
                Quantity::Angle => {
                    for angle in &mut values {
                        *angle *= link_length_m;
                    }
                    columns.displacement_m = Some(values);
                }
            }
        }
        MotionTable { columns, name: name.to_owned(), lines: self.lines }
    }
}

/// One field of a column, in SI.
fn read_number(field: &str, heading: &Heading, place: Place) -> Result<f64, TableError> {
    let finite = "must be a finite number";
    if field.is_empty() {
        return Err(place.refuse(&heading.name, "nothing", finite));
    }
    let Ok(number) = field.parse::<f64>() else {
        let decimal_comma = field.replace(',', ".").parse::<f64>().is_ok();
        let hint = decimal_comma.then(|| "decimals follow a point".to_owned());
        return Err(place.refuse(&heading.name, quoted(field), "must be a number").with_hint(hint));
    };
    let value = heading.to_si(number);
    if value.is_finite() { Ok(value) } else { Err(place.refuse(&heading.name, field, finite)) }
}
