//! The link's motion with its tip on the chord: linear, and iterated with second-order terms as loads.

use num_complex::Complex64;

use super::chord::{ChordHistories, ChordPeriod, resolved};
use super::error::{ElasticaError, FINEST};
use super::loads::{BentLink, LoadHistories, SecondOrder};
use super::on_chord::LinkOnChord;
use super::reaction::{ElasticaMotion, Iteration, apart, band, size};
use super::sag::{Sag, TOLERANCE};
use crate::beam::LoadedMotion;
use crate::modal::DampingLaw;
use crate::model::{KeptModes, Model};
use crate::numeric::FourierPair;

/// Limit of iterations, even if they still converge.
pub(super) const MOST_ITERATIONS: usize = 100;

/// Shares of the torque's amplitudes, all added up, at high frequencies whose deflections are left out of the
/// second-order terms. These terms grow with the square of the frequency, so that a larger share may converge where a
/// smaller one does not.
const NEGLIGIBLE: [f64; 5] = [1e-8, 1e-6, 1e-5, 1e-4, 1e-3];

/// The same shares for an estimate of second-order terms.
const ESTIMATED: [f64; 3] = [1e-4, 1e-3, 1e-2];

/// Ratio of the second iteration's change to the first's up to which the second is nearer.
const CONVERGES: f64 = 0.5;

/// Ratio of an iteration's change to the change before, above which a narrower band is tried, which may converge.
const SLOW: f64 = 0.9;

/// Number of bins of the loads over the number of bins of their deflections: products of three reach as far.
pub(super) const REACH: usize = 3;

/// Share of the longest resolved step that an error message suggests: more samples show faster parts of the motion.
/// With 0.7, most of 60 coarse paths were refused again.
const FINER: f64 = 0.2;

/// Share of a refused step that an error message suggests if the motion reaches the Nyquist frequency: a least-jerk
/// motion of 25 samples needs it.
const OF_NYQUIST: f64 = 0.1;

/// Amplitudes of a link's answer, one for each bin.
type Answers = Vec<LoadedMotion<Complex64>>;

/// The motion of a link on its chord, and the course of its iteration.
#[derive(Debug)]
pub struct Followed {
    /// The motion.
    pub motion: ElasticaMotion,
    /// Course of the iteration of second-order terms.
    pub iteration: Iteration,
    second_order: SecondOrder,
    answers: Answers,
    /// Other approximations: the iteration before the last and, if terms of high frequencies are neglected, the motion
    /// without more of them. The factor on the distance from this motion gives the change by further terms.
    others: Vec<(Answers, f64)>,
}

impl Followed {
    /// Second-order terms in this motion.
    pub(crate) fn second_order(&self) -> SecondOrder {
        self.second_order
    }

    /// Other approximations of the motion of this model on this chord. The factor on the distance from this motion
    /// gives the change by further iterations, or by terms of more frequencies.
    pub fn others<'a>(
        &'a self,
        model: &'a dyn Model,
        chord: &'a ChordPeriod,
    ) -> impl Iterator<Item = (ElasticaMotion, f64)> + 'a {
        let link = LinkOnChord::of(model, chord);
        let others = self.others.iter();
        others.map(move |(answers, factor)| {
            (link.motion(answers, self.second_order, (&chord.pair, None)), *factor)
        })
    }
}

