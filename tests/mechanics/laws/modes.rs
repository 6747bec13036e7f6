//! Counting modes by the signs of the pivots, and what holding the hub does to them.

use flexlink::link::Link;
use flexlink::modal::{held_frequencies, modes_below, natural_frequencies};
use proptest::prelude::*;

use super::links::{any_parts, mesh};

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

    /// One more spring raises every frequency, and none beyond the next (Rayleigh); clamping is the
    /// stiffest spring.
    #[test]
    fn held_frequencies_lie_between_the_free_and_the_clamped_ones(
        parts in any_parts(),
        elements in 7_usize..30,
        decades in -4.0..7.0_f64,
    ) {
        let mesh = mesh(&parts, elements);
        let free = [vec![0.0], natural_frequencies(&mesh, 8)].concat();
        let held = held_frequencies(&mesh, 10.0_f64.powf(decades), 8);
        let clamped = held_frequencies(&mesh, f64::INFINITY, 8);
        prop_assert_eq!((held.len(), clamped.len()), (8, 8));
        let is_rising = |chain: &[f64]| chain.windows(2).all(|w| w[0] <= w[1] * (1.0 + 1e-12));
        for k in 0..8 {
            let chain = [free[k], held[k], clamped[k], free[k + 1]];
            prop_assert!(is_rising(&chain), "mode {}: {:?}", k + 1, chain);
            let above = held.get(k + 1).copied().unwrap_or(f64::INFINITY);
            prop_assert!(is_rising(&[clamped[k], above]), "mode {}: {:?}", k + 1, held);
        }
    }

    #[test]
    fn a_soft_joint_frees_the_hub_and_a_stiff_one_clamps_it(
        parts in any_parts(),
        elements in 7_usize..30,
    ) {
        let mesh = mesh(&parts, elements);
        let rigid = Link::new(parts).expect("a valid link").rigid_inertia_kg_m2();
        let free = natural_frequencies(&mesh, 7);
        let own = free[0].powi(2) * rigid;
        let off = |found: &[f64], limit: &[f64]| {
            assert_eq!(found.len(), limit.len());
            found.iter().zip(limit).fold(0.0_f64, |m, (a, b)| m.max((a / b - 1.0).abs()))
        };
        let soft = held_frequencies(&mesh, 1e-12 * own, 8);
        // The rigid link swings on the joint.
        let swing = (1e-12_f64 * own / rigid).sqrt();
        prop_assert!(off(&soft[..1], &[swing]) < 1e-6, "{:?}", soft);
        prop_assert!(off(&soft[1..], &free) < 1e-6, "{:?} for {:?}", soft, free);
        let clamped = held_frequencies(&mesh, f64::INFINITY, 8);
        let stiff = held_frequencies(&mesh, 1e12 * own, 8);
        prop_assert!(off(&stiff, &clamped) < 1e-6, "{:?} for {:?}", stiff, clamped);
    }
}
