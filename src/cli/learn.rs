//! `learn`: the next effort of a repeated motion from the measured tip.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use rayon::prelude::*;

use super::problem::Problem;
use super::robust::{Plants, not_played};
use crate::cli::options::common::{digits_arguments, option, seconds};
use crate::cli::options::inputs::{ChangeArgs, LINK, MOTION, MotionArgs};
use crate::cli::options::reading::TableName;
use crate::cli::terminal::files::{keep_files, read_once};
use crate::cli::terminal::text::learn_text;
use crate::cli::terminal::{
    Exit, Failure, PrintArgs, StageBar, ThreadArgs, WarningArgs, console, memory,
};
use crate::csv::{
    Digits, InputFile, Joints, Reading, TableError, read_joint_references, read_joint_torques,
    read_recording_as,
};
use crate::inverse::{Resources, Solution, invert_motion};
use crate::learn::{
    Band, Contraction, Correction, LearnError, LearnSummary, Plant, Recorded, Saturation, Table,
    responses, saturation,
};
use crate::link::Arm;
use crate::numeric::{largest, rounded};
use crate::result::{ChannelRecording, Limits, Notice};
use crate::robust::{Command, Hold, How, Key, Thinned, directions_rad};
use crate::spec::{Override, Specification, Uncertain};
use crate::store::{Fingerprint, LearnInputs, record_json, write_next};
use crate::text::{given, shown_path, significant};

const EXAMPLE: &str = "\
Example:
  flexlink learn link.toml motion.csv camera.csv \\
      --uncertain 'segments.*.EI*=±10%' -o next.csv
  flexlink learn link.toml motion.csv camera2.csv \\
      --applied next.csv --uncertain 'segments.*.EI*=±10%'
  flexlink learn link.toml motion.csv camera.csv \\
      --play position --uncertain 'payload.mass=±20 g'";

/// Share of the motion at its ends that an applied table may lack, as one cut by --window does.
const UNPLAYED: f64 = 0.1;

/// Smallest error that counts, over the travel, and by how much it must exceed that of all links within the intervals.
const SEEN: f64 = 1e-4;
const BEYOND: f64 = 1.2;

/// Largest travel of the measured tip after the motion, over that of the motion, that counts as rest.
const AT_REST: f64 = 0.03;

/// Quantity that the drives hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Holds {
    /// The positions of the joints.
    Position,
    /// Torques and forces.
    #[value(aliases = ["torque", "force"])]
    Effort,
}

/// Compute the next torque of a repeated motion from the measured tip.
///
/// Adds to the applied torque the inverse of the error, wanted less measured tip, and writes the next table. Play it,
/// measure again, and repeat. The error shrinks at the frequencies where max |G_true/G - 1| < 1: G is the response of the
/// model, G_true that of a plant within the intervals. The command prints this maximum, also weighted by the error's
/// spectrum, and the error to expect. This is the larger one of two: the contracted error, and the error of the plants
/// that play the next table.
///
/// MEASURED has the time of MOTION and the tip, with rest before and after the motion. A constant offset of the sensor does not
/// count. The command refuses another motion, a time shift that explains the error, and a torque with a plateau, as of a
/// drive at its limit.
///
/// With --play position the table is the motion of the joints, which the drives hold. Links of an arm from the third on, and
/// its carriage, keep their wanted motion in the correction.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Learn {
    #[arg(value_name = "LINK", help = LINK)]
    link: PathBuf,

    #[arg(value_name = "MOTION", help = MOTION)]
    motion: PathBuf,

    /// Recording (CSV): `time` and `tip`, of an arm `x` and `y`, at any times, as --measured of simulate.
    #[arg(value_name = "MEASURED")]
    measured: PathBuf,

    #[command(flatten)]
    options: LearnOptions,

    /// Table that was played when MEASURED was recorded: torque.csv, force.csv, torques.csv, or with --play position
    /// hub_angle.csv, carriage.csv, joint_angles.csv; of an arm on a carriage all joints in one table [default: that of
    /// solve].
    #[arg(long, value_name = "FILE")]
    applied: Option<PathBuf>,

    /// Record of a fit, NAME.json beside the fitted LINK: its values vary within their 95 % intervals.
    #[arg(long, value_name = "FIT")]
    from: Option<PathBuf>,

    /// Table to write.
    #[arg(short, long, value_name = "FILE", default_value = "next.csv")]
    output: PathBuf,

    #[command(flatten)]
    print: PrintArgs,

    #[command(flatten)]
    warnings: WarningArgs,

    #[command(flatten)]
    threads: ThreadArgs,
}

