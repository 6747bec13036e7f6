//! The duration of a motion: of the command line, or the shortest within limits, for one profile or for the best.

use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::shape::Shape;
use crate::cli::options::inputs::ChangeArgs;
use crate::cli::terminal::text::{binding_text, found_text, is_limit_of_carriage};
use crate::cli::terminal::{Exit, Failure, StageBar, console, memory};
use crate::inverse::{Solution, SolutionWarning};
use crate::motion::{CurveError, Ends, Law, MotionError, Profile};
use crate::result::{
    Along, Fit, FitError, FitProblem, JointMetrics, LimitedValue, Limits, Metrics, Notice,
    OpenMotion, Peak, Remark, shortest_fit, solved,
};
use crate::spec::{Override, SpecError, Specification};
use crate::text::{after, before, excerpt, plain, significant, visible};

/// Name of the choice of the profile with the shortest motion.
const BEST: &str = "best";

/// The profile of the command line.
#[derive(Debug, Clone, Copy)]
pub(super) enum Choice {
    Profile(Profile),
    /// The profile with the shortest duration.
    Best,
}

/// Names of the profiles, and `best`.
pub(super) fn profiles() -> impl TypedValueParser<Value = Choice> {
    let names = Profile::ALL.iter().map(|profile| profile.name()).chain([BEST]);
    let named = |name: String| {
        let profile = Profile::ALL.into_iter().find(|profile| profile.name() == name);
        profile.map_or(Choice::Best, Choice::Profile)
    };
    PossibleValuesParser::new(names).map(named)
}

/// Profile and duration of a motion.
pub struct Found {
    pub(super) law: Law,
    /// Steps of the profile, without those of the shaper.
    pub(super) steps: usize,
    /// Comment for the first line of the file.
    pub(super) comment: String,
    /// Notes on duration, shape and torque.
    pub notes: Vec<String>,
    /// Warnings of the solution, and of limits.
    pub warnings: Vec<Notice>,
    pub(super) remarks: Vec<Notice>,
}

impl Found {
    /// Prints notes, warnings and remarks.
    pub(super) fn tell(&self) {
        for note in &self.notes {
            console::note(note);
        }
        console::warnings(self.warnings.iter().cloned());
        console::remarks(self.remarks.iter().cloned());
    }
}

/// Subject of limits.
#[derive(Debug, Clone, Copy)]
pub(super) enum Limited {
    Link,
    Arm,
}

/// A motion whose profile or duration may be open.
pub(super) struct Search {
    pub(super) profile: Choice,
    /// Steps of the duration; `None` if limits decide.
    pub(super) steps: Option<usize>,
    pub(super) step_s: f64,
    /// The modes that the motion must not excite.
    pub(super) shape: Option<Shape>,
}

impl Search {
    /// Profile and duration of a motion, with notes on both and on the torque of a cycle.
    pub(super) fn found(
        &self,
        along: Along,
        arm: Option<&Specification>,
    ) -> Result<Found, Failure> {
        let is_cycle = along.ends() == Ends::Periodic;
        let is_solved = self.steps.is_none() || is_cycle || self.shape.is_some();
        let Some(arm) = arm.filter(|_| is_solved) else {
            return self.given();
        };
        let (mut found, solution) = if self.steps.is_some() {
            let given = self.given()?;
            let solution = self.solved(arm, along, &given)?;
            (given, solution)
        } else {
            self.shortest(arm, along)?
        };
        let metrics = Metrics::of(&solution);
        if is_cycle {
            let cycle_s = plain(self.time_s(solution.grid.len));
            found.notes.push(solution.arm.joint().worded(&cycle_text(&cycle_s, &metrics)));
        }
        if let Some(shape) = &self.shape {
            let own = solution.motion.grid();
            let steps = own.len - usize::from(!is_cycle);
            let times_s = (self.time_s(found.steps), self.time_s(steps));
            let text = shape.text(found.law.profile(), times_s);
            found.comment = format!("# {text}\n{}", found.comment);
            found.notes.push(text);
            let of_torque = timing_text(&metrics, solution.arm.pick(false, true));
            if let Some(text) = of_torque {
                found.notes.push(solution.arm.joint().worded(&text));
            }
        }
        let worded = |own: Notice| own.worded(&solution.arm);
        found.warnings.extend(solution.warnings.iter().map(|own| worded(own.into())));
        found.warnings.extend(metrics.exceeded(&arm.limits).iter().map(|own| worded(own.into())));
        found.remarks.extend(Remark::on_jumps(&solution).map(|own| worded(Notice::from(&own))));
        Ok(found)
    }

