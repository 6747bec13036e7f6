/// Largest absolute value, what is not a number left out; 0 of nothing.
pub fn largest(values: &[f64]) -> f64 {
    // Eight at a time, as vectors compare; the largest does not depend on their order.
    let (eights, rest) = values.as_chunks::<8>();
    let mut found = [0.0; 8];
    let larger = |largest: f64, value: f64| if value > largest { value } else { largest };
    for eight in eights {
        for (found, value) in found.iter_mut().zip(eight) {
            *found = larger(*found, value.abs());
        }
    }
    found.iter().chain(rest).fold(0.0, |largest, value| larger(largest, value.abs()))
}

/// Largest absolute difference of two histories, sample by sample as far as both go.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest, (a, b)| largest.max((a - b).abs()))
}
