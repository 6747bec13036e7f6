//! From the tip's motion to the hub torque: the frequency-domain inversion (Bayo 1987, eqs 13-21).

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "samples are counted from the trajectory's first, so some numbers are negative; all \
              stay far below 2^52, and are brought into the period before they index"
)]

mod accuracy;
mod analysis;
mod arm;
mod diagnostics;
mod error;
mod histories;
mod inversion;
mod mesh_error;
mod model_error;
mod nodal_table;
mod period;
mod periodic_answer;
mod problem;
mod solution;
mod spectra;
mod warning;

pub(crate) use accuracy::size;
pub use accuracy::{PerQuantity, Quantity, QuantityErrors, ShareOf};
pub use analysis::{Analysis, Resources, Stage, Unwatched, Watch};
pub use arm::check_reach;
pub use error::{InversionError, RefusedEnds};
pub use histories::MotorHistories;
#[cfg(test)]
pub(crate) use inversion::tests;
pub use inversion::{WindowTorques, invert, invert_motion};
pub use nodal_table::NodalTable;
pub use solution::{Band, JointMotion, LinkMotion, LinkShape, SecondOrderFindings, Solution};
pub use warning::{SolutionWarning, Straying, Warning};
