//! Bursts: two or three bad samples within a few steps, and bad samples at the ends of a column.
//!
//! Samples of a burst spoil each other's cubics; samples at the ends have neighbours on one side only. The search
//! removes a burst as a whole and compares it with the cubic through the samples before and after it. At an end the
//! comparison is with the parabola through the samples on one side.

use std::ops::Range;

use super::course::{
    AROUND, CONTINUES, CONTINUES_DEVIATIONS, Change, Column, Course, DEVIATIONS, ENDS,
    LEFT_DEVIATIONS, Lead, NEAR, Noise, SECOND, quantile,
};
use crate::numeric::{extremes, largest};

/// Samples of each burst, relative to its first. The first burst is one sample at an end.
const BURSTS: [&[usize]; 8] =
    [&[0], &[0, 1], &[0, 2], &[0, 3], &[0, 1, 2], &[0, 1, 3], &[0, 2, 3], &[0, 2, 4]];
/// Farthest first sample of a burst before and after the worst sample, in samples.
const REACH: [usize; 2] = [5, 3];
/// Number of samples that predict one beyond them.
const SIDE: usize = 6;
/// Fewest samples of a column for a search of bursts.
const FEWEST: usize = 20;
/// Smallest distance of a sample near a burst, in standard deviations of the noise.
const SEED: f64 = 3.0;
/// Largest distance of the samples near a removed burst, over the burst's distance; also with the burst moved aside.
const LEFT: f64 = 0.05;
const LEFT_ASIDE: f64 = 0.1;
/// Smallest distance of a sample in or beside a burst from its neighbours, over the largest in the burst: a narrow bend
/// shows less.
const SHOWN: f64 = 0.3;
/// Polynomials that predict a burst at an end (samples, degree): a rest, a line, a curve.
const LEADS_OF_ENDS: [(usize, usize); 5] = [(1, 0), (2, 1), (4, 1), (3, 2), (6, 2)];

/// Numbers of the samples in bursts, and of bad samples at the ends.
pub(super) fn bursts(column: &Column) -> Vec<usize> {
    let len = column.off.len();
    let is_seed = |k: &usize| {
        let own = column.deviations[*k];
        let near = k.saturating_sub(NEAR)..(k + NEAR + 1).min(len);
        let around = k.saturating_sub(AROUND)..(k + AROUND + 1).min(len);
        own > (SEED * column.noise).max(column.limits.round_off)
            && column.deviations[near].iter().all(|other| *other <= own)
            && own > SEED * quantile(&mut column.deviations[around].to_vec(), 0.4)
    };
    let is_end = |k: &usize| column.change == Change::Continuous && (*k == 0 || k + 1 == len);
    let mut found: Vec<usize> = Vec::new();
    for k in (0..len).filter(|k| is_end(k) || is_seed(k)) {
        let last = found.last().copied();
        if let Some(samples) = fewest(column, k)
            && last.is_none_or(|last| last + NEAR + 2 < samples[0])
        {
            found.extend(samples);
        }
    }
    found
}

/// The smallest burst near sample `k` that explains its distance from its neighbours; of equal ones, the burst that
/// leaves the smallest distances.
fn fewest(column: &Column, k: usize) -> Option<Vec<usize>> {
    let mut best: Option<(usize, f64, Vec<usize>)> = None;
    for steps in BURSTS {
        for first in k.saturating_sub(REACH[0])..=k + REACH[1] {
            let samples: Vec<usize> = steps.iter().map(|own| first + own).collect();
            let is_open = best.as_ref().is_none_or(|(most, ..)| steps.len() <= *most);
            let left =
                if is_open { Burst::of(column, &samples).and_then(|own| own.left()) } else { None };
            if let Some(left) = left
                && best.as_ref().is_none_or(|(_, least, _)| left < *least)
            {
                best = Some((steps.len(), left, samples));
            }
        }
    }
    best.map(|(.., samples)| samples)
}

/// A candidate of a burst, and the values that the samples around it predict.
struct Burst<'a> {
    column: &'a Column<'a>,
    samples: &'a [usize],
    first: usize,
    last: usize,
    /// Samples before the burst, and after it, nearest first.
    sides: [Vec<usize>; 2],
    /// Good samples that predict a burst at an end, nearest first.
    inside: Option<Vec<usize>>,
    leads: Vec<Lead>,
    off: Vec<f64>,
    /// Smallest absolute distance in `off`.
    distance: f64,
}

