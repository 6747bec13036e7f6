//! Simulation of a linear link by its modes.

use std::f64::consts::TAU;

use super::bent::JointMotion;
use super::driving::Driving;
use super::error::{SimulationError, SimulationWarning};
use super::losses::{Losses, MOST_SUBSTEPS};
use super::modes::Equations;
use super::play::{LEFT_OUT, Play, Started, refuse_memory};
use super::played::{ModalPlay, Played, PlayedBy, PlayedLink, deflection_m};
use super::residual::{PlayedModelError, Reading, ResidualVibration};
use super::stepper::Record;
use crate::beam::Mesh;
use crate::link::{Drive, Link};
use crate::modal::{DampingLaw, deflection_weights, hub_moves_mass, second_order_share};
use crate::motion::TipMotionHistories;
use crate::numeric::{TimeGrid, largest, largest_difference};

/// Memory in bytes for each sample, as measured, besides the coordinate and the rate of each mode.
const BYTES_PER_SAMPLE: usize = 190;

/// Memory in bytes for each sample of a reference's rate, its cubics, and the copy for the balance of energy.
const BYTES_OF_TURNING: usize = 48;

/// Largest vibration over the tip's travel that the rows need not show.
const VIBRATES: f64 = 1e-6;

/// Computes the motion under an input, torque or hub angle, that drives the link up to `band_rad_s`.
pub(super) fn play_modes(
    link: &Link,
    mesh: Mesh,
    play: &Play,
    band_rad_s: f64,
) -> Result<Played, SimulationError> {
    if !hub_moves_mass(&mesh) {
        return Err(SimulationError::MasslessHub);
    }
    let (grid, driving) =
        (play.grid()?, play.driving((0, link), play.zero_of_state_rad(link), link.has_weight())?);
    let law = DampingLaw::of(link, &mesh)?;
    let Started { mut equations, selection, start, left_out } =
        Started::of(link, (&mesh, &law), (play, &driving), band_rad_s)?;
    let modes = equations.coordinates.len();
    let samples = grid.len;
    let turning = if driving.turning.is_some() { BYTES_OF_TURNING } else { 0 };
    let bytes = samples * (2 * size_of::<f64>() * modes + BYTES_PER_SAMPLE + turning);
    refuse_memory((samples, modes), bytes, play.memory_bytes)?;
    let mut record = Record::of(&equations, &driving, &grid, &start);
    let mut unsettled = None;
    let losses = play.is_under_voltage.then(|| {
        let back = link.drive().and_then(Drive::back_friction);
        Losses::of(link, back, (record.largest_rate(&equations), grid.duration_s()))
    });
    if let Some(losses) = losses.flatten() {
        let starts = |own: &Equations| Ok(play.start(link, (own, &mesh), &driving)?.0);
        let change = settle(&mut equations, losses, &mut record, (&driving, &grid, &starts))?;
        unsettled = SimulationWarning::coarse_losses(change);
    }
    let initial_tip_m = play.start_m(link);
    let from_rad = play.origin_rad(link).unwrap_or(0.0);
    let offsets = [from_rad + initial_tip_m / mesh.rigid_tip(), initial_tip_m];
    let observed = observed(&record, &equations, &driving, offsets, &grid)?;
    let [torque_n_m, angle_rad, rate_rad_s, acceleration_rad_s2, tip @ ..] = observed;
    let [displacement_m, velocity_m_s, acceleration_m_s2] = tip;
    let tip = TipMotionHistories { displacement_m, velocity_m_s, acceleration_m_s2 };
    let driven = play.input.grid().len;
    let goal_m = play.goal_rad(link).map(|turn_rad| turn_rad * mesh.rigid_tip());
    let reading = Reading::new(&equations, goal_m);
    let (last, held) = (record.at(driven - 1), driving.held());
    // Friction stops what vibrates on.
    let rings_on = play.cycle_turn_rad.is_none() && equations.losses.is_none();
    let residual = rings_on
        .then(|| ResidualVibration::of(&equations, last, held, &reading, tip.largest_travel_m()));
    let has_turning = driving.turning.is_some();
    let turning_rad_s = driving.turning_rad_s(if has_turning { grid.len } else { 0 });
    let deflection_m = deflection_m(&mesh, from_rad, &tip.displacement_m, &angle_rad);
    // The hub of a vibrating link swings faster than the link turns.
    let turned = largest(&tip.velocity_m_s) / mesh.rigid_tip();
    let share_of = second_order_share(&mesh, link, turned.min(largest(&rate_rad_s)));
    let bends_m = largest(&deflection_m);
    let vibrates_m = residual.map_or(0.0, |residual| residual.amplitude_m);
    let shares = [bends_m, vibrates_m].map(|bent_m| share_of(bent_m, deflection_weights(link)));
    let omega_rad_s = equations.first_period_s().map_or(0.0, |period_s| TAU / period_s);
    let moves_m = (bends_m, tip.largest_travel_m());
    let vibration = (omega_rad_s, grid.duration_s());
    let model_error = PlayedModelError::of(shares, moves_m, residual.as_ref(), vibration);
    let is_cut = play.state.is_some() && left_out > LEFT_OUT;
    let cut = is_cut.then_some(SimulationWarning::StateCut { share: left_out });
    let of_input = play.warnings_of_input((&grid, &torque_n_m));
    // Without a vibration the rows need not show it.
    let vibrates = residual.is_none_or(|residual| residual.share > VIBRATES);
    let coarse = SimulationWarning::coarse_step(grid.step_s, equations.first_period_s());
    let coarse = coarse.filter(|_| vibrates);
    let others = [coarse, model_error.warning(), unsettled];
    let warnings = cut.into_iter().chain(of_input).chain(others.into_iter().flatten()).collect();
    let hub = JointMotion {
        torque_n_m,
        net_n_m: None,
        angle_rad,
        rate_rad_s,
        acceleration_rad_s2,
        holding_n_m: None,
    };
    let by = PlayedBy::Modes(ModalPlay {
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
    });
    let links = vec![PlayedLink::of(link, mesh, law)];
    Ok(Played { grid, driven, joints: vec![hub], tip: vec![tip], links, by, warnings })
}

