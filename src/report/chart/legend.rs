use maud::{Markup, html};

use super::drawing::{LEFT, RIGHT, TOP, WIDTH, number};
use super::figure::{Figure, Mark};
use crate::numeric::significant;

/// Width of a letter, about.
const LETTER: f64 = 6.6;

impl Figure {
    /// Names of the marks, each class in a row of its own; those that would lie over the one before
    /// are left out.
    pub(super) fn mark_labels(&self) -> Markup {
        let mut classes: Vec<&str> = self.marks.iter().map(|mark| mark.class).collect();
        classes.dedup();
        html! {
            g class="mark-labels" {
                @for (row, class) in classes.iter().enumerate() {
                    @for (mark, at) in self.apart(class) {
                        text class=(format!("mark-label {class}")) data-at=(mark.at)
                            x=(number(at + 3.0)) y=(TOP + 13.0 + 14.0 * row as f64) { (mark.label) }
                    }
                }
            }
        }
    }

    /// Marks of a class whose names have room, and where they are.
    fn apart(&self, class: &str) -> Vec<(&Mark, f64)> {
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

    /// What is what, in a row above the plot.
    pub(super) fn legend(&self) -> Markup {
        let mut at = LEFT;
        let mut place = |name: &str| {
            let x = at;
            at += 34.0 + LETTER * name.chars().count() as f64 + 14.0;
            x
        };
        let strip = self.strip.as_ref().map(|(curve, _)| curve);
        html! {
            g class="legend" {
                @for curve in strip.into_iter().chain(&self.curves) {
                    @let x = place(&curve.name);
                    path class=(curve.stroke.classes()) d=(format!("M{x},17h26")) {}
                    text class="legend-text" x=(x + 32.0) y="21" { (curve.name) }
                }
                @for span in &self.spans {
                    @let x = place(&span.name);
                    rect class=(format!("span {}", span.class)) x=(x) y="9" width="26" height="15" {}
                    text class="legend-text" x=(x + 32.0) y="21" { (span.name) }
                }
                @if let Some(curve) = &self.backdrop {
                    @let x = place(&curve.name);
                    rect class="fill" x=(x) y="9" width="26" height="15" {}
                    text class="legend-text" x=(x + 32.0) y="21" { (curve.name) }
                }
                @if let Some(map) = &self.map {
                    @let (low, high) = map.limits();
                    @let [low, high] = [low, high].map(|value| significant(value, 3).replace('-', "−"));
                    @let end = WIDTH - RIGHT - LETTER * (high.chars().count() + map.unit.chars().count() + 2) as f64;
                    text class="legend-text" x=(end - 128.0) y="21" text-anchor="end" {
                        (map.name) " " (low)
                    }
                    @for (k, colour) in map.scale(24).iter().enumerate() {
                        rect x=(end - 120.0 + 5.0 * k as f64 - 4.0) y="9" width="5.2" height="15" fill=(colour) {}
                    }
                    text class="legend-text" x=(end + 6.0) y="21" { (high) " " (map.unit) }
                }
            }
        }
    }
}
