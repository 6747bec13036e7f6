//! The motion of an arm over one period: histories of its joints, and of the quantities with errors.

use std::borrow::Cow;
use std::sync::Arc;

use num_complex::Complex64;
use rayon::prelude::*;

use crate::elastica::{AngleHistories, ArmLinkMotion, ArmMotion, ArmPeriod};
use crate::inverse::accuracy::Curves;
use crate::inverse::period::Rest;
use crate::inverse::periodic_answer::PeriodicAnswer;
use crate::inverse::solution::{Shape, farthest_m};
use crate::inverse::spectra::{DrivenModel, HubSpectra};
use crate::inverse::{MotorHistories, Unwatched};
use crate::link::{ArmCarriage, Drive};
use crate::model::Model;
use crate::motion::{ArmPath, CourseHistories, Prescribed, TipPeriod};

/// Links on their meshes, the inner one first.
pub(in super::super) type Models = [Arc<dyn Model>];

/// The wanted motion over one period, and the chords along it.
pub(in super::super) struct PathPeriod {
    pub(super) arm: ArmPeriod,
    pub(super) rest: Rest,
    /// Direction of each chord in rad at rest before the motion and after it, then places of the carriage in m.
    pub(super) rests: Vec<[f64; 2]>,
    /// Chords of the rigid arm, which do not return.
    pub(super) rigid: Vec<AngleHistories>,
    /// The carriage of the arm.
    pub(super) carried: Option<Carried>,
    /// The period of the tip, or of the coordinate with the highest cut-off.
    pub(in super::super) tip: Arc<TipPeriod>,
    /// Largest error of each coordinate of the path, in m.
    pub(super) errors_m: Vec<f64>,
}

/// The carriage of an arm over a period.
pub(in super::super) struct Carried {
    pub(super) own: ArmCarriage,
    pub(super) gravity_m_s2: [f64; 2],
    /// Displacement in m, rate and acceleration.
    pub(super) course: CourseHistories,
}

impl Carried {
    /// Accelerations of the first axis along x and y in m/s².
    pub(super) fn accelerations_m_s2(&self) -> Vec<[f64; 2]> {
        self.course[2].iter().map(|own| self.own.axis.map(|part| own * part)).collect()
    }

    /// Force on the carriage in N.
    fn force_n(&self, motion: &ArmMotion) -> Vec<f64> {
        let ([x_n, y_n], [_, rate, acceleration]) = (&motion.links[0].force_n, &self.course);
        let force_n = |k: usize| {
            let moving = [rate[k], acceleration[k]];
            self.own.force_n(self.gravity_m_s2, moving, [x_n[k], y_n[k]])
        };
        (0..x_n.len()).map(force_n).collect()
    }
}

/// The answer over one period.
pub(in super::super) struct ArmAnswer {
    pub(super) models: Vec<Arc<dyn Model>>,
    pub(in super::super) motion: ArmMotion,
    pub(super) path: Arc<PathPeriod>,
}

/// Motion and torque of a joint over the period.
pub(super) struct JointHistories {
    /// Angle in rad of its link's root against the tip of the link before, or against x; its rate and acceleration.
    pub(super) angle: AngleHistories,
    /// The same of the rotor, if the joint has a drive.
    pub(super) rotor: Option<AngleHistories>,
}

/// History of a joint's link less that of the link before; the first joint has no link before.
pub(super) fn relative(link: &[f64], before: Option<&Vec<f64>>) -> Vec<f64> {
    match before {
        None => link.to_vec(),
        Some(before) => link.iter().zip(before).map(|(link, before)| link - before).collect(),
    }
}

/// Angle in rad that the slopes of a link's root and of the tip before it add to the joint's chord angle.
fn bent_rad(ArmMotion { links, .. }: &ArmMotion, joint: usize) -> Vec<f64> {
    let before = joint.checked_sub(1).map(|before| &links[before].tip_slope_rad);
    relative(&links[joint].bent.hub_slope_rad, before)
}

