//! The modes that a torque or a hub moves, and their equations of motion, also with a prescribed hub,
//! or with the spring and the damper of a loop at the hub.

use std::f64::consts::TAU;

use super::losses::Losses;
use crate::beam::Mesh;
use crate::modal::{
    DampingLaw, ModalBasis, Mode, Shape, flexible_modes, modes_below, natural_frequencies,
};
use crate::numeric::{
    FourierPair, SymmetricEigen, TimeGrid, angular_frequency, fast_length, magnitude,
};

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
    /// Losses of a drive under an effort.
    pub(super) losses: Option<Losses>,
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
    fn of_friction(self) -> Self {
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
        Self {
            coordinates,
            shapes,
            reaction,
            damping: None,
            drags: None,
            prescribed: None,
            losses: None,
        }
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

    /// Loss of the drive in N m at an instant, under the input `u`; 0 without losses.
    pub(super) fn loss_n_m(&self, q: &[f64], rate: &[f64], u: f64) -> f64 {
        let Some(losses) = &self.losses else { return 0.0 };
        let lossless = self.hub(&self.accelerations(q, rate, (u, 0.0)));
        let per_torque: f64 = self.coordinates.iter().map(|c| c.hub_angle * c.drive).sum();
        losses.solve(u, [self.hub(rate), 0.0], [lossless, -per_torque])
    }

    /// Damping of a coordinate: Σ c q̇, less the part that turns with the reference.
    fn damped(&self, k: usize, rate: &[f64], turning_rad_s: f64) -> f64 {
        let whole = match &self.damping {
            None => self.coordinates[k].rate_per_s * rate[k],
            Some(damping) => {
                let row = &damping[k * rate.len()..][..rate.len()];
                row.iter().zip(rate).map(|(c, rate)| c * rate).sum()
            }
        };
        whole - self.drags.as_ref().map_or(0.0, |drags| drags[k] * turning_rad_s)
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
        let turning = acceleration[0] + drag_per_s * rate[0];
        let bending = self.bending(acceleration) + drag_per_s * self.bending(rate);
        inertia_kg_m2 * turning + bending + friction_n_m
    }
}

