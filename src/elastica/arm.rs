//! Arms of several links: each on its chord, from the last inward, with what the next one does to its tip.

use std::sync::Arc;

use num_complex::Complex64;

use super::chord::{ChordHistories, ChordPeriod, TipLoad, resolved};
use super::error::{ElasticaError, FINEST};
use super::iteration::{MOST_ITERATIONS, REACH, check, factor_of, further, over_widest_band};
use super::kinematics::{ArmPeriod, Moving, axes};
use super::loads::{BentLink, SecondOrder};
use super::on_chord::LinkOnChord;
use super::reaction::{ArmLinkMotion, ArmMotion, Iteration, apart, band, joint_rates, size};
use super::sag::Sag;
use crate::beam::LoadedMotion;
use crate::modal::DampingLaw;
use crate::model::Model;
use crate::numeric::{FourierPair, Size, magnitude};

/// Shares of the torques that are negligible of the loads, and of what links that shorten move the chords by, which grows
/// with the square of the frequency; then how many times the bins up to there. What a link shortens by is a square of
/// deflections, so that it reaches twice as far; what does not converge is tried with less.
const LEVELS: [(f64, f64, usize); 7] = [
    (1e-8, 1e-10, 2),
    (1e-8, 1e-10, 1),
    (1e-8, 1e-8, 1),
    (1e-6, 1e-6, 1),
    (1e-5, 1e-5, 1),
    (1e-4, 1e-4, 1),
    (1e-3, 1e-3, 1),
];

/// Share of what is negligible up to which chords are moved once, to see what that changes.
const BEYOND: f64 = 1e-4;

/// Round-off of the torque of one joint, over the largest amplitude of any.
const ROUND_OFF: f64 = 1e-12;

/// Iterations after which the error of the next ones follows from their factor.
const FEWEST_ITERATIONS: usize = 3;

/// Amplitudes of the answer of each link.
type Answers = Vec<Vec<LoadedMotion<Complex64>>>;

/// Finds the torques with which the chords of an arm move as given, or its tip stays on its path.
///
/// Torque i turns link i counterclockwise, and its reaction link i − 1.
///
/// # Errors
/// [`ElasticaError`].
///
/// # Panics
/// If there are not as many models as chords.
pub fn follow_arm(
    models: &[Arc<dyn Model>],
    arm: &ArmPeriod,
    second_order: SecondOrder,
    tolerance: f64,
) -> Result<ArmMotion, ElasticaError> {
    assert!(models.len() == arm.links(), "a model for each chord");
    if !(FINEST..1.0).contains(&tolerance) {
        return Err(ElasticaError::Tolerance(tolerance));
    }
    let mut follower = Follower { models, arm, second_order, sags: Vec::new(), round_off_n_m: 0.0 };
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
    if second_order == SecondOrder::None {
        let links = follower.links(&linear.answers, &linear.state);
        return Ok(ArmMotion { links, iteration: Iteration::default() });
    }
    over_widest_band(
        &LEVELS,
        |level| follower.iterated_over(&linear, tolerance, level),
        |motion, narrower| {
            let torques = motion.links.iter().map(|link| &link.bent.torque_n_m);
            let others: Vec<_> =
                narrower.links.into_iter().map(|link| link.bent.torque_n_m).collect();
            motion.iteration.error += follower.largest_change(torques, &others);
        },
    )
}

struct Follower<'a> {
    models: &'a [Arc<dyn Model>],
    arm: &'a ArmPeriod,
    second_order: SecondOrder,
    /// Damping ratio and sag of each link, where hysteretic ones have weight.
    sags: Vec<(f64, Sag)>,
    /// Amplitude of a torque in N m that may be round-off of the largest.
    round_off_n_m: f64,
}

/// What moves each link over the period, and the force on its inner end along x and y.
struct State {
    chords: Vec<ChordPeriod>,
    lengths_m: Vec<Vec<f64>>,
    forces_n: Vec<[Vec<f64>; 2]>,
}

/// What one iteration hands to the next.
struct Iterate {
    answers: Answers,
    torques_n_m: Vec<Vec<f64>>,
    shortened: Option<Shortened>,
}

/// How much shorter than its link each chord is in m, at the samples of a pair.
type Shortened = (FourierPair, Vec<Vec<f64>>);

struct Linear {
    answers: Answers,
    torques_n_m: Vec<Vec<f64>>,
    state: State,
}

