use super::axis::Axis;
use super::colour_map::ColourMap;
use crate::numeric::significant;

/// A figure: what is drawn, in numbers; [`Figure::svg`] draws it.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Name of its file, and its anchor in a page: `torque`.
    pub id: String,
    /// Heading.
    pub title: String,
    /// What it shows, and what to see in it.
    pub caption: String,
    /// To the right.
    pub x: Axis,
    /// Upward.
    pub y: Axis,
    /// What x counts: figures over time are looked at together.
    pub across: Across,
    /// Stretches of x that are shaded.
    pub spans: Vec<Span>,
    /// An area behind all lines, from 0 to 1 of the height, with its name.
    pub backdrop: Option<Curve>,
    /// Colours behind all lines.
    pub map: Option<ColourMap>,
    /// A line over the upper part of the colours, with the axis that it has for itself.
    pub strip: Option<(Curve, Axis)>,
    /// Lines.
    pub curves: Vec<Curve>,
    /// Places of x with a name.
    pub marks: Vec<Mark>,
}

/// What the x axis of a figure counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Across {
    /// Time, the same in all figures of a page.
    Time,
    /// Something of its own.
    Other,
}

/// How a curve is drawn; colours go by number, so that all figures agree on them.
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
    /// What it is, for the legend.
    pub name: String,
    /// How it is drawn.
    pub stroke: Stroke,
    /// Points (x, y); one that is not finite parts the line.
    pub points: Vec<(f64, f64)>,
}

impl Curve {
    /// A line through the values at some places.
    pub fn new(name: &str, stroke: Stroke, x: &[f64], y: &[f64]) -> Self {
        let points = x.iter().copied().zip(y.iter().copied()).collect();
        Self { name: name.to_owned(), stroke, points }
    }
}

/// A shaded stretch.
#[derive(Debug, Clone, PartialEq)]
pub struct Span {
    /// What it is, for the legend.
    pub name: String,
    /// Its class in the style sheet: `lead` or `lag`.
    pub class: &'static str,
    /// From where to where.
    pub range: std::ops::Range<f64>,
}

/// A place of x with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Where it is.
    pub at: f64,
    /// What it is: `f1`.
    pub label: String,
    /// Its class in the style sheet.
    pub class: &'static str,
}

/// Figures of a result, and what could not be shown and why.
#[derive(Debug, Clone, Default)]
pub struct Figures {
    /// In the order of a page.
    pub drawn: Vec<Figure>,
    /// What is missing: `waves, since no nodal displacements were written`.
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

    /// A figure of nothing yet.
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
