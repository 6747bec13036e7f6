//! The program `flexlink`.

use std::env;
use std::process::ExitCode;

use flexlink::cli;
use flexlink::cli::terminal::allocator::SystemOrEnd;

#[global_allocator]
static ALLOCATOR: SystemOrEnd = SystemOrEnd;

fn main() -> ExitCode {
    ExitCode::from(cli::run(env::args_os()))
}
