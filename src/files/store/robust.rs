//! The folder of `robust`, written and read: summary.json, robust.csv and envelope.csv; and the fit that gives its intervals.

use std::io::{self, Write};

use serde::{Deserialize, Serialize};

use super::folder::{FolderError, OutputFolder};
use super::json::{Fingerprint, Head, as_written, check_format, newer, parsed, record_json};
use super::names::{REPORT, SUMMARY};
use super::read_tables::{ONE_RUN, RunFolder, TIME, Table as RunTable};
use super::summary::LinkRecord;
use crate::compare::{Cell, Table};
use crate::csv::{Digits, InputFile, Place, TableError, quoted, read_table, write_columns};
use crate::link::Arm;
use crate::numeric::student_95;
use crate::result::{Notice, Origin};
use crate::robust::{Fitted, How, Key, Plant, PlantKind, RobustSummary, Robustness, StoredRobust};
use crate::spec::unit_of_key;

/// The value of `command` in the record.
pub(super) const COMMAND: &str = "robust";

/// Names of all files that `robust` may write.
const OWNED: [&str; 4] = [PLANTS, ENVELOPE, REPORT, SUMMARY];
const PLANTS: &str = "robust.csv";
const ENVELOPE: &str = "envelope.csv";

/// Columns of robust.csv.
const KIND: &str = "kind";
const SETTLING: &str = "settling_s";

/// Columns of envelope.csv after the time.
const LOWEST: &str = "lowest_error_m";
const HIGHEST: &str = "highest_error_m";

/// Inputs of a study: its files, and its arguments as the program takes them.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct RobustInputs {
    /// The link file; absent for a program without files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<Fingerprint>,
    /// The motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<Fingerprint>,
    /// The record of the fit that gives intervals.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fit: Option<Fingerprint>,
    /// Its arguments.
    pub arguments: Vec<String>,
}

impl RobustInputs {
    /// Origin of the study for a page.
    fn origin(self, version: String, title: String) -> Origin {
        let Self { link, motion, fit, arguments } = self;
        let files = [("link", link), ("motion", motion), ("fit", fit)];
        let inputs = files.into_iter().filter_map(|(role, file)| Some(file?.input(role))).collect();
        Origin { command: COMMAND.to_owned(), version, title, inputs, arguments }
    }
}

/// Links and numbers of a record.
#[derive(Serialize, Deserialize)]
struct Numbers<S> {
    /// The link of the file, or the links of its arm.
    links: Vec<LinkRecord>,
    #[serde(flatten)]
    summary: S,
}

/// The whole record.
#[derive(Deserialize)]
struct Record {
    flexlink: String,
    title: String,
    inputs: RobustInputs,
    #[serde(flatten)]
    numbers: Numbers<RobustSummary>,
    warnings: Vec<Notice>,
}

/// The record of a study as JSON.
pub fn robust_json(
    arm: &Arm,
    inputs: &RobustInputs,
    summary: &RobustSummary,
    warnings: &[Notice],
) -> String {
    let links = arm.links().iter().map(|own| LinkRecord::of_parts(&own.link)).collect();
    record_json(COMMAND, (arm.title(), inputs), &Numbers { links, summary }, warnings)
}

/// The files of a study, in memory.
#[derive(Debug)]
pub struct RobustFiles {
    record: InputFile,
    plants: InputFile,
    envelope: InputFile,
}

impl RobustFiles {
    /// The files of a study with this record. `times_s` has the times of the envelope.
    ///
    /// # Panics
    /// Never: memory takes every byte.
    pub fn of(
        (record, summary): (&str, &RobustSummary),
        (outcome, times_s): (&Robustness, &[f64]),
        digits: Digits,
    ) -> Self {
        let [mut plants, mut envelope] = [Vec::new(), Vec::new()];
        let written = write_plants(&mut plants, &outcome.plants, summary, digits);
        let [low, high] = &outcome.envelope_m;
        let columns = [(TIME, times_s), (LOWEST, low), (HIGHEST, high)];
        let written = written.and_then(|()| write_columns(&mut envelope, None, &columns, digits));
        written.expect("memory takes every byte");
        let file = |name: &str, bytes: Vec<u8>| {
            let [shown, name] = [name, name].map(str::to_owned);
            InputFile { shown, name, bytes }
        };
        Self {
            record: file(SUMMARY, record.as_bytes().to_vec()),
            plants: file(PLANTS, plants),
            envelope: file(ENVELOPE, envelope),
        }
    }

    /// Reads the files of a folder.
    pub(super) fn read(folder: RunFolder) -> Result<Self, TableError> {
        let [record, plants, envelope] = [SUMMARY, PLANTS, ENVELOPE].map(|name| folder.file(name));
        Ok(Self { record: record?, plants: plants?, envelope: envelope? })
    }

