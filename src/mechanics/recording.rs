//! Quality of a recorded motion: digits and times of its samples, and rests at its ends.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use thiserror::Error;

use crate::numeric::TimeGrid;

mod bursts;
mod course;
mod outliers;

pub use course::Change;
pub use outliers::{Outlier, outliers};

/// Fewest different sizes of numbers between two powers of ten that show their digits. Of four numbers without trailing
/// zeros one in ten thousand has all last digits 0.
const FEWEST_DIFFERENT: usize = 4;

/// The numbers between two powers of ten.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Decade {
    /// The first different sizes.
    sizes: [f64; FEWEST_DIFFERENT],
    /// Number of different sizes.
    different: usize,
    /// Largest number of decimals.
    decimals: i32,
}

/// Digits of a column, counted during reading.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Digits {
    /// Decades by the power of ten of the first digit.
    decades: BTreeMap<i32, Decade>,
}

/// Rounding to a decimal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounding {
    /// Number of decimals; negative for tens, hundreds, ….
    pub decimals: i32,
    /// Unit of the last decimal.
    pub step: f64,
}

impl Digits {
    /// Counts the digits of one number.
    pub fn count(&mut self, text: &str, value: f64) {
        let Some((first, decimals)) = places(text) else { return };
        let none = Decade { sizes: [0.0; FEWEST_DIFFERENT], different: 0, decimals };
        let decade = self.decades.entry(first).or_insert(none);
        let known = &decade.sizes[..decade.different];
        if known.len() < FEWEST_DIFFERENT
            && known.iter().all(|size| size.total_cmp(&value.abs()).is_ne())
        {
            decade.sizes[decade.different] = value.abs();
            decade.different += 1;
        }
        decade.decimals = decade.decimals.max(decimals);
    }

    /// Rounding of the largest numbers, if there are enough of them.
    ///
    /// With a fixed number of decimals the largest number shows the number of digits; with a fixed number of digits the
    /// largest numbers have the fewest decimals. Both yield the decimals of the largest numbers. The rest at the end,
    /// one number repeated, does not count among them.
    ///
    /// ```
    /// use flexlink::recording::Digits;
    /// let mut digits = Digits::default();
    /// for (text, value) in [("0.10", 0.1), ("0.2", 0.2), ("0.33", 0.33), ("0.45", 0.45), ("1", 1.0)] {
    ///     digits.count(text, value);
    /// }
    /// assert_eq!(digits.rounding().unwrap().decimals, 2);
    /// ```
    pub fn rounding(&self) -> Option<Rounding> {
        let (power, _) =
            self.decades.iter().rev().find(|(_, decade)| decade.different >= FEWEST_DIFFERENT)?;
        let smaller = self.decades.range(..=power);
        let digits = smaller.map(|(power, decade)| power + decade.decimals).max()?;
        let decimals = digits - power;
        let step = format!("1e{}", -decimals).parse().ok()?;
        Some(Rounding { decimals, step })
    }
}

/// Power of ten of the first digit that is not 0, and number of decimals; `None` for 0 and for text that is no decimal
/// number.
fn places(text: &str) -> Option<(i32, i32)> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse().ok()?),
        None => (text, 0_i32),
    };
    let mantissa = mantissa.trim_start_matches(['+', '-']);
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if !(is_digits(whole) && is_digits(fraction)) {
        return None;
    }
    let decimals = i32::try_from(fraction.len()).ok()?;
    let mut digits = whole.bytes().chain(fraction.bytes());
    let leading = i32::try_from(digits.position(|digit| digit != b'0')?).ok()?;
    let before = i32::try_from(whole.len()).ok()?;
    let first = (before - 1 - leading).checked_add(exponent)?;
    Some((first, decimals.checked_sub(exponent)?))
}

/// Largest distance of a time from the uniform grid, in steps, that needs no option for interpolation.
pub const LARGEST_JITTER: f64 = 0.05;

/// Jitter in steps below which times count as uniform if the tip does not show it.
const UNIFORM: f64 = 1e-3;

