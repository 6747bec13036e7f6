//! Shapes of the first modes.

use std::f64::consts::TAU;

use crate::beam::Mesh;
use crate::modal::{Shape, mode, natural_frequencies};
use crate::numeric::significant;
use crate::report::chart::{Across, Axis, Curve, Figure, Stroke};

/// Modes that are drawn.
const MODES: usize = 4;

/// Points of a shape at least, so that cubics look like cubics.
const POINTS: usize = 120;

/// Displacement along the link in its first modes; none where nothing vibrates.
pub(super) fn shapes(mesh: &Mesh) -> Result<Figure, String> {
    let frequencies = natural_frequencies(mesh, MODES);
    if frequencies.is_empty() {
        return Err("mode shapes, since nothing vibrates".to_owned());
    }
    let curve = |(k, omega): (usize, &f64)| {
        let points = smooth(mesh, &mode(mesh, *omega).shape);
        let peak = points.iter().fold(f64::MIN_POSITIVE, |peak, (_, v)| peak.max(v.abs()));
        Curve {
            name: format!("mode {}, {} Hz", k + 1, significant(omega / TAU, 3)),
            stroke: if k % 2 == 0 { Stroke::Solid(k + 1) } else { Stroke::Dashed(k + 1) },
            points: points.into_iter().map(|(x, v)| (x, v / peak)).collect(),
        }
    };
    let curves: Vec<Curve> = frequencies.iter().enumerate().map(curve).collect();
    let x = Axis::linear("x", "m", 0.0..mesh.length_m());
    let y = Axis::linear("displacement", "", -1.1..1.1);
    Ok(Figure {
        caption: "Displacement along the link, from the hub's axis to the tip, while it vibrates freely \
                  about its hub; each shape over its largest value. The slope at the hub is the hub's \
                  own turning."
            .to_owned(),
        curves,
        ..Figure::new("mode-shapes", "Mode shapes", Across::Other, x, y)
    })
}

/// The shape by the elements' own cubics, from the axis on: a rigid radius turns with the hub.
fn smooth(mesh: &Mesh, shape: &Shape) -> Vec<(f64, f64)> {
    let nodes_m = mesh.nodes_m();
    let parts = POINTS.div_ceil(mesh.elements().len());
    let mut points = vec![(0.0, 0.0)];
    for (k, pair) in nodes_m.windows(2).enumerate() {
        let (l, [inner, outer]) =
            (pair[1] - pair[0], [k, k + 1].map(|node| shape.deflections[node]));
        for part in 0..=parts {
            let s = part as f64 / parts as f64;
            // Hermite's cubics (Bayo 1987, eq 8).
            let bend = inner[0] * (1.0 - 3.0 * s * s + 2.0 * s * s * s)
                + l * inner[1] * (s - 2.0 * s * s + s * s * s)
                + outer[0] * (3.0 * s * s - 2.0 * s * s * s)
                + l * outer[1] * (s * s * s - s * s);
            let x = pair[0] + s * l;
            points.push((x, bend + x * shape.hub_angle));
        }
    }
    points.dedup_by(|a, b| a.0 <= b.0);
    points
}