impl<'a> Burst<'a> {
    /// A burst that lies in the column and can be judged.
    fn of(column: &'a Column<'a>, samples: &'a [usize]) -> Option<Self> {
        let (course, len) = (column.course, column.off.len());
        let (first, last) = (samples[0], samples[samples.len() - 1]);
        let is_inner = first >= ENDS && last + ENDS < len;
        let is_continuous = column.change == Change::Continuous;
        let is_judged = match samples {
            _ if last >= len => false,
            [_] => !is_inner && is_continuous,
            _ => len >= FEWEST && (is_inner || is_continuous),
        };
        if !is_judged {
            return None;
        }
        let before: Vec<usize> = (first.saturating_sub(3 * SIDE)..first).rev().collect();
        let after: Vec<usize> = (last + 1..(last + 1 + 3 * SIDE).min(len)).collect();
        let between = || (first..last).filter(|j| !samples.contains(j));
        let inside: Option<Vec<usize>> = match (first == 0, last + 1 == len) {
            (true, _) => Some(between().chain(after.iter().copied()).collect()),
            (_, true) => Some(between().rev().chain(before.iter().copied()).collect()),
            _ => None,
        };
        if inside.as_ref().is_some_and(|inside| inside.len() < 2 * SIDE) {
            return None;
        }
        let lead = |k: &usize| match &inside {
            Some(inside) => course.fitted(course.time_s[*k], &inside[..SIDE], 2),
            None => course.across(*k, [first, last]),
        };
        let leads: Vec<Lead> = samples.iter().map(lead).collect();
        let off = samples.iter().zip(&leads).map(|(k, lead)| course.values[*k] - lead.value);
        let off: Vec<f64> = off.collect();
        let distance = off.iter().fold(f64::INFINITY, |least, off| least.min(off.abs()));
        let sides = [before, after];
        Some(Self { column, samples, first, last, sides, inside, leads, off, distance })
    }

    /// Largest distance of the samples near the removed burst, over the allowed distance; `None` if the burst is not
    /// bad.
    fn left(&self) -> Option<f64> {
        let whole = Noise { deviation: self.column.noise, doubt: 1.0 };
        if self.distance <= self.column.limits.least
            || !self.is_beyond(whole)
            || (self.column.change == Change::Jumping && self.is_pulse())
            || (self.inside.is_none() && !self.is_shown())
        {
            return None;
        }
        let start = self.first.saturating_sub(AROUND);
        let range = start..(self.last + AROUND + 1).min(self.column.off.len());
        let mut without = self.column.course.part(range.clone());
        for (k, lead) in self.samples.iter().zip(&self.leads) {
            without.values[k - start] = lead.value;
        }
        let others = range.filter(|j| !self.samples.contains(j));
        let others: Vec<(usize, (f64, f64))> =
            others.map(|j| (j, without.off(j - start))).collect();
        let deviations = others.iter().map(|(_, (off, gain))| off.abs() / gain);
        let noise = Noise::around(whole.deviation, deviations.collect());
        if !self.is_beyond(noise) {
            return None;
        }
        let (left, has_second) = self.left_near(&others, noise);
        if left > 1.0 && !has_second {
            return None;
        }
        if let Some(inside) = &self.inside {
            let at_end = self.left_inside(inside, noise);
            return (at_end <= 1.0 && !self.continues_at_end(inside, noise))
                .then_some(left.max(at_end));
        }
        // The burst at other places shows how far such cubics are off without bad samples.
        let aside = self.aside(&without, start);
        let far = aside.iter().filter(|(shift, ..)| self.samples.len() == 1 || *shift > 2);
        let far = far.map(|(_, off, gain)| off / gain).collect();
        let noise = Noise { doubt: noise.doubt, ..Noise::around(noise.deviation, far) };
        let is_rough = |(shift, off, gain): &(usize, f64, f64)| {
            let most = (LEFT_ASIDE * self.distance).max(LEFT_DEVIATIONS * noise.deviation * gain);
            *shift <= NEAR && *off > most
        };
        let is_bad = self.is_beyond(noise)
            && (has_second || !aside.iter().any(is_rough))
            && !self.continues(noise)
            && !self.is_corner(noise);
        is_bad.then_some(left)
    }

    /// True if all samples of the burst are farther off than noise.
    fn is_beyond(&self, noise: Noise) -> bool {
        let mut all = self.off.iter().zip(&self.leads);
        all.all(|(off, lead)| off.abs() > noise.surely(DEVIATIONS) * lead.gain)
    }

    /// True if adjacent samples are off to the same side.
    fn is_pulse(&self) -> bool {
        let mut pairs = self.samples.windows(2).zip(self.off.windows(2));
        pairs.any(|(at, off)| at[1] - at[0] == 1 && off[0] * off[1] > 0.0)
    }

    /// True if the burst shows in the distances of samples from their neighbours.
    fn is_shown(&self) -> bool {
        let beside = self.first.saturating_sub(2)..(self.last + 3).min(self.column.off.len());
        let beside = self.column.off[beside].iter().map(|(off, _)| off.abs());
        beside.fold(0.0, f64::max) >= SHOWN * largest(&self.off)
    }

