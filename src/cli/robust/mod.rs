//! `robust`: a command on plants that differ from the model.

mod help;
mod plants;

use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::csv::{Digits, InputFile};
use crate::inverse::{Analysis, Solution};
use crate::link::{Arm, ArmLink, Damping};
use crate::model::KeptModes;
use crate::motion::{Shaper, Shaping};
use crate::numeric::{Dimension, parse_quantity};
use crate::page::{Figures, page};
use crate::response::SimulationError;
use crate::result::{Limits, Notice};
use crate::robust::{
    Command, Distribution, Histories, Hold, Plant, PlantError, PlantKind, PlantTip, PlayErrors,
    Quantiles, RobustSummary, Robustness, Sample, Study, Thinned,
};
use crate::spec::{Override, Specification, Uncertain};
use crate::store::{Fingerprint, REPORT, RobustFiles, RobustInputs, StoredResult, robust_json};
use crate::text::{given, shown_path, significant};

pub use self::plants::Plants;

use super::problem::Problem;
use super::simulate::refusal;
use crate::cli::options::common::{SyncArgs, digits_arguments, option};
use crate::cli::options::inputs::{ChangeArgs, LINK, MOTION, MotionArgs};
use crate::cli::options::play::{Gains, gains, gains_of_joints};
use crate::cli::options::reading::TableName;
use crate::cli::terminal::files::{keep, read_once};
use crate::cli::terminal::text::robust_text;
use crate::cli::terminal::{Exit, Failure, PrintArgs, ThreadArgs, WarningArgs, console, memory};

const EXAMPLE: &str = "\
Example:
  flexlink robust link.toml motion.csv \\
      --uncertain 'segments.*.EI*=±5%' \\
      --uncertain 'payload.mass=±20 g'
  flexlink robust link.toml motion.csv --play position \\
      --uncertain 'segments.*.EI*=±10%' --allow '1 mm'
  flexlink robust arm.toml path.csv --feedback 50,1 \\
      --uncertain 'links.*.segments.*.EI*=±10%' --runs 200";

/// Quantity that the drives hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Holds {
    /// The positions of the joints.
    Position,
    /// Torques and forces.
    #[value(aliases = ["torque", "force"])]
    Effort,
    /// Torques and forces with feedback around the positions.
    Feedback,
}

/// A distribution of the sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Distributed {
    Uniform,
    Normal,
}

/// Command of the drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Played {
    /// The answer of solve.
    Inverse,
    /// The answer for rigid links.
    Rigid,
    /// The rigid answer, shaped by ZV for the lowest mode that rings.
    Zv,
    /// Shaped by ZVD.
    Zvd,
    /// Shaped by EI.
    Ei,
    /// Shaped by the two-hump EI shaper.
    #[value(name = "2hump")]
    TwoHump,
}

impl From<Distributed> for Distribution {
    fn from(own: Distributed) -> Self {
        match own {
            Distributed::Uniform => Self::Uniform,
            Distributed::Normal => Self::Normal,
        }
    }
}

impl Played {
    /// Its name as an option's value.
    fn name(self) -> &'static str {
        match self {
            Self::Inverse => "inverse",
            Self::Rigid => "rigid",
            shaped => shaped.shaping().map_or("", Shaping::name),
        }
    }

    /// The shaper of a command of rigid links.
    fn shaping(self) -> Option<Shaping> {
        match self {
            Self::Inverse | Self::Rigid => None,
            Self::Zv => Some(Shaping::Zv),
            Self::Zvd => Some(Shaping::Zvd),
            Self::Ei => Some(Shaping::Ei),
            Self::TwoHump => Some(Shaping::TwoHump),
        }
    }
}

/// A share of the travel, or a length in m.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Amount {
    Share(f64),
    Metres(f64),
}

