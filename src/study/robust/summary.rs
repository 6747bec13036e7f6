//! The numbers of a study, as they are printed, stored and shown.

use serde::{Deserialize, Serialize};

use super::command::{Command, Hold};
use super::key::Key;
use super::outcome::{KeyOutcome, OverLimit, PlantKind, Quantiles, Robustness};
use super::plants::Sample;
use super::strays::{Measure, Strays, below};

/// Share of a worst tip error above which the errors of the plays matter.
const MATTERS: f64 = 0.01;

/// Smallest error of the plays that matters, over the travel.
const COUNTS: f64 = 1e-5;

/// A plant with the largest of a measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorstPlant {
    /// The measure.
    pub measure: Measure,
    /// Its size in m.
    pub size_m: f64,
    /// Reason for the plant.
    pub kind: PlantKind,
    /// Values of the keys; null: as in the file.
    pub values: Vec<Option<f64>>,
}

/// Errors of the plays.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PlayErrors {
    /// Largest error in m of the nominal plant under the exact inverse, taken off from every play; 0 for other commands.
    pub common_m: f64,
    /// Largest change of a tip error in m when the nominal and the worst plant play with all samples, modes and
    /// refinements.
    pub play_m: f64,
}

/// What another command would leave on the corners.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Help {
    /// The command in words.
    pub what: String,
    /// Its worst tip error in m at the corners.
    pub tip_error_m: f64,
    /// Its worst rest vibration in m there.
    pub rest_vibration_m: f64,
    /// Its worst drift in m there.
    pub drift_m: f64,
}

/// Numbers of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RobustSummary {
    /// What the drives hold.
    pub play: Hold,
    /// What they play.
    pub command: String,
    /// Gains of each joint's feedback.
    pub feedback: Vec<(f64, f64)>,
    /// Largest travel of the wanted tip in m.
    pub travel_m: f64,
    /// End of the wanted motion in s.
    pub end_s: f64,
    /// Duration of the command in s, at 2 % of its range.
    pub duration_s: f64,
    /// The band of the settling time in m.
    pub band_m: f64,
    /// The sample.
    pub sample: Sample,
    /// Number of all plants.
    pub plants: usize,
    /// The plant of the file.
    pub nominal: Strays,
    /// Each key alone.
    pub keys: Vec<KeyOutcome>,
    /// The worst plants by tip error, rest vibration and drift.
    pub worst: Vec<WorstPlant>,
    /// Quantiles of the three over the sample.
    pub quantiles: Option<[Quantiles; 3]>,
    /// Time in s after the motion in which 95 % of the sample settle; null where more than 5 % do not.
    pub settling_p95_s: Option<f64>,
    /// The limits, with the share of the sample over each.
    pub over_limits: Vec<OverLimit>,
    /// Draws that the file refused.
    pub drawn_again: usize,
    /// Errors of the plays.
    pub errors: PlayErrors,
    /// What other commands would leave.
    pub help: Vec<Help>,
}

impl RobustSummary {
    /// The numbers of an outcome.
    pub fn of(
        outcome: &Robustness,
        command: &Command,
        (name, feedback): (&str, Vec<(f64, f64)>),
        (sample, band_m): (Sample, f64),
        (errors, help): (PlayErrors, Vec<Help>),
    ) -> Self {
        let worst = |(measure, at): (Measure, usize)| {
            let plant = &outcome.plants[at];
            let (kind, values) = (plant.kind, plant.values.clone());
            WorstPlant { measure, size_m: plant.strays.size_m(measure), kind, values }
        };
        let drawn = outcome.plants.iter().filter(|plant| plant.kind == PlantKind::Sample);
        let unsettled = |own: Option<f64>| own.unwrap_or(f64::INFINITY);
        let mut settling: Vec<f64> =
            drawn.map(|plant| unsettled(plant.strays.settling_s)).collect();
        settling.sort_by(f64::total_cmp);
        let place = below(0.95 * settling.len().saturating_sub(1) as f64 + 0.5);
        let settling_p95_s = settling.get(place).copied();
        Self {
            play: command.hold(),
            command: name.to_owned(),
            feedback,
            travel_m: command.travel_m,
            end_s: command.end_s,
            duration_s: command.duration_s(),
            band_m,
            sample,
            plants: outcome.plants.len(),
            nominal: outcome.plants[0].strays,
            keys: outcome.keys.clone(),
            worst: Measure::ALL.into_iter().zip(outcome.worst).map(worst).collect(),
            quantiles: outcome.quantiles,
            settling_p95_s: settling_p95_s.filter(|own| own.is_finite()),
            over_limits: outcome.over_limits.clone(),
            drawn_again: outcome.drawn_again,
            errors,
            help,
        }
    }

    /// The keys.
    pub fn keys(&self) -> impl Iterator<Item = &Key> {
        self.keys.iter().map(|own| &own.key)
    }

    /// The worst tip error in m.
    pub fn worst_m(&self) -> f64 {
        self.worst.first().map_or(0.0, |own| own.size_m)
    }

    /// True where the errors of the plays are more than 1 % of the worst tip error.
    pub fn is_coarse(&self) -> bool {
        self.errors.play_m > (MATTERS * self.worst_m()).max(COUNTS * self.travel_m)
    }
}
