use crate::motion::{MotionColumns, TipMotion, TipTarget};
use crate::numeric::TimeGrid;

use super::quantity::Quantity;
use super::samples::Samples;
use super::table_error::{Place, TableError};
use super::trajectory_header::read_trajectory_header;

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

    /// The displacement as a target to compare with.
    ///
    /// A target need not be at rest at its ends. Columns beside the displacement are not looked at.
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
    /// [`TableError`] where there is no displacement, or a time is off the uniform grid.
    pub fn into_target(self) -> Result<TipTarget, TableError> {
        let Self { columns, name, lines } = self;
        let place = Place { file: &name, line: None };
        let Some(displacement_m) = columns.displacement_m else {
            let must = "must be given of a target, as displacement or angle";
            let hint = "an acceleration leaves open where the tip is; tip.csv of `flexlink solve` \
                        holds the displacement";
            let error = place.refuse("displacement", "nothing", must);
            return Err(error.with_hint(hint.to_owned()));
        };
        let grid = TimeGrid::through(&columns.time_s).map_err(|error| {
            let place = Place { line: Some(lines[error.sample]), ..place };
            place.refuse_whole(error.to_string()).with_hint(error.hint().to_owned())
        })?;
        Ok(TipTarget::new(grid, displacement_m))
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
/// use flexlink::csv::read_motion_table;
/// let file = b"time [ms],displacement [cm]\n0,0\n1,0.5\n2,1.5\n3,2\n";
/// let motion = read_motion_table("move.csv", file, 1.5)?;
/// let displacement_m = motion.columns.displacement_m.as_deref();
/// assert!((displacement_m.unwrap()[3] - 0.02).abs() < 1e-15);
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names the file, and line and column where they are at fault.
pub fn read_motion_table(
    name: &str,
    bytes: &[u8],
    link_length_m: f64,
) -> Result<MotionTable, TableError> {
    let mut samples = Samples::read(name, bytes, read_trajectory_header)?;
    let arc = samples.take(Quantity::Angle).map(|mut angle| {
        for value in &mut angle {
            *value *= link_length_m;
        }
        angle
    });
    let columns = MotionColumns {
        time_s: samples.take(Quantity::Time).unwrap_or_default(),
        acceleration_m_s2: samples.take(Quantity::Acceleration),
        velocity_m_s: samples.take(Quantity::Velocity),
        displacement_m: samples.take(Quantity::Displacement).or(arc),
    };
    Ok(MotionTable { columns, name: name.to_owned(), lines: samples.lines })
}
