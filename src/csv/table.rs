//! Tables as CSV text: a row of names, then a row of numbers for each sample, mode or frequency.

use std::io::{self, Write};
use std::ops::Range;

use super::cells::CellFormat;
use super::in_order::write_in_order;
use super::number::{Digits, NumberFormat, time_format};
use crate::inverse::{NodalTable, Stage, Watch};
use crate::numeric::ThinnedGrid;

/// Numbers that a thread formats at a time: their text fits its cache.
const BLOCK_NUMBERS: usize = 1 << 14;

/// One column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column<'a> {
    /// Heading: the word and its unit, `torque_n_m`.
    pub name: String,
    /// One value a row. Where one is not finite, the field stays empty.
    pub values: &'a [f64],
}

/// Columns of one unit, which share their peak and so their number of decimals.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnGroup<'a> {
    /// The columns, from the left.
    pub columns: Vec<Column<'a>>,
}

impl ColumnGroup<'_> {
    /// Largest finite absolute value of all columns.
    fn peak(&self) -> f64 {
        let values = self.columns.iter().flat_map(|column| column.values);
        values.filter(|x| x.is_finite()).fold(0.0, |peak, x| peak.max(x.abs()))
    }
}

/// Columns of one unit.
pub(crate) fn group<'a, const N: usize>(columns: [(&str, &'a Vec<f64>); N]) -> ColumnGroup<'a> {
    let columns = columns.map(|(name, values)| Column { name: name.to_owned(), values });
    ColumnGroup { columns: columns.into() }
}

/// The column at the left, whose values are computed row by row.
struct FirstColumn<'a> {
    heading: &'a str,
    format: NumberFormat,
    value: &'a (dyn Fn(usize) -> f64 + Sync),
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
    out: &mut (dyn Write + Send),
    time: &ThinnedGrid,
    groups: &[ColumnGroup],
    digits: Digits,
) -> io::Result<()> {
    write_over_time(out, ("time_s", &|k| time.time_s(k)), time.len(), groups, digits)
}

/// [`write_csv`] with another heading of the times, which are in s, and `rows` of them.
pub(super) fn write_over_time(
    out: &mut (dyn Write + Send),
    (heading, time_s): (&str, &(dyn Fn(usize) -> f64 + Sync)),
    rows: usize,
    groups: &[ColumnGroup],
    digits: Digits,
) -> io::Result<()> {
    for column in groups.iter().flat_map(|group| &group.columns) {
        assert_eq!(column.values.len(), rows, "{}", column.name);
    }
    let first = FirstColumn { heading, format: time_format(time_s, rows), value: time_s };
    write_table(out, Some(&first), rows, groups, digits)
}

/// Writes columns of any length, each with decimals for its own peak, after a column of this heading
/// that counts the rows from 1. Fields beyond the end of a column are empty.
///
/// # Errors
/// Those of `out`.
pub(crate) fn write_columns(
    out: &mut (dyn Write + Send),
    count: Option<&str>,
    columns: &[(&str, &[f64])],
    digits: Digits,
) -> io::Result<()> {
    let number = |row: usize| (row + 1) as f64;
    let count = count.map(|heading| FirstColumn {
        heading,
        format: NumberFormat::Fixed(0),
        value: &number,
    });
    let groups: Vec<_> = columns
        .iter()
        .map(|(name, values)| Column { name: (*name).to_owned(), values })
        .map(|column| ColumnGroup { columns: vec![column] })
        .collect();
    let rows = columns.iter().map(|(_, values)| values.len()).max().unwrap_or(0);
    write_table(out, count.as_ref(), rows, &groups, digits)
}

fn write_table(
    out: &mut (dyn Write + Send),
    first: Option<&FirstColumn>,
    rows: usize,
    groups: &[ColumnGroup],
    digits: Digits,
) -> io::Result<()> {
    let mut columns = Vec::new();
    for group in groups {
        let format = CellFormat::new(digits.for_peak(group.peak()));
        columns.extend(group.columns.iter().map(|column| (column, format)));
    }
    let names = columns.iter().map(|(column, _)| column.name.as_str());
    write_names(out, first.map(|first| first.heading).into_iter().chain(names))?;
    let width = columns.len() + usize::from(first.is_some());
    write_blocks(out, &(0..rows), width, |rows, text| {
        let computed: Vec<f64> =
            first.map_or(vec![], |first| rows.clone().map(first.value).collect());
        let first = first.map(|first| (&computed[..], CellFormat::new(first.format)));
        let given = columns.iter().map(|(column, format)| {
            let end = column.values.len();
            (&column.values[rows.start.min(end)..rows.end.min(end)], *format)
        });
        let mut batches = vec![vec![]; width];
        let cells = first.into_iter().chain(given).zip(&mut batches);
        let cells: Vec<_> =
            cells.map(|((values, format), batches)| format.cells(values, batches)).collect();
        for row in 0..rows.len() {
            for (column, cells) in cells.iter().enumerate() {
                cells.append(text, if column == 0 { b'\n' } else { b',' }, row);
            }
            reserve_rows(text, row, rows.len());
        }
    })?;
    out.write_all(b"\n")
}

