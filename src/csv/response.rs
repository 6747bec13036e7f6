use std::f64::consts::PI;

use num_complex::Complex64;

use super::rows::{Place, TableError, quoted};
use super::samples::read_table;
use super::unit_name::split_any_unit;
use crate::compare::{Cell, Table, TableColumn};

/// Factor of decibels to powers of ten.
const DECIBELS: f64 = 0.05;

/// A column of a measured response, with the factor that makes SI of its numbers.
struct Found<'a> {
    column: &'a TableColumn,
    factor: f64,
}

/// Reads a measured frequency response: the frequencies in Hz and the complex values.
///
/// Columns are `frequency` and either `real` and `imaginary`, or `gain` and `phase`; units in brackets or
/// parentheses may be Hz, kHz, rad/s, dB, deg and rad. Without unit a gain is in SI, a phase in degrees.
/// Other columns are left.
///
/// ```
/// use flexlink::csv::read_frequency_response;
/// let file = b"frequency [Hz],gain,phase [deg]\n1,2,90\n2,1,180\n";
/// let (frequencies_hz, values) = read_frequency_response("frf.csv", file)?;
/// assert_eq!(frequencies_hz, [1.0, 2.0]);
/// assert!((values[0].im - 2.0).abs() < 1e-15);
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names the column that is missing, and the line of a field that is no finite number.
pub fn read_frequency_response(
    name: &str,
    bytes: &[u8],
) -> Result<(Vec<f64>, Vec<Complex64>), TableError> {
    let table = read_table(name, bytes)?;
    let place = Place { file: name, line: None };
    let hertz = |unit: &str| match unit {
        "" | "hz" => Some(1.0),
        "khz" => Some(1000.0),
        "rad/s" => Some(0.5 / PI),
        _ => None,
    };
    // SI as the transfers have it; decibels are 20 lg of it.
    let si = |unit: &str| match unit {
        "" | "rad/(n m)" | "rad/n/m" | "1/(n m s)" | "1/(kg m)" | "1" | "1/n" | "1/(n m)" => {
            Some(1.0)
        }
        "rad/v" | "rad/(s v)" | "rad/s/v" | "m/v" | "m/(s^2 v)" | "m/s^2/v" | "1/v" => Some(1.0),
        _ => None,
    };
    let decibels = |unit: &str| if unit == "db" { Some(DECIBELS) } else { si(unit) };
    let radians = |unit: &str| match unit {
        "" | "deg" | "°" => Some(PI / 180.0),
        "rad" => Some(1.0),
        _ => None,
    };
    let find =
        |names: &[&str], factor: &dyn Fn(&str) -> Option<f64>| found(&table, names, factor, place);
    let must = "must include frequency, and real and imaginary or gain and phase";
    let columns = || table.names().collect::<Vec<_>>().join(",");
    let missing = || place.refuse("columns", quoted(&columns()), must);
    let frequencies = find(&["frequency", "frequency_hz", "f"], &hertz)?.ok_or_else(missing)?;
    let real = find(&["real", "re"], &si)?.zip(find(&["imaginary", "imag", "im"], &si)?);
    let polar = find(&["gain", "magnitude"], &decibels)?.zip(find(&["phase"], &radians)?);
    let rows = table.lines.len();
    let frequencies_hz = numbers(&table, &frequencies, place)?;
    let at_rest = frequencies_hz.iter().position(|hertz| *hertz <= 0.0);
    if let Some(row) = at_rest {
        let place = Place { line: Some(table.lines[row]), ..place };
        let hint = "remove the row at 0 Hz: a link on a free hub has no response there";
        let error = place.refuse("frequency", table_text(&frequencies, row), "must be above 0");
        return Err(error.with_hint(hint.to_owned()));
    }
    let values: Vec<Complex64> = match (real, polar) {
        (Some((re, im)), None) => {
            let [re, im] = [numbers(&table, &re, place)?, numbers(&table, &im, place)?];
            (0..rows).map(|k| Complex64::new(re[k], im[k])).collect()
        }
        (None, Some((gain, phase))) => {
            let sizes = gains(&table, &gain, place)?;
            let phase = numbers(&table, &phase, place)?;
            let turned = |k: usize| Complex64::new(libm::cos(phase[k]), libm::sin(phase[k]));
            (0..rows).map(|k| turned(k) * sizes[k]).collect()
        }
        _ => return Err(missing()),
    };
    Ok((frequencies_hz, values))
}

fn table_text(found: &Found, row: usize) -> String {
    quoted(&found.column.text(row))
}

/// Gains above 0, from numbers or decibels.
fn gains(table: &Table, found: &Found, place: Place) -> Result<Vec<f64>, TableError> {
    let is_decibel = found.factor.to_bits() == DECIBELS.to_bits();
    let gain = |number: f64| if is_decibel { libm::exp10(number) } else { number };
    let gains: Vec<f64> = numbers(table, found, place)?.into_iter().map(gain).collect();
    match gains.iter().position(|gain| *gain <= 0.0) {
        Some(row) => {
            let place = Place { line: Some(table.lines[row]), ..place };
            Err(place
                .refuse("gain", table_text(found, row), "must be above 0")
                .with_hint("a gain in decibels has the heading gain [dB]".to_owned()))
        }
        None => Ok(gains),
    }
}

/// The column of one of these names, in any case, and the factor of its unit.
fn found<'a>(
    table: &'a Table,
    names: &[&str],
    factor: &dyn Fn(&str) -> Option<f64>,
    place: Place,
) -> Result<Option<Found<'a>>, TableError> {
    for column in &table.columns {
        let lower = column.name().to_lowercase();
        let (name, unit) = split_any_unit(&lower);
        let unit = unit.unwrap_or_default();
        if names.contains(&name) {
            let must = "must be one that the column may have: Hz, kHz, rad/s; dB or SI; deg or rad";
            let unknown = || place.refuse(format!("unit of {name}"), quoted(unit), must);
            let factor = factor(unit).ok_or_else(unknown)?;
            return Ok(Some(Found { column, factor }));
        }
    }
    Ok(None)
}

fn numbers(table: &Table, found: &Found, place: Place) -> Result<Vec<f64>, TableError> {
    let number = |(row, line): (usize, &u64)| match found.column.cell(row) {
        Cell::Number(number) if number.is_finite() => Ok(number * found.factor),
        _ => {
            let place = Place { line: Some(*line), ..place };
            let text = found.column.text(row);
            Err(place.refuse(found.column.name(), quoted(&text), "must be a finite number"))
        }
    };
    table.lines.iter().enumerate().map(number).collect()
}
