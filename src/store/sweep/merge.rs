//! Shards of a sweep joined to its table.

use super::rows::SweepRows;
use crate::csv::{Place, TableError};

/// Joins the shards of a sweep to its table: every row of every shard, in the order of the cases.
///
/// # Errors
/// [`TableError`] names a shard that is of another sweep, that is there twice, that is not finished,
/// or those that are missing.
///
/// # Panics
/// Without a shard.
pub fn merge_shards(shards: &[SweepRows]) -> Result<String, TableError> {
    let first = &shards[0];
    let of = first.identity.shard().of();
    let mut ordered: Vec<Option<&SweepRows>> = vec![None; of];
    for shard in shards {
        check_shard(shard, first)?;
        let earlier = ordered[shard.identity.shard().number() - 1].replace(shard);
        if let Some(earlier) = earlier {
            if earlier.name == shard.name {
                let place = Place { file: &shard.name, line: None };
                return Err(place.refuse_whole("is named twice".to_owned()));
            }
            let must = format!("must be another one than that of {}", earlier.name);
            return Err(shard.refuse("shard", shard.identity.shard().to_string(), must));
        }
    }
    let there: Option<Vec<&SweepRows>> = ordered.iter().copied().collect();
    let Some(ordered) = there else {
        let missing = ordered.iter().enumerate().filter(|(_, shard)| shard.is_none());
        let missing: Vec<String> =
            missing.map(|(number, _)| format!("{}/{of}", number + 1)).collect();
        let found = format!("{} of {of}", shards.len());
        let must = format!("must be all: {} missing", listed(&missing));
        return Err(first.refuse("shards", found, must));
    };
    let cases = first.identity.plan().cases();
    let row = |case: usize| ordered[case % of].rows[case / of].as_str();
    let lines = std::iter::once(first.header.as_str()).chain((0..cases).map(row));
    Ok(lines.flat_map(|line| [line, "\n"]).collect())
}

/// Refuses a shard of another sweep than that of the `first`, and one that is not finished.
fn check_shard(shard: &SweepRows, first: &SweepRows) -> Result<(), TableError> {
    shard.check_same(&first.identity, &first.header, &format!("in {}", first.name))?;
    let (own, of) = (shard.identity.shard(), first.identity.shard().of());
    if own.of() != of {
        let must = format!("must be one of {of} as in {}", first.name);
        let place = Place { file: &shard.name, line: Some(1) };
        return Err(place.refuse("shard", own.to_string(), must));
    }
    let (found, must) = (shard.rows.len(), shard.identity.rows());
    if found != must {
        let hint = format!("finish it with --shard {own} --resume");
        let error = shard.refuse("rows", found.to_string(), format!("must be {must}"));
        return Err(error.with_hint(hint));
    }
    Ok(())
}

/// A list of a few, or the first of many and their number.
fn listed(missing: &[String]) -> String {
    match missing {
        [one] => format!("{one} is"),
        few if few.len() <= 8 => format!("{} are", few.join(", ")),
        many => format!("{}, … ({} in all) are", many[..8].join(", "), many.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::identity::{SweepIdentity, identity_of};
    use super::super::rows::{HEADER, file};
    use super::*;

    /// The rows of all cases of a shard.
    fn rows(shard: &SweepIdentity) -> String {
        let cases = (0..shard.rows()).map(|k| shard.shard().case(k) + 1);
        cases.map(|case| case.to_string() + ",0.5,,\n").collect()
    }

    fn shard(number: usize, of: usize, cases: usize) -> SweepRows {
        let shard = format!("{number}/{of}");
        let identity = identity_of("link", &[], &format!("x=1:{cases}:{cases}"), &shard);
        let text = file(&shard, cases, &rows(&identity));
        SweepRows::read(&format!("s{number}.csv"), text.as_bytes()).unwrap()
    }

    #[test]
    fn merged_rows_stand_in_the_order_of_the_cases() {
        for (of, cases) in [(3, 10), (4, 4), (1, 3), (5, 3)] {
            let mut shards: Vec<_> = (1..=of).map(|k| shard(k, of, cases)).collect();
            shards.reverse();
            let merged = merge_shards(&shards).unwrap();
            let whole = identity_of("link", &[], &format!("x=1:{cases}:{cases}"), "1/1");
            assert_eq!(merged, HEADER.to_owned() + &rows(&whole), "{of} shards");
        }
    }

    fn refusal(shards: &[SweepRows]) -> String {
        merge_shards(shards).unwrap_err().to_string()
    }

    #[test]
    fn a_missing_a_second_and_an_unfinished_shard_are_refused() {
        let [a, b, c] = [1, 2, 3].map(|k| shard(k, 3, 10));
        let missing = refusal(&[c.clone(), a.clone()]);
        assert_eq!(missing, "s3.csv: shards = 2 of 3, but must be all: 2/3 is missing");
        let twice = refusal(&[a.clone(), b.clone(), b.clone(), c.clone()]);
        assert_eq!(twice, "s2.csv: is named twice");
        let copy = SweepRows { name: "copy.csv".into(), ..b.clone() };
        let twice = refusal(&[a.clone(), b.clone(), copy]);
        assert_eq!(twice, "copy.csv: shard = 2/3, but must be another one than that of s2.csv");
        let mut cut = b.clone();
        cut.rows.pop();
        assert_eq!(refusal(&[a.clone(), cut, c.clone()]), "s2.csv: rows = 2, but must be 3");
        let mut told = b.clone();
        told.header = HEADER.trim_end().replace("told", "other");
        assert!(
            refusal(&[a.clone(), told, c.clone()]).starts_with("s2.csv:2: columns = \"x,other")
        );
        let other = shard(2, 4, 10);
        let words = "s2.csv:1: shard = 2/4, but must be one of 3 as in s1.csv";
        assert_eq!(refusal(&[a, other, c]), words);
    }
}
