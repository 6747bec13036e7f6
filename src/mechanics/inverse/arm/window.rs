//! Histories of an arm's joints and links over the written window, cut out of the answer over one period;
//! the torques of the rigid arm, by recursive Newton-Euler; the tip with the joints moved as solved, by Lagrange's equations,
//! independent of the inversion.

use std::f64::consts::TAU;
use std::sync::Arc;

use rayon::prelude::*;

use super::answer::{ArmAnswer, JointHistories, relative};
use crate::elastica::AngleHistories;
use crate::inverse::histories::cut;
use crate::inverse::{
    JointMotion, LinkMotion, LinkShape, MotorHistories, PerQuantity, QuantityErrors, Solution,
    Straying,
};
use crate::link::Arm;
use crate::motion::{ArmPath, Ends, Prescribed, TipMotionHistories};
use crate::numeric::{Size, TimeGrid};
use crate::response::{MovedJoint, Played, SimulationError, move_arm};

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
        let carriage = self.path.carried.as_ref().map(|own| cut_all(&own.course, grid));
        let rigid_torques_n_m = rigid_torques_n_m(arm, &rigid, carriage.as_ref());
        let motion_of = |(joint, rigid_torque_n_m): (usize, Vec<f64>)| {
            let JointHistories { angle, rotor } = self.joint(joint);
            let force_n = self.motion.links.get(joint).map(|link| cut_all(&link.force_n, grid));
            let before = joint.checked_sub(1).map(|before| &rigid[before][0]);
            let rigid_angle_rad = match (rigid.get(joint), &carriage) {
                (Some([rigid, ..]), _) => relative(rigid, before),
                (None, carriage) => carriage.iter().flat_map(|[own, ..]| own.clone()).collect(),
            };
            let [angle_rad, rate_rad_s, acceleration_rad_s2] = cut_all(&angle, grid);
            let torque_n_m = cut(&self.effort(joint), grid);
            let drive = self.models.get(joint).and_then(|model| model.link().drive());
            let motor = drive.zip(rotor).map(|(drive, rotor)| {
                MotorHistories::of(drive, [&torque_n_m, &rate_rad_s], cut_all(&rotor, grid))
            });
            JointMotion {
                torque_n_m,
                rigid_torque_n_m,
                angle_rad,
                rate_rad_s,
                acceleration_rad_s2: Some(acceleration_rad_s2),
                rigid_angle_rad,
                force_n,
                motor,
                errors: errors[joint],
            }
        };
        rigid_torques_n_m.into_par_iter().enumerate().map(motion_of).collect()
    }

    /// The links over a window, and x and y of the tip with their derivatives.
    pub(super) fn links(&self, grid: &TimeGrid) -> (Vec<LinkMotion>, Vec<TipMotionHistories>) {
        let carried = self.path.carried.as_ref();
        let carried = carried.map(|own| (own.own.axis, cut_all(&own.course, grid)));
        // Place, velocity and acceleration of the joint.
        let mut axis = [0, 1].map(|part: usize| match &carried {
            Some((axis, course)) => {
                course.each_ref().map(|own| own.iter().map(|at| axis[part] * at).collect())
            }
            None => [0, 1, 2].map(|_| vec![0.0; grid.len]),
        });
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

/// Mass moments of a rigid link.
struct RigidLink {
    length_m: f64,
    mass_kg: f64,
    /// First moment about its joint in kg m.
    moment_kg_m: f64,
    /// Rotary inertia about its joint in kg m², hub included.
    inertia_kg_m2: f64,
    friction_n_m_s_rad: f64,
}

/// Torques in N m of the joints of an arm of rigid links with these directions, and the force in N on its carriage, which
/// moves by this course.
///
/// ```text
/// a₁ = ü − g,   aᵢ₊₁ = aᵢ + Lᵢ c,   c = −θ̇ᵢ² e + θ̈ᵢ n
/// Fᵢ = mᵢ aᵢ + Sᵢ c + Fᵢ₊₁,   Tᵢ = Iᵢ θ̈ᵢ + (Sᵢ aᵢ + Lᵢ Fᵢ₊₁)·n + Tᵢ₊₁
/// ```
///
/// Friction comes last: like the torque it acts between two links.
fn rigid_torques_n_m(
    arm: &Arm,
    chords: &[AngleHistories],
    carriage: Option<&AngleHistories>,
) -> Vec<Vec<f64>> {
    let carriage = arm.carriage().zip(carriage);
    let links: Vec<RigidLink> = arm
        .links()
        .iter()
        .map(|own| RigidLink {
            length_m: own.link.length_m(),
            mass_kg: own.link.mass_kg(),
            moment_kg_m: own.link.mass_moment_kg_m(),
            inertia_kg_m2: own.link.rigid_inertia_kg_m2(),
            friction_n_m_s_rad: own.link.joint().friction(),
        })
        .collect();
    let samples = chords[0][0].len();
    let mut torques_n_m = vec![Vec::with_capacity(samples); arm.joints().count()];
    let mut axes = Vec::with_capacity(links.len());
    for k in 0..samples {
        let mut axis = arm.gravity_m_s2().map(|part| -part);
        if let Some((own, [_, _, acceleration])) = carriage {
            axis = [0, 1].map(|part| axis[part] + acceleration[k] * own.axis[part]);
        }
        axes.clear();
        for (link, chord) in links.iter().zip(chords) {
            let [angle, rate, turning] = [0, 1, 2].map(|part| chord[part][k]);
            let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
            let per_m =
                [-rate * rate * cosine - turning * sine, -rate * rate * sine + turning * cosine];
            axes.push((axis, per_m, [-sine, cosine], turning));
            axis = [0, 1].map(|part| axis[part] + link.length_m * per_m[part]);
        }
        let (mut force_n, mut torque_n_m) = ([0.0; 2], 0.0);
        for (number, link) in links.iter().enumerate().rev() {
            let (axis, per_m, across, turning) = axes[number];
            let onto = |vector: [f64; 2]| vector[0] * across[0] + vector[1] * across[1];
            torque_n_m += link.inertia_kg_m2 * turning
                + link.moment_kg_m * onto(axis)
                + link.length_m * onto(force_n);
            force_n = [0, 1].map(|part| {
                force_n[part] + link.mass_kg * axis[part] + link.moment_kg_m * per_m[part]
            });
            let before = number.checked_sub(1).map_or(0.0, |before| chords[before][1][k]);
            let friction_n_m = link.friction_n_m_s_rad * (chords[number][1][k] - before);
            torques_n_m[number].push(torque_n_m + friction_n_m);
        }
        if let Some((own, [_, rate, acceleration])) = carriage {
            let moving = [rate[k], acceleration[k]];
            torques_n_m[links.len()].push(own.force_n(arm.gravity_m_s2(), moving, force_n));
        }
    }
    torques_n_m
}

/// Tolerance of a moved arm, over the tolerance of the analysis.
const SETTLED: f64 = 0.1;

/// Largest change by the last refinement of a moved arm, over the tip's error, that still allows to measure this error.
const SHARP: f64 = 0.3;

impl Solution {
    /// The arm with its joints moved as solved, by Lagrange's equations.
    ///
    /// # Errors
    /// [`SimulationError`].
    pub fn moved(&self) -> Result<Played, SimulationError> {
        let accelerations: Vec<_> =
            (0..self.joints.len()).map(|joint| self.acceleration_rad_s2(joint)).collect();
        let joints =
            self.joints.iter().zip(&accelerations).map(|(joint, acceleration)| MovedJoint {
                angle_rad: joint.angle_rad[0],
                rate_rad_s: joint.rate_rad_s[0],
                accelerations_rad_s2: acceleration,
            });
        let joints: Vec<MovedJoint<'_>> = joints.collect();
        let highest_rad_s = TAU * self.band.cutoff_hz.unwrap_or(0.25 / self.grid.step_s);
        let tolerance = SETTLED * self.analysis.tolerance();
        let repeats = self.motion.ends() == Ends::Periodic;
        move_arm(&self.arm, &joints, &self.grid, (highest_rad_s, tolerance), repeats)
    }

    /// Largest distance of the moved arm's tip from its path, over its travel; for a path of angles, from the solved
    /// tip.
    pub fn tip_error_of(&self, moved: &Played, path: &ArmPath) -> f64 {
        let off = |k: usize| {
            let wanted_m = self.wanted_tip_m(path, k);
            distance([0, 1].map(|axis: usize| moved.tip[axis].displacement_m[k] - wanted_m[axis]))
        };
        (0..self.grid.len).map(off).fold(0.0, Size::larger) / self.tip_travel_m()
    }

    /// Wanted place of the tip at a sample of the window, x and y in m; for a path of angles, the solved place.
    pub(crate) fn wanted_tip_m(&self, path: &ArmPath, k: usize) -> [f64; 2] {
        let last = path.grid().len - 1;
        let before = usize::try_from(-self.grid.first).unwrap_or(0);
        [0, 1].map(|axis: usize| match path.prescribed() {
            // A window holds all rows of its path.
            Prescribed::Tip => path.given()[axis][k.saturating_sub(before).min(last)],
            Prescribed::Angles => self.tip[axis].displacement_m[k],
        })
    }
}

/// Error of the tip from chords as long as their links.
pub(super) fn straying(solution: &Solution, path: &ArmPath) -> Straying {
    let travel_m = solution.tip_travel_m();
    let measured = solution.moved().ok().and_then(|moved| {
        let share = solution.tip_error_of(&moved, path);
        (moved.change()[0] <= SHARP * share * travel_m).then_some(Straying::Measured(share))
    });
    measured.unwrap_or_else(|| Straying::Estimated(shortened_m(solution) / travel_m))
}

/// Largest error of the tip in m by shorter chords: the chord of a bent link is ½ ∫ w'² ds shorter than its link.
fn shortened_m(solution: &Solution) -> f64 {
    let at = |k: usize| {
        let links = solution.shapes().zip(solution.nodes_m());
        let missed = links.fold([0.0; 2], |[x, y], (link, nodes_m)| {
            let rows = link.deflections_m.windows(2).zip(nodes_m.windows(2));
            let short: f64 = rows
                .map(|(w, s)| 0.5 * (w[1][k] - w[0][k]) * (w[1][k] - w[0][k]) / (s[1] - s[0]))
                .sum();
            let angle = link.chord[0][k];
            [x + short * libm::cos(angle), y + short * libm::sin(angle)]
        });
        distance(missed)
    };
    (0..solution.grid.len).map(at).fold(0.0, Size::larger)
}

fn distance([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}
