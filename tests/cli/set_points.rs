//! `solve --write --with`: rows of a drive, in its units and counts, and `simulate` that takes a table back.

use std::f64::consts::TAU;

use super::{Bench, LINK, MOTION, apart, column, number, stderr, stdout};

/// A law of damping that has an equation in time: a simulation of the table finds the same.
const DAMPED: &str = "--set damping={model='rayleigh',beta=1e-3}";

/// A rotor of 2 kg cm² behind a gear of 100.
const GEAR: &str = "--set drive={rotor_inertia=2e-4,gear_ratio=100.0}";

/// The motion with its displacement.
const WANTED: &str = "trajectories/sine_0.88s_displacement.csv";

const ALL: &str = "position,velocity,acceleration,effort";

#[test]
fn columns_are_those_of_the_run_in_the_order_of_the_list() {
    let bench = Bench::new();
    bench.solve(&format!("{GEAR} -o out --write all.csv --with {ALL} --digits full"));
    bench.solve(&format!("{GEAR} --write motor.csv --with effort,position --side motor"));
    let text = bench.read("all.csv");
    assert!(
        text.starts_with("# motion begins at 0 s, in its file at 0 s\n# Bayo"),
        "{}",
        &text[..99]
    );
    let all = bench.table("all.csv");
    let names: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
    let hub = ["hub_angle_rad", "hub_rate_rad_s", "hub_acceleration_rad_s2"];
    assert_eq!(names, [&["time_s"], &hub[..], &["torque_n_m"]].concat());
    for name in hub {
        assert_eq!(column(&bench, "all.csv", name), column(&bench, "out/hub_angle.csv", name));
    }
    assert_eq!(all[4].1, column(&bench, "out/torque.csv", "torque_n_m"));
    let names = bench.table("motor.csv").into_iter().map(|(name, _)| name);
    let names: Vec<String> = names.collect();
    assert_eq!(names, ["time_s", "motor_torque_n_m", "motor_angle_rad"]);
    for name in &names[1..] {
        let [own, of_run] = ["motor.csv", "out/motor.csv"].map(|file| column(&bench, file, name));
        assert!(apart(&own, &of_run) < 1e-8, "{name}");
    }
}

#[test]
fn a_table_in_units_of_the_drive_is_played_as_that_in_si() {
    let bench = Bench::new();
    let units = ["--units", "effort=N cm,position=deg"];
    let cycle = format!("{DAMPED} -q --with position,effort --cycle 2e-3");
    bench.solve(&super::with(&format!("{cycle} --write drive.csv"), &units));
    bench.solve(&format!("{cycle} --write si.csv"));
    let names = bench.table("drive.csv").into_iter().map(|(name, _)| name).collect::<Vec<_>>();
    assert_eq!(names, ["time_s", "hub_angle [deg]", "torque [N cm]"]);
    let [degrees, radians] = [("drive.csv", "hub_angle [deg]"), ("si.csv", "hub_angle_rad")]
        .map(|(file, name)| column(&bench, file, name));
    assert!(apart(&degrees, &radians.iter().map(|x| x.to_degrees()).collect::<Vec<_>>()) < 1e-8);
    for table in ["drive.csv", "si.csv"] {
        bench.done(&format!("simulate {LINK} {table} {DAMPED} -q -o {table}.out"));
    }
    let tips = ["drive.csv.out/tip.csv", "si.csv.out/tip.csv"];
    let tips = tips.map(|file| column(&bench, file, "tip_displacement_m"));
    assert!(apart(&tips[0], &tips[1]) < 1e-8);
}

