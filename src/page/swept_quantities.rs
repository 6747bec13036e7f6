//! Quantities of the cases of a sweep, with their limits: one for each figure.

use std::borrow::Cow;
use std::fmt::Write as _;

use super::joint::formula_of_limit;
use super::words;
use crate::compare::TableColumn;
use crate::link::{Joint, MOST_LINKS};
use crate::result::{Exceeded, JointQuantity, QUANTITIES, StoredSweep};
use crate::sweep::column_of_carriage;
use crate::text::given;

/// One figure: a quantity of the cases.
pub(super) struct Drawn {
    pub(super) id: String,
    pub(super) title: String,
    pub(super) caption: String,
    pub(super) formula: Cow<'static, str>,
    /// Name and unit.
    pub(super) quantity: (String, String),
    /// Lines by the names of the legend, with a number per case; empty for a limited quantity without a column. A figure
    /// over several values has the first alone.
    pub(super) lines: Vec<(String, Vec<f64>)>,
    /// The limit, unless it is varied.
    pub(super) limit: Option<f64>,
    /// The limit of each case, NaN where the table does not tell, and whether it is varied.
    limits: Vec<f64>,
    is_varied: bool,
    /// Whether a case exceeds the limit, which has a warning.
    pub(super) exceeded: Vec<bool>,
    /// Number of cases without numbers.
    pub(super) failed: usize,
    /// Names of the limits that bind in some case, and the number of the binding one in each case.
    pub(super) binding: Option<(Vec<String>, Vec<f64>)>,
}

/// Whose numbers a figure shows.
#[derive(Clone, Copy, PartialEq)]
enum Of {
    /// A single link.
    Link,
    /// A joint of an arm, by its number from 1.
    Joint(usize),
    /// The carriage of an arm.
    Carriage,
}

/// A quantity of plays alone: column, id, title, axis, caption, formula.
const OF_PLAYS: [[&str; 6]; 2] = [
    [
        "tip_error_m",
        "tip-error",
        "Error of the tip",
        "error",
        "Largest distance of the tip from the wanted motion.",
        "max |v(t) − v_wanted(t)|.",
    ],
    [
        "residual_m",
        "residual",
        "Vibration left behind",
        "amplitude",
        "Amplitude of the tip's vibration after the torque's last sample.",
        "max |v(t) − mean of v| after the last sample of the torque.",
    ],
];

/// Quantities in the order of a page: nearness to the limits, or the reason why it is missing, then peaks, then ratio, lead
/// and lag. `is_single` is true for one varied value, whose figure has a line for each limit.
pub(super) fn drawn_quantities(
    sweep: &StoredSweep,
    is_single: bool,
) -> (Vec<Drawn>, Option<String>) {
    let table = &sweep.table;
    let has = |of: Of| QUANTITIES.iter().any(|own| column(sweep, of, own).is_some());
    let joints = (1..=MOST_LINKS).take_while(|joint| has(Of::Joint(*joint))).count();
    let mut all: Vec<Of> = (1..=joints).map(Of::Joint).collect();
    all.push(if joints == 0 { Of::Link } else { Of::Carriage });
    let is_peak = |own: &&JointQuantity| own.limit_key().is_some();
    let peaks = QUANTITIES.iter().filter(is_peak);
    let others = QUANTITIES.iter().filter(|own| !is_peak(own) && own.name != RIGID);
    let order = peaks.chain(others);
    let of_joints = order.flat_map(|own| all.iter().filter_map(move |of| drawn(sweep, *of, own)));
    let of_plays = OF_PLAYS.iter().filter_map(|[name, id, title, axis, caption, formula]| {
        let numbers = numbers(table.column(name)?, table.lines.len())?;
        Some(Drawn {
            id: (*id).to_owned(),
            title: (*title).to_owned(),
            caption: (*caption).to_owned(),
            formula: (*formula).into(),
            quantity: ((*axis).to_owned(), "m".to_owned()),
            lines: vec![((*axis).to_owned(), numbers)],
            limit: None,
            limits: vec![f64::NAN; table.lines.len()],
            is_varied: false,
            exceeded: vec![false; table.lines.len()],
            failed: failed(sweep),
            binding: None,
        })
    });
    let drawn: Vec<Drawn> = of_plays.chain(of_joints).collect();
    match feasible(&drawn, table.lines.len(), is_single) {
        None => (drawn, None),
        Some(Ok(feasible)) => (std::iter::once(feasible).chain(drawn).collect(), None),
        Some(Err(why)) => (drawn, Some(why)),
    }
}

