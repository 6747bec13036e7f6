//! Sweeps that play feedback, motions of the joints and voltages on every case.

use super::sweep::{sweep, swept};
use super::{Bench, LINK, MOTION, apart, column, number, peak, refusal, septic, stdout};

/// What a test plays on two cases, and compares with `simulate`.
struct Plays<'a> {
    link: &'a str,
    motion: &'a str,
    /// The varied key and its values.
    key: &'a str,
    values: [&'a str; 2],
    /// Options of both commands.
    options: &'a str,
    travel_m: f64,
    /// Columns of the tip in its table, and other columns of the row with their places in the summary.
    tip: &'a [&'a str],
    others: &'a [(&'a str, &'a str)],
}

impl Plays<'_> {
    /// Compares every row and its files with `simulate`. Returns the share by which each tip strays.
    #[track_caller]
    fn as_simulated(&self, bench: &Bench, played: &str) -> Vec<f64> {
        let Self { link, motion, key, values: [first, second], options, travel_m, .. } = self;
        let vary = format!("--vary {key}={first},{second} --torque {played} {options}");
        bench.done(&format!("sweep {link} {motion} {vary} -o s.csv --outputs cases"));
        bench.done("report s.csv -q");
        // The sweep holds the tip against the motion asked for, `out/tip.csv` is within 1e-6 of it.
        let within_m = 2e-6 * travel_m;
        for (case, value) in self.values.iter().enumerate() {
            let set = format!("{options} --target out/tip.csv --set {key}={value} -o alone");
            bench.done(&format!("simulate {link} {played} {set}"));
            let summary = bench.json("alone/summary.json");
            for (name, path) in [
                ("tip_error_m", "tip_error/worst_m"),
                ("rms_tip_error_m", "tip_error/rms_m"),
                ("final_tip_error_m", "tip_error/final_m"),
            ] {
                let (own, alone) = (bench.numbers("s.csv", name)[case], number(&summary, path));
                assert!((own - alone).abs() < within_m, "{played}, {name}: {own} {alone}");
            }
            for (name, path) in self.others {
                let (own, alone) = (bench.numbers("s.csv", name)[case], number(&summary, path));
                assert!((own / alone - 1.0).abs() < 1e-5, "{played}, {name}: {own} {alone}");
            }
            let own = bench.json(&format!("cases/{}/summary.json", case + 1));
            for input in ["torque", "hub_angle", "force", "carriage", "reference"] {
                assert_eq!(own["inputs"][input], summary["inputs"][input], "{played}, {input}");
            }
            for name in self.tip {
                let of = |folder: &str| column(bench, &format!("{folder}/tip.csv"), name);
                let off = apart(&of(&format!("cases/{}", case + 1)), &of("alone"));
                assert!(off < within_m, "{played}, {name}: {off:e}");
            }
        }
        bench.numbers("s.csv", "tip_error_share")
    }
}

const STIFFER: Plays<'_> = Plays {
    link: LINK,
    motion: MOTION,
    key: "segments.*.EI*",
    values: ["1", "1.1"],
    options: "",
    travel_m: 0.5,
    tip: &["tip_displacement_m"],
    others: &[
        ("peak_torque_n_m", "results/peak_torque_n_m"),
        ("peak_hub_rate_rad_s", "results/peak_hub_rate_rad_s"),
        ("residual_m", "residual/amplitude_m"),
    ],
};

#[test]
fn feedback_and_moved_hubs_play_on_links_as_simulate_plays_them() {
    let bench = Bench::new();
    bench.solve("-q --digits full");
    STIFFER.as_simulated(&bench, "out/torque.csv --feedback 20,2 --reference out/hub_angle.csv");
    STIFFER.as_simulated(&bench, "out/hub_angle.csv --input hub-angle");
    // The torque of feedback differs from case to case, and so may its limit be exceeded.
    let [soft, stiff] = ["1.37", "1.5"];
    let limit = "--set limits={torque=1.45} -o limited.csv";
    let feedback = "--torque out/torque.csv --feedback 20,2 --reference out/hub_angle.csv";
    swept(&bench, &format!("--vary segments.*.EI*=1,1.1 {feedback} {limit}"));
    let rows = bench.rows("limited.csv");
    let peak = rows[0].iter().position(|name| name == "peak_torque_n_m").unwrap();
    let warned = rows[0].len() - 2;
    for (row, (starts, warning)) in
        rows[1..].iter().zip([(soft, ""), (stiff, "limit_exceeded:torque")])
    {
        assert!(row[peak].starts_with(starts), "{row:?}");
        assert_eq!(row[warned], warning, "{row:?}");
    }
}

