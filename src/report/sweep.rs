//! A sweep: figures of what changes with the values that were varied, and its page.

use maud::{Markup, html};

use super::axis::Axis;
use super::colour_map::{ColourMap, Colours};
use super::figure::{Curve, Figure, Figures, Stroke};
use super::page::{FILES, Section, document, figures_section, inputs, made_by, table};
use crate::compare::{Cell, TableColumn};
use crate::result::StoredSweep;
use crate::text::significant;

/// Most lines of a figure; more cannot be distinguished.
const MOST_LINES: usize = 6;

/// Most levels of a heat map that all get a tick.
const MOST_TICKS: usize = 12;

/// Ratio of the largest to the smallest value above which an axis is logarithmic.
const WIDE: f64 = 12.0;

/// A value that was varied: its heading and one number per case.
struct Varied<'a> {
    name: &'a str,
    values: Vec<f64>,
    /// The different numbers, ascending.
    levels: Vec<f64>,
}

impl<'a> Varied<'a> {
    fn of(column: &'a TableColumn, rows: usize) -> Option<Self> {
        let values: Vec<f64> = (0..rows).map(|row| column.number(row)).collect();
        let mut levels = values.clone();
        levels.sort_by(f64::total_cmp);
        levels.dedup_by(|a, b| a.total_cmp(b).is_eq());
        let all = levels.iter().all(|value| value.is_finite()) && levels.len() > 1;
        all.then(|| Self { name: column.name(), values, levels })
    }

    /// Its axis; `margin` relative to the range of its values.
    fn axis(&self, margin: f64) -> Axis {
        let (low, high) = (self.levels[0], self.levels[self.levels.len() - 1]);
        if low > 0.0 && high / low > WIDE {
            let factor = libm::pow(high / low, margin);
            Axis::logarithmic(self.name, "", low / factor..high * factor)
        } else {
            let more = margin * (high - low);
            Axis::linear(self.name, "", low - more..high + more)
        }
    }
}

/// Figures of a sweep.
pub(super) fn sweep_figures(sweep: &StoredSweep) -> Figures {
    let rows = sweep.table.lines.len();
    let columns = &sweep.table.columns[..sweep.varied];
    // Columns with several values: numbers for an axis, words for names of lines.
    let several: Vec<&TableColumn> = columns
        .iter()
        .filter(|column| (1..rows).any(|row| column.text(row) != column.text(0)))
        .collect();
    let mut varied: Vec<Varied> =
        several.iter().filter_map(|column| Varied::of(column, rows)).collect();
    let mut figures = Figures::default();
    if varied.is_empty() {
        figures.omitted.push("figures, since no varied value takes two numbers or more".to_owned());
        return figures;
    }
    // The value with most numbers becomes the axis; of equals the last, which runs fastest.
    varied.sort_by_key(|varied| varied.levels.len());
    for topic in &TOPICS {
        let found: Vec<(&str, &TableColumn)> = topic
            .columns
            .iter()
            .filter_map(|(column, name)| Some((*name, sweep.table.column(column)?)))
            .filter(|(_, column)| (0..rows).any(|row| column.number(row).is_finite()))
            .collect();
        let [(_, first), ..] = found[..] else { continue };
        match (&varied[..], several.len()) {
            ([one], 1) => figures.add(Ok(over_one(topic, one, &found))),
            ([other, one], 2) => figures.add(Ok(over_two(topic, [one, other], first))),
            ([.., x], _) => figures.add(over_many(topic, x, &several, first)),
            ([], _) => {}
        }
    }
    if figures.drawn.is_empty() && figures.omitted.is_empty() {
        figures.omitted.push("figures, since no case has a number".to_owned());
    }
    figures
}

/// A line's name and its points.
type Line = (String, Vec<(f64, f64)>);

fn figure(topic: &Topic, x: &Varied, lines: Vec<Line>) -> Figure {
    let curve = |(k, (name, mut points)): (usize, Line)| {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curve { name, stroke: Stroke::Dotted(k + 1), points }
    };
    let curves = lines.into_iter().enumerate().map(curve).collect();
    let caption = topic.caption.to_owned();
    Figure::of_curves(topic.id, topic.title, caption, x.axis(0.03), topic.quantity, curves)
}

/// A line for each column.
fn over_one(topic: &Topic, x: &Varied, columns: &[(&str, &TableColumn)]) -> Figure {
    let line = |(name, column): &(&str, &TableColumn)| {
        let points = x.values.iter().enumerate().map(|(row, x)| (*x, column.number(row)));
        ((*name).to_owned(), points.collect())
    };
    figure(topic, x, columns.iter().map(line).collect())
}

