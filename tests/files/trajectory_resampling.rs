//! Resampling of trajectories: what it keeps and refuses.

use flexlink::csv::{MotionTable, read_motion_table};

fn read(text: &str) -> MotionTable {
    read_motion_table("traj.csv", text.as_bytes(), 2.0).expect("a trajectory")
}

#[test]
fn a_resampling_step_must_suit_the_motion() {
    let motion = read("time,displacement\n0,0\n1,1\n2,2\n3,3\n");
    let refused = |step_s: f64, must: &str, hint| {
        let error = motion.clone().resampled(step_s).unwrap_err();
        let message = format!("traj.csv: resampling step = {step_s} s, but must {must}");
        assert_eq!(error.to_string(), message);
        assert_eq!(error.hint(), hint, "{message}");
    };
    for step_s in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        refused(step_s, "be finite and above 0", None);
    }
    refused(2.0, "be at most 1 s, which gives 4 samples", None);
    let must = "be at least 3.00000e-7 s, which gives 1e7 samples";
    refused(1e-9, must, None);
    // The motion rests at its end: a twentieth of a step does not matter, and a rest fills the last step.
    let filled = motion.clone().resampled(0.7).unwrap();
    let note = "read 0.500 s of rest added after the last row";
    assert_eq!(filled.reading().note().as_deref(), Some(note));
    let filled = filled.columns().unwrap().displacement_m.clone().unwrap();
    assert_eq!((filled.len(), filled[5].to_bits()), (6, 3.0_f64.to_bits()));
    let nearly = motion.resampled(0.99).unwrap();
    assert_eq!(nearly.reading().note(), None);
    assert_eq!(
        nearly.columns().unwrap().displacement_m.as_ref().unwrap()[3].to_bits(),
        3.0_f64.to_bits()
    );
}

#[test]
fn resampling_keeps_a_uniform_motion() {
    let motion = read("time,angle\n0,0\n0.1,0.1\n0.2,0.3\n0.3,0.6\n0.4,0.7\n");
    let same = motion.clone().resampled(0.1).unwrap();
    let fine = motion.clone().resampled(0.05).unwrap();
    let displacement_m =
        |motion: &MotionTable| motion.columns().unwrap().displacement_m.clone().unwrap();
    for k in 0..5 {
        let given = displacement_m(&motion)[k];
        assert!((displacement_m(&same)[k] - given).abs() < 1e-15);
        assert!((displacement_m(&fine)[2 * k] - given).abs() < 1e-15);
    }
    assert_eq!([0, 1, 2, 7, 8].map(|k| fine.line_of(k).unwrap()), [2, 2, 3, 5, 6]);
}
