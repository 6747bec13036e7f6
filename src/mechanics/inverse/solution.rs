//! The solution of an inversion: motions of joints, links and tip, their band and errors.

use std::borrow::Cow;
use std::f64::consts::TAU;
use std::num::NonZeroUsize;
use std::sync::Arc;

use super::accuracy::{PerQuantity, QuantityErrors, size};
use super::analysis::{Analysis, Unwatched};
use super::histories::{HubMotion, MotorHistories, cut, tip_deflection_m};
use super::spectra::{DrivenModel, HubSpectra};
use super::warning::{SolutionWarning, Straying};
use crate::beam::Mesh;
use crate::elastica::{AngleHistories, ElasticaMotion, Iteration, SecondOrder};
use crate::link::{Arm, Drive, Link};
use crate::modal::{DampingLaw, reported_frequencies, reported_zeros, reports_weight};
use crate::model::Model;
use crate::motion::{Ends, Motion, TailTerms, TipMotionHistories, TipPeriod, TipSpectrum};
use crate::numeric::{Size, TimeGrid, largest};

/// Frequencies that were solved for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Period P in s.
    pub period_s: f64,
    /// Samples of the period: the length of the Fourier transform.
    pub fft_length: usize,
    /// Frequencies solved for, zero included.
    pub frequencies: usize,
    /// The highest solved frequency in Hz. For an arm the highest in its histories: turning links raise it above the
    /// path's cut-off.
    pub highest_hz: f64,
    /// Frequency in Hz that starts the roll-off of the motion; the tip follows lower frequencies unchanged. `None`
    /// where the solver covers every frequency of the samples.
    pub cutoff_hz: Option<f64>,
    /// Nyquist frequency in Hz.
    pub nyquist_hz: f64,
}

impl Band {
    pub(super) fn of(spectrum: &TipSpectrum, frequencies: usize) -> Self {
        let hertz = |k: usize| spectrum.omegas_rad_s[k] / TAU;
        Self {
            period_s: spectrum.period_s(),
            fft_length: spectrum.pair.len(),
            frequencies,
            highest_hz: hertz(frequencies - 1),
            cutoff_hz: (!spectrum.cutoff.keeps_all()).then(|| spectrum.cutoff.omega_rad_s / TAU),
            nyquist_hz: hertz(spectrum.pair.len() / 2),
        }
    }
}

/// Motion and torques of all joints that move the tip as wanted, with the arm, the wanted motion and the analysis.
///
/// All histories are samples on [`Solution::grid`], the motion's samples with lead and lag added where its rest is too
/// short.
#[derive(Clone)]
pub struct Solution {
    /// The arm; one link is an arm of one.
    pub arm: Arm,
    /// The wanted motion.
    pub motion: Motion,
    /// Required accuracy of the answer.
    pub analysis: Analysis,
    /// Times of all histories.
    pub grid: TimeGrid,
    /// The joints, the inner one first; for one link its hub. The carriage of an arm comes last, with its force in N and
    /// its place in m.
    pub joints: Vec<JointMotion>,
    /// The links on the meshes of the answer, the inner one first.
    pub links: Vec<LinkMotion>,
    /// Each coordinate of the tip: for one link the displacement along its arc, for several x and y.
    pub tip: Vec<TipMotionHistories>,
    /// Largest distance of the solved tip from the wanted one, over its travel.
    pub tip_error: f64,
    /// Largest displacement of the tip by all second-order terms under the torque, over its travel. `None` with weight,
    /// with counted second-order terms, and for an arm.
    pub tip_model_error: Option<f64>,
    /// Numbers of the grid's samples between which the tip moves: the last at rest before the
    /// motion and the first at rest after it.
    pub moving: (usize, usize),
    /// First zero of torque → tip in 1/s, for an arm the smallest of its links' zeros. `None` where no mesh has a zero.
    pub first_zero_per_s: Option<f64>,
    /// Frequencies that were solved for.
    pub band: Band,
    /// The second-order terms: with gravity, on request, or for several links.
    pub second_order: Option<SecondOrderFindings>,
    /// Warnings, for the user to judge the answer by.
    pub warnings: Vec<SolutionWarning>,
    /// The spectra of one link, the source of its nodes' motions on request.
    pub(super) spectra: Option<LinkSpectra>,
}

