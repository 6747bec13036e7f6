//! Records as JSON: their text, their format, messages on damaged records and records of other versions; the
//! record of a fit, NAME.json beside the fitted link file NAME.toml.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::files::{is_stream, record_beside};
use crate::compare::{Cell, Table, TableColumn};
use crate::csv::{InputError, InputFile, Place, TableError};
use crate::fit::{FitOutcome, Replaced};
use crate::response::{LinkState, State};
use crate::result::{Notice, Origin, StoredInput};
use crate::text::{excerpt, is_hidden, visible};

/// Format of all records. It grows with each change that breaks readers of the previous format.
pub(super) const FORMAT: u32 = 2;

/// The key `command` of a state.
const A_STATE: &str = "state";

/// Keys that distinguish a record from other files.
#[derive(Debug, Deserialize)]
pub(super) struct Head {
    pub(super) format: Option<u32>,
    pub(super) flexlink: Option<String>,
    pub(super) command: Option<String>,
}

/// Refuses a record of another format than [`FORMAT`].
pub(super) fn check_format(
    found: Option<u32>,
    version: &str,
    place: Place,
) -> Result<(), TableError> {
    if found == Some(FORMAT) { Ok(()) } else { Err(other_format(found, version, place)) }
}

/// The error of a record of another format; early versions wrote no format.
pub(super) fn other_format(found: Option<u32>, version: &str, place: Place) -> TableError {
    let shown = found.map_or("is missing".to_owned(), |format| format!("= {format}"));
    let error = place.refuse_whole(&format!("format {shown}, but must be {FORMAT}"));
    if found.is_some_and(|format| format > FORMAT) {
        return newer(error, version);
    }
    let version = excerpt(version);
    error.with_hint(format!("flexlink {version} wrote it in an older format: run it again"))
}

/// Reads a record. An error names the line if `place` has none, and the required content, `must`, if the record is
/// not JSON.
pub(super) fn parsed<T: DeserializeOwned>(
    bytes: &[u8],
    place: Place,
    must: &str,
) -> Result<T, TableError> {
    if bytes.trim_ascii_start().starts_with(b"[") {
        // The parser accepts a list as the values of an object.
        return Err(place.refuse("content", "a list", "must be an object"));
    }
    serde_json::from_slice(bytes).map_err(|error| {
        let line = u64::try_from(error.line()).ok().filter(|line| *line > 0);
        let key = key_before(bytes, error.line(), error.column());
        let message = in_words(&error.to_string(), key, must);
        Place { line: place.line.or(line), ..place }.refuse_whole(&message)
    })
}

/// The record of a state.
#[derive(Serialize, Deserialize)]
struct StateRecord<S> {
    format: Option<u32>,
    flexlink: String,
    command: String,
    state: S,
}

/// The state of a link, or of an arm, at the end of a simulation, as JSON.
pub fn state_json(state: &State) -> String {
    match &state.links[..] {
        [link] => state_record(link),
        _ => state_record(state),
    }
}

fn state_record(state: &impl Serialize) -> String {
    let [flexlink, command] = [env!("CARGO_PKG_VERSION"), A_STATE].map(str::to_owned);
    json(&StateRecord { format: Some(FORMAT), flexlink, command, state })
}

/// Reads the text of [`state_json`] for a number of links.
///
/// # Errors
/// [`TableError`] names the file, the line and the fault.
pub fn read_state(name: &str, bytes: &[u8], links: usize) -> Result<State, TableError> {
    let whole = Place { file: name, line: None };
    let must = "must be what --save-state of `flexlink simulate` writes, in JSON";
    let head: Head = parsed(bytes, whole, must)?;
    if head.command.as_deref() != Some(A_STATE) {
        let shown =
            head.command.map_or("is missing".to_owned(), |command| format!("= {command:?}"));
        let hint = "--save-state of `flexlink simulate` writes a state".to_owned();
        let message = format!("command {shown}, but must be \"state\"");
        return Err(whole.refuse_whole(&message).with_hint(hint));
    }
    check_format(head.format, head.flexlink.as_deref().unwrap_or_default(), whole)?;
    if links > 1 {
        return Ok(parsed::<StateRecord<State>>(bytes, whole, &as_written())?.state);
    }
    let link = parsed::<StateRecord<LinkState>>(bytes, whole, &as_written())?.state;
    Ok(State { links: vec![link], carriage: None })
}

