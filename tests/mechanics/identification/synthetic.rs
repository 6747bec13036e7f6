//! Uniform links whose true values are known, measured with noise. Their frequencies are roots of the closed
//! characteristic equations, not those of the program.

use std::f64::consts::{PI, TAU};

use super::fitted;
use crate::recordings::Random;
use flexlink::fit::{HubEnd, Measured, Measurements, Misfit, Observable};

/// A uniform link with a hub and a point payload.
#[derive(Debug, Clone, Copy)]
pub(super) struct Truth {
    pub(super) length: f64,
    pub(super) stiffness: f64,
    pub(super) mass_per_length: f64,
    pub(super) hub: f64,
    pub(super) payload: f64,
}

impl Truth {
    fn drawn(random: &mut Random) -> Self {
        let (length, mass_per_length) = (random.over(0.3, 2.0), random.over(0.05, 2.0));
        let beam = mass_per_length * length;
        Self {
            length,
            mass_per_length,
            stiffness: random.over(0.05, 50.0),
            hub: random.over(0.02, 0.3) * beam * length * length,
            payload: random.over(0.1, 1.0) * beam,
        }
    }

    /// Text of a link file.
    fn text(&self) -> String {
        let Self { length, stiffness, mass_per_length, hub, payload } = self;
        format!(
            "[[segments]]\nlength = {length}\nEI = {stiffness}\nmass_per_length = {mass_per_length}\n\
             [hub]\ninertia = {hub}\n[payload]\nmass = {payload}\n"
        )
    }

    /// The first natural frequencies in Hz: roots b of the characteristic equation, ω = b²√(EI/m̄L⁴).
    pub(super) fn frequencies(&self, hub: HubEnd, count: usize) -> Vec<f64> {
        let beam = self.mass_per_length * self.length;
        let (eta, mu) = (self.hub / (beam * self.length.powi(2)), self.payload / beam);
        let equation = |b: f64| {
            // Divided by cosh b, which has no root.
            let (sin, cos, tanh, sech) = (b.sin(), b.cos(), b.tanh(), 1.0 / b.cosh());
            let clamped = sech + cos + mu * b * (cos * tanh - sin);
            match hub {
                HubEnd::Held => clamped,
                HubEnd::Free => {
                    cos * tanh - sin - 2.0 * mu * b * sin * tanh - eta * b.powi(3) * clamped
                }
            }
        };
        let scale = (self.stiffness / (self.mass_per_length * self.length.powi(4))).sqrt() / TAU;
        let step = PI / 400.0;
        // The rigid rotation is a root of the free link at 0.
        let places = (1..).map(|k| 0.02 + step * f64::from(k));
        let changes = places.filter(|b| equation(*b) * equation(b + step) < 0.0);
        changes.take(count).map(|b| scale * bisected(&equation, b, b + step).powi(2)).collect()
    }
}

