//! The uniform Bernoulli-Euler link in closed form, written down without the program's recursion.
//!
//! EI v'''' = m̄ λ v on 0 ≤ x ≤ L, with v(0) = 0, a payload at x = L and the hub at x = 0. From the
//! tip inward, s = L − x, every solution is a sum of Krylov's functions
//!
//! ```text
//! S_j(s) = Σ_k q^k s^(4k+j)/(4k+j)!,   q = λ m̄/EI;   S_0' = q S_3, S_j' = S_(j-1)
//! S_0 = (cosh βs + cos βs)/2, …, S_3 = (sinh βs − sin βs)/(2β³) with β⁴ = q
//! ```
//!
//! These are entire functions of q, so nothing is singular at λ = 0; in 106 bits their sums keep
//! more than 53 correct ones up to |βL| = 20. What the payload asks of the beam's end is
//!
//! ```text
//! EI v''(L)  =  λ [m_t c v + (J_t + m_t c²) v']
//! EI v'''(L) = −λ [m_t v + m_t c v']
//! ```
//!
//! and v(0) = 0 fixes the ratio of v(L) = F to v'(L) = N.

use flexlink::beam::Mesh;
use flexlink::link::{Hub, Link, LinkParts, Payload, Segment};
use num_complex::{Complex, Complex64};
use twofloat::TwoFloat;

use crate::common::mesh_of;

/// A complex number of 2 × 106 bits.
type Long = Complex<TwoFloat>;

/// A link of one uniform segment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UniformLink {
    pub(crate) length_m: f64,
    pub(crate) bending_stiffness_n_m2: f64,
    pub(crate) mass_per_length_kg_m: f64,
    pub(crate) hub_inertia_kg_m2: f64,
    pub(crate) payload: Payload,
}

/// The solution at one λ. All are entire functions of λ with one common factor.
pub(crate) struct Solution<'a> {
    link: &'a UniformLink,
    lambda: Long,
    /// F = v(L).
    tip: Long,
    /// N = v'(L).
    slope: Long,
    /// v''(L)/λ and −v'''(L)/λ.
    load: [Long; 2],
}

impl UniformLink {
    /// The link of the paper's section "Numerical examples", all of it uniform.
    pub(crate) const BAYO: Self = Self {
        length_m: 1.5,
        bending_stiffness_n_m2: 5.0,
        mass_per_length_kg_m: 0.8,
        hub_inertia_kg_m2: 0.1,
        payload: Payload { mass_kg: 0.0, inertia_kg_m2: 0.0, offset_m: 0.0 },
    };

    /// L = EI = m̄ = 1, so that ω = b², with `η = I_H/m̄L³` and `μ = m_t/m̄L`.
    pub(crate) fn unit(eta: f64, mu: f64) -> Self {
        Self {
            length_m: 1.0,
            bending_stiffness_n_m2: 1.0,
            mass_per_length_kg_m: 1.0,
            hub_inertia_kg_m2: eta,
            payload: Payload { mass_kg: mu, ..Payload::default() },
        }
    }

    /// The same link in finite elements.
    pub(crate) fn mesh(&self, elements: usize) -> Mesh {
        let link = Link::new(LinkParts {
            segments: vec![Segment::uniform(
                self.length_m,
                self.bending_stiffness_n_m2,
                self.mass_per_length_kg_m,
            )],
            hub: Hub { inertia_kg_m2: self.hub_inertia_kg_m2, ..Hub::default() },
            payload: self.payload,
            ..LinkParts::default()
        })
        .expect("a valid link");
        mesh_of(&link, elements)
    }

    /// |β|h of an element: how finely a mesh resolves the bending wave of λ.
    pub(crate) fn resolution(&self, lambda: Complex64, elements: usize) -> f64 {
        let q = lambda.norm() * self.mass_per_length_kg_m / self.bending_stiffness_n_m2;
        q.powf(0.25) * self.length_m / elements as f64
    }

