//! Pages of arms: with their run, of its folder, and of several folders side by side.

use std::fs;

use super::report::points;
use super::{Bench, column, repository, stderr, stdout};

const ARM: &str = "specs/arms/two_links.toml";
const PATH: &str = "trajectories/arms/line_1.5s.csv";

/// `solve` of an arm into a folder; fast, since what is drawn here need not be exact.
#[track_caller]
fn solved(bench: &Bench, folder: &str, more: &[&str]) {
    let fast = ["--set", "analysis.second_order=\"none\"", "--set", "mesh.elements=4"];
    let (arm, path) = (repository(ARM), repository(PATH));
    let given = ["solve", &arm, &path, "-q", "-o", folder];
    bench.done(&[&given[..], &fast, more].concat());
}

#[track_caller]
fn done(bench: &Bench, arguments: &[&str]) -> String {
    let output = bench.done(arguments);
    stdout(&output)
}

#[track_caller]
fn refused(bench: &Bench, arguments: &[&str]) -> String {
    let output = bench.ends(3, arguments);
    stderr(&output)
}

/// Holds a line of a figure against values at times.
#[track_caller]
fn assert_line(bench: &Bench, (figure, line): (&str, &str), (times_s, values): (&[f64], &[f64])) {
    let shown = points(&bench.read(&format!("figures/{figure}.svg")), line);
    let most = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    assert!(shown.len() > 200, "{figure}: {} points", shown.len());
    let step_s = times_s[1] - times_s[0];
    for (time_s, value) in shown {
        let row = times_s.partition_point(|time| *time < time_s - 0.5 * step_s);
        assert!((times_s[row] - time_s).abs() < 0.1 * step_s, "{figure} at {time_s} s");
        let off = (values[row] - value).abs();
        assert!(off < 1e-3 * most, "{figure}, {line}, at {time_s} s: {off:e} off");
    }
}

#[test]
fn figures_of_an_arm_show_the_numbers_of_its_tables() {
    let bench = Bench::new();
    solved(&bench, "out", &["--moments"]);
    let told = done(&bench, &["report", "out", "--svg", "figures"]);
    let names = [
        "angle-1.svg",
        "angle-2.svg",
        "bending-angles.svg",
        "root-moments.svg",
        "tip.svg",
        "torque-1.svg",
        "torque-2.svg",
        "waves-1.svg",
        "waves-2.svg",
    ];
    assert_eq!(bench.names("figures"), names);
    assert_eq!(told, "written  9 figures in figures\n");
    let of = |file: &str, name: &str| column(&bench, &format!("out/{file}"), name);
    let times_s = of("torques.csv", "time_s");
    for (figure, line, file, name) in [
        ("torque-1", "flexible arm", "torques.csv", "torque1_n_m"),
        ("torque-2", "rigid arm", "rigid_torques.csv", "rigid_torque2_n_m"),
        ("angle-2", "flexible arm", "joint_angles.csv", "joint2_rad"),
        ("angle-1", "rigid arm", "joint_angles.csv", "rigid_joint1_rad"),
        ("tip", "y", "tip.csv", "y_m"),
        ("root-moments", "link 2", "bending_moments.csv", "m2_0_n_m"),
    ] {
        assert_line(&bench, (figure, line), (&times_s, &of(file, name)));
    }
    let rigid = of("joint_angles.csv", "rigid_joint2_rad");
    let angle = of("joint_angles.csv", "joint2_rad");
    let bent: Vec<f64> = angle.iter().zip(rigid).map(|(own, rigid)| 1e3 * (own - rigid)).collect();
    assert_line(&bench, ("bending-angles", "joint 2"), (&times_s, &bent));
    // What has a limit is drawn with it, of each joint and of each link.
    let limits = "links.fore.limits={hub_rate=2, power=10, bending_moment=5, deflection=0.05}";
    let drive = "links.fore.drive={joint_stiffness=1000.0, rotor_inertia=0.001, gear_ratio=2.0}";
    solved(&bench, "out", &["--moments", "--set", limits, "--set", drive]);
    done(&bench, &["report", "out", "--svg", "figures"]);
    let rate = of("joint_angles.csv", "joint2_rate_rad_s");
    let torque = of("torques.csv", "torque2_n_m");
    let power: Vec<f64> = torque.iter().zip(&rate).map(|(torque, rate)| torque * rate).collect();
    assert_line(&bench, ("rate-2", "flexible arm"), (&times_s, &rate));
    assert_line(&bench, ("power-2", "flexible arm"), (&times_s, &power));
    let motor = of("motor.csv", "motor2_torque_n_m");
    assert_line(&bench, ("motor-torque-2", "flexible arm"), (&times_s, &motor));
    let deflected = points(&bench.read("figures/tip-deflection-2.svg"), "flexible arm");
    let largest = deflected.iter().fold(0.0_f64, |most, (_, value)| most.max(value.abs()));
    let joints = &bench.json("out/summary.json")["results"]["joints"];
    let exact = joints[1]["peak_deflection_m"].as_f64().unwrap();
    assert!((largest / exact - 1.0).abs() < 0.02, "{largest} of {exact}");
    for (figure, limit) in [
        ("rate-2", "limit 2 rad/s"),
        ("power-2", "limit 10 W"),
        ("tip-deflection-2", "limit 0.05 m"),
        ("root-moments", "link 2: limit 5 N m"),
    ] {
        let line = format!("class=\"limit s{}\"", if figure == "root-moments" { 2 } else { 1 });
        let svg = bench.read(&format!("figures/{figure}.svg"));
        assert!(svg.contains(limit) && svg.contains(&line), "{figure}");
    }
    assert!(!bench.names("figures").contains(&"rate-1.svg".to_owned()), "it has no limit");
    // Without moments the waves are those of the deflection, and the page says what is missing.
    solved(&bench, "out", &["--every", "8"]);
    done(&bench, &["report", "out"]);
    let page = bench.read("out/report.html");
    assert!(page.contains("deflection from the chord") && !page.contains("fig-root-moments"));
    assert!(
        page.contains("w: distance of the link from its chord") && !page.contains("EI ∂²w/∂x²")
    );
    assert!(page.contains("bending moments, since they were not written"));
}

