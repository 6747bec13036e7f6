//! Links with shear and rotary inertia against Timoshenko's beam in closed form: the exponential of its
//! equations along the link, in 106 bits for the frequencies.

use std::ops::{Add, Mul, Sub};

use flexlink::beam::tip_transfer;
use flexlink::link::{Hub, Link, Payload, Segment, Taper, Timoshenko};
use flexlink::modal::{natural_frequencies, real_frequency_zeros, torque_zeros};
use num_complex::Complex64;
use twofloat::TwoFloat;

use crate::common::mesh_of;

const LENGTH_M: f64 = 1.2;
const STIFFNESS_N_M2: f64 = 5.0;
const MASS_KG_M: f64 = 0.8;
/// E/(κG) of steel, rectangular.
const FLEXIBILITY: f64 = 3.06;
const HUB_KG_M2: f64 = 0.05;
const PAYLOAD: Payload = Payload { mass_kg: 0.3, inertia_kg_m2: 4e-3, offset_m: 0.0 };

/// Shear and rotary inertia of a link whose length is so many times √12 radii of gyration, the thickness of a
/// rectangle.
fn of_slenderness(slenderness: f64) -> Timoshenko {
    let square_m2 = (LENGTH_M / slenderness).powi(2) / 12.0;
    Timoshenko {
        shear_stiffness_n: Taper::constant(STIFFNESS_N_M2 / (square_m2 * FLEXIBILITY)),
        rotary_inertia_per_length_kg_m: Taper::constant(MASS_KG_M * square_m2),
    }
}

fn link(timoshenko: Option<Timoshenko>) -> Link {
    let segment = Segment { timoshenko, ..Segment::uniform(LENGTH_M, STIFFNESS_N_M2, MASS_KG_M) };
    let hub = Hub { inertia_kg_m2: HUB_KG_M2, ..Hub::default() };
    Link::builder().segment(segment).hub(hub).payload(PAYLOAD).build().unwrap()
}

trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + From<f64> {}
impl Number for TwoFloat {}
impl Number for Complex64 {}

type Square<T> = [[T; 4]; 4];

fn product<T: Number>(a: &Square<T>, b: &Square<T>) -> Square<T> {
    let zero = T::from(0.0);
    std::array::from_fn(|i| {
        std::array::from_fn(|k| (0..4).fold(zero, |sum, j| sum + a[i][j] * b[j][k]))
    })
}

/// State (v, ψ, M, Q) at the tip of one at the hub, for `λ = ω²`: `exp(A L)` by its series, squared ten times.
///
/// ```text
/// v' = ψ + Q/(κGA),  ψ' = M/EI,  M' = −Q − ρI λ ψ,  Q' = −m̄ λ v
/// ```
fn carried<T: Number>(own: &Timoshenko, lambda: T) -> Square<T> {
    let (number, piece) = (|x: f64| T::from(x), T::from(LENGTH_M / 1024.0));
    let zero = number(0.0);
    // Reciprocals of numbers are exact to 53 bits only; those of powers of two are exact.
    let mut a = [[zero; 4]; 4];
    a[0][1] = number(1.0);
    a[0][3] = number(own.shear_stiffness_n.inner.recip());
    a[1][2] = number(STIFFNESS_N_M2.recip());
    a[2][3] = number(-1.0);
    a[2][1] = zero - number(own.rotary_inertia_per_length_kg_m.inner) * lambda;
    a[3][0] = zero - number(MASS_KG_M) * lambda;
    let a = a.map(|row| row.map(|entry| entry * piece));
    let mut sum: Square<T> =
        std::array::from_fn(|i| std::array::from_fn(|j| number(if i == j { 1.0 } else { 0.0 })));
    let mut term = sum;
    for k in 1..=24 {
        let share = number(1.0 / f64::from(k));
        term = product(&term, &a).map(|row| row.map(|entry| entry * share));
        sum = std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j] + term[i][j]));
    }
    (0..10).fold(sum, |power, _| product(&power, &power))
}

/// What the tip misses of its payload's force and moment, of a unit of ψ, M and Q at the hub.
fn missed<T: Number>(own: &Timoshenko, lambda: T) -> [[T; 2]; 3] {
    let end = carried(own, lambda);
    [1, 2, 3].map(|k| {
        let [v, psi, m, q] = [0, 1, 2, 3].map(|row: usize| end[row][k]);
        [
            q - v * lambda * T::from(PAYLOAD.mass_kg),
            m - psi * lambda * T::from(PAYLOAD.inertia_kg_m2),
        ]
    })
}

