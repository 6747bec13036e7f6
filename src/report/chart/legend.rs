use maud::{Markup, html};

use super::colour_map::ColourMap;
use super::drawing::{LEFT, RIGHT, TOP, WIDTH, number};
use super::figure::{Curve, Figure, Mark};
use crate::numeric::significant;

/// Approximate width of a letter.
const LETTER: f64 = 6.6;

/// What stands before a name in the legend, with its classes in the style sheet.
enum Symbol {
    Line(String),
    Area(String),
}

impl Figure {
    /// Names of the marks, one row for each class; a name that would overlap the one before is left
    /// out.
    pub(super) fn mark_labels(&self) -> Markup {
        let mut classes: Vec<&str> = self.marks.iter().map(|mark| mark.class).collect();
        classes.dedup();
        html! {
            g class="mark-labels" {
                @for (row, class) in classes.iter().enumerate() {
                    @for (mark, at) in self.with_room(class) {
                        text class=(format!("mark-label {class}")) data-at=(mark.at)
                            x=(number(at + 3.0)) y=(TOP + 13.0 + 14.0 * row as f64) { (mark.label) }
                    }
                }
            }
        }
    }

    /// Marks of a class whose names have room, each with its x.
    fn with_room(&self, class: &str) -> Vec<(&Mark, f64)> {
        let width = self.plot().0;
        let mut free = f64::NEG_INFINITY;
        let mut shown = Vec::new();
        for mark in self.marks.iter().filter(|mark| mark.class == class) {
            let at = LEFT + width * self.x.share(mark.at);
            let end = at + 6.0 + LETTER * mark.label.chars().count() as f64;
            if at >= free && end <= LEFT + width {
                free = end;
                shown.push((mark, at));
            }
        }
        shown
    }

    /// The legend, in a row above the plot: first all lines, then what is filled.
    pub(super) fn legend(&self) -> Markup {
        let line = |curve: &Curve| (curve.name.clone(), Symbol::Line(curve.stroke.classes()));
        let fill = |name: &str, class: String| (name.to_owned(), Symbol::Area(class));
        let strip = self.strip.as_ref().map(|(curve, _)| curve);
        let entries = strip.into_iter().chain(&self.curves).map(line);
        let spans = self.spans.iter().map(|span| fill(&span.name, format!("span {}", span.class)));
        let backdrop = self.backdrop.iter().map(|curve| fill(&curve.name, "fill".to_owned()));
        let mut at = LEFT;
        let place = |(name, symbol): (String, Symbol)| {
            let x = at;
            at += 34.0 + LETTER * name.chars().count() as f64 + 14.0;
            (x, name, symbol)
        };
        let placed: Vec<_> = entries.chain(spans).chain(backdrop).map(place).collect();
        html! {
            g class="legend" {
                @for (x, name, symbol) in &placed {
                    @match symbol {
                        Symbol::Line(class) => path class=(class) d=(format!("M{x},17h26")) {},
                        Symbol::Area(class) => rect class=(class) x=(x) y="9" width="26" height="15" {},
                    }
                    text class="legend-text" x=(x + 32.0) y="21" { (name) }
                }
                @if let Some(map) = &self.map { (colour_scale(map)) }
            }
        }
    }
}

/// The colours of a map from its smallest number to its largest.
fn colour_scale(map: &ColourMap) -> Markup {
    let (low, high) = map.limits();
    let [low, high] = [low, high].map(|value| significant(value, 3).replace('-', "−"));
    let letters = high.chars().count() + map.unit.chars().count() + 2;
    let end = WIDTH - RIGHT - LETTER * letters as f64;
    html! {
        text class="legend-text" x=(end - 128.0) y="21" text-anchor="end" { (map.name) " " (low) }
        @for (k, colour) in map.scale(24).iter().enumerate() {
            rect x=(end - 120.0 + 5.0 * k as f64 - 4.0) y="9" width="5.2" height="15" fill=(colour) {}
        }
        text class="legend-text" x=(end + 6.0) y="21" { (high) " " (map.unit) }
    }
}
