//! The summary of `simulate`.

use std::f64::consts::TAU;

use super::json::Fingerprint;
use super::numbers::Numbers;
use super::summary::{Inputs, ModesRecord, Summary, TorqueRecord};
use crate::csv::InputFile;
use crate::link::Link;
use crate::response::{Interpolation, Play, PlayError, Simulation};
use crate::result::{PlayedMetrics, StoredWarning, TipError};

/// What a simulation was given.
#[derive(Debug, Clone, Copy)]
pub struct SimulationInputs<'a> {
    /// The link file.
    pub link_file: &'a InputFile,
    /// The torque file.
    pub torque_file: &'a InputFile,
    /// The target file, if there is one.
    pub target_file: Option<&'a InputFile>,
    /// The reference file of feedback, if there is one.
    pub reference_file: Option<&'a InputFile>,
    /// The link that was read.
    pub link: &'a Link,
    /// What was played.
    pub play: &'a Play<'a>,
    /// Arguments that shape the results beside the files, in order, as the program takes them:
    /// `--set`, `payload.mass=0`.
    pub arguments: &'a [String],
}

impl Summary {
    /// Gathers the summary of a simulation, with the errors of its mesh and modes and the tip's error
    /// against its target; `files` are the names of all files of the run.
    pub fn of_simulation(
        inputs: &SimulationInputs,
        simulation: &Simulation,
        metrics: &PlayedMetrics,
        (error, tip_error): (Option<&PlayError>, Option<&TipError>),
        files: &[&str],
    ) -> Self {
        let frequencies = &simulation.natural_frequencies_rad_s;
        let files_in = Inputs {
            link: Fingerprint::of(inputs.link_file),
            motion: None,
            torque: Some(Fingerprint::of(inputs.torque_file)),
            target: Some(inputs.target_file.map(Fingerprint::of)),
            reference: Some(inputs.reference_file.map(Fingerprint::of)),
            arguments: inputs.arguments.to_vec(),
        };
        let of = (inputs.link, &simulation.law, &simulation.mesh);
        let residual = &simulation.residual;
        Self {
            torque: Some(torque_record(inputs.play, simulation)),
            feedback: Some(inputs.play.feedback.map(|feedback| {
                Numbers::of([
                    ("stiffness_n_m_rad", feedback.stiffness_n_m_rad()),
                    ("damping_n_m_s_rad", feedback.damping_n_m_s_rad()),
                ])
            })),
            modes: Some(ModesRecord {
                kept: simulation.selection.modes,
                of_mesh: simulation.selection.of,
                torque_band_hz: simulation.selection.torque_band_hz,
                highest_hz: simulation.selection.highest_hz,
            }),
            periods_s: frequencies.iter().map(|omega| TAU / omega).collect(),
            viscous_damping_ratios: Some(simulation.law.modal_ratios(frequencies)),
            errors: error.map(errors),
            residual: Some(
                Numbers::of([("amplitude_m", residual.amplitude_m), ("share", residual.share)])
                    .with("frequency_hz", residual.frequency_hz)
                    .with("decay_s", residual.decay_s),
            ),
            tip_error: Some(tip_error.map(tip_numbers)),
            warnings: warnings(simulation, error, tip_error),
            files: files.iter().map(|&file| file.to_owned()).collect(),
            ..Self::begun("simulate", files_in, of, results(metrics))
        }
    }
}

fn torque_record(play: &Play, simulation: &Simulation) -> TorqueRecord {
    let grid = play.torque.grid();
    TorqueRecord {
        samples: grid.len,
        step_s: grid.step_s,
        start_s: grid.time_s(0),
        end_s: grid.end_s(),
        simulated_until_s: simulation.grid.end_s(),
        interpolation: match play.interpolation {
            Interpolation::Cubic => "cubic".into(),
            Interpolation::Linear => "linear".into(),
        },
    }
}

fn results(metrics: &PlayedMetrics) -> Numbers {
    Numbers::of([
        ("peak_torque_n_m", metrics.peak_torque_n_m.value),
        ("farthest_m", metrics.farthest_m),
        ("travel_m", metrics.travel_m),
        ("final_tip_velocity_m_s", metrics.final_tip_velocity_m_s),
        ("peak_hub_angle_rad", metrics.peak_hub_angle_rad.value),
        ("peak_hub_rate_rad_s", metrics.peak_hub_rate_rad_s.value),
        ("peak_power_w", metrics.peak_power_w.value),
        ("peak_deflection_m", metrics.peak_deflection_m.value),
    ])
}

/// Shares of each quantity's own peak, of the tip's travel: of the mesh, and of the modes left out.
fn errors(error: &PlayError) -> Numbers {
    Numbers::default()
        .with("tip", Numbers::of([("mesh", error.tip)]))
        .with("hub_angle", Numbers::of([("mesh", error.hub_angle)]))
}

fn tip_numbers(error: &TipError) -> Numbers {
    Numbers::of([
        ("worst_m", error.worst_m),
        ("share", error.share),
        ("time_s", error.time_s),
        ("rms_m", error.rms_m),
        ("final_m", error.final_m),
    ])
}

fn warnings(
    simulation: &Simulation,
    error: Option<&PlayError>,
    tip_error: Option<&TipError>,
) -> Vec<StoredWarning> {
    let coarse = error.and_then(PlayError::warning);
    let played = simulation.warnings.iter().copied().chain(coarse);
    let played = played.map(|w| StoredWarning::new(w.kind(), &w, w.hint()));
    let late = tip_error.and_then(|error| error.late);
    let late = late.map(|late| StoredWarning::new(late.kind(), &late, late.hint()));
    played.chain(late).collect()
}
