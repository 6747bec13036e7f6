//! summary.json of `simulate`.

use serde::Serialize;

use super::json_record::FORMAT;
use super::link_record::LinkRecord;
use super::records::{Fingerprint, MeshRecord, WarningRecord, json};
use crate::csv::InputFile;
use crate::link::Link;
use crate::response::{Interpolation, Play, PlayError, Simulation};
use crate::result::{PlayedMetrics, TipError};

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
    /// The arguments that shape the results beside the files, in order, as the program takes them:
    /// `--set`, `payload.mass=0`.
    pub arguments: &'a [String],
}

/// The content of summary.json, in the order of its keys.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SimulationSummary {
    format: u32,
    flexlink: &'static str,
    command: &'static str,
    title: String,
    inputs: Inputs,
    link: LinkRecord,
    mesh: MeshRecord,
    torque: TorqueRecord,
    feedback: Option<FeedbackRecord>,
    modes: ModesRecord,
    periods_s: Vec<f64>,
    viscous_damping_ratios: Vec<f64>,
    results: Results,
    errors: Option<ErrorsRecord>,
    residual: ResidualRecord,
    tip_error: Option<TipErrorRecord>,
    warnings: Vec<WarningRecord>,
    files: Vec<&'static str>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Inputs {
    link: Fingerprint,
    torque: Fingerprint,
    target: Option<Fingerprint>,
    reference: Option<Fingerprint>,
    arguments: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct TorqueRecord {
    samples: usize,
    step_s: f64,
    start_s: f64,
    end_s: f64,
    simulated_until_s: f64,
    interpolation: &'static str,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct FeedbackRecord {
    stiffness_n_m_rad: f64,
    damping_n_m_s_rad: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct ModesRecord {
    kept: usize,
    of_mesh: usize,
    torque_band_hz: f64,
    highest_hz: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Results {
    peak_torque_n_m: f64,
    farthest_m: f64,
    travel_m: f64,
    final_tip_velocity_m_s: f64,
    peak_hub_angle_rad: f64,
    peak_hub_rate_rad_s: f64,
    peak_power_w: f64,
    peak_deflection_m: f64,
}

/// Shares of each quantity's own peak; of the tip: of its way.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct ErrorsRecord {
    tip: MeshErrorRecord,
    hub_angle: MeshErrorRecord,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct MeshErrorRecord {
    /// Of the mesh, and of the modes that were kept.
    mesh: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct ResidualRecord {
    amplitude_m: f64,
    share: f64,
    frequency_hz: Option<f64>,
    decay_s: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct TipErrorRecord {
    worst_m: f64,
    share: f64,
    time_s: f64,
    rms_m: f64,
    final_m: f64,
}

impl SimulationSummary {
    /// Gathers the summary of a simulation, with what mesh and modes make it wrong by and how far the
    /// tip is from its target; `files` are the names of what is written with it.
    pub fn new(
        inputs: &SimulationInputs,
        simulation: &Simulation,
        metrics: &PlayedMetrics,
        (error, tip_error): (Option<&PlayError>, Option<&TipError>),
        files: Vec<&'static str>,
    ) -> Self {
        let frequencies = &simulation.natural_frequencies_rad_s;
        Self {
            format: FORMAT,
            flexlink: env!("CARGO_PKG_VERSION"),
            command: "simulate",
            title: inputs.link.title().to_owned(),
            inputs: Inputs {
                link: Fingerprint::of(inputs.link_file),
                torque: Fingerprint::of(inputs.torque_file),
                target: inputs.target_file.map(Fingerprint::of),
                reference: inputs.reference_file.map(Fingerprint::of),
                arguments: inputs.arguments.to_vec(),
            },
            link: LinkRecord::new(inputs.link, &simulation.law),
            mesh: MeshRecord::of(&simulation.mesh),
            torque: TorqueRecord::new(inputs.play, simulation),
            feedback: inputs.play.feedback.map(|feedback| FeedbackRecord {
                stiffness_n_m_rad: feedback.stiffness_n_m_rad(),
                damping_n_m_s_rad: feedback.damping_n_m_s_rad(),
            }),
            modes: ModesRecord {
                kept: simulation.selection.modes,
                of_mesh: simulation.selection.of,
                torque_band_hz: simulation.selection.torque_band_hz,
                highest_hz: simulation.selection.highest_hz,
            },
            periods_s: frequencies.iter().map(|omega| std::f64::consts::TAU / omega).collect(),
            viscous_damping_ratios: simulation.law.modal_ratios(frequencies),
            results: Results::new(metrics),
            errors: error.map(|error| ErrorsRecord {
                tip: MeshErrorRecord { mesh: error.tip },
                hub_angle: MeshErrorRecord { mesh: error.hub_angle },
            }),
            residual: ResidualRecord {
                amplitude_m: simulation.residual.amplitude_m,
                share: simulation.residual.share,
                frequency_hz: simulation.residual.frequency_hz,
                decay_s: simulation.residual.decay_s,
            },
            tip_error: tip_error.map(|error| TipErrorRecord {
                worst_m: error.worst_m,
                share: error.share,
                time_s: error.time_s,
                rms_m: error.rms_m,
                final_m: error.final_m,
            }),
            warnings: warnings(simulation, error, tip_error),
            files,
        }
    }

    /// The JSON text, indented, with a final line end.
    pub fn to_json(&self) -> String {
        json(self)
    }
}

fn warnings(
    simulation: &Simulation,
    error: Option<&PlayError>,
    tip_error: Option<&TipError>,
) -> Vec<WarningRecord> {
    let coarse = error.and_then(PlayError::warning);
    let played = simulation.warnings.iter().copied().chain(coarse).map(|warning| WarningRecord {
        kind: warning.kind().into(),
        message: warning.to_string(),
        hint: warning.hint().into(),
    });
    let compared = tip_error.and_then(|error| error.late).map(|late| WarningRecord {
        kind: late.kind().into(),
        message: late.to_string(),
        hint: late.hint().into(),
    });
    played.chain(compared).collect()
}

impl TorqueRecord {
    fn new(play: &Play, simulation: &Simulation) -> Self {
        let (grid, own) = (play.torque.grid(), &simulation.grid);
        Self {
            samples: grid.len,
            step_s: grid.step_s,
            start_s: grid.time_s(0),
            end_s: grid.end_s(),
            simulated_until_s: own.end_s(),
            interpolation: match play.interpolation {
                Interpolation::Cubic => "cubic",
                Interpolation::Linear => "linear",
            },
        }
    }
}

impl Results {
    fn new(metrics: &PlayedMetrics) -> Self {
        Self {
            peak_torque_n_m: metrics.peak_torque_n_m.value,
            farthest_m: metrics.farthest_m,
            travel_m: metrics.travel_m,
            final_tip_velocity_m_s: metrics.final_tip_velocity_m_s,
            peak_hub_angle_rad: metrics.peak_hub_angle_rad.value,
            peak_hub_rate_rad_s: metrics.peak_hub_rate_rad_s.value,
            peak_power_w: metrics.peak_power_w.value,
            peak_deflection_m: metrics.peak_deflection_m.value,
        }
    }
}
