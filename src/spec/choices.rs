//! Keys of the link file that go together: damping models, shapes of cross-sections, stiffness and
//! mass; and the JSON Schema of these alternatives.

use schemars::Schema;
use serde_json::{Map, Value, json};

/// A damping model as the file names it.
pub(super) struct Model {
    pub(super) name: &'static str,
    /// Its keys besides `model`.
    pub(super) keys: &'static [&'static str],
    /// Which of these belong together, in words.
    pub(super) takes: &'static str,
}

pub(super) const MODELS: [Model; 5] = [
    Model { name: "hysteretic", keys: &["ratio"], takes: "ratio only" },
    Model { name: "modal", keys: &["ratio", "ratios"], takes: "ratio or ratios" },
    Model {
        name: "rayleigh",
        keys: &["alpha", "beta", "modes", "ratios"],
        takes: "alpha and beta, or modes and ratios",
    },
    Model {
        name: "caughey",
        keys: &["ratio", "ratios", "modes"],
        takes: "ratio, or ratios with or without modes",
    },
    Model { name: "none", keys: &[], takes: "nothing else" },
];

/// Shapes of cross-sections.
pub(super) const SHAPES: [&str; 4] = ["rectangle", "circle", "tube", "box"];

/// The keys that a shape takes.
pub(super) fn dimensions_of(shape: &str) -> Option<&'static [&'static str]> {
    Some(match shape {
        "rectangle" => &["width", "thickness"],
        "circle" => &["diameter"],
        "tube" => &["diameter", "wall"],
        "box" => &["width", "height", "wall"],
        _ => return None,
    })
}

/// A list that is not empty.
pub(super) fn at_least_one(schema: &mut Schema) {
    schema.insert("minItems".into(), json!(1));
}

/// A shape of cross-section.
pub(super) fn a_shape(schema: &mut Schema) {
    schema.insert("enum".into(), json!(SHAPES));
}

/// A model of damping.
pub(super) fn a_model(schema: &mut Schema) {
    schema.insert("enum".into(), json!(MODELS.map(|model| model.name)));
    schema.insert("default".into(), json!("hysteretic"));
}

/// A segment gives its stiffness in one of three ways, and its mass.
pub(super) fn stiffness_and_mass(schema: &mut Schema) {
    let way = |whole: &str, material: &str, shape: &str| {
        let with_section =
            json!({ "required": [material, "section"], "not": one_of(&[whole, shape]) });
        json!({ "oneOf": [
            { "required": [whole], "not": one_of(&[material, shape]) },
            { "required": [material, shape], "not": one_of(&[whole, "section"]) },
            with_section,
        ] })
    };
    let section_serves = json!({ "section": { "anyOf": [
        { "required": ["E"] }, { "required": ["density"] },
    ] } });
    schema.insert(
        "allOf".into(),
        json!([way("EI", "E", "I"), way("mass_per_length", "density", "area"),]),
    );
    schema.insert("dependencies".into(), section_serves);
}

/// Matches what has one of the keys.
fn one_of(keys: &[&str]) -> Value {
    let required: Vec<Value> = keys.iter().map(|key| json!({ "required": [key] })).collect();
    json!({ "anyOf": required })
}

/// A section has just the dimensions of its shape.
pub(super) fn section_shapes(schema: &mut Schema) {
    let shapes = SHAPES.iter().map(|shape| {
        let takes = dimensions_of(shape).unwrap_or_default();
        let mut then = only(schema, "shape", takes);
        then.insert("required".into(), json!(takes));
        json!({ "if": { "properties": { "shape": { "const": shape } } }, "then": then })
    });
    let shapes: Vec<Value> = shapes.collect();
    schema.insert("allOf".into(), shapes.into());
}

/// Damping has just the keys of its model, in one of the combinations that the model takes.
pub(super) fn damping_laws(schema: &mut Schema) {
    let laws = MODELS.iter().map(|model| {
        let mut then = only(schema, "model", model.keys);
        if let Value::Object(ways) = ways(model.name) {
            then.extend(ways);
        }
        let named = json!({ "model": { "const": model.name } });
        if model.name == "hysteretic" {
            // The model of a table that names none.
            json!({ "if": { "properties": named }, "then": then })
        } else {
            json!({ "if": { "properties": named, "required": ["model"] }, "then": then })
        }
    });
    let laws: Vec<Value> = laws.collect();
    schema.insert("allOf".into(), laws.into());
}

/// The combinations of keys that a damping model takes.
fn ways(model: &str) -> Value {
    match model {
        "hysteretic" => json!({ "required": ["ratio"] }),
        "modal" => json!({ "oneOf": [{ "required": ["ratio"] }, { "required": ["ratios"] }] }),
        "rayleigh" => json!({ "oneOf": [
            one_of(&["alpha", "beta"]),
            {
                "required": ["modes", "ratios"],
                "properties": { "modes": pair(), "ratios": pair() },
            },
        ], "dependencies": { "modes": ["ratios"], "ratios": ["modes"] } }),
        "caughey" => json!({
            "oneOf": [{ "required": ["ratio"] }, { "required": ["ratios"] }],
            "dependencies": { "modes": ["ratios"] },
            "properties": { "modes": series(), "ratios": series() },
        }),
        _ => json!({}),
    }
}

fn pair() -> Value {
    json!({ "minItems": 2, "maxItems": 2 })
}

fn series() -> Value {
    json!({ "minItems": 1, "maxItems": 8 })
}

/// Refuses all keys of a schema but `name` and those that are taken.
fn only(schema: &Schema, name: &str, takes: &[&str]) -> Map<String, Value> {
    let known = schema.get("properties").and_then(Value::as_object);
    let others = known.into_iter().flat_map(Map::keys);
    let others = others.filter(|key| *key != name && !takes.contains(&key.as_str()));
    let refused: Map<String, Value> = others.map(|key| (key.clone(), json!(false))).collect();
    Map::from_iter([("properties".into(), refused.into())])
}
