//! A run's folder, whole or not at all; summary.json; the file of a sweep; golden files; the record of a fit; a torque to
//! play.

mod arrays;
mod files;
mod folder;
mod frequency_tables;
mod golden;
mod json;
mod learn;
mod lock;
mod names;
mod read_result;
mod read_run;
mod read_tables;
mod repetition;
mod robust;
mod run_summary;
mod run_tables;
mod set_point_file;
mod set_point_forms;
mod state_space;
mod summary;
mod sweep;

pub use arrays::{NamedArray, Values, mat, npz};
pub use files::{NamedBy, NewFile, write_file, write_files};
pub use folder::{Durability, FolderError, OutputFolder};
pub use frequency_tables::{
    ResponseColumns, arm_response, frequency_response_json, link_response, modes_json,
    write_frequency_response,
};
pub use golden::{CsvFolder, GoldenChanges, change_golden_files, comparison_json};
pub use json::{
    Fingerprint, FitInputs, different_inputs, fit_json, fit_record, foreign_fit_record, read_state,
    record_json, results_table, state_json,
};
pub use learn::{LearnInputs, write_next};
pub use lock::{abandon_unfinished, try_abandon_unfinished, wait_if_ending};
pub use names::{REPORT, RunOutputs, SUMMARY, is_result_file};
pub use read_result::{StoredResult, is_run, read_result, read_results};
pub use repetition::{RunRecord, TemporaryFolder};
pub use robust::{RobustFiles, RobustInputs, plant_columns, read_fitted, robust_json};
pub use run_summary::{Findings, PlayedRun, Simulated};
pub use run_tables::{RunTables, write_solution};
pub use set_point_file::{SetPointFile, SetPointForm, TableRecord};
pub use state_space::{StateSpaceFile, StateSpaceForm};
pub use summary::{RunInputs, STATIONS, SimulateFiles, Summary, verification_json};
pub use sweep::{
    ForeignRecord, LeftRows, Resumed, SweepFile, SweepIdentity, SweepInputs, SweepRows, SweptCase,
    merge_shards, sweep_files, sweep_header, sweep_row, write_sweep,
};
