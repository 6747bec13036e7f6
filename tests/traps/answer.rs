//! The link's exact answer at one frequency, whatever its damping law.

use num_complex::Complex64;

use super::beam::{Beam, Frequency, Turned};
use super::link::{Damping, Link};
use super::modes::{Modes, natural_frequencies};

/// Modes that modal damping is given, and those of a series, whose ratios rise.
const MODES: usize = 30;
const MODES_OF_SERIES: usize = 45;

/// Transfers from the tip's acceleration.
#[derive(Debug, Clone)]
pub(crate) struct Transfers {
    /// T/a in kg m.
    pub(crate) torque: Complex64,
    /// `(θ − v_tip/L)/a` in rad s²/m, of a carriage `(u − v_tip)/a` in s²; the tip is the output.
    pub(crate) excess_angle: Complex64,
    /// `(v_x − x/L v_tip)/a` in s² at the stations, of a carriage `(v_x − v_tip)/a`.
    pub(crate) excess: Vec<Complex64>,
    /// `N_x/a` in kg m at the stations.
    pub(crate) moment: Vec<Complex64>,
}

/// The exact link.
pub(crate) struct Exact {
    /// The link in pieces with its damping; where it tapers, in twice as many pieces as well.
    beams: Vec<(Beam, Law)>,
    friction_n_m_s: f64,
}

enum Law {
    Hysteretic(f64),
    Rayleigh { alpha_per_s: f64, beta_s: f64 },
    Modal { modes: Modes, rates_per_s: Vec<f64> },
}

impl Exact {
    pub(crate) fn new(link: &Link, stations_m: &[f64]) -> Self {
        let finenesses: &[usize] = if link.is_tapered() { &[1, 2] } else { &[1] };
        let beams = finenesses.iter().map(|fineness| {
            let beam = Beam::new(link, *fineness, stations_m);
            let law = Law::of(&link.damping, &beam);
            (beam, law)
        });
        Self { beams: beams.collect(), friction_n_m_s: link.friction_n_m_s }
    }

    /// Transfers at ω > 0.
    pub(crate) fn at(&self, omega_rad_s: f64) -> Transfers {
        let all: Vec<Transfers> = self.beams.iter().map(|b| self.of(b, omega_rad_s)).collect();
        let [coarse, fine] = match &all[..] {
            [only] => return only.clone(),
            [coarse, fine] => [coarse, fine],
            _ => unreachable!("one beam or two"),
        };
        // Midpoint values are off by the square of the pieces' length.
        let limit = |c: &Complex64, f: &Complex64| f + (f - c) / 3.0;
        let rows = |c: &[Complex64], f: &[Complex64]| {
            c.iter().zip(f).map(|(c, f)| limit(c, f)).collect::<Vec<_>>()
        };
        Transfers {
            torque: limit(&coarse.torque, &fine.torque),
            excess_angle: limit(&coarse.excess_angle, &fine.excess_angle),
            excess: rows(&coarse.excess, &fine.excess),
            moment: rows(&coarse.moment, &fine.moment),
        }
    }

    fn of(&self, (beam, law): &(Beam, Law), omega: f64) -> Transfers {
        let (turned, hub_u) = law.turned(beam, omega);
        let Turned { tip_m, tip_u, inertia_kg_m2, u, moment } = turned;
        let length = beam.rigid_output();
        let theta = 1.0 + omega * omega * hub_u;
        let friction = Complex64::new(0.0, -self.friction_n_m_s / omega) * theta;
        let shapes = u.iter().zip(beam.rigid_stations());
        Transfers {
            torque: (inertia_kg_m2 + friction) / tip_m,
            excess_angle: (tip_u / length - hub_u) / tip_m,
            excess: shapes.map(|(u, x)| (tip_u * x / length - u) / tip_m).collect(),
            moment: moment.iter().map(|n| n / tip_m).collect(),
        }
    }
}

impl Law {
    fn of(damping: &Damping, beam: &Beam) -> Self {
        match damping {
            Damping::Hysteretic(ratio) => Self::Hysteretic(*ratio),
            Damping::Rayleigh { alpha_per_s, beta_s } => {
                Self::Rayleigh { alpha_per_s: *alpha_per_s, beta_s: *beta_s }
            }
            Damping::RayleighThrough { modes, ratios } => {
                let found = natural_frequencies(beam, modes[1]);
                let [a, b] = modes.map(|mode| found[mode - 1]);
                let [p, q] = [2.0 * ratios[0] * a, 2.0 * ratios[1] * b];
                let beta_s = (q - p) / (b * b - a * a);
                Self::Rayleigh { alpha_per_s: p - beta_s * a * a, beta_s }
            }
            Damping::Modal(ratios) => {
                let modes = Modes::new(beam, MODES);
                let ratio = |k: usize| ratios[k.min(ratios.len() - 1)];
                let omegas = modes.omegas_rad_s.iter().enumerate();
                let rates_per_s = omegas.map(|(k, omega)| 2.0 * ratio(k) * omega).collect();
                Self::Modal { modes, rates_per_s }
            }
            Damping::Caughey(ratios) => {
                let modes = Modes::new(beam, MODES_OF_SERIES);
                let through = &modes.omegas_rad_s[..ratios.len()];
                let rates_per_s = modes.omegas_rad_s.iter().map(|w| series(through, ratios, *w));
                Self::Modal { rates_per_s: rates_per_s.collect(), modes }
            }
        }
    }

    /// The link under a unit of its joint, and the joint's own u.
    fn turned(&self, beam: &Beam, omega: f64) -> (Turned, Complex64) {
        let square = Complex64::from(omega * omega);
        let local =
            |stiffness, mass| (beam.turned(Frequency { square, stiffness, mass }), Complex64::ZERO);
        match self {
            Self::Hysteretic(ratio) => local(Complex64::new(1.0, 2.0 * ratio), Complex64::ONE),
            Self::Rayleigh { alpha_per_s, beta_s } => local(
                Complex64::new(1.0, omega * beta_s),
                Complex64::new(1.0, -alpha_per_s / omega),
            ),
            Self::Modal { modes, rates_per_s } => {
                modes.damped(omega, beam.rigid_output(), rates_per_s)
            }
        }
    }
}

/// Caughey's series `2ζω = Σ a_b ω²ᵇ` through modes, by Lagrange's formula over ω².
fn series(through: &[f64], ratios: &[f64], omega: f64) -> f64 {
    let product = |i: usize| {
        let others = through.iter().enumerate().filter(move |(j, _)| *j != i);
        let own = through[i] * through[i];
        others.map(|(_, w)| (omega * omega - w * w) / (own - w * w)).product::<f64>()
    };
    (0..through.len()).map(|i| 2.0 * ratios[i] * through[i] * product(i)).sum()
}
