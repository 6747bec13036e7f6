//! The page of an arm: all its figures, those of bending among them, and the tables beside them.

use maud::{Markup, html};

use super::arm::{COLOURS, Shown, from_start_m, has_weight, run_stroke};
use super::arm_motion::Motion;
use super::axis::{Axis, is_extreme};
use super::bending::{TRUSTED, deflections, map, tip_deflection_m, with_colour};
use super::figure::{Curve, Figure, Figures, Stroke};
use super::limited::{MOTOR_TORQUE, figure};
use super::link::given;
use super::page::{FILES, Section, advice, animation, document, inputs, made_by, parted_figures};
use super::tables::{checks, link_readings, readings, results, table, words_and_unit};
use super::view::start_and_stop;
use super::words::formula;
use crate::numeric::largest;
use crate::result::{Notice, StoredArm};
use crate::text::significant;

/// All figures of an arm's runs.
pub(super) fn arm_figures(arms: &[StoredArm]) -> Figures {
    let shown = Shown::of(arms);
    let joints = 0..shown.first.joints.len();
    let mut figures = Figures::default();
    for joint in joints.clone() {
        figures.add(Ok(shown.torque(joint)));
        if let Some(motor) = shown.turning(joint, &MOTOR_TORQUE) {
            figures.add(Ok(motor));
        }
    }
    figures.add(Ok(shown.tip()));
    shown.strays().into_iter().for_each(|figure| figures.add(Ok(figure)));
    for joint in joints.clone() {
        figures.add(Ok(shown.angle(joint)));
        for figure in shown.limited(joint) {
            figures.add(Ok(figure));
        }
        shown.deflection(joint).into_iter().for_each(|figure| figures.add(figure));
    }
    figures.add(shown.bent_angles());
    joints.for_each(|link| figures.add(shown.waves(link)));
    figures.add(shown.root_moments());
    figures
}

