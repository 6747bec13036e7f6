//! Tables of sweeps.

use flexlink::compare::Cell;

use super::{Bench, PAPER, SHORT};

const VARY: &str = "--vary payload.mass=0,0.05 --vary segments.*.EI*=1,4";
const KINDS: &str = "must be those of a sweep: values varied, period_1_s, …, error";

/// A sweep into `folder/name`.
fn swept(bench: &Bench, arguments: &str, name: &str) {
    bench.run(&format!("sweep {PAPER} {arguments} {SHORT}"), name);
}

#[test]
fn a_sweep_comes_back_from_its_file_and_from_its_folder() {
    let bench = Bench::new();
    swept(&bench, VARY, "s/stiff.csv");
    bench.write("s/other.csv", "time_s,torque_n_m\n0,1\n");
    bench.write("s/notes.txt", "mine");
    for path in ["s/stiff.csv", "s"] {
        let sweep = bench.sweep_of(path);
        assert_eq!((sweep.name.as_str(), sweep.units.len()), ("stiff.csv", 2));
        assert_eq!(sweep.table.lines, [2, 3, 4, 5]);
        let names: Vec<&str> = sweep.table.names().collect();
        let text = bench.read("s/stiff.csv");
        assert_eq!(names.join(","), text.lines().next().unwrap());
        for (row, line) in text.lines().skip(1).enumerate() {
            for (column, field) in sweep.table.columns.iter().zip(line.split(',')) {
                let expected = field.parse().map_or(Cell::Word(field), Cell::Number);
                assert_eq!(column.cell(row), expected);
            }
        }
    }
}

#[test]
fn a_sweep_of_one_torque_and_one_with_failed_cases_come_back() {
    let bench = Bench::new();
    bench.solve(PAPER);
    let torque = bench.file("out/torque.csv");
    let vary = format!("--vary segments.beam.length=1.35,-1 --torque {torque}");
    swept(&bench, &vary, "played.csv");
    let sweep = bench.sweep_of("played.csv");
    assert_eq!(sweep.units.len(), 1);
    assert!(sweep.table.column("tip_error_m").is_some());
    let error = sweep.table.column("error").unwrap();
    assert_eq!(error.cell(0), Cell::Word(""));
    assert!(matches!(error.cell(1), Cell::Word(text) if !text.is_empty()));
    assert_eq!(sweep.table.column("residual_m").unwrap().cell(1), Cell::Word(""));
}

#[test]
fn what_is_no_sweep_or_several_is_refused() {
    let bench = Bench::new();
    swept(&bench, "--vary payload.mass=0,0.05", "s/a.csv");
    let text = bench.read("s/a.csv");
    bench.write("s/b.csv", &text);
    let hint = |text: &str| Some(text.to_owned());
    let several = "s: tables of sweeps = a.csv, b.csv, but must be one";
    assert_eq!(bench.refusal("s"), (several.into(), hint("name the file of one of them")));
    bench.write("t.csv", "time_s,torque_n_m\n0,1\n");
    let foreign = format!("t.csv: columns = \"time_s,torque_n_m\", but {KINDS}");
    let folder = hint("name the folder of solve, simulate or robust, or the table of sweep");
    assert_eq!(bench.refusal("t.csv"), (foreign, folder.clone()));
    bench.write("summary.json", "{\n  \"flexlink\": \"0.1.0\",\n  \"command\": \"solve\"\n}\n");
    assert_eq!(bench.refusal("summary.json").1, folder);

    let header = text.lines().next().unwrap();
    let told = header.split_once(',').unwrap().1;
    let refused = |text: &str| {
        bench.write("x.csv", text);
        bench.refusal("x.csv").0
    };
    let none = "x.csv: the table has no cases, but must have at least one";
    assert_eq!(refused(&format!("{header}\n")), none);
    let slip = format!("x.csv: column 9 = \"lagg_s\", but must be \"{told}\"");
    assert_eq!(refused(&text.replace(",lag_s,", ",lagg_s,")), slip);
    bench.write("x.csv", &text.replace(",warnings,", ",").replace(",,\n", ",\n"));
    let older = "x.csv: the column warnings is missing".to_owned();
    let again = hint("an older flexlink wrote it: run the sweep again");
    assert_eq!(bench.refusal("x.csv"), (older, again));
    let fewer = told.replace("lag_s,", "");
    let must = format!("x.csv: columns from period_1_s on = \"{fewer}\", but must be \"{told}\"");
    assert_eq!(refused(&(header.replace("lag_s,", "") + "\n")), must);
    let row = text.lines().nth(1).unwrap();
    let fields: Vec<&str> = row.split(',').collect();
    for (found, shown) in [("nan", "NaN"), ("inf", "inf"), ("much", "\"much\"")] {
        let changed = row.replacen(fields[3], found, 1);
        let must = "but must be a finite number or nothing";
        let told = refused(&format!("{header}\n{changed}\n"));
        assert_eq!(told, format!("x.csv:2: peak_torque_n_m = {shown}, {must}"));
    }
    let short = refused(&format!("{header}\n1,2\n"));
    assert!(short.starts_with("x.csv:2: fields = 2, but must be 24"), "{short}");
}
