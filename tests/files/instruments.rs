//! Tables as instruments and spreadsheets write them: one motion, read with at most one option.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fs;
use std::path::{Path, PathBuf};

use flexlink::csv::{MotionTable, TableFormat, read_motion_table, read_motion_table_as};

/// One file: the option that it takes, the rounding of its numbers in m, and what the reader tells.
struct Instrument {
    file: &'static str,
    format: TableFormat,
    rounding_m: f64,
    note: Option<&'static str>,
    unread: Option<&'static str>,
}

fn format(set: impl FnOnce(&mut TableFormat)) -> TableFormat {
    let mut format = TableFormat::default();
    set(&mut format);
    format
}

fn columns(choices: &[&str]) -> TableFormat {
    format(|format| format.columns = choices.iter().map(|text| text.parse().unwrap()).collect())
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/instruments")
}

fn read(file: &str, format: &TableFormat) -> MotionTable {
    let bytes = fs::read(folder().join(file)).unwrap();
    read_motion_table_as(file, &bytes, &[1.5], format).unwrap()
}

fn instruments() -> Vec<Instrument> {
    let plain = TableFormat::default;
    let one = |file, format, rounding_m, note, unread| Instrument {
        file,
        format,
        rounding_m,
        note,
        unread,
    };
    vec![
        one("matlab_writematrix.csv", columns(&["time=1", "displacement=3"]), 1e-9, None, None),
        one(
            "matlab_writetable.csv",
            plain(),
            1e-9,
            Some("read time from column 1 \"t\", displacement from column 3 \"x\" in m"),
            Some("columns not read: 2 \"u\""),
        ),
        one(
            "excel_en.csv",
            plain(),
            1e-7,
            Some("read time from column 1, displacement from column 2 \"Position\" in mm"),
            Some("columns not read: 3 \"Remark\""),
        ),
        one(
            "excel_de.csv",
            plain(),
            1e-7,
            Some(
                "read ; as delimiter, decimal comma, time from column 1 \"Zeit\", displacement from \
                 column 2 \"Weg\" in mm",
            ),
            Some("columns not read: 3 \"Kraft (N)\""),
        ),
        one(
            "excel_fr.csv",
            plain(),
            1e-7,
            Some(
                "read ; as delimiter, decimal comma, time from column 1 \"Temps\", displacement from \
                 column 2 \"Déplacement\" in cm",
            ),
            None,
        ),
        one(
            "labview.txt",
            format(|format| format.skip = 5),
            1e-6,
            Some(
                "read tab as delimiter, time from column 1, displacement from column 2 \"Position\" \
                 in m",
            ),
            Some("columns not read: 3 \"Comment\""),
        ),
        one(
            "labview_de.txt",
            plain(),
            1e-6,
            Some(
                "read tab as delimiter, decimal comma, time from column 1 \"Zeit\" in ms, \
                 displacement from column 2 \"Position\" in mm",
            ),
            None,
        ),
        one(
            "logger.txt",
            plain(),
            1e-7,
            Some(
                "read blanks as delimiter, time from column 1 in ms, displacement from column 2 \
                 \"Position\" in mm",
            ),
            Some("columns not read: 3 \"Temperature (degC)\""),
        ),
        one(
            "numpy_savetxt.txt",
            columns(&["time=1", "displacement=2"]),
            1e-9,
            Some("read blanks as delimiter, time from column 1, displacement from column 2 in m"),
            None,
        ),
        one("numpy_savetxt.csv", columns(&["time=1", "displacement=3"]), 1e-9, None, None),
        one(
            "encoder.csv",
            format(|format| format.scales = vec!["displacement=1e-5".parse().unwrap()]),
            1e-5,
            Some("read time from column 1 in ms, displacement from column 2 in m"),
            None,
        ),
        one("oscilloscope.csv", columns(&["displacement=CH1"]), 1e-7, None, None),
    ]
}

#[test]
fn twelve_instruments_and_spreadsheets_give_the_same_motion() {
    let reference = read("reference.csv", &TableFormat::default());
    assert_eq!((reference.reading().note(), reference.reading().remark()), (None, None));
    let instruments = instruments();
    assert_eq!(instruments.len(), 12);
    for Instrument { file, format, rounding_m, note, unread } in instruments {
        let table = read(file, &format);
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
        assert_eq!(table.reading().note().as_deref(), note, "{file}");
        assert_eq!(table.reading().remark().map(|(unread, _)| unread), unread, "{file}");
        assert!(
            (table.into_motion().unwrap().into_tip().unwrap().travel_m() - 0.5).abs() < 2e-5,
            "{file}"
        );
    }
}

