//! Fit of a link to its measurements: natural frequencies, zeros, damping ratios, frequency responses and recorded
//! histories; fit of an arm to frequencies and damping ratios in poses.
//!
//! ```text
//! link.toml + free values ─► Specimen ─► predictions ─► residuals ─► least squares ─► factors
//!                                                                     Jacobian ─► standard errors,
//!                                                                                 what is not determined
//! ```
//!
//! The unknowns are the logarithms of factors on values of the link file. The residual of each measurement is the
//! logarithm of prediction over measured value, over the relative uncertainty of the measurement. The residuals of a
//! record are the differences of its samples from the history of the link, over their uncertainty, with the best gain,
//! offset and delay of the sensors where these are free.

mod advice;
mod answers;
mod damped;
mod decay;
mod instruments;
mod least_squares;
mod measurement;
mod measurements;
mod misfits;
mod outcome;
mod record;
mod response;
mod specimen;

pub use decay::{Decay, DecayError, DecayMode, DecaySamples, DecayValues};
pub use instruments::{Channel, Gain, Motor, RecordError, RecordInput, RecordedInput};
pub use least_squares::fit;
pub use measurement::{
    ArmMode, HubEnd, LinkFitError, Measured, MeasurementsError, Observable, UnfitDrive,
};
pub use measurements::Measurements;
pub use misfits::{ChannelMisfit, Misfit, RecordMisfit, Residual};
pub use outcome::{
    FitOutcome, FittedValue, Free, FreeNumber, Openness, OtherAnswer, Replaced, StartEnd,
    Undetermined,
};
pub use record::Record;
pub use response::{Coordinate, Overlay, Response, ResponseError, ResponseMisfit, Spacing};
pub use specimen::Specimen;