#[test]
fn the_page_of_an_arm_made_with_its_run_is_the_one_made_of_its_files() {
    let bench = Bench::new();
    let title = "title=\"</script><script>alert(1)</script>\"";
    let name = "links.fore.segments.0.name=\"<img>\"";
    let traps = ["--set", title, "--set", name, "--set", "links.fore.limits.torque=1"];
    let more = ["--moments", "--every", "4", "--digits", "full", "--report"];
    solved(&bench, "out", &[&more[..], &traps].concat());
    let with_run = bench.read("out/report.html");
    assert_eq!(done(&bench, &["report", "out"]), "written  out/report.html\n");
    assert!(with_run == bench.read("out/report.html"));
    assert!(with_run.starts_with("<!DOCTYPE html>") && with_run.ends_with("</html>"));
    let sections = ["warnings", "first", "animation", "arm", "figures", "errors", "inputs"];
    let places = sections.map(|section| with_run.find(&format!("<section id=\"{section}\"")));
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{places:?}");
    assert!(with_run.contains("joint 2: limits.torque = 1 N m is exceeded"));
    assert!(!with_run.contains("<script>alert") && !with_run.contains("<img"), "not escaped");
    assert_eq!(
        with_run.matches("</script>").count(),
        3,
        "the motion, the style of figures, the script"
    );
    let addresses = with_run.matches("://").count();
    assert_eq!(addresses, with_run.matches("http://www.w3.org/2000/svg").count(), "an address");
    assert!(with_run.len() < 2_000_000, "{} bytes", with_run.len());
    // A run that is repeated is compared without its page, and a later one removes it.
    assert!(bench.run(&["solve", "--repeat", "out"]).status.code().is_some());
    solved(&bench, "out", &[]);
    assert!(!bench.names("out").contains(&"report.html".to_owned()), "an old page stays");
}

/// Makes a folder look like that of a simulation, whose tip is 1 cm off along x.
fn played(bench: &Bench, from: &str, to: &str) {
    fs::create_dir(bench.path(to)).unwrap();
    for name in bench.names(from) {
        if name != "rigid_torques.csv" {
            fs::copy(bench.path(from).join(&name), bench.path(to).join(&name)).unwrap();
        }
    }
    let mut summary = bench.json(&format!("{from}/summary.json"));
    let files = summary["files"].as_array_mut().unwrap();
    files.retain(|file| file != "rigid_torques.csv");
    summary["command"] = "simulate".into();
    for key in ["motion", "results", "errors", "second_order"] {
        summary.as_object_mut().unwrap().remove(key);
    }
    bench.write(&format!("{to}/summary.json"), &summary.to_string());
    let write = |file: &str, columns: &[(String, Vec<f64>)]| {
        let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        let row = |k: usize| {
            let fields = columns.iter().map(|(_, values)| values[k].to_string());
            fields.collect::<Vec<_>>().join(",") + "\n"
        };
        let rows: String = (0..columns[0].1.len()).map(row).collect();
        bench.write(&format!("{to}/{file}"), &format!("{}\n{rows}", names.join(",")));
    };
    let mut tip = bench.table(&format!("{from}/tip.csv"));
    tip[1].1.iter_mut().for_each(|x| *x += 0.01);
    write("tip.csv", &tip);
    let mut angles = bench.table(&format!("{from}/joint_angles.csv"));
    angles.retain(|(name, _)| !name.starts_with("rigid"));
    write("joint_angles.csv", &angles);
}

