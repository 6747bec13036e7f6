//! The link's motion with its tip on the chord: linear, and with second-order terms as loads, iterated.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rayon::prelude::*;

use super::chord::{ChordHistories, ChordPeriod, ElasticaError, FINEST, STEEPEST, resolved};
use super::loads::{BentLink, SecondOrder};
use super::reaction::{ElasticaMotion, apart, band, size};
use super::sag::{Sag, TOLERANCE};
use crate::beam::{LoadedMotion, Loads};
use crate::modal::DampingLaw;
use crate::model::{KeptModes, Model};
use crate::numeric::FourierPair;

/// Iterations after which one that still converges is given up.
const MOST_ITERATIONS: usize = 100;

/// Shares of the torque's amplitudes, all added up, of the high frequencies whose deflections are no part of the
/// second-order terms: what these gain grows with the square of the frequency, so that a larger share may converge where a
/// smaller one does not.
const NEGLIGIBLE: [f64; 5] = [1e-8, 1e-6, 1e-5, 1e-4, 1e-3];

/// Change by an iteration, over that by the one before, from which on a narrower band is tried: that may converge.
const SLOW: f64 = 0.9;

/// The same of what is round-off in shapes and moments.
const ROUND_OFF: f64 = 1e-12;

/// Bins that the loads are solved at over those whose deflections they are made of: products of three reach as far.
const REACH: usize = 3;

/// Finds the torque with which the tip of a link stays on a chord that moves as given.
///
/// The iteration ends where further ones would change the torque by less than `tolerance` of its range.
///
/// # Errors
/// [`ElasticaError`].
pub fn follow(
    model: &dyn Model,
    chord: &ChordPeriod,
    second_order: SecondOrder,
    tolerance: f64,
) -> Result<ElasticaMotion, ElasticaError> {
    if !(FINEST..1.0).contains(&tolerance) {
        return Err(ElasticaError::Tolerance(tolerance));
    }
    check(model, chord, second_order)?;
    let follower = Follower::of(model, chord, second_order)?;
    let linear = follower.linear()?;
    if second_order == SecondOrder::None {
        return Ok(follower.motion(&linear, second_order));
    }
    follower.iterated(&linear, second_order, tolerance)
}

/// Refuses samples too far apart, and links whose weight or second order is not derived.
fn check(
    model: &dyn Model,
    chord: &ChordPeriod,
    second_order: SecondOrder,
) -> Result<(), ElasticaError> {
    let refused = |what, known| Err(ElasticaError::NotDerived { what, known });
    let (law, is_bent) = (model.law(), second_order != SecondOrder::None);
    if chord.reaches_nyquist(model.mesh().length_m()) {
        return Err(ElasticaError::LongStep { step_s: chord.step_s });
    }
    if model.kept_modes() != KeptModes::All {
        return refused("the link is reduced to its first modes", "with all modes");
    }
    if (is_bent || chord.has_weight()) && model.mesh().has_shear() {
        return refused("the link has shear and rotary inertia", "without them");
    }
    if law.mass_rate_per_s() != 0.0 {
        return refused("the damping drags every mass (alpha)", "with alpha = 0");
    }
    if law.is_modal() && (is_bent || chord.has_weight()) {
        return refused("the damping is given mode by mode", "with hysteretic or rayleigh damping");
    }
    Ok(())
}

struct Follower<'a> {
    model: &'a dyn Model,
    chord: &'a ChordPeriod,
    /// Bins that carry any motion.
    band: usize,
    /// Damping ratio ξ and sag, where a hysteretic link has weight.
    sag: Option<(f64, Sag)>,
}

impl<'a> Follower<'a> {
    fn of(
        model: &'a dyn Model,
        chord: &'a ChordPeriod,
        second_order: SecondOrder,
    ) -> Result<Self, ElasticaError> {
        let sag = match model.law() {
            DampingLaw::Hysteretic { ratio } if *ratio > 0.0 && chord.has_weight() => {
                let rest = |at: &ChordPeriod| {
                    let bent = follow(model, at, second_order, TOLERANCE)?;
                    Ok(bent.deflections.iter().map(|history| history[0]).collect())
                };
                Sag::of(model.mesh(), chord, rest)?.map(|sag| (*ratio, sag))
            }
            _ => None,
        };
        Ok(Self { model, chord, band: chord.band_len(model.mesh().length_m()), sag })
    }