    pub(crate) fn solve(&self, lambda: Complex64) -> Solution<'_> {
        let lambda = long(lambda);
        let Payload { mass_kg, inertia_kg_m2, offset_m } = self.payload;
        let m = real(mass_kg);
        let mc = m * real(offset_m);
        let j = real(inertia_kg_m2) + mc * real(offset_m);
        let compliance = over(real(1.0), self.bending_stiffness_n_m2);
        let [s0, s1, s2, s3] = krylov(self.q(lambda), real(self.length_m));
        let tip = s1 - compliance * lambda * (j * s2 + mc * s3);
        let slope = s0 + compliance * lambda * (mc * s2 + m * s3);
        let load = [compliance * (mc * tip + j * slope), compliance * (m * tip + mc * slope)];
        Solution { link: self, lambda, tip, slope, load }
    }

    fn q(&self, lambda: Long) -> Long {
        over(lambda * real(self.mass_per_length_kg_m), self.bending_stiffness_n_m2)
    }
}

impl Solution<'_> {
    /// v and v' at x, and EI v''/λ: what the inner part exerts on the outer part there, per −ω².
    fn at(&self, x: Long) -> [Long; 3] {
        let link = self.link;
        let (v, phi, lambda, [m, f]) = (self.tip, self.slope, self.lambda, self.load);
        let q = link.q(lambda);
        let [s0, s1, s2, s3] = krylov(q, real(link.length_m) - x);
        let mass = real(link.mass_per_length_kg_m);
        let ei = real(link.bending_stiffness_n_m2);
        [
            v * s0 - phi * s1 + lambda * (m * s2 + f * s3),
            phi * s0 - v * q * s3 - lambda * (m * s1 + f * s2),
            mass * (v * s2 - phi * s3) + ei * (m * s0 + f * s1),
        ]
    }

    /// Vanishes at a zero of torque → tip, entire in λ.
    pub(crate) fn tip_motion(&self) -> f64 {
        short(self.tip).re
    }

    /// Vanishes at a natural frequency, entire in λ.
    pub(crate) fn torque(&self) -> f64 {
        short(self.long_torque()).re
    }

    /// Share of the beam's own mass in the kinetic energy, for real λ.
    pub(crate) fn beam_share_of_kinetic_energy(&self) -> f64 {
        let motion = |x: f64| self.at(real(x)).map(|z| short(z).re);
        let link = self.link;
        let intervals = 200;
        let h = link.length_m / f64::from(intervals);
        let simpson = |k: i32| match k {
            _ if k == 0 || k == intervals => h / 3.0,
            _ if k % 2 == 1 => 4.0 * h / 3.0,
            _ => 2.0 * h / 3.0,
        };
        let squares = (0..=intervals).map(|k| simpson(k) * motion(h * f64::from(k))[0].powi(2));
        let beam = link.mass_per_length_kg_m * squares.sum::<f64>();
        let ([_, theta, _], [v, phi, _]) = (motion(0.0), motion(link.length_m));
        let payload = link.payload.mass_kg * (v + link.payload.offset_m * phi).powi(2)
            + link.payload.inertia_kg_m2 * phi * phi;
        beam / (beam + payload + link.hub_inertia_kg_m2 * theta * theta)
    }

    fn long_torque(&self) -> Long {
        let [_, theta, moment] = self.at(real(0.0));
        real(self.link.hub_inertia_kg_m2) * theta + moment
    }

    /// `T/a_tip` in kg m.
    pub(crate) fn inertia_kg_m(&self) -> Complex64 {
        short(self.long_torque()) / short(self.tip)
    }

    /// `θ/v_tip` in rad/m.
    pub(crate) fn angle_rad_m(&self) -> Complex64 {
        short(self.at(real(0.0))[1]) / short(self.tip)
    }

    /// `(v(x) − xθ)/(λ v_tip)` in s².
    pub(crate) fn deflection_s2(&self, x_m: f64) -> Complex64 {
        let theta = self.at(real(0.0))[1];
        let v = self.at(real(x_m))[0];
        short(v - theta * real(x_m)) / short(self.lambda * self.tip)
    }

    /// Moment that the part inside x exerts on the part outside, per tip acceleration, in kg m.
    pub(crate) fn moment_kg_m(&self, x_m: f64) -> Complex64 {
        short(self.at(real(x_m))[2]) / short(self.tip)
    }
}

