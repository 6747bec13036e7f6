//! Arms of several links on the command line: what is written and told, refusals, repetition.

use serde_json::Value;

use super::{Bench, column, keys, refusal, repository, stderr, stdout, succeeded};

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

/// The step of ninth order from 0 to 1.
fn step(u: f64) -> f64 {
    u.powi(5) * (126.0 - u * (420.0 - u * (540.0 - u * (315.0 - 70.0 * u))))
}

/// A path that moves the tip from one place to another in a second.
fn path(from: [f64; 2], to: [f64; 2]) -> String {
    let row = |k: u32| {
        let share = step(f64::from(k) / 500.0);
        let at = |axis: usize| from[axis] + share * (to[axis] - from[axis]);
        format!("{:.3},{:.15},{:.15}\n", f64::from(k) / 500.0, at(0), at(1))
    };
    format!("time,x,y\n{}", (0..=500).map(row).collect::<String>())
}

pub(super) fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("arm.toml", ARM);
    bench.write("path.csv", &path([0.9, -0.5], [0.9, 0.1]));
    bench
}

#[test]
fn an_arm_is_solved_written_told_and_repeated() {
    let bench = bench();
    let options = ["--deflections", "--moments"];
    let output = bench.done(&[&["solve", "arm.toml", "path.csv"], &options[..]].concat());
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
    bench.done(&["solve", "--repeat", "out"]);
    bench.ends(4, &["solve", "arm.toml", "path.csv", "--strict"]);
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
        bench.done(&["solve", file, &motion, "-o", folder]);
    }
    for file in ["torque.csv", "hub_angle.csv", "nodal_displacements.csv", "tip.csv", "nodes.csv"] {
        assert_eq!(
            bench.read(&format!("link/{file}")),
            bench.read(&format!("arm/{file}")),
            "{file}"
        );
    }
    bench.done(&["modes", "arm.toml"]);
}

/// The same motion as angles of the links, sampled from the rigid arm that follows the path.
#[test]
fn directions_of_the_links_lead_the_arm_too() {
    let bench = bench();
    bench.done(&["solve", "arm.toml", "path.csv", "--digits", "full"]);
    let of = |file: &str, name: &str| column(&bench, file, name);
    let rigid = [1, 2].map(|joint| of("out/joint_angles.csv", &format!("rigid_joint{joint}_rad")));
    let time = of("out/torques.csv", "time_s");
    let rows = time.iter().enumerate().filter(|(_, t)| (-1e-9..1.000_000_1).contains(*t));
    let rows = rows
        .map(|(k, t)| format!("{t:.3},{:.15},{:.15}\n", rigid[0][k], rigid[0][k] + rigid[1][k]));
    bench.write("angles.csv", &format!("time,angle1,angle2\n{}", rows.collect::<String>()));
    bench.done(&["solve", "arm.toml", "angles.csv", "-o", "angles"]);
    let [tip, led] = ["out", "angles"].map(|out| of(&format!("{out}/torques.csv"), "torque1_n_m"));
    let times = of("angles/torques.csv", "time_s");
    // Chords that keep their directions lead the tip by as little elsewhere as the links shorten.
    let range = tip.iter().fold(0.0_f64, |most, t| most.max(t.abs()));
    let mut compared = 0;
    for (t, torque) in times.iter().zip(&led) {
        let Some(k) = time.iter().position(|own| (own - t).abs() < 1e-6) else { continue };
        assert!((torque - tip[k]).abs() < 1e-2 * range, "{torque} {} at {t}", tip[k]);
        compared += 1;
    }
    assert!(compared > 500, "{compared}");
}

#[test]
fn an_arm_is_verified_and_what_is_left_out_is_found() {
    let bench = bench();
    let within = ["--set", "links.upper.limits.torque=50"];
    bench.done(&[&["solve", "arm.toml", "path.csv", "--verify"][..], &within].concat());
    let summary = bench.json("out/summary.json");
    let checks = summary["verification"].as_array().unwrap();
    let names: Vec<&str> = checks.iter().map(|check| check["name"].as_str().unwrap()).collect();
    for name in ["tip_error", "torque_of_joint2", "torque_at_rest1", "energy", "rigid_arm"] {
        assert!(names.contains(&name), "{names:?}");
    }
    assert!(checks.iter().all(|check| check["passes"] == true), "{checks:?}");
    let table = stdout(&bench.done(&[&["verify", "arm.toml", "path.csv"][..], &within].concat()));
    assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
    assert!(!table.contains("FAILS") && !table.contains("not made"), "{table}");
    // Without second-order terms the tip strays by more than it may, and the energy still adds up.
    let linear = ["--set", "analysis.second_order=\"none\""];
    let failed =
        bench.ends(4, &[&["verify", "arm.toml", "path.csv"][..], &within, &linear].concat());
    assert!(stderr(&failed).contains("tip, the joints moved as solved"), "{}", stderr(&failed));
    let energy = stdout(&failed);
    let energy = energy.lines().find(|line| line.starts_with("work less energy")).unwrap();
    assert!(!energy.contains("FAILS"), "{energy}");
    let hysteretic = ["--set", "links.*.damping={ model = \"hysteretic\", ratio = 0.01 }"];
    let unplayed =
        bench.run(&[&["verify", "arm.toml", "path.csv"][..], &within, &hysteretic].concat());
    assert!(stdout(&unplayed).contains("not made: the damping of a link"), "{}", stdout(&unplayed));
}

