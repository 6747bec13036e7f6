//! The motion of a link or an arm from a simulation; of a linear link also under other torques or another damping law.

use std::f64::consts::TAU;
use std::num::NonZeroUsize;

use num_complex::Complex64;
use rayon::prelude::*;

use super::bent::{BentPlay, JointMotion, largest_travel_m};
use super::driving::{Interpolation, pieces};
use super::error::SimulationWarning;
use super::modes::{Coordinate, Equations, HubReaction, ModeSelection};
use super::residual::{PlayedModelError, ResidualVibration};
use super::state::{LinkState, State};
use super::stepper::{Record, Stepper};
use crate::beam::{Mesh, NodalHistories};
use crate::link::ParameterError;
use crate::modal::{DampingLaw, Shape};
use crate::motion::TipMotionHistories;
use crate::numeric::{FourierPair, TimeGrid, angular_frequency, fast_length};
use crate::system::end_if_stopped;

/// The motion of a link or an arm under torques or with prescribed joints. The times of all histories are
/// [`Played::grid`].
#[derive(Debug, Clone)]
pub struct Played {
    /// Times of all histories: those of the input, continued to the requested end.
    pub grid: TimeGrid,
    /// Samples of the input.
    pub driven: usize,
    /// The joints, the inner one first. One link has one, its hub.
    pub joints: Vec<JointMotion>,
    /// Motion of the tip: for one link along its arc, for an arm along x and y.
    pub tip: Vec<TipMotionHistories>,
    /// The links, the inner one first; empty where [`move_arm`](super::move_arm) moved the joints.
    pub links: Vec<PlayedLink>,
    /// Method and its results.
    pub by: PlayedBy,
    /// Warnings for the user.
    pub warnings: Vec<SimulationWarning>,
}

/// A link and its properties.
#[derive(Debug, Clone)]
pub struct PlayedLink {
    /// Its mesh.
    pub mesh: Mesh,
    /// Its damping law; the ratio of a hysteretic link serves as its viscous ratio.
    pub law: DampingLaw,
    /// Gravity in m/s² outward along it, if it keeps its direction.
    pub outward_m_s2: Option<f64>,
    /// Its lowest natural frequencies in rad/s, the rigid motion excluded; with weight only of a link that keeps its
    /// direction. NaN for a mode that does not vibrate, because the weight buckles the link.
    pub natural_frequencies_rad_s: Vec<f64>,
}

impl PlayedLink {
    /// The lowest frequency at which the link vibrates; `None` for a rigid link.
    pub(super) fn first_rad_s(&self) -> Option<f64> {
        self.natural_frequencies_rad_s.iter().copied().find(|omega| *omega > 0.0)
    }
}

/// Method of a simulation, with its results.
#[derive(Debug, Clone)]
pub enum PlayedBy {
    /// A linear link, by its modes.
    Modes(ModalPlay),
    /// A link with weight or at large angles, or an arm.
    Elastica(BentPlay),
}

impl Played {
    /// The hub: the first joint.
    pub fn hub(&self) -> &JointMotion {
        &self.joints[0]
    }

    /// The mesh of one link.
    pub fn mesh(&self) -> &Mesh {
        &self.links[0].mesh
    }

    /// Distances in m of the nodes of each link from its joint.
    pub fn nodes_m(&self) -> Vec<&[f64]> {
        self.links.iter().map(|link| link.mesh.nodes_m()).collect()
    }

    /// Largest distance of the tip from its start in m.
    pub fn largest_travel_m(&self) -> f64 {
        largest_travel_m(&self.tip)
    }

    /// Largest change of the tip in m, and of any joint in rad, by the last refinement; 0 for modes, integrated
    /// exactly.
    pub fn change(&self) -> [f64; 2] {
        self.bent().map_or([0.0; 2], |bent| bent.change)
    }

    /// Longest period of a link's first flexible mode in s; for a linear link with a prescribed hub, of the held link.
    pub fn first_period_s(&self) -> Option<f64> {
        match &self.by {
            PlayedBy::Modes(modes) => modes.equations.first_period_s(),
            PlayedBy::Elastica(_) => {
                let first = self.links.iter().filter_map(PlayedLink::first_rad_s);
                first.map(|omega| TAU / omega).reduce(f64::max)
            }
        }
    }

    /// Results of a linear link.
    pub fn modes(&self) -> Option<&ModalPlay> {
        match &self.by {
            PlayedBy::Modes(modes) => Some(modes),
            PlayedBy::Elastica(_) => None,
        }
    }

    /// Results of bent links.
    pub fn bent(&self) -> Option<&BentPlay> {
        match &self.by {
            PlayedBy::Modes(_) => None,
            PlayedBy::Elastica(bent) => Some(bent),
        }
    }

