//! Undamped modes of the link with a free hub, from the closed form: frequencies where the apparent
//! inertia vanishes, what each mode gives by contour integrals, the rest by its Taylor series.
//!
//! With T = −ω²I the link moves by v = x + ω²U, and over λ = ω²
//!
//! ```text
//! U_x(λ) = Σ_k ρ_k(x)/(λ_k − λ) + R_x(λ)
//! ```
//!
//! Modal damping puts `2iζ_kω_kω` beside `λ_k − λ`.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::beam::{Beam, Frequency, Turned};

/// Points on a circle around one mode, and around all of them.
const AROUND_ONE: usize = 32;
const AROUND_ALL: usize = 256;

/// Terms of the Taylor series of what is left.
const TERMS: usize = 40;

/// A field over the hub's own turn and the stations: U of the hub, of the tip, of the stations.
type Field = Vec<Complex64>;

/// The lowest modes and the rest.
pub(crate) struct Modes {
    pub(crate) omegas_rad_s: Vec<f64>,
    shares: Vec<Field>,
    rest: Vec<Field>,
    radius: f64,
    inertia_kg_m2: f64,
}

fn undamped(square: Complex64) -> Frequency {
    Frequency { square, stiffness: Complex64::ONE, mass: Complex64::ONE }
}

/// The first natural frequencies in rad/s, the rigid rotation left out.
///
/// They are the zeros of `T/a_tip` over real ω. Its poles are where the tip is blocked: none but what
/// a body's rotary inertia makes.
pub(crate) fn natural_frequencies(beam: &Beam, count: usize) -> Vec<f64> {
    let to_tip = beam.to_tip();
    let transfer = |omega: f64| {
        let turned = to_tip.turned(undamped((omega * omega).into()));
        (turned.inertia_kg_m2 / turned.tip_m).re
    };
    // Steps of the waves in the link, and so of √ω.
    let unit = 1.0 / beam.waves(undamped(Complex64::ONE));
    let omega_at = |k: usize| (k as f64 * 0.01 * unit).powi(2);
    let mut found = Vec::new();
    let mut before = transfer(omega_at(1));
    for k in 2.. {
        let here = transfer(omega_at(k));
        if before * here < 0.0 {
            let root = bisected(&transfer, [omega_at(k - 1), omega_at(k)]);
            if transfer(root).abs() < before.abs().max(here.abs()) {
                found.push(root);
            }
            if found.len() == count {
                break;
            }
        }
        before = here;
    }
    found
}

