//! Place and motion of a link or an arm at one instant, the start of another simulation.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, Vector2};
use serde::{Deserialize, Serialize};

use super::driving::{CycleError, Driving, Step};
use super::error::SimulationError;
use super::modes::Equations;
use super::radau::Motion;
use super::stepper::Stepper;
use crate::beam::Mesh;
use crate::link::{Arm, Link, POSITION_TOLERANCE};
use crate::modal::Shape;
use crate::numeric::{TimeGrid, largest, rounded};

/// Largest difference between the direction of a link on a carriage and the root's slope of its state, whole turns apart.
const SAME_DIRECTION_RAD: f64 = 1e-9;

/// The motion of a link at one instant.
///
/// A linear link has displacements and slopes, cubic between the places. An elastica has slopes, polynomials between
/// two masses or segment ends.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkState {
    /// Time of the instant in s.
    pub time_s: f64,
    /// Distances of the places from the axis in m, along the link, from its root to its tip.
    pub x_m: Vec<f64>,
    /// Direction of the link there in rad.
    pub slope_rad: Vec<f64>,
    /// Its rate in rad/s.
    pub slope_rate_rad_s: Vec<f64>,
    /// Displacement of a linear link there in m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement_m: Option<Vec<f64>>,
    /// Its velocity in m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_m_s: Option<Vec<f64>>,
    /// Displacement in m and velocity in m/s of the carriage of an elastica.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carriage: Option<[f64; 2]>,
}

impl LinkState {
    /// Refuses a state that does not suit the link.
    ///
    /// # Errors
    /// [`SimulationError::State`].
    pub(super) fn check(&self, link: &Link, is_large: bool) -> Result<(), SimulationError> {
        let refused = |found: String, must: String| Err(SimulationError::State { found, must });
        let linear = [&self.displacement_m, &self.velocity_m_s];
        match (linear.iter().all(|list| list.is_some()), is_large) {
            (true, true) => {
                return refused("is of a linear link".into(), "be one at large angles".into());
            }
            (false, false) => {
                return refused("is of a link at large angles".into(), "be of a linear one".into());
            }
            _ => {}
        }
        // Words that stay in messages on a carriage.
        let kind = |slides| if slides { "of a link that slides" } else { "of a link that rotates" };
        let [found, own] = [self.carriage.is_some(), is_large && link.joint().slides()];
        if found != own {
            return refused(format!("is {}", kind(found)), format!("be {}", kind(own)));
        }
        let places = self.x_m.len();
        let lists = [Some(&self.slope_rad), Some(&self.slope_rate_rad_s)].into_iter();
        let lists = lists.chain(linear.map(Option::as_ref)).flatten();
        if places < 2 || lists.clone().any(|list| list.len() != places) {
            let must = "have as many numbers in every list, two or more";
            return refused(format!("has {places} places"), must.into());
        }
        let numbers = lists.flatten().chain(&self.x_m).chain(self.carriage.iter().flatten());
        if let Some(lost) = numbers.copied().find(|number| !number.is_finite()) {
            return refused(format!("holds {lost}"), "hold finite numbers".into());
        }
        let own_rad = link.direction_rad().unwrap_or(0.0);
        let apart_rad = self.slope_rad[0] - own_rad;
        let apart_rad = apart_rad - TAU * (apart_rad / TAU).round();
        if link.joint().slides() && apart_rad.abs() > SAME_DIRECTION_RAD {
            let [found, own] = [self.slope_rad[0], own_rad].map(|rad| rounded(rad.to_degrees(), 6));
            return refused(format!("has the direction {found} deg"), format!("have {own} deg"));
        }
        let is_sprung = link.root_stiffness_n_m_rad().is_some();
        let mut pairs = self.x_m.windows(2).skip(usize::from(is_sprung) * self.springs());
        if let Some([inner, outer]) = pairs.find(|pair| pair[1] <= pair[0]) {
            return refused(format!("has {outer} m after {inner} m"), "have rising places".into());
        }
        let (root_m, tip_m) = (link.hub().radius_m, link.length_m());
        let ends = [(self.x_m[0], root_m), (self.x_m[places - 1], tip_m)];
        if ends.iter().any(|(found, own)| (found - own).abs() > POSITION_TOLERANCE * tip_m) {
            let found = format!("reaches from {} to {} m", self.x_m[0], self.x_m[places - 1]);
            return refused(found, format!("reach from {root_m} to {tip_m} m, as the link does"));
        }
        Ok(())
    }

