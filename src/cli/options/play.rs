//! Inputs of `simulate` and of the plays of `sweep`, and targets for comparison.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::csv::{
    ClockTime, InputFile, Joints, Reading, TableError, TableFormat, read_joint_references,
    read_joint_torques, read_record, read_recording_as, read_target, read_tip_places,
    read_torque_table_as,
};
use crate::fit::RecordedInput;
use crate::link::{Arm, ParameterError};
use crate::numeric::TimeGrid;
use crate::response::{Feedback, HubReference, Interpolation, Torque};
use crate::result::{ChannelRecording, TipPlaces};
use crate::store::{SimulateFiles, read_state};
use crate::text::given;

use super::common::{angle_rad, metres, option, seconds};
use super::inputs::worded;
use super::moves::{AtRest, Begins, Moves, Moving, of_motor, under_voltages, voltage};
use super::reading::{ReadArgs, TableName, tell};
use crate::cli::terminal::{Exit, Failure, console};

/// Quantity that moves the link: of a hub, or of a carriage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum InputKind {
    Torque,
    HubAngle,
    Force,
    Carriage,
    Voltage,
}

impl InputKind {
    /// True for the motion of the joint, false for the effort that drives it.
    fn is_motion(self) -> bool {
        matches!(self, Self::HubAngle | Self::Carriage)
    }

    /// Its name as an option's value.
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |own| own.get_name().to_owned())
    }
}

/// The torque between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Hold {
    /// Each sample until the next one, as a converter plays a table.
    Zero,
    /// Straight lines.
    Linear,
    /// A cubic spline.
    Cubic,
}

/// Tables of a simulation. The first takes the options of reading without a name.
const TABLES: [TableName; 4] =
    [TableName::Torque, TableName::Target, TableName::Reference, TableName::Measured];

/// Course of a torque between its samples.
#[derive(Debug, Args)]
pub(crate) struct HoldArgs {
    /// Course of the torque between the samples of TORQUE.
    #[arg(long, value_name = "KIND", value_enum, default_value_t = Hold::Cubic)]
    hold: Hold,

    /// Short for --hold linear.
    #[arg(long, conflicts_with = "hold")]
    linear: bool,
}

impl HoldArgs {
    /// Interpolation of the torque between its samples.
    pub(crate) fn interpolation(&self) -> Interpolation {
        match self.hold {
            Hold::Cubic if self.linear => Interpolation::Linear,
            Hold::Cubic => Interpolation::Cubic,
            Hold::Linear => Interpolation::Linear,
            Hold::Zero => Interpolation::Zero,
        }
    }

    /// Refuses rows that are for a drive that holds each to the next one, without --hold zero: they lead the curve by half a
    /// step.
    fn refuse_held(&self, shown: &str, reading: &Reading, hint: &str) -> Result<(), Failure> {
        if !reading.is_held() || self.interpolation() == Interpolation::Zero {
            return Ok(());
        }
        let must = "but must be samples of a smooth curve without --hold zero";
        let message = format!("{shown}: each row is held to the next, as its comment says, {must}");
        Err(Failure::new(Exit::InputRefused, &message, Some(hint)))
    }

    /// Refuses torques that the table does not have in this course. A spline that makes times uniform rings at the steps of held
    /// torques.
    pub(crate) fn refuse(&self, file: &InputFile, reading: &Reading) -> Result<(), Failure> {
        self.refuse_held(&file.shown, reading, "use --hold zero")?;
        if !reading.is_interpolated() || self.interpolation() == Interpolation::Cubic {
            return Ok(());
        }
        let must = "must be for --hold zero or linear";
        let message = format!("{}: the times are not uniform, but {must}", file.shown);
        let hint = "write times with more decimals, or use --hold cubic";
        Err(Failure::new(Exit::InputRefused, &message, Some(hint)))
    }

    /// Arguments for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        let linear = self.linear.then(|| vec!["--linear".to_owned()]);
        let hold = self.hold.to_possible_value().filter(|_| self.hold != Hold::Cubic);
        let hold = hold.map(|hold| option("--hold", hold.get_name()));
        hold.into_iter().chain(linear).flatten().collect()
    }
}

