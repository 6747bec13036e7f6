#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share of a number of samples"
)]

use std::f64::consts::PI;

use super::alignment::{Alignment, Freedom, Overlaid, longest_delay, rough_delay};
use super::instruments::{
    Channel, FEWEST, Gain, INPUT, MOST_UNCERTAIN, RecordError, RecordInput, check, is_constant,
    rms, rms_about_mean, with_motor_friction,
};
use crate::beam::Mesh;
use crate::link::Link;
use crate::modal::natural_frequencies;
use crate::model::Sensor;
use crate::numeric::largest;
use crate::response::{Driven, sensed};

/// Noise of a hub angle, over its motion, that a fit may mistake for motion.
const LITTLE_NOISE: f64 = 2e-4;

/// Smallest noise of a channel over its size.
const EXACT: f64 = 1e-12;

/// Share of its largest value above which an input moves the link.
const STIRRING: f64 = 1e-3;

/// Fewest samples of the beginning of a record.
const LEAST_BEGINNING: usize = 32;

/// Order of differences that leaves only the noise of a motion.
const NOISE_ORDER: usize = 8;

/// Factor of differences of this order on the variance of white noise: `C(16, 8)`.
const NOISE_GAIN: f64 = 12_870.0;

/// Number of modes that the mesh of a record follows.
const FOLLOWED_MODES: usize = 30;

/// Recorded histories of a link, driven from rest, at uniform times.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    pub(super) name: String,
    pub(super) step_s: f64,
    driven: Driven,
    motor_friction_n_m_s_rad: f64,
    pub(super) channels: Vec<Channel>,
    /// Root mean square of the samples of each channel, about their mean if an offset is free.
    pub(super) sizes: Vec<f64>,
    /// True if the sensors may be late.
    pub(super) is_delay_free: bool,
    /// Noise of each channel over its size, from a fit, if uncertainties are unknown.
    noise: Option<Vec<f64>>,
}