/// Finds the torque that keeps the tip of a link on a moving chord.
///
/// The iteration ends when further ones would change the torque by less than `tolerance` of its range.
///
/// # Errors
/// [`ElasticaError`].
pub fn follow(
    model: &dyn Model,
    chord: &ChordPeriod,
    second_order: SecondOrder,
    tolerance: f64,
) -> Result<Followed, ElasticaError> {
    if !(FINEST..1.0).contains(&tolerance) {
        return Err(ElasticaError::Tolerance(tolerance));
    }
    check(model, chord, second_order != SecondOrder::None || chord.has_weight())?;
    let sag = sag_of(model, chord, second_order)?;
    let sag = sag.as_ref().map(|(ratio, sag)| (*ratio, sag));
    let link = LinkOnChord { sag, ..LinkOnChord::of(model, chord) };
    let linear = link.linear()?;
    if second_order == SecondOrder::None {
        let motion = link.motion(&linear, second_order, (&chord.pair, None));
        let iteration = Iteration::default();
        return Ok(Followed { motion, iteration, second_order, answers: linear, others: vec![] });
    }
    over_widest_band(
        &NEGLIGIBLE,
        |negligible| link.iterated_over(&linear, second_order, tolerance, negligible),
        |_| true,
        |found, narrower| {
            let (own, other) = (&found.motion.torque_n_m, &narrower.motion.torque_n_m);
            found.iteration.error += apart(other, own) / size(own, model.mesh());
            found.others.push((narrower.answers, 1.0));
        },
    )
}

/// The linear motion of a link whose tip stays on a chord, another motion, and a factor. The factor times their
/// difference estimates the change by all second-order terms. The histories cover `nodes`.
///
/// The other motion is the second iteration, with the factor 1. If the second iteration changes the torque by more than
/// half of the first change, it is the first iteration. Its change alternates if the terms stiffen the link: if each
/// change is r times the one before, `1/(1 + r)` of the first change remains.
///
/// # Errors
/// [`ElasticaError`].
pub(crate) fn estimate(
    model: &dyn Model,
    chord: &ChordPeriod,
    nodes: &[usize],
) -> Result<([Followed; 2], f64), ElasticaError> {
    check(model, chord, true)?;
    let link = LinkOnChord::of(model, chord);
    let linear = link.linear()?;
    let bent = BentLink::of(model, SecondOrder::Full);
    let bands = ESTIMATED.map(|level| link.band_of_loads(&linear, level));
    // Unresolved products would alias to lower frequencies.
    let is_resolved = |band: &usize| REACH * band <= resolved(&chord.pair);
    let long = long_step(chord.step_s, OF_NYQUIST);
    let band = bands.into_iter().flatten().find(is_resolved).ok_or(long)?;
    let pair = chord.pair_for(REACH * band);
    let time = chord.at(&pair);
    let iterated = |latest: &Answers| {
        let kept = &latest[..band.min(latest.len())];
        Ok::<_, ElasticaError>(link.iterated(&linear, (&bent, kept), (&pair, &time))?.0)
    };
    let once = iterated(&linear)?;
    let twice = iterated(&once);
    let torque_n_m = |answers, order| link.hub(answers, order, &pair, &time).0;
    let torques = [torque_n_m(&linear, SecondOrder::None), torque_n_m(&once, SecondOrder::Full)];
    let first = apart(&torques[1], &torques[0]);
    let ratio = twice.as_ref().map_or(1.0, |twice| {
        let second = apart(&torque_n_m(twice, SecondOrder::Full), &torques[1]);
        if first == 0.0 { 0.0 } else { second / first }
    });
    let (all, share) = match twice {
        Ok(twice) if ratio <= CONVERGES => (twice, 1.0),
        _ => (once, (1.0 + ratio).recip()),
    };
    let both = [(linear, SecondOrder::None), (all, SecondOrder::Full)];
    let followed = both.map(|(answers, second_order)| {
        let motion = link.motion(&answers, second_order, (&chord.pair, Some(nodes)));
        Followed { motion, iteration: Iteration::default(), second_order, answers, others: vec![] }
    });
    Ok((followed, share))
}

