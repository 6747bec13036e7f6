//! Numbers of an arm's solution that a person reads first, and the shortest path within limits.

use serde::Serialize;

use super::fit::{Fit, FitError, Trials};
use super::limits::{Exceeded, LimitedValue, Limits, Reached, all_kinds};
use super::metrics::{Acting, TIMING_LEVEL};
use crate::beam::MeshPlan;
use crate::inverse::{Analysis, ArmSolution, Resources, invert_arm};
use crate::link::Arm;
use crate::motion::{ArmPath, Curve, PathColumns, Profile};
use crate::numeric::{TimeGrid, extremes, largest};

/// Numbers of an arm's solution over the written window.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArmMetrics {
    /// Those of each joint and its link, the inner one first.
    pub joints: Vec<JointMetrics>,
}

/// Numbers of one joint, its link and its motor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct JointMetrics {
    /// Largest |T| in N m.
    pub peak_torque_n_m: f64,
    /// Root mean square of T in N m while it acts, see [`Metrics::rms_torque_n_m`](super::Metrics::rms_torque_n_m).
    pub rms_torque_n_m: f64,
    /// Largest |T| of the rigid arm in N m.
    pub peak_rigid_torque_n_m: f64,
    /// How long before the path's first motion T first acts, in s; negative where it does so only afterwards.
    pub lead_s: f64,
    /// How long after the path's last motion T last acts, in s, likewise.
    pub lag_s: f64,
    /// Angle of the joint at the beginning and at the end in rad.
    pub start_angle_rad: f64,
    /// At the end.
    pub end_angle_rad: f64,
    /// Largest rate of the joint in rad/s.
    pub peak_rate_rad_s: f64,
    /// Largest mechanical power |T φ̇| in W.
    pub peak_power_w: f64,
    /// Largest deflection in m of the link's tip from its root's tangent line.
    pub peak_deflection_m: f64,
    /// Largest bending moment at the link's root in N m.
    pub peak_root_moment_n_m: f64,
    /// Largest torque of the motor in N m, where there is one.
    pub peak_motor_torque_n_m: Option<f64>,
    /// Root mean square of the motor's torque in N m while it acts.
    pub rms_motor_torque_n_m: Option<f64>,
    /// Largest rate of the rotor in rad/s.
    pub peak_motor_rate_rad_s: Option<f64>,
    /// Largest mechanical power of the motor in W.
    pub peak_motor_power_w: Option<f64>,
}

impl ArmMetrics {
    /// Reads the numbers off a solution.
    pub fn of(solution: &ArmSolution) -> Self {
        let (grid, path) = (&solution.grid, &solution.path);
        let (first, last) = path.moving_samples();
        let moves_s = [first, last].map(|sample| path.grid().time_s(sample));
        let joints = 0..solution.joints.len();
        Self {
            joints: joints
                .map(|joint| JointMetrics::of(solution, joint, (grid, moves_s)))
                .collect(),
        }
    }

    /// The limits of each joint that a solution exceeds, with the number of the joint.
    pub fn exceeded(&self, limits: &[Limits]) -> Vec<(usize, Exceeded)> {
        let values = self.limited(limits).into_iter();
        let exceeded = values.filter(|(_, value)| value.found > value.limit);
        exceeded.map(|(joint, value)| (joint, Exceeded(value))).collect()
    }

    /// How near a solution comes to each limit, with the number of the joint.
    pub fn reached(&self, solution: &ArmSolution, limits: &[Limits]) -> Vec<(usize, Reached)> {
        let joints = self.joints.iter().zip(limits).enumerate();
        let of = |(number, (joint, limits)): (usize, (&JointMetrics, &Limits))| {
            let reached = limits.reached_by(joint.limited(), joint.errors(solution, number));
            reached.into_iter().map(move |reached| (number, reached))
        };
        joints.flat_map(of).collect()
    }

