//! A figure as SVG. Colours are classes: the style sheet of the page has a light and a dark theme, that of a separate
//! figure file only the light one.

use std::fmt::Write as _;
use std::slice;

use maud::{Markup, html};

use super::axis::{Axis, TIME, digits, in_unit};
use super::colour_map::{ColourMap, Fields, Hatch};
use super::figure::{Curve, Figure, Mark, Stroke, thinned};
use super::words::letters;

/// Approximate width of a letter.
const LETTER: f64 = 6.6;

/// Width of every figure in pixels.
const WIDTH: f64 = 760.0;

/// Margins around the plot.
const LEFT: f64 = 76.0;
const TOP: f64 = 34.0;
const RIGHT: f64 = 16.0;
const BOTTOM: f64 = 46.0;

/// Number of dots in a line above which they are small.
const MANY_DOTS: usize = 200;

/// Height of the strip above a colour map, and of the gap below it.
const STRIP: f64 = 70.0;
const GAP: f64 = 10.0;

/// Smallest height of a field with a number.
const FIELD_HEIGHT: f64 = 15.0;

/// Vertical extent of a y axis in the plot.
#[derive(Debug, Clone, Copy)]
struct Band {
    top: f64,
    height: f64,
}

impl Band {
    fn y(&self, share: f64) -> f64 {
        self.top + self.height * (1.0 - share)
    }
}

impl Figure {
    /// Height of the figure in pixels.
    fn height(&self) -> f64 {
        if self.map.is_some() { 380.0 } else { 300.0 }
    }

    /// Width and height of the plot.
    fn plot(&self) -> (f64, f64) {
        (WIDTH - LEFT - RIGHT, self.height() - TOP - BOTTOM)
    }

    /// Extent of the y axis: below the strip, if there is one.
    fn main_band(&self) -> Band {
        let top = if self.strip.is_some() { STRIP + GAP } else { 0.0 };
        Band { top, height: self.plot().1 - top }
    }

    /// The drawing as SVG. A file needs the namespace; in a page it does no harm.
    pub(super) fn svg(&self) -> Markup {
        let (width, height) = self.plot();
        let band = self.main_band();
        let (x, y) = (&self.x, &self.y);
        // The page zooms all figures over time together.
        let across = if x.name == TIME { TIME } else { "other" };
        let places: Vec<String> = x.places.iter().map(f64::to_string).collect();
        let places = (!places.is_empty()).then(|| places.join(" "));
        html! {
            svg class="chart" xmlns="http://www.w3.org/2000/svg" role="img"
                aria-label=(format!("{}: {} against {}", self.title, y.title(), x.title()))
                viewBox=(format!("0 0 {WIDTH} {}", self.height()))
                data-plot=(format!("{LEFT} {TOP} {width} {height}"))
                data-band=(format!("{} {}", band.top, band.height))
                data-x=(range(x)) data-y=(range(y))
                data-x-name=(x.name) data-x-unit=(x.unit)
                data-y-name=(y.name) data-y-unit=(y.unit)
                data-x-places=[places]
                data-x-grid=[self.grid()]
                data-x-axis=(across)
                data-x-scale=(x.spacing_word()) data-y-scale=(y.spacing_word()) {
                rect class="plot-area" x=(LEFT) y=(TOP) width=(width) height=(height) {}
                (self.ticks(band))
                svg class="plot" x=(LEFT) y=(TOP) width=(width) height=(height)
                    viewBox=(format!("0 0 {width} {height}")) preserveAspectRatio="none" {
                    g class="zoom" { (self.content(band)) }
                    g class="marks" {
                        @for mark in &self.marks {
                            @let at = number(width * x.share(mark.at));
                            line class=(format!("mark {}", mark.class)) data-at=(mark.at)
                                x1=(at) x2=(at) y1="0" y2=(height) {}
                        }
                    }
                }
                (self.field_numbers(band))
                (self.mark_labels())
                (self.legend())
            }
        }
    }

