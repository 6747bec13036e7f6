//! Laws of damping by modes, and a link reduced to few modes, through all commands.

use super::{Bench, LINK, apart, column, number, peak, stdout};

const CAUGHEY: &str = "damping={model=\"caughey\",modes=[1,2],ratios=[0.02,0.03]}";

/// The line of a printed summary with this label, without it.
fn line(text: &str, label: &str) -> Option<String> {
    let found = text.lines().find(|line| line.split(' ').next() == Some(label))?;
    Some(found[label.len()..].trim().to_owned())
}

#[test]
fn a_law_tells_what_each_mode_gets() {
    let bench = Bench::new();
    let list = "damping={model=\"modal\",ratios=[0.01,0.02,0.03]}";
    let series = "caughey, all modes of the mesh, ratios 0.020 0.030 0.066 0.12 0.20";
    for (law, model, ratios, told) in [
        ("damping.model=modal", "modal", &[0.02][..], "modal, ratio 0.02"),
        (
            list,
            "modal",
            &[0.01, 0.02, 0.03],
            "modal, all modes of the mesh, ratios 0.010 0.020 0.030 0.030 0.030",
        ),
        (CAUGHEY, "caughey", &[0.02, 0.03], series),
    ] {
        let text = stdout(&bench.solve(&["--set", law]));
        assert_eq!(line(&text, "damping").as_deref(), Some(told));
        let damping = &bench.json("out/summary.json")["link"]["damping"];
        assert_eq!(
            (&damping["model"], &damping["ratios"]),
            (&model.into(), &serde_json::json!(ratios))
        );
        let each = bench.json("out/summary.json")["modal_damping_ratios"].clone();
        assert_eq!(each == serde_json::json!(vec![0.02; 5]), ratios.len() == 1, "{law}: {each}");
    }
    assert_eq!(
        bench.json("out/summary.json")["link"]["damping"]["modes"],
        serde_json::json!([1, 2])
    );
    let played = stdout(&bench.run(&format!("simulate {LINK} out/torque.csv --set {CAUGHEY}")));
    assert_eq!(line(&played, "damping").as_deref(), Some(series), "{played}");
}

#[test]
fn modes_tabulates_the_ratios_of_a_series() {
    let bench = Bench::new();
    bench.done(&format!("modes {LINK} --set {CAUGHEY} --count 3 -o m"));
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
    let text = stdout(&bench.solve("--set analysis.modes=5 --set analysis.tip_tolerance=0"));
    let errors = bench.json("out/summary.json")["errors"].clone();
    let truncation = number(&errors, "torque/modes");
    assert!((0.03..0.08).contains(&truncation), "{truncation}");
    let worst = number(&errors, "hub_acceleration/modes");
    assert!(worst > truncation, "{worst}");
    let told = line(&text, "errors").unwrap();
    assert!(!told.contains("modes"), "{told}");
    let heading = "         modes left out (hub accel.)";
    let below = text.lines().skip_while(|line| !line.starts_with(heading)).nth(1).unwrap();
    assert!(below.starts_with(&format!("         {worst:.1e} ")), "{text}");
    let text = stdout(&bench.solve(""));
    assert!(!text.contains("modes left out"), "{text}");
    let errors = &bench.json("out/summary.json")["errors"];
    assert!(errors["torque"]["modes"].is_null(), "{errors}");
}

#[test]
fn the_truncation_error_is_the_difference_of_the_two_torques() {
    let bench = Bench::new();
    let window = "--set analysis.lead=1 --set analysis.lag=1";
    bench.solve(&format!("-o all {window}"));
    bench.solve(&format!("-o few --set analysis.modes=5 {window}"));
    let [all, few] =
        ["all", "few"].map(|folder| column(&bench, &format!("{folder}/torque.csv"), "torque_n_m"));
    let share = apart(&all, &few) / peak(&all);
    let told = bench.number("few", "errors/torque/modes");
    assert!((told / share - 1.0).abs() < 0.02, "{told} is not {share}");
}

/// A part of a response at 400 frequencies under a law: by its name.
fn response(bench: &Bench, law: &str) -> impl Fn(&str) -> Vec<f64> + use<> {
    bench.done(&format!("frf {LINK} --set damping={{{law}}} --points 400 --to 60 -o frf.csv"));
    let table = bench.table("frf.csv");
    move |name| table.iter().find(|(heading, _)| heading == name).unwrap().1.clone()
}

#[test]
fn modal_and_hysteretic_damping_of_one_ratio_respond_alike_away_from_the_poles() {
    let bench = Bench::new();
    let [modal, hysteretic, undamped] =
        ["model=\"modal\",ratio=0.01", "model=\"hysteretic\",ratio=0.01", "model=\"none\""]
            .map(|law| response(&bench, law));
    for name in ["torque_per_tip_acceleration_kg_m", "tip_displacement_per_torque_1_n"] {
        let [magnitude, real, imag] =
            ["magnitude", "real", "imag"].map(|part| format!("{name}_{part}"));
        let (damped, free) = (hysteretic(&magnitude), undamped(&magnitude));
        let [(re, own_re), (im, own_im)] =
            [real, imag].map(|part| (modal(&part), hysteretic(&part)));
        // Near a pole and a zero, damping is what limits the response.
        let away: Vec<usize> =
            (0..400).filter(|k| (damped[*k] / free[*k] - 1.0).abs() <= 0.02).collect();
        assert!(away.len() > 300, "{name}: {} frequencies", away.len());
        for k in away {
            let share = (re[k] - own_re[k]).hypot(im[k] - own_im[k]) / free[k];
            assert!(share < 0.05, "{name} in row {k}: {share}");
        }
    }
}

#[test]
fn undamped_modes_respond_with_numbers_everywhere() {
    let bench = Bench::new();
    let of_none = response(&bench, "model=\"none\"");
    for law in ["caughey", "modal"] {
        let undamped = response(&bench, &format!("model=\"{law}\",ratio=0"));
        for (name, values) in bench.table("frf.csv") {
            assert!(values.iter().all(|x| x.is_finite()), "{law}: {name}");
            if law == "modal" && name.ends_with("_magnitude") {
                let pairs = undamped(&name).into_iter().zip(of_none(&name));
                let worst = pairs.fold(0.0_f64, |most, (a, b)| most.max((a / b - 1.0).abs()));
                assert!(worst < 1e-5, "{name}: {worst:e}");
            }
        }
    }
}
