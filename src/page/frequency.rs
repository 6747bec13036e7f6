//! Figures of the link alone: torque per tip acceleration over frequency, shapes of the first modes.

use std::f64::consts::TAU;

use super::axis::Axis;
use super::figure::{Curve, Figure, Mark, Stroke};
use super::view::{Single, View, run_stroke};
use super::words::{formula, own};
use crate::beam::Mesh;
use crate::modal::{Shape, mode, natural_frequencies, real_frequency_zeros, torque_zeros};
use crate::model::{FrequencyResponse, KeptModes, model_of};
use crate::numeric::{FourierPair, angular_frequency, fast_length, largest, magnitude};
use crate::text::significant;

/// Number of frequencies in the figure.
const POINTS: usize = 900;

/// Largest number of marked modes and zeros.
const MARKED: usize = 8;

/// Number of decades shown of the motion's spectrum.
const DECADES: f64 = 4.0;

/// Amplitudes of the motion over frequency, relative to the largest.
struct MotionSpectrum {
    hertz: Vec<f64>,
    shares: Vec<f64>,
}

impl MotionSpectrum {
    fn of(run: Single) -> Self {
        let step_s = run.times_s[1] - run.times_s[0];
        let mut samples = run.arc.tip.acceleration_m_s2.clone();
        let len = fast_length(samples.len().next_multiple_of(2));
        samples.resize(len, 0.0);
        let amplitudes = FourierPair::new(len).amplitudes(samples);
        let sizes: Vec<f64> = amplitudes.iter().map(|a| magnitude(*a)).collect();
        let peak = largest(&sizes).max(f64::MIN_POSITIVE);
        Self {
            hertz: (0..sizes.len()).map(|k| angular_frequency(k, len, step_s) / TAU).collect(),
            shares: sizes.iter().map(|size| size / peak).collect(),
        }
    }

    /// Highest frequency in Hz at which the spectrum is within the shown decades.
    fn last_shown_hz(&self) -> f64 {
        let shown = |share: &f64| *share > libm::pow(10.0, -DECADES);
        self.shares.iter().rposition(shown).map_or(0.0, |last| self.hertz[last])
    }

    /// The spectrum at these frequencies as heights from 0 to 1.
    fn backdrop(&self, hertz: &[f64]) -> Curve {
        let apart = hertz[1] / hertz[0];
        let height = |f: &f64| {
            let share = self.between(*f, f * apart).max(f64::MIN_POSITIVE);
            (1.0 + libm::log10(share) / DECADES).clamp(0.0, 1.0)
        };
        let heights: Vec<f64> = hertz.iter().map(height).collect();
        Curve::new("motion's spectrum", Stroke::Solid(6), hertz, &heights)
    }

    /// Largest share between two frequencies, or the nearest one.
    fn between(&self, from_hz: f64, to_hz: f64) -> f64 {
        let start = self.hertz.partition_point(|f| *f < from_hz).min(self.hertz.len() - 1);
        let end = self.hertz.partition_point(|f| *f < to_hz).clamp(start + 1, self.hertz.len());
        largest(&self.shares[start..end])
    }
}