/// The input that moves the joints, and the feedback around their motion: options of `simulate` and of `sweep`.
#[derive(Debug, Args)]
pub(crate) struct MovingArgs {
    /// Quantity in TORQUE: the torque, or the hub angle (for an arm the angles of its joints), which the hub follows
    /// exactly while the torque is computed. The hub rests before the first sample and after the last. On a
    /// carriage the force, or the position of the carriage. `voltage` is that of the motor of [drive], of an arm `voltage1`,
    /// `voltage2`, …, as in motor.csv; the motor is shorted after the last sample [default: torque or force].
    #[arg(long, value_name = "KIND", value_enum)]
    input: Option<InputKind>,

    /// Column of TORQUE to play [default: `torque` or `force`].
    #[arg(long, value_name = "NAME")]
    column: Option<String>,

    #[command(flatten)]
    hold: HoldArgs,

    /// Feedback at the hub around the reference: gains in N m/rad and N m s/rad, at a carriage in N/m and N s/m; for an arm
    /// one pair for all joints, or a pair for each, its carriage last.
    #[arg(long, value_name = "KP,KD", requires = "reference")]
    #[arg(value_parser = gains, allow_hyphen_values = true)]
    feedback: Option<Gains>,

    /// Motion that the feedback follows (CSV), at the times of TORQUE: `hub_angle.csv` of solve, `joint_angles.csv` for
    /// an arm, `carriage.csv` for a carriage; for an arm on a carriage both in one table, or carriage.csv beside the file.
    /// The simulation starts at its first row.
    #[arg(long, value_name = "FILE", requires = "feedback")]
    pub(crate) reference: Option<PathBuf>,
}

/// Input, references and options of `simulate`.
#[derive(Debug, Args)]
pub(crate) struct PlayArgs {
    /// Torque at the hub (CSV): `time` and `torque`; with --input hub-angle `time` and `hub_angle`. Of an arm `time` and
    /// `torque1`, `torque2`, …; with --input hub-angle `time` and `joint1`, `joint2`, … On a carriage `time` and
    /// `force`; with --input carriage `time` and `carriage`. Of an arm on a carriage all of these, or those of the joints with
    /// force.csv or carriage.csv beside the file.
    #[arg(value_name = "TORQUE")]
    pub(crate) file: PathBuf,

    #[command(flatten)]
    pub(crate) moving: MovingArgs,

    /// End of the simulation, in s or with its unit. After the last sample of TORQUE the torque is zero; with gravity the last
    /// torque stays [default: the end of TORQUE, or of the target if that is later].
    #[arg(long, value_name = "T", value_parser = seconds, allow_hyphen_values = true)]
    pub(crate) until: Option<f64>,

    /// Tip motion to compare with (CSV): `time` and `displacement`, as `tip.csv` of solve. The
    /// link starts at its first displacement, but with --input hub-angle where its hub points, and with --input carriage
    /// where the carriage stands.
    #[arg(long, value_name = "FILE")]
    target: Option<PathBuf>,

    /// Recording to compare with, channel by channel (CSV): `time` and any of `hub_angle`, `hub_rate`, `tip`,
    /// `velocity`, `acceleration`, `tip_deflection` and `torque`; on a carriage `carriage`, `carriage_velocity` and `force`
    /// in place of those of the hub; of an arm any of `x`, `y`, `joint1`, `joint1_rate`, `torque1`, `joint2`, …; at any
    /// times.
    #[arg(long, value_name = "FILE")]
    measured: Option<PathBuf>,

    /// Start from the state that --save-state of an earlier run wrote, not at rest.
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,

    /// Play the repeating motion to which the link or the arm settles. TORQUE is one cycle of torques, or of the angles of hub or
    /// joints; its first row follows the last one, a step later.
    #[arg(long, conflicts_with = "state")]
    periodic: bool,

