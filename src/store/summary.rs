//! summary.json: what went in, what came out, and how far it can be trusted.

use serde::Serialize;

use super::json_record::FORMAT;
use super::link_record::{DriveRecord, LinkRecord};
use super::records::{CheckRecord, Fingerprint, MeshRecord, WarningRecord, json};
use crate::csv::InputFile;
use crate::inverse::{Accuracy, QuantityErrors, Solution};
use crate::modal::{REPORTED_MODES, REPORTED_ZEROS};
use crate::motion::TipMotion;
use crate::result::{Exceeded, Metrics, MotorMetrics, Remark};
use crate::verify::Verification;

/// What a run was given.
#[derive(Debug, Clone, Copy)]
pub struct RunInputs<'a> {
    /// The link file.
    pub link_file: &'a InputFile,
    /// The trajectory file.
    pub motion_file: &'a InputFile,
    /// The arguments that shape the results beside the files, in order, as the program takes them:
    /// `--set`, `payload.mass=0`.
    pub arguments: &'a [String],
    /// What verifying the answer gave, if it was verified.
    pub verification: Option<&'a Verification>,
    /// What is possible but rare in link and motion.
    pub remarks: &'a [Remark],
}

/// The content of summary.json, in the order of its keys.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    format: u32,
    flexlink: &'static str,
    command: &'static str,
    title: String,
    inputs: Inputs,
    link: LinkRecord,
    drive: Option<DriveRecord>,
    mesh: MeshRecord,
    motion: MotionRecord,
    periods_s: Vec<f64>,
    natural_frequencies_hz: Vec<f64>,
    modal_damping_ratios: Vec<f64>,
    zeros_per_s: Vec<f64>,
    analysis: AnalysisRecord,
    results: Results,
    errors: Errors,
    verification: Option<Vec<CheckRecord>>,
    warnings: Vec<WarningRecord>,
    remarks: Vec<WarningRecord>,
    files: Vec<&'static str>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Inputs {
    link: Fingerprint,
    motion: Fingerprint,
    arguments: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct MotionRecord {
    given: &'static str,
    samples: usize,
    step_s: f64,
    start_s: f64,
    moves_from_s: f64,
    moves_until_s: f64,
    travel_m: f64,
    peak_velocity_m_s: f64,
    peak_acceleration_m_s2: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct AnalysisRecord {
    tolerance: f64,
    tip_tolerance: f64,
    /// Nothing where every frequency of the samples is solved for.
    band_hz: Option<f64>,
    /// Nothing where all modes are kept.
    modes: Option<usize>,
    period_s: f64,
    fft_length: usize,
    frequencies: usize,
    highest_frequency_hz: f64,
    nyquist_hz: f64,
    window_start_s: f64,
    window_end_s: f64,
    rows: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Results {
    peak_torque_n_m: f64,
    peak_torque_time_s: f64,
    rms_torque_n_m: f64,
    peak_rigid_torque_n_m: f64,
    torque_ratio: f64,
    lead_s: f64,
    lag_s: f64,
    peak_hub_angle_rad: f64,
    peak_hub_rate_rad_s: f64,
    peak_power_w: f64,
    peak_root_moment_n_m: f64,
    peak_deflection_m: f64,
    /// Keys that only a link with a drive has.
    #[serde(flatten)]
    motor: Option<MotorResults>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct MotorResults {
    peak_motor_torque_n_m: f64,
    peak_motor_torque_time_s: f64,
    rms_motor_torque_n_m: f64,
    peak_motor_rate_rad_s: f64,
    peak_motor_power_w: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Errors {
    tip: f64,
    torque: QuantityRecord,
    hub_angle: QuantityRecord,
    hub_rate: QuantityRecord,
    hub_acceleration: Option<QuantityRecord>,
    displacement: Option<QuantityRecord>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bending_moment: Option<QuantityRecord>,
    motor_torque: Option<QuantityRecord>,
    motor_rate: Option<QuantityRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct QuantityRecord {
    mesh: f64,
    window: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    modes: Option<f64>,
}

impl Summary {
    /// Gathers the summary of a solution, its metrics and the limits that it exceeds; `files` are
    /// the names of what is written with it.
    pub fn new(
        inputs: &RunInputs,
        solution: &Solution,
        metrics: &Metrics,
        exceeded: &[Exceeded],
        files: Vec<&'static str>,
    ) -> Self {
        let link = solution.link();
        let hertz = |omega: &f64| omega / std::f64::consts::TAU;
        let frequencies = solution.natural_frequencies_rad_s(REPORTED_MODES);
        Self {
            format: FORMAT,
            flexlink: env!("CARGO_PKG_VERSION"),
            command: "solve",
            title: link.title().to_owned(),
            inputs: Inputs {
                link: Fingerprint::of(inputs.link_file),
                motion: Fingerprint::of(inputs.motion_file),
                arguments: inputs.arguments.to_vec(),
            },
            link: LinkRecord::new(link, solution.law()),
            drive: link.drive().map(DriveRecord::of),
            mesh: MeshRecord::of(solution.mesh()),
            motion: MotionRecord::new(&solution.motion, metrics),
            periods_s: frequencies.iter().map(|omega| hertz(omega).recip()).collect(),
            natural_frequencies_hz: frequencies.iter().map(hertz).collect(),
            modal_damping_ratios: solution.law().modal_ratios(&frequencies),
            zeros_per_s: solution.zeros_per_s(REPORTED_ZEROS),
            analysis: AnalysisRecord::new(solution),
            results: Results::new(metrics),
            errors: Errors::of(&solution.accuracy),
            verification: inputs.verification.map(CheckRecord::all),
            warnings: warnings(solution, exceeded),
            remarks: inputs.remarks.iter().map(remark).collect(),
            files,
        }
    }

    /// The JSON text, indented, with a final line end.
    ///
    /// # Panics
    /// Never: the summary holds nothing that JSON cannot.
    pub fn to_json(&self) -> String {
        json(self)
    }
}

fn remark(remark: &Remark) -> WarningRecord {
    WarningRecord {
        kind: remark.kind().into(),
        message: remark.to_string(),
        hint: remark.hint().into(),
    }
}

fn warnings(solution: &Solution, exceeded: &[Exceeded]) -> Vec<WarningRecord> {
    let record = |warning: &crate::inverse::Warning| WarningRecord {
        kind: warning.kind().into(),
        message: warning.to_string(),
        hint: warning.hint().into(),
    };
    let limit = |exceeded: &Exceeded| WarningRecord {
        kind: Exceeded::KIND.into(),
        message: exceeded.to_string(),
        hint: exceeded.hint().into(),
    };
    solution.warnings.iter().map(record).chain(exceeded.iter().map(limit)).collect()
}

impl MotionRecord {
    fn new(motion: &TipMotion, metrics: &Metrics) -> Self {
        let (grid, (from, until)) = (motion.grid(), motion.moving_samples());
        Self {
            given: if motion.is_from_displacement() { "displacement" } else { "acceleration" },
            samples: grid.len,
            step_s: grid.step_s,
            start_s: grid.origin_s,
            moves_from_s: grid.time_s(from),
            moves_until_s: grid.time_s(until),
            travel_m: motion.travel_m(),
            peak_velocity_m_s: metrics.peak_tip_velocity_m_s.value,
            peak_acceleration_m_s2: metrics.peak_tip_acceleration_m_s2.value,
        }
    }
}

impl AnalysisRecord {
    fn new(solution: &Solution) -> Self {
        let Solution { analysis, band, grid, .. } = solution;
        Self {
            tolerance: analysis.tolerance(),
            tip_tolerance: analysis.tip_tolerance(),
            band_hz: band.cutoff_hz,
            modes: analysis.modes(),
            period_s: band.period_s,
            fft_length: band.fft_length,
            frequencies: band.frequencies,
            highest_frequency_hz: band.highest_hz,
            nyquist_hz: band.nyquist_hz,
            window_start_s: grid.time_s(0),
            window_end_s: grid.time_s(grid.len - 1),
            rows: grid.len,
        }
    }
}

impl Errors {
    fn of(accuracy: &Accuracy) -> Self {
        let record = |errors: QuantityErrors| {
            let QuantityErrors { mesh, window, step, modes } = errors;
            QuantityRecord { mesh, window, step, modes }
        };
        let errors = &accuracy.errors;
        Self {
            tip: accuracy.tip,
            torque: record(errors.torque),
            hub_angle: record(errors.hub_angle),
            hub_rate: record(errors.hub_rate),
            hub_acceleration: errors.hub_acceleration.map(record),
            displacement: errors.displacement.map(record),
            bending_moment: errors.bending_moment.map(record),
            motor_torque: errors.motor_torque.map(record),
            motor_rate: errors.motor_rate.map(record),
        }
    }
}

impl Results {
    fn new(metrics: &Metrics) -> Self {
        Self {
            peak_torque_n_m: metrics.peak_torque_n_m.value,
            peak_torque_time_s: metrics.peak_torque_n_m.time_s,
            rms_torque_n_m: metrics.rms_torque_n_m,
            peak_rigid_torque_n_m: metrics.peak_rigid_torque_n_m.value,
            torque_ratio: metrics.torque_ratio,
            lead_s: metrics.lead_s,
            lag_s: metrics.lag_s,
            peak_hub_angle_rad: metrics.peak_hub_angle_rad.value,
            peak_hub_rate_rad_s: metrics.peak_hub_rate_rad_s.value,
            peak_power_w: metrics.peak_power_w.value,
            peak_root_moment_n_m: metrics.peak_root_moment_n_m.value,
            peak_deflection_m: metrics.peak_deflection_m.value,
            motor: metrics.motor.as_ref().map(MotorResults::new),
        }
    }
}

impl MotorResults {
    fn new(motor: &MotorMetrics) -> Self {
        Self {
            peak_motor_torque_n_m: motor.peak_torque_n_m.value,
            peak_motor_torque_time_s: motor.peak_torque_n_m.time_s,
            rms_motor_torque_n_m: motor.rms_torque_n_m,
            peak_motor_rate_rad_s: motor.peak_rate_rad_s.value,
            peak_motor_power_w: motor.peak_power_w.value,
        }
    }
}