/// Tip displacement due to jitter, over the travel, that stays unnoticed.
const UNNOTICED: f64 = 2e-7;

/// Largest distance of times in s from the best uniform grid, in steps, if the motion must be interpolated. Then the
/// jitter exceeds the rounding of the times, changes the displacement noticeably, if known, and is at most
/// [`LARGEST_JITTER`].
pub fn jitter(time_s: &[f64], displacement_m: Option<&[f64]>) -> Option<f64> {
    if time_s.len() < 2 {
        return None;
    }
    let [from_ends, steps] = TimeGrid::jitter(time_s);
    let is_noticed =
        from_ends > UNIFORM || displacement_m.is_some_and(|d| share(d) * from_ends > UNNOTICED);
    (is_noticed && steps <= LARGEST_JITTER).then_some(steps)
}

/// Largest step of the tip over its travel.
fn share(displacement_m: &[f64]) -> f64 {
    let step_m = displacement_m.windows(2).map(|d| (d[1] - d[0]).abs()).fold(0.0, f64::max);
    let start_m = displacement_m.first().copied().unwrap_or(0.0);
    let travel_m = displacement_m.iter().map(|d| (d - start_m).abs()).fold(0.0, f64::max);
    if travel_m > 0.0 { step_m / travel_m } else { 0.0 }
}

/// Fewest samples of a rest.
const FEWEST: usize = 8;

/// Largest distance of a sample of a rest from its mean, in standard deviations; also the limit for the mean of the
/// next few samples.
const QUIET: f64 = 5.0;

/// A recording that moves from its first sample on or up to its last one.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "the recording rests for {samples} samples at its {}, within {QUIET} standard deviations of the noise, but must \
     rest for {FEWEST}",
    if *at_end { "end" } else { "start" }
)]
pub struct NoRest {
    /// Number of samples at rest.
    pub samples: usize,
    /// True for the end of the recording.
    pub at_end: bool,
}

/// Makes both ends of displacements exactly at rest: the first half of each rest becomes its mean, the second half
/// blends into the samples. Also returns the largest change.
///
/// # Errors
/// [`NoRest`] unless both ends rest for some samples.
pub fn rested(displacement_m: &[f64], deviation_m: f64) -> Result<(Vec<f64>, f64), NoRest> {
    let mut rested = displacement_m.to_vec();
    for at_end in [false, true] {
        let quiet = quiet(&rested, deviation_m);
        if quiet < FEWEST {
            return Err(NoRest { samples: quiet, at_end });
        }
        let mean = rested[..quiet].iter().sum::<f64>() / quiet as f64;
        let half = quiet / 2;
        for (k, sample) in rested[..quiet].iter_mut().enumerate() {
            let beyond = k.saturating_sub(half) as f64 / (quiet - half) as f64;
            let kept = 0.5 * (1.0 - libm::cos(PI * beyond));
            *sample = mean + kept * (*sample - mean);
        }
        rested.reverse();
    }
    let moved = rested.iter().zip(displacement_m).map(|(a, b)| (a - b).abs());
    let moved_m = moved.fold(0.0, f64::max);
    Ok((rested, moved_m))
}