/// Columns and rows of a heat map: enough for fields of uneven width.
pub(super) const FINE: (usize, usize) = (480, 160);

/// A heat map; the field of a case reaches half way to its neighbours.
fn over_two(topic: &Topic, [x, y]: [&Varied; 2], column: &TableColumn) -> Figure {
    let place = |varied: &Varied, case: usize| {
        varied.levels.iter().position(|level| level.total_cmp(&varied.values[case]).is_eq())
    };
    let mut found = vec![vec![f64::NAN; x.levels.len()]; y.levels.len()];
    for case in 0..x.values.len() {
        if let (Some(i), Some(j)) = (place(x, case), place(y, case)) {
            found[j][i] = column.number(case);
        }
    }
    let (columns, rows) = (fields(x, FINE.0), fields(y, FINE.1));
    let row = |j: &usize| columns.iter().map(|i| found[*j][*i]).collect();
    let map = ColourMap {
        name: topic.quantity.0.to_owned(),
        unit: topic.quantity.1.to_owned(),
        colours: Colours::Sequential,
        rows: rows.iter().map(row).collect(),
    };
    let title = format!("{}, over two values", topic.title);
    let caption = format!("{} Each field is a case; white where there is none.", topic.caption);
    let figure = Figure::new(topic.id, &title, caption, field_axis(x), field_axis(y));
    Figure { map: Some(map), ..figure }
}

/// The axis of a heat map reaches half a field beyond the first and the last level.
fn field_axis(varied: &Varied) -> Axis {
    let axis = varied.axis(0.5 / (varied.levels.len() - 1) as f64);
    let places = if varied.levels.len() <= MOST_TICKS { varied.levels.clone() } else { vec![] };
    Axis { places, ..axis }
}

/// Number of the level nearest to each of `count` even places along the axis of a heat map.
fn fields(varied: &Varied, count: usize) -> Vec<usize> {
    let axis = field_axis(varied);
    let levels: Vec<f64> = varied.levels.iter().map(|level| axis.share(*level)).collect();
    let nearest = |k: usize| {
        let at = (k as f64 + 0.5) / count as f64;
        let next = levels.partition_point(|level| *level < at).clamp(1, levels.len() - 1);
        if at - levels[next - 1] < levels[next] - at { next - 1 } else { next }
    };
    (0..count).map(nearest).collect()
}

/// A line for each combination of the other values.
fn over_many(
    topic: &Topic,
    x: &Varied,
    several: &[&TableColumn],
    column: &TableColumn,
) -> Result<Figure, String> {
    let name = |row: usize| {
        let others = several.iter().filter(|other| other.name() != x.name);
        let value = |other: &&TableColumn| format!("{} = {}", other.name(), other.text(row));
        others.map(value).collect::<Vec<_>>().join(", ")
    };
    let mut lines: Vec<Line> = Vec::new();
    for row in 0..x.values.len() {
        let (name, point) = (name(row), (x.values[row], column.number(row)));
        match lines.iter_mut().find(|(other, _)| *other == name) {
            Some((_, points)) => points.push(point),
            None => lines.push((name, vec![point])),
        }
    }
    if lines.len() > MOST_LINES {
        return Err(format!(
            "{}, since {} lines over {} are more than a figure holds: sweep fewer values at a time",
            topic.title,
            lines.len(),
            x.name
        ));
    }
    Ok(figure(topic, x, lines))
}

/// What a figure shows of each case.
struct Topic {
    id: &'static str,
    title: &'static str,
    /// Name and unit of the y axis.
    quantity: (&'static str, &'static str),
    /// Columns of the table, each with its name in the legend.
    columns: &'static [(&'static str, &'static str)],
    caption: &'static str,
}

