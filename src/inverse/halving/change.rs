use num_complex::Complex64;

use super::sampled::{Estimate, SampledChange};
use crate::inverse::dynamics::KeptModes;
use crate::inverse::error::InversionError;
use crate::inverse::spectra::Forcing;
use crate::modal::{carries_rotary_inertia, modes_below};
use crate::numeric::largest;

/// Intervals that the first quintics span at least: 48 frequencies at their ends, and then 47 between
/// them, just fill vectors of sixteen.
pub(super) const FEWEST_INTERVALS: usize = 47;

/// What the interpolation from half as many frequencies may be wrong by, over the largest change.
const WRONG: f64 = 4e-2;

/// Change of the torque in N m over the period from a mesh to another, `torque_n_m` being the
/// amplitudes on the former.
///
/// # Errors
/// [`InversionError::NotFinite`] on the latter.
pub(in crate::inverse) fn change_n_m(
    from: Forcing<'_>,
    to: Forcing<'_>,
    torque_n_m: &[Complex64],
) -> Result<Vec<f64>, InversionError> {
    let pair = &to.spectrum.pair;
    if let Some(samples) = interpolated_change_n_m(from, to, torque_n_m.len()) {
        return Ok(samples);
    }
    let finer = to.hub_spectra()?.torque_n_m;
    let change: Vec<_> = finer.iter().zip(torque_n_m).map(|(to, from)| to - from).collect();
    Ok(pair.samples(change))
}

/// The change from few of the bins; none where these do not suffice.
pub(super) fn interpolated_change_n_m(
    from: Forcing<'_>,
    to: Forcing<'_>,
    bins: usize,
) -> Option<Vec<f64>> {
    let dynamics = from.dynamics;
    let is_smooth =
        dynamics.kept_modes() == KeptModes::All && !carries_rotary_inertia(dynamics.mesh());
    // Two meshes are solved at every sample: with half as many samples as bins all is won.
    let pays = |intervals: usize| 2 * intervals < bins / 2;
    if !is_smooth || !pays(FEWEST_INTERVALS) {
        return None;
    }
    let fewest = modes_below(to.dynamics.mesh(), to.last_rad_s()).max(FEWEST_INTERVALS);
    if !pays(fewest) {
        return None;
    }
    let mut change = SampledChange::new(from, to, fewest);
    while pays(change.intervals()) {
        let Estimate { wrong_n_m, change_n_m } = change.doubled();
        // No change is larger than its amplitudes add up to, which is faster found.
        if wrong_n_m <= WRONG * change_n_m {
            let samples = to.spectrum.pair.samples(change.amplitudes_n_m());
            if wrong_n_m <= WRONG * largest(&samples) {
                return Some(samples);
            }
        }
    }
    None
}
