//! `modes` and `frf`, of links and of arms.

use std::f64::consts::TAU;

use flexlink::cli::frf::Frf;
use flexlink::cli::modes::{Wanted, computed};
use flexlink::response::{PoseMode, SettledModes};
use flexlink::result::{ModesResult, Setting};

use crate::arrays::{OneOrEach, dictionary, rows};
use crate::keywords::{arguments, parsed};
use crate::link::Link;
use crate::prelude::*;
use crate::threads::until_pressed;

/// Natural frequencies, damping ratios, mode shapes and zeros, as a dictionary of arrays.
///
/// ``at`` is the direction of a link under gravity in rad, or those of all links of an arm. The frequencies are then those
/// of small motions there: ``free_hz`` with free joints and ``held_hz`` with held rotors, imaginary ones as negative
/// numbers.
///
/// >>> import flexlink
/// >>> strip = {"length": 1.0, "EI": 10.0, "mass_per_length": 0.5}
/// >>> result = flexlink.modes(flexlink.Link(segments=[strip]), count=2)
/// >>> pinned = 3.926602312**2 * (10.0 / 0.5) ** 0.5 / 6.283185307  # of a pinned and free beam
/// >>> bool(abs(result["frequency_hz"][0] / pinned - 1) < 1e-6)
/// True
/// >>> result["shapes"].shape == (2, result["nodes"].size)
/// True
#[pyfunction]
#[pyo3(signature = (link, count=10, *, at=None))]
pub(crate) fn modes<'py>(
    py: Python<'py>,
    link: &Link,
    count: usize,
    at: Option<OneOrEach<f64>>,
) -> Dictionary<'py> {
    if !(1..=1000).contains(&count) {
        return Err(usage(&format!("count = {count}, but must be 1 to 1000"), None).into());
    }
    let at = at.map(OneOrEach::list);
    let specification = &link.specification;
    let compute = || computed(specification, at.as_deref(), count, Wanted::Modes);
    let result = until_pressed(py, compute)?;
    warn(py, &result.warnings(&specification.arm))?;
    let in_pose = [("free_hz", each(&result.free, hertz)), ("held_hz", each(&result.held, hertz))];
    Ok(match &result.setting {
        Setting::Weightless => level(py, &result)?,
        Setting::Straight { .. } => dictionary(py, in_pose)?,
        Setting::AtRest { tip_m, holding_torques_n_m, .. } => {
            let at_rest = [("holding_torque", &holding_torques_n_m[..]), ("tip", &tip_m[..])];
            let at_rest = at_rest.map(|(name, numbers)| (name, numbers.to_vec()));
            dictionary(py, in_pose.into_iter().chain(at_rest))?
        }
    })
}

/// Numbers of all modes.
fn each(own: &SettledModes, of: impl Fn(&PoseMode) -> f64) -> Vec<f64> {
    own.modes.iter().map(of).collect()
}

/// Frequencies in Hz. A mode that leaves the pose has an imaginary one, here a negative number.
fn hertz(mode: &PoseMode) -> f64 {
    mode.square_per_s2.abs().sqrt().copysign(mode.square_per_s2) / TAU
}

fn level<'py>(py: Python<'py>, result: &ModesResult) -> PyResult<Bound<'py, PyDict>> {
    let ratio = |mode: &PoseMode| mode.damping_ratio.unwrap_or(f64::NAN);
    let (free, held) = (&result.free, &result.held);
    let (zeros, nodes_m) = (&result.zeros[0], result.meshes[0].nodes_m());
    let columns = [
        ("frequency_hz", each(free, hertz)),
        ("damping_ratio", each(free, ratio)),
        ("mesh_error", free.errors.clone()),
        ("zero_per_s", zeros.zeros_per_s.clone()),
        ("zero_mesh_error", zeros.mesh_errors.clone()),
        ("blocked_hz", zeros.blocked_hz.clone()),
        ("nodes", nodes_m.to_vec()),
        ("held_hz", each(held, hertz)),
        ("held_damping_ratio", each(held, ratio)),
    ];
    let table = dictionary(py, columns)?;
    let shapes = result.displacements();
    // A row for each mode.
    table.set_item("shapes", rows(py, &shapes, nodes_m.len())?.call_method0("transpose")?)?;
    Ok(table)
}

/// Options with another keyword: `from` is a word of Python.
const RENAMED: [(&str, &str); 2] = [("from", "start"), ("to", "stop")];

/// Frequency response, as a dictionary of the columns that ``flexlink frf`` writes: for a link torque per tip
/// acceleration, hub angle per tip displacement, tip displacement per torque.
///
/// Keywords are the options ``start``, ``stop`` (``--from`` and ``--to``, in Hz), ``points``, ``linear`` and ``at``, the
/// directions of the links in rad, which an arm needs. With ``at`` the columns are tip displacement and joint angles per
/// torque, about the shape at rest there.
///
/// >>> import flexlink
/// >>> link = flexlink.Link(segments=[{"length": 1.0, "EI": 10.0, "mass_per_length": 0.5}])
/// >>> response = flexlink.frf(link, start=0.001, stop=10, points=3)
/// >>> inertia = response["torque_per_tip_acceleration_kg_m_real"][0]
/// >>> bool(abs(inertia - link.rigid_inertia / link.length) < 1e-6)  # slowly it turns as if it were rigid
/// True
#[pyfunction]
#[pyo3(signature = (link, **keywords))]
pub(crate) fn frf<'py>(
    py: Python<'py>,
    link: &Link,
    keywords: Option<Keywords<'py>>,
) -> Dictionary<'py> {
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let mut words = arguments(&keywords, &RENAMED)?;
    // The parser requires a file, but the call has the link itself.
    words.push("link".to_owned());
    let frf: Frf = parsed(&words, &[], &RENAMED)?;
    let response = until_pressed(py, || frf.compute(&link.specification).map_err(renamed))?;
    let coarse = response.error.and_then(|error| error.warning);
    warn(py, &coarse.map(Notice::from).into_iter().collect::<Vec<_>>())?;
    Ok(dictionary(py, response.columns)?)
}

/// A refusal with the names of the call.
fn renamed(failure: Failure) -> Failure {
    let named = |text: String| text.replace("--from", "--start").replace("--to", "--stop");
    Failure { message: named(failure.message), hint: failure.hint.map(named), ..failure }
}
