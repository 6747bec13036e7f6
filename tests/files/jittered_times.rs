//! Torques, hub angles and targets at times that are not quite uniform.

use std::f64::consts::TAU;

use flexlink::csv::{
    TableFormat, read_joint_references, read_target, read_torque_table, read_torque_table_as,
};
use flexlink::link::{Link, Segment};

fn link() -> Link {
    Link::builder().segment(Segment::uniform(1.5, 5.0, 0.8)).build().expect("a link")
}

/// A sine over 1 s at 5 ms, its times off by up to `jitter` steps in a pattern, its values those of the
/// times.
fn table(heading: &str, jitter: f64) -> String {
    let row = |k: u32| {
        let off = jitter * [0.0, 1.0, -0.4, 0.7, -1.0][(k % 5) as usize];
        let t = 0.005 * (f64::from(k) + if k.is_multiple_of(200) { 0.0 } else { off });
        format!("{t:.12},{:.12}\n", (TAU * t).sin())
    };
    format!("time,{heading}\n{}", (0..=200).map(row).collect::<String>())
}

#[track_caller]
fn is_sine(samples: &[f64], told: Option<(&str, &str)>) {
    let error = |(k, x): (usize, &f64)| (x - (TAU * 0.005 * k as f64).sin()).abs();
    let worst = samples.iter().enumerate().map(error).fold(0.0, f64::max);
    assert!(worst < 1e-7, "{worst:e}");
    let (remark, _) = told.expect("a remark");
    assert!(remark.starts_with("the times are off a uniform grid of 0.005"), "{remark}");
    assert!(remark.ends_with("interpolated at uniform times by a cubic spline"), "{remark}");
}

#[test]
fn samples_at_jittered_times_are_interpolated() {
    let form = TableFormat::default();
    let text = table("torque", 0.04);
    let (torque, reading) = read_torque_table_as("t.csv", text.as_bytes(), 1, None, &form).unwrap();
    is_sine(torque.torque_n_m(), reading.jitter());
    let text = table("hub_angle", 0.04);
    let (mut hubs, reading) = read_joint_references("h.csv", text.as_bytes(), 1, &form).unwrap();
    let hub = hubs.remove(0);
    is_sine(hub.angle_rad(), reading.jitter());
    let text = table("displacement", 0.04);
    let (target, reading) = read_target("d.csv", text.as_bytes(), &link(), &form).unwrap();
    is_sine(target.displacement_m(), reading.jitter());
    assert!((target.grid().end_s() - 1.0).abs() < 1e-12);
}

#[test]
fn uniform_times_are_left_alone_and_more_jitter_is_refused() {
    let text = table("torque", 0.0);
    let form = TableFormat::default();
    let (_, reading) = read_torque_table_as("t.csv", text.as_bytes(), 1, None, &form).unwrap();
    assert_eq!(reading.jitter(), None);
    for heading in ["torque", "displacement"] {
        let text = table(heading, 0.2);
        let error = match heading {
            "torque" => read_torque_table("t.csv", text.as_bytes(), None).unwrap_err(),
            _ => {
                read_target("t.csv", text.as_bytes(), &link(), &TableFormat::default()).unwrap_err()
            }
        };
        assert!(error.to_string().contains("time = "), "{error}");
    }
}
