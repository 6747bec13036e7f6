use std::ops::RangeInclusive;

use super::dynamics::Dynamics;
use super::error::InversionError;
use super::halving::change_n_m;
use super::spectra::{Forcing, HubSpectra};
use crate::beam::MeshPlan;
use crate::motion::TipSpectrum;
use crate::numeric::largest;

/// What the measured change of the torque may be wrong by, of itself; see [`change_n_m`].
const MEASURED_TO: f64 = 1e-3;

/// Peak torques in N m whose squares, and products with rates and times, are numbers, too.
const TORQUES_N_M: RangeInclusive<f64> = 1e-100..=1e100;

/// The answer on a mesh, and the discretisation error of its torque, relative to the peak.
pub(super) struct Measured {
    pub(super) hub: HubSpectra,
    pub(super) torque_n_m: Vec<f64>,
    pub(super) error: f64,
}

/// Peak of a torque in N m.
///
/// # Errors
/// [`InversionError::OutOfRange`] if its square is no number.
pub(super) fn peak_in_range(torque_n_m: &[f64]) -> Result<f64, InversionError> {
    let peak_n_m = largest(torque_n_m);
    if TORQUES_N_M.contains(&peak_n_m) {
        Ok(peak_n_m)
    } else {
        Err(InversionError::OutOfRange { peak_n_m })
    }
}

/// Measures the discretisation error of the torque against the mesh with halved elements, and
/// refines an automatic mesh until it is below the plan's tolerance.
///
/// The error falls with the fourth power of the element length, so that the halved mesh has a
/// sixteenth of it and the difference is 15/16 of it.
///
/// # Errors
/// [`InversionError::NotConverged`], or a torque that is not finite or beyond what can be squared.
pub(super) fn measured_mesh(
    coarsest: Dynamics,
    plan: &MeshPlan,
    friction_n_m_s_rad: f64,
    spectrum: &TipSpectrum,
) -> Result<(Dynamics, Measured), InversionError> {
    let mut dynamics = coarsest;
    loop {
        let finer = dynamics.refined()?;
        let may_refine =
            plan.is_automatic() && 2 * finer.mesh().elements().len() <= finer.most_elements();
        let forcing = Forcing { dynamics: &dynamics, friction_n_m_s_rad, spectrum };
        match measured(forcing, &finer) {
            // A mesh far too coarse for its band may give no numbers at all.
            Err(InversionError::NotFinite { .. }) if may_refine => {}
            Err(error) => return Err(error),
            Ok(measured) => {
                let error = measured.error;
                let is_fine = error * (1.0 + MEASURED_TO) <= plan.tolerance();
                if !plan.is_automatic() || is_fine {
                    return Ok((dynamics, measured));
                }
                if !may_refine {
                    let (elements, tolerance) =
                        (dynamics.mesh().elements().len(), plan.tolerance());
                    return Err(InversionError::NotConverged { error, elements, tolerance });
                }
            }
        }
        dynamics = finer;
    }
}

/// The answer on a mesh, measured against that of `finer`, whose elements are half as long.
fn measured(forcing: Forcing<'_>, finer: &Dynamics) -> Result<Measured, InversionError> {
    let hub = forcing.hub_spectra()?;
    let torque_n_m = forcing.spectrum.pair.samples(&hub.torque_n_m);
    let peak_n_m = peak_in_range(&torque_n_m)?;
    let on_finer = Forcing { dynamics: finer, ..forcing };
    let change = change_n_m(forcing, on_finer, &hub.torque_n_m)?;
    let finer_torque: Vec<f64> = torque_n_m.iter().zip(&change).map(|(t, d)| t + d).collect();
    // What is less than the rounding of the sum is not known.
    let finer_peak_n_m = largest(&finer_torque).max(f64::EPSILON * peak_n_m);
    let error = 16.0 / 15.0 * largest(&change) / finer_peak_n_m;
    Ok(Measured { hub, torque_n_m, error })
}
