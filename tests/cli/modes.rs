//! `flexlink modes` and `flexlink frf`.

use std::f64::consts::{PI, TAU};

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::{Bench, LINK, stderr, stdout};

const TABLES: [&str; 4] = ["held_modes.csv", "mode_shapes.csv", "modes.csv", "zeros.csv"];

const COLUMNS: [&str; 6] =
    ["mode", "omega_rad_s", "frequency_hz", "period_s", "damping_ratio", "mesh_error"];

#[test]
fn modes_are_printed_and_tabled() {
    let bench = Bench::new();
    let text = bench.printed(&format!("modes {LINK} --count 5 -o m"));
    assert!(text.contains("0.52642512"), "{text}");
    assert_eq!(bench.names("m"), TABLES);
    assert_eq!(bench.rows("m/modes.csv")[0], COLUMNS);
    assert!((bench.numbers("m/modes.csv", "period_s")[4] - 0.024_270_99).abs() < 1e-8);
    let shapes = bench.table("m/mode_shapes.csv");
    assert_eq!((shapes.len(), shapes[0].1.len()), (1 + 5 * 6, 11));
    assert!(shapes[1..6].iter().all(|(_, v)| v[0].abs() < 1e-12 && v[10] > 0.0));
    let zeros = bench.rows("m/zeros.csv");
    let [zero, lead, blocked] = ["zero_per_s", "lead_to_1_percent_s", "blocked_frequency_hz"];
    assert_eq!(zeros[0], [zero, lead, blocked, "mesh_error", "blocked_mesh_error"]);
    let [zero, lead] = [zero, lead].map(|name| bench.numbers("m/zeros.csv", name)[0]);
    assert!((zero - 12.891_475_6).abs() < 1e-6 && (zero * lead - 100.0_f64.ln()).abs() < 1e-9);
}

/// Uniform, on a pinned or a clamped root: closed forms of the displacement, its slope at the root and at the tip.
#[test]
fn shapes_have_the_part_of_the_hub_and_slopes_with_the_hub_free_and_held() {
    let bench = Bench::new();
    let uniform = "segments = [{ length = 1, EI = 1, mass_per_length = 1 }]\nmesh.elements = 60\n";
    bench.write("link.toml", uniform);
    bench.done("modes link.toml --count 2 -o m");
    let shape = |name: &str| bench.numbers("m/mode_shapes.csv", name);
    let (x, last) = (shape("x_m"), 60);
    let b = 3.926_602_312_047_919_f64;
    let slope = b * (1.0 / b.sin() + 1.0 / b.sinh());
    assert!((shape("mode_1_slope")[0] / slope - 1.0).abs() < 1e-6);
    for (node, rigid) in shape("mode_1_rigid").into_iter().enumerate() {
        assert!((rigid - slope * x[node]).abs() < 1e-6, "node {node}: {rigid}");
    }
    let at_tip = b * (b.cos() / b.sin() + b.cosh() / b.sinh());
    assert!((shape("mode_1_slope")[last] / at_tip - 1.0).abs() < 1e-6);
    // Mass-normalised, the tip of each clamped mode moves by 2.
    assert!((shape("held_2")[last] - 2.0).abs() < 1e-6);
    assert!(
        shape("held_2_rigid").iter().chain([&shape("held_2_slope")[0]]).all(|v| v.abs() < 1e-9)
    );
    let b = 4.694_091_133_f64;
    let steep = (b.cos() + b.cosh()) / (b.sin() + b.sinh());
    let tip = b * (b.sin() + b.sinh() - steep * (b.cosh() - b.cos()));
    let sign = (b.cosh() - b.cos() - steep * (b.sinh() - b.sin())).signum();
    assert!((shape("held_2_slope")[last] / (sign * tip) - 1.0).abs() < 1e-5, "{tip}");
}

#[test]
fn quiet_modes_print_nothing_but_warnings() {
    let bench = Bench::new();
    assert_eq!(bench.silent(&format!("modes {LINK} --count 3 -q -o m --state-space s.json")), "");
    assert_eq!(bench.numbers("m/modes.csv", "period_s").len(), 3);
    let coarse = bench.told(&format!("modes {LINK} --quiet --set mesh.elements=2"));
    assert!(coarse.starts_with("warning: "), "{coarse}");
    bench.refuses(2, &format!("modes {LINK} --quiet --json"), "--json");
}