    /// Largest distance near the burst over the allowed distance, and true if another bad sample on one side causes it.
    fn left_near(&self, others: &[(usize, (f64, f64))], noise: Noise) -> (f64, bool) {
        let Self { first, last, distance, .. } = *self;
        let reach = NEAR + 2;
        let near = others.iter().filter(|(j, _)| j + reach >= first && *j <= last + reach);
        let near = near.map(|(j, (off, gain))| {
            let most = (LEFT * distance).max(LEFT_DEVIATIONS * noise.deviation * gain);
            (*j, off.abs() / most)
        });
        let near: Vec<(usize, f64)> = near.collect();
        let worst = |range: Range<usize>| {
            let within = near.iter().filter(|(j, _)| range.contains(j));
            within.map(|(_, left)| *left).fold(0.0, f64::max)
        };
        let [before, between, after] = [
            worst(first.saturating_sub(NEAR)..first),
            worst(first..last),
            worst(last + 1..last + NEAR + 1),
        ];
        let has_second = before.min(after).max(between) <= 1.0
            && first >= reach
            && last + reach < self.column.off.len()
            && near.iter().any(|(_, left)| *left > SECOND / LEFT);
        (before.max(between).max(after), has_second)
    }

    /// Largest distance of the samples beside a burst at an end from the parabola through samples farther inside, over
    /// the allowed distance.
    fn left_inside(&self, inside: &[usize], noise: Noise) -> f64 {
        let course = self.column.course;
        let left = (0..SIDE).map(|j| {
            let k = inside[j];
            let lead = course.fitted(course.time_s[k], &inside[j + 1..=j + SIDE], 2);
            let most = (LEFT * self.distance).max(LEFT_DEVIATIONS * noise.deviation * lead.gain);
            (course.values[k] - lead.value).abs() / most
        });
        left.fold(0.0, f64::max)
    }

    /// True if one of the burst's samples lies where a rest, a line or a curve may have led to the samples inside.
    fn continues_at_end(&self, inside: &[usize], noise: Noise) -> bool {
        let course = self.column.course;
        let mut all = self.samples.iter().zip(&self.off);
        all.any(|(k, off)| {
            let leads = LEADS_OF_ENDS.map(|(samples, degree)| {
                course.fitted(course.time_s[*k], &inside[..samples], degree).value
            });
            let [low, high] = extremes(&leads);
            let within = (CONTINUES * off.abs()).max(noise.surely(CONTINUES_DEVIATIONS));
            (low - within..=high + within).contains(&course.values[*k])
        })
    }

    /// The burst moved to other places of a course that begins at sample `start`: shift in samples, distance, and its
    /// deviation over that of a sample.
    fn aside(&self, course: &Course, start: usize) -> Vec<(usize, f64, f64)> {
        let len = course.values.len();
        let (first, last) = (self.first - start, self.last - start);
        // Needs as many samples on either side as the burst has.
        let fewest = self.sides.iter().map(Vec::len).fold(2, usize::min);
        let mut found = Vec::new();
        for to in fewest..len.saturating_sub(last - first + fewest) {
            let moved = [to, to + last - first];
            let shift = to.abs_diff(first);
            if shift == 0 || shift > AROUND || len - 1 - (moved[1] - moved[0]) < 4 {
                continue;
            }
            for k in self.samples.iter().map(|own| own - self.first + to) {
                let lead = course.across(k, moved);
                found.push((shift, (course.values[k] - lead.value).abs(), lead.gain));
            }
        }
        found
    }

    /// True if the burst's samples continue the samples before it up to some sample, and from there on the samples
    /// after it, as beside a step.
    fn continues(&self, noise: Noise) -> bool {
        let course = self.column.course;
        let continues = |number: usize, side: &[usize]| {
            let k = self.samples[number];
            let within =
                (CONTINUES * self.off[number].abs()).max(noise.surely(CONTINUES_DEVIATIONS));
            let rest = || (course.values[k] - course.values[side[0]]).abs() < within;
            // Several samples are not predicted by chance.
            let chance = if self.samples.len() > 1 { 0.0 } else { noise.deviation };
            (side.len() < 4 && rest())
                || course.is_led_to(k, side, (within, chance), Change::Jumping)
        };
        let [before, after] = &self.sides;
        let len = self.samples.len();
        (0..=len).any(|split| {
            (0..split).all(|own| continues(own, before))
                && (split..len).all(|own| continues(own, after))
        })
    }

    /// True if a sample lies between the cubics from both sides, which differ by more than noise: as where the jerk of
    /// a smooth motion jumps.
    fn is_corner(&self, noise: Noise) -> bool {
        let course = self.column.course;
        let mut all = self.samples.iter().zip(self.leads.iter().zip(&self.off));
        all.any(|(k, (lead, off))| {
            let beyond = self.sides.iter().filter(|side| side.len() >= 4).map(|side| {
                let other = course.fitted(course.time_s[*k], &side[..4], 3);
                let apart = other.value - lead.value;
                let noise = noise.surely(CONTINUES_DEVIATIONS) * other.gain;
                lead.value + apart.signum() * (apart.abs() - noise).max(0.0)
            });
            let beyond: Vec<f64> = beyond.chain([lead.value]).collect();
            let [low, high] = extremes(&beyond);
            let (value, within) = (course.values[*k], CONTINUES * off.abs());
            value > low - within && value < high + within
        })
    }
}
