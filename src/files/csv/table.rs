//! Tables as CSV text: a row of names, then a row of numbers for each sample, mode or frequency.

use std::io::{self, Write};
use std::ops::Range;

use rayon::prelude::*;

use super::number::CellFormat;
use super::number::{Digits, NumberFormat, time_format};
use crate::inverse::{NodalTable, Stage, Watch};
use crate::numeric::ThinnedGrid;

/// Count of numbers that a thread formats at a time: their text fits its cache.
const BLOCK_NUMBERS: usize = 1 << 14;

/// Number of blocks that each thread formats in a round.
const BLOCKS_PER_THREAD: usize = 2;

/// One column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column<'a> {
    /// Heading: the word and its unit, `torque_n_m`.
    pub name: String,
    /// Values, one a row. The field of a value that is not finite stays empty.
    pub values: &'a [f64],
}

/// Columns of one unit, with a common peak and so a common number of decimals.
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

/// Makes a group of columns of one unit.
pub(crate) fn group<'a, const N: usize>(columns: [(&str, &'a [f64]); N]) -> ColumnGroup<'a> {
    let columns = columns.map(|(name, values)| Column { name: name.to_owned(), values });
    ColumnGroup { columns: columns.into() }
}

/// Writes a table over time: a header, then one row a sample, `time_s` first.
///
/// Rows are formatted in parallel; the bytes do not depend on the number of threads.
///
/// # Errors
/// Those of `out`; invalid input if columns and times differ in length.
pub fn write_csv(
    out: &mut (dyn Write + Send),
    time: &ThinnedGrid,
    groups: &[ColumnGroup],
    digits: Digits,
) -> io::Result<()> {
    let time_s: Vec<f64> = (0..time.len()).map(|k| time.time_s(k)).collect();
    write_over_time(out, ("time_s", &time_s), groups, digits)
}

/// Writes a table over time, each column with its format.
///
/// # Errors
/// Those of `out`.
pub(crate) fn write_formatted(
    out: &mut (dyn Write + Send),
    time: &ThinnedGrid,
    columns: &[(&str, &[f64], NumberFormat)],
) -> io::Result<()> {
    let time_s: Vec<f64> = (0..time.len()).map(|k| time.time_s(k)).collect();
    let format = CellFormat::new(time_format(|k| time_s[k], time_s.len()));
    let own =
        columns.iter().map(|(name, values, format)| (*name, *values, CellFormat::new(*format)));
    let columns: Vec<_> = [("time_s", &time_s[..], format)].into_iter().chain(own).collect();
    write_cells(out, &columns, time_s.len())
}

/// [`write_csv`] with times in s and their heading.
pub(super) fn write_over_time(
    out: &mut (dyn Write + Send),
    (heading, time_s): (&str, &[f64]),
    groups: &[ColumnGroup],
    digits: Digits,
) -> io::Result<()> {
    let rows = time_s.len();
    let mut columns = groups.iter().flat_map(|group| &group.columns);
    if let Some(Column { name, values }) = columns.find(|column| column.values.len() != rows) {
        let text = format!("{name} = {} values, but must be {rows}, one a time", values.len());
        return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
    }
    let format = CellFormat::new(time_format(|k| time_s[k], rows));
    write_table(out, Some((heading, time_s, format)), rows, groups, digits)
}

/// Writes columns of any length, each with decimals for its peak, after an optional column of whole numbers. Fields
/// beyond the end of a column are empty.
///
/// # Errors
/// Those of `out`.
pub(crate) fn write_columns(
    out: &mut (dyn Write + Send),
    numbers: Option<(&str, &[f64])>,
    columns: &[(&str, &[f64])],
    digits: Digits,
) -> io::Result<()> {
    let rows = columns.iter().map(|(_, values)| values.len()).max().unwrap_or(0);
    let whole = CellFormat::new(NumberFormat::Fixed(0));
    let first = numbers.map(|(heading, numbers)| (heading, numbers, whole));
    let groups: Vec<_> = columns.iter().map(|column| group([*column])).collect();
    write_table(out, first, rows, &groups, digits)
}

/// Writes a table of `rows` rows; its first column has a separate format.
fn write_table(
    out: &mut (dyn Write + Send),
    first: Option<(&str, &[f64], CellFormat)>,
    rows: usize,
    groups: &[ColumnGroup],
    digits: Digits,
) -> io::Result<()> {
    let mut columns: Vec<_> = first.into_iter().collect();
    for group in groups {
        let format = CellFormat::new(digits.for_peak(group.peak()));
        columns.extend(group.columns.iter().map(|c| (c.name.as_str(), c.values, format)));
    }
    write_cells(out, &columns, rows)
}

/// Writes columns with their formats.
fn write_cells(
    out: &mut (dyn Write + Send),
    columns: &[(&str, &[f64], CellFormat)],
    rows: usize,
) -> io::Result<()> {
    write_names(out, columns.iter().map(|(name, ..)| *name))?;
    write_blocks(out, &(0..rows), columns.len(), |rows, text| {
        let mut batches = vec![vec![]; columns.len()];
        let cells = columns.iter().zip(&mut batches).map(|((_, values, format), batches)| {
            let end = values.len();
            format.cells(&values[rows.start.min(end)..rows.end.min(end)], batches)
        });
        let cells: Vec<_> = cells.collect();
        for row in 0..rows.len() {
            for (column, cells) in cells.iter().enumerate() {
                cells.append(text, if column == 0 { b'\n' } else { b',' }, row);
            }
            reserve_rows(text, row, rows.len());
        }
    })?;
    out.write_all(b"\n")
}

