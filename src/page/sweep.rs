//! Figures of a sweep, results over the varied values, and its page.

use std::collections::HashSet;

use maud::{Markup, html};

use super::axis::{Axis, in_unit, raised};
use super::colour_map::{ColourMap, Colours, Fields};
use super::document::{FILES, Section, all_figures, document, inputs, made_by};
use super::figure::{Curve, Figure, Figures, Stroke};
use super::link::{link_drawing, link_readings};
use super::tables::{readings, table};
use super::view::nearest;
use super::words::{GLOSSARY, warning_meaning};
use crate::compare::{Cell, Table, TableColumn};
use crate::link::{Joint, Link};
use crate::result::StoredSweep;
use crate::sweep::column_of_carriage;
use crate::text::significant;

/// Largest number of lines in a figure; more cannot be distinguished.
const MOST_LINES: usize = 6;

/// Largest number of levels of a heat map with a tick for each.
const MOST_TICKS: usize = 12;

/// Ratio of the largest to the smallest value above which an axis is logarithmic.
const WIDE: f64 = 100.0;

/// Ratio above which an axis of values at equal factors is logarithmic, and the relative tolerance of these factors.
const WIDE_IN_STEPS: f64 = 2.0;
const SAME_STEP: f64 = 0.02;

/// A column of varied values with its name and unit.
struct Named<'a> {
    column: &'a TableColumn,
    name: String,
    unit: String,
}

impl<'a> Named<'a> {
    /// Columns of all varied values.
    fn all(sweep: &'a StoredSweep) -> Vec<Self> {
        let columns = sweep.table.columns.iter().zip(&sweep.units);
        columns.map(|(column, unit)| Self::of(column, unit)).collect()
    }

    /// A heading may contain a unit: `segments.beam.I [cm^4]`. The numbers of others are in SI.
    fn of(column: &'a TableColumn, si: &str) -> Self {
        let given = column.name().strip_suffix(']').and_then(|heading| heading.split_once(" ["));
        let (name, unit) = given.unwrap_or((column.name(), si));
        Self { column, name: name.to_owned(), unit: raised(unit) }
    }

    /// Name and unit: `payload.mass in kg`.
    fn heading(&self) -> String {
        let is_text = self.column.number(0).is_nan();
        in_unit(&self.name, if is_text { "" } else { &self.unit })
    }

    /// A value of a case: `payload.mass = 0.05 kg`.
    fn value_words(&self, row: usize) -> String {
        // A text contains its unit.
        let unit = if self.column.number(row).is_finite() { &self.unit[..] } else { "" };
        format!("{} = {} {unit}", self.name, self.column.text(row)).trim_end().to_owned()
    }
}

/// A varied value: its heading, and one number per case.
struct Varied<'a> {
    named: &'a Named<'a>,
    values: Vec<f64>,
    /// Distinct numbers, ascending.
    levels: Vec<f64>,
}

impl<'a> Varied<'a> {
    fn of(named: &'a Named<'a>, rows: usize) -> Option<Self> {
        let values: Vec<f64> = (0..rows).map(|row| named.column.number(row)).collect();
        let mut levels = values.clone();
        levels.sort_by(f64::total_cmp);
        levels.dedup_by(|a, b| a.total_cmp(b).is_eq());
        let all = levels.iter().all(|value| value.is_finite()) && levels.len() > 1;
        all.then_some(Self { named, values, levels })
    }

    /// Axis of the value; `margin` is relative to the range of its values.
    fn axis(&self, margin: f64) -> Axis {
        let (low, high) = (self.levels[0], self.levels[self.levels.len() - 1]);
        let (name, unit) = (&self.named.name, &self.named.unit);
        if self.is_wide() {
            let factor = libm::pow(high / low, margin);
            Axis::logarithmic(name, unit, low / factor..high * factor)
        } else {
            let more = margin * (high - low);
            Axis::linear(name, unit, low - more..high + more)
        }
    }

