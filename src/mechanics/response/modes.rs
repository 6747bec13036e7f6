//! The modes that a torque or a hub moves, and their equations of motion, also on a prescribed hub.

use std::f64::consts::TAU;

use crate::beam::Mesh;
use crate::modal::{
    DampingLaw, ModalBasis, Mode, Shape, flexible_modes, modes_below, natural_frequencies,
};
use crate::numeric::{FourierPair, TimeGrid, angular_frequency, fast_length, magnitude};

/// One modal coordinate: `q̈ + c q̇ + ω² q = p u`, u the torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coordinate {
    /// ω² in rad²/s²; 0 for the rigid rotation.
    pub(super) square: f64,
    /// c = 2ζω in 1/s.
    pub(super) rate_per_s: f64,
    /// p of the input.
    pub(super) drive: f64,
    /// The shape's hub angle: p of a torque.
    pub(super) hub_angle: f64,
    /// The shape's displacement of the tip.
    pub(super) tip: f64,
}

/// Friction and feedback at the hub, in proportion to its motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[expect(clippy::struct_field_names, reason = "units")]
pub(super) struct HubReaction {
    /// Torque per hub angle in N m/rad.
    pub(super) stiffness_n_m_rad: f64,
    /// Torque per hub rate in N m s/rad, friction included.
    pub(super) damping_n_m_s_rad: f64,
    /// Torque of the hub's friction per hub rate in N m s/rad.
    pub(super) friction_n_m_s_rad: f64,
}

/// The link in modal coordinates (Bayo 1987, eqs 11 and 12): rigid rotation first.
///
/// ```text
/// q̈ + C (q̇ − x₀ Ω) + diag(ω²) q + p (k pᵀq + d pᵀq̇) = p u
/// ```
///
/// C is diag(2ζω), or that of a loop. x₀ is the rigid rotation by a unit angle, and Ω the rate of the loop's reference.
#[derive(Debug, Clone)]
pub(super) struct Equations {
    pub(super) coordinates: Vec<Coordinate>,
    pub(super) shapes: Vec<Shape>,
    pub(super) reaction: HubReaction,
    /// Damping between the coordinates in 1/s, row by row. `None`: each coordinate has a separate rate.
    pub(super) damping: Option<Vec<f64>>,
    /// `C x₀` in a loop: the damping turns with the reference.
    pub(super) drags: Option<Vec<f64>>,
    /// Set for a prescribed hub, with its acceleration as u.
    pub(super) prescribed: Option<PrescribedHub>,
}

/// Properties of the link for the torque of a prescribed hub.
#[derive(Debug, Clone, Copy)]
pub(super) struct PrescribedHub {
    /// Rigid inertia about the axis in kg m².
    pub(super) inertia_kg_m2: f64,
    /// Drag α of the damping law on every mass in 1/s.
    pub(super) drag_per_s: f64,
}

impl HubReaction {
    /// The friction alone: a prescribed motion does not include it.
    pub(super) fn of_friction(self) -> Self {
        Self { friction_n_m_s_rad: self.friction_n_m_s_rad, ..Self::default() }
    }

    /// Torque in N m that opposes a motion.
    pub(super) fn torque_n_m(&self, hub_angle: f64, hub_rate: f64) -> f64 {
        self.stiffness_n_m_rad * hub_angle + self.damping_n_m_s_rad * hub_rate
    }
}

impl Equations {
    /// The rigid rotation, the modes of a basis, and the residual mode for all others.
    pub(super) fn new(
        mesh: &Mesh,
        law: &DampingLaw,
        basis: ModalBasis,
        reaction: HubReaction,
    ) -> Self {
        let rest = basis.residual_mode(mesh);
        let coordinate = |square: f64, rate_per_s: f64, shape: &Shape| {
            let (hub_angle, tip) = (shape.hub_angle, shape.tip_displacement(mesh));
            Coordinate { square, rate_per_s, drive: hub_angle, hub_angle, tip }
        };
        let mut coordinates = vec![coordinate(0.0, law.mass_rate_per_s(), &basis.rigid)];
        let mut shapes = vec![basis.rigid];
        for (k, Mode { omega_rad_s, shape }) in basis.modes.into_iter().chain(rest).enumerate() {
            let rate_per_s = 2.0 * law.modal_ratio(k + 1, omega_rad_s) * omega_rad_s;
            coordinates.push(coordinate(omega_rad_s * omega_rad_s, rate_per_s, &shape));
            shapes.push(shape);
        }
        Self { coordinates, shapes, reaction, damping: None, drags: None, prescribed: None }
    }

    /// Period of the first flexible mode in s.
    pub(super) fn first_period_s(&self) -> Option<f64> {
        self.coordinates.get(1).map(|mode| TAU / mode.square.sqrt())
    }