    /// Deflection of one link's tip from the hub's tangent line, `v_tip − Lθ`, in m.
    pub fn tip_deflection_m(&self) -> Vec<f64> {
        match &self.by {
            PlayedBy::Modes(modes) => {
                let (tip_m, hub_rad) = (&self.tip[0].displacement_m, &self.hub().angle_rad);
                modes.tip_deflection_m(self.mesh(), tip_m, hub_rad)
            }
            PlayedBy::Elastica(bent) => bent.tip_deflection_m(),
        }
    }

    /// Total displacement `v = xθ + w` in m of one link at `nodes`, every `every`-th sample.
    ///
    /// # Errors
    /// [`ParameterError`] if the mesh lacks a node.
    pub fn displacements_m(
        &self,
        nodes: &[usize],
        every: NonZeroUsize,
    ) -> Result<NodalHistories, ParameterError> {
        let mesh = self.mesh();
        mesh.check_nodes(nodes)?;
        let samples = match &self.by {
            PlayedBy::Modes(modes) => {
                let history = |node: &usize| modes.displacement_m(mesh, *node, every);
                nodes.par_iter().map(history).collect()
            }
            PlayedBy::Elastica(bent) => {
                let along_m = nodes.iter().map(|node| mesh.nodes_m()[*node]);
                bent.displacements_m(&along_m.collect::<Vec<_>>(), every)
            }
        };
        Ok(NodalHistories { nodes: nodes.to_vec(), grid: self.grid.thinned(every), samples })
    }

    /// Histories in m of the `nodes` of each link, every `every`-th sample: displacements for one link, x and y for an
    /// arm.
    ///
    /// # Errors
    /// [`ParameterError`] if the mesh lacks a node.
    pub fn places_m(
        &self,
        nodes: &[Vec<usize>],
        every: NonZeroUsize,
    ) -> Result<Vec<Vec<Vec<Vec<f64>>>>, ParameterError> {
        if let [nodes] = nodes {
            let displacements_m = self.displacements_m(nodes, every)?.samples;
            return Ok(vec![displacements_m.into_iter().map(|own| vec![own]).collect()]);
        }
        let mut along_m = Vec::new();
        for (link, nodes) in self.links.iter().zip(nodes) {
            link.mesh.check_nodes(nodes)?;
            along_m.push(nodes.iter().map(|node| link.mesh.nodes_m()[*node]).collect());
        }
        Ok(self.bent().map_or_else(Vec::new, |bent| bent.positions_m(&along_m, every)))
    }

    /// Largest imbalance of energy of an arm over the largest work, kinetic energy or change of all energy; 0 for an
    /// arm at rest.
    pub fn imbalance(&self) -> f64 {
        self.bent().map_or(0.0, BentPlay::imbalance)
    }

    /// Place and motion of the links at the last sample.
    pub fn state(&self) -> State {
        match &self.by {
            PlayedBy::Modes(modes) => {
                let links = vec![modes.state(self.mesh(), self.grid.end_s())];
                State { links, carriage: None }
            }
            PlayedBy::Elastica(bent) => bent.state(&self.grid, self.grid.len - 1),
        }
    }
}

/// Motion of a linear link by its modes.
#[derive(Debug, Clone)]
pub struct ModalPlay {
    /// Kept modes.
    pub selection: ModeSelection,
    /// Vibration after the input, unless it repeats.
    pub residual: Option<ResidualVibration>,
    /// Effect of the terms that the linear model omits.
    pub model_error: PlayedModelError,
    /// Highest frequency in rad/s of the input.
    pub(super) band_rad_s: f64,
    pub(super) grid: TimeGrid,
    /// Hub angle in rad at zero displacement of the tip.
    pub(super) from_rad: f64,
    pub(super) initial_tip_m: f64,
    /// Whether the motion is one repeating cycle.
    pub(super) repeats: bool,
    pub(super) equations: Equations,
    pub(super) record: Record,
    /// Rate of the reference in rad/s at each sample, if the damping of a loop turns with it; else empty.
    pub(super) turning_rad_s: Vec<f64>,
}

/// Deflection of the tip in m; the hub's angle counts from `from_rad`, the direction of zero displacement of the tip.
pub(super) fn deflection_m(
    mesh: &Mesh,
    from_rad: f64,
    tip_m: &[f64],
    hub_angle_rad: &[f64],
) -> Vec<f64> {
    let samples = tip_m.iter().zip(hub_angle_rad);
    samples.map(|(v, theta)| v - mesh.rigid_tip() * (theta - from_rad)).collect()
}

