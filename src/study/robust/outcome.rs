//! A study of plants: each key alone, corners, a sample; the worst of all, quantiles, and the keys that matter.

use std::borrow::Cow;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::command::PlantTip;
use super::key::Key;
use super::plants::{POINTS, Random, Sample, Values, corners};
use super::strays::{Measure, Strays, below};
use crate::numeric::extremes;
use crate::result::LimitedValue;
use crate::system::end_if_stopped;

/// Plants that are played before their histories are merged.
const TOGETHER: usize = 256;

/// Draws of one plant that the file may refuse.
const DRAWS: usize = 100;

/// By how much a value inside an interval must exceed both ends, over the larger, to make a key not monotone.
const BEYOND: f64 = 0.01;

/// Smallest measure, over the travel, whose place in an interval counts.
const COUNTS: f64 = 1e-5;

/// Fewest drawn plants beyond a quantile that has a standard error.
const FEW: f64 = 5.0;

/// Range of a key's measures, over the travel, up to which it changes nothing.
const IDLE: f64 = 1e-8;

/// Plays of a search for the worst value between two others, and golden section.
const SECTIONS: usize = 12;
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Reason for a plant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlantKind {
    /// The link of the file.
    Nominal,
    /// One key at a point, the others as in the file.
    Key,
    /// All keys at an end, or at a worst value inside.
    Corner,
    /// Drawn.
    Sample,
    /// A step of the search for the worst from the worst drawn plant.
    Search,
}

impl PlantKind {
    /// All kinds, in the order of robust.csv.
    pub const ALL: [Self; 5] = [Self::Nominal, Self::Key, Self::Corner, Self::Sample, Self::Search];

    /// Its word in robust.csv.
    pub fn word(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Key => "key",
            Self::Corner => "corner",
            Self::Sample => "sample",
            Self::Search => "search",
        }
    }
}

/// A plant with its measures.
#[derive(Debug, Clone, PartialEq)]
pub struct Plant {
    /// Reason for it.
    pub kind: PlantKind,
    /// Value of each key; `None`: as in the file.
    pub values: Vec<Option<f64>>,
    /// Its measures.
    pub strays: Strays,
}

/// A worst value inside an interval: the key is not monotone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Inside {
    /// The measure.
    pub measure: Measure,
    /// The value.
    pub value: f64,
    /// The measure there in m.
    pub size_m: f64,
}

/// Errors that one key makes alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KeyOutcome {
    /// The key.
    pub key: Key,
    /// Its largest tip error, rest vibration and drift in m, and their values.
    pub worst: [Worst; 3],
    /// Its tip error over the sum of those of all keys.
    pub share: f64,
    /// Worst values inside the interval.
    pub inside: Vec<Inside>,
}

/// A largest measure and its place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Worst {
    /// The measure in m.
    pub size_m: f64,
    /// The value of the key.
    pub value: f64,
}

/// Quantiles of a measure over the sample in m, each with its standard error by the number of plants.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quantiles {
    /// 50 % and its standard error, `None` if few plants lie beyond the quantile.
    pub median_m: Quantile,
    /// 95 %.
    pub p95_m: Quantile,
    /// 99 %.
    pub p99_m: Quantile,
}

/// A quantile and its standard error.
pub type Quantile = (f64, Option<f64>);

/// The outcome of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Robustness {
    /// All plants: the nominal one, those of each key, corners, the sample, the search.
    pub plants: Vec<Plant>,
    /// Errors that each key makes alone.
    pub keys: Vec<KeyOutcome>,
    /// Numbers of the plants with the largest tip error, rest vibration and drift.
    pub worst: [usize; 3],
    /// Quantiles of the three over the sample; `None` without one.
    pub quantiles: Option<[Quantiles; 3]>,
    /// Smallest and largest error of the sample in m at each time of the nominal plant's play.
    pub envelope_m: [Vec<f64>; 2],
    /// The limits, with the share of the sample that exceeds each.
    pub over_limits: Vec<OverLimit>,
    /// Draws that the file refused.
    pub drawn_again: usize,
    /// Travel of the tip in m.
    pub travel_m: f64,
}

/// A limit, and the plants of a sample over it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OverLimit {
    /// Number of the joint of an arm, from 0.
    pub joint: Option<usize>,
    /// Key of the limit.
    pub key: String,
    /// The limit.
    pub limit: f64,
    /// The largest value of the sample.
    pub largest: f64,
    /// Unit of both.
    pub unit: String,
    /// Share of the sample over the limit.
    pub share: f64,
}

/// Why a plant has no measures: the file refuses its values, or another failure.
#[derive(Debug)]
pub enum PlantError<E> {
    /// The file refuses the values.
    Refused(E),
    /// Any other failure.
    Failed(E),
}

