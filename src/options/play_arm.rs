//! What `simulate` plays on an arm, and what it compares the result with.

use flexlink::csv::{InputFile, read_joint_references, read_joint_torques, read_tip_places};
use flexlink::link::Arm;
use flexlink::response::{ArmPlay, ArmStart, ArmState, Feedback, Interpolation, Torque};
use flexlink::result::TipPlaces;
use flexlink::store::read_state;

use super::common::directions;
use super::inputs::{ReadArgs, tell};
use super::play::PlayArgs;
use crate::terminal::{Exit, Failure, memory};

/// The files of an arm's simulation beside that of the arm, read.
pub(crate) struct ArmPlaying {
    pub(crate) file: InputFile,
    pub(crate) target: Option<(InputFile, TipPlaces)>,
    pub(crate) reference_file: Option<InputFile>,
    pub(crate) state_file: Option<InputFile>,
    torques: Vec<Torque>,
    feedback: Vec<Feedback>,
    interpolation: Interpolation,
    start: Start,
}

/// Where the arm starts at rest.
enum Start {
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
        let target = target.transpose()?;
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
        let first = references.iter().map(|own| own.angle_rad()[0]).collect::<Vec<f64>>();
        let gains = self.gains_of(links)?;
        let feedback = gains.into_iter().zip(references);
        let feedback = feedback.map(|((kp, kd), reference)| Feedback::new(kp, kd, reference));
        let feedback =
            feedback.collect::<Result<_, _>>().map_err(|error| Self::gains_refused(&error))?;
        let start = match (state, &self.at, &target) {
            (Some(state), _, _) => Start::State(state),
            (None, Some(at), _) => Start::Chords(directions(Some(at), links)?),
            (None, None, _) if !first.is_empty() => Start::Joints(first),
            (None, None, Some((_, target))) if links == 2 && arm.elbow().is_some() => {
                Start::Tip([0, 1].map(|axis: usize| target.at_m[axis][0]))
            }
            _ => {
                let message = "--at = nothing, but must say where the arm starts";
                let hint = "--at '30 deg,75 deg', the directions of its chords, as the first row of chord_angles.csv has them; or --feedback with --reference";
                return Err(Failure::new(Exit::Usage, &message, Some(hint)));
            }
        };
        let interpolation = self.hold.interpolation();
        Ok(ArmPlaying {
            file,
            target,
            reference_file,
            state_file,
            torques,
            feedback,
            interpolation,
            start,
        })
    }

    /// The gains of each joint: one pair for all of them, or one each; none without feedback.
    fn gains_of(&self, links: usize) -> Result<Vec<(f64, f64)>, Failure> {
        match self.feedback.as_deref() {
            None => Ok(Vec::new()),
            Some([one]) => Ok(vec![*one; links]),
            Some(each) if each.len() == links => Ok(each.to_vec()),
            Some(others) => {
                let found = others.len();
                let message = format!(
                    "--feedback = {found} pairs, but must be one for all joints, or one for each of {links}"
                );
                Err(Failure::new(
                    Exit::Usage,
                    &message,
                    Some("KP1,KD1,KP2,KD2, from the inner joint on"),
                ))
            }
        }
    }
}

impl ArmPlaying {
    /// What to play until a time, or else as long as input and target last.
    pub(crate) fn play(&self, until_s: Option<f64>, tolerance: f64) -> ArmPlay<'_> {
        let end_s = self.torques[0].grid().end_s();
        let both_s = self.target.as_ref().map(|(_, target)| target.grid.end_s().max(end_s));
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