/// Share of the motion above the torque's band.
pub(super) const NEGLIGIBLE: f64 = 1e-12;

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
/// a `share` of the whole motion, see [`NEGLIGIBLE`]. `None` for a torque of zero.
pub(super) fn torque_band_rad_s(grid: &TimeGrid, samples: &[f64], share: f64) -> Option<f64> {
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
        if above > share * whole {
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

/// The equations of the free link with the hub's motion in place of the motor's torque: the coordinates are
/// the hub angle and the modes of the link held at its hub.
///
/// A held mode x is a sum of free modes with a hub angle of 0. The flexible ones are independent; the rigid rotation
/// follows from them, `x₀ = −Σ p_k x_k/p₀`. So the held frequencies ω satisfy
///
/// ```text
/// (1 + p pᵀ/p₀²) x = diag(ω_k²) x/ω²
/// ```
///
/// solved in `y = ω_k x_k` for 1/ω², with the accuracy of the free modes for low frequencies. With X the held modes,
/// mass-normalised, and h = x₀/p₀ their product with the rotation by a unit angle,
///
/// ```text
/// η̈ + D η̇ + diag(ω²) η = −h (θ̈ + α θ̇),    D = Xᵀ diag(c) X
/// T = (θ̈ + α θ̇)/p₀² + hᵀ(η̈ + α η̇) + b θ̇
/// ```
///
/// T is the rate of the whole link's angular momentum, plus friction and drag. Where the ratio of hysteretic damping ξ
/// stands for a viscous one, it applies to the vibrating modes: D = 2ξω.
///
/// The link is rigidly fixed to the hub, without the motor side of a link file's `[drive]`. So `hub.inertia` must
/// include the rotor reflected through the gear, N² J.
///
/// `None` where the numbers are not finite.
pub(super) fn held(free: &Equations, law: &DampingLaw) -> Option<Equations> {
    let rigid = free.coordinates.first()?;
    let held_modes = hub_modes(free, f64::INFINITY)?;
    let count = held_modes.len();
    let mut coordinates = vec![Coordinate {
        square: 0.0,
        rate_per_s: 0.0,
        drive: 1.0,
        hub_angle: 1.0,
        tip: rigid.tip / rigid.hub_angle,
    }];
    let mut shapes = vec![free.shapes[0].clone().scaled(rigid.hub_angle.recip())];
    let mut modes: Vec<Vec<f64>> = Vec::with_capacity(count);
    for (number, HubMode { omega_rad_s, mode, .. }) in held_modes.into_iter().enumerate() {
        coordinates.push(Coordinate {
            square: omega_rad_s * omega_rad_s,
            rate_per_s: 2.0 * law.modal_ratio(number + 1, omega_rad_s) * omega_rad_s,
            drive: -mode[0] / rigid.hub_angle,
            hub_angle: 0.0,
            tip: mode.iter().zip(&free.coordinates).map(|(x, free)| x * free.tip).sum(),
        });
        shapes.push(Shape { hub_angle: 0.0, ..Shape::sum(&mode, &free.shapes) });
        modes.push(mode);
    }
    let drag_per_s = law.mass_rate_per_s();
    let damping = (law.is_modal() || drag_per_s != 0.0).then(|| {
        let size = count + 1;
        let mut damping = vec![0.0; size * size];
        for (i, own) in modes.iter().enumerate() {
            let row = &mut damping[(i + 1) * size..][..size];
            row[0] = -drag_per_s * coordinates[i + 1].drive;
            for (j, other) in modes.iter().enumerate() {
                let rates = free.coordinates.iter().map(|mode| mode.rate_per_s);
                let terms = own.iter().zip(other).zip(rates).map(|((a, b), rate)| rate * a * b);
                row[j + 1] = terms.sum();
            }
        }
        damping
    });
    let prescribed = PrescribedHub { inertia_kg_m2: rigid.hub_angle.powi(-2), drag_per_s };
    let reaction = free.reaction.of_friction();
    let prescribed = Some(prescribed);
    Some(Equations {
        coordinates,
        shapes,
        reaction,
        damping,
        drags: None,
        prescribed,
        losses: None,
    })
}

/// A mode of the link with a spring at its hub.
struct HubMode {
    omega_rad_s: f64,
    /// The mode as a sum of free modes.
    mode: Vec<f64>,
    /// Share of the link in the energy of link and spring.
    link_share: f64,
}

/// The modes of the link with a spring k at its hub, or with a held hub for an infinite spring; the lowest first.
///
/// Solved as in [`held`] for 1/ω² in `y = ω_k x_k`, and in `y₀ = √k pᵀx` of the spring. The square of y is the energy.
/// `None` where the numbers are not finite.
fn hub_modes(free: &Equations, spring_n_m_rad: f64) -> Option<Vec<HubMode>> {
    let [rigid, flexible @ ..] = &free.coordinates[..] else { return None };
    let of_spring = spring_n_m_rad.is_finite().then(|| -spring_n_m_rad.sqrt().recip());
    let of_spring = of_spring.map(|turn| turn / rigid.hub_angle);
    let scaled = |mode: &Coordinate| mode.hub_angle / rigid.hub_angle / mode.square.sqrt();
    // The rigid rotation follows from the others: x₀ = −turnᵀ y.
    let turn: Vec<f64> = of_spring.into_iter().chain(flexible.iter().map(scaled)).collect();
    let (count, first) = (turn.len(), turn.len() - flexible.len());
    let mut matrix = vec![0.0; count * count];
    for i in 0..count {
        for j in 0..=i {
            matrix[i * count + j] = turn[i] * turn[j];
        }
        if i >= first {
            matrix[i * count + i] += flexible[i - first].square.recip();
        }
    }
    let eigen = SymmetricEigen::new(count, matrix)?;
    let mode = |k: usize| {
        let (omega_rad_s, y) = (eigen.values[k].sqrt().recip(), eigen.vector(k));
        let bent = y[first..].iter().zip(flexible);
        let bent: Vec<f64> = bent.map(|(y, mode)| omega_rad_s * y / mode.square.sqrt()).collect();
        let turned: f64 = bent.iter().zip(flexible).map(|(x, mode)| x * mode.hub_angle).sum();
        let by_spring = of_spring.map_or(0.0, |turn| omega_rad_s * y[0] * turn);
        let rotation = -turned / rigid.hub_angle - by_spring;
        HubMode {
            omega_rad_s,
            mode: std::iter::once(rotation).chain(bent).collect(),
            link_share: y[first..].iter().map(|y| y * y).sum(),
        }
    };
    Some((0..count).rev().map(mode).collect())
}

/// Softest relevant spring at the hub, over `I ω₁²`: a softer spring changes every damping ratio by less than this.
const SOFT: f64 = 1e-4;

/// Weight of `(d/(I ω₁))²` in w, see [`HubLoop`].
const DAMPER: f64 = 20.0;

/// Damping of a hysteretic link under feedback. The ratio ξ belongs to the strain of the link, so each mode that
/// vibrates with the spring k of the loop has ξ times the link's share of its energy. A damper d holds the hub, too:
///
/// ```text
/// D = (1 − w) D_loop + w D_held,    w = 20 d²/(20 d² + (I ω₁)²)
/// ```
///
/// with the inertia I about the axis and the first frequency ω₁ of the free hub. The ratios of the first three modes
/// equal those of the complex stiffness, to first order in ξ, for d = 0 and d → ∞, and elsewhere within 9 %. The factor
/// 20 minimises the worst error of many links and gains. `D_held` does not damp a rotation of the unbent link. `D_loop`
/// does, and acts on the motion from the loop's reference.
pub(super) struct HubLoop {
    /// w.
    pub(super) held_share: f64,
    /// k. `None` for a soft spring.
    pub(super) spring_n_m_rad: Option<f64>,
}

impl HubLoop {
    pub(super) fn of(reaction: HubReaction, inertia_kg_m2: f64, omega_rad_s: f64) -> Self {
        let rate_n_m_s_rad = reaction.damping_n_m_s_rad - reaction.friction_n_m_s_rad;
        let rate = rate_n_m_s_rad / inertia_kg_m2 / omega_rad_s;
        let square = DAMPER * rate * rate;
        let soft_n_m_rad = SOFT * inertia_kg_m2 * omega_rad_s * omega_rad_s;
        let spring_n_m_rad = Some(reaction.stiffness_n_m_rad);
        Self {
            held_share: if square.is_finite() { square / (1.0 + square) } else { 1.0 },
            spring_n_m_rad: spring_n_m_rad.filter(|spring| *spring > soft_n_m_rad),
        }
    }
}

/// Damps the modes of the loop where feedback holds the hub of a hysteretic link; keeps other equations unchanged.
pub(super) fn in_loop(mut free: Equations, law: &DampingLaw) -> Equations {
    let DampingLaw::Hysteretic { ratio } = *law else { return free };
    let [rigid, first, ..] = &free.coordinates[..] else { return free };
    let HubLoop { held_share, spring_n_m_rad } =
        HubLoop::of(free.reaction, rigid.hub_angle.powi(-2), first.square.sqrt());
    if ratio == 0.0 || (held_share == 0.0 && spring_n_m_rad.is_none()) {
        return free;
    }
    let count = free.coordinates.len();
    let mut damping = vec![0.0; count * count];
    if spring_n_m_rad.is_none() {
        for (k, coordinate) in free.coordinates.iter().enumerate() {
            damping[k * count + k] = (1.0 - held_share) * coordinate.rate_per_s;
        }
    }
    let mut damp = |rate_per_s: f64, shape: &[f64]| {
        for (own, row) in shape.iter().zip(damping.chunks_exact_mut(count)) {
            let entries = row.iter_mut().zip(shape);
            entries.for_each(|(entry, other)| *entry += rate_per_s * own * other);
        }
    };
    let springs = [(1.0 - held_share, spring_n_m_rad), (held_share, Some(f64::INFINITY))];
    for (part, spring_n_m_rad) in springs {
        let Some(spring_n_m_rad) = spring_n_m_rad.filter(|_| part > 0.0) else { continue };
        let Some(modes) = hub_modes(&free, spring_n_m_rad) else { return free };
        for HubMode { omega_rad_s, mut mode, link_share } in modes {
            if spring_n_m_rad.is_infinite() {
                // The coordinate of the held mode: the rotation with the hub bends nothing.
                let follows = mode[0] / rigid.hub_angle;
                let pairs = mode.iter_mut().zip(&free.coordinates);
                pairs.for_each(|(x, free)| *x -= follows * free.hub_angle);
                mode[0] = 0.0;
            }
            // Round-off removes the frequency of modes far above a soft loop.
            if omega_rad_s.is_finite() {
                damp(part * 2.0 * ratio * link_share * omega_rad_s, &mode);
            }
        }
    }
    let drags = damping.iter().step_by(count).map(|rate| rate / rigid.hub_angle);
    free.drags = Some(drags.collect());
    free.damping = Some(damping);
    free
}

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, DMatrix};

    use super::*;
    use crate::beam::Mesh;
    use crate::link::{Hub, Link, LinkParts, uniform};
    use crate::modal::ModalBasis;

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
        torque_band_rad_s(&grid, &samples, NEGLIGIBLE).unwrap()
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
        assert_eq!(torque_band_rad_s(&pulse(9, 0.1, 0.0).0, &[0.0; 28], NEGLIGIBLE), None);
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

    /// Eigenvalues of vibrations in state space, the slowest first: of these equations, or of the complex stiffness of a link
    /// with this ratio and the same spring and damper at its hub.
    fn vibrations(equations: &Equations, hysteretic: Option<f64>) -> Vec<Complex<f64>> {
        let Equations { coordinates, reaction, damping, .. } = equations;
        let count = coordinates.len();
        let matrix = DMatrix::from_fn(2 * count, 2 * count, |row, column| {
            if row < count {
                return Complex::from(f64::from(column == row + count));
            }
            let (i, j) = (row - count, column % count);
            let hub = coordinates[i].hub_angle * coordinates[j].hub_angle;
            let alone = |value: f64| if i == j { value } else { 0.0 };
            if column < count {
                let loss = 2.0 * hysteretic.unwrap_or(0.0);
                let own = Complex::new(1.0, loss) * alone(coordinates[i].square);
                return -own - hub * reaction.stiffness_n_m_rad;
            }
            let rate_per_s = match (hysteretic, damping) {
                (Some(_), _) => 0.0,
                (None, Some(damping)) => damping[i * count + j],
                (None, None) => alone(coordinates[i].rate_per_s),
            };
            Complex::from(-rate_per_s - hub * reaction.damping_n_m_s_rad)
        });
        let all = matrix.schur().eigenvalues().unwrap();
        let mut all: Vec<_> = all.iter().copied().filter(|s| s.im > 1e-3 * s.norm()).collect();
        all.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        all
    }

    /// Springs and dampers at the hub from soft to stiff. The first number is the worst of loops without a damper.
    #[test]
    fn modes_of_a_loop_have_the_damping_ratios_of_the_complex_stiffness() {
        let mut worst = [0.0_f64; 2];
        for inertia_kg_m2 in [0.02, 0.1, 1.0] {
            let law = DampingLaw::Hysteretic { ratio: 0.02 };
            let hub = Hub { inertia_kg_m2, ..Hub::default() };
            let link = Link::new(LinkParts { hub, ..uniform() }).unwrap();
            let mesh = Mesh::on(&link, 20);
            let on_hub = |reaction: HubReaction| {
                Equations::new(&mesh, &law, ModalBasis::lowest(&mesh, 12), reaction)
            };
            let free = on_hub(HubReaction::default());
            let (omega, inertia) =
                (free.coordinates[1].square.sqrt(), free.coordinates[0].hub_angle.powi(-2));
            for spring in [0.01, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0] {
                for damper in [0.0, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0] {
                    let free = on_hub(HubReaction {
                        stiffness_n_m_rad: spring * inertia * omega * omega,
                        damping_n_m_s_rad: damper * inertia * omega,
                        friction_n_m_s_rad: 0.0,
                    });
                    let expected = vibrations(&free, Some(0.02));
                    let found = vibrations(&in_loop(free, &law), None);
                    let ratio = |s: &Complex<f64>| -s.re / s.norm();
                    for mode in expected.iter().take(3).filter(|s| ratio(s) < 0.7) {
                        let apart = |s: &Complex<f64>| (s - mode).norm();
                        let own = found.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
                        let off = (ratio(own.unwrap()) / ratio(mode) - 1.0).abs();
                        let worst = &mut worst[usize::from(damper > 0.0)];
                        *worst = worst.max(off);
                    }
                }
            }
        }
        assert!(worst[0] < 0.01 && (0.02..0.09).contains(&worst[1]), "{worst:?}");
    }
}
