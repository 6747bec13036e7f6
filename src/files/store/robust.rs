//! The folder of `robust`: summary.json, robust.csv and envelope.csv; and the fit that gives its intervals.

use std::io::{self, Write};

use serde::{Deserialize, Serialize};

use super::folder::{FolderError, OutputFolder};
use super::json::Fingerprint;
use super::names::SUMMARY;
use crate::csv::{Digits, InputFile, Place, TableError, write_columns};
use crate::numeric::student_95;
use crate::robust::{Fitted, How, Key, Plant, RobustSummary, Robustness};

/// Names of all files that `robust` may write.
const OWNED: [&str; 3] = [PLANTS, ENVELOPE, SUMMARY];
const PLANTS: &str = "robust.csv";
const ENVELOPE: &str = "envelope.csv";

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

/// Writes robust.csv, envelope.csv and summary.json: all or none. `times_s` has the times of the envelope.
///
/// # Errors
/// [`FolderError`] names the file that cannot be written.
pub fn write_robust(
    folder: OutputFolder,
    (record, summary): (&str, &RobustSummary),
    (outcome, times_s): (&Robustness, &[f64]),
    digits: Digits,
) -> Result<(), FolderError> {
    folder.file(PLANTS, |out| write_plants(out, &outcome.plants, summary, digits))?;
    folder.file(ENVELOPE, |out| {
        let [low, high] = &outcome.envelope_m;
        let columns = [("time_s", times_s), ("lowest_error_m", low), ("highest_error_m", high)];
        write_columns(out, None, &columns, digits)
    })?;
    folder.file(SUMMARY, |out| out.write_all(record.as_bytes()))?;
    folder.commit(SUMMARY, &OWNED)
}

/// A number of a plant, from the plant and the travel in m.
type Number = fn(&Plant, f64) -> Option<f64>;

/// Writes a row for each plant: its kind, the value of each key, empty where the file's value stays unknown, and its
/// measures, tip error and rest vibration over the travel.
fn write_plants(
    out: &mut (dyn Write + Send),
    plants: &[Plant],
    summary: &RobustSummary,
    digits: Digits,
) -> io::Result<()> {
    let columns = plant_columns(plants, summary);
    let mut text = b"kind".to_vec();
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
    let numbers: [(&str, Number); 4] = [
        ("tip_error", |own, travel_m| Some(own.strays.tip_error_m / travel_m)),
        ("rest_vibration", |own, travel_m| Some(own.strays.rest_vibration_m / travel_m)),
        ("drift_m", |own, _| Some(own.strays.drift_m)),
        ("settling_s", |own, _| own.strays.settling_s),
    ];
    for (name, of) in numbers {
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
    let record: FitRecord = serde_json::from_slice(&file.bytes)
        .map_err(|error| place.refuse_whole(&format!("is no record of a fit: {error}")))?;
    if record.command != "fit" {
        let message = format!("command = {:?}, but must be \"fit\"", record.command);
        let hint = "--from takes NAME.json, which fit -o NAME.toml writes";
        return Err(place.refuse_whole(&message).with_hint(Some(hint.to_owned())));
    }
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