/// Zero at a natural frequency: `M = −λ I_H` at the hub of unit rotation.
fn characteristic(own: &Timoshenko, omega: f64) -> TwoFloat {
    let lambda = TwoFloat::from(omega) * TwoFloat::from(omega);
    let [turned, bent, sheared] = missed(own, lambda);
    let moment = TwoFloat::from(0.0) - lambda * TwoFloat::from(HUB_KG_M2);
    let hub = [0, 1].map(|k: usize| turned[k] + bent[k] * moment);
    hub[0] * sheared[1] - hub[1] * sheared[0]
}

/// The root of the characteristic equation next to a frequency.
fn exact(own: &Timoshenko, near: f64) -> f64 {
    let is_above = |omega: f64| characteristic(own, omega) > TwoFloat::from(0.0);
    let (mut low, mut high) = (0.97 * near, 1.03 * near);
    assert_ne!(is_above(low), is_above(high), "no root, or two, at {near}");
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if is_above(middle) == is_above(low) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Relative errors of the first three frequencies on so many elements.
fn errors(slenderness: f64, elements: usize) -> Vec<f64> {
    let own = of_slenderness(slenderness);
    let found = natural_frequencies(&mesh_of(&link(Some(own)), elements), 3);
    let fine = natural_frequencies(&mesh_of(&link(Some(own)), 2000), 3);
    found.iter().zip(fine).map(|(found, near)| found / exact(&own, near) - 1.0).collect()
}

#[test]
fn frequencies_converge_to_the_closed_form_at_every_slenderness() {
    for (slenderness, bound) in
        [(5.0, 4e-6), (10.0, 1e-6), (30.0, 2e-7), (100.0, 2e-8), (1000.0, 3e-10)]
    {
        let found = errors(slenderness, 1000);
        assert!(found.iter().all(|error| error.abs() < bound), "{slenderness}: {found:?}");
        // From above: what static shapes leave out is energy.
        let coarse = errors(slenderness, 20);
        assert!(coarse.iter().all(|error| *error > 0.0), "{slenderness}: {coarse:?}");
    }
}

/// Thick links converge with order 2, slender ones with order 4 as long as shear is small beside the
/// element; the error that is stated covers the true one in between as well.
#[test]
fn the_order_is_two_or_four_and_the_stated_error_covers_the_true_one() {
    let order = |slenderness: f64, elements: usize, mode: usize| {
        (errors(slenderness, elements)[mode] / errors(slenderness, 2 * elements)[mode]).log2()
    };
    for mode in 0..3 {
        let thick = order(8.0, 80, mode);
        assert!((thick - 2.0).abs() < 0.02, "mode {mode}: {thick}");
        let slender = order(1000.0, 10, mode);
        assert!((slender - 4.0).abs() < 0.05, "mode {mode}: {slender}");
    }
    for slenderness in [5.0, 20.0, 50.0, 200.0, 1000.0] {
        let link = link(Some(of_slenderness(slenderness)));
        for elements in [10, 20, 40] {
            let mesh = mesh_of(&link, elements);
            let [found, finer] = [&mesh, &mesh.refined()].map(|mesh| natural_frequencies(mesh, 3));
            for (mode, error) in errors(slenderness, elements).iter().enumerate() {
                let stated = mesh.error_per_change() * (found[mode] / finer[mode] - 1.0);
                let share = stated / error;
                assert!(share > 0.99 && share < 1.3, "{slenderness} {elements} {mode}: {share}");
            }
        }
    }
}

/// With real exponents z, λ = −z²: the tip's displacement per hub angle changes its sign at the zeros.
#[test]
fn zeros_are_those_of_the_closed_form_and_no_more() {
    let tip = |own: &Timoshenko, lambda: f64| {
        let lambda = TwoFloat::from(lambda);
        let [[f, g], [a, c], [b, d]] = missed(own, lambda);
        let end = carried(own, lambda)[0];
        // The sign of the determinant of the clamped link does not change where λ is negative.
        end[1] * (a * d - b * c) + end[2] * (b * g - d * f) + end[3] * (c * f - a * g)
    };
    for slenderness in [4.0, 8.0, 20.0] {
        let own = of_slenderness(slenderness);
        let mesh = mesh_of(&link(Some(own)), 1000);
        let is_above = |lambda: f64| tip(&own, lambda) > TwoFloat::from(0.0);
        let places = |from: f64, to: f64| {
            (0..1200).map(move |k| from * (to / from).powf(f64::from(k) / 1200.0))
        };
        let crossings = |from: f64, to: f64, sign: f64| -> Vec<f64> {
            let all: Vec<f64> = places(from, to).collect();
            let pairs = all.windows(2);
            let has_root = |pair: &&[f64]| {
                is_above(sign * pair[0].powi(2)) != is_above(sign * pair[1].powi(2))
            };
            pairs.filter(has_root).map(|pair| 0.5 * (pair[0] + pair[1])).collect()
        };
        let near = |found: &[f64], exact: &[f64]| {
            assert_eq!(found.len(), exact.len(), "{slenderness}: {found:?} is not {exact:?}");
            for (found, exact) in found.iter().zip(exact) {
                assert!(
                    (found / exact - 1.0).abs() < 4e-3,
                    "{slenderness}: {found} is not {exact}"
                );
            }
        };
        // Beyond 400 1/s the determinant cancels in 106 bits.
        let mut found = torque_zeros(&mesh, 100);
        found.retain(|z| *z < 400.0);
        let exact = crossings(1.0, 400.0, -1.0);
        near(&found, &exact);
        let blocked = crossings(1.0, 600.0, 1.0);
        near(&real_frequency_zeros(&mesh, 600.0), &blocked);
    }
}

/// On a few elements, too, of which a tapered one is a thousand times softer than the first.
#[test]
fn a_nearly_slender_link_has_the_zeros_of_the_slender_one() {
    let ends = Taper { inner: STIFFNESS_N_M2, outer: 1e-3 * STIFFNESS_N_M2 };
    for stiffness in [Taper::constant(STIFFNESS_N_M2), ends] {
        let zeros = |timoshenko| {
            let segment = Segment {
                bending_stiffness_n_m2: stiffness,
                timoshenko,
                ..Segment::uniform(LENGTH_M, STIFFNESS_N_M2, MASS_KG_M)
            };
            let hub = Hub { inertia_kg_m2: HUB_KG_M2, ..Hub::default() };
            let link = Link::builder().segment(segment).hub(hub).build().unwrap();
            torque_zeros(&mesh_of(&link, 8), 3)
        };
        let (thick, slender) = (zeros(Some(of_slenderness(1e5))), zeros(None));
        assert_eq!((thick.len(), slender.len()), (3, 3), "{thick:?} {slender:?}");
        for (thick, slender) in thick.iter().zip(&slender) {
            assert!((thick / slender - 1.0).abs() < 1e-5, "{thick} is not {slender}");
        }
    }
}

/// What a mesh of a thick link has beyond its real zeros moves with its elements: it is no zero of the link.
#[test]
fn zeros_of_the_mesh_alone_are_left_out() {
    let own = of_slenderness(3.0);
    let counts = [32, 64, 128, 256, 1024]
        .map(|elements| torque_zeros(&mesh_of(&link(Some(own)), elements), 10).len());
    assert!(counts.iter().all(|count| *count == counts[0]) && counts[0] > 0, "{counts:?}");
}

#[test]
fn a_stiff_web_without_rotary_inertia_is_the_slender_link() {
    let own = Timoshenko {
        shear_stiffness_n: Taper::constant(1e18),
        rotary_inertia_per_length_kg_m: Taper::constant(0.0),
    };
    let of = |own| natural_frequencies(&mesh_of(&link(own), 30), 8);
    for (thick, slender) in of(Some(own)).iter().zip(of(None)) {
        assert!((thick / slender - 1.0).abs() < 1e-12, "{thick} is not {slender}");
    }
}

/// `T/a_tip` of the damped link, `λ = ω²/(1 + 2iξ)` in K alone.
#[test]
fn torque_per_acceleration_is_that_of_the_closed_form() {
    for (slenderness, bound) in [(6.0, 2e-5), (20.0, 2e-6), (1000.0, 1e-8)] {
        let own = of_slenderness(slenderness);
        let mesh = mesh_of(&link(Some(own)), 1000);
        for omega in [0.5, 6.0, 20.0, 55.0, 140.0] {
            let lambda = Complex64::from(omega * omega) / Complex64::new(1.0, 0.04);
            let [[f, g], [a, c], [b, d]] = missed(&own, lambda);
            let determinant = a * d - b * c;
            let moment = (b * g - d * f) / determinant;
            let force = (c * f - a * g) / determinant;
            let end = carried(&own, lambda)[0];
            let tip = end[1] + end[2] * moment + end[3] * force;
            let exact = (moment + lambda * HUB_KG_M2) / (lambda * tip);
            let found = tip_transfer(&mesh, lambda).inertia_kg_m;
            assert!(
                (found - exact).norm() < bound * exact.norm(),
                "{omega}: {found} is not {exact}"
            );
        }
    }
}