    /// The values of each joint that have a limit, with the number of the joint.
    pub fn limited(&self, limits: &[Limits]) -> Vec<(usize, LimitedValue)> {
        let joints = self.joints.iter().zip(limits).enumerate();
        let of = |(number, (joint, limits)): (usize, (&JointMetrics, &Limits))| {
            let values = limits.limited_of(joint.limited());
            values.into_iter().map(move |value| (number, value))
        };
        joints.flat_map(of).collect()
    }
}

impl JointMetrics {
    fn of(
        solution: &ArmSolution,
        joint: usize,
        (grid, [first_s, last_s]): (&TimeGrid, [f64; 2]),
    ) -> Self {
        let (own, link) = (&solution.joints[joint], &solution.links[joint]);
        let [angle, rate, _] = &own.angle;
        let power = own.torque_n_m.iter().zip(rate).map(|(t, rate)| t * rate);
        let acts = |torque: &[f64]| Acting::beyond_level(torque, TIMING_LEVEL);
        let acting = acts(&own.torque_n_m);
        // The tip is on the chord: seen from the root's tangent line it deflects by the chord times the root's slope.
        let deflection = (0..grid.len)
            .map(|k| link.chord_length_m[k] * libm::sin(link.chord[0][k] - link.root_rad[k]));
        let motor = own.motor.as_ref();
        Self {
            peak_torque_n_m: largest(&own.torque_n_m),
            rms_torque_n_m: acting.rms(&own.torque_n_m),
            peak_rigid_torque_n_m: largest(&own.rigid_torque_n_m),
            lead_s: first_s - acting.start_s(grid),
            lag_s: acting.end_s(grid) - last_s,
            start_angle_rad: angle[0],
            end_angle_rad: angle[grid.len - 1],
            peak_rate_rad_s: largest(rate),
            peak_power_w: largest(&power.collect::<Vec<_>>()),
            peak_deflection_m: largest(&deflection.collect::<Vec<_>>()),
            peak_root_moment_n_m: largest(&link.moments_n_m[0]),
            peak_motor_torque_n_m: motor.map(|motor| largest(&motor.torque_n_m)),
            rms_motor_torque_n_m: motor.map(|motor| acts(&motor.torque_n_m).rms(&motor.torque_n_m)),
            peak_motor_rate_rad_s: motor.map(|motor| largest(&motor.rate_rad_s)),
            peak_motor_power_w: motor.map(|motor| largest(&motor.power_w)),
        }
    }

    /// The values that can have a limit, in the order of the link file.
    fn limited(&self) -> [f64; 10] {
        let motor = |value: Option<f64>| value.unwrap_or(f64::INFINITY);
        [
            self.peak_torque_n_m,
            self.rms_torque_n_m,
            self.peak_rate_rad_s,
            self.peak_power_w,
            self.peak_deflection_m,
            self.peak_root_moment_n_m,
            motor(self.peak_motor_torque_n_m),
            motor(self.rms_motor_torque_n_m),
            motor(self.peak_motor_rate_rad_s),
            motor(self.peak_motor_power_w),
        ]
    }

