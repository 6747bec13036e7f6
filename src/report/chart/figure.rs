use super::axis::Axis;
use super::colour_map::ColourMap;

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
