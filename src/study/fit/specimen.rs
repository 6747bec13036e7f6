//! Object of a fit, a link or an arm, and its predictions for the measurements.

use std::cell::OnceCell;
use std::f64::consts::TAU;

use rayon::prelude::*;

use super::instruments::with_motor;
use super::measurement::{ArmMode, End, HubEnd, LinkFitError, Measured, Observable};
use super::measurements::{Measurements, Prediction};
use super::record::Record;
use super::response::Response;
use crate::beam::{Mesh, MeshPlan};
use crate::link::{Arm, Drive, Link, ParameterError};
use crate::modal::DampingLaw;
use crate::model::{KeptModes, model_of};
use crate::numeric::Size;
use crate::response::{ArmPose, MORE_ORDERS, MOST_REFINEMENTS, PoseError, damping_ratios};

/// Largest relative mesh error of a frequency while starts are tried.
pub(super) const COARSE: f64 = 1e-5;

/// Largest relative mesh error of a frequency of the fitted link: far below any measurement's.
pub(super) const FINE: f64 = 1e-8;

/// Object of the measurements.
#[derive(Debug, Clone)]
pub enum Specimen {
    /// A link, and the plan of its mesh.
    Link(Box<(Link, MeshPlan)>),
    /// An arm.
    Arm(Arm),
}

impl Specimen {
    /// The object of a file: a link with the plan of its mesh, or an arm of several links.
    pub fn of(arm: Arm, plans: &[MeshPlan]) -> Self {
        match (arm.links(), plans) {
            ([own], [plan]) => Self::Link(Box::new((own.link.clone(), plan.clone()))),
            _ => Self::Arm(arm),
        }
    }

    /// Number of times that the elements of an automatic plan are halved, or the orders of an arm's polynomials are
    /// raised, for measured values exact to a tolerance; 0 for other plans.
    pub(super) fn refinements<E>(
        &self,
        measured: &Measurements,
        tolerance: f64,
    ) -> Result<u32, LinkFitError<E>> {
        Ok(match self {
            Self::Link(own) => measured.halvings(&own.0, &own.1, tolerance)?,
            Self::Arm(arm) => raised(arm, measured.values(), tolerance)?.0,
        })
    }

    /// The refinements at the start. Refuses an arm whose measured modes are not exact.
    pub(super) fn checked<E>(&self, measured: &Measurements) -> Result<u32, LinkFitError<E>> {
        let Self::Arm(arm) = self else { return self.refinements(measured, COARSE) };
        let (refinements, change) = raised(arm, measured.values(), COARSE)?;
        // Infinite if a mode is missing.
        if change.is_finite() && change > COARSE {
            return Err(LinkFitError::Coarse { change });
        }
        Ok(refinements)
    }

    /// The drive of one link.
    pub fn drive(&self) -> Option<&Drive> {
        match self {
            Self::Link(own) => own.0.drive(),
            Self::Arm(_) => None,
        }
    }

    /// True for a link on a carriage.
    pub fn slides(&self) -> bool {
        matches!(self, Self::Link(own) if own.0.joint().slides())
    }

    /// Number of links.
    pub fn links(&self) -> usize {
        match self {
            Self::Link(_) => 1,
            Self::Arm(arm) => arm.links().len(),
        }
    }

    /// Frequencies in Hz that are nearer to this one than to those of the modes below and above it, by their
    /// logarithms; unbounded where there is no such mode.
    pub fn around_hz(&self, frequency: &Observable) -> [f64; 2] {
        let number = frequency.number();
        let value = |number: usize| {
            let observable = frequency.numbered(number);
            let measured = Measured { observable, value: 1.0, uncertainty: None };
            let measured = Measurements::of_values(vec![measured]);
            let refinements = self.refinements::<()>(&measured, COARSE).ok()?;
            let hertz = self.predicted(&measured, refinements, &[])?.values[0];
            hertz.filter(|hertz| hertz.is_finite() && *hertz > 0.0)
        };
        let Some(own) = value(number) else { return [0.0, f64::INFINITY] };
        let below = if number > 1 { value(number - 1) } else { None };
        let border = |other: f64| (own * other).sqrt();
        [below.map_or(0.0, border), value(number + 1).map_or(f64::INFINITY, border)]
    }

