//! The page of a fit to a record.

use super::{Bench, column};

const LINK: &str = "[[segments]]\nlength = 0.42\nEI = 0.15\nmass_per_length = 0.155\n\
                    [hub]\ninertia = 0.0018\n[damping]\nmodel = 'modal'\nratio = 0.012\n";

const MEASURED: &str = "[[record]]\nfile = 'log.csv'\ninput = 'torque'\ndelay = 'free'\n\
                        [[record.channel]]\nsensor = 'hub_angle'\n\
                        [[record.channel]]\nsensor = 'tip_acceleration'\ngain = 'free'\noffset = 'free'\n";

/// What a link of a fifth more stiffness does under a torque: hub angle in rad, 40 times the tip's
/// acceleration and 3.
fn write_log(bench: &Bench) {
    bench.write("link.toml", LINK);
    let torque = |t: f64| 0.02 * (9.0 * t).sin() * (1.0 - (-t).exp());
    let rows: String = (0..400)
        .map(|k| 0.005 * f64::from(k))
        .fold(String::new(), |rows, t| format!("{rows}{t:.3},{:.9}\n", torque(t)));
    bench.write("torque.csv", &format!("time,torque\n{rows}"));
    let stiffer = ["--set", "segments.0.EI=0.18", "-o", "true", "--digits", "12"];
    bench.done(&[&["simulate", "link.toml", "torque.csv"], &stiffer[..]].concat());
    let columns = [
        ("torque.csv", "time_s"),
        ("torque.csv", "torque_n_m"),
        ("hub_angle.csv", "hub_angle_rad"),
        ("tip.csv", "tip_acceleration_m_s2"),
    ];
    let columns = columns.map(|(file, name)| column(bench, &format!("true/{file}"), name));
    let [time, torque, angle, acceleration] = columns;
    let row = |k: usize| {
        format!("{},{},{},{}\n", time[k], torque[k], angle[k], 40.0 * acceleration[k] + 3.0)
    };
    let rows: String = (0..time.len()).map(row).collect();
    bench.write("log.csv", &format!("time,torque,hub_angle,tip_acceleration\n{rows}"));
    bench.write("measured.toml", MEASURED);
}

#[test]
fn a_record_has_a_row_for_each_channel_and_its_histories_over_each_other() {
    let bench = Bench::new();
    write_log(&bench);
    let arguments = ["fit", "link.toml", "measured.toml", "--free", "segments.0.EI"];
    bench.done(&[&arguments[..], &["-o", "fitted.toml", "--report"]].concat());
    let page = bench.read("fitted.html");
    let section = &page[page.find("id=\"measured\"").unwrap()..];
    let section = &section[..section.find("</section>").unwrap()];
    let rows: Vec<Vec<&str>> = section
        .split("<tr>")
        .skip(2)
        .map(|row| row.split("<td>").map(|cell| cell.split('<').next().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 2, "{section}");
    for (row, start) in rows
        .iter()
        .zip([["hub angle", "300", "–", "–"], ["tip acceleration", "300", "40.00", "3.000"]])
    {
        let [_, channel, samples, delay, gain, offset, ..] = row[..] else { panic!("{row:?}") };
        assert_eq!([channel, samples, gain, offset], start);
        assert!(delay.ends_with(" s"), "{delay}");
    }
    for name in ["log.csv: hub angle", "log.csv: tip acceleration"] {
        assert!(page.contains(name), "{name}");
    }
    // The line lies thin on the dots, so that both are seen.
    let figure = &page[page.find("id=\"fig-overlay-1\"").unwrap()..];
    let (dots, line) = (figure.find("class=\"dots"), figure.find("class=\"line s1 thin\""));
    assert!(dots.is_some() && dots < line, "{dots:?}, {line:?}");
}