/// Krylov's functions `S_0` … `S_3` by their power series.
fn krylov(q: Long, s: Long) -> [Long; 4] {
    let step = q * s * s * s * s;
    let leading =
        [(0.0, real(1.0)), (1.0, s), (2.0, over(s * s, 2.0)), (3.0, over(s * s * s, 6.0))];
    leading.map(|(j, leading)| {
        let (mut term, mut sum) = (leading, leading);
        let mut n: f64 = j;
        while short(term).norm() > 1e-34 * short(sum).norm() {
            let next = (n + 1.0) * (n + 2.0) * (n + 3.0) * (n + 4.0);
            term = over(term * step, next);
            sum += term;
            n += 4.0;
        }
        sum
    })
}

/// Division by 53 bits: that by 106 keeps 53 only (`twofloat` 0.8 forms 1 − b·(1/b) unfused).
fn over(z: Long, divisor: f64) -> Long {
    Complex::new(z.re / divisor, z.im / divisor)
}

fn real(x: f64) -> Long {
    Complex::new(TwoFloat::from(x), TwoFloat::from(0.0))
}

fn long(z: Complex64) -> Long {
    Complex::new(TwoFloat::from(z.re), TwoFloat::from(z.im))
}

fn short(z: Long) -> Complex64 {
    Complex64::new(z.re.hi(), z.im.hi())
}

#[test]
fn the_series_are_krylovs_functions() {
    for beta in [0.3, 2.0, 7.0_f64] {
        let s = krylov(real(beta.powi(4)), real(1.0)).map(|z| short(z).re);
        let (ch, sh, c, si) = (beta.cosh(), beta.sinh(), beta.cos(), beta.sin());
        let trigonometric = [
            0.5 * (ch + c),
            (sh + si) / (2.0 * beta),
            (ch - c) / (2.0 * beta.powi(2)),
            (sh - si) / (2.0 * beta.powi(3)),
        ];
        for (a, b) in s.iter().zip(trigonometric) {
            assert!((a / b - 1.0).abs() < 1e-12, "β = {beta}: {a} is not {b}");
        }
    }
}

#[test]
fn the_closed_form_is_the_rigid_link_at_rest() {
    let mut link = UniformLink::BAYO;
    link.payload = Payload { mass_kg: 0.3, inertia_kg_m2: 0.02, offset_m: 0.1 };
    let rigid = 0.1 + 0.8 * 1.5_f64.powi(3) / 3.0 + 0.3 * 1.6_f64.powi(2) + 0.02;
    let solution = link.solve(Complex64::ZERO);
    assert!((solution.inertia_kg_m() * 1.5 / rigid - 1.0).norm() < 1e-15);
    assert!((solution.angle_rad_m() * 1.5 - 1.0).norm() < 1e-15);
}

/// Roots of a function of b = βL, found without the program's own search: the first `count` sign
/// changes of `f` on 0.05 < b < 20, ascending, bisected to the last bit.
pub(crate) fn roots(count: usize, f: impl Fn(f64) -> f64) -> Vec<f64> {
    const STEP: f64 = 0.05;
    let is_negative = |b: f64| f(b) < 0.0;
    let bisect = |mut low: f64| {
        let (start, mut step) = (is_negative(low), STEP);
        while low + step > low {
            step *= 0.5;
            if is_negative(low + step) == start {
                low += step;
            }
        }
        low
    };
    (1..400)
        .map(|k| STEP * f64::from(k))
        .filter(|b| is_negative(*b) != is_negative(b + STEP))
        .take(count)
        .map(bisect)
        .collect()
}
