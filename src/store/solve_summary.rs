//! The summary of `solve`.

use std::f64::consts::TAU;

use super::json::Fingerprint;
use super::numbers::Numbers;
use super::summary::{AnalysisRecord, CheckRecord, Inputs, MotionRecord, Summary};
use crate::csv::InputFile;
use crate::inverse::{Accuracy, QuantityErrors, Solution, Warning};
use crate::modal::{REPORTED_MODES, REPORTED_ZEROS};
use crate::motion::TipMotion;
use crate::result::{Exceeded, Metrics, Remark, StoredWarning};
use crate::verify::Verification;

/// What a run of `solve` was given.
#[derive(Debug, Clone, Copy)]
pub struct RunInputs<'a> {
    /// The link file.
    pub link_file: &'a InputFile,
    /// The trajectory file.
    pub motion_file: &'a InputFile,
    /// Arguments that shape the results beside the files, in order, as the program takes them: `--set`,
    /// `payload.mass=0`.
    pub arguments: &'a [String],
    /// Checks of the answer, if it was verified.
    pub verification: Option<&'a Verification>,
    /// Remarks on link and motion.
    pub remarks: &'a [Remark],
}

impl Summary {
    /// Gathers the summary of a solution, its metrics and the limits that it exceeds; `files` are
    /// the names of all files of the run.
    pub fn of_solution(
        inputs: &RunInputs,
        solution: &Solution,
        metrics: &Metrics,
        exceeded: &[Exceeded],
        files: &[&str],
    ) -> Self {
        let hertz = |omega: &f64| omega / TAU;
        let frequencies = solution.natural_frequencies_rad_s(REPORTED_MODES);
        let files_in = Inputs {
            link: Fingerprint::of(inputs.link_file),
            motion: Some(Fingerprint::of(inputs.motion_file)),
            torque: None,
            target: None,
            reference: None,
            arguments: inputs.arguments.to_vec(),
        };
        let link = solution.link();
        Self {
            drive: Some(link.drive().copied()),
            motion: Some(motion_record(&solution.motion, metrics)),
            periods_s: frequencies.iter().map(|omega| hertz(omega).recip()).collect(),
            natural_frequencies_hz: Some(frequencies.iter().map(hertz).collect()),
            modal_damping_ratios: Some(solution.law().modal_ratios(&frequencies)),
            zeros_per_s: Some(solution.zeros_per_s(REPORTED_ZEROS)),
            analysis: Some(analysis_record(solution)),
            errors: Some(errors(&solution.accuracy)),
            verification: Some(inputs.verification.map(CheckRecord::all)),
            warnings: warnings(solution, exceeded),
            remarks: Some(inputs.remarks.iter().map(remark).collect()),
            files: files.iter().map(|&file| file.to_owned()).collect(),
            ..Self::begun(
                "solve",
                files_in,
                (link, solution.law(), solution.mesh()),
                results(metrics),
            )
        }
    }
}

fn motion_record(motion: &TipMotion, metrics: &Metrics) -> MotionRecord {
    let (grid, (from, until)) = (motion.grid(), motion.moving_samples());
    MotionRecord {
        given: if motion.is_from_displacement() { "displacement" } else { "acceleration" }.into(),
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

fn analysis_record(solution: &Solution) -> AnalysisRecord {
    let Solution { analysis, band, grid, .. } = solution;
    AnalysisRecord {
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

fn results(metrics: &Metrics) -> Numbers {
    let results = Numbers::of([
        ("peak_torque_n_m", metrics.peak_torque_n_m.value),
        ("peak_torque_time_s", metrics.peak_torque_n_m.time_s),
        ("rms_torque_n_m", metrics.rms_torque_n_m),
        ("peak_rigid_torque_n_m", metrics.peak_rigid_torque_n_m.value),
        ("torque_ratio", metrics.torque_ratio),
        ("lead_s", metrics.lead_s),
        ("lag_s", metrics.lag_s),
        ("peak_hub_angle_rad", metrics.peak_hub_angle_rad.value),
        ("peak_hub_rate_rad_s", metrics.peak_hub_rate_rad_s.value),
        ("peak_power_w", metrics.peak_power_w.value),
        ("peak_root_moment_n_m", metrics.peak_root_moment_n_m.value),
        ("peak_deflection_m", metrics.peak_deflection_m.value),
    ]);
    let Some(motor) = &metrics.motor else { return results };
    results
        .with("peak_motor_torque_n_m", motor.peak_torque_n_m.value)
        .with("peak_motor_torque_time_s", motor.peak_torque_n_m.time_s)
        .with("rms_motor_torque_n_m", motor.rms_torque_n_m)
        .with("peak_motor_rate_rad_s", motor.peak_rate_rad_s.value)
        .with("peak_motor_power_w", motor.peak_power_w.value)
}

fn errors(accuracy: &Accuracy) -> Numbers {
    let of = |errors: QuantityErrors| {
        Numbers::of([("mesh", errors.mesh), ("window", errors.window)])
            .with_some("step", errors.step)
            .with_some("modes", errors.modes)
    };
    let errors = &accuracy.errors;
    Numbers::of([("tip", accuracy.tip)])
        .with("torque", of(errors.torque))
        .with("hub_angle", of(errors.hub_angle))
        .with("hub_rate", of(errors.hub_rate))
        .with("hub_acceleration", errors.hub_acceleration.map(of))
        .with("displacement", errors.displacement.map(of))
        .with_some("bending_moment", errors.bending_moment.map(of))
        .with("motor_torque", errors.motor_torque.map(of))
        .with("motor_rate", errors.motor_rate.map(of))
}

fn warnings(solution: &Solution, exceeded: &[Exceeded]) -> Vec<StoredWarning> {
    let warning = |w: &Warning| StoredWarning::new(w.kind(), w, w.hint());
    let limit = |e: &Exceeded| StoredWarning::new(Exceeded::KIND, e, e.hint());
    solution.warnings.iter().map(warning).chain(exceeded.iter().map(limit)).collect()
}

fn remark(remark: &Remark) -> StoredWarning {
    StoredWarning::new(remark.kind(), remark, remark.hint())
}
