//! `trajectory --shape` and `--quiet-at`: motions that leave a link at rest whose stiffness is off by some percent.

use std::f64::consts::{PI, TAU};

use flexlink::motion::{Excitation, Profile};

use super::{Bench, column, json_of, number, stderr, succeeded};

const ARM: &str = "specs/arms/two_links.toml";

/// A steel sheet of 0.52 × 0.08 × 0.001 m on a carriage, without weight.
const SHEET: &str = "[carriage]\nmass = 1.0\n[[segments]]\nlength = 0.52\nEI = 1.2666666666666667\n\
                     mass_per_length = 0.6296\n[damping]\nratio = 0.005\n";

/// A mass on a nearly massless strip: one mode.
const ONE_MODE: &str = "[carriage]\nmass = 1.0\n[[segments]]\nlength = 0.5\nEI = 1.0\n\
                        mass_per_length = 1e-4\n[payload]\nmass = 0.2\n";

fn bench(link: &str) -> Bench {
    let bench = Bench::new();
    bench.write("link.toml", link);
    bench
}

/// Messages of `trajectory`.
fn made(bench: &Bench, options: &str) -> String {
    stderr(&succeeded(bench.run(&format!("trajectory {options}"))))
}

/// Held and free frequency of the first mode in rad/s.
fn first_rad_s(bench: &Bench, link: &str) -> [f64; 2] {
    let found = json_of(&bench.run(&format!("modes {link} --count 2 --json")));
    ["held/frequency_hz/0", "frequency_hz/0"].map(|key| TAU * number(&found, key))
}

/// Half of the range of a column in a period after a time.
fn vibration(bench: &Bench, table: &str, name: &str, [from_s, period_s]: [f64; 2]) -> f64 {
    let (time_s, values) = (column(bench, table, "time_s"), column(bench, table, name));
    let own = time_s
        .iter()
        .zip(&values)
        .filter(|(time_s, _)| (from_s - 1e-9..=from_s + period_s + 1e-9).contains(*time_s));
    let (low, high) = own
        .fold((f64::MAX, f64::MIN), |(low, high), (_, value)| (low.min(*value), high.max(*value)));
    0.5 * (high - low)
}

#[test]
fn a_shaped_base_motion_leaves_what_the_closed_forms_say() {
    let bench = bench(ONE_MODE);
    let [omega_rad_s, _] = first_rad_s(&bench, "link.toml");
    // k = 3EI/L³ of a massless strip.
    assert!((omega_rad_s / (24.0_f64 / 0.2).sqrt() - 1.0).abs() < 1e-3, "{omega_rad_s}");
    let septic = "septic --distance 0.1 --duration 0.4 --step 0.002";
    let kinds = [("", 0.0), ("--shape zv --of held", 0.5), ("--shape zvd --of held", 1.0)];
    let mut left = Vec::new();
    for (options, periods) in kinds {
        // The base takes the motion itself.
        let base = if options.is_empty() {
            let row = |k: u32| {
                let place_m = 0.1 * Profile::Septic.share(f64::from(k) / 200.0);
                format!("{:.3},{place_m:e}\n", 0.002 * f64::from(k))
            };
            "time,carriage\n".to_owned() + &(0..=200).map(row).collect::<String>()
        } else {
            made(&bench, &format!("{septic} --link link.toml {options} -o base.csv"));
            bench.read("base.csv").replace("displacement", "carriage")
        };
        bench.write("base.csv", &base);
        let end_s = 0.4 + periods * TAU / omega_rad_s + 0.002;
        for r in [0.8_f64, 0.9, 1.0, 1.1, 1.2] {
            let set = format!("--set segments.*.EI={:e}", r * r);
            bench.done(&format!(
                "simulate link.toml base.csv --input carriage {set} --until 3 -o out"
            ));
            let window = [end_s, TAU / (r * omega_rad_s)];
            left.push(vibration(&bench, "out/tip.csv", "tip_displacement_m", window));
        }
    }
    for (k, r) in [0.8, 0.9, 1.0, 1.1, 1.2].into_iter().enumerate() {
        let cos = f64::cos(0.5 * PI * r).abs();
        for (found, known) in [(left[5 + k], cos), (left[10 + k], cos * cos)] {
            let found = found / left[k];
            assert!((found - known).abs() < 1e-3, "{r}: {found} is not {known}");
        }
    }
}

