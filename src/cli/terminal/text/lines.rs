//! Lines of at most 80 columns that several commands print: wrapped items, values below their names, labels before
//! lines, and the lines of a link, an arm and a joint.

use std::fmt::{Display, Write as _};

use crate::beam::Mesh;
use crate::link::{Arm, ArmCarriage, Damping, Joint, Link};
use crate::modal::DampingLaw;
use crate::numeric::{ThinnedGrid, rounded};
use crate::result::{JointQuantity, Peak, QUANTITIES};
use crate::text::{gigabytes, instant, plain, significant, visible};

/// Number of columns of a line, and of its label.
pub(super) const COLUMNS: usize = 80;
pub(super) const LABEL: usize = 9;

/// Items with commas between them and an end, wrapped at 80 columns.
pub(super) fn wrapped(items: impl Iterator<Item = String>, end: &str) -> String {
    let (mut text, mut column) = (String::new(), LABEL);
    for item in items {
        let width = item.chars().count();
        if !text.is_empty() && column + 2 + width + end.len() > COLUMNS {
            text += ",\n";
            text += &" ".repeat(LABEL);
            column = LABEL;
        } else if !text.is_empty() {
            text += ", ";
            column += 2;
        }
        text += &item;
        column += width;
    }
    text + end
}

/// Values below their names, in blocks of at most 80 columns, with an end after the last one.
pub(super) fn in_columns(items: impl Iterator<Item = (String, String)>, end: &str) -> String {
    let mut blocks: Vec<[String; 2]> = Vec::new();
    for (name, value) in items {
        let width = name.chars().count().max(value.chars().count());
        let fits = |block: &[String; 2]| LABEL + block[0].chars().count() + 2 + width <= COLUMNS;
        if !blocks.last().is_some_and(fits) {
            blocks.push([String::new(), String::new()]);
        }
        if let Some([names, values]) = blocks.last_mut() {
            let gap = if names.is_empty() { "" } else { "  " };
            // Writing to a string cannot fail.
            let _ = write!(names, "{gap}{name:<width$}");
            let _ = write!(values, "{gap}{value:<width$}");
        }
    }
    let mut lines: Vec<String> =
        blocks.iter().flatten().map(|line| line.trim_end().to_owned()).collect();
    match lines.last_mut() {
        Some(last) if LABEL + last.chars().count() + 2 + end.len() <= COLUMNS => {
            let _ = write!(last, "  {end}");
        }
        _ => lines.push(end.to_owned()),
    }
    lines.join(&format!("\n{:LABEL$}", ""))
}

/// The line of a label after its `start`, with all quantities that are shown there; empty without numbers.
pub(super) fn joint_line(
    label: &str,
    start: &str,
    (joint, number): (&Joint, Option<usize>),
    of: impl Fn(&JointQuantity) -> Option<f64>,
) -> String {
    let whole = if number.is_some() { "arm" } else { "link" };
    let part = |own: &JointQuantity| {
        let shown = own.shown.filter(|shown| shown.line == label)?;
        let number = (shown.number)(of(own)?);
        let text = shown.text.replace("{link}", whole);
        let text = if own.keeps_words() { text } else { joint.worded(&text) };
        Some(text.replace("{}", &number))
    };
    let mut parts: Vec<String> = QUANTITIES.iter().filter_map(part).collect();
    // The part that opens the line has no separator.
    parts.sort_by_key(|part| part.starts_with([',', ';', ' ']));
    let text = start.to_owned() + &parts.concat();
    wrapped(text.split(", ").map(str::to_owned), "")
}

/// A title, then a line for each label with content.
pub(super) fn labelled<L: Display>(
    arm: &Arm,
    lines: impl IntoIterator<Item = (L, String)>,
) -> String {
    let mut text = title(arm.title());
    for (label, content) in lines.into_iter().filter(|(_, content)| !content.is_empty()) {
        // Writing to a string cannot fail.
        let [label, content] = [label.to_string(), content].map(|text| arm.of_output(text));
        let _ = writeln!(text, "{label:<8} {content}");
    }
    text
}

/// The title of a link or an arm on a separate line, if it has one.
pub(super) fn title(title: &str) -> String {
    if title.is_empty() { String::new() } else { format!("{}\n", visible(title)) }
}

/// Each number with four significant digits.
pub(super) fn four<const N: usize>(numbers: [f64; N]) -> [String; N] {
    numbers.map(|number| significant(number, 4))
}

/// Length, mesh and rigid inertia.
pub(super) fn link_line(link: &Link, mesh: &Mesh) -> String {
    let [length, inertia] = four([link.length_m(), link.rigid_inertia_kg_m2()]);
    let elements = mesh.elements().len();
    let [rigid, unit] = if link.joint().slides() { ["mass", "kg"] } else { ["inertia", "kg m²"] };
    format!("{length} m, {elements} elements, rigid {rigid} {inertia} {unit}")
}

