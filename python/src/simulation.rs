//! A simulation: the motion of a link or an arm from its input, and the files of `flexlink simulate`.

use pyo3::sync::PyOnceLock;

use flexlink::cli::options::moves::{Moves, under_voltages};
use flexlink::cli::simulate::refusal;
use flexlink::cli::terminal::{console, memory};
use flexlink::csv::Joints;
use flexlink::response::{BentPlay, Played, simulate};
use flexlink::result::FollowedTarget;
use flexlink::spec::Specification;
use flexlink::store::{OutputFolder, PlayedRun, RunInputs, Simulated, Summary, state_json};

use crate::arrays::{Every, Nodes, checked, nodal, pairs, times};
use crate::joints::{Driven, Moving, Of, axes};
use crate::keywords::{of_writing, solve_options};
use crate::prelude::*;
use crate::properties::Value::{Computed, Entry, Notices, Stored};
use crate::properties::{Named, Properties, check, slices};
use crate::threads::{apart, without_python};

/// Keywords of `write`.
const WRITING: [&str; 4] = ["nodes", "stations", "every", "digits"];

/// The motion of a link or an arm on which torques, or a motion of the hub, were played. Arrays have a row for each of
/// ``time``: those of one link are views that cannot be written to, those of an arm have a column for each joint, the inner
/// one first. Units are SI.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Simulation {
    specification: Specification,
    moves: Moves,
    result: Simulated,
    pub(crate) warnings: Vec<Notice>,
    summary: PyOnceLock<String>,
}

impl Simulation {
    /// Plays the input of a call.
    pub(crate) fn of(specification: Specification, moves: Moves) -> Fails<Self> {
        let Specification { arm, meshes, .. } = &specification;
        let moved = moves.is_under_voltage.then(|| under_voltages(arm)).transpose()?;
        let moved = moved.as_ref().unwrap_or(arm);
        let play = moves.play();
        let played = simulate(moved, meshes, &play, &|_| {}).map_err(|error| {
            let (message, hint) = refusal(&error, arm);
            Failure { message, hint, ..Failure::from(error) }
        })?;
        let compared = moves.target.as_ref().map(|target| FollowedTarget::of(&played, target));
        let result = Simulated::of(played, moved, &play, compared.transpose()?)?;
        let (warnings, summary) = (Vec::new(), PyOnceLock::new());
        let run = Self { specification, moves, result, warnings, summary };
        let warnings = run.with(|run| run.notices(|limit| Notice::from(limit)));
        Ok(Self { warnings, ..run })
    }

    /// Does something with the run in the form of the command.
    fn with<T>(&self, with: impl FnOnce(&PlayedRun<'_>) -> T) -> T {
        let Specification { arm, limits, .. } = &self.specification;
        with(&PlayedRun { arm, play: &self.moves.play(), limits, result: &self.result })
    }

    pub(crate) fn played(&self) -> &Played {
        &self.result.played
    }

    pub(crate) fn write_into(&self, folder: &Path, keywords: &[String]) -> Fails<()> {
        let options = solve_options(keywords)?;
        let (played, outputs) = (self.played(), options.outputs());
        options.nodes.check(&played.nodes_m())?;
        memory::check_nodes(outputs.simulation_bytes(played), memory::available())?;
        let inputs = RunInputs::of_arguments(options.arguments());
        let stage = || Ok(OutputFolder::stage(folder, &|_| {})?);
        self.with(|run| run.write(inputs, &outputs, stage)).map(drop)
    }

    /// The play of links that are elasticas.
    fn bent(&self) -> impl Iterator<Item = &BentPlay> {
        self.played().bent().into_iter()
    }

    fn holding_n_m(&self) -> Vec<f64> {
        self.played().joints.iter().filter_map(|joint| joint.holding_n_m).collect()
    }

    fn energy_j(&self) -> Vec<f64> {
        let both = self.bent().flat_map(|bent| bent.kinetic_j.iter().zip(&bent.potential_j));
        both.map(|(kinetic, potential)| kinetic + potential).collect()
    }
}

impl Driven for Simulation {
    fn joints(&self, of: Of) -> Vec<Option<&[f64]>> {
        let joints = self.played().joints.iter();
        let history = joints.map(|joint| match of {
            Of::Effort => Some(&*joint.torque_n_m),
            Of::Position => Some(&*joint.angle_rad),
            Of::Rate => Some(&*joint.rate_rad_s),
            Of::Acceleration => Some(&*joint.acceleration_rad_s2),
            _ => None,
        });
        history.collect()
    }
}

impl Moving for Simulation {
    fn tip(&self, order: usize) -> Vec<&[f64]> {
        axes(&self.played().tip, order)
    }

