//! `trajectory`: a tip motion, or the path of an arm's tip, from a profile.

mod found;
mod path;
mod shape;

use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::OnceLock;

use clap::Args;

pub use self::found::Found;
use self::found::{Choice, Limited, Search, limits, not_made, profiles};
use self::path::{PathArgs, Travel, reached, refused, travel};
use self::shape::ShapeArgs;
use crate::cli::options::common::seconds;
use crate::cli::options::inputs::{ChangeArgs, specification};
use crate::cli::robust::Plants;
use crate::cli::terminal::{Exit, Failure, WarningArgs, console, memory};
use crate::csv::{Digits, InputFile, write_path, write_trajectory};
use crate::motion::{Course, Curve, MotionColumns, PathColumns};
use crate::result::Along;
use crate::robust::Hold;
use crate::spec::Specification;
use crate::text::{given, plain};

/// Distances in m and steps in s that keep all samples finite and not 0.
const DISTANCES_M: RangeInclusive<f64> = 1e-100..=1e100;
const STEPS_S: RangeInclusive<f64> = 1e-90..=1e90;

/// Memory in bytes of a sample until it is written. A path, which is read back, also needs its text.
const BYTES_PER_SAMPLE: usize = 24;
const BYTES_PER_PLACE: usize = 250;

/// Most samples of a trajectory.
const MOST_SAMPLES: f64 = 16_777_216.0;

const EXAMPLE: &str = "\
Example:
  flexlink trajectory septic --distance 0.5 \\
      --duration 0.8 --step 0.001 -o move.csv
  flexlink trajectory s-curve --distance 0.3 \\
      --duration 1 --step 0.001 | flexlink solve link.toml -
  flexlink trajectory septic --distance 0.5 --step 0.001 \\
      --link link.toml --fit-limit torque=2
  flexlink trajectory septic --distance '90 deg' \\
      --link link.toml --duration '800 ms' --step '1 ms'
  flexlink trajectory min-jerk --distance 0.2 --step 0.001 \\
      --duration 0.44 --link link.toml --shape zv --of held
  flexlink trajectory min-jerk --distance 0.2 --step 0.001 \\
      --link link.toml --quiet-at held --fit-limit torque=2
  flexlink trajectory septic --path line --from 0.9,-0.5 \\
      --to 0.5,0.8 --duration 1.5 --step 0.001 \\
      --link arm.toml -o path.csv
  flexlink trajectory septic --path arc --from '0.7 m,0' \\
      --center 0,0 --angle '90 deg' \\
      --duration 2 --step 0.001
  flexlink trajectory septic --path line --from 0.5,-0.9 \\
      --to 1.9,-0.6 --carriage 0,0.8 \\
      --duration 1.5 --step 0.002";

