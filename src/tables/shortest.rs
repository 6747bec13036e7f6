//! Numbers as the shortest text that reads back to the same number, as the standard library writes
//! them and several times faster.

use std::fmt::Arguments;
use std::io::Write as _;
use std::ops::Range;

/// Digits up to which no two texts read back to the same number.
const DISTINCT_DIGITS: usize = 15;

/// 2²⁵: what is no multiple of its reciprocal has more than 18 significant digits.
const MOST_HALVINGS: f64 = 33_554_432.0;

/// Sizes that are written without an exponent.
const PLAIN: Range<f64> = 1e-5..1e17;

/// Decimal exponent that is written out here: where the digits come in scientific notation, but
/// the text is still to be plain.
const LAST_PLAIN: i32 = 16;

/// Appends the shortest text of `value`; plain from 1e-5 up to below 1e17, else with an exponent. A
/// zero has no sign.
pub(super) fn write_shortest(out: &mut Vec<u8>, value: f64) {
    if value == 0.0 {
        return out.push(b'0');
    }
    let mut room = zmij::Buffer::new();
    let text = room.format(value);
    if text.len() > DISTINCT_DIGITS && may_be_tied(value) {
        return write_tied(out, value);
    }
    let Some((digits, exponent)) = text.split_once('e') else {
        return out.extend_from_slice(whole(text).as_bytes());
    };
    let exponent = exponent.parse().unwrap_or(0);
    if exponent == LAST_PLAIN {
        return write_whole(out, digits);
    }
    out.extend_from_slice(whole(digits).as_bytes());
    append(out, format_args!("e{exponent}"));
}

/// Whether a number may stand midway between two texts of at most 17 digits that both read back to it:
/// the standard library takes the larger of them, `zmij` the even one.
///
/// Its own digits are one more then, 18 at most, and the last is a 5: it is n/2ʲ with an odd n and
/// n·5ʲ below 10¹⁸, so that j is at most 25.
fn may_be_tied(value: f64) -> bool {
    (value * MOST_HALVINGS).fract() == 0.0
}

fn write_tied(out: &mut Vec<u8>, value: f64) {
    if PLAIN.contains(&value.abs()) {
        append(out, format_args!("{value}"));
    } else {
        append(out, format_args!("{value:e}"));
    }
}

fn append(out: &mut Vec<u8>, text: Arguments) {
    let written = out.write_fmt(text);
    debug_assert!(written.is_ok(), "memory takes every number");
}

/// A whole number without its decimal.
fn whole(digits: &str) -> &str {
    digits.strip_suffix(".0").unwrap_or(digits)
}

/// Appends `digits · 10^LAST_PLAIN`.
fn write_whole(out: &mut Vec<u8>, digits: &str) {
    let (sign, size) = digits.strip_prefix('-').map_or(("", digits), |size| ("-", size));
    let (one, decimals) = size.split_once('.').unwrap_or((size, ""));
    for part in [sign, one, decimals] {
        out.extend_from_slice(part.as_bytes());
    }
    out.extend((decimals.len()..LAST_PLAIN as usize).map(|_| b'0'));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::fixed::words;

    /// As the standard library has it.
    fn expected(value: f64, out: &mut Vec<u8>) {
        match value.abs() {
            0.0 => out.push(b'0'),
            1e-5..1e17 => write!(out, "{value}").unwrap(),
            _ => write!(out, "{value:e}").unwrap(),
        }
    }

    #[track_caller]
    fn check(values: impl Iterator<Item = f64>) {
        let (mut found, mut text) = (vec![], vec![]);
        for value in values.flat_map(|value| [value, -value]) {
            found.clear();
            text.clear();
            write_shortest(&mut found, value);
            expected(value, &mut text);
            if found != text {
                let [found, text] = [found, text].map(|text| String::from_utf8(text).unwrap());
                panic!("{found} for {text}");
            }
        }
    }

    #[test]
    fn ten_million_numbers_are_written_as_the_standard_library_writes_them() {
        let words = |part: u64| words(part << 40).take(2_500_000);
        check(words(11).map(f64::from_bits));
        // Sizes about which the layout changes: 2⁻³² to 2⁶⁴.
        check(words(12).zip(words(13)).map(|(word, more)| {
            f64::from_bits((word & !(0x7ff << 52)) | ((1023 - 32 + more % 96) << 52))
        }));
    }

    #[test]
    fn numbers_of_few_digits_are_written_as_the_standard_library_writes_them() {
        let powers = || (-345..310).map(|power| format!("1e{power}").parse::<f64>().unwrap());
        check((1..1000).flat_map(|k| powers().map(move |power| f64::from(k) * power)));
        check((1..500).map(|k| f64::from(k) / 1000.0));
    }

    #[test]
    fn numbers_at_the_edges_are_written_as_the_standard_library_writes_them() {
        let around = |value: f64| [value.next_down(), value, value.next_up()];
        let powers = || (-345..310).map(|power| format!("1e{power}").parse::<f64>().unwrap());
        check(powers().flat_map(around));
        check((-1074..1024).map(|power| 2_f64.powi(power)).flat_map(around));
        check(words(14 << 40).take(200_000).map(|word| f64::from_bits(word >> 12)));
        check(words(15 << 40).take(200_000).map(|word| (word >> (word % 64)) as f64));
        check((0..200_000).map(f64::from));
        // Few halves, quarters, …: those that stand midway between two texts are among them.
        check(
            words(16 << 40).take(2_000_000).map(|word| {
                (word >> (11 + word % 40)) as f64 * 0.5_f64.powi((word / 64 % 32) as i32)
            }),
        );
        check([f64::NAN, f64::INFINITY, f64::MAX, f64::MIN_POSITIVE, 0.0].into_iter());
    }
}
