//! Damping laws as functions of frequency and of the mode.

use num_complex::Complex64;
use thiserror::Error;

use super::basis::MOST_ELEMENTS_OF_ALL_MODES;
use super::frequencies::natural_frequencies;
use crate::beam::Mesh;
use crate::link::{Damping, Link};
use crate::numeric::Scalar;

/// A damping law with all its numbers.
///
/// The local laws are one complex number at each frequency: stiffness K κ(ω) and mass M (1 + α/(iω)) act only through
///
/// ```text
/// λ = ω² (1 + α/(iω)) / κ = (ω² − iωα)/κ
/// κ = 1 + 2iξ  (hysteretic, Bayo 1987, eq 16)      κ = 1 + iωβ  (Rayleigh)
/// ```
///
/// and the torque follows the effective acceleration of the mass, â + αv̂. The modal laws give each flexible mode a
/// ratio (eq 12), and leave the rigid rotation undamped; then λ = ω² and κ = 1.
#[derive(Debug, Clone, PartialEq)]
pub enum DampingLaw {
    /// κ = 1 + 2iξ; ξ = 0 is the undamped link.
    Hysteretic {
        /// ξ.
        ratio: f64,
    },
    /// κ = 1 + iωβ, and α for every mass.
    Rayleigh {
        /// α in 1/s.
        alpha_per_s: f64,
        /// β in s.
        beta_s: f64,
    },
    /// Viscous ratio of every flexible mode.
    Modal {
        /// ζ of modes 1, 2, …; the last one also applies to all higher modes.
        ratios: Vec<f64>,
    },
    /// Viscous ratios from a series.
    Caughey(CaugheySeries),
}

/// Reason why a link's damping is invalid.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DampingError {
    /// A law refers to a mode that the mesh does not have.
    #[error("damping.modes asks for mode {asked}, but the mesh has only {found} modes")]
    NoSuchMode {
        /// Number of the mode.
        asked: usize,
        /// Number of flexible modes of the mesh.
        found: usize,
    },
    /// Rayleigh damping through two modes adds energy.
    #[error(
        "damping.ratios give alpha = {alpha_per_s:.3e} 1/s and beta = {beta_s:.3e} s, but both must \
         be at least 0"
    )]
    NegativeDamping {
        /// α in 1/s.
        alpha_per_s: f64,
        /// β in s.
        beta_s: f64,
    },
    /// A Caughey series adds energy to a mode.
    #[error(
        "damping.ratios give mode {mode} ({frequency_hz:.4} Hz) a ratio of {ratio:.3e}, but it must \
         be at least 0 in modes 1 to {modes}"
    )]
    NegativeRatio {
        /// Number of the mode.
        mode: usize,
        /// Its frequency in Hz.
        frequency_hz: f64,
        /// Ratio of the mode from the series.
        ratio: f64,
        /// Number of flexible modes of the mesh.
        modes: usize,
    },
}

impl DampingError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::NoSuchMode { .. } => "name lower modes, or give the mesh more elements",
            Self::NegativeDamping { .. } => {
                "bring the two ratios closer together, or set alpha and beta instead"
            }
            Self::NegativeRatio { .. } => {
                "set an even number of modes with similar ratios, so that the series rises above them, or a ratio \
                 for each mode with model \"modal\""
            }
        }
    }
}

impl DampingLaw {
    /// The law of a link; ratios for certain modes become coefficients from the modes of `mesh`.
    ///
    /// # Errors
    /// [`DampingError`]: modes that the mesh does not have, or damping that adds energy.
    pub fn of(link: &Link, mesh: &Mesh) -> Result<Self, DampingError> {
        let law = Self::on_finer(link, mesh)?;
        law.check(mesh)?;
        Ok(law)
    }

    /// The law on a mesh that refines one with a checked law. The additional modes lie above all frequencies of
    /// interest, so that their ratios from a series do not matter.
    ///
    /// # Errors
    /// [`DampingError::NoSuchMode`].
    pub(crate) fn on_finer(link: &Link, mesh: &Mesh) -> Result<Self, DampingError> {
        match link.damping() {
            Damping::None => Ok(Self::Hysteretic { ratio: 0.0 }),
            Damping::Hysteretic { ratio } => Ok(Self::Hysteretic { ratio: *ratio }),
            Damping::Rayleigh { alpha_per_s, beta_s } => {
                Ok(Self::Rayleigh { alpha_per_s: *alpha_per_s, beta_s: *beta_s })
            }
            Damping::RayleighThroughModes { modes, ratios } => {
                Ok(rayleigh(&frequencies_of(modes, mesh)?, *ratios))
            }
            Damping::Modal { ratios } => Ok(Self::Modal { ratios: ratios.clone() }),
            Damping::Caughey { modes, ratios } => {
                let series = CaugheySeries::through(&frequencies_of(modes, mesh)?, ratios);
                Ok(Self::Caughey(series))
            }
        }
    }