impl State {
    /// Stores the force on the inner end of a link, along its chord and across it, and gives it and the torque to the
    /// link before.
    fn hand_inward(
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

impl Follower<'_> {
    fn on_chord<'b>(&'b self, link: usize, chord: &'b ChordPeriod) -> LinkOnChord<'b> {
        let model = &*self.models[link];
        let sag = self.sags.get(link).map(|(ratio, sag)| (*ratio, sag));
        let round_off_n_m = self.round_off_n_m;
        LinkOnChord { model, chord, sag, friction_n_m_s_rad: 0.0, round_off_n_m }
    }

    /// The histories of every chord; `shortened` is by how much each is shorter than its link, with its derivatives.
    fn chords(&self, shortened: &[[Vec<f64>; 3]]) -> Result<State, ElasticaError> {
        let len = self.arm.pair.len();
        let rigid: Vec<Moving> =
            self.models.iter().map(|model| [model.mesh().length_m(), 0.0, 0.0]).collect();
        let empty = || ChordHistories {
            rate_rad_s: Vec::with_capacity(len),
            acceleration_rad_s2: Vec::with_capacity(len),
            along_m_s2: Vec::with_capacity(len),
            across_m_s2: Vec::with_capacity(len),
            tip: None,
        };
        let mut histories: Vec<_> = rigid.iter().map(|_| empty()).collect();
        let mut angles = vec![Vec::with_capacity(len); rigid.len()];
        let mut lengths_m = angles.clone();
        for sample in 0..len {
            let own = |(rigid, by): (&Moving, &[Vec<f64>; 3])| {
                [0, 1, 2].map(|order| rigid[order] - by[order][sample])
            };
            let lengths: Vec<Moving> = rigid.iter().zip(shortened).map(own).collect();
            let bars = self.arm.bars(sample, [&rigid, &lengths])?;
            // Gravity is an upward acceleration of the first axis.
            let mut axis = self.arm.gravity_m_s2.map(|part| -part);
            for (link, bar) in bars.iter().enumerate() {
                let [along, across] = bar.axes();
                let onto = |unit: [f64; 2]| axis[0] * unit[0] + axis[1] * unit[1];
                let of = &mut histories[link];
                of.rate_rad_s.push(bar.angle_rad[1]);
                of.acceleration_rad_s2.push(bar.angle_rad[2]);
                of.along_m_s2.push(onto(along));
                of.across_m_s2.push(onto(across));
                angles[link].push(bar.angle_rad[0]);
                lengths_m[link].push(bar.length_m[0]);
                let [_, _, further] = bar.vector();
                axis = [axis[0] + further[0], axis[1] + further[1]];
            }
        }
        let (pair, place) = (&self.arm.pair, self.arm.gravity_m_s2);
        let chords = angles.into_iter().zip(histories).map(|(angle, histories)| {
            ChordPeriod::of(pair.clone(), self.arm.step_s, (angle, place), histories)
        });
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

    /// The motion over the band of loads beyond which a share of the torques is negligible.
    fn iterated_over(
        &self,
        linear: &Linear,
        tolerance: f64,
        (negligible, moved, times): (f64, f64, usize),
    ) -> Result<ArmMotion, ElasticaError> {
        let of_all = |answers: &Answers, negligible: f64| {
            let bands = answers.iter().enumerate().map(|(link, answers)| {
                self.on_chord(link, &linear.state.chords[link]).band_of_loads(answers, negligible)
            });
            bands.collect::<Result<Vec<_>, _>>().map(|bands| bands.into_iter().fold(1, usize::max))
        };
        let linear_band = |negligible: f64| {
            let pairs = linear.answers.iter().zip(self.models);
            let bands = pairs.map(|(answers, model)| {
                band(answers, negligible, (model.mesh(), self.round_off_n_m))
            });
            bands.fold(1, usize::max)
        };
        let moving = times * linear_band(moved);
        let mut band = of_all(&linear.answers, negligible)?;
        let mut latest = Iterate {
            answers: linear.answers.clone(),
            torques_n_m: linear.torques_n_m.clone(),
            shortened: None,
        };
        let (mut last_change, mut last_factor) = (f64::INFINITY, 0.0);
        for iterations in 1..=MOST_ITERATIONS {
            let pair = linear.state.chords[0].pair_for(REACH * band);
            let swept = self.swept(linear, &latest, (&pair, band, moving));
            let diverges = |error: ElasticaError, change| match error {
                // The first iteration has the path's own pose and the linear slopes.
                error if iterations == 1 => error,
                error => error.diverging(iterations, change),
            };
            let (state, next) = swept.map_err(|error| diverges(error, last_change))?;
            let change = self.largest_change(next.torques_n_m.iter(), &latest.torques_n_m);
            latest = next;
            let reach = of_all(&latest.answers, negligible);
            band = band.max(reach.map_err(|error| error.diverging(iterations, change))?);
            let factor = factor_of([last_change, change], iterations, (tolerance, negligible))?;
            let contraction = (iterations > 1).then_some(factor);
            // Shortened links move the chords from the second iteration on: the second factor is none yet.
            let error = further(change, factor.max(last_factor));
            if iterations > FEWEST_ITERATIONS && error <= tolerance {
                // The chords moved at more frequencies, once.
                let reach = (&pair, band, REACH * linear_band(BEYOND * negligible));
                let wider = self.swept(linear, &latest, reach);
                let (_, wider) = wider.map_err(|error| diverges(error, change))?;
                let unmoved = self.largest_change(wider.torques_n_m.iter(), &latest.torques_n_m);
                let torques = latest.torques_n_m.iter();
                let second_order_change = self.largest_change(torques, &linear.torques_n_m);
                let iteration = Iteration {
                    iterations,
                    contraction,
                    error: error + unmoved,
                    second_order_change,
                    exceeds_step: REACH * band > resolved(&self.arm.pair),
                };
                return Ok(ArmMotion { links: self.links(&latest.answers, &state), iteration });
            }
            (last_change, last_factor) = (change, factor);
        }
        Err(ElasticaError::Diverges { iterations: MOST_ITERATIONS, change: last_change })
    }

    /// Largest difference of torques, each over its size.
    fn largest_change<'b>(
        &self,
        torques_n_m: impl Iterator<Item = &'b Vec<f64>>,
        others: &[Vec<f64>],
    ) -> f64 {
        let changes = torques_n_m
            .zip(others)
            .zip(self.models)
            .map(|((torque, other), model)| apart(torque, other) / size(torque, model.mesh()));
        changes.fold(0.0, f64::larger)
    }

    /// One iteration: all links from the last inward, each with the loads of its last answer; links that shorten move the
    /// chords in the first bins alone.
    fn swept(
        &self,
        linear: &Linear,
        last: &Iterate,
        (pair, band, moving): (&FourierPair, usize, usize),
    ) -> Result<(State, Iterate), ElasticaError> {
        let (order, bins) = (self.second_order, resolved(pair));
        let mut state = self.chords(&self.shortened(last.shortened.as_ref(), moving))?;
        let (mut answers, mut torques_n_m, mut shortened) = (Vec::new(), Vec::new(), Vec::new());
        for link in (0..self.arm.links()).rev() {
            let on_chord = self.on_chord(link, &state.chords[link]);
            let time = on_chord.chord.at(pair);
            let kept = &last.answers[link][..band.min(last.answers[link].len())];
            let loads = on_chord.loads(&BentLink::of(on_chord.model, order), kept, pair, &time);
            let (loads, _) = loads.map_err(|error| error.of_link(link))?;
            let found = on_chord.with_loads(&linear.answers[link], &loads, pair);
            let few = &found[..bins.min(found.len())];
            let (torque_n_m, _) = on_chord.hub(few, order, pair, &time);
            let [along, across, short] = on_chord.ends(few, order, pair, &time);
            let [torque_n_m, along, across] =
                [torque_n_m, along, across].map(|few| self.arm.at_all(pair, &few, bins, 0));
            state.hand_inward(link, (&along, &across), &torque_n_m);
            answers.insert(0, found);
            torques_n_m.insert(0, torque_n_m);
            shortened.insert(0, short);
        }
        Ok((state, Iterate { answers, torques_n_m, shortened: Some((pair.clone(), shortened)) }))
    }

    /// How much shorter than its link each chord is, with its derivatives; of their amplitudes the first ones count.
    fn shortened(&self, shortened: Option<&Shortened>, moving: usize) -> Vec<[Vec<f64>; 3]> {
        let none = || [0, 1, 2].map(|_| vec![0.0; self.arm.len()]);
        match shortened.filter(|_| self.second_order == SecondOrder::Full) {
            None => self.models.iter().map(|_| none()).collect(),
            Some((pair, shortened)) => shortened
                .iter()
                .map(|few| [0, 1, 2].map(|derived| self.arm.at_all(pair, few, moving, derived)))
                .collect(),
        }
    }

    /// The histories of these answers and chords.
    fn links(&self, answers: &Answers, state: &State) -> Vec<ArmLinkMotion> {
        let mut links: Vec<ArmLinkMotion> = Vec::new();
        for (link, (chord, answers)) in state.chords.iter().zip(answers).enumerate() {
            let bent = self.on_chord(link, chord).motion(answers, self.second_order);
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
        links
    }
}
