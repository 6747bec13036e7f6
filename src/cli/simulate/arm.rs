//! `simulate` of an arm of several links.

use std::path::Path;

use crate::beam::{Mesh, MeshPlan};
use crate::csv::InputFile;
use crate::inverse::Unwatched;
use crate::link::ArmLink;
use crate::response::{ArmPlay, ArmPlayWarning, PlayedArm, SimulationError, simulate_arm};
use crate::result::{FollowedTarget, PlayedMetrics};
use crate::spec::ArmSpecification;
use crate::store::{PlayedRun, RunInputs, RunTables, SimulateFiles, Summary, state_json};

use super::options::{Simulate, shown};
use crate::cli::options::common::refuse_for_arms;
use crate::cli::options::play_arm::ArmPlaying;
use crate::cli::terminal::text::played_arm_text;
use crate::cli::terminal::{Exit, Failure, StageBar, console};

/// The inputs, read.
pub(super) struct ArmInputs {
    arm_file: InputFile,
    specification: Box<ArmSpecification>,
    playing: ArmPlaying,
}

/// The simulation, and its errors.
struct Played<'a> {
    play: ArmPlay<'a>,
    motion: PlayedArm,
    metrics: PlayedMetrics,
    warnings: Vec<ArmPlayWarning>,
    target: Option<FollowedTarget>,
    nodes_m: Vec<Vec<f64>>,
}

impl Simulate {
    /// Reads the files of an arm.
    pub(super) fn load_arm(
        &self,
        arm_file: InputFile,
        specification: Box<ArmSpecification>,
    ) -> Result<ArmInputs, Failure> {
        refuse_for_arms(self.nodes.chosen().map(str::to_owned))?;
        let playing = self.play.load_arm(&specification.arm, &self.read)?;
        Ok(ArmInputs { arm_file, specification, playing })
    }

    /// Plays the torques, writes and tells.
    pub(super) fn run_arm(&self, inputs: &ArmInputs) -> Result<(), Failure> {
        let played = self.compute_arm(inputs)?;
        let run = played.run(inputs);
        let summary = self.write_arm(inputs, &run)?;
        console::remarks(&inputs.specification.remarks);
        self.tell(&summary, |written| played_arm_text(&run, &written))
    }

    fn compute_arm<'a>(&self, inputs: &'a ArmInputs) -> Result<Played<'a>, Failure> {
        let ArmSpecification { arm, meshes, .. } = &*inputs.specification;
        let tolerance = MeshPlan::smallest_tolerance(meshes);
        let ArmPlaying { played, target_file, .. } = &inputs.playing;
        let play = played.play(self.play.until, tolerance);
        let stages = StageBar::new();
        let simulated = simulate_arm(arm, meshes, &play, &|progress| stages.played(progress));
        drop(stages);
        let (motion, warnings) = simulated.map_err(|error| self.arm_refused(&error, inputs))?;
        let target = target_file.as_ref().zip(played.target.as_ref());
        let target = target.map(|(file, target)| {
            let followed = FollowedTarget::of_arm(&motion, target);
            followed.map_err(|error| self.target_refused(error, shown(file)))
        });
        let target = target.transpose()?;
        let nodes_m = nodes_m(&inputs.specification)?;
        let metrics = PlayedMetrics::of_arm(&motion);
        Ok(Played { play, motion, metrics, warnings, target, nodes_m })
    }

    /// The failure of a simulation, with the file or option that causes it.
    fn arm_refused(&self, error: &SimulationError, inputs: &ArmInputs) -> Failure {
        let playing = &inputs.playing;
        let (exit, place) = match error {
            SimulationError::OtherTimes { .. } => {
                let file = playing.reference_file.as_ref().unwrap_or(&playing.file);
                (Exit::InputRefused, shown(file))
            }
            SimulationError::State { .. } => {
                let file = playing.state_file.as_ref();
                (Exit::InputRefused, file.map(shown).unwrap_or_default())
            }
            SimulationError::TooLong { .. } | SimulationError::EndsEarly { .. } => {
                // The message begins with the option's name.
                let place = if self.play.until.is_some() { "--" } else { "the target's end: " };
                (Exit::Usage, place.to_owned())
            }
            _ => (Exit::NotSolvable, String::new()),
        };
        let (message, hint) = refusal(error);
        Failure::new(exit, &format!("{place}{message}"), hint)
    }

    /// Writes all tables and summary.json. With --save-state it also writes the state at the end.
    fn write_arm(&self, inputs: &ArmInputs, run: &PlayedRun<'_>) -> Result<Summary, Failure> {
        let playing = &inputs.playing;
        let files = SimulateFiles {
            input: &playing.file,
            target: playing.target_file.as_ref(),
            measured: None,
            reference: playing.reference_file.as_ref(),
            state: playing.state_file.as_ref(),
        };
        let record = RunInputs::of_simulate(&inputs.arm_file, &files, true, self.arguments());
        let summary = Summary::of_played_arm(record, run);
        let folder = self.sync.stage(Path::new(&self.output))?;
        let outputs = self.nodes.outputs(self.digits);
        let tables =
            RunTables::of_played_arm((run.arm, run.played), run.nodes_m, run.target, &outputs);
        outputs.write(folder, tables, (&summary, None), &Unwatched)?;
        if let Some(path) = &self.play.save_state {
            let state = state_json(&run.played.state());
            console::deliver(Some(path), state.as_bytes())?;
        }
        Ok(summary)
    }
}

/// Nodes of each link: distances in m from its joint.
pub fn nodes_m(of: &ArmSpecification) -> Result<Vec<Vec<f64>>, Failure> {
    let nodes =
        |(own, plan): (&ArmLink, &MeshPlan)| Ok(Mesh::new(&own.link, plan)?.nodes_m().to_vec());
    of.arm.links().iter().zip(&of.meshes).map(nodes).collect()
}

/// Why an arm is not simulated, and what to do about it.
pub fn refusal(error: &SimulationError) -> (String, Option<&'static str>) {
    let hint = match error {
        SimulationError::OtherTimes { .. } => {
            Some("take joint_angles.csv and torques.csv of one run of solve")
        }
        SimulationError::NoRest => {
            let message = "the arm finds no shape at rest where it starts, but must begin at rest";
            let hint = "a place within reach, stiffer links, or another pose: --at";
            return (message.to_owned(), Some(hint));
        }
        SimulationError::NotConverged { .. } => {
            let hint = "damping of the links by rayleigh, as beta = 1e-3; a shorter step of the torques, smaller ones, or \
                        smaller gains";
            Some(hint)
        }
        SimulationError::State { .. } => Some("--save-state of a run of the same arm writes it"),
        _ => error.hint(),
    };
    (error.to_string(), hint)
}

impl<'a> Played<'a> {
    fn run<'b>(&'b self, inputs: &'b ArmInputs) -> PlayedRun<'b>
    where
        'a: 'b,
    {
        PlayedRun {
            arm: &inputs.specification.arm,
            play: &self.play,
            played: &self.motion,
            metrics: &self.metrics,
            limits: &inputs.specification.limits,
            target: self.target.as_ref(),
            warnings: &self.warnings,
            nodes_m: &self.nodes_m,
        }
    }
}