#[test]
fn a_voltage_plays_through_the_motor_of_each_case() {
    let bench = Bench::new();
    let motor = "gear_ratio=50.0,rotor_inertia=1e-5,torque_constant=0.05,resistance=1.0";
    let drive = format!("--set drive={{{motor}}}");
    bench.solve(&format!("-q --digits full {drive}"));
    let plays =
        Plays { key: "drive.torque_constant*", values: ["1", "1.2"], options: &drive, ..STIFFER };
    let shares = plays.as_simulated(&bench, "out/motor.csv --input voltage");
    assert!(shares[0] < 0.01 && shares[1] > 0.2, "{shares:?}");
    let played = "--vary payload.mass=0,0.1 --torque out/motor.csv --input voltage";
    let words = "the first: bayo1987_example1.toml: drive.torque_constant = nothing, but must be";
    refusal(4, sweep(&bench, played), words);
}

#[test]
fn feedback_and_moved_joints_play_on_arms_as_simulate_plays_them() {
    let bench = super::arms::bench();
    bench.done("solve arm.toml path.csv -q --digits full");
    let heavier = Plays {
        link: "arm.toml",
        motion: "path.csv",
        key: "links.fore.payload.mass*",
        values: ["1", "1.2"],
        options: "",
        travel_m: 0.6,
        tip: &["x_m", "y_m"],
        others: &[
            ("peak_torque1_n_m", "results/joints/0/peak_torque_n_m"),
            ("peak_hub_rate2_rad_s", "results/joints/1/peak_hub_rate_rad_s"),
        ],
    };
    let feedback = "out/torques.csv --feedback 50,1,30,1 --reference out/joint_angles.csv";
    let shares = heavier.as_simulated(&bench, feedback);
    assert!(shares[0] < 1e-5 && shares[1] > 1e-2, "{shares:?}");
    let record = bench.json("s.json");
    let arguments = serde_json::json!(["--feedback", "50,1,30,1", "--outputs", "cases"]);
    assert_eq!(record["inputs"]["arguments"], arguments);
    assert_eq!(record["inputs"]["reference"]["name"], "joint_angles.csv");
    let moved = heavier.as_simulated(&bench, "out/joint_angles.csv --input hub-angle");
    assert!(moved[0] < 1e-4 && moved[1] < shares[1], "{moved:?} {shares:?}");
}

/// A link on a carriage that hardly bends, moved along a septic: the whole mass times its acceleration.
#[test]
fn a_moved_carriage_takes_the_force_of_its_masses() {
    let bench = Bench::new();
    bench.write(
        "cart.toml",
        "[carriage]\nmass = 10\n[damping]\nmodel = 'rayleigh'\nbeta = 1e-5\n\
         [[segments]]\nlength = 0.5\nEI = 1e6\nmass_per_length = 2\n[payload]\nmass = 1\n",
    );
    let place = |k: f64| [k / 500.0, 0.3 * septic(k / 500.0)];
    bench.sampled("move.csv", "time,displacement", 0..=500, place);
    bench.sampled("rail.csv", "time,carriage", 0..=500, place);
    let moved = "--torque rail.csv --input carriage --vary payload.mass=1,3 -o s.csv";
    bench.done(&format!("sweep cart.toml move.csv {moved}"));
    let acceleration = |t: f64| 420.0 * t * t * (1.0 - t) * (1.0 - t) * (1.0 - 2.0 * t);
    let all: Vec<f64> = (0..=10_000).map(|k| 0.3 * acceleration(f64::from(k) * 1e-4)).collect();
    for (force_n, mass_kg) in bench.numbers("s.csv", "peak_force_n").iter().zip([12.0, 14.0]) {
        let expected = mass_kg * peak(&all);
        assert!((force_n / expected - 1.0).abs() < 1e-4, "{force_n} {expected}");
    }
    assert!(bench.numbers("s.csv", "tip_error_share").iter().all(|share| *share < 1e-5));
}

#[test]
fn feedback_and_moved_carriages_play_as_simulate_plays_them() {
    let bench = Bench::new();
    let mast = std::fs::read_to_string(super::repository("specs/carriages/stacker_mast.toml"));
    let viscous = mast.unwrap().replace("ratio = 0.01", "model = \"rayleigh\"\nbeta = 7e-4");
    bench.write("mast.toml", &viscous);
    bench.done("trajectory septic --distance 2 --duration 2 --step 0.002 -o move.csv");
    bench.done("solve mast.toml move.csv -q --digits full");
    let plays = Plays {
        link: "mast.toml",
        motion: "move.csv",
        key: "payload.mass",
        values: ["40", "80"],
        travel_m: 2.0,
        others: &[("peak_force_n", "results/peak_force_n")],
        ..STIFFER
    };
    plays.as_simulated(&bench, "out/force.csv --feedback 5e4,2e3 --reference out/carriage.csv");
    plays.as_simulated(&bench, "out/carriage.csv --input carriage");
}

