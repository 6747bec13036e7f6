//! The plants of a study: points on each key, corners, and a seeded sample.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::key::{Fitted, Key};
use crate::numeric::NORMAL_95;

/// Values of the keys of one plant, in their order; `None`: as in the file.
pub type Values = Vec<Option<f64>>;

/// Values of each key that is alone: its ends, its middle and four between.
pub(super) const POINTS: usize = 7;

/// Most keys with all their corners, and most corners.
const MOST_KEYS: usize = 8;
const MOST_CORNERS: usize = 1024;

/// Degrees of freedom from which Student's distribution counts as normal.
const MANY: usize = 200;

/// Distribution of a value in its interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Distribution {
    /// Every value is as likely.
    #[default]
    Uniform,
    /// Normal about the middle; the interval has 95 % of the values.
    Normal,
}

/// A seeded sample of plants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Number of plants.
    pub runs: usize,
    /// Seed.
    pub seed: u64,
    /// Distribution of the values that no fit found.
    pub distribution: Distribution,
    /// Keys that a fit found.
    pub fitted: Option<Fitted>,
}

/// Values of the corners: every combination of the candidates of each key. With many keys, for each measure the corner of
/// the worst candidates, the opposite one, and both with one key turned. `worst` has the number of the worst candidate
/// of each key, one list a measure. One key has no corners: it is alone at its candidates.
pub fn corners(candidates: &[Vec<f64>], worst: &[Vec<usize>]) -> Vec<Values> {
    if candidates.len() < 2 {
        return Vec::new();
    }
    let count: usize = candidates.iter().map(Vec::len).fold(1, usize::saturating_mul);
    if candidates.len() <= MOST_KEYS && count <= MOST_CORNERS {
        let corner = |mut number: usize| {
            let choose = |own: &Vec<f64>| {
                let chosen = own[number % own.len()];
                number /= own.len();
                Some(chosen)
            };
            candidates.iter().map(choose).collect()
        };
        return (0..count).map(corner).collect();
    }
    let mut all: Vec<Values> = Vec::new();
    for signs in worst {
        let other =
            |key: usize, number: usize| if number == 0 { candidates[key].len() - 1 } else { 0 };
        for is_opposite in [false, true] {
            for turned in std::iter::once(None).chain((0..candidates.len()).map(Some)) {
                let chosen = |(key, own): (usize, &usize)| {
                    let turns = is_opposite != (turned == Some(key));
                    Some(candidates[key][if turns { other(key, *own) } else { *own }])
                };
                let corner: Values = signs.iter().enumerate().map(chosen).collect();
                if !all.contains(&corner) {
                    all.push(corner);
                }
            }
        }
    }
    all
}

/// The generator `SplitMix64` (Steele, Lea, Flood, OOPSLA 2014).
pub(super) struct Random(u64);

/// The odd constant of its steps, the golden ratio times 2⁶⁴.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