    /// Displacements and slopes, and their rates, of a linear link at the nodes of a mesh; the displacement is 0 where
    /// the link points to `origin_rad`.
    fn shapes(&self, mesh: &Mesh, origin_rad: f64) -> [Shape; 2] {
        let no = Vec::new();
        let lists = [
            (self.displacement_m.as_ref().unwrap_or(&no), &self.slope_rad, origin_rad),
            (self.velocity_m_s.as_ref().unwrap_or(&no), &self.slope_rate_rad_s, 0.0),
        ];
        lists.map(|(values, slopes, origin_rad)| {
            let at = |x_m| between(&self.x_m, values, slopes, origin_rad, x_m);
            let root_m = values.first().copied().unwrap_or_default();
            let hub_angle = mesh.joint().position([root_m, slopes[0] - origin_rad]);
            let node = |node| {
                Vector2::from(at(mesh.nodes_m()[node]))
                    - Vector2::from(mesh.rigid(node)) * hub_angle
            };
            Shape { hub_angle, deflections: (0..mesh.nodes_m().len()).map(node).collect() }
        })
    }

    /// Coordinates and rates of the modes of a linear link, and their omitted part over the whole, as square roots of
    /// energies of motion.
    pub(super) fn coordinates(
        &self,
        equations: &Equations,
        mesh: &Mesh,
        origin_rad: f64,
    ) -> ([Vec<f64>; 2], f64) {
        let mut left_out = 0.0_f64;
        let coordinates = self.shapes(mesh, origin_rad).map(|own| {
            let of = |shape: &Shape| shape.mass_product(mesh, &own);
            let q: Vec<f64> = equations.shapes.iter().map(of).collect();
            let rest = own.clone().less(1.0, &Shape::sum(&q, &equations.shapes));
            let (rest, whole) = (rest.mass_product(mesh, &rest), own.mass_product(mesh, &own));
            if whole > 0.0 {
                left_out = left_out.max((rest.max(0.0) / whole).sqrt());
            }
            q
        });
        (coordinates, left_out)
    }

    /// The slopes of an elastica, less the hub's, and their rates, at the places from one distance to another: (t, slope,
    /// rate), t from −1 to 1.
    pub(super) fn piece(&self, [from_m, to_m]: [f64; 2]) -> Vec<[f64; 3]> {
        let same_m = POSITION_TOLERANCE * self.x_m[self.x_m.len() - 1];
        let hub = [self.slope_rad[0], self.slope_rate_rad_s[0]];
        let inside = |k: &usize| (from_m - same_m..=to_m + same_m).contains(&self.x_m[*k]);
        let row = |k: usize| {
            let t = 2.0 * (self.x_m[k] - from_m) / (to_m - from_m) - 1.0;
            let t = t.clamp(-1.0, 1.0);
            [t, self.slope_rad[k] - hub[0], self.slope_rate_rad_s[k] - hub[1]]
        };
        (self.springs()..self.x_m.len()).filter(inside).map(row).collect()
    }

    /// 1 if the root has two slopes: that of the joint, then that of the link on its spring.
    fn springs(&self) -> usize {
        usize::from(self.x_m[1].total_cmp(&self.x_m[0]).is_eq())
    }
}

/// Most cycles until the state repeats, and the change between cycles, over the turn of the hub, that counts as
/// repeating. If changes fall by a hundredth from cycle to cycle, the remaining error is a hundred times the last
/// change.
const MOST_CYCLES: usize = 400;
const SETTLED: f64 = 1e-9;

/// Largest repeating vibration, over the vibration that a cycle adds; a larger one belongs to an undamped link in step
/// with the cycle.
const MOST_GROWTH: f64 = 1e5;

/// Largest mean torque of a free hub, over the largest torque; a larger mean turns it faster from cycle to cycle.
const MEAN: f64 = 1e-6;

