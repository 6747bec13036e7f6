//! Common inputs of several commands: a link file with its changes, a tip motion, and the reading of a measured table.

use std::path::{Path, PathBuf};

use clap::Args;

use super::common::{finite, hertz, option, quantity};
use super::reading::{ReadArgs, TableName};
use crate::cli::terminal::{Exit, Failure, console};
use crate::csv::{InputFile, MotionTable, Reading, SampleRows, TableFormat, read_motion_table_as};
use crate::link::{Arm, Link};
use crate::motion::{Ends, Motion, MotionError, MotionScale};
use crate::numeric::Dimension;
use crate::spec::{Override, SpecError, Specification, read_specification};
use crate::text::plain;

pub(crate) const LINK: &str = "Link file (TOML)";

pub(crate) const MOTION: &str =
    "Tip trajectory (CSV): `time` and `acceleration`, `displacement`, `angle` or `velocity`";

/// A link file and the changes to it.
#[derive(Debug, Args)]
pub(crate) struct LinkArgs {
    #[arg(value_name = "LINK", help = LINK)]
    pub(crate) link: PathBuf,

    #[command(flatten)]
    pub(crate) changes: ChangeArgs,
}

impl LinkArgs {
    /// Reads the file, one link or an arm of several, and applies the changes.
    pub(crate) fn load(&self) -> Result<(InputFile, Specification), Failure> {
        let file = InputFile::read_toml(&self.link)?;
        let specification = specification(&file, &self.changes.overrides()?)?;
        Ok((file, specification))
    }
}

/// Changes to a link file.
#[derive(Debug, Args)]
pub struct ChangeArgs {
    /// Replace a value of the link file, or multiply it with `*=`; repeatable, applied in order. A segment is
    /// addressed by its name, its number from 0, or `*` for all: 'segments.*.EI*=4',
    /// 'payload.mass="50 g"'.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    changes: Vec<String>,
}

impl ChangeArgs {
    pub(crate) fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// Arguments for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        self.changes.iter().flat_map(|change| option("--set", change)).collect()
    }

    /// The parsed changes.
    pub(crate) fn overrides(&self) -> Result<Vec<Override>, Failure> {
        let overrides: Result<_, SpecError> =
            self.changes.iter().map(|change| change.parse()).collect();
        overrides.map_err(|error| Failure::new(Exit::Usage, &error, error.hint()))
    }
}

/// Reads the content of a file, one link or an arm of several, with some changes.
pub fn specification(file: &InputFile, changes: &[Override]) -> Result<Specification, Failure> {
    read_specification(&file.shown, file.text()?, changes).map_err(|error| {
        let extension = Path::new(&file.name).extension();
        let is_table = extension.is_some_and(|extension| extension == "csv");
        let order = is_table.then_some("LINK, a TOML file, comes before MOTION or TORQUE");
        Failure::new(Exit::InputRefused, &error, file.disguise().or(error.hint()).or(order))
    })
}

/// Refuses a direction of a link on a carriage, which keeps its own.
pub(crate) fn refuse_direction(arm: &Arm) -> Result<(), Failure> {
    if !arm.joint().slides() {
        return Ok(());
    }
    let message = "--at is set, but the direction of a link on a carriage is its start_angle";
    let hint = "leave --at out, and set start_angle beside gravity: --set 'start_angle=\"90 deg\"'";
    Err(Failure::new(Exit::InputRefused, &message, Some(hint)))
}

/// Warns that frequencies exclude gravity, if it acts; returns the number of warnings. `of_carriage` is the remedy for a link
/// on a carriage.
pub(crate) fn warn_of_gravity(link: &Link, of_carriage: &str) -> usize {
    if !link.has_weight() {
        return 0;
    }
    let left_out = "gravity changes natural frequencies and zeros with the link's direction: those here are without it";
    let remedy = if link.joint().slides() {
        of_carriage
    } else {
        "compute those of one direction with modes --at ANGLE"
    };
    console::warning(left_out, &format!("{remedy}; --set 'gravity=[0, 0]' is a horizontal plane"));
    1
}

/// The quality of a trajectory's samples, and its ends.
#[derive(Debug, Args)]
pub struct SampleArgs {
    /// Replace samples that do not follow their neighbours by the values that these predict, and count them.
    #[arg(long)]
    drop_outliers: bool,

    /// Standard deviation of the noise of the samples: a length in m or with its unit, as in "0.1 mm", or an angle with its
    /// unit, as in 0.005deg, for a motion of angles. The tip follows the samples only as closely as the noise allows. The
    /// noise of an arm's angles may be a length, too: that of each link's tip [default: from the decimals of the file].
    #[arg(long, value_name = "VALUE", value_parser = noise, allow_hyphen_values = true)]
    noise: Option<Noise>,

