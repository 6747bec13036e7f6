//! Arms of several links: each on its chord, from the last inward, with what the next one does to its tip.

use std::sync::Arc;

use num_complex::Complex64;
use rayon::prelude::*;

use super::chord::{ChordHistories, ChordPeriod, TipLoad};
use super::error::ElasticaError;
use super::iteration::check;
use super::kinematics::{ArmPeriod, Moving, axes};
use super::loads::SecondOrder;
use super::on_chord::LinkOnChord;
use super::reaction::{ArmLinkMotion, ArmMotion, Iteration, apart, joint_rates, size};
use super::sag::Sag;
use crate::beam::LoadedMotion;
use crate::modal::DampingLaw;
use crate::model::Model;
use crate::numeric::{FourierPair, Size, magnitude};

/// Round-off of the torque of one joint, over the largest amplitude of any.
const ROUND_OFF: f64 = 1e-12;

/// Amplitudes of the answer of each link.
pub(super) type Answers = Vec<Vec<LoadedMotion<Complex64>>>;

pub(super) struct Follower<'a> {
    pub(super) models: &'a [Arc<dyn Model>],
    pub(super) arm: &'a ArmPeriod,
    pub(super) second_order: SecondOrder,
    /// Damping ratio and sag of each link, where hysteretic ones have weight.
    pub(super) sags: Vec<(f64, Sag)>,
    /// Amplitude of a torque in N m that may be round-off of the largest.
    pub(super) round_off_n_m: f64,
}

/// What moves each link over the period, and the force on its inner end along x and y.
pub(super) struct State {
    pub(super) chords: Vec<ChordPeriod>,
    pub(super) lengths_m: Vec<Vec<f64>>,
    pub(super) forces_n: Vec<[Vec<f64>; 2]>,
}

/// How much shorter than its link each chord is in m, at the samples of a pair.
pub(super) type Shortened = (FourierPair, Vec<Vec<f64>>);

/// What an iteration ends with.
pub(super) struct Found {
    pub(super) state: State,
    pub(super) answers: Answers,
    pub(super) torques_n_m: Vec<Vec<f64>>,
    pub(super) iteration: Iteration,
}

pub(super) struct Linear {
    pub(super) answers: Answers,
    pub(super) torques_n_m: Vec<Vec<f64>>,
    pub(super) state: State,
}

impl State {
    /// Stores the force on the inner end of a link, along its chord and across it, and gives it and the torque to the
    /// link before.
    pub(super) fn hand_inward(
        &mut self,
        link: usize,
        (along_n, across_n): (&[f64], &[f64]),
        torque_n_m: &[f64],
    ) {
        let axes = |link: usize, k: usize| axes(self.chords[link].angle_rad[k]);
        let samples = along_n.iter().zip(across_n).enumerate();
        let forces = samples.map(|(k, (along_n, across_n))| {
            let [e, n] = axes(link, k);
            [0, 1].map(|axis| along_n * e[axis] + across_n * n[axis])
        });
        let forces: Vec<[f64; 2]> = forces.collect();
        self.forces_n.insert(0, [0, 1].map(|axis| forces.iter().map(|f| f[axis]).collect()));
        let Some(before) = link.checked_sub(1) else { return };
        let on_tip = forces.iter().enumerate().map(|(k, force)| {
            axes(before, k).map(|unit| -(force[0] * unit[0] + force[1] * unit[1]))
        });
        let (along_n, across_n) = on_tip.map(|[along, across]| (along, across)).unzip();
        let torque_n_m = torque_n_m.to_vec();
        self.chords[before].load_tip(TipLoad { along_n, across_n, torque_n_m });
    }
}

