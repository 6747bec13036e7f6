//! Arms of one link or several: the iteration of second-order terms, as loads over a band of frequencies.

use std::sync::Arc;

use super::arm_links::{Answers, Follower, Iterate, Shortened, State};
use super::chord::resolved;
use super::error::{ElasticaError, FINEST};
use super::kinematics::ArmPeriod;
use super::loads::{BentLink, SecondOrder};
use super::on_chord::{
    MOST_ITERATIONS, OF_NYQUIST, REACH, factor_of, further, long_step, over_widest_band,
};
use super::reaction::{ArmMotion, Iteration, apart};
use crate::model::Model;
use crate::numeric::FourierPair;

/// Levels of the iteration: negligible share of the torques for the loads, negligible share for the motion of chords by
/// links that shorten, and a factor on the bins of this motion. The motion grows with the square of the frequency, and
/// reaches twice as far because the shortening is a square of deflections. A level that does not converge is followed
/// by one with less.
const LEVELS: [(f64, f64, usize); 7] = [
    (1e-8, 1e-10, 2),
    (1e-8, 1e-10, 1),
    (1e-8, 1e-8, 1),
    (1e-6, 1e-6, 1),
    (1e-5, 1e-5, 1),
    (1e-4, 1e-4, 1),
    (1e-3, 1e-3, 1),
];

/// Number of levels before those that differ by their loads. One link moves no chord when it shortens.
const OF_CHORDS: usize = 2;

/// Levels for torques that need not be exact.
const ESTIMATED: [(f64, f64, usize); 2] = [LEVELS[5], LEVELS[6]];

/// Relative accuracy of an estimate of the second-order change.
const ESTIMATED_TO: f64 = 0.01;

/// Shares of the torque's amplitudes, all added up, at high frequencies whose deflections an estimate of second-order
/// terms leaves out.
const ESTIMATED_BANDS: [f64; 3] = [1e-4, 1e-3, 1e-2];

/// Ratio of the second iteration's change to the first's up to which the second is nearer.
const CONVERGES: f64 = 0.5;

/// Factor on the negligible share for a single wider motion of chords, which shows its effect.
const BEYOND: f64 = 1e-4;

/// Criterion for the end of an iteration.
#[derive(Clone, Copy)]
enum Until {
    /// Further iterations, and chords moved at more frequencies, change the torques by less than this share of the
    /// torques.
    Within(f64),
    /// Further iterations change the torques by less than this share of the second-order change.
    Share(f64),
}

/// Finds the torques that move the chords of an arm as prescribed, or keep its tip on its path.
///
/// Torque i turns link i counterclockwise, and its reaction turns link i − 1.
///
/// # Errors
/// [`ElasticaError`].
///
/// # Panics
/// If models and chords differ in number.
pub fn follow_arm(
    models: &[Arc<dyn Model>],
    arm: &ArmPeriod,
    second_order: SecondOrder,
    tolerance: f64,
) -> Result<ArmMotion, ElasticaError> {
    follow_arm_at(models, arm, (second_order, tolerance), None)
}

/// [`follow_arm`] with histories of these nodes of each link only. Histories of other nodes are empty, except for the
/// tip's slope.
pub(crate) fn follow_arm_at(
    models: &[Arc<dyn Model>],
    arm: &ArmPeriod,
    (second_order, tolerance): (SecondOrder, f64),
    nodes: Option<&[Vec<usize>]>,
) -> Result<ArmMotion, ElasticaError> {
    if !(FINEST..1.0).contains(&tolerance) {
        return Err(ElasticaError::Tolerance(tolerance));
    }
    let negligible = (second_order != SecondOrder::None).then_some(LEVELS[0].0);
    over_fewest_samples(models, arm, (second_order, negligible, nodes), |follower, linear| {
        if second_order == SecondOrder::None {
            return Ok(linear);
        }
        let levels = if models.len() == 1 { &LEVELS[OF_CHORDS..] } else { &LEVELS[..] };
        over_widest_band(
            levels,
            |level| follower.iterated_over(&linear, Until::Within(tolerance), level),
            |error| !follower.needs_more(error),
            |found, narrower| {
                found.iteration.error +=
                    follower.largest_change(&found.torques_n_m, &narrower.torques_n_m);
                found.iteration.reaction_n += found.state.reaction_apart_n(&narrower.state);
                found.others.push((narrower.answers, 1.0));
            },
        )
    })
}

