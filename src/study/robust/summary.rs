//! The numbers of a study, as they are printed, stored and shown.

use serde::{Deserialize, Serialize};

use super::command::{Command, Hold};
use super::key::Key;
use super::outcome::{KeyOutcome, OverLimit, PlantKind, Quantile, Quantiles, Robustness};
use super::plants::{Distribution, Sample};
use super::strays::{Measure, Strays, below};
use crate::compare::Table;
use crate::link::Link;
use crate::result::{Notice, Origin};
use crate::text::{counted, significant};

/// Share of a worst tip error above which the errors of the plays matter.
const MATTERS: f64 = 0.01;

/// Smallest error of the plays that matters, over the travel.
const COUNTS: f64 = 1e-5;

/// Largest tip error of a command that helps, over that of the study.
const HELPS: f64 = 0.95;

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

/// Errors of another command on the corners.
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
    /// Quantity that the drives hold.
    pub play: Hold,
    /// Name of the command.
    pub played: String,
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
    /// Errors of other commands.
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
            played: name.to_owned(),
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

    /// The keys by their share of the tip error, the largest first.
    pub fn by_share(&self) -> Vec<&KeyOutcome> {
        let mut keys: Vec<&KeyOutcome> = self.keys.iter().collect();
        keys.sort_by(|a, b| b.share.total_cmp(&a.share));
        keys
    }

    /// The other commands by their tip error, the smallest first, and the number of those that help.
    pub fn by_help(&self) -> (Vec<&Help>, usize) {
        let mut help: Vec<&Help> = self.help.iter().collect();
        help.sort_by(|a, b| a.tip_error_m.total_cmp(&b.tip_error_m));
        let helps = help.iter().filter(|own| own.tip_error_m < HELPS * self.worst_m()).count();
        (help, helps)
    }
}

/// Numbers as texts, in the words of a hub.
impl RobustSummary {
    /// A length as a share of the travel: `2.3 %`.
    pub fn percent(&self, m: f64) -> String {
        format!("{} %", significant(100.0 * m / self.travel_m, 3))
    }

    /// The same with the length: `2.3 % (0.0115 m)`.
    pub fn both(&self, m: f64) -> String {
        format!("{} ({} m)", self.percent(m), significant(m, 3))
    }

    /// A quantile as a share of the travel with its standard error: `2.47 ± 0.06 %`, or `?` where few plants lie beyond.
    pub fn quantile(&self, (at_m, error_m): Quantile) -> String {
        let percent = |m: f64, digits| significant(100.0 * m / self.travel_m, digits);
        let error = error_m.map_or("?".to_owned(), |error_m| percent(error_m, 1));
        format!("{} ± {error} %", percent(at_m, 3))
    }

    /// The played quantity: `torque of solve, without feedback`.
    pub fn played_words(&self, is_arm: bool) -> String {
        let of = match &*self.played {
            "inverse" => "of solve".to_owned(),
            "rigid" => "of rigid links".to_owned(),
            shaper => format!("of rigid links, shaped by {shaper}"),
        };
        match self.play {
            Hold::Position if is_arm => format!("angles of the joints {of}, held exactly"),
            Hold::Position => format!("hub angle {of}, held exactly"),
            Hold::Effort => format!("torque {of}, without feedback"),
            Hold::Feedback => {
                let gains = self.feedback.iter().map(|(kp, kd)| format!("{kp},{kd}"));
                format!("torque {of}, with feedback {}", gains.collect::<Vec<_>>().join(","))
            }
        }
    }

    /// The plants in parts, from the number of each kind.
    pub fn plants_words(&self, count: impl Fn(PlantKind) -> usize) -> Vec<String> {
        let drawn = match (&self.sample.fitted, self.sample.distribution) {
            (Some(_), _) => "from the fit",
            (None, Distribution::Uniform) => "uniform",
            (None, Distribution::Normal) => "normal",
        };
        let mut parts = vec![
            format!("{} in all", self.plants),
            format!("{} on {}", count(PlantKind::Key), counted(self.keys.len(), "key")),
        ];
        if self.keys.len() > 1 {
            parts.push(counted(count(PlantKind::Corner), "corner"));
        }
        if self.sample.runs > 0 {
            let seed = self.sample.seed;
            parts.push(format!("{} drawn ({drawn}, seed {seed})", self.sample.runs));
        }
        if self.drawn_again > 0 {
            parts.push(format!("{} drawn again", self.drawn_again));
        }
        parts
    }

    /// Values of the keys of a plant; empty for the link of the file.
    pub fn values_words(&self, values: &[Option<f64>]) -> Vec<String> {
        let pairs = self.keys().zip(values);
        let value = |(key, own): (&Key, &Option<f64>)| {
            Some(format!("{} = {}", key.name(), key.amount((*own)?)))
        };
        pairs.filter_map(value).collect()
    }

    /// How the sample settles, in two parts; `None` without a sample.
    pub fn settling_words(&self) -> Option<[String; 2]> {
        let band = self.both(self.band_m);
        let parts = match self.settling_p95_s {
            Some(after_s) => [
                format!("95 % of the drawn plants stay within {band}"),
                format!("from {} s after the motion on", significant(after_s, 3)),
            ],
            None => [
                format!("over 5 % of the drawn plants do not stay within {band}"),
                "in 10 periods after the motion".to_owned(),
            ],
        };
        (self.sample.runs > 0).then_some(parts)
    }

    /// Errors of the plays, in parts.
    pub fn errors_words(&self) -> Vec<String> {
        let share = |m: f64| format!("{:.1e}", m / self.travel_m);
        let PlayErrors { common_m, play_m } = self.errors;
        let play =
            format!("plays {} of the travel (nominal and worst plant, in full)", share(play_m));
        let common = (common_m > 0.0).then(|| {
            let common = share(common_m);
            format!("{common} taken off: the nominal link, as its damping differs in time")
        });
        std::iter::once(play).chain(common).collect()
    }
}

impl OverLimit {
    /// The share of the sample over the limit, as a sentence.
    pub fn words(&self) -> String {
        let joint = self.joint.map_or(String::new(), |joint| format!("joint {}: ", joint + 1));
        let [limit, largest] = [self.limit, self.largest].map(|number| significant(number, 4));
        let (share, key, unit) = (share_words(self.share), &self.key, &self.unit);
        format!(
            "{joint}{share} of the drawn plants exceed {key} = {limit} {unit} (up to {largest})"
        )
    }
}

/// A share of a whole: `68 %`.
pub fn share_words(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 2))
}

/// A study read back from its folder.
#[derive(Debug, Clone)]
pub struct StoredRobust {
    /// Name of its folder.
    pub name: String,
    /// Version, files and arguments of the study.
    pub origin: Origin,
    /// The link of the file, or the links of its arm.
    pub links: Vec<Link>,
    /// Its numbers.
    pub summary: RobustSummary,
    /// Its warnings.
    pub warnings: Vec<Notice>,
    /// A row for each plant: its kind, its values, tip error and rest vibration over the travel, drift in m, settling
    /// time in s.
    pub plants: Table,
    /// Times of the envelope in s.
    pub times_s: Vec<f64>,
    /// Lowest and highest error of the sample in m at these times; of an arm sizes.
    pub envelope_m: [Vec<f64>; 2],
}
