//! Values with their unit as text, such as `"5e4 N cm^2"`, and their conversion to SI.

mod known;

use thiserror::Error;

use crate::text::{excerpt, visible};
use known::{known, nearest, run_together};

pub use known::Dimension;
pub(crate) use known::{may_count_turns, quantity_pattern, reads_as_unit};

/// A unit, such as `N m^2` or `kg/m`: a factor to SI and a dimension.
///
/// Blanks, `*`, `·` or `⋅` separate factors; a power is written `^2`, `^-1`, `**2` or `²`; one `/` may precede the last
/// factor.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Unit {
    /// Factor without its power of ten, so that 135 cm is 1.35 m to the last bit.
    coefficient: f64,
    exponent: i32,
    dimension: Dimension,
}

impl Unit {
    /// Reads a unit.
    ///
    /// ```
    /// use flexlink::numeric::{Dimension, Unit};
    /// let unit = Unit::parse("N cm^2")?;
    /// assert_eq!(unit.dimension(), Dimension::BENDING_STIFFNESS);
    /// assert_eq!(unit.to_si(5e4), 5.0);
    /// # Ok::<(), flexlink::numeric::UnitError>(())
    /// ```
    ///
    /// # Errors
    /// [`UnitError`] for an unknown unit, more than one unit below the stroke, or no unit at all.
    pub fn parse(text: &str) -> Result<Self, UnitError> {
        let malformed = || UnitError::Malformed { unit: text.trim().into() };
        let plain = text.trim().replace("**", "^");
        let (above, below) = match plain.split_once('/') {
            Some((above, below)) => (above.trim(), Some(below.trim())),
            None => (plain.as_str(), None),
        };
        // A stroke may have nothing above it: `/s`.
        let above = if above.is_empty() && below.is_some() { vec![] } else { factors(above) };
        let mut powers: Vec<(&str, i8)> = above.into_iter().map(|factor| (factor, 1)).collect();
        if let Some(below) = below {
            let [factor] = factors(below)[..] else { return Err(UnitError::Ambiguous) };
            if below.contains('/') {
                return Err(UnitError::Ambiguous);
            }
            powers.push((factor, -1));
        }
        let mut unit = Self { coefficient: 1.0, exponent: 0, dimension: Dimension::NONE };
        for (factor, sign) in powers {
            let (word, power) = word_and_power(factor).ok_or_else(malformed)?;
            let found = known(word).ok_or_else(|| UnitError::UnknownUnit {
                unit: word.into(),
                nearest: nearest(word),
            })?;
            let power = power.checked_mul(sign).ok_or_else(malformed)?;
            unit.coefficient *= found.coefficient.powi(power.into());
            unit.exponent += found.exponent * i32::from(power);
            unit.dimension = unit.dimension.times(found.dimension, power).ok_or_else(malformed)?;
        }
        // The unit `um^60 m^-59` is a length, but its factor underflows.
        let is_in_range = unit.coefficient.is_normal() && unit.to_si(1.0).is_normal();
        if is_in_range { Ok(unit) } else { Err(malformed()) }
    }

    /// Converts `value` in this unit to SI.
    pub fn to_si(&self, value: f64) -> f64 {
        let product = if self.coefficient.to_bits() == 1.0_f64.to_bits() {
            value
        } else {
            value * self.coefficient
        };
        // Powers of ten up to 22 are exact, negative powers are not.
        let scale = 10.0_f64.powi(self.exponent.abs());
        if self.exponent < 0 { product / scale } else { product * scale }
    }

    /// Dimension of the unit.
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }
}

/// Factors of a product; an empty one where a sign of multiplication lacks a factor.
fn factors(product: &str) -> Vec<&str> {
    let mut found = Vec::new();
    for part in product.split(['*', '·', '⋅']) {
        let before = found.len();
        found.extend(part.split_whitespace());
        if found.len() == before {
            found.push("");
        }
    }
    found
}

/// Splits `cm^2` or `cm²` into word and power.
fn word_and_power(factor: &str) -> Option<(&str, i8)> {
    let end = factor.find(|c| c == '^' || superscript(c).is_some()).unwrap_or(factor.len());
    let (word, power) = factor.split_at(end);
    if word.is_empty() || !word.chars().all(char::is_alphanumeric) {
        return None;
    }
    let power = match power.strip_prefix('^') {
        _ if power.is_empty() => 1,
        Some(digits) => digits.parse().ok()?,
        None => {
            let digits: Option<String> = power.chars().map(superscript).collect();
            digits?.parse().ok()?
        }
    };
    Some((word, power))
}

/// The digit or sign of a superscript.
fn superscript(c: char) -> Option<char> {
    const RAISED: [char; 11] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹', '⁻'];
    let place = RAISED.iter().position(|raised| *raised == c)?;
    "0123456789-".chars().nth(place)
}

