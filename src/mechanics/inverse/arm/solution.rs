//! The torques of an arm, and all that goes with them, over the written window.

use std::sync::Arc;

use rayon::prelude::*;

use super::answer::{ArmAnswer, JointHistories};
use super::problem::Models;
use super::rigid::rigid_torques_n_m;
use super::warning::{ArmWarning, Straying};
use crate::elastica::{AngleHistories, Iteration, SecondOrder};
use crate::inverse::{Analysis, MotorHistories, PerQuantity, QuantityErrors};
use crate::link::Arm;
use crate::model::Model;
use crate::motion::ArmPath;
use crate::numeric::{Size, TimeGrid};

/// What an arm must do so that its tip follows its path.
#[derive(Debug, Clone)]
pub struct ArmSolution {
    /// The arm.
    pub arm: Arm,
    /// The path.
    pub path: ArmPath,
    /// How exactly it was solved.
    pub analysis: Analysis,
    /// The written window.
    pub grid: TimeGrid,
    /// The joints, the inner one first.
    pub joints: Vec<ArmJoint>,
    /// The links, the inner one first.
    pub links: Vec<ArmLinkShape>,
    /// x and y of the tip: place in m, velocity and acceleration.
    pub tip: [AngleHistories; 2],
    /// Largest distance of the tip from its start in m.
    pub way_m: f64,
    /// Largest distance of the solved tip from the wanted one over its way.
    pub tip_error: f64,
    /// What each quantity of each joint may be off by, over its range, or over its peak without weight.
    pub errors: Vec<PerQuantity<QuantityErrors>>,
    /// The slowest decay: the smallest of the links' first zeros in 1/s.
    pub first_zero_per_s: Option<f64>,
    /// The period in s, and the highest frequency in Hz that the path is solved for; none where all are.
    pub period_s: f64,
    /// That frequency.
    pub cutoff_hz: Option<f64>,
    /// What was found of the second order.
    pub findings: ArmFindings,
    /// What the user must know.
    pub warnings: Vec<ArmWarning>,
    pub(super) models: Vec<Arc<dyn Model>>,
}

/// One joint over the window.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmJoint {
    /// Torque in N m that turns its link, and the link before the other way.
    pub torque_n_m: Vec<f64>,
    /// That of the rigid arm.
    pub rigid_torque_n_m: Vec<f64>,
    /// Angle in rad of its link's root against the tip of the link before, of the first joint against x; rate and
    /// acceleration.
    pub angle: AngleHistories,
    /// That of the rigid arm.
    pub rigid_angle_rad: Vec<f64>,
    /// Force in N along x and y on its link's inner end.
    pub force_n: [Vec<f64>; 2],
    /// Its motor, where it has a drive.
    pub motor: Option<MotorHistories>,
}

/// One link over the window: a history for each node.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmLinkShape {
    /// Direction of its chord in rad, rate and acceleration.
    pub chord: AngleHistories,
    /// Length of its chord in m.
    pub chord_length_m: Vec<f64>,
    /// Direction of its root's tangent line in rad.
    pub root_rad: Vec<f64>,
    /// Distance of the nodes from the joint along the unbent link in m.
    pub nodes_m: Vec<f64>,
    /// x and y of the nodes in m.
    pub positions_m: Vec<[Vec<f64>; 2]>,
    /// Deflection of the nodes from the chord in m.
    pub deflections_m: Vec<Vec<f64>>,
    /// Bending moment at the nodes in N m.
    pub moments_n_m: Vec<Vec<f64>>,
    /// Largest slope |w'| of the link from its chord.
    pub largest_slope: f64,
}

/// What was found of the second order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmFindings {
    /// What was counted.
    pub order: SecondOrder,
    /// How it was found.
    pub iteration: Iteration,
    /// What the terms that were not counted change of a torque at most, over its range: none where all were counted, and
    /// none within where the motion is refused with all of them.
    pub left_out: Option<Option<f64>>,
    /// Where the iteration of all terms does not converge and fewer are counted instead: how far the tip strays for that;
    /// what was left out is then not looked for otherwise.
    pub fallback: Option<Straying>,
}

impl ArmSolution {
    /// Number of elements of each link.
    pub fn elements(&self) -> Vec<usize> {
        self.models.iter().map(|model| model.mesh().elements().len()).collect()
    }

    /// How far the tip is expected to be from where it should be, at most, over its way: what the solved one is off, or what
    /// fewer terms than all lead it off by where these do not converge.
    pub fn expected_tip_error(&self) -> f64 {
        let fallback = self.findings.fallback.map_or(0.0, Straying::share);
        Size::larger(self.tip_error, fallback)
    }

    /// The largest error of a kind, over all quantities of all joints.
    pub fn worst(&self, kind: impl Fn(&QuantityErrors) -> f64) -> f64 {
        let of_joint = |errors: &PerQuantity<QuantityErrors>| {
            errors.iter().map(|(_, own)| kind(&own)).fold(0.0, Size::larger)
        };
        self.errors.iter().map(of_joint).fold(0.0, Size::larger)
    }
}

