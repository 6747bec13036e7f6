//! All figures of a result and its page; figures of a run over time, 3 to 9 of Bayo (1987) for its links.

use std::borrow::Cow;
use std::fmt::Write as _;

use super::arm_page::{arm_figures, arm_page};
use super::axis::is_extreme;
use super::bending::waves;
use super::figure::{Curve, Figure, Figures, Stroke};
use super::frequency::{shapes, transfer};
use super::limited::{limited_of_link, motor_torque};
use super::link::given;
use super::page::run_page;
use super::sweep::sweep_figures;
use super::sweep_page::sweep_page;
use super::view::{View, inside};
use super::words::formula;
use crate::elastica::SecondOrder;
use crate::link::Damping;
use crate::numeric::largest;
use crate::response::{Play, Torque, simulate_on};
use crate::result::{StoredResult, StoredRun, StoredSolution};
use crate::text::{significant, visible_document};

impl Figures {
    /// All figures of a result.
    pub fn of(result: &StoredResult) -> Self {
        match result {
            StoredResult::Run(run) => run_figures(run),
            StoredResult::Arms(arms) => arm_figures(arms),
            StoredResult::Sweep(sweep) => sweep_figures(sweep),
        }
    }
}

/// The page of a result, with its figures: one HTML file that needs nothing else.
pub fn page(result: &StoredResult, figures: &Figures) -> String {
    let document = match result {
        StoredResult::Run(run) => run_page(run, figures),
        StoredResult::Arms(arms) => arm_page(arms, figures),
        StoredResult::Sweep(sweep) => sweep_page(sweep, figures),
    };
    visible_document(&document.into_string())
}

fn run_figures(run: &StoredRun) -> Figures {
    let view = &View::of(run);
    let [acceleration, displacement] = motion(view);
    let mut figures = Figures::default();
    figures.add(Ok(torque(view)));
    if let Some(motor) = motor_torque(view) {
        figures.add(Ok(motor));
    }
    figures.add(Ok(displacement));
    if let Some(error) = tip_error(view) {
        figures.add(Ok(error));
    }
    for figure in [acceleration, hub(view)] {
        figures.add(Ok(figure));
    }
    for figure in limited_of_link(view) {
        figures.add(figure);
    }
    figures.add(waves(view));
    if let Some(solved) = &run.solved {
        let why = |error| format!("the tip under the rigid link's torque, since {error}");
        figures.add(tip_under_rigid_torque(view, solved).map_err(why));
    }
    figures.add(transfer(run));
    figures.add(shapes(&run.mesh));
    figures
}

/// Number of the example of Bayo (1987) that a solution is, for the figures of the paper: its link, and its motion of
/// 0.5 m in 0.88 s with a period of a sine as acceleration.
fn example(run: &StoredRun) -> Option<usize> {
    let close = |found: f64, printed: f64| (found / printed - 1.0).abs() < 1e-3;
    let (from, until) = run.solved.as_ref()?.moving_s;
    let link = &run.link;
    let parts: Vec<[f64; 3]> = link
        .segments()
        .iter()
        .map(|s| [s.length_m, s.bending_stiffness_n_m2.mean(), s.mass_per_length_kg_m.mean()])
        .collect();
    let (hub, payload) = (link.hub(), link.payload());
    let left_out = [
        payload.mass_kg,
        payload.inertia_kg_m2,
        payload.offset_m,
        hub.radius_m,
        hub.viscous_friction_n_m_s_rad,
    ];
    let is_uniform = link.segments().iter().all(|s| {
        s.bending_stiffness_n_m2.is_constant()
            && s.mass_per_length_kg_m.is_constant()
            && s.timoshenko.is_none()
    });
    let is_bare = largest(&left_out) <= 0.0
        && is_uniform
        && link.masses().is_empty()
        && link.drive().is_none()
        && link.gravity().is_none();
    let is_hub = close(hub.inertia_kg_m2, 0.1);
    let peak_m_s2 = largest(&run.tip.acceleration_m_s2);
    let displacement = &run.tip.displacement_m;
    let travel_m = displacement.last()? - displacement.first()?;
    let is_moved = close(until - from, 0.88)
        && close(travel_m.abs(), 0.5)
        && (peak_m_s2 / (std::f64::consts::PI / 0.88_f64.powi(2)) - 1.0).abs() < 1e-2;
    let is_damped = matches!(link.damping(), Damping::Hysteretic { ratio } if close(*ratio, 0.02));
    let is_printed = |stiffness: f64| {
        let printed = [[0.15, 10.0 * stiffness, 0.8], [1.35, stiffness, 0.8]];
        let pairs = parts.iter().flatten().zip(printed.iter().flatten());
        parts.len() == 2 && pairs.into_iter().all(|(found, printed)| close(*found, *printed))
    };
    let number = [5.0, 20.0].into_iter().position(is_printed).map(|k| k + 1);
    number.filter(|_| is_bare && is_hub && is_damped && is_moved)
}

