//! One motion as programs and instruments log it: what is read, guessed and refused.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fmt::Display;

use flexlink::csv::{
    MotionTable, TableError, TableFormat, read_frequency_response, read_motion_table_as,
};

use crate::refused_tables::format_of;

const LENGTH_M: f64 = 1.5;

/// Arc of the tip in mm at the time 5 ms · k: a septic of 300 mm, then a rest.
fn arc_mm(k: u32) -> f64 {
    let u = (f64::from(k) / 200.0).min(1.0);
    300.0 * u.powi(4) * (35.0 - u * (84.0 - u * (70.0 - 20.0 * u)))
}

/// Rows of all samples.
fn rows<R: Display>(row: impl Fn(u32) -> R) -> String {
    (0..=220).map(|k| row(k).to_string() + "\n").collect()
}

fn read(bytes: &[u8], options: &str) -> Result<MotionTable, TableError> {
    read_motion_table_as("log", bytes, &[LENGTH_M], &format_of(options))
}

fn with_comma(text: &str) -> String {
    text.replace('.', ",")
}

/// Name, content, options, and a part of the note.
#[expect(clippy::too_many_lines, reason = "one long list")]
fn logs() -> Vec<(&'static str, Vec<u8>, &'static str, &'static str)> {
    let ms = |k: u32| 5 * k;
    let s = |k: u32| f64::from(k) * 0.005;
    let mm = |k: u32| format!("{:.5}", arc_mm(k));
    let clock = |k: u32| format!("17:24:{:06.3}", 5.0 + s(k));
    let latin = |text: String| -> Vec<u8> {
        text.chars().map(|letter| u8::try_from(u32::from(letter)).unwrap()).collect()
    };
    let polar = |k: u32| {
        let angle = arc_mm(k) / 1e3 / LENGTH_M;
        format!("{:.9}\t{:.9}", LENGTH_M * angle.cos(), LENGTH_M * angle.sin())
    };
    let wide: Vec<u8> =
        format!("\u{feff}Time (ms)\tPosition (mm)\n{}", rows(|k| format!("{}\t{}", ms(k), mm(k))))
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect();
    vec![
        (
            "oscilloscope",
            format!(
                "Model,MDO3024\nSample Interval,5e-03\nVertical Units,V\n,\nLabel,,\nTIME,CH1,CH1 Peak Detect\n{}",
                rows(|k| format!("{:e},{},", s(k), mm(k)))
            )
            .into(),
            "--columns displacement=CH1 --unit mm",
            "lines 1 to 5 above the names left out, time from column 1, displacement from column 2 \"CH1\" in mm",
        ),
        (
            "LabVIEW",
            format!(
                "LabVIEW Measurement\t\nWriter_Version\t2\nDelta_X\t0.005\t0.005\n***End_of_Header***\t\n\n\
                 X_Value\tPosition (mm)\tComment\n{}",
                rows(|k| format!("{}\t{}{}", s(k), mm(k), if k == 0 { "\tstart" } else { "" }))
            )
            .into(),
            "",
            "lines 1 to 4 above the names left out, rows without a field of the last name \"Comment\", tab as delimiter, \
             time from column 1 \"X_Value\"",
        ),
        (
            "DIAdem",
            format!("\"Time\";\"Weg\"\n\"ms\";\"mm\"\n{}", rows(|k| format!("{};{}", ms(k), with_comma(&mm(k))))).into(),
            "",
            "units from line 2, ; as delimiter, decimal comma, time from column 1 in ms",
        ),
        (
            "German spreadsheet",
            latin(format!(
                "Prüfung 12;Stand 3\nUhrzeit;Weg;Kraft\n;mm;N\n{}",
                rows(|k| format!("{};{};0,5", with_comma(&clock(k)), with_comma(&mm(k))))
            )),
            "",
            "Windows-1252 as encoding, line 1 above the names left out, units from line 3, ; as delimiter, decimal comma",
        ),
        (
            "French spreadsheet",
            latin(format!(
                "Temps;Déplacement\n(s);(mm)\n{}",
                rows(|k| with_comma(&format!("{};{}", s(k), mm(k))))
            )),
            "",
            "Windows-1252 as encoding, units from line 2, ; as delimiter, decimal comma, time from column 1 \"Temps\"",
        ),
        (
            "ROS bag",
            format!(
                "%time,field.header.seq,field.data\n{}",
                rows(|k| format!("{},{k},{}", 1_709_067_600_000_000_000 + 5_000_000 * u64::from(k), mm(k)))
            )
            .into(),
            "--columns displacement=field.data --unit mm",
            "displacement from column 3 \"field.data\" in mm, time in ns since 1970, by its size",
        ),
        (
            "pandas",
            format!(
                ",timestamp,position [mm]\n{}",
                rows(|k| format!("{k},2026-11-30 {}+00:00,{}", clock(k), mm(k)))
            )
            .into(),
            "",
            "time from column 2 \"timestamp\", displacement from column 3 \"position\" in mm, time in s since 2026-11-30 \
             17:24:05.000+00:00 in line 2",
        ),
        (
            "camera tracker",
            format!("mass A\t\t\nt\tx\ty\n{}", rows(|k| format!("{}\t{}", s(k), polar(k)))).into(),
            "",
            "line 1 above the names left out, tab as delimiter, time from column 1 \"t\", x from column 2 in m, \
             y from column 3 in m, angle as the direction of x and y",
        ),
        (
            "motion controller",
            format!("# run 7\n# t  theta  current\n{}", rows(|k| format!("{}  {:.9}  0.1", s(k), arc_mm(k) / 1e3 / LENGTH_M))).into(),
            "--columns angle=theta",
            "names from line 2 in a comment, blanks as delimiter",
        ),
        (
            "two rows of names",
            format!(
                "Zeit;Position;;Strom\n;Soll;Ist;\nms;mm;mm;A\n{}",
                rows(|k| format!("{};{};0;0", ms(k), with_comma(&mm(k))))
            )
            .into(),
            "--columns displacement=Position_Soll",
            "names from lines 1 and 2, units from line 3",
        ),
        ("UTF-16", wide, "", "UTF-16 as encoding, tab as delimiter, time from column 1 in ms"),
        (
            "Rigol",
            format!(
                "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-3e-3,5e-3\n{}",
                rows(|k| format!("{k},{},0,,", mm(k)))
            )
            .into(),
            "--columns displacement=CH1 --unit mm",
            "units, and time by Start and Increment, from line 2, time from column 1, displacement from column 2 \"CH1\" in mm",
        ),
        (
            "Rigol without fields below the last names",
            format!(
                "X,CH1,Start,Increment\nSequence,Volt,2e-3,5e-3\n{}",
                rows(|k| format!("{},{}", k + 7, mm(k)))
            )
            .into(),
            "--columns displacement=CH1 --scale displacement=1e-3",
            "units, and time by Start and Increment, from line 2",
        ),
        (
            "durations of MATLAB",
            format!("Time,Pos_1\n{}", rows(|k| format!("{} sec,{}", s(k), mm(k)))).into(),
            "--columns displacement=Pos_1 --unit mm",
            "time in sec, as its fields say",
        ),
        (
            "dates of MATLAB",
            format!(
                "Time,Position [mm]\n{}",
                rows(|k| format!("31-Oct-2026 {},{}", clock(k), mm(k)))
            )
            .into(),
            "",
            "time in s since 31-Oct-2026 17:24:05.000 in line 2",
        ),
        (
            "words with a large letter",
            format!("Time (Sec),Position (mm)\n{}", rows(|k| format!("{},{}", s(k), mm(k)))).into(),
            "",
            "time from column 1 in Sec",
        ),
        (
            "WinCC",
            format!(
                "\"VarName\";\"VarValue\";\"Validity\";\"Time_ms\"\n{}",
                rows(|k| {
                    let days = 4.6e10 + s(k) / 0.0864;
                    with_comma(&format!("\"Weg\";{};1;{days:.6}", mm(k)))
                })
            )
            .into(),
            "--columns time=Time_ms,displacement=VarValue --unit mm --scale time=0.0864",
            "displacement from column 2 \"VarValue\" in mm",
        ),
        (
            "converter without times",
            format!("CH1\n{}", rows(mm)).into(),
            "--columns displacement=CH1 --unit mm --sample-rate 0.2kHz",
            "blanks as delimiter, displacement from column 1 \"CH1\" in mm, time from the rate of 0.2kHz",
        ),
    ]
}

