use std::f64::consts::TAU;
use std::num::NonZeroUsize;

use super::bent::{BentPlay, play_bent};
use super::driving::Driving;
use super::error::{SimulationError, SimulationWarning};
use super::history::Feedback;
use super::modes::{Equations, ModeSelection};
use super::play::{Input, LEFT_OUT, Play, Started, refuse_memory};
use super::residual::{PlayedModelError, Reading, ResidualVibration};
use super::stepper::Record;
use crate::beam::{Mesh, MeshPlan, NodalHistories};
use crate::link::{Link, ParameterError};
use crate::modal::{
    DampingLaw, OF_DEFLECTION, REPORTED_MODES, Shape, hub_moves_mass, natural_frequencies,
    second_order_share,
};
use crate::motion::TipMotionHistories;
use crate::numeric::{TimeGrid, largest};
use crate::system::end_if_stopped;
use rayon::prelude::*;

/// Memory in bytes that playing takes for each sample, as measured, besides the coordinate and the
/// rate of each mode.
const BYTES_PER_SAMPLE: usize = 190;

/// The rate of a reference, its cubics, and the copy that the balance of energy reads.
const BYTES_OF_TURNING: usize = 48;

/// Vibration over the tip's travel below which the rows need not show it.
const VIBRATES: f64 = 1e-6;

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
    /// What was played.
    pub played: Played,
    /// Lowest natural frequencies in rad/s without weight, the rigid rotation left out.
    pub natural_frequencies_rad_s: Vec<f64>,
    /// The mesh.
    pub mesh: Mesh,
    /// The damping law; the ratio of a hysteretic link is taken as its viscous ratio.
    pub law: DampingLaw,
    /// What the user must know.
    pub warnings: Vec<SimulationWarning>,
}

/// The link as it was played.
#[derive(Debug, Clone)]
pub enum Played {
    /// A linear link, by its modes.
    Modes(ModalPlay),
    /// A link with weight or at large angles.
    Elastica(BentPlay),
}

/// A linear link, played by its modes.
#[derive(Debug, Clone)]
pub struct ModalPlay {
    /// Modes that were kept.
    pub selection: ModeSelection,
    /// Vibration after the input; none of one that repeats.
    pub residual: Option<ResidualVibration>,
    /// What the linear model leaves out.
    pub model_error: PlayedModelError,
    /// Frequency in rad/s up to which the link is driven.
    pub(super) band_rad_s: f64,
    pub(super) grid: TimeGrid,
    /// Hub angle in rad where the tip's displacement is 0.
    pub(super) from_rad: f64,
    pub(super) initial_tip_m: f64,
    /// Whether it is one cycle of a motion that repeats.
    pub(super) repeats: bool,
    pub(super) equations: Equations,
    pub(super) record: Record,
    /// Rate of the reference in rad/s at each sample where the damping of a loop turns with it, else empty.
    pub(super) turning_rad_s: Vec<f64>,
}

/// Computes the motion of a link under a torque, or on a hub that moves as prescribed: direct dynamics in
/// modal coordinates, each mode integrated exactly for the interpolated input (Bayo 1987, eqs 11 and 12).
///
/// With weight, or where [`Play::is_large`] asks for it, the link is an inextensible elastica with angles as
/// coordinates, integrated by Radau's method with more angles and shorter steps until tip and hub settle within the
/// plan's tolerance. It starts from its shape at rest.
///
/// The modes are those within the band of the input; the others act as one residual mode with their static
/// response. Hysteretic damping has no equation in time: its ratio is taken as the viscous ratio of every
/// mode, of the held ones where the hub moves as prescribed, of those of the loop under feedback. An automatic mesh is
/// refined until it follows the input's band to the plan's tolerance.
///
/// # Errors
/// [`SimulationError`].
pub fn simulate(link: &Link, plan: &MeshPlan, play: &Play) -> Result<Simulation, SimulationError> {
    let mesh = Mesh::new(link, plan)?;
    if let Some(state) = play.state {
        if let Input::HubAngle(_) = play.input {
            let must = "not be beside a motion of the hub".to_owned();
            return Err(SimulationError::State { found: "given".to_owned(), must });
        }
        state.check(link, play.is_large_on(link))?;
    }
    if play.is_large_on(link) {
        return play_large(link, mesh, play, plan.tolerance());
    }
    let band_rad_s = driven_rad_s(play)?;
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
    if play.is_large_on(link) {
        return play_large(link, mesh, play, MeshPlan::DEFAULT_TOLERANCE);
    }
    play_on(link, mesh, play, driven_rad_s(play)?)
}