    /// Measured error of each of these values, relative to it, as of one link.
    fn errors(&self, solution: &ArmSolution, joint: usize) -> [f64; 10] {
        let own = &solution.joints[joint];
        let errors = solution.errors[joint];
        let errors = errors.zip(&errors, |own, _| all_kinds(own));
        let has_weight = solution.arm.has_weight();
        // With gravity errors are shares of ranges.
        let off = |error: f64, history: &[f64]| {
            let [low, high] = extremes(history);
            error * if has_weight { high - low } else { largest(history) }
        };
        let of_motor = |error: Option<f64>, history: Option<&Vec<f64>>| {
            error.zip(history).map_or(0.0, |(error, history)| off(error, history))
        };
        let motor = own.motor.as_ref();
        let torque_n_m = off(errors.torque, &own.torque_n_m);
        let rate_rad_s = off(errors.hub_rate, &own.angle[1]);
        let angle_rad = off(errors.hub_angle, &own.angle[0]);
        let motor_torque_n_m = of_motor(errors.motor_torque, motor.map(|own| &own.torque_n_m));
        let motor_rate_rad_s = of_motor(errors.motor_rate, motor.map(|own| &own.rate_rad_s));
        let motor_peaks = [self.peak_motor_torque_n_m, self.peak_motor_rate_rad_s];
        let [motor_peak_n_m, motor_peak_rad_s] = motor_peaks.map(Option::unwrap_or_default);
        let off = [
            torque_n_m,
            torque_n_m,
            rate_rad_s,
            torque_n_m * self.peak_rate_rad_s + rate_rad_s * self.peak_torque_n_m,
            angle_rad * solution.arm.links()[joint].link.length_m(),
            torque_n_m,
            motor_torque_n_m,
            motor_torque_n_m,
            motor_rate_rad_s,
            motor_torque_n_m * motor_peak_rad_s + motor_rate_rad_s * motor_peak_n_m,
        ];
        let found = self.limited();
        std::array::from_fn(|k| if off[k] == 0.0 { 0.0 } else { (off[k] / found[k]).min(f64::MAX) })
    }
}

/// The path of an arm's tip with all given but its duration, with the arm and its limits.
#[derive(Debug, Clone, Copy)]
pub struct ArmFitProblem<'a> {
    /// The arm.
    pub arm: &'a Arm,
    /// How each link is meshed.
    pub plans: &'a [MeshPlan],
    /// How exact the answers must be.
    pub analysis: &'a Analysis,
    /// Memory in bytes that each trial may take; `None`: no limit.
    pub memory_bytes: Option<usize>,
    /// Largest values that each joint, its link and its motor may reach.
    pub limits: &'a [Limits],
    /// Where the tip goes.
    pub curve: &'a Curve,
    /// How it goes along the curve.
    pub profile: Profile,
    /// Step of the path in s.
    pub step_s: f64,
    /// Constant directions in rad of the links from the third on.
    pub outer_rad: &'a [f64],
}

/// The fewest steps of a path within the limits of all joints, found as [`shortest_fit`](super::shortest_fit) does.
///
/// # Errors
/// [`FitError`] where no duration fits.
pub fn shortest_arm_fit(problem: &ArmFitProblem) -> Result<Fit<ArmSolution>, FitError> {
    problem.shortest()
}

impl Trials for ArmFitProblem<'_> {
    type Solution = ArmSolution;

    /// An arm that exceeds its limits in a motion as slow as that does so by its weight.
    const MOST_STEPS: usize = 1 << 14;

    fn step_s(&self) -> f64 {
        self.step_s
    }

    fn tried(&self, steps: usize) -> Result<Option<Fit<ArmSolution>>, FitError> {
        let places = self.curve.sampled(self.profile, steps, [0, 0])?;
        let columns = PathColumns::of_tip(self.step_s, &places, self.outer_rad);
        let path = ArmPath::new(columns, &self.arm.lengths_m())?;
        let resources = Resources { memory_bytes: self.memory_bytes, ..Resources::default() };
        let solution = invert_arm(self.arm, self.plans, &path, self.analysis, &resources)?;
        for (joint, (own, limits)) in solution.joints.iter().zip(self.limits).enumerate() {
            let ends = own.torque_n_m.first().into_iter().chain(own.torque_n_m.last());
            let held_n_m = ends.fold(0.0, |most: f64, torque| most.max(torque.abs()));
            if let Some(limit_n_m) = limits.torque_n_m.filter(|limit| held_n_m > *limit) {
                return Err(FitError::TooHeavyArm { joint, limit_n_m, held_n_m });
            }
        }
        let reached = ArmMetrics::of(&solution).reached(&solution, self.limits).into_iter();
        let binding = reached.max_by(|a, b| a.1.share().total_cmp(&b.1.share()));
        let (joint, binding) = binding.unzip();
        Ok(Fit::within(steps, solution, (joint, binding)))
    }
}