/// Turn of a joint's chords against each other: angle, rate or acceleration.
fn turned(ArmMotion { links, .. }: &ArmMotion, joint: usize, part: usize) -> Vec<f64> {
    relative(
        &links[joint].chord[part],
        joint.checked_sub(1).map(|before| &links[before].chord[part]),
    )
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

impl PathPeriod {
    /// Number of samples.
    pub(super) fn len(&self) -> usize {
        self.tip.spectrum.pair.len()
    }

    /// Force in N that holds the carriage of an arm at rest.
    pub(super) fn held_n(&self, ArmMotion { links, .. }: &ArmMotion) -> Option<f64> {
        let Carried { own, gravity_m_s2, .. } = self.carried.as_ref()?;
        let on_arm_n = links[0].force_n.each_ref().map(|force_n| force_n[0]);
        Some(own.force_n(*gravity_m_s2, [0.0; 2], on_arm_n))
    }

    /// Number of bins of its band.
    pub(super) fn bins(&self) -> usize {
        self.tip.spectrum.band_len()
    }
}

impl ArmAnswer {
    /// Another motion of the same models on the same path.
    pub(super) fn with(&self, motion: ArmMotion) -> Self {
        Self { models: self.models.clone(), motion, path: Arc::clone(&self.path) }
    }

    /// Number of joints, the carriage included.
    pub(super) fn joint_count(&self) -> usize {
        self.models.len() + usize::from(self.path.carried.is_some())
    }

    /// Torque of a joint in N m, or the force on the carriage in N.
    pub(super) fn effort(&self, joint: usize) -> Cow<'_, [f64]> {
        match (self.motion.links.get(joint), &self.path.carried) {
            (None, Some(carried)) => carried.force_n(&self.motion).into(),
            _ => Cow::from(&self.motion.links[joint].bent.torque_n_m[..]),
        }
    }

    /// A history of a period, or a derivative of it in time.
    pub(super) fn derivative(&self, history: &[f64], order: usize) -> Vec<f64> {
        let spectrum = &self.path.tip.spectrum;
        if order == 0 {
            return history.to_vec();
        }
        spectrum.pair.samples(spectrum.derivative(&spectrum.pair.amplitudes(history), order))
    }

    /// Histories of a joint, and of its rotor where it has a drive.
    pub(super) fn joint(&self, joint: usize) -> JointHistories {
        if let (None, Some(carried)) = (self.models.get(joint), &self.path.carried) {
            return JointHistories { angle: carried.course.clone(), rotor: None };
        }
        let bent = bent_rad(&self.motion, joint);
        let chords = [0, 1, 2].map(|part| turned(&self.motion, joint, part));
        let with_chords = |elastic: &[f64]| -> AngleHistories {
            [0, 1, 2].map(|part| sum(&self.derivative(elastic, part), &chords[part]))
        };
        let angle = with_chords(&bent);
        let rotor = self.models[joint].link().drive().map(|drive| {
            let torque_n_m = &self.motion.links[joint].bent.torque_n_m;
            rotor(drive, torque_n_m, |twist| with_chords(&sum(&bent, twist)))
        });
        JointHistories { angle, rotor }
    }

    /// Torque in N m, without losses, and rate in rad/s of a joint's motor.
    pub(super) fn motor(&self, joint: usize, rotor: AngleHistories) -> Option<[Vec<f64>; 2]> {
        let [_, rate, acceleration] = rotor;
        let torque_n_m = &self.motion.links[joint].bent.torque_n_m;
        let drive = self.models[joint].link().drive()?;
        Some([MotorHistories::lossless_n_m(drive, torque_n_m, &acceleration), rate])
    }

    /// Histories of all quantities outside the chords' return, a set for each joint.
    pub(in super::super) fn curves(&self, probes: &[Vec<usize>]) -> Vec<Curves> {
        self.curves_by(probes, |values| self.path.rest.outside_return(values))
    }

    /// Histories of all quantities over the first samples of the period, those of the motion itself.
    pub(super) fn curves_of_motion(&self, probes: &[Vec<usize>], given: usize) -> Vec<Curves> {
        self.curves_by(probes, |values| values[..given].to_vec())
    }

    fn curves_by(
        &self,
        probes: &[Vec<usize>],
        chronological: impl Fn(&[f64]) -> Vec<f64> + Sync,
    ) -> Vec<Curves> {
        let curves_of = |joint: usize| {
            let JointHistories { angle: [angle, rate, acceleration], rotor } = self.joint(joint);
            let nodes = probes.get(joint).map_or(&[][..], Vec::as_slice).iter();
            let displacement_m = |node: &usize| {
                chronological(&displacement_m(&self.models, &self.motion, joint, *node))
            };
            let moment_n_m =
                |node: &usize| chronological(&self.motion.links[joint].bent.moments_n_m[*node]);
            Curves {
                torque_n_m: chronological(&self.effort(joint)),
                hub_angle_rad: chronological(&angle),
                hub_rate_rad_s: chronological(&rate),
                hub_acceleration_rad_s2: chronological(&acceleration),
                displacement_m: nodes.clone().map(displacement_m).collect(),
                moment_n_m: nodes.map(moment_n_m).collect(),
                motor: rotor
                    .and_then(|rotor| self.motor(joint, rotor))
                    .map(|motor| motor.map(|values| chronological(&values))),
            }
        };
        (0..self.joint_count()).into_par_iter().map(curves_of).collect()
    }

    /// The answer of one link as amplitudes at hub and motor.
    pub(in super::super) fn periodic(&self) -> PeriodicAnswer {
        let (model, period, watch) = (&*self.models[0], &*self.path.tip, &Unwatched);
        let (bent, pair) = (&self.motion.links[0].bent, &period.spectrum.pair);
        let hub = HubSpectra {
            torque_n_m: pair.amplitudes(&bent.torque_n_m),
            excess_angle_rad: pair.amplitudes(&bent.hub_slope_rad),
            root_moment_n_m: pair.amplitudes(&bent.moments_n_m[0]),
            blocked_hz: None,
        };
        let motor = DrivenModel { model, period, watch }.motor_spectra(&hub);
        PeriodicAnswer::new(hub, motor.as_ref(), Arc::clone(&self.path.tip))
    }

    /// Largest distance in m of the rigid arm's tip from its start, over the samples of its path.
    pub(super) fn way_of_chords_m(&self, given: usize) -> f64 {
        let moved = |part: usize| match &self.path.carried {
            Some(Carried { own, course, .. }) => {
                course[0][..given].iter().map(|at_m| own.axis[part] * at_m).collect()
            }
            None => vec![0.0; given],
        };
        let [mut x_m, mut y_m] = [moved(0), moved(1)];
        for (chord, model) in self.path.rigid.iter().zip(&self.models) {
            let length_m = model.mesh().length_m();
            for k in 0..given {
                x_m[k] += length_m * libm::cos(chord[0][k]);
                y_m[k] += length_m * libm::sin(chord[0][k]);
            }
        }
        farthest_m([&x_m, &y_m])
    }

    /// Largest distance of the solved tip from the wanted one, in m.
    pub(super) fn tip_error_m(&self, path: &ArmPath) -> f64 {
        match (path.prescribed(), &self.path.errors_m[..]) {
            (Prescribed::Tip, [x, y, ..]) => (x * x + y * y).sqrt(),
            // The tip is the sum of the chords and the carriage: L δθ of each chord.
            (_, errors_m) => errors_m.iter().sum(),
        }
    }

    /// Amplitudes of a torque over the period.
    pub(super) fn torque_amplitudes_n_m(&self, joint: usize) -> Vec<Complex64> {
        self.path.tip.spectrum.pair.amplitudes(&*self.effort(joint))
    }
}

