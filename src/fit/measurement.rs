use std::f64::consts::TAU;
use std::fmt;

use serde::Serialize;
use thiserror::Error;

use super::overlay::Overlay;
use super::response::{MOST_UNCERTAIN, Response};
use crate::beam::{Mesh, MeshPlan};
use crate::link::{Link, ParameterError};
use crate::modal::{DampingLaw, held_frequencies, natural_frequencies};
use crate::model::{KeptModes, model_of};

/// Largest relative error of a frequency that the mesh may have while a start is tried.
pub(super) const COARSE: f64 = 1e-5;

/// The same of the fitted link: far below any measurement's.
pub(super) const FINE: f64 = 1e-8;

/// Highest number of a mode or zero: the mesh grows with it.
const MOST_NUMBER: usize = 100;

/// How the hub was held while the link vibrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum HubEnd {
    /// Free to turn.
    Free,
    /// Held: the rotor of a drive, with the joint's spring behind it; without a drive the hub itself.
    Held,
}

/// What was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Observable {
    /// A natural frequency in Hz, the rigid rotation left out.
    Frequency {
        /// Number of the mode, from 1.
        mode: usize,
        /// The hub's end.
        hub: HubEnd,
    },
    /// A zero of torque → hub angle in Hz, from 1: the frequencies of the clamped link.
    Zero {
        /// Number of the zero, from 1.
        zero: usize,
    },
    /// The damping ratio of a mode.
    Damping {
        /// Number of the mode, from 1.
        mode: usize,
        /// The hub's end.
        hub: HubEnd,
    },
}

impl Observable {
    /// Number of the mode or zero, from 1.
    fn number(self) -> usize {
        match self {
            Self::Frequency { mode, .. } | Self::Damping { mode, .. } => mode,
            Self::Zero { zero } => zero,
        }
    }

    fn end(self) -> End {
        match self {
            Self::Frequency { hub, .. } | Self::Damping { hub, .. } => match hub {
                HubEnd::Free => End::Free,
                HubEnd::Held => End::Held,
            },
            Self::Zero { .. } => End::Clamped,
        }
    }

    /// True of a damping ratio.
    pub(super) fn is_damping(self) -> bool {
        matches!(self, Self::Damping { .. })
    }

    /// Unit of its value; none of a ratio.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Frequency { .. } | Self::Zero { .. } => "Hz",
            Self::Damping { .. } => "",
        }
    }
}

impl fmt::Display for Observable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let held = |hub: HubEnd| if hub == HubEnd::Held { ", hub held" } else { "" };
        match self {
            Self::Frequency { mode, hub } => write!(f, "frequency {mode}{}", held(*hub)),
            Self::Zero { zero } => write!(f, "zero {zero} of the hub angle"),
            Self::Damping { mode, hub } => write!(f, "damping ratio {mode}{}", held(*hub)),
        }
    }
}

/// The boundary at the hub.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    Free,
    Held,
    Clamped,
}

impl End {
    const ALL: [Self; 3] = [Self::Free, Self::Held, Self::Clamped];

    /// The first `count` natural frequencies in rad/s; fewer where the mesh has fewer.
    fn frequencies(self, link: &Link, mesh: &Mesh, count: usize) -> Vec<f64> {
        let joint = || link.drive().map_or(f64::INFINITY, |drive| drive.joint_stiffness_n_m_rad);
        match self {
            Self::Free => natural_frequencies(mesh, count),
            Self::Held => held_frequencies(mesh, joint(), count),
            Self::Clamped => held_frequencies(mesh, f64::INFINITY, count),
        }
    }
}

/// One measured value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Measured {
    /// What was measured.
    pub observable: Observable,
    /// Its value in [`Observable::unit`], above 0.
    pub value: f64,
    /// Its standard uncertainty in the same unit, if it is known.
    pub uncertainty: Option<f64>,
}

impl Measured {
    /// Uncertainty over the value; 1 where it is not known.
    fn relative(&self) -> f64 {
        self.uncertainty.map_or(1.0, |uncertainty| uncertainty / self.value)
    }

