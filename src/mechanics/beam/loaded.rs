//! The recursion for a link under loads on its nodes. Besides the apparent inertia it carries a bias force from tip to
//! hub: the reaction to the loads.

use num_complex::Complex64;

use super::inertia::{Gain, Inertia};
use super::mesh::Mesh;
use super::recursion::condense;
use super::transfer::is_trusted;
use crate::numeric::{Scalar, Size};

/// Relative distances of the four λ from which [`loaded_motion`] interpolates next to a resonance.
const NEIGHBOURS: [f64; 4] = [-2e-5, -1e-5, 1e-5, 2e-5];

/// Weights of the four answers in the interpolation. It is exact for cubics in λ; beyond, its error grows with the
/// fourth power of the distance.
const WEIGHTS: [f64; 4] = [-1.0 / 6.0, 4.0 / 6.0, 4.0 / 6.0, -1.0 / 6.0];

/// Prescribed motion of a link's chord and loads on its nodes, at one frequency.
///
/// The chord runs from the axis to the output, which is the tip or a station on the link. Forces act along its normal,
/// moments counterclockwise.
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

/// Response of a link to [`Loads`] with its output on the chord.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedMotion<S> {
    /// Torque at the hub in N m, including its inertia but not friction and drive.
    pub torque_n_m: S,
    /// Angle of the hub's tangent line relative to the chord in rad.
    pub hub_slope_rad: S,
    /// Deflection in m and slope in rad of nodes 0 … n from the chord.
    pub deflections: Vec<[S; 2]>,
}

/// Torque at the hub, and deflections of the nodes, that keep the output on the chord, at one λ.
///
/// `factors` multiply the mesh's mass and stiffness at this frequency: the damping law in complex numbers.
///
/// Where the part of an undamped link outboard of some node resonates, the recursion loses its digits. The response of
/// the whole link is smooth there, unless no torque moves the output at a frequency nearby. The function then interpolates
/// it from four neighbouring λ, at relative distances of 1e-5 and 2e-5. Measured errors: torques 1e-8, deflections
/// 1e-7.
///
/// # Panics
/// If loads and nodes differ in number.
pub fn loaded_motion(
    mesh: &Mesh,
    lambda: Complex64,
    factors: [Complex64; 2],
    loads: &Loads<Complex64>,
) -> LoadedMotion<Complex64> {
    let (motion, largest_gain) = by_recursion(mesh, lambda, factors, loads);
    if is_trusted(largest_gain) {
        return motion;
    }
    let near = NEIGHBOURS.map(|step| by_recursion(mesh, lambda * (1.0 + step), factors, loads).0);
    let interpolated = |quantity: &dyn Fn(&LoadedMotion<Complex64>) -> Complex64| -> Complex64 {
        near.iter().zip(WEIGHTS).map(|(motion, weight)| quantity(motion) * weight).sum()
    };
    let node = |k: usize| [0, 1].map(|part| interpolated(&|motion| motion.deflections[k][part]));
    LoadedMotion {
        torque_n_m: interpolated(&|motion| motion.torque_n_m),
        hub_slope_rad: interpolated(&|motion| motion.hub_slope_rad),
        deflections: (0..loads.nodal.len()).map(node).collect(),
    }
}

