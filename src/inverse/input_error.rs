//! What the uncertainty of a recorded motion does to the answer.
//!
//! Within the band the samples' errors pass through the link's transfers. Errors that are independent from
//! sample to sample with standard deviation σ have the amplitude `σ/√N` at each of the N frequencies of a
//! period, so that a quantity X with the transfer H from the tip's displacement has
//!
//! ```text
//! σ_X² = (2/N) Σ_k |H(ω_k)|² w(ω_k)² σ²
//! ```
//!
//! Beyond the band the motion is not known. The tip's error at the cut-off falls on with its power f, as it
//! does up to there, until it is what exact samples would be solved to. If all parts of it passed at the same
//! time, X would be off by
//!
//! ```text
//! ∫ |H| (−dε),   ε = ε(ω_c) (ω/ω_c)^{−f},   ω_c < ω < ω_c (ε(ω_c)/ε_wanted)^{1/f}
//! ```

use num_complex::Complex64;

use super::accuracy::PerQuantity;
use super::amplitudes::Amplitudes;
use crate::motion::TipSpectrum;

/// Largest error of a signal over its standard deviation.
const PEAK: f64 = 4.0;

/// Factor on what lies beyond the band: the tip's error falls in lobes, up to twice their mean. Without it,
/// one in ten of random motions and decimals had a larger error than the estimate.
const LOBES: f64 = 2.0;

/// What a set of amplitudes amounts to over time.
type Measure<'a> = &'a dyn Fn(&[Complex64]) -> f64;

/// The error of each quantity, over its peak: `within` are the amplitudes for a tip with the samples' errors
/// alone, `beyond` those for the parts of its motion beyond the band, each with its spectrum.
pub(super) fn input_errors(
    within: (&Amplitudes, &TipSpectrum),
    beyond: (&Amplitudes, &TipSpectrum),
    peaks: &PerQuantity<f64>,
    length_m: f64,
) -> PerQuantity<f64> {
    let within = within.0.measured(within.1, length_m, &|amplitudes| {
        let squares: f64 = amplitudes.iter().map(Complex64::norm_sqr).sum();
        PEAK * (2.0 * squares).sqrt()
    });
    let beyond = beyond.0.measured(beyond.1, length_m, &|amplitudes| {
        amplitudes.iter().map(|a| a.norm_sqr().sqrt()).sum()
    });
    let both = within.zip(&beyond, |within, beyond| within + LOBES * beyond);
    both.zip(peaks, |error, peak| if error == 0.0 { 0.0 } else { error / peak })
}

impl Amplitudes {
    /// Each quantity, the tip's own motion in it, as it amounts to over time.
    fn measured(&self, tip: &TipSpectrum, length_m: f64, measure: Measure<'_>) -> PerQuantity<f64> {
        let bins = self.hub.torque_n_m.len();
        let tip_m: Vec<Complex64> = (0..bins)
            .map(|k| match k {
                0 => Complex64::ZERO,
                _ => -tip.acceleration_m_s2[k] / tip.omegas_rad_s[k].powi(2),
            })
            .collect();
        let with_rigid = |excess: &[Complex64], tip: &[Complex64]| {
            let both: Vec<_> = excess.iter().zip(tip).map(|(e, tip)| e + tip / length_m).collect();
            measure(&both)
        };
        let of_all =
            |rows: &Vec<Vec<Complex64>>| rows.iter().map(|row| measure(row)).fold(0.0, f64::max);
        let acceleration = self.hub_acceleration_rad_s2.as_ref();
        PerQuantity {
            torque: measure(&self.hub.torque_n_m),
            hub_angle: with_rigid(&self.hub.excess_angle_rad, &tip_m),
            hub_rate: with_rigid(&self.hub_rate_rad_s, &tip.velocity_m_s),
            hub_acceleration: acceleration.map(|a| with_rigid(a, &tip.acceleration_m_s2)),
            displacement: self.displacement_m.as_ref().map(|rows| of_all(rows) + measure(&tip_m)),
            bending_moment: self.moment_n_m.as_ref().map(of_all),
            motor_torque: self.motor.as_ref().map(|motor| measure(&motor.torque_n_m)),
            motor_rate: self.motor.as_ref().map(|motor| measure(&motor.rate_rad_s)),
        }
    }
}
