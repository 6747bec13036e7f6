//! Motion of links with weight or at large angles, and of arms of them: elasticas one after the other.

use std::num::NonZeroUsize;

use super::balance::Place;
use super::linkage::Linkage;
use super::radau::Motion;
use super::shape::direction;
use super::state::State;
use super::stepper::Record;
use crate::link::Drive;
use crate::motion::TipMotionHistories;
use crate::numeric::{Size, TimeGrid};

/// Largest change of an angle in rad that is round-off.
const ROUND_OFF_RAD: f64 = 1e-12;

/// Share of an arm's energy that is round-off.
const ROUND_OFF: f64 = 1e-9;

/// Histories of a joint as its encoder measures them: its link's root against the tip of the link before, the first
/// root against x.
#[derive(Debug, Clone)]
pub struct JointMotion {
    /// Torque of the motor in N m, feedback included; friction takes part of it. Under a voltage the torque at the joint,
    /// behind rotor and losses.
    pub torque_n_m: Vec<f64>,
    /// Under a voltage, torque in N m in front of rotor and back voltage, less the losses.
    pub net_n_m: Option<Vec<f64>>,
    /// Angle in rad.
    pub angle_rad: Vec<f64>,
    /// Rate in rad/s.
    pub rate_rad_s: Vec<f64>,
    /// Acceleration in rad/s².
    pub acceleration_rad_s2: Vec<f64>,
    /// Torque in N m that holds bent links at their start.
    pub holding_n_m: Option<f64>,
}

impl JointMotion {
    /// The motion with the torque at the joint, behind rotor and back voltage of a motor.
    pub(super) fn behind(self, drive: &Drive) -> Self {
        let (friction, rotor) = (drive.back_friction().unwrap_or(0.0), drive.rotor_at_joint());
        let motions = self.rate_rad_s.iter().zip(&self.acceleration_rad_s2);
        let torques = self.torque_n_m.iter().zip(motions);
        let at_joint =
            torques.map(|(net, (rate, turning))| net - friction * rate - rotor * turning);
        let torque_n_m = at_joint.collect();
        Self { net_n_m: Some(self.torque_n_m), torque_n_m, ..self }
    }
}

/// Motion of links that bend as elasticas.
#[derive(Debug, Clone)]
pub struct BentPlay {
    /// Number of coordinates that describe the links, the joints included.
    pub angles: usize,
    /// Steps of the integration from one sample to the next.
    pub steps: usize,
    /// Direction of each link's chord at each sample in rad, whole turns counted.
    pub chords_rad: Vec<Vec<f64>>,
    /// Kinetic energy in J.
    pub kinetic_j: Vec<f64>,
    /// Energy of strain and weight in J.
    pub potential_j: Vec<f64>,
    /// Work in J of an arm's torques; empty for one link.
    pub work_j: Vec<f64>,
    /// Energy in J that damping and friction of an arm dissipate; empty for one link.
    pub lost_j: Vec<f64>,
    /// Largest change of the tip in m, and of any joint's position (of an arm's carriage over the arm's length), by the last
    /// refinement: two angles more on each piece, half the step.
    pub change: [f64; 2],
    /// Whether refinement still changes tip or joints by more than 1e-4 of their movement.
    pub is_unsettled: bool,
    pub(super) linkage: Linkage,
    record: Record,
    /// Direction in rad of zero displacement for one link that turns.
    from_rad: f64,
    /// Direction of each link's chord less that of its root at the last sample in rad.
    bent_rad: Vec<f64>,
    /// Rate of the reference at each sample in rad/s; the damping of a loop turns with it.
    turning_rad_s: Vec<f64>,
}

/// The motion of bent links.
#[derive(Debug, Clone)]
pub(super) struct BentMotion {
    pub(super) play: BentPlay,
    pub(super) joints: Vec<JointMotion>,
    /// Motion of the tip along the arc of one link, or along x and y.
    pub(super) tip: Vec<TipMotionHistories>,
}

impl BentMotion {
    /// The motion before its first sample, with the holding torques; displacements of one link count from a direction
    /// in rad.
    pub(super) fn empty(
        linkage: &Linkage,
        from_rad: f64,
        (steps, samples): (usize, usize),
        holding_n_m: impl Iterator<Item = Option<f64>>,
    ) -> Self {
        let (links, column) = (linkage.links.len(), || Vec::with_capacity(samples));
        let joint = |holding_n_m| JointMotion {
            torque_n_m: column(),
            net_n_m: None,
            angle_rad: column(),
            rate_rad_s: column(),
            acceleration_rad_s2: column(),
            holding_n_m,
        };
        let axis = || TipMotionHistories {
            displacement_m: column(),
            velocity_m_s: column(),
            acceleration_m_s2: column(),
        };
        let integrals = if links > 1 { vec![0.0] } else { Vec::new() };
        let play = BentPlay {
            angles: linkage.count,
            steps,
            chords_rad: vec![column(); links],
            kinetic_j: column(),
            potential_j: column(),
            work_j: integrals.clone(),
            lost_j: integrals,
            change: [f64::INFINITY; 2],
            is_unsettled: true,
            linkage: linkage.clone(),
            record: Record::with_capacity(linkage.count, samples),
            from_rad,
            bent_rad: vec![0.0; links],
            turning_rad_s: column(),
        };
        let axes = if links > 1 { vec![axis(), axis()] } else { vec![axis()] };
        Self { play, joints: holding_n_m.map(joint).collect(), tip: axes }
    }

