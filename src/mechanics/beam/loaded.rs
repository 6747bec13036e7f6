//! The recursion with loads: besides the apparent inertia it carries a bias force.

use num_complex::Complex64;

use super::inertia::{Gain, Inertia};
use super::mesh::Mesh;
use super::recursion::condense;
use super::transfer::is_trusted;
use crate::numeric::{Scalar, Size};

/// Relative steps of λ away from a resonance of the part outboard of some node.
const BESIDE: [f64; 4] = [-2e-5, -1e-5, 1e-5, 2e-5];

/// Weights of the answers at these steps, exact up to the fourth power of the step.
const WEIGHTS: [f64; 4] = [-1.0 / 6.0, 4.0 / 6.0, 4.0 / 6.0, -1.0 / 6.0];

/// Motions and loads of a link at one frequency, besides the torque at its hub.
///
/// The chord runs from the axis to the tip. Forces act along its normal, moments counterclockwise.
#[derive(Debug, Clone, PartialEq)]
pub struct Loads<S> {
    /// Acceleration of the axis along the normal in m/s².
    pub axis_m_s2: S,
    /// Angular acceleration of the chord in rad/s².
    pub chord_rad_s2: S,
    /// Force in N and moment in N m on nodes 0 … n; [`Element::load`](super::Element::load) distributes loads between
    /// nodes.
    pub nodal: Vec<[S; 2]>,
}

/// Response of a link to [`Loads`] with its tip on the chord.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedMotion<S> {
    /// Torque at the hub in N m, including its inertia but not friction and drive.
    pub torque_n_m: S,
    /// Angle of the hub's tangent line relative to the chord in rad.
    pub hub_slope_rad: S,
    /// Deflection in m and slope in rad of nodes 0 … n from the chord.
    pub deflections: Vec<[S; 2]>,
}

/// Torque of the hub and deflections of the nodes that keep the tip on the chord, at one λ.
///
/// Where an undamped link's outboard part resonates, the recursion loses its digits, but the whole link's answer is
/// smooth unless a blocked tip is near. The answer is then interpolated from four neighbouring λ, at relative distances
/// of 1e-5 and 2e-5 (measured: torques to 1e-8, deflections to 1e-7).
///
/// # Panics
/// If loads and nodes differ in number.
pub fn loaded_motion(
    mesh: &Mesh,
    lambda: Complex64,
    factors: [Complex64; 2],
    loads: &Loads<Complex64>,
) -> LoadedMotion<Complex64> {
    let (found, gain) = recursed(mesh, lambda, factors, loads);
    if is_trusted(gain) {
        return found;
    }
    let beside = BESIDE.map(|step| recursed(mesh, lambda * (1.0 + step), factors, loads).0);
    let sum = |of: &dyn Fn(&LoadedMotion<Complex64>) -> Complex64| -> Complex64 {
        beside.iter().zip(WEIGHTS).map(|(motion, weight)| of(motion) * weight).sum()
    };
    let node = |k: usize| [0, 1].map(|part| sum(&|motion| motion.deflections[k][part]));
    LoadedMotion {
        torque_n_m: sum(&|motion| motion.torque_n_m),
        hub_slope_rad: sum(&|motion| motion.hub_slope_rad),
        deflections: (0..loads.nodal.len()).map(node).collect(),
    }
}

