//! `simulate`: torques, or motions of joints, played on a link or an arm.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::csv::{Digits, InputFile};
use crate::elastica::SecondOrder;
use crate::link::Arm;
use crate::response::{CycleError, Play, SimulationError, simulate};
use crate::result::{Comparison, FollowedTarget, TargetError};
use crate::spec::Specification;
use crate::store::{PlayedRun, RunInputs, SimulateFiles, Simulated, Summary, state_json};
use crate::text::{plain, shown_path};

use crate::cli::options::common::{NodeArgs, SyncArgs, digits_arguments};
use crate::cli::options::inputs::LinkArgs;
use crate::cli::options::play::{DrivenFiles, PlayArgs, Playing};
use crate::cli::options::reading::ReadArgs;
use crate::cli::terminal::files::{keep, keep_inputs};
use crate::cli::terminal::text::simulate_text;
use crate::cli::terminal::{
    Exit, Failure, PrintArgs, StageBar, ThreadArgs, WarningArgs, console, memory,
};

const EXAMPLE: &str = "\
Example:
  flexlink simulate link.toml out/torque.csv \\
      --target out/tip.csv --set 'payload.mass=\"50 g\"'
  flexlink simulate link.toml out/rigid_torque.csv \\
      --column rigid_torque_n_m --until 10
  flexlink simulate link.toml out/torque.csv \\
      --feedback 20,2 --reference out/hub_angle.csv
  flexlink simulate link.toml lab.csv \\
      --columns time=1,torque=3 --unit 'N cm' --skip 5
  flexlink simulate link.toml encoder.csv \\
      --input hub-angle --measured camera.csv
  flexlink simulate link.toml first.csv \\
      --save-state state.json
  flexlink simulate link.toml second.csv \\
      --state state.json
  flexlink simulate geared.toml out/motor.csv \\
      --input voltage --target out/tip.csv
  flexlink simulate mast.toml out/force.csv \\
      --feedback 5e4,2e3 --reference out/carriage.csv
  flexlink simulate arm.toml out/torques.csv \\
      --feedback 50,1 --reference out/joint_angles.csv

One of the files may be `-`, standard input.";

/// Play a torque or a motion of the hub on a link, or torques on an arm.
///
/// Writes torque.csv (the motor's torque, feedback included), tip.csv, hub_angle.csv,
/// nodal_displacements.csv, nodes.csv and summary.json, and with --target tip_error.csv, into a folder, all
/// or none of them, and prints a short summary. The link is at rest before the first sample; after the last one
/// of a torque it is free.
/// Each mode is integrated exactly in time, so the answer does not depend on the Fourier transform of solve.
/// A hysteretic link has no equation in time: its ratio serves as the viscous ratio of every mode. The
/// torque acts at the hub, on the whole link: [drive] and analysis.modes are not used.
///
/// With --input voltage TORQUE has the motor's voltage, as motor.csv of solve. The motor of [drive], with torque_constant
/// and resistance, turns its rotor and the link against friction and losses of its gear. torque.csv is then the torque at the
/// hub, behind rotor and gear.
///
/// With gravity, or with analysis.second_order "first" or "full", the link is played with all terms of large
/// angles. With gravity it starts from its shape at rest in the direction start_angle, and the last torque
/// stays after its last sample.
///
/// An arm of several links is played with all terms: TORQUE has `torque1`, `torque2`, …, as torques.csv of
/// solve. It writes torques.csv, joint_angles.csv, chord_angles.csv, tip.csv, nodal_positions.csv, nodes.csv and
/// summary.json, with --target tip_error.csv, too. Under gravity most poses fall without --feedback.
///
/// A table of solve --write begins with the time when its motion begins. Its times are shifted to those of the motion's file,
/// which all other tables have.
///
/// On a carriage TORQUE is a force, as force.csv of solve, or with --input carriage the motion of the carriage.
/// Force and motion are in force.csv and carriage.csv. For an arm on a carriage they come beside those of its joints.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Simulate {
    #[command(flatten)]
    link: LinkArgs,

    #[command(flatten)]
    play: PlayArgs,

    /// Folder for the results.
    #[arg(short, long, value_name = "DIR", default_value = "simulated")]
    output: PathBuf,

    #[command(flatten)]
    nodes: NodeArgs,

    /// Digits: the last one is 10^-N of a column's peak, or `full` for the shortest text that
    /// reads back to the same number.
    #[arg(long, value_name = "N", default_value = "10")]
    digits: Digits,

    #[command(flatten)]
    warnings: WarningArgs,

    #[command(flatten)]
    sync: SyncArgs,

    #[command(flatten)]
    print: PrintArgs,

    #[command(flatten)]
    threads: ThreadArgs,

    #[command(flatten)]
    read: ReadArgs,
}