impl Shown<'_> {
    /// Waves along a link: the bending moment, or the deflection where it was not written.
    fn waves(&self, link: usize) -> Result<Figure, String> {
        let arm = self.first;
        let own = &arm.links[link];
        let (name, unit, what, formula, mut nodes) = if let Some(moments) = own.moments_n_m.clone()
        {
            ("moment", "N m", "bending moment", formula::ARM_MOMENT, moments)
        } else {
            let what = "deflection from the chord";
            ("deflection", "m", what, formula::ARM_DEFLECTION, deflections(arm, link))
        };
        let words = format!("link {}{}", link + 1, self.name_of(link));
        if nodes.times_s.len() < 2 {
            return Err(format!("waves along {words}, since but one moment was written"));
        }
        if is_extreme(nodes.peak()) {
            let why = "since what bends is too large or too small to be drawn";
            return Err(format!("waves along {words}, {why}"));
        }
        for history in &mut nodes.histories {
            let rest = history[0];
            for value in history {
                *value -= rest;
            }
        }
        let peak = significant(nodes.peak(), 4);
        let rest = if has_weight(arm) { ", less what it is at rest at first," } else { "" };
        let caption = format!(
            "The {what}{rest} over time (to the right) and along the link (up, from its joint), below the tip's \
             distance from where it begins; it reaches {peak} {unit}. Colours go by the square root, so that weak waves \
             are seen too."
        );
        let tip =
            self.curve("tip from its start", Stroke::Solid(6), &arm.times_s, &from_start_m(arm));
        let above = Axis::around("tip", "m", tip.points.iter().map(|(_, value)| value));
        let (map, x) = map(self.span_s, &nodes, &own.nodes_m, (name, unit));
        let title = format!("Waves along {words}");
        let figure =
            Figure::new(format!("waves-{}", link + 1), &title, caption, self.time_axis(), x);
        let marks = arm.moving_s.map(start_and_stop).unwrap_or_default();
        Ok(Figure { map: Some(map), strip: Some((tip, above)), marks, ..figure }
            .by(with_colour(formula, name)))
    }

    /// Deflection of a link's tip from the tangent line at its root, where it has a limit.
    fn deflection(&self, link: usize) -> Option<Result<Figure, String>> {
        let joint = &self.first.joints[link];
        let limit = joint.limits.deflection_m?;
        let title = format!(
            "Deflection at the tip of link {}{}, estimated from its nodes",
            link + 1,
            self.name_of(link)
        );
        let caption = "From the tangent line at the link's root, at most {}.";
        let known = joint.reading("peak_deflection_m");
        let own = largest(&tip_deflection_m(self.first, link));
        if known.is_some_and(|peak| (own / peak - 1.0).abs() > TRUSTED) {
            return Some(Err(format!(
                "{title}, since too few rows were written for it: --every 1 writes all"
            )));
        }
        let curves = self.named("flexible arm").enumerate().map(|(run, (arm, name))| {
            let history = tip_deflection_m(arm, link);
            self.curve(&name, run_stroke(run), &arm.nodal_times_s, &history)
        });
        let (id, words) = (format!("tip-deflection-{}", link + 1), (&title[..], caption));
        let lines = (curves.collect(), Some(limit));
        let figure = figure(id, words, self.time_axis(), ("deflection", "m"), lines, known);
        Some(Ok(figure.by(formula::LINK_DEFLECTION)))
    }

    /// The bending moment at the root of each link.
    fn root_moments(&self) -> Result<Figure, String> {
        let mut curves = self.each(&self.numbered("link"), |arm, link| {
            let moments = arm.links[link].moments_n_m.as_ref()?;
            Some((&moments.times_s, moments.histories[0].clone()))
        });
        if curves.is_empty() {
            let why = if self.first.moving_s.is_some() {
                "they were not written: solve --moments writes them"
            } else {
                "a simulation does not write them"
            };
            return Err(format!("bending moments, since {why}"));
        }
        let mut caption =
            "Bending moment at the root of each link, where it is largest as a rule.".to_owned();
        for (link, joint) in self.first.joints.iter().enumerate() {
            let (whose, limit) = (format!("link {}:", link + 1), joint.limits.bending_moment_n_m);
            let colour = 1 + link % COLOURS;
            caption.push_str(&Curve::add_limit(&mut curves, limit, (&whose, "N m"), colour));
        }
        let title = "Bending moments at the roots";
        let quantity = ("moment", "N m");
        let figure = self.figure("root-moments".to_owned(), title, caption, quantity, curves);
        Ok(figure.by(formula::ROOT_MOMENTS))
    }
}

/// The page of the first of an arm's runs, with the others beside it.
pub(super) fn arm_page(arms: &[StoredArm], figures: &Figures) -> Markup {
    let shown = Shown::of(arms);
    let first = shown.first;
    let title = match first.origin.title.trim() {
        "" => "An arm of flexible links",
        title => title,
    };
    let mut sections = Vec::new();
    let warnings = told(arms, |arm| &arm.warnings);
    if !warnings.is_empty() {
        sections.push(Section::warnings(advice(&warnings, true)));
    }
    let motion = Motion::of(&shown);
    let data = motion.as_ref().map(|motion| motion.json(&shown));
    let (times, (from, until)) = (&first.times_s, shown.span_s);
    let [from, until, start, end] =
        [from, until, times[0], times[times.len() - 1]].map(|t| given(t, ""));
    let note = format!(
        "Over time the figures show {from} … {until} s of the {start} … {end} s that were computed."
    );
    let [leading, more] = parted_figures("Torques, tip and joints", figures, &note);
    sections.extend(leading);
    if let Some(motion) = &motion {
        let (heading, class) = ("The arm in motion", Some("needs-script"));
        let section = Section::new("animation", "Motion", animation("The arm while it moves"));
        sections.push(Section { heading, class, ..section });
        sections.push(Section::new("arm", "Poses", motion.drawing(&shown)));
    }
    sections.extend(more);
    let remarks = told(arms, |arm| &arm.remarks);
    if !remarks.is_empty() {
        sections.push(Section::new("remarks", "Remarks", advice(&remarks, false)));
    }
    sections.push(Section::glossary());
    sections.push(Section::new("results", "Results", tables(arms, &shown)));
    if first.joints.iter().any(|joint| !joint.errors.is_empty()) {
        sections.push(Section::new("errors", "Errors", errors(first)));
    }
    if !first.checks.is_empty() {
        sections.push(Section::new("checks", "Verification", checks(&first.checks)));
    }
    sections.extend(arms.iter().take(1).map(|arm| inputs(&arm.origin)));
    let origin = html! {
        @for (k, arm) in arms.iter().enumerate() {
            @if k > 0 { br; }
            @if arms.len() > 1 { strong { (arm.name) } " " }
            (made_by(&arm.origin))
        }
    };
    document(title, &origin, &sections, FILES, data.as_deref())
}