    /// Refuses a law that adds energy.
    fn check(&self, mesh: &Mesh) -> Result<(), DampingError> {
        match *self {
            Self::Rayleigh { alpha_per_s, beta_s } if alpha_per_s < 0.0 || beta_s < 0.0 => {
                return Err(DampingError::NegativeDamping { alpha_per_s, beta_s });
            }
            Self::Caughey(_) => {}
            _ => return Ok(()),
        }
        let all = natural_frequencies(mesh, MOST_CHECKED);
        let ratios = self.modal_ratios(&all);
        match ratios.iter().position(|ratio| *ratio < 0.0) {
            Some(k) => Err(DampingError::NegativeRatio {
                mode: k + 1,
                frequency_hz: all[k] / std::f64::consts::TAU,
                ratio: ratios[k],
                modes: all.len(),
            }),
            None => Ok(()),
        }
    }

    /// True if the law is diagonal only in the modes, so that responses need all modes.
    pub fn is_modal(&self) -> bool {
        matches!(self, Self::Modal { .. } | Self::Caughey(_))
    }

    /// Relative complex stiffness κ at ω ≥ 0.
    pub fn stiffness_factor(&self, omega_rad_s: f64) -> Complex64 {
        match *self {
            Self::Hysteretic { ratio } => Complex64::new(1.0, 2.0 * ratio),
            Self::Rayleigh { beta_s, .. } => Complex64::new(1.0, omega_rad_s * beta_s),
            Self::Modal { .. } | Self::Caughey(_) => Complex64::ONE,
        }
    }

    /// α in 1/s: the law's drag rate on every mass, including the rigid rotation.
    pub fn mass_rate_per_s(&self) -> f64 {
        match *self {
            Self::Rayleigh { alpha_per_s, .. } => alpha_per_s,
            _ => 0.0,
        }
    }

    /// Factors of mass and stiffness at ω ≥ 0, `1 + α/(iω)` and κ. Both are 1 at ω = 0, because a constant load meets
    /// neither drag nor damping.
    pub(crate) fn factors(&self, omega_rad_s: f64) -> [Complex64; 2] {
        if omega_rad_s == 0.0 {
            return [Complex64::ONE; 2];
        }
        let mass = Complex64::new(1.0, -self.mass_rate_per_s() / omega_rad_s);
        [mass, self.stiffness_factor(omega_rad_s)]
    }

    /// 1/κ at ω ≥ 0, computed once if it does not depend on ω.
    pub(crate) fn compliance_factor(&self) -> impl Fn(f64) -> Complex64 {
        let at = |omega_rad_s| self.stiffness_factor(omega_rad_s).reciprocal();
        let at_all = if matches!(self, Self::Rayleigh { .. }) { None } else { Some(at(0.0)) };
        #[inline(always)]
        move |omega_rad_s| at_all.unwrap_or_else(|| at(omega_rad_s))
    }

    /// λ at ω ≥ 0 in 1/s².
    pub fn lambda(&self, omega_rad_s: f64) -> Complex64 {
        self.lambdas()(omega_rad_s)
    }

    /// [`Self::lambda`] as a function, for many ω.
    pub fn lambdas(&self) -> impl Fn(f64) -> Complex64 {
        let (compliance, mass_rate_per_s) = (self.compliance_factor(), self.mass_rate_per_s());
        move |omega_rad_s| {
            let dragged = Complex64::new(omega_rad_s, -mass_rate_per_s) * omega_rad_s;
            dragged * compliance(omega_rad_s)
        }
    }

    /// Viscous ratio of flexible mode `number`, counted from 1, at its natural frequency ω: ξ, α/(2ω) + βω/2, or the
    /// ratio of the mode.
    pub fn modal_ratio(&self, number: usize, omega_rad_s: f64) -> f64 {
        match self {
            Self::Hysteretic { ratio } => *ratio,
            Self::Rayleigh { alpha_per_s, beta_s } => {
                0.5 * (alpha_per_s / omega_rad_s + beta_s * omega_rad_s)
            }
            Self::Modal { ratios } => {
                let ratio = ratios.get(number.saturating_sub(1)).or(ratios.last());
                ratio.copied().unwrap_or(0.0)
            }
            Self::Caughey(series) => 0.5 * series.rate_per_s(omega_rad_s) / omega_rad_s,
        }
    }

    /// Viscous ratios of the first flexible modes, with these frequencies in rad/s.
    pub fn modal_ratios(&self, frequencies_rad_s: &[f64]) -> Vec<f64> {
        let modes = frequencies_rad_s.iter().enumerate();
        modes.map(|(k, omega)| self.modal_ratio(k + 1, *omega)).collect()
    }

    /// Denominator of the torque's share in flexible mode `number`, of natural frequency `mode_rad_s`, at ω:
    /// `ω_k² − λ`, or `ω_k² − ω² + 2iζω_kω`, in 1/s².
    pub(crate) fn modal_denominator(
        &self,
        number: usize,
        mode_rad_s: f64,
        omega_rad_s: f64,
    ) -> Complex64 {
        let square = mode_rad_s * mode_rad_s;
        if self.is_modal() {
            let rate = 2.0 * self.modal_ratio(number, mode_rad_s) * mode_rad_s;
            Complex64::new(square - omega_rad_s * omega_rad_s, rate * omega_rad_s)
        } else {
            square - self.lambda(omega_rad_s)
        }
    }
}

