//! `solve --repeat`: the repetition of a run, compared with the files of the run.

use std::path::Path;

use crate::csv::InputFile;
use crate::result::{Repeated, RepeatedFile};
use crate::store::{Durability, RunRecord, TemporaryFolder, wait_if_ending};
use crate::text::{excerpt, path_in_shell};

use super::Solve;
use super::run::{Page, Run, SolveOptions};
use super::write_args::WriteArgs;
use crate::cli::terminal::files::{keep, read_once};
use crate::cli::terminal::text::repetition_text;
use crate::cli::terminal::{Ending, Exit, Failure, console};

const VERSION: &str = env!("CARGO_PKG_VERSION");

impl Solve {
    /// Repeats the run in a folder.
    pub(super) fn repeat(&self, run: &Path) -> Result<Ending, Failure> {
        let (record, options, [link, motion]) = self.recorded(run)?;
        let warnings = warn_of_version(&record);
        let again = Run::read(&options, link, || Ok(motion));
        let again = again.map_err(|failure| of_record(failure, &record))?;
        let files = self.repeated(&record, &again)?;
        let ending = self.tell_repeated(run, &files)?;
        self.warnings.refuse(warnings)?;
        Ok(ending)
    }

    /// Reads the record of a run and its options, and finds its inputs.
    fn recorded(&self, run: &Path) -> Result<(RunRecord, SolveOptions, [InputFile; 2]), Failure> {
        let [link, motion] = [&self.link, &self.motion].map(|path| path.as_deref());
        read_once(&[link, motion].into_iter().flatten().collect::<Vec<_>>())?;
        let record = RunRecord::read(run)?;
        let options = recorded_options(&record)?;
        let (link_path, link) = record.input("link", link)?;
        let (motion_path, motion) = record.input("motion", motion)?;
        if let Some(output) = &self.output {
            keep(output, &[&record.path(), &link_path, &motion_path])?;
        }
        Ok((record, options, [link, motion]))
    }

    /// Solves the problem again, and compares its files with those of the run.
    fn repeated(&self, record: &RunRecord, run: &Run<'_>) -> Result<Vec<RepeatedFile>, Failure> {
        // The numbers of the run's torque table are part of its summary.
        let table = WriteArgs::recorded(&record.table_arguments);
        let table = table.map_err(|error| not_read("table.arguments", &error, record))?;
        let compared = |folder: &Path, durability| {
            let stages = self.print.stages();
            let solved = run.solve(&stages).and_then(|solved| {
                let solution = &solved.solved.solution;
                let found = table.table(solution, run.problem.plans(), &stages)?;
                let summary = table.recorded_in(run.summary(&solved), found.as_ref());
                run.write((&solved, &summary), (folder, durability), Page::Left, &stages)
            });
            drop(stages);
            solved.map_err(|failure| of_record(failure, record))?;
            let files = record.compare(folder);
            // A request to end removes the temporary folder.
            wait_if_ending();
            Ok(files?)
        };
        match &self.output {
            Some(output) => compared(output, self.sync.durability()),
            None => TemporaryFolder::new()
                .map_err(Failure::from)
                .and_then(|folder| compared(folder.path(), Durability::InMemory))
                .map_err(elsewhere),
        }
    }

    /// Prints which files differ.
    fn tell_repeated(&self, run: &Path, files: &[RepeatedFile]) -> Result<Ending, Failure> {
        let is_same = files.iter().all(|file| file.outcome == Repeated::Same);
        if !self.print.quiet {
            console::print(&repetition_text(files, run, self.output.as_deref()))?;
            if files.iter().any(is_other_table) {
                console::hint(&match &self.output {
                    Some(output) => {
                        let [run, output] =
                            [run, output].map(|own| path_in_shell(&own.display().to_string()));
                        format!("flexlink compare {run} {output} says by how much")
                    }
                    None => "keep the new results for flexlink compare with -o DIR".to_owned(),
                });
            }
        }
        Ok(if is_same { Ending::Done } else { Ending::Different })
    }
}

/// True if a table has other numbers than the run's.
fn is_other_table(file: &RepeatedFile) -> bool {
    let is_table = Path::new(&file.name).extension().is_some_and(|end| end == "csv");
    is_table && matches!(file.outcome, Repeated::Differs(_))
}

/// The recorded arguments, read like the command line.
fn recorded_options(record: &RunRecord) -> Result<SolveOptions, Failure> {
    let options = SolveOptions::recorded(&record.origin.arguments);
    options.map_err(|error| not_read("inputs.arguments", &error, record))
}