impl ModalPlay {
    /// Deflection of the tip from the hub's tangent line in m, from its displacement and the hub's angle.
    pub(super) fn tip_deflection_m(&self, mesh: &Mesh, tip_m: &[f64], hub_rad: &[f64]) -> Vec<f64> {
        deflection_m(mesh, self.from_rad, tip_m, hub_rad)
    }

    /// Place and motion of the link at the last sample.
    pub(super) fn state(&self, mesh: &Mesh, time_s: f64) -> LinkState {
        let (q, rates) = self.record.at(self.grid.len - 1);
        let all = [q, rates].map(|own| Shape::sum(own, &self.equations.shapes));
        let at = |own: &Shape, part: usize| -> Vec<f64> {
            let nodes = 0..mesh.nodes_m().len();
            nodes.map(|node| own.total(mesh, node)[part]).collect()
        };
        let turned = self.initial_tip_m / mesh.rigid_tip();
        let nodes_m = mesh.nodes_m();
        let moved = at(&all[0], 0).into_iter().enumerate();
        let moved = moved.map(|(node, v)| v + mesh.rigid(node)[0] * turned);
        let from_rad = self.from_rad + mesh.rigid(0)[1] * turned;
        LinkState {
            time_s,
            x_m: nodes_m.to_vec(),
            slope_rad: at(&all[0], 1).iter().map(|slope| slope + from_rad).collect(),
            slope_rate_rad_s: at(&all[1], 1),
            displacement_m: Some(moved.collect()),
            velocity_m_s: Some(at(&all[1], 0)),
            carriage: None,
        }
    }

    /// Total displacement of a node in m, every `every`-th sample.
    pub(super) fn displacement_m(&self, mesh: &Mesh, node: usize, every: NonZeroUsize) -> Vec<f64> {
        end_if_stopped();
        let at_node = |shape: &Shape| shape.displacement(mesh, node);
        let shapes: Vec<f64> = self.equations.shapes.iter().map(at_node).collect();
        let rest = self.initial_tip_m / mesh.rigid_tip() * mesh.rigid(node)[0];
        let rows = self.record.coordinates.chunks_exact(shapes.len()).step_by(every.get());
        rows.map(|q| rest + q.iter().zip(&shapes).map(|(q, v)| q * v).sum::<f64>()).collect()
    }

    /// Tip displacement in m under a torque with straight lines between its samples, from this simulation's first
    /// sample on. Friction and feedback act as in this simulation.
    pub fn straight_tip_m(&self, torque_n_m: &[f64]) -> Vec<f64> {
        let mut tip_m = Vec::with_capacity(torque_n_m.len());
        let lines = pieces(torque_n_m, Interpolation::Linear);
        let (coordinates, rates) = self.record.at(0);
        let stepper = Stepper::new(&self.equations, self.grid.step_s);
        stepper.starting_at(coordinates, rates).run(lines, |stepper| {
            tip_m.push(self.initial_tip_m + self.equations.tip(&stepper.coordinates()));
        });
        tip_m
    }

    /// Tip displacement in m of the same link with hysteretic damping ξ under a torque on the link, without friction,
    /// at the samples of this simulation.
    ///
    /// Hysteretic damping has no equation in time. Each mode responds over frequency, on a period of twice the
    /// simulation's length; the rigid rotation is integrated in time:
    ///
    /// ```text
    /// q̂_k = p_k T̂/(ω_k²(1 + 2iξ) − ω²)                        (Bayo 1987, eqs 15 and 16, mode by mode)
    /// ```
    pub fn hysteretic_tip_m(&self, ratio: f64, net_torque_n_m: &[f64]) -> Vec<f64> {
        let kappa = Complex64::new(1.0, 2.0 * ratio);
        let coordinates = &self.equations.coordinates;
        let bending = self.filtered(net_torque_n_m, |omega, torque| {
            let answers = coordinates[1..]
                .iter()
                .map(|mode| mode.tip * mode.hub_angle / (mode.square * kappa - omega * omega));
            answers.sum::<Complex64>() * torque
        });
        let rigid = self.rigid_rotation(net_torque_n_m);
        let moved = rigid.iter().zip(bending).map(|(q, bent)| q * coordinates[0].tip + bent);
        moved.map(|v| self.initial_tip_m + v).collect()
    }

