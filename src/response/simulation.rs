use std::num::NonZeroUsize;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::error::{SimulationError, SimulationWarning};
use super::modes::{Equations, MOST_MODES, ModeSelection, kept_modes};
use super::play::{Driving, Play};
use super::residual::{Reading, ResidualVibration};
use super::stepper::{Record, Stepper};
use crate::beam::{Mesh, MeshPlan, NodalHistories};
use crate::link::{Link, ParameterError};
use crate::modal::{DampingLaw, REPORTED_MODES, Shape, hub_moves_mass, natural_frequencies};
use crate::motion::TipMotionHistories;
use crate::numeric::{TimeGrid, largest};

/// Memory in bytes that playing takes for each sample, as measured, besides the coordinate and the
/// rate of each mode.
const BYTES_PER_SAMPLE: usize = 190;

/// The motion of a link under a torque, or on a hub that moves as prescribed. The times of all histories are
/// [`Simulation::grid`].
#[derive(Debug, Clone)]
pub struct Simulation {
    /// Times of all histories: those of the input, continued to the given end.
    pub grid: TimeGrid,
    /// Samples of the input.
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
    /// Vibration after the input.
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

/// Computes the motion of a link under a torque, or on a hub that moves as prescribed: direct dynamics in
/// modal coordinates, each mode integrated exactly for the interpolated input (Bayo 1987, eqs 11 and 12).
///
/// The modes are those within the band of the input; the others act as one residual mode with their static
/// response. Hysteretic damping has no equation in time: its ratio is taken as the viscous ratio of every
/// mode, of the held ones where the hub moves as prescribed. An automatic mesh is refined until it follows
/// the input's band to the plan's tolerance.
///
/// # Errors
/// [`SimulationError`].
pub fn simulate(link: &Link, plan: &MeshPlan, play: &Play) -> Result<Simulation, SimulationError> {
    let band_rad_s = play.band_rad_s().ok_or(play.nothing())?;
    let mesh = Mesh::new(link, plan)?;
    let mesh =
        if plan.is_automatic() { mesh.resolving(band_rad_s, plan.tolerance()) } else { mesh };
    play_on(link, mesh, play, band_rad_s)
}

/// Computes the motion as [`simulate`] does, on a given mesh.
///
/// # Errors
/// [`SimulationError`].
pub(crate) fn simulate_on(
    link: &Link,
    mesh: Mesh,
    play: &Play,
) -> Result<Simulation, SimulationError> {
    play_on(link, mesh, play, play.band_rad_s().ok_or(play.nothing())?)
}

/// Computes the motion under an input, torque or hub angle, that drives the link up to `band_rad_s`.
fn play_on(
    link: &Link,
    mesh: Mesh,
    play: &Play,
    band_rad_s: f64,
) -> Result<Simulation, SimulationError> {
    if !hub_moves_mass(&mesh) {
        return Err(SimulationError::MasslessHub);
    }
    if link.has_weight() {
        return Err(SimulationError::HasWeight);
    }
    let grid = play.grid()?;
    let driving = play.driving()?;
    let law = DampingLaw::of(link, &mesh)?;
    let (basis, selection) = kept_modes(&mesh, band_rad_s, MOST_MODES);
    let equations = play.equations(link, (&mesh, &law), basis)?;
    let modes = equations.coordinates.len();
    let samples = grid.len;
    let bytes = samples * (2 * size_of::<f64>() * modes + BYTES_PER_SAMPLE);
    if let Some(allowed) = play.memory_bytes.filter(|allowed| bytes > *allowed) {
        return Err(SimulationError::TooMuchMemory { samples, modes, bytes, allowed });
    }
    let record = Record::of(&equations, &driving, &grid);
    let initial_tip_m = play.start_m(mesh.length_m());
    let start = [initial_tip_m / mesh.length_m(), initial_tip_m];
    let observed = observed(&record, &equations, &driving, start, &grid)?;
    let [torque_n_m, hub_angle_rad, hub_rate_rad_s, hub_acceleration_rad_s2, tip @ ..] = observed;
    let [displacement_m, velocity_m_s, acceleration_m_s2] = tip;
    let tip = TipMotionHistories { displacement_m, velocity_m_s, acceleration_m_s2 };
    let driven = play.input.grid().len;
    let goal_m = play.goal_rad().map(|turn_rad| turn_rad * mesh.length_m());
    let reading = Reading::new(&equations, goal_m);
    let (last, held) = (record.at(driven - 1), driving.held());
    let residual = ResidualVibration::of(&equations, last, &held, &reading, tip.largest_travel_m());
    let deflection_m = tip_deflection_m(&mesh, &tip.displacement_m, &hub_angle_rad);
    let warnings = SimulationWarning::all(
        play.input.warnings(&torque_n_m),
        (grid.step_s, equations.first_period_s()),
        (residual.share, largest(&deflection_m) / mesh.length_m()),
    );
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
        initial_tip_m,
        equations,
        record,
    })
}

