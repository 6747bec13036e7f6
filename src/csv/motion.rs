use std::io::{self, Write};

use super::error::{Place, TableError, quoted};
use super::heading::{
    Header, Heading, Quantity, TRAJECTORY, check_names, check_single, nearest, refuse_missing,
    split_unit,
};
use super::number::Digits;
use super::samples::Samples;
use super::table::{group, write_over_time};
use crate::motion::{MotionColumns, TipMotion, TipTarget};
use crate::numeric::TimeGrid;

/// A tip motion read from a file, in SI, with the line of each sample.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionTable {
    /// The samples.
    pub columns: MotionColumns,
    pub(super) name: String,
    pub(super) lines: Vec<u64>,
}

impl MotionTable {
    /// Line of a sample in the file, from 1; in a resampled motion, the line of the last sample of the
    /// file that is not later.
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

    /// The file as the user named it.
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// Reads a tip trajectory: a row of names, then a row for each sample.
///
/// An angle gives the displacement, `angle · link_length_m`. Times must increase; they need not be
/// uniform.
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

/// Reads the first row, and checks that the columns describe a motion.
///
/// An unknown column is refused: it may be a known one misspelt.
pub(super) fn read_trajectory_header(fields: &[&str], place: Place) -> Result<Header, TableError> {
    check_names(fields, &TRAJECTORY, place)?;
    let mut headings: Vec<Heading> = Vec::new();
    for (index, field) in fields.iter().enumerate() {
        let heading = Heading::read(index, field, &TRAJECTORY, place)?
            .ok_or_else(|| unknown_column(index, field, place))?;
        check_single(&headings, &heading, place)?;
        check_arc(&headings, &heading, place)?;
        headings.push(heading);
    }
    check_motion(&headings, place)?;
    Ok(Header { width: fields.len(), headings })
}

fn unknown_column(index: usize, field: &str, place: Place) -> TableError {
    let subject = format!("column {}", index + 1);
    let words: Vec<&str> = TRAJECTORY.quantities.iter().map(|quantity| quantity.word()).collect();
    let must = format!("must be one of {}", words.join(", "));
    let (name, _) = split_unit(field);
    place.refuse(subject, quoted(field), must).with_hint(hint_for(&TRAJECTORY.plain(name)))
}

/// What the user may have meant by an unknown name.
fn hint_for(name: &str) -> Option<String> {
    if name.is_empty() {
        return Some("a comma at the end of the row begins a column of its own".to_owned());
    }
    if name.starts_with("hub_") {
        return Some("a trajectory holds the tip's motion; the hub's follows from it".to_owned());
    }
    let begins = |quantity: &&Quantity| {
        let rest = name.strip_prefix(quantity.word());
        rest.is_some_and(|rest| rest.starts_with(['_', '(', '[', ' ']))
    };
    if let Some(quantity) = TRAJECTORY.quantities.iter().find(begins) {
        let [_, unit] = quantity.units();
        let word = quantity.word();
        return Some(format!("a unit follows in brackets: {word} [{unit}]"));
    }
    let words = TRAJECTORY.quantities.iter().map(|quantity| quantity.word());
    nearest(name, words).map(|word| format!("did you mean {word}?"))
}

/// Refuses an angle beside a displacement.
fn check_arc(before: &[Heading], heading: &Heading, place: Place) -> Result<(), TableError> {
    let is_arc =
        |heading: &&Heading| matches!(heading.quantity, Quantity::Displacement | Quantity::Angle);
    let Some(earlier) = before.iter().find(is_arc).filter(|_| is_arc(&heading)) else {
        return Ok(());
    };
    let same = format!("{}, {}", earlier.subject(), quoted(&earlier.name));
    let must = format!("must not stand beside {same}: they are two names of one thing");
    let hint = "displacement = angle * link length; keep one of them";
    Err(place.refuse(heading.subject(), quoted(&heading.name), must).with_hint(hint.to_owned()))
}

fn check_motion(headings: &[Heading], place: Place) -> Result<(), TableError> {
    let has = |wanted| headings.iter().any(|heading| heading.quantity == wanted);
    let names: Vec<&str> = headings.iter().map(|h| h.name.as_str()).collect();
    if !has(Quantity::Time) {
        return Err(refuse_missing(&names, "time", place));
    }
    let moves = has(Quantity::Acceleration) || has(Quantity::Displacement) || has(Quantity::Angle);
    if !moves {
        return Err(refuse_missing(&names, "acceleration, displacement or angle", place));
    }
    Ok(())
}

/// Writes a trajectory as [`read_motion_table`] reads it: the time, and acceleration, velocity and
/// displacement as far as they are given, all in SI.
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
    let groups: Vec<_> = given
        .into_iter()
        .filter_map(|(name, values)| Some(group([(name, values.as_ref()?)])))
        .collect();
    let time_s = &columns.time_s;
    write_over_time(out, ("time", &|k| time_s[k]), time_s.len(), &groups, digits)
}