    /// Start and step of the x of all lines, if they are evenly spaced.
    fn grid(&self) -> Option<String> {
        let x: Vec<f64> =
            self.curves.iter().flat_map(|curve| curve.points.iter().map(|(x, _)| *x)).collect();
        let (start, step) = (*x.first()?, x.get(1)? - x[0]);
        let is_even = |x: &f64| {
            let steps = (x - start) / step;
            x.is_nan() || (steps - steps.round()).abs() < 1e-3
        };
        (self.x.name == TIME && x.iter().all(is_even)).then(|| format!("{start} {step}"))
    }

    /// Numbers in the fields of a map, if they have room.
    fn field_numbers(&self, band: Band) -> Markup {
        let found = self.map.as_ref().and_then(|map| Some((map, map.fields.as_ref()?)));
        let Some((map, Fields { places: [x, y], values, hatch })) = found else {
            return html! {};
        };
        let is_hatched =
            |row: usize, k: usize| hatch.as_ref().is_some_and(|own| own.fields[row][k]);
        let class = |value: f64, is_hatched: bool| {
            let on = if map.is_dark(value) { "on-dark" } else { "on-light" };
            if is_hatched { format!("{on} on-hatch") } else { on.to_owned() }
        };
        let (width, borders) = (self.plot().0, borders(&self.x, x));
        let is_low = band.height / (y.len() as f64) < FIELD_HEIGHT;
        let most = if is_low { 0 } else { y.len() };
        html! {
            g class="fields" {
                @for (j, (at_y, row)) in y.iter().zip(values).take(most).enumerate() {
                    @for (k, value) in row.iter().enumerate().filter(|(_, value)| value.is_finite()) {
                        @let label = digits(*value, 3);
                        @let (from, to) = (borders[k], borders[k + 1]);
                        @if LETTER * label.chars().count() as f64 + 2.0 < width * (to - from) {
                            text class=(class(*value, is_hatched(j, k)))
                                data-from=(number(width * from)) data-to=(number(width * to))
                                x=(number(LEFT + width * self.x.share(x[k])))
                                y=(number(TOP + band.y(self.y.share(*at_y)) + 4.0))
                                text-anchor="middle" { (label) }
                        }
                    }
                }
            }
        }
    }

    fn content(&self, band: Band) -> Markup {
        let (width, height) = self.plot();
        html! {
            @for span in &self.spans {
                @let [from, to] = [span.range.start, span.range.end].map(|x| width * self.x.share(x));
                rect class=(format!("span {}", span.name)) x=(number(from)) y="0"
                    width=(number(to - from)) height=(height) {}
            }
            @if let Some(map) = &self.map {
                image x="0" y=(band.top) width=(width) height=(band.height)
                    preserveAspectRatio="none" href=(map.picture()) {}
                (self.hatching(map, band))
            }
            @if let Some(curve) = &self.backdrop {
                path class="fill" data-name=(curve.name) d=(self.area(curve)) {}
            }
            @if let Some((curve, axis)) = &self.strip {
                @for curve in &thinned(slice::from_ref(curve)) {
                    (self.line(curve, axis, Band { top: 0.0, height: STRIP }, true))
                }
            }
            @for curve in &thinned(&self.curves) { (self.line(curve, &self.y, band, false)) }
        }
    }

