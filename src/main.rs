//! The program `flexlink`.

mod cli;
mod options;
mod terminal;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run()
}
