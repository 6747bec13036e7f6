//! Damping of the link's material.

use std::fmt::Debug;

use serde::{Deserialize, Deserializer, Serialize};

use super::parts::{ParameterError, not_negative};

/// Damping law of the link, without its joint (Bayo 1987, eqs 12, 15 and 16).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(tag = "model", rename_all = "lowercase", deny_unknown_fields)]
pub enum Damping {
    /// An undamped link.
    #[default]
    #[serde(deserialize_with = "no_more_keys")]
    None,
    /// Complex stiffness K(1 + 2iξ) (eq 16), the paper's law.
    Hysteretic {
        /// Material damping ratio ξ, in [0, 1).
        ratio: f64,
    },
    /// C = αM + βK for every mass and every stiffness.
    Rayleigh {
        /// α in 1/s, at least 0.
        alpha_per_s: f64,
        /// β in s, at least 0.
        beta_s: f64,
    },
    /// C = αM + βK with α and β such that two flexible modes get these ratios.
    #[serde(rename = "rayleigh through modes")]
    RayleighThroughModes {
        /// Numbers of the two flexible modes, from 1, ascending.
        modes: [usize; 2],
        /// Viscous ratio of each, in [0, 1).
        ratios: [f64; 2],
    },
    /// A viscous ratio ζ for each flexible mode, 2ζωq̇ in modal coordinates; rigid motion is free.
    Modal {
        /// ζ of each flexible mode from the first, in [0, 1), at least one; the last holds for all
        /// higher modes.
        ratios: Vec<f64>,
    },
    /// Caughey series through the ratios of these modes (Bayo 1987, eq 12); rigid motion is free:
    ///
    /// ```text
    /// ζ(ω) = ½ Σ_b a_b ω^(2b − 1),  b = 0 … p − 1,  ζ(ω_mode) = ratio for each of the p modes
    /// ```
    Caughey {
        /// Numbers of 1 to 8 flexible modes, from 1, strictly ascending.
        modes: Vec<usize>,
        /// Viscous ratio of each, in [0, 1).
        ratios: Vec<f64>,
    },
}

/// Reads a law without numbers. A plain unit variant would accept any further key.
fn no_more_keys<'de, D: Deserializer<'de>>(deserializer: D) -> Result<(), D::Error> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct NoKeys {}
    NoKeys::deserialize(deserializer).map(|NoKeys {}| ())
}

impl Damping {
    /// Largest number of terms of a Caughey series: the last power, ω¹³, spans twenty decades over the first eight
    /// modes of a beam.
    const MOST_TERMS: usize = 8;

    /// Name of the law in a link file.
    pub fn name(&self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Hysteretic { .. } => "hysteretic",
            Self::Rayleigh { .. } | Self::RayleighThroughModes { .. } => "rayleigh",
            Self::Modal { .. } => "modal",
            Self::Caughey { .. } => "caughey",
        }
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        match self {
            Self::None => Ok(()),
            Self::Hysteretic { ratio } => in_unit_interval("damping.ratio", *ratio),
            Self::Rayleigh { alpha_per_s, beta_s } => {
                not_negative("damping.alpha", *alpha_per_s, "1/s")?;
                not_negative("damping.beta", *beta_s, "s")
            }
            Self::RayleighThroughModes { modes, ratios } => {
                let must = "must be two flexible modes, numbered from 1, the lower first";
                ascending(modes, must)?;
                all_in_unit_interval(ratios)
            }
            Self::Modal { ratios } if ratios.is_empty() => {
                Err(refused("damping.ratios", ratios, "must hold at least one number"))
            }
            Self::Modal { ratios } => all_in_unit_interval(ratios),
            Self::Caughey { modes, ratios } => check_series(modes, ratios),
        }
    }
}

fn check_series(modes: &[usize], ratios: &[f64]) -> Result<(), ParameterError> {
    let most = Damping::MOST_TERMS;
    if !(1..=most).contains(&ratios.len()) {
        let must = format!("must hold 1 to {most} numbers for a Caughey series");
        return Err(refused("damping.ratios", ratios, must));
    }
    if modes.len() != ratios.len() {
        let must = format!("must be as many as damping.ratios, {}", ratios.len());
        return Err(refused("damping.modes", modes, must));
    }
    ascending(modes, "must be flexible modes, numbered from 1, in ascending order")?;
    all_in_unit_interval(ratios)
}

/// Refuses mode numbers that do not ascend from 1 or above.
fn ascending(modes: &[usize], must: &str) -> Result<(), ParameterError> {
    if modes.first() != Some(&0) && modes.is_sorted_by(|lower, higher| lower < higher) {
        Ok(())
    } else {
        Err(refused("damping.modes", modes, must))
    }
}

