//! `learn` on rigs that are other links than their file: `simulate` plays the table, a generator adds noise to the tip.

use std::f64::consts::TAU;

use super::{Bench, LINK, number, peak, with};
use crate::repository;

/// Standard deviation of the noise over the travel.
const NOISE: f64 = 1e-3;

/// A rig: a link, its motion, and what it truly is.
struct Rig<'a> {
    bench: Bench,
    link: &'a str,
    /// Changes of the model, of the rig from it, and the intervals.
    model: &'a [&'a str],
    differs: &'a [&'a str],
    uncertain: &'a [&'a str],
    /// `effort`, or `position` with the input of simulate.
    play: &'a str,
    input: &'a str,
    /// Table of solve that is played first, and columns of the tip.
    first: &'a str,
    tip: &'a [&'a str],
    travel_m: f64,
    random: u64,
    until_s: f64,
}

/// The numbers of a step over the travel.
struct Step {
    rms: f64,
    predicted: f64,
}

/// `--option value` for each value.
fn options(option: &str, values: &[&str]) -> Vec<String> {
    values.iter().flat_map(|value| [option.to_owned(), (*value).to_owned()]).collect()
}

impl Rig<'_> {
    /// A normal deviate (`SplitMix64`, Box and Muller).
    fn normal(&mut self) -> f64 {
        let mut share = || {
            self.random = self.random.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = self.random;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            (((z ^ (z >> 31)) >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
        };
        let (radius, angle) = (share(), share());
        (-2.0 * radius.ln()).sqrt() * (TAU * angle).cos()
    }

    /// The pose in which the arm of solve starts.
    fn start(&self) -> String {
        let chords = self.bench.table("out/chord_angles.csv").into_iter();
        let angles = chords.filter(|(name, _)| name.starts_with("angle"));
        let angles: Vec<String> = angles.map(|(_, values)| values[0].to_string()).collect();
        format!("--at={}", angles.join(","))
    }

    /// Plays a table on the true link and writes measured.csv, with the times less a shift in s.
    fn measure(&mut self, table: &str, (noise, late_s): (f64, f64)) {
        let changes = with(&options("--set", self.model), &options("--set", self.differs));
        let input = if self.input.is_empty() { vec![] } else { vec!["--input", self.input] };
        let play = with(&["simulate", self.link, table, "-o", "sim", "--quiet"], &input);
        let play = with(&play, &changes);
        let at = self.tip.len() > 1 && self.input.is_empty();
        let at: Vec<String> = at.then(|| self.start()).into_iter().collect();
        self.bench.done(&with(&play, &at));
        let time_s = self.bench.numbers("sim/tip.csv", "time_s");
        if self.until_s == 0.0 {
            self.until_s = *time_s.last().unwrap();
        }
        let columns: Vec<Vec<f64>> =
            self.tip.iter().map(|name| self.bench.numbers("sim/tip.csv", name)).collect();
        let until_s = self.until_s + 1e-9;
        let mut text = format!("time_s,{}\n", self.tip.join(","));
        for (k, time_s) in time_s.iter().enumerate().filter(|(_, t)| **t <= until_s) {
            let mut row = vec![(time_s + late_s).to_string()];
            for column in &columns {
                let noise_m = noise * self.travel_m * self.normal();
                row.push((column[k] + noise_m).to_string());
            }
            text += &(row.join(",") + "\n");
        }
        self.bench.write("measured.csv", &text);
    }

    fn learn(&self, applied: Option<&str>, more: &[&str]) -> Vec<String> {
        let own = ["learn", self.link, "motion.csv", "measured.csv", "--play", self.play];
        let own = with(&own, &options("--set", self.model));
        let own = with(&own, &options("--uncertain", self.uncertain));
        let applied: Vec<&str> = applied.into_iter().flat_map(|name| ["--applied", name]).collect();
        with(&with(&own, &applied), more)
    }

    fn solve(&self) {
        let own = ["solve", self.link, "motion.csv", "-o", "out", "--quiet"];
        self.bench.done(&with(&own, &options("--set", self.model)));
    }

    /// Steps with noise. Every error is at most as large as the step before predicts, with the noise.
    fn learned(&mut self, steps: usize) -> Vec<Step> {
        self.solve();
        let mut table = self.first.to_owned();
        let mut all: Vec<Step> = Vec::new();
        for step in 0..steps {
            self.measure(&table, (NOISE, 0.0));
            let next = format!("next{step}.csv");
            let applied = Some(&*table).filter(|_| step > 0);
            let told = self.bench.reply(&self.learn(applied, &["-o", &next, "--json"]));
            let [rms, predicted] = ["rms_m", "predicted_rms_m"]
                .map(|name| number(&told, name) / number(&told, "travel_m"));
            if let Some(before) = all.last() {
                let most = before.predicted.hypot(NOISE * (self.tip.len() as f64).sqrt());
                assert!(rms < 1.1 * most, "step {step}: {rms} is above {most}");
            }
            all.push(Step { rms, predicted });
            table = next;
        }
        let noise = NOISE * (self.tip.len() as f64).sqrt();
        let first = all.iter().position(|step| step.rms < 3.0 * noise);
        let first = first.unwrap_or_else(|| panic!("the last error is {}", all[steps - 1].rms));
        assert!(all[first..].iter().all(|step| step.rms < 3.0 * noise));
        all
    }
}

/// The motion of a bench: `travel` m in `duration` s, a row every `step` s.
fn bench_of(travel: &str, duration: &str, step: &str) -> Bench {
    let bench = Bench::new();
    let motion = ["trajectory", "min-jerk", "--distance", travel, "--duration", duration];
    bench.done(&with(&motion, &["--step", step, "-o", "motion.csv"]));
    bench
}

fn rig<'a>(
    bench: Bench,
    link: &'a str,
    differs: &'a [&'a str],
    uncertain: &'a [&'a str],
) -> Rig<'a> {
    Rig {
        bench,
        link,
        model: &[],
        differs,
        uncertain,
        play: "effort",
        input: "",
        first: "out/torque.csv",
        tip: &["tip_displacement_m"],
        travel_m: 0.5,
        random: 1,
        until_s: 0.0,
    }
}