    /// Solve the motion up to this frequency in Hz or with its unit, instead of the frequency that the tip needs.
    #[arg(long, value_name = "HZ", value_parser = positive, allow_hyphen_values = true)]
    lowpass: Option<f64>,

    /// The trajectory is one cycle of a motion that repeats: its first row follows the last one, a step
    /// later.
    #[arg(long, conflicts_with = "noise")]
    periodic: bool,

    /// The tip moves before the first row and after the last one, at constant velocity. A velocity column implies
    /// this option.
    #[arg(long, conflicts_with_all = ["noise", "periodic"])]
    moving_ends: bool,
}

/// A failure of a file in the words of the joint and the output. The name of the file stays.
pub(crate) fn worded(failure: Failure, file: &InputFile, arm: &Arm) -> Failure {
    let (name, rest) = match failure.message.strip_prefix(&file.shown) {
        Some(rest) => (&*file.shown, rest),
        None => ("", &*failure.message),
    };
    let message = name.to_owned() + &arm.worded(rest);
    let hint = failure.hint.map(|hint| arm.worded(&hint));
    Failure { message, hint, ..failure }
}

/// The wanted motion, the rows of its samples, and the deviations of its table from the standard form.
#[derive(Debug, Clone)]
pub struct Wanted {
    pub motion: Motion,
    pub rows: SampleRows,
    pub reading: Reading,
}

impl Wanted {
    /// The motion over another distance and duration.
    pub fn scaled(&self, scale: MotionScale) -> Result<Self, MotionError> {
        let (rows, reading) = (self.rows.clone(), self.reading.clone());
        Ok(Self { motion: self.motion.scaled(scale)?, rows, reading })
    }

    /// The same for a case of a sweep, which an error refuses.
    pub fn of_case(&self, scale: MotionScale) -> Result<Self, Failure> {
        self.scaled(scale).map_err(|error| Failure::new(Exit::InputRefused, &error, error.hint()))
    }
}

/// True if a file is the same motion of both arms, whose links may differ: angles are arcs of one link's length, and its
/// start angle is that of a motion in angles.
pub fn are_read_alike(one: &Arm, other: &Arm) -> bool {
    let read_by = |arm: &Arm| (arm.lengths_m(), arm.links()[0].link.gravity().copied());
    read_by(one) == read_by(other)
}

/// Options that make a motion of a file or of arrays.
#[derive(Debug, Args)]
pub struct MotionArgs {
    #[command(flatten)]
    pub read: ReadArgs,

    #[command(flatten)]
    pub samples: SampleArgs,

    #[command(flatten)]
    pub scale: ScaleArgs,
}

impl MotionArgs {
    /// The options for the table of the motion.
    pub fn format(&self) -> TableFormat {
        let read = self.read.format(TableName::Motion, TableName::Motion);
        TableFormat { drop_outliers: self.samples.drop_outliers, ..read }
    }

    /// Arguments for the record.
    pub fn arguments(&self) -> Vec<String> {
        [self.read.arguments(), self.samples.arguments(), self.scale.arguments()].concat()
    }

    /// Reads the motion of an arm.
    pub fn motion_of(&self, file: &InputFile, arm: &Arm) -> Result<Wanted, Failure> {
        let (lengths_m, format) = (arm.lengths_m(), self.format());
        let table = read_motion_table_as(&file.shown, &file.bytes, &lengths_m, &format);
        let table = table.map_err(|error| {
            let failure = worded(error.into(), file, arm);
            // Places turn about a hub; a carriage has none.
            let is_turned = arm.joint().slides() && failure.message.contains(" x and y ");
            let hint = "write the motion as displacement: a link on a carriage does not turn";
            let hint = is_turned.then(|| hint.to_owned()).or(failure.hint);
            Failure { hint, ..failure }
        })?;
        self.motion_in(table, Some(arm)).map_err(|failure| worded(failure, file, arm))
    }

