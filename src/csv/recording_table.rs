//! A recording of a link in motion, to be compared with a simulation.

use super::columns::{Columns, Header};
use super::format::{Reading, TableFormat};
use super::heading::{
    ACCELERATION, DEFLECTION, DISPLACEMENT, HUB_ANGLE, HUB_RATE, Quantity, TIME, TIP, TORQUE,
    VELOCITY, Vocabulary, find, names, refuse_missing, require,
};
use super::motion_columns::unread;
use super::place::{BY_HEADINGS, TableError};
use super::samples::Samples;
use crate::result::{ChannelRecording, SimulatedChannel};

/// All that a simulation gives.
const CHANNELS: Vocabulary = Vocabulary {
    quantities: &[
        TIME,
        HUB_ANGLE,
        HUB_RATE,
        TIP,
        DISPLACEMENT,
        VELOCITY,
        ACCELERATION,
        DEFLECTION,
        TORQUE,
    ],
    prefix: "tip_",
    example: "time,hub_angle",
    choice: Some("rename one of them"),
    by_option: "",
};

/// The channel of each quantity.
const OF_QUANTITY: [(Quantity, SimulatedChannel); 8] = [
    (HUB_ANGLE, SimulatedChannel::HubAngle),
    (HUB_RATE, SimulatedChannel::HubRate),
    (TIP, SimulatedChannel::Tip),
    (DISPLACEMENT, SimulatedChannel::Tip),
    (VELOCITY, SimulatedChannel::Velocity),
    (ACCELERATION, SimulatedChannel::Acceleration),
    (DEFLECTION, SimulatedChannel::TipDeflection),
    (TORQUE, SimulatedChannel::Torque),
];

/// Reads a recording: `time`, and any of `hub_angle`, `hub_rate`, `tip` or `displacement`, `velocity` and
/// `acceleration` of the tip, `tip_deflection` and `torque`. Times must increase; they need not be uniform.
///
/// ```
/// use flexlink::csv::read_recording;
/// use flexlink::result::SimulatedChannel;
/// let file = b"Time (ms),hub_angle [deg],tip [mm]\n0,0,0\n1,1,0\n2,3,1\n3,6,3\n";
/// let (recording, _) = read_recording("rig.csv", file)?;
/// let (channel, samples) = &recording.channels[1];
/// assert_eq!((*channel, samples[3], recording.time_s[3]), (SimulatedChannel::Tip, 0.003, 0.003));
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names the file, and line and column where they are at fault.
pub fn read_recording(name: &str, bytes: &[u8]) -> Result<(ChannelRecording, Reading), TableError> {
    let mut samples = Samples::read(name, bytes, &TableFormat::default(), channel_columns)
        .map_err(|error| error.of_named_file(BY_HEADINGS))?;
    let time_s = samples.take(TIME).unwrap_or_default();
    let taken = OF_QUANTITY.into_iter();
    let taken = taken.filter_map(|(quantity, channel)| Some((channel, samples.take(quantity)?)));
    let channels = taken.collect();
    Ok((ChannelRecording { time_s, channels }, samples.reading))
}

fn channel_columns(header: Header) -> Result<(Columns, Reading), TableError> {
    let Header { fields, place, .. } = header;
    let columns = Columns::find_all(&CHANNELS, header)?;
    let headings = &columns.headings;
    require(headings, TIME, fields, place)?;
    if let (Some(tip), Some(displacement)) = (find(headings, TIP), find(headings, DISPLACEMENT)) {
        let (first, second) =
            if tip.index < displacement.index { (tip, displacement) } else { (displacement, tip) };
        let must =
            format!("must not be given with {}: they are two names of one thing", first.named());
        return Err(place
            .refuse_column(second.index, &second.name, must)
            .with_hint("rename one of them".to_owned()));
    }
    if headings.len() < 2 {
        let words = CHANNELS.quantities[1..].iter().map(|quantity| quantity.word);
        let wanted = format!("one of {}", words.collect::<Vec<_>>().join(", "));
        return Err(refuse_missing(&names(fields), &wanted, place));
    }
    let (unread, hint) = unread(&columns, fields, &CHANNELS, "a simulation has no such channel");
    Ok((columns, Reading { unread, hint, ..Reading::default() }))
}
