//! Choices of a caller: accuracy and resources of an inversion, and the watcher of its progress.

use serde::{Deserialize, Serialize};

use super::error::{InversionError, RefusedEnds};
use crate::elastica::SecondOrder;
use crate::link::{Link, ParameterError};
use crate::model::KeptModes;
use crate::motion::{Ends, Periods};

/// Share of the tolerance, and least change, that end an iteration of second-order terms.
const ITERATED: f64 = 0.01;
const FINEST: f64 = 1e-11;

/// Required accuracy of the answer, its time around the motion, and its modes.
///
/// Deserialization checks the values and fills in defaults.
///
/// ```
/// use flexlink::inverse::Analysis;
/// let analysis: Analysis = serde_json::from_str(r#"{"tolerance": 1e-4}"#).unwrap();
/// assert_eq!(analysis, Analysis::new(1e-4, None, None)?);
/// assert!(serde_json::from_str::<Analysis>(r#"{"tolerance": 2.0}"#).is_err());
/// # Ok::<(), flexlink::link::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct Analysis {
    tolerance: f64,
    tip_tolerance: f64,
    lead_s: Option<f64>,
    lag_s: Option<f64>,
    modes: Option<usize>,
    with_moments: bool,
    without_tables: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    second_order: Option<SecondOrder>,
}

impl Analysis {
    /// Share of its peak that padding and wrap-around may cost every quantity.
    pub const DEFAULT_TOLERANCE: f64 = 1e-6;

    /// Share of its travel that the tip may stray from the wanted motion.
    pub const DEFAULT_TIP_TOLERANCE: f64 = 1e-6;

    /// Checks the ranges: `tolerance` in [1e-12, 1e-2], lead and lag at least 0 s. All modes are kept.
    ///
    /// # Errors
    /// [`ParameterError`] names the first value out of its range.
    pub fn new(
        tolerance: f64,
        lead_s: Option<f64>,
        lag_s: Option<f64>,
    ) -> Result<Self, ParameterError> {
        if !(1e-12..=1e-2).contains(&tolerance) {
            let must = "must lie in [1e-12, 1e-2]";
            return Err(ParameterError::new("analysis.tolerance", tolerance, "", must));
        }
        for (parameter, value) in [("analysis.lead", lead_s), ("analysis.lag", lag_s)] {
            if let Some(value) = value.filter(|v| !(v.is_finite() && *v >= 0.0)) {
                let must = "must be finite and at least 0";
                return Err(ParameterError::new(parameter, value, "s", must));
            }
        }
        Ok(Self { tolerance, lead_s, lag_s, ..Self::default() })
    }

    /// Keeps only the rigid mode and the lowest `modes` flexible ones, the reduction that Bayo (1987) names after eq
    /// 12.
    ///
    /// ```
    /// use flexlink::inverse::Analysis;
    /// assert_eq!(Analysis::default().modes(), None);
    /// assert_eq!(Analysis::default().keeping_modes(5)?.modes(), Some(5));
    /// # Ok::<(), flexlink::link::ParameterError>(())
    /// ```
    ///
    /// # Errors
    /// [`ParameterError`] for 0 modes.
    pub fn keeping_modes(self, modes: usize) -> Result<Self, ParameterError> {
        if modes == 0 {
            return Err(ParameterError::new("analysis.modes", modes, "", "must be at least 1"));
        }
        Ok(Self { modes: Some(modes), ..self })
    }

    /// Sets the largest distance of the tip from the wanted motion, over its travel. The solver stops at the lowest
    /// sufficient frequency (see [`TipMotion::cutoff`]), for 0 at the Nyquist frequency.
    ///
    /// [`TipMotion::cutoff`]: crate::motion::TipMotion::cutoff
    ///
    /// # Errors
    /// [`ParameterError`] unless it is 0 or lies in [1e-12, 1e-1].
    pub fn with_tip_tolerance(self, tip_tolerance: f64) -> Result<Self, ParameterError> {
        if tip_tolerance != 0.0 && !(1e-12..=1e-1).contains(&tip_tolerance) {
            let must = "must be 0, for all frequencies, or lie in [1e-12, 1e-1]";
            return Err(ParameterError::new("analysis.tip_tolerance", tip_tolerance, "", must));
        }
        Ok(Self { tip_tolerance, ..self })
    }

