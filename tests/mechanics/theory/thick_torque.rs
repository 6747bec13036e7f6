//! What shear and rotary inertia change of a torque, estimated and by Timoshenko's beam.

use std::f64::consts::{PI, TAU};

use flexlink::link::{Link, Payload, Section};
use flexlink::modal::{DampingLaw, Thickness, natural_frequencies};
use num_complex::Complex64;

use super::thickness::{bar, link, mesh, short_bar};

/// Steps of the integration along each segment.
const STEPS: usize = 60;

/// Frequencies up to where the motion's content ends.
const FREQUENCIES: usize = 240;

const DAMPING: DampingLaw = DampingLaw::Hysteretic { ratio: 0.02 };

type State = [Complex64; 4];

/// The beam at one λ; slender where it has neither shear nor rotary inertia.
struct Beam<'a> {
    link: &'a Link,
    lambda: Complex64,
    is_thick: bool,
}

impl Beam<'_> {
    /// State (v, ψ, M, Q) at the tip, of one at the hub.
    ///
    /// ```text
    /// v' = ψ + Q/(κGA),  ψ' = M/EI,  M' = −Q − m̄r²λψ,  Q' = −m̄λv
    /// ```
    fn carried(&self, mut state: State) -> State {
        let along = |from: State, step: f64, slope: State| {
            std::array::from_fn::<_, 4, _>(|k| from[k] + slope[k] * step)
        };
        for segment in self.link.segments() {
            let section = segment.cross_section.unwrap();
            let ei = segment.bending_stiffness_n_m2.inner;
            let mass = segment.mass_per_length_kg_m.inner;
            let thick = if self.is_thick { 1.0 } else { 0.0 };
            let square_m2 = thick * section.radius_of_gyration_m.inner.powi(2);
            let shear = square_m2 * section.shear_flexibility() / ei;
            let slopes = |[v, psi, m, q]: State| {
                let turned = psi * self.lambda * (mass * square_m2);
                [psi + q * shear, m / ei, -q - turned, -v * self.lambda * mass]
            };
            let h = segment.length_m / STEPS as f64;
            for _ in 0..STEPS {
                let a = slopes(state);
                let b = slopes(along(state, 0.5 * h, a));
                let c = slopes(along(state, 0.5 * h, b));
                let d = slopes(along(state, h, c));
                let sum = |k: usize| (a[k] + b[k] * 2.0 + c[k] * 2.0 + d[k]) / 6.0;
                state = along(state, h, std::array::from_fn(sum));
            }
        }
        state
    }

    /// `T/a_tip`, but for its sign.
    fn transfer(&self) -> Complex64 {
        let Payload { mass_kg, inertia_kg_m2, .. } = *self.link.payload();
        let ends = [1, 2, 3].map(|k| {
            let mut start = [Complex64::ZERO; 4];
            start[k] = Complex64::ONE;
            self.carried(start)
        });
        // The tip carries its payload and nothing else.
        let missed = ends.map(|[v, psi, m, q]| {
            [q - v * self.lambda * mass_kg, m - psi * self.lambda * inertia_kg_m2]
        });
        let [[f, g], [a, c], [b, d]] = missed;
        let determinant = a * d - b * c;
        let moment = (b * g - d * f) / determinant;
        let force = (c * f - a * g) / determinant;
        let tip = ends[0][0] + ends[1][0] * moment + ends[2][0] * force;
        (moment + self.lambda * self.link.hub().inertia_kg_m2) / (self.lambda * tip)
    }
}

/// Amplitude at ω of the acceleration of a sin⁶ velocity of one second.
fn acceleration(omega: f64) -> Complex64 {
    let samples = 400_u32;
    let at = |k: u32| {
        let time = f64::from(k) / f64::from(samples);
        let phase = PI * time;
        Complex64::cis(-omega * time) * (phase.sin().powi(5) * phase.cos())
    };
    (0..samples).map(at).sum::<Complex64>()
}

