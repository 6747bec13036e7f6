//! The plants of a link file: its keys with their intervals, and the file with values of them.

use crate::cli::terminal::{Exit, Failure, console};
use crate::csv::InputFile;
use crate::robust::{Fitted, Hold, How, Key, Values, corners};
use crate::spec::{LinkDocument, Override, SpecError, Specification, Uncertain};
use crate::store::read_fitted;

/// The link file with its changes, from which plants are made.
pub struct Plants {
    document: LinkDocument,
    name: String,
    changes: Vec<Override>,
    /// The values that differ.
    pub(in crate::cli) keys: Vec<Key>,
    /// Those that a fit found.
    pub(super) fitted: Option<Fitted>,
}

impl Plants {
    /// The plants of a link file with changes, and the specification of the file. Their keys are those of the options, or else
    /// of the file, and those of a fit; at least one.
    pub fn of(
        link: (&InputFile, Vec<Override>),
        intervals: (&[Uncertain], Option<&InputFile>),
        hold: Hold,
    ) -> Result<(Self, Specification), Failure> {
        let found = Self::of_any(link, intervals, hold)?;
        if found.0.keys.is_empty() {
            let message = "nothing is uncertain: --uncertain is missing, and the link file has no [uncertainty]";
            let hint = "say how well a value is known: --uncertain 'segments.*.EI*=±5%'";
            return Err(Failure::new(Exit::Usage, &message, Some(hint)));
        }
        Ok(found)
    }

    /// [`Plants::of`] with any number of keys.
    pub(in crate::cli) fn of_any(
        (link, changes): (&InputFile, Vec<Override>),
        (uncertain, fit): (&[Uncertain], Option<&InputFile>),
        hold: Hold,
    ) -> Result<(Self, Specification), Failure> {
        let document = LinkDocument::read(&link.shown, link.text()?)?;
        let specification = document.specification(&link.shown, &changes)?;
        let (keys, fitted) = keys(&document, (link, &changes), (uncertain, fit), hold)?;
        let plants = Self { document, name: link.shown.clone(), changes, keys, fitted };
        // An end that the file refuses is told by its own number, before anything is played.
        plants.alone().iter().try_for_each(|values| plants.with(values).map(drop))?;
        Ok((plants, specification))
    }

    /// The file with these values of the keys.
    pub(in crate::cli) fn with(&self, values: &[Option<f64>]) -> Result<Specification, Failure> {
        let delay_s = self.delay_s(values);
        if delay_s < 0.0 {
            let message = format!("delay = {delay_s} s, but must be 0 or above");
            return Err(Failure::new(Exit::InputRefused, &message, None));
        }
        let mut changes = self.changes.clone();
        for (key, value) in self.keys.iter().zip(values) {
            if let Some(change) = value.and_then(|value| key.change(value)) {
                let place = format!("--uncertain, {change}");
                changes.push(Override::placed(&place, &change).map_err(|error| refused(&error))?);
            }
        }
        self.document.specification(&self.name, &changes).map_err(|error| refused(&error))
    }

    /// The ends of each key alone, and the corners.
    pub(in crate::cli) fn ends(&self) -> Vec<Values> {
        let candidates: Vec<Vec<f64>> = self.keys.iter().map(|key| key.ends.to_vec()).collect();
        [self.alone(), corners(&candidates, &[vec![1; candidates.len()]])].concat()
    }

    /// The ends of each key alone.
    fn alone(&self) -> Vec<Values> {
        let keys = self.keys.iter().enumerate();
        let ends = keys.flat_map(|(number, key)| key.ends.map(|end| (number, end)));
        let values = |(number, end): (usize, f64)| {
            let mut values = vec![None; self.keys.len()];
            values[number] = Some(end);
            values
        };
        ends.map(values).collect()
    }

    /// The delay of the drives in s.
    pub(in crate::cli) fn delay_s(&self, values: &[Option<f64>]) -> f64 {
        let delays = self.keys.iter().zip(values).filter(|(key, _)| key.how == How::Delay);
        delays.filter_map(|(_, value)| *value).sum()
    }
}

fn refused(error: &SpecError) -> Failure {
    Failure::new(Exit::InputRefused, error, error.hint())
}

/// The keys of the options, or else of the link file, and those of a fit.
fn keys(
    document: &LinkDocument,
    (link, changes): (&InputFile, &[Override]),
    (uncertain, fit): (&[Uncertain], Option<&InputFile>),
    hold: Hold,
) -> Result<(Vec<Key>, Option<Fitted>), Failure> {
    let mut all = uncertain.to_vec();
    if uncertain.is_empty() && fit.is_none() {
        all = document.uncertainties(&link.shown).map_err(|error| refused(&error))?;
        if hold != Hold::Position && all.iter().any(Uncertain::is_delay) {
            all.retain(|own| !own.is_delay());
            console::note("the delay of [uncertainty] counts with --play position alone");
        }
    } else if let Some(own) = all.iter().find(|own| own.is_delay() && hold != Hold::Position) {
        let message = format!("{own}: is for --play position: a delayed torque is another command");
        return Err(Failure::new(Exit::Usage, &message, None));
    }
    let key = |own: &Uncertain| document.uncertain(own, changes).map_err(|error| refused(&error));
    let mut keys: Vec<Key> = all.iter().map(key).collect::<Result<_, _>>()?;
    let fitted = match fit {
        None => None,
        Some(fit) => {
            let (of_fit, fitted) = read_fitted(fit, link)?;
            let first = keys.len();
            keys.extend(of_fit);
            Some(Fitted { first, ..fitted })
        }
    };
    if let Some(two) = document.overlapping(&keys, changes) {
        let [one, other] = two.map(|number| keys[number].heading());
        let message = if one == other {
            format!("{one} has two intervals, but must have one")
        } else {
            format!("{one} and {other} are intervals of one value")
        };
        let hint = "state each value once: an interval of --uncertain, or that of the fit";
        return Err(Failure::new(Exit::Usage, &message, Some(hint)));
    }
    Ok((keys, fitted))
}