    /// Adds a motion at a sample, with the torque of each joint in N m and the rate of the damping's rotation in rad/s.
    pub(super) fn observe(&mut self, motion: &Motion, torques_n_m: Vec<f64>, turning_rad_s: f64) {
        let Motion { q, rates, accelerations } = motion;
        let Self { play, joints, tip: axes } = self;
        let linkage = &play.linkage;
        for ((joint, torque_n_m), own) in linkage.joints.iter().zip(torques_n_m).zip(joints) {
            own.torque_n_m.push(torque_n_m);
            own.angle_rad.push(q[*joint]);
            own.rate_rad_s.push(rates[*joint]);
            own.acceleration_rad_s2.push(accelerations[*joint]);
        }
        let (ends, energies) = linkage.ends_and_energies(q, rates);
        // Follows each chord by its root and its last bend: the last sample may be more than half a turn away.
        let chords = linkage.chords_rad(q, &ends, &mut play.bent_rad);
        let fixed = Place::fixed(q.len());
        let tip = ends.last().unwrap_or(&fixed);
        let moving = tip.acceleration_m_s2(accelerations);
        let row = |axis: usize| [tip.at_m[axis], tip.rate_m_s[axis], moving[axis]];
        let rows = match chords[..] {
            [_] if linkage.links[0].slides() => {
                vec![[0, 1, 2].map(|k| linkage.links[0].across([row(0)[k], row(1)[k]]))]
            }
            [chord_rad] => {
                let length_m = linkage.length_m();
                let [rate, turning] = turning(row(0), row(1));
                vec![[length_m * (chord_rad - play.from_rad), length_m * rate, length_m * turning]]
            }
            _ => vec![row(0), row(1)],
        };
        for (axis, [at_m, rate_m_s, acceleration_m_s2]) in axes.iter_mut().zip(rows) {
            axis.displacement_m.push(at_m);
            axis.velocity_m_s.push(rate_m_s);
            axis.acceleration_m_s2.push(acceleration_m_s2);
        }
        play.chords_rad.iter_mut().zip(chords).for_each(|(column, own)| column.push(own));
        play.kinetic_j.push(energies.kinetic_j);
        play.potential_j.push(energies.potential_j);
        play.turning_rad_s.push(turning_rad_s);
        play.record.push(q, rates);
    }

    /// Largest distance in m of the tip from that of another motion, and largest difference of a joint's angle in rad; that
    /// of an arm's carriage is over its size.
    pub(super) fn change_from(&self, other: &Self) -> [f64; 2] {
        let far = (0..self.joints[0].angle_rad.len())
            .map(|k| apart_m(&self.tip, k, &other.tip, k))
            .fold(0.0, Size::larger);
        let joints = self.joints.iter().zip(&other.joints).enumerate();
        let turns = joints.flat_map(|(joint, (own, other))| {
            let size = self.play.linkage.size_of(joint);
            let pairs = own.angle_rad.iter().zip(&other.angle_rad);
            pairs.map(move |(a, b)| (a - b).abs() / size)
        });
        [far, turns.fold(0.0, Size::larger)]
    }

    /// Change by the last refinement over the motion, the larger one of the tip and of any joint. A change by round-off is 0.
    pub(super) fn changed(&self) -> f64 {
        let Self { play: BentPlay { linkage, change, .. }, tip, joints } = self;
        let moved = [largest_travel_m(tip), self.play.largest_turn_rad(joints)];
        let sizes = [linkage.length_m(), linkage.links[0].position_size()];
        let share = |k: usize| {
            let is_round_off = change[k] <= ROUND_OFF_RAD * sizes[k];
            if is_round_off { 0.0 } else { change[k] / moved[k] }
        };
        Size::larger(share(0), share(1))
    }
}

/// Rate in rad/s and acceleration in rad/s² of a place's direction, from place, rate and acceleration along both axes.
fn turning([x, vx, ax]: [f64; 3], [y, vy, ay]: [f64; 3]) -> [f64; 2] {
    let square = x * x + y * y;
    let rate = (x * vy - y * vx) / square;
    [rate, (x * ay - y * ax - 2.0 * (x * vx + y * vy) * rate) / square]
}

/// Distance in m of the tip at a sample from another tip at a sample.
fn apart_m(tip: &[TipMotionHistories], k: usize, other: &[TipMotionHistories], l: usize) -> f64 {
    let parts = tip.iter().zip(other).map(|(a, b)| a.displacement_m[k] - b.displacement_m[l]);
    distance_m(&parts.collect::<Vec<f64>>())
}

