//! `solve`: the solution of a link or an arm with its inputs, and the files of `flexlink solve`.

use pyo3::sync::PyOnceLock;

use flexlink::beam::{MeshPlan, NodalHistories};
use flexlink::cli::problem::{Problem, Solved};
use flexlink::cli::solve::run::SolveOptions;
use flexlink::cli::terminal::memory;
use flexlink::csv::Joints;
use flexlink::inverse::{JointMotion, LinkShape, Resources, Solution as Inverse};
use flexlink::link::ParameterError;
use flexlink::store::{OutputFolder, RunInputs, Summary};

use crate::arrays::{Every, Nodes, checked, nodal, pairs, rows, times};
use crate::joints::{Driven, Moving, Of, axes, no_link};
use crate::keywords::{self, solve_options};
use crate::link::{Link, PickledSource, Source};
use crate::motion::Call;
use crate::prelude::*;
use crate::properties::Value::{Computed, Entry, Notices, OfJoints, Places, Stored};
use crate::properties::{Named, Properties, check, slices};
use crate::samples::{Pickled, Samples, meshed};
use crate::table::SetPoints;
use crate::threads::{apart, until_pressed, without_python};

/// Keywords of `write`.
const WRITING: [&str; 6] = ["nodes", "stations", "every", "deflections", "digits", "golden"];

/// Torques and motion of the joints that move the tip as wanted, of one link or of an arm of several. Arrays have a row for
/// each of ``time``, those of an arm a column for each joint, the inner one first. Arrays of one link are views that cannot
/// be written to. ``root_moment``, ``motor_torque``, ``moments``, ``deflections``, ``results`` and ``errors`` are there for any
/// number of links, ``torque``, ``joint_angle`` and ``joint_rate`` for hubs and arms, ``force``, ``carriage`` and
/// ``carriage_velocity`` for links and arms on a carriage. Units are SI.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Solution {
    source: Source,
    samples: Arc<Samples>,
    /// The keywords of the call as options.
    arguments: Vec<String>,
    pub(crate) solved: Solved,
    /// Plans of the links' meshes.
    pub(crate) plans: Vec<MeshPlan>,
    /// How the file of the motion was read.
    reading: Vec<Notice>,
    warnings: Vec<Notice>,
    summary: PyOnceLock<String>,
}

