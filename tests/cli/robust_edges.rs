//! What `robust` says at its edges: idle keys, small samples, waves that stay, errors of the nominal link.

use super::{Bench, LINK, MOTION, column, json_of, number};
use crate::repository;

/// Largest error of the tip in m in a simulation against the motion, up to a time in s.
fn strays_m(bench: &Bench, arguments: &str, until_s: f64) -> f64 {
    bench.done(&format!("simulate {arguments} -o sim"));
    let times_s = column(bench, "sim/tip_error.csv", "time_s");
    let errors_m = column(bench, "sim/tip_error.csv", "tip_error_m");
    let within = times_s.iter().zip(&errors_m).filter(|(time_s, _)| **time_s <= until_s);
    within.fold(0.0, |most, (_, error_m)| most.max(error_m.abs()))
}

/// A carriage with weight stands where the reference of its feedback begins.
#[test]
fn a_carried_link_with_weight_strays_on_feedback_as_simulate_says() {
    let bench = Bench::new();
    let sheet = "specs/carriages/sheet.toml";
    bench.done("trajectory min-jerk --distance 0.2 --duration 0.44 --step 0.001 -o move.csv");
    bench.done(&format!("solve {sheet} move.csv -o out"));
    let gains = "--feedback 50,2";
    bench.done(&format!(
        "robust {sheet} move.csv --uncertain segments.*.E*=±5% --runs 0 {gains} -o rb"
    ));
    let summary = bench.json("rb/summary.json");
    let (worst_m, factor) =
        (number(&summary, "worst/0/size_m"), number(&summary, "worst/0/values/0"));
    let period_s = number(&summary, "nominal/period_s");
    let changed = format!("--set segments.*.E*={factor}");
    let played = "out/force.csv --reference out/carriage.csv --target out/tip.csv --until 2";
    let found_m = strays_m(&bench, &format!("{sheet} {played} {gains} {changed}"), 0.44 + period_s);
    assert!((worst_m / found_m - 1.0).abs() < 0.01, "{worst_m} is not {found_m}");
}

/// The error by left-out modes is one of the command; that by the law of damping is not.
#[test]
fn errors_of_the_nominal_link_count_unless_its_damping_makes_them() {
    let bench = Bench::new();
    let study = |more: &str| {
        let play = "--play position --uncertain segments.*.EI*=±1% --runs 0";
        bench.done(&format!("robust {LINK} {MOTION} {play} {more} -o rb"));
        let summary = bench.json("rb/summary.json");
        ["nominal/tip_error_m", "errors/common_m"].map(|key| number(&summary, key))
    };
    let [nominal_m, common_m] = study("");
    assert!(nominal_m < 1e-9 && common_m > 1e-4, "{nominal_m} {common_m}");
    let [nominal_m, common_m] = study("--set analysis.modes=1");
    assert!(nominal_m > 0.01 && common_m == 0.0, "{nominal_m} {common_m}");
    let [nominal_m, common_m] = study("--set damping={model=\"rayleigh\",beta=1e-4}");
    assert!(nominal_m < 1e-6 && common_m == 0.0, "{nominal_m} {common_m}");
}

/// The period is that of the loop's pole for links with weight, too, and that of the lowest mode which rings: α damps the
/// first one beyond the critical ratio.
#[test]
fn the_period_is_that_of_the_slowest_wave() {
    let bench = Bench::new();
    bench.write(
        "link.toml",
        "segments = [{ length = 1.0, EI = 20.0, mass_per_length = 0.5, elements = 4 }]\n\
         hub = { inertia = 0.05 }\npayload = { mass = 0.2 }\n\
         damping = { model = \"rayleigh\", beta = 1e-3 }\n",
    );
    bench.done("trajectory min-jerk --distance 0.5 --duration 2 --step 0.01 -o move.csv");
    let period_s = |more: &str| {
        let study = "robust link.toml move.csv --uncertain segments.*.EI*=±5% --runs 0 -o rb";
        bench.done(&format!("{study} {more}"));
        number(&bench.json("rb/summary.json"), "nominal/period_s")
    };
    for gains in ["--feedback 50,20", "--feedback 5,20"] {
        let light = period_s(gains);
        let weighed = period_s(&format!("{gains} --set gravity=[0,-1e-6] --set start_angle=0"));
        assert!((weighed / light - 1.0).abs() < 1e-3, "{gains}: {weighed} is not {light}");
    }
    let modes = json_of(&bench.run("modes link.toml --count 2 --json"));
    let [first, second] =
        [0, 1].map(|k| std::f64::consts::TAU * number(&modes, &format!("frequency_hz/{k}")));
    let alpha = 1.2 * 2.0 * first;
    let ratio = 0.5 * alpha / second;
    let damped_s = std::f64::consts::TAU / (second * (1.0 - ratio * ratio).sqrt());
    let found_s = period_s(&format!("--set damping={{model=\"rayleigh\",alpha={alpha}}}"));
    assert!(ratio < 0.9 && (found_s / damped_s - 1.0).abs() < 1e-2, "{found_s}, {damped_s}");
}

