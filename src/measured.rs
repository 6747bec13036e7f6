//! What was measured of a link, read from its file and from those that it names.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::csv::{
    InputError, InputFile, Reading, TableError, TableFormat, read_frequency_response, read_record,
};
use crate::fit::{
    Channel, Gain, Measurements, Motor, Record, RecordInput, RecordedInput, Response,
};
use crate::spec::{MeasuredFile, RecordFile, ResponseFile, SpecError, read_measurements};

/// Measurements, the files that they are from, and how these were read.
#[derive(Debug)]
pub struct MeasuredSet {
    /// What was measured.
    pub measurements: Measurements,
    /// The file of measured values.
    pub file: InputFile,
    /// The files that it names, in its order: responses, then records.
    pub named: Vec<InputFile>,
    /// How each of the records was read, after its name.
    pub readings: Vec<(String, Reading)>,
}

/// Why measurements are refused.
#[derive(Debug, Error)]
pub enum MeasuredError {
    /// A file that cannot be read.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The file of measured values.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// A response or a record.
    #[error(transparent)]
    Table(#[from] TableError),
    /// Numbers that cannot be fitted to, with their file.
    #[error("{0}")]
    Refused(String),
}

impl MeasuredError {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&str> {
        match self {
            Self::Input(error) => error.hint(),
            Self::Spec(error) => error.hint(),
            Self::Table(error) => error.hint(),
            Self::Refused(_) => None,
        }
    }

    fn refused(file: &InputFile, error: &impl Display) -> Self {
        Self::Refused(format!("{}: {error}", file.shown))
    }
}

/// The files that a file of measured values names, beside it.
fn beside(file: &Path, name: &str) -> PathBuf {
    file.with_file_name(name)
}

/// Reads a file of measured values (TOML) and all files that it names.
///
/// # Errors
/// [`MeasuredError`] names the file, and the line where one is at fault.
pub fn read_measured(path: &Path) -> Result<MeasuredSet, MeasuredError> {
    let file = InputFile::read_toml(path)?;
    let MeasuredFile { values, responses, records, motor } =
        read_measurements(&file.shown, file.text()?)?;
    let (mut read_responses, mut read_records) = (Vec::new(), Vec::new());
    let (mut named, mut readings) = (Vec::new(), Vec::new());
    for response in responses {
        let table = InputFile::read(&beside(path, &response.file))?;
        read_responses.push(read_response(&table, response, motor.as_ref())?);
        named.push(table);
    }
    for record in records {
        let table = InputFile::read(&beside(path, &record.file))?;
        let (record, reading) = record_of(&table, record, motor)?;
        readings.push((table.shown.clone(), reading));
        read_records.push(record);
        named.push(table);
    }
    let measurements = Measurements::new(values, read_responses, read_records)
        .map_err(|error| MeasuredError::refused(&file, &error))?;
    Ok(MeasuredSet { measurements, file, named, readings })
}

fn read_response(
    table: &InputFile,
    of: ResponseFile,
    motor: Option<&Motor>,
) -> Result<Response, MeasuredError> {
    let ResponseFile { file, transfer, is_per_volt, gain, distance_m, uncertainty } = of;
    let (frequencies_hz, values) = read_frequency_response(&table.shown, &table.bytes)?;
    let values = values.into_iter().map(|value| value / distance_m).collect();
    let response = Response::new(file, (transfer, gain), uncertainty, (frequencies_hz, values))
        .map_err(|error| MeasuredError::refused(table, &error))?;
    Ok(match motor.filter(|_| is_per_volt) {
        Some(motor) => response.per_volt(motor),
        None => response,
    })
}

fn record_of(
    table: &InputFile,
    of: RecordFile,
    motor: Option<Motor>,
) -> Result<(Record, Reading), MeasuredError> {
    let refused = |error: &dyn Display| MeasuredError::refused(table, &error);
    let sensors: Vec<_> = of.channels.iter().map(|channel| channel.sensor).collect();
    let mut format = TableFormat { skip: of.skip, ..TableFormat::default() };
    for choice in &of.columns {
        let choice = choice.parse().map_err(|error| refused(&format!("columns: {error}")))?;
        format.columns.push(choice);
    }
    // Numbers with a free gain may have any unit.
    for channel in of.channels.iter().filter(|channel| channel.gain == Gain::Free) {
        let scale = format!("{}=1", channel.sensor.word());
        format.scales.push(scale.parse().map_err(|error: String| refused(&error))?);
    }
    let read = read_record(&table.shown, &table.bytes, of.input, &sensors, &format)?;
    let channels = of.channels.iter().zip(read.channels).zip(read.units);
    let channels = channels.map(|((channel, samples), unit)| {
        let samples = samples.into_iter().map(|sample| sample / channel.distance_m).collect();
        let uncertainty = channel.uncertainty.map(|own| own * unit.abs() / channel.distance_m);
        let (sensor, gain, has_offset) = (channel.sensor, channel.gain, channel.has_offset);
        Channel { sensor, gain, has_offset, uncertainty, samples }
    });
    let input = match (of.input, motor) {
        (RecordedInput::Voltage, Some(motor)) => RecordInput::Voltage(read.input, of.hold, motor),
        (RecordedInput::HubAngle, _) => RecordInput::HubAngle(read.input),
        (RecordedInput::Torque | RecordedInput::Voltage, _) => {
            RecordInput::Torque(read.input, of.hold)
        }
    };
    let record = Record::new(of.file, read.step_s, input, channels.collect(), of.is_delay_free);
    Ok((record.map_err(|error| refused(&error))?, read.reading))
}
