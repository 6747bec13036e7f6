//! An arm played step by step: each joint under a torque, or moved as prescribed.

use std::num::NonZeroUsize;

use super::arm_chain::ArmChain;
use super::balance::{Balance, Place};
use super::checks::UNSETTLED;
use super::driving::Driving;
use super::error::SimulationError;
use super::modes::HubReaction;
use super::play::ArmProgress;
use super::radau::{Motion, Radau};
use super::state::ArmState;
use super::stepper::Record;
use crate::numeric::{Size, TimeGrid, dot};

/// Steps beyond which no refinement is made.
const LONGEST: usize = 1 << 20;

/// What each refinement adds to every order.
const MORE_ORDERS: usize = 2;

/// Share of an arm's energy that is round-off.
const ROUND_OFF: f64 = 1e-9;

/// Motion in m or rad that has nothing to settle.
const STILL: f64 = 1e-12;

/// The motion of an arm. The times of all histories are [`PlayedArm::grid`].
#[derive(Debug, Clone)]
pub struct PlayedArm {
    /// Times of all histories.
    pub grid: TimeGrid,
    /// Torque of each joint in N m: what its motor gives, feedback included; friction takes part of it.
    pub torques_n_m: Vec<Vec<f64>>,
    /// Angle, rate and acceleration of each joint in rad, rad/s and rad/s², as an encoder sees them: of its link's root
    /// against the tip of the link before, of the first joint against x.
    pub joints: Vec<[Vec<f64>; 3]>,
    /// Direction of each link's chord in rad.
    pub chords_rad: Vec<Vec<f64>>,
    /// x and y of the tip in m, with rate and acceleration.
    pub tip: [[Vec<f64>; 3]; 2],
    /// Kinetic energy in J.
    pub kinetic_j: Vec<f64>,
    /// Kinetic energy, and that of strain and weight, in J.
    pub energy_j: Vec<f64>,
    /// Work in J that the torques have done.
    pub work_j: Vec<f64>,
    /// What damping and friction have dissipated in J.
    pub lost_j: Vec<f64>,
    /// Torques in N m that hold the arm where it starts.
    pub holding_n_m: Vec<f64>,
    /// Largest change of the tip in m, and of any joint in rad, by the last refinement: longer polynomials, half the step.
    pub change: [f64; 2],
    /// Whether refinement still changes tip or joints by more than a share of 1e-4 of what they move by.
    pub is_unsettled: bool,
    /// Angles that describe the arm.
    pub angles: usize,
    /// Steps of the integration from one sample to the next.
    pub steps: usize,
    pub(super) chain: ArmChain,
    pub(super) record: Record,
}

/// What acts on one joint: a torque against a reaction, or an acceleration that it is given.
#[derive(Debug, Clone)]
pub(super) enum Drive {
    Torque(Driving, HubReaction),
    Acceleration(Driving),
}

/// An arm, what acts on its joints, and where it starts.
pub(super) struct Problem<'a> {
    pub(super) chain: ArmChain,
    pub(super) drives: &'a [Drive],
    pub(super) grid: &'a TimeGrid,
    /// Coordinates and rates.
    pub(super) start: (Vec<f64>, Vec<f64>),
}

/// Plays finer and finer until that changes tip and joints by less than `tolerance` of what they move by, or the finest
/// is reached ([`PlayedArm::change`] tells); `problem` is given how many orders more the polynomials have, `watch` each
/// sample that is played.
///
/// # Errors
/// [`SimulationError`].
pub(super) fn settled<'a>(
    problem: impl Fn(usize) -> Result<Problem<'a>, SimulationError>,
    (tolerance, most_refinements): (f64, usize),
    watch: &dyn Fn(ArmProgress),
) -> Result<PlayedArm, SimulationError> {
    let played = |orders: usize, refinement: usize| {
        let at = |done, samples| watch(ArmProgress { refinement, done, samples });
        problem(orders * MORE_ORDERS)?.played(1 << refinement, at)
    };
    let (mut orders, mut coarse) = (0, played(0, 0));
    for finer in 1..=most_refinements {
        let before = match coarse {
            Ok(before) => before,
            // Steps too long to converge are no reason against shorter ones.
            Err(SimulationError::NotConverged { .. }) => {
                coarse = played(orders, finer);
                continue;
            }
            Err(_) => return coarse,
        };
        orders += 1;
        let mut found = played(orders, finer)?;
        let both = [found.tip_from(&before), found.joints_from(&before)];
        let is_within =
            |share: f64| both.iter().all(|(change, moved)| *change <= (share * moved).max(STILL));
        found.change = both.map(|(change, _)| change);
        found.is_unsettled = !is_within(UNSETTLED);
        let is_last = is_within(tolerance) || (found.grid.len << finer) > LONGEST;
        coarse = Ok(found);
        if is_last {
            break;
        }
    }
    coarse
}