/// `|T/a_tip|` with natural frequencies and zeros, in front of the motion's spectrum.
pub(super) fn transfer(view: &View, run: Single) -> Result<Figure, String> {
    let kept = run.arc.kept_modes.map_or(KeptModes::All, KeptModes::First);
    let model = model_of(run.link, run.arc.mesh.clone(), kept)
        .map_err(|error| format!("torque per tip acceleration, since {error}"))?;
    // A simulated tip may still vibrate at the last sample, so that the cut would dominate its spectrum.
    let spectrum = run.joint.rigid_angle_rad.is_some().then(|| MotionSpectrum::of(run));
    let (from_hz, to_hz) = band(run, spectrum.as_ref());
    let hertz: Vec<f64> = (0..POINTS)
        .map(|k| from_hz * libm::pow(to_hz / from_hz, k as f64 / (POINTS - 1) as f64))
        .collect();
    let flexible =
        |f: &f64| magnitude(FrequencyResponse::at(&*model, *f).torque_per_tip_acceleration_kg_m);
    let (rigid_tip, friction) = (run.link.rigid_tip(), run.link.joint().friction());
    let rigid =
        |f: &f64| libm::hypot(run.link.rigid_inertia_kg_m2(), friction / (TAU * f)) / rigid_tip;
    let sizes: Vec<f64> = hertz.iter().map(flexible).collect();
    let rigid: Vec<f64> = hertz.iter().map(rigid).collect();
    // Runs of the same link have one curve.
    let others = view.named("").enumerate().skip(1).filter_map(|(k, (other, name))| {
        let own = Single::of(other)?;
        let is_alike = own.link.joint().slides() == run.link.joint().slides();
        if !is_alike || own.link == run.link {
            return None;
        }
        let kept = own.arc.kept_modes.map_or(KeptModes::All, KeptModes::First);
        let model = model_of(own.link, own.arc.mesh.clone(), kept).ok()?;
        let at = |f: &f64| {
            magnitude(FrequencyResponse::at(&*model, *f).torque_per_tip_acceleration_kg_m)
        };
        let sizes: Vec<f64> = hertz.iter().map(at).collect();
        Some(Curve::new(&name, run_stroke(k), &hertz, &sizes))
    });
    let others: Vec<Curve> = others.collect();
    let of_others = || others.iter().flat_map(|own| own.points.iter().map(|(_, size)| size));
    let all = || sizes.iter().chain(&rigid).chain(of_others()).copied();
    let finite = || all().filter(|s| s.is_finite() && *s > 0.0);
    let range = 0.7 * finite().fold(f64::INFINITY, f64::min)..1.5 * finite().fold(0.0, f64::max);
    let unit = if run.link.joint().slides() { "kg" } else { "kg m" };
    let name = if others.is_empty() { "flexible link".to_owned() } else { own(&view.first().name) };
    let y = Axis::logarithmic("|T / a|", unit, range);
    let x = Axis::logarithmic("frequency", "Hz", from_hz..to_hz);
    let marks = marks(&run.arc.mesh, from_hz..to_hz);
    let caption = caption(&marks, spectrum.is_some());
    Ok(Figure {
        backdrop: spectrum.map(|spectrum| spectrum.backdrop(&hertz)),
        curves: [
            vec![
                Curve::new(&name, Stroke::Solid(1), &hertz, &sizes),
                Curve::new("rigid link", Stroke::Dashed(2), &hertz, &rigid),
            ],
            others,
        ]
        .concat(),
        marks,
        ..Figure::new("transfer", "Torque per tip acceleration", caption, x, y)
    }
    .by(formula::TRANSFER))
}

/// First and last frequency in Hz: from a tenth of the first mode to the end of the motion's spectrum, or to the last
/// marked mode.
fn band(run: Single, spectrum: Option<&MotionSpectrum>) -> (f64, f64) {
    let modes = natural_frequencies(&run.arc.mesh, MARKED);
    let nyquist_hz = 0.5 / (run.times_s[1] - run.times_s[0]);
    let first_hz = modes.first().map_or(0.1 * nyquist_hz, |omega| omega / TAU);
    let last_hz = match spectrum {
        Some(spectrum) => spectrum.last_shown_hz(),
        None => modes.last().map_or(0.0, |omega| omega / TAU),
    };
    let to_hz = (1.5 * last_hz).max(6.0 * first_hz).min(nyquist_hz);
    (0.1 * first_hz.min(to_hz), to_hz)
}

fn marks(mesh: &Mesh, range: std::ops::Range<f64>) -> Vec<Mark> {
    let all = [
        ("mode", "f", natural_frequencies(mesh, MARKED)),
        ("zero", "z", torque_zeros(mesh, MARKED)),
        ("blocked", "b", real_frequency_zeros(mesh, TAU * range.end)),
    ];
    let mut marks = Vec::new();
    for (class, letter, places) in all {
        for (k, omega) in places.into_iter().enumerate() {
            marks.push(Mark { at: omega / TAU, label: format!("{letter}{}", k + 1), class });
        }
    }
    marks.retain(|mark| range.contains(&mark.at));
    marks
}

fn caption(marks: &[Mark], has_spectrum: bool) -> String {
    let blocked = if marks.iter().any(|mark| mark.class == "blocked") {
        " At b no torque moves the tip: the curve peaks."
    } else {
        ""
    };
    let spectrum = if has_spectrum {
        format!(
            " Grey: the motion's spectrum over {DECADES} decades, the part of the curve that matters."
        )
    } else {
        String::new()
    };
    format!(
        "Torque that an acceleration of the tip needs at each frequency, of this link and of a rigid one. Natural \
         frequencies f, and zeros ±z of torque → tip, drawn at z/2π.{blocked}{spectrum}"
    )
}