/// Make a tip motion, or the path of an arm's tip, from rest to rest.
///
/// Writes a CSV of time and acceleration, to standard output or a file. The samples end at rest exactly and add up to
/// the travel. With --path, the CSV has time, x and y, and the profile is the law of the travel along the path; with
/// --carriage also the place of the arm's carriage.
///
/// The torque of `solve` leaves the link at rest. If its stiffness is off by some percent, the link rings: as strongly as
/// the motion excites its modes. --shape and --quiet-at make motions that excite them little, and print how long the
/// torque starts before the motion and ends after it. Shaped motions are written as time and displacement. The modes of
/// an arm, or of a link that turns under gravity, change along the way: the middle of their range counts, and the largest
/// remainder on the way is printed.
///
/// Profiles: sine (one period of a sine acceleration), versine (harmonic, with jumps of the acceleration at
/// both ends), min-jerk (fifth degree), septic (seventh degree, the smoothest of the polynomials),
/// trapezoid (a third of the time accelerating, a third at speed), s-curve (the same with limited jerk),
/// bang-bang, gaussian (bell of velocity); best (with --link: the profile of the shortest motion without a warning or
/// a jump of the acceleration; the durations of all profiles are printed).
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub struct Trajectory {
    /// Shape of the motion.
    #[arg(value_name = "PROFILE", value_parser = profiles())]
    profile: Choice,

    /// Travel of the tip along its arc, in m or with its unit, '65.8 cm'; or the angle by which the link of --link
    /// turns, '90 deg'.
    #[arg(long, value_name = "TRAVEL", value_parser = travel, allow_hyphen_values = true)]
    #[arg(required_unless_present = "path")]
    distance: Option<Travel>,

    /// Duration of the motion in s or with its unit, '800 ms', a whole number of steps; of all moves together,
    /// without the rests between them [default: the shortest within the limits of --link].
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_hyphen_values = true)]
    duration: Option<f64>,

    /// Limit beside those of the link file, torque=5, force=5000 or 'power="20 W"', or in place of the one with the same key;
    /// repeatable. Finds the shortest duration that keeps all limits. Keys as in [limits]; with --path for all
    /// joints, or for one, fore.torque=5, or for the carriage, force=200 or carriage.power=500. Tries every shorter
    /// duration or, if there are very many, about a thousand, and prints how many.
    #[arg(long, value_name = "KEY=VALUE", requires = "link", conflicts_with = "duration")]
    fit_limit: Vec<String>,

    /// Link file (TOML) for --fit-limit, and for the length of a link that turns by an angle. With --path, an arm
    /// file: a path out of its reach is refused.
    #[arg(long, value_name = "LINK")]
    pub link: Option<PathBuf>,

    /// The file of --link, once it is read: standard input can be read only once.
    #[arg(skip)]
    link_file: OnceLock<InputFile>,

    #[command(flatten)]
    pub changes: ChangeArgs,

    /// Step in s or with its unit.
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_hyphen_values = true)]
    step: f64,

    /// Rest before the motion in s or with its unit, a whole number of steps.
    #[arg(long, value_name = "TIME", value_parser = seconds, default_value = "0", allow_hyphen_values = true)]
    rest_before: f64,

    /// Rest after the motion in s or with its unit, a whole number of steps.
    #[arg(long, value_name = "TIME", value_parser = seconds, default_value = "0", allow_hyphen_values = true)]
    rest_after: f64,

    #[command(flatten)]
    shape: ShapeArgs,

    #[command(flatten)]
    pub path: PathArgs,

    /// Rest at each --via, in s or with its unit, a whole number of steps; with --cycle also at both ends.
    #[arg(long, value_name = "TIME", value_parser = seconds, default_value = "0", allow_hyphen_values = true)]
    dwell: f64,

    /// Make one cycle of a motion that repeats, for `solve --periodic`: out, --dwell, back through the same places,
    /// --dwell. --duration is that of the outward motion. With --link, the cycle is solved, and its torque printed.
    #[arg(long, conflicts_with_all = ["path", "rest_before", "rest_after"])]
    cycle: bool,

    /// File to write [default: standard output].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Digits: the last one is 10^-N of the peak, or `full` for the shortest text that reads back
    /// to the same number.
    #[arg(long, value_name = "N", default_value = "full")]
    digits: Digits,

    #[command(flatten)]
    warnings: WarningArgs,
}

