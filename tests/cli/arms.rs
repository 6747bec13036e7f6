//! Arms of several links on the command line: what is written and told, refusals, repetition.

use super::{Bench, column, keys, repository, stderr, stdout};

const ARM: &str = "gravity = [0, -9.81]
elbow = 'left'
[[links]]
name = 'upper'
segments = [{ length = 0.7, EI = 60, mass_per_length = 0.8 }]
hub = { inertia = 0.02 }
tip = { mass = 0.6 }
damping = { model = 'rayleigh', beta = 2e-4 }
limits = { torque = 5 }
[[links]]
name = 'fore'
segments = [{ length = 0.6, EI = 15, mass_per_length = 0.4 }]
hub = { inertia = 0.005, viscous_friction = 0.1 }
payload = { mass = 0.3 }
damping = { model = 'rayleigh', beta = 2e-4 }
drive = { gear_ratio = 50, rotor_inertia = 1e-6 }
";

/// The step of ninth order from 0 to 1, and a path that moves the tip from one place to another in a second.
fn path(from: [f64; 2], to: [f64; 2]) -> String {
    let step = |u: f64| u.powi(5) * (126.0 - u * (420.0 - u * (540.0 - u * (315.0 - 70.0 * u))));
    let row = |k: u32| {
        let share = step(f64::from(k) / 500.0);
        let at = |axis: usize| from[axis] + share * (to[axis] - from[axis]);
        format!("{:.3},{:.15},{:.15}\n", f64::from(k) / 500.0, at(0), at(1))
    };
    format!("time,x,y\n{}", (0..=500).map(row).collect::<String>())
}

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("arm.toml", ARM);
    bench.write("path.csv", &path([0.9, -0.5], [0.9, 0.1]));
    bench
}