    /// True if the values span decades, or have equal factors between them.
    fn is_wide(&self) -> bool {
        let (low, high) = (self.levels[0], self.levels[self.levels.len() - 1]);
        let steps = self.levels.windows(2).map(|pair| pair[1] / pair[0]);
        let first = self.levels[1] / low;
        let is_even = steps.into_iter().all(|step| (step / first - 1.0).abs() < SAME_STEP);
        let is_stepped = self.levels.len() > 2 && high / low > WIDE_IN_STEPS && is_even;
        low > 0.0 && (high / low > WIDE || is_stepped)
    }
}

/// Figures of a sweep.
pub(super) fn sweep_figures(sweep: &StoredSweep) -> Figures {
    let rows = sweep.table.lines.len();
    // Columns with several values: numbers for an axis, words for names of lines.
    let mut several = Named::all(sweep);
    several.retain(|own| (1..rows).any(|row| own.column.text(row) != own.column.text(0)));
    let mut varied: Vec<Varied> =
        several.iter().filter_map(|named| Varied::of(named, rows)).collect();
    let mut figures = Figures::default();
    if varied.is_empty() {
        figures.omitted.push("figures, since no varied value takes two numbers or more".to_owned());
        return figures;
    }
    // The value with the most numbers becomes the axis; of equals the last, which varies fastest.
    varied.sort_by_key(|varied| varied.levels.len());
    for drawn in TOPICS.iter().flat_map(|topic| topic.drawn(&sweep.table)) {
        match (&varied[..], several.len()) {
            ([one], 1) => figures.add(Ok(over_one(&drawn, one))),
            ([other, one], 2) => figures.add(Ok(over_two(&drawn, [one, other]))),
            ([.., x], _) => figures.add(over_many(&drawn, x, &several)),
            ([], _) => {}
        }
    }
    if figures.drawn.is_empty() && figures.omitted.is_empty() {
        figures.omitted.push("figures, since no case has a number".to_owned());
    }
    figures
}

/// Name and points of a line.
type Line = (String, Vec<(f64, f64)>);

fn figure(drawn: &Drawn, x: &Varied, lines: Vec<Line>) -> Figure {
    let curve = |(k, (name, mut points)): (usize, Line)| {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curve { name, stroke: Stroke::Dotted(k + 1), points }
    };
    let curves = lines.into_iter().enumerate().map(curve).collect();
    let Drawn { id, title, .. } = drawn;
    let [caption, name, unit, formula] = drawn.texts();
    Figure::of_curves(id.clone(), title, caption, x.axis(0.03), (&name, &unit), curves).by(formula)
}

/// A line for each column.
fn over_one(drawn: &Drawn, x: &Varied) -> Figure {
    let line = |(name, column): &(String, &TableColumn)| {
        let points = x.values.iter().enumerate().map(|(row, x)| (*x, column.number(row)));
        (name.clone(), points.collect())
    };
    figure(drawn, x, drawn.columns.iter().map(line).collect())
}

/// Columns and rows of a heat map: enough for fields of uneven width.
pub(super) const FINE: (usize, usize) = (480, 160);

/// A heat map of the first column; the field of a case extends half-way to its neighbours.
fn over_two(drawn: &Drawn, [x, y]: [&Varied; 2]) -> Figure {
    let ([caption, name, unit, formula], column) = (drawn.texts(), drawn.columns[0].1);
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
        name,
        unit,
        colours: Colours::Sequential,
        rows: rows.iter().map(row).collect(),
        fields: Some(Fields {
            places: [x.levels.clone(), y.levels.clone()],
            values: found.clone(),
        }),
    };
    let title = format!("{}, over two values", drawn.title);
    let caption =
        format!("{caption} Each field is a case; empty where there is none.{}", map.range_words());
    let figure = Figure::new(drawn.id.clone(), &title, caption, field_axis(x), field_axis(y));
    Figure { map: Some(map), ..figure }.by(formula)
}