    /// Refuses what cannot be measured.
    fn check(&self) -> Result<(), MeasurementsError> {
        let Self { observable, value, uncertainty } = *self;
        let checked = [
            ("value", value),
            ("uncertainty", uncertainty.unwrap_or(1.0)),
            ("number", observable.number() as f64),
        ];
        let wrong = checked.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0));
        match wrong {
            Some((name, value)) => Err(MeasurementsError::Value { observable, name, value }),
            None if observable.number() > MOST_NUMBER => {
                Err(MeasurementsError::Number { observable })
            }
            None if uncertainty.is_some_and(|u| u >= MOST_UNCERTAIN * value) => {
                let most = MOST_UNCERTAIN * value;
                let value = uncertainty.unwrap_or_default();
                Err(MeasurementsError::Large { observable, name: "uncertainty", value, most })
            }
            None if observable.is_damping() && value >= 1.0 => {
                Err(MeasurementsError::Large { observable, name: "ratio", value, most: 1.0 })
            }
            None => Ok(()),
        }
    }
}

/// Why values cannot be fitted to.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MeasurementsError {
    /// Nothing was measured.
    #[error("measurements = none, but must be at least one")]
    Empty,
    /// A value, an uncertainty or a number that cannot be.
    #[error("{observable}: {name} = {value}, but must be finite and above 0")]
    Value {
        /// What was measured.
        observable: Observable,
        /// The part that is wrong.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// An uncertainty as large as the value, or a damping ratio of 1 or more: probably a per cent.
    #[error("{observable}: {name} = {value}, but must be below {most}")]
    Large {
        /// What was measured.
        observable: Observable,
        /// The part that is wrong.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be below.
        most: f64,
    },
    /// A mode or zero too high to be measured.
    #[error("{observable}: its number must be at most {MOST_NUMBER}")]
    Number {
        /// What was measured.
        observable: Observable,
    },
    /// Some uncertainties are known and some are not.
    #[error("{observable}: uncertainty is missing, but others have one")]
    Mixed {
        /// The first measurement without uncertainty.
        observable: Observable,
    },
    /// A response without uncertainty beside values with one, or the other way round.
    #[error("{0}: responses and values must all have an uncertainty, or none")]
    MixedResponse(String),
    /// The same thing measured twice.
    #[error("{observable} is measured twice")]
    Twice {
        /// What was measured.
        observable: Observable,
    },
}

/// What was measured of one link: all with an uncertainty, or nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurements {
    values: Vec<Measured>,
    responses: Vec<Response>,
}

/// What a link has in place of the measurements.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Prediction {
    /// In place of each value; none of a mode that the link has not.
    pub(super) values: Vec<Option<f64>>,
    /// Misfits of each response.
    pub(super) responses: Vec<Vec<f64>>,
}

impl Measurements {
    /// Checks the values and responses.
    ///
    /// # Errors
    /// [`MeasurementsError`]: nothing measured, a value or an uncertainty that is not above 0, a mode number
    /// 0 or above 100, a thing measured twice, uncertainties of some only. A response beside values, or
    /// beside another response, needs an uncertainty: their misfits have other sizes.
    pub fn new(values: Vec<Measured>, responses: Vec<Response>) -> Result<Self, MeasurementsError> {
        if values.is_empty() && responses.is_empty() {
            return Err(MeasurementsError::Empty);
        }
        let measurements = Self { values, responses };
        let is_known = measurements.has_uncertainties();
        for (k, measured) in measurements.values.iter().enumerate() {
            let observable = measured.observable;
            measured.check()?;
            if is_known && measured.uncertainty.is_none() {
                return Err(MeasurementsError::Mixed { observable });
            }
            if measurements.values[..k].iter().any(|earlier| earlier.observable == observable) {
                return Err(MeasurementsError::Twice { observable });
            }
        }
        let is_alone = measurements.values.is_empty() && measurements.responses.len() == 1;
        let unknown =
            measurements.responses.iter().find(|response| response.uncertainty().is_none());
        match unknown.filter(|_| !is_alone) {
            Some(response) => Err(MeasurementsError::MixedResponse(response.name().to_owned())),
            None => Ok(measurements),
        }
    }

    /// The values in their order.
    pub fn values(&self) -> &[Measured] {
        &self.values
    }

    /// The responses in their order.
    pub fn responses(&self) -> &[Response] {
        &self.responses
    }

    /// True if the uncertainties are known.
    pub fn has_uncertainties(&self) -> bool {
        self.values.iter().any(|measured| measured.uncertainty.is_some())
            || self.responses.iter().any(|response| response.uncertainty().is_some())
    }

