//! The link file key by key, as it is written; what is allowed together is decided elsewhere.
//!
//! The comments on the keys and their ranges become those of the JSON Schema.

use schemars::JsonSchema;
use serde::Deserialize as Derived;

use super::choices::{
    a_model, a_shape, at_least_one, damping_laws, section_shapes, stiffness_and_mass,
};
use super::quantity::{Count, Elements, Quantity, Real, Tapered, Unbounded};
use super::value_schema::{Range, a_share, quantity, shares, within};
use crate::numeric::Dimension;

/// Link file of flexlink.
#[derive(Debug, Derived, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawSpecification {
    /// Title, for people.
    pub(super) title: Option<String>,
    /// Segments of the link, from the hub outward; at least one.
    #[serde(default)]
    #[schemars(transform = at_least_one)]
    pub(super) segments: Vec<RawSegment>,
    /// What the motor turns.
    #[serde(default)]
    pub(super) hub: RawHub,
    /// Masses lumped on the link, any number.
    #[serde(default)]
    pub(super) masses: Vec<RawMass>,
    /// What the tip carries.
    #[serde(default)]
    pub(super) payload: RawPayload,
    /// Damping of the link; without this table there is none.
    pub(super) damping: Option<RawDamping>,
    /// What sits between motor and hub; adds the tables of motor and held modes.
    pub(super) drive: Option<RawDrive>,
    /// What link and motor stand; exceeding one is a warning, with --strict an error.
    #[serde(default)]
    pub(super) limits: RawLimits,
    /// Finite elements.
    #[serde(default)]
    pub(super) mesh: RawMesh,
    /// How exact the answer is, around which time, of which modes.
    #[serde(default)]
    pub(super) analysis: RawAnalysis,
}

/// `[[segments]]`
#[derive(Debug, Derived, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table")]
#[schemars(transform = stiffness_and_mass)]
pub(super) struct RawSegment {
    /// Unique name, which addresses the segment in --set; not a number, without `.`, `*` and `=`.
    pub(super) name: Option<String>,
    /// Length along the link.
    #[schemars(transform = quantity(Dimension::LENGTH, Range::AboveZero))]
    pub(super) length: Quantity,
    /// Bending stiffness; or give E and I, or E and section. [inner, outer] tapers linearly.
    #[serde(rename = "EI")]
    #[schemars(transform = quantity(Dimension::BENDING_STIFFNESS, Range::AboveZero))]
    pub(super) bending_stiffness: Option<Tapered>,
    /// Young's modulus, with I or section.
    #[serde(rename = "E")]
    #[schemars(transform = quantity(Dimension::PRESSURE, Range::AboveZero))]
    pub(super) modulus: Option<Quantity>,
    /// Second moment of area, with E. [inner, outer] tapers linearly.
    #[serde(rename = "I")]
    #[schemars(transform = quantity(Dimension::SECOND_MOMENT, Range::AboveZero))]
    pub(super) second_moment: Option<Tapered>,
    /// Mass per length; or give density and area, or density and section. [inner, outer] tapers
    /// linearly.
    #[schemars(transform = quantity(Dimension::MASS_PER_LENGTH, Range::AtLeastZero))]
    pub(super) mass_per_length: Option<Tapered>,
    /// Density, with area or section.
    #[schemars(transform = quantity(Dimension::DENSITY, Range::AtLeastZero))]
    pub(super) density: Option<Quantity>,
    /// Area of the cross-section, with density. [inner, outer] tapers linearly.
    #[schemars(transform = quantity(Dimension::AREA, Range::AboveZero))]
    pub(super) area: Option<Tapered>,
    /// Cross-section, with E or density or both.
    pub(super) section: Option<RawSection>,
    /// Elements of this segment; by default shared out from [mesh].
    pub(super) elements: Option<Count>,
}

