use super::decay::Decay;
use super::measurement::{Measured, MeasurementsError, UnfitDrive};
use super::record::{Alignment, Record};
use super::response::{Overlay, Response, ResponseFit};
use crate::link::Drive;
use crate::model::Sensor;

/// Measurements of one link, or of one arm: either all have an uncertainty, or none has.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurements {
    values: Vec<Measured>,
    responses: Vec<Response>,
    records: Vec<Record>,
    /// Decays; their values are among `values`.
    decays: Vec<Decay>,
}

/// Predictions of a link or an arm for the measurements.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Prediction {
    /// Prediction of each value; `None` for a missing mode.
    pub(super) values: Vec<Option<f64>>,
    /// Ratio of each response to the link's.
    pub(super) responses: Vec<ResponseFit>,
    /// Misfits of each record, and its alignment with the computed histories.
    pub(super) records: Vec<Alignment>,
}

impl Measurements {
    /// Checks the measurements.
    ///
    /// # Errors
    /// [`MeasurementsError`]: no measurements, a value or an uncertainty that is not above 0, a mode number 0 or above
    /// 100, a quantity measured twice, uncertainties for only some. Without uncertainties only one kind is possible:
    /// values, a response or records, because misfits of different kinds have different sizes.
    pub fn new(
        values: Vec<Measured>,
        responses: Vec<Response>,
        records: Vec<Record>,
    ) -> Result<Self, MeasurementsError> {
        let kinds =
            usize::from(!values.is_empty()) + responses.len() + usize::from(!records.is_empty());
        if kinds == 0 {
            return Err(MeasurementsError::Empty);
        }
        let measurements = Self { values, responses, records, decays: Vec::new() };
        let is_known = measurements.has_uncertainties();
        for (k, measured) in measurements.values.iter().enumerate() {
            let observable = || measured.observable.clone();
            measured.check()?;
            if is_known && measured.uncertainty.is_none() {
                return Err(MeasurementsError::Mixed { observable: observable() });
            }
            let earlier = &measurements.values[..k];
            if earlier.iter().any(|earlier| earlier.observable == measured.observable) {
                return Err(MeasurementsError::Twice { observable: observable() });
            }
        }
        if let Some(name) = measurements.twice() {
            return Err(MeasurementsError::TwiceFile(name));
        }
        let responses = measurements.responses.iter();
        let responses = responses.filter(|response| response.uncertainty().is_none());
        let records = measurements.records.iter().filter(|record| !record.has_uncertainties());
        let unknown = responses.map(Response::name).chain(records.map(Record::name)).next();
        match unknown.filter(|_| is_known || kinds > 1) {
            Some(name) => Err(MeasurementsError::MixedFile(name.to_owned())),
            None => Ok(measurements),
        }
    }

    /// Adds the decays behind some of the values.
    #[must_use]
    pub fn with_decays(self, decays: Vec<Decay>) -> Self {
        Self { decays, ..self }
    }

    /// Unchecked measurements of values only.
    pub(super) fn of_values(values: Vec<Measured>) -> Self {
        Self { values, responses: Vec::new(), records: Vec::new(), decays: Vec::new() }
    }

    /// A file and a sensor of it that appear twice.
    fn twice(&self) -> Option<String> {
        let responses = self.responses.iter().map(|response| (response.name(), response.sensor()));
        let records = self.records.iter().flat_map(|record| {
            record.channels().iter().map(|channel| (record.name(), channel.sensor))
        });
        let all: Vec<(&str, Sensor)> = responses.chain(records).collect();
        let again = all.iter().enumerate().find(|(k, one)| all[..*k].contains(one));
        again.map(|(_, (name, sensor))| format!("{} of {name}", sensor.word()))
    }

    /// The values in their order.
    pub fn values(&self) -> &[Measured] {
        &self.values
    }

    /// The responses in their order.
    pub fn responses(&self) -> &[Response] {
        &self.responses
    }

    /// The records in their order.
    pub fn records(&self) -> &[Record] {
        &self.records
    }

    /// Decays behind some of the values.
    pub fn decays(&self) -> &[Decay] {
        &self.decays
    }

    /// These measurements with only the beginning of each record.
    pub(super) fn beginning(&self, share: f64) -> Self {
        let records = self.records.iter().map(|record| record.beginning(share)).collect();
        Self { records, ..self.clone() }
    }