/// One joint over the window.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMotion {
    /// Torque T in N m that turns its link, and the link before the other way.
    pub torque_n_m: Vec<f64>,
    /// Torque in N m that the same links would need if they were rigid.
    pub rigid_torque_n_m: Vec<f64>,
    /// Angle θ in rad: for the first joint against x, for the others from the tip of the link before to their link's
    /// root.
    pub angle_rad: Vec<f64>,
    /// Rate in rad/s.
    pub rate_rad_s: Vec<f64>,
    /// Acceleration in rad/s². `None` for one link, where [`Solution::acceleration_rad_s2`] computes it.
    pub acceleration_rad_s2: Option<Vec<f64>>,
    /// Angle in rad of the same joint between rigid links.
    pub rigid_angle_rad: Vec<f64>,
    /// Force in N along x and y on its link's inner end. `None` for one link and for a carriage.
    pub force_n: Option<[Vec<f64>; 2]>,
    /// Its motor, where it has a drive.
    pub motor: Option<MotorHistories>,
    /// Errors of each of its quantities.
    pub errors: PerQuantity<QuantityErrors>,
}

/// One link over the window.
#[derive(Debug, Clone)]
pub struct LinkMotion {
    /// The link on its mesh.
    pub model: Arc<dyn Model>,
    /// Moment in N m that its joint exerts on its root.
    pub root_moment_n_m: Vec<f64>,
    /// Largest slope |w'| from its chord. `None` for a link solved on its hub's tangent line.
    pub largest_slope: Option<f64>,
    /// Histories of its nodes. `None` for one link, where [`Solution::deflections`] and the like compute them.
    pub shape: Option<LinkShape>,
}

/// The shape of a link over the window: a history for each node.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkShape {
    /// Direction of its chord in rad, rate and acceleration.
    pub chord: AngleHistories,
    /// Length of its chord in m.
    pub chord_length_m: Vec<f64>,
    /// Direction of its root's tangent line in rad.
    pub root_rad: Vec<f64>,
    /// x and y of the nodes in m.
    pub positions_m: Vec<[Vec<f64>; 2]>,
    /// Deflection of the nodes from the chord in m.
    pub deflections_m: Vec<Vec<f64>>,
    /// Bending moment at the nodes in N m.
    pub moments_n_m: Vec<Vec<f64>>,
}

/// The second-order terms of a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondOrderFindings {
    /// The counted terms.
    pub order: SecondOrder,
    /// Their iteration.
    pub iteration: Iteration,
    /// Largest change of a torque by omitted terms, over its range. `None` where all terms count, and `Some(None)`
    /// where the motion with all terms is refused.
    pub left_out: Option<Option<f64>>,
    /// Error of the tip where the iteration of all terms does not converge and fewer count instead. No other estimate
    /// of omitted terms exists then.
    pub fallback: Option<Straying>,
}

/// The solution of one link in frequency.
#[derive(Clone)]
pub(super) struct LinkSpectra {
    /// Amplitudes at the hub over the band.
    pub(super) hub: HubSpectra,
    pub(super) period: Arc<TipPeriod>,
    /// The hub angle's slow tail, where damping causes one.
    pub(super) hub_tail: Option<TailTerms>,
    /// Places of the nodes over the period, for a link under gravity or with second-order terms.
    pub(super) shape: Option<Arc<Shape>>,
}

/// Places of a link's nodes over time: one history for each node.
#[expect(clippy::struct_field_names, reason = "their units end alike")]
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Shape {
    /// Displacement along the arc less that of the chord, `x atan(w/(x + u))`, in m.
    pub(super) arcs_m: Vec<Vec<f64>>,
    /// Deflection from the hub's tangent line in m.
    pub(super) deflections_m: Vec<Vec<f64>>,
    /// Bending moment in N m.
    pub(super) moments_n_m: Vec<Vec<f64>>,
}

