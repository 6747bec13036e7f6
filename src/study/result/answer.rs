//! A solution as its metrics, limits and remarks read it: one list of joints, of a link or of an arm.

use super::peak::Peaks;
use crate::inverse::{ArmSolution, MotorHistories, PerQuantity, QuantityErrors, Solution, size};
use crate::motion::Ends;
use crate::numeric::TimeGrid;

/// A history that is computed on request.
type Computed<'a> = Box<dyn Fn() -> Vec<f64> + 'a>;

/// The histories of a solution, joint by joint. `From` makes it of a solution of a link or of an arm.
pub struct Answer<'a> {
    pub(super) grid: &'a TimeGrid,
    pub(super) ends: Ends,
    /// Steps in a period of the highest frequency; none where all frequencies of the samples are solved.
    per_cycle: Option<f64>,
    /// Times in s between which the tip moves.
    pub(super) moving_s: [f64; 2],
    /// With gravity, errors are shares of ranges.
    pub(super) has_weight: bool,
    pub(super) joints: Vec<AnsweredJoint<'a>>,
    /// Speed of the tip in m/s, or the magnitude of its acceleration in m/s², with its sign for one link.
    pub(super) tip: Box<dyn Fn(usize) -> Vec<f64> + 'a>,
}

/// The histories of a joint, its link and its motor.
pub(super) struct AnsweredJoint<'a> {
    /// Number of the joint of an arm, from 0.
    pub(super) number: Option<usize>,
    pub(super) torque_n_m: &'a [f64],
    pub(super) rigid_torque_n_m: &'a [f64],
    /// While the tip moves, if it moves on beyond its ends.
    pub(super) angle_rad: &'a [f64],
    pub(super) rate_rad_s: &'a [f64],
    pub(super) root_moment_n_m: &'a [f64],
    /// Deflection of the link's tip from the hub's tangent line.
    pub(super) deflection_m: Computed<'a>,
    pub(super) length_m: f64,
    pub(super) motor: Option<&'a MotorHistories>,
    pub(super) errors: PerQuantity<QuantityErrors>,
}

impl Answer<'_> {
    pub(super) fn peaks(&self) -> Peaks<'_> {
        Peaks { grid: self.grid, per_cycle: self.per_cycle }
    }

    /// The peak of a history, with gravity its range.
    pub(super) fn size_of(&self, history: &[f64]) -> f64 {
        size(history, self.has_weight)
    }
}

impl<'a> From<&'a Solution> for Answer<'a> {
    fn from(solution: &'a Solution) -> Self {
        let Solution { grid, band, motion, tip, .. } = solution;
        let (first, last) = solution.moving;
        // Of a tip that moves before its motion and after it, the hub turns on as long as it is looked at.
        let angle_rad = match motion.ends() {
            Ends::Moving => &solution.hub_angle_rad[first..=last],
            _ => &solution.hub_angle_rad[..],
        };
        let hub = AnsweredJoint {
            number: None,
            torque_n_m: &solution.torque_n_m,
            rigid_torque_n_m: &solution.rigid_torque_n_m,
            angle_rad,
            rate_rad_s: &solution.hub_rate_rad_s,
            root_moment_n_m: &solution.root_moment_n_m,
            deflection_m: Box::new(|| solution.tip_deflection_m()),
            length_m: solution.mesh().length_m(),
            motor: solution.motor.as_ref(),
            errors: solution.accuracy.errors,
        };
        Self {
            grid,
            ends: motion.ends(),
            per_cycle: band.cutoff_hz.map(|_| 1.0 / (band.highest_hz * grid.step_s)),
            moving_s: [first, last].map(|sample| grid.time_s(sample)),
            has_weight: solution.link().has_weight(),
            joints: vec![hub],
            tip: Box::new(|order| [&tip.velocity_m_s, &tip.acceleration_m_s2][order].clone()),
        }
    }
}

impl<'a> From<&'a ArmSolution> for Answer<'a> {
    fn from(solution: &'a ArmSolution) -> Self {
        let ArmSolution { arm, grid, path, tip, .. } = solution;
        let (first, last) = path.moving_samples();
        let pairs = solution.joints.iter().zip(&solution.links).enumerate();
        let joints = pairs.map(|(number, (joint, link))| AnsweredJoint {
            number: Some(number),
            torque_n_m: &joint.torque_n_m,
            rigid_torque_n_m: &joint.rigid_torque_n_m,
            angle_rad: &joint.angle[0],
            rate_rad_s: &joint.angle[1],
            root_moment_n_m: &link.moments_n_m[0],
            // The link's tip is on the chord: it deflects by the chord times the root's slope.
            deflection_m: Box::new(|| {
                let slopes = link.chord[0].iter().zip(&link.root_rad).map(|(own, root)| own - root);
                let chords = link.chord_length_m.iter();
                chords.zip(slopes).map(|(length, slope)| length * libm::sin(slope)).collect()
            }),
            length_m: arm.links()[number].link.length_m(),
            motor: joint.motor.as_ref(),
            errors: solution.errors[number],
        });
        Self {
            grid,
            ends: Ends::AtRest,
            // The roll-off and the turning links bring frequencies above the path's; they are small above twice its cut-off.
            per_cycle: solution.cutoff_hz.map(|cutoff_hz| 0.5 / (cutoff_hz * grid.step_s)),
            moving_s: [first, last].map(|sample| path.grid().time_s(sample)),
            has_weight: arm.has_weight(),
            joints: joints.collect(),
            tip: Box::new(|order| {
                let [x, y] = [&tip[0][order + 1], &tip[1][order + 1]];
                x.iter().zip(y).map(|(x, y)| libm::hypot(*x, *y)).collect()
            }),
        }
    }
}
