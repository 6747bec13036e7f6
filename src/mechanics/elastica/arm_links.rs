//! Links on their chords, from the last inward, with the next link's load on its tip.

use std::sync::Arc;

use num_complex::Complex64;
use rayon::prelude::*;

use super::chord::{ChordHistories, ChordPeriod, TipLoad, resolved};
use super::error::ElasticaError;
use super::kinematics::{ArmPeriod, Bar, Moving, axes};
use super::loads::SecondOrder;
use super::on_chord::{LinkOnChord, REACH, check, is_undamped};
use super::reaction::{ArmLinkMotion, ArmMotion, Iteration, apart, band, joint_rates, size};
use super::sag::Sag;
use crate::beam::LoadedMotion;
use crate::modal::{DampingLaw, WeighedLink};
use crate::model::Model;
use crate::numeric::{FourierPair, Size, magnitude};

/// Round-off of the torque of one joint, over the largest torque amplitude of any joint.
const ROUND_OFF: f64 = 1e-12;

/// Share of the torques, all added up, beyond the frequencies that samples must resolve: the answer of the links to
/// accelerations that the period leaves out.
const LEFT_OUT: f64 = 1e-12;

/// Amplitudes of the answer of each link.
pub(super) type Answers = Vec<Vec<LoadedMotion<Complex64>>>;

pub(super) struct Follower<'a> {
    pub(super) models: &'a [Arc<dyn Model>],
    /// Period of the wanted motion.
    whole: &'a ArmPeriod,
    /// The period with every `stride`-th sample, enough for the motion.
    pub(super) arm: ArmPeriod,
    pub(super) stride: usize,
    pub(super) second_order: SecondOrder,
    /// Damping ratio and sag of each link, if hysteretic links have weight.
    pub(super) sags: Vec<(f64, Sag)>,
    /// The link with the weight along it, if it keeps its direction and its second-order terms count. Damping keeps the
    /// digits of its elimination at a resonance.
    weighed: Option<WeighedLink>,
    /// Amplitude of a torque in N m below which it may be round-off of the largest.
    pub(super) round_off_n_m: f64,
}

/// Motion of each link over the period, and the force on its inner end along its chord and across it.
#[derive(Clone)]
pub(super) struct State {
    pub(super) chords: Vec<ChordPeriod>,
    pub(super) forces_n: Vec<[Vec<f64>; 2]>,
    pub(super) shortened: Option<Shortened>,
}

/// Shortening of each chord relative to its link.
#[derive(Clone)]
pub(super) struct Shortened {
    /// Shortening in m at the samples of the pair.
    pub(super) by_m: Vec<Vec<f64>>,
    pub(super) pair: FourierPair,
    /// Number of bins in use.
    pub(super) bins: usize,
}

/// The bars of an arm at one sample, with the acceleration of each inner end along the bar and across it.
type Bars = Vec<(Bar, [f64; 2])>;

/// The linear answer, or that of an iteration.
#[derive(Clone)]
pub(super) struct Iterate {
    pub(super) state: State,
    pub(super) answers: Answers,
    /// Torques of the joints. A link that slides has its place from the chord, too, as [`LinkOnChord::place`]: the force on
    /// its carriage at rest is the same for every shape.
    pub(super) torques_n_m: Vec<Vec<f64>>,
    /// Terms of the answer.
    pub(super) order: SecondOrder,
    /// Largest slope in the loads of one link.
    pub(super) largest_slope: Option<f64>,
    pub(super) iteration: Iteration,
    /// Other approximations; the factor on the distance from this one gives the change by further terms.
    pub(super) others: Vec<(Answers, f64)>,
}

impl State {
    /// Largest change in N of the force on the first link from another state.
    pub(super) fn reaction_apart_n(&self, other: &Self) -> f64 {
        let apart = (0..self.forces_n[0][0].len()).map(|k| {
            let [[ax, ay], [bx, by]] = [self, other].map(|own| own.in_plane_n(0, k));
            libm::hypot(ax - bx, ay - by)
        });
        apart.fold(0.0, Size::larger)
    }