    /// Diagonal lines over the hatched fields of a map, and the edge of the hatched region.
    fn hatching(&self, map: &ColourMap, band: Band) -> Markup {
        let fields = map.fields.as_ref();
        let Some((places, hatch)) = fields.and_then(|own| Some((&own.places, own.hatch.as_ref()?)))
        else {
            return html! {};
        };
        let width = self.plot().0;
        let x: Vec<f64> = borders(&self.x, &places[0]).iter().map(|share| width * share).collect();
        let y: Vec<f64> = borders(&self.y, &places[1]).iter().map(|share| band.y(*share)).collect();
        let is_hatched = |row: Option<usize>, column: Option<usize>| {
            let field =
                row.zip(column).and_then(|(row, column)| hatch.fields.get(row)?.get(column));
            field.copied()
        };
        let (mut lines, mut edges) = (Vec::new(), String::new());
        for row in 0..places[1].len() {
            for column in 0..places[0].len() {
                let own = is_hatched(Some(row), Some(column));
                let (left, right, foot, top) = (x[column], x[column + 1], y[row], y[row + 1]);
                if own == Some(true) {
                    lines.push((column, row, diagonals([left, right], [top, foot])));
                }
                // An edge stands between two fields of which one is hatched.
                let differs = |other: Option<bool>| other.is_some() && other != own;
                if differs(is_hatched(Some(row), column.checked_add(1))) {
                    let _ = write!(edges, "M{},{}V{}", number(right), number(foot), number(top));
                }
                if differs(is_hatched(row.checked_add(1), Some(column))) {
                    let _ = write!(edges, "M{},{}H{}", number(left), number(top), number(right));
                }
            }
        }
        html! {
            g class="hatch" {
                @for (column, row, d) in &lines {
                    path class="halo" d=(d) {}
                    path class="stripes" data-column=(column) data-row=(row) d=(d) {}
                }
                @if !edges.is_empty() { path class="halo edge" d=(edges) {} path class="edge" d=(edges) {} }
            }
        }
    }

    /// Points of a line in pixels.
    fn points(&self, curve: &Curve, y: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        let width = self.plot().0;
        let point = |(at, value): &(f64, f64)| (width * self.x.share(*at), y(*value));
        curve.points.iter().map(point).collect()
    }

    fn line(&self, curve: &Curve, y: &Axis, band: Band, is_strip: bool) -> Markup {
        let points = self.points(curve, |value| band.y(y.share(value)));
        // The strip has a separate y axis.
        let axis = is_strip.then(|| range(y));
        let heights = is_strip.then(|| format!("{} {}", band.top, band.height));
        html! {
            @if let Stroke::Columns(colour) = curve.stroke {
                path class=(format!("bars broad s{colour}")) d=(stems(&points, band.y(y.share(0.0)))) {}
            }
            path class=(curve.stroke.classes()) data-name=(curve.name)
                data-y=[axis] data-band=[heights]
                data-unit=[is_strip.then_some(&y.unit)] d=(path(&points)) {}
            @if let Stroke::Dotted(colour) | Stroke::Points(colour) | Stroke::Columns(colour) = curve.stroke {
                @let size = if points.len() > MANY_DOTS { "dots fine" } else { "dots" };
                path class=(format!("{size} s{colour}")) d=(dots(&points)) {}
            }
        }
    }

    /// Area below a line from 0 to 1.
    fn area(&self, curve: &Curve) -> String {
        let height = self.plot().1;
        let points = self.points(curve, |share| height * (1.0 - share));
        let [Some(first), Some(last)] = [points.first(), points.last()] else {
            return String::new();
        };
        format!("{}L{},{height}L{},{height}Z", path(&points), number(last.0), number(first.0))
    }

    fn ticks(&self, band: Band) -> Markup {
        let (width, height) = self.plot();
        let right = LEFT + width;
        let foot = TOP + height;
        let middle = TOP + band.top + band.height / 2.0;
        html! {
            g class="ticks x" {
                @for (value, label) in self.x.ticks() {
                    @let at = number(LEFT + width * self.x.share(value));
                    line class="grid-line" x1=(at) x2=(at) y1=(TOP) y2=(foot) {}
                    text class="tick" x=(at) y=(foot + 17.0) text-anchor="middle" { (label) }
                }
            }
            g class="ticks y" {
                @for (value, label) in self.y.ticks() {
                    @let at = TOP + band.y(self.y.share(value));
                    line class="grid-line" x1=(LEFT) x2=(right) y1=(number(at)) y2=(number(at)) {}
                    text class="tick" x=(LEFT - 7.0) y=(number(at + 4.0)) text-anchor="end" { (label) }
                }
            }
            text class="axis x" x=(LEFT + width / 2.0) y=(foot + 37.0) text-anchor="middle" {
                (self.x.title())
            }
            text class="axis y" x="0" y="0" text-anchor="middle"
                transform=(format!("translate(13 {}) rotate(-90)", number(middle))) { (self.y.title()) }
        }
    }