/// Rest vibration of the sheet in % of the travel, played at the positions of the carriage that its nominal inverse computes,
/// with these factors on EI.
fn rest_vibrations(bench: &Bench, options: &str, factors: &[f64]) -> (f64, Vec<f64>) {
    let move_m = "min-jerk --distance 0.2 --step 0.001 --link link.toml -o move.csv";
    made(bench, &format!("{move_m} {options}"));
    let end_s = column(bench, "move.csv", "time").last().copied().unwrap();
    bench.done("solve link.toml move.csv -o solved");
    let [omega_rad_s, _] = first_rad_s(bench, "link.toml");
    let left = factors.iter().map(|factor| {
        let set = format!("--set segments.*.EI*={factor}");
        bench
            .done(&format!("simulate link.toml solved/carriage.csv --input carriage {set} -o out"));
        let window = [end_s, TAU / (omega_rad_s * factor.sqrt())];
        100.0 * vibration(bench, "out/tip.csv", "tip_displacement_m", window) / 0.2
    });
    (end_s, left.collect())
}

#[test]
fn the_inverse_of_a_shaped_motion_leaves_little_where_the_stiffness_is_off() {
    let bench = bench(SHEET);
    let factors = [0.8, 0.9, 0.95, 1.0, 1.05, 1.1, 1.2];
    // Computed by a separate program.
    let rows = [
        ("zv", 0.61, [1.16, 0.23, 0.05, 0.0, 0.05, 0.17, 0.51]),
        ("zvd", 0.78, [0.19, 0.02, 0.01, 0.0, 0.01, 0.02, 0.07]),
    ];
    for (shaper, duration_s, known) in rows {
        let options = format!("--duration 0.44 --shape {shaper} --of held");
        let (end_s, found) = rest_vibrations(&bench, &options, &factors);
        assert!((end_s - duration_s).abs() < 0.005, "{shaper}: {end_s}");
        for ((found, known), factor) in found.iter().zip(known).zip(factors) {
            assert!((found - known).abs() < 0.1, "{shaper}, EI × {factor}: {found} is not {known}");
        }
    }
}

#[test]
fn a_quiet_duration_is_a_zero_of_the_motion_at_the_mode() {
    let bench = bench(SHEET);
    let (end_s, found) = rest_vibrations(&bench, "--quiet-at held", &[0.9, 1.1]);
    assert!((end_s - 0.625).abs() < 1e-9, "{end_s}");
    for (found, known) in found.iter().zip([0.25, 0.19]) {
        assert!((found - known).abs() < 0.1, "{found} is not {known}");
    }
    // Within a limit it is a later zero: the first whose force keeps it.
    let limited = "min-jerk --distance 0.2 --step 0.001 --link link.toml --fit-limit force=1";
    let told = made(&bench, &format!("{limited} --quiet-at held -o move.csv"));
    let end_s = column(&bench, "move.csv", "time").last().copied().unwrap();
    assert!(
        told.starts_with(&format!(
            "note: {end_s} s, the shortest quiet duration within force=1 N\n"
        ))
    );
    let [omega_rad_s, _] = first_rad_s(&bench, "link.toml");
    let excitation = Excitation::of(Profile::MinJerk);
    let zeros = excitation.quiet_phases(100.0).map(|phase| phase / omega_rad_s);
    let zeros: Vec<f64> = zeros.map(|zero_s| (1e3 * zero_s).round() / 1e3).collect();
    let own = zeros.iter().position(|zero_s| (zero_s - end_s).abs() < 1e-9).unwrap();
    assert!(own > 0, "{end_s}");
    for (zero_s, fits) in [(zeros[own - 1], false), (end_s, true)] {
        let given = format!("--distance 0.2 --step 0.001 --duration {zero_s}");
        bench.done(&format!("trajectory min-jerk {given} -o move.csv"));
        bench.done("solve link.toml move.csv -o solved");
        let peak_n = bench.number("solved", "results/peak_force_n");
        assert_eq!(peak_n < 1.0, fits, "{zero_s}: {peak_n}");
    }
}

