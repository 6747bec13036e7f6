use std::fmt;
use std::io::Write as _;
use std::ops::Range;
use std::str::FromStr;

use rayon::prelude::*;

use crate::numeric::largest;
use crate::text::excerpt;

/// Number of digits in a column group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Digits {
    /// The last digit is at most 10⁻ⁿ of the group's peak, n from 1 to 17.
    BelowPeak(u8),
    /// The shortest text that reads back to the same number.
    Full,
}

impl Default for Digits {
    fn default() -> Self {
        Self::BelowPeak(10)
    }
}

impl Digits {
    /// Format of a column group from its largest absolute value.
    ///
    /// The number of decimals d is the smallest, 0 or above, with 10⁻ᵈ ≤ 10⁻ⁿ·peak. A peak of 0 yields n decimals, one
    /// that is not finite the shortest text.
    ///
    /// ```
    /// use flexlink::csv::{Digits, NumberFormat};
    /// assert_eq!(Digits::BelowPeak(10).for_peak(3.2), NumberFormat::Fixed(10));
    /// assert_eq!(Digits::BelowPeak(3).for_peak(0.05), NumberFormat::Fixed(5));
    /// ```
    pub fn for_peak(&self, peak: f64) -> NumberFormat {
        match *self {
            Self::Full => NumberFormat::Shortest,
            Self::BelowPeak(n) if peak == 0.0 => NumberFormat::Fixed(usize::from(n)),
            Self::BelowPeak(n) => match decimal_exponent(peak) {
                Some(exponent) => {
                    NumberFormat::Fixed(usize::try_from(i32::from(n) - exponent).unwrap_or(0))
                }
                None => NumberFormat::Shortest,
            },
        }
    }

    /// The samples as they read back from a written column.
    pub fn as_written(&self, samples: &[f64]) -> Vec<f64> {
        let format = self.for_peak(largest(samples));
        let mut text = Vec::new();
        let read_back = |sample: &f64| {
            text.clear();
            format.write(&mut text, *sample);
            std::str::from_utf8(&text).ok().and_then(|text| text.parse().ok()).unwrap_or(f64::NAN)
        };
        samples.iter().map(read_back).collect()
    }
}

/// Largest e with 10ᵉ ≤ |value|; `None` if the value is not finite.
///
/// It uses the decimal text, because a logarithm may miss a power of ten by one.
fn decimal_exponent(value: f64) -> Option<i32> {
    let text = format!("{:e}", value.abs());
    let (_, exponent) = text.split_once('e')?;
    exponent.parse().ok()
}

impl FromStr for Digits {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "full" {
            return Ok(Self::Full);
        }
        if let Ok(n @ 1..=17) = text.parse() {
            return Ok(Self::BelowPeak(n));
        }
        let found = excerpt(text);
        Err(format!("digits = {found}, but must be a whole number from 1 to 17, or full"))
    }
}

/// Text as [`FromStr`] reads it.
impl fmt::Display for Digits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BelowPeak(n) => write!(f, "{n}"),
            Self::Full => f.write_str("full"),
        }
    }
}

/// Format of the numbers of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberFormat {
    /// A fixed number of decimals, correctly rounded.
    Fixed(usize),
    /// The shortest text that reads back to the same number, with an exponent below 1e-5 and from 1e17.
    Shortest,
}

impl NumberFormat {
    /// Appends `value` to `out`; a zero never has a sign.
    ///
    /// ```
    /// use flexlink::csv::NumberFormat;
    /// let mut out = Vec::new();
    /// NumberFormat::Fixed(3).write(&mut out, -0.0004);
    /// assert_eq!(out, b"0.000");
    /// ```
    pub fn write(&self, out: &mut Vec<u8>, value: f64) {
        match *self {
            Self::Fixed(decimals) => write_fixed(out, value, decimals),
            Self::Shortest => write_shortest(out, value),
        }
    }
}

fn write_fixed(out: &mut Vec<u8>, value: f64, decimals: usize) {
    let start = out.len();
    // The formatter takes no more decimals. Writing to memory cannot fail.
    let decimals = decimals.min(usize::from(u16::MAX));
    let _ = write!(out, "{value:.decimals$}");
    if let [b'-', digits @ ..] = &out[start..]
        && digits.iter().all(|digit| matches!(digit, b'0' | b'.'))
    {
        out.remove(start);
    }
}

