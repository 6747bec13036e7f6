//! `simulate`: a torque played on a link, or torques on an arm.

pub mod arm;
mod options;

use std::path::Path;
use std::slice::from_ref;

use crate::csv::InputFile;
use crate::elastica::SecondOrder;
use crate::inverse::Unwatched;
use crate::response::{CycleError, Play, PlayError, Simulation, SimulationError, simulate};
use crate::result::{Comparison, FollowedTarget, Limits, PlayedMetrics, TargetError};
use crate::spec::{Described, Specification};
use crate::store::{PlayFindings, RunInputs, RunTables, SimulateFiles, Summary, state_json};
use crate::text::{plain, shown_path};

use self::arm::ArmInputs;
pub(crate) use self::options::Simulate;
use self::options::shown;
use crate::cli::options::inputs::described;
use crate::cli::options::play::Playing;
use crate::cli::terminal::files::{keep, keep_inputs};
use crate::cli::terminal::text::simulate_text;
use crate::cli::terminal::{Exit, Failure, console, memory};

/// What is played: a link, or an arm of several.
enum OneOrSeveral {
    One(Box<Inputs>),
    Several(Box<ArmInputs>),
}

/// The inputs, read.
struct Inputs {
    link_file: InputFile,
    specification: Specification,
    playing: Playing,
}

/// The simulation, and its errors.
struct Played<'a> {
    play: Play<'a>,
    simulation: Simulation,
    metrics: PlayedMetrics,
    error: Option<PlayError>,
    limits: Limits,
    target: Option<FollowedTarget>,
    comparison: Option<Comparison>,
}