impl<'a> Follower<'a> {
    /// Checks the links, and solves them without second-order terms.
    pub(super) fn of(
        models: &'a [Arc<dyn Model>],
        arm: &'a ArmPeriod,
        second_order: SecondOrder,
    ) -> Result<(Self, Linear), ElasticaError> {
        assert!(models.len() == arm.links(), "a model for each chord");
        let mut follower = Self { models, arm, second_order, sags: Vec::new(), round_off_n_m: 0.0 };
        let state = follower.chords(&follower.shortened(None, 0))?;
        let has_weight = arm.gravity_m_s2.iter().any(|part| *part != 0.0);
        let is_exact = second_order != SecondOrder::None || has_weight || models.len() > 1;
        for (link, (model, chord)) in models.iter().zip(&state.chords).enumerate() {
            check(&**model, chord, is_exact).map_err(|error| match error {
                error @ ElasticaError::NotDerived { .. } => error.of_link(link),
                error => error,
            })?;
        }
        let ratio = |model: &Arc<dyn Model>| match model.law() {
            DampingLaw::Hysteretic { ratio } => *ratio,
            _ => 0.0,
        };
        let ratios: Vec<f64> = models.iter().map(ratio).collect();
        if has_weight && ratios.iter().any(|ratio| *ratio > 0.0) {
            let sags = Sag::of_arm(models, arm, second_order)?;
            follower.sags = ratios.into_iter().zip(sags).collect();
        }
        let linear = follower.linear(state)?;
        let amplitudes = linear.answers.iter().flatten().map(|answer| magnitude(answer.torque_n_m));
        follower.round_off_n_m = ROUND_OFF * amplitudes.fold(0.0, f64::max);
        Ok((follower, linear))
    }

    pub(super) fn on_chord<'b>(&'b self, link: usize, chord: &'b ChordPeriod) -> LinkOnChord<'b> {
        let model = &*self.models[link];
        let sag = self.sags.get(link).map(|(ratio, sag)| (*ratio, sag));
        let round_off_n_m = self.round_off_n_m;
        LinkOnChord { model, chord, sag, friction_n_m_s_rad: 0.0, round_off_n_m }
    }

    /// The histories of every chord; `shortened` is by how much each is shorter than its link, with its derivatives.
    pub(super) fn chords(&self, shortened: &[[Vec<f64>; 3]]) -> Result<State, ElasticaError> {
        let len = self.arm.pair.len();
        let rigid: Vec<Moving> =
            self.models.iter().map(|model| [model.mesh().length_m(), 0.0, 0.0]).collect();
        // Of each sample and link: direction, length, rate, angular acceleration, acceleration along and across.
        let at = |sample: usize| {
            let own = |(rigid, by): (&Moving, &[Vec<f64>; 3])| {
                [0, 1, 2].map(|order| rigid[order] - by[order][sample])
            };
            let lengths: Vec<Moving> = rigid.iter().zip(shortened).map(own).collect();
            // Gravity is an upward acceleration of the first axis.
            let mut axis = self.arm.gravity_m_s2.map(|part| -part);
            let bars = self.arm.bars(sample, [&rigid, &lengths])?.into_iter().map(|bar| {
                let axes = bar.axes();
                let [along, across] = axes.map(|unit| axis[0] * unit[0] + axis[1] * unit[1]);
                let [_, _, further] = bar.vector(axes);
                axis = [axis[0] + further[0], axis[1] + further[1]];
                let [angle, rate, acceleration] = bar.angle_rad;
                [angle, bar.length_m[0], rate, acceleration, along, across]
            });
            Ok(bars.collect::<Vec<_>>())
        };
        let samples: Vec<_> = (0..len).into_par_iter().map(at).collect();
        let samples = samples.into_iter().collect::<Result<Vec<_>, ElasticaError>>()?;
        let history = |link: usize, part: usize| -> Vec<f64> {
            samples.iter().map(|bars| bars[link][part]).collect()
        };
        let (pair, place) = (&self.arm.pair, self.arm.gravity_m_s2);
        let chords = (0..rigid.len()).map(|link| {
            let histories = ChordHistories {
                rate_rad_s: history(link, 2),
                acceleration_rad_s2: history(link, 3),
                along_m_s2: history(link, 4),
                across_m_s2: history(link, 5),
                tip: None,
            };
            let angle_rad = history(link, 0);
            ChordPeriod::of(pair.clone(), self.arm.step_s, (angle_rad, place), histories)
        });
        let lengths_m = (0..rigid.len()).map(|link| history(link, 1)).collect();
        Ok(State { chords: chords.collect(), lengths_m, forces_n: Vec::new() })
    }

