use std::fmt;
use std::io::Write as _;
use std::ops::Range;
use std::str::FromStr;

use thiserror::Error;

use super::fixed::write_fixed;
use crate::numeric::{excerpt, largest};

/// How many digits the numbers of one column group are given.
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
    /// Format of a column group whose largest absolute value is `peak`.
    ///
    /// The number of decimals d is the smallest, 0 or above, with 10⁻ᵈ ≤ 10⁻ⁿ·peak. A peak of 0
    /// gives n decimals, one that is not finite the shortest text.
    ///
    /// ```
    /// use flexlink::csv::{Digits, NumberFormat};
    /// assert_eq!(Digits::BelowPeak(10).for_peak(3.2), NumberFormat::Fixed(10));
    /// assert_eq!(Digits::BelowPeak(3).for_peak(0.05), NumberFormat::Fixed(5));
    /// ```
    pub fn for_peak(&self, peak: f64) -> NumberFormat {
        self.for_peak_of(|| peak)
    }

    /// [`Self::for_peak`] of a peak that is only sought where it matters.
    pub(super) fn for_peak_of(self, peak: impl FnOnce() -> f64) -> NumberFormat {
        let Self::BelowPeak(n) = self else { return NumberFormat::Shortest };
        let peak = peak();
        if peak == 0.0 {
            return NumberFormat::Fixed(usize::from(n));
        }
        decimal_exponent(peak)
            .map(|exponent| usize::try_from(i32::from(n) - exponent).unwrap_or(0))
            .map_or(NumberFormat::Shortest, NumberFormat::Fixed)
    }
}

impl Digits {
    /// Samples as they read back from a column of their own.
    pub fn as_written(&self, samples: &[f64]) -> Vec<f64> {
        let format = self.for_peak(largest(samples));
        let mut text = Vec::new();
        let read_back = |sample: &f64| {
            text.clear();
            format.write(&mut text, *sample);
            // Every number that is written reads back.
            std::str::from_utf8(&text).ok().and_then(|text| text.parse().ok()).unwrap_or(f64::NAN)
        };
        samples.iter().map(read_back).collect()
    }
}

/// Largest e with 10ᵉ ≤ |value|; none of what is not finite.
///
/// Read from the decimal text: a logarithm may miss the powers of ten by one.
fn decimal_exponent(value: f64) -> Option<i32> {
    let text = format!("{:e}", value.abs());
    let (_, exponent) = text.split_once('e')?;
    exponent.parse().ok()
}

/// A number of digits that cannot be had.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("digits = {found}, but must be a whole number from 1 to 17, or full")]
pub struct DigitsError {
    found: String,
}

impl FromStr for Digits {
    type Err = DigitsError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "full" {
            return Ok(Self::Full);
        }
        match text.parse() {
            Ok(n @ 1..=17) => Ok(Self::BelowPeak(n)),
            _ => Err(DigitsError { found: excerpt(text).into_owned() }),
        }
    }
}

/// As it is read.
impl fmt::Display for Digits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BelowPeak(n) => write!(f, "{n}"),
            Self::Full => f.write_str("full"),
        }
    }
}

/// How the numbers of a column are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberFormat {
    /// With this many decimals, correctly rounded.
    Fixed(usize),
    /// The shortest text that reads back to the same number; with an exponent below 1e-5 and from
    /// 1e17.
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

/// Sizes whose shortest text has no exponent.
const PLAIN: Range<f64> = 1e-5..1e17;

fn write_shortest(out: &mut Vec<u8>, value: f64) {
    let written = match value.abs() {
        0.0 => write!(out, "0"),
        size if PLAIN.contains(&size) => write!(out, "{value}"),
        _ => write!(out, "{value:e}"),
    };
    debug_assert!(written.is_ok(), "memory takes every number");
}

#[cfg(test)]
mod tests {
    use super::*;

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
            assert_eq!(error.to_string(), format!("digits = {refused}, {must}"));
        }
    }
}
