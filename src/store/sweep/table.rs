//! The table of a sweep: a row for every case, as it is written and as it is checked when it is read.

use std::f64::consts::TAU;

use csv::ReaderBuilder;

use super::identity::SweepIdentity;
use crate::csv::{NumberFormat, Place, TableError, quoted};
use crate::inverse::Solution;
use crate::modal::torque_zeros;
use crate::numeric::rounded;
use crate::response::Simulation;
use crate::result::{Metrics, MotorMetrics, PlayedMetrics, TipError};
use crate::sweep::{CaseValues, SweepPlan, Variation};

/// Significant digits of a number in the table. Rows are written as they come, before the peak of
/// their column is known.
const DIGITS: usize = 12;

/// The column of the kinds of a case's warnings, with `;` between them.
pub(super) const WARNINGS: &str = "warnings";

/// The last column: why a case has no numbers.
pub(super) const ERROR: &str = "error";

/// A case whose torque was computed.
#[derive(Clone, Copy)]
pub struct SolvedCase<'a> {
    /// The solution.
    pub solution: &'a Solution,
    /// Its metrics.
    pub metrics: &'a Metrics,
    /// Its first natural frequency in rad/s; none if nothing vibrates.
    pub first_rad_s: Option<f64>,
}

/// A case on which a torque was played.
#[derive(Debug, Clone, Copy)]
pub struct PlayedCase<'a> {
    /// The simulation.
    pub simulation: &'a Simulation,
    /// Its metrics.
    pub metrics: &'a PlayedMetrics,
    /// The error of the tip against its target.
    pub tip_error: &'a TipError,
}

/// A column and the number that it shows of a case, where it has one.
type Solved = (&'static str, fn(&SolvedCase<'_>) -> Option<f64>);
type Played = (&'static str, fn(&PlayedCase<'_>) -> Option<f64>);

const SOLVED: [Solved; 16] = [
    ("period_1_s", |case| case.first_rad_s.map(|omega| TAU / omega)),
    ("zero_1_per_s", |case| case.solution.first_zero_per_s),
    ("peak_torque_n_m", |case| Some(case.metrics.peak_torque_n_m.value)),
    ("rms_torque_n_m", |case| Some(case.metrics.rms_torque_n_m)),
    ("peak_rigid_torque_n_m", |case| Some(case.metrics.peak_rigid_torque_n_m.value)),
    ("torque_ratio", |case| Some(case.metrics.torque_ratio)),
    ("lead_s", |case| Some(case.metrics.lead_s)),
    ("lag_s", |case| Some(case.metrics.lag_s)),
    ("peak_hub_rate_rad_s", |case| Some(case.metrics.peak_hub_rate_rad_s.value)),
    ("peak_power_w", |case| Some(case.metrics.peak_power_w.value)),
    ("peak_root_moment_n_m", |case| Some(case.metrics.peak_root_moment_n_m.value)),
    ("peak_deflection_m", |case| Some(case.metrics.peak_deflection_m.value)),
    ("band_hz", |case| Some(case.solution.band.cutoff_hz.unwrap_or(case.solution.band.highest_hz))),
    ("tip_error", |case| Some(case.solution.accuracy.tip)),
    ("torque_mesh_error", |case| Some(case.solution.accuracy.errors.torque.mesh)),
    ("torque_window_error", |case| Some(case.solution.accuracy.errors.torque.window)),
];

const DRIVEN: [Solved; 4] = [
    ("peak_motor_torque_n_m", |case| of_motor(case, |motor| motor.peak_torque_n_m.value)),
    ("rms_motor_torque_n_m", |case| of_motor(case, |motor| motor.rms_torque_n_m)),
    ("peak_motor_rate_rad_s", |case| of_motor(case, |motor| motor.peak_rate_rad_s.value)),
    ("peak_motor_power_w", |case| of_motor(case, |motor| motor.peak_power_w.value)),
];

