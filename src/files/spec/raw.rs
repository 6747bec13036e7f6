//! The link file key by key, as written; conversion decides which keys are allowed together. The types of the keys,
//! their comments and ranges make the JSON Schema.

use schemars::{JsonSchema, Schema};
use serde::Deserialize;
use serde_json::json;

use super::choices::{Model, Order, Shape, Theory, combinations, dimensions, properties};
use super::value::{
    AlongAxes, Angle, Area, BendingStiffness, Count, Density, Elements, Length, Mass,
    MassPerLength, Power, Pressure, Rate, RotaryInertia, RotaryInertiaPerLength, SecondMoment,
    ShearStiffness, Time, Torque, Unbounded, ViscousFriction, above_zero, at_least_zero, tables,
};

/// Link file of flexlink.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
#[schemars(extend("dependencies" = json!({ "start_angle": ["gravity"] })))]
pub(super) struct RawSpecification {
    /// Title, for people.
    pub(super) title: Option<String>,
    /// Theory of all segments that name none: euler-bernoulli, the default, is for slender ones, timoshenko
    /// takes shear and rotary inertia into account.
    #[schemars(extend("default" = "euler-bernoulli"))]
    pub(super) theory: Option<Theory>,
    /// Gravity along the x and y axes of the plane of motion, [0, -9.81] in a vertical one; by default that plane
    /// is horizontal. Angles count from x, counterclockwise.
    pub(super) gravity: Option<AlongAxes>,
    /// With gravity, the direction of the chord, from the hub's axis to the tip, where the tip's displacement is
    /// 0; needed unless the motion gives angles.
    pub(super) start_angle: Option<Angle>,
    /// Segments of the link, from the hub outward; at least one.
    #[serde(deserialize_with = "tables")]
    #[schemars(length(min = 1))]
    pub(super) segments: Vec<RawSegment>,
    /// What the motor turns.
    pub(super) hub: RawHub,
    /// Masses lumped on the link, any number.
    #[serde(deserialize_with = "tables")]
    pub(super) masses: Vec<RawMass>,
    /// What the tip carries.
    pub(super) payload: RawPayload,
    /// Damping of the link; without this table there is none.
    pub(super) damping: Option<RawDamping>,
    /// What sits between motor and hub; adds the tables of motor and held modes.
    pub(super) drive: Option<RawDrive>,
    /// What link and motor stand; exceeding one is a warning, with --strict an error.
    pub(super) limits: RawLimits,
    /// Finite elements.
    pub(super) mesh: RawMesh,
    /// How exact the answer is, around which time, of which modes.
    pub(super) analysis: RawAnalysis,
}

/// `[[segments]]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table")]
#[schemars(transform = properties)]
pub(super) struct RawSegment {
    /// Unique name, which addresses the segment in --set; not a number, without `.`, `*` and `=`.
    pub(super) name: Option<String>,
    /// Length along the link.
    #[schemars(transform = above_zero)]
    pub(super) length: Length,
    /// Bending stiffness; or give E and I, or E and section. [inner, outer] tapers linearly.
    #[serde(rename = "EI")]
    #[schemars(transform = above_zero)]
    pub(super) bending_stiffness: Option<BendingStiffness>,
    /// Young's modulus, with I or section.
    #[serde(rename = "E")]
    #[schemars(transform = above_zero)]
    pub(super) modulus: Option<Pressure>,
    /// Second moment of area, with E. [inner, outer] tapers linearly.
    #[serde(rename = "I")]
    #[schemars(transform = above_zero)]
    pub(super) second_moment: Option<SecondMoment>,
    /// Mass per length; or give density and area, or density and section. [inner, outer] tapers
    /// linearly.
    #[schemars(transform = at_least_zero)]
    pub(super) mass_per_length: Option<MassPerLength>,
    /// Density, with area or section.
    #[schemars(transform = at_least_zero)]
    pub(super) density: Option<Density>,
    /// Area of the cross-section, with density. [inner, outer] tapers linearly.
    #[schemars(transform = above_zero)]
    pub(super) area: Option<Area>,
    /// Cross-section, with E or density or both.
    pub(super) section: Option<RawSection>,
    /// Theory of this segment: euler-bernoulli or timoshenko; by default that of the link.
    pub(super) theory: Option<Theory>,
    /// Shear stiffness κ G A, with theory timoshenko; or give G or Poisson's ratio, with section.
    /// [inner, outer] tapers linearly.
    #[schemars(transform = above_zero)]
    pub(super) shear_stiffness: Option<ShearStiffness>,
    /// Shear modulus G, with section, which gives Cowper's shear coefficient κ and the area.
    #[schemars(transform = above_zero)]
    pub(super) shear_modulus: Option<Pressure>,
    /// Poisson's ratio ν, with section; G is E/(2(1 + ν)) where G is not given.
    #[schemars(range(max = 0.5), extend("exclusiveMinimum" = -1))]
    pub(super) poisson_ratio: Option<f64>,
    /// Rotary inertia of the cross-section per length; without it, the mass per length times I/A of section.
    /// [inner, outer] tapers linearly.
    #[schemars(transform = at_least_zero)]
    pub(super) rotary_inertia_per_length: Option<RotaryInertiaPerLength>,
    /// Elements of this segment; by default shared out from [mesh].
    pub(super) elements: Option<Count>,
}