    /// The motion of a table; without an arm, of a link without gravity.
    pub fn motion_in(&self, table: MotionTable, arm: Option<&Arm>) -> Result<Wanted, Failure> {
        let link = arm.and_then(|arm| arm.links().first()).map(|own| &own.link);
        let table = match link {
            Some(link) => table.of_link(link)?,
            None => table,
        };
        let SampleArgs { noise, lowpass, .. } = &self.samples;
        let ends = self.samples.ends();
        let table = table.with_ends(ends);
        let table = match self.format().resample_s {
            Some(_) if ends == Ends::Periodic => {
                let message = "--resample stands beside --periodic, but a cycle keeps its own step";
                return Err(Failure::new(Exit::Usage, &message, None));
            }
            Some(step_s) => table.resampled(step_s)?,
            None => table,
        };
        let table = match noise {
            Some(Noise { deviation, is_angle: true, .. }) => {
                let length_m = arm.map_or(1.0, |arm| arm.lengths_m()[0]);
                table.with_angle_noise(*deviation, length_m)?
            }
            Some(Noise { deviation, .. }) => table.with_noise(*deviation)?,
            None => table,
        };
        let table = match lowpass {
            Some(hertz) => table.with_lowpass(*hertz),
            None => table,
        };
        let (rows, reading) = (table.rows().clone(), table.reading().clone());
        Ok(Wanted { motion: table.into_motion()?, rows, reading })
    }
}

/// A standard deviation above 0 as written, in m or in rad.
#[derive(Debug, Clone)]
struct Noise {
    text: String,
    deviation: f64,
    is_angle: bool,
}

fn noise(text: &str) -> Result<Noise, String> {
    let length = quantity(text, Dimension::LENGTH);
    let angle = quantity(text, Dimension::NONE);
    let (deviation, is_angle) = match (length, angle) {
        (Ok(metres), _) => (metres, false),
        (Err(_), Ok(radians)) => (radians, true),
        (Err(error), Err(_)) => return Err(error),
    };
    if deviation > 0.0 {
        Ok(Noise { text: text.to_owned(), deviation, is_angle })
    } else {
        Err("must be a length or an angle above 0".into())
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let above_zero = hertz(text).ok().filter(|number| *number > 0.0);
    above_zero.ok_or_else(|| "must be a frequency above 0".into())
}

impl SampleArgs {
    /// Arguments for the record.
    pub fn arguments(&self) -> Vec<String> {
        let dropped = self.drop_outliers.then(|| vec!["--drop-outliers".to_owned()]);
        let noise = self.noise.as_ref().map(|noise| option("--noise", &noise.text));
        let lowpass = self.lowpass.map(|hertz| option("--lowpass", hertz));
        let ends = match self.ends() {
            Ends::AtRest => None,
            Ends::Moving => Some(vec!["--moving-ends".to_owned()]),
            Ends::Periodic => Some(vec!["--periodic".to_owned()]),
        };
        [dropped, noise, lowpass, ends].into_iter().flatten().flatten().collect()
    }

    fn ends(&self) -> Ends {
        match (self.periodic, self.moving_ends) {
            (true, _) => Ends::Periodic,
            (_, true) => Ends::Moving,
            _ => Ends::AtRest,
        }
    }
}

/// Factors on a motion, as those of a sweep.
#[derive(Debug, Args)]
pub struct ScaleArgs {
    /// Multiply the motion's travel; an arm's path keeps its start.
    #[arg(long, value_name = "FACTOR", value_parser = finite, allow_negative_numbers = true)]
    #[arg(default_value_t = 1.0, hide_default_value = true)]
    scale_distance: f64,

    /// Multiply the motion's duration, from its first sample on.
    #[arg(long, value_name = "FACTOR", value_parser = finite, allow_negative_numbers = true)]
    #[arg(default_value_t = 1.0, hide_default_value = true)]
    scale_duration: f64,
}

impl ScaleArgs {
    pub fn scale(&self) -> MotionScale {
        MotionScale { distance: self.scale_distance, duration: self.scale_duration }
    }

    /// Applies these factors to a motion.
    pub fn scaled(&self, wanted: &Wanted) -> Result<Wanted, Failure> {
        wanted.scaled(self.scale()).map_err(|error| {
            let message = format!("{}: {error}", scale_arguments(self.scale()).join(" "));
            Failure::new(Exit::Usage, &message, error.hint())
        })
    }

    /// Arguments for the record.
    pub fn arguments(&self) -> Vec<String> {
        scale_arguments(self.scale())
    }
}

/// Arguments for the record that scale a motion by these factors.
pub fn scale_arguments(scale: MotionScale) -> Vec<String> {
    let MotionScale { distance, duration } = scale;
    let factors = [("--scale-distance", distance), ("--scale-duration", duration)];
    let others = factors.into_iter().filter(|(_, factor)| factor.total_cmp(&1.0).is_ne());
    others.flat_map(|(name, factor)| option(name, plain(factor))).collect()
}
