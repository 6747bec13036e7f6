//! Arms of several links on the command line: what is written and told, refusals, repetition.

use serde_json::Value;

use super::{
    Bench, MOTION, apart, column, keys, ninth, number, peak, refusal, stderr, stdout, succeeded,
};

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

/// A path from 0.5 m below the first joint to 0.1 m above it in a second.
pub(super) fn path(k: f64) -> [f64; 3] {
    [k / 500.0, 0.9, -0.5 + 0.6 * ninth(k / 500.0)]
}

pub(super) fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("arm.toml", ARM);
    bench.sampled("path.csv", "time,x,y", 0..=500, path);
    bench
}

/// Keeps the torque within its limit.
const WITHIN: &str = "--set links.upper.limits.torque=50";

#[test]
fn an_arm_is_solved_written_told_and_repeated() {
    let bench = bench();
    let output = bench.done("solve arm.toml path.csv --deflections --moments");
    let warned = stderr(&output);
    assert!(warned.starts_with("warning: joint 1: limits.torque = 5 N m is exceeded"), "{warned}");
    assert_eq!(warned.matches("warning:").count(), 1, "{warned}");
    let text = stdout(&output);
    for begins in
        ["arm      2 links, 1.300 m", "link 1   upper, ", "order    full: ", "joint 2  peak "]
    {
        assert!(text.lines().any(|line| line.starts_with(begins)), "{text}");
    }
    // The tip is where the path is, before it, on it and after it, and the last node is the tip.
    let of = |file: &str, name: &str| column(&bench, &format!("out/{file}"), name);
    let (time, x, y) = (of("tip.csv", "time_s"), of("tip.csv", "x_m"), of("tip.csv", "y_m"));
    for ((time, x), y) in time.iter().zip(&x).zip(&y) {
        let [_, x_m, y_m] = path(500.0 * time.clamp(0.0, 1.0));
        let off = (y - y_m).hypot(x - x_m);
        assert!(off < 1e-6 * 0.6, "{off:e} m at {time} s");
    }
    let nodes = bench.read("out/nodes.csv");
    let last = nodes.lines().last().unwrap();
    let node = last.split(',').nth(1).unwrap();
    assert!(last.starts_with("2,") && last.ends_with(",fore"), "{last}");
    assert!(apart(&of("nodal_positions.csv", &format!("y2_{node}_m")), &y) < 1e-9);
    // At rest the first joint holds all weights where they are: at their share of the way to the tip's place.
    let torque = of("torques.csv", "torque1_n_m");
    let weighs = |node: &str, mass: f64| 9.81 * mass * of("nodal_positions.csv", node)[0];
    let elements: usize = node.parse().unwrap();
    let upper = weighs(&format!("x1_{}_m", elements / 2), 0.56);
    let fore = weighs(&format!("x2_{}_m", elements / 2), 0.24);
    let held = upper + fore + weighs(&format!("x1_{elements}_m"), 0.6) + 9.81 * 0.3 * 0.9;
    assert!((torque[0] / held - 1.0).abs() < 1e-3, "{} {held}", torque[0]);
    // The motor turns fifty times as far, and takes a fiftieth at rest.
    let (motor, elbow) = (of("motor.csv", "motor2_torque_n_m"), of("torques.csv", "torque2_n_m"));
    assert!((50.0 * motor[0] / elbow[0] - 1.0).abs() < 1e-6);
    let summary = bench.json("out/summary.json");
    assert_eq!(summary["second_order"]["order"], "full");
    assert_eq!(summary["results"]["joints"].as_array().unwrap().len(), 2);
    assert!(keys(&summary["errors"]["joints"][0]["torque"]).contains(&"iteration"));
    bench.done("solve --repeat out");
    bench.ends(4, "solve arm.toml path.csv --strict");
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
    for name in ["link", "arm"] {
        bench.done(&format!("solve {name}.toml {MOTION} -o {name}"));
    }
    let tables = |folder: &str| {
        let mut contents = bench.contents(folder);
        contents.retain(|(name, _)| name != "summary.json");
        contents
    };
    assert!(tables("link") == tables("arm"));
    bench.done("modes arm.toml");
}

