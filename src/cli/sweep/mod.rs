//! `sweep`: many cases, with a row of one table for each.

pub mod cases;
mod table;
pub mod tally;
mod work;

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::options::inputs::{LINK, MOTION};
use crate::cli::terminal::console::is_standard_output;
use crate::cli::terminal::files::{
    keep_cases, keep_files, keep_from_cases, keep_record, read_once,
};
use crate::cli::terminal::{CaseBar, Exit, Failure, ThreadArgs, WarningArgs, console, interrupt};
use crate::store::{NamedBy, SweepRows, sweep_header, sweep_row};
use crate::sweep::{PlanError, Shard, SweepPlan, Variation, in_order};
use crate::text::{counted, excerpt, shown_path, visible};
use cases::{CaseArgs, Cases};
use table::{EarlyEnd, OpenedTable, TableOutput, merge};
use tally::Tally;
use work::Outcome;

const EXAMPLE: &str = "\
Example:
  flexlink sweep link.toml move.csv \\
      --vary 'segments.*.EI*=0.5:8:100:log' -o stiffness.csv
  flexlink sweep link.toml move.csv \\
      --vary payload.mass=0,0.05 --vary 'duration*=0.8:2:25'
  flexlink sweep link.toml move.csv --torque torque.csv \\
      --vary 'segments.*.EI*=0.8:1.2:41'
  flexlink sweep link.toml move.csv --torque torque.csv \\
      --feedback 20,2 --reference hub_angle.csv \\
      --vary 'segments.*.EI*=0.8:1.2:41'
  flexlink sweep link.toml move.csv --torque encoder.csv \\
      --input hub-angle --vary payload.mass=0:0.1:11
  flexlink sweep link.toml move.csv --shard 2/8 \\
      --vary 'segments.*.EI*=0.5:8:1000:log'
  flexlink sweep arm.toml path.csv \\
      --vary 'links.*.segments.*.EI*=0.5:2:10'
  flexlink sweep --merge sweep-*-of-8.csv -o sweep.csv

LINK and MOTION as for solve. Exit codes as `flexlink --help` lists them: 0 even if some
cases fail; 4 if all fail, or if one fails and --strict or --deny-warnings is given.";

const USAGE: &str = "\
flexlink sweep [OPTIONS] <LINK> <MOTION> --vary <PATH=VALUES>...
       flexlink sweep --merge <SHARD>... [-o <FILE>]";

const LONG_ABOUT: &str = "\
Solve many cases: vary values of link and motion.

Writes one table with a row for every case, in order whatever the number of threads: the values, \
first period and zero, peaks, lead and lag, errors, kinds of warnings. A case that fails says why in \
the column `error` and does not stop the rest. Beside the table NAME.csv lies NAME.json: link, motion, \
arguments and SHA-256. While it runs, the finished rows are in a file of the same name that \
ends in .part; after an interruption (exit code 130) the same command with --resume goes on from \
there; without --resume it starts from the beginning. With --resume a finished shard is kept; a \
finished table is always computed anew.

PATH is that of --set, with = for values and *= for factors; distance*= and duration*= scale the \
motion. VALUES are START:STOP:COUNT, START:STOP:COUNT:log, or a list a,b,c; both ends of a range may \
have a unit. Several --vary make the product, the last one running fastest.

With --torque every case plays one table as simulate does: torques, with feedback or without, a motion of the joints \
or voltages. A row says how far the tip strays from MOTION.

LINK and MOTION may be an arm of several links and its path (docs/arms.md). A row then has the numbers of every joint.";

/// Most cases of one run; at a millisecond each they take more than a week.
const MOST_CASES: usize = 1_000_000_000;

/// Solve many cases: vary values of link and motion.
#[derive(Debug, Args)]
#[command(long_about = LONG_ABOUT, after_help = EXAMPLE, override_usage = USAGE)]
#[command(mut_arg("list", |nodes| nodes.requires("outputs")))]
#[command(mut_arg("stations_m", |stations| stations.requires("outputs")))]
#[command(mut_arg("input", |input| input.requires("torque")))]
#[command(mut_arg("column", |column| column.requires("torque")))]
#[command(mut_arg("hold", |hold| hold.requires("torque")))]
#[command(mut_arg("linear", |linear| linear.requires("torque")))]
#[command(mut_arg("feedback", |feedback| feedback.requires("torque")))]
#[command(mut_arg("every", |every| every.requires("outputs")))]
#[command(mut_arg("sync", |sync| sync.conflicts_with("merge")))]
pub(crate) struct Sweep {
    #[arg(value_name = "LINK", help = LINK, required_unless_present = "merge")]
    link: Option<PathBuf>,

