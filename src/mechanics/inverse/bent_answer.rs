//! The answer of a bent link over one period.

use std::sync::Arc;

use super::analysis::Unwatched;
use super::curves::{Curves, Shape};
use super::periodic_answer::PeriodicAnswer;
use super::rest::Rest;
use super::solution::SecondOrderFindings;
use super::spectra::{DrivenModel, HubSpectra};
use crate::elastica::{ChordPeriod, ElasticaMotion, Followed, SecondOrder};
use crate::model::Model;
use crate::motion::TipPeriod;

/// Results of a bent link beside its histories.
pub(super) struct Bent {
    pub(super) findings: SecondOrderFindings,
    /// Largest slope |w'| of the link from its chord.
    pub(super) largest_slope: f64,
    /// Places of the nodes over the period.
    pub(super) shape: Shape,
}

/// Puts some or all samples of the period in the order of time.
type Chronological<'a> = &'a dyn Fn(&[f64]) -> Vec<f64>;

/// The answer over one period.
pub(super) struct BentAnswer {
    pub(super) period: Arc<TipPeriod>,
    pub(super) chord: ChordPeriod,
    pub(super) found: Followed,
    pub(super) rest: Rest,
}

impl BentAnswer {
    /// The answer as amplitudes at hub and motor.
    pub(super) fn periodic(&self, model: &dyn Model) -> PeriodicAnswer {
        self.periodic_of(&self.found.motion, model)
    }

    fn periodic_of(&self, motion: &ElasticaMotion, model: &dyn Model) -> PeriodicAnswer {
        let pair = &self.period.spectrum.pair;
        let hub = HubSpectra {
            torque_n_m: pair.amplitudes(&motion.torque_n_m),
            excess_angle_rad: pair.amplitudes(&motion.hub_slope_rad),
            root_moment_n_m: pair.amplitudes(&motion.moments_n_m[0]),
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
        self.curves_of(&self.found.motion, model, second_order, nodes)
    }

    /// [`Self::curves`] of another approximation of the motion.
    pub(super) fn curves_of(
        &self,
        motion: &ElasticaMotion,
        model: &dyn Model,
        second_order: SecondOrder,
        nodes: &[usize],
    ) -> Curves {
        let outside = |values: &[f64]| self.rest.outside_return(values);
        self.curves_by((motion, &outside), model, second_order, nodes)
    }

    /// Histories of all quantities over the samples of the motion itself.
    pub(super) fn curves_of_motion(
        &self,
        model: &dyn Model,
        second_order: SecondOrder,
        nodes: &[usize],
        given: usize,
    ) -> Curves {
        let own = |values: &[f64]| values[..given].to_vec();
        self.curves_by((&self.found.motion, &own), model, second_order, nodes)
    }

    fn curves_by(
        &self,
        (motion, chronological): (&ElasticaMotion, Chronological<'_>),
        model: &dyn Model,
        second_order: SecondOrder,
        nodes: &[usize],
    ) -> Curves {
        let answer = self.periodic_of(motion, model);
        let (tip, length_m) = (&self.period.histories, model.mesh().length_m());
        let with_chord = |order: usize, of_tip: &[f64]| -> Vec<f64> {
            let pairs = answer.excess(order).iter().zip(of_tip);
            let all: Vec<f64> = pairs.map(|(excess, tip)| excess + tip / length_m).collect();
            chronological(&all)
        };
        let nodes_m = model.mesh().nodes_m();
        let displacement = |node: &usize| {
            let arcs = Shape::arc_m(motion, second_order, nodes_m, *node);
            let share = nodes_m[*node] / length_m;
            let all: Vec<f64> =
                arcs.iter().zip(&tip.displacement_m).map(|(arc, tip)| arc + share * tip).collect();
            chronological(&all)
        };
        Curves {
            torque_n_m: chronological(&motion.torque_n_m),
            hub_angle_rad: with_chord(0, &tip.displacement_m),
            hub_rate_rad_s: with_chord(1, &tip.velocity_m_s),
            hub_acceleration_rad_s2: with_chord(2, &tip.acceleration_m_s2),
            displacement_m: nodes.iter().map(displacement).collect(),
            moment_n_m: nodes.iter().map(|k| chronological(&motion.moments_n_m[*k])).collect(),
            motor: self.driven(model).motor_spectra(&answer.hub).map(|motor| {
                let pair = &self.period.spectrum.pair;
                [motor.torque_n_m, motor.rate_rad_s].map(|of| chronological(&pair.samples(of)))
            }),
        }
    }
}
