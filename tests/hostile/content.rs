//! What a file may hold instead of a table or a link.

use std::fs;

use super::{Bench, REFUSED, SOLVE, link};

/// Arguments of every command that reads `file`.
fn readers(file: &str) -> [String; 5] {
    [
        format!("solve {file} motion.csv"),
        format!("solve link.toml {file}"),
        format!("simulate link.toml {file}"),
        format!("report {file}"),
        format!("sweep --merge {file} -o merged.csv"),
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
    let names = ": has no rows, but must hold a row of names or of numbers\n";
    let segments = ": must hold at least one [[segments]]\n";
    let shard = ":1: first line = \"\", but must be that of a shard";
    refused(&bench, "empty", [segments, samples, samples, names, shard]);
}

#[test]
fn a_file_that_is_not_there_and_a_folder_are_told_in_the_systems_words() {
    let bench = Bench::new();
    let words = fs::read(bench.path("none")).unwrap_err().to_string();
    let words = format!(": cannot read: {}\n", words.split(" (os").next().unwrap());
    refused(&bench, "none", [words.as_str(); 5]);
    if cfg!(unix) {
        fs::create_dir(bench.path("folder")).unwrap();
        let words = ": cannot read: Is a directory\n";
        refused(&bench, "folder", [words, words, words, ": summary.json is missing", words]);
    }
}

#[test]
fn utf_16_is_refused_unless_it_is_a_table_with_its_mark() {
    const HINT: &str = "\nhint: it seems to be UTF-16: save the file as text in UTF-8\n";
    let bench = Bench::new();
    let name = ":1: column 1 = \"t\\0i\\0m\\0e\\0\", but must be one of time";
    for (text, reader, messages) in [
        (link(""), 0, [": cannot read: not UTF-8 from byte 1 on", ":1: key with no value"]),
        (bench.read("motion.csv"), 1, ["", name]),
    ] {
        for (file, mark, message) in
            [("marked", "\u{feff}", messages[0]), ("bare", "", messages[1])]
        {
            let text = format!("{mark}{text}");
            let bytes: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
            bench.write(file, bytes);
            let arguments = &readers(file)[reader];
            if message.is_empty() {
                assert!(bench.told(arguments).contains("read UTF-16 as encoding"));
                std::fs::remove_dir_all(bench.path("out")).unwrap();
                continue;
            }
            bench.refuses(arguments, REFUSED, &format!("{file}{message}"));
            bench.refuses(arguments, REFUSED, HINT);
        }
    }
}

#[test]
fn a_compressed_file_or_a_spreadsheet_is_told_to_be_one() {
    let bench = Bench::new();
    let sheet = "it seems to be a spreadsheet or an archive: export the table as CSV";
    let gzip = "it seems to be compressed by gzip: unpack it first";
    for (name, bytes, hint) in [
        ("motion.xlsx", &b"PK\x03\x04\x14\0\x06\0\x08\0\0\0!\0\xdf\xa4"[..], sheet),
        ("stored.zip", b"PK\x03\x04\n\0\0\0\0\0motion.csvtime,acceleration\n", sheet),
        ("motion.csv.gz", b"\x1f\x8b\x08\0\0", gzip),
        ("other", b"caf\x81", "save the file as text in UTF-8"),
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
    bench.solves("");
    let plain = bench.read("out/torque.csv");
    let rows = bench.read("motion.csv");
    let fields = rows.trim_end().replace(',', "\",\"").replace('\n', "\"\n\"");
    let quoted = format!("\"{fields}\"\n");
    bench.write("motion.csv", &quoted);
    bench.solves("");
    assert!(bench.read("out/torque.csv") == plain);
    fs::remove_dir_all(bench.path("out")).unwrap();
    let at = quoted.match_indices('"').nth(40).unwrap().0;
    bench.write("motion.csv", format!("{}{}", &quoted[..at], &quoted[at + 1..]));
    bench.refuses(SOLVE, REFUSED, "motion.csv:1");
}

#[test]
fn nul_bytes_are_shown_and_refused() {
    let bench = Bench::new();
    bench.write("zeros", [0; 5000]);
    let shown = "\\0".repeat(60);
    let columns = |must: &str| format!("columns = \"{shown}…\", but must {must}");
    let messages = [
        ":1: key with no value",
        &format!(":1: column 1 = \"{shown}…\", but must be one of time"),
        &format!(":1: {}", columns("include time")),
        &format!(": {}", columns("be those of a sweep")),
        ":1: first line = \"",
    ];
    refused(&bench, "zeros", messages);
    bench.write("one", "time,acceleration\n0,0\n1,1\0.5\n2,0\n3,0\n");
    let message = "one:3: acceleration = \"1\\0.5\", but must be a number\n";
    bench.refuses("solve link.toml one", REFUSED, message);
}

#[test]
fn a_picture_is_neither_a_table_nor_a_link() {
    let bench = Bench::new();
    bench.write("p.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\xff\xfe");
    bench.refuses("solve link.toml p.png", REFUSED, "p.png:1: text = byte 0x89");
    bench.refuses("solve p.png motion.csv", REFUSED, "p.png: cannot read: not UTF-8");
}
