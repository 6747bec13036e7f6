/// What long work is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Solving on a mesh of so many elements; parts are frequencies.
    Solve {
        /// Elements of the mesh.
        elements: usize,
    },
    /// Transforming what was found for them; parts are nodes.
    Transform,
    /// Writing a table; parts are rows.
    Write,
}

/// Someone who is told how far long work has come.
pub trait Watch: Sync {
    /// A stage of so many parts begins.
    fn begin(&self, stage: Stage, parts: usize);

    /// So many parts of it are done, in any thread.
    fn advance(&self, parts: usize);
}

/// No one.
#[derive(Debug, Clone, Copy)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn begin(&self, _: Stage, _: usize) {}

    fn advance(&self, _: usize) {}
}