    /// Names of the marks, one row for each class; omits a name that would overlap the one before.
    fn mark_labels(&self) -> Markup {
        let mut classes: Vec<&str> = self.marks.iter().map(|mark| mark.class).collect();
        classes.dedup();
        html! {
            g class="mark-labels" {
                @for (row, class) in classes.iter().enumerate() {
                    @for (mark, at) in self.with_room(class) {
                        text class=(format!("mark-label {class}")) data-at=(mark.at)
                            x=(number(at)) y=(TOP + 13.0 + 14.0 * row as f64) { (mark.label) }
                    }
                }
            }
        }
    }

    /// Marks of a class with room for their names, each with the x of its name: to the right of the mark, or to the left
    /// where the right is too narrow. The page's script does the same.
    fn with_room(&self, class: &str) -> Vec<(&Mark, f64)> {
        let width = self.plot().0;
        let mut free = 0.0;
        let mut shown = Vec::new();
        for mark in self.marks.iter().filter(|mark| mark.class == class) {
            let at = LEFT + width * self.x.share(mark.at);
            let long = 6.0 + LETTER * letters(&mark.label) as f64;
            let x = if at + long < LEFT + width { at + 3.0 } else { at - long };
            if x >= free {
                free = x + long;
                shown.push((mark, x));
            }
        }
        shown
    }

    /// The legend, in a row above the plot: first all lines, then filled areas.
    fn legend(&self) -> Markup {
        let strip = self.strip.as_ref().map(|(curve, _)| curve);
        let lines = strip.into_iter().chain(&self.curves);
        let lines = lines.map(|curve| (curve.name.as_str(), curve.stroke.classes(), true));
        let spans = self.spans.iter().map(|s| (s.name, format!("span {}", s.name), false));
        let backdrop = self.backdrop.iter().map(|c| (c.name.as_str(), "fill".to_owned(), false));
        let mut at = LEFT;
        let placed = lines.chain(spans).chain(backdrop).map(|(name, class, is_line)| {
            let x = at;
            at += 34.0 + LETTER * letters(name) as f64 + 14.0;
            (x, name, class, is_line)
        });
        html! {
            g class="legend" {
                @for (x, name, class, is_line) in placed {
                    @if is_line {
                        path class=(class) d=(format!("M{x},17h26")) {}
                    } @else {
                        rect class=(class) x=(x) y="9" width="26" height="15" {}
                    }
                    text class="legend-text" x=(x + 32.0) y="21" { (name) }
                }
                @if let Some(map) = &self.map {
                    @if map.kinds().is_empty() { (colour_scale(map)) }
                    (map_legend(map))
                }
            }
        }
    }
}

/// Shares of an axis at the borders of the fields around these places: half-way between them.
pub(super) fn borders(axis: &Axis, places: &[f64]) -> Vec<f64> {
    let shares: Vec<f64> = places.iter().map(|place| axis.share(*place)).collect();
    let middles = shares.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    std::iter::once(0.0).chain(middles).chain([1.0]).collect()
}

/// Length of the colour scale, and distance of its end from the right edge.
const SCALE: f64 = 200.0;
const SCALE_RIGHT: f64 = 34.0;

