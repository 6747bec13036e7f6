//! The numbers of a step.

use serde::{Deserialize, Serialize};

use super::{Band, Correction, Recorded, Table};
use crate::inverse::Solution;
use crate::numeric::rounded;
use crate::robust::{Hold, Key};

/// The numbers of a step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearnSummary {
    /// Quantity that the drives hold.
    pub play: Hold,
    /// Largest travel of the wanted tip in m.
    pub travel_m: f64,
    /// Time of the recording less that of the motion in s.
    pub shift_s: f64,
    /// First and last time of the error in s, on the clock of the motion.
    pub measured_s: [f64; 2],
    /// Measured less wanted place before the motion along each axis in m, which the error lacks.
    pub offset_m: Vec<f64>,
    /// Root mean square of the error in m.
    pub rms_m: f64,
    /// Largest error in m.
    pub peak_m: f64,
    /// The intervals.
    pub keys: Vec<Key>,
    /// Number of plants of the intervals.
    pub plants: usize,
    /// End of the corrected band in Hz.
    pub band_end_hz: f64,
    /// Frequency in Hz up to which the whole error is corrected.
    pub whole_until_hz: f64,
    /// True if the plants end the band, false if the motion does.
    pub is_limited: bool,
    /// Largest contraction where the whole error is corrected.
    pub contraction: f64,
    /// Its frequency in Hz.
    pub contraction_hz: f64,
    /// Contraction in the band, weighted by the error's spectrum.
    pub weighted_contraction: f64,
    /// Largest root mean square in m of the next error of a link within the intervals, without noise: by the contraction, or when
    /// the plants play the next table.
    pub predicted_rms_m: f64,
    /// Root mean squares in m of the error in the band, and of the largest that the answer of `solve` makes there on a link
    /// within the intervals.
    pub in_band_rms_m: [f64; 2],
    /// First and last time of the next table in s.
    pub next_s: [f64; 2],
    /// Its rows.
    pub rows: usize,
}

impl LearnSummary {
    /// The numbers of a step with these plants, of which the worst leaves an error of `played_rms_m` when it plays the table.
    pub fn of(
        (solution, recorded, shift_s): (&Solution, &Recorded, f64),
        (keys, plants): (&[Key], usize),
        (band, correction, played_rms_m): (&Band, &Correction, f64),
        (next, play): (&Table, Hold),
    ) -> Self {
        let [rms_m, peak_m] = recorded.rms_and_peak_m();
        let (contraction, contraction_hz) = band.largest();
        Self {
            play,
            travel_m: solution.tip_travel_m(),
            shift_s,
            measured_s: [recorded.grid.time_s(0), recorded.grid.end_s()].map(|s| rounded(s, 9)),
            offset_m: recorded.offset_m.clone(),
            rms_m,
            peak_m,
            keys: keys.to_vec(),
            plants,
            band_end_hz: band.end_hz,
            whole_until_hz: band.whole_until_hz(),
            is_limited: band.is_limited,
            contraction,
            contraction_hz,
            weighted_contraction: correction.contraction,
            predicted_rms_m: correction.predicted_rms_m.max(played_rms_m),
            in_band_rms_m: correction.in_band_rms_m,
            next_s: [next.grid.time_s(0), next.grid.end_s()].map(|s| rounded(s, 9)),
            rows: next.grid.len,
        }
    }
}
