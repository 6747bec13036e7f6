//! Starts of a fit, and other answers.
//!
//! Other answers are results of other starts that the data cannot distinguish from the best one; intervals cover them.

use rayon::prelude::*;

use super::least_squares::{Depth, End, POLISH, Problem};
use super::measurements::Prediction;
use super::misfits::Misfits;
use super::outcome::{FitOutcome, OtherAnswer, Spread, USUAL_MISFIT};
use super::specimen::{FINE, Specimen};
use crate::numeric::NORMAL_95;

/// Depth of the search for the least sum of squares with one fixed value.
const HELD: Depth =
    Depth { mesh_tolerance: FINE, settled: 1e-5, little: 1e-5, most_iterations: 30 };

/// Distance of values in standard errors, and in the logarithm, below which they are the same.
const SAME: [f64; 2] = [0.5, 1e-3];

/// Relative error allowed in the distance from the best answer at the end of an interval.
const NEAR: f64 = 0.05;

/// Limit of places tried for the end of an interval.
const MOST_PLACES: usize = 12;

/// Number of starts besides the file's: in general; for several free values of a link with values as the only
/// measurements, which takes milliseconds; for the same with an arm.
const OTHER_STARTS: [usize; 3] = [3, 15, 7];

/// Largest factor between the file's value and another start.
const FARTHEST_START: f64 = 5.0;

/// An answer with the standard errors around it.
struct Answer {
    /// Logarithms of the factors, then delays.
    x: Vec<f64>,
    sum: f64,
    /// Standard error of each free value over the standard error of the residuals; `None` if a value is not determined.
    errors: Option<Vec<f64>>,
}

impl<S: Into<Specimen>, E: Send, F: Fn(&[f64]) -> Result<S, E> + Sync> Problem<'_, F> {
    /// The outcome at `x` with those of the other `ends` that fit about as well, and with intervals that cover them.
    /// `surveyed` is the sum of squares at the end of the survey that led to `x`.
    pub(super) fn with_other_answers(
        &self,
        mut outcome: FitOutcome,
        (x, predicted): (&[f64], Option<&Prediction>),
        ends: Vec<End>,
        surveyed: f64,
    ) -> FitOutcome {
        let misfits = Misfits::of(self.measurements, self.free.len(), predicted);
        if !misfits.sum.is_finite() || !outcome.undetermined.is_empty() {
            return outcome;
        }
        // Exact measurements leave round-off.
        let scale = misfits.scale().unwrap_or(USUAL_MISFIT).max(FINE);
        let room = (misfits.reach_95() * scale).powi(2);
        let least = misfits.sum;
        let error = |k: usize| outcome.values[k].relative_standard_error.unwrap_or(0.0);
        let is_same = |a: &[f64], b: &[f64]| {
            let far = |k: usize| (SAME[0] * error(k)).max(SAME[1]);
            (0..self.free.len()).all(|k| (a[k] - b[k]).abs() < far(k))
        };
        let mut others: Vec<End> = Vec::new();
        // The survey went less far, on a coarser mesh.
        for end in ends.into_iter().filter(|end| end.cost < 2.0 * surveyed + 4.0 * room) {
            let known = others.iter().map(|other| &other.x[..]).chain([x]);
            if !known.into_iter().any(|known| is_same(known, &end.x)) {
                others.push(end);
            }
        }
        let polished = others.into_par_iter().filter_map(|end| self.descend(end.x, POLISH));
        let mut polished: Vec<End> = polished.filter(|end| end.cost < least + room).collect();
        polished.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let own = Answer { x: x.to_vec(), sum: least, errors: None };
        let mut answers = vec![own];
        for End { x, cost, .. } in polished {
            if !answers.iter().any(|answer| is_same(&answer.x, &x)) {
                let errors = self.errors(&x);
                answers.push(Answer { x, sum: cost, errors });
            }
        }
        let near =
            answers[1..].iter().filter(|answer| answer.sum < least + (NORMAL_95 * scale).powi(2));
        let factors = |x: &[f64]| x[..self.free.len()].iter().map(|x| libm::exp(*x)).collect();
        outcome.other_answers = near
            .map(|answer| OtherAnswer { factors: factors(&answer.x), sum_of_squares: answer.sum })
            .collect();
        let is_profiled = misfits.has_uncertainties && !self.measurements.has_files();
        let intervals: Vec<Option<[f64; 2]>> = (0..self.free.len())
            .into_par_iter()
            .map(|k| {
                let known = outcome.values[k].relative_interval_95?;
                let sides = known.map(|end| x[k] + libm::log(end));
                let wide = [0, 1].map(|side| {
                    self.edge((k, side), &answers, (sides[side], least + room), is_profiled)
                });
                let is_wider = (0..2).any(|side| wide[side].total_cmp(&sides[side]).is_ne());
                is_wider.then(|| wide.map(|end| libm::exp(end - x[k])))
            })
            .collect();
        for (value, interval) in outcome.values.iter_mut().zip(intervals) {
            value.relative_interval_95 = interval.or(value.relative_interval_95);
        }
        outcome
    }

    /// Standard errors of the free values at an answer, for residuals of variance 1.
    fn errors(&self, x: &[f64]) -> Option<Vec<f64>> {
        let jacobian = self.jacobian(x, self.refinements(x, FINE)?, true);
        let spread = Spread::of(&jacobian, self.measurements.weight(), 1.0);
        if !spread.open(true).is_empty() {
            return None;
        }
        let covariance = spread.covariance();
        Some((0..self.free.len()).map(|k| covariance[(k, k)].sqrt()).collect())
    }

    /// Lower or upper end, `side` 0 or 1, of the interval of a value: the farthest of the `answers`, each extended by
    /// its standard error; `own` is the extension of the first. If `is_profiled`, it is the place where the least sum
    /// of squares with the value fixed equals `most`.
    fn edge(
        &self,
        (k, side): (usize, usize),
        answers: &[Answer],
        (own, most): (f64, f64),
        is_profiled: bool,
    ) -> f64 {
        let [low, high] = self.bounds(k);
        let sign = [-1.0, 1.0][side];
        let place = |answer: &Answer| {
            let reach = (most - answer.sum).max(0.0).sqrt();
            let error = answer.errors.as_ref().map_or(0.0, |errors| errors[k]);
            (answer.x[k] + sign * reach * error).clamp(low, high)
        };
        let (mut from, mut far) = (&answers[0], own);
        for answer in &answers[1..] {
            let next = place(answer);
            if sign * (next - far) > 0.0 {
                (from, far) = (answer, next);
            }
        }
        if is_profiled { self.profiled(k, from, far, most) } else { far }
    }

    /// Place of value `k` where the least sum of squares with the value fixed equals `most`, sought from `first` on its
    /// side of the answer; a bound if the sum stays below.
    fn profiled(&self, k: usize, answer: &Answer, first: f64, most: f64) -> f64 {
        let [low, high] = self.bounds(k);
        let room = most - answer.sum;
        let (mut place, mut x) = (first.clamp(low, high), answer.x.clone());
        if room <= 0.0 || place.total_cmp(&answer.x[k]).is_eq() {
            return first;
        }
        for number in 0..MOST_PLACES {
            let Some(end) = self.held(k, place, x.clone()) else { return place };
            // As along a parabola, the distance grows with the root of the sum.
            let share = ((end.cost - answer.sum).max(0.0) / room).sqrt();
            if (share - 1.0).abs() < NEAR {
                return if number == 0 { first } else { place };
            }
            let times = (1.0 / share).clamp(0.5, 2.0);
            let next = (answer.x[k] + times * (place - answer.x[k])).clamp(low, high);
            if next.total_cmp(&place).is_eq() {
                return place;
            }
            (place, x) = (next, end.x);
        }
        place
    }

    /// Least sum of squares near `x` with value `k` fixed.
    fn held(&self, k: usize, place: f64, mut x: Vec<f64>) -> Option<End> {
        let factor = libm::exp(place);
        let mut free = self.free.to_vec();
        free[k].factors = [factor; 2];
        x[k] = libm::log(factor);
        Problem { free: &free, ..self.by_ref() }.descend(x, HELD)
    }
}