/// The failure of recorded arguments that this version lacks.
fn not_read(key: &str, error: &clap::Error, record: &RunRecord) -> Failure {
    let text = console::shortened(error, error.to_string());
    let first = text.lines().next().unwrap_or_default();
    let why = first.strip_prefix("error: ").unwrap_or(first);
    let shown = &record.shown;
    let message = format!("{shown}: {key} are not those of flexlink {VERSION}: {why}");
    let version = &record.origin.version;
    let hint = (version != VERSION).then(|| format!("flexlink {} wrote it", excerpt(version)));
    Failure::new(Exit::InputRefused, &message, hint.as_deref())
}

/// The failure of a recorded argument, which names the record.
fn of_record(failure: Failure, record: &RunRecord) -> Failure {
    let is_argument = match failure.exit {
        Exit::Usage => true,
        Exit::InputRefused => failure.message.starts_with("--"),
        _ => false,
    };
    if !is_argument {
        return failure;
    }
    let message = format!("{}: inputs.arguments: {}", record.shown, failure.message);
    Failure { exit: Exit::InputRefused, message, ..failure }
}

/// Adds the hint that the temporary files may go to another folder.
fn elsewhere(failure: Failure) -> Failure {
    match failure.exit {
        Exit::CannotWrite => {
            Failure { hint: Some("choose another folder with -o DIR".into()), ..failure }
        }
        _ => failure,
    }
}

/// Warns if another version wrote the record; returns the number of warnings.
fn warn_of_version(record: &RunRecord) -> usize {
    let (shown, version) = (&record.shown, &record.origin.version);
    if version == VERSION {
        return 0;
    }
    let message = format!("{shown}: flexlink = {}, but this is {VERSION}", excerpt(version));
    console::warning(message, "differences may come from the other version");
    1
}

#[cfg(test)]
mod tests {
    use clap::{CommandFactory as _, Parser as _};

    use super::super::run::{Recorded, SolveOptions};
    use crate::cli::Cli;

    /// Arguments that shape no result.
    const OTHERS: [&str; 24] = [
        "link",
        "motion",
        "output",
        "repeat",
        "report",
        "write",
        "start_at",
        "window",
        "hold",
        "with",
        "side",
        "cycle",
        "units",
        "counts",
        "form",
        "joint_names",
        "strict",
        "deny_warnings",
        "sync",
        "no_sync",
        "json",
        "quiet",
        "threads",
        "help",
    ];

    /// A valid value of an argument.
    fn value_of(name: &str) -> &'static str {
        match name {
            "--columns" => "displacement=2",
            "--scale" => "displacement=2.0",
            "--time-unit" => "ms",
            "--unit" => "mm",
            "--delimiter" => ";",
            "--decimal" => "comma",
            _ => "2",
        }
    }

    /// Every argument that shapes the results, with a value if it needs one.
    fn shaping() -> Vec<Vec<String>> {
        let command = Recorded::command();
        let arguments = command.get_arguments().map(|argument| {
            let name = format!("--{}", argument.get_long().unwrap());
            let value = argument.get_action().takes_values().then(|| value_of(&name).to_owned());
            std::iter::once(name).chain(value).collect()
        });
        arguments.collect()
    }

    #[test]
    fn every_argument_that_shapes_the_results_is_recorded_as_it_is_given() {
        let all = shaping();
        assert!(all.len() >= 10, "{all:?}");
        for given in &all {
            assert_eq!(SolveOptions::recorded(given).unwrap().arguments(), *given);
        }
        // A cycle lacks the ends and steps of other options; a golden folder has its own nodes and rows.
        let alone = ["--periodic", "--golden"];
        let together: Vec<_> =
            all.into_iter().filter(|given| !alone.contains(&&*given[0])).collect();
        let of_ends = ["--noise", "--moving-ends"];
        let [without_noise, without_ends] = of_ends.map(|name: &str| -> Vec<String> {
            together.iter().filter(|given| given[0] != name).flatten().cloned().collect()
        });
        for together in [without_noise, without_ends] {
            assert_eq!(SolveOptions::recorded(&together).unwrap().arguments(), together);
        }
    }

    #[test]
    fn every_argument_is_either_recorded_or_shapes_no_result() {
        let cli = Cli::command();
        let solve = cli.find_subcommand("solve").unwrap();
        let recorded = Recorded::command();
        let is_recorded = |id| recorded.get_arguments().any(|argument| argument.get_id() == id);
        for argument in solve.get_arguments() {
            let id = argument.get_id();
            assert!(is_recorded(id) != OTHERS.contains(&id.as_str()), "{id}");
        }
    }

    #[test]
    fn every_argument_that_shapes_the_results_contradicts_a_repetition() {
        for given in shaping() {
            let line = ["flexlink", "solve", "--repeat", "out"].map(str::to_owned);
            let words = Cli::try_parse_from(line.into_iter().chain(given.clone())).unwrap_err();
            assert_eq!(words.kind(), clap::error::ErrorKind::ArgumentConflict, "{given:?}");
        }
    }
}