    /// Measures bending moments along the link, too.
    #[must_use]
    pub fn with_moments(self) -> Self {
        Self { with_moments: true, ..self }
    }

    /// Suits callers that write no tables over time: skips measuring the nodes' displacements and the hub's
    /// acceleration, except on an automatic mesh.
    #[must_use]
    pub fn without_tables(self) -> Self {
        Self { without_tables: true, ..self }
    }

    /// Sets the second-order terms to count. By default [`Analysis::second_order_of`] the link decides.
    #[must_use]
    pub fn with_second_order(self, second_order: SecondOrder) -> Self {
        Self { second_order: Some(second_order), ..self }
    }

    /// Refuses ends of a motion that do not suit lead and lag, links that bend far or sag, or links with drag.
    pub(super) fn refuse_ends(
        &self,
        ends: Ends,
        (is_bent, has_drag): (bool, bool),
    ) -> Result<(), InversionError> {
        let has_edges = self.lead_s.is_some() || self.lag_s.is_some();
        let refused = match ends {
            Ends::Moving if is_bent => Some(RefusedEnds::Bent),
            Ends::Moving if has_drag => Some(RefusedEnds::Drag),
            Ends::Periodic if has_edges => Some(RefusedEnds::Edges),
            _ => None,
        };
        refused.map_or(Ok(()), |why| Err(InversionError::Ends(why)))
    }

    /// Second-order terms to count for a link: the caller's choice, else all terms with weight and no terms without it.
    pub fn second_order_of(&self, link: &Link) -> SecondOrder {
        let default = if link.has_weight() { SecondOrder::Full } else { SecondOrder::None };
        self.second_order.unwrap_or(default)
    }

    /// Change that ends an iteration of second-order terms: a share of the tolerance, as derivatives converge late, but
    /// above round-off.
    pub(super) fn iterated_to(&self) -> f64 {
        (ITERATED * self.tolerance).max(FINEST)
    }

    /// The caller's choice of second-order terms.
    pub(super) fn second_order(&self) -> Option<SecondOrder> {
        self.second_order
    }

    /// Share of its peak that padding and wrap-around may cost every quantity.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Share of its travel that the tip may stray from the wanted motion; 0: the solver covers all frequencies.
    pub fn tip_tolerance(&self) -> f64 {
        self.tip_tolerance
    }

    /// Whether the inversion measures bending moments along the link.
    pub fn measures_moments(&self) -> bool {
        self.with_moments
    }

    /// Whether the inversion measures all quantities in tables over time, on every mesh.
    pub fn measures_tables(&self) -> bool {
        !self.without_tables
    }

    /// Time to add before the trajectory's first sample in s; `None`: as much as needed.
    pub fn lead_s(&self) -> Option<f64> {
        self.lead_s
    }

    /// Time to add after the trajectory's last sample in s; `None`: as much as needed.
    pub fn lag_s(&self) -> Option<f64> {
        self.lag_s
    }

    /// Flexible modes to keep, from the first, at least 1; `None`: all that the mesh has.
    pub fn modes(&self) -> Option<usize> {
        self.modes
    }

    /// Modes of the answer.
    pub fn kept_modes(&self) -> KeptModes {
        self.modes.map_or(KeptModes::All, KeptModes::First)
    }
}

impl Default for Analysis {
    fn default() -> Self {
        Self {
            tolerance: Self::DEFAULT_TOLERANCE,
            tip_tolerance: Self::DEFAULT_TIP_TOLERANCE,
            lead_s: None,
            lag_s: None,
            modes: None,
            with_moments: false,
            without_tables: false,
            second_order: None,
        }
    }
}