impl<F> Problem<'_, F> {
    /// All starts, the file's first.
    pub(super) fn starts(&self) -> Vec<Vec<f64>> {
        let [few, of_link, of_arm] = OTHER_STARTS;
        let values = self.measurements.values();
        let others = match values.first() {
            _ if self.free.len() < 2 || self.measurements.has_files() => few,
            Some(first) if first.observable.arm_mode().is_some() => of_arm,
            _ => of_link,
        };
        (0..=others).map(|number| self.start(number)).collect()
    }

    /// Start 0 has the file's values; the others are Halton points in the logarithms. All delays are 0.
    fn start(&self, number: usize) -> Vec<f64> {
        const BASES: [usize; 8] = [2, 3, 5, 7, 11, 13, 17, 19];
        let reach = libm::log(FARTHEST_START);
        let place = |k: usize| {
            let [low, high] = self.bounds(k);
            let (low, high) = (low.max(-reach), high.min(reach));
            low + (high - low) * halton(number, BASES[k % BASES.len()])
        };
        let logarithm = |k: usize| if number == 0 { 0.0 } else { place(k) };
        let logarithms: Vec<f64> = (0..self.free.len()).map(logarithm).collect();
        let delays = self.measurements.records_with_free_delay().map(|_| 0.0);
        logarithms.iter().copied().chain(delays).collect()
    }
}

/// Point `number`, from 1, of Halton's sequence in (0, 1).
fn halton(number: usize, base: usize) -> f64 {
    let (mut rest, mut share, mut sum) = (number, 1.0, 0.0);
    while rest > 0 {
        share /= base as f64;
        sum += share * (rest % base) as f64;
        rest /= base;
    }
    sum
}
