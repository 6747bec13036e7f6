//! Modes of a link with gravity along it: small motions about its straight shape, by dense algebra.
//!
//! A deflection w lowers each point by `∫ w'²/2`, so that gravity adds to the stiffness
//!
//! ```text
//! K_g = ∫ N v'² ds,   N(s) = g_e ∫ m̄ ds outboard of s,
//! ```
//!
//! with `g_e`, the gravity outward along the link. `K_g` is also the entire stiffness of a pendulum.

use nalgebra::{DMatrix, DVector, Matrix2, Matrix4, Vector2, Vector4};
use num_complex::Complex64;
use rayon::prelude::*;

use super::frequencies::{
    SCAN_RANGE, changes, held_frequencies, natural_frequencies, real_frequency_zeros, scan_start,
    torque_zeros,
};
use super::shape::Shape;
use crate::beam::{Element, Inertia, LoadedMotion, Loads, Mesh};
use crate::numeric::{SECTIONS, SymmetricEigen};

/// Largest number of elements for a computation of all modes at once.
pub const MOST_ELEMENTS_OF_A_POSE: usize = 256;

/// Largest number of elements for which the reported modes and zeros of a link that keeps its direction have its weight.
const MOST_ELEMENTS_OF_REPORTED: usize = 64;

/// Steps of the search for a buckling weight, for half of the digits.
const SHARE_STEPS: usize = 40;

/// Places and weights of the four Gauss-Legendre points in (0, 1).
const POINTS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Restraint of a hub in its modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PoseHub {
    /// No restraint: the hub is free.
    Free,
    /// A spring of this stiffness in N m/rad; infinite for a clamped hub.
    Spring(f64),
}

impl PoseHub {
    /// The first `count` natural frequencies in rad/s without gravity and without the rigid rotation; fewer if the mesh
    /// has fewer.
    pub fn frequencies(self, mesh: &Mesh, count: usize) -> Vec<f64> {
        match self {
            Self::Free => natural_frequencies(mesh, count),
            Self::Spring(stiffness_n_m_rad) => held_frequencies(mesh, stiffness_n_m_rad, count),
        }
    }
}

/// Squares ω² in 1/s² of the first `count` natural frequencies of a link with gravity `outward_m_s2` along it,
/// ascending, and the mass-normalised shape of each mode. The swing of a free hub is the first. A negative square means
/// that the link leaves its pose as e^{√(−ω²) t}. In each mode a free hub turns counterclockwise; with a clamped hub the
/// tip moves counterclockwise.
///
/// `None` for more than [`MOST_ELEMENTS_OF_A_POSE`] elements, or if a motion moves no mass.
pub fn pose_modes(
    mesh: &Mesh,
    outward_m_s2: f64,
    hub: PoseHub,
    count: usize,
) -> Option<Vec<(f64, Shape)>> {
    let nodes = mesh.nodes_m().len();
    if nodes > MOST_ELEMENTS_OF_A_POSE + 1 {
        return None;
    }
    let [mut mass, mut stiffness] = on_joint(mesh, outward_m_s2);
    let is_clamped = hub == PoseHub::Spring(f64::INFINITY);
    match hub {
        PoseHub::Spring(spring_n_m_rad) if spring_n_m_rad.is_finite() => {
            stiffness[(0, 0)] += spring_n_m_rad;
        }
        PoseHub::Spring(_) => {
            [mass, stiffness] = [mass, stiffness].map(|all| all.remove_row(0).remove_column(0));
        }
        PoseHub::Free => {}
    }
    let lower = mass.cholesky()?.unpack();
    let eigen = SymmetricEigen::over(&lower, &stiffness)?;
    let upper = lower.transpose();
    let mode = |k: usize| {
        let x = upper.solve_upper_triangular(&DVector::from_column_slice(eigen.vector(k)))?;
        let (hub_angle, outer) = if is_clamped { (0.0, 0) } else { (x[0], 1) };
        let shape = shape_of(mesh, hub_angle, &x.as_slice()[outer..]);
        let leading = if is_clamped { shape.displacement(mesh, nodes - 1) } else { hub_angle };
        Some((eigen.values[k], shape.scaled(1.0_f64.copysign(leading))))
    };
    (0..eigen.values.len().min(count)).map(mode).collect()
}