/// The motion over the widest band of loads that converges and that the samples resolve, with levels from the widest to
/// the narrowest. Its error includes the change to the next narrower band, except for the widest level. Errors that are
/// not `of_band` do not lead to a narrower band.
pub(super) fn over_widest_band<L: Copy, T>(
    levels: &[L],
    iterated: impl Fn(L) -> Result<T, ElasticaError>,
    of_band: impl Fn(&ElasticaError) -> bool,
    add_error: impl Fn(&mut T, T),
) -> Result<T, ElasticaError> {
    let is_of_band = |error: &ElasticaError| {
        matches!(error, ElasticaError::Diverges { .. }) || error.is_of_step() && of_band(error)
    };
    let mut refused = ElasticaError::Diverges { iterations: 0, change: f64::NAN };
    for (number, level) in levels[..levels.len() - 1].iter().enumerate() {
        match iterated(*level) {
            Ok(motion) if number == 0 => return Ok(motion),
            Ok(mut motion) => match iterated(levels[number + 1]) {
                Ok(narrower) => {
                    add_error(&mut motion, narrower);
                    return Ok(motion);
                }
                Err(error) if is_of_band(&error) => refused = error,
                Err(error) => return Err(error),
            },
            Err(error) if is_of_band(&error) => refused = error,
            Err(error) => return Err(error),
        }
    }
    Err(refused)
}

/// Ratio of an iteration's change to the change before.
///
/// # Errors
/// [`ElasticaError::Diverges`] if the changes do not fall, or not fast enough for this band.
pub(super) fn factor_of(
    [last, change]: [f64; 2],
    iterations: usize,
    (tolerance, negligible): (f64, f64),
) -> Result<f64, ElasticaError> {
    let factor = if change == 0.0 { 0.0 } else { change / last };
    let most = if negligible < NEGLIGIBLE[NEGLIGIBLE.len() - 1] { SLOW } else { 1.0 };
    if !change.is_finite() || iterations > 3 && factor >= most && change > tolerance {
        return Err(ElasticaError::Diverges { iterations, change });
    }
    Ok(factor)
}

/// Sum of the changes by all further iterations, if each is `factor` times the one before.
pub(super) fn further(change: f64, factor: f64) -> f64 {
    change * factor / (1.0 - factor).max(0.01)
}

/// Refuses samples too far apart, and links that are not derived. `is_exact` means weight, second order or further
/// links, for which fewer links are derived.
pub(super) fn check(
    model: &dyn Model,
    chord: &ChordPeriod,
    is_exact: bool,
) -> Result<(), ElasticaError> {
    let refused = |what, known| Err(ElasticaError::NotDerived { what, known });
    let law = model.law();
    if chord.reaches_nyquist(model.mesh().length_m()) {
        return Err(long_step(chord.step_s, OF_NYQUIST));
    }
    if model.kept_modes() != KeptModes::All {
        return refused(
            "the link is reduced to its first modes (analysis.modes)",
            "with all modes",
        );
    }
    if is_exact && model.mesh().has_shear() {
        return refused("the link has shear and rotary inertia", "without them");
    }
    if law.mass_rate_per_s() != 0.0 {
        return refused("the damping drags every mass (alpha)", "with alpha = 0");
    }
    if law.is_modal() && is_exact {
        return refused("the damping is set mode by mode", "with hysteretic or rayleigh damping");
    }
    Ok(())
}

/// Error for a step, with about this share of it as a remedy.
fn long_step(step_s: f64, share: f64) -> ElasticaError {
    ElasticaError::LongStep { step_s, most_s: share * step_s }
}

/// Damping ratio and sag of a hysteretic link with weight.
fn sag_of(
    model: &dyn Model,
    chord: &ChordPeriod,
    second_order: SecondOrder,
) -> Result<Option<(f64, Sag)>, ElasticaError> {
    match model.law() {
        DampingLaw::Hysteretic { ratio } if *ratio > 0.0 && chord.has_weight() => {
            let rest = |at: &ChordPeriod| {
                let bent = follow(model, at, second_order, TOLERANCE)?.motion;
                Ok(bent.deflections.iter().map(|history| history[0]).collect())
            };
            Ok(Sag::of(model.mesh(), chord, rest)?.map(|sag| (*ratio, sag)))
        }
        _ => Ok(None),
    }
}

