//! Sixteen numbers with a fixed count of decimals at a time: most of the time of a large run is
//! spent here.
//!
//! All arithmetic is exact or its error is watched, so that the text is that of
//! [`write_fixed`](super::fixed::write_fixed), which takes over where the watch says so: about one
//! number in a hundred thousand.

#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "code for wider vectors must be inlined into its caller, and iterators need not be"
)]

use pulp::{Arch, Simd, WithSimd};

use super::fixed::write_fixed;

/// Numbers that are spelled at a time.
const BATCH: usize = 16;

/// Most decimals that two words of eight digits hold.
const MOST_DECIMALS: usize = 16;

/// 2⁵²: added to a smaller number and taken away again, it leaves a whole one.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// Numbers of more last digits than this are left to exact arithmetic.
const MOST_UNITS: f64 = 1e15;

/// Whole parts from here on do not fit eight digits.
const MOST_WHOLE: f64 = 1e8;

/// Bytes of the longest number that is spelled here, and of the words that are written over its end.
const ROOM: usize = 32;

/// Eight digits '0', as one word.
const ZEROS: u64 = 0x3030_3030_3030_3030;

/// How numbers with one count of decimals, 1 to 16, are spelled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decimals {
    count: usize,
    /// Last digits that make one.
    scale: f64,
    /// Last digits that make one of the first eight decimals' last.
    cut: f64,
    /// What fills up the first and the second eight decimals.
    fill: [f64; 2],
}

/// Digits of sixteen numbers: eight of the whole part and twice eight decimals, the first in the
/// lowest byte, each less '0'.
#[derive(Debug, Clone)]
pub(super) struct Spelled {
    words: [[u64; BATCH]; 3],
    /// 1 for a number that begins with a minus sign.
    signs: [u64; BATCH],
    exact: [bool; BATCH],
}

/// The work of [`Decimals::spell`], for the processor's own vectors.
struct Spelling<'a> {
    decimals: &'a Decimals,
    numbers: &'a [f64],
    spelled: &'a mut [Spelled],
}

impl WithSimd for Spelling<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (batches, rest) = self.numbers.as_chunks();
        for k in 0..batches.len() {
            self.decimals.spell_batch(&batches[k], &mut self.spelled[k]);
        }
        if !rest.is_empty() {
            let mut last = [0.0; BATCH];
            last[..rest.len()].copy_from_slice(rest);
            self.decimals.spell_batch(&last, &mut self.spelled[batches.len()]);
        }
    }
}

impl Spelled {
    const BLANK: Self = Self { words: [[0; BATCH]; 3], signs: [0; BATCH], exact: [false; BATCH] };
}

impl Decimals {
    /// For this many decimals; none where they are too few or too many.
    pub(super) fn new(count: usize) -> Option<Self> {
        let ten = |power: usize| (0..power).fold(1.0, |product, _| 10.0 * product);
        (1..=MOST_DECIMALS).contains(&count).then(|| {
            let (first, second) = (count.min(8), count.saturating_sub(8));
            Self {
                count,
                scale: ten(count),
                cut: ten(second),
                fill: [ten(8 - first), ten(8 - second)],
            }
        })
    }

    /// The digits of `numbers`, sixteen at a time; the last batch may hold further zeros. What was
    /// in `spelled` is written over.
    pub(super) fn spell(&self, numbers: &[f64], spelled: &mut Vec<Spelled>) {
        spelled.resize(numbers.len().div_ceil(BATCH), Spelled::BLANK);
        Arch::new().dispatch(Spelling { decimals: self, numbers, spelled });
    }

    #[inline(always)]
    fn spell_batch(&self, numbers: &[f64; BATCH], spelled: &mut Spelled) {
        let [mut wholes, mut firsts, mut seconds] = [[0.0; BATCH]; 3];
        for k in 0..BATCH {
            // Rounded once: off by at most 2⁻⁵³ of itself.
            let scaled = numbers[k].abs() * self.scale;
            let units = (scaled + WHOLE) - WHOLE;
            let rest = (scaled - units).abs();
            // Neither NaN nor a number that might be rounded the other way passes.
            let is_sure = scaled < MOST_UNITS && 0.5 - rest > scaled / WHOLE;
            let units = if is_sure { units } else { 0.0 };
            // Of whole numbers below 2⁵³ a quotient stays below the whole number above it by more
            // than its rounding: all that follows is exact.
            let whole = floor(units / self.scale);
            let fits = whole < MOST_WHOLE;
            let decimals = units - whole * self.scale;
            let first = floor(decimals / self.cut);
            wholes[k] = if fits { whole } else { 0.0 };
            firsts[k] = first * self.fill[0];
            seconds[k] = (decimals - first * self.cut) * self.fill[1];
            spelled.signs[k] = u64::from(numbers[k] < 0.0 && units > 0.0);
            spelled.exact[k] = is_sure && fits;
        }
        eight_digits(&wholes, &mut spelled.words[0]);
        eight_digits(&firsts, &mut spelled.words[1]);
        eight_digits(&seconds, &mut spelled.words[2]);
    }