/// All topics, in the order of the page.
const TOPICS: [Topic; 8] = [
    Topic {
        id: "torque-ratio",
        title: "Peak torque, flexible over rigid",
        quantity: ("ratio", ""),
        columns: &[("torque_ratio", "ratio")],
        caption: "Peak torque of the flexible link over that of the rigid one. It tends to 1 where the \
                  link is stiff for this motion.",
    },
    Topic {
        id: "lead",
        title: "Lead",
        quantity: ("lead", "s"),
        columns: &[("lead_s", "lead")],
        caption: "How long before the tip moves the torque begins, at the 2 % level.",
    },
    Topic {
        id: "lag",
        title: "Lag",
        quantity: ("lag", "s"),
        columns: &[("lag_s", "lag")],
        caption: "How long the torque goes on after the tip has stopped, at the 2 % level.",
    },
    Topic {
        id: "peak-torque",
        title: "Peak torque",
        quantity: ("torque", "N m"),
        columns: &[("peak_torque_n_m", "flexible link"), ("peak_rigid_torque_n_m", "rigid link")],
        caption: "Largest torque at the hub.",
    },
    Topic {
        id: "peak-motor-torque",
        title: "Peak torque of the motor",
        quantity: ("torque", "N m"),
        columns: &[("peak_motor_torque_n_m", "motor")],
        caption: "Largest torque of the motor, on its own side of the gear.",
    },
    Topic {
        id: "residual",
        title: "Vibration left behind",
        quantity: ("amplitude", "m"),
        columns: &[("residual_m", "residual")],
        caption: "How far the tip vibrates after the torque's last sample.",
    },
    Topic {
        id: "tip-error",
        title: "Error of the tip",
        quantity: ("error", "m"),
        columns: &[("tip_error_m", "largest error")],
        caption: "How far the tip strays from the wanted motion, at most.",
    },
    Topic {
        id: "deflection",
        title: "Peak deflection",
        quantity: ("deflection", "m"),
        columns: &[("peak_deflection_m", "tip")],
        caption: "Largest deflection of the tip from the hub's tangent line.",
    },
];

/// Most rows of the table.
const MOST_CASES: usize = 200;

pub(super) fn sweep_page(sweep: &StoredSweep, figures: &Figures) -> Markup {
    let cases = sweep.table.lines.len();
    let varied: Vec<&str> = sweep.table.names().take(sweep.varied).collect();
    let title = format!("Sweep over {}", varied.join(" and "));
    let origin = html! {
        @if let Some(origin) = &sweep.origin { (made_by(origin)) " · " }
        (sweep.name) " · " (cases) @if cases == 1 { " case" } @else { " cases" }
    };
    let mut sections = Vec::new();
    let kinds = kinds_of_warnings(sweep);
    if !kinds.is_empty() {
        sections.push(Section::warnings(warnings(&kinds, cases)));
    }
    sections.push(figures_section(figures, ""));
    sections.push(Section::new("cases", "Cases", cases_table(sweep)));
    sections.extend(sweep.origin.as_ref().map(inputs));
    document(&title, &origin, &sections, FILES, None)
}

/// Kinds of warnings, each with the number of its cases and the row of the first, from 1.
fn kinds_of_warnings(sweep: &StoredSweep) -> Vec<(String, usize, usize)> {
    let mut kinds: Vec<(String, usize, usize)> = Vec::new();
    let [.., warnings, error] = &sweep.table.columns[..] else { return kinds };
    for row in 0..sweep.table.lines.len() {
        let failed = (!error.text(row).is_empty()).then_some("failed");
        let warnings = warnings.text(row);
        let warnings = warnings.split(';').filter(|kind| !kind.is_empty());
        for kind in failed.into_iter().chain(warnings) {
            match kinds.iter_mut().find(|(known, ..)| known == kind) {
                Some((_, cases, _)) => *cases += 1,
                None => kinds.push((kind.to_owned(), 1, row + 1)),
            }
        }
    }
    kinds
}

fn warnings(kinds: &[(String, usize, usize)], cases: usize) -> Markup {
    html! {
        ul { @for (kind, count, first) in kinds {
            li {
                strong { (kind) } " "
                span class="hint" { (count) " of " (cases) " cases, the first is row " (first) "." }
            }
        } }
    }
}

fn cases_table(sweep: &StoredSweep) -> Markup {
    let cases = sweep.table.lines.len();
    let shown = cases.min(MOST_CASES);
    let cell = |column: usize, row: usize| match sweep.table.columns[column].cell(row) {
        Cell::Number(number) if column < sweep.varied => format!("{number}"),
        Cell::Number(number) => significant(number, 5),
        Cell::Word(word) => word.to_owned(),
    };
    let head: Vec<&str> = sweep.table.names().collect();
    let rows = html! {
        @for row in 0..shown { tr { @for column in 0..head.len() { td { (cell(column, row)) } } } }
    };
    html! {
        p {
            "The column " code { "warnings" } " holds the kinds of the warnings; their full text is in \
             summary.json of the case, which " code { "sweep --outputs" } " writes."
            @if sweep.origin.is_none() {
                " No record lies beside the table, so link, motion and arguments are not known."
            }
        }
        @if shown < cases {
            p { "The first " (shown) " of " (cases) "; " (sweep.name) " holds all." }
        }
        (table(&head, &rows))
    }
}