/// `section = { … }`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table such as { shape = \"circle\", diameter = 0.01 }")]
#[schemars(transform = dimensions)]
pub(super) struct RawSection {
    /// rectangle (width, thickness), circle (diameter), tube (diameter, wall) or box (width, height,
    /// wall).
    pub(super) shape: Shape,
    /// Width across the plane of motion; of a rectangle or box.
    #[schemars(transform = above_zero)]
    pub(super) width: Option<Length>,
    /// Thickness in the plane of motion; of a rectangle.
    #[schemars(transform = above_zero)]
    pub(super) thickness: Option<Length>,
    /// Height in the plane of motion; of a box.
    #[schemars(transform = above_zero)]
    pub(super) height: Option<Length>,
    /// Outer diameter; of a circle or tube.
    #[schemars(transform = above_zero)]
    pub(super) diameter: Option<Length>,
    /// Thickness of the wall, below half the outer size; of a tube or box.
    #[schemars(transform = above_zero)]
    pub(super) wall: Option<Length>,
}

/// `[hub]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawHub {
    /// Rotary inertia about the axis.
    #[schemars(transform = at_least_zero, extend("default" = 0))]
    pub(super) inertia: RotaryInertia,
    /// Rigid radius from the axis to the link's root.
    #[schemars(transform = at_least_zero, extend("default" = 0))]
    pub(super) radius: Length,
    /// Viscous friction of the joint.
    #[schemars(transform = at_least_zero, extend("default" = 0))]
    pub(super) viscous_friction: ViscousFriction,
}

/// `[[masses]]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawMass {
    /// Distance from the axis, hub radius included; a node is placed there.
    #[schemars(transform = at_least_zero)]
    pub(super) at: Length,
    /// Mass.
    #[schemars(transform = at_least_zero)]
    pub(super) mass: Mass,
    /// Rotary inertia about its own centre.
    #[serde(default)]
    #[schemars(transform = at_least_zero, extend("default" = 0))]
    pub(super) inertia: RotaryInertia,
}

/// `[payload]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawPayload {
    /// Mass.
    #[schemars(transform = at_least_zero, extend("default" = 0))]
    pub(super) mass: Mass,
    /// Rotary inertia about its own centre of mass.
    #[schemars(transform = at_least_zero, extend("default" = 0))]
    pub(super) inertia: RotaryInertia,
    /// Distance of its centre of mass beyond the tip; negative towards the hub.
    #[schemars(extend("default" = 0))]
    pub(super) offset: Length,
}

/// `[damping]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
#[schemars(transform = combinations)]
pub(super) struct RawDamping {
    /// hysteretic (ratio), modal (ratio or ratios), rayleigh (alpha and beta, or modes and ratios),
    /// caughey (ratio, or ratios with or without modes) or none; by default hysteretic.
    #[schemars(extend("default" = "hysteretic"))]
    pub(super) model: Option<Model>,
    /// Damping ratio; 0.02 is usual for metal links.
    #[schemars(range(min = 0), extend("exclusiveMaximum" = 1))]
    pub(super) ratio: Option<f64>,
    /// Damping ratios, from mode 1 or one for each of `modes`.
    #[schemars(transform = shares)]
    pub(super) ratios: Option<Vec<f64>>,
    /// Flexible modes, from 1, that the ratios belong to.
    pub(super) modes: Option<Vec<Count>>,
    /// Rayleigh damping in proportion to mass.
    #[schemars(transform = at_least_zero, extend("default" = 0))]
    pub(super) alpha: Option<Rate>,
    /// Rayleigh damping in proportion to stiffness.
    #[schemars(transform = at_least_zero, extend("default" = 0))]
    pub(super) beta: Option<Time>,
}

