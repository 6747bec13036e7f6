//! Measurements: records and free decays for a fit, and a recording for comparison with a simulation.

use super::columns::{Beside, Columns, Header};
use super::format::{ColumnScale, Reading, TableFormat};
use super::heading::{
    ACCELERATION, CARRIAGE, CARRIAGE_VELOCITY, DEFLECTION, DISPLACEMENT, FORCE, HUB_ANGLE,
    HUB_RATE, Heading, JOINT_RATES, JOINT_TORQUES, JOINTS, Measure, PATH_X, PATH_Y, Quantity,
    ROOT_STRAIN, Spelling, TIME, TIP, TORQUE, VELOCITY, VOLTAGE, Vocabulary, joined, names,
    quantity, refuse_missing,
};
use super::input::{BY_HEADINGS, Place, TableError};
use super::joints::Joints;
use super::motion_columns::unread;
use super::quality::{Judged, doubt};
use super::samples::Samples;
use super::uniform::MIN_SAMPLES;
use crate::fit::{DecaySamples, RecordedInput};
use crate::model::Sensor;
use crate::numeric::{Dimension, TimeGrid};
use crate::recording::Change;
use crate::result::{ChannelRecording, SimulatedChannel};

/// Inputs of a link, and quantities of its sensors.
const RECORD: Vocabulary = Vocabulary {
    quantities: &[
        TIME,
        TORQUE,
        VOLTAGE,
        HUB_ANGLE,
        HUB_RATE,
        FORCE,
        CARRIAGE,
        CARRIAGE_VELOCITY,
        DEFLECTION,
        ACCELERATION,
        ROOT_STRAIN,
    ],
    prefix: "tip_",
    example: "time,torque,hub_angle",
    choice: Some("rename one of them, or choose with columns"),
    by_option: "columns = [\"time=1\", \"torque=2\"] names the columns",
};

/// Keys about a record in the file that names it, for hints.
const CHOICES: &str = "columns = [\"time=1\", \"torque=2\"] chooses columns by number or heading; skip = 3 \
                       leaves lines out; scale = [\"hub_angle=0.0015\"] makes SI of counts; resample = \"5 ms\" makes times uniform and leaves out rows without a value; gain = \"free\" takes a sensor's numbers in any unit";

/// A recorded table, in SI at uniform times.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordTable {
    /// Its times.
    pub grid: TimeGrid,
    /// Samples of the input that drives the link.
    pub input: Vec<f64>,
    /// Samples of each sensor.
    pub channels: Vec<Vec<f64>>,
    /// Unit of each sensor's column in SI.
    pub units: Vec<f64>,
    /// Deviations of the table from the standard form.
    pub reading: Reading,
}

/// Reads recorded histories: `time`, the input that drives the link, and the columns of sensors, by their names or by
/// the choice of `format`. Other columns are ignored.
///
/// Times may be off the uniform grid by up to 5 % of the step: a cubic spline through each column yields the samples of
/// the grid.
///
/// ```
/// use flexlink::csv::{TableFormat, read_record};
/// use flexlink::fit::RecordedInput;
/// use flexlink::model::Sensor;
/// let file = b"time [ms],voltage [V],hub_angle [deg],note\n0,0,0,\n1,5,0,\n2,5,1,\n3,5,3,\n";
/// let format = TableFormat::default();
/// let record = read_record("step.csv", file, RecordedInput::Voltage, &[Sensor::HubAngle], &format)?;
/// assert_eq!((record.grid.step_s, &record.input[..]), (0.001, &[0.0, 5.0, 5.0, 5.0][..]));
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names a missing column, and the line of a field that is not finite or of a time off the grid.
pub fn read_record(
    name: &str,
    bytes: &[u8],
    input: RecordedInput,
    sensors: &[Sensor],
    format: &TableFormat,
) -> Result<RecordTable, TableError> {
    let wanted: Vec<Quantity> =
        [TIME, driving(input)].into_iter().chain(sensors.iter().map(|s| shown(*s))).collect();
    let mut samples = Samples::read(name, bytes, format, |header| columns(header, &wanted))
        .map_err(|error| error.of_named_file(CHOICES))?;
    doubt(&mut samples);
    let units: Vec<f64> = wanted.iter().map(|wanted| samples.unit(*wanted)).collect();
    let mut taken: Vec<Vec<f64>> =
        wanted.iter().map(|wanted| samples.take(*wanted).unwrap_or_default()).collect();
    let time_s = taken.remove(0);
    let time_s = samples.make_uniform(time_s, taken.iter_mut().collect())?;
    let grid = samples.grid(&time_s).map_err(|error| error.of_named_file(CHOICES))?;
    let (input, units) = (taken.remove(0), units[2..].to_vec());
    Ok(RecordTable { grid, input, channels: taken, units, reading: samples.reading })
}