/// The damping law in words, and the damping ratios of the modes if they differ.
pub(super) fn damping_line(link: &Link, law: &DampingLaw, frequencies_rad_s: &[f64]) -> String {
    let own = match (link.damping(), law) {
        (Damping::None | Damping::Hysteretic { ratio: 0.0 }, _) => "none".into(),
        (_, DampingLaw::Rayleigh { alpha_per_s, beta_s }) => {
            let [alpha, beta] = [*alpha_per_s, *beta_s].map(|number| significant(number, 3));
            let alpha =
                if *alpha_per_s == 0.0 { String::new() } else { format!(", alpha {alpha} 1/s") };
            format!("rayleigh{alpha}, beta {beta} s")
        }
        (Damping::Hysteretic { ratio }, _) => format!("hysteretic, ratio {ratio}"),
        (Damping::Modal { ratios }, _) if ratios.len() == 1 => {
            format!("modal, ratio {}", ratios[0])
        }
        (damping, _) => format!("{}, all modes of the mesh", damping.name()),
    };
    let ratios = law.modal_ratios(frequencies_rad_s);
    let are_one = ratios.windows(2).all(|pair| pair[0].to_bits() == pair[1].to_bits());
    let ratios = (!are_one).then(|| format!("ratios {}", list(&ratios, 2)));
    wrapped(std::iter::once(own).chain(ratios), "")
}

/// Several numbers with `digits` significant digits each, a dash for a missing one.
pub(super) fn list(values: &[f64], digits: usize) -> String {
    let text =
        |value: &f64| if value.is_nan() { "-".to_owned() } else { significant(*value, digits) };
    values.iter().map(text).collect::<Vec<_>>().join(" ")
}

/// Angle that a hub turns, or start and end angle of an arm's joint.
pub(super) fn turned(end_angles_rad: Option<[f64; 2]>, peak_rad: Peak) -> String {
    // An end far below the last digit of the turn is 0.
    let clear = |end: f64| if end.abs() < 1e-5 * peak_rad.value { 0.0 } else { end };
    match end_angles_rad.map(|ends| four(ends.map(clear))) {
        Some([from, to]) => format!("turns from {from} to {to} rad"),
        None => format!("turns by up to {} rad", significant(peak_rad.value, 4)),
    }
}

/// Note about memory before its allocation.
pub(crate) fn memory_text(bytes: usize, blocks: usize) -> String {
    let gigabytes = gigabytes(bytes);
    let more = if blocks > 1 {
        format!("; the rows are made in {blocks} blocks, each transformed anew")
    } else {
        String::new()
    };
    format!("the motion of the nodes takes about {gigabytes} of memory{more}")
}

/// Number of written rows, and the times of the first and the last.
pub(crate) fn rows_text(rows: &ThinnedGrid) -> String {
    let [start, end] = [0, rows.len().saturating_sub(1)].map(|row| instant(rows.time_s(row), 4));
    format!("{} rows, {start} … {end} s", rows.len())
}

pub(super) fn size_line(arm: &Arm) -> String {
    let carriage = arm.carriage().map_or_else(String::new, |ArmCarriage { carriage, axis }| {
        let [mass] = four([carriage.mass_kg]);
        let [x, y] = axis.map(|part| plain(rounded(part, 4)));
        format!(", on a carriage of {mass} kg along {x}, {y}")
    });
    format!("{} links, {} m{carriage}", arm.links().len(), significant(arm.length_m(), 4))
}

/// Gravity in the plane of an arm.
pub(super) fn gravity_line(arm: &Arm) -> String {
    if !arm.has_weight() {
        return String::new();
    }
    let [along_x, along_y] = arm.gravity_m_s2().map(plain);
    format!("{along_x}, {along_y} m/s²")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_below_their_names_on_as_many_lines_as_they_need() {
        let item = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        let two = [item("tip", "1.0e-6"), item("mesh (hub angle)", "2e-4")];
        let text = in_columns(two.into_iter(), "of the peak");
        assert_eq!(text, "tip     mesh (hub angle)\n         1.0e-6  2e-4  of the peak");
        let many = (0..9).map(|k| item(&format!("quantity {k}"), "1.0e-6"));
        let text = in_columns(many, "of the peak");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 4, "{text}");
        assert!(lines[2].trim_start().starts_with("quantity 6"), "{text}");
        assert!(lines.iter().all(|line| line.chars().count() <= COLUMNS), "{text}");
    }

    #[test]
    fn much_memory_is_told_with_what_becomes_slower() {
        let one = "the motion of the nodes takes about 0.54 GB of memory";
        assert_eq!(memory_text(540_000_000, 1), one);
        let many = "about 1.1 GB of memory; the rows are made in 3 blocks, each transformed anew";
        assert!(memory_text(1_100_000_000, 3).ends_with(many));
    }
}