/// The options that shape a step beside its files; its record has them.
#[derive(Debug, Args)]
pub struct LearnOptions {
    #[command(flatten)]
    changes: ChangeArgs,

    /// Quantity that the drives hold.
    #[arg(long = "play", value_name = "WHAT", default_value = "effort")]
    holds: Holds,

    /// Interval of a value: KEY=±SHARE%, KEY=±AMOUNT, KEY=LOW..HIGH, or KEY*=LOW..HIGH for factors;
    /// repeatable [default: [uncertainty] of the link file]. KEY is a path as in --set; delay is that of
    /// position drives.
    #[arg(long, value_name = "KEY=INTERVAL")]
    uncertain: Vec<Uncertain>,

    /// Time in MEASURED at the motion's time 0, in s or with its unit. 0 states that the clocks agree.
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_hyphen_values = true)]
    shift: Option<f64>,

    /// Digits: the last one is 10^-N of a column's peak, or `full`.
    #[arg(long, value_name = "N", default_value = "10")]
    pub digits: Digits,

    #[command(flatten)]
    pub motion: MotionArgs,
}

/// Tables that options of reading may name.
const TABLES: [TableName; 3] = [TableName::Motion, TableName::Measured, TableName::Applied];

/// A recording of the tip, and the table that was played for it.
pub struct Trial<'a> {
    /// Name of the recording in messages.
    pub shown: &'a str,
    pub recording: &'a ChannelRecording,
    /// The table that was played, with its name in messages; `None`: the answer of `solve`.
    pub applied: Option<(&'a Table, &'a str)>,
}

/// A step of learning.
pub struct Step {
    arm: Arm,
    /// Quantity that the drives hold.
    pub hold: Hold,
    /// The table to play next.
    pub next: Table,
    /// Its numbers.
    pub summary: LearnSummary,
    /// Its warnings beside those of the solution.
    pub warnings: Vec<Notice>,
}

/// The failure of a step that no table causes.
fn not_learned(error: &LearnError) -> Failure {
    Failure::new(Exit::NotSolvable, error, error.hint().as_deref())
}

impl Learn {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        let files = [&self.link, &self.motion, &self.measured].into_iter();
        let files = files.chain(&self.applied).chain(&self.from);
        let files: Vec<&Path> = files.map(PathBuf::as_path).collect();
        read_once(&files)?;
        keep_files(&self.output, &files)?;
        let file = InputFile::read_toml(&self.link)?;
        let fit = self.from.as_deref().map(InputFile::read).transpose()?;
        let options = &self.options;
        let changes = options.changes.overrides()?;
        let (plants, specification) = options.plants((&file, changes), fit.as_ref())?;
        let motion = InputFile::read(&self.motion)?;
        let problem = Problem::read((&file, specification), &motion, &options.motion)?;
        let arm = &problem.specification.arm;
        let applied = self.applied.as_deref().map(InputFile::read).transpose()?;
        let table = applied.as_ref().map(|file| {
            let (table, reading) = options.table(file, arm)?;
            TableName::Applied.tell(&file.shown, &reading);
            Ok::<_, Failure>(table)
        });
        let table = table.transpose()?;
        let measured = InputFile::read(&self.measured)?;
        let (recording, reading) = options.recording(&measured, arm)?;
        TableName::Measured.tell(&measured.shown, &reading);
        let stages = self.print.stages();
        let solved = problem.solve(|own| *own, memory::available(), &stages)?;
        let played = applied.as_ref().map_or("solve", |file| &file.shown);
        let trial = Trial {
            shown: &measured.shown,
            recording: &recording,
            applied: table.as_ref().map(|table| (table, played)),
        };
        let step = options.step((&problem, &solved.solution), &plants, &trial, &stages)?;
        drop(stages);
        console::deliver_by(Some(&self.output), |out| step.write(out, options.digits))?;
        let told = solved.tell();
        console::warnings(step.warnings.iter().cloned());
        let inputs = LearnInputs {
            link: Some(Fingerprint::of(&file)),
            motion: Some(Fingerprint::of(&motion)),
            measured: Some(Fingerprint::of(&measured)),
            applied: applied.as_ref().map(Fingerprint::of),
            fit: fit.as_ref().map(Fingerprint::of),
            arguments: options.arguments(),
        };
        let record = || step.record(&inputs, solved.warnings());
        let output = shown_path(&self.output);
        self.print.print(record, || learn_text(arm, &step.summary, played, &output))?;
        self.warnings.refuse(told + step.warnings.len())
    }
}