impl Simulate {
    /// The arguments that shape the results, for the record.
    fn arguments(&self) -> Vec<String> {
        let (nodes, digits) = (self.nodes.arguments(), digits_arguments(self.digits));
        let (changes, played) = (self.link.changes.arguments(), self.play.arguments());
        [changes, played, nodes, digits, self.read.arguments()].concat()
    }
}

/// The file's name, at the start of messages.
fn shown(file: &InputFile) -> String {
    format!("{}: ", file.shown)
}

/// The inputs, read.
struct Inputs {
    file: InputFile,
    specification: Specification,
    /// The link or the arm that moves: under voltages with the rotors of its motors.
    moved: Arm,
    playing: Playing,
}

impl Simulate {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        let inputs = self.load()?;
        let stages = self.print.stages();
        stages.at("playing");
        let play = inputs.playing.moves.play();
        let result = self.compute(&inputs, &play, &stages)?;
        let Specification { arm, limits, remarks, .. } = &inputs.specification;
        let run = PlayedRun { arm, play: &play, limits, result: &result };
        stages.at("writing");
        let summary = self.write(&inputs, &run)?;
        drop(stages);
        if arm.alone().is_none() {
            console::remarks(remarks);
        }
        self.tell(&summary, |written| {
            simulate_text(&run, written) + &self.nodes.text(&result.played.nodes_m())
        })
    }

    /// Reads all files; every error names its file.
    fn load(&self) -> Result<Inputs, Failure> {
        let files = [self.link.link.as_path()].into_iter().chain(self.play.files());
        let files: Vec<&Path> = files.collect();
        keep(&self.output, &files)?;
        if let Some(path) = &self.play.save_state {
            keep_inputs("--save-state", path, &files)?;
        }
        let (file, specification) = self.link.load()?;
        let specification = self.nodes.meshed(specification)?;
        let order = specification.analysis.second_order_of(specification.link());
        let is_large = order != SecondOrder::None;
        let arm = &specification.arm;
        let mut playing = self.play.load(arm, is_large, &self.read)?;
        let moved = match self.play.moving.under_voltages(&file, arm, &playing.moves.moving)? {
            Some((moved, moving)) => {
                playing.moves.moving = moving;
                moved
            }
            None => arm.clone(),
        };
        Ok(Inputs { file, specification, moved, playing })
    }

    /// Plays the input until the time of the command line, or else to the later end of input and target. Computes the
    /// errors of the tip and of the simulation itself, and the difference from a recording.
    fn compute(
        &self,
        inputs: &Inputs,
        play: &Play<'_>,
        stages: &StageBar,
    ) -> Result<Simulated, Failure> {
        let Inputs { specification: Specification { meshes, .. }, moved: arm, playing, .. } =
            inputs;
        let refused = |error| self.refused(&error, inputs);
        let played = simulate(arm, meshes, play, &|progress| stages.played(progress));
        let played = played.map_err(refused)?;
        self.nodes.check(&played.nodes_m())?;
        let target = playing.moves.target.as_ref().map(|target| {
            let followed = FollowedTarget::of(&played, target);
            followed.map_err(|error| self.target_refused(error, inputs.target_shown()))
        });
        let target = target.transpose()?;
        let compared = playing.measured.as_ref().map(|(file, measured)| {
            Comparison::of(&played, measured).map_err(|error| {
                let message = format!("{}{error}", shown(file));
                Failure::new(Exit::InputRefused, &message, Some(error.hint()))
            })
        });
        let comparison = compared.transpose()?;
        let bytes = self.nodes.outputs(self.digits).simulation_bytes(&played);
        memory::check_nodes(bytes, play.memory_bytes)?;
        let result = Simulated::of(played, arm, play, target).map_err(refused)?;
        Ok(Simulated { comparison, ..result })
    }

    /// The failure of a simulation, with the file or option that causes it.
    fn refused(&self, error: &SimulationError, inputs: &Inputs) -> Failure {
        let Playing { files: DrivenFiles { input: file, reference, .. }, state_file, .. } =
            &inputs.playing;
        let (exit, place) = match error {
            SimulationError::NoTorque
            | SimulationError::NoTurn
            | SimulationError::Cycle(CycleError::Mean { .. } | CycleError::Repeats) => {
                (Exit::InputRefused, shown(file))
            }
            SimulationError::OtherTimes { .. }
            | SimulationError::Cycle(CycleError::Reference { .. }) => {
                (Exit::InputRefused, shown(reference.as_ref().unwrap_or(file)))
            }
            // The target is longer than the input.
            SimulationError::TooLong { until_s, samples, limit } if self.play.until.is_none() => {
                let place = inputs.target_shown();
                let steps =
                    format!("the end = {} s, {samples:.3e} steps of the input", plain(*until_s));
                let message = format!("{place}{steps}, but must be at most {limit} steps");
                return Failure::new(Exit::InputRefused, &message, error.hint());
            }
            SimulationError::NoStartAngle => (Exit::InputRefused, String::new()),
            SimulationError::State { .. } => {
                (Exit::InputRefused, state_file.as_ref().map(shown).unwrap_or_default())
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
        let (message, hint) = refusal(error, &inputs.specification.arm);
        Failure::new(exit, &format!("{place}{message}"), hint.as_deref())
    }

    /// The failure of a target in this file that does not suit the simulation.
    fn target_refused(&self, error: TargetError, shown: String) -> Failure {
        let (exit, place) = match (error, self.play.until) {
            (TargetError::EndsLate { .. }, Some(until)) => {
                (Exit::Usage, format!("--until {}: ", plain(until)))
            }
            _ => (Exit::InputRefused, shown),
        };
        Failure::new(exit, &format!("{place}{error}"), error.hint())
    }

    /// Writes all tables and summary.json. With --save-state it also writes the state at the end.
    fn write(&self, inputs: &Inputs, run: &PlayedRun<'_>) -> Result<Summary, Failure> {
        let Playing { files, target_file, measured, state_file, .. } = &inputs.playing;
        let files = SimulateFiles {
            target: target_file.as_ref(),
            measured: measured.as_ref().map(|(file, _)| file),
            state: state_file.as_ref(),
            ..files.recorded()
        };
        let kind = (run.play.input.is_torque(), run.arm.joint().slides());
        let record = RunInputs::of_simulate(&inputs.file, &files, kind, self.arguments());
        let outputs = self.nodes.outputs(self.digits);
        let summary = run.write(record, &outputs, || self.sync.stage(&self.output))?;
        if let Some(path) = &self.play.save_state {
            console::deliver(Some(path), state_json(&run.result.played.state()).as_bytes())?;
        }
        Ok(summary)
    }

    /// Prints warnings and the summary, whose text names the `written` files.
    fn tell(&self, summary: &Summary, text: impl FnOnce(String) -> String) -> Result<(), Failure> {
        let warnings = summary.warnings();
        console::warnings(warnings.iter().cloned());
        let written = || format!("{} files in {}", summary.file_count(), shown_path(&self.output));
        self.print.print(|| summary.to_json(), || text(written()))?;
        self.warnings.refuse(warnings.len())
    }
}

impl Inputs {
    /// The name of the target's file, at the start of messages.
    fn target_shown(&self) -> String {
        self.playing.target_file.as_ref().map(shown).unwrap_or_default()
    }
}

/// Reason of a failed simulation, and the remedy, which names the files of an arm or of a link on a carriage.
pub fn refusal(error: &SimulationError, arm: &Arm) -> (String, Option<String>) {
    let hint = match error {
        _ if arm.alone().is_some() => error.hint(),
        SimulationError::OtherTimes { .. } => {
            Some("take joint_angles.csv and torques.csv of one run of solve")
        }
        SimulationError::NoRest => {
            let message = "the arm has no shape at rest where it starts";
            let hint = "use a place within reach, stiffer links, or another pose: --at";
            return (message.to_owned(), Some(hint.to_owned()));
        }
        SimulationError::NotConverged { .. } => Some(
            "use rayleigh damping of the links, such as beta = 1e-3, torques that are smaller or have a shorter \
             step, or smaller gains",
        ),
        SimulationError::State { .. } => Some("use a state that --save-state of this arm wrote"),
        _ => error.hint(),
    };
    (arm.worded(&error.to_string()), hint.map(|hint| arm.worded(hint)))
}
