//! The uniform link without hub radius, in closed form: ω = b² √(EI/m̄L⁴).

use flexlink::link::Link;

/// Uniform link in dimensionless numbers: `η = I_H/m̄L³`, `μ = m_t/m̄L`.
pub(crate) struct Uniform {
    pub(crate) hub: f64,
    pub(crate) payload: f64,
}

impl Uniform {
    /// The dimensionless numbers of a link that has one uniform segment and a point payload.
    pub(crate) fn of(link: &Link) -> Self {
        let (length, mass) = (link.length_m(), link.segments()[0].mass_per_length_kg_m.inner);
        Self {
            hub: link.hub().inertia_kg_m2 / (mass * length.powi(3)),
            payload: link.payload().mass_kg / (mass * length),
        }
    }

    /// Free hub: (cos b sinh b − sin b cosh b) − 2μb sin b sinh b
    /// − ηb³ [1 + cos b cosh b + μb (cos b sinh b − sin b cosh b)] = 0, over cosh b.
    fn free_hub(&self, b: f64) -> f64 {
        let (sin, cos, tanh) = (b.sin(), b.cos(), b.tanh());
        let (mu, eta) = (self.payload, self.hub);
        (cos * tanh - sin) - 2.0 * mu * b * sin * tanh - eta * b.powi(3) * self.clamped(b)
    }

    /// Clamped: 1 + cos b cosh b + μb (cos b sinh b − sin b cosh b) = 0, over cosh b.
    fn clamped(&self, b: f64) -> f64 {
        let (sin, cos, tanh) = (b.sin(), b.cos(), b.tanh());
        1.0 / b.cosh() + cos + self.payload * b * (cos * tanh - sin)
    }

    pub(crate) fn free_hub_numbers(&self, count: usize) -> Vec<f64> {
        roots(|b| self.free_hub(b), count)
    }

    pub(crate) fn clamped_numbers(&self, count: usize) -> Vec<f64> {
        roots(|b| self.clamped(b), count)
    }
}

/// √(EI/m̄l⁴) in rad/s, with l the length of the segment.
pub(crate) fn unit_frequency(link: &Link) -> f64 {
    let segment = &link.segments()[0];
    let (ei, mass) = (segment.bending_stiffness_n_m2.inner, segment.mass_per_length_kg_m.inner);
    (ei / mass).sqrt() / segment.length_m.powi(2)
}

/// Natural frequencies in rad/s of dimensionless numbers b.
pub(crate) fn frequencies(link: &Link, numbers: &[f64]) -> Vec<f64> {
    numbers.iter().map(|b| b * b * unit_frequency(link)).collect()
}

/// The first roots above 0.3: by steps of 0.01, then bisection.
pub(crate) fn roots(function: impl Fn(f64) -> f64, count: usize) -> Vec<f64> {
    let changes = (30..).map(|k| (0.01 * f64::from(k), 0.01 * f64::from(k + 1)));
    let brackets = changes.filter(|(low, high)| function(*low) * function(*high) < 0.0);
    let bisected = brackets.map(|(mut low, mut high)| {
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if function(low) * function(middle) <= 0.0 { high = middle } else { low = middle }
        }
        low
    });
    bisected.take(count).collect()
}

#[test]
fn the_closed_form_gives_the_roots_of_the_textbooks() {
    let numbers = |hub, payload| Uniform { hub, payload }.free_hub_numbers(3);
    for ((hub, payload), expected) in [
        ((0.0, 0.0), [3.926_602_312, 7.068_582_746, 10.210_176_12]),
        ((1.0 / 27.0, 0.0), [3.116_156_922, 4.970_050_622, 7.912_340_048]),
        ((0.1, 1.0), [2.326_474_278, 4.184_594_707, 7.161_872_009]),
    ] {
        super::assert_close(&numbers(hub, payload), &expected, 1e-9);
    }
    let cantilever = Uniform { hub: 0.0, payload: 0.0 }.clamped_numbers(2);
    super::assert_close(&cantilever, &[1.875_104_069, 4.694_091_133], 1e-9);
}