    /// What moves the link at a bin, and forces on its nodes, those of its sag added.
    fn moved(&self, bin: usize, mut nodal: Vec<[Complex64; 2]>) -> Loads<Complex64> {
        let axis_m_s2 = self.chord.across[bin];
        if let Some((ratio, sag)) = self.sag.as_ref().filter(|_| bin > 0) {
            sag.add(bin, Complex64::new(0.0, 2.0 * ratio), &mut nodal);
        }
        Loads { axis_m_s2, chord_rad_s2: self.chord.turning[bin], nodal }
    }

    /// The answer at each bin to what moves the link, without loads.
    fn linear(&self) -> Result<Vec<LoadedMotion<Complex64>>, ElasticaError> {
        let nodes = self.model.mesh().nodes_m().len();
        let answers: Vec<_> = (0..self.band)
            .into_par_iter()
            .map(|bin| {
                let loads = self.moved(bin, vec![[Complex64::ZERO; 2]; nodes]);
                self.model.loaded_motion(self.chord.omega_rad_s(bin), &loads)
            })
            .collect();
        let mesh = self.model.mesh();
        // Damped, no frequency of a payload's inertia is blocked altogether.
        let is_undamped = matches!(
            self.model.law(),
            DampingLaw::Hysteretic { ratio: 0.0 }
                | DampingLaw::Rayleigh { alpha_per_s: 0.0, beta_s: 0.0 }
        );
        let is_lost = |bin: &usize| {
            let tip = || self.model.tip_transfer(self.chord.omega_rad_s(*bin));
            !answers[*bin].torque_n_m.is_finite() || is_undamped && tip().is_blocked(mesh)
        };
        match (0..self.band).find(is_lost) {
            Some(bin) => {
                Err(ElasticaError::NotFinite { frequency_hz: self.chord.omega_rad_s(bin) / TAU })
            }
            None => Ok(answers),
        }
    }

    /// Bins up to the last one whose torque counts for the second order.
    ///
    /// # Errors
    /// [`ElasticaError::LongStep`] where there are more.
    fn band_of_loads(
        &self,
        answers: &[LoadedMotion<Complex64>],
        negligible: f64,
    ) -> Result<usize, ElasticaError> {
        let band = band(answers, negligible);
        let (most, step_s) = (self.chord.len() / 4, self.chord.step_s);
        if band < most.max(2) { Ok(band) } else { Err(ElasticaError::LongStep { step_s }) }
    }

    /// The motion over the widest band of loads that converges; what the next narrower one changes is added to its
    /// error, unless the widest of all does.
    fn iterated(
        &self,
        linear: &[LoadedMotion<Complex64>],
        second_order: SecondOrder,
        tolerance: f64,
    ) -> Result<ElasticaMotion, ElasticaError> {
        let mut refused = ElasticaError::Diverges { iterations: 0, change: f64::NAN };
        for (number, negligible) in NEGLIGIBLE[..NEGLIGIBLE.len() - 1].iter().enumerate() {
            match self.iterated_over(linear, second_order, tolerance, *negligible) {
                Ok(motion) if number == 0 => return Ok(motion),
                Ok(mut motion) => {
                    let narrower = NEGLIGIBLE[number + 1];
                    match self.iterated_over(linear, second_order, tolerance, narrower) {
                        Ok(narrower) => {
                            let (own, other) = (&motion.torque_n_m, &narrower.torque_n_m);
                            motion.iteration_error +=
                                apart(other, own) / size(own, self.model.mesh());
                            motion.others.push((narrower, 1.0));
                            return Ok(motion);
                        }
                        Err(error @ ElasticaError::Diverges { .. }) => refused = error,
                        Err(error) => return Err(error),
                    }
                }
                Err(error @ ElasticaError::Diverges { .. }) => refused = error,
                Err(error) => return Err(error),
            }
        }
        Err(refused)
    }