/// Compute how far the tip strays if the link differs from its file.
///
/// Plays the torque of solve, or its motion of the joints, on plants whose values differ within intervals: each key
/// alone, all corners, and a seeded sample. Prints the worst error of the tip, the remaining vibration and drift,
/// quantiles over the sample, and the share of each key in the error.
///
/// Tip error is the largest distance of the tip from the wanted motion, up to one period after its end. Rest
/// vibration is half the range of the error over this period, drift its mean. The period is that of the lowest mode
/// that rings: of the held joint with --play position, of the free one with --play effort, on the gains of feedback.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Robust {
    #[arg(value_name = "LINK", help = LINK)]
    link: PathBuf,

    #[arg(value_name = "MOTION", help = MOTION)]
    motion: PathBuf,

    #[command(flatten)]
    options: RobustOptions,

    /// Fail with exit code 4 if the tip error exceeds --allow, or a plant a limit of the link file; all files
    /// are written.
    #[arg(long)]
    strict: bool,

    /// Record of a fit, NAME.json beside the fitted LINK: its values vary with their covariance.
    #[arg(long, value_name = "FIT")]
    from: Option<PathBuf>,

    /// Folder for the results.
    #[arg(short, long, value_name = "DIR", default_value = "robust")]
    output: PathBuf,

    /// Also write report.html, the page that `flexlink report` makes.
    #[arg(long)]
    report: bool,

    #[command(flatten)]
    sync: SyncArgs,

    #[command(flatten)]
    print: PrintArgs,

    #[command(flatten)]
    warnings: WarningArgs,

    #[command(flatten)]
    threads: ThreadArgs,
}

/// The options that shape a study beside its files; a run records them.
#[derive(Debug, Args)]
pub struct RobustOptions {
    #[command(flatten)]
    changes: ChangeArgs,

    /// Interval of a value: KEY=±SHARE%, KEY=±AMOUNT, KEY=LOW..HIGH, or KEY*=LOW..HIGH for factors;
    /// repeatable [default: [uncertainty] of the link file]. KEY is a path as in --set; delay is that of
    /// position drives.
    #[arg(long, value_name = "KEY=INTERVAL")]
    uncertain: Vec<Uncertain>,

    /// Quantity that the drives hold [default: effort, with --feedback feedback].
    #[arg(long = "play", value_name = "WHAT")]
    holds: Option<Holds>,

    /// Gains of each joint's feedback around its motion in solve, KP in N m/rad (N/m) and KD in
    /// N m s/rad (N s/m), as in simulate.
    #[arg(long, value_name = "KP,KD", value_parser = gains, allow_hyphen_values = true)]
    feedback: Option<Gains>,

    /// Command of the drives: the answer of solve, or for comparison that of rigid links, as it is or shaped by zv, zvd,
    /// ei or 2hump for the lowest mode that rings.
    #[arg(long = "command", value_name = "WHAT", default_value = "inverse")]
    played: Played,

    /// Number of plants in the sample.
    #[arg(long, value_name = "N", default_value_t = 1000)]
    runs: usize,

    /// Seed of the sample.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Distribution of the sample in its intervals; normal: 95 % of the values.
    #[arg(long, value_name = "WHAT", default_value = "uniform")]
    distribution: Distributed,

    /// Band of the settling time: a share of the travel, or a length.
    #[arg(long, value_name = "AMOUNT", value_parser = amount, default_value = "1%")]
    band: Amount,

    /// Largest tip error that 95 % of the drawn plants may have: a share of the travel, or a length. Beyond it a warning,
    /// with --strict exit code 4. Where fewer than 100 are drawn, the worst tip error of all counts.
    #[arg(long, value_name = "AMOUNT", value_parser = amount, allow_hyphen_values = true)]
    allow: Option<Amount>,

    /// Digits: the last one is 10^-N of a column's peak, or `full`.
    #[arg(long, value_name = "N", default_value = "10")]
    pub digits: Digits,

    #[command(flatten)]
    pub motion: MotionArgs,
}

fn amount(text: &str) -> Result<Amount, String> {
    let must = || "must be a share such as 1% or a length such as 2 mm, above 0".to_owned();
    let above_zero = |number: f64| (number > 0.0 && number.is_finite()).then_some(number);
    let amount = if let Some(share) = text.trim().strip_suffix('%') {
        let share = share.trim().parse().ok().and_then(above_zero);
        share.map(|share| Amount::Share(0.01 * share))
    } else {
        let metres = parse_quantity(text, Dimension::LENGTH).ok();
        metres.and_then(above_zero).map(Amount::Metres)
    };
    amount.ok_or_else(must)
}