#[test]
fn an_arm_on_a_carriage_is_held_by_feedback_of_all_its_joints() {
    let bench = Bench::new();
    let gantry = "specs/carriages/gantry_arm.toml";
    bench.done(&format!("solve {gantry} trajectories/arms/gantry_1.5s.csv --digits full -q"));
    let heavier = Plays {
        link: gantry,
        motion: "trajectories/arms/gantry_1.5s.csv",
        key: "carriage.mass",
        values: ["12", "15"],
        options: "",
        travel_m: 1.0,
        tip: &["x_m", "y_m"],
        others: &[("peak_force_n", "results/carriage/peak_force_n")],
    };
    let feedback = "--feedback 1000,50,1000,50,20000,1000 --reference out/joint_angles.csv";
    let held = heavier.as_simulated(&bench, &format!("out/torques.csv {feedback}"));
    let open = {
        let open = "--torque out/torques.csv --vary carriage.mass=12,15 -o open.csv";
        bench.done(&format!("sweep {gantry} trajectories/arms/gantry_1.5s.csv {open}"));
        bench.numbers("open.csv", "tip_error_share")
    };
    assert!(held[0] < 2e-6 && held[1] < 0.1 * open[1], "{held:?} {open:?}");
    let inputs = &bench.json("s.json")["inputs"];
    for (role, name) in [
        ("torque", "torques.csv"),
        ("force", "force.csv"),
        ("reference", "joint_angles.csv"),
        ("carriage_reference", "carriage.csv"),
    ] {
        assert_eq!(inputs[role]["name"], name, "{role}");
    }
}

#[test]
fn a_sweep_of_other_gains_or_another_reference_does_not_go_on() {
    let bench = Bench::new();
    bench.solve("-q");
    let vary = "--vary segments.*.EI*=1,1.1 --torque out/torque.csv";
    let held = format!("{vary} --feedback 20,2 --reference out/hub_angle.csv");
    swept(&bench, &format!("{held} --shard 1/2"));
    let again = |options: &str| sweep(&bench, &format!("{options} --shard 1/2 --resume"));
    assert_eq!(stdout(&again(&held)), "complete sweep-1-of-2.csv, 1 case\n");
    let other = held.replace("20,2", "20,3");
    let words = "inputs.arguments = \"--feedback 20,2\", but must be \"--feedback 20,3\"";
    refusal(3, again(&other), words);
    refusal(3, again(vary), "inputs.reference.sha256 = \"");
    let moved = "--vary segments.*.EI*=1,1.1 --torque out/hub_angle.csv --input hub-angle";
    refusal(3, again(moved), "inputs.torque.sha256 = \"");
    bench.write("other.csv", &bench.read("out/hub_angle.csv").replacen("time_s", "time", 1));
    refusal(3, again(&held.replace("out/hub_angle", "other")), "inputs.reference.sha256 = \"");
    // Nor does it join.
    swept(&bench, &format!("{other} --shard 2/2"));
    let both = "sweep --merge sweep-1-of-2.csv sweep-2-of-2.csv -o s.csv";
    bench.refuses(3, both, "inputs.arguments = \"--feedback 20,3\", but must be");
}

#[test]
fn what_simulate_refuses_to_play_a_sweep_refuses() {
    let bench = Bench::new();
    bench.solve("-q");
    let text = bench.read("out/hub_angle.csv");
    let half: Vec<&str> = text.lines().step_by(2).collect();
    bench.write("half.csv", &half.join("\n"));
    let torque = "--torque out/torque.csv";
    let moved = "--torque out/hub_angle.csv --input hub-angle";
    let around = "--reference out/hub_angle.csv";
    for (code, options, words) in [
        (2, format!("{torque} --feedback 20,2"), "--reference <FILE>"),
        (2, format!("--feedback 20,2 {around}"), "--torque <TORQUE>"),
        (2, "--input hub-angle".into(), "--torque <TORQUE>"),
        (2, format!("{torque} --feedback 1,1,1,1 {around}"), "--feedback = 2 pairs, but must be 1"),
        (2, format!("{torque} --feedback 20,-2 {around}"), "--feedback: KD = -2 N m s/rad, but"),
        (
            2,
            format!("{torque} --input force"),
            "--input = force, but must be torque or hub-angle for a hub",
        ),
        (
            2,
            format!("{moved} --feedback 20,2 {around}"),
            "hint: a hub that moves as prescribed needs no feedback",
        ),
        (2, format!("{moved} --column x"), "hint: the column is hub_angle; simulate chooses"),
        (2, format!("{moved} --hold zero"), "--input = hub-angle, but must be torque with --hold"),
        (
            3,
            format!("{torque} --feedback 20,2 --reference half.csv"),
            "half.csv: the reference has",
        ),
        (
            3,
            format!("{torque} --feedback 20,2 --reference half.csv"),
            "hint: take hub_angle.csv and torque.csv of one run of solve",
        ),
        (3, "--torque out/torque.csv --input hub-angle".into(), "hub_angle"),
    ] {
        refusal(code, sweep(&bench, &format!("--vary payload.mass=0,0.1 {options}")), words);
    }
    assert!(bench.names(".").iter().all(|name| !name.starts_with("sweep.csv")));
}
