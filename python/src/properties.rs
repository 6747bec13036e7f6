//! Properties of results by name, for one link and for arms.

use pyo3::PyClass;
use pyo3::exceptions::PyAttributeError;
use pyo3::pyclass::boolean_struct::True;
use pyo3::types::PyCFunction;

use flexlink::csv::Joints;

use crate::arrays::{pairs, rows, view};
use crate::prelude::*;

/// Kinds of links and arms for which a name exists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Links {
    Any,
    One,
    Several,
    /// One link on a hub.
    Hub,
    /// A link on a hub, or an arm.
    Turning,
    /// One link on a carriage.
    Sliding,
    /// A link or an arm on a carriage.
    Carriage,
    /// An arm on a carriage.
    CarriedArm,
}

impl Links {
    /// True if links with these joints have the name.
    pub(crate) fn holds(self, Joints { links, slides }: Joints) -> bool {
        match self {
            Self::Any => true,
            Self::One => links == 1,
            Self::Several => links > 1,
            Self::Hub => links == 1 && !slides,
            Self::Turning => links > 1 || !slides,
            Self::Sliding => links == 1 && slides,
            Self::Carriage => slides,
            Self::CarriedArm => links > 1 && slides,
        }
    }

    /// Refuses a name that links with these joints lack.
    pub(crate) fn refusal(self, name: &str, joints: Joints) -> String {
        match self {
            Self::Several => format!("{name} is for an arm, and this is one link"),
            Self::CarriedArm => format!("{name} is for an arm on a carriage"),
            Self::Hub | Self::Turning if joints.slides && joints.links == 1 => {
                format!("{name} is for a hub, and this link is on a carriage")
            }
            Self::Sliding | Self::Carriage if joints.links == 1 => {
                format!("{name} is for a carriage, and this link is on a hub")
            }
            Self::Carriage => format!("{name} is for a carriage, and the arm has none"),
            _ => format!("{name} is for one link, and the arm has several"),
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
    Turning torque,
    /// Force in N on the carriage. That of a simulation includes the feedback.
    Carriage force,
    /// Torque in N m that the hub of a rigid link, or each joint of a rigid arm, would need. None for a simulation.
    Turning rigid_torque,
    /// Force in N that the carriage of a rigid link or arm would need. None for a simulation.
    Carriage rigid_force,
    /// Hub angle in rad.
    Hub hub_angle,
    /// Hub rate in rad/s.
    Hub hub_rate,
    /// Hub acceleration in rad/s².
    Hub hub_acceleration,
    /// Hub angle in rad of the rigid link.
    Hub rigid_hub_angle,
    /// Position of the carriage in m.
    Carriage carriage,
    /// Velocity of the carriage in m/s.
    Carriage carriage_velocity,
    /// Acceleration of the carriage in m/s².
    Carriage carriage_acceleration,
    /// Position in m of the carriage of the rigid link.
    Sliding rigid_carriage,
    /// Moment in N m that its joint, or the carriage, exerts on the root of each link.
    Any root_moment,
    /// Angle in rad of each joint: of the first against x, of the others from the tip of the link before to the root of
    /// their link. That of one link is its hub angle.
    Turning joint_angle,
    /// Rate in rad/s of each joint.
    Turning joint_rate,
    /// Acceleration in rad/s² of each joint.
    Turning joint_acceleration,
    /// Angle in rad of each joint between rigid links.
    Turning rigid_joint_angle,
    /// x and y of the force in N on the inner end of each link: an array over time, link and axis.
    Several reaction,
    /// Direction in rad of each link's chord, from joint to joint.
    Several chord_angle,
    /// Rate in rad/s of each link's chord.
    Several chord_rate,
    /// Acceleration in rad/s² of each link's chord.
    Several chord_acceleration,
    /// Length in m of each link's chord.
    Several chord_length,
    /// Displacement of the tip in m along its arc.
    One tip_displacement,
    /// Velocity of the tip in m/s: along its arc, of an arm x and y.
    Any tip_velocity,
    /// Acceleration of the tip in m/s²: along its arc, of an arm x and y.
    Any tip_acceleration,
    /// Deflection of the tip in m from the hub's tangent line.
    One tip_deflection,
    /// x and y of the tip in m.
    Several tip,
    /// Torque of each motor in N m, not a number for a joint without a drive; None without any drive. The carriage of an arm
    /// has none, and no column.
    Any motor_torque,
    /// Angle of each motor in rad, in the form of ``motor_torque``.
    Any motor_angle,
    /// Rate of each motor in rad/s, in the form of ``motor_torque``.
    Any motor_rate,
    /// Power of each motor in W, in the form of ``motor_torque``.
    Any motor_power,
    /// Current of each motor in A, in the form of ``motor_torque``; None without any drive.torque_constant.
    Any motor_current,
    /// Acceleration of each motor in rad/s², in the form of ``motor_torque``.
    Any motor_acceleration,
    /// Voltage of each motor in V, in the form of ``motor_torque``; None without any drive.torque_constant and
    /// drive.resistance.
    Any motor_voltage,
    /// Energy in J of motion, strain and weight.
    Several energy,
    /// Work in J that the torques have done.
    Several work,
    /// Energy in J that damping and friction have dissipated.
    Several dissipated,
    /// Torques in N m that hold the arm where it starts.
    Several holding_torque,
    /// Distances of the nodes of one link from the axis in m; ``nodes_of`` has those of each link of an arm.
    One nodes,
    /// Times in s of the nodes' histories: those of ``time`` that were written.
    Any nodal_time,
    /// Errors of a solution, as in summary.json: ``errors["tip"]`` is the tip's distance from its motion over its travel,
    /// ``errors["torque"]["mesh"]`` the change by elements of half the length over the peak, and so on; of an arm
    /// ``errors["joints"][0]["torque"]``.
    Any errors,
    /// Peaks and other numbers of summary.json, of an arm those of its joints in the list ``results["joints"]``.
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
    Several positions,
    One written_nodes,
    One length,
    Hub rigid_inertia,
    Sliding rigid_mass,
}

/// Raises AttributeError if links with these joints lack the name.
pub(crate) fn check(name: &str, joints: Joints) -> PyResult<()> {
    match NAMES.iter().find(|(known, ..)| *known == name) {
        Some((_, of, _)) if !of.holds(joints) => {
            Err(PyAttributeError::new_err(of.refusal(name, joints)))
        }
        _ => Ok(()),
    }
}

/// Value of a property.
pub(crate) enum Value<T> {
    /// One stored history, or one for each joint or axis; None without any.
    Stored(fn(&T) -> Vec<&[f64]>),
    /// A stored history of each joint, which some joints lack; None where all do.
    OfJoints(fn(&T) -> Vec<Option<&[f64]>>),
    /// x and y for each link.
    Places(fn(&T) -> Vec<[&[f64]; 2]>),
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

/// Properties by name; blanks separate the names for hubs, arms and carriages.
pub(crate) type Named<T> = &'static [(&'static str, Value<T>)];

/// A result of one link or an arm.
pub(crate) trait Properties: PyClass<Frozen = True> + Sync + Sized + 'static {
    /// Properties of its class alone.
    const PROPERTIES: Named<Self>;