    #[arg(value_name = "MOTION", help = MOTION, required_unless_present = "merge")]
    motion: Option<PathBuf>,

    /// Value to vary; repeatable: the cases are all combinations.
    #[arg(long, value_name = "PATH=VALUES", required_unless_present = "merge")]
    vary: Vec<String>,

    /// Table to write, `-` for standard output [default: sweep.csv, for a shard sweep-I-of-N.csv].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    #[command(flatten)]
    shared: CaseArgs,

    /// Solve only every N-th case, from the I-th on, into a separate file.
    #[arg(long, value_name = "I/N", default_value_t, hide_default_value = true)]
    shard: Shard,

    /// Continue an interrupted run of the same sweep.
    #[arg(long)]
    resume: bool,

    /// Join the shards of a sweep to one table, if none is missing.
    #[arg(long, value_name = "SHARD", num_args = 1..)]
    #[arg(conflicts_with_all = ["link", "motion", "changes", "resample", "vary", "torque"])]
    #[arg(conflicts_with_all = ["input", "feedback", "reference"])]
    #[arg(conflicts_with_all = ["column", "hold", "linear", "outputs", "shard", "resume", "columns", "time_unit"])]
    #[arg(conflicts_with_all = ["sample_rate", "unit", "scale", "skip", "delimiter", "decimal", "scale_distance", "scale_duration"])]
    merge: Vec<PathBuf>,

    /// Fail with exit code 4 if a case failed or exceeds a limit of the link file; the table is
    /// written.
    #[arg(long)]
    strict: bool,

    #[command(flatten)]
    warnings: WarningArgs,

    /// Print nothing but warnings and errors, and no progress.
    #[arg(long, short)]
    quiet: bool,

    #[command(flatten)]
    threads: ThreadArgs,
}

