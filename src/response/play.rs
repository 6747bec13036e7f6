use super::feedback::Feedback;
use super::forcing::{Cubic, Interpolation, pieces};
use super::selection::torque_band_rad_s;
use super::simulation::SimulationError;
use super::stepper::Stepper;
use super::torque::Torque;
use crate::numeric::TimeGrid;

/// Most samples that are simulated.
const LONGEST: usize = 1 << 24;

/// What is played on a link that is at rest before.
#[derive(Debug, Clone, Copy)]
pub struct Play<'a> {
    /// The torque at the hub; zero before its first and after its last sample.
    pub torque: &'a Torque,
    /// How it goes on between its samples.
    pub interpolation: Interpolation,
    /// Time in s up to which to go on, free of torque; `None`: to the torque's last sample.
    pub until_s: Option<f64>,
    /// Feedback at the hub, added to the torque.
    pub feedback: Option<&'a Feedback>,
    /// Displacement of the tip before, in m.
    pub initial_tip_m: f64,
    /// Memory in bytes that playing may take; `None`: whatever it needs.
    pub memory_bytes: Option<usize>,
}

impl<'a> Play<'a> {
    /// A torque played to its end, by cubics, without feedback, the tip at 0 before.
    pub fn of(torque: &'a Torque) -> Self {
        Self {
            torque,
            interpolation: Interpolation::default(),
            until_s: None,
            feedback: None,
            initial_tip_m: 0.0,
            memory_bytes: None,
        }
    }

    /// The torque's grid, continued to the end asked for.
    pub(super) fn grid(&self) -> Result<TimeGrid, SimulationError> {
        let grid = self.torque.grid();
        let Some(until_s) = self.until_s else { return Ok(grid) };
        let end_s = grid.end_s();
        let steps = (until_s - end_s) / grid.step_s;
        // An end a hair beside the last sample is that sample.
        if steps.is_nan() || steps < -1e-6 {
            return Err(SimulationError::EndsEarly { until_s, end_s });
        }
        let more = (steps - 1e-6).ceil().max(0.0);
        let samples = grid.len as f64 + more;
        if samples > LONGEST as f64 {
            return Err(SimulationError::TooLong { until_s, samples, limit: LONGEST });
        }
        Ok(TimeGrid { len: samples as usize, ..grid })
    }

    /// Frequency in rad/s above which the link is not driven; none where nothing drives it.
    pub(super) fn band_rad_s(&self) -> Option<f64> {
        let grid = self.torque.grid();
        let torque = torque_band_rad_s(&grid, self.torque.torque_n_m());
        // The reference's rate, unlike its angle, is zero at both ends.
        let wanted = self.feedback.and_then(Feedback::driving_rate_rad_s);
        let wanted = wanted.and_then(|rate| torque_band_rad_s(&grid, &rate));
        torque.into_iter().chain(wanted).reduce(f64::max)
    }

    /// The input of the modal equations at every sample and between.
    ///
    /// # Errors
    /// Feedback with a reference at other times than the torque.
    pub(super) fn driving(&self) -> Result<Driving, SimulationError> {
        let torque = self.torque.torque_n_m();
        let (samples, hold) = match self.feedback {
            None => (torque.to_vec(), 0.0),
            Some(feedback) => {
                let wanted = feedback.wanted_torque_n_m(self.torque)?;
                let samples = torque.iter().zip(wanted).map(|(t, wanted)| t + wanted).collect();
                (samples, feedback.stiffness_n_m_rad() * feedback.turn_rad())
            }
        };
        let pieces = pieces(&samples, self.interpolation);
        Ok(Driving { samples, pieces, hold })
    }
}

/// Input u of the modal equations: the torque and what feedback wants; feedback's answer to the
/// link's own motion is part of the equations.
#[derive(Debug, Clone)]
pub(super) struct Driving {
    samples: Vec<f64>,
    pieces: Vec<Cubic>,
    /// After the last sample.
    hold: f64,
}

impl Driving {
    /// At a sample, also after the torque's last.
    pub(super) fn at(&self, sample: usize) -> f64 {
        self.samples.get(sample).copied().unwrap_or(self.hold)
    }

    /// Over the step that follows a sample.
    pub(super) fn after(&self, sample: usize) -> Cubic {
        self.pieces.get(sample).copied().unwrap_or(self.held())
    }

    /// Over any step after the last sample.
    pub(super) fn held(&self) -> Cubic {
        [self.hold, 0.0, 0.0, 0.0]
    }

    /// Steps from rest through all samples.
    pub(super) fn record(&self, stepper: &mut Stepper, samples: usize) -> Record {
        let numbers = samples * stepper.coordinates().len();
        let mut record =
            Record { coordinates: Vec::with_capacity(numbers), rates: Vec::with_capacity(numbers) };
        for sample in 0..samples {
            if sample > 0 {
                stepper.advance(&self.after(sample - 1));
            }
            record.coordinates.extend(stepper.coordinates());
            record.rates.extend(stepper.rates());
        }
        record
    }
}

/// Modal coordinates and their rates at every sample, one row a sample.
#[derive(Debug, Clone, Default)]
pub(super) struct Record {
    pub(super) coordinates: Vec<f64>,
    pub(super) rates: Vec<f64>,
}