impl fmt::Display for Amount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Share(share) => write!(f, "{}%", given(100.0 * share)),
            Self::Metres(metres) => write!(f, "{} m", given(*metres)),
        }
    }
}

impl Amount {
    fn metres(self, travel_m: f64) -> f64 {
        match self {
            Self::Share(share) => share * travel_m,
            Self::Metres(metres) => metres,
        }
    }
}

/// The plays of a study.
struct Plays {
    /// Thinned samples, for all plants.
    quick: Command,
    /// All samples, for checks.
    whole: Command,
    band_m: f64,
    least_s: f64,
    common_m: f64,
}

impl Robust {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        let files = [&self.link, &self.motion].into_iter().chain(&self.from);
        let files: Vec<&Path> = files.map(PathBuf::as_path).collect();
        read_once(&files)?;
        keep(&self.output, &files)?;
        let file = InputFile::read_toml(&self.link)?;
        let fit = self.from.as_deref().map(InputFile::read).transpose()?;
        let options = &self.options;
        let changes = options.changes.overrides()?;
        let (plants, specification) = options.plants((&file, changes), fit.as_ref())?;
        let motion = InputFile::read(&self.motion)?;
        let problem = Problem::read((&file, specification), &motion, &options.motion)?;
        let stages = self.print.stages();
        let solved = problem.solve(Analysis::clone, memory::available(), &stages)?;
        stages.at("playing plants");
        let studied = options.study((&problem, &solved.solution), &plants)?;
        drop(stages);
        let told = solved.tell();
        console::warnings(studied.warnings.iter().cloned());
        let inputs = RobustInputs {
            link: Some(Fingerprint::of(&file)),
            motion: Some(Fingerprint::of(&motion)),
            fit: fit.as_ref().map(Fingerprint::of),
            arguments: options.arguments(),
        };
        let record = studied.record(&inputs, solved.warnings());
        let files = studied.files(&record, options.digits);
        let page = self.report.then(|| drawn(&files)).transpose()?;
        files.write(self.sync.stage(&self.output)?, page.as_deref())?;
        let kinds: Vec<PlantKind> = studied.outcome.plants.iter().map(|own| own.kind).collect();
        let written = || self.written();
        let (arm, summary) = (&problem.specification.arm, &studied.summary);
        self.print.print(|| record.clone(), || robust_text(arm, summary, &kinds, written()))?;
        self.judge(summary)?;
        self.warnings.refuse(told + studied.warnings.len())
    }

    /// The written files in words.
    fn written(&self) -> String {
        let folder = format!("3 files in {}", shown_path(&self.output));
        let page = || format!("\n{:9}{}", "", shown_path(&self.output.join(REPORT)));
        folder + &self.report.then(page).unwrap_or_default()
    }

    /// Ends with exit code 4 under --strict if the tip error exceeds --allow, or a limit is exceeded.
    fn judge(&self, summary: &RobustSummary) -> Result<(), Failure> {
        if !self.strict {
            return Ok(());
        }
        let beyond = self.options.beyond(summary);
        if beyond.is_some() {
            let message = "--strict: the tip error exceeds --allow; all files are written";
            return Err(Failure::new(Exit::NotSolvable, &message, None));
        }
        if summary.over_limits.iter().any(|own| own.share > 0.0) {
            let message = "--strict: drawn plants exceed a limit; all files are written";
            return Err(Failure::new(Exit::NotSolvable, &message, None));
        }
        Ok(())
    }
}

/// A study that is done.
pub struct Studied {
    arm: Arm,
    /// All plants.
    pub outcome: Robustness,
    /// Its numbers.
    pub summary: RobustSummary,
    /// Times of the envelope in s.
    pub times_s: Vec<f64>,
    /// Its warnings beside those of the solution.
    pub warnings: Vec<Notice>,
}