#[test]
fn a_wrong_stiffness_payload_and_friction_are_learned_in_ten_steps() {
    let bench = bench_of("0.5", "3", "0.01");
    let paper = std::fs::read_to_string(repository(LINK)).unwrap();
    bench.write("link.toml", &format!("{paper}\n[payload]\nmass = '100 g'\n"));
    let differs = ["payload.mass*=1.2", "segments.*.EI*=0.9", "hub.viscous_friction=0.05"];
    let uncertain = ["payload.mass=±20%", "segments.*.EI*=±10%", "hub.viscous_friction=0..0.1"];
    let steps = rig(bench, "link.toml", &differs, &uncertain).learned(10);
    assert!(steps[0].rms > 0.05 && steps[9].rms < 2.0 * NOISE, "{}", steps[9].rms);
}

/// Friction that no interval has makes an error that no link within the intervals makes.
#[test]
fn an_error_that_the_intervals_do_not_explain_is_told() {
    let bench = bench_of("0.5", "3", "0.01");
    let differs = ["segments.*.EI*=0.9", "hub.viscous_friction=0.05"];
    let stiffness = "segments.*.EI*=±10%";
    let mut own = rig(bench, LINK, &differs, &[]);
    own.solve();
    own.measure("out/torque.csv", (NOISE, 0.0));
    for (uncertain, is_told) in
        [(&[stiffness][..], true), (&[stiffness, "hub.viscous_friction=0..0.1"], false)]
    {
        own.uncertain = uncertain;
        let told = own.bench.told(&own.learn(None, &[]));
        assert_eq!(
            told.contains("times that which links within the intervals make"),
            is_told,
            "{told}"
        );
    }
}