impl Random {
    /// The stream of a plant: each plant has one of its own, so that no other changes it.
    pub(super) fn new(seed: u64, plant: usize) -> Self {
        let mut of_plant = Self(seed ^ (plant as u64).wrapping_mul(GOLDEN));
        Self(of_plant.next())
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GOLDEN);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Between 0 and 1, neither of them.
    fn share(&mut self) -> f64 {
        ((self.next() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    /// A normal deviate (Box and Muller).
    fn normal(&mut self) -> f64 {
        let (radius, angle) = (self.share(), self.share());
        (-2.0 * libm::log(radius)).sqrt() * libm::cos(TAU * angle)
    }
}

impl Sample {
    /// Values of a plant from its stream.
    pub(super) fn drawn(&self, keys: &[Key], random: &mut Random) -> Values {
        let of_fit = self.fitted.as_ref().map(|fitted| (fitted.first, fitted.factors(random)));
        let value = |(number, key): (usize, &Key)| {
            let own = of_fit
                .as_ref()
                .and_then(|(first, factors)| factors.get(number.checked_sub(*first)?).copied());
            Some(own.unwrap_or_else(|| match self.distribution {
                Distribution::Uniform => key.at(random.share()),
                Distribution::Normal => {
                    let [low, high] = key.ends;
                    0.5 * (low + high) + 0.5 * (high - low) / NORMAL_95 * random.normal()
                }
            }))
        };
        keys.iter().enumerate().map(value).collect()
    }
}

impl Fitted {
    /// Factors of a plant.
    fn factors(&self, random: &mut Random) -> Vec<f64> {
        let alone: Vec<f64> = self.standard_errors.iter().map(|_| random.normal()).collect();
        let few = self.degrees_of_freedom.filter(|own| *own < MANY);
        let wider = few.map_or(1.0, |degrees| {
            let square: f64 = (0..degrees).map(|_| random.normal().powi(2)).sum();
            (degrees as f64 / square).sqrt()
        });
        let pairs = self.lower.iter().zip(&self.standard_errors);
        let factor = |(row, error): (&Vec<f64>, &f64)| {
            let deviate: f64 = row.iter().zip(&alone).map(|(l, z)| l * z).sum();
            libm::exp(error * wider * deviate)
        };
        pairs.map(factor).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robust::How;

    fn key(ends: [f64; 2]) -> Key {
        Key { path: "payload.mass".into(), how: How::Value("g".into()), nominal: None, ends }
    }

    fn drawn(sample: &Sample, keys: &[Key]) -> Vec<Vec<f64>> {
        let one = |plant| sample.drawn(keys, &mut Random::new(sample.seed, plant));
        (0..sample.runs).map(|plant| one(plant).into_iter().flatten().collect()).collect()
    }

    /// Mean and standard deviation of each, within four standard errors.
    #[test]
    fn the_sample_has_the_moments_of_its_distribution() {
        let keys = [key([2.0, 6.0]), key([-1.0, 1.0])];
        for (distribution, deviation) in
            [(Distribution::Uniform, 2.0 / 3.0_f64.sqrt()), (Distribution::Normal, 2.0 / NORMAL_95)]
        {
            let sample = Sample { runs: 20_000, seed: 3, distribution, fitted: None };
            let values = drawn(&sample, &keys);
            for (axis, (mean, scale)) in [(4.0, 1.0), (0.0, 0.5)].into_iter().enumerate() {
                let n = values.len() as f64;
                let found = values.iter().map(|own| own[axis]).sum::<f64>() / n;
                let square = values.iter().map(|own| (own[axis] - found).powi(2)).sum::<f64>() / n;
                let error = scale * deviation / n.sqrt();
                assert!((found - mean).abs() < 4.0 * error, "{distribution:?}: {found}");
                assert!((square.sqrt() / (scale * deviation) - 1.0).abs() < 0.03, "{square}");
            }
            let product: f64 = values.iter().map(|own| (own[0] - 4.0) * own[1]).sum();
            assert!((product / values.len() as f64).abs() < 0.03, "{product}");
        }
    }

    #[test]
    fn fitted_factors_have_their_covariance_and_the_tails_of_student() {
        let correlation = vec![vec![1.0, 0.8], vec![0.8, 1.0]];
        let lower = Fitted::lower_of(&correlation).unwrap();
        assert!((lower[1][0] - 0.8).abs() < 1e-15 && (lower[1][1] - 0.6).abs() < 1e-15);
        assert_eq!(Fitted::lower_of(&[vec![1.0, 1.0], vec![1.0, 1.0]]), None);
        for (degrees, factor) in [(None, 1.0), (Some(5), 5.0 / 3.0)] {
            let fitted = Fitted {
                first: 0,
                standard_errors: vec![0.02, 0.05],
                lower: lower.clone(),
                degrees_of_freedom: degrees,
            };
            let keys = [key([0.9, 1.1]), key([0.9, 1.1])];
            let distribution = Distribution::Uniform;
            let sample = Sample { runs: 40_000, seed: 1, distribution, fitted: Some(fitted) };
            let logs = drawn(&sample, &keys).into_iter();
            let logs: Vec<Vec<f64>> =
                logs.map(|own| own.iter().map(|x| x.ln()).collect()).collect();
            let mean = |a: usize, b: usize| {
                logs.iter().map(|own| own[a] * own[b]).sum::<f64>() / logs.len() as f64
            };
            // Variance ν/(ν − 2) of Student's distribution.
            for (a, b, exact) in [(0, 0, 4e-4), (1, 1, 2.5e-3), (0, 1, 8e-4)] {
                assert!(
                    (mean(a, b) / (exact * factor) - 1.0).abs() < 0.06,
                    "{a}{b}: {}",
                    mean(a, b)
                );
            }
        }
    }

    #[test]
    fn corners_are_all_or_those_that_the_signs_suggest() {
        let two = corners(&[vec![1.0, 2.0], vec![5.0, 6.0]], &[]);
        assert_eq!(two.len(), 4);
        assert!(two.contains(&vec![Some(2.0), Some(5.0)]));
        assert!(corners(&[vec![1.0, 2.0]], &[vec![1]]).is_empty());
        let keys = vec![vec![0.0, 1.0]; 9];
        let many = corners(&keys, &[vec![1; 9]]);
        assert_eq!(many.len(), 2 * 9 + 2);
        assert!(many.contains(&vec![Some(1.0); 9]) && many.contains(&vec![Some(0.0); 9]));
    }
}
