//! flexlink for Python: the library's links, motions and solutions as classes over NumPy arrays, and the command.
//!
//! | module | holds |
//! |---|---|
//! | `arrays` | columns of numbers in, views of samples out |
//! | `keywords` | keywords as the command's options, dictionaries as TOML |
//! | `messages` | errors and warnings as Python's |
//! | `pool`, `interrupt` | threads that survive a fork; Ctrl-C |
//! | `link` | a link and its file |
//! | `motion`, `solve`, `solution` | motions of a tip from arrays and files, and their solutions |
//! | `solved` | common parts of the solutions of links and arms |
//! | `arm` | arms, their paths and their solutions |
//! | `frequency`, `trajectory` | modes and responses; motions by profile |
//! | `simulate`, `simulate_arm`, `play` | torques played on links and arms, and their keywords |
//! | `sweep`, `sweep_work`, `fit` | the commands of these names |
//! | `stored` | results read back |
//!
//! The command is that of the program, out of the library with its feature `cli`.
#![expect(clippy::needless_pass_by_value, reason = "PyO3 hands over what it has converted")]
#![expect(clippy::doc_link_with_quotes, clippy::doc_markdown, reason = "docs are those of Python")]

mod arm;
mod arrays;
mod fit;
mod frequency;
mod interrupt;
mod keywords;
mod link;
mod messages;
mod motion;
mod play;
mod pool;
mod simulate;
mod simulate_arm;
mod solution;
mod solve;
mod solved;
mod stored;
mod sweep;
mod sweep_work;
mod trajectory;

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

    #[pymodule_export]
    use super::arm::{Arm, ArmSolution};
    #[pymodule_export]
    use super::fit::{Fit, fit};
    #[pymodule_export]
    use super::frequency::{frf, modes};
    #[pymodule_export]
    use super::link::Link;
    #[pymodule_export]
    use super::motion::Motion;
    #[pymodule_export]
    use super::simulate::{PlayedLink, simulate};
    #[pymodule_export]
    use super::simulate_arm::ArmSimulation;
    #[pymodule_export]
    use super::solution::Solution;
    #[pymodule_export]
    use super::solve::solve;
    #[pymodule_export]
    use super::stored::{ArmRun, Run, read};
    #[pymodule_export]
    use super::sweep::sweep;
    #[pymodule_export]
    use super::trajectory::trajectory;

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name of it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    /// Keeps freed memory as the command does, unless the environment says otherwise: a solution takes and frees some
    /// megabytes, and twice as long where the system hands out fresh pages each time.
    #[pymodule_init]
    #[expect(clippy::unnecessary_wraps, reason = "the signature that PyO3 wants")]
    fn init(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        let settings = ["MALLOC_TRIM_THRESHOLD_", "MALLOC_MMAP_THRESHOLD_", "GLIBC_TUNABLES"];
        if settings.iter().all(|name| env::var_os(name).is_none()) {
            keep_freed_memory();
        }
        Ok(())
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
