//! Numbers with a fixed count of decimals, correctly rounded, as the standard library writes them
//! and several times faster.

use std::io::Write as _;

/// 5ᵈ for every count of decimals that is written here; with more, 128 bits do not hold the product.
const POWERS_OF_FIVE: [u64; 28] = {
    let mut powers = [1; 28];
    let mut d = 1;
    while d < 28 {
        powers[d] = 5 * powers[d - 1];
        d += 1;
    }
    powers
};

/// Bits of the fraction of a double.
const FRACTION_BITS: u32 = 52;

/// Appends `value` with this many decimals; a tie goes to the even digit, a zero has no sign.
pub(super) fn write_fixed(out: &mut Vec<u8>, value: f64, decimals: usize) {
    if let Some(units) = scaled(value.abs(), decimals) {
        if value < 0.0 && units > 0 {
            out.push(b'-');
        }
        write_units(out, units, decimals);
        return;
    }
    let start = out.len();
    let written = write!(out, "{value:.decimals$}");
    debug_assert!(written.is_ok(), "memory takes every number");
    if let [b'-', digits @ ..] = &out[start..]
        && digits.iter().all(|digit| matches!(digit, b'0' | b'.'))
    {
        out.remove(start);
    }
}

/// `size · 10^decimals`, rounded to the nearest integer; none where 64 bits do not hold it.
///
/// A double is m·2ᵉ with whole m below 2⁵³, so that m·5ᵈ is exact in 128 bits, and the rest of
/// 10ᵈ = 5ᵈ·2ᵈ is a shift.
fn scaled(size: f64, decimals: usize) -> Option<u64> {
    let power = *POWERS_OF_FIVE.get(decimals)?;
    let bits = size.to_bits();
    let fraction = bits & ((1 << FRACTION_BITS) - 1);
    let exponent = i32::try_from(bits >> FRACTION_BITS).ok()?;
    // Infinity, and what is no number, have the largest exponent.
    let (mantissa, exponent) = match exponent {
        0x7ff => return None,
        0 => (fraction, 1),
        _ => (fraction | (1 << FRACTION_BITS), exponent),
    };
    let product = u128::from(mantissa) * u128::from(power);
    // value · 10ᵈ = product · 2^−shift
    let shift = 1075 - exponent - i32::try_from(decimals).ok()?;
    if shift <= 0 {
        let up = u32::try_from(-shift).ok().filter(|up| *up <= product.leading_zeros())?;
        return u64::try_from(product << up).ok();
    }
    // Both factors are below 2¹¹⁷ together: beyond that less than a half is left.
    let Some(down) = u32::try_from(shift).ok().filter(|down| *down < 120) else { return Some(0) };
    let (whole, rest) = (product >> down, product & ((1 << down) - 1));
    let half = 1_u128 << (down - 1);
    let up = rest > half || (rest == half && whole & 1 == 1);
    u64::try_from(whole + u128::from(up)).ok()
}

/// Writes `units · 10^−decimals`.
fn write_units(out: &mut Vec<u8>, units: u64, decimals: usize) {
    // 24 digits in three groups, and where they begin.
    let mut digits = [0; 24];
    let (high, low) = (units / 100_000_000, units % 100_000_000);
    digits[16..].copy_from_slice(&eight_digits(low));
    digits[8..16].copy_from_slice(&eight_digits(high % 100_000_000));
    digits[..8].copy_from_slice(&eight_digits(high / 100_000_000));
    let written = digits.iter().position(|digit| *digit != b'0').unwrap_or(digits.len());
    let point = digits.len().saturating_sub(decimals);
    if written >= point || point == 0 {
        out.push(b'0');
    } else {
        out.extend_from_slice(&digits[written..point]);
    }
    if decimals == 0 {
        return;
    }
    out.push(b'.');
    out.extend(std::iter::repeat_n(b'0', decimals.saturating_sub(digits.len())));
    out.extend_from_slice(&digits[point..]);
}

/// The eight digits of a number below 10⁸, all at once: halves, quarters and eighths side by side in
/// one word.
fn eight_digits(number: u64) -> [u8; 8] {
    let halves = (number / 10_000) | ((number % 10_000) << 32);
    // x/100 = 10486x >> 20 below 10⁴, x/10 = 103x >> 10 below 100.
    let hundreds = ((halves * 10_486) >> 20) & 0x0000_007f_0000_007f;
    let quarters = hundreds | ((halves - 100 * hundreds) << 16);
    let tens = ((quarters * 103) >> 10) & 0x000f_000f_000f_000f;
    let digits = tens | ((quarters - 10 * tens) << 8);
    (digits + 0x3030_3030_3030_3030).to_le_bytes()
}

/// Words without pattern (Steele, Lea, Flood 2014: `SplitMix64`).
#[cfg(test)]
pub(super) fn words(seed: u64) -> impl Iterator<Item = u64> {
    (1_u64..).map(move |k| {
        let mut z = (seed + k).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the standard library has it, a zero without sign.
    fn expected(value: f64, decimals: usize) -> String {
        let text = format!("{value:.decimals$}");
        let is_zero = text.bytes().all(|c| matches!(c, b'-' | b'0' | b'.'));
        if is_zero { text.trim_start_matches('-').to_owned() } else { text }
    }

    #[track_caller]
    fn check(value: f64, decimals: usize, out: &mut Vec<u8>) {
        out.clear();
        write_fixed(out, value, decimals);
        let expected = expected(value, decimals);
        assert!(out == expected.as_bytes(), "{value:e} with {decimals}: {expected}");
    }

    /// A count of decimals below `most`.
    fn decimals(word: u64, most: u64) -> usize {
        usize::try_from(word % most).unwrap()
    }

    #[test]
    fn ten_million_numbers_are_written_as_the_standard_library_writes_them() {
        let mut out = Vec::new();
        for (word, more) in words(0).zip(words(1 << 40)).take(10_000_000) {
            // Sizes from 1e-16 to 1e10 with up to 13 decimals, as tables have them.
            let exponent = 1023 - 53 + more % 87;
            let value = f64::from_bits((word & !(0x7ff << 52)) | (exponent << 52));
            check(value, decimals(more >> 32, 14), &mut out);
        }
    }

    #[test]
    fn any_double_is_written_with_any_count_of_decimals() {
        let mut out = Vec::new();
        for (word, more) in words(1 << 41).zip(words(1 << 42)).take(200_000) {
            check(f64::from_bits(word), decimals(more, 40), &mut out);
        }
        for value in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN, f64::MAX, 5e-324, -0.0, 0.0] {
            (0..40).for_each(|decimals| check(value, decimals, &mut out));
        }
    }

    #[test]
    fn ties_go_to_the_even_digit() {
        let mut out = Vec::new();
        for decimals in 0..27_u8 {
            for (k, word) in (0..2000).zip(words(1 << 43)) {
                // An odd multiple of 2^−(d+1) lies halfway between two of 10^−d, where it is one.
                for odd in [2 * k + 1, 2 * (word >> 40) + 1] {
                    let tie = odd as f64 * 0.5_f64.powi(i32::from(decimals) + 1);
                    check(tie, decimals.into(), &mut out);
                    check(-tie, decimals.into(), &mut out);
                }
            }
        }
    }

    #[test]
    fn carries_run_through_all_digits() {
        let mut out = Vec::new();
        for decimals in 0..20_usize {
            for digits in 0..20 {
                let power = 10_f64.powi(digits - 10);
                for value in [power, power.next_down(), power.next_up(), power * 0.999_999_999_5] {
                    check(value, decimals, &mut out);
                    check(-value, decimals, &mut out);
                }
            }
        }
    }
}
