//! The link file key by key, as written, and the keys that exclude, replace or need each other. The types of the keys,
//! their comments and ranges make the JSON Schema.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::LazyLock;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value, json};

use super::value::{
    AlongAxes, Angle, Area, Axis, BendingStiffness, Count, Density, Elements, Ends, Friction,
    JointRate, Length, Mass, MassPerLength, Pressure, Rate, Resistance, RotaryInertia,
    RotaryInertiaPerLength, SecondMoment, ShearStiffness, SlidingFriction, Time, TorqueConstant,
    Unbounded, ViscousFriction, above_zero, at_least_zero, quantity, tables,
};
use crate::elastica::SecondOrder;
use crate::link::Joint;
use crate::numeric::Dimension;
use crate::result::JointQuantity;

/// Key of the table of intervals.
pub(super) const UNCERTAINTY: &str = "uncertainty";

/// Link file of flexlink.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
#[schemars(extend(
    "dependencies" = json!({ "start_angle": ["gravity"] }),
    "not" = json!({ "required": ["hub", "carriage"] })
))]
pub(super) struct RawSpecification {
    /// Title, for people.
    pub(super) title: Option<String>,
    /// Theory of segments without this key: euler-bernoulli, the default, for slender ones, timoshenko with shear and
    /// rotary inertia.
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
    /// Hub, which the motor turns.
    pub(super) hub: Option<RawHub>,
    /// Carriage, which the motor pushes across the link, in place of a hub; of an arm, below its first joint.
    pub(super) carriage: Option<RawCarriage>,
    /// Place on the link whose motion is given.
    #[serde(default)]
    pub(super) output: RawOutput,
    /// Masses lumped on the link, any number.
    #[serde(deserialize_with = "tables")]
    pub(super) masses: Vec<RawMass>,
    /// Payload at the tip.
    pub(super) payload: RawPayload,
    /// Damping of the link; without this table the link is undamped.
    pub(super) damping: Option<RawDamping>,
    /// Motor, gear and joint that drive the hub; adds the tables of motor and held modes.
    pub(super) drive: Option<RawDrive>,
    /// Limits of link and motor; exceeding one is a warning, with --strict an error.
    pub(super) limits: RawLimits,
    /// Intervals of values, for robust: "segments.*.EI*" = "±5%", "payload.mass" = "±20 g", "damping.ratio" = "0.005..0.02".
    #[serde(rename = "uncertainty")]
    pub(super) _uncertainty: BTreeMap<String, String>,
    /// Finite elements.
    pub(super) mesh: RawMesh,
    /// Accuracy, time window and modes of the answer.
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
    /// Poisson's ratio ν, with section; without G it is E/(2(1 + ν)).
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
    /// Stiffness of a rotational spring between hub and link; inf, the default, clamps the root.
    #[schemars(transform = above_zero)]
    pub(super) root_stiffness: Option<Unbounded>,
}

/// `[output]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawOutput {
    /// Place whose motion is given, from the axis or the carriage; a node is placed there. The default is the tip.
    #[schemars(transform = above_zero)]
    pub(super) at: Option<Length>,
}

