//! `flexlink modes` and `flexlink frf`.

use super::{Bench, LINK, repository, stderr};

#[track_caller]
fn printed(bench: &Bench, arguments: &[&str]) -> String {
    let output = bench.done(arguments);
    String::from_utf8(output.stdout).unwrap()
}

/// Fields of a table, empty ones too.
fn fields(text: &str) -> Vec<Vec<&str>> {
    text.lines().map(|line| line.split(',').collect()).collect()
}

#[test]
fn modes_are_printed_and_tabled() {
    let bench = Bench::new();
    let text = printed(&bench, &["modes", &repository(LINK), "--count", "5", "-o", "m"]);
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    assert!(text.contains("0.52642512"), "{text}");
    assert_eq!(bench.names("m"), ["held_modes.csv", "mode_shapes.csv", "modes.csv", "zeros.csv"]);
    let modes = bench.table("m/modes.csv");
    let names: Vec<&str> = modes.iter().map(|(name, _)| name.as_str()).collect();
    let expected =
        ["mode", "omega_rad_s", "frequency_hz", "period_s", "damping_ratio", "mesh_error"];
    assert_eq!(names, expected);
    assert!((modes[3].1[4] - 0.024_270_99).abs() < 1e-8);
    let shapes = bench.table("m/mode_shapes.csv");
    assert_eq!((shapes.len(), shapes[0].1.len()), (6, 11));
    assert!(shapes[1..].iter().all(|(_, v)| v[0].abs() < 1e-12 && v[10] > 0.0));
    let text = bench.read("m/zeros.csv");
    let zeros = fields(&text);
    let [zero, lead, blocked] = ["zero_per_s", "lead_to_1_percent_s", "blocked_frequency_hz"];
    assert_eq!(zeros[0], [zero, lead, blocked, "mesh_error", "blocked_mesh_error"]);
    let (zero, lead): (f64, f64) = (zeros[1][0].parse().unwrap(), zeros[1][1].parse().unwrap());
    assert!((zero - 12.891_475_6).abs() < 1e-6 && (zero * lead - 100.0_f64.ln()).abs() < 1e-9);
}

#[test]
fn a_link_with_a_drive_also_has_the_modes_of_the_held_rotor() {
    let bench = Bench::new();
    let rome = repository("specs/rome_link.toml");
    let held = ["--set", "mesh.elements=200", "--count", "3", "-o", "m"];
    let text = printed(&bench, &[&["modes", &rome], &held[..]].concat());
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    let (free, block) = text.split_once("rotor held, joint spring 1000 N m/rad\n").unwrap();
    assert!(free.contains("damping") && free.contains("zero"), "{text}");
    let rows: Vec<Vec<&str>> =
        block.lines().skip(1).map(|row| row.split_whitespace().collect()).collect();
    assert_eq!(bench.names("m"), ["held_modes.csv", "mode_shapes.csv", "modes.csv", "zeros.csv"]);
    let table = bench.table("m/held_modes.csv");
    let names: Vec<&str> = table.iter().map(|(name, _)| name.as_str()).collect();
    let expected =
        ["mode", "omega_rad_s", "frequency_hz", "period_s", "damping_ratio", "mesh_error"];
    assert_eq!(names, expected);
    assert_eq!((rows.len(), table[0].1.as_slice()), (3, &[1.0, 2.0, 3.0][..]));
    for (k, squared) in [34.14, 1383.24, 11_084.49].into_iter().enumerate() {
        let [omega, hertz, period] = [1, 2, 3].map(|column| table[column].1[k]);
        assert!((omega * omega - squared).abs() < 0.005, "{omega}² is not {squared}");
        assert!((hertz * std::f64::consts::TAU / omega - 1.0).abs() < 1e-9);
        assert!((hertz * period - 1.0).abs() < 1e-9);
        let printed: Vec<f64> = rows[k].iter().map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(printed.len(), 6, "{text}");
        for (cell, value) in printed[1..4].iter().zip([omega, hertz, period]) {
            assert!((cell / value - 1.0).abs() < 1e-7, "{cell} for {value}");
        }
        // The joint's spring has no damping of its own.
        let ratio = table[4].1[k];
        assert!((printed[4] / ratio - 1.0).abs() < 1e-3 && ratio < 0.02, "{text}");
    }
}

