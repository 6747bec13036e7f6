//! Figures of the joints over time: torque and angle, of a link as in figures 5 to 7 of Bayo (1987), and quantities that
//! may have a limit: torque of the motor, rates, powers, deflection, moment at the root.

use std::borrow::Cow;
use std::fmt::Write as _;

use super::bending::{TRUSTED, bent_m, tip_deflection_m};
use super::figure::{Curve, Figure, Stroke};
use super::paper::cited;
use super::tip::{at_times, motion_formula};
use super::view::{COLOURS, Single, View, peak_words, run_stroke};
use super::words::{Of, formula, own};
use crate::elastica::SecondOrder;
use crate::link::{Drive, Joint};
use crate::numeric::largest;
use crate::result::{JointQuantity, StoredJoint, StoredRun};
use crate::text::{after, before};

/// A quantity of a joint of the flexible and of the rigid arm.
type Both<'a> = (&'a Vec<f64>, Option<&'a Vec<f64>>);

/// A quantity of a joint: of every run, and of the first rigid arm in the files.
fn of_joint(view: &View, (joint, name): (usize, &str), of: fn(&StoredJoint) -> Both) -> Vec<Curve> {
    let mut curves =
        view.of_runs(name, |arm| Some((&arm.times_s, Cow::from(of(view.joint(arm, joint)?).0))));
    let rigid = |arm| Some((arm, of(view.joint(arm, joint)?).1?));
    let known: Vec<_> = view.runs.iter().filter_map(rigid).collect();
    if let Some((arm, rigid)) = known.first() {
        let name = view.pick("rigid link", "rigid arm");
        let of_run = if known.len() > 1 { format!(", {}", own(&arm.name)) } else { String::new() };
        let name = format!("{name}{of_run}");
        curves.push(view.curve(&name, Stroke::Dashed(2), &arm.times_s, rigid));
    }
    curves
}

/// Torque at a joint, flexible and rigid.
pub(super) fn torque(view: &View, joint: usize) -> Figure {
    let own = &view.first().joints[joint];
    let peak = |name: &str, history: &[f64]| peak_words(own.reading(name), history);
    let mut caption = format!("At most {} N m.", peak("peak_torque_n_m", &own.torque_n_m));
    if let Some(rigid) = &own.rigid_torque_n_m {
        let rigid = peak("peak_rigid_torque_n_m", rigid);
        let links = view.pick("link", "links");
        let paper = cited(view, [Some(5), Some(7)]);
        // Writing to a string cannot fail.
        let _ = write!(caption, " Were the {links} rigid, it would be {rigid} N m{paper}.");
        let timing = ["lead_s", "lag_s"].map(|name| own.reading(name));
        caption.push_str(&timing_words(timing, view.is_arm() || view.has_weight()));
    }
    let line = (joint, flexible(view, "torque"));
    let mut curves = of_joint(view, line, |j| (&j.torque_n_m, j.rigid_torque_n_m.as_ref()));
    caption.push_str(&Curve::add_limit(
        &mut curves,
        (own.limits.of("torque"), 0.0),
        ("", "N m"),
        1,
    ));
    let id = view.id("torque", joint);
    let title = format!("Torque {} {}", view.pick("at", "of"), view.joint_words(joint));
    let figure = view.figure(id, &title, caption, ("torque", "N m"), curves);
    Figure { spans: view.lead_and_lag(joint), ..figure }.by(torque_formula(view))
}

/// Quantities of [`LIMITED`] in the words of an arm's carriage: key, title, axis and unit.
const OF_CARRIAGE: [[&str; 4]; 3] = [
    ["hub_rate", "Speed of the carriage", "speed", "m/s"],
    ["hub_acceleration", "Acceleration of the carriage", "acceleration", "m/s²"],
    ["power", "Power at the carriage", "power", "W"],
];