/// `[carriage]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawCarriage {
    /// Mass without the link.
    #[schemars(transform = at_least_zero, extend("default" = 0))]
    pub(super) mass: Mass,
    /// Viscous friction of the guide.
    #[schemars(transform = at_least_zero, extend("default" = 0))]
    pub(super) viscous_friction: SlidingFriction,
    /// Direction along x and y of the rail of an arm's carriage, [1, 0] by default; its length does not matter.
    #[schemars(with = "Option<[f64; 2]>")]
    pub(super) axis: Option<Axis>,
    /// Stiffness of a rotational spring between carriage and link; inf, the default, clamps the root.
    #[schemars(transform = above_zero)]
    pub(super) root_stiffness: Option<Unbounded>,
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
    /// Stiffness of the elastic joint, of a carriage's belt in N/m; inf, the default, is a stiff one.
    #[schemars(transform = above_zero)]
    pub(super) joint_stiffness: Option<Unbounded>,
    /// Rotary inertia of the rotor, on the motor side of the gear.
    #[schemars(transform = at_least_zero, extend("default" = 0))]
    pub(super) rotor_inertia: RotaryInertia,
    /// Turns of the motor for one turn of the hub, or of a carriage's pinion, 1e-6 to 1e6.
    #[schemars(range(min = 1e-6, max = 1e6), extend("default" = 1))]
    pub(super) gear_ratio: Option<f64>,
    /// Radius of the pinion, or of the belt's pulley, that moves a carriage; needed on a carriage, and only there.
    #[schemars(transform = above_zero)]
    pub(super) pinion_radius: Option<Length>,
    /// Efficiency of the gear, in both directions of the power, 1e-6 to 1.
    #[schemars(range(min = 1e-6, max = 1.0), extend("default" = 1))]
    pub(super) efficiency: Option<f64>,
    /// Coulomb friction of the joint, on a carriage in N.
    #[schemars(transform = at_least_zero, extend("default" = 0))]
    pub(super) coulomb_friction: Option<Friction>,
    /// Rate of the joint, on a carriage in m/s, over which friction and losses of the gear change their sign: they follow
    /// the hyperbolic tangent of the rate over this one; by default 1 % of the joint's peak rate.
    #[schemars(transform = above_zero)]
    pub(super) friction_rate: Option<JointRate>,
    /// Torque constant of the motor; adds its current.
    #[schemars(transform = above_zero)]
    pub(super) torque_constant: Option<TorqueConstant>,
    /// Resistance of the motor, beside its torque constant; adds its voltage.
    #[schemars(transform = above_zero)]
    pub(super) resistance: Option<Resistance>,
}

/// Limits of a carriage, with the key of a hub's limit in their place and their dimension.
pub(super) const OF_CARRIAGE: [(&str, &str, Dimension); 5] = [
    ("force", "torque", Dimension::FORCE),
    ("rms_force", "rms_torque", Dimension::FORCE),
    ("carriage_travel", "hub_angle", Dimension::LENGTH),
    ("carriage_speed", "hub_rate", Dimension::VELOCITY),
    ("carriage_acceleration", "hub_acceleration", Dimension::ACCELERATION),
];

/// Keys of `[limits]`, each with its dimension and its meaning: those of [`QUANTITIES`](crate::result::QUANTITIES), then those
/// of a carriage.
fn limit_keys() -> impl Iterator<Item = (&'static str, Dimension, String)> {
    let carriage = Joint::CARRIAGE;
    let what = move |of_hub| JointQuantity::of_limit(of_hub).map_or("", |own| own.what);
    let of_carriage = OF_CARRIAGE.into_iter();
    let of_carriage = of_carriage
        .map(move |(key, of_hub, dimension)| (key, dimension, carriage.worded(what(of_hub))));
    let of_joint = JointQuantity::with_limit();
    of_joint.map(|(key, of)| (key, of.unit.dimension, of.what.to_owned())).chain(of_carriage)
}

/// `[limits]`: keys with their values in SI.
#[derive(Debug, Default)]
pub(super) struct RawLimits(pub(super) Vec<(&'static str, f64)>);

impl<'de> Deserialize<'de> for RawLimits {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        static KEYS: LazyLock<Vec<&str>> =
            LazyLock::new(|| limit_keys().map(|(key, ..)| key).collect());
        struct Table;
        impl<'de> Visitor<'de> for Table {
            type Value = RawLimits;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a table")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<RawLimits, A::Error> {
                let mut limits = Vec::new();
                while let Some(written) = map.next_key::<String>()? {
                    let known = limit_keys().find(|(key, ..)| *key == written);
                    let (key, dimension, _) =
                        known.ok_or_else(|| A::Error::unknown_field(&written, &KEYS))?;
                    let quantity = Ends { dimension, takes_two: false };
                    limits.push((key, map.next_value_seed(quantity)?.inner));
                }
                Ok(RawLimits(limits))
            }
        }
        deserializer.deserialize_struct("RawLimits", &[], Table)
    }
}

