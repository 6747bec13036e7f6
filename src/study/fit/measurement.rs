use super::instruments::MOST_UNCERTAIN;
use crate::link::{Link, ParameterError};
use crate::modal::PoseHub;
use crate::response::PoseError;
use crate::text::significant;
use serde::{Deserialize, Serialize};
use std::fmt;
use thiserror::Error;

/// Highest number of a mode or zero; the mesh grows with it.
const MOST_NUMBER: usize = 100;

/// State of the hub while the link vibrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HubEnd {
    /// The hub is free to turn.
    #[default]
    Free,
    /// The hub is held: at the rotor of a drive, behind the joint's spring; without a drive at the hub.
    Held,
}

/// A mode of an arm about its shape at rest in a pose.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArmMode {
    /// Number of the mode from 1, as in [`ArmModes`](crate::response::ArmModes): with free joints the swings come
    /// first.
    pub mode: usize,
    /// All joints free, or all rotors held.
    pub joints: HubEnd,
    /// Direction of each link's chord in rad, counterclockwise from x, the inner one first.
    pub at_rad: Vec<f64>,
}

impl fmt::Display for ArmMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let joints = match self.joints {
            HubEnd::Free => "free",
            HubEnd::Held => "held",
        };
        let degrees = |angle: &f64| {
            let text = significant(angle.to_degrees(), 5);
            let text = if text.contains('.') { text.trim_end_matches('0') } else { &text };
            format!("{}°", text.trim_end_matches('.'))
        };
        let at: Vec<String> = self.at_rad.iter().map(degrees).collect();
        write!(f, "{}, joints {joints}, at {}", self.mode, at.join(", "))
    }
}

/// Measured quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Observable {
    /// Natural frequency in Hz, without the rigid rotation.
    Frequency {
        /// Number of the mode, from 1.
        mode: usize,
        /// State of the hub.
        hub: HubEnd,
    },
    /// Zero of torque → hub angle in Hz: a frequency of the clamped link.
    Zero {
        /// Number of the zero, from 1.
        zero: usize,
    },
    /// Damping ratio of a mode.
    Damping {
        /// Number of the mode, from 1.
        mode: usize,
        /// State of the hub.
        hub: HubEnd,
    },
    /// Natural frequency of an arm in Hz.
    ArmFrequency(ArmMode),
    /// Damping ratio of a mode of an arm.
    ArmDamping(ArmMode),
}

impl Observable {
    /// Number of the mode or zero, from 1.
    pub(super) fn number(&self) -> usize {
        match self {
            Self::Frequency { mode, .. } | Self::Damping { mode, .. } => *mode,
            Self::Zero { zero } => *zero,
            Self::ArmFrequency(own) | Self::ArmDamping(own) => own.mode,
        }
    }

    /// Boundary at the hub of a link; `None` for an arm.
    pub(super) fn end(&self) -> Option<End> {
        match self {
            Self::Frequency { hub, .. } | Self::Damping { hub, .. } => Some(match hub {
                HubEnd::Free => End::Free,
                HubEnd::Held => End::Held,
            }),
            Self::Zero { .. } => Some(End::Clamped),
            Self::ArmFrequency(_) | Self::ArmDamping(_) => None,
        }
    }

    /// Mode of an arm; `None` for a link.
    pub(super) fn arm_mode(&self) -> Option<&ArmMode> {
        match self {
            Self::ArmFrequency(own) | Self::ArmDamping(own) => Some(own),
            Self::Frequency { .. } | Self::Zero { .. } | Self::Damping { .. } => None,
        }
    }

    /// True for a damping ratio.
    pub(super) fn is_damping(&self) -> bool {
        matches!(self, Self::Damping { .. } | Self::ArmDamping(_))
    }

    /// Damping ratio of the mode with this frequency.
    pub(crate) fn ratio(&self) -> Self {
        match self.clone() {
            Self::Frequency { mode, hub } => Self::Damping { mode, hub },
            Self::ArmFrequency(own) => Self::ArmDamping(own),
            other => other,
        }
    }