/// Force on the carriage of an arm, its place, and its quantities with a limit.
pub(super) fn carriage(view: &View) -> Vec<Figure> {
    let Some(carriage) = view.first().carriage.as_ref() else { return Vec::new() };
    let own = &carriage.joint;
    let lines = |name: &str, of: HistoryOf| {
        view.of_runs(name, |arm| Some((&arm.times_s, of(&arm.carriage.as_ref()?.joint)?)))
    };
    let force = |name: &str, history: &[f64]| peak_words(own.reading(name), history);
    let mut caption = format!("At most {} N.", force("peak_force_n", &own.torque_n_m));
    let mut curves = lines("flexible arm", |joint| Some(Cow::from(&joint.torque_n_m)));
    if let Some(rigid) = &own.rigid_torque_n_m {
        let peak = force("peak_rigid_force_n", rigid);
        let _ = write!(caption, " Were the links rigid, it would be {peak} N.");
        curves.push(view.curve("rigid arm", Stroke::Dashed(2), &view.first().times_s, rigid));
    }
    caption.push_str(&Curve::add_limit(&mut curves, (own.limits.of("torque"), 0.0), ("", "N"), 1));
    let title = "Force on the carriage";
    let figure = view.figure("carriage-force", title, caption, ("force", "N"), curves);
    let mut places = lines("carriage", |joint| Some(Cow::from(&joint.angle_rad)));
    let mut caption = "Place along the rail, from the path.".to_owned();
    let travel = (own.limits.of("hub_angle"), own.angle_rad[0]);
    caption.push_str(&Curve::add_limit(&mut places, travel, ("", "m"), 1));
    let title = "Place of the carriage";
    let place = view.figure("carriage", title, caption, ("place", "m"), places);
    let joint = Joint::CARRIAGE;
    let limited = OF_CARRIAGE.iter().filter_map(|[key, title, axis, unit]| {
        let limit = own.limits.of(key)?;
        let Limited { of, .. } = LIMITED.iter().find(|topic| topic.quantity.1 == *key)?;
        let mut curves = lines("flexible arm", *of);
        let name = JointQuantity::of_limit(key)?.column(None);
        let peak = peak_words(own.reading(&joint.named(&name)), &of(own)?);
        let mut caption = format!("At most {peak} {unit}.");
        caption.push_str(&Curve::add_limit(&mut curves, (Some(limit), 0.0), ("", unit), 1));
        let id = format!("carriage-{axis}");
        let figure = view.figure(id, title, caption, (axis, unit), curves);
        Some(figure.by(formula_of_limit(key, Of::Carriage)?))
    });
    [figure.by(formula::CARRIAGE_FORCE), place].into_iter().chain(limited).collect()
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

/// Start and end of a torque relative to the motion; `from_rest` is true for a torque that may hold a weight.
fn timing_words([lead_s, lag_s]: [Option<f64>; 2], from_rest: bool) -> String {
    let Some((lead_s, lag_s)) = lead_s.zip(lag_s) else {
        return " This is one cycle, which the torque repeats.".to_owned();
    };
    let (lead, lag) = (before(lead_s, 4), after(lag_s, 4));
    if lead_s > 0.0 && lag_s > 0.0 && !from_rest {
        return format!(
            " Bending waves take time: the torque acts, at the 2 % level, from {lead} the tip moves until {lag} it has \
             stopped (shaded)."
        );
    }
    let start = if lead_s >= 0.0 { "the tip sets out" } else { "the tip has set out" };
    let stop = if lag_s >= 0.0 { "it has stopped" } else { "it stops" };
    if from_rest {
        return format!(
            " The torque leaves its value at rest (2 % of its range) {lead} {start}, and returns to it {lag} {stop}."
        );
    }
    format!(" The torque acts, at the 2 % level, from {lead} {start} until {lag} {stop}.")
}

/// Angle of a joint, flexible and rigid; for the first joint relative to a fixed direction.
pub(super) fn angle(view: &View, joint: usize) -> Figure {
    let against = if joint == 0 { "x" } else { "the tip of the link before" };
    let mut caption = view.pick(
        "Angle that an encoder at the hub measures.".to_owned(),
        format!("Angle that an encoder measures: of the link's root against {against}."),
    );
    if view.is_solved() && !view.is_arm() {
        let two = if view.runs.len() > 1 { "its two" } else { "the two" };
        caption = format!(
            "Angle that an encoder at the hub measures; the hub of a rigid link would turn as the tip does{}. The \
             gap between {two} curves is bending.",
            cited(view, [Some(6), None])
        );
    }
    let title = format!("{} {}", view.pick("Rotation of", "Angle of"), view.joint_words(joint));
    let line = (joint, flexible(view, "hub"));
    let mut curves = of_joint(view, line, |j| (&j.angle_rad, j.rigid_angle_rad.as_ref()));
    let own = &view.first().joints[joint];
    let start_rad = own.angle_rad[0];
    let turned_rad =
        own.angle_rad.iter().fold(0.0, |most: f64, own| most.max((own - start_rad).abs()));
    // Of a cycle the limit is that of the range, which is not a line.
    if own.reading("peak_hub_angle_rad").is_none_or(|peak| turned_rad > 0.99 * peak) {
        let limit = (own.limits.of("hub_angle"), start_rad);
        caption.push_str(&Curve::add_limit(&mut curves, limit, ("", "rad"), 1));
    }
    let id = view.id("hub-angle", joint);
    let figure = view.figure(id, &title, caption, ("angle", "rad"), curves);
    let spans = view.pick(view.lead_and_lag(joint), vec![]);
    let formula = view.pick(motion_formula(view, formula::HUB), formula::JOINT_ANGLE);
    Figure { spans, ..figure }.by(formula)
}

/// Contribution of bending to the joint angles of an arm.
pub(super) fn bent_angles(view: &View) -> Result<Figure, String> {
    let why = "what bending adds to the joint angles, since the rigid arm's were not written";
    let rigid = view.rigid().ok_or(why)?;
    let curves = view.each(&view.numbered("joint"), |arm, joint| {
        let straight = rigid.joints[joint].rigid_angle_rad.as_deref()?;
        let straight = at_times(&arm.times_s, (&rigid.times_s, straight));
        let pairs = view.joint(arm, joint)?.angle_rad.iter().zip(straight);
        Some((&arm.times_s, pairs.map(|(own, rigid)| 1e3 * (own - rigid)).collect()))
    });
    let weight = if view.has_weight() { " and sag" } else { "" };
    let caption = format!(
        "Turn of each joint beyond that of the rigid arm, which keeps the tip in its place although the links \
         bend{weight}."
    );
    let title = "What bending adds to the joint angles";
    let figure = view.figure("bending-angles", title, caption, ("angle", "mrad"), curves);
    Ok(figure.by(formula::BENDING_ANGLES))
}

/// A history of a joint, if it has one.
type HistoryOf = fn(&StoredJoint) -> Option<Cow<[f64]>>;

/// A figure of a quantity of a hub or of a joint that may have a limit.
pub(super) struct Limited {
    /// Id of the figure; for a motor `motor-torque`.
    id: &'static str,
    /// Title without the name of hub, joint or motor.
    title: &'static str,
    /// Name of the vertical axis, and key of the limit.
    pub(super) quantity: (&'static str, &'static str),
    of: HistoryOf,
    formula: &'static str,
}

const AT_MOST: &str = "At most {}.";
const OF_MOTOR: &str = "At most {}, on the motor's side of the drive.";

/// Torque of the motor, which has a figure even without a limit.
pub(super) const MOTOR_TORQUE: Limited = Limited {
    id: "motor-torque",
    title: "Torque of the motor of",
    quantity: ("torque", "motor_torque"),
    of: |joint| Some(Cow::Borrowed(&joint.motor.as_ref()?.torque_n_m)),
    formula: formula::MOTOR,
};

/// Rate, acceleration and power, of the joint and of its motor: drawn if they have a limit.
pub(super) const LIMITED: [Limited; 7] = [
    Limited {
        id: "hub-rate",
        title: "Rate of",
        quantity: ("rate", "hub_rate"),
        of: |joint| Some(Cow::Borrowed(&joint.rate_rad_s)),
        formula: formula::RATE,
    },
    Limited {
        id: "hub-acceleration",
        title: "Acceleration of",
        quantity: ("acceleration", "hub_acceleration"),
        of: |joint| Some(Cow::Borrowed(&joint.acceleration_rad_s2)),
        formula: formula::ACCELERATION,
    },
    Limited {
        id: "hub-power",
        title: "Power at",
        quantity: ("power", "power"),
        of: |joint| Some(power_w(&joint.torque_n_m, &joint.rate_rad_s)),
        formula: formula::POWER,
    },
    Limited {
        id: "motor-rate",
        title: "Rate of the motor of",
        quantity: ("rate", "motor_rate"),
        of: |joint| Some(Cow::Borrowed(&joint.motor.as_ref()?.rate_rad_s)),
        formula: formula::MOTOR_RATE,
    },
    Limited {
        id: "motor-power",
        title: "Power of the motor of",
        quantity: ("power", "motor_power"),
        of: |joint| joint.motor.as_ref().map(|motor| power_w(&motor.torque_n_m, &motor.rate_rad_s)),
        formula: formula::MOTOR_POWER,
    },
    Limited {
        id: "motor-current",
        title: "Current of the motor of",
        quantity: ("current", "motor_current"),
        of: |joint| Some(Cow::Borrowed(joint.motor.as_ref()?.current_a.as_ref()?)),
        formula: formula::MOTOR_CURRENT,
    },
    Limited {
        id: "motor-voltage",
        title: "Voltage of the motor of",
        quantity: ("voltage", "motor_voltage"),
        of: |joint| Some(Cow::Borrowed(joint.motor.as_ref()?.voltage_v.as_ref()?)),
        formula: formula::MOTOR_VOLTAGE,
    },
];

/// Formula of the quantity with this limit.
pub(super) fn formula_of_limit(key: &str, of: Of) -> Option<String> {
    // Only the links of an arm are measured by their chords.
    let deflection = match of {
        Of::Joint => formula::LINK_DEFLECTION,
        Of::Hub | Of::Carriage => formula::TIP_DEFLECTION,
    };
    let others = [("deflection", deflection), ("bending_moment", formula::ROOT_MOMENTS)];
    let topics = LIMITED.iter().chain([&MOTOR_TORQUE]).map(|own| (own.quantity.1, own.formula));
    let key = key.replace("rms_", "");
    topics.chain(others).find(|(own, _)| *own == key).map(|(_, formula)| of.words(formula))
}

fn power_w(torque_n_m: &[f64], rate_rad_s: &[f64]) -> Cow<'static, [f64]> {
    torque_n_m.iter().zip(rate_rad_s).map(|(torque, rate)| torque * rate).collect()
}

