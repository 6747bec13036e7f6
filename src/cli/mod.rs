//! The command line: arguments in, exit code out.

mod args;
mod console;
mod exit;
mod frf;
mod init;
mod link_text;
mod modes;
mod modes_text;
mod number;
mod shell;
mod simulate;
mod simulate_inputs;
mod simulate_text;
mod solve;
mod solve_text;
mod trajectory;
mod verify;
mod verify_text;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use exit::Failure;

/// Hub torque that makes the tip of a flexible link follow a wanted motion.
#[derive(Debug, Parser)]
#[command(version, about, long_about = LONG_ABOUT, after_help = EXIT_CODES, max_term_width = 100)]
#[command(bin_name = "flexlink")] // on Windows too, where the file is flexlink.exe
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const LONG_ABOUT: &str = "\
Hub torque that makes the tip of a flexible link follow a wanted motion.

The link turns about its hub in the horizontal plane and bends a little; the motion goes from \
rest to rest. The torque starts before the tip moves and outlasts its motion, because bending \
waves travel at finite speed (E. Bayo, J. Robotic Systems 4(1), 1987).";

const EXIT_CODES: &str = "\
Exit codes: 0 done, 2 wrong usage, 3 input refused, 4 not solvable, 5 cannot write";

#[derive(Debug, Subcommand)]
enum Command {
    // The help of each stands with its arguments.
    Solve(Box<solve::Solve>),
    Simulate(Box<simulate::Simulate>),
    Verify(Box<verify::Verify>),
    Modes(modes::Modes),
    Frf(frf::Frf),
    Trajectory(trajectory::Trajectory),
    Init(init::Init),
    Completions(shell::Completions),
    #[command(name = "man")]
    Manual(shell::Manual),
}

/// Runs the program: the one place that prints an error and its hint.
pub(crate) fn run() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Solve(solve) => solve.run(),
        Command::Simulate(simulate) => simulate.run(),
        Command::Verify(verify) => verify.run(),
        Command::Modes(modes) => modes.run(),
        Command::Frf(frf) => frf.run(),
        Command::Trajectory(trajectory) => trajectory.run(),
        Command::Init(init) => init.run(),
        Command::Completions(completions) => completions.run(Cli::command()),
        Command::Manual(manual) => manual.run(Cli::command()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure { exit, message, hint }) => {
            console::error(&message, hint.as_deref());
            exit.into()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