/// Number of cases that failed.
fn failed(sweep: &StoredSweep) -> usize {
    let error = sweep.table.column("error");
    error.map_or(0, |own| {
        (0..sweep.table.lines.len()).filter(|row| !own.text(*row).is_empty()).count()
    })
}

/// How many cases exceed a limit.
fn over_words(exceeded: &[bool], failed: usize, what: &str) -> String {
    let over = exceeded.iter().filter(|own| **own).count();
    if failed == 0 {
        return format!(" {over} of {} cases exceed {what}.", exceeded.len());
    }
    let solved = exceeded.len() - failed;
    format!(" {over} of {solved} solved cases exceed {what}; {failed} failed.")
}

/// Whether the torques of all cases start from a value at rest that may differ from 0; `None` where that is not known.
pub(super) fn from_rest(sweep: &StoredSweep) -> Option<bool> {
    let is_varied =
        sweep.table.names().take(sweep.units.len()).any(|name| name.starts_with("gravity"));
    match &sweep.links[..] {
        [] => None,
        [link] => Some(link.has_weight()).filter(|_| !is_varied),
        _ => Some(true),
    }
}

/// Quantity that stands in the figure of the torque.
const RIGID: &str = "peak_rigid_torque";

/// Quantities with a figure if they have a limit.
const ON_LIMIT: [&str; 5] =
    ["rms_torque", "rms_power", "rms_motor_torque", "peak_hub_angle", "peak_hub_acceleration"];

/// Column of a quantity in the table.
fn column<'a>(sweep: &'a StoredSweep, of: Of, own: &JointQuantity) -> Option<&'a TableColumn> {
    let of_hub = own.column(None);
    match of {
        // A link has the columns of its joint.
        Of::Link => {
            let column = sweep.table.column(&of_hub);
            column.or_else(|| sweep.table.column(&Joint::CARRIAGE.named(&of_hub)))
        }
        Of::Joint(joint) => sweep.table.column(&own.column(Some(joint))),
        Of::Carriage => sweep.table.column(&column_of_carriage(&of_hub)),
    }
}

/// A number per case; `None` without numbers.
fn numbers(column: &TableColumn, cases: usize) -> Option<Vec<f64>> {
    let numbers: Vec<f64> = (0..cases).map(|row| column.number(row)).collect();
    numbers.iter().any(|number| number.is_finite()).then_some(numbers)
}

/// Whether a single link slides on a carriage.
fn slides(sweep: &StoredSweep) -> bool {
    let named = |name: &str| sweep.table.column(name).is_some();
    named("peak_carriage_speed_m_s") || named("peak_force_n")
}

