//! Motions and paths from a program's numbers: without file and lines, but with the same checks, digits and remedies.

use std::fmt::Write as _;

use super::format::Reading;
use super::motion::{MotionTable, SampleRows, Sampled};
use super::outliers::Judged;
use super::place::Place;
use super::quality::digits_of;
use super::rows::TableError;
use super::uniform::MIN_SAMPLES;
use crate::motion::{Ends, MotionColumns, PathColumns, Uncertainty};
use crate::recording::{Change, Digits, Rounding};

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
    let mut digits = Digits::default();
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
    use super::super::motion::read_motion_table;
    use super::*;

    fn refused(time_s: &[f64], displacement_m: &[f64]) -> String {
        let displacement_m = Some(displacement_m.to_vec());
        let columns =
            MotionColumns { time_s: time_s.to_vec(), displacement_m, ..MotionColumns::default() };
        MotionTable::of_columns("motion", columns).unwrap_err().to_string()
    }

    #[test]
    fn what_no_file_may_hold_is_refused_with_its_index() {
        let times = [0.0, 0.1, 0.2, 0.3];
        assert_eq!(refused(&times[..3], &[0.0; 3]), "motion: samples = 3, but must be 4 or more");
        let short = refused(&times, &[0.0; 3]);
        assert_eq!(short, "motion: samples of displacement = 3, but must be 4, as many as times");
        let not_a_number = refused(&times, &[0.0, f64::NAN, 0.0, 0.0]);
        assert_eq!(not_a_number, "motion: displacement[1] = NaN, but must be a finite number");
        let turned = refused(&[0.0, 0.2, 0.1, 0.3], &[0.0; 4]);
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