impl JsonSchema for RawLimits {
    fn schema_name() -> Cow<'static, str> {
        "RawLimits".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let keys = limit_keys().map(|(key, dimension, what)| {
            let mut schema = quantity(dimension);
            above_zero(&mut schema);
            schema.insert("description".into(), what.into());
            (key.to_owned(), schema.into())
        });
        let keys: Map<String, Value> = keys.collect();
        json_schema!({ "type": "object", "additionalProperties": false, "properties": keys })
    }
}

/// `[mesh]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawMesh {
    /// Elements of the whole link, or of each link of an arm, or "auto", the default unless a segment has a number:
    /// refined until every written quantity is exact to tolerance.
    pub(super) elements: Option<Elements>,
    /// Largest error of a quantity by "auto", as a share of its peak, 1e-12 to 0.1.
    #[schemars(range(min = 1e-12, max = 0.1), extend("default" = 1e-6))]
    pub(super) tolerance: Option<f64>,
}

/// `[analysis]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RawAnalysis {
    /// Largest error of a quantity by padding and wrap-around, as a share of its peak, 1e-12 to 1e-2.
    #[schemars(range(min = 1e-12, max = 1e-2), extend("default" = 1e-6))]
    pub(super) tolerance: Option<f64>,
    /// Largest distance of the tip from the wanted motion, as a share of its travel, 1e-12 to 0.1: only frequencies
    /// that it needs are solved. 0: every frequency of the samples.
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
    /// Terms beyond small deflections: none, first (gravity and centripetal forces along the link) or full (all, also
    /// of large slopes); by default none without gravity, full with gravity.
    #[schemars(with = "Option<String>", extend("enum" = ["none", "first", "full"]))]
    pub(super) second_order: Option<SecondOrder>,
}

/// Adds the schema of a list of numbers from 0 to below 1, at least one.
fn shares(schema: &mut Schema) {
    schema.insert("minItems".into(), 1.into());
    let share = json!({ "type": "number", "minimum": 0, "exclusiveMaximum": 1 });
    schema.insert("items".into(), share);
}

/// A property along the segment: given as a whole, or as a material's constant times a property of the cross-section,
/// which is a key or follows from `section`.
pub(super) struct Property {
    pub(super) name: &'static str,
    pub(super) whole: &'static str,
    pub(super) material: &'static str,
    pub(super) shape: &'static str,
}

pub(super) const STIFFNESS: Property =
    Property { name: "bending stiffness", whole: "EI", material: "E", shape: "I" };

pub(super) const MASS: Property = Property {
    name: "mass per length",
    whole: "mass_per_length",
    material: "density",
    shape: "area",
};

pub(super) const PROPERTIES: [Property; 2] = [STIFFNESS, MASS];

/// Adds the schema of a segment: each property in one of its three ways; a section serves one of them.
pub(super) fn properties(schema: &mut Schema) {
    let ways = PROPERTIES.map(|Property { whole, material, shape, .. }| {
        json!({ "oneOf": [
            { "required": [whole], "not": one_of(&[material, shape]) },
            { "required": [material, shape], "not": one_of(&[whole, "section"]) },
            { "required": [material, "section"], "not": one_of(&[whole, shape]) },
        ] })
    });
    schema.insert("allOf".into(), json!(ways));
    let section_serves = one_of(&PROPERTIES.map(|property| property.material));
    let with_section = |others: Value| json!({ "allOf": [{ "required": ["section"] }, others] });
    let by_modulus = one_of(&["shear_modulus", "E"]);
    let dependencies = json!({
        "section": section_serves,
        "shear_stiffness": { "not": one_of(&["shear_modulus", "poisson_ratio"]) },
        "shear_modulus": with_section(json!({})),
        "poisson_ratio": with_section(by_modulus),
    });
    schema.insert("dependencies".into(), dependencies);
}

/// Schema of a table with one of the keys.
fn one_of(keys: &[&str]) -> Value {
    let required: Vec<Value> = keys.iter().map(|key| json!({ "required": [key] })).collect();
    json!({ "anyOf": required })
}

/// A theory of beams.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Theory {
    EulerBernoulli,
    Timoshenko,
}

/// A shape of cross-section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum Shape {
    Rectangle,
    Circle,
    Tube,
    Box,
}

impl Shape {
    const ALL: [Self; 4] = [Self::Rectangle, Self::Circle, Self::Tube, Self::Box];

