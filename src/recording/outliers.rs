//! Samples that do not follow their neighbours: one bad reading among good ones.
//!
//! A sample is held against the cubic through its four nearest neighbours. A bad sample is far from it, and with it
//! taken out all others near it lie on their own cubics. Where a motion has a step or a corner, each sample
//! continues the samples on one side of it, and what is left near it is rough: neither is a bad sample.

use crate::numeric::largest;

/// A sample that does not follow its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Its number.
    pub sample: usize,
    /// Where its good neighbours lead to.
    pub expected: f64,
}

/// Samples before and after a sample that decide whether it is a bad one.
const NEAR: usize = 4;
/// The same that show the noise around it.
const AROUND: usize = 20;
/// Samples at both ends that are not judged: nothing leads there from both sides.
const ENDS: usize = 3;
/// Least distance of a bad sample in standard deviations of the noise.
const DEVIATIONS: f64 = 6.5;
/// Least distance in the smallest steps between samples: a counter flickers by one or two.
const QUANTA: f64 = 3.5;
/// Largest distance of the samples near it over its own, without it: corners and steps leave more.
const LEFT: f64 = 0.1;
/// The same in standard deviations of the noise.
const LEFT_DEVIATIONS: f64 = 4.0;
/// Least distance of another bad sample near it over its own.
const SECOND: f64 = 0.4;
/// Largest distance from what one side leads to, over the own, of a sample that continues it; and in standard
/// deviations of the noise.
const CONTINUES: f64 = 1.0 / 3.0;
const CONTINUES_DEVIATIONS: f64 = 4.5;
/// Distances over the largest value that are round-off.
const ROUND_OFF: f64 = 1e-12;
/// The same that no one notices.
const UNNOTICED: f64 = 1e-9;
/// Fewest distances of other samples that tell the noise of all.
const FEWEST: usize = 25;
/// Median and upper quartile of the absolute value of a normal variable.
const MEDIAN: f64 = 0.674_5;
const QUARTILE: f64 = 1.15;
/// Most rounds, each of which takes out the worst sample of every neighbourhood.
const ROUNDS: usize = 50;

/// The samples that do not follow their neighbours, in their order.
///
/// ```
/// use flexlink::recording::outliers;
/// let time_s: Vec<f64> = (0..400).map(f64::from).collect();
/// let mut values: Vec<f64> = time_s.iter().map(|t| (0.01 * t).sin()).collect();
/// assert!(outliers(&time_s, &values).is_empty());
/// values[170] += 0.02;
/// let found = outliers(&time_s, &values);
/// assert_eq!(found.len(), 1);
/// assert!(found[0].sample == 170 && (found[0].expected - 1.7_f64.sin()).abs() < 1e-4);
/// ```
pub fn outliers(time_s: &[f64], values: &[f64]) -> Vec<Outlier> {
    let mut good = Course { time_s: time_s.to_vec(), values: values.to_vec() };
    let mut numbers: Vec<usize> = (0..values.len()).collect();
    let mut bad = Vec::new();
    let limits = Limits::of(values);
    for _ in 0..ROUNDS {
        let worst = good.worst(&limits);
        if worst.is_empty() {
            break;
        }
        bad.extend(worst.iter().map(|k| numbers[*k]));
        let mut is_good = vec![true; numbers.len()];
        for k in worst {
            is_good[k] = false;
        }
        good.time_s = kept(&good.time_s, &is_good);
        good.values = kept(&good.values, &is_good);
        numbers = kept(&numbers, &is_good);
    }
    bad.sort_unstable();
    let led = |sample: usize| {
        let after = numbers.partition_point(|number| *number < sample);
        Outlier { sample, expected: good.at(time_s[sample], good.around(after, None)) }
    };
    let found: Vec<_> = bad.into_iter().map(led).collect();
    // A record that is constant without its pulses is made of them.
    let rest = good.values.first().map_or(0.0, |first| {
        good.values.iter().map(|value| (value - first).abs()).fold(0.0, f64::max)
    });
    let most = found.iter().map(|own| (values[own.sample] - own.expected).abs());
    if rest <= UNNOTICED * most.fold(0.0, f64::max) { Vec::new() } else { found }
}

fn kept<T: Copy>(all: &[T], is_good: &[bool]) -> Vec<T> {
    all.iter().zip(is_good).filter(|(_, good)| **good).map(|(own, _)| *own).collect()
}

/// Distances of a column that are nothing.
struct Limits {
    round_off: f64,
    /// Least distance of a bad sample.
    least: f64,
}

