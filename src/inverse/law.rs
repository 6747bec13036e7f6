use num_complex::Complex64;

use super::error::InversionError;
use crate::beam::Mesh;
use crate::link::Damping;
use crate::modal::natural_frequencies;

/// A damping law as the recursion takes it: at one frequency all laws here are one complex number.
///
/// Stiffness K κ(ω) and mass M (1 + α/(iω)) act together only through
///
/// ```text
/// λ = ω² (1 + α/(iω)) / κ = (ω² − iωα)/κ
/// κ = 1 + 2iξ  (hysteretic, Bayo 1987, eq 16)      κ = 1 + iωβ  (Rayleigh)
/// ```
///
/// and the torque answers to the acceleration that the mass feels, â + αv̂.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DampingLaw {
    /// κ = 1 + 2iξ; ξ = 0 is the undamped link.
    Hysteretic {
        /// ξ.
        ratio: f64,
    },
    /// κ = 1 + iωβ, and α on every mass.
    Rayleigh {
        /// α in 1/s.
        alpha_per_s: f64,
        /// β in s.
        beta_s: f64,
    },
}

impl DampingLaw {
    /// The law of a link; ratios given for modes become α and β with the modes of `mesh`.
    ///
    /// # Errors
    /// Modes that the mesh does not have, ratios that would need a negative α or β, or a law of
    /// modes, which is no complex number at all.
    pub fn of(damping: &Damping, mesh: &Mesh) -> Result<Self, InversionError> {
        match *damping {
            Damping::None => Ok(Self::Hysteretic { ratio: 0.0 }),
            Damping::Hysteretic { ratio } => Ok(Self::Hysteretic { ratio }),
            Damping::Rayleigh { alpha_per_s, beta_s } => Ok(Self::Rayleigh { alpha_per_s, beta_s }),
            Damping::RayleighThroughModes { modes, ratios } => through_modes(modes, ratios, mesh),
            Damping::Modal { .. } | Damping::Caughey { .. } => {
                Err(InversionError::LawOfModes { model: damping.name() })
            }
        }
    }

    /// Relative complex stiffness κ at ω ≥ 0.
    pub fn stiffness_factor(&self, omega_rad_s: f64) -> Complex64 {
        match *self {
            Self::Hysteretic { ratio } => Complex64::new(1.0, 2.0 * ratio),
            Self::Rayleigh { beta_s, .. } => Complex64::new(1.0, omega_rad_s * beta_s),
        }
    }

    /// α in 1/s: the rate at which the law drags every mass.
    pub fn mass_rate_per_s(&self) -> f64 {
        match *self {
            Self::Hysteretic { .. } => 0.0,
            Self::Rayleigh { alpha_per_s, .. } => alpha_per_s,
        }
    }

    /// λ at ω ≥ 0 in 1/s².
    pub fn lambda(&self, omega_rad_s: f64) -> Complex64 {
        let dragged = Complex64::new(omega_rad_s, -self.mass_rate_per_s()) * omega_rad_s;
        dragged / self.stiffness_factor(omega_rad_s)
    }

    /// Damping ratio that a mode of natural frequency ω gets: ξ, or α/(2ω) + βω/2.
    pub fn modal_ratio(&self, omega_rad_s: f64) -> f64 {
        match *self {
            Self::Hysteretic { ratio } => ratio,
            Self::Rayleigh { alpha_per_s, beta_s } => {
                0.5 * (alpha_per_s / omega_rad_s + beta_s * omega_rad_s)
            }
        }
    }
}

/// Solves α/(2ω) + βω/2 = ζ at two natural frequencies.
fn through_modes(
    modes: [usize; 2],
    ratios: [f64; 2],
    mesh: &Mesh,
) -> Result<DampingLaw, InversionError> {
    let frequencies = natural_frequencies(mesh, modes[1]);
    if frequencies.len() < modes[1] {
        return Err(InversionError::NoSuchMode { asked: modes[1], found: frequencies.len() });
    }
    let [low, high] = modes.map(|mode| frequencies[mode - 1]);
    let spread = (high - low) * (high + low);
    let beta_s = 2.0 * (ratios[1] * high - ratios[0] * low) / spread;
    let alpha_per_s = 2.0 * low * high * (ratios[0] * high - ratios[1] * low) / spread;
    if alpha_per_s < 0.0 || beta_s < 0.0 {
        return Err(InversionError::NegativeDamping { alpha_per_s, beta_s });
    }
    Ok(DampingLaw::Rayleigh { alpha_per_s, beta_s })
}
