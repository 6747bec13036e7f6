use super::super::chart::{Across, Axis, ColourMap, Colours, Curve, Figure, Stroke};
use super::super::figures::Figures;
use super::topics::{TOPICS, Topic};
use crate::compare::{Cell, TableColumn};
use crate::result::StoredSweep;

/// Lines of a figure at most; more could not be told from each other.
const MOST_LINES: usize = 6;

/// Levels of a heat map at most that are all written beside it.
const MOST_TICKS: usize = 12;

/// From this ratio on values above 0 are drawn by their logarithm.
const WIDE: f64 = 12.0;

/// A value that was varied: its heading and one number a case.
struct Varied<'a> {
    name: &'a str,
    values: Vec<f64>,
    /// The numbers that occur, ascending.
    levels: Vec<f64>,
}

impl<'a> Varied<'a> {
    fn of(column: &'a TableColumn, rows: usize) -> Option<Self> {
        let values: Vec<f64> = (0..rows).map(|row| number(column, row)).collect();
        let mut levels = values.clone();
        levels.sort_by(f64::total_cmp);
        levels.dedup_by(|a, b| a.total_cmp(b).is_eq());
        let all = levels.iter().all(|value| value.is_finite()) && levels.len() > 1;
        all.then(|| Self { name: column.name(), values, levels })
    }

    /// Its axis; `margin` in shares of the whole.
    fn axis(&self, margin: f64) -> Axis {
        let (low, high) = (self.levels[0], self.levels[self.levels.len() - 1]);
        if low > 0.0 && high / low > WIDE {
            let factor = libm::pow(high / low, margin);
            Axis::logarithmic(self.name, "", low / factor..high * factor)
        } else {
            let more = margin * (high - low);
            Axis::linear(self.name, "", low - more..high + more)
        }
    }
}

fn number(column: &TableColumn, row: usize) -> f64 {
    match column.cell(row) {
        Cell::Number(number) => number,
        Cell::Word(_) => f64::NAN,
    }
}

/// Figures of a sweep, and what could not be shown and why.
pub(in crate::report) fn sweep_figures(sweep: &StoredSweep) -> Figures {
    let rows = sweep.table.lines.len();
    let columns = &sweep.table.columns[..sweep.varied];
    // What has several values, numbers to draw over and words to tell lines apart.
    let several: Vec<&TableColumn> = columns
        .iter()
        .filter(|column| (1..rows).any(|row| text(column, row) != text(column, 0)))
        .collect();
    let mut varied: Vec<Varied> =
        several.iter().filter_map(|column| Varied::of(column, rows)).collect();
    let mut figures = Figures::default();
    if varied.is_empty() {
        figures.omitted.push("figures, since no varied value takes two numbers or more".to_owned());
        return figures;
    }
    // The value with most numbers has the axis; of equals the last one, which runs fastest.
    varied.sort_by_key(|varied| varied.levels.len());
    for topic in &TOPICS {
        let found: Vec<(&str, &TableColumn)> = topic
            .columns
            .iter()
            .filter_map(|(column, name)| Some((*name, sweep.table.column(column)?)))
            .filter(|(_, column)| (0..rows).any(|row| number(column, row).is_finite()))
            .collect();
        let [(_, first), ..] = found[..] else { continue };
        match (&varied[..], several.len()) {
            ([one], 1) => figures.add(Ok(over_one(topic, one, &found))),
            ([other, one], 2) => figures.add(Ok(over_two(topic, [one, other], first))),
            ([.., x], _) => figures.add(over_many(topic, x, &several, first)),
            ([], _) => {}
        }
    }
    if figures.drawn.is_empty() && figures.omitted.is_empty() {
        figures.omitted.push("figures, since no case has a number".to_owned());
    }
    figures
}

/// What stands in a row.
fn text(column: &TableColumn, row: usize) -> String {
    match column.cell(row) {
        Cell::Number(number) => number.to_string(),
        Cell::Word(word) => word.to_owned(),
    }
}

