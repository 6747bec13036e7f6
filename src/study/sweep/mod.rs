//! Many cases of one link and motion, or of an arm and its path: their values, the share of one machine, their numbers,
//! and their parallel computation in order.

mod columns;
mod variation;

pub use columns::{CaseNumbers, PlayedCase, SolvedCase, SweepKind, column_of_carriage};
pub use variation::{Operation, Variation, VariationError};

use std::collections::BTreeMap;
use std::ops::Range;
use std::panic::resume_unwind;
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{fmt, thread};

use rayon::ThreadPoolBuilder;
use thiserror::Error;

use crate::motion::MotionScale;
use crate::text::excerpt;

/// All cases of a sweep: the product of its variations, with the last one varying fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPlan {
    variations: Vec<Variation>,
    cases: usize,
}

/// The values of one case of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseValues {
    /// Value of every variation, as shown in its column.
    pub values: Vec<String>,
    /// Changes of the link file, in the form of `--set`.
    pub link_changes: Vec<String>,
    /// Change of the motion.
    pub motion: MotionScale,
}

/// Reason why variations make no sweep.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum PlanError {
    /// Two variations have the same path.
    #[error("{path} is varied twice, but must be varied once")]
    Twice {
        /// Path of the variations.
        path: String,
    },
    /// The number of cases overflows.
    #[error("the product of all values has more cases than can be counted")]
    TooMany,
    /// A value of the motion is not a factor.
    #[error("{change}, but {path} of the motion takes factors, {path}*=0.5,1,2")]
    NoFactor {
        /// Path, `distance` or `duration`.
        path: String,
        /// Text of the change.
        change: String,
    },
}

impl PlanError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Twice { .. } => "write all of its values at once: PATH=1,2,3",
            Self::TooMany => "use fewer values, or several sweeps",
            Self::NoFactor { .. } => "factors are numbers without a unit",
        }
    }
}

/// Values of the motion that can vary.
const DISTANCE: &str = "distance";
const DURATION: &str = "duration";

impl SweepPlan {
    /// Makes a plan from the variations of a sweep.
    ///
    /// # Errors
    /// A path that varies twice, values of the motion that are not factors, or an overflow of the number of cases.
    pub fn new(variations: Vec<Variation>) -> Result<Self, PlanError> {
        for (number, variation) in variations.iter().enumerate() {
            let path = variation.path();
            if variations[..number].iter().any(|earlier| earlier.path() == path) {
                return Err(PlanError::Twice { path: excerpt(path).into_owned() });
            }
            let of_motion = path == DISTANCE || path == DURATION;
            let not_a_factor = (0..variation.values().len())
                .find(|k| of_motion && factor(variation, *k).is_none())
                .map(|k| excerpt(&variation.change(k)).into_owned());
            if let Some(change) = not_a_factor {
                return Err(PlanError::NoFactor { path: path.to_owned(), change });
            }
        }
        let product =
            |cases: usize, variation: &Variation| cases.checked_mul(variation.values().len());
        let cases = variations.iter().try_fold(1, product).ok_or(PlanError::TooMany)?;
        Ok(Self { variations, cases })
    }

    /// The variations in their order.
    pub fn variations(&self) -> &[Variation] {
        &self.variations
    }

    /// Number of cases.
    pub fn cases(&self) -> usize {
        self.cases
    }

    /// The first case, and all cases that differ from it in one value: every value once.
    pub fn single_changes(&self) -> impl Iterator<Item = usize> {
        let strides = self.variations.iter().rev().scan(1, |stride, variation| {
            let (own, values) = (*stride, variation.values().len());
            *stride *= values;
            Some((own, values))
        });
        let others: Vec<_> = strides.collect();
        let changed =
            others.into_iter().flat_map(|(stride, values)| (1..values).map(move |k| k * stride));
        std::iter::once(0).chain(changed)
    }

    /// The values of a case, counted from 0.
    pub fn case(&self, number: usize) -> CaseValues {
        let mut left = number;
        let mut chosen: Vec<usize> = Vec::with_capacity(self.variations.len());
        for variation in self.variations.iter().rev() {
            chosen.push(left % variation.values().len());
            left /= variation.values().len();
        }
        chosen.reverse();
        let mut case =
            CaseValues { values: vec![], link_changes: vec![], motion: MotionScale::default() };
        for (variation, k) in self.variations.iter().zip(chosen) {
            case.values.push(variation.shown(k).to_owned());
            match (variation.path(), factor(variation, k)) {
                (DISTANCE, Some(factor)) => case.motion.distance = factor,
                (DURATION, Some(factor)) => case.motion.duration = factor,
                _ => case.link_changes.push(variation.change(k)),
            }
        }
        case
    }
}