#[test]
fn a_limit_that_the_torque_of_a_joint_and_its_error_exceed_fails() {
    let bench = bench();
    bench.done(&["solve", "arm.toml", "path.csv"]);
    let summary = bench.json("out/summary.json");
    let peak_n_m = summary["results"]["joints"][0]["peak_torque_n_m"].as_f64().unwrap();
    let errors = summary["errors"]["joints"][0]["torque"].as_object().unwrap();
    let error: f64 = errors.values().filter_map(Value::as_f64).sum();
    let with = |beyond: f64| {
        let limit = format!("links.upper.limits.torque={:e}", peak_n_m * (1.0 + beyond * error));
        bench.run(&["verify", "arm.toml", "path.csv", "--set", &limit])
    };
    succeeded(with(10.0));
    refusal(4, with(0.1), "out of bounds: joint 1 limits.torque\n");
}

/// Angles go on over whole turns where the tip is led around the first joint, and the elbow stays on its side.
#[test]
fn whole_turns_of_the_tip_are_counted_and_the_elbow_stays_on_its_side() {
    let bench = bench();
    let around = |from: f64, by: f64| {
        let row = |k: u32| {
            let u = f64::from(k) / 800.0;
            let angle = from + by * step(u);
            format!("{:.3},{:.15},{:.15}\n", 4.0 * u, 0.8 * angle.cos(), 0.8 * angle.sin())
        };
        format!("time,x,y\n{}", (0..=800).map(row).collect::<String>())
    };
    for (elbow, from, by) in [("left", 0.3, 7.0), ("right", 2.9, 0.5), ("left", 2.9, -6.0)] {
        bench.write("around.csv", &around(from, by));
        let elbow = format!("elbow=\"{elbow}\"");
        bench.done(&["solve", "arm.toml", "around.csv", "--set", &elbow, "-q"]);
        let of = |file: &str, name: &str| column(&bench, &format!("out/{file}"), name);
        let chords = [1, 2].map(|link| of("chord_angles.csv", &format!("angle{link}_rad")));
        let steps = chords[0].windows(2).map(|pair| (pair[1] - pair[0]).abs());
        assert!(steps.fold(0.0, f64::max) < 0.1, "{elbow}: the chord jumps");
        let turned = chords[0][chords[0].len() - 1] - chords[0][0];
        assert!((turned - by).abs() < 0.05, "{elbow}: {turned} of {by}");
        for (first, second) in chords[0].iter().zip(&chords[1]) {
            let sine = if elbow.contains("left") { second - first } else { first - second };
            assert!((0.0..std::f64::consts::PI).contains(&sine), "{elbow}: {first} {second}");
        }
        let joint = of("joint_angles.csv", "joint2_rad");
        assert!(joint.iter().all(|angle| angle.abs() < 3.2), "{elbow}");
    }
}

#[test]
fn a_torque_that_a_given_lead_cuts_off_is_told() {
    let bench = bench();
    let cut = ["--set", "analysis.lead=0", "--set", "analysis.lag=0"];
    let softer = ["--set", "links.*.segments.*.EI*=0.5", "--set", "links.upper.limits.torque=50"];
    let output = bench.run(&[&["solve", "arm.toml", "path.csv", "-q"], &cut[..], &softer].concat());
    assert!(stderr(&output).contains("the finite period and the window leave the torque off"));
}

