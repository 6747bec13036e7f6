//! A figure in numbers, its table, and its files.

use std::borrow::Cow;
use std::ops::Range;

use super::axis::{Axis, digits, drawn_points, in_unit};
use super::colour_map::{ColourMap, Fields};
use crate::link::Link;
use crate::text::{given, significant};

/// Content of a figure in numbers; [`Figures::svg_file`] and [`Figures::png_file`] draw it.
#[derive(Debug, Clone, Default)]
pub struct Figure {
    /// Name of the file, and anchor in a page: `torque`.
    pub id: Cow<'static, str>,
    /// Heading.
    pub(super) title: String,
    /// Sentences below the figure.
    pub(super) caption: String,
    /// Formula of the quantities in the figure.
    pub(super) formula: Cow<'static, str>,
    pub(super) x: Axis,
    pub(super) y: Axis,
    /// Shaded ranges of x, such as the lead of a torque.
    pub(super) spans: Vec<Span>,
    /// A named area behind all lines; its values, from 0 to 1, are shares of the figure's height.
    pub(super) backdrop: Option<Curve>,
    /// Colour map behind all lines.
    pub(super) map: Option<ColourMap>,
    /// A line above the colour map, with a y axis of its quantity.
    pub(super) strip: Option<(Curve, Axis)>,
    /// Lines, drawn in this order.
    pub(super) curves: Vec<Curve>,
    /// Named values of x.
    pub(super) marks: Vec<Mark>,
}

/// Drawing style of a curve, with the number of its colour in the style sheet, 1 to 6.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stroke {
    Solid(usize),
    /// A thin line that leaves the dots below it visible.
    Thin(usize),
    Dashed(usize),
    /// A line with a dot at each point.
    Dotted(usize),
    /// A dot at each point, without a line.
    Points(usize),
    /// A dot at each point, on a bar from 0.
    Columns(usize),
    /// Pieces of a line that show uncertainties rather than values.
    Bars(usize),
    /// Limit of the line with this colour.
    Limit(usize),
}

impl Stroke {
    /// Names of its classes in the style sheet.
    pub(super) fn classes(self) -> String {
        match self {
            Self::Solid(colour) | Self::Dotted(colour) => format!("line s{colour}"),
            Self::Thin(colour) => format!("line s{colour} thin"),
            Self::Dashed(colour) => format!("line s{colour} dashed"),
            Self::Points(colour) | Self::Columns(colour) => format!("line s{colour} points"),
            Self::Bars(colour) => format!("bars s{colour}"),
            Self::Limit(colour) => format!("limit s{colour}"),
        }
    }

    /// True if the line shows readable values.
    fn has_values(self) -> bool {
        !matches!(self, Self::Bars(_) | Self::Limit(_))
    }
}

/// A line of a figure.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve {
    /// Name in the legend.
    pub(super) name: String,
    pub(super) stroke: Stroke,
    /// Points (x, y); a point that is not finite interrupts the line.
    pub(super) points: Vec<(f64, f64)>,
}

impl Curve {
    /// A line through the points (x, y).
    pub(super) fn new(name: &str, stroke: Stroke, x: &[f64], y: &[f64]) -> Self {
        let points = x.iter().copied().zip(y.iter().copied()).collect();
        Self { name: name.to_owned(), stroke, points }
    }

    /// Adds a limit of the distance from the value `from` to the lines of a figure, in the colour of the limited line;
    /// `owner` is empty or a word before "limit". A limit far above the lines would make them small: the function then adds no line, and returns a
    /// sentence for the caption.
    pub(super) fn add_limit(
        curves: &mut Vec<Self>,
        (limit, from): (Option<f64>, f64),
        (owner, unit): (&str, &str),
        colour: usize,
    ) -> String {
        let Some(limit) = limit else { return String::new() };
        let name = format!("{owner} limit {} {unit}", given(limit)).trim().to_owned();
        let Some(line) = Self::limit((limit, &name), from, colour, curves) else {
            return format!(" The {name} is beyond the figure.");
        };
        curves.push(line);
        String::new()
    }

    /// A line at a limit above `from`, over the x of the first of `curves`; also at the limit below it if some curve falls
    /// below `from` by a twentieth of the peak. `None` for a limit of more than three times the peak, and without points.
    pub(super) fn limit(
        (limit, name): (f64, &str),
        from: f64,
        colour: usize,
        curves: &[Self],
    ) -> Option<Self> {
        const FAR: f64 = 3.0;
        let points = || curves.iter().flat_map(|line| &line.points);
        let values = || points().map(|(_, value)| value - from);
        let peak = values().fold(0.0_f64, |peak, value| peak.max(value.abs()));
        let x = &curves.first()?.points;
        let [first, last] = [x.first()?.0, x.last()?.0];
        let mut points = vec![(first, from + limit), (last, from + limit)];
        if values().any(|value| value < -0.05 * peak) {
            points.extend([(f64::NAN, f64::NAN), (first, from - limit), (last, from - limit)]);
        }
        let name = name.to_owned();
        (limit <= FAR * peak).then_some(Self { name, stroke: Stroke::Limit(colour), points })
    }