/// The figure of a quantity; `None` for one without numbers, unless it exceeds its limit, and for one without a limit that
/// only a limit brings in.
fn drawn(sweep: &StoredSweep, of: Of, own: &JointQuantity) -> Option<Drawn> {
    let cases = sweep.table.lines.len();
    let on_carriage = of == Of::Carriage || of == Of::Link && slides(sweep);
    let worded = |text: &str| {
        if !on_carriage || own.keeps_words() {
            return text.to_owned();
        }
        let symbols = ["T(", "|T|", "T_rigid", "max T", "min T"];
        let text = symbols
            .iter()
            .fold(text.to_owned(), |text, own| text.replace(own, &own.replace('T', "F")));
        let text =
            text.replace(", an angle per time squared", "").replace(", an angle per time", "");
        Joint::CARRIAGE.worded(&text)
    };
    let (limit, is_varied, limits, exceeded) = limit(sweep, of, own);
    let numbers = column(sweep, of, own).and_then(|column| numbers(column, cases));
    if numbers.is_none() && !exceeded.contains(&true) {
        return None;
    }
    let has_limit = limits.iter().any(|own| own.is_finite()) || exceeded.contains(&true);
    if ON_LIMIT.contains(&own.name) && !has_limit {
        return None;
    }
    let words = own.name.replace('_', " ").replace("rms", "RMS");
    let words = match of {
        Of::Joint(_) => words.replace("hub ", ""),
        Of::Link | Of::Carriage => worded(&words),
    };
    let axis = words.rsplit(' ').next().unwrap_or_default().to_owned();
    let title = words[..1].to_uppercase() + &words[1..];
    let id = own.name.replace('_', "-");
    let (id, title) = match of {
        Of::Link => (id, title),
        Of::Joint(joint) => (format!("{id}-joint-{joint}"), format!("{title}, joint {joint}")),
        Of::Carriage if title.contains("carriage") => (format!("{id}-carriage"), title),
        Of::Carriage => (format!("{id}-carriage"), format!("{title}, carriage")),
    };
    let unit = worded(own.unit.text);
    let mut caption = match (of, own.of_motor) {
        (Of::Joint(_), _) if own.name == "peak_deflection" => {
            "Peak deflection of the link's outer end from the tangent line at its root.".to_owned()
        }
        // The rest of the sentence names keys of the motor.
        (_, Some(_)) => format!("{}.", own.what.split([';', '.']).next().unwrap_or_default()),
        _ => own.what.replace("link or arm", if of == Of::Link { "link" } else { "arm" }),
    };
    if numbers.iter().flatten().any(|number| *number < 0.0) {
        caption += match own.name {
            "lead" => " Below 0 the torque begins after the tip has set out.",
            "lag" => " Below 0 the torque ends before the tip stops.",
            _ => "",
        };
    }
    caption = match of {
        Of::Joint(_) => caption.replace("the hub", "the joint"),
        Of::Link | Of::Carriage => worded(&caption),
    };
    if is_varied {
        caption += " Its limit is among the varied values, so that no line shows it.";
    }
    let failed = failed(sweep);
    if exceeded.contains(&true) {
        caption += &over_words(&exceeded, failed, "the limit");
    }
    let mut lines: Vec<_> = numbers.into_iter().map(|own| (axis.clone(), own)).collect();
    if own.name == "peak_torque" && !lines.is_empty() {
        let rigid = QUANTITIES.iter().find(|own| own.name == RIGID);
        let rigid = rigid.and_then(|own| self::numbers(column(sweep, of, own)?, cases));
        if let Some(rigid) = rigid {
            "flexible".clone_into(&mut lines[0].0);
            lines.push(("rigid".to_owned(), rigid));
        }
    }
    let (kind, from_rest) = match of {
        Of::Link if on_carriage => (words::Of::Carriage, from_rest(sweep)),
        Of::Link => (words::Of::Hub, from_rest(sweep)),
        Of::Joint(_) => (words::Of::Joint, Some(true)),
        Of::Carriage => (words::Of::Carriage, Some(true)),
    };
    let formula = worded(&formula(own, kind, from_rest)).into();
    let quantity = (axis, unit);
    let binding = None;
    Some(Drawn {
        id,
        title,
        caption,
        formula,
        quantity,
        lines,
        limit,
        limits,
        is_varied,
        exceeded,
        failed,
        binding,
    })
}

