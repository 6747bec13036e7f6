//! The link file as JSON Schema: derived from the raw form, so that an editor knows the keys that
//! the reader knows.
//!
//! TOML editors understand draft 7, and show a description only where it stands: so the schema has no
//! references.

use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::transform_subschemas;
use serde_json::{Map, Value};

use super::raw::RawSpecification;

/// JSON Schema (draft 7) of the link file, as text: what editors complete and check it with.
///
/// It has every key with its meaning, unit, range and default, and the keys that go together. It cannot
/// say the dimension of a unit or the sum of the elements; the reader checks these.
///
/// ```
/// let schema: serde_json::Value = serde_json::from_str(&flexlink::spec::link_file_schema())?;
/// assert!(schema["properties"]["hub"]["properties"]["inertia"].is_object());
/// # Ok::<(), serde_json::Error>(())
/// ```
pub fn link_file_schema() -> String {
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    let generator = settings.with_transform(tidied).into_generator();
    let mut schema = generator.into_root_schema_for::<RawSpecification>();
    schema.insert("title".into(), "flexlink link file".into());
    schema.insert("required".into(), Value::from(vec!["segments"]));
    format!("{:#}\n", Value::from(schema))
}

/// Removes the `null` of optional keys, which TOML does not have, and the line ends that wrap a
/// description.
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
        if let [Value::Object(only)] = &choices[..] {
            let only = only.clone();
            schema.remove("anyOf");
            adopt(schema, only);
        }
    }
    transform_subschemas(&mut tidied, schema);
}

/// Adds the keywords of the only choice, unless the key has its own.
fn adopt(schema: &mut Schema, only: Map<String, Value>) {
    for (keyword, value) in only {
        if schema.get(&keyword).is_none() {
            schema.insert(keyword, value);
        }
    }
}