impl Solution {
    /// Solves the problem of a call.
    pub(crate) fn of_call(link: &Link, call: Call<'_>) -> Fails<Self> {
        let options = solve_options(&call.arguments)?;
        let (wanted, reading) = call.wanted(link, &options.motion)?;
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
            plans: problem.plans().to_vec(),
            reading: Vec::new(),
            warnings,
            summary: PyOnceLock::new(),
        })
    }

    pub(crate) fn inverse(&self) -> &Inverse {
        &self.solved.solution
    }

    /// A history of each link's shape.
    fn shapes(&self, of: fn(&LinkShape) -> &Vec<f64>) -> Vec<&[f64]> {
        slices(self.inverse().shapes().map(of))
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

    /// The summary of a run with all its tables.
    fn record_of_all(&self) -> Fails<Summary> {
        let options = self.options(Vec::new())?;
        let inputs = self.record(&options);
        Ok(self.solved.summary(inputs, None, &options.outputs()))
    }

    /// Writes the files of the command, with more options.
    pub(crate) fn write_into(&self, folder: &Path, more: Vec<String>) -> Fails<()> {
        let options = self.options(more)?;
        options.nodes.check(&self.inverse().nodes_m())?;
        let (inputs, outputs) = (self.record(&options), options.outputs());
        let stage = || Ok(OutputFolder::stage(folder, &|_| {})?);
        self.solved.write(inputs, &outputs, memory::available(), stage)
    }

    /// Acceleration by its name of a joint, by its number: of one link or of an arm's carriage the last.
    fn acceleration<'py>(
        &self,
        py: Python<'py>,
        (name, joint): (&str, usize),
    ) -> Raises<Bound<'py, PyArray1<f64>>> {
        check(name, self.kind())?;
        let find = || Ok(self.inverse().acceleration_rad_s2(joint).into_owned());
        Ok(PyArray1::from_vec(py, without_python(py, find)?))
    }

    fn last(&self) -> usize {
        self.inverse().joints.len() - 1
    }

    /// A quantity at nodes of one link, all by default, of every `every`-th sample.
    fn nodal<'py>(
        &self,
        py: Python<'py>,
        (nodes, every): (Nodes, Every),
        find: impl FnOnce(&Inverse, &[usize]) -> Result<NodalHistories, ParameterError> + Send,
    ) -> Table<'py> {
        let solution = self.inverse();
        let of = (&solution.grid, solution.nodes_m()[0].len());
        nodal(py, of, (nodes, every), |nodes| find(solution, nodes))
    }

    /// A quantity at nodes of a link: of an arm's from its shape, of a single one computed.
    fn of_link<'py>(
        &self,
        py: Python<'py>,
        (link, nodes, every): (usize, Nodes, Every),
        of_arm: fn(&LinkShape) -> &Vec<Vec<f64>>,
        find: impl FnOnce(&Inverse, &[usize]) -> Result<NodalHistories, ParameterError> + Send,
    ) -> Table<'py> {
        if self.links() == 1 && link == 0 {
            return self.nodal(py, (nodes, every), find);
        }
        let at = (link, nodes, every);
        let (histories, samples) = self.of_shape(at, |own, node| vec![&of_arm(own)[node]])?;
        Ok(rows(py, &histories, samples)?)
    }

    /// A stored quantity at nodes of an arm's link, in pieces of several for each node.
    fn of_shape(
        &self,
        (link, nodes, every): (usize, Nodes, Every),
        of: impl Fn(&LinkShape, usize) -> Vec<&Vec<f64>>,
    ) -> Raises<(Vec<Vec<f64>>, usize)> {
        let solution = self.inverse();
        let shape = solution.shapes().nth(link).ok_or_else(|| no_link(link, self.links()))?;
        let samples = solution.grid.thinned(every.0).len();
        let all = solution.nodes_m()[link].len();
        let nodes = checked(nodes, all, samples)?;
        if let Some(node) = nodes.iter().find(|node| **node >= all) {
            let must = format!("must be below {all}, the number of nodes of the link");
            return Err(usage(&format!("nodes = {node}, but {must}"), None).into());
        }
        let taken = |own: &Vec<f64>| own.iter().step_by(every.0.get()).copied().collect();
        let histories = nodes.iter().flat_map(|node| of(shape, *node)).map(taken).collect();
        Ok((histories, samples))
    }
}

impl Driven for Solution {
    fn joints(&self, of: Of) -> Vec<Option<&[f64]>> {
        fn history(joint: &JointMotion, of: Of) -> Option<&Vec<f64>> {
            let motor = joint.motor.as_ref();
            match of {
                Of::Effort => Some(&joint.torque_n_m),
                Of::Position => Some(&joint.angle_rad),
                Of::Rate => Some(&joint.rate_rad_s),
                Of::Acceleration => joint.acceleration_rad_s2.as_ref(),
                Of::RigidEffort => Some(&joint.rigid_torque_n_m),
                Of::RigidPosition => Some(&joint.rigid_angle_rad),
                Of::MotorEffort => Some(&motor?.torque_n_m),
                Of::MotorPosition => Some(&motor?.angle_rad),
                Of::MotorRate => Some(&motor?.rate_rad_s),
                Of::MotorAcceleration => None,
                Of::MotorPower => Some(&motor?.power_w),
                Of::MotorCurrent => motor?.current_a.as_ref(),
                Of::MotorVoltage => motor?.voltage_v.as_ref(),
            }
        }
        let joints = self.inverse().joints.iter();
        joints.map(|joint| history(joint, of).map(Vec::as_slice)).collect()
    }
}

impl Moving for Solution {
    fn tip(&self, order: usize) -> Vec<&[f64]> {
        axes(&self.inverse().tip, order)
    }

    fn nodes_m(&self) -> Vec<&[f64]> {
        self.inverse().nodes_m()
    }
}

