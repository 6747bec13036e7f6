//! The step to which the numbers of a column are rounded, from their text.

use std::collections::BTreeMap;

/// Fewest changes of the numbers between two powers of ten from which their digits are judged. Of four
/// numbers without trailing zeros one in ten thousand has all last digits 0.
const FEWEST_CHANGES: usize = 4;

/// The numbers between two powers of ten.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Decade {
    /// Number of times that the value has changed.
    changes: usize,
    last: f64,
    /// Most decimals.
    decimals: i32,
}

/// The digits of a column, counted while it is read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Digits {
    /// By the power of ten of the first digit.
    decades: BTreeMap<i32, Decade>,
}

/// Rounding to a decimal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounding {
    /// Number of decimals; negative for tens, hundreds, ….
    pub decimals: i32,
    /// One of the last decimal.
    pub step: f64,
}

impl Digits {
    /// Counts the digits of one number.
    pub fn count(&mut self, text: &str, value: f64) {
        let Some((first, decimals)) = places(text) else { return };
        let decade =
            self.decades.entry(first).or_insert(Decade { changes: 0, last: f64::NAN, decimals });
        if value.to_bits() != decade.last.to_bits() {
            decade.changes += 1;
        }
        decade.last = value;
        decade.decimals = decade.decimals.max(decimals);
    }

    /// The rounding of the largest numbers, where there are enough to tell.
    ///
    /// Numbers with a fixed number of decimals have as many digits as the largest of them shows; those with a
    /// fixed number of digits have the fewest decimals where they are largest. Both give the decimals of the
    /// largest numbers, of which the rest at the end, one number repeated, is none.
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
            self.decades.iter().rev().find(|(_, decade)| decade.changes >= FEWEST_CHANGES)?;
        let own = self.decades.range(..=power);
        let digits = own.map(|(power, decade)| power + decade.decimals).max()?;
        let decimals = digits - power;
        let step = format!("1e{}", -decimals).parse().ok()?;
        Some(Rounding { decimals, step })
    }
}

/// Power of ten of the first digit that is not 0, and number of decimals; none for 0 and for what is no
/// decimal number.
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
        // Four digits: the largest numbers below 1 have four decimals, the small ones more.
        assert_eq!(decimals(waves().map(|x| format!("{:.3e}", 0.99 * x))), Some(4));
        assert_eq!(decimals(waves().map(|x| format!("{:.0}", 1e4 * x))), Some(0));
    }

    #[test]
    fn full_digits_are_many_decimals_and_few_numbers_none() {
        assert!(decimals(waves().map(|x| format!("{x}"))).unwrap() >= 16);
        assert!(decimals(waves().map(|x| format!("{x:.18e}"))).unwrap() >= 18);
        assert_eq!(decimals(["0", "0.5", "1", "1"].map(str::to_owned)), None);
    }
}
