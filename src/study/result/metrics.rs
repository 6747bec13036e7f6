//! Numbers of a solution and of a simulation that a person reads first.

use super::peak::{Peak, Peaks};
use crate::inverse::{MotorHistories, Solution};
use crate::link::{Arm, Drive};
use crate::motion::{Ends, TipMotionHistories};
use crate::numeric::{TimeGrid, dot, extremes, largest};
use crate::response::{JointMotion, Played};

/// Share of the peak torque that counts as acting: the level of the paper's 0.3 s.
pub const TIMING_LEVEL: f64 = 0.02;

/// Numbers of a solution that a person reads first, over the written window.
///
/// Peaks are those of the motion, not of its samples: they do not change with the step.
#[derive(Debug, Clone, PartialEq)]
pub struct Metrics {
    /// Numbers of each joint, its link and its motor, the inner one first. One link has one, its hub.
    pub joints: Vec<JointMetrics>,
    /// Largest tip velocity in m/s.
    pub peak_tip_velocity_m_s: Peak,
    /// Largest tip acceleration in m/s².
    pub peak_tip_acceleration_m_s2: Peak,
}

/// Numbers of one joint, its link and its motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMetrics {
    /// Number of the joint of an arm, from 0; its carriage comes last.
    pub joint: Option<usize>,
    /// Largest |T| in N m.
    pub peak_torque_n_m: Peak,
    /// Root mean square of T in N m while it acts: from the first to the last |T| above 2 % of its peak, so that the
    /// rest around the motion does not count. With gravity T acts while it differs from the holding torque at rest by
    /// more than 2 % of its range. A periodic torque always acts.
    pub rms_torque_n_m: f64,
    /// Largest |T| of the rigid link or arm in N m.
    pub peak_rigid_torque_n_m: Peak,
    /// Peak torque over that of the rigid link or arm.
    pub torque_ratio: f64,
    /// Time in s from T's first action to the tip's first motion, interpolated between samples; negative if T acts
    /// later. `None` for a periodic motion.
    pub lead_s: Option<f64>,
    /// Time in s from the tip's last motion to T's last action, likewise.
    pub lag_s: Option<f64>,
    /// Angle at the beginning and at the end of the window in rad.
    pub end_angles_rad: [f64; 2],
    /// Largest |θ − θ(start)| in rad; of a periodic motion the range of θ.
    pub peak_hub_angle_rad: Peak,
    /// Largest rate of the joint in rad/s.
    pub peak_hub_rate_rad_s: Peak,
    /// Largest acceleration of the joint in rad/s².
    pub peak_hub_acceleration_rad_s2: Peak,
    /// Largest mechanical power |T θ̇| in W.
    pub peak_power_w: Peak,
    /// Root mean square of T θ̇ in W over the samples while T acts.
    pub rms_power_w: f64,
    /// Largest moment of the hub on the link's root in N m; absent for the carriage of an arm, which has no link.
    pub peak_root_moment_n_m: Option<Peak>,
    /// Largest deflection of the link's tip from the hub's tangent line in m.
    pub peak_deflection_m: Option<Peak>,
    /// With an output inboard of the tip, largest distance of the tip in m from its place on a rigid link.
    pub peak_free_end_from_rigid_m: Option<Peak>,
    /// Values of the motor; absent without a drive.
    pub motor: Option<MotorMetrics>,
}

/// Numbers of the motor, on its own side of the gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorMetrics {
    /// Its peaks.
    pub peaks: MotorPeaks,
    /// Root mean square of the motor's torque in N m while it acts: from the first to the last one
    /// above 2 % of its peak.
    pub rms_torque_n_m: f64,
}

/// Peaks of the motor, on its own side of the gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorPeaks {
    /// Largest torque of the motor in N m.
    pub peak_torque_n_m: Peak,
    /// Largest rate of the rotor in rad/s.
    pub peak_rate_rad_s: Peak,
    /// Largest mechanical power of the motor in W.
    pub peak_power_w: Peak,
    /// Largest current in A, if the drive has its torque constant.
    pub peak_current_a: Option<Peak>,
    /// Largest voltage in V, if the drive has its resistance, too.
    pub peak_voltage_v: Option<Peak>,
}