/// Torque of the motor in N m; angle, rate and acceleration of the hub in rad, rad/s and rad/s²;
/// displacement, velocity and acceleration of the tip in m, m/s and m/s². The hub angle and the tip's
/// displacement begin at `start`.
fn observed(
    record: &Record,
    equations: &Equations,
    driving: &Driving,
    [start_rad, start_m]: [f64; 2],
    grid: &TimeGrid,
) -> Result<[Vec<f64>; 7], SimulationError> {
    let mut columns = [(); 7].map(|()| Vec::with_capacity(grid.len));
    for sample in 0..grid.len {
        let (q, rate) = record.at(sample);
        let input = driving.at(sample);
        let acceleration = equations.accelerations(q, rate, input);
        let (angle, hub_rate) = (equations.hub(q), equations.hub(rate));
        let row = [
            equations.motor_n_m(q, rate, &acceleration, input),
            start_rad + angle,
            hub_rate,
            equations.hub(&acceleration),
            start_m + equations.tip(q),
            equations.tip(rate),
            equations.tip(&acceleration),
        ];
        let (power, all) = (row[0] * row[2], row.iter().sum::<f64>());
        if !power.is_finite() || !all.is_finite() {
            return Err(SimulationError::NotFinite { time_s: grid.time_s(sample) });
        }
        for (column, value) in columns.iter_mut().zip(row) {
            column.push(value);
        }
    }
    Ok(columns)
}

fn tip_deflection_m(mesh: &Mesh, tip_m: &[f64], hub_angle_rad: &[f64]) -> Vec<f64> {
    tip_m.iter().zip(hub_angle_rad).map(|(v, theta)| v - mesh.length_m() * theta).collect()
}

impl Simulation {
    /// Period of the first flexible mode in s, of the held link where the hub moves as prescribed.
    pub fn first_period_s(&self) -> Option<f64> {
        self.equations.first_period_s()
    }

    /// Deflection of the tip from the hub's tangent line, `v_tip − Lθ`, in m.
    pub fn tip_deflection_m(&self) -> Vec<f64> {
        tip_deflection_m(&self.mesh, &self.tip.displacement_m, &self.hub_angle_rad)
    }

    /// Total displacement `v = xθ + w` in m at `nodes`, every `every`-th sample.
    ///
    /// # Errors
    /// [`ParameterError`] if a node is not one of the mesh.
    pub fn displacements_m(
        &self,
        nodes: &[usize],
        every: NonZeroUsize,
    ) -> Result<NodalHistories, ParameterError> {
        self.mesh.check_nodes(nodes)?;
        let initial_angle = self.initial_tip_m / self.mesh.length_m();
        let history = |node: &usize| -> Vec<f64> {
            let at_node = |shape: &Shape| shape.displacement(&self.mesh, *node);
            let shapes: Vec<f64> = self.equations.shapes.iter().map(at_node).collect();
            let rest = initial_angle * self.mesh.nodes_m()[*node];
            let rows = self.record.coordinates.chunks_exact(shapes.len()).step_by(every.get());
            rows.map(|q| rest + q.iter().zip(&shapes).map(|(q, v)| q * v).sum::<f64>()).collect()
        };
        let samples = nodes.par_iter().map(history).collect();
        Ok(NodalHistories { nodes: nodes.to_vec(), grid: self.grid.thinned(every), samples })
    }
}

/// Error of a tip or a hub angle above which a warning is given.
const COARSE: f64 = 1e-2;

/// Errors of a simulation by its mesh and its modes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PlayError {
    /// Largest error of the tip's displacement, over its travel.
    pub tip: f64,
    /// Largest error of the hub angle, over its peak.
    pub hub_angle: f64,
}

impl PlayError {
    /// Plays the same torque on elements of half the length, with all modes that the torque moves
    /// there, and measures the change; where modes were cut, with twice as many.
    ///
    /// It takes about as long as the simulation, and no memory. `None` where such elements do not
    /// allow the damping law.
    ///
    /// # Errors
    /// As [`simulate`] of this simulation.
    pub fn of(
        simulation: &Simulation,
        link: &Link,
        play: &Play,
    ) -> Result<Option<Self>, SimulationError> {
        let mesh = simulation.mesh.refined();
        let Ok(law) = DampingLaw::of(link, &mesh) else { return Ok(None) };
        let were_cut = simulation.selection.modes >= MOST_MODES;
        let most_modes = if were_cut { 2 * MOST_MODES } else { MOST_MODES };
        let (basis, _) = kept_modes(&mesh, simulation.band_rad_s, most_modes);
        let equations = play.equations(link, (&mesh, &law), basis)?;
        let driving = play.driving()?;
        let Simulation { grid, tip, hub_angle_rad, .. } = simulation;
        let (start_m, start_rad) = (tip.displacement_m[0], hub_angle_rad[0]);
        let turned: Vec<f64> = hub_angle_rad.iter().map(|angle| angle - start_rad).collect();
        let mut found = tip.displacement_m.iter().zip(&turned);
        let (mut tip_m, mut hub_rad) = (0.0_f64, 0.0_f64);
        Stepper::new(&equations, grid.step_s).run(driving.steps(grid.len), |stepper| {
            let q = stepper.coordinates();
            let Some((displacement_m, turned_rad)) = found.next() else { return };
            tip_m = tip_m.max((equations.tip(&q) - (displacement_m - start_m)).abs());
            hub_rad = hub_rad.max((equations.hub(&q) - turned_rad).abs());
        });
        let per_change = mesh.error_per_change();
        let share =
            |error: f64, whole: f64| per_change * if error == 0.0 { 0.0 } else { error / whole };
        let (tip, hub_angle) =
            (share(tip_m, tip.largest_travel_m()), share(hub_rad, largest(&turned)));
        Ok(Some(Self { tip, hub_angle }))
    }

    /// A warning if the errors are large.
    pub fn warning(&self) -> Option<SimulationWarning> {
        let Self { tip, hub_angle } = *self;
        (tip.max(hub_angle) > COARSE).then_some(SimulationWarning::CoarseMesh { tip, hub_angle })
    }
}
