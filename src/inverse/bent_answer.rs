//! The answer of a bent link over one period.

use std::ops::Range;
use std::sync::Arc;

use super::analysis::Unwatched;
use super::curves::{Curves, Shape};
use super::periodic_answer::PeriodicAnswer;
use super::spectra::{DrivenModel, HubSpectra};
use crate::elastica::{ElasticaMotion, SecondOrder};
use crate::model::Model;
use crate::motion::TipPeriod;

/// What was found of the second order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondOrderFindings {
    /// What was counted.
    pub order: SecondOrder,
    /// Number of iterations.
    pub iterations: usize,
    /// Change of the torque by the last iteration over that by the one before.
    pub contraction: Option<f64>,
    /// Largest slope |w'| of the link from its chord.
    pub largest_slope: f64,
    /// What the second order changed of the torque, over its range.
    pub torque_change: f64,
    /// What the terms that were not counted change of the torque, over its range: none where all were counted, and
    /// none within where the motion is refused with all of them.
    pub left_out: Option<Option<f64>>,
}

/// What a solution holds of a bent link beside its histories.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bent {
    pub(super) findings: SecondOrderFindings,
    /// Places of the nodes over the period.
    pub(super) shape: Shape,
}

/// The answer over one period.
pub(super) struct BentAnswer {
    pub(super) period: Arc<TipPeriod>,
    pub(super) motion: ElasticaMotion,
    /// Samples in which the chord returns, with the rest on either side; without weight it is empty.
    pub(super) returning: Range<usize>,
}

impl BentAnswer {
    /// Samples of the period less what they are at rest before the motion and after it; while the chord returns, 0.
    pub(super) fn beyond_rest(&self, samples: &[f64], rests: [f64; 2]) -> Vec<f64> {
        let beyond = samples.iter().enumerate().map(|(k, value)| match k {
            _ if self.returning.contains(&k) => 0.0,
            _ if k < self.until() => value - rests[1],
            _ => value - rests[0],
        });
        beyond.collect()
    }

    /// The same as amplitudes at hub and motor.
    pub(super) fn periodic(&self, model: &dyn Model) -> PeriodicAnswer {
        let pair = &self.period.spectrum.pair;
        let hub = HubSpectra {
            torque_n_m: pair.amplitudes(&self.motion.torque_n_m),
            excess_angle_rad: pair.amplitudes(&self.motion.hub_slope_rad),
            root_moment_n_m: pair.amplitudes(&self.motion.moments_n_m[0]),
            blocked_hz: None,
        };
        let motor = self.driven(model).motor_spectra(&hub);
        PeriodicAnswer::new(hub, motor.as_ref(), Arc::clone(&self.period))
    }

    fn driven<'a>(&'a self, model: &'a dyn Model) -> DrivenModel<'a> {
        DrivenModel { model, period: &self.period, watch: &Unwatched }
    }

    /// Histories of all quantities outside the chord's return, from its end on.
    pub(super) fn curves(
        &self,
        model: &dyn Model,
        second_order: SecondOrder,
        nodes: &[usize],
    ) -> Curves {
        self.curves_by(model, second_order, nodes, &|values| self.outside_return(values))
    }

    /// Histories of all quantities over the samples of the motion itself.
    pub(super) fn curves_of_motion(
        &self,
        model: &dyn Model,
        second_order: SecondOrder,
        nodes: &[usize],
        given: usize,
    ) -> Curves {
        self.curves_by(model, second_order, nodes, &|values| values[..given].to_vec())
    }

    fn curves_by(
        &self,
        model: &dyn Model,
        second_order: SecondOrder,
        nodes: &[usize],
        chronological: &dyn Fn(&[f64]) -> Vec<f64>,
    ) -> Curves {
        let answer = self.periodic(model);
        let (tip, length_m) = (&self.period.histories, model.mesh().length_m());
        let with_chord = |order: usize, of_tip: &[f64]| -> Vec<f64> {
            let pairs = answer.excess(order).iter().zip(of_tip);
            let all: Vec<f64> = pairs.map(|(excess, tip)| excess + tip / length_m).collect();
            chronological(&all)
        };
        let nodes_m = model.mesh().nodes_m();
        let displacement = |node: &usize| {
            let arcs = Shape::arc_m(&self.motion, second_order, nodes_m, *node);
            let share = nodes_m[*node] / length_m;
            let all: Vec<f64> =
                arcs.iter().zip(&tip.displacement_m).map(|(arc, tip)| arc + share * tip).collect();
            chronological(&all)
        };
        Curves {
            torque_n_m: chronological(&self.motion.torque_n_m),
            hub_angle_rad: with_chord(0, &tip.displacement_m),
            hub_rate_rad_s: with_chord(1, &tip.velocity_m_s),
            hub_acceleration_rad_s2: with_chord(2, &tip.acceleration_m_s2),
            displacement_m: nodes.iter().map(displacement).collect(),
            moment_n_m: nodes.iter().map(|k| chronological(&self.motion.moments_n_m[*k])).collect(),
            motor: self.driven(model).motor_spectra(&answer.hub).map(|motor| {
                let pair = &self.period.spectrum.pair;
                [motor.torque_n_m, motor.rate_rad_s].map(|of| chronological(&pair.samples(of)))
            }),
        }
    }

    /// Samples of a period outside the chord's return, from its end on.
    pub(super) fn outside_return(&self, values: &[f64]) -> Vec<f64> {
        values[self.start()..].iter().chain(&values[..self.until()]).copied().collect()
    }

    /// Over how many samples rest is measured before the motion and after it: as many as around a seam, within half
    /// of what is there.
    pub(super) fn reaches(&self, given: usize) -> [usize; 2] {
        let spectrum = &self.period.spectrum;
        let there = [spectrum.pair.len() - self.start(), self.until().saturating_sub(given)];
        there.map(|samples| spectrum.seam_reach().min(samples / 2).max(1))
    }

    /// The same period with another motion.
    pub(super) fn with_motion(&self, motion: &ElasticaMotion) -> Self {
        let (period, returning) = (Arc::clone(&self.period), self.returning.clone());
        Self { period, motion: motion.clone(), returning }
    }

    /// First sample of a time before the motion, where no chord returns.
    fn start(&self) -> usize {
        if self.returning.is_empty() { self.period.spectrum.seam } else { self.returning.end }
    }

    /// First sample that is not of a time after the motion.
    fn until(&self) -> usize {
        if self.returning.is_empty() { self.period.spectrum.seam } else { self.returning.start }
    }
}
