//! The answer of a link under gravity or with second-order terms, over a period with a return of its chord.
//!
//! The torque at rest is the weight's static moment, with different values before and after the motion. Between both
//! rests the chord returns slowly, as if at rest, so that only gravity's direction follows it.

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

use super::accuracy::PerQuantity;
use super::amplitudes::Probes;
use super::analysis::{Resources, Unwatched};
use super::bent_answer::{Bent, BentAnswer};
use super::curves::{Curves, Shape, size};
use super::error::InversionError;
use super::mesh_error::TORQUES_N_M;
use super::period::Window;
use super::periodic_answer::PeriodicAnswer;
use super::problem::Problem;
use super::rest::{Rest, Return, left_to_return, lengthened};
use super::solution::SecondOrderFindings;
use super::spectra::DrivenModel;
use crate::beam::MeshPlan;
use crate::elastica::{ChordPeriod, ElasticaMotion, Followed, SecondOrder, follow};
use crate::link::Link;
use crate::model::Model;
use crate::motion::TipPeriod;
use crate::numeric::largest_difference;

/// Memory in bytes for each node and sample of the period, as measured.
pub(super) const BYTES: usize = 200;

/// The link at rest before the motion and after it.
type Rests = [ElasticaMotion; 2];

/// A problem of a link with weight or second-order terms.
pub(super) struct BentProblem<'a> {
    pub(super) problem: &'a Problem<'a>,
    gravity_m_s2: [f64; 2],
    /// Direction in rad of the chord at zero displacement of the tip.
    start_angle_rad: f64,
    pub(super) second_order: SecondOrder,
    returns: Return,
}

impl<'a> BentProblem<'a> {
    /// # Errors
    /// [`InversionError::NoStartAngle`].
    pub(super) fn of(
        problem: &'a Problem<'a>,
        link: &Link,
        first_zero_per_s: Option<f64>,
    ) -> Result<Self, InversionError> {
        let returns = link.has_weight() && problem.motion.cycles().is_none();
        Ok(Self {
            gravity_m_s2: link.gravity().map_or([0.0; 2], |gravity| gravity.acceleration_m_s2),
            start_angle_rad: problem.start_angle_rad(link)?,
            second_order: problem.analysis.second_order_of(link),
            returns: if returns {
                Return::of(1, first_zero_per_s, &problem.motion.grid())
            } else {
                Return::NONE
            },
            problem,
        })
    }

    /// Samples of the shortest period.
    pub(super) fn shortest_len(&self) -> Result<usize, InversionError> {
        self.returns.shortest_len(self.problem.padding, self.problem.motion.grid().len)
    }

    /// The motion on a mesh, over a period of `len` samples.
    ///
    /// # Errors
    /// [`InversionError`].
    pub(super) fn answer(
        &self,
        model: &dyn Model,
        len: usize,
    ) -> Result<BentAnswer, InversionError> {
        let nodes = model.mesh().nodes_m().len();
        let bytes = len.saturating_mul(nodes).saturating_mul(BYTES);
        if let Some(allowed) = self.problem.resources.memory_bytes.filter(|most| bytes > *most) {
            return Err(InversionError::TooMuchMemory { bytes, allowed });
        }
        let period = self.problem.period(len)?;
        let driven = DrivenModel { model, period: &period, watch: self.problem.resources.watch };
        driven.begin(1, 0);
        let (chord, rest) = self.chord_and_rest(&period, model.mesh().length_m())?;
        let tolerance = self.problem.analysis.iterated_to();
        let found = follow(model, &chord, self.second_order, tolerance)?;
        driven.begin(1, 1);
        Ok(BentAnswer { period, chord, found, rest })
    }

    pub(super) fn chord_and_rest(
        &self,
        period: &TipPeriod,
        length_m: f64,
    ) -> Result<(ChordPeriod, Rest), InversionError> {
        let (padding, given) = (self.problem.padding, self.problem.motion.grid().len);
        let spectrum = &period.spectrum;
        let returning = self.returns.samples(padding, given, spectrum.pair.len());
        let chord = self.chord(period, &returning, length_m)?;
        Ok((chord, Rest::of(spectrum, spectrum.seam_reach(), returning)))
    }