impl OverLimit {
    fn none(own: &LimitedValue) -> Self {
        let LimitedValue { joint, key, limit, unit, .. } = *own;
        let (key, unit) = (key.to_owned(), unit.to_owned());
        Self { joint, key, limit, largest: 0.0, unit, share: 0.0 }
    }

    /// Counts the value of one of `plants` plants.
    fn count(&mut self, own: &LimitedValue, plants: usize) {
        self.largest = self.largest.max(own.found);
        if own.found > own.limit {
            self.share += 1.0 / plants as f64;
        }
    }
}

impl<E> PlantError<E> {
    fn cause(self) -> E {
        match self {
            Self::Refused(cause) | Self::Failed(cause) => cause,
        }
    }
}

/// The keys of a study, its sample, and the play of one plant with these values of the keys.
pub struct Study<'a, P> {
    /// Keys.
    pub keys: &'a [Key],
    /// Sample.
    pub sample: &'a Sample,
    /// Largest travel of the wanted motion in m.
    pub travel_m: f64,
    /// Play.
    pub play: P,
}

impl<P> Study<'_, P> {
    /// Plays all plants, in parallel where one does not need the other; equal on any number of threads.
    ///
    /// # Errors
    /// The first failure of a play, and values on a key or a corner that the file refuses.
    pub fn run<E: Send>(&self) -> Result<Robustness, E>
    where
        P: Fn(&[Option<f64>]) -> Result<PlantTip, PlantError<E>> + Sync,
    {
        let count = self.keys.len();
        let nominal = self.played(&vec![None; count]).map_err(PlantError::cause)?;
        let own_m = sizes(&nominal.error_m).into_owned();
        let mut envelope_m = [own_m.clone(), own_m];
        let mut plants = vec![Plant {
            kind: PlantKind::Nominal,
            values: vec![None; count],
            strays: nominal.strays,
        }];
        let points: Vec<Values> =
            (0..count * POINTS).map(|at| self.alone(at / POINTS, self.point(at))).collect();
        plants.extend(self.all(PlantKind::Key, &points)?);
        let mut keys = Vec::new();
        for number in 0..count {
            let own = plants[1 + number * POINTS..][..POINTS].to_vec();
            keys.push(self.of_key(number, &own, &mut plants)?);
        }
        let sum: f64 = keys.iter().map(|own| own.worst[0].size_m).sum();
        for own in &mut keys {
            own.share = own.worst[0].size_m / sum.max(f64::MIN_POSITIVE);
        }
        plants.extend(self.all(PlantKind::Corner, &corners_of(&keys))?);
        let first = plants.len();
        let mut over_limits: Vec<OverLimit> = Vec::new();
        let mut drawn_again = 0;
        for begin in (0..self.sample.runs).step_by(TOGETHER) {
            let until = (begin + TOGETHER).min(self.sample.runs);
            let drawn: Vec<_> = (begin..until)
                .into_par_iter()
                .map(|plant| self.drawn(plant))
                .collect::<Result<_, _>>()?;
            for (values, PlantTip { strays, error_m, limited, .. }, again) in drawn {
                let [low, high] = &mut envelope_m;
                for (k, e) in sizes(&error_m).iter().enumerate().take(low.len()) {
                    (low[k], high[k]) = if plants.len() == first {
                        (*e, *e)
                    } else {
                        (low[k].min(*e), high[k].max(*e))
                    };
                }
                for (number, own) in limited.into_iter().enumerate() {
                    if number == over_limits.len() {
                        over_limits.push(OverLimit::none(&own));
                    }
                    over_limits[number].count(&own, self.sample.runs);
                }
                drawn_again += again;
                plants.push(Plant { kind: PlantKind::Sample, values, strays });
            }
        }
        let sample: Vec<Strays> = plants[first..].iter().map(|plant| plant.strays).collect();
        let quantiles =
            (!sample.is_empty()).then(|| Measure::ALL.map(|own| quantiles(&sample, own)));
        for measure in Measure::ALL {
            let worst = worst_of(&plants, measure);
            if plants[worst].kind == PlantKind::Sample {
                self.search(measure, plants[worst].clone(), &mut plants)?;
            }
        }
        let worst = Measure::ALL.map(|measure| worst_of(&plants, measure));
        let travel_m = self.travel_m;
        Ok(Robustness {
            plants,
            keys,
            worst,
            quantiles,
            envelope_m,
            over_limits,
            drawn_again,
            travel_m,
        })
    }

    fn played<E>(&self, values: &[Option<f64>]) -> Result<PlantTip, PlantError<E>>
    where
        P: Fn(&[Option<f64>]) -> Result<PlantTip, PlantError<E>>,
    {
        end_if_stopped();
        (self.play)(values)
    }

    /// Plants with these values.
    fn all<E: Send>(&self, kind: PlantKind, values: &[Values]) -> Result<Vec<Plant>, E>
    where
        P: Fn(&[Option<f64>]) -> Result<PlantTip, PlantError<E>> + Sync,
    {
        let one = |values: &Values| {
            let PlantTip { strays, .. } = self.played(values).map_err(PlantError::cause)?;
            Ok(Plant { kind, values: values.clone(), strays })
        };
        values.par_iter().map(one).collect()
    }

    /// Value of a numbered point.
    fn point(&self, at: usize) -> f64 {
        self.keys[at / POINTS].at((at % POINTS) as f64 / (POINTS - 1) as f64)
    }

    /// One key at a value, the others as in the file.
    fn alone(&self, key: usize, value: f64) -> Values {
        (0..self.keys.len()).map(|own| (own == key).then_some(value)).collect()
    }

    /// A drawn plant, and the draws that the file refused before it.
    fn drawn<E>(&self, plant: usize) -> Result<(Values, PlantTip, usize), E>
    where
        P: Fn(&[Option<f64>]) -> Result<PlantTip, PlantError<E>>,
    {
        let mut random = Random::new(self.sample.seed, plant);
        let mut again = 0;
        loop {
            let values = self.sample.drawn(self.keys, &mut random);
            match self.played(&values) {
                Ok(found) => return Ok((values, found, again)),
                Err(PlantError::Refused(_)) if again < DRAWS => again += 1,
                Err(error) => return Err(error.cause()),
            }
        }
    }

    /// Finds the errors that a key makes alone from its points, and searches for a worst value inside its interval.
    fn of_key<E>(
        &self,
        number: usize,
        points: &[Plant],
        plants: &mut Vec<Plant>,
    ) -> Result<KeyOutcome, E>
    where
        P: Fn(&[Option<f64>]) -> Result<PlantTip, PlantError<E>>,
    {
        let mut inside = Vec::new();
        let mut worst = Vec::new();
        for measure in Measure::ALL {
            let sizes: Vec<f64> = points.iter().map(|own| own.strays.size_m(measure)).collect();
            let at = |k: usize| self.point(number * POINTS + k);
            let top = (0..POINTS).max_by(|a, b| sizes[*a].total_cmp(&sizes[*b])).unwrap_or(0);
            let mut found = Worst { size_m: sizes[top], value: at(top) };
            let end_m = sizes[0].max(sizes[POINTS - 1]);
            if found.size_m > (1.0 + BEYOND) * end_m && found.size_m > COUNTS * self.travel_m {
                let between = [at(top - 1), at(top + 1)];
                let along = |value| self.alone(number, value);
                for plant in self.sections(PlantKind::Key, between, along, measure)? {
                    let size_m = plant.strays.size_m(measure);
                    if size_m > found.size_m {
                        let value = plant.values[number].unwrap_or(found.value);
                        found = Worst { size_m, value };
                    }
                    plants.push(plant);
                }
                inside.push(Inside { measure, value: found.value, size_m: found.size_m });
            }
            worst.push(found);
        }
        let worst = [worst[0], worst[1], worst[2]];
        Ok(KeyOutcome { key: self.keys[number].clone(), worst, share: 0.0, inside })
    }

    /// Plants of a golden section towards the largest measure between two values.
    fn sections<E>(
        &self,
        kind: PlantKind,
        [mut low, mut high]: [f64; 2],
        with: impl Fn(f64) -> Values,
        measure: Measure,
    ) -> Result<Vec<Plant>, E>
    where
        P: Fn(&[Option<f64>]) -> Result<PlantTip, PlantError<E>>,
    {
        let mut plants = Vec::new();
        let mut size = |value: f64| {
            let values = with(value);
            let PlantTip { strays, .. } = self.played(&values).map_err(PlantError::cause)?;
            plants.push(Plant { kind, values, strays });
            Ok::<f64, E>(strays.size_m(measure))
        };
        let inner =
            |low: f64, high: f64| [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
        let [mut a, mut b] = inner(low, high);
        let [mut of_a, mut of_b] = [size(a)?, size(b)?];
        for _ in 2..SECTIONS {
            if of_a < of_b {
                (low, a, of_a) = (a, b, of_b);
                [_, b] = inner(low, high);
                of_b = size(b)?;
            } else {
                (high, b, of_b) = (b, a, of_a);
                [a, _] = inner(low, high);
                of_a = size(a)?;
            }
        }
        Ok(plants)
    }

    /// Searches on from the worst drawn plant, key by key, within a sixth of each interval.
    fn search<E>(&self, measure: Measure, mut best: Plant, plants: &mut Vec<Plant>) -> Result<(), E>
    where
        P: Fn(&[Option<f64>]) -> Result<PlantTip, PlantError<E>>,
    {
        for (number, key) in self.keys.iter().enumerate() {
            let Some(value) = best.values[number] else { continue };
            let [low, high] = key.ends;
            let reach = (high - low) / (POINTS - 1) as f64;
            let ends = [(value - reach).max(low.min(value)), (value + reach).min(high.max(value))];
            let from = best.values.clone();
            let with = |value| {
                let mut values = from.clone();
                values[number] = Some(value);
                values
            };
            for plant in self.sections(PlantKind::Search, ends, with, measure)? {
                if plant.strays.size_m(measure) > best.strays.size_m(measure) {
                    best = plant.clone();
                }
                plants.push(plant);
            }
        }
        Ok(())
    }
}

