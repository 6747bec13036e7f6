//! `simulate`: a torque or a motion of the hub in arrays, played on a link.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use flexlink::elastica::SecondOrder;
use flexlink::link::Link as LibraryLink;
use flexlink::response::{
    Feedback, HistoryError, HubReference, Input, Interpolation, Play, PlayError, Simulation,
    Torque, simulate as played,
};
use flexlink::result::{FollowedTarget, Limits, PlayedMetrics, StoredWarning};
use flexlink::spec::Specification;
use flexlink::store::{OutputFolder, PlayFindings, RunInputs, Summary};

use crate::arrays::{column, frame, rows, view};
use crate::keywords::{self, solve_options};
use crate::link::{Link, described_by};
use crate::messages::{notice, objects, usage, warn};
use crate::motion::Motion;
use crate::pool;
use crate::terminal::{Exit, Failure, memory};

type Array<'py> = Bound<'py, PyArray1<f64>>;

/// What moves the link.
enum Moving {
    Torque(Torque),
    HubAngle(HubReference),
}

/// What is played, and how.
struct Playing {
    moving: Moving,
    interpolation: Interpolation,
    until_s: Option<f64>,
    feedback: Option<Feedback>,
    initial_tip_m: f64,
    is_large: bool,
    is_periodic: bool,
}

impl Playing {
    fn play(&self) -> Play<'_> {
        let input = match &self.moving {
            Moving::Torque(torque) => Input::Torque(torque),
            Moving::HubAngle(hub) => Input::HubAngle(hub),
        };
        Play {
            input,
            interpolation: self.interpolation,
            until_s: self.until_s,
            feedback: self.feedback.as_ref(),
            initial_tip_m: self.initial_tip_m,
            memory_bytes: memory::available(),
            is_large: self.is_large,
            cycle_turn_rad: self.is_periodic.then_some(0.0),
            state: None,
            start_angle_rad: None,
        }
    }
}

fn history(error: &HistoryError) -> Failure {
    Failure::new(Exit::InputRefused, error, error.hint())
}

/// Keywords of `simulate`, with blanks between.
const KEYWORDS: &str = "torque hub_angle hub_rate hold until feedback reference reference_rate initial_tip periodic target";

/// Keywords of `write`.
const WRITING: [&str; 4] = ["nodes", "stations", "every", "digits"];

/// How a torque goes on between its samples.
fn interpolation(hold: &str) -> Result<Interpolation, Failure> {
    match hold {
        "zero" => Ok(Interpolation::Zero),
        "linear" => Ok(Interpolation::Linear),
        "cubic" => Ok(Interpolation::Cubic),
        _ => {
            let must = "must be \"zero\", \"linear\" or \"cubic\"";
            Err(usage(&format!("hold = {hold:?}, but {must}"), None))
        }
    }
}

/// Takes the arrays of the call out of its keywords, all that there are.
fn moving(time: &Bound<'_, PyAny>, keywords: &Bound<'_, PyDict>) -> PyResult<Playing> {
    let take = |name: &str| -> PyResult<Option<Bound<'_, PyAny>>> {
        let Some(given) = keywords.get_item(name)? else { return Ok(None) };
        keywords.del_item(name)?;
        Ok((!given.is_none()).then_some(given))
    };
    let array = |name: &str| take(name)?.map(|given| column(name, &given)).transpose();
    let number = |name: &str| take(name)?.map(|given| given.extract::<f64>()).transpose();
    let time_s = column("time", time)?;
    let hub = |angle: Vec<f64>, rate: Option<Vec<f64>>| {
        HubReference::new(&time_s, angle, rate).map_err(|error| history(&error))
    };
    let (rate, reference_rate) = (array("hub_rate")?, array("reference_rate")?);
    let moving = match (array("torque")?, array("hub_angle")?, rate) {
        (Some(torque), None, None) => {
            Moving::Torque(Torque::new(&time_s, torque).map_err(|error| history(&error))?)
        }
        (None, Some(angle), rate) => Moving::HubAngle(hub(angle, rate)?),
        _ => {
            let must = "must be torque alone, or hub_angle with or without hub_rate";
            return Err(usage(&format!("what is played, but {must}"), None).into());
        }
    };
    let gains = take("feedback")?.map(|given| given.extract::<(f64, f64)>()).transpose()?;
    let feedback = match (gains, array("reference")?) {
        (None, None) => None,
        (Some((kp, kd)), Some(angle)) => {
            let feedback = Feedback::new(kp, kd, hub(angle, reference_rate)?);
            Some(feedback.map_err(|error| usage(&format!("feedback: {error}"), None))?)
        }
        _ => {
            let message = "one of feedback and reference, but must be both or none";
            return Err(usage(&message, None).into());
        }
    };
    let hold = take("hold")?.map(|given| given.extract::<String>()).transpose()?;
    let is_periodic = take("periodic")?.map(|given| given.is_truthy()).transpose()?;
    let playing = Playing {
        moving,
        interpolation: interpolation(hold.as_deref().unwrap_or("cubic"))?,
        until_s: number("until")?,
        feedback,
        initial_tip_m: number("initial_tip")?.unwrap_or_default(),
        is_large: false,
        is_periodic: is_periodic.unwrap_or_default(),
    };
    match keywords.keys().iter().next() {
        None => Ok(playing),
        Some(other) => {
            let other = other.extract::<String>()?;
            Err(keywords::unknown(&other, KEYWORDS.split(' ')).into())
        }
    }
}

