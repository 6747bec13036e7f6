//! Nothing depends on the units that lengths, masses and times are measured in.

use flexlink::beam::nodal_transfer;
use flexlink::link::{LinkParts, Taper};
use flexlink::modal::{natural_frequencies, torque_zeros};
use proptest::prelude::*;

use super::links::{any_excitation, any_parts, mesh};

/// How many of the new units one metre, kilogram and second are.
#[derive(Debug, Clone, Copy)]
struct Units {
    length: f64,
    mass: f64,
    time: f64,
}

/// Powers of two, which cost no digit.
fn any_units() -> impl Strategy<Value = Units> {
    (-8..8_i32, -8..8_i32, -8..8_i32).prop_map(|(length, mass, time)| Units {
        length: 2.0_f64.powi(length),
        mass: 2.0_f64.powi(mass),
        time: 2.0_f64.powi(time),
    })
}

impl Units {
    fn express(&self, parts: &LinkParts) -> LinkParts {
        let Self { length, mass, time } = *self;
        let inertia = mass * length * length;
        let scale = |taper: &mut Taper, factor: f64| *taper = taper.scaled(factor);
        let mut parts = parts.clone();
        for segment in &mut parts.segments {
            segment.length_m *= length;
            scale(&mut segment.bending_stiffness_n_m2, inertia * length / (time * time));
            scale(&mut segment.mass_per_length_kg_m, mass / length);
            if let Some(own) = &mut segment.timoshenko {
                scale(&mut own.shear_stiffness_n, mass * length / (time * time));
                scale(&mut own.rotary_inertia_per_length_kg_m, mass * length);
            }
        }
        for lumped in &mut parts.masses {
            lumped.at_m *= length;
            lumped.mass_kg *= mass;
            lumped.inertia_kg_m2 *= inertia;
        }
        parts.hub.inertia_kg_m2 *= inertia;
        parts.hub.radius_m *= length;
        parts.payload.mass_kg *= mass;
        parts.payload.inertia_kg_m2 *= inertia;
        parts.payload.offset_m *= length;
        parts
    }
}

proptest! {
    #[test]
    fn transfers_change_with_the_units_to_the_last_bit(
        parts in any_parts(),
        units in any_units(),
        excitation in any_excitation(),
    ) {
        let (here, there) = (mesh(&parts, 15), mesh(&units.express(&parts), 15));
        let Units { length, mass, time } = units;
        let lambda = excitation.lambda(&here);
        let here = nodal_transfer(&here, lambda);
        let there = nodal_transfer(&there, lambda / (time * time));
        prop_assert_eq!(there.tip.inertia_kg_m, here.tip.inertia_kg_m * (mass * length));
        prop_assert_eq!(there.tip.angle_rad_m, here.tip.angle_rad_m / length);
        for (there, here) in there.deflections_s2.iter().zip(&here.deflections_s2) {
            prop_assert_eq!(*there, here * (time * time));
        }
        for (there, here) in there.moments_kg_m.iter().zip(&here.moments_kg_m) {
            prop_assert_eq!(*there, here * (mass * length));
        }
    }

    #[test]
    fn frequencies_and_zeros_are_per_unit_of_time(parts in any_parts(), units in any_units()) {
        let (here, there) = (mesh(&parts, 15), mesh(&units.express(&parts), 15));
        let rates = [
            (natural_frequencies(&here, 4), natural_frequencies(&there, 4)),
            (torque_zeros(&here, 2), torque_zeros(&there, 2)),
        ];
        for (here, there) in rates {
            prop_assert_eq!(here.len(), there.len());
            for (here, there) in here.iter().zip(&there) {
                prop_assert!((there * units.time / here - 1.0).abs() < 1e-11);
            }
        }
    }
}
