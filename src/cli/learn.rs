//! `learn`: the next effort of a repeated motion from the measured tip.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use rayon::prelude::*;

use super::problem::{Problem, Solved};
use super::robust::{Plants, ends, keys};
use crate::cli::options::common::{digits_arguments, option, seconds};
use crate::cli::options::inputs::{
    ChangeArgs, LINK, MOTION, ReadArgs, ResampleArgs, ScaleArgs, tell,
};
use crate::cli::terminal::files::{keep_files, read_once};
use crate::cli::terminal::text::learn_text;
use crate::cli::terminal::{
    Exit, Failure, PrintArgs, StageBar, ThreadArgs, WarningArgs, console, memory,
};
use crate::csv::{
    Digits, InputFile, Joints, TableFormat, read_joint_references, read_joint_torques,
    read_recording_as,
};
use crate::inverse::{Resources, Solution, invert_motion};
use crate::learn::{
    Band, Contraction, Correction, LearnError, LearnSummary, Plant, Recorded, Saturation, Table,
    responses, saturation,
};
use crate::link::Arm;
use crate::numeric::largest;
use crate::result::{Limits, Notice};
use crate::robust::{Hold, Key, Values, directions_rad};
use crate::spec::{LinkDocument, Specification, Uncertain};
use crate::store::{Fingerprint, LearnInputs, record_json, write_next};
use crate::text::{shown_path, significant};