    /// All links without second-order terms.
    fn linear(&self, mut state: State) -> Result<Linear, ElasticaError> {
        let (mut answers, mut torques_n_m) = (Vec::new(), Vec::new());
        for link in (0..self.arm.links()).rev() {
            let on_chord = self.on_chord(link, &state.chords[link]);
            let found = on_chord.linear().map_err(|error| error.of_link(link))?;
            let (pair, chord) = (&self.arm.pair, &state.chords[link].histories);
            let (torque_n_m, _) = on_chord.hub(&found, SecondOrder::None, pair, chord);
            let [along, across] = on_chord.linear_ends(&found);
            state.hand_inward(link, (&along, &across), &torque_n_m);
            answers.insert(0, found);
            torques_n_m.insert(0, torque_n_m);
        }
        Ok(Linear { answers, torques_n_m, state })
    }

    /// Largest difference of torques, each over its size.
    pub(super) fn largest_change(&self, torques_n_m: &[Vec<f64>], others: &[Vec<f64>]) -> f64 {
        let pairs = torques_n_m.iter().zip(others).zip(self.models);
        let changes =
            pairs.map(|((torque, other), model)| apart(torque, other) / size(torque, model.mesh()));
        changes.fold(0.0, f64::larger)
    }

    /// How much shorter than its link each chord is, with its derivatives; of their amplitudes the first ones count.
    pub(super) fn shortened(
        &self,
        shortened: Option<&Shortened>,
        moving: usize,
    ) -> Vec<[Vec<f64>; 3]> {
        let none = || [0, 1, 2].map(|_| vec![0.0; self.arm.len()]);
        match shortened.filter(|_| self.second_order == SecondOrder::Full) {
            None => self.models.iter().map(|_| none()).collect(),
            Some((pair, shortened)) => shortened
                .iter()
                .map(|few| [0, 1, 2].map(|derived| self.arm.at_all(pair, few, moving, derived)))
                .collect(),
        }
    }

    /// The histories of what was found; with `nodes`, of those of each link alone.
    pub(super) fn motion(
        &self,
        Found { state, answers, iteration, .. }: Found,
        nodes: Option<&[Vec<usize>]>,
    ) -> ArmMotion {
        let mut links: Vec<ArmLinkMotion> = Vec::new();
        for (link, (chord, answers)) in state.chords.iter().zip(&answers).enumerate() {
            let nodes = nodes.map(|nodes| &nodes[link][..]);
            let bent = self.on_chord(link, chord).motion(answers, self.second_order, nodes);
            let slope = bent.deflections.last().into_iter().flatten();
            let tip_slope_rad = match self.second_order {
                SecondOrder::Full => slope.map(|sine| libm::asin(*sine)).collect(),
                _ => slope.copied().collect(),
            };
            let ChordHistories { rate_rad_s, acceleration_rad_s2, .. } = &chord.histories;
            links.push(ArmLinkMotion {
                bent,
                chord: [chord.angle_rad.clone(), rate_rad_s.clone(), acceleration_rad_s2.clone()],
                chord_length_m: state.lengths_m[link].clone(),
                tip_slope_rad,
                force_n: state.forces_n[link].clone(),
            });
        }
        for link in 0..links.len() {
            let friction = self.models[link].link().joint().friction_n_m_s_rad;
            if friction > 0.0 {
                let rates = joint_rates(&links, link, self.arm);
                let torques = links[link].bent.torque_n_m.iter_mut().zip(rates);
                torques.for_each(|(torque, rate)| *torque += friction * rate);
            }
        }
        ArmMotion { links, iteration }
    }
}
