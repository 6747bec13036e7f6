//! What a file may hold instead of a table or a link.

use std::fs;

use super::{Bench, REFUSED, link};

/// Arguments of every command that reads `file`.
fn readers(file: &str) -> [Vec<&str>; 5] {
    [
        vec!["solve", file, "motion.csv"],
        vec!["solve", "link.toml", file],
        vec!["simulate", "link.toml", file],
        vec!["report", file],
        vec!["sweep", "--merge", file, "-o", "merged.csv"],
    ]
}

#[track_caller]
fn refused(bench: &Bench, file: &str, messages: [&str; 5]) {
    for (arguments, message) in readers(file).iter().zip(messages) {
        bench.refuses(arguments, REFUSED, &format!("{file}{message}"));
    }
}

#[test]
fn an_empty_file_is_told_what_is_missing() {
    let bench = Bench::new();
    bench.write("empty", "");
    let samples = ": has no rows, but must hold a row of names and 4 samples or more\n";
    refused(
        &bench,
        "empty",
        [
            ": must hold at least one [[segments]]\n",
            samples,
            samples,
            ": has no rows, but must hold a row of names or of numbers\n",
            ":1: first line = \"\", but must be that of a shard",
        ],
    );
}

#[test]
fn a_file_that_is_not_there_is_told_in_the_systems_words() {
    let bench = Bench::new();
    let words = fs::read(bench.path("none")).unwrap_err().to_string();
    let words = format!(": cannot read: {}\n", words.split(" (os").next().unwrap());
    refused(&bench, "none", [words.as_str(); 5]);
}

#[cfg(unix)]
#[test]
fn a_directory_is_no_file() {
    let bench = Bench::new();
    fs::create_dir(bench.path("folder")).unwrap();
    let words = ": cannot read: Is a directory\n";
    let run = ": summary.json is missing";
    refused(&bench, "folder", [words, words, words, run, words]);
}

#[test]
fn utf_16_is_refused_with_and_without_its_mark() {
    const HINT: &str = "\nhint: it seems to be UTF-16: save the file as text in UTF-8\n";
    let bench = Bench::new();
    let table = fs::read_to_string(bench.path("motion.csv")).unwrap();
    for (text, messages) in [
        (link(""), [": cannot read: not UTF-8 from byte 1 on", ":1: key with no value"]),
        (
            table,
            [
                ":1: text = byte 0xff, but must be UTF-8",
                ":1: column 1 = \"t\\0i\\0m\\0e\\0\", but must be one of time",
            ],
        ),
    ] {
        let bytes = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<_>>();
        bench.write("marked", bytes(&format!("\u{feff}{text}")));
        bench.write("bare", bytes(&text));
        let is_link = text.starts_with("segments");
        for (file, message) in ["marked", "bare"].into_iter().zip(messages) {
            let [as_link, as_motion, ..] = readers(file);
            let arguments = if is_link { as_link } else { as_motion };
            bench.refuses(&arguments, REFUSED, &format!("{file}{message}"));
            bench.refuses(&arguments, REFUSED, HINT);
        }
    }
}

#[test]
fn a_compressed_file_or_a_spreadsheet_is_told_to_be_one() {
    let bench = Bench::new();
    let sheet = "it seems to be a spreadsheet or an archive: export the table as CSV";
    for (name, bytes, hint) in [
        ("motion.xlsx", &b"PK\x03\x04\x14\0\x06\0\x08\0\0\0!\0\xdf\xa4"[..], sheet),
        ("stored.zip", b"PK\x03\x04\n\0\0\0\0\0motion.csvtime,acceleration\n", sheet),
        (
            "motion.csv.gz",
            b"\x1f\x8b\x08\0\0",
            "it seems to be compressed by gzip: unpack it first",
        ),
        ("other", b"caf\xe9", "save the file as text in UTF-8"),
    ] {
        bench.write(name, bytes);
        for arguments in &readers(name)[..3] {
            bench.refuses(arguments, REFUSED, &format!("\nhint: {hint}\n"));
        }
    }
}

#[test]
fn quoted_fields_are_read_and_one_that_never_ends_is_told() {
    let bench = Bench::new();
    bench.solves(&[]);
    let plain = fs::read(bench.path("out/torque.csv")).unwrap();
    let rows = fs::read_to_string(bench.path("motion.csv")).unwrap();
    let fields = rows.trim_end().replace(',', "\",\"").replace('\n', "\"\n\"");
    let quoted = format!("\"{fields}\"\n");
    bench.write("motion.csv", &quoted);
    bench.solves(&[]);
    assert!(fs::read(bench.path("out/torque.csv")).unwrap() == plain);
    fs::remove_dir_all(bench.path("out")).unwrap();
    let at = quoted.match_indices('"').nth(40).unwrap().0;
    bench.write("motion.csv", format!("{}{}", &quoted[..at], &quoted[at + 1..]));
    let output = bench.run(&["solve", "link.toml", "motion.csv"]);
    bench.is_refusal(&output, REFUSED, "motion.csv:1");
}

#[test]
fn nul_bytes_are_shown_and_refused() {
    let bench = Bench::new();
    bench.write("zeros", [0; 5000]);
    let shown = "\\0".repeat(60);
    refused(
        &bench,
        "zeros",
        [
            ":1: key with no value",
            &format!(":1: column 1 = \"{shown}…\", but must be one of time"),
            &format!(":1: columns = \"{shown}…\", but must include time"),
            &format!(": columns = \"{shown}…\", but must be those of a sweep"),
            ":1: first line = \"",
        ],
    );
    bench.write("one", "time,acceleration\n0,0\n1,1\0.5\n2,0\n3,0\n");
    bench.refuses(
        &["solve", "link.toml", "one"],
        REFUSED,
        "one:3: acceleration = \"1\\0.5\", but must be a number\n",
    );
}

#[test]
fn a_picture_is_neither_a_table_nor_a_link() {
    let bench = Bench::new();
    bench.write("p.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\xff\xfe");
    bench.refuses(&["solve", "link.toml", "p.png"], REFUSED, "p.png:1: text = byte 0x89");
    bench.refuses(&["solve", "p.png", "motion.csv"], REFUSED, "p.png: cannot read: not UTF-8");
}