/// Number of samples from the first one on that stay at the mean of the samples before them. The means of any
/// [`FEWEST`] of them must also stay, because they show a slow start earlier than a single sample.
fn quiet(displacement_m: &[f64], deviation_m: f64) -> usize {
    let (mut sum, mut recent) = (0.0, 0.0);
    for (k, sample) in displacement_m.iter().enumerate() {
        recent += sample;
        if k >= FEWEST {
            recent -= displacement_m[k - FEWEST];
            let mean = sum / k as f64;
            let of_recent = recent / FEWEST as f64;
            let noise = deviation_m / (FEWEST as f64).sqrt();
            if (sample - mean).abs() > QUIET * deviation_m
                || (of_recent - mean).abs() > QUIET * noise
            {
                return k.saturating_sub(FEWEST);
            }
        }
        sum += sample;
    }
    displacement_m.len() / 2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decimals(texts: impl IntoIterator<Item = String>) -> Option<i32> {
        let mut digits = Digits::default();
        for text in texts {
            let value = text.parse().unwrap();
            digits.count(&text, value);
        }
        digits.rounding().map(|rounding| rounding.decimals)
    }

    fn waves() -> impl Iterator<Item = f64> {
        (0..200)
            .map(|k| 0.5 - 0.5 * libm::cos(std::f64::consts::PI * f64::from(k.min(150)) / 150.0))
    }

    #[test]
    fn places_are_counted_from_the_point() {
        let found = ["0.10", "1e-5", "-12.5", "2.50E+3", "007", "3.25e2"].map(places);
        let expected = [(-1, 2), (-5, 5), (1, 1), (3, -1), (0, 0), (2, 0)];
        assert_eq!(found, expected.map(Some));
        assert_eq!(["0.00", "inf", "", "1e999999999999"].map(places), [None; 4]);
    }

    #[test]
    fn all_ways_to_write_four_decimals_are_four_decimals() {
        assert_eq!(decimals(waves().map(|x| format!("{x:.4}"))), Some(4));
        // Without trailing zeros.
        assert_eq!(decimals(waves().map(|x| format!("{}", (1e4 * x).round() / 1e4))), Some(4));
        // Four digits: the largest numbers below 1 have four decimals, smaller ones more.
        assert_eq!(decimals(waves().map(|x| format!("{:.3e}", 0.99 * x))), Some(4));
        assert_eq!(decimals(waves().map(|x| format!("{:.0}", 1e4 * x))), Some(0));
    }

    #[test]
    fn full_digits_are_many_decimals_and_few_numbers_none() {
        assert!(decimals(waves().map(|x| format!("{x}"))).unwrap() >= 16);
        assert!(decimals(waves().map(|x| format!("{x:.18e}"))).unwrap() >= 18);
        assert_eq!(decimals(["0", "0.5", "1", "1"].map(str::to_owned)), None);
    }

    #[test]
    fn times_are_as_they_are_where_their_digits_say_so_and_the_tip_shows_it() {
        let times = |decimals: i32, jitter: f64| -> Vec<f64> {
            let unit = 10.0_f64.powi(decimals);
            let off = |k: i32| if k % 3 == 1 { jitter } else { 0.0 };
            (0..=500).map(|k| ((f64::from(k) / 300.0 + off(k)) * unit).round() / unit).collect()
        };
        let ramp: Vec<f64> = (0..=500).map(|k| f64::from(k) / 500.0).collect();
        assert_eq!(jitter(&times(4, 0.0), Some(&ramp)), None, "rounded times");
        assert_eq!(jitter(&times(12, 1e-12), Some(&ramp)), None);
        let found = jitter(&times(12, 1e-6), Some(&ramp)).unwrap();
        assert!((found - 2e-4).abs() < 1e-5, "{found}");
        assert_eq!(jitter(&times(12, 1e-6), None), None, "an acceleration is integrated twice");
        assert!(jitter(&times(12, 1e-4), None).is_some());
        assert_eq!(jitter(&times(12, 3e-4), Some(&ramp)), None, "left to be refused");
    }

    #[test]
    fn rests_become_their_means_and_the_motion_stays() {
        let noise = |k: usize| 1e-3 * (((k * 7919) % 101) as f64 / 50.0 - 1.0);
        let at = |k: usize| (k.clamp(100, 200) as f64 - 100.0) / 100.0 + noise(k);
        let samples: Vec<f64> = (0..300).map(at).collect();
        let (rested, moved_m) = rested(&samples, 6e-4).unwrap();
        assert!(moved_m <= 1.2e-3, "{moved_m}");
        assert!(rested[..40].iter().all(|x| (x - rested[0]).abs() < 1e-15));
        assert!(rested[0].abs() < 2e-4 && (rested[299] - 1.0).abs() < 2e-4);
        assert_eq!(rested[110..190], samples[110..190]);
        let error = super::rested(&samples[100..], 6e-4).unwrap_err();
        assert!(!error.at_end && error.samples < FEWEST, "{error}");
    }
}