fn driving(input: RecordedInput) -> Quantity {
    match input {
        RecordedInput::Torque => TORQUE,
        RecordedInput::Voltage => VOLTAGE,
        RecordedInput::HubAngle => HUB_ANGLE,
        RecordedInput::Force => FORCE,
        RecordedInput::Carriage => CARRIAGE,
    }
}

fn shown(sensor: Sensor) -> Quantity {
    match sensor {
        Sensor::HubAngle => HUB_ANGLE,
        Sensor::HubRate => HUB_RATE,
        Sensor::Carriage => CARRIAGE,
        Sensor::CarriageVelocity => CARRIAGE_VELOCITY,
        Sensor::TipDeflection => DEFLECTION,
        Sensor::TipAcceleration => ACCELERATION,
        Sensor::RootStrain => ROOT_STRAIN,
    }
}

fn columns(header: Header, wanted: &[Quantity]) -> Result<Columns, TableError> {
    let Header { fields, place, .. } = header;
    let mut columns = Columns::find(&RECORD, header, Beside::Others)?;
    if let Some(missing) = wanted.iter().find(|wanted| !columns.has(**wanted)) {
        let missing = refuse_missing(&names(fields), &word_of(*missing), place);
        return Err(missing.or_hint(CHOICES.to_owned()));
    }
    columns.headings.retain(|heading| wanted.contains(&heading.quantity));
    header.check_measures(&columns.headings)?;
    Ok(columns)
}

/// Name of a quantity in messages.
fn word_of(quantity: Quantity) -> String {
    let of_tip = [DEFLECTION, ACCELERATION].contains(&quantity);
    if of_tip { format!("tip_{}", quantity.word) } else { quantity.word.to_owned() }
}

/// Quantities of the tip of one link.
const OF_TIP: [Quantity; 5] = [TIP, DISPLACEMENT, VELOCITY, ACCELERATION, DEFLECTION];

/// Names of all quantities that a simulation yields.
const CHANNELS: Vocabulary = Vocabulary {
    quantities: &joined::<9>(&[&[TIME, HUB_ANGLE, HUB_RATE], &OF_TIP, &[TORQUE]]),
    prefix: "tip_",
    example: "time,hub_angle",
    ..Vocabulary::NONE
};

/// Names of all quantities that the simulation of a link on a carriage yields.
const CARRIAGE_CHANNELS: Vocabulary = Vocabulary {
    quantities: &joined::<9>(&[&[TIME, CARRIAGE, CARRIAGE_VELOCITY], &OF_TIP, &[FORCE]]),
    example: "time,carriage",
    ..CHANNELS
};

/// Quantities of a carriage.
const OF_CARRIAGE: [Quantity; 3] = [CARRIAGE, CARRIAGE_VELOCITY, FORCE];

/// Names of all quantities that the simulation of an arm yields; those of a carriage are of an arm on one.
const ARM_CHANNELS: Vocabulary = Vocabulary {
    quantities: &joined::<33>(&[
        &[TIME, PATH_X, PATH_Y],
        &JOINTS,
        &JOINT_RATES,
        &JOINT_TORQUES,
        &OF_CARRIAGE,
    ]),
    example: "time,joint1,joint2",
    ..CHANNELS
};

/// Channel of a quantity.
fn channel_of(quantity: Quantity) -> Option<SimulatedChannel> {
    let name = match quantity {
        DISPLACEMENT => TIP.word,
        DEFLECTION => "tip_deflection",
        _ => quantity.word,
    };
    SimulatedChannel::of_name(name)
}

