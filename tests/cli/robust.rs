//! `robust` against a simulation that is written here: assembled elements, modes, and recurrences for straight pieces of
//! the torque.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::{Bench, LINK, MOTION, Words, number, with};

/// A beam of uniform elements on a hub, with a mass at its tip.
struct Plant {
    length_m: f64,
    stiffness_n_m2: f64,
    mass_kg_m: f64,
    hub_kg_m2: f64,
    tip_kg: f64,
    /// Viscous ratio of each mode.
    ratio: f64,
}

impl Plant {
    /// The paper's first example.
    fn paper(factor: f64, tip_kg: f64) -> Self {
        Self {
            length_m: 1.5,
            stiffness_n_m2: 5.0 * factor,
            mass_kg_m: 0.8,
            hub_kg_m2: 0.1,
            tip_kg,
            ratio: 0.02,
        }
    }

    fn inertia_kg_m2(&self) -> f64 {
        let beam = self.mass_kg_m * self.length_m.powi(3) / 3.0;
        self.hub_kg_m2 + beam + self.tip_kg * self.length_m.powi(2)
    }

    /// Frequency in rad/s, angle of the hub and displacement of the tip of each mass-normalised mode, the rigid rotation
    /// first. Coordinates: angle of the hub, then deflection and slope of the nodes in the hub's frame.
    fn modes(&self, elements: usize) -> Vec<[f64; 3]> {
        let (h, size) = (self.length_m / elements as f64, 2 * elements + 1);
        let mut mass = DMatrix::<f64>::zeros(size, size);
        let mut stiffness = mass.clone();
        mass[(0, 0)] = self.hub_kg_m2;
        let m = self.mass_kg_m * h / 420.0;
        let own_mass = [
            [156.0, 22.0 * h, 54.0, -13.0 * h],
            [22.0 * h, 4.0 * h * h, 13.0 * h, -3.0 * h * h],
            [54.0, 13.0 * h, 156.0, -22.0 * h],
            [-13.0 * h, -3.0 * h * h, -22.0 * h, 4.0 * h * h],
        ];
        let own_stiffness = [
            [12.0, 6.0 * h, -12.0, 6.0 * h],
            [6.0 * h, 4.0 * h * h, -6.0 * h, 2.0 * h * h],
            [-12.0, -6.0 * h, 12.0, -6.0 * h],
            [6.0 * h, 2.0 * h * h, -6.0 * h, 4.0 * h * h],
        ];
        for element in 0..elements {
            // The clamp of the paper's link, its first element, is ten times as stiff.
            let clamp = if element == 0 { 10.0 } else { 1.0 };
            let k = clamp * self.stiffness_n_m2 / h.powi(3);
            // Total displacement and slope of the four ends from the coordinates: v = xθ + w.
            let mut part = DMatrix::<f64>::zeros(4, size);
            for (end, node) in [element, element + 1].into_iter().enumerate() {
                part[(2 * end, 0)] = node as f64 * h;
                part[(2 * end + 1, 0)] = 1.0;
                if node > 0 {
                    part[(2 * end, 2 * node - 1)] = 1.0;
                    part[(2 * end + 1, 2 * node)] = 1.0;
                }
            }
            let matrix = |own: &[[f64; 4]; 4], factor: f64| {
                DMatrix::from_fn(4, 4, |row, column| factor * own[row][column])
            };
            mass += part.transpose() * matrix(&own_mass, m) * &part;
            stiffness += part.transpose() * matrix(&own_stiffness, k) * &part;
        }
        let tip = self.tip_row(size);
        mass += self.tip_kg * &tip * tip.transpose();
        let lower = mass.cholesky().unwrap().unpack();
        let half = lower.clone().solve_lower_triangular(&stiffness).unwrap();
        let whole = lower.clone().solve_lower_triangular(&half.transpose()).unwrap();
        let eigen = SymmetricEigen::new(0.5 * (&whole + whole.transpose()));
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        let upper = lower.transpose();
        let mode = |(number, k): (usize, &usize)| {
            let x = eigen.eigenvectors.column(*k).into_owned();
            let shape = upper.solve_upper_triangular(&x).unwrap();
            let omega = if number == 0 { 0.0 } else { eigen.eigenvalues[*k].max(0.0).sqrt() };
            [omega, shape[0], tip.dot(&shape)]
        };
        order.iter().enumerate().map(mode).collect()
    }

