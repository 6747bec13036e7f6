use num_complex::Complex64;

use crate::inverse::spectra::Forcing;
use crate::numeric::{RootPlaces, Scalar, largest, quintic, scale_by_quintics, sum_over};

/// Change of torque per felt acceleration in kg m, evenly sampled in √ω from zero to the end of the
/// band.
pub(super) struct SampledChange<'a> {
    from: Forcing<'a>,
    to: Forcing<'a>,
    last_rad_s: f64,
    /// Acceleration that the mass feels at each bin, in m/s².
    felt_m_s2: Vec<Complex64>,
    samples_kg_m: Vec<Complex64>,
}

/// What amplitudes add up to over the band, each taken from the solved frequency nearest to it.
pub(super) struct Estimate {
    /// How far the change from half as many samples may be off at any time.
    pub(super) wrong_n_m: f64,
    /// The change itself.
    pub(super) change_n_m: f64,
}

impl<'a> SampledChange<'a> {
    pub(super) fn new(from: Forcing<'a>, to: Forcing<'a>, intervals: usize) -> Self {
        let (last_rad_s, felt_m_s2) = (to.last_rad_s(), to.felt_accelerations_m_s2());
        let mut change = Self { from, to, last_rad_s, felt_m_s2, samples_kg_m: vec![] };
        change.samples_kg_m = change.solved(0..=intervals, intervals);
        change
    }

    pub(super) fn intervals(&self) -> usize {
        self.samples_kg_m.len() - 1
    }

    /// The change at samples of these numbers, where there are so many intervals.
    fn solved(&self, numbers: impl Iterator<Item = usize>, intervals: usize) -> Vec<Complex64> {
        let omega = |number: usize| {
            let root = number as f64 / intervals as f64;
            self.last_rad_s * (root * root)
        };
        let omegas: Vec<f64> = numbers.map(omega).collect();
        let from = self.from.apparent_inertias_kg_m(&omegas);
        let to = self.to.apparent_inertias_kg_m(&omegas);
        to.iter().zip(&from).map(|(to, from)| to - from).collect()
    }

    /// Solves for twice as many samples, and tells how far off the interpolation between those
    /// before was.
    pub(super) fn doubled(&mut self) -> Estimate {
        let (before, intervals) = (&self.samples_kg_m, 2 * self.intervals());
        let between = self.solved((1..intervals).step_by(2), intervals);
        let mut samples = Vec::with_capacity(intervals + 1);
        let mut estimate = Estimate { wrong_n_m: 0.0, change_n_m: 0.0 };
        let off = |k: usize| (between[k] - quintic(before, k as f64 + 0.5)).size();
        let off: Vec<f64> = (0..between.len()).map(off).collect();
        let places = self.places();
        // Of the bins between two samples the one between these is the nearest.
        for (k, here) in between.iter().enumerate() {
            let felt = &self.felt_m_s2[places.between(k)];
            let sum = 2.0 * sum_over(felt, |felt| felt.size());
            let neighbours = &off[k.saturating_sub(1)..off.len().min(k + 2)];
            estimate.wrong_n_m += sum * largest(neighbours);
            estimate.change_n_m += sum * here.size();
        }
        for (before, between) in before.iter().zip(&between) {
            samples.extend([before, between]);
        }
        samples.extend(before.last());
        self.samples_kg_m = samples;
        estimate
    }

    /// Where the bins stand among the samples.
    fn places(&self) -> RootPlaces {
        RootPlaces { numbers: self.felt_m_s2.len(), intervals: self.intervals() }
    }

    /// The change at all bins.
    pub(super) fn amplitudes_n_m(&self) -> Vec<Complex64> {
        let mut amplitudes = self.felt_m_s2.clone();
        scale_by_quintics(&self.samples_kg_m, self.places(), &mut amplitudes);
        amplitudes
    }
}
