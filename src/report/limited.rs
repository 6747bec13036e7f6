//! Figures of what may have a limit: torque of the motor, rates, powers, deflection, moment at the root.

use super::axis::Axis;
use super::bending::bending_moments;
use super::figure::{Curve, Figure, Stroke};
use super::view::{View, peak_words, reading};
use super::words::formula;
use crate::result::{Limits, StoredJoint, StoredMotor, StoredRun};

/// What turns at a hub or at a joint.
pub(super) struct Turning<'a> {
    torque_n_m: &'a [f64],
    rate_rad_s: &'a [f64],
    motor: Option<&'a StoredMotor>,
}

impl<'a> From<&'a StoredRun> for Turning<'a> {
    fn from(run: &'a StoredRun) -> Self {
        let motor = run.solved.as_ref().and_then(|solved| solved.motor.as_ref());
        Self { torque_n_m: &run.torque_n_m, rate_rad_s: &run.hub_rate_rad_s, motor }
    }
}

impl<'a> From<&'a StoredJoint> for Turning<'a> {
    fn from(joint: &'a StoredJoint) -> Self {
        let StoredJoint { torque_n_m, rate_rad_s, motor, .. } = joint;
        Self { torque_n_m, rate_rad_s, motor: motor.as_ref() }
    }
}

/// A quantity of a hub or of a joint that may have a limit.
pub(super) struct Limited {
    pub(super) id: &'static str,
    /// Its peak in the summary.
    reading: &'static str,
    /// Whether it is the motor's.
    is_of_motor: bool,
    /// Its title, but for what it is of.
    title: &'static str,
    /// Its caption, with `{}` for its peak.
    caption: &'static str,
    quantity: (&'static str, &'static str),
    pub(super) limit: fn(&Limits) -> Option<f64>,
    pub(super) of: fn(&Turning) -> Option<Vec<f64>>,
    formula: &'static str,
}

const AT_MOST: &str = "At most {}.";
const OF_MOTOR: &str = "At most {}, on the motor's side of the drive.";

/// Torque of the motor, which has a figure without a limit, too.
pub(super) const MOTOR_TORQUE: Limited = Limited {
    id: "motor-torque",
    reading: "peak_motor_torque_n_m",
    is_of_motor: true,
    title: "Torque of the motor of",
    caption: OF_MOTOR,
    quantity: ("torque", "N m"),
    limit: |limits| limits.motor_torque_n_m,
    of: |turning| Some(turning.motor?.torque_n_m.clone()),
    formula: formula::MOTOR,
};

/// Rate and power, at the joint and of its motor: drawn where they have a limit.
pub(super) const LIMITED: [Limited; 4] = [
    Limited {
        id: "rate",
        reading: "peak_hub_rate_rad_s",
        is_of_motor: false,
        title: "Rate of",
        caption: AT_MOST,
        quantity: ("rate", "rad/s"),
        limit: |limits| limits.hub_rate_rad_s,
        of: |turning| Some(turning.rate_rad_s.to_vec()),
        formula: formula::RATE,
    },
    Limited {
        id: "power",
        reading: "peak_power_w",
        is_of_motor: false,
        title: "Power at",
        caption: AT_MOST,
        quantity: ("power", "W"),
        limit: |limits| limits.power_w,
        of: |turning| Some(power_w(turning.torque_n_m, turning.rate_rad_s)),
        formula: formula::POWER,
    },
    Limited {
        id: "motor-rate",
        reading: "peak_motor_rate_rad_s",
        is_of_motor: true,
        title: "Rate of the motor of",
        caption: OF_MOTOR,
        quantity: ("rate", "rad/s"),
        limit: |limits| limits.motor_rate_rad_s,
        of: |turning| Some(turning.motor?.rate_rad_s.clone()),
        formula: formula::MOTOR_RATE,
    },
    Limited {
        id: "motor-power",
        reading: "peak_motor_power_w",
        is_of_motor: true,
        title: "Power of the motor of",
        caption: OF_MOTOR,
        quantity: ("power", "W"),
        limit: |limits| limits.motor_power_w,
        of: |turning| turning.motor.map(|motor| power_w(&motor.torque_n_m, &motor.rate_rad_s)),
        formula: formula::MOTOR_POWER,
    },
];

fn power_w(torque_n_m: &[f64], rate_rad_s: &[f64]) -> Vec<f64> {
    torque_n_m.iter().zip(rate_rad_s).map(|(torque, rate)| torque * rate).collect()
}

impl Limited {
    /// Its figure, of `what` in a run of a link or an arm, with the limit if there is one.
    pub(super) fn figure(
        &self,
        (id, what): (String, &str),
        time: Axis,
        (curves, limit): (Vec<Curve>, Option<f64>),
        readings: &[(String, f64)],
    ) -> Figure {
        let title = format!("{} {what}", self.title);
        let known = reading(readings, self.reading);
        let words = (&title[..], self.caption);
        figure(id, words, time, self.quantity, (curves, limit), known).by(self.formula)
    }
}

