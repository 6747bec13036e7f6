//! Laws that hold for any trajectory file.

use flexlink::numeric::TimeGrid;
use flexlink::tables::{Column, ColumnGroup, Digits, read_motion_table, write_csv};
use proptest::prelude::*;

/// Any finite number.
fn number() -> impl Strategy<Value = f64> {
    any::<f64>().prop_filter("finite", |value| value.is_finite())
}

/// Text of the characters that a table is made of, with or without a good first row.
fn almost_a_table() -> impl Strategy<Value = String> {
    "(time,angle\r?\n)?[-+0-9.einaf,;#\" \t\r\n\\[\\]µ]{0,60}"
}

proptest! {
    #[test]
    fn no_bytes_make_the_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = read_motion_table("t.csv", &bytes, 1.0);
    }

    #[test]
    fn no_table_makes_the_reader_panic(text in almost_a_table()) {
        let refused = read_motion_table("t.csv", text.as_bytes(), 1.0).err();
        let lines = text.split(['\r', '\n']).count();
        if let Some(error) = refused {
            let message = error.to_string();
            let line = message.strip_prefix("t.csv:").and_then(|m| m.split(':').next());
            let line = line.and_then(|line| line.parse::<usize>().ok()).unwrap_or(1);
            prop_assert!((1..=lines).contains(&line), "{}", message);
        }
    }

    #[test]
    fn what_is_written_in_full_reads_back_to_the_last_bit(
        values in prop::collection::vec(number(), 4..50),
        step_s in 1e-4..10.0,
        first in -20_i64..20,
    ) {
        let grid = TimeGrid { origin_s: 0.0, step_s, first, len: values.len() };
        let column = Column { name: "tip_displacement_m".to_owned(), values: &values };
        let groups = [ColumnGroup { columns: vec![column] }];
        let mut file = Vec::new();
        write_csv(&mut file, &grid.thinned(1), &groups, Digits::Full)?;
        let columns = read_motion_table("t.csv", &file, 1.0)?.columns;
        // -0 is written without its sign, and is equal.
        prop_assert_eq!(columns.displacement_m, Some(values));
        for (k, time_s) in columns.time_s.iter().enumerate() {
            prop_assert!((time_s - grid.time_s(k)).abs() <= 1e-12);
        }
    }
}