fn all_in_unit_interval(ratios: &[f64]) -> Result<(), ParameterError> {
    ratios.iter().try_for_each(|&ratio| in_unit_interval("damping.ratios", ratio))
}

/// Refuses a damping ratio outside [0, 1).
pub(crate) fn in_unit_interval(parameter: &str, ratio: f64) -> Result<(), ParameterError> {
    if (0.0..1.0).contains(&ratio) {
        Ok(())
    } else {
        Err(ParameterError::new(parameter, ratio, "", "must lie in [0, 1)"))
    }
}

fn refused<T: Debug>(parameter: &str, list: &[T], must: impl Into<String>) -> ParameterError {
    ParameterError::new(parameter, format!("{list:?}"), "", must)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(law: &Damping) -> String {
        law.check().unwrap_err().to_string()
    }

    #[test]
    fn a_stored_law_is_read_back_and_another_key_is_refused() {
        let modal = Damping::Modal { ratios: vec![0.1] };
        let series = Damping::Caughey { modes: vec![2], ratios: vec![0.1] };
        let two = Damping::RayleighThroughModes { modes: [1, 2], ratios: [0.1; 2] };
        let rayleigh = Damping::Rayleigh { alpha_per_s: 0.1, beta_s: 0.0 };
        let hysteretic = Damping::Hysteretic { ratio: 0.1 };
        for law in [Damping::None, hysteretic, rayleigh, two, modal, series] {
            let stored = serde_json::to_string(&law).unwrap();
            assert_eq!(serde_json::from_str::<Damping>(&stored).unwrap(), law);
            let further = stored.replace('}', r#","more":1}"#);
            assert!(serde_json::from_str::<Damping>(&further).is_err(), "{further}");
        }
    }

    #[test]
    fn a_ratio_outside_zero_to_one_is_refused_with_its_value() {
        let error = Damping::Hysteretic { ratio: -0.02 }.check().unwrap_err();
        assert_eq!(error.to_string(), "damping.ratio = -0.02, but must lie in [0, 1)");
        assert!(Damping::Hysteretic { ratio: 1.0 }.check().is_err());
        assert!(Damping::Hysteretic { ratio: f64::NAN }.check().is_err());
        assert!(Damping::Hysteretic { ratio: 0.0 }.check().is_ok());
    }

    #[test]
    fn rayleigh_modes_must_ascend_from_one() {
        for modes in [[0, 1], [2, 2], [3, 1]] {
            let law = Damping::RayleighThroughModes { modes, ratios: [0.01, 0.02] };
            assert_eq!(law.check().unwrap_err().parameter, "damping.modes");
        }
    }

    #[test]
    fn modal_damping_needs_a_ratio_and_each_in_its_range() {
        let modal = |ratios: &[f64]| Damping::Modal { ratios: ratios.to_vec() };
        assert_eq!(modal(&[0.0, 0.02]).check(), Ok(()));
        assert_eq!(refusal(&modal(&[])), "damping.ratios = [], but must hold at least one number");
        for ratio in [-0.01, 1.0, f64::NAN] {
            assert_eq!(
                refusal(&modal(&[0.02, ratio])),
                format!("damping.ratios = {ratio}, but must lie in [0, 1)")
            );
        }
    }

    #[test]
    fn a_caughey_series_goes_through_one_to_eight_ascending_modes() {
        let caughey = |modes: &[usize], ratios: &[f64]| Damping::Caughey {
            modes: modes.to_vec(),
            ratios: ratios.to_vec(),
        };
        assert_eq!(caughey(&[3], &[0.02]).check(), Ok(()));
        assert_eq!(caughey(&[1, 2, 3, 4, 5, 6, 7, 9], &[0.02; 8]).check(), Ok(()));
        let ascending = "must be flexible modes, numbered from 1, in ascending order";
        for (modes, ratios, expected) in [
            (&[][..], &[][..], "ratios = [], but must hold 1 to 8 numbers for a Caughey series"),
            (&[1, 2], &[0.1], "modes = [1, 2], but must be as many as damping.ratios, 1"),
            (&[0, 1], &[0.1; 2], &format!("modes = [0, 1], but {ascending}")),
            (&[1, 3, 3], &[0.1; 3], &format!("modes = [1, 3, 3], but {ascending}")),
            (&[1, 2], &[0.1, 1.5], "ratios = 1.5, but must lie in [0, 1)"),
        ] {
            assert_eq!(refusal(&caughey(modes, ratios)), format!("damping.{expected}"));
        }
        assert!(caughey(&[1, 2, 3, 4, 5, 6, 7, 8, 9], &[0.02; 9]).check().is_err());
    }
}
