//! Figures of a sweep: quantities over the varied values.

use super::axis::{Axis, in_unit, raised};
use super::colour_map::{ColourMap, Colours, Fields, Hatch};
use super::figure::{Curve, Figure, Figures, Stroke};
use super::swept_quantities::{Drawn, drawn_quantities};
use super::view::nearest;
use super::words::own;
use crate::compare::TableColumn;
use crate::result::StoredSweep;
use crate::text::given;

/// Largest number of lines in a figure; more cannot be distinguished.
const MOST_LINES: usize = 6;

/// Largest number of levels of a heat map with a tick for each.
const MOST_TICKS: usize = 12;

/// Ratio of the largest to the smallest value above which an axis is logarithmic.
const WIDE: f64 = 100.0;

/// Ratio above which an axis of values at equal factors is logarithmic, and the relative tolerance of these factors.
const WIDE_IN_STEPS: f64 = 2.0;
const SAME_STEP: f64 = 0.02;

/// A column of varied values with its name and unit.
pub(super) struct Named<'a> {
    pub(super) column: &'a TableColumn,
    name: String,
    unit: String,
}

impl<'a> Named<'a> {
    /// Columns of all varied values.
    pub(super) fn all(sweep: &'a StoredSweep) -> Vec<Self> {
        let columns = sweep.table.columns.iter().zip(&sweep.units);
        columns.map(|(column, unit)| Self::of(column, unit)).collect()
    }

    /// A heading may contain a unit: `segments.beam.I [cm^4]`. The numbers of others are in SI.
    fn of(column: &'a TableColumn, si: &str) -> Self {
        let given = column.name().strip_suffix(']').and_then(|heading| heading.split_once(" ["));
        let (name, unit) = given.unwrap_or((column.name(), si));
        Self { column, name: own(name), unit: own(raised(unit)) }
    }

    /// Name and unit: `payload.mass in kg`.
    pub(super) fn heading(&self) -> String {
        let is_text = self.column.number(0).is_nan();
        in_unit(&self.name, if is_text { "" } else { &self.unit })
    }

    /// A value of a case: `payload.mass = 0.05 kg`.
    pub(super) fn value_words(&self, row: usize) -> String {
        // A text contains its unit.
        let unit = if self.column.number(row).is_finite() { &self.unit[..] } else { "" };
        own(format!("{} = {} {unit}", self.name, self.column.text(row)).trim_end())
    }
}

/// The x or y of a figure: a varied value, or the number of a case.
struct Varied<'a> {
    /// `None` for the number of a case.
    named: Option<&'a Named<'a>>,
    /// One number per case.
    values: Vec<f64>,
    /// Distinct numbers, ascending.
    levels: Vec<f64>,
}

impl<'a> Varied<'a> {
    /// `None` without two numbers, and for texts.
    fn of(named: &'a Named<'a>, rows: usize) -> Option<Self> {
        let values: Vec<f64> = (0..rows).map(|row| named.column.number(row)).collect();
        let mut levels = values.clone();
        levels.sort_by(f64::total_cmp);
        levels.dedup_by(|a, b| a.total_cmp(b).is_eq());
        let all = levels.iter().all(|value| value.is_finite()) && levels.len() > 1;
        all.then_some(Self { named: Some(named), values, levels })
    }

    /// The numbers of the cases, from 1.
    fn case(rows: usize) -> Self {
        let values: Vec<f64> = (1..=rows).map(|row| row as f64).collect();
        Self { named: None, levels: values.clone(), values }
    }

    fn name(&self) -> &str {
        self.named.map_or("case", |own| &own.name)
    }

    /// Axis of the value; `margin` is relative to the range of its values.
    fn axis(&self, margin: f64) -> Axis {
        let (low, high) = (self.levels[0], self.levels[self.levels.len() - 1]);
        let unit = self.named.map_or("", |own| &own.unit);
        if self.is_wide() {
            let factor = libm::pow(high / low, margin);
            Axis::logarithmic(self.name(), unit, low / factor..high * factor)
        } else {
            let more = margin * (high - low);
            Axis::linear(self.name(), unit, low - more..high + more)
        }
    }

    /// True if the values span decades, or have equal factors between them.
    fn is_wide(&self) -> bool {
        let (low, high) = (self.levels[0], self.levels[self.levels.len() - 1]);
        let steps = self.levels.windows(2).map(|pair| pair[1] / pair[0]);
        let first = self.levels[1] / low;
        let is_even = steps.into_iter().all(|step| (step / first - 1.0).abs() < SAME_STEP);
        let is_stepped = self.levels.len() > 2 && high / low > WIDE_IN_STEPS && is_even;
        low > 0.0 && (high / low > WIDE || is_stepped) && self.named.is_some()
    }
}

