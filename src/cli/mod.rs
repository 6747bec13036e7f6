//! The command line: arguments in, exit code out. `run` of each command reads as load, compute, write, tell.
#![allow(clippy::doc_markdown, reason = "docs of commands and arguments are help on a terminal")]

pub mod compare;
pub mod fit;
pub mod frf;
mod help;
pub mod learn;
pub mod modes;
pub mod options;
pub mod problem;
mod report;
pub mod robust;
mod setup;
pub mod simulate;
pub mod solve;
mod state_space;
pub mod sweep;
pub mod terminal;
pub mod trajectory;
mod verify;

use std::ffi::OsString;

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

use crate::cli::terminal::{Ending, Failure, ThreadArgs, console, interrupt, memory};

/// Torque at a hub, or force on a carriage, that makes the tip of a flexible link follow a wanted motion.
///
/// The link turns about its hub or slides with its carriage, in the horizontal plane or under gravity; the
/// motion goes from rest to rest. The torque starts before the tip moves and outlasts its motion, because bending waves travel at
/// finite speed (E. Bayo, J. Robotic Systems 4(1), 1987).
#[derive(Debug, Parser)]
#[command(name = "flexlink")] // in Python's extension, too, whose package has another name
#[command(version, about, after_help = EXIT_CODES, max_term_width = 100)]
#[command(disable_help_subcommand = true)] // ours prints pages, too
#[command(bin_name = "flexlink")] // on Windows too, where the file is flexlink.exe
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXIT_CODES: &str = "\
Exit codes: 0 done, 1 compared and different, 2 wrong usage,
  3 input refused, 4 not solvable, 5 cannot write, 130 interrupted";

#[derive(Debug, Subcommand)]
enum Command {
    // The doc of each struct is its help.
    Solve(Box<solve::Solve>),
    Simulate(Box<simulate::Simulate>),
    Verify(Box<verify::Verify>),
    Modes(modes::Modes),
    Frf(frf::Frf),
    Fit(fit::Fit),
    Sweep(Box<sweep::Sweep>),
    Robust(Box<robust::Robust>),
    Learn(Box<learn::Learn>),
    Trajectory(Box<trajectory::Trajectory>),
    Compare(compare::Compare),
    Report(report::Report),
    Init(setup::Init),
    Schema(setup::Schema),
    Completions(setup::Completions),
    #[command(name = "man")]
    Manual(setup::Manual),
    Help(help::Help),
}

/// Runs the command of a command line, the program's name first, and returns the exit code. Only this function prints
/// an error and its hint. It sets up the allocator, the threads and the signals of the process.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let mut program = Cli::command();
    let parsed = program.try_get_matches_from_mut(arguments).and_then(|matches| {
        let of_command = matches.subcommand().map(|(_, of_command)| of_command);
        let quiet = of_command.and_then(|found| found.try_get_one("quiet").ok().flatten());
        console::show_remarks(quiet != Some(&true));
        Cli::from_arg_matches(&matches).map_err(|error| error.format(&mut program))
    });
    let ended = match parsed {
        Ok(cli) => cli.command.run().map(|ending| ending as u8),
        Err(error) => console::parser_text(&error),
    };
    ended.unwrap_or_else(|Failure { exit, message, hint, .. }| {
        console::error(&message, hint.as_deref());
        exit as u8
    })
}

impl Command {
    fn run(self) -> Result<Ending, Failure> {
        memory::check_program()?;
        // A sweep ends between two cases.
        if !matches!(self, Self::Sweep(_)) {
            interrupt::end_in_order();
        }
        // These commands start as many threads as their option says.
        let has_threads = matches!(
            self,
            Self::Solve(_)
                | Self::Simulate(_)
                | Self::Verify(_)
                | Self::Sweep(_)
                | Self::Robust(_)
                | Self::Learn(_)
        );
        if !has_threads {
            ThreadArgs::default().start()?;
        }
        let done = match self {
            Self::Compare(compare) => return compare.run(),
            Self::Solve(solve) => return solve.run(),
            Self::Simulate(simulate) => simulate.run(),
            Self::Verify(verify) => verify.run(),
            Self::Modes(modes) => modes.run(),
            Self::Frf(frf) => frf.run(),
            Self::Fit(fit) => fit.run(),
            Self::Sweep(sweep) => sweep.run(),
            Self::Robust(robust) => robust.run(),
            Self::Learn(learn) => learn.run(),
            Self::Trajectory(trajectory) => trajectory.run(),
            Self::Report(report) => report.run(),
            Self::Init(init) => init.run(),
            Self::Schema(schema) => schema.run(),
            Self::Completions(completions) => completions.run(Cli::command()),
            Self::Manual(manual) => manual.run(Cli::command()),
            Self::Help(help) => help.run(Cli::command()),
        };
        done.map(|()| Ending::Done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn help_knows_all_commands() {
        for command in Cli::command().get_subcommands().map(clap::Command::get_name) {
            let words = ["flexlink", "help", command];
            assert!(command == "help" || Cli::try_parse_from(words).is_ok(), "{command}");
        }
    }
}
