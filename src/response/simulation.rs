use rayon::prelude::*;

use super::equations::{Equations, HubReaction};
use super::error::SimulationError;
use super::feedback::Feedback;
use super::play::Play;
use super::record::Record;
use super::residual::{AfterTorque, ResidualVibration};
use super::selection::{MOST_MODES, ModeSelection, kept_modes};
use super::warning::{Evidence, SimulationWarning, warnings};
use crate::beam::{Mesh, MeshPlan, NodalHistories};
use crate::link::Link;
use crate::modal::{
    DampingLaw, ModalBasis, REPORTED_MODES, Shape, hub_moves_mass, natural_frequencies,
};
use crate::motion::TipMotionHistories;
use crate::numeric::{TimeGrid, largest};

/// Memory in bytes that playing takes for each sample, as measured, besides the coordinate and the
/// rate of each mode.
const BYTES_PER_SAMPLE: usize = 190;

/// The motion of a link under a torque. All histories stand on [`Simulation::grid`].
#[derive(Debug, Clone)]
pub struct Simulation {
    /// Times of all histories: those of the torque, continued to the given end.
    pub grid: TimeGrid,
    /// Samples of the torque.
    pub driven: usize,
    /// Torque of the motor at the hub in N m, feedback included.
    pub torque_n_m: Vec<f64>,
    /// Hub angle in rad.
    pub hub_angle_rad: Vec<f64>,
    /// Hub rate in rad/s.
    pub hub_rate_rad_s: Vec<f64>,
    /// Hub acceleration in rad/s².
    pub hub_acceleration_rad_s2: Vec<f64>,
    /// Motion of the tip.
    pub tip: TipMotionHistories,
    /// Vibration after the torque.
    pub residual: ResidualVibration,
    /// Modes that were kept.
    pub selection: ModeSelection,
    /// Lowest natural frequencies in rad/s, the rigid rotation left out.
    pub natural_frequencies_rad_s: Vec<f64>,
    /// The mesh.
    pub mesh: Mesh,
    /// The damping law; the ratio of a hysteretic link is taken as its viscous ratio.
    pub law: DampingLaw,
    /// What the user must know.
    pub warnings: Vec<SimulationWarning>,
    /// Frequency in rad/s up to which the link is driven.
    pub(super) band_rad_s: f64,
    pub(super) initial_tip_m: f64,
    pub(super) equations: Equations,
    pub(super) record: Record,
}

/// Plays a torque on a link: direct dynamics in modal coordinates, each mode integrated exactly for
/// the interpolated torque (Bayo 1987, eqs 11 and 12).
///
/// The modes are those within the band of the torque; the others act as one residual mode with their static
/// response. Hysteretic damping has no equation in time: its ratio is taken as the
/// viscous ratio of every mode. An automatic mesh is refined until it follows the torque's band to
/// the plan's tolerance.
///
/// # Errors
/// [`SimulationError`].
pub fn simulate(link: &Link, plan: &MeshPlan, play: &Play) -> Result<Simulation, SimulationError> {
    let band_rad_s = play.band_rad_s().ok_or(SimulationError::NoTorque)?;
    let mesh = Mesh::new(link, plan);
    let mesh =
        if plan.is_automatic() { mesh.resolving(band_rad_s, plan.tolerance()) } else { mesh };
    play_on(link, mesh, play, band_rad_s)
}

/// Plays a torque on a link as [`simulate`] does, on a given mesh.
///
/// # Errors
/// [`SimulationError`].
pub fn simulate_on(link: &Link, mesh: Mesh, play: &Play) -> Result<Simulation, SimulationError> {
    play_on(link, mesh, play, play.band_rad_s().ok_or(SimulationError::NoTorque)?)
}

