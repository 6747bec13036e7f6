//! `fit`: the measured link or arm.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use clap::Args;

use crate::csv::{InputFile, Reading};
use crate::fit::{
    FitOutcome, Free, LinkFitError, Measurements, Replaced, Specimen, UnfitDrive, fit,
};
use crate::link::{Damping, Joint};
use crate::measured::{MeasuredSet, read_measured};
use crate::page::{FitReport, fit_page};
use crate::spec::{FreeValue, LinkDocument, Override, SpecError, Specification, rewrite};
use crate::store::{
    Fingerprint, FitInputs, NamedBy, NewFile, fit_json, fit_record, foreign_fit_record,
};
use crate::text::shown_path;

use crate::cli::options::common::option;
use crate::cli::options::inputs::{LinkArgs, warn_of_gravity};
use crate::cli::options::reading::tell as tell_reading;
use crate::cli::terminal::files::{keep_inputs, keep_page_apart, read_once};
use crate::cli::terminal::text::fit_text;
use crate::cli::terminal::{Exit, Failure, StageBar, WarningArgs, console};

const EXAMPLE: &str = "\
Example:
  flexlink fit link.toml measured.toml --free hub.inertia
  flexlink fit link.toml m.toml --free hub.inertia --report
  flexlink fit arm.toml m.toml --free links.fore.hub.inertia

measured.toml holds any of
  [[frequency]]            # a natural frequency
  mode = 1
  value = \"2.52 Hz\"
  uncertainty = \"0.02 Hz\"  # optional: for all or none
  hub = \"held\"             # or \"free\", the default
  [[frequency]]            # a zero of the hub angle
  zero = 1
  value = \"4.126 Hz\"
  [[damping]]
  mode = 1
  ratio = 0.013            # or peaks = [1.0, 0.92, 0.85]
  [[decay]]                # after a pluck or a blow
  file = \"pluck.csv\"       # time and a sensor, in any unit
  hub = \"held\"             # or \"free\", the default
  mode = [1, 2]            # default 1
  from = \"0.35 s\"          # after the release
  [[response]]             # per torque or force
  file = \"frf.csv\"         # frequency, real, imaginary
  transfer = \"hub_angle\"   # hub_rate, tip_deflection,
                           # tip_acceleration, root_strain
  per = \"torque\"           # or \"force\", or \"volt\" with [drive]
  gain = \"free\"            # or \"known\", the default: SI
  uncertainty = 0.05       # of each part, relative
  [[record]]               # histories from rest
  file = \"step.csv\"        # time, torque, hub_angle
  input = \"torque\"         # or \"voltage\", \"hub_angle\"
  hold = \"zero\"            # or \"linear\", \"cubic\"
  delay = \"free\"           # of the sensors; or \"known\": 0
  [[record.channel]]
  sensor = \"hub_angle\"     # any transfer of a response
  gain = \"free\"            # or \"sign\", or \"known\"
  offset = \"free\"          # or \"known\", the default: 0
  uncertainty = 0.001      # in the column's unit
  [drive]                  # at the joint; or in the link file
  torque_constant = 0.042  # N m/A
  resistance = 8.4         # ohm
  gear_ratio = 70          # default 1
  pinion_radius = \"50 mm\"  # of a carriage

