use std::fmt;

use sha2::{Digest as _, Sha256};

use super::input::{InputFile, hexadecimal};
use crate::sweep::{Shard, SweepPlan};

/// Digits of the fingerprint that are told: no two sweeps of one project share these.
const DIGITS: usize = 16;

/// Which rows a file of a sweep is to hold: the first line of shards and of unfinished sweeps.
///
/// It reads `# flexlink 0.1.0 sweep 5f0c2a9b1d3e4f60, shard 2/8 of 1000 cases`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SweepIdentity {
    pub(super) version: String,
    pub(super) fingerprint: String,
    pub(super) shard: Shard,
    pub(super) cases: usize,
}

impl SweepIdentity {
    /// The identity of a sweep over these files, with these other arguments that shape its rows.
    pub fn new(files: &[&InputFile], arguments: &[String], plan: &SweepPlan, shard: Shard) -> Self {
        let mut digest = Sha256::new();
        let mut add = |part: &str| {
            // The length first, so that no two lists of parts read the same.
            digest.update(part.len().to_le_bytes());
            digest.update(part);
        };
        for file in files {
            add(&file.sha256());
        }
        for argument in arguments {
            add(argument);
        }
        for variation in plan.variations() {
            add(&variation.heading());
            for k in 0..variation.values().len() {
                add(&variation.change(k));
            }
        }
        let mut fingerprint = hexadecimal(&digest.finalize());
        fingerprint.truncate(DIGITS);
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Self { version, fingerprint, shard, cases: plan.cases() }
    }

    /// The cases that the file is to hold.
    pub fn shard(&self) -> Shard {
        self.shard
    }

    /// Rows that the file is to hold.
    pub fn rows(&self) -> usize {
        self.shard.len(self.cases)
    }

    /// Whether `other` is a shard of the same sweep.
    pub(super) fn is_of_sweep(&self, other: &Self) -> bool {
        Self { shard: other.shard, ..self.clone() } == *other && self.shard.of() == other.shard.of()
    }

    /// Reads the first line of a file, without its line end; `None` where it is none of a sweep.
    pub(super) fn read(line: &str) -> Option<Self> {
        let rest = line.trim_end().strip_prefix("# flexlink ")?;
        let (version, rest) = rest.split_once(" sweep ")?;
        let (fingerprint, rest) = rest.split_once(", shard ")?;
        let (shard, cases) = rest.strip_suffix(" cases")?.split_once(" of ")?;
        Some(Self {
            version: version.to_owned(),
            fingerprint: fingerprint.to_owned(),
            shard: shard.parse().ok()?,
            cases: cases.parse().ok()?,
        })
    }
}

impl fmt::Display for SweepIdentity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { version, fingerprint, shard, cases } = self;
        write!(f, "# flexlink {version} sweep {fingerprint}, shard {shard} of {cases} cases")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> InputFile {
        InputFile { shown: "x".into(), name: "x".into(), bytes: text.as_bytes().to_vec() }
    }

    fn identity(link: &str, arguments: &[&str], vary: &str) -> SweepIdentity {
        let plan = SweepPlan::new(vec![vary.parse().unwrap()]).unwrap();
        let arguments: Vec<String> = arguments.iter().map(|a| (*a).to_owned()).collect();
        SweepIdentity::new(&[&file(link)], &arguments, &plan, "2/8".parse().unwrap())
    }

    #[test]
    fn it_reads_back_from_its_own_line() {
        let found = identity("link", &[], "hub.inertia=1:2:11");
        assert_eq!(SweepIdentity::read(&found.to_string()), Some(found.clone()));
        assert_eq!((found.rows(), found.shard().number()), (2, 2));
        for line in ["time_s,torque_n_m", "# flexlink", &found.to_string().replace("2/8", "9/8")] {
            assert_eq!(SweepIdentity::read(line), None, "{line}");
        }
    }

    #[test]
    fn whatever_changes_a_row_changes_the_fingerprint() {
        let known = identity("link", &["--set", "a=1"], "hub.inertia=1,2");
        for other in [
            identity("link ", &["--set", "a=1"], "hub.inertia=1,2"),
            identity("link", &["--set", "a=2"], "hub.inertia=1,2"),
            identity("link", &["--set", "a=1"], "hub.inertia=1,3"),
            identity("link", &["--set", "a=1"], "hub.inertia*=1,2"),
        ] {
            assert!(!known.is_of_sweep(&other));
        }
        let same = identity("link", &["--set", "a=1"], "hub.inertia=1:2:2");
        assert!(known.is_of_sweep(&same), "the same rows, written otherwise");
    }
}
