use super::pairing::Pairing;
use super::table::{Cell, RowPlace, TableColumn};
use super::tolerance::Tolerance;

/// The comparison of one column of EXPECTED with that of ACTUAL.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnComparison {
    /// The heading.
    pub name: String,
    /// Largest absolute value of EXPECTED's finite numbers, in the column's unit.
    pub peak: f64,
    /// Its tolerance; `None` if it was not compared.
    pub tolerance: Option<Tolerance>,
    /// The field that differs most, the first of equals; `None` if all are the same.
    pub worst: Option<Worst>,
    /// Number of rows beyond tolerance.
    pub rows_beyond: usize,
}

/// The field of a column that differs most.
#[derive(Debug, Clone, PartialEq)]
pub struct Worst {
    /// Absolute difference in the column's unit; infinite unless both fields are finite numbers.
    pub difference: f64,
    /// EXPECTED's row.
    pub expected: RowPlace,
    /// ACTUAL's row.
    pub actual: RowPlace,
    /// EXPECTED's field, as text: empty, a word or a number.
    pub expected_field: String,
    /// ACTUAL's field, as text.
    pub actual_field: String,
}

impl ColumnComparison {
    /// Largest difference allowed, in the column's unit; `None` if it was not compared.
    pub fn allowed(&self) -> Option<f64> {
        self.tolerance.map(|tolerance| tolerance.allowed(self.peak))
    }

    /// True if a row is beyond tolerance.
    pub fn fails(&self) -> bool {
        self.rows_beyond > 0
    }

    /// The largest difference relative to the peak; 0 if there is none.
    pub fn relative(&self) -> f64 {
        let difference = self.worst.as_ref().map_or(0.0, |worst| worst.difference);
        if difference == 0.0 { 0.0 } else { difference / self.peak }
    }

    /// The largest difference as a multiple of what is allowed, for ranking.
    pub fn severity(&self) -> f64 {
        let difference = self.worst.as_ref().map_or(0.0, |worst| worst.difference);
        match self.allowed() {
            Some(allowed) if difference > 0.0 => difference / allowed,
            _ => 0.0,
        }
    }
}

/// The row and size of the largest difference.
struct Largest {
    difference: f64,
    expected: usize,
    actual: usize,
}

/// Compares a column that both sides have; `place` returns the places of the rows of a pair.
pub(super) fn compare_column(
    expected: &TableColumn,
    actual: &TableColumn,
    tolerance: Tolerance,
    pairing: &Pairing,
    place: impl Fn(usize, usize) -> (RowPlace, RowPlace),
) -> ColumnComparison {
    let peak = expected.peak();
    let allowed = tolerance.allowed(peak);
    let mut rows_beyond = 0;
    let mut largest: Option<Largest> = None;
    for &(e, a) in &pairing.pairs {
        let difference = difference(expected.cell(e), actual.cell(a));
        // Different words fail even with an infinite tolerance.
        rows_beyond += usize::from(difference > allowed || difference.is_infinite());
        if difference > largest.as_ref().map_or(0.0, |largest| largest.difference) {
            largest = Some(Largest { difference, expected: e, actual: a });
        }
    }
    let worst = largest.map(|largest| {
        let (expected_place, actual_place) = place(largest.expected, largest.actual);
        Worst {
            difference: largest.difference,
            expected: expected_place,
            actual: actual_place,
            expected_field: field(expected.cell(largest.expected)),
            actual_field: field(actual.cell(largest.actual)),
        }
    });
    let name = expected.name().to_owned();
    ColumnComparison { name, peak, tolerance: Some(tolerance), worst, rows_beyond }
}

/// Absolute difference of two fields: 0 if equal, infinite if one is no finite number.
fn difference(expected: Cell, actual: Cell) -> f64 {
    match (expected, actual) {
        (Cell::Number(e), Cell::Number(a)) if e.is_finite() && a.is_finite() => (e - a).abs(),
        (Cell::Number(e), Cell::Number(a)) if e.total_cmp(&a).is_eq() => 0.0,
        // The sign of a NaN depends on the processor.
        (Cell::Number(e), Cell::Number(a)) if e.is_nan() && a.is_nan() => 0.0,
        (Cell::Word(e), Cell::Word(a)) if e == a => 0.0,
        _ => f64::INFINITY,
    }
}

fn field(cell: Cell) -> String {
    match cell {
        Cell::Number(number) => format!("{number:?}"),
        Cell::Word(word) => word.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_tolerance_makes_a_word_a_number() {
        let column = |cell| {
            let mut column = TableColumn::new("a".into());
            column.push(cell);
            column
        };
        let compared = |actual| {
            let tolerance = Tolerance { rtol: f64::MAX, atol: f64::MAX };
            let pairing = Pairing::by_number(1, 1);
            let place = |_, _| [1, 1].map(|line| RowPlace { line, key: None }).into();
            let expected = column(Cell::Number(2.0));
            compare_column(&expected, &column(actual), tolerance, &pairing, place)
        };
        assert!(!compared(Cell::Number(1e300)).fails());
        assert!(compared(Cell::Word("two")).fails());
    }

    #[test]
    fn only_finite_numbers_have_a_distance() {
        let number = Cell::Number;
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        for same in [
            [number(nan), number(-nan)],
            [number(inf), number(inf)],
            [number(0.0), number(-0.0)],
            [Cell::Word(""), Cell::Word("")],
            [Cell::Word("root"), Cell::Word("root")],
        ] {
            assert!(difference(same[0], same[1]) == 0.0, "{same:?}");
        }
        for other in [
            [number(nan), number(0.0)],
            [number(inf), number(-inf)],
            [number(1e308), number(inf)],
            [Cell::Word(""), number(0.0)],
            [Cell::Word(""), number(nan)],
            [Cell::Word("root"), Cell::Word("Root")],
        ] {
            assert!(difference(other[0], other[1]).is_infinite(), "{other:?}");
            assert!(difference(other[1], other[0]).is_infinite(), "{other:?}");
        }
        assert!((difference(number(1.0), number(-2.5)) - 3.5).abs() < 1e-15);
    }
}
