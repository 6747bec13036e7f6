//! `trajectory`: a tip motion, or the path of an arm's tip, made from a profile.

mod path;

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use clap::builder::PossibleValuesParser;
use clap::{Args, builder::TypedValueParser};

use self::path::{PathArgs, Travel, reached, refused, seconds, travel};
use super::verify::warn;
use crate::options::inputs::{ChangeArgs, described, specification};
use crate::terminal::text::{binding_text, found_text};
use crate::terminal::{Exit, Failure, StageBar, WarningArgs, console, memory};
use flexlink::csv::{Digits, InputFile, write_path, write_trajectory};
use flexlink::motion::{Curve, MotionColumns, PathColumns, Profile};
use flexlink::result::{
    ArmFitProblem, ArmMetrics, Fit, FitProblem, LimitedValue, Metrics, OpenMotion,
    shortest_arm_fit, shortest_fit,
};
use flexlink::spec::{ArmSpecification, Described, Override, SpecError, Specification};
use flexlink::text::{excerpt, plain, visible};

/// Distances in m and steps in s, within which all samples are numbers and none vanishes.
const DISTANCES_M: RangeInclusive<f64> = 1e-100..=1e100;
const STEPS_S: RangeInclusive<f64> = 1e-90..=1e90;

/// Memory in bytes that a sample takes until it is written; that of a path, which is read back, with its text.
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
  flexlink trajectory septic --path line --from 0.9,-0.5 \\
      --to 0.5,0.8 --duration 1.5 --step 0.001 \\
      --link arm.toml -o path.csv
  flexlink trajectory septic --path arc --from '0.7 m,0' \\
      --center 0,0 --angle '90 deg' \\
      --duration 2 --step 0.001";

/// Make a tip motion, or the path of an arm's tip, from rest to rest.
///
/// Writes a CSV of time and acceleration, to standard output or a file. The samples themselves end at rest
/// and add up to the distance. With --path, the CSV has time, x and y, and the profile is the law of the
/// length that the tip has gone.
///
/// Profiles: sine (one period of a sine acceleration), versine (harmonic, with jumps of the acceleration at
/// both ends), min-jerk (fifth degree), septic (seventh degree, the smoothest of the polynomials),
/// trapezoid (a third of the time accelerating, a third at speed), s-curve (the same with limited jerk),
/// bang-bang, gaussian (bell of velocity).
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Trajectory {
    /// Shape of the motion.
    #[arg(value_name = "PROFILE", value_parser = profiles())]
    profile: Profile,

    /// Travel of the tip along its arc, in m or with its unit, '65.8 cm'; or the angle by which the link of --link
    /// turns, '90 deg'.
    #[arg(long, value_name = "TRAVEL", value_parser = travel, allow_hyphen_values = true)]
    #[arg(required_unless_present = "path")]
    distance: Option<Travel>,

    /// Duration of the motion in s or with its unit, '800 ms', a whole number of steps.
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_hyphen_values = true)]
    #[arg(required_unless_present = "fit_limit")]
    duration: Option<f64>,

    /// Find the shortest duration that keeps this limit, torque=5 or 'power="20 W"', and those of the
    /// link file; repeatable. Keys as in [limits]; with --path of all joints, or of one, fore.torque=5. Every
    /// shorter duration is tried; if there are very many, about a thousand of them, and the message says how
    /// many.
    #[arg(long, value_name = "KEY=VALUE", requires = "link", conflicts_with = "duration")]
    fit_limit: Vec<String>,

    /// Link file (TOML) for --fit-limit, and for the length of a link that turns by an angle. With --path, that of an
    /// arm: a path that it does not reach is refused.
    #[arg(long, value_name = "LINK")]
    pub(crate) link: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) changes: ChangeArgs,

    /// Step in s or with its unit.
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_hyphen_values = true)]
    step: f64,

    /// Rest before the motion in s or with its unit, a whole number of steps.
    #[arg(long, value_name = "TIME", value_parser = seconds, default_value = "0", allow_hyphen_values = true)]
    rest_before: f64,

    /// Rest after the motion in s or with its unit, a whole number of steps.
    #[arg(long, value_name = "TIME", value_parser = seconds, default_value = "0", allow_hyphen_values = true)]
    rest_after: f64,

    /// File to write [default: standard output].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Digits: the last one is 10^-N of the peak, or `full` for the shortest text that reads back
    /// to the same number.
    #[arg(long, value_name = "N", default_value = "full")]
    digits: Digits,

    #[command(flatten)]
    pub(crate) path: PathArgs,

    #[command(flatten)]
    warnings: WarningArgs,
}

/// The duration of a motion.
#[derive(Default)]
pub(crate) struct Duration {
    steps: usize,
    /// Comment for the first line of the file.
    comment: String,
    /// Number of warnings that were printed.
    warnings: usize,
}

/// What limits are of.
#[derive(Debug, Clone, Copy)]
enum Limited {
    Link,
    Arm,
}

fn profiles() -> impl TypedValueParser<Value = Profile> {
    let names = Profile::ALL.map(Profile::name);
    let named = |name: String| Profile::ALL.into_iter().find(|profile| profile.name() == name);
    PossibleValuesParser::new(names).map(move |name| named(name).unwrap_or(Profile::Sine))
}

