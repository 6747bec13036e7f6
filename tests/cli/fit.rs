//! `flexlink fit`: what it writes, and what it never replaces.

use std::process::Output;

use serde_json::Value;

use super::fit_response::response;
use super::{Bench, LINK, ended, number, stderr, stdout, succeeded};

const SLFR: &str = "fit specs/krauss_slfr.toml measurements/krauss_slfr.toml";

/// Fits the stiffness of the paper's link to three times the response of one with a tenth more.
fn fit_response(bench: &Bench, gain: &str, more: &str) -> Output {
    let rows = response(bench, 60).into_iter().map(|[hertz, size, phase]| {
        format!("{hertz},{},{}\n", 3.0 * size * phase.cos(), 3.0 * size * phase.sin())
    });
    bench.write("frf.csv", &format!("frequency,real,imaginary\n{}", rows.collect::<String>()));
    let measured = format!(
        "[[response]]\nfile = 'frf.csv'\ntransfer = 'tip_acceleration'\ngain = '{gain}'\n\
         uncertainty = 0.01\n"
    );
    bench.write("measured.toml", &measured);
    bench.run(&format!("fit {LINK} measured.toml --free segments.*.EI {more}"))
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
    let given = "--set damping.ratio=0.02 --free segments.*.EI --free masses.0.mass";
    bench.done(&format!("{SLFR} {given} -o slfr.toml"));
    let record = bench.json("slfr.json");
    let arguments: Vec<&str> = given.split(' ').collect();
    assert_eq!(record["inputs"]["arguments"], serde_json::json!(arguments));
    assert_eq!(record["inputs"]["link"]["sha256"].as_str().unwrap().len(), 64);
    let mass = &record["values"][1];
    assert_eq!((&mass["before"], &mass["unit"]), (&Value::from(7.7), &Value::from("g")));
    let factor = number(mass, "factor");
    assert!((number(mass, "after") / 7.7 / factor - 1.0).abs() < 1e-12, "{mass}");
    // One degree of freedom.
    let error = number(mass, "relative_standard_error");
    let high = number(mass, "relative_interval_95/1");
    assert!((high.ln() / error - 12.7062).abs() < 1e-4, "{mass}");
    let starts = record["starts"].as_array().unwrap();
    assert_eq!(starts.len(), 16);
    for start in starts {
        assert!((number(start, "to/1") / factor - 1.0).abs() < 1e-3, "{start}");
        assert!(start["iterations"].as_u64().unwrap() > 0, "{start}");
    }
    assert!(record["iterations"].as_u64().unwrap() > 0);
}

#[test]
fn the_page_has_measured_and_fitted_over_each_other() {
    let bench = Bench::new();
    let told = stdout(&succeeded(fit_response(&bench, "free", "-o fitted.toml --report")));
    assert!(told.ends_with("written  fitted.html\n"), "{told}");
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
        assert!(super::apart(&measured, &fitted) < 0.5, "{figure}: {measured:?}, {fitted:?}");
    }
}

#[test]
fn a_misfit_has_its_page_and_no_link_file() {
    let bench = Bench::new();
    // Three times the response, taken for SI.
    let out = ended(4, fit_response(&bench, "known", "--report page.html -o fitted.toml"));
    assert!(!bench.path("fitted.toml").exists());
    let page = bench.read("page.html");
    let top = page.find("No link file is written").unwrap();
    assert!(top < page.find("id=\"values\"").unwrap());
    let [measured, fitted] =
        ["measured", "fitted"].map(|line| heights(&page, "overlay-1", line)[0]);
    assert!((measured - fitted).abs() > 5.0, "{measured} {fitted}");
    for hint in ["hint: check each unit", "error: no link file is written: the best values"] {
        assert!(stderr(&out).contains(hint), "{}", stderr(&out));
    }
}

#[test]
fn a_value_at_its_bound_is_named_with_what_to_widen() {
    let bench = Bench::new();
    let told =
        bench.error(4, &super::with(SLFR, &["--free", "masses.0.mass='7 g':'8 g'", "--report"]));
    let bound = "masses.0.mass lies on its bound, 1.039 times the file's value";
    assert!(told.contains(bound), "{told}");
    assert!(told.contains("hint: widen its bounds, --free masses.0.mass=LOW:HIGH"), "{told}");
    assert!(bench.read("fit.html").contains("at its bound"));
    // A factor of 1e9 either way is within what bounds may be.
    let measured = super::repository("tests/refusals/runs.in/frequencies.toml");
    bench.done(&["fit", LINK, &measured, "--free", "segments.*.EI=1e-9:1e9"]);
}
