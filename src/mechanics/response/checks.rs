//! Verification of a simulation: its balance of energy, its errors, and the warnings of bent links.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::bent::{BentMotion, JointMotion};
use super::error::{STEP_SHARE, SimulationError, SimulationWarning};
use super::history::{APART_RAD, Torque};
use super::modes::{Equations, MOST_MODES, kept_modes};
use super::play::{Input, Play};
use super::played::{Played, PlayedBy, PlayedLink};
use super::stepper::Stepper;
use crate::link::{Arm, Drive};
use crate::modal::{DampingLaw, Shape, buckling_share};
use crate::numeric::{CubicSpline, SplineEnds, TimeGrid, extremes, largest, largest_difference};

/// Balance of energy at one time, in J.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyBalance {
    /// Time in s.
    pub time_s: f64,
    /// Work of the motor since the start, ∫ T θ̇ dt.
    pub work_j: f64,
    /// Kinetic energy.
    pub kinetic_j: f64,
    /// Strain energy; with weight or at large angles energy of strain and weight since the start.
    pub strain_j: f64,
    /// Energy dissipated by damping and friction.
    pub dissipated_j: f64,
}

/// Balances over time, and the error of their integrals.
#[derive(Debug, Clone, PartialEq)]
pub struct EnergyAccount {
    /// The balances.
    pub balances: Vec<EnergyBalance>,
    /// Energy of the link at the start in J: 0 at rest.
    pub start_j: f64,
    /// Estimated error of the integrals of work and loss in J: a quarter of their change without every second sample. A
    /// smooth power has an error of a sixteenth, a power with kinks a larger one.
    pub quadrature_error_j: f64,
}

impl Played {
    /// The balance at `count` samples, the last one among them. Equal integrals of the motor's absolute power separate
    /// them, so that few fall into a long rest.
    ///
    /// A cubic spline integrates work and dissipation over all samples. The energies are those of the elastica, or of
    /// the elements in the shape and rate of the summed modes.
    pub fn energy(&self, count: usize) -> EnergyAccount {
        let power_w = |sample: usize| {
            let work_w = |own: &JointMotion| {
                own.net_n_m.as_ref().unwrap_or(&own.torque_n_m)[sample] * own.rate_rad_s[sample]
            };
            self.joints.iter().map(work_w).sum()
        };
        let motor: Vec<f64> = (0..self.grid.len).map(power_w).collect();
        let lost: Vec<f64> = (0..self.grid.len).map(|sample| self.loss_w(sample)).collect();
        let (work, dissipated) = (self.integral(&motor, 1), self.integral(&lost, 1));
        let last = self.grid.len - 1;
        let mut total = 0.0;
        let worked: Vec<f64> = motor
            .iter()
            .map(|power| {
                total += power.abs();
                total
            })
            .collect();
        let balance = |k: usize| {
            let reached = |sum: &f64| *sum < total * k as f64 / count as f64;
            let sample = if k == count { last } else { worked.partition_point(reached) };
            let [kinetic_j, strain_j] = self.energies_j(sample);
            EnergyBalance {
                time_s: self.grid.time_s(sample),
                work_j: work[sample],
                kinetic_j,
                strain_j,
                dissipated_j: dissipated[sample],
            }
        };
        let missing = |power: &[f64], integral: &[f64]| {
            if power.len() < 2 * CubicSpline::MIN_POINTS {
                // Too few samples for integrals without every second one.
                return 0.0;
            }
            let every_second: Vec<f64> = integral.iter().copied().step_by(2).collect();
            largest_difference(&every_second, &self.integral(power, 2))
        };
        EnergyAccount {
            balances: (1..=count).map(balance).collect(),
            start_j: self.energies_j(0).iter().sum(),
            quadrature_error_j: 0.25 * (missing(&motor, &work) + missing(&lost, &dissipated)),
        }
    }

    /// Kinetic energy, and that of strain and weight since the start, at a sample in J.
    fn energies_j(&self, sample: usize) -> [f64; 2] {
        let modes = match &self.by {
            PlayedBy::Modes(modes) => modes,
            PlayedBy::Elastica(bent) => {
                let held_j = bent.potential_j[sample] - bent.potential_j[0];
                return [bent.kinetic_j[sample], held_j];
            }
        };
        let (q, rate) = modes.record.at(sample);
        let [shape, velocity] = [q, rate].map(|own| Shape::sum(own, &modes.equations.shapes));
        let kinetic_j = 0.5 * velocity.mass_product(self.mesh(), &velocity);
        [kinetic_j, 0.5 * shape.stiffness_product(self.mesh(), &shape)]
    }

    /// Power that damping and friction dissipate at a sample in W.
    fn loss_w(&self, sample: usize) -> f64 {
        let modes = match &self.by {
            PlayedBy::Modes(modes) => modes,
            PlayedBy::Elastica(bent) => return bent.loss_w(sample),
        };
        let rate = modes.record.at(sample).1;
        let turning_rad_s = modes.turning_rad_s.get(sample).copied().unwrap_or(0.0);
        modes.equations.damped_w(rate, turning_rad_s)
            + modes.equations.reaction.friction_n_m_s_rad * self.hub().rate_rad_s[sample].powi(2)
    }