/// Range of sizes whose shortest text has no exponent.
const PLAIN: Range<f64> = 1e-5..1e17;

fn write_shortest(out: &mut Vec<u8>, value: f64) {
    // Writing to memory cannot fail.
    let _ = match value.abs() {
        0.0 => write!(out, "0"),
        size if PLAIN.contains(&size) => write!(out, "{value}"),
        _ => write!(out, "{value:e}"),
    };
}

/// Largest error of a time after reading back, in s.
const TOLERANCE_S: f64 = 1e-12;
/// Largest error in steps, so that times at steps below 10 ns stay distinct.
const TOLERANCE: f64 = 1e-4;
/// Largest number of decimals; beyond it the shortest text takes over.
const MAX_DECIMALS: usize = 15;
/// Limit below which every whole number is exact.
const EXACT_INTEGERS: f64 = 9_007_199_254_740_992.0;

/// Fewest times for a parallel task.
const TIMES_AT_ONCE: usize = 1 << 14;

/// Fewest decimals with which each of `len` times reads back within 1e-12 s and 1e-4 of their step.
///
/// Too few decimals usually fail at one of the first times, so that about one pass over all times suffices.
pub(crate) fn time_format(time: impl Fn(usize) -> f64 + Sync, len: usize) -> NumberFormat {
    let steps = len.saturating_sub(1);
    let mut tolerance_s = TOLERANCE_S;
    if steps > 0 {
        let step_s = (time(steps) - time(0)).abs() / steps as f64;
        tolerance_s = tolerance_s.min(TOLERANCE * step_s);
    }
    let mut scale = 1.0;
    for decimals in 0..=MAX_DECIMALS {
        let reads_back = |k: usize| {
            let time = time(k);
            let last_digits = (time * scale).round();
            // A whole number below 2⁵³ divided by an exact power of ten is rounded once, like a decimal text by its
            // reader; larger ones are written and read back.
            let read = if last_digits.abs() < EXACT_INTEGERS {
                last_digits / scale
            } else {
                format!("{time:.decimals$}").parse().unwrap_or(f64::NAN)
            };
            (read - time).abs() <= tolerance_s
        };
        if (0..len).into_par_iter().with_min_len(TIMES_AT_ONCE).all(reads_back) {
            return NumberFormat::Fixed(decimals);
        }
        scale *= 10.0;
    }
    NumberFormat::Shortest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::TimeGrid;

    fn text(format: NumberFormat, value: f64) -> String {
        let mut out = b"before,".to_vec();
        format.write(&mut out, value);
        String::from_utf8(out.split_off(7)).unwrap()
    }

    #[test]
    fn the_last_digit_stays_at_or_below_its_share_of_the_peak() {
        let decimals = |n, peak| Digits::BelowPeak(n).for_peak(peak);
        for (n, peak, expected) in [
            (10, 1.0, 10),
            (10, 0.999, 11),
            (10, 9.99, 10),
            (10, 10.0, 9),
            (10, 1000.0, 7),
            (3, 0.001, 6),
            (3, 0.000_999, 7),
            (10, 1e10, 0),
            (10, 1e300, 0),
            (10, 0.0, 10),
            (2, 5e-324, 326),
        ] {
            assert_eq!(decimals(n, peak), NumberFormat::Fixed(expected), "{n} {peak}");
        }
        assert_eq!(decimals(10, f64::INFINITY), NumberFormat::Shortest);
        assert_eq!(decimals(10, f64::NAN), NumberFormat::Shortest);
        assert_eq!(Digits::Full.for_peak(1.0), NumberFormat::Shortest);
    }

    #[test]
    fn a_zero_has_no_sign() {
        assert_eq!(text(NumberFormat::Fixed(3), -0.000_49), "0.000");
        assert_eq!(text(NumberFormat::Fixed(3), -0.000_51), "-0.001");
        assert_eq!(text(NumberFormat::Fixed(0), -0.3), "0");
        assert_eq!(text(NumberFormat::Fixed(0), -10.0), "-10");
        assert_eq!(text(NumberFormat::Shortest, -0.0), "0");
    }

    #[test]
    fn shortest_texts_read_back_to_the_same_number() {
        for (value, expected) in [
            (0.1, "0.1"),
            (-2.5, "-2.5"),
            (1e16, "10000000000000000"),
            (1e17, "1e17"),
            (-1.25e300, "-1.25e300"),
            (1e-5, "0.00001"),
            (9.5e-6, "9.5e-6"),
            (5e-324, "5e-324"),
            (1.0 / 3.0, "0.3333333333333333"),
        ] {
            assert_eq!(text(NumberFormat::Shortest, value), expected);
            assert_eq!(expected.parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
    }

    #[test]
    fn fixed_decimals_hold_for_huge_and_tiny_numbers() {
        assert_eq!(text(NumberFormat::Fixed(2), 1e22), "10000000000000000000000.00");
        assert_eq!(text(NumberFormat::Fixed(10), 1e-300), "0.0000000000");
    }

    #[test]
    fn digits_are_one_to_seventeen_or_full() {
        assert_eq!("10".parse(), Ok(Digits::default()));
        assert_eq!("full".parse(), Ok(Digits::Full));
        for digits in [Digits::BelowPeak(17), Digits::Full] {
            assert_eq!(digits.to_string().parse(), Ok(digits));
        }
        for refused in ["0", "18", "-1", "ten", "", "3.0"] {
            let error = refused.parse::<Digits>().unwrap_err();
            let must = "but must be a whole number from 1 to 17, or full";
            assert_eq!(error, format!("digits = {refused}, {must}"));
        }
    }

    /// By the definition: writes all times and reads them back.
    fn fits(grid: &TimeGrid, decimals: usize) -> bool {
        let allowed_s = 1e-12_f64.min(1e-4 * grid.duration_s() / (grid.len - 1) as f64);
        (0..grid.len).all(|k| {
            let text = format!("{:.decimals$}", grid.time_s(k));
            (text.parse::<f64>().unwrap() - grid.time_s(k)).abs() <= allowed_s
        })
    }

    fn grid(origin_s: f64, step_s: f64, first: i64, len: usize) -> TimeGrid {
        TimeGrid { origin_s, step_s, first, len }
    }

    #[test]
    fn the_decimals_are_the_fewest_that_read_back() {
        for grid in [
            grid(0.0, 0.001, -700, 3000),
            grid(0.0, 0.25, 0, 9),
            grid(5.0, 1.0, -3, 9),
            grid(0.125, 0.01, 0, 500),
            grid(0.0, 1.0 / 1024.0, -5, 2000),
            grid(0.0, 1.0 / 3.0, 0, 100),
            grid(0.0, 0.88 / 880.0, 0, 881),
            grid(0.0, 1e-6, 0, 5000),
            grid(4.0e4, 0.001, 0, 5000),
            grid(1.7e9, 0.001, 0, 3000),
            grid(0.0, 1e-13, 0, 50),
            grid(0.0, 1e-12, 1, 50),
        ] {
            let expected = (0..=15).find(|&d| fits(&grid, d));
            let expected = expected.map_or(NumberFormat::Shortest, NumberFormat::Fixed);
            assert_eq!(time_format(|k| grid.time_s(k), grid.len), expected, "{grid:?}");
        }
    }

    #[test]
    fn a_late_sample_may_ask_for_more_decimals() {
        let time = |k: usize| if k == 999_999 { 0.125 } else { 0.0 };
        assert_eq!(time_format(time, 1_000_000), NumberFormat::Fixed(3));
        assert_eq!(time_format(|k| 0.002 * k as f64, 1000), NumberFormat::Fixed(3));
    }

    #[test]
    fn times_that_are_too_close_for_decimals_take_the_shortest_text_and_stay_apart() {
        assert_eq!(time_format(|k| 1e-18 * k as f64, 4), NumberFormat::Shortest);
        for step_s in [1e-13, 0.3e-14, 1e-18, 1e-300] {
            let format = time_format(|k| step_s * k as f64, 50);
            let text = |k: usize| {
                let mut text = Vec::new();
                format.write(&mut text, step_s * k as f64);
                String::from_utf8(text).unwrap()
            };
            let read = |k: usize| text(k).parse::<f64>().unwrap() / step_s;
            for k in 0..50 {
                assert!((read(k) - k as f64).abs() < 1e-3, "{step_s:e}: {}", text(k));
            }
        }
    }
}