impl Limits {
    fn of(values: &[f64]) -> Self {
        let size = largest(values);
        let round_off = ROUND_OFF * size;
        let steps = values.windows(2).map(|two| (two[1] - two[0]).abs());
        let quantum = steps.filter(|step| *step > round_off).fold(f64::INFINITY, f64::min);
        let quantum = if quantum.is_finite() { quantum } else { 0.0 };
        Self { round_off, least: (QUANTA * quantum).max(UNNOTICED * size) }
    }
}

/// Samples over time.
struct Course {
    time_s: Vec<f64>,
    values: Vec<f64>,
}

impl Course {
    /// Numbers of the samples that are bad, the worst of each neighbourhood.
    fn worst(&self, limits: &Limits) -> Vec<usize> {
        let len = self.values.len();
        if len <= 2 * (NEAR + ENDS) {
            return Vec::new();
        }
        let off: Vec<(f64, f64)> = (0..len).map(|k| self.off(k)).collect();
        let deviations: Vec<f64> = off.iter().map(|(off, gain)| off.abs() / gain).collect();
        let mut rough: Vec<f64> =
            deviations.iter().copied().filter(|own| *own > limits.round_off).collect();
        let noise = if rough.len() < FEWEST { 0.0 } else { quantile(&mut rough, 0.5) / MEDIAN };
        let is_bad = |k: &usize| {
            let (own, distance) = (deviations[*k], off[*k].0.abs());
            let range = k.saturating_sub(NEAR).max(ENDS)..(k + NEAR + 1).min(len - ENDS);
            own > DEVIATIONS * noise
                && distance > limits.least
                && deviations[range].iter().all(|other| *other <= own)
                && self.is_alone(*k, off[*k].0, noise, &deviations)
        };
        let mut found: Vec<usize> = (ENDS..len - ENDS).filter(is_bad).collect();
        // Neighbours that are as far off lean on each other.
        found.dedup_by(|next, before| *next - *before <= NEAR);
        found
    }

    /// True of a sample that is farther off than the noise around it, without which its neighbours are in order, and
    /// that continues neither those before it nor those after it.
    fn is_alone(&self, k: usize, off: f64, noise: f64, deviations: &[f64]) -> bool {
        let len = self.values.len();
        let around = k.saturating_sub(AROUND)..(k + AROUND + 1).min(len);
        let mut others: Vec<f64> =
            around.filter(|j| j.abs_diff(k) > 2).map(|j| deviations[j]).collect();
        let noise = noise.max(quantile(&mut others, 0.75) / QUARTILE);
        let distance = off.abs();
        if deviations[k] <= DEVIATIONS * noise {
            return false;
        }
        let near = k.saturating_sub(2 * NEAR)..(k + 2 * NEAR + 1).min(len);
        let (first, own) = (near.start, k - near.start);
        let mut without =
            Self { time_s: self.time_s[near.clone()].to_vec(), values: self.values[near].to_vec() };
        without.values[own] -= off;
        // Distances over the largest that is in order.
        let left_of = |j: usize| {
            let (off, gain) = without.off(j - first);
            off.abs() / (LEFT * distance).max(LEFT_DEVIATIONS * noise * gain)
        };
        let before = (k.saturating_sub(NEAR)..k).map(left_of).fold(0.0, f64::max);
        let after = (k + 1..(k + NEAR + 1).min(len)).map(left_of).fold(0.0, f64::max);
        // Another bad sample spoils the cubics of its neighbours, two steps beyond it.
        let reach = NEAR + 2;
        let has_second = before.min(after) <= 1.0
            && k >= reach
            && k + reach < len
            && (k - reach..=k + reach).any(|j| j != k && left_of(j) > SECOND / LEFT);
        if before.max(after) > 1.0 && !has_second {
            return false;
        }
        let within = (CONTINUES * distance).max(CONTINUES_DEVIATIONS * noise);
        let continues = |expected: Option<f64>| {
            expected.is_some_and(|expected| (self.values[k] - expected).abs() < within)
        };
        ![(2, 1), (4, 1), (6, 2), (3, 2)].into_iter().any(|(samples, degree)| {
            let before = (k >= samples).then(|| self.led_to(k, k - samples, samples, degree));
            let fits = k + samples < len;
            continues(before) || continues(fits.then(|| self.led_to(k, k + 1, samples, degree)))
        })
    }

