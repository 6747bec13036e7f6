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
use flexlink::result::{PlayedMetrics, StoredWarning};
use flexlink::spec::Specification;
use flexlink::store::{OutputFolder, PlayFindings, RunInputs, Summary};

use crate::arrays::{column, frame, rows, view};
use crate::keywords;
use crate::link::Link;
use crate::messages::{notice, objects, usage, warn};
use crate::pool;
use crate::solve::read_options;
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

/// Takes the arrays of the call out of its keywords.
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
        Some(other) => Err(usage(&format!("unexpected keyword {other}"), None).into()),
    }
}

/// Plays a torque, or a motion of the hub, on a link at rest, as ``flexlink simulate``: independent of ``solve``.
///
/// Arrays over ``time`` in s, evenly spaced: ``torque`` in N m; or ``hub_angle`` in rad, and ``hub_rate`` if it is known.
/// Other keywords: ``hold``, the torque between its samples, ``"cubic"``, ``"linear"`` or ``"zero"``; ``until`` in s;
/// ``feedback``, a pair of gains in N m/rad and N m s/rad, around ``reference`` in rad with ``reference_rate``;
/// ``initial_tip`` in m; ``periodic``.
///
/// >>> import flexlink
/// >>> link = flexlink.Link(
/// ...     segments=[{"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}],
/// ...     hub={"inertia": 0.1}, damping={"model": "rayleigh", "alpha": 0.1, "beta": 0.002},
/// ... )
/// >>> motion = flexlink.trajectory("sine", distance=0.5, duration=0.88, step=0.002)
/// >>> solution = flexlink.solve(link, **motion)
/// >>> played = flexlink.simulate(link, solution.time, torque=solution.torque)
/// >>> bool(abs(played.tip_displacement - solution.tip_displacement).max() < 1e-4)
/// True
#[pyfunction]
#[pyo3(signature = (link, time, **keywords))]
pub(crate) fn simulate(
    py: Python<'_>,
    link: &Bound<'_, PyAny>,
    time: &Bound<'_, PyAny>,
    keywords: Option<Bound<'_, PyDict>>,
) -> PyResult<PlayedLink> {
    let link = &link.cast::<Link>()?.get().specification;
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let is_large = link.analysis.second_order_of(&link.link) != SecondOrder::None;
    let playing = Playing { is_large, ..moving(time, &keywords)? };
    let played = py.detach(|| pool::install(|| PlayedLink::of(link, playing)))?;
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
    warnings: Vec<StoredWarning>,
}

impl PlayedLink {
    fn of(specification: &Specification, playing: Playing) -> Result<Self, Failure> {
        let (link, play) = (&specification.link, playing.play());
        let simulation = played(link, &specification.mesh, &play)?;
        let error = PlayError::of(&simulation, link, &play)?;
        let coarse = error.as_ref().and_then(|error| error.warning(&simulation));
        let warnings = simulation.warnings.iter().copied().chain(coarse);
        let warnings = warnings.map(|own| notice(own.kind(), &own, own.hint())).collect();
        Ok(Self { link: link.clone(), playing, simulation, error, warnings })
    }

    fn write_into(&self, folder: &Path, keywords: &[String]) -> Result<(), Failure> {
        let options = read_options(keywords)?;
        let (simulation, outputs) = (&self.simulation, options.outputs());
        options.nodes.check(&simulation.mesh)?;
        memory::check_nodes(outputs.simulation_bytes(simulation), memory::available())?;
        let findings = PlayFindings { error: self.error.as_ref(), ..PlayFindings::default() };
        let summary = Summary::of_simulation(
            RunInputs::default(),
            (&self.link, &self.playing.play()),
            simulation,
            &PlayedMetrics::of(simulation),
            &findings,
        );
        let folder = OutputFolder::stage(folder, &|_| {})?;
        Ok(outputs.write_simulation(folder, &self.link, simulation, &summary)?)
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

    /// What the user must know: warnings that were given to Python's filters, too.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        objects(py, &self.warnings)
    }

    /// Writes the files of ``flexlink simulate`` into a folder, all or none. Keywords are its options ``nodes``, ``every``,
    /// ``digits``.
    #[pyo3(signature = (folder, **keywords))]
    fn write(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        keywords: Option<Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let keywords = keywords.as_ref().map(keywords::arguments).transpose()?.unwrap_or_default();
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
