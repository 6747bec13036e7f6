//! What `flexlink simulate` refuses and warns of; most words of refusals are in tests/refusals.

use std::f64::consts::PI;

use super::{Bench, LINK, apart, no_such_file, peak, said, simulated, stderr, stdout, succeeded};

const TORQUE: &str = "time,torque\n0,0\n0.01,1\n0.02,1\n0.03,0\n";

/// A bench with a torque of four samples, a target and a hub motion at its times.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("torque.csv", TORQUE);
    bench.write("tip.csv", "time,displacement\n0,0\n0.01,0\n0.02,0.001\n0.03,0.002\n");
    bench.write("hub.csv", "time,hub_angle\n0,0\n0.01,0\n0.02,0.001\n0.03,0.001\n");
    bench
}

/// Plays, which must fail with `code`; nothing is printed or written. Error and hint.
#[track_caller]
fn failed(bench: &Bench, arguments: &str, code: i32) -> String {
    let output = bench.ends(code, &format!("simulate {LINK} {arguments}"));
    assert_eq!(stdout(&output), "");
    assert!(!bench.path("simulated").exists(), "nothing is left behind");
    stderr(&output)
}

#[test]
fn a_refusal_leaves_nothing_behind() {
    let bench = bench();
    bench.write("huge.csv", "time,torque\n0,0\n0.01,1e308\n0.02,1e308\n0.03,0\n");
    failed(&bench, "torque.csv --until 0.02", 2);
    failed(&bench, "huge.csv", 4);
    let absent = format!("error: none.csv: cannot read: {}\n", no_such_file());
    for options in ["--target none.csv", "--feedback 1,1 --reference none.csv"] {
        assert_eq!(failed(&bench, &format!("torque.csv {options}"), 3), absent);
    }
    let error = failed(&bench, "torque.csv -o tip.csv", 5);
    let exists = said(std::fs::create_dir(bench.path("tip.csv")));
    assert_eq!(error, format!("error: tip.csv: cannot create the folder: {exists}\n"));
}

#[test]
fn the_folder_of_an_input_is_refused_however_it_is_written() {
    let bench = bench();
    std::fs::create_dir(bench.path("run")).unwrap();
    bench.write("run/tip.csv", &bench.read("tip.csv"));
    for output in ["run", "./run/", "run/../run"] {
        let error = failed(&bench, &format!("torque.csv --target run/tip.csv -o {output}"), 2);
        let message = "but must be another folder than that of run/tip.csv\n";
        assert!(error.starts_with(&format!("error: --output = {output}, {message}")), "{error}");
    }
    assert_eq!(bench.names("run"), ["tip.csv"]);
}

#[test]
fn a_dash_reads_the_torque_from_standard_input() {
    let bench = bench();
    simulated(&bench, "torque.csv -o file");
    succeeded(bench.fed(TORQUE, &format!("simulate {LINK} - -o piped")));
    assert!(bench.read("piped/tip.csv") == bench.read("file/tip.csv"));
    assert_eq!(bench.json("piped/summary.json")["inputs"]["torque"]["name"], "-");
}

#[test]
fn jumps_at_the_ends_a_coarse_step_and_a_late_target_are_told() {
    let bench = bench();
    let jump = "hint: use a torque that begins and ends at zero, as that of solve for an uncut window and a tip at rest";
    bench.write("step.csv", "time,torque\n0,1\n0.01,-2\n0.02,1\n0.03,0.5\n");
    let told = stderr(&simulated(&bench, "step.csv"));
    let expected = format!(
        "warning: the torque begins with 1.0 N m, 50.0 % of its peak: it acts on the resting link \
         as a jump\n{jump}\nwarning: the torque ends with 0.5 N m, 25.0 % of its peak: it drops to \
         zero there\n{jump}\nwarning: mesh and modes make the tip wrong by "
    );
    assert!(told.starts_with(&expected), "{told}");
    bench.write("coarse.csv", "time,torque\n0,0\n0.1,0.01\n0.2,0.01\n0.3,0\n");
    let expected = "warning: the step of 0.1 s leaves 5.3 steps to a period of the first mode, 0.5264 s: the rows do \
                    not show its vibration\n\
                    hint: use a torque with a shorter step\n";
    assert_eq!(stderr(&simulated(&bench, "coarse.csv")), expected);
    bench.write("late.csv", "time,displacement\n0.2,1e-3\n0.3,2e-3\n0.4,3e-3\n0.5,4e-3\n");
    let told = stderr(&simulated(&bench, "torque.csv --target late.csv"));
    assert!(told.starts_with("warning: the target begins at 0.2 s, when the tip has moved by"));
    assert!(told.ends_with("hint: use a target that begins before the tip moves\n"), "{told}");
    let warnings = &bench.json("simulated/summary.json")["warnings"];
    assert_eq!(warnings[0]["kind"], "late_target");
}

/// Pinned link without damping or inertia of its hub, and a torque of zero that lets it go from where it is held, chord
/// level.
fn let_go(bench: &Bench, ei_n_m2: f64) {
    let link = format!("segments = [{{ length = 1.0, EI = {ei_n_m2}, mass_per_length = 0.3 }}]\n");
    bench.write("pinned.toml", &format!("gravity = [0, -9.81]\nstart_angle = 0.0\n{link}"));
    bench.sampled("torque.csv", "time,torque", 0..40, |k| [0.001 * k, 0.0]);
}