/// The error along one axis with its sign, or the size of that along two.
fn sizes(error_m: &[Vec<f64>]) -> Cow<'_, [f64]> {
    match error_m {
        [along] => along.into(),
        [x, y] => x.iter().zip(y).map(|(x, y)| (x * x + y * y).sqrt()).collect::<Vec<_>>().into(),
        _ => Cow::default(),
    }
}

impl Robustness {
    /// The keys that change no measure.
    pub fn idle_keys(&self) -> Vec<&Key> {
        let is_idle = |number: usize| {
            let own = &self.plants[1 + number * POINTS..][..POINTS];
            Measure::ALL.iter().all(|measure| {
                let sizes: Vec<f64> = own.iter().map(|own| own.strays.size_m(*measure)).collect();
                let [low, high] = extremes(&sizes);
                high - low <= IDLE * self.travel_m
            })
        };
        let keys = self.keys.iter().enumerate().filter(|(number, _)| is_idle(*number));
        keys.map(|(_, own)| &own.key).collect()
    }

    /// Values of the plants on keys and corners with the largest tip errors, at most `most`.
    pub fn hardest(&self, most: usize) -> Vec<&[Option<f64>]> {
        let is_chosen = |own: &&Plant| matches!(own.kind, PlantKind::Key | PlantKind::Corner);
        let mut chosen: Vec<&Plant> = self.plants.iter().filter(is_chosen).collect();
        chosen.sort_by(|a, b| b.strays.tip_error_m.total_cmp(&a.strays.tip_error_m));
        chosen.iter().take(most).map(|own| &own.values[..]).collect()
    }
}