    /// Writes them and the page, if there is one: all or none.
    ///
    /// # Errors
    /// [`FolderError`] names the file that cannot be written.
    pub fn write(&self, folder: OutputFolder, page: Option<&str>) -> Result<(), FolderError> {
        let page = page.map(|page| (REPORT, page.as_bytes()));
        let own = [&self.record, &self.plants, &self.envelope];
        for (name, bytes) in own.map(|own| (&*own.name, &*own.bytes)).into_iter().chain(page) {
            folder.file(name, |out| out.write_all(bytes))?;
        }
        folder.commit(SUMMARY, &OWNED)
    }

    /// The study as these files have it.
    ///
    /// # Errors
    /// [`TableError`] names the file and its damaged or foreign part.
    pub fn stored(&self) -> Result<StoredRobust, TableError> {
        let place = Place { file: &self.record.shown, line: None };
        let Head { format, flexlink, .. } = parsed(&self.record.bytes, place, &as_written())?;
        let version = flexlink.unwrap_or_default();
        check_format(format, &version, place)?;
        let read = || {
            let record: Record = parsed(&self.record.bytes, place, &as_written())?;
            let Numbers { links, mut summary } = record.numbers;
            let link = |own: LinkRecord| own.link(&record.title, None);
            let links = links.into_iter().map(link).collect::<Result<_, _>>();
            let links = links.map_err(|error| place.refuse_whole(&format!("links: {error}")))?;
            let plants = read_plants(&self.plants, &summary)?;
            // The record leaves out the unit of values in SI, a page shows it.
            for own in &mut summary.keys {
                if let How::Value(unit) = &mut own.key.how
                    && unit.is_empty()
                {
                    *unit = unit_of_key(&own.key.path).unwrap_or_default();
                }
            }
            let mut envelope = RunTable::of(&self.envelope, &[LOWEST, HIGHEST].map(str::to_owned))?;
            envelope.check_even()?;
            let [times_s, low, high] = [TIME, LOWEST, HIGHEST].map(|name| envelope.take(name));
            let origin = record.inputs.origin(record.flexlink, record.title);
            let (warnings, envelope_m) = (record.warnings, [low, high]);
            let name = String::new();
            Ok(StoredRobust { name, origin, links, summary, warnings, plants, times_s, envelope_m })
        };
        read().map_err(|error| newer(error, &version))
    }
}

/// Reads robust.csv of a study with these numbers.
fn read_plants(file: &InputFile, summary: &RobustSummary) -> Result<Table, TableError> {
    let place = Place { file: &file.shown, line: None };
    let table = read_table(&file.shown, &file.bytes)?;
    let expected = std::iter::once(KIND.to_owned()).chain(summary.keys().map(Key::heading));
    let expected: Vec<String> = expected.chain(NUMBERS.map(|(name, _)| name.to_owned())).collect();
    let found: Vec<&str> = table.names().collect();
    if found != expected {
        let must = format!("must be {}", quoted(&expected.join(",")));
        return Err(place.refuse("columns", quoted(&found.join(",")), must));
    }
    let rows = table.lines.len();
    if rows != summary.plants {
        let must = format!("must be {}, the plants of {SUMMARY}: {ONE_RUN}", summary.plants);
        return Err(place.refuse("rows", rows.to_string(), must));
    }
    if rows == 0 || table.columns[0].cell(0) != Cell::Word(PlantKind::Nominal.word()) {
        return Err(place.refuse_whole("the first row must be the nominal plant"));
    }
    let is_kind = |word: &str| PlantKind::ALL.iter().any(|kind| kind.word() == word);
    for (number, column) in table.columns.iter().enumerate() {
        let name = column.name();
        // A value that the file leaves open, and the time of a tip that does not settle.
        let is_optional = number <= summary.keys.len() || name == SETTLING;
        for (row, line) in table.lines.iter().enumerate() {
            let must = match column.cell(row) {
                Cell::Word(word) if number == 0 && is_kind(word) => continue,
                _ if number == 0 => {
                    format!("must be one of {}", PlantKind::ALL.map(PlantKind::word).join(", "))
                }
                Cell::Number(value) if value.is_finite() => continue,
                Cell::Word("") if is_optional => continue,
                _ if is_optional => "must be a finite number or nothing".to_owned(),
                _ => "must be a finite number".to_owned(),
            };
            let place = Place { line: Some(*line), ..place };
            return Err(place.refuse(name, quoted(&column.text(row)), must));
        }
    }
    Ok(table)
}

/// A number of a plant, from the plant and the travel in m.
type Number = fn(&Plant, f64) -> Option<f64>;

/// Columns of the measures.
const NUMBERS: [(&str, Number); 4] = [
    ("tip_error", |own, travel_m| Some(own.strays.tip_error_m / travel_m)),
    ("rest_vibration", |own, travel_m| Some(own.strays.rest_vibration_m / travel_m)),
    ("drift_m", |own, _| Some(own.strays.drift_m)),
    (SETTLING, |own, _| own.strays.settling_s),
];

