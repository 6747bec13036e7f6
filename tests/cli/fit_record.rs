//! `flexlink fit` with a `[[record]]`, as a logger would have written it.

use super::{Bench, column, number, stderr, stdout};

const LINK: &str = "[[segments]]\nlength = 0.42\nEI = 0.15\nmass_per_length = 0.155\n\
                    [hub]\ninertia = 0.0018\n[payload]\nmass = 0.05\n\
                    [damping]\nmodel = 'modal'\nratio = 0.012\n";

const RECORD: &str = "[[record]]\nfile = 'log.csv'\ninput = 'torque'\ndelay = 'free'\n\
                      columns = ['time=Zeit', 'torque=M', 'hub_angle=Winkel', 'tip_acceleration=4']\n\
                      [[record.channel]]\nsensor = 'hub_angle'\n\
                      [[record.channel]]\nsensor = 'tip_acceleration'\ngain = 'free'\noffset = 'free'\n";

/// A link of true stiffness 0.18 and hub inertia 0.0021 under a torque of two frequencies, logged with semicolons,
/// decimal commas, milliseconds and degrees; the sensors are late by two samples and the accelerometer shows
/// −0.1 V per m/s² about 2.5 V.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("link.toml", LINK);
    let torque = |t: f64| 0.02 * ((3.0 * t).sin() + (11.0 * t).sin()) * (1.0 - (-t).exp());
    bench.sampled("torque.csv", "time,torque", 0..1500, |k| [0.002 * k, torque(0.002 * k)]);
    let truth = "--set segments.0.EI=0.18 --set hub.inertia=0.0021";
    bench.done(&format!("simulate link.toml torque.csv -o true --digits 12 {truth}"));
    let angle = column(&bench, "true/hub_angle.csv", "hub_angle_rad");
    let acceleration = column(&bench, "true/tip.csv", "tip_acceleration_m_s2");
    let late = |of: &[f64], k: usize| if k < 2 { 0.0 } else { of[k - 2] };
    let row = |k: usize| {
        // Noise of a thousandth, the same at every run.
        let noise = ((k * 7919 % 1000) as f64 / 1000.0 - 0.5) * 2e-3;
        let t = 0.002 * k as f64;
        let numbers = [
            format!("{:.1}", 1000.0 * t),
            format!("{:.9}", torque(t)),
            format!("{:.7}", late(&angle, k).to_degrees() * (1.0 + noise)),
            format!("{:.7}", 2.5 - 0.1 * late(&acceleration, k) * (1.0 - noise)),
        ];
        numbers.join(";").replace('.', ",") + "\n"
    };
    let rows: String = (0..1500).map(row).collect();
    bench.write("log.csv", &format!("Zeit (ms);M [N m];Winkel [deg];a [V]\n{rows}"));
    bench.write("measured.toml", RECORD);
    bench
}

#[test]
fn a_log_gives_the_link_the_gain_and_the_delay_and_its_page() {
    let bench = bench();
    let free = "--free segments.0.EI --free hub.inertia";
    let out = bench.done(&format!("fit link.toml measured.toml -o fitted.toml --report {free}"));
    let record = bench.json("fitted.json");
    for (path, exact, tolerance) in [
        ("values/0/after", 0.18, 1e-3),
        ("values/1/after", 0.0021, 1e-3),
        ("records/0/delay_s", 0.004, 1e-2),
        ("records/0/channels/1/gain", -0.1, 1e-3),
        ("records/0/channels/1/offset", 2.5, 1e-4),
    ] {
        let found = number(&record, path);
        assert!((found / exact - 1.0).abs() < tolerance, "{path}: {found}");
    }
    assert_eq!(record["inputs"]["named"][0]["name"], "log.csv");
    assert!(stderr(&out).contains("read ; as delimiter, decimal comma"), "{}", stderr(&out));
    assert!(stdout(&out).contains("record log.csv"), "{}", stdout(&out));

    // A row for each channel, and the histories over each other.
    let page = bench.read("fitted.html");
    let section = &page[page.find("id=\"measured\"").unwrap()..];
    let section = &section[..section.find("</section>").unwrap()];
    let rows = section.split("<tr>").skip(2);
    let rows: Vec<Vec<&str>> = rows
        .map(|row| row.split("<td>").map(|cell| cell.split('<').next().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 2, "{section}");
    for (row, start) in
        rows.iter().zip([["hub angle", "–", "–"], ["tip acceleration", "−0.1000", "2.500"]])
    {
        let [_, channel, samples, delay, gain, offset, ..] = row[..] else { panic!("{row:?}") };
        assert_eq!([channel, gain, offset], start);
        assert!(delay.ends_with(" s") && samples == "1400", "{delay} {samples}");
    }
    for name in ["log.csv: hub angle", "log.csv: tip acceleration"] {
        assert!(page.contains(name), "{name}");
    }
    // The line lies thin on the dots, so that both are seen.
    let figure = &page[page.find("id=\"fig-overlay-1\"").unwrap()..];
    let (dots, line) = (figure.find("class=\"dots"), figure.find("class=\"line s1 thin\""));
    assert!(dots.is_some() && dots < line, "{dots:?}, {line:?}");
}

#[test]
fn a_model_that_lacks_something_is_told_by_its_differences() {
    // The payload of the file is not the true one.
    let wrong = "fit link.toml measured.toml --set payload.mass=0.045 --free segments.0.EI";
    let told = stderr(&bench().run(wrong));
    let words = "log.csv: the differences of hub_angle are not noise, each resembles the one before: the \
                standard errors are about";
    assert!(told.contains(words), "{told}");
}

#[test]
fn what_a_record_is_not_is_refused_with_its_file() {
    let bench = bench();
    for (from, to, expected) in [
        ("log.csv", "lag.csv", "lag.csv: cannot read: "),
        ("torque=M'", "torque=N'", "log.csv:1: columns = torque=\"N\", but must be one of"),
        ("gain = 'free'\n", "", "unit of a = \"V\", but must be a unit such as m/s^2"),
        (
            "sensor = 'hub_angle'\n",
            "sensor = 'hub_angle'\nuncertainty = 0.1\n",
            "log.csv: uncertainty of tip_acceleration is missing",
        ),
    ] {
        bench.write("measured.toml", &RECORD.replace(from, to));
        bench.refuses(3, "fit link.toml measured.toml --free segments.0.EI", expected);
    }
    // Names in a comment are names.
    bench.write("log.csv", "#Zeit\tM\tWinkel\ta\n0.000\t0\t0.0\t0\n0.002\t1\t0.1\t1\n");
    bench.write("measured.toml", RECORD);
    let told = bench.error(3, "fit link.toml measured.toml --free hub.inertia");
    assert!(told.contains("log.csv: samples = 2, but must be 4 or more"), "{told}");
}
