//! The modes of a link or an arm about a pose for its state space: all joints free, each with its torque.

use nalgebra::DMatrix;

use super::pose::{ArmPose, PoseError};
use super::pose_modes::ArmModes;
use super::state_space::{Modes, Motion, Output, Signal, StateSpace, StateSpaceScope};
use crate::link::POSITION_TOLERANCE;
use crate::model::Sensor;
use crate::numeric::dot;

impl ArmModes {
    /// The state space of these modes with free joints. A carriage is held.
    ///
    /// # Errors
    /// [`PoseError::Spread`].
    pub fn state_space(&self, scope: &StateSpaceScope) -> Result<StateSpace, PoseError> {
        self.pose.state_space(scope)
    }
}

impl ArmPose {
    /// [`ArmModes::state_space`] with as many modes as the pose has, at most.
    fn state_space(&self, scope: &StateSpaceScope) -> Result<StateSpace, PoseError> {
        let joints = self.joints.len();
        // The swing of one link is mode 0.
        let first = usize::from(joints > 1);
        let numbered = (first..).zip(self.undamped(None, usize::MAX)?);
        let rigid = first..=first + joints - 1;
        let (all, others): (Vec<_>, Vec<_>) =
            numbered.partition(|(number, _)| scope.modes.has(*number, rigid.clone()));
        let (numbers, all): (Vec<usize>, Vec<_>) = all.into_iter().unzip();
        let shapes: Vec<&[f64]> = all.iter().map(|mode| &mode.shape[..]).collect();
        let of_rest = |joint: usize| {
            let mut rest = vec![0.0; self.count];
            for (_, mode) in &others {
                let factor = mode.shape[joint] / mode.square_per_s2;
                rest.iter_mut().zip(&mode.shape).for_each(|(own, x)| *own += factor * x);
            }
            rest
        };
        let rests: Vec<Vec<f64>> = self.joints.iter().map(|joint| of_rest(*joint)).collect();
        let output = |name: String, unit: &str, motion, of: &dyn Fn(&[f64]) -> f64| Output {
            signal: Signal::new(name, unit),
            motion,
            modes: shapes.iter().map(|shape| of(shape)).collect(),
            rest: rests.iter().map(|rest| of(rest)).collect(),
        };
        let mut outputs = Vec::new();
        for (number, joint) in (1..).zip(&self.joints) {
            for (end, unit, motion) in
                [("", "rad", Motion::Displacement), ("_rate", "rad/s", Motion::Rate)]
            {
                outputs.push(output(format!("joint{number}{end}"), unit, motion, &|x| x[*joint]));
            }
        }
        let tip = vec![outputs.len(), outputs.len() + 1];
        for (axis, row) in ["x", "y"].into_iter().zip(&self.tip_rows) {
            outputs
                .push(output(format!("tip_{axis}"), "m", Motion::Displacement, &|x| dot(row, x)));
        }
        let strain = Sensor::RootStrain;
        for (number, row) in (1..).zip(self.root_rows()) {
            let name = format!("{}{number}", strain.word());
            outputs.push(output(name, strain.unit(), Motion::Displacement, &|x| dot(&row, x)));
        }
        outputs.extend(self.stations(scope, &shapes, &rests));
        let product = |matrix: &[f64], i: usize, j: usize| {
            let rows = matrix.chunks_exact(self.count).zip(shapes[i]);
            rows.map(|(row, x)| x * dot(row, shapes[j])).sum::<f64>()
        };
        let viscous = DMatrix::from_fn(all.len(), all.len(), |i, j| {
            let joints = self.joints.iter().zip(&self.friction_n_m_s_rad);
            let friction = joints.map(|(joint, b)| b * shapes[i][*joint] * shapes[j][*joint]);
            product(&self.damping, i, j) + friction.sum::<f64>()
        });
        let loss = DMatrix::from_fn(all.len(), all.len(), |i, j| product(&self.loss, i, j));
        let inputs = (1..).zip(&self.joints).map(|(number, joint)| {
            let turns = shapes.iter().map(|shape| shape[*joint]).collect();
            (Signal::new(format!("torque{number}"), "N m"), turns)
        });
        let modes = Modes {
            numbers,
            squares_per_s2: all.iter().map(|mode| mode.square_per_s2).collect(),
            viscous,
            loss,
            inputs: inputs.collect(),
            frictions: self.friction_n_m_s_rad.clone(),
            outputs,
            tip,
        };
        Ok(modes.state_space(scope.has_residual))
    }