/// Axis of a heat map, which extends half a field beyond the first and the last level.
fn field_axis(varied: &Varied) -> Axis {
    let axis = varied.axis(0.5 / (varied.levels.len() - 1) as f64);
    let places = if varied.levels.len() <= MOST_TICKS { varied.levels.clone() } else { vec![] };
    Axis { places, ..axis }
}

/// Number of the level nearest to each of `count` even places along the axis of a heat map.
fn fields(varied: &Varied, count: usize) -> Vec<usize> {
    let axis = field_axis(varied);
    let levels: Vec<f64> = varied.levels.iter().map(|level| axis.share(*level)).collect();
    (0..count).map(|k| nearest(&levels, (k as f64 + 0.5) / count as f64)).collect()
}

/// The first column: a line for each combination of the other values.
fn over_many(drawn: &Drawn, x: &Varied, several: &[Named]) -> Result<Figure, String> {
    let column = drawn.columns[0].1;
    let name = |row: usize| {
        let others = several.iter().filter(|other| !std::ptr::eq(*other, x.named));
        others.map(|other| other.value_words(row)).collect::<Vec<_>>().join(", ")
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
            drawn.title,
            lines.len(),
            x.named.name
        ));
    }
    Ok(figure(drawn, x, lines))
}

/// Quantity of each case in a figure.
struct Topic {
    id: &'static str,
    title: &'static str,
    /// Name and unit of the y axis.
    quantity: (&'static str, &'static str),
    /// Columns of the table, each with its name in the legend. For an arm the joint's number goes between the two parts
    /// of the column's name.
    columns: &'static [([&'static str; 2], &'static str)],
    caption: &'static str,
    formula: &'static str,
}

/// One figure of a topic.
struct Drawn<'a> {
    topic: &'static Topic,
    of: Of,
    id: String,
    title: String,
    /// Columns of the table, each with its name in the legend.
    columns: Vec<(String, &'a TableColumn)>,
}

/// Whose numbers a figure shows.
#[derive(Clone, Copy, PartialEq)]
enum Of {
    /// A link, or the tip of an arm.
    Link,
    /// A joint of an arm, by its number from 1.
    Joint(usize),
    /// The carriage of an arm.
    Carriage,
}

/// A text on a hub in the words of a carriage.
fn on_carriage(text: &str) -> String {
    let symbols = ["T(", "|T|", "T_rigid", "max T", "min T"];
    let text =
        symbols.iter().fold(text.to_owned(), |text, own| text.replace(own, &own.replace('T', "F")));
    let text = text.replace(", or at the joint of an arm", "");
    Joint::CARRIAGE.worded(&text)
}

impl Drawn<'_> {
    /// Caption, name and unit of the y axis, and formula.
    fn texts(&self) -> [String; 4] {
        let Topic { caption, quantity: (name, unit), formula, .. } = self.topic;
        [caption, name, unit, formula].map(|text| match self.of {
            Of::Carriage => on_carriage(text),
            _ => (*text).to_owned(),
        })
    }
}

impl Topic {
    /// Figures of the topic: one for a link, one for each joint of an arm and for its carriage.
    fn drawn<'a>(&'static self, table: &'a Table) -> Vec<Drawn<'a>> {
        let of = |of: Of| -> Option<Drawn<'a>> {
            let column = |([quantity, unit], name): &([&str; 2], &str)| {
                let of_hub = format!("{quantity}{unit}");
                let column = match of {
                    // A link has the columns of its joint.
                    Of::Link => table
                        .column(&of_hub)
                        .or_else(|| table.column(&Joint::CARRIAGE.named(&of_hub))),
                    Of::Joint(joint) => table.column(&format!("{quantity}{joint}{unit}")),
                    Of::Carriage => table.column(&column_of_carriage(&of_hub)),
                }?;
                let has_number = (0..table.lines.len()).any(|row| column.number(row).is_finite());
                has_number.then(|| ((*name).to_owned(), column))
            };
            let columns: Vec<_> = self.columns.iter().filter_map(column).collect();
            let [id, title] = match of {
                Of::Link => [self.id, self.title].map(str::to_owned),
                Of::Joint(joint) => {
                    [format!("{}-joint-{joint}", self.id), format!("{}, joint {joint}", self.title)]
                }
                Of::Carriage => {
                    [format!("{}-carriage", self.id), on_carriage(self.title) + ", carriage"]
                }
            };
            (!columns.is_empty()).then_some(Drawn { topic: self, of, id, title, columns })
        };
        let mut drawn: Vec<_> = (1..).map_while(|joint| of(Of::Joint(joint))).collect();
        let whole = if drawn.is_empty() { Of::Link } else { Of::Carriage };
        drawn.extend(of(whole));
        drawn
    }
}

