use std::f64::consts::TAU;

use crate::beam::Mesh;
use crate::modal::{ModalBasis, flexible_modes, modes_below, natural_frequencies};
use crate::numeric::{FourierPair, TimeGrid, angular_frequency, fast_length, magnitude};

/// Share of the motion that may lie above the frequency up to which modes answer dynamically.
const NEGLIGIBLE: f64 = 1e-12;

/// Modes are kept up to this factor above that frequency: beyond, they follow the torque statically
/// to within (1/factor)² of their small share, and their common residual mode follows that too.
const REACH: f64 = 4.0;

/// The band counts as at least this many first natural frequencies: a torque with a jump, or with
/// corners between its samples, holds more than its samples show.
const LEAST_BAND: f64 = 10.0;

/// Most modes that are kept.
const MOST_MODES: usize = 500;

/// Which modes a torque moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeSelection {
    /// Flexible modes kept; those beyond answer together as one residual mode.
    pub modes: usize,
    /// Flexible modes of the mesh.
    pub of: usize,
    /// Frequency in Hz above which the torque moves a rigid link by less than a share of 1e-12.
    pub torque_band_hz: f64,
    /// Frequency in Hz of the highest mode kept.
    pub highest_hz: f64,
}

/// Frequency in rad/s above which a torque of these samples has next to no part in the motion.
///
/// A torque's amplitude T̂ moves a rigid link by T̂/(Iω²): these shares are summed from the Nyquist
/// frequency down until they matter beside the whole motion. None for a torque that is zero.
pub(super) fn torque_band_rad_s(grid: &TimeGrid, samples: &[f64]) -> Option<f64> {
    let whole = largest_excursion(samples) * grid.step_s.powi(2);
    if whole == 0.0 {
        return None;
    }
    let len = fast_length(2 * grid.len);
    let pair = FourierPair::new(len);
    let mut padded = samples.to_vec();
    padded.resize(len, 0.0);
    let amplitudes = pair.amplitudes(padded);
    let omega = |k: usize| angular_frequency(k, len, grid.step_s);
    let mut above = 0.0;
    for k in (1..amplitudes.len()).rev() {
        above += 2.0 * magnitude(amplitudes[k]) / omega(k).powi(2);
        if above > NEGLIGIBLE * whole {
            return Some(omega(k));
        }
    }
    Some(omega(1))
}

/// Largest |∬ T dt dt| over the squared step.
fn largest_excursion(samples: &[f64]) -> f64 {
    let (mut rate, mut angle, mut largest) = (0.0, 0.0, 0.0_f64);
    for torque in samples {
        rate += torque;
        angle += rate;
        largest = largest.max(angle.abs());
    }
    largest
}

/// The modes of `mesh` that a torque of this band moves.
pub(super) fn kept_modes(mesh: &Mesh, band_rad_s: f64) -> (ModalBasis, ModeSelection) {
    // The rigid rotation is below every frequency.
    let least = natural_frequencies(mesh, 1).first().map_or(0.0, |first| LEAST_BAND * first);
    let reach = REACH * band_rad_s.max(least);
    let wanted = modes_below(mesh, reach).saturating_sub(1).clamp(1, MOST_MODES);
    let basis = ModalBasis::lowest(mesh, wanted);
    let highest = basis.modes.last().map_or(0.0, |mode| mode.omega_rad_s);
    let selection = ModeSelection {
        modes: basis.modes.len(),
        of: flexible_modes(mesh),
        torque_band_hz: band_rad_s / TAU,
        highest_hz: highest / TAU,
    };
    (basis, selection)
}