/// Name of the flexible line on a page of one run: `played` for the simulation of a link.
fn flexible<'a>(view: &View, played: &'a str) -> &'a str {
    view.pick(if view.is_solved() { "flexible link" } else { played }, "flexible arm")
}

impl Limited {
    /// Figure of a joint, with the limit if there is one; `None` if the joint lacks the quantity.
    pub(super) fn figure(&self, view: &View, joint: usize) -> Option<Figure> {
        (self.of)(&view.first().joints[joint])?;
        let is_of_motor = self.id.starts_with("motor");
        let of_link = if is_of_motor { "motor" } else { flexible(view, "hub") };
        let name = view.pick(of_link, "flexible arm");
        let caption = if is_of_motor { OF_MOTOR } else { AT_MOST };
        let curves =
            view.of_runs(name, |arm| Some((&arm.times_s, (self.of)(view.joint(arm, joint)?)?)));
        let title = format!("{} {}", self.title, view.joint_words(joint));
        let id = view.id(self.id, joint);
        let figure = figure(view, joint, id, (&title, caption), self.quantity, curves);
        let drive = view.first().links.get(joint).and_then(|own| own.link.drive());
        let is_lossy = self.id == MOTOR_TORQUE.id && drive.is_some_and(Drive::has_losses);
        let formula = if is_lossy { formula::LOSSY_MOTOR } else { self.formula };
        Some(figure.by(view.kind().words(formula)))
    }
}