    /// Force on the inner end of a link at a sample along x and y. `forces_n` begins with this link.
    fn in_plane_n(&self, link: usize, k: usize) -> [f64; 2] {
        let ([e, n], [along_n, across_n]) =
            (axes(self.chords[link].angle_rad[k]), &self.forces_n[0]);
        [0, 1].map(|axis| along_n[k] * e[axis] + across_n[k] * n[axis])
    }

    /// Stores the force on the inner end of a link, along its chord and across it, and passes it and the torque to the
    /// link before.
    pub(super) fn hand_inward(&mut self, link: usize, forces_n: [Vec<f64>; 2], torque_n_m: &[f64]) {
        self.forces_n.insert(0, forces_n);
        let Some(before) = link.checked_sub(1) else { return };
        let on_tip = (0..torque_n_m.len()).map(|k| {
            let force = self.in_plane_n(link, k);
            axes(self.chords[before].angle_rad[k])
                .map(|unit| -(force[0] * unit[0] + force[1] * unit[1]))
        });
        let (along_n, across_n) = on_tip.map(|[along, across]| (along, across)).unzip();
        let torque_n_m = torque_n_m.to_vec();
        self.chords[before].load_tip(TipLoad { along_n, across_n, torque_n_m });
    }
}

impl<'a> Follower<'a> {
    /// Checks the links, and solves them without second-order terms. It uses `fewest` samples of the period, or more if
    /// the solution or its loads need them, up to a negligible share of the torques.
    pub(super) fn of(
        models: &'a [Arc<dyn Model>],
        whole: &'a ArmPeriod,
        second_order: SecondOrder,
        (fewest, negligible): (usize, Option<f64>),
    ) -> Result<(Self, Iterate), ElasticaError> {
        assert!(models.len() == whole.links(), "a model for each chord");
        let mut fewest = fewest.max(whole.fewest);
        loop {
            let stride = whole.stride_to(fewest);
            let arm = whole.thinned(stride);
            fewest = 2 * arm.len();
            let (sags, weighed, round_off_n_m) = (Vec::new(), None, 0.0);
            let mut follower =
                Self { models, whole, arm, stride, second_order, sags, weighed, round_off_n_m };
            match follower.solved() {
                Ok(linear) if stride == 1 || follower.resolves(&linear, negligible) => {
                    return Ok((follower, linear));
                }
                Err(error) if !follower.needs_more(&error) => return Err(follower.placed(error)),
                _ => {}
            }
        }
    }

    /// Attributes an error to one of several links.
    pub(super) fn of_link(&self, link: usize, error: ElasticaError) -> ElasticaError {
        if self.models.len() > 1 { error.of_link(link) } else { error }
    }

    /// True if more samples may remove the error.
    pub(super) fn needs_more(&self, error: &ElasticaError) -> bool {
        self.stride > 1 && error.is_of_step()
    }

    /// Converts the sample number of an error to the whole period.
    pub(super) fn placed(&self, error: ElasticaError) -> ElasticaError {
        match error {
            ElasticaError::Elbow { sample, sine } => {
                ElasticaError::Elbow { sample: sample * self.stride, sine }
            }
            error => error,
        }
    }

    /// True if the samples resolve these torques, and loads up to a negligible share of the torques.
    fn resolves(&self, linear: &Iterate, negligible: Option<f64>) -> bool {
        let most = resolved(&self.arm.pair);
        self.band(&linear.answers, LEFT_OUT) <= most
            && negligible.is_none_or(|share| REACH * self.band(&linear.answers, share) <= most)
    }

    /// Number of bins beyond which a share of the torques is negligible.
    pub(super) fn band(&self, answers: &Answers, negligible: f64) -> usize {
        let band_of = |(answers, model): (&Vec<LoadedMotion<Complex64>>, &Arc<dyn Model>)| {
            band(answers, negligible, (model.mesh(), self.round_off_n_m))
        };
        answers.iter().zip(self.models).map(band_of).fold(1, usize::max)
    }

