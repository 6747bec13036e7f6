//! An arm as one chain of elasticas: Lagrange's equations at any pose and deflection. Each joint turns its link against
//! the tip of the link before.

use super::balance::{Balance, Energies, Met, Place};
use super::chain::{Chain, coordinates};
use super::error::SimulationError;
use super::shape::{Station, direction};
use super::state::State;
use crate::link::{Arm, ArmCarriage, ArmLink};
use crate::numeric::dot;

/// Initial order of a piece's polynomials, beside one for each radian of a bending wave along it.
const FIRST_ORDER: usize = 3;

/// Highest initial order of a piece's polynomials.
const HIGHEST_ORDER: usize = 24;

/// Links one after the other.
#[derive(Debug, Clone)]
pub(super) struct Linkage {
    pub(super) links: Vec<Chain>,
    /// Number of the first coordinate of each link, the position of its joint, then that of an arm's carriage.
    pub(super) joints: Vec<usize>,
    pub(super) carriage: Option<ArmCarriage>,
    pub(super) friction_n_m_s_rad: Vec<f64>,
    pub(super) gravity_m_s2: [f64; 2],
    pub(super) count: usize,
    pub(super) stiffness: Vec<f64>,
    pub(super) damping: Vec<f64>,
}

/// Order of the polynomials on a piece of a numbered link, from its ends in m, its mean stiffness in N m² and its mean
/// mass in kg/m.
fn orders(
    highest_rad_s: f64,
    more: usize,
    state: Option<&State>,
) -> impl Fn(usize, [f64; 2], [f64; 2]) -> usize {
    move |number, ends_m, [stiffness_n_m2, mass_kg_m]| {
        let square = mass_kg_m / stiffness_n_m2 * highest_rad_s * highest_rad_s;
        let wave_rad = (ends_m[1] - ends_m[0]) * square.sqrt().sqrt();
        let places = state.map_or(0, |state| state.links[number].piece(ends_m).len());
        let order = (FIRST_ORDER + wave_rad.ceil() as usize).min(HIGHEST_ORDER);
        order.max(places.saturating_sub(1)) + more
    }
}

impl Linkage {
    /// An undamped arm with polynomials for bending waves up to a frequency, `more` orders beyond these, and for a
    /// state.
    pub(super) fn of(arm: &Arm, highest_rad_s: f64, more: usize, state: Option<&State>) -> Self {
        let order = orders(highest_rad_s, more, state);
        let chain =
            |(number, own): (usize, &ArmLink)| Chain::of(&own.link, |e, m| order(number, e, m));
        let links: Vec<Chain> = arm.links().iter().enumerate().map(chain).collect();
        let mut joints = Vec::new();
        let mut count = 0;
        for link in &links {
            joints.push(count);
            count += link.count;
        }
        let carriage = arm.carriage().copied();
        if carriage.is_some() {
            joints.push(count);
            count += 1;
        }
        let mut linkage = Self {
            joints,
            carriage,
            friction_n_m_s_rad: arm.joints().map(|own| own.friction()).collect(),
            gravity_m_s2: arm.gravity_m_s2(),
            count,
            stiffness: Vec::new(),
            damping: vec![0.0; count * count],
            links,
        };
        linkage.stiffness = linkage.gathered(linkage.links.iter().map(|link| &link.stiffness[..]));
        linkage
    }

    /// Number of coordinates of [`of`](Self::of), computed without its matrices.
    pub(super) fn coordinates(
        arm: &Arm,
        highest_rad_s: f64,
        more: usize,
        state: Option<&State>,
    ) -> usize {
        let order = orders(highest_rad_s, more, state);
        let links = arm.links().iter().enumerate();
        let links = links.map(|(number, own)| coordinates(&own.link, |e, m| order(number, e, m)));
        links.sum::<usize>() + usize::from(arm.carriage().is_some())
    }

    /// Place of the first axis, which the carriage moves.
    pub(super) fn base(&self, q: &[f64], rates: &[f64]) -> Place {
        let mut base = Place::fixed(self.count);
        if let Some(ArmCarriage { axis, .. }) = self.carriage {
            let last = self.count - 1;
            base.at_m = axis.map(|part| part * q[last]);
            base.rate_m_s = axis.map(|part| part * rates[last]);
            base.by.iter_mut().zip(axis).for_each(|(by, part)| by[last] = part);
        }
        base
    }

    /// The stiffness of each link times its factor.
    pub(super) fn scaled_stiffness(&self, factors: &[f64]) -> Vec<f64> {
        let links = self.links.iter().zip(factors);
        let scaled = links.map(|(link, factor)| {
            link.stiffness.iter().map(|entry| factor * entry).collect::<Vec<f64>>()
        });
        let scaled: Vec<_> = scaled.collect();
        self.gathered(scaled.iter().map(Vec::as_slice))
    }