fn bisected(f: &dyn Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> f64 {
    let at_low = f(low);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) * at_low > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

impl Modes {
    /// The lowest `count` modes of the link.
    ///
    /// # Panics
    /// If a mode was missed: the rest is no Taylor series then.
    pub(crate) fn new(beam: &Beam, count: usize) -> Self {
        let mut omegas = natural_frequencies(beam, count + 1);
        let squares: Vec<f64> = omegas.iter().map(|omega| omega * omega).collect();
        let field = |square: Complex64| scaled(beam, square);
        let shares: Vec<Field> = (0..count)
            .map(|k| {
                let below = if k == 0 { squares[k] } else { squares[k] - squares[k - 1] };
                let radius = 0.3 * below.min(squares[k + 1] - squares[k]);
                let circle = |m: usize| {
                    Complex64::from_polar(radius, TAU * (m as f64 + 0.5) / AROUND_ONE as f64)
                };
                let sum = (0..AROUND_ONE).map(|m| {
                    let offset = circle(m);
                    let weight = -offset / AROUND_ONE as f64;
                    field(squares[k] + offset).iter().map(|u| u * weight).collect::<Field>()
                });
                sum.reduce(added).expect("points on a circle")
            })
            .collect();
        // Half way between two modes, far within the first one that is left.
        let radius = 0.5 * (squares[count / 2 - 1] + squares[count / 2]);
        let rest_at = |square: Complex64| {
            let mut rest = field(square);
            for (share, pole) in shares.iter().zip(&squares) {
                for (r, s) in rest.iter_mut().zip(share) {
                    *r -= s / (pole - square);
                }
            }
            rest
        };
        let angle = |m: usize| TAU * (m as f64 + 0.5) / AROUND_ALL as f64;
        let ring: Vec<Field> =
            (0..AROUND_ALL).map(|m| rest_at(Complex64::from_polar(radius, angle(m)))).collect();
        let rest: Vec<Field> = (0..TERMS)
            .map(|j| {
                let terms = ring.iter().enumerate().map(|(m, field)| {
                    let turn = Complex64::from_polar(1.0 / AROUND_ALL as f64, -angle(m) * j as f64);
                    field.iter().map(|r| r * turn).collect::<Field>()
                });
                terms.reduce(added).expect("points on a circle")
            })
            .collect();
        omegas.truncate(count);
        let inertia_kg_m2 = beam.rigid_inertia_kg_m2();
        let modes = Self { omegas_rad_s: omegas, shares, rest, radius, inertia_kg_m2 };
        modes.held_against(beam, 0.1 * squares[count - 1].sqrt());
        modes
    }

    /// Panics if the modes do not give the link back, undamped but for a complex frequency.
    fn held_against(&self, beam: &Beam, omega: f64) {
        let square = Complex64::new(omega * omega, 0.05 * omega * omega);
        let found = self.field(square, Complex64::ZERO, &vec![0.0; self.omegas_rad_s.len()]);
        let expected = scaled(beam, square);
        let largest = expected.iter().fold(0.0_f64, |m, u| m.max(u.norm()));
        for (found, expected) in found.iter().zip(&expected) {
            let off = (found - expected).norm() / largest;
            assert!(off < 1e-8, "modes miss the link by {off:e} at {omega} rad/s");
        }
    }

    /// U where each mode has a damping rate 2ζω in 1/s, and velocity is `rate` times displacement.
    fn field(&self, square: Complex64, rate: Complex64, rates_per_s: &[f64]) -> Field {
        let mut field: Field = vec![Complex64::ZERO; self.rest[0].len()];
        let modes = self.shares.iter().zip(&self.omegas_rad_s).zip(rates_per_s);
        for ((share, omega), damping) in modes {
            let pole = omega * omega - square + damping * rate;
            for (u, s) in field.iter_mut().zip(share) {
                *u += s / pole;
            }
        }
        let mut power = Complex64::ONE;
        for term in &self.rest {
            for (u, r) in field.iter_mut().zip(term) {
                *u += r * power;
            }
            power *= square / self.radius;
        }
        field
    }

    /// The link under T = −ω²I where `rate_per_s` is 2ζω of each mode: as [`Turned`], with the
    /// hub's own u besides.
    pub(crate) fn damped(
        &self,
        omega: f64,
        length_m: f64,
        rates_per_s: &[f64],
    ) -> (Turned, Complex64) {
        let square = Complex64::from(omega * omega);
        let field = self.field(square, Complex64::new(0.0, omega), rates_per_s);
        let turned = Turned {
            tip_m: length_m + square * field[1],
            tip_u: field[1],
            inertia_kg_m2: self.inertia_kg_m2.into(),
            u: field[2..].to_vec(),
            moment: vec![Complex64::new(f64::NAN, f64::NAN); field.len() - 2],
        };
        (turned, field[0])
    }
}

/// U of hub, tip and stations under T = −ω²I.
fn scaled(beam: &Beam, square: Complex64) -> Field {
    let turned = beam.turned(undamped(square));
    let scale = beam.rigid_inertia_kg_m2() / turned.inertia_kg_m2;
    // (scale − 1)/λ; the field is only asked for far from λ = 0.
    let lift = (scale - 1.0) / square;
    let hub = std::iter::once(lift);
    let tip = std::iter::once(beam.rigid_output() * lift + scale * turned.tip_u);
    let stations = turned.u.iter().zip(beam.rigid_stations()).map(|(u, r)| r * lift + scale * u);
    hub.chain(tip).chain(stations).collect()
}

fn added(a: Field, b: Field) -> Field {
    a.into_iter().zip(b).map(|(a, b)| a + b).collect()
}