/// Formula of a quantity; `from_rest` as in [`words::acts`].
fn formula(own: &JointQuantity, kind: words::Of, from_rest: Option<bool>) -> String {
    let acts = |end: &str| {
        let (peak, range) =
            ("|T(t)| > 0.02 max |T|", format!("|T(t) − T({end})| > 0.02 (max T − min T)"));
        match from_rest {
            Some(true) => range,
            Some(false) => peak.to_owned(),
            None => format!("{peak}, or under gravity {range},"),
        }
    };
    match own.name {
        "peak_torque" => "max |T(t)|.".to_owned(),
        "torque_ratio" => {
            "max |T(t)| / max |T_rigid(t)|. It tends to 1 where bending is small.".to_owned()
        }
        "lead" => format!(
            "The start of the tip's motion less the first t with {}.",
            acts("start").trim_end_matches(',')
        ),
        "lag" => format!("The last t with {} less the end of the tip's motion.", acts("end")),
        name => {
            let formula = own.limit_key().and_then(|key| formula_of_limit(key, kind));
            let what = if name.starts_with("rms") { "Root mean square" } else { "Largest size" };
            format!("{what} over time. {}", formula.unwrap_or_default())
        }
    }
}

/// Limit of a quantity unless it is varied, whether it is varied, the limit of each case, NaN where the table does not tell
/// it, and whether each case exceeds it.
fn limit(
    sweep: &StoredSweep,
    of: Of,
    own: &JointQuantity,
) -> (Option<f64>, bool, Vec<f64>, Vec<bool>) {
    let cases = sweep.table.lines.len();
    let Some(key) = own.limit_key() else {
        return (None, false, vec![f64::NAN; cases], vec![false; cases]);
    };
    let of_carriage = Joint::CARRIAGE.named(key);
    let (kinds, number) = match of {
        Of::Link => (vec![key.to_owned(), of_carriage.clone()], 0),
        Of::Joint(joint) => (vec![format!("joint{joint}.{key}")], joint - 1),
        Of::Carriage => (vec![format!("carriage.{of_carriage}")], sweep.limits.len().max(1) - 1),
    };
    let kinds: Vec<String> = kinds.iter().map(|own| format!("{}:{own}", Exceeded::KIND)).collect();
    let is_over = |row: usize| {
        let warnings = sweep.table.column("warnings").map(|column| column.text(row));
        let warnings = warnings.unwrap_or_default();
        warnings.split(';').any(|kind| kinds.iter().any(|own| own == kind))
    };
    let is_key = |name: &str| name == key || name == of_carriage;
    let is_of_limit = |column: &&TableColumn| {
        let path = column.name().split(" [").next().unwrap_or_default();
        let mut path =
            path.trim_end_matches(['*', '+']).split('.').skip_while(|part| *part != "limits");
        path.next().is_some() && path.next().is_none_or(is_key)
    };
    let varied = sweep.table.columns.iter().take(sweep.units.len()).filter(is_of_limit);
    let varied: Vec<&TableColumn> = varied.collect();
    let limit = sweep.limits.get(number).and_then(|limits| limits.of(key));
    let of_case = |row: usize| match (&varied[..], limit) {
        ([], limit) => limit.unwrap_or(f64::NAN),
        // The table does not tell which link of an arm a key names.
        ([column], _) if matches!(of, Of::Joint(_)) && !column.name().starts_with("links.*.") => {
            f64::NAN
        }
        ([column], limit) => {
            let (first, value) = (column.number(0), column.number(row));
            // The limits are those of the first case; factors and other units share its ratio.
            match (column.name().chars().last(), limit.unwrap_or(f64::NAN)) {
                (Some('*' | ']'), limit) => limit * value / first,
                _ => value,
            }
        }
        _ => f64::NAN,
    };
    let limits = (0..cases).map(of_case).collect();
    let is_varied = !varied.is_empty();
    (limit.filter(|_| !is_varied), is_varied, limits, (0..cases).map(is_over).collect())
}

impl Drawn {
    /// Name of the cases over the limit.
    pub(super) fn over_words(&self) -> String {
        let unit = &self.quantity.1;
        match self.limit {
            Some(_) if self.binding.is_some() => "over a limit".to_owned(),
            Some(limit) => format!("over the limit {} {unit}", given(limit)).trim_end().to_owned(),
            None => "over the limit".to_owned(),
        }
    }

    /// Value of a case over its limit, NaN if one of them is not known.
    fn share(&self, case: usize) -> f64 {
        self.lines.first().map_or(f64::NAN, |line| line.1[case] / self.limits[case])
    }
}