    /// ∫ dt from the first to each `every`-th sample, from these samples alone.
    fn integral(&self, samples: &[f64], every: usize) -> Vec<f64> {
        let samples: Vec<f64> = samples.iter().copied().step_by(every).collect();
        let step_s = every as f64 * self.grid.step_s;
        let spline = CubicSpline::uniform(&samples, SplineEnds::NotAKnot);
        let pieces = samples
            .windows(2)
            .zip(spline.slopes().windows(2))
            .map(|(ends, slopes)| 0.5 * (ends[0] + ends[1]) + (slopes[0] - slopes[1]) / 12.0);
        let running = pieces.scan(0.0, |sum, piece| {
            *sum += piece * step_s;
            Some(*sum)
        });
        std::iter::once(0.0).chain(running).collect()
    }
}

/// Warning threshold of the errors of tip and hub angle.
const COARSE: f64 = 1e-2;

/// Errors of a simulation by its mesh and its modes; for bent links by their angles and steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PlayError {
    /// Largest error of the tip's displacement, over its travel.
    pub tip: f64,
    /// Largest error of the hub angle, over its peak; for an arm the error of any joint over the largest turn of any.
    pub hub_angle: f64,
}

impl PlayError {
    /// Plays the torque of a linear link again on elements of half the length and measures the change. Uses all modes
    /// that the torque moves there; where a limit cut the first selection, up to twice that limit.
    ///
    /// Takes about as long as the simulation, and no memory. `None` where such elements do not allow the damping law.
    /// At large angles the errors are the changes by the last refinement.
    ///
    /// # Errors
    /// As [`simulate`](super::simulate).
    pub fn of(
        played: &Played,
        arm: &Arm,
        play: &Play<'_>,
    ) -> Result<Option<Self>, SimulationError> {
        let travel_m = played.largest_travel_m();
        let turned = |joint: &JointMotion| -> Vec<f64> {
            joint.angle_rad.iter().map(|angle| angle - joint.angle_rad[0]).collect()
        };
        let share = |error: f64, whole: f64| if error == 0.0 { 0.0 } else { error / whole };
        let modes = match &played.by {
            PlayedBy::Modes(modes) => modes,
            PlayedBy::Elastica(bent) => {
                let [tip_m, joint_rad] = bent.change;
                let turn_rad = bent.largest_turn_rad(&played.joints);
                return Ok(Some(Self {
                    tip: share(tip_m, travel_m),
                    hub_angle: share(joint_rad, turn_rad),
                }));
            }
        };
        let (link, tip, grid) = (&arm.links()[0].link, &played.tip[0], &played.grid);
        let (start_m, turned) = (tip.displacement_m[0], turned(played.hub()));
        let mesh = played.mesh().refined();
        let Ok(law) = DampingLaw::of(link, &mesh) else { return Ok(None) };
        let were_cut = modes.selection.modes >= MOST_MODES;
        let most_modes = if were_cut { 2 * MOST_MODES } else { MOST_MODES };
        let (basis, _) = kept_modes(&mesh, modes.band_rad_s, most_modes);
        let losses = modes.equations.losses;
        let equations = Equations { losses, ..play.equations(link, (&mesh, &law), basis)? };
        let driving = play.driving((0, link), play.zero_of_state_rad(link), link.has_weight())?;
        let mut played_samples = tip.displacement_m.iter().zip(&turned);
        let (mut tip_m, mut hub_rad) = (0.0_f64, 0.0_f64);
        let ([q, rates], _) = play.start(link, (&equations, &mesh), &driving)?;
        let stepper = Stepper::new(&equations, grid.step_s).starting_at(&q, &rates);
        let (first_m, first_rad) =
            (equations.tip(&stepper.coordinates()), equations.hub(&stepper.coordinates()));
        stepper.run(driving.steps(grid.len), |stepper| {
            let q = stepper.coordinates();
            let Some((displacement_m, turned_rad)) = played_samples.next() else { return };
            let (own_m, own_rad) = (equations.tip(&q) - first_m, equations.hub(&q) - first_rad);
            tip_m = tip_m.max((own_m - (displacement_m - start_m)).abs());
            hub_rad = hub_rad.max((own_rad - turned_rad).abs());
        });
        let per_change = mesh.error_per_change();
        let tip = per_change * share(tip_m, travel_m);
        let hub_angle = per_change * share(hub_rad, largest(&turned));
        Ok(Some(Self { tip, hub_angle }))
    }