fn figure(topic: &Topic, x: Axis, curves: Vec<Curve>) -> Figure {
    let values = curves.iter().flat_map(|curve| curve.points.iter().map(|(_, value)| value));
    let y = Axis::around(topic.quantity.0, topic.quantity.1, values);
    let base = Figure::new(topic.id, topic.title, Across::Other, x, y);
    Figure { caption: topic.caption.to_owned(), curves, ..base }
}

fn over_one(topic: &Topic, x: &Varied, columns: &[(&str, &TableColumn)]) -> Figure {
    let curve = |(k, (name, column)): (usize, &(&str, &TableColumn))| {
        let rows = 0..x.values.len();
        line(name, k, rows.map(|row| (x.values[row], number(column, row))).collect())
    };
    figure(topic, x.axis(0.03), columns.iter().enumerate().map(curve).collect())
}

fn line(name: &str, number: usize, mut points: Vec<(f64, f64)>) -> Curve {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    Curve { name: name.to_owned(), stroke: Stroke::Dotted(number + 1), points }
}

/// Pixels of a heat map across and up: enough for the borders of fields of any width.
const FINE: (usize, usize) = (480, 160);

/// A heat map; each case is a field that reaches half way to its neighbours.
fn over_two(topic: &Topic, [x, y]: [&Varied; 2], column: &TableColumn) -> Figure {
    let place = |varied: &Varied, case: usize| {
        varied.levels.iter().position(|level| level.total_cmp(&varied.values[case]).is_eq())
    };
    let mut found = vec![vec![f64::NAN; x.levels.len()]; y.levels.len()];
    for case in 0..x.values.len() {
        if let (Some(i), Some(j)) = (place(x, case), place(y, case)) {
            found[j][i] = number(column, case);
        }
    }
    let (columns, rows) = (fields(x, FINE.0), fields(y, FINE.1));
    let row = |j: &usize| columns.iter().map(|i| found[*j][*i]).collect();
    let map = ColourMap {
        name: topic.quantity.0.to_owned(),
        unit: topic.quantity.1.to_owned(),
        colours: Colours::Sequential,
        rows: rows.iter().map(row).collect(),
    };
    let title = format!("{}, over two values", topic.title);
    let base = Figure::new(topic.id, &title, Across::Other, field_axis(x), field_axis(y));
    let caption = format!("{} Each field is a case; white where there is none.", topic.caption);
    Figure { caption, map: Some(map), ..base }
}

/// The axis of a heat map: it reaches half a field beyond the first and the last level.
fn field_axis(varied: &Varied) -> Axis {
    let axis = varied.axis(0.5 / (varied.levels.len() - 1) as f64);
    let places = if varied.levels.len() <= MOST_TICKS { varied.levels.clone() } else { vec![] };
    Axis { places, ..axis }
}

/// Number of the level nearest to each of `count` even places along the axis of a heat map.
fn fields(varied: &Varied, count: usize) -> Vec<usize> {
    let axis = field_axis(varied);
    let levels: Vec<f64> = varied.levels.iter().map(|level| axis.share(*level)).collect();
    let nearest = |k: usize| {
        let at = (k as f64 + 0.5) / count as f64;
        let next = levels.partition_point(|level| *level < at).clamp(1, levels.len() - 1);
        if at - levels[next - 1] < levels[next] - at { next - 1 } else { next }
    };
    (0..count).map(nearest).collect()
}

