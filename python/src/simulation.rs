//! A simulation: the motion of a link or an arm from its input, and the files of `flexlink simulate`.

use pyo3::sync::PyOnceLock;

use flexlink::cli::options::moves::{Moves, under_voltages};
use flexlink::cli::simulate::refusal;
use flexlink::cli::terminal::{console, memory};
use flexlink::csv::Joints;
use flexlink::motion::TipMotionHistories;
use flexlink::response::{BentPlay, JointMotion, Played, simulate};
use flexlink::result::FollowedTarget;
use flexlink::spec::Specification;
use flexlink::store::{OutputFolder, PlayedRun, RunInputs, Simulated, Summary, state_json};

use crate::arrays::{Every, Nodes, checked, pairs, rows, times};
use crate::keywords::{of_writing, solve_options};
use crate::prelude::*;
use crate::properties::Value::{Computed, Entry, Notices, Stored};
use crate::properties::{Properties, Value, check, slices};
use crate::solution::no_link;
use crate::threads::{apart, until_pressed, without_python};

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

    /// A history of the joint of each link.
    fn joints(&self, of: fn(&JointMotion) -> &Vec<f64>) -> Vec<&[f64]> {
        slices(self.played().joints.iter().map(of).take(self.links()))
    }

    /// A history of the carriage, the joint of one link or the last of an arm.
    fn carriage(&self, of: fn(&JointMotion) -> &Vec<f64>) -> Vec<&[f64]> {
        slices(self.played().joints.last().map(of).into_iter())
    }

    /// A history of the tip's axes, of one link along its arc.
    fn tip(&self, of: fn(&TipMotionHistories) -> &Vec<f64>) -> Vec<&[f64]> {
        slices(self.played().tip.iter().map(of))
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

impl Properties for Simulation {
    const PROPERTIES: &'static [(&'static str, Value<Self>)] = &[
        ("time", Computed(|own| times(&own.played().grid))),
        ("torque", Stored(|own| own.joints(|joint| &joint.torque_n_m))),
        ("force", Stored(|own| own.carriage(|joint| &joint.torque_n_m))),
        ("hub_angle joint_angle", Stored(|own| own.joints(|joint| &joint.angle_rad))),
        ("carriage", Stored(|own| own.carriage(|joint| &joint.angle_rad))),
        ("hub_rate joint_rate", Stored(|own| own.joints(|joint| &joint.rate_rad_s))),
        ("carriage_velocity", Stored(|own| own.carriage(|joint| &joint.rate_rad_s))),
        (
            "hub_acceleration joint_acceleration",
            Stored(|own| own.joints(|joint| &joint.acceleration_rad_s2)),
        ),
        ("carriage_acceleration", Stored(|own| own.carriage(|joint| &joint.acceleration_rad_s2))),
        ("chord_angle", Stored(|own| slices(own.bent().flat_map(|bent| &bent.chords_rad)))),
        ("tip_displacement tip", Stored(|own| own.tip(|axis| &axis.displacement_m))),
        ("tip_velocity", Stored(|own| own.tip(|axis| &axis.velocity_m_s))),
        ("tip_acceleration", Stored(|own| own.tip(|axis| &axis.acceleration_m_s2))),
        ("energy", Computed(Self::energy_j)),
        ("work", Stored(|own| slices(own.bent().map(|bent| &bent.work_j)))),
        ("dissipated", Stored(|own| slices(own.bent().map(|bent| &bent.lost_j)))),
        ("holding_torque", Computed(Self::holding_n_m)),
        ("nodes", Stored(|own| vec![own.played().mesh().nodes_m()])),
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
        let samples = self.played().grid.thinned(every.0).len();
        let nodes = checked(nodes, self.played().mesh().nodes_m().len(), samples)?;
        let histories =
            until_pressed(py, || Ok(self.played().displacements_m(&nodes, every.0)?))?;
        Ok(rows(py, &histories.samples, samples)?)
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
        let all = self.played().nodes_m();
        let own = all.get(link).ok_or_else(|| no_link(link, self.links()))?;
        let mut chosen = vec![Vec::new(); all.len()];
        chosen[link] = checked(nodes, own.len(), samples)?;
        let places_m = py.detach(|| Ok::<_, Failure>(self.played().places_m(&chosen, every.0)?))?;
        Ok(pairs(py, &places_m[link].concat(), samples)?)
    }

    /// Distances in m of the nodes of a ``link``, numbered from 0, from its joint.
    #[pyo3(signature = (link=0))]
    fn nodes_of<'py>(&self, py: Python<'py>, link: usize) -> Raises<Bound<'py, PyArray1<f64>>> {
        let all = self.played().nodes_m();
        let nodes_m = all.get(link).ok_or_else(|| no_link(link, self.links()))?;
        Ok(PyArray1::from_slice(py, nodes_m))
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
