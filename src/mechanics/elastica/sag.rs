//! Sag of a link under its weight, as if at rest, which is exempt from hysteretic damping.
//!
//! The complex part of the stiffness has the sign of ω: a weight whose direction changes from one rest to another would
//! leave a logarithm of time, and the link would never settle. So this part acts only on the bending beyond the sag, by
//! the loads `2iξ K w_sag` besides the weight.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use nalgebra::Vector4;
use num_complex::Complex64;
use rayon::prelude::*;

use super::chord::{ChordPeriod, TipLoad};
use super::error::ElasticaError;
use super::kinematics::ArmPeriod;
use super::loads::{BentLink, Instant, Scratch, SecondOrder};
use crate::beam::{Loads, Mesh};
use crate::model::Model;
use crate::numeric::{FourierPair, Size, extremes};
use crate::system::end_if_stopped;

/// Numbers of directions of the chord for the sag, increased until the polynomial through them is exact between them.
/// The sag repeats after a whole turn, so that no more are needed.
const DIRECTIONS: [usize; 3] = [32, 64, 128];

/// Largest error of the sag's loads between two directions, relative to the largest load; the loads have the factor 2ξ.
const EXACT: f64 = 1e-6;

/// Turn of a chord below which it is at rest.
const AT_REST_RAD: f64 = 1e-9;

/// Tolerance of the sag's iteration.
pub(super) const TOLERANCE: f64 = 1e-9;

/// Limit of iterations for an arm at rest.
const MOST_ITERATIONS: usize = 100;

/// Number of samples of an arm's period whose sags are computed in sequence, each from the one before.
const CHUNK: usize = 32;

/// Negligible share of the amplitudes of the chords' directions, all added up.
const UNSEEN: f64 = 1e-9;

/// Amplitudes of `K w_sag` at every bin: force in N and moment in N m for each node in turn.
pub(super) struct Sag {
    loads: Vec<Vec<Complex64>>,
}

impl Sag {
    /// Sag on a moving chord; `None` for a chord at rest, whose loads have only zero frequency. `rest` computes
    /// deflection in m and slope of each node on a chord at rest.
    ///
    /// # Errors
    /// [`ElasticaError`] for a link without a rest position.
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
            *load += factor * amplitudes.get(bin).copied().unwrap_or_default();
        }
    }

    /// Sags of the links of an arm, each with its chord in the direction of the rigid arm, and with the next link's
    /// load at rest.
    ///
    /// # Errors
    /// [`ElasticaError`] for an arm without a rest position.
    pub(super) fn of_arm(
        models: &[Arc<dyn Model>],
        arm: &ArmPeriod,
        second_order: SecondOrder,
    ) -> Result<Vec<Self>, ElasticaError> {
        let links: Vec<_> =
            models.iter().map(|model| (&**model, BentLink::of(&**model, second_order))).collect();
        let masses_kg = links.iter().map(|(_, shape)| shape.straight().mass_kg).collect();
        let resting = RestingArm { links, masses_kg, arm, second_order };
        let stride = arm.stride(UNSEEN);
        let pair = FourierPair::new(arm.len() / stride);
        let chunks: Vec<usize> = (0..pair.len()).step_by(CHUNK).collect();
        let of_chunk = |from: &usize| -> Result<Vec<Vec<f64>>, ElasticaError> {
            let mut bent: Vec<_> =
                models.iter().map(|model| vec![0.0; 2 * model.mesh().nodes_m().len()]).collect();
            let mut found: Vec<Vec<f64>> = Vec::new();
            for k in *from..pair.len().min(from + CHUNK) {
                end_if_stopped();
                if found.is_empty() || !arm.rests(k * stride, (k - 1) * stride) {
                    resting.settle(k * stride, &mut bent)?;
                }
                let loads = models.iter().zip(&bent).map(|(m, w)| bending_loads(m.mesh(), w));
                found.push(loads.flatten().collect());
            }
            Ok(found)
        };
        let rows = chunks.par_iter().map(of_chunk).collect::<Result<Vec<_>, _>>()?.concat();
        let mut columns = 0..rows[0].len();
        let sags = models.iter().map(|model| {
            let own = columns.by_ref().take(2 * model.mesh().nodes_m().len());
            let history = |column: usize| rows.iter().map(|row| row[column]).collect::<Vec<_>>();
            Self { loads: own.map(|column| pair.amplitudes(history(column))).collect() }
        });
        Ok(sags.collect())
    }
}