#[test]
fn runs_of_an_arm_stand_side_by_side() {
    let bench = Bench::new();
    solved(&bench, "solved", &[]);
    played(&bench, "solved", "played");
    done(&bench, &["report", "played", "-q"]);
    let alone = bench.read("played/report.html");
    assert!(alone.contains("fig-torque-1") && !alone.contains("data-name=\"rigid arm\""));
    assert!(alone.contains("since the rigid arm's were not written"), "what is missing");
    let both = ["report", "solved", "played", "-q"];
    done(&bench, &both);
    let page = bench.read("solved/report.html");
    assert!(page.contains("<strong>played</strong> flexlink"), "which is which");
    done(&bench, &[&both[..], &["--svg", "figures"]].concat());
    let times_s = column(&bench, "solved/torques.csv", "time_s");
    let torque = column(&bench, "solved/torques.csv", "torque1_n_m");
    for line in ["solved", "played"] {
        assert_line(&bench, ("torque-1", line), (&times_s, &torque));
    }
    assert_line(&bench, ("tip-error", "played"), (&times_s, &vec![0.01; times_s.len()]));
    // Folders of one name are told apart by the folders that they lie in.
    fs::create_dir(bench.path("more")).unwrap();
    fs::rename(bench.path("played"), bench.path("more/solved")).unwrap();
    done(&bench, &["report", "solved", "more/solved", "-q", "-o", "both.html"]);
    assert!(bench.read("both.html").contains("<strong>more/solved</strong>"));
    let told = refused(&bench, &["report", "solved", "nowhere"]);
    assert!(told.contains("nowhere"), "{told}");
    done(
        &bench,
        &["solve", &repository(super::LINK), &repository(super::MOTION), "-q", "-o", "link"],
    );
    let told = refused(&bench, &["report", "solved", "link"]);
    assert!(
        told.contains("link: result = another, but must be a run of an arm of 2 links"),
        "{told}"
    );
    let told = refused(&bench, &["report", "link", "solved"]);
    assert!(told.contains("only runs of arms stand side by side"), "{told}");
}

#[test]
fn what_is_missing_or_damaged_in_an_arms_folder_is_refused_by_its_name() {
    let bench = Bench::new();
    solved(&bench, "out", &[]);
    for file in ["torques.csv", "joint_angles.csv", "tip.csv", "nodal_positions.csv", "nodes.csv"] {
        let text = bench.read(&format!("out/{file}"));
        fs::remove_file(bench.path("out").join(file)).unwrap();
        let told = refused(&bench, &["report", "out"]);
        assert!(told.contains(&format!("{file} is missing")), "{told}");
        bench.write(&format!("out/{file}"), &text);
    }
    let damaged = |file: &str, from: &str, to: &str, words: &str| {
        let path = format!("out/{file}");
        let text = bench.read(&path);
        assert!(text.contains(from), "{file} has no {from}");
        bench.write(&path, &text.replacen(from, to, 1));
        let told = refused(&bench, &["report", "out"]);
        assert!(told.contains(words) && told.contains(file), "{told}");
        bench.write(&path, &text);
    };
    damaged("torques.csv", "torque2_n_m", "torque3_n_m", "torque2_n_m");
    damaged("nodal_positions.csv", "y2_4_m", "y2_5_m", "y2_4_m");
    damaged("nodes.csv", "2,1,", "2,2,", "node = \"2\", but must be 1");
    damaged("nodes.csv", "2,4,0.6,fore", "", "from its hub to its tip");
    damaged("summary.json", "\"length_m\": 0.7", "\"length_m\": -0.7", "arm.links.0");
    damaged("summary.json", "\"window_start_s\": -", "\"window_start_s\": -1", "summary.json");
    let rows = bench.read("out/tip.csv");
    let fewer: Vec<&str> = rows.lines().take(9).collect();
    bench.write("out/tip.csv", &fewer.join("\n"));
    let told = refused(&bench, &["report", "out"]);
    assert!(told.contains("tip.csv") && told.contains("torques.csv"), "{told}");
}