/// Without noise the next error of a link within the intervals is at most the predicted one.
#[test]
fn the_prediction_bounds_the_error_of_links_within_the_intervals() {
    for (duration, changes) in [
        ("1.5", ["segments.*.EI*=0.92", "payload.mass*=1.1"]),
        ("2.5", ["segments.*.EI*=1.08", "payload.mass*=0.9"]),
    ] {
        let bench = bench_of("0.5", duration, "0.005");
        let paper = std::fs::read_to_string(repository(LINK)).unwrap();
        bench.write("link.toml", &format!("{paper}\n[payload]\nmass = '100 g'\n"));
        let uncertain = ["payload.mass=±20%", "segments.*.EI*=±10%"];
        let mut own = rig(bench, "link.toml", &changes, &uncertain);
        own.solve();
        own.measure("out/torque.csv", (0.0, 0.0));
        let told = own.bench.reply(&own.learn(None, &["--json", "-o", "next.csv"]));
        own.measure("next.csv", (0.0, 0.0));
        let again = own.bench.reply(&own.learn(Some("next.csv"), &["--json", "-o", "after.csv"]));
        let [predicted, found] = [number(&told, "predicted_rms_m"), number(&again, "rms_m")];
        assert!(found < 1.01 * predicted, "{duration} s: {found} is above {predicted}");
    }
}

/// EI −10 % alone, faster: the error lies in the band up to the free link's first frequency, and what lies above it stays.
#[test]
fn a_wrong_stiffness_is_learned_by_torque_and_by_the_hubs_angle() {
    for (duration, play, input, first) in [
        ("1.6", "effort", "", "out/torque.csv"),
        ("4", "position", "hub-angle", "out/hub_angle.csv"),
    ] {
        let bench = bench_of("0.5", duration, "0.005");
        let own = rig(bench, LINK, &["segments.*.EI*=0.9"], &["segments.*.EI*=±10%"]);
        let mut own = Rig { play, input, first, ..own };
        let steps = own.learned(4);
        assert!(steps[3].rms < 1.3 * NOISE, "{play}: {}", steps[3].rms);
    }
}

/// The sheet is light: the force moves a mass M that is 20 % larger, and each step leaves 1 − 1/1.2 of the error.
#[test]
fn a_wrong_carriage_shrinks_the_error_by_its_closed_form() {
    let bench = bench_of("0.3", "1.5", "0.002");
    bench.write(
        "cart.toml",
        "carriage = { mass = 5 }\ndamping = { ratio = 0.02 }\n[[segments]]\nlength = 0.5\nEI = 50\nmass_per_length = 0.01\n",
    );
    let own = rig(bench, "cart.toml", &["carriage.mass*=1.2"], &["carriage.mass=±20%"]);
    let mut own = Rig { first: "out/force.csv", travel_m: 0.3, ..own };
    let steps = own.learned(4);
    let exact = 1.0 - 1.0 / 1.2;
    let ratio = steps[1].rms / steps[0].rms;
    assert!((ratio / exact - 1.0).abs() < 0.05, "{ratio} is not {exact}");
    // At the other end of the interval the plant is lighter: 1/0.8 − 1.
    let told = own.bench.reply(&own.learn(Some("next2.csv"), &["--json"]));
    let contraction = number(&told, "contraction");
    assert!((contraction / 0.25 - 1.0).abs() < 0.02, "{contraction}");
}

#[test]
fn an_arm_of_two_links_learns_x_and_y() {
    let bench = Bench::new();
    let path = repository("trajectories/arms/line_1.5s.csv");
    bench.write("motion.csv", &std::fs::read_to_string(path).unwrap());
    let link = "specs/arms/two_links.toml";
    let differs = ["links.*.segments.*.EI*=0.8", "links.fore.payload.mass*=1.5"];
    let uncertain = ["links.*.segments.*.EI*=±20%", "links.fore.payload.mass=±50%"];
    let own = rig(bench, link, &differs, &uncertain);
    let tip = ["x_m", "y_m"];
    let mut own = Rig {
        model: &["gravity=[0,0]"],
        play: "position",
        input: "hub-angle",
        first: "out/joint_angles.csv",
        tip: &tip,
        travel_m: 1.36,
        ..own
    };
    own.bench.done(&[
        "solve",
        link,
        "motion.csv",
        "-o",
        "out",
        "--quiet",
        "--scale-duration",
        "3",
        "--set",
        "gravity=[0,0]",
    ]);
    own.measure("out/joint_angles.csv", (0.1 * NOISE, 0.0));
    let told =
        own.bench.reply(&own.learn(None, &["--scale-duration", "3", "--json", "-o", "next0.csv"]));
    let [before, predicted] = ["rms_m", "predicted_rms_m"].map(|name| number(&told, name));
    own.measure("next0.csv", (0.1 * NOISE, 0.0));
    let again =
        own.learn(Some("next0.csv"), &["--scale-duration", "3", "--json", "-o", "next1.csv"]);
    let after = number(&own.bench.reply(&again), "rms_m");
    assert!(after < 0.4 * before && after < 1.1 * predicted, "{before}, {predicted}, {after}");
    let names: Vec<String> = own.bench.table("next1.csv").into_iter().map(|own| own.0).collect();
    assert_eq!(
        names,
        ["time_s", "joint1_rad", "joint1_rate_rad_s", "joint2_rad", "joint2_rate_rad_s"]
    );
}

