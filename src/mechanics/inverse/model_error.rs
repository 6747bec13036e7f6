//! Errors of a linear answer: large deflections, centrifugal stiffening and the thickness.

use super::accuracy::PerQuantity;
use super::arm::{ArmProblem, BYTES};
use super::histories::{Histories, tip_deflection_m};
use super::periodic_answer::PeriodicAnswer;
use super::problem::{AnsweringModel, LinkProblem};
use crate::beam::{Mesh, MeshPlan};
use crate::modal::{TORQUE_WEIGHTS, deflection_weights, second_order_share};
use crate::model::{KeptModes, model_of};
use crate::numeric::{largest, largest_difference};
use crate::response::{Play, Torque, simulate_on};

/// Largest estimates of the errors of the tip, over its travel, and of the torque, over its peak, that suffice without
/// counting the terms. The true errors may be twice as large.
const ESTIMATED_TIP: f64 = 5e-3;
const ESTIMATED_TORQUE: f64 = 2e-2;

/// Most memory in bytes for counting the terms.
const MOST_BYTES: usize = 3 << 29;

/// Relative change of the torque, over the square of deflection over length. A bent link with a load at its tip is
/// shorter from hub to tip by a tenth of that square, and the torque falls with the square of the distance.
const SHORTENED: f64 = 0.2;

/// Errors on a carriage of the force and of the moment at the root, over their peaks, over the square of deflection over
/// length. Links of 2 to 30 % deflection that were played with all terms in another program reach 0.6 to 6.
const ON_CARRIAGE: f64 = 6.0;

/// Movement of inner nodes, over the change of the tip's deflection. Hub and tip stay on their arcs; the nodes between
/// them move less.
const INNER: f64 = 0.25;

/// Errors of the linear model, as shares.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinearModelError {
    /// Error of the tip of a link with all terms under the torque, over its travel.
    pub(super) tip: f64,
    /// Change of each quantity by all terms, over its size.
    pub(super) errors: PerQuantity<f64>,
}

impl LinearModelError {
    /// Estimate from deflection and rate alone.
    fn estimated(
        AnsweringModel { model, peaks, .. }: &AnsweringModel,
        answer: &PeriodicAnswer,
        histories: &Histories,
    ) -> Self {
        let Histories { rigid_hub_angle_rad, hub_angle_rad, .. } = histories;
        let length_m = model.mesh().length_m();
        let rigid_tip = model.mesh().rigid_tip();
        let deflection_m =
            largest(&tip_deflection_m(rigid_hub_angle_rad, hub_angle_rad, rigid_tip));
        let turned = largest(&histories.tip.velocity_m_s) / rigid_tip;
        // The hub of a vibrating link swings faster than the link turns.
        let rate_rad_s = turned.min(largest(&histories.hub_rate_rad_s));
        let share_of = second_order_share(model.mesh(), model.link(), rate_rad_s);
        let share = share_of(deflection_m, TORQUE_WEIGHTS);
        let of =
            |flexible: f64, peak: f64| if flexible == 0.0 { 0.0 } else { share * flexible / peak };
        let excess = |order: usize, peak: f64| of(largest(answer.excess(order)), peak);
        let beyond_rigid = largest_difference(&histories.torque_n_m, &histories.rigid_torque_n_m);
        let (joint, flexible_m) =
            (model.link().joint(), length_m - model.link().joint().radius_m());
        let shortened = if joint.slides() { ON_CARRIAGE } else { SHORTENED };
        let square = (model.link().tip_per_output() * deflection_m / flexible_m).powi(2);
        let torque = of(beyond_rigid, peaks.torque) + shortened * square;
        let hub_rate = excess(1, peaks.hub_rate);
        Self {
            tip: share_of(deflection_m, deflection_weights(model.link())) * deflection_m
                / answer.period.histories.largest_travel_m(),
            errors: PerQuantity {
                torque,
                hub_angle: excess(0, peaks.hub_angle),
                hub_rate,
                hub_acceleration: peaks.hub_acceleration.map(|peak| excess(2, peak)),
                displacement: peaks.displacement.map(|peak| of(INNER * deflection_m, peak)),
                bending_moment: peaks
                    .bending_moment
                    .map(|_| if joint.slides() { torque } else { share }),
                motor_torque: peaks.motor_torque.map(|_| torque),
                motor_rate: peaks.motor_rate.map(|_| hub_rate),
            },
        }
    }