    fn nodes_m(&self) -> Vec<&[f64]> {
        self.played().nodes_m()
    }
}

impl Properties for Simulation {
    const PROPERTIES: Named<Self> = &[
        ("time", Computed(|own| times(&own.played().grid))),
        ("chord_angle", Stored(|own| slices(own.bent().flat_map(|bent| &bent.chords_rad)))),
        ("energy", Computed(Self::energy_j)),
        ("work", Stored(|own| slices(own.bent().map(|bent| &bent.work_j)))),
        ("dissipated", Stored(|own| slices(own.bent().map(|bent| &bent.lost_j)))),
        ("holding_torque", Computed(Self::holding_n_m)),
        ("results", Entry),
        ("tip_error", Entry),
        ("warnings", Notices(|own| own.warnings.clone())),
    ];

    fn kind(&self) -> Joints {
        Joints::from(&self.specification.arm)
    }
}

#[pymethods]
impl Simulation {
    /// Displacements of the nodes of one link in m, as those of a solution.
    #[pyo3(signature = (nodes=None, every=Every::ALL))]
    fn displacements<'py>(&self, py: Python<'py>, nodes: Nodes, every: Every) -> Table<'py> {
        check("displacements", self.kind())?;
        let played = self.played();
        let of = (&played.grid, played.mesh().nodes_m().len());
        nodal(py, of, (nodes, every), |nodes| played.displacements_m(nodes, every.0))
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
        let samples = self.played().grid.thinned(every.0).len();
        let mut chosen = vec![Vec::new(); self.links()];
        chosen[link] = checked(nodes, self.nodes_of_link(link)?.len(), samples)?;
        let places_m = py.detach(|| Ok::<_, Failure>(self.played().places_m(&chosen, every.0)?))?;
        Ok(pairs(py, &places_m[link].concat(), samples)?)
    }

    /// Distances in m of the nodes of a ``link``, numbered from 0, from its joint.
    #[pyo3(signature = (link=0))]
    fn nodes_of<'py>(&self, py: Python<'py>, link: usize) -> Raises<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_slice(py, self.nodes_of_link(link)?))
    }

    /// Errors of the motion. For one link those of mesh and modes: of the tip over its travel, and of the hub angle over its
    /// peak; None where elements of half the length do not allow the damping. For an arm as in summary.json: the change
    /// by the last refinement, and the missing share of energy.
    #[getter]
    fn errors<'py>(&self, py: Python<'py>) -> PyResult<Option<Any<'py>>> {
        if self.links() > 1 {
            return self.summary(py)?.get_item("errors").map(Some);
        }
        let Some(error) = &self.result.error else { return Ok(None) };
        let joint = self.specification.arm.joint().named("hub_angle");
        let errors = [("tip".to_owned(), error.tip), (joint, error.hub_angle)];
        Ok(Some(errors.into_py_dict(py)?.into_any()))
    }

    /// Content of a run's summary.json.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> Raises<Any<'py>> {
        let write = || Ok(self.with(|run| Summary::of_played(RunInputs::default(), run)).to_json());
        let text = self.summary.get_or_try_init(py, || without_python(py, write))?;
        Ok(loaded(py, text)?)
    }

    /// Writes the files of ``flexlink simulate`` into a folder, all or none. Keywords are its options ``nodes``, ``stations``,
    /// ``every``, ``digits``.
    #[pyo3(signature = (folder, **keywords))]
    fn write(&self, py: Python<'_>, folder: PathBuf, keywords: Option<Keywords<'_>>) -> Raises<()> {
        let keywords = of_writing(keywords.as_ref(), &WRITING)?;
        apart(py, || self.write_into(&folder, &keywords))
    }

    /// Writes the state at the end, as ``--save-state`` of the command: ``state`` of a later call goes on from it.
    fn save_state(&self, py: Python<'_>, path: PathBuf) -> Raises<()> {
        let text = state_json(&self.played().state());
        Ok(py.detach(|| console::deliver(Some(&path), text.as_bytes()))?)
    }

    fn __repr__(&self) -> String {
        let (samples, joints) = (self.played().grid.len, self.links());
        let joints = if joints > 1 { format!(", joints={joints}") } else { String::new() };
        format!("Simulation(samples={samples}{joints})")
    }
}
