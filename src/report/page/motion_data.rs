//! What the animation plays: the motion, thinned, as JSON inside the page.

use serde_json::{Value, json};

use super::link_drawing::{largest_stiffness, relative_thickness};
use crate::numeric::{largest, rounded};
use crate::report::View;
use crate::report::chart::{evenly, is_extreme};
use crate::report::run::{bending_moments, inside, nearest};
use crate::result::{StoredNodes, StoredRun};

/// Frames and nodes at most.
const FRAMES: usize = 600;
const NODES: usize = 61;

/// Digits of its numbers: more than an eye can tell.
const DIGITS: usize = 5;

/// The motion over the time shown; none where no nodes were written, or what moves is too large or too
/// small to be drawn.
pub(super) fn motion_data(view: &View) -> Option<String> {
    let run = view.run;
    let nodes = &view.deflections()?;
    // What only turns an arrow or the hub may be small.
    let [torque_n_m, angle_rad] =
        [&run.torque_n_m, &run.hub_angle_rad].map(|h| largest(h).max(1.0));
    let tip_m = largest(&run.tip.displacement_m);
    if [torque_n_m, angle_rad, tip_m, nodes.peak()].into_iter().any(is_extreme) {
        return None;
    }
    let (from_s, until_s) = view.span_s();
    let shown = inside(&nodes.times_s, from_s, until_s);
    let frames: Vec<usize> =
        evenly(shown.len(), FRAMES).into_iter().map(|k| shown.start + k).collect();
    // The nodes may be thinned over time: each frame's sample of the run.
    let samples: Vec<usize> =
        frames.iter().map(|k| nearest(&run.times_s, nodes.times_s[*k])).collect();
    let of = |history: &[f64]| -> Vec<f64> { samples.iter().map(|k| short(history[*k])).collect() };
    let kept = evenly(nodes.nodes.len(), NODES);
    let of_nodes = |quantity: &StoredNodes, frame: &usize| -> Vec<f64> {
        kept.iter().map(|node| short(quantity.histories[*node][*frame])).collect()
    };
    // Moments written at other nodes or times than the deflections are not played.
    let alike = |m: &StoredNodes| {
        m.nodes == nodes.nodes && m.times_s.len() == nodes.times_s.len() && !is_extreme(m.peak())
    };
    let moments = bending_moments(view).map(|moments| moments.nodes).filter(alike);
    let solved = run.solved.as_ref();
    let link = &run.link;
    let body = |at: f64, kg: f64| json!({ "at_m": at, "mass_kg": kg });
    let data = json!({
        "times_s": frames.iter().map(|k| rounded(nodes.times_s[*k], 9)).collect::<Vec<_>>(),
        "hub_angle_rad": of(&run.hub_angle_rad),
        "rigid_hub_angle_rad": solved.map(|solved| of(&solved.rigid_hub_angle_rad)),
        "torque_n_m": of(&run.torque_n_m),
        "tip_m": of(&run.tip.displacement_m),
        "nodes_m": kept.iter().map(|k| short(run.mesh.nodes_m()[nodes.nodes[*k]])).collect::<Vec<_>>(),
        "deflection_m": frames.iter().map(|k| of_nodes(nodes, k)).collect::<Vec<_>>(),
        "moment_n_m": moments.as_ref().map(|moments| frames.iter().map(|k| of_nodes(moments, k)).collect::<Vec<_>>()),
        "length_m": link.length_m(),
        "hub_radius_m": link.hub().radius_m,
        "payload": { "mass_kg": link.payload().mass_kg, "offset_m": link.payload().offset_m },
        "masses": link.masses().iter().map(|m| body(m.at_m, m.mass_kg)).collect::<Vec<_>>(),
        "peak_torque_n_m": largest(&run.torque_n_m),
        "peak_deflection_m": nodes.peak(),
        "thickness": thickness(run),
    });
    // Inside a page no text may look like the end of the script.
    Some(data.to_string().replace('<', "\\u003c"))
}

/// Relative thickness along the link: two places for each segment.
fn thickness(run: &StoredRun) -> Vec<Value> {
    let largest = largest_stiffness(&run.link);
    let mut at = run.link.hub().radius_m;
    let mut places = Vec::new();
    for segment in run.link.segments() {
        let taper = segment.bending_stiffness_n_m2;
        for (x, stiffness) in [(at, taper.inner), (at + segment.length_m, taper.outer)] {
            places.push(json!([short(x), short(relative_thickness(stiffness, largest))]));
        }
        at += segment.length_m;
    }
    places
}

/// A number as short as an eye can tell.
fn short(value: f64) -> f64 {
    rounded(value, DIGITS)
}
