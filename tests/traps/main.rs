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

/// Cases that are wrong today, and why; each is held to be wrong still.
const KNOWN: [(&str, &str); 0] = [];

#[test]
fn no_case_is_wrong_without_a_word() {
    let seed = std::env::var("FLEXLINK_TRAPS_SEED");
    let seed = seed.map_or(SEED, |text| text.parse().expect("a seed is a number"));
    let cases = [listed::cases(), random::cases(seed, DRAWN)].concat();
    let reports: Vec<Report> = cases.par_iter().map(Report::of).collect();
    let mut failed = Vec::new();
    for Report { name, lines, wrong, .. } in &reports {
        println!("{name}: {}", lines.join("\n    "));
        let known = KNOWN.iter().find(|(known, _)| known == name);
        match (known, wrong.is_empty()) {
            (None, true) => {}
            (None, false) => failed.push(format!("{name}: {}", wrong.join("; "))),
            (Some((_, why)), false) => println!("    known: {why}: {}", wrong.join("; ")),
            (Some(_), true) => failed.push(format!("{name}: no longer wrong, no longer known")),
        }
    }
    let compared = reports.iter().filter(|report| report.same_motion > 1).count();
    println!("{} cases, {compared} at several steps, {} wrong", reports.len(), failed.len());
    assert!(failed.is_empty(), "wrong without a word:\n{}", failed.join("\n"));
}