    /// Difference in m between the tip of this link with viscous modal damping and a tip motion with these
    /// accelerations. The torque is the one for that motion in the same link with hysteretic damping ξ.
    ///
    /// With X the tip's and Y the hub's acceleration per torque on the link, both sums over modes, and the
    /// hub's friction b:
    ///
    /// ```text
    /// v̂_viscous/v̂_hysteretic = X_v (iω + bY_h)/(X_h (iω + bY_v)),   X = Σ −ω² v_k p_k/D_k(ω)
    /// D_h = ω_k²(1 + 2iξ) − ω²,   D_v = ω_k² + iω 2ξω_k − ω²        (Bayo 1987, eqs 12 and 16)
    /// ```
    pub fn apart_m(&self, ratio: f64, tip_acceleration_m_s2: &[f64]) -> Vec<f64> {
        let friction = self.equations.reaction.damping_n_m_s_rad;
        let kappa = Complex64::new(1.0, 2.0 * ratio);
        self.filtered(tip_acceleration_m_s2, |omega, acceleration| {
            if omega == 0.0 {
                // The acceleration of a motion from rest to rest has no mean.
                return Complex64::ZERO;
            }
            let square = omega * omega;
            let rate = Complex64::new(0.0, omega);
            let answers = |law: &dyn Fn(&Coordinate) -> Complex64| {
                let terms = self.equations.coordinates.iter().map(|mode| {
                    let per_torque = Complex64::from(-square * mode.hub_angle) / law(mode);
                    (per_torque * mode.tip, per_torque * mode.hub_angle)
                });
                terms.fold((Complex64::ZERO, Complex64::ZERO), |sum, term| {
                    (sum.0 + term.0, sum.1 + term.1)
                })
            };
            let (x_h, y_h) = answers(&|mode| mode.square * kappa - square);
            let (x_v, y_v) = answers(&|mode| mode.square - square + mode.rate_per_s * rate);
            let laws = x_v * (rate + friction * y_h) / (x_h * (rate + friction * y_v));
            (laws - 1.0) * acceleration / -square
        })
    }

    /// Filters samples by an answer at each ω in rad/s, on a period of twice the simulation's length.
    fn filtered(&self, samples: &[f64], answer: impl Fn(f64, Complex64) -> Complex64) -> Vec<f64> {
        // Two cycles of a repeating motion: a transform has an even length.
        let len = if self.repeats { 2 * self.grid.len } else { fast_length(2 * self.grid.len) };
        let pair = FourierPair::new(len);
        let mut padded = samples.to_vec();
        if self.repeats {
            padded.extend_from_slice(samples);
        }
        padded.resize(len, 0.0);
        let mut amplitudes = pair.amplitudes(padded);
        for (bin, amplitude) in amplitudes.iter_mut().enumerate() {
            *amplitude = answer(angular_frequency(bin, len, self.grid.step_s), *amplitude);
        }
        let mut filtered = pair.samples(amplitudes);
        filtered.truncate(self.grid.len);
        filtered
    }

    /// The rigid rotation's coordinate.
    fn rigid_rotation(&self, torque_n_m: &[f64]) -> Vec<f64> {
        let alone = Equations {
            coordinates: self.equations.coordinates[..1].to_vec(),
            shapes: self.equations.shapes[..1].to_vec(),
            reaction: HubReaction::default(),
            damping: None,
            drags: None,
            prescribed: None,
            losses: None,
        };
        let mut q = Vec::with_capacity(torque_n_m.len());
        let cubics = pieces(torque_n_m, Interpolation::Cubic);
        Stepper::new(&alone, self.grid.step_s)
            .run(cubics, |stepper| q.extend(stepper.coordinates()));
        q
    }
}

#[cfg(test)]
mod tests {
    use std::slice::from_ref;

    use crate::beam::{ElementCount, MeshPlan};
    use crate::link::{Hub, Link, LinkParts, uniform};
    use crate::response::{Interpolation, Play, Torque, simulate};

    #[test]
    fn the_tip_is_that_of_the_torque_played_by_straight_lines() {
        let hub = Hub { viscous_friction_n_m_s_rad: 0.1, ..uniform().hub };
        let link = Link::new(LinkParts { hub, ..uniform() }).unwrap();
        let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Total(10)), 1e-6).unwrap();
        let time_s: Vec<f64> = (0..=100).map(|k| 1e-2 * f64::from(k)).collect();
        let sine = time_s.iter().map(|t| (std::f64::consts::TAU * t).sin()).collect();
        let torque = Torque::new(&time_s, sine).unwrap();
        let play = Play { initial_tip_m: 0.5, ..Play::of(&torque) };
        let played = |play: &Play<'_>| {
            simulate(&link.clone().into(), from_ref(&plan), play, &|_| {}).unwrap()
        };
        let cubics = played(&play);
        let lines = Play { interpolation: Interpolation::Linear, ..play };
        let lines = played(&lines).tip.swap_remove(0).displacement_m;
        assert!(cubics.modes().unwrap().straight_tip_m(torque.torque_n_m()) == lines);
        assert!(cubics.tip[0].displacement_m != lines);
    }
}
