//! Length of the period, its part worth writing, and the return of chords within it.

use std::ops::Range;

use super::analysis::Analysis;
use super::error::InversionError;
use crate::elastica::returning;
use crate::motion::{TipMotion, TipSpectrum};
use crate::numeric::{TimeGrid, fast_length, largest};

/// Most samples of a period.
const LONGEST: usize = 1 << 24;

/// Memory in bytes of the solver for each sample of the period, and for each solved frequency, as measured.
const BYTES_PER_SAMPLE: usize = 210;
const BYTES_PER_FREQUENCY: usize = 360;

/// Most samples of a lengthened period, unless four times its initial length are more.
const LENGTHENED: usize = 1 << 20;

/// Samples before and after those of the trajectory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Padding {
    pub(super) before: usize,
    pub(super) after: usize,
    /// Samples of the shortest period of a periodic motion, without padding.
    pub(super) cycles: Option<usize>,
}

impl Padding {
    /// Padding that lets the torque decay to a tenth of the tolerance, as e^{z₁t} before and e^{−z₁t} after the motion.
    /// Rest within the trajectory counts.
    pub(super) fn new(motion: &TipMotion, analysis: &Analysis, first_zero: Option<f64>) -> Self {
        let moving = (motion.cycles(), motion.moving_samples());
        Self::around(moving, motion.grid(), analysis, first_zero)
    }

    /// Padding of a motion from sample `first` to sample `last` of its grid; a period of `cycles` samples needs none.
    pub(super) fn around(
        (cycles, (first, last)): (Option<usize>, (usize, usize)),
        TimeGrid { step_s, len, .. }: TimeGrid,
        analysis: &Analysis,
        first_zero: Option<f64>,
    ) -> Self {
        if cycles.is_some() {
            return Self { before: 0, after: 0, cycles };
        }
        let decay_s = first_zero.map_or(0.0, |z| libm::log(10.0 / analysis.tolerance()) / z);
        let decay = (decay_s / step_s).ceil() as usize;
        let requested = |time_s: Option<f64>| steps(time_s.unwrap_or(0.0), step_s);
        Self {
            before: decay.saturating_sub(first).max(requested(analysis.lead_s())),
            after: decay.saturating_sub(len - 1 - last).max(requested(analysis.lag_s())),
            cycles: None,
        }
    }

    /// Length of the period in samples for a motion of `len` samples.
    ///
    /// # Errors
    /// [`InversionError::TooLong`].
    pub(super) fn period_len(self, len: usize) -> Result<usize, InversionError> {
        let samples = len.saturating_add(self.before).saturating_add(self.after);
        if samples > LONGEST {
            return Err(InversionError::TooLong { samples, limit: LONGEST });
        }
        Ok(self.cycles.unwrap_or_else(|| fast_length(samples)))
    }

    /// First sample of a period of `len` samples that lies before a motion of `given` samples in time; both sides share
    /// the spare samples.
    pub(super) fn seam(self, given: usize, len: usize) -> usize {
        if self.cycles.is_some() {
            return len;
        }
        given + self.after + (len - given - self.before - self.after) / 2
    }

    /// The next longer period to try. `None` at the limit.
    pub(super) fn lengthened(current: usize, initial: usize) -> Option<usize> {
        let limit = LENGTHENED.max(4 * initial).min(LONGEST);
        (2 * current <= limit).then(|| fast_length(2 * current))
    }
}

/// Refuses a period that exceeds the memory limit.
///
/// # Errors
/// [`InversionError::TooMuchMemory`].
pub(super) fn check_memory(
    samples: usize,
    frequencies: usize,
    memory_bytes: Option<usize>,
) -> Result<(), InversionError> {
    let bytes = samples * BYTES_PER_SAMPLE + frequencies * BYTES_PER_FREQUENCY;
    match memory_bytes.filter(|allowed| bytes > *allowed) {
        Some(allowed) => Err(InversionError::TooMuchMemory { bytes, allowed }),
        None => Ok(()),
    }
}

/// Whole steps that cover a time.
fn steps(time_s: f64, step_s: f64) -> usize {
    // A lead of 0.5 s at 1 ms must be 500 steps, whatever the last bit of the quotient.
    (time_s / step_s * (1.0 - 1e-12)).ceil() as usize
}

/// First and last sample to write, in the trajectory's numbering.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) start: i64,
    pub(super) stop: i64,
}