#[test]
fn loggers_give_the_same_motion_and_every_guess_is_told() {
    for (name, bytes, options, note) in logs() {
        let options = options.replace("Position_Soll", "Position Soll");
        let table = read(&bytes, &options).unwrap_or_else(|error| {
            panic!("{name}: {error}, {:?}", error.hint());
        });
        let columns = table.columns().unwrap();
        assert_eq!(columns.time_s.len(), 221, "{name}");
        let start_s = columns.time_s[0];
        // Two times since 1899 have a rounding of 0.3 us each in days and of 0.24 us in seconds.
        let digits_s = if name == "WinCC" { 1.2e-6 } else { 1e-9 };
        for (k, (time_s, arc_m)) in
            (0..).zip(columns.time_s.iter().zip(columns.displacement_m.as_ref().unwrap()))
        {
            let off_s = time_s - start_s - 0.005 * f64::from(k);
            assert!(off_s.abs() < digits_s, "{name}, sample {k}: {off_s} s");
            let off_m = arc_m - 1e-3 * arc_mm(k);
            assert!(off_m.abs() < 1e-8, "{name}, sample {k}: {off_m} m");
        }
        let told = table.reading().note().unwrap();
        assert!(told.contains(note), "{name}: {told}");
        assert_eq!(table.reading().since().is_some(), told.contains("time in s since "));
    }
}

