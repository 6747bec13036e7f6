//! A trajectory file whose samples are no motion from rest to rest on a uniform grid is refused,
//! with file, line and what to do.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use flexlink::csv::read_motion_table;

fn refusal(text: &str) -> String {
    let table = read_motion_table("traj.csv", text.as_bytes(), 1.5).unwrap();
    let error = table.into_motion().unwrap_err();
    match error.hint() {
        Some(hint) => format!("{error}\nhint: {hint}"),
        None => error.to_string(),
    }
}

#[test]
fn a_time_off_the_grid_is_named_with_its_row() {
    assert_eq!(
        refusal("# a row is missing\ntime,displacement\n0,0\n0.1,0\n0.2,0.1\n0.4,0.2\n0.5,0.2\n"),
        "traj.csv:6: time = 0.4 s, but must be 0.3 s: the samples before and after stand 0.1 s \
         apart\nhint: write times with more decimals, or let --resample STEP make uneven samples \
         uniform"
    );
}

#[test]
fn columns_that_contradict_each_other_are_named_with_the_worst_row() {
    let text = "time,acceleration,displacement\n0,0,0\n1,1,0\n2,0,1\n3,-1,2\n4,0,20\n";
    let found = refusal(text);
    // Five samples are few for a band-limited integral: it misses the sum, 2 m, by 0.5 %.
    assert!(found.starts_with("traj.csv:6: displacement = 20 m, but must be 2.009"), "{found}");
    let rest = " m to agree with the acceleration\nhint: check the units in the header, or leave one \
                of the columns out";
    assert!(found.ends_with(rest), "{found}");
    let text = "time,velocity,displacement\n0,0,0\n1,9,0\n2,0,1\n3,0,2\n4,0,2\n";
    let found = refusal(text);
    assert!(found.starts_with("traj.csv:3: velocity = 9 m/s, but must be "), "{found}");
    assert!(
        found.contains(" m/s to agree with the displacement\nhint: check the units"),
        "{found}"
    );
}

#[test]
fn a_motion_that_is_not_at_rest_at_an_end_is_refused() {
    let hint = "hint: a motion goes from rest to rest; add the samples that bring the tip to rest";
    assert_eq!(
        refusal("time,displacement\n0,0\n1,1\n2,2\n3,2\n4,2\n"),
        format!(
            "traj.csv:2: the motion starts with a velocity of 1.000e0 m/s, 100.00 % of its peak, \
             but must be at rest there\n{hint}"
        )
    );
    assert_eq!(
        refusal("time,angle\n0,0\n1,0\n2,0\n3,1\n4,2\n"),
        format!(
            "traj.csv:6: the motion ends with a velocity of 1.500e0 m/s, 100.00 % of its peak, but \
             must be at rest there\n{hint}"
        )
    );
    assert_eq!(
        refusal("time,acceleration\n0,0\n1,1\n2,0\n3,-0.9\n4,0\n"),
        format!(
            "traj.csv: the motion ends with a velocity of 1.000e-1 m/s, 10.00 % of its peak, but \
             must end at rest: the acceleration must integrate to 0\n{hint}"
        )
    );
}

#[test]
fn a_tip_that_stands_still_is_refused() {
    let expected = "traj.csv: the tip stands still in all samples, but must move";
    assert_eq!(refusal("time,acceleration\n0,0\n1,0\n2,0\n3,0\n"), expected);
}
