//! The motor's side of the drive: its numbers in every result, and its limits.

use flexlink::text::significant;

use super::{Bench, LINK, MOTION, column, ended, keys, stderr, stdout, succeeded};

/// A rotor of 2 kg cm² behind a gear of 100, on the spring of a joint.
const DRIVE: &str = "--set drive={joint_stiffness=100.0,rotor_inertia=2e-4,gear_ratio=100.0}";

const KEYS: [&str; 5] = [
    "peak_motor_torque_n_m",
    "peak_motor_torque_time_s",
    "rms_motor_torque_n_m",
    "peak_motor_rate_rad_s",
    "peak_motor_power_w",
];

/// Largest absolute value, and its place.
fn peak(samples: &[f64]) -> (f64, usize) {
    let larger = |best: (f64, usize), (k, sample): (usize, &f64)| {
        if sample.abs() > best.0 { (sample.abs(), k) } else { best }
    };
    samples.iter().enumerate().fold((0.0, 0), larger)
}

#[test]
fn the_motors_numbers_are_those_of_its_table() {
    let bench = Bench::new();
    let text = stdout(&bench.solve(&format!("{DRIVE} --report")));
    let found = KEYS.map(|key| bench.number("out", &format!("results/{key}")));
    let of = |name: &str| column(&bench, "out/motor.csv", name);
    let torque = of("motor_torque_n_m");
    let (highest, at) = peak(&torque);
    let acts = |t: &f64| t.abs() > 0.02 * highest;
    let [first, last] = [torque.iter().position(acts), torque.iter().rposition(acts)];
    let acting = &torque[first.unwrap()..=last.unwrap()];
    let rms = (acting.iter().map(|t| t * t).sum::<f64>() / acting.len() as f64).sqrt();
    let [rate, power] = ["motor_rate_rad_s", "motor_power_w"].map(|name| peak(&of(name)).0);
    let expected = [highest, of("time_s")[at], rms, rate, power];
    for ((found, expected), key) in found.iter().zip(expected).zip(KEYS) {
        // Peaks are those between the rows, too; the time of one is within half a step.
        let is_time = key.ends_with("time_s");
        let above = if is_time { (found - expected).abs() } else { found / expected - 1.0 };
        let allowed = if is_time || key.contains("power") { 1e-3 } else { 1e-5 };
        assert!((-1e-9..allowed).contains(&above), "{key}: {found} is not {expected}");
    }
    let line = text.lines().find(|line| line.starts_with("motor ")).unwrap();
    let after = text.lines().position(|line| line.starts_with("hub ")).unwrap() + 1;
    assert_eq!(text.lines().nth(after), Some(line));
    let numbers: Vec<f64> = line.split([' ', ',', ';']).filter_map(|w| w.parse().ok()).collect();
    for (shown, found) in numbers.iter().zip(found) {
        assert!((shown / found - 1.0).abs() < 6e-3, "{line}: {found}");
    }
    assert_eq!(numbers.len(), found.len(), "{line}");
    let page = bench.read("out/report.html");
    for words in ["peak motor torque", "rms motor torque", "peak motor rate", "peak motor power"] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn without_a_drive_no_motor_is_told_of() {
    let bench = Bench::new();
    let text = stdout(&bench.solve(""));
    let summary = bench.json("out/summary.json");
    assert!(keys(&summary["results"]).iter().all(|key| !key.contains("motor")));
    assert!(!text.contains("motor"), "{text}");
    bench.done(&format!("sweep {LINK} {MOTION} --vary hub.inertia=0.1"));
    assert!(!bench.read("sweep.csv").contains("motor"));
}

#[test]
fn a_sweep_over_gears_tells_the_motors_numbers_and_its_page_shows_them() {
    let bench = Bench::new();
    bench.done(&format!("sweep {LINK} {MOTION} {DRIVE} --vary drive.gear_ratio=10,50"));
    let header = bench.rows("sweep.csv").swap_remove(0);
    let told: Vec<&String> = header.iter().filter(|name| name.contains("motor")).collect();
    assert_eq!(told, [KEYS[0], KEYS[2], KEYS[3], KEYS[4]]);
    for (row, gear) in bench.cells("sweep.csv", "drive.gear_ratio").iter().enumerate() {
        bench.solve(&format!("{DRIVE} --set drive.gear_ratio={gear}"));
        for name in &told {
            let found = bench.numbers("sweep.csv", name)[row];
            let expected = bench.number("out", &format!("results/{name}"));
            assert!((found / expected - 1.0).abs() < 1e-11, "{name}: {found} is not {expected}");
        }
    }
    bench.done("report sweep.csv -o page.html");
    assert!(bench.read("page.html").contains("Peak torque of the motor"));
}

#[test]
fn limits_of_the_motor_are_held_beside_the_hubs() {
    let bench = Bench::new();
    let strict = |key: &str, limit: f64| {
        let limits = format!("--set limits={{{key}={limit:?}}}");
        bench.run(&format!("solve {LINK} {MOTION} {DRIVE} {limits} --strict -q"))
    };
    bench.solve(DRIVE);
    let of = |key: &str| bench.number("out", &format!("results/{key}"));
    let [torque, _, rms, rate, power] = KEYS.map(of);
    // The torque of the limit without a name is the hub's, 100 times as much as the motor's.
    let hub = of("peak_torque_n_m");
    for (key, found) in [
        ("motor_torque", torque),
        ("motor_rms_torque", rms),
        ("motor_rate", rate),
        ("motor_power", power),
    ] {
        succeeded(strict(key, 1.01 * found));
        let error = stderr(&ended(4, strict(key, 0.99 * found)));
        assert!(error.contains(&format!("error: limits.{key} = ")), "{error}");
        assert!(error.contains(&format!("is exceeded: {} ", significant(found, 5))), "{error}");
    }
    succeeded(strict("torque", 1.01 * hub));
}

/// A motor whose losses, current and voltage are known, on a rigid joint.
const KNOWN: &str = "--set drive={rotor_inertia=2e-4,gear_ratio=20.0,efficiency=0.8,\
                     coulomb_friction=0.05,torque_constant=0.05,resistance=1.2}";

const PLAYED: [&str; 5] = [
    "peak_motor_torque_n_m",
    "peak_motor_rate_rad_s",
    "peak_motor_power_w",
    "peak_motor_current_a",
    "peak_motor_voltage_v",
];

#[test]
fn a_play_of_the_torque_needs_the_motor_that_solve_tells() {
    let bench = Bench::new();
    // Its damping is the same in frequency and in time.
    let known = format!("{KNOWN} --set damping={{model=\"rayleigh\",beta=1e-4}}");
    bench.solve(&known);
    bench.done(&format!("simulate {LINK} out/torque.csv {known} -o played"));
    for key in PLAYED {
        let [known, found] =
            ["out", "played"].map(|folder| bench.number(folder, &format!("results/{key}")));
        assert!((found / known - 1.0).abs() < 1e-3, "{key}: {found} is not {known}");
    }
    // No simulation moves the rotor of an elastic joint.
    bench.solve(DRIVE);
    bench.done(&format!("simulate {LINK} out/torque.csv {DRIVE} -o played"));
    let results = &bench.json("played/summary.json")["results"];
    assert!(keys(results).iter().all(|key| !key.contains("motor")));
}

#[test]
fn robust_counts_the_plants_whose_motor_is_over_its_limit() {
    let bench = Bench::new();
    bench.solve(KNOWN);
    let current_a = |mass: f64| {
        let set = format!("{KNOWN} --set payload.mass={mass:?}");
        bench.done(&format!("simulate {LINK} out/hub_angle.csv --input hub-angle {set} -o played"));
        bench.number("played", "results/peak_motor_current_a")
    };
    let limit = current_a(0.05);
    let limits = format!("--set limits={{motor_current={limit:?},rms_torque=1.0}}");
    let uncertain = "--uncertain payload.mass=0..0.1 --runs 9 --play position";
    let told = bench.told(&format!("robust {LINK} {MOTION} {KNOWN} {limits} {uncertain} -o rb"));
    let masses = bench.numbers("rb/robust.csv", "payload.mass");
    let kinds = bench.cells("rb/robust.csv", "kind");
    let sample = masses.iter().zip(kinds).filter(|(_, kind)| kind == "sample");
    let currents: Vec<f64> = sample.map(|(mass, _)| current_a(*mass)).collect();
    let over = currents.iter().filter(|current| **current > limit).count();
    assert!((1..=8).contains(&over) && currents.len() == 9, "{currents:?}");
    let summary = bench.json("rb/summary.json");
    let found = &summary["over_limits"][0];
    assert_eq!(found["key"], "motor_current");
    let [share, largest] = ["share", "largest"].map(|key| found[key].as_f64().unwrap());
    let most = currents.iter().copied().fold(0.0, f64::max);
    assert!((share - over as f64 / 9.0).abs() < 1e-12, "{share}, {over}");
    assert!((largest / most - 1.0).abs() < 1e-3, "{largest} is not {most}");
    // A limit that plays have no value of is told.
    assert!(told.contains("limits.rms_torque is not compared"), "{told}");
}

#[test]
fn the_shortest_motion_within_a_current_keeps_it_and_none_shorter_does() {
    let bench = Bench::new();
    for (key, limit) in [("motor_current", 2.0), ("motor_voltage", 4.0)] {
        let fit = format!("--step 0.01 --link {LINK} {KNOWN} --fit-limit {key}={limit}");
        let told = bench.told(&format!("trajectory septic --distance 0.5 {fit} -o fit.csv"));
        assert!(told.contains(&format!("limits.{key} binds")), "{told}");
        let end_s = column(&bench, "fit.csv", "time").last().copied().unwrap();
        let unit = if key == "motor_current" { "a" } else { "v" };
        for (less_s, fits) in [(0.01, false), (0.0, true)] {
            let duration = format!("--duration {:.2}", end_s - less_s);
            bench
                .done(&format!("trajectory septic --distance 0.5 --step 0.01 {duration} -o m.csv"));
            bench.done(&format!("solve {LINK} m.csv {KNOWN} -o solved"));
            let found = bench.number("solved", &format!("results/peak_{key}_{unit}"));
            assert_eq!(found <= limit, fits, "{key}: {found} in {end_s} s less {less_s} s");
        }
    }
}

/// A joint that its friction holds stands still, and no warning says otherwise: of a hanging link, and of a linear one.
#[test]
fn friction_holds_a_joint_under_a_small_voltage() {
    let bench = Bench::new();
    bench.write(
        "held.toml",
        "gravity = [0, -9.81]\nstart_angle = '-90 deg'\n\
         segments = [{ length = 1.0, EI = 20.0, mass_per_length = 0.5, elements = 4 }]\n\
         hub = { inertia = 0.05 }\npayload = { mass = 0.2 }\n\
         damping = { model = 'rayleigh', beta = 1e-3 }\n[drive]\ngear_ratio = 20\n\
         efficiency = 0.8\ncoulomb_friction = 0.5\ntorque_constant = 0.05\nresistance = 1.2\n",
    );
    // At most 0.2/1.2 × 0.05 × 20 = 0.17 N m against 0.5 N m.
    let row = |k: u32| {
        let share = (std::f64::consts::PI * f64::from(k) / 200.0).sin();
        format!("{},{}\n", 0.005 * f64::from(k), 0.2 * share * share)
    };
    let rows: String = (0..=200).map(row).collect();
    bench.write("volts.csv", &("time,voltage\n".to_owned() + &rows));
    for weight in ["gravity=[0,-9.81]", "gravity=[0,0]"] {
        let play = "simulate held.toml volts.csv --input voltage --deny-warnings -o held";
        bench.done(&format!("{play} --set {weight}"));
        let angles = bench.numbers("held/hub_angle.csv", "hub_angle_rad");
        let turned = angles.iter().map(|own| (own - angles[0]).abs()).fold(0.0, f64::max);
        assert!(turned > 0.0 && turned < 1e-6, "{weight}: {turned}");
        let torques = bench.numbers("held/torque.csv", "torque_n_m");
        assert!(torques.iter().all(|own| own.abs() < 1e-3), "{weight}");
    }
}
