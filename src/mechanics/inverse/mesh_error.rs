//! The answer on a mesh, and its errors from the mesh and from the uncertainty of a recorded motion.
//!
//! Within the band the samples' errors pass through the link's transfers. Independent errors of the samples with
//! standard deviation σ have the amplitude `σ/√N` at each of the N frequencies of a period. A quantity X with the
//! transfer H from the tip's displacement has
//!
//! ```text
//! σ_X² = (2/N) Σ_k |H(ω_k)|² w(ω_k)² σ²
//! ```
//!
//! Beyond the band the motion is unknown. The tip's error falls with the power f up to the cut-off and beyond it, down
//! to the tolerance for exact samples. If all its parts added up at one time, the error of X would be
//!
//! ```text
//! ∫ |H| (−dε),   ε = ε(ω_c) (ω/ω_c)^{−f},   ω_c < ω < ω_c (ε(ω_c)/ε_wanted)^{1/f}
//! ```

use std::f64::consts::FRAC_1_SQRT_2;
use std::ops::RangeInclusive;
use std::sync::Arc;

use num_complex::Complex64;

use super::accuracy::PerQuantity;
use super::analysis::{Analysis, Unwatched, Watch};
use super::error::InversionError;
use super::spectra::{Amplitudes, DrivenModel, Probes};
use crate::beam::{Mesh, MeshPlan};
use crate::model::{KeptModes, Model, ModelError};
use crate::motion::{InputBand, TipPeriod, TipSpectrum};

/// Peak torques in N m with finite squares, and finite products with rates and times.
pub(super) const TORQUES_N_M: RangeInclusive<f64> = 1e-100..=1e100;

/// The answer on a fine enough mesh, and its errors.
pub(super) struct MeshAnswer {
    pub(super) model: Arc<dyn Model>,
    pub(super) amplitudes: Amplitudes,
    /// Peak of each quantity.
    pub(super) peaks: PerQuantity<f64>,
    /// Discretisation error of each quantity over its peak.
    pub(super) mesh_errors: PerQuantity<f64>,
    /// Change of each quantity by a reduction to few modes, over its peak.
    pub(super) mode_errors: Option<PerQuantity<f64>>,
    /// Error of each quantity from uncertain samples, over its peak.
    pub(super) input_errors: Option<PerQuantity<f64>>,
}

