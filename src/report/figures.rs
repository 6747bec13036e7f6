//! All figures of a result, and those of a run over time: figures 3 to 9 of the paper for this link.

use std::fmt::Write as _;

use super::bending::waves;
use super::chart::{Figure, Figures, Stroke, is_extreme};
use super::frequency::{shapes, transfer};
use super::sweep::sweep_figures;
use super::view::{View, inside};
use crate::link::Damping;
use crate::numeric::{largest, significant};
use crate::response::{Play, Simulation, Torque, simulate_on};
use crate::result::{StoredResult, StoredRun, StoredSolution};

impl Figures {
    /// All figures of a result.
    pub fn of(result: &StoredResult) -> Self {
        match result {
            StoredResult::Run(run) => run_figures(run),
            StoredResult::Sweep(sweep) => sweep_figures(sweep),
        }
    }
}

fn run_figures(run: &StoredRun) -> Figures {
    let view = &View::of(run);
    let mut figures = Figures::default();
    figures.add(Ok(torque(view)));
    for figure in motion(view) {
        figures.add(Ok(figure));
    }
    figures.add(Ok(hub(view)));
    figures.add(waves(view));
    if let Some(figure) = tip_under_rigid_torque(view) {
        figures.add(figure);
    }
    figures.add(transfer(run));
    figures.add(shapes(&run.mesh));
    figures
}

/// Acceleration and displacement of the tip (Bayo 1987, figures 3 and 4).
fn motion(view: &View) -> Vec<Figure> {
    let tip = &view.run.tip;
    let wanted = view.run.solved.is_some();
    let what = if wanted { "The motion asked for" } else { "The motion that the torque makes" };
    let acceleration = Figure {
        caption: format!(
            "{what}: tip acceleration, at most {} m/s² (figure 3 of the paper).",
            significant(largest(&tip.acceleration_m_s2), 3)
        ),
        ..view.figure(
            "tip-acceleration",
            "Acceleration of the tip",
            ("acceleration", "m/s²"),
            vec![view.curve("tip", Stroke::Solid(3), &tip.acceleration_m_s2)],
        )
    };
    let ends = tip.displacement_m[tip.displacement_m.len() - 1] - tip.displacement_m[0];
    let displacement = Figure {
        caption: format!(
            "{what}: tip displacement along the arc; it ends {} m from where it began (figure 4).",
            significant(ends, 3).replace('-', "−")
        ),
        ..view.figure(
            "tip-displacement",
            "Displacement of the tip",
            ("displacement", "m"),
            vec![view.curve("tip", Stroke::Solid(3), &tip.displacement_m)],
        )
    };
    vec![acceleration, displacement]
}

/// Torque at the hub, flexible against rigid (figures 5 and 7).
fn torque(view: &View) -> Figure {
    let run = view.run;
    let own = if run.solved.is_some() { "flexible link" } else { "torque" };
    let mut curves = vec![view.curve(own, Stroke::Solid(1), &run.torque_n_m)];
    let mut caption =
        format!("Torque at the hub, at most {} N m.", significant(largest(&run.torque_n_m), 4));
    if let Some(solved) = &run.solved {
        let rigid = &solved.rigid_torque_n_m;
        curves.push(view.curve("rigid link", Stroke::Dashed(2), rigid));
        let rigid = significant(largest(rigid), 4);
        // Writing to a string cannot fail.
        let _ = write!(caption, " Were the link rigid, it would be {rigid} N m (figures 5 and 7).");
        if let Some(motor) = &solved.motor_torque_n_m {
            curves.push(view.curve("motor", Stroke::Solid(4), motor));
            let motor = significant(largest(motor), 4);
            let _ = write!(caption, " On its side of the drive the motor gives up to {motor} N m.");
        }
        caption.push_str(&timing_words(solved));
    }
    Figure {
        caption,
        spans: view.lead_and_lag(),
        ..view.figure("torque", "Torque at the hub", ("torque", "N m"), curves)
    }
}