    /// Its joints.
    fn kind(&self) -> Joints;

    /// Number of its links.
    fn links(&self) -> usize {
        self.kind().links
    }
}

/// Adds its properties to the class, and `shared` ones.
pub(crate) fn add<T: Properties>(py: Python<'_>, shared: &[Named<T>]) -> PyResult<()> {
    let (class, property) = (py.get_type::<T>(), py.import("builtins")?.getattr("property")?);
    let properties = shared.iter().copied().chain([T::PROPERTIES]).flatten();
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
    check(name, of.get().kind())?;
    Ok(match value {
        Value::Stored(stored) => match &stored(of.get())[..] {
            [] => py.None().into_bound(py),
            [_] => view(of, |own| stored(own)[0]).into_any(),
            several => rows(py, several, several[0].len())?.into_any(),
        },
        Value::OfJoints(stored) => match &stored(of.get())[..] {
            [Some(_)] => view(of, |own| stored(own)[0].unwrap_or_default()).into_any(),
            joints => match joints.iter().flatten().next() {
                None => py.None().into_bound(py),
                Some(first) => {
                    let none = vec![f64::NAN; first.len()];
                    let columns: Vec<&[f64]> =
                        joints.iter().map(|own| own.unwrap_or(&none)).collect();
                    rows(py, &columns, none.len())?.into_any()
                }
            },
        },
        Value::Places(places) => {
            let axes = places(of.get()).concat();
            let samples = axes.first().map_or(0, |axis| axis.len());
            pairs(py, &axes, samples)?.into_any()
        }
        Value::Computed(computed) => PyArray1::from_vec(py, computed(of.get())).into_any(),
        Value::Notices(notices) => objects(py, &notices(of.get()))?.into_pyobject(py)?,
        Value::Entry => of.as_any().getattr("summary")?.get_item(name)?,
    })
}