    /// The motion over the band of loads beyond which a share of the torque is negligible.
    fn iterated_over(
        &self,
        linear: &[LoadedMotion<Complex64>],
        second_order: SecondOrder,
        tolerance: f64,
        negligible: f64,
    ) -> Result<ElasticaMotion, ElasticaError> {
        let mesh = self.model.mesh();
        let link = BentLink::of(self.model, second_order);
        // Products of deflections reach beyond the frequencies of the motion.
        let mut band = self.band_of_loads(linear, negligible)?;
        let mut answers = linear.to_vec();
        let (mut last_change, mut last_level) = (f64::INFINITY, SecondOrder::None);
        for iterations in 1..=MOST_ITERATIONS {
            let pair = self.chord.pair_for(REACH * band);
            let time = self.chord.at(&pair);
            let (before, _) = self.hub(&answers, last_level, &pair, &time);
            let kept = &answers[..band.min(answers.len())];
            let (loads, largest_slope) = self.loads(&link, kept, &pair, &time)?;
            let next = self.with_loads(linear, &loads, &pair);
            let previous = std::mem::replace(&mut answers, next);
            band = band.max(self.band_of_loads(&answers, negligible)?);
            let (torque_n_m, _) = self.hub(&answers, second_order, &pair, &time);
            let change = apart(&torque_n_m, &before) / size(&torque_n_m, mesh);
            let factor = if change == 0.0 { 0.0 } else { change / last_change };
            let most = if negligible < NEGLIGIBLE[NEGLIGIBLE.len() - 1] { SLOW } else { 1.0 };
            if !change.is_finite() || iterations > 3 && factor >= most && change > tolerance {
                return Err(ElasticaError::Diverges { iterations, change });
            }
            let contraction = (iterations > 1).then_some(factor);
            let iteration_error = contraction.map_or(change, |f| change * f / (1.0 - f).max(0.01));
            if iterations > 1 && iteration_error <= tolerance {
                let motion = self.motion(&answers, second_order);
                let further = factor / (1.0 - factor).max(0.01);
                let others = vec![(self.motion(&previous, second_order), further)];
                let without =
                    self.hub(linear, SecondOrder::None, &self.chord.pair, &self.chord.histories).0;
                let size = size(&motion.torque_n_m, mesh);
                let second_order_change = apart(&motion.torque_n_m, &without) / size;
                return Ok(ElasticaMotion {
                    iterations,
                    contraction,
                    iteration_error,
                    largest_slope,
                    second_order_change,
                    exceeds_step: REACH * band > resolved(&self.chord.pair),
                    others,
                    ..motion
                });
            }
            (last_change, last_level) = (change, second_order);
        }
        Err(ElasticaError::Diverges { iterations: MOST_ITERATIONS, change: last_change })
    }

    /// Loads on the nodes, one history for each force and moment, and the largest slope.
    fn loads(
        &self,
        link: &BentLink,
        answers: &[LoadedMotion<Complex64>],
        pair: &FourierPair,
        chord: &ChordHistories,
    ) -> Result<(Vec<Vec<f64>>, f64), ElasticaError> {
        let states = (self.histories(answers, link.orders(), pair), chord);
        let (loads, slope) =
            link.at_each_instant(states, |now, scratch, row| link.write(now, scratch, row));
        if slope.is_nan() || slope >= STEEPEST {
            return Err(ElasticaError::TooSteep { slope });
        }
        Ok((loads, slope))
    }

    /// Histories of (w, w') of each node, then of their derivatives up to `orders`.
    fn histories(
        &self,
        answers: &[LoadedMotion<Complex64>],
        orders: usize,
        pair: &FourierPair,
    ) -> Vec<Vec<f64>> {
        let width = 2 * self.model.mesh().nodes_m().len();
        let omega = |bin: usize| Complex64::new(0.0, self.chord.omega_rad_s(bin));
        (0..orders * width)
            .into_par_iter()
            .map(|column| {
                let (order, dof) = (column / width, column % width);
                let amplitudes = answers.iter().enumerate().map(|(bin, answer)| {
                    let amplitude = answer.deflections[dof / 2][dof % 2];
                    (0..order).fold(amplitude, |derived, _| derived * omega(bin))
                });
                pair.samples(amplitudes.collect::<Vec<_>>())
            })
            .collect()
    }

    /// The linear answers, with those to loads where these have no alias.
    fn with_loads(
        &self,
        linear: &[LoadedMotion<Complex64>],
        loads: &[Vec<f64>],
        pair: &FourierPair,
    ) -> Vec<LoadedMotion<Complex64>> {
        let spectra: Vec<_> = loads.par_iter().map(|history| pair.amplitudes(history)).collect();
        let at = |bin: usize| {
            let nodal = spectra.chunks(2).map(|node| [node[0][bin], node[1][bin]]).collect();
            self.model.loaded_motion(self.chord.omega_rad_s(bin), &self.moved(bin, nodal))
        };
        let mut answers: Vec<_> = (0..resolved(pair)).into_par_iter().map(at).collect();
        answers.extend(linear.iter().skip(answers.len()).cloned());
        answers
    }