    /// Value of the point whose x is nearest to this one; `None` beyond the line's ends.
    fn value_near(&self, x: f64) -> Option<f64> {
        let points = &self.points;
        let is_inside = points.first()?.0 <= x && x <= points.last()?.0;
        let next = points.partition_point(|point| point.0 < x).min(points.len() - 1);
        let before = next.saturating_sub(1);
        let nearest = if x - points[before].0 < points[next].0 - x { before } else { next };
        is_inside.then_some(points[nearest].1)
    }
}

/// A shaded range of x.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Span {
    /// Name in the legend, and class in the style sheet: `lead` or `lag`.
    pub(super) name: &'static str,
    pub(super) range: Range<f64>,
}

/// A named value of x.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mark {
    pub(super) at: f64,
    /// Name of the mark: `f1`.
    pub(super) label: String,
    /// Class in the style sheet.
    pub(super) class: &'static str,
}

/// Figures of a result.
#[derive(Debug, Clone, Default)]
pub struct Figures {
    /// Figures in the order of a page.
    pub drawn: Vec<Figure>,
    /// Titles of missing figures, with reasons: `waves, since no nodal displacements were written`.
    pub omitted: Vec<String>,
    /// The first link of the result, whose joint and output the words are of.
    pub(super) link: Option<Link>,
}

impl Figures {
    /// Adds a figure, or the reason why it is missing. A figure with extreme numbers counts as missing.
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

    pub(super) fn extend(&mut self, figures: impl IntoIterator<Item = Result<Figure, String>>) {
        figures.into_iter().for_each(|figure| self.add(figure));
    }
}

/// Largest number of rows in the table below a figure.
const ROWS: usize = 16;

/// Largest number of dots in the table below a figure.
const DOTS: usize = 200;

/// Number of rows of a map over time in its table.
const MAP_ROWS: usize = 5;

/// Significant digits of the numbers in a table. A map of fields keeps the digits of its CSV file.
const DIGITS: usize = 4;
const FIELD_DIGITS: usize = 6;

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

    /// A figure of lines, with a y axis of this name and unit around them.
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

    /// Sets the formula of the quantities in the figure.
    pub(super) fn by(self, formula: impl Into<Cow<'static, str>>) -> Self {
        Self { formula: formula.into(), ..self }
    }

    /// True if a page of a run shows the figure before the others. The leading figures are those of the torques, the force, the
    /// tip, the hub and the motors, and of an arm also the angle, rate and power of each joint; but not the tip under
    /// the rigid link's torque.
    pub(super) fn leads(&self) -> bool {
        const LEADING: [&str; 8] =
            ["torque", "carriage", "tip", "hub", "motor", "angle", "rate", "power"];
        LEADING.iter().any(|id| self.id.starts_with(id)) && self.id != "tip-under-rigid-torque"
    }

    /// True if the numbers are too large or too small for a drawing.
    fn is_extreme(&self) -> bool {
        let strip = self.strip.as_ref().map(|(_, axis)| axis);
        let is_map = self.map.as_ref().is_some_and(ColourMap::is_extreme);
        is_map || [&self.x, &self.y].into_iter().chain(strip).any(Axis::is_extreme)
    }

    /// Number of drawn points of the first line, and number of all its points. `None` if the figure shows all points.
    pub(super) fn thinned(&self) -> Option<(usize, usize)> {
        let (drawn, all) =
            (thinned(&self.curves).first()?.points.len(), self.curves.first()?.points.len());
        (drawn < all).then_some((drawn, all))
    }

    /// Headings and rows of a table. Each row has an x, evenly spaced, and the values of all lines there. A map of
    /// fields has a line for each of its rows, a map over time for some of its rows.
    pub(super) fn table(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let (mut lines, unit, most_rows, digit_count) = match &self.map {
            Some(map) if map.fields.is_some() => {
                (self.map_lines(map), "", usize::MAX, FIELD_DIGITS)
            }
            Some(map) if self.curves.is_empty() => (self.map_lines(map), "", ROWS, DIGITS),
            _ => (thinned(&self.curves), self.y.unit.as_str(), ROWS, DIGITS),
        };
        lines.retain(|line| line.stroke.has_values());
        if !lines.is_empty() && lines.iter().all(|line| matches!(line.stroke, Stroke::Points(_))) {
            return self.table_of_dots(&lines);
        }
        let Some(first) = lines.first() else { return (vec![], vec![]) };
        let text =
            |value: f64| if value.is_finite() { digits(value, digit_count) } else { String::new() };
        let mut head = vec![self.x.title()];
        head.extend(lines.iter().map(|line| in_unit(&line.name, unit)));
        let row = |k: usize| {
            let x = first.points[k].0;
            let values = lines.iter().map(|line| line.value_near(x).map_or(String::new(), text));
            std::iter::once(text(x)).chain(values).collect()
        };
        (head, evenly(first.points.len(), most_rows).into_iter().map(row).collect())
    }

    /// The table of a figure of dots: a row for each, since several may stand over one x, with the name of its kind if
    /// there are several. The page's script writes the same to the CSV file.
    fn table_of_dots(&self, kinds: &[Curve]) -> (Vec<String>, Vec<Vec<String>>) {
        let mut dots: Vec<((f64, f64), &String)> = Vec::new();
        for kind in kinds {
            dots.extend(kind.points.iter().map(|dot| (*dot, &kind.name)));
        }
        dots.retain(|((_, value), _)| value.is_finite());
        dots.sort_by(|(a, _), (b, _)| a.0.total_cmp(&b.0));
        let columns = if kinds.len() > 1 { 3 } else { 2 };
        let cells = |all: [String; 3]| all.into_iter().take(columns).collect::<Vec<_>>();
        let row = |k: usize| {
            let ((x, value), kind) = &dots[k];
            cells([digits(*x, DIGITS), digits(*value, DIGITS), (*kind).clone()])
        };
        let rows = evenly(dots.len(), DOTS).into_iter().map(row).collect();
        (cells([self.x.title(), self.y.title(), "case".to_owned()]), rows)
    }

    /// All rows of a map of fields, or some rows of a map over time, as lines over x.
    fn map_lines(&self, map: &ColourMap) -> Vec<Curve> {
        let line = |y: f64, points: Vec<(f64, f64)>| {
            let y = if map.fields.is_some() { given(y) } else { significant(y, 3) };
            let place = format!("{} = {y} {}", self.y.name, self.y.unit);
            let name = in_unit(&format!("{} at {}", map.name, place.trim_end()), &map.unit);
            Curve { name, stroke: Stroke::Solid(1), points }
        };
        if let Some(Fields { places: [x, y], values, .. }) = &map.fields {
            let points = |row: &Vec<f64>| x.iter().copied().zip(row.iter().copied()).collect();
            return y.iter().zip(values).map(|(y, row)| line(*y, points(row))).collect();
        }
        // The numbers of a map over time belong to the centres of equal cells.
        let centre = |range: &Range<f64>, cell: usize, cells: usize| {
            range.start + (range.end - range.start) * (cell as f64 + 0.5) / cells as f64
        };
        let line_of_row = |row: usize| {
            let values = &map.rows[row];
            let x = (0..values.len()).map(|cell| centre(&self.x.range, cell, values.len()));
            let y = centre(&self.y.range, row, map.rows.len());
            line(y, x.zip(values.iter().copied()).collect())
        };
        evenly(map.rows.len(), MAP_ROWS).into_iter().map(line_of_row).collect()
    }
}