const PLAYED: [Played; 14] = [
    ("period_1_s", |case| {
        case.simulation.natural_frequencies_rad_s.first().map(|omega| TAU / omega)
    }),
    ("zero_1_per_s", |case| torque_zeros(&case.simulation.mesh, 1).first().copied()),
    ("tip_error_m", |case| Some(case.tip_error.worst_m)),
    ("tip_error_share", |case| Some(case.tip_error.share)),
    ("tip_error_time_s", |case| Some(case.tip_error.time_s)),
    ("rms_tip_error_m", |case| Some(case.tip_error.rms_m)),
    ("final_tip_error_m", |case| Some(case.tip_error.final_m)),
    ("residual_m", |case| Some(case.simulation.residual.amplitude_m)),
    ("residual_share", |case| Some(case.simulation.residual.share)),
    ("residual_frequency_hz", |case| case.simulation.residual.frequency_hz),
    ("residual_decay_s", |case| case.simulation.residual.decay_s),
    ("peak_hub_rate_rad_s", |case| Some(case.metrics.peak_hub_rate_rad_s.value)),
    ("peak_power_w", |case| Some(case.metrics.peak_power_w.value)),
    ("peak_deflection_m", |case| Some(case.metrics.peak_deflection_m.value)),
];

fn of_motor(case: &SolvedCase, number: fn(&MotorMetrics) -> f64) -> Option<f64> {
    case.metrics.motor.as_ref().map(number)
}

/// Which numbers a sweep has of its cases: the columns between those of the variations and the last two,
/// `warnings` and `error`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SweepKind {
    /// Of the torque for the motion.
    Solved,
    /// Of that of a link with a drive, with those of its motor.
    Driven,
    /// Of one torque played on every case.
    Played,
}

/// The numbers of a case, in the order of the columns; none where a case has no such number.
pub type CaseNumbers = Vec<Option<f64>>;

impl SweepKind {
    /// Names of the columns.
    pub(super) fn names(self) -> Vec<&'static str> {
        match self {
            Self::Solved => SOLVED.map(|(name, _)| name).into(),
            Self::Driven => [&SOLVED[..], &DRIVEN].concat().iter().map(|(name, _)| *name).collect(),
            Self::Played => PLAYED.map(|(name, _)| name).into(),
        }
    }

    /// The numbers of a solved case.
    pub fn solved(self, case: &SolvedCase) -> CaseNumbers {
        let driven = DRIVEN.iter().filter(|_| self == Self::Driven);
        SOLVED.iter().chain(driven).map(|(_, of)| of(case)).collect()
    }

    /// The numbers of a case on which a torque was played.
    pub fn played(case: &PlayedCase) -> CaseNumbers {
        PLAYED.iter().map(|(_, of)| of(case)).collect()
    }
}

/// The row that names the columns, with its line end.
pub fn sweep_header(plan: &SweepPlan, kind: SweepKind) -> String {
    let varied = plan.variations().iter().map(|variation| field(&variation.heading()));
    let numbers = kind.names().into_iter().map(str::to_owned);
    line(varied.chain(numbers).chain([WARNINGS, ERROR].map(str::to_owned)))
}

/// The row of a case, with its line end: its values, its numbers or why it has none, and the kinds of
/// its warnings.
pub fn sweep_row(
    case: &CaseValues,
    outcome: &Result<CaseNumbers, String>,
    kind: SweepKind,
    warnings: &[&str],
) -> String {
    let number = |value: Option<f64>| {
        let mut text = Vec::new();
        if let Some(value) = value.filter(|value| value.is_finite()) {
            NumberFormat::Shortest.write(&mut text, rounded(value, DIGITS));
        }
        String::from_utf8_lossy(&text).into_owned()
    };
    let numbers = match outcome {
        Ok(numbers) => numbers.clone(),
        Err(_) => vec![None; kind.names().len()],
    };
    let numbers = numbers.into_iter().map(number);
    let error = outcome.as_ref().err().map_or_else(String::new, |error| field(error));
    let values = case.values.iter().map(|value| field(value));
    line(values.chain(numbers).chain([field(&warnings.join(";")), error]))
}

fn line(fields: impl Iterator<Item = String>) -> String {
    fields.collect::<Vec<_>>().join(",") + "\n"
}

