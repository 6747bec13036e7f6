//! Bending along the link: estimates of unwritten moments, deflections of an arm's links from their chords, and the
//! figure of waves.

use std::borrow::Cow;

use super::axis::{Axis, is_extreme};
use super::colour_map::{ColourMap, Colours};
use super::figure::{Figure, Stroke};
use super::view::{Single, View, from_start_m, inside, nearest, peak_words, reading};
use super::words::formula;
use crate::beam::Mesh;
use crate::numeric::largest;
use crate::result::{StoredNodes, StoredRun};

/// Number of columns of the map, one for each pixel; the step of accelerations is at most one column.
pub(super) const COLUMNS: usize = 680;

/// Fewest nodes for an estimate of moments.
const FEWEST: usize = 5;

/// Largest step of the accelerations, relative to the period of the first mode.
const COARSEST: f64 = 0.05;

/// Largest relative difference of the estimated root moment from the summary's.
pub(super) const TRUSTED: f64 = 0.1;

/// Bending moments in N m.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Moments {
    /// Moments at the nodes and times of the displacements, or as written.
    pub(super) nodes: StoredNodes,
    /// True if the run wrote them, false for estimates.
    pub(super) is_written: bool,
}

impl View<'_> {
    /// Deflections of a link from its chord. For a single link they are from the hub's tangent line, and include the
    /// root, 0, and the output, `v − Lθ` of a tip. `None` without a written node between the two, or with fewer than two times.
    pub(super) fn deflections(&self, link: usize) -> Option<StoredNodes> {
        let Some(run) = self.link else {
            return Some(deflections(self.first(), link)).filter(|nodes| nodes.times_s.len() > 1);
        };
        let written = self.first().links[link].deflections_m.clone();
        let mut nodes = written.filter(|nodes| nodes.times_s.len() > 1)?;
        let output = run.arc.mesh.output();
        if nodes.nodes.first() != Some(&0) {
            nodes.nodes.insert(0, 0);
            nodes.histories.insert(0, vec![0.0; nodes.times_s.len()]);
        }
        if let Err(at) = nodes.nodes.binary_search(&output) {
            let bent = bent_m(run);
            let bent = nodes.times_s.iter().map(|time_s| bent[nearest(run.times_s, *time_s)]);
            nodes.histories.insert(at, bent.collect());
            nodes.nodes.insert(at, output);
        }
        (nodes.nodes.len() > 2 || output < 2).then_some(nodes)
    }

    /// Written bending moments of a link or, for a single link, moments estimated from its displacements: force and
    /// moment at a node accelerate the part outboard.
    ///
    /// ```text
    /// m(x) = ∫ₓᴸ m̄ (s − x) v̈ ds + Σ [m (x_m − x) v̈ + J φ̈] + payload     (d'Alembert; v of Bayo 1987, eq 1)
    /// ```
    ///
    /// v̈ comes from second differences over time and is linear between nodes: exact enough for colours, not for
    /// design. `None` if nodes, times or digits do not suffice.
    pub(super) fn moments(&self, link: usize) -> Option<Moments> {
        let Some(run) = self.link else {
            let nodes = self.first().links[link].moments_n_m.clone()?;
            return Some(Moments { nodes, is_written: true });
        };
        if let Some(nodes) =
            self.first().links[link].moments_n_m.clone().filter(|nodes| nodes.times_s.len() > 1)
        {
            return Some(Moments { nodes, is_written: true });
        }
        // The part of the weight, and of the force that supports it, does not follow from accelerations.
        if self.has_weight() {
            return None;
        }
        let deflections = self.deflections(link)?;
        let step_s = deflections.times_s[1] - deflections.times_s[0];
        let (from_s, until_s) = self.span_s;
        let apart = (inside(&deflections.times_s, from_s, until_s).len() / COLUMNS).max(1);
        let is_fine = apart as f64 * step_s < COARSEST * self.period_s.unwrap_or(f64::INFINITY);
        if deflections.nodes.len() < FEWEST || deflections.times_s.len() < 3 || !is_fine {
            return None;
        }
        let histories = estimated(run, &deflections, (step_s, apart));
        let known = reading(run.readings, "peak_root_moment_n_m");
        let is_right =
            known.is_none_or(|peak| (largest(&histories[0]) / peak - 1.0).abs() < TRUSTED);
        let nodes = StoredNodes { histories, ..deflections };
        is_right.then_some(Moments { nodes, is_written: false })
    }
}

/// Deflection of a single link's output over the time of the run, in m: of a tip `v − Lθ`.
pub(super) fn bent_m(run: Single) -> Vec<f64> {
    let rigid_tip = run.arc.mesh.rigid_tip();
    let pairs = run.arc.tip.displacement_m.iter().zip(&run.joint.angle_rad);
    pairs.map(|(v, angle)| v - rigid_tip * (angle - run.arc.origin_rad)).collect()
}

