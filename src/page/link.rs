//! A link drawn to scale, its parts in words, and numbers for a page.

use maud::{Markup, html};

use super::words::own;
use crate::link::{Damping, Drive, Joint, Link, Segment};
use crate::numeric::rounded;
use crate::text::significant;

/// Width and height of the drawing, position of the axis, x of the farthest body, all in pixels.
const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 150.0;
const AXIS: (f64, f64) = (60.0, 62.0);
const END: f64 = 700.0;

/// Largest and smallest thickness in pixels.
const THICKEST: f64 = 26.0;
const THINNEST: f64 = 3.0;

/// Radius in pixels of a mass equal to the link's.
const LINK_SIZED: f64 = 14.0;

/// Thickness relative to the largest, for sections of equal width: EI ∝ h³.
fn relative_thickness(stiffness: f64, largest: f64) -> f64 {
    libm::cbrt(stiffness / largest)
}

/// Largest stiffness EI of a link in N m².
pub(super) fn largest_stiffness(link: &Link) -> f64 {
    let ends = |s: &Segment| s.bending_stiffness_n_m2.inner.max(s.bending_stiffness_n_m2.outer);
    link.segments().iter().map(ends).fold(f64::MIN_POSITIVE, f64::max)
}

/// Distances of the segments' ends from the axis in m.
fn borders_m(link: &Link) -> Vec<f64> {
    let mut borders = vec![link.hub().radius_m];
    for segment in link.segments() {
        borders.push(borders[borders.len() - 1] + segment.length_m);
    }
    borders
}

/// The link, to scale along its length, with thickness by stiffness and a dot for each mass.
pub(super) fn link_drawing(link: &Link) -> Markup {
    let offset = link.payload().offset_m.max(0.0);
    let per_m = (END - AXIS.0) / (link.length_m() + offset);
    let at = |x_m: f64| AXIS.0 + per_m * x_m;
    let radius_px = (per_m * link.hub().radius_m).max(0.0);
    let largest = largest_stiffness(link);
    let half =
        |stiffness: f64| 0.5 * (THICKEST * relative_thickness(stiffness, largest)).max(THINNEST);
    let mass_kg = |s: &Segment| s.mass_per_length_kg_m.mean() * s.length_m;
    let link_kg: f64 = link.segments().iter().map(mass_kg).sum();
    let size =
        |kg: f64| (LINK_SIZED * libm::cbrt(kg / link_kg.max(f64::MIN_POSITIVE))).clamp(3.5, 22.0);
    let borders = borders_m(link);
    let words = format!(
        "The link to scale: {} segments, {} m from the axis to the tip",
        link.segments().len(),
        significant(link.length_m(), 4)
    );
    html! {
        svg role="img" aria-label=(words) viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) {
            @if link.joint().slides() {
                path class="ground" d=(format!("M{} {}v76", AXIS.0 - 16.0, AXIS.1 - 38.0)) {}
            } @else {
                path class="ground" d=(format!("M{} {}h36m-30 0l-7 8m15 -8l-7 8m15 -8l-7 8m15 -8l-7 8", AXIS.0 - 18.0, AXIS.1 + 26.0)) {}
                path class="ground" d=(format!("M{} {}v26", AXIS.0, AXIS.1)) {}
            }
            @if radius_px > 0.0 {
                rect class="radius" x=(AXIS.0) y=(AXIS.1 - 8.0) width=(radius_px) height="16" {}
            }
            @for (k, segment) in link.segments().iter().enumerate() {
                @let (from, to) = (at(borders[k]), at(borders[k + 1]));
                @let taper = segment.bending_stiffness_n_m2;
                @let (inner, outer) = (half(taper.inner), half(taper.outer));
                polygon class="segment" points=(format!(
                    "{from:.1},{:.1} {to:.1},{:.1} {to:.1},{:.1} {from:.1},{:.1}",
                    AXIS.1 - inner, AXIS.1 - outer, AXIS.1 + outer, AXIS.1 + inner)) {}
            }
            @if link.joint().slides() {
                // The rail runs across the link.
                rect class="hub" x=(AXIS.0 - 13.0) y=(AXIS.1 - 20.0) width="13" height="40" {}
            } @else {
                circle class="hub" cx=(AXIS.0) cy=(AXIS.1) r="13" {}
                circle class="axis-point" cx=(AXIS.0) cy=(AXIS.1) r="3" {}
            }
            @for mass in link.masses() {
                circle class="mass" cx=(format!("{:.1}", at(mass.at_m))) cy=(AXIS.1)
                    r=(format!("{:.1}", size(mass.mass_kg))) {}
            }
            @if link.payload().mass_kg > 0.0 || link.payload().inertia_kg_m2 > 0.0 {
                @let centre = at(link.length_m() + link.payload().offset_m);
                path class="ground" d=(format!("M{:.1} {}H{centre:.1}", at(link.length_m()), AXIS.1)) {}
                circle class="payload" cx=(format!("{centre:.1}")) cy=(AXIS.1)
                    r=(format!("{:.1}", size(link.payload().mass_kg))) {}
            }
            (dimensions(link, &borders, at))
        }
    }
}