impl Step {
    /// The record of the step, with these inputs and the warnings of the solution.
    pub fn record(&self, inputs: &LearnInputs, of_solution: Vec<Notice>) -> String {
        let warnings = [of_solution, self.warnings.clone()].concat();
        record_json("learn", (self.arm.title(), inputs), &self.summary, &warnings)
    }

    /// Writes the table to play next.
    pub fn write(&self, out: &mut (dyn Write + Send), digits: Digits) -> io::Result<()> {
        write_next(out, &self.arm, (&self.next, self.hold), digits)
    }
}

impl LearnOptions {
    /// The plants of a link file with changes, and the specification of the file.
    pub fn plants(
        &self,
        link: (&InputFile, Vec<Override>),
        fit: Option<&InputFile>,
    ) -> Result<(Plants, Specification), Failure> {
        self.motion.read.check(&TABLES)?;
        Plants::of(link, (&self.uncertain, fit), self.hold())
    }

    /// The next table after a trial on the link of a solution.
    pub fn step(
        &self,
        (problem, solution): (&Problem, &Solution),
        plants: &Plants,
        trial: &Trial<'_>,
        stages: &StageBar,
    ) -> Result<Step, Failure> {
        let Specification { arm, limits, .. } = &problem.specification;
        let hold = self.hold();
        let own = Table::of(solution, hold);
        let (table, shown) = trial.applied.unwrap_or((&own, "solve"));
        refuse_short((table, shown), solution)?;
        self.refuse_saturated((table, shown), &problem.specification)?;
        let recorded = self.recorded(trial, solution, &plants.keys)?;
        stages.at("comparing plants");
        let each = plants.ends();
        let each = each.par_iter().map(|values| Ok((plants.with(values)?, plants.delay_s(values))));
        let each = each.collect::<Result<Vec<_>, Failure>>()?;
        let band = self.band(problem, solution, &recorded, &each)?;
        stages.at("correcting");
        let correction =
            Correction::of(solution, &recorded, &band).map_err(|error| not_learned(&error))?;
        let corrected = Self::corrected(problem, &correction, stages)?;
        let holds = hold == Hold::Position || arm.has_weight();
        let next = table.changed([&own, &Table::of(&corrected, hold)], holds);
        stages.at("playing plants");
        let tables = [table, &next];
        let falls = arm.alone().is_none() && arm.has_weight() && hold == Hold::Effort;
        let played = if falls {
            Err("an arm under weight falls without feedback".to_owned())
        } else {
            let played = self.played_rms_m((problem, solution), &recorded, &each, tables);
            played.map_err(|failure| failure.message)
        };
        let summary = LearnSummary::of(
            (solution, &recorded, self.shift.unwrap_or(0.0)),
            (&plants.keys, each.len()),
            (&band, &correction, *played.as_ref().unwrap_or(&0.0)),
            (&next, hold),
        );
        let mut warnings = self.warnings_of(&next, limits, arm);
        let unplayed = played.err().map(|why| {
            let message = format!(
                "the error to expect is that of small motions about poses at rest, for plants do not play the table: {why}"
            );
            let hint = "learn with --play position if the drives hold positions";
            Notice::new("small_motions", message, hint)
        });
        let others = [beyond(&summary), moving(&recorded), unplayed];
        warnings.extend(others.into_iter().flatten());
        Ok(Step { arm: arm.clone(), hold, next, summary, warnings })
    }