/// Frequency in rad/s up to which an input drives a link; what a state moves is 0.
fn driven_rad_s(play: &Play) -> Result<f64, SimulationError> {
    play.band_rad_s().or(play.state.map(|_| 0.0)).ok_or(play.nothing())
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
    let (grid, driving) = (play.grid()?, play.driving(link)?);
    let law = DampingLaw::of(link, &mesh)?;
    let Started { equations, selection, start, left_out } =
        Started::of(link, (&mesh, &law), (play, &driving), band_rad_s)?;
    let modes = equations.coordinates.len();
    let samples = grid.len;
    let turning = if driving.turning.is_some() { BYTES_OF_TURNING } else { 0 };
    let bytes = samples * (2 * size_of::<f64>() * modes + BYTES_PER_SAMPLE + turning);
    refuse_memory((samples, modes), bytes, play.memory_bytes)?;
    let record = Record::of(&equations, &driving, &grid, &start);
    let initial_tip_m = play.start_m(link);
    let from_rad = play.origin_rad(link).unwrap_or(0.0);
    let offsets = [from_rad + initial_tip_m / mesh.length_m(), initial_tip_m];
    let observed = observed(&record, &equations, &driving, offsets, &grid)?;
    let [torque_n_m, hub_angle_rad, hub_rate_rad_s, hub_acceleration_rad_s2, tip @ ..] = observed;
    let [displacement_m, velocity_m_s, acceleration_m_s2] = tip;
    let tip = TipMotionHistories { displacement_m, velocity_m_s, acceleration_m_s2 };
    let driven = play.input.grid().len;
    let goal_m = play.goal_rad(link).map(|turn_rad| turn_rad * mesh.length_m());
    let reading = Reading::new(&equations, goal_m);
    let (last, held) = (record.at(driven - 1), driving.held());
    let residual = play
        .cycle_turn_rad
        .is_none()
        .then(|| ResidualVibration::of(&equations, last, held, &reading, tip.largest_travel_m()));
    let has_turning = driving.turning.is_some();
    let turning_rad_s = driving.turning_rad_s(if has_turning { grid.len } else { 0 });
    let deflection_m = tip_deflection_m(&mesh, from_rad, &tip.displacement_m, &hub_angle_rad);
    // In one that vibrates the hub swings faster than the link turns.
    let turned = largest(&tip.velocity_m_s) / mesh.length_m();
    let share_of = second_order_share(&mesh, link, turned.min(largest(&hub_rate_rad_s)));
    let bends_m = largest(&deflection_m);
    let vibrates_m = residual.map_or(0.0, |residual| residual.amplitude_m);
    let shares = [bends_m, vibrates_m].map(|bent_m| share_of(bent_m, OF_DEFLECTION));
    let omega_rad_s = equations.first_period_s().map_or(0.0, |period_s| TAU / period_s);
    let moves_m = (bends_m, tip.largest_travel_m());
    let vibration = (omega_rad_s, grid.duration_s());
    let model_error = PlayedModelError::of(shares, moves_m, residual.as_ref(), vibration);
    let [begins, ends] = play.input.warnings(&torque_n_m);
    let cut = SimulationWarning::StateCut { share: left_out };
    let begins = match play.state {
        Some(_) => (left_out > LEFT_OUT).then_some(cut),
        None => begins,
    };
    let [begins, ends] = if residual.is_some() { [begins, ends] } else { [None, None] };
    // Without a vibration the rows need not show it.
    let vibrates = residual.is_none_or(|residual| residual.share > VIBRATES);
    let coarse = SimulationWarning::coarse_step(grid.step_s, equations.first_period_s());
    let coarse = coarse.filter(|_| vibrates);
    let warnings = [begins, ends, coarse, model_error.warning()].into_iter().flatten().collect();
    Ok(Simulation {
        grid,
        driven,
        torque_n_m,
        hub_angle_rad,
        hub_rate_rad_s,
        hub_acceleration_rad_s2,
        tip,
        played: Played::Modes(ModalPlay {
            selection,
            residual,
            model_error,
            band_rad_s,
            grid,
            from_rad,
            initial_tip_m,
            repeats: play.cycle_turn_rad.is_some(),
            equations,
            record,
            turning_rad_s,
        }),
        natural_frequencies_rad_s: natural_frequencies(&mesh, REPORTED_MODES),
        mesh,
        law,
        warnings,
    })
}

