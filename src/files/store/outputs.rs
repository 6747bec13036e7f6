//! Choice of a run's tables, with their nodes, rows and digits.

use std::num::NonZeroUsize;

use super::names::{
    CHORD, DEFLECTIONS, FORCE, MOMENTS, MOTOR, RIGID_TORQUE, SUMMARY, solved_files,
};
use crate::beam::{nearest_node, node_at};
use crate::csv::Digits;
use crate::inverse::{NodalTable, Solution};
use crate::link::{Link, ParameterError};
use crate::numeric::{ThinnedGrid, TimeGrid};
use crate::response::Played;

/// Choice of the results of a solution or a simulation to write, and their digits.
#[derive(Debug, Clone, PartialEq)]
pub struct RunOutputs {
    /// Nodes of the nodal tables; `None`: all.
    pub nodes: Option<Vec<usize>>,
    /// Distances from the axis in m of nodes of the nodal tables, besides `nodes`. Distances beyond a link do not
    /// count.
    pub stations_m: Vec<f64>,
    /// Number of samples per row of the nodal tables.
    pub every: NonZeroUsize,
    /// Whether a solution has `nodal_deflections.csv`: deflection w from the hub's tangent line.
    pub deflections: bool,
    /// Whether a solution has `bending_moments.csv`.
    pub moments: bool,
    /// Whether a solution has a small folder for later comparison: torque, hub or joint angles, tip, displacements of
    /// three nodes. Tables have every fifth row, counted from the motion's first sample.
    pub golden: bool,
    /// Digits of all numbers.
    pub digits: Digits,
}

/// Rows of a golden folder.
const GOLDEN_EVERY: NonZeroUsize = NonZeroUsize::new(5).unwrap();

impl Default for RunOutputs {
    /// Every node, every sample, no table on demand.
    fn default() -> Self {
        Self {
            nodes: None,
            stations_m: Vec::new(),
            every: NonZeroUsize::MIN,
            deflections: false,
            moments: false,
            golden: false,
            digits: Digits::default(),
        }
    }
}

impl RunOutputs {
    /// Names of the files of a solution, summary.json last.
    pub(super) fn files<'a>(&self, links: impl IntoIterator<Item = &'a Link>) -> Vec<&'static str> {
        let drives: Vec<bool> = links.into_iter().map(|link| link.drive().is_some()).collect();
        let links = drives.len();
        let is_written = |name: &&str| match *name {
            name if name == MOTOR.name(links) => drives.contains(&true),
            name if name == DEFLECTIONS.name(links) => self.deflections,
            name if name == MOMENTS.name(links) => self.moments,
            _ => true,
        };
        let files = solved_files(links).filter(is_written);
        files.filter(|name| self.has(name, links)).chain([SUMMARY]).collect()
    }

    /// False for a file that a golden folder lacks.
    pub(super) fn has(&self, name: &str, links: usize) -> bool {
        !self.golden
            || [&RIGID_TORQUE, &MOTOR, &CHORD, &FORCE].iter().all(|file| file.name(links) != name)
    }

    /// The rows of tables over time.
    pub fn rows(&self, grid: &TimeGrid) -> ThinnedGrid {
        if self.golden { grid.multiples(GOLDEN_EVERY) } else { grid.thinned(NonZeroUsize::MIN) }
    }

    /// The rows of tables at nodes.
    pub(super) fn nodal_rows(&self, grid: &TimeGrid) -> ThinnedGrid {
        if self.golden { self.rows(grid) } else { grid.thinned(self.every) }
    }

    /// The deflections of a link's nodal tables, computed on request.
    ///
    /// # Errors
    /// [`ParameterError`] if a node is not one of the mesh.
    pub(super) fn deflections<'a>(
        &self,
        solution: &'a Solution,
    ) -> Result<NodalTable<'a>, ParameterError> {
        let nodes = self.nodes_of(solution.links[0].mesh().nodes_m());
        solution.deflections_at(&nodes, self.nodal_rows(&solution.grid))
    }

    /// The nodes to write: the list and the stations, three for a golden folder, or all.
    pub(super) fn nodes_of(&self, nodes_m: &[f64]) -> Vec<usize> {
        if self.golden {
            return nodes_at_thirds(nodes_m);
        }
        let mut nodes = match &self.nodes {
            Some(list) => list.clone(),
            None if self.stations_m.is_empty() => return (0..nodes_m.len()).collect(),
            None => Vec::new(),
        };
        for node in self.stations_m.iter().filter_map(|at_m| node_at(nodes_m, *at_m)) {
            if !nodes.contains(&node) {
                nodes.push(node);
            }
        }
        nodes
    }

    /// Memory in bytes of the nodal table of a simulation.
    pub fn simulation_bytes(&self, played: &Played) -> usize {
        let nodes = played.nodes_m().into_iter().map(|nodes_m| self.nodes_of(nodes_m).len());
        size_of::<f64>()
            * played.tip.len()
            * nodes.sum::<usize>()
            * played.grid.len.div_ceil(self.every.get())
    }
}

/// The nodes nearest to a third and two thirds of the length from the root, and the tip.
fn nodes_at_thirds(nodes_m: &[f64]) -> Vec<usize> {
    let last = nodes_m.len() - 1;
    let at_m = |thirds: f64| nodes_m[0] + thirds / 3.0 * (nodes_m[last] - nodes_m[0]);
    let inner = |thirds: f64| nearest_node(&nodes_m[..last], at_m(thirds));
    let mut nodes = vec![inner(1.0), inner(2.0), last];
    nodes.dedup();
    nodes
}