/// SI value of text such as `"150 cm"`, which must have the expected dimension.
///
/// ```
/// use flexlink::numeric::{Dimension, parse_quantity};
/// assert_eq!(parse_quantity("150 cm", Dimension::LENGTH), Ok(1.5));
/// assert!(parse_quantity("150 kg", Dimension::LENGTH).is_err());
/// ```
///
/// # Errors
/// [`UnitError`] for a wrong number, unit or dimension.
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
        if expected == Dimension::RATE && may_count_turns(unit) {
            return Err(UnitError::TurnsOrRadians { unit: unit.into() });
        }
        parsed.to_si(number)
    };
    if value.is_finite() { Ok(value) } else { Err(UnitError::NotFinite) }
}

/// Splits off the decimal number at the start of `text`. Returns `None` without a number or if the rest makes it
/// doubtful, as in `1,5` and `1_000`.
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

/// Error in a quantity or a unit.
///
/// Its text continues a sentence that names the input: `length = "1.5"` *has no unit, but must be a length such as m*.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum UnitError {
    /// The text does not begin with a decimal number.
    #[error("does not begin with a number such as 1.5 or 2e-3")]
    NotANumber,
    /// The number, or its value in SI, is too large.
    #[error("is too large, but must be finite")]
    NotFinite,
    /// A number without a unit where a dimension is expected.
    #[error("has no unit, but must be {}", wanted(*.expected))]
    NoUnit {
        /// Expected dimension.
        expected: Dimension,
    },
    /// A unit of another dimension.
    #[error("is {}, but must be {}", described(.unit, *.found), wanted(*.expected))]
    WrongDimension {
        /// The unit as written.
        unit: String,
        /// Dimension of the unit.
        found: Dimension,
        /// Expected dimension.
        expected: Dimension,
    },
    /// An unknown unit.
    #[error("has the unknown unit `{}`", visible(&excerpt(.unit)))]
    UnknownUnit {
        /// The word as written.
        unit: String,
        /// The known unit spelt most like it, if one is near.
        nearest: Option<&'static str>,
    },
    /// A rate that may count turns.
    #[error("is in {}, which may count turns or radians", visible(&excerpt(.unit)))]
    TurnsOrRadians {
        /// The unit as written.
        unit: String,
    },
    /// More than one unit may belong below the stroke.
    #[error("is ambiguous: only one unit may follow the only `/`")]
    Ambiguous,
    /// No unit, or signs in between that make no sense.
    #[error("has the malformed unit `{}`", visible(&excerpt(.unit)))]
    Malformed {
        /// The unit as written.
        unit: String,
    },
}

impl UnitError {
    /// Suggests a remedy.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::NoUnit { .. } => Some("a number without quotes is in SI units".into()),
            Self::UnknownUnit { unit, nearest } => {
                if let Some([first, second]) = run_together(unit) {
                    return Some(format!("a blank separates units: `{first} {second}`"));
                }
                let bare = unit.trim_end_matches(|c: char| c.is_ascii_digit());
                match nearest {
                    Some(near) if *near == bare => {
                        let power = &unit[bare.len()..];
                        Some(format!("a power is written `{near}^{power}`"))
                    }
                    Some(near) => Some(format!("did you mean `{near}`?")),
                    None => None,
                }
            }
            Self::TurnsOrRadians { .. } => {
                Some("write rpm for turns a minute, or rad/s, deg/s or 1/s".into())
            }
            Self::Ambiguous => Some("use negative powers, as in `kg m^-1 s^-1`".into()),
            Self::Malformed { .. } => Some("units read like `N m^2`, `kg/m` or `1/s`".into()),
            Self::NotANumber => Some("a value with its unwrite it like \"1.5 m\"".into()),
            Self::NotFinite | Self::WrongDimension { .. } => None,
        }
    }
}

fn wanted(dimension: Dimension) -> String {
    let name = dimension.name().unwrap_or("of another dimension");
    match dimension.si_unit() {
        "" => name.into(),
        unit => format!("{name} such as {unit}"),
    }
}

fn described(unit: &str, dimension: Dimension) -> String {
    dimension.name().map_or_else(|| format!("measured in {}", visible(&excerpt(unit))), Into::into)
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
        assert_eq!(length("1 kg s").0, "is measured in kg s, but must be a length such as m");
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

    #[test]
    fn what_is_no_product_of_units_is_refused() {
        for text in [
            "",
            " ",
            "N m^",
            "N m^x",
            "N * * m",
            "N *",
            "^2",
            "(N m)",
            "m^999",
            "m^99 m^99",
            "1/",
            "/",
            "um^60 m^-59",
            "km^103 m^-102",
            "oz^30 kg^-29",
        ] {
            let error = Unit::parse(text).unwrap_err();
            assert!(matches!(error, UnitError::Malformed { .. }), "{text:?}");
        }
    }
}
