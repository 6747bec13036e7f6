//! Runs whose truth is known by other means: each number that the program writes is held against an
//! exact solution of the link, and the error that it claims against the error that it has.
//!
//! `cargo test --test traps -- --nocapture` prints the table: the end of the band and the warnings,
//! claimed | true error of every quantity, and the peaks at four steps. `FLEXLINK_TRAPS_SEED` draws
//! other cases, `FLEXLINK_TRAPS_CASE` takes only those with these words in their name.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "rows, samples and nodes are counted in thousands"
)]

mod answer;
mod beam;
mod case;
mod excuse;
mod fitted;
mod half_step;
mod judge;
mod link;
mod listed;
mod modes;
mod motion;
#[path = "../mechanics/theory/published.rs"]
mod published;
mod random;
mod report;
mod run;
mod steps;
mod theory;
mod truth;
mod waves;

use rayon::prelude::*;

use case::Case;
use report::Report;

/// Seed of the cases that are drawn.
const SEED: u64 = 21;

/// How many are drawn.
const DRAWN: usize = 44;

/// How many are drawn with carriages, stations and springs at the root.
const OTHERS: usize = 44;

/// Steps of a drawn motion, every factor as likely.
const STEPS: [f64; 2] = [8.0, 600.0];

/// Seed and number of cases that were found wrong when other seeds were tried.
const FOUND: [(u64, usize); 6] = [(1, 8), (1, 35), (3, 34), (3, 42), (4, 3), (4, 37)];

/// Their steps.
const STEPS_OF_FOUND: [f64; 2] = [60.0, 600.0];

/// The same of cases with [`STEPS`].
const FOUND_LATER: [(u64, usize); 7] =
    [(31, 1), (31, 26), (32, 34), (33, 18), (34, 16), (34, 24), (34, 27)];

/// Seed and number of a case with a station that was found wrong.
const FOUND_OTHERS: [(u64, usize); 1] = [(23, 12)];

/// At least so many cases are compared at several steps, …
const COMPARED: usize = 60;

/// … at most this share of all is refused, …
const REFUSED: f64 = 0.1;

/// … and at least this share of all claims is judged without a warning that excuses it.
const NOT_EXCUSED: f64 = 0.91;

/// All cases, or those that the environment asks for.
fn cases(seed: u64, name: &str) -> Vec<Case> {
    let drawn = (0..DRAWN).map(|k| random::drawn(seed, k, STEPS));
    let found = FOUND.map(|(seed, k)| random::drawn(seed, k, STEPS_OF_FOUND));
    let later = FOUND_LATER.map(|(seed, k)| random::drawn(seed, k, STEPS));
    let others = (0..OTHERS).map(|k| (seed, k)).chain(FOUND_OTHERS);
    let others = others.map(|(seed, k)| random::drawn_otherwise(seed, k, STEPS));
    let all = listed::cases().into_iter().chain(found).chain(later).chain(drawn).chain(others);
    all.filter(|case| case.name.contains(name)).collect()
}

#[test]
fn no_case_is_wrong_without_a_word() {
    let seed = std::env::var("FLEXLINK_TRAPS_SEED");
    let seed = seed.map_or(SEED, |text| text.parse().expect("a seed is a number"));
    let only = std::env::var("FLEXLINK_TRAPS_CASE").unwrap_or_default();
    let reports: Vec<Report> = cases(seed, &only).par_iter().map(Report::of).collect();
    let mut failed = Vec::new();
    for Report { name, lines, wrong, .. } in &reports {
        println!("{name}: {}", lines.join("\n    "));
        if !wrong.is_empty() {
            println!("    WRONG: {}", wrong.join("; "));
            failed.push(format!("{name}: {}", wrong.join("; ")));
        }
    }
    let counts = Counts::of(&reports);
    println!("{counts:?}, {} wrong", failed.len());
    assert!(failed.is_empty(), "wrong without a word:\n{}", failed.join("\n"));
    if only.is_empty() {
        counts.check();
    }
}

/// What all cases came to.
#[derive(Debug)]
struct Counts {
    cases: usize,
    refused: usize,
    /// At several steps.
    compared: usize,
    claims: usize,
    excused: usize,
}

impl Counts {
    fn of(reports: &[Report]) -> Self {
        Self {
            cases: reports.len(),
            refused: reports.iter().filter(|report| report.is_refused).count(),
            compared: reports.iter().filter(|report| report.same_motion > 1).count(),
            claims: reports.iter().map(|report| report.claims).sum(),
            excused: reports.iter().map(|report| report.excused).sum(),
        }
    }

    /// The cases judge what they are for.
    fn check(&self) {
        let Self { cases, refused, compared, claims, excused } = *self;
        assert!(refused as f64 <= REFUSED * cases as f64, "{refused} of {cases} are refused");
        assert!(compared >= COMPARED, "{compared} are compared at several steps");
        let judged = claims - excused;
        assert!(judged as f64 >= NOT_EXCUSED * claims as f64, "{excused} of {claims} are excused");
    }
}