/// Length in m of a displacement along the arc of one link, or of x and y.
pub(super) fn distance_m(parts_m: &[f64]) -> f64 {
    match parts_m {
        [along_m] => along_m.abs(),
        parts_m => parts_m.iter().map(|part| part * part).sum::<f64>().sqrt(),
    }
}

/// Largest distance of the tip from its start in m.
pub(super) fn largest_travel_m(tip: &[TipMotionHistories]) -> f64 {
    let samples = tip.first().map_or(0, |axis| axis.displacement_m.len());
    (0..samples).map(|k| apart_m(tip, k, tip, 0)).fold(0.0, Size::larger)
}

impl BentPlay {
    /// Largest turn of a joint from its start in rad; the travel of an arm's carriage is over its size.
    pub(super) fn largest_turn_rad(&self, joints: &[JointMotion]) -> f64 {
        let turns = joints.iter().enumerate().flat_map(|(number, joint)| {
            let size = self.linkage.size_of(number);
            let turned = move |angle_rad: &f64| (angle_rad - joint.angle_rad[0]).abs() / size;
            joint.angle_rad.iter().map(turned)
        });
        turns.fold(0.0, Size::larger)
    }

    /// Place and motion of the links at a sample.
    pub(super) fn state(&self, grid: &TimeGrid, sample: usize) -> State {
        let (q, rates) = self.record.at(sample);
        self.linkage.state(grid.time_s(sample), q, rates)
    }

    /// Largest imbalance of energy over the largest work, kinetic energy or change of all energy; 0 for an arm at rest.
    pub fn imbalance(&self) -> f64 {
        let energies_j: Vec<f64> =
            self.kinetic_j.iter().zip(&self.potential_j).map(|(a, b)| a + b).collect();
        // A change below this share of all energy is round-off.
        let held_j = energies_j.iter().map(|own| own.abs()).fold(0.0, f64::max);
        let (mut missing, mut size) = (0.0, ROUND_OFF * held_j);
        for (sample, (work_j, lost_j)) in self.work_j.iter().zip(&self.lost_j).enumerate() {
            let held_j = energies_j[sample] - energies_j[0];
            missing = Size::larger(missing, (work_j - held_j - lost_j).abs());
            let most = held_j.abs().max(work_j.abs()).max(self.kinetic_j[sample]);
            size = Size::larger(size, most);
        }
        if size == 0.0 { 0.0 } else { missing / size }
    }

    /// x and y in m of places on each link, every `every`-th sample. `along_m` has their distances in m from the joint
    /// of each link.
    pub(super) fn positions_m(
        &self,
        along_m: &[Vec<f64>],
        every: NonZeroUsize,
    ) -> Vec<Vec<Vec<Vec<f64>>>> {
        let stations = self.linkage.stations(along_m);
        let columns = |own: &Vec<f64>| own.iter().map(|_| vec![Vec::new(); 2]).collect();
        let mut positions: Vec<Vec<Vec<Vec<f64>>>> = along_m.iter().map(columns).collect();
        for sample in (0..self.kinetic_j.len()).step_by(every.get()) {
            let places = self.linkage.places_m(&stations, self.record.at(sample).0);
            for (columns, place) in positions.iter_mut().flatten().zip(places.iter().flatten()) {
                columns.iter_mut().zip(place).for_each(|(column, part)| column.push(*part));
            }
        }
        positions
    }

    /// Displacement in m, along the arc or across a link that slides, of places at distances along one link, at every
    /// `every`-th sample.
    pub(super) fn displacements_m(&self, along_m: &[f64], every: NonZeroUsize) -> Vec<Vec<f64>> {
        let chain = &self.linkage.links[0];
        let stations = chain.stations(along_m);
        let mut columns = vec![Vec::new(); along_m.len()];
        for sample in (0..self.kinetic_j.len()).step_by(every.get()) {
            let places = chain.places_m(&stations, self.record.at(sample).0);
            for ((column, at_m), s_m) in columns.iter_mut().zip(places).zip(along_m) {
                let chord_rad = self.chords_rad[0][sample];
                column.push(if chain.slides() {
                    chain.across(at_m)
                } else {
                    s_m * (direction(at_m, chord_rad) - self.from_rad)
                });
            }
        }
        columns
    }

    /// Deflection of one link's output from its tangent line at the joint in m.
    pub(super) fn tip_deflection_m(&self) -> Vec<f64> {
        let (link, rest) = (&self.linkage.links[0], vec![0.0; self.angles]);
        let deflection = |sample: usize| {
            let q = self.record.at(sample).0;
            let (root_rad, axis_m, at_m) =
                (link.root_rad(q), link.axis_m(q), link.output(q, &rest).at_m);
            let [x, y] = [0, 1].map(|part| at_m[part] - axis_m[part]);
            y * libm::cos(root_rad) - x * libm::sin(root_rad)
        };
        (0..self.kinetic_j.len()).map(deflection).collect()
    }

    /// Power that damping and friction dissipate at a sample in W.
    pub(super) fn loss_w(&self, sample: usize) -> f64 {
        self.linkage.lost_w(self.record.at(sample).1, self.turning_rad_s[sample])
    }
}