    /// x and y of the stations on each link. A shorter link has those that lie on it.
    fn stations(
        &self,
        scope: &StateSpaceScope,
        shapes: &[&[f64]],
        rests: &[Vec<f64>],
    ) -> Vec<Output> {
        let on_link = |length_m: &f64| {
            let stations = (1..).zip(&scope.stations_m);
            let on_it =
                stations.filter(|(_, at_m)| **at_m <= length_m * (1.0 + POSITION_TOLERANCE));
            on_it.map(|(number, at_m)| (number, *at_m)).collect()
        };
        let links: Vec<Vec<(u32, f64)>> = self.lengths_m().iter().map(on_link).collect();
        let along_m: Vec<Vec<f64>> =
            links.iter().map(|own| own.iter().map(|(_, at_m)| *at_m).collect()).collect();
        let of_modes: Vec<_> = shapes.iter().map(|shape| self.moved(&along_m, shape)).collect();
        let of_rests: Vec<_> = rests.iter().map(|rest| self.moved(&along_m, rest)).collect();
        let mut outputs = Vec::new();
        for (link, own) in links.iter().enumerate() {
            let of_link =
                if links.len() == 1 { String::new() } else { format!("link{}_", link + 1) };
            for (place, (number, _)) in own.iter().enumerate() {
                for (axis, letter) in ["x", "y"].into_iter().enumerate() {
                    outputs.push(Output {
                        signal: Signal::new(format!("{of_link}station{number}_{letter}"), "m"),
                        motion: Motion::Displacement,
                        modes: of_modes.iter().map(|own| own[link][place][axis]).collect(),
                        rest: of_rests.iter().map(|own| own[link][place][axis]).collect(),
                    });
                }
            }
        }
        outputs
    }
}

#[cfg(test)]
mod tests {
    use super::super::state_space::ModeChoice;
    use super::*;
    use crate::link::{
        Arm, ArmLink, ArmParts, Damping, Hub, Link, LinkParts, Payload, Segment, uniform,
    };

    /// Two bent links with friction in both joints.
    fn pose(damping: &Damping) -> ArmPose {
        let link = |length_m: f64, viscous_friction_n_m_s_rad: f64| {
            let link = Link::new(LinkParts {
                segments: vec![Segment::uniform(length_m, 20.0, 0.6)],
                hub: Hub { inertia_kg_m2: 0.02, radius_m: 0.03, viscous_friction_n_m_s_rad },
                payload: Payload { mass_kg: 0.3, inertia_kg_m2: 1e-3, offset_m: 0.0 },
                damping: damping.clone(),
                ..uniform()
            });
            ArmLink { name: None, link: link.unwrap() }
        };
        let links = vec![link(0.7, 0.3), link(0.5, 0.1)];
        let gravity_m_s2 = [0.0, -9.81];
        let arm = Arm::new(ArmParts { links, gravity_m_s2, ..ArmParts::default() }).unwrap();
        ArmPose::of(&arm, &[-0.8, 0.4], (0.0, 4)).unwrap()
    }

    fn scope(modes: usize, has_residual: bool) -> StateSpaceScope {
        StateSpaceScope { modes: ModeChoice::First(modes), stations_m: Vec::new(), has_residual }
    }