/// [`loaded_motion`] by the recursion alone, and an upper bound of |G|.
///
/// At this frequency the factors `mass` and `stiffness` multiply the mesh's mass and stiffness; λ is ω² times the first
/// over the second. With the apparent inertia A and the elimination of [`condense`], the bias p of the outboard part is
/// the force (v, φ) on its node that holds its loads at rest:
///
/// ```text
/// h   = (K_d/λ − (M_dd + A_j))⁻¹ p_j
/// p_i = Rᵀ p_j + Gᵀ p_j − q_i,                                p_n = −q_n
/// a_j = R a_i + G a_i + h,       w_j = R w_i − (G a_i + h)/ω²
/// ψ   = −w_tip/(L + e_tip),      T = (A_0 a_0 + p_0)_φ + I_H a_φ         about the axis
/// ```
///
/// a is the whole acceleration including the axis, so that rigid motion is no load. The deflection is per 1/λ, and
/// finite at ω = 0. Articulated bodies carry their bias force in the same way (Featherstone 1987).
fn recursed<S: Scalar>(
    mesh: &Mesh,
    lambda: S,
    [mass, stiffness]: [S; 2],
    loads: &Loads<S>,
) -> (LoadedMotion<S>, S::Size) {
    let (one, mut largest_gain) = (lambda.lift(1.0).size(), lambda.lift(0.0).size());
    let (elements, link_m, root_m) = (mesh.elements().len(), mesh.length_m(), mesh.nodes_m()[0]);
    assert!(loads.nodal.len() == elements + 1, "a load for each node");
    let per_mass = mass.reciprocal();
    let load = |node: usize| loads.nodal[node].map(|part| part * per_mass);
    let zero = lambda.lift(0.0);
    let mut answers = vec![(Gain { vv: zero, vp: zero, pv: zero, pp: zero }, [zero; 2]); elements];
    let mut bias = load(elements).map(|part| part * -1.0);
    // Three parts of the tip's motion. The first, per motion of the node in full, has its digits where the tip hardly
    // moves. The second, without the rigid part, has the digits of a deflection at rest. The third is due to the loads.
    let (mut whole, [mut e_v, mut e_phi], mut e_bias) = ([zero + 1.0, zero], [zero; 2], zero);
    let root = condense(mesh, lambda, |index, step| {
        let length_m = mesh.relative_elements()[index].length_m;
        let bent = step.eliminated.solved(step.pivots, bias);
        e_bias = e_bias + whole[0] * bent[0] + whole[1] * bent[1];
        let tip = [e_v + 1.0, e_phi + (link_m - mesh.nodes_m()[index + 1])];
        let ([v, phi], along) = (step.eliminated.along(tip), step.eliminated.along(whole));
        [e_v, e_phi] = [e_v + v, e_v * length_m + e_phi + phi];
        whole = [whole[0] + along[0], whole[0] * length_m + whole[1] + along[1]];
        let (passed, own) = (step.eliminated.along(bias), load(index));
        bias = [bias[0] + passed[0] - own[0], bias[0] * length_m + bias[1] + passed[1] - own[1]];
        answers[index] = (step.gain(), bent);
        largest_gain = largest_gain.larger(step.eliminated.size(one, link_m));
    });

    // A deflection is −1/ω² times the acceleration due to bending.
    let per_square = mesh.per_lambda(lambda) * (mass * stiffness.reciprocal());
    let square = lambda * (stiffness * per_mass);
    let rigid = [loads.axis_m_s2 + loads.chord_rad_s2 * root_m, loads.chord_rad_s2];
    let tip_m = zero - per_square * (e_v * rigid[0] + e_phi * rigid[1] + e_bias);
    let per_hub_angle_m = whole[0] * root_m + whole[1];
    let hub_slope_rad = zero - tip_m * per_hub_angle_m.reciprocal();
    let hub_rad_s2 = loads.chord_rad_s2 - square * hub_slope_rad;

    let mut a = [loads.axis_m_s2 + hub_rad_s2 * root_m, hub_rad_s2];
    let about_axis = about_axis(root, bias, a, root_m);
    let mut w = [hub_slope_rad * root_m, hub_slope_rad];
    let mut deflections = vec![w];
    for ((gain, bent), element) in answers.iter().zip(mesh.relative_elements()) {
        let bent =
            [gain.vv * a[0] + gain.vp * a[1] + bent[0], gain.pv * a[0] + gain.pp * a[1] + bent[1]];
        let l = element.length_m;
        w = [w[0] + w[1] * l - bent[0] * per_square, w[1] - bent[1] * per_square];
        a = [a[0] + a[1] * l + bent[0], a[1] + bent[1]];
        deflections.push(w);
    }
    let found = LoadedMotion {
        torque_n_m: (about_axis + hub_rad_s2 * mesh.hub_inertia_kg_m2()) * mass,
        hub_slope_rad,
        deflections,
    };
    (found, largest_gain)
}