/// A figure of lines with a limit; the caption says how far the first line gets, as the summary has it if it is `known`.
pub(super) fn figure(
    id: String,
    (title, caption): (&str, &str),
    time: Axis,
    (name, unit): (&str, &str),
    (mut curves, limit): (Vec<Curve>, Option<f64>),
    known: Option<f64>,
) -> Figure {
    let values = curves.first().into_iter().flat_map(|curve| &curve.points);
    let values: Vec<f64> = values.map(|(_, value)| *value).collect();
    let peak = format!("{} {unit}", peak_words(known, &values));
    let mut caption = caption.replace("{}", &peak);
    caption.push_str(&Curve::add_limit(&mut curves, limit, ("", unit), 1));
    Figure::of_curves(id, title, caption, time, (name, unit), curves)
}

/// The torque of the motor, where there is one.
pub(super) fn motor_torque(view: &View) -> Option<Figure> {
    of_hub(view, &MOTOR_TORQUE, view.run.limits.motor_torque_n_m)
}

/// A quantity of the hub or of its motor.
fn of_hub(view: &View, topic: &Limited, limit: Option<f64>) -> Option<Figure> {
    let run = view.run;
    let history = (topic.of)(&Turning::from(run))?;
    let (id, name) = if topic.is_of_motor {
        (topic.id.to_owned(), "motor")
    } else {
        (format!("hub-{}", topic.id), if run.solved.is_some() { "flexible link" } else { "hub" })
    };
    let curves = vec![view.curve(name, Stroke::Solid(1), &history)];
    Some(topic.figure((id, "the hub"), view.time_axis(), (curves, limit), &run.readings))
}

/// What of a link has a limit, but for torques.
pub(super) fn limited_of_link(view: &View) -> Vec<Result<Figure, String>> {
    let run = view.run;
    let turning = LIMITED.iter().filter_map(|topic| {
        let limit = (topic.limit)(&run.limits)?;
        of_hub(view, topic, Some(limit)).map(Ok)
    });
    let deflection = run.limits.deflection_m.map(|limit| {
        let curves = vec![deflection(view)];
        let title = "Deflection of the tip from the hub's tangent line";
        let (id, words) = ("tip-deflection".to_owned(), (title, AT_MOST));
        let lines = (curves, Some(limit));
        let known = view.reading("peak_deflection_m");
        Ok(figure(id, words, view.time_axis(), ("deflection", "m"), lines, known)
            .by(formula::TIP_DEFLECTION))
    });
    let moment = run.limits.bending_moment_n_m.map(|limit| root_moment(view, limit));
    turning.chain(deflection).chain(moment).collect()
}

/// The deflection of the tip as it was written, or `v − Lθ`.
fn deflection(view: &View) -> Curve {
    let run = view.run;
    let tip = run.mesh.nodes_m().len() - 1;
    let written = run.deflections_m.as_ref().filter(|own| own.nodes.last() == Some(&tip));
    if let Some(history) = written.and_then(|own| Some((&own.times_s, own.histories.last()?))) {
        return view.over_time("flexible link", Stroke::Solid(1), history);
    }
    let length_m = run.mesh.length_m();
    let pairs = run.tip.displacement_m.iter().zip(&run.hub_angle_rad);
    let bent: Vec<f64> = pairs.map(|(v, angle)| v - length_m * (angle - run.origin_rad)).collect();
    view.over_time("flexible link", Stroke::Solid(1), (&run.times_s, &bent))
}

