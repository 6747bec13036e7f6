use crate::numeric::ThinnedGrid;

/// Histories of one quantity at some nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalHistories {
    /// Numbers of the nodes.
    pub nodes: Vec<usize>,
    /// Times of the samples.
    pub grid: ThinnedGrid,
    /// Samples of each node.
    pub samples: Vec<Vec<f64>>,
}
