//! Measured frequency responses.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use super::columns::Header;
use super::format::{Reading, TableFormat};
use super::heading::{FREQUENCY, GAIN, IMAGINARY, PHASE, Quantity, REAL, Spelling, Vocabulary};
use super::input::{Place, TableError, quoted};
use super::rows::read_table_as;
use super::unit_name::split_any_unit;
use crate::compare::{Cell, Table, TableColumn};
use crate::numeric::magnitude;
use crate::text::significant;

/// Names of a frequency response.
const RESPONSE: Vocabulary =
    Vocabulary { quantities: &[FREQUENCY, REAL, IMAGINARY, GAIN, PHASE], ..Vocabulary::NONE };

/// Remedy for columns that are not found, for hints.
const BY_KEYS: &str = "columns = [\"frequency=1\", \"real=2\", \"imaginary=3\"] chooses columns by number or heading; \
                       skip = 3 leaves lines out";

/// Factor from decibels to powers of ten.
const DECIBELS: f64 = 0.05;

/// Largest difference between a value below 0 Hz and the conjugate of the value above, over its size.
const CONJUGATE: f64 = 0.01;

/// Largest relative difference of frequencies that are equal except for sign and rounding.
const SAME_FREQUENCY: f64 = 1e-4;

/// A column of a measured response, with the factor from its numbers to SI.
struct Found<'a> {
    column: &'a TableColumn,
    factor: f64,
    /// Factor of the user on the numbers, before their unit.
    scale: f64,
    has_unit: bool,
}

/// A measured frequency response.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseTable {
    /// Frequencies in Hz, above 0.
    pub frequencies_hz: Vec<f64>,
    /// Value at each frequency.
    pub values: Vec<Complex64>,
    /// Guesses and ignored rows.
    pub reading: Reading,
}

/// Reads a measured frequency response with the user's options for its form.
///
/// Columns are `frequency` and either `real` and `imaginary`, or `gain` and `phase`; units in brackets or parentheses
/// may be Hz, kHz, rad/s, dB, deg and rad. Numbers without a unit are in SI, phases in radians; phases that cannot be
/// radians are degrees. Other columns are ignored. Rows below 0 Hz, as in a two-sided spectrum, are compared with the
/// conjugates of those above, and removed.
///
/// ```
/// use flexlink::csv::read_frequency_response;
/// let file = b"frequency [Hz],gain,phase [deg]\n1,2,90\n2,1,180\n";
/// let table = read_frequency_response("frf.csv", file, &Default::default())?;
/// assert_eq!(table.frequencies_hz, [1.0, 2.0]);
/// assert!((table.values[0].im - 2.0).abs() < 1e-15);
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names a missing column, the line of a field that is not finite, a row at 0 Hz, and a row below 0 Hz
/// that is no conjugate of the row above.
pub fn read_frequency_response(
    name: &str,
    bytes: &[u8],
    format: &TableFormat,
) -> Result<ResponseTable, TableError> {
    let (table, mut said) = read_table_as(name, bytes, format)?;
    let place = Place { file: name, line: None };
    let hertz = |unit: &str| match unit {
        "" | "hz" => Some(1.0),
        "khz" => Some(1000.0),
        "rad/s" => Some(0.5 / PI),
        _ => None,
    };
    // SI as in the transfers; decibels are 20 times its decimal logarithm.
    let si = |unit: &str| match unit {
        "" | "rad/(n m)" | "rad/n/m" | "1/(n m s)" | "1/(kg m)" | "1" | "1/n" | "1/(n m)"
        | "rad/v" | "rad/(s v)" | "rad/s/v" | "m/v" | "m/(s^2 v)" | "m/s^2/v" | "1/v" => Some(1.0),
        _ => None,
    };
    let decibels = |unit: &str| if unit == "db" { Some(DECIBELS) } else { si(unit) };
    let radians = |unit: &str| match unit {
        "deg" | "°" => Some(DEGREE),
        "" | "rad" => Some(1.0),
        _ => None,
    };
    let names: Vec<&str> = table.names().collect();
    let header = Header { fields: &names, format, place };
    for choice in &format.columns {
        header.check_quantity(&RESPONSE, choice.quantity, "columns")?;
    }
    for scale in &format.scales {
        header.check_quantity(&RESPONSE, scale.quantity, "scale")?;
    }
    let find = |quantity: Quantity, factor: &dyn Fn(&str) -> Option<f64>| {
        let found = found(&table, header, quantity, factor);
        found.map_err(|error| error.of_named_file(BY_KEYS))
    };
    let must = "must include frequency, and real and imaginary or gain and phase";
    let columns = || table.names().collect::<Vec<_>>().join(",");
    let missing =
        || place.refuse("columns", quoted(&columns()), must).with_hint(BY_KEYS.to_owned());
    let frequencies = find(FREQUENCY, &hertz)?.ok_or_else(missing)?;
    let real = find(REAL, &si)?.zip(find(IMAGINARY, &si)?);
    let polar = find(GAIN, &decibels)?.zip(find(PHASE, &radians)?);
    let is_polar = polar.is_some();
    let rows = table.lines.len();
    let frequencies_hz = numbers(&table, &frequencies, place)?;
    let at_rest = frequencies_hz.iter().position(|hertz| *hertz == 0.0);
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
            let has_unit = phase.has_unit;
            let mut phase = numbers(&table, &phase, place)?;
            if !has_unit {
                let row =
                    |k| PolarRow { hertz: frequencies_hz[k], gain: sizes[k], phase: phase[k] };
                let above = (0..rows).map(row).filter(|row| row.hertz > 0.0);
                let (radians, guess) = bare_phase(above.collect());
                phase = phase.into_iter().map(|phase| phase * radians).collect();
                said.push(guess);
            }
            let turned = |k: usize| Complex64::new(libm::cos(phase[k]), libm::sin(phase[k]));
            (0..rows).map(|k| turned(k) * sizes[k]).collect()
        }
        _ => return Err(missing()),
    };
    let read = if is_polar { [FREQUENCY, GAIN, PHASE] } else { [FREQUENCY, REAL, IMAGINARY] };
    if let Some(scale) = format.scales.iter().find(|scale| !read.contains(&scale.quantity)) {
        let must =
            format!("must be one of the columns read: {}", read.map(|own| own.word).join(", "));
        let error = place.refuse("--scale", scale.quantity.word, must);
        return Err(error.of_named_file(BY_KEYS));
    }
    let mut found = ResponseTable { frequencies_hz, values, reading: Reading::default() };
    said.extend(found.leave_out_rows_below_0_hz(|row, must| {
        let place = Place { line: Some(table.lines[row]), ..place };
        let hint = "leave out the rows below 0 Hz, or those above if these are wrong";
        place.refuse("frequency", table_text(&frequencies, row), must).with_hint(hint.to_owned())
    })?);
    found.reading.found = said;
    Ok(found)
}

