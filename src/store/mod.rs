//! A run's folder, whole or not at all; summary.json; the file of a sweep; golden files.

mod comparison_json;
mod file_names;
mod folder;
mod frequency_tables;
mod golden;
mod json;
mod lock;
mod numbers;
mod run_tables;
mod simulation_summary;
mod single_file;
mod solve_summary;
mod stored;
mod summary;
mod sweep;
mod unfinished;

pub use comparison_json::comparison_json;
pub use file_names::{REPORT, SUMMARY, is_result_file};
pub use folder::{Durability, FolderAction, FolderError, OutputFolder};
pub use frequency_tables::{HeldModes, ModesResult, write_frequency_response};
pub use golden::{CsvFolder, GoldenChanges, change_golden_files};
pub use run_tables::{OptionalTable, SimulateOutputs, SolveOutputs};
pub use simulation_summary::SimulationInputs;
pub use single_file::write_file;
pub use solve_summary::RunInputs;
pub use stored::{FoundInput, InputRole, RunRecord, TemporaryFolder, read_result};
pub use summary::{Summary, is_run, verification_json};
pub use sweep::{
    ForeignRecord, LeftRows, Resumed, SweepColumn, SweepFile, SweepIdentity, SweepInputs,
    SweepRecord, SweepRows, SweptCase, check_record, merge_shards, sweep_columns, sweep_files,
    sweep_header, sweep_row, write_sweep,
};
pub use unfinished::{abandon_unfinished, wait_if_ending};
