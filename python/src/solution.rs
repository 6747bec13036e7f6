//! `solve`: the solution of a link or an arm with its inputs, and the files of `flexlink solve`.

use pyo3::sync::PyOnceLock;

use flexlink::beam::NodalHistories;
use flexlink::cli::problem::{Problem, Solved};
use flexlink::cli::solve::run::SolveOptions;
use flexlink::cli::terminal::memory;
use flexlink::csv::Joints;
use flexlink::inverse::{JointMotion, MotorHistories, Resources, Solution as Inverse};
use flexlink::link::ParameterError;
use flexlink::store::{OutputFolder, RunInputs};

use crate::arrays::{Every, Nodes, checked, places_of_nodes, rows, times};
use crate::keywords::{self, solve_options};
use crate::link::{Link, PickledSource, Source};
use crate::motion::Call;
use crate::prelude::*;
use crate::properties::Value::{Computed, Entry, Notices, Stored};
use crate::properties::{Properties, Value, check, frame, slices};
use crate::samples::{Pickled, Samples, meshed};
use crate::threads::{apart, until_pressed, without_python};

/// Keywords of `write`.
const WRITING: [&str; 6] = ["nodes", "stations", "every", "deflections", "digits", "golden"];

/// Torques and motion of the joints that move the tip as wanted: those of one hub, or those of an arm in arrays with a
/// column for each joint, the inner one first. Arrays have a row for each of ``time``; those of one link are views that
/// cannot be written to. Units are SI.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Solution {
    source: Source,
    samples: Arc<Samples>,
    /// The keywords of the call as options.
    arguments: Vec<String>,
    pub(crate) solved: Solved,
    /// How the file of the motion was read.
    reading: Vec<Notice>,
    warnings: Vec<Notice>,
    summary: PyOnceLock<String>,
}

impl Solution {
    /// Solves the problem of a call.
    fn of_call(link: &Link, call: Call<'_>) -> Fails<Self> {
        let options = solve_options(&call.arguments)?;
        let (wanted, reading) = call.wanted(link, &options)?;
        let specification = meshed(link.specification.clone(), &options)?;
        let problem = Problem::of(&link.source.file, specification, wanted);
        let periods = call.motion.map(|motion| &*motion.periods);
        let memory_bytes = memory::available();
        let resources = Resources { memory_bytes, periods, ..Resources::default() };
        let inputs = (link.source.clone(), call.samples, call.arguments);
        Ok(Self { reading, ..Self::of(problem, &resources, inputs)? })
    }

    /// Solves a problem with these inputs: link file, motion, and options of the call.
    pub(crate) fn of(
        problem: Problem,
        resources: &Resources,
        (source, samples, arguments): (Source, Arc<Samples>, Vec<String>),
    ) -> Fails<Self> {
        let solved = problem.solved_within(resources)?;
        let limits = solved.exceeded.iter().map(Notice::from);
        let warnings = solved.solution.warnings.iter().map(Notice::from).chain(limits);
        let warnings = warnings.map(|own| own.worded(&solved.solution.arm)).collect();
        Ok(Self {
            source,
            samples,
            arguments,
            solved,
            reading: Vec::new(),
            warnings,
            summary: PyOnceLock::new(),
        })
    }

    fn inverse(&self) -> &Inverse {
        &self.solved.solution
    }

    /// A history of the joint of each link.
    fn joints(&self, of: fn(&JointMotion) -> &Vec<f64>) -> Vec<&[f64]> {
        slices(self.inverse().joints.iter().map(of).take(self.links()))
    }

    /// A history of the carriage, the joint of one link or the last of an arm.
    fn carriage(&self, of: fn(&JointMotion) -> &Vec<f64>) -> Vec<&[f64]> {
        slices(self.inverse().joints.last().map(of).into_iter())
    }

    /// The motors of the joints that have a drive.
    fn motors(&self) -> impl Iterator<Item = &MotorHistories> {
        self.inverse().joints.iter().filter_map(|joint| joint.motor.as_ref())
    }

    /// Remarks on the motion's file and on unusual input.
    fn notices(&self) -> Vec<Notice> {
        let remarks = self.solved.remarks().iter().map(Notice::from);
        let remarks = remarks.map(|own| own.worded(&self.inverse().arm));
        self.reading.iter().cloned().chain(remarks).collect()
    }

