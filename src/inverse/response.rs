use std::f64::consts::TAU;

use num_complex::Complex64;

use super::dynamics::Dynamics;
use crate::beam::TipTransfer;

/// Transfers of a link at one frequency, for e^{+iωt}.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrequencyResponse {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// `T/a_tip` in kg m (Bayo 1987, eq 20), joint friction included.
    pub torque_per_tip_acceleration_kg_m: Complex64,
    /// `θ/v_tip` in rad/m (eq 21).
    pub hub_angle_per_tip_displacement_rad_m: Complex64,
    /// `v_tip/T` in 1/N (eq 19).
    pub tip_displacement_per_torque_1_n: Complex64,
}

impl FrequencyResponse {
    /// Transfers at `frequency_hz` > 0.
    ///
    /// ```text
    /// T/a_tip = (A_0[φφ] + I_H)/(L + e_tip) (1 + α/(iω)) + b/(iω (L + e_tip))
    /// ```
    ///
    /// At a pole of an undamped link a transfer may be infinite.
    pub fn at(dynamics: &Dynamics, friction_n_m_s_rad: f64, frequency_hz: f64) -> Self {
        let transfer = dynamics.tip_transfer(frequency_hz * TAU);
        Self::of(transfer, dynamics, friction_n_m_s_rad, frequency_hz)
    }

    /// [`FrequencyResponse::at`] many frequencies, as many at a time as the processor's vectors hold.
    pub fn at_all(
        dynamics: &Dynamics,
        friction_n_m_s_rad: f64,
        frequencies_hz: &[f64],
    ) -> Vec<Self> {
        let omegas: Vec<f64> = frequencies_hz.iter().map(|hz| hz * TAU).collect();
        let transfers = dynamics.tip_transfers(&omegas);
        let all = transfers.iter().zip(frequencies_hz);
        all.map(|(of, hz)| Self::of(of, dynamics, friction_n_m_s_rad, *hz)).collect()
    }

    fn of(
        transfer: TipTransfer,
        dynamics: &Dynamics,
        friction_n_m_s_rad: f64,
        frequency_hz: f64,
    ) -> Self {
        let omega = frequency_hz * TAU;
        let rate = Complex64::new(0.0, omega);
        let torque = transfer.inertia_kg_m * (1.0 + dynamics.law().mass_rate_per_s() / rate)
            + transfer.angle_rad_m * friction_n_m_s_rad / rate;
        Self {
            frequency_hz,
            torque_per_tip_acceleration_kg_m: torque,
            hub_angle_per_tip_displacement_rad_m: transfer.angle_rad_m,
            tip_displacement_per_torque_1_n: -(torque * omega * omega).inv(),
        }
    }
}