/// The claim for the effort is that of a simulation; the position held by a fine drive strays far less.
#[test]
fn a_shifted_table_is_taken_back_by_the_line_of_its_motion() {
    let bench = Bench::new();
    let table = "--write cut.csv --with position,effort --window 0.5% --start-at 0";
    let output = bench.run(&format!("solve {LINK} {MOTION} {DAMPED} -o out {table}"));
    let text = stdout(&output);
    assert!(
        text.contains("         where the drive holds the position:\n         tip off"),
        "{text}"
    );
    assert!(
        text.contains("         where the drive holds the effort:\n         tip off"),
        "{text}"
    );
    let summary = bench.json("out/summary.json");
    let of = |key: &str| number(&summary["table"], key);
    let [position_m, effort_m] =
        ["position", "effort"].map(|held| of(&format!("tip_errors/{held}/worst_m")));
    assert!(position_m < 0.5 * effort_m, "{position_m} {effort_m}");
    assert_eq!(of("tip_error/worst_m").to_bits(), position_m.to_bits());
    let end_s = column(&bench, "out/tip.csv", "time_s").last().copied().unwrap();
    // The table is played at the times of the motion's file, which a solved tip has, too.
    let play = format!("simulate {LINK} cut.csv {DAMPED}");
    let told = bench.told(&format!("{play} --target out/tip.csv --until {end_s}"));
    let shift =
        format!("times shifted by -{} s, to those of the motion's file", of("moves_from_s"));
    assert!(told.contains(&format!("note: cut.csv: read {shift}")), "{told}");
    let found_m = bench.number("simulated", "tip_error/worst_m");
    assert!((found_m / effort_m - 1.0).abs() < 0.02, "{found_m} {effort_m}");
    bench.done(&format!("{play} --target {WANTED} -q"));
    assert!(bench.number("simulated", "tip_error/share") < 5e-3);
    // The reference is longer than the table.
    let around = format!("--feedback 200,5 --reference out/hub_angle.csv --target {WANTED}");
    bench.done(&format!("{play} {around} -q"));
    // It begins with the angle that the table cuts.
    assert!(bench.number("simulated", "tip_error/share") < 2e-3);
    // The table itself may be the reference, the recording, or the torque of a sweep.
    let told = bench.told(&format!("{play} --feedback 200,5 --reference cut.csv"));
    assert_eq!(told.matches(&shift).count(), 2, "{told}");
    bench.done(&format!("{play} --measured out/hub_angle.csv -q"));
    let channel = &bench.json("simulated/summary.json")["measured"]["channels"][0];
    assert!(number(channel, "share") < 0.1, "{channel}");
    assert!(number(channel, "fit/delay_s").abs() < 5e-3, "{channel}");
    let sweep = "--vary payload.mass=0,0.1 --torque cut.csv -o sweep.csv -q";
    bench.done(&format!("sweep {LINK} {WANTED} {DAMPED} {sweep}"));
    assert!(bench.numbers("sweep.csv", "tip_error_m")[0] < 5e-3 * 0.5);
}

#[test]
fn efforts_of_motors_turn_their_rotors_and_an_elastic_transmission_is_told() {
    let bench = Bench::new();
    let write = "--write cut.csv --with position,effort --window 0.5%";
    let error_m = |drive: &str, side: &str, held: &str| {
        let all = format!("solve {LINK} {MOTION} {DAMPED} {drive} {write} --side {side} --json");
        let reply = super::json_of(&bench.run(&all));
        let error = &reply["table"]["tip_errors"][held]["worst_m"];
        error.as_f64()
    };
    // Through a stiff gear the cut of one side is about that of the other: the rotor's part of the torque rests, too.
    for held in ["position", "effort"] {
        let [joint_m, motor_m] = ["joint", "motor"].map(|side| error_m(GEAR, side, held).unwrap());
        assert!((0.3..3.0).contains(&(joint_m / motor_m)), "{held}: {joint_m} {motor_m}");
    }
    let elastic = GEAR.replace('{', "{joint_stiffness=100.0,");
    let spring_m = error_m(&elastic, "motor", "position").unwrap();
    assert!((1e-6..1e-2).contains(&spring_m), "{spring_m}");
    assert_eq!(error_m(&elastic, "motor", "effort"), None);
    let output = bench.run(&format!("solve {LINK} {MOTION} {elastic} {write} --side motor"));
    let not = "         not played where the drive holds the effort of its motor:\n";
    assert!(stdout(&output).contains(not), "{}{}", stdout(&output), stderr(&output));
}