    /// This quantity for the mode of another number.
    pub(super) fn numbered(&self, number: usize) -> Self {
        match self.clone() {
            Self::Frequency { hub, .. } => Self::Frequency { mode: number, hub },
            Self::Damping { hub, .. } => Self::Damping { mode: number, hub },
            Self::Zero { .. } => Self::Zero { zero: number },
            Self::ArmFrequency(own) => Self::ArmFrequency(ArmMode { mode: number, ..own }),
            Self::ArmDamping(own) => Self::ArmDamping(ArmMode { mode: number, ..own }),
        }
    }

    /// Unit of the value; empty for a ratio.
    pub fn unit(&self) -> &'static str {
        if self.is_damping() { "" } else { "Hz" }
    }
}

impl fmt::Display for Observable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let held = |hub: HubEnd| if hub == HubEnd::Held { ", hub held" } else { "" };
        match self {
            Self::Frequency { mode, hub } => write!(f, "frequency {mode}{}", held(*hub)),
            Self::Zero { zero } => write!(f, "zero {zero} of the hub angle"),
            Self::Damping { mode, hub } => write!(f, "damping ratio {mode}{}", held(*hub)),
            Self::ArmFrequency(own) => write!(f, "frequency {own}"),
            Self::ArmDamping(own) => write!(f, "damping ratio {own}"),
        }
    }
}

/// Boundary at the hub.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Free,
    Held,
    Clamped,
}

impl End {
    pub(super) const ALL: [Self; 3] = [Self::Free, Self::Held, Self::Clamped];

    /// Restraint of a link's hub.
    pub(super) fn hub(self, link: &Link) -> PoseHub {
        match self {
            Self::Free => PoseHub::Free,
            Self::Held => PoseHub::Spring(link.joint_stiffness_n_m_rad()),
            Self::Clamped => PoseHub::Spring(f64::INFINITY),
        }
    }
}

/// One measured value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measured {
    /// Measured quantity.
    pub observable: Observable,
    /// Value in [`Observable::unit`], above 0.
    pub value: f64,
    /// Standard uncertainty in the same unit, if known.
    pub uncertainty: Option<f64>,
}

impl Measured {
    /// Uncertainty over the value; 1 if it is unknown.
    pub(super) fn relative(&self) -> f64 {
        self.uncertainty.map_or(1.0, |uncertainty| uncertainty / self.value)
    }

    /// The value with its uncertainty in two digits, `2.3286 ± 0.0012`, without the unit.
    pub fn shown(&self) -> String {
        let Some(uncertainty) = self.uncertainty else { return significant(self.value, 5) };
        let order = |number: f64| libm::log10(number.abs()).floor();
        let least = 2.0 + order(self.value) - order(uncertainty);
        let digits = (2_usize..12).find(|digits| *digits as f64 >= least).unwrap_or(12);
        format!("{} ± {}", significant(self.value, digits), significant(uncertainty, 2))
    }

    /// Refuses impossible values.
    pub(super) fn check(&self) -> Result<(), MeasurementsError> {
        let Self { ref observable, value, uncertainty } = *self;
        let observable = || observable.clone();
        let checked = [
            ("value", value),
            ("uncertainty", uncertainty.unwrap_or(1.0)),
            ("number", self.observable.number() as f64),
        ];
        let wrong = checked.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0));
        match wrong {
            Some((name, value)) => {
                Err(MeasurementsError::Value { observable: observable(), name, value })
            }
            None if self.observable.number() > MOST_NUMBER => {
                Err(MeasurementsError::Number { observable: observable() })
            }
            None if uncertainty.is_some_and(|u| u >= MOST_UNCERTAIN * value) => {
                let most = MOST_UNCERTAIN * value;
                let value = uncertainty.unwrap_or_default();
                Err(MeasurementsError::Large {
                    observable: observable(),
                    name: "uncertainty",
                    value,
                    most,
                })
            }
            None if self.observable.is_damping() && value >= 1.0 => Err(MeasurementsError::Large {
                observable: observable(),
                name: "ratio",
                value,
                most: 1.0,
            }),
            None => Ok(()),
        }
    }
}