/// An unchecked [`Analysis`] from a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Unchecked {
    tolerance: Option<f64>,
    tip_tolerance: Option<f64>,
    lead_s: Option<f64>,
    lag_s: Option<f64>,
    modes: Option<usize>,
    #[serde(default)]
    with_moments: bool,
    #[serde(default)]
    without_tables: bool,
    second_order: Option<SecondOrder>,
}

impl TryFrom<Unchecked> for Analysis {
    type Error = ParameterError;

    fn try_from(read: Unchecked) -> Result<Self, ParameterError> {
        let Unchecked { lead_s, lag_s, with_moments, without_tables, second_order, .. } = read;
        let analysis = Self::new(read.tolerance.unwrap_or(Self::DEFAULT_TOLERANCE), lead_s, lag_s)?
            .with_tip_tolerance(read.tip_tolerance.unwrap_or(Self::DEFAULT_TIP_TOLERANCE))?;
        let analysis = match read.modes {
            Some(modes) => analysis.keeping_modes(modes)?,
            None => analysis,
        };
        Ok(Self { with_moments, without_tables, second_order, ..analysis })
    }
}

/// A part of long work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Solving on a mesh; its parts are frequencies.
    Solve {
        /// Elements of the mesh.
        elements: usize,
    },
    /// Transforming amplitudes to samples over time; its parts are nodes.
    Transform,
    /// Writing a table; its parts are rows.
    Write,
}

/// Receives the progress of long work.
pub trait Watch: Sync {
    /// Begins a stage with this number of parts.
    fn begin(&self, stage: Stage, parts: usize);

    /// Reports further finished parts of the stage, from any thread.
    fn advance(&self, parts: usize);
}

/// Ignores all progress.
#[derive(Debug, Clone, Copy)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn begin(&self, _: Stage, _: usize) {}

    fn advance(&self, _: usize) {}
}

/// Memory limit of an inversion, the watcher of its progress, and periods shared with other inversions. The default has
/// no limit, no watcher and no shared periods.
#[derive(Clone, Copy)]
pub struct Resources<'a> {
    /// Memory limit in bytes: a larger inversion is refused. `None`: no limit.
    pub memory_bytes: Option<usize>,
    /// Receives the progress.
    pub watch: &'a dyn Watch,
    /// Cut-off and periods that several inversions share; `None`: the inversion computes them.
    pub periods: Option<&'a Periods>,
    /// True for one of many trials, which only estimate the error of the linear model and never count the terms.
    pub is_trial: bool,
}

impl Default for Resources<'_> {
    fn default() -> Self {
        Self { memory_bytes: None, watch: &Unwatched, periods: None, is_trial: false }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flexible_mode_must_be_kept_and_nothing_else_changes() {
        let analysis = Analysis::new(1e-4, Some(0.5), None).unwrap();
        let refused = analysis.keeping_modes(0).unwrap_err().to_string();
        assert_eq!(refused, "analysis.modes = 0, but must be at least 1");
        let reduced = analysis.keeping_modes(1).unwrap();
        assert_eq!(reduced, Analysis { modes: Some(1), ..analysis });
    }

    #[test]
    fn a_stored_analysis_is_read_back_and_checked() {
        let analysis = Analysis::new(1e-4, Some(0.5), None).unwrap().keeping_modes(3).unwrap();
        let analysis =
            analysis.with_moments().without_tables().with_second_order(SecondOrder::First);
        let stored = serde_json::to_string(&analysis).unwrap();
        assert_eq!(serde_json::from_str::<Analysis>(&stored).unwrap(), analysis);
        assert_eq!(serde_json::from_str::<Analysis>("{}").unwrap(), Analysis::default());
        for wrong in [r#"{"modes": 0}"#, r#"{"lag_s": -1.0}"#, r#"{"tip_tolerance": 1.0}"#] {
            assert!(serde_json::from_str::<Analysis>(wrong).is_err(), "{wrong}");
        }
    }
}