/// `[drive]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawDrive {
    /// Stiffness of the elastic joint; inf, the default, is a stiff one.
    #[schemars(transform = above_zero)]
    pub(super) joint_stiffness: Option<Unbounded>,
    /// Rotary inertia of the rotor, on the motor side of the gear.
    #[schemars(transform = at_least_zero, extend("default" = 0))]
    pub(super) rotor_inertia: RotaryInertia,
    /// Turns of the motor for one turn of the hub, 1e-6 to 1e6.
    #[schemars(range(min = 1e-6, max = 1e6), extend("default" = 1))]
    pub(super) gear_ratio: Option<f64>,
}

/// `[limits]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawLimits {
    /// Peak torque at the hub, on the link's side of a drive.
    #[schemars(transform = above_zero)]
    pub(super) torque: Option<Torque>,
    /// Root mean square of the torque at the hub while it acts.
    #[schemars(transform = above_zero)]
    pub(super) rms_torque: Option<Torque>,
    /// Peak rate of the hub, an angle per time.
    #[schemars(transform = above_zero)]
    pub(super) hub_rate: Option<Rate>,
    /// Peak mechanical power at the hub.
    #[schemars(transform = above_zero)]
    pub(super) power: Option<Power>,
    /// Peak deflection of the tip from the hub's tangent line.
    #[schemars(transform = above_zero)]
    pub(super) deflection: Option<Length>,
    /// Peak bending moment at the link's root.
    #[schemars(transform = above_zero)]
    pub(super) bending_moment: Option<Torque>,
    /// Peak torque of the motor, on its own side of the gear; needs a [drive], as all limits of the
    /// motor.
    #[schemars(transform = above_zero)]
    pub(super) motor_torque: Option<Torque>,
    /// Root mean square of the motor's torque while it acts.
    #[schemars(transform = above_zero)]
    pub(super) motor_rms_torque: Option<Torque>,
    /// Peak rate of the rotor, an angle per time.
    #[schemars(transform = above_zero)]
    pub(super) motor_rate: Option<Rate>,
    /// Peak mechanical power of the motor.
    #[schemars(transform = above_zero)]
    pub(super) motor_power: Option<Power>,
}

/// `[mesh]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawMesh {
    /// Elements of the whole link, of each link of an arm, or "auto", the default where a segment has no number of its own:
    /// refined until all that is written is exact to tolerance.
    pub(super) elements: Option<Elements>,
    /// Share of its peak that "auto" may cost every quantity, 1e-12 to 0.1.
    #[schemars(range(min = 1e-12, max = 0.1), extend("default" = 1e-6))]
    pub(super) tolerance: Option<f64>,
}

/// `[analysis]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawAnalysis {
    /// Share of its peak that padding and wrap-around may cost every quantity, 1e-12 to 1e-2.
    #[schemars(range(min = 1e-12, max = 1e-2), extend("default" = 1e-6))]
    pub(super) tolerance: Option<f64>,
    /// Share of its travel that the tip may stray from the wanted motion, 1e-12 to 0.1: no frequency is
    /// solved that this does not need. 0: every frequency of the samples.
    #[schemars(range(min = 0.0, max = 0.1), extend("default" = 1e-6))]
    pub(super) tip_tolerance: Option<f64>,
    /// Time added before the trajectory's first sample; by default until the torque falls below
    /// tolerance there.
    #[schemars(transform = at_least_zero)]
    pub(super) lead: Option<Time>,
    /// Time added after the trajectory's last sample; by default likewise.
    #[schemars(transform = at_least_zero)]
    pub(super) lag: Option<Time>,
    /// Lowest flexible modes to keep, the paper's reduction; by default all.
    pub(super) modes: Option<Count>,
    /// What is counted beyond small deflections: none, first (gravity and centripetal forces along the link) or
    /// full (all, the slopes being large); by default none without gravity, full with gravity.
    pub(super) second_order: Option<Order>,
}

/// Adds the schema of a list of numbers from 0 to below 1, at least one.
fn shares(schema: &mut Schema) {
    schema.insert("minItems".into(), 1.into());
    let share = json!({ "type": "number", "minimum": 0, "exclusiveMaximum": 1 });
    schema.insert("items".into(), share);
}