impl Window {
    /// Number of samples.
    pub(super) fn len(&self) -> usize {
        (self.stop - self.start + 1) as usize
    }
}

/// The torque over a period that begins in the middle of the rest: samples from `before` on are one period earlier, as
/// in the motion's histories.
pub(super) struct PeriodicTorque<'a> {
    pub(super) samples: &'a [f64],
    /// The first sample whose time is one period earlier.
    pub(super) before: usize,
    /// Samples on either side of `before` that measure the remainder where periods meet.
    pub(super) reach: usize,
}

impl PeriodicTorque<'_> {
    /// Torque from sample `from` of the trajectory's numbering, negative before it, to before sample `to`, at most a
    /// period later. Two parts cover samples on both sides of the period's end.
    fn part(&self, from: i64, to: i64) -> [&[f64]; 2] {
        let len = self.samples.len();
        let first = from.rem_euclid(len as i64) as usize;
        let end = first + (to - from).max(0) as usize;
        [&self.samples[first..end.min(len)], &self.samples[..end.saturating_sub(len)]]
    }

    /// Largest torque of a [`Self::part`].
    fn largest(&self, from: i64, to: i64) -> f64 {
        let [a, b] = self.part(from, to);
        largest(a).max(largest(b))
    }

    /// First and last sample of the period in the trajectory's numbering.
    fn ends(&self) -> (i64, i64) {
        let before = self.before as i64;
        (before - self.samples.len() as i64, before - 1)
    }

    pub(super) fn peak(&self) -> f64 {
        largest(self.samples)
    }

    /// Largest torque around the middle of the rest, where one period meets the next.
    pub(super) fn at_seam(&self) -> f64 {
        let (reach, seam) = (self.reach as i64, self.before as i64);
        self.largest(seam - reach, seam + reach)
    }

    /// The part of the period to write: the trajectory's samples with the analysis's lead and lag or, without these,
    /// until the torque stays below the tolerance of `peak`.
    pub(super) fn window(&self, len: usize, step_s: f64, analysis: &Analysis, peak: f64) -> Window {
        let (begin, end) = self.ends();
        let last = len as i64 - 1;
        let acts = |torque: &f64| torque.abs() > analysis.tolerance() * peak;
        let before_it_acts = || {
            let mut early = self.part(begin, 0).into_iter().flatten();
            early.position(acts).map_or(0, |k| begin + k as i64 - 1)
        };
        let after_it_acts = || {
            let mut late = self.part(last + 1, end + 1).into_iter().flatten().rev();
            late.position(acts).map_or(last, |k| end - k as i64 + 1)
        };
        let requested = |time_s: f64| steps(time_s, step_s) as i64;
        let start = analysis.lead_s().map_or_else(before_it_acts, |lead_s| -requested(lead_s));
        let stop = analysis.lag_s().map_or_else(after_it_acts, |lag_s| last + requested(lag_s));
        Window { start: start.max(begin), stop: stop.min(end) }
    }

    /// Largest torque outside the window.
    pub(super) fn outside(&self, window: &Window) -> f64 {
        let (begin, end) = self.ends();
        self.largest(begin, window.start).max(self.largest(window.stop + 1, end + 1))
    }
}

/// Duration of a chord's return, over the time constant of the torque's decay. At its ends the torque differs from that
/// at rest by about 5e-11 of its range: `e^(−30 + s²/2)`, where the bell's standard deviation is s = 3.5 of those
/// times.
const RETURN: f64 = 60.0;

/// Fewest samples of a return: they cannot resolve products at the frequencies of a faster one.
const FEWEST: usize = 256;

/// Samples of rest before the return and after it, at least.
const AT_REST: usize = 2;

/// Share of a period's spare time for the return; the torque decays in the rest.
const SPARE_FOR_RETURN: f64 = 0.2;

/// Most samples of a lengthened period, unless four times its initial length are more.
const LENGTHENED_RETURN: usize = 1 << 15;

/// Return of the chords within a period; without weight they need none.
#[derive(Debug, Clone, Copy)]
pub(super) struct Return {
    /// Fewest samples of the chord's return.
    fewest: usize,
}

impl Return {
    /// A period without a return.
    pub(super) const NONE: Self = Self { fewest: 0 };

