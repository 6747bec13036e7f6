//! Times of the parts behind the commands: `cargo bench --package flexlink-speed`, with
//! `-- transform` for one.
//!
//! One program of all subjects, so that the slow optimised link is made once. Criterion prints the
//! throughput of each row; its reciprocal is the time of one element, number, sample or byte.

#![expect(clippy::unwrap_used, reason = "a bench may stop where a test may")]
#![expect(missing_docs, reason = "criterion's macro makes a public function without any")]

mod formatter;
mod inputs;
mod inversion;
mod reader;
mod recursion;
mod simulation;
mod transform;

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};

criterion_group! {
    name = speed;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    targets =
        recursion::bench,
        transform::bench,
        formatter::bench,
        reader::bench,
        inversion::bench,
        simulation::bench,
}
criterion_main!(speed);