/// All topics, in the order of the page.
const TOPICS: [Topic; 8] = [
    Topic {
        id: "torque-ratio",
        title: "Peak torque, flexible over rigid",
        quantity: ("ratio", ""),
        columns: &[(["torque_ratio", ""], "ratio")],
        caption: "Peak torque of the flexible link over that of the rigid one. It tends to 1 where the \
                  link is stiff for this motion.",
        formula: "max |T(t)| / max |T_rigid(t)|.",
    },
    Topic {
        id: "lead",
        title: "Lead",
        quantity: ("lead", "s"),
        columns: &[(["lead", "_s"], "lead")],
        caption: "Time by which the torque begins before the tip moves, at the 2 % level.",
        formula: "Start of the tip's motion less the first t with |T(t)| > 0.02 max |T|; of an \
                  arm and under gravity with |T(t) − T(start)| > 0.02 (max T − min T).",
    },
    Topic {
        id: "lag",
        title: "Lag",
        quantity: ("lag", "s"),
        columns: &[(["lag", "_s"], "lag")],
        caption: "Time by which the torque outlasts the motion of the tip, at the 2 % level.",
        formula: "The last t with |T(t)| > 0.02 max |T| less the end of the tip's motion; of an \
                  arm and under gravity with |T(t) − T(end)| > 0.02 (max T − min T).",
    },
    Topic {
        id: "peak-torque",
        title: "Peak torque",
        quantity: ("torque", "N m"),
        columns: &[(["peak_torque", "_n_m"], "flexible"), (["peak_rigid_torque", "_n_m"], "rigid")],
        caption: "Largest torque at the hub, or at the joint of an arm.",
        formula: "max |T(t)|.",
    },
    Topic {
        id: "peak-motor-torque",
        title: "Peak torque of the motor",
        quantity: ("torque", "N m"),
        columns: &[(["peak_motor_torque", "_n_m"], "motor")],
        caption: "Largest torque of the motor, on its own side of the gear.",
        formula: "max |T_m(t)|; T_m: torque of the hub and of the rotor's inertia, over the gear.",
    },
    Topic {
        id: "residual",
        title: "Vibration left behind",
        quantity: ("amplitude", "m"),
        columns: &[(["residual", "_m"], "residual")],
        caption: "Amplitude of the tip's vibration after the torque's last sample.",
        formula: "max |v(t) − mean of v| after the last sample of the torque.",
    },
    Topic {
        id: "tip-error",
        title: "Error of the tip",
        quantity: ("error", "m"),
        columns: &[(["tip_error", "_m"], "largest error")],
        caption: "Largest distance of the tip from the wanted motion.",
        formula: "max |v(t) − v_wanted(t)|.",
    },
    Topic {
        id: "deflection",
        title: "Peak deflection",
        quantity: ("deflection", "m"),
        columns: &[(["peak_deflection", "_m"], "tip")],
        caption: "Largest deflection of the tip from the hub's tangent line.",
        formula: "max |v(t) − L θ(t)|; of an arm, and of a link that bends far, the distance \
                  from the tangent line at the root.",
    },
];

/// Largest number of rows in the table of cases.
const MOST_CASES: usize = 200;

