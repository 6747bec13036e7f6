use num_complex::Complex64;

use super::dynamics::Dynamics;
use super::error::InversionError;
use super::response::FrequencyResponse;
use crate::numeric::magnitude;

/// Frequencies that are answered at a time, so that many take no memory.
const AT_A_TIME: usize = 4096;

/// What halved elements change of the transfers of `rows`: for each the larger of the changes of
/// `T/a_tip` and `θ/v_tip`, over the larger of the two magnitudes that it lies between.
///
/// Over the larger, so that at a pole or zero without damping it is a number, too.
///
/// # Errors
/// [`InversionError::TooManyElements`] where damping needs all modes of the finer mesh.
pub fn changes_on_halves(
    dynamics: &Dynamics,
    friction_n_m_s_rad: f64,
    rows: &[FrequencyResponse],
) -> Result<Vec<f64>, InversionError> {
    let finer = dynamics.refined()?;
    let changes = rows.chunks(AT_A_TIME).flat_map(|rows| {
        let frequencies_hz: Vec<f64> = rows.iter().map(|row| row.frequency_hz).collect();
        let on_halves = FrequencyResponse::at_all(&finer, friction_n_m_s_rad, &frequencies_hz);
        rows.iter().zip(on_halves).map(|(row, half)| change(row, &half)).collect::<Vec<_>>()
    });
    Ok(changes.collect())
}

fn change(found: &FrequencyResponse, half: &FrequencyResponse) -> f64 {
    let relative = |of: fn(&FrequencyResponse) -> Complex64| {
        let (found, half) = (of(found), of(half));
        let change = magnitude(found - half) / magnitude(found).max(magnitude(half));
        // One that is infinite on one mesh alone is changed altogether; on both, or 0, not at all.
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
