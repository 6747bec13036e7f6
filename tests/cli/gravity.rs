//! Links under gravity on the command line: what is written and told, angles, refusals, repetition, modes in a pose.

use std::f64::consts::FRAC_PI_2;

use super::{Bench, apart, column, keys, number, stderr, stdout, with};

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
    bench.done("trajectory septic --distance 0.2 --duration 0.8 --step 0.002 -o move.csv");
    bench
}

#[test]
fn the_torque_at_rest_holds_the_weight_and_angles_are_absolute() {
    let bench = bench();
    let text = bench.silent("solve strip.toml move.csv --deflections --moments --report");
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
    assert!((hub[0] + FRAC_PI_2).abs() < 1e-6, "{}", hub[0]);
    let tip = column(&bench, "out/tip.csv", "tip_displacement_m");
    assert!(apart(&tip, &column(&bench, "out/nodal_displacements.csv", "v4_m")) < 1e-10);
    let summary = bench.json("out/summary.json");
    assert_eq!(summary["link"]["gravity"]["acceleration_m_s2"][1], -9.81);
    assert_eq!(summary["second_order"]["order"], "full");
    assert!(keys(&summary["errors"]["torque"]).contains(&"iteration"));
    bench.done("solve --repeat out");
    bench.done("report out");
    let page = bench.read("out/report.html");
    for words in ["−9.81 m/s² along y", "start angle", "second order contraction"] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn a_motion_as_angles_starts_at_its_own_angle() {
    let bench = bench();
    bench.done("solve strip.toml move.csv --digits full");
    let [times, tip] =
        ["time_s", "tip_displacement_m"].map(|name| column(&bench, "out/tip.csv", name));
    let turned = times.iter().zip(&tip).filter(|(time, _)| (0.0..0.8001).contains(*time));
    let rows = turned.map(|(time, m)| format!("{time:.3},{:.15}\n", m / 0.4 - FRAC_PI_2));
    bench.write("angle.csv", &format!("time,angle\n{}", rows.collect::<String>()));
    bench.write("anywhere.toml", &STRIP.replace("start_angle = '-90 deg'\n", ""));
    bench.done("solve anywhere.toml angle.csv -o angles");
    let [angles, out] = ["angles", "out"].map(|run| bench.number(run, "results/peak_torque_n_m"));
    assert!((angles / out - 1.0).abs() < 1e-4, "{angles} {out}");
    let displacement = column(&bench, "angles/tip.csv", "tip_displacement_m");
    assert!(displacement[0].abs() < 1e-6, "{}", displacement[0]);
    let message = bench.error(3, "solve strip.toml angle.csv --set start_angle=0");
    assert!(message.starts_with("error: angle.csv:2: angle = -1.57"), "{message}");
    assert!(message.contains("must be start_angle of the link file, 0 rad"), "{message}");
    let swept = bench.run("sweep strip.toml angle.csv --vary start_angle=-1.570796,0.5 -o s.csv");
    assert!(stderr(&swept).contains("1 of 2 cases failed"), "{}", stderr(&swept));
    assert!(bench.read("s.csv").contains("must be start_angle of the link file, 0.5 rad"));
    bench.refuses(3, "solve anywhere.toml move.csv", "start_angle");
}

#[test]
fn what_has_no_weight_yet_warns() {
    let bench = bench();
    for command in ["modes strip.toml", "frf strip.toml -o f.csv"] {
        let told = bench.told(command);
        assert!(told.contains("warning: gravity changes natural frequencies"), "{told}");
    }
    let verify = "verify strip.toml move.csv";
    let table = bench.printed(verify);
    assert!(!table.contains("tip deflection"), "{table}");
    let viscous =
        bench.printed(&format!("{verify} --set damping={{model=\"hysteretic\",ratio=0.01}}"));
    for (table, made) in [
        (&table, ["with further iterations", "tip, the hub moved as solved"]),
        (&table, ["torque that the moved hub takes", ""]),
        (&viscous, ["tip, hub moved, viscous damping", "torque of it, viscous damping"]),
    ] {
        assert!(made.iter().all(|made| table.contains(made)), "{table}");
        assert!(!table.contains("not made"), "{table}");
    }
    let first = format!("{verify} --set analysis.second_order=\"none\"");
    bench.refuses(4, &first, "tip, the hub moved as solved");
}

#[test]
fn the_torque_of_a_link_with_weight_is_played() {
    let bench = bench();
    bench.done("solve strip.toml move.csv --report");
    let simulate = "simulate strip.toml out/torque.csv --target out/tip.csv";
    let text = bench.silent(simulate);
    for begins in [
        "gravity  0, -9.81 m/s²; at first 0.000 N m hold the hub at -1.571 rad",
        "order    all terms: ",
    ] {
        assert!(text.lines().any(|line| line.starts_with(begins)), "{text}");
    }
    let summary = bench.json("simulated/summary.json");
    assert!(number(&summary, "tip_error/share") < 5e-6, "{}", summary["tip_error"]);
    assert!(summary["elastica"]["angles"].as_u64().unwrap() > 4);
    assert!(number(&summary, "errors/tip/refinement") < 1e-6);
    // Angles are absolute, and nodes move along their arcs, as those of solve.
    for (file, name) in [("hub_angle.csv", "hub_angle_rad"), ("nodal_displacements.csv", "v2_m")] {
        let [own, wanted] =
            ["simulated", "out"].map(|dir| column(&bench, &format!("{dir}/{file}"), name));
        assert!(apart(&own, &wanted) < 2e-6, "{file}");
    }
    let moved = "simulate strip.toml out/hub_angle.csv --input hub-angle --target out/tip.csv";
    bench.silent(moved);
    assert!(bench.number("simulated", "tip_error/share") < 5e-6);
    bench.done("report simulated");
    // Hub angles are absolute, and displacements are not: the page counts both from the same direction.
    for dir in ["out", "simulated"] {
        let page = bench.read(&format!("{dir}/report.html"));
        let (_, rest) = page.split_once("displacement; it reaches ").unwrap();
        let largest: f64 = rest.split_once(" m. Colours").unwrap().0.parse().unwrap();
        let peak = bench.number(dir, "results/peak_deflection_m");
        assert!((largest / peak - 1.0).abs() < 0.03, "{dir}: {largest} m, {peak} m");
    }
    // Elsewhere the same torque holds nothing.
    let level = stderr(&bench.run(&format!("{simulate} --set start_angle=0")));
    assert!(level.contains("hold the link where it starts"), "{level}");
    bench.write("nowhere.toml", &STRIP.replace("start_angle = '-90 deg'\n", ""));
    bench.write("tip.csv", "time,acceleration\n0,0\n0.1,1\n0.2,0\n0.3,-1\n0.4,0\n");
    let missing = "error: start_angle is missing";
    bench.refuses_first(3, "simulate nowhere.toml out/torque.csv", missing);
    bench.refuses(3, "solve nowhere.toml tip.csv", "start_angle is missing");
}

#[test]
fn modes_of_a_direction_are_told_with_the_swing_first() {
    let bench = bench();
    let lines = |angle: &str| {
        let output = bench.done(&["modes", "strip.toml", "--count", "2", "--at", angle]);
        let falls = stderr(&output).starts_with("warning: the link falls from this pose");
        assert!(falls || stderr(&output).is_empty(), "{}", stderr(&output));
        assert_eq!(falls, angle == "1.5708", "{}", stderr(&output));
        stdout(&output).lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let hanging = lines("-90 deg");
    assert_eq!(hanging[1], "at -1.571 rad gravity pulls by 9.810 m/s² outward along the link");
    let swing: f64 = hanging[4].split_whitespace().nth(1).unwrap().parse().unwrap();
    // Of a rigid link: g S/I.
    assert!((swing / pendulum_rad_s() - 1.0).abs() < 0.02, "{swing}");
    assert_eq!(hanging[7], "hub held");
    assert!(lines("1.5708")[4].starts_with("0      not stable: it leaves the pose as e^(t/0.2"));
    assert_eq!(lines("0")[4], "0      neutral: the link stays where it is turned");
    bench.ends(4, &["modes", "strip.toml", "--at", "90 deg", "--deny-warnings"]);
    let json = bench.reply(&["modes", "strip.toml", "--at", "90 deg", "--json"]);
    assert!(json["free"]["frequency_hz"][0].is_null());
    assert!((number(&json, "free/growth_per_s/0") - swing).abs() < 0.2);
    assert!(json["held"]["growth_per_s"][0].is_null());
}

/// Inertia of the rigid strip about its hub in kg m², and the rate of its swing, √(g S/I).
const INERTIA_KG_M2: f64 = 2e-3 + 0.15 * 0.064 / 3.0 + 0.05 * 0.16;

fn pendulum_rad_s() -> f64 {
    (9.81 * (0.15 * 0.08 + 0.05 * 0.4) / INERTIA_KG_M2).sqrt()
}

/// A strip that hardly bends is a pendulum: in its swing it turns by 1/√I, mass-normalised.
#[test]
fn modes_of_a_direction_are_tabled_as_those_of_an_arm() {
    let bench = bench();
    let stiff = "modes strip.toml --count 2 --set segments.*.EI*=1e4";
    bench.done(&format!("{stiff} --set gravity=[0,0] -o level"));
    for (angle, [x, y]) in
        [("-90 deg", [0.0_f64, -1.0]), ("90 deg", [0.0, 1.0]), ("0.7", [0.764_842, 0.644_218])]
    {
        let json = bench.reply(&with(stiff, &["--at", angle, "-o", "pose", "--json"]));
        for (file, list) in [("pose/modes.csv", "free"), ("pose/held_modes.csv", "held")] {
            let names = "mode,omega_rad_s,frequency_hz,period_s,growth_per_s,mesh_error,joint1\n";
            assert!(bench.read(file).starts_with(names), "{}", bench.read(file));
            for column in ["frequency_hz", "growth_per_s", "mesh_error"] {
                let exact = json[list][column].as_array().unwrap();
                let found = bench.numbers(file, column);
                assert_eq!(found.len(), exact.len(), "{file} {column}");
                for (found, exact) in found.into_iter().zip(exact) {
                    let is_none = found.is_nan() && exact.is_null();
                    let off = (found - exact.as_f64().unwrap_or(f64::NAN)).abs();
                    assert!(
                        is_none || off <= 1e-9 * found.abs(),
                        "{file} {column}: {found} {exact}"
                    );
                }
            }
        }
        // Gravity outward along the link drives the pendulum.
        let square = -pendulum_rad_s().powi(2) * y;
        let modes = |column: &str| bench.numbers("pose/modes.csv", column);
        let rate = modes(if square > 0.0 { "omega_rad_s" } else { "growth_per_s" })[0];
        assert!((rate * rate / square.abs() - 1.0).abs() < 1e-4, "{angle}: {rate}");
        assert_eq!((modes("joint1"), modes("mode")), (vec![1.0; 3], vec![1.0, 2.0, 3.0]));
        for (name, exact) in [("rest_x_m", x), ("rest_y_m", y), ("mode_1_x", -y), ("mode_1_y", x)] {
            let turns = if name.starts_with("mode") { 1.0 / INERTIA_KG_M2.sqrt() } else { 1.0 };
            let at_m = bench.numbers("pose/mode_shapes.csv", "x_m");
            let exact: Vec<f64> = at_m.iter().map(|at_m| turns * at_m * exact).collect();
            let off = apart(&bench.numbers("pose/mode_shapes.csv", name), &exact);
            assert!(off < 1e-4, "{angle} {name}: {off:e}");
        }
        // Zeros are those without gravity.
        assert_eq!(bench.numbers("pose/zeros.csv", "link"), [1.0; 2]);
        let [pose, level] =
            ["pose", "level"].map(|dir| bench.numbers(&format!("{dir}/zeros.csv"), "zero_per_s"));
        assert_eq!(pose, level);
    }
    assert_eq!(bench.names("pose"), bench.names("level"));
}

/// Without weight a link answers in any direction as it does without one; hanging, it has its poles at its frequencies.
#[test]
fn the_response_in_a_direction_is_that_without_gravity_and_has_the_poles_of_its_modes() {
    let bench = bench();
    let run = |arguments: &[&str], file: &str| {
        bench.done(&with("frf strip.toml", &[arguments, &["-o", file]].concat()));
    };
    let band = "--from 0.5 --to 80 --points 30 --set gravity=[0,0] --set mesh.elements='auto'";
    let weightless: Vec<&str> =
        band.split(' ').chain(["--set", "hub.viscous_friction=0.01"]).collect();
    run(&weightless, "level.csv");
    run(&[&weightless[..], &["--at", "30 deg"]].concat(), "pose.csv");
    let complex = |file: &str, name: &str| -> Vec<[f64; 2]> {
        let [re, im] = ["real", "imag"].map(|part| bench.numbers(file, &format!("{name}_{part}")));
        re.into_iter().zip(im).map(|(re, im)| [re, im]).collect()
    };
    let hertz = ["pose.csv", "level.csv"].map(|file| bench.numbers(file, "frequency_hz"));
    assert_eq!(hertz[0], hertz[1]);
    let tip = complex("level.csv", "tip_displacement_per_torque_1_n");
    let hub = complex("level.csv", "hub_angle_per_tip_displacement_rad_m");
    let [x, y] = ["x", "y"].map(|axis| complex("pose.csv", &format!("tip_{axis}_per_torque1_1_n")));
    let joint = complex("pose.csv", "joint1_per_torque1_rad_n_m");
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

    let undamped = "--set damping={model='none'} --set mesh.elements='auto'";
    let undamped: Vec<&str> = undamped.split(' ').chain(["--at", "-90 deg"]).collect();
    let json = bench.reply(&with("modes strip.toml --json --count 2", &undamped));
    for hertz in json["free"]["frequency_hz"].as_array().unwrap() {
        let hertz = hertz.as_f64().unwrap();
        let [from, to] = [0.9999, 1.0001].map(|factor| (factor * hertz).to_string());
        let around = ["--points", "2", "--from", &from, "--to", &to];
        run(&[&undamped[..], &around].concat(), "pole.csv");
        let turned = bench.numbers("pole.csv", "joint1_per_torque1_rad_n_m_real");
        // The stiffness of the mode changes its sign there.
        assert!(turned[0] > 0.0 && turned[1] < 0.0, "{hertz} Hz: {turned:?}");
    }
    let up = ["frf", "strip.toml", "--at", "90 deg", "--points", "2", "--deny-warnings"];
    let words = "warning: the link falls from this pose if its hub is free: it responds so only under control";
    bench.refuses(4, &up, words);
}

#[test]
fn a_run_goes_on_from_the_state_that_another_left() {
    let bench = bench();
    let level = STRIP.replace("gravity", "# gravity").replace("start_angle", "# start_angle");
    bench.write("level.toml", &level);
    for (name, from, until) in [("whole", 0, 100), ("first", 0, 60), ("second", 60, 100)] {
        bench.sampled(&format!("{name}.csv"), "time,torque", from..=until, |k| {
            [0.01 * k, (k - 40.0).powi(2) * 1e-4]
        });
    }
    for link in ["strip.toml", "level.toml"] {
        for (run, state) in
            [("whole", ""), ("first", "--save-state state.json"), ("second", "--state state.json")]
        {
            let play = format!("simulate {link} {run}.csv --hold linear --digits 12 -o {run}");
            bench.done(&format!("{play} {state}"));
        }
        let [whole, second] = ["whole", "second"]
            .map(|dir| column(&bench, &format!("{dir}/tip.csv"), "tip_displacement_m"));
        assert!(apart(&whole[60..], &second[..whole.len() - 60]) < 1e-9, "{link}");
        let summary = bench.json("second/summary.json");
        assert_eq!(summary["inputs"]["state"]["name"], "state.json");
        let time_s = number(&bench.json("state.json"), "state/time_s");
        assert!((time_s - 0.6).abs() < 1e-12);
    }
    // That of the level strip is linear.
    let other = "simulate strip.toml second.csv --state state.json";
    let must = "error: state.json: the state is of a linear link, but must be one at large angles";
    bench.refuses_first(3, other, must);
    bench.write("state.json", "time,torque\n");
    bench.refuses(3, other, "must be what --save-state");
    let over = "simulate strip.toml second.csv --save-state second.csv";
    assert!(stderr(&bench.run(over)).contains("--save-state"));
    assert!(bench.read("second.csv").starts_with("time,torque"), "an input is never replaced");
}
