/// A Caughey series through chosen modes (Bayo 1987, eq 12).
///
/// ```text
/// C = M Σ a_b (M⁻¹K)ᵇ,   2ζω = Σ a_b ω²ᵇ,   b = 0 … p − 1
/// ```
///
/// Kept in Newton's form over ω², in which neighbouring modes cost no digits.
#[derive(Debug, Clone, PartialEq)]
pub struct CaugheySeries {
    /// ω² of the chosen modes in rad²/s².
    squares: Vec<f64>,
    /// Divided differences of 2ζω over ω².
    differences: Vec<f64>,
}

impl CaugheySeries {
    /// The series that gives modes of these ascending frequencies in rad/s these ratios.
    pub(super) fn through(frequencies: &[f64], ratios: &[f64]) -> Self {
        let squares: Vec<f64> = frequencies.iter().map(|omega| omega * omega).collect();
        let mut differences: Vec<f64> =
            frequencies.iter().zip(ratios).map(|(omega, ratio)| 2.0 * ratio * omega).collect();
        for order in 1..squares.len() {
            for k in (order..squares.len()).rev() {
                let rise = differences[k] - differences[k - 1];
                differences[k] = rise / (squares[k] - squares[k - order]);
            }
        }
        Self { squares, differences }
    }

    /// 2ζω in 1/s at a natural frequency in rad/s.
    pub(super) fn rate_per_s(&self, omega_rad_s: f64) -> f64 {
        let square = omega_rad_s * omega_rad_s;
        let terms = self.squares.iter().zip(&self.differences).rev();
        terms.fold(0.0, |sum, (known, difference)| sum * (square - known) + difference)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_modes_give_the_law_of_rayleigh() {
        let series = CaugheySeries::through(&[12.0, 80.0], &[0.02, 0.05]);
        let beta = 2.0 * (0.05 * 80.0 - 0.02 * 12.0) / (80.0_f64.powi(2) - 12.0_f64.powi(2));
        let alpha = 2.0 * 0.02 * 12.0 - beta * 144.0;
        for omega in [1.0, 12.0, 30.0, 80.0, 500.0] {
            let expected = alpha + beta * omega * omega;
            assert!((series.rate_per_s(omega) / expected - 1.0).abs() < 1e-13, "{omega} rad/s");
        }
    }

    #[test]
    fn every_chosen_mode_gets_its_ratio() {
        let (frequencies, ratios) = ([11.9, 34.2, 83.8, 159.0], [0.01, 0.03, 0.02, 0.04]);
        let series = CaugheySeries::through(&frequencies, &ratios);
        for (omega, ratio) in frequencies.iter().zip(ratios) {
            assert!((series.rate_per_s(*omega) / (2.0 * omega) - ratio).abs() < 1e-15);
        }
        // Between them the cubic in ω² through the four points, here by Lagrange's formula.
        let omega: f64 = 50.0;
        let lagrange: f64 = (0..4)
            .map(|i| {
                let others = (0..4).filter(|j| *j != i).map(|j| {
                    let square = |k: usize| frequencies[k] * frequencies[k];
                    (omega * omega - square(j)) / (square(i) - square(j))
                });
                2.0 * ratios[i] * frequencies[i] * others.product::<f64>()
            })
            .sum();
        assert!((series.rate_per_s(omega) / lagrange - 1.0).abs() < 1e-13);
    }
}