    /// Distance of a sample from the cubic through its neighbours, and the deviation of it over that of a sample.
    fn off(&self, k: usize) -> (f64, f64) {
        let neighbours = self.around(k, Some(k));
        let weights = self.weights(self.time_s[k], neighbours);
        let expected: f64 = weights.iter().zip(neighbours).map(|(w, j)| w * self.values[j]).sum();
        let squares: f64 = weights.iter().map(|w| w * w).sum();
        (self.values[k] - expected, (1.0 + squares).sqrt())
    }

    /// Numbers of the four samples nearest to where sample `k` is, without sample `left_out`.
    fn around(&self, k: usize, left_out: Option<usize>) -> [usize; 4] {
        let len = self.values.len();
        let own = usize::from(left_out.is_some());
        let first = k.saturating_sub(2).min(len - 4 - own);
        [0, 1, 2, 3].map(|j| {
            let at = first + j;
            if left_out.is_some_and(|own| at >= own) { at + 1 } else { at }
        })
    }

    fn at(&self, time_s: f64, samples: [usize; 4]) -> f64 {
        self.weights(time_s, samples).iter().zip(samples).map(|(w, j)| w * self.values[j]).sum()
    }

    /// Lagrange's weights of some samples at a time.
    fn weights(&self, time_s: f64, samples: [usize; 4]) -> [f64; 4] {
        samples.map(|i| {
            let others = samples.into_iter().filter(|j| *j != i);
            let at = |j: usize| (time_s - self.time_s[j]) / (self.time_s[i] - self.time_s[j]);
            others.map(at).product()
        })
    }

    /// Where a polynomial of degree 1 or 2 leads to at sample `k`, fitted to some samples by least squares.
    fn led_to(&self, k: usize, first: usize, samples: usize, degree: usize) -> f64 {
        let range = first..first + samples;
        let scale = (self.time_s[k] - self.time_s[first])
            .abs()
            .max((self.time_s[first + samples - 1] - self.time_s[k]).abs());
        let at = |j: usize| (self.time_s[j] - self.time_s[k]) / scale;
        // Gram–Schmidt over the samples: the polynomial at 0 is the sum of the parts at 0.
        let constant = self.values[range.clone()].iter().sum::<f64>() / samples as f64;
        let mean = range.clone().map(at).sum::<f64>() / samples as f64;
        let first_order = |u: f64| u - mean;
        let size = range.clone().map(|j| first_order(at(j)).powi(2)).sum::<f64>();
        let slope = range.clone().map(|j| first_order(at(j)) * self.values[j]).sum::<f64>() / size;
        let line = constant + slope * first_order(0.0);
        if degree < 2 {
            return line;
        }
        let squares = range.clone().map(|j| at(j).powi(2)).sum::<f64>() / samples as f64;
        let tilt = range.clone().map(|j| at(j).powi(2) * first_order(at(j))).sum::<f64>() / size;
        let second_order = |u: f64| u * u - squares - tilt * first_order(u);
        let size = range.clone().map(|j| second_order(at(j)).powi(2)).sum::<f64>();
        let bend = range.map(|j| second_order(at(j)) * self.values[j]).sum::<f64>() / size;
        line + bend * second_order(0.0)
    }
}