impl Metrics {
    /// Reads the numbers off a solution.
    pub fn of(solution: &Solution) -> Self {
        let peaks = Peaks::in_solution(solution);
        // In the plane the magnitude counts.
        let peak = |of: fn(&TipMotionHistories) -> &[f64]| match &solution.tip[..] {
            [x, y] => {
                let pairs = of(x).iter().zip(of(y));
                peaks.of(&pairs.map(|(x, y)| libm::hypot(*x, *y)).collect::<Vec<_>>())
            }
            along => peaks.of(of(&along[0])),
        };
        let joints = 0..solution.joints.len();
        Self {
            joints: joints.map(|number| JointMetrics::of(solution, number)).collect(),
            peak_tip_velocity_m_s: peak(|tip| &tip.velocity_m_s),
            peak_tip_acceleration_m_s2: peak(|tip| &tip.acceleration_m_s2),
        }
    }

    /// The numbers of the hub: of the first joint.
    pub fn hub(&self) -> &JointMetrics {
        &self.joints[0]
    }
}

impl JointMetrics {
    fn of(solution: &Solution, number: usize) -> Self {
        let (grid, peaks) = (&solution.grid, Peaks::in_solution(solution));
        let (joint, link) = (&solution.joints[number], solution.links.get(number));
        let (torque, angle) = (&joint.torque_n_m[..], solution.followed_rad(number));
        let peak_torque_n_m = peaks.of(torque);
        let peak_rigid_torque_n_m = peaks.of(&joint.rigid_torque_n_m);
        let is_cycle = solution.motion.ends() == Ends::Periodic;
        let turned = |from_rad: f64| {
            peaks.of(&angle.iter().map(|angle| angle - from_rad).collect::<Vec<_>>())
        };
        let mut peak_hub_angle_rad = turned(angle[0]);
        if is_cycle {
            // A cycle begins anywhere: its hub turns by the range of the angle, whose ends lie between samples.
            let [low, high] = extremes(angle);
            peak_hub_angle_rad = turned(low);
            peak_hub_angle_rad.value += turned(high).value - (high - low);
        }
        let timed = |time_s: f64| (!is_cycle).then_some(time_s);
        let (first, last) = solution.moving;
        let acts =
            |torque: &[f64], peak| Acting::in_solution(solution, (torque, peak), TIMING_LEVEL);
        let acting = acts(torque, peak_torque_n_m);
        let power_w: Vec<f64> =
            torque.iter().zip(&joint.rate_rad_s).map(|(torque, rate)| torque * rate).collect();
        Self {
            joint: solution.arm.number_of(number),
            peak_torque_n_m,
            rms_torque_n_m: acting.rms(torque),
            peak_rigid_torque_n_m,
            torque_ratio: peak_torque_n_m.value / peak_rigid_torque_n_m.value,
            lead_s: timed(grid.time_s(first) - acting.start_s(grid)),
            lag_s: timed(acting.end_s(grid) - grid.time_s(last)),
            end_angles_rad: [angle[0], angle[angle.len() - 1]],
            peak_hub_angle_rad,
            peak_hub_rate_rad_s: peaks.of(&joint.rate_rad_s),
            peak_hub_acceleration_rad_s2: peaks.of(&solution.acceleration_rad_s2(number)),
            peak_power_w: peaks.of_product(torque, &joint.rate_rad_s),
            rms_power_w: acting.rms(&power_w),
            peak_root_moment_n_m: link.map(|link| peaks.of(&link.root_moment_n_m)),
            peak_deflection_m: link.map(|_| peaks.of(&solution.tip_deflection_m(number))),
            peak_free_end_from_rigid_m: solution.tip_from_rigid_m().map(|apart| peaks.of(&apart)),
            motor: joint.motor.as_ref().map(|motor| MotorMetrics::of(motor, &peaks, acts)),
        }
    }
}

/// Numbers of a simulation that a person reads first.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayedMetrics {
    /// Numbers of each joint, the inner one first. One link has one, its hub.
    pub joints: Vec<PlayedJoint>,
    /// Largest distance of the tip from its start in m.
    pub farthest_m: f64,
    /// Displacement of the tip at the last sample less the first, in m; for an arm the distance of the two places.
    pub travel_m: f64,
    /// Velocity of the tip at the last sample in m/s; of an arm its speed.
    pub final_tip_velocity_m_s: f64,
    /// x and y of an arm's tip at the last sample in m.
    pub final_tip_m: Option<[f64; 2]>,
}

