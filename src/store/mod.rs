//! A run's folder, whole or not at all; summary.json; the file of a sweep; golden files.

mod comparison_json;
mod csv_folder;
mod folder;
mod golden;
mod histories;
mod json_record;
mod link_record;
mod modes_tables;
mod records;
mod signals;
mod simulate_tables;
mod simulation_summary;
mod single_file;
mod solve_tables;
mod stored;
mod summary;
mod sweep_file;
mod sweep_identity;
mod sweep_merge;
mod sweep_part;
mod sweep_record;
mod sweep_rows;
mod sweep_table;

pub use comparison_json::comparison_json;
pub use csv_folder::CsvFolder;
pub use folder::{
    Durability, FolderAction, FolderError, OutputFolder, TemporaryFolder, abandon_unfinished,
    abandon_unfinished_soon, wait_if_ending,
};
pub use golden::{GoldenChanges, change_golden_files};
pub use histories::{REPORT, SUMMARY, is_result_file};
pub use modes_tables::{HeldModes, ModesResult};
pub use records::verification_json;
pub use signals::ignored_signals;
pub use simulate_tables::SimulateOutputs;
pub use simulation_summary::{SimulationInputs, SimulationSummary};
pub use single_file::{write_file, write_file_by};
pub use solve_tables::{OptionalTable, SolveOutputs};
pub use stored::{FoundInput, InputRole, RunRecord, is_run, read_result};
pub use summary::{RunInputs, Summary};
pub use sweep_file::{LeftRows, Resumed, SweepFile};
pub use sweep_identity::{SweepIdentity, SweepInputs};
pub use sweep_merge::merge_shards;
pub use sweep_record::{ForeignRecord, check_record, sweep_files, write_sweep};
pub use sweep_rows::{SweepRows, SweptCase};
pub use sweep_table::{SweepColumn, SweepRecord, sweep_columns, sweep_header, sweep_row};