    /// Quantity that the drives hold.
    pub fn hold(&self) -> Hold {
        match self.holds {
            Holds::Position => Hold::Position,
            Holds::Effort => Hold::Effort,
        }
    }

    /// The applied table in a file.
    pub fn table(&self, file: &InputFile, arm: &Arm) -> Result<(Table, Reading), Failure> {
        let InputFile { shown, bytes, .. } = file;
        let (joints, name) = (Joints::from(arm), TableName::Applied);
        let format = self.motion.read.format(name, TABLES[0]);
        let of_table = |error: TableError| name.refused(error.into());
        let (table, reading, column) = if self.hold() == Hold::Position {
            let (found, reading) =
                read_joint_references(shown, bytes, joints, &format).map_err(of_table)?;
            (Table::of_positions(&found), reading, "carriage")
        } else {
            let (found, reading) =
                read_joint_torques(shown, bytes, joints, &format).map_err(of_table)?;
            (Table::of_efforts(&found), reading, "force")
        };
        if table.joints.len() < arm.joints().count() {
            let message = format!("{shown}: the column {column} is missing");
            let hint = "put all joints into one table, as learn does; without --applied it is that of solve";
            return Err(Failure::new(Exit::InputRefused, &message, Some(hint)));
        }
        Ok((table, reading))
    }

    /// The recording in a file.
    pub fn recording(
        &self,
        file: &InputFile,
        arm: &Arm,
    ) -> Result<(ChannelRecording, Reading), Failure> {
        let (joints, name) = (Joints::from(arm), TableName::Measured);
        let format = self.motion.read.format(name, TABLES[0]);
        let read = read_recording_as(&file.shown, &file.bytes, joints, &format);
        read.map_err(|error| name.refused(error.into()))
    }

    /// Refuses an effort that the drive cannot have played.
    fn refuse_saturated(
        &self,
        (table, place): (&Table, &str),
        Specification { arm, limits, .. }: &Specification,
    ) -> Result<(), Failure> {
        if self.hold() == Hold::Position {
            return Ok(());
        }
        for (number, columns) in table.joints.iter().enumerate() {
            let limit = limits.get(number).and_then(|own: &Limits| own.of("torque"));
            let Some(found) = saturation(&columns[0], limit) else { continue };
            let Saturation { sample, samples, value, is_limit } = found;
            let [what, key] = torque_and_limit(arm, number);
            let [value, time] = [value, table.grid.time_s(sample)].map(|own| significant(own, 6));
            let why = match limit.filter(|_| is_limit) {
                Some(limit) => format!("at {key} = {}", significant(limit, 6)),
                None => "a plateau at its extremum".to_owned(),
            };
            let message = format!(
                "{place}: {what} = {value} in {samples} rows from {time} s, {why}: it is saturated"
            );
            let hint = "learn a slower motion, or raise the limit: a drive at its limit plays no correction";
            return Err(Failure::new(Exit::InputRefused, &message, Some(hint)));
        }
        Ok(())
    }

    /// The error of the recording.
    fn recorded(
        &self,
        Trial { shown, recording, .. }: &Trial<'_>,
        solution: &Solution,
        keys: &[Key],
    ) -> Result<Recorded, Failure> {
        let lags = keys.iter().filter(|key| key.how == How::Delay);
        let lag_s = lags.map(|key| key.ends[1]).sum();
        Recorded::of(solution, recording, (self.shift, lag_s)).map_err(|error| {
            let message = format!("{shown}: {error}");
            Failure::new(Exit::InputRefused, &message, error.hint().as_deref())
        })
    }