#[test]
fn a_held_hub_and_one_behind_a_stiff_joint_are_clamped() {
    let bench = Bench::new();
    let uniform = "segments = [{ length = 1, EI = 1, mass_per_length = 1 }]\nhub.inertia = 0.1\n";
    for (drive, heading) in [("", "hub held"), ("[drive]\n", "rotor held, stiff joint")] {
        bench.write("link.toml", &format!("{uniform}{drive}"));
        let text = printed(&bench, &["modes", "link.toml", "--count", "3", "-o", "m"]);
        assert!(text.contains(&format!("\n{heading}\nmode ")), "{text}");
        let omega = &bench.table("m/held_modes.csv")[1].1;
        assert_eq!(omega.len(), 3);
        for (omega, b) in omega.iter().zip([1.875_104_069, 4.694_091_133, 7.854_757_438_f64]) {
            assert!((omega / (b * b) - 1.0).abs() < 1e-6, "{omega} is not {b}²");
        }
    }
}

#[test]
fn a_payload_inertia_blocks_the_tip_at_a_frequency_that_is_told() {
    let bench = Bench::new();
    let link = repository(LINK);
    let text = printed(&bench, &["modes", &link, "--set", "payload.inertia=0.05"]);
    assert!(text.contains(" Hz no torque moves the tip (mesh error "), "{text}");
}

#[test]
fn an_automatic_mesh_is_refined_for_the_modes_asked_for() {
    let bench = Bench::new();
    bench.write("link.toml", "segments = [{ length = 1, EI = 1, mass_per_length = 1 }]\n");
    printed(&bench, &["modes", "link.toml", "--count", "20", "-o", "m"]);
    // Pinned and free: tan b = tanh b, which is (k + 1/4)π from the third on to nine digits.
    let modes = bench.table("m/modes.csv");
    assert_eq!(modes[1].1.len(), 20);
    for (mode, omega) in modes[1].1.iter().enumerate().skip(2) {
        let exact = ((mode as f64 + 1.25) * std::f64::consts::PI).powi(2);
        assert!((omega / exact - 1.0).abs() < 1e-6, "mode {mode}: {omega} is not {exact}");
    }
}

/// Uniform links of few elements against closed forms, after the coarse mesh of solve.
#[test]
fn the_mesh_error_of_each_number_is_what_it_is_wrong_by() {
    let bench = Bench::new();
    let uniform = "segments = [{ length = 1, EI = 1, mass_per_length = 1 }]\n";
    bench.write("link.toml", &format!("{uniform}mesh.elements = 8\n[drive]\n"));
    let output = bench.run(&["modes", "link.toml", "--count", "6", "-o", "m"]);
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    let quarters = |first: f64| move |k: usize| (k as f64 + first) * std::f64::consts::PI;
    let free = [3.926_602_312, 7.068_582_746, 10.210_176_12, 13.351_768_78, 16.493_361_43];
    let clamped = [1.875_104_069, 4.694_091_133, 7.854_757_438, 10.995_540_73, 14.137_168_39];
    let zeros = [11.186_642_72, 60.451_695_86, 149.277_767_6];
    let columns = |name: &str| {
        let text = bench.read(&format!("m/{name}"));
        let rows = fields(&text);
        let column = |wanted: &str| {
            let place = rows[0].iter().position(|name| *name == wanted).unwrap();
            rows[1..].iter().map(|row| row[place].parse::<f64>().unwrap()).collect::<Vec<_>>()
        };
        (
            column(if name == "zeros.csv" { "zero_per_s" } else { "omega_rad_s" }),
            column("mesh_error"),
        )
    };
    let squared = |roots: &[f64], next: &dyn Fn(usize) -> f64| {
        let roots = roots.iter().copied().chain([next(roots.len())]);
        roots.map(|b| b * b).collect::<Vec<_>>()
    };
    for (name, exact) in [
        ("modes.csv", squared(&free, &quarters(1.25))),
        ("held_modes.csv", squared(&clamped, &quarters(0.5))),
        ("zeros.csv", zeros.to_vec()),
    ] {
        let (found, errors) = columns(name);
        for (k, exact) in exact.iter().enumerate() {
            let (error, told) = ((found[k] / exact - 1.0).abs(), errors[k]);
            let worst = if error > 1e-2 { 0.3 } else { 0.1 };
            assert!((told / error - 1.0).abs() < worst, "{name} {k}: {told:e} for {error:e}");
        }
    }
    let expected = "warning: from mode 5 on the mesh is wrong by more than 1 %, at the worst by ";
    assert!(stderr(&output).starts_with(expected), "{}", stderr(&output));
}

#[test]
fn a_massless_link_has_the_modes_of_its_bodies_and_no_more() {
    let bench = Bench::new();
    let segment = "segments = [{ length = 1.5, EI = 5, mass_per_length = 0 }]";
    bench.write("link.toml", &format!("{segment}\nhub.inertia = 0.1\npayload.mass = 1\n"));
    let text = printed(&bench, &["modes", "link.toml", "-o", "m"]);
    assert!(text.contains("0.61480"), "{text}");
    assert_eq!(bench.table("m/modes.csv")[0].1, [1.0]);
    assert_eq!(bench.read("m/zeros.csv").lines().count(), 1, "no zero");
}