/// Coordinates and rates at both ends of a repeating cycle, with a sample at each time of the grid. Without stiffness at the hub `start_m`
/// sets the tip's displacement at the start; without damping as well, `travel_m` sets its displacement over the cycle.
///
/// With M the transition over a cycle and c the state after a cycle from rest, x = (1 − M)⁻¹ c. Without stiffness the
/// angle of the rigid rotation is arbitrary; without damping as well, its rate follows from its travel. Losses of a drive are
/// not linear: from there cycles with them follow until they repeat.
///
/// # Errors
/// [`CycleError`].
pub(super) fn of_cycle(
    equations: &Equations,
    driving: &Driving,
    grid: TimeGrid,
    [travel_m, start_m]: [f64; 2],
) -> Result<[Vec<f64>; 2], SimulationError> {
    let (samples, lossless) = (grid.len, Equations { losses: None, ..equations.clone() });
    let stepper = Stepper::new(&lossless, grid.step_s);
    let mut cycle = stepper.clone();
    driving.steps(samples + 1).for_each(|step| cycle.advance(&step));
    let mut right = DVector::from_column_slice(cycle.state());
    let states = right.len();
    let mut matrix = DMatrix::identity(states, states) - stepper.transition_over(samples);
    let rigid = &equations.coordinates[0];
    let (angle, rate) = (0, states / 2);
    let is_held = equations.reaction.stiffness_n_m_rad != 0.0;
    if !is_held {
        let is_damped = equations.reaction.damping_n_m_s_rad != 0.0 || rigid.rate_per_s != 0.0;
        if !is_damped {
            let torques = || (0..samples).map(|k| driving.at(k));
            let (mean, most) = (
                torques().sum::<f64>() / samples as f64,
                torques().fold(0.0_f64, |most, torque| most.max(torque.abs())),
            );
            if mean.abs() > MEAN * most {
                return Err(CycleError::Mean { mean_n_m: mean }.into());
            }
            let turned = matrix.row(angle).clone_owned();
            matrix.set_row(rate, &turned);
            let travelled = stepper.factors(&[1.0], &[])[0].recip() * travel_m / rigid.tip;
            right[rate] = right[angle] - travelled;
        }
        matrix.row_mut(angle).fill(0.0);
        matrix[(angle, angle)] = 1.0;
        right[angle] = 0.0;
    }
    let driven = largest(right.as_slice());
    // A larger ratio means that no noticeable damping limits the vibration.
    let repeats = |state: &DVector<f64>| state.iter().all(|x| x.abs() <= MOST_GROWTH * driven);
    let state = matrix.lu().solve(&right).filter(repeats).ok_or(CycleError::Resonance)?;
    let [mut coordinates, mut rates] = stepper.of_state(state.as_slice());
    if equations.losses.is_some() {
        let turning = if is_held { Vec::new() } else { vec![angle] };
        let cycle = Cycle { grid, turning, is_prescribed: false };
        let steps: Vec<Step> = driving.steps(samples + 1).collect();
        let mut stepper = Stepper::new(equations, grid.step_s);
        let mut motion = Motion { q: coordinates, rates, accelerations: Vec::new() };
        settle(&mut motion, &cycle, (&[angle], 1.0), |motion, sample| {
            stepper.start_at(&motion.q, &motion.rates);
            stepper.advance(&steps[sample]);
            (motion.q, motion.rates) = (stepper.coordinates(), stepper.rates());
            Ok(())
        })?;
        (coordinates, rates) = (motion.q, motion.rates);
    }
    if equations.prescribed.is_some() {
        coordinates[0] = 0.0;
    } else if !is_held {
        coordinates[0] = (start_m - equations.tip(&coordinates)) / rigid.tip;
    }
    Ok([coordinates, rates])
}

/// One cycle that repeats.
#[derive(Debug, Clone)]
pub(super) struct Cycle {
    pub(super) grid: TimeGrid,
    /// Coordinates of joints that may turn on from cycle to cycle: prescribed ones, or the first one where nothing
    /// holds it.
    pub(super) turning: Vec<usize>,
    /// Whether they are prescribed.
    pub(super) is_prescribed: bool,
}

impl Cycle {
    /// A cycle of prescribed joints.
    pub(super) fn prescribed(grid: TimeGrid, joints: &[usize]) -> Self {
        Self { grid, turning: joints.to_vec(), is_prescribed: true }
    }
}

/// Integrates cycles until the state repeats. Each cycle begins with the first positions of turning joints. Of their motion
/// only the rate of an unheld joint must repeat. Changes of `joints` count over the size of their positions.
///
/// # Errors
/// [`CycleError`], and errors of `advance`.
pub(super) fn settle(
    motion: &mut Motion,
    Cycle { grid, turning, is_prescribed }: &Cycle,
    (joints, size): (&[usize], f64),
    mut advance: impl FnMut(&mut Motion, usize) -> Result<(), SimulationError>,
) -> Result<(), SimulationError> {
    let cycle_s = grid.len as f64 * grid.step_s;
    let mut last = f64::INFINITY;
    for _ in 0..MOST_CYCLES {
        let start = motion.clone();
        let mut turned_rad = 0.0_f64;
        for sample in 0..grid.len {
            advance(motion, sample)?;
            let turns_rad = joints.iter().map(|joint| (motion.q[*joint] - start.q[*joint]).abs());
            turned_rad = turns_rad.map(|own| own / size).fold(turned_rad, f64::max);
        }
        for joint in turning {
            motion.q[*joint] = start.q[*joint];
            if *is_prescribed {
                // The integral of the accelerations has small errors, which must not add up.
                motion.rates[*joint] = start.rates[*joint];
            }
        }
        let changes_rad = (0..motion.q.len()).map(|coordinate| {
            let change = if turning.contains(&coordinate) {
                (motion.rates[coordinate] - start.rates[coordinate]) * cycle_s
            } else {
                motion.q[coordinate] - start.q[coordinate]
            };
            if joints.contains(&coordinate) { change / size } else { change }
        });
        let changed_rad = changes_rad.map(f64::abs).fold(0.0, f64::max);
        let share = changed_rad / turned_rad.max(f64::MIN_POSITIVE);
        if share <= SETTLED {
            return Ok(());
        }
        last = share;
    }
    Err(CycleError::Unsettled { cycles: MOST_CYCLES, share: last }.into())
}

