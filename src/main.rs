//! The program `flexlink`.

mod cli;
mod terminal;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run()
}