#[test]
fn the_frequency_response_has_three_transfers_in_four_parts() {
    let bench = Bench::new();
    let link = repository(LINK);
    let arguments = ["--from", "0.5", "--to", "20", "--points", "7", "-o", "new/frf.csv"];
    let arguments = [&["frf", link.as_str()], &arguments[..]].concat();
    assert_eq!(printed(&bench, &arguments), "");
    let table = bench.table("new/frf.csv");
    assert_eq!((table.len(), table[0].1.len()), (14, 7));
    assert_eq!((table[0].1[0], table[0].1[6]), (0.5, 20.0));
    let column = |name: &str| &table.iter().find(|(n, _)| n == name).unwrap().1;
    for k in 0..7 {
        let of = |name: &str, part: &str| column(&format!("{name}_{part}"))[k];
        let name = "torque_per_tip_acceleration_kg_m";
        let (re, im) = (of(name, "real"), of(name, "imag"));
        assert!((of(name, "magnitude") - re.hypot(im)).abs() < 1e-12);
        assert!((of(name, "phase_rad") - im.atan2(re)).abs() < 1e-12);
        // v/T = −1/(ω² T/a)
        let omega = std::f64::consts::TAU * table[0].1[k];
        let product = of("tip_displacement_per_torque_1_n", "magnitude") * omega * omega;
        assert!((product * of(name, "magnitude") - 1.0).abs() < 1e-12);
    }
}

/// Coarse against fine, at frequencies between the poles and near them.
#[test]
fn the_mesh_error_of_a_response_is_what_a_fine_mesh_shows_and_is_told() {
    let bench = Bench::new();
    let link = repository(LINK);
    let band = ["--from", "1", "--to", "30", "--points", "60", "-o"];
    let run = |rest: &[&str]| {
        let output = bench.run(&[&["frf", link.as_str()], &band[..], rest].concat());
        assert!(output.status.success() && output.stdout.is_empty(), "{}", stderr(&output));
        stderr(&output)
    };
    let told = run(&["coarse.csv"]);
    let finer = run(&["fine.csv", "--set", "mesh.elements=320"]);
    assert!(finer.starts_with("note: the mesh error is "), "{finer}");
    let [coarse, fine] = ["coarse.csv", "fine.csv"].map(|name| bench.table(name));
    let column = |table: &[(String, Vec<f64>)], wanted: &str| {
        table.iter().find(|(name, _)| name == wanted).unwrap().1.clone()
    };
    let claimed = column(&coarse, "mesh_error");
    let mut worst = (0.0, 0.0_f64);
    for (k, claimed) in claimed.iter().enumerate() {
        let error = ["torque_per_tip_acceleration_kg_m", "hub_angle_per_tip_displacement_rad_m"]
            .map(|name| {
                let part = |table, part: &str| column(table, &format!("{name}_{part}"))[k];
                let change = [&coarse, &fine].map(|t| [part(t, "real"), part(t, "imag")]);
                (change[0][0] - change[1][0]).hypot(change[0][1] - change[1][1])
                    / part(&coarse, "magnitude").max(part(&fine, "magnitude"))
            });
        let error = error[0].max(error[1]);
        assert!((claimed / error - 1.0).abs() < 0.2, "row {k}: {claimed:e} for {error:e}");
        worst = if error > worst.1 { (coarse[0].1[k], error) } else { worst };
    }
    assert!(worst.1 > 1e-2, "{worst:?}");
    let below = coarse[0].1[claimed.iter().position(|error| *error > 1e-2).unwrap() - 1];
    let expected =
        format!("warning: above {below:.2} Hz the mesh is wrong by more than 1 %, at the");
    assert!(told.starts_with(&expected), "{told} for {expected}");
    assert!(
        told.contains(&format!("at {:.2} Hz (elements halved)\n", worst.0)),
        "{told} {worst:?}"
    );
}

#[test]
fn an_undamped_response_has_no_number_that_is_none() {
    let bench = Bench::new();
    let link = repository(LINK);
    let undamped = ["--set", "damping.ratio=0", "--linear", "--points", "3000"];
    let text = printed(&bench, &[&["frf", link.as_str()], &undamped[..]].concat());
    let rows = fields(&text);
    assert_eq!(rows.len(), 3001);
    for field in rows[1..].iter().flatten() {
        assert!(field.parse::<f64>().is_ok_and(f64::is_finite), "{field:?}");
    }
}
