use std::io::{self, Write};

use rayon::prelude::*;

use crate::numeric::ThinnedGrid;

use super::number::{Digits, NumberFormat};
use super::time_format::time_format;

/// Rows formatted by one thread at a time.
const BLOCK_ROWS: usize = 512;
/// Blocks held in memory before they are written.
const BLOCKS_AT_ONCE: usize = 64;

/// One column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column<'a> {
    /// Heading: the word and its unit, `torque_n_m`.
    pub name: String,
    /// One value a row.
    pub values: &'a [f64],
}

/// Columns of one unit, which share their peak and so their number of decimals.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnGroup<'a> {
    /// The columns, from the left.
    pub columns: Vec<Column<'a>>,
}

impl ColumnGroup<'_> {
    /// Largest absolute value of all columns.
    fn peak(&self) -> f64 {
        let values = self.columns.iter().flat_map(|column| column.values);
        values.fold(0.0, |peak, value| peak.max(value.abs()))
    }
}

/// Writes a table over time: a header, then one row a sample, `time_s` first.
///
/// Rows are formatted in parallel; the bytes do not depend on the number of threads.
///
/// # Errors
/// Those of `out`.
///
/// # Panics
/// If a column has not as many values as there are times.
pub fn write_csv(
    out: &mut (impl Write + ?Sized),
    time: &ThinnedGrid,
    groups: &[ColumnGroup],
    digits: Digits,
) -> io::Result<()> {
    write_timed(out, "time_s", &|k| time.time_s(k), time.len(), groups, digits)
}

/// Writes a table of `rows` rows over times in s under a heading of their own.
pub(super) fn write_timed(
    out: &mut (impl Write + ?Sized),
    heading: &str,
    time_s: &(impl Fn(usize) -> f64 + Sync),
    rows: usize,
    groups: &[ColumnGroup],
    digits: Digits,
) -> io::Result<()> {
    let columns = formatted(groups, digits);
    for (column, _) in &columns {
        assert_eq!(column.values.len(), rows, "{}", column.name);
    }
    let names = columns.iter().map(|(column, _)| column.name.as_str());
    let header: Vec<&str> = std::iter::once(heading).chain(names).collect();
    writeln!(out, "{}", header.join(","))?;

    let time_format = time_format(time_s, rows);
    let write_row = |block: &mut Vec<u8>, k: usize| {
        time_format.write(block, time_s(k));
        for (column, format) in &columns {
            block.push(b',');
            format.write(block, column.values[k]);
        }
        block.push(b'\n');
    };
    write_rows(out, rows, write_row)
}

/// The columns of all groups, each with the format of its group.
fn formatted<'a>(
    groups: &'a [ColumnGroup<'a>],
    digits: Digits,
) -> Vec<(&'a Column<'a>, NumberFormat)> {
    let mut columns = Vec::new();
    for group in groups {
        let format = digits.for_peak(group.peak());
        columns.extend(group.columns.iter().map(|column| (column, format)));
    }
    columns
}

/// Formats blocks of rows in parallel and writes them in order.
fn write_rows(
    out: &mut (impl Write + ?Sized),
    rows: usize,
    write_row: impl Fn(&mut Vec<u8>, usize) + Sync,
) -> io::Result<()> {
    for start in (0..rows).step_by(BLOCK_ROWS * BLOCKS_AT_ONCE) {
        let end = rows.min(start + BLOCK_ROWS * BLOCKS_AT_ONCE);
        let blocks: Vec<Vec<u8>> = (start..end)
            .into_par_iter()
            .step_by(BLOCK_ROWS)
            .map(|first| {
                let mut block = Vec::new();
                (first..end.min(first + BLOCK_ROWS)).for_each(|k| write_row(&mut block, k));
                block
            })
            .collect();
        blocks.iter().try_for_each(|block| out.write_all(block))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::TimeGrid;

    fn column<'a>(name: &str, values: &'a [f64]) -> Column<'a> {
        Column { name: name.to_owned(), values }
    }

    fn written(time: &ThinnedGrid, groups: &[ColumnGroup], digits: Digits) -> String {
        let mut out = Vec::new();
        write_csv(&mut out, time, groups, digits).unwrap();
        String::from_utf8(out).unwrap()
    }

    const GRID: TimeGrid = TimeGrid { origin_s: 0.0, step_s: 0.25, first: -1, len: 5 };

    #[test]
    fn each_group_has_decimals_of_its_own_peak() {
        let (angle, rate) = ([0.0, -0.001, 2.0], [0.5, 1.0, -0.000_1]);
        let torque = [100.0, -12.345_678, 0.0];
        let groups = [
            ColumnGroup { columns: vec![column("a_rad", &angle), column("b_rad", &rate)] },
            ColumnGroup { columns: vec![column("torque_n_m", &torque)] },
        ];
        let expected = "time_s,a_rad,b_rad,torque_n_m\n\
                        -0.25,0.000,0.500,100.0\n\
                        0.25,-0.001,1.000,-12.3\n\
                        0.75,2.000,0.000,0.0\n";
        assert_eq!(written(&GRID.thinned(2), &groups, Digits::BelowPeak(3)), expected);
    }

    #[test]
    fn a_table_of_no_columns_still_has_its_times() {
        let text = written(&GRID.thinned(4), &[], Digits::Full);
        assert_eq!(text, "time_s\n-0.25\n0.75\n");
    }

    #[test]
    fn the_bytes_do_not_depend_on_the_number_of_threads() {
        let len = 3 * BLOCK_ROWS * BLOCKS_AT_ONCE / 2 + 7;
        let values: Vec<f64> = (0..len).map(|k| (0.37 * k as f64).sin()).collect();
        let grid = TimeGrid { len, ..GRID };
        let table = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let groups = [ColumnGroup { columns: vec![column("v_m", &values)] }];
            let write = || written(&grid.thinned(1), &groups, Digits::default());
            pool.build().unwrap().install(write)
        };
        let alone = table(1);
        assert_eq!(alone.lines().count(), len + 1);
        assert!(alone == table(5));
        for (k, line) in alone.lines().skip(1).enumerate() {
            let value: f64 = line.split_once(',').unwrap().1.parse().unwrap();
            assert!((value - values[k]).abs() <= 1e-10, "row {k}");
        }
    }

    #[test]
    #[should_panic(expected = "torque_n_m")]
    fn a_column_of_another_length_is_a_mistake_of_the_caller() {
        let groups = [ColumnGroup { columns: vec![column("torque_n_m", &[1.0])] }];
        written(&GRID.thinned(1), &groups, Digits::Full);
    }
}
