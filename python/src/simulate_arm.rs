//! `simulate` of an arm: torques of its joints in arrays, played.

use std::path::PathBuf;

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods as _};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use flexlink::cli::options::moves::{AtRest, Begins, Moves, Moving};
use flexlink::cli::options::play::feedback;
use flexlink::cli::terminal::Failure;
use flexlink::numeric::TimeGrid;
use flexlink::response::{BentPlay, HubReference, Interpolation, JointMotion, Torque};
use flexlink::result::TipPlaces;

use crate::arm::Arm;
use crate::arrays::{Every, column, columns, frame, rows};
use crate::interrupt::until_pressed;
use crate::messages::{Raised, objects, usage};
use crate::play::{HALF_A_FEEDBACK, Keywords, OF_ARM, OF_LINK, Run, history, refuse_both, state};

type Array<'py> = Bound<'py, PyArray1<f64>>;
type Columns<'py> = Bound<'py, PyArray2<f64>>;

/// The refusal of gains that are no numbers.
const NO_GAINS: &str =
    "feedback = something else, but must be (stiffness, damping), or a list of one for each joint";

/// The gains of all joints, or of each.
#[derive(FromPyObject)]
enum Gains {
    One([f64; 2]),
    Each(Vec<[f64; 2]>),
}

/// Takes all arrays of a call on an arm out of its keywords.
fn arm_moves(
    arm: &Arm,
    time: &Bound<'_, PyAny>,
    keywords: &Keywords<'_, '_>,
) -> Result<Moves, Raised> {
    let arm = &arm.specification.arm;
    let links = arm.links().len();
    let time_s = column("time", time)?;
    let of_joints = |name: &str| {
        let given = keywords.take(name)?;
        given.map(|given| columns(name, &given, (time_s.len(), links))).transpose()
    };
    let Some(torques) = of_joints("torque")? else {
        let must = "must be given, a column for each joint";
        return Err(usage(&format!("torque = nothing, but {must}"), None).into());
    };
    let torques = torques.into_iter().map(|own| Torque::new(&time_s, own));
    let torques: Vec<Torque> = torques.collect::<Result<_, _>>().map_err(|e| history(&e))?;
    let gains = keywords.take("feedback")?.map(|given| match given.extract::<Gains>() {
        Ok(Gains::One(pair)) => Ok(vec![pair.into()]),
        Ok(Gains::Each(pairs)) => Ok(pairs.into_iter().map(Into::into).collect()),
        Err(_) => Err(usage(&NO_GAINS, None)),
    });
    let gains: Option<Vec<(f64, f64)>> = gains.transpose()?;
    let references = match (&gains, of_joints("reference")?, of_joints("reference_rate")?) {
        (None, None, None) => Vec::new(),
        (Some(_), Some(angles), rates) => joint_references(&time_s, angles, rates)?,
        _ => return Err(usage(&HALF_A_FEEDBACK, None).into()),
    };
    let feedback = feedback(gains.as_deref(), references, links)?;
    let target = keywords.take("target")?;
    let target = target.map(|own| places(&own, torques[0].grid())).transpose()?;
    let at = keywords.array("at")?;
    let state = keywords.take("state")?.map(|given| state(&given, links)).transpose()?;
    refuse_both([("at", at.is_some()), ("state", state.is_some())])?;
    let interpolation = keywords.hold()?.unwrap_or(Interpolation::Cubic);
    let until_s = keywords.number("until")?;
    keywords.refuse_rest(OF_ARM, OF_LINK, "is for one link, and the arm has several")?;
    let begins = Begins { state: state.is_some(), moved: false, at: at.as_deref(), tip_m: None };
    let start = AtRest::of(arm, &begins, (&feedback, target.as_ref()))?;
    Ok(Moves {
        moving: Moving::Torques(torques),
        interpolation,
        until_s,
        feedback,
        start,
        state,
        target,
        start_angle_rad: None,
        is_large: false,
        is_periodic: false,
    })
}