/// Number of modes in the figure.
const MODES: usize = 4;

/// Fewest points of a shape.
const SHAPE_POINTS: usize = 120;

/// Displacement along the link in its first modes; an error if nothing vibrates.
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
    let caption = "Displacement along the link, from the hub's axis to the end, while it vibrates freely \
                   about its hub; each shape over its largest value. The slope at the hub is the hub's \
                   own turning.";
    let figure = Figure::new("mode-shapes", "Mode shapes", caption.to_owned(), x, y);
    Ok(Figure { curves, ..figure }.by(formula::MODE_SHAPES))
}

/// Points (x, v) of a shape from the elements' cubics, from the axis outward; the hub's radius is rigid. With shear the
/// slope is not the rotation of the section; straight lines then join the nodes.
fn smooth(mesh: &Mesh, shape: &Shape) -> Vec<(f64, f64)> {
    let nodes_m = mesh.nodes_m();
    let parts = if mesh.has_shear() { 1 } else { SHAPE_POINTS.div_ceil(mesh.elements().len()) };
    let rigid = |x_m: f64| mesh.joint().rigid(x_m)[0] * shape.hub_angle;
    let mut points = vec![(0.0, rigid(0.0))];
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
            points.push((x, bend + rigid(x)));
        }
    }
    points.dedup_by(|a, b| a.0 <= b.0);
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::tests::{run, view};

    #[test]
    fn the_curve_begins_at_the_rigid_link_and_falls_at_natural_frequencies() {
        let run = run();
        let view = view(&run);
        let run = view.link.unwrap();
        let figure = transfer(&view, run).unwrap();
        let rigid = run.link.rigid_inertia_kg_m2() / run.link.rigid_tip();
        let points = &figure.curves[0].points;
        assert!((points[0].1 / rigid - 1.0).abs() < 0.02, "{} of {rigid}", points[0].1);
        let modes = figure.marks.iter().filter(|mark| mark.class == "mode");
        let fallen = modes.filter(|mark| {
            let near = points.iter().filter(|(f, _)| (f / mark.at - 1.0).abs() < 0.02);
            near.fold(f64::INFINITY, |least, (_, size)| least.min(*size)) < 0.3 * rigid
        });
        assert!(fallen.count() >= 3, "{:?}", figure.marks);
        assert!(figure.marks.iter().any(|mark| mark.class == "zero"));
    }

    #[test]
    fn the_curves_are_absolute_values_friction_included() {
        let mut run = run();
        run.links[0].link = crate::page::tests::link(2.0);
        let view = view(&run);
        let run = view.link.unwrap();
        let figure = transfer(&view, run).unwrap();
        let model = model_of(run.link, run.arc.mesh.clone(), KeptModes::All).unwrap();
        let inertia = run.link.rigid_inertia_kg_m2() / run.link.rigid_tip();
        for k in (0..POINTS).step_by(37) {
            let (f, size) = figure.curves[0].points[k];
            let exact = FrequencyResponse::at(&*model, f).torque_per_tip_acceleration_kg_m;
            let exact = (exact.re * exact.re + exact.im * exact.im).sqrt();
            assert!((size / exact - 1.0).abs() < 1e-12, "{size} of {exact} at {f} Hz");
            let drag = 2.0 / run.link.rigid_tip() / (TAU * f);
            let rigid = (inertia * inertia + drag * drag).sqrt();
            assert!((figure.curves[1].points[k].1 / rigid - 1.0).abs() < 1e-12, "rigid at {f} Hz");
        }
    }

    #[test]
    fn the_spectrum_is_that_of_the_motion() {
        let run = run();
        let spectrum = MotionSpectrum::of(view(&run).link.unwrap());
        // A sine of 0.88 s has its peak just below 1/0.88 s and a gap at 2/0.88 s.
        let peak = spectrum.shares.iter().position(|share| *share >= 1.0).unwrap();
        assert!((0.7..1.2).contains(&spectrum.hertz[peak]), "{} Hz", spectrum.hertz[peak]);
        let gap = 2.0 / 0.88;
        assert!(spectrum.between(gap * 0.97, gap * 1.03) < 0.06);
        assert!(spectrum.between(0.8, 1.2) > 0.99);
    }
}