/// Factor of a multiplying variation.
fn factor(variation: &Variation, number: usize) -> Option<f64> {
    let factor = variation.values()[number].parse().ok().filter(|x: &f64| x.is_finite());
    factor.filter(|_| !variation.has_unit() && variation.operation() == Operation::Multiply)
}

/// Largest number of shards of one sweep.
const MOST: usize = 100_000;

/// Every N-th case, the share of one of N machines: `2/8` has the cases 2, 10, 18, …
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

/// Text that does not describe a shard.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("shard = {found:?}, but must read I/N, 1 <= I <= N, N at most {MOST}")]
pub struct ShardError {
    found: String,
}

impl Default for Shard {
    /// A single shard with all cases.
    fn default() -> Self {
        Self { number: 1, of: 1 }
    }
}

impl Shard {
    /// Number of the shard, from 1.
    pub fn number(&self) -> usize {
        self.number
    }

    /// Number of shards.
    pub fn of(&self) -> usize {
        self.of
    }

    /// Number of its cases out of `cases`.
    pub fn len(&self, cases: usize) -> usize {
        cases.saturating_add(self.of - self.number) / self.of
    }

    /// Number of its `k`-th case, both from 0.
    pub fn case(&self, k: usize) -> usize {
        k.saturating_mul(self.of).saturating_add(self.number - 1)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = |text: &str| text.trim().parse::<usize>().ok().filter(|n| *n > 0);
        let pair = text.split_once('/').and_then(|(i, n)| Some((number(i)?, number(n)?)));
        match pair {
            Some((number, of)) if number <= of && of <= MOST => Ok(Self { number, of }),
            _ => Err(ShardError { found: excerpt(text).into_owned() }),
        }
    }
}

/// Computes many cases on all threads of the current pool, and passes the results to `take` in the order of the cases,
/// each as soon as all before it are done.
///
/// A case has one thread, or an even share of them if there are fewer cases than threads. When `stop` becomes true, or
/// `take` fails, running cases end and no other begins: the results passed to `take` have no gap.
///
/// The working threads themselves call `take`, one at a time.
///
/// # Errors
/// The first error of `take`.
pub fn in_order<T: Send, E: Send>(
    cases: Range<usize>,
    stop: &AtomicBool,
    work: impl Fn(usize) -> T + Sync,
    take: impl FnMut(usize, T) -> Result<(), E> + Send,
) -> Result<(), E> {
    let threads = rayon::current_num_threads();
    let workers = threads.min(cases.len());
    if workers == 0 {
        return Ok(());
    }
    let next = AtomicUsize::new(cases.start);
    let failed = AtomicBool::new(false);
    let done = Done { waiting: BTreeMap::new(), due: cases.start, take: Some(take) };
    let done = Mutex::new(done);
    let worker = || {
        // Parallel work within a case uses these threads. If the system has no more threads, it shares the threads of
        // the whole program.
        let _own =
            ThreadPoolBuilder::new().num_threads(threads / workers).use_current_thread().build();
        while !stop.load(Ordering::Relaxed) && !failed.load(Ordering::Relaxed) {
            let case = next.fetch_add(1, Ordering::Relaxed);
            if case >= cases.end {
                break;
            }
            hand_over(&done, case, work(case))
                .inspect_err(|_| failed.store(true, Ordering::Relaxed))?;
        }
        Ok(())
    };
    thread::scope(|scope| {
        let begin = |_| thread::Builder::new().spawn_scoped(scope, worker).ok();
        let begun: Vec<_> = (0..workers).filter_map(begin).collect();
        if begun.is_empty() {
            return worker();
        }
        let ended = begun.into_iter().map(|one| one.join().unwrap_or_else(|it| resume_unwind(it)));
        // All threads end before the error is returned.
        ended.fold(Ok(()), Result::and)
    })
}

/// Finished results that were not yet passed to `take`.
struct Done<T, F> {
    waiting: BTreeMap<usize, T>,
    /// The next case for `take`.
    due: usize,
    /// `None` while a thread calls it, and after it failed.
    take: Option<F>,
}