    /// Hub angle from coordinates, or hub rate from their rates.
    pub(super) fn hub(&self, q: &[f64]) -> f64 {
        q.iter().zip(&self.coordinates).map(|(q, c)| q * c.hub_angle).sum()
    }

    /// Displacement of the tip from coordinates, or its velocity from their rates.
    pub(super) fn tip(&self, q: &[f64]) -> f64 {
        q.iter().zip(&self.coordinates).map(|(q, c)| q * c.tip).sum()
    }

    /// Accelerations of the coordinates under the input `u`, the reference turning at a rate in rad/s.
    pub(super) fn accelerations(
        &self,
        q: &[f64],
        rate: &[f64],
        (u, turning_rad_s): (f64, f64),
    ) -> Vec<f64> {
        let net = u - self.reaction.torque_n_m(self.hub(q), self.hub(rate));
        let own = |k: usize| {
            let Coordinate { square, drive, .. } = self.coordinates[k];
            drive * net - self.damped(k, rate, turning_rad_s) - square * q[k]
        };
        (0..q.len()).map(own).collect()
    }

    /// Damping of a coordinate: Σ c q̇, less the part that turns with the reference.
    fn damped(&self, k: usize, rate: &[f64], turning_rad_s: f64) -> f64 {
        let own = match &self.damping {
            None => self.coordinates[k].rate_per_s * rate[k],
            Some(damping) => {
                let row = &damping[k * rate.len()..][..rate.len()];
                row.iter().zip(rate).map(|(c, rate)| c * rate).sum()
            }
        };
        own - self.drags.as_ref().map_or(0.0, |drags| drags[k] * turning_rad_s)
    }

    /// Power that damping and drag dissipate at these rates in W, the reference turning at a rate in rad/s.
    pub(super) fn damped_w(&self, rate: &[f64], turning_rad_s: f64) -> f64 {
        let own = |k: usize| rate[k] * self.damped(k, rate, turning_rad_s);
        let damped: f64 = (0..rate.len()).map(own).sum();
        let Some(PrescribedHub { inertia_kg_m2, drag_per_s }) = self.prescribed else {
            return damped;
        };
        // Drag takes angular momentum from the hub, too.
        let momentum = inertia_kg_m2 * rate[0] + self.bending(rate);
        damped + drag_per_s * momentum * rate[0]
    }

    /// Product of flexible coordinates with the rotation by a unit angle, for a prescribed hub.
    fn bending(&self, coordinates: &[f64]) -> f64 {
        let flexible = coordinates.iter().zip(&self.coordinates).skip(1);
        flexible.map(|(x, mode)| -mode.drive * x).sum()
    }

    /// Torque of the motor in N m at coordinates, rates and accelerations under the input `u`.
    pub(super) fn motor_n_m(&self, q: &[f64], rate: &[f64], acceleration: &[f64], u: f64) -> f64 {
        let (reaction, hub_rate) = (self.reaction, self.hub(rate));
        let friction_n_m = reaction.friction_n_m_s_rad * hub_rate;
        let Some(PrescribedHub { inertia_kg_m2, drag_per_s }) = self.prescribed else {
            // Friction acts on the hub; the rest of the reaction is the motor's.
            return u - (reaction.torque_n_m(self.hub(q), hub_rate) - friction_n_m);
        };
        let own = acceleration[0] + drag_per_s * rate[0];
        let bending = self.bending(acceleration) + drag_per_s * self.bending(rate);
        inertia_kg_m2 * own + bending + friction_n_m
    }
}

/// Share of the motion above the torque's band.
const NEGLIGIBLE: f64 = 1e-12;

/// Highest frequency of kept modes, over the band. Higher modes follow the torque statically to within (1/factor)² of
/// their small share, as does the residual mode in their place.
pub(super) const REACH: f64 = 4.0;

/// Least band in first natural frequencies: jumps, and corners between the samples, have higher frequencies than the
/// samples show.
const LEAST_BAND: f64 = 10.0;

/// Most kept modes.
pub(super) const MOST_MODES: usize = 500;

/// The modes that a torque excites.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeSelection {
    /// Flexible modes kept; one residual mode stands for the others.
    pub modes: usize,
    /// Flexible modes of the mesh.
    pub of: usize,
    /// Frequency in Hz above which the torque moves a rigid link by less than a share of 1e-12.
    pub torque_band_hz: f64,
    /// Frequency in Hz of the highest kept mode.
    pub highest_hz: f64,
}

