use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use crate::numeric::excerpt;

/// Most shards of one sweep.
const MOST: usize = 100_000;

/// Every N-th case, the share of one machine of N: `2/8` has the cases 2, 10, 18, …
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

/// Text that is no shard.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("shard = {found:?}, but must read I/N, 1 <= I <= N, N at most {MOST}")]
pub struct ShardError {
    found: String,
}

impl Default for Shard {
    /// All cases.
    fn default() -> Self {
        Self { number: 1, of: 1 }
    }
}

impl Shard {
    /// Its number, from 1.
    pub fn number(&self) -> usize {
        self.number
    }

    /// How many shards there are.
    pub fn of(&self) -> usize {
        self.of
    }

    /// How many of `cases` it has.
    pub fn len(&self, cases: usize) -> usize {
        (cases + self.of - self.number) / self.of
    }

    /// Number of its `k`-th case, both from 0.
    pub fn case(&self, k: usize) -> usize {
        k * self.of + self.number - 1
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = |text: &str| text.trim().parse::<usize>().ok().filter(|n| *n > 0);
        let pair = text.split_once('/').and_then(|(i, n)| Some((number(i)?, number(n)?)));
        match pair {
            Some((number, of)) if number <= of && of <= MOST => Ok(Self { number, of }),
            _ => Err(ShardError { found: excerpt(text).into_owned() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_all_cases_and_none_twice() {
        for (cases, of) in [(10, 3), (7, 7), (5, 8), (0, 2), (1, 1)] {
            let mut seen = vec![0; cases];
            for number in 1..=of {
                let shard: Shard = format!("{number}/{of}").parse().unwrap();
                (0..shard.len(cases)).for_each(|k| seen[shard.case(k)] += 1);
            }
            assert!(seen.iter().all(|times| *times == 1), "{cases} cases, {of} shards: {seen:?}");
        }
    }

    #[test]
    fn a_shard_that_there_is_not_is_refused() {
        for text in ["0/4", "5/4", "1", "a/b", "1/0", "-1/2", "1/100001", ""] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
