//! Laws that hold for any file that is read as a table.

use std::num::NonZeroUsize;

use flexlink::csv::{
    Column, ColumnGroup, Digits, TableError, TableFormat, read_hub_reference, read_motion_table,
    read_motion_table_as, read_torque_table, write_csv,
};
use flexlink::numeric::TimeGrid;
use flexlink::recording::{Change, outliers};
use proptest::prelude::*;

/// Any finite number.
fn number() -> impl Strategy<Value = f64> {
    any::<f64>().prop_filter("finite", |value| value.is_finite())
}

/// Samples that are not refused for their neighbours: any few numbers, or more of them of one size.
fn samples(most: usize) -> impl Strategy<Value = Vec<f64>> {
    let of_one_size = (prop::collection::vec(-1.0..1.0, 4..most), -1000_i32..1000);
    let of_one_size = of_one_size.prop_map(|(values, exponent)| {
        values.into_iter().map(|value: f64| value * 2.0_f64.powi(exponent)).collect()
    });
    prop_oneof![prop::collection::vec(number(), 4..7), of_one_size].prop_filter(
        "no sample is bad",
        |values: &Vec<f64>| {
            let time_s: Vec<f64> = (0..values.len()).map(|k| k as f64).collect();
            outliers(&time_s, values, Change::Continuous).is_empty()
        },
    )
}

/// Text of the characters that a table is made of, with or without a good first row.
fn almost_a_table() -> impl Strategy<Value = String> {
    "(time,(angle|torque|hub_angle)(,x \\[N cm\\])?\r?\n)?[-+0-9.einaf,;#\" \t\r\n\\[\\]µ]{0,60}"
}

/// What each of the readers refuses; a torque is asked for by one of the names that the tables
/// above may hold.
fn refusals(bytes: &[u8]) -> Vec<TableError> {
    let torque = |column| read_torque_table("t.csv", bytes, column).err();
    let target = read_motion_table("t.csv", bytes, 1.0).and_then(|table| {
        // Whether it is a motion does not matter, only that it is found out.
        let _ = table.clone().into_motion();
        table.into_target()
    });
    let columns = [None, Some(""), Some("x"), Some("angle"), Some("µ"), Some("[")];
    let hub = read_hub_reference("t.csv", bytes).err();
    columns.into_iter().filter_map(torque).chain(target.err()).chain(hub).collect()
}

/// A delimiter, and if decimal commas go with it.
fn dialect() -> impl Strategy<Value = (&'static str, bool)> {
    prop_oneof![
        Just((",", false)),
        (prop::sample::select(vec![";", "\t", " ", "   "]), any::<bool>()),
    ]
}

/// Rows of time, a column that is not read, and displacement, in a dialect.
fn written(rows: &[(f64, f64)], (delimiter, has_commas): (&str, bool)) -> String {
    let number = |value: f64| {
        let text = format!("{value:e}");
        if has_commas { text.replace('.', ",") } else { text }
    };
    let row = |(k, (other, value)): (usize, &(f64, f64))| {
        let fields = [number(k as f64), number(*other), number(*value)];
        fields.join(delimiter) + "\n"
    };
    rows.iter().enumerate().map(row).collect()
}

proptest! {
    #[test]
    fn a_table_is_read_alike_in_every_dialect(
        values in samples(30),
        others in prop::collection::vec(number(), 30),
        dialect in dialect(),
        line_end in prop::sample::select(vec!["\n", "\r\n"]),
        start in prop::sample::select(vec!["", "\u{feff}", "# made up\n", "\n"]),
    ) {
        let rows: Vec<(f64, f64)> = others.into_iter().zip(values.iter().copied()).collect();
        let body = written(&rows, dialect);
        let names = ["time", "other", "displacement"].join(dialect.0);
        let headed = format!("{start}{names}\n{body}").replace('\n', line_end);
        let found = read_motion_table("t.csv", headed.as_bytes(), 1.0)?;
        prop_assert_eq!(found.columns().unwrap().displacement_m.as_ref(), Some(&values));
        prop_assert_eq!(found.reading().note().is_some(), dialect.0 != ",");

        let choices = ["time=1", "displacement=3"].map(|choice| choice.parse().unwrap());
        let format = TableFormat { columns: choices.to_vec(), ..TableFormat::default() };
        let bare = format!("{start}{body}").replace('\n', line_end);
        let found = read_motion_table_as("t.csv", bare.as_bytes(), &[1.0], &format)?;
        prop_assert_eq!(found.columns().unwrap().displacement_m.as_ref(), Some(&values));
    }

    #[test]
    fn no_bytes_make_a_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        refusals(&bytes);
    }

    #[test]
    fn no_table_makes_a_reader_panic_and_refusals_name_a_line_of_it(text in almost_a_table()) {
        let lines = text.split(['\r', '\n']).count();
        for error in refusals(text.as_bytes()) {
            let message = error.to_string();
            let line = message.strip_prefix("t.csv:").and_then(|m| m.split(':').next());
            let line = line.and_then(|line| line.parse::<usize>().ok()).unwrap_or(1);
            prop_assert!((1..=lines).contains(&line), "{}", message);
        }
    }

    #[test]
    fn a_recording_in_few_digits_is_uniform(
        values in prop::collection::vec(number(), 4..50),
        rate_hz in 1_u32..500,
        start in -20_i32..20,
    ) {
        let time_s = |k: usize| f64::from(start) + k as f64 / f64::from(rate_hz);
        let rows = values.iter().enumerate().map(|(k, x)| format!("{:.5},{x:e}\n", time_s(k)));
        let text = format!("time,hub_torque\n{}", rows.collect::<String>());
        let torque = read_torque_table("t.csv", text.as_bytes(), None)?;
        prop_assert_eq!(torque.torque_n_m(), values);
        prop_assert!((torque.grid().step_s * f64::from(rate_hz) - 1.0).abs() < 1e-2);
    }

    #[test]
    fn what_is_written_in_full_reads_back_to_the_last_bit(
        values in samples(50),
        step_s in 1e-4..10.0,
        first in -20_i64..20,
    ) {
        let grid = TimeGrid { origin_s: 0.0, step_s, first, len: values.len() };
        let column = Column { name: "tip_displacement_m".to_owned(), values: &values };
        let groups = [ColumnGroup { columns: vec![column] }];
        let mut file = Vec::new();
        write_csv(&mut file, &grid.thinned(NonZeroUsize::MIN), &groups, Digits::Full)?;
        let columns = read_motion_table("t.csv", &file, 1.0)?.columns().unwrap().clone();
        // -0 is written without its sign, and is equal.
        prop_assert_eq!(columns.displacement_m, Some(values));
        for (k, time_s) in columns.time_s.iter().enumerate() {
            prop_assert!((time_s - grid.time_s(k)).abs() <= 1e-12);
        }
    }
}