/// [`loaded_motion`] by the recursion alone, and an upper bound of |G|.
///
/// λ is ω² `mass`/`stiffness`. The recursion runs with the mesh's real matrices, and with loads q over `mass`; `mass`
/// multiplies the torque at the end. R, G, A and the eliminated system are those of [`condense`].
///
/// The bias `p_i` is the force and moment on node i that hold it at rest against all loads outboard of it: hence −q. From
/// tip to hub, over an element with inner node i and outer node j:
///
/// ```text
/// h   = (K_d/λ − (M_dd + A_j))⁻¹ p_j                          deformation of the element by loads
/// p_i = Rᵀ p_j + Gᵀ p_j − q_i,                                p_n = −q_n
/// ```
///
/// From hub to tip, with the acceleration a of a node and its deflection w from the chord:
///
/// ```text
/// a_j = R a_i + G a_i + h,       w_j = R w_i − (G a_i + h)/ω²
/// w'_0 = −w_out/(x + e_out),     T = (A_0 a_0 + p_0)_φ + I_H a_φ         about the axis
/// w_0  = −w_out/(1 + e_out),     F = (A_0 a_0 + p_0)_v + M a_v           of a carriage
/// ```
///
/// `w_out` is the deflection of the output at x with the hub's tangent on the chord; the hub turns by w'_0 to bring the
/// output back to the chord. a includes the motion of the axis, so that the inertia forces of a rigid motion are no loads. A
/// deflection is −1/ω² times the acceleration due to bending; G and h are proportional to ω² at low frequencies, so
/// that it stays finite at ω = 0. Articulated bodies carry their bias force in the same way (Featherstone 1987).
fn by_recursion<S: Scalar>(
    mesh: &Mesh,
    lambda: S,
    [mass, stiffness]: [S; 2],
    loads: &Loads<S>,
) -> (LoadedMotion<S>, S::Size) {
    let (one, mut largest_gain) = (lambda.lift(1.0).size(), lambda.lift(0.0).size());
    let (elements, link_m, unit) = (mesh.elements().len(), mesh.length_m(), mesh.rigid(0));
    assert!(loads.nodal.len() == elements + 1, "a load for each node");
    let per_mass = mass.reciprocal();
    let load = |node: usize| loads.nodal[node].map(|part| part * per_mass);
    let zero = lambda.lift(0.0);
    // G and h of each element.
    let mut gains = vec![(Gain { vv: zero, vp: zero, pv: zero, pp: zero }, [zero; 2]); elements];
    let mut bias = load(elements).map(|part| part * -1.0);
    // Motion of the output per motion (v, φ) of the node, in two forms: the displacement t keeps its digits where the
    // output hardly moves, the deflection e (t without its rigid part) keeps them near ω = 0. e_q is the part by the
    // loads. They begin at the output.
    let [mut t_v, mut t_phi, mut e_v, mut e_phi, mut e_q] = [zero + 1.0, zero, zero, zero, zero];
    let root = condense(mesh, lambda, |index, step| {
        let length_m = mesh.relative_elements()[index].length_m;
        let h = step.eliminated.solved(step.pivots, bias);
        if index < mesh.output() {
            e_q = e_q + t_v * h[0] + t_phi * h[1];
            let output = [e_v + 1.0, e_phi + (mesh.output_m() - mesh.nodes_m()[index + 1])];
            let [bend_v, bend_phi] = step.eliminated.along(output);
            [e_v, e_phi] = [e_v + bend_v, e_v * length_m + e_phi + bend_phi];
            let [bend_v, bend_phi] = step.eliminated.along([t_v, t_phi]);
            [t_v, t_phi] = [t_v + bend_v, t_v * length_m + t_phi + bend_phi];
        }
        let ([g_v, g_phi], [q_v, q_phi]) = (step.eliminated.along(bias), load(index));
        bias = [bias[0] + g_v - q_v, bias[0] * length_m + bias[1] + g_phi - q_phi];
        gains[index] = (step.gain(), h);
        largest_gain = largest_gain.larger(step.eliminated.size(one, link_m));
    });

    let per_omega_square = mesh.per_lambda(lambda) * (mass * stiffness.reciprocal());
    let omega_square = lambda * (stiffness * per_mass);
    // The root's acceleration and the output's deflection with the hub's tangent on the chord.
    let moved = |joint: S| [loads.axis_m_s2 + joint * unit[0], joint * unit[1]];
    let [root_v, root_phi] = moved(loads.chord_rad_s2);
    let output_m = zero - per_omega_square * (e_v * root_v + e_phi * root_phi + e_q);
    let output_per_hub_angle_m = t_v * unit[0] + t_phi * unit[1];
    let hub_slope_rad = zero - output_m * output_per_hub_angle_m.reciprocal();
    let hub_rad_s2 = loads.chord_rad_s2 - omega_square * hub_slope_rad;

    let root_m_s2 = moved(hub_rad_s2);
    let at_root = effort(root, bias, root_m_s2, unit);
    let mut a = root_m_s2;
    let mut w = unit.map(|part| hub_slope_rad * part);
    let mut deflections = vec![w];
    for ((gain, h), element) in gains.iter().zip(mesh.relative_elements()) {
        let d = [gain.vv * a[0] + gain.vp * a[1] + h[0], gain.pv * a[0] + gain.pp * a[1] + h[1]];
        let l = element.length_m;
        w = [w[0] + w[1] * l - d[0] * per_omega_square, w[1] - d[1] * per_omega_square];
        a = [a[0] + a[1] * l + d[0], a[1] + d[1]];
        deflections.push(w);
    }
    let torque_n_m = (at_root + mesh.joint().position(root_m_s2) * mesh.joint().inertia()) * mass;
    (LoadedMotion { torque_n_m, hub_slope_rad, deflections }, largest_gain)
}

