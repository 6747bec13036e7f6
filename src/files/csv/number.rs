//! Numbers of one format as text. Numbers with fixed decimals are formatted sixteen at a time, because large runs spend
//! most of their time here.
//!
//! The batches compute exactly, or bound their error: a number with a doubtful last digit, about one in a hundred
//! thousand, goes to [`NumberFormat::write`], so that both always write the same text.
#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "code for wider vectors must be inlined into its caller, and iterators need not be"
)]

use std::fmt;
use std::io::Write as _;
use std::ops::Range;
use std::str::FromStr;

use pulp::{Arch, Simd, WithSimd};
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

/// Number of values in a batch.
const BATCH_LEN: usize = 16;

/// Largest number of decimals: two words of eight digits.
const MOST_DECIMALS: usize = 16;

/// 2⁵²: adding and subtracting it rounds a smaller number to a whole number.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// Largest number, in units of the last digit, that batches format; larger ones go to [`NumberFormat::write`].
const MOST_UNITS: f64 = 1e15;

/// Smallest whole part that does not fit eight digits.
const MOST_WHOLE: f64 = 1e8;

/// Number of bytes written for one cell, including those beyond its end.
const CELL_BYTES: usize = 32;

/// Eight digits '0', as one word.
const ZEROS: u64 = 0x3030_3030_3030_3030;

/// Writes the cells of a column or a row, which share one format.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellFormat {
    format: NumberFormat,
    /// Decimals in batches, 1 to [`MOST_DECIMALS`]; 0 disables batches.
    decimals: usize,
    /// 10^decimals.
    scale: f64,
    /// 10^(decimals - 8), or 1.
    cut: f64,
    /// Powers of ten that extend the first and the second word of decimals to eight digits.
    fill: [f64; 2],
}

/// Numbers with computed digits.
pub(super) struct Cells<'a> {
    format: CellFormat,
    values: &'a [f64],
    batches: &'a [Batch],
}

/// Digits of sixteen numbers: a word of eight digits for the whole part and two for the decimals, the
/// first digit in the lowest byte, each as a number from 0 to 9.
#[derive(Debug, Clone)]
pub(super) struct Batch {
    words: [[u64; BATCH_LEN]; 3],
    /// 1 for a number that begins with a minus sign.
    signs: [u64; BATCH_LEN],
    exact: [bool; BATCH_LEN],
}

/// The digits of numbers, computed in the vectors of this processor.
struct Compute<'a> {
    format: &'a CellFormat,
    numbers: &'a [f64],
    batches: &'a mut [Batch],
}

impl WithSimd for Compute<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (full, rest) = self.numbers.as_chunks();
        for k in 0..full.len() {
            self.format.compute_batch(&full[k], &mut self.batches[k]);
        }
        if !rest.is_empty() {
            let mut last = [f64::NAN; BATCH_LEN];
            last[..rest.len()].copy_from_slice(rest);
            self.format.compute_batch(&last, &mut self.batches[full.len()]);
        }
    }
}

impl Batch {
    const BLANK: Self =
        Self { words: [[0; BATCH_LEN]; 3], signs: [0; BATCH_LEN], exact: [false; BATCH_LEN] };
}

impl CellFormat {
    pub(super) fn new(format: NumberFormat) -> Self {
        let decimals = match format {
            NumberFormat::Fixed(count) if count <= MOST_DECIMALS => count,
            _ => 0,
        };
        let ten = |power: usize| (0..power).fold(1.0, |product, _| 10.0 * product);
        let (first, second) = (decimals.min(8), decimals.saturating_sub(8));
        let fill = [ten(8 - first), ten(8 - second)];
        Self { format, decimals, scale: ten(decimals), cut: ten(second), fill }
    }

    /// Computes the digits of `values`; `batches` is memory for them, reusable across calls.
    pub(super) fn cells<'a>(&self, values: &'a [f64], batches: &'a mut Vec<Batch>) -> Cells<'a> {
        let count = if self.decimals > 0 { values.len().div_ceil(BATCH_LEN) } else { 0 };
        batches.resize(count, Batch::BLANK);
        if count > 0 {
            Arch::new().dispatch(Compute { format: self, numbers: values, batches });
        }
        Cells { format: *self, values, batches }
    }

