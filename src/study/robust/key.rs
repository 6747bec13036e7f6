//! A value of the link file that is known to an interval.

use serde::{Deserialize, Serialize};

use crate::text::significant;

/// Effect of a value on the link file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum How {
    /// It replaces the file's value, in this unit; empty for SI.
    Value(String),
    /// It multiplies the file's value.
    Factor,
    /// It delays the position that the drive plays, in s; the link file stays.
    Delay,
}

/// A value of the link file with the interval in which it is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Key {
    /// Dotted path of the value, as in `--set`.
    pub path: String,
    /// Effect of a value.
    pub how: How,
    /// The value of the file, 1 for a factor; `None` where the file has no single value.
    pub nominal: Option<f64>,
    /// Lower and upper end.
    pub ends: [f64; 2],
}

impl Key {
    /// Heading of its column: the path, `*` for a factor, and the unit in brackets.
    pub fn heading(&self) -> String {
        let (name, unit) = (self.name(), self.unit());
        if unit.is_empty() { name } else { format!("{name} [{unit}]") }
    }

    /// Its name in a text: the path, with `*` for a factor.
    pub fn name(&self) -> String {
        let star = if self.how == How::Factor { "*" } else { "" };
        format!("{}{star}", self.path)
    }

    /// Unit of its values; empty for a factor and in SI.
    pub fn unit(&self) -> &str {
        match &self.how {
            How::Factor => "",
            How::Delay => "s",
            How::Value(unit) => unit,
        }
    }

    /// A value in its unit: `0.02000 kg`.
    pub fn amount(&self, value: f64) -> String {
        format!("{} {}", significant(value, 4), self.unit()).trim_end().to_owned()
    }

    /// The change of the link file to a value, in the form of `--set`; `None` for a delay.
    pub fn change(&self, value: f64) -> Option<String> {
        let path = &self.path;
        match &self.how {
            How::Factor => Some(format!("{path}*={value:?}")),
            How::Delay => None,
            How::Value(unit) => Some(format!("{path}={value:?} {unit}").trim_end().to_owned()),
        }
    }

    /// A value between the ends, at a share from the lower one.
    pub(super) fn at(&self, share: f64) -> f64 {
        let [low, high] = self.ends;
        if share >= 1.0 { high } else { low + share * (high - low) }
    }
}

/// Keys that a fit found together: their factors are normal in the logarithm, with these correlations; with few degrees
/// of freedom they follow Student's distribution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fitted {
    /// Number of the first of these keys; they follow one another.
    pub first: usize,
    /// Standard error of the logarithm of each factor.
    pub standard_errors: Vec<f64>,
    /// Lower triangle L of the correlations, `L Lᵀ`, row by row.
    pub lower: Vec<Vec<f64>>,
    /// Degrees of freedom of the standard errors; `None` where they are known.
    pub degrees_of_freedom: Option<usize>,
}

impl Fitted {
    /// Correlations as `L Lᵀ`; `None` if they are not positive definite.
    pub fn lower_of(correlation: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
        let mut lower: Vec<Vec<f64>> = Vec::new();
        for (i, row) in correlation.iter().enumerate() {
            let mut own = vec![0.0; correlation.len()];
            for j in 0..=i {
                let known = |k: usize| own[k] * if j == i { own[k] } else { lower[j][k] };
                let rest = row[j] - (0..j).map(known).sum::<f64>();
                own[j] = if j < i { rest / lower[j][j] } else { rest.sqrt() };
            }
            // The root of a negative number is NaN, and not positive either.
            lower.push(Some(own).filter(|own| own[i] > 0.0)?);
        }
        Some(lower)
    }
}