/// Passes a case and all that waited for it to `take`, unless an earlier one is unfinished or another thread is calling
/// `take` and will pass this one.
fn hand_over<T, E>(
    done: &Mutex<Done<T, impl FnMut(usize, T) -> Result<(), E>>>,
    case: usize,
    found: T,
) -> Result<(), E> {
    let mut now = locked(done);
    now.waiting.insert(case, found);
    let Some(mut take) = now.take.take() else { return Ok(()) };
    loop {
        let due = now.due;
        let Some(found) = now.waiting.remove(&due) else { break };
        drop(now);
        take(due, found)?;
        now = locked(done);
        now.due += 1;
    }
    now.take = Some(take);
    Ok(())
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use rayon::prelude::*;

    use super::*;

    fn plan(variations: &[&str]) -> Result<SweepPlan, PlanError> {
        SweepPlan::new(variations.iter().map(|text| text.parse().unwrap()).collect())
    }

    #[test]
    fn the_last_variation_runs_fastest() {
        let plan = plan(&["hub.inertia=1,2", "duration*=0.5,1,2"]).unwrap();
        assert_eq!(plan.cases(), 6);
        let fourth = plan.case(3);
        assert_eq!(fourth.values, ["2", "0.5"]);
        assert_eq!(fourth.link_changes, ["hub.inertia=2"]);
        assert_eq!(fourth.motion, MotionScale { distance: 1.0, duration: 0.5 });
    }

    #[test]
    fn every_value_stands_alone_in_one_case() {
        let plan = plan(&["a=1,2", "b=1,2,3", "c=1,2"]).unwrap();
        let values = plan.single_changes().map(|case| plan.case(case).values.concat());
        assert_eq!(values.collect::<Vec<_>>(), ["111", "112", "121", "131", "211"]);
    }

    #[test]
    fn what_makes_no_sweep_is_refused() {
        let refusal = |variations: &[&str]| plan(variations).unwrap_err().to_string();
        assert!(
            refusal(&["hub.inertia=1", "hub.inertia*=2"])
                .starts_with("hub.inertia is varied twice")
        );
        assert!(refusal(&["duration=1,2"]).starts_with("duration=1, but duration of the motion"));
        assert!(refusal(&["distance*=1,x"]).starts_with("distance*=x"));
        assert!(refusal(&["distance*=1 m:2 m:2"]).starts_with("distance*=1 m"));
        let thousand: Vec<String> = (0..7).map(|k| format!("hub.{k}=1:2:1000")).collect();
        let thousand: Vec<&str> = thousand.iter().map(String::as_str).collect();
        assert!(refusal(&thousand).contains("more cases than can be counted"));
        assert_eq!(plan(&thousand[1..]).unwrap().cases(), 1_000_000_000_000_000_000);
    }

    #[test]
    fn shards_share_all_cases_and_none_twice() {
        for (cases, of) in [(10, 3), (7, 7), (5, 8), (0, 2), (1, 1)] {
            let mut seen = vec![0; cases];
            for number in 1..=of {
                let shard: Shard = format!("{number}/{of}").parse().unwrap();
                (0..shard.len(cases)).for_each(|k| seen[shard.case(k)] += 1);
            }
            assert!(seen.iter().all(|times| *times == 1), "{cases} cases, {of} shards: {seen:?}");
        }
    }

    #[test]
    fn a_shard_that_there_is_not_is_refused() {
        for text in ["0/4", "5/4", "1", "a/b", "1/0", "-1/2", "1/100001", ""] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }

    fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
        ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
    }

    /// Uneven work with inner parallelism.
    fn sum(case: usize) -> usize {
        let terms = 1000 * (case % 7);
        (0..terms).into_par_iter().map(|k| k % 3).sum::<usize>() + case
    }

    #[test]
    fn rows_come_in_order_on_any_number_of_threads() {
        let go = AtomicBool::new(false);
        let rows = |threads| {
            on_threads(threads, || {
                let mut rows = Vec::new();
                let take = |case, sum| {
                    rows.push((case, sum));
                    Ok::<(), ()>(())
                };
                in_order(3..200, &go, sum, take).unwrap();
                rows
            })
        };
        let expected: Vec<_> = (3..200).map(|case| (case, sum(case))).collect();
        for threads in [1, 2, 7, 300] {
            assert_eq!(rows(threads), expected, "{threads} threads");
        }
    }

    #[test]
    fn nothing_is_missing_before_the_case_at_which_it_was_stopped() {
        let stop = AtomicBool::new(false);
        let mut rows = Vec::new();
        let work = |case| {
            if case == 50 {
                stop.store(true, Ordering::Relaxed);
            }
            case
        };
        let take = |case, done| {
            assert_eq!(case, done);
            rows.push(case);
            Ok::<(), ()>(())
        };
        on_threads(4, || in_order(0..10_000, &stop, work, take)).unwrap();
        assert!((51..10_000).contains(&rows.len()), "{} rows", rows.len());
        assert!(rows.iter().copied().eq(0..rows.len()));
    }

    #[test]
    fn a_row_that_is_not_taken_ends_the_work() {
        let stop = AtomicBool::new(false);
        let begun = AtomicUsize::new(0);
        let work = |case| {
            begun.fetch_add(1, Ordering::Relaxed);
            case
        };
        let take = |case, _| if case == 5 { Err("full") } else { Ok(()) };
        let ended = on_threads(2, || in_order(0..1_000_000, &stop, work, take));
        assert_eq!(ended, Err("full"));
        assert!(begun.load(Ordering::Relaxed) < 1_000_000);
    }
}
