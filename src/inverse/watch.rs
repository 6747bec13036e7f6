//! What long work may take of the machine, and who is told how far it has come.

use crate::motion::Periods;

/// A part of long work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Solving on a mesh; its parts are frequencies.
    Solve {
        /// Elements of the mesh.
        elements: usize,
    },
    /// Transforming what was solved to samples over time; its parts are nodes.
    Transform,
    /// Writing a table; its parts are rows.
    Write,
}

/// Gets the progress of long work.
pub trait Watch: Sync {
    /// A stage of so many parts begins.
    fn begin(&self, stage: Stage, parts: usize);

    /// So many parts of it are done, in any thread.
    fn advance(&self, parts: usize);
}

/// Ignores all progress.
#[derive(Debug, Clone, Copy)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn begin(&self, _: Stage, _: usize) {}

    fn advance(&self, _: usize) {}
}

/// Memory for an inversion, who gets its progress, and what it shares with others. By default all memory, no
/// one and nothing.
#[derive(Clone, Copy)]
pub struct Resources<'a> {
    /// Memory in bytes; an inversion that would take more is refused. `None`: no limit.
    pub memory_bytes: Option<usize>,
    /// Gets the progress.
    pub watch: &'a dyn Watch,
    /// Cut-off and periods that several inversions share; `None`: the inversion computes its own.
    pub periods: Option<&'a Periods>,
}

impl Default for Resources<'_> {
    fn default() -> Self {
        Self { memory_bytes: None, watch: &Unwatched, periods: None }
    }
}
