//! Links under gravity on the command line: what is written and told, angles, refusals, repetition, modes in a pose.

use super::{Bench, column, json_of, keys, stderr, stdout};

const STRIP: &str = "gravity = [0, '-981 cm/s^2']
start_angle = '-90 deg'
[[segments]]
length = 0.4
EI = 0.3
mass_per_length = 0.15
elements = 4
[hub]
inertia = 2e-3
[payload]
mass = 0.05
[damping]
model = 'rayleigh'
beta = 1e-3
";

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("strip.toml", STRIP);
    let arguments = ["septic", "--distance", "0.2", "--duration", "0.8", "--step", "0.002"];
    let arguments = [&["trajectory"], &arguments[..], &["-o", "move.csv"]].concat();
    bench.done(&arguments);
    bench
}

#[test]
fn the_torque_at_rest_holds_the_weight_and_angles_are_absolute() {
    let bench = bench();
    let options = ["--deflections", "--moments", "--report"];
    let text =
        stdout(&bench.silent(&[&["solve", "strip.toml", "move.csv"], &options[..]].concat()));
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    for begins in
        ["gravity  0, -9.81 m/s²; the link moves from -1.571 to -1.071 rad", "order    full: "]
    {
        assert!(text.lines().any(|line| line.starts_with(begins)), "{text}");
    }
    assert!(text.contains(" of the range\n") && !text.contains(" of the peak\n"), "{text}");
    // The link hangs, then stands off by half a radian: m g L/2 and the payload, but for the sag.
    let torque = column(&bench, "out/torque.csv", "torque_n_m");
    let held = 9.81 * (0.15 * 0.4 * 0.2 + 0.05 * 0.4) * 0.5_f64.sin();
    let last = torque[torque.len() - 1];
    assert!(torque[0].abs() < 1e-6 && (last / held - 1.0).abs() < 0.01, "{last} {held}");
    let hub = column(&bench, "out/hub_angle.csv", "hub_angle_rad");
    assert!((hub[0] + std::f64::consts::FRAC_PI_2).abs() < 1e-6, "{}", hub[0]);
    let tip = column(&bench, "out/tip.csv", "tip_displacement_m");
    let nodal = column(&bench, "out/nodal_displacements.csv", "v4_m");
    assert!(tip.iter().zip(&nodal).all(|(a, b)| (a - b).abs() < 1e-10));
    let summary = bench.json("out/summary.json");
    assert_eq!(summary["link"]["gravity"]["acceleration_m_s2"][1], -9.81);
    assert_eq!(summary["second_order"]["order"], "full");
    assert!(keys(&summary["errors"]["torque"]).contains(&"iteration"));
    bench.done(&["solve", "--repeat", "out"]);
    bench.done(&["report", "out"]);
    let page = bench.read("out/report.html");
    for words in ["−9.81 m/s² along y", "start angle", "second order contraction"] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn a_motion_as_angles_starts_at_its_own_angle() {
    let bench = bench();
    bench.done(&["solve", "strip.toml", "move.csv", "--digits", "full"]);
    let tip = bench.table("out/tip.csv");
    let turned = tip[0].1.iter().zip(&tip[1].1).filter(|(time, _)| (0.0..0.8001).contains(*time));
    let angle = |metres: &f64| metres / 0.4 - std::f64::consts::FRAC_PI_2;
    let rows = turned.map(|(time, metres)| format!("{time:.3},{:.15}\n", angle(metres)));
    bench.write("angle.csv", &format!("time,angle\n{}", rows.collect::<String>()));
    let without = STRIP.replace("start_angle = '-90 deg'\n", "");
    bench.write("anywhere.toml", &without);
    bench.done(&["solve", "anywhere.toml", "angle.csv", "-o", "angles"]);
    let first = |folder: &str| {
        bench.json(&format!("{folder}/summary.json"))["results"]["peak_torque_n_m"]
            .as_f64()
            .unwrap()
    };
    assert!((first("angles") / first("out") - 1.0).abs() < 1e-4);
    let displacement = column(&bench, "angles/tip.csv", "tip_displacement_m");
    assert!(displacement[0].abs() < 1e-6, "{}", displacement[0]);
    let message =
        stderr(&bench.ends(3, &["solve", "strip.toml", "angle.csv", "--set", "start_angle=0"]));
    assert!(message.starts_with("error: angle.csv:2: angle = -1.57"), "{message}");
    assert!(message.contains("must be start_angle of the link file, 0 rad"), "{message}");
    let swept = ["--vary", "start_angle=-1.570796,0.5", "-o", "swept.csv"];
    let swept = bench.run(&[&["sweep", "strip.toml", "angle.csv"], &swept[..]].concat());
    assert!(stderr(&swept).contains("1 of 2 cases failed"), "{}", stderr(&swept));
    assert!(bench.read("swept.csv").contains("must be start_angle of the link file, 0.5 rad"));
    bench.refuses(3, &["solve", "anywhere.toml", "move.csv"], "start_angle");
}

#[test]
fn what_has_no_weight_yet_warns() {
    let bench = bench();
    for command in [&["modes", "strip.toml"][..], &["frf", "strip.toml", "-o", "f.csv"]] {
        let output = bench.done(command);
        assert!(stderr(&output).contains("warning: gravity changes natural frequencies"));
    }
    let table = stdout(&bench.done(&["verify", "strip.toml", "move.csv"]));
    assert!(table.contains("with further iterations"), "{table}");
    assert!(!table.contains("tip deflection") && !table.contains("not made"), "{table}");
    for made in ["tip, the hub moved as solved", "torque that the moved hub takes"] {
        assert!(table.contains(made), "{table}");
    }
    let hysteretic = ["--set", "damping={model=\"hysteretic\", ratio=0.01}"];
    let verified = bench.run(&[&["verify", "strip.toml", "move.csv"][..], &hysteretic].concat());
    let table = stdout(&verified);
    for made in ["tip, hub moved, viscous damping", "torque of it, viscous damping"] {
        assert!(table.contains(made), "{table}");
    }
    assert!(verified.status.success() && !table.contains("not made"), "{table}");
    let first = ["verify", "strip.toml", "move.csv", "--set", "analysis.second_order=\"none\""];
    bench.refuses(4, &first, "tip, the hub moved as solved");
}

#[test]
fn the_torque_of_a_link_with_weight_is_played() {
    let bench = bench();
    bench.done(&["solve", "strip.toml", "move.csv", "--report"]);
    let simulate = ["simulate", "strip.toml", "out/torque.csv", "--target", "out/tip.csv"];
    let text = stdout(&bench.silent(&simulate));
    for begins in [
        "gravity  0, -9.81 m/s²; at first 0.000 N m hold the hub at -1.571 rad",
        "order    all terms: ",
    ] {
        assert!(text.lines().any(|line| line.starts_with(begins)), "{text}");
    }
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    let summary = bench.json("simulated/summary.json");
    let share = summary["tip_error"]["share"].as_f64().unwrap();
    assert!(share < 5e-6, "{share:e}");
    assert!(summary["elastica"]["angles"].as_u64().unwrap() > 4);
    assert!(summary["errors"]["tip"]["refinement"].as_f64().unwrap() < 1e-6);
    // Angles are absolute, and nodes move along their arcs, as those of solve.
    for (file, name) in [("hub_angle.csv", "hub_angle_rad"), ("nodal_displacements.csv", "v2_m")] {
        let [own, wanted] =
            ["simulated", "out"].map(|dir| column(&bench, &format!("{dir}/{file}"), name));
        let apart = own.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 2e-6, "{file}: {apart:e}");
    }
    let moved = ["simulate", "strip.toml", "out/hub_angle.csv", "--input", "hub-angle"];
    bench.silent(&[&moved[..], &["--target", "out/tip.csv"]].concat());
    assert!(bench.json("simulated/summary.json")["tip_error"]["share"].as_f64().unwrap() < 5e-6);
    bench.done(&["report", "simulated"]);
    // Hub angles are absolute, and displacements are not: the page counts both from the same direction.
    for dir in ["out", "simulated"] {
        let page = bench.read(&format!("{dir}/report.html"));
        let (_, rest) = page.split_once("displacement; it reaches ").unwrap();
        let largest: f64 = rest.split_once(" m. Colours").unwrap().0.parse().unwrap();
        let summary = bench.json(&format!("{dir}/summary.json"));
        let peak = summary["results"]["peak_deflection_m"].as_f64().unwrap();
        assert!((largest / peak - 1.0).abs() < 0.03, "{dir}: {largest} m, {peak} m");
    }
    // Elsewhere the same torque holds nothing.
    let level = bench.run(&[&simulate[..], &["--set", "start_angle=0"]].concat());
    assert!(stderr(&level).contains("hold the link where it starts"), "{}", stderr(&level));
    let nowhere = STRIP.replace("start_angle = '-90 deg'\n", "");
    bench.write("nowhere.toml", &nowhere);
    bench.refuses_first(
        3,
        &["simulate", "nowhere.toml", "out/torque.csv"],
        "error: start_angle is missing",
    );
    let tip = "time,acceleration\n0,0\n0.1,1\n0.2,0\n0.3,-1\n0.4,0\n";
    bench.write("tip.csv", tip);
    bench.refuses(3, &["solve", "nowhere.toml", "tip.csv"], "start_angle is missing");
}