    /// Delays in whole samples at which the histories fit the records with free delays best.
    pub(super) fn rough_delays(
        &self,
        measured: &Measurements,
        refinements: u32,
    ) -> Option<Vec<f64>> {
        let Self::Link(own) = self else { return None };
        let mesh = halved(&own.0, &own.1, refinements)?;
        let delay = |record: &Record| {
            let link = record.with_motor(&own.0)?;
            record.rough_delay(&link, &mesh.clone().with_joint(link.joint()))
        };
        measured.records_with_free_delay().map(delay).collect()
    }

    /// Predictions for the measurements, with the delays in samples of all records with a free delay. `None` for a link
    /// without mesh or model, and for an arm with responses or records.
    pub(super) fn predicted(
        &self,
        measured: &Measurements,
        refinements: u32,
        delays: &[f64],
    ) -> Option<Prediction> {
        match self {
            Self::Link(own) => {
                measured.predicted(&own.0, &halved(&own.0, &own.1, refinements)?, delays)
            }
            Self::Arm(_) if measured.has_files() => None,
            Self::Arm(arm) => {
                let values = of_arm(arm, measured.values(), refinements).ok()?;
                Some(Prediction { values, responses: Vec::new(), records: Vec::new() })
            }
        }
    }
}

/// The mesh of a plan with its elements halved this many times.
fn halved(link: &Link, plan: &MeshPlan, halvings: u32) -> Option<Mesh> {
    let first = Mesh::new(link, plan).ok()?;
    Some((0..halvings).fold(first, |mesh, _| mesh.refined()))
}

/// Number of times that the orders are raised until this changes no value by more than the tolerance, or until they
/// cannot be raised; and the last change.
fn raised(arm: &Arm, values: &[Measured], tolerance: f64) -> Result<(u32, f64), PoseError> {
    let (mut known, mut last) = (of_arm(arm, values, 0)?, f64::INFINITY);
    for refinements in 0..MOST_REFINEMENTS {
        let finer = match of_arm(arm, values, refinements + 1) {
            Err(PoseError::TooMany { .. }) if refinements > 0 => return Ok((refinements, last)),
            finer => finer?,
        };
        let pairs = known.iter().zip(&finer);
        let changes = pairs.map(|pair| match pair {
            (Some(known), Some(finer)) if known.to_bits() == finer.to_bits() => 0.0,
            (Some(known), Some(finer)) => (known / finer - 1.0).abs(),
            // More coordinates may yield the missing mode.
            _ => f64::INFINITY,
        });
        last = changes.fold(0.0, Size::larger);
        if last <= tolerance {
            return Ok((refinements, last));
        }
        known = finer;
    }
    Ok((MOST_REFINEMENTS, last))
}

/// Predictions of an arm for each value, with the orders of its polynomials raised this many times: NaN for a mode that
/// does not vibrate, `None` for a missing mode.
fn of_arm(arm: &Arm, values: &[Measured], refinements: u32) -> Result<Vec<Option<f64>>, PoseError> {
    let modes = || values.iter().filter_map(|value| value.observable.arm_mode());
    let mut poses: Vec<&Vec<f64>> = Vec::new();
    for ArmMode { at_rad, .. } in modes() {
        if !poses.contains(&at_rad) {
            poses.push(at_rad);
        }
    }
    let springs = arm.joint_stiffnesses_n_m_rad();
    let in_pose = |at_rad: &&Vec<f64>| {
        let pose = ArmPose::of(arm, at_rad, (0.0, MORE_ORDERS * refinements as usize))?;
        let of = |joints, springs: Option<&[f64]>| {
            let own = modes().filter(|own| own.at_rad == **at_rad && own.joints == joints);
            match own.map(|own| own.mode).max() {
                None => Ok(Vec::new()),
                Some(most) => pose.modes(springs, most),
            }
        };
        Ok((of(HubEnd::Free, None)?, of(HubEnd::Held, Some(&springs))?))
    };
    let found: Vec<_> = poses.par_iter().map(in_pose).collect();
    let found = found.into_iter().collect::<Result<Vec<_>, PoseError>>()?;
    let value = |Measured { observable, .. }: &Measured| {
        let own = observable.arm_mode()?;
        let (free, held) = &found[poses.iter().position(|at_rad| **at_rad == own.at_rad)?];
        let modes = if own.joints == HubEnd::Free { free } else { held };
        let mode = modes.get(own.mode - 1)?;
        Some(if observable.is_damping() {
            mode.damping_ratio.unwrap_or(f64::NAN)
        } else if mode.square_per_s2 > 0.0 {
            mode.square_per_s2.sqrt() / TAU
        } else {
            f64::NAN
        })
    };
    Ok(values.iter().map(value).collect())
}