/// The shape of a hub angle and of the coordinates of [`on_joint`] after it.
fn shape_of(mesh: &Mesh, hub_angle: f64, outer: &[f64]) -> Shape {
    let [root, turn] = mesh.rigid(0).map(|part| part * hub_angle);
    // Both nodes of a spring lie at the root.
    let springs = mesh.springs();
    let at_root = std::iter::once([root, turn]).chain((0..springs).map(|k| [root, outer[k]]));
    let beyond = outer[springs..].chunks_exact(2).map(|pair| [pair[0], pair[1]]);
    let deflections = at_root.chain(beyond).enumerate().map(|(node, [v, phi])| {
        let [rigid_v, rigid_phi] = mesh.rigid(node).map(|part| part * hub_angle);
        Vector2::new(v - rigid_v, phi - rigid_phi)
    });
    Shape { hub_angle, deflections: deflections.collect() }
}

/// Bending moment at the root per coordinate (w, w') of the nodes that a weight `outward_m_s2` along the link adds to the
/// one of its inertia.
pub(crate) fn root_pull(mesh: &Mesh, outward_m_s2: f64) -> Vec<f64> {
    let [_, weight] = assembled(mesh, (0.0, outward_m_s2));
    weight.row(2 * mesh.springs() + 1).iter().copied().collect()
}

/// Mass and stiffness on the joint's position and on (v, φ) of nodes 1 … n; on φ alone of the outer node of a spring at the
/// root, which moves with the root.
fn on_joint(mesh: &Mesh, outward_m_s2: f64) -> [DMatrix<f64>; 2] {
    let [mut mass, stiffness] = assembled(mesh, (1.0, outward_m_s2)).map(|full| {
        let full = if mesh.springs() > 0 { with_outer_on_root(full) } else { full };
        with_root_on_joint(full, mesh.rigid(0))
    });
    mass[(0, 0)] += mesh.joint().inertia();
    [mass, stiffness]
}

/// Zeros of the effort → output of a link with gravity `outward_m_s2` along it: the first `count` real ones in 1/s, and
/// those at real frequencies below `limit_rad_s`, in rad/s.
///
/// At a zero an effort at the joint alone leaves the output at rest: the matrix `K − λM` without the row of the joint
/// and the column of the output is singular. `None` for more than [`MOST_ELEMENTS_OF_A_POSE`] elements.
pub fn pose_zeros(
    mesh: &Mesh,
    outward_m_s2: f64,
    count: usize,
    limit_rad_s: f64,
) -> Option<[Vec<f64>; 2]> {
    if mesh.elements().len() > MOST_ELEMENTS_OF_A_POSE {
        return None;
    }
    let output = 2 * mesh.output() - 1 - mesh.springs();
    let [mass, stiffness] =
        on_joint(mesh, outward_m_s2).map(|all| all.remove_row(0).remove_column(output));
    let determinant = |lambda: f64| {
        let factors = (&stiffness - &mass * lambda).lu();
        let (sign, pivots) = (factors.p().determinant::<f64>(), factors.u().diagonal());
        pivots.iter().fold((sign, 0.0), |(sign, log), pivot| {
            (sign * pivot.signum(), log + libm::log(pivot.abs()))
        })
    };
    let start = scan_start(mesh)?;
    let (_, size) = determinant(start * start);
    // The determinant over its size at the start of the scan, within the range of numbers.
    let over = |lambda: f64| {
        let (sign, log) = determinant(lambda);
        sign * libm::exp((log - size).clamp(-600.0, 600.0))
    };
    let at = |of: f64| move |places: &[f64; SECTIONS]| places.map(|place| over(of * place * place));
    Some([
        changes(start, start * SCAN_RANGE, count, at(-1.0)),
        changes(start, limit_rad_s, usize::MAX, at(1.0)),
    ])
}

/// Whether [`reported_frequencies`] and [`reported_zeros`] of a link with gravity `outward_m_s2` along it have its weight:
/// on meshes of up to 64 elements.
pub fn reports_weight(mesh: &Mesh, outward_m_s2: Option<f64>) -> bool {
    outward_m_s2.is_some() && mesh.elements().len() <= MOST_ELEMENTS_OF_REPORTED
}