/// Angles of the joints at these times, and their rates if known.
fn joint_references(
    time_s: &[f64],
    angles: Vec<Vec<f64>>,
    rates: Option<Vec<Vec<f64>>>,
) -> Result<Vec<HubReference>, Failure> {
    let rates = rates
        .map_or_else(|| vec![None; angles.len()], |rates| rates.into_iter().map(Some).collect());
    let joint = |(angle, rate)| HubReference::new(time_s, angle, rate);
    let joints = angles.into_iter().zip(rates).map(joint);
    joints.collect::<Result<_, _>>().map_err(|error| history(&error))
}

/// Wanted places of the tip at the times of the torques.
fn places(given: &Bound<'_, PyAny>, grid: TimeGrid) -> Result<TipPlaces, Raised> {
    let found = columns("target", given, (grid.len, 2))?;
    let stray = found.iter().flatten().find(|own| !own.is_finite());
    match stray {
        None => Ok(TipPlaces { grid, at_m: found }),
        Some(_) => Err(usage(&"target: not a number, but must be finite numbers", None).into()),
    }
}

/// The motion of an arm on which torques were played. Arrays have a row for each of ``time`` and a column for each joint,
/// the inner one first; units are SI.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct ArmSimulation(pub(crate) Run);

impl ArmSimulation {
    /// Plays the input of the call, until Ctrl-C.
    pub(crate) fn play(
        py: Python<'_>,
        arm: &Arm,
        time: &Bound<'_, PyAny>,
        keywords: &Keywords<'_, '_>,
    ) -> Result<Self, Raised> {
        let moves = arm_moves(arm, time, keywords)?;
        let specification = arm.specification.clone();
        until_pressed(py, || Run::of(specification, moves)).map(Self)
    }

    fn of_joints<'py>(
        &self,
        py: Python<'py>,
        histories: &[impl AsRef<[f64]>],
    ) -> PyResult<Columns<'py>> {
        rows(py, histories, self.0.played.grid.len)
    }

    /// A history of each joint.
    fn of_each<'py>(
        &self,
        py: Python<'py>,
        history: fn(&JointMotion) -> &Vec<f64>,
    ) -> PyResult<Columns<'py>> {
        let histories: Vec<&[f64]> =
            self.0.played.joints.iter().map(|own| &history(own)[..]).collect();
        self.of_joints(py, &histories)
    }

    /// The play of the links.
    fn bent(&self) -> PyResult<&BentPlay> {
        let none = || PyRuntimeError::new_err("an arm is played as elasticas");
        self.0.played.bent().ok_or_else(none)
    }
}

