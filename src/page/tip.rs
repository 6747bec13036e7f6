//! Figures of the tip: motion along the arc for a link, place for an arm, and distance from the wanted motion.

use std::borrow::Cow;

use super::axis::{digits, is_extreme};
use super::bending::Interpolation;
use super::figure::{Curve, Figure, Stroke};
use super::link::given;
use super::paper::cited;
use super::view::{COLOURS, Single, View, from_start_m, inside, reading, run_stroke};
use super::words::{formula, own};
use crate::elastica::SecondOrder;
use crate::link::Damping;
use crate::motion::Prescribed;
use crate::numeric::largest;
use crate::response::{Play, Torque, simulate_on};
use crate::result::{StoredJoint, StoredRun};
use crate::text::significant;

/// Acceleration and displacement of the tip of a link.
pub(super) fn motion(view: &View, run: Single) -> [Figure; 2] {
    let tip = &run.arc.tip;
    let what = if view.is_solved() { "The wanted motion" } else { "The simulated motion" };
    let peak = view.peak("peak_tip_acceleration_m_s2", &tip.acceleration_m_s2);
    let acceleration = view.figure(
        "tip-acceleration",
        "Acceleration of the tip",
        format!("{what}: tip acceleration, at most {peak} m/s²{}.", cited(view, [Some(3), None])),
        ("acceleration", "m/s²"),
        view.of_links(("tip", 3), |run| {
            Some((run.times_s, Cow::from(&run.arc.tip.acceleration_m_s2)))
        }),
    );
    let travel = tip.displacement_m[tip.displacement_m.len() - 1] - tip.displacement_m[0];
    let travel = digits(travel, 4);
    let mut curves = view
        .of_links(("tip", 3), |run| Some((run.times_s, Cow::from(&run.arc.tip.displacement_m))));
    let cited = cited(view, [Some(4), None]);
    let mut caption = format!(
        "{what}: tip displacement along the arc; it ends {travel} m from where it began{cited}."
    );
    if let Some(target) = &view.first().target {
        curves.push(view.curve("wanted", Stroke::Dashed(2), &target.times_s, &target.wanted_m[0]));
        caption.push_str(" Dashed: the target.");
    }
    let (title, quantity) = ("Displacement of the tip", ("displacement", "m"));
    let displacement = view.figure("tip-displacement", title, caption, quantity, curves);
    [acceleration, displacement].map(|figure| figure.by(motion_formula(view, formula::TIP)))
}

/// Formula of a link's motion: for a solution `solved`, for a simulation the formula of its model.
pub(super) fn motion_formula(view: &View, solved: &'static str) -> &'static str {
    match view.link.map(|run| run.arc.second_order) {
        _ if view.is_solved() => solved,
        None | Some(SecondOrder::None) => formula::MODES_PLAYED,
        Some(SecondOrder::First | SecondOrder::Full) => formula::ELASTICA_PLAYED,
    }
}

/// Place of the tip of an arm.
pub(super) fn place(view: &View) -> Figure {
    let names = ["x", "y"].map(str::to_owned);
    let mut curves = view.each(&names, |arm, axis| {
        arm.arc.is_none().then(|| (&arm.times_s[..], arm.tip_m[axis].clone()))
    });
    let travel_m = view.peak("farthest_m", &from_start_m(view.first()));
    let mut caption = format!("Place of the tip; it gets up to {travel_m} m away from its start.");
    if let Some(target) = &view.first().target {
        for (axis, history) in names.iter().zip(&target.wanted_m) {
            let name = format!("wanted {axis}");
            let colour = 1 + (2 + curves.len()) % COLOURS;
            curves.push(view.curve(&name, Stroke::Dashed(colour), &target.times_s, history));
        }
        caption.push_str(" Dashed: the target.");
    }
    view.figure("tip", "Place of the tip", caption, ("place", "m"), curves).by(formula::ARM_TIP)
}

/// Distance of a run's tip from the wanted motion: of a simulation from its target, or else from the motion of the
/// first solved run.
pub(super) struct Strays<'a> {
    /// Number of the run.
    pub(super) run: usize,
    times_s: &'a [f64],
    /// Of a link with a sign, of an arm the distance.
    error_m: Cow<'a, [f64]>,
}

impl Strays<'_> {
    pub(super) fn largest_m(&self) -> f64 {
        largest(&self.error_m)
    }
}

