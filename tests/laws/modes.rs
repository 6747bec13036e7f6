//! Counting modes by the signs of the pivots.

use flexlink::modal::{modes_below, natural_frequencies};
use proptest::prelude::*;

use crate::links::{any_parts, mesh};

proptest! {
    /// Beside each natural frequency the count is the rigid rotation and the modes found so far.
    #[test]
    fn the_count_of_modes_jumps_by_one_at_each_natural_frequency(
        parts in any_parts(),
        elements in 7_usize..30,
    ) {
        let mesh = mesh(&parts, elements);
        let found = natural_frequencies(&mesh, 8);
        prop_assert_eq!(found.len(), 8);
        for (k, omega) in found.iter().enumerate() {
            prop_assert_eq!(modes_below(&mesh, omega * (1.0 - 1e-9)), k + 1);
            prop_assert_eq!(modes_below(&mesh, omega * (1.0 + 1e-9)), k + 2);
        }
    }

    #[test]
    fn the_count_of_modes_never_falls_and_ends_at_the_degrees_of_freedom(
        parts in any_parts(),
        elements in 7_usize..30,
    ) {
        let mesh = mesh(&parts, elements);
        let lowest = natural_frequencies(&mesh, 1)[0];
        let counts = (-20..300).map(|k| modes_below(&mesh, lowest * 1.1_f64.powi(k)));
        let counts: Vec<usize> = counts.collect();
        prop_assert!(counts.is_sorted(), "{:?}", counts);
        prop_assert_eq!(counts[0], 1);
        prop_assert_eq!(counts[counts.len() - 1], 2 * elements + 1);
    }
}
