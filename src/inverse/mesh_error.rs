//! The answer on a mesh, and its discretisation error: what elements of half the length change of it.

use std::ops::RangeInclusive;
use std::sync::Arc;

use super::accuracy::PerQuantity;
use super::amplitudes::{Amplitudes, Probes};
use super::analysis::{Analysis, Unwatched, Watch};
use super::error::InversionError;
use super::input_error::input_errors;
use super::spectra::DrivenModel;
use crate::beam::{Mesh, MeshPlan};
use crate::model::{KeptModes, Model, ModelError};
use crate::motion::{InputBand, TipPeriod};

/// Peak torques in N m whose squares, and products with rates and times, are finite.
const TORQUES_N_M: RangeInclusive<f64> = 1e-100..=1e100;

/// The answer on the mesh that is fine enough, and its errors.
pub(super) struct MeshAnswer {
    pub(super) model: Arc<dyn Model>,
    pub(super) amplitudes: Amplitudes,
    /// Peak of each quantity.
    pub(super) peaks: PerQuantity<f64>,
    /// Discretisation error of each quantity over its own peak.
    pub(super) mesh_errors: PerQuantity<f64>,
    /// What a reduction to few modes changes of each quantity, over its own peak.
    pub(super) mode_errors: Option<PerQuantity<f64>>,
    /// What the uncertainty of the samples does to each quantity, over its own peak.
    pub(super) input_errors: Option<PerQuantity<f64>>,
}

impl MeshAnswer {
    /// Solves on the coarsest mesh and on halved elements, and goes on with these where the plan is
    /// automatic, until the worst discretisation error is below the plan's tolerance.
    ///
    /// # Errors
    /// [`InversionError::NotConverged`], or a torque that is not finite or beyond what can be squared.
    pub(super) fn of(
        coarsest: Arc<dyn Model>,
        plan: &MeshPlan,
        period: &TipPeriod,
        analysis: &Analysis,
        watch: &dyn Watch,
    ) -> Result<Self, InversionError> {
        let mut probes = Probes::of(coarsest.mesh(), plan, analysis);
        let solved = |model: &Arc<dyn Model>, probes: &Probes| {
            Amplitudes::of(DrivenModel { model: &**model, period, watch }, probes)
        };
        let mut answer = solved(&coarsest, &probes);
        let mut model = coarsest;
        loop {
            let elements = model.mesh().elements().len();
            let finer = model.refined()?;
            let finer_probes = probes.refined();
            let finer_answer = solved(&finer, &finer_probes);
            let may_refine = plan.is_automatic() && 4 * elements <= finer.most_elements();
            match measured(&answer, &finer_answer, period, model.mesh()) {
                // A mesh far too coarse for its band may give no numbers at all.
                Err(InversionError::Model(ModelError::NotFinite { .. })) if may_refine => {}
                Err(error) => return Err(error),
                Ok((mesh_errors, peaks)) => {
                    let (_, error) = mesh_errors.worst();
                    if !plan.is_automatic() || error <= plan.tolerance() {
                        let amplitudes = answer?;
                        let mode_errors = (model.kept_modes() != KeptModes::All).then(|| {
                            let all = model.unreduced()?;
                            let exact = solved(&all, &probes)?;
                            let peaks = exact.peaks(period, all.mesh().length_m());
                            Ok::<_, ModelError>(amplitudes.change_to(&exact, &peaks))
                        });
                        let mode_errors = mode_errors.transpose()?;
                        let input = period.spectrum.cutoff.input;
                        let of_input =
                            |input| uncertain((&*model, &probes), period, &input, &peaks);
                        let input_errors = input.map(of_input).transpose()?;
                        return Ok(Self {
                            model,
                            amplitudes,
                            peaks,
                            mesh_errors,
                            mode_errors,
                            input_errors,
                        });
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
}

/// What uncertain samples do to each quantity, over its peak; all of it where the mesh has no answer at the
/// frequencies beyond the band.
fn uncertain(
    (model, probes): (&dyn Model, &Probes),
    period: &TipPeriod,
    input: &InputBand,
    peaks: &PerQuantity<f64>,
) -> Result<PerQuantity<f64>, ModelError> {
    let watch = &Unwatched;
    let [within, beyond] = [period.of_noise(input.deviation_m), period.beyond(input)];
    let of_within = Amplitudes::of(DrivenModel { model, period: &within, watch }, probes)?;
    let of_beyond = Amplitudes::of(DrivenModel { model, period: &beyond, watch }, probes);
    let Ok(of_beyond) = of_beyond else { return Ok(peaks.zip(peaks, |_, _| 1.0)) };
    let within = (&of_within, &within.spectrum);
    let beyond = (&of_beyond, &beyond.spectrum);
    Ok(input_errors(within, beyond, peaks, model.mesh().length_m()))
}

/// Discretisation error of an answer, measured against that on halved elements, and the peaks there.
fn measured(
    answer: &Result<Amplitudes, ModelError>,
    finer: &Result<Amplitudes, ModelError>,
    period: &TipPeriod,
    mesh: &Mesh,
) -> Result<(PerQuantity<f64>, PerQuantity<f64>), InversionError> {
    let (answer, finer) =
        (answer.as_ref().map_err(Clone::clone)?, finer.as_ref().map_err(Clone::clone)?);
    let peaks = finer.peaks(period, mesh.length_m());
    if !TORQUES_N_M.contains(&peaks.torque) {
        return Err(InversionError::OutOfRange { peak_n_m: peaks.torque });
    }
    let changes = answer.change_to(finer, &peaks);
    let per_change = mesh.error_per_change();
    Ok((changes.zip(&changes, |change, _| per_change * change), peaks))
}
