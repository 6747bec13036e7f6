//! Several answers that fit about as well: printed, warned of, covered by the intervals, refused by --strict.

use super::{Bench, number, refusal, stderr, stdout, succeeded};

const LINK: &str = "[[segments]]\nlength = 0.24\nEI = 6.2687\nmass_per_length = 0.30039\n\
                    [[segments]]\nlength = 0.36\nEI = 6.5037\nmass_per_length = 0.30039\n\
                    [hub]\ninertia = 0.030_758\n[payload]\nmass = 0.15570\n";

/// Frequencies with the hub free, then held, of the link with its values times [`TRUE_OF_LINK`], with errors of 1 %.
const OF_LINK: [[f64; 2]; 6] = [
    [4.211_594_645_883_026, 0.042_392_255],
    [29.762_403_578_319_34, 0.298_144_947],
    [90.247_661_262_559_52, 0.887_707_608],
    [3.082_433_413_185_474, 0.030_622_487],
    [29.153_400_615_086_287, 0.296_399_093],
    [88.708_338_030_438_5, 0.887_129_540],
];

const TRUE_OF_LINK: [f64; 4] = [0.557, 0.890, 1.967, 0.631];

const ARM: &str = "elbow = 'left'\n\
    [[links]]\nname = 'l0'\nsegments = [{ length = 0.5, EI = 20.0, mass_per_length = 0.6 }]\n\
    hub = { inertia = 0.01 }\ntip = { mass = 0.5 }\ndamping = { model = 'rayleigh', beta = 2e-4 }\n\
    drive = { joint_stiffness = 200.0 }\n\
    [[links]]\nname = 'l1'\nsegments = [{ length = 0.4, EI = 4.0, mass_per_length = 0.3 }]\n\
    hub = { inertia = 0.002 }\npayload = { mass = 0.15 }\ndamping = { model = 'rayleigh', beta = 2e-4 }\n\
    drive = { joint_stiffness = 90.0 }\n";

/// The frequencies with held joints straight, then at right angles, of the arm with its values times
/// [`TRUE_OF_ARM`], with errors of 0.3 %.
const OF_ARM: [[f64; 2]; 8] = [
    [1.805_494_556_049_964_4, 0.005_444_877_6],
    [6.364_761_028_291_148, 0.019_171_158_1],
    [24.115_955_304_304_805, 0.072_644_496_5],
    [30.815_435_109_996_418, 0.092_543_864_4],
    [2.237_290_911_173_517_7, 0.006_758_763_3],
    [4.370_196_361_108_707, 0.013_118_022_6],
    [24.023_847_701_521_03, 0.072_279_096_1],
    [30.676_978_541_574_027, 0.091_784_878_7],
];

const TRUE_OF_ARM: [f64; 4] = [1.25, 1.0 / 0.75, 0.75, 1.0 / 1.5];

/// Writes the link and its measured values; returns the values to fit.
fn write_link(bench: &Bench) -> [&'static str; 4] {
    write(bench, LINK, &OF_LINK, |k| {
        format!("mode = {}\nhub = '{}'\n", k % 3 + 1, ["free", "held"][k / 3])
    });
    ["segments.0.EI", "segments.1.EI", "hub.inertia", "payload.mass"]
}

fn write_arm(bench: &Bench) -> [&'static str; 4] {
    write(bench, ARM, &OF_ARM, |k| {
        let (mode, elbow) = (k % 4 + 1, [0, 90][k / 4]);
        format!("mode = {mode}\nat = ['0 deg', '{elbow} deg']\njoints = 'held'\n")
    });
    [
        "links.l1.segments.*.EI",
        "links.l1.payload.mass",
        "links.l0.drive.joint_stiffness",
        "links.l1.drive.joint_stiffness",
    ]
}

fn write(bench: &Bench, link: &str, values: &[[f64; 2]], of: impl Fn(usize) -> String) {
    bench.write("link.toml", link);
    let entries = values.iter().enumerate().map(|(k, [value, uncertainty])| {
        format!("[[frequency]]\n{}value = {value}\nuncertainty = {uncertainty}\n", of(k))
    });
    bench.write("measured.toml", &entries.collect::<String>());
}

fn fit(bench: &Bench, free: [&str; 4], more: &str) -> std::process::Output {
    bench.run(&format!("fit link.toml measured.toml --free {} {more}", free.join(" --free ")))
}

/// Fits, and checks that each true factor lies within its interval; returns the factors of all answers.
fn covering(bench: &Bench, free: [&str; 4], exact: [f64; 4]) -> Vec<Vec<f64>> {
    let out = succeeded(fit(bench, free, "-o f.toml --report"));
    assert!(stderr(&out).contains("the measurements about as well"), "{}", stderr(&out));
    let record = bench.json("f.json");
    let values = record["values"].as_array().unwrap();
    for (value, exact) in values.iter().zip(exact) {
        let factor = number(value, "factor");
        let [low, high] =
            [0, 1].map(|k| factor * number(value, &format!("relative_interval_95/{k}")));
        assert!(low < exact && exact < high, "{low} … {high} {value}");
    }
    let others = record["other_answers"].as_array().unwrap();
    for other in others {
        let more = number(other, "sum_of_squares") - number(&record, "chi_squared");
        assert!((-1e-2..3.842).contains(&more), "{other}");
    }
    assert_eq!(stdout(&out).matches("another answer: factors ").count(), others.len());
    assert!(bench.read("f.html").contains("Other answers"));
    assert_eq!(record["warnings"][0]["kind"], "ambiguous");
    let factors = |other: &serde_json::Value| {
        (0..4).map(|k| number(other, &format!("factors/{k}"))).collect()
    };
    let best = values.iter().map(|value| number(value, "factor")).collect();
    others.iter().map(factors).chain([best]).collect()
}

#[test]
fn the_intervals_of_a_link_cover_all_answers() {
    let bench = Bench::new();
    let free = write_link(&bench);
    covering(&bench, free, TRUE_OF_LINK);
}

#[test]
fn an_arm_has_the_answer_near_the_truth_beside_the_better_one() {
    let bench = Bench::new();
    let free = write_arm(&bench);
    let answers = covering(&bench, free, TRUE_OF_ARM);
    let is_near = |answer: &Vec<f64>| {
        answer.iter().zip(TRUE_OF_ARM).all(|(found, exact)| (found / exact - 1.0).abs() < 0.03)
    };
    assert!(answers.iter().any(is_near) && !answers.iter().all(is_near), "{answers:?}");
}

#[test]
fn strict_takes_several_answers_for_none_and_denied_warnings_fail_after_all_output() {
    let bench = Bench::new();
    let free = write_arm(&bench);
    // A denied warning ends the fit after its link file.
    let denied = "error: --deny-warnings: warnings = 1, but must be none; all output is written\n";
    refusal(4, fit(&bench, free, "--deny-warnings -o g.toml"), denied);
    assert!(bench.path("g.toml").exists());
    let told =
        "error: no link file is written: one other answer fits the measurements about as well";
    refusal(4, fit(&bench, free, "--strict -o f.toml"), told);
    assert!(!bench.path("f.toml").exists() && bench.path("f.json").exists());
    // One answer is one with --strict, too.
    let one = bench.run(&format!("fit link.toml measured.toml --free {} --strict", free[0]));
    assert!(!stderr(&one).contains("about as well"), "{}", stderr(&one));
}
