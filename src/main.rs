//! The program `flexlink`.

mod cli;
mod options;
mod terminal;

use std::env;
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(cli::run(env::args_os()))
}