/// A figure of lines of a joint's quantity, with its limit if there is one. The caption contains the peak of the first
/// line, from the summary if that has it.
fn figure(
    view: &View,
    joint: usize,
    id: String,
    (title, caption): (&str, &str),
    (axis, key): (&str, &str),
    mut curves: Vec<Curve>,
) -> Figure {
    let joint = &view.first().joints[joint];
    let quantity = JointQuantity::of_limit(key);
    let known = quantity.and_then(|quantity| joint.reading(&quantity.column(None)));
    let unit = quantity.map_or("", |quantity| quantity.unit.text);
    let values = curves.first().into_iter().flat_map(|curve| &curve.points);
    let values: Vec<f64> = values.map(|(_, value)| *value).collect();
    let peak = format!("{} {unit}", peak_words(known, &values));
    let mut caption = caption.replace("{}", &peak);
    caption.push_str(&Curve::add_limit(&mut curves, (joint.limits.of(key), 0.0), ("", unit), 1));
    view.figure(id, title, caption, (axis, unit), curves)
}

/// Figures of all quantities with a limit, except torques, of a joint, its motor and its link.
pub(super) fn limited(view: &View, joint: usize) -> Vec<Result<Figure, String>> {
    let limits = &view.first().joints[joint].limits;
    let has_limit = |topic: &&Limited| limits.of(topic.quantity.1).is_some();
    let turning = LIMITED.iter().filter(has_limit);
    let turning = turning.filter_map(|topic| topic.figure(view, joint)).map(Ok);
    let deflected = limits.of("deflection").map(|_| deflection(view, joint));
    // The moments of all links of an arm are in one figure.
    let limit = view.pick(limits.of("bending_moment"), None);
    let moment = limit.map(|_| root_moment(view));
    turning.chain(deflected).chain(moment).collect()
}