impl Properties for Solution {
    const PROPERTIES: Named<Self> = &[
        ("time", Computed(|own| times(&own.inverse().grid))),
        (
            "root_moment",
            Stored(|own| slices(own.inverse().links.iter().map(|link| &link.root_moment_n_m))),
        ),
        (
            "reaction",
            Places(|own| {
                let forces = own.inverse().joints.iter().filter_map(|joint| joint.force_n.as_ref());
                forces.map(|force| force.each_ref().map(Vec::as_slice)).collect()
            }),
        ),
        ("chord_angle", Stored(|own| own.shapes(|shape| &shape.chord[0]))),
        ("chord_rate", Stored(|own| own.shapes(|shape| &shape.chord[1]))),
        ("chord_acceleration", Stored(|own| own.shapes(|shape| &shape.chord[2]))),
        ("chord_length", Stored(|own| own.shapes(|shape| &shape.chord_length_m))),
        ("tip_deflection", Computed(|own| own.inverse().tip_deflection_m(0))),
        ("motor_angle", OfJoints(|own| own.of_motors(Of::MotorPosition))),
        ("motor_power", OfJoints(|own| own.of_motors(Of::MotorPower))),
        ("errors", Entry),
        ("results", Entry),
        ("warnings", Notices(|own| own.warnings.clone())),
        ("remarks", Notices(Self::notices)),
    ];

    fn kind(&self) -> Joints {
        Joints::from(&self.inverse().arm)
    }
}

