//! Measurements of a link or an arm, read from their file and the files that it names.

use std::fmt::Display;
use std::path::Path;
use std::str::FromStr;

use thiserror::Error;

use crate::csv::{
    InputError, InputFile, Reading, SampleRate, TableError, TableFormat, read_decay,
    read_frequency_response, read_record,
};
use crate::fit::{
    Channel, Decay, Gain, Measured, Measurements, MeasurementsError, Motor, Record, RecordInput,
    RecordedInput, Response, Specimen,
};
use crate::response::Interpolation;
use crate::spec::{
    DecayFile, MeasuredFile, RecordFile, ResponseFile, SpecError, TableKeys, read_measurements,
};

/// Measurements, their files, and the manner of reading them.
#[derive(Debug)]
pub struct MeasuredSet {
    /// What was measured.
    pub measurements: Measurements,
    /// The file of measured values.
    pub file: InputFile,
    /// The files that it names, in its order: responses, then records, then decays.
    pub named: Vec<InputFile>,
    /// Manner of reading each file, after its name.
    pub readings: Vec<(String, Reading)>,
}

/// Why measurements are refused.
#[derive(Debug, Error)]
pub enum MeasuredError {
    /// An unreadable file.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The file of measured values.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// A response or a record.
    #[error(transparent)]
    Table(#[from] TableError),
    /// Numbers that do not allow a fit, with their file.
    #[error("{message}")]
    Refused {
        /// The file, and what is wrong.
        message: String,
        /// Remedy for the user.
        hint: Option<&'static str>,
    },
}

impl MeasuredError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&str> {
        match self {
            Self::Input(error) => error.hint(),
            Self::Spec(error) => error.hint(),
            Self::Table(error) => error.hint(),
            Self::Refused { hint, .. } => *hint,
        }
    }

    fn refused(file: &InputFile, error: &impl Display) -> Self {
        Self::Refused { message: format!("{}: {error}", file.shown), hint: None }
    }

    fn hinting(self, own: Option<&'static str>) -> Self {
        match self {
            Self::Refused { message, hint } => Self::Refused { message, hint: own.or(hint) },
            other => other,
        }
    }
}