/// Names the paper's figure of its first or second example that a figure is the analogue of; nothing for other links
/// and motions.
fn cited(run: &StoredRun, figures: [Option<u8>; 2]) -> String {
    let figure = example(run).and_then(|number| figures[number - 1]);
    figure.map_or(String::new(), |figure| format!(" (Bayo 1987, figure {figure})"))
}

/// Acceleration and displacement of the tip.
fn motion(view: &View) -> [Figure; 2] {
    let run = view.run;
    let tip = &run.tip;
    let wanted = run.solved.is_some();
    let what = if wanted { "The wanted motion" } else { "The simulated motion" };
    let peak = view.peak("peak_tip_acceleration_m_s2", &tip.acceleration_m_s2);
    let acceleration = view.figure(
        "tip-acceleration",
        "Acceleration of the tip",
        format!("{what}: tip acceleration, at most {peak} m/s²{}.", cited(run, [Some(3), None])),
        ("acceleration", "m/s²"),
        vec![view.curve("tip", Stroke::Solid(3), &tip.acceleration_m_s2)],
    );
    let travel = tip.displacement_m[tip.displacement_m.len() - 1] - tip.displacement_m[0];
    let travel = significant(travel, 4).replace('-', "−");
    let mut curves = vec![view.curve("tip", Stroke::Solid(3), &tip.displacement_m)];
    let mut beside = "";
    if let Some(target) = &run.target {
        let wanted = (&target.times_s, &target.wanted_m[0]);
        curves.push(view.over_time("wanted", Stroke::Dashed(2), wanted));
        beside = " Dashed: the target.";
    }
    let displacement = view.figure(
        "tip-displacement",
        "Displacement of the tip",
        format!(
            "{what}: tip displacement along the arc; it ends {travel} m from where it began{}.{beside}",
            cited(run, [Some(4), None])
        ),
        ("displacement", "m"),
        curves,
    );
    let formula = motion_formula(run, formula::TIP);
    [acceleration.by(formula.clone()), displacement.by(formula)]
}

/// How far the tip of a simulation is from its target.
fn tip_error(view: &View) -> Option<Figure> {
    let target = view.run.target.as_ref()?;
    let (worst_m, at) =
        (view.peak("tip_error_worst_m", &target.error_m), view.reading("tip_error_time_s"));
    let at = at.map(|at| format!(" at {}", given(at, "s"))).unwrap_or_default();
    let rms = view.reading("tip_error_rms_m");
    let rms = rms.map(|rms| format!("; root mean square {} m", significant(rms, 4)));
    let caption = format!(
        "Displacement of the tip less that of the target, at most {worst_m} m{at}{}.",
        rms.unwrap_or_default()
    );
    let error = (&target.times_s, &target.error_m);
    let curves = vec![view.over_time("simulated less wanted", Stroke::Solid(4), error)];
    let title = "How far the tip is from its target";
    let figure = view.figure("tip-error", title, caption, ("error", "m"), curves);
    Some(figure.by(formula::TIP_ERROR))
}

/// Torque at the hub, flexible against rigid.
fn torque(view: &View) -> Figure {
    let run = view.run;
    let own = if run.solved.is_some() { "flexible link" } else { "torque" };
    let mut curves = vec![view.curve(own, Stroke::Solid(1), &run.torque_n_m)];
    let peak = view.peak("peak_torque_n_m", &run.torque_n_m);
    let mut caption = format!("At most {peak} N m.");
    if let Some(solved) = &run.solved {
        let rigid = &solved.rigid_torque_n_m;
        curves.push(view.curve("rigid link", Stroke::Dashed(2), rigid));
        let rigid = view.peak("peak_rigid_torque_n_m", rigid);
        // Writing to a string cannot fail.
        let paper = cited(run, [Some(5), Some(7)]);
        let _ = write!(caption, " Were the link rigid, it would be {rigid} N m{paper}.");
        caption.push_str(&timing_words(solved));
    }
    let unit = "N m";
    caption.push_str(&Curve::add_limit(&mut curves, run.limits.torque_n_m, ("", unit), 1));
    let figure = view.figure("torque", "Torque at the hub", caption, ("torque", unit), curves);
    Figure { spans: view.lead_and_lag(), ..figure }.by(torque_formula(run))
}

/// The formula of a torque: of a solution with what it counts.
fn torque_formula(run: &StoredRun) -> Cow<'static, str> {
    let is_bent = run.second_order != SecondOrder::None || run.link.has_weight();
    match &run.solved {
        None => formula::TORQUE_PLAYED.into(),
        Some(_) if is_bent => format!("{} {}", formula::TORQUE, formula::SECOND_ORDER).into(),
        Some(_) => formula::TORQUE.into(),
    }
}

