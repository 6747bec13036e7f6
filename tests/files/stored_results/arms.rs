//! Runs of arms.

use std::fs;

use super::Bench;

const ARM: &str = "specs/arms/two_links.toml trajectories/arms/line_1.5s.csv";

/// A drive of the outer joint alone.
const DRIVE: &str = "--set links.fore.drive={gear_ratio=50,rotor_inertia=1e-6}";

#[test]
fn an_arm_comes_back_as_its_tables_with_the_motor_of_the_joint_that_has_one() {
    let bench = Bench::new();
    bench.run(&format!("solve {ARM} --moments {DRIVE}"), "out");
    let run = bench.run_of("out");
    assert!(run.arc.is_none() && run.moving_s.is_some());
    assert!(run.times_s == bench.column("out/torques.csv", "time_s"));
    assert!(run.joints[0].motor.is_none());
    let motor = run.joints[1].motor.as_ref().unwrap();
    assert!(motor.torque_n_m == bench.column("out/motor.csv", "motor2_torque_n_m"));
    assert!(motor.rate_rad_s == bench.column("out/motor.csv", "motor2_rate_rad_s"));
    for (number, (joint, link)) in (1..).zip(run.joints.iter().zip(&run.links)) {
        let column = |file: &str, name: String| bench.column(&format!("out/{file}"), &name);
        assert!(joint.torque_n_m == column("torques.csv", format!("torque{number}_n_m")));
        assert!(joint.angle_rad == column("joint_angles.csv", format!("joint{number}_rad")));
        let rate = column("joint_angles.csv", format!("joint{number}_rate_rad_s"));
        assert!(joint.rate_rad_s == rate);
        let rigid = column("rigid_torques.csv", format!("rigid_torque{number}_n_m"));
        assert!(joint.rigid_torque_n_m == Some(rigid));
        for (node, [x, y]) in link.positions_m.iter().enumerate() {
            assert!(*x == column("nodal_positions.csv", format!("x{number}_{node}_m")));
            assert!(*y == column("nodal_positions.csv", format!("y{number}_{node}_m")));
        }
        let moments = link.moments_n_m.as_ref().unwrap();
        assert_eq!(moments.nodes.len(), link.nodes_m.len());
        assert!(moments.histories[0] == column("bending_moments.csv", format!("m{number}_0_n_m")));
    }
    assert!(run.tip_m == ["x_m", "y_m"].map(|name| bench.column("out/tip.csv", name)));
}

/// The refusal of the run `out` with a change of one of its files, which is undone.
#[track_caller]
fn after(bench: &Bench, file: &str, from: &str, to: &str) -> (String, Option<String>) {
    let path = bench.path("out").join(file);
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{from}");
    fs::write(&path, text.replacen(from, to, 1)).unwrap();
    let refusal = bench.refusal("out");
    fs::write(&path, text).unwrap();
    refusal
}

#[test]
fn a_damaged_run_of_an_arm_is_refused() {
    let bench = Bench::new();
    bench.run(&format!("solve {ARM}"), "out");
    let (lead, _) = after(&bench, "summary.json", "\"lead_s\": ", "\"lead_s\": true, \"lead\": ");
    assert_eq!(lead, "out/summary.json: results.joints.0.lead_s is missing");
    // Nodes are named in their order, 2 before 10; the run was not asked to leave some out.
    let (node, hint) = after(&bench, "nodal_positions.csv", ",x2_2_m", ",x2_2_mm");
    assert!(node.contains("x2_2_mm") && !hint.unwrap_or_default().contains("--nodes"), "{node}");
    let (tip, _) = after(&bench, "tip.csv", ",velocity_x_m_s", ",u_m_s");
    assert!(tip.contains("velocity_x_m_s"), "{tip}");
    bench.run(&format!("solve {ARM} --nodes 0,2"), "out");
    let (node, hint) = bench.refusal("out");
    assert!(node.contains("x1_1_m") && hint.unwrap().contains("without --nodes"), "{node}");
}

#[test]
fn a_strange_motor_beside_a_simulation_is_left_alone() {
    let bench = Bench::new();
    bench.run(&format!("solve {ARM}"), "out");
    let (arm, torques) = (ARM.split(' ').next().unwrap(), bench.file("out/torques.csv"));
    bench.run(&["simulate", arm, &torques, "--at", "1.2,2.4"], "played");
    bench.write("played/motor.csv", "time_s,a\n0,1\n");
    let run = bench.run_of("played");
    assert!(run.joints.iter().all(|own| own.motor.is_none() && own.rigid_angle_rad.is_none()));
    assert!(run.joints[1].torque_n_m == bench.column("played/torques.csv", "torque2_n_m"));
}