/// Value and slope at a place, by the cubics through all values and slopes; slopes count from `origin`.
fn between(x_m: &[f64], values: &[f64], slopes: &[f64], origin: f64, at_m: f64) -> [f64; 2] {
    let inner = x_m.partition_point(|x| *x <= at_m).clamp(1, x_m.len() - 1) - 1;
    let (l, outer) = (x_m[inner + 1] - x_m[inner], inner + 1);
    let t = (at_m - x_m[inner]) / l;
    let rise = values[outer] - values[inner];
    let [from, to] = [slopes[inner] - origin, slopes[outer] - origin].map(|slope| slope * l);
    let cubic = [values[inner], from, 3.0 * rise - 2.0 * from - to, from + to - 2.0 * rise];
    let value = cubic.iter().rev().fold(0.0, |sum, term| sum * t + term);
    [value, (cubic[1] + t * (2.0 * cubic[2] + 3.0 * t * cubic[3])) / l]
}

/// The motion of a link or an arm at one instant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// The state of each link, the inner one first: slopes against x along it.
    pub links: Vec<LinkState>,
    /// Displacement in m and rate in m/s of the carriage of an arm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carriage: Option<[f64; 2]>,
}

impl State {
    /// A linear link that moves undeformed, with these position and rate of its joint.
    pub(crate) fn undeformed(link: &Link, time_s: f64, motion: [f64; 2]) -> Self {
        let x_m = vec![link.hub().radius_m, link.length_m()];
        let rigid = |part: usize, of: f64| -> Vec<f64> {
            x_m.iter().map(|x| of * link.joint().rigid(*x)[part]).collect()
        };
        let [position, rate] = motion;
        let state = LinkState {
            time_s,
            slope_rad: rigid(1, position),
            slope_rate_rad_s: rigid(1, rate),
            displacement_m: Some(rigid(0, position)),
            velocity_m_s: Some(rigid(0, rate)),
            x_m: x_m.clone(),
            carriage: None,
        };
        Self { links: vec![state], carriage: None }
    }

    /// Refuses a state that does not suit the links.
    ///
    /// # Errors
    /// [`SimulationError::State`].
    pub(super) fn check(&self, arm: &Arm, is_large: bool) -> Result<(), SimulationError> {
        let (count, links) = (self.links.len(), arm.links().len());
        if count != links {
            let must = format!("be one of {links} links");
            return Err(SimulationError::State { found: format!("is one of {count} links"), must });
        }
        let kinds = [self.carriage.is_some(), arm.carriage().is_some()];
        let [found, own] = kinds.map(|slides| if slides { "on a carriage" } else { "at rest" });
        if kinds[0] != kinds[1] {
            let [found, must] = [format!("is of a base {found}"), format!("be of a base {own}")];
            return Err(SimulationError::State { found, must });
        }
        if let Some(lost) = self.carriage.iter().flatten().find(|own| !own.is_finite()) {
            let must = "hold finite numbers".to_owned();
            return Err(SimulationError::State { found: format!("holds {lost}"), must });
        }
        let time_s = self.links[0].time_s;
        if let Some(other) = self.links.iter().find(|own| own.time_s.total_cmp(&time_s).is_ne()) {
            let found = format!("is at {} s and at {time_s} s", other.time_s);
            let must = "have one time".to_owned();
            return Err(SimulationError::State { found, must });
        }
        for (number, (state, own)) in self.links.iter().zip(arm.links()).enumerate() {
            state.check(&own.link, is_large).map_err(|error| match error {
                SimulationError::State { found, must } if links > 1 => {
                    let found = format!("{found} on {}", arm.name_of(number));
                    SimulationError::State { found, must }
                }
                other => other,
            })?;
        }
        Ok(())
    }
}