/// Plays a torque, or a motion of the hub, on a link at rest, as ``flexlink simulate``: independent of ``solve``.
///
/// Arrays over ``time`` in s, evenly spaced: ``torque`` in N m; or ``hub_angle`` in rad, and ``hub_rate`` if it is known.
/// Other keywords: ``hold``, the torque between its samples, ``"cubic"``, ``"linear"`` or ``"zero"``; ``until`` in s;
/// ``feedback``, a pair of gains in N m/rad and N m s/rad, around ``reference`` in rad with ``reference_rate``;
/// ``initial_tip`` in m; ``periodic``; ``target``, the wanted :class:`Motion` with which the tip is compared.
///
/// >>> import flexlink
/// >>> link = flexlink.Link(
/// ...     segments=[{"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}],
/// ...     hub={"inertia": 0.1}, damping={"model": "rayleigh", "alpha": 0.1, "beta": 0.002},
/// ... )
/// >>> motion = flexlink.trajectory("sine", distance=0.5, duration=0.88, step=0.002)
/// >>> solution = flexlink.solve(link, **motion)
/// >>> wanted = flexlink.Motion(**motion)
/// >>> played = flexlink.simulate(link, solution.time, torque=solution.torque, target=wanted)
/// >>> played.tip_error["share"] < 1e-3  # of the largest distance from the start
/// True
#[pyfunction]
#[pyo3(signature = (link, time, **keywords))]
pub(crate) fn simulate(
    py: Python<'_>,
    link: &Bound<'_, PyAny>,
    time: &Bound<'_, PyAny>,
    keywords: Option<Bound<'_, PyDict>>,
) -> PyResult<PlayedLink> {
    let link = &described_by::<Link>(link)?.get().specification;
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let target = keywords.get_item("target")?.filter(|given| !given.is_none());
    if keywords.contains("target")? {
        keywords.del_item("target")?;
    }
    let target = target.as_ref().map(described_by::<Motion>).transpose()?.map(Bound::get);
    if let Some(target) = target {
        target.refuse_other(&link.link)?;
    }
    let is_large = link.analysis.second_order_of(&link.link) != SecondOrder::None;
    let playing = Playing { is_large, ..moving(time, &keywords)? };
    let played = py.detach(|| pool::install(|| PlayedLink::of(link, playing, target)))?;
    warn(py, &played.warnings)?;
    Ok(played)
}

/// The motion of a link on which a torque, or a motion of the hub, was played. Arrays are views that cannot be written to,
/// one value for each of ``time``; units are SI.
#[pyclass(frozen, module = "flexlink", name = "Simulation")]
pub(crate) struct PlayedLink {
    link: LibraryLink,
    playing: Playing,
    simulation: Simulation,
    error: Option<PlayError>,
    limits: Limits,
    target: Option<FollowedTarget>,
    warnings: Vec<StoredWarning>,
}

impl PlayedLink {
    fn of(
        specification: &Specification,
        playing: Playing,
        target: Option<&Motion>,
    ) -> Result<Self, Failure> {
        let (link, play) = (&specification.link, playing.play());
        let simulation = played(link, &specification.mesh, &play)?;
        let error = PlayError::of(&simulation, link, &play)?;
        let grid = &simulation.grid;
        let target = target.map(|motion| motion.target(grid.time_s(0), grid.end_s()));
        let compared = target.map(|target| FollowedTarget::of(&simulation, &target));
        let target = compared.transpose()?;
        let coarse = error.as_ref().and_then(|error| error.warning(&simulation));
        let warnings = simulation.warnings.iter().copied().chain(coarse);
        let warnings = warnings.map(|own| notice(own.kind(), &own, own.hint()));
        let late = target.as_ref().and_then(|target| target.tip_error.late);
        let late = late.map(|own| notice(own.kind(), &own, own.hint()));
        let warnings = warnings.chain(late).collect();
        let (link, limits) = (link.clone(), specification.limits);
        Ok(Self { link, playing, simulation, error, limits, target, warnings })
    }

