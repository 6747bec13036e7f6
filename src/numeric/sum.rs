/// Terms that are added up side by side.
const ASIDE: usize = 8;

/// Sum of a term over values: eight sums side by side, which then are added up.
///
/// One after the other each sum would wait for the one before it; a result does not depend on the
/// processor either way.
pub(crate) fn sum_over<T>(values: &[T], term: impl Fn(&T) -> f64) -> f64 {
    let (eights, rest) = values.as_chunks::<ASIDE>();
    let mut sums = [0.0; ASIDE];
    for eight in eights {
        for (sum, value) in sums.iter_mut().zip(eight) {
            *sum += term(value);
        }
    }
    sums.iter().sum::<f64>() + rest.iter().map(term).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_summed_once_however_many_there_are() {
        for len in 0..30_u32 {
            let values: Vec<u32> = (1..=len).collect();
            let squares = f64::from(len * (len + 1) * (2 * len + 1)) / 6.0;
            assert_eq!(sum_over(&values, |x| f64::from(x * x)).to_bits(), squares.to_bits());
        }
    }
}