    /// Profile and duration of the command line.
    fn given(&self) -> Result<Found, Failure> {
        let Choice::Profile(profile) = self.profile else {
            let message = "PROFILE = best, but must be one profile with --duration";
            let hint = "leave --duration out: best finds the shortest motion within limits";
            return Err(Failure::new(Exit::Usage, &message, Some(hint)));
        };
        // Checked options have a duration unless there is a link.
        let steps = self.steps.unwrap_or_default();
        Ok(self.with(profile, steps, (String::new(), Vec::new())))
    }

    /// A profile and its steps, before its solution.
    fn with(
        &self,
        profile: Profile,
        steps: usize,
        (comment, notes): (String, Vec<String>),
    ) -> Found {
        let (law, warnings, remarks) = (self.law(profile), Vec::new(), Vec::new());
        Found { law, steps, comment, notes, warnings, remarks }
    }

    /// A profile, shaped.
    fn law(&self, profile: Profile) -> Law {
        match &self.shape {
            Some(shape) => Law::shaped(profile, &shape.shaper, self.step_s),
            None => profile.into(),
        }
    }

    /// The motion of the command line, solved.
    fn solved(
        &self,
        specification: &Specification,
        along: Along,
        given: &Found,
    ) -> Result<Solution, Failure> {
        let Specification { arm, meshes: plans, analysis, limits, .. } = specification;
        let (law, step_s, memory_bytes) = (&given.law, self.step_s, memory::available());
        let motion = OpenMotion { law, along, step_s, durations: None };
        let problem = FitProblem { arm, plans, analysis, memory_bytes, limits, motion };
        solved(&problem, given.steps).map_err(|error| match error {
            FitError::Curve(error) => not_made(&error),
            error => self.not_solved(along, error),
        })
    }

    /// The failure of a motion without a torque for --link; it is therefore not written.
    fn not_solved(&self, along: Along, error: FitError) -> Failure {
        let (is_cycle, is_shaped) = (along.ends() == Ends::Periodic, self.shape.is_some());
        let exit = matches!(error, FitError::Motion(_)).then_some(Exit::Usage);
        let is_repeated = matches!(error, FitError::Motion(MotionError::Repeats { .. }));
        let failure = Failure::from(error);
        let what = if is_cycle { "cycle" } else { "motion" };
        let message = format!("the {what} is neither solved nor written: {}", failure.message);
        let own = if is_repeated && is_shaped {
            Some("use a --dwell of several steps, or another --step".to_owned())
        } else {
            failure.hint.clone()
        };
        let without = (!is_shaped).then(|| "without --link it is written".to_owned());
        let hint = own.into_iter().chain(without).reduce(|own, more| format!("{own}; {more}"));
        Failure { exit: exit.unwrap_or(failure.exit), message, hint, ..failure }
    }

    /// The shortest motion within the limits.
    fn shortest(
        &self,
        specification: &Specification,
        along: Along,
    ) -> Result<(Found, Solution), Failure> {
        let Specification { arm, meshes: plans, analysis, limits, .. } = specification;
        let is_quiet = self.steps.is_none() && self.quiet(Profile::Sine).is_some();
        if !is_quiet {
            refuse_no_limit(limits)?;
        }
        let mut notes = Vec::new();
        let found = self.searched(&mut notes, |profile| {
            let (law, durations) = (self.law(profile), self.quiet(profile));
            let (step_s, durations) = (self.step_s, durations.as_deref());
            let motion = OpenMotion { law: &law, along, step_s, durations };
            let memory_bytes = memory::available();
            shortest_fit(&FitProblem { arm, plans, analysis, memory_bytes, limits, motion })
        });
        let (profile, fit) = found.map_err(|failure| {
            let hint = failure.hint.map(|hint| arm.worded(&hint));
            Failure { message: arm.worded(&failure.message), hint, ..failure }
        })?;
        let values = Metrics::of(&fit.solution).limited(limits);
        let of = match along {
            Along::Arc(course) if course.ends() == Ends::Periodic => " each way",
            Along::Arc(course) if course.stops_m().len() > 1 => " of moves",
            _ => "",
        };
        let warnings = kinds(&fit.solution).len();
        let (note, comment) = self.told(profile, (&fit, warnings, of), &values);
        notes.push(note);
        let found = self.with(profile, fit.steps, (comment, notes));
        Ok((found, fit.solution))
    }

