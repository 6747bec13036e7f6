/// A number with `digits` significant digits, for people; scientific below 0.001 and from a million
/// on.
///
/// ```
/// use flexlink::numeric::significant;
/// assert_eq!(significant(0.526_425_1, 4), "0.5264");
/// assert_eq!(significant(1.5e-4, 2), "1.5e-4");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    let after_first = digits - 1;
    let scientific = format!("{value:.after_first$e}");
    let exponent = scientific.split_once('e').and_then(|(_, e)| e.parse::<isize>().ok());
    match exponent {
        Some(exponent) if (-3..6).contains(&exponent) => {
            let decimals = after_first.saturating_add_signed(-exponent);
            format!("{value:.decimals$}")
        }
        _ => scientific,
    }
}

/// A number with all its digits, for people: as it was given, but one far from 1 in powers of ten.
///
/// ```
/// use flexlink::numeric::plain;
/// assert_eq!([2.0, 0.25, 1e300].map(plain), ["2", "0.25", "1e300"]);
/// ```
pub fn plain(value: f64) -> String {
    let is_near = value == 0.0 || !value.is_finite() || (1e-5..1e16).contains(&value.abs());
    if is_near { value.to_string() } else { format!("{value:e}") }
}

/// Memory in GB, for people; in MB where it is less than a tenth of that.
///
/// ```
/// use flexlink::numeric::gigabytes;
/// assert_eq!(gigabytes(1_530_000_000), "1.5 GB");
/// assert_eq!(gigabytes(24_300_000), "24 MB");
/// ```
pub fn gigabytes(bytes: usize) -> String {
    if bytes < 100_000_000 {
        return format!("{} MB", significant(bytes as f64 / 1e6, 2));
    }
    format!("{} GB", significant(bytes as f64 / 1e9, 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_significant_and_extremes_are_scientific() {
        assert_eq!(significant(181.588, 4), "181.6");
        assert_eq!(significant(123_456.7, 3), "123457");
        assert_eq!(significant(9.9996, 4), "10.00");
        assert_eq!(significant(1.5e7, 2), "1.5e7");
        assert_eq!(significant(0.0, 3), "0.00");
    }
}