    /// With the static response of the others a mode left out far above adds nothing; one below is missed.
    #[test]
    fn chosen_modes_are_those_of_all() {
        let pose = pose(&Damping::None);
        let all = pose.state_space(&scope(4, false)).unwrap();
        let modes = ModeChoice::Numbers(vec![5, 2]);
        let few = pose.state_space(&StateSpaceScope { modes, ..scope(0, false) }).unwrap();
        assert_eq!(few.numbers().collect::<Vec<_>>(), [2, 5]);
        for (own, of_all) in [(0, 1), (1, 4)] {
            assert_eq!(few.a[(2 + own, own)].to_bits(), all.a[(6 + of_all, of_all)].to_bits());
            assert_eq!(few.b.row(2 + own), all.b.row(6 + of_all));
            assert_eq!(few.c.column(own), all.c.column(of_all));
        }
    }

    fn worst(pose: &ArmPose, scope: &StateSpaceScope, hertz: f64) -> f64 {
        let found = pose.state_space(scope).unwrap();
        let at = found.response(std::f64::consts::TAU * hertz).unwrap();
        let exact = pose.response(hertz);
        let mut worst: f64 = 0.0;
        for (column, own) in exact.torques.iter().enumerate() {
            for (row, output) in found.outputs.iter().enumerate() {
                let exact = match &*output.name {
                    "joint1" => own.joints_rad[0],
                    "joint2" => own.joints_rad[1],
                    "tip_x" => own.tip_m[0],
                    "tip_y" => own.tip_m[1],
                    _ => continue,
                };
                worst = worst.max((at[(row, column)] / exact - 1.0).norm());
            }
        }
        worst
    }

    #[test]
    fn the_response_in_a_pose_is_that_of_frf() {
        let [all, few] = [1000, 4].map(|modes| scope(modes, true));
        let pose = pose(&Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 2e-4 });
        for hertz in [0.05, 0.7, 3.0, 11.0] {
            assert!(worst(&pose, &all, hertz) < 1e-9, "{:e}", worst(&pose, &all, hertz));
            // Far below the first mode left out its static response is the whole of it.
            let off = worst(&pose, &few, hertz);
            assert!(hertz > 5.0 || off < 1e-2, "{off:e} at {hertz} Hz");
        }
    }

    #[test]
    fn hysteretic_damping_stands_in_as_told() {
        let pose = pose(&Damping::Hysteretic { ratio: 0.01 });
        let scope = scope(1000, false);
        let told = pose.state_space(&scope).unwrap().hysteretic_difference.unwrap();
        let most = [0.3, 0.7, 3.0, 9.0, 20.0].map(|hertz| worst(&pose, &scope, hertz));
        let most = most.into_iter().fold(0.0, f64::max);
        assert!(told < 0.1 && most > 1e-4 && most < 3.0 * told, "{told} {most}");
    }

    #[test]
    fn stations_are_places_on_the_links_and_the_root_bends_as_its_moment_says() {
        let pose = pose(&Damping::None);
        let stations_m = vec![0.53, 0.3];
        let scope = StateSpaceScope { stations_m, ..scope(3, true) };
        let found = pose.state_space(&scope).unwrap();
        let names: Vec<&str> = found.outputs.iter().map(|own| &*own.name).collect();
        let stations = ["link1_station1_x", "link1_station1_y", "link1_station2_x"];
        assert_eq!(names[8..11], stations);
        assert_eq!(names[6..8], ["root_strain1", "root_strain2"]);
        // The end of the second link is the tip.
        let row = |name: &str| names.iter().position(|own| *own == name).unwrap();
        for axis in ["x", "y"] {
            let (tip, end) = (row(&format!("tip_{axis}")), row(&format!("link2_station1_{axis}")));
            let apart = (found.c.row(tip) - found.c.row(end)).amax();
            assert!(apart < 1e-9 * found.c.row(tip).amax(), "{apart:e}");
        }
    }
}