/// Writes a quantity at the nodes of a link over time: a header, then one row a sample. `time_s` comes first, then a
/// column for each node, headed `letter`, its number and `unit`.
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
    // The shortest digits need no peak, whose search takes a pass over all nodes.
    let peak = if digits == Digits::Full { 0.0 } else { table.peak(watch, are_one) };
    let values = CellFormat::new(digits.for_peak(peak));
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

/// Writes the names of the columns without a line end: every row begins with the line end of the row before.
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

/// Reserves memory for all rows of a block after its first row, so that the text does not move while it grows.
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

/// Writes the text of `blocks` blocks in their order; `make` appends the text of one block to an empty buffer.
///
/// All threads make a round of blocks while one of them writes the round before, so that at most two rounds are in
/// memory.
///
/// # Errors
/// Those of `out`.
fn write_in_order(
    out: &mut (dyn Write + Send),
    blocks: usize,
    make: impl Fn(usize, &mut Vec<u8>) + Sync,
) -> io::Result<()> {
    let at_once = BLOCKS_PER_THREAD * rayon::current_num_threads();
    let (mut made, mut next) = (Vec::new(), Vec::new());
    let mut start = 0;
    while start < blocks || !made.is_empty() {
        next.resize_with(at_once.min(blocks - start), Vec::new);
        let (written, ()) = rayon::join(
            || made.iter().try_for_each(|text: &Vec<u8>| out.write_all(text)),
            || {
                next.par_iter_mut().enumerate().with_max_len(1).for_each(|(k, text)| {
                    text.clear();
                    make(start + k, text);
                });
            },
        );
        written?;
        start += next.len();
        std::mem::swap(&mut made, &mut next);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroUsize;
    use std::sync::atomic::{AtomicUsize, Ordering};

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
        assert_eq!(
            written(&GRID.thinned(NonZeroUsize::new(2).unwrap()), &groups, Digits::BelowPeak(3)),
            expected
        );
    }

    #[test]
    fn a_table_of_no_columns_still_has_its_times() {
        let text = written(&GRID.thinned(NonZeroUsize::new(4).unwrap()), &[], Digits::Full);
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
            let write = || written(&grid.thinned(NonZeroUsize::MIN), &groups, Digits::default());
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
        let table = || solution.displacements(&[3, 0, 40], NonZeroUsize::MIN).unwrap();
        let ((one, whole), (many, blocked)) = (bytes(table()), bytes(table().in_blocks_of(97)));
        assert!(one == 1 && many > 5 && whole == blocked, "{one} and {many} blocks");
        let text = String::from_utf8(whole).unwrap();
        assert!(text.starts_with("time_s,v3_m,v0_m,v40_m\n") && text.ends_with('\n'));
        assert_eq!(text.lines().count(), 1 + solution.grid.len);
    }

    #[test]
    fn a_column_of_another_length_is_refused() {
        let groups = [group([("torque_n_m", &[1.0])])];
        let times = &GRID.thinned(NonZeroUsize::MIN);
        let error = write_csv(&mut vec![], times, &groups, Digits::Full).unwrap_err().to_string();
        assert_eq!(error, "torque_n_m = 1 values, but must be 5, one a time");
    }

    #[test]
    fn short_columns_and_missing_values_leave_fields_empty() {
        let columns = [("zero_per_s", &[2.0, f64::INFINITY][..]), ("mesh_error", &[1.0; 3])];
        let written = |numbers| {
            let mut out = Vec::new();
            write_columns(&mut out, numbers, &columns, Digits::BelowPeak(2)).unwrap();
            String::from_utf8(out).unwrap()
        };
        assert_eq!(written(None), "zero_per_s,mesh_error\n2.00,1.00\n,1.00\n,1.00\n");
        let counted = "mode,zero_per_s,mesh_error\n1,2.00,1.00\n2,,1.00\n3,,1.00\n";
        assert_eq!(written(Some(("mode", &[1.0, 2.0, 3.0]))), counted);
    }

    fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
    }

    /// Blocks of uneven work.
    fn text(block: usize, out: &mut Vec<u8>) {
        let busy: f64 = (0..block % 7 * 500).map(|k| k as f64).sum();
        out.extend(format!("{block}:{busy};").as_bytes());
    }

    #[test]
    fn texts_are_in_order_on_any_number_of_threads() {
        for blocks in [0, 1, 2, 4, 299, 300] {
            let mut expected = vec![];
            (0..blocks).for_each(|block| text(block, &mut expected));
            for threads in [1, 2, 7] {
                let mut out = vec![];
                on_threads(threads, || write_in_order(&mut out, blocks, text)).unwrap();
                assert!(out == expected, "{blocks} blocks on {threads} threads");
            }
        }
    }

    /// A disk that becomes full after some writes.
    struct Full(usize);

    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0 = self.0.checked_sub(1).ok_or(io::ErrorKind::StorageFull)?;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn an_error_ends_the_work_and_is_returned() {
        let made = AtomicUsize::new(0);
        let make = |block: usize, out: &mut Vec<u8>| {
            made.fetch_add(1, Ordering::Relaxed);
            text(block, out);
        };
        let written = on_threads(3, || write_in_order(&mut Full(5), 100_000, make));
        assert_eq!(written.unwrap_err().kind(), io::ErrorKind::StorageFull);
        assert!(made.into_inner() < 100);
    }

    #[test]
    #[should_panic(expected = "block 4")]
    fn a_panic_is_passed_on_and_no_thread_waits() {
        let make = |block: usize, _: &mut Vec<u8>| assert_ne!(block, 4, "block {block}");
        let mut out = vec![];
        let _ = on_threads(3, || write_in_order(&mut out, 50, make));
    }
}