impl Shape {
    pub(super) fn of(motion: &ElasticaMotion, second_order: SecondOrder, mesh: &Mesh) -> Self {
        let (is_large, slides) = (second_order == SecondOrder::Full, mesh.joint().slides());
        let nodes_m = mesh.nodes_m();
        let deflection = |[x, u, w, slope]: [f64; 4]| {
            if slides {
                w - slope
            } else if is_large {
                w * libm::cos(slope) - (x + u) * libm::sin(slope)
            } else {
                w - x * slope
            }
        };
        let nodes = 0..nodes_m.len();
        Self {
            arcs_m: nodes.clone().map(|k| Self::arc_m(motion, second_order, mesh, k)).collect(),
            deflections_m: nodes.map(|k| history_of(motion, nodes_m, k, deflection)).collect(),
            moments_n_m: motion.moments_n_m.clone(),
        }
    }

    /// [`Self::arcs_m`] of one node.
    pub(super) fn arc_m(
        motion: &ElasticaMotion,
        second_order: SecondOrder,
        mesh: &Mesh,
        node: usize,
    ) -> Vec<f64> {
        // The nodes of a link that slides move across it.
        let is_large = second_order == SecondOrder::Full && !mesh.joint().slides();
        history_of(motion, mesh.nodes_m(), node, |[x, u, w, _]| {
            if is_large && x > 0.0 { x * libm::atan2(w, x + u) } else { w }
        })
    }
}

/// Maps a node's distance from the axis, its shortening, its deflection and the hub's slope by `of`.
fn history_of(
    motion: &ElasticaMotion,
    nodes_m: &[f64],
    node: usize,
    of: impl Fn([f64; 4]) -> f64,
) -> Vec<f64> {
    let (w, u) = (&motion.deflections[2 * node], &motion.shortenings_m[node]);
    let places = w.iter().zip(u).zip(&motion.hub_slope_rad);
    places.map(|((w, u), slope)| of([nodes_m[node], *u, *w, *slope])).collect()
}

impl LinkSpectra {
    pub(super) fn driven<'a>(&'a self, model: &'a dyn Model) -> DrivenModel<'a> {
        DrivenModel { model, period: &self.period, watch: &Unwatched }
    }
}

impl LinkMotion {
    /// The link.
    pub fn link(&self) -> &Link {
        self.model.link()
    }

    /// The mesh of the answer.
    pub fn mesh(&self) -> &Mesh {
        self.model.mesh()
    }

    /// The damping law with all its numbers.
    pub fn law(&self) -> &DampingLaw {
        self.model.law()
    }

    /// The first `count` natural frequencies in rad/s, without the rigid motion; with the weight if
    /// [`reports_weight`](Self::reports_weight).
    pub fn natural_frequencies_rad_s(&self, count: usize) -> Vec<f64> {
        reported_frequencies(self.mesh(), self.link().outward_m_s2(), count)
    }

    /// The first `count` zeros of torque → tip in 1/s, with the weight like the frequencies.
    pub fn zeros_per_s(&self, count: usize) -> Vec<f64> {
        reported_zeros(self.mesh(), self.link().outward_m_s2(), count)
    }

    /// Whether frequencies and zeros have the weight: of a link that keeps its direction, on a mesh that is not too large.
    pub fn reports_weight(&self) -> bool {
        reports_weight(self.mesh(), self.link().outward_m_s2())
    }
}

impl Solution {
    /// The first joint: the hub of one link.
    pub fn hub(&self) -> &JointMotion {
        &self.joints[0]
    }

    /// Distances of the nodes of each link from its joint in m.
    pub fn nodes_m(&self) -> Vec<&[f64]> {
        self.links.iter().map(|link| link.mesh().nodes_m()).collect()
    }

    /// The shapes of an arm's links; empty for one link.
    pub fn shapes(&self) -> impl Iterator<Item = &LinkShape> {
        self.links.iter().filter_map(|link| link.shape.as_ref())
    }

