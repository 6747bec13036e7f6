//! The sag of a link under its weight, as if at rest, which hysteretic damping leaves alone.
//!
//! Its complex part has the sign of ω: a weight that changes its direction from one rest to another would leave a
//! logarithm of time, and the link would never settle. So that part acts on what the link bends beyond its sag, by the
//! loads `2iξ K w_sag` beside its weight.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector4;
use num_complex::Complex64;
use rayon::prelude::*;

use super::chord::{ChordPeriod, ElasticaError};
use crate::beam::Mesh;
use crate::numeric::extremes;

/// Directions of the chord at which the sag is computed, until the polynomial through them is exact between them; the
/// sag is the same after a whole turn, so that more is not needed.
const DIRECTIONS: [usize; 3] = [32, 64, 128];

/// Largest error of the sag's loads between two directions, over the largest of them; they act times 2ξ.
const EXACT: f64 = 1e-6;

/// A chord that turns by less is at rest.
const AT_REST_RAD: f64 = 1e-9;

/// Tolerance of the sag's iteration.
pub(super) const TOLERANCE: f64 = 1e-9;

/// Amplitudes of `K w_sag` at every bin: force in N and moment in N m for each node in turn.
pub(super) struct Sag {
    loads: Vec<Vec<Complex64>>,
}

impl Sag {
    /// None for a chord at rest, whose loads have no frequency but zero. `rest` gives the deflection in m and slope of
    /// each node where the chord rests.
    ///
    /// # Errors
    /// [`ElasticaError`] of a link that has no rest.
    pub(super) fn of(
        mesh: &Mesh,
        chord: &ChordPeriod,
        rest: impl Fn(&ChordPeriod) -> Result<Vec<f64>, ElasticaError> + Sync,
    ) -> Result<Option<Self>, ElasticaError> {
        let ends = extremes(&chord.angle_rad);
        if ends[1] - ends[0] < 2.0 * AT_REST_RAD {
            return Ok(None);
        }
        let is_turned = ends[1] - ends[0] > TAU;
        let ends = if is_turned { [0.0, TAU] } else { ends };
        let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
        let at = |place: f64| {
            let chord = ChordPeriod::at_rest(middle + half * place, chord.gravity_m_s2)?;
            Ok(bending_loads(mesh, &rest(&chord)?))
        };
        for count in DIRECTIONS {
            let through = Interpolation::through(count, &at)?;
            if through.error(&at)? > EXACT {
                continue;
            }
            let places: Vec<f64> = (chord.angle_rad.iter())
                .map(|angle| if is_turned { angle.rem_euclid(TAU) } else { *angle })
                .map(|angle| (angle - middle) / half)
                .collect();
            let histories = through.histories(&places);
            let loads = histories.into_par_iter().map(|history| chord.pair.amplitudes(history));
            return Ok(Some(Self { loads: loads.collect() }));
        }
        Err(ElasticaError::Sag)
    }

    /// Adds the loads at a bin, times a factor.
    pub(super) fn add(&self, bin: usize, factor: Complex64, nodal: &mut [[Complex64; 2]]) {
        for (load, amplitudes) in nodal.as_flattened_mut().iter_mut().zip(&self.loads) {
            *load += factor * amplitudes[bin];
        }
    }
}

/// `K w`: force in N and moment in N m on each node in turn.
fn bending_loads(mesh: &Mesh, dofs: &[f64]) -> Vec<f64> {
    let mut loads = vec![0.0; dofs.len()];
    for (k, element) in mesh.elements().iter().enumerate() {
        let own = element.stiffness() * Vector4::from_column_slice(&dofs[2 * k..2 * k + 4]);
        for (load, own) in loads[2 * k..2 * k + 4].iter_mut().zip(&own) {
            *load += own;
        }
    }
    loads
}

/// Loads as polynomials through Chebyshev's points of the second kind in [−1, 1].
struct Interpolation {
    places: Vec<f64>,
    /// At each place those of all nodes.
    loads: Vec<Vec<f64>>,
}

/// Loads at a place.
type Loads<'a> = &'a (dyn Fn(f64) -> Result<Vec<f64>, ElasticaError> + Sync);

impl Interpolation {
    fn through(count: usize, at: Loads<'_>) -> Result<Self, ElasticaError> {
        let place = |k: usize| libm::cos(PI * k as f64 / (count - 1) as f64);
        let places: Vec<f64> = (0..count).map(place).collect();
        let loads = places.par_iter().map(|place| at(*place)).collect::<Result<_, _>>()?;
        Ok(Self { places, loads })
    }

    /// Largest error in the middle between two points in the widest gap, and in one beside it, over the largest load.
    fn error(&self, at: Loads<'_>) -> Result<f64, ElasticaError> {
        let largest = self.loads.iter().flatten().map(|load| load.abs()).fold(0.0, f64::max);
        let middle = self.places.len() / 2;
        let mut error = 0.0;
        for k in [middle, middle + 1] {
            let place = 0.5 * (self.places[k - 1] + self.places[k]);
            let between = self.histories(&[place]);
            for (exact, found) in at(place)?.iter().zip(between) {
                error = f64::max(error, (exact - found[0]).abs());
            }
        }
        Ok(if error == 0.0 { 0.0 } else { error / largest })
    }

    /// Each load at some places.
    fn histories(&self, places: &[f64]) -> Vec<Vec<f64>> {
        let weights: Vec<Vec<f64>> =
            places.par_iter().map(|place| weights(&self.places, *place)).collect();
        let dofs = 0..self.loads[0].len();
        let history = |dof: usize| {
            let at = |weights: &Vec<f64>| {
                weights.iter().zip(&self.loads).map(|(weight, loads)| weight * loads[dof]).sum()
            };
            weights.iter().map(at).collect()
        };
        dofs.into_par_iter().map(history).collect()
    }
}

/// What each of the values at some places counts at another place in [−1, 1].
fn weights(places: &[f64], at: f64) -> Vec<f64> {
    if let Some(same) = places.iter().position(|place| (place - at).abs() < f64::MIN_POSITIVE) {
        return (0..places.len()).map(|k| f64::from(u8::from(k == same))).collect();
    }
    let last = places.len() - 1;
    let parts: Vec<f64> = places
        .iter()
        .enumerate()
        .map(|(k, place)| {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            let end = if k == 0 || k == last { 0.5 } else { 1.0 };
            sign * end / (at - place)
        })
        .collect();
    let sum: f64 = parts.iter().sum();
    parts.iter().map(|part| part / sum).collect()
}
