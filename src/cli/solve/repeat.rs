//! A run of `solve` done again, and held against what it has left.

use std::path::Path;

use flexlink::numeric::excerpt;
use flexlink::result::{Repeated, RepeatedFile};
use flexlink::store::{Durability, RunRecord, TemporaryFolder, wait_if_ending};

use super::options::SolveOptions;
use super::run::{Destination, Problem, WithPage};
use crate::terminal::files::{keep, read_once};
use crate::terminal::text::repetition_text;
use crate::terminal::{Ending, Exit, Failure, PrintArgs, WarningArgs, console};

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What to do again.
pub(crate) struct Repetition<'a> {
    /// The folder of the run.
    pub(crate) run: &'a Path,
    pub(crate) link: Option<&'a Path>,
    pub(crate) motion: Option<&'a Path>,
    /// Where the new results are kept, if they are.
    pub(crate) output: Option<&'a Path>,
    pub(crate) durability: Durability,
    pub(crate) print: &'a PrintArgs,
    pub(crate) warnings: &'a WarningArgs,
}

impl Repetition<'_> {
    pub(crate) fn run(&self) -> Result<Ending, Failure> {
        let given: Vec<&Path> = self.link.into_iter().chain(self.motion).collect();
        read_once(&given)?;
        let record = RunRecord::read(self.run)?;
        let options = recorded_options(&record)?;
        let (link_path, link_file) = record.link(self.link)?;
        let (motion_path, motion_file) = record.motion(self.motion)?;
        if let Some(output) = self.output {
            keep(output, &[&record.path(), &link_path, &motion_path])?;
        }
        let warnings = warn_of_version(&record);
        let problem = Problem::read(&options, link_file, || Ok(motion_file));
        let problem = problem.map_err(|failure| of_record(failure, &record))?;
        let files = if let Some(output) = self.output {
            self.compared(&record, &problem, &options, output)?
        } else {
            let folder = TemporaryFolder::new().map_err(|error| elsewhere(error.into()))?;
            self.compared(&record, &problem, &options, folder.path()).map_err(elsewhere)?
        };
        let ending = self.tell(&files)?;
        self.warnings.refuse(warnings)?;
        Ok(ending)
    }

    fn compared(
        &self,
        record: &RunRecord,
        problem: &Problem,
        options: &SolveOptions,
        folder: &Path,
    ) -> Result<Vec<RepeatedFile>, Failure> {
        // No one keeps files without a folder of their own.
        let durability = self.output.map_or(Durability::InMemory, |_| self.durability);
        let stages = self.print.stages();
        let to = Destination { folder, durability, page: WithPage::No, stages: &stages };
        let solved = problem.solve(options, &to);
        drop(stages);
        solved.map_err(|failure| of_record(failure, record))?;
        let files = record.compare(folder);
        // A request to end takes the temporary folder away.
        wait_if_ending();
        Ok(files?)
    }

    fn tell(&self, files: &[RepeatedFile]) -> Result<Ending, Failure> {
        let is_same = files.iter().all(|file| file.outcome == Repeated::Same);
        if !self.print.quiet {
            console::print(&repetition_text(files, self.run, self.output))?;
            if let Some(hint) = self.hint(files) {
                console::hint(&hint);
            }
        }
        Ok(if is_same { Ending::Done } else { Ending::Different })
    }

    /// How to find out by how much tables differ, if any does.
    fn hint(&self, files: &[RepeatedFile]) -> Option<String> {
        let is_other_table = |file: &RepeatedFile| {
            let is_table = Path::new(&file.name).extension().is_some_and(|end| end == "csv");
            is_table && matches!(file.outcome, Repeated::Differs(_))
        };
        files.iter().any(is_other_table).then(|| match self.output {
            Some(output) => {
                let (run, output) = (self.run.display(), output.display());
                format!("flexlink compare {run} {output} says by how much")
            }
            None => "-o DIR keeps the new results, for flexlink compare".to_owned(),
        })
    }
}

/// The recorded arguments, read as those of the command line are.
fn recorded_options(record: &RunRecord) -> Result<SolveOptions, Failure> {
    SolveOptions::recorded(&record.origin.arguments).map_err(|words| {
        let words = console::shortened(&words, words.to_string());
        let first = words.lines().next().unwrap_or_default();
        let why = first.strip_prefix("error: ").unwrap_or(first);
        let shown = &record.shown;
        let message =
            format!("{shown}: inputs.arguments are not those of flexlink {VERSION}: {why}");
        let version = &record.origin.version;
        let hint = (version != VERSION).then(|| format!("flexlink {} wrote it", excerpt(version)));
        Failure::new(Exit::InputRefused, &message, hint.as_deref())
    })
}

/// A wrong argument is one of the record.
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

/// What cannot be written to where nobody keeps it may be written elsewhere.
fn elsewhere(failure: Failure) -> Failure {
    match failure.exit {
        Exit::CannotWrite => {
            Failure { hint: Some("-o DIR takes another folder".to_owned()), ..failure }
        }
        _ => failure,
    }
}

/// Warns where another version wrote the record; returns how many warnings it printed.
fn warn_of_version(record: &RunRecord) -> usize {
    let (shown, version) = (&record.shown, &record.origin.version);
    if version == VERSION {
        return 0;
    }
    let message = format!("{shown}: flexlink = {}, but this is {VERSION}", excerpt(version));
    console::warning(message, "what differs may come from that");
    1
}

#[cfg(test)]
mod tests {
    use clap::{CommandFactory as _, Parser as _};

    use super::super::options::{Recorded, SolveOptions};
    use crate::cli::Cli;

    /// Arguments that shape no result.
    const OTHERS: [&str; 13] = [
        "link",
        "motion",
        "output",
        "repeat",
        "report",
        "strict",
        "deny_warnings",
        "sync",
        "no_sync",
        "json",
        "quiet",
        "threads",
        "help",
    ];

    /// Every argument that shapes the results, with a value where it takes one.
    fn shaping() -> Vec<Vec<String>> {
        let command = Recorded::command();
        let arguments = command.get_arguments().map(|argument| {
            let name = format!("--{}", argument.get_long().unwrap());
            let value = argument.get_action().takes_values().then(|| "2".to_owned());
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
        let together = all.concat();
        assert_eq!(SolveOptions::recorded(&together).unwrap().arguments(), together);
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
