use rayon::prelude::*;
use thiserror::Error;

use super::equations::{Equations, HubReaction};
use super::feedback::{Feedback, FeedbackError};
use super::play::{Driving, Play, Record};
use super::residual::ResidualVibration;
use super::selection::{MOST_MODES, ModeSelection, kept_modes};
use super::stepper::Stepper;
use super::warning::{SimulationWarning, warnings};
use crate::beam::{Mesh, MeshPlan, NodalHistories};
use crate::link::Link;
use crate::modal::{
    DampingError, DampingLaw, ModalBasis, REPORTED_MODES, Shape, hub_moves_mass,
    natural_frequencies,
};
use crate::motion::TipMotionHistories;
use crate::numeric::{TimeGrid, gigabytes, plain, rounded};

/// Memory in bytes that playing takes for each sample, as measured, besides the coordinate and the
/// rate of each mode.
const BYTES_PER_SAMPLE: usize = 190;

/// Why a torque is not played.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SimulationError {
    /// Nothing moves.
    #[error("the torque is zero in all samples, but must move the link")]
    NoTorque,
    /// A hub that turns without moving mass, so that its motion follows no equation in time.
    #[error("the hub moves no mass, but must: hub.inertia = 0, and the link's root has none")]
    MasslessHub,
    /// Damping that cannot be.
    #[error(transparent)]
    Damping(#[from] DampingError),
    /// Feedback that does not fit the torque.
    #[error(transparent)]
    Feedback(#[from] FeedbackError),
    /// An end before that of the torque.
    #[error(
        "until = {until_s} s, but must not be before the torque's last sample, {} s",
        rounded(*end_s, 12)
    )]
    EndsEarly {
        /// The end asked for in s.
        until_s: f64,
        /// The torque's last time in s.
        end_s: f64,
    },
    /// More samples than this program holds.
    #[error(
        "until = {} s, {samples:.3e} samples, but must be at most {limit} samples",
        plain(*until_s)
    )]
    TooLong {
        /// The end asked for in s.
        until_s: f64,
        /// Samples that it needs.
        samples: f64,
        /// Samples possible.
        limit: usize,
    },
    /// More memory than is allowed.
    #[error(
        "{samples} samples of {modes} modes would need {} of memory, but must fit in the {} \
         available",
        gigabytes(*bytes),
        gigabytes(*allowed)
    )]
    TooMuchMemory {
        /// Samples of the simulation.
        samples: usize,
        /// Modes kept, rigid rotation and residual mode included.
        modes: usize,
        /// Bytes needed, about.
        bytes: usize,
        /// Bytes allowed.
        allowed: usize,
    },
    /// Numbers beyond double precision.
    #[error("the motion at {} s = not a finite number, but must be one", rounded(*time_s, 12))]
    NotFinite {
        /// The time in s.
        time_s: f64,
    },
}

impl SimulationError {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Damping(error) => Some(error.hint()),
            Self::Feedback(error) => error.hint(),
            Self::TooLong { .. } | Self::TooMuchMemory { .. } => {
                Some("an earlier end, or a torque with a longer step")
            }
            Self::NotFinite { .. } => Some("the inputs are too large for double precision"),
            Self::EndsEarly { .. } => Some("the simulation goes on to the torque's end by itself"),
            Self::MasslessHub => Some("give the hub an inertia, however small"),
            Self::NoTorque => None,
        }
    }
}

/// What a torque does to a link. All histories stand on [`Simulation::grid`].
#[derive(Debug, Clone)]
pub struct Simulation {
    /// Times of all histories: those of the torque, then as many more as asked for.
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
    /// What vibrates on after the torque.
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
    pub(super) initial_tip_m: f64,
    pub(super) friction_n_m_s_rad: f64,
    pub(super) equations: Equations,
    pub(super) record: Record,
}

/// Plays a torque on a link: direct dynamics in modal coordinates, each mode integrated exactly for
/// the interpolated torque (Bayo 1987, eqs 11 and 12).
///
/// The modes are those that the torque's own spectrum reaches; the rest answers as one residual
/// mode, statically right. Hysteretic damping has no equation in time: its ratio is taken as the
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