    /// Checks the links, and solves them without second-order terms.
    fn solved(&mut self) -> Result<Iterate, ElasticaError> {
        let (models, state) = (self.models, self.chords(None)?);
        let has_weight = self.arm.gravity_m_s2.iter().any(|part| *part != 0.0);
        let is_exact = self.second_order != SecondOrder::None || has_weight || models.len() > 1;
        for (link, (model, chord)) in models.iter().zip(&state.chords).enumerate() {
            check(&**model, chord, is_exact).map_err(|error| match error {
                error @ ElasticaError::NotDerived { .. } => self.of_link(link, error),
                error => error,
            })?;
        }
        let ratio = |model: &Arc<dyn Model>| match model.law() {
            DampingLaw::Hysteretic { ratio } => *ratio,
            _ => 0.0,
        };
        let ratios: Vec<f64> = models.iter().map(ratio).collect();
        if has_weight && ratios.iter().any(|ratio| *ratio > 0.0) {
            let sags = Sag::of_arm(models, &self.arm, self.second_order)?;
            self.sags = ratios.into_iter().zip(sags).collect();
        }
        let linear = self.linear(state)?;
        let own = &models[0];
        let is_weighed = self.second_order != SecondOrder::None && !is_undamped(own.law());
        let outward_m_s2 = own.link().outward_m_s2().filter(|_| is_weighed);
        self.weighed = outward_m_s2.and_then(|outward| WeighedLink::of(own.mesh(), outward));
        // The torque of one link has no round-off of a next link's load.
        if models.len() > 1 {
            let amplitudes = linear.answers.iter().flatten();
            let amplitudes = amplitudes.map(|answer| magnitude(answer.torque_n_m));
            self.round_off_n_m = ROUND_OFF * amplitudes.fold(0.0, f64::max);
        }
        Ok(linear)
    }

    pub(super) fn on_chord<'b>(&'b self, link: usize, chord: &'b ChordPeriod) -> LinkOnChord<'b> {
        let model = &*self.models[link];
        let sag = self.sags.get(link).map(|(ratio, sag)| (*ratio, sag));
        let round_off_n_m = self.round_off_n_m;
        // The friction of several links acts between them, that of a carriage on its motion with the chord.
        let is_turning = self.models.len() == 1 && !self.arm.slides();
        let friction_n_m_s_rad = if is_turning { model.link().joint().friction() } else { 0.0 };
        let weighed = self.weighed.as_ref();
        LinkOnChord { model, chord, sag, weighed, friction_n_m_s_rad, round_off_n_m }
    }

    /// The bars of an arm, with shortened links, at each sample of a period.
    fn bars(
        &self,
        arm: &ArmPeriod,
        shortened: Option<&Shortened>,
    ) -> Result<Vec<Bars>, ElasticaError> {
        let rigid: Vec<Moving> =
            self.models.iter().map(|model| [model.mesh().output_m(), 0.0, 0.0]).collect();
        let by_m = shortened.map(|Shortened { by_m, pair, bins }| {
            let derived = |few: &Vec<f64>, derived| arm.at_all(pair, few, *bins, derived);
            by_m.iter().map(|few| [0, 1, 2].map(|order| derived(few, order))).collect::<Vec<_>>()
        });
        let at = |sample: usize| {
            let length_of = |link: usize| {
                let by_m = |order: usize| by_m.as_ref().map_or(0.0, |by| by[link][order][sample]);
                [0, 1, 2].map(|order: usize| rigid[link][order] - by_m(order))
            };
            let lengths: Vec<Moving> = (0..rigid.len()).map(length_of).collect();
            Ok(arm.carried(sample, arm.bars(sample, [&rigid, &lengths])?).collect())
        };
        let samples: Vec<_> = (0..arm.len()).into_par_iter().map(at).collect();
        samples.into_iter().collect()
    }