/// The last key before a line and column of a record, if there is one.
fn key_before(bytes: &[u8], line: usize, column: usize) -> Option<String> {
    let line = bytes.split(|byte| *byte == b'\n').nth(line.checked_sub(1)?)?;
    let text = String::from_utf8_lossy(&line[..column.min(line.len())]).into_owned();
    let (before, _) = text.rsplit_once("\":")?;
    before.rsplit_once('"').map(|(_, key)| key.to_owned())
}

/// An error of the parser with its subject, the actual and the required content.
fn in_words(text: &str, key: Option<String>, must: &str) -> String {
    let text = text.rsplit_once(" at line ").map_or(text, |(text, _)| text);
    if let Some(key) = text.strip_prefix("missing field `").and_then(|rest| rest.strip_suffix('`'))
    {
        return format!("{key} is missing");
    }
    let mismatch = text.strip_prefix("invalid type: ").or(text.strip_prefix("invalid value: "));
    match mismatch.and_then(|text| text.rsplit_once(", expected ")) {
        Some((found, expected)) => {
            let subject = key.unwrap_or_else(|| "content".to_owned());
            let found = excerpt(found);
            let must = plain_kind(expected);
            format!("{} = {}, but must be {must}", excerpt(&subject), visible(&found))
        }
        None => format!("content = {}, but {must}", visible(&excerpt(text))),
    }
}

/// A type of Rust in the user's words.
fn plain_kind(expected: &str) -> &str {
    match expected {
        "u32" | "u64" | "usize" => "a whole number",
        "f64" => "a number",
        "a sequence" => "a list",
        "a string" | "a borrowed string" => "a text",
        "a boolean" => "true or false",
        _ if expected.starts_with("struct ") || expected == "a map" => "an object",
        _ if expected.starts_with("an array") => "a list of that length",
        _ => expected,
    }
}

/// The requirement on a damaged record.
pub(super) fn as_written() -> String {
    format!("must be as flexlink {} writes it", env!("CARGO_PKG_VERSION"))
}

/// Adds a hint to an error if a later version than this one wrote the file.
pub(super) fn newer(error: TableError, version: &str) -> TableError {
    let own = env!("CARGO_PKG_VERSION");
    if numbers(version) <= numbers(own) {
        return error;
    }
    error.or_hint(format!(
        "flexlink {} wrote it, and this is {own}: take that version",
        excerpt(version)
    ))
}

/// The numbers of a version: `[1, 2, 3]` of `1.2.3-beta`.
fn numbers(version: &str) -> Vec<u64> {
    let plain = version.split(['-', '+']).next().unwrap_or_default();
    plain.split('.').map(|number| number.parse().unwrap_or(0)).collect()
}

/// The JSON text of a record, indented, with a final line end.
///
/// # Panics
/// Never: JSON can hold every record.
pub(super) fn json(record: &impl Serialize) -> String {
    let mut text = serde_json::to_string_pretty(record).expect("plain records are JSON");
    text.push('\n');
    without_controls(text)
}

/// The record of a study as JSON: the command with its inputs, its numbers and its warnings.
///
/// # Panics
/// Never: JSON can hold every record.
pub fn record_json(
    command: &str,
    (title, inputs): (&str, &impl Serialize),
    summary: &impl Serialize,
    warnings: &[Notice],
) -> String {
    #[derive(Serialize)]
    struct Record<'a, I, S> {
        format: u32,
        flexlink: &'static str,
        command: &'a str,
        title: &'a str,
        inputs: &'a I,
        #[serde(flatten)]
        summary: &'a S,
        warnings: &'a [Notice],
    }
    let (format, flexlink) = (FORMAT, env!("CARGO_PKG_VERSION"));
    json(&Record { format, flexlink, command, title, inputs, summary, warnings })
}

/// The JSON text of a record on one line, without a line end.
///
/// # Panics
/// Never, as [`json`].
pub(super) fn json_line(record: &impl Serialize) -> String {
    without_controls(serde_json::to_string(record).expect("plain records are JSON"))
}