impl Simulate {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        let inputs = match self.load()? {
            OneOrSeveral::One(inputs) => inputs,
            OneOrSeveral::Several(inputs) => return self.run_arm(&inputs),
        };
        let stages = self.print.stages();
        stages.at("playing");
        let played = self.compute(&inputs)?;
        stages.at("writing");
        let summary = self.write(&inputs, &played)?;
        drop(stages);
        self.tell(&summary, |written| {
            let Played { play, simulation, metrics, .. } = &played;
            let link = &inputs.specification.link;
            simulate_text(link, play, simulation, metrics, &played.findings(), written)
                + &self.nodes.text(&[simulation.mesh.nodes_m()])
        })
    }

    /// Reads all files; every error names its file.
    fn load(&self) -> Result<OneOrSeveral, Failure> {
        let files = [self.link.link.as_path()].into_iter().chain(self.play.files());
        let files: Vec<&Path> = files.collect();
        keep(&self.output, &files)?;
        if let Some(path) = &self.play.save_state {
            keep_inputs("--save-state", path, &files)?;
        }
        let link_file = InputFile::read_toml(&self.link.link)?;
        let described = described(&link_file, &self.link.changes.overrides()?)?;
        match self.nodes.meshed(described)? {
            Described::Link(specification) => {
                let playing = self.play.load(&specification.link, &self.read)?;
                let inputs = Inputs { link_file, specification: *specification, playing };
                Ok(OneOrSeveral::One(Box::new(inputs)))
            }
            Described::Arm(specification) => {
                self.load_arm(link_file, specification).map(Box::new).map(OneOrSeveral::Several)
            }
        }
    }

    /// Plays the input until the time of the command line, else as long as input and target last.
    /// Computes the errors of the tip and of the simulation itself, and what a recording differs by.
    fn compute<'a>(&self, inputs: &'a Inputs) -> Result<Played<'a>, Failure> {
        let Specification { link, mesh, analysis, .. } = &inputs.specification;
        let is_large = analysis.second_order_of(link) != SecondOrder::None;
        let play = inputs.playing.play(self.play.until, is_large);
        let refused = |error| self.refused(&error, inputs);
        let simulation = simulate(link, mesh, &play).map_err(refused)?;
        self.nodes.check(&[simulation.mesh.nodes_m()])?;
        let target = inputs.playing.target.as_ref().map(|(_, target)| {
            let followed = FollowedTarget::of(&simulation, target);
            followed.map_err(|error| self.target_refused(error, inputs.target_shown()))
        });
        let target = target.transpose()?;
        let compared = inputs.playing.measured.as_ref().map(|(file, measured)| {
            Comparison::of(&simulation, measured).map_err(|error| {
                let message = format!("{}{error}", shown(file));
                Failure::new(Exit::InputRefused, &message, Some(error.hint()))
            })
        });
        let comparison = compared.transpose()?;
        let bytes = self.nodes.outputs(self.digits).simulation_bytes(&simulation);
        memory::check_nodes(bytes, play.memory_bytes)?;
        let error = PlayError::of(&simulation, link, &play).map_err(refused)?;
        let metrics = PlayedMetrics::of(&simulation);
        let limits = inputs.specification.limits;
        Ok(Played { play, simulation, metrics, error, limits, target, comparison })
    }

    /// The failure of a simulation, with the file or option that causes it.
    fn refused(&self, error: &SimulationError, inputs: &Inputs) -> Failure {
        let (exit, place) = match error {
            SimulationError::NoTorque
            | SimulationError::NoTurn
            | SimulationError::Cycle(CycleError::Mean { .. } | CycleError::Repeats) => {
                (Exit::InputRefused, shown(&inputs.playing.file))
            }
            SimulationError::OtherTimes { .. }
            | SimulationError::Cycle(CycleError::Reference { .. }) => {
                let Playing { file, reference_file, .. } = &inputs.playing;
                (Exit::InputRefused, shown(reference_file.as_ref().unwrap_or(file)))
            }
            // The target is longer than the input.
            SimulationError::TooLong { until_s, samples, limit } if self.play.until.is_none() => {
                let place = inputs.target_shown();
                let found =
                    format!("the end = {} s, {samples:.3e} steps of the input", plain(*until_s));
                let message = format!("{place}{found}, but must be at most {limit} steps");
                return Failure::new(Exit::InputRefused, &message, error.hint());
            }
            SimulationError::NoStartAngle => (Exit::InputRefused, String::new()),
            SimulationError::State { .. } => {
                let file = inputs.playing.state.as_ref();
                (Exit::InputRefused, file.map(|(file, _)| shown(file)).unwrap_or_default())
            }
            // The message begins with the option's name.
            SimulationError::TooLong { .. } | SimulationError::EndsEarly { .. } => {
                (Exit::Usage, "--".to_owned())
            }
            SimulationError::Plan(_)
            | SimulationError::Cycle(
                CycleError::Resonance | CycleError::Free | CycleError::Unsettled { .. },
            )
            | SimulationError::Damping(_)
            | SimulationError::MasslessHub
            | SimulationError::NotDerived { .. }
            | SimulationError::NotConverged { .. }
            | SimulationError::NoRest
            | SimulationError::TooMuchMemory { .. }
            | SimulationError::NotFinite { .. } => (Exit::NotSolvable, String::new()),
        };
        Failure::new(exit, &format!("{place}{error}"), error.hint())
    }

    /// The failure of a target in this file that the simulation does not reach.
    fn target_refused(&self, error: TargetError, shown: String) -> Failure {
        let (exit, place) = match (error, self.play.until) {
            (TargetError::EndsLate { .. }, Some(until)) => {
                (Exit::Usage, format!("--until {}: ", plain(until)))
            }
            _ => (Exit::InputRefused, shown),
        };
        Failure::new(exit, &format!("{place}{error}"), error.hint())
    }

    /// Writes all tables and summary.json.
    fn write(&self, inputs: &Inputs, played: &Played) -> Result<Summary, Failure> {
        let link = &inputs.specification.link;
        let Playing { file, target, measured, reference_file, .. } = &inputs.playing;
        let files = SimulateFiles {
            input: file,
            target: target.as_ref().map(|(file, _)| file),
            measured: measured.as_ref().map(|(file, _)| file),
            reference: reference_file.as_ref(),
            state: inputs.playing.state.as_ref().map(|(file, _)| file),
        };
        let Played { play, simulation, metrics, .. } = played;
        let record = RunInputs::of_simulate(
            &inputs.link_file,
            &files,
            play.input.is_torque(),
            self.arguments(),
        );
        let findings = played.findings();
        let summary = Summary::of_simulation(record, (link, play), simulation, metrics, &findings);
        let folder = self.sync.stage(&self.output)?;
        let outputs = self.nodes.outputs(self.digits);
        let tables = RunTables::of_simulation((link, simulation), findings.target, &outputs)?;
        outputs.write(folder, tables, (&summary, None), &Unwatched)?;
        if let Some(path) = &self.play.save_state {
            console::deliver(Some(path), state_json(&simulation.state()).as_bytes())?;
        }
        Ok(summary)
    }

    /// Prints warnings and the summary, whose text says what was `written`.
    fn tell(&self, summary: &Summary, text: impl FnOnce(String) -> String) -> Result<(), Failure> {
        let warnings = summary.warnings();
        console::warnings(warnings.iter().cloned());
        let written = || format!("{} files in {}", summary.file_count(), shown_path(&self.output));
        self.print.print(|| summary.to_json(), || text(written()))?;
        self.warnings.refuse(warnings.len())
    }
}

impl Inputs {
    /// The name of the target's file, as a message begins with it.
    fn target_shown(&self) -> String {
        self.playing.target.as_ref().map(|(file, _)| shown(file)).unwrap_or_default()
    }
}

impl Played<'_> {
    fn findings(&self) -> PlayFindings<'_> {
        PlayFindings {
            error: self.error.as_ref(),
            limits: from_ref(&self.limits),
            target: self.target.as_ref(),
            comparison: self.comparison.as_ref(),
        }
    }
}