impl Trajectory {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match self.curve()? {
            Some(curve) => self.write_path(&curve),
            None => self.write_motion(),
        }
    }

    /// The command with the content of the file of --link.
    #[must_use]
    pub fn of_link(self, file: InputFile) -> Self {
        Self { link_file: OnceLock::from(file), ..self }
    }

    /// The motion of a link's tip, with its profile and duration.
    pub fn motion(&self) -> Result<(MotionColumns, Found), Failure> {
        let link = self.specification(Limited::Link)?;
        let course = self.course(link.as_ref())?;
        let along = Along::Arc(&course);
        let found = self.search(along, link.as_ref())?.found(along, link.as_ref())?;
        let rest = self.rests(&found, BYTES_PER_SAMPLE)?;
        let columns = course.sampled(&found.law, self.step, found.steps, rest);
        Ok((columns.map_err(|error| not_made(&error))?, found))
    }

    /// The path of an arm's tip along a curve, with its profile and duration.
    pub fn path_along(
        &self,
        curve: &Curve,
        arm: Option<&Specification>,
    ) -> Result<(PathColumns, Found), Failure> {
        let along = Along::Curve(curve, self.path.outer_rad());
        let found = self.search(along, arm)?.found(along, arm)?;
        let rest = self.rests(&found, BYTES_PER_PLACE)?;
        let (steps, outer_rad) = ((self.step, found.steps), self.path.outer_rad());
        let columns = curve.columns(&found.law, steps, rest, outer_rad);
        Ok((columns.map_err(|error| refused(&error, error.hint()))?, found))
    }

    /// The open and the fixed values of the motion.
    fn search(&self, along: Along, own: Option<&Specification>) -> Result<Search, Failure> {
        let steps = self.duration.map(|duration_s| self.steps("--duration", duration_s, 4.0));
        let (profile, step_s) = (self.profile, self.step);
        let shape = self.shape.shape(own, along, &self.plants()?)?;
        if let Some(shape) = &shape {
            shape.check_step(step_s)?;
        }
        Ok(Search { profile, steps: steps.transpose()?, step_s, shape })
    }

    /// The file of --link; `None` without it.
    fn link_file(&self) -> Result<Option<&InputFile>, Failure> {
        if let (None, Some(link)) = (self.link_file.get(), &self.link) {
            let file = InputFile::read_toml(link)?;
            return Ok(Some(self.link_file.get_or_init(|| file)));
        }
        Ok(self.link_file.get())
    }

    /// The links or arms at the ends and corners of the intervals of --quiet-at.
    fn plants(&self) -> Result<Vec<Specification>, Failure> {
        let Some(file) = self.link_file()?.filter(|_| self.shape.is_quiet()) else {
            return Ok(Vec::new());
        };
        let own = (file, self.changes.overrides()?);
        let (plants, _) = Plants::of_any(own, (self.shape.uncertain(), None), Hold::Position)?;
        plants.ends().iter().map(|values| plants.with(values)).collect()
    }

    /// The curve of --path; `None` without it. Checks the options that every motion has.
    pub fn curve(&self) -> Result<Option<Curve>, Failure> {
        self.check_step()?;
        self.check_use()?;
        let curve = self.path.curve()?;
        let dwell = self.steps("--dwell", self.dwell, 0.0)?;
        Ok(curve.map(|curve| curve.with_dwell(dwell)))
    }

    /// Writes the motion of a link's tip.
    fn write_motion(&self) -> Result<(), Failure> {
        let (columns, found) = self.motion()?;
        found.tell();
        console::deliver_by(self.output.as_deref(), |mut out| {
            out.write_all(found.comment.as_bytes())?;
            write_trajectory(&mut out, &columns, self.digits)
        })?;
        self.warnings.refuse(found.warnings.len())
    }

    /// Writes the path of an arm's tip along a curve, unless it is out of the arm's reach.
    fn write_path(&self, curve: &Curve) -> Result<(), Failure> {
        let arm = self.arm()?;
        let (columns, found) = self.path_along(curve, arm.as_ref())?;
        found.tell();
        let mut text = found.comment.into_bytes();
        write_path(&mut text, &columns, self.digits)
            .map_err(|cause| Failure::new(Exit::CannotWrite, &cause, None))?;
        // The warnings of a solved path include this one.
        let warned = match &arm {
            Some(arm) if self.duration.is_some() && !self.shape.is_given() => reached(&text, arm)?,
            _ => found.warnings.len(),
        };
        console::deliver(self.output.as_deref(), &text)?;
        self.warnings.refuse(warned)
    }

    /// Steps of rest before and after.
    fn rests(&self, found: &Found, bytes_per_sample: usize) -> Result<[usize; 2], Failure> {
        let before = self.steps("--rest-before", self.rest_before, 0.0)?;
        let after = self.steps("--rest-after", self.rest_after, 0.0)?;
        let stops = self.path.travels().count() + usize::from(self.cycle);
        let dwell = self.steps("--dwell", self.dwell, 0.0)?;
        let way = found.steps + stops * dwell + (stops + 1) * found.law.more_steps();
        let ways = if self.cycle { 2 } else { 1 };
        let bytes = (ways * way + before + after) * bytes_per_sample;
        memory::check("the trajectory", bytes, None, "use a longer step")?;
        Ok([before, after])
    }

    /// Returns an error if the step is out of range.
    fn check_step(&self) -> Result<(), Failure> {
        let step_s = self.step;
        if STEPS_S.contains(&step_s) {
            return Ok(());
        }
        let message = format!("--step = {step_s:?} s, but must lie from 1e-90 to 1e90 s");
        Err(Failure::new(Exit::Usage, &message, None))
    }

    /// Returns an error for a missing option, or for an option whose effect needs a missing one.
    fn check_use(&self) -> Result<(), Failure> {
        self.check_duration()?;
        let turns = self.travels().any(|(_, travel)| matches!(travel, Travel::Angle(_)));
        let is_searched = self.duration.is_none() || matches!(self.profile, Choice::Best);
        let is_shaped = self.shape.is_given();
        let uses_link = is_searched || is_shaped || self.path.is_given() || turns || self.cycle;
        let stops = self.cycle || self.path.stops();
        let (option, needs) = if let Some(option) = self.path.without_path() {
            (option, "--path")
        } else if let Some(idle) = self.shape.idle() {
            idle
        } else if self.link.is_some() && !uses_link {
            (
                "--link",
                "--path, --cycle, --shape, an angle as --distance or --via, or without --duration",
            )
        } else if self.link.is_none() && !self.changes.is_empty() {
            ("--set", "--link, the file that it changes")
        } else if self.shape.is_quiet() && self.path.stops() {
            ("--quiet-at", "one move, without --via, or with --corner on a path")
        } else if self.dwell != 0.0 && !stops {
            ("--dwell", "--cycle, or with --via where the tip stops")
        } else {
            return Ok(());
        };
        let message = format!("{option} has an effect only with {needs}");
        Err(Failure::new(Exit::Usage, &message, None))
    }

    /// Returns an error without a duration, unless a link has limits that decide.
    fn check_duration(&self) -> Result<(), Failure> {
        let message = match (&self.duration, &self.link, self.profile) {
            (None, None, Choice::Best) => "PROFILE = best, but needs --link",
            (None, None, _) => "--duration is missing: without --link nothing limits the motion",
            _ => return Ok(()),
        };
        let hint = "--link LINK finds the shortest motion within the limits of the link file and of --fit-limit";
        Err(Failure::new(Exit::Usage, &message, Some(hint)))
    }

    /// The link or the arm of --link, with the limits of the command line; `None` without it.
    fn specification(&self, of: Limited) -> Result<Option<Specification>, Failure> {
        let Some(file) = self.link_file()? else { return Ok(None) };
        // Reads the file first without the limits, because a link has their keys elsewhere than an arm.
        let own = specification(file, &self.changes.overrides()?)?;
        let refused = match (of, &own.lines[..]) {
            (Limited::Link, [_, second, ..]) => {
                let line = second.map(|line| format!(":{line}")).unwrap_or_default();
                let why = "one link is needed here, but the file has several";
                let hint = "`flexlink solve` takes arms of several links";
                Some((format!("{}{line}: {why}", file.shown), hint))
            }
            (Limited::Arm, [_]) => {
                let why = "a file of one link, but must be a file of an arm with --path";
                let hint = "--distance makes the motion of one link's tip";
                Some((format!("--link = {}, {why}", file.shown), hint))
            }
            _ => None,
        };
        match refused {
            Some((message, hint)) => Err(Failure::new(Exit::InputRefused, &message, Some(hint))),
            None if self.fit_limit.is_empty() => Ok(Some(own)),
            None => specification(file, &limits(&self.changes, &self.fit_limit, of)?).map(Some),
        }
    }

    /// The arm of --link, with the limits of the command line; `None` without it.
    pub fn arm(&self) -> Result<Option<Specification>, Failure> {
        self.specification(Limited::Arm)
    }

    /// Travels of --via and --distance, with their options.
    fn travels(&self) -> impl Iterator<Item = (&'static str, Travel)> {
        let stops = self.path.travels().map(|travel| ("--via", travel));
        stops.chain(self.distance.map(|travel| ("--distance", travel)))
    }

    /// Course of a link's tip.
    fn course(&self, specification: Option<&Specification>) -> Result<Course, Failure> {
        let stop_m = |(option, travel)| displacement_m(option, travel, specification);
        let stops_m = self.travels().map(stop_m).collect::<Result<Vec<_>, _>>()?;
        let before = [0.0].iter().chain(&stops_m);
        for ((option, _), (from_m, to_m)) in self.travels().zip(before.zip(&stops_m)) {
            if (to_m - from_m).abs() < *DISTANCES_M.start() {
                let (from, to) = (plain(*from_m), plain(*to_m));
                let must = format!("but must differ from {from} m, the place before it");
                return Err(Failure::new(Exit::Usage, &format!("{option} = {to} m, {must}"), None));
            }
        }
        let dwell = self.steps("--dwell", self.dwell, 0.0)?;
        let course = Course::through(stops_m, dwell).map_err(|error| not_made(&error))?;
        Ok(if self.cycle { course.there_and_back() } else { course })
    }

    /// A time in whole steps.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the number is checked to be whole, positive and small"
    )]
    fn steps(&self, option: &str, time_s: f64, least: f64) -> Result<usize, Failure> {
        let steps = time_s / self.step;
        let whole = steps.round();
        let is_whole = (steps - whole).abs() <= 1e-6 * whole.max(1.0);
        if is_whole && (least..=MOST_SAMPLES).contains(&whole) {
            return Ok(whole as usize);
        }
        let [time, step] = [time_s, self.step].map(plain);
        let must = format!("a whole number of steps of {step} s, {least} to {MOST_SAMPLES}");
        let message = format!("{option} = {time} s, but must be {must}");
        Err(Failure::new(Exit::Usage, &message, None))
    }
}

