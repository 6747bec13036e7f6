//! What shapes the results of `solve` beside its files.

use clap::{Args, Parser};

use crate::cli::args::{NodeArgs, digits_arguments};
use crate::cli::inputs::{ChangeArgs, ResampleArgs, ScaleArgs};
use crate::terminal::Failure;
use flexlink::csv::{Digits, InputFile};
use flexlink::inverse::Analysis;
use flexlink::link::Link;
use flexlink::motion::TipMotion;
use flexlink::spec::Specification;
use flexlink::store::SolveOutputs;

/// The arguments that a run records.
#[derive(Debug, Args)]
pub(crate) struct SolveOptions {
    #[command(flatten)]
    changes: ChangeArgs,

    #[command(flatten)]
    resample: ResampleArgs,

    #[command(flatten)]
    scale: ScaleArgs,

    #[command(flatten)]
    pub(crate) nodes: NodeArgs,

    #[arg(long, help = "Also write nodal_deflections.csv: deflection from the hub's tangent line")]
    deflections: bool,

    #[arg(long, help = "Also write bending_moments.csv")]
    moments: bool,

    /// Digits: the last one is 10^-N of a column's peak, or `full` for the shortest text that
    /// reads back to the same number.
    #[arg(long, value_name = "N", default_value = "10")]
    pub(crate) digits: Digits,

    /// Measure the answer by other means, as `flexlink verify` does, and keep the table in
    /// summary.json; exit code 4 if a number is out of its bound, the results are written.
    #[arg(long)]
    pub(crate) verify: bool,
}

/// The arguments of a record, read as those of the command line are.
#[derive(Debug, Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
pub(crate) struct Recorded {
    #[command(flatten)]
    options: SolveOptions,
}

impl SolveOptions {
    /// What a link file describes.
    pub(crate) fn specification(&self, file: &InputFile) -> Result<Specification, Failure> {
        self.changes.specification(file)
    }

    /// The motion of a link's tip that a file holds.
    pub(crate) fn motion_of(&self, file: &InputFile, link: &Link) -> Result<TipMotion, Failure> {
        self.scale.scaled(self.resample.motion_of(file, link)?)
    }

    /// The analysis of a link file, of all that is to be written.
    pub(crate) fn analysis(&self, analysis: &Analysis) -> Analysis {
        if self.moments { analysis.with_moments() } else { *analysis }
    }

    /// Which tables to write.
    pub(crate) fn outputs(&self) -> SolveOutputs {
        SolveOutputs {
            nodes: self.nodes.list.clone(),
            every: self.nodes.every,
            deflections: self.deflections,
            moments: self.moments,
            digits: self.digits,
        }
    }

    /// Reads the arguments of a record.
    pub(crate) fn recorded(arguments: &[String]) -> Result<Self, clap::Error> {
        Recorded::try_parse_from(arguments).map(|recorded| recorded.options)
    }

    /// The arguments, for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        let flag = |on: bool, name: &str| on.then(|| name.to_owned());
        [
            self.changes.arguments(),
            self.resample.arguments(),
            self.scale.arguments(),
            self.nodes.arguments(),
            Vec::from_iter(flag(self.deflections, "--deflections")),
            Vec::from_iter(flag(self.moments, "--moments")),
            digits_arguments(self.digits),
            Vec::from_iter(flag(self.verify, "--verify")),
        ]
        .concat()
    }
}