    fn tip_row(&self, size: usize) -> DVector<f64> {
        let mut tip = DVector::zeros(size);
        (tip[0], tip[size - 2]) = (self.length_m, 1.0);
        tip
    }

    /// The tip under a torque with straight lines between its samples, and after its end, up to a time after the first
    /// sample; and the period of the first mode.
    fn played(
        &self,
        torque_n_m: &[f64],
        step_s: f64,
        until_s: impl Fn(f64) -> f64,
    ) -> (Vec<f64>, f64) {
        let modes = self.modes(10);
        let period_s = std::f64::consts::TAU / modes[1][0];
        let samples = below(until_s(period_s) / step_s) + 2;
        let mut tip = vec![0.0; samples];
        let at = |k: usize| torque_n_m.get(k).copied().unwrap_or(0.0);
        for [omega, hub, own] in modes.into_iter().take(9) {
            let (mut q, mut rate) = (0.0, 0.0);
            let decay = self.ratio * omega;
            let damped = omega * (1.0 - self.ratio * self.ratio).sqrt();
            let (sine, cosine) = (damped * step_s).sin_cos();
            let e = (-decay * step_s).exp();
            for (k, tip) in tip.iter_mut().enumerate() {
                *tip += own * q;
                let (force, slope) = (hub * at(k), hub * (at(k + 1) - at(k)) / step_s);
                if omega == 0.0 {
                    let t = step_s;
                    q += rate * t + force * t * t / 2.0 + slope * t * t * t / 6.0;
                    rate += force * t + slope * t * t / 2.0;
                    continue;
                }
                // A particular solution a + b t, and the free vibration from what is left.
                let square = omega * omega;
                let b = slope / square;
                let a = (force - 2.0 * decay * b) / square;
                let (q0, rate0) = (q - a, rate - b);
                let swing = (rate0 + decay * q0) / damped;
                q = e * (q0 * cosine + swing * sine) + a + b * step_s;
                rate = e
                    * ((swing * damped - decay * q0) * cosine
                        - (q0 * damped + decay * swing) * sine)
                    + b;
            }
        }
        (tip, period_s)
    }
}

/// The whole number at a place or before it.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative")]
fn below(place: f64) -> usize {
    place as usize
}

/// Tip error, rest vibration and drift in m.
fn measures(error_m: &[f64], from_s: f64, step_s: f64, end_s: f64, period_s: f64) -> [f64; 3] {
    let place = |time_s: f64| below((time_s - from_s) / step_s);
    let (end, until) = (place(end_s), place(end_s + period_s));
    let largest = error_m[..=until].iter().fold(0.0_f64, |most, e| most.max(e.abs()));
    let after = &error_m[end..=until];
    let (low, high) =
        after.iter().fold((f64::MAX, f64::MIN), |(low, high), e| (low.min(*e), high.max(*e)));
    let mean = after.iter().sum::<f64>() / after.len() as f64;
    [largest, 0.5 * (high - low), mean]
}

/// The study of the paper's example by the simulation of this file.
struct Brute {
    torque_n_m: Vec<f64>,
    from_s: f64,
    nominal_m: Vec<f64>,
}

const STEP_S: f64 = 1e-3;
const END_S: f64 = 0.88;
const TRAVEL_M: f64 = 0.5;

impl Brute {
    fn of(bench: &Bench) -> Self {
        bench.solve(&["-o", "nominal"]);
        let table = bench.table("nominal/torque.csv");
        let (from_s, torque_n_m) = (table[0].1[0], table[1].1.clone());
        let long = |_| 30.0;
        let (nominal_m, _) = Plant::paper(1.0, 0.0).played(&torque_n_m, STEP_S, long);
        Self { torque_n_m, from_s, nominal_m }
    }

    /// The nominal plant follows the wanted motion: errors count from it.
    fn measures(&self, factor: f64, tip_kg: f64) -> [f64; 3] {
        let until = |period_s| END_S - self.from_s + period_s + 0.01;
        let (tip, period_s) = Plant::paper(factor, tip_kg).played(&self.torque_n_m, STEP_S, until);
        let error: Vec<f64> = tip.iter().zip(&self.nominal_m).map(|(own, n)| own - n).collect();
        measures(&error, self.from_s, STEP_S, END_S, period_s)
    }
}

fn robust(bench: &Bench, arguments: &(impl Words + ?Sized)) {
    bench.done(&with(&["robust", LINK, MOTION], arguments));
}