/// Moment about the axis of the root's reaction `A a + p`.
fn about_axis<S: Scalar>(root: Inertia<S>, bias: [S; 2], a: [S; 2], root_m: f64) -> S {
    let force = root.vv * a[0] + root.vp * a[1] + bias[0];
    root.moment(a[0], a[1]) + bias[1] + force * root_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::test_links::mesh;
    use crate::beam::tip_transfer;
    use crate::link::{Hub, Link, LinkParts, Payload, Segment, Taper, uniform};
    use crate::numeric::Wide;

    const NO_FACTORS: [f64; 2] = [1.0, 1.0];

    /// A beam of 2 m and 6 N m² from the axis on, without payload.
    fn beam(elements: usize) -> Mesh {
        let parts = LinkParts {
            segments: vec![Segment::uniform(2.0, 6.0, 0.7)],
            hub: Hub::default(),
            payload: Payload::default(),
            ..uniform()
        };
        Mesh::on(&Link::new(parts).unwrap(), elements)
    }

    fn none(mesh: &Mesh) -> Loads<f64> {
        let nodal = vec![[0.0; 2]; mesh.nodes_m().len()];
        Loads { axis_m_s2: 0.0, chord_rad_s2: 0.0, nodal }
    }

    /// A load per length, linear from the axis to the tip.
    fn distributed(mesh: &Mesh, force_n_m: Taper) -> Loads<f64> {
        let mut loads = none(mesh);
        for (k, element) in mesh.elements().iter().enumerate() {
            let share = |node: usize| mesh.nodes_m()[node] / mesh.length_m();
            let ends = element.load(force_n_m.between(share(k), share(k + 1)));
            for (node, load) in [k, k + 1].into_iter().zip(ends) {
                let [force, moment] = &mut loads.nodal[node];
                (*force, *moment) = (*force + load[0], *moment + load[1]);
            }
        }
        loads
    }

    /// Compares the motion at rest with the deflection of a cantilever, turned so that its tip lies on the chord.
    fn check(mesh: &Mesh, loads: &Loads<f64>, torque: f64, cantilever: impl Fn(f64) -> f64) {
        let (found, _) = recursed(mesh, 0.0, NO_FACTORS, loads);
        let turn = -cantilever(mesh.length_m()) / mesh.length_m();
        assert!((found.torque_n_m / torque - 1.0).abs() < 1e-13, "{} {torque}", found.torque_n_m);
        assert!((found.hub_slope_rad / turn - 1.0).abs() < 1e-12, "{}", found.hub_slope_rad);
        for (x, [w, _]) in mesh.nodes_m().iter().zip(&found.deflections) {
            let exact = cantilever(*x) + turn * x;
            assert!((w - exact).abs() < 1e-13 * (turn * x).abs().max(1e-3), "{w} {exact} at {x}");
        }
    }

    /// Reference: tables of cantilevers in books on the strength of materials.
    #[test]
    fn at_rest_the_link_bends_as_tables_of_cantilevers_say() {
        let (l, ei) = (2.0, 6.0);
        for elements in [1, 4, 30] {
            let mesh = beam(elements);
            let uniform = |f: f64| {
                move |x: f64| f * x * x * (6.0 * l * l - 4.0 * l * x + x * x) / (24.0 * ei)
            };
            check(
                &mesh,
                &distributed(&mesh, Taper::constant(3.0)),
                -3.0 * l * l / 2.0,
                uniform(3.0),
            );
            // Largest at the axis, zero at the tip.
            let triangle = |x: f64| {
                let sum = 10.0 * l.powi(3) - 10.0 * l * l * x + 5.0 * l * x * x - x.powi(3);
                5.0 * x * x / (120.0 * ei * l) * sum
            };
            let force = Taper { inner: 5.0, outer: 0.0 };
            check(&mesh, &distributed(&mesh, force), -5.0 * l * l / 6.0, triangle);
            let mut tip = none(&mesh);
            tip.nodal[elements] = [4.0, -1.5];
            let at_tip =
                |x: f64| 4.0 * x * x * (3.0 * l - x) / (6.0 * ei) - 1.5 * x * x / (2.0 * ei);
            check(&mesh, &tip, -4.0 * l + 1.5, at_tip);
            // An accelerated axis acts as a load on the mass.
            let moved = Loads { axis_m_s2: 9.81, ..none(&mesh) };
            let weight = -0.7 * 9.81;
            check(&mesh, &moved, -weight * l * l / 2.0, uniform(weight));
        }
        let mesh = beam(4);
        let mut middle = none(&mesh);
        middle.nodal[2] = [2.0, 0.0];
        let bent = |x: f64| {
            let a = 1.0;
            let (inner, beyond) = (x.min(a), (x - a).max(0.0));
            2.0 * inner * inner * (3.0 * a - inner) / (6.0 * ei) + 2.0 * a * a / (2.0 * ei) * beyond
        };
        check(&mesh, &middle, -2.0, bent);
    }

    #[test]
    fn without_loads_the_answer_is_that_of_the_tips_motion() {
        let mesh = mesh(17);
        for omega in [0.0, 0.3, 7.0, 60.0] {
            let lambda = Complex64::new(1.0, 0.04).inv() * omega * omega;
            let transfer = tip_transfer(&mesh, lambda);
            let nodal = vec![[Complex64::ZERO; 2]; 18];
            let chord_rad_s2 = Complex64::from(1.0 / mesh.length_m());
            let loads = Loads { axis_m_s2: Complex64::ZERO, chord_rad_s2, nodal };
            let factors = [Complex64::ONE, Complex64::new(1.0, 0.04)];
            let found = loaded_motion(&mesh, lambda, factors, &loads);
            let off = (found.torque_n_m / transfer.inertia_kg_m - 1.0).norm();
            assert!(off < 1e-13, "{off:e} at {omega}");
            let slope = transfer.deflection_s2 / factors[1] / mesh.length_m();
            let off = (found.hub_slope_rad / slope - 1.0).norm();
            assert!(off < 1e-12, "{off:e} at {omega}");
            let [tip, _] = found.deflections[17];
            assert!(tip.norm() < 1e-12 * slope.norm() * mesh.length_m(), "{tip}");
        }
    }

    #[test]
    fn four_thousand_elements_at_rest_lose_no_digit_under_loads() {
        let mesh = mesh(4000);
        let omega = 0.01;
        let wave = |k: usize| Complex64::new((0.3 * k as f64).sin(), (1.7 * k as f64).cos());
        let nodal: Vec<_> = (0..=4000).map(|k| [wave(k), wave(k + 7) * 0.01]).collect();
        let stiffness = Complex64::new(1.0, 0.04);
        let (one, axis) = (Complex64::ONE, Complex64::new(9.81, 0.2));
        let lambda = stiffness.inv() * omega * omega;
        let loads = Loads { axis_m_s2: axis, chord_rad_s2: one, nodal };
        let found = loaded_motion(&mesh, lambda, [one, stiffness], &loads);
        let wide = Loads {
            axis_m_s2: Wide::from(axis),
            chord_rad_s2: Wide::from(one),
            nodal: loads.nodal.iter().map(|load| load.map(Wide::from)).collect(),
        };
        let factors = [one, stiffness].map(Wide::from);
        let (exact, _) = recursed(&mesh, Wide::from(lambda), factors, &wide);
        let off = |found: Complex64, exact: Wide| (found / exact.nearest() - 1.0).norm();
        let torque = off(found.torque_n_m, exact.torque_n_m);
        let slope = off(found.hub_slope_rad, exact.hub_slope_rad);
        assert!(torque < 1e-13 && slope < 1e-12, "{torque:e} {slope:e}");
        let largest = found.deflections.iter().fold(0.0, |most: f64, w| most.max(w[0].norm()));
        for (found, exact) in found.deflections.iter().zip(&exact.deflections) {
            let off = (found[0] - exact[0].nearest()).norm();
            assert!(off < 1e-12 * largest, "{off:e} of {largest:e}");
        }
    }

    #[test]
    fn an_undamped_link_keeps_its_digits_where_its_outboard_part_resonates() {
        let (mesh, one) = (mesh(10), Complex64::ONE);
        let nodal: Vec<_> =
            (0..=10).map(|k| [Complex64::from(0.3 + 0.1 * f64::from(k)); 2]).collect();
        let loads = Loads { axis_m_s2: one, chord_rad_s2: one, nodal };
        let wide = Loads {
            axis_m_s2: Wide::from(one),
            chord_rad_s2: Wide::from(one),
            nodal: loads.nodal.iter().map(|load| load.map(Wide::from)).collect(),
        };
        let at = |lambda: f64| recursed(&mesh, Complex64::from(lambda), [one; 2], &loads).1;
        let mut flagged = 0;
        for k in 1..600 {
            // The largest gain near a multiple, if it has one.
            let mut lambda = (0.670_123 * f64::from(k)).powi(2);
            for step in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8] {
                let near = (-10..=10).map(|place| lambda * (1.0 + step * f64::from(place)));
                lambda = near.max_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap();
            }
            flagged += u32::from(!is_trusted(at(lambda)));
            let found = loaded_motion(&mesh, lambda.into(), [one; 2], &loads);
            let (exact, _) = recursed(&mesh, Wide::from(lambda), [Wide::from(1.0); 2], &wide);
            let off = (found.torque_n_m / exact.torque_n_m.nearest() - 1.0).norm();
            assert!(off < 1e-8, "{off:e} at λ = {lambda}, gain {:e}", at(lambda));
            let largest = found.deflections.iter().fold(0.0, |m: f64, w| m.max(w[0].norm()));
            for (found, exact) in found.deflections.iter().zip(&exact.deflections) {
                let off = (found[0] - exact[0].nearest()).norm() / largest;
                assert!(off < 3e-7, "{off:e} at λ = {lambda}");
            }
        }
        assert!(flagged > 20, "{flagged}");
    }
}