    /// The options of the call and of writing.
    fn options(&self, more: Vec<String>) -> Fails<SolveOptions> {
        let changes = self.source.changes.iter();
        let changes = changes.flat_map(|change| ["--set".to_owned(), change.clone()]);
        solve_options(&changes.chain(self.arguments.clone()).chain(more).collect::<Vec<_>>())
    }

    /// The inputs that the command would record. Those without files have only the arguments.
    fn record(&self, options: &SolveOptions) -> RunInputs {
        match self.samples.file() {
            Some(motion) if self.source.is_file => {
                RunInputs::of_solve(&self.source.file, motion, options.arguments())
            }
            _ => RunInputs::of_arguments(options.arguments()),
        }
    }

    /// Writes the files of the command, with more options.
    pub(crate) fn write_into(&self, folder: &Path, more: Vec<String>) -> Fails<()> {
        let options = self.options(more)?;
        options.nodes.check(&self.inverse().nodes_m())?;
        let (inputs, outputs) = (self.record(&options), options.outputs());
        let stage = || Ok(OutputFolder::stage(folder, &|_| {})?);
        self.solved.write(inputs, &outputs, memory::available(), stage)
    }

    /// Acceleration of the joint of one link, or of the carriage of an arm, by its name.
    fn acceleration<'py>(&self, py: Python<'py>, name: &str) -> Raises<Bound<'py, PyArray1<f64>>> {
        check(name, self.kind())?;
        let last = self.inverse().joints.len() - 1;
        let find = || Ok(self.inverse().acceleration_rad_s2(last).into_owned());
        Ok(PyArray1::from_vec(py, without_python(py, find)?))
    }

    /// A quantity of this name at nodes, all by default, of every `every`-th sample.
    fn nodal<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        (nodes, every): (Nodes, Every),
        find: impl FnOnce(&Inverse, &[usize]) -> Result<NodalHistories, ParameterError> + Send,
    ) -> Table<'py> {
        check(name, self.kind())?;
        let solution = self.inverse();
        let samples = solution.grid.thinned(every.0).len();
        let nodes = checked(nodes, solution.links[0].mesh().nodes_m().len(), samples)?;
        let histories = until_pressed(py, || Ok(find(solution, &nodes)?))?;
        Ok(rows(py, &histories.samples, samples)?)
    }
}

impl Properties for Solution {
    const PROPERTIES: &'static [(&'static str, Value<Self>)] = &[
        ("time", Computed(|own| times(&own.inverse().grid))),
        ("torque", Stored(|own| own.joints(|joint| &joint.torque_n_m))),
        ("force", Stored(|own| own.carriage(|joint| &joint.torque_n_m))),
        ("rigid_torque", Stored(|own| own.joints(|joint| &joint.rigid_torque_n_m))),
        ("rigid_force", Stored(|own| own.carriage(|joint| &joint.rigid_torque_n_m))),
        ("hub_angle joint_angle", Stored(|own| own.joints(|joint| &joint.angle_rad))),
        ("carriage", Stored(|own| own.carriage(|joint| &joint.angle_rad))),
        ("hub_rate joint_rate", Stored(|own| own.joints(|joint| &joint.rate_rad_s))),
        ("carriage_velocity", Stored(|own| own.carriage(|joint| &joint.rate_rad_s))),
        (
            "rigid_hub_angle rigid_carriage",
            Stored(|own| own.joints(|joint| &joint.rigid_angle_rad)),
        ),
        ("root_moment", Stored(|own| vec![&own.inverse().links[0].root_moment_n_m])),
        ("chord_angle", Stored(|own| slices(own.inverse().shapes().map(|own| &own.chord[0])))),
        ("tip_displacement", Stored(|own| vec![&own.inverse().tip[0].displacement_m])),
        ("tip_velocity", Stored(|own| vec![&own.inverse().tip[0].velocity_m_s])),
        ("tip_acceleration", Stored(|own| vec![&own.inverse().tip[0].acceleration_m_s2])),
        ("tip_deflection", Computed(|own| own.inverse().tip_deflection_m(0))),
        ("tip", Stored(|own| slices(own.inverse().tip.iter().map(|axis| &axis.displacement_m)))),
        ("motor_torque", Stored(|own| slices(own.motors().map(|motor| &motor.torque_n_m)))),
        ("motor_rate", Stored(|own| slices(own.motors().map(|motor| &motor.rate_rad_s)))),
        (
            "motor_current",
            Stored(|own| slices(own.motors().filter_map(|own| own.current_a.as_ref()))),
        ),
        (
            "motor_voltage",
            Stored(|own| slices(own.motors().filter_map(|own| own.voltage_v.as_ref()))),
        ),
        ("nodes", Stored(|own| vec![own.inverse().links[0].mesh().nodes_m()])),
        ("errors", Entry),
        ("results", Entry),
        ("warnings", Notices(|own| own.warnings.clone())),
        ("remarks", Notices(Self::notices)),
    ];
    const FRAME: &'static str = "torque force rigid_torque rigid_force hub_angle joint_angle carriage hub_rate joint_rate carriage_velocity hub_acceleration carriage_acceleration tip_displacement tip_velocity tip_acceleration tip_deflection tip";

    fn kind(&self) -> Joints {
        Joints::from(&self.inverse().arm)
    }
}

