//! End of the program: exit codes, and their assignment to errors of the library.

use clap::Args;

use crate::csv::{InputError, TableError};
use crate::inverse::InversionError;
use crate::link::ParameterError;
use crate::measured::MeasuredError;
use crate::modal::DampingError;
use crate::model::ModelError;
use crate::motion::CurveError;
use crate::response::{PoseError, SimulationError};
use crate::result::{FitError, TargetError};
use crate::spec::SpecError;
use crate::store::FolderError;
use crate::verify::VerificationError;

/// Exit code after completed work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    Done = 0,
    /// The compared results differ.
    Different = 1,
}

/// Exit code after a failure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// The command line is wrong.
    Usage = 2,
    /// An input file is invalid.
    InputRefused = 3,
    /// Link and motion are valid, but without an answer.
    NotSolvable = 4,
    /// The results cannot be written.
    CannotWrite = 5,
    /// Ctrl-C or the system stopped the program in order; the number that shells use for Ctrl-C.
    Interrupted = 130,
}

/// Reason for an end without completed work.
#[derive(Debug)]
pub struct Failure {
    pub exit: Exit,
    pub message: String,
    pub hint: Option<String>,
    /// True if the work needs more memory than allowed.
    pub is_of_memory: bool,
}

impl Failure {
    pub fn new(exit: Exit, message: &impl ToString, hint: Option<&str>) -> Self {
        let hint = hint.map(str::to_owned);
        Self { exit, message: message.to_string(), hint, is_of_memory: false }
    }

    /// The failure with the name of its file before the message.
    #[must_use]
    pub fn placed(self, file: &str) -> Self {
        Self { message: format!("{file}: {}", self.message), ..self }
    }
}

/// How a run with warnings ends.
#[derive(Debug, Args)]
pub struct WarningArgs {
    #[arg(long, help = "Fail with exit code 4 if there is a warning; all output is written")]
    deny_warnings: bool,
}

impl WarningArgs {
    /// True if warnings are an error.
    pub(crate) fn are_denied(&self) -> bool {
        self.deny_warnings
    }

    /// Returns an error for printed warnings if they are denied. Call it after all output.
    pub(crate) fn refuse(&self, warnings: usize) -> Result<(), Failure> {
        if warnings == 0 || !self.deny_warnings {
            return Ok(());
        }
        let must = "but must be none; all output is written";
        let message = format!("--deny-warnings: warnings = {warnings}, {must}");
        Err(Failure::new(Exit::NotSolvable, &message, None))
    }
}

/// Failures with the text and the hint of an error.
macro_rules! failures {
    ($($error:ty => $exit:ident,)*) => {$(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::new(Exit::$exit, &error, error.hint())
            }
        }
    )*};
}

failures! {
    InputError => InputRefused,
    SpecError => InputRefused,
    MeasuredError => InputRefused,
    TableError => InputRefused,
    PoseError => NotSolvable,
    TargetError => NotSolvable,
    FolderError => CannotWrite,
}

impl From<InversionError> for Failure {
    fn from(error: InversionError) -> Self {
        let is_of_memory = matches!(error, InversionError::TooMuchMemory { .. });
        let exit = if error.is_of_input() { Exit::InputRefused } else { Exit::NotSolvable };
        Self { is_of_memory, ..Self::new(exit, &error, error.hint()) }
    }
}

impl From<SimulationError> for Failure {
    fn from(error: SimulationError) -> Self {
        let is_of_memory = matches!(error, SimulationError::TooMuchMemory { .. });
        let is_of_input = matches!(error, SimulationError::NoStartAngle);
        let exit = if is_of_input { Exit::InputRefused } else { Exit::NotSolvable };
        Self { is_of_memory, ..Self::new(exit, &error, error.hint()) }
    }
}

impl From<ModelError> for Failure {
    fn from(error: ModelError) -> Self {
        Self::new(Exit::NotSolvable, &error, Some(error.hint()))
    }
}

impl From<VerificationError> for Failure {
    fn from(error: VerificationError) -> Self {
        Self::new(Exit::NotSolvable, &format!("not verified: {error}"), error.hint())
    }
}

impl From<FitError> for Failure {
    fn from(error: FitError) -> Self {
        let hint = match &error {
            FitError::TooSlow { .. } => Some("use a higher limit, shorter travel or longer step"),
            FitError::TooHeavy { .. } | FitError::TooHeavyArm { .. } => {
                Some("use a higher limit, or a lighter link")
            }
            FitError::Inversion(error) => error.hint(),
            FitError::Motion(error) => error.hint(),
            FitError::Curve(error) => error.hint(),
            FitError::Path(error) => error.hint(),
        };
        let exit = match &error {
            FitError::Curve(CurveError::TurnsAtOnce { .. }) => Exit::Usage,
            FitError::Inversion(error) if error.is_of_input() => Exit::InputRefused,
            _ => Exit::NotSolvable,
        };
        Self::new(exit, &error, hint)
    }
}

impl From<DampingError> for Failure {
    fn from(error: DampingError) -> Self {
        Self::new(Exit::NotSolvable, &error, Some(error.hint()))
    }
}

impl From<ParameterError> for Failure {
    fn from(error: ParameterError) -> Self {
        Self::new(Exit::Usage, &error, None)
    }
}
