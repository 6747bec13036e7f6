//! flexlink for Python: the library's links, motions and solutions as classes over NumPy arrays, and the command.
//!
//! | module | holds |
//! |---|---|
//! | `messages`, `wording` | errors and warnings as Python's, in its words |
//! | `prelude` | names that most files use |
//! | `threads` | threads that survive a fork; Ctrl-C |
//! | `arrays` | columns of numbers in, views of samples out |
//! | `arrow` | columns as a stream for other libraries of tables |
//! | `properties`, `joints` | properties of results by name, for one link and for arms |
//! | `keywords` | keywords as the command's options, dictionaries as TOML |
//! | `link` | a link or an arm, and its file |
//! | `samples` | wanted motions from arrays and files |
//! | `motion` | the motion of a call; motions that are read once |
//! | `solution`, `table` | `solve`, and its result; a table for a controller |
//! | `verify`, `compare`, `page` | the checks of a solution; differences of files; pages and figures |
//! | `simulation`, `simulate` | results of simulations; their input in the keywords of a call |
//! | `sweep`, `played` | many cases in parallel; the table that they play |
//! | `robust`, `learn` | links that differ from their file: the tip of many; the next torque from a measured tip |
//! | `frequency`, `trajectory`, `fit` | the commands of these names, and modes |
//! | `state_space` | matrices for the design of controllers |
//! | `stored` | results read back |
//!
//! A link is an arm of one link: each class and each function takes both.
//!
//! The command is that of the program, out of the library with its feature `cli`.
#![expect(clippy::needless_pass_by_value, reason = "PyO3 hands over what it has converted")]
#![expect(clippy::doc_link_with_quotes, clippy::doc_markdown, reason = "docs are those of Python")]

mod arrays;
mod arrow;
mod compare;
mod fit;
mod frequency;
mod joints;
mod keywords;
mod learn;
mod link;
mod messages;
mod motion;
mod page;
mod played;
mod prelude;
mod properties;
mod robust;
mod samples;
mod simulate;
mod simulation;
mod solution;
mod state_space;
mod stored;
mod sweep;
mod table;
mod threads;
mod trajectory;
mod verify;
mod wording;

use flexlink::cli::terminal::allocator::SystemOrEnd;
use pyo3::prelude::*;

#[global_allocator]
static ALLOCATOR: SystemOrEnd = SystemOrEnd;

/// Torques that make the tip of a flexible link follow a motion exactly.
#[pymodule]
mod _flexlink {
    use std::env;
    use std::ffi::OsString;
    use std::io::{self, Write as _};

    use flexlink::cli;
    use flexlink::cli::terminal::allocator::keep_freed_memory;
    use pyo3::prelude::*;

    use super::joints::{Driven as _, Moving as _};
    use super::properties::add;

    #[pymodule_export]
    use super::arrow::arrow_stream;
    #[pymodule_export]
    use super::compare::{Comparison, compare_files};
    #[pymodule_export]
    use super::fit::{Fit, fit};
    #[pymodule_export]
    use super::frequency::{frf, modes};
    #[pymodule_export]
    use super::learn::{Learned, learn};
    #[pymodule_export]
    use super::link::Link;
    #[pymodule_export]
    use super::motion::Motion;
    #[pymodule_export]
    use super::page::{Page, page_of_files};
    #[pymodule_export]
    use super::robust::{Robustness, robust};
    #[pymodule_export]
    use super::simulate::simulate;
    #[pymodule_export]
    use super::simulation::Simulation;
    #[pymodule_export]
    use super::solution::{Solution, solve};
    #[pymodule_export]
    use super::state_space::StateSpace;
    #[pymodule_export]
    use super::stored::{Run, read};
    #[pymodule_export]
    use super::sweep::sweep;
    #[pymodule_export]
    use super::table::SetPoints;
    #[pymodule_export]
    use super::trajectory::trajectory;
    #[pymodule_export]
    use super::verify::{Verification, verify};
    #[pymodule_export]
    use super::wording::wording;

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name of it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    /// Adds the properties of results. Keeps freed memory as the command does, unless the environment says otherwise: a
    /// solution takes and frees some megabytes, and twice as long where the system hands out fresh pages each time.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let settings = ["MALLOC_TRIM_THRESHOLD_", "MALLOC_MMAP_THRESHOLD_", "GLIBC_TUNABLES"];
        if settings.iter().all(|name| env::var_os(name).is_none()) {
            keep_freed_memory();
        }
        let py = module.py();
        add(py, &[Solution::JOINTS, Solution::SOLVED, Solution::MOTION])?;
        add(py, &[Simulation::JOINTS, Simulation::ACCELERATIONS, Simulation::MOTION])?;
        add(py, &[Run::JOINTS, Run::ACCELERATIONS, Run::SOLVED, Run::MOTION])?;
        add(py, &[SetPoints::JOINTS, SetPoints::ACCELERATIONS])?;
        add(py, &[Learned::JOINTS])
    }

    /// Runs the command with `sys.argv`; returns its exit code.
    #[pyfunction]
    fn main(py: Python<'_>) -> PyResult<u8> {
        let arguments: Vec<OsString> = py.import("sys")?.getattr("argv")?.extract()?;
        Ok(py.detach(|| {
            let code = cli::run(arguments);
            // Rust runs nothing when Python ends.
            let _ = io::stdout().flush();
            code
        }))
    }
}