/// Rows of columns that go from one value by another in a number of steps, min-jerk, with 0.3 s of rest before and 1.5 s
/// after.
fn path((per_second, steps): (i32, i32), columns: &[(&str, f64, f64)]) -> String {
    let names: Vec<&str> = columns.iter().map(|own| own.0).collect();
    let mut text = format!("time,{}\n", names.join(","));
    let [before, after] = [3, 15].map(|tenths| per_second * tenths / 10);
    for k in -before..=steps + after {
        let t = (f64::from(k) / f64::from(steps)).clamp(0.0, 1.0);
        let share = t.powi(3) * (10.0 - 15.0 * t + 6.0 * t * t);
        let values = columns.iter().map(|(_, from, by)| from + by * share);
        let row = std::iter::once(f64::from(k) / f64::from(per_second)).chain(values);
        let row: Vec<String> = row.map(|own| own.to_string()).collect();
        text += &(row.join(",") + "\n");
    }
    text
}

/// Three links in a horizontal plane.
const THREE: &str = "\
elbow = 'left'
[[links]]
segments = [{ length = 0.5, EI = 120, mass_per_length = 0.8 }]
hub = { inertia = 0.02, viscous_friction = 0.5 }
tip = { mass = 0.6 }
damping = { model = 'rayleigh', beta = 5e-4 }
[[links]]
segments = [{ length = 0.4, EI = 60, mass_per_length = 0.5 }]
hub = { inertia = 0.005, viscous_friction = 0.5 }
tip = { mass = 0.3 }
damping = { model = 'rayleigh', beta = 5e-4 }
[[links]]
segments = [{ length = 0.3, EI = 15, mass_per_length = 0.3 }]
hub = { inertia = 0.005, viscous_friction = 0.2 }
payload = { mass = 0.3 }
damping = { model = 'rayleigh', beta = 5e-4 }
";

/// Steps on an arm at ends of the intervals: each error is at most the one that the step before predicts, and smaller than
/// the one before. The last is less than a share of the first.
fn learned_as_predicted(own: &mut Rig<'_>, (steps, left): (usize, f64)) {
    own.solve();
    let mut table = own.first.to_owned();
    let (mut all, mut most) = (Vec::new(), f64::INFINITY);
    for step in 0..steps {
        own.measure(&table, (0.0, 0.0));
        let next = format!("next{step}.csv");
        let applied = Some(&*table).filter(|_| step > 0);
        let told = own.bench.reply(&own.learn(applied, &["-o", &next, "--json"]));
        let [rms, predicted] = ["rms_m", "predicted_rms_m"].map(|name| number(&told, name));
        assert!(rms <= most, "step {step}: {rms} is above {most}");
        all.push(rms);
        (table, most) = (next, predicted);
    }
    assert!(all.is_sorted_by(|a, b| a > b) && all[steps - 1] < left * all[0], "{all:?}");
}

#[test]
fn an_arm_of_three_links_learns_its_torques() {
    let bench = Bench::new();
    bench.write("arm.toml", THREE);
    let columns = [("x", 0.9, -0.3), ("y", -0.2, 0.7), ("angle3", -0.4, 1.0)];
    bench.write("motion.csv", &path((100, 200), &columns));
    let differs = ["links.*.segments.*.EI*=0.9", "links.2.payload.mass*=1.2"];
    let uncertain = ["links.*.segments.*.EI*=±10%", "links.2.payload.mass=±20%"];
    let own = rig(bench, "arm.toml", &differs, &uncertain);
    let mut own = Rig { first: "out/torques.csv", tip: &["x_m", "y_m"], ..own };
    learned_as_predicted(&mut own, (3, 5e-3));
}