/// Times in s, and deflection in m of a link's tip from the tangent line at its root; for a single link as written, or
/// `v − Lθ`.
fn tip_deflection(run: &StoredRun, link: usize) -> (&[f64], Cow<'_, [f64]>) {
    let Some(single) = Single::of(run) else {
        return (&run.nodal_times_s, tip_deflection_m(run, link).into());
    };
    let output = single.arc.mesh.output();
    let written = run.links[link].deflections_m.as_ref();
    let written = written.and_then(|own| {
        let at = own.nodes.iter().position(|node| *node == output)?;
        Some((&own.times_s[..], Cow::from(&own.histories[at])))
    });
    written.unwrap_or_else(|| (single.times_s, bent_m(single).into()))
}

/// Deflection of a link's tip from the tangent line at its root.
fn deflection(view: &View, link: usize) -> Result<Figure, String> {
    let known = view.first().joints[link].reading("peak_deflection_m");
    let of_arm =
        format!("Deflection at the tip of link {}, estimated from its nodes", view.number_of(link));
    let title = view.pick("Deflection of the tip from the hub's tangent line", &of_arm);
    let caption = view.pick(AT_MOST, "From the tangent line at the link's root, at most {}.");
    let own = largest(&tip_deflection(view.first(), link).1);
    if view.is_arm() && known.is_some_and(|peak| (own / peak - 1.0).abs() > TRUSTED) {
        let why = "too few rows were written for it: --every 1 writes all";
        return Err(format!("{title}, since {why}"));
    }
    let curves = view.of_runs(view.pick("flexible link", "flexible arm"), |run| {
        view.joint(run, link)?;
        Some(tip_deflection(run, link))
    });
    let id = view.id("tip-deflection", link);
    let figure = figure(view, link, id, (title, caption), ("deflection", "deflection"), curves);
    Ok(figure.by(view.pick(formula::TIP_DEFLECTION, formula::LINK_DEFLECTION)))
}