/// The first `count` natural frequencies in rad/s of a link with a free joint, without its rigid motion. `outward_m_s2` is
/// gravity along a link that keeps its direction. NaN for a mode that does not vibrate, because its weight buckles the link.
pub fn reported_frequencies(mesh: &Mesh, outward_m_s2: Option<f64>, count: usize) -> Vec<f64> {
    let weighed = outward_m_s2.filter(|_| reports_weight(mesh, outward_m_s2));
    let modes = weighed.and_then(|own| pose_modes(mesh, own, PoseHub::Free, count + 1));
    let Some(modes) = modes else { return natural_frequencies(mesh, count) };
    let mut squares: Vec<f64> = modes.into_iter().map(|(square, _)| square).collect();
    // Weight does not drive the motion of the whole link.
    let rigid = (0..squares.len()).min_by(|a, b| squares[*a].abs().total_cmp(&squares[*b].abs()));
    rigid.map(|rigid| squares.remove(rigid));
    squares.into_iter().map(f64::sqrt).collect()
}

/// The first `count` zeros of the effort → output in 1/s, like [`reported_frequencies`].
pub fn reported_zeros(mesh: &Mesh, outward_m_s2: Option<f64>, count: usize) -> Vec<f64> {
    let weighed = outward_m_s2.filter(|_| reports_weight(mesh, outward_m_s2));
    let zeros = weighed.and_then(|own| pose_zeros(mesh, own, count, 0.0));
    zeros.map_or_else(|| torque_zeros(mesh, count), |[real, _]| real)
}

/// Frequencies below `limit_rad_s` in rad/s at which no effort moves the output, like [`reported_frequencies`].
pub fn reported_blocked(mesh: &Mesh, outward_m_s2: Option<f64>, limit_rad_s: f64) -> Vec<f64> {
    let weighed = outward_m_s2.filter(|_| reports_weight(mesh, outward_m_s2));
    let zeros = weighed.and_then(|own| pose_zeros(mesh, own, 0, limit_rad_s));
    zeros.map_or_else(|| real_frequency_zeros(mesh, limit_rad_s), |[_, blocked]| blocked)
}

/// A link on a carriage with gravity along it, over frequency. With the factors μ of mass and κ of stiffness of the damping
/// law, a displacement u of the carriage, the rigid displacement r and deflections w from it,
///
/// ```text
/// D = κK + K_g − ω²μM,   D w = q + ω²μM r u,   F = −ω²μ(M_c u + rᵀM (r u + w)) − rᵀq
/// ```
///
/// K r and `K_g r` are 0, because a displacement across the link turns no part of it.
pub struct WeighedLink {
    mass: DMatrix<f64>,
    bending: DMatrix<f64>,
    weight: DMatrix<f64>,
    /// Force and moment on each node per unit acceleration of the rigid link.
    moved: Vec<Vector2<f64>>,
    carriage_kg: f64,
    output: usize,
}

impl WeighedLink {
    /// The link with gravity `outward_m_s2` along it. `None` as for [`pose_modes`].
    pub fn of(mesh: &Mesh, outward_m_s2: f64) -> Option<Self> {
        if mesh.elements().len() > MOST_ELEMENTS_OF_A_POSE {
            return None;
        }
        let ([mass, mut bending], [_, weight]) =
            (assembled(mesh, (1.0, 0.0)), assembled(mesh, (0.0, outward_m_s2)));
        if mesh.springs() > 0 {
            // The outer end of a spring stays at the root.
            bending[(2, 2)] += mesh.relative_elements()[0].k_d.m11;
        }
        let row = |i: usize| mass.row(i).iter().step_by(2).sum();
        let moved =
            (0..mesh.nodes_m().len()).map(|k| Vector2::new(row(2 * k), row(2 * k + 1))).collect();
        let (carriage_kg, output) = (mesh.joint().inertia(), mesh.output());
        Some(Self { mass, bending, weight, moved, carriage_kg, output })
    }