    /// Write the state at the end of the simulation (JSON), from which another one goes on: angles along the
    /// link, deflections and their rates.
    #[arg(long, value_name = "FILE")]
    pub(crate) save_state: Option<PathBuf>,

    /// Directions of an arm's links, each from its joint to the next one, in rad or with units: '30 deg,75 deg'. The arm
    /// starts at rest there [default: the first row of the reference; for two links also of the target].
    #[arg(long, value_name = "ANGLES", value_parser = angle_rad, allow_hyphen_values = true)]
    #[arg(value_delimiter = ',', conflicts_with = "state")]
    at: Option<Vec<f64>>,

    /// Place of an arm's carriage where it starts with --at or at the target, in m or with its unit [default: 0].
    #[arg(long, value_name = "PLACE", value_parser = metres, allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["state", "reference"])]
    carriage_at: Option<f64>,
}

/// Pairs of gains.
pub(crate) type Gains = Vec<(f64, f64)>;

/// Histories that move the joints, their feedback, and their files.
pub struct Driven {
    pub(crate) files: DrivenFiles,
    /// Under voltages these, as torques.
    pub(crate) moving: Moving,
    /// The feedback of each joint; empty without.
    pub(crate) feedback: Vec<Feedback>,
    /// Instant of the time 0, of a table of dates or times of day.
    pub(crate) since: Option<ClockTime>,
}

/// The files of what moves the joints.
pub(crate) struct DrivenFiles {
    pub(crate) input: InputFile,
    /// Files of an arm's carriage beside that of its joints and beside their reference.
    pub(crate) of_carriage: [Option<InputFile>; 2],
    pub(crate) reference: Option<InputFile>,
}

impl DrivenFiles {
    /// The files for the record of a run without target, recording and state.
    pub(crate) fn recorded(&self) -> SimulateFiles<'_> {
        SimulateFiles {
            input: &self.input,
            carriage: self.of_carriage[0].as_ref(),
            target: None,
            measured: None,
            reference: self.reference.as_ref(),
            carriage_reference: self.of_carriage[1].as_ref(),
            state: None,
        }
    }
}

/// The failure of a reference that does not last as long as the torque, after both were shifted.
fn uncovered(file: &InputFile, reference: &TimeGrid, torque: &TimeGrid) -> Failure {
    let [found, must] = [reference, torque]
        .map(|own| format!("{} … {} s", given(own.time_s(0)), given(own.end_s())));
    let message = format!("{}: times = {found}, but must cover {must} of TORQUE", file.shown);
    let hint =
        "a comment `motion begins at` shifted the times of a table to those of the motion's file";
    Failure::new(Exit::InputRefused, &message, Some(hint))
}

/// The files of a simulation beside that of link or arm, read.
pub(crate) struct Playing {
    pub(crate) files: DrivenFiles,
    pub(crate) target_file: Option<InputFile>,
    pub(crate) measured: Option<(InputFile, ChannelRecording)>,
    pub(crate) state_file: Option<InputFile>,
    pub(crate) moves: Moves,
}