/// Largest number of limits with a colour.
const MOST_KINDS: usize = 6;

/// Nearness to all limits: the largest value over its limit, and its limit, in each case; a reason where no case has it.
/// `None` without limits.
fn feasible(drawn: &[Drawn], cases: usize, is_single: bool) -> Option<Result<Drawn, String>> {
    let is_known = |own: &Drawn| own.limits.iter().any(|limit| limit.is_finite());
    let has_limit = |own: &&Drawn| is_known(own) || own.is_varied || own.exceeded.contains(&true);
    let limited: Vec<&Drawn> = drawn.iter().filter(has_limit).collect();
    let shares: Vec<Vec<f64>> =
        limited.iter().map(|own| (0..cases).map(|case| own.share(case)).collect()).collect();
    let binding = |case: usize| {
        let known = (0..limited.len()).filter(|own| !shares[*own][case].is_nan());
        known.max_by(|a, b| shares[*a][case].total_cmp(&shares[*b][case]))
    };
    let bound: Vec<Option<usize>> = (0..cases).map(binding).collect();
    let times = |own: usize| bound.iter().filter(|bound| **bound == Some(own)).count();
    let mut order: Vec<usize> = (0..limited.len()).filter(|own| times(*own) > 0).collect();
    order.sort_by_key(|own| std::cmp::Reverse(times(*own)));
    let name = |own: &usize| {
        let title = limited[*own].title.trim_start_matches("Peak ");
        title[..1].to_lowercase() + &title[1..]
    };
    let unknown = |own: &usize| shares[*own].iter().all(|share| share.is_nan());
    let unknown: Vec<String> = (0..limited.len()).filter(unknown).map(|own| name(&own)).collect();
    let unknown = unknown.join(", ");
    // Over one value the figure of the one limited quantity says the same.
    if limited.is_empty() || is_single && limited.len() < 2 {
        return None;
    }
    if order.is_empty() {
        let why = "since the table does not have both the value and its limit in each case";
        return Some(Err(format!("Feasible, the nearness to the limits of {unknown}, {why}")));
    }
    let mut names: Vec<String> = order.iter().map(name).collect();
    if names.len() > MOST_KINDS {
        names.truncate(MOST_KINDS - 1);
        names.push("others".to_owned());
    }
    let kind = |bound: &Option<usize>| {
        let place = order.iter().position(|own| Some(*own) == *bound);
        place.map_or(f64::NAN, |place| place.min(MOST_KINDS - 1) as f64)
    };
    let kinds: Vec<f64> = bound.iter().map(kind).collect();
    let exceeded: Vec<bool> =
        (0..cases).map(|case| limited.iter().any(|own| own.exceeded[case])).collect();
    let failed = drawn[0].failed;
    let most = order.iter().map(|own| format!("{} in {}", name(own), times(*own)));
    let most = most.collect::<Vec<_>>().join(", ");
    let mut caption = format!(
        "Each peak over its limit: at most 1 where all limits hold.{} Nearest to its limit, or farthest beyond it: \
         {most}.",
        over_words(&exceeded, failed, "a limit")
    );
    if !unknown.is_empty() {
        // Writing to a string cannot fail.
        let _ = write!(caption, " Hatched where it is exceeded, but without a number: {unknown}.");
    }
    let largest = |case: usize| bound[case].map_or(f64::NAN, |own| shares[own][case]);
    let lines = if is_single {
        let line = |(own, shares): (usize, &Vec<f64>)| (name(&own), shares.clone());
        shares.iter().enumerate().map(line).collect()
    } else {
        vec![("share of the limit".to_owned(), (0..cases).map(largest).collect())]
    };
    Some(Ok(Drawn {
        id: "feasible".to_owned(),
        title: "Feasible".to_owned(),
        caption,
        formula: "max |value| / limit, of each quantity with a limit.".into(),
        quantity: ("share of the limit".to_owned(), String::new()),
        lines,
        limit: Some(1.0),
        limits: vec![1.0; cases],
        is_varied: false,
        exceeded,
        failed,
        binding: Some((names, kinds)),
    }))
}