    /// The band of these plants, each with the delay of its drives in s.
    fn band(
        &self,
        problem: &Problem,
        solution: &Solution,
        recorded: &Recorded,
        plants: &[(Specification, f64)],
    ) -> Result<Band, Failure> {
        let refused = |error: LearnError| not_learned(&error);
        let Specification { arm, meshes, analysis, .. } = &problem.specification;
        let band = &solution.band;
        let lowest_hz = 0.5 / recorded.grid.duration_s();
        let highest_hz = band.cutoff_hz.unwrap_or(band.highest_hz);
        let frequencies_hz = Contraction::frequencies_hz(arm, [lowest_hz, highest_hz]);
        let (first, last) = solution.moving;
        let poses = [first, first.midpoint(last), last];
        let poses_rad = poses.map(|sample| directions_rad(solution, sample));
        let at = (&poses_rad[..], &frequencies_hz[..]);
        let kept = analysis.kept_modes();
        let nominal = Plant { arm, meshes, kept, delay_s: 0.0 };
        let nominal = responses(&nominal, self.hold(), at).map_err(refused)?;
        let of_plant = |(own, delay_s): &(Specification, f64)| {
            let Specification { arm, meshes, .. } = own;
            let plant = Plant { arm, meshes, kept, delay_s: *delay_s };
            responses(&plant, self.hold(), at).map_err(refused)
        };
        let all: Vec<_> = plants.par_iter().map(of_plant).collect::<Result<_, _>>()?;
        let contraction = Contraction::of(frequencies_hz, &nominal, &all);
        contraction.band().map_err(refused)
    }

    /// Largest root mean square in m of the next error: of the measured one less the change of the tip from the applied table to
    /// the next, as the plants of the intervals play both.
    fn played_rms_m(
        &self,
        (problem, solution): (&Problem, &Solution),
        recorded: &Recorded,
        plants: &[(Specification, f64)],
        tables: [&Table; 2],
    ) -> Result<f64, Failure> {
        let Specification { arm, meshes, .. } = &problem.specification;
        let (hold, until_s) = (self.hold(), recorded.grid.end_s());
        let failed = |error| not_played(&error, arm);
        let command = |table: &Table| {
            let end_s = solution.grid.time_s(solution.moving.1);
            let histories = table.histories(solution, hold);
            let how = (hold, &[][..], Thinned::No);
            let command = problem.command(solution, (&histories, end_s), how)?;
            command.refined(arm, meshes).map_err(failed)
        };
        let [applied, next] = [command(tables[0])?, command(tables[1])?];
        let of_plant = |(own, delay_s): &(Specification, f64)| {
            let tip = |command: &Command| {
                let how = (*delay_s, until_s, until_s);
                let played = command.plant((&own.arm, &own.meshes), how, &[]).map_err(failed)?;
                Ok::<_, Failure>(command.over_time(&played.error_m))
            };
            let [before, after] = [tip(&applied)?, tip(&next)?];
            let change_m = |axis, time_s| after(axis, time_s) - before(axis, time_s);
            Ok(recorded.rms_and_peak_less_m(change_m)[0])
        };
        let all = plants.par_iter().map(of_plant).collect::<Result<Vec<f64>, Failure>>()?;
        Ok(all.into_iter().fold(0.0, f64::max))
    }

    /// The solution of the corrected motion.
    fn corrected(
        problem: &Problem,
        correction: &Correction,
        stages: &StageBar,
    ) -> Result<Solution, Failure> {
        let Specification { arm, meshes, analysis, .. } = &problem.specification;
        let memory_bytes = memory::available();
        let resources = Resources { memory_bytes, watch: stages, ..Resources::default() };
        invert_motion(arm, meshes, &correction.motion, analysis, &resources).map_err(|error| {
            let message = format!("the corrected motion: {error}");
            Failure::new(Exit::NotSolvable, &message, error.hint())
        })
    }