#[test]
fn modes_without_a_use_and_steps_longer_than_a_shaper_are_refused() {
    let bench = bench(SHEET);
    let own = "trajectory min-jerk --distance 0.2 --duration 0.44 --step 0.01 --link link.toml";
    bench.refuses(2, &format!("{own} --modes 2"), "--modes has an effect only with --shape");
    bench.refuses(2, &format!("{own} --shape zv --of held --modes 1,1"), "--modes = 1 twice");
    let uncertain = format!("{own} --shape zv --of held --uncertain segments.*.EI*=±5%");
    bench.refuses(2, &uncertain, "--uncertain has an effect only with --quiet-at");
    // Mode 3 of a cantilever: 2.9 Hz × (7.8548/1.8751)², half a period of 9.9 ms.
    let third = format!("{own} --shape zv --of held --modes 3");
    bench.refuses(2, &third, "is longer than zv for mode 3");
    bench.done(&third.replace("0.01", "0.005"));
}

/// |A(ω)|/ω of a min-jerk motion over its travel: a Riemann sum of its velocity 30 s²(1 − s)² times the phase.
fn min_jerk_amplitude(phase: f64) -> f64 {
    let steps = 20_000;
    let sum = |part: fn(f64) -> f64| {
        let at = |k: u32| {
            let s = (f64::from(k) + 0.5) / f64::from(steps);
            30.0 * (s * (1.0 - s)).powi(2) * part(phase * s)
        };
        (0..steps).map(at).sum::<f64>() / f64::from(steps)
    };
    sum(f64::cos).hypot(sum(f64::sin))
}

#[test]
fn a_quiet_duration_with_intervals_has_the_least_worst_case_beside_the_zero() {
    let bench = bench(SHEET);
    let [omega_rad_s, _] = first_rad_s(&bench, "link.toml");
    let quiet = "min-jerk --distance 0.2 --step 0.001 --link link.toml --quiet-at held -o move.csv";
    let ends = |factors: [f64; 2], duration_s: f64| {
        let of = |factor: f64| min_jerk_amplitude(omega_rad_s * factor.sqrt() * duration_s);
        factors.map(of).into_iter().fold(0.0, f64::max)
    };
    for (options, factors) in [
        ("--uncertain segments.*.EI*=±15%", [0.85, 1.15]),
        ("--uncertain segments.*.EI*=0.7..1.1", [0.7, 1.1]),
        ("--uncertain segments.*.EI*=0.9..1.4 --uncertain delay=0..1ms", [0.9, 1.4]),
    ] {
        let told = made(&bench, &format!("{quiet} {options}"));
        let end_s = column(&bench, "move.csv", "time").last().copied().unwrap();
        let (own, beside) = (ends(factors, end_s), [-0.001, 0.001, 0.625 - end_s]);
        for more_s in beside.into_iter().filter(|more_s| more_s.abs() > 1e-9) {
            assert!(own < ends(factors, end_s + more_s), "{options}: {end_s} + {more_s}");
        }
        let (_, rest) = told.split_once("|A|/ω is at most, in the intervals, ").unwrap();
        let (left, _) = rest.split_once(" % of the travel").unwrap();
        let left: f64 = left.parse().unwrap();
        assert!((left / (100.0 * own) - 1.0).abs() < 0.01, "{options}: {left}, {own}");
    }
    // The table of the file counts as the options do.
    let table = "[uncertainty]\n\"segments.*.EI*\" = \"±15%\"\n";
    bench.write("file.toml", &format!("{SHEET}{table}"));
    let of_file = made(&bench, &quiet.replace("link.toml", "file.toml"));
    assert_eq!(of_file, made(&bench, &format!("{quiet} --uncertain segments.*.EI*=±15%")));
    let told = made(&bench, quiet);
    // Standard input is read once, for the link and for its intervals.
    let fed = bench.fed(SHEET, &format!("trajectory {}", quiet.replace("link.toml", "-")));
    assert_eq!(stderr(&succeeded(fed)), told);
    assert!(told.contains("|A|/ω is ") && !told.contains("intervals"), "{told}");
}

