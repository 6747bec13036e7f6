//! What `trajectory --fit-limit` says of the duration that it found.

use flexlink::numeric::{plain, significant};
use flexlink::result::{Fit, Limits, Metrics, Reached};

/// What a duration is among those that were tried, with all limits that it is within.
pub(crate) fn found_text(fit: &Fit, limits: &Limits) -> String {
    let held = limits.held(&Metrics::of(&fit.solution));
    let each = held.iter().map(|held| format!("{}={} {}", held.key, plain(held.limit), held.unit));
    let within = each.collect::<Vec<_>>().join(", ");
    if fit.is_shortest() {
        return format!("the shortest within {within}");
    }
    let (tried, shorter) = (fit.shorter_tried, fit.shorter());
    format!("within {within}; {tried} of the {shorter} shorter durations were tried, none fits")
}

/// Which limit a motion comes closest to, and by how much.
pub(crate) fn binding_text(fit: &Fit) -> String {
    if fit.has_fewest_steps() {
        return "; no limit binds: the profile has no fewer steps".to_owned();
    }
    let Some(Reached { held, error }) = fit.binding else { return String::new() };
    let below = 100.0 * (1.0 - Reached { held, error }.share());
    let below = if below < 0.01 { "less than 0.01".to_owned() } else { format!("{below:.2}") };
    format!(
        "; limits.{} binds: {} of {} {}, {below} % below it with the error of {error:.1e}",
        held.key,
        significant(held.found, 5),
        plain(held.limit),
        held.unit,
    )
}