/// The colours of a map with their numbers.
fn colour_scale(map: &ColourMap) -> Markup {
    let start = WIDTH - SCALE_RIGHT - SCALE;
    let colours = map.scale(40);
    let step = SCALE / colours.len() as f64;
    // Opaque colours extend below the next one, so that no gaps show between them.
    let width = |opacity: f64| if opacity < 1.0 { step } else { step + 0.5 };
    let label = |value: f64| match value {
        zero if zero.abs() <= 0.0 => "0".to_owned(),
        value => digits(value, 3),
    };
    html! {
        text class="legend-text" x=(start - 8.0) y="12" text-anchor="end" { (in_unit(&map.name, &map.unit)) }
        @for (k, (colour, opacity)) in colours.iter().enumerate() {
            rect x=(number(start + step * k as f64)) y="3" width=(number(width(*opacity))) height="11"
                fill=(colour) fill-opacity=(number(*opacity)) {}
        }
        @for (value, share) in map.scale_ticks() {
            text class="legend-text" x=(number(start + share * SCALE)) y="27" text-anchor="middle" { (label(value)) }
        }
    }
}

/// Names of a map's kinds and of its hatching, in a row at the left.
fn map_legend(map: &ColourMap) -> Markup {
    let hatch = map.fields.as_ref().and_then(|own| own.hatch.as_ref());
    let kind = |(k, name): (usize, &String)| (name.clone(), format!("named fill k{}", k + 1));
    let kinds = map.kinds().iter().enumerate().map(kind);
    let hatched = hatch.map(|Hatch { name, .. }| (name.clone(), "named hatched".to_owned()));
    let mut at = LEFT;
    let placed = kinds.chain(hatched).map(|(name, class)| {
        let x = at;
        at += 34.0 + LETTER * letters(&name) as f64 + 14.0;
        let stripes = if class.ends_with("hatched") { "m4,15l15,-15m-7,15l14,-14" } else { "" };
        (x, name, class, format!("M{x},9h26v15h-26z{stripes}"))
    });
    html! {
        @for (x, name, class, d) in placed {
            path class=(class) d=(d) {}
            text class="legend-text named" x=(x + 32.0) y="21" { (name) }
        }
    }
}

/// First and last number of an axis.
fn range(axis: &Axis) -> String {
    format!("{} {}", axis.range.start, axis.range.end)
}

/// A coordinate as text, to a hundredth of a pixel.
fn number(value: f64) -> String {
    rounded(value, 2)
}

/// A coordinate as text. Lines have four decimals, a millionth of the axis, because the page's script reads values from
/// them.
fn rounded(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// A line through all points, interrupted at points that are not finite.
fn path(points: &[(f64, f64)]) -> String {
    let mut text = String::new();
    let mut pen = 'M';
    for (x, y) in points {
        if !(x.is_finite() && y.is_finite()) {
            pen = 'M';
            continue;
        }
        // Some viewers fail on larger coordinates, which are out of sight.
        let y = y.clamp(-1e5, 1e5);
        // Writing to a string cannot fail.
        let _ = write!(text, "{pen}{},{}", rounded(*x, 4), rounded(y, 4));
        pen = 'L';
    }
    text
}

/// Distance of hatching lines along x, in pixels.
const HATCH: f64 = 11.0;

/// Lines at 45 degrees within a box; lines of neighbouring boxes continue each other.
fn diagonals([left, right]: [f64; 2], [top, foot]: [f64; 2]) -> String {
    let mut text = String::new();
    let mut sum = HATCH * ((left + top) / HATCH).ceil();
    while sum < right + foot {
        let (from, to) = (left.max(sum - foot), right.min(sum - top));
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "M{},{}L{},{}",
            number(from),
            number(sum - from),
            number(to),
            number(sum - to)
        );
        sum += HATCH;
    }
    text
}

/// A line to each point from a height.
fn stems(points: &[(f64, f64)], foot: f64) -> String {
    let stem = |(x, y): &(f64, f64)| [(*x, foot), (*x, *y), (f64::NAN, f64::NAN)];
    path(&points.iter().flat_map(stem).collect::<Vec<_>>())
}

/// A dot at each point.
fn dots(points: &[(f64, f64)]) -> String {
    let finite = points.iter().filter(|(x, y)| x.is_finite() && y.is_finite());
    finite.map(|(x, y)| format!("M{},{}h0", number(*x), number(*y))).collect::<Vec<_>>().concat()
}