#[test]
#[expect(clippy::too_many_lines, reason = "one long list")]
fn doubts_are_refused_with_what_decides() {
    let row = |k: u32| format!("{},{}", 5 * k, arc_mm(k));
    for (text, options, message, hint) in [
        (
            format!("time [s],displacement\nms,mm\n{}", rows(row)),
            "",
            "log:2: time = \"ms\", but must be a number",
            "",
        ),
        (
            format!("Zeit;Soll\nms;counts\n{}", rows(|k| format!("{k};{k}"))),
            "--columns displacement=Soll",
            "log:1: unit of Soll = \"counts\", but must be a unit such as m or cm",
            "--unit UNIT or --scale displacement=FACTOR",
        ),
        (
            format!(
                "time,displacement\n{}",
                rows(|k| format!("0:00:{:02}:{:02},1", k / 25, k % 25))
            ),
            "",
            "log:2: time = \"0:00:00:00\", but must be a number",
            "a time is a number, or reads like 17:24:05.123",
        ),
        (
            format!("time [ms],displacement\n{}", rows(|k| format!("10:00:{:02}.5,1", k % 60))),
            "",
            "log:2: time = \"10:00:00.5\", but must be a number of ms",
            "a date or a time of day has no unit",
        ),
        (
            format!(
                "time,displacement\n{}",
                rows(|k| if k == 3 { "3,1".into() } else { format!("10:00:{:02}.5,1", k % 60) })
            ),
            "",
            "log:5: time = \"3\", but must be a time as in line 2",
            "",
        ),
        (
            format!(
                "time,displacement\n{}",
                rows(|k| format!("{}/12/2026 10:00:00,1", 1 + k / 30))
            ),
            "",
            "log:3: time = 1/12/2026 10:00:00, but must be above 1/12/2026 10:00:00 of line 2",
            "--resample STEP leaves out",
        ),
        (
            format!("time,displacement\n{}", rows(row)),
            "--sample-rate 200",
            "log:1: --sample-rate = 200, but must be left out: column 1, \"time\" has the times",
            "",
        ),
        (
            format!(
                "X,CH1,Start,Increment\nSequence,Volt,-3e-3,5e-3\n{}",
                rows(|k| format!("{k},1,,"))
            ),
            "--columns displacement=CH1 --unit mm --sample-rate 200",
            "log:1: --sample-rate = 200, but must be left out: column 1, \"time\" has the times",
            "",
        ),
        (
            format!(
                "X,CH1,Start,Increment\nSequence,Volt,-3e-3,5e-3\n{}",
                rows(|k| format!("{k},1,,"))
            ),
            "--columns displacement=CH1",
            "log:1: unit of CH1 = \"Volt\", but must be a unit such as m or cm",
            "--unit UNIT or --scale displacement=FACTOR",
        ),
        (
            format!("VarName;VarValue;Validity;Time_ms\n{}", rows(|k| format!("Weg;{k};1;4{k}"))),
            "--columns time=Time_ms,displacement=VarValue --unit mm",
            "log:1: column 4 = \"Time_ms\", but must have its unit in brackets: \"ms\" reads like one",
            "--scale time=0.0864 reads WinCC's millionths of days",
        ),
        (
            format!(
                "time,displacement\n{}",
                rows(|k| format!("{} {},1", k, if k == 1 { "ms" } else { "sec" }))
            ),
            "",
            "log:3: time = \"1 ms\", but must be a number",
            "",
        ),
        (
            // An increment of 0 makes no times.
            format!("X,CH1,Start,Increment\nSequence,Volt,0,0\n{}", rows(|k| format!("{k},1,,"))),
            "--columns time=X,displacement=CH1",
            "log:2: X = \"Sequence\", but must be a number",
            "",
        ),
        (
            format!(
                "***End_of_Header***\t\nX_Value\tPosition (mm)\tComment\n{0}\t\t\nChannels\t1\t\nX_Value\tPosition (mm)\t\n{0}",
                rows(|k| format!("{}\t{}", 0.005 * f64::from(k), arc_mm(k)))
            ),
            "",
            "log:225: a further segment begins, but a table has one",
            "--skip 224 reads this segment; write each one",
        ),
    ] {
        let error = read(text.as_bytes(), options).unwrap_err();
        assert_eq!(error.to_string(), message);
        let found = error.hint().unwrap_or_default();
        assert!(found.starts_with(hint), "{message}: {found}");
    }
}