/// Escapes U+007F to U+009F and marks of the direction of writing: JSON allows them, but terminals obey them. They
/// occur only in strings.
fn without_controls(text: String) -> String {
    let is_bare = |letter: char| is_hidden(letter) && letter != '\n';
    if !text.contains(is_bare) {
        return text;
    }
    let escaped = |letter: char| match letter {
        letter if is_bare(letter) => format!("\\u{:04x}", u32::from(letter)),
        letter => letter.to_string(),
    };
    text.chars().map(escaped).collect()
}

/// The values of a run's summary.json for a comparison, as a table of one row: its command, its results,
/// `results.peak_torque_n_m` and so on, and the kinds of its warnings. `None` without results.
pub fn results_table(summary: &[u8]) -> Option<Table> {
    let record: Value = serde_json::from_slice(summary).ok()?;
    record.get("flexlink")?;
    let mut columns = Vec::new();
    // The first column is not a number, so that rows match by their order.
    add_columns(&mut columns, "command", record.get("command")?);
    add_columns(&mut columns, "results", record.get("results")?);
    let warnings = record.get("warnings").and_then(Value::as_array);
    let kinds = warnings.into_iter().flatten().filter_map(|warning| warning.get("kind")?.as_str());
    for kind in kinds.collect::<BTreeSet<_>>() {
        add_columns(&mut columns, &format!("warnings.{kind}"), &Value::from("told"));
    }
    let before = summary.windows(9).position(|text| text == b"\"results\"")?;
    let line = summary[..before].split(|byte| *byte == b'\n').count() as u64;
    Some(Table { columns, lines: vec![line] })
}

/// Names the inputs of two runs that differ: `link: arm.toml with other content`.
pub fn different_inputs(expected: &[u8], actual: &[u8]) -> Vec<String> {
    let [expected, actual] = [expected, actual].map(inputs_of);
    let names: BTreeSet<&String> = expected.keys().chain(actual.keys()).collect();
    let differ = names.into_iter().filter(|name| expected.get(*name) != actual.get(*name));
    let told = |name: &String| match [&expected, &actual].map(|inputs| inputs.get(name)) {
        [Some(Value::Array(own)), Some(Value::Array(other))] => {
            // The common beginning of long lists would hide the rest.
            let same = own.iter().zip(other).take_while(|(own, other)| own == other).count();
            let [own, other] = [&own[same..], &other[same..]].map(arguments_in_words);
            format!("{name}: {own} in EXPECTED, {other} in ACTUAL")
        }
        sides => match sides.map(input_in_words) {
            [own, other] if own == other => format!("{name}: {own} with other content"),
            [own, other] => format!("{name}: {own} in EXPECTED, {other} in ACTUAL"),
        },
    };
    differ.map(told).collect()
}

/// The inputs in a summary.json by their names there, and the version that wrote it.
fn inputs_of(summary: &[u8]) -> Map<String, Value> {
    let mut record: Map<String, Value> = serde_json::from_slice(summary).unwrap_or_default();
    let mut inputs = match record.remove("inputs") {
        Some(Value::Object(inputs)) => inputs,
        _ => Map::new(),
    };
    inputs.extend(record.remove_entry("flexlink"));
    let is_given =
        |input: &Value| !input.is_null() && input.as_array().is_none_or(|a| !a.is_empty());
    inputs.retain(|_, input| is_given(input));
    inputs
}

/// The name of a file, or arguments as the user typed them.
fn input_in_words(input: Option<&Value>) -> String {
    match input {
        None => "none".to_owned(),
        Some(Value::Array(arguments)) => arguments_in_words(arguments),
        Some(input) => {
            let name = input.get("name").unwrap_or(input).as_str().unwrap_or_default();
            visible(&excerpt(name)).into_owned()
        }
    }
}

fn arguments_in_words(arguments: &[Value]) -> String {
    let words: Vec<&str> = arguments.iter().filter_map(Value::as_str).collect();
    let text = words.join(" ");
    if text.is_empty() { "none".to_owned() } else { visible(&excerpt(&text)).into_owned() }
}

