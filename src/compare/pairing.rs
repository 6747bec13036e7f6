use super::table::{Table, TableColumn};

/// Largest difference of the keys of one row, relative to the distance of the nearest row: rounding
/// moves a time by far less, another step by far more.
const KEY_SHARE: f64 = 1e-3;

/// Which row of EXPECTED belongs to which row of ACTUAL.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Pairing {
    /// Rows of EXPECTED and ACTUAL, in order.
    pub(super) pairs: Vec<(usize, usize)>,
    /// Rows that only EXPECTED has, in order.
    pub(super) expected: Vec<usize>,
    /// Rows that only ACTUAL has, in order.
    pub(super) actual: Vec<usize>,
}

/// The column that rows are matched by, in EXPECTED and in ACTUAL: the first one of EXPECTED, if
/// ACTUAL has one of that name and both increase from row to row.
pub(super) fn key<'a>(expected: &'a Table, actual: &'a Table) -> Option<[&'a TableColumn; 2]> {
    let first = expected.columns.first()?;
    let other = actual.column(first.name())?;
    (first.increasing().is_some() && other.increasing().is_some()).then_some([first, other])
}

impl Pairing {
    /// Row by row, as they stand.
    pub(super) fn by_number(expected: usize, actual: usize) -> Self {
        let both = expected.min(actual);
        Self {
            pairs: (0..both).map(|row| (row, row)).collect(),
            expected: (both..expected).collect(),
            actual: (both..actual).collect(),
        }
    }

    /// By keys, both strictly increasing.
    pub(super) fn by_key(expected: &[f64], actual: &[f64]) -> Self {
        let mut found = Self::default();
        let (mut e, mut a) = (0, 0);
        while e < expected.len() && a < actual.len() {
            let (left, right) = (expected[e], actual[a]);
            let reach = KEY_SHARE * gap(expected, e).min(gap(actual, a));
            if (left - right).abs() <= reach {
                found.pairs.push((e, a));
                e += 1;
                a += 1;
            } else if left < right {
                found.expected.push(e);
                e += 1;
            } else {
                found.actual.push(a);
                a += 1;
            }
        }
        found.expected.extend(e..expected.len());
        found.actual.extend(a..actual.len());
        found
    }
}

/// Distance of a key to its nearest neighbour; infinite for a single key.
fn gap(keys: &[f64], row: usize) -> f64 {
    let before = if row > 0 { keys[row] - keys[row - 1] } else { f64::INFINITY };
    let after = keys.get(row + 1).map_or(f64::INFINITY, |next| next - keys[row]);
    before.min(after)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_match_across_rounding_and_not_across_steps() {
        let expected = [-0.2, -0.1, 0.0, 0.1, 0.3];
        let actual = [-0.1 + 9e-5, 1e-17, 0.1 - 2e-4, 0.3, 0.4];
        let found = Pairing::by_key(&expected, &actual);
        assert_eq!(found.pairs, [(1, 0), (2, 1), (4, 3)]);
        assert_eq!(found.expected, [0, 3]);
        assert_eq!(found.actual, [2, 4]);
    }

    #[test]
    fn a_logarithmic_key_is_measured_by_its_own_steps() {
        let expected = [1e-6, 1e-5, 1.0, 1e6];
        let actual = [1e-6 + 1e-10, 1e-5, 1.0, 1e6 * (1.0 + 1e-9)];
        assert_eq!(Pairing::by_key(&expected, &actual).pairs, [(0, 0), (1, 1), (2, 2), (3, 3)]);
    }

    #[test]
    fn single_rows_belong_together() {
        assert_eq!(Pairing::by_key(&[5.0], &[7.0]).pairs, [(0, 0)]);
    }

    #[test]
    fn the_longer_table_keeps_its_last_rows() {
        let found = Pairing::by_number(2, 4);
        assert_eq!((found.pairs.len(), found.expected.len()), (2, 0));
        assert_eq!(found.actual, [2, 3]);
    }
}
