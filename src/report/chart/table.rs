use super::figure::{Curve, Figure};
use crate::numeric::significant;

/// Rows of the table beside a figure, about.
const ROWS: usize = 16;

/// Digits of its numbers.
const DIGITS: usize = 4;

/// The numbers of a figure as a table: some places, and what each line has there.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureTable {
    /// Headings.
    pub head: Vec<String>,
    /// Rows of texts.
    pub rows: Vec<Vec<String>>,
}

impl Figure {
    /// Some of the figure's numbers, evenly over its first line or its map.
    pub fn table(&self) -> FigureTable {
        if let (Some(map), None) = (&self.map, self.curves.first()) {
            return self.map_table(&map.rows, &map.name, &map.unit);
        }
        let Some(first) = self.curves.first() else {
            return FigureTable { head: vec![], rows: vec![] };
        };
        let head = self.curves.iter().map(|curve| heading(&curve.name, &self.y.unit));
        let places = evenly(first.points.len(), ROWS).into_iter().map(|k| first.points[k].0);
        let row = |at: f64| {
            let values =
                self.curves.iter().map(|curve| value_at(curve, at).map_or(String::new(), text));
            std::iter::once(text(at)).chain(values).collect()
        };
        FigureTable {
            head: std::iter::once(heading(&self.x.name, &self.x.unit)).chain(head).collect(),
            rows: places.map(row).collect(),
        }
    }

    fn map_table(&self, rows: &[Vec<f64>], name: &str, unit: &str) -> FigureTable {
        let columns = rows.first().map_or(0, Vec::len);
        let place = |range: &std::ops::Range<f64>, k: usize, len: usize| {
            range.start + (range.end - range.start) * (k as f64 + 0.5) / len as f64
        };
        let shown = evenly(rows.len(), 5);
        let head = shown.iter().map(|k| {
            let at = significant(place(&self.y.range, *k, rows.len()), 3);
            format!("{name} at {} = {at} {} in {unit}", self.y.name, self.y.unit)
        });
        let row = |k: usize| {
            let values = shown.iter().map(|row| text(rows[*row][k]));
            std::iter::once(text(place(&self.x.range, k, columns))).chain(values).collect()
        };
        FigureTable {
            head: std::iter::once(heading(&self.x.name, &self.x.unit)).chain(head).collect(),
            rows: evenly(columns, ROWS).into_iter().map(row).collect(),
        }
    }
}

fn heading(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} in {unit}") }
}

fn text(value: f64) -> String {
    if value.is_finite() { significant(value, DIGITS).replace('-', "−") } else { String::new() }
}

/// The value of the point nearest to a place; none beyond the line's ends.
fn value_at(curve: &Curve, at: f64) -> Option<f64> {
    let inside = curve.points.first()?.0 <= at && at <= curve.points.last()?.0;
    let next = curve.points.partition_point(|(x, _)| *x < at).min(curve.points.len() - 1);
    let before = next.saturating_sub(1);
    let nearest =
        if at - curve.points[before].0 < curve.points[next].0 - at { before } else { next };
    inside.then_some(curve.points[nearest].1)
}

/// At most `most` of `len` numbers, evenly, the first and the last among them.
pub(in crate::report) fn evenly(len: usize, most: usize) -> Vec<usize> {
    let count = len.min(most);
    (0..count).map(|k| if count < 2 { 0 } else { k * (len - 1) / (count - 1) }).collect()
}