/// Room for a label, and for a letter, on a narrow page, where text is larger.
const NARROW_GAP: f64 = 100.0;
const NARROW_LETTER: f64 = 14.0;

/// Names of the segments, and distances of their ends from the axis.
fn dimensions(link: &Link, borders: &[f64], at: impl Fn(f64) -> f64) -> Markup {
    let line = HEIGHT - 32.0;
    let mut last = f64::NEG_INFINITY;
    let mut shown: Vec<(f64, String, bool)> = Vec::new();
    let ends = std::iter::once(&0.0).chain(borders);
    for (k, border) in ends.enumerate() {
        let is_last = k == borders.len();
        // Omits a label that would overlap the one before, but keeps the tip's label.
        if at(*border) - last > 46.0 || is_last {
            if is_last && shown.len() > 1 && at(*border) - last < 46.0 {
                shown.pop();
            }
            let is_crowded = at(*border) - last < NARROW_GAP && !is_last;
            last = at(*border);
            shown.push((last, given(*border, "m"), is_crowded));
        }
    }
    let class = |is_crowded| if is_crowded { "dimension-text crowded" } else { "dimension-text" };
    html! {
        path class="dimension" d=(format!("M{:.1} {line}H{:.1}", at(0.0), at(link.length_m()))) {}
        @for (place, label, is_crowded) in &shown {
            @let is_crowded = *is_crowded;
            path class="dimension" d=(format!("M{place:.1} {}v10", line - 5.0)) {}
            text class=(class(is_crowded)) x=(format!("{place:.1}")) y=(line + 20.0) text-anchor="middle" {
                (label)
            }
        }
        @for (k, segment) in link.segments().iter().enumerate() {
            @let (from, to) = (at(borders[k]), at(borders[k + 1]));
            @if let Some(name) = segment.name.as_ref().filter(|name| 7.0 * name.chars().count() as f64 <= to - from + 12.0) {
                @let is_crowded = NARROW_LETTER * (name.chars().count() + 2) as f64 > to - from;
                text class=(class(is_crowded)) x=(format!("{:.1}", 0.5 * (from + to))) y=(line - 8.0)
                    text-anchor="middle" { (own(name)) }
            }
        }
    }
}

/// The parts of the link.
pub(super) fn link_readings(link: &Link) -> Vec<(String, String)> {
    let (payload, friction) = (link.payload(), link.joint().friction());
    let length = ("length", Some(given(link.length_m(), "m")));
    let rigid = link.rigid_inertia_kg_m2();
    let rows = match link.joint() {
        Joint::Revolute(hub) => vec![
            length,
            ("rigid inertia", Some(given(rigid, "kg m²"))),
            ("hub inertia", Some(given(hub.inertia_kg_m2, "kg m²"))),
            ("hub radius", (hub.radius_m > 0.0).then(|| given(hub.radius_m, "m"))),
            ("hub friction", (friction > 0.0).then(|| given(friction, "N m s/rad"))),
        ],
        Joint::Prismatic(carriage) => vec![
            length,
            ("rigid mass", Some(given(rigid, "kg"))),
            ("carriage mass", Some(given(carriage.mass_kg, "kg"))),
            ("carriage friction", (friction > 0.0).then(|| given(friction, "N s/m"))),
        ],
    };
    let rows = rows.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?)));
    let mut rows: Vec<(String, String)> = rows.collect();
    for (k, segment) in link.segments().iter().enumerate() {
        let name = segment.name.clone().unwrap_or_else(|| k.to_string());
        rows.push((format!("segment {}", own(name)), segment_words(segment)));
    }
    for mass in link.masses() {
        let place = format!("mass at {}", given(mass.at_m, "m"));
        rows.push((place, body_words(mass.mass_kg, mass.inertia_kg_m2)));
    }
    if payload.mass_kg > 0.0 || payload.inertia_kg_m2 > 0.0 {
        let mut words = body_words(payload.mass_kg, payload.inertia_kg_m2);
        if payload.offset_m.abs() > 0.0 {
            words = format!("{words}, {} beyond the tip", given(payload.offset_m, "m"));
        }
        rows.push(("payload".to_owned(), words));
    }
    rows.push(("damping".to_owned(), damping_words(link.damping())));
    let slides = link.joint().slides();
    rows.extend(link.drive().map(|drive| ("drive".to_owned(), drive_words(drive, slides))));
    if let Some(gravity) = link.gravity() {
        let [along_x, along_y] = gravity.acceleration_m_s2.map(|part| given(part, "m/s²"));
        rows.push(("gravity".to_owned(), format!("{along_x} along x, {along_y} along y")));
        let start = gravity.start_angle_rad.map(|angle| given(angle, "rad"));
        let start = start.unwrap_or_else(|| "that of the motion".into());
        rows.push(("start angle".to_owned(), start));
    }
    // Values have the units of this joint.
    rows.into_iter().map(|(name, value)| (name, own(value))).collect()
}

