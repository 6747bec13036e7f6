//! The chord's motion over a period, and gravity in its frame.

use num_complex::Complex64;

use super::error::{ElasticaError, FEWEST};
use crate::numeric::{FourierPair, angular_frequency, fast_length, largest, magnitude};

/// Share of the largest amplitude below which the amplitude at the Nyquist frequency counts as 0.
const NOTHING: f64 = 1e-6;

/// Round-off of a steady acceleration at other frequencies, relative to its size.
const STEADY: f64 = 1e-13;

/// Share of the largest amplitude below which amplitudes are round-off of the transform.
const ROUND_OFF: f64 = 1e-15;

/// Half the duration of a return over `√2` standard deviations of its bell: `erfc(6) / 2` and `e^(−6²)` are round-off.
const BELL: f64 = 6.0;

/// The motion of a chord over a period of N samples, and the acceleration of the axis in its frame; gravity counts as
/// an upward acceleration.
#[derive(Debug, Clone)]
pub(super) struct ChordPeriod {
    pub(super) pair: FourierPair,
    pub(super) step_s: f64,
    /// Directions in rad.
    pub(super) angle_rad: Vec<f64>,
    pub(super) histories: ChordHistories,
    /// Amplitudes of the rate in rad/s.
    rate: Vec<Complex64>,
    /// Amplitudes of the axis' acceleration along the chord in m/s².
    along: Vec<Complex64>,
    /// Amplitudes of the angular acceleration in rad/s².
    pub(super) turning: Vec<Complex64>,
    /// Amplitudes of the axis' acceleration across the chord in m/s².
    pub(super) across: Vec<Complex64>,
    /// Amplitudes of the next link's load on the tip.
    pub(super) tip: Option<TipLoad<Vec<Complex64>>>,
}

/// Load of the next link on the tip: histories, amplitudes or values at one instant.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct TipLoad<T> {
    /// Force along the chord in N.
    pub(super) along_n: T,
    /// Force across the chord in N.
    pub(super) across_n: T,
    /// Torque in N m that turns the next link; its reaction turns the tip.
    pub(super) torque_n_m: T,
}

/// The chord's motion in time, and the next link's load on the tip.
#[derive(Debug, Clone)]
pub(super) struct ChordHistories {
    /// Rate of the chord in rad/s.
    pub(super) rate_rad_s: Vec<f64>,
    /// Angular acceleration in rad/s².
    pub(super) acceleration_rad_s2: Vec<f64>,
    /// Acceleration of the axis along the chord in m/s².
    pub(super) along_m_s2: Vec<f64>,
    /// Acceleration of the axis across the chord in m/s².
    pub(super) across_m_s2: Vec<f64>,
    pub(super) tip: Option<TipLoad<Vec<f64>>>,
}

impl TipLoad<Vec<f64>> {
    /// The load at a sample.
    pub(super) fn at(&self, sample: usize) -> TipLoad<f64> {
        self.each(|history| history[sample])
    }
}

impl<T> TipLoad<T> {
    /// Applies a function to each part.
    pub(super) fn each<U>(&self, of: impl Fn(&T) -> U) -> TipLoad<U> {
        TipLoad {
            along_n: of(&self.along_n),
            across_n: of(&self.across_n),
            torque_n_m: of(&self.torque_n_m),
        }
    }
}

impl ChordPeriod {
    /// The period of these histories, without a next link.
    pub(super) fn of(
        pair: FourierPair,
        step_s: f64,
        angle_rad: Vec<f64>,
        histories: ChordHistories,
    ) -> Self {
        let ChordHistories { rate_rad_s, acceleration_rad_s2, along_m_s2, across_m_s2, .. } =
            &histories;
        let (rate, along) = (pair.amplitudes(rate_rad_s), pair.amplitudes(along_m_s2));
        let (turning, across) =
            (pair.amplitudes(acceleration_rad_s2), pair.amplitudes(across_m_s2));
        let tip = None;
        Self { pair, step_s, angle_rad, histories, rate, along, turning, across, tip }
    }

    /// Applies the load of the next link to the tip.
    pub(super) fn load_tip(&mut self, load: TipLoad<Vec<f64>>) {
        self.tip = Some(load.each(|history| self.pair.amplitudes(history)));
        self.histories.tip = Some(load);
    }

    /// Number N of samples.
    pub(super) fn len(&self) -> usize {
        self.pair.len()
    }

    /// The pair with the fewest samples of the period that [resolve](resolved) products in this number of bins.
    pub(super) fn pair_for(&self, bins: usize) -> FourierPair {
        let few = fast_length(resolving(bins));
        if few < self.len() { FourierPair::new(few) } else { self.pair.clone() }
    }

