//! The content of a figure in numbers, as a table, and as a file of its own.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use maud::{PreEscaped, html};
use resvg::{tiny_skia, usvg};

use super::axis::{Axis, in_unit};
use super::colour_map::ColourMap;
use crate::text::{significant, visible_document};

/// The content of a figure in numbers; [`Figure::svg_file`] and [`Figure::png_file`] draw it.
#[derive(Debug, Clone, Default)]
pub struct Figure {
    /// Name of its file, and its anchor in a page: `torque`.
    pub id: Cow<'static, str>,
    /// Heading.
    pub(super) title: String,
    /// Text below the figure.
    pub(super) caption: String,
    pub(super) x: Axis,
    pub(super) y: Axis,
    /// Shaded ranges of x.
    pub(super) spans: Vec<Span>,
    /// An area behind all lines, from 0 to 1 of the height, with its name.
    pub(super) backdrop: Option<Curve>,
    /// Colours behind all lines.
    pub(super) map: Option<ColourMap>,
    /// A line above the colours, with its own y axis.
    pub(super) strip: Option<(Curve, Axis)>,
    /// Lines.
    pub(super) curves: Vec<Curve>,
    /// Named values of x.
    pub(super) marks: Vec<Mark>,
}

/// How a curve is drawn, with the number of its colour in the style sheet, 1 to 6.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stroke {
    Solid(usize),
    Dashed(usize),
    /// A line with a dot at each point.
    Dotted(usize),
    /// A dot at each point, without a line.
    Points(usize),
    /// Pieces of a line that are no values: uncertainties.
    Bars(usize),
}

impl Stroke {
    /// Its classes in the style sheet.
    pub(super) fn classes(self) -> String {
        match self {
            Self::Solid(colour) | Self::Dotted(colour) => format!("line s{colour}"),
            Self::Dashed(colour) => format!("line s{colour} dashed"),
            Self::Points(colour) => format!("line s{colour} points"),
            Self::Bars(colour) => format!("bars s{colour}"),
        }
    }
}

/// A line of a figure.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve {
    /// Name in the legend.
    pub(super) name: String,
    pub(super) stroke: Stroke,
    /// Points (x, y); one that is not finite interrupts the line.
    pub(super) points: Vec<(f64, f64)>,
}

impl Curve {
    /// A line through the points (x, y).
    pub(super) fn new(name: &str, stroke: Stroke, x: &[f64], y: &[f64]) -> Self {
        let points = x.iter().copied().zip(y.iter().copied()).collect();
        Self { name: name.to_owned(), stroke, points }
    }

    /// Value of the point nearest to an x; none beyond the line's ends.
    fn value_at(&self, at: f64) -> Option<f64> {
        let points = &self.points;
        let inside = points.first()?.0 <= at && at <= points.last()?.0;
        let next = points.partition_point(|(x, _)| *x < at).min(points.len() - 1);
        let before = next.saturating_sub(1);
        let nearest = if at - points[before].0 < points[next].0 - at { before } else { next };
        inside.then_some(points[nearest].1)
    }
}

/// A shaded range of x.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Span {
    /// Name in the legend, and its class in the style sheet: `lead` or `lag`.
    pub(super) name: &'static str,
    pub(super) range: Range<f64>,
}

