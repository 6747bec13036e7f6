//! The table of `solve --write`: efforts, or set-points of drives, as a controller plays them.

use flexlink::beam::MeshPlan;
use flexlink::cli::solve::table::{WriteArgs, WrittenTable};
use flexlink::cli::terminal::StageBar;
use flexlink::csv::Joints;
use flexlink::inverse::Solution as Inverse;
use flexlink::result::SetPoint;
use flexlink::store::Summary;

use crate::arrays::times;
use crate::keywords::{of_writing, parsed, solve_options};
use crate::prelude::*;
use crate::properties::Value::{Computed, Notices, Stored};
use crate::properties::{Properties, Value};

/// The torque at the hub, those of the joints, or the force on the carriage, as a controller plays it, or the set-points of
/// drives. Arrays have a row for each of ``time``, those of an arm a column for each joint. Units are SI. ``position``,
/// ``velocity``, ``acceleration`` and ``effort`` have a column for each joint, the carriage last, or are None.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct SetPoints {
    /// The keywords of the call as options.
    arguments: Vec<String>,
    written: WrittenTable,
    /// The summary of the solution.
    summary: Summary,
    kind: Joints,
}

impl SetPoints {
    /// The table of a solution with these options; plays it where they change the torque.
    pub(crate) fn of(
        (solution, plans): (&Inverse, &[MeshPlan]),
        summary: Summary,
        arguments: Vec<String>,
    ) -> Fails<Self> {
        let options = options_of(&arguments, "-")?;
        options.check_motion(solution.motion.ends(), solution.motion.grid().step_s)?;
        let table = options.table(solution, plans, &StageBar::hidden())?;
        let written = table.ok_or_else(|| usage(&"no table", None))?;
        let (summary, kind) = (summary.without_files(), Joints::from(&solution.arm));
        Ok(Self { arguments, written, summary, kind })
    }

    pub(crate) fn notices(&self) -> Vec<Notice> {
        self.written.warning.iter().cloned().collect()
    }

    /// A column for each joint, or no column.
    fn all(&self, set_point: SetPoint) -> Vec<&[f64]> {
        let table = &self.written.table;
        table.columns_of(set_point).map(|own| table.rows_of(own)).collect()
    }

    /// Efforts of the joints of the links.
    fn joints(&self) -> Vec<&[f64]> {
        self.all(SetPoint::Effort).into_iter().take(self.kind.links).collect()
    }

    /// The force on the carriage, the joint of one link or the last of an arm.
    fn carriage(&self) -> Vec<&[f64]> {
        self.all(SetPoint::Effort).pop().into_iter().collect()
    }

    fn write_to(&self, path: &Path, more: &[String]) -> Fails<()> {
        let options = options_of(&self.arguments, &path.display().to_string())?;
        options.check(&[], None)?;
        let summary = options.recorded_in(self.summary.clone(), Some(&self.written));
        options.write(&self.written, &summary, solve_options(more)?.digits)
    }
}

/// The options of a table in this file.
fn options_of(arguments: &[String], file: &str) -> Fails<WriteArgs> {
    let file = [format!("--write={file}")];
    parsed(&[arguments, &file].concat(), &[], &[])
}

impl Properties for SetPoints {
    const PROPERTIES: &'static [(&'static str, Value<Self>)] = &[
        ("time", Computed(|own| times(&own.written.table.grid()))),
        ("torque", Stored(Self::joints)),
        ("force", Stored(Self::carriage)),
        ("position", Stored(|own| own.all(SetPoint::Position))),
        ("velocity", Stored(|own| own.all(SetPoint::Velocity))),
        ("acceleration", Stored(|own| own.all(SetPoint::Acceleration))),
        ("effort", Stored(|own| own.all(SetPoint::Effort))),
        ("warnings", Notices(Self::notices)),
    ];

    fn kind(&self) -> Joints {
        self.kind
    }
}

#[pymethods]
impl SetPoints {
    /// The table in summary.json of a run that writes it: ``rows``, ``start_s``, ``step_s``, ``window``, ``hold``,
    /// ``tip_error`` and others.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> Raises<Any<'py>> {
        let options = options_of(&self.arguments, "-")?;
        let summary = options.recorded_in(self.summary.clone(), Some(&self.written));
        Ok(loaded(py, &summary.to_json())?.get_item("table")?)
    }

    /// Distance of the tip from its motion when the table is played: ``worst_m``, its ``share`` of the travel, ``time_s``,
    /// ``rms_m``, and ``known_to_m``. None for the whole torque, which the errors of the solution describe.
    #[getter]
    fn tip_error<'py>(&self, py: Python<'py>) -> Raises<Any<'py>> {
        Ok(self.summary(py)?.get_item("tip_error")?)
    }

    /// Differences of the table from the torque, and results of the play, a line each, as in the file.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.written.notes.clone()
    }

    /// Writes the file of ``flexlink solve --write``: ``.csv``, ``.h`` for C, ``.m`` for MATLAB and Simulink, ``.mat``,
    /// ``.npz``, ``.yaml`` or ``.json`` for ROS 2. ``digits`` is that of the command.
    #[pyo3(signature = (path, **keywords))]
    fn write(&self, py: Python<'_>, path: PathBuf, keywords: Option<Keywords<'_>>) -> Raises<()> {
        let more = of_writing(keywords.as_ref(), &["digits"])?;
        Ok(py.detach(|| self.write_to(&path, &more))?)
    }

    fn __repr__(&self) -> String {
        format!("SetPoints(rows={})", self.written.table.grid().len)
    }
}