#[test]
fn the_shortest_shaped_motion_keeps_the_limit_and_none_shorter_does() {
    let bench = bench(SHEET);
    let shaped = "min-jerk --distance 0.2 --step 0.002 --link link.toml --shape zv --of held";
    let told = made(&bench, &format!("{shaped} --fit-limit force=3 -o fit.csv"));
    let (duration, rest) = told.strip_prefix("note: ").unwrap().split_once(" s, ").unwrap();
    assert!(
        rest.starts_with("the shortest duration within force=3 N; limits.force binds: "),
        "{told}"
    );
    let duration_s: f64 = duration.parse().unwrap();
    let (mut peaks, mut texts) = (Vec::new(), Vec::new());
    for less in [0.002, 0.0] {
        let duration = format!("--duration {:.3}", duration_s - less);
        made(&bench, &format!("{shaped} {duration} -o exact.csv"));
        bench.done("solve link.toml exact.csv -o solved");
        peaks.push(bench.number("solved", "results/peak_force_n"));
        texts.push(bench.read("exact.csv"));
    }
    assert!(peaks[0] > 3.0 && peaks[1] <= 3.0, "{peaks:?}");
    let below = |text: &str| text.split_once("time,").unwrap().1.to_owned();
    assert_eq!(below(&bench.read("fit.csv")), below(&texts[1]));
    // Lead and lag are those of solve.
    let [lead_s, lag_s] =
        ["lead_s", "lag_s"].map(|key| bench.number("solved", &format!("results/{key}")));
    let (_, rest) = told.split_once("the force starts ").unwrap();
    let (lead, rest) = rest.split_once(" s before the motion, and it ends ").unwrap();
    let (lag, _) = rest.split_once(" s after it").unwrap();
    let [lead, lag] = [lead, lag].map(|text| text.parse::<f64>().unwrap());
    assert!(
        (lead - lead_s).abs() < 1e-3 && (lag - lag_s).abs() < 1e-3,
        "{told}, {lead_s}, {lag_s}"
    );
}

#[test]
fn the_modes_are_those_that_modes_prints() {
    let bench = bench(
        "[hub]\ninertia = 0.1\n[[segments]]\nlength = 1.2\nEI = 5.0\nmass_per_length = 0.8\n\
                       [damping]\nmodel = \"rayleigh\"\nbeta = 1e-3\n[drive]\njoint_stiffness = 40.0\n\
                       rotor_inertia = 1e-4\ngear_ratio = 10\n",
    );
    let septic = "septic --distance 0.3 --duration 0.8 --step 0.004 --shape zvd";
    let (mast, sheet) = ("specs/carriages/stacker_mast.toml", "specs/carriages/sheet.toml");
    // With weight both tables of modes have a name.
    for (link, free) in [("link.toml", ""), (mast, ""), (sheet, "free/")] {
        let found = json_of(&bench.run(&format!("modes {link} --count 2 --json")));
        for (state, key) in [("held", "held/"), ("free", free)] {
            let told =
                made(&bench, &format!("{septic} --link {link} --of {state} --modes 2 -o m.csv"));
            let (_, rest) = told.split_once(&format!("zvd for {state} mode 2, ")).unwrap();
            let (hertz, _) = rest.split_once(" Hz, damping ratio ").unwrap();
            let (hertz, known): (f64, f64) =
                (hertz.parse().unwrap(), number(&found, &format!("{key}frequency_hz/1")));
            assert!((hertz / known - 1.0).abs() < 1e-3, "{link}, {state}: {hertz} is not {known}");
            let period_s = column(&bench, "m.csv", "time").last().unwrap() - 0.8;
            assert!((0.0..0.004).contains(&(period_s - 1.0 / known)), "{link}: {period_s}");
        }
    }
}

