//! The options of `simulate`.

use std::path::PathBuf;

use clap::Args;

use crate::csv::{Digits, InputFile};

use crate::cli::options::common::{NodeArgs, SyncArgs, digits_arguments};
use crate::cli::options::inputs::LinkArgs;
use crate::cli::options::inputs::ReadArgs;
use crate::cli::options::play::PlayArgs;
use crate::cli::terminal::{PrintArgs, ThreadArgs, WarningArgs};

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
/// With gravity, or with analysis.second_order "first" or "full", the link is played with all terms of large
/// angles. With gravity it starts from its shape at rest in the direction start_angle, and the last torque
/// stays after its last sample.
///
/// An arm of several links is played with all terms: TORQUE has `torque1`, `torque2`, …, as torques.csv of
/// solve. It writes torques.csv, joint_angles.csv, chord_angles.csv, tip.csv, nodal_positions.csv, nodes.csv and
/// summary.json, with --target tip_error.csv, too. Under gravity most poses fall without --feedback.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Simulate {
    #[command(flatten)]
    pub(super) link: LinkArgs,

    #[command(flatten)]
    pub(super) play: PlayArgs,

    /// Folder for the results.
    #[arg(short, long, value_name = "DIR", default_value = "simulated")]
    pub(super) output: PathBuf,

    #[command(flatten)]
    pub(super) nodes: NodeArgs,

    /// Digits: the last one is 10^-N of a column's peak, or `full` for the shortest text that
    /// reads back to the same number.
    #[arg(long, value_name = "N", default_value = "10")]
    pub(super) digits: Digits,

    #[command(flatten)]
    pub(super) warnings: WarningArgs,

    #[command(flatten)]
    pub(super) sync: SyncArgs,

    #[command(flatten)]
    pub(super) print: PrintArgs,

    #[command(flatten)]
    pub(super) threads: ThreadArgs,

    #[command(flatten)]
    pub(super) read: ReadArgs,
}

impl Simulate {
    /// The arguments that shape the results, for the record.
    pub(super) fn arguments(&self) -> Vec<String> {
        let (nodes, digits) = (self.nodes.arguments(), digits_arguments(self.digits));
        let (changes, played) = (self.link.changes.arguments(), self.play.arguments());
        [changes, played, nodes, digits, self.read.arguments()].concat()
    }
}

/// The file's name, at the start of messages.
pub(super) fn shown(file: &InputFile) -> String {
    format!("{}: ", file.shown)
}
