use thiserror::Error;

use super::Dimension;
use super::known::run_together;
use crate::numeric::{excerpt, visible};

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