/// Moments in N m at the nodes of deflections, from second differences over `apart` of their steps.
fn estimated(
    run: Single,
    deflections: &StoredNodes,
    (step_s, apart): (f64, usize),
) -> Vec<Vec<f64>> {
    let intervals = Interval::between(&run.arc.mesh, &deflections.nodes);
    let turns: Vec<f64> = deflections
        .times_s
        .iter()
        .map(|t| run.joint.angle_rad[nearest(run.times_s, *t)] - run.arc.origin_rad)
        .collect();
    // v of every node.
    let motion = |(node, w): (&usize, &Vec<f64>)| -> Vec<f64> {
        let rigid = run.arc.mesh.rigid(*node)[0];
        w.iter().zip(&turns).map(|(w, turn)| w + rigid * turn).collect()
    };
    let motions: Vec<_> =
        deflections.nodes.iter().zip(&deflections.histories).map(motion).collect();
    let last = turns.len() - 1;
    let apart = apart.min(last / 2);
    let square = (apart as f64 * step_s) * (apart as f64 * step_s);
    let mut histories = vec![Vec::with_capacity(turns.len()); deflections.nodes.len()];
    for k in 0..=last {
        let middle = k.clamp(apart, last - apart);
        let second = |v: &Vec<f64>| v[middle - apart] - 2.0 * v[middle] + v[middle + apart];
        let accelerations: Vec<f64> = motions.iter().map(|v| second(v) / square).collect();
        let moments = moments(run, deflections, &intervals, &accelerations);
        histories.iter_mut().zip(moments).for_each(|(history, moment)| history.push(moment));
    }
    histories
}

/// Length in m and mass in kg between two neighbouring nodes.
struct Interval {
    length_m: f64,
    mass_kg: f64,
}

impl Interval {
    fn between(mesh: &Mesh, nodes: &[usize]) -> Vec<Self> {
        let of = |pair: &[usize]| {
            let elements = &mesh.elements()[pair[0]..pair[1]];
            let mass = elements.iter().map(|e| e.length_m * e.mass_per_length_kg_m.mean());
            Self { length_m: elements.iter().map(|e| e.length_m).sum(), mass_kg: mass.sum() }
        };
        nodes.windows(2).map(of).collect()
    }
}

/// Moments in N m at the nodes, summed from the tip inward.
fn moments(run: Single, nodes: &StoredNodes, intervals: &[Interval], a: &[f64]) -> Vec<f64> {
    let payload = run.link.payload();
    let tip = a.len() - 1;
    // φ̈ of the chord inboard of a node.
    let turning = |k: usize| {
        let springs = run.arc.mesh.springs();
        let outer = k.max(1 + springs);
        (a[outer] - a[outer - 1]) / intervals[outer - 1].length_m
    };
    let mut force = payload.mass_kg * (a[tip] + payload.offset_m * turning(tip));
    let mut moment = payload.offset_m * force + payload.inertia_kg_m2 * turning(tip);
    let lumped = |k: usize| {
        let x_m = run.arc.mesh.nodes_m()[nodes.nodes[k]];
        let here = run.link.masses().iter().filter(|m| (m.at_m - x_m).abs() < 1e-9 * (1.0 + x_m));
        here.fold((0.0, 0.0), |(mass, inertia), m| (mass + m.mass_kg, inertia + m.inertia_kg_m2))
    };
    let mut found = Vec::with_capacity(a.len());
    for k in (0..=tip).rev() {
        if let Some(Interval { length_m, mass_kg }) = intervals.get(k) {
            // The load is linear between the two nodes.
            moment += force * length_m + mass_kg * length_m * (a[k] / 6.0 + a[k + 1] / 3.0);
            force += mass_kg * (a[k] + a[k + 1]) / 2.0;
        }
        let (mass_kg, inertia_kg_m2) = lumped(k);
        force += mass_kg * a[k];
        moment += inertia_kg_m2 * turning(k);
        found.push(moment);
    }
    found.reverse();
    found
}

/// Number of rows of the map, evenly spaced along the link.
pub(super) const ROWS: usize = 120;

/// A quantity of bending: name, unit, letter, words in a caption, formula.
type Quantity = (&'static str, &'static str, char, &'static str, &'static str);

const ARM_MOMENT: Quantity = ("moment", "N m", 'm', "bending moment", formula::ARM_MOMENT);
const MOMENT: Quantity = ("moment", "N m", 'm', "bending moment", formula::MOMENT);
const MOMENT_ESTIMATED: Quantity = (
    "moment",
    "N m",
    'm',
    "bending moment, estimated from the displacements,",
    formula::MOMENT_ESTIMATED,
);
const ARM_DEFLECTION: Quantity =
    ("deflection", "m", 'w', "deflection from the chord", formula::ARM_DEFLECTION);
