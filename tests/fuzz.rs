//! The laws of the fuzz targets, held by their corpora and by inputs made of these: the same ones every
//! time, so that a run that fails tells of a change. `fuzz/run` makes up ever new ones.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::{Config, RngSeed, TestRunner};

#[path = "../fuzz/src/lib.rs"]
#[expect(unreachable_pub, reason = "a library of its own for the targets")]
mod laws;

/// What is done to an input; places are shares of its length.
#[derive(Debug, Clone)]
enum Change {
    /// A bit is turned.
    Turn { at: Index, bit: u8 },
    /// Some bytes go.
    Cut { at: Index, len: usize },
    /// Some bytes of an input of the corpus come in between.
    Splice { at: Index, from: Index, start: Index, len: usize },
}

fn change() -> impl Strategy<Value = Change> {
    let at = any::<Index>;
    prop_oneof![
        (at(), 0..8_u8).prop_map(|(at, bit)| Change::Turn { at, bit }),
        (at(), 1..9_usize).prop_map(|(at, len)| Change::Cut { at, len }),
        (at(), at(), at(), 1..65_usize).prop_map(|(at, from, start, len)| Change::Splice {
            at,
            from,
            start,
            len
        }),
    ]
}

fn changed(mut input: Vec<u8>, change: &Change, corpus: &[Vec<u8>]) -> Vec<u8> {
    match change {
        _ if input.is_empty() => {}
        Change::Turn { at, bit } => *at.get_mut(&mut input) ^= 1 << bit,
        Change::Cut { at, len } => {
            let start = at.index(input.len());
            input.drain(start..input.len().min(start + len));
        }
        Change::Splice { at, from, start, len } => {
            let other = from.get(corpus);
            let start = start.index(other.len() + 1);
            let piece = &other[start..other.len().min(start + len)];
            let at = at.index(input.len());
            input.splice(at..at, piece.iter().copied());
        }
    }
    input
}

fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let paths = fs::read_dir(folder)
        .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, _>>());
    let mut paths = paths.expect("a folder of inputs");
    paths.sort();
    paths.iter().map(|path| fs::read(path).expect("an input")).collect()
}

/// Holds the corpus of a target, and so many inputs made of it, to the target's laws.
fn hold(target: &str, law: fn(&[u8]), inputs: u32) {
    let corpus = corpus(target);
    assert!(corpus.len() >= 8, "{} inputs of {target}", corpus.len());
    for input in &corpus {
        law(input);
    }
    let made = (any::<Index>(), prop::collection::vec(change(), 1..5)).prop_map(|(of, changes)| {
        let first = of.get(&corpus).clone();
        changes.iter().fold(first, |input, change| changed(input, change, &corpus))
    });
    let config = Config {
        cases: inputs,
        rng_seed: RngSeed::Fixed(1987),
        failure_persistence: None,
        ..Config::default()
    };
    let kept = TestRunner::new(config).run(&made, |input| {
        let is_kept = catch_unwind(AssertUnwindSafe(|| law(&input))).is_ok();
        prop_assert!(is_kept, "{:?}", String::from_utf8_lossy(&input));
        Ok(())
    });
    kept.unwrap_or_else(|error| panic!("{target}: {error}"));
}

#[test]
fn link_files_keep_their_laws() {
    hold("link_file", laws::link_file, 10_000);
}

#[test]
fn quantities_keep_their_laws() {
    hold("quantity", laws::quantity, 30_000);
}

#[test]
fn overrides_keep_their_laws() {
    hold("override_path", laws::override_path, 3000);
}

#[test]
fn motions_keep_their_laws() {
    hold("motion_csv", laws::motion_csv, 10_000);
}

#[test]
fn torques_keep_their_laws() {
    hold("torque_csv", laws::torque_csv, 10_000);
}

#[test]
fn compared_tables_keep_their_laws() {
    hold("compare_csv", laws::compare_csv, 10_000);
}

#[test]
fn solutions_keep_their_laws() {
    hold("solve", laws::solve, 4000);
}