measured.toml of an arm, in poses
  at = [\"30 deg\", \"75 deg\"]  # of all entries without one
  [[frequency]]
  mode = 3                 # as `modes --at` numbers them
  joints = \"free\"          # the default, or \"held\"
  at = [\"0 deg\", \"90 deg\"] # of each link, inner first
  value = \"8.3 Hz\"
  [[damping]]              # mode, joints, at, ratio
  [[decay]]                # file, mode, joints, at";

/// Fit values of a link or an arm to measured frequencies, damping ratios, responses and records.
///
/// Changes the free values until natural frequencies, zeros, damping ratios, frequency responses and recorded
/// histories fit the measured ones best. The fit minimises the squares of the relative differences, for a record of
/// the differences of its samples, over their uncertainties. Prints each value with its standard error and the
/// factors of its 95 % interval, each measurement beside the value of the fitted link, and the values that the data
/// do not determine. -o writes the link file NAME.toml with the fitted values and all else kept, and its record
/// NAME.json.
///
/// If other values fit about as well, they are printed with a warning, and the 95 % intervals cover them all.
///
/// Without uncertainties the standard errors follow from the remaining differences; with few differences the 95 %
/// intervals are wide, by Student's distribution. If the data do not determine all free values, or do not fit the
/// link, no link file is written, and the exit code is 4.
///
/// An arm of several links is fitted to frequencies and damping ratios of small motions about its shape at rest in poses,
/// bent by its weight, with free joints or held rotors. The modes have the numbers of `modes --at`: with free joints
/// the first ones, one for each link, are swings.
#[derive(Debug, Args)]
#[command(about = "Fit values of a link or an arm to measurements", after_help = EXAMPLE)]
pub(crate) struct Fit {
    #[command(flatten)]
    link: LinkArgs,

    /// Measured values (TOML).
    #[arg(value_name = "MEASURED")]
    measured: PathBuf,

    /// Free a value; PATH as for --set, a `*` frees one common factor. LOW:HIGH bounds the value, with a `*`
    /// the factor [default: a factor of 1000 either way]; repeatable.
    #[arg(long, value_name = "PATH[=LOW:HIGH]", required = true)]
    free: Vec<String>,

    /// Link file NAME.toml to write; its record NAME.json goes beside it [default: none is written].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// If other values fit about as well, write no link file and end with exit code 4.
    #[arg(long)]
    strict: bool,

    /// Write a page that overlays measured and fitted values, even if no link file is written
    /// [default FILE: NAME.html beside the link file NAME.toml of -o, else fit.html].
    #[arg(long, value_name = "FILE")]
    #[expect(clippy::option_option, reason = "an option whose value may be left out")]
    report: Option<Option<PathBuf>>,

    #[command(flatten)]
    warnings: WarningArgs,
}

/// Remedy for the weight of a link on a carriage.
const WEIGHTLESS: &str =
    "fit computes no weight: measure the link across gravity, or compare modes of the fitted link";

/// A link or an arm, its free values, and the measurements to fit.
pub struct Problem {
    link: InputFile,
    /// The link or arm of the file, with the changes of the command line.
    own: Specification,
    document: LinkDocument,
    changes: Vec<Override>,
    free: Vec<(FreeValue, Free)>,
    measured: Measurements,
    pub inputs: FitInputs,
}

/// Manner of reading each file, after its name.
type Readings = Vec<(String, Reading)>;

impl Fit {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let inputs = [&*self.link.link, &*self.measured];
        read_once(&inputs)?;
        self.output.as_deref().map_or(Ok(()), check_output)?;
        self.page().map_or(Ok(()), |page| keep_page_apart(&page, &self.results()))?;
        self.keep(&inputs)?;
        let problem = self.load()?;
        let bar = StageBar::new();
        let mut outcome = problem.fit(&|tried| bar.tried(tried))?;
        if self.strict {
            outcome.refuse_several();
        }
        drop(bar);
        if problem.plays_as_viscous() {
            console::note(
                "records are of the link with its hysteretic ratio as the viscous ratio of each mode",
            );
        }
        let of_gravity =
            problem.own.arm.alone().map_or(0, |link| warn_of_gravity(link, WEIGHTLESS));
        let (replaced, written) = self.write(&problem, &outcome)?;
        let warnings = of_gravity + tell(&problem.own.arm.joint(), &outcome, &replaced, &written)?;
        self.warnings.refuse(warnings)
    }

    /// The link file and its record.
    fn results(&self) -> Vec<PathBuf> {
        let record = self.output.as_deref().and_then(fit_record);
        self.output.iter().cloned().chain(record).collect()
    }

    fn page(&self) -> Option<PathBuf> {
        let beside = || match &self.output {
            Some(output) => output.with_extension("html"),
            None => PathBuf::from("fit.html"),
        };
        self.report.as_ref().map(|file| file.clone().unwrap_or_else(beside))
    }

    /// Refuses outputs that would replace an input.
    fn keep(&self, inputs: &[&Path]) -> Result<(), Failure> {
        let results = self.results();
        results.iter().try_for_each(|file| keep_inputs("--output", file, inputs))?;
        self.page().map_or(Ok(()), |page| keep_inputs("--report", &page, inputs))
    }

    /// The page of a fit.
    fn drawn(&self, problem: &Problem, outcome: &FitOutcome, replaced: &[Replaced]) -> String {
        let written = self.output.as_deref().filter(|_| outcome.misfit.is_none());
        let name = written.and_then(Path::file_name).map(|name| name.to_string_lossy());
        let origin = problem.inputs.origin(problem.own.arm.title());
        fit_page(&FitReport { origin, outcome, replaced, written: name.as_deref() })
    }

    fn arguments(&self) -> Vec<String> {
        let free = self.free.iter().flat_map(|free| option("--free", free));
        self.link.changes.arguments().into_iter().chain(free).collect()
    }

    fn load(&self) -> Result<Problem, Failure> {
        let link = self.link.load()?;
        let changes = self.link.changes.overrides()?;
        let (problem, named, readings) =
            Problem::read(link, changes, &self.free, &self.measured, self.arguments())?;
        let named: Vec<&Path> = named.iter().map(|file| Path::new(&file.shown)).collect();
        self.keep(&named)?;
        for (shown, reading) in &readings {
            tell_reading(shown, reading);
        }
        Ok(problem)
    }

    /// Writes the link file, if the fit is credible, its record and the page, together. Returns the replaced values,
    /// and the line that names the page.
    fn write(
        &self,
        problem: &Problem,
        outcome: &FitOutcome,
    ) -> Result<(Vec<Replaced>, String), Failure> {
        let is_believed = outcome.misfit.is_none();
        let fitted = problem.fitted(outcome);
        let (text, would_replace) = match &self.output {
            Some(_) => fitted?,
            None => fitted.unwrap_or_default(),
        };
        let json = fit_json(&problem.inputs, &would_replace, outcome);
        let replaced = if is_believed { would_replace } else { Vec::new() };
        let html = self.report.as_ref().map(|_| self.drawn(problem, outcome, &replaced));
        let (record, page) = (self.output.as_deref().and_then(fit_record), self.page());
        let is_page_typed = matches!(self.report, Some(Some(_)));
        let page_by = if is_page_typed { NamedBy::User } else { NamedBy::Program };
        let files = [
            (self.output.as_deref().filter(|_| is_believed), Some(&text), NamedBy::User),
            (record.as_deref(), Some(&json), NamedBy::Program),
            (page.as_deref(), html.as_ref(), page_by),
        ];
        let files = files.into_iter().filter_map(|(path, text, named_by)| {
            Some(NewFile { path: path?, bytes: text?.as_bytes(), named_by })
        });
        console::deliver_all(&files.collect::<Vec<_>>())?;
        if let Some(output) = self.output.as_deref().filter(|file| !is_believed && file.exists()) {
            console::note(&format!("{} belongs to another fit", output.display()));
        }
        let written = page.map(|page| format!("written  {}\n", shown_path(&page)));
        Ok((replaced, written.unwrap_or_default()))
    }
}

/// Refuses a link file whose record has no place beside it.
pub fn check_output(output: &Path) -> Result<(), Failure> {
    let (but, hint) = if console::is_standard_output(output) {
        ("must be a file".to_owned(), "name a file: its record is written beside it")
    } else if let Some(record) = foreign_fit_record(output) {
        let but =
            format!("its record {} would replace a file that no fit has written", record.display());
        (but, "use another name for the link file, or for that file")
    } else {
        return Ok(());
    };
    let message = format!("--output = {}, but {but}", output.display());
    Err(Failure::new(Exit::Usage, &message, Some(hint)))
}

impl Problem {
    /// Reads the measured values, and the names of the free values of a link or an arm after the `changes`. Also returns
    /// the further files that the measurements name, and the manner of reading them.
    pub fn read(
        (link, own): (InputFile, Specification),
        changes: Vec<Override>,
        free_texts: &[String],
        measured: &Path,
        arguments: Vec<String>,
    ) -> Result<(Self, Vec<InputFile>, Readings), Failure> {
        let specimen = Specimen::of(own.arm.clone(), &own.meshes);
        let document = LinkDocument::read(&link.shown, link.text()?)?;
        let usage = |error: SpecError| Failure::new(Exit::Usage, &error, error.hint());
        let mut free = Vec::new();
        for text in free_texts {
            let value: FreeValue = text.parse().map_err(usage)?;
            let bounds = document.free(&value, &changes).map_err(usage)?;
            if free.iter().any(|(_, earlier): &(_, Free)| earlier.path == bounds.path) {
                let message = format!("--free {} appears twice", bounds.path);
                return Err(Failure::new(Exit::Usage, &message, Some("leave one of them out")));
            }
            free.push((value, bounds));
        }
        let MeasuredSet { measurements, file, named, readings } =
            read_measured(measured, &specimen)?;
        let [of_link, of_measured] = [&link, &file].map(Fingerprint::of);
        let of_named = named.iter().map(Fingerprint::of).collect();
        let inputs = FitInputs { link: of_link, measured: of_measured, named: of_named, arguments };
        let problem = Self { link, own, document, changes, free, measured: measurements, inputs };
        Ok((problem, named, readings))
    }

    /// Fits the free values; `tried` receives the number of links tried so far.
    pub fn fit(&self, tried: &(dyn Fn(usize) + Sync)) -> Result<FitOutcome, Failure> {
        let free: Vec<Free> = self.free.iter().map(|(_, free)| free.clone()).collect();
        let count = AtomicUsize::new(0);
        let specimen_at = |factors: &[f64]| {
            tried(count.fetch_add(1, Ordering::Relaxed));
            let changes = self.changed(factors)?;
            let own = self.document.specification(&self.link.shown, &changes)?;
            Ok(Specimen::of(own.arm, &own.meshes))
        };
        fit(&self.measured, &free, specimen_at).map_err(|error: LinkFitError<SpecError>| {
            let hint = match &error {
                LinkFitError::Link(error) => error.hint(),
                LinkFitError::Plan(_) | LinkFitError::NoModel => None,
                LinkFitError::Pose(error) => error.hint(),
                LinkFitError::NoMode(_) => Some(self.own.arm.pick(
                    "number the modes from 1, the rigid rotation left out",
                    "number the modes as `flexlink modes --at` does: with free joints the first ones, as many as links, \
                     are swings",
                )),
                LinkFitError::NoVibration(_) => Some(self.own.arm.pick(
                    "`flexlink modes` lists the modes of the link",
                    "`flexlink modes --at` lists the modes of the file's arm",
                )),
                LinkFitError::Distant { .. } => {
                    Some("check its unit, mode, hub or pose, and the units of the link file")
                }
                LinkFitError::Coarse { .. } => Some("measure lower modes"),
                LinkFitError::Drive(UnfitDrive::Elastic) => Some(
                    "a joint's stiffness is fitted to frequencies alone; leave it out for responses and records",
                ),
                LinkFitError::Drive(UnfitDrive::Rotor) => {
                    Some("leave drive.rotor_inertia out, or measure per volt")
                }
                LinkFitError::Drive(UnfitDrive::Losses) => {
                    Some("fit losses to a [[record]], and the [[response]] without them")
                }
                LinkFitError::NoDamping(_) => Some("[damping] with ratio = 0.02 is a start"),
            };
            Failure::new(Exit::InputRefused, &error, hint)
        })
    }

    /// True if a record needs a play of a link with hysteretic damping.
    fn plays_as_viscous(&self) -> bool {
        let damping = self.own.link().damping();
        let is_hysteretic = matches!(damping, Damping::Hysteretic { ratio } if *ratio > 0.0);
        is_hysteretic && !self.measured.records().is_empty()
    }

    /// The changes of the command line, then the factors on the free values.
    fn changed(&self, factors: &[f64]) -> Result<Vec<Override>, SpecError> {
        let free = self.free.iter().zip(factors).map(|((value, _), factor)| value.times(*factor));
        let free: Vec<Override> = free.collect::<Result<_, _>>()?;
        Ok(self.changes.iter().cloned().chain(free).collect())
    }

    /// The link file with the fitted values, and the replaced values.
    pub fn fitted(&self, outcome: &FitOutcome) -> Result<(String, Vec<Replaced>), Failure> {
        let factors: Vec<f64> = outcome.values.iter().map(|value| value.factor).collect();
        let changes = self.changed(&factors)?;
        Ok(rewrite(&self.link.shown, self.link.text()?, &changes)?)
    }
}

/// Prints values, residuals, and the facts that make them credible. Returns the number of warnings.
fn tell(
    joint: &Joint,
    outcome: &FitOutcome,
    replaced: &[Replaced],
    written: &str,
) -> Result<usize, Failure> {
    for undetermined in &outcome.undetermined {
        console::plain(&undetermined.to_string());
    }
    let warnings = outcome.warnings();
    let number = warnings.len();
    console::warnings(warnings);
    if outcome.is_from_other_start {
        console::note("a better fit was found from another start than the file's own values");
    }
    console::print(&(fit_text(joint, outcome, replaced) + written))?;
    match &outcome.misfit {
        None => Ok(number),
        Some(misfit) => Err(Failure::new(Exit::NotSolvable, misfit, Some(&misfit.hint()))),
    }
}