/// A fast arm turns while the error acts: the contraction about poses at rest is too small, and the plants' plays count.
#[test]
fn a_fast_arm_learns_as_the_plants_play() {
    let bench = Bench::new();
    let link = std::fs::read_to_string(repository("specs/arms/two_links.toml")).unwrap();
    bench.write("arm.toml", &link.replace("hub = {", "hub = { viscous_friction = 0.5,"));
    bench.write("motion.csv", &path((500, 750), &[("x", 0.9, -0.4), ("y", -0.5, 1.3)]));
    let differs = ["links.*.segments.*.EI*=0.9", "links.fore.payload.mass*=1.2"];
    let uncertain = ["links.*.segments.*.EI*=±10%", "links.fore.payload.mass=±20%"];
    let own = rig(bench, "arm.toml", &differs, &uncertain);
    let model = &["gravity=[0,0]"];
    let mut own = Rig { model, first: "out/torques.csv", tip: &["x_m", "y_m"], ..own };
    learned_as_predicted(&mut own, (3, 0.1));
    // Under weight no plant plays, and small motions count.
    own.model = &["gravity=[0,-9.81]"];
    let told = own.bench.told(&own.learn(None, &["-o", "weighed.csv"]));
    assert!(told.contains("an arm under weight falls without feedback"), "{told}");
}

#[test]
fn an_arm_on_a_carriage_learns_its_efforts_and_its_motion() {
    let gantry = std::fs::read_to_string(repository("specs/carriages/gantry_arm.toml")).unwrap();
    let gantry = gantry.replace("hub = { inertia", "hub = { viscous_friction = 0.5, inertia");
    let columns = [("x", 0.5, 0.8), ("y", -0.9, 0.4), ("carriage", 0.0, 0.4)];
    let differs = ["links.*.segments.*.EI*=0.9", "links.fore.payload.mass*=1.2"];
    let uncertain = ["links.*.segments.*.EI*=±10%", "links.fore.payload.mass=±20%"];
    for (play, input, first, steps, names) in [
        (
            "effort",
            "",
            "out/torques.csv",
            (3, 5e-3),
            &["torque1_n_m", "torque2_n_m", "force_n"][..],
        ),
        (
            "position",
            "hub-angle",
            "out/joint_angles.csv",
            (2, 0.3),
            &[
                "joint1_rad",
                "joint1_rate_rad_s",
                "joint2_rad",
                "joint2_rate_rad_s",
                "carriage_m",
                "carriage_velocity_m_s",
            ],
        ),
    ] {
        let bench = Bench::new();
        bench.write("arm.toml", &gantry);
        bench.write("motion.csv", &path((100, 300), &columns));
        let own = rig(bench, "arm.toml", &differs, &uncertain);
        let model = &["gravity=[0,0]"];
        let mut own = Rig { model, play, input, first, tip: &["x_m", "y_m"], ..own };
        learned_as_predicted(&mut own, steps);
        let table = own.bench.table("next1.csv").into_iter();
        let found: Vec<String> = table.skip(1).map(|own| own.0).collect();
        assert_eq!(found, names);
        own.bench.refuses(3, &own.learn(Some(first), &[]), "is missing");
    }
}