impl Drive {
    fn driving(&self) -> &Driving {
        match self {
            Self::Torque(driving, _) | Self::Acceleration(driving) => driving,
        }
    }

    /// The input a part s of a step after a sample.
    fn input(&self, sample: usize, s: f64) -> f64 {
        let driving = self.driving();
        if s == 0.0 {
            return driving.at(sample);
        }
        let cubic = driving.pieces.get(sample).copied().unwrap_or(driving.held());
        cubic.iter().rev().fold(0.0, |sum, term| sum * s + term)
    }

    /// Puts an input into the equation of a joint, the coordinate of this number.
    fn apply(&self, input: f64, joint: usize, (q, rates): (&[f64], &[f64]), into: &mut Balance) {
        let count = q.len();
        match self {
            Self::Torque(_, reaction) => {
                into.force[joint] += input - reaction.torque_n_m(q[joint], rates[joint]);
            }
            Self::Acceleration(_) => {
                into.mass[joint * count..][..count].fill(0.0);
                into.mass[joint * count + joint] = 1.0;
                into.force[joint] = input;
            }
        }
    }
}

impl Problem<'_> {
    /// Plays with so many steps from one sample to the next; `at` is given how many samples of how many are played.
    fn played(self, steps: usize, at: impl Fn(usize, usize)) -> Result<PlayedArm, SimulationError> {
        let (grid, count) = (*self.grid, self.chain.count);
        let (mut stiffness, mut damping) =
            (self.chain.stiffness.clone(), self.chain.damping.clone());
        for (joint, drive) in self.chain.joints.iter().zip(self.drives) {
            if let Drive::Torque(_, reaction) = drive {
                stiffness[joint * count + joint] += reaction.stiffness_n_m_rad;
                damping[joint * count + joint] += reaction.damping_n_m_s_rad;
            }
        }
        let mut radau = Radau::new(grid.step_s / steps as f64, &stiffness, &damping);
        let mut balance = Balance::default();
        let (q, rates) = self.start.clone();
        let mut motion = Motion { q, rates, accelerations: vec![0.0; count] };
        let mut found = self.begun(steps, &motion, &mut balance);
        self.accelerate(0, &mut motion, &mut balance)?;
        found.observe(&self, 0, &motion, &mut balance);
        for sample in 1..grid.len {
            let not_converged = SimulationError::NotConverged { time_s: grid.time_s(sample) };
            let [mut work_j, mut lost_j] =
                [&found.work_j, &found.lost_j].map(|sum| sum[sample - 1]);
            for step in 0..steps {
                let place = |stage: usize| (step as f64 + Radau::places()[stage]) / steps as f64;
                let is_done = radau.advance(&mut motion, |stage, q, rates, balance| {
                    self.chain.balance(q, rates, balance);
                    self.apply(sample - 1, place(stage), (q, rates), balance);
                });
                if !is_done {
                    return Err(not_converged);
                }
                let reached = radau.reached();
                let lost = reached.iter().map(|own| self.chain.lost_w(&own.rates));
                lost_j += radau.integral(lost);
                let powers = reached.iter().enumerate().map(|(stage, own)| {
                    self.power_w((sample - 1, place(stage)), own, &mut balance)
                });
                work_j += radau.integral(powers);
            }
            found.work_j.push(work_j);
            found.lost_j.push(lost_j);
            self.accelerate(sample, &mut motion, &mut balance)?;
            found.observe(&self, sample, &motion, &mut balance);
            at(sample + 1, grid.len);
        }
        Ok(found)
    }

    /// The result before its first sample, with the torques that hold the arm there.
    fn begun(&self, steps: usize, motion: &Motion, balance: &mut Balance) -> PlayedArm {
        let (links, samples) = (self.chain.links.len(), self.grid.len);
        let column = || Vec::with_capacity(samples);
        self.chain.balance(&motion.q, &vec![0.0; self.chain.count], balance);
        PlayedArm {
            grid: *self.grid,
            torques_n_m: vec![column(); links],
            joints: vec![[(); 3].map(|()| column()); links],
            chords_rad: vec![column(); links],
            tip: [(); 2].map(|()| [(); 3].map(|()| column())),
            kinetic_j: column(),
            energy_j: column(),
            work_j: vec![0.0],
            lost_j: vec![0.0],
            holding_n_m: self
                .chain
                .joints
                .iter()
                .map(|joint| 0.0 - balance.force[*joint])
                .collect(),
            change: [f64::INFINITY; 2],
            is_unsettled: true,
            angles: self.chain.count,
            steps,
            chain: self.chain.clone(),
            record: Record::with_capacity(self.chain.count, samples),
        }
    }

    /// Puts in what acts on the joints a part s of a step after a sample.
    fn apply(&self, sample: usize, s: f64, at: (&[f64], &[f64]), balance: &mut Balance) {
        for (joint, drive) in self.chain.joints.iter().zip(self.drives) {
            drive.apply(drive.input(sample, s), *joint, at, balance);
        }
    }

    /// The accelerations at a sample; where a torque jumps, those of the last step's end are of the torque before.
    fn accelerate(
        &self,
        sample: usize,
        motion: &mut Motion,
        balance: &mut Balance,
    ) -> Result<(), SimulationError> {
        let at = (&motion.q[..], &motion.rates[..]);
        self.chain.balance(at.0, at.1, balance);
        self.apply(sample, 0.0, at, balance);
        let lost = SimulationError::NotFinite { time_s: self.grid.time_s(sample) };
        motion.accelerations = balance.accelerations().ok_or(lost)?;
        Ok(())
    }

    /// Torque of each joint in N m, a part s of a step after a sample: what its motor gives, or what its motion takes.
    fn torques_n_m(
        &self,
        (sample, s): (usize, f64),
        motion: &Motion,
        balance: &mut Balance,
    ) -> Vec<f64> {
        let Motion { q, rates, accelerations } = motion;
        if self.drives.iter().any(|drive| matches!(drive, Drive::Acceleration(_))) {
            self.chain.balance(q, rates, balance);
        }
        let joints = self.chain.joints.iter().zip(&self.chain.friction_n_m_s_rad);
        let torque = |(drive, (joint, friction)): (&Drive, (&usize, &f64))| {
            let rubbed = friction * rates[*joint];
            match drive {
                Drive::Acceleration(_) => {
                    let row = &balance.mass[joint * q.len()..][..q.len()];
                    dot(row, accelerations) - balance.force[*joint] + rubbed
                }
                Drive::Torque(_, reaction) => {
                    let opposed = reaction.torque_n_m(q[*joint], rates[*joint]);
                    drive.input(sample, s) - opposed + rubbed
                }
            }
        };
        self.drives.iter().zip(joints).map(torque).collect()
    }

    /// Power of all torques in W.
    fn power_w(&self, at: (usize, f64), motion: &Motion, balance: &mut Balance) -> f64 {
        let torques = self.torques_n_m(at, motion, balance);
        let joints = self.chain.joints.iter().zip(torques);
        joints.map(|(joint, torque)| torque * motion.rates[*joint]).sum()
    }
}

