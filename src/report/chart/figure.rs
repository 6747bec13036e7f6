use super::axis::Axis;
use super::colour_map::ColourMap;
use crate::numeric::significant;

/// The content of a figure in numbers; [`Figure::svg`] draws it.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Name of its file, and its anchor in a page: `torque`.
    pub id: String,
    /// Heading.
    pub title: String,
    /// Text below the figure.
    pub caption: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Quantity of x; the page zooms all figures over time together.
    pub across: Across,
    /// Shaded ranges of x.
    pub spans: Vec<Span>,
    /// An area behind all lines, from 0 to 1 of the height, with its name.
    pub backdrop: Option<Curve>,
    /// Colours behind all lines.
    pub map: Option<ColourMap>,
    /// A line above the colours, with its own y axis.
    pub strip: Option<(Curve, Axis)>,
    /// Lines.
    pub curves: Vec<Curve>,
    /// Named values of x.
    pub marks: Vec<Mark>,
}

/// Quantity of a figure's x axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Across {
    /// Time, the same in all figures of a page.
    Time,
    /// Any other quantity.
    Other,
}

/// How a curve is drawn, with the number of its colour in the style sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// A line of a colour, 1 to 6.
    Solid(usize),
    /// A dashed line of a colour.
    Dashed(usize),
    /// A line with a dot at each point.
    Dotted(usize),
}

impl Stroke {
    /// Number of its colour.
    pub(super) fn colour(self) -> usize {
        match self {
            Self::Solid(colour) | Self::Dashed(colour) | Self::Dotted(colour) => colour,
        }
    }

    /// Its classes in the style sheet.
    pub(super) fn classes(self) -> String {
        let dashes = if let Self::Dashed(_) = self { " dashed" } else { "" };
        format!("line s{}{dashes}", self.colour())
    }
}

/// A line of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name in the legend.
    pub name: String,
    /// How it is drawn.
    pub stroke: Stroke,
    /// Points (x, y); one that is not finite interrupts the line.
    pub points: Vec<(f64, f64)>,
}

impl Curve {
    /// A line through the points (x, y).
    pub fn new(name: &str, stroke: Stroke, x: &[f64], y: &[f64]) -> Self {
        let points = x.iter().copied().zip(y.iter().copied()).collect();
        Self { name: name.to_owned(), stroke, points }
    }
}

/// A shaded range of x.
#[derive(Debug, Clone, PartialEq)]
pub struct Span {
    /// Name in the legend.
    pub name: String,
    /// Its class in the style sheet: `lead` or `lag`.
    pub class: &'static str,
    /// The range.
    pub range: std::ops::Range<f64>,
}

/// A named value of x.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// The value.
    pub at: f64,
    /// Its name: `f1`.
    pub label: String,
    /// Its class in the style sheet.
    pub class: &'static str,
}

/// Figures of a result.
#[derive(Debug, Clone, Default)]
pub struct Figures {
    /// In the order of a page.
    pub drawn: Vec<Figure>,
    /// What is missing and why: `waves, since no nodal displacements were written`.
    pub omitted: Vec<String>,
}

impl Figures {
    pub(in crate::report) fn add(&mut self, figure: Result<Figure, String>) {
        match figure {
            Ok(figure) if figure.is_extreme() => {
                let why = "since its numbers are too large or too small to be drawn";
                self.omitted.push(format!("{}, {why}", figure.title));
            }
            Ok(figure) => self.drawn.push(figure),
            Err(why) => self.omitted.push(why),
        }
    }
}

impl Figure {
    /// Whether its numbers are too large or too small to be drawn.
    pub(in crate::report) fn is_extreme(&self) -> bool {
        let strip = self.strip.as_ref().map(|(_, axis)| axis);
        let is_map = self.map.as_ref().is_some_and(ColourMap::is_extreme);
        is_map || [&self.x, &self.y].into_iter().chain(strip).any(Axis::is_extreme)
    }

    /// A figure without content.
    pub fn new(id: &str, title: &str, across: Across, x: Axis, y: Axis) -> Self {
        Self {
            id: id.to_owned(),
            title: title.to_owned(),
            caption: String::new(),
            x,
            y,
            across,
            spans: Vec::new(),
            backdrop: None,
            map: None,
            strip: None,
            curves: Vec::new(),
            marks: Vec::new(),
        }
    }
}

/// Most rows of the table below a figure.
const ROWS: usize = 16;

/// Digits of its numbers.
const DIGITS: usize = 4;

/// Numbers of a figure as a table: some values of x, and the value of each line there.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureTable {
    /// Headings.
    pub head: Vec<String>,
    /// Rows of texts.
    pub rows: Vec<Vec<String>>,
}

impl Figure {
    /// Numbers at even distances along the first line or the map.
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

/// Value of the point nearest to an x; none beyond the line's ends.
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