impl<'a> LinkOnChord<'a> {
    /// A single link, without sag and round-off.
    fn of(model: &'a dyn Model, chord: &'a ChordPeriod) -> Self {
        let friction_n_m_s_rad = model.link().joint().friction_n_m_s_rad;
        Self { model, chord, sag: None, friction_n_m_s_rad, round_off_n_m: 0.0 }
    }
}

impl LinkOnChord<'_> {
    /// Number of bins up to the last one whose torque counts for the second order.
    ///
    /// # Errors
    /// [`ElasticaError::LongStep`] if the samples do not resolve them.
    pub(super) fn band_of_loads(
        &self,
        answers: &[LoadedMotion<Complex64>],
        negligible: f64,
    ) -> Result<usize, ElasticaError> {
        let band = band(answers, negligible, (self.model.mesh(), self.round_off_n_m));
        let most = (self.chord.len() / 4).max(2);
        let share = FINER * most as f64 / band as f64;
        if band < most { Ok(band) } else { Err(long_step(self.chord.step_s, share)) }
    }

    /// The answers with the second-order terms of the `latest` answers as loads, and the largest slope of the latter.
    fn iterated(
        &self,
        linear: &Answers,
        (link, latest): (&BentLink, &[LoadedMotion<Complex64>]),
        (pair, chord): (&FourierPair, &ChordHistories),
    ) -> Result<(Answers, f64), ElasticaError> {
        let states = (self.histories(latest, link.orders(), pair), chord);
        let LoadHistories { nodal, largest_slope, .. } = link.loads(states)?;
        Ok((self.with_loads(linear, &nodal, pair), largest_slope))
    }

    /// The motion with loads up to the frequency beyond which a share of the torque is negligible.
    fn iterated_over(
        &self,
        linear: &Answers,
        second_order: SecondOrder,
        tolerance: f64,
        negligible: f64,
    ) -> Result<Followed, ElasticaError> {
        let mesh = self.model.mesh();
        let link = BentLink::of(self.model, second_order);
        // Products of deflections reach beyond the frequencies of the motion.
        let mut band = self.band_of_loads(linear, negligible)?;
        let mut answers = linear.clone();
        let (mut last_change, mut last_level) = (f64::INFINITY, SecondOrder::None);
        for iterations in 1..=MOST_ITERATIONS {
            let pair = self.chord.pair_for(REACH * band);
            let time = self.chord.at(&pair);
            let (before, _) = self.hub(&answers, last_level, &pair, &time);
            let kept = &answers[..band.min(answers.len())];
            let (next, largest_slope) = self.iterated(linear, (&link, kept), (&pair, &time))?;
            let previous = std::mem::replace(&mut answers, next);
            band = band.max(self.band_of_loads(&answers, negligible)?);
            let (torque_n_m, _) = self.hub(&answers, second_order, &pair, &time);
            let change = apart(&torque_n_m, &before) / size(&torque_n_m, mesh);
            let factor = factor_of([last_change, change], iterations, (tolerance, negligible))?;
            let contraction = (iterations > 1).then_some(factor);
            let iteration_error = contraction.map_or(change, |factor| further(change, factor));
            if iterations > 1 && iteration_error <= tolerance {
                let motion = self.motion(&answers, second_order, (&self.chord.pair, None));
                let others = vec![(previous, further(1.0, factor))];
                let without =
                    self.hub(linear, SecondOrder::None, &self.chord.pair, &self.chord.histories).0;
                let size = size(&motion.torque_n_m, mesh);
                let second_order_change = apart(&motion.torque_n_m, &without) / size;
                let iteration = Iteration {
                    iterations,
                    contraction,
                    error: iteration_error,
                    second_order_change,
                    exceeds_step: REACH * band > resolved(&self.chord.pair),
                };
                let motion = ElasticaMotion { largest_slope, ..motion };
                return Ok(Followed { motion, iteration, second_order, answers, others });
            }
            (last_change, last_level) = (change, second_order);
        }
        Err(ElasticaError::Diverges { iterations: MOST_ITERATIONS, change: last_change })
    }
}