    /// Adds a damping matrix for each link.
    pub(super) fn damped(self, of_links: &[Vec<f64>]) -> Self {
        Self { damping: self.gathered(of_links.iter().map(Vec::as_slice)), ..self }
    }

    /// Combines matrices of the links into one matrix.
    fn gathered<'a>(&self, of_links: impl Iterator<Item = &'a [f64]>) -> Vec<f64> {
        let mut whole = vec![0.0; self.count * self.count];
        for ((own, link), first) in of_links.zip(&self.links).zip(&self.joints) {
            for (i, row) in own.chunks_exact(link.count).enumerate() {
                whole[(first + i) * self.count + first..][..link.count].copy_from_slice(row);
            }
        }
        whole
    }

    /// A copy of the arm with a share of its weight.
    pub(super) fn weighing(&self, share: f64) -> Self {
        Self { gravity_m_s2: self.gravity_m_s2.map(|part| share * part), ..self.clone() }
    }

    /// Walks all links from the first joint outward; returns the outer end of each, of one link its output.
    pub(super) fn walk(
        &self,
        q: &[f64],
        rates: &[f64],
        mut meet: impl FnMut(&Place, &Met<'_>),
    ) -> Vec<Place> {
        let mut ends: Vec<Place> = Vec::with_capacity(self.links.len());
        let (base, mut before) = (self.base(q, rates), Vec::new());
        if let Some(ArmCarriage { carriage, .. }) = self.carriage {
            meet(&base, &Met::Mass(carriage.mass_kg));
        }
        for (link, first) in self.links.iter().zip(&self.joints) {
            let (mut end, mut turned) = (Place::default(), Vec::new());
            let axis = ends.last().unwrap_or(&base);
            link.walk_on(axis, (&before, *first), (q, rates), &mut |place: &Place, met| {
                if let Met::End(by) = met {
                    end.clone_from(place);
                    turned = by.to_vec();
                } else {
                    meet(place, &met);
                }
            });
            ends.push(end);
            before = turned;
        }
        ends
    }

    /// The equations at coordinates and rates, without the joints' torques.
    pub(super) fn balance(&self, q: &[f64], rates: &[f64], into: &mut Balance) {
        into.begin(&self.stiffness, &self.damping, (q, rates));
        self.walk(q, rates, |place, met| into.meet(place, met, self.gravity_m_s2));
        into.end();
    }

    /// The outer end of each link; kinetic energy, and that of strain and weight.
    pub(super) fn ends_and_energies(&self, q: &[f64], rates: &[f64]) -> (Vec<Place>, Energies) {
        let rows = self.stiffness.chunks_exact(self.count).zip(q);
        let strain_j = 0.5 * rows.map(|(row, own)| own * dot(row, q)).sum::<f64>();
        let mut energies = Energies::of_strain(strain_j);
        let ends = self.walk(q, rates, |place, met| {
            energies.meet(place, met, (rates, self.gravity_m_s2));
        });
        (ends, energies)
    }

    /// Lets the damping turn with the reference of the first joint at a rate in rad/s.
    pub(super) fn turn(&self, turning_rad_s: f64, into: &mut Balance) {
        let drags = self.damping.iter().step_by(self.count);
        into.force.iter_mut().zip(drags).for_each(|(force, drag)| *force += drag * turning_rad_s);
    }

    /// Power in W that damping and friction dissipate, the damping turning with a reference at a rate in rad/s.
    pub(super) fn lost_w(&self, rates: &[f64], turning_rad_s: f64) -> f64 {
        let rows = self.damping.chunks_exact(self.count).zip(rates);
        let rows = rows.map(|(row, own)| own * (dot(row, rates) - row[0] * turning_rad_s));
        let damped: f64 = rows.sum();
        let joints = self.joints.iter().zip(&self.friction_n_m_s_rad);
        damped + joints.map(|(joint, b)| b * rates[*joint] * rates[*joint]).sum::<f64>()
    }

    /// Direction of each link's chord in rad, from the ends of the links. It is within half a turn of the root's
    /// direction plus `bent_rad`; `bent_rad` becomes the chord's new bend.
    pub(super) fn chords_rad(&self, q: &[f64], ends: &[Place], bent_rad: &mut [f64]) -> Vec<f64> {
        let (base_m, axis_m) = (self.base(q, q).at_m, self.links[0].axis_m(q));
        let mut from_m = [0, 1].map(|axis| base_m[axis] + axis_m[axis]);
        let roots_rad = self.links.iter().zip(self.of_links(q)).map(|(link, q)| link.root_rad(&q));
        let chord = |((end, root_rad), bent_rad): ((&Place, f64), &mut f64)| {
            let along = [0, 1].map(|axis| end.at_m[axis] - from_m[axis]);
            from_m = end.at_m;
            let chord_rad = direction(along, root_rad + *bent_rad);
            *bent_rad = chord_rad - root_rad;
            chord_rad
        };
        ends.iter().zip(roots_rad).zip(bent_rad).map(chord).collect()
    }

    /// Size of a joint's position: 1 rad, of an arm's carriage the length of the arm in m.
    pub(super) fn size_of(&self, joint: usize) -> f64 {
        if joint < self.links.len() { 1.0 } else { self.length_m() }
    }

    /// Length in m of the stretched links up to the output.
    pub(super) fn length_m(&self) -> f64 {
        self.links.iter().map(|link| link.output_m).sum()
    }

    /// Coordinates, or rates, of each link alone: its root's direction against x, or its carriage's position, then its
    /// slopes.
    pub(super) fn of_links(&self, q: &[f64]) -> Vec<Vec<f64>> {
        let mut turned = 0.0;
        let of_link = |(link, first): (&Chain, &usize)| {
            let mut coordinates = q[*first..][..link.count].to_vec();
            coordinates[0] += turned;
            turned = coordinates[0] + link.end(&coordinates);
            coordinates
        };
        self.links.iter().zip(&self.joints).map(of_link).collect()
    }

    /// x and y in m of places on the links; `stations` has the places of each link.
    pub(super) fn places_m(&self, stations: &[Vec<Station>], q: &[f64]) -> Vec<Vec<[f64; 2]>> {
        let ends = self.walk(q, &vec![0.0; self.count], |_, _| {});
        let joints_m = std::iter::once(self.base(q, q).at_m).chain(ends.iter().map(|end| end.at_m));
        let links = self.links.iter().zip(stations).zip(self.of_links(q)).zip(joints_m);
        let of_link =
            |(((link, stations), own), joint_m): (((&Chain, &Vec<Station>), _), [f64; 2])| {
                let own: Vec<f64> = own;
                let places = link.places_m(stations, &own).into_iter();
                places.map(|[x, y]| [joint_m[0] + x, joint_m[1] + y]).collect()
            };
        links.map(of_link).collect()
    }

    /// Turn of the links at stations by these coordinates, to first order.
    pub(super) fn turns(&self, stations: &[Vec<Station>], q: &[f64]) -> Vec<Vec<f64>> {
        let links = self.links.iter().zip(stations).zip(self.of_links(q));
        links.map(|((link, stations), own)| link.turns(stations, &own)).collect()
    }

    /// Stations at distances in m from the joint of each link, for places from coordinates.
    pub(super) fn stations(&self, along_m: &[Vec<f64>]) -> Vec<Vec<Station>> {
        self.links.iter().zip(along_m).map(|(link, own)| link.stations(own)).collect()
    }

    /// Coordinates of the arm from those of each link alone.
    fn of_each(&self, links: &[Vec<f64>], carriage: Option<f64>) -> Vec<f64> {
        let (mut q, mut turned) = (Vec::with_capacity(self.count), 0.0);
        for (link, own) in self.links.iter().zip(links) {
            q.push(own[0] - turned);
            q.extend_from_slice(&own[1..]);
            turned = own[0] + link.end(own);
        }
        q.extend(self.carriage.map(|_| carriage.unwrap_or(0.0)));
        q
    }

    /// Place and motion of the arm.
    pub(super) fn state(&self, time_s: f64, q: &[f64], rates: &[f64]) -> State {
        let own = self.of_links(q).into_iter().zip(self.of_links(rates));
        let links = self.links.iter().zip(own);
        let links = links.map(|(link, (q, rates))| link.state(time_s, &q, &rates)).collect();
        let last = self.count - 1;
        State { links, carriage: self.carriage.map(|_| [q[last], rates[last]]) }
    }

    /// Coordinates and rates of a state.
    ///
    /// # Errors
    /// [`SimulationError::State`].
    pub(super) fn of_state(&self, state: &State) -> Result<(Vec<f64>, Vec<f64>), SimulationError> {
        let links = self.links.iter().zip(&state.links).map(|(link, own)| link.of_state(own));
        let links: Vec<(Vec<f64>, Vec<f64>)> = links.collect::<Result<_, _>>()?;
        let (q, rates): (Vec<_>, Vec<_>) = links.into_iter().unzip();
        let [at_m, rate_m_s] = [0, 1].map(|part: usize| state.carriage.map(|own| own[part]));
        Ok((self.of_each(&q, at_m), self.of_each(&rates, rate_m_s)))
    }
}

impl Chain {
    /// Slope of the outer end against the root.
    fn end(&self, q: &[f64]) -> f64 {
        self.pieces.last().map_or(0.0, |piece| q[piece.outer()])
    }
}
