//! Flexible-link manipulator: Gu, Petkov and Konstantinov, *Robust Control Design with MATLAB*,
//! Springer, 2005.
//!
//! | | printed, SI |
//! |---|---|
//! | length from the root | 1.0 m |
//! | hub radius | 0.04 m |
//! | bending stiffness | 18.4 N m² |
//! | mass per length | 0.54 kg/m |
//! | hub inertia | 0.1 kg m² |
//! | payload | 0.25 kg, uncertain by 40 % either way |

use super::closed_form::{self, roots};
use super::{FINE, assert_close, clamped_frequencies, frequencies, specification};

const FILE: &str = "gu_petkov.toml";

#[test]
fn the_rigid_inertia_counts_from_the_axis_and_not_from_the_root() {
    let link = specification(FILE, &[]).link().clone();
    let rod = 0.54 * (1.04_f64.powi(3) - 0.04_f64.powi(3)) / 3.0;
    let expected = 0.1 + rod + 0.25 * 1.04 * 1.04;
    assert!((link.rigid_inertia_kg_m2() / expected - 1.0).abs() < 1e-14);
}

/// Clamped at the root, `μ = m_t/m̄l`: 1 + cos b cosh b + μb (cos b sinh b − sin b cosh b) = 0.
#[test]
fn clamped_frequencies_know_nothing_of_the_hub_radius() {
    for factor in ["0.6", "1", "1.4"] {
        let payload = format!("payload.mass*={factor}");
        let link = specification(FILE, &[&payload]).link().clone();
        let mu = link.payload().mass_kg / 0.54;
        let numbers =
            roots(|b| 1.0 / b.cosh() + b.cos() + mu * b * (b.cos() * b.tanh() - b.sin()), 3);
        let expected = closed_form::frequencies(&link, &numbers);
        assert_close(&clamped_frequencies(FILE, &[FINE, &payload], 3), &expected, 1e-9);
    }
}

/// Free hub with the root at radius r from the axis, length l = 1 m. With k = b/l and
/// v = A cos kx + B sin kx + C cosh kx + D sinh kx the root moves as v = rθ, v′ = θ, and the hub
/// obeys `I_H θ̈ = EI v″ − r EI v‴`: A, C and D follow from θ and B, and the tip's two conditions
/// leave a 2×2 determinant. Divided by cosh kl where that is large.
fn free_hub(b: f64, mu: f64) -> f64 {
    let (mass, hub, radius) = (0.54, 0.1, 0.04);
    let (sin, cos, tanh) = (b.sin() / b.cosh(), b.cos() / b.cosh(), b.tanh());
    let tip = |theta: f64, sine: f64| {
        let cosine = 0.5 * b * b * hub / mass * theta + radius * b * sine;
        let (cosh, sinh) = (radius * theta - cosine, theta / b - sine);
        let moment = -cosine * cos - sine * sin + cosh + sinh * tanh;
        let shear = cosine * sin - sine * cos + cosh * tanh + sinh;
        let motion = cosine * cos + sine * sin + cosh + sinh * tanh;
        (moment, shear + mu * b * motion)
    };
    let (angle, sine) = (tip(1.0, 0.0), tip(0.0, 1.0));
    (angle.0 * sine.1 - sine.0 * angle.1) * b.cosh()
}

#[test]
fn frequencies_of_the_free_hub_know_its_radius() {
    for factor in ["0.6", "1", "1.4"] {
        let payload = format!("payload.mass*={factor}");
        let link = specification(FILE, &[&payload]).link().clone();
        let mu = link.payload().mass_kg / 0.54;
        let expected = closed_form::frequencies(&link, &roots(|b| free_hub(b, mu), 3));
        let found = frequencies(FILE, &[FINE, &payload], 3);
        assert_close(&found, &expected, 1e-9);
        let without = frequencies(FILE, &[FINE, &payload, "hub.radius=0"], 3);
        assert!(found[0] > 1.01 * without[0], "the radius matters: {} rad/s", without[0]);
    }
}