/// A counter of milliseconds without a unit would be a motion of minutes.
#[test]
fn times_without_a_unit_that_are_slow_as_seconds_are_told() {
    let remark = |heading: &str, step: f64, options: &str| {
        let text = format!(
            "{heading},displacement [mm]\n{}",
            rows(|k| format!("{:.3},{:.5}", step * f64::from(k), arc_mm(k)))
        );
        let table = read(text.as_bytes(), options).unwrap();
        let remarks = table.reading().remarks().map(|(remark, hint)| format!("{remark}; {hint}"));
        remarks.collect::<Vec<_>>().join("\n")
    };
    let told = "\"Timestamp\" has no unit and counts as seconds: a sample every 5.00 s, 1100 s in all; --time-unit";
    assert!(remark("Timestamp", 5.0, "").contains(told));
    assert!(remark("time", 0.1, "").contains("a sample every 0.1"));
    for (heading, step, options) in [
        ("time", 0.05, ""),
        ("time_s", 5.0, ""),
        ("time [s]", 5.0, ""),
        ("time", 5.0, "--time-unit ms"),
    ] {
        assert_eq!(remark(heading, step, options), "", "{heading}, {step}, {options}");
    }
}

#[test]
fn rows_without_a_value_and_repeated_rows_are_left_out_and_counted() {
    let text = |gap: &str, repeated: usize| {
        let row = |k: u32| match k {
            50 => format!("{},{gap}", 5 * k),
            51 => ",".to_owned(),
            90 => vec![format!("{},{}", 5 * k, arc_mm(k)); 1 + repeated].join("\n"),
            _ => format!("{},{}", 5 * k, arc_mm(k)),
        };
        format!("time [ms],displacement [mm]\n{}", rows(row))
    };
    for gap in ["", "NaN", "-nan", "\u{221e}", "-\u{221e}", "inf"] {
        let error = read(text(gap, 1).as_bytes(), "").unwrap_err();
        assert!(error.to_string().starts_with("log:52: displacement = "), "{error}");
        assert!(error.hint().unwrap().starts_with("--resample STEP"), "{error}");
        let table = read(text(gap, 2).as_bytes(), "--resample 0.005").unwrap();
        let note = "read without 2 rows that repeat a time, from line 93 on, without 2 rows that lack a value, from line 52 on";
        assert_eq!(table.reading().note().as_deref(), Some(note));
        let table = table.resampled(0.005).unwrap();
        let columns = table.columns().unwrap();
        assert_eq!(columns.time_s.len(), 221);
        for (k, arc_m) in (0..).zip(columns.displacement_m.as_ref().unwrap()) {
            assert!((arc_m - 1e-3 * arc_mm(k)).abs() < 1e-6, "{k}");
        }
    }
    let error = read(text("", 25).as_bytes(), "--resample 0.005").unwrap_err();
    let must = "log: rows that --resample leaves out = 27 of 246, but must be at most a tenth";
    assert_eq!(error.to_string(), must);
}