#[pymethods]
impl Solution {
    /// Content of a run's summary.json.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> Raises<Any<'py>> {
        let write = || {
            let options = self.options(Vec::new())?;
            let inputs = self.record(&options);
            Ok(self.solved.summary(inputs, None, &options.outputs()).to_json())
        };
        let text = self.summary.get_or_try_init(py, || without_python(py, write))?;
        Ok(loaded(py, text)?)
    }

    /// Hub acceleration in rad/s², computed by each call.
    #[getter]
    fn hub_acceleration<'py>(&self, py: Python<'py>) -> Raises<Bound<'py, PyArray1<f64>>> {
        self.acceleration(py, "hub_acceleration")
    }

    /// Acceleration of the carriage in m/s², computed by each call.
    #[getter]
    fn carriage_acceleration<'py>(&self, py: Python<'py>) -> Raises<Bound<'py, PyArray1<f64>>> {
        self.acceleration(py, "carriage_acceleration")
    }

    /// Displacements of the nodes of one link in m, numbered from 0 at the root, all by default: a row for each sample, or
    /// for every ``every``-th, a column for each node.
    #[pyo3(signature = (nodes=None, every=Every::ALL))]
    fn displacements<'py>(&self, py: Python<'py>, nodes: Nodes, every: Every) -> Table<'py> {
        self.nodal(py, "displacements", (nodes, every), |own, nodes| {
            Ok(own.displacements(nodes, every.0)?.histories())
        })
    }

    /// Deflections of nodes in m from the hub's tangent line, in the form of ``displacements``.
    #[pyo3(signature = (nodes=None, every=Every::ALL))]
    fn deflections<'py>(&self, py: Python<'py>, nodes: Nodes, every: Every) -> Table<'py> {
        self.nodal(py, "deflections", (nodes, every), |own, nodes| {
            Ok(own.deflections(nodes, every.0)?.histories())
        })
    }

    /// Bending moments at nodes in N m, in the form of ``displacements``.
    #[pyo3(signature = (nodes=None, every=Every::ALL))]
    fn moments<'py>(&self, py: Python<'py>, nodes: Nodes, every: Every) -> Table<'py> {
        self.nodal(py, "moments", (nodes, every), |own, nodes| {
            Ok(own.moments(nodes, every.0)?.histories())
        })
    }

    /// x and y in m of the nodes of an arm's link, numbered from 0: an array over time, node and axis.
    fn positions<'py>(&self, py: Python<'py>, link: usize) -> Places<'py> {
        check("positions", self.kind())?;
        let shape = self.inverse().shapes().nth(link);
        let shape = shape.ok_or_else(|| no_link(link, self.links()))?;
        Ok(places_of_nodes(py, &shape.positions_m, self.inverse().grid.len)?)
    }

    /// Writes the files of ``flexlink solve`` into a folder, all or none: the same bytes, also of summary.json if link and
    /// motion are files. Keywords are its options ``nodes``, ``every``, ``deflections``, ``digits``, ``golden``, and
    /// ``stations``, distances in m of nodes from the axis, or from the joint of an arm's link: :func:`solve` with the same
    /// keyword puts nodes there.
    #[pyo3(signature = (folder, **keywords))]
    fn write(&self, py: Python<'_>, folder: PathBuf, keywords: Option<Keywords<'_>>) -> Raises<()> {
        let more = keywords::of_writing(keywords.as_ref(), &WRITING)?;
        apart(py, || self.write_into(&folder, more))
    }

    /// The histories as a `pandas.DataFrame` over the time, those of an arm with a column for each joint: ``torque1``,
    /// ``torque2``.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Any<'py>> {
        frame(slf)
    }

    /// A pickle holds link and motion: they are solved again where it is read.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> Reduced<'py> {
        let (py, own) = (slf.py(), slf.get());
        let arguments = (own.source.pickled(), own.samples.pickled(py)?, own.arguments.clone());
        Ok((slf.get_type().getattr("_unpickled")?, arguments.into_pyobject(py)?))
    }

    #[staticmethod]
    fn _unpickled(
        py: Python<'_>,
        link: PickledSource,
        samples: Pickled<'_>,
        arguments: Vec<String>,
    ) -> Raises<Self> {
        let samples = Arc::new(Samples::unpickled(samples)?);
        let call = Call { samples, arguments, motion: None };
        let link = Link::unpickled(link)?;
        without_python(py, || Self::of_call(&link, call))
    }

    fn __repr__(&self) -> String {
        let joints_or_peak = match &self.solved.metrics.joints[..] {
            [hub] => {
                let name = self.inverse().arm.joint().named("peak_torque");
                format!("{name}={:.6}", hub.peak_torque_n_m.value)
            }
            joints => format!("joints={}", joints.len()),
        };
        format!("Solution(samples={}, {joints_or_peak})", self.inverse().grid.len)
    }
}

