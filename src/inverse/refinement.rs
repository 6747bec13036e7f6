use super::error::InversionError;
use super::spectra::Forcing;
use crate::beam::{Mesh, MeshPlan};

/// Elements that an automatic mesh is not refined beyond.
const MOST_ELEMENTS: usize = 8192;

/// A mesh and the discretisation error of its torque, relative to the peak.
pub(super) struct MeasuredMesh {
    pub(super) mesh: Mesh,
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
    coarsest: Mesh,
    plan: &MeshPlan,
    forcing: impl Fn(&Mesh) -> Result<Vec<f64>, InversionError>,
) -> Result<MeasuredMesh, InversionError> {
    let mut mesh = coarsest;
    let mut torque = forcing(&mesh)?;
    loop {
        let finer = mesh.refined();
        let finer_torque = forcing(&finer)?;
        let peak = finer_torque.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
        let difference =
            torque.iter().zip(&finer_torque).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        let error = 16.0 / 15.0 * difference / peak;
        if !plan.is_automatic() || error <= plan.tolerance() {
            return Ok(MeasuredMesh { mesh, error });
        }
        if 2 * finer.elements().len() > MOST_ELEMENTS {
            let (elements, tolerance) = (mesh.elements().len(), plan.tolerance());
            return Err(InversionError::NotConverged { error, elements, tolerance });
        }
        (mesh, torque) = (finer, finer_torque);
    }
}

impl Forcing<'_> {
    /// Torque in N m over the period.
    pub(super) fn torque_n_m(&self) -> Result<Vec<f64>, InversionError> {
        Ok(self.spectrum.pair.samples(self.hub_spectra()?.torque_n_m))
    }
}