impl Studied {
    /// The content of summary.json, with these inputs and the warnings of the solution.
    pub fn record(&self, inputs: &RobustInputs, of_solution: Vec<Notice>) -> String {
        let warnings = [of_solution, self.warnings.clone()].concat();
        robust_json(&self.arm, inputs, &self.summary, &warnings)
    }

    /// The files of the study, with its record.
    pub fn files(&self, record: &str, digits: Digits) -> RobustFiles {
        RobustFiles::of((record, &self.summary), (&self.outcome, &self.times_s), digits)
    }
}

impl RobustOptions {
    /// The plants of a link file with changes, and the specification of the file.
    pub fn plants(
        &self,
        link: (&InputFile, Vec<Override>),
        fit: Option<&InputFile>,
    ) -> Result<(Plants, Specification), Failure> {
        self.motion.read.check(&[TableName::Motion])?;
        Plants::of(link, (&self.uncertain, fit), self.hold())
    }

    /// Plays the command of a solution on all plants.
    pub fn study(
        &self,
        (problem, solution): (&Problem, &Solution),
        plants: &Plants,
    ) -> Result<Studied, Failure> {
        let plays = self.plays(problem, solution)?;
        let distribution = self.distribution.into();
        let fitted = plants.fitted.clone();
        let sample = Sample { runs: self.runs, seed: self.seed, distribution, fitted };
        let outcome = plays.study(problem, plants, &sample)?;
        let errors = plays.errors(&outcome, plants)?;
        let help = self.help(problem, solution, &outcome, plants);
        let summary = RobustSummary::of(
            &outcome,
            &plays.quick,
            (self.played.name(), self.feedback.clone().unwrap_or_default()),
            (sample, plays.band_m),
            (errors, help),
        );
        let times = 0..outcome.envelope_m[0].len();
        Ok(Studied {
            arm: problem.specification.arm.clone(),
            times_s: times.map(|k| plays.quick.time_s(k)).collect(),
            warnings: self.warnings_of((&outcome, &summary), &problem.specification.limits),
            outcome,
            summary,
        })
    }

    fn hold(&self) -> Hold {
        match (self.holds, &self.feedback) {
            (Some(Holds::Position), _) => Hold::Position,
            (Some(Holds::Feedback), _) | (None, Some(_)) => Hold::Feedback,
            (Some(Holds::Effort), _) | (None, None) => Hold::Effort,
        }
    }

    /// Histories of the command, and its end in s.
    fn histories(
        &self,
        problem: &Problem,
        solution: &Solution,
        hold: Hold,
    ) -> Result<(Histories, f64), Failure> {
        let histories = Histories::of(solution, self.played != Played::Inverse);
        let end_s = solution.grid.time_s(solution.moving.1);
        let Some(shaping) = self.played.shaping() else { return Ok((histories, end_s)) };
        let Specification { arm, meshes, .. } = &problem.specification;
        let how = (hold, &self.gains(arm)?[..], Thinned::Yes);
        let command = problem.command(solution, (&histories, end_s), how)?;
        let nominal = command.plant((arm, meshes), (0.0, 1.0, end_s), &[]);
        let rings = nominal.map_err(|error| not_played(&error, arm))?.rings;
        let shaper = rings
            .and_then(|own| Shaper::new(shaping, own.omega_rad_s(), own.ratio))
            .ok_or_else(|| {
                let message = format!("--command = {shaping}, but no mode of the link rings");
                Failure::new(Exit::NotSolvable, &message, None)
            })?;
        Ok((histories.shaped(&shaper), end_s + shaper.duration_s()))
    }