    /// Name of the shape in the file.
    pub(super) fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }

    /// Keys of the shape's dimensions.
    pub(super) fn dimensions(self) -> &'static [&'static str] {
        match self {
            Self::Rectangle => &["width", "thickness"],
            Self::Circle => &["diameter"],
            Self::Tube => &["diameter", "wall"],
            Self::Box => &["width", "height", "wall"],
        }
    }
}

/// Adds the schema of a section: exactly the dimensions of its shape.
pub(super) fn dimensions(schema: &mut Schema) {
    let shapes = Shape::ALL.map(|shape| {
        let mut then = only(schema, "shape", shape.dimensions());
        then.insert("required".into(), json!(shape.dimensions()));
        json!({ "if": { "properties": { "shape": { "const": shape.name() } } }, "then": then })
    });
    schema.insert("allOf".into(), json!(shapes));
}

/// A damping law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum Model {
    Hysteretic,
    Modal,
    Rayleigh,
    Caughey,
    None,
}

impl Model {
    pub(super) const ALL: [Self; 5] =
        [Self::Hysteretic, Self::Modal, Self::Rayleigh, Self::Caughey, Self::None];

    /// Name of the law in the file.
    pub(super) fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }

    /// Keys of the law besides `model`.
    pub(super) fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Hysteretic => &["ratio"],
            Self::Modal => &["ratio", "ratios"],
            Self::Rayleigh => &["alpha", "beta", "modes", "ratios"],
            Self::Caughey => &["ratio", "ratios", "modes"],
            Self::None => &[],
        }
    }

    /// Combinations of its keys, in words.
    pub(super) fn takes(self) -> &'static str {
        match self {
            Self::Hysteretic => "ratio only",
            Self::Modal => "ratio or ratios",
            Self::Rayleigh => "alpha and beta, or modes and ratios",
            Self::Caughey => "ratio, or ratios with or without modes",
            Self::None => "nothing else",
        }
    }

    /// Schema of its combinations of keys.
    fn combinations(self) -> Value {
        let one_ratio_or_list = json!([{ "required": ["ratio"] }, { "required": ["ratios"] }]);
        match self {
            Self::Hysteretic => json!({ "required": ["ratio"] }),
            Self::Modal => json!({ "oneOf": one_ratio_or_list }),
            Self::Rayleigh => {
                let pair = json!({ "minItems": 2, "maxItems": 2 });
                json!({ "oneOf": [
                    one_of(&["alpha", "beta"]),
                    {
                        "required": ["modes", "ratios"],
                        "properties": { "modes": pair, "ratios": pair },
                    },
                ], "dependencies": { "modes": ["ratios"], "ratios": ["modes"] } })
            }
            Self::Caughey => {
                let series = json!({ "minItems": 1, "maxItems": 8 });
                json!({
                    "oneOf": one_ratio_or_list,
                    "dependencies": { "modes": ["ratios"] },
                    "properties": { "modes": series, "ratios": series },
                })
            }
            Self::None => json!({}),
        }
    }
}

/// Adds the schema of damping: only the keys of its model, in one of the model's combinations.
pub(super) fn combinations(schema: &mut Schema) {
    let laws = Model::ALL.map(|model| {
        let mut then = only(schema, "model", model.keys());
        if let Value::Object(combinations) = model.combinations() {
            then.extend(combinations);
        }
        let mut condition = json!({ "properties": { "model": { "const": model.name() } } });
        // A table without a model is hysteretic.
        if model != Model::Hysteretic {
            condition["required"] = json!(["model"]);
        }
        json!({ "if": condition, "then": then })
    });
    schema.insert("allOf".into(), json!(laws));
}

/// Schema that refuses all keys of a schema except `name` and `takes`.
fn only(schema: &Schema, name: &str, takes: &[&str]) -> Map<String, Value> {
    let known = schema.get("properties").and_then(Value::as_object);
    let others = known.into_iter().flat_map(Map::keys);
    let others = others.filter(|key| *key != name && !takes.contains(&key.as_str()));
    let refused: Map<String, Value> = others.map(|key| (key.clone(), json!(false))).collect();
    Map::from_iter([("properties".into(), refused.into())])
}