/// Reads a file of measured values (TOML) of a link or an arm, and all files that it names. Searches decays for modes
/// near the frequencies of the link or the arm.
///
/// # Errors
/// [`MeasuredError`] names the file, and the faulty line.
pub fn read_measured(path: &Path, of: &Specimen) -> Result<MeasuredSet, MeasuredError> {
    let file = InputFile::read_toml(path)?;
    let of_link = of.drive().and_then(Motor::of);
    let MeasuredFile { mut values, responses, records, decays, motor, table, has_pinion } =
        read_measurements(&file.shown, file.text()?, (of.links(), of_link.is_some()))?;
    let slides = of.slides();
    if motor.is_some() && has_pinion != slides {
        let why = if slides {
            "is missing: the carriage moves by it for a turn of 1 rad of its pinion"
        } else {
            "is for a carriage, but this is a hub"
        };
        return Err(MeasuredError::refused(&file, &format!("{table}.pinion_radius {why}")));
    }
    let motor = motor.or(of_link);
    let check = |kind: &str, words: &[(&'static str, Option<bool>)]| {
        let wrong = words.iter().find(|(_, of)| of.is_some_and(|of| of != slides));
        let [joint, known] = if slides {
            ["carriage", "force, carriage and carriage_velocity"]
        } else {
            ["hub", "torque, hub_angle and hub_rate"]
        };
        wrong.map_or(Ok(()), |(word, _)| {
            let why = format!("{kind}: {word}, but a link on a {joint} has {known}");
            Err(MeasuredError::refused(&file, &why))
        })
    };
    let (mut read_responses, mut read_records) = (Vec::new(), Vec::new());
    let (mut named, mut readings) = (Vec::new(), Vec::new());
    for response in responses {
        let table = InputFile::read_beside(path, &response.file)?;
        let first_zero = response.first_zero;
        let words = [(response.transfer.word(), response.transfer.slides())];
        let words: Vec<_> = words.into_iter().chain(response.effort).collect();
        check("response", &words)?;
        let (response, reading) = read_response(&table, response, motor.as_ref())?;
        let response = response.on_carriage(slides);
        readings.push((table.shown.clone(), reading));
        match first_zero {
            Some(first) => values.extend(zeros_of(&table, &response, first)?),
            None => read_responses.push(response),
        }
        named.push(table);
    }
    for record in records {
        let table = InputFile::read_beside(path, &record.file)?;
        let sensors = record.channels.iter().map(|own| (own.sensor.word(), own.sensor.slides()));
        let input = (record.input.word(), record.input.slides());
        check("record", &std::iter::once(input).chain(sensors).collect::<Vec<_>>())?;
        let (record, reading) = record_of(&table, record, motor)?;
        readings.push((table.shown.clone(), reading));
        read_records.push(record);
        named.push(table);
    }
    let mut read_decays = Vec::new();
    for decay in decays {
        let table = InputFile::read_beside(path, &decay.file)?;
        let (decay, taken, reading) = decay_of(&table, decay, of)?;
        values.extend(taken);
        readings.push((table.shown.clone(), reading));
        read_decays.push(decay);
        named.push(table);
    }
    let has_decays = !read_decays.is_empty();
    let measurements = Measurements::new(values, read_responses, read_records);
    let measurements = measurements.map_err(|error| {
        let is_mixed =
            matches!(error, MeasurementsError::Mixed { .. } | MeasurementsError::MixedFile(_));
        let hint = (has_decays && is_mixed).then_some(OF_DECAYS);
        MeasuredError::refused(&file, &error).hinting(hint)
    })?;
    let measurements = measurements.with_decays(read_decays);
    Ok(MeasuredSet { measurements, file, named, readings })
}

/// Advice for values without uncertainty beside the values of a decay.
const OF_DECAYS: &str = "the values of a [[decay]] have uncertainties from its samples: add one to every other \
                         value, or write those of the decay as [[frequency]] and [[damping]] without";

/// The modes of a decay, its values for the fit, and how the program read it.
fn decay_of(
    table: &InputFile,
    decay: DecayFile,
    of: &Specimen,
) -> Result<(Decay, Vec<Measured>, Reading), MeasuredError> {
    let DecayFile { file, frequencies, values, uncertainty, sensor, span_s, table: keys } = decay;
    let format = format_of(table, &keys)?;
    let (mut samples, reading) = read_decay(&table.shown, &table.bytes, sensor, span_s, &format)?;
    samples.name = file;
    let within = frequencies.into_iter().map(|own| (own.clone(), of.around_hz(&own)));
    let decay = Decay::of(samples, &within.collect::<Vec<_>>(), values)
        .map_err(|error| MeasuredError::refused(table, &error).hinting(Some(error.hint())))?;
    let taken = decay.values(values, uncertainty.unwrap_or(0.0));
    Ok((decay, taken, reading))
}

/// The form of a table by its keys.
fn format_of(table: &InputFile, keys: &TableKeys) -> Result<TableFormat, MeasuredError> {
    fn parsed<T: FromStr>(
        table: &InputFile,
        key: &str,
        texts: impl IntoIterator<Item = impl AsRef<str>>,
    ) -> Result<Vec<T>, MeasuredError>
    where
        T::Err: Display,
    {
        let one = |text: &str| {
            text.parse().map_err(|error| MeasuredError::refused(table, &format!("{key}: {error}")))
        };
        texts.into_iter().map(|text| one(text.as_ref())).collect()
    }
    let rate = keys.sample_rate_hz.map(SampleRate::of_hertz);
    let rate = rate.map(|rate| rate.ok_or("sample_rate must be above 0"));
    Ok(TableFormat {
        skip: keys.skip,
        columns: parsed(table, "columns", &keys.columns)?,
        scales: parsed(table, "scale", &keys.scale)?,
        delimiter: parsed(table, "delimiter", &keys.delimiter)?.pop(),
        decimal: parsed(table, "decimal", &keys.decimal)?.pop(),
        time_unit: parsed(table, "time_unit", &keys.time_unit)?.pop(),
        unit: parsed(table, "unit", &keys.unit)?.pop(),
        sample_rate: rate.transpose().map_err(|error| MeasuredError::refused(table, &error))?,
        resample_s: keys.resample_s,
        ..TableFormat::default()
    })
}

fn read_response(
    table: &InputFile,
    of: ResponseFile,
    motor: Option<&Motor>,
) -> Result<(Response, Reading), MeasuredError> {
    let format = format_of(table, &of.table)?;
    let ResponseFile { file, transfer, is_per_volt, gain, distance_m, uncertainty, .. } = of;
    let read = read_frequency_response(&table.shown, &table.bytes, &format)?;
    let values = read.values.into_iter().map(|value| value / distance_m).collect();
    let columns = (read.frequencies_hz, values);
    let response = Response::new(file, (transfer, gain), uncertainty, columns)
        .map_err(|error| MeasuredError::refused(table, &error))?;
    let response = match motor.filter(|_| is_per_volt) {
        Some(motor) => response.per_volt(motor),
        None => response,
    };
    Ok((response, read.reading))
}

/// The zeros of a response of a closed loop.
fn zeros_of(
    table: &InputFile,
    response: &Response,
    first: usize,
) -> Result<Vec<Measured>, MeasuredError> {
    let zeros = response.zeros(first);
    if zeros.is_empty() {
        let must = "no dips, but a closed loop is fitted to its dips: at least one must be 6 dB deep \
                    (12 dB beside an uncertainty of 0.12), its phase rising";
        return Err(MeasuredError::refused(table, &must));
    }
    Ok(zeros)
}

fn record_of(
    table: &InputFile,
    of: RecordFile,
    motor: Option<Motor>,
) -> Result<(Record, Reading), MeasuredError> {
    let refused = |error: &dyn Display| MeasuredError::refused(table, &error);
    let sensors: Vec<_> = of.channels.iter().map(|channel| channel.sensor).collect();
    let mut format = format_of(table, &of.table)?;
    // Numbers with a free gain may have any unit.
    for channel in of.channels.iter().filter(|channel| channel.gain == Gain::Free) {
        let scale = format!("{}=1", channel.sensor.word());
        format.scales.push(scale.parse().map_err(|error: String| refused(&error))?);
    }
    let read = read_record(&table.shown, &table.bytes, of.input, &sensors, &format)?;
    if !of.input.is_motion() && of.hold != Interpolation::Cubic && read.reading.is_interpolated() {
        let must = "the times are not uniform, but must be unless hold = \"cubic\"";
        return Err(refused(&must));
    }
    let channels = of.channels.iter().zip(read.channels).zip(read.units);
    let channels = channels.map(|((channel, samples), unit)| {
        let samples = samples.into_iter().map(|sample| sample / channel.distance_m).collect();
        let uncertainty = channel.uncertainty.map(|own| own * unit.abs() / channel.distance_m);
        let (sensor, gain, has_offset) = (channel.sensor, channel.gain, channel.has_offset);
        let unit = unit / channel.distance_m;
        Channel { sensor, gain, has_offset, uncertainty, unit, samples }
    });
    let input = match (of.input, motor) {
        (RecordedInput::Voltage, Some(motor)) => RecordInput::Voltage(read.input, of.hold, motor),
        (RecordedInput::Voltage, None) => return Err(refused(&"a voltage needs [drive]")),
        (RecordedInput::HubAngle | RecordedInput::Carriage, _) => RecordInput::HubAngle(read.input),
        (RecordedInput::Torque | RecordedInput::Force, _) => {
            RecordInput::Torque(read.input, of.hold)
        }
    };
    let record =
        Record::new(of.file, read.grid.step_s, input, channels.collect(), of.is_delay_free);
    let record = record.map_err(|error| refused(&error).hinting(error.hint()))?;
    Ok((record, read.reading))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::fit::Observable;
    use crate::spec::read_specification;

    fn any_link() -> Specimen {
        let text = "segments = [{ length = 1, EI = 1, mass_per_length = 1 }]\nhub.inertia = 1";
        let own = read_specification("link.toml", text, &[]).unwrap();
        Specimen::of(own.arm, &own.meshes)
    }

    /// Samples, uncertainties and units of a record in degrees, microstrain at 0.4 mm, counts and volts.
    #[test]
    fn units_distances_and_scales_reach_samples_and_uncertainties() {
        let folder = tempfile::tempdir().unwrap();
        let log = "any line\ntime [ms],torque,hub_angle [deg],root_strain [um/m],tip_deflection\n\
                   0,0,0,0,0\n1,1,90,4,10\n2,1,180,8,20\n3,0,90,4,10\n";
        let text = "[[record]]\nfile = 'log.csv'\ninput = 'torque'\nhold = 'linear'\nskip = 1\n\
                    scale = ['tip_deflection=0.001']\n\
                    [[record.channel]]\nsensor = 'hub_angle'\nuncertainty = 1.8\n\
                    [[record.channel]]\nsensor = 'root_strain'\ndistance = '0.4 mm'\nuncertainty = 0.2\n\
                    [[record.channel]]\nsensor = 'tip_deflection'\nuncertainty = 0.5\n";
        fs::write(folder.path().join("log.csv"), log).unwrap();
        let path = folder.path().join("measured.toml");
        fs::write(&path, text).unwrap();
        let read = read_measured(&path, &any_link()).unwrap();
        let channels = read.measurements.records()[0].channels();
        let near = |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 1e-12, "{found}");
        near(channels[0].samples[2], std::f64::consts::PI);
        near(channels[0].uncertainty.unwrap(), std::f64::consts::PI / 100.0);
        near(channels[1].samples[2], 8e-6 / 0.4e-3);
        near(channels[1].uncertainty.unwrap(), 0.2e-6 / 0.4e-3);
        near(channels[2].samples[1], 0.01);
        near(channels[2].uncertainty.unwrap(), 5e-4);
        fs::write(&path, text.to_owned() + &text.replace("hold = 'linear'", "")).unwrap();
        let twice = read_measured(&path, &any_link()).unwrap_err().to_string();
        assert!(twice.ends_with("measured.toml: hub_angle of log.csv is given twice"), "{twice}");
    }

    #[test]
    fn keys_of_a_table_are_the_options_of_the_reader() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("measured.toml");
        let read = |table: &str, keys: &str| {
            fs::write(folder.path().join("table.csv"), table).unwrap();
            fs::write(&path, keys).unwrap();
            read_measured(&path, &any_link())
        };
        let response = "[[response]]\nfile = 'table.csv'\ntransfer = 'hub_angle'\n";
        let rows = "1,2,3\n2,0.5,1\n3,1,0.25\n";
        let plain = read(&format!("frequency,real,imaginary\n{rows}"), response).unwrap();
        let keys = "skip = 1\ncolumns = ['frequency=1', 'real=2', 'imaginary=3']\ndecimal = 'comma'\n\
                    delimiter = ';'\nscale = ['real=0.5']\n";
        let other = format!("any\n{}", "1;4;3\n2;1;1\n3;2;0,25\n");
        let found = read(&other, &format!("{response}{keys}")).unwrap();
        assert_eq!(found.measurements.responses(), plain.measurements.responses());
        let refused = read("a;b\n1;2\n", response).unwrap_err();
        assert!(refused.hint().unwrap().starts_with("columns = ["), "{refused}");

        let row = |k: u32| match k {
            7 => "7;;7\n".to_owned(),
            _ => format!("{k};{};{k}\n", k * k).repeat(if k == 9 { 2 } else { 1 }),
        };
        let table = "ms;hub_angle;torque\n".replace("ms", "time [ms]")
            + &(0..30).map(row).collect::<String>();
        let record = "[[record]]\nfile = 'table.csv'\ninput = 'torque'\nresample = '0.5 ms'\n\
                      [[record.channel]]\nsensor = 'hub_angle'\n";
        let found = read(&table, record).unwrap();
        let samples = &found.measurements.records()[0].channels()[0].samples;
        assert_eq!(samples.len(), 59);
        for (k, sample) in (0..).zip(samples) {
            assert!((sample - 0.25 * f64::from(k * k)).abs() < 1e-9, "{k}: {sample}");
        }
        let note = found.readings[0].1.note().unwrap();
        assert!(
            note.ends_with(
                "without line 12, which repeats a time, without line 9, which lacks a value"
            ),
            "{note}"
        );
        let error = read(&table, &record.replace("resample = '0.5 ms'\n", "")).unwrap_err();
        assert!(
            error
                .to_string()
                .ends_with("table.csv:9: hub_angle = an empty field, but must be a finite number"),
            "{error}"
        );
        assert!(error.hint().unwrap().contains("resample = "), "{error}");
    }

    /// A loop with zeros of ratio 0.01 at 4 and 9 Hz between well damped poles, which are the second and the
    /// third; the same poles without zeros are refused.
    #[test]
    fn a_closed_loop_is_read_as_zeros() {
        let folder = tempfile::tempdir().unwrap();
        let row = |hertz: f64, zeros: &[f64]| {
            let s = num_complex::Complex64::new(0.0, hertz);
            let poles = (s + 1.0) * (s * s + s + 36.0) * (s * s + 2.0 * s + 100.0);
            let value = zeros.iter().fold(poles.inv(), |v, z| v * (s * s + 0.02 * z * s + z * z));
            format!("{hertz},{},{}\n", value.re, value.im)
        };
        let table = |zeros: &[f64]| {
            let rows = (1..300).map(|k| row(0.05 * f64::from(k), zeros));
            "frequency [Hz],real,imaginary\n".to_owned() + &rows.collect::<String>()
        };
        let path = folder.path().join("measured.toml");
        let text = "[[response]]\nfile = 'loop.csv'\ntransfer = 'hub_angle'\nloop = 'closed'\n";
        fs::write(folder.path().join("loop.csv"), table(&[4.0, 9.0])).unwrap();
        fs::write(&path, text.to_owned() + "first_zero = 2\nuncertainty = 0.01\n").unwrap();
        let read = read_measured(&path, &any_link()).unwrap();
        assert_eq!(read.measurements.responses().len() + read.named.len(), 1);
        for (k, exact) in [(0, 4.0), (1, 9.0)] {
            let zero = &read.measurements.values()[k];
            assert_eq!(zero.observable, Observable::Zero { zero: k + 2 });
            assert!((zero.value / exact - 1.0).abs() < 1e-4, "{zero:?}");
            assert!(zero.uncertainty.unwrap() < 0.001 * exact, "{zero:?}");
        }
        fs::write(folder.path().join("loop.csv"), table(&[])).unwrap();
        let refused = read_measured(&path, &any_link()).unwrap_err().to_string();
        assert!(refused.contains("loop.csv: no dips"), "{refused}");
    }

    #[test]
    fn a_held_input_needs_uniform_times() {
        let folder = tempfile::tempdir().unwrap();
        let row = |k: i32| {
            format!("{},{},{}\n", f64::from(k) + if k % 2 == 1 { 0.02 } else { 0.0 }, k % 3, k)
        };
        let log = "time,torque,hub_angle\n".to_owned() + &(0..20).map(row).collect::<String>();
        fs::write(folder.path().join("log.csv"), log).unwrap();
        let text = "[[record]]\nfile = 'log.csv'\ninput = 'torque'\n[[record.channel]]\nsensor = 'hub_angle'\n";
        let path = folder.path().join("measured.toml");
        fs::write(&path, text).unwrap();
        assert!(read_measured(&path, &any_link()).unwrap().readings[0].1.jitter().is_some());
        fs::write(&path, text.replace("'torque'\n", "'torque'\nhold = 'zero'\n")).unwrap();
        let refused = read_measured(&path, &any_link()).unwrap_err().to_string();
        assert!(refused.contains("log.csv: the times are not uniform"), "{refused}");
    }
}