/// Reads a recording of one link: `time`, and any of `hub_angle`, `hub_rate`, `tip` or `displacement`, `velocity` and
/// `acceleration` of the tip, `tip_deflection` and `torque`; on a carriage `carriage`, `carriage_velocity` and `force` in
/// place of those of the hub. A recording of an arm has any of `x` and `y` of the tip, `joint1`, `joint1_rate`, `torque1`,
/// `joint2`, …, and of its carriage. Times must increase, but need not be uniform.
///
/// ```
/// use flexlink::csv::read_recording;
/// use flexlink::result::SimulatedChannel;
/// let file = b"Time (ms),hub_angle [deg],tip [mm]\n0,0,0\n1,1,0\n2,3,1\n3,6,3\n";
/// let (recording, _) = read_recording("rig.csv", file, 1)?;
/// let (channel, samples) = &recording.channels[1];
/// assert_eq!((*channel, samples[3], recording.time_s[3]), (SimulatedChannel::Tip, 0.003, 0.003));
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names the file, and the faulty line and column.
pub fn read_recording(
    name: &str,
    bytes: &[u8],
    joints: impl Into<Joints>,
) -> Result<(ChannelRecording, Reading), TableError> {
    read_recording_as(name, bytes, joints, &TableFormat::default())
        .map_err(|error| error.of_named_file(BY_HEADINGS))
}

/// Reads a recording with the user's options for its form. After a choice of columns, a common name such as `v` counts
/// only if it is chosen.
///
/// # Errors
/// Those of [`read_recording`]; also options that do not fit the table.
pub fn read_recording_as(
    name: &str,
    bytes: &[u8],
    joints: impl Into<Joints>,
    format: &TableFormat,
) -> Result<(ChannelRecording, Reading), TableError> {
    let Joints { links, slides } = joints.into();
    let vocabulary = match links {
        1 if slides => &CARRIAGE_CHANNELS,
        1 => &CHANNELS,
        _ => &ARM_CHANNELS,
    };
    let columns = |header: Header| channel_columns(header, vocabulary, Joints { links, slides });
    let mut samples = Samples::read(name, bytes, format, columns)?;
    doubt(&mut samples);
    let time_s = samples.take(TIME).unwrap_or_default();
    let each = vocabulary.quantities[1..].iter();
    let channels = each.filter_map(|own| Some((channel_of(*own)?, samples.take(*own)?))).collect();
    Ok((ChannelRecording { time_s, channels }, samples.reading))
}

fn channel_columns(
    header: Header,
    vocabulary: &Vocabulary,
    Joints { links, slides }: Joints,
) -> Result<Columns, TableError> {
    let Header { fields, place, format } = header;
    let mut columns = Columns::find(vocabulary, header, Beside::Others)?;
    let joint_of = |own: Quantity| channel_of(own).and_then(SimulatedChannel::joint);
    let has = |own: Quantity| {
        joint_of(own).is_none_or(|joint| joint < links) && (slides || !OF_CARRIAGE.contains(&own))
    };
    let is_chosen = |quantity| format.columns.iter().any(|own| own.quantity == quantity);
    let counts = |own: &Heading| {
        let field = fields.get(own.index).copied().unwrap_or_default();
        let spelling = vocabulary.spelling(field, own.quantity);
        let is_common = !format.columns.is_empty() && spelling == Some(Spelling::Alias);
        has(own.quantity) && (own.quantity == TIME || is_chosen(own.quantity) || !is_common)
    };
    columns.headings.retain(counts);
    let is_read = |index: &usize| columns.headings.iter().any(|own| own.index == *index);
    columns.unread = (0..fields.len()).filter(|index| !is_read(index)).collect();
    columns.require(TIME, header)?;
    columns.refuse_both([TIP, DISPLACEMENT], header, "rename one of them")?;
    if columns.headings.len() < 2 {
        let words = vocabulary.quantities[1..].iter().filter(|own| has(**own)).map(|own| own.word);
        let wanted = format!("one of {}", words.collect::<Vec<_>>().join(", "));
        return Err(refuse_missing(&names(fields), &wanted, place));
    }
    header.check_measures(&columns.headings)?;
    let hint = "a simulation has no such channel";
    columns.reading.unread = unread(&columns, fields, vocabulary, hint);
    Ok(columns)
}

/// The only column besides the time.
const SIGNAL: Quantity = quantity("signal", "_1", Dimension::NONE, ["1", "1"]);

/// All quantities that may vibrate, in any unit.
const DECAY: Vocabulary = Vocabulary {
    quantities: &joined::<12>(&[
        &[TIME, HUB_ANGLE, HUB_RATE, CARRIAGE, CARRIAGE_VELOCITY],
        &OF_TIP,
        &[ROOT_STRAIN, VOLTAGE],
    ]),
    prefix: "tip_",
    example: "time,tip_deflection",
    choice: Some("rename one of them, or choose with columns"),
    by_option: "columns = [\"time=1\", \"deflection=2\"] names the columns",
};