/// Frequency in rad/s above which a torque of these samples hardly moves a link.
///
/// An amplitude T̂ moves a rigid link by T̂/(Iω²). Sums these from the Nyquist frequency down until the sum exceeds
/// [`NEGLIGIBLE`] times the whole motion. `None` for a torque of zero.
pub(super) fn torque_band_rad_s(grid: &TimeGrid, samples: &[f64]) -> Option<f64> {
    let whole = largest_excursion(samples) * grid.step_s.powi(2);
    if whole == 0.0 {
        return None;
    }
    let len = fast_length(2 * grid.len);
    let pair = FourierPair::new(len);
    let mut padded = samples.to_vec();
    padded.resize(len, 0.0);
    let amplitudes = pair.amplitudes(padded);
    let omega = |k: usize| angular_frequency(k, len, grid.step_s);
    let mut above = 0.0;
    for k in (1..amplitudes.len()).rev() {
        above += 2.0 * magnitude(amplitudes[k]) / omega(k).powi(2);
        if above > NEGLIGIBLE * whole {
            return Some(omega(k));
        }
    }
    Some(omega(1))
}

/// Largest |∬ T dt dt| over the squared step.
fn largest_excursion(samples: &[f64]) -> f64 {
    let (mut rate, mut angle, mut largest) = (0.0, 0.0, 0.0_f64);
    for torque in samples {
        rate += torque;
        angle += rate;
        largest = largest.max(angle.abs());
    }
    largest
}

/// The modes of `mesh` that a torque of this band excites, at most `most_modes`.
pub(super) fn kept_modes(
    mesh: &Mesh,
    band_rad_s: f64,
    most_modes: usize,
) -> (ModalBasis, ModeSelection) {
    // The rigid rotation is below every frequency.
    let least = natural_frequencies(mesh, 1).first().map_or(0.0, |first| LEAST_BAND * first);
    let reach = REACH * band_rad_s.max(least);
    let wanted = modes_below(mesh, reach).saturating_sub(1).clamp(1, most_modes);
    let basis = ModalBasis::lowest(mesh, wanted);
    let highest = basis.modes.last().map_or(0.0, |mode| mode.omega_rad_s);
    let selection = ModeSelection {
        modes: basis.modes.len(),
        of: flexible_modes(mesh),
        torque_band_hz: band_rad_s / TAU,
        highest_hz: highest / TAU,
    };
    (basis, selection)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pulse sin⁸ of `steps` steps and a peak of `torque_n_m`, with rest of equal length on both sides.
    fn pulse(steps: u32, step_s: f64, torque_n_m: f64) -> (TimeGrid, Vec<f64>) {
        let steps_s: Vec<f64> = (0..=3 * steps).map(|k| step_s * f64::from(k)).collect();
        let at = |k: u32| {
            let phase =
                std::f64::consts::PI * f64::from(k) / f64::from(steps) - std::f64::consts::PI;
            if (steps..2 * steps).contains(&k) { torque_n_m * phase.sin().powi(8) } else { 0.0 }
        };
        (TimeGrid::through(&steps_s).unwrap(), (0..=3 * steps).map(at).collect())
    }

    fn band_rad_s(steps: u32, step_s: f64, torque_n_m: f64) -> f64 {
        let (grid, samples) = pulse(steps, step_s, torque_n_m);
        torque_band_rad_s(&grid, &samples).unwrap()
    }

    #[test]
    fn the_band_of_a_torque_is_per_unit_of_time_and_has_nothing_to_do_with_its_size() {
        let band = band_rad_s(200, 0.01, 1.0);
        for (step_s, torque_n_m) in [(0.01, 1e3), (0.01, 1e-3), (0.01, -1.0)] {
            assert_eq!(band_rad_s(200, step_s, torque_n_m).to_bits(), band.to_bits());
        }
        for faster in [4096.0, 1.0 / 4096.0] {
            let found = band_rad_s(200, 0.01 / faster, 1.0);
            assert!((found / (band * faster) - 1.0).abs() < 1e-12, "{found} is not {band} times");
        }
        assert_eq!(torque_band_rad_s(&pulse(9, 0.1, 0.0).0, &[0.0; 28]), None);
    }

    /// sin⁸ over T has seven continuous derivatives. From a few times 2π/T on its spectrum falls as ω⁻⁹, and the motion
    /// as ω⁻¹¹, down to 1e-12 at some tens of times 2π/T.
    #[test]
    fn samples_beyond_what_a_smooth_torque_needs_do_not_change_its_band() {
        let bands = [400, 800, 1600].map(|steps| band_rad_s(steps, 2.0 / f64::from(steps), 1.0));
        for band in bands {
            assert!((band / bands[0] - 1.0).abs() < 0.01, "{bands:?}");
        }
        assert!(
            (10.0..100.0).contains(&(band_rad_s(400, 2.0 / 400.0, 1.0) / std::f64::consts::PI))
        );
    }
}