/// Three decimals: what they do to the torques is a bound of what they are off from those of all digits.
#[test]
fn a_path_of_few_digits_is_told_with_what_that_does() {
    let bench = bench();
    let exact = path([0.9, -0.5], [0.9, 0.1]);
    let rounded = exact.lines().skip(1).step_by(5).map(|row| {
        let numbers: Vec<f64> = row.split(',').map(|field| field.parse().unwrap()).collect();
        format!("{:.2},{:.3},{:.3}\n", numbers[0], numbers[1], numbers[2])
    });
    bench.write("rounded.csv", &format!("time,x,y\n{}", rounded.collect::<String>()));
    let within = ["--set", "links.upper.limits.torque=50"];
    let told =
        bench.run(&[&["solve", "arm.toml", "rounded.csv", "-o", "few"][..], &within].concat());
    let words =
        "remark: the path has 3 decimals, ±5.0e-4 m: the tip is followed to 1.7e-3 of its travel";
    assert!(stderr(&told).contains(words), "{}", stderr(&told));
    bench.done(&[&["solve", "arm.toml", "path.csv"][..], &within].concat());
    let of = |out: &str, name: &str| column(&bench, &format!("{out}/torques.csv"), name);
    let times = [of("few", "time_s"), of("out", "time_s")];
    let summary = bench.json("few/summary.json");
    for joint in [1, 2] {
        let name = format!("torque{joint}_n_m");
        let [few, all] = ["few", "out"].map(|out| of(out, &name));
        let range = all.iter().fold(f64::MIN, |m, t| m.max(*t))
            - all.iter().fold(f64::MAX, |m, t| m.min(*t));
        let off = times[0].iter().zip(&few).filter_map(|(time, torque)| {
            let k = times[1].iter().position(|own| (own - time).abs() < 1e-6)?;
            Some((torque - all[k]).abs() / range)
        });
        let off = off.fold(0.0, f64::max);
        let stated = summary["errors"]["joints"][joint - 1]["torque"]["input"].as_f64().unwrap();
        assert!(off > 1e-3 && (1.0..30.0).contains(&(stated / off)), "{stated:e} {off:e}");
    }
}

/// A coordinate that changes by its last decimal is held, and one that moves for few samples is no trap.
#[test]
fn coordinates_that_hardly_move_are_solved_or_refused_in_words() {
    let bench = bench();
    let write = |name: &str, y: &dyn Fn(u32) -> f64| {
        let row = |k: u32| {
            let u = f64::from(k) / 400.0;
            format!("{:.3},{:.3},{:.3}\n", 2.0 * u, 0.6 + 0.2 * step(u), y(k))
        };
        bench.write(name, &format!("time,x,y\n{}", (0..=400).map(row).collect::<String>()));
    };
    write("digit.csv", &|k| if k > 200 { 0.001 } else { 0.0 });
    write("short.csv", &|k| 0.001 * f64::from(k.clamp(200, 204) - 200));
    let linear =
        ["--set", "analysis.second_order=\"none\"", "--set", "links.upper.limits.torque=50"];
    bench.done(&[&["solve", "arm.toml", "digit.csv", "-q"][..], &linear].concat());
    let short = bench.run(&[&["solve", "arm.toml", "short.csv", "-q"][..], &linear].concat());
    let message = stderr(&short);
    assert!(!message.contains("panicked"), "{message}");
    assert!(message.contains("warning: ") || message.starts_with("error: "), "{message}");
}

#[test]
fn nodes_of_the_list_are_written_for_each_link_that_has_them_and_repeated() {
    let bench = bench();
    let path = repository("trajectories/arms/line_1.5s.csv");
    let two = repository("specs/arms/two_links.toml");
    let linear = ["--set", "analysis.second_order=\"none\"", "-q"];
    let elements =
        ["--set", "links.0.segments.0.elements=4", "--set", "links.1.segments.0.elements=2"];
    let run = |more: &[&str]| {
        bench.run(&[&["solve", &two, &path][..], &linear, &elements, more].concat())
    };
    succeeded(run(&["--moments", "-o", "all"]));
    succeeded(run(&["--moments", "--nodes", "4,1", "-o", "few"]));
    let heading = |file: &str| bench.read(file).lines().next().unwrap().to_owned();
    let names = "time_s,x1_4_m,y1_4_m,x1_1_m,y1_1_m,x2_1_m,y2_1_m";
    assert_eq!(heading("few/nodal_positions.csv"), names);
    assert_eq!(heading("few/bending_moments.csv"), "time_s,m1_4_n_m,m1_1_n_m,m2_1_n_m");
    for name in ["x1_4_m", "y2_1_m"] {
        let [few, all] =
            ["few", "all"].map(|run| column(&bench, &format!("{run}/nodal_positions.csv"), name));
        assert!(few.len() == all.len() && few.iter().zip(&all).all(|(a, b)| (a - b).abs() < 1e-9));
    }
    assert!(bench.read("few/nodes.csv") == bench.read("all/nodes.csv"), "it lists all nodes");
    bench.done(&["solve", "--repeat", "few", &two, &path]);

    // 0.7 m is the tip of the longer link, and not on the other. The links have four elements and two before: 0.3 m
    // is a node of the shorter, and 0.5 m divides both.
    succeeded(run(&["--moments", "--stations", "0.7,0.3,0.5", "-o", "at"]));
    let told = stdout(&run(&["--stations", "0.7,0.3", "-o", "told"]));
    assert!(told.is_empty(), "{told}");
    let names = "time_s,m1_6_n_m,m1_2_n_m,m1_4_n_m,m2_1_n_m,m2_2_n_m";
    assert_eq!(heading("at/bending_moments.csv"), names);

    let told = stderr(&bench.ends(3, &["report", "few"]));
    assert!(told.contains("must include x1_0_m") && told.contains("without --nodes"), "{told}");
}
