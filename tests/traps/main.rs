//! Runs whose truth is known by other means: each number that the program writes is held against an
//! exact solution of the link, and the error that it claims against the error that it has.
//!
//! `cargo test --test traps -- --nocapture` prints the table: the end of the band and the warnings,
//! claimed | true error of every quantity, and the peaks at four steps. `FLEXLINK_TRAPS_SEED` draws
//! other cases.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "rows, samples and nodes are counted in thousands"
)]

mod answer;
mod beam;
mod case;
mod judge;
mod link;
mod listed;
mod modes;
mod motion;
mod random;
mod report;
mod run;
mod steps;
mod theory;
mod truth;
mod waves;

use rayon::prelude::*;

use report::Report;

/// Seed of the cases that are drawn.
const SEED: u64 = 21;

/// How many are drawn.
const DRAWN: usize = 44;

/// Seed and number of cases that were found wrong when other seeds were tried.
const FOUND: [(u64, usize); 6] = [(1, 8), (1, 35), (3, 34), (3, 42), (4, 3), (4, 37)];

#[test]
fn no_case_is_wrong_without_a_word() {
    let seed = std::env::var("FLEXLINK_TRAPS_SEED");
    let seed = seed.map_or(SEED, |text| text.parse().expect("a seed is a number"));
    let drawn = (0..DRAWN).map(|k| random::drawn(seed, k));
    let found = FOUND.map(|(seed, k)| random::drawn(seed, k));
    let cases: Vec<_> = listed::cases().into_iter().chain(found).chain(drawn).collect();
    let reports: Vec<Report> = cases.par_iter().map(Report::of).collect();
    let mut failed = Vec::new();
    for Report { name, lines, wrong, .. } in &reports {
        println!("{name}: {}", lines.join("\n    "));
        if !wrong.is_empty() {
            println!("    WRONG: {}", wrong.join("; "));
            failed.push(format!("{name}: {}", wrong.join("; ")));
        }
    }
    let compared = reports.iter().filter(|report| report.same_motion > 1).count();
    println!("{} cases, {compared} at several steps, {} wrong", reports.len(), failed.len());
    assert!(failed.is_empty(), "wrong without a word:\n{}", failed.join("\n"));
}
