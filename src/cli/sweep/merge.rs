//! Shards of a sweep joined to one table.

use std::path::{Path, PathBuf};

use flexlink::csv::InputFile;
use flexlink::store::{Durability, SweepRows, SweptCase, check_record, merge_shards, write_sweep};

use super::sink::report;
use super::tally::Tally;
use crate::cli::files::{keep_files, keep_record, read_once};
use crate::terminal::console::is_standard_output;
use crate::terminal::{Failure, console};

/// Joins the shards in these files; nothing else is read.
pub(crate) fn merge(shards: &[PathBuf], output: &Path, quiet: bool) -> Result<Tally, Failure> {
    let inputs: Vec<&Path> = shards.iter().map(PathBuf::as_path).collect();
    read_once(&inputs)?;
    keep_files(output, &inputs)?;
    keep_record(output)?;
    let read = |path: &&Path| -> Result<SweepRows, Failure> {
        let file = InputFile::read(path)?;
        let rows = SweepRows::read(&file.shown, &file.bytes)?;
        check_record(path, &file)?;
        Ok(rows)
    };
    let shards: Vec<SweepRows> = inputs.iter().map(read).collect::<Result<_, _>>()?;
    let table = merge_shards(&shards)?;
    if is_standard_output(output) {
        console::print_bytes(table.as_bytes())?;
    } else {
        let whole = shards[0].identity().whole();
        write_sweep(output, table.as_bytes(), &whole, Durability::default(), &console::waiting)?;
    }
    let mut cases: Vec<SweptCase> = shards.iter().flat_map(SweepRows::cases).collect();
    cases.sort_by_key(|case| case.number);
    let tally = Tally::of_cases(cases.into_iter(), |_| Vec::new());
    tally.warn();
    let (rows, shards, output_shown) = (tally.rows(), shards.len(), output.display());
    let text = format!("cases    {rows}, of {shards} shards\nwritten  {output_shown}");
    report(&text, output, quiet)?;
    tally.refuse_all_failed()?;
    Ok(tally)
}