    /// The chord over a period. It returns around the seam, from the displacement after the motion to the one before
    /// it; whole turns need no return.
    fn chord(
        &self,
        period: &TipPeriod,
        returning: &Range<usize>,
        length_m: f64,
    ) -> Result<ChordPeriod, InversionError> {
        let (tip, spectrum) = (&period.histories, &period.spectrum);
        let turn_m = TAU * length_m;
        let travel_m = spectrum.travel_m();
        let travel_m = travel_m - turn_m * (travel_m / turn_m).round();
        let mut at_m = tip.displacement_m.clone();
        for (k, left_m) in left_to_return(travel_m, returning, spectrum.seam) {
            at_m[k] += left_m;
        }
        let per_length = |values: &[f64]| values.iter().map(|m| m / length_m).collect();
        let angle = at_m.iter().map(|m| self.start_angle_rad + m / length_m).collect();
        let columns = [angle, per_length(&tip.velocity_m_s), per_length(&tip.acceleration_m_s2)];
        Ok(ChordPeriod::new(spectrum.step_s, columns, self.gravity_m_s2)?)
    }

    /// The link at rest with its tip at this displacement.
    pub(super) fn at_rest(
        &self,
        model: &dyn Model,
        displacement_m: f64,
    ) -> Result<ElasticaMotion, InversionError> {
        let angle_rad = self.start_angle_rad + displacement_m / model.mesh().length_m();
        let chord = ChordPeriod::at_rest(angle_rad, self.gravity_m_s2)?;
        let tolerance = self.problem.analysis.iterated_to();
        Ok(follow(model, &chord, self.second_order, tolerance)?.motion)
    }

    /// The motion on a mesh fine enough for the plan.
    ///
    /// # Errors
    /// [`InversionError::NotConverged`], or an impossible motion.
    pub(super) fn on_mesh_of(
        &self,
        plan: &MeshPlan,
        coarsest: Arc<dyn Model>,
    ) -> Result<BentOnMesh, InversionError> {
        let (len, order) = (self.shortest_len()?, self.second_order);
        let mut probes = Probes::of(coarsest.mesh(), plan, self.problem.analysis);
        let mut answer = self.answer(&*coarsest, len)?;
        let mut model = coarsest;
        loop {
            let elements = model.mesh().elements().len();
            let (finer, finer_probes) = (model.refined()?, probes.refined());
            let finer_answer = self.answer(&*finer, len)?;
            let on_finer = finer_answer.curves(&*finer, order, &finer_probes.nodes);
            let travel_m = answer.period.histories.largest_travel_m();
            let sizes = probes.measured(on_finer.sizes(model.link().has_weight(), travel_m));
            if !TORQUES_N_M.contains(&sizes.torque) {
                return Err(InversionError::OutOfRange { peak_n_m: sizes.torque });
            }
            let errors = self.mesh_errors((&*model, &probes, &answer), &on_finer, &sizes);
            let (_, error) = errors.worst();
            if !plan.is_automatic() || error <= plan.tolerance() {
                return Ok(BentOnMesh { model, probes, answer, sizes, errors });
            }
            if 4 * elements > finer.most_elements() {
                let tolerance = plan.tolerance();
                return Err(InversionError::NotConverged { error, elements, tolerance });
            }
            (model, probes, answer) = (finer, finer_probes, finer_answer);
        }
    }

    /// Change of each quantity by halved elements, over its size.
    fn mesh_errors(
        &self,
        (model, probes, answer): (&dyn Model, &Probes, &BentAnswer),
        on_finer: &Curves,
        sizes: &PerQuantity<f64>,
    ) -> PerQuantity<f64> {
        let curves = answer.curves(model, self.second_order, &probes.nodes);
        let per_change = model.mesh().error_per_change();
        curves.apart(on_finer).zip(sizes, |off, size| per_change * off / size)
    }

    /// Mesh errors of an answer over a longer period, where the ringing of an undamped mesh adds up.
    ///
    /// # Errors
    /// As [`Self::answer`].
    pub(super) fn mesh_errors_of(
        &self,
        (model, probes, answer): (&dyn Model, &Probes, &BentAnswer),
        sizes: &PerQuantity<f64>,
    ) -> Result<PerQuantity<f64>, InversionError> {
        let (finer, nodes) = (model.refined()?, probes.refined().nodes);
        let finer_answer = self.answer(&*finer, answer.period.spectrum.pair.len())?;
        let on_finer = finer_answer.curves(&*finer, self.second_order, &nodes);
        Ok(self.mesh_errors((model, probes, answer), &on_finer, sizes))
    }

