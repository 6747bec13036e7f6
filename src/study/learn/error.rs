//! Why a recording teaches nothing.

use thiserror::Error;

use crate::link::ParameterError;
use crate::model::ModelError;
use crate::motion::{MotionError, PathError};
use crate::numeric::rounded;
use crate::response::PoseError;
use crate::text::significant;

/// Why a recording teaches nothing.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LearnError {
    /// A motion without rest at its ends.
    #[error("the motion moves at its ends, but must rest there to be learned")]
    Moves,
    /// A recording without the tip.
    #[error("{channel} is missing, but learn needs the measured tip")]
    NoTip {
        /// Name of the missing channel.
        channel: String,
    },
    /// A recording that misses a part of the motion.
    #[error("the recording lasts from {} to {} s, but the motion from {} to {} s", second(recorded_s[0]), second(recorded_s[1]), second(motion_s[0]), second(motion_s[1]))]
    TooShort {
        /// First and last time of the recording in s.
        recorded_s: [f64; 2],
        /// First and last time of the motion in s.
        motion_s: [f64; 2],
    },
    /// A recording that ends soon after the motion.
    #[error("the recording ends at {} s, but must last until {} s, a tenth of the motion after its end", second(*end_s), second(*until_s))]
    TooShortRest {
        /// Last time of the recording in s.
        end_s: f64,
        /// Least last time in s.
        until_s: f64,
    },
    /// Too few samples before or after the motion.
    #[error("the recording has {found} rows {} the motion at rest, but must have {least}", place(*is_before))]
    FewAtRest {
        /// True before the motion, false after it.
        is_before: bool,
        /// Rows there.
        found: usize,
        /// Fewest rows.
        least: usize,
    },
    /// A tip that moves where it should rest.
    #[error("the measured tip moves by {} % of the travel {} the motion, but must rest", significant(100.0 * share, 3), place(*is_before))]
    NoRest {
        /// True before the motion, false after it.
        is_before: bool,
        /// Its way over the travel.
        share: f64,
    },
    /// A recording of another motion.
    #[error("the recording is of another motion: with the best shift and scale {} % of it stay unlike", significant(100.0 * left, 3))]
    OtherMotion {
        /// Root mean square that the wanted motion does not explain, over that of the recording.
        left: f64,
    },
    /// A recording of another travel.
    #[error("the measured tip travels {} times as far as the wanted one, but must travel between {LEAST_TRAVEL} and {MOST_TRAVEL}", significant(*scale, 3))]
    OtherTravel {
        /// Measured over wanted travel.
        scale: f64,
    },
    /// A time shift that explains the error.
    #[error("the recording is {} s {}, which explains {} % of the error", significant(shift_s.abs(), 3), if *shift_s > 0.0 { "late" } else { "early" }, significant(100.0 * explained, 3))]
    Shift {
        /// Time of the recording less that of the motion in s.
        shift_s: f64,
        /// Share of the error that the shift removes.
        explained: f64,
    },
    /// Plants that differ from the model by their whole response at the lowest frequency.
    #[error("the plants differ from the model by {} times its response at {} Hz, the lowest frequency of the recording, but must differ by less than 1", significant(*ratio, 3), significant(*hertz, 3))]
    NoBand {
        /// The lowest frequency in Hz.
        hertz: f64,
        /// Largest `|G_true/G − 1|` there.
        ratio: f64,
    },
    /// A link without a mesh.
    #[error(transparent)]
    Mesh(#[from] ParameterError),
    /// A link without a model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A pose without a response.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// A corrected motion that is refused.
    #[error("the corrected motion: {0}")]
    Motion(#[from] MotionError),
    /// A corrected path that is refused.
    #[error("the corrected path: {0}")]
    Path(#[from] PathError),
}

/// Smallest and largest ratio of the measured to the wanted travel.
pub(super) const LEAST_TRAVEL: f64 = 0.5;
pub(super) const MOST_TRAVEL: f64 = 1.5;

fn second(s: f64) -> f64 {
    rounded(s, 6)
}

fn place(is_before: bool) -> &'static str {
    if is_before { "before" } else { "after" }
}

impl LearnError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<String> {
        let text = match self {
            Self::Moves => "use a motion from rest to rest",
            Self::NoTip { .. } => "record the tip: `tip` of a link, `x` and `y` of an arm",
            Self::TooShort { .. } => {
                "record the whole motion, and count its time from the same instant: --shift TIME"
            }
            Self::TooShortRest { .. } => "record longer, at rest",
            Self::FewAtRest { .. } => "start earlier and record longer, or more often",
            Self::NoRest { is_before: true, .. } => {
                "start the recording at rest, and count its time from the same instant: --shift TIME"
            }
            Self::NoRest { .. } => "record until the tip rests, or add friction or feedback",
            Self::OtherMotion { .. } | Self::OtherTravel { .. } => {
                "use the recording of this motion under the applied table, and its unit: --unit measured:UNIT"
            }
            Self::Shift { shift_s, .. } => {
                let shift = significant(*shift_s, 3);
                return Some(format!(
                    "--shift '{shift} s' if the clocks differ, --shift 0 if the tip itself is late"
                ));
            }
            Self::NoBand { .. } => "use narrower intervals: measure and fit the link first",
            Self::Mesh(_) => return None,
            Self::Model(error) => error.hint(),
            Self::Pose(error) => return error.hint().map(str::to_owned),
            Self::Motion(error) => return error.hint().map(str::to_owned),
            Self::Path(error) => return error.hint().map(str::to_owned),
        };
        Some(text.to_owned())
    }
}