/// `section = { … }`
#[derive(Debug, Derived, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table such as { shape = \"circle\", diameter = 0.01 }")]
#[schemars(transform = section_shapes)]
pub(super) struct RawSection {
    /// rectangle (width, thickness), circle (diameter), tube (diameter, wall) or box (width, height,
    /// wall).
    #[schemars(transform = a_shape)]
    pub(super) shape: String,
    /// Width across the plane of motion; of a rectangle or box.
    #[schemars(transform = quantity(Dimension::LENGTH, Range::AboveZero))]
    pub(super) width: Option<Quantity>,
    /// Thickness in the plane of motion; of a rectangle.
    #[schemars(transform = quantity(Dimension::LENGTH, Range::AboveZero))]
    pub(super) thickness: Option<Quantity>,
    /// Height in the plane of motion; of a box.
    #[schemars(transform = quantity(Dimension::LENGTH, Range::AboveZero))]
    pub(super) height: Option<Quantity>,
    /// Outer diameter; of a circle or tube.
    #[schemars(transform = quantity(Dimension::LENGTH, Range::AboveZero))]
    pub(super) diameter: Option<Quantity>,
    /// Thickness of the wall, below half the outer size; of a tube or box.
    #[schemars(transform = quantity(Dimension::LENGTH, Range::AboveZero))]
    pub(super) wall: Option<Quantity>,
}

/// `[hub]`
#[derive(Debug, Default, Derived, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawHub {
    /// Rotary inertia about the axis.
    #[schemars(transform = quantity(Dimension::ROTARY_INERTIA, Range::AtLeastZero).or(0))]
    pub(super) inertia: Quantity,
    /// Rigid radius from the axis to the link's root.
    #[schemars(transform = quantity(Dimension::LENGTH, Range::AtLeastZero).or(0))]
    pub(super) radius: Quantity,
    /// Viscous friction of the joint.
    #[schemars(transform = quantity(Dimension::VISCOUS_FRICTION, Range::AtLeastZero).or(0))]
    pub(super) viscous_friction: Quantity,
}

/// `[[masses]]`
#[derive(Debug, Derived, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawMass {
    /// Distance from the axis, hub radius included; a node is placed there.
    #[schemars(transform = quantity(Dimension::LENGTH, Range::AtLeastZero))]
    pub(super) at: Quantity,
    /// Mass.
    #[schemars(transform = quantity(Dimension::MASS, Range::AtLeastZero))]
    pub(super) mass: Quantity,
    /// Rotary inertia about its own centre.
    #[serde(default)]
    #[schemars(transform = quantity(Dimension::ROTARY_INERTIA, Range::AtLeastZero).or(0))]
    pub(super) inertia: Quantity,
}

/// `[payload]`
#[derive(Debug, Default, Derived, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawPayload {
    /// Mass.
    #[schemars(transform = quantity(Dimension::MASS, Range::AtLeastZero).or(0))]
    pub(super) mass: Quantity,
    /// Rotary inertia about its own centre of mass.
    #[schemars(transform = quantity(Dimension::ROTARY_INERTIA, Range::AtLeastZero).or(0))]
    pub(super) inertia: Quantity,
    /// Distance of its centre of mass beyond the tip; negative towards the hub.
    #[schemars(transform = quantity(Dimension::LENGTH, Range::Any).or(0))]
    pub(super) offset: Quantity,
}

/// `[damping]`
#[derive(Debug, Default, Derived, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
#[schemars(transform = damping_laws)]
pub(super) struct RawDamping {
    /// hysteretic (ratio), modal (ratio or ratios), rayleigh (alpha and beta, or modes and ratios),
    /// caughey (ratio, or ratios with or without modes) or none; by default hysteretic.
    #[schemars(transform = a_model)]
    pub(super) model: Option<String>,
    /// Damping ratio; 0.02 is usual for metal links.
    #[schemars(transform = a_share)]
    pub(super) ratio: Option<Real>,
    /// Damping ratios, from mode 1 or one for each of `modes`.
    #[schemars(transform = shares)]
    pub(super) ratios: Option<Vec<Real>>,
    /// Flexible modes, from 1, that the ratios belong to.
    pub(super) modes: Option<Vec<Count>>,
    /// Rayleigh damping in proportion to mass.
    #[schemars(transform = quantity(Dimension::RATE, Range::AtLeastZero).or(0))]
    pub(super) alpha: Option<Quantity>,
    /// Rayleigh damping in proportion to stiffness.
    #[schemars(transform = quantity(Dimension::TIME, Range::AtLeastZero).or(0))]
    pub(super) beta: Option<Quantity>,
}

