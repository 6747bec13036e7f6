//! Inputs of `simulate` for an arm, and targets for comparison.

use crate::csv::{InputFile, read_joint_references, read_joint_torques, read_tip_places};
use crate::link::Arm;
use crate::response::{ArmPlay, ArmStart, ArmState, Feedback, HubReference, Interpolation, Torque};
use crate::result::TipPlaces;
use crate::store::read_state;

use super::common::directions;
use super::play::PlayArgs;
use super::reading::{ReadArgs, tell};
use crate::cli::terminal::{Exit, Failure, memory};

/// Files of an arm's simulation besides the arm's, as read.
pub(crate) struct ArmPlaying {
    pub(crate) file: InputFile,
    pub(crate) target_file: Option<InputFile>,
    pub(crate) reference_file: Option<InputFile>,
    pub(crate) state_file: Option<InputFile>,
    pub(crate) played: ArmTorques,
}

/// Torques of an arm, further influences, and the target of the tip.
pub struct ArmTorques {
    pub torques: Vec<Torque>,
    pub feedback: Vec<Feedback>,
    pub interpolation: Interpolation,
    pub start: Start,
    pub target: Option<TipPlaces>,
}

/// Rest position of the arm at the start.
pub enum Start {
    Joints(Vec<f64>),
    Chords(Vec<f64>),
    Tip([f64; 2]),
    State(ArmState),
}

impl PlayArgs {
    /// Reads all files for an arm; every error names its file.
    pub(crate) fn load_arm(&self, arm: &Arm, read: &ReadArgs) -> Result<ArmPlaying, Failure> {
        self.refuse_for_arms()?;
        let links = arm.links().len();
        let file = InputFile::read(&self.file)?;
        let (torques, reading) =
            read_joint_torques(&file.shown, &file.bytes, links, &read.format())?;
        self.hold.refuse_jitter(&file, &reading)?;
        tell(&file.shown, &reading);
        let target = self.target.as_deref().map(|path| -> Result<_, Failure> {
            let file = InputFile::read(path)?;
            let (target, reading) = read_tip_places(&file.shown, &file.bytes)?;
            tell(&file.shown, &reading);
            Ok((file, target))
        });
        let (target_file, target) = target.transpose()?.unzip();
        let reference = self.reference.as_deref().map(|path| -> Result<_, Failure> {
            let file = InputFile::read(path)?;
            let (motion, reading) = read_joint_references(&file.shown, &file.bytes, links)?;
            tell(&file.shown, &reading);
            Ok((file, motion))
        });
        let (reference_file, references) = reference.transpose()?.unzip();
        let state = self.state.as_deref().map(|path| -> Result<_, Failure> {
            let file = InputFile::read(path)?;
            let state = read_state(&file.shown, &file.bytes)?;
            Ok((file, state))
        });
        let (state_file, state) = state.transpose()?.unzip();
        let references = references.unwrap_or_default();
        let feedback = feedback(self.feedback.as_deref(), references, links)?;
        let start = Start::of(arm, state, self.at.as_deref(), (&feedback, target.as_ref()))?;
        let interpolation = self.hold.interpolation();
        let played = ArmTorques { torques, feedback, interpolation, start, target };
        Ok(ArmPlaying { file, target_file, reference_file, state_file, played })
    }
}

/// Feedback of each joint around its reference, with one pair of gains for all joints, or one for each; empty without
/// gains.
pub fn feedback(
    gains: Option<&[(f64, f64)]>,
    references: Vec<HubReference>,
    links: usize,
) -> Result<Vec<Feedback>, Failure> {
    let gains = match gains {
        None => Vec::new(),
        Some([one]) => vec![*one; links],
        Some(each) if each.len() == links => each.to_vec(),
        Some(others) => {
            let found = others.len();
            let message = format!(
                "--feedback = {found} pairs, but must be one for all joints, or one for each of {links}"
            );
            let hint = "KP1,KD1,KP2,KD2, from the inner joint on";
            return Err(Failure::new(Exit::Usage, &message, Some(hint)));
        }
    };
    let of_joints = gains.into_iter().zip(references);
    let of_joints = of_joints.map(|((kp, kd), reference)| Feedback::new(kp, kd, reference));
    of_joints.collect::<Result<_, _>>().map_err(|error| PlayArgs::gains_refused(&error))
}

impl Start {
    /// Start at a state, else at these directions of the chords, else at the beginning of feedback or target.
    pub fn of(
        arm: &Arm,
        state: Option<ArmState>,
        at: Option<&[f64]>,
        (feedback, target): (&[Feedback], Option<&TipPlaces>),
    ) -> Result<Self, Failure> {
        let links = arm.links().len();
        match (state, at, target) {
            (Some(state), _, _) => Ok(Self::State(state)),
            (None, Some(at), _) => Ok(Self::Chords(directions(Some(at), links)?)),
            (None, None, _) if !feedback.is_empty() => {
                let first = feedback.iter().map(|own| own.reference().angle_rad()[0]);
                Ok(Self::Joints(first.collect()))
            }
            (None, None, Some(target)) if links == 2 && arm.elbow().is_some() => {
                Ok(Self::Tip([0, 1].map(|axis: usize| target.at_m[axis][0])))
            }
            _ => {
                let message = "--at = nothing, but must say where the arm starts";
                let hint = "--at '30 deg,75 deg', the directions of its chords, as the first row of chord_angles.csv has them; or --feedback with --reference";
                Err(Failure::new(Exit::Usage, &message, Some(hint)))
            }
        }
    }
}

impl ArmTorques {
    /// The simulation up to a time, or else until input and target end.
    pub fn play(&self, until_s: Option<f64>, tolerance: f64) -> ArmPlay<'_> {
        let end_s = self.torques[0].grid().end_s();
        let both_s = self.target.as_ref().map(|target| target.grid.end_s().max(end_s));
        let start = match &self.start {
            Start::State(state) => ArmStart::State(state),
            Start::Chords(chords) => ArmStart::Chords(chords),
            Start::Tip(at_m) => ArmStart::Tip(*at_m),
            Start::Joints(joints) => ArmStart::Joints(joints),
        };
        ArmPlay {
            torques: &self.torques,
            interpolation: self.interpolation,
            until_s: until_s.or(both_s),
            feedback: &self.feedback,
            start,
            tolerance,
            memory_bytes: memory::available(),
        }
    }
}
