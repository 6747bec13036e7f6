//! The JSON Schema of link files and arm files, from the types of their keys.

use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::transform_subschemas;
use serde_json::{Map, Value, json};

use super::document::{OF_ARM, SHARED};
use super::raw::RawSpecification;
use super::value::{IN_UNIT, describe};
use crate::link::MOST_LINKS;

/// JSON Schema (draft 7) of link files and arm files, as text, for completion and checks in editors.
///
/// It contains every key with its meaning, unit, range and default, and the combinations of keys. It cannot express the
/// dimension of a unit or the sum of the elements; the reader checks these. It has no references, because editors show
/// no description through one.
///
/// ```
/// let schema: serde_json::Value = serde_json::from_str(&flexlink::spec::link_file_schema())?;
/// assert!(schema["properties"]["hub"]["properties"]["inertia"].is_object());
/// assert!(schema["properties"]["links"]["items"]["properties"]["hub"].is_object());
/// # Ok::<(), serde_json::Error>(())
/// ```
pub fn link_file_schema() -> String {
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    let generator = settings.with_transform(tidied).into_generator();
    let mut schema = generator.into_root_schema_for::<RawSpecification>();
    schema.insert("title".into(), "flexlink link file or arm file".into());
    with_arms(&mut schema);
    let mut schema = Value::from(schema);
    schema.sort_all_objects();
    format!("{schema:#}\n")
}

/// SI unit of a key of a link file or arm file, by its path: `N m^2` for `segments.beam.EI`; `None` for a key without a
/// unit and for an unknown key.
///
/// ```
/// use flexlink::spec::unit_of_key;
/// assert_eq!(unit_of_key("links.fore.payload.mass").as_deref(), Some("kg"));
/// assert_eq!(unit_of_key("damping.ratio"), None);
/// ```
pub fn unit_of_key(path: &str) -> Option<String> {
    let schema: Value = serde_json::from_str(&link_file_schema()).ok()?;
    let mut parts = path.split('.');
    let mut at = &schema;
    while let Some(part) = parts.next() {
        at = at["properties"].get(part)?;
        // The number or name of a list item has no key.
        if at["items"]["properties"].is_object() {
            (at, _) = (&at["items"], parts.next()?);
        }
    }
    let (_, unit) = at["description"].as_str()?.split_once(IN_UNIT)?;
    Some(unit.split_once(',')?.0.to_owned())
}

/// Adds the keys of an arm; its links have the keys of a link file except those that the arm has once.
fn with_arms(schema: &mut Schema) {
    let Some(Value::Object(keys)) = schema.get_mut("properties") else { return };
    let is_of_arm = |key: &String| SHARED.iter().chain(&OF_ARM).any(|own| own == key);
    let mut of_link: Map<String, Value> =
        keys.clone().into_iter().filter(|(key, _)| !is_of_arm(key)).collect();
    let refused = |keys: &mut dyn Iterator<Item = &String>| -> Value {
        keys.map(|key| (key.clone(), json!(false))).collect::<Map<_, _>>().into()
    };
    // The carriage of an arm, with its limits, stands above the links.
    let mut above_links = refused(&mut of_link.keys().filter(|key| *key != "limits"));
    above_links["carriage"] = json!({ "properties": { "root_stiffness": false } });
    if let Some(carriage) = of_link["carriage"]["properties"].as_object_mut() {
        carriage.remove("axis");
    }
    let described = |mut schema: Value, text: &str| {
        schema["description"] = text.into();
        schema
    };
    let joint = "Body of the next joint, which the link's tip carries; on all links but the last, which has a payload.";
    of_link.insert("tip".into(), described(of_link["payload"].clone(), joint));
    let name = "Unique name, which addresses the link in --set.";
    of_link.insert("name".into(), described(json!({ "type": "string" }), name));
    let link = json!({
        "type": "object",
        "additionalProperties": false,
        "properties": of_link,
        "required": ["segments"],
    });
    let links = json!({ "type": "array", "items": link, "minItems": 1, "maxItems": MOST_LINKS });
    let text = "Links of an arm, the inner one first, each with the keys of a link file.";
    keys.insert("links".into(), described(links, text));
    let side = "Side of the first link on which the second one lies; a path of the tip needs it.";
    keys.insert("elbow".into(), described(json!({ "enum": ["left", "right"] }), side));
    schema.insert("if".into(), json!({ "required": ["links"] }));
    schema.insert("then".into(), json!({ "properties": above_links, "allOf": by_count() }));
    let carriage = json!({ "properties": { "axis": false } });
    let of_one = json!({
        "required": ["segments"],
        "properties": { "elbow": false, "carriage": carriage },
    });
    schema.insert("else".into(), of_one);
}

/// Refusals for an arm of each number of links: a payload except on the last link, a tip there, and keys that the arm
/// has once.
fn by_count() -> Vec<Value> {
    let of = |count: usize| {
        let mut links = vec![json!({ "properties": { "payload": false } }); count - 1];
        links.push(json!({ "properties": { "tip": false } }));
        let keys = if count == 1 { &["elbow", "carriage", "limits"][..] } else { &["start_angle"] };
        let counted = json!({ "links": { "minItems": count, "maxItems": count } });
        let mut then = json!({ "links": { "items": links } });
        for key in keys {
            then[*key] = false.into();
        }
        json!({ "if": { "properties": counted }, "then": { "properties": then } })
    };
    (1..=MOST_LINKS).map(of).collect()
}

/// Removes the `null` of optional keys, which TOML does not have, and the line breaks of descriptions.
fn tidied(schema: &mut Schema) {
    if let Some(Value::String(text)) = schema.get_mut("description") {
        let paragraphs: Vec<String> = text.split("\n\n").map(|p| p.replace('\n', " ")).collect();
        *text = paragraphs.join("\n\n");
    }
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|kind| kind != "null");
        if let [only] = &types[..] {
            let only = only.clone();
            schema.insert("type".into(), only);
        }
    }
    if let Some(Value::Array(choices)) = schema.get_mut("enum") {
        choices.retain(|choice| !choice.is_null());
    }
    if let Some(Value::Array(choices)) = schema.get_mut("anyOf") {
        choices.retain(|choice| choice.get("type").is_none_or(|kind| kind != "null"));
        if let [Value::Object(only)] = &mut choices[..] {
            let only = std::mem::take(only);
            schema.remove("anyOf");
            // Keywords of the key precede those of its type.
            for (keyword, value) in only {
                schema.ensure_object().entry(keyword).or_insert(value);
            }
        }
    }
    // Numbers without a default in the file have one in serde.
    if schema.get("default").is_some_and(Value::is_null) {
        schema.remove("default");
    }
    schema.remove("format");
    describe(schema);
    transform_subschemas(&mut tidied, schema);
}
