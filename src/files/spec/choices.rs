//! Keys of the link file that exclude, replace or need each other: stiffness and mass, shapes of cross-sections,
//! damping laws; and their JSON Schema.

use schemars::{JsonSchema, Schema};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::elastica::SecondOrder;

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
#[serde(rename_all = "kebab-case", expecting = "a string")]
pub(super) enum Theory {
    EulerBernoulli,
    Timoshenko,
}

/// What is counted of the second order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase", expecting = "a string")]
pub(super) enum Order {
    None,
    First,
    Full,
}

impl From<Order> for SecondOrder {
    fn from(order: Order) -> Self {
        match order {
            Order::None => Self::None,
            Order::First => Self::First,
            Order::Full => Self::Full,
        }
    }
}

/// A shape of cross-section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase", expecting = "a string")]
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
#[serde(rename_all = "lowercase", expecting = "a string")]
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