/// A quantile of numbers, which it reorders; 0 of no number.
fn quantile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number from 0 to that of the values"
    )]
    let at = (share * (values.len() - 1) as f64) as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// Normal numbers with a standard deviation of 1.
    fn normal(state: &mut u64) -> f64 {
        let mut part = || {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (*state >> 33) as f64 / f64::from(1_u32 << 31)
        };
        (-2.0 * libm::log(part().max(1e-300))).sqrt() * libm::cos(TAU * part())
    }

    fn least_jerk(u: f64) -> f64 {
        u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u)
    }

    /// Motions from 0 at u = 0 to 1, or back to 0: positions, velocities and accelerations, with steps and corners.
    const MOTIONS: [fn(f64) -> f64; 10] = [
        least_jerk,
        |u| 16.0 * u * u * (1.0 - u) * (1.0 - u),
        |u| 10.0 * u * (1.0 - u) * (1.0 - 2.0 * u),
        |u| if u < 0.5 { 2.0 * u * u } else { 1.0 - 2.0 * (1.0 - u) * (1.0 - u) },
        |u| 2.0 * u.min(1.0 - u),
        |u| {
            if u <= 0.0 || u >= 1.0 {
                0.0
            } else if u < 0.5 {
                1.0
            } else {
                -1.0
            }
        },
        |u| (5.0 * u.min(1.0 - u)).min(1.0),
        |u| {
            let half = if u < 0.5 { u } else { u - 0.5 };
            let size = (10.0 * half.min(0.5 - half)).min(1.0);
            if u < 0.5 { size } else { -size }
        },
        |u| u,
        |u| 0.5 - 0.5 * libm::cos(TAU * u),
    ];

    fn sampled(
        motion: fn(f64) -> f64,
        samples: u32,
        rest: u32,
        shift: f64,
    ) -> (Vec<f64>, Vec<f64>) {
        let times = 0..=samples + 2 * rest;
        let time_s: Vec<f64> =
            times.map(|k| (f64::from(k) - f64::from(rest) + shift) / f64::from(samples)).collect();
        let values = time_s.iter().map(|u| motion(u.clamp(0.0, 1.0))).collect();
        (time_s, values)
    }

    #[test]
    fn motions_have_no_bad_samples_however_they_are_sampled_rounded_or_noisy() {
        let mut noise = 49;
        let mut tried = 0;
        for (number, motion) in MOTIONS.into_iter().enumerate() {
            for samples in [5, 7, 14, 20, 33, 50, 100, 300] {
                for (rest, shift) in [(0, 0.0), (3, 0.3), (20, 0.0), (20, 0.5), (100, 0.3)] {
                    let (time_s, exact) = sampled(motion, samples, rest, shift);
                    let to = |unit: f64| exact.iter().map(|x| (x / unit).round() * unit).collect();
                    let mut cases: Vec<Vec<f64>> =
                        vec![exact.clone(), to(1e-2), to(1e-3), to(1e-5)];
                    cases.push(to(0.0137));
                    // Few samples of a fast motion with noise cannot be told from bad ones.
                    if samples >= 50 {
                        for sigma in [1e-5, 1e-4, 1e-3, 1e-2] {
                            cases.push(
                                exact.iter().map(|x| x + sigma * normal(&mut noise)).collect(),
                            );
                        }
                    }
                    for values in cases {
                        tried += 1;
                        let motion = (number, samples, rest, shift);
                        assert_eq!(outliers(&time_s, &values), [], "{motion:?}");
                    }
                }
            }
        }
        assert!(tried > 2000, "{tried}");
    }

    #[test]
    fn a_bad_sample_is_found_in_rest_and_motion_and_noise() {
        let mut noise = 7;
        for motion in [MOTIONS[0], MOTIONS[1], MOTIONS[9]] {
            for (sigma, off) in
                [(0.0, 4e-3), (0.0, 1.0), (1e-5, 4e-3), (4e-4, 1e-2), (4e-4, -0.3), (4e-4, 50.0)]
            {
                for bad in (ENDS..240 - ENDS).step_by(9) {
                    let (time_s, exact) = sampled(motion, 200, 20, 0.0);
                    let mut values: Vec<f64> =
                        exact.iter().map(|x| x + sigma * normal(&mut noise)).collect();
                    values[bad] += off;
                    let found = outliers(&time_s, &values);
                    assert_eq!(found.len(), 1, "{bad}, {off} in {sigma}: {found:?}");
                    assert_eq!(found[0].sample, bad);
                    let wrong = (found[0].expected - exact[bad]).abs();
                    assert!(wrong < 4.0 * sigma + 1e-4, "{bad}: {wrong}");
                }
            }
        }
    }

    #[test]
    fn several_bad_samples_are_found_at_uneven_times() {
        let (mut time_s, _) = sampled(least_jerk, 200, 20, 0.0);
        for (k, time_s) in time_s.iter_mut().enumerate() {
            *time_s += 1e-3 * libm::sin(k as f64);
        }
        let exact = |u: f64| least_jerk(u.clamp(0.0, 1.0));
        let mut values: Vec<f64> = time_s.iter().map(|u| exact(*u)).collect();
        for (sample, off) in [(30, 0.02), (100, -0.01), (104, 0.02), (150, -2.0), (156, 2.0)] {
            values[sample] += off;
        }
        let found: Vec<usize> = outliers(&time_s, &values).iter().map(|own| own.sample).collect();
        assert_eq!(found, [30, 100, 104, 150, 156]);
    }

    #[test]
    fn a_record_that_is_nothing_but_pulses_has_none_that_is_bad() {
        let time_s: Vec<f64> = (0..60).map(f64::from).collect();
        let mut values = vec![0.0; 60];
        (values[20], values[40]) = (1.0, -1.0);
        assert_eq!(outliers(&time_s, &values), []);
    }
}
