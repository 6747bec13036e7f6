//! The slow tail that hysteretic damping leaves in deflections and in the hub angle.
//!
//! The factor κ = 1 + 2iξ sgn ω has a jump at ω = 0, so that deflections and the hub angle decay no
//! faster than t⁻² away from the motion, where the torque decays as t⁻⁴. That part is known in closed
//! form: where the transfer from tip acceleration is
//!
//! ```text
//! H(ω) = (g₀ + g₁ ω² + g₂ ω⁴ + …)/κ,   ω > 0,
//! h(s) → Σ_m S_m/s^{2m+1},   S_m = −(−1)^m (2m)!/π · Im(g_m/κ),   |s| → ∞,
//! ```
//!
//! and what the motion in all other periods adds through it, [`Images`], is taken off.
//!
//! [`Images`]: crate::motion::Images

use std::f64::consts::PI;

use num_complex::Complex64;

use crate::beam::{Checkpoints, NodalQuantity};
use crate::modal::DampingLaw;
use crate::model::Model;
use crate::motion::{TAIL_TERMS, TailTerms};

/// Spacing of the frequencies through which the series of a transfer is found, over the first zero.
const SPACING: f64 = 0.1;

/// Where a transfer with a slow tail is a power series in ω².
pub(super) struct Series {
    /// Zero and the frequencies above it, in rad/s.
    omegas_rad_s: [f64; TAIL_TERMS + 1],
    compliance: Complex64,
}

impl Series {
    /// None for a law without a slow tail.
    pub(super) fn of(model: &dyn Model, first_zero_per_s: Option<f64>) -> Option<Self> {
        let law = model.law();
        let is_hysteretic = matches!(law, DampingLaw::Hysteretic { ratio } if *ratio > 0.0);
        let spacing = SPACING * first_zero_per_s.filter(|_| is_hysteretic)?;
        let omegas_rad_s = std::array::from_fn(|k| spacing * k as f64);
        Some(Self { omegas_rad_s, compliance: law.stiffness_factor(0.0).inv() })
    }

    /// `S_m` of the hub angle less that of a rigid link.
    pub(super) fn hub_tail(&self, model: &dyn Model) -> TailTerms {
        let lags = model.tip_transfers(&self.omegas_rad_s).deflection_s2;
        self.tail(&lags).map(|s| s / model.mesh().length_m())
    }

    /// `S_m` of the deflection at each of some nodes.
    pub(super) fn nodal_tails(&self, model: &dyn Model, nodes: &[usize]) -> Vec<TailTerms> {
        let mut rows = vec![[Complex64::ZERO; TAIL_TERMS + 1]; nodes.len()];
        let mut columns: Vec<_> = rows.iter_mut().map(<[_; _]>::as_mut_slice).collect();
        let quantity = NodalQuantity::Deflection;
        let checkpoints = &mut Checkpoints::of(model.mesh(), []);
        model.nodal_transfers(&self.omegas_rad_s, nodes, quantity, &mut columns, checkpoints);
        rows.iter().map(|row| self.tail(row).map(|s| -s)).collect()
    }

    /// `S_m` from the values of `κH`.
    fn tail(&self, values: &[Complex64]) -> TailTerms {
        // Newton's divided differences in ω², and from them the coefficients of its powers.
        let squares = self.omegas_rad_s.map(|omega| omega * omega);
        let mut differences = values.to_vec();
        for level in 1..differences.len() {
            for k in (level..differences.len()).rev() {
                let rise = differences[k] - differences[k - 1];
                differences[k] = rise / (squares[k] - squares[k - level]);
            }
        }
        let mut powers = vec![Complex64::ZERO; differences.len()];
        for k in (0..differences.len()).rev() {
            for j in (1..powers.len()).rev() {
                powers[j] = powers[j - 1] - powers[j] * squares[k];
            }
            powers[0] = differences[k] - powers[0] * squares[k];
        }
        let mut factor = -1.0 / PI;
        std::array::from_fn(|m| {
            let tail = factor * (powers[m] * self.compliance).im;
            factor *= -(((2 * m + 1) * (2 * m + 2)) as f64);
            tail
        })
    }
}