/// Feedback with stiff joints and a soft carriage: all masses swing on the carriage's gains.
#[test]
fn the_period_of_a_carried_arm_is_that_of_its_carriage_on_feedback() {
    let bench = Bench::new();
    let arm = super::repository("specs/carriages/gantry_arm.toml");
    bench.done(
        "trajectory septic --path line --from 0.5,-0.9 --to 1.1,-0.6 --carriage 0,0.3 --duration 2 --step 0.005 \
         -o path.csv",
    );
    let gains =
        "--feedback 2e4,20,2e4,20,500,10 --set gravity=[0,0] --set carriage.viscous_friction=0";
    let study = "path.csv --uncertain links.*.segments.*.EI*=±1% --runs 0 -o rb";
    bench.done(&format!("robust {arm} {study} {gains}"));
    let found_s = number(&bench.json("rb/summary.json"), "nominal/period_s");
    let mass = 12.0 + 0.7 * 0.8 + 0.6 + 0.6 * 0.4 + 0.3;
    let omega = (500.0_f64 / mass - (0.5 * 10.0 / mass).powi(2)).sqrt();
    let of_carriage_s = std::f64::consts::TAU / omega;
    assert!((found_s / of_carriage_s - 1.0).abs() < 0.01, "{found_s}, {of_carriage_s}");
}

/// A wave of half the range outside the band does not settle, whatever the phase at which the play ends.
#[test]
fn a_wave_beyond_the_band_never_settles() {
    let bench = Bench::new();
    let options =
        "--set damping.ratio=0.0002 --uncertain segments.*.EI*=±5% --runs 200 --band 0.2%";
    bench.done(&format!("robust {LINK} {MOTION} {options} -o rb"));
    let settling = bench.cells("rb/robust.csv", "settling_s");
    let rest = bench.numbers("rb/robust.csv", "rest_vibration");
    let far = rest.iter().zip(&settling).filter(|(rest, _)| **rest > 0.0022);
    let far: Vec<_> = far.collect();
    assert!(far.len() > 20, "{}", far.len());
    assert!(far.iter().all(|(_, settling)| settling.is_empty()), "{far:?}");
}

#[test]
fn keys_that_change_nothing_and_two_intervals_of_one_value_are_told() {
    let bench = Bench::new();
    let study = format!("robust {LINK} {MOTION} --runs 10 -o rb");
    let told = bench.told(&format!("{study} --play position --uncertain hub.inertia*=±20%"));
    assert!(told.contains("hub.inertia* changes nothing in these plays"), "{told}");
    let told = bench.told(&format!("{study} --uncertain segments.*.EI*=±5%"));
    assert!(!told.contains("changes nothing"), "{told}");
    let two = "--uncertain segments.*.EI*=±5% --uncertain segments.0.EI=±5%";
    bench.refuses(2, &format!("{study} {two}"), "are intervals of one value");
}

/// Delays are drawn from 0 on, also where a normal distribution has a part below.
#[test]
fn no_drawn_delay_is_below_zero() {
    let bench = Bench::new();
    let options = "--play position --uncertain delay=0..20ms --distribution normal --runs 200";
    bench.done(&format!("robust {LINK} {MOTION} {options} -o rb"));
    let delays = bench.numbers("rb/robust.csv", "delay [s]");
    assert!(delays.iter().all(|delay_s| *delay_s >= 0.0), "{delays:?}");
    assert!(number(&bench.json("rb/summary.json"), "drawn_again") > 0.0);
    // A delay of the table is for position drives; other studies go on without it.
    let link = std::fs::read_to_string(repository(LINK)).unwrap();
    let table = "[uncertainty]\n\"segments.*.EI\" = \"±5%\"\ndelay = \"0..2ms\"\n";
    bench.write("link.toml", &format!("{link}{table}"));
    let told = bench.told(&format!("robust link.toml {MOTION} --runs 10 -o rc"));
    assert!(told.contains("delay of [uncertainty] counts with --play position alone"), "{told}");
    assert!(!bench.read("rc/robust.csv").contains("delay"));
}

/// With few plants beyond a quantile its error is unknown, and the worst of all plants is the pass mark.
#[test]
fn a_small_sample_has_no_pass_mark_of_its_own() {
    let bench = Bench::new();
    let study = |runs: usize| {
        let options = format!("--uncertain segments.*.EI*=±5% --runs {runs} --allow 0.98%");
        let output = bench.run(&format!("robust {LINK} {MOTION} {options} --strict -o rb --json"));
        (
            output.status.code(),
            json_of(&bench.run(&format!("robust {LINK} {MOTION} {options} -o rb --json"))),
        )
    };
    // The worst is 1.00 %, the quantile below it.
    let (code, summary) = study(20);
    assert_eq!(code, Some(4));
    assert!(summary["quantiles"][0]["p95_m"][1].is_null());
    assert!(summary["quantiles"][0]["median_m"][1].as_f64().unwrap() > 0.0);
    let (code, summary) = study(400);
    assert_eq!(code, Some(0));
    assert!(summary["quantiles"][0]["p95_m"][1].as_f64().unwrap() > 0.0);
    assert!(summary["quantiles"][0]["p99_m"][1].is_null());
}