    /// Change of each quantity by half the step, over its size, where second-order terms exceed the samples'
    /// resolution. `None` elsewhere, or where the motion cannot be sampled twice as often.
    ///
    /// # Errors
    /// As [`Self::answer`].
    pub(super) fn step_errors(
        &self,
        (model, probes, answer): (&dyn Model, &Probes, &BentAnswer),
        first_zero_per_s: Option<f64>,
        sizes: &PerQuantity<f64>,
    ) -> Result<Option<PerQuantity<f64>>, InversionError> {
        if !answer.found.iteration.exceeds_step {
            return Ok(None);
        }
        let Ok(finer) = self.problem.motion.twice_as_often() else { return Ok(None) };
        let resources = Resources { watch: &Unwatched, ..self.problem.resources };
        let finer = Problem::new(&finer, self.problem.analysis, first_zero_per_s, resources)?;
        let finer = BentProblem::of(&finer, model.link(), first_zero_per_s)?;
        let found = finer.answer(model, 2 * answer.period.spectrum.pair.len())?;
        let given = self.problem.motion.grid().len;
        let of = |answer: &BentAnswer, given: usize| {
            answer.curves_of_motion(model, self.second_order, &probes.nodes, given)
        };
        let apart = of(answer, given).apart_from_finer(&of(&found, 2 * given - 1));
        Ok(Some(apart.zip(sizes, |off, size| off / size)))
    }

    /// Change of each quantity by further iterations and by loads of more frequencies, over its size.
    pub(super) fn iteration_errors(
        &self,
        (model, probes, answer): (&dyn Model, &Probes, &BentAnswer),
        sizes: &PerQuantity<f64>,
    ) -> PerQuantity<f64> {
        let own = answer.curves(model, self.second_order, &probes.nodes);
        let mut errors = sizes.zip(sizes, |_, _| 0.0);
        for (other, factor) in answer.found.others(model, &answer.chord) {
            let other = answer.curves_of(&other, model, self.second_order, &probes.nodes);
            let changed = own.apart(&other);
            let changed = changed.zip(sizes, |off, size| factor * off / size);
            errors = errors.zip(&changed, |sum, error| sum + error);
        }
        errors
    }

    /// Lengthens the period until every quantity is at rest where the chord begins and ends its return; returns each
    /// remainder there, over the quantity's size. A periodic motion has no rest.
    pub(super) fn decayed(
        &self,
        model: &dyn Model,
        probes: &Probes,
        sizes: &PerQuantity<f64>,
        shortest: BentAnswer,
    ) -> Result<(BentAnswer, Option<Rests>, PerQuantity<f64>), InversionError> {
        if self.problem.padding.cycles.is_some() {
            return Ok((shortest, None, sizes.zip(sizes, |_, _| 0.0)));
        }
        let initial = shortest.period.spectrum.pair.len();
        let linear = Self { second_order: SecondOrder::None, ..*self };
        let is_linear = self.second_order == SecondOrder::None;
        let mut answer = shortest;
        loop {
            let (rests, left) = self.left(model, probes, sizes, &answer)?;
            let next = if self.is_at_rest(&left) {
                None
            } else {
                let len = answer.period.spectrum.pair.len();
                lengthened(len, initial, |len| {
                    Ok::<_, InversionError>(
                        is_linear || {
                            let shorter = linear.answer(model, len)?;
                            self.is_at_rest(&linear.left(model, probes, sizes, &shorter)?.1)
                        },
                    )
                })?
            };
            match next {
                Some(len) => answer = self.answer(model, len)?,
                None => return Ok((answer, Some(rests), left)),
            }
        }
    }

    fn is_at_rest(&self, left: &PerQuantity<f64>) -> bool {
        left.worst().1 <= self.problem.analysis.tolerance()
    }

