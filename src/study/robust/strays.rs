//! How far the tip of a plant strays from the wanted motion.

use serde::{Deserialize, Serialize};

use crate::numeric::{CubicSpline, SplineEnds, TimeGrid, extremes};

/// Places in the first period after the motion.
const PLACES: usize = 256;

/// Samples of the splines after this period.
const BEYOND: usize = 32;

/// Parts of a step in which the largest error is searched.
const PARTS: usize = 16;

/// One of the measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Largest error up to a period after the motion.
    TipError,
    /// Vibration in the first period after the motion.
    RestVibration,
    /// Mean error in this period.
    Drift,
}

impl Measure {
    /// All measures.
    pub const ALL: [Self; 3] = [Self::TipError, Self::RestVibration, Self::Drift];

    /// In text.
    pub fn word(self) -> &'static str {
        match self {
            Self::TipError => "tip error",
            Self::RestVibration => "rest vibration",
            Self::Drift => "drift",
        }
    }
}

/// Measures of the error e of one plant: its output less the wanted motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Strays {
    /// Largest |e| in m up to a period of the lowest mode that rings after the end of the motion.
    pub tip_error_m: f64,
    /// Half of the largest less the smallest e in m over the first period after the end of the motion; of an arm half of
    /// the largest distance of two errors.
    pub rest_vibration_m: f64,
    /// Mean of e in m over the same period; of an arm its size.
    pub drift_m: f64,
    /// Time in s from the end of the motion until |e| stays within the band, for a period at least. `None` if it does not.
    pub settling_s: Option<f64>,
    /// The period in s; `None` if nothing rings, and then the end alone counts.
    pub period_s: Option<f64>,
}

impl Strays {
    /// The measures of an error along each axis on a grid, for a motion that ends at `end_s`.
    pub fn of(
        error_m: &[Vec<f64>],
        grid: &TimeGrid,
        (end_s, period_s): (f64, Option<f64>),
        band_m: f64,
    ) -> Self {
        let last = (grid.len - 1) as f64;
        // Splines need no samples long after the first period.
        let until_s = end_s + period_s.unwrap_or(0.0);
        let kept = below(((until_s - grid.time_s(0)) / grid.step_s).min(last)) + BEYOND;
        let splines = error_m.iter().map(|own| &own[..own.len().min(kept)]);
        let splines = splines.map(|own| CubicSpline::uniform(own, SplineEnds::NotAKnot));
        let splines: Vec<CubicSpline> = splines.collect();
        let place = |time_s: f64| ((time_s - grid.time_s(0)) / grid.step_s).clamp(0.0, last);
        let at = |place: f64| splines.iter().map(|axis| axis.value(place)).collect::<Vec<f64>>();
        let size = |place: f64| norm(splines.iter().map(|axis| axis.value(place)));
        let sample = |k: usize| norm(error_m.iter().map(|axis| axis[k]));
        let end = place(end_s);
        let until = place(until_s);
        let top = (0..=below(until)).max_by(|a, b| sample(*a).total_cmp(&sample(*b)));
        let top = top.unwrap_or(0) as f64;
        let near = (0..=2 * PARTS).map(|part| top - 1.0 + part as f64 / PARTS as f64);
        let near = near.filter(|place| (0.0..=until).contains(place)).chain([until]);
        let after = (0..PLACES).map(|k| end + (until - end) * (k as f64 + 0.5) / PLACES as f64);
        let after: Vec<Vec<f64>> = after.map(at).collect();
        let mean = |axis: usize| after.iter().map(|e| e[axis]).sum::<f64>() / PLACES as f64;
        let drift_m = match splines.len() {
            1 => mean(0),
            axes => norm((0..axes).map(mean)),
        };
        let outside = (0..grid.len).rev().find(|k| sample(*k) > band_m);
        // A wave is within the band only if it stays there for a whole period.
        let settled_s = outside.map_or(grid.time_s(0), |k| grid.time_s(k) + grid.step_s);
        let stays_s = grid.end_s() - settled_s;
        let is_settled = stays_s >= period_s.unwrap_or(0.0) && stays_s >= 0.0;
        let settling_s = is_settled.then(|| (settled_s - end_s).max(0.0));
        Self {
            tip_error_m: near.map(size).fold(0.0, f64::max),
            rest_vibration_m: 0.5 * widest(&after),
            drift_m,
            settling_s,
            period_s,
        }
    }