/// Refusal of the number of a link.
pub(crate) fn no_link(link: usize, links: usize) -> Failure {
    usage(&format!("link = {link}, but must be below {links}, the number of links"), None)
}

/// Computes the torque at the hub of a link, or the torques of an arm's joints, for a motion of the tip.
///
/// The motion is arrays over ``time`` in s, evenly spaced: ``acceleration`` in m/s², ``displacement`` along the arc in
/// m, ``velocity`` in m/s, or ``angle`` in rad; or a file, whose path is in place of the time, or a :class:`Motion`. An array
/// counts as a file that holds its numbers: few decimals limit its accuracy. Other keywords are the options of
/// ``flexlink solve``: ``resample``, ``noise``, ``lowpass``, ``periodic``, ``moving_ends``,
/// ``scale_distance``, ``scale_duration``, ``moments``, ``stations``; for a file ``columns``, ``time_unit``, ``unit``, ``scale``,
/// ``skip``, ``delimiter``, ``decimal``, ``drop_outliers``. An arm takes ``x`` and ``y`` of its tip in m, or the directions ``angle1``,
/// ``angle2``, … of its links in rad. A link on a carriage takes the motion of a link except ``angle``; its solution has
/// ``force`` and ``carriage``.
///
/// >>> import flexlink, numpy
/// >>> link = flexlink.Link(
/// ...     segments=[{"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}],
/// ...     hub={"inertia": 0.1}, damping={"ratio": 0.02},
/// ... )
/// >>> time = numpy.linspace(0, 0.88, 881)
/// >>> solution = flexlink.solve(link, time, acceleration=4 * numpy.sin(2 * numpy.pi * time / 0.88))
/// >>> solution.torque.shape == solution.time.shape
/// True
/// >>> bool(solution.time[abs(solution.torque) > 0.02].min() < -0.2)  # the torque starts before the tip
/// True
#[pyfunction]
#[pyo3(signature = (link, time, **keywords))]
pub(crate) fn solve(
    py: Python<'_>,
    link: &Link,
    time: &Any<'_>,
    keywords: Option<Keywords<'_>>,
) -> PyResult<Solution> {
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let call = Call::take(time, &keywords, link.links())?;
    let solution = until_pressed(py, || Solution::of_call(link, call))?;
    warn(py, &solution.warnings)?;
    Ok(solution)
}