/// Hint at the keys of a decay.
const OF_DECAY: &str = "sensor = \"tip_acceleration\" names the column that vibrates; columns = [\"time=1\", \
                        \"deflection=2\"] chooses columns by number or heading; skip = 3 leaves lines out; resample = \"5 ms\" makes times uniform";

/// Reads a free decay: `time` and the column of a sensor, in any unit. Without a sensor it is the only column that
/// changes. Only the samples in a span in s are used; their times must be uniform.
///
/// ```
/// use flexlink::csv::{TableFormat, read_decay};
/// let file = b"time [ms],hub_angle,strain [mV]\n0,0,3\n1,0,2\n2,0,-1\n3,0,-2\n4,0,1\n";
/// let format = TableFormat { columns: vec!["root_strain=strain".parse()?], ..Default::default() };
/// let (decay, _) = read_decay("pluck.csv", file, None, [Some(0.001), None], &format)?;
/// assert_eq!((decay.start_s, &decay.samples[..]), (0.001, &[2.0, -1.0, -2.0, 1.0][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of [`read_record`]; also several changing columns, or no changing column.
pub fn read_decay(
    name: &str,
    bytes: &[u8],
    sensor: Option<Sensor>,
    [from_s, until_s]: [Option<f64>; 2],
    format: &TableFormat,
) -> Result<(DecaySamples, Reading), TableError> {
    // The unit does not matter for a vibration.
    let of_any_unit = |quantity: &Quantity| ColumnScale { quantity: *quantity, factor: 1.0 };
    let scales = DECAY.quantities[1..].iter().map(of_any_unit).collect();
    let format = TableFormat { scales, ..format.clone() };
    let wanted = sensor.map(shown);
    let mut samples = Samples::read(name, bytes, &format, |header| decaying(header, wanted))
        .map_err(|error| error.of_named_file(OF_DECAY))?;
    let time_s = samples.take(TIME).unwrap_or_default();
    let first = from_s.map_or(0, |from_s| time_s.partition_point(|time| *time < from_s));
    let end = until_s.map_or(time_s.len(), |until_s| time_s.partition_point(|t| *t <= until_s));
    let within = first.min(end)..end;
    let all = DECAY.quantities[1..].iter().chain([&SIGNAL]);
    let columns = all.filter_map(|own| Some((*own, samples.take(*own)?[within.clone()].to_vec())));
    let mut columns: Vec<(Quantity, Vec<f64>)> = columns.collect();
    if wanted.is_none() {
        columns.retain(|(_, samples)| {
            samples.windows(2).any(|pair| pair[0].total_cmp(&pair[1]).is_ne())
        });
    }
    samples.lines = samples.lines[within.clone()].to_vec();
    let place = Place { file: name, line: None };
    let words: Vec<String> = columns.iter().map(|(own, _)| word_of(*own)).collect();
    let [(_, column)] = &mut columns[..] else {
        let found = if words.is_empty() { "none".to_owned() } else { words.join(", ") };
        let must = "must be one, or sensor must name one of them";
        let error = place.refuse("columns that change", found, must);
        return Err(error.with_hint(OF_DECAY.to_owned()));
    };
    if within.len() < MIN_SAMPLES {
        let must = format!("must be {MIN_SAMPLES} or more from its begin to its end");
        return Err(place.refuse("samples", within.len().to_string(), must));
    }
    let judged = Judged {
        name: &words[0],
        unit: ("", 1.0),
        change: Change::Jumping,
        is_command: false,
        time_s: &time_s[within.clone()],
        values: column,
    };
    samples.reading.doubt = judged.doubt(&samples.lines);
    let uniform_s = samples.make_uniform(time_s[within].to_vec(), vec![column])?;
    let decay = DecaySamples {
        name: name.to_owned(),
        column: words[0].clone(),
        start_s: uniform_s[0],
        step_s: samples.grid(&uniform_s).map_err(|error| error.of_named_file(OF_DECAY))?.step_s,
        samples: std::mem::take(column),
    };
    Ok((decay, samples.reading))
}

