//! Motion of a link or an arm for the animation, and the poses of an arm in a drawing.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use maud::{Markup, html};
use serde_json::{Value, json};

use super::axis::{digits, is_extreme};
use super::bending::Chord;
use super::figure::evenly;
use super::link::{given, largest_stiffness, short, thickness};
use super::tip::{rigid_directions_rad, rigid_tip_m};
use super::view::{View, inside, nearest, run_stroke};
use crate::motion::Prescribed;
use crate::numeric::{largest, rounded};
use crate::result::{StoredNodes, StoredRun};

/// Largest number of frames, and of nodes.
const FRAMES: usize = 600;
const NODES: usize = 61;

/// The motion at the moments and nodes of a page.
pub(super) struct Motion {
    /// Rows of the nodes' tables, and samples of all other histories at their times.
    rows: Vec<usize>,
    samples: Vec<usize>,
    /// For each link its deflections in m, and the numbers of the shown histories.
    links: Vec<(StoredNodes, Vec<usize>)>,
    /// Magnification of the drawn deflections.
    factor: f64,
}

impl Motion {
    /// `None` if there is only one moment, or if the numbers are too large or too small for a drawing.
    pub(super) fn of(view: &View) -> Option<Self> {
        let arm = view.first();
        let most = (NODES / arm.links.len()).max(9);
        let links = (0..arm.links.len()).map(|link| {
            let own = view.deflections(link)?;
            let nodes = evenly(own.histories.len(), most);
            Some((own, nodes))
        });
        let links: Vec<_> = links.collect::<Option<_>>()?;
        let times_s = &links[0].0.times_s;
        let inside = inside(times_s, view.span_s.0, view.span_s.1);
        let rows: Vec<usize> =
            evenly(inside.len(), FRAMES).into_iter().map(|k| inside.start + k).collect();
        // Nodes may be written at fewer times than the other histories.
        let samples = rows.iter().map(|row| nearest(&arm.times_s, times_s[*row])).collect();
        // A small torque or angle only makes an arrow short, and a small place is next to the base.
        let places = arm.links.iter().flat_map(|link| link.positions_m.iter().flatten());
        let turns = arm.joints.iter().flat_map(|joint| [&joint.torque_n_m, &joint.angle_rad]);
        let sizes = places.chain(turns).map(|history| largest(history).max(1.0));
        let peaks = links.iter().map(|(own, _)| own.peak());
        let tip_m = view.link.map(|run| largest(&run.arc.tip.displacement_m));
        let is_drawn = !sizes.chain(peaks).chain(tip_m).any(is_extreme);
        let bends =
            links.iter().zip(&arm.links).map(|((own, _), link)| own.peak() / link.link.length_m());
        let factor = exaggeration(bends.fold(0.0, f64::max));
        is_drawn.then_some(Self { rows, samples, links, factor })
    }

    /// JSON for the page's script.
    pub(super) fn json(&self, view: &View) -> String {
        let arm = view.first();
        let times_s = &self.links[0].0.times_s;
        let stiffest = arm.links.iter().map(|own| largest_stiffness(&own.link)).fold(0.0, f64::max);
        let links = (0..arm.links.len()).map(|link| self.link_json(view, link, stiffest));
        let mut data = json!({
            "exaggeration": self.factor,
            "links": links.collect::<Vec<Value>>(),
            "seen_from": if view.has_weight() || arm.links[0].link.joint().slides() { "the side" } else { "above" },
            "times_s": self.rows.iter().map(|row| rounded(times_s[*row], 9)).collect::<Vec<_>>(),
        });
        if view.is_arm() {
            let wanted = rigid_tip_m(arm).filter(|_| arm.prescribed == Some(Prescribed::Tip));
            let wanted = wanted.map(|[x, y]| -> Vec<[f64; 2]> {
                self.samples.iter().map(|k| [short(x[*k]), short(y[*k])]).collect()
            });
            data["wanted_m"] = json!(wanted);
            if arm.carriage.is_some() {
                let at = |k: &usize| arm.base_m(*k).map(short);
                data["base_m"] = json!(self.samples.iter().map(at).collect::<Vec<_>>());
            }
        }
        // A `<` in a title could end the script element.
        data.to_string().replace('<', "\\u003c")
    }