/// Writes a quantity at the nodes of a link over time: a header, then one row a sample, `time_s`
/// first and then a column a node, headed `letter`, its number and `unit`.
///
/// # Errors
/// Those of `out`.
pub(crate) fn write_nodal(
    out: &mut (dyn Write + Send),
    table: &NodalTable,
    (letter, unit): (&str, &str),
    digits: Digits,
    watch: &dyn Watch,
) -> io::Result<()> {
    let (grid, width) = (table.grid(), table.nodes().len());
    let names = table.nodes().iter().map(|node| format!("{letter}{node}_{unit}"));
    write_names(out, std::iter::once("time_s".to_owned()).chain(names))?;
    let times = CellFormat::new(time_format(|k| grid.time_s(k), grid.len()));
    let are_one = |found, bound| digits.for_peak(found) == digits.for_peak(bound);
    let values = CellFormat::new(digits.for_peak_of(|| table.peak(watch, are_one)));
    for number in 0..table.blocks() {
        let block = table.block(number, watch);
        watch.begin(Stage::Write, block.rows().len());
        write_blocks(out, &block.rows(), width + 1, |rows, text| {
            let time_s: Vec<f64> = rows.clone().map(|k| grid.time_s(k)).collect();
            let (mut time_batches, mut batches) = (vec![], vec![]);
            let times = times.cells(&time_s, &mut time_batches);
            let mut numbers = vec![0.0; rows.len() * width];
            block.write_rows(rows.clone(), &mut numbers);
            for row in 0..rows.len() {
                times.append(text, b'\n', row);
                let cells = values.cells(&numbers[row * width..][..width], &mut batches);
                (0..width).for_each(|column| cells.append(text, b',', column));
                reserve_rows(text, row, rows.len());
            }
            watch.advance(rows.len());
        })?;
    }
    out.write_all(b"\n")
}

/// Writes the names of the columns without a line end: every row begins with that of the line before.
fn write_names<S: AsRef<str>>(
    out: &mut (dyn Write + Send),
    names: impl Iterator<Item = S>,
) -> io::Result<()> {
    for (column, name) in names.enumerate() {
        let separator: &[u8] = if column == 0 { b"" } else { b"," };
        out.write_all(separator)?;
        out.write_all(name.as_ref().as_bytes())?;
    }
    Ok(())
}

/// Reserves memory for all rows of a block after the first of them, so that the text does not move
/// while it grows.
fn reserve_rows(text: &mut Vec<u8>, row: usize, rows: usize) {
    if row == 0 {
        text.reserve(text.len() * rows * 9 / 8);
    }
}

/// Formats blocks of rows in parallel and writes them in order.
fn write_blocks(
    out: &mut (dyn Write + Send),
    rows: &Range<usize>,
    width: usize,
    write_block: impl Fn(Range<usize>, &mut Vec<u8>) + Sync,
) -> io::Result<()> {
    let block_rows = (BLOCK_NUMBERS / width.max(1)).max(1);
    write_in_order(out, rows.len().div_ceil(block_rows), |block, text| {
        let first = rows.start + block * block_rows;
        write_block(first..rows.end.min(first + block_rows), text);
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inverse::Unwatched;
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
        let len = 9 * BLOCK_NUMBERS / 2 + 7;
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
    fn a_nodal_table_made_in_blocks_has_the_bytes_of_one_made_at_once() {
        let solution = crate::inverse::tests::solution(400);
        let bytes = |table: NodalTable| {
            let mut out = Vec::new();
            let blocks = table.blocks();
            write_nodal(&mut out, &table, ("v", "m"), Digits::default(), &Unwatched).unwrap();
            (blocks, out)
        };
        let table = || solution.displacements(&[3, 0, 40], 1);
        let ((one, whole), (many, blocked)) = (bytes(table()), bytes(table().in_blocks_of(97)));
        assert!(one == 1 && many > 5 && whole == blocked, "{one} and {many} blocks");
        let text = String::from_utf8(whole).unwrap();
        assert!(text.starts_with("time_s,v3_m,v0_m,v40_m\n") && text.ends_with('\n'));
        assert_eq!(text.lines().count(), 1 + solution.grid.len);
    }

    #[test]
    #[should_panic(expected = "torque_n_m")]
    fn a_column_of_another_length_is_a_mistake_of_the_caller() {
        let groups = [ColumnGroup { columns: vec![column("torque_n_m", &[1.0])] }];
        written(&GRID.thinned(1), &groups, Digits::Full);
    }

    #[test]
    fn short_columns_and_missing_values_leave_fields_empty() {
        let columns = [("zero_per_s", &[2.0, f64::INFINITY][..]), ("mesh_error", &[1.0; 3])];
        let written = |count| {
            let mut out = Vec::new();
            write_columns(&mut out, count, &columns, Digits::BelowPeak(2)).unwrap();
            String::from_utf8(out).unwrap()
        };
        assert_eq!(written(None), "zero_per_s,mesh_error\n2.00,1.00\n,1.00\n,1.00\n");
        let counted = "mode,zero_per_s,mesh_error\n1,2.00,1.00\n2,,1.00\n3,,1.00\n";
        assert_eq!(written(Some("mode")), counted);
    }
}
