use serde::de::Deserialize;

use super::document::located;
use super::error::{Fault, SpecError};
use super::measured_files::{
    DecayFile, RawDecay, RawMotor, RawRecord, RawResponse, RecordFile, ResponseFile,
};
use super::measured_values::{MeasuredOf, RawDamping, RawFrequency};
use super::tree::Node;
use super::value::{Angle, tables};
use crate::fit::{Measured, Motor};

/// The whole file of measured values, key by key.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct RawMeasurements {
    at: Option<Vec<Angle>>,
    #[serde(default, deserialize_with = "tables")]
    frequency: Vec<RawFrequency>,
    #[serde(default, deserialize_with = "tables")]
    damping: Vec<RawDamping>,
    #[serde(default, deserialize_with = "tables")]
    response: Vec<RawResponse>,
    #[serde(default, deserialize_with = "tables")]
    record: Vec<RawRecord>,
    #[serde(default, deserialize_with = "tables")]
    decay: Vec<RawDecay>,
    motor: Option<RawMotor>,
}

/// Content of a file of measured values.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredFile {
    /// Measured values.
    pub values: Vec<Measured>,
    /// Frequency responses in separate files.
    pub responses: Vec<ResponseFile>,
    /// Recorded histories in separate files.
    pub records: Vec<RecordFile>,
    /// Free decays in separate files.
    pub decays: Vec<DecayFile>,
    /// The motor at the hub.
    pub motor: Option<Motor>,
}

/// Reads the text of a file of measured values of an arm with this number of `links`, or of one link; errors call the
/// file `name`.
///
/// ```
/// use flexlink::spec::read_measurements;
/// let text = "[[frequency]]\nmode = 1\nvalue = '2.52 Hz'\nuncertainty = '0.02 Hz'\nhub = 'held'\n\
///             [[damping]]\nmode = 1\nratio = 0.013\nuncertainty = 0.002\n";
/// let measured = read_measurements("measured.toml", text, 1)?;
/// assert_eq!(measured.values.len(), 2);
/// # Ok::<(), flexlink::spec::SpecError>(())
/// ```
///
/// # Errors
/// [`SpecError`] names the line and the wrong value.
pub fn read_measurements(name: &str, text: &str, links: usize) -> Result<MeasuredFile, SpecError> {
    let tree = Node::document(name, text)?;
    let raw = RawMeasurements::deserialize(&tree).map_err(Fault::from);
    raw.and_then(|raw| convert(raw, links)).map_err(|fault| located(fault, &tree, (name, &[])))
}

fn convert(raw: RawMeasurements, links: usize) -> Result<MeasuredFile, Fault> {
    let of = MeasuredOf::new(links, raw.at)?;
    let of_one_link = [
        ("motor", raw.motor.is_some()),
        ("response", !raw.response.is_empty()),
        ("record", !raw.record.is_empty()),
    ];
    for (key, _) in of_one_link.into_iter().filter(|(_, is_given)| *is_given) {
        of.refuse_for_arms(key, "only [[frequency]], [[damping]] and [[decay]]")?;
    }
    let values = each("frequency", raw.frequency, |raw, path| raw.convert(path, &of))?;
    let ratios = each("damping", raw.damping, |raw, path| raw.convert(path, &of))?;
    let values = [values, ratios].concat();
    let decays = each("decay", raw.decay, |raw, path| raw.convert(path, &of))?;
    let motor = raw.motor.map(RawMotor::convert).transpose()?;
    let has_motor = motor.is_some();
    let responses = each("response", raw.response, |raw, path| raw.convert(path, has_motor))?;
    let records = each("record", raw.record, |raw, path| raw.convert(path, has_motor))?;
    if values.is_empty() && responses.is_empty() && records.is_empty() && decays.is_empty() {
        let hint = if of.is_arm() {
            "[[frequency]] with mode, value, joints and at, [[damping]] with mode, ratio, joints and at, [[decay]] \
             with file, mode, joints and at"
        } else {
            "[[frequency]] with mode, value and hub, [[damping]] with mode and ratio, [[decay]] with file, mode and hub, \
             [[response]] with file and transfer, [[record]] with file, input and channel"
        };
        let message = "the file has no measurements, but needs at least one";
        return Err(Fault::new("", message).hinting(hint.to_owned()));
    }
    Ok(MeasuredFile { values, responses, records, decays, motor })
}

/// Converts the tables of a key, each with its path.
fn each<R, T>(
    key: &str,
    raw: Vec<R>,
    convert: impl Fn(R, &str) -> Result<T, Fault>,
) -> Result<Vec<T>, Fault> {
    let numbered = raw.into_iter().enumerate();
    numbered.map(|(number, raw)| convert(raw, &format!("{key}.{number}"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_is_refused_with_its_line() {
        for (text, expected) in [
            ("", "m.toml: the file has no measurements, but needs at least one"),
            (
                "[[frequency]]\nmode = 1\nvalue = 0",
                "m.toml:3: frequency.0.value = 0, but must be above 0",
            ),
            (
                "[[frequency]]\nvalue = 1",
                "m.toml:1: frequency.0 has neither mode nor zero, but must have one of them",
            ),
            ("[[frequency]]\nmode = 1", "m.toml:1: frequency.0.value is missing"),
            ("[[frequenzy]]\nmode = 1", "m.toml:1: unknown key `frequenzy`"),
            (
                "[[damping]]\nmode = 1\npeaks = [1, 2]",
                "m.toml:3: damping.0.peaks must be two or more peaks of one sign, each below the one before",
            ),
        ] {
            assert_eq!(read_measurements("m.toml", text, 1).unwrap_err().to_string(), expected);
        }
    }
}