    /// Histories of every chord, with shortened links.
    pub(super) fn chords(&self, shortened: Option<Shortened>) -> Result<State, ElasticaError> {
        let samples = self.bars(&self.arm, shortened.as_ref())?;
        let pair = &self.arm.pair;
        let chords = (0..self.models.len()).map(|link| {
            let history = |of: fn(&(Bar, [f64; 2])) -> f64| -> Vec<f64> {
                samples.iter().map(|bars| of(&bars[link])).collect()
            };
            let histories = ChordHistories {
                rate_rad_s: history(|(bar, _)| bar.angle_rad[1]),
                acceleration_rad_s2: history(|(bar, _)| bar.angle_rad[2]),
                along_m_s2: history(|(_, [along, _])| *along),
                across_m_s2: history(|(_, [_, across])| *across),
                tip: None,
            };
            let angle_rad = history(|(bar, _)| bar.angle_rad[0]);
            ChordPeriod::of(pair.clone(), self.arm.step_s, angle_rad, histories)
        });
        Ok(State { chords: chords.collect(), forces_n: Vec::new(), shortened })
    }

    /// All links, solved without second-order terms.
    fn linear(&self, mut state: State) -> Result<Iterate, ElasticaError> {
        let (mut answers, mut torques_n_m) = (Vec::new(), Vec::new());
        for link in (0..self.arm.links()).rev() {
            let on_chord = self.on_chord(link, &state.chords[link]);
            let link_answers = on_chord.linear().map_err(|error| self.of_link(link, error))?;
            let (pair, chord) = (&self.arm.pair, &state.chords[link].histories);
            let (torque_n_m, slope) = on_chord.hub(&link_answers, SecondOrder::None, pair, chord);
            let forces_n = on_chord.linear_ends(&link_answers);
            let place = on_chord.place(slope);
            state.hand_inward(link, forces_n, &torque_n_m);
            answers.insert(0, link_answers);
            torques_n_m.insert(0, torque_n_m);
            torques_n_m.extend(place);
        }
        Ok(Iterate {
            state,
            answers,
            torques_n_m,
            order: SecondOrder::None,
            largest_slope: None,
            iteration: Iteration::default(),
            others: Vec::new(),
        })
    }

    /// Largest difference of torques, each relative to its size.
    pub(super) fn largest_change(&self, torques_n_m: &[Vec<f64>], others: &[Vec<f64>]) -> f64 {
        let models = self.models.iter().chain(self.models.last());
        let pairs = torques_n_m.iter().zip(others).zip(models);
        let changes =
            pairs.map(|((torque, other), model)| apart(torque, other) / size(torque, model.mesh()));
        changes.fold(0.0, f64::larger)
    }