/// Effort of the root's reaction `A a + p` along the joint's unit motion.
fn effort<S: Scalar>(root: Inertia<S>, bias: [S; 2], a: [S; 2], [v, phi]: [f64; 2]) -> S {
    let force = root.vv * a[0] + root.vp * a[1] + bias[0];
    (root.moment(a[0], a[1]) + bias[1]) * phi + force * v
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
        with_output(elements, None)
    }

    fn with_output(elements: usize, output_m: Option<f64>) -> Mesh {
        let parts = LinkParts {
            segments: vec![Segment::uniform(2.0, 6.0, 0.7)],
            hub: Hub::default(),
            payload: Payload::default(),
            output_m,
            ..uniform()
        };
        Mesh::on(&Link::new(parts).unwrap(), elements)
    }

    fn no_loads(mesh: &Mesh) -> Loads<f64> {
        let nodal = vec![[0.0; 2]; mesh.nodes_m().len()];
        Loads { axis_m_s2: 0.0, chord_rad_s2: 0.0, nodal }
    }

    /// A load per length, linear from the axis to the tip.
    fn distributed(mesh: &Mesh, force_n_m: Taper) -> Loads<f64> {
        let mut loads = no_loads(mesh);
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

    /// Compares the motion at rest with the deflection of a cantilever, turned so that its output lies on the chord.
    fn check(mesh: &Mesh, loads: &Loads<f64>, torque: f64, cantilever: impl Fn(f64) -> f64) {
        let (motion, _) = by_recursion(mesh, 0.0, NO_FACTORS, loads);
        let turn = -cantilever(mesh.output_m()) / mesh.output_m();
        assert!((motion.torque_n_m / torque - 1.0).abs() < 1e-13, "{} {torque}", motion.torque_n_m);
        assert!((motion.hub_slope_rad / turn - 1.0).abs() < 1e-12, "{}", motion.hub_slope_rad);
        for (x, [w, _]) in mesh.nodes_m().iter().zip(&motion.deflections) {
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
            let mut tip = no_loads(&mesh);
            tip.nodal[elements] = [4.0, -1.5];
            let at_tip =
                |x: f64| 4.0 * x * x * (3.0 * l - x) / (6.0 * ei) - 1.5 * x * x / (2.0 * ei);
            check(&mesh, &tip, -4.0 * l + 1.5, at_tip);
            // An accelerated axis acts as a load on the mass.
            let lifted = Loads { axis_m_s2: 9.81, ..no_loads(&mesh) };
            let weight = -0.7 * 9.81;
            check(&mesh, &lifted, -weight * l * l / 2.0, uniform(weight));
        }
        let inboard = with_output(4, Some(1.5));
        let lifted = Loads { axis_m_s2: 9.81, ..no_loads(&inboard) };
        let sag = |x: f64| -0.7 * 9.81 * x * x * (6.0 * l * l - 4.0 * l * x + x * x) / (24.0 * ei);
        check(&inboard, &lifted, 0.7 * 9.81 * l * l / 2.0, sag);
        let mesh = beam(4);
        let mut middle = no_loads(&mesh);
        middle.nodal[2] = [2.0, 0.0];
        let cantilever = |x: f64| {
            let a = 1.0;
            let (inner, beyond) = (x.min(a), (x - a).max(0.0));
            2.0 * inner * inner * (3.0 * a - inner) / (6.0 * ei) + 2.0 * a * a / (2.0 * ei) * beyond
        };
        check(&mesh, &middle, -2.0, cantilever);
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
            let motion = loaded_motion(&mesh, lambda, factors, &loads);
            let error = (motion.torque_n_m / transfer.inertia_kg_m - 1.0).norm();
            assert!(error < 1e-13, "{error:e} at {omega}");
            let slope = transfer.deflection_s2 / factors[1] / mesh.length_m();
            let error = (motion.hub_slope_rad / slope - 1.0).norm();
            assert!(error < 1e-12, "{error:e} at {omega}");
            let [tip, _] = motion.deflections[17];
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
        let motion = loaded_motion(&mesh, lambda, [one, stiffness], &loads);
        let wide = Loads {
            axis_m_s2: Wide::from(axis),
            chord_rad_s2: Wide::from(one),
            nodal: loads.nodal.iter().map(|load| load.map(Wide::from)).collect(),
        };
        let factors = [one, stiffness].map(Wide::from);
        let (exact, _) = by_recursion(&mesh, Wide::from(lambda), factors, &wide);
        let error = |value: Complex64, exact: Wide| (value / exact.nearest() - 1.0).norm();
        let torque = error(motion.torque_n_m, exact.torque_n_m);
        let slope = error(motion.hub_slope_rad, exact.hub_slope_rad);
        assert!(torque < 1e-13 && slope < 1e-12, "{torque:e} {slope:e}");
        let largest = motion.deflections.iter().fold(0.0, |most: f64, w| most.max(w[0].norm()));
        for (w, exact) in motion.deflections.iter().zip(&exact.deflections) {
            let error = (w[0] - exact[0].nearest()).norm();
            assert!(error < 1e-12 * largest, "{error:e} of {largest:e}");
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
        let gain = |lambda: f64| by_recursion(&mesh, Complex64::from(lambda), [one; 2], &loads).1;
        let mut resonances = 0;
        for k in 1..600 {
            // The largest gain near a multiple, if it has one.
            let mut lambda = (0.670_123 * f64::from(k)).powi(2);
            for step in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8] {
                let near = (-10..=10).map(|place| lambda * (1.0 + step * f64::from(place)));
                lambda = near.max_by(|a, b| gain(*a).total_cmp(&gain(*b))).unwrap();
            }
            resonances += u32::from(!is_trusted(gain(lambda)));
            let motion = loaded_motion(&mesh, lambda.into(), [one; 2], &loads);
            let (exact, _) = by_recursion(&mesh, Wide::from(lambda), [Wide::from(1.0); 2], &wide);
            let error = (motion.torque_n_m / exact.torque_n_m.nearest() - 1.0).norm();
            assert!(error < 1e-8, "{error:e} at λ = {lambda}, gain {:e}", gain(lambda));
            let largest = motion.deflections.iter().fold(0.0, |m: f64, w| m.max(w[0].norm()));
            for (w, exact) in motion.deflections.iter().zip(&exact.deflections) {
                let error = (w[0] - exact[0].nearest()).norm() / largest;
                assert!(error < 3e-7, "{error:e} at λ = {lambda}");
            }
        }
        assert!(resonances > 20, "{resonances}");
    }
}
