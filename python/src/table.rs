//! The table of `solve --write`: efforts, or set-points of drives, as a controller plays them.

use flexlink::beam::MeshPlan;
use flexlink::cli::solve::table::WrittenTable;
use flexlink::cli::solve::write_args::WriteArgs;
use flexlink::cli::terminal::StageBar;
use flexlink::csv::Joints;
use flexlink::inverse::Solution as Inverse;
use flexlink::response::Interpolation;
use flexlink::result::{SetPoint, Side};
use flexlink::store::Summary;

use crate::arrays::times;
use crate::joints::{Driven, Of};
use crate::keywords::{of_writing, parsed, solve_options};
use crate::prelude::*;
use crate::properties::Value::{Computed, Notices, OfJoints, Stored};
use crate::properties::{Named, Properties};

/// The torque at the hub, those of the joints, or the force on the carriage, as a controller plays it, or the set-points of
/// drives. Arrays have a row for each of ``time``, those of an arm a column for each joint. They are in SI, also where the
/// file has other units or counts. ``position``, ``velocity``, ``acceleration`` and ``effort`` have a column for each joint, the
/// carriage last; without their quantity they are None. The names of a :class:`Solution` show the same columns: ``hub_angle``,
/// ``joint_rate``, ``carriage``, ``torque`` and so on, with ``side="motor"`` ``motor_angle``, ``motor_rate``,
/// ``motor_acceleration`` and ``motor_torque``.
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
    /// The ``hold`` of a play as the table is for.
    pub(crate) fn hold(&self) -> Option<&'static str> {
        match self.written.table.interpolation() {
            Interpolation::Zero => Some("zero"),
            Interpolation::Linear => Some("linear"),
            Interpolation::Cubic => None,
        }
    }

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

    /// The times of the motion's file in s.
    pub(crate) fn times_of_motion(&self) -> Vec<f64> {
        let table = &self.written.table;
        let shift_s = table.moves_from_in_file_s() - table.moves_from_s();
        times(&table.grid()).into_iter().map(|time_s| time_s + shift_s).collect()
    }

    pub(crate) fn notices(&self) -> Vec<Notice> {
        self.written.warning.iter().cloned().collect()
    }

    /// A column for each joint, or no column.
    fn all(&self, set_point: SetPoint) -> Vec<&[f64]> {
        let table = &self.written.table;
        table.columns_of(set_point).map(|own| table.rows_of(own)).collect()
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

impl Driven for SetPoints {
    fn joints(&self, of: Of) -> Vec<Option<&[f64]>> {
        let set_point = match (self.written.table.side(), of) {
            (Side::Joint, Of::Effort) | (Side::Motor, Of::MotorEffort) => SetPoint::Effort,
            (Side::Joint, Of::Position) | (Side::Motor, Of::MotorPosition) => SetPoint::Position,
            (Side::Joint, Of::Rate) | (Side::Motor, Of::MotorRate) => SetPoint::Velocity,
            (Side::Joint, Of::Acceleration) | (Side::Motor, Of::MotorAcceleration) => {
                SetPoint::Acceleration
            }
            _ => return Vec::new(),
        };
        self.all(set_point).into_iter().map(Some).collect()
    }
}

impl Properties for SetPoints {
    const PROPERTIES: Named<Self> = &[
        ("time", Computed(|own| times(&own.written.table.grid()))),
        ("motor_torque", OfJoints(|own| own.of_motors(Of::MotorEffort))),
        ("motor_angle", OfJoints(|own| own.of_motors(Of::MotorPosition))),
        ("motor_rate", OfJoints(|own| own.of_motors(Of::MotorRate))),
        ("motor_acceleration", OfJoints(|own| own.of_motors(Of::MotorAcceleration))),
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
    /// ``rms_m``, and ``known_to_m``. None for a table of the solution's own samples, which its errors describe.
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
    /// ``.npz``, ``.yaml`` or ``.json`` for ROS 2, and with ``form="halstreamer"`` ``.txt`` for LinuxCNC. ``digits`` is that of
    /// the command.
    #[pyo3(signature = (path, **keywords))]
    fn write(&self, py: Python<'_>, path: PathBuf, keywords: Option<Keywords<'_>>) -> Raises<()> {
        let more = of_writing(keywords.as_ref(), &["digits"])?;
        Ok(py.detach(|| self.write_to(&path, &more))?)
    }

    fn __repr__(&self) -> String {
        format!("SetPoints(rows={})", self.written.table.grid().len)
    }
}