impl Sweep {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start_apart()?;
        let (Some(link), Some(motion)) = (&self.link, &self.motion) else {
            return self.merge();
        };
        let cases = self.load(link, motion)?;
        let (mut table, mut tally, warnings) = match self.open(&cases)? {
            OpenedTable::Unfinished(table, earlier, warnings) => {
                (table, earlier.map(|rows| tally_of(&cases, &rows)).unwrap_or_default(), warnings)
            }
            OpenedTable::Complete(rows) => return self.tell_complete(&tally_of(&cases, &rows)),
        };
        match self.compute(&cases, &mut table, &mut tally) {
            Ok(()) => {}
            Err(EarlyEnd::ReaderGone) => return Ok(()),
            Err(EarlyEnd::Failed(failure)) => {
                if tally.rows() == 0 {
                    table.discard();
                }
                return Err(failure);
            }
        }
        tally.warn();
        self.write(table, &tally, &cases)?;
        self.report(&format!("cases    {}", tally.rows()))?;
        self.judge(&tally, warnings)
    }

    /// Reads the common inputs of all cases.
    fn load(&self, link: &Path, motion: &Path) -> Result<Cases<'_>, Failure> {
        self.check_files()?;
        Cases::read(self.plan()?, link, motion, &self.shared)
    }

    /// Opens the table for the rows of this run's shard.
    fn open(&self, cases: &Cases) -> Result<OpenedTable, Failure> {
        let header = sweep_header(&cases.plan, cases.kind);
        let identity = cases.identity(&self.vary, self.shard);
        TableOutput::open(&self.output_path(), identity, &header, self.resume)
    }

    /// Computes the cases without rows in the table, and appends each row at once.
    fn compute(
        &self,
        cases: &Cases,
        table: &mut TableOutput,
        tally: &mut Tally,
    ) -> Result<(), EarlyEnd> {
        let (done, all) = (tally.rows(), self.shard.len(cases.plan.cases()));
        let is_silent = self.quiet || table.is_printed();
        let progress = if is_silent { CaseBar::hidden() } else { CaseBar::new(done, all) };
        let take = |k: usize, Outcome { row, warnings, remarks }| {
            let (case, row) = (self.shard.case(k), row?);
            let kinds: Vec<&str> = warnings.iter().map(|warning| &*warning.kind).collect();
            let line = sweep_row(&cases.plan.case(case), &row, cases.kind, &kinds);
            tally.add(case + 1, row.as_ref().err(), warnings, &remarks);
            progress.advance();
            table.append(&line)
        };
        let work = |k| interrupt::at_work(|| cases.outcome(self.shard.case(k)));
        in_order(done..all, interrupt::watch(), work, take)
    }

    /// Gives the table its name; returns an error for an incomplete table.
    fn write(&self, table: TableOutput, tally: &Tally, cases: &Cases) -> Result<(), Failure> {
        let all = self.shard.len(cases.plan.cases());
        if tally.rows() < all {
            return Err(table.interrupted(tally.rows(), all));
        }
        table.finish(self.named_by(), self.shared.outputs.sync.durability())
    }

    /// Returns an error for cases that the options refuse, and for `warnings` of the run.
    fn judge(&self, tally: &Tally, warnings: usize) -> Result<(), Failure> {
        // A shard is only a part: others may have numbers.
        if self.shard.of() == 1 {
            tally.refuse_all_failed()?;
        }
        self.refuse(tally)?;
        self.warnings.refuse(warnings)
    }

    fn merge(&self) -> Result<(), Failure> {
        let tally = merge(&self.merge, &self.output_path(), self.named_by())?;
        tally.warn();
        self.report(&format!("cases    {}, of {} shards", tally.rows(), self.merge.len()))?;
        tally.refuse_all_failed()?;
        self.refuse(&tally)
    }

    fn plan(&self) -> Result<SweepPlan, Failure> {
        let read = |text: &String| {
            text.parse::<Variation>().map_err(|error| {
                let message = format!("--vary '{}': {error}", visible(&excerpt(text)));
                Failure::new(Exit::Usage, &message, Some(error.hint()))
            })
        };
        let variations: Vec<Variation> = self.vary.iter().map(read).collect::<Result<_, _>>()?;
        let refused = |error: PlanError| {
            Failure::new(Exit::Usage, &format!("--vary: {error}"), Some(error.hint()))
        };
        let plan = SweepPlan::new(variations).map_err(refused)?;
        let cases = self.shard.len(plan.cases());
        if cases <= MOST_CASES {
            return Ok(plan);
        }
        let message = format!("--vary: {cases} cases, but must be at most {MOST_CASES} in one run");
        Err(Failure::new(Exit::Usage, &message, Some("use fewer values, or a part: --shard")))
    }

    /// Prints that an earlier run has completed the sweep.
    fn tell_complete(&self, tally: &Tally) -> Result<(), Failure> {
        tally.warn();
        let (output, cases) = (self.output_path(), counted(tally.rows(), "case"));
        self.say(&format!("complete {}, {cases}\n", shown_path(&output)))?;
        self.refuse(tally)
    }

    /// Returns an error for cases that --strict or --deny-warnings refuse.
    fn refuse(&self, tally: &Tally) -> Result<(), Failure> {
        if self.strict {
            tally.refuse_exceeding()?;
        }
        if self.warnings.are_denied() { tally.refuse_warned() } else { Ok(()) }
    }

    /// Refuses files that the sweep would read twice or overwrite.
    fn check_files(&self) -> Result<(), Failure> {
        let files = self.link.iter().chain(&self.motion).map(PathBuf::as_path);
        let played = &self.shared.torque;
        let played = [&played.torque, &played.moving.reference].into_iter().flatten();
        let inputs: Vec<&Path> = files.chain(played.map(PathBuf::as_path)).collect();
        read_once(&inputs)?;
        keep_files(&self.output_path(), &inputs)?;
        keep_record(&self.output_path())?;
        let Some(folder) = &self.shared.outputs.outputs else { return Ok(()) };
        keep_cases(folder, &inputs)?;
        keep_from_cases(&self.output_path(), folder)
    }

    fn output_path(&self) -> PathBuf {
        let shard = self.shard;
        self.output.clone().unwrap_or_else(|| match shard.of() {
            1 => "sweep.csv".into(),
            of => format!("sweep-{}-of-{of}.csv", shard.number()).into(),
        })
    }

    fn named_by(&self) -> NamedBy {
        if self.output.is_some() { NamedBy::User } else { NamedBy::Program }
    }

    /// Prints the finished work, and the place of the table.
    fn report(&self, done: &str) -> Result<(), Failure> {
        self.say(&format!("{done}\nwritten  {}\n", shown_path(&self.output_path())))
    }

    /// Prints to standard output, unless the table goes there.
    fn say(&self, text: &str) -> Result<(), Failure> {
        if self.quiet || is_standard_output(&self.output_path()) {
            return Ok(());
        }
        console::print(text)
    }
}

/// Counts the cases of earlier rows.
fn tally_of(cases: &Cases, rows: &SweepRows) -> Tally {
    Tally::of_cases(rows.cases(), |case| cases.remarks(case))
}