/// Figures of a sweep.
pub(super) fn sweep_figures(sweep: &StoredSweep) -> Figures {
    let rows = sweep.table.lines.len();
    // Columns with several values: numbers for an axis, words for names of lines.
    let mut several = Named::all(sweep);
    several.retain(|own| (1..rows).any(|row| own.column.text(row) != own.column.text(0)));
    let mut varied: Vec<Varied> =
        several.iter().filter_map(|named| Varied::of(named, rows)).collect();
    let mut figures = Figures::default();
    if several.is_empty() {
        figures.omitted.push("figures, since no varied value takes two values or more".to_owned());
        return figures;
    }
    // The value with the most numbers becomes the axis; of equals the last, which varies fastest.
    varied.sort_by_key(|varied| varied.levels.len());
    let is_map = varied.len() == 2 && several.len() == 2;
    let (all, infeasible) = drawn_quantities(sweep, varied.len() < 2 && several.len() == 1);
    figures.omitted.extend(infeasible);
    for drawn in all {
        let why = "which exceeds its limit, since the table has no column of it";
        figures.add(match (&varied[..], several.len()) {
            _ if drawn.lines.is_empty() => Err(format!("{}, {why}", drawn.title)),
            ([one], 1) => Ok(over_one(&drawn, one)),
            ([other, one], 2) => Ok(over_two(&drawn, [one, other])),
            ([.., x], _) => Ok(over_many(&drawn, x, &several)),
            ([], _) => Ok(over_one(&drawn, &Varied::case(rows))),
        });
    }
    if figures.drawn.is_empty() && figures.omitted.is_empty() {
        figures.omitted.push("figures, since no case has a number".to_owned());
    }
    if is_map && figures.drawn.iter().any(|own| own.id == "peak-torque") {
        figures
            .omitted
            .push("the torque of the rigid link, since a map holds one quantity".to_owned());
    }
    figures
}

/// Name and points of a line.
type Line = (String, Vec<(f64, f64)>);

