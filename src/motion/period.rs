use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::histories::TipHistories;
use super::spectrum::TipSpectrum;
use super::tip_motion::TipMotion;

/// A motion on a period: what depends on no link, and so is the same for all cases of a sweep.
pub struct TipPeriod {
    /// Its spectrum.
    pub spectrum: Arc<TipSpectrum>,
    histories: OnceLock<TipHistories>,
}

impl TipPeriod {
    /// Its histories; `motion` must be the one that the period is of.
    pub fn histories(&self, motion: &TipMotion) -> &TipHistories {
        self.histories.get_or_init(|| motion.histories(&self.spectrum))
    }
}

impl TipMotion {
    /// The motion on a period of `len` samples with this seam, as [`TipMotion::spectrum`] has it.
    ///
    /// The motion and its clones keep the last two, so that many links that ask for the same
    /// period, and for the one that it is lengthened to, share them.
    ///
    /// # Panics
    /// As [`TipMotion::spectrum`].
    pub fn over_period(&self, len: usize, seam: usize) -> Arc<TipPeriod> {
        let is_asked_for = |period: &&Arc<TipPeriod>| {
            (period.spectrum.pair.len(), period.spectrum.seam) == (len, seam)
        };
        let last = &self.last_periods().0;
        // Whole periods are put in, so that no panic elsewhere leaves half a one.
        let kept = || last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(period) = kept().iter().find(is_asked_for) {
            return Arc::clone(period);
        }
        let spectrum = Arc::new(self.spectrum(len, seam));
        let period = Arc::new(TipPeriod { spectrum, histories: OnceLock::new() });
        let mut kept = kept();
        kept.insert(0, Arc::clone(&period));
        kept.truncate(2);
        period
    }
}

/// The last periods that a motion or a clone of it was asked for; no property of the motion.
#[derive(Clone, Default)]
pub(super) struct LastPeriods(Arc<Mutex<Vec<Arc<TipPeriod>>>>);

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
        let period = motion.over_period(256, 200);
        assert!(Arc::ptr_eq(&period, &motion.clone().over_period(256, 200)));
        for (len, seam) in [(256, 201), (300, 200)] {
            let other = motion.over_period(len, seam);
            assert_eq!((other.spectrum.pair.len(), other.histories(&motion).before), (len, seam));
        }
        let longer = motion.scaled(crate::motion::MotionScale { distance: 2.0, duration: 1.0 });
        let longer = longer.unwrap().over_period(256, 200);
        assert!(longer.spectrum.largest_m_s2 > 1.9 * period.spectrum.largest_m_s2);
    }
}