/// Writes a row for each plant: its kind, the value of each key, empty where the file's value stays unknown, and its
/// measures, tip error and rest vibration over the travel.
fn write_plants(
    out: &mut (dyn Write + Send),
    plants: &[Plant],
    summary: &RobustSummary,
    digits: Digits,
) -> io::Result<()> {
    let columns = plant_columns(plants, summary);
    let mut text = KIND.as_bytes().to_vec();
    for (heading, _) in &columns {
        // A heading may have a comma or a quote in the name of a segment.
        let quoted = heading.replace('"', "\"\"");
        let is_plain = !heading.contains([',', '"']);
        text.push(b',');
        text.extend(if is_plain { heading.clone() } else { format!("\"{quoted}\"") }.as_bytes());
    }
    text.push(b'\n');
    let peak = |values: &[Option<f64>]| {
        values.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()))
    };
    let formats: Vec<_> = columns.iter().map(|(_, values)| digits.for_peak(peak(values))).collect();
    for (row, plant) in plants.iter().enumerate() {
        text.extend(plant.kind.word().as_bytes());
        for ((_, values), format) in columns.iter().zip(&formats) {
            text.push(b',');
            if let Some(value) = values[row] {
                format.write(&mut text, value);
            }
        }
        text.push(b'\n');
        out.write_all(&text)?;
        text.clear();
    }
    Ok(())
}

/// Columns of robust.csv behind the kinds: values of the keys, and measures.
pub fn plant_columns(plants: &[Plant], summary: &RobustSummary) -> Vec<(String, Vec<Option<f64>>)> {
    let keys: Vec<&Key> = summary.keys().collect();
    let value = |plant: &Plant, key: usize| plant.values[key].or(keys[key].nominal);
    let mut columns: Vec<(String, Vec<Option<f64>>)> = keys
        .iter()
        .enumerate()
        .map(|(number, key)| (key.heading(), plants.iter().map(|own| value(own, number)).collect()))
        .collect();
    let travel_m = summary.travel_m;
    for (name, of) in NUMBERS {
        columns.push((name.to_owned(), plants.iter().map(|own| of(own, travel_m)).collect()));
    }
    columns
}

/// Parts of the record of a fit that a study reads.
#[derive(Deserialize)]
struct FitRecord {
    command: String,
    inputs: FitLink,
    values: Vec<FitValue>,
    correlation: Vec<Vec<f64>>,
    chi_squared: Option<f64>,
    degrees_of_freedom: usize,
}

#[derive(Deserialize)]
struct FitLink {
    link: Fingerprint,
}

#[derive(Deserialize)]
struct FitValue {
    path: String,
    relative_standard_error: Option<f64>,
    relative_interval_95: Option<[f64; 2]>,
}

/// The keys of a fit with their 95 % intervals and their covariance, from its record; for the fitted link, not for the one
/// before.
///
/// # Errors
/// [`TableError`] for another file, a fit of the link file `link` itself, and a value that the data do not determine.
pub fn read_fitted(file: &InputFile, link: &InputFile) -> Result<(Vec<Key>, Fitted), TableError> {
    let place = Place { file: &file.shown, line: None };
    let record: Option<FitRecord> = serde_json::from_slice(&file.bytes).ok();
    let Some(record) = record.filter(|record| record.command == "fit") else {
        let hint = "it is NAME.json beside the link NAME.toml that fit -o NAME.toml writes";
        let error = place.refuse_whole("must be the record of a fit");
        return Err(error.with_hint(Some(hint.to_owned())));
    };
    if record.inputs.link.sha256 == link.sha256() {
        let message =
            format!("{} is the link before this fit, but must be the fitted one", link.shown);
        let hint = "use the link file that fit -o wrote";
        return Err(place.refuse_whole(&message).with_hint(Some(hint.to_owned())));
    }
    let degrees = record.chi_squared.is_none().then_some(record.degrees_of_freedom);
    let reach = degrees.map_or(crate::numeric::NORMAL_95, student_95);
    let (mut keys, mut standard_errors) = (Vec::new(), Vec::new());
    for FitValue { path, relative_standard_error, relative_interval_95 } in record.values {
        let Some(error) = relative_standard_error.filter(|own| *own > 0.0 && reach.is_finite())
        else {
            let message =
                format!("values: {path} has no standard error: the data do not determine it");
            let hint = "fix it in the fit, and give its interval by --uncertain";
            return Err(place.refuse_whole(&message).with_hint(Some(hint.to_owned())));
        };
        let ends =
            relative_interval_95.unwrap_or([-reach, reach].map(|reach| libm::exp(reach * error)));
        keys.push(Key { path, how: How::Factor, nominal: Some(1.0), ends });
        standard_errors.push(error);
    }
    let lower = Fitted::lower_of(&record.correlation).filter(|own| own.len() == keys.len());
    let Some(lower) = lower else {
        let message = "correlation is no positive definite matrix of all values";
        return Err(place.refuse_whole(message));
    };
    Ok((keys, Fitted { first: 0, standard_errors, lower, degrees_of_freedom: degrees }))
}