/// How far the tips of simulations stray. The tip error of a solved run is among its errors.
pub(super) fn strays<'a>(view: &View<'a>) -> Vec<Strays<'a>> {
    let of_link = view.link.is_some();
    let rigid = view.runs.iter().find(|run| run.moving_s.is_some());
    let rigid = rigid.filter(|run| run.arc.is_some() == of_link);
    let wanted_m = rigid.filter(|_| !of_link).and_then(rigid_tip_m);
    let of = |(run, arm): (usize, &'a StoredRun)| -> Option<Strays<'a>> {
        if arm.arc.is_some() != of_link || arm.moving_s.is_some() {
            return None;
        }
        if let Some(target) = &arm.target {
            let error_m = Cow::from(&target.error_m);
            return Some(Strays { run, times_s: &target.times_s, error_m });
        }
        let rigid = rigid?;
        let times_s = &arm.times_s;
        let error_m: Vec<f64> = match (&arm.arc, &rigid.arc, &wanted_m) {
            (Some(own), Some(wanted), _) => {
                let (own_m, wanted_m) = (&own.tip.displacement_m, &wanted.tip.displacement_m);
                let wanted = at_times(times_s, (&rigid.times_s, wanted_m));
                // Without a target a simulation begins at 0, wherever the motion does.
                let apart_m = own_m[0] - wanted[0];
                own_m.iter().zip(wanted).map(|(own, wanted)| own - wanted - apart_m).collect()
            }
            (None, None, Some(wanted)) => {
                let [x, y] = [0, 1].map(|axis| at_times(times_s, (&rigid.times_s, &wanted[axis])));
                let off = |k: usize| libm::hypot(arm.tip_m[0][k] - x[k], arm.tip_m[1][k] - y[k]);
                (0..times_s.len()).map(off).collect()
            }
            _ => return None,
        };
        Some(Strays { run, times_s, error_m: error_m.into() })
    };
    view.runs.iter().enumerate().filter_map(of).collect()
}

/// How far the tips of the runs are from the wanted motion; `None` without a target and a solved run beside.
pub(super) fn error(view: &View) -> Option<Figure> {
    if view.runs.len() == 1 {
        return off_target(view);
    }
    let names: Vec<String> = view.named("").map(|(_, name)| name).collect();
    let all = strays(view);
    let worst =
        all.iter().map(|own| format!("{} {} m", names[own.run], significant(own.largest_m(), 2)));
    let worst = worst.collect::<Vec<_>>().join(", ");
    let curve =
        |own: &Strays| view.curve(&names[own.run], run_stroke(own.run), own.times_s, &own.error_m);
    let curves: Vec<Curve> = all.iter().map(curve).collect();
    if curves.is_empty() {
        return None;
    }
    let solved = view.runs.iter().find(|run| run.moving_s.is_some());
    let from = match solved.and_then(|run| run.prescribed) {
        Some(Prescribed::Angles) => "the tip of the rigid arm with the same directions",
        _ => "where it is wanted",
    };
    let what =
        view.pick("Displacement of the tip less the wanted one", "Distance of the tip from ");
    let from = view.pick("", from);
    let by_target = all.iter().any(|own| view.runs[own.run].target.is_some());
    let by_run = all.iter().any(|own| view.runs[own.run].target.is_none());
    let of_run = solved.filter(|_| by_run).map(|run| own(&run.name));
    let of_target = by_target.then(|| "the target of each simulation that has one".to_owned());
    let wanted = [of_target, of_run].into_iter().flatten().collect::<Vec<_>>().join(", else ");
    let caption = format!("{what}{from}, at most: {worst}. The wanted motion is that of {wanted}.");
    let (title, quantity) = ("How far the tip strays", ("distance", "m"));
    let quantity = view.pick(("error", "m"), quantity);
    let figure = view.figure("tip-error", title, caption, quantity, curves);
    let of_link = match (by_target, by_run) {
        (true, true) => {
            format!("{} Without a target: {}", formula::TIP_ERROR, formula::TIP_ERROR_BESIDE)
        }
        (true, false) => formula::TIP_ERROR.to_owned(),
        _ => formula::TIP_ERROR_BESIDE.to_owned(),
    };
    Some(figure.by(view.pick(of_link, formula::ARM_TIP_ERROR.to_owned())))
}