    fn link_json(&self, view: &View, number: usize, stiffest: f64) -> Value {
        let arm = view.first();
        let (own, joint) = (&arm.links[number], &arm.joints[number]);
        let (link, payload) = (&own.link, own.link.payload());
        let (deflections, nodes) = &self.links[number];
        // The chord begins at the joint; a rigid piece leads from there to the first node.
        let is_behind = view.pick(false, own.nodes_m[0] > 0.0);
        let from_joint = |first: f64, of: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let all = nodes.iter().map(|node| short(of(*node)));
            is_behind.then_some(first).into_iter().chain(all).collect()
        };
        let at_nodes = |histories: &[Vec<f64>], is_moment: bool| -> Vec<Vec<f64>> {
            let first = |row: usize| if is_moment { short(histories[0][row]) } else { 0.0 };
            let of = |row: &usize| from_joint(first(*row), &|node| histories[node][*row]);
            self.rows.iter().map(of).collect()
        };
        let at_samples = |history: &[f64]| -> Vec<f64> {
            self.samples.iter().map(|k| short(history[*k])).collect()
        };
        let rigid_angle = |k: &usize| Some(short(rigid_directions_rad(arm, *k)?[number]));
        let rigid_angle_rad: Option<Vec<f64>> = self.samples.iter().map(rigid_angle).collect();
        // Moments at other nodes or times than the deflections are omitted.
        let alike = |moments: &StoredNodes| {
            moments.nodes == deflections.nodes
                && moments.times_s.len() == deflections.times_s.len()
                && !is_extreme(moments.peak())
        };
        let moments = view.moments(number).map(|moments| moments.nodes).filter(alike);
        let slides = link.joint().slides();
        let (mut angle_rad, mut chord_m) = (at_samples(&joint.angle_rad), None);
        if view.is_arm() {
            let mut directions: Vec<f64> = Vec::new();
            let mut lengths_m = Vec::new();
            for row in &self.rows {
                let chord = Chord::of(arm, number, *row);
                let turns =
                    directions.last().map_or(0.0, |before| (before - chord.angle_rad) / TAU);
                directions.push(chord.angle_rad + TAU * turns.round());
                lengths_m.push(short(chord.length_m));
            }
            angle_rad = directions.into_iter().map(short).collect();
            chord_m = Some(lengths_m);
        }
        let body = |at: f64, kg: f64| json!({ "at_m": at, "mass_kg": kg });
        let mut data = json!({
            "angle_rad": angle_rad,
            "chord_m": chord_m,
            "deflection_m": at_nodes(&deflections.histories, false),
            "hub_radius_m": view.pick(link.hub().radius_m, 0.0),
            "length_m": link.length_m(),
            "masses": link.masses().iter().map(|m| body(m.at_m, m.mass_kg)).collect::<Vec<_>>(),
            "moment_n_m": moments.map(|moments| at_nodes(&moments.histories, true)),
            "nodes_m": from_joint(0.0, &|node| own.nodes_m[deflections.nodes[node]]),
            "payload": { "mass_kg": payload.mass_kg, "offset_m": payload.offset_m },
            "peak_torque_n_m": largest(&joint.torque_n_m),
            "rigid_angle_rad": rigid_angle_rad,
            "thickness": thickness(link, stiffest),
            "torque_n_m": at_samples(&joint.torque_n_m),
            "slides": slides,
        });
        if let Some(data) = data.as_object_mut().filter(|_| chord_m.is_none()) {
            data.shift_remove("chord_m");
        }
        data
    }

    /// x and y in m of a link's nodes at a row, with the magnified deflection.
    fn places(&self, arm: &StoredRun, link: usize, row: usize) -> Vec<[f64; 2]> {
        let chord = Chord::of(arm, link, row);
        let (sin, cos) = (libm::sin(chord.angle_rad), libm::cos(chord.angle_rad));
        let more = self.factor - 1.0;
        let place = |(places, w): (&[Vec<f64>; 2], &Vec<f64>)| {
            [places[0][row] - more * w[row] * sin, places[1][row] + more * w[row] * cos]
        };
        let nodes = arm.links[link].positions_m.iter().zip(&self.links[link].0.histories);
        std::iter::once(chord.start_m).chain(nodes.map(place)).collect()
    }
}

/// Initial magnification of a deflection of `bending` times the link's length, for good visibility.
pub(super) fn exaggeration(bending: f64) -> f64 {
    const SEEN: f64 = 0.08;
    let factors = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0];
    let off = |factor: &f64| (factor * bending - SEEN).abs();
    factors.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(1.0)
}

/// Width, largest height and margin of the poses in pixels, and the height of the row below them.
const WIDTH: f64 = 760.0;
const HIGHEST: f64 = 460.0;
const MARGIN: f64 = 34.0;
const FOOT: f64 = 60.0;

/// Number of drawn poses.
const POSES: usize = 6;

/// Length of the arrow of gravity in pixels.
const ARROW: f64 = 26.0;

