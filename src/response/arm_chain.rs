//! An arm as one chain of elasticas, each turned by its joint against the tip of the one before: Lagrange's equations
//! at any pose and deflection.

use super::arm::MovedArmError;
use super::balance::{Balance, Met, Place};
use super::chain::Chain;
use crate::link::{Arm, Damping};

/// Order of the polynomials of a piece at first, beside one for each radian of a bending wave along it.
const FIRST_ORDER: usize = 3;

/// Highest order of the polynomials of a piece at first.
const HIGHEST_ORDER: usize = 24;

/// Links one after the other.
pub(super) struct ArmChain {
    pub(super) links: Vec<Chain>,
    /// Number of the first coordinate of each link: the angle of its joint.
    pub(super) joints: Vec<usize>,
    pub(super) friction_n_m_s_rad: Vec<f64>,
    pub(super) gravity_m_s2: [f64; 2],
    pub(super) count: usize,
    pub(super) stiffness: Vec<f64>,
    pub(super) damping: Vec<f64>,
}

impl ArmChain {
    pub(super) fn of(arm: &Arm, highest_rad_s: f64, more: usize) -> Result<Self, MovedArmError> {
        let order = |[from_m, end_m]: [f64; 2], [stiffness_n_m2, mass_kg_m]: [f64; 2]| {
            let square = mass_kg_m / stiffness_n_m2 * highest_rad_s * highest_rad_s;
            let wave_rad = (end_m - from_m) * square.sqrt().sqrt();
            (FIRST_ORDER + wave_rad.ceil() as usize).min(HIGHEST_ORDER) + more
        };
        let links: Vec<Chain> = arm.links().iter().map(|own| Chain::of(&own.link, order)).collect();
        let mut joints = Vec::new();
        let mut count = 0;
        for link in &links {
            joints.push(count);
            count += link.count;
        }
        let mut stiffness = vec![0.0; count * count];
        let mut damping = stiffness.clone();
        for ((chain, own), first) in links.iter().zip(arm.links()).zip(&joints) {
            let beta_s = match own.link.damping() {
                Damping::Rayleigh { alpha_per_s: 0.0, beta_s } => *beta_s,
                Damping::None | Damping::Hysteretic { ratio: 0.0 } => 0.0,
                _ => return Err(MovedArmError::Damping),
            };
            for i in 0..chain.count {
                for j in 0..chain.count {
                    let (entry, at) =
                        (chain.stiffness[i * chain.count + j], (first + i) * count + first + j);
                    stiffness[at] = entry;
                    damping[at] = beta_s * entry;
                }
            }
        }
        let frictions = arm.links().iter().map(|own| own.link.joint().friction_n_m_s_rad);
        Ok(Self {
            links,
            joints,
            friction_n_m_s_rad: frictions.collect(),
            gravity_m_s2: arm.gravity_m_s2(),
            count,
            stiffness,
            damping,
        })
    }

    /// Walks all links from the first joint outward; returns the tip.
    pub(super) fn walk(
        &self,
        q: &[f64],
        rates: &[f64],
        mut meet: impl FnMut(&Place, &Met<'_>),
    ) -> Place {
        let (mut axis, mut before) = (Place::fixed(self.count), Vec::new());
        for (link, first) in self.links.iter().zip(&self.joints) {
            let (mut end, mut turned) = (axis.clone(), Vec::new());
            link.walk_on(&axis, (&before, *first), (q, rates), &mut |place: &Place, met| {
                if let Met::End(by) = met {
                    end.clone_from(place);
                    turned = by.to_vec();
                } else {
                    meet(place, &met);
                }
            });
            (axis, before) = (end, turned);
        }
        axis
    }

    pub(super) fn balance(&self, q: &[f64], rates: &[f64], into: &mut Balance) {
        into.begin(&self.stiffness, &self.damping, (q, rates));
        self.walk(q, rates, |place, met| into.meet(place, met, self.gravity_m_s2));
        into.end();
    }
}