/// Straight lines and stairs leave their images, and the finer the counts the less the rounding.
#[test]
fn rounding_cycle_and_hold_cost_what_they_must() {
    let bench = Bench::new();
    let error = |options: &str| {
        let all = format!(
            "solve {LINK} {MOTION} {DAMPED} --write p.csv --with position --json {options}"
        );
        number(&super::json_of(&bench.run(&all)), "table/tip_error/share")
    };
    let counts = |bits: u32| {
        format!("--hold zero --counts position={}/360 --units position=deg", 1_u64 << bits)
    };
    let [coarse, fine] = [12, 20].map(|bits| error(&counts(bits)));
    assert!((1e-3..1e-2).contains(&coarse) && fine < 0.02 * coarse, "{coarse} {fine}");
    let holds = ["--cycle 4e-3 --hold linear", "--cycle 4e-3 --hold zero"].map(error);
    assert!(holds[0] < 1e-4 && holds[0] < holds[1] && holds[1] < 2e-3, "{holds:?}");
    // A drive that holds the velocity draws lines of position.
    let velocity =
        format!("solve {LINK} {MOTION} {DAMPED} --write v.csv --with velocity --hold zero --json");
    let velocity =
        number(&super::json_of(&bench.run(&velocity)), "table/tip_errors/velocity/share");
    assert!(velocity < 1e-4, "{velocity}");
}

/// A bench with turning.csv, a cycle that turns on, with a velocity in m/s of twice its frequency.
fn turning(twice_m_s: f64) -> Bench {
    let bench = Bench::new();
    bench.sampled("turning.csv", "time,velocity", 0..80, |k| {
        let (once, twice) = ((TAU * k / 80.0).sin(), (TAU * k / 40.0).cos());
        [0.0125 * k, 0.6 + 0.3 * once + twice_m_s * twice]
    });
    bench
}

