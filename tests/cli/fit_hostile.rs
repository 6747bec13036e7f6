//! Measurements that no link has: refused or told in words, never as a number that is none.

use super::{Bench, repository, stderr, stdout};

const FREQUENCIES: &str = "[[frequency]]\nmode = 1\nvalue = '1.8 Hz'\nuncertainty = '0.02 Hz'\n\
                           [[frequency]]\nmode = 2\nvalue = '5.3 Hz'\nuncertainty = '0.05 Hz'\n";

fn fit(bench: &Bench, free: &str) -> (Option<i32>, String) {
    let link = repository("specs/bayo1987_example1.toml");
    let out = bench.run(&["fit", &link, "measured.toml", "--free", free]);
    let told = stdout(&out) + &stderr(&out);
    let words = || told.split(|letter: char| !letter.is_ascii_alphabetic());
    assert!(!words().any(|word| ["nan", "inf"].contains(&word.to_lowercase().as_str())), "{told}");
    (out.status.code(), told)
}

#[test]
fn a_sample_whose_square_is_no_number_is_refused_when_it_is_read() {
    let bench = Bench::new();
    bench.write(
        "measured.toml",
        "[[response]]\nfile = 'frf.csv'\ntransfer = 'hub_angle'\ngain = 'free'\nuncertainty = 0.05\n",
    );
    for (sample, size) in [("-1e308,-0.5", "1.000e308"), ("0,1e-200", "1.000e-200")] {
        let table = format!("frequency_hz,real,imaginary\n1,1,0.1\n2,{sample}\n3,0.2,0.1\n4,1,1\n");
        bench.write("frf.csv", &table);
        let (code, told) = fit(&bench, "segments.*.EI");
        let must = format!(
            "frf.csv: sample 2 = 2.000 Hz, a value of size {size}, but must be a frequency above 0 and a size \
             from 1e-150 to 1e150"
        );
        assert!(code == Some(3) && told.contains(&must), "{code:?}: {told}");
    }
    bench.write(
        "measured.toml",
        "[[record]]\nfile = 'log.csv'\ninput = 'torque'\n[[record.channel]]\nsensor = 'hub_angle'\n",
    );
    let table = (0..40).fold("time,torque,hub_angle\n".to_owned(), |text, k| {
        format!("{text}{},{},{}\n", 0.01 * f64::from(k), k % 3, k)
    });
    let table = table.replace(",7\n", ",1e200\n");
    bench.write("log.csv", &table);
    let (code, told) = fit(&bench, "segments.*.EI");
    assert!(code == Some(3) && told.contains("log.csv: sample 7 of hub_angle"), "{code:?}: {told}");
}

#[test]
fn a_frequency_of_another_order_of_magnitude_is_refused_before_any_start_is_tried() {
    let bench = Bench::new();
    for (value, shown) in [("1e-200 Hz", "1.000e-200"), ("1e12 Hz", "1.000e12")] {
        bench.write(
            "measured.toml",
            &FREQUENCIES.replace("5.3 Hz", value).replace("uncertainty", "#"),
        );
        let (code, told) = fit(&bench, "segments.*.EI");
        let must = format!(
            "frequency 2 = {shown} Hz, but must be within a factor of 1e6 of the file's own, "
        );
        assert!(code == Some(3) && told.contains(&must), "{code:?}: {told}");
    }
}

#[test]
fn bounds_that_no_value_has_are_refused() {
    let bench = Bench::new();
    bench.write("measured.toml", FREQUENCIES);
    for free in ["segments.*.EI=1e-300:1e300", "segments.*.EI=0.5:1e13", "hub.inertia=1e-30:100"] {
        let (code, told) = fit(&bench, free);
        let must = "LOW and HIGH must be within a factor of 1e12 of the file's value";
        assert!(code == Some(2) && told.contains(must), "{code:?}: {told}");
    }
    assert_eq!(fit(&bench, "segments.*.EI=1e-9:1e9").0, Some(0));
}
