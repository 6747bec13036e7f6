use super::finite;
use super::wording::check_words;
use flexlink::csv::{TableError, read_hub_reference, read_torque_table};
use flexlink::numeric::TimeGrid;

const FILE: &str = "torque.csv";

/// Laws: a torque, with or without the name of its column, and a hub motion are refused with words, or
/// have finite samples on a uniform grid. The first line is the name of the column.
///
/// # Panics
/// If one is broken.
pub fn torque_csv(bytes: &[u8]) {
    let end = bytes.iter().position(|byte| *byte == b'\n').unwrap_or(0);
    let (column, table) = bytes.split_at(end);
    let table = table.get(1..).unwrap_or_default();
    check(
        read_torque_table(FILE, table, None)
            .map(|torque| (torque.grid(), vec![torque.torque_n_m().to_vec()])),
    );
    if let Ok(column) = std::str::from_utf8(column) {
        check(
            read_torque_table(FILE, table, Some(column))
                .map(|torque| (torque.grid(), vec![torque.torque_n_m().to_vec()])),
        );
    }
    check(read_hub_reference(FILE, table).map(|hub| {
        let rates = hub.rate_rad_s().map(<[f64]>::to_vec);
        (hub.grid(), [hub.angle_rad().to_vec()].into_iter().chain(rates).collect())
    }));
}

fn check(read: Result<(TimeGrid, Vec<Vec<f64>>), TableError>) {
    match read {
        Err(error) => check_words(FILE, &error, error.hint()),
        Ok((grid, histories)) => {
            let times: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
            assert!(grid.len >= 4 && finite(&times) && times.is_sorted_by(|a, b| a < b));
            assert!(histories.iter().all(|history| history.len() == grid.len && finite(history)));
        }
    }
}