#[test]
fn a_state_space_answers_as_frf_and_names_its_numbers() {
    let bench = Bench::new();
    let link = "segments = [{ length = 1, EI = 8, mass_per_length = 0.6 }]\nmesh.elements = 10
hub = { inertia = 0.1, viscous_friction = 0.2 }\npayload.mass = 0.2
damping = { model = 'rayleigh', alpha = 0.3, beta = 1e-3 }\n";
    bench.write("link.toml", link);
    let told = bench.told("modes link.toml --count 3 --state-space s.json --stations 50cm");
    assert!(told.starts_with("note: s.json has 8 states, 1 input and 7 outputs: modes 0 to 3; "));
    assert!(told.trim_end().ends_with("; D lacks the static response of the others"), "{told}");
    let space: serde_json::Value = serde_json::from_str(&bench.read("s.json")).unwrap();
    let names = ["hub_angle", "hub_rate", "tip_displacement", "tip_deflection", "tip_acceleration"];
    let names = [&names[..], &["root_strain", "station1"]].concat();
    assert_eq!(space["outputs"], serde_json::json!(names));
    assert_eq!(space["input_units"], serde_json::json!(["N m"]));
    let matrix = |name: &str| {
        let rows: Vec<Vec<f64>> = serde_json::from_value(space[name].clone()).unwrap();
        let number = |i: usize, j: usize| Complex64::from(rows[i][j]);
        DMatrix::from_fn(rows.len(), rows[0].len(), number)
    };
    let [a, b, c, d] = ["A", "B", "C", "D"].map(matrix);
    let [mass, stiffness, damping] = ["mass", "stiffness", "damping"].map(matrix);
    assert_eq!(mass, DMatrix::identity(4, 4));
    assert_eq!(-stiffness, a.view((4, 0), (4, 4)).into_owned());
    assert_eq!(-damping, a.view((4, 4), (4, 4)).into_owned());
    let told = bench.told("modes link.toml --state-space few.json --modes 3,1");
    assert!(
        told.starts_with("note: few.json has 6 states, 1 input and 6 outputs: modes 0, 1, 3; ")
    );
    let few: serde_json::Value = serde_json::from_str(&bench.read("few.json")).unwrap();
    assert_eq!(few["states"][2], "mode_3");
    assert_eq!(few["A"][5][2], space["A"][7][3]);
    bench.refuses(2, "modes link.toml --state-space s.json --modes 11", "at most --count, 10");
    bench.done("frf link.toml --set analysis.modes=3 --from 0.1 --to 60 --points 40 -o frf.csv");
    let of = |name: &str| {
        let part = |part: &str| bench.numbers("frf.csv", &format!("{name}_{part}"));
        let parts = part("real").into_iter().zip(part("imag"));
        parts.map(|(re, im)| Complex64::new(re, im)).collect::<Vec<_>>()
    };
    let [tip, hub] =
        ["tip_displacement_per_torque_1_n", "hub_angle_per_tip_displacement_rad_m"].map(of);
    for (k, hertz) in bench.numbers("frf.csv", "frequency_hz").into_iter().enumerate() {
        let rate = Complex64::new(0.0, TAU * hertz);
        let left = DMatrix::from_diagonal_element(8, 8, rate) - &a;
        let found = &c * left.lu().solve(&b).unwrap() + &d;
        assert!((found[(2, 0)] / tip[k] - 1.0).norm() < 1e-9, "{hertz} Hz");
        assert!((found[(0, 0)] / (hub[k] * tip[k]) - 1.0).norm() < 1e-9, "{hertz} Hz");
    }
    let hanging = "modes link.toml --count 2 --set gravity=[0,-9.81] --at=-1.2 --set damping.alpha=0 --residual --state-space";
    for (file, head) in [("pose.npz", &b"PK"[..]), ("pose.mat", b"MATLAB 5.0")] {
        bench.done(&format!("{hanging} {file}"));
        assert!(std::fs::read(bench.path(file)).unwrap().starts_with(head), "{file}");
    }
    bench.refuses(2, "modes link.toml --state-space s.csv", "must end in .npz, .mat or .json");
    let upright = "modes specs/carriages/sheet.toml --state-space s.json";
    let modal = "--set damping={model='modal',ratios=[0.02,0.01]}";
    bench.refuses(
        4,
        &format!("{upright} {modal}"),
        "the ratios of modal damping are those without weight",
    );
    bench.refuses(2, "modes link.toml --state-space s.json --stations 1.2", "--stations = 1.2 m");
    bench.refuses(2, "modes link.toml --residual", "--state-space");
    bench.refuses(2, "modes link.toml --state-space link.toml", "must end in");
}