impl ResponseTable {
    /// Removes the rows below 0 Hz and returns a note on them; refuses a row that is no conjugate of the row above. It
    /// also removes a row without one above, such as at half the sampling rate.
    fn leave_out_rows_below_0_hz(
        &mut self,
        refuse: impl Fn(usize, &str) -> TableError,
    ) -> Result<Option<String>, TableError> {
        let rows = || self.frequencies_hz.iter().copied().zip(&self.values).enumerate();
        let mut above: Vec<_> = rows().filter(|(_, (hertz, _))| *hertz > 0.0).collect();
        above.sort_by(|a, b| a.1.0.total_cmp(&b.1.0));
        let (mut below, mut held) = (0, 0);
        for (row, (hertz, value)) in rows().filter(|(_, (hertz, _))| *hertz < 0.0) {
            let next = above.partition_point(|(_, (above, _))| *above < -hertz);
            let near = [next.checked_sub(1), Some(next)].into_iter().flatten();
            let near = near.filter_map(|k| above.get(k));
            let off = |above: f64| (above + hertz).abs();
            let nearest = near.min_by(|a, b| off(a.1.0).total_cmp(&off(b.1.0)));
            below += 1;
            let Some((_, (_, partner))) =
                nearest.filter(|(_, (own, _))| off(*own) <= SAME_FREQUENCY * own)
            else {
                continue;
            };
            held += 1;
            if magnitude(value - partner.conj()) > CONJUGATE * magnitude(**partner) {
                return Err(refuse(row, "must have the conjugate of the value above 0 Hz"));
            }
        }
        if below > 0 && held == 0 {
            let first = rows().find(|(_, (hertz, _))| *hertz < 0.0).map_or(0, |(row, _)| row);
            return Err(refuse(first, "must be above 0, or have a row at +f, too"));
        }
        let pairs = self.frequencies_hz.iter().copied().zip(self.values.iter().copied());
        (self.frequencies_hz, self.values) = pairs.filter(|(hertz, _)| *hertz > 0.0).unzip();
        Ok((below > 0).then(|| {
            format!("without its {below} rows below 0 Hz, {held} of them conjugates of rows above")
        }))
    }
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

/// The one column with a name of a quantity.
fn named(header: Header, quantity: Quantity) -> Result<Option<usize>, TableError> {
    let lower: Vec<String> = header.fields.iter().map(|field| field.to_lowercase()).collect();
    let lower: Vec<&str> = lower.iter().map(String::as_str).collect();
    let found = RESPONSE.columns((&lower, header.place), |own, _, _| own == quantity)?;
    Ok(found.first().map(|(_, index, _)| *index))
}

/// The column of a quantity, by the user's choice or its name, and the factor of its unit.
fn found<'a>(
    table: &'a Table,
    header: Header,
    quantity: Quantity,
    factor: &dyn Fn(&str) -> Option<f64>,
) -> Result<Option<Found<'a>>, TableError> {
    let chosen = header.format.columns.iter().find(|choice| choice.quantity == quantity);
    let index = match chosen {
        Some(choice) => Some(header.index_of(quantity, &choice.column)?),
        None => named(header, quantity)?,
    };
    let Some(column) = index.map(|index| &table.columns[index]) else { return Ok(None) };
    let lower = column.name().to_lowercase();
    let (name, unit) = split_any_unit(&lower);
    let scale = header.format.scales.iter().find(|scale| scale.quantity == quantity);
    let is_suffixed = RESPONSE.spelling(&lower, quantity) == Some(Spelling::Suffixed);
    let has_unit = unit.is_some() || is_suffixed || scale.is_some();
    let unit = unit.unwrap_or_default();
    let must = "must be one that the column may have: Hz, kHz, rad/s; dB or SI; deg or rad";
    let unknown = || header.place.refuse(format!("unit of {name}"), quoted(unit), must);
    let factor = factor(unit).ok_or_else(unknown)?;
    let scale = scale.map_or(1.0, |scale| scale.factor);
    Ok(Some(Found { column, factor, scale, has_unit }))
}