impl Record {
    /// Checks a record of step `step_s` in s; messages call it `name`.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn new(
        name: String,
        step_s: f64,
        input: RecordInput,
        channels: Vec<Channel>,
        is_delay_free: bool,
    ) -> Result<Self, RecordError> {
        if !(step_s.is_finite() && step_s > 0.0) {
            return Err(RecordError::Step(step_s));
        }
        if channels.is_empty() {
            return Err(RecordError::NoChannel);
        }
        let (driven, motor_friction_n_m_s_rad) = input.driven();
        let (Driven::Torque(driving, _) | Driven::Angle(driving)) = &driven;
        if driving.len() < FEWEST {
            return Err(RecordError::Few(driving.len()));
        }
        check(INPUT, driving, driving.len())?;
        // A torque that begins with the record and stays constant moves the link.
        let is_rest = matches!(driven, Driven::Angle(_)) || driving[0] == 0.0;
        if is_rest && is_constant(driving) {
            return Err(RecordError::Constant { channel: INPUT.to_owned() });
        }
        let mut sizes = Vec::new();
        for channel in &channels {
            let name = channel.sensor.word();
            check(name, &channel.samples, driving.len())?;
            if is_constant(&channel.samples) {
                return Err(RecordError::Constant { channel: name.to_owned() });
            }
            let size = channel.size();
            if let Some(found) = channel.uncertainty
                && !(found > 0.0 && found < MOST_UNCERTAIN * size)
            {
                let (found, most) = (found / channel.unit, MOST_UNCERTAIN * size / channel.unit);
                return Err(RecordError::Uncertainty { channel: name.to_owned(), found, most });
            }
            sizes.push(size);
        }
        let is_known = channels.iter().any(|channel| channel.uncertainty.is_some());
        let unknown = channels.iter().find(|channel| channel.uncertainty.is_none());
        if let Some(channel) = unknown.filter(|_| is_known) {
            return Err(RecordError::Mixed { channel: channel.sensor.word().to_owned() });
        }
        Ok(Self {
            name,
            step_s,
            driven,
            motor_friction_n_m_s_rad,
            channels,
            sizes,
            is_delay_free,
            noise: None,
        })
    }

    /// Name in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Records of the sensors.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// True if the uncertainty of every channel is known.
    pub fn has_uncertainties(&self) -> bool {
        self.channels.iter().all(|channel| channel.uncertainty.is_some())
    }

    /// The link with the friction of the motor that drives it.
    pub(super) fn with_motor_friction(&self, link: &Link) -> Option<Link> {
        with_motor_friction(link, self.motor_friction_n_m_s_rad)
    }

    /// Noise of a hub angle that drives the link, over its motion, if it counts: only noise remains in its eighth
    /// differences.
    pub(super) fn input_noise(&self) -> Option<f64> {
        let Driven::Angle(angle) = &self.driven else { return None };
        if angle.len() <= 2 * NOISE_ORDER {
            return None;
        }
        let differences = (0..NOISE_ORDER).fold(angle.clone(), |samples, _| {
            samples.windows(2).map(|pair| pair[1] - pair[0]).collect()
        });
        let share = rms(&differences) / NOISE_GAIN.sqrt() / rms_about_mean(angle);
        (share > LITTLE_NOISE).then_some(share)
    }

    /// Number of residuals.
    pub(super) fn rows(&self) -> usize {
        self.channels.len() * self.compared()
    }

    /// Longest delay of the search, in samples; 0 without a free delay.
    pub(super) fn longest_delay(&self) -> usize {
        if self.is_delay_free { longest_delay(self.channels[0].samples.len()) } else { 0 }
    }

    /// Number of compared samples.
    pub(super) fn compared(&self) -> usize {
        self.channels[0].samples.len() - self.longest_delay()
    }

    /// Number of additional free values: gains, offsets, the delay.
    pub(super) fn own_free_values(&self) -> usize {
        let own = |channel: &Channel| {
            usize::from(channel.gain == Gain::Free) + usize::from(channel.has_offset)
        };
        self.channels.iter().map(own).sum::<usize>() + usize::from(self.is_delay_free)
    }

    /// Sum of squared weights of the residuals.
    pub(super) fn weight(&self) -> f64 {
        let numbers = 0..self.channels.len();
        numbers.map(|k| self.compared() as f64 * self.uncertainty(k).powi(-2)).sum()
    }

    /// Uncertainty of a channel over its size; if unknown, the noise from a fit, or 1.
    fn uncertainty(&self, channel: usize) -> f64 {
        let shown = self.noise.as_ref().map_or(1.0, |noise| noise[channel]);
        self.channels[channel].uncertainty.map_or(shown, |u| u / self.sizes[channel])
    }

    /// Beginning of the record: a share of the part after the input first moves the link. In few periods a wrong
    /// frequency does not lose count of them.
    pub(super) fn beginning(&self, share: f64) -> Self {
        let (Driven::Torque(input, _) | Driven::Angle(input)) = &self.driven;
        let (first, size) = (input[0], largest(input));
        let moves = |sample: &f64| (sample - first).abs() > STIRRING * size || first != 0.0;
        let rest = input.iter().position(moves).unwrap_or(0);
        let kept = rest + (share * (input.len() - rest) as f64).ceil() as usize;
        let kept = kept.max(LEAST_BEGINNING).min(input.len());
        let input = input[..kept].to_vec();
        let driven = match &self.driven {
            Driven::Torque(_, interpolation) => Driven::Torque(input, *interpolation),
            Driven::Angle(_) => Driven::Angle(input),
        };
        let cut = |channel: &Channel| Channel {
            samples: channel.samples[..kept].to_vec(),
            ..channel.clone()
        };
        Self { driven, channels: self.channels.iter().map(cut).collect(), ..self.clone() }
    }

    /// This record with each channel weighted by the remaining differences of a fit.
    pub(super) fn weighed(&self, alignment: &Alignment) -> Self {
        let shares = alignment.differences.iter().zip(&self.sizes);
        let noise = shares.map(|(differences, size)| (rms(differences) / size).max(EXACT));
        Self { noise: Some(noise.collect()), ..self.clone() }
    }

    /// Highest frequency in rad/s that a mesh must follow.
    pub(super) fn highest_rad_s(&self, mesh: &Mesh) -> f64 {
        let modes = natural_frequencies(mesh, FOLLOWED_MODES);
        let nyquist = PI / self.step_s;
        modes.last().map_or(nyquist, |highest| highest.min(nyquist))
    }

    /// Alignment with the histories of a link, including its motor's friction, at a delay of `delay` samples. `None` if
    /// the link cannot be simulated.
    pub(super) fn fitted(&self, link: &Link, mesh: &Mesh, delay: f64) -> Option<Alignment> {
        let computed = self.computed(link, mesh)?;
        Some(Alignment::of(&self.overlaid(&computed), delay, self.compared()))
    }

    /// The delay in whole samples at which the histories of a link fit the record best.
    pub(super) fn rough_delay(&self, link: &Link, mesh: &Mesh) -> Option<f64> {
        Some(rough_delay(&self.overlaid(&self.computed(link, mesh)?)))
    }

    fn computed(&self, link: &Link, mesh: &Mesh) -> Option<Vec<Vec<f64>>> {
        let sensors: Vec<Sensor> = self.channels.iter().map(|channel| channel.sensor).collect();
        sensed(link, mesh, &self.driven, self.step_s, &sensors).ok()
    }

    fn overlaid<'a>(&'a self, computed: &'a [Vec<f64>]) -> Vec<Overlaid<'a>> {
        let pairs = self.channels.iter().zip(computed).enumerate();
        let overlaid = pairs.map(|(k, (channel, computed))| Overlaid {
            recorded: &channel.samples,
            computed,
            freedom: Freedom { gain: channel.gain, has_offset: channel.has_offset },
            weight: 1.0 / (self.sizes[k] * self.uncertainty(k)),
        });
        overlaid.collect()
    }

    /// Differences over their uncertainties, or over the size of the channel if these are unknown.
    pub(super) fn residuals(&self, alignment: &Alignment) -> Vec<f64> {
        let channels = alignment.differences.iter().enumerate();
        let residuals = channels.flat_map(|(k, differences)| {
            let unit = self.sizes[k] * self.uncertainty(k);
            differences.iter().map(move |difference| difference / unit)
        });
        residuals.collect()
    }
}