/// Plays a torque that drives the link up to `band_rad_s`.
fn play_on(
    link: &Link,
    mesh: Mesh,
    play: &Play,
    band_rad_s: f64,
) -> Result<Simulation, SimulationError> {
    if !hub_moves_mass(&mesh) {
        return Err(SimulationError::MasslessHub);
    }
    let grid = play.grid()?;
    let driving = play.driving()?;
    let law = DampingLaw::of(link.damping(), &mesh)?;
    let (basis, selection) = kept_modes(&mesh, band_rad_s, MOST_MODES);
    let equations = equations_on(link, &mesh, &law, play, basis);
    let modes = equations.coordinates.len();
    check_memory(grid.len, modes, play)?;
    let record = Record::of(&equations, &driving, &grid);
    if let Some(bad) = record.coordinates.iter().position(|q| !q.is_finite()) {
        return Err(SimulationError::NotFinite { time_s: grid.time_s(bad / modes) });
    }
    let observed = record.observed(&equations, &mesh, &driving, play.initial_tip_m);
    let [torque_n_m, hub_angle_rad, hub_rate_rad_s, hub_acceleration_rad_s2, tip @ ..] = observed;
    let [displacement_m, velocity_m_s, acceleration_m_s2] = tip;
    let tip = TipMotionHistories { displacement_m, velocity_m_s, acceleration_m_s2 };
    let is_finite = |k: &usize| {
        let power = torque_n_m[*k] * hub_rate_rad_s[*k];
        let accelerations = tip.acceleration_m_s2[*k] + hub_acceleration_rad_s2[*k];
        power.is_finite() && accelerations.is_finite()
    };
    if let Some(sample) = (0..grid.len).find(|k| !is_finite(k)) {
        return Err(SimulationError::NotFinite { time_s: grid.time_s(sample) });
    }
    let driven = play.torque.grid().len;
    let (coordinates, rates) = record.at(driven - 1);
    let residual = ResidualVibration::of(&AfterTorque {
        equations: &equations,
        mesh: &mesh,
        feedback: play.feedback,
        input: driving.held(),
        coordinates,
        rates,
        travel_m: tip.largest_travel_m(),
    });
    let deflection_m = tip_deflection_m(&mesh, &tip.displacement_m, &hub_angle_rad);
    let warnings = warnings(&Evidence {
        torque_n_m: play.torque.torque_n_m(),
        step_s: grid.step_s,
        first_period_s: equations.first_period_s(),
        vibration_share: residual.share,
        deflection_share: largest(&deflection_m) / mesh.length_m(),
    });
    Ok(Simulation {
        grid,
        driven,
        torque_n_m,
        hub_angle_rad,
        hub_rate_rad_s,
        hub_acceleration_rad_s2,
        tip,
        residual,
        selection,
        natural_frequencies_rad_s: natural_frequencies(&mesh, REPORTED_MODES),
        mesh,
        law,
        warnings,
        band_rad_s,
        initial_tip_m: play.initial_tip_m,
        equations,
        record,
    })
}

/// The link in these modes, with friction and feedback at its hub.
pub(super) fn equations_on(
    link: &Link,
    mesh: &Mesh,
    law: &DampingLaw,
    play: &Play,
    basis: ModalBasis,
) -> Equations {
    let gain = |of: fn(&Feedback) -> f64| play.feedback.map_or(0.0, of);
    let friction_n_m_s_rad = link.joint().friction_n_m_s_rad;
    let reaction = HubReaction {
        stiffness_n_m_rad: gain(Feedback::stiffness_n_m_rad),
        damping_n_m_s_rad: friction_n_m_s_rad + gain(Feedback::damping_n_m_s_rad),
        friction_n_m_s_rad,
    };
    Equations::new(mesh, law, basis, reaction)
}

/// Refuses a simulation that needs more memory than the play allows.
fn check_memory(samples: usize, modes: usize, play: &Play) -> Result<(), SimulationError> {
    let bytes = samples * (2 * size_of::<f64>() * modes + BYTES_PER_SAMPLE);
    match play.memory_bytes.filter(|allowed| bytes > *allowed) {
        Some(allowed) => Err(SimulationError::TooMuchMemory { samples, modes, bytes, allowed }),
        None => Ok(()),
    }
}

fn tip_deflection_m(mesh: &Mesh, tip_m: &[f64], hub_angle_rad: &[f64]) -> Vec<f64> {
    tip_m.iter().zip(hub_angle_rad).map(|(v, theta)| v - mesh.length_m() * theta).collect()
}

impl Simulation {
    /// Deflection of the tip from the hub's tangent line, `v_tip − Lθ`, in m.
    pub fn tip_deflection_m(&self) -> Vec<f64> {
        tip_deflection_m(&self.mesh, &self.tip.displacement_m, &self.hub_angle_rad)
    }

    /// Total displacement `v = xθ + w` in m at `nodes`, every `every`-th sample.
    ///
    /// # Panics
    /// If a node is not one of the mesh, or `every` is 0.
    pub fn displacements_m(&self, nodes: &[usize], every: usize) -> NodalHistories {
        let initial_angle = self.initial_tip_m / self.mesh.length_m();
        let history = |node: &usize| -> Vec<f64> {
            let at_node = |shape: &Shape| shape.displacement(&self.mesh, *node);
            let shapes: Vec<f64> = self.equations.shapes.iter().map(at_node).collect();
            let rest = initial_angle * self.mesh.nodes_m()[*node];
            let rows = self.record.coordinates.chunks_exact(shapes.len()).step_by(every);
            rows.map(|q| rest + q.iter().zip(&shapes).map(|(q, v)| q * v).sum::<f64>()).collect()
        };
        let samples = nodes.par_iter().map(history).collect();
        NodalHistories { nodes: nodes.to_vec(), grid: self.grid.thinned(every), samples }
    }
}