#[test]
fn a_link_with_a_drive_also_has_the_modes_of_the_held_rotor() {
    let bench = Bench::new();
    let modes = "modes specs/rome_link.toml --set mesh.elements=200 --count 3 -o m";
    let text = bench.printed(modes);
    let (free, block) = text.split_once("rotor held, joint spring 1000 N m/rad\n").unwrap();
    assert!(free.contains("damping") && free.contains("zero"), "{text}");
    let rows: Vec<Vec<&str>> =
        block.lines().skip(1).map(|row| row.split_whitespace().collect()).collect();
    assert_eq!(bench.names("m"), TABLES);
    assert_eq!(bench.rows("m/held_modes.csv")[0], COLUMNS);
    let table = bench.table("m/held_modes.csv");
    assert_eq!((rows.len(), table[0].1.as_slice()), (3, &[1.0, 2.0, 3.0][..]));
    for (k, squared) in [34.14, 1383.24, 11_084.49].into_iter().enumerate() {
        let [omega, hertz, period] = [1, 2, 3].map(|column| table[column].1[k]);
        assert!((omega * omega - squared).abs() < 0.005, "{omega}² is not {squared}");
        assert!((hertz * TAU / omega - 1.0).abs() < 1e-9);
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
        let text = bench.printed("modes link.toml --count 3 -o m");
        assert!(text.contains(&format!("\n{heading}\nmode ")), "{text}");
        let omega = bench.numbers("m/held_modes.csv", "omega_rad_s");
        assert_eq!(omega.len(), 3);
        for (omega, b) in omega.iter().zip([1.875_104_069, 4.694_091_133, 7.854_757_438_f64]) {
            assert!((omega / (b * b) - 1.0).abs() < 1e-6, "{omega} is not {b}²");
        }
    }
}

#[test]
fn a_payload_inertia_blocks_the_tip_at_a_frequency_that_is_told() {
    let text = Bench::new().printed(&format!("modes {LINK} --set payload.inertia=0.05"));
    assert!(text.contains(" Hz no torque moves the tip (mesh error "), "{text}");
}

#[test]
fn an_automatic_mesh_is_refined_for_the_modes_asked_for() {
    let bench = Bench::new();
    bench.write("link.toml", "segments = [{ length = 1, EI = 1, mass_per_length = 1 }]\n");
    bench.done("modes link.toml --count 20 -o m");
    // Pinned and free: tan b = tanh b, which is (k + 1/4)π from the third on to nine digits.
    let omega = bench.numbers("m/modes.csv", "omega_rad_s");
    assert_eq!(omega.len(), 20);
    for (mode, omega) in omega.iter().enumerate().skip(2) {
        let exact = ((mode as f64 + 1.25) * PI).powi(2);
        assert!((omega / exact - 1.0).abs() < 1e-6, "mode {mode}: {omega} is not {exact}");
    }
}

/// Uniform links of few elements against closed forms, after the coarse mesh of solve.
#[test]
fn the_mesh_error_of_each_number_is_what_it_is_wrong_by() {
    let bench = Bench::new();
    let uniform = "segments = [{ length = 1, EI = 1, mass_per_length = 1 }]\n";
    bench.write("link.toml", &format!("{uniform}mesh.elements = 8\n[drive]\n"));
    let told = bench.told("modes link.toml --count 6 -o m");
    let free =
        [3.926_602_312, 7.068_582_746, 10.210_176_12, 13.351_768_78, 16.493_361_43, 6.25 * PI];
    let clamped =
        [1.875_104_069, 4.694_091_133, 7.854_757_438, 10.995_540_73, 14.137_168_39, 5.5 * PI];
    let squared = |roots: [f64; 6]| roots.map(|root| root * root).to_vec();
    for (name, column, exact) in [
        ("modes", "omega_rad_s", squared(free)),
        ("held_modes", "omega_rad_s", squared(clamped)),
        ("zeros", "zero_per_s", vec![11.186_642_72, 60.451_695_86, 149.277_767_6]),
    ] {
        let [found, errors] =
            [column, "mesh_error"].map(|column| bench.numbers(&format!("m/{name}.csv"), column));
        for (k, exact) in exact.iter().enumerate() {
            let (error, told) = ((found[k] / exact - 1.0).abs(), errors[k]);
            let worst = if error > 1e-2 { 0.3 } else { 0.1 };
            assert!((told / error - 1.0).abs() < worst, "{name} {k}: {told:e} for {error:e}");
        }
    }
    let expected = "warning: from mode 5 on the mesh is wrong by more than 1 %, at the worst by ";
    assert!(told.starts_with(expected), "{told}");
}