/// The displacement of a stop in m, if it is in range.
fn displacement_m(
    option: &str,
    travel: Travel,
    specification: Option<&Specification>,
) -> Result<f64, Failure> {
    let distance_m = match (travel, specification) {
        (Travel::Length(length_m), _) => length_m,
        (Travel::Angle(angle_rad), Some(own)) if own.link().joint().slides() => {
            let angle = given(angle_rad);
            let message = format!("{option} = {angle} rad, but must be a length on a carriage");
            return Err(Failure::new(Exit::Usage, &message, None));
        }
        (Travel::Angle(angle_rad), Some(own)) => angle_rad * own.link().rigid_tip(),
        (Travel::Angle(angle_rad), None) => {
            let angle = given(angle_rad);
            let message = format!("{option} = {angle} rad, but must be a length without --link");
            let hint = "name the link that turns: --link LINK";
            return Err(Failure::new(Exit::Usage, &message, Some(hint)));
        }
        (Travel::Place(_), _) => {
            let message =
                format!("{option} = x and y, but must be the travel of the tip without --path");
            return Err(Failure::new(Exit::Usage, &message, None));
        }
    };
    // The start may be a stop, and the end of a motion with stops.
    if DISTANCES_M.contains(&distance_m.abs()) || distance_m == 0.0 {
        return Ok(distance_m);
    }
    let must = "must lie from 1e-100 to 1e100 m, in either direction";
    let message = format!("{option} = {distance_m:?} m, but {must}");
    Err(Failure::new(Exit::Usage, &message, None))
}
