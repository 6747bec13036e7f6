//! Links under gravity and at large angles.

pub(crate) mod laws;
mod prototype;
mod solved;
pub(crate) mod statics;

use std::sync::Arc;

use flexlink::elastica::{
    ArmPeriod, ElasticaError, ElasticaMotion, Kept, SecondOrder, follow_arm, returning,
};
use flexlink::link::{Damping, Hub, Link, LinkParts, Payload, Segment};
use flexlink::model::{KeptModes, Model, model_of};

use crate::common::mesh_of;

pub(crate) const STEP_S: f64 = 1.0 / 1024.0;

/// Rest before the time zero of a motion in s.
pub(crate) const BEFORE_S: f64 = 0.5;

/// A smooth turn of the chord: an error function of nine times the duration.
#[derive(Debug, Clone)]
pub(crate) struct Turn {
    pub(crate) from_rad: f64,
    pub(crate) by_rad: f64,
    pub(crate) duration_s: f64,
}

impl Turn {
    /// Angle, rate and acceleration.
    pub(crate) fn at(&self, time_s: f64) -> [f64; 3] {
        let scale = 9.0 / self.duration_s;
        let x = scale * (time_s - 0.5 * self.duration_s);
        let bell = (-x * x).exp() / std::f64::consts::PI.sqrt() * scale;
        let share = 0.5 * (1.0 + libm::erf(x));
        [
            self.from_rad + self.by_rad * share,
            self.by_rad * bell,
            -2.0 * self.by_rad * bell * x * scale,
        ]
    }

    /// Sample of a time.
    pub(crate) fn sample(time_s: f64) -> usize {
        (0..u16::MAX)
            .find(|k| f64::from(*k) * STEP_S >= time_s + BEFORE_S - 0.5 * STEP_S)
            .map_or(0, |k: u16| k.into())
    }
}

/// 1.1 m long, with 0.2 kg at its tip.
pub(crate) fn arm() -> LinkParts {
    LinkParts {
        segments: vec![Segment::uniform(1.1, 20.0, 0.5)],
        hub: Hub { inertia_kg_m2: 0.05, ..Hub::default() },
        payload: Payload { mass_kg: 0.2, inertia_kg_m2: 1e-4, offset_m: 0.0 },
        damping: Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 3e-4 },
        ..LinkParts::default()
    }
}

/// The link in so many elements.
pub(crate) fn model(parts: &LinkParts, elements: usize) -> Arc<dyn Model> {
    let link = Link::new(parts.clone()).expect("a valid link");
    model_of(&link, mesh_of(&link, elements), KeptModes::All).expect("a model")
}

/// The turn over a period: half a second of rest on either side, one second more after it, half a second in which
/// the chord returns, and one second before the next.
pub(crate) fn chord(turn: &Turn, gravity_m_s2: [f64; 2]) -> ArmPeriod {
    let last = Turn::sample(turn.duration_s + BEFORE_S + 1.0);
    let columns: Vec<[f64; 3]> =
        (0..=last).map(|k| turn.at(k as f64 * STEP_S - BEFORE_S)).collect();
    let [mut angle, mut rate, mut acceleration] =
        [0, 1, 2].map(|part| columns.iter().map(|at| at[part]).collect::<Vec<f64>>());
    let end_rad = turn.from_rad + turn.by_rad;
    angle.extend(returning(end_rad, turn.from_rad, 512));
    let len = (angle.len() + 1024).next_multiple_of(64);
    angle.resize(len, turn.from_rad);
    rate.resize(len, 0.0);
    acceleration.resize(len, 0.0);
    let chords = vec![[angle, rate, acceleration]];
    ArmPeriod::new(STEP_S, chords, Kept::Angles, gravity_m_s2).expect("a period")
}

/// The motion of one link.
pub(crate) fn follow(
    model: &Arc<dyn Model>,
    period: &ArmPeriod,
    second_order: SecondOrder,
    tolerance: f64,
) -> Result<ElasticaMotion, ElasticaError> {
    let found = follow_arm(std::slice::from_ref(model), period, second_order, tolerance)?;
    Ok(found.links.into_iter().next().expect("a link").bent)
}