#[test]
fn a_recording_of_something_else_is_refused() {
    let bench = bench_of("0.5", "1.6", "0.005");
    let mut own = rig(bench, LINK, &["segments.*.EI*=0.97"], &["segments.*.EI*=±10%"]);
    own.solve();
    own.measure("out/torque.csv", (0.0, 0.0));
    let good = own.bench.read("measured.csv");
    own.bench.done(&own.learn(None, &["-o", "next.csv"]));
    // The table of solve is the default, to the digits of its file.
    own.bench.done(&own.learn(Some("out/torque.csv"), &["-o", "same.csv"]));
    let [a, b] = ["next.csv", "same.csv"].map(|name| own.bench.numbers(name, "torque_n_m"));
    assert!(super::apart(&a, &b) < 1e-9 * peak(&a));

    let refused = |text: &str, words: &str| {
        own.bench.write("measured.csv", text);
        own.bench.refuses(3, &own.learn(None, &[]), words);
    };
    let rows: Vec<[f64; 2]> = good
        .lines()
        .skip(1)
        .map(|line| line.split_once(',').unwrap())
        .map(|(t, x)| [t.parse().unwrap(), x.parse().unwrap()])
        .collect();
    let table = |row: &dyn Fn([f64; 2]) -> Option<[f64; 2]>| {
        let rows = rows.iter().filter_map(|own| row(*own));
        rows.fold("time_s,tip_displacement_m\n".to_owned(), |text, [t, x]| {
            format!("{text}{t},{x}\n")
        })
    };
    refused(&table(&|[t, x]| Some([t + 0.1, x])), "0.0992 s late");
    refused(&table(&|[t, x]| Some([t, 2.0 * x])), "2.00 times as far");
    refused(
        &table(&|[t, _]| {
            Some([t, 0.5 * (TAU * t).sin() * f64::from(u8::from(t > 0.0 && t < 2.0))])
        }),
        "another motion",
    );
    refused(&table(&|[t, x]| (t > 0.3).then_some([t, x])), "the recording lasts from");
    refused(&table(&|[t, x]| (t < 1.2).then_some([t, x])), "the recording lasts from");
    refused(&table(&|[t, x]| (t < 1.7).then_some([t, x])), "but must last until 1.76 s");
    refused(
        &table(&|[t, x]| Some([t, if t < 0.0 { 0.2 * (9.0 * t).sin() } else { x }])),
        "before the motion",
    );
    refused(&table(&|[t, x]| Some([t, x + 0.3 * (t - 1.6).max(0.0)])), "after the motion");
    refused(&good.replace("tip_displacement_m", "hub_angle"), "tip is missing");
    own.bench.write("measured.csv", &table(&|[t, x]| Some([t, x + 0.05 * (t - 1.6).max(0.0)])));
    let told = own.bench.told(&own.learn(None, &[]));
    assert!(told.contains("after the motion: the error at rest is not known"), "{told}");

    // A shift that is told, a constant offset, and a shift that is said to be the tip's.
    let reply = |text: &str, more: &[&str]| {
        own.bench.write("measured.csv", text);
        own.bench.reply(&own.learn(None, &[&["--json"], more].concat()))
    };
    let exact = number(&reply(&good, &[]), "rms_m");
    let late = table(&|[t, x]| Some([t + 0.1, x]));
    let told = number(&reply(&late, &["--shift", "100 ms"]), "rms_m");
    assert!((told / exact - 1.0).abs() < 1e-3, "{told} is not {exact}");
    assert!(number(&reply(&late, &["--shift", "0"]), "rms_m") > 5.0 * exact);
    let offset = reply(&table(&|[t, x]| Some([t, x + 0.07])), &[]);
    assert!((number(&offset, "rms_m") / exact - 1.0).abs() < 1e-6);
    assert!((number(&offset, "offset_m/0") - 0.07).abs() < 1e-4);

    // A torque that its drive cuts off, and intervals without a band.
    own.bench.write("measured.csv", &good);
    let [time_s, torque_n_m] =
        ["time_s", "torque_n_m"].map(|name| own.bench.numbers("out/torque.csv", name));
    let most = 0.8 * peak(&torque_n_m);
    let cut =
        time_s.iter().zip(&torque_n_m).map(|(t, x)| format!("{t},{}\n", x.clamp(-most, most)));
    own.bench.write("cut.csv", &("time_s,torque_n_m\n".to_owned() + &cut.collect::<String>()));
    own.bench.refuses(3, &own.learn(Some("cut.csv"), &[]), "it is saturated");
    let short: Vec<String> = own.bench.read("out/torque.csv").lines().map(str::to_owned).collect();
    own.bench.write("short.csv", &short[..short.len() / 2].join("\n"));
    own.bench.refuses(3, &own.learn(Some("short.csv"), &[]), "s, but must last from 0 to 1.6 s");
    let limit = format!("limits.torque={most}");
    own.bench.refuses(3, &own.learn(None, &["--set", &limit]), "at limits.torque = ");
    let wide = [
        "--uncertain",
        "hub.inertia*=0.0001..10",
        "--uncertain",
        "segments.*.mass_per_length*=0.01..3",
    ];
    own.bench.refuses(4, &own.learn(None, &wide), "must differ by less than 1");
    own.uncertain = &[];
    own.bench.refuses(2, &own.learn(None, &[]), "nothing is uncertain");
}