/// Text on one line.
fn one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// Text as one field of one line.
fn field(text: &str) -> String {
    let text = one_line(text);
    let plain = !text.contains([',', '"']) && text.trim() == text && !text.starts_with('#');
    if plain { text } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

/// Refuses a row of names that is not that of the sweep.
pub(super) fn check_names(
    identity: &SweepIdentity,
    names: &[String],
    place: Place,
) -> Result<(), TableError> {
    let headings = identity.plan().variations().iter().map(Variation::heading);
    for (k, heading) in headings.enumerate() {
        let found = names.get(k).map_or("", String::as_str);
        if found != heading {
            let must = format!("must be {}", quoted(&heading));
            return Err(place.refuse(format!("column {}", k + 1), quoted(found), must));
        }
    }
    if names.ends_with(&[WARNINGS.to_owned(), ERROR.to_owned()]) {
        return Ok(());
    }
    let must = format!("must end with {WARNINGS}, {ERROR}");
    Err(place.refuse("columns", quoted(&names.join(",")), must))
}

/// Refuses row `k` where it is not that of its case: its values those of the case, then numbers, or
/// none where it failed.
pub(super) fn check_row(
    identity: &SweepIdentity,
    names: &[String],
    k: usize,
    fields: &[String],
    place: Place,
) -> Result<(), TableError> {
    if fields.len() != names.len() {
        let must = format!("must be {}, as many as there are columns", names.len());
        return Err(place.refuse("fields", fields.len().to_string(), must));
    }
    let case = identity.shard().case(k);
    let values = identity.plan().case(case).values;
    for ((name, found), value) in names.iter().zip(fields).zip(&values) {
        let value = one_line(value);
        if *found != value {
            let must = format!("must be {}, the value of case {}", quoted(&value), case + 1);
            return Err(place.refuse(name, quoted(found), must));
        }
    }
    let numbers = values.len()..fields.len() - 1;
    let failed = fields.last().is_some_and(|error| !error.is_empty());
    for (name, found) in names[numbers.clone()].iter().zip(&fields[numbers]) {
        let is_number = found.parse().is_ok_and(f64::is_finite);
        let must = match found.as_str() {
            "" => continue,
            _ if failed => "must be nothing: the case has an error",
            _ if !is_number && name != WARNINGS => "must be a finite number or nothing",
            _ => continue,
        };
        return Err(place.refuse(name, quoted(found), must));
    }
    Ok(())
}

/// The fields of one row; none if it is no CSV.
pub(super) fn fields(row: &str) -> Vec<String> {
    let mut reader = ReaderBuilder::new().has_headers(false).from_reader(row.as_bytes());
    let record = reader.records().next().and_then(Result::ok);
    record.map(|fields| fields.iter().map(str::to_owned).collect()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::MotionScale;

    #[test]
    fn fields_that_would_part_or_comment_a_row_are_quoted() {
        assert_eq!(field("segments.*.EI [N cm^2]"), "segments.*.EI [N cm^2]");
        assert_eq!(field("[0.01, 0.02]"), "\"[0.01, 0.02]\"");
        assert_eq!(field("link \"a\"\nline"), "\"link \"\"a\"\" line\"");
        assert_eq!(field("#1"), "\"#1\"");
    }

    #[test]
    fn a_failed_case_has_empty_numbers_and_says_why() {
        let case = CaseValues {
            values: vec!["2".into()],
            link_changes: vec![],
            motion: MotionScale::default(),
        };
        let row =
            sweep_row(&case, &Err("damping.ratio = 2, too much".into()), SweepKind::Solved, &[]);
        assert_eq!(row, format!("2{}\"damping.ratio = 2, too much\"\n", ",".repeat(18)));
        let plan = SweepPlan::new(vec!["damping.ratio=2".parse().unwrap()]).unwrap();
        let header = sweep_header(&plan, SweepKind::Solved);
        assert_eq!(header.matches(',').count(), 18);
        assert!(header.starts_with("damping.ratio,period_1_s,zero_1_per_s,peak_torque_n_m,"));
        assert!(header.ends_with(
            ",band_hz,tip_error,torque_mesh_error,torque_window_error,warnings,error\n"
        ));
    }
}