    /// Force on the carriage without friction, and displacement of the output, per unit of the carriage's displacement.
    pub(crate) fn transfer(&self, omega_rad_s: f64, factors: [Complex64; 2]) -> [Complex64; 2] {
        let square = factors[0] * (omega_rad_s * omega_rad_s);
        let bent = self.deflections((omega_rad_s, factors), |node| [self.moved(node) * square]);
        let all: Vec<_> = bent.iter().map(|[w]| w + Vector2::new(1.0.into(), 0.0.into())).collect();
        [-square * (self.momentum_kg(&all) + self.carriage_kg), all[self.output][0]]
    }

    /// Force on the carriage, and deflections, that keep the output on the chord; without weight those of
    /// [`loaded_motion`](crate::beam::loaded_motion).
    pub(crate) fn loaded_motion(
        &self,
        omega_rad_s: f64,
        factors: [Complex64; 2],
        loads: &Loads<Complex64>,
    ) -> LoadedMotion<Complex64> {
        let (mass, square) = (factors[0], omega_rad_s * omega_rad_s);
        let chord_m_s2 = loads.axis_m_s2 + loads.chord_rad_s2;
        let bent = self.deflections((omega_rad_s, factors), |node| {
            let moved = self.moved(node) * mass;
            [moved * Complex64::from(square), Vector2::from(loads.nodal[node]) - moved * chord_m_s2]
        });
        let [per_place, held] = bent[self.output];
        let place_m = -held[0] / (per_place[0] + 1.0);
        let all: Vec<_> = bent
            .iter()
            .map(|[per_place, held]| per_place * place_m + held + Vector2::new(place_m, 0.0.into()))
            .collect();
        let moving = self.momentum_kg(&all) + place_m * self.carriage_kg;
        let whole_kg = self.moved.iter().map(|own| own[0]).sum::<f64>() + self.carriage_kg;
        let borne_n: Complex64 = loads.nodal.iter().map(|[force_n, _]| force_n).sum();
        LoadedMotion {
            torque_n_m: mass * (chord_m_s2 * whole_kg - moving * square) - borne_n,
            hub_slope_rad: place_m,
            deflections: all.into_iter().map(Into::into).collect(),
        }
    }

    /// Adds the loads `K_g w` to histories of force and moment on each node in turn; `deflections` begins with histories of
    /// (w, w') of each node.
    pub(crate) fn restore(&self, deflections: &[Vec<f64>], loads: &mut [Vec<f64>]) {
        loads.par_iter_mut().enumerate().for_each(|(row, load)| {
            let stiffness = self.weight.row(row);
            let columns = deflections.iter().zip(stiffness.iter());
            for (deflection, stiffness) in columns.filter(|(_, stiffness)| **stiffness != 0.0) {
                load.iter_mut().zip(deflection).for_each(|(f, w)| *f += stiffness * w);
            }
        });
    }

    fn moved(&self, node: usize) -> Vector2<Complex64> {
        self.moved[node].map(Complex64::from)
    }

    /// Momentum across the link per rate of displacements of (v, φ) of the nodes.
    fn momentum_kg(&self, displacements: &[Vector2<Complex64>]) -> Complex64 {
        (0..).zip(displacements).map(|(node, own)| self.moved(node).dot(own)).sum()
    }