/// Warnings or remarks of all runs; those of several with the name of theirs.
fn told(arms: &[StoredArm], of: fn(&StoredArm) -> &Vec<Notice>) -> Vec<Notice> {
    let named = |arm: &StoredArm, warning: &Notice| match arms.len() {
        1 => warning.clone(),
        _ => Notice { message: format!("{}: {}", arm.name, warning.message), ..warning.clone() },
    };
    arms.iter().flat_map(|arm| of(arm).iter().map(move |warning| named(arm, warning))).collect()
}

fn tables(arms: &[StoredArm], shown: &Shown) -> Markup {
    let first = shown.first;
    let last = first.links.len() - 1;
    let link = |k: usize| {
        let mut rows = link_readings(&first.links[k].link);
        let body = rows.iter_mut().filter(|(name, _)| name == "payload" && k < last);
        body.for_each(|(name, _)| "body at its tip".clone_into(name));
        readings(&format!("Link {}{}", k + 1, shown.name_of(k)), &rows)
    };
    html! {
        div class="columns" { @for arm in arms { div {
            @if arms.len() > 1 { h3 { (arm.name) } }
            (joints(arm))
        } } }
        div class="columns" {
            @if !first.readings.is_empty() { (readings("Whole arm", &results(&first.readings))) }
            @for k in 0..first.links.len() { (link(k)) }
        }
    }
}

/// The numbers of the joints, a column each; nothing where there are none.
fn joints(arm: &StoredArm) -> Markup {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in arm.joints.iter().flat_map(|joint| &joint.readings) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let head = (1..=arm.joints.len()).map(|number| format!("joint {number}"));
    let head: Vec<String> = ["quantity".to_owned()].into_iter().chain(head).collect();
    let rows = html! {
        @for name in &names {
            @let (words, unit) = words_and_unit(name);
            tr {
                th scope="row" { (words) }
                @for joint in &arm.joints {
                    td { @if let Some(value) = joint.reading(name) {
                        (format!("{} {unit}", significant(value, 4).replace('-', "−")).trim_end())
                    } }
                }
            }
        }
    };
    html! { @if !names.is_empty() { (table(&head, &rows)) } }
}

/// What each quantity of each joint may be off by.
fn errors(arm: &StoredArm) -> Markup {
    let all = || {
        arm.joints.iter().enumerate().flat_map(|(k, joint)| {
            joint.errors.iter().map(move |(quantity, kinds)| (k, quantity, kinds))
        })
    };
    let mut head = vec!["quantity", "joint"];
    for (_, _, kinds) in all() {
        for (kind, _) in kinds {
            if !head.contains(&kind.as_str()) {
                head.push(kind);
            }
        }
    }
    let rows = html! {
        @for (k, quantity, kinds) in all() { tr {
            th scope="row" { (quantity.replace("hub", "joint").replace('_', " ")) }
            td { (k + 1) }
            @for kind in &head[2..] {
                td { @if let Some((_, error)) = kinds.iter().find(|(own, _)| own == kind) {
                    (significant(*error, 2))
                } }
            }
        } }
    };
    let of = if has_weight(arm) { "range" } else { "peak" };
    html! {
        p { "What each quantity may be off by, as a share of its own " (of) "." }
        (table(&head, &rows))
    }
}