    /// Both commands of this study, less the common error of the exact inverse.
    fn plays(&self, problem: &Problem, solution: &Solution) -> Result<Plays, Failure> {
        let Specification { arm, meshes, limits, .. } = &problem.specification;
        let gains = self.gains(arm)?;
        let not_played = |error| not_played(&error, arm);
        let (histories, end_s) = self.histories(problem, solution, self.hold())?;
        let command = |thinned| {
            let how = (self.hold(), &gains[..], thinned);
            problem.command(solution, (&histories, end_s), how)
        };
        // The acceleration of thinned positions, of which efforts depend, has less digits than the positions.
        let is_limited = limits.iter().any(|own| *own != Limits::default());
        let exact = self.hold() == Hold::Position && is_limited;
        let quick = command(if exact { Thinned::No } else { Thinned::Yes })?
            .refined(arm, meshes)
            .map_err(not_played)?;
        let whole = command(Thinned::No)?;
        let band_m = self.band.metres(quick.travel_m);
        // With the limits of all plants, so that its own error is exactly 0.
        let nominal = quick.plant((arm, meshes), (0.0, band_m, quick.end_s), limits);
        let PlantTip { strays, error_m, .. } = nominal.map_err(not_played)?;
        let least_s = quick.time_s(error_m[0].len() - 1);
        if !self.takes_off(&problem.specification) {
            return Ok(Plays { quick, whole, band_m, least_s, common_m: 0.0 });
        }
        let checked = whole.checked((arm, meshes), (0.0, band_m), strays.period_s);
        let checked = checked.map_err(not_played)?;
        let (quick, whole) = (quick.less(error_m), whole.less(checked.error_m));
        Ok(Plays { quick, whole, band_m, least_s, common_m: checked.strays.tip_error_m })
    }

    /// True if the error of the nominal plant is that of its law of damping alone, which is no error of the link.
    fn takes_off(&self, Specification { arm, analysis, .. }: &Specification) -> bool {
        let is_hysteretic =
            |own: &ArmLink| matches!(own.link.damping(), Damping::Hysteretic { .. });
        self.played == Played::Inverse
            && arm.links().iter().any(is_hysteretic)
            && analysis.kept_modes() == KeptModes::All
    }

    /// Warnings of the study.
    fn warnings_of(
        &self,
        (outcome, summary): (&Robustness, &RobustSummary),
        limits: &[Limits],
    ) -> Vec<Notice> {
        let mut warnings = Vec::new();
        let is_known = |key: &str| summary.over_limits.iter().any(|own| own.key == key);
        let unknown = limits.iter().flat_map(|own| own.keys().filter(|key| !is_known(key)));
        let unknown: BTreeSet<&str> = unknown.filter(|_| self.runs > 0).collect();
        for key in unknown {
            let message = format!("limits.{key} is not compared: plays do not have its value");
            let hint = "`flexlink solve` compares it on the link of the file";
            warnings.push(Notice::new("limit_not_played", message, hint));
        }
        for key in outcome.idle_keys() {
            let message = format!("{} changes nothing in these plays", key.name());
            let hint = "leave it out, or play what it acts on: --play position, effort or feedback";
            warnings.push(Notice::new("key_without_effect", message, hint));
        }
        if self.played == Played::Inverse && summary.errors.common_m > summary.worst_m() {
            let message = "the error of damping that is taken off exceeds the worst tip error";
            let hint = "state how the link is damped in time: damping = { model = \"rayleigh\", beta = … }";
            warnings.push(Notice::new("damping_differs", message, hint));
        }
        if summary.is_coarse() {
            let share = summary.errors.play_m / summary.worst_m();
            let message = format!("the plays are off by {share:.1e} of the worst tip error");
            let hint = "use a finer step of the motion, or mesh.elements";
            warnings.push(Notice::new("coarse_plays", message, hint));
        }
        if let Some((what, found, allowed)) = self.beyond(summary) {
            let [found, allowed] = [found, allowed].map(|own| significant(own, 4));
            let message = format!("{what} = {found} m, but --allow is {allowed} m");
            warnings.push(Notice::new(
                "not_robust",
                message,
                "know the first key better, or use another command that helps",
            ));
        }
        warnings
    }

    /// The 95 % quantile of the tip error, or its worst where the sample is too small for it, and the allowed error in m, if it
    /// exceeds it.
    fn beyond(&self, summary: &RobustSummary) -> Option<(&'static str, f64, f64)> {
        let allowed_m = self.allow?.metres(summary.travel_m);
        let (what, found_m) = match summary.quantiles {
            Some([Quantiles { p95_m: (p95_m, Some(_)), .. }, ..]) => {
                ("the 95 % quantile of the tip error", p95_m)
            }
            _ => ("the worst tip error", summary.worst_m()),
        };
        (found_m > allowed_m).then_some((what, found_m, allowed_m))
    }