    /// The errors, with the change of torques and moments by shear and rotary inertia.
    pub(super) fn with_thickness(&self, thick: Option<f64>) -> PerQuantity<f64> {
        let thick = thick.unwrap_or(0.0);
        let with = |share: Option<f64>| share.map(|share| share + thick);
        PerQuantity {
            torque: self.errors.torque + thick,
            bending_moment: with(self.errors.bending_moment),
            motor_torque: with(self.errors.motor_torque),
            ..self.errors
        }
    }
}

impl LinkProblem<'_> {
    /// Change of a linear answer by all terms of second order.
    ///
    /// The terms change the difference to the rigid link by about a [share](second_order_share), and shorten the link.
    /// If this estimate is large, the solver counts the terms.
    pub(super) fn model_error(
        &self,
        answering: &AnsweringModel,
        answer: &PeriodicAnswer,
        histories: &Histories,
    ) -> LinearModelError {
        let estimate = LinearModelError::estimated(answering, answer, histories);
        let is_small = estimate.tip <= ESTIMATED_TIP && estimate.errors.torque <= ESTIMATED_TORQUE;
        if is_small || self.resources.is_trial {
            return estimate;
        }
        let counted = self.with_all_terms(answering, answer, histories);
        counted.map_or(estimate, |(own, converges)| LinearModelError {
            tip: own.tip.max(estimate.tip),
            errors: if converges { own.errors } else { own.errors.zip(&estimate.errors, f64::max) },
        })
    }

    /// Counts the terms: plays the missing torque on the linear link, and judges whether two iterations suffice. `None`
    /// if the terms are refused or exceed the memory limit.
    fn with_all_terms(
        &self,
        AnsweringModel { model, first_zero_per_s, peaks, .. }: &AnsweringModel,
        answer: &PeriodicAnswer,
        histories: &Histories,
    ) -> Option<(LinearModelError, bool)> {
        let link = model.link();
        let mesh = Mesh::new(link, &MeshPlan::automatic(link)).ok()?;
        let (len, nodes) = (answer.period.spectrum.pair.len(), mesh.nodes_m().len());
        let bytes = len.saturating_mul(nodes).saturating_mul(BYTES);
        let allowed = self.resources.memory_bytes.unwrap_or(usize::MAX).min(MOST_BYTES);
        if bytes > allowed {
            return None;
        }
        // A coarse mesh with all modes suffices.
        let coarse = model_of(link, mesh.clone(), KeptModes::All).ok()?;
        let arm = link.clone().into();
        let bent = ArmProblem::of_link(self, &arm, *first_zero_per_s).ok()?;
        let probes = [vec![0, nodes / 2]];
        let ([own, other], share) = bent.estimated(coarse, &answer.period, &probes).ok()?;
        let converges = share >= 1.0;
        let errors = own.apart(&other).zip(peaks, |off, size| share * off / size);
        let missing = own.torque_n_m.iter().zip(&other.torque_n_m);
        let missing: Vec<f64> = missing.map(|(own, other)| share * (own - other)).collect();
        // A cycle does not start from rest.
        if self.motion.cycles().is_some() {
            return Some((LinearModelError { tip: 0.0, errors }, converges));
        }
        // Curves begin at the seam, in the middle of the rest.
        let (step_s, seam) = (self.motion.grid().step_s, answer.period.spectrum.seam);
        let window = histories.grid;
        let time_s: Vec<f64> = (0..len).map(|k| k as f64 * step_s).collect();
        let torque = Torque::new(&time_s, missing).ok()?;
        let played = simulate_on(link, mesh, &Play::of(&torque)).ok()?;
        let end = (len - seam) as i64 + window.first + window.len as i64;
        let strays_m = largest(&played.tip[0].displacement_m[..len.min(end as usize)]);
        let travel_m = answer.period.histories.largest_travel_m();
        Some((LinearModelError { tip: strays_m / travel_m, errors }, converges))
    }
}