    /// A warning if the errors are large.
    pub fn warning(&self, played: &Played) -> Option<SimulationWarning> {
        let Self { tip, hub_angle } = *self;
        match &played.by {
            PlayedBy::Modes(_) => (tip.max(hub_angle) > COARSE)
                .then_some(SimulationWarning::CoarseMesh { tip, hub_angle }),
            PlayedBy::Elastica(bent) => {
                let is_arm = played.joints.len() > 1;
                let warning = SimulationWarning::Unsettled { tip, hub_angle, is_arm };
                bent.is_unsettled.then_some(warning)
            }
        }
    }
}

/// Warning threshold of the imbalance of energy.
const IMBALANCE: f64 = 1e-3;

/// Warnings of a link with weight or at large angles, or of an arm.
pub(super) fn of_bent(
    arm: &Arm,
    (play, grid): (&Play<'_>, &TimeGrid),
    motion: &BentMotion,
    first: &PlayedLink,
) -> Vec<SimulationWarning> {
    let is_link = arm.links().len() == 1;
    let mut warnings = match play.input {
        Input::Torques(torques)
            if play.cycle_turn_rad.is_none() && (arm.has_weight() || !is_link) =>
        {
            of_torques(arm, torques, play, motion)
        }
        _ => play.warnings_of_input((grid, &motion.joints[0].torque_n_m)),
    };
    let share = first.outward_m_s2.map(|own| buckling_share(&first.mesh, own));
    if let Some(share) = share.filter(|share| *share >= 1.0) {
        warnings.push(SimulationWarning::Falls { share });
    } else if is_link {
        let period_s = first.first_rad_s().map(|omega| TAU / omega);
        // Bent links move until the end, so that the step always matters.
        warnings.extend(SimulationWarning::coarse_step(play.input.grid().step_s, period_s));
    }
    if play.lossy(arm).next().is_some() {
        warnings.extend(SimulationWarning::coarse_losses(motion.changed()));
    }
    let share = motion.play.imbalance();
    warnings.extend((share > IMBALANCE).then_some(SimulationWarning::Imbalance { share }));
    warnings
}

/// Warnings of torques that begin apart from the holding torques, or end with a jump, and of references apart from the
/// joints.
fn of_torques(
    arm: &Arm,
    torques: &[Torque],
    play: &Play<'_>,
    motion: &BentMotion,
) -> Vec<SimulationWarning> {
    let drive_of = |number: usize| play.lossy(arm).find(|(own, ..)| *own == number);
    // At rest a gear with losses still takes a part of the torque.
    let in_front = |number: usize, along: f64| {
        let holding_n_m = motion.joints[number].holding_n_m.unwrap_or_default();
        let lossy = |drive: &Drive| drive.with_losses(holding_n_m, along).torque;
        drive_of(number).map_or(holding_n_m, |(.., drive)| lossy(drive))
    };
    let holding = (0..motion.joints.len()).map(|number| in_front(number, 0.0));
    // The torques of all links have one size; the force of their carriage has its own.
    let size = |joints: std::ops::Range<usize>| {
        let least = arm.weight_moment_n_m() / motion.play.linkage.size_of(joints.start);
        let own = torques.iter().zip(holding.clone()).skip(joints.start).take(joints.len());
        let [range, most] = own.fold([0.0_f64; 2], |[range, most], (torque, holding_n_m)| {
            let [low, high] = extremes(torque.torque_n_m());
            [range.max(high - low), most.max(holding_n_m.abs())]
        });
        // The holding torque of a link that hangs straight is round-off.
        if range > 0.0 { range } else { most }.max(STEP_SHARE * STEP_SHARE * least)
    };
    let links = arm.links().len();
    let sizes = [size(0..links), size(links..torques.len())];
    let starts_at_rest = play.state.is_none();
    let mut warnings = Vec::new();
    for (number, (torque, holding_n_m)) in torques.iter().zip(holding.clone()).enumerate() {
        let size = sizes[usize::from(number >= links)];
        let samples_n_m = torque.torque_n_m();
        let joint = arm.number_of(number).map(|number| number + 1);
        let torque_n_m = samples_n_m[0];
        // Between these the losses hold the joint.
        let [low, high] = [-1.0, 1.0].map(|along| in_front(number, along));
        let share = (low - torque_n_m).max(torque_n_m - high).max(0.0) / size;
        if starts_at_rest && share > STEP_SHARE {
            let begins = SimulationWarning::BeginsUnheld { joint, torque_n_m, holding_n_m, share };
            warnings.push(begins);
        }
        let torque_n_m = samples_n_m[samples_n_m.len() - 1];
        let share = torque_n_m.abs() / size;
        if !arm.has_weight() && share > STEP_SHARE {
            warnings.push(SimulationWarning::EndsWithJump { joint, torque_n_m, share });
        }
        let hub_rad = motion.joints[number].angle_rad[0];
        let reference = play.feedback.get(number).map(|of| of.reference().angle_rad()[0]);
        let apart = reference.filter(|at| starts_at_rest && (at - hub_rad).abs() > APART_RAD);
        warnings.extend(apart.map(|reference_rad| SimulationWarning::ReferenceApart {
            joint,
            reference_rad,
            hub_rad,
        }));
    }
    warnings
}