    /// A measure in m, without its sign.
    pub fn size_m(&self, measure: Measure) -> f64 {
        match measure {
            Measure::TipError => self.tip_error_m,
            Measure::RestVibration => self.rest_vibration_m,
            Measure::Drift => self.drift_m.abs(),
        }
    }
}

/// Number of the sample at a place or before it.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative")]
pub(super) fn below(place: f64) -> usize {
    place.max(0.0) as usize
}

/// Length of a vector.
fn norm(parts: impl Iterator<Item = f64>) -> f64 {
    parts.map(|part| part * part).sum::<f64>().sqrt()
}

/// Largest distance of two of the errors.
fn widest(errors: &[Vec<f64>]) -> f64 {
    if errors[0].len() == 1 {
        let [low, high] = extremes(&errors.iter().map(|e| e[0]).collect::<Vec<f64>>());
        return high - low;
    }
    let apart = |a: &[f64], b: &[f64]| norm(a.iter().zip(b).map(|(a, b)| a - b));
    let pairs = errors.iter().enumerate();
    let pairs = pairs.flat_map(|(k, a)| errors[k + 1..].iter().map(move |b| apart(a, b)));
    pairs.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;
    use std::slice::from_ref;

    use super::*;

    /// e = 0.3 − 0.2 t up to the end at 1 s, then 0.1 + 0.05 cos(2π(t − 1)/0.7): the period holds whole waves.
    #[test]
    fn the_measures_of_a_known_error_are_its_own() {
        let grid = TimeGrid { origin_s: 0.0, step_s: 0.01, first: -50, len: 951 };
        let error = |t: f64| {
            if t < 1.0 {
                0.3 - 0.15 * (t + 0.5) / 1.5
            } else {
                0.1 + 0.05 * (TAU * (t - 1.0) / 0.7).cos()
            }
        };
        let e: Vec<f64> = (0..grid.len).map(|k| error(grid.time_s(k))).collect();
        let found = Strays::of(from_ref(&e), &grid, (1.0, Some(0.7)), 0.2);
        assert!((found.tip_error_m - 0.3).abs() < 1e-9, "{found:?}");
        assert!((found.rest_vibration_m - 0.05).abs() < 2e-5, "{found:?}");
        assert!((found.drift_m - 0.1).abs() < 2e-5, "{found:?}");
        // |e| > 0.2 until t = 0.5.
        assert_eq!(found.settling_s, Some(0.0));
        let narrow = Strays::of(from_ref(&e), &grid, (1.0, Some(0.7)), 0.01);
        assert_eq!(narrow.settling_s, None);
        // A play that ends within a wave says nothing: |e| ≤ 0.148 in its last 0.62 s, less than the period.
        let short = TimeGrid { len: 916, ..grid };
        let wave = |t: f64| if t < 1.0 { 0.1 } else { 0.1 + 0.05 * (TAU * (t - 1.0) / 0.7).cos() };
        let waves: Vec<f64> = (0..short.len).map(|k| wave(short.time_s(k))).collect();
        let ringing = Strays::of(from_ref(&waves), &short, (1.0, Some(0.7)), 0.148);
        assert_eq!(ringing.settling_s, None);
        // Along two axes the drift is a length, and the vibration the same along any direction.
        let turned = [e.iter().map(|e| 0.6 * e).collect(), e.iter().map(|e| -0.8 * e).collect()];
        let both = Strays::of(&turned, &grid, (1.0, Some(0.7)), 0.2);
        for measure in Measure::ALL {
            assert!((both.size_m(measure) - found.size_m(measure)).abs() < 1e-9, "{measure:?}");
        }
    }
}
