//! The sag of a link under its weight, as if at rest, which hysteretic damping leaves alone.
//!
//! Its complex part has the sign of ω: a weight that changes its direction from one rest to another would leave a
//! logarithm of time, and the link would never settle. So that part acts on what the link bends beyond its sag, by the
//! loads `2iξ K w_sag` beside its weight.

use nalgebra::Vector4;
use num_complex::Complex64;
use rayon::prelude::*;

use super::chord::{ChordPeriod, ElasticaError};
use crate::beam::Mesh;

/// Directions of the chord at which the sag is computed; between them it is a polynomial of the direction. Over a full
/// turn it is exact to 1e-10.
const DIRECTIONS: usize = 32;

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
        let ends =
            chord.angle_rad.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |ends, angle| {
                [ends[0].min(*angle), ends[1].max(*angle)]
            });
        let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
        if half < AT_REST_RAD {
            return Ok(None);
        }
        // Chebyshev's points of the second kind, and their weights for interpolation.
        let places: Vec<f64> = (0..DIRECTIONS)
            .map(|k| libm::cos(std::f64::consts::PI * k as f64 / (DIRECTIONS - 1) as f64))
            .collect();
        let loads_at = places
            .par_iter()
            .map(|place| {
                let at = ChordPeriod::at_rest(middle + half * place, chord.gravity_m_s2)?;
                Ok(bending_loads(mesh, &rest(&at)?))
            })
            .collect::<Result<Vec<Vec<f64>>, ElasticaError>>()?;
        let weights: Vec<Vec<f64>> = chord
            .angle_rad
            .par_iter()
            .map(|angle| weights(&places, (angle - middle) / half))
            .collect();
        let dofs = 0..loads_at[0].len();
        let loads = dofs.into_par_iter().map(|dof| {
            let at = |weights: &Vec<f64>| {
                weights.iter().zip(&loads_at).map(|(weight, loads)| weight * loads[dof]).sum()
            };
            chord.pair.amplitudes(weights.iter().map(at).collect::<Vec<f64>>())
        });
        Ok(Some(Self { loads: loads.collect() }))
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
