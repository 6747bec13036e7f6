use crate::response::Torque;

use super::quantity::Quantity;
use super::samples::Samples;
use super::table_error::TableError;
use super::torque_header::read_torque_header;

/// Reads a torque over time: a row that names the columns, then a row for every sample.
///
/// Without `column` the torque is the column `torque`, `torque_n_m`, `hub_torque` or
/// `hub_torque_n_m`; with it, the column of that name, with or without its unit in brackets. Its
/// unit is N m unless one follows the name in brackets. Of all columns only the time and the torque
/// are read.
///
/// ```
/// use flexlink::csv::read_torque_table;
/// let file = b"time [ms],motor [N cm],state\n0,0,idle\n1,50,run\n2,50,run\n3,0,idle\n";
/// let torque = read_torque_table("lab.csv", file, Some("motor"))?;
/// assert_eq!(torque.torque_n_m(), [0.0, 0.5, 0.5, 0.0]);
/// assert_eq!(torque.grid().step_s, 0.001);
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names the file, and line and column where they are at fault.
pub fn read_torque_table(
    name: &str,
    bytes: &[u8],
    column: Option<&str>,
) -> Result<Torque, TableError> {
    let mut samples =
        Samples::read(name, bytes, |fields, place| read_torque_header(fields, column, place))?;
    let time_s = samples.take(Quantity::Time).unwrap_or_default();
    let torque_n_m = samples.take(Quantity::Torque).unwrap_or_default();
    Torque::new(&time_s, torque_n_m).map_err(|error| samples.refuse_history(name, &error))
}
