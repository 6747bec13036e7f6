//! Pages of arms: with their run, of its folder, and of several folders side by side.

use std::fs;

use super::report::points;
use super::{Bench, LINK, MOTION, column, peak};

const ARM: &str = "specs/arms/two_links.toml trajectories/arms/line_1.5s.csv";

/// `solve` of an arm into a folder; fast, since what is drawn here need not be exact.
#[track_caller]
fn solved(bench: &Bench, folder: &str, more: &str) {
    let fast = "--set analysis.second_order=\"none\" --set mesh.elements=4";
    bench.done(&format!("solve {ARM} -q -o {folder} {fast} {more}"));
}

/// Holds a line of a figure against values at times.
#[track_caller]
fn assert_line(bench: &Bench, (figure, line): (&str, &str), (times_s, values): (&[f64], &[f64])) {
    let shown = points(&bench.read(&format!("figures/{figure}.svg")), line);
    assert!(shown.len() > 200, "{figure}: {} points", shown.len());
    let step_s = times_s[1] - times_s[0];
    for (time_s, value) in shown {
        let row = times_s.partition_point(|time| *time < time_s - 0.5 * step_s);
        assert!((times_s[row] - time_s).abs() < 0.1 * step_s, "{figure} at {time_s} s");
        let off = (values[row] - value).abs();
        assert!(off < 1e-3 * peak(values), "{figure}, {line}, at {time_s} s: {off:e} off");
    }
}

#[test]
fn figures_of_an_arm_show_the_numbers_of_its_tables() {
    let bench = Bench::new();
    solved(&bench, "out", "--moments");
    let told = bench.printed("report out --svg figures");
    let names = "angle-1 angle-2 bending-angles root-moments tip torque-1 torque-2 waves-1 waves-2";
    assert_eq!(bench.names("figures").join(" ").replace(".svg", ""), names);
    assert_eq!(told, "written  9 figures in figures\n");
    let of = |file: &str, name: &str| column(&bench, &format!("out/{file}.csv"), name);
    let times_s = of("torques", "time_s");
    for (figure, line, file, name) in [
        ("torque-1", "flexible arm", "torques", "torque1_n_m"),
        ("torque-2", "rigid arm", "rigid_torques", "rigid_torque2_n_m"),
        ("angle-2", "flexible arm", "joint_angles", "joint2_rad"),
        ("angle-1", "rigid arm", "joint_angles", "rigid_joint1_rad"),
        ("tip", "y", "tip", "y_m"),
        ("root-moments", "link 2", "bending_moments", "m2_0_n_m"),
    ] {
        assert_line(&bench, (figure, line), (&times_s, &of(file, name)));
    }
    let rigid = of("joint_angles", "rigid_joint2_rad");
    let angle = of("joint_angles", "joint2_rad");
    let bent: Vec<f64> = angle.iter().zip(rigid).map(|(own, rigid)| 1e3 * (own - rigid)).collect();
    assert_line(&bench, ("bending-angles", "joint 2"), (&times_s, &bent));
    // What has a limit is drawn with it, of each joint and of each link.
    let limits = "links.fore.limits={hub_rate=2,power=10,bending_moment=5,deflection=0.05}";
    let drive = "links.fore.drive={joint_stiffness=1000.0,rotor_inertia=0.001,gear_ratio=2.0}";
    solved(&bench, "out", &format!("--moments --set {limits} --set {drive}"));
    bench.done("report out --svg figures");
    let rate = of("joint_angles", "joint2_rate_rad_s");
    let torque = of("torques", "torque2_n_m");
    let power: Vec<f64> = torque.iter().zip(&rate).map(|(torque, rate)| torque * rate).collect();
    assert_line(&bench, ("rate-2", "flexible arm"), (&times_s, &rate));
    assert_line(&bench, ("power-2", "flexible arm"), (&times_s, &power));
    let motor = of("motor", "motor2_torque_n_m");
    assert_line(&bench, ("motor-torque-2", "flexible arm"), (&times_s, &motor));
    let deflected = points(&bench.read("figures/tip-deflection-2.svg"), "flexible arm");
    let largest = deflected.iter().fold(0.0_f64, |most, (_, value)| most.max(value.abs()));
    let exact = bench.number("out", "results/joints/1/peak_deflection_m");
    assert!((largest / exact - 1.0).abs() < 0.02, "{largest} of {exact}");
    for (figure, limit, style) in [
        ("rate-2", "limit 2 rad/s", 1),
        ("power-2", "limit 10 W", 1),
        ("tip-deflection-2", "limit 0.05 m", 1),
        ("root-moments", "link 2: limit 5 N m", 2),
    ] {
        let line = format!("class=\"limit s{style}\"");
        let svg = bench.read(&format!("figures/{figure}.svg"));
        assert!(svg.contains(limit) && svg.contains(&line), "{figure}");
    }
    assert!(!bench.path("figures/rate-1.svg").exists(), "it has no limit");
    // Without moments the waves are those of the deflection, and the page says what is missing.
    solved(&bench, "out", "--every 8");
    bench.done("report out");
    let page = bench.read("out/report.html");
    assert!(page.contains("deflection from the chord") && !page.contains("fig-root-moments"));
    assert!(page.contains("w: distance of the link from its chord"));
    assert!(page.contains("bending moments, since they were not written"));
    assert!(!page.contains("EI ∂²w/∂x²"));
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
    solved(&bench, "solved", "");
    played(&bench, "solved", "played");
    bench.done("report played -q");
    let alone = bench.read("played/report.html");
    assert!(alone.contains("fig-torque-1") && !alone.contains("data-name=\"rigid arm\""));
    assert!(alone.contains("since the rigid arm's were not written"), "what is missing");
    bench.done("report solved played -q");
    let page = bench.read("solved/report.html");
    assert!(page.contains("<strong>played</strong> flexlink"), "which is which");
    bench.done("report solved played -q --svg figures");
    let times_s = column(&bench, "solved/torques.csv", "time_s");
    let torque = column(&bench, "solved/torques.csv", "torque1_n_m");
    for line in ["solved", "played"] {
        assert_line(&bench, ("torque-1", line), (&times_s, &torque));
    }
    assert_line(&bench, ("tip-error", "played"), (&times_s, &vec![0.01; times_s.len()]));
    // Folders of one name are told apart by the folders that they lie in.
    fs::create_dir(bench.path("more")).unwrap();
    fs::rename(bench.path("played"), bench.path("more/solved")).unwrap();
    bench.done("report solved more/solved -q -o both.html");
    assert!(bench.read("both.html").contains("<strong>more/solved</strong>"));
    bench.refuses(3, "report solved nowhere", "nowhere");
    bench.done(&format!("solve {LINK} {MOTION} -q -o link"));
    // Beside a link it keeps what both have, and says what it leaves out.
    bench.done("report solved link -q -o both.html");
    let page = bench.read("both.html");
    assert!(page.contains("of link, since it is a turning link and solved an arm"), "why");
    let torque = figure(&page, "torque-1");
    assert!(torque.contains("data-name=\"link\"") && torque.contains("data-name=\"solved\""));
    assert!(!figure(&page, "torque-2").contains("data-name=\"link\""), "it has one joint");
    assert!(!figure(&page, "tip").contains("link"), "its tip has no x and y");
    bench.done("report link solved -q -o both.html");
    assert!(
        bench.read("both.html").contains("of solved, since it is an arm and link a turning link")
    );
}

