//! Free decays.

use super::columns::{Columns, Header};
use super::format::{ColumnScale, Reading, TableFormat};
use super::heading::{
    ACCELERATION, DEFLECTION, DISPLACEMENT, HUB_ANGLE, HUB_RATE, Heading, Measure, Quantity,
    ROOT_STRAIN, TIME, TIP, VELOCITY, VOLTAGE, Vocabulary, find, names, quantity, refuse_missing,
    require,
};
use super::outliers::Judged;
use super::record::{shown, word_of};
use super::rows::{Place, TableError};
use super::samples::{MIN_SAMPLES, Samples, refuse_samples};
use crate::fit::DecaySamples;
use crate::model::Sensor;
use crate::numeric::{Dimension, TimeGrid};
use crate::recording::Change;

/// The only column besides the time.
const SIGNAL: Quantity = quantity("signal", "_1", Dimension::NONE, ["1", "1"]);

/// All quantities that may vibrate, in any unit.
const DECAY: Vocabulary = Vocabulary {
    quantities: &[
        TIME,
        HUB_ANGLE,
        HUB_RATE,
        TIP,
        DISPLACEMENT,
        VELOCITY,
        ACCELERATION,
        DEFLECTION,
        ROOT_STRAIN,
        VOLTAGE,
    ],
    prefix: "tip_",
    example: "time,tip_deflection",
    choice: Some("rename one of them, or choose with columns"),
    by_option: "columns = [\"time=1\", \"deflection=2\"] says which column is what",
};

/// Hint at the keys of a decay.
const OF_DECAY: &str = "sensor = \"tip_acceleration\" names the column that vibrates; columns = [\"time=1\", \
                        \"deflection=2\"] chooses columns by number or heading; skip = 3 leaves lines out";

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
/// Those of [`read_record`](super::read_record); also several changing columns, or no changing column.
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
    samples.reading.doubt = judged.doubt(&samples.lines[first..]);
    let uniform_s = samples.make_uniform(time_s[within].to_vec(), vec![column]);
    let grid = TimeGrid::through(&uniform_s).map_err(|error| {
        let lines = &samples.lines[first..];
        refuse_samples(name, lines, Some(error.sample), &error, Some(error.hint()))
    })?;
    let (start_s, step_s) = (uniform_s[0], grid.step_s);
    let (name, samples_of) = (name.to_owned(), std::mem::take(column));
    let column = words[0].clone();
    let decay = DecaySamples { name, column, start_s, step_s, samples: samples_of };
    Ok((decay, samples.reading))
}

/// Columns of a decay: the time and quantities that may vibrate, or else the only other column.
fn decaying(header: Header, wanted: Option<Quantity>) -> Result<(Columns, Reading), TableError> {
    let Header { fields, place, .. } = header;
    let mut columns = Columns::find_all(&DECAY, header)?;
    require(&columns.headings, TIME, fields, place)?;
    if let ([_], None, [only]) = (&columns.headings[..], wanted, &columns.unread[..]) {
        let measure = Measure { factor: Some(1.0), ..Measure::default() };
        let heading = Heading::of(*only, fields[*only], SIGNAL, false, measure, place)?;
        columns.headings.push(heading);
    }
    let sensors = columns.headings.iter_mut().filter(|heading| heading.quantity != TIME);
    sensors.for_each(|heading| "any unit".clone_into(&mut heading.unit_text));
    if let Some(wanted) = wanted {
        if find(&columns.headings, wanted).is_none() {
            let missing = refuse_missing(&names(fields), &word_of(wanted), place);
            return Err(missing.or_hint(OF_DECAY.to_owned()));
        }
        columns.headings.retain(|heading| [TIME, wanted].contains(&heading.quantity));
    }
    Ok((columns, Reading::default()))
}