/// Reason why values cannot be used in a fit.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MeasurementsError {
    /// There are no measurements.
    #[error("the fit has no measurements, but needs at least one")]
    Empty,
    /// A value, an uncertainty or a number is impossible.
    #[error("{observable}: {name} = {value}, but must be finite and above 0")]
    Value {
        /// Measured quantity.
        observable: Observable,
        /// Name of the wrong part.
        name: &'static str,
        /// Value of the part.
        value: f64,
    },
    /// An uncertainty is as large as the value, or a damping ratio is 1 or more: probably a per cent.
    #[error("{observable}: {name} = {value}, but must be below {most}")]
    Large {
        /// Measured quantity.
        observable: Observable,
        /// Name of the wrong part.
        name: &'static str,
        /// Value of the part.
        value: f64,
        /// Upper limit of the part.
        most: f64,
    },
    /// A mode or zero is too high for a measurement.
    #[error("{observable}: its number must be at most {MOST_NUMBER}")]
    Number {
        /// Measured quantity.
        observable: Observable,
    },
    /// Only some uncertainties are known.
    #[error("{observable}: uncertainty is missing, but others have one")]
    Mixed {
        /// The first measurement without uncertainty.
        observable: Observable,
    },
    /// Of a file and the values, only one has uncertainties.
    #[error("{0}: an uncertainty is missing, but all values and files must have one if any has")]
    MixedFile(String),
    /// A sensor of a file appears twice.
    #[error("{0} is given twice")]
    TwiceFile(String),
    /// A quantity is measured twice.
    #[error("{observable} is measured twice")]
    Twice {
        /// Measured quantity.
        observable: Observable,
    },
}

/// Limit of the factor between a measured frequency and the file's; beyond it no start is tried.
pub(super) const FARTHEST: f64 = 1e6;

/// Reason why responses and records do not suit the drive of a link file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum UnfitDrive {
    /// An elastic joint, which responses and records do not have.
    #[error(
        "drive.joint_stiffness is finite, but beside responses and records must be inf: they are those of a link that is \
         rigidly fixed to its rotor"
    )]
    Elastic,
    /// A rotor beside a torque, which acts at the hub.
    #[error(
        "drive.rotor_inertia is above 0, but must be 0 beside a response or record per torque or force: these act at the \
         joint, behind the rotor"
    )]
    Rotor,
    /// Losses beside a response, which is linear.
    #[error(
        "drive.efficiency is below 1, or drive.coulomb_friction above 0, but a [[response]] is linear and has no losses"
    )]
    Losses,
}

/// Reason why no link can be fitted.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LinkFitError<E> {
    /// The file's values make no link.
    #[error("{0}")]
    Link(E),
    /// The plan of the mesh does not fit the link.
    #[error("{0}")]
    Plan(#[from] ParameterError),
    /// The arm has no small motions about a pose.
    #[error("{0}")]
    Pose(#[from] PoseError),
    /// A frequency has another order of magnitude than the file's.
    #[error(
        "{observable} = {} Hz, but must be within a factor of {FARTHEST:e} of the link file's value, {} Hz",
        significant(*measured, 4),
        significant(*own, 4)
    )]
    Distant {
        /// Measured quantity.
        observable: Observable,
        /// Measured value in Hz.
        measured: f64,
        /// Value in Hz of the link or the arm with the file's values.
        own: f64,
    },
    /// The specimen has fewer modes than were measured.
    #[error("{0} was measured, but there is no such mode")]
    NoMode(Observable),
    /// The mode does not vibrate.
    #[error(
        "{0} was measured, but this mode does not vibrate: it has no stiffness, or friction stops it"
    )]
    NoVibration(Observable),
    /// The polynomials do not resolve the measured modes.
    #[error(
        "the measured modes are not exact: the finest polynomials still change one by {change:.1e} of it"
    )]
    Coarse {
        /// Relative change of a mode.
        change: f64,
    },
    /// The link has no response or history on a fine mesh.
    #[error(
        "the link has nothing to compare with the measurements: its hub moves no mass, or its damping by \
         modes allows no mesh that is fine enough"
    )]
    NoModel,
    /// Responses and records do not suit the drive of the link file.
    #[error("{0}")]
    Drive(UnfitDrive),
    /// The damping of the link is zero or has another law.
    #[error("{0} was measured, but this mode has no damping: the link needs a damping law")]
    NoDamping(Observable),
}