/// A figure of a page.
fn figure<'a>(page: &'a str, id: &str) -> &'a str {
    let figure = &page[page.find(&format!("id=\"fig-{id}\"")).unwrap()..];
    &figure[..figure.find("</figure>").unwrap()]
}

/// Lead and lag of each joint read as its summary has them, whatever their signs.
#[test]
fn lead_and_lag_of_joints_are_before_or_after_the_motion_in_words() {
    let bench = Bench::new();
    solved(&bench, "out", "--report");
    let page = bench.read("out/report.html");
    let row = |name: &str| {
        let row = &page[page.find(&format!("<th scope=\"row\">{name}</th>")).unwrap()..];
        row[..row.find("</tr>").unwrap()].to_owned()
    };
    for joint in [0, 1] {
        let of = |name: &str| bench.number("out", &format!("results/joints/{joint}/{name}"));
        let (lead_s, lag_s) = (of("lead_s"), of("lag_s"));
        let side = |is_before: bool| if is_before { "before" } else { "after" };
        for (name, seconds, side) in
            [("lead", lead_s, side(lead_s >= 0.0)), ("lag", lag_s, side(lag_s < 0.0))]
        {
            let text = format!(" s {side} the tip ");
            let cells: Vec<String> = row(name).split("<td>").skip(1).map(str::to_owned).collect();
            let (number, _) = cells[joint].split_once(&text).unwrap_or_else(|| panic!("{cells:?}"));
            let number: f64 = number.parse().unwrap();
            assert!((number / seconds.abs() - 1.0).abs() < 1e-3, "{name}: {number} {seconds}");
        }
    }
    assert!(!page.contains("−0.") || !row("lead").contains('−'), "no signs");
}

#[test]
fn what_is_missing_or_damaged_in_an_arms_folder_is_refused_by_its_name() {
    let bench = Bench::new();
    solved(&bench, "out", "");
    for file in ["torques.csv", "joint_angles.csv", "tip.csv", "nodal_positions.csv", "nodes.csv"] {
        let text = bench.read(&format!("out/{file}"));
        fs::remove_file(bench.path("out").join(file)).unwrap();
        bench.refuses(3, "report out", &format!("{file} is missing"));
        bench.write(&format!("out/{file}"), &text);
    }
    for (file, from, to, words) in [
        ("torques.csv", "torque2_n_m", "torque3_n_m", "torque2_n_m"),
        ("nodal_positions.csv", "y2_4_m", "y2_5_m", "y2_4_m"),
        ("nodes.csv", "2,1,", "2,2,", "node = \"2\", but must be 1"),
        ("nodes.csv", "2,4,0.6,fore", "", "from its hub to its tip"),
        ("summary.json", "\"length_m\": 0.7", "\"length_m\": -0.7", "arm.links.0"),
        ("summary.json", "\"window_start_s\": -", "\"window_start_s\": -1", "summary.json"),
    ] {
        let path = format!("out/{file}");
        let text = bench.read(&path);
        assert!(text.contains(from), "{file} has no {from}");
        bench.write(&path, &text.replacen(from, to, 1));
        let told = bench.error(3, "report out");
        assert!(told.contains(words) && told.contains(file), "{told}");
        bench.write(&path, &text);
    }
    let rows = bench.read("out/tip.csv");
    let fewer: Vec<&str> = rows.lines().take(9).collect();
    bench.write("out/tip.csv", &fewer.join("\n"));
    let told = bench.error(3, "report out");
    assert!(told.contains("tip.csv") && told.contains("torques.csv"), "{told}");
}
