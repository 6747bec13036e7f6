//! The full results of every case of a sweep.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::args::{NodeArgs, SyncArgs, digits_arguments, option};
use crate::terminal::{Exit, Failure, memory};
use flexlink::csv::Digits;
use flexlink::inverse::{Solution, Unwatched};
use flexlink::response::{PlayError, Simulation};
use flexlink::result::Exceeded;
use flexlink::store::{
    OutputFolder, RunInputs, SimulateOutputs, SimulationInputs, SolveOutputs, Summary,
};
use flexlink::sweep::{PlayedCase, SolvedCase};

/// Which files every case is to write.
#[derive(Debug, Args)]
pub(crate) struct OutputsArgs {
    /// Also write the results of every case, as solve or simulate do, into folders DIR/1, DIR/2,
    /// …, numbered as the rows are.
    #[arg(long, value_name = "DIR")]
    pub(crate) outputs: Option<PathBuf>,

    #[command(flatten)]
    nodes: NodeArgs,

    /// Digits of the tables in --outputs, as in solve.
    #[arg(long, value_name = "N", default_value = "10", requires = "outputs")]
    digits: Digits,

    #[command(flatten)]
    pub(crate) sync: SyncArgs,
}

impl OutputsArgs {
    /// The arguments that shape the files of a case, for its record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        [self.nodes.arguments(), digits_arguments(self.digits)].concat()
    }

    /// What makes the files of the cases, for the identity of a sweep: rows that are there already
    /// have these files.
    pub(crate) fn identity(&self) -> Vec<String> {
        let folder = self.outputs.iter().flat_map(|folder| option("--outputs", folder.display()));
        folder.chain(self.arguments()).collect()
    }

    /// Folder of a case, from 0, among so many.
    pub(crate) fn folder_of(&self, case: usize, cases: usize) -> Option<PathBuf> {
        let width = cases.to_string().len();
        self.outputs.as_ref().map(|folder| folder.join(format!("{:0width$}", case + 1)))
    }

    /// Writes what solve writes.
    pub(crate) fn write_solution(
        &self,
        folder: &Path,
        inputs: &RunInputs,
        (solution, case, exceeded): (&Solution, &SolvedCase, &[Exceeded]),
        memory_bytes: Option<usize>,
    ) -> Result<(), Failure> {
        self.nodes.check(solution.mesh())?;
        let outputs = SolveOutputs {
            nodes: self.nodes.list.clone(),
            every: self.nodes.every,
            optional: Vec::new(),
            digits: self.digits,
        };
        let files = outputs.file_names(solution.link());
        let summary = Summary::of_solution(inputs, solution, &case.metrics, exceeded, &files);
        let deflections = outputs.deflections(solution);
        memory::check_nodes(deflections.bytes(), memory_bytes)?;
        let nodal = (solution, deflections);
        Ok(outputs.write(self.stage(folder)?, nodal, (&summary, None), &Unwatched)?)
    }

    /// Writes what simulate writes.
    pub(crate) fn write_simulation(
        &self,
        folder: &Path,
        inputs: &SimulationInputs,
        simulation: &Simulation,
        case: &PlayedCase,
        error: Option<&PlayError>,
    ) -> Result<(), Failure> {
        self.nodes.check(&simulation.mesh)?;
        let outputs = self.nodes.of_simulation(self.digits);
        memory::check_nodes(outputs.nodal_bytes(simulation), inputs.play.memory_bytes)?;
        let (files, errors) = (SimulateOutputs::file_names(), (error, Some(&case.tip_error)));
        let summary = Summary::of_simulation(inputs, simulation, &case.metrics, errors, &files);
        Ok(outputs.write(self.stage(folder)?, inputs.link, simulation, &summary)?)
    }

    /// Opens the folder of a case, which the command line does not name: it must lead nowhere else.
    fn stage(&self, folder: &Path) -> Result<OutputFolder, Failure> {
        if folder.is_symlink() {
            let shown = folder.display();
            let message = format!("{shown}: is a symbolic link, but must be a folder of its own");
            return Err(Failure::new(Exit::CannotWrite, &message, None));
        }
        self.sync.stage(folder)
    }
}
