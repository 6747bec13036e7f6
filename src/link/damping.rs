use super::error::{ParameterError, not_negative};

/// The link's own damping law (Bayo 1987, eqs 12, 15 and 16).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// An undamped link.
    None,
    /// Complex stiffness K(1 + 2iξ) (eq 16), the paper's law.
    Hysteretic {
        /// Material damping ratio ξ, in [0, 1).
        ratio: f64,
    },
    /// C = αM + βK on every mass and every stiffness.
    Rayleigh {
        /// α in 1/s, at least 0.
        alpha_per_s: f64,
        /// β in s, at least 0.
        beta_s: f64,
    },
    /// C = αM + βK with α and β such that two flexible modes get the given ratios.
    RayleighThroughModes {
        /// Numbers of the two flexible modes, from 1, ascending.
        modes: [usize; 2],
        /// Viscous ratio of each, in [0, 1).
        ratios: [f64; 2],
    },
}

impl Damping {
    /// The law's name, as the link file spells it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Hysteretic { .. } => "hysteretic",
            Self::Rayleigh { .. } | Self::RayleighThroughModes { .. } => "rayleigh",
        }
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        match *self {
            Self::None => Ok(()),
            Self::Hysteretic { ratio } => in_unit_interval("damping.ratio", ratio),
            Self::Rayleigh { alpha_per_s, beta_s } => {
                not_negative("damping.alpha", alpha_per_s, "1/s")?;
                not_negative("damping.beta", beta_s, "s")
            }
            Self::RayleighThroughModes { modes, ratios } => {
                if modes[0] == 0 || modes[0] >= modes[1] {
                    return Err(ParameterError::new(
                        "damping.modes",
                        format!("[{}, {}]", modes[0], modes[1]),
                        "",
                        "must be two flexible modes, numbered from 1, the lower first",
                    ));
                }
                ratios.iter().try_for_each(|&ratio| in_unit_interval("damping.ratios", ratio))
            }
        }
    }
}

fn in_unit_interval(parameter: &str, ratio: f64) -> Result<(), ParameterError> {
    if (0.0..1.0).contains(&ratio) {
        Ok(())
    } else {
        Err(ParameterError::new(parameter, ratio, "", "must lie in [0, 1)"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
