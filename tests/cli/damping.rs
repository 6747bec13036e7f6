//! Laws of damping by modes, and a link reduced to few modes, through all commands.

use super::{Bench, LINK, column, repository, stdout};

const MODAL: &str = "damping.model=modal";
const CAUGHEY: &str = "damping={model=\"caughey\", modes=[1, 2], ratios=[0.02, 0.03]}";

/// The line of a printed summary with this label, without it.
fn line(text: &str, label: &str) -> Option<String> {
    let found = text.lines().find(|line| line.split(' ').next() == Some(label))?;
    Some(found[label.len()..].trim().to_owned())
}

#[test]
fn modal_damping_tells_its_one_ratio() {
    let bench = Bench::new();
    let text = stdout(&bench.solve(&["--set", MODAL]));
    assert_eq!(line(&text, "damping").as_deref(), Some("modal, ratio 0.02"));
    let summary = bench.json("out/summary.json");
    assert_eq!(summary["link"]["damping"]["model"], "modal");
    assert_eq!(summary["link"]["damping"]["ratios"], serde_json::json!([0.02]));
    assert_eq!(summary["modal_damping_ratios"], serde_json::json!([0.02, 0.02, 0.02, 0.02, 0.02]));
}

#[test]
fn a_list_of_ratios_and_a_caughey_series_tell_what_each_mode_gets() {
    let bench = Bench::new();
    let list = "damping={model=\"modal\", ratios=[0.01, 0.02, 0.03]}";
    let text = stdout(&bench.solve(&["--set", list]));
    let expected = "modal, all modes of the mesh, ratios 0.010 0.020 0.030 0.030 0.030";
    assert_eq!(line(&text, "damping").as_deref(), Some(expected));
    let text = stdout(&bench.solve(&["--set", CAUGHEY]));
    let expected = "caughey, all modes of the mesh, ratios 0.020 0.030 0.066 0.12 0.20";
    assert_eq!(line(&text, "damping").as_deref(), Some(expected));
    let damping = &bench.json("out/summary.json")["link"]["damping"];
    assert_eq!(damping["model"], "caughey");
    assert_eq!(damping["modes"], serde_json::json!([1, 2]));
    assert_eq!(damping["ratios"], serde_json::json!([0.02, 0.03]));
    let simulate = ["simulate", &repository(LINK), "out/torque.csv", "--set", CAUGHEY];
    let played = stdout(&bench.run(&simulate));
    assert_eq!(line(&played, "damping").as_deref(), Some(expected), "{played}");
}

#[test]
fn modes_tabulates_the_ratios_of_a_series() {
    let bench = Bench::new();
    bench.done(&["modes", &repository(LINK), "--set", CAUGHEY, "--count", "3", "-o", "m"]);
    let ratios = column(&bench, "m/modes.csv", "damping_ratio");
    assert!((ratios[0] - 0.02).abs() < 1e-9 && (ratios[1] - 0.03).abs() < 1e-9);
    // Two modes make it the law of Rayleigh, ζ = α/(2ω) + βω/2.
    let omega = column(&bench, "m/modes.csv", "omega_rad_s");
    let determinant = omega[1] / omega[0] - omega[0] / omega[1];
    let beta = 2.0 * (0.03 / omega[0] - 0.02 / omega[1]) / determinant;
    let alpha = 2.0 * 0.02 * omega[0] - beta * omega[0] * omega[0];
    let expected = 0.5 * (alpha / omega[2] + beta * omega[2]);
    assert!((ratios[2] - expected).abs() < 1e-9, "{} is not {expected}", ratios[2]);
}

#[test]
fn what_few_modes_cost_is_told() {
    let bench = Bench::new();
    let whole = ["--set", "analysis.tip_tolerance=0"];
    let text = stdout(&bench.solve(&[&["--set", "analysis.modes=5"], &whole[..]].concat()));
    let errors = line(&text, "errors").unwrap();
    let told = bench.json("out/summary.json")["errors"].clone();
    let of = |quantity: &str| told[quantity]["modes"].as_f64().unwrap();
    let truncation = of("torque");
    assert!((0.03..0.08).contains(&truncation), "{truncation}");
    let worst = of("hub_acceleration");
    assert!(worst > truncation, "{worst}");
    assert!(!errors.contains("modes"), "{errors}");
    let heading =
        text.lines().position(|line| line.starts_with("         modes left out (hub accel.)"));
    let below = text.lines().nth(heading.unwrap() + 1).unwrap();
    assert!(below.starts_with(&format!("         {worst:.1e} ")), "{text}");
    let text = stdout(&bench.solve(&[]));
    assert!(!text.contains("modes left out"), "{text}");
    let errors = &bench.json("out/summary.json")["errors"];
    assert!(errors["torque"]["modes"].is_null(), "{errors}");
}