impl MovingArgs {
    /// Reads the histories of the joints from a file whose table has this form, and the references. Every error names its
    /// file.
    pub(crate) fn load(
        &self,
        path: &Path,
        arm: &Arm,
        format_of: &dyn Fn(TableName) -> TableFormat,
    ) -> Result<Driven, Failure> {
        let joints = Joints::from(arm);
        let format = &format_of(TableName::Torque);
        let input = InputFile::read(path)?;
        let reference = self.reference.as_deref().map(InputFile::read).transpose()?;
        let InputFile { shown, bytes, .. } = &input;
        let (moving, of_carriage, reading) = if self.is_moved() {
            let (mut hubs, reading) = read_joint_references(shown, bytes, joints, format)?;
            let hint = "write the table without --hold zero; with it, `solve` plays it and prints the error of the tip";
            self.hold.refuse_held(shown, &reading, hint)?;
            let own = with_carriage_moved(&mut hubs, (arm, path), format)?;
            (Moving::Angles(hubs), own, reading)
        } else if self.is_under_voltage() {
            let (volts, reading) = self.read_voltages(&input, arm, format)?;
            (Moving::Torques(volts), None, reading)
        } else {
            let (mut torques, reading) =
                read_torques(&input, joints, (self.column.as_deref(), format))?;
            let own = with_force(&mut torques, (arm, path), (&self.hold, format))?;
            (Moving::Torques(torques), own, reading)
        };
        if !self.is_moved() {
            self.hold.refuse(&input, &reading)?;
        }
        tell(shown, &reading);
        let (since, has_beginning) = (reading.since().cloned(), reading.has_beginning());
        let (mut references, mut of_reference) = (Vec::new(), None);
        if let Some((path, file)) = self.reference.as_deref().zip(reference.as_ref()) {
            let name = TableName::Reference;
            let form = TableFormat { since: since.clone(), ..format_of(name) };
            let read = read_joint_references(&file.shown, &file.bytes, joints, &form);
            let (own, reading) = read.map_err(|error| name.refused(error.into()))?;
            name.tell(&file.shown, &reading);
            let hint = "use --hold zero, which holds TORQUE, too, or write the table without it";
            self.hold.refuse_held(&file.shown, &reading, hint)?;
            references = own;
            of_reference = with_carriage_moved(&mut references, (arm, path), &form)?;
            if has_beginning || reading.has_beginning() {
                let grid = moving.input().grid();
                let own = references.iter().map(|own| own.on_times(&grid));
                let own = own.collect::<Option<_>>();
                references = own.ok_or_else(|| uncovered(file, &references[0].grid(), &grid))?;
            }
        }
        let feedback = feedback(self.feedback.as_deref(), references, arm)?;
        let files = DrivenFiles { input, of_carriage: [of_carriage, of_reference], reference };
        Ok(Driven { files, moving, feedback, since })
    }

    /// Course of a torque between its samples.
    pub(crate) fn interpolation(&self) -> Interpolation {
        self.hold.interpolation()
    }

    /// True where the motion of the joints is the input.
    pub(crate) fn is_moved(&self) -> bool {
        self.input.is_some_and(InputKind::is_motion)
    }

    /// True where the voltages of motors are the input.
    pub(crate) fn is_under_voltage(&self) -> bool {
        self.input == Some(InputKind::Voltage)
    }

    /// True for torques and forces alone, the same on every link that they move.
    pub(crate) fn is_open(&self) -> bool {
        !self.is_moved() && !self.is_under_voltage() && self.feedback.is_none()
    }

    /// The arm of this file with the rotors of its motors, and the torques of their voltages at its held joints. `None`
    /// without voltages.
    pub(crate) fn under_voltages(
        &self,
        file: &InputFile,
        arm: &Arm,
        moving: &Moving,
    ) -> Result<Option<(Arm, Moving)>, Failure> {
        let Moving::Torques(volts) = moving else { return Ok(None) };
        if !self.is_under_voltage() {
            return Ok(None);
        }
        let moved = under_voltages(arm).map_err(|failure| failure.placed(&file.shown))?;
        let torques = arm.links().iter().zip(volts).map(|(own, volts)| of_motor(&own.link, volts));
        Ok(Some((moved, Moving::Torques(torques.collect()))))
    }

    /// The failure of gains outside the range of a feedback.
    fn gains_refused(error: &ParameterError, arm: &Arm) -> Failure {
        let message = arm.joint().worded(&format!("--feedback: {error}"));
        Failure::new(Exit::Usage, &message, None)
    }

