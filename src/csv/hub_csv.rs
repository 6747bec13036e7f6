use crate::response::HubReference;

use super::header::{Header, check_names, find_column, find_time, names, refuse_missing};
use super::quantity::{HUB_MOTION, Quantity};
use super::samples::Samples;
use super::table_error::{Place, TableError};

/// Reads the hub motion that a feedback is to hold: `hub_angle`, and `hub_rate` where it is given,
/// as in the `hub_angle.csv` of `solve`. Other columns are not read.
///
/// ```
/// use flexlink::csv::read_hub_reference;
/// let file = b"time_s,hub_angle [deg],note\n0,0,\n1,90,\n2,180,\n3,180,\n";
/// let reference = read_hub_reference("hub_angle.csv", file)?;
/// assert_eq!(reference.angle_rad()[2], std::f64::consts::PI);
/// assert_eq!(reference.rate_rad_s(), None);
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names the file, and line and column where they are at fault.
pub fn read_hub_reference(name: &str, bytes: &[u8]) -> Result<HubReference, TableError> {
    let mut samples = Samples::read(name, bytes, read_hub_header)?;
    let time_s = samples.take(Quantity::Time).unwrap_or_default();
    let angle_rad = samples.take(Quantity::HubAngle).unwrap_or_default();
    let rate_rad_s = samples.take(Quantity::HubRate);
    HubReference::new(&time_s, angle_rad, rate_rad_s)
        .map_err(|error| samples.refuse_history(name, &error))
}

fn read_hub_header(fields: &[&str], place: Place) -> Result<Header, TableError> {
    check_names(fields, &HUB_MOTION, place)?;
    let time = find_time(fields, &HUB_MOTION, place)?;
    let angle = find_column(fields, Quantity::HubAngle, &HUB_MOTION, place)?.ok_or_else(|| {
        let hint = "hub_angle.csv of `flexlink solve` holds it".to_owned();
        refuse_missing(&names(fields), Quantity::HubAngle.word(), place).or_hint(hint)
    })?;
    let rate = find_column(fields, Quantity::HubRate, &HUB_MOTION, place)?;
    Ok(Header { width: fields.len(), headings: [time, angle].into_iter().chain(rate).collect() })
}
