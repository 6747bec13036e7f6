//! Place of the chords' return within a period, and the rest on either side of it.

use std::ops::Range;

use super::error::InversionError;
use super::period::Padding;
use crate::elastica::returning;
use crate::motion::TipSpectrum;
use crate::numeric::TimeGrid;

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
const LENGTHENED: usize = 1 << 15;

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
