//! What a case gives the program, and what it expects.

use super::link::Link;
use super::motion::Motion;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Mesh {
    Elements(usize),
    /// Automatic, to a share of each quantity's peak.
    Auto(f64),
}

/// What a case must come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Expect {
    /// Claims that hold, or a warning that names why they do not.
    Claims,
    /// Claims that hold, without a warning.
    Quiet,
    /// A warning of this kind, whatever the claims.
    Warning(&'static str),
    /// No results, and a message that holds these words.
    Refusal(&'static str),
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) link: Link,
    pub(crate) motion: Motion,
    pub(crate) mesh: Mesh,
    pub(crate) tolerance: f64,
    /// The tip's tolerance where it is not the default.
    pub(crate) tip_tolerance: Option<f64>,
    pub(crate) modes: Option<usize>,
    /// Lead and lag in s.
    pub(crate) window_s: Option<[f64; 2]>,
    /// A line of `[limits]`.
    pub(crate) limits: Option<String>,
    pub(crate) expect: Expect,
    /// Peaks known from elsewhere: key of `results`, value, and the share that it is known to.
    pub(crate) peaks: Vec<(&'static str, f64, f64)>,
}

impl Case {
    pub(crate) fn new(name: impl Into<String>, link: Link, motion: Motion, mesh: Mesh) -> Self {
        Self {
            name: name.into(),
            link,
            motion,
            mesh,
            tolerance: 1e-6,
            tip_tolerance: None,
            modes: None,
            window_s: None,
            limits: None,
            expect: Expect::Claims,
            peaks: Vec::new(),
        }
    }

    /// The case with some of it changed.
    pub(crate) fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    /// The tip's tolerance, the default included.
    pub(crate) fn tip_share(&self) -> f64 {
        self.tip_tolerance.unwrap_or(1e-6)
    }

    /// The link file.
    pub(crate) fn toml(&self) -> String {
        let mesh = match self.mesh {
            Mesh::Elements(count) => format!("[mesh]\nelements = {count}"),
            Mesh::Auto(tolerance) => {
                format!("[mesh]\nelements = \"auto\"\ntolerance = {tolerance:e}")
            }
        };
        let line = |key: &str, value: Option<String>| {
            value.map_or(String::new(), |value| format!("{key} = {value}\n"))
        };
        let [lead, lag] = [0, 1].map(|k| self.window_s.map(|window| format!("{:?}", window[k])));
        let tables = [
            format!("{mesh}\n[analysis]\ntolerance = {:e}\n", self.tolerance),
            line("tip_tolerance", self.tip_tolerance.map(|share| format!("{share:e}"))),
            line("modes", self.modes.map(|modes| modes.to_string())),
            line("lead", lead),
            line("lag", lag),
            self.limits.as_ref().map_or(String::new(), |limits| format!("[limits]\n{limits}\n")),
        ]
        .concat();
        self.link.toml(&tables)
    }
}