#[test]
fn an_arm_is_solved_written_told_and_repeated() {
    let bench = bench();
    let options = ["--deflections", "--moments"];
    let output = bench.run(&[&["solve", "arm.toml", "path.csv"], &options[..]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let warned = stderr(&output);
    assert!(warned.starts_with("warning: joint 1: limits.torque = 5 N m is exceeded"), "{warned}");
    assert_eq!(warned.matches("warning:").count(), 1, "{warned}");
    let text = stdout(&output);
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    for begins in
        ["arm      2 links, 1.300 m", "link 1   upper, ", "order    full: ", "joint 2  peak "]
    {
        assert!(text.lines().any(|line| line.starts_with(begins)), "{text}");
    }
    // The tip is where the path is, before it, on it and after it, and the last node is the tip.
    let of = |file: &str, name: &str| column(&bench, &format!("out/{file}"), name);
    let (time, x, y) = (of("tip.csv", "time_s"), of("tip.csv", "x_m"), of("tip.csv", "y_m"));
    let wanted = path([0.9, -0.5], [0.9, 0.1]);
    let wanted = wanted.lines().skip(1).map(|row| row.split(',').nth(2).unwrap().parse().unwrap());
    let wanted: Vec<f64> = wanted.collect();
    for ((time, x), y) in time.iter().zip(&x).zip(&y) {
        let rows = wanted.iter().enumerate();
        let row = rows.min_by(|a, b| {
            let off = |row: usize| (row as f64 / 500.0 - time.clamp(0.0, 1.0)).abs();
            off(a.0).total_cmp(&off(b.0))
        });
        let off = (y - row.unwrap().1).hypot(x - 0.9);
        assert!(off < 1e-6 * 0.6, "{off:e} m at {time} s");
    }
    let nodes = bench.read("out/nodes.csv");
    let last = nodes.lines().last().unwrap();
    let node = last.split(',').nth(1).unwrap();
    assert!(last.starts_with("2,") && last.ends_with(",fore"), "{last}");
    let tip = of("nodal_positions.csv", &format!("y2_{node}_m"));
    assert!(tip.iter().zip(&y).all(|(a, b)| (a - b).abs() < 1e-9));
    // At rest the first joint holds all weights where they are: at their share of the way to the tip's place.
    let torque = of("torques.csv", "torque1_n_m");
    let middles = |link: &str, mass: f64| {
        let places = of("nodal_positions.csv", link);
        9.81 * mass * places[0]
    };
    let elements: usize = node.parse().unwrap();
    let upper = middles(&format!("x1_{}_m", elements / 2), 0.56);
    let fore = middles(&format!("x2_{}_m", elements / 2), 0.24);
    let held = upper + fore + middles(&format!("x1_{elements}_m"), 0.6) + 9.81 * 0.3 * 0.9;
    assert!((torque[0] / held - 1.0).abs() < 1e-3, "{} {held}", torque[0]);
    // The motor turns fifty times as far, and takes a fiftieth at rest.
    let (motor, elbow) = (of("motor.csv", "motor2_torque_n_m"), of("torques.csv", "torque2_n_m"));
    assert!((50.0 * motor[0] / elbow[0] - 1.0).abs() < 1e-6);
    let summary = bench.json("out/summary.json");
    assert_eq!(summary["second_order"]["order"], "full");
    assert_eq!(summary["results"]["joints"].as_array().unwrap().len(), 2);
    assert!(keys(&summary["errors"]["joints"][0]["torque"]).contains(&"iteration"));
    let again = bench.run(&["solve", "--repeat", "out"]);
    assert!(again.status.success(), "{}", stdout(&again));
    let strict = bench.run(&["solve", "arm.toml", "path.csv", "--strict"]);
    assert_eq!(strict.status.code(), Some(4));
    let page = bench.run(&["report", "out"]);
    assert!(stderr(&page).contains("results of one link"), "{}", stderr(&page));
}

#[test]
fn an_arm_of_one_link_gives_the_bytes_of_the_link() {
    let bench = Bench::new();
    let body = "segments = [{ length = 0.7, EI = 60, mass_per_length = 0.8 }]
hub = { inertia = 0.02 }
payload = { mass = 0.3 }
damping = { model = 'hysteretic', ratio = 0.02 }
";
    bench.write("link.toml", &format!("title = 'one'\n{body}"));
    bench.write("arm.toml", &format!("title = 'one'\n[[links]]\nname = 'only'\n{body}"));
    let motion = repository("trajectories/sine_0.88s.csv");
    for (file, folder) in [("link.toml", "link"), ("arm.toml", "arm")] {
        let output = bench.run(&["solve", file, &motion, "-o", folder]);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    for file in ["torque.csv", "hub_angle.csv", "nodal_displacements.csv", "tip.csv", "nodes.csv"] {
        assert_eq!(
            bench.read(&format!("link/{file}")),
            bench.read(&format!("arm/{file}")),
            "{file}"
        );
    }
    let modes = bench.run(&["modes", "arm.toml"]);
    assert!(modes.status.success(), "{}", stderr(&modes));
}

#[test]
fn what_an_arm_cannot_follow_is_refused_by_its_row() {
    let bench = bench();
    let refused = |file: &str, more: &[&str], code: i32, words: &str| {
        let output = bench.run(&[&["solve", "arm.toml", file], more].concat());
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{message}");
        assert!(message.starts_with("error: ") && message.contains(words), "{message}");
    };
    bench.write("far.csv", &path([0.9, -0.5], [1.2, 0.9]));
    refused("far.csv", &[], 3, "m from the first joint, but must be from 0.100000 to 1.300000 m");
    bench.write("stretched.csv", &path([0.9, -0.5], [1.2999, 0.0]));
    refused("stretched.csv", &[], 3, "the sine of the elbow's angle = 0.0");
    bench.write("moving.csv", "time,x,y\n0,0.9,0\n0.1,0.9,0.1\n0.2,0.9,0.2\n0.3,0.9,0.3\n");
    refused("moving.csv", &[], 3, "y: the motion starts with a velocity");
    bench.write("lone.csv", "time,displacement\n0,0\n1,1\n2,1\n3,1\n");
    refused("lone.csv", &[], 3, "x and y, or angle1");
    refused("path.csv", &["--verify"], 2, "--verify is for one link");
    refused("path.csv", &["--nodes", "1"], 2, "--nodes is for one link");
    refused("path.csv", &["--set", "links.upper.hub.inertia=-1"], 3, "links.0.hub.inertia = -1");
    refused(
        "path.csv",
        &["--set", "links.lower.payload.mass=1"],
        3,
        "links.lower is not in the file",
    );
    bench.write("no_elbow.toml", &ARM.replace("elbow = 'left'\n", ""));
    let output = bench.run(&["solve", "no_elbow.toml", "path.csv"]);
    assert!(stderr(&output).contains("elbow = nothing"), "{}", stderr(&output));
    for command in [&["verify", "arm.toml", "path.csv"][..], &["modes", "arm.toml"]] {
        let output = bench.run(command);
        assert_eq!(output.status.code(), Some(3));
        assert!(stderr(&output).contains("arm of one link, but the file has more"));
    }
}

/// The same motion as angles of the links, sampled from the rigid arm that follows the path.
#[test]
fn directions_of_the_links_lead_the_arm_too() {
    let bench = bench();
    assert!(bench.run(&["solve", "arm.toml", "path.csv", "--digits", "full"]).status.success());
    let of = |file: &str, name: &str| column(&bench, file, name);
    let rigid = [1, 2].map(|joint| of("out/joint_angles.csv", &format!("rigid_angle{joint}_rad")));
    let time = of("out/torques.csv", "time_s");
    let rows = time.iter().enumerate().filter(|(_, t)| (-1e-9..1.000_000_1).contains(*t));
    let rows = rows
        .map(|(k, t)| format!("{t:.3},{:.15},{:.15}\n", rigid[0][k], rigid[0][k] + rigid[1][k]));
    bench.write("angles.csv", &format!("time,angle1,angle2\n{}", rows.collect::<String>()));
    let output = bench.run(&["solve", "arm.toml", "angles.csv", "-o", "angles"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let [tip, led] = ["out", "angles"].map(|out| of(&format!("{out}/torques.csv"), "torque1_n_m"));
    let times = of("angles/torques.csv", "time_s");
    // Chords that keep their directions lead the tip by as little elsewhere as the links shorten.
    let range = tip.iter().fold(0.0_f64, |most, t| most.max(t.abs()));
    for (t, torque) in times.iter().zip(&led) {
        let Some(k) = time.iter().position(|own| (own - t).abs() < 1e-6) else { continue };
        assert!((torque - tip[k]).abs() < 1e-2 * range, "{torque} {} at {t}", tip[k]);
    }
}