const DEFLECTION: Quantity =
    ("deflection", "m", 'w', "deflection from the hub's tangent line", formula::DEFLECTION);

/// Waves along a link: the bending moment, or else the deflection. For an arm, the initial values are subtracted.
pub(super) fn waves(view: &View, link: usize) -> Result<Figure, String> {
    let is_arm = view.is_arm();
    let place = view.pick("the link".to_owned(), format!("link {}", view.number_of(link)));
    let omitted = |why: &str| {
        let waves = view.pick("waves and animation".to_owned(), format!("waves along {place}"));
        format!("{waves}, since {why}")
    };
    let few = view.pick(
        "no node between root and tip was written, or only one moment",
        "only one moment was written",
    );
    let (quantity, mut nodes) = match view.moments(link) {
        Some(Moments { nodes, is_written: true }) => (view.pick(MOMENT, ARM_MOMENT), nodes),
        Some(Moments { nodes, .. }) => (MOMENT_ESTIMATED, nodes),
        None => {
            let nodes = view.deflections(link).ok_or_else(|| omitted(few))?;
            (view.pick(DEFLECTION, ARM_DEFLECTION), nodes)
        }
    };
    let (name, unit, letter, what, formula) = quantity;
    if nodes.times_s.len() < 2 {
        return Err(omitted(few));
    }
    if is_extreme(nodes.peak()) {
        return Err(omitted("the bending is too large or too small to be drawn"));
    }
    for history in nodes.histories.iter_mut().filter(|_| is_arm) {
        let rest = history[0];
        for value in history {
            *value -= rest;
        }
    }
    let weight = if view.has_weight() { ", less its value at rest at first," } else { "" };
    let rest = view.pick("", weight);
    let root = view.pick("the root", "its joint");
    let beside = view.pick("displacement", "distance from its start");
    let story = if !is_arm && view.is_solved() && name == "moment" {
        " Before the tip moves, a wave runs out to it: near the hub the colours begin earlier. After the tip has \
         stopped, the rest of the wave runs back to the hub, where the torque absorbs it."
    } else {
        ""
    };
    let peak = peak_words(known_peak(view, name, &nodes), &[nodes.peak()]);
    let caption = format!(
        "The {what}{rest} over time (to the right) and along the link (up, from {root}), below the tip's \
         {beside}; it reaches {peak} {unit}. Colours show the square root, so that weak waves are visible, too.{story}"
    );
    let (of_tip, travel_m) = match view.link {
        Some(run) => ("tip displacement", Cow::Borrowed(&run.arc.tip.displacement_m)),
        None => ("tip from its start", Cow::Owned(from_start_m(view.first()))),
    };
    let tip = view.curve(of_tip, Stroke::Solid(6), &view.first().times_s, &travel_m);
    let above = Axis::around("tip", "m", tip.points.iter().map(|(_, value)| value));
    let (map, x) = map(view.span_s, &nodes, &view.first().links[link].nodes_m, (name, unit));
    let id = view.id("waves", link);
    let figure = Figure::new(id, &format!("Waves along {place}"), caption, view.time_axis(), x);
    let colour =
        format!(" Colour: sign({letter}) √(|{letter}| / max |{letter}|) of the drawn quantity.");
    let marks = view.start_and_stop();
    Ok(Figure { map: Some(map), strip: Some((tip, above)), marks, ..figure }
        .by(formula.to_owned() + &colour))
}

/// Peak of a single link's moment or deflection in the summary, which includes peaks between samples; only if the peak
/// is at the root or the tip.
fn known_peak(view: &View, name: &str, nodes: &StoredNodes) -> Option<f64> {
    let readings = &view.link?.readings;
    let (end, known) = if name == "moment" {
        ((nodes.nodes[0] == 0).then_some(0), reading(readings, "peak_root_moment_n_m"))
    } else {
        (nodes.histories.len().checked_sub(1), reading(readings, "peak_deflection_m"))
    };
    let is_there = end.is_some_and(|end| largest(&nodes.histories[end]) >= nodes.peak());
    known.filter(|_| is_there)
}