impl Measurements {
    /// Number of times that the elements of an automatic plan are halved for measured frequencies exact to a tolerance;
    /// 0 for other plans.
    fn halvings(
        &self,
        link: &Link,
        plan: &MeshPlan,
        tolerance: f64,
    ) -> Result<u32, ParameterError> {
        let first = Mesh::new(link, plan)?;
        if !plan.is_automatic() {
            return Ok(0);
        }
        let counts = End::ALL.map(|end| (end, self.most(end)));
        let most = counts.iter().map(|(_, count)| *count).max().unwrap_or(1);
        let mut mesh = first.clone();
        while mesh.elements().len() <= most {
            mesh = mesh.refined();
        }
        let ends =
            counts.map(|(end, count)| end.hub(link).frequencies(&mesh, count).last().copied());
        let responses = self.responses().iter().map(Response::highest_rad_s);
        let fastest = ends.into_iter().flatten().chain(responses).fold(0.0, f64::max);
        let mesh = mesh.resolving(fastest, tolerance);
        let records = self.records().iter().map(|record| record.highest_rad_s(&mesh));
        let fastest = records.fold(0.0, f64::max);
        let mesh = mesh.resolving(fastest, COARSE);
        Ok((mesh.elements().len() / first.elements().len()).ilog2())
    }

    /// Highest measured number with the hub at this end; 0 without a measurement.
    fn most(&self, end: End) -> usize {
        let own = self.values().iter().filter(|measured| measured.observable.end() == Some(end));
        own.map(|measured| measured.observable.number()).max().unwrap_or(0)
    }

    /// Predictions of a link on a mesh; `None` without a model.
    fn predicted(&self, link: &Link, mesh: &Mesh, delays: &[f64]) -> Option<Prediction> {
        let values = self.predicted_values(link, mesh);
        let plain = OnceCell::new();
        let response = |response: &Response| {
            let motor = response.motor.as_ref();
            let made = || {
                let link = with_motor(link, motor)?;
                let mesh = mesh.clone().with_joint(link.joint());
                model_of(&link, mesh, KeptModes::All).ok()
            };
            let own;
            let model = if motor.is_none() {
                plain.get_or_init(made).as_deref()?
            } else {
                own = made()?;
                &*own
            };
            Some(response.fitted(model))
        };
        let responses = self.responses().iter().map(response).collect::<Option<_>>()?;
        let mut delays = delays.iter();
        let record = |record: &Record| {
            let own = if record.is_delay_free { delays.next() } else { None };
            let link = record.with_motor(link)?;
            record.fitted(
                &link,
                &mesh.clone().with_joint(link.joint()),
                own.copied().unwrap_or(0.0),
            )
        };
        let records = self.records().iter().map(record).collect::<Option<_>>()?;
        Some(Prediction { values, responses, records })
    }

    fn predicted_values(&self, link: &Link, mesh: &Mesh) -> Vec<Option<f64>> {
        let law = DampingLaw::of(link, mesh).ok();
        let known = End::ALL.map(|end| end.hub(link).frequencies(mesh, self.most(end)));
        // Ratios up to the highest mode with a measured ratio.
        let ratios = End::ALL.map(|end| {
            let is_own = |own: &Observable| own.is_damping() && own.end() == Some(end);
            let own = self.values().iter().map(|measured| &measured.observable);
            let most = own.filter(|own| is_own(own)).map(Observable::number).max().unwrap_or(0);
            let omegas = &known[end as usize];
            let omegas = &omegas[..most.min(omegas.len())];
            match &law {
                Some(law) if most > 0 => damping_ratios((link, mesh, law), end.hub(link), omegas),
                _ => Vec::new(),
            }
        });
        let value = |Measured { observable, .. }: &Measured| {
            let (end, index) = (observable.end()? as usize, observable.number() - 1);
            match observable {
                Observable::Damping { .. } => ratios[end].get(index).copied(),
                _ => known[end].get(index).map(|omega| omega / TAU),
            }
        };
        self.values().iter().map(value).collect()
    }
}