/// An arm under its weight, at rest at one sample of its period.
struct RestingArm<'a> {
    links: Vec<(&'a dyn Model, BentLink)>,
    masses_kg: Vec<f64>,
    arm: &'a ArmPeriod,
    second_order: SecondOrder,
}

impl RestingArm<'_> {
    /// Finds (w, w') of all nodes of each link, starting from `bent`.
    fn settle(&self, sample: usize, bent: &mut [Vec<f64>]) -> Result<(), ElasticaError> {
        let mut change = f64::INFINITY;
        for _ in 0..MOST_ITERATIONS {
            let (mut load, mut largest) = (([0.0; 2], 0.0), 0.0);
            change = 0.0;
            for link in (0..self.links.len()).rev() {
                let rested = self.rested(link, self.arm.axes(link, sample), load, &bent[link]);
                let changes =
                    rested.bent.iter().zip(&bent[link]).map(|(new, old)| (new - old).abs());
                change = changes.fold(change, f64::larger);
                largest = rested.bent.iter().map(|w| w.abs()).fold(largest, f64::larger);
                load = rested.load;
                bent[link] = rested.bent;
            }
            if change <= TOLERANCE * largest {
                return Ok(());
            }
        }
        Err(ElasticaError::Diverges { iterations: MOST_ITERATIONS, change })
    }

    /// One link under its weight and the force (along x and y) and torque that support the next link.
    fn rested(
        &self,
        link: usize,
        [along, across]: [[f64; 2]; 2],
        (force_n, torque_n_m): ([f64; 2], f64),
        bent: &[f64],
    ) -> Rested {
        let (model, shape) = &self.links[link];
        let still = vec![0.0; bent.len()];
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let gravity = self.arm.gravity_m_s2;
        let tip =
            TipLoad { along_n: -dot(force_n, along), across_n: -dot(force_n, across), torque_n_m };
        let now = |w| Instant {
            w,
            rate: &still,
            acceleration: &still,
            chord_rate_rad_s: 0.0,
            chord_acceleration_rad_s2: 0.0,
            along_m_s2: -dot(gravity, along),
            across_m_s2: -dot(gravity, across),
            tip,
        };
        let mut loads = vec![0.0; shape.columns()];
        if self.second_order != SecondOrder::None {
            shape.write(&now(bent), &mut Scratch::default(), &mut loads);
        }
        loads.truncate(bent.len());
        let last = loads.len() - 2;
        loads[last] += tip.across_n;
        loads[last + 1] -= tip.torque_n_m;
        let loads = Loads {
            axis_m_s2: Complex64::from(-dot(gravity, across)),
            chord_rad_s2: Complex64::ZERO,
            nodal: loads.chunks(2).map(|node| [node[0].into(), node[1].into()]).collect(),
        };
        let found = model.loaded_motion(0.0, &loads);
        let bent: Vec<f64> = found.deflections.as_flattened().iter().map(|w| w.re).collect();
        let cosine = match self.second_order {
            SecondOrder::Full => (1.0 - bent[1] * bent[1]).sqrt(),
            _ => 1.0,
        };
        let force_n = [0, 1].map(|axis| force_n[axis] - self.masses_kg[link] * gravity[axis]);
        Rested { load: (force_n, found.torque_n_m.re * cosine), bent }
    }
}

/// Load of a link at rest on the one before, and its bending.
struct Rested {
    load: ([f64; 2], f64),
    bent: Vec<f64>,
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

/// Loads as polynomials through Chebyshev points of the second kind in [−1, 1].
struct Interpolation {
    places: Vec<f64>,
    /// Loads of all nodes at each place.
    loads: Vec<Vec<f64>>,
}

/// Loads at a place.
type LoadsAt<'a> = &'a (dyn Fn(f64) -> Result<Vec<f64>, ElasticaError> + Sync);

impl Interpolation {
    fn through(count: usize, at: LoadsAt<'_>) -> Result<Self, ElasticaError> {
        let place = |k: usize| libm::cos(PI * k as f64 / (count - 1) as f64);
        let places: Vec<f64> = (0..count).map(place).collect();
        let loads = places.par_iter().map(|place| at(*place)).collect::<Result<_, _>>()?;
        Ok(Self { places, loads })
    }

    /// Largest error in the middle of the widest gap between points and of the next gap, relative to the largest load.
    fn error(&self, at: LoadsAt<'_>) -> Result<f64, ElasticaError> {
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

/// Weights of the values at some places for interpolation at another place in [−1, 1].
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