#[test]
fn times_of_day_pass_midnight() {
    let clock = |k: u32| {
        let s = (86_399.5 + 0.005 * f64::from(k)) % 86_400.0;
        let [hours, minutes] = [s / 3600.0, s / 60.0 % 60.0].map(f64::floor);
        format!("{hours:02.0}:{minutes:02.0}:{:06.3}", s % 60.0)
    };
    let text =
        format!("time,displacement [mm]\n{}", rows(|k| format!("{},{}", clock(k), arc_mm(k))));
    let table = read(text.as_bytes(), "").unwrap();
    let last_s = *table.columns().unwrap().time_s.last().unwrap();
    assert!((last_s - 1.1).abs() < 1e-9, "{last_s}");
    let note = "read time in s since 23:59:59.500 in line 2, past midnight";
    assert_eq!(table.reading().note().as_deref(), Some(note));
}

#[test]
fn a_date_shows_the_order_of_the_next_ones() {
    let date = |k: u32| {
        let s = 86_399.5 + 0.005 * f64::from(k);
        let (day, s) = if s < 86_400.0 { ("11/30/2026", s) } else { ("12/01/2026", s - 86_400.0) };
        let [hours, minutes] = [s / 3600.0, s / 60.0 % 60.0].map(f64::floor);
        format!("{day} {hours:02.0}:{minutes:02.0}:{:06.3}", s % 60.0)
    };
    let text =
        format!("time,displacement [mm]\n{}", rows(|k| format!("{},{}", date(k), arc_mm(k))));
    let table = read(text.as_bytes(), "").unwrap();
    let last_s = *table.columns().unwrap().time_s.last().unwrap();
    assert!((last_s - 1.1).abs() < 1e-9, "{last_s}");
    // Neither date shows it.
    let text = text.replace("11/30/2026", "12/11/2026").replace("12/01/2026", "12/12/2026");
    let error = read(text.as_bytes(), "").unwrap_err().to_string();
    assert!(error.contains("must show the order of day and month"), "{error}");
}