impl PlayedArm {
    /// Adds what a motion is like at a sample.
    fn observe(
        &mut self,
        problem: &Problem<'_>,
        sample: usize,
        motion: &Motion,
        balance: &mut Balance,
    ) {
        let Motion { q, rates, accelerations } = motion;
        let chain = &problem.chain;
        let torques = problem.torques_n_m((sample, 0.0), motion, balance);
        for (number, (joint, torque_n_m)) in chain.joints.iter().zip(torques).enumerate() {
            self.torques_n_m[number].push(torque_n_m);
            let row = [q[*joint], rates[*joint], accelerations[*joint]];
            self.joints[number].iter_mut().zip(row).for_each(|(column, own)| column.push(own));
        }
        let (ends, energies) = chain.ends_and_energies(q, rates);
        for (column, own) in self.chords_rad.iter_mut().zip(chain.chords_rad(q, &ends)) {
            column.push(own);
        }
        let fixed = Place::fixed(q.len());
        let tip = ends.last().unwrap_or(&fixed);
        let moving = tip.acceleration_m_s2(accelerations);
        for (axis, columns) in self.tip.iter_mut().enumerate() {
            let row = [tip.at_m[axis], tip.rate_m_s[axis], moving[axis]];
            columns.iter_mut().zip(row).for_each(|(column, own)| column.push(own));
        }
        self.kinetic_j.push(energies.kinetic_j);
        self.energy_j.push(energies.kinetic_j + energies.potential_j);
        self.record.push(q, rates);
    }