/// A named value of x.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mark {
    pub(super) at: f64,
    /// Its name: `f1`.
    pub(super) label: String,
    /// Its class in the style sheet.
    pub(super) class: &'static str,
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
    pub(super) fn add(&mut self, figure: Result<Figure, String>) {
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

/// Most rows of the table below a figure.
const ROWS: usize = 16;

/// Rows of a map that its table shows.
const MAP_ROWS: usize = 5;

/// Digits of the table's numbers.
const DIGITS: usize = 4;

impl Figure {
    /// A figure without content.
    pub(super) fn new(
        id: impl Into<Cow<'static, str>>,
        title: &str,
        caption: String,
        x: Axis,
        y: Axis,
    ) -> Self {
        Self { id: id.into(), title: title.to_owned(), caption, x, y, ..Self::default() }
    }

    /// A figure of lines, with a y axis of this name and unit that holds them.
    pub(super) fn of_curves(
        id: impl Into<Cow<'static, str>>,
        title: &str,
        caption: String,
        x: Axis,
        (name, unit): (&str, &str),
        curves: Vec<Curve>,
    ) -> Self {
        let values = curves.iter().flat_map(|curve| curve.points.iter().map(|(_, value)| value));
        let y = Axis::around(name, unit, values);
        Self { curves, ..Self::new(id, title, caption, x, y) }
    }

    /// True if its numbers are too large or too small to be drawn.
    fn is_extreme(&self) -> bool {
        let strip = self.strip.as_ref().map(|(_, axis)| axis);
        let is_map = self.map.as_ref().is_some_and(ColourMap::is_extreme);
        is_map || [&self.x, &self.y].into_iter().chain(strip).any(Axis::is_extreme)
    }

    /// Headings and rows of a table: some values of x at even distances, and the value of each line
    /// there, or of some rows of the map.
    pub(super) fn table(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let (mut lines, unit) = match &self.map {
            Some(map) if self.curves.is_empty() => (self.map_lines(map), ""),
            _ => (self.curves.clone(), self.y.unit.as_str()),
        };
        lines.retain(|line| !matches!(line.stroke, Stroke::Bars(_)));
        let Some(first) = lines.first() else { return (vec![], vec![]) };
        let text = |value: f64| {
            let digits = value.is_finite().then(|| significant(value, DIGITS).replace('-', "−"));
            digits.unwrap_or_default()
        };
        let mut head = vec![self.x.title()];
        head.extend(lines.iter().map(|line| in_unit(&line.name, unit)));
        let row = |k: usize| {
            let at = first.points[k].0;
            let values = lines.iter().map(|line| line.value_at(at).map_or(String::new(), text));
            std::iter::once(text(at)).chain(values).collect()
        };
        (head, evenly(first.points.len(), ROWS).into_iter().map(row).collect())
    }

    /// Some rows of a map as lines.
    fn map_lines(&self, map: &ColourMap) -> Vec<Curve> {
        let place = |range: &Range<f64>, k: usize, len: usize| {
            range.start + (range.end - range.start) * (k as f64 + 0.5) / len as f64
        };
        let line = |row: usize| {
            let at = significant(place(&self.y.range, row, map.rows.len()), 3);
            let values = &map.rows[row];
            let x = (0..values.len()).map(|k| place(&self.x.range, k, values.len()));
            Curve {
                name: format!(
                    "{} at {} = {at} {} in {}",
                    map.name, self.y.name, self.y.unit, map.unit
                ),
                stroke: Stroke::Solid(1),
                points: x.zip(values.iter().copied()).collect(),
            }
        };
        evenly(map.rows.len(), MAP_ROWS).into_iter().map(line).collect()
    }
}

/// At most `most` of `len` numbers, evenly, the first and the last among them.
pub(super) fn evenly(len: usize, most: usize) -> Vec<usize> {
    let count = len.min(most);
    (0..count).map(|k| if count < 2 { 0 } else { k * (len - 1) / (count - 1) }).collect()
}

/// Style sheet of a figure in a file of its own: the light colours of the page.
const STYLE: &str = include_str!("figure.css");

/// Font of the pictures, so that they are the same on every machine.
const FONT: &[u8] = include_bytes!("font/DejaVuSans.ttf");

/// Pixels of a picture per unit of the drawing.
const SCALE: f32 = 2.0;

impl Figure {
    /// The figure as a file of its own.
    pub fn svg_file(&self) -> String {
        let drawing = self.svg().into_string();
        let head_len = drawing.find('>').map_or(0, |at| at + 1);
        let (head, rest) = drawing.split_at(head_len);
        let style = html! {
            title { (self.title) }
            desc { (self.caption) }
            style { (PreEscaped(STYLE)) }
            rect width="100%" height="100%" fill="#ffffff" {}
        };
        visible_document(&format!("{head}{}{rest}\n", style.into_string()))
    }

    /// The figure as a PNG file, two pixels per unit of the drawing, on white.
    ///
    /// # Errors
    /// The renderer's message if the drawing is too large for it.
    pub fn png_file(&self) -> Result<Vec<u8>, String> {
        let mut fonts = usvg::fontdb::Database::new();
        fonts.load_font_data(FONT.to_vec());
        let options = usvg::Options {
            fontdb: Arc::new(fonts),
            font_family: "DejaVu Sans".to_owned(),
            ..usvg::Options::default()
        };
        let tree = usvg::Tree::from_str(&self.svg_file(), &options).map_err(|e| e.to_string())?;
        let size = tree.size().to_int_size().scale_by(SCALE).ok_or("its size is none")?;
        let mut pixels =
            tiny_skia::Pixmap::new(size.width(), size.height()).ok_or("its size is none")?;
        let transform = tiny_skia::Transform::from_scale(SCALE, SCALE);
        resvg::render(&tree, transform, &mut pixels.as_mut());
        pixels.encode_png().map_err(|error| error.to_string())
    }
}