    /// The return of the chords of `links` links for torques that decay as e^(−z₁t), `z₁` the smallest of their zeros.
    /// More links return more slowly: each inner link amplifies the fast motion of the outer ones on its way to the
    /// first joint.
    pub(super) fn of(links: usize, first_zero_per_s: Option<f64>, grid: &TimeGrid) -> Self {
        let falls_s = first_zero_per_s.map_or(grid.duration_s() / RETURN, f64::recip);
        let steps = (links as f64 * RETURN * falls_s / grid.step_s).ceil() as usize;
        Self { fewest: steps.max(FEWEST) }
    }

    /// Samples of the shortest period for a motion of `given` samples.
    pub(super) fn shortest_len(
        self,
        padding: Padding,
        given: usize,
    ) -> Result<usize, InversionError> {
        let returning = if self.fewest == 0 { 0 } else { self.fewest.saturating_add(2 * AT_REST) };
        padding.period_len(given.saturating_add(returning))
    }

    /// The samples of the chord's return in a period.
    pub(super) fn samples(self, padding: Padding, given: usize, len: usize) -> Range<usize> {
        let spare = len - given - padding.before - padding.after;
        let further = spare.saturating_sub(self.fewest + 2 * AT_REST);
        let count = match self.fewest {
            0 => 0,
            fewest => fewest + (SPARE_FOR_RETURN * further as f64) as usize,
        };
        let from = given + padding.after + (spare - count) / 2;
        from..from + count
    }
}

/// The next longer period to try, or the longest. `None` if `len` is the longest. Skips periods too short for linear
/// torques to decay (see `decays`): torques with second-order terms rarely decay in them.
pub(super) fn lengthened<E>(
    len: usize,
    initial: usize,
    decays: impl Fn(usize) -> Result<bool, E>,
) -> Result<Option<usize>, E> {
    let longer = |len: usize| {
        let longer = Padding::lengthened(len, initial);
        longer.filter(|len| *len <= LENGTHENED_RETURN.max(4 * initial))
    };
    let Some(mut next) = longer(len) else { return Ok(None) };
    while let Some(longer) = longer(next) {
        if decays(next)? {
            break;
        }
        next = longer;
    }
    Ok(Some(next))
}

/// Remaining travel of a returning chord at each sample of its return. Before the seam it counts from the motion's end,
/// behind the seam to the motion's start.
pub(super) fn left_to_return(
    travel: f64,
    samples: &Range<usize>,
    seam: usize,
) -> impl Iterator<Item = (usize, f64)> {
    let shares = returning(0.0, 1.0, samples.len());
    samples.clone().zip(shares).map(move |(k, share)| {
        let left = if k < seam { -share } else { 1.0 - share };
        (k, travel * left)
    })
}

/// The parts of a period at rest, before the motion and after it.
#[derive(Debug, Clone)]
pub(super) struct Rest {
    /// Samples of the chord's return; empty without weight.
    returning: Range<usize>,
    len: usize,
    seam: usize,
    seam_reach: usize,
}

impl Rest {
    /// The rest of a period with this return of the chords.
    pub(super) fn of(spectrum: &TipSpectrum, seam_reach: usize, returning: Range<usize>) -> Self {
        Self { returning, len: spectrum.pair.len(), seam: spectrum.seam, seam_reach }
    }

    /// Samples of the period less their values at rest before the motion and after it; 0 while the chord returns.
    pub(super) fn beyond(&self, samples: &[f64], rests: [f64; 2]) -> Vec<f64> {
        let beyond = samples.iter().enumerate().map(|(k, value)| match k {
            _ if self.returning.contains(&k) => 0.0,
            _ if k < self.until() => value - rests[1],
            _ => value - rests[0],
        });
        beyond.collect()
    }

    /// Samples of a period outside the chord's return, from its end on.
    pub(super) fn outside_return(&self, values: &[f64]) -> Vec<f64> {
        values[self.start()..].iter().chain(&values[..self.until()]).copied().collect()
    }

    /// Numbers of samples that measure rest before the motion and after it: the reach around a seam, at most half of
    /// the rest.
    pub(super) fn reaches(&self, given: usize) -> [usize; 2] {
        let there = [self.len - self.start(), self.until().saturating_sub(given)];
        there.map(|samples| self.seam_reach.min(samples / 2).max(1))
    }

    /// First sample of the rest before the motion.
    fn start(&self) -> usize {
        if self.returning.is_empty() { self.seam } else { self.returning.end }
    }