/// Plays a torque that drives the link up to a frequency.
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
    let mut stepper = Stepper::new(&equations, grid.step_s);
    let record = driving.record(&mut stepper, grid.len);
    if let Some(bad) = record.coordinates.iter().position(|q| !q.is_finite()) {
        return Err(SimulationError::NotFinite { time_s: grid.time_s(bad / modes) });
    }
    let mut simulation = Simulation {
        grid,
        driven: play.torque.grid().len,
        torque_n_m: Vec::with_capacity(grid.len),
        hub_angle_rad: Vec::with_capacity(grid.len),
        hub_rate_rad_s: Vec::with_capacity(grid.len),
        hub_acceleration_rad_s2: Vec::with_capacity(grid.len),
        tip: TipMotionHistories::default(),
        residual: ResidualVibration::default(),
        selection,
        natural_frequencies_rad_s: natural_frequencies(&mesh, REPORTED_MODES),
        mesh,
        law,
        warnings: Vec::new(),
        initial_tip_m: play.initial_tip_m,
        friction_n_m_s_rad: link.joint().friction_n_m_s_rad,
        equations,
        record,
    };
    simulation.observe(&driving);
    if let Some(sample) = simulation.first_not_finite() {
        return Err(SimulationError::NotFinite { time_s: grid.time_s(sample) });
    }
    simulation.residual = ResidualVibration::of(&simulation, play, &driving);
    simulation.warnings = warnings(&simulation, play);
    Ok(simulation)
}

/// The link in these modes, with all that reacts to its hub's motion.
pub(super) fn equations_on(
    link: &Link,
    mesh: &Mesh,
    law: &DampingLaw,
    play: &Play,
    basis: ModalBasis,
) -> Equations {
    let gain = |of: fn(&Feedback) -> f64| play.feedback.map_or(0.0, of);
    let friction = link.joint().friction_n_m_s_rad;
    let reaction = HubReaction {
        stiffness_n_m_rad: gain(Feedback::stiffness_n_m_rad),
        damping_n_m_s_rad: friction + gain(Feedback::damping_n_m_s_rad),
    };
    Equations::new(mesh, law, basis, reaction)
}

/// Refuses a simulation that takes more memory than the play allows.
fn check_memory(samples: usize, modes: usize, play: &Play) -> Result<(), SimulationError> {
    let bytes = samples * (2 * size_of::<f64>() * modes + BYTES_PER_SAMPLE);
    match play.memory_bytes.filter(|allowed| bytes > *allowed) {
        Some(allowed) => Err(SimulationError::TooMuchMemory { samples, modes, bytes, allowed }),
        None => Ok(()),
    }
}

impl Simulation {
    /// Modal coordinates and rates at a sample.
    pub(super) fn state(&self, sample: usize) -> (&[f64], &[f64]) {
        let row = self.equations.coordinates.len();
        let range = sample * row..(sample + 1) * row;
        (&self.record.coordinates[range.clone()], &self.record.rates[range])
    }

    /// Reads motion of hub and tip, and the motor's torque, off the modal coordinates.
    fn observe(&mut self, driving: &Driving) {
        let tips = self.equations.tips(&self.mesh);
        let tip = |q: &[f64]| -> f64 { q.iter().zip(&tips).map(|(q, tip)| q * tip).sum() };
        let initial_angle = self.initial_tip_m / self.mesh.length_m();
        for sample in 0..self.grid.len {
            let (q, rate) = self.state(sample);
            let input = driving.at(sample);
            let acceleration = self.equations.accelerations(q, rate, input);
            let (angle, hub_rate) = (self.equations.hub(q), self.equations.hub(rate));
            // Friction is the hub's own; the rest of the reaction is the motor's.
            let reaction = self.equations.reaction.torque_n_m(angle, hub_rate);
            let motor = input - (reaction - self.friction_n_m_s_rad * hub_rate);
            let hub_acceleration = self.equations.hub(&acceleration);
            let [v, velocity, a] = [tip(q), tip(rate), tip(&acceleration)];
            self.torque_n_m.push(motor);
            self.hub_angle_rad.push(initial_angle + angle);
            self.hub_rate_rad_s.push(hub_rate);
            self.hub_acceleration_rad_s2.push(hub_acceleration);
            self.tip.displacement_m.push(self.initial_tip_m + v);
            self.tip.velocity_m_s.push(velocity);
            self.tip.acceleration_m_s2.push(a);
        }
    }

    /// The first sample at which the motion or the motor's power is beyond double precision.
    fn first_not_finite(&self) -> Option<usize> {
        (0..self.grid.len).find(|k| {
            let power = self.torque_n_m[*k] * self.hub_rate_rad_s[*k];
            let accelerations = self.tip.acceleration_m_s2[*k] + self.hub_acceleration_rad_s2[*k];
            !(power.is_finite() && accelerations.is_finite())
        })
    }

    /// Deflection of the tip from the hub's tangent line, `v_tip − Lθ`, in m.
    pub fn tip_deflection_m(&self) -> Vec<f64> {
        let length_m = self.mesh.length_m();
        let tips = self.tip.displacement_m.iter().zip(&self.hub_angle_rad);
        tips.map(|(v, theta)| v - length_m * theta).collect()
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