/// The tip's displacement in m and the hub's angle in rad of the link of [`let_go`] at small deflections: its held shape
/// is a sum of the modes of a pinned and free beam, which fall each by itself.
///
/// ```text
/// m v'' + EI v'''' = −m g,   v = x q₀ + Σ qₖ φₖ,   φ = sin βx + sin β sinh βx / sinh β,   tan β = tanh β,   L = 1
/// ```
fn falling(ei_n_m2: f64, times_s: &[f64]) -> [Vec<f64>; 2] {
    const MODES: u32 = 80;
    const PLACES: u32 = 4000;
    let load_m_s2 = -9.81;
    let held = |x: f64| {
        let sag = |x: f64| 0.3 * load_m_s2 / (24.0 * ei_n_m2) * x * x * (x * (x - 4.0) + 6.0);
        sag(x) - x * sag(1.0)
    };
    // Simpson's rule.
    let integral = |of: &dyn Fn(f64) -> f64| {
        let weight = |k: u32| match k {
            0 | PLACES => 1.0,
            _ => 2.0 + 2.0 * f64::from(k % 2),
        };
        let place = |k: u32| f64::from(k) / f64::from(PLACES);
        (0..=PLACES).map(|k| weight(k) * of(place(k))).sum::<f64>() / (3.0 * f64::from(PLACES))
    };
    let turned = 3.0 * integral(&|x| x * held(x));
    let rigid = times_s.iter().map(|t| turned + 0.75 * load_m_s2 * t * t).collect::<Vec<f64>>();
    let mut found = [rigid.clone(), rigid];
    for mode in 1..=MODES {
        let [mut low, mut high] = [0.0, 0.5].map(|part| PI * (f64::from(mode) + part));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let is_above = middle.tan() > middle.tanh();
            (low, high) = if is_above { (low, middle) } else { (middle, high) };
        }
        let beta = 0.5 * (low + high);
        let left = 1.0 - (-2.0 * beta).exp();
        let rises = |x: f64| (beta * (x - 1.0)).exp() * (1.0 - (-2.0 * beta * x).exp()) / left;
        let shape = |x: f64| (beta * x).sin() + beta.sin() * rises(x);
        let size = integral(&|x| shape(x) * shape(x));
        let first = integral(&|x| shape(x) * held(x)) / size;
        let omega = beta * beta * (ei_n_m2 / 0.3).sqrt();
        let hangs = load_m_s2 * integral(&shape) / size / (omega * omega);
        let slope = beta * (1.0 + beta.sin() * 2.0 * (-beta).exp() / left);
        for (own, by) in found.iter_mut().zip([shape(1.0), slope]) {
            for (value, t) in own.iter_mut().zip(times_s) {
                *value += by * (hangs + (first - hangs) * (omega * t).cos());
            }
        }
    }
    found
}

#[test]
fn an_undamped_link_that_is_let_go_falls_as_its_modes_do_within_what_is_stated() {
    let bench = Bench::new();
    let_go(&bench, 150.0);
    bench.done("simulate pinned.toml torque.csv -o free");
    let tables = ["tip", "hub_angle"].map(|name| bench.table(&format!("free/{name}.csv")));
    let stated =
        ["tip", "hub_angle"].map(|name| bench.number("free", &format!("errors/{name}/refinement")));
    let expected = falling(150.0, &tables[0][0].1);
    for ((own, expected), stated) in tables.iter().zip(&expected).zip(stated) {
        let (off, peak) = (apart(&own[1].1, expected), peak(expected));
        // Refinements converge slowly after the jump: the last change is about half of what is left.
        assert!(off < 2.0 * stated * peak, "{off} of {peak}, stated {stated}");
        assert!(off < 1e-2 * peak, "{off} of {peak}");
    }
}

#[test]
fn undamped_links_that_bend_far_are_let_go_and_what_is_left_is_told() {
    let bench = Bench::new();
    let_go(&bench, 1.5);
    let short = "segments = [{ length = 0.5, EI = 10.0, mass_per_length = 0.4 }]\n";
    let links = format!("[[links]]\nname = 'a'\n{short}[[links]]\nname = 'b'\n{short}");
    bench.write("double.toml", &format!("gravity = [0, -9.81]\n{links}"));
    bench.sampled("torques.csv", "time,torque1,torque2", 0..40, |k| [0.001 * k, 0.0, 0.0]);
    let mut told = String::new();
    for inputs in ["pinned.toml torque.csv -o pinned", "double.toml torques.csv --at 0,0 -o double"]
    {
        told = bench.told(&format!("simulate {inputs}"));
        assert!(told.contains("the last refinement still changes"), "{told}");
    }
    // Radau's method damps the waves that its steps do not resolve: that is told, too.
    let energy = bench.number("double", "errors/energy");
    assert!(energy < 3e-2, "{energy}");
    assert!(energy < 1e-3 || told.contains("work and energy differ"), "{told}");
}