#[pymethods]
impl ArmSimulation {
    /// Times in s.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Array<'py> {
        let grid = &self.0.played.grid;
        PyArray1::from_vec(py, (0..grid.len).map(|k| grid.time_s(k)).collect())
    }

    /// Torque in N m of each joint, that of the feedback included.
    #[getter]
    fn torque<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        self.of_each(py, |own| &own.torque_n_m)
    }

    /// Angle in rad of each joint: of its link's root against the tip of the link before, of the first joint against x.
    #[getter]
    fn joint_angle<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        self.of_each(py, |own| &own.angle_rad)
    }

    /// Rate in rad/s of each joint.
    #[getter]
    fn joint_rate<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        self.of_each(py, |own| &own.rate_rad_s)
    }

    /// Acceleration in rad/s² of each joint.
    #[getter]
    fn joint_acceleration<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        self.of_each(py, |own| &own.acceleration_rad_s2)
    }

    /// Direction in rad of each link's chord, from joint to joint.
    #[getter]
    fn chord_angle<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        self.of_joints(py, &self.bent()?.chords_rad)
    }

    /// x and y of the tip in m.
    #[getter]
    fn tip<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        let axes = self.0.played.tip.iter().map(|axis| &axis.displacement_m[..]);
        self.of_joints(py, &axes.collect::<Vec<_>>())
    }

    /// Kinetic energy, and that of strain and weight, in J.
    #[getter]
    fn energy<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        let BentPlay { kinetic_j, potential_j, .. } = self.bent()?;
        let all = kinetic_j.iter().zip(potential_j).map(|(kinetic, held)| kinetic + held);
        Ok(PyArray1::from_vec(py, all.collect()))
    }

    /// Work in J that the torques have done.
    #[getter]
    fn work<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        Ok(PyArray1::from_slice(py, &self.bent()?.work_j))
    }

    /// What damping and friction have dissipated in J.
    #[getter]
    fn dissipated<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        Ok(PyArray1::from_slice(py, &self.bent()?.lost_j))
    }

    /// Torques in N m that hold the arm where it starts.
    #[getter]
    fn holding_torque<'py>(&self, py: Python<'py>) -> Array<'py> {
        let holding = self.0.played.joints.iter().filter_map(|joint| joint.holding_n_m);
        PyArray1::from_vec(py, holding.collect())
    }

    /// x and y in m of the nodes of a link, numbered from 0, of every ``every``-th sample: an array over time, node and axis.
    #[pyo3(signature = (link, every=Every::ALL))]
    fn positions<'py>(
        &self,
        py: Python<'py>,
        link: usize,
        every: Every,
    ) -> Result<Bound<'py, PyArray3<f64>>, Raised> {
        let Run { played, .. } = &self.0;
        let nodes: Vec<Vec<usize>> =
            played.nodes_m().iter().map(|nodes_m| (0..nodes_m.len()).collect()).collect();
        let links = nodes.len();
        if link >= links {
            let message = format!("link = {link}, but must be below {links}, the number of links");
            return Err(usage(&message, None).into());
        }
        let found = py.detach(|| Ok::<_, Failure>(played.places_m(&nodes, every.0)?))?;
        let histories: Vec<&[f64]> = found[link].iter().flatten().map(Vec::as_slice).collect();
        let samples = played.grid.thinned(every.0).len();
        Ok(rows(py, &histories, samples)?.reshape([samples, found[link].len(), 2])?)
    }

    /// What summary.json of a run holds.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>, Raised> {
        self.0.summary_of(py)
    }

    /// Numbers of each joint and of the tip, as in summary.json.
    #[getter]
    fn results<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary(py)?.get_item("results")
    }

    /// How exact the motion is, as in summary.json: what the last refinement changes, and the share of energy that is
    /// missing.
    #[getter]
    fn errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary(py)?.get_item("errors")
    }

    /// Distance of the tip from its ``target``, as in summary.json: ``worst_m``, ``share`` of the largest distance from the
    /// start, ``time_s``, ``rms_m``, ``final_m``; None without a target.
    #[getter]
    fn tip_error<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary(py)?.get_item("tip_error")
    }

    /// What the user must know: warnings that were given to Python's filters, too.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        objects(py, &self.0.warnings)
    }

    /// Writes the files of ``flexlink simulate`` into a folder, all or none. Keywords are its options ``nodes``, ``stations``,
    /// ``every``, ``digits``.
    #[pyo3(signature = (folder, **keywords))]
    fn write(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        keywords: Option<Bound<'_, PyDict>>,
    ) -> Result<(), Raised> {
        self.0.write(py, &folder, keywords.as_ref())
    }

    /// Writes the state at the end, as ``--save-state`` of the command: ``state`` of a later call goes on from it.
    fn save_state(&self, py: Python<'_>, path: PathBuf) -> Result<(), Raised> {
        self.0.save_state(py, &path)
    }

    /// The histories as a `pandas.DataFrame` over the time, a column for each joint: ``torque1``, ``torque2``.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        frame(slf, &["torque", "joint_angle", "joint_rate", "chord_angle", "tip"])
    }

    fn __repr__(&self) -> String {
        let joints = self.0.played.joints.len();
        format!("ArmSimulation(samples={}, joints={joints})", self.0.played.grid.len)
    }
}
