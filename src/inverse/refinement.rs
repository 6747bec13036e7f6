use super::dynamics::Dynamics;
use super::error::InversionError;
use super::spectra::Forcing;
use crate::beam::MeshPlan;
use crate::numeric::{largest, largest_difference};

/// The link on a mesh and the discretisation error of its torque, relative to the peak.
pub(super) struct Measured {
    pub(super) dynamics: Dynamics,
    pub(super) error: f64,
}

/// Measures the discretisation error of the torque against the mesh with halved elements, and
/// refines an automatic mesh until it is below the plan's tolerance.
///
/// The error falls with the fourth power of the element length, so that the halved mesh has a
/// sixteenth of it and the difference is 15/16 of it.
///
/// # Errors
/// [`InversionError::NotConverged`], or a torque that is not finite.
pub(super) fn measured_mesh(
    coarsest: Dynamics,
    plan: &MeshPlan,
    forcing: impl Fn(&Dynamics) -> Result<Vec<f64>, InversionError>,
) -> Result<Measured, InversionError> {
    let mut dynamics = coarsest;
    let mut torque = forcing(&dynamics)?;
    loop {
        let finer = dynamics.refined()?;
        let finer_torque = forcing(&finer)?;
        let difference = largest_difference(&torque, &finer_torque);
        let error = 16.0 / 15.0 * difference / largest(&finer_torque);
        if !plan.is_automatic() || error <= plan.tolerance() {
            return Ok(Measured { dynamics, error });
        }
        if 2 * finer.mesh().elements().len() > finer.most_elements() {
            let (elements, tolerance) = (dynamics.mesh().elements().len(), plan.tolerance());
            return Err(InversionError::NotConverged { error, elements, tolerance });
        }
        (dynamics, torque) = (finer, finer_torque);
    }
}

impl Forcing<'_> {
    /// Torque in N m over the period.
    pub(super) fn torque_n_m(&self) -> Result<Vec<f64>, InversionError> {
        Ok(self.spectrum.pair.samples(self.hub_spectra()?.torque_n_m))
    }
}