fn bisected(equation: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if equation(low) * equation(middle) <= 0.0 { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// Measured frequencies of a link, each with normal noise of this relative size.
fn measured(truth: &Truth, random: &mut Random, noise: f64) -> Measurements {
    let ends = [(HubEnd::Held, 3), (HubEnd::Free, 3)];
    let values = ends.into_iter().flat_map(|(hub, count)| {
        let frequencies = truth.frequencies(hub, count);
        (1..)
            .zip(frequencies)
            .map(move |(mode, hertz)| (Observable::Frequency { mode, hub }, hertz))
    });
    let values = values.map(|(observable, hertz)| {
        let value = hertz * (1.0 + noise * random.box_muller());
        Measured { observable, value, uncertainty: Some(noise * hertz) }
    });
    Measurements::new(values.collect(), vec![], vec![]).unwrap()
}

/// Sets of free values that frequencies determine.
const DETERMINED: [&[&str]; 4] = [
    &["segments.*.EI"],
    &["segments.*.EI", "payload.mass"],
    &["segments.*.EI", "hub.inertia"],
    &["segments.*.mass_per_length", "payload.mass"],
];

/// Values of which frequencies determine the ratios alone.
const UNDETERMINED: &[&str] =
    &["segments.*.EI", "segments.*.mass_per_length", "hub.inertia", "payload.mass"];

#[test]
fn the_true_values_lie_within_two_standard_errors_in_95_of_100_cases() {
    let mut random = Random(23);
    let (mut within, mut all) = (0, 0);
    for case in 0..200 {
        let truth = Truth::drawn(&mut random);
        let noise = random.over(1e-3, 1e-2);
        let measured = measured(&truth, &mut random, noise);
        let free = DETERMINED[case % DETERMINED.len()];
        // The file is wrong by up to a factor of two.
        let mut file = truth;
        let mut off = |value: &mut f64| {
            let factor = random.over(0.5, 2.0);
            *value *= factor;
            1.0 / factor
        };
        let true_factors: Vec<f64> = free
            .iter()
            .map(|path| match *path {
                "segments.*.EI" => off(&mut file.stiffness),
                "segments.*.mass_per_length" => off(&mut file.mass_per_length),
                "hub.inertia" => off(&mut file.hub),
                _ => off(&mut file.payload),
            })
            .collect();
        let found = fitted(&file.text(), &measured, free).unwrap();
        assert_eq!((&found.misfit, found.undetermined.len()), (&None, 0), "{truth:?} {found:?}");
        for (value, factor) in found.values.iter().zip(true_factors) {
            let away = (value.factor / factor).ln() / value.relative_standard_error.unwrap();
            all += 1;
            within += usize::from(away.abs() < 2.0);
        }
    }
    let share = within as f64 / f64::from(all);
    assert!((0.93..=0.97).contains(&share), "{within} of {all}");
}

#[test]
fn what_frequencies_do_not_determine_is_named() {
    let mut random = Random(24);
    let free = UNDETERMINED;
    for _ in 0..50 {
        let truth = Truth::drawn(&mut random);
        let measured = measured(&truth, &mut random, 3e-3);
        let found = fitted(&truth.text(), &measured, free).unwrap();
        assert_eq!(found.undetermined.len(), 1, "{truth:?}");
        let powers = &found.undetermined[0].powers;
        assert_eq!(powers.iter().map(|(path, _)| path.as_str()).collect::<Vec<_>>(), free);
        assert!(powers.iter().all(|(_, power)| (power - 1.0).abs() < 1e-4), "{powers:?}");
    }
}

#[test]
fn measurements_that_contradict_each_other_are_no_fit() {
    let truth = Truth::drawn(&mut Random(25));
    let [first, second] = truth.frequencies(HubEnd::Held, 2)[..] else { panic!() };
    let frequency = |mode, value| Measured {
        observable: Observable::Frequency { mode, hub: HubEnd::Held },
        value,
        uncertainty: Some(0.01 * value),
    };
    let crossed = vec![frequency(1, first), frequency(2, 0.7 * second)];
    let crossed = Measurements::new(crossed, vec![], vec![]).unwrap();
    let found = fitted(&truth.text(), &crossed, &["segments.*.EI"]).unwrap();
    assert!(found.misfit.is_some(), "{found:?}");
}

#[test]
fn a_frequency_that_the_bounds_do_not_allow_is_no_fit() {
    let truth = Truth::drawn(&mut Random(26));
    let low = Measured {
        observable: Observable::Frequency { mode: 1, hub: HubEnd::Held },
        value: 0.62 * truth.frequencies(HubEnd::Held, 1)[0],
        uncertainty: None,
    };
    let low = Measurements::new(vec![low], vec![], vec![]).unwrap();
    let found = fitted(&truth.text(), &low, &["segments.*.EI=0.5:2"]).unwrap();
    assert!(matches!(found.misfit, Some(Misfit::Bound { .. })), "{found:?}");
}

/// Ratios of single modes belong to the modes of their numbers.
#[test]
fn damping_ratios_are_fitted_mode_by_mode() {
    let truth = Truth::drawn(&mut Random(28));
    let text = truth.text() + "[damping]\nmodel = 'modal'\nratios = [0.02, 0.02, 0.02]\n";
    let ratios = [0.01, 0.04, 0.09];
    let measured = (1..).zip(ratios).map(|(mode, value)| Measured {
        observable: Observable::Damping { mode, hub: HubEnd::Free },
        value,
        uncertainty: Some(0.1 * value),
    });
    let measured = Measurements::new(measured.collect(), vec![], vec![]).unwrap();
    let free = ["damping.ratios.0", "damping.ratios.1", "damping.ratios.2"];
    let found = fitted(&text, &measured, &free).unwrap();
    for (value, ratio) in found.values.iter().zip(ratios) {
        assert!((0.02 * value.factor / ratio - 1.0).abs() < 1e-6, "{found:?}");
    }
    assert_eq!(found.degrees_of_freedom, 0);
}

#[test]
fn one_measurement_for_three_values_leaves_two_combinations_open() {
    let truth = Truth::drawn(&mut Random(27));
    let one = Measured {
        observable: Observable::Frequency { mode: 1, hub: HubEnd::Free },
        value: 1.1 * truth.frequencies(HubEnd::Free, 1)[0],
        uncertainty: None,
    };
    let one = Measurements::new(vec![one], vec![], vec![]).unwrap();
    let found =
        fitted(&truth.text(), &one, &["segments.*.EI", "hub.inertia", "payload.mass"]).unwrap();
    assert_eq!(found.undetermined.len(), 2, "{found:?}");
    assert!(found.misfit.is_some());
}
