//! Tables as instruments and spreadsheets write them: one motion, read with at most one option.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::Path;

use flexlink::csv::{MotionTable, read_motion_table, read_motion_table_as};
use flexlink::motion::TipMotion;

use crate::refused_tables::format_of;

/// A file of an instrument as options read it.
fn read(file: &str, options: &str) -> MotionTable {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/instruments");
    let bytes = fs::read(folder.join(file)).unwrap();
    read_motion_table_as(file, &bytes, &[1.5], &format_of(options)).unwrap()
}

fn tip(table: &MotionTable) -> TipMotion {
    table.clone().into_motion().unwrap().into_tip().unwrap()
}

/// Files: the option that each takes, the rounding of its numbers in m, what the reader tells, and the columns that are
/// not read.
const INSTRUMENTS: [(&str, &str, f64, &str, &str); 12] = [
    ("matlab_writematrix.csv", "--columns time=1,displacement=3", 1e-9, "", ""),
    (
        "matlab_writetable.csv",
        "",
        1e-9,
        "time from column 1 \"t\", displacement from column 3 \"x\" in m",
        "2 \"u\"",
    ),
    (
        "excel_en.csv",
        "",
        1e-7,
        "time from column 1, displacement from column 2 \"Position\" in mm",
        "3 \"Remark\"",
    ),
    (
        "excel_de.csv",
        "",
        1e-7,
        "; as delimiter, decimal comma, time from column 1 \"Zeit\", displacement from column 2 \"Weg\" in mm",
        "3 \"Kraft (N)\"",
    ),
    (
        "excel_fr.csv",
        "",
        1e-7,
        "; as delimiter, decimal comma, time from column 1 \"Temps\", displacement from column 2 \"Déplacement\" in cm",
        "",
    ),
    (
        "labview.txt",
        "--skip 5",
        1e-6,
        "tab as delimiter, time from column 1, displacement from column 2 \"Position\" in m",
        "3 \"Comment\"",
    ),
    (
        "labview_de.txt",
        "",
        1e-6,
        "tab as delimiter, decimal comma, time from column 1 \"Zeit\" in ms, displacement from column 2 \"Position\" in mm",
        "",
    ),
    (
        "logger.txt",
        "",
        1e-7,
        "blanks as delimiter, time from column 1 in ms, displacement from column 2 \"Position\" in mm",
        "3 \"Temperature (degC)\"",
    ),
    (
        "numpy_savetxt.txt",
        "--columns time=1,displacement=2",
        1e-9,
        "names from line 1 in a comment, blanks as delimiter, time from column 1 \"t\", displacement from column 2 \"x\" in \
         m",
        "",
    ),
    (
        "numpy_savetxt.csv",
        "--columns time=1,displacement=3",
        1e-9,
        "names from line 1 in a comment, time from column 1, displacement from column 3 in m",
        "",
    ),
    (
        "encoder.csv",
        "--scale displacement=1e-5",
        1e-5,
        "time from column 1 in ms, displacement from column 2 in m",
        "",
    ),
    ("oscilloscope.csv", "--columns displacement=CH1", 1e-7, "", ""),
];

#[test]
fn twelve_instruments_and_spreadsheets_give_the_same_motion() {
    let reference = read("reference.csv", "");
    assert_eq!((reference.reading().note(), reference.reading().remark()), (None, None));
    for (file, options, rounding_m, note, unread) in INSTRUMENTS {
        let table = read(file, options);
        let [found, expected] = [&table, &reference].map(|table| table.columns().unwrap().clone());
        assert_eq!(found.time_s.len(), expected.time_s.len(), "{file}");
        let times = found.time_s.iter().zip(&expected.time_s);
        assert!(times.into_iter().all(|(a, b)| (a - b).abs() < 1e-12), "{file}");
        let pairs = found.displacement_m.unwrap().into_iter().zip(expected.displacement_m.unwrap());
        // Half a digit of the file, and of the reference.
        let allowed = 0.5 * rounding_m + 0.51e-7;
        for (found, expected) in pairs {
            assert!((found - expected).abs() <= allowed, "{file}: {found}, not {expected}");
        }
        let told = |begin: &str, rest: &str| (!rest.is_empty()).then(|| format!("{begin} {rest}"));
        assert_eq!(table.reading().note(), told("read", note), "{file}");
        let remark = table.reading().remark().map(|(unread, _)| unread.to_owned());
        assert_eq!(remark, told("columns not read:", unread), "{file}");
        assert!((tip(&table).travel_m() - 0.5).abs() < 2e-5, "{file}");
    }
}