    /// Warnings of limits that the next table exceeds.
    fn warnings_of(&self, next: &Table, limits: &[Limits], arm: &Arm) -> Vec<Notice> {
        let warning = |(number, columns): (usize, &Vec<Vec<f64>>)| {
            let limit = limits.get(number)?.of("torque")?;
            let found = largest(&columns[0]);
            let [of, most] = [found, limit].map(|own| significant(own, 5));
            let [what, key] = torque_and_limit(arm, number);
            let message = format!("the next {what} = {of}, but {key} is {most}");
            let hint = "learn a slower motion: a drive at its limit plays no correction";
            (found > limit).then(|| Notice::new("limit_exceeded", message, hint))
        };
        let joints = next.joints.iter().enumerate();
        joints.filter(|_| self.hold() == Hold::Effort).filter_map(warning).collect()
    }

    /// The arguments, for the record.
    pub fn arguments(&self) -> Vec<String> {
        let uncertain = self.uncertain.iter().flat_map(|own| option("--uncertain", own.text()));
        let shift = self.shift.map(|shift_s| option("--shift", shift_s));
        let own = uncertain.chain(option("--play", self.hold().name()));
        [
            self.changes.arguments(),
            own.chain(shift.into_iter().flatten()).collect(),
            self.motion.arguments(),
            digits_arguments(self.digits),
        ]
        .concat()
    }
}

/// Names of a joint's effort and of its limit: `torque of joint 2` and `limits.torque`.
fn torque_and_limit(arm: &Arm, number: usize) -> [String; 2] {
    let joint = arm.joints().nth(number).unwrap_or(arm.joint());
    let of_joint = format!(" of joint {}", number + 1);
    let of_arm = if joint.slides() { " on the carriage".to_owned() } else { of_joint };
    let of_joint = arm.pick(String::new(), of_arm);
    [format!("torque{of_joint}"), "limits.torque".to_owned()].map(|own| joint.worded(&own))
}

/// The warning of a tip that hardly rests after the motion.
fn moving(recorded: &Recorded) -> Option<Notice> {
    let share = recorded.moves_after;
    let percent = significant(100.0 * share, 3);
    let message = format!(
        "the measured tip still moves by {percent} % of the travel after the motion: the error at rest is not known"
    );
    let hint = "record until the tip rests, or add friction or feedback";
    (share > AT_REST).then(|| Notice::new("tip_moves", message, hint))
}

/// Refuses a table that lacks a part of the motion.
fn refuse_short((table, place): (&Table, &str), solution: &Solution) -> Result<(), Failure> {
    let [own, motion] = [&table.grid, &solution.grid];
    let motion_s = [solution.moving.0, solution.moving.1].map(|sample| motion.time_s(sample));
    let least_s = UNPLAYED * (motion_s[1] - motion_s[0]);
    if own.time_s(0) <= motion_s[0] + least_s && own.end_s() >= motion_s[1] - least_s {
        return Ok(());
    }
    let seconds = |time_s: f64| given(rounded(time_s, 6));
    let [from, until] = [own.time_s(0), own.end_s()].map(seconds);
    let [begin, end] = motion_s.map(seconds);
    let message = format!(
        "{place}: lasts from {from} to {until} s, but must last from {begin} to {end} s, as the motion does"
    );
    let hint = "name the whole table that was played, on the clock of the motion";
    Err(Failure::new(Exit::InputRefused, &message, Some(hint)))
}

/// The warning of an error that no link within the intervals makes.
fn beyond(summary: &LearnSummary) -> Option<Notice> {
    let [found_m, possible_m] = summary.in_band_rms_m;
    let is_seen = found_m > SEEN * summary.travel_m && found_m > BEYOND * possible_m;
    let times = significant((found_m / possible_m).min(1e6), 3);
    let message = format!(
        "the error in the band is {times} times that which links within the intervals make under the answer of solve"
    );
    let hint = "another value is off, such as friction, or the measurement: name it with --uncertain, or measure and fit it";
    is_seen.then(|| Notice::new("beyond_intervals", message, hint))
}
