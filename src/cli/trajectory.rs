//! `trajectory`: a tip motion made from a profile.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use clap::builder::PossibleValuesParser;
use clap::{Args, builder::TypedValueParser};

use super::verify::warn;
use crate::options::inputs::specification;
use crate::terminal::text::{binding_text, found_text};
use crate::terminal::{Exit, Failure, StageBar, WarningArgs, console, memory};
use flexlink::csv::{Digits, InputFile, write_trajectory};
use flexlink::motion::Profile;
use flexlink::result::{FitProblem, OpenMotion, shortest_fit};
use flexlink::spec::{Override, SpecError, Specification};
use flexlink::text::{excerpt, plain, visible};

/// Distances in m and steps in s, within which all samples are numbers and none vanishes.
const DISTANCES_M: RangeInclusive<f64> = 1e-100..=1e100;
const STEPS_S: RangeInclusive<f64> = 1e-90..=1e90;

/// Memory in bytes that a sample takes until it is written.
const BYTES_PER_SAMPLE: usize = 24;

/// Most samples of a trajectory.
const MOST_SAMPLES: f64 = 16_777_216.0;

const EXAMPLE: &str = "\
Example:
  flexlink trajectory septic --distance 0.5 \\
      --duration 0.8 --step 0.001 -o move.csv
  flexlink trajectory s-curve --distance 0.3 \\
      --duration 1 --step 0.001 | flexlink solve link.toml -
  flexlink trajectory septic --distance 0.5 --step 0.001 \\
      --link link.toml --fit-limit torque=2";

/// Make a tip motion from rest to rest.
///
/// Writes a CSV of time and acceleration, to standard output or a file. The samples themselves end at rest
/// and add up to the distance.
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

    /// Travel of the tip along its arc, in m.
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    distance: f64,

    /// Duration of the motion in s, a whole number of steps.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    #[arg(required_unless_present = "fit_limit")]
    duration: Option<f64>,

    /// Find the shortest duration that keeps this limit, torque=5 or 'power="20 W"', and those of the
    /// link file; repeatable. Keys as in [limits]. Every shorter duration is tried; if there are very
    /// many, about a thousand of them, and the message says how many.
    #[arg(long, value_name = "KEY=VALUE", requires = "link", conflicts_with = "duration")]
    fit_limit: Vec<String>,

    /// Link file (TOML) for --fit-limit.
    #[arg(long, value_name = "LINK", requires = "fit_limit")]
    link: Option<PathBuf>,

    /// Step in s.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    step: f64,

    /// Rest before the motion in s, a whole number of steps.
    #[arg(long, value_name = "S", default_value_t = 0.0, allow_negative_numbers = true)]
    rest_before: f64,

    /// Rest after the motion in s, a whole number of steps.
    #[arg(long, value_name = "S", default_value_t = 0.0, allow_negative_numbers = true)]
    rest_after: f64,

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

/// The duration of a motion.
#[derive(Default)]
struct Duration {
    steps: usize,
    /// Comment for the first line of the file.
    comment: String,
    /// Number of warnings that were printed.
    warnings: usize,
}

fn profiles() -> impl TypedValueParser<Value = Profile> {
    let names = Profile::ALL.map(Profile::name);
    let named = |name: String| Profile::ALL.into_iter().find(|profile| profile.name() == name);
    PossibleValuesParser::new(names).map(move |name| named(name).unwrap_or(Profile::Sine))
}

impl Trajectory {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        self.check()?;
        let Duration { steps, comment, warnings } = self.duration()?;
        let before = self.steps("--rest-before", self.rest_before, 0.0)?;
        let after = self.steps("--rest-after", self.rest_after, 0.0)?;
        let bytes = (steps + before + after) * BYTES_PER_SAMPLE;
        memory::check("the trajectory", bytes, None, "use a longer step")?;
        let columns = self.profile.sampled(self.distance, self.step, steps, [before, after]);
        console::deliver_by(self.output.as_deref(), |mut out| {
            out.write_all(comment.as_bytes())?;
            write_trajectory(&mut out, &columns, self.digits)
        })?;
        self.warnings.refuse(warnings)
    }

    /// Returns an error if step or distance is out of range.
    fn check(&self) -> Result<(), Failure> {
        let (step_s, distance_m) = (self.step, self.distance);
        let refuse = |message: String| Err(Failure::new(Exit::Usage, &message, None));
        if !STEPS_S.contains(&step_s) {
            return refuse(format!("--step = {step_s:?} s, but must lie from 1e-90 to 1e90 s"));
        }
        if !DISTANCES_M.contains(&distance_m.abs()) {
            let must = "must lie from 1e-100 to 1e100 m, in either direction";
            return refuse(format!("--distance = {distance_m:?} m, but {must}"));
        }
        Ok(())
    }

    /// The duration of the command line, or the shortest one within the limits.
    fn duration(&self) -> Result<Duration, Failure> {
        if let Some(duration_s) = self.duration {
            let steps = self.steps("--duration", duration_s, 4.0)?;
            return Ok(Duration { steps, ..Duration::default() });
        }
        let changes = self.limits()?;
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
            motion: OpenMotion {
                profile: self.profile,
                distance_m: self.distance,
                step_s: self.step,
            },
        })?;
        drop(stages);
        let product = fit.steps as f64 * self.step;
        // Without the last digits of the product.
        let duration_s: f64 = format!("{product:.14e}").parse().unwrap_or(product);
        let found = format!("{} s, {}", plain(duration_s), found_text(&fit, &limits));
        console::note(&format!("{found}{}", binding_text(&fit)));
        warn(&fit.solution);
        let comment = format!("# {}: {found}\n", self.profile);
        Ok(Duration { steps: fit.steps, comment, warnings: fit.solution.warnings.len() })
    }

    /// The limits of the command line, as changes to the link file.
    fn limits(&self) -> Result<Vec<Override>, Failure> {
        let refused = |error: SpecError| Failure::new(Exit::Usage, &error, error.hint());
        let limit = |text: &String| {
            let place = format!("--fit-limit '{}'", visible(&excerpt(text)));
            if !text.contains('=') {
                let message = format!("{place}: has no `=`, but must read KEY=VALUE");
                let hint = "it reads like torque=5 or 'power=\"20 W\"'";
                return Err(Failure::new(Exit::Usage, &message, Some(hint)));
            }
            Override::placed(&place, &format!("limits.{text}")).map_err(refused)
        };
        self.fit_limit.iter().map(limit).collect()
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