    #[inline(always)]
    fn compute_batch(&self, numbers: &[f64; BATCH_LEN], batch: &mut Batch) {
        let [mut wholes, mut firsts, mut seconds] = [[0.0; BATCH_LEN]; 3];
        for k in 0..BATCH_LEN {
            // Rounded once: the relative error is at most 2⁻⁵³.
            let scaled = numbers[k].abs() * self.scale;
            let units = (scaled + WHOLE) - WHOLE;
            let rest = (scaled - units).abs();
            // False for NaN and if this error could change the last digit.
            let is_sure = scaled < MOST_UNITS && 0.5 - rest > scaled / WHOLE;
            let units = if is_sure { units } else { 0.0 };
            // A quotient of whole numbers below 2⁵³ is farther below the next whole number than its rounding error, so
            // that all that follows is exact.
            let whole = floor(units / self.scale);
            let fits = whole < MOST_WHOLE;
            let decimals = units - whole * self.scale;
            let first = floor(decimals / self.cut);
            wholes[k] = if fits { whole } else { 0.0 };
            firsts[k] = first * self.fill[0];
            seconds[k] = (decimals - first * self.cut) * self.fill[1];
            batch.signs[k] = u64::from(numbers[k] < 0.0 && units > 0.0);
            batch.exact[k] = is_sure && fits;
        }
        eight_digits(&wholes, &mut batch.words[0]);
        eight_digits(&firsts, &mut batch.words[1]);
        eight_digits(&seconds, &mut batch.words[2]);
    }

    /// Appends a separator and the number in this lane of a batch, with exact digits.
    #[inline(always)]
    fn append_exact(&self, out: &mut Vec<u8>, separator: u8, batch: &Batch, lane: usize) {
        let start = out.len();
        out.extend_from_slice(&[b'-'; CELL_BYTES]);
        let cell = &mut out[start..];
        cell[0] = separator;
        let [whole, first, second] =
            [batch.words[0][lane], batch.words[1][lane], batch.words[2][lane]];
        // The whole part keeps its last digit, even a zero.
        let leading = (whole | 1 << 56).trailing_zeros() / 8;
        let begin = 1 + (batch.signs[lane] & 1) as usize;
        cell[begin..begin + 8].copy_from_slice(&((whole + ZEROS) >> (8 * leading)).to_le_bytes());
        let point = begin + 8 - leading as usize;
        cell[point] = b'.';
        cell[point + 1..point + 9].copy_from_slice(&(first + ZEROS).to_le_bytes());
        cell[point + 9..point + 17].copy_from_slice(&(second + ZEROS).to_le_bytes());
        out.truncate(start + point + 1 + self.decimals);
    }
}

impl Cells<'_> {
    /// Appends a separator and the text of cell `k`; the text is empty for a missing number or one that is not finite.
    #[inline(always)]
    pub(super) fn append(&self, out: &mut Vec<u8>, separator: u8, k: usize) {
        match self.batches.get(k / BATCH_LEN) {
            Some(batch) if batch.exact[k % BATCH_LEN] => {
                self.format.append_exact(out, separator, batch, k % BATCH_LEN);
            }
            _ => self.append_alone(out, separator, k),
        }
    }

    #[inline(never)]
    fn append_alone(&self, out: &mut Vec<u8>, separator: u8, k: usize) {
        out.push(separator);
        if let Some(value) = self.values.get(k).filter(|value| value.is_finite()) {
            self.format.format.write(out, *value);
        }
    }
}

/// Largest whole number at or below `x` in [0, 2⁵¹].
#[inline(always)]
fn floor(x: f64) -> f64 {
    let nearest = (x + WHOLE) - WHOLE;
    if nearest > x { nearest - 1.0 } else { nearest }
}

/// The eight digits of whole numbers below 10⁸.
#[inline(always)]
fn eight_digits(numbers: &[f64; BATCH_LEN], digits: &mut [u64; BATCH_LEN]) {
    for k in 0..BATCH_LEN {
        let high = floor((numbers[k] + 0.5) * 1e-4);
        let low = numbers[k] - 1e4 * high;
        digits[k] = u64::from(four_digits(high)) | u64::from(four_digits(low)) << 32;
    }
}