const KEYS: [&str; 4] =
    ["--uncertain", "segments.*.EI*=±10%", "--uncertain", "payload.mass=0..0.02"];

#[test]
fn a_sample_has_the_errors_and_quantiles_of_another_simulation() {
    let bench = Bench::new();
    robust(&bench, &KEYS);
    let brute = Brute::of(&bench);
    let rows = bench.rows("robust/robust.csv");
    let sample: Vec<Vec<f64>> = rows
        .iter()
        .filter(|row| row[0] == "sample")
        .map(|row| row[1..6].iter().map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert_eq!(sample.len(), 1000);
    for row in sample.iter().take(100) {
        let [tip, rest, drift] = brute.measures(row[0], row[1]);
        for (found, exact) in [(row[2], tip / TRAVEL_M), (row[3], rest / TRAVEL_M), (row[4], drift)]
        {
            // 0.1 %, and the error of straight lines between the samples of the torque.
            let off = (found - exact).abs();
            assert!(off < 1e-3 * exact.abs() + 5e-6, "{row:?}: {found} is not {exact}");
        }
    }
    // Another seed, and another generator.
    let mut state = 12345_u64;
    let mut share = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let plants = 10_000_u16;
    let mut drawn: Vec<[f64; 3]> =
        (0..plants).map(|_| brute.measures(0.9 + 0.2 * share(), 0.02 * share())).collect();
    let summary = bench.json("robust/summary.json");
    for (axis, name) in ["tip error", "rest vibration", "drift"].into_iter().enumerate() {
        drawn.sort_by(|a, b| a[axis].abs().total_cmp(&b[axis].abs()));
        for (q, key) in [(0.5, "median_m"), (0.95, "p95_m"), (0.99, "p99_m")] {
            let at = |q: f64| drawn[below(q * f64::from(plants - 1) + 0.5)][axis].abs();
            let off = (q * (1.0 - q) / f64::from(plants)).sqrt();
            let [found, error] =
                [0, 1].map(|part| number(&summary, &format!("quantiles/{axis}/{key}/{part}")));
            let own_error = 0.5 * (at(q + off) - at(q - off));
            let both = error.hypot(own_error);
            assert!((found - at(q)).abs() < 3.0 * both, "{name} {q}: {found} ± {error}, {}", at(q));
        }
        let worst = number(&summary, &format!("worst/{axis}/size_m"));
        let largest = drawn.last().unwrap()[axis].abs();
        assert!(largest < 1.01 * worst, "{name}: {largest} exceeds {worst}");
    }
}

/// The rigid rotation of a free link: under the same torque it turns by I/I' of the wanted angle.
#[test]
fn a_wrong_mass_drifts_as_the_rigid_rotation_does_and_a_wrong_stiffness_does_not() {
    let bench = Bench::new();
    let undamped =
        ["--set", "damping.ratio=0", "--runs", "0", "--uncertain", "payload.mass=0..0.05"];
    robust(&bench, &with(&undamped, &["--uncertain", "segments.*.EI*=±10%"]));
    let [nominal, heavy] = [0.0, 0.05].map(|mass| Plant::paper(1.0, mass).inertia_kg_m2());
    let rows = bench.rows("robust/robust.csv");
    let own = |key: usize, value: f64| {
        let found = rows.iter().find(|row| {
            row[0] == "key" && row[key].parse::<f64>().is_ok_and(|x| (x - value).abs() < 1e-9)
        });
        found.unwrap()[5].parse::<f64>().unwrap()
    };
    // Over one period of the first mode the others leave a little of their own.
    let drift = own(1, 0.05);
    let exact = TRAVEL_M * (nominal / heavy - 1.0);
    assert!((drift - exact).abs() < 2e-3 * TRAVEL_M, "{drift} is not {exact}");
    assert!(own(2, 0.9).abs() < 1e-3 * TRAVEL_M);
}

#[test]
fn the_files_are_the_same_on_any_number_of_threads() {
    let bench = Bench::new();
    for threads in ["1", "2", "5"] {
        let own = ["--runs", "300", "--threads", threads, "-o", threads];
        robust(&bench, &with(&KEYS, &own));
    }
    assert_eq!(bench.contents("1"), bench.contents("2"));
    assert_eq!(bench.contents("1"), bench.contents("5"));
}

/// The sheet of the design's table, on a base whose position is commanded.
const SHEET: &str = "carriage = { mass = 1 }
damping = { ratio = 0.005 }
[[segments]]
length = 0.52
E = '190 GPa'
density = 7870
section = { shape = 'rectangle', width = '80 mm', thickness = '1 mm' }
";

/// Rest vibration in % of the travel with the true modulus off by −20, −10, −5, 0, 5, 10 and 20 %: measured on a prototype.
#[test]
fn a_commanded_position_leaves_the_vibration_of_the_design_table() {
    let bench = Bench::new();
    bench.write("sheet.toml", SHEET);
    let motion = ["trajectory", "min-jerk", "--distance", "0.2", "--duration", "0.44"];
    bench.done(&with(&motion, &["--step", "0.001", "-o", "motion.csv"]));
    let table = [
        ("rigid", [51.6, 44.0, 40.5, 37.2, 34.0, 31.1, 25.6]),
        ("zv", [8.53, 3.57, 1.61, 0.03, 1.35, 2.40, 3.83]),
        ("zvd", [1.40, 0.32, 0.08, 0.02, 0.08, 0.19, 0.56]),
        ("ei", [1.10, 1.87, 1.92, 1.83, 1.62, 1.34, 0.67]),
        ("inverse", [7.12, 2.92, 1.32, 0.0, 1.06, 1.91, 3.03]),
    ];
    let on_way = [7.9, 3.4, 1.6, 0.0, 1.4, 2.5, 4.4];
    for (command, rest) in table {
        for (column, factor) in [0.8, 0.9, 0.95, 1.0, 1.05, 1.1, 1.2].into_iter().enumerate() {
            // The lower end of each interval is the cell.
            let interval = format!("segments.0.E*={factor}..1.5");
            let study = ["robust", "sheet.toml", "motion.csv", "--play", "position", "--runs", "0"];
            bench.done(&with(&study, &["--command", command, "--uncertain", &interval]));
            let cells = ["tip_error", "rest_vibration"]
                .map(|name| bench.cells("robust/robust.csv", name)[1].parse::<f64>().unwrap());
            let [tip, found] = cells.map(|own| 100.0 * own);
            assert!((found - rest[column]).abs() < 0.1, "{command} {factor}: {found}");
            if command == "inverse" {
                assert!((tip - on_way[column]).abs() < 0.1, "{factor}: {tip}");
            }
        }
    }
}

/// The tip's motion shaped, and then the exact inverse.
#[test]
fn a_shaped_tip_leaves_the_vibration_of_the_design_table() {
    let bench = Bench::new();
    bench.write("sheet.toml", SHEET);
    let motion =
        ["trajectory", "min-jerk", "--distance", "0.2", "--duration", "0.44", "--step", "0.001"];
    let table = [
        ("zv", [1.16, 0.23, 0.05, 0.0, 0.05, 0.17, 0.51]),
        ("zvd", [0.19, 0.02, 0.01, 0.0, 0.01, 0.02, 0.07]),
    ];
    let on_way = [3.0, 1.2, 0.5, 0.0, 0.4, 0.8, 1.5];
    for (shaper, rest) in table {
        let shape = ["--shape", shaper, "--of", "held", "--link", "sheet.toml", "-o", "motion.csv"];
        bench.done(&with(&motion, &shape));
        for (column, factor) in [0.8, 0.9, 0.95, 1.0, 1.05, 1.1, 1.2].into_iter().enumerate() {
            let interval = format!("segments.0.E*={factor}..1.5");
            let study = ["robust", "sheet.toml", "motion.csv", "--play", "position", "--runs", "0"];
            bench.done(&with(&study, &["--uncertain", &interval]));
            let [tip, found] = ["tip_error", "rest_vibration"].map(|name| {
                100.0 * bench.cells("robust/robust.csv", name)[1].parse::<f64>().unwrap()
            });
            assert!((found - rest[column]).abs() < 0.1, "{shaper} {factor}: {found}");
            if shaper == "zv" {
                assert!((tip - on_way[column]).abs() < 0.1, "{factor}: {tip}");
            }
        }
    }
}

/// A shaper with a hump leaves most inside the interval: at its mode, and zeros on both sides.
#[test]
fn a_key_with_its_worst_value_inside_is_told_and_searched() {
    let bench = Bench::new();
    bench.write("sheet.toml", SHEET);
    let motion = ["trajectory", "min-jerk", "--distance", "0.2", "--duration", "0.44"];
    bench.done(&with(&motion, &["--step", "0.001", "-o", "motion.csv"]));
    let study = ["robust", "sheet.toml", "motion.csv", "--play", "position", "--command", "ei"];
    let study = with(&study, &["--uncertain", "segments.0.E*=0.8..1.2", "--runs", "200"]);
    let printed = bench.printed(&study);
    assert!(printed.contains("segments.0.E* is not monotone"), "{printed}");
    let summary = bench.json("robust/summary.json");
    let inside = summary["keys"][0]["inside"].as_array().unwrap();
    let rest = inside.iter().find(|own| own["measure"] == "rest_vibration").unwrap();
    let value = rest["value"].as_f64().unwrap();
    assert!((0.9..0.98).contains(&value), "{value}");
    // The largest of all plants is that of the search.
    let worst = number(&summary, "worst/1/size_m");
    let cells = bench.cells("robust/robust.csv", "rest_vibration");
    let largest = cells.iter().map(|cell| cell.parse::<f64>().unwrap()).fold(0.0, f64::max);
    let travel_m = number(&summary, "travel_m");
    assert!((largest * travel_m / worst - 1.0).abs() < 1e-6, "{largest} {worst}");
    assert!(worst >= rest["size_m"].as_f64().unwrap() * (1.0 - 1e-12));
}

#[test]
fn a_delay_moves_the_played_position_and_nothing_else() {
    let bench = Bench::new();
    let delay = ["--play", "position", "--uncertain", "delay=0..2ms", "--runs", "0"];
    robust(&bench, &delay);
    // A late tip is off by its speed times the delay: the sine motion has a top speed of 2 d/T.
    let rows = bench.rows("robust/robust.csv");
    let late = rows.iter().find(|row| row[0] == "key" && row[1].starts_with("0.0020")).unwrap();
    let found = late[2].parse::<f64>().unwrap() * TRAVEL_M;
    let exact = 0.002 * 2.0 * TRAVEL_M / END_S;
    assert!((found / exact - 1.0).abs() < 2e-3, "{found} is not {exact}");
    bench.refuses(
        2,
        &with(&["robust", LINK, MOTION, "--uncertain"], &["delay=0..2ms"]),
        "--play position",
    );
}

#[test]
fn what_cannot_be_studied_is_refused_by_its_key() {
    let bench = Bench::new();
    let refused = |code: i32, arguments: &[&str], words: &str| {
        bench.refuses(code, &with(&["robust", LINK, MOTION], arguments), words);
    };
    refused(2, &[], "nothing is uncertain");
    // The hint has a form that the file takes, where there is one.
    refused(3, &["--uncertain", "payload.mass=±20 g"], "give its values: payload.mass=LOW..HIGH");
    refused(3, &["--uncertain", "EI*=±5%"], "hint: EI is a key of segments: segments.*.EI");
    refused(3, &["--uncertain", "payload.mass=-0.02..0.02"], "payload.mass = -0.02");
    let of_end = "damping.ratio = 1.5, but must lie in [0, 1)";
    refused(3, &["--uncertain", "damping.ratio=0.5..1.5"], of_end);
    refused(2, &["--uncertain", "segments.*.EI*=5%"], "LOW..HIGH");
    refused(2, &[KEYS[0], KEYS[1], "--play", "feedback"], "--feedback");
    refused(2, &[KEYS[0], KEYS[1], "--play", "effort", "--feedback", "5,1"], "--feedback");
}

#[test]
fn allow_is_a_pass_mark() {
    let bench = Bench::new();
    let study = with(&["robust", LINK, MOTION, "--runs", "100"], &KEYS);
    let warned = bench.told(&with(&study, &["--allow", "1%"]));
    assert!(warned.contains("95 % quantile"), "{warned}");
    bench.ends(4, &with(&study, &["--allow", "1%", "--strict"]));
    bench.done(&with(&study, &["--allow", "40 mm", "--strict", "--deny-warnings"]));
}

/// The plays that give the limited values give the same errors as those of the tip alone; positions then play all samples.
#[test]
fn limits_change_no_error() {
    let bench = Bench::new();
    for (play, most) in [("effort", 1e-9), ("position", 1e-5)] {
        let study = ["--uncertain", "segments.*.EI*=±10%", "--play", play, "--runs", "20"];
        robust(&bench, &study);
        robust(&bench, &with(&study, &["--set", "limits={torque=1.4}", "-o", "limited"]));
        let [free, limited] =
            ["robust", "limited"].map(|run| bench.json(&format!("{run}/summary.json")));
        for measure in 0..3 {
            let size = |of| number(of, &format!("worst/{measure}/size_m"));
            let off = size(&limited) / size(&free) - 1.0;
            assert!(off.abs() < most, "{play}, {measure}: {off:e}");
        }
        let share = number(&limited, "over_limits/0/share");
        assert_eq!(share > 0.1, play == "position", "{share}");
    }
}

#[test]
fn the_table_of_the_link_file_says_what_is_uncertain() {
    let bench = Bench::new();
    let link = std::fs::read_to_string(super::repository(LINK)).unwrap();
    bench.write("link.toml", &format!("{link}\n[uncertainty]\n\"segments.*.EI*\" = \"±10%\"\n"));
    bench.done(&["robust", "link.toml", &super::repository(MOTION), "--runs", "5"]);
    assert_eq!(bench.rows("robust/robust.csv")[0][1], "segments.*.EI*");
    bench.done(&["solve", "link.toml", &super::repository(MOTION)]);
}

/// Largest error in m of a played folder up to a time, less that of another one.
fn largest(bench: &Bench, [folder, nominal]: [&str; 2], until_s: f64) -> f64 {
    let table = |folder: &str| bench.table(&format!("{folder}/tip_error.csv"));
    let [own, nominal] = [folder, nominal].map(table);
    let (times, last) = (&own[0].1, own.len() - 1);
    let kept = times.iter().filter(|time| **time <= until_s).count();
    let pairs = own[last].1.iter().zip(&nominal[last].1).take(kept);
    pairs.map(|(own, nominal)| (own - nominal).abs()).fold(0.0, f64::max)
}

/// Tip error in m of the lower end of a study's only key.
fn lower_end_m(bench: &Bench) -> f64 {
    let share = bench.cells("robust/robust.csv", "tip_error")[1].parse::<f64>().unwrap();
    share * number(&bench.json("robust/summary.json"), "travel_m")
}

/// An arm and a mast with weight, against `simulate` of the changed file.
#[test]
fn bent_links_stray_as_simulate_plays_them() {
    let bench = Bench::new();
    let [arm, path] = ["specs/arms/two_links.toml", "trajectories/arms/line_1.5s.csv"];
    bench.done(&["solve", arm, path, "-o", "arm"]);
    for (folder, factor) in [("nominal", "1"), ("soft", "0.9")] {
        let key = format!("links.*.segments.*.EI*={factor}");
        let play = ["--input", "hub-angle", "--target", "arm/tip.csv", "-o", folder];
        bench.done(&with(&["simulate", arm, "arm/joint_angles.csv", "--set", &key], &play));
    }
    let interval = "links.*.segments.*.EI*=0.9..1.2";
    let study = ["robust", arm, path, "--runs", "0", "--play", "position"];
    bench.done(&with(&study, &["--uncertain", interval]));
    // The softer arm rings with a period of 0.47 s after the motion.
    let (found, exact) = (lower_end_m(&bench), largest(&bench, ["soft", "nominal"], 1.97));
    assert!((found / exact - 1.0).abs() < 5e-3, "{found} is not {exact}");

    let mast = "specs/carriages/stacker_mast.toml";
    let motion = ["trajectory", "septic", "--distance", "2", "--duration", "2", "--step", "0.002"];
    bench.done(&with(&motion, &["-o", "move.csv"]));
    bench.done(&["solve", mast, "move.csv", "-o", "mast"]);
    let target = "mast/tip.csv";
    for (folder, factor) in [("nominal", "1"), ("light", "0.9")] {
        let key = format!("payload.mass*={factor}");
        let play = ["--feedback", "5e4,2e4", "--reference", "mast/carriage.csv"];
        let play = with(&play, &["--target", target, "-o", folder, "--set", &key]);
        bench.done(&with(&["simulate", mast, "mast/force.csv"], &play));
    }
    let study = ["robust", mast, "move.csv", "--runs", "0", "--feedback", "5e4,2e4"];
    bench.done(&with(&study, &["--uncertain", "payload.mass*=0.9..1.2"]));
    let (found, exact) = (lower_end_m(&bench), largest(&bench, ["light", "nominal"], 2.2));
    assert!((found / exact - 1.0).abs() < 5e-3, "{found} is not {exact}");
}