/// The motion that `find` derives from the linear one, at the fewest samples of the period that resolve it.
fn over_fewest_samples(
    models: &[Arc<dyn Model>],
    arm: &ArmPeriod,
    (second_order, negligible, nodes): (SecondOrder, Option<f64>, Option<&[Vec<usize>]>),
    find: impl Fn(&Follower<'_>, Iterate) -> Result<Iterate, ElasticaError>,
) -> Result<ArmMotion, ElasticaError> {
    // One link costs little at all samples, and its terms often reach beyond the fewest.
    let mut fewest = if models.len() == 1 { usize::MAX } else { 0 };
    loop {
        let (follower, linear) = Follower::of(models, arm, second_order, (fewest, negligible))?;
        match find(&follower, linear) {
            Ok(found) if follower.stride == 1 || !found.iteration.exceeds_step => {
                return follower.motion(found, nodes);
            }
            Err(error) if !follower.needs_more(&error) => return Err(follower.placed(error)),
            // More samples show the reach of second-order terms.
            _ => fewest = 2 * follower.arm.len(),
        }
    }
}

/// The torques with all terms, to about a hundredth of the second-order change, and without histories of nodes.
pub(crate) fn estimate_arm(
    models: &[Arc<dyn Model>],
    arm: &ArmPeriod,
) -> Result<ArmMotion, ElasticaError> {
    let none = vec![Vec::new(); models.len()];
    let how = (SecondOrder::Full, Some(ESTIMATED[0].0), Some(&none[..]));
    over_fewest_samples(models, arm, how, |follower, linear| {
        let mut refused = ElasticaError::Diverges { iterations: 0, change: f64::NAN };
        for level in ESTIMATED {
            match follower.iterated_over(&linear, Until::Share(ESTIMATED_TO), level) {
                Err(error @ ElasticaError::Diverges { .. }) => refused = error,
                found => return found,
            }
        }
        Err(refused)
    })
}

/// The linear motion of an arm of one link without weight, another motion, and a factor. The factor times their
/// difference estimates the change by all second-order terms. The histories cover `nodes`.
///
/// The other motion is the second iteration, with the factor 1. If the second iteration changes the torque by more than
/// half of the first change, it is the first iteration. Its change alternates if the terms stiffen the link: if each
/// change is r times the one before, `1/(1 + r)` of the first change remains.
///
/// # Errors
/// [`ElasticaError`].
pub(crate) fn estimate(
    models: &[Arc<dyn Model>],
    arm: &ArmPeriod,
    nodes: &[Vec<usize>; 1],
) -> Result<([ArmMotion; 2], f64), ElasticaError> {
    let (follower, linear) = Follower::of(models, arm, SecondOrder::Full, (usize::MAX, None))?;
    let chord = &linear.state.chords[0];
    let link = follower.on_chord(0, chord);
    let bands = ESTIMATED_BANDS.map(|level| link.band_of_loads(&linear.answers[0], level));
    // Unresolved products would alias to lower frequencies.
    let is_resolved = |band: &usize| REACH * band <= resolved(&chord.pair);
    let long = long_step(chord.step_s, OF_NYQUIST);
    let band = bands.into_iter().flatten().find(is_resolved).ok_or(long)?;
    let pair = chord.pair_for(REACH * band);
    let time = chord.at(&pair);
    let sweep = |last: &Answers| follower.swept(&linear, last, (&pair, band, 0));
    let once = sweep(&linear.answers)?;
    let twice = sweep(&once.answers);
    let torque_n_m = |answers: &Answers, order| link.hub(&answers[0], order, &pair, &time).0;
    let torques = [
        torque_n_m(&linear.answers, SecondOrder::None),
        torque_n_m(&once.answers, SecondOrder::Full),
    ];
    let first = apart(&torques[1], &torques[0]);
    let ratio = twice.as_ref().map_or(1.0, |twice| {
        let second = apart(&torque_n_m(&twice.answers, SecondOrder::Full), &torques[1]);
        if first == 0.0 { 0.0 } else { second / first }
    });
    let (all, share) = match twice {
        Ok(twice) if ratio <= CONVERGES => (twice, 1.0),
        _ => (once, (1.0 + ratio).recip()),
    };
    let linear = follower.motion(linear, Some(nodes))?;
    Ok(([linear, follower.motion(all, Some(nodes))?], share))
}

impl Follower<'_> {
    /// The motion with loads up to the frequency beyond which a share of the torques is negligible.
    fn iterated_over(
        &self,
        linear: &Iterate,
        until: Until,
        (negligible, moved, times): (f64, f64, usize),
    ) -> Result<Iterate, ElasticaError> {
        let of_all = |answers: &Answers, negligible: f64| {
            let bands = answers.iter().enumerate().map(|(link, answers)| {
                self.on_chord(link, &linear.state.chords[link]).band_of_loads(answers, negligible)
            });
            bands.collect::<Result<Vec<_>, _>>().map(|bands| bands.into_iter().fold(1, usize::max))
        };
        let linear_band = |negligible: f64| self.band(&linear.answers, negligible);
        let moving = times * linear_band(moved);
        let mut band = of_all(&linear.answers, negligible)?;
        let mut latest = linear.clone();
        let (mut last_change, mut last_factor) = (f64::INFINITY, 0.0);
        for iterations in 1..=MOST_ITERATIONS {
            let pair = linear.state.chords[0].pair_for(REACH * band);
            let swept = self.swept(linear, &latest.answers, (&pair, band, moving));
            let diverges = |error: ElasticaError, change| match error {
                error if self.needs_more(&error) => error,
                error if self.models.len() == 1 && error.is_of_step() => error,
                // The first iteration has the linear slopes, for which the path's pose is possible.
                error if iterations == 1 && !matches!(error, ElasticaError::Elbow { .. }) => error,
                error => error.diverging(iterations, change),
            };
            let next = swept.map_err(|error| diverges(error, last_change))?;
            let change = self.largest_change(&next.torques_n_m, &latest.torques_n_m);
            let previous = std::mem::replace(&mut latest, next);
            let reach = of_all(&latest.answers, negligible);
            band = band.max(reach.map_err(|error| diverges(error, change))?);
            let joints = self.models.len();
            let second_order = || {
                let [own, other] = [&latest, linear].map(|of| &of.torques_n_m[..joints]);
                self.largest_change(own, other)
            };
            let tolerance = match until {
                Until::Within(tolerance) => tolerance,
                Until::Share(share) => share * second_order(),
            };
            let factor = factor_of([last_change, change], iterations, (tolerance, negligible))?;
            let contraction = (iterations > 1).then_some(factor);
            // The first of two changes includes constant parts, such as a weight's sag, so that their ratio is small.
            // An estimate needs a third change; otherwise the wider sweep below adds another change.
            let fewest = if matches!(until, Until::Within(_)) { 2 } else { 3 };
            // The changes of several links fall less evenly.
            let slower = if self.models.len() > 1 { factor.max(last_factor) } else { factor };
            let mut error = further(change, slower);
            if iterations >= fewest && error <= tolerance {
                let apart_n = previous.state.reaction_apart_n(&latest.state);
                let mut reaction_n = further(apart_n, slower);
                if matches!(until, Until::Within(_)) && self.models.len() > 1 {
                    // One sweep that moves the chords at more frequencies.
                    let reach = (&pair, band, REACH * linear_band(BEYOND * negligible));
                    let wider = self.swept(linear, &latest.answers, reach);
                    let wider = wider.map_err(|error| diverges(error, change))?;
                    error += self.largest_change(&wider.torques_n_m, &latest.torques_n_m);
                    reaction_n += wider.state.reaction_apart_n(&latest.state);
                }
                let iteration = Iteration {
                    iterations,
                    contraction,
                    error,
                    reaction_n,
                    second_order_change: second_order(),
                    exceeds_step: REACH * band > resolved(&self.arm.pair),
                };
                let others = vec![(previous.answers, further(1.0, factor))];
                return Ok(Iterate { iteration, others, ..latest });
            }
            (last_change, last_factor) = (change, factor);
        }
        Err(ElasticaError::Diverges { iterations: MOST_ITERATIONS, change: last_change })
    }

    /// One iteration over all links from the last inward, each with the loads from its last answer. Links that shorten
    /// move the chords of the next ones only in the first bins.
    fn swept(
        &self,
        linear: &Iterate,
        last: &Answers,
        (pair, band, moving): (&FourierPair, usize, usize),
    ) -> Result<Iterate, ElasticaError> {
        let (order, bins) = (self.second_order, resolved(pair));
        let bent: Vec<_> = self.models.iter().map(|model| BentLink::of(&**model, order)).collect();
        let histories = |link: usize| {
            let kept = &last[link][..band.min(last[link].len())];
            let on_chord = self.on_chord(link, &linear.state.chords[link]);
            on_chord.histories(kept, bent[link].orders(), pair)
        };
        let mut histories: Vec<_> = (0..bent.len()).map(histories).collect();
        let shortening = |(link, own): (usize, &Vec<Vec<f64>>)| {
            bent[link].shortening_m(own).map_err(|error| self.of_link(link, error))
        };
        let is_one = bent.len() == 1;
        let mut state = if order == SecondOrder::Full && !is_one {
            let by_m = histories.iter().enumerate().map(shortening).collect::<Result<_, _>>()?;
            self.chords(Some(Shortened { by_m, pair: pair.clone(), bins: moving }))?
        } else {
            State { forces_n: Vec::new(), ..linear.state.clone() }
        };
        let (mut answers, mut torques_n_m, mut largest_slope) = (Vec::new(), Vec::new(), None);
        for (link, own) in bent.iter().enumerate().rev() {
            let on_chord = self.on_chord(link, &state.chords[link]);
            let time = on_chord.chord.at(pair);
            let histories = histories.pop().unwrap_or_default();
            let loads = own.loads((&histories, &time));
            let mut loads = loads.map_err(|error| self.of_link(link, error))?;
            if let Some(weighed) = on_chord.weighed {
                weighed.restore(&histories, &mut loads.nodal);
            }
            largest_slope = is_one.then_some(loads.largest_slope);
            let link_answers = on_chord.with_loads(&linear.answers[link], &loads.nodal, pair);
            let few = &link_answers[..bins.min(link_answers.len())];
            let along_n: Vec<f64> = loads.axial_n.iter().map(|axial| -axial).collect();
            let at_all = |few: &[f64]| self.arm.at_all(pair, few, bins, 0);
            let mut place = None;
            let torque_n_m = if is_one {
                // All frequencies, so that changes between bands are those of the same frequencies.
                let time = &on_chord.chord.histories;
                let (torque_n_m, slope) = on_chord.hub(&link_answers, order, &self.arm.pair, time);
                place = on_chord.place(slope);
                torque_n_m
            } else {
                at_all(&on_chord.hub(few, order, pair, &time).0)
            };
            let mut across_n = on_chord.across_n(&own.straight(), few);
            let left_n = pair.amplitudes(&loads.left_n);
            across_n.iter_mut().zip(left_n).for_each(|(across, left)| *across += left);
            let forces_n = [at_all(&along_n), self.arm.pair.samples(across_n)];
            state.hand_inward(link, forces_n, &torque_n_m);
            answers.insert(0, link_answers);
            torques_n_m.insert(0, torque_n_m);
            torques_n_m.extend(place);
        }
        let (iteration, others) = (Iteration::default(), Vec::new());
        Ok(Iterate { state, answers, torques_n_m, order, largest_slope, iteration, others })
    }
}
