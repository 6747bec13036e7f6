use std::ops::RangeInclusive;
use std::sync::Arc;

use super::accuracy::PerQuantity;
use super::error::InversionError;
use super::probes::{Amplitudes, Probes, Wanted};
use super::spectra::Forcing;
use super::watch::Watch;
use crate::beam::MeshPlan;
use crate::model::{Model, ModelError};
use crate::motion::{TipHistories, TipSpectrum};

/// Peak torques in N m whose squares, and products with rates and times, are numbers, too.
const TORQUES_N_M: RangeInclusive<f64> = 1e-100..=1e100;

/// The error falls with the fourth power of the element length: the halved mesh has a sixteenth of it,
/// and what it changes is 15/16 of it.
const ERROR_PER_CHANGE: f64 = 16.0 / 15.0;

/// The answer on a mesh, and what halved elements change of it.
pub(super) struct Measured {
    pub(super) model: Arc<dyn Model>,
    pub(super) probes: Probes,
    pub(super) amplitudes: Amplitudes,
    /// Peak of each quantity.
    pub(super) peaks: PerQuantity<f64>,
    /// Discretisation error of each quantity over its own peak.
    pub(super) mesh_errors: PerQuantity<f64>,
}

/// What a motion on a period asks of every mesh.
#[derive(Clone, Copy)]
pub(super) struct Asked<'a> {
    pub(super) spectrum: &'a TipSpectrum,
    pub(super) histories: &'a TipHistories,
    pub(super) wanted: Wanted,
    pub(super) watch: &'a dyn Watch,
}

/// Refuses a peak torque whose square is no number.
///
/// # Errors
/// [`InversionError::OutOfRange`].
fn check_range(peak_n_m: f64) -> Result<(), InversionError> {
    if TORQUES_N_M.contains(&peak_n_m) {
        Ok(())
    } else {
        Err(InversionError::OutOfRange { peak_n_m })
    }
}

impl<'a> Asked<'a> {
    /// The motion on one mesh.
    pub(super) fn of(&self, model: &'a dyn Model) -> Forcing<'a> {
        Forcing { model, spectrum: self.spectrum, watch: self.watch }
    }

    /// Peak of each quantity of an answer. The tip's way stands for the farthest that a node goes.
    pub(super) fn peaks(&self, length_m: f64, amplitudes: &Amplitudes) -> PerQuantity<f64> {
        amplitudes.peaks(self.spectrum, self.histories, length_m)
    }
}

/// What changed over peaks, quantity by quantity.
pub(super) fn shares(changes: &PerQuantity<f64>, peaks: &PerQuantity<f64>) -> PerQuantity<f64> {
    changes.zip(peaks, |change, peak| if change == 0.0 { 0.0 } else { change / peak })
}

/// Measures the discretisation error of every quantity against the mesh with halved elements, and
/// refines an automatic mesh until the worst is below the plan's tolerance.
///
/// # Errors
/// [`InversionError::NotConverged`], or a torque that is not finite or beyond what can be squared.
pub(super) fn measured_mesh(
    coarsest: Arc<dyn Model>,
    plan: &MeshPlan,
    asked: &Asked<'_>,
) -> Result<Measured, InversionError> {
    // An automatic mesh is the same whatever is measured on it.
    let tables = asked.wanted.tables || plan.is_automatic();
    let mut probes = Probes::of(coarsest.mesh(), Wanted { tables, ..asked.wanted });
    let mut answer = Amplitudes::of(asked.of(&*coarsest), &probes);
    let mut model = coarsest;
    loop {
        let elements = model.mesh().elements().len();
        let finer = model.refined()?;
        let finer_probes = probes.refined();
        let finer_answer = Amplitudes::of(asked.of(&*finer), &finer_probes);
        let may_refine = plan.is_automatic() && 4 * elements <= finer.most_elements();
        match measured(asked, &*model, &answer, &finer_answer) {
            // A mesh far too coarse for its band may give no numbers at all.
            Err(InversionError::Model(ModelError::NotFinite { .. })) if may_refine => {}
            Err(error) => return Err(error),
            Ok((mesh_errors, peaks)) => {
                let (_, error) = mesh_errors.worst();
                if !plan.is_automatic() || error <= plan.tolerance() {
                    let amplitudes = answer?;
                    return Ok(Measured { model, probes, amplitudes, peaks, mesh_errors });
                }
                if !may_refine {
                    let tolerance = plan.tolerance();
                    return Err(InversionError::NotConverged { error, elements, tolerance });
                }
            }
        }
        (model, probes, answer) = (finer, finer_probes, finer_answer);
    }
}

/// Discretisation error of an answer, measured against that on halved elements, and the peaks there.
fn measured(
    asked: &Asked<'_>,
    model: &dyn Model,
    answer: &Result<Amplitudes, ModelError>,
    finer: &Result<Amplitudes, ModelError>,
) -> Result<(PerQuantity<f64>, PerQuantity<f64>), InversionError> {
    let (answer, finer) =
        (answer.as_ref().map_err(Clone::clone)?, finer.as_ref().map_err(Clone::clone)?);
    let peaks = asked.peaks(model.mesh().length_m(), finer);
    check_range(peaks.torque)?;
    let errors = shares(&answer.change_to(finer), &peaks);
    Ok((errors.zip(&errors, |error, _| ERROR_PER_CHANGE * error), peaks))
}
