//! Where in a period the chords return, and the rest on either side of it.

use std::ops::Range;

use super::error::InversionError;
use super::period::Padding;
use crate::elastica::returning;
use crate::motion::TipSpectrum;
use crate::numeric::TimeGrid;

/// Time in which a link's chord returns, over the time in which the torque falls by e. At its ends the torque differs from
/// that at rest by about 5e-11 of its range: `e^(−30 + s²/2)`, where the bell's standard deviation is s = 3.5 of those times.
const RETURN: f64 = 60.0;

/// Fewest samples of a return: at the frequencies of a faster one the samples do not resolve products.
const FEWEST: usize = 256;

/// Samples of rest before the return and after it, at least.
const AT_REST: usize = 2;

/// Share of the time that a period has to spare for the return; the torque decays in the rest.
const SPARE_FOR_RETURN: f64 = 0.2;

/// A period is lengthened to at most this many samples, or to four times what it began with.
const LENGTHENED: usize = 1 << 15;

/// How chords return within a period; without weight they need not.
#[derive(Debug, Clone, Copy)]
pub(super) struct Return {
    /// Fewest samples in which the chord returns.
    fewest: usize,
}

impl Return {
    /// A period in which nothing returns.
    pub(super) const NONE: Self = Self { fewest: 0 };

    /// The return of the chords of so many links for torques that decay as e^(−z₁t), `z₁` the smallest of their zeros. Of
    /// more links it is slower: what the outer ones do reaches the first joint through links that amplify fast parts of
    /// it, each by its own gain.
    pub(super) fn of(links: usize, first_zero_per_s: Option<f64>, grid: &TimeGrid) -> Self {
        let falls_s = first_zero_per_s.map_or(grid.duration_s() / RETURN, f64::recip);
        let steps = (links as f64 * RETURN * falls_s / grid.step_s).ceil() as usize;
        Self { fewest: steps.max(FEWEST) }
    }

    /// Samples of the shortest period for a motion of `given` ones.
    pub(super) fn shortest_len(
        self,
        padding: Padding,
        given: usize,
    ) -> Result<usize, InversionError> {
        let returning = if self.fewest == 0 { 0 } else { self.fewest.saturating_add(2 * AT_REST) };
        padding.period_len(given.saturating_add(returning))
    }

    /// The samples of a period in which the chord returns.
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
    /// Samples in which the chord returns; without weight it is empty.
    returning: Range<usize>,
    len: usize,
    seam: usize,
    seam_reach: usize,
}

impl Rest {
    /// The rest of a period whose chords return in these samples.
    pub(super) fn of(spectrum: &TipSpectrum, seam_reach: usize, returning: Range<usize>) -> Self {
        Self { returning, len: spectrum.pair.len(), seam: spectrum.seam, seam_reach }
    }

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

#[cfg(test)]
mod tests {
    use super::*;

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