/// Bending moment at the root of a single link, if known.
fn root_moment(view: &View) -> Result<Figure, String> {
    let moments = view.moments(0).filter(|moments| moments.nodes.nodes.first() == Some(&0));
    let why = if view.is_solved() {
        "it was not written: solve --moments writes it"
    } else {
        "too few rows were written for an estimate: --every 1 writes all"
    };
    let moments = moments.ok_or_else(|| format!("the bending moment at the root, since {why}"))?;
    let of_others: Vec<_> = view.runs[1..].chunks(1).map(|run| View::of(run).moments(0)).collect();
    let all = std::iter::once(Some(moments.clone())).chain(of_others);
    let lines = view.named("flexible link").zip(all).enumerate();
    let lines = lines.filter_map(|(k, ((run, name), moments))| {
        let nodes = moments.filter(|own| own.nodes.nodes.first() == Some(&0))?.nodes;
        view.joint(run, 0)?;
        Some(view.curve(&name, run_stroke(k), &nodes.times_s, &nodes.histories[0]))
    });
    let curves = lines.collect();
    let (title, formula) = if moments.is_written {
        ("Bending moment at the root", formula::ROOT_MOMENTS)
    } else {
        ("Bending moment at the root, estimated", formula::MOMENT_ESTIMATED)
    };
    let (id, quantity) = ("hub-moment".to_owned(), ("moment", "bending_moment"));
    Ok(figure(view, 0, id, (title, AT_MOST), quantity, curves).by(formula))
}

