use std::process::ExitCode;

use flexlink::csv::{InputError, TableError};
use flexlink::inverse::InversionError;
use flexlink::modal::DampingError;
use flexlink::model::ModelError;
use flexlink::response::SimulationError;
use flexlink::result::{FitError, TargetError};
use flexlink::spec::SpecError;
use flexlink::store::FolderError;
use flexlink::verify::VerificationError;

/// How a program that has done its work ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// As it should.
    Done = 0,
    /// What was compared is different.
    Different = 1,
}

impl From<Ending> for ExitCode {
    fn from(ending: Ending) -> Self {
        Self::from(ending as u8)
    }
}

/// How the program ends when it is not done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Exit {
    /// The command line asks for what there is not.
    Usage = 2,
    /// An input file is refused.
    InputRefused = 3,
    /// Link and motion are valid, but there is no answer.
    NotSolvable = 4,
    /// The results cannot be written.
    CannotWrite = 5,
    /// Stopped in order by Ctrl-C or the system's request to end: the number that shells give Ctrl-C.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// Why the program ends without having done its work.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) exit: Exit,
    pub(crate) message: String,
    pub(crate) hint: Option<String>,
    /// Whether it takes more memory than is allowed.
    pub(crate) is_of_memory: bool,
}

impl Failure {
    pub(crate) fn new(exit: Exit, message: &impl ToString, hint: Option<&str>) -> Self {
        let hint = hint.map(str::to_owned);
        Self { exit, message: message.to_string(), hint, is_of_memory: false }
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        Self::new(Exit::InputRefused, &error, error.hint())
    }
}

impl From<SpecError> for Failure {
    fn from(error: SpecError) -> Self {
        Self::new(Exit::InputRefused, &error, error.hint())
    }
}

impl From<TableError> for Failure {
    fn from(error: TableError) -> Self {
        Self::new(Exit::InputRefused, &error, error.hint())
    }
}

impl From<InversionError> for Failure {
    fn from(error: InversionError) -> Self {
        let is_of_memory = matches!(error, InversionError::TooMuchMemory { .. });
        Self { is_of_memory, ..Self::new(Exit::NotSolvable, &error, error.hint()) }
    }
}

impl From<SimulationError> for Failure {
    fn from(error: SimulationError) -> Self {
        let is_of_memory = matches!(error, SimulationError::TooMuchMemory { .. });
        Self { is_of_memory, ..Self::new(Exit::NotSolvable, &error, error.hint()) }
    }
}

impl From<TargetError> for Failure {
    fn from(error: TargetError) -> Self {
        Self::new(Exit::NotSolvable, &error, error.hint())
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
            FitError::TooSlow { .. } => Some("a higher limit, a shorter way or a longer step"),
            FitError::Inversion(error) => error.hint(),
            FitError::Motion(_) => None,
        };
        Self::new(Exit::NotSolvable, &error, hint)
    }
}

impl From<DampingError> for Failure {
    fn from(error: DampingError) -> Self {
        Self::new(Exit::NotSolvable, &error, Some(error.hint()))
    }
}

impl From<FolderError> for Failure {
    fn from(error: FolderError) -> Self {
        Self::new(Exit::CannotWrite, &error, None)
    }
}