fn numbers(table: &Table, found: &Found, place: Place) -> Result<Vec<f64>, TableError> {
    let number = |(row, line): (usize, &u64)| match found.column.cell(row) {
        Cell::Number(number) if number.is_finite() => Ok(number * found.scale * found.factor),
        _ => {
            let place = Place { line: Some(*line), ..place };
            let text = found.column.text(row);
            Err(place.refuse(found.column.name(), quoted(&text), "must be a finite number"))
        }
    };
    table.lines.iter().enumerate().map(number).collect()
}

/// Margin for rounding in rad.
const ROUNDING: f64 = 0.05;

/// Radians in a degree.
const DEGREE: f64 = PI / 180.0;

/// A row of a response above 0 Hz.
#[derive(Debug, Clone, Copy)]
struct PolarRow {
    hertz: f64,
    gain: f64,
    /// Phase as written.
    phase: f64,
}

/// Factor from phases without a unit to radians, and a note on it.
///
/// Phases are radians, as in SI, unless this is impossible. Wrapped radians stay within a turn, and unwrapped radians
/// change by at most half a turn from one frequency to the next. If unwrapped radians are possible, the gain decides: a
/// resonance, a delay of a fraction of its period and noise turn a response about as much as they change the logarithm
/// of its gain. Degrees mistaken for radians turn it 57 times as much; the bound is the geometric mean of 1 and 57.
fn bare_phase(mut rows: Vec<PolarRow>) -> (f64, String) {
    rows.sort_by(|a, b| a.hertz.total_cmp(&b.hertz));
    let most = rows.iter().map(|row| row.phase.abs()).fold(0.0, f64::max);
    let steps = || rows.windows(2).map(|pair| (pair[1].phase - pair[0].phase).abs());
    let step = steps().fold(0.0, f64::max);
    let turned: f64 = steps().sum();
    let changes = rows.windows(2).map(|pair| libm::log(pair[1].gain / pair[0].gain).abs());
    let changed: f64 = changes.sum();
    let why = if most <= TAU + ROUNDING {
        None
    } else if step > PI + ROUNDING {
        let [most, step] = [most, step].map(|number| significant(number, 3));
        Some(format!("radians up to {most} do not turn by {step} between two rows"))
    } else if turned * DEGREE.sqrt() > changed {
        Some("radians would turn far more than the gain changes".to_owned())
    } else {
        None
    };
    match why {
        None => {
            (1.0, "phase in radians: its heading names no unit, as phase [deg] does".to_owned())
        }
        Some(why) => (DEGREE, format!("phase in degrees: its heading names no unit, and {why}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_response_is_read_in_any_form() {
        let row = |k: u32| (f64::from(k), 1.0 / f64::from(k), -f64::from(k));
        let rows = |row_text: &dyn Fn((f64, f64, f64)) -> String| {
            (1..9).map(|k| row_text(row(k)) + "\n").collect::<String>()
        };
        let comma = rows(&|(f, re, im)| format!("{f};{re};{im}").replace('.', ","));
        let kilo = rows(&|(f, re, im)| format!("{} {} {}", f / 1e3, 1e3 * re, 1e3 * im));
        let numbered = || TableFormat {
            columns: ["frequency=1", "real=2", "imaginary=3"]
                .map(|own| own.parse().unwrap())
                .into(),
            ..TableFormat::default()
        };
        let scales = ["frequency=1e3", "real=1e-3", "imaginary=1e-3"];
        let scaled =
            TableFormat { scales: scales.map(|own| own.parse().unwrap()).into(), ..numbered() };
        let skipped = TableFormat { skip: 1, ..numbered() };
        for (text, format) in [
            (format!("Freq (Hz);re;im\n{comma}"), TableFormat::default()),
            (format!("Analyser 5;x\nf;Re;Im\nHz;;\n{comma}"), TableFormat::default()),
            (format!("any\n{comma}"), skipped),
            (kilo, scaled),
        ] {
            let read = read_frequency_response("f.csv", text.as_bytes(), &format).unwrap();
            assert_eq!(read.values.len(), 8, "{text}");
            for (k, value) in (1..).zip(&read.values) {
                let (f, re, im) = row(k);
                let hertz = read.frequencies_hz[k as usize - 1];
                assert!((hertz - f).abs() < 1e-12 * f, "{text}: {hertz}");
                assert!((value - Complex64::new(re, im)).norm() < 1e-12 * im.abs(), "{text}");
            }
        }
    }

    /// Phases in rad and gains of two resonances with a zero between them and a delay, from 1 to 20 Hz.
    fn rows(count: u32, delay_s: f64) -> Vec<PolarRow> {
        let row = |k: u32| {
            let hertz = 1.0 + 19.0 * f64::from(k) / f64::from(count - 1);
            let s = Complex64::new(0.0, hertz);
            let pair = |own: f64| s * s + 0.04 * own * s + own * own;
            let turned = Complex64::cis(-TAU * hertz * delay_s);
            let value = pair(7.0) / (s * s * pair(5.0) * pair(12.0)) * turned;
            PolarRow { hertz, gain: value.norm(), phase: value.arg() }
        };
        (0..count).map(row).collect()
    }

    fn unwrapped(mut rows: Vec<PolarRow>) -> Vec<PolarRow> {
        for k in 1..rows.len() {
            let step = rows[k].phase - rows[k - 1].phase;
            rows[k].phase -= TAU * (step / TAU).round();
        }
        rows
    }

    fn is_degrees(rows: Vec<PolarRow>) -> bool {
        bare_phase(rows).0 < 1.0
    }

    /// Wrapped and unwrapped, with few rows and with so many that no step of the degrees exceeds π, in any order.
    #[test]
    fn radians_and_degrees_are_told_apart() {
        for count in [12, 60, 400, 5000] {
            for delay_s in [0.0, 0.02, 0.2] {
                for mut own in [rows(count, delay_s), unwrapped(rows(count, delay_s))] {
                    own.reverse();
                    let degrees =
                        own.iter().map(|row| PolarRow { phase: row.phase / DEGREE, ..*row });
                    assert!(is_degrees(degrees.collect()), "{count} {delay_s}");
                    assert!(!is_degrees(own), "{count} {delay_s}");
                }
            }
        }
    }

    /// Ambiguous numbers are SI; the note names the unit.
    #[test]
    fn what_may_be_both_is_radians() {
        let own = rows(60, 0.0).into_iter().filter(|row| row.hertz < 3.0);
        let degrees: Vec<_> = own.map(|row| PolarRow { phase: row.phase + 3.0, ..row }).collect();
        let (factor, said) = bare_phase(degrees);
        assert_eq!(factor.to_bits(), 1.0_f64.to_bits());
        assert!(said.contains("radians") && said.contains("phase [deg]"), "{said}");
    }
}
