//! Outliers: bad readings among good samples, which do not follow their neighbours.
//!
//! The search compares each sample with the cubic through its four nearest neighbours. A bad sample is far from it, and
//! without the bad sample all others nearby lie on their cubics. At a step or a corner of a motion, each sample
//! continues the samples on one side, and the samples nearby stay rough: such samples are not bad.
//!
//! Bad samples within a step or two spoil each other's cubics. The search removes two or three of them, a burst,
//! together and compares them with the cubic through the samples before and after them.

use super::bursts::bursts;
use super::course::{
    AROUND, CONTINUES, CONTINUES_DEVIATIONS, Change, Column, Course, DEVIATIONS, ENDS,
    LEFT_DEVIATIONS, Limits, NEAR, Noise, SECOND, UNNOTICED, kept,
};

/// A sample that does not follow its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Number of the sample.
    pub sample: usize,
    /// Value predicted by good neighbours.
    pub expected: f64,
}

/// Number of samples that predict one beyond them, in place of a bad one at an end.
const SIDE: usize = 6;
/// Fewest samples for a search.
const FEWEST: usize = 15;
/// Largest distance of the samples near a removed bad sample, over its distance: corners and steps leave more.
const LEFT: f64 = 0.1;
/// Limit of rounds; each removes the worst sample of every neighbourhood.
const ROUNDS: usize = 50;

/// Finds the samples that do not follow their neighbours, in their order.
///
/// Fewer than 15 samples are too few for a result.
///
/// ```
/// use flexlink::recording::{Change, outliers};
/// let time_s: Vec<f64> = (0..400).map(f64::from).collect();
/// let mut values: Vec<f64> = time_s.iter().map(|t| (0.01 * t).sin()).collect();
/// assert!(outliers(&time_s, &values, Change::Continuous).is_empty());
/// values[170] += 0.02;
/// values[171] += 0.03;
/// let found = outliers(&time_s, &values, Change::Continuous);
/// assert_eq!(found.len(), 2);
/// assert!(found[0].sample == 170 && (found[0].expected - 1.7_f64.sin()).abs() < 1e-4);
/// ```
pub fn outliers(time_s: &[f64], values: &[f64], change: Change) -> Vec<Outlier> {
    let mut good = Course { time_s: time_s.to_vec(), values: values.to_vec() };
    let mut numbers: Vec<usize> = (0..values.len()).collect();
    let mut bad = Vec::new();
    let limits = Limits::of(values);
    for _ in 0..ROUNDS {
        if numbers.len() < FEWEST {
            break;
        }
        let worst = worst(&Column::of(&good, &limits, change));
        if worst.is_empty() {
            break;
        }
        bad.extend(worst.iter().map(|k| numbers[*k]));
        let mut is_good = vec![true; numbers.len()];
        for k in worst {
            is_good[k] = false;
        }
        good = good.kept(&is_good);
        numbers = kept(&numbers, &is_good);
    }
    bad.sort_unstable();
    let led = |sample: usize| {
        let (at, after) = (time_s[sample], numbers.partition_point(|number| *number < sample));
        let lead = match numbers.len() {
            _ if after == 0 => good.fitted(at, &(0..SIDE).collect::<Vec<_>>(), 2),
            len if after == len => good.fitted(at, &(len - SIDE..len).collect::<Vec<_>>(), 2),
            _ => good.cubic(at, good.around(after, None)),
        };
        Outlier { sample, expected: lead.value }
    };
    let judged: Vec<_> = bad.into_iter().map(led).collect();
    // If a record is constant except for its pulses, the pulses are its signal.
    let rest = good.values.first().map_or(0.0, |first| {
        good.values.iter().map(|value| (value - first).abs()).fold(0.0, f64::max)
    });
    let most = judged.iter().map(|own| (values[own.sample] - own.expected).abs());
    if rest <= UNNOTICED * most.fold(0.0, f64::max) { Vec::new() } else { judged }
}

/// Numbers of the bad samples, the worst of each neighbourhood; without single bad samples, those of bursts.
fn worst(column: &Column) -> Vec<usize> {
    let len = column.off.len();
    let is_bad = |k: &usize| {
        let (own, distance) = (column.deviations[*k], column.off[*k].0.abs());
        let range = k.saturating_sub(NEAR).max(ENDS)..(k + NEAR + 1).min(len - ENDS);
        own > DEVIATIONS * column.noise
            && distance > column.limits.least
            && column.deviations[range].iter().all(|other| *other <= own)
            && is_alone(column, *k)
    };
    let mut bad: Vec<usize> = (ENDS..len - ENDS).filter(is_bad).collect();
    // Neighbours that are equally far off affect each other.
    bad.dedup_by(|next, before| *next - *before <= NEAR);
    if bad.is_empty() { bursts(column) } else { bad }
}