    /// Number of residuals less that of gains: what a fit has to determine its values.
    pub(super) fn rows(&self) -> [usize; 2] {
        let sum = |of: fn(&Response) -> usize| self.responses.iter().map(of).sum::<usize>();
        [self.values.len() + sum(Response::rows), sum(Response::own_free_values)]
    }

    /// Root of the sum of the residuals' squared weights.
    pub(super) fn weight(&self) -> f64 {
        let values = self.values.iter().map(|measured| measured.relative().powi(-2));
        let responses = self.responses.iter().map(|response| {
            response.rows() as f64 * response.uncertainty().unwrap_or(1.0).powi(-2)
        });
        values.chain(responses).sum::<f64>().sqrt()
    }

    /// How often the elements of an automatic plan are halved so that the measured frequencies are exact to a
    /// tolerance; 0 for other plans.
    pub(super) fn halvings(
        &self,
        link: &Link,
        plan: &MeshPlan,
        tolerance: f64,
    ) -> Result<u32, ParameterError> {
        let first = Mesh::new(link, plan)?;
        if !plan.is_automatic() {
            return Ok(0);
        }
        let counts = End::ALL.map(|end| (end, self.most(end)));
        let most = counts.iter().map(|(_, count)| *count).max().unwrap_or(1);
        let mut mesh = first.clone();
        while mesh.elements().len() <= most {
            mesh = mesh.refined();
        }
        let ends = counts.map(|(end, count)| end.frequencies(link, &mesh, count).last().copied());
        let responses = self.responses.iter().map(Response::highest_rad_s);
        let fastest = ends.into_iter().flatten().chain(responses).fold(0.0, f64::max);
        let mesh = mesh.resolving(fastest, tolerance);
        Ok((mesh.elements().len() / first.elements().len()).ilog2())
    }

    /// The highest number measured with the hub at this end; 0 without one.
    fn most(&self, end: End) -> usize {
        let own = self.values.iter().filter(|measured| measured.observable.end() == end);
        own.map(|measured| measured.observable.number()).max().unwrap_or(0)
    }

    /// What a link has in place of the measurements; none of a link that has no mesh or no model.
    pub(super) fn predicted(
        &self,
        link: &Link,
        plan: &MeshPlan,
        halvings: u32,
    ) -> Option<Prediction> {
        let first = Mesh::new(link, plan).ok()?;
        let halved = (0..halvings).fold(first, |mesh, _| mesh.refined());
        let law = DampingLaw::of(link, &halved).ok();
        let known = End::ALL.map(|end| end.frequencies(link, &halved, self.most(end)));
        let values = self.values.iter().map(|Measured { observable, .. }| {
            let (omegas, index) = (&known[observable.end() as usize], observable.number() - 1);
            match observable {
                Observable::Damping { .. } => {
                    law.as_ref()?.modal_ratios(omegas).get(index).copied()
                }
                _ => omegas.get(index).map(|omega| omega / TAU),
            }
        });
        let values = values.collect();
        let responses = if self.responses.is_empty() {
            Vec::new()
        } else {
            let model = model_of(link, halved, KeptModes::All).ok()?;
            self.responses.iter().map(|response| response.misfits(&*model)).collect()
        };
        Some(Prediction { values, responses })
    }

    /// Measured and fitted over each other: gain and phase of each response.
    pub(super) fn overlays(&self, predicted: &Prediction) -> Vec<Overlay> {
        let responses = self.responses.iter().zip(&predicted.responses);
        responses.flat_map(|(response, misfits)| response.overlays(misfits)).collect()
    }

    /// `ln(prediction/value)` over the relative uncertainty, or over 1 where none is known; the responses
    /// after the values.
    pub(super) fn residuals(&self, predicted: &Prediction) -> Option<Vec<f64>> {
        let pairs = self.values.iter().zip(&predicted.values);
        let value = |(measured, predicted): (&Measured, &Option<f64>)| {
            Some(libm::log((*predicted)? / measured.value) / measured.relative())
        };
        let responses = self.responses.iter().zip(&predicted.responses);
        let response = |(response, misfits): (&Response, &Vec<f64>)| {
            let uncertainty = response.uncertainty().unwrap_or(1.0);
            misfits.iter().map(move |misfit| misfit / uncertainty).collect::<Vec<f64>>()
        };
        let mut residuals: Vec<f64> = pairs.map(value).collect::<Option<_>>()?;
        residuals.extend(responses.flat_map(response));
        residuals.iter().all(|residual| residual.is_finite()).then_some(residuals)
    }
}