    /// Largest distance in m of the tip from that of another play, and from where it starts.
    fn tip_from(&self, other: &Self) -> (f64, f64) {
        let [x, y] = [0, 1].map(|axis: usize| &self.tip[axis][0]);
        let [other_x, other_y] = [0, 1].map(|axis: usize| &other.tip[axis][0]);
        let apart = |k: usize, to: [f64; 2]| {
            let [x, y] = [x[k] - to[0], y[k] - to[1]];
            (x * x + y * y).sqrt()
        };
        let all = 0..self.grid.len;
        let change = all.clone().map(|k| apart(k, [other_x[k], other_y[k]]));
        let moved = all.map(|k| apart(k, [x[0], y[0]]));
        (change.fold(0.0, Size::larger), moved.fold(0.0, Size::larger))
    }

    /// Largest difference of a joint's angle in rad from that of another play, and the largest turn of any.
    fn joints_from(&self, other: &Self) -> (f64, f64) {
        let joints = self.joints.iter().zip(&other.joints);
        let of = |(own, other): (&[Vec<f64>; 3], &[Vec<f64>; 3])| {
            let change = own[0].iter().zip(&other[0]).map(|(a, b)| (a - b).abs());
            let moved = own[0].iter().map(|a| (a - own[0][0]).abs());
            (change.fold(0.0, Size::larger), moved.fold(0.0, Size::larger))
        };
        joints.map(of).fold((0.0, 0.0), |most, own| {
            (Size::larger(most.0, own.0), Size::larger(most.1, own.1))
        })
    }

    /// Largest distance of the tip from where it starts in m.
    pub fn way_m(&self) -> f64 {
        self.tip_from(self).1
    }

    /// Largest imbalance of energy over the largest work, kinetic energy or change of all energy; 0 of an arm at rest.
    pub fn imbalance(&self) -> f64 {
        // What is so small beside all energy is round-off.
        let held_j = self.energy_j.iter().map(|own| own.abs()).fold(0.0, f64::max);
        let (mut missing, mut size) = (0.0, ROUND_OFF * held_j);
        for (sample, energy_j) in self.energy_j.iter().enumerate() {
            let (held_j, work_j) = (energy_j - self.energy_j[0], self.work_j[sample]);
            missing = Size::larger(missing, (work_j - held_j - self.lost_j[sample]).abs());
            let most = held_j.abs().max(work_j.abs()).max(self.kinetic_j[sample]);
            size = Size::larger(size, most);
        }
        if size == 0.0 { 0.0 } else { missing / size }
    }

    /// Where the arm is at the last sample, and how it moves.
    pub fn state(&self) -> ArmState {
        let last = self.grid.len - 1;
        let (q, rates) = self.record.at(last);
        self.chain.state(self.grid.time_s(last), q, rates)
    }

    /// x and y in m of places on the links, every `every`-th sample: of each link, of each of its places. `along_m` has
    /// their distances in m from the joint of each link.
    pub fn positions_m(
        &self,
        along_m: &[Vec<f64>],
        every: NonZeroUsize,
    ) -> Vec<Vec<[Vec<f64>; 2]>> {
        let stations = self.chain.stations(along_m);
        let columns = |own: &Vec<f64>| own.iter().map(|_| [Vec::new(), Vec::new()]).collect();
        let mut found: Vec<Vec<[Vec<f64>; 2]>> = along_m.iter().map(columns).collect();
        for sample in (0..self.grid.len).step_by(every.get()) {
            let places = self.chain.places_m(&stations, self.record.at(sample).0);
            for (columns, place) in found.iter_mut().flatten().zip(places.iter().flatten()) {
                columns.iter_mut().zip(place).for_each(|(column, part)| column.push(*part));
            }
        }
        found
    }
}
