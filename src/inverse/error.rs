use thiserror::Error;

/// Why a valid link and a valid motion have no torque here.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum InversionError {
    /// Rayleigh damping through modes that the mesh does not have.
    #[error("damping.modes asks for mode {asked}, but the mesh must have it and has {found} modes")]
    NoSuchMode {
        /// Mode asked for.
        asked: usize,
        /// Flexible modes of the mesh.
        found: usize,
    },
    /// Rayleigh damping through two modes that would feed energy in.
    #[error(
        "damping.ratios give alpha = {alpha_per_s:.3e} 1/s and beta = {beta_s:.3e} s, but both must \
         be at least 0"
    )]
    NegativeDamping {
        /// α in 1/s.
        alpha_per_s: f64,
        /// β in s.
        beta_s: f64,
    },
    /// A law that only modes know.
    #[error("damping.model = {model:?}, but must be one that the inversion knows")]
    LawOfModes {
        /// Name of the law.
        model: &'static str,
    },
    /// A frequency at which no torque moves the tip, or numbers beyond double precision.
    #[error("the torque at {frequency_hz:.4} Hz = not a finite number, but must be one")]
    NotFinite {
        /// The frequency in Hz.
        frequency_hz: f64,
    },
    /// An automatic mesh that does not converge.
    #[error(
        "mesh error = {error:.2e} of the peak torque with {elements} elements, but must be at most \
         {tolerance:e}"
    )]
    NotConverged {
        /// Error reached, relative to the peak torque.
        error: f64,
        /// Elements of the finest mesh tried.
        elements: usize,
        /// Tolerance asked for.
        tolerance: f64,
    },
    /// A window longer than this program transforms.
    #[error("the period = {samples} samples, but must be at most {limit}")]
    TooLong {
        /// Samples needed.
        samples: usize,
        /// Samples possible.
        limit: usize,
    },
}

impl InversionError {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        Some(match self {
            Self::NoSuchMode { .. } => "name lower modes, or give the mesh more elements",
            Self::NegativeDamping { .. } => {
                "bring the two ratios closer together, or give alpha and beta themselves"
            }
            Self::LawOfModes { .. } => "hysteretic and rayleigh are known",
            Self::NotFinite { .. } => {
                "no torque moves the tip there (a payload's inertia without damping), the mesh is far \
                 too coarse, or the inputs are too large for double precision"
            }
            Self::NotConverged { .. } => {
                "sample the motion more smoothly, or loosen mesh.tolerance"
            }
            Self::TooLong { .. } => {
                "use a longer step, or a shorter analysis.lead and analysis.lag"
            }
        })
    }
}
