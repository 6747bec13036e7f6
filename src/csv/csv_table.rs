use std::io::{self, Write};
use std::ops::Range;

use super::cells::Cells;
use super::in_turn::write_in_turn;
use super::number::Digits;
use super::time_format::time_format;
use crate::inverse::{NodalTable, Stage, Watch};
use crate::numeric::{ThinnedGrid, largest};

/// Numbers formatted by one thread at a time: their text fits its cache.
const BLOCK_NUMBERS: usize = 1 << 14;

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
        self.columns.iter().map(|column| largest(column.values)).fold(0.0, f64::max)
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
    out: &mut (dyn Write + Send),
    time: &ThinnedGrid,
    groups: &[ColumnGroup],
    digits: Digits,
) -> io::Result<()> {
    write_timed(out, "time_s", &|k| time.time_s(k), time.len(), groups, digits)
}

/// Writes a table of `rows` rows over times in s under a heading of their own.
pub(super) fn write_timed(
    out: &mut (dyn Write + Send),
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
    write_header(out, heading, names)?;
    let times = Cells::new(time_format(time_s, rows));
    let write_block = |rows: Range<usize>, text: &mut Vec<u8>| {
        let time: Vec<f64> = rows.clone().map(time_s).collect();
        let (mut spelled_times, mut spelled) = (vec![], vec![vec![]; columns.len()]);
        let mut all = vec![times.of(&time, &mut spelled_times)];
        all.extend(
            columns
                .iter()
                .zip(&mut spelled)
                .map(|((column, cells), spelled)| cells.of(&column.values[rows.clone()], spelled)),
        );
        for row in 0..time.len() {
            all[0].append(text, b'\n', row);
            all[1..].iter().for_each(|cells| cells.append(text, b',', row));
            reserve_rows(text, row, time.len());
        }
    };
    write_blocks(out, &(0..rows), columns.len() + 1, write_block)?;
    out.write_all(b"\n")
}

/// The columns of all groups, each with the format of its group.
fn formatted<'a>(groups: &'a [ColumnGroup<'a>], digits: Digits) -> Vec<(&'a Column<'a>, Cells)> {
    let mut columns = Vec::new();
    for group in groups {
        let cells = Cells::new(digits.for_peak(group.peak()));
        columns.extend(group.columns.iter().map(|column| (column, cells)));
    }
    columns
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
    write_header(out, "time_s", names)?;
    let times = Cells::new(time_format(|k| grid.time_s(k), grid.len()));
    let are_one = |found, bound| digits.for_peak(found) == digits.for_peak(bound);
    let cells = Cells::new(digits.for_peak_of(|| table.peak(watch, are_one)));
    for number in 0..table.blocks() {
        let block = table.block(number, watch);
        watch.begin(Stage::Write, block.rows().len());
        let write_block = |rows: Range<usize>, text: &mut Vec<u8>| {
            let time: Vec<f64> = rows.clone().map(|k| grid.time_s(k)).collect();
            let (mut spelled_times, mut spelled) = (vec![], vec![]);
            let time = times.of(&time, &mut spelled_times);
            let mut values = vec![0.0; rows.len() * width];
            block.write_rows(rows.clone(), &mut values);
            for row in 0..rows.len() {
                time.append(text, b'\n', row);
                let values = cells.of(&values[row * width..][..width], &mut spelled);
                (0..width).for_each(|column| values.append(text, b',', column));
                reserve_rows(text, row, rows.len());
            }
            watch.advance(rows.len());
        };
        write_blocks(out, &block.rows(), width + 1, write_block)?;
    }
    out.write_all(b"\n")
}

/// Writes the names of the columns; every row then begins with the end of the line before it.
fn write_header<S: AsRef<str>>(
    out: &mut (dyn Write + Send),
    heading: &str,
    names: impl Iterator<Item = S>,
) -> io::Result<()> {
    out.write_all(heading.as_bytes())?;
    for name in names {
        out.write_all(b",")?;
        out.write_all(name.as_ref().as_bytes())?;
    }
    Ok(())
}

/// Takes memory for all rows of a block, after the first of them, so that the text does not move
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
    let block_rows = (BLOCK_NUMBERS / width).max(1);
    write_in_turn(out, rows.len().div_ceil(block_rows), |block, text| {
        let first = rows.start + block * block_rows;
        write_block(first..rows.end.min(first + block_rows), text);
    })
}

/// Columns of one unit.
pub(crate) fn group<'a, const N: usize>(columns: [(&str, &'a Vec<f64>); N]) -> ColumnGroup<'a> {
    let columns = columns.map(|(name, values)| Column { name: name.to_owned(), values });
    ColumnGroup { columns: columns.into() }
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
}
