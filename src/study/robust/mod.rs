//! Commands on plants that differ from the model: the error of the tip over intervals of the link's values.

mod command;
mod key;
mod outcome;
mod plants;
mod strays;
mod summary;

pub use command::{
    Command, CommandError, Histories, Hold, PERIODS, PlantTip, Thinned, directions_rad,
};
pub use key::{Fitted, How, Key};
pub use outcome::{
    Inside, KeyOutcome, OverLimit, Plant, PlantError, PlantKind, Quantile, Quantiles, Robustness,
    Study, Worst,
};
pub use plants::{Distribution, Sample, Values, corners};
pub use strays::{Measure, Strays};
pub use summary::{Help, PlayErrors, RobustSummary, StoredRobust, WorstPlant, share_words};