#[test]
fn the_truncation_error_is_the_difference_of_the_two_torques() {
    let bench = Bench::new();
    let window = ["--set", "analysis.lead=1", "--set", "analysis.lag=1"];
    bench.solve(&[&["-o", "all"], &window[..]].concat());
    bench.solve(&[&["-o", "few", "--set", "analysis.modes=5"], &window[..]].concat());
    let torque = |folder: &str| column(&bench, &format!("{folder}/torque.csv"), "torque_n_m");
    let (all, few) = (torque("all"), torque("few"));
    let largest =
        |samples: &mut dyn Iterator<Item = f64>| samples.fold(0.0, |m: f64, x| m.max(x.abs()));
    let difference = largest(&mut all.iter().zip(&few).map(|(a, b)| a - b));
    let share = difference / largest(&mut all.iter().copied());
    let told = bench.json("few/summary.json")["errors"]["torque"]["modes"].as_f64().unwrap();
    assert!((told / share - 1.0).abs() < 0.02, "{told} is not {share}");
}

/// Responses at 400 frequencies under a law.
fn response(bench: &Bench, law: &str) -> Vec<(String, Vec<f64>)> {
    let arguments = ["--points", "400", "--to", "60", "-o", "frf.csv"];
    let link = repository(LINK);
    bench.done(&[&["frf", &link, "--set", law], &arguments[..]].concat());
    bench.table("frf.csv")
}

#[test]
fn modal_and_hysteretic_damping_of_one_ratio_respond_alike_away_from_the_poles() {
    let bench = Bench::new();
    let modal = response(&bench, "damping={model=\"modal\", ratio=0.01}");
    let hysteretic = response(&bench, "damping={model=\"hysteretic\", ratio=0.01}");
    let undamped = response(&bench, "damping={model=\"none\"}");
    let at = |table: &[(String, Vec<f64>)], name: &str, part: &str, k: usize| {
        let name = format!("{name}_{part}");
        table.iter().find(|(heading, _)| *heading == name).unwrap().1[k]
    };
    for name in ["torque_per_tip_acceleration_kg_m", "tip_displacement_per_torque_1_n"] {
        let mut compared = 0;
        for k in 0..modal[0].1.len() {
            let [a, b, free] =
                [&modal, &hysteretic, &undamped].map(|table| at(table, name, "magnitude", k));
            // Near a pole and a zero, damping is what limits the response.
            if (b / free - 1.0).abs() > 0.02 {
                continue;
            }
            compared += 1;
            let distance = [("real"), ("imag")]
                .map(|part| at(&modal, name, part, k) - at(&hysteretic, name, part, k));
            let share = distance[0].hypot(distance[1]) / free;
            assert!(share < 0.05, "{name} at {} Hz: {share} ({a}, {b})", modal[0].1[k]);
        }
        assert!(compared > 300, "{name}: {compared} frequencies");
    }
}

#[test]
fn undamped_modes_respond_with_numbers_everywhere() {
    let bench = Bench::new();
    for law in ["damping={model=\"modal\", ratio=0}", "damping={model=\"caughey\", ratio=0}"] {
        for (name, values) in response(&bench, law) {
            assert!(values.iter().all(|x| x.is_finite()), "{law}: {name}");
        }
    }
    let modal = response(&bench, "damping={model=\"modal\", ratio=0}");
    let none = response(&bench, "damping={model=\"none\"}");
    for ((name, a), (_, b)) in
        modal.iter().zip(&none).filter(|((n, _), _)| n.ends_with("_magnitude"))
    {
        let worst = a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a / b - 1.0).abs()));
        assert!(worst < 1e-5, "{name}: {worst:e}");
    }
}
