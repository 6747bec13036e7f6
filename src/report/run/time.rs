//! Motion, torque and hub over time: the figures 3 to 7 of the paper, for this link.

use std::fmt::Write as _;

use super::view::View;
use crate::numeric::{largest, significant};
use crate::report::chart::{Figure, Stroke};
use crate::result::StoredSolution;

/// Acceleration and displacement of the tip (Bayo 1987, figures 3 and 4).
pub(super) fn motion(view: &View) -> Vec<Figure> {
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
pub(super) fn torque(view: &View) -> Figure {
    let run = view.run;
    let own = if run.solved.is_some() { "flexible link" } else { "torque" };
    let mut curves = vec![view.curve(own, Stroke::Solid(1), &run.torque_n_m)];
    let mut caption =
        format!("Torque at the hub, at most {} N m.", significant(largest(&run.torque_n_m), 4));
    if let Some(solved) = &run.solved {
        let rigid = &solved.rigid_torque_n_m;
        curves.push(view.curve("rigid link", Stroke::Dashed(2), rigid));
        let rigid = significant(largest(rigid), 4);
        // Into a string nothing fails.
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

/// When the torque acts beside the motion.
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
pub(super) fn hub(view: &View) -> Figure {
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