/// Bending moments at the roots of all links of an arm.
pub(super) fn root_moments(view: &View) -> Result<Figure, String> {
    let mut curves = view.each(&view.numbered("link"), |arm, link| {
        let moments = arm.links.get(link)?.moments_n_m.as_ref()?;
        Some((&moments.times_s, moments.histories[0].clone()))
    });
    if curves.is_empty() {
        let why = if view.is_solved() {
            "they were not written: solve --moments writes them"
        } else {
            "a simulation does not write them"
        };
        return Err(format!("bending moments, since {why}"));
    }
    let mut caption =
        "Bending moment at the root of each link, where it is largest as a rule.".to_owned();
    for (link, joint) in view.first().joints.iter().enumerate() {
        let limit = (joint.limits.of("bending_moment"), 0.0);
        let whose = format!("link {}:", link + 1);
        let colour = 1 + link % COLOURS;
        caption.push_str(&Curve::add_limit(&mut curves, limit, (&whose, "N m"), colour));
    }
    let (title, quantity) = ("Bending moments at the roots", ("moment", "N m"));
    Ok(view.figure("root-moments", title, caption, quantity, curves).by(formula::ROOT_MOMENTS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::Figures;
    use crate::page::tests::{run, solution};
    use crate::result::Limits;
    use crate::result::{StoredMotor, StoredRun};
    use crate::store::StoredResult;
    use crate::text::significant;

    /// A peak between samples exceeds all samples.
    #[test]
    fn captions_have_the_peaks_of_the_summary() {
        let mut run = run();
        let motor = StoredMotor {
            torque_n_m: run.joints[0].torque_n_m.clone(),
            rate_rad_s: run.joints[0].rate_rad_s.clone(),
            current_a: None,
            voltage_v: None,
        };
        run.joints[0].motor = Some(motor);
        run.joints[0].limits = Limits::new([("hub_rate", 2.0), ("deflection", 0.2)]).unwrap();
        let moment_n_m = 1.01 * largest(&solution().links[0].root_moment_n_m);
        let moment_words = format!("reaches {} N m", significant(moment_n_m, 4));
        let peaks = [
            ("torque", "peak_torque_n_m", 1.401, "1.401 N m"),
            ("torque", "peak_rigid_torque_n_m", 2.901, "2.901 N m"),
            ("motor-torque", "peak_motor_torque_n_m", 1.402, "1.402 N m"),
            ("tip-acceleration", "peak_tip_acceleration_m_s2", 4.201, "4.201 m/s²"),
            ("hub-rate", "peak_hub_rate_rad_s", 0.5301, "0.5301 rad/s"),
            ("tip-deflection", "peak_deflection_m", 0.1701, "0.1701 m"),
            ("waves", "peak_root_moment_n_m", moment_n_m, &moment_words),
        ];
        run.readings = peaks.map(|(_, name, value, _)| (name.to_owned(), value)).to_vec();
        run.joints[0].readings.clone_from(&run.readings);
        let drawn = Figures::of(&StoredResult::Runs(vec![run])).drawn;
        for (id, name, _, words) in peaks {
            let figure = drawn.iter().find(|figure| figure.id == id).unwrap();
            assert!(figure.caption.contains(words), "{name}: {}", figure.caption);
        }
    }

    #[test]
    fn every_limit_of_a_history_is_a_line_in_its_figure() {
        let mut run = run();
        run.joints[0].motor = Some(StoredMotor {
            torque_n_m: run.joints[0].torque_n_m.iter().map(|torque| 0.5 * torque).collect(),
            rate_rad_s: run.joints[0].rate_rad_s.iter().map(|rate| 2.0 * rate).collect(),
            current_a: Some(run.joints[0].torque_n_m.clone()),
            voltage_v: Some(run.joints[0].rate_rad_s.clone()),
        });
        let drawn = |run: &StoredRun| Figures::of(&StoredResult::Runs(vec![run.clone()])).drawn;
        assert!(!drawn(&run).iter().any(|figure| figure.id == "hub-power"), "there is no limit");
        let power: Vec<f64> = run.joints[0]
            .torque_n_m
            .iter()
            .zip(&run.joints[0].rate_rad_s)
            .map(|(torque, rate)| torque * rate)
            .collect();
        let half = |history: &[f64]| 0.5 * largest(history);
        let deflection = half(run.bent().histories.last().unwrap());
        let (joint, motor) = (&run.joints[0], run.joints[0].motor.as_ref().unwrap());
        let limits = Limits::new([
            ("torque", half(&joint.torque_n_m)),
            ("hub_rate", half(&joint.rate_rad_s)),
            ("power", half(&power)),
            ("deflection", deflection),
            ("bending_moment", half(&solution().links[0].root_moment_n_m)),
            ("motor_torque", half(&motor.torque_n_m)),
            ("motor_rate", half(&motor.rate_rad_s)),
            ("motor_power", half(&power)),
            ("motor_current", half(motor.current_a.as_ref().unwrap())),
            ("motor_voltage", half(motor.voltage_v.as_ref().unwrap())),
        ]);
        run.joints[0].limits = limits.unwrap();
        let figures = drawn(&run);
        for (id, line, key) in [
            ("torque", "flexible link", "torque"),
            ("motor-torque", "motor", "motor_torque"),
            ("hub-rate", "flexible link", "hub_rate"),
            ("hub-power", "flexible link", "power"),
            ("motor-rate", "motor", "motor_rate"),
            ("motor-power", "motor", "motor_power"),
            ("motor-current", "motor", "motor_current"),
            ("motor-voltage", "motor", "motor_voltage"),
            ("tip-deflection", "flexible link", "deflection"),
            ("hub-moment", "flexible link", "bending_moment"),
        ] {
            let limit = run.joints[0].limits.of(key);
            let figure = figures.iter().find(|figure| figure.id == id).unwrap();
            let curve = figure.curves.iter().find(|curve| curve.name == line).unwrap();
            let peak = curve.points.iter().fold(0.0_f64, |peak, (_, value)| peak.max(value.abs()));
            // The moment is estimated.
            assert!((0.5 * peak / limit.unwrap() - 1.0).abs() < 0.02, "{id}: {peak}, {limit:?}");
            let is_limit = |curve: &&Curve| matches!(curve.stroke, Stroke::Limit(_));
            let mut lines = figure.curves.iter().filter(is_limit);
            let is_drawn = lines.any(|curve| (curve.points[0].1 - limit.unwrap()).abs() < 1e-15);
            assert!(is_drawn, "{id} lacks the limit of {line}");
        }
    }
}
