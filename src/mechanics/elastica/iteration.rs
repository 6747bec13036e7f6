//! Bands of frequencies and changes of an iteration of second-order terms, and the links that it suits.

use num_complex::Complex64;

use super::chord::ChordPeriod;
use super::error::ElasticaError;
use super::on_chord::LinkOnChord;
use super::reaction::band;
use crate::beam::LoadedMotion;
use crate::model::{KeptModes, Model};

/// Limit of iterations, even if they still converge.
pub(super) const MOST_ITERATIONS: usize = 100;

/// Largest share that an iteration leaves out. These terms grow with the square of the frequency, so that a larger share
/// may converge where a smaller one does not.
pub(super) const MOST_NEGLIGIBLE: f64 = 1e-3;

/// Ratio of an iteration's change to the change before, above which a narrower band is tried, which may converge.
const SLOW: f64 = 0.9;

/// Number of bins of the loads over the number of bins of their deflections: products of three reach as far.
pub(super) const REACH: usize = 3;

/// Share of the longest resolved step that an error message suggests: more samples show faster parts of the motion.
/// With 0.7, most of 60 coarse paths were refused again.
const FINER: f64 = 0.2;

/// Share of a refused step that an error message suggests if the motion reaches the Nyquist frequency: a least-jerk
/// motion of 25 samples needs it.
pub(super) const OF_NYQUIST: f64 = 0.1;

/// The motion over the widest band of loads that converges and that the samples resolve, with levels from the widest to
/// the narrowest. Its error includes the change to the next narrower band, except for the widest level. Errors that are
/// not `of_band` do not lead to a narrower band.
pub(super) fn over_widest_band<L: Copy, T>(
    levels: &[L],
    iterated: impl Fn(L) -> Result<T, ElasticaError>,
    of_band: impl Fn(&ElasticaError) -> bool,
    add_error: impl Fn(&mut T, T),
) -> Result<T, ElasticaError> {
    let is_of_band = |error: &ElasticaError| {
        matches!(error, ElasticaError::Diverges { .. }) || error.is_of_step() && of_band(error)
    };
    let mut refused = ElasticaError::Diverges { iterations: 0, change: f64::NAN };
    for (number, level) in levels[..levels.len() - 1].iter().enumerate() {
        match iterated(*level) {
            Ok(motion) if number == 0 => return Ok(motion),
            Ok(mut motion) => match iterated(levels[number + 1]) {
                Ok(narrower) => {
                    add_error(&mut motion, narrower);
                    return Ok(motion);
                }
                Err(error) if is_of_band(&error) => refused = error,
                Err(error) => return Err(error),
            },
            Err(error) if is_of_band(&error) => refused = error,
            Err(error) => return Err(error),
        }
    }
    Err(refused)
}

/// Ratio of an iteration's change to the change before.
///
/// # Errors
/// [`ElasticaError::Diverges`] if the changes do not fall, or not fast enough for this band.
pub(super) fn factor_of(
    [last, change]: [f64; 2],
    iterations: usize,
    (tolerance, negligible): (f64, f64),
) -> Result<f64, ElasticaError> {
    let factor = if change == 0.0 { 0.0 } else { change / last };
    let most = if negligible < MOST_NEGLIGIBLE { SLOW } else { 1.0 };
    if !change.is_finite() || iterations > 3 && factor >= most && change > tolerance {
        return Err(ElasticaError::Diverges { iterations, change });
    }
    Ok(factor)
}

/// Sum of the changes by all further iterations, if each is `factor` times the one before.
pub(super) fn further(change: f64, factor: f64) -> f64 {
    change * factor / (1.0 - factor).max(0.01)
}

/// Refuses samples too far apart, and links that are not derived. `is_exact` means weight, second order or further
/// links, for which fewer links are derived.
pub(super) fn check(
    model: &dyn Model,
    chord: &ChordPeriod,
    is_exact: bool,
) -> Result<(), ElasticaError> {
    let refused = |what, known| Err(ElasticaError::NotDerived { what, known });
    let law = model.law();
    if chord.reaches_nyquist(model.mesh().length_m()) {
        return Err(long_step(chord.step_s, OF_NYQUIST));
    }
    if model.kept_modes() != KeptModes::All {
        return refused(
            "the link is reduced to its first modes (analysis.modes)",
            "with all modes",
        );
    }
    if is_exact && model.mesh().has_shear() {
        return refused("the link has shear and rotary inertia", "without them");
    }
    if law.mass_rate_per_s() != 0.0 {
        return refused("the damping drags every mass (alpha)", "with alpha = 0");
    }
    if law.is_modal() && is_exact {
        return refused("the damping is set mode by mode", "with hysteretic or rayleigh damping");
    }
    Ok(())
}

/// Error for a step, with about this share of it as a remedy.
pub(super) fn long_step(step_s: f64, share: f64) -> ElasticaError {
    ElasticaError::LongStep { step_s, most_s: share * step_s }
}

impl LinkOnChord<'_> {
    /// Number of bins up to the last one whose torque counts for the second order.
    ///
    /// # Errors
    /// [`ElasticaError::LongStep`] if the samples do not resolve them.
    pub(super) fn band_of_loads(
        &self,
        answers: &[LoadedMotion<Complex64>],
        negligible: f64,
    ) -> Result<usize, ElasticaError> {
        let band = band(answers, negligible, (self.model.mesh(), self.round_off_n_m));
        let most = (self.chord.len() / 4).max(2);
        let share = FINER * most as f64 / band as f64;
        if band < most { Ok(band) } else { Err(long_step(self.chord.step_s, share)) }
    }
}