    /// The arguments, for the record.
    pub fn arguments(&self) -> Vec<String> {
        let uncertain = self.uncertain.iter().flat_map(|own| option("--uncertain", own.text()));
        let gains = self.feedback.iter().flat_map(|pairs| {
            let pairs: Vec<String> = pairs.iter().map(|(kp, kd)| format!("{kp},{kd}")).collect();
            option("--feedback", pairs.join(","))
        });
        let own = uncertain
            .chain(option("--play", self.hold().name()))
            .chain(gains)
            .chain(option("--command", self.played.name()))
            .chain(option("--runs", self.runs))
            .chain(option("--seed", self.seed))
            .chain(option("--band", self.band))
            .chain(self.allow.into_iter().flat_map(|allow| option("--allow", allow)));
        let normal =
            (self.distribution == Distributed::Normal).then(|| option("--distribution", "normal"));
        let own = own.chain(normal.into_iter().flatten()).collect();
        [self.changes.arguments(), own, self.motion.arguments(), digits_arguments(self.digits)]
            .concat()
    }

    /// A pair of gains for each joint.
    fn gains(&self, arm: &Arm) -> Result<Gains, Failure> {
        let refuse = |message: &str| Err(Failure::new(Exit::Usage, &message, None));
        match (&self.feedback, self.hold()) {
            (None, Hold::Feedback) => refuse("--play feedback needs --feedback KP,KD"),
            (Some(_), Hold::Position | Hold::Effort) => {
                refuse("--feedback is for --play feedback, but --play holds something else")
            }
            (None, _) => Ok(Vec::new()),
            (Some(gains), _) => gains_of_joints(gains, arm),
        }
    }
}

/// The page of a study, from its files.
fn drawn(files: &RobustFiles) -> Result<String, Failure> {
    let study = StoredResult::Robust(vec![files.stored()?]);
    Ok(page(&study, &Figures::of(&study)))
}

pub(in crate::cli) fn not_played(error: &SimulationError, arm: &Arm) -> Failure {
    let (message, hint) = refusal(error, arm);
    Failure::new(Exit::NotSolvable, &message, hint.as_deref())
}

impl Plays {
    /// Plays all plants.
    fn study(
        &self,
        problem: &Problem,
        plants: &Plants,
        sample: &Sample,
    ) -> Result<Robustness, Failure> {
        let limits = &problem.specification.limits;
        let play = |values: &[Option<f64>]| -> Result<PlantTip, PlantError<Failure>> {
            let own = plants.with(values).map_err(PlantError::Refused)?;
            let Self { quick, band_m, least_s, .. } = self;
            let how = (plants.delay_s(values), *band_m, *least_s);
            let played = quick.plant((&own.arm, &own.meshes), how, limits);
            played.map_err(|error| PlantError::Failed(not_played(&error, &own.arm)))
        };
        let travel_m = self.quick.travel_m;
        Study { keys: &plants.keys, sample, travel_m, play }.run()
    }

    /// The change of the tip errors of the nominal and the worst plant in a whole simulation.
    fn errors(&self, outcome: &Robustness, plants: &Plants) -> Result<PlayErrors, Failure> {
        let mut play_m: f64 = 0.0;
        // The nominal plant under the exact inverse is that whose error is taken off.
        let first = usize::from(self.common_m > 0.0);
        for at in &[0, outcome.worst[0]][first..] {
            let Plant { values, strays, .. } = &outcome.plants[*at];
            let own = plants.with(values)?;
            let how = (plants.delay_s(values), self.band_m);
            let checked = self.whole.checked((&own.arm, &own.meshes), how, strays.period_s);
            let checked = checked.map_err(|error| not_played(&error, &own.arm))?;
            play_m = play_m.max((checked.strays.tip_error_m - strays.tip_error_m).abs());
        }
        Ok(PlayErrors { common_m: self.common_m, play_m })
    }
}