impl Motion {
    /// Poses of an arm, with the paths of the tips of all runs, and the wanted path.
    pub(super) fn drawing(&self, view: &View) -> Markup {
        let arm = view.first();
        let rows = self.along_the_way(arm);
        let poses: Vec<Vec<[f64; 2]>> = rows
            .iter()
            .map(|row| (0..arm.links.len()).flat_map(|link| self.places(arm, link, *row)).collect())
            .collect();
        let ways = ways(view);
        let lines = ways.iter().map(|way| &way.places_m);
        let frame = Frame::around(poses.iter().chain(lines).flatten());
        // A fixed first joint has a drawing of its own.
        let inner = usize::from(arm.carriage.is_none());
        let joints = |row: usize| {
            (inner..arm.links.len()).map(move |link| Chord::of(arm, link, row).start_m)
        };
        let rail = [rows[0], rows[rows.len() - 1]].map(|row| Chord::of(arm, 0, row).start_m);
        let last = poses.len() - 1;
        let shade = |k: usize| format!("{:.2}", 0.25 + 0.75 * k as f64 / last.max(1) as f64);
        let times: Vec<String> =
            rows.iter().map(|row| digits(arm.nodal_times_s[*row], 3)).collect();
        let scale = if self.factor > 1.0 {
            format!("{} times as large as they are", self.factor)
        } else {
            "to scale".to_owned()
        };
        html! {
            figure class="drawing" {
                svg role="img" aria-label="Poses of the arm" viewBox=(format!("0 0 {WIDTH} {:.0}", frame.height)) {
                    @for way in &ways { path class=(way.class) d=(frame.path(&way.places_m)) {} }
                    @for (k, (pose, row)) in poses.iter().zip(&rows).enumerate() {
                        g class="pose" opacity=(shade(k)) {
                            path class="link" d=(frame.path(pose)) {}
                            @for [x, y] in joints(*row).map(|place| frame.at(place)) {
                                circle class="hub" cx=(x) cy=(y) r="5" {}
                            }
                            @if let Some(tip) = pose.last() {
                                @let [x, y] = frame.at(*tip);
                                circle class="payload" cx=(x) cy=(y) r="5" {}
                            }
                        }
                    }
                    @if inner > 0 { (base(frame.at([0.0; 2]))) }
                    @else { path class="ground" d=(frame.path(&rail)) {} }
                    (frame.foot(arm.gravity_m_s2))
                }
                div class="key" {
                    @for way in &ways { span {
                        svg viewBox="0 0 26 12" aria-hidden="true" { path class=(way.class) d="M1,6H25" {} }
                        span { (way.name) }
                    } }
                }
                figcaption {
                    "Poses at " (times.join(", ")) " s, from pale to strong; deflections from the chords are drawn "
                    (scale) "."
                }
            }
        }
    }

    /// Rows at which the tip has covered even parts of its path.
    fn along_the_way(&self, arm: &StoredRun) -> Vec<usize> {
        let places = arm.links.last().and_then(|link| link.positions_m.last());
        let Some([x, y]) = places else { return Vec::new() };
        let mut gone_m = vec![0.0];
        for pair in self.rows.windows(2) {
            let step_m = libm::hypot(x[pair[1]] - x[pair[0]], y[pair[1]] - y[pair[0]]);
            gone_m.push(gone_m[gone_m.len() - 1] + step_m);
        }
        let all_m = gone_m[gone_m.len() - 1];
        let at = |k: usize| {
            let part_m = all_m * k as f64 / (POSES - 1) as f64;
            self.rows[gone_m.partition_point(|m| *m < part_m).min(self.rows.len() - 1)]
        };
        let mut rows: Vec<usize> = (0..POSES).map(at).collect();
        rows.dedup();
        rows
    }
}

/// The path of a tip.
struct Way {
    name: String,
    /// Classes in the style sheet.
    class: String,
    places_m: Vec<[f64; 2]>,
}

/// Number of points of a path.
const POINTS: usize = 400;

/// The paths of the tips of all runs in the shown time, with the wanted path on top.
fn ways(view: &View) -> Vec<Way> {
    let way = |name: String, class: String, (times_s, [x, y]): (&[f64], &[Vec<f64>; 2])| {
        let samples = inside(times_s, view.span_s.0, view.span_s.1);
        let kept = evenly(samples.len(), POINTS).into_iter().map(|k| samples.start + k);
        Way { name, class, places_m: kept.map(|k| [x[k], y[k]]).collect() }
    };
    // The tip of a single link has no place in the plane of the arm.
    let arms = view.named("path of the tip").enumerate().filter(|(_, (run, _))| run.arc.is_none());
    let runs = arms.map(|(k, (arm, name))| {
        let class = if k == 0 { "way reached s4".to_owned() } else { run_stroke(k).classes() };
        way(name, class, (&arm.times_s, &arm.tip_m))
    });
    let rigid = view.rigid().filter(|arm| arm.prescribed == Some(Prescribed::Tip));
    let wanted = rigid.and_then(|arm| Some((arm, rigid_tip_m(arm)?)));
    let wanted = wanted.map(|(arm, tip_m)| {
        way("wanted path".to_owned(), "line s6 dashed".to_owned(), (&arm.times_s, &tip_m))
    });
    runs.chain(wanted).collect()
}