/// Numbers of one joint in a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlayedJoint {
    /// Number of the joint of an arm, from 0.
    pub joint: Option<usize>,
    /// Largest torque of the motor in N m, feedback included.
    pub peak_torque_n_m: Peak,
    /// Torque in N m that holds bent links at the start.
    pub holding_torque_n_m: Option<f64>,
    /// Angle at the first sample and at the last in rad.
    pub end_angles_rad: [f64; 2],
    /// Largest |θ − θ(start)| in rad.
    pub peak_hub_angle_rad: Peak,
    /// Largest rate of the joint in rad/s.
    pub peak_hub_rate_rad_s: Peak,
    /// Largest acceleration of the joint in rad/s².
    pub peak_hub_acceleration_rad_s2: Peak,
    /// Largest mechanical power |T θ̇| of the motor in W.
    pub peak_power_w: Peak,
    /// Largest deflection of the tip of one link from the hub's tangent line in m.
    pub peak_deflection_m: Option<Peak>,
    /// Peaks of the motor; absent without a drive, and behind an elastic joint, whose rotor a simulation does not move.
    pub motor: Option<MotorPeaks>,
}

impl PlayedMetrics {
    /// Reads the numbers off a simulation of a link or an arm.
    pub fn of(played: &Played, arm: &Arm) -> Self {
        let (tip, last) = (&played.tip, played.grid.len - 1);
        let drives = arm.links().iter().map(|own| own.link.drive()).chain(std::iter::repeat(None));
        let joints = played.joints.iter().zip(drives);
        let joints = joints.map(|(joint, drive)| PlayedJoint::of(&played.grid, joint, drive));
        let mut joints: Vec<PlayedJoint> = joints.collect();
        match &mut joints[..] {
            [hub] => {
                let peaks = Peaks { grid: &played.grid, per_cycle: None };
                hub.peak_deflection_m = Some(peaks.of(&played.tip_deflection_m()));
            }
            joints => (0..).zip(joints).for_each(|(number, own)| own.joint = Some(number)),
        }
        let at = |axis: &TipMotionHistories| axis.displacement_m[last];
        let moved = tip.iter().map(|axis| at(axis) - axis.displacement_m[0]);
        let rate = tip.iter().map(|axis| axis.velocity_m_s[last]);
        Self {
            joints,
            farthest_m: played.largest_travel_m(),
            travel_m: along_or_apart(moved),
            final_tip_velocity_m_s: along_or_apart(rate),
            final_tip_m: match &tip[..] {
                [x, y] => Some([x, y].map(at)),
                _ => None,
            },
        }
    }

    /// The numbers of the hub: of the first joint.
    pub fn hub(&self) -> &PlayedJoint {
        &self.joints[0]
    }
}

/// A quantity of the tip: with its sign along the arc of one link, or its size along x and y.
fn along_or_apart(axes: impl Iterator<Item = f64>) -> f64 {
    axes.reduce(libm::hypot).unwrap_or_default()
}

impl PlayedJoint {
    fn of(grid: &TimeGrid, joint: &JointMotion, drive: Option<&Drive>) -> Self {
        let peaks = Peaks { grid, per_cycle: None };
        let drive = drive.filter(|drive| drive.joint_stiffness_n_m_rad.is_infinite());
        let motor = drive.map(|drive| {
            let rotor = [&joint.angle_rad, &joint.rate_rad_s, &joint.acceleration_rad_s2];
            let rotor = rotor.map(|own| own.iter().map(|x| drive.gear_ratio * x).collect());
            MotorHistories::of(drive, [&joint.torque_n_m, &joint.rate_rad_s], rotor)
        });
        let (torque, angle, rate) = (&joint.torque_n_m, &joint.angle_rad, &joint.rate_rad_s);
        let turned: Vec<f64> = angle.iter().map(|own| own - angle[0]).collect();
        Self {
            joint: None,
            peak_torque_n_m: peaks.of(torque),
            holding_torque_n_m: joint.holding_n_m,
            end_angles_rad: [angle[0], angle[angle.len() - 1]],
            peak_hub_angle_rad: peaks.of(&turned),
            peak_hub_rate_rad_s: peaks.of(rate),
            peak_hub_acceleration_rad_s2: peaks.of(&joint.acceleration_rad_s2),
            peak_power_w: peaks.of_product(torque, rate),
            peak_deflection_m: None,
            motor: motor.map(|motor| MotorPeaks::of(&motor, &peaks)),
        }
    }
}