/// Columns of a decay: the time and quantities that may vibrate, or else the only other column.
fn decaying(header: Header, wanted: Option<Quantity>) -> Result<Columns, TableError> {
    let Header { fields, place, .. } = header;
    let mut columns = Columns::find(&DECAY, header, Beside::Others)?;
    columns.require(TIME, header)?;
    if let ([_], None, [only]) = (&columns.headings[..], wanted, &columns.unread[..]) {
        let measure = Measure { factor: Some(1.0), ..Measure::default() };
        let heading = Heading::of(*only, fields[*only], SIGNAL, false, measure, place)?;
        columns.headings.push(heading);
    }
    let sensors = columns.headings.iter_mut().filter(|heading| heading.quantity != TIME);
    sensors.for_each(|heading| "any unit".clone_into(&mut heading.unit_text));
    if let Some(wanted) = wanted {
        if !columns.has(wanted) {
            let missing = refuse_missing(&names(fields), &word_of(wanted), place);
            return Err(missing.or_hint(OF_DECAY.to_owned()));
        }
        columns.headings.retain(|heading| [TIME, wanted].contains(&heading.quantity));
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SENSORS: [Sensor; 2] = [Sensor::TipAcceleration, Sensor::RootStrain];

    fn read(text: &str, columns: &[&str]) -> Result<RecordTable, TableError> {
        let columns = columns.iter().map(|choice| choice.parse().unwrap()).collect();
        let format = TableFormat { columns, ..TableFormat::default() };
        read_record("r.csv", text.as_bytes(), RecordedInput::Torque, &SENSORS, &format)
    }

    #[test]
    fn a_common_name_beside_chosen_columns_counts_for_nothing() {
        let file = b"t,theta,v\n0,0,0\n0.1,0.1,6\n0.2,0.2,6\n0.3,0.3,6\n";
        let columns = |choices: &[&str]| TableFormat {
            columns: choices.iter().map(|choice| choice.parse().unwrap()).collect(),
            ..TableFormat::default()
        };
        let read = |choices: &[&str]| {
            let (recording, reading) =
                read_recording_as("r.csv", file, 1, &columns(choices)).unwrap();
            let channels: Vec<_> = recording.channels.iter().map(|(own, _)| *own).collect();
            (channels, reading.unread)
        };
        let (channels, unread) = read(&["time=t", "hub_angle=theta"]);
        assert_eq!(channels, [SimulatedChannel::HubAngle]);
        assert_eq!(unread.map(|(unread, _)| unread).as_deref(), Some("columns not read: 3 \"v\""));
        let (channels, _) = read(&["time=t", "hub_angle=theta", "velocity=v"]);
        assert_eq!(channels, [SimulatedChannel::HubAngle, SimulatedChannel::Velocity]);
    }

    #[test]
    fn columns_are_found_by_name_or_by_choice_with_their_units() {
        let text = "time;torque [N cm];tip_acceleration [cm/s^2];root_strain [um/m];n\n\
                    0,0;0;0;0;1\n0,1;1;2;3;1\n0,2;1;2;3;1\n0,3;1;2;3;1\n";
        let table = read(text, &[]).unwrap();
        assert_eq!(table.input, [0.0, 0.01, 0.01, 0.01]);
        assert_eq!(table.channels[0], [0.0, 0.02, 0.02, 0.02]);
        assert_eq!(table.units, [0.01, 1e-6]);
        let chosen = ["time=1", "torque=2", "tip_acceleration=3", "root_strain=4"];
        let table = read("0 0 0 0\n1 1 2 3\n2 1 2 3\n3 1 2 3\n", &chosen).unwrap();
        assert_eq!((table.grid.step_s, table.channels[1].clone()), (1.0, vec![0.0, 3.0, 3.0, 3.0]));
    }

    #[test]
    fn times_with_jitter_are_used_as_they_are() {
        let row = |k: i32| {
            let t = 0.1 * f64::from(k) + if k % 3 == 1 { 0.003 } else { 0.0 };
            format!("{t:.6},{:.9},{:.9},0\n", t * t, t.sin())
        };
        let rows: String = (0..50).map(row).collect();
        let text = "time,torque,tip_acceleration,root_strain\n".to_owned() + &rows;
        let table = read(&text, &[]).unwrap();
        assert!(table.reading.jitter().is_some());
        for (k, value) in table.input.iter().enumerate() {
            assert!((value - (table.grid.step_s * k as f64).powi(2)).abs() < 1e-8, "{k}: {value}");
        }
        let error = read(&text.replace("1.003000", "1.053000"), &[]).unwrap_err();
        assert!(error.to_string().starts_with("r.csv:3: time = 0.103 s, but must be"), "{error}");
    }

    #[test]
    fn a_missing_column_is_named() {
        let error = read("time,torque,root_strain\n0,0,0\n", &[]).unwrap_err();
        let must =
            "r.csv:1: columns = \"time,torque,root_strain\", but must include tip_acceleration";
        assert_eq!(error.to_string(), must);
    }
}