    /// First sample behind the rest after the motion.
    fn until(&self) -> usize {
        if self.returning.is_empty() { self.seam } else { self.returning.start }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_period_is_doubled_to_a_million_samples_or_four_times_what_it_began_with() {
        assert_eq!(Padding::lengthened(1000, 500), Some(fast_length(2000)));
        assert_eq!(Padding::lengthened(1 << 19, 1000), Some(1 << 20));
        assert_eq!(Padding::lengthened(1 << 20, 1000), None);
        assert_eq!(Padding::lengthened(1 << 21, 1 << 20), Some(1 << 22));
        assert_eq!(Padding::lengthened(1 << 22, 1 << 20), None);
        assert_eq!(Padding::lengthened(1 << 23, 1 << 23), Some(1 << 24));
        assert_eq!(Padding::lengthened(1 << 24, 1 << 23), None, "the most that is transformed");
        assert_eq!(Padding::lengthened(3 << 18, 1000), None, "twice as many would be more");
    }

    #[test]
    fn a_period_may_be_as_long_as_the_most_samples_and_no_longer() {
        let padding = Padding { before: 100, after: 23, cycles: None };
        assert_eq!(padding.period_len(LONGEST - 123), Ok(fast_length(LONGEST)));
        let samples = LONGEST + 1;
        let error = InversionError::TooLong { samples, limit: LONGEST };
        assert_eq!(padding.period_len(LONGEST - 122), Err(error));
    }

    /// A period of 20 samples, five of them before the trajectory, with a torque between two samples.
    fn acting(from: i64, to: i64) -> Vec<f64> {
        (0..20)
            .map(
                |k| {
                    if (from..=to).contains(&(k - if k < 15 { 0 } else { 20 })) { 2.0 } else { 0.0 }
                },
            )
            .collect()
    }

    fn window(samples: &[f64], lead_s: Option<f64>, lag_s: Option<f64>) -> (i64, i64, f64) {
        let torque = PeriodicTorque { samples, before: 15, reach: 2 };
        let analysis = Analysis::new(1e-6, lead_s, lag_s).unwrap();
        let window = torque.window(4, 0.1, &analysis, 2.0);
        assert_eq!(window.len(), usize::try_from(window.stop - window.start).unwrap() + 1);
        (window.start, window.stop, torque.outside(&window))
    }

    #[test]
    fn a_window_begins_and_ends_with_a_sample_of_rest_around_torque_and_motion() {
        assert_eq!(window(&acting(-3, 8), None, None), (-4, 9, 0.0));
        for (from, to) in [(0, 0), (1, 2), (0, 3), (3, 3)] {
            let found = window(&acting(from, to), None, None);
            assert_eq!(found, (0, 3, 0.0), "{from} to {to}: within the trajectory");
        }
        assert_eq!(window(&acting(-5, 14), None, None), (-5, 14, 0.0), "all of the period");
    }

    #[test]
    fn a_window_of_given_lead_and_lag_ends_at_the_latest_with_the_period() {
        assert_eq!(window(&acting(-3, 8), Some(0.3), Some(0.5)), (-3, 8, 0.0));
        assert_eq!(window(&acting(-3, -3), Some(0.2), Some(0.5)), (-2, 8, 2.0));
        assert_eq!(window(&acting(8, 8), Some(0.2), Some(0.4)), (-2, 7, 2.0));
        assert_eq!(window(&acting(-5, -5), Some(0.4), Some(9.0)), (-4, 14, 2.0));
        assert_eq!(window(&acting(14, 14), Some(9.0), Some(1.0)), (-5, 13, 2.0));
    }

    #[test]
    fn the_period_rests_before_and_after_the_return() {
        let grid = TimeGrid { origin_s: 0.0, first: 0, len: 101, step_s: 0.01 };
        for links in 1..=3 {
            let own = Return::of(links, Some(20.0), &grid);
            for before in [0, 1, 40] {
                for after in [0, 1, 60] {
                    let padding = Padding { before, after, cycles: None };
                    let shortest = own.shortest_len(padding, grid.len).unwrap();
                    for len in [shortest, 2 * shortest] {
                        let samples = own.samples(padding, grid.len, len);
                        assert!(samples.start > grid.len + after, "{samples:?}");
                        assert!(samples.end + before < len, "{samples:?} of {len}");
                    }
                }
            }
        }
    }
}