/// The samples of a period that a window has.
fn cut(samples: &[f64], grid: &TimeGrid) -> Vec<f64> {
    let len = samples.len() as i64;
    let at = |k: usize| samples[(grid.first + k as i64).rem_euclid(len) as usize];
    (0..grid.len).map(at).collect()
}

fn cut_all<const N: usize>(histories: &[Vec<f64>; N], grid: &TimeGrid) -> [Vec<f64>; N] {
    histories.each_ref().map(|history| cut(history, grid))
}

impl ArmAnswer {
    /// The joints over a window.
    pub(super) fn joints(&self, arm: &Arm, grid: &TimeGrid) -> Vec<ArmJoint> {
        let rigid: Vec<AngleHistories> =
            self.path.rigid.iter().map(|chord| cut_all(chord, grid)).collect();
        let rigid_torques_n_m = rigid_torques_n_m(arm, &rigid);
        let of = |(joint, rigid_torque_n_m): (usize, Vec<f64>)| {
            let JointHistories { angle, motor } = self.joint(arm, joint);
            let link = &self.motion.links[joint];
            let before = joint.checked_sub(1).map(|before| &rigid[before][0]);
            let rigid_angle_rad = match before {
                None => rigid[joint][0].clone(),
                Some(before) => {
                    rigid[joint][0].iter().zip(before).map(|(own, before)| own - before).collect()
                }
            };
            ArmJoint {
                torque_n_m: cut(&link.bent.torque_n_m, grid),
                rigid_torque_n_m,
                angle: cut_all(&angle, grid),
                rigid_angle_rad,
                force_n: cut_all(&link.force_n, grid),
                motor: motor.map(|motor| MotorHistories {
                    torque_n_m: cut(&motor.torque_n_m, grid),
                    angle_rad: cut(&motor.angle_rad, grid),
                    rate_rad_s: cut(&motor.rate_rad_s, grid),
                    power_w: cut(&motor.power_w, grid),
                }),
            }
        };
        rigid_torques_n_m.into_par_iter().enumerate().map(of).collect()
    }

    /// The links over a window, and x and y of the tip with their derivatives.
    pub(super) fn links(
        &self,
        models: &Models,
        grid: &TimeGrid,
    ) -> (Vec<ArmLinkShape>, [AngleHistories; 2]) {
        let none = || [0, 1, 2].map(|_| vec![0.0; grid.len]);
        // Of the joint: place, velocity, acceleration.
        let mut axis = [none(), none()];
        let mut links = Vec::new();
        for (link, model) in self.motion.links.iter().zip(models) {
            let nodes_m = model.mesh().nodes_m().to_vec();
            let chord = cut_all(&link.chord, grid);
            let units: Vec<[f64; 2]> =
                chord[0].iter().map(|angle| [libm::cos(*angle), libm::sin(*angle)]).collect();
            let place = |node: usize| {
                let w = cut(&link.bent.deflections[2 * node], grid);
                let u = cut(&link.bent.shortenings_m[node], grid);
                let at = |k: usize| {
                    let ([cosine, sine], x, w) = (units[k], nodes_m[node] + u[k], w[k]);
                    [x * cosine - w * sine, x * sine + w * cosine]
                };
                [0, 1].map(|part| {
                    (0..grid.len).map(|k| axis[part][0][k] + at(k)[part]).collect::<Vec<f64>>()
                })
            };
            let positions_m = (0..nodes_m.len()).into_par_iter().map(place).collect();
            let deflections = link.bent.deflections.par_iter().step_by(2);
            let deflections_m = deflections.map(|history| cut(history, grid)).collect();
            let moments = link.bent.moments_n_m.par_iter();
            let moments_n_m = moments.map(|history| cut(history, grid)).collect();
            let length =
                [0, 1, 2].map(|order| cut(&self.derivative(&link.chord_length_m, order), grid));
            for k in 0..grid.len {
                let ([cosine, sine], [l, l1, l2]) =
                    (units[k], [0, 1, 2].map(|n: usize| length[n][k]));
                let [rate, turning] = [chord[1][k], chord[2][k]];
                let parts = [
                    [l, 0.0],
                    [l1, l * rate],
                    [l2 - l * rate * rate, 2.0 * l1 * rate + l * turning],
                ];
                for (order, [along, across]) in parts.into_iter().enumerate() {
                    axis[0][order][k] += along * cosine - across * sine;
                    axis[1][order][k] += along * sine + across * cosine;
                }
            }
            let [chord_length_m, ..] = length;
            let largest_slope = link.bent.largest_slope;
            links.push(ArmLinkShape {
                root_rad: cut(&link.bent.hub_slope_rad, grid)
                    .iter()
                    .zip(&chord[0])
                    .map(|(slope, chord)| slope + chord)
                    .collect(),
                chord,
                chord_length_m,
                nodes_m,
                positions_m,
                deflections_m,
                moments_n_m,
                largest_slope,
            });
        }
        (links, axis)
    }
}