/// The four digits of a whole number below 10⁴.
#[inline(always)]
fn four_digits(number: f64) -> u32 {
    let number = ((number + WHOLE).to_bits() & 0xffff_ffff) as u32;
    // x/100 = 10486x >> 20 below 10⁴, x/10 = 103x >> 10 below 100.
    let hundreds = (number * 10_486) >> 20;
    let quarters = hundreds | ((number - 100 * hundreds) << 16);
    let tens = ((quarters * 103) >> 10) & 0x000f_000f;
    tens | ((quarters - 10 * tens) << 8)
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

    /// Patternless words (Steele, Lea, Flood 2014: `SplitMix64`).
    fn words(seed: u64) -> impl Iterator<Item = u64> {
        (1_u64..).map(move |k| {
            let mut z = (seed + k).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            z ^ (z >> 31)
        })
    }

    /// The text of the standard library, without the sign of a zero; empty for a number that is not finite.
    fn expected(value: f64, decimals: usize, out: &mut String) {
        use std::fmt::Write as _;
        if !value.is_finite() {
            return;
        }
        let start = out.len();
        write!(out, "{value:.decimals$}").unwrap();
        if out[start..].bytes().all(|c| matches!(c, b'-' | b'0' | b'.')) && value.is_sign_negative()
        {
            out.remove(start);
        }
    }

    #[track_caller]
    fn check(values: &[f64], count: usize) {
        let format = CellFormat::new(NumberFormat::Fixed(count));
        // The digits of earlier numbers must not remain.
        let mut batches = vec![];
        format.cells(&[-1e300; 40], &mut batches);
        let cells = format.cells(values, &mut batches);
        let (mut found, mut text) = (vec![], String::new());
        for (k, value) in values.iter().enumerate() {
            cells.append(&mut found, b';', k);
            text.push(';');
            expected(*value, count, &mut text);
        }
        if found != text.as_bytes() {
            let found = String::from_utf8(found).unwrap();
            let pair = found.split(';').zip(text.split(';')).find(|(a, b)| a != b);
            panic!("{count} decimals: {pair:?}");
        }
    }

    #[test]
    fn ten_million_numbers_are_written_as_the_standard_library_writes_them() {
        let mut numbers = words(3 << 40).zip(words(5 << 40));
        for count in (1..=MOST_DECIMALS).cycle().take(1000) {
            // Sizes up to 1e8 and a few larger, down to far below the last decimal.
            let number = |(word, more): (u64, u64)| {
                let exponent =
                    1023 - 30 - 3 * count as u64 / 2 + more % (60 + 3 * count as u64 / 2);
                f64::from_bits((word & !(0x7ff << 52)) | (exponent << 52))
            };
            let values: Vec<f64> = numbers.by_ref().take(10_000).map(number).collect();
            check(&values, count);
        }
    }

    #[test]
    fn ties_and_carries_are_written_as_the_standard_library_writes_them() {
        for count in 1..=MOST_DECIMALS {
            let half = 0.5_f64.powi(i32::try_from(count).unwrap() + 1);
            let ties = (0..3000).map(|k| f64::from(2 * k + 1) * half);
            let sums = words(7 << 40).take(3000).map(|word| (2 * (word >> 30) + 1) as f64 * half);
            let powers = (0..26).map(|power| 10_f64.powi(power - 17));
            let carries = powers.flat_map(|power| {
                [power, power.next_down(), power.next_up(), power * 0.999_999_999_5]
            });
            let values: Vec<f64> = ties.chain(sums).chain(carries).flat_map(|x| [x, -x]).collect();
            check(&values, count);
        }
    }

    #[test]
    fn cells_of_large_numbers_are_whole_and_those_of_no_number_empty() {
        let values = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -5e-324, -0.0, 1e8, 0.5];
        (1..=MOST_DECIMALS).for_each(|count| check(&values, count));
        for count in [0, MOST_DECIMALS + 1] {
            assert_eq!(CellFormat::new(NumberFormat::Fixed(count)).decimals, 0);
            check(&values, count);
        }
    }

    #[test]
    fn few_numbers_need_exact_arithmetic() {
        let values: Vec<f64> = (0..1 << 20).map(|k| 0.3 * (0.37 * f64::from(k)).sin()).collect();
        let mut batches = vec![];
        CellFormat::new(NumberFormat::Fixed(11)).cells(&values, &mut batches);
        let left = batches.iter().flat_map(|batch| batch.exact).filter(|exact| !exact).count();
        assert!(left < 1000, "{left} of a million");
    }
}