/// A column for each value within a value.
fn add_columns(columns: &mut Vec<TableColumn>, name: &str, value: &Value) {
    match value {
        Value::Object(parts) => {
            parts
                .iter()
                .for_each(|(key, part)| add_columns(columns, &format!("{name}.{key}"), part));
        }
        Value::Array(parts) => {
            let numbered = (0..).zip(parts);
            numbered.for_each(|(k, part)| add_columns(columns, &format!("{name}.{k}"), part));
        }
        own => {
            let mut column = TableColumn::new(name.to_owned());
            match (own.as_f64(), own.as_str()) {
                (Some(number), _) => column.push(Cell::Number(number)),
                (_, Some(word)) => column.push(Cell::Word(word)),
                _ => column.push(Cell::Word(&own.to_string())),
            }
            columns.push(column);
        }
    }
}

/// An input file of a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fingerprint {
    /// Its name without folders.
    pub name: String,
    /// Its SHA-256 in hexadecimal digits.
    pub sha256: String,
}

impl Fingerprint {
    /// Name and SHA-256 of a file.
    pub fn of(file: &InputFile) -> Self {
        Self { name: file.name.clone(), sha256: file.sha256() }
    }

    /// The file with its role in the run: `link`, `motion`.
    pub(super) fn input(&self, role: &str) -> StoredInput {
        let Self { name, sha256 } = self.clone();
        StoredInput { role: role.to_owned(), name, sha256 }
    }
}

/// Error of an unreadable file, as the error of a refused one.
pub(super) fn unreadable(error: &InputError) -> TableError {
    let text = error.to_string();
    let (file, message) = text.split_once(": ").unwrap_or(("", &text));
    Place { file, line: None }.refuse_whole(message).with_hint(error.hint().map(str::to_owned))
}

const COMMAND: &str = "fit";

/// Path of the record of a fitted link file; `None` for a device or a pipe.
pub fn fit_record(link_file: &Path) -> Option<PathBuf> {
    (!is_stream(link_file)).then(|| record_beside(link_file, "toml"))
}

/// The file in the place of the record of a fitted link file, if no fit has written it.
pub fn foreign_fit_record(link_file: &Path) -> Option<PathBuf> {
    let path = fit_record(link_file)?;
    path.symlink_metadata().ok()?;
    let file = if path.is_file() { InputFile::read(&path).ok() } else { None };
    let is_record = |file: InputFile| {
        let head: Result<Head, _> = serde_json::from_slice(&file.bytes);
        head.is_ok_and(|head| head.flexlink.is_some() && head.command.as_deref() == Some(COMMAND))
    };
    (!file.is_some_and(is_record)).then_some(path)
}

/// Inputs of a fit: its files, and its arguments as the program takes them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FitInputs {
    /// The link file.
    pub link: Fingerprint,
    /// The file of measured values.
    pub measured: Fingerprint,
    /// The responses and records that it names.
    pub named: Vec<Fingerprint>,
    /// `--set`, `payload.mass=0`, `--free`, `hub.inertia`, in order.
    pub arguments: Vec<String>,
}

impl FitInputs {
    /// Origin of the fit for a page; `title` is the link's.
    pub fn origin(&self, title: &str) -> Origin {
        let named = self.named.iter().map(|file| file.input("measured"));
        let files = [self.link.input("link"), self.measured.input("measured")];
        Origin {
            command: COMMAND.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            title: title.to_owned(),
            inputs: files.into_iter().chain(named).collect(),
            arguments: self.arguments.clone(),
        }
    }
}

/// The record of a fit.
#[derive(Serialize)]
struct FitRecord<'a> {
    format: u32,
    flexlink: &'static str,
    command: &'static str,
    inputs: &'a FitInputs,
    /// Values of the link file before and after.
    replaced: &'a [Replaced],
    #[serde(flatten)]
    outcome: &'a FitOutcome,
    warnings: Vec<Notice>,
}

/// The record of a fit as JSON: the values with their standard errors, the residuals, the correlations, the values
/// that the data do not determine, and the end of each start.
pub fn fit_json(inputs: &FitInputs, replaced: &[Replaced], outcome: &FitOutcome) -> String {
    let (flexlink, command) = (env!("CARGO_PKG_VERSION"), COMMAND);
    let warnings = outcome.warnings();
    json(&FitRecord { format: FORMAT, flexlink, command, inputs, replaced, outcome, warnings })
}
