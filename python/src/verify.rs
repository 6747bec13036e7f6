//! `verify`: a solution measured by other means.

use flexlink::cli::terminal::StageBar;
use flexlink::store::verification_json;
use flexlink::verify::Verification as Checks;

use crate::keywords::{solve_options, take_arguments};
use crate::link::Link;
use crate::motion::Call;
use crate::prelude::*;
use crate::solution::Solution;
use crate::threads::until_pressed;

/// The checks of a solution by other means than that of the solution.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Verification(Checks);

/// Checks a solution by independent methods, as ``flexlink verify``: the torque is played, elements and step are halved,
/// the energy is balanced, and so on. ``solution`` is the result of :func:`solve`, or a link with the motion of such a call in
/// the next arguments. ``digits`` are those of the torque that is played. Python's filters receive a warning for each check
/// out of its bound. Ctrl-C ends it.
///
/// >>> import flexlink
/// >>> strip = {"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}
/// >>> link = flexlink.Link(segments=[strip], hub={"inertia": 0.1}, damping={"ratio": 0.02})
/// >>> motion = flexlink.trajectory("min-jerk", distance=0.3, duration=1.5, step=0.005)
/// >>> verified = flexlink.verify(flexlink.solve(link, **motion))
/// >>> verified.passes, flexlink.verify(link, **motion).checks == verified.checks
/// (True, True)
/// >>> [check["found"] < check["bound"] for check in verified.checks if check["name"] == "tip_error"]
/// [True]
#[pyfunction]
#[pyo3(signature = (solution, time=None, **keywords))]
pub(crate) fn verify<'py>(
    py: Python<'py>,
    solution: &Any<'py>,
    time: Option<Any<'py>>,
    keywords: Option<Keywords<'py>>,
) -> Raises<Verification> {
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let digits = solve_options(&take_arguments(&keywords, &["digits"])?)?.digits;
    let check = |own: &Solution| {
        let stages = StageBar::hidden();
        Ok(Verification(own.solved.verified(&own.plans, digits, &stages)?))
    };
    let verification = match (solution.cast::<Solution>(), solution.cast::<Link>(), time) {
        (Ok(solved), _, None) if keywords.is_empty() => {
            let solved = solved.get();
            until_pressed(py, || check(solved))?
        }
        (Err(_), Ok(link), Some(time)) => {
            let link = link.get();
            let call = Call::take(&time, &keywords, link.links())?;
            until_pressed(py, || check(&Solution::of_call(link, call)?))?
        }
        _ => {
            let must = "must be a solution alone, or a link with its motion";
            let message = format!("solution = {}, but {must}", solution.get_type());
            return Err(PyTypeError::new_err(message).into());
        }
    };
    warn(py, &verification.notices())?;
    Ok(verification)
}

impl Verification {
    /// A warning for each check out of its bound.
    fn notices(&self) -> Vec<Notice> {
        let failed = self.0.failed();
        let notice = |own: &_| -> Notice {
            let flexlink::result::Check { what, hint, .. } = own;
            Notice::new("out_of_bounds", format!("out of bounds: {what}"), hint)
        };
        failed.map(notice).collect()
    }
}

#[pymethods]
impl Verification {
    /// True if every check is within its bound.
    #[getter]
    fn passes(&self) -> bool {
        self.0.failed().next().is_none()
    }

    /// The checks, as in summary.json: ``name``, ``what`` was measured, ``found`` and its ``bound``, the ``reason`` of a missing
    /// number, and whether the check ``passes``.
    #[getter]
    fn checks<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        loaded(py, &verification_json(&self.0))
    }

    /// Warnings, which Python's filters received, too.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Any<'py>>> {
        objects(py, &self.notices())
    }

    fn __repr__(&self) -> String {
        let (checks, failed) = (self.0.checks.len(), self.0.failed().count());
        format!("Verification(checks={checks}, failed={failed})")
    }
}