/// Lines as drawn. Few points stay as they are. Of many, each part of x keeps the lowest and the highest point of every
/// line, so that no peak is lost; all lines over the same x keep these points of all of them.
pub(super) fn thinned(curves: &[Curve]) -> Vec<Curve> {
    let has_same_x = |(a, b): (&(f64, f64), &(f64, f64))| a.0.total_cmp(&b.0).is_eq();
    let thin = |curve: &Curve| {
        let all = &curve.points;
        let is_alike = |other: &&[(f64, f64)]| {
            other.len() == all.len() && all.iter().zip(*other).all(has_same_x)
        };
        let alike = curves.iter().map(|other| &other.points[..]).filter(is_alike);
        let kept = drawn_points(&alike.collect::<Vec<_>>(), all.len());
        Curve { points: kept.map(|k| all[k]).collect(), ..curve.clone() }
    };
    curves.iter().map(thin).collect()
}

/// At most `most` of `len` numbers, evenly spaced, including the first and the last.
pub(super) fn evenly(len: usize, most: usize) -> Vec<usize> {
    let count = len.min(most);
    (0..count).map(|k| if count < 2 { 0 } else { k * (len - 1) / (count - 1) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_is_drawn_on_both_sides_unless_the_lines_are_far_from_it() {
        let curve =
            |values: &[f64]| vec![Curve::new("torque", Stroke::Solid(1), &[0.0, 1.0], values)];
        let mut curves = curve(&[-1.0, 1.5]);
        assert_eq!(Curve::add_limit(&mut curves, (Some(2.0), 0.0), ("", "N m"), 1), "");
        let limit = &curves[1];
        let heights: Vec<f64> =
            limit.points.iter().map(|(_, y)| *y).filter(|y| y.is_finite()).collect();
        assert_eq!((heights, &limit.name[..]), (vec![2.0, 2.0, -2.0, -2.0], "limit 2 N m"));
        assert_eq!(Curve::limit((2.0, "a"), 0.0, 1, &curve(&[0.0, 1.5])).unwrap().points.len(), 2);
        let remark = Curve::add_limit(&mut curves, (Some(20.0), 0.0), ("motor's", "N m"), 1);
        let beyond = " The motor's limit 20 N m is beyond the figure.";
        assert_eq!((remark.as_str(), curves.len()), (beyond, 2));
    }
}