    /// Deflections of all nodes of the link with its root held, for N sets of loads on each node.
    fn deflections<const N: usize>(
        &self,
        (omega_rad_s, [of_mass, of_stiffness]): (f64, [Complex64; 2]),
        loads: impl Fn(usize) -> [Vector2<Complex64>; N],
    ) -> Vec<[Vector2<Complex64>; N]> {
        let of_mass = of_mass * -(omega_rad_s * omega_rad_s);
        let block = |inner: usize, outer: usize| {
            Matrix2::from_fn(|i, j| {
                let at = (2 * inner + i, 2 * outer + j);
                of_stiffness * self.bending[at] + of_mass * self.mass[at] + self.weight[at]
            })
        };
        let inverse = |pivot: Matrix2<Complex64>| {
            let [a, b, c, d] = [pivot.m11, pivot.m12, pivot.m21, pivot.m22];
            Matrix2::new(d, -b, -c, a) * (a * d - b * c).inv()
        };
        // From the tip to the root: each node's inverse pivot and load, and its coupling to the node inward.
        let last = self.moved.len() - 1;
        let (mut pivot, mut rest) = (inverse(block(last, last)), loads(last));
        let mut nodes = Vec::with_capacity(last);
        for node in (1..last).rev() {
            let coupling = block(node, node + 1);
            nodes.push((pivot, rest, coupling));
            let inward = coupling * pivot;
            let own = loads(node);
            rest = std::array::from_fn(|k| own[k] - inward * rest[k]);
            pivot = inverse(block(node, node) - inward * coupling.transpose());
        }
        let mut bent = vec![[Vector2::zeros(); N], rest.map(|rest| pivot * rest)];
        while let Some((pivot, rest, coupling)) = nodes.pop() {
            let inner = bent[bent.len() - 1];
            let moved = |k: usize| pivot * (rest[k] - coupling.transpose() * inner[k]);
            bent.push(std::array::from_fn(moved));
        }
        bent
    }
}

/// Weight of an upright link over the weight that buckles it with its joint held; 0 where gravity pulls outward.
pub fn buckling_share(mesh: &Mesh, outward_m_s2: f64) -> f64 {
    if outward_m_s2 >= 0.0 {
        return 0.0;
    }
    let (elements, outboard_kg) = (mesh.elements(), outboard_kg(mesh));
    let bending: Vec<Matrix4<f64>> = elements.iter().map(Element::stiffness).collect();
    let weighed = elements.iter().zip(&outboard_kg[1..]);
    let weight: Vec<Matrix4<f64>> =
        weighed.map(|(element, outboard_kg)| pull(element, outward_m_s2, *outboard_kg)).collect();
    let on_tip = Matrix2::new(0.0, 0.0, 0.0, outward_m_s2 * mesh.tip_inertia().vp);
    // From the tip to the root each node is eliminated: the link stands if all pivots are positive.
    let stands = |factor: f64| {
        let mut outer = on_tip * factor;
        for (k, (bending, weight)) in bending.iter().zip(&weight).enumerate().rev() {
            let element = bending + weight * factor;
            let pivot = element.fixed_view::<2, 2>(2, 2) + outer;
            // The outer end of a spring stays at the root.
            if k < mesh.springs() {
                return pivot.m22 > 0.0;
            }
            if pivot.m11 <= 0.0 || pivot.determinant() <= 0.0 {
                return false;
            }
            let coupling = element.fixed_view::<2, 2>(0, 2);
            let inverse = Matrix2::new(pivot.m22, -pivot.m12, -pivot.m21, pivot.m11);
            let passed = coupling * inverse * coupling.transpose() / pivot.determinant();
            outer = element.fixed_view::<2, 2>(0, 0) - passed;
        }
        true
    };
    // Bisects the share: the weight divided by it just stands.
    let (mut stands_at, mut falls_at) = (f64::INFINITY, 0.0);
    for _ in 0..SHARE_STEPS {
        let share = match stands_at {
            f64::INFINITY => 2.0_f64.max(2.0 * falls_at),
            _ => 0.5 * (stands_at + falls_at),
        };
        if stands(share.recip()) {
            stands_at = share;
        } else {
            falls_at = share;
        }
    }
    stands_at
}

/// Lets v of node 1 follow v of the root in a symmetric matrix.
fn with_outer_on_root(mut full: DMatrix<f64>) -> DMatrix<f64> {
    for k in 0..full.nrows() {
        full[(0, k)] += full[(2, k)];
    }
    for k in 0..full.nrows() {
        full[(k, 0)] += full[(k, 2)];
    }
    full.remove_row(2).remove_column(2)
}

/// Replaces the root's (v, φ) by the joint's position times its unit motion in a symmetric matrix. It avoids products of
/// matrices, whose order of summation depends on the processor.
fn with_root_on_joint(full: DMatrix<f64>, [unit_v, unit_phi]: [f64; 2]) -> DMatrix<f64> {
    let [v, phi] = [full.row(0), full.row(1)];
    let pairs = v.iter().zip(phi.iter());
    let turned: Vec<f64> = pairs.map(|(v, phi)| v * unit_v + phi * unit_phi).collect();
    let mut matrix = full.remove_row(0).remove_column(0);
    for (k, value) in turned.iter().enumerate().skip(2) {
        (matrix[(0, k - 1)], matrix[(k - 1, 0)]) = (*value, *value);
    }
    matrix[(0, 0)] = turned[0] * unit_v + turned[1] * unit_phi;
    matrix
}

