/// A number of this many significant digits, at least 1; those that arithmetic leaves behind in a
/// message are gone with twelve.
pub(crate) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_digits_of_arithmetic_are_gone() {
        for (value, digits, expected) in [
            (4.671_999_999_999_999, 12, "4.672"),
            (0.1 + 0.2, 12, "0.3"),
            (-0.553_210_7, 4, "-0.5532"),
            (1234.0, 2, "1200"),
            (0.0, 3, "0"),
            (f64::NAN, 3, "NaN"),
        ] {
            assert_eq!(rounded(value, digits).to_string(), expected);
        }
    }
}