/// The formula of a motion: what a solution has, or what makes it in a simulation.
fn motion_formula(run: &StoredRun, solved: &'static str) -> Cow<'static, str> {
    match run.second_order {
        _ if run.solved.is_some() => solved.into(),
        SecondOrder::None => formula::MODES_PLAYED.into(),
        SecondOrder::First | SecondOrder::Full => formula::ELASTICA_PLAYED.into(),
    }
}

/// Velocity of the tip at the start, over its peak, from which on a motion does not start at rest.
const STARTS: f64 = 1e-6;

/// When the torque begins and ends relative to the motion.
fn timing_words(solved: &StoredSolution) -> String {
    let Some((lead_s, lag_s)) = solved.lead_s.zip(solved.lag_s) else {
        return " This is one cycle, which the torque repeats.".to_owned();
    };
    let size = |seconds: f64| significant(seconds.abs(), 4);
    if lead_s > 0.0 && lag_s > 0.0 {
        return format!(
            " Bending waves take time: it acts, at the 2 % level, from {} s before the tip moves \
             until {} s after it has stopped (shaded).",
            size(lead_s),
            size(lag_s)
        );
    }
    let start = if lead_s >= 0.0 { "before the tip sets out" } else { "after the tip has set out" };
    let stop = if lag_s >= 0.0 { "after it has stopped" } else { "before it has stopped" };
    let (lead, lag) = (size(lead_s), size(lag_s));
    format!(" It acts, at the 2 % level, from {lead} s {start} until {lag} s {stop}.")
}

/// Rotation of the hub, flexible against rigid.
fn hub(view: &View) -> Figure {
    let run = view.run;
    let own = if run.solved.is_some() { "flexible link" } else { "hub" };
    let mut curves = vec![view.curve(own, Stroke::Solid(1), &run.hub_angle_rad)];
    let mut caption = "What an encoder at the hub sees.".to_owned();
    if let Some(solved) = &run.solved {
        curves.push(view.curve("rigid link", Stroke::Dashed(2), &solved.rigid_hub_angle_rad));
        caption = format!(
            "What an encoder at the hub sees; the hub of a rigid link would turn as the tip does{}. What lies between the two \
             curves is bending.",
            cited(run, [Some(6), None])
        );
    }
    let (title, quantity) = ("Rotation of the hub", ("angle", "rad"));
    let figure = view.figure("hub-angle", title, caption, quantity, curves);
    Figure { spans: view.lead_and_lag(), ..figure }.by(motion_formula(run, formula::HUB))
}

/// The tip when the rigid link's torque is played on the flexible link.
fn tip_under_rigid_torque(view: &View, solved: &StoredSolution) -> Result<Figure, String> {
    let run = view.run;
    let torque = Torque::new(&run.times_s, solved.rigid_torque_n_m.clone())
        .map_err(|error| error.to_string())?;
    let [wanted, velocity] = [&run.tip.displacement_m, &run.tip.velocity_m_s];
    if solved.lead_s.is_none() || velocity[0].abs() > STARTS * largest(velocity) {
        return Err("it is played from rest, where this motion does not begin".to_owned());
    }
    let play = Play { initial_tip_m: wanted[0], ..Play::of(&torque) };
    let simulation =
        simulate_on(&run.link, run.mesh.clone(), &play).map_err(|error| error.to_string())?;
    let tip = &simulation.tip.displacement_m;
    let after = inside(&run.times_s, solved.moving_s.1, f64::INFINITY);
    let strays: Vec<f64> = after.map(|k| tip[k] - wanted[k]).collect();
    let strays_m = largest(&strays);
    if is_extreme(strays_m) {
        return Err("it strays by more or less than can be drawn".to_owned());
    }
    let share = 100.0 * strays_m / run.tip.largest_travel_m();
    let of_travel = if is_extreme(share) {
        String::new()
    } else {
        format!(", {} % of its travel", significant(share, 2))
    };
    let damping = match run.link.damping() {
        Damping::Hysteretic { .. } => ", its damping ratio as viscous in every mode",
        _ => "",
    };
    let strays_m = significant(strays_m, 3);
    let figure = view.figure(
        "tip-under-rigid-torque",
        "Tip under the rigid link's torque",
        format!(
            "What a controller gets that takes the link for rigid: its torque, played on the flexible \
             link{damping}{}. After the motion the tip still strays by up to \
             {strays_m} m{of_travel}.",
            cited(run, [Some(8), Some(9)])
        ),
        ("displacement", "m"),
        vec![
            view.curve("wanted", Stroke::Solid(3), wanted),
            view.curve("rigid link's torque", Stroke::Dashed(2), tip),
        ],
    );
    let is_bent = run.link.has_weight();
    Ok(figure.by(if is_bent { formula::ELASTICA_PLAYED } else { formula::RIGID_TORQUE_PLAYED }))
}