/// Number of the plant with the largest measure; the first of equals.
fn worst_of(plants: &[Plant], measure: Measure) -> usize {
    let size = |k: usize| plants[k].strays.size_m(measure);
    (1..plants.len()).fold(0, |worst, k| if size(k) > size(worst) { k } else { worst })
}

/// Corners: the ends of each key, and its worst values inside.
fn corners_of(keys: &[KeyOutcome]) -> Vec<Values> {
    let candidates: Vec<Vec<f64>> = keys
        .iter()
        .map(|own| {
            let mut all = vec![own.key.ends[0]];
            all.extend(own.inside.iter().map(|inside| inside.value));
            all.push(own.key.ends[1]);
            all
        })
        .collect();
    let nearest = |own: &[f64], value: f64| {
        let apart = |k: &usize| (own[*k] - value).abs();
        (0..own.len()).min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or(0)
    };
    let worst = |measure: usize| {
        let pairs = keys.iter().zip(&candidates);
        pairs.map(|(own, all)| nearest(all, own.worst[measure].value)).collect()
    };
    corners(&candidates, &[0, 1, 2].map(worst))
}

/// Quantiles of a measure.
fn quantiles(sample: &[Strays], measure: Measure) -> Quantiles {
    let mut sizes: Vec<f64> = sample.iter().map(|own| own.size_m(measure)).collect();
    sizes.sort_by(f64::total_cmp);
    let last = (sizes.len() - 1) as f64;
    let at = |share: f64| {
        let place = (share * last).clamp(0.0, last);
        let low = below(place);
        let high = (low + 1).min(sizes.len() - 1);
        sizes[low] + (place - low as f64) * (sizes[high] - sizes[low])
    };
    // A share q of n plants has the standard error √(q (1 − q)/n).
    let with_error = |q: f64| {
        let count = sizes.len() as f64;
        let off = (q * (1.0 - q) / count).sqrt();
        let is_known = count * (1.0 - q) > FEW - 1e-9;
        (at(q), is_known.then(|| 0.5 * (at(q + off) - at(q - off))))
    };
    Quantiles { median_m: with_error(0.5), p95_m: with_error(0.95), p99_m: with_error(0.99) }
}