fn drive_words(drive: &Drive, slides: bool) -> String {
    let [ratio, effort, per_motion] =
        if slides { ["rad/m", "N", "N/m"] } else { ["", "N m", "N m/rad"] };
    let ratio = given(drive.gear_ratio, ratio);
    let rotor = given(drive.rotor_inertia_kg_m2, "kg m²");
    let stiffness = drive.joint_stiffness_n_m_rad;
    let joint = if stiffness.is_finite() { given(stiffness, per_motion) } else { "stiff".into() };
    let parts = [
        (drive.efficiency < 1.0, "efficiency", given(drive.efficiency, "")),
        (
            drive.coulomb_friction_n_m > 0.0,
            "Coulomb friction",
            given(drive.coulomb_friction_n_m, effort),
        ),
    ];
    let constants = [
        ("torque constant", drive.torque_constant_n_m_a, "N m/A"),
        ("resistance", drive.resistance_ohm, "Ω"),
    ];
    let losses = parts.into_iter().filter(|(acts, ..)| *acts);
    let losses = losses.map(|(_, name, value)| format!("; {name} {value}"));
    let constants = constants.into_iter().filter_map(|(name, value, unit)| {
        value.map(|value| format!("; {name} {}", given(value, unit)))
    });
    let more: String = losses.chain(constants).collect();
    format!("gear ratio {ratio}; rotor {rotor}; joint {joint}{more}")
}

/// A damping law with its numbers, if it has any.
fn damping_words(damping: &Damping) -> String {
    let name = damping.name();
    let list = |ratios: &[f64]| ratios.iter().map(|r| given(*r, "")).collect::<Vec<_>>().join(", ");
    match damping {
        Damping::Hysteretic { ratio } => format!("{name}, ratio {}", given(*ratio, "")),
        Damping::Modal { ratios } => format!("{name}, ratios {}", list(ratios)),
        Damping::Rayleigh { alpha_per_s, beta_s } => {
            format!("{name}, α {}, β {}", given(*alpha_per_s, "1/s"), given(*beta_s, "s"))
        }
        _ => name.to_owned(),
    }
}

fn segment_words(segment: &Segment) -> String {
    let ends = |inner: f64, outer: f64, unit: &str| {
        if inner.total_cmp(&outer).is_eq() {
            given(inner, unit)
        } else {
            format!("{} … {}", given(inner, ""), given(outer, unit))
        }
    };
    let (stiffness, mass) = (segment.bending_stiffness_n_m2, segment.mass_per_length_kg_m);
    let slender = format!(
        "{}; EI {}; {}",
        given(segment.length_m, "m"),
        ends(stiffness.inner, stiffness.outer, "N m²"),
        ends(mass.inner, mass.outer, "kg/m")
    );
    let Some(thick) = segment.timoshenko else { return slender };
    let (shear, rotary) = (thick.shear_stiffness_n, thick.rotary_inertia_per_length_kg_m);
    format!(
        "{slender}; κGA {}; ρI {}",
        ends(shear.inner, shear.outer, "N"),
        ends(rotary.inner, rotary.outer, "kg m")
    )
}

fn body_words(mass_kg: f64, inertia_kg_m2: f64) -> String {
    let mass = given(mass_kg, "kg");
    if inertia_kg_m2 > 0.0 { format!("{mass}, {}", given(inertia_kg_m2, "kg m²")) } else { mass }
}

/// A number with its unit, without trailing zeros.
pub(super) fn given(value: f64, unit: &str) -> String {
    let digits = significant(value, 4);
    let short = match digits.split_once('.') {
        Some((whole, decimals)) if !decimals.contains('e') => {
            let decimals = decimals.trim_end_matches('0');
            if decimals.is_empty() { whole.to_owned() } else { format!("{whole}.{decimals}") }
        }
        _ => digits,
    };
    format!("{short} {unit}").replace('-', "−").trim_end().to_owned()
}

/// Significant digits of the numbers, as in the CSV file of a map.
const DIGITS: usize = 6;

/// Relative thickness along the link, at both ends of each segment; `largest` is the stiffness in N m² with thickness
/// 1.
pub(super) fn thickness(link: &Link, largest: f64) -> Vec<[f64; 2]> {
    let borders = borders_m(link);
    let ends = link.segments().iter().zip(borders.windows(2)).flat_map(|(segment, ends)| {
        let taper = segment.bending_stiffness_n_m2;
        [(ends[0], taper.inner), (ends[1], taper.outer)]
    });
    ends.map(|(x, ei)| [short(x), short(relative_thickness(ei, largest))]).collect()
}

/// A number with few digits.
pub(super) fn short(value: f64) -> f64 {
    rounded(value, DIGITS)
}