/// Errors of lead and lag in s for a torque with an error of `share` of its peak or range. They are the changes of its
/// start and end if the level of `acting` has the same error.
pub(super) fn timing_errors_s(
    grid: &TimeGrid,
    share: f64,
    acting: impl Fn(f64) -> Acting,
) -> [f64; 2] {
    let ends = |level| {
        let acting = acting(level);
        [acting.start_s(grid), acting.end_s(grid)]
    };
    let told = ends(TIMING_LEVEL);
    let others = [TIMING_LEVEL + share, TIMING_LEVEL - share];
    let possible = others.into_iter().filter(|level| (0.0..1.0).contains(level));
    possible.map(ends).fold([0.0; 2], |worst, other| {
        [0, 1].map(|end| f64::max(worst[end], (other[end] - told[end]).abs()))
    })
}

/// Action of a torque: the samples beyond a level, and the parts of the steps around them beyond the level.
pub(super) struct Acting {
    /// The first sample beyond the level, and the last.
    pub(super) first: usize,
    pub(super) last: usize,
    /// Steps before the first sample, and after the last, 0 to 1.
    before: f64,
    after: f64,
}

impl Acting {
    /// Action of a torque of a solution with this peak, at a level as a share of the peak. With gravity, or against
    /// friction, the torque acts where it differs from its values at the ends.
    pub(super) fn in_solution(
        solution: &Solution,
        (torque, peak): (&[f64], Peak),
        level: f64,
    ) -> Self {
        match solution.motion.ends() {
            Ends::Periodic => Self { first: 0, last: torque.len() - 1, before: 0.0, after: 0.0 },
            Ends::AtRest if !solution.arm.has_weight() => Self::of(torque, level * peak.value),
            _ => Self::beyond_rest(torque, level * solution.size_of(torque)),
        }
    }

    fn of(torque: &[f64], level: f64) -> Self {
        let acts = |t: &f64| t.abs() > level;
        let first = torque.iter().position(acts).unwrap_or(0);
        let last = torque.iter().rposition(acts).unwrap_or(0);
        // The straight line between a sample beyond the level and its neighbour within.
        let share = |beyond: usize, within: Option<&f64>| {
            let crossed = level.copysign(torque[beyond]);
            let within = within.filter(|_| acts(&torque[beyond]));
            within.map_or(0.0, |within| (torque[beyond] - crossed) / (torque[beyond] - within))
        };
        Self {
            first,
            last,
            before: share(first, first.checked_sub(1).map(|k| &torque[k])),
            after: share(last, torque.get(last + 1)),
        }
    }

    /// Action of a torque that holds a link at rest at its first and last sample. It begins as the torque leaves the
    /// first value by more than the level, and ends as the torque comes as near to the last.
    pub(super) fn beyond_rest(torque: &[f64], level: f64) -> Self {
        let less = |rest: f64| torque.iter().map(|t| t - rest).collect::<Vec<f64>>();
        let (from_first, from_last) = (less(torque[0]), less(torque[torque.len() - 1]));
        let [begins, ends] = [Self::of(&from_first, level), Self::of(&from_last, level)];
        Self { last: ends.last.max(begins.first), after: ends.after, ..begins }
    }

    /// Root mean square of the torque from the first sample to the last.
    fn rms(&self, torque: &[f64]) -> f64 {
        let acting = &torque[self.first..=self.last];
        let mean = |values: &[f64]| dot(values, values) / values.len() as f64;
        match mean(acting) {
            square if square.is_finite() => square.sqrt(),
            // A square may exceed double precision.
            _ => {
                let size = largest(acting);
                size * mean(&acting.iter().map(|value| value / size).collect::<Vec<_>>()).sqrt()
            }
        }
    }

    pub(super) fn start_s(&self, grid: &TimeGrid) -> f64 {
        grid.time_s(self.first) - self.before * grid.step_s
    }

    pub(super) fn end_s(&self, grid: &TimeGrid) -> f64 {
        grid.time_s(self.last) + self.after * grid.step_s
    }
}

impl MotorMetrics {
    fn of(motor: &MotorHistories, peaks: &Peaks, acts: impl Fn(&[f64], Peak) -> Acting) -> Self {
        let (torque, peaks) = (&motor.torque_n_m[..], MotorPeaks::of(motor, peaks));
        Self { peaks, rms_torque_n_m: acts(torque, peaks.peak_torque_n_m).rms(torque) }
    }
}

