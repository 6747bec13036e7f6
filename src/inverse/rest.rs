//! Where in a period the chords return, and the rest on either side of it.

use std::ops::Range;

use super::error::InversionError;
use super::period::Padding;
use crate::elastica::returning;
use crate::motion::TipSpectrum;
use crate::numeric::TimeGrid;

/// Time in which the chord returns, over the time in which the torque falls by e: it then differs from that at rest by
/// about 5e-4 of its range at most, with the fifth power of this number.
const RETURN: f64 = 40.0;

/// Fewest samples of a return: a faster one has amplitudes at frequencies that the samples do not resolve.
const FEWEST: usize = 256;

/// Rest on either side of the return, over the same time: that difference has fallen to about 1e-8.
const QUIET: f64 = 10.0;

/// How many times as long an arm's chords return: what the outer links do reaches the first joint through links that
/// amplify fast parts of it, each by its own gain.
const OF_ARM: usize = 2;

/// Share of the time that a period has to spare for the return; the torque decays in the rest.
const SPARE_FOR_RETURN: f64 = 0.2;

/// A period is lengthened to at most this many samples, or to four times what it began with.
const LENGTHENED: usize = 1 << 15;

/// How chords return within a period; without weight they need not.
#[derive(Debug, Clone, Copy)]
pub(super) struct Return {
    /// Fewest samples in which the chord returns.
    fewest: usize,
    /// Samples of rest on either side.
    quiet: usize,
}

impl Return {
    /// A period in which nothing returns.
    pub(super) const NONE: Self = Self { fewest: 0, quiet: 0 };

    /// The return of one link's chord for torques that decay as e^(−z₁t).
    pub(super) fn of_link(first_zero_per_s: Option<f64>, grid: &TimeGrid) -> Self {
        let falls_s = first_zero_per_s.map_or(grid.duration_s() / RETURN, f64::recip);
        let steps = |times: f64| (times * falls_s / grid.step_s).ceil() as usize;
        Self { fewest: steps(RETURN).max(FEWEST), quiet: steps(QUIET) }
    }

    /// That of an arm's chords, where `z₁` is the smallest of the links' zeros.
    pub(super) fn of_arm(first_zero_per_s: Option<f64>, grid: &TimeGrid) -> Self {
        let Self { fewest, quiet } = Self::of_link(first_zero_per_s, grid);
        Self { fewest: OF_ARM * fewest, quiet }
    }

    /// Samples of the shortest period for a motion of `given` ones.
    pub(super) fn shortest_len(
        self,
        padding: Padding,
        given: usize,
    ) -> Result<usize, InversionError> {
        let returning = self.fewest.saturating_add(2 * self.quiet);
        padding.period_len(given.saturating_add(returning))
    }

    /// The samples of a period in which the chord returns.
    pub(super) fn samples(self, padding: Padding, given: usize, len: usize) -> Range<usize> {
        let spare = len - given - padding.before - padding.after;
        let further = spare.saturating_sub(self.fewest + 2 * self.quiet);
        let count = match self.fewest {
            0 => 0,
            fewest => fewest + (SPARE_FOR_RETURN * further as f64) as usize,
        };
        let from = given + padding.after + (spare - count) / 2;
        from..from + count
    }

    /// The rest of a period whose chords return in these samples.
    pub(super) fn rest(
        self,
        spectrum: &TipSpectrum,
        seam_reach: usize,
        returning: &Range<usize>,
    ) -> Rest {
        Rest {
            returning: returning.start - self.quiet..returning.end + self.quiet,
            len: spectrum.pair.len(),
            seam: spectrum.seam,
            seam_reach,
        }
    }
}

/// The next longer period to try: one at which linear torques have decayed, as `decays` tells, since those with second-order
/// terms have not where they have not, most times; or the longest. None where `len` is that.
pub(super) fn lengthened<E>(
    len: usize,
    initial: usize,
    decays: impl Fn(usize) -> Result<bool, E>,
) -> Result<Option<usize>, E> {
    let longer = |len: usize| {
        let longer = Padding::lengthened(len, initial);
        longer.filter(|len| *len <= LENGTHENED.max(4 * initial))
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

/// What a chord that travels so far has still to return, at each sample of its return: before the seam it goes on from
/// its end, behind it it goes on to its start.
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

/// The parts of a period before the motion, and after it, in which all is at rest.
#[derive(Debug, Clone)]
pub(super) struct Rest {
    /// Samples in which the chord returns, with the rest on either side; without weight it is empty.
    returning: Range<usize>,
    len: usize,
    seam: usize,
    seam_reach: usize,
}

impl Rest {
    /// Samples of the period less what they are at rest before the motion and after it; while the chord returns, 0.
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

    /// Over how many samples rest is measured before the motion and after it: as many as around a seam, within half
    /// of what is there.
    pub(super) fn reaches(&self, given: usize) -> [usize; 2] {
        let there = [self.len - self.start(), self.until().saturating_sub(given)];
        there.map(|samples| self.seam_reach.min(samples / 2).max(1))
    }

    /// First sample of a time before the motion, where no chord returns.
    fn start(&self) -> usize {
        if self.returning.is_empty() { self.seam } else { self.returning.end }
    }

    /// First sample that is not of a time after the motion.
    fn until(&self) -> usize {
        if self.returning.is_empty() { self.seam } else { self.returning.start }
    }
}
