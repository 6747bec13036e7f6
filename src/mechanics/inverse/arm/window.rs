//! Histories of an arm's joints and links over the written window, cut out of the answer over one period.

use std::sync::Arc;

use rayon::prelude::*;

use super::answer::{ArmAnswer, JointHistories};
use super::rigid::rigid_torques_n_m;
use crate::elastica::AngleHistories;
use crate::inverse::histories::cut;
use crate::inverse::{
    JointMotion, LinkMotion, LinkShape, MotorHistories, PerQuantity, QuantityErrors,
};
use crate::link::Arm;
use crate::motion::TipMotionHistories;
use crate::numeric::TimeGrid;

fn cut_all<const N: usize>(histories: &[Vec<f64>; N], grid: &TimeGrid) -> [Vec<f64>; N] {
    histories.each_ref().map(|history| cut(history, grid))
}

impl ArmAnswer {
    /// The joints over a window, with their errors.
    pub(super) fn joints(
        &self,
        arm: &Arm,
        grid: &TimeGrid,
        errors: &[PerQuantity<QuantityErrors>],
    ) -> Vec<JointMotion> {
        let rigid: Vec<AngleHistories> =
            self.path.rigid.iter().map(|chord| cut_all(chord, grid)).collect();
        let rigid_torques_n_m = rigid_torques_n_m(arm, &rigid);
        let of = |(joint, rigid_torque_n_m): (usize, Vec<f64>)| {
            let JointHistories { angle, motor } = self.joint(joint);
            let link = &self.motion.links[joint];
            let before = joint.checked_sub(1).map(|before| &rigid[before][0]);
            let rigid_angle_rad = match before {
                None => rigid[joint][0].clone(),
                Some(before) => {
                    rigid[joint][0].iter().zip(before).map(|(own, before)| own - before).collect()
                }
            };
            let [angle_rad, rate_rad_s, acceleration_rad_s2] = cut_all(&angle, grid);
            JointMotion {
                torque_n_m: cut(&link.bent.torque_n_m, grid),
                rigid_torque_n_m,
                angle_rad,
                rate_rad_s,
                acceleration_rad_s2: Some(acceleration_rad_s2),
                rigid_angle_rad,
                force_n: Some(cut_all(&link.force_n, grid)),
                motor: motor.map(|motor| MotorHistories {
                    torque_n_m: cut(&motor.torque_n_m, grid),
                    angle_rad: cut(&motor.angle_rad, grid),
                    rate_rad_s: cut(&motor.rate_rad_s, grid),
                    power_w: cut(&motor.power_w, grid),
                }),
                errors: errors[joint],
            }
        };
        rigid_torques_n_m.into_par_iter().enumerate().map(of).collect()
    }

    /// The links over a window, and x and y of the tip with their derivatives.
    pub(super) fn links(&self, grid: &TimeGrid) -> (Vec<LinkMotion>, Vec<TipMotionHistories>) {
        let none = || [0, 1, 2].map(|_| vec![0.0; grid.len]);
        // Place, velocity and acceleration of the joint.
        let mut axis = [none(), none()];
        let mut links = Vec::new();
        for (link, model) in self.motion.links.iter().zip(&self.models) {
            let nodes_m = model.mesh().nodes_m();
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
            let moments_n_m: Vec<_> = moments.map(|history| cut(history, grid)).collect();
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
            let root_moment_n_m = moments_n_m[0].clone();
            let shape = LinkShape {
                root_rad: cut(&link.bent.hub_slope_rad, grid)
                    .iter()
                    .zip(&chord[0])
                    .map(|(slope, chord)| slope + chord)
                    .collect(),
                chord,
                chord_length_m,
                positions_m,
                deflections_m,
                moments_n_m,
            };
            links.push(LinkMotion {
                model: Arc::clone(model),
                root_moment_n_m,
                largest_slope: Some(link.bent.largest_slope),
                shape: Some(shape),
            });
        }
        let tip = axis.map(|[displacement_m, velocity_m_s, acceleration_m_s2]| {
            TipMotionHistories { displacement_m, velocity_m_s, acceleration_m_s2 }
        });
        (links, tip.into())
    }
}
