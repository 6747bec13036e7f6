//! What many of these tests need: a mesh of so many elements, motions of the tip from rest to rest, and how far two
//! histories are apart.

use std::f64::consts::{PI, TAU};

use flexlink::beam::{ElementCount, Mesh, MeshPlan};
use flexlink::inverse::Analysis;
use flexlink::link::Link;
use flexlink::motion::{MotionColumns, TipMotion};
use num_complex::Complex64;

/// So many elements of a link, none of its segments with a number of its own.
pub(crate) fn plan_of(link: &Link, elements: usize) -> MeshPlan {
    let own = vec![None; link.segments().len()];
    MeshPlan::new(link, &own, Some(ElementCount::Total(elements)), 1e-6).expect("a valid plan")
}

pub(crate) fn mesh_of(link: &Link, elements: usize) -> Mesh {
    Mesh::new(link, &plan_of(link, elements)).expect("a plan of the link")
}

/// The analysis with every frequency of the samples, where a law is to hold to the last digits.
pub(crate) fn whole_band(analysis: Analysis) -> Analysis {
    analysis.with_tip_tolerance(0.0).expect("a tolerance")
}

/// Tip velocity that rises and falls as sin⁶ over a time: five continuous derivatives of the
/// acceleration, so that its spectrum ends far below the Nyquist frequency.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Smooth {
    pub travel_m: f64,
    pub duration_s: f64,
    /// Steps of the motion itself.
    pub steps: u32,
    /// Samples of rest before and after it.
    pub rest: [u32; 2],
}

impl Smooth {
    pub(crate) const MOVE: Self = Self { travel_m: 0.5, duration_s: 1.0, steps: 256, rest: [0, 0] };
    /// A move that bends the link little.
    pub(crate) const SHORT: Self = Self { travel_m: 0.2, ..Self::MOVE };

    pub(crate) fn step_s(&self) -> f64 {
        self.duration_s / f64::from(self.steps)
    }

    /// Phase πt/T of every sample, 0 and π in the rest, and its time; the motion starts at 0 s.
    fn phases(&self) -> Vec<(f64, f64)> {
        let [before, after] = self.rest.map(i64::from);
        let steps = i64::from(self.steps);
        let samples = -before..=steps + after;
        let at = |k: i64| {
            let phase = PI * k.clamp(0, steps) as f64 / steps as f64;
            (k as f64 * self.step_s(), phase)
        };
        samples.map(at).collect()
    }

    pub(crate) fn time_s(&self) -> Vec<f64> {
        self.phases().into_iter().map(|(time_s, _)| time_s).collect()
    }

    /// a = (16/5)(D/T)(6π/T) sin⁵ cos.
    pub(crate) fn acceleration_m_s2(&self) -> Vec<f64> {
        let peak = 3.2 * 6.0 * PI * self.travel_m / self.duration_s.powi(2);
        let at = |(_, phase): (f64, f64)| peak * phase.sin().powi(5) * phase.cos();
        self.phases().into_iter().map(at).collect()
    }

    /// v = (16/5) D ∫sin⁶.
    pub(crate) fn displacement_m(&self) -> Vec<f64> {
        let at = |(_, x): (f64, f64)| {
            let waves = -15.0 * (2.0 * x).sin() + 3.0 * (4.0 * x).sin() - (6.0 * x).sin() / 3.0;
            3.2 * self.travel_m * (5.0 * x / 16.0 + waves / 64.0) / PI
        };
        self.phases().into_iter().map(at).collect()
    }

    pub(crate) fn motion(&self) -> TipMotion {
        accelerated(self.time_s(), self.acceleration_m_s2())
    }
}

pub(crate) fn accelerated(time_s: Vec<f64>, acceleration_m_s2: Vec<f64>) -> TipMotion {
    let acceleration_m_s2 = Some(acceleration_m_s2);
    TipMotion::new(MotionColumns { time_s, acceleration_m_s2, ..Default::default() })
        .expect("a motion")
}

pub(crate) fn displaced(time_s: Vec<f64>, displacement_m: Vec<f64>) -> TipMotion {
    let displacement_m = Some(displacement_m);
    TipMotion::new(MotionColumns { time_s, displacement_m, ..Default::default() })
        .expect("a motion")
}

/// One period of a sine acceleration: Bayo's motion as reconstructed.
pub(crate) fn sine(travel_m: f64, duration_s: f64, steps: u32) -> TipMotion {
    let turn = |k: u32| f64::from(k) / f64::from(steps);
    let peak = TAU * travel_m / duration_s.powi(2);
    let time_s = (0..=steps).map(|k| duration_s * turn(k)).collect();
    accelerated(time_s, (0..=steps).map(|k| peak * (TAU * turn(k)).sin()).collect())
}

pub(crate) fn peak(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// Largest difference of two histories, as far as the shorter one goes.
pub(crate) fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

/// Largest difference of two histories of one length over the peak of the second.
pub(crate) fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    apart(a, b) / peak(b)
}

/// Largest difference of complex numbers over the largest of the first.
pub(crate) fn complex_difference(a: &[Complex64], b: impl IntoIterator<Item = Complex64>) -> f64 {
    let size = a.iter().fold(0.0_f64, |size, z| size.max(z.norm()));
    a.iter().zip(b).fold(0.0_f64, |most, (a, b)| most.max((a - b).norm())) / size
}