/// A line for each combination of the other values.
fn over_many(
    topic: &Topic,
    x: &Varied,
    several: &[&TableColumn],
    column: &TableColumn,
) -> Result<Figure, String> {
    let name = |row: usize| {
        let others = several.iter().filter(|other| other.name() != x.name);
        let value = |other: &&TableColumn| format!("{} = {}", other.name(), text(other, row));
        others.map(value).collect::<Vec<_>>().join(", ")
    };
    let mut lines: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
    for row in 0..x.values.len() {
        let (name, point) = (name(row), (x.values[row], number(column, row)));
        match lines.iter_mut().find(|(other, _)| *other == name) {
            Some((_, points)) => points.push(point),
            None => lines.push((name, vec![point])),
        }
    }
    if lines.len() > MOST_LINES {
        return Err(format!(
            "{}, since {} lines over {} are more than a figure holds: sweep fewer values at a time",
            topic.title,
            lines.len(),
            x.name
        ));
    }
    let curves = lines.into_iter().enumerate().map(|(k, (name, points))| line(&name, k, points));
    Ok(figure(topic, x.axis(0.03), curves.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::Table;

    /// A sweep whose columns after the varied ones are the ratio and its cases' order.
    fn sweep(varied: &[(&str, &[f64])], ratios: &[f64]) -> StoredSweep {
        let named = varied.iter().copied().chain([("torque_ratio", ratios)]);
        let columns = named.map(|(name, values)| {
            let mut column = TableColumn::new(name.to_owned());
            for value in values {
                let cell = if value.is_nan() { Cell::Word("") } else { Cell::Number(*value) };
                column.push(cell);
            }
            column
        });
        let table =
            Table { columns: columns.collect(), lines: (2..2 + ratios.len() as u64).collect() };
        StoredSweep { name: "sweep.csv".to_owned(), origin: None, varied: varied.len(), table }
    }

    #[test]
    fn fields_reach_half_way_to_their_neighbours() {
        let sweep = sweep(
            &[("a", &[1.0, 2.0, 4.0, 1.0, 2.0, 4.0]), ("b", &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0])],
            &[0.1, 0.2, 0.3, 0.4, f64::NAN, 0.6],
        );
        let figures = sweep_figures(&sweep);
        assert_eq!((figures.drawn.len(), figures.omitted.len()), (1, 0));
        let figure = &figures.drawn[0];
        let map = figure.map.as_ref().unwrap();
        let place = |share: f64, count: usize| {
            (0..count).find(|k| (*k + 1) as f64 > share * count as f64).unwrap()
        };
        let at = |a: f64, b: f64| {
            let column = place(figure.x.share(a), FINE.0);
            map.rows[place(figure.y.share(b), FINE.1)][column]
        };
        for (a, b, expected) in
            [(1.0, 0.0, 0.1), (1.4, 0.45, 0.1), (1.6, 0.0, 0.2), (3.1, 0.55, 0.6)]
        {
            assert!((at(a, b) - expected).abs() < 1e-15, "{a}, {b}: {}", at(a, b));
        }
        assert!(at(2.0, 1.0).is_nan(), "a case without a number");
        assert_eq!(figure.x.places, [1.0, 2.0, 4.0]);
    }

    #[test]
    fn what_cannot_be_drawn_is_told() {
        let one = sweep(&[("a", &[1.0])], &[0.5]);
        let figures = sweep_figures(&one);
        assert!(figures.drawn.is_empty());
        assert!(figures.omitted[0].contains("two numbers or more"), "{:?}", figures.omitted);
        let failed = sweep(&[("a", &[1.0, 2.0])], &[f64::NAN, f64::NAN]);
        assert!(sweep_figures(&failed).omitted[0].contains("no case has a number"));
        let many: Vec<f64> = (0..14).map(f64::from).collect();
        let last: Vec<f64> = (0..14).map(|k| f64::from(k % 2)).collect();
        let more: Vec<f64> = (0..14).map(|k| f64::from(k / 2)).collect();
        let crowd = sweep(&[("a", &many), ("b", &more), ("c", &last)], &[0.5; 14]);
        let figures = sweep_figures(&crowd);
        assert!(figures.omitted[0].contains("more than a figure holds"), "{:?}", figures.omitted);
    }

    #[test]
    fn words_part_lines_and_the_value_with_most_numbers_has_the_axis() {
        let mut table = sweep(
            &[("a", &[1.0, 2.0, 3.0, 1.0, 2.0, 3.0]), ("law", &[f64::NAN; 6])],
            &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
        );
        let mut law = TableColumn::new("law".to_owned());
        for word in ["none", "none", "none", "modal", "modal", "modal"] {
            law.push(Cell::Word(word));
        }
        table.table.columns[1] = law;
        let figure = &sweep_figures(&table).drawn[0];
        assert_eq!(figure.x.name, "a");
        let names: Vec<&str> = figure.curves.iter().map(|curve| curve.name.as_str()).collect();
        assert_eq!(names, ["law = none", "law = modal"]);
        assert_eq!(figure.curves[1].points, [(1.0, 0.4), (2.0, 0.5), (3.0, 0.6)]);
    }
}