    /// The fit of the profile, or of the best profile, with a note on each duration. The best is the shortest
    /// whose solution has no warning; of equally short ones it is the one farthest from its limit.
    fn searched(
        &self,
        told: &mut Vec<String>,
        fit: impl Fn(Profile) -> Result<Fit, FitError>,
    ) -> Result<(Profile, Fit), Failure> {
        let stages = StageBar::new();
        stages.at("trying durations");
        if let Choice::Profile(profile) = self.profile {
            return Ok((profile, fit(profile)?));
        }
        let share = |fit: &Fit| fit.binding.map_or(0.0, |binding| binding.share());
        let mut best = None;
        let (mut notes, mut refused, mut last) = (Vec::new(), Vec::new(), None);
        for profile in Profile::ALL {
            let own = match fit(profile) {
                Ok(own) => own,
                Err(error) => {
                    refused.push(format!("{:<9}  none: {error}", profile.name()));
                    last = Some(error);
                    continue;
                }
            };
            let kinds = kinds(&own.solution);
            let rank = (!kinds.is_empty(), own.steps);
            let duration_s = plain(self.time_s(own.steps));
            let kinds = if rank.0 { format!(" ({})", kinds.join(", ")) } else { String::new() };
            let binds = self.binding_text(profile, &own);
            let note = format!("{:<9}  {duration_s} s{kinds}{binds}", profile.name());
            notes.push((rank, note));
            let is_better = best.as_ref().is_none_or(|(of_known, _, known)| {
                rank < *of_known || rank == *of_known && share(&own) < share(known)
            });
            if is_better {
                best = Some((rank, profile, own));
            }
        }
        drop(stages);
        notes.sort_by_key(|(rank, _)| *rank);
        told.extend(notes.into_iter().map(|(_, note)| note).chain(refused));
        match (best, last) {
            (Some((_, profile, fit)), _) => Ok((profile, fit)),
            (None, Some(error)) => {
                for note in &*told {
                    console::note(note);
                }
                Err(error.into())
            }
            (None, None) => Err(Failure::new(Exit::Usage, &"there is no profile", None)),
        }
    }

    /// A note on the duration and its binding limit, and the comment of the file.
    fn told(
        &self,
        profile: Profile,
        (fit, warnings, of): (&Fit, usize, &str),
        values: &[LimitedValue],
    ) -> (String, String) {
        let duration_s = plain(self.time_s(fit.steps));
        let is_quiet = self.quiet(profile).is_some();
        let found = format!("{duration_s} s{of}, {}", found_text(fit, values, is_quiet));
        let note = match self.profile {
            Choice::Best if warnings == 0 => {
                format!("the best without a warning or jump is {profile}: {found}")
            }
            Choice::Best => {
                format!("every profile warns or jumps; the shortest is {profile}: {found}")
            }
            Choice::Profile(_) => format!("{found}{}", self.binding_text(profile, fit)),
        };
        (note, format!("# {profile}: {found}\n"))
    }

    /// The limit that binds; of quiet durations none does.
    fn binding_text(&self, profile: Profile, fit: &Fit) -> String {
        self.quiet(profile).map_or_else(|| binding_text(fit), |_| String::new())
    }

    /// Numbers of steps at which the profile does not excite the mode of --quiet-at; `None` without it.
    fn quiet(&self, profile: Profile) -> Option<Vec<usize>> {
        self.shape.as_ref()?.durations(profile, self.step_s)
    }

