use std::borrow::Cow;
use std::f64::consts::TAU;
use std::sync::Arc;

use super::accuracy::Accuracy;
use super::analysis::{Analysis, Unwatched};
use super::bent_answer::{Bent, SecondOrderFindings};
use super::curves::size;
use super::histories::{HubMotion, MotorHistories, cut, tip_deflection_m};
use super::spectra::{DrivenModel, HubSpectra};
use super::warning::Warning;
use crate::beam::Mesh;
use crate::link::Link;
use crate::modal::{DampingLaw, natural_frequencies, torque_zeros};
use crate::model::Model;
use crate::motion::{Ends, TailTerms, TipMotion, TipMotionHistories, TipPeriod, TipSpectrum};
use crate::numeric::TimeGrid;

/// Frequencies that were solved for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Period P in s.
    pub period_s: f64,
    /// Samples of the period: the length of the Fourier transform.
    pub fft_length: usize,
    /// Frequencies solved for, zero included.
    pub frequencies: usize,
    /// The highest of them in Hz.
    pub highest_hz: f64,
    /// Frequency in Hz up to which the motion is followed as it is, and from which it rolls off; none
    /// where every frequency of the samples is solved for.
    pub cutoff_hz: Option<f64>,
    /// Nyquist frequency in Hz.
    pub nyquist_hz: f64,
}

impl Band {
    pub(super) fn of(spectrum: &TipSpectrum, frequencies: usize) -> Self {
        let hertz = |k: usize| spectrum.omegas_rad_s[k] / TAU;
        Self {
            period_s: spectrum.period_s(),
            fft_length: spectrum.pair.len(),
            frequencies,
            highest_hz: hertz(frequencies - 1),
            cutoff_hz: (!spectrum.cutoff.keeps_all()).then(|| spectrum.cutoff.omega_rad_s / TAU),
            nyquist_hz: hertz(spectrum.pair.len() / 2),
        }
    }
}

/// What the hub must do so that the tip moves as wanted, with the link, the motion and the analysis.
///
/// All histories are samples on [`Solution::grid`], the trajectory's samples with lead and lag added
/// where its own rest is too short.
#[derive(Clone)]
pub struct Solution {
    /// The link on the mesh that the answer was computed on.
    pub model: Arc<dyn Model>,
    /// The wanted motion.
    pub motion: TipMotion,
    /// How exact the answer was to be.
    pub analysis: Analysis,
    /// Times of all histories.
    pub grid: TimeGrid,
    /// Torque T at the hub in N m.
    pub torque_n_m: Vec<f64>,
    /// Torque in N m that the same link would need, were it rigid.
    pub rigid_torque_n_m: Vec<f64>,
    /// Hub angle θ in rad.
    pub hub_angle_rad: Vec<f64>,
    /// Hub rate in rad/s.
    pub hub_rate_rad_s: Vec<f64>,
    /// Hub angle in rad of the rigid link, `v_tip/L`.
    pub rigid_hub_angle_rad: Vec<f64>,
    /// Moment in N m that the hub exerts on the link's root.
    pub root_moment_n_m: Vec<f64>,
    /// Motion of the tip.
    pub tip: TipMotionHistories,
    /// What the motor does; none for a link without a drive.
    pub motor: Option<MotorHistories>,
    /// Numbers of the grid's samples between which the tip moves: the last at rest before the
    /// motion and the first at rest after it.
    pub moving: (usize, usize),
    /// First zero of torque → tip in 1/s; none where the mesh has none.
    pub first_zero_per_s: Option<f64>,
    /// How exact each quantity is.
    pub accuracy: Accuracy,
    /// Frequencies that were solved for.
    pub band: Band,
    /// What the user must know.
    pub warnings: Vec<Warning>,
    /// Amplitudes at the hub over the band.
    pub(super) hub: HubSpectra,
    pub(super) period: Arc<TipPeriod>,
    /// The hub angle's slow tail, where damping leaves one.
    pub(super) hub_tail: Option<TailTerms>,
    /// Where the nodes of a link under gravity, or with second-order terms, are.
    pub(super) bent: Option<Arc<Bent>>,
}

impl Solution {
    pub(super) fn driven(&self) -> DrivenModel<'_> {
        DrivenModel { model: &*self.model, period: &self.period, watch: &Unwatched }
    }

    /// The link.
    pub fn link(&self) -> &Link {
        self.model.link()
    }

    /// The mesh that the answer was computed on.
    pub fn mesh(&self) -> &Mesh {
        self.model.mesh()
    }

    /// The damping law with all its numbers.
    pub fn law(&self) -> &DampingLaw {
        self.model.law()
    }

    /// The first `count` natural frequencies in rad/s, the rigid rotation left out.
    pub fn natural_frequencies_rad_s(&self, count: usize) -> Vec<f64> {
        natural_frequencies(self.mesh(), count)
    }

    /// The first `count` zeros of torque → tip in 1/s.
    pub fn zeros_per_s(&self, count: usize) -> Vec<f64> {
        torque_zeros(self.mesh(), count)
    }

    /// Hub acceleration in rad/s², computed by each call: most solutions are read without it.
    pub fn hub_acceleration_rad_s2(&self) -> Vec<f64> {
        let per_length = 1.0 / self.mesh().length_m();
        let hub = HubMotion { period: &self.period, tail: self.hub_tail, per_length };
        let spectrum = &self.period.spectrum;
        let excess = spectrum.pair.samples(spectrum.derivative(&self.hub.excess_angle_rad, 2));
        hub.on(&self.grid, &excess, &self.tip.acceleration_m_s2, 2)
    }

    /// How far the tip moves from where it starts, in m: of one that moves before its motion and after it, within that.
    pub fn tip_travel_m(&self) -> f64 {
        match self.motion.ends() {
            Ends::Moving => self.period.histories.largest_travel_m(),
            _ => self.tip.largest_travel_m(),
        }
    }

    /// What was found of the second order, where gravity acts or it was asked for.
    pub fn second_order(&self) -> Option<&SecondOrderFindings> {
        self.bent.as_deref().map(|bent| &bent.findings)
    }

    /// What errors of a history are a share of: its peak or, with gravity, its largest value less its smallest.
    pub fn size_of(&self, history: &[f64]) -> f64 {
        size(history, self.link().has_weight())
    }

    /// How far the line has turned that displacements of the nodes are counted along: the hub's tangent line or, of a
    /// bent link, the chord.
    pub(super) fn turned_rad(&self) -> Cow<'_, [f64]> {
        if self.bent.is_none() {
            return Cow::Borrowed(&self.hub_angle_rad);
        }
        let length_m = self.mesh().length_m();
        self.tip.displacement_m.iter().map(|m| m / length_m).collect()
    }

    /// Deflection of the tip from the hub's tangent line, `v_tip − Lθ`, in m.
    pub fn tip_deflection_m(&self) -> Vec<f64> {
        if let Some(bent) = &self.bent {
            return bent
                .shape
                .deflections_m
                .last()
                .map_or_else(Vec::new, |tip| cut(tip, &self.grid));
        }
        let length_m = self.mesh().length_m();
        tip_deflection_m(&self.rigid_hub_angle_rad, &self.hub_angle_rad, length_m)
    }
}