    /// The motion at the samples of a pair over the same period; band-limited if there are fewer samples.
    pub(super) fn at(&self, pair: &FourierPair) -> ChordHistories {
        if pair.len() == self.len() {
            return self.histories.clone();
        }
        ChordHistories {
            rate_rad_s: pair.samples(&self.rate),
            acceleration_rad_s2: pair.samples(&self.turning),
            along_m_s2: pair.samples(&self.along),
            across_m_s2: pair.samples(&self.across),
            tip: self.tip.as_ref().map(|tip| tip.each(|amplitudes| pair.samples(amplitudes))),
        }
    }

    /// Angular frequency of a bin in rad/s.
    pub(super) fn omega_rad_s(&self, bin: usize) -> f64 {
        angular_frequency(bin, self.len(), self.step_s)
    }

    /// True if the motion of a link of this length exceeds round-off at the Nyquist frequency, whose phase samples do
    /// not show.
    pub(super) fn reaches_nyquist(&self, length_m: f64) -> bool {
        let sizes = self.sizes(length_m);
        // Relative to the moving part; a steady weight or turn adds only its round-off.
        let moving = sizes[1..].iter().sum::<f64>();
        let rate = magnitude(self.rate[0]);
        let steady = sizes[0] + magnitude(self.along[0]) + rate * rate * length_m;
        sizes[sizes.len() - 1] > NOTHING * moving + STEADY * steady
    }

    /// Number of bins from zero frequency to the last one above round-off, without the Nyquist frequency.
    pub(super) fn band_len(&self, length_m: f64) -> usize {
        let mut parts = vec![self.sizes(length_m)];
        if let Some(tip) = &self.tip {
            let size =
                |amplitudes: &Vec<Complex64>| amplitudes.iter().map(|a| magnitude(*a)).collect();
            parts.extend([size(&tip.across_n), size(&tip.torque_n_m)]);
        }
        let end = |sizes: &Vec<f64>| {
            let least = ROUND_OFF * largest(sizes);
            sizes.iter().rposition(|size| *size > least).map_or(1, |last| last + 1)
        };
        parts.iter().map(end).max().unwrap_or(1).min(self.len() / 2)
    }

    /// Acceleration of a link of this length in each bin, in m/s².
    fn sizes(&self, length_m: f64) -> Vec<f64> {
        let bins = self.turning.iter().zip(&self.across);
        bins.map(|(turning, across)| magnitude(*turning) * length_m + magnitude(*across)).collect()
    }
}

/// Checks the chords of a period, each with its angles, rates and accelerations, and returns the number of samples.
///
/// # Errors
/// [`ElasticaError::Lengths`], [`ElasticaError::Step`], [`ElasticaError::Sample`].
pub(super) fn check_period(
    step_s: f64,
    gravity_m_s2: [f64; 2],
    chords: &[[&[f64]; 3]],
) -> Result<usize, ElasticaError> {
    let len = chords.first().map_or(0, |[angles, ..]| angles.len());
    let uneven = chords.iter().map(|chord| chord.map(<[f64]>::len)).find(|own| *own != [len; 3]);
    let is_period = len >= FEWEST && len.is_multiple_of(2);
    if let Some([angles, rates, accelerations]) = uneven.or((!is_period).then_some([len; 3])) {
        return Err(ElasticaError::Lengths { angles, rates, accelerations });
    }
    if !(step_s > 0.0 && step_s.is_finite()) {
        return Err(ElasticaError::Step(step_s));
    }
    let named = |chord: &[_; 3]| ["angle", "rate", "acceleration"].into_iter().zip(*chord);
    let columns = chords.iter().flat_map(named);
    for (column, values) in std::iter::once(("gravity", &gravity_m_s2[..])).chain(columns) {
        if let Some(sample) = values.iter().position(|value| !value.is_finite()) {
            return Err(ElasticaError::Sample { column, sample, value: values[sample] });
        }
    }
    Ok(len)
}

/// Number of bins up to the last one that counts: the sizes beyond add up to at most `least`.
pub(super) fn counting(sizes: &[f64], least: f64) -> usize {
    let mut beyond = 0.0;
    let counts = |size: &f64| {
        beyond += size;
        beyond > least
    };
    sizes.iter().rposition(counts).map_or(1, |last| last + 1)
}

/// Number of bins without aliases of products of histories, up to products of the fifth order.
pub(super) fn resolved(pair: &FourierPair) -> usize {
    2 * pair.len() / 5
}

/// Fewest samples that [resolve](resolved) this number of bins.
pub(super) fn resolving(bins: usize) -> usize {
    (5 * bins).div_ceil(2)
}

/// `count` angles between `from` and `to` along the integral of a Gaussian bell. Beyond its ends, and at angular
/// frequencies above 146 over its duration, only round-off remains.
pub fn returning(from: f64, to: f64, count: usize) -> Vec<f64> {
    let step = |x: f64| 0.5 * libm::erfc(BELL * (1.0 - 2.0 * x));
    let place = |k: usize| (k + 1) as f64 / (count + 1) as f64;
    (0..count).map(|k| from + (to - from) * step(place(k))).collect()
}