/// The same motion as angles of the links, sampled from the rigid arm that follows the path.
#[test]
fn directions_of_the_links_lead_the_arm_too() {
    let bench = bench();
    bench.done("solve arm.toml path.csv --digits full");
    let of = |file: &str, name: &str| column(&bench, file, name);
    let [first, second] =
        [1, 2].map(|joint| of("out/joint_angles.csv", &format!("rigid_joint{joint}_rad")));
    let time = of("out/torques.csv", "time_s");
    let rows = time.iter().enumerate().filter(|(_, t)| (-1e-9..1.000_000_1).contains(*t));
    let rows = rows.map(|(k, t)| format!("{t:.3},{:.15},{:.15}\n", first[k], first[k] + second[k]));
    bench.write("angles.csv", &format!("time,angle1,angle2\n{}", rows.collect::<String>()));
    bench.done("solve arm.toml angles.csv -o angles");
    let [tip, led] = ["out", "angles"].map(|out| of(&format!("{out}/torques.csv"), "torque1_n_m"));
    let times = of("angles/torques.csv", "time_s");
    // Chords that keep their directions lead the tip by as little elsewhere as the links shorten.
    let mut compared = 0;
    for (t, torque) in times.iter().zip(&led) {
        let Some(k) = time.iter().position(|own| (own - t).abs() < 1e-6) else { continue };
        assert!((torque - tip[k]).abs() < 1e-2 * peak(&tip), "{torque} {} at {t}", tip[k]);
        compared += 1;
    }
    assert!(compared > 500, "{compared}");
}

#[test]
fn an_arm_is_verified_and_what_is_left_out_is_found() {
    let bench = bench();
    bench.done(&format!("solve arm.toml path.csv --verify {WITHIN}"));
    let summary = bench.json("out/summary.json");
    let checks = summary["verification"].as_array().unwrap();
    let names: Vec<&str> = checks.iter().map(|check| check["name"].as_str().unwrap()).collect();
    for name in ["tip_error", "torque_of_joint2", "torque_at_rest1", "energy", "rigid_arm"] {
        assert!(names.contains(&name), "{names:?}");
    }
    assert!(checks.iter().all(|check| check["passes"] == true), "{checks:?}");
    let verify = format!("verify arm.toml path.csv {WITHIN}");
    let table = bench.printed(&verify);
    assert!(!table.contains("FAILS") && !table.contains("not made"), "{table}");
    // Without second-order terms the tip strays by more than it may, and the energy still adds up.
    let failed = bench.ends(4, &format!("{verify} --set analysis.second_order=\"none\""));
    assert!(stderr(&failed).contains("tip, the joints moved as solved"), "{}", stderr(&failed));
    let energy = stdout(&failed);
    let energy = energy.lines().find(|line| line.starts_with("work less energy")).unwrap();
    assert!(!energy.contains("FAILS"), "{energy}");
    let hysteretic = "--set links.*.damping={model=\"hysteretic\",ratio=0.01}";
    let unplayed = stdout(&bench.run(&format!("{verify} {hysteretic}")));
    assert!(unplayed.contains("not made: the damping of a link"), "{unplayed}");
}

#[test]
fn a_limit_that_the_torque_of_a_joint_and_its_error_exceed_fails() {
    let bench = bench();
    bench.done("solve arm.toml path.csv");
    let summary = bench.json("out/summary.json");
    let peak_n_m = number(&summary, "results/joints/0/peak_torque_n_m");
    let errors = summary["errors"]["joints"][0]["torque"].as_object().unwrap();
    let error: f64 = errors.values().filter_map(Value::as_f64).sum();
    let with = |beyond: f64| {
        let limit = peak_n_m * (1.0 + beyond * error);
        bench.run(&format!("verify arm.toml path.csv --set links.upper.limits.torque={limit:e}"))
    };
    succeeded(with(10.0));
    refusal(4, with(0.1), "out of bounds: joint 1 limits.torque\n");
}

/// Angles go on over whole turns where the tip is led around the first joint, and the elbow stays on its side.
#[test]
fn whole_turns_of_the_tip_are_counted_and_the_elbow_stays_on_its_side() {
    let bench = bench();
    for (elbow, from, by) in [("left", 0.3, 7.0), ("right", 2.9, 0.5), ("left", 2.9, -6.0)] {
        bench.sampled("around.csv", "time,x,y", 0..=800, |k| {
            let angle: f64 = from + by * ninth(k / 800.0);
            [k / 200.0, 0.8 * angle.cos(), 0.8 * angle.sin()]
        });
        bench.done(&format!("solve arm.toml around.csv --set elbow=\"{elbow}\" -q"));
        let of = |file: &str, name: &str| column(&bench, &format!("out/{file}"), name);
        let chords = [1, 2].map(|link| of("chord_angles.csv", &format!("angle{link}_rad")));
        let steps = chords[0].windows(2).map(|pair| (pair[1] - pair[0]).abs());
        assert!(steps.fold(0.0, f64::max) < 0.1, "{elbow}: the chord jumps");
        let turned = chords[0][chords[0].len() - 1] - chords[0][0];
        assert!((turned - by).abs() < 0.05, "{elbow}: {turned} of {by}");
        for (first, second) in chords[0].iter().zip(&chords[1]) {
            let sine = if elbow == "left" { second - first } else { first - second };
            assert!((0.0..std::f64::consts::PI).contains(&sine), "{elbow}: {first} {second}");
        }
        assert!(peak(&of("joint_angles.csv", "joint2_rad")) < 3.2, "{elbow}");
    }
}