impl MotorPeaks {
    fn of(motor: &MotorHistories, peaks: &Peaks) -> Self {
        let MotorHistories { torque_n_m: torque, rate_rad_s: rate, .. } = motor;
        // Losses change their sign within few samples: waves through these would swing beyond them.
        let per_cycle = peaks.per_cycle.filter(|_| !motor.has_losses());
        let (smooth, peaks) = (peaks, &Peaks { per_cycle, ..*peaks });
        Self {
            peak_torque_n_m: peaks.of(torque),
            peak_rate_rad_s: smooth.of(rate),
            peak_power_w: peaks.of_product(torque, rate),
            peak_current_a: motor.current_a.as_ref().map(|own| peaks.of(own)),
            peak_voltage_v: motor.voltage_v.as_ref().map(|own| peaks.of(own)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The times when a bell of either sign crosses 2 % of its peak, by samples at a step.
    fn crossings_s(sign: f64, step_s: f64, len: usize) -> [f64; 2] {
        let grid = TimeGrid { origin_s: -4.0, step_s, first: 0, len };
        let bell = |k| sign * (-grid.time_s(k) * grid.time_s(k)).exp();
        let torque: Vec<f64> = (0..len).map(bell).collect();
        let acting = Acting::of(&torque, TIMING_LEVEL);
        [acting.start_s(&grid), acting.end_s(&grid)]
    }

    #[test]
    fn lead_and_lag_are_exact_to_the_second_order_of_the_step() {
        // e^(-t²) = 0.02
        let exact_s = 50.0_f64.ln().sqrt();
        for sign in [1.0, -1.0] {
            for (step_s, len) in [(0.01, 800), (0.02, 400), (0.04, 200)] {
                let [from_s, until_s] = crossings_s(sign, step_s, len);
                // The straight line is off by h²/8 |f''/f'| = 0.43 h², and a sixth of that, as f''
                // changes over the longest step.
                let bound_s = 0.5 * step_s * step_s;
                assert!((from_s + exact_s).abs() < bound_s, "{from_s} at {step_s} s");
                assert!((until_s - exact_s).abs() < bound_s, "{until_s} at {step_s} s");
            }
        }
    }

    #[test]
    fn a_torque_that_acts_from_its_first_sample_to_its_last_is_not_extended() {
        let acting = Acting::of(&[1.0, -1.0, 1.0], TIMING_LEVEL);
        assert_eq!([acting.before, acting.after].map(f64::to_bits), [0; 2]);
        assert_eq!((acting.first, acting.last), (0, 2));
        let still = Acting::of(&[0.0, 0.0, 0.0], 0.0);
        assert_eq!([still.before, still.after].map(f64::to_bits), [0; 2]);
    }

    #[test]
    fn a_torque_acts_from_where_it_leaves_one_rest_until_it_is_near_the_other() {
        let torque = [1.0, 1.0, 1.5, 4.0, 3.5, 3.0, 3.0];
        let acting = Acting::beyond_rest(&torque, 0.25);
        assert_eq!((acting.first, acting.last), (2, 4));
        assert!((acting.before - 0.5).abs() < 1e-15 && (acting.after - 0.5).abs() < 1e-15);
        let falling = Acting::beyond_rest(&[3.0, 3.0, 1.0, 1.0], 0.5);
        assert_eq!((falling.first, falling.last), (2, 2), "it leaves one where it is at the other");
    }

    #[test]
    fn a_crossing_with_a_change_of_sign_is_that_of_the_sample_beyond_the_level() {
        let grid = TimeGrid { origin_s: 0.0, step_s: 1.0, first: 0, len: 3 };
        let acting = Acting::of(&[0.01, -0.03, 1.0], 0.02);
        assert!((acting.start_s(&grid) - 0.75).abs() < 1e-12, "{}", acting.start_s(&grid));
    }

    #[test]
    fn the_root_mean_square_of_a_sine_is_its_amplitude_over_root_two() {
        let sine: Vec<f64> =
            (0..1000).map(|k| (0.01 * std::f64::consts::TAU * f64::from(k)).sin()).collect();
        let whole = Acting { first: 0, last: 999, before: 0.0, after: 0.0 };
        assert!((whole.rms(&sine) - 0.5_f64.sqrt()).abs() < 1e-12);
    }
}