impl MeshAnswer {
    /// Solves on the coarsest mesh and on halved elements. For an automatic plan halves them until the worst
    /// discretisation error is below the plan's tolerance.
    ///
    /// # Errors
    /// [`InversionError::NotConverged`], or a torque that is not finite or too large to square.
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
            let finer_probes = probes.refined(model.mesh());
            let finer_answer = solved(&finer, &finer_probes);
            let may_refine = plan.is_automatic() && 4 * elements <= finer.most_elements();
            match measured(&answer, &finer_answer, period, model.mesh()) {
                // A mesh far too coarse for its band may yield no finite numbers.
                Err(InversionError::Model(ModelError::NotFinite { .. })) if may_refine => {}
                Err(error) => return Err(error),
                Ok((mesh_errors, peaks)) => {
                    let (_, error) = mesh_errors.worst();
                    if !plan.is_automatic() || error <= plan.tolerance() {
                        let amplitudes = answer?;
                        let mode_errors = (model.kept_modes() != KeptModes::All).then(|| {
                            let all = model.unreduced()?;
                            let exact = solved(&all, &probes)?;
                            let peaks = exact.peaks(period, all.mesh().rigid_tip());
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

/// Error of each quantity from uncertain samples, over its peak; 1 where the mesh has no answer at the frequencies
/// beyond the band.
pub(super) fn uncertain(
    (model, probes): (&dyn Model, &Probes),
    period: &TipPeriod,
    input: &InputBand,
    peaks: &PerQuantity<f64>,
) -> Result<PerQuantity<f64>, ModelError> {
    let watch = &Unwatched;
    let [within, beyond] = [period.of_noise(&input.noise), period.beyond(input)];
    let of_within = Amplitudes::of(DrivenModel { model, period: &within, watch }, probes)?;
    let of_beyond = Amplitudes::of(DrivenModel { model, period: &beyond, watch }, probes);
    let Ok(of_beyond) = of_beyond else { return Ok(peaks.zip(peaks, |_, _| 1.0)) };
    let within = (&of_within, &within.spectrum);
    let beyond = (&of_beyond, &beyond.spectrum);
    Ok(input_errors(within, beyond, peaks, model.mesh().rigid_tip()))
}

/// Discretisation error of an answer, measured on halved elements, and the peaks there.
fn measured(
    answer: &Result<Amplitudes, ModelError>,
    finer: &Result<Amplitudes, ModelError>,
    period: &TipPeriod,
    mesh: &Mesh,
) -> Result<(PerQuantity<f64>, PerQuantity<f64>), InversionError> {
    let (answer, finer) =
        (answer.as_ref().map_err(Clone::clone)?, finer.as_ref().map_err(Clone::clone)?);
    let peaks = finer.peaks(period, mesh.rigid_tip());
    if !TORQUES_N_M.contains(&peaks.torque) {
        return Err(InversionError::OutOfRange { peak_n_m: peaks.torque });
    }
    let changes = answer.change_to(finer, &peaks);
    let per_change = mesh.error_per_change();
    Ok((changes.zip(&changes, |change, _| per_change * change), peaks))
}

/// Largest error of a signal over its standard deviation.
const PEAK: f64 = 4.0;

/// Factor on the error beyond the band: the tip's error falls in lobes, up to twice their mean. Without it, one in ten
/// of random motions and decimals had a larger error than the estimate.
const LOBES: f64 = 2.0;

/// Size of a set of amplitudes over time.
type Measure<'a> = &'a dyn Fn(&[Complex64]) -> f64;

/// The error of each quantity, over its peak. `within` are amplitudes for a tip with the samples' errors alone,
/// `beyond` for the parts of its motion beyond the band, each with its spectrum.
pub(super) fn input_errors(
    within: (&Amplitudes, &TipSpectrum),
    beyond: (&Amplitudes, &TipSpectrum),
    peaks: &PerQuantity<f64>,
    rigid_tip: f64,
) -> PerQuantity<f64> {
    let within = within.0.measured(within.1, rigid_tip, &|amplitudes| {
        let squares: f64 = amplitudes.iter().map(Complex64::norm_sqr).sum();
        PEAK * (2.0 * squares).sqrt()
    });
    let beyond = beyond.0.measured(beyond.1, rigid_tip, &|amplitudes| {
        amplitudes.iter().map(|a| a.norm_sqr().sqrt()).sum()
    });
    let both = within.zip(&beyond, |within, beyond| within + LOBES * beyond);
    both.zip(peaks, |error, peak| if error == 0.0 { 0.0 } else { error / peak })
}

impl Amplitudes {
    /// Size of each quantity over time, the tip's motion included.
    fn measured(
        &self,
        tip: &TipSpectrum,
        rigid_tip: f64,
        measure: Measure<'_>,
    ) -> PerQuantity<f64> {
        let bins = self.hub.torque_n_m.len();
        let tip_m: Vec<Complex64> = (0..bins)
            .map(|k| match k {
                // The tip's end is no wave: its square counts half as much in the sum as a wave's.
                0 => (FRAC_1_SQRT_2 * tip.travel_m()).into(),
                _ => -tip.acceleration_m_s2[k] / tip.omegas_rad_s[k].powi(2),
            })
            .collect();
        let with_rigid = |excess: &[Complex64], tip: &[Complex64]| {
            let both: Vec<_> = excess.iter().zip(tip).map(|(e, tip)| e + tip / rigid_tip).collect();
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