/// Mapping from places in m to pixels of the drawing, with one scale for x and y.
struct Frame {
    height: f64,
    per_m: f64,
    /// Origin in pixels.
    origin: [f64; 2],
}

impl Frame {
    /// The frame around places and the first joint.
    fn around<'a>(places: impl Iterator<Item = &'a [f64; 2]>) -> Self {
        let (mut low, mut high) = ([0.0_f64; 2], [0.0_f64; 2]);
        for place in places {
            for axis in 0..2 {
                low[axis] = low[axis].min(place[axis]);
                high[axis] = high[axis].max(place[axis]);
            }
        }
        let [wide, tall] = [0, 1].map(|axis| (high[axis] - low[axis]).max(f64::MIN_POSITIVE));
        let per_m = ((WIDTH - 2.0 * MARGIN) / wide).min((HIGHEST - 2.0 * MARGIN) / tall);
        let left = 0.5 * (WIDTH - per_m * wide);
        let origin = [left - per_m * low[0], MARGIN + per_m * high[1]];
        Self { height: per_m * tall + 2.0 * MARGIN + FOOT, per_m, origin }
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [rounded_px(self.origin[0] + self.per_m * x), rounded_px(self.origin[1] - self.per_m * y)]
    }

    fn path(&self, places: &[[f64; 2]]) -> String {
        let mut text = String::new();
        for (k, place) in places.iter().enumerate() {
            let [x, y] = self.at(*place);
            // Writing to a string cannot fail.
            let _ = write!(text, "{}{x},{y}", if k == 0 { 'M' } else { 'L' });
        }
        text
    }

    /// The row below: a length to scale, and the direction of gravity.
    fn foot(&self, gravity_m_s2: [f64; 2]) -> Markup {
        let raw_m = 0.2 * WIDTH / self.per_m;
        let power = libm::pow(10.0, libm::floor(libm::log10(raw_m)));
        let steps = [5.0, 2.0, 1.0].map(|step| step * power);
        let length_m = steps.into_iter().find(|step| *step <= raw_m).unwrap_or(power);
        let (end, foot) = (MARGIN + self.per_m * length_m, self.height - 22.0);
        let size = libm::hypot(gravity_m_s2[0], gravity_m_s2[1]);
        let [along, up] = gravity_m_s2.map(|part| ARROW * part / size.max(f64::MIN_POSITIVE));
        let (x, y) = (WIDTH - MARGIN - 34.0 - 0.5 * along, self.height - 30.0 + 0.5 * up);
        let head = format!(
            "M{:.1} {:.1}l{:.1} {:.1}l{:.1} {:.1}",
            x + along - 0.3 * (along - up),
            y - up - 0.3 * (-up - along),
            0.3 * (along - up),
            0.3 * (-up - along),
            -0.3 * (along + up),
            -0.3 * (-up + along),
        );
        html! {
            path class="dimension" d=(format!("M{MARGIN} {foot:.1}v-6v12v-6H{end:.1}v-6v12")) {}
            text class="dimension-text" x=(format!("{:.1}", end + 10.0)) y=(format!("{:.1}", foot + 5.0)) {
                (given(length_m, "m"))
            }
            @if size > 0.0 {
                path class="ground" d=(format!("M{x:.1} {y:.1}l{along:.1} {:.1}{head}", -up)) {}
                text class="dimension-text" x=(WIDTH - MARGIN) y=(format!("{:.1}", foot + 5.0)) text-anchor="end" { "g" }
            }
        }
    }
}

/// Rounds pixels to a tenth.
fn rounded_px(value: f64) -> f64 {
    (10.0 * value).round() / 10.0
}

/// Drawing of the first joint.
fn base([x, y]: [f64; 2]) -> Markup {
    html! {
        path class="ground" d=(format!("M{x} {y}v16m-18 0h36m-30 0l-7 8m15 -8l-7 8m15 -8l-7 8")) {}
        circle class="hub" cx=(x) cy=(y) r="8" {}
        circle class="axis-point" cx=(x) cy=(y) r="2.5" {}
    }
}
