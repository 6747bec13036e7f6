//! The program `flexlink`.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run()
}