#[test]
fn seconds_since_1970_keep_their_digits() {
    let time = |k: u32| {
        format!("17960594{}.{:04}", 45 + (1234 + 50 * k) / 10_000, (1234 + 50 * k) % 10_000)
    };
    let text =
        format!("time,displacement [mm]\n{}", rows(|k| format!("{},{}", time(k), arc_mm(k))));
    let table = read(text.as_bytes(), "").unwrap();
    for (k, time_s) in (0..).zip(&table.columns().unwrap().time_s) {
        assert!((time_s - 0.005 * f64::from(k)).abs() < 1e-13, "{k}: {time_s}");
    }
}

/// A step of 5e-8 d, 4.32 ms. As one number a time of 45000 d in s has half a µs.
#[test]
fn days_of_a_spreadsheet_keep_their_digits() {
    let text = |unit: &str, day: u32| {
        let day = |k: u32| format!("{day}.{:08}", 12_345_678 + 5 * k);
        format!("time{unit},displacement [mm]\n{}", rows(|k| format!("{},{}", day(k), arc_mm(k))))
    };
    for (text, options) in [
        (text(" [d]", 45_000), ""),
        (text("", 45_000), "--time-unit d"),
        (text(" [d]", 739_000), "--scale displacement=2"),
        (text(" [d]", 0), ""),
    ] {
        let table = read(text.as_bytes(), options).unwrap();
        let times_s = &table.columns().unwrap().time_s;
        for (k, time_s) in (0..).zip(times_s) {
            let error_s = time_s - times_s[0] - 0.00432 * f64::from(k);
            assert!(error_s.abs() < 1e-11, "{options} {k}: {error_s}");
        }
    }
    let exponent = text(" [d]", 45_000).replace(".12345678,", ".12345678e0,");
    assert!(read(exponent.as_bytes(), "").is_ok());
}

#[test]
fn every_line_is_a_sample_at_a_sample_rate() {
    let text = format!("displacement [mm]\n{}", rows(|k| arc_mm(k).to_string()));
    assert!(read(text.as_bytes(), "--sample-rate 200").is_ok());
    let mut lines: Vec<&str> = text.lines().collect();
    lines[101] = "";
    let error = read(lines.join("\n").as_bytes(), "--sample-rate 200").unwrap_err().to_string();
    assert!(error.starts_with("log:102: has no sample, but must have one"), "{error}");
}

#[test]
fn a_response_has_one_column_of_a_quantity_and_a_phase_in_its_unit() {
    let response = |text: &str, keys: TableFormat| {
        read_frequency_response("frf", text.as_bytes(), &keys).map(|found| found.values)
    };
    // A delay of 0.3 s, in radians that no wrapping limits.
    let hertz = |k: u32| 1.0 + f64::from(k);
    let phase = |k: u32| -std::f64::consts::TAU * 0.3 * hertz(k);
    let rows = (0..30).map(|k| format!("{},{},{}\n", hertz(k), 1.0 / hertz(k), phase(k)));
    let rows: String = rows.collect();
    let scaled = TableFormat { scales: vec!["phase=1".parse().unwrap()], ..TableFormat::default() };
    for (names, keys) in [
        ("frequency_hz,gain_1,phase_rad", TableFormat::default()),
        ("frequency,gain,phase", scaled.clone()),
    ] {
        let values = response(&format!("{names}\n{rows}"), keys).unwrap();
        for (k, value) in (0..).zip(values) {
            let exact = (phase(k).cos() / hertz(k), phase(k).sin() / hertz(k));
            assert!(
                (value.re - exact.0).abs() + (value.im - exact.1).abs() < 1e-12,
                "{names}: {k}"
            );
        }
    }
    let two = "freq,magnitude,amplitude,phase [rad]\n1,2,3,0\n2,1,4,0\n3,1,2,0\n";
    let error = response(two, TableFormat::default()).unwrap_err().to_string();
    assert!(error.contains("must not repeat column 2"), "{error}");
    let error =
        response("frequency,real,imaginary\n1,2,3\n2,1,4\n", scaled).unwrap_err().to_string();
    assert!(error.contains("scale = phase, but must be one of the columns read"), "{error}");
}
