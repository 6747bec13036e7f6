//! All figures of a result and its page; figures of the joints over time, those of a link as in figures 5 to 7 of Bayo
//! (1987).

use std::borrow::Cow;
use std::fmt::Write as _;

use super::bending::waves;
use super::document::run_page;
use super::figure::{Curve, Figure, Figures, Stroke};
use super::frequency::{shapes, transfer};
use super::limited::{MOTOR_TORQUE, flexible, limited, root_moments};
use super::sweep::sweep_figures;
use super::sweep_page::sweep_page;
use super::tip::{self, motion_formula};
use super::view::{View, peak_words};
use super::words::{cited, formula};
use crate::elastica::SecondOrder;
use crate::result::{StoredJoint, StoredResult};
use crate::text::{significant, visible_document};

impl Figures {
    /// All figures of a result.
    pub fn of(result: &StoredResult) -> Self {
        match result {
            StoredResult::Runs(runs) => run_figures(&View::of(runs)),
            StoredResult::Sweep(sweep) => sweep_figures(sweep),
        }
    }
}

/// The page of a result, with its figures: one self-contained HTML file.
pub fn page(result: &StoredResult, figures: &Figures) -> String {
    let document = match result {
        StoredResult::Runs(runs) => run_page(&View::of(runs), figures),
        StoredResult::Sweep(sweep) => sweep_page(sweep, figures),
    };
    visible_document(&document.into_string())
}

fn run_figures(view: &View) -> Figures {
    let joints = 0..view.first().joints.len();
    let mut figures = Figures::default();
    for joint in joints.clone() {
        figures.add(Ok(torque(view, joint)));
        figures.extend(MOTOR_TORQUE.figure(view, joint).map(Ok));
    }
    let motion = view.link.map(|run| tip::motion(view, run));
    let [acceleration, displacement] = motion.map_or([None, None], |motion| motion.map(Some));
    figures.add(Ok(displacement.unwrap_or_else(|| tip::place(view))));
    figures.extend(tip::error(view).into_iter().chain(acceleration).map(Ok));
    for joint in joints.clone() {
        figures.add(Ok(angle(view, joint)));
        figures.extend(limited(view, joint));
    }
    figures.extend(view.is_arm().then(|| bent_angles(view)));
    figures.extend(joints.map(|link| waves(view, link)));
    if let Some(run) = view.link {
        figures.extend(view.is_solved().then(|| tip::under_rigid_torque(view, run)));
        figures.extend([transfer(run), shapes(&run.arc.mesh)]);
    } else {
        figures.add(root_moments(view));
    }
    figures
}

/// A quantity of a joint of the flexible and of the rigid arm.
type Both<'a> = (&'a Vec<f64>, Option<&'a Vec<f64>>);

/// A quantity of a joint: of every run, and of the first rigid arm in the files.
fn of_joint(view: &View, (joint, name): (usize, &str), of: fn(&StoredJoint) -> Both) -> Vec<Curve> {
    let mut curves =
        view.of_runs(name, |arm| Some((&arm.times_s, Cow::from(of(&arm.joints[joint]).0))));
    let known = view.runs.iter().find_map(|arm| Some((arm, of(&arm.joints[joint]).1?)));
    if let Some((arm, rigid)) = known {
        let name = view.pick("rigid link", "rigid arm");
        curves.push(view.curve(name, Stroke::Dashed(2), &arm.times_s, rigid));
    }
    curves
}

/// Torque at a joint, flexible and rigid.
fn torque(view: &View, joint: usize) -> Figure {
    let own = &view.first().joints[joint];
    let peak = |name: &str, history: &[f64]| peak_words(own.reading(name), history);
    let mut caption = format!("At most {} N m.", peak("peak_torque_n_m", &own.torque_n_m));
    if let Some(rigid) = &own.rigid_torque_n_m {
        let rigid = peak("peak_rigid_torque_n_m", rigid);
        let links = view.pick("link", "links");
        let paper = cited(view, [Some(5), Some(7)]);
        // Writing to a string cannot fail.
        let _ = write!(caption, " Were the {links} rigid, it would be {rigid} N m{paper}.");
        if !view.is_arm() {
            caption.push_str(&timing_words(["lead_s", "lag_s"].map(|name| own.reading(name))));
        }
    }
    let line = (joint, flexible(view, "torque"));
    let mut curves = of_joint(view, line, |j| (&j.torque_n_m, j.rigid_torque_n_m.as_ref()));
    caption.push_str(&Curve::add_limit(&mut curves, own.limits.torque_n_m, ("", "N m"), 1));
    let id = view.id("torque", joint);
    let title = format!("Torque {} {}", view.pick("at", "of"), view.joint_words(joint));
    let figure = view.figure(id, &title, caption, ("torque", "N m"), curves);
    Figure { spans: view.lead_and_lag(joint), ..figure }.by(torque_formula(view))
}