    /// Appends a separator and number `k` of those spelled, which is `value`.
    #[inline(always)]
    pub(super) fn append(
        &self,
        out: &mut Vec<u8>,
        separator: u8,
        spelled: &[Spelled],
        (k, value): (usize, f64),
    ) {
        let (spelled, lane) = (&spelled[k / BATCH], k % BATCH);
        if !spelled.exact[lane] {
            out.push(separator);
            return write_fixed(out, value, self.count);
        }
        let start = out.len();
        out.extend_from_slice(&[b'-'; ROOM]);
        let room = &mut out[start..];
        room[0] = separator;
        let [whole, first, second] =
            [spelled.words[0][lane], spelled.words[1][lane], spelled.words[2][lane]];
        // The last digit of the whole part stays where it is zero.
        let leading = (whole | 1 << 56).trailing_zeros() / 8;
        let begin = 1 + (spelled.signs[lane] & 1) as usize;
        room[begin..begin + 8].copy_from_slice(&((whole + ZEROS) >> (8 * leading)).to_le_bytes());
        let point = begin + 8 - leading as usize;
        room[point] = b'.';
        room[point + 1..point + 9].copy_from_slice(&(first + ZEROS).to_le_bytes());
        room[point + 9..point + 17].copy_from_slice(&(second + ZEROS).to_le_bytes());
        out.truncate(start + point + 1 + self.count);
    }
}

/// The largest whole number at or below `x` in [0, 2⁵¹].
#[inline(always)]
fn floor(x: f64) -> f64 {
    let nearest = (x + WHOLE) - WHOLE;
    if nearest > x { nearest - 1.0 } else { nearest }
}

/// The eight digits of whole numbers below 10⁸: halves, quarters and eighths side by side.
#[inline(always)]
fn eight_digits(numbers: &[f64; BATCH], digits: &mut [u64; BATCH]) {
    for k in 0..BATCH {
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
    use crate::csv::fixed::words;

    /// As the standard library has it, a zero without sign.
    fn expected(value: f64, decimals: usize, out: &mut String) {
        use std::fmt::Write as _;
        let start = out.len();
        write!(out, "{value:.decimals$}").unwrap();
        if out[start..].bytes().all(|c| matches!(c, b'-' | b'0' | b'.')) && value.is_sign_negative()
        {
            out.remove(start);
        }
    }

    #[track_caller]
    fn check(values: &[f64], count: usize) {
        let decimals = Decimals::new(count).unwrap();
        // What is left of other numbers must not show.
        let mut spelled = vec![];
        decimals.spell(&[-1e300; 40], &mut spelled);
        decimals.spell(values, &mut spelled);
        let (mut found, mut text) = (vec![], String::new());
        for (k, value) in values.iter().enumerate() {
            decimals.append(&mut found, b';', &spelled, (k, *value));
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
            // Sizes of up to 1e8 and some beyond, down to far below the last decimal.
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
    fn what_is_no_number_or_too_large_is_left_to_the_other_way() {
        let values = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -5e-324, -0.0, 1e8, 0.5];
        (1..=MOST_DECIMALS).for_each(|count| check(&values, count));
        assert!(Decimals::new(0).is_none() && Decimals::new(MOST_DECIMALS + 1).is_none());
    }

    #[test]
    fn few_numbers_need_exact_arithmetic() {
        let values: Vec<f64> = (0..1 << 20).map(|k| 0.3 * (0.37 * f64::from(k)).sin()).collect();
        let mut spelled = vec![];
        Decimals::new(11).unwrap().spell(&values, &mut spelled);
        let left = spelled.iter().flat_map(|batch| batch.exact).filter(|exact| !exact).count();
        assert!(left < 1000, "{left} of a million");
    }
}