    /// Remainder of each quantity beyond the link at rest where the chord begins and ends its return, over its size.
    fn left(
        &self,
        model: &dyn Model,
        probes: &Probes,
        sizes: &PerQuantity<f64>,
        answer: &BentAnswer,
    ) -> Result<(Rests, PerQuantity<f64>), InversionError> {
        let (order, nodes) = (self.second_order, &probes.nodes);
        let tip = &answer.period.histories;
        let ends_m = [tip.start_m(), tip.start_m() + answer.period.spectrum.travel_m()];
        let rests = [self.at_rest(model, ends_m[0])?, self.at_rest(model, ends_m[1])?];
        let place = ((order, model.mesh().nodes_m()), (model.link(), &nodes[..]));
        let at_rest = [0, 1].map(|end| Curves::at_rest(&rests[end], place.0, ends_m[end], place.1));
        let curves = answer.curves(model, order, nodes);
        let left = curves.left_of(&at_rest, answer.rest.reaches(self.problem.motion.grid().len));
        Ok((rests, left.zip(sizes, |left, size| left / size)))
    }

    /// The samples to write: until the torques of hub and motor stay within the tolerance of their values at rest; and
    /// the largest torques outside, over their sizes.
    pub(super) fn window(
        &self,
        (link, answer): (&Link, &BentAnswer),
        periodic: &PeriodicAnswer,
        rests: Option<&Rests>,
        sizes: &PerQuantity<f64>,
    ) -> (Window, PerQuantity<f64>) {
        let given = self.problem.motion.grid();
        let Some(rests) = rests else {
            return (self.problem.window(periodic), PerQuantity::default());
        };
        let of = |samples: &[f64], per_hub: f64, size: f64| {
            let at_rest = [0, 1].map(|end| rests[end].torque_n_m[0] * per_hub);
            let beyond = answer.rest.beyond(samples, at_rest);
            let torque = periodic.periodic(&beyond);
            let window = torque.window(given.len, given.step_s, self.problem.analysis, size);
            (beyond, window)
        };
        let (hub, window) = of(&periodic.torque_n_m, 1.0, sizes.torque);
        let motor = periodic.motor_n_m.as_deref().zip(sizes.motor_torque).zip(link.drive());
        let motor = motor.map(|((motor, size), drive)| of(motor, drive.gear_ratio.recip(), size));
        let window = motor.as_ref().map_or(window, |(_, motor)| Window {
            start: window.start.min(motor.start),
            stop: window.stop.max(motor.stop),
        });
        let outside = |beyond: &[f64], size| periodic.periodic(beyond).outside(&window) / size;
        let cut = PerQuantity {
            torque: outside(&hub, sizes.torque),
            motor_torque: motor
                .zip(sizes.motor_torque)
                .map(|((motor, _), size)| outside(&motor, size)),
            ..PerQuantity::default()
        };
        (window, cut)
    }

    /// Results of the answer beside its histories.
    pub(super) fn findings(&self, model: &dyn Model, answer: &BentAnswer) -> Bent {
        let Followed { motion, iteration, .. } = &answer.found;
        let left_out = match self.second_order {
            SecondOrder::Full => None,
            _ => Some(self.left_out(model, answer)),
        };
        let findings = SecondOrderFindings {
            order: self.second_order,
            iteration: *iteration,
            left_out,
            fallback: None,
        };
        let shape = Shape::of(motion, self.second_order, model.mesh().nodes_m());
        Bent { findings, largest_slope: motion.largest_slope, shape }
    }

    /// Change of the torque by all terms, over its range, for an answer with fewer terms. `None` where the motion with
    /// all terms is refused.
    fn left_out(&self, model: &dyn Model, answer: &BentAnswer) -> Option<f64> {
        let all = Self { second_order: SecondOrder::Full, ..*self };
        let len = answer.period.spectrum.pair.len();
        let full = all.answer(model, len).ok()?;
        let [own, full] = [answer, &full]
            .map(|answer| answer.rest.outside_return(&answer.found.motion.torque_n_m));
        Some(largest_difference(&own, &full) / size(&own, true))
    }
}

/// The answer on a fine enough mesh, and its errors.
pub(super) struct BentOnMesh {
    pub(super) model: Arc<dyn Model>,
    pub(super) probes: Probes,
    pub(super) answer: BentAnswer,
    /// Size of each quantity, the reference of its errors.
    pub(super) sizes: PerQuantity<f64>,
    /// Discretisation error of each quantity.
    pub(super) errors: PerQuantity<f64>,
}