/// A figure of lines or dots, with the limit if there is one.
fn figure(drawn: &Drawn, x: &Varied, curves: Vec<Curve>, caption: String, colour: usize) -> Figure {
    let mut curves = curves;
    for curve in &mut curves {
        curve.points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    let (name, unit) = (&drawn.quantity.0, &drawn.quantity.1);
    let limit = (drawn.limit, 0.0);
    let beyond = Curve::add_limit(&mut curves, limit, ("", unit), colour);
    let caption = caption + &beyond;
    let (id, title) = (drawn.id.clone(), &drawn.title);
    Figure::of_curves(id, title, caption, x.axis(0.03), (name, unit), curves)
        .by(drawn.formula.clone())
}

/// A line for each column.
fn over_one(drawn: &Drawn, x: &Varied) -> Figure {
    let curve = |(k, (name, numbers)): (usize, &(String, Vec<f64>))| {
        let points = x.values.iter().copied().zip(numbers.iter().copied()).collect();
        Curve { name: name.clone(), stroke: Stroke::Dotted(1 + k % MOST_LINES), points }
    };
    let curves = drawn.lines.iter().enumerate().map(curve).collect();
    let of_case = if x.named.is_none() { " Over the number of the case." } else { "" };
    let colour = if drawn.lines.len() > 2 { MOST_LINES } else { 1 };
    figure(drawn, x, curves, drawn.caption.clone() + of_case, colour)
}

/// Columns and rows of a heat map: enough for fields of uneven width.
pub(super) const FINE: (usize, usize) = (480, 160);

/// A heat map of the first line; the field of a case extends half-way to its neighbours. Cases over the limit are
/// hatched.
fn over_two(drawn: &Drawn, [x, y]: [&Varied; 2]) -> Figure {
    let place = |varied: &Varied, case: usize| {
        varied.levels.iter().position(|level| level.total_cmp(&varied.values[case]).is_eq())
    };
    let mut cases = vec![vec![None; x.levels.len()]; y.levels.len()];
    for case in 0..x.values.len() {
        if let (Some(i), Some(j)) = (place(x, case), place(y, case)) {
            cases[j][i] = Some(case);
        }
    }
    let over_fields = |of: &dyn Fn(usize) -> f64| -> Vec<Vec<f64>> {
        let number = |case: &Option<usize>| case.map_or(f64::NAN, of);
        cases.iter().map(|row| row.iter().map(number).collect()).collect()
    };
    let values = over_fields(&|case| drawn.lines[0].1[case]);
    let (colours, coloured) = match &drawn.binding {
        Some((names, kinds)) => (Colours::Kinds(names.clone()), over_fields(&|case| kinds[case])),
        None => (Colours::Sequential, values.clone()),
    };
    let is_over = |case: &Option<usize>| case.is_some_and(|case| drawn.exceeded[case]);
    let hatch = drawn.exceeded.contains(&true).then(|| Hatch {
        name: drawn.over_words(),
        fields: cases.iter().map(|row| row.iter().map(is_over).collect()).collect(),
    });
    let (columns, rows) = (fields(x, FINE.0), fields(y, FINE.1));
    let row = |j: &usize| columns.iter().map(|i| coloured[*j][*i]).collect();
    let map = ColourMap {
        name: drawn.quantity.0.clone(),
        unit: drawn.quantity.1.clone(),
        colours,
        rows: rows.iter().map(row).collect(),
        fields: Some(Fields { places: [x.levels.clone(), y.levels.clone()], values, hatch }),
    };
    let title = format!("{}, over two values", drawn.title);
    let hatched = match drawn.limit {
        Some(limit) if !drawn.exceeded.contains(&true) && drawn.binding.is_none() => {
            let limit = format!("{} {}", given(limit), drawn.quantity.1);
            let case = if drawn.failed > 0 { "solved case" } else { "case" };
            format!(" No {case} exceeds the limit of {}.", limit.trim_end())
        }
        _ => String::new(),
    };
    let range = if drawn.binding.is_some() { String::new() } else { map.range_words() };
    let failed = if drawn.failed > 0 { ", or where it failed" } else { "" };
    let caption = format!(
        "{} Each field is a case; empty where there is none{failed}.{range}{hatched}",
        drawn.caption
    );
    let figure = Figure::new(drawn.id.clone(), &title, caption, field_axis(x), field_axis(y));
    Figure { map: Some(map), ..figure }.by(drawn.formula.clone())
}

/// Axis of a heat map, which extends half a field beyond the first and the last level.
fn field_axis(varied: &Varied) -> Axis {
    let axis = varied.axis(0.5 / (varied.levels.len() - 1) as f64);
    let places = if varied.levels.len() <= MOST_TICKS { varied.levels.clone() } else { vec![] };
    Axis { places, ..axis }
}

/// Number of the level nearest to each of `count` even places along the axis of a heat map.
fn fields(varied: &Varied, count: usize) -> Vec<usize> {
    let axis = field_axis(varied);
    let levels: Vec<f64> = varied.levels.iter().map(|level| axis.share(*level)).collect();
    (0..count).map(|k| nearest(&levels, (k as f64 + 0.5) / count as f64)).collect()
}

/// The first line of a quantity: a line for each combination of the other values, or a dot for each case if the lines
/// are too many.
fn over_many(drawn: &Drawn, x: &Varied, several: &[Named]) -> Figure {
    let numbers = &drawn.lines[0].1;
    let name = |row: usize| {
        let is_other = |other: &&Named| x.named.is_none_or(|own| !std::ptr::eq(*other, own));
        let others = several.iter().filter(is_other);
        others.map(|other| other.value_words(row)).collect::<Vec<_>>().join(", ")
    };
    let mut lines: Vec<Line> = Vec::new();
    for (row, point) in x.values.iter().copied().zip(numbers.iter().copied()).enumerate() {
        let name = name(row);
        match lines.iter_mut().find(|(other, _)| *other == name) {
            Some((_, points)) => points.push(point),
            None => lines.push((name, vec![point])),
        }
    }
    if lines.len() <= MOST_LINES {
        let curve = |(k, (name, points)): (usize, Line)| Curve {
            name,
            stroke: Stroke::Dotted(k + 1),
            points,
        };
        let curves = lines.into_iter().enumerate().map(curve).collect();
        return figure(drawn, x, curves, drawn.caption.clone(), MOST_LINES);
    }
    let dots = |is_over: bool, name: String, colour: usize| {
        let rows = (0..x.values.len()).filter(|row| drawn.exceeded[*row] == is_over);
        let points: Vec<_> = rows.map(|row| (x.values[row], numbers[row])).collect();
        let is_there = points.iter().any(|(_, number)| number.is_finite());
        is_there.then_some(Curve { name, stroke: Stroke::Points(colour), points })
    };
    let has_limit = drawn.limit.is_some() || drawn.exceeded.contains(&true);
    let within = if has_limit { "within the limit" } else { "cases" };
    let curves = [dots(false, within.to_owned(), 1), dots(true, drawn.over_words(), 2)];
    let caption = format!(
        "{} A dot for each case: {} lines of the other values are more than a figure holds.",
        drawn.caption,
        lines.len()
    );
    figure(drawn, x, curves.into_iter().flatten().collect(), caption, MOST_LINES)
}
