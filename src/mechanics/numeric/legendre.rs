//! Legendre polynomials and Gauss-Legendre points.

/// Shapes up to `order` at t in (−1, 1), and their derivatives: one that is 1 at the inner end, those that vanish at
/// both ends, one that is 1 at the outer end.
pub(crate) fn piece_shapes(order: usize, t: f64) -> (Vec<f64>, Vec<f64>) {
    let p = legendre(order, t);
    let inside = (2..=order).map(|j| {
        let twice = (2 * j - 1) as f64;
        ((p[j] - p[j - 2]) / (2.0 * twice).sqrt(), (0.5 * twice).sqrt() * p[j - 1])
    });
    let ends = [(0.5 * (1.0 - t), -0.5), (0.5 * (1.0 + t), 0.5)];
    [ends[0]].into_iter().chain(inside).chain([ends[1]]).unzip()
}

/// Legendre polynomials `P₀` … `P_order` at t.
fn legendre(order: usize, t: f64) -> Vec<f64> {
    let mut p = vec![1.0, t];
    for k in 1..order {
        let (k, [before, last]) = (k as f64, [p[k - 1], p[k]]);
        p.push(((2.0 * k + 1.0) * t * last - k * before) / (k + 1.0));
    }
    p
}

/// Gauss-Legendre points in (−1, 1), with weights whose sum is 1.
#[derive(Debug, Clone)]
pub(crate) struct GaussRule {
    pub(crate) places: Vec<f64>,
    pub(crate) weights: Vec<f64>,
}

impl GaussRule {
    pub(crate) fn new(points: usize) -> Self {
        let n = points as f64;
        let (places, weights) = (0..points)
            .map(|k| {
                let guess = -libm::cos(std::f64::consts::PI * (k as f64 + 0.75) / (n + 0.5));
                let slope = |t: f64, p: &[f64]| n * (p[points - 1] - t * p[points]) / (1.0 - t * t);
                // Newton's steps double the digits: the sixth changes nothing.
                let t = (0..6).fold(guess, |t, _| {
                    let p = legendre(points, t);
                    t - p[points] / slope(t, &p)
                });
                let slope = slope(t, &legendre(points, t));
                (t, ((1.0 - t * t) * slope * slope).recip())
            })
            .unzip();
        Self { places, weights }
    }

    /// Weights of the values at the points in the integral from the inner end to t, relative to the length. The
    /// integrand is the polynomial through all values, a sum of Legendre polynomials.
    pub(crate) fn up_to(&self, t: f64) -> Vec<f64> {
        let points = self.places.len();
        let ends = legendre(points, t);
        let share = |(place, weight): (&f64, &f64)| {
            let own = legendre(points, *place);
            let higher = (1..points).map(|m| own[m] * (ends[m + 1] - ends[m - 1]) * 0.5);
            weight * (0.5 * (1.0 + t) + higher.sum::<f64>())
        };
        self.places.iter().zip(&self.weights).map(share).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_of_powers_are_exact_up_to_every_place() {
        for points in 1..=24 {
            let rule = GaussRule::new(points);
            let sum: f64 = rule.weights.iter().sum();
            assert!((sum - 1.0).abs() < 1e-14, "{points} points: {sum}");
            for end in [-1.0, -0.4, 0.3, 1.0] {
                for power in 0..points {
                    let exponent = i32::try_from(power).unwrap() + 1;
                    let exact = (f64::powi(end, exponent) - f64::powi(-1.0, exponent))
                        / (2.0 * f64::from(exponent));
                    let found: f64 = rule
                        .up_to(end)
                        .iter()
                        .zip(&rule.places)
                        .map(|(share, t)| share * t.powi(exponent - 1))
                        .sum();
                    assert!((found - exact).abs() < 1e-13, "{points} points, t^{power} to {end}");
                }
            }
        }
    }

    #[test]
    fn shapes_are_independent_and_take_any_polynomial_between_two_ends() {
        let (ends, _) = piece_shapes(5, 1.0);
        assert_eq!(ends, [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let (_, slopes) = piece_shapes(4, 0.3);
        let [after, before] = [0.3 + 1e-6, 0.3 - 1e-6].map(|t| piece_shapes(4, t).0);
        for (k, slope) in slopes.iter().enumerate() {
            assert!(((after[k] - before[k]) / 2e-6 - slope).abs() < 1e-8, "shape {k}");
        }
    }
}