/// Angle of a joint's rotor, rate and acceleration. `turned` is the angle behind the joint's spring; the torque twists the
/// spring: `φ = n (θ + T/k)`.
fn rotor(
    drive: &Drive,
    torque_n_m: &[f64],
    turned: impl Fn(&[f64]) -> AngleHistories,
) -> AngleHistories {
    let twist: Vec<f64> = torque_n_m.iter().map(|t| t / drive.joint_stiffness_n_m_rad).collect();
    turned(&twist).map(|values| values.iter().map(|x| drive.gear_ratio * x).collect())
}

/// Displacement in m of a node: for one link along its arc, for several from the chord.
fn displacement_m(models: &Models, motion: &ArmMotion, joint: usize, node: usize) -> Vec<f64> {
    let ArmLinkMotion { bent, chord, .. } = &motion.links[joint];
    if models.len() > 1 {
        return bent.deflections[2 * node].clone();
    }
    let mesh = models[joint].mesh();
    let (arcs_m, rigid) =
        (Shape::arc_m(bent, motion.second_order, mesh, node), mesh.rigid(node)[0]);
    arcs_m.iter().zip(&chord[0]).map(|(arc_m, angle)| arc_m + rigid * angle).collect()
}

/// All quantities of an arm at rest before its motion, `end` 0, or after it, `end` 1: one sample of each.
pub(super) fn curves_at_rest(
    models: &Models,
    path: &PathPeriod,
    (motion, end): (&ArmMotion, usize),
    probes: &[Vec<usize>],
) -> Vec<Curves> {
    let first = |history: &[f64]| vec![history[0]];
    let curves_of = |joint: usize| {
        let bent = &motion.links[joint].bent;
        let angle = sum(&bent_rad(motion, joint), &turned(motion, joint, 0));
        let nodes = probes[joint].iter();
        let displacement_m = |node: &usize| first(&displacement_m(models, motion, joint, *node));
        let drive = models[joint].link().drive();
        Curves {
            torque_n_m: first(&bent.torque_n_m),
            hub_angle_rad: first(&angle),
            hub_rate_rad_s: vec![0.0],
            hub_acceleration_rad_s2: vec![0.0],
            displacement_m: nodes.clone().map(displacement_m).collect(),
            moment_n_m: nodes.map(|node| first(&bent.moments_n_m[*node])).collect(),
            motor: drive.map(|drive| [vec![bent.torque_n_m[0] / drive.gear_ratio], vec![0.0]]),
        }
    };
    let carriage = path.held_n(motion).map(|force_n| Curves {
        torque_n_m: vec![force_n],
        hub_angle_rad: vec![path.rests[models.len()][end]],
        hub_rate_rad_s: vec![0.0],
        hub_acceleration_rad_s2: vec![0.0],
        displacement_m: Vec::new(),
        moment_n_m: Vec::new(),
        motor: None,
    });
    (0..models.len()).map(curves_of).chain(carriage).collect()
}
