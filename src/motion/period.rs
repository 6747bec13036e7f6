use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::cutoff::Cutoff;
use super::histories::TipHistories;
use super::images::Images;
use super::spectrum::TipSpectrum;
use super::tip_motion::TipMotion;

/// A motion on a period: what depends on no link, and so is the same for all cases of a sweep.
pub struct TipPeriod {
    /// Its spectrum.
    pub spectrum: Arc<TipSpectrum>,
    forcing_m_s2: Vec<f64>,
    histories: OnceLock<TipHistories>,
    images: OnceLock<Images>,
}

impl TipPeriod {
    /// Its histories; `motion` must be the one that the period is of.
    pub fn histories(&self, motion: &TipMotion) -> &TipHistories {
        self.histories.get_or_init(|| motion.histories(&self.spectrum))
    }

    /// What the motion in all other periods adds to signals with a slow tail.
    pub fn images(&self) -> &Images {
        self.images.get_or_init(|| Images::new(&self.spectrum, &self.forcing_m_s2))
    }
}

impl TipMotion {
    /// The motion on a period of `len` samples with this seam, as [`TipMotion::spectrum`] has it, rolled
    /// off at a cut-off.
    ///
    /// The motion and its clones keep the last two, so that many links that ask for the same
    /// period, and for the one that it is lengthened to, share them.
    ///
    /// # Panics
    /// As [`TipMotion::spectrum`].
    pub fn over_period(&self, len: usize, seam: usize, cutoff: Cutoff) -> Arc<TipPeriod> {
        let is_asked_for = |period: &&Arc<TipPeriod>| {
            let TipSpectrum { pair, seam: its_seam, cutoff: its_cutoff, .. } = &*period.spectrum;
            (pair.len(), *its_seam, *its_cutoff) == (len, seam, cutoff)
        };
        let last = &self.last_periods().periods;
        // Whole periods are put in, so that no panic elsewhere leaves half a one.
        let kept = || last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(period) = kept().iter().find(is_asked_for) {
            return Arc::clone(period);
        }
        let spectrum = Arc::new(self.spectrum(len, seam).up_to(cutoff));
        let period = Arc::new(TipPeriod {
            spectrum,
            forcing_m_s2: self.forcing_m_s2().to_vec(),
            histories: OnceLock::new(),
            images: OnceLock::new(),
        });
        let mut kept = kept();
        kept.insert(0, Arc::clone(&period));
        kept.truncate(2);
        period
    }
}

/// The last periods, and the last cut-off, that a motion or a clone of it was asked for; no property of
/// the motion.
#[derive(Clone, Default)]
pub(super) struct LastPeriods {
    periods: Arc<Mutex<Vec<Arc<TipPeriod>>>>,
    /// A tolerance and its cut-off.
    cutoff: Arc<Mutex<Option<(f64, Cutoff)>>>,
}

impl LastPeriods {
    /// The cut-off of a tolerance, found by `find` unless it was the last one.
    pub(super) fn cutoff(&self, tolerance: f64, find: impl FnOnce() -> Cutoff) -> Cutoff {
        let mut last = self.cutoff.lock().unwrap_or_else(PoisonError::into_inner);
        match *last {
            Some((known, cutoff)) if known.to_bits() == tolerance.to_bits() => cutoff,
            _ => last.insert((tolerance, find())).1,
        }
    }
}

impl PartialEq for LastPeriods {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl std::fmt::Debug for LastPeriods {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("LastPeriods")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Profile;

    #[test]
    fn clones_share_a_period_and_another_one_is_not_taken_for_it() {
        let motion = TipMotion::new(Profile::Septic.sampled(0.5, 0.01, 100, [0, 0])).unwrap();
        let period = motion.over_period(256, 200, Cutoff::ALL);
        assert!(Arc::ptr_eq(&period, &motion.clone().over_period(256, 200, Cutoff::ALL)));
        for (len, seam) in [(256, 201), (300, 200)] {
            let other = motion.over_period(len, seam, Cutoff::ALL);
            assert_eq!((other.spectrum.pair.len(), other.histories(&motion).before), (len, seam));
        }
        let longer = motion.scaled(crate::motion::MotionScale { distance: 2.0, duration: 1.0 });
        let longer = longer.unwrap().over_period(256, 200, Cutoff::ALL);
        assert!(longer.spectrum.largest_m_s2 > 1.9 * period.spectrum.largest_m_s2);
    }
}