#[test]
fn modes_of_a_direction_are_told_with_the_swing_first() {
    let bench = bench();
    let lines = |angle: &str| {
        let output = bench.done(&["modes", "strip.toml", "--count", "2", "--at", angle]);
        let falls = stderr(&output).starts_with("warning: the link falls from this pose");
        assert!(falls || stderr(&output).is_empty(), "{}", stderr(&output));
        assert_eq!(falls, angle == "1.5708", "{}", stderr(&output));
        let text = stdout(&output);
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
        text.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let hanging = lines("-90 deg");
    assert_eq!(hanging[1], "at -1.571 rad gravity pulls by 9.810 m/s² outward along the link");
    let swing: f64 = hanging[4].split_whitespace().nth(1).unwrap().parse().unwrap();
    // Of a rigid link: g S/I.
    let (moment, inertia) = (0.15 * 0.08 + 0.05 * 0.4, 2e-3 + 0.15 * 0.064 / 3.0 + 0.05 * 0.16);
    assert!((swing / f64::sqrt(9.81 * moment / inertia) - 1.0).abs() < 0.02, "{swing}");
    assert_eq!(hanging[7], "hub held");
    assert!(lines("1.5708")[4].starts_with("0      not stable: it leaves the pose as e^(t/0.2"));
    assert_eq!(lines("0")[4], "0      neutral: the link stays where it is turned");
    bench.ends(4, &["modes", "strip.toml", "--at", "90 deg", "--deny-warnings"]);
    let json = bench.run(&["modes", "strip.toml", "--at", "90 deg", "--json"]);
    let json = json_of(&json);
    assert!(json["free"]["frequency_hz"][0].is_null());
    assert!((json["free"]["growth_per_s"][0].as_f64().unwrap() - swing).abs() < 0.2);
    assert!(json["held"]["growth_per_s"][0].is_null());
}

/// Numbers of a table by name; NaN in an empty field.
fn table(bench: &Bench, name: &str) -> impl Fn(&str) -> Vec<f64> + use<> {
    let text = bench.read(name);
    move |column| {
        let at = text.lines().next().unwrap().split(',').position(|own| own == column);
        let at = at.unwrap_or_else(|| panic!("{column} of {text}"));
        let fields = text.lines().skip(1).map(|row| row.split(',').nth(at).unwrap());
        fields.map(|field| field.parse().unwrap_or(f64::NAN)).collect()
    }
}

/// A strip that hardly bends is a pendulum: in its swing it turns by 1/√I, mass-normalised.
#[test]
fn modes_of_a_direction_are_tabled_as_those_of_an_arm() {
    let bench = bench();
    let stiff = ["modes", "strip.toml", "--count", "2", "--set", "segments.*.EI*=1e4"];
    let inertia = 2e-3 + 0.15 * 0.064 / 3.0 + 0.05 * 0.16;
    let swing = f64::sqrt(9.81 * (0.15 * 0.08 + 0.05 * 0.4) / inertia);
    bench.done(&[&stiff[..], &["--set", "gravity=[0, 0]", "-o", "level"]].concat());
    for (angle, [x, y]) in
        [("-90 deg", [0.0_f64, -1.0]), ("90 deg", [0.0, 1.0]), ("0.7", [0.764_842, 0.644_218])]
    {
        let output = bench.done(&[&stiff[..], &["--at", angle, "-o", "pose", "--json"]].concat());
        let json = json_of(&output);
        for (file, list) in [("pose/modes.csv", "free"), ("pose/held_modes.csv", "held")] {
            let names = "mode,omega_rad_s,frequency_hz,period_s,growth_per_s,mesh_error,joint1\n";
            assert!(bench.read(file).starts_with(names), "{}", bench.read(file));
            for column in ["frequency_hz", "growth_per_s", "mesh_error"] {
                let exact = json[list][column].as_array().unwrap();
                let found = table(&bench, file)(column);
                assert_eq!(found.len(), exact.len(), "{file} {column}");
                for (found, exact) in found.into_iter().zip(exact) {
                    let off = found - exact.as_f64().unwrap_or(f64::NAN);
                    let is_right = off.abs() <= 1e-9 * found.abs();
                    let is_right = is_right || (found.is_nan() && exact.is_null());
                    assert!(is_right, "{file} {column}: {found} {exact}");
                }
            }
        }
        // Gravity outward along the link drives the pendulum.
        let square = -swing * swing * y;
        let modes = table(&bench, "pose/modes.csv");
        let rate = if square > 0.0 { modes("omega_rad_s")[0] } else { modes("growth_per_s")[0] };
        assert!((rate * rate / square.abs() - 1.0).abs() < 1e-4, "{angle}: {rate}");
        assert_eq!(
            (&modes("joint1")[..], &modes("mode")[..]),
            (&[1.0; 3][..], &[1.0, 2.0, 3.0][..])
        );
        let shapes = table(&bench, "pose/mode_shapes.csv");
        for (k, at_m) in shapes("x_m").into_iter().enumerate() {
            let turned = at_m / inertia.sqrt();
            for (name, exact) in [
                ("rest_x_m", at_m * x),
                ("rest_y_m", at_m * y),
                ("mode_1_x", -turned * y),
                ("mode_1_y", turned * x),
            ] {
                let found = shapes(name)[k];
                assert!((found - exact).abs() < 1e-4, "{angle} {name}: {found} {exact}");
            }
        }
        // Zeros are those without gravity.
        let [pose, level] =
            ["pose", "level"].map(|folder| table(&bench, &format!("{folder}/zeros.csv")));
        assert_eq!(pose("link"), [1.0; 2]);
        assert_eq!(pose("zero_per_s"), level("zero_per_s"));
    }
    assert_eq!(bench.names("pose"), bench.names("level"));
}

/// Without weight a link answers in any direction as it does without one; hanging, it has its poles at its frequencies.
#[test]
fn the_response_in_a_direction_is_that_without_gravity_and_has_the_poles_of_its_modes() {
    let bench = bench();
    let band = ["--from", "0.5", "--to", "80", "--points", "30"];
    let run = |arguments: &[&str], file: &str| {
        bench.done(&[&["frf", "strip.toml"], arguments, &["-o", file]].concat());
        table(&bench, file)
    };
    let weightless =
        [&band[..], &["--set", "gravity=[0, 0]", "--set", "mesh.elements='auto'"]].concat();
    let weightless = [&weightless[..], &["--set", "hub.viscous_friction=0.01"]].concat();
    let level = run(&weightless, "level.csv");
    let pose = run(&[&weightless[..], &["--at", "30 deg"]].concat(), "pose.csv");
    assert_eq!(pose("frequency_hz"), level("frequency_hz"));
    let complex = |table: &dyn Fn(&str) -> Vec<f64>, name: &str| -> Vec<[f64; 2]> {
        let [re, im] = ["real", "imag"].map(|part| table(&format!("{name}_{part}")));
        re.into_iter().zip(im).map(|(re, im)| [re, im]).collect()
    };
    let tip = complex(&level, "tip_displacement_per_torque_1_n");
    let hub = complex(&level, "hub_angle_per_tip_displacement_rad_m");
    let [x, y] = ["x", "y"].map(|axis| complex(&pose, &format!("tip_{axis}_per_torque1_1_n")));
    let joint = complex(&pose, "joint1_per_torque1_rad_n_m");
    let (sin, cos) = (0.5, f64::sqrt(0.75));
    for k in 0..30 {
        let across = [0, 1].map(|part| cos * y[k][part] - sin * x[k][part]);
        let along = [0, 1].map(|part| cos * x[k][part] + sin * y[k][part]);
        let turned = [
            tip[k][0] * hub[k][0] - tip[k][1] * hub[k][1],
            tip[k][0] * hub[k][1] + tip[k][1] * hub[k][0],
        ];
        let size = |[re, im]: [f64; 2]| (re * re + im * im).sqrt();
        let off = |a: [f64; 2], b: [f64; 2]| size([a[0] - b[0], a[1] - b[1]]) / size(b);
        assert!(off(across, tip[k]) < 1e-4, "{k}: {across:?} {:?}", tip[k]);
        assert!(off(joint[k], turned) < 1e-4, "{k}: {:?} {turned:?}", joint[k]);
        assert!(size(along) < 1e-9 * size(across), "{k}: {along:?}");
    }

    let undamped =
        ["--set", "damping={ model = 'none' }", "--set", "mesh.elements='auto'", "--at", "-90 deg"];
    let modes =
        bench.run(&[&["modes", "strip.toml", "--json", "--count", "2"], &undamped[..]].concat());
    let json = json_of(&modes);
    for hertz in json["free"]["frequency_hz"].as_array().unwrap() {
        let hertz = hertz.as_f64().unwrap();
        let [from, to] = [0.9999, 1.0001].map(|factor| (factor * hertz).to_string());
        let around = ["--points", "2", "--from", &from, "--to", &to];
        let found = run(&[&undamped[..], &around].concat(), "pole.csv");
        let turned = found("joint1_per_torque1_rad_n_m_real");
        // The stiffness of the mode changes its sign there.
        assert!(turned[0] > 0.0 && turned[1] < 0.0, "{hertz} Hz: {turned:?}");
    }
    let up =
        bench.ends(4, &["frf", "strip.toml", "--at", "90 deg", "--points", "2", "--deny-warnings"]);
    let words = "warning: the link falls from this pose if its hub is free: it responds so only under control";
    assert!(stderr(&up).contains(words), "{}", stderr(&up));
}

#[test]
fn a_run_goes_on_from_the_state_that_another_left() {
    let bench = bench();
    bench.write(
        "level.toml",
        &STRIP.replace("gravity", "# gravity").replace("start_angle", "# start_angle"),
    );
    let rows = |from: i32, until: i32| {
        let row =
            |k: i32| format!("{},{}\n", 0.01 * f64::from(k), f64::from((k - 40).pow(2)) * 1e-4);
        format!("time,torque\n{}", (from..=until).map(row).collect::<String>())
    };
    for (name, from, until) in [("whole", 0, 100), ("first", 0, 60), ("second", 60, 100)] {
        bench.write(&format!("{name}.csv"), &rows(from, until));
    }
    for link in ["strip.toml", "level.toml"] {
        let played = |torque: &str, more: &[&str]| {
            let arguments = ["simulate", link, torque, "--hold", "linear", "--digits", "12"];
            bench.run(&[&arguments[..], more].concat())
        };
        for run in [
            played("whole.csv", &["-o", "whole"]),
            played("first.csv", &["-o", "first", "--save-state", "state.json"]),
            played("second.csv", &["-o", "second", "--state", "state.json"]),
        ] {
            assert!(run.status.success(), "{}", stderr(&run));
        }
        let [whole, second] = ["whole", "second"]
            .map(|dir| column(&bench, &format!("{dir}/tip.csv"), "tip_displacement_m"));
        let apart = whole[60..].iter().zip(&second).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-9, "{link}");
        let summary = bench.json("second/summary.json");
        assert_eq!(summary["inputs"]["state"]["name"], "state.json");
        let state = bench.json("state.json");
        assert!((state["state"]["time_s"].as_f64().unwrap() - 0.6).abs() < 1e-12);
    }
    // That of the level strip is linear.
    let other = ["simulate", "strip.toml", "second.csv", "--state", "state.json"];
    let message = stderr(&bench.ends(3, &other));
    let must = "error: state.json: the state is of a linear link, but must be one at large angles";
    assert!(message.starts_with(must), "{message}");
    bench.write("state.json", "{\"command\": \"fit\"}");
    let message = stderr(&bench.run(&other));
    assert!(
        message.starts_with("error: state.json: command = \"fit\", but must be \"state\""),
        "{message}"
    );
    bench.write("state.json", "time,torque\n");
    let message = stderr(&bench.run(&other));
    assert!(message.contains("must be what --save-state"), "{message}");
    let same = ["--save-state", "second.csv"];
    let message = stderr(&bench.run(&[&other[..3], &same].concat()));
    assert!(message.contains("--save-state"), "{message}");
    assert!(bench.read("second.csv").starts_with("time,torque"), "an input is never replaced");
}