/// Mass and stiffness on (v, φ) of all nodes, without the hub, with a factor of the bending stiffness.
fn assembled(mesh: &Mesh, (bending, outward_m_s2): (f64, f64)) -> [DMatrix<f64>; 2] {
    let size = 2 * mesh.nodes_m().len();
    let [mut mass, mut stiffness] = [DMatrix::zeros(size, size), DMatrix::zeros(size, size)];
    let Inertia { vv, vp, pp } = mesh.tip_inertia();
    add_inertia(&mut mass, size - 2, [vv, vp, pp]);
    // The payload beyond the tip is a rigid piece along the tip's slope, as the hub's radius is along the hub's.
    stiffness[(size - 1, size - 1)] += outward_m_s2 * vp;
    let outboard_kg = outboard_kg(mesh);
    for (k, element) in mesh.elements().iter().enumerate().rev() {
        let pulled =
            element.stiffness() * bending + pull(element, outward_m_s2, outboard_kg[k + 1]);
        for (matrix, own) in [(&mut mass, element.mass()), (&mut stiffness, pulled)] {
            let mut block = matrix.fixed_view_mut::<4, 4>(2 * k, 2 * k);
            block += own;
        }
        if let Some(Inertia { vv, vp, pp }) = mesh.lumped_inertia(k) {
            add_inertia(&mut mass, 2 * k, [vv, vp, pp]);
        }
    }
    stiffness[(1, 1)] += outward_m_s2 * outboard_kg[0] * mesh.nodes_m()[0];
    [mass, stiffness]
}

/// Mass in kg of all that lies outboard of each node, with the bodies at the node itself.
fn outboard_kg(mesh: &Mesh) -> Vec<f64> {
    let elements = mesh.elements();
    let mut outboard_kg = vec![mesh.tip_inertia().vv; elements.len() + 1];
    for (k, element) in elements.iter().enumerate().rev() {
        let own_kg = element.length_m * element.mass_per_length_kg_m.mean();
        let at_node = mesh.lumped_inertia(k).map_or(0.0, |inertia| inertia.vv);
        outboard_kg[k] = outboard_kg[k + 1] + own_kg + at_node;
    }
    outboard_kg
}

fn add_inertia(mass: &mut DMatrix<f64>, at: usize, [vv, vp, pp]: [f64; 3]) {
    mass[(at, at)] += vv;
    mass[(at, at + 1)] += vp;
    mass[(at + 1, at)] += vp;
    mass[(at + 1, at + 1)] += pp;
}

