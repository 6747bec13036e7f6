//! Arms of several links.

mod carriage;
mod curves;
mod cycles;
mod digits;
mod fallback;
mod inversion;
mod laws;
mod newton_euler;
mod noise;
mod pose;
mod prototype;
mod random;
mod simulation;
mod swing;

use std::sync::Arc;

use flexlink::elastica::{AngleHistories, ArmPeriod, Kept, reaching, returning};
use flexlink::link::{Damping, Hub, LinkParts, Payload, Segment};
use flexlink::model::Model;

use crate::elastica::{BEFORE_S, STEP_S, Turn, arm, model};

/// 0.7 m with 0.6 kg at its tip, which turns 0.6 m with 0.3 kg.
fn two_links() -> [LinkParts; 2] {
    let link = |[length_m, stiffness, mass]: [f64; 3], inertia_kg_m2, mass_kg| LinkParts {
        segments: vec![Segment::uniform(length_m, stiffness, mass)],
        hub: Hub { inertia_kg_m2, ..Hub::default() },
        payload: Payload { mass_kg, inertia_kg_m2: 0.0, offset_m: 0.0 },
        damping: Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 2e-4 },
        ..arm()
    };
    [link([0.7, 60.0, 0.8], 0.02, 0.6), link([0.6, 15.0, 0.4], 0.005, 0.3)]
}

/// The links in so many elements each.
fn models(parts: &[LinkParts], elements: usize) -> Vec<Arc<dyn Model>> {
    parts.iter().map(|parts| model(parts, elements)).collect()
}

/// The tip on a line in 1.5 s, over a period: half a second of rest on either side, one second more after it, half a
/// second in which the chords return, and one second before the next.
fn line(gravity_m_s2: [f64; 2]) -> ArmPeriod {
    let share = Turn { from_rad: 0.0, by_rad: 1.0, duration_s: 1.5 };
    let last = Turn::sample(1.5 + BEFORE_S + 1.0);
    let tip: Vec<[[f64; 2]; 3]> = (0..=last)
        .map(|k| {
            let [s, rate, acceleration] = share.at(k as f64 * STEP_S - BEFORE_S);
            let by = |share: f64| [-0.4 * share, 1.3 * share];
            [[0.9 + by(s)[0], -0.5 + by(s)[1]], by(rate), by(acceleration)]
        })
        .collect();
    let chords = reaching(&tip, &[0.7, 0.6], &[], true).expect("a reachable line");
    period(chords, Kept::Tip, gravity_m_s2, STEP_S)
}

/// Chords that turn, over such a period.
fn turning(turns: &[Turn], kept: Kept, gravity_m_s2: [f64; 2]) -> ArmPeriod {
    let last = Turn::sample(turns[0].duration_s + BEFORE_S + 1.0);
    let chord = |turn: &Turn| {
        let at = |k: usize| turn.at(k as f64 * STEP_S - BEFORE_S);
        [0, 1, 2].map(|part| (0..=last).map(|k| at(k)[part]).collect())
    };
    period(turns.iter().map(chord).collect(), kept, gravity_m_s2, STEP_S)
}

fn period(
    mut chords: Vec<AngleHistories>,
    kept: Kept,
    gravity_m_s2: [f64; 2],
    step_s: f64,
) -> ArmPeriod {
    for [angle, rate, acceleration] in &mut chords {
        let (start_rad, end_rad) = (angle[0], angle[angle.len() - 1]);
        angle.extend(returning(end_rad, start_rad, 512));
        let len = (angle.len() + 1024).next_multiple_of(64);
        angle.resize(len, start_rad);
        rate.resize(len, 0.0);
        acceleration.resize(len, 0.0);
    }
    ArmPeriod::new(step_s, chords, kept, gravity_m_s2).expect("a period")
}
