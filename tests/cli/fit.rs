//! `flexlink fit`: what it writes, and what it never replaces.

use serde_json::Value;

use super::{Bench, ended, repository, stderr, stdout, succeeded};

const FREE: [&str; 4] = ["--free", "segments.*.EI", "--free", "masses.0.mass"];

/// Fits the SLFR rig; `more` arguments follow.
fn fitted(bench: &Bench, more: &[&str]) -> std::process::Output {
    let files = [repository("specs/krauss_slfr.toml"), repository("measurements/krauss_slfr.toml")];
    bench.run(&[&["fit", &files[0], &files[1]], &FREE[..], more].concat())
}

/// A response of the paper's link with a tenth more stiffness, and the file that names it.
fn write_response(bench: &Bench, gain: &str) {
    let link = repository("specs/bayo1987_example1.toml");
    let arguments = ["frf", &link, "--set", "segments.*.EI*=1.1", "--points", "60", "--json"];
    let found: Value = serde_json::from_slice(&bench.run(&arguments).stdout).unwrap();
    let column = |name: &str| -> Vec<f64> {
        found[name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let hertz = column("frequency_hz");
    let size = column("torque_per_tip_acceleration_kg_m_magnitude");
    let phase = column("torque_per_tip_acceleration_kg_m_phase_rad");
    let row = |k: usize| {
        let (size, phase) = (3.0 / size[k], -phase[k]);
        format!("{},{},{}\n", hertz[k], size * phase.cos(), size * phase.sin())
    };
    let rows: String = (0..hertz.len()).map(row).collect();
    bench.write("frf.csv", &format!("frequency,real,imaginary\n{rows}"));
    bench.write(
        "measured.toml",
        &format!(
            "[[response]]\nfile = 'frf.csv'\ntransfer = 'tip_acceleration'\ngain = '{gain}'\n\
             uncertainty = 0.01\n"
        ),
    );
}

fn fit_response(bench: &Bench, more: &[&str]) -> std::process::Output {
    let link = repository("specs/bayo1987_example1.toml");
    bench.run(&[&["fit", &link, "measured.toml", "--free", "segments.*.EI"], more].concat())
}

/// Heights of a named line of a figure of the page.
fn heights(page: &str, figure: &str, line: &str) -> Vec<f64> {
    let figure = &page[page.find(&format!("id=\"fig-{figure}\"")).unwrap()..];
    let path = &figure[figure.find(&format!("data-name=\"{line}\"")).unwrap()..];
    let places = path.split(" d=\"").nth(1).unwrap().split('"').next().unwrap();
    let places = places.split(['M', 'L']).filter(|place| !place.is_empty());
    places.map(|place| place.split_once(',').unwrap().1.parse().unwrap()).collect()
}

#[test]
fn the_record_has_what_a_fit_was_given_and_where_it_went() {
    let bench = Bench::new();
    succeeded(fitted(&bench, &["--set", "damping.ratio=0.02", "-o", "slfr.toml"]));
    let record = bench.json("slfr.json");
    let arguments: Vec<&str> = record["inputs"]["arguments"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_str)
        .collect();
    assert_eq!(arguments, [&["--set", "damping.ratio=0.02"], &FREE[..]].concat());
    assert_eq!(record["inputs"]["link"]["sha256"].as_str().unwrap().len(), 64);
    let mass = &record["values"][1];
    assert_eq!((&mass["before"], &mass["unit"]), (&Value::from(7.7), &Value::from("g")));
    let (factor, after) = (mass["factor"].as_f64().unwrap(), mass["after"].as_f64().unwrap());
    assert!((after / 7.7 / factor - 1.0).abs() < 1e-12, "{mass}");
    // One degree of freedom.
    let error = mass["relative_standard_error"].as_f64().unwrap();
    let high = mass["relative_interval_95"][1].as_f64().unwrap();
    assert!((high.ln() / error - 12.7062).abs() < 1e-4, "{mass}");
    let starts = record["starts"].as_array().unwrap();
    assert_eq!(starts.len(), 16);
    for start in starts {
        assert!((start["to"][1].as_f64().unwrap() / factor - 1.0).abs() < 1e-3, "{start}");
        assert!(start["iterations"].as_u64().unwrap() > 0, "{start}");
    }
    assert!(record["iterations"].as_u64().unwrap() > 0);
}

#[test]
fn the_page_has_measured_and_fitted_over_each_other() {
    let bench = Bench::new();
    write_response(&bench, "free");
    let out = succeeded(fit_response(&bench, &["-o", "fitted.toml", "--report"]));
    assert!(stdout(&out).ends_with("written  fitted.html\n"), "{}", stdout(&out));
    let page = bench.read("fitted.html");
    for text in
        ["frf.csv: tip acceleration per torque, gain", "fitted.toml is the link file", "SHA-256"]
    {
        assert!(page.contains(text), "{text}");
    }
    // The response is exact, its uncertainty is not.
    assert!(page.contains("is far too small: the uncertainties"));
    for figure in ["overlay-1", "overlay-2"] {
        let [measured, fitted] = ["measured", "fitted"].map(|line| heights(&page, figure, line));
        assert_eq!(measured.len(), 60);
        for (measured, fitted) in measured.iter().zip(&fitted) {
            assert!((measured - fitted).abs() < 0.5, "{figure}: {measured}, {fitted}");
        }
    }
}

#[test]
fn a_misfit_has_its_page_and_no_link_file() {
    let bench = Bench::new();
    // Three times the response, taken for SI.
    write_response(&bench, "known");
    let out = ended(4, fit_response(&bench, &["--report", "page.html", "-o", "fitted.toml"]));
    assert!(!bench.path("fitted.toml").exists());
    let page = bench.read("page.html");
    let top = page.find("No link file is written").unwrap();
    assert!(top < page.find("id=\"values\"").unwrap());
    let apart =
        heights(&page, "overlay-1", "measured")[0] - heights(&page, "overlay-1", "fitted")[0];
    assert!(apart.abs() > 5.0, "{apart}");
    for hint in ["hint: check each unit", "error: no link file is written: the best values"] {
        assert!(stderr(&out).contains(hint), "{}", stderr(&out));
    }
}

#[test]
fn a_value_at_its_bound_is_named_with_what_to_widen() {
    let bench = Bench::new();
    let files = [repository("specs/krauss_slfr.toml"), repository("measurements/krauss_slfr.toml")];
    let free = ["--free", "masses.0.mass='7 g':'8 g'", "--report"];
    let told = stderr(&bench.ends(4, &[&["fit", &files[0], &files[1]], &free[..]].concat()));
    assert!(
        told.contains("masses.0.mass lies on its bound, 1.039 times the file's value"),
        "{told}"
    );
    assert!(told.contains("hint: widen its bounds, --free masses.0.mass=LOW:HIGH"), "{told}");
    assert!(bench.read("fit.html").contains("at its bound"));
    // A factor of 1e9 either way is within what bounds may be.
    let link = repository("specs/bayo1987_example1.toml");
    let measured = repository("tests/refusals/runs.in/frequencies.toml");
    bench.done(&["fit", &link, &measured, "--free", "segments.*.EI=1e-9:1e9"]);
}