impl Trajectory {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        self.check_step()?;
        self.check_file()?;
        match self.path.curve()? {
            Some(curve) => self.write_path(&curve),
            None => self.write_motion(),
        }
    }

    /// The motion of a link's tip, and how its duration was found.
    pub(crate) fn motion(&self) -> Result<(MotionColumns, Duration), Failure> {
        let distance_m = self.distance_m()?;
        let duration = self.duration(distance_m)?;
        let rest = self.rests(duration.steps, BYTES_PER_SAMPLE)?;
        Ok((self.profile.sampled(distance_m, self.step, duration.steps, rest), duration))
    }

    /// The path of an arm's tip along a curve, and how its duration was found.
    pub(crate) fn path_along(
        &self,
        curve: &Curve,
        arm: Option<&ArmSpecification>,
    ) -> Result<(PathColumns, Duration), Failure> {
        let duration = self.duration_along(curve, arm)?;
        let rest = self.rests(duration.steps, BYTES_PER_PLACE)?;
        let places = curve.sampled(self.profile, duration.steps, rest);
        let places = places.map_err(|error| refused(&error, error.hint()))?;
        Ok((PathColumns::of_tip(self.step, &places, self.path.outer_rad()), duration))
    }

    /// Writes the motion of a link's tip.
    fn write_motion(&self) -> Result<(), Failure> {
        let (columns, Duration { comment, warnings, .. }) = self.motion()?;
        console::deliver_by(self.output.as_deref(), |mut out| {
            out.write_all(comment.as_bytes())?;
            write_trajectory(&mut out, &columns, self.digits)
        })?;
        self.warnings.refuse(warnings)
    }

    /// Writes the path of an arm's tip along a curve, unless the arm does not reach it.
    fn write_path(&self, curve: &Curve) -> Result<(), Failure> {
        let arm = self.link.as_deref().map(|link| self.arm(link)).transpose()?;
        let (columns, Duration { comment, warnings, .. }) =
            self.path_along(curve, arm.as_deref())?;
        let mut text = comment.into_bytes();
        write_path(&mut text, &columns, self.digits)
            .map_err(|cause| Failure::new(Exit::CannotWrite, &cause, None))?;
        // The warnings of a solved path have this one among them.
        let warned = match &arm {
            Some(arm) if self.fit_limit.is_empty() => reached(&text, arm)?,
            _ => warnings,
        };
        console::deliver(self.output.as_deref(), &text)?;
        self.warnings.refuse(warned)
    }

    /// Steps of rest before and after.
    fn rests(&self, steps: usize, bytes_per_sample: usize) -> Result<[usize; 2], Failure> {
        let before = self.steps("--rest-before", self.rest_before, 0.0)?;
        let after = self.steps("--rest-after", self.rest_after, 0.0)?;
        let bytes = (steps + before + after) * bytes_per_sample;
        memory::check("the trajectory", bytes, None, "use a longer step")?;
        Ok([before, after])
    }

    /// Returns an error if the step is out of range.
    pub(crate) fn check_step(&self) -> Result<(), Failure> {
        let step_s = self.step;
        if STEPS_S.contains(&step_s) {
            return Ok(());
        }
        let message = format!("--step = {step_s:?} s, but must lie from 1e-90 to 1e90 s");
        Err(Failure::new(Exit::Usage, &message, None))
    }

    /// Returns an error if a file or changes to it are given that nothing is made of.
    fn check_file(&self) -> Result<(), Failure> {
        let turns = matches!(self.distance, Some(Travel::Angle(_)));
        let is_used = !self.fit_limit.is_empty() || self.path.is_given() || turns;
        let (option, needs) = match (&self.link, self.changes.is_empty()) {
            (Some(_), _) if !is_used => {
                ("--link", "--fit-limit, --path, or an angle as --distance")
            }
            (None, false) => ("--set", "--link, the file that it changes"),
            _ => return Ok(()),
        };
        let message = format!("{option} is given, but has an effect only with {needs}");
        Err(Failure::new(Exit::Usage, &message, None))
    }

    /// The distance, if it is in range; the parser has seen to it that it is given.
    fn distance_m(&self) -> Result<f64, Failure> {
        let distance_m = match (self.distance, &self.link) {
            (None, _) => 0.0,
            (Some(Travel::Length(length_m)), _) => length_m,
            (Some(Travel::Angle(angle_rad)), Some(link)) => {
                let file = InputFile::read_toml(link)?;
                angle_rad * specification(&file, &self.limits(Limited::Link)?)?.link.length_m()
            }
            (Some(Travel::Angle(angle_rad)), None) => {
                let angle = plain(angle_rad);
                let message = format!(
                    "--distance = {angle} rad, but must be a length unless --link is given"
                );
                let hint = "--link LINK gives the length of the link that turns";
                return Err(Failure::new(Exit::Usage, &message, Some(hint)));
            }
        };
        if DISTANCES_M.contains(&distance_m.abs()) {
            return Ok(distance_m);
        }
        let must = "must lie from 1e-100 to 1e100 m, in either direction";
        let message = format!("--distance = {distance_m:?} m, but {must}");
        Err(Failure::new(Exit::Usage, &message, None))
    }

    /// The arm of a file, with the limits of the command line.
    pub(crate) fn arm(&self, link: &Path) -> Result<Box<ArmSpecification>, Failure> {
        let file = InputFile::read_toml(link)?;
        match described(&file, &self.limits(Limited::Arm)?)? {
            Described::Arm(arm) => Ok(arm),
            Described::Link(_) => {
                let message = format!(
                    "--link = {}, a file of one link, but must be that of an arm with --path",
                    file.shown
                );
                let hint = "--distance makes the motion of one link's tip";
                Err(Failure::new(Exit::InputRefused, &message, Some(hint)))
            }
        }
    }

    /// The duration of the command line, or the shortest one within the limits.
    fn duration(&self, distance_m: f64) -> Result<Duration, Failure> {
        if let Some(duration_s) = self.duration {
            let steps = self.steps("--duration", duration_s, 4.0)?;
            return Ok(Duration { steps, ..Duration::default() });
        }
        let changes = self.limits(Limited::Link)?;
        let file = InputFile::read_toml(self.link.as_deref().unwrap_or(Path::new("-")))?;
        let Specification { link, mesh, analysis, limits, .. } = specification(&file, &changes)?;
        let stages = StageBar::new();
        stages.at("trying durations");
        let fit = shortest_fit(&FitProblem {
            link: &link,
            plan: &mesh,
            analysis: &analysis,
            memory_bytes: memory::available(),
            limits: &limits,
            motion: OpenMotion { profile: self.profile, distance_m, step_s: self.step },
        })?;
        drop(stages);
        let values = limits.limited_values(&Metrics::of(&fit.solution)).into_iter();
        let found = self.told(&fit, values.map(|value| (None, value)));
        warn(&fit.solution);
        Ok(Duration { warnings: fit.solution.warnings.len(), ..found })
    }

    /// The duration of the command line, or the shortest one of a path within the limits of an arm's joints.
    fn duration_along(
        &self,
        curve: &Curve,
        arm: Option<&ArmSpecification>,
    ) -> Result<Duration, Failure> {
        let (Some(arm), None) = (arm, self.duration) else {
            let steps = self.steps("--duration", self.duration.unwrap_or_default(), 4.0)?;
            return Ok(Duration { steps, ..Duration::default() });
        };
        let stages = StageBar::new();
        stages.at("trying durations");
        let fit = shortest_arm_fit(&ArmFitProblem {
            arm: &arm.arm,
            plans: &arm.meshes,
            analysis: &arm.analysis,
            memory_bytes: memory::available(),
            limits: &arm.limits,
            curve,
            profile: self.profile,
            step_s: self.step,
            outer_rad: self.path.outer_rad(),
        })?;
        drop(stages);
        let values = ArmMetrics::of(&fit.solution).limited(&arm.limits).into_iter();
        let found = self.told(&fit, values.map(|(joint, value)| (Some(joint), value)));
        let warnings = &fit.solution.warnings;
        console::warnings(warnings.iter().map(|warning| (warning, warning.hint())));
        Ok(Duration { warnings: warnings.len(), ..found })
    }

    /// Tells the duration that was found, and which of the limits binds.
    fn told<S>(
        &self,
        fit: &Fit<S>,
        values: impl IntoIterator<Item = (Option<usize>, LimitedValue)>,
    ) -> Duration {
        let product = fit.steps as f64 * self.step;
        // Without the last digits of the product.
        let duration_s: f64 = format!("{product:.14e}").parse().unwrap_or(product);
        let found = format!("{} s, {}", plain(duration_s), found_text(fit, values));
        console::note(&format!("{found}{}", binding_text(fit)));
        let comment = format!("# {}: {found}\n", self.profile);
        Duration { steps: fit.steps, comment, warnings: 0 }
    }

    /// The changes and the limits of the command line, as changes to the file of a link or of an arm.
    fn limits(&self, of: Limited) -> Result<Vec<Override>, Failure> {
        let refused = |error: SpecError| Failure::new(Exit::Usage, &error, error.hint());
        let limit = |text: &String| {
            let place = format!("--fit-limit '{}'", visible(&excerpt(text)));
            let Some((key, value)) = text.split_once('=') else {
                let message = format!("{place}: has no `=`, but must read KEY=VALUE");
                let hint = "it reads like torque=5 or 'power=\"20 W\"'";
                return Err(Failure::new(Exit::Usage, &message, Some(hint)));
            };
            let change = match (of, key.rsplit_once('.')) {
                (Limited::Link, _) => format!("limits.{text}"),
                (Limited::Arm, None) => format!("links.*.limits.{text}"),
                (Limited::Arm, Some((link, key))) => format!("links.{link}.limits.{key}={value}"),
            };
            Override::placed(&place, &change).map_err(refused)
        };
        let limits = self.fit_limit.iter().map(limit).collect::<Result<Vec<_>, _>>()?;
        Ok([self.changes.overrides()?, limits].concat())
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