/// Frequencies in rad/s of flexible modes, numbered from 1.
fn frequencies_of(modes: &[usize], mesh: &Mesh) -> Result<Vec<f64>, DampingError> {
    let asked = modes.iter().copied().max().unwrap_or(0);
    let frequencies = natural_frequencies(mesh, asked);
    let found = frequencies.len();
    if found < asked {
        return Err(DampingError::NoSuchMode { asked, found });
    }
    Ok(modes.iter().map(|mode| frequencies[mode - 1]).collect())
}

/// Solves α/(2ω) + βω/2 = ζ at two natural frequencies.
fn rayleigh(frequencies_rad_s: &[f64], ratios: [f64; 2]) -> DampingLaw {
    let (low, high) = (frequencies_rad_s[0], frequencies_rad_s[1]);
    let spread = (high - low) * (high + low);
    let beta_s = 2.0 * (ratios[1] * high - ratios[0] * low) / spread;
    let alpha_per_s = 2.0 * low * high * (ratios[0] * high - ratios[1] * low) / spread;
    DampingLaw::Rayleigh { alpha_per_s, beta_s }
}

/// Number of modes checked in a Caughey series: those of the largest mesh that it is summed on.
const MOST_CHECKED: usize = 2 * MOST_ELEMENTS_OF_ALL_MODES;

/// A Caughey series through chosen modes (Bayo 1987, eq 12).
///
/// ```text
/// C = M Σ a_b (M⁻¹K)ᵇ,   2ζω = Σ a_b ω²ᵇ,   b = 0 … p − 1
/// ```
///
/// Stored in Newton's form over ω², which loses no digits for neighbouring modes.
#[derive(Debug, Clone, PartialEq)]
pub struct CaugheySeries {
    /// ω² of the chosen modes in rad²/s².
    squares: Vec<f64>,
    /// Divided differences of 2ζω over ω².
    differences: Vec<f64>,
}

impl CaugheySeries {
    /// The series through these ratios at these ascending frequencies in rad/s.
    pub(super) fn through(frequencies: &[f64], ratios: &[f64]) -> Self {
        let squares: Vec<f64> = frequencies.iter().map(|omega| omega * omega).collect();
        let mut differences: Vec<f64> =
            frequencies.iter().zip(ratios).map(|(omega, ratio)| 2.0 * ratio * omega).collect();
        for order in 1..squares.len() {
            for k in (order..squares.len()).rev() {
                let rise = differences[k] - differences[k - 1];
                differences[k] = rise / (squares[k] - squares[k - order]);
            }
        }
        Self { squares, differences }
    }

    /// 2ζω in 1/s at a natural frequency in rad/s.
    pub(super) fn rate_per_s(&self, omega_rad_s: f64) -> f64 {
        let square = omega_rad_s * omega_rad_s;
        let terms = self.squares.iter().zip(&self.differences).rev();
        terms.fold(0.0, |sum, (known, difference)| sum * (square - known) + difference)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_modes_give_the_law_of_rayleigh() {
        let series = CaugheySeries::through(&[12.0, 80.0], &[0.02, 0.05]);
        let beta = 2.0 * (0.05 * 80.0 - 0.02 * 12.0) / (80.0_f64.powi(2) - 12.0_f64.powi(2));
        let alpha = 2.0 * 0.02 * 12.0 - beta * 144.0;
        for omega in [1.0, 12.0, 30.0, 80.0, 500.0] {
            let expected = alpha + beta * omega * omega;
            assert!((series.rate_per_s(omega) / expected - 1.0).abs() < 1e-13, "{omega} rad/s");
        }
    }

    #[test]
    fn every_chosen_mode_gets_its_ratio() {
        let (frequencies, ratios) = ([11.9, 34.2, 83.8, 159.0], [0.01, 0.03, 0.02, 0.04]);
        let series = CaugheySeries::through(&frequencies, &ratios);
        for (omega, ratio) in frequencies.iter().zip(ratios) {
            assert!((series.rate_per_s(*omega) / (2.0 * omega) - ratio).abs() < 1e-15);
        }
        // Between the modes it is the cubic in ω² through the four points, here by Lagrange's formula.
        let omega: f64 = 50.0;
        let lagrange: f64 = (0..4)
            .map(|i| {
                let others = (0..4).filter(|j| *j != i).map(|j| {
                    let square = |k: usize| frequencies[k] * frequencies[k];
                    (omega * omega - square(j)) / (square(i) - square(j))
                });
                2.0 * ratios[i] * frequencies[i] * others.product::<f64>()
            })
            .sum();
        assert!((series.rate_per_s(omega) / lagrange - 1.0).abs() < 1e-13);
    }
}