/// `∫ N v'² ds` of an element with the mass `outboard_kg` outboard of it.
fn pull(element: &Element, outward_m_s2: f64, outboard_kg: f64) -> Matrix4<f64> {
    let (l, mass) = (element.length_m, element.mass_per_length_kg_m);
    let mut stiffness = Matrix4::zeros();
    for (x, weight) in POINTS.into_iter().filter(|_| !element.is_spring()) {
        // Mass per length is linear: the mean over the rest is the value in its middle.
        let beyond_kg = l * (1.0 - x) * 0.5 * (mass.at(x) + mass.outer);
        let tension_n = outward_m_s2 * (outboard_kg + beyond_kg);
        let slope = Vector4::new(
            -6.0 * x * (1.0 - x) / l,
            (1.0 - x) * (1.0 - 3.0 * x),
            6.0 * x * (1.0 - x) / l,
            x * (3.0 * x - 2.0),
        );
        stiffness += slope * slope.transpose() * (tension_n * weight * l);
    }
    stiffness
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::{ElementCount, MeshPlan, loaded_motion};
    use crate::link::{Carriage, Hub, Link, LinkParts, LumpedMass, Payload, Segment, uniform};

    const CLAMPED: PoseHub = PoseHub::Spring(f64::INFINITY);

    /// A beam of 2 m and 0.7 kg/m from the axis on, without payload.
    fn beam(stiffness_n_m2: f64, elements: usize) -> Mesh {
        let parts = LinkParts {
            segments: vec![Segment::uniform(2.0, stiffness_n_m2, 0.7)],
            hub: Hub::default(),
            payload: Payload::default(),
            ..uniform()
        };
        Mesh::on(&Link::new(parts).unwrap(), elements)
    }

    fn first(mesh: &Mesh, outward_m_s2: f64, hub: PoseHub) -> f64 {
        pose_modes(mesh, outward_m_s2, hub, 1).unwrap()[0].0
    }

    /// Up to round-off, which grows with the number of elements.
    #[test]
    fn without_weight_a_link_on_a_carriage_moves_as_by_the_recursion() {
        for (elements, output_m, most) in
            [(12, None, 1e-10), (12, Some(1.0), 1e-9), (128, None, 1e-6), (250, Some(1.0), 1e-5)]
        {
            let link = Link::builder()
                .segment(Segment::uniform(0.7, 14.0, 0.6))
                .segment(Segment::uniform(0.8, 9.0, 0.4))
                .mass(LumpedMass { at_m: 0.5, mass_kg: 0.1, inertia_kg_m2: 1e-3 })
                .payload(Payload { mass_kg: 0.2, inertia_kg_m2: 2e-3, offset_m: 0.05 })
                .carriage(Carriage { mass_kg: 0.8, viscous_friction_n_s_m: 0.0 });
            let parts =
                LinkParts { output_m, root_stiffness_n_m_rad: output_m.map(|_| 60.0), ..link };
            let link = Link::new(parts).unwrap();
            let whole = Some(ElementCount::Total(elements));
            let plan = MeshPlan::new(&link, &[None, None], whole, 1e-6).unwrap();
            let mesh = Mesh::new(&link, &plan).unwrap();
            let wave = |k: usize| Complex64::cis(1.3 * k as f64);
            let nodal = (0..mesh.nodes_m().len()).map(|k| [wave(k), wave(3 * k + 1) * 0.05]);
            let loads = Loads {
                axis_m_s2: Complex64::new(3.0, 0.4),
                chord_rad_s2: Complex64::new(-1.0, 0.7),
                nodal: nodal.collect(),
            };
            let weighed = WeighedLink::of(&mesh, 0.0).unwrap();
            for omega in [0.0, 5.0, 80.0, 700.0] {
                let factors = [Complex64::ONE, Complex64::new(1.0, 0.04)];
                let lambda = factors[1].inv() * (omega * omega);
                let exact = loaded_motion(&mesh, lambda, factors, &loads);
                let found = weighed.loaded_motion(omega, factors, &loads);
                let off = (found.torque_n_m / exact.torque_n_m - 1.0).norm();
                assert!(off < most, "{off:e} at {omega}, {elements} elements");
                let size = |all: &[[Complex64; 2]]| {
                    all.as_flattened().iter().map(|own| own.norm()).fold(0.0, f64::max)
                };
                let pairs = found.deflections.iter().zip(&exact.deflections);
                let apart: Vec<_> =
                    pairs.map(|(own, exact)| [0, 1].map(|part| own[part] - exact[part])).collect();
                let off = size(&apart) / size(&exact.deflections);
                assert!(off < most, "{off:e} at {omega}, {elements} elements");
            }
        }
    }

    /// Reference: A. G. Greenhill, Proc. Cambridge Phil. Soc. 4, 1881: m̄ g L³/EI = 7.83735.
    #[test]
    fn an_upright_link_with_its_hub_held_buckles_under_its_own_weight() {
        let mesh = beam(3.0, 20);
        let at = |load: f64| first(&mesh, -load * 3.0 / (0.7 * 8.0), CLAMPED);
        let (mut low, mut high) = (7.0, 9.0);
        assert!(at(low) > 0.0 && at(high) < 0.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if at(middle) > 0.0 { low = middle } else { high = middle }
        }
        assert!((low - 7.837_347).abs() < 1e-4, "{low}");
    }

    /// The same load, by the weight that it may not exceed, on any number of pieces; on a spring the load of a rigid link is
    /// `k = m g L/2`.
    #[test]
    fn the_share_of_the_buckling_weight_is_known_on_any_mesh() {
        for elements in [20, 300] {
            let share = buckling_share(&beam(3.0, elements), -7.837_347 * 3.0 / (0.7 * 8.0));
            assert!((share - 1.0).abs() < 2e-5, "{share} with {elements} elements");
        }
        assert!(buckling_share(&beam(3.0, 20), 9.81) == 0.0);
        let parts = LinkParts {
            segments: vec![Segment::uniform(2.0, 1e7, 0.7)],
            hub: Hub::default(),
            payload: Payload::default(),
            root_stiffness_n_m_rad: Some(5.0),
            ..uniform()
        };
        let share = buckling_share(&Mesh::on(&Link::new(parts).unwrap(), 8), -9.81);
        assert!((share / (0.7 * 2.0 * 9.81 / 5.0) - 1.0).abs() < 1e-4, "{share}");
    }

    /// Zeros of J₀ at 2 ω √(L/g): 2.404826, 5.520078, 8.653728.
    #[test]
    fn a_link_that_hardly_resists_bending_swings_as_a_hanging_chain() {
        let modes = pose_modes(&beam(1e-6, 200), 9.81, PoseHub::Free, 3).unwrap();
        for ((square, _), zero) in modes.iter().zip([2.404_826, 5.520_078, 8.653_728]) {
            let exact = 0.25 * zero * zero * 9.81 / 2.0;
            assert!((square / exact - 1.0).abs() < 1e-3, "{square} of {exact}");
        }
    }

    #[test]
    fn a_stiff_link_is_a_pendulum_upward_one_that_falls_and_without_gravity_itself() {
        let parts = LinkParts {
            hub: Hub { inertia_kg_m2: 0.1, radius_m: 0.3, viscous_friction_n_m_s_rad: 0.0 },
            segments: vec![Segment::uniform(1.5, 1e5, 0.8)],
            payload: Payload { mass_kg: 0.4, inertia_kg_m2: 0.02, offset_m: 0.1 },
            ..uniform()
        };
        let link = Link::new(parts).unwrap();
        let mesh = Mesh::on(&link, 8);
        let exact = 9.81 * link.mass_moment_kg_m() / link.rigid_inertia_kg_m2();
        let down = first(&mesh, 9.81, PoseHub::Free);
        let up = first(&mesh, -9.81, PoseHub::Free);
        assert!(
            (down / exact - 1.0).abs() < 1e-4 && (up / exact + 1.0).abs() < 1e-4,
            "{down} {up}"
        );
        let found = pose_modes(&mesh, 0.0, PoseHub::Free, 4).unwrap();
        assert!(found[0].0.abs() < 1e-4 * found[1].0);
        for ((square, _), omega) in found[1..].iter().zip(natural_frequencies(&mesh, 3)) {
            assert!((square.sqrt() / omega - 1.0).abs() < 1e-9, "{square} {omega}");
        }
        // Mass-normalised, the pendulum turns by 1/√I; a clamped hub does not turn.
        let rigid = link.rigid_inertia_kg_m2().sqrt();
        let shape = &pose_modes(&mesh, 9.81, PoseHub::Free, 1).unwrap()[0].1.displacements(&mesh);
        for (across, at_m) in shape.iter().zip(mesh.nodes_m()) {
            assert!((across * rigid / at_m - 1.0).abs() < 1e-4, "{across} at {at_m} m");
        }
        let shape = &pose_modes(&mesh, 9.81, CLAMPED, 1).unwrap()[0].1.displacements(&mesh);
        assert!(shape[0] == 0.0 && shape.windows(2).all(|pair| pair[0] < pair[1]), "{shape:?}");
        // On a spring at the hub, ω² of the rigid link is k/I.
        let spring = first(&mesh, 0.0, PoseHub::Spring(2.0));
        assert!((spring * link.rigid_inertia_kg_m2() / 2.0 - 1.0).abs() < 1e-4, "{spring}");
        assert_eq!(pose_modes(&Mesh::on(&link, 257), 0.0, PoseHub::Free, 1), None);
    }
}