    /// Torque, and angle of the hub from the chord, at the samples of a pair; with all terms, the hub turns by the
    /// angle of its slope.
    ///
    /// ```text
    /// T = (T_l − I_H(θ̈ + ẅ'_0)) cos ψ + I_H(θ̈ + ψ̈) + b(θ̇ + ψ̇),       ψ = asin w'_0
    /// ```
    fn hub(
        &self,
        answers: &[LoadedMotion<Complex64>],
        second_order: SecondOrder,
        pair: &FourierPair,
        chord: &ChordHistories,
    ) -> (Vec<f64>, Vec<f64>) {
        let (inertia, joint) = (self.model.mesh().hub_inertia_kg_m2(), self.model.link().joint());
        let torque: Vec<_> = answers.iter().map(|answer| answer.torque_n_m).collect();
        let mut torque_n_m = pair.samples(torque);
        let slopes = [0, 1, 2].map(|order| {
            let amplitudes = answers.iter().enumerate().map(|(bin, answer)| {
                answer.hub_slope_rad * Complex64::new(0.0, self.chord.omega_rad_s(bin)).powu(order)
            });
            pair.samples(amplitudes.collect::<Vec<_>>())
        });
        let mut hub_slope_rad = slopes[0].clone();
        for (k, torque) in torque_n_m.iter_mut().enumerate() {
            let [sine, rate, acceleration] = [slopes[0][k], slopes[1][k], slopes[2][k]];
            let mut hub_rate = rate;
            if second_order == SecondOrder::Full {
                let cosine = (1.0 - sine * sine).sqrt();
                let turning =
                    acceleration / cosine + sine * rate * rate / (cosine * cosine * cosine);
                let turned = chord.acceleration_rad_s2[k];
                *torque = (*torque - inertia * (turned + acceleration)) * cosine
                    + inertia * (turned + turning);
                hub_slope_rad[k] = libm::asin(sine);
                hub_rate = rate / cosine;
            }
            *torque += joint.friction_n_m_s_rad * (chord.rate_rad_s[k] + hub_rate);
        }
        (torque_n_m, hub_slope_rad)
    }

    /// The histories of these answers over the chord's own samples.
    fn motion(
        &self,
        answers: &[LoadedMotion<Complex64>],
        second_order: SecondOrder,
    ) -> ElasticaMotion {
        let pair = &self.chord.pair;
        let (torque_n_m, hub_slope_rad) =
            self.hub(answers, second_order, pair, &self.chord.histories);
        let deflections = self.histories(answers, 1, pair);
        let ([shortenings_m, moments_n_m], largest_slope) = self.shapes(answers, second_order);
        ElasticaMotion {
            torque_n_m,
            hub_slope_rad,
            deflections,
            shortenings_m,
            moments_n_m,
            iterations: 0,
            contraction: None,
            iteration_error: 0.0,
            largest_slope,
            second_order_change: 0.0,
            exceeds_step: false,
            others: Vec::new(),
        }
    }

    /// Shortening and bending moment of each node in turn, and the largest slope: at as many samples as products of
    /// what bends need, then at the chord's own.
    fn shapes(
        &self,
        answers: &[LoadedMotion<Complex64>],
        second_order: SecondOrder,
    ) -> ([Vec<Vec<f64>>; 2], f64) {
        let (link, band) = (BentLink::of(self.model, second_order), band(answers, ROUND_OFF));
        let pair = self.chord.pair_for(band);
        let (states, chord) = (self.histories(&answers[..band], 3, &pair), self.chord.at(&pair));
        let (shapes, largest_slope) = link
            .at_each_instant((states, &chord), |now, scratch, row| link.shape(now, scratch, row));
        let all = |few: Vec<f64>| match pair.len() {
            len if len == self.chord.len() => few,
            _ => self.chord.pair.samples(pair.amplitudes(few)),
        };
        let nodes = shapes.into_par_iter().map(all).collect::<Vec<_>>();
        let mut parts = [Vec::new(), Vec::new()];
        nodes.into_iter().enumerate().for_each(|(k, history)| parts[k % 2].push(history));
        (parts, largest_slope)
    }
}
