//! Bending over x and t, as colours.

use super::moments::{Moments, bending_moments};
use super::view::View;
use crate::numeric::{largest, significant};
use crate::report::chart::{Across, Axis, ColourMap, Colours, Figure, Stroke, is_extreme};
use crate::result::StoredNodes;

/// Rows of a map: the link's length is cut into so many.
const ROWS: usize = 120;

/// Columns of a map: a figure has no more pixels.
const COLUMNS: usize = 680;

/// What runs along the link: the bending moment, or the deflection where the displacements written
/// are too few for it.
pub(super) fn waves(view: &View) -> Result<Figure, String> {
    let (name, what, nodes) = match (bending_moments(view), view.deflections()) {
        (Some(Moments { nodes, is_written: true }), _) => ("moment", "bending moment", nodes),
        (Some(Moments { nodes, is_written: false }), _) => {
            ("moment", "bending moment, estimated from the displacements,", nodes)
        }
        (None, Some(nodes)) => ("deflection", "deflection from the hub's tangent line", nodes),
        (None, None) => {
            return Err("waves and animation, since no node between root and tip was written, or \
                        but one moment"
                .to_owned());
        }
    };
    if is_extreme(nodes.peak()) {
        let why = "waves and animation, since what bends is too large or too small to be drawn";
        return Err(why.to_owned());
    }
    let story = if view.run.solved.is_some() && name == "moment" {
        " Before the tip moves a wave runs out to it: the colours begin earlier the nearer to the \
         hub. After the tip has stopped what is left runs back to the hub, where the torque takes it \
         up."
    } else {
        ""
    };
    let unit = if name == "moment" { "N m" } else { "m" };
    let caption = format!(
        "The {what} over time (to the right) and along the link (up, from the root), below the tip's \
         displacement. At each place it is over the largest there, {} {unit} in all, and colours go by \
         the square root, so that weak waves are seen too.{story}",
        significant(nodes.peak(), 2)
    );
    let tip = view.curve("tip displacement", Stroke::Solid(6), &view.run.tip.displacement_m);
    let above = Axis::around("tip", "m", tip.points.iter().map(|(_, value)| value));
    let (map, x) = map(view, &nodes, name);
    let base = Figure::new("waves", "Waves along the link", Across::Time, view.time_axis(), x);
    let marks = view.start_and_stop();
    Ok(Figure { caption, map: Some(map), strip: Some((tip, above)), marks, ..base })
}

/// A map over the time shown, linear between the moments and the nodes written, and its axis along
/// the link.
fn map(view: &View, nodes: &StoredNodes, name: &str) -> (ColourMap, Axis) {
    let (from_s, until_s) = view.span_s();
    let column = |k: usize| from_s + (until_s - from_s) * (k as f64 + 0.5) / COLUMNS as f64;
    let moments: Vec<Between> =
        (0..COLUMNS).map(|k| Between::of(&nodes.times_s, column(k))).collect();
    let nodes_m = view.run.mesh.nodes_m();
    let places: Vec<f64> = nodes.nodes.iter().map(|node| nodes_m[*node]).collect();
    let (first_m, last_m) = (places[0], places[places.len() - 1]);
    let row = |k: usize| {
        let x_m = first_m + (last_m - first_m) * (k as f64 + 0.5) / ROWS as f64;
        let place = Between::of(&places, x_m);
        let at = |moment: &Between| {
            let history = |node: usize| moment.mix(|k| nodes.histories[node][k]);
            place.mix(history)
        };
        over_largest(moments.iter().map(at).collect())
    };
    let map = ColourMap {
        name: name.to_owned(),
        unit: "(√ of share)".to_owned(),
        colours: Colours::Diverging,
        rows: (0..ROWS).map(row).collect(),
    };
    (map, Axis::linear("x", "m", first_m..last_m))
}

/// A place between two of ascending numbers.
struct Between {
    before: usize,
    share: f64,
}

impl Between {
    fn of(numbers: &[f64], at: f64) -> Self {
        let next = numbers.partition_point(|number| *number < at).clamp(1, numbers.len() - 1);
        let (low, high) = (numbers[next - 1], numbers[next]);
        Self { before: next - 1, share: ((at - low) / (high - low)).clamp(0.0, 1.0) }
    }

    fn mix(&self, of: impl Fn(usize) -> f64) -> f64 {
        let (a, b) = (of(self.before), of(self.before + 1));
        a + self.share * (b - a)
    }
}

/// Square root, with its sign, of what happens at a place over the largest there.
fn over_largest(mut values: Vec<f64>) -> Vec<f64> {
    let peak = largest(&values);
    if peak > 0.0 {
        for value in &mut values {
            *value = value.signum() * (value.abs() / peak).sqrt();
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::tests::run;

    #[test]
    fn colours_stand_at_their_time_however_the_rows_are_thinned() {
        let run = run();
        let whole = waves(&View::of(&run)).unwrap().map.unwrap();
        let mut thinned = run.clone();
        let nodes = thinned.deflections_m.as_mut().unwrap();
        for values in nodes.histories.iter_mut().chain([&mut nodes.times_s]) {
            *values = values.iter().copied().step_by(4).collect();
        }
        let thinned = waves(&View::of(&thinned)).unwrap().map.unwrap();
        let middle = ROWS / 2;
        for k in 0..COLUMNS {
            let apart = whole.rows[middle][k] - thinned.rows[middle][k];
            assert!(apart.abs() < 0.12, "column {k}: {apart}");
        }
    }

    #[test]
    fn the_tip_is_known_without_its_node() {
        let mut run = run();
        let whole = run.deflections_m.clone().unwrap();
        let nodes = run.deflections_m.as_mut().unwrap();
        for list in [0, nodes.nodes.len() - 2] {
            nodes.nodes.remove(list);
            nodes.histories.remove(list);
        }
        let found = View::of(&run).deflections().unwrap();
        assert_eq!(found.nodes, whole.nodes);
        for (found, written) in found.histories.iter().zip(&whole.histories) {
            let apart =
                found.iter().zip(written).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(apart < 1e-12, "{apart:e}");
        }
        run.deflections_m.as_mut().unwrap().nodes.clear();
        run.deflections_m.as_mut().unwrap().histories.clear();
        assert_eq!(View::of(&run).deflections(), None);
        assert!(waves(&View::of(&run)).is_err());
    }
}