    /// Angle of a joint in rad; for a tip that moves before its motion and after it, only during the motion.
    pub(crate) fn followed_rad(&self, joint: usize) -> &[f64] {
        let (first, last) = self.moving;
        match self.motion.ends() {
            Ends::Moving => &self.joints[joint].angle_rad[first..=last],
            _ => &self.joints[joint].angle_rad,
        }
    }

    /// Acceleration of a joint in rad/s². For one link each call computes it, as few readers need it.
    pub fn acceleration_rad_s2(&self, joint: usize) -> Cow<'_, [f64]> {
        match (&self.joints[joint].acceleration_rad_s2, &self.spectra) {
            (None, Some(LinkSpectra { hub, period, hub_tail, .. })) => {
                let per_rigid_tip = 1.0 / self.links[0].mesh().rigid_tip();
                let motion = HubMotion { period, tail: *hub_tail, per_rigid_tip };
                let spectrum = &period.spectrum;
                let excess = spectrum.pair.samples(spectrum.derivative(&hub.excess_angle_rad, 2));
                motion.on(&self.grid, &excess, &self.tip[0].acceleration_m_s2, 2).into()
            }
            (known, _) => known.as_deref().unwrap_or_default().into(),
        }
    }

    /// Largest distance of the tip from its start in m; for a tip that moves before its motion and after it, during the
    /// motion.
    pub fn tip_travel_m(&self) -> f64 {
        match (&self.tip[..], &self.spectra) {
            ([x, y], _) => farthest_m([&x.displacement_m, &y.displacement_m]),
            (_, Some(spectra)) if self.motion.ends() == Ends::Moving => {
                spectra.period.histories.largest_travel_m()
            }
            _ => self.tip[0].largest_travel_m(),
        }
    }

    /// Largest expected distance of the tip from the wanted one, over its travel: the larger of the solved tip's error
    /// and the error by fewer second-order terms after a failed iteration.
    pub fn expected_tip_error(&self) -> f64 {
        let fallback = self.second_order.and_then(|found| found.fallback);
        Size::larger(self.tip_error, fallback.map_or(0.0, Straying::share))
    }

    /// The largest error of a kind, over all quantities of all joints.
    pub fn worst(&self, kind: impl Fn(&QuantityErrors) -> f64) -> f64 {
        let errors = self.joints.iter().flat_map(|joint| joint.errors.iter());
        errors.map(|(_, errors)| kind(&errors)).fold(0.0, Size::larger)
    }

    /// The solution whose motors' torques have the errors that losses add to them.
    pub(super) fn with_losses(mut self) -> Self {
        for number in 0..self.links.len() {
            let drive = self.arm.links()[number].link.drive().copied();
            if let Some(drive) = drive.filter(Drive::has_losses) {
                self.joints[number].errors = self.errors_with_losses(number, &drive);
            }
        }
        self
    }

    /// Errors of a joint whose motor has losses. Those of the torque in front of the gear follow from the errors of the
    /// joint's torque and rate by the slopes of the losses; the window also cuts off the friction beyond it.
    fn errors_with_losses(&self, number: usize, drive: &Drive) -> PerQuantity<QuantityErrors> {
        let joint @ JointMotion { torque_n_m, rate_rad_s, errors, .. } = &self.joints[number];
        let Some((motor, own)) = joint.motor.as_ref().zip(errors.motor_torque) else {
            return *errors;
        };
        let friction_rate = drive.friction_rate(largest(rate_rad_s));
        let lossy = |k: usize, away_rad_s: f64| {
            let rate = rate_rad_s[k].abs();
            let [along, other] =
                [rate, rate - away_rad_s].map(|rate| Drive::direction(rate, friction_rate));
            (drive.with_losses(torque_n_m[k], along.copysign(rate_rad_s[k])), along - other)
        };
        let sizes = [&motor.torque_n_m, motor.linear_n_m(), torque_n_m, rate_rad_s];
        let [size, linear, joint_n_m, rate_size] = sizes.map(|own| self.size_of(own));
        let with = |own: f64, torque: f64, rate: f64| {
            let (torque_n_m, away_rad_s) = (torque * joint_n_m, rate * rate_size);
            let worst = (0..self.grid.len).map(|k| {
                let (lossy, turned) = lossy(k, away_rad_s);
                (lossy.per_torque - 1.0).abs() * torque_n_m + lossy.per_direction.abs() * turned
            });
            let worst = worst.fold(0.0, Size::larger);
            if size == 0.0 { own } else { (own * linear + worst / drive.gear_ratio) / size }
        };
        let of_kind = |kind: fn(&QuantityErrors) -> Option<f64>| {
            let [torque, rate] = [&errors.torque, &errors.hub_rate].map(&kind);
            kind(&own).map(|own| with(own, torque.unwrap_or(0.0), rate.unwrap_or(0.0)))
        };
        let beyond = [0, self.grid.len - 1].map(|k| {
            let (held, (moving, _)) = (drive.with_losses(torque_n_m[k], 0.0), lossy(k, 0.0));
            (moving.torque - held.torque).abs() / drive.gear_ratio / size
        });
        let is_cut = self.motion.ends() == Ends::AtRest && size > 0.0;
        let beyond = if is_cut { beyond[0].max(beyond[1]) } else { 0.0 };
        let lossy = QuantityErrors {
            mesh: of_kind(|own| Some(own.mesh)).unwrap_or_default(),
            window: of_kind(|own| Some(own.window)).unwrap_or_default() + beyond,
            step: of_kind(|own| own.step),
            iteration: of_kind(|own| own.iteration),
            modes: of_kind(|own| own.modes),
            input: of_kind(|own| own.input),
            model: of_kind(|own| own.model),
        };
        PerQuantity { motor_torque: Some(lossy), ..*errors }
    }

    /// Reference of a history's errors: its peak or, with gravity, its largest value less its smallest.
    pub fn size_of(&self, history: &[f64]) -> f64 {
        size(history, self.arm.has_weight())
    }

    /// Displacement of the tip less that of the tip of a rigid link whose output moves alike, in m. `None` where the output
    /// is the tip.
    pub fn tip_from_rigid_m(&self) -> Option<Vec<f64>> {
        let mesh = self.links[0].mesh();
        let nodes = [mesh.output(), mesh.nodes_m().len() - 1];
        let is_inboard = nodes[0] < nodes[1];
        let table = is_inboard.then(|| self.displacements(&nodes, NonZeroUsize::MIN).ok())??;
        let samples = table.histories().samples;
        let share = mesh.rigid(nodes[1])[0] / mesh.rigid_tip();
        let pairs = samples[1].iter().zip(&samples[0]);
        Some(pairs.map(|(tip, output)| tip - share * output).collect())
    }

    /// Deflection of a link's output from the tangent line of its joint in m; for one link `v − xθ` of an output at x.
    pub fn tip_deflection_m(&self, link: usize) -> Vec<f64> {
        let LinkMotion { model, shape, .. } = &self.links[link];
        if let Some(LinkShape { chord, chord_length_m, root_rad, .. }) = shape {
            // The tip is on the chord: it deflects by the chord times the root's slope.
            let slopes = chord[0].iter().zip(root_rad).map(|(chord, root)| chord - root);
            let chords = chord_length_m.iter().zip(slopes);
            return chords.map(|(length, slope)| length * libm::sin(slope)).collect();
        }
        if let Some(shape) = self.spectra.as_ref().and_then(|spectra| spectra.shape.as_ref()) {
            return cut(&shape.deflections_m[model.mesh().output()], &self.grid);
        }
        let JointMotion { angle_rad, rigid_angle_rad, .. } = &self.joints[link];
        tip_deflection_m(rigid_angle_rad, angle_rad, model.mesh().rigid_tip())
    }
}

/// Largest distance in m of a tip at these x and y from its start.
pub(super) fn farthest_m([x_m, y_m]: [&[f64]; 2]) -> f64 {
    let far = |(x, y): (&f64, &f64)| {
        let [dx, dy] = [x - x_m[0], y - y_m[0]];
        (dx * dx + dy * dy).sqrt()
    };
    x_m.iter().zip(y_m).map(far).fold(0.0, f64::max)
}