#[pymethods]
impl Solution {
    /// Content of a run's summary.json.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> Raises<Any<'py>> {
        let write = || Ok(self.record_of_all()?.to_json());
        let text = self.summary.get_or_try_init(py, || without_python(py, write))?;
        Ok(loaded(py, text)?)
    }

    /// Hub acceleration in rad/s², computed by each call.
    #[getter]
    fn hub_acceleration<'py>(&self, py: Python<'py>) -> Raises<Bound<'py, PyArray1<f64>>> {
        self.acceleration(py, ("hub_acceleration", self.last()))
    }

    /// Acceleration in rad/s² of each joint, of one link computed by each call.
    #[getter]
    fn joint_acceleration<'py>(&self, py: Python<'py>) -> Raises<Any<'py>> {
        let all =
            (0..self.links()).map(|joint| self.acceleration(py, ("joint_acceleration", joint)));
        let all = all.collect::<Raises<Vec<_>>>()?;
        if let [hub] = &all[..] {
            return Ok(hub.clone().into_any());
        }
        let histories: Vec<Vec<f64>> =
            all.iter().map(|own| own.readonly().as_array().to_vec()).collect();
        Ok(rows(py, &histories, self.inverse().grid.len)?.into_any())
    }

    /// Acceleration of the carriage in m/s², computed by each call.
    #[getter]
    fn carriage_acceleration<'py>(&self, py: Python<'py>) -> Raises<Bound<'py, PyArray1<f64>>> {
        self.acceleration(py, ("carriage_acceleration", self.last()))
    }

    /// Displacements of the nodes of one link in m, numbered from 0 at the root, all by default: a row for each sample, or
    /// for every ``every``-th, a column for each node.
    #[pyo3(signature = (nodes=None, every=Every::ALL))]
    fn displacements<'py>(&self, py: Python<'py>, nodes: Nodes, every: Every) -> Table<'py> {
        check("displacements", self.kind())?;
        self.nodal(py, (nodes, every), |own, nodes| {
            Ok(own.displacements(nodes, every.0)?.histories())
        })
    }

    /// Deflections of nodes in m from the hub's tangent line, of the nodes of an arm's ``link`` from its chord, in the form of
    /// ``displacements``. ``link`` counts from 0.
    #[pyo3(signature = (nodes=None, every=Every::ALL, *, link=0))]
    fn deflections<'py>(
        &self,
        py: Python<'py>,
        nodes: Nodes,
        every: Every,
        link: usize,
    ) -> Table<'py> {
        self.of_link(
            py,
            (link, nodes, every),
            |own| &own.deflections_m,
            |own, nodes| Ok(own.deflections(nodes, every.0)?.histories()),
        )
    }

    /// Bending moments at nodes in N m, of an arm at those of a ``link``, in the form of ``displacements``. ``link`` counts
    /// from 0.
    #[pyo3(signature = (nodes=None, every=Every::ALL, *, link=0))]
    fn moments<'py>(&self, py: Python<'py>, nodes: Nodes, every: Every, link: usize) -> Table<'py> {
        self.of_link(
            py,
            (link, nodes, every),
            |own| &own.moments_n_m,
            |own, nodes| Ok(own.moments(nodes, every.0)?.histories()),
        )
    }

    /// x and y in m of the nodes of an arm's ``link``, numbered from 0, of every ``every``-th sample: an array over time, node
    /// and axis.
    #[pyo3(signature = (link, nodes=None, every=Every::ALL))]
    fn positions<'py>(
        &self,
        py: Python<'py>,
        link: usize,
        nodes: Nodes,
        every: Every,
    ) -> PairsOverTime<'py> {
        check("positions", self.kind())?;
        let at = (link, nodes, every);
        let (axes, samples) =
            self.of_shape(at, |own, node| own.positions_m[node].iter().collect())?;
        Ok(pairs(py, &axes, samples)?)
    }

    /// Distances in m of the nodes of a ``link``, numbered from 0, from its joint.
    #[pyo3(signature = (link=0))]
    fn nodes_of<'py>(&self, py: Python<'py>, link: usize) -> Raises<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_slice(py, self.nodes_of_link(link)?))
    }

    /// The torque at the hub, those of the joints, or the force on the carriage, as a controller plays it: the table of
    /// ``flexlink solve --write``. ``window`` cuts the rows before and after which the torque stays below this share of its
    /// peak, ``0.02`` or ``"2%"``; ``hold="zero"`` corrects the values for a converter that holds each until the next;
    /// ``start_at`` is the time of the first row. ``quantities=["position", "effort"]`` makes set-points of drives, with
    /// ``cycle``, ``side``, ``units``, ``counts``, ``joint_names`` and ``form`` as the command has them. A table that is cut,
    /// held, on a cycle or in counts is played, and has the ``tip_error``.
    #[pyo3(signature = (**keywords))]
    fn table(&self, py: Python<'_>, keywords: Option<Keywords<'_>>) -> PyResult<SetPoints> {
        let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
        if keywords.contains("write")? {
            let hint = "write(path) of the table writes it";
            return Err(Raised::from(usage(&"unexpected keyword `write`", Some(hint))).into());
        }
        // `with` is a word of Python.
        if let Some(quantities) = keywords.get_item("quantities")? {
            keywords.del_item("quantities")?;
            keywords.set_item("with", quantities)?;
        }
        let words = keywords::arguments(&keywords, &[])?;
        let table = until_pressed(py, || {
            SetPoints::of((self.inverse(), &self.plans), self.record_of_all()?, words)
        })?;
        warn(py, &table.notices())?;
        Ok(table)
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

/// Computes the torque at the hub of a link, or the torques of an arm's joints, for a motion of the tip.
///
/// The motion is arrays over ``time`` in s, evenly spaced: ``acceleration`` in m/s², ``displacement`` along the arc in
/// m, ``velocity`` in m/s, or ``angle`` in rad; or a file, whose path is in place of the time, or a :class:`Motion`. An array
/// counts as a file that holds its numbers: few decimals limit its accuracy. Other keywords are the options of
/// ``flexlink solve``: ``resample``, ``noise``, ``lowpass``, ``periodic``, ``moving_ends``,
/// ``scale_distance``, ``scale_duration``, ``moments``, ``stations``; for a file ``columns``, ``time_unit``,
/// ``sample_rate``, ``unit``, ``scale``, ``skip``, ``delimiter``, ``decimal``, ``drop_outliers``. An arm takes ``x`` and ``y``
/// of its tip in m, or the directions ``angle1``, ``angle2``, … of its links in rad. A link on a carriage takes the motion of
/// a link except ``angle``; its solution has ``force`` and ``carriage``.
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
