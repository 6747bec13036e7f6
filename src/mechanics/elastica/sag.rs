//! Sag of a link under its weight, as if at rest, which is exempt from hysteretic damping.
//!
//! The complex part of the stiffness has the sign of ω: a weight whose direction changes from one rest to another would
//! leave a logarithm of time, and the link would never settle. So this part acts only on the bending beyond the sag, by
//! the loads `2iξ K w_sag` besides the weight.

use std::sync::Arc;

use nalgebra::Vector4;
use num_complex::Complex64;
use rayon::prelude::*;

use super::chord::TipLoad;
use super::error::ElasticaError;
use super::kinematics::ArmPeriod;
use super::loads::{BentLink, Instant, Scratch, SecondOrder};
use crate::beam::{Loads, Mesh};
use crate::model::Model;
use crate::numeric::{FourierPair, Size, magnitude};
use crate::system::end_if_stopped;

/// Largest error of the sag's loads between two samples, relative to the largest load; the loads have the factor 2ξ.
const EXACT: f64 = 1e-6;

/// Tolerance of the sag's iteration.
const TOLERANCE: f64 = 1e-9;

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
        let mut stride = arm.stride(UNSEEN);
        loop {
            let sags = resting.sags(stride)?;
            if sags.iter().all(Self::is_smooth) {
                return Ok(sags);
            }
            if stride == 1 {
                return Err(ElasticaError::Sag);
            }
            stride = arm.stride_to(2 * arm.len() / stride);
        }
    }

    /// True if samples resolve the loads: in the last quarter of their frequencies, their amplitudes add up to the error
    /// of the loads between samples.
    fn is_smooth(&self) -> bool {
        let all = |loads: &[Complex64]| loads.iter().map(|load| magnitude(*load)).sum::<f64>();
        let largest = self.loads.iter().map(|loads| all(loads)).fold(0.0, f64::max);
        let last = |loads: &Vec<Complex64>| all(&loads[loads.len() - loads.len() / 4..]);
        self.loads.iter().all(|loads| last(loads) <= EXACT * largest)
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
    /// Sags of the links from every `stride`-th sample of the period.
    fn sags(&self, stride: usize) -> Result<Vec<Sag>, ElasticaError> {
        let arm = self.arm;
        let models = || self.links.iter().map(|(model, _)| *model);
        let pair = FourierPair::new(arm.len() / stride);
        let chunks: Vec<usize> = (0..pair.len()).step_by(CHUNK).collect();
        let of_chunk = |from: &usize| -> Result<Vec<Vec<f64>>, ElasticaError> {
            let mut bent: Vec<_> =
                models().map(|model| vec![0.0; 2 * model.mesh().nodes_m().len()]).collect();
            let mut rows: Vec<Vec<f64>> = Vec::new();
            for k in *from..pair.len().min(from + CHUNK) {
                end_if_stopped();
                if rows.is_empty() || !arm.rests(k * stride, (k - 1) * stride) {
                    self.settle(k * stride, &mut bent)?;
                }
                let loads = models().zip(&bent).map(|(m, w)| bending_loads(m.mesh(), w));
                rows.push(loads.flatten().collect());
            }
            Ok(rows)
        };
        let rows = chunks.par_iter().map(of_chunk).collect::<Result<Vec<_>, _>>()?.concat();
        let mut columns = 0..rows[0].len();
        let sags = models().map(|model| {
            let numbers = columns.by_ref().take(2 * model.mesh().nodes_m().len());
            let history = |column: usize| rows.iter().map(|row| row[column]).collect::<Vec<_>>();
            Sag { loads: numbers.map(|column| pair.amplitudes(history(column))).collect() }
        });
        Ok(sags.collect())
    }

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
        let motion = model.loaded_motion(0.0, &loads);
        let bent: Vec<f64> = motion.deflections.as_flattened().iter().map(|w| w.re).collect();
        let cosine = match self.second_order {
            SecondOrder::Full => (1.0 - bent[1] * bent[1]).sqrt(),
            _ => 1.0,
        };
        let force_n = [0, 1].map(|axis| force_n[axis] - self.masses_kg[link] * gravity[axis]);
        Rested { load: (force_n, motion.torque_n_m.re * cosine), bent }
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
        let forces = element.stiffness() * Vector4::from_column_slice(&dofs[2 * k..2 * k + 4]);
        for (load, force) in loads[2 * k..2 * k + 4].iter_mut().zip(&forces) {
            *load += force;
        }
    }
    loads
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn loads_that_jump_between_samples_are_not_smooth() {
        let pair = FourierPair::new(256);
        let is_smooth = |at: &dyn Fn(f64) -> f64| {
            let history = (0..256).map(|k| at(f64::from(k) / 256.0)).collect::<Vec<_>>();
            Sag { loads: vec![pair.amplitudes(history), pair.amplitudes(vec![1e-9; 256])] }
                .is_smooth()
        };
        assert!(is_smooth(&|_| 0.0));
        assert!(is_smooth(&|x| libm::sin(libm::sin(TAU * x))));
        assert!(is_smooth(&|x| libm::sin(8.0 * libm::sin(2.0 * TAU * x))));
        assert!(!is_smooth(&|x| libm::sin(40.0 * libm::sin(2.0 * TAU * x))));
        assert!(!is_smooth(&|x| f64::from(u8::from(x > 0.3)) * 1e-3 + libm::sin(TAU * x)));
    }
}