/// The bending moment at the root, if it is known.
fn root_moment(view: &View, limit: f64) -> Result<Figure, String> {
    let moments = bending_moments(view).filter(|moments| moments.nodes.nodes.first() == Some(&0));
    let why = if view.run.solved.is_some() {
        "it was not written: solve --moments writes it"
    } else {
        "too few rows were written for an estimate: --every 1 writes all"
    };
    let moments = moments.ok_or_else(|| format!("the bending moment at the root, since {why}"))?;
    let history = (&moments.nodes.times_s, &moments.nodes.histories[0]);
    let curves = vec![view.over_time("flexible link", Stroke::Solid(1), history)];
    let (title, formula) = if moments.is_written {
        ("Bending moment at the root", formula::ROOT_MOMENTS)
    } else {
        ("Bending moment at the root, estimated", formula::MOMENT_ESTIMATED)
    };
    let (id, words) = ("hub-moment".to_owned(), (title, AT_MOST));
    let (lines, known) = ((curves, Some(limit)), view.reading("peak_root_moment_n_m"));
    Ok(figure(id, words, view.time_axis(), ("moment", "N m"), lines, known).by(formula))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::largest;
    use crate::report::Figures;
    use crate::report::tests::{run, solution};
    use crate::result::StoredResult;
    use crate::text::significant;

    /// A peak between samples is larger than all of them.
    #[test]
    fn captions_have_the_peaks_of_the_summary() {
        let mut run = run();
        let motor = StoredMotor {
            torque_n_m: run.torque_n_m.clone(),
            rate_rad_s: run.hub_rate_rad_s.clone(),
        };
        run.solved.as_mut().unwrap().motor = Some(motor);
        run.limits.hub_rate_rad_s = Some(2.0);
        run.limits.deflection_m = Some(0.2);
        let moment_n_m = 1.01 * largest(&solution().root_moment_n_m);
        let moment_words = format!("reaches {} N m", significant(moment_n_m, 4));
        let peaks = [
            ("torque", "peak_torque_n_m", 1.401, "1.401 N m"),
            ("torque", "peak_rigid_torque_n_m", 2.901, "2.901 N m"),
            ("motor-torque", "peak_motor_torque_n_m", 1.402, "1.402 N m"),
            ("tip-acceleration", "peak_tip_acceleration_m_s2", 4.201, "4.201 m/s²"),
            ("hub-rate", "peak_hub_rate_rad_s", 0.5301, "0.5301 rad/s"),
            ("tip-deflection", "peak_deflection_m", 0.1701, "0.1701 m"),
            ("waves", "peak_root_moment_n_m", moment_n_m, &moment_words),
        ];
        run.readings = peaks.map(|(_, name, value, _)| (name.to_owned(), value)).to_vec();
        let drawn = Figures::of(&StoredResult::Run(Box::new(run))).drawn;
        for (id, name, _, words) in peaks {
            let figure = drawn.iter().find(|figure| figure.id == id).unwrap();
            assert!(figure.caption.contains(words), "{name}: {}", figure.caption);
        }
    }

    #[test]
    fn every_limit_of_a_history_is_a_line_in_its_figure() {
        let mut run = run();
        let solved = run.solved.as_mut().unwrap();
        solved.motor = Some(StoredMotor {
            torque_n_m: run.torque_n_m.iter().map(|torque| 0.5 * torque).collect(),
            rate_rad_s: run.hub_rate_rad_s.iter().map(|rate| 2.0 * rate).collect(),
        });
        let drawn = |run: &StoredRun| Figures::of(&StoredResult::Run(Box::new(run.clone()))).drawn;
        assert!(!drawn(&run).iter().any(|figure| figure.id == "hub-power"), "there is no limit");
        let half = |history: &[f64]| Some(0.5 * largest(history));
        let power: Vec<f64> = run
            .torque_n_m
            .iter()
            .zip(&run.hub_rate_rad_s)
            .map(|(torque, rate)| torque * rate)
            .collect();
        run.limits = Limits {
            torque_n_m: half(&run.torque_n_m),
            hub_rate_rad_s: half(&run.hub_rate_rad_s),
            power_w: half(&power),
            deflection_m: half(run.deflections_m.as_ref().unwrap().histories.last().unwrap()),
            bending_moment_n_m: half(&solution().root_moment_n_m),
            motor_torque_n_m: half(
                &run.solved.as_ref().unwrap().motor.as_ref().unwrap().torque_n_m,
            ),
            motor_rate_rad_s: half(
                &run.solved.as_ref().unwrap().motor.as_ref().unwrap().rate_rad_s,
            ),
            motor_power_w: half(&power),
            ..Limits::default()
        };
        let figures = drawn(&run);
        for (id, line, limit) in [
            ("torque", "flexible link", run.limits.torque_n_m),
            ("motor-torque", "motor", run.limits.motor_torque_n_m),
            ("hub-rate", "flexible link", run.limits.hub_rate_rad_s),
            ("hub-power", "flexible link", run.limits.power_w),
            ("motor-rate", "motor", run.limits.motor_rate_rad_s),
            ("motor-power", "motor", run.limits.motor_power_w),
            ("tip-deflection", "flexible link", run.limits.deflection_m),
            ("hub-moment", "flexible link", run.limits.bending_moment_n_m),
        ] {
            let figure = figures.iter().find(|figure| figure.id == id).unwrap();
            let curve = figure.curves.iter().find(|curve| curve.name == line).unwrap();
            let peak = curve.points.iter().fold(0.0_f64, |peak, (_, value)| peak.max(value.abs()));
            // The moment is estimated.
            assert!((0.5 * peak / limit.unwrap() - 1.0).abs() < 0.02, "{id}: {peak}, {limit:?}");
            let is_limit = |curve: &&Curve| matches!(curve.stroke, Stroke::Limit(_));
            let mut lines = figure.curves.iter().filter(is_limit);
            let is_drawn = lines.any(|curve| (curve.points[0].1 - limit.unwrap()).abs() < 1e-15);
            assert!(is_drawn, "{id} lacks the limit of {line}");
        }
    }
}