/// Formula of a torque, for a solution with its second-order terms.
fn torque_formula(view: &View) -> Cow<'static, str> {
    let is_bent = |order: SecondOrder| order != SecondOrder::None || view.has_weight();
    match view.link {
        _ if !view.is_solved() => formula::TORQUE_PLAYED.into(),
        None => formula::ARM_TORQUE.into(),
        Some(run) if is_bent(run.arc.second_order) => {
            format!("{} {}", formula::TORQUE, formula::SECOND_ORDER).into()
        }
        Some(_) => formula::TORQUE.into(),
    }
}

/// Start and end of a link's torque relative to the motion.
fn timing_words([lead_s, lag_s]: [Option<f64>; 2]) -> String {
    let Some((lead_s, lag_s)) = lead_s.zip(lag_s) else {
        return " This is one cycle, which the torque repeats.".to_owned();
    };
    let [lead, lag] = [lead_s, lag_s].map(|seconds| significant(seconds.abs(), 4));
    if lead_s > 0.0 && lag_s > 0.0 {
        return format!(
            " Bending waves take time: it acts, at the 2 % level, from {lead} s before the tip moves \
             until {lag} s after it has stopped (shaded)."
        );
    }
    let start = if lead_s >= 0.0 { "before the tip sets out" } else { "after the tip has set out" };
    let stop = if lag_s >= 0.0 { "after it has stopped" } else { "before it has stopped" };
    format!(" It acts, at the 2 % level, from {lead} s {start} until {lag} s {stop}.")
}

/// Angle of a joint, flexible and rigid; for the first joint relative to a fixed direction.
fn angle(view: &View, joint: usize) -> Figure {
    let against = if joint == 0 { "x" } else { "the tip of the link before" };
    let mut caption = view.pick(
        "What an encoder at the hub sees.".to_owned(),
        format!("Angle that an encoder sees: of the link's root against {against}."),
    );
    if view.is_solved() && !view.is_arm() {
        caption = format!(
            "What an encoder at the hub sees; the hub of a rigid link would turn as the tip does{}. What lies between the two \
             curves is bending.",
            cited(view, [Some(6), None])
        );
    }
    let title = format!("{} {}", view.pick("Rotation of", "Angle of"), view.joint_words(joint));
    let line = (joint, flexible(view, "hub"));
    let curves = of_joint(view, line, |j| (&j.angle_rad, j.rigid_angle_rad.as_ref()));
    let id = view.id("hub-angle", joint);
    let figure = view.figure(id, &title, caption, ("angle", "rad"), curves);
    let spans = view.pick(view.lead_and_lag(joint), vec![]);
    let formula = view.pick(motion_formula(view, formula::HUB), formula::JOINT_ANGLE);
    Figure { spans, ..figure }.by(formula)
}

/// Contribution of bending to the joint angles of an arm.
fn bent_angles(view: &View) -> Result<Figure, String> {
    let why = "what bending adds to the joint angles, since the rigid arm's were not written";
    let rigid = view.rigid().ok_or(why)?;
    let curves = view.each(&view.numbered("joint"), |arm, joint| {
        let straight = rigid.joints[joint].rigid_angle_rad.as_deref()?;
        let straight = tip::at_times(&arm.times_s, (&rigid.times_s, straight));
        let pairs = arm.joints[joint].angle_rad.iter().zip(straight);
        Some((&arm.times_s, pairs.map(|(own, rigid)| 1e3 * (own - rigid)).collect()))
    });
    let weight = if view.has_weight() { " and sag" } else { "" };
    let caption = format!(
        "By how much each joint turns beyond the rigid arm's, so that the tip is where it should be although \
         the links bend{weight}."
    );
    let title = "What bending adds to the joint angles";
    let figure = view.figure("bending-angles", title, caption, ("angle", "mrad"), curves);
    Ok(figure.by(formula::BENDING_ANGLES))
}