/// When the torque begins and ends relative to the motion.
fn timing_words(solved: &StoredSolution) -> String {
    let StoredSolution { lead_s, lag_s, .. } = *solved;
    let size = |seconds: f64| significant(seconds.abs(), 3);
    if lead_s > 0.0 && lag_s > 0.0 {
        return format!(
            " Bending waves take time: it exceeds 2 % of its peak from {} s before the tip moves \
             until {} s after it has stopped (shaded).",
            size(lead_s),
            size(lag_s)
        );
    }
    let side = |seconds: f64, before: &str, after: &str| {
        let place = if seconds >= 0.0 { before } else { after };
        format!("{} s {place}", size(seconds))
    };
    format!(
        " It exceeds 2 % of its peak from {} until {}.",
        side(lead_s, "before the tip sets out", "after the tip has set out"),
        side(lag_s, "after it has stopped", "before it has stopped")
    )
}

/// Rotation of the hub, flexible against rigid (figure 6).
fn hub(view: &View) -> Figure {
    let run = view.run;
    let own = if run.solved.is_some() { "flexible link" } else { "hub" };
    let mut curves = vec![view.curve(own, Stroke::Solid(1), &run.hub_angle_rad)];
    let mut caption = "Angle of the hub.".to_owned();
    if let Some(solved) = &run.solved {
        curves.push(view.curve("rigid link", Stroke::Dashed(2), &solved.rigid_hub_angle_rad));
        "Angle of the hub; the hub of a rigid link would turn as the tip does (figure 6). What lies \
         between the two curves is bending."
            .clone_into(&mut caption);
    }
    Figure {
        caption,
        spans: view.lead_and_lag(),
        ..view.figure("hub-angle", "Rotation of the hub", ("angle", "rad"), curves)
    }
}

/// The tip when the rigid link's torque is played on the flexible link (figures 8 and 9).
///
/// None for a run without a wanted motion; `Err` says why the figure cannot be drawn.
fn tip_under_rigid_torque(view: &View) -> Option<Result<Figure, String>> {
    let solved = view.run.solved.as_ref()?;
    let why = |error: String| format!("the tip under the rigid link's torque, since {error}");
    let drawn = simulated(view, solved).and_then(|simulation| strayed(view, solved, &simulation));
    Some(drawn.map_err(why))
}

fn simulated(view: &View, solved: &StoredSolution) -> Result<Simulation, String> {
    let run = view.run;
    let torque = Torque::new(&run.times_s, solved.rigid_torque_n_m.clone())
        .map_err(|error| error.to_string())?;
    let play = Play { initial_tip_m: run.tip.displacement_m[0], ..Play::of(&torque) };
    simulate_on(&run.link, run.mesh.clone(), &play).map_err(|error| error.to_string())
}

fn strayed(
    view: &View,
    solved: &StoredSolution,
    simulation: &Simulation,
) -> Result<Figure, String> {
    let (run, tip) = (view.run, &simulation.tip.displacement_m);
    let wanted = &run.tip.displacement_m;
    let after = inside(&run.times_s, solved.moving_s.1, f64::INFINITY);
    let strays: Vec<f64> = after.map(|k| tip[k] - wanted[k]).collect();
    let strays_m = largest(&strays);
    if is_extreme(strays_m) {
        return Err("it strays by more or less than can be drawn".to_owned());
    }
    let share = 100.0 * strays_m / run.tip.largest_travel_m();
    let of_way = if is_extreme(share) {
        String::new()
    } else {
        format!(", {} % of its way", significant(share, 2))
    };
    let damping = match run.link.damping() {
        Damping::Hysteretic { .. } => ", its damping ratio as viscous in every mode",
        _ => "",
    };
    let curves = vec![
        view.curve("wanted", Stroke::Solid(3), wanted),
        view.curve("rigid link's torque", Stroke::Dashed(2), tip),
    ];
    Ok(Figure {
        caption: format!(
            "What a controller gets that takes the link for rigid: its torque, played on the flexible \
             link{damping} (figures 8 and 9). After the motion the tip still strays by up to {} \
             m{of_way}.",
            significant(strays_m, 3)
        ),
        ..view.figure(
            "tip-under-rigid-torque",
            "Tip under the rigid link's torque",
            ("displacement", "m"),
            curves,
        )
    })
}