/// True for a sample farther off than the noise around it, if its neighbours are in order without it and it continues
/// neither the samples before nor those after it.
fn is_alone(column: &Column, k: usize) -> bool {
    let len = column.off.len();
    let around = k.saturating_sub(AROUND)..(k + AROUND + 1).min(len);
    let others = around.filter(|j| j.abs_diff(k) > 2).map(|j| column.deviations[j]);
    let noise = Noise::around(column.noise, others.collect());
    let off = column.off[k].0;
    let distance = off.abs();
    if column.deviations[k] <= noise.surely(DEVIATIONS) {
        return false;
    }
    let near = k.saturating_sub(2 * NEAR)..(k + 2 * NEAR + 1).min(len);
    let first = near.start;
    let mut without = column.course.part(near);
    without.values[k - first] -= off;
    // Distances over the allowed distance.
    let left_of = |j: usize| {
        let (off, gain) = without.off(j - first);
        off.abs() / (LEFT * distance).max(LEFT_DEVIATIONS * noise.deviation * gain)
    };
    let before = (k.saturating_sub(NEAR)..k).map(left_of).fold(0.0, f64::max);
    let after = (k + 1..(k + NEAR + 1).min(len)).map(left_of).fold(0.0, f64::max);
    // Another bad sample spoils the cubics of its neighbours up to two steps away.
    let reach = NEAR + 2;
    let has_second = before.min(after) <= 1.0
        && k >= reach
        && k + reach < len
        && (k - reach..=k + reach).any(|j| j != k && left_of(j) > SECOND / LEFT);
    if before.max(after) > 1.0 && !has_second {
        return false;
    }
    let within = (CONTINUES * distance).max(noise.surely(CONTINUES_DEVIATIONS));
    let before: Vec<usize> = (k.saturating_sub(SIDE + 1)..k).rev().collect();
    let after: Vec<usize> = (k + 1..(k + SIDE + 2).min(len)).collect();
    // At a step or a corner a sample may lie between its cubic and the predictions of both sides.
    let is_between = || {
        let leads = [&before, &after]
            .map(|side| column.course.fitted(column.course.time_s[k], &side[..2], 1).value);
        let value = column.course.values[k];
        let [a, b] = leads.map(|lead| lead - value);
        column.change == Change::Jumping && a.min(b).min(-off) <= 0.0 && a.max(b).max(-off) >= 0.0
    };
    let within = (within, noise.deviation);
    let is_led_to = |side: &Vec<usize>| column.course.is_led_to(k, side, within, column.change);
    !is_between() && ![&before, &after].into_iter().any(is_led_to)
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

    /// Indices of the motions without jumps.
    const PLACES: [usize; 7] = [0, 1, 3, 4, 6, 8, 9];

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
                    // Few samples of a fast motion with noise resemble bad ones.
                    if samples >= 50 {
                        for sigma in [1e-5, 1e-4, 1e-3, 1e-2] {
                            cases.push(
                                exact.iter().map(|x| x + sigma * normal(&mut noise)).collect(),
                            );
                        }
                    }
                    let is_place = PLACES.contains(&number);
                    let changes = [Change::Jumping].into_iter();
                    let changes = changes.chain(is_place.then_some(Change::Continuous));
                    for (change, values) in
                        changes.flat_map(|own| cases.iter().map(move |v| (own, v)))
                    {
                        tried += 1;
                        let motion = (number, samples, rest, shift);
                        assert_eq!(outliers(&time_s, values, change), [], "{motion:?}");
                    }
                }
            }
        }
        assert!(tried > 4000, "{tried}");
    }

    #[test]
    fn a_bad_sample_is_found_in_rest_and_motion_and_noise() {
        let mut noise = 7;
        for motion in [MOTIONS[0], MOTIONS[1], MOTIONS[9]] {
            for (sigma, off) in
                [(0.0, 4e-3), (0.0, 1.0), (1e-5, 4e-3), (4e-4, 1e-2), (4e-4, -0.3), (4e-4, 50.0)]
            {
                for bad in [0, 1, 2].into_iter().chain((3..240).step_by(9)).chain([239, 240]) {
                    let (time_s, exact) = sampled(motion, 200, 20, 0.0);
                    let mut values: Vec<f64> =
                        exact.iter().map(|x| x + sigma * normal(&mut noise)).collect();
                    values[bad] += off;
                    let found = outliers(&time_s, &values, Change::Continuous);
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
        let found = outliers(&time_s, &values, Change::Continuous);
        let found: Vec<usize> = found.iter().map(|own| own.sample).collect();
        assert_eq!(found, [30, 100, 104, 150, 156]);
    }

    #[test]
    fn a_record_that_is_nothing_but_pulses_has_none_that_is_bad() {
        let time_s: Vec<f64> = (0..60).map(f64::from).collect();
        let mut values = vec![0.0; 60];
        (values[20], values[40]) = (1.0, -1.0);
        assert_eq!(outliers(&time_s, &values, Change::Continuous), []);
    }
}
