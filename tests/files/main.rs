//! What is read from files and written to them: links, motions, torques, references, results.

mod instruments;
mod jittered_times;
mod link_file;
mod loggers;
mod reference_files;
mod refused_arms;
mod refused_tables;
mod snapshot;
mod stored_results;
mod table_laws;
mod torque_file;
mod trajectory_file;
mod trajectory_resampling;