/// Held values of a cycle that turns on follow its turning: stairs lead the angle by half a step, lines meet it.
#[test]
fn a_turning_cycle_is_held_without_ringing() {
    let bench = turning(0.0);
    let solve = format!("solve {LINK} turning.csv {DAMPED} --periodic -q -o out --digits full");
    let held = |hold: &str| {
        bench.done(&format!("{solve} --write p.csv --with position --hold {hold}"));
        column(&bench, "p.csv", "hub_angle_rad")
    };
    let (stairs, lines) = (held("zero"), held("linear"));
    let angle_rad = column(&bench, "out/hub_angle.csv", "hub_angle_rad");
    let between: Vec<f64> = angle_rad.windows(2).map(|two| f64::midpoint(two[0], two[1])).collect();
    // The angle turns by 5e-3 rad in a step, and bends away from a line by 3e-5 rad at most.
    let off = |held: &[f64], wanted: &[f64]| {
        held.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let found = [off(&stairs, &between), off(&lines, &angle_rad)];
    assert!(found.iter().all(|off| *off < 1e-4), "{found:?}");
}

#[test]
fn velocities_of_a_cycle_that_drift_are_not_played() {
    let bench = turning(0.1);
    let told = |counts: &str| {
        let write = format!("--write v.csv --with velocity --hold zero {counts}");
        let text = stdout(&bench.run(&format!("solve {LINK} turning.csv --periodic {write}")));
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let (drifts, exact) = (told("--counts velocity=103/2rad/s"), told(""));
    let reason = "and the position drifts by this in each cycle";
    assert!(drifts.contains("not played") && drifts.contains(reason), "{drifts}");
    assert!(!exact.contains("not played") && exact.contains("tip off at the rows"), "{exact}");
}

/// A cut leaves the carriage of a table some speed in its last row, where the drive and the simulation stop it.
#[test]
fn a_cut_table_of_positions_simulates_to_its_claim() {
    let bench = Bench::new();
    let words = ["trajectory", "septic", "--distance", "200 mm", "--duration", "600 ms"];
    bench.done(&[&words[..], &["--step", "1 ms", "-o", "move.csv"]].concat());
    let link = "specs/carriages/sheet.toml";
    let level = ["--set", "gravity=[0, 0]"];
    for hold in ["", "--hold linear"] {
        let write = format!(
            "solve {link} move.csv --write p.csv --with position --cycle 2e-3 --window 0.01% {hold} --json -o out"
        );
        let reply = super::json_of(&bench.run(&super::with(&write, &level)));
        let claimed = number(&reply, "table/tip_error/share");
        let play = format!("simulate {link} p.csv --input carriage --target out/tip.csv");
        let told = bench.told(&super::with(&play, &level));
        let found = bench.number("simulated", "tip_error/share");
        assert!((1e-4..2e-4).contains(&claimed), "{hold}: {claimed}");
        assert!((found / claimed - 1.0).abs() < 0.05, "{hold}: {found} {claimed} {told}");
    }
}

/// Values for stairs lead their curve by half a cycle: nothing but stairs is played of them.
#[test]
fn a_table_for_stairs_is_played_as_stairs_alone() {
    let bench = Bench::new();
    let cycle = format!("{DAMPED} -o out -q --cycle 2e-3");
    bench.solve(&format!("{cycle} --write both.csv --with effort,position --hold zero"));
    bench.solve(&format!("{cycle} --write smooth.csv --with effort,position"));
    let held = "# motion begins at 0 s, in its file at 0 s, held to the next row\n";
    assert!(bench.read("both.csv").starts_with(held), "{}", &bench.read("both.csv")[..99]);
    let message = "both.csv: each row is held to the next, as its comment says, but must be samples of a smooth curve";
    let around = |options: &str| format!("simulate {LINK} {options} {DAMPED} --feedback 200,5 -q");
    for (play, hint) in [
        (format!("simulate {LINK} both.csv {DAMPED}"), "use --hold zero"),
        (format!("simulate {LINK} both.csv {DAMPED} --hold linear"), "use --hold zero"),
        (
            format!("simulate {LINK} both.csv {DAMPED} --input hub-angle"),
            "write the table without --hold zero",
        ),
        (around("smooth.csv --reference both.csv"), "use --hold zero, which holds TORQUE, too"),
    ] {
        let text = stderr(&bench.ends(3, &play));
        let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains(message) && words.contains(hint), "{play}: {text}");
    }
    // Torque and reference come as stairs, as the table is for: the tip is as near as that of the smooth table.
    let strays = |options: &str| {
        bench.done(&format!("{} --target {WANTED}", around(options)));
        bench.number("simulated", "tip_error/share")
    };
    let stairs = strays("both.csv --hold zero --reference both.csv");
    let late = strays("both.csv --hold zero --reference smooth.csv");
    assert!(stairs < 1e-3 && stairs < 0.5 * late, "{stairs} {late}");
}

/// Joints of an arm on a carriage that move at the ends of their recording are named one by one.
#[test]
fn joints_that_move_at_the_ends_of_a_recording_are_told() {
    let bench = Bench::new();
    let ramp = |from: f64, rate: f64| move |k: f64| [0.002 * k, from + rate * 0.002 * k];
    let [first, carriage] = [ramp(0.3, 0.1), ramp(0.0, 0.2)];
    bench.sampled("joints.csv", "time_s,joint1,joint2", 0..101, |k| {
        let [time_s, angle_rad] = first(k);
        [time_s, angle_rad, 0.5]
    });
    bench.sampled("carriage.csv", "time_s,carriage", 0..101, carriage);
    let play = "simulate specs/carriages/gantry_arm.toml joints.csv --input hub-angle";
    let told = |options: &str| stderr(&bench.run(&format!("{play} {options}")));
    let (to_the_end, beyond) = (told(""), told("--until 0.3"));
    for (name, rate) in [("joint 1", "0.1 rad/s"), ("carriage", "0.2 m/s")] {
        let begins = format!(
            "warning: {name} begins with {rate}, 100.0 % of its peak rate: it rests before"
        );
        let ends =
            format!("warning: {name} ends with {rate}, 100.0 % of its peak rate: it stops within");
        assert!(to_the_end.contains(&begins) && !to_the_end.contains(&ends), "{to_the_end}");
        assert!(beyond.contains(&begins) && beyond.contains(&ends), "{beyond}");
    }
    assert!(!beyond.contains("joint 2"), "{beyond}");
    let angles_rad = column(&bench, "simulated/joint_angles.csv", "joint1_rad");
    assert!(angles_rad[101..].iter().all(|angle| (angle - 0.32).abs() < 1e-9), "{angles_rad:?}");
}