    /// Histories of a result over the whole period; with `nodes`, only of these nodes of each link.
    ///
    /// # Errors
    /// [`ElasticaError::Elbow`] or [`ElasticaError::Diverges`] between the samples that resolved the motion.
    pub(super) fn motion(
        &self,
        Iterate { state, answers, order, largest_slope, iteration, others, .. }: Iterate,
        nodes: Option<&[Vec<usize>]>,
    ) -> Result<ArmMotion, ElasticaError> {
        let pair = &self.whole.pair;
        let Iteration { iterations, error, .. } = iteration;
        let bars = self.bars(self.whole, state.shortened.as_ref());
        // If the pose was possible before the links bent, the iteration made it impossible.
        let bars = bars.map_err(|refused| match state.shortened {
            Some(_) => refused.diverging(iterations, error),
            None => refused,
        })?;
        let of_link = |link: usize| {
            let nodes = nodes.map(|nodes| &nodes[link][..]);
            let on_chord = self.on_chord(link, &state.chords[link]);
            let mut bent = on_chord.motion(&answers[link], order, (pair, nodes));
            bent.largest_slope = largest_slope.unwrap_or(bent.largest_slope);
            let slope = bent.deflections.last().into_iter().flatten();
            let tip_slope_rad = match order {
                SecondOrder::Full => slope.map(|sine| libm::asin(*sine)).collect(),
                _ => slope.copied().collect(),
            };
            let history = |of: &dyn Fn(&Bar) -> f64| -> Vec<f64> {
                bars.iter().map(|bars| of(&bars[link].0)).collect()
            };
            // Converts to x and y only here: chords that turn together make this conversion the fastest.
            let [along_n, across_n] = state.forces_n[link].each_ref().map(|few| self.at_whole(few));
            let parts = along_n.iter().zip(&across_n).zip(&bars);
            let forces_n: Vec<[f64; 2]> = parts
                .map(|((along_n, across_n), bars)| {
                    let [e, n] = bars[link].0.axes();
                    [0, 1].map(|axis| along_n * e[axis] + across_n * n[axis])
                })
                .collect();
            let mut chord_length_m = history(&|bar| bar.length_m[0]);
            if state.shortened.is_none() {
                let output = self.models[link].mesh().output();
                let shortened = bent.shortenings_m.get(output).into_iter().flatten();
                chord_length_m.iter_mut().zip(shortened).for_each(|(length, own)| *length += own);
            }
            ArmLinkMotion {
                bent,
                chord: if self.whole.slides() {
                    self.whole.rigid[link].clone()
                } else {
                    [0, 1, 2].map(|order: usize| history(&|bar| bar.angle_rad[order]))
                },
                chord_length_m,
                tip_slope_rad,
                force_n: [0, 1].map(|axis| forces_n.iter().map(|force| force[axis]).collect()),
            }
        };
        let mut links: Vec<_> = (0..self.models.len()).into_par_iter().map(of_link).collect();
        for link in 0..links.len() {
            let friction = self.models[link].link().joint().friction();
            if friction > 0.0 && (links.len() > 1 || self.whole.slides()) {
                let rates = joint_rates(&links, link, self.whole);
                let torques = links[link].bent.torque_n_m.iter_mut().zip(rates);
                torques.for_each(|(torque, rate)| *torque += friction * rate);
            }
        }
        Ok(ArmMotion { links, iteration, second_order: order, others })
    }

    /// Interpolates a history to the whole period.
    fn at_whole(&self, few: &[f64]) -> Vec<f64> {
        match self.stride {
            1 => few.to_vec(),
            // Omits the Nyquist frequency, which lies inside a longer spectrum.
            _ => self.whole.pair.samples(&self.arm.pair.amplitudes(few)[..self.arm.len() / 2]),
        }
    }
}

impl ArmMotion {
    /// Other approximations of the motion of an arm of one link. The factor on the distance from this motion gives the
    /// change by further iterations, or by terms of more frequencies.
    ///
    /// # Errors
    /// [`ElasticaError`].
    pub(crate) fn others(
        &self,
        models: &[Arc<dyn Model>],
        whole: &ArmPeriod,
    ) -> Result<Vec<(Self, f64)>, ElasticaError> {
        let (arm, second_order, sags) = (whole.clone(), self.second_order, Vec::new());
        let follower = Follower {
            models,
            whole,
            arm,
            stride: 1,
            second_order,
            sags,
            weighed: None,
            round_off_n_m: 0.0,
        };
        let mut state = follower.chords(None)?;
        state.forces_n.resize(models.len(), <_>::default());
        let other = |(answers, factor): &(Answers, f64)| {
            let iterate = Iterate {
                state: state.clone(),
                answers: vec![answers[0].clone()],
                torques_n_m: Vec::new(),
                order: second_order,
                largest_slope: None,
                iteration: self.iteration,
                others: Vec::new(),
            };
            Ok((follower.motion(iterate, None)?, *factor))
        };
        self.others.iter().map(other).collect()
    }
}