    /// These measurements with the channels of records weighted by the remaining differences of a fit, because each
    /// channel has a different noise. `None` unless there are several channels without uncertainties.
    pub(super) fn weighed(&self, predicted: &Prediction) -> Option<Self> {
        let channels: usize = self.records.iter().map(|record| record.channels().len()).sum();
        if channels < 2 || self.has_uncertainties() {
            return None;
        }
        let records = self.records.iter().zip(&predicted.records);
        let records = records.map(|(record, fit)| record.weighed(fit)).collect();
        Some(Self { records, ..self.clone() })
    }

    /// True if there are responses or records.
    pub(super) fn has_files(&self) -> bool {
        !(self.responses.is_empty() && self.records.is_empty())
    }

    /// Reason why responses and records do not suit a drive.
    pub(super) fn unfit(&self, drive: &Drive) -> Option<UnfitDrive> {
        let of_torque = self.responses.iter().any(|own| own.motor.is_none())
            || self.records.iter().any(Record::is_of_torque);
        let reasons = [
            (drive.joint_stiffness_n_m_rad.is_finite() && self.has_files(), UnfitDrive::Elastic),
            (drive.rotor_inertia_kg_m2 > 0.0 && of_torque, UnfitDrive::Rotor),
            (drive.has_losses() && !self.responses.is_empty(), UnfitDrive::Losses),
        ];
        reasons.into_iter().find(|(is_unfit, _)| *is_unfit).map(|(_, reason)| reason)
    }

    /// True if uncertainties are known.
    pub fn has_uncertainties(&self) -> bool {
        self.values.iter().any(|measured| measured.uncertainty.is_some())
            || self.responses.iter().any(|response| response.uncertainty().is_some())
            || self.records.iter().any(Record::has_uncertainties)
    }

    /// Number of residuals, and of additional free values of files: gains, offsets, delays.
    pub(super) fn rows(&self) -> [usize; 2] {
        let responses = |of: fn(&Response) -> usize| self.responses.iter().map(of).sum::<usize>();
        let records = |of: fn(&Record) -> usize| self.records.iter().map(of).sum::<usize>();
        [
            self.values.len() + responses(Response::rows) + records(Record::rows),
            responses(Response::own_free_values) + records(Record::own_free_values),
        ]
    }

    /// Root of the sum of squared weights of the residuals.
    pub(super) fn weight(&self) -> f64 {
        let values = self.values.iter().map(|measured| measured.relative().powi(-2));
        let responses = self.responses.iter().map(|response| {
            response.rows() as f64 * response.uncertainty().unwrap_or(1.0).powi(-2)
        });
        let records = self.records.iter().map(Record::weight);
        values.chain(responses).chain(records).sum::<f64>().sqrt()
    }

    /// Records with a delay among the free values.
    pub(super) fn records_with_free_delay(&self) -> impl Iterator<Item = &Record> {
        self.records.iter().filter(|record| record.is_delay_free)
    }

    /// Measured and fitted curves: gain and phase of each response, each channel of a record.
    pub(super) fn overlays(&self, predicted: &Prediction) -> Vec<Overlay> {
        let responses = self.responses.iter().zip(&predicted.responses);
        let responses = responses.flat_map(|(response, fit)| response.overlays(&fit.misfits));
        let records = self.records.iter().zip(&predicted.records);
        responses.chain(records.flat_map(|(record, fit)| record.overlays(fit))).collect()
    }

    /// `ln(prediction/value)` over the relative uncertainty, or over 1 if it is unknown; the responses follow the
    /// values, then the records.
    pub(super) fn residuals(&self, predicted: &Prediction) -> Option<Vec<f64>> {
        let pairs = self.values.iter().zip(&predicted.values);
        let value = |(measured, predicted): (&Measured, &Option<f64>)| {
            Some(libm::log((*predicted)? / measured.value) / measured.relative())
        };
        let responses = self.responses.iter().zip(&predicted.responses);
        let response = |(response, fit): (&Response, &ResponseFit)| {
            let uncertainty = response.uncertainty().unwrap_or(1.0);
            fit.misfits.iter().map(move |misfit| misfit / uncertainty).collect::<Vec<f64>>()
        };
        let mut residuals: Vec<f64> = pairs.map(value).collect::<Option<_>>()?;
        residuals.extend(responses.flat_map(response));
        let records = self.records.iter().zip(&predicted.records);
        residuals.extend(records.flat_map(|(record, fitted)| record.residuals(fitted)));
        residuals.iter().all(|residual| residual.is_finite()).then_some(residuals)
    }
}