/// Distance of a simulation's tip from its target.
fn off_target(view: &View) -> Option<Figure> {
    let arm = view.first();
    let target = arm.target.as_ref()?;
    let [what, line, quantity] = view.pick(
        ["Displacement of the tip less that of the target", "simulated less wanted", "error"],
        ["Distance of the tip from its target", "distance", "distance"],
    );
    let worst_m = view.peak("tip_error_worst_m", &target.error_m);
    let at = reading(&arm.readings, "tip_error_time_s").map(|at| format!(" at {}", given(at, "s")));
    let rms = reading(&arm.readings, "tip_error_rms_m");
    let rms = rms.map(|rms| format!("; root mean square {} m", significant(rms, 4)));
    let [at, rms] = [at, rms].map(Option::unwrap_or_default);
    let caption = format!("{what}, at most {worst_m} m{at}{rms}.");
    let curves = vec![view.curve(line, Stroke::Solid(4), &target.times_s, &target.error_m)];
    let title = "How far the tip is from its target";
    let figure = view.figure("tip-error", title, caption, (quantity, "m"), curves);
    Some(figure.by(view.pick(formula::TIP_ERROR, formula::ARM_TIP_ERROR)))
}

/// Velocity of the tip at the start, over its peak, above which a motion does not start at rest.
const STARTS: f64 = 1e-6;

/// The tip of the flexible link under the rigid link's torque.
pub(super) fn under_rigid_torque(view: &View, run: Single) -> Result<Figure, String> {
    const TITLE: &str = "the tip under the rigid link's torque, since";
    let joint = &view.first().joints[0];
    let rigid_n_m = joint.rigid_torque_n_m.clone().unwrap_or_default();
    let torque = Torque::new(run.times_s, rigid_n_m).map_err(|error| format!("{TITLE} {error}"))?;
    let [wanted, velocity] = [&run.arc.tip.displacement_m, &run.arc.tip.velocity_m_s];
    if joint.reading("lead_s").is_none() || velocity[0].abs() > STARTS * largest(velocity) {
        return Err(format!("{TITLE} it is played from rest, where this motion does not begin"));
    }
    let play = Play { initial_tip_m: wanted[0], ..Play::of(&torque) };
    let simulation = simulate_on(run.link, run.arc.mesh.clone(), &play)
        .map_err(|error| format!("{TITLE} {error}"))?;
    let tip = &simulation.tip[0].displacement_m;
    let stop_s = view.first().moving_s.map_or(f64::NEG_INFINITY, |(_, until)| until);
    let after = inside(run.times_s, stop_s, f64::INFINITY);
    let strays: Vec<f64> = after.map(|k| tip[k] - wanted[k]).collect();
    let strays_m = largest(&strays);
    if is_extreme(strays_m) {
        return Err(format!("{TITLE} it strays by more or less than can be drawn"));
    }
    let share = 100.0 * strays_m / run.arc.tip.largest_travel_m();
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
    let caption = format!(
        "Result of a controller that assumes a rigid link: its torque, played on the flexible link{damping}{}. After \
         the motion the tip still strays by up to \
         {strays_m} m{of_travel}.",
        cited(view, [Some(8), Some(9)])
    );
    let curves = vec![
        view.curve("wanted", Stroke::Solid(3), run.times_s, wanted),
        view.curve("rigid link's torque", Stroke::Dashed(2), run.times_s, tip),
    ];
    let (title, quantity) = ("Tip under the rigid link's torque", ("displacement", "m"));
    let figure = view.figure("tip-under-rigid-torque", title, caption, quantity, curves);
    let is_bent = view.has_weight();
    Ok(figure.by(if is_bent { formula::ELASTICA_PLAYED } else { formula::RIGID_TORQUE_PLAYED }))
}

/// A history interpolated to other times.
pub(super) fn at_times(times_s: &[f64], (own_s, history): (&[f64], &[f64])) -> Vec<f64> {
    let at = |time_s: &f64| Interpolation::of(own_s, *time_s).mix(|k| history[k]);
    times_s.iter().map(at).collect()
}

/// Directions of the rigid arm's links in rad at a sample, if its joint angles are known.
pub(super) fn rigid_directions_rad(arm: &StoredRun, sample: usize) -> Option<Vec<f64>> {
    let mut direction = 0.0;
    let turned = |joint: &StoredJoint| {
        direction += joint.rigid_angle_rad.as_ref()?[sample];
        Some(direction)
    };
    arm.joints.iter().map(turned).collect()
}

/// x and y of the rigid arm's tip in m: the wanted place if the path prescribes the tip.
pub(super) fn rigid_tip_m(arm: &StoredRun) -> Option<[Vec<f64>; 2]> {
    let mut tip_m = [Vec::new(), Vec::new()];
    for sample in 0..arm.times_s.len() {
        let mut at = arm.base_m(sample);
        for (angle, own) in rigid_directions_rad(arm, sample)?.iter().zip(&arm.links) {
            at[0] += own.link.length_m() * libm::cos(*angle);
            at[1] += own.link.length_m() * libm::sin(*angle);
        }
        tip_m.iter_mut().zip(at).for_each(|(axis, at)| axis.push(at));
    }
    Some(tip_m)
}