/// `[drive]`
#[derive(Debug, Default, Derived, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawDrive {
    /// Stiffness of the elastic joint; inf, the default, is a stiff one.
    #[schemars(transform = quantity(Dimension::TORQUE, Range::AboveZero))]
    pub(super) joint_stiffness: Option<Unbounded>,
    /// Rotary inertia of the rotor, on the motor side of the gear.
    #[schemars(transform = quantity(Dimension::ROTARY_INERTIA, Range::AtLeastZero).or(0))]
    pub(super) rotor_inertia: Quantity,
    /// Turns of the motor for one turn of the hub, 1e-6 to 1e6.
    #[schemars(transform = within(1e-6, 1e6), extend("default" = 1))]
    pub(super) gear_ratio: Option<Real>,
}

/// `[limits]`
#[derive(Debug, Default, Derived, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawLimits {
    /// Peak torque at the hub, on the link's side of a drive.
    #[schemars(transform = quantity(Dimension::TORQUE, Range::AboveZero))]
    pub(super) torque: Option<Quantity>,
    /// Root mean square of the torque at the hub while it acts.
    #[schemars(transform = quantity(Dimension::TORQUE, Range::AboveZero))]
    pub(super) rms_torque: Option<Quantity>,
    /// Peak rate of the hub, an angle per time.
    #[schemars(transform = quantity(Dimension::RATE, Range::AboveZero))]
    pub(super) hub_rate: Option<Quantity>,
    /// Peak mechanical power at the hub.
    #[schemars(transform = quantity(Dimension::POWER, Range::AboveZero))]
    pub(super) power: Option<Quantity>,
    /// Peak deflection of the tip from the hub's tangent line.
    #[schemars(transform = quantity(Dimension::LENGTH, Range::AboveZero))]
    pub(super) deflection: Option<Quantity>,
    /// Peak bending moment at the link's root.
    #[schemars(transform = quantity(Dimension::TORQUE, Range::AboveZero))]
    pub(super) bending_moment: Option<Quantity>,
    /// Peak torque of the motor, on its own side of the gear; needs a [drive], as all limits of the
    /// motor.
    #[schemars(transform = quantity(Dimension::TORQUE, Range::AboveZero))]
    pub(super) motor_torque: Option<Quantity>,
    /// Root mean square of the motor's torque while it acts.
    #[schemars(transform = quantity(Dimension::TORQUE, Range::AboveZero))]
    pub(super) motor_rms_torque: Option<Quantity>,
    /// Peak rate of the rotor, an angle per time.
    #[schemars(transform = quantity(Dimension::RATE, Range::AboveZero))]
    pub(super) motor_rate: Option<Quantity>,
    /// Peak mechanical power of the motor.
    #[schemars(transform = quantity(Dimension::POWER, Range::AboveZero))]
    pub(super) motor_power: Option<Quantity>,
}

/// `[mesh]`
#[derive(Debug, Default, Derived, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawMesh {
    /// Elements of the whole link, or "auto", the default where a segment has no number of its own:
    /// refined until all that is written is exact to tolerance.
    pub(super) elements: Option<Elements>,
    /// Share of its peak that "auto" may cost every quantity, 1e-12 to 0.1.
    #[schemars(transform = within(1e-12, 0.1), extend("default" = 1e-6))]
    pub(super) tolerance: Option<Real>,
}

/// `[analysis]`
#[derive(Debug, Default, Derived, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawAnalysis {
    /// Share of its peak that padding and wrap-around may cost every quantity, 1e-12 to 1e-2.
    #[schemars(transform = within(1e-12, 1e-2), extend("default" = 1e-6))]
    pub(super) tolerance: Option<Real>,
    /// Share of its way that the tip may stray from the wanted motion, 1e-12 to 0.1: no frequency is
    /// solved that this does not need. 0: every frequency of the samples.
    #[schemars(transform = within(0.0, 0.1), extend("default" = 1e-6))]
    pub(super) tip_tolerance: Option<Real>,
    /// Time added before the trajectory's first sample; by default until the torque falls below
    /// tolerance there.
    #[schemars(transform = quantity(Dimension::TIME, Range::AtLeastZero))]
    pub(super) lead: Option<Quantity>,
    /// Time added after the trajectory's last sample; by default likewise.
    #[schemars(transform = quantity(Dimension::TIME, Range::AtLeastZero))]
    pub(super) lag: Option<Quantity>,
    /// Lowest flexible modes to keep, the paper's reduction; by default all.
    pub(super) modes: Option<Count>,
}
