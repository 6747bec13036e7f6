//! `modes` and `frf` of arms in a pose: what is told and written, refusals, and the arm whose hardware was measured.

use serde_json::Value;

use super::{Bench, apart, keys, number, peak, stderr, stdout};

const ARM: &str = "gravity = [0, -9.81]
[[links]]
name = 'upper'
segments = [{ length = 0.7, EI = 60, mass_per_length = 0.8 }]
hub = { inertia = 0.02 }
tip = { mass = 0.6, inertia = 0.01 }
damping = { model = 'hysteretic', ratio = 0.02 }
drive = { joint_stiffness = 200 }
[[links]]
name = 'fore'
segments = [{ length = 0.6, EI = 15, mass_per_length = 0.4 }]
hub = { inertia = 0.005, viscous_friction = 0.1 }
payload = { mass = 0.3 }
damping = { model = 'rayleigh', beta = 2e-4 }
";

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("arm.toml", ARM);
    bench
}

#[test]
fn modes_of_a_pose_are_told_with_swings_first_and_zeros_of_each_link() {
    let bench = bench();
    let lines = |pose: &str| {
        let output = bench.done(&["modes", "arm.toml", "--count", "3", "--at", pose]);
        let falls = stderr(&output).starts_with("warning: the arm falls from this pose");
        assert!(falls || stderr(&output).is_empty(), "{}", stderr(&output));
        assert_eq!(falls, pose.starts_with("90 deg"), "{}", stderr(&output));
        stdout(&output).lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let hanging = lines("-90 deg,-90 deg");
    assert_eq!(hanging[0], "arm of 2 links, 1.300 m; the links point to -1.571, -1.571 rad");
    assert_eq!(hanging[1], "the tip rests at 0.000, -1.300 m");
    assert_eq!(hanging[3], "joints free; the first 2 are swings of the whole arm");
    assert!(hanging[4].ends_with("mesh error  joints"), "{hanging:?}");
    assert!(hanging[5].ends_with("  1.000  0.672"), "{hanging:?}");
    assert_eq!(hanging[10], "rotors held, joint springs 200.0, stiff N m/rad");
    let upper = hanging.iter().position(|line| line == "link upper, from its joint to its tip");
    let blocked = hanging[upper.unwrap()..].iter().filter(|line| line.starts_with("at "));
    assert_eq!(blocked.count(), 1, "{hanging:?}");
    let up = lines("90 deg,1.5708");
    assert!(up[5].starts_with("1      not stable: it leaves the pose as e^(t/0.1"), "{up:?}");
    bench.ends(4, &["modes", "arm.toml", "--at", "90 deg,1.5708", "--deny-warnings"]);
    let flat = bench.printed("modes arm.toml --at 0.3,1.2 --set gravity=[0,0]");
    assert!(flat.contains("\n2      neutral: the arm stays where it is turned\n"), "{flat}");
    let json = bench.reply("modes arm.toml --at 0.3,1.2 --json --count 2");
    assert_eq!(json["free"]["joints"].as_array().unwrap().len(), 4);
    assert_eq!(json["held"]["frequency_hz"].as_array().unwrap().len(), 2);
    assert!(json["joint_stiffness_n_m_rad"][1].is_null());
    assert_eq!(keys(&json["links"][0]).len(), 4);
    // At rest the second joint holds its link's weight at its middle and its payload's at its end.
    let held = number(&json, "holding_torque_n_m/1");
    let weighs = 9.81 * 1.2_f64.cos() * (0.24 * 0.3 + 0.3 * 0.6);
    assert!((held / weighs - 1.0).abs() < 0.02, "{held} {weighs}");
}

#[test]
fn responses_to_each_torque_are_written_with_what_they_are_wrong_by() {
    let bench = bench();
    let pose = ["frf", "arm.toml", "--at", "-60 deg,-20 deg"];
    let band = ["--from", "0.3", "--to", "60", "--points", "40", "-o", "frf.csv"];
    let told = bench.told(&[&pose[..], &band].concat());
    assert!(told.starts_with("note: the mesh error is "), "{told}");
    let table = bench.table("frf.csv");
    assert_eq!((table.len(), table[0].1.len()), (2 + 2 * 4 * 4, 40));
    let column = |name: &str| bench.numbers("frf.csv", name);
    assert!(peak(&column("mesh_error")) < 1e-4);
    for part in ["real", "imag"] {
        let [a, b] = ["joint1_per_torque2_rad_n_m", "joint2_per_torque1_rad_n_m"]
            .map(|name| column(&format!("{name}_{part}")));
        assert!(apart(&a, &b) < 1e-9 * peak(&a), "{part}");
    }
    assert!(column("tip_x_per_torque1_1_n_magnitude").iter().all(|own| *own > 0.0));
    let json = bench.reply(&[&pose[..], &["--points", "3", "--json"]].concat());
    assert_eq!(keys(&json).len(), 34);
    let up = "frf arm.toml --at 1.5,1.6 --points 3 --deny-warnings";
    bench.refuses(4, up, "warning: the arm falls from this pose");
}

#[test]
fn modes_shapes_and_zeros_of_a_pose_are_tabled() {
    let bench = bench();
    let pose = ["modes", "arm.toml", "--at", "-60 deg,20 deg", "--count", "2"];
    let json = bench.reply(&[&pose[..], &["-o", "m", "--json"]].concat());
    let files = ["held_modes.csv", "mode_shapes.csv", "modes.csv", "zeros.csv"];
    assert_eq!(bench.names("m"), files);
    let numbers = |list: &Value| -> Vec<f64> {
        list.as_array().unwrap().iter().map(|own| own.as_f64().unwrap_or(f64::NAN)).collect()
    };

    // The first swing falls: it has a rate in place of a frequency.
    let modes = bench.rows("m/modes.csv");
    let own = ["growth_per_s", "damping_ratio", "mesh_error", "joint1", "joint2"];
    let common = ["mode", "omega_rad_s", "frequency_hz", "period_s"];
    assert_eq!(modes[0], [&common[..], &own].concat());
    assert_eq!(
        (modes.len(), &modes[1][..4]),
        (1 + 2 + 2, &["1", "", "", ""].map(str::to_owned)[..])
    );
    let growth = bench.numbers("m/modes.csv", "growth_per_s");
    assert!((growth[0] - number(&json, "free/growth_per_s/0")).abs() < 1e-9);
    assert!(growth[1..].iter().all(|own| own.is_nan()), "{growth:?}");
    let hertz = bench.numbers("m/modes.csv", "frequency_hz");
    assert!(apart(&hertz[1..], &numbers(&json["free"]["frequency_hz"])[1..]) < 1e-8);
    let held = bench.rows("m/held_modes.csv");
    assert_eq!((held[0].len(), held.len()), (9, 3));

    // Links in order, each from its joint to its tip, where the next one begins.
    let shapes = bench.table("m/mode_shapes.csv");
    let names: Vec<&str> = shapes.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names[..6], ["link", "x_m", "rest_x_m", "rest_y_m", "mode_1_x", "mode_1_y"]);
    assert_eq!(names[12..15], ["mode_1_slope", "mode_2_slope", "mode_3_slope"]);
    assert_eq!(names[16..19], ["held_1_x", "held_1_y", "held_1_slope"]);
    assert_eq!(names.len(), 4 + 3 * 4 + 3 * 2);
    let root = shapes[0].1.iter().position(|link| *link > 1.5).unwrap();
    assert!((shapes[1].1[root - 1] - 0.7).abs() < 1e-9 && shapes[1].1[root] == 0.0);
    // The second joint turns by the step of the slope there.
    let turns = json["free"]["joints"].as_array().unwrap();
    for (mode, turns) in turns.iter().enumerate() {
        let slope = &shapes[12 + mode].1;
        let ratio =
            slope[root] - slope[root - 1] - number(turns, "1") / number(turns, "0") * slope[0];
        assert!(ratio.abs() < 1e-6 * peak(slope), "mode {}: {ratio}", mode + 1);
    }
    for (name, values) in shapes[2..].iter().filter(|(name, _)| !name.ends_with("slope")) {
        assert!((values[root] - values[root - 1]).abs() < 1e-9, "{name}");
        assert!(values[0].abs() < 1e-12, "{name}");
    }
    let tip = [2, 3].map(|axis: usize| *shapes[axis].1.last().unwrap());
    assert!(apart(&tip, &numbers(&json["tip_m"])) < 1e-9);
    // Where the first joint turns most, it turns counterclockwise: from -60 deg towards x.
    let turns = (0..4).filter(|mode| json["free"]["joints"][*mode][0] == 1.0);
    for mode in turns.inspect(|mode| assert!(*mode > 0)) {
        let [x, y] = [0, 1].map(|axis: usize| shapes[4 + 2 * mode + axis].1[1]);
        assert!(0.866 * x + 0.5 * y > 0.0, "mode {}", mode + 1);
    }

    // The drive's spring is in the first joint alone; zeros of both links stand in one table.
    let zeros = bench.rows("m/zeros.csv");
    assert_eq!(zeros[0][..2], ["link", "zero_per_s"]);
    for link in 0..2 {
        let of_link = |row: &&Vec<String>| row[0] == (link + 1).to_string() && !row[1].is_empty();
        let own = zeros.iter().filter(of_link).map(|row| row[1].parse::<f64>().unwrap());
        let ratios = own.zip(numbers(&json["links"][link]["zero_per_s"])).map(|(a, b)| a / b - 1.0);
        let ratios: Vec<f64> = ratios.collect();
        assert!(ratios.len() == 2 && ratios.iter().all(|off| off.abs() < 1e-9), "{ratios:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn many_modes_tell_how_far_they_are() {
    let bench = bench();
    let program = env!("CARGO_BIN_EXE_flexlink");
    let modes = format!("timeout 4 {program} modes arm.toml --at 0.1,1.2 --count 1000");
    let mut script = std::process::Command::new("script");
    let script = script.args(["-qec", &modes, "/dev/null"]).current_dir(bench.path("."));
    // Without `script` there is no terminal to print to.
    let Ok(output) = script.output() else { return };
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(told.contains("finding modes and zeros"), "{told}");
}
