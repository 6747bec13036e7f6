//! Periods and cut-off of a motion, shared by the cases of a sweep.

use std::sync::{Arc, Mutex, PoisonError};

use super::period::TipPeriod;
use super::spectrum::Cutoff;
use super::tip_motion::TipMotion;

/// Limit of the samples of all kept periods, over the samples of the longest: each period that a case tries is twice as
/// long as the one before.
const KEPT: usize = 2;

/// The last cut-off and the last periods of one motion, for the cases of a sweep.
///
/// They do not depend on a link, so that a sweep passes one `Periods` to all cases, which may run in parallel. A case
/// with another motion computes separate periods.
pub struct Periods {
    motion: TipMotion,
    /// A tolerance and its cut-off.
    cutoff: Mutex<Option<(f64, Cutoff)>>,
    /// The last periods, latest first.
    last: Mutex<Vec<Arc<TipPeriod>>>,
}

impl Periods {
    /// Starts without periods, for `motion` and its clones.
    pub fn of(motion: &TipMotion) -> Self {
        Self { motion: motion.clone(), cutoff: Mutex::default(), last: Mutex::default() }
    }

    /// [`TipMotion::cutoff`], computed only if `tolerance` differs from the last call.
    pub fn cutoff(&self, motion: &TipMotion, tolerance: f64) -> Cutoff {
        if !motion.is_clone_of(&self.motion) {
            return motion.cutoff(tolerance);
        }
        // Other threads wait here for the cut-off. The thread that computes it works alone: if it waited for others of
        // its pool, it might take up another case, which would wait for this lock.
        let mut last = self.cutoff.lock().unwrap_or_else(PoisonError::into_inner);
        match *last {
            Some((known, cutoff)) if known.to_bits() == tolerance.to_bits() => cutoff,
            _ => last.insert((tolerance, motion.cutoff(tolerance))).1,
        }
    }

    /// [`TipMotion::over_period`], computed unless it is among the last periods.
    ///
    /// # Panics
    /// Like [`TipMotion::over_period`].
    pub(crate) fn over_period(
        &self,
        motion: &TipMotion,
        len: usize,
        seam: usize,
        cutoff: Cutoff,
    ) -> Arc<TipPeriod> {
        let computed = || Arc::new(motion.over_period(len, seam, cutoff));
        if !motion.is_clone_of(&self.motion) {
            return computed();
        }
        let is_wanted = |period: &&Arc<TipPeriod>| {
            let spectrum = &period.spectrum;
            (spectrum.pair.len(), spectrum.seam, spectrum.cutoff) == (len, seam, cutoff)
        };
        // The list contains only whole periods, so that it is valid even after a panic.
        let kept = || self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(period) = kept().iter().find(is_wanted) {
            return Arc::clone(period);
        }
        let period = computed();
        let mut kept = kept();
        kept.insert(0, Arc::clone(&period));
        let longest = kept.iter().map(|own| own.spectrum.pair.len()).fold(len, usize::max);
        let mut samples = 0;
        kept.retain(|own| {
            samples += own.spectrum.pair.len();
            samples <= KEPT * longest
        });
        period
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;
    use std::time::Duration;

    use super::*;
    use crate::motion::{MotionScale, Profile};

    fn motion() -> TipMotion {
        TipMotion::new(Profile::Septic.sampled(0.5, 0.01, 100, [0, 0])).unwrap()
    }

    #[test]
    fn clones_share_a_period_and_another_one_is_not_taken_for_it() {
        let motion = motion();
        let periods = Periods::of(&motion);
        let over =
            |motion: &TipMotion, len, seam| periods.over_period(motion, len, seam, Cutoff::ALL);
        let period = over(&motion, 256, 200);
        assert!(Arc::ptr_eq(&period, &over(&motion.clone(), 256, 200)));
        for (len, seam) in [(256, 201), (300, 200)] {
            let other = over(&motion, len, seam);
            assert_eq!((other.spectrum.pair.len(), other.histories.before), (len, seam));
        }
        let chain = [128, 256, 512].map(|len| over(&motion, len, 110));
        for (len, own) in [128, 256, 512].into_iter().zip(&chain) {
            assert!(Arc::ptr_eq(own, &over(&motion, len, 110)), "a case's periods are kept");
        }
        over(&motion, 500, 110);
        let kept = periods.last.lock().unwrap();
        let lens: Vec<usize> = kept.iter().map(|own| own.spectrum.pair.len()).collect();
        assert_eq!(lens, [500, 512], "at most twice the longest");
        drop(kept);
        let longer = motion.scaled(MotionScale { distance: 2.0, duration: 1.0 }).unwrap();
        assert!(over(&longer, 256, 200).spectrum.largest_m_s2 > 1.9 * period.spectrum.largest_m_s2);
    }

    #[test]
    fn each_motion_and_each_tolerance_has_its_own_cut_off() {
        let motion = motion();
        let periods = Periods::of(&motion);
        let slower = motion.scaled(MotionScale { distance: 1.0, duration: 2.0 }).unwrap();
        for tolerance in [1e-3, 1e-3, 1e-5, 0.0] {
            for motion in [&motion, &slower] {
                assert_eq!(periods.cutoff(motion, tolerance), motion.cutoff(tolerance));
            }
        }
    }

    #[test]
    fn cases_of_one_pool_do_not_wait_for_images_that_they_compute_themselves() {
        const CASES: usize = 4;
        let motion = motion();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let (ended, end) = mpsc::channel();
        for _ in 0..100 {
            let period = Arc::new(motion.over_period(1 << 16, 200, Cutoff::ALL));
            for _ in 0..CASES {
                let (period, ended) = (Arc::clone(&period), ended.clone());
                pool.spawn(move || ended.send(period.images().history(0).len()).unwrap());
            }
            for _ in 0..CASES {
                assert_eq!(end.recv_timeout(Duration::from_secs(60)), Ok(1 << 16));
            }
        }
    }
}
