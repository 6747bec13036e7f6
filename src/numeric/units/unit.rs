use thiserror::Error;

use super::Dimension;
use super::known::{KnownUnit, known, nearest, run_together};
use crate::numeric::{excerpt, visible};

/// A unit, such as `N m^2` or `kg/m`: a factor to SI and a dimension.
///
/// Factors are separated by blanks, `*`, `·` or `⋅`; a power is written `^2`, `^-1`, `**2` or
/// `²`; one `/` may stand before the last factor.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Unit {
    /// Kept apart from the power of ten, so that 135 cm is 1.35 m to the last bit.
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
        let text = text.trim().replace("**", "^");
        let (above, below) = match text.split_once('/') {
            Some((above, below)) => (above.trim(), Some(below.trim())),
            None => (text.as_str(), None),
        };
        let mut unit = Self::ONE;
        if !above.is_empty() || below.is_none() {
            for factor in factors(above) {
                unit = unit.times(factor, 1).ok_or_else(malformed)??;
            }
        }
        if let Some(below) = below {
            let mut rest = factors(below).into_iter();
            let factor = rest.next().unwrap_or_default();
            if rest.next().is_some() || below.contains('/') {
                return Err(UnitError::Ambiguous);
            }
            unit = unit.times(factor, -1).ok_or_else(malformed)??;
        }
        if unit.is_in_range() { Ok(unit) } else { Err(malformed()) }
    }

    /// Whether its factor is a number: that of `um^60 m^-59`, a length, is not.
    fn is_in_range(&self) -> bool {
        self.coefficient.is_normal() && self.to_si(1.0).is_normal()
    }

    /// The value in SI of `value` in this unit.
    pub fn to_si(&self, value: f64) -> f64 {
        let product = if self.coefficient.to_bits() == 1.0_f64.to_bits() {
            value
        } else {
            value * self.coefficient
        };
        // Powers of ten up to 22 are exact, those of negative exponent never are.
        let scale = 10.0_f64.powi(self.exponent.abs());
        if self.exponent < 0 { product / scale } else { product * scale }
    }

    /// What the unit measures.
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }

    const ONE: Self = Self { coefficient: 1.0, exponent: 0, dimension: Dimension::NONE };

    /// This unit times `factor`, such as `cm^2`, to the power `sign`; `None` where `factor` is
    /// no word with a power.
    fn times(self, factor: &str, sign: i8) -> Option<Result<Self, UnitError>> {
        let (word, power) = word_and_power(factor)?;
        let Some(unit) = known(word) else {
            return Some(Err(UnitError::UnknownUnit { unit: word.into(), nearest: nearest(word) }));
        };
        self.times_known(unit, power.checked_mul(sign)?).map(Ok)
    }

    fn times_known(self, unit: &KnownUnit, power: i8) -> Option<Self> {
        Some(Self {
            coefficient: self.coefficient * unit.coefficient.powi(i32::from(power)),
            exponent: self.exponent + unit.exponent * i32::from(power),
            dimension: self.dimension.plus(unit.dimension.power(power)?)?,
        })
    }
}

/// The factors of a product; an empty one where a sign of multiplication has no factor.
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

/// Takes `cm^2` or `cm²` apart.
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

/// The digit or sign that is written raised.
fn superscript(c: char) -> Option<char> {
    const RAISED: [char; 11] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹', '⁻'];
    let place = RAISED.iter().position(|raised| *raised == c)?;
    "0123456789-".chars().nth(place)
}

/// Text that is no value with a unit, or no unit.
///
/// The text reads on from what was found: `length = "1.5"` *has no unit, but must be a length
/// such as m*.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum UnitError {
    /// It does not begin with a decimal number.
    #[error("does not begin with a decimal number")]
    NotANumber,
    /// The number, or its value in SI, is too large.
    #[error("is too large, but must be finite")]
    NotFinite,
    /// A number without a unit where a dimension is expected.
    #[error("has no unit, but must be {}", wanted(*.expected))]
    NoUnit {
        /// What is expected.
        expected: Dimension,
    },
    /// The unit measures something else.
    #[error("is {}, but must be {}", described(.unit, *.found), wanted(*.expected))]
    WrongDimension {
        /// The unit, as it was found.
        unit: String,
        /// What it measures.
        found: Dimension,
        /// What is expected.
        expected: Dimension,
    },
    /// A word that is no unit.
    #[error("has the unknown unit `{}`", visible(&excerpt(.unit)))]
    UnknownUnit {
        /// The word, as it was found.
        unit: String,
        /// The known unit that is spelt most like it, if one is.
        nearest: Option<&'static str>,
    },
    /// More than one unit may belong below the stroke.
    #[error("is ambiguous: only one unit may follow the only `/`")]
    Ambiguous,
    /// No unit at all, or signs in between that make no sense.
    #[error("has the malformed unit `{}`", visible(&excerpt(.unit)))]
    Malformed {
        /// The unit, as it was found.
        unit: String,
    },
}

impl UnitError {
    /// What to write instead.
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
            Self::Ambiguous => Some("use negative powers, as in `kg m^-1 s^-1`".into()),
            Self::Malformed { .. } => Some("units read like `N m^2`, `kg/m` or `1/s`".into()),
            Self::NotANumber => Some("a value with its unit reads like \"1.5 m\"".into()),
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
