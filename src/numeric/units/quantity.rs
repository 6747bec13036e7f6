use super::{Dimension, Unit, UnitError};

/// The SI value of text such as `"150 cm"`, which must measure what is expected.
///
/// ```
/// use flexlink::numeric::{Dimension, parse_quantity};
/// assert_eq!(parse_quantity("150 cm", Dimension::LENGTH), Ok(1.5));
/// assert!(parse_quantity("150 kg", Dimension::LENGTH).is_err());
/// ```
///
/// # Errors
/// [`UnitError`] says what is wrong with the number, its unit or its dimension.
pub fn parse_quantity(text: &str, expected: Dimension) -> Result<f64, UnitError> {
    let (number, unit) = split_number(text).ok_or(UnitError::NotANumber)?;
    let unit = unit.trim();
    let value = if unit.is_empty() {
        if expected != Dimension::NONE {
            return Err(UnitError::NoUnit { expected });
        }
        number
    } else {
        let parsed = Unit::parse(unit)?;
        if parsed.dimension() != expected {
            return Err(UnitError::WrongDimension {
                unit: unit.into(),
                found: parsed.dimension(),
                expected,
            });
        }
        parsed.to_si(number)
    };
    if value.is_finite() { Ok(value) } else { Err(UnitError::NotFinite) }
}

/// The decimal number that `text` begins with, and the rest; `None` where there is no number or
/// it goes on in a way that leaves doubt, as in `1,5` and `1_000`.
pub(crate) fn split_number(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let digits = |from: usize| {
        let tail = text[from..].bytes();
        from + tail.take_while(u8::is_ascii_digit).count()
    };
    let mut end = digits(usize::from(text.starts_with(['+', '-'])));
    if text[end..].starts_with('.') {
        end = digits(end + 1);
    }
    let mut exponent = text[end..].chars();
    if matches!(exponent.next(), Some('e' | 'E')) {
        let sign = usize::from(matches!(exponent.next(), Some('+' | '-')));
        let after = digits(end + 1 + sign);
        if after > end + 1 + sign {
            end = after;
        }
    }
    let (number, rest) = text.split_at(end);
    if rest.starts_with([',', '_', '.', '\'']) {
        return None;
    }
    Some((number.parse().ok()?, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str, expected: Dimension) -> (String, Option<String>) {
        let error = parse_quantity(text, expected).unwrap_err();
        (error.to_string(), error.hint())
    }

    #[test]
    fn decimal_factors_cost_no_digit() {
        let cases = [
            ("150 cm", Dimension::LENGTH, 1.5),
            ("135cm", Dimension::LENGTH, 1.35),
            ("-15e-1 mm", Dimension::LENGTH, -0.0015),
            ("5e4 N cm^2", Dimension::BENDING_STIFFNESS, 5.0),
            ("5e4 N*cm**2", Dimension::BENDING_STIFFNESS, 5.0),
            ("5e4 N·cm²", Dimension::BENDING_STIFFNESS, 5.0),
            ("5e4 N ⋅ cm²", Dimension::BENDING_STIFFNESS, 5.0),
            ("1000 kg cm^2", Dimension::ROTARY_INERTIA, 0.1),
            ("2e7 N/cm^2", Dimension::PRESSURE, 2e11),
            ("2e7 N cm⁻²", Dimension::PRESSURE, 2e11),
            ("0.25e-2 cm^4", Dimension::SECOND_MOMENT, 2.5e-11),
            ("0.008 kg/cm^3", Dimension::DENSITY, 8000.0),
            ("1 cm^2", Dimension::AREA, 1e-4),
            ("0.8 g/mm", Dimension::MASS_PER_LENGTH, 0.8),
            ("0.015 N m s/rad", Dimension::VISCOUS_FRICTION, 0.015),
            ("2 1/s", Dimension::RATE, 2.0),
            ("2 /s", Dimension::RATE, 2.0),
            ("180 deg", Dimension::NONE, std::f64::consts::PI),
            ("0.5", Dimension::NONE, 0.5),
        ];
        for (text, dimension, expected) in cases {
            let found = parse_quantity(text, dimension);
            assert_eq!(found, Ok(expected), "{text}");
        }
    }

    #[test]
    fn products_of_inch_pound_units_are_right_to_round_off() {
        let cases = [
            (
                "28.6 lbf ft^2",
                Dimension::BENDING_STIFFNESS,
                28.6 * 4.448_221_615_260_5 * 0.3048 * 0.3048,
            ),
            ("12 oz in^2", Dimension::ROTARY_INERTIA, 12.0 * 0.028_349_523_125 * 0.0254 * 0.0254),
            ("1e4 ksi", Dimension::PRESSURE, 6.894_757_293_168_361e10),
        ];
        for (text, dimension, expected) in cases {
            let found = parse_quantity(text, dimension).unwrap();
            assert!((found / expected - 1.0).abs() < 1e-15, "{text}");
        }
    }

    #[test]
    fn a_wrong_or_missing_unit_is_refused_with_what_is_meant() {
        let length = |text| refusal(text, Dimension::LENGTH);
        assert_eq!(
            length("1.5"),
            (
                "has no unit, but must be a length such as m".into(),
                Some("a number without quotes is in SI units".into())
            )
        );
        assert_eq!(length("150 kg").0, "is a mass, but must be a length such as m");
        assert_eq!(length("1 kg m").0, "is measured in kg m, but must be a length such as m");
        assert_eq!(
            length("150 cn"),
            ("has the unknown unit `cn`".into(), Some("did you mean `cm`?".into()))
        );
        assert_eq!(length("1 mm2").1.unwrap(), "a power is written `mm^2`");
        assert_eq!(length("1 xyzzy").1, None);
    }

    #[test]
    fn two_units_below_the_stroke_are_ambiguous() {
        for text in ["1 kg/m s", "1 J/kg/K", "1 kg/m*s"] {
            let error = parse_quantity(text, Dimension::DENSITY).unwrap_err();
            assert_eq!(error, UnitError::Ambiguous, "{text}");
        }
    }

    #[test]
    fn what_is_no_finite_decimal_number_is_refused() {
        for text in
            ["", "abc", "nan m", "inf m", "-inf m", "1,5 m", "1_000 m", "e5 m", ". m", "- m"]
        {
            let error = parse_quantity(text, Dimension::LENGTH).unwrap_err();
            assert_eq!(error, UnitError::NotANumber, "{text}");
        }
        for text in ["1e999 m", "1e308 km"] {
            let error = parse_quantity(text, Dimension::LENGTH).unwrap_err();
            assert_eq!(error, UnitError::NotFinite, "{text}");
        }
    }
}