/// Computes the motion of a link with weight or at large angles; the mesh has the nodes that are shown.
fn play_large(
    link: &Link,
    mesh: Mesh,
    play: &Play,
    tolerance: f64,
) -> Result<Simulation, SimulationError> {
    if !hub_moves_mass(&mesh) {
        return Err(SimulationError::MasslessHub);
    }
    let is_still = play.band_rad_s().is_none();
    // Under a torque of zero a link falls, or goes on.
    let is_torque = matches!(play.input, Input::Torque(_));
    let falls = (link.has_weight() || play.state.is_some()) && is_torque;
    if is_still && !falls {
        return Err(play.nothing());
    }
    let (grid, law) = (play.grid()?, DampingLaw::of(link, &mesh)?);
    let natural_frequencies_rad_s = natural_frequencies(&mesh, REPORTED_MODES);
    let first_rad_s = natural_frequencies_rad_s.first().copied().unwrap_or(0.0);
    let (bent, histories) = play_bent(link, &law, play, (&grid, first_rad_s, tolerance))?;
    let [torque_n_m, hub_angle_rad, hub_rate_rad_s, hub_acceleration_rad_s2, tip @ ..] = histories;
    let [displacement_m, velocity_m_s, acceleration_m_s2] = tip;
    let [begins, ends] = play.input.warnings(&torque_n_m);
    let own = match (play.state, play.input) {
        _ if play.cycle_turn_rad.is_some() => [None; 3],
        (Some(_), _) => [None, ends.filter(|_| !link.has_weight()), None],
        (None, Input::Torque(torque)) if link.has_weight() => {
            let reference = play.feedback.map(Feedback::reference);
            let apart = reference.and_then(|reference| reference.apart(hub_angle_rad[0]));
            [bent.unheld(torque.torque_n_m()), None, apart]
        }
        (None, _) => [begins, ends, None],
    };
    let period_s = (first_rad_s > 0.0).then(|| TAU / first_rad_s);
    // A link that is played to its end always moves.
    let coarse = SimulationWarning::coarse_step(grid.step_s, period_s);
    let warnings = own.into_iter().chain([coarse]).flatten().collect();
    Ok(Simulation {
        driven: play.input.grid().len,
        grid,
        torque_n_m,
        hub_angle_rad,
        hub_rate_rad_s,
        hub_acceleration_rad_s2,
        tip: TipMotionHistories { displacement_m, velocity_m_s, acceleration_m_s2 },
        played: Played::Elastica(bent),
        natural_frequencies_rad_s,
        mesh,
        law,
        warnings,
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
        let (input, turning_rad_s) = (driving.at(sample), driving.turning_at(sample));
        let acceleration = equations.accelerations(q, rate, (input, turning_rad_s));
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

/// The hub's angle counts from `from_rad` on, the direction where the tip's displacement is 0.
fn tip_deflection_m(mesh: &Mesh, from_rad: f64, tip_m: &[f64], hub_angle_rad: &[f64]) -> Vec<f64> {
    let samples = tip_m.iter().zip(hub_angle_rad);
    samples.map(|(v, theta)| v - mesh.length_m() * (theta - from_rad)).collect()
}

impl Simulation {
    /// Period of the first flexible mode in s, of the held link where the hub of a linear link moves as prescribed.
    pub fn first_period_s(&self) -> Option<f64> {
        match &self.played {
            Played::Modes(modes) => modes.equations.first_period_s(),
            Played::Elastica(_) => self.natural_frequencies_rad_s.first().map(|omega| TAU / omega),
        }
    }

    /// The play of a linear link.
    pub fn modes(&self) -> Option<&ModalPlay> {
        match &self.played {
            Played::Modes(modes) => Some(modes),
            Played::Elastica(_) => None,
        }
    }

    /// Deflection of the tip from the hub's tangent line, `v_tip − Lθ`, in m.
    pub fn tip_deflection_m(&self) -> Vec<f64> {
        match &self.played {
            Played::Modes(modes) => {
                let (tip_m, hub_rad) = (&self.tip.displacement_m, &self.hub_angle_rad);
                tip_deflection_m(&self.mesh, modes.from_rad, tip_m, hub_rad)
            }
            Played::Elastica(bent) => bent.tip_deflection_m(),
        }
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
        let samples = match &self.played {
            Played::Modes(modes) => {
                let history = |node: &usize| modes.displacement_m(&self.mesh, *node, every);
                nodes.par_iter().map(history).collect()
            }
            Played::Elastica(bent) => {
                let along_m = nodes.iter().map(|node| self.mesh.nodes_m()[*node]);
                bent.displacements_m(&along_m.collect::<Vec<_>>(), every)
            }
        };
        Ok(NodalHistories { nodes: nodes.to_vec(), grid: self.grid.thinned(every), samples })
    }
}

impl ModalPlay {
    /// Total displacement of a node in m, every `every`-th sample.
    fn displacement_m(&self, mesh: &Mesh, node: usize, every: NonZeroUsize) -> Vec<f64> {
        end_if_stopped();
        let at_node = |shape: &Shape| shape.displacement(mesh, node);
        let shapes: Vec<f64> = self.equations.shapes.iter().map(at_node).collect();
        let rest = self.initial_tip_m / mesh.length_m() * mesh.nodes_m()[node];
        let rows = self.record.coordinates.chunks_exact(shapes.len()).step_by(every.get());
        rows.map(|q| rest + q.iter().zip(&shapes).map(|(q, v)| q * v).sum::<f64>()).collect()
    }
}
