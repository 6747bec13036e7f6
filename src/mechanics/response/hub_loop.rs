//! The equations of a link with a prescribed hub, or with the spring and the damper of a loop at its hub.

use super::modes::{Coordinate, Equations, HubReaction, PrescribedHub};
use crate::modal::{DampingLaw, Shape};
use crate::numeric::SymmetricEigen;

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
    let found = hub_modes(free, f64::INFINITY)?;
    let count = found.len();
    let mut coordinates = vec![Coordinate {
        square: 0.0,
        rate_per_s: 0.0,
        drive: 1.0,
        hub_angle: 1.0,
        tip: rigid.tip / rigid.hub_angle,
    }];
    let mut shapes = vec![free.shapes[0].clone().scaled(rigid.hub_angle.recip())];
    let mut modes: Vec<Vec<f64>> = Vec::with_capacity(count);
    for (number, HubMode { omega_rad_s, mode, .. }) in found.into_iter().enumerate() {
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
    Some(Equations { coordinates, shapes, reaction, damping, drags: None, prescribed })
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
        let own = y[first..].iter().zip(flexible);
        let own: Vec<f64> = own.map(|(y, mode)| omega_rad_s * y / mode.square.sqrt()).collect();
        let turned: f64 = own.iter().zip(flexible).map(|(x, mode)| x * mode.hub_angle).sum();
        let by_spring = of_spring.map_or(0.0, |turn| omega_rad_s * y[0] * turn);
        let rotation = -turned / rigid.hub_angle - by_spring;
        HubMode {
            omega_rad_s,
            mode: std::iter::once(rotation).chain(own).collect(),
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
    use super::*;
    use crate::beam::Mesh;
    use crate::link::{Hub, Link, LinkParts, uniform};
    use crate::modal::ModalBasis;
    use nalgebra::{Complex, DMatrix};

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