#[test]
fn a_massless_link_has_the_modes_of_its_bodies_and_no_more() {
    let bench = Bench::new();
    let segment = "segments = [{ length = 1.5, EI = 5, mass_per_length = 0 }]";
    bench.write("link.toml", &format!("{segment}\nhub.inertia = 0.1\npayload.mass = 1\n"));
    let text = bench.printed("modes link.toml -o m");
    assert!(text.contains("0.61480"), "{text}");
    assert_eq!(bench.cells("m/modes.csv", "mode"), ["1"]);
    assert_eq!(bench.rows("m/zeros.csv").len(), 1, "no zero");
}

#[test]
fn the_frequency_response_has_three_transfers_in_four_parts() {
    let bench = Bench::new();
    let band = "--from 0.5 --to 20 --points 7 -o new/frf.csv";
    assert_eq!(bench.printed(&format!("frf {LINK} {band}")), "");
    let table = bench.table("new/frf.csv");
    assert_eq!((table.len(), table[0].1.len()), (14, 7));
    assert_eq!((table[0].1[0], table[0].1[6]), (0.5, 20.0));
    let of = |name: &str| bench.numbers("new/frf.csv", name);
    let [re, im, size, phase] = ["real", "imag", "magnitude", "phase_rad"]
        .map(|part| of(&format!("torque_per_tip_acceleration_kg_m_{part}")));
    let tip = of("tip_displacement_per_torque_1_n_magnitude");
    for k in 0..7 {
        assert!((size[k] - re[k].hypot(im[k])).abs() < 1e-12);
        assert!((phase[k] - im[k].atan2(re[k])).abs() < 1e-12);
        // v/T = −1/(ω² T/a)
        let omega = TAU * table[0].1[k];
        assert!((tip[k] * omega * omega * size[k] - 1.0).abs() < 1e-12);
    }
}

/// Coarse against fine, at frequencies between the poles and near them.
#[test]
fn the_mesh_error_of_a_response_is_what_a_fine_mesh_shows_and_is_told() {
    let bench = Bench::new();
    let run = |rest: &str| {
        let output = bench.done(&format!("frf {LINK} --from 1 --to 30 --points 60 -o {rest}"));
        assert_eq!(stdout(&output), "");
        stderr(&output)
    };
    let told = run("coarse.csv");
    let finer = run("fine.csv --set mesh.elements=320");
    assert!(finer.starts_with("note: the mesh error is "), "{finer}");
    let column = |name: &str| ["coarse.csv", "fine.csv"].map(|file| bench.numbers(file, name));
    let transfers = ["torque_per_tip_acceleration_kg_m", "hub_angle_per_tip_displacement_rad_m"]
        .map(|name| ["real", "imag", "magnitude"].map(|part| column(&format!("{name}_{part}"))));
    let [hertz, _] = column("frequency_hz");
    let [claimed, _] = column("mesh_error");
    let mut worst = (0.0, 0.0_f64);
    for (k, claimed) in claimed.iter().enumerate() {
        let errors = transfers.each_ref().map(|[re, im, size]| {
            (re[0][k] - re[1][k]).hypot(im[0][k] - im[1][k]) / size[0][k].max(size[1][k])
        });
        let error = errors[0].max(errors[1]);
        assert!((claimed / error - 1.0).abs() < 0.2, "row {k}: {claimed:e} for {error:e}");
        worst = if error > worst.1 { (hertz[k], error) } else { worst };
    }
    assert!(worst.1 > 1e-2, "{worst:?}");
    let below = hertz[claimed.iter().position(|error| *error > 1e-2).unwrap() - 1];
    let expected =
        format!("warning: above {below:.2} Hz the mesh is wrong by more than 1 %, at the");
    assert!(told.starts_with(&expected), "{told} for {expected}");
    let at = format!("at {:.2} Hz (elements halved)\n", worst.0);
    assert!(told.contains(&at), "{told} {worst:?}");
}

#[test]
fn an_undamped_response_has_no_number_that_is_none() {
    let bench = Bench::new();
    bench.done(&format!("frf {LINK} --set damping.ratio=0 --linear --points 3000 -o frf.csv"));
    for (name, values) in bench.table("frf.csv") {
        assert!(values.len() == 3000 && values.iter().all(|value| value.is_finite()), "{name}");
    }
}