#[test]
fn each_move_of_a_cycle_is_shaped() {
    let bench = bench(SHEET);
    let cycle = "--distance 0.2 --via 0.1 --cycle --dwell 0.1 --duration 0.6 --step 0.01";
    let shaped = "--link link.toml --shape zvd --of held";
    let told = made(&bench, &format!("trapezoid {cycle} {shaped} -o cycle.csv"));
    let places_m = column(&bench, "cycle.csv", "displacement");
    // Moves of 30 steps, the period of 0.3407 s in 35, rests of 10: four times.
    assert_eq!(places_m.len(), 4 * (30 + 35 + 10), "{told}");
    assert!(told.contains("each move lasts 0.3407 s longer, 3 s in all\n"), "{told}");
    for (rest, known_m) in [(65, 0.1), (140, 0.2), (215, 0.1), (290, 0.0)] {
        let own = &places_m[rest..rest + 10];
        assert!(own.iter().all(|place_m| (place_m - known_m).abs() < 1e-15), "{rest}: {own:?}");
    }
    // The way back is shaped as the way there: the same places less the travel, not the reversed ones.
    for k in 0..65 {
        assert!((places_m[75 + k] - 0.1 - places_m[k]).abs() < 1e-12, "{k}");
        assert!((0.2 - places_m[150 + k] - places_m[k]).abs() < 1e-12, "{k}");
    }
    bench.done("solve link.toml cycle.csv --periodic -o out");
}

#[test]
fn the_path_of_an_arm_is_shaped_along_its_length() {
    let bench = Bench::new();
    let line = "septic --path line --from 0.9,-0.5 --to 0.5,0.8 --duration 1.5 --step 0.004";
    let told = made(&bench, &format!("{line} --link {ARM} --shape zv --of held -o path.csv"));
    let (_, rest) = told.split_once("zv for held mode 1, ").unwrap();
    let (hertz, rest) = rest.split_once(" Hz (the middle of ").unwrap();
    let (range, rest) = rest.split_once(" Hz on the way)").unwrap();
    let range: Vec<f64> = range.split(" to ").map(|own| own.parse().unwrap()).collect();
    let middle: f64 = hertz.parse().unwrap();
    assert!((middle - 0.5 * (range[0] + range[1])).abs() < 2e-3 && range[0] < range[1], "{told}");
    // The largest remainder is that at both ends of the range: cos(πr/2), nearly.
    let (_, rest) = rest.split_once("on the way it leaves at most ").unwrap();
    let (left, _) = rest.split_once(" % of a mode's vibration").unwrap();
    let known = 100.0 * f64::cos(0.5 * PI * range[1] / middle).abs();
    assert!((left.parse::<f64>().unwrap() - known).abs() < 0.1, "{left} is not {known}");
    // All places are on the line, those of a half-half sum of the profile and the delayed one, nearly.
    let [x, y] = ["x", "y"].map(|name| column(&bench, "path.csv", name));
    let half_s = 0.5 / middle;
    for (k, (x, y)) in (0..).zip(x.iter().zip(&y)) {
        let gone = (0.9 - x) / 0.4;
        assert!((gone - (y + 0.5) / 1.3).abs() < 1e-12, "{k}");
        let time_s = 0.004 * f64::from(k);
        let share = |time_s: f64| Profile::Septic.share((time_s / 1.5).clamp(0.0, 1.0));
        let known = 0.5 * (share(time_s) + share(time_s - half_s));
        assert!((gone - known).abs() < 2e-3, "{k}: {gone} is not {known}");
    }
    assert_eq!((x.last(), y.last()), (Some(&0.5), Some(&0.8)));
    // The carriage goes along.
    let line = "septic --path line --from 0.5,-0.9 --to 1.9,-0.6 --carriage 0,0.8 --step 0.004";
    let shaped = "--duration 1.5 --link specs/carriages/gantry_arm.toml --shape ei --of held";
    made(&bench, &format!("{line} {shaped} -o path.csv"));
    let [x, carriage] = ["x", "carriage"].map(|name| column(&bench, "path.csv", name));
    let apart = |(x, carriage): (&f64, &f64)| ((x - 0.5) / 1.4 - carriage / 0.8).abs();
    assert!(x.iter().zip(&carriage).map(apart).all(|own| own < 1e-12));
}