    /// Reads the voltage of each motor, as torques.
    fn read_voltages(
        &self,
        file: &InputFile,
        arm: &Arm,
        format: &TableFormat,
    ) -> Result<(Vec<Torque>, Reading), Failure> {
        let InputFile { shown, bytes, .. } = file;
        let text = String::from_utf8_lossy(bytes);
        let is_chosen = format.columns.iter().any(|own| own.is_of("voltage"));
        if (self.column.is_some() || is_chosen) && arm.alone().is_none() {
            let option = if is_chosen { "--columns voltage" } else { "--column" };
            let message = format!(
                "{option} names one column, but the voltages of an arm are voltage1, voltage2, …"
            );
            return Err(Failure::new(
                Exit::Usage,
                &message,
                Some("rename the columns in the file"),
            ));
        }
        let mut all = Vec::new();
        for number in 1..=arm.links().len() {
            let number = arm.pick(String::new(), number.to_string());
            let of_motor = format!("motor{number}_voltage_v");
            let of_motor = Some(of_motor).filter(|name| text.contains(name.as_str()));
            let of_joint = arm.pick(None, Some(format!("voltage{number}")));
            let mut format = format.clone();
            let name = self.column.clone().or(of_motor.or(of_joint).filter(|_| !is_chosen));
            if let Some(name) = name {
                let choice = format!("voltage={name}").parse();
                format.columns.push(choice.map_err(|error: String| {
                    Failure::new(Exit::Usage, &format!("--column: {error}"), None)
                })?);
            }
            let input = RecordedInput::Voltage;
            let table = read_record(shown, bytes, input, &[], &format).map_err(|error| {
                let hint = "the columns are voltage, of an arm voltage1, voltage2, …, or those of motor.csv; --column \
                            names another one";
                Failure { hint: Some(hint.to_owned()), ..Failure::from(error) }
            })?;
            let times_s: Vec<f64> = (0..table.grid.len).map(|k| table.grid.time_s(k)).collect();
            let volts = voltage(&times_s, table.input).map_err(|failure| failure.placed(shown))?;
            all.push((volts, table.reading));
        }
        let (volts, mut readings): (Vec<_>, Vec<_>) = all.into_iter().unzip();
        Ok((volts, readings.swap_remove(0)))
    }