#[test]
fn a_velocity_alone_gives_its_integral() {
    let reference_m = tip(&read("reference.csv", "")).travel_m();
    let table = read("pandas_velocity.csv", "");
    let note = "read time from column 2, velocity from column 3 in mm/s, displacement as the velocity's \
                integral";
    assert_eq!(table.reading().note().as_deref(), Some(note));
    let unread = "columns not read: 1 \"\", 4 \"state\"";
    let hint = "--columns QUANTITY=NUMBER reads one of them instead";
    assert_eq!(table.reading().remark(), Some((unread, hint)));
    for table in [table.clone(), table.clone().resampled(0.01).unwrap()] {
        let travel_m = tip(&table).travel_m();
        assert!((travel_m - reference_m).abs() < 1e-5, "{travel_m}");
    }
    let target = table.into_target().unwrap_err();
    assert!(target.to_string().contains("a target needs displacement"), "{target}");
}

#[test]
fn the_integral_of_a_velocity_has_the_fourth_order() {
    let error = |n: u32| {
        let time = |k: u32| f64::from(k) / f64::from(n);
        let row = |k| format!("{:e},{:e}\n", time(k), (PI * time(k)).sin().powi(2));
        let text = format!("time,velocity\n{}", (0..=n).map(row).collect::<String>());
        let table = read_motion_table("v.csv", text.as_bytes(), 1.0).unwrap();
        let table = table.resampled(1.0 / f64::from(4 * n)).unwrap();
        let columns = table.columns().unwrap();
        let exact = |t: f64| 0.5 * t - (TAU * t).sin() / (4.0 * PI);
        let pairs = columns.time_s.iter().zip(columns.displacement_m.as_ref().unwrap());
        pairs.map(|(t, x)| (exact(*t) - x).abs()).fold(0.0, f64::max)
    };
    let order = (error(40) / error(80)).log2();
    assert!((3.7..5.2).contains(&order), "order {order}");
}

#[test]
fn columns_are_chosen_by_heading_with_and_without_unit_in_any_case() {
    for choices in [
        "displacement=pos,time=Time",
        "displacement=POS,time=TIME (s)",
        "displacement=pos [mm],time=time (S)",
        "displacement=2,time=1",
    ] {
        let text = b"Time (s),pos [mm],acceleration\n0,1,9\n1,2,9\n2,3,9\n3,4,9\n";
        let format = format_of(&format!("--columns {choices}"));
        let table = read_motion_table_as("m.csv", text, &[1.0], &format).unwrap();
        let found = table.columns().unwrap().clone();
        assert_eq!(found.displacement_m, Some(vec![0.001, 0.002, 0.003, 0.004]), "{choices:?}");
        assert_eq!((found.acceleration_m_s2, table.reading().note()), (None, None));
    }
}

#[test]
fn quoted_numbers_have_decimal_commas_by_option() {
    let text = b"time,displacement\n0,\"0,5\"\n1,\"1,5\"\n2,\"2\"\n3,\"2,25\"\n";
    let table = read_motion_table_as("m.csv", text, &[1.0], &format_of("--decimal comma")).unwrap();
    let found = table.columns().unwrap();
    assert_eq!(found.displacement_m, Some(vec![0.5, 1.5, 2.0, 2.25]));
}

#[test]
fn units_are_those_of_the_options() {
    let format = format_of("--columns time=1,angle=2 --time-unit ms --unit deg");
    let text = b"0 0\n5 1\n10 2\n15 3\n";
    let table = read_motion_table_as("m.csv", text, &[2.0], &format).unwrap();
    let found = table.columns().unwrap();
    assert_eq!(found.time_s, [0.0, 0.005, 0.01, 0.015]);
    let last_m = found.displacement_m.as_ref().unwrap()[3];
    assert!((last_m - 6.0f64.to_radians()).abs() < 1e-15, "{last_m}");
}