/// Change of tip or hub by halved steps of the losses, over the motion, that ends the halving.
const SETTLED: f64 = 1e-7;

/// Most passes until the peak rate that sets the friction's rate stays, and its largest change that stays.
pub(super) const PASSES: usize = 8;
pub(super) const STEADY: f64 = 1e-4;

/// Coordinates and rates at the start; in a cycle they depend on the losses.
type Starts<'a> = dyn Fn(&Equations) -> Result<[Vec<f64>; 2], SimulationError> + 'a;

/// Plays the losses: first at the friction's rate for the peak rate that they leave, then in steps halved until tip and hub
/// stay. Returns the last change, over the motion.
fn settle(
    equations: &mut Equations,
    losses: Losses,
    record: &mut Record,
    (driving, grid, starts): (&Driving, &TimeGrid, &Starts<'_>),
) -> Result<f64, SimulationError> {
    let mut own = losses;
    let mut play = |own: Losses, record: &mut Record| {
        equations.losses = Some(own);
        *record = Record::of(equations, driving, grid, &starts(equations)?);
        let rate = record.largest_rate(equations);
        Ok::<_, SimulationError>((rate, record.histories(equations)))
    };
    let mut last = play(own, record)?;
    for _ in 0..PASSES {
        let next = own.at(last.0);
        let is_steady = (next.friction_rate / own.friction_rate - 1.0).abs() <= STEADY;
        if is_steady || last.0 == 0.0 {
            break;
        }
        own = next;
        last = play(own, record)?;
    }
    let mut change = f64::INFINITY;
    while own.substeps < MOST_SUBSTEPS && change > SETTLED {
        own.substeps *= 2;
        let finer = play(own, record)?;
        let shares = last.1.iter().zip(&finer.1).map(|(coarse, fine)| {
            let off = largest_difference(coarse, fine);
            if off == 0.0 { 0.0 } else { off / largest(fine) }
        });
        change = shares.fold(0.0, f64::max);
        last = finer;
    }
    // A joint that creeps stands still in every step.
    Ok(if own.holds() { 0.0 } else { change })
}

impl Record {
    /// Largest rate of the hub.
    fn largest_rate(&self, equations: &Equations) -> f64 {
        (0..self.len()).map(|k| equations.hub(self.at(k).1).abs()).fold(0.0, f64::max)
    }

    /// Displacements of the tip, and turns of the hub, from their starts.
    fn histories(&self, equations: &Equations) -> [Vec<f64>; 2] {
        let moved = |of: &dyn Fn(&[f64]) -> f64| {
            let start = of(self.at(0).0);
            (0..self.len()).map(|k| of(self.at(k).0) - start).collect()
        };
        [moved(&|q| equations.tip(q)), moved(&|q| equations.hub(q))]
    }
}

/// Motor torque in N m. Angle, rate and acceleration of the hub in rad, rad/s and rad/s². Displacement, velocity and
/// acceleration of the tip in m, m/s and m/s². The hub angle and the tip's displacement begin at `start`.
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
        let input = input - equations.loss_n_m(q, rate, input);
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