    fn summary(&self, arguments: Vec<String>) -> Summary {
        let findings = PlayFindings {
            error: self.error.as_ref(),
            limits: self.limits,
            target: self.target.as_ref(),
            ..PlayFindings::default()
        };
        Summary::of_simulation(
            RunInputs::of_arguments(arguments),
            (&self.link, &self.playing.play()),
            &self.simulation,
            &PlayedMetrics::of(&self.simulation),
            &findings,
        )
    }

    fn write_into(&self, folder: &Path, keywords: &[String]) -> Result<(), Failure> {
        let options = solve_options(keywords)?;
        let (simulation, outputs) = (&self.simulation, options.outputs());
        options.nodes.check(&simulation.mesh)?;
        memory::check_nodes(outputs.simulation_bytes(simulation), memory::available())?;
        let summary = self.summary(options.arguments());
        let folder = OutputFolder::stage(folder, &|_| {})?;
        let run = (&self.link, simulation);
        Ok(outputs.write_simulation(folder, run, (self.target.as_ref(), &summary))?)
    }
}

#[pymethods]
impl PlayedLink {
    /// Times in s.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Array<'py> {
        let grid = &self.simulation.grid;
        PyArray1::from_vec(py, (0..grid.len).map(|k| grid.time_s(k)).collect())
    }

    /// Torque at the hub in N m, that of the feedback included.
    #[getter]
    fn torque<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.simulation.torque_n_m)
    }

    /// Hub angle in rad.
    #[getter]
    fn hub_angle<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.simulation.hub_angle_rad)
    }

    /// Hub rate in rad/s.
    #[getter]
    fn hub_rate<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.simulation.hub_rate_rad_s)
    }

    /// Hub acceleration in rad/s².
    #[getter]
    fn hub_acceleration<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.simulation.hub_acceleration_rad_s2)
    }

    /// Displacement of the tip in m along its arc.
    #[getter]
    fn tip_displacement<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.simulation.tip.displacement_m)
    }

    /// Velocity of the tip in m/s.
    #[getter]
    fn tip_velocity<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.simulation.tip.velocity_m_s)
    }

    /// Acceleration of the tip in m/s².
    #[getter]
    fn tip_acceleration<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.simulation.tip.acceleration_m_s2)
    }

    /// Distances of the nodes from the axis in m.
    #[getter]
    fn nodes<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| own.simulation.mesh.nodes_m())
    }

    /// Displacements of nodes in m, as those of a solution.
    #[pyo3(signature = (nodes=None, every=NonZeroUsize::MIN))]
    fn displacements<'py>(
        &self,
        py: Python<'py>,
        nodes: Option<Vec<usize>>,
        every: NonZeroUsize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let nodes = nodes.unwrap_or_else(|| (0..self.simulation.mesh.nodes_m().len()).collect());
        let found =
            py.detach(|| pool::install(|| Ok(self.simulation.displacements_m(&nodes, every)?)))?;
        rows(py, &found.samples, found.grid.len())
    }

    /// Errors of mesh and modes: of the tip over its travel, and of the hub angle over its peak; None where elements of half
    /// the length do not allow the damping.
    #[getter]
    fn errors<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(error) = &self.error else { return Ok(None) };
        let found = PyDict::new(py);
        found.set_item("tip", error.tip)?;
        found.set_item("hub_angle", error.hub_angle)?;
        Ok(Some(found))
    }

    /// Peaks, as in summary.json.
    #[getter]
    fn results<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary_of(py)?.get_item("results")
    }

    /// Distance of the tip from its ``target``, as in summary.json: ``worst_m``, ``share`` of the largest distance from the
    /// start, ``time_s``, ``rms_m``, ``final_m``; None without a target.
    #[getter]
    fn tip_error<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary_of(py)?.get_item("tip_error")
    }

    /// What summary.json of a run holds.
    #[getter(summary)]
    fn summary_of<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = py.detach(|| pool::install(|| Ok(self.summary(Vec::new()).to_json())));
        py.import("json")?.call_method1("loads", (text?,))
    }

    /// What the user must know: warnings that were given to Python's filters, too.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        objects(py, &self.warnings)
    }

    /// Writes the files of ``flexlink simulate`` into a folder, all or none. Keywords are its options ``nodes``, ``stations``,
    /// ``every``, ``digits``.
    #[pyo3(signature = (folder, **keywords))]
    fn write(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        keywords: Option<Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let keywords = keywords::of_writing(keywords.as_ref(), &WRITING)?;
        Ok(py.detach(|| pool::install(|| self.write_into(&folder, &keywords)))?)
    }

    /// The histories as a `pandas.DataFrame` over the time.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        frame(slf, &HISTORIES)
    }

    fn __repr__(&self) -> String {
        format!("Simulation(samples={})", self.simulation.grid.len)
    }
}

/// Columns of a data frame.
const HISTORIES: [&str; 7] = [
    "torque",
    "hub_angle",
    "hub_rate",
    "hub_acceleration",
    "tip_displacement",
    "tip_velocity",
    "tip_acceleration",
];
