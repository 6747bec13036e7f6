use std::f64::consts::TAU;

use num_complex::Complex64;

use super::link_on_mesh::{Model, ModelError};
use crate::beam::TipTransfer;
use crate::numeric::magnitude;

/// Frequencies at which the finer mesh is solved at a time, so that many take little memory.
const AT_A_TIME: usize = 4096;

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
    pub fn at(model: &dyn Model, frequency_hz: f64) -> Self {
        Self::of(model.tip_transfer(frequency_hz * TAU), model, frequency_hz)
    }

    /// [`FrequencyResponse::at`] many frequencies, as many at a time as the processor's vectors hold.
    pub fn at_all(model: &dyn Model, frequencies_hz: &[f64]) -> Vec<Self> {
        let omegas: Vec<f64> = frequencies_hz.iter().map(|hz| hz * TAU).collect();
        let transfers = model.tip_transfers(&omegas);
        transfers.iter().zip(frequencies_hz).map(|(of, hz)| Self::of(*of, model, *hz)).collect()
    }

    fn of(transfer: TipTransfer, model: &dyn Model, frequency_hz: f64) -> Self {
        let omega = frequency_hz * TAU;
        let rate = Complex64::new(0.0, omega);
        let torque = transfer.inertia_kg_m * (1.0 + model.law().mass_rate_per_s() / rate)
            + transfer.angle_rad_m * model.link().joint().friction_n_m_s_rad / rate;
        Self {
            frequency_hz,
            torque_per_tip_acceleration_kg_m: torque,
            hub_angle_per_tip_displacement_rad_m: transfer.angle_rad_m,
            tip_displacement_per_torque_1_n: -(torque * omega * omega).inv(),
        }
    }
}

/// What halved elements change of the transfers of `rows`: for each the larger of the changes of
/// `T/a_tip` and `θ/v_tip`, over the larger of the two magnitudes that it lies between.
///
/// Over the larger, so that it is a number at a pole or zero without damping, too.
///
/// # Errors
/// [`ModelError::TooManyElements`] where damping needs all modes of the finer mesh.
pub fn changes_on_halves(
    model: &dyn Model,
    rows: &[FrequencyResponse],
) -> Result<Vec<f64>, ModelError> {
    let finer = model.refined()?;
    let changes = rows.chunks(AT_A_TIME).flat_map(|rows| {
        let frequencies_hz: Vec<f64> = rows.iter().map(|row| row.frequency_hz).collect();
        let on_halves = FrequencyResponse::at_all(&*finer, &frequencies_hz);
        rows.iter().zip(on_halves).map(|(row, half)| change(row, &half)).collect::<Vec<_>>()
    });
    Ok(changes.collect())
}

fn change(found: &FrequencyResponse, half: &FrequencyResponse) -> f64 {
    let relative = |of: fn(&FrequencyResponse) -> Complex64| {
        let (found, half) = (of(found), of(half));
        let change = magnitude(found - half) / magnitude(found).max(magnitude(half));
        // A transfer that is infinite on one mesh alone changes by all of it; one that is infinite, or
        // 0, on both does not change.
        match (found.is_finite(), half.is_finite()) {
            (true, true) if change.is_nan() => 0.0,
            (true, true) => change,
            (false, false) => 0.0,
            _ => 1.0,
        }
    };
    relative(|row| row.torque_per_tip_acceleration_kg_m)
        .max(relative(|row| row.hub_angle_per_tip_displacement_rad_m))
}