/// The page of a sweep, with its figures.
pub(super) fn sweep_page(sweep: &StoredSweep, figures: &Figures) -> Markup {
    let cases = sweep.table.lines.len();
    let varied: Vec<&str> = sweep.table.names().take(sweep.units.len()).collect();
    let link =
        sweep.origin.as_ref().map(|origin| origin.title.trim()).filter(|title| !title.is_empty());
    let title = format!(
        "{}Sweep over {}",
        link.map(|title| format!("{title}. ")).unwrap_or_default(),
        varied.join(" and ")
    );
    let origin = html! {
        @if let Some(origin) = &sweep.origin { (made_by(origin)) " · " }
        (sweep.name) " · " (cases) @if cases == 1 { " case" } @else { " cases" }
    };
    let mut sections = Vec::new();
    let kinds = kinds_of_warnings(sweep);
    if !kinds.is_empty() {
        sections.push(Section::warnings(warnings(&kinds, sweep)));
    }
    sections.push(all_figures(figures));
    sections.extend(
        (!sweep.links.is_empty()).then(|| Section::new("link", "Link", links(&sweep.links))),
    );
    sections.push(Section::glossary(&GLOSSARY));
    sections.push(Section::new("varied", "What is varied", varied_values(sweep)));
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

fn warnings(kinds: &[(String, usize, usize)], sweep: &StoredSweep) -> Markup {
    let cases = sweep.table.lines.len();
    let columns = Named::all(sweep);
    let values = |row: usize| {
        columns.iter().map(|column| column.value_words(row)).collect::<Vec<_>>().join(", ")
    };
    html! {
        ul { @for (kind, count, first) in kinds {
            li {
                strong { (kind.replace('_', " ").replace(':', ": ")) } " "
                span class="hint" {
                    (count) " of " (cases) " cases, the first is row " (first) ": " (values(first - 1)) "."
                    @if let Some(meaning) = warning_meaning(kind) { " " (meaning) }
                }
            }
        } }
    }
}

/// Link of the first case, or links of its arm.
fn links(links: &[Link]) -> Markup {
    html! {
        p { "As in the first case." }
        (links_drawn(links))
    }
}

/// A link or the links of an arm, in a drawing and in numbers.
pub(super) fn links_drawn(links: &[Link]) -> Markup {
    html! {
        @if let [link] = links { figure class="drawing" { (link_drawing(link)) } }
        div class="columns" { @for (k, link) in links.iter().enumerate() {
            (readings(&(if links.len() > 1 { format!("Link {}", k + 1) } else { "Link".to_owned() }), &link_readings(link)))
        } }
    }
}

/// Largest number of listed values in a row.
const MOST_VALUES: usize = 12;

/// The varied values, and the number of each.
fn varied_values(sweep: &StoredSweep) -> Markup {
    let row = |named: &Named| {
        let column = named.column;
        let (mut listed, mut seen) = (Vec::new(), HashSet::new());
        for row in 0..sweep.table.lines.len() {
            let text = column.text(row);
            if seen.insert(text.clone()) && listed.len() < MOST_VALUES {
                listed.push(text);
            }
        }
        let (listed, count) = (listed.join(", "), seen.len());
        let more =
            if count > MOST_VALUES { format!(", … ({count} values)") } else { String::new() };
        (named.heading(), listed + &more)
    };
    let rows: Vec<_> = Named::all(sweep).iter().map(row).collect();
    readings("Values", &rows)
}

fn cases_table(sweep: &StoredSweep) -> Markup {
    let cases = sweep.table.lines.len();
    let shown = cases.min(MOST_CASES);
    let cell = |column: usize, row: usize| match sweep.table.columns[column].cell(row) {
        Cell::Number(number) if column < sweep.units.len() => format!("{number}"),
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
                " The table has no record beside it, so link, motion and arguments are not known."
            }
        }
        @if shown < cases {
            p { "The first " (shown) " of " (cases) "; " (sweep.name) " holds all." }
        }
        (table(&head, &rows))
    }
}
