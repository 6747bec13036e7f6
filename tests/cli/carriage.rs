//! A link on a carriage: its files, its words, and what refuses it.

use super::{Bench, column, ended, number, repository, septic, stderr, stdout, succeeded};

const MAST: &str = "specs/carriages/stacker_mast.toml";
const SHEET: &str = "specs/carriages/sheet.toml";
const HUB: &str = "specs/bayo1987_example1.toml";

/// A bench with the motion of the mast.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.done("trajectory septic --distance 2 --duration 2 --step 0.002 -o move.csv");
    bench
}

#[test]
fn the_force_of_a_mast_is_that_of_a_program_written_separately() {
    let bench = bench();
    let text = stdout(&succeeded(bench.run(&format!("solve {MAST} move.csv -o out"))));
    let peak_n = bench.number("out", "results/peak_force_n");
    for words in ["force    peak 4849 N at ", "carriage moves by up to ", " m/s, ", " N m"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    for words in ["torque", "hub", "rad"] {
        assert!(!text.contains(words), "{words}: {text}");
    }
    let force = column(&bench, "out/force.csv", "force_n");
    let largest = force.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
    // Forty Hermite elements and an FFT of 8192 samples, in another language; the peak lies between two samples.
    assert!((largest / 4848.576 - 1.0).abs() < 2e-6, "{largest}");
    assert!((1.0..1.0 + 1e-5).contains(&(peak_n / largest)), "{largest} {peak_n}");
    let of = |name: &str| column(&bench, "out/carriage.csv", name);
    let place = of("carriage_m");
    // The slow tail of hysteretic damping is left over at both ends.
    let (first_m, last_m) = (place[0], place[place.len() - 1]);
    assert!(first_m.abs() < 1e-5 && (last_m - 2.0).abs() < 1e-5, "{first_m} {last_m}");
    for name in ["carriage_velocity_m_s", "carriage_acceleration_m_s2", "rigid_carriage_m"] {
        assert_eq!(of(name).len(), force.len(), "{name}");
    }
    let moment = of("root_moment_n_m").iter().fold(0.0_f64, |most, own| most.max(own.abs()));
    let peak_n_m = bench.number("out", "results/peak_root_moment_n_m");
    assert!((moment / peak_n_m - 1.0).abs() < 1e-3, "{moment} {peak_n_m}");
    let rigid = column(&bench, "out/rigid_force.csv", "rigid_force_n");
    assert_eq!(rigid.len(), force.len());
}

#[test]
fn the_force_is_verified_in_words_of_a_carriage() {
    let bench = bench();
    let text = stdout(&succeeded(bench.run(&format!("verify {MAST} move.csv"))));
    assert!(text.contains("F/a_tip by assembled matrices"), "{text}");
    assert!(!text.contains("torque") && !text.contains("hub"), "{text}");
}

#[test]
fn modes_are_those_with_the_carriage_free_and_held() {
    let bench = bench();
    let text = stdout(&succeeded(bench.run(&format!("modes {MAST}"))));
    assert!(text.contains("carriage free\n") && text.contains("carriage held\n"), "{text}");
    assert!(!text.contains("hub"), "{text}");
}

#[test]
fn a_sweep_and_a_response_have_the_columns_of_a_carriage() {
    let bench = bench();
    bench.done(&format!("sweep {MAST} move.csv --vary payload.mass=40,80 -o sweep.csv"));
    let text = bench.read("sweep.csv");
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let at = rows[0].iter().position(|name| *name == "peak_force_n").unwrap();
    let forces: Vec<f64> = rows[1..].iter().map(|row| row[at].parse().unwrap()).collect();
    bench.done(&format!("solve {MAST} move.csv --set payload.mass=80 -o out"));
    let alone = bench.number("out", "results/peak_force_n");
    assert!((forces[1] / alone - 1.0).abs() < 1e-9, "{forces:?} {alone}");
    assert!(!text.contains("torque") && !text.contains("hub"), "{text}");
    bench.done(&format!("frf {MAST} --from 0.01 --to 20 --points 3 -o frf.csv"));
    // At rest the force moves the whole mass.
    let inertia = column(&bench, "frf.csv", "force_per_tip_acceleration_kg_real");
    let place = column(&bench, "frf.csv", "carriage_per_tip_displacement_real");
    let mass_kg = bench.number("out", "link/rigid_mass_kg") - 40.0;
    assert!((inertia[0] / mass_kg - 1.0).abs() < 1e-4, "{inertia:?} {mass_kg}");
    assert!((place[0] - 1.0).abs() < 1e-4, "{place:?}");
}

#[test]
fn limits_of_force_and_speed_are_checked() {
    let bench = bench();
    let solve =
        |limits: &str| bench.run(&format!("solve {MAST} move.csv {limits} --strict -o out"));
    succeeded(solve("--set limits.force=5000 --set limits.carriage_speed=2.2"));
    assert!((bench.number("out", "limits/force_n") - 5e3).abs() < 1e-9);
    let told = stderr(&ended(4, solve("--set limits.force=4000")));
    assert!(told.contains("limits.force = 4000 N is exceeded at the carriage: 4848.6 N"), "{told}");
    let told = stderr(&ended(4, solve("--set limits.carriage_speed=2")));
    assert!(told.contains("limits.carriage_speed = 2 m/s is exceeded: 2.14"), "{told}");
    let told = stderr(&ended(
        3,
        bench.run(
            "solve specs/bayo1987_example1.toml trajectories/sine_0.88s.csv --set limits.force=2",
        ),
    ));
    assert!(told.contains("limits.force must be torque at a hub"), "{told}");
}

#[test]
fn what_a_carriage_does_not_take_is_refused_in_words() {
    let bench = bench();
    let refused = |words: &str| stderr(&ended(3, bench.run(words)));
    bench.write("angle.csv", "time,angle\n0,0\n0.1,0\n0.2,0.1\n0.3,0.2\n0.4,0.2\n");
    let cases = [
        (format!("solve {MAST} angle.csv"), "displacement, velocity or acceleration"),
        (
            format!("solve {MAST} move.csv --set hub.inertia=1"),
            "hub must not be there beside [carriage]",
        ),
        (format!("solve {MAST} move.csv --set gravity=[0,-9.81]"), "start_angle is missing"),
        (format!("solve {MAST} move.csv --set limits.motor_rate=2"), "must come with a [drive]"),
        (
            format!("solve {MAST} move.csv --set drive.gear_ratio=2"),
            "drive.pinion_radius is missing",
        ),
        (
            format!("solve {MAST} move.csv --set drive={{pinion_radius=1,joint_stiffness='5J'}}"),
            "drive.joint_stiffness must be in N/m on a carriage",
        ),
        (format!("solve {MAST} move.csv --set limits.torque=2"), "limits.torque must be force"),
        (format!("solve {MAST} move.csv --set limits.force=-2"), "limits.force = -2 N, but must"),
        (format!("solve {MAST} move.csv --set limits.hub_angle=2"), "must be carriage_travel"),
        (format!("simulate {MAST} move.csv"), "must include force"),
        (format!("simulate {MAST} angle.csv --input carriage"), "must include carriage"),
        (format!("frf {MAST} --at 0"), "the direction of a link on a carriage is its start_angle"),
        (
            "modes specs/carriages/sheet.toml --at 0".to_owned(),
            "the direction of a link on a carriage is its start_angle",
        ),
    ];
    for (words, expected) in cases {
        let told = refused(&words);
        assert!(told.contains(expected), "{words}: {told}");
    }
    let mass = format!("solve specs/bayo1987_example1.toml {} --set hub.mass=2", super::MOTION);
    assert!(refused(&mass).contains("hint: a hub that slides is a [carriage]"));
    bench.done(&format!("solve {MAST} move.csv -o run"));
    let told = refused(&format!("simulate {MAST} run/force.csv --target angle.csv"));
    assert!(told.contains("angle.csv: angle, but a link on a carriage"), "{told}");
    let usage = |words: &str| stderr(&ended(2, bench.run(words)));
    let kinds = [
        (format!("simulate {MAST} run/force.csv --input torque"), "must be force or carriage"),
        (format!("simulate {HUB} run/force.csv --input carriage"), "must be torque or hub-angle"),
        (
            "simulate specs/carriages/gantry_arm.toml run/force.csv --input carriage".to_owned(),
            "must be torque or hub-angle for an arm",
        ),
        (
            format!("simulate {MAST} run/carriage.csv --input carriage --hold zero"),
            "--input = carriage, but must be force with --hold",
        ),
        (
            format!("simulate {MAST} run/force.csv --feedback=-1,0 --reference run/carriage.csv"),
            "KP = -1 N/m",
        ),
        (
            format!(
                "trajectory septic --distance 9deg --step 0.01 --link {MAST} --fit-limit force=9"
            ),
            "must be a length on a carriage",
        ),
    ];
    for (words, expected) in kinds {
        let told = usage(&words);
        assert!(told.contains(expected), "{words}: {told}");
    }
}

/// The mast with a damping that has an equation in time.
fn viscous(bench: &Bench) {
    let mast = std::fs::read_to_string(super::repository(MAST)).unwrap();
    bench.write("mast.toml", &mast.replace("ratio = 0.01", "model = \"rayleigh\"\nbeta = 7e-4"));
}

#[test]
fn a_run_is_compared_repeated_and_kept_as_golden() {
    let bench = bench();
    bench.done(&format!("solve {MAST} move.csv -o run"));
    bench.done(&format!("solve --repeat run {MAST} move.csv"));
    bench.done(&format!("solve {MAST} move.csv --golden -o gold"));
    bench.done("compare gold gold");
    bench.done(&format!("solve {MAST} move.csv --set payload.mass=41 -o heavier"));
    let told = stdout(&ended(1, bench.run("compare run heavier")));
    assert!(
        told.contains("differs  force.csv") && told.contains("differs  carriage.csv"),
        "{told}"
    );
    assert!(
        bench.read("gold/carriage.csv").starts_with("time_s,carriage_m,carriage_velocity_m_s,")
    );
    for page in ["report run -o run.html", "report gold -o gold.html"] {
        let is_whole = page.contains("run");
        ended(if is_whole { 0 } else { 3 }, bench.run(page));
    }
}

#[test]
fn force_and_motion_of_the_carriage_bring_the_tip_where_it_was_to_be() {
    let bench = bench();
    viscous(&bench);
    bench.done("solve mast.toml move.csv -o run --digits full");
    let plays = [
        ("run/force.csv --input force", "carriage.csv", 3e-6),
        ("run/carriage.csv --input carriage", "force.csv", 3e-6),
        ("run/force.csv --feedback 5e4,2e3 --reference run/carriage.csv", "carriage.csv", 3e-6),
    ];
    for (play, measured, within) in plays {
        let words = format!(
            "simulate mast.toml {play} --target run/tip.csv --measured run/{measured} -o sim"
        );
        let text = stdout(&succeeded(bench.run(&words)));
        for word in ["torque", "hub", "rad/s"] {
            assert!(!text.contains(word), "{word}: {text}");
        }
        let share = bench.number("sim", "tip_error/share");
        assert!(share < within, "{play}: {share:e}");
        let share = bench.number("sim", "measured/channels/0/share");
        assert!(share < 1e-4, "{play}: {share:e}");
        assert!(bench.read("sim/force.csv").starts_with("time_s,force_n\n"));
        let head = "time_s,carriage_m,carriage_velocity_m_s,carriage_acceleration_m_s2\n";
        assert!(bench.read("sim/carriage.csv").starts_with(head));
    }
    assert!((bench.number("sim", "feedback/stiffness_n_m") - 5e4).abs() < 1e-9);
    assert!((bench.number("sim", "feedback/damping_n_s_m") - 2e3).abs() < 1e-9);
    bench.done("report sim -o sim.html");
}

#[test]
fn a_table_of_the_force_moves_the_tip_as_wanted() {
    let bench = bench();
    viscous(&bench);
    bench.done("solve mast.toml move.csv --write lift.csv");
    assert!(bench.read("lift.csv").starts_with("time_s,force_n\n"));
    bench.done("sweep mast.toml move.csv --torque lift.csv --vary payload.mass=40,80 -o s.csv");
    let off = bench.numbers("s.csv", "tip_error_share");
    assert!(off[0] < 1e-5 && off[1] > 1e-3, "{off:?}");
    assert!(!bench.read("s.csv").contains("hub"));
    let text = stdout(&succeeded(bench.run("solve mast.toml move.csv --write lift.h --hold zero")));
    assert!(text.contains("values for a converter"), "{text}");
    let header = bench.read("lift.h");
    for words in ["Force on the carriage in N", "static const double lift_n[LIFT_LENGTH]"] {
        assert!(header.contains(words), "{words}");
    }
    bench.done("solve mast.toml move.csv --write lift.m");
    let script = bench.read("lift.m");
    assert!(script.contains("timeseries(lift_n, lift_time_s") && script.contains("Units = 'N';"));
}

#[test]
fn limits_of_travel_and_acceleration_are_those_of_the_rail() {
    let bench = bench();
    let limits = "--set limits={carriage_travel=1.9,carriage_acceleration=3,bending_moment=6000}";
    bench.done(&format!("solve {MAST} move.csv {limits} -o out"));
    let warned = bench.read("out/summary.json");
    for words in [
        "limits.carriage_travel = 1.9 m is exceeded: 2.0000 m",
        "limits.carriage_acceleration = 3 m/s² is exceeded: 3.6192 m/s²",
        "limits.bending_moment = 6000 N m is exceeded: 6324.4 N m",
    ] {
        assert!(warned.contains(words), "{words}: {warned}");
    }
    let of = |name: &str| column(&bench, "out/carriage.csv", name);
    let largest = |all: &[f64]| all.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
    let sampled = largest(&of("carriage_acceleration_m_s2"));
    let peak = bench.number("out", "results/peak_carriage_acceleration_m_s2");
    assert!((1.0..1.0001).contains(&(peak / sampled)), "{peak} {sampled}");
    assert!((bench.number("out", "limits/carriage_travel_m") - 1.9).abs() < 1e-12);
}

#[test]
fn the_shortest_move_within_the_limits_of_a_carriage_is_found() {
    let bench = bench();
    let fit = "--fit-limit force=9000 --fit-limit carriage_speed=2.5";
    let words =
        format!("trajectory septic --distance 2 --step 0.02 --link {MAST} {fit} -o fast.csv");
    let told = stderr(&succeeded(bench.run(&words)));
    assert!(told.contains("within force=9000 N, carriage_speed=2.5 m/s; limits."), "{told}");
    let limits = "--set limits={force=9000,carriage_speed=2.5} --strict";
    bench.done(&format!("solve {MAST} fast.csv {limits} -o out"));
    let text = bench.read("fast.csv");
    let (last_s, _) = text.lines().last().unwrap().split_once(',').unwrap();
    let shorter_s = last_s.parse::<f64>().unwrap() - 0.02;
    let shorter = format!("trajectory septic --distance 2 --step 0.02 --duration {shorter_s:.2}");
    bench.done(&format!("{shorter} -o shorter.csv"));
    ended(4, bench.run(&format!("solve {MAST} shorter.csv {limits} -o out")));
    let cycle =
        format!("trajectory septic --distance 2 --duration 2 --step 0.01 --cycle --link {MAST}");
    let told = stderr(&succeeded(bench.run(&format!("{cycle} -o cycle.csv"))));
    assert!(told.contains(" s takes a force of ") && told.contains(" N rms"), "{told}");
}

#[test]
fn a_template_of_a_mast_is_solved() {
    let bench = Bench::new();
    bench.done("init --carriage mast");
    let output = bench.run("solve mast/link.toml mast/motion.csv -o out --deny-warnings");
    assert!(stdout(&succeeded(output)).contains("force    peak 2293 N"));
}

#[test]
fn a_station_names_the_output_and_tells_where_the_tip_goes() {
    let bench = bench();
    let solved = succeeded(bench.run(&format!("solve {MAST} move.csv --set output.at=4 -o out")));
    let (text, warned) = (stdout(&solved), stderr(&solved));
    for words in ["output deflects by up to ", "free end strays by up to ", "model (output)"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert!(!text.contains("tip") && !warned.contains("tip"), "{text} {warned}");
    let output_m = column(&bench, "out/output.csv", "output_displacement_m");
    let (first, last) = (output_m[0], output_m[output_m.len() - 1]);
    assert!(first.abs() < 1e-5 && (last - 2.0).abs() < 1e-5, "{first} {last}");
    assert!(!bench.read("out/summary.json").contains("tip.csv"));
    // The tip is the last node; a rigid mast carries it as far as the output.
    let nodes = bench.read("out/nodal_displacements.csv");
    let tip = nodes.lines().next().unwrap().rsplit(',').next().unwrap().to_owned();
    let tip_m = column(&bench, "out/nodal_displacements.csv", &tip);
    let apart_m = tip_m.iter().zip(&output_m).map(|(tip, output)| (tip - output).abs());
    let told_m = bench.number("out", "results/peak_free_end_from_rigid_m");
    let apart_m = apart_m.fold(0.0, f64::max);
    assert!((apart_m / told_m - 1.0).abs() < 1e-3, "{apart_m} {told_m}");
    let text = stdout(&succeeded(bench.run(&format!("modes {MAST} --set output.at=4"))));
    assert!(text.contains(" Hz no force moves the output"), "{text}");
    let text = stdout(&succeeded(bench.run(&format!("verify {MAST} move.csv --set output.at=4"))));
    assert!(text.contains("F/a_output") && !text.contains("tip"), "{text}");
    // An output at the tip is the default, and a place off the link is refused.
    bench.done(&format!("solve {MAST} move.csv --set output.at=6 -o tip"));
    bench.done(&format!("solve {MAST} move.csv -o default"));
    assert_eq!(bench.read("tip/force.csv"), bench.read("default/force.csv"));
    let refused = stderr(&ended(3, bench.run(&format!("solve {MAST} move.csv --set output.at=0"))));
    assert!(refused.contains("output.at = 0 m, but must lie beyond the root"), "{refused}");
}

#[test]
fn a_spring_at_the_root_stands_in_all_results_of_hub_and_carriage() {
    let bench = bench();
    bench.done(&format!("solve {MAST} move.csv --set carriage.root_stiffness=2e7 -o out"));
    let told = bench.number("out", "link/root_stiffness_n_m_rad");
    assert!((told - 2e7).abs() < 1e-3, "{told}");
    let clamped = stdout(&succeeded(bench.run(&format!("modes {MAST} --count 1"))));
    let spring = "--set carriage.root_stiffness=inf --count 1";
    assert_eq!(stdout(&succeeded(bench.run(&format!("modes {MAST} {spring}")))), clamped);
    let text = stderr(&ended(
        3,
        bench.run(&format!("solve {MAST} move.csv --set carriage.root_stiffness=0")),
    ));
    assert!(text.contains("carriage.root_stiffness = 0 N m/rad, but must be"), "{text}");
}

/// The sheet upright on a spring, and as a pendulum of a hub with a radius.
#[test]
fn weight_on_a_spring_at_the_root_is_verified_by_the_equations_of_the_elastica() {
    let bench = bench();
    bench.done("trajectory septic --distance 0.1 --duration 1.5 --step 0.005 -o slow.csv");
    let sheet = std::fs::read_to_string(repository(SHEET)).unwrap();
    let on_hub = "[hub]\ninertia = '0.05 kg m^2'\nradius = '30 mm'\nroot_stiffness = 4.0";
    bench.write("hub.toml", &sheet.replace("[carriage]\nmass = \"5 kg\"", on_hub));
    let spring = "--set carriage.root_stiffness=10";
    let runs = [
        format!("{SHEET} slow.csv {spring}"),
        format!("{SHEET} slow.csv {spring} --set damping={{model='hysteretic',ratio=0.01}}"),
        "hub.toml slow.csv --set start_angle=-0.5".to_owned(),
    ];
    for words in runs {
        let text = stdout(&succeeded(bench.run(&format!("verify {words}"))));
        assert!(text.contains("moved"), "{text}");
    }
}

/// A slim mast that stands, and a hub under gravity, with the output inboard of the tip.
#[test]
fn weight_on_a_station_is_verified_by_the_equations_of_the_elastica() {
    let bench = bench();
    bench.done("trajectory septic --distance 0.4 --duration 1.2 --step 0.005 -o slow.csv");
    bench.done("trajectory septic --distance 0.05 --duration 2 --step 0.02 -o slower.csv");
    let link = |joint: &str, direction: &str, stiffness: f64| {
        format!(
            "gravity = [0.0, -9.81]\nstart_angle = '{direction}'\n{joint}\n[output]\nat = 0.9\n\
             [[segments]]\nlength = 1.2\nEI = {stiffness}\nmass_per_length = 0.25\n\
             [damping]\nmodel = 'rayleigh'\nbeta = 2e-3\n"
        )
    };
    bench.write("mast.toml", &link("[carriage]\nmass = 1.5", "90 deg", 3.0));
    bench.write("hub.toml", &link("[hub]\ninertia = 0.02", "30 deg", 60.0));
    // On a finer mesh, and at 0.8 of the buckling weight.
    for words in [
        "mast.toml slow.csv",
        "mast.toml slow.csv --set mesh.elements=80",
        "mast.toml slower.csv --set segments.0.EI=0.68",
        "hub.toml slow.csv",
    ] {
        succeeded(bench.run(&format!("solve {words} --verify -o checks")));
        let summary = bench.json("checks/summary.json");
        let found = |k: usize| summary["verification"][k]["found"].as_f64().unwrap();
        let (output, effort) = (found(0), found(1));
        assert!(output < 1e-5 && effort < 5e-5, "{words}: {output:e} {effort:e}");
    }
    // With the weight: the frequency of the mast without it is 5.79 Hz.
    let told = stderr(&succeeded(bench.run("solve mast.toml slow.csv -o out")));
    assert!(told.contains("at 5.57631 Hz no force moves the output"), "{told}");
    let lying = "--set start_angle=0.3 --set damping={model='hysteretic',ratio=0.01}";
    let refused = stderr(&ended(4, bench.run(&format!("solve mast.toml slow.csv {lying}"))));
    assert!(
        refused.contains("Hz, within the motion's band, no force moves the output"),
        "{refused}"
    );
}

#[test]
fn a_motor_moves_the_carriage_by_its_pinion() {
    let bench = bench();
    let drive = "drive={gear_ratio=10,pinion_radius='50mm',rotor_inertia=0.01}";
    bench.done(&format!("solve {MAST} move.csv --set {drive} -o out --digits full"));
    let of = |file: &str, name: &str| column(&bench, &format!("out/{file}.csv"), name);
    let (force, torque) = (of("force", "force_n"), of("motor", "motor_torque_n_m"));
    let acceleration = of("carriage", "carriage_acceleration_m_s2");
    let (velocity, rate) =
        (of("carriage", "carriage_velocity_m_s"), of("motor", "motor_rate_rad_s"));
    for k in (0..force.len()).step_by(50) {
        // A stiff belt: 10/0.05 = 200 rad of the motor for 1 m.
        let exact = force[k] / 200.0 + 0.01 * 200.0 * acceleration[k];
        assert!((torque[k] - exact).abs() < 1e-9 * 31.0, "{} {exact}", torque[k]);
        assert!((rate[k] - 200.0 * velocity[k]).abs() < 1e-9 * 430.0);
    }
    let told = stderr(&ended(
        4,
        bench.run(&format!(
            "solve {MAST} move.csv --set {drive} --set limits.motor_torque=20 --strict -o out"
        )),
    ));
    assert!(told.contains("limits.motor_torque = 20 N m is exceeded: 31.4"), "{told}");
    bench.done("report out -o out.html");
}

#[test]
fn a_fit_finds_mass_and_friction_of_the_carriage() {
    let bench = bench();
    viscous(&bench);
    bench.done("solve mast.toml move.csv -o run");
    let truth = "--set carriage.mass=900 --set carriage.viscous_friction=120";
    bench.done(&format!("simulate mast.toml run/force.csv {truth} -o rig --digits full"));
    let [force, place] = [("force", "force_n"), ("carriage", "carriage_m")]
        .map(|(file, name)| bench.cells(&format!("rig/{file}.csv"), name));
    let times = bench.cells("rig/force.csv", "time_s");
    let rows = times.iter().zip(&force).zip(&place).map(|((t, f), x)| format!("{t},{f},{x}\n"));
    bench.write("rig.csv", &("time,force,carriage\n".to_owned() + &rows.collect::<String>()));
    let record = |input: &str, sensor: &str| {
        let text = format!(
            "file = 'rig.csv'\ninput = '{input}'\n[[record.channel]]\nsensor = '{sensor}'\n"
        );
        bench.write("measured.toml", &format!("[[record]]\n{text}"));
    };
    record("force", "carriage");
    let start = bench.read("mast.toml").replace("800 kg\"", "800 kg\"\nviscous_friction = 50.0");
    bench.write("start.toml", &start);
    let free = "--free carriage.mass --free carriage.viscous_friction";
    let fit = format!("fit start.toml measured.toml {free} -o fitted.toml --report");
    let text = stdout(&succeeded(bench.run(&fit)));
    assert!(text.contains("carriage.mass = \"900.0 kg\", was \"800 kg\""), "{text}");
    assert!(text.contains("carriage.viscous_friction = 120.0, was 50.0"), "{text}");
    record("torque", "hub_angle");
    let told = stderr(&ended(3, bench.run(&fit)));
    assert!(told.contains("record: torque, but a link on a carriage has force"), "{told}");
    bench.write("measured.toml", "[[frequency]]\nmode = 1\ncarriage = 'held'\nvalue = 3.8246515\n");
    let text = stdout(&succeeded(bench.run("fit mast.toml measured.toml --free segments.*.E")));
    assert!(text.contains("frequency 1, carriage held"), "{text}");
}

#[test]
fn a_fit_takes_responses_per_force_and_voltages_of_a_carriage() {
    let bench = bench();
    viscous(&bench);
    let truth = "--set carriage.mass=900 --set segments.*.E*=1.1";
    bench.done(&format!("frf mast.toml {truth} --from 1 --to 25 --points 80 -o frf.csv"));
    let of = |name: &str| bench.numbers("frf.csv", name);
    let hertz = of("frequency_hz");
    let parts = |name: &str| [of(&format!("{name}_magnitude")), of(&format!("{name}_phase_rad"))];
    let [force, place, tip] = [
        "force_per_tip_acceleration_kg",
        "carriage_per_tip_displacement",
        "tip_displacement_per_force_m_n",
    ]
    .map(parts);
    let table = |name: &str, of: &dyn Fn(usize) -> [f64; 2]| {
        let rows = hertz.iter().enumerate().map(|(k, hertz)| {
            let [gain, phase] = of(k);
            format!("{hertz},{gain},{phase}\n")
        });
        let heading = "frequency,gain,phase [rad]\n".to_owned();
        bench.write(name, &(heading + &rows.collect::<String>()));
    };
    table("tip.csv", &|k| [force[0][k].recip(), -force[1][k]]);
    table("place.csv", &|k| [place[0][k] * tip[0][k], place[1][k] + tip[1][k]]);
    let response = |file: &str, transfer: &str, more: &str| {
        format!(
            "[[response]]\nfile = '{file}.csv'\ntransfer = '{transfer}'\nuncertainty = 0.01\n{more}\n"
        )
    };
    let both =
        response("tip", "tip_acceleration", "per = 'force'") + &response("place", "carriage", "");
    bench.write("measured.toml", &both);
    let free = "--free carriage.mass --free segments.*.E";
    let fit = |more: &str| {
        bench.run(&format!("fit mast.toml measured.toml {free} -o fitted.toml {more}"))
    };
    let text = stdout(&succeeded(fit("--report")));
    assert!(text.contains("carriage.mass = \"900.0 kg\""), "{text}");
    for (k, exact) in [(0, 900.0 / 800.0), (1, 1.1)] {
        let factor = number(&bench.json("fitted.json"), &format!("values/{k}/factor"));
        assert!((factor / exact - 1.0).abs() < 1e-5, "{factor} is not {exact}");
    }
    let page = bench.read("fitted.html");
    assert!(page.contains("carriage per force, gain"), "a page in words of a carriage");
    // The dip of a closed loop is the frequency of the held link.
    bench.write("measured.toml", &response("place", "carriage", "loop = 'closed'"));
    succeeded(bench.run("fit mast.toml measured.toml --free segments.*.E -o held.toml"));
    let factor = number(&bench.json("held.json"), "values/0/factor");
    assert!((factor / 1.1 - 1.0).abs() < 5e-3, "{factor}");
    for (more, told) in [
        (response("tip", "hub_rate", ""), "response: hub_rate, but a link on a carriage has force"),
        (
            response("tip", "tip_acceleration", "per = 'torque'"),
            "response: torque, but a link on a carriage",
        ),
        (
            both + "[motor]\ntorque_constant = 0.05\nresistance = 2.0\n",
            "motor.pinion_radius is missing: the carriage moves by it",
        ),
    ] {
        bench.write("measured.toml", &more);
        let text = stderr(&ended(3, fit("")));
        assert!(text.contains(told), "{told}: {text}");
    }
    // A motor of 5 N/V, whose back voltage is a friction of 50 N s/m: (10/0.05 · 0.05)²/2.
    bench.done("solve mast.toml move.csv -o run");
    let truth = "--set carriage.mass=900 --set carriage.viscous_friction=120";
    bench.done(&format!("simulate mast.toml run/force.csv {truth} -o rig --digits full"));
    let [force, place] = [("force", "force_n"), ("carriage", "carriage_m")]
        .map(|(file, name)| bench.numbers(&format!("rig/{file}.csv"), name));
    let times = bench.numbers("rig/force.csv", "time_s");
    let rows = times.iter().zip(&force).zip(&place);
    let rows = rows.map(|((t, f), x)| format!("{t},{},{x}\n", f / 5.0));
    bench.write("volts.csv", &("time,voltage,carriage\n".to_owned() + &rows.collect::<String>()));
    let motor =
        "torque_constant = 0.05\nresistance = 2.0\ngear_ratio = 10\npinion_radius = '50 mm'\n";
    let record = "[[record]]\nfile = 'volts.csv'\ninput = 'voltage'\nhold = 'cubic'\n\
                  [[record.channel]]\nsensor = 'carriage'\n";
    bench.write("measured.toml", &format!("{record}[motor]\n{motor}"));
    let start = bench.read("mast.toml").replace("800 kg\"", "800 kg\"\nviscous_friction = 50.0");
    bench.write("start.toml", &start);
    let free = "--free carriage.mass --free carriage.viscous_friction";
    let text = stdout(&succeeded(bench.run(&format!("fit start.toml measured.toml {free}"))));
    assert!(text.contains("carriage.mass = \"900.0 kg\", was \"800 kg\""), "{text}");
    assert!(text.contains("carriage.viscous_friction = 70.0, was 50.0"), "{text}");
}

/// Texts of a page without its scripts, styles and tags.
fn texts(page: &str) -> String {
    let mut texts = String::new();
    let mut rest = page;
    while let Some(at) = rest.find('<') {
        texts += &rest[..at];
        texts.push('\n');
        let end = ["script", "style"].into_iter().find(|own| rest[at + 1..].starts_with(own));
        let end = end.map_or(">".to_owned(), |name| format!("</{name}>"));
        let after = rest[at..].find(&end).map_or(rest.len(), |k| at + k + end.len());
        rest = &rest[after..];
    }
    texts + rest
}

#[test]
fn a_page_speaks_of_force_and_carriage() {
    let bench = bench();
    let limits = "--set limits={force=4500,carriage_speed=2,power=5000,bending_moment=7000}";
    bench.done(&format!("solve {MAST} move.csv {limits} --moments --report -o out --quiet"));
    bench.done(&format!("sweep {MAST} move.csv --vary payload.mass=40,80 -o sweep.csv"));
    bench.done("report sweep.csv -o sweep.html");
    let [run, sweep] = ["out/report.html", "sweep.html"].map(|name| texts(&bench.read(name)));
    for text in [&run, &sweep] {
        for word in ["hub", "torque", "Torque", "rad/s"] {
            assert!(!text.contains(word), "{word} in {text}");
        }
    }
    for words in ["Peak force\n", "Force ratio\n", "Peak force at the carriage", "max |F(t)|"] {
        assert!(sweep.contains(words), "{words}: {sweep}");
    }
    for words in [
        "Force on the carriage",
        "force in N\n",
        "At most 4849 N.",
        "limit 4500 N\n",
        "Speed of the carriage",
        "limit 2 m/s",
        "limit 7000 N m",
        "At most 6324 N m.",
        "|F / a| in kg\n",
        "Modes, the carriage free",
        "carriage mass\n",
    ] {
        assert!(run.contains(words), "{words}: {run}");
    }
}

#[test]
fn a_page_names_the_output_and_draws_limits_of_travel_and_acceleration() {
    let bench = bench();
    let limits = "--set limits={carriage_travel=1.9,carriage_acceleration=3}";
    bench
        .done(&format!("solve {MAST} move.csv {limits} --set output.at=4 --report -o out --quiet"));
    let page = texts(&bench.read("out/report.html"));
    for words in [
        "Displacement of the output",
        "Output under the rigid link's force",
        "Force per output acceleration",
        "limit 1.9 m\n",
        "limit 3 m/s²\n",
        "At most 3.677 m/s².",
        "peak free end from rigid",
    ] {
        assert!(page.contains(words), "{words}: {page}");
    }
    for word in ["the tip", "Tip", "tip displacement"] {
        assert!(!page.contains(word), "{word} in {page}");
    }
}

/// Frequencies computed with dense matrices in another language; the buckling weight of a uniform column, 7.8373 EI/L².
#[test]
fn an_upright_link_has_softer_modes_and_buckles_at_its_weight() {
    let bench = bench();
    let held_hz = |settings: &str| -> f64 {
        bench.done(&format!("modes {SHEET} --count 1 {settings} -o modes"));
        let text = bench.read("modes/held_modes.csv");
        let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        let at = rows[0].iter().position(|name| *name == "frequency_hz").unwrap();
        rows[1][at].parse().unwrap()
    };
    for (settings, exact_hz) in [
        ("--set gravity=[0,0]", 2.9354),
        ("", 2.8045),
        ("--set start_angle=-1.5707963267948966", 3.0605),
    ] {
        let hz = held_hz(settings);
        assert!((hz - exact_hz).abs() < 6e-5, "{hz} is not {exact_hz}");
    }
    bench.done("trajectory septic --distance 0.05 --duration 1.5 --step 0.005 -o slow.csv");
    // Moved by other equations than the solver's.
    for order in ["full", "first"] {
        let order = format!("--set analysis.second_order={order}");
        let text = stdout(&succeeded(bench.run(&format!("verify {SHEET} slow.csv {order}"))));
        assert!(text.contains("tip, the carriage moved as solved"), "{text}");
        assert!(text.contains("force that the moved carriage takes"), "{text}");
    }
    // m̄gL³/EI = 12 ρgL³/(E h²) is 7.8373 times the share.
    let solve = |share: f64| {
        let modulus = 12.0 * 7870.0 * 9.81 * 0.52_f64.powi(3) / (1e-6 * 7.8373 * share);
        bench.run(&format!("solve {SHEET} slow.csv --set segments.0.E={modulus} -o out"))
    };
    let text = stderr(&succeeded(solve(0.65)));
    assert!(!text.contains("buckle"), "{text}");
    // On pieces as on a whole link.
    let modulus = 12.0 * 7870.0 * 9.81 * 0.52_f64.powi(3) / (1e-6 * 7.8373 * 0.985);
    let section = "section={shape='rectangle',width='80 mm',thickness='1 mm'}";
    let piece = format!("{{length='1.3 mm',{section},E={modulus},density=7870}}");
    let pieces = vec![piece; 400].join(",");
    bench.write(
        "pieces.toml",
        &format!("gravity=[0,-9.81]\nstart_angle='90 deg'\nsegments=[{pieces}]\ncarriage.mass=5\n"),
    );
    let text = stderr(&ended(4, bench.run("solve pieces.toml slow.csv -o out")));
    assert!(text.contains("the weight is 0.985 of the one that buckles the link"), "{text}");
    let text = stderr(&succeeded(solve(0.75)));
    assert!(text.contains("the weight is 0.75 of the one that buckles the link"), "{text}");
    let text = stderr(&ended(4, solve(0.985)));
    assert!(
        text.contains(
            "the weight is 0.985 of the one that buckles the link, but must be below 0.98"
        ),
        "{text}"
    );
}

#[test]
fn a_state_of_another_direction_or_of_a_hub_is_refused() {
    let bench = bench();
    bench.sampled("force.csv", "time,force", 0..=4, |k| [0.01 * k, k * (4.0 - k)]);
    let sheet = "simulate specs/carriages/sheet.toml force.csv -o out";
    bench.done(&format!("{sheet} --save-state state.json"));
    bench.done(&format!("{sheet} --state state.json"));
    let hanging = format!("{sheet} --state state.json --set start_angle=0");
    let told = stderr(&ended(3, bench.run(&hanging)));
    assert!(told.contains("the state has the direction 90 deg, but must have 0 deg"), "{told}");
    let ends = |turned: &str| {
        bench.done(&format!("{sheet} --state state.json {turned}"));
        bench.number("out", "results/peak_carriage_travel_m")
    };
    let (own, turned) = (ends(""), ends("--set start_angle=7.853981633974483"));
    assert!((turned / own - 1.0).abs() < 1e-9, "{turned} a turn on, {own}");
    let text = bench.read("state.json");
    let at = text.find("\"carriage\"").unwrap();
    let (before, after) = (&text[..at], &text[at..]);
    let before = before.trim_end().trim_end_matches(',');
    let of_hub = format!("{before}{}", &after[after.find(']').unwrap() + 1..]);
    bench.write("hub.json", &of_hub);
    let told = stderr(&ended(3, bench.run(&format!("{sheet} --state hub.json"))));
    let must = "the state is of a link that rotates, but must be of a link that slides";
    assert!(told.contains(must), "{told}");
}

/// Radius in m of a hub that moves its link as a carriage does, up to the length over the radius.
const LONG_M: f64 = 1e4;

/// Largest difference that this radius makes, as a share.
const OF_LONG: f64 = 3e-4;

/// A link with a spring at its root, a body and a payload, on this joint, the body `beyond_m` from the axis.
fn laden(joint: &str, beyond_m: f64) -> String {
    format!(
        "[[segments]]\nlength = 1.2\nEI = 6.0\nmass_per_length = 0.7\n{joint}\nroot_stiffness = 50.0\n\
         [[masses]]\nat = {}\nmass = 0.2\n[payload]\nmass = 0.3\n\
         [damping]\nmodel = 'rayleigh'\nalpha = 0.0\nbeta = 2e-3\n",
        beyond_m + 0.5
    )
}

/// The link on a carriage of a mass in kg and a friction in N s/m, and on a hub that moves it alike.
fn alike(bench: &Bench, mass_kg: f64, friction: f64) {
    let on_carriage = format!("[carriage]\nmass = {mass_kg:?}\nviscous_friction = {friction:?}");
    bench.write("carriage.toml", &laden(&on_carriage, 0.0));
    let square = LONG_M * LONG_M;
    let [inertia, friction] = [mass_kg, friction].map(|own| own * square);
    let on_hub = format!(
        "[hub]\ninertia = {inertia:?}\nviscous_friction = {friction:?}\nradius = {LONG_M:?}"
    );
    bench.write("hub.toml", &laden(&on_hub, LONG_M));
}

/// Compares two columns of numbers, the second times a factor, over the largest number.
fn are_alike(own: &[f64], long: &[f64], factor: f64) {
    assert_eq!(own.len(), long.len());
    let largest = own.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
    let off = own
        .iter()
        .zip(long)
        .fold(0.0_f64, |most, (own, long)| most.max((own - factor * long).abs()));
    assert!(largest > 0.0 && off < OF_LONG * largest, "{off:e} of {largest:e}");
}

#[test]
fn sweeps_and_shortest_moves_are_those_of_a_hub_with_a_very_long_radius() {
    let bench = Bench::new();
    alike(&bench, 1.0, 0.3);
    bench.done("trajectory septic --distance 0.3 --duration 0.8 --step 0.004 -o move.csv");
    let square = LONG_M * LONG_M;
    let drives = [
        (
            "carriage",
            "{joint_stiffness=3000.0,rotor_inertia=1e-3,gear_ratio=10,pinion_radius=0.5}"
                .to_owned(),
        ),
        (
            "hub",
            format!(
                "{{joint_stiffness={},rotor_inertia=1e-3,gear_ratio={}}}",
                3000.0 * square,
                20.0 * LONG_M
            ),
        ),
    ];
    for (joint, drive) in &drives {
        let words =
            format!("{joint}.toml move.csv --set drive={drive} --vary payload.mass=0.2,0.3");
        bench.done(&format!("sweep {words} -o {joint}.csv"));
        let fit = format!("--link {joint}_driven.toml --fit-limit motor_torque=0.5");
        let driven = format!(
            "{}[drive]\n{}",
            bench.read(&format!("{joint}.toml")),
            drive.trim_matches(['{', '}']).replace(',', "\n")
        );
        bench.write(&format!("{joint}_driven.toml"), &driven);
        bench.done(&format!(
            "trajectory septic --distance 0.3 --step 0.01 {fit} -o {joint}_fast.csv"
        ));
    }
    assert_eq!(bench.read("carriage_fast.csv"), bench.read("hub_fast.csv"));
    for (own, long, factor) in [
        ("peak_force_n", "peak_torque_n_m", 1.0 / LONG_M),
        ("rms_force_n", "rms_torque_n_m", 1.0 / LONG_M),
        ("peak_rigid_force_n", "peak_rigid_torque_n_m", 1.0 / LONG_M),
        ("peak_carriage_speed_m_s", "peak_hub_rate_rad_s", LONG_M),
        ("peak_power_w", "peak_power_w", 1.0),
        ("peak_root_moment_n_m", "peak_root_moment_n_m", 1.0),
        ("peak_deflection_m", "peak_deflection_m", 1.0),
        ("peak_motor_torque_n_m", "peak_motor_torque_n_m", 1.0),
        ("lead_s", "lead_s", 1.0),
        ("zero_1_per_s", "zero_1_per_s", 1.0),
    ] {
        are_alike(&bench.numbers("carriage.csv", own), &bench.numbers("hub.csv", long), factor);
    }
}

#[test]
fn recorded_motions_are_solved_as_for_a_hub_with_a_very_long_radius() {
    let bench = Bench::new();
    alike(&bench, 1.0, 0.3);
    let row = |k: i32| {
        let u = (f64::from(k) / 200.0).clamp(0.0, 1.0);
        let tip_m = 0.3 * septic(u);
        let noise_m = 2e-5 * (12.9898 * f64::from(k * k) + 1.1).sin();
        format!("{:.3},{:.6}\n", 0.004 * f64::from(k + 40), tip_m + noise_m)
    };
    let rows: String = (-40..=240).map(row).collect();
    bench.write("recorded.csv", &format!("time,displacement\n{rows}"));
    for joint in ["carriage", "hub"] {
        bench.done(&format!(
            "solve {joint}.toml recorded.csv --noise 0.02mm -o {joint} --digits full --quiet"
        ));
    }
    let of = |file: &str, name: &str| column(&bench, file, name);
    are_alike(
        &of("carriage/force.csv", "force_n"),
        &of("hub/torque.csv", "torque_n_m"),
        1.0 / LONG_M,
    );
    let [own, long] =
        [of("carriage/carriage.csv", "carriage_m"), of("hub/hub_angle.csv", "hub_angle_rad")];
    are_alike(&own, &long, LONG_M);
    let own = bench.number("carriage", "errors/force/input");
    let long = bench.number("hub", "errors/torque/input");
    assert!(own > 0.01 && (long / own - 1.0).abs() < 0.01, "{own} {long}");
}

#[test]
fn a_fit_finds_what_it_finds_for_a_hub_with_a_very_long_radius() {
    let bench = Bench::new();
    bench.done("trajectory septic --distance 0.3 --duration 0.8 --step 0.004 -o move.csv");
    alike(&bench, 1.2, 0.5);
    bench.done("solve carriage.toml move.csv -o run --quiet");
    bench.done("simulate carriage.toml run/force.csv -o rig --digits full --quiet");
    alike(&bench, 1.0, 0.3);
    let of = |file: &str, name: &str| column(&bench, &format!("rig/{file}.csv"), name);
    let (time_s, force_n, at_m) =
        (of("force", "time_s"), of("force", "force_n"), of("carriage", "carriage_m"));
    for (joint, input, sensor, [by_effort, by_place]) in [
        ("carriage", "force", "carriage", [1.0, 1.0]),
        ("hub", "torque", "hub_angle", [LONG_M, 1.0 / LONG_M]),
    ] {
        let rows = time_s.iter().zip(&force_n).zip(&at_m);
        let rows = rows.map(|((t, f), x)| format!("{t},{:?},{:?}\n", by_effort * f, by_place * x));
        let rows: String = rows.collect();
        bench.write(&format!("{joint}_rig.csv"), &format!("time,{input},{sensor}\n{rows}"));
        let record = format!(
            "[[record]]\nfile = '{joint}_rig.csv'\ninput = '{input}'\n[[record.channel]]\nsensor = '{sensor}'\n"
        );
        bench.write(&format!("{joint}_measured.toml"), &record);
    }
    let fit = |joint: &str, inertia: &str| {
        let free = format!("--free {joint}.{inertia} --free {joint}.viscous_friction");
        let files = format!("{joint}.toml {joint}_measured.toml");
        bench.done(&format!("fit {files} {free} -o {joint}_fitted.toml"));
        let fitted = bench.read(&format!("{joint}_fitted.toml"));
        let fitted: toml::Table = toml::from_str(&fitted).unwrap();
        [inertia, "viscous_friction"].map(|key| fitted[joint][key].as_float().unwrap())
    };
    let (own, long) = (fit("carriage", "mass"), fit("hub", "inertia"));
    for ((own, long), truth) in own.iter().zip(long).zip([1.2, 0.5]) {
        assert!((own / truth - 1.0).abs() < 1e-6, "{own} {truth}");
        assert!((long / (LONG_M * LONG_M) / own - 1.0).abs() < OF_LONG, "{own} {long}");
    }
}

const GANTRY: &str = "specs/carriages/gantry_arm.toml trajectories/arms/gantry_1.5s.csv";

#[test]
fn an_arm_on_a_carriage_has_its_force_in_every_folder() {
    let bench = Bench::new();
    let text = stdout(&succeeded(bench.run(&format!("solve {GANTRY} --moments --report -o out"))));
    for words in ["on a carriage of 12.00 kg along 1, 0", "\ncarriage peak ", "moves from "] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let force = column(&bench, "out/force.csv", "force_n");
    let largest = force.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
    let peak_n = bench.number("out", "results/carriage/peak_force_n");
    assert!((1.0..1.001).contains(&(peak_n / largest)), "{largest} {peak_n}");
    // A level rail carries no weight, and friction is over.
    assert!(force[0].abs() < 1e-5 * peak_n && force[force.len() - 1].abs() < 1e-5 * peak_n);
    let place = column(&bench, "out/carriage.csv", "carriage_m");
    assert!((place[place.len() - 1] - 0.8).abs() < 1e-6);
    let tip = column(&bench, "out/tip.csv", "x_m");
    assert!((tip[0] - 0.5).abs() < 1e-6 && (tip[tip.len() - 1] - 1.9).abs() < 1e-6);
    assert!((bench.number("out", "errors/carriage/force/mesh")).abs() < 1e-6);
    assert!((bench.number("out", "limits/2/force_n") - 300.0).abs() < 1e-9);
    let page = bench.read("out/report.html");
    assert!(page.contains("Force on the carriage") && page.contains("\"base_m\":["), "the page");
    let text = stdout(&succeeded(bench.run(&format!("solve --repeat out {GANTRY}"))));
    assert!(text.contains("byte for byte"), "{text}");
    succeeded(bench.run("compare out out"));
    succeeded(bench.run(&format!("solve {GANTRY} --golden -o golden")));
    assert!(
        bench.path("golden/force.csv").is_file() && !bench.path("golden/rigid_force.csv").is_file()
    );
    succeeded(bench.run(&format!("solve {GANTRY} --write all.csv")));
    let written = column(&bench, "all.csv", "force_n");
    assert_eq!(written.len(), column(&bench, "all.csv", "torque2_n_m").len());
    let text = stdout(&succeeded(bench.run(&format!("verify {GANTRY}"))));
    assert!(text.contains("force taken by moved carriage") && !text.contains("joint 3"), "{text}");
}

#[test]
fn a_sweep_of_an_arm_on_a_carriage_has_the_numbers_of_the_carriage() {
    let bench = Bench::new();
    bench.done(&format!("sweep {GANTRY} --vary carriage.mass=6,24 -o sweep.csv"));
    let text = bench.read("sweep.csv");
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let of = |name: &str| -> [f64; 2] {
        let at = rows[0].iter().position(|own| *own == name).unwrap();
        [1, 2].map(|row: usize| rows[row][at].parse().unwrap())
    };
    bench.done("report sweep.csv -o sweep.html");
    let page = texts(&bench.read("sweep.html"));
    for words in ["Peak torque, joint 2", "Peak force, carriage", "Lead, carriage", "force in N\n"]
    {
        assert!(page.contains(words), "{words}: {page}");
    }
    let (force, lead) = (of("peak_force_n"), of("carriage_lead_s"));
    assert!(force[0] < force[1] && lead.iter().all(|lead| lead.is_finite()), "{force:?} {lead:?}");
    let torque = of("peak_torque1_n_m");
    assert!((torque[0] / torque[1] - 1.0).abs() < 1e-6, "the path moves the carriage: {torque:?}");
    bench.done("report sweep.csv -o sweep.html");
    bench.done(&format!("solve {GANTRY} --set carriage.mass=24 -o out"));
    let alone = bench.number("out", "results/carriage/peak_force_n");
    assert!((force[1] / alone - 1.0).abs() < 1e-9, "{force:?} {alone}");
}

#[test]
fn what_an_arm_on_a_carriage_does_not_take_is_refused_in_words() {
    let bench = Bench::new();
    let warned = stderr(&ended(
        4,
        bench.run(&format!("solve {GANTRY} --set limits.force=100 --strict -o out")),
    ));
    assert!(warned.contains("carriage: limits.force = 100 N is exceeded: 226"), "{warned}");
    let two = "specs/arms/two_links.toml";
    let path = "trajectories/arms/gantry_1.5s.csv";
    let cases = [
        (3, format!("solve {two} {path}"), "the arm has no [carriage]"),
        (
            3,
            format!("solve {GANTRY} --set carriage.axis=[0,0]"),
            "must be a direction along x and y",
        ),
        (3, format!("solve {GANTRY} --set carriage.mass=-1"), "carriage.mass = -1 kg, but must"),
        (3, format!("solve {GANTRY} --set carriage.root_stiffness=1"), "is for one link"),
        (
            3,
            format!("solve {GANTRY} --set carriage.colour=1"),
            "known here: mass, viscous_friction and axis\n",
        ),
        (3, format!("solve {GANTRY} --set limits.deflection=1"), "is a limit of a link"),
        (3, format!("solve {GANTRY} --set limits.motor_rate=1"), "must come with a [drive]"),
        (3, format!("solve {GANTRY} --set carriage.axis=[1,0,0]"), "must hold two numbers"),
        (3, format!("solve {MAST} {path} --set carriage.axis=[1,0]"), "two links or more"),
        (3, format!("solve {MAST} {path} --set limits.bending_moment=-1"), "= -1 N m, but"),
    ];
    for (exit, words, expected) in cases {
        let told = stderr(&ended(exit, bench.run(&words)));
        assert!(told.contains(expected), "{words}: {told}");
    }
    bench.done("solve specs/arms/two_links.toml trajectories/arms/line_1.5s.csv -o fixed");
    let gantry = "simulate specs/carriages/gantry_arm.toml";
    let two_links = format!("simulate {two} fixed/torques.csv --target fixed/tip.csv");
    bench.done(&format!("{two_links} --save-state state.json -o rest"));
    bench.write("all.csv", "time,torque1,torque2,force\n0,0,0,0\n1,0,0,0\n2,0,0,0\n3,0,0,0\n");
    for (exit, words, expected) in [
        (
            3,
            format!("{gantry} fixed/torques.csv --at 0,0.5"),
            "fixed/torques.csv: the column force is missing, and there is no force.csv beside it",
        ),
        (3, format!("{gantry} all.csv --state state.json"), "is of a base at rest, but must be"),
        (2, format!("{gantry} all.csv"), "nothing states where the arm starts"),
        (2, format!("{two_links} --carriage-at 1"), "--carriage-at is for an arm on a carriage"),
        (
            3,
            format!("sweep {GANTRY} --torque fixed/torques.csv --vary carriage.mass=12,24"),
            "there is no force.csv beside it",
        ),
    ] {
        let told = stderr(&ended(exit, bench.run(&words)));
        assert!(told.contains(expected), "{words}: {told}");
    }
    let text = stdout(&succeeded(
        bench.run("modes specs/carriages/gantry_arm.toml --at=-1,0.35 --count 2"),
    ));
    assert!(text.contains("the carriage is held at 0"), "{text}");
}

#[test]
fn few_digits_of_a_carriages_place_are_an_error_of_the_force() {
    let bench = Bench::new();
    let root = env!("CARGO_MANIFEST_DIR");
    let path =
        std::fs::read_to_string(format!("{root}/trajectories/arms/gantry_1.5s.csv")).unwrap();
    let rows = path.lines().map(|line| match line.rsplit_once(',') {
        Some((before, place)) => {
            place.parse::<f64>().map_or(line.to_owned(), |place| format!("{before},{place:.4}"))
        }
        None => line.to_owned(),
    });
    bench.write("rounded.csv", &rows.collect::<Vec<_>>().join("\n"));
    let solved = "solve specs/carriages/gantry_arm.toml";
    bench.done(&format!("{solved} rounded.csv -o rounded --digits full --quiet"));
    bench.done(&format!(
        "{solved} trajectories/arms/gantry_1.5s.csv -o exact --digits full --quiet"
    ));
    let [own, exact] =
        ["rounded", "exact"].map(|folder| bench.number(folder, "results/carriage/peak_force_n"));
    let input = bench.number("rounded", "errors/carriage/force/input");
    let off = (own / exact - 1.0).abs();
    assert!(off < input && input < 0.5, "{off:e} {input:e}");
}

#[test]
fn a_sweep_names_the_limit_of_a_carriage_by_its_key() {
    let bench = bench();
    let limits = "--set limits.force=300 --vary carriage.mass=12,20";
    bench.done(&format!("sweep {GANTRY} {limits} -o arm.csv"));
    assert_eq!(bench.cells("arm.csv", "warnings")[1], "limit_exceeded:carriage.force");
    let limits = "--set limits={force=4000,carriage_travel=1.9} --vary payload.mass=40,80";
    bench.done(&format!("sweep {MAST} move.csv {limits} -o mast.csv"));
    let warned = &bench.cells("mast.csv", "warnings")[0];
    assert_eq!(warned, "limit_exceeded:force;limit_exceeded:carriage_travel");
}

#[test]
fn places_of_a_link_on_a_carriage_are_refused_with_a_remedy() {
    let bench = Bench::new();
    bench.write("places.csv", "time,x,y\n0,1,0\n0.1,1,0.1\n0.2,1,0.2\n0.3,1,0.2\n");
    let told = stderr(&ended(3, bench.run("solve specs/carriages/sheet.toml places.csv")));
    assert!(told.contains("from the carriage") && told.contains("as displacement"), "{told}");
}

#[test]
fn a_mast_beyond_its_buckling_weight_falls_with_a_word() {
    let bench = Bench::new();
    let sheet = "specs/carriages/sheet.toml";
    bench.done("trajectory septic --distance 0.05 --duration 1.5 --step 0.005 -o slow.csv");
    bench.done(&format!("solve {sheet} slow.csv -o out --quiet"));
    let heavy = "--set gravity=[0,-130]";
    let told =
        stderr(&succeeded(bench.run(&format!("simulate {sheet} out/force.csv {heavy} -o fallen"))));
    assert!(told.contains("the weight is 1.16 of the weight that buckles the link"), "{told}");
    // The modes keep their numbers: the first has no period, and the second that of `modes`.
    let periods = bench.json("fallen/summary.json")["periods_s"].clone();
    let modes = bench.printed(&format!("modes {sheet} {heavy} --json"));
    let second = serde_json::from_str::<serde_json::Value>(&modes).unwrap();
    let second_s = second["free"]["frequency_hz"][1].as_f64().unwrap().recip();
    assert!(periods[0].is_null(), "{periods}");
    assert!((periods[1].as_f64().unwrap() / second_s - 1.0).abs() < 1e-4, "{periods} {second_s}");
    bench.done("trajectory septic --distance 0.001 --duration 0.1 --step 0.005 -o short.csv");
    bench.sampled("force.csv", "time,force", 0..=4, |k| [0.02 * k, k * (4.0 - k)]);
    bench.done(&format!(
        "sweep {sheet} short.csv --torque force.csv --vary gravity.1=-9.81,-130 -o s.csv"
    ));
    let periods = bench.numbers("s.csv", "period_1_s");
    assert!((periods[0] - 0.349_789_33).abs() < 1e-7 && periods[1].is_nan(), "{periods:?}");
    let told = stderr(&succeeded(bench.run(&format!("frf {sheet} {heavy} --points 3"))));
    assert!(told.contains("it responds so only under control"), "{told}");
    let told = stderr(&ended(
        3,
        bench.run("solve specs/carriages/stacker_mast.toml slow.csv --set gravity=[0,-9.81]"),
    ));
    assert!(told.contains("set start_angle") && !told.contains("as angles"), "{told}");
}

/// x in m of the nodes of a link over time, from `nodal_positions.csv`.
fn along_x(bench: &Bench, link: usize) -> Vec<Vec<f64>> {
    let table = bench.table("played/nodal_positions.csv");
    let first = format!("x{link}_");
    table.into_iter().filter(|(name, _)| name.starts_with(&first)).map(|(_, own)| own).collect()
}

#[test]
fn solved_efforts_of_an_arm_on_a_carriage_play_its_path() {
    let bench = Bench::new();
    bench.done(&format!("solve {GANTRY} -o out --digits full"));
    let gantry = "simulate specs/carriages/gantry_arm.toml";
    let played = format!("{gantry} out/torques.csv --target out/tip.csv -o played --digits full");
    let run = succeeded(bench.run(&played));
    let text = stdout(&run);
    assert!(text.contains("\ncarriage peak 226.7 N; ") && text.contains("moves from "), "{text}");
    assert!(stderr(&run).contains("out/force.csv: gives the column force"), "{}", stderr(&run));
    assert!(bench.number("played", "tip_error/share") < 2e-6);
    assert!(bench.number("played", "errors/energy") < 1e-9);
    let ends =
        ["start_m", "end_m"].map(|key| bench.number("played", &format!("results/carriage/{key}")));
    assert!(ends[0].abs() < 1e-6 && (ends[1] - 0.8).abs() < 2e-6, "{ends:?}");
    let of = |file: &str, name: &str| column(&bench, file, name);
    let (own, wanted) =
        (of("played/carriage.csv", "carriage_m"), of("out/carriage.csv", "carriage_m"));
    let off = own.iter().zip(&wanted).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(off < 2e-6, "{off:e}");
    // Newton's law of the whole: force less friction accelerates the masses along the rail.
    let force = of("played/force.csv", "force_n");
    let rate = of("played/carriage.csv", "carriage_velocity_m_s");
    let time = of("played/force.csv", "time_s");
    let links = [(1, 0.8 * 0.7, 0.6), (2, 0.4 * 0.6, 0.3)];
    let links = links.map(|(link, mass_kg, tip_kg)| (along_x(&bench, link), mass_kg, tip_kg));
    let moment = |k: usize| {
        let of_link = |(x_m, mass_kg, tip_kg): &(Vec<Vec<f64>>, f64, f64)| {
            let last = x_m.len() - 1;
            assert!(last >= 8 && last.is_multiple_of(2), "{last}");
            let weight =
                |node| if node == 0 || node == last { 1.0 } else { 2.0 + 2.0 * (node % 2) as f64 };
            let mean: f64 = (0..=last).map(|node| weight(node) * x_m[node][k]).sum();
            mass_kg * mean / (3.0 * last as f64) + tip_kg * x_m[last][k]
        };
        12.0 * own[k] + links.iter().map(of_link).sum::<f64>()
    };
    let moments: Vec<f64> = (0..own.len()).map(moment).collect();
    let step_s = time[1] - time[0];
    let off = (1..own.len() - 1).fold(0.0_f64, |most, k| {
        let found = (moments[k + 1] - 2.0 * moments[k] + moments[k - 1]) / (step_s * step_s);
        most.max((found - (force[k] - 20.0 * rate[k])).abs())
    });
    assert!(off < 1e-4 * 226.7, "{off:e}");
    // All efforts in one table, and feedback with gains of each joint.
    bench.done(&format!("solve {GANTRY} --write all.csv --digits full"));
    let feedback = "--feedback 50,1,50,1,500,50 --reference out/joint_angles.csv";
    let held = format!("{gantry} out/torques.csv {feedback} --target out/tip.csv -o held");
    let text = stdout(&succeeded(bench.run(&held)));
    assert!(text.contains("1.000 N m s/rad;\n         500.0 N/m, 50.00 N s/m around"), "{text}");
    assert!(bench.number("held", "tip_error/share") < 2e-6);
    assert!((bench.number("held", "feedback/2/stiffness_n_m") - 500.0).abs() < 1e-9);
    bench.done(&format!("{gantry} all.csv --target out/tip.csv -o one"));
    assert!(bench.number("one", "tip_error/share") < 1e-4);
    // The motion of all joints takes the solved force.
    let moved = format!("{gantry} out/joint_angles.csv --input hub-angle --measured out/force.csv");
    let text = stdout(&succeeded(bench.run(&format!("{moved} -o moved"))));
    assert!(text.contains("\nforce  "), "{text}");
    assert!(bench.number("moved", "measured/channels/0/share") < 1e-5);
    for words in ["report held", "report out held", "compare held held"] {
        succeeded(bench.run(words));
    }
    assert!(bench.read("held/report.html").contains("Force on the carriage"));
    // The same table on every case of a sweep.
    let swept = "--torque out/torques.csv --vary carriage.mass=12,15 -o sweep.csv";
    bench.done(&format!("sweep {GANTRY} {swept}"));
    let share = bench.numbers("sweep.csv", "tip_error_share");
    assert!(share[0] < 2e-6 && share[1] > 0.01, "{share:?}");
    let speed_m_s = bench.numbers("sweep.csv", "peak_carriage_speed_m_s");
    assert!((speed_m_s[0] - 2.70808).abs() < 1e-4 && speed_m_s[1] < 2.5, "{speed_m_s:?}");
}

#[test]
fn an_arm_on_a_very_heavy_carriage_moves_as_on_a_fixed_axis() {
    let bench = Bench::new();
    bench.done("solve specs/arms/two_links.toml trajectories/arms/line_1.5s.csv -o fixed");
    let with_column = |file: &str, name: &str, most: usize| -> String {
        let table = bench.read(file);
        let rows = table.lines().take(most + 1).enumerate();
        let rows = rows.map(|(k, row)| format!("{row},{}\n", if k == 0 { name } else { "0" }));
        rows.collect::<Vec<_>>().concat()
    };
    bench.write("all.csv", &with_column("fixed/torques.csv", "force_n", usize::MAX - 1));
    bench.write("short.csv", &with_column("fixed/torques.csv", "force_n", 20));
    bench.write("at.csv", &with_column("fixed/joint_angles.csv", "carriage_m", usize::MAX - 1));
    let held = "--feedback 50,1 --digits full --reference";
    let fixed = "specs/arms/two_links.toml fixed/torques.csv";
    bench.done(&format!("simulate {fixed} {held} fixed/joint_angles.csv -o fixed2"));
    let gantry = "simulate specs/carriages/gantry_arm.toml";
    let heavy = "--set carriage.mass=1e12";
    bench.done(&format!("{gantry} all.csv {heavy} {held} at.csv -o heavy"));
    for name in ["x_m", "y_m"] {
        let [a, b] = ["fixed2", "heavy"].map(|run| column(&bench, &format!("{run}/tip.csv"), name));
        let off = a.iter().zip(&b).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(off < 1e-8, "{name}: {off:e}");
    }
    // A place on the rail moves the whole motion.
    let at = format!("{gantry} short.csv --at=-60deg,20deg --digits full");
    bench.done(&format!("{at} --carriage-at 2m -o far"));
    bench.done(&format!("{at} -o near"));
    let [far, near] = ["far", "near"].map(|run| column(&bench, &format!("{run}/tip.csv"), "x_m"));
    let apart = far.iter().zip(&near).map(|(far, near)| (far - near - 2.0).abs());
    assert!(apart.fold(0.0, f64::max) < 1e-9, "{far:?} {near:?}");
    // Up the rail the weight of all hangs on the force.
    let told = stderr(&bench.run(&format!("{at} --set carriage.axis=[0,1] -o up")));
    let all_kg = 12.0 + 0.8 * 0.7 + 0.6 + 0.4 * 0.6 + 0.3;
    let held = format!("the force begins with 0.0 N, but {:.3}", 9.81 * all_kg);
    assert!(told.contains(&held) && told.contains(" N hold the arm"), "{held}: {told}");
}

#[test]
fn a_path_moves_the_carriage_of_an_arm_along_within_its_limits() {
    let bench = Bench::new();
    let line = "trajectory septic --path line --from 0.5,-0.9 --to 1.9,-0.6 --carriage 0,0.8";
    let gantry = "--link specs/carriages/gantry_arm.toml";
    bench.done(&format!("{line} --duration 1.5 --step 0.002 {gantry} -o path.csv"));
    let of = |file: &str, name: &str| column(&bench, file, name);
    for (time_s, at_m) in of("path.csv", "time").iter().zip(of("path.csv", "carriage")) {
        assert!((at_m - 0.8 * septic(time_s / 1.5)).abs() < 1e-12, "{time_s}: {at_m}");
    }
    // At a stop the carriage has made the share of its way that the tip has of the path.
    let via = "--via 0.5,-0.5 --carriage=-0.3m,0.1 --dwell 0.1 --rest-after 0.2";
    let corner = "trajectory sine --path line --from 0.9,-0.5 --to 1.1,-0.5";
    bench.done(&format!("{corner} {via} --duration 1.2 --step 0.01 -o via.csv"));
    let (x_m, at_m) = (of("via.csv", "x"), of("via.csv", "carriage"));
    let stop = x_m.iter().position(|x| (x - 0.5).abs() < 1e-12).unwrap();
    assert!((at_m[stop] - (-0.3 + 0.4 * 0.4)).abs() < 1e-12, "{}", at_m[stop]);
    assert!((at_m[0] + 0.3).abs() < 1e-15 && (at_m[at_m.len() - 1] - 0.1).abs() < 1e-15);
    // The shortest within a limit of the carriage; with the linear level it takes little time.
    let linear = "--set analysis.second_order=none";
    for (limit, key, most) in [
        ("force=100", "peak_force_n", 100.0),
        ("carriage.power=100", "peak_power_w", 100.0),
        ("carriage_speed=1.5", "peak_carriage_speed_m_s", 1.5),
    ] {
        let fit = format!("{line} --step 0.04 {gantry} {linear} --fit-limit {limit} -o fast.csv");
        let told = stderr(&succeeded(bench.run(&fit)));
        let named = limit.replace("carriage.", "carriage ");
        let is_doubled = told.contains("carriage force") || told.contains("carriage carriage");
        assert!(told.contains(&named) && !told.contains("joint 3"), "{named}: {told}");
        assert!(!is_doubled, "{told}");
        bench.done(&format!("solve specs/carriages/gantry_arm.toml fast.csv {linear} -o fast"));
        let found = bench.number("fast", &format!("results/carriage/{key}"));
        assert!(found <= most && found > 0.9 * most, "{limit}: {found}");
    }
    for (exit, words, expected) in [
        (
            3,
            format!("{line} --duration 1.5 --step 0.002 --link specs/arms/two_links.toml"),
            "the arm has no [carriage]",
        ),
        (
            2,
            "trajectory septic --distance 1 --duration 1 --step 0.01 --carriage 1".to_owned(),
            "--path",
        ),
        (
            2,
            format!("{line},1 --duration 1.5 --step 0.002"),
            "must be one place, or FROM,TO: 0,0.8",
        ),
        (
            3,
            format!("{line},-3 --duration 1.5 --step 0.002 {gantry}").replace("0,0.8,", "0,"),
            "or other places of --carriage",
        ),
        (
            3,
            format!("{line} --step 0.02 --link specs/arms/two_links.toml --fit-limit force=5"),
            "above the links only [carriage] has limits",
        ),
    ] {
        let told = stderr(&ended(exit, bench.run(&words)));
        assert!(told.contains(expected), "{words}: {told}");
    }
}

/// The hint names the setting that keeps the weight out, not one that is there.
#[test]
fn a_weight_that_frf_and_fit_leave_out_has_the_remedy_of_its_reason() {
    let bench = Bench::new();
    let modal = "damping={model='modal',ratio=0.01}";
    bench.write("measured.toml", "[[frequency]]\nmode = 1\ncarriage = 'held'\nvalue = 2.9354\n");
    for (words, remedy) in [
        (format!("frf {MAST} --set gravity=[0,-9.81]"), Some("set start_angle")),
        (format!("frf {SHEET} --set analysis.modes=2"), Some("leave analysis.modes out")),
        (format!("frf {SHEET} --set {modal}"), Some("use hysteretic or rayleigh damping")),
        (format!("frf {SHEET} --set mesh.elements=300"), Some("lower --to, or use fewer")),
        (format!("frf {SHEET} --set mesh.elements=100"), None),
        (format!("modes {MAST} --set gravity=[0,-9.81]"), Some("set start_angle")),
        (format!("fit {SHEET} measured.toml --free segments.*.E"), Some("fit computes no weight")),
    ] {
        let told = stderr(&succeeded(bench.run(&words)));
        let is_left_out = told.contains("those here are without it");
        assert_eq!(is_left_out, remedy.is_some(), "{words}: {told}");
        assert!(told.contains(remedy.unwrap_or_default()), "{words}: {told}");
        let sets = told.contains("set start_angle");
        assert_eq!(sets, remedy == Some("set start_angle"), "{words}: {told}");
    }
    // 200 elements have their weight, but not their halves.
    let told = stderr(&succeeded(bench.run(&format!("frf {SHEET} --set mesh.elements=200"))));
    assert!(
        told.contains("halved elements are more than 256") && !told.contains("modal"),
        "{told}"
    );
}

#[test]
fn the_page_of_an_arms_carriage_has_the_peak_of_the_summary() {
    let bench = Bench::new();
    bench.done(&format!("solve {GANTRY} --set limits.carriage_speed=3 -o out --quiet"));
    let peak =
        bench.json("out/summary.json")["results"]["carriage"]["peak_carriage_speed_m_s"].clone();
    // A peak between two samples.
    let text = bench.read("out/summary.json").replace(&peak.to_string(), "2.8125");
    bench.write("out/summary.json", &text);
    bench.done("report out -o page.html");
    let page = texts(&bench.read("page.html"));
    assert!(page.contains("At most 2.812 m/s."), "{page}");
}

#[test]
fn a_refused_motion_of_a_station_is_one_of_the_output() {
    let bench = Bench::new();
    bench.sampled("tip.csv", "time,displacement", 0..=20, |k| [0.1 * k, 0.01 * k * k]);
    let solve = format!("solve {MAST} tip.csv --set output.at=4");
    let told = stderr(&ended(3, bench.run(&solve)));
    assert!(
        told.contains("error: tip.csv:") && told.contains("bring the output to rest"),
        "{told}"
    );
    assert!(!told.replace("tip.csv", "").contains("tip"), "{told}");
}

/// Zeros and periods in the columns of a sweep have the weight of a link that keeps its direction alone.
#[test]
fn a_sweep_tells_that_its_columns_leave_the_weight_out() {
    let bench = Bench::new();
    bench.done("trajectory septic --distance 0.05 --duration 1.5 --step 0.005 -o slow.csv");
    let told = |words: &str| stderr(&succeeded(bench.run(&format!("{words} -o s.csv"))));
    let on_hub = format!("sweep {HUB} slow.csv --vary payload.mass=0,0.1");
    let weight = "--set gravity=[0,-9.81] --set start_angle=-1.5";
    let remark = "those without gravity";
    assert!(told(&format!("{on_hub} {weight}")).contains(remark));
    assert!(!told(&on_hub).contains(remark));
    let on_carriage = format!("sweep {SHEET} slow.csv --vary carriage.mass=5,6");
    assert!(!told(&on_carriage).contains(remark));
    assert!(told(&format!("{on_carriage} --set mesh.elements=70")).contains(remark));
    bench.done(&format!("solve {HUB} slow.csv {weight} -o out --quiet"));
    assert!(told(&format!("{on_hub} {weight} --torque out/torque.csv")).contains(remark));
}

/// The play of `verify` has all terms: an answer of first order is off by those that `solve` states as left out.
#[test]
fn an_answer_of_first_order_is_verified_within_the_terms_left_out() {
    let bench = Bench::new();
    bench.done("trajectory septic --distance 0.15 --duration 0.7 --step 0.005 -o fast.csv");
    let solve = |order: &str| {
        let order = format!("--set analysis.second_order={order} --verify -o {order}");
        bench.run(&format!("solve {SHEET} fast.csv {order} --quiet"))
    };
    succeeded(solve("first"));
    succeeded(solve("full"));
    let told = stderr(&ended(4, solve("none")));
    assert!(told.contains("tip, the carriage moved as solved"), "{told}");
    let tip = |order: &str| {
        let summary = bench.json(&format!("{order}/summary.json"));
        let own = &summary["verification"][0];
        let [found, bound] = ["found", "bound"].map(|key| own[key].as_f64().unwrap());
        (found, bound, own["of"].as_str().unwrap().to_owned())
    };
    let (first, bound, of) = tip("first");
    assert_eq!(of, "the tip's travel, terms left out");
    let left_out = bench.number("first", "second_order/left_out");
    let (full, least, of) = tip("full");
    assert_eq!(of, "the tip's travel");
    assert!(first > least && full < 0.1 * first, "{first} {full} {least}");
    assert!(bound < least + 3.1 * left_out, "{bound} {least} {left_out}");
}