#[test]
fn a_velocity_alone_gives_its_integral() {
    let reference =
        read("reference.csv", &TableFormat::default()).into_motion().unwrap().into_tip().unwrap();
    let table = read("pandas_velocity.csv", &TableFormat::default());
    assert_eq!(
        table.reading().note().as_deref(),
        Some(
            "read time from column 2, velocity from column 3 in mm/s, displacement as the velocity's \
             integral"
        )
    );
    let unread = "columns not read: 1 \"\", 4 \"state\"";
    assert_eq!(table.reading().remark().map(|(unread, _)| unread), Some(unread));
    let (_, hint) =
        table.clone().reading().remark().map(|(a, b)| (a.to_owned(), b.to_owned())).unwrap();
    assert_eq!(hint, "--columns QUANTITY=NUMBER reads one of them instead");
    let motion = table.clone().into_motion().unwrap().into_tip().unwrap();
    assert!((motion.travel_m() - reference.travel_m()).abs() < 1e-5, "{}", motion.travel_m());
    let finer = table.clone().resampled(0.01).unwrap().into_motion().unwrap().into_tip().unwrap();
    assert!((finer.travel_m() - reference.travel_m()).abs() < 1e-5, "{}", finer.travel_m());
    let target = table.into_target().unwrap_err();
    assert!(target.to_string().contains("a target needs displacement"), "{target}");
}

#[test]
fn the_integral_of_a_velocity_has_the_fourth_order() {
    let error = |n: u32| {
        let time = |k: u32| f64::from(k) / f64::from(n);
        let velocity = |t: f64| (std::f64::consts::PI * t).sin().powi(2);
        let row = |k| format!("{:e},{:e}\n", time(k), velocity(time(k)));
        let text = format!("time,velocity\n{}", (0..=n).map(row).collect::<String>());
        let table = read_motion_table("v.csv", text.as_bytes(), 1.0).unwrap();
        let table = table.resampled(1.0 / f64::from(4 * n)).unwrap();
        let found = table.columns().unwrap().displacement_m.clone().unwrap();
        let exact =
            |t: f64| 0.5 * t - (std::f64::consts::TAU * t).sin() / (4.0 * std::f64::consts::PI);
        let times = table.columns().unwrap().time_s.iter();
        times.zip(&found).map(|(t, x)| (exact(*t) - x).abs()).fold(0.0, f64::max)
    };
    let order = (error(40) / error(80)).log2();
    assert!((3.7..5.2).contains(&order), "order {order}");
}

#[test]
fn columns_are_chosen_by_heading_with_and_without_unit_in_any_case() {
    for choices in [
        ["displacement=pos", "time=Time"],
        ["displacement=POS", "time=TIME (s)"],
        ["displacement=pos [mm]", "time=time (S)"],
        ["displacement=2", "time=1"],
    ] {
        let text = b"Time (s),pos [mm],acceleration\n0,1,9\n1,2,9\n2,3,9\n3,4,9\n";
        let table = read_motion_table_as("m.csv", text, &[1.0], &columns(&choices)).unwrap();
        let found = table.columns().unwrap().clone();
        assert_eq!(found.displacement_m, Some(vec![0.001, 0.002, 0.003, 0.004]), "{choices:?}");
        assert_eq!((found.acceleration_m_s2, table.reading().note()), (None, None));
    }
}

#[test]
fn quoted_numbers_have_decimal_commas_by_option() {
    let text = b"time,displacement\n0,\"0,5\"\n1,\"1,5\"\n2,\"2\"\n3,\"2,25\"\n";
    let format = format(|format| format.decimal = Some("comma".parse().unwrap()));
    let found =
        read_motion_table_as("m.csv", text, &[1.0], &format).unwrap().columns().unwrap().clone();
    assert_eq!(found.displacement_m, Some(vec![0.5, 1.5, 2.0, 2.25]));
}

#[test]
fn units_are_those_of_the_options() {
    let text = b"0 0\n5 1\n10 2\n15 3\n";
    let format = TableFormat {
        time_unit: Some("ms".parse().unwrap()),
        unit: Some("deg".parse().unwrap()),
        ..columns(&["time=1", "angle=2"])
    };
    let found =
        read_motion_table_as("m.csv", text, &[2.0], &format).unwrap().columns().unwrap().clone();
    assert_eq!(found.time_s, [0.0, 0.005, 0.01, 0.015]);
    let last_m = found.displacement_m.unwrap()[3];
    assert!((last_m - 6.0f64.to_radians()).abs() < 1e-15, "{last_m}");
}
