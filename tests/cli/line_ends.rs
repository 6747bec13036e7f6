//! Files as editors on other systems save them.

use super::{Bench, LINK, MOTION, repository};

/// A file of this repository with other line ends, and a byte order mark where `mark` is one.
fn saved(bench: &Bench, name: &str, from: &str, mark: &str, line_end: &str) {
    let text = std::fs::read_to_string(repository(from)).unwrap();
    assert!(!text.contains('\r'));
    bench.write(name, &format!("{mark}{}", text.replace('\n', line_end)));
}

#[test]
fn windows_line_ends_and_a_byte_order_mark_change_nothing() {
    let bench = Bench::new();
    bench.solve("-q");
    for (mark, line_end) in [("", "\r\n"), ("\u{feff}", "\r\n"), ("\u{feff}", "\n")] {
        saved(&bench, "link.toml", LINK, mark, line_end);
        saved(&bench, "motion.csv", MOTION, mark, line_end);
        bench.done("solve link.toml motion.csv -o new -q");
        assert!(bench.read("new/torque.csv") == bench.read("out/torque.csv"));
        let torque = bench.read("out/torque.csv").replace('\n', line_end);
        bench.write("torque.csv", &format!("{mark}{torque}"));
        bench.done("simulate link.toml torque.csv -o played -q");
    }
}

#[test]
fn lines_are_counted_as_an_editor_does() {
    let bench = Bench::new();
    bench.write("link.toml", "\u{feff}# a\r\n\r\n[hub]\r\nradius = 0\r\nradios = 1\r\n");
    bench.refuses_first(3, &format!("solve link.toml {MOTION}"), "error: link.toml:5: ");
    bench.write("motion.csv", "\u{feff}# a\r\n\r\ntime,acceleration\r\n0,0\r\n1,x\r\n");
    bench.refuses_first(3, &format!("solve {LINK} motion.csv"), "error: motion.csv:5: ");
}

#[test]
fn carriage_returns_alone_are_read_or_refused_in_words() {
    let bench = Bench::new();
    bench.solve("-q");
    saved(&bench, "link.toml", LINK, "", "\r");
    let message = "error: link.toml:1: carriage return must be followed by newline";
    bench.refuses_first(3, &format!("solve link.toml {MOTION}"), message);
    saved(&bench, "motion.csv", MOTION, "", "\r");
    assert_eq!(
        bench.error(3, &format!("solve {LINK} motion.csv")),
        "error: motion.csv:1: line end = CR, but must be LF or CR LF where there are comments\n\
         hint: save the file with the line ends of Unix or Windows\n"
    );
    let lines = include_str!("../../trajectories/sine_0.88s.csv").lines();
    let bare: Vec<&str> = lines.filter(|line| !line.starts_with('#')).collect();
    bench.write("motion.csv", &bare.join("\r"));
    bench.done(&format!("solve {LINK} motion.csv -o new -q"));
    assert!(bench.read("new/torque.csv") == bench.read("out/torque.csv"));
}