    /// Refuses an input of the other kind of joint, and options of a torque, these and `others`, beside a hub angle.
    pub(crate) fn check(&self, arm: &Arm, others: &[(&'static str, bool)]) -> Result<(), Failure> {
        let slides = arm.joint().slides();
        if let Some(input) = self.input {
            let of_carriage = [InputKind::Force, InputKind::Carriage];
            if input != InputKind::Voltage && of_carriage.contains(&input) != slides {
                let (kinds, of) = if slides {
                    ("force or carriage", "a link on a carriage")
                } else {
                    ("torque or hub-angle", arm.pick("a hub", "an arm"))
                };
                let message = format!("--input = {}, but must be {kinds} for {of}", input.name());
                let hint = "the carriage moves by the column of the same table, or by force.csv or carriage.csv beside it";
                let hint = arm.carriage().map(|_| hint);
                return Err(Failure::new(Exit::Usage, &message, hint));
            }
        }
        self.check_input(arm, others)?;
        if self.is_under_voltage() && self.feedback.is_some() {
            let message = "--input = voltage, but must be torque or force with --feedback";
            let hint = "the feedback is a torque, which the voltage does not contain";
            return Err(Failure::new(Exit::Usage, &message, Some(hint)));
        }
        Ok(())
    }

    /// Refuses options of a torque beside a hub angle.
    fn check_input(&self, arm: &Arm, others: &[(&'static str, bool)]) -> Result<(), Failure> {
        let Some(input) = self.input.filter(|own| own.is_motion()) else { return Ok(()) };
        let given = [
            ("--column", self.column.is_some()),
            ("--hold", self.hold.hold != Hold::Cubic),
            ("--linear", self.hold.linear),
            ("--feedback", self.feedback.is_some()),
        ];
        let mut given = given.iter().chain(others);
        let Some((name, _)) = given.find(|(_, is_given)| *is_given) else { return Ok(()) };
        let joint = arm.joint();
        let must = joint.worded(&format!("must be torque with {name}"));
        let message = format!("--input = {}, but {must}", input.name());
        let hint = match *name {
            "--column" if joint.slides() => {
                "the column is carriage; simulate chooses another one by --columns carriage=COLUMN"
            }
            "--column" => {
                "the column is hub_angle; simulate chooses another one by --columns hub_angle=COLUMN"
            }
            "--feedback" => "a hub that moves as prescribed needs no feedback",
            "--at" | "--carriage-at" => "the first row is where it starts",
            _ => "the hub angle is a smooth curve through its samples",
        };
        Err(Failure::new(Exit::Usage, &message, Some(&joint.worded(hint))))
    }

    /// Arguments for the record, without files.
    pub(crate) fn arguments(&self) -> Vec<String> {
        let is_told = |own: &InputKind| own.is_motion() || *own == InputKind::Voltage;
        let input = self.input.filter(is_told);
        let input = input.map(|own| option("--input", own.name()));
        let column = self.column.iter().map(|column| option("--column", column));
        let feedback = self.feedback.as_ref().map(|pairs| {
            let pairs: Vec<String> = pairs.iter().map(|(kp, kd)| format!("{kp},{kd}")).collect();
            option("--feedback", pairs.join(","))
        });
        let input = input.into_iter().chain(column).chain([self.hold.arguments()]);
        input.chain(feedback).flatten().collect()
    }
}

impl PlayArgs {
    /// All files, for the check that no output replaces one.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        let others = [&self.target, &self.measured, &self.moving.reference, &self.state];
        let others = others.into_iter().flatten();
        [&self.file].into_iter().chain(others).map(PathBuf::as_path)
    }

    /// Reads all files; every error names its file.
    pub(crate) fn load(
        &self,
        arm: &Arm,
        is_large: bool,
        read: &ReadArgs,
    ) -> Result<Playing, Failure> {
        self.check(arm)?;
        read.check(&TABLES)?;
        let (links, joints) = (arm.links().len(), Joints::from(arm));
        let link = arm.alone();
        let options = |table| read.format(table, TABLES[0]);
        let Driven { files, moving, feedback, since } =
            self.moving.load(&self.file, arm, &options)?;
        let format = |table| TableFormat { since: since.clone(), ..options(table) };
        let open = |path: &Option<PathBuf>| path.as_deref().map(InputFile::read).transpose();
        let [target_file, measured, state_file] =
            [open(&self.target)?, open(&self.measured)?, open(&self.state)?];
        let mut start_angle_rad = None;
        let target = target_file.as_ref().map(|file| -> Result<TipPlaces, Failure> {
            let name = TableName::Target;
            let form = format(name);
            let (target, reading) = match link {
                Some(link) => {
                    let target = read_target(&file.shown, &file.bytes, link, &form);
                    let (target, reading) =
                        target.map_err(|error| name.refused(worded(error.into(), file, arm)))?;
                    start_angle_rad = target.start_angle_rad();
                    (TipPlaces::from(&target), reading)
                }
                None => read_tip_places(&file.shown, &file.bytes, &form)
                    .map_err(|error| name.refused(error.into()))?,
            };
            name.tell(&file.shown, &reading);
            Ok(target)
        });
        let target = target.transpose()?;
        let measured = measured.map(|file| -> Result<_, Failure> {
            let name = TableName::Measured;
            // One table with both has its columns from the options without a name.
            let is_same =
                file.bytes == files.input.bytes && options(name) == TableFormat::default();
            let own = format(if is_same { TableName::Torque } else { name });
            let read = read_recording_as(&file.shown, &file.bytes, joints, &own);
            let (recording, reading) = read.map_err(|error| {
                let failure = Failure::from(error);
                if is_same { failure } else { name.refused(failure) }
            })?;
            name.tell(&file.shown, &reading);
            Ok((file, recording))
        });
        let measured = measured.transpose()?;
        let state = state_file.as_ref();
        let state = state.map(|file| read_state(&file.shown, &file.bytes, links)).transpose()?;
        let begins = Begins {
            state: state.is_some(),
            moved: self.moving.is_moved(),
            at: self.at.as_deref(),
            tip_m: None,
        };
        let start = AtRest::of(arm, &begins, (&feedback, target.as_ref()))?;
        let moves = Moves {
            moving,
            interpolation: self.moving.interpolation(),
            until_s: self.until,
            feedback,
            start,
            carriage_m: self.carriage_at.unwrap_or_default(),
            state,
            target,
            start_angle_rad,
            is_large,
            is_periodic: self.periodic,
            is_under_voltage: self.moving.is_under_voltage(),
        };
        Ok(Playing { files, target_file, measured, state_file, moves })
    }

    /// Refuses inputs and options that do not suit the arm.
    fn check(&self, arm: &Arm) -> Result<(), Failure> {
        let starts = [("--at", self.at.is_some()), ("--carriage-at", self.carriage_at.is_some())];
        self.moving.check(arm, &starts)?;
        if self.at.is_some() && arm.alone().is_some() {
            let message =
                "--at sets the directions of an arm, but one link starts at its start_angle";
            return Err(Failure::new(Exit::Usage, &message, None));
        }
        if self.carriage_at.is_some() && arm.carriage().is_none() {
            let message = "--carriage-at is for an arm on a carriage, but the file has none";
            return Err(Failure::new(Exit::Usage, &message, None));
        }
        Ok(())
    }

    /// Arguments for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        let until = self.until.map(|until| option("--until", until));
        let at = self
            .at
            .as_ref()
            .map(|at| option("--at", at.iter().map(f64::to_string).collect::<Vec<_>>().join(",")));
        let carriage_at = self.carriage_at.map(|at_m| option("--carriage-at", at_m));
        let periodic = self.periodic.then(|| vec!["--periodic".to_owned()]);
        let others = until.into_iter().chain(periodic).chain(at).chain(carriage_at);
        self.moving.arguments().into_iter().chain(others.flatten()).collect()
    }
}

/// Adds the force of an arm's carriage from force.csv beside the file of the torques, unless this file has it.
fn with_force(
    torques: &mut Vec<Torque>,
    of: (&Arm, &Path),
    (hold, format): (&HoldArgs, &TableFormat),
) -> Result<Option<InputFile>, Failure> {
    let format = &beside(format);
    let read = |file: &InputFile| read_joint_torques(&file.shown, &file.bytes, ALONE, format);
    let own = with_carriage(torques, of, ["force.csv", "force"], (read, Torque::grid, format))?;
    let Some((file, reading)) = own else { return Ok(None) };
    hold.refuse(&file, &reading)?;
    Ok(Some(file))
}

/// Adds the motion of an arm's carriage from carriage.csv beside the file of the joints, unless this file has it.
fn with_carriage_moved(
    joints: &mut Vec<HubReference>,
    of: (&Arm, &Path),
    format: &TableFormat,
) -> Result<Option<InputFile>, Failure> {
    let format = &beside(format);
    let read = |file: &InputFile| read_joint_references(&file.shown, &file.bytes, ALONE, format);
    let how = (read, HubReference::grid, format);
    let own = with_carriage(joints, of, ["carriage.csv", "carriage"], how)?;
    Ok(own.map(|(file, _)| file))
}

/// The options of a table for the one beside it: all but those of its own columns.
fn beside(format: &TableFormat) -> TableFormat {
    TableFormat { columns: Vec::new(), scales: Vec::new(), unit: None, ..format.clone() }
}

/// The carriage in a table of its own.
const ALONE: Joints = Joints { links: 1, slides: true };

/// Adds the history of an arm's carriage from the file `name` beside that of the joints, unless this file has it in its
/// `column`. Says so, and refuses other times.
fn with_carriage<T>(
    histories: &mut Vec<T>,
    (arm, path): (&Arm, &Path),
    [name, column]: [&str; 2],
    (read, grid, format): (
        impl Fn(&InputFile) -> Result<(Vec<T>, Reading), TableError>,
        impl Fn(&T) -> TimeGrid,
        &TableFormat,
    ),
) -> Result<Option<(InputFile, Reading)>, Failure> {
    if histories.len() == arm.joints().count() {
        return Ok(None);
    }
    let shown = path.display();
    if path.as_os_str() == "-" || !path.with_file_name(name).exists() {
        let message =
            format!("{shown}: the column {column} is missing, and there is no {name} beside it");
        let hint = "solve writes both files; solve --write writes all efforts into one";
        return Err(Failure::new(Exit::InputRefused, &message, Some(hint)));
    }
    let file = InputFile::read_beside(path, name)?;
    let (own, reading) = read(&file).map_err(|error| {
        let failure = Failure::from(error);
        let hint = "the reading options are also those of this file; or put all efforts into one table, as solve --write \
                    does";
        let is_given = *format != TableFormat::default();
        if is_given { Failure { hint: Some(hint.to_owned()), ..failure } } else { failure }
    })?;
    tell(&file.shown, &reading);
    if grid(&own[0]) != grid(&histories[0]) {
        let message =
            format!("{}: has other times than {shown}, but must have the same", file.shown);
        let hint = format!("take both of one run of solve, or add the column {column} to {shown}");
        return Err(Failure::new(Exit::InputRefused, &message, Some(&hint)));
    }
    console::note(&format!("{}: gives the column {column} beside {shown}", file.shown));
    histories.extend(own);
    Ok(Some((file, reading)))
}

/// Pairs of gains, separated by commas.
pub(crate) fn gains(text: &str) -> Result<Gains, String> {
    let numbers: Option<Vec<f64>> =
        text.split(',').map(|part| part.trim().parse::<f64>().ok()).collect();
    let pairs = numbers.filter(|numbers| numbers.len().is_multiple_of(2));
    let pairs = pairs.map(|numbers| numbers.chunks(2).map(|pair| (pair[0], pair[1])).collect());
    pairs.ok_or_else(|| "must be two numbers, KP,KD, or a pair for each joint of an arm".into())
}

/// Reads the torque of a link or the force on its carriage, in a column of the user if he names one, or the torques of an
/// arm.
fn read_torques(
    file: &InputFile,
    joints: Joints,
    (column, format): (Option<&str>, &TableFormat),
) -> Result<(Vec<Torque>, Reading), Failure> {
    let InputFile { shown, bytes, .. } = file;
    match column {
        None => Ok(read_joint_torques(shown, bytes, joints, format)?),
        Some(_) if joints.links > 1 => {
            let message =
                "--column names one column, but the torques of an arm are torque1, torque2, …";
            let hint = "rename the columns in the file";
            Err(Failure::new(Exit::Usage, &message, Some(hint)))
        }
        column => {
            let (torque, reading) = read_torque_table_as(shown, bytes, joints, column, format)?;
            Ok((vec![torque], reading))
        }
    }
}

/// A pair of gains for each joint, of one pair for all or of as many.
pub(crate) fn gains_of_joints(gains: &[(f64, f64)], arm: &Arm) -> Result<Gains, Failure> {
    let joints = arm.joints().count();
    if let [one] = gains {
        return Ok(vec![*one; joints]);
    }
    if gains.len() == joints {
        return Ok(gains.to_vec());
    }
    let found = gains.len();
    let each = match joints {
        1 => String::new(),
        _ => format!(", for all joints, or {joints}, one for each"),
    };
    let message = format!("--feedback = {found} pairs, but must be 1{each}");
    let hint = (joints > 1).then_some(match arm.carriage() {
        Some(_) => "KP1,KD1,KP2,KD2,KP,KD, from the inner joint on, the carriage last",
        None => "KP1,KD1,KP2,KD2, from the inner joint on",
    });
    Err(Failure::new(Exit::Usage, &message, hint))
}

/// The feedback of each joint around its reference, with one pair of gains for all joints, or one pair for each;
/// empty without gains.
pub fn feedback(
    gains: Option<&[(f64, f64)]>,
    references: Vec<HubReference>,
    arm: &Arm,
) -> Result<Vec<Feedback>, Failure> {
    let gains = gains.map(|own| gains_of_joints(own, arm)).transpose()?.unwrap_or_default();
    let of_joints = gains.into_iter().zip(references);
    let of_joints = of_joints.map(|((kp, kd), reference)| Feedback::new(kp, kd, reference));
    of_joints.collect::<Result<_, _>>().map_err(|error| MovingArgs::gains_refused(&error, arm))
}
