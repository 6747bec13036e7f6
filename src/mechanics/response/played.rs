//! The motion of a link or an arm from a simulation.

use std::f64::consts::TAU;
use std::num::NonZeroUsize;

use rayon::prelude::*;

use super::bent::{BentPlay, JointMotion, largest_travel_m};
use super::error::SimulationWarning;
use super::modal_play::ModalPlay;
use super::state::State;
use crate::beam::{Mesh, NodalHistories};
use crate::link::ParameterError;
use crate::modal::DampingLaw;
use crate::motion::TipMotionHistories;
use crate::numeric::TimeGrid;

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
    /// Its lowest natural frequencies in rad/s without weight, the rigid rotation excluded.
    pub natural_frequencies_rad_s: Vec<f64>,
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
                let first =
                    self.links.iter().filter_map(|own| own.natural_frequencies_rad_s.first());
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
                State { links: vec![modes.state(self.mesh(), self.grid.end_s())] }
            }
            PlayedBy::Elastica(bent) => bent.state(&self.grid, self.grid.len - 1),
        }
    }
}