#[test]
fn a_torque_that_a_given_lead_cuts_off_is_told() {
    let cut = "--set analysis.lead=0 --set analysis.lag=0 --set links.*.segments.*.EI*=0.5";
    let output = bench().run(&format!("solve arm.toml path.csv -q {cut} {WITHIN}"));
    assert!(stderr(&output).contains("the finite period and the window leave the torque off"));
}

/// Three decimals: what they do to the torques is a bound of what they are off from those of all digits.
#[test]
fn a_path_of_few_digits_is_told_with_what_that_does() {
    let bench = bench();
    let rounded = (0..=100).map(|k| {
        let [time, x, y] = path(5.0 * f64::from(k));
        format!("{time:.2},{x:.3},{y:.3}\n")
    });
    bench.write("rounded.csv", &format!("time,x,y\n{}", rounded.collect::<String>()));
    let told = stderr(&bench.run(&format!("solve arm.toml rounded.csv -o few {WITHIN}")));
    let words =
        "remark: the path has 3 decimals, ±5.0e-4 m: the tip is followed to 1.7e-3 of its travel";
    assert!(told.contains(words), "{told}");
    bench.done(&format!("solve arm.toml path.csv {WITHIN}"));
    let of = |out: &str, name: &str| column(&bench, &format!("{out}/torques.csv"), name);
    let times = [of("few", "time_s"), of("out", "time_s")];
    for joint in [1, 2] {
        let [few, all] = ["few", "out"].map(|out| of(out, &format!("torque{joint}_n_m")));
        let [low, high] = [f64::min, f64::max].map(|of| all.iter().copied().reduce(of).unwrap());
        let off = times[0].iter().zip(&few).filter_map(|(time, torque)| {
            let k = times[1].iter().position(|own| (own - time).abs() < 1e-6)?;
            Some((torque - all[k]).abs() / (high - low))
        });
        let off = off.fold(0.0, f64::max);
        let stated = bench.number("few", &format!("errors/joints/{}/torque/input", joint - 1));
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
            format!("{:.3},{:.3},{:.3}\n", 2.0 * u, 0.6 + 0.2 * ninth(u), y(k))
        };
        bench.write(name, &format!("time,x,y\n{}", (0..=400).map(row).collect::<String>()));
    };
    write("digit.csv", &|k| if k > 200 { 0.001 } else { 0.0 });
    write("short.csv", &|k| 0.001 * f64::from(k.clamp(200, 204) - 200));
    let linear = format!("-q --set analysis.second_order=\"none\" {WITHIN}");
    bench.done(&format!("solve arm.toml digit.csv {linear}"));
    let message = stderr(&bench.run(&format!("solve arm.toml short.csv {linear}")));
    assert!(!message.contains("panicked"), "{message}");
    assert!(message.contains("warning: ") || message.starts_with("error: "), "{message}");
}

#[test]
fn nodes_of_the_list_are_written_for_each_link_that_has_them_and_repeated() {
    let bench = bench();
    let two = "specs/arms/two_links.toml trajectories/arms/line_1.5s.csv";
    let elements = "--set links.0.segments.0.elements=4 --set links.1.segments.0.elements=2";
    let linear = "--set analysis.second_order=\"none\" -q";
    let run = |more: &str| bench.printed(&format!("solve {two} {linear} {elements} {more}"));
    run("--moments -o all");
    run("--moments --nodes 4,1 -o few");
    let heading = |file: &str| bench.read(file).lines().next().unwrap().to_owned();
    let names = "time_s,x1_4_m,y1_4_m,x1_1_m,y1_1_m,x2_1_m,y2_1_m";
    assert_eq!(heading("few/nodal_positions.csv"), names);
    assert_eq!(heading("few/bending_moments.csv"), "time_s,m1_4_n_m,m1_1_n_m,m2_1_n_m");
    for name in ["x1_4_m", "y2_1_m"] {
        let [few, all] =
            ["few", "all"].map(|run| column(&bench, &format!("{run}/nodal_positions.csv"), name));
        assert!(apart(&few, &all) < 1e-9, "{name}");
    }
    assert!(bench.read("few/nodes.csv") == bench.read("all/nodes.csv"), "it lists all nodes");
    bench.done(&format!("solve --repeat few {two}"));

    // 0.7 m is the tip of the longer link, and not on the other. The links have four elements and two before: 0.3 m
    // is a node of the shorter, and 0.5 m divides both.
    run("--moments --stations 0.7,0.3,0.5 -o at");
    assert_eq!(run("--stations 0.7,0.3 -o told"), "");
    let names = "time_s,m1_6_n_m,m1_2_n_m,m1_4_n_m,m2_1_n_m,m2_2_n_m";
    assert_eq!(heading("at/bending_moments.csv"), names);

    let told = bench.error(3, "report few");
    assert!(told.contains("must include x1_0_m") && told.contains("without --nodes"), "{told}");
}