    /// The time in s of this many steps, without the last digits of the product.
    fn time_s(&self, steps: usize) -> f64 {
        let product = steps as f64 * self.step_s;
        format!("{product:.14e}").parse().unwrap_or(product)
    }
}

/// The changes and the limits of the command line, as changes to the file of a link or of an arm.
pub(super) fn limits(
    changes: &ChangeArgs,
    fit_limit: &[String],
    of: Limited,
) -> Result<Vec<Override>, Failure> {
    let refused = |error: SpecError| Failure::new(Exit::Usage, &error, error.hint());
    let limit = |text: &String| {
        let place = format!("--fit-limit '{}'", visible(&excerpt(text)));
        let Some((key, value)) = text.split_once('=') else {
            let message = format!("{place}: has no `=`, but must read KEY=VALUE");
            let hint = "write it like torque=5 or 'power=\"20 W\"'";
            return Err(Failure::new(Exit::Usage, &message, Some(hint)));
        };
        let change = match (of, key.rsplit_once('.')) {
            (Limited::Link, _) => format!("limits.{text}"),
            (Limited::Arm, Some(("carriage", key))) => format!("limits.{key}={value}"),
            (Limited::Arm, None) if is_limit_of_carriage(key) => format!("limits.{text}"),
            (Limited::Arm, None) => format!("links.*.limits.{text}"),
            (Limited::Arm, Some((link, key))) => format!("links.{link}.limits.{key}={value}"),
        };
        Override::placed(&place, &change).map_err(refused)
    };
    let limits = fit_limit.iter().map(limit).collect::<Result<Vec<_>, _>>()?;
    Ok([changes.overrides()?, limits].concat())
}

/// Refuses to search a duration without limits.
fn refuse_no_limit(limits: &[Limits]) -> Result<(), Failure> {
    if limits.iter().any(|own| *own != Limits::default()) {
        return Ok(());
    }
    let message = "--duration is missing: nothing limits the motion";
    let hint = "set --duration, or a limit, --fit-limit torque=5 or [limits] in the link file, to find the shortest";
    Err(Failure::new(Exit::Usage, &message, Some(hint)))
}

/// The time by which the torques precede the tip's motion and outlast it; `None` for a cycle.
fn timing_text(metrics: &Metrics, is_arm: bool) -> Option<String> {
    let largest = |times: fn(&JointMetrics) -> Option<f64>| {
        metrics.joints.iter().filter_map(times).reduce(f64::max)
    };
    let (lead_s, lag_s) = largest(|own| own.lead_s).zip(largest(|own| own.lag_s))?;
    let starts =
        before(lead_s, 3) + if lead_s < 0.0 { " the motion begins" } else { " the motion" };
    let ends = after(lag_s, 3) + if lag_s < 0.0 { " it ends" } else { " it" };
    let torque = if is_arm { "the first torque" } else { "the torque" };
    let last = if is_arm { "the last" } else { "it" };
    Some(format!("{torque} starts {starts}, and {last} ends {ends}"))
}

/// What a cycle takes.
fn cycle_text(cycle_s: &str, metrics: &Metrics) -> String {
    let torques = |rms: f64, peak: Peak| {
        let [rms, peak] = [rms, peak.value].map(|torque| significant(torque, 4));
        format!("{rms} N m rms, {peak} N m at its peak")
    };
    let hub = metrics.hub();
    let motor = hub.motor.map_or(String::new(), |motor| {
        format!("; of the motor {}", torques(motor.rms_torque_n_m, motor.peaks.peak_torque_n_m))
    });
    let hub = torques(hub.rms_torque_n_m, hub.peak_torque_n_m);
    format!("a cycle of {cycle_s} s takes a torque of {hub}{motor}")
}

/// Refuses a motion that the profile cannot make.
pub(super) fn not_made(error: &CurveError) -> Failure {
    Failure::new(Exit::Usage, error, error.hint())
}

/// Kinds of the warnings of a solution, and of the remark on an acceleration that jumps, because no motor follows it.
fn kinds(solution: &Solution) -> Vec<&'static str> {
    let warnings = solution.warnings.iter().map(SolutionWarning::kind);
    warnings.chain(Remark::on_jumps(solution).iter().map(Remark::kind)).collect()
}
