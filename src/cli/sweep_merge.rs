//! Shards of a sweep joined to one table.

use std::path::{Path, PathBuf};

use flexlink::tables::{InputFile, SweepRows, merge_shards};

use super::console;
use super::exit::Failure;
use super::files::{keep_files, read_once};
use super::sweep_sink::report;
use super::sweep_tally::Tally;

/// Joins the shards in these files; nothing else is read.
pub(crate) fn merge(shards: &[PathBuf], output: &Path, quiet: bool) -> Result<(), Failure> {
    let inputs: Vec<&Path> = shards.iter().map(PathBuf::as_path).collect();
    read_once(&inputs)?;
    keep_files(output, &inputs)?;
    let read = |path: &&Path| -> Result<SweepRows, Failure> {
        let file = InputFile::read(path)?;
        Ok(SweepRows::read(&file.shown, &file.bytes)?)
    };
    let shards: Vec<SweepRows> = inputs.iter().map(read).collect::<Result<_, _>>()?;
    let table = merge_shards(&shards)?;
    console::deliver(Some(output), table.as_bytes())?;
    let mut tally = Tally::default();
    for shard in &shards {
        tally.join(Tally::of_rows(shard));
    }
    tally.warn();
    let (rows, shards, output_shown) = (tally.rows(), shards.len(), output.display());
    let text = format!("cases    {rows}, of {shards} shards\nwritten  {output_shown}");
    report(&text, output, quiet)?;
    tally.refuse_all_failed()
}