const EXAMPLE: &str = "\
Example:
  flexlink learn link.toml motion.csv camera.csv \\
      --uncertain 'segments.*.EI*=±10%' -o next.csv
  flexlink learn link.toml motion.csv camera2.csv \\
      --applied next.csv --uncertain 'segments.*.EI*=±10%'
  flexlink learn link.toml motion.csv camera.csv \\
      --play position --uncertain 'payload.mass=±20 g'";

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
/// measure again, and repeat. The error shrinks in the band in which no plant within the intervals differs from the model by
/// as much as it responds: max |G_true/G - 1| < 1. Printed are this maximum, also weighted by the error's spectrum,
/// and the error to expect.
///
/// MEASURED has the time of MOTION and the tip, with rest before and after the motion. A constant offset of the sensor does not
/// count. Refused are another motion, a time shift that explains the error, and a torque with a plateau, as of a
/// drive at its limit.
///
/// With --play position the table is the motion of the joints, which the drives hold. For one link or an arm of two.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Learn {
    #[arg(value_name = "LINK", help = LINK)]
    link: PathBuf,

    #[arg(value_name = "MOTION", help = MOTION)]
    motion: PathBuf,

    /// Recording (CSV): `time` and `tip`, of an arm `x` and `y`, at any times, as --measured of simulate. The options of
    /// reading are those of this table.
    #[arg(value_name = "MEASURED")]
    measured: PathBuf,

    #[command(flatten)]
    changes: ChangeArgs,

    /// Table that was played when MEASURED was recorded: torque.csv, force.csv, torques.csv, or with --play position
    /// hub_angle.csv, carriage.csv, joint_angles.csv [default: that of solve].
    #[arg(long, value_name = "FILE")]
    applied: Option<PathBuf>,

    /// Quantity that the drives hold.
    #[arg(long = "play", value_name = "WHAT", default_value = "effort")]
    holds: Holds,

    /// Interval of a value: KEY=±SHARE%, KEY=±AMOUNT, KEY=LOW..HIGH, or KEY*=LOW..HIGH for factors;
    /// repeatable [default: [uncertainty] of the link file]. KEY is a path as in --set; delay is that of
    /// position drives.
    #[arg(long, value_name = "KEY=INTERVAL")]
    uncertain: Vec<Uncertain>,

    /// Record of a fit, NAME.json beside the fitted LINK: its values vary within their 95 % intervals.
    #[arg(long, value_name = "FIT")]
    from: Option<PathBuf>,

    /// Time in MEASURED at the motion's time 0, in s or with its unit. 0 states that the clocks agree.
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_hyphen_values = true)]
    shift: Option<f64>,

    /// Table to write.
    #[arg(short, long, value_name = "FILE", default_value = "next.csv")]
    output: PathBuf,

    /// Digits: the last one is 10^-N of a column's peak, or `full`.
    #[arg(long, value_name = "N", default_value = "10")]
    digits: Digits,

    #[command(flatten)]
    resample: ResampleArgs,

    #[command(flatten)]
    scale: ScaleArgs,

    #[command(flatten)]
    print: PrintArgs,

    #[command(flatten)]
    warnings: WarningArgs,

    #[command(flatten)]
    threads: ThreadArgs,

    #[command(flatten)]
    read: ReadArgs,
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
        let changes = self.changes.overrides()?;
        let document = LinkDocument::read(&file.shown, file.text()?)?;
        let specification = document.specification(&file.shown, &changes)?;
        let intervals = (&self.uncertain[..], fit.as_ref());
        let (keys, _) = keys(&document, (&file, &changes), intervals, self.hold())?;
        let motion = InputFile::read(&self.motion)?;
        let how = (&ReadArgs::default(), &self.resample, &self.scale);
        let problem = Problem::read((&file, specification), &motion, how)?;
        let arm = &problem.specification.arm;
        let applied = self.applied.as_deref().map(InputFile::read).transpose()?;
        let table = applied.as_ref().map(|file| self.table(file, arm)).transpose()?;
        let measured = InputFile::read(&self.measured)?;
        let stages = self.print.stages();
        let solved = problem.solve(|own| *own, memory::available(), &stages)?;
        let solution = &solved.solution;
        let own = Table::of(solution, self.hold());
        let table = table.unwrap_or_else(|| own.clone());
        self.refuse_saturated(&table, applied.as_ref(), &problem.specification)?;
        let recorded = self.recorded(&measured, solution, &keys)?;
        stages.at("comparing plants");
        let plants = Plants { document, name: file.shown.clone(), changes, keys: &keys };
        let (band, count) = self.band(&problem, solution, &recorded, &plants)?;
        stages.at("correcting");
        let correction =
            Correction::of(solution, &recorded, &band).map_err(|error| not_learned(&error))?;
        let corrected = Self::corrected(&problem, &correction, &stages)?;
        let holds = self.hold() == Hold::Position || arm.has_weight();
        let next = table.changed([&own, &Table::of(&corrected, self.hold())], holds);
        let of_step = (&band, &correction);
        let summary = LearnSummary::of(
            (solution, &recorded, self.shift.unwrap_or(0.0)),
            (&keys, count),
            of_step,
            (&next, self.hold()),
        );
        drop(stages);
        console::deliver_by(Some(&self.output), |out| {
            write_next(out, arm, (&next, self.hold()), self.digits)
        })?;
        let inputs = LearnInputs {
            link: Fingerprint::of(&file),
            motion: Fingerprint::of(&motion),
            measured: Fingerprint::of(&measured),
            applied: applied.as_ref().map(Fingerprint::of),
            fit: fit.as_ref().map(Fingerprint::of),
            arguments: self.arguments(),
        };
        let played = applied.as_ref().map_or("solve", |file| &file.shown);
        self.tell((&problem, &solved), (&summary, &inputs), &next, played)
    }

    fn hold(&self) -> Hold {
        match self.holds {
            Holds::Position => Hold::Position,
            Holds::Effort => Hold::Effort,
        }
    }

    /// The applied table.
    fn table(&self, file: &InputFile, arm: &Arm) -> Result<Table, Failure> {
        let InputFile { shown, bytes, .. } = file;
        let (joints, format) = (Joints::from(arm), TableFormat::default());
        if self.hold() == Hold::Position {
            let (found, reading) = read_joint_references(shown, bytes, joints, &format)?;
            tell(shown, &reading);
            let columns = |own: &crate::response::HubReference| {
                let rate = own.rate_rad_s().map(<[f64]>::to_vec);
                [own.angle_rad().to_vec()].into_iter().chain(rate).collect()
            };
            return Ok(Table {
                grid: found[0].grid(),
                joints: found.iter().map(columns).collect(),
            });
        }
        let (found, reading) = read_joint_torques(shown, bytes, joints, &format)?;
        tell(shown, &reading);
        let columns = found.iter().map(|own| vec![own.torque_n_m().to_vec()]);
        Ok(Table { grid: found[0].grid(), joints: columns.collect() })
    }

    /// Refuses an effort that the drive cannot have played.
    fn refuse_saturated(
        &self,
        table: &Table,
        file: Option<&InputFile>,
        Specification { arm, limits, .. }: &Specification,
    ) -> Result<(), Failure> {
        if self.hold() == Hold::Position {
            return Ok(());
        }
        for (number, columns) in table.joints.iter().enumerate() {
            let limit = limits.get(number).and_then(|own: &Limits| own.of("torque"));
            let Some(found) = saturation(&columns[0], limit) else { continue };
            let Saturation { sample, samples, value, is_limit } = found;
            let joint = arm.pick(String::new(), format!(" of joint {}", number + 1));
            let what = arm.joint().worded(&format!("torque{joint}"));
            let [value, time] = [value, table.grid.time_s(sample)].map(|own| significant(own, 6));
            let why =
                if is_limit { "the limit of the link file" } else { "a plateau at its extremum" };
            let place = file.map_or("solve", |file| &file.shown);
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
        file: &InputFile,
        solution: &Solution,
        keys: &[Key],
    ) -> Result<Recorded, Failure> {
        let joints = Joints::from(&solution.arm);
        let (recording, reading) =
            read_recording_as(&file.shown, &file.bytes, joints, &self.read.format())?;
        tell(&file.shown, &reading);
        let lags = keys.iter().filter(|key| key.how == crate::robust::How::Delay);
        let lag_s = lags.map(|key| key.ends[1]).sum();
        Recorded::of(solution, &recording, (self.shift, lag_s)).map_err(|error| {
            let message = format!("{}: {error}", file.shown);
            Failure::new(Exit::InputRefused, &message, error.hint().as_deref())
        })
    }

    /// The band of all plants of the intervals, and their number.
    fn band(
        &self,
        problem: &Problem,
        solution: &Solution,
        recorded: &Recorded,
        plants: &Plants<'_>,
    ) -> Result<(Band, usize), Failure> {
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
        let all = ends(plants.keys);
        let of_plant = |values: &Values| {
            let own = plants.with(values)?;
            let plant =
                Plant { arm: &own.arm, meshes: &own.meshes, kept, delay_s: plants.delay_s(values) };
            responses(&plant, self.hold(), at).map_err(refused)
        };
        let all: Vec<_> = all.par_iter().map(of_plant).collect::<Result<_, _>>()?;
        let contraction = Contraction::of(frequencies_hz, &nominal, &all);
        Ok((contraction.band().map_err(refused)?, all.len()))
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

    /// Warnings of the next table.
    fn warnings_of(&self, next: &Table, limits: &[Limits], arm: &Arm) -> Vec<Notice> {
        let warning = |(number, columns): (usize, &Vec<Vec<f64>>)| {
            let limit = limits.get(number)?.of("torque")?;
            let found = largest(&columns[0]);
            let [of, most] = [found, limit].map(|own| significant(own, 5));
            let joint = arm.pick(String::new(), format!(" of joint {}", number + 1));
            let message = format!("the next torque{joint} = {of}, but limits.torque is {most}");
            let hint = "learn a slower motion: a drive at its limit plays no correction";
            (found > limit).then(|| Notice::new("limit_exceeded", message, hint).worded(arm))
        };
        let joints = next.joints.iter().enumerate();
        joints.filter(|_| self.hold() == Hold::Effort).filter_map(warning).collect()
    }

    /// Prints warnings and the summary.
    fn tell(
        &self,
        (problem, solved): (&Problem, &Solved),
        (summary, inputs): (&LearnSummary, &LearnInputs),
        next: &Table,
        applied: &str,
    ) -> Result<(), Failure> {
        let Specification { arm, limits, .. } = &problem.specification;
        let told = solved.tell();
        let of_step = self.warnings_of(next, limits, arm);
        console::warnings(of_step.iter().cloned());
        let warnings = [solved.warnings(), of_step.clone()].concat();
        let record = || record_json("learn", (arm.title(), inputs), summary, &warnings);
        let output = shown_path(&self.output);
        self.print.print(record, || learn_text(arm, summary, applied, &output))?;
        self.warnings.refuse(told + of_step.len())
    }

    /// The arguments, for the record.
    fn arguments(&self) -> Vec<String> {
        let uncertain = self.uncertain.iter().flat_map(|own| option("--uncertain", own.text()));
        let shift = self.shift.map(|shift_s| option("--shift", shift_s));
        let own = uncertain.chain(option("--play", self.hold().name()));
        [
            self.changes.arguments(),
            own.chain(shift.into_iter().flatten()).collect(),
            self.resample.arguments(),
            self.scale.arguments(),
            digits_arguments(self.digits),
            self.read.arguments(),
        ]
        .concat()
    }
}
