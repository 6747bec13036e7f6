//! Properties of results by name, for one link and for arms, and data frames of them.

use pyo3::PyClass;
use pyo3::exceptions::PyAttributeError;
use pyo3::pyclass::boolean_struct::True;
use pyo3::types::PyCFunction;

use crate::arrays::{rows, view};
use crate::prelude::*;

/// Number of links for which a name exists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Links {
    Any,
    One,
    Several,
}

impl Links {
    /// True if this many links have the name.
    pub(crate) fn holds(self, links: usize) -> bool {
        match self {
            Self::Any => true,
            Self::One => links == 1,
            Self::Several => links > 1,
        }
    }

    /// Refuses a name that one link or an arm lacks.
    pub(crate) fn refusal(self, name: &str) -> String {
        match self {
            Self::One | Self::Any => format!("{name} is for one link, and the arm has several"),
            Self::Several => format!("{name} is for an arm, and this is one link"),
        }
    }
}

/// Builds the table of names from lines `Links name`, each after the docs of its property.
macro_rules! names {
    ($($(#[doc = $docs:literal])* $links:ident $name:ident,)+) => {
        const NAMES: &[(&str, Links, &str)] =
            &[$((stringify!($name), Links::$links, concat!($($docs, "\n",)*))),+];
    };
}

names! {
    /// Times in s. Those of a solution begin before its motion and end after it.
    Any time,
    /// Torque in N m at the hub, or of each joint: it turns its link, and the link before in the opposite direction. That
    /// of a simulation includes the feedback.
    Any torque,
    /// Torque in N m that the hub of a rigid link, or each joint of a rigid arm, would need. None for a simulation.
    Any rigid_torque,
    /// Hub angle in rad.
    One hub_angle,
    /// Hub rate in rad/s.
    One hub_rate,
    /// Hub acceleration in rad/s².
    One hub_acceleration,
    /// Hub angle in rad of the rigid link.
    One rigid_hub_angle,
    /// Moment in N m that the hub exerts on the link's root.
    One root_moment,
    /// Angle in rad of each joint: of the first against x, of the others from the tip of the link before to the root of
    /// their link.
    Several joint_angle,
    /// Rate in rad/s of each joint.
    Several joint_rate,
    /// Acceleration in rad/s² of each joint.
    Several joint_acceleration,
    /// Direction in rad of each link's chord, from joint to joint.
    Several chord_angle,
    /// Displacement of the tip in m along its arc.
    One tip_displacement,
    /// Velocity of the tip in m/s.
    One tip_velocity,
    /// Acceleration of the tip in m/s².
    One tip_acceleration,
    /// Deflection of the tip in m from the hub's tangent line.
    One tip_deflection,
    /// x and y of the tip in m.
    Several tip,
    /// Torque of the motor in N m; None for a link without a drive.
    One motor_torque,
    /// Rate of the motor in rad/s; None for a link without a drive.
    One motor_rate,
    /// Energy in J of motion, strain and weight.
    Several energy,
    /// Work in J that the torques have done.
    Several work,
    /// Energy in J that damping and friction have dissipated.
    Several dissipated,
    /// Torques in N m that hold the arm where it starts.
    Several holding_torque,
    /// Distances of the nodes from the axis in m.
    One nodes,
    /// Times in s of the nodes' histories: those of ``time`` that were written.
    One nodal_time,
    /// Errors of a solution, as in summary.json: ``errors["tip"]`` is the tip's distance from its motion over its travel,
    /// ``errors["torque"]["mesh"]`` the change by elements of half the length over the peak, and so on.
    Any errors,
    /// Peaks and other numbers of summary.json.
    Any results,
    /// Distance of the tip from its ``target``, as in summary.json: ``worst_m``, ``share`` of the largest distance from
    /// the start, ``time_s``, ``rms_m``, ``final_m``; None without a target.
    Any tip_error,
    /// Warnings, which Python's filters received, too.
    Any warnings,
    /// Remarks on values that are possible but rare, often a slip of units.
    Any remarks,
    // Methods, and properties with code of their own.
    One displacements,
    One deflections,
    One moments,
    Several positions,
    One written_nodes,
    One length,
    One rigid_inertia,
}

/// Raises AttributeError if this many links lack the name.
pub(crate) fn check(name: &str, links: usize) -> PyResult<()> {
    match NAMES.iter().find(|(known, ..)| *known == name) {
        Some((_, of, _)) if !of.holds(links) => Err(PyAttributeError::new_err(of.refusal(name))),
        _ => Ok(()),
    }
}

/// Value of a property.
pub(crate) enum Value<T> {
    /// One stored history, or one for each joint or axis; None without any.
    Stored(fn(&T) -> Vec<&[f64]>),
    /// A history that each access computes.
    Computed(fn(&T) -> Vec<f64>),
    /// Notices as objects.
    Notices(fn(&T) -> Vec<Notice>),
    /// The entry of this name in the property `summary`.
    Entry,
}

/// Histories as slices.
pub(crate) fn slices<'a>(histories: impl Iterator<Item = &'a Vec<f64>>) -> Vec<&'a [f64]> {
    histories.map(Vec::as_slice).collect()
}

/// A result of one link or an arm.
pub(crate) trait Properties: PyClass<Frozen = True> + Sync + Sized + 'static {
    /// Its properties by name; a blank separates the name for one link from that for arms.
    const PROPERTIES: &'static [(&'static str, Value<Self>)];
    /// Columns of its data frame, for one link and for arms, with blanks between.
    const FRAME: &'static str;

    /// Number of its links.
    fn links(&self) -> usize;
}

/// Adds the properties to the class.
pub(crate) fn add<T: Properties>(py: Python<'_>) -> PyResult<()> {
    let (class, property) = (py.get_type::<T>(), py.import("builtins")?.getattr("property")?);
    let properties = T::PROPERTIES.iter();
    let named =
        properties.flat_map(|(names, value)| names.split(' ').map(move |name| (name, value)));
    for (name, value) in named {
        let read = move |arguments: &Bound<'_, PyTuple>, _: Option<&Bound<'_, PyDict>>| {
            let of = arguments.get_item(0)?.cast_into::<T>()?;
            Ok::<_, PyErr>(read(&of, name, value)?.unbind())
        };
        let read = PyCFunction::new_closure(py, None, None, read)?;
        let docs = NAMES.iter().find(|(known, ..)| *known == name).map(|(.., docs)| docs.trim());
        class.setattr(name, property.call1((read, py.None(), py.None(), docs))?)?;
    }
    Ok(())
}

fn read<'py, T: Properties>(
    of: &Bound<'py, T>,
    name: &str,
    value: &Value<T>,
) -> PyResult<Any<'py>> {
    let py = of.py();
    check(name, of.get().links())?;
    Ok(match value {
        Value::Stored(stored) => match &stored(of.get())[..] {
            [] => py.None().into_bound(py),
            [_] => view(of, |own| stored(own)[0]).into_any(),
            several => rows(py, several, several[0].len())?.into_any(),
        },
        Value::Computed(computed) => PyArray1::from_vec(py, computed(of.get())).into_any(),
        Value::Notices(notices) => objects(py, &notices(of.get()))?.into_pyobject(py)?,
        Value::Entry => of.as_any().getattr("summary")?.get_item(name)?,
    })
}

/// The histories as a `pandas.DataFrame` over the time.
pub(crate) fn frame<'py, T: Properties>(of: &Bound<'py, T>) -> PyResult<Any<'py>> {
    of.py().import("flexlink._frames")?.call_method1("frame", (of, T::FRAME))
}