/// True and estimated change of the torque of a motion that lasts so many of the first periods.
fn changes(link: &Link, periods: f64) -> (f64, f64) {
    let mesh = mesh(link);
    let modes = natural_frequencies(&mesh, 5);
    let duration_s = periods * TAU / modes[0];
    // The spectrum falls with the seventh power of the frequency.
    let highest = 12.0 * TAU / duration_s;
    let omegas: Vec<f64> =
        (1..=FREQUENCIES).map(|k| highest * k as f64 / FREQUENCIES as f64).collect();
    let torque = |is_thick: bool| -> Vec<Complex64> {
        let at = |omega: &f64| {
            let beam = Beam { link, lambda: DAMPING.lambda(*omega), is_thick };
            beam.transfer() * acceleration(omega * duration_s)
        };
        omegas.iter().map(at).collect()
    };
    let (slender, thick) = (torque(false), torque(true));
    let power = |torque: &[Complex64]| torque.iter().map(Complex64::norm_sqr).sum::<f64>();
    let difference: Vec<Complex64> = slender.iter().zip(&thick).map(|(a, b)| b - a).collect();
    let estimate =
        Thickness::known(link).torque_change(&mesh, &DAMPING, &modes, (&omegas, &slender));
    ((power(&difference) / power(&slender)).sqrt(), estimate)
}

#[test]
fn the_change_of_a_torque_is_estimated_within_a_factor_of_about_three_wherever_its_band_lies() {
    let rectangle = |thickness_m: f64| bar(1.0, &Section::Rectangle { width_m: 0.02, thickness_m });
    let tube = bar(0.6, &Section::Tube { diameter_m: 0.05, wall_m: 0.002 });
    let strip = bar(0.4, &Section::Rectangle { width_m: 0.05, thickness_m: 0.02 });
    let payload = Payload { mass_kg: 2.0, inertia_kg_m2: 0.002, offset_m: 0.0 };
    let mut warned = [0, 0];
    for link in [
        short_bar(),
        link(vec![rectangle(0.05)], 0.0, Payload::default()),
        link(vec![rectangle(0.05)], 0.3, Payload { mass_kg: 2.0, ..Payload::default() }),
        link(vec![rectangle(0.03)], 20.0, Payload::default()),
        link(vec![tube, strip], 0.02, payload),
    ] {
        for periods in [20.0, 8.0, 3.0, 1.0, 0.5] {
            let (found, estimate) = changes(&link, periods);
            let ratio = estimate / found;
            assert!((0.3..3.5).contains(&ratio), "{periods} periods: {estimate} of {found}");
            warned[usize::from(estimate > 0.01)] += 1;
        }
    }
    assert!(warned.iter().all(|cases| *cases >= 8), "{warned:?}");
}

#[test]
fn a_torque_that_peaks_at_a_real_zero_in_its_band_changes_with_that_zero() {
    let rectangle = |thickness_m: f64| bar(1.0, &Section::Rectangle { width_m: 0.02, thickness_m });
    let tube = bar(0.6, &Section::Tube { diameter_m: 0.05, wall_m: 0.002 });
    let payload =
        |mass_kg: f64, inertia_kg_m2: f64| Payload { mass_kg, inertia_kg_m2, offset_m: 0.0 };
    for link in [
        link(vec![rectangle(0.05)], 0.3, payload(2.0, 0.1)),
        link(vec![rectangle(0.05)], 0.3, payload(1.0, 0.5)),
        link(vec![rectangle(0.03)], 5.0, payload(1.0, 0.02)),
        link(vec![tube], 0.02, payload(0.5, 0.05)),
    ] {
        for periods in [20.0, 8.0, 3.0, 1.0, 0.5] {
            let (found, estimate) = changes(&link, periods);
            let ratio = estimate / found;
            assert!((0.5..2.5).contains(&ratio), "{periods} periods: {estimate} of {found}");
        }
    }
}