/// A map over the shown time, linear between times and between nodes at `nodes_m`, and its axis along the link.
pub(super) fn map(
    (from_s, until_s): (f64, f64),
    nodes: &StoredNodes,
    nodes_m: &[f64],
    (name, unit): (&str, &str),
) -> (ColourMap, Axis) {
    let column = |k: usize| from_s + (until_s - from_s) * (k as f64 + 0.5) / COLUMNS as f64;
    let moments: Vec<Interpolation> =
        (0..COLUMNS).map(|k| Interpolation::of(&nodes.times_s, column(k))).collect();
    let places: Vec<f64> = nodes.nodes.iter().map(|node| nodes_m[*node]).collect();
    let (first_m, last_m) = (places[0], places[places.len() - 1]);
    let row = |k: usize| {
        let x_m = first_m + (last_m - first_m) * (k as f64 + 0.5) / ROWS as f64;
        let place = Interpolation::of(&places, x_m);
        let at = |moment: &Interpolation| {
            let history = |node: usize| moment.mix(|k| nodes.histories[node][k]);
            place.mix(history)
        };
        moments.iter().map(at).collect()
    };
    let map = ColourMap {
        name: name.to_owned(),
        unit: unit.to_owned(),
        colours: Colours::Diverging,
        rows: (0..ROWS).map(row).collect(),
        fields: None,
    };
    (map, Axis::linear("x", "m", first_m..last_m))
}

/// Linear interpolation between two of ascending numbers; the first or the last beyond them.
pub(super) struct Interpolation {
    before: usize,
    share: f64,
}

impl Interpolation {
    pub(super) fn of(numbers: &[f64], at: f64) -> Self {
        let next = numbers.partition_point(|number| *number < at).clamp(1, numbers.len() - 1);
        let (low, high) = (numbers[next - 1], numbers[next]);
        Self { before: next - 1, share: ((at - low) / (high - low)).clamp(0.0, 1.0) }
    }

    pub(super) fn mix(&self, of: impl Fn(usize) -> f64) -> f64 {
        let (a, b) = (of(self.before), of(self.before + 1));
        a + self.share * (b - a)
    }
}

/// The chord of a link at one moment.
pub(super) struct Chord {
    /// Position of its joint in m.
    pub(super) start_m: [f64; 2],
    /// Direction in rad, from −π to π.
    pub(super) angle_rad: f64,
    pub(super) length_m: f64,
}

impl Chord {
    /// The chord of a link at a row of the nodes' places.
    pub(super) fn of(arm: &StoredRun, link: usize, row: usize) -> Self {
        let tip = |link: usize| {
            let places = &arm.links[link].positions_m;
            places[places.len() - 1].each_ref().map(|axis| axis[row])
        };
        let base_m = || arm.base_m(nearest(&arm.times_s, arm.nodal_times_s[row]));
        let start_m = link.checked_sub(1).map_or_else(base_m, tip);
        let [along_x, along_y] = [0, 1].map(|axis| tip(link)[axis] - start_m[axis]);
        let angle_rad = libm::atan2(along_y, along_x);
        Self { start_m, angle_rad, length_m: libm::hypot(along_x, along_y) }
    }

    /// Distance of a place from the chord in m, positive to its left.
    fn deflection_m(&self, place_m: [f64; 2]) -> f64 {
        let [x, y] = [0, 1].map(|axis| place_m[axis] - self.start_m[axis]);
        y * libm::cos(self.angle_rad) - x * libm::sin(self.angle_rad)
    }
}

/// Deflections of a link's nodes from its chord in m.
pub(super) fn deflections(arm: &StoredRun, link: usize) -> StoredNodes {
    let times_s = arm.nodal_times_s.clone();
    let chords: Vec<Chord> = (0..times_s.len()).map(|row| Chord::of(arm, link, row)).collect();
    let of = |places: &[Vec<f64>; 2]| {
        let at = |row: usize| chords[row].deflection_m(places.each_ref().map(|axis| axis[row]));
        (0..chords.len()).map(at).collect()
    };
    let histories: Vec<Vec<f64>> = arm.links[link].positions_m.iter().map(of).collect();
    StoredNodes { nodes: (0..histories.len()).collect(), times_s, histories }
}

/// Number of nodes that determine the slope at a root.
const AT_ROOT: usize = 5;

/// Deflection in m of a link's tip from the tangent line at its root, whose slope comes from the polynomial through the
/// first nodes, or from the rigid piece that leads to them.
pub(super) fn tip_deflection_m(arm: &StoredRun, link: usize) -> Vec<f64> {
    let own = &arm.links[link];
    let nodes = deflections(arm, link);
    let x_m = &own.nodes_m[..own.nodes_m.len().min(AT_ROOT)];
    let slope = |row: usize| {
        if x_m[0] > 0.0 {
            return nodes.histories[0][row] / x_m[0];
        }
        let weight = |j: usize| {
            let others = (1..x_m.len()).filter(|m| *m != j);
            others.fold(1.0 / x_m[j], |weight, m| weight * x_m[m] / (x_m[m] - x_m[j]))
        };
        (1..x_m.len()).map(|j| weight(j) * nodes.histories[j][row]).sum()
    };
    let deflection =
        |row: usize| -Chord::of(arm, link, row).length_m * libm::sin(libm::atan(slope(row)));
    (0..nodes.times_s.len()).map(deflection).collect()
}
