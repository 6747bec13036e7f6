//! One link whose tip stays on its chord: its answers to the chord's motion, to loads, and to a next link; the
//! bands of frequencies and the changes of its iteration.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rayon::prelude::*;

use super::chord::{ChordHistories, ChordPeriod, resolved};
use super::error::ElasticaError;
use super::loads::{BentLink, SecondOrder};
use super::reaction::{ElasticaMotion, Straight, band, softest};
use super::sag::Sag;
use crate::beam::{LoadedMotion, Loads};
use crate::link::Link;
use crate::modal::{DampingLaw, WeighedLink};
use crate::model::{KeptModes, Model};
use crate::numeric::FourierPair;
use crate::system::end_if_stopped;

/// Share of the torque's amplitudes, all added up, that is round-off in shapes and moments.
const ROUND_OFF: f64 = 1e-12;

/// A link whose tip stays on a chord, and the influences on it.
pub(super) struct LinkOnChord<'a> {
    pub(super) model: &'a dyn Model,
    pub(super) chord: &'a ChordPeriod,
    /// Damping ratio ξ and sag, if a hysteretic link has weight.
    pub(super) sag: Option<(f64, &'a Sag)>,
    /// The link with the weight along it, if it keeps its direction.
    pub(super) weighed: Option<&'a WeighedLink>,
    /// Friction of a hub against a fixed base, in N m s/rad.
    pub(super) friction_n_m_s_rad: f64,
    /// Amplitude of a torque in N m below which it may be round-off of the next link's load.
    pub(super) round_off_n_m: f64,
}

impl LinkOnChord<'_> {
    /// Motion of the link at a bin, and forces on its nodes, including those of its sag.
    pub(super) fn moved(&self, bin: usize, mut nodal: Vec<[Complex64; 2]>) -> Loads<Complex64> {
        let axis_m_s2 = self.chord.across[bin];
        if let Some(tip) = &self.chord.tip {
            let last = nodal.len() - 1;
            nodal[last][0] += tip.across_n[bin];
            nodal[last][1] -= tip.torque_n_m[bin];
        }
        if let Some((ratio, sag)) = self.sag.filter(|_| bin > 0) {
            sag.add(bin, Complex64::new(0.0, 2.0 * ratio), &mut nodal);
        }
        Loads { axis_m_s2, chord_rad_s2: self.chord.turning[bin], nodal }
    }

    /// Linear answer to the motion at each bin, without loads.
    pub(super) fn linear(&self) -> Result<Vec<LoadedMotion<Complex64>>, ElasticaError> {
        let nodes = self.model.mesh().nodes_m().len();
        let band = self.chord.band_len(self.model.mesh().length_m());
        let answers: Vec<_> = (0..band)
            .into_par_iter()
            .map(|bin| {
                end_if_stopped();
                let loads = self.moved(bin, vec![[Complex64::ZERO; 2]; nodes]);
                self.model.loaded_motion(self.chord.omega_rad_s(bin), &loads)
            })
            .collect();
        let mesh = self.model.mesh();
        // With damping a payload's inertia blocks no frequency completely.
        let is_undamped = is_undamped(self.model.law());
        let is_lost = |bin: &usize| {
            let tip = || self.model.tip_transfer(self.chord.omega_rad_s(*bin));
            !answers[*bin].torque_n_m.is_finite() || is_undamped && tip().is_blocked(mesh)
        };
        match (0..band).find(is_lost) {
            Some(bin) => {
                Err(ElasticaError::NotFinite { frequency_hz: self.chord.omega_rad_s(bin) / TAU })
            }
            None => Ok(answers),
        }
    }

    /// Histories of (w, w') of each node, then of their derivatives up to `orders`.
    pub(super) fn histories(
        &self,
        answers: &[LoadedMotion<Complex64>],
        orders: usize,
        pair: &FourierPair,
    ) -> Vec<Vec<f64>> {
        let width = 2 * self.model.mesh().nodes_m().len();
        (0..orders * width)
            .into_par_iter()
            .map(|column| {
                end_if_stopped();
                self.history(answers, column % width, column / width, pair)
            })
            .collect()
    }

    /// History of w or w' of a node, or of a derivative of it.
    fn history(
        &self,
        answers: &[LoadedMotion<Complex64>],
        dof: usize,
        order: usize,
        pair: &FourierPair,
    ) -> Vec<f64> {
        let omega = |bin: usize| Complex64::new(0.0, self.chord.omega_rad_s(bin));
        let amplitudes = answers.iter().enumerate().map(|(bin, answer)| {
            let amplitude = answer.deflections[dof / 2][dof % 2];
            (0..order).fold(amplitude, |derived, _| derived * omega(bin))
        });
        pair.samples(amplitudes.collect::<Vec<_>>())
    }

    /// The linear answers plus the answers to loads, where the loads have no alias. A weighed link moves with its weight.
    pub(super) fn with_loads(
        &self,
        linear: &[LoadedMotion<Complex64>],
        loads: &[Vec<f64>],
        pair: &FourierPair,
    ) -> Vec<LoadedMotion<Complex64>> {
        let spectra: Vec<_> = loads.par_iter().map(|history| pair.amplitudes(history)).collect();
        let at = |bin: usize| {
            end_if_stopped();
            let nodal = spectra.chunks(2).map(|node| [node[0][bin], node[1][bin]]).collect();
            let (omega_rad_s, loads) = (self.chord.omega_rad_s(bin), self.moved(bin, nodal));
            match self.weighed {
                Some(weighed) => {
                    let factors = self.model.law().factors(omega_rad_s);
                    weighed.loaded_motion(omega_rad_s, factors, &loads)
                }
                None => self.model.loaded_motion(omega_rad_s, &loads),
            }
        };
        let mut answers: Vec<_> = (0..resolved(pair)).into_par_iter().map(at).collect();
        answers.extend(linear.iter().skip(answers.len()).cloned());
        answers
    }

    /// Torque, and angle of the hub from the chord, at the samples of a pair; force, and displacement of a carriage from
    /// the chord. With all terms, the hub turns by the angle of its slope:
    ///
    /// ```text
    /// T = (T_l − I_H(θ̈ + ẅ'_0)) cos ψ + I_H(θ̈ + ψ̈) + b(θ̇ + ψ̇),       ψ = asin w'_0
    /// ```
    pub(super) fn hub(
        &self,
        answers: &[LoadedMotion<Complex64>],
        second_order: SecondOrder,
        pair: &FourierPair,
        chord: &ChordHistories,
    ) -> (Vec<f64>, Vec<f64>) {
        let (joint, friction) = (self.model.mesh().joint(), self.friction_n_m_s_rad);
        let (inertia, slides) = (joint.inertia(), joint.slides());
        let torque: Vec<_> = answers.iter().map(|answer| answer.torque_n_m).collect();
        let mut torque_n_m = pair.samples(torque);
        let slopes = [0, 1, 2].map(|order| {
            let amplitudes = answers.iter().enumerate().map(|(bin, answer)| {
                answer.hub_slope_rad * Complex64::new(0.0, self.chord.omega_rad_s(bin)).powu(order)
            });
            pair.samples(amplitudes.collect::<Vec<_>>())
        });
        let mut hub_slope_rad = slopes[0].clone();
        for (k, torque) in torque_n_m.iter_mut().enumerate() {
            let [sine, rate, acceleration] = [slopes[0][k], slopes[1][k], slopes[2][k]];
            let mut hub_rate = rate;
            if second_order == SecondOrder::Full && !slides {
                let cosine = (1.0 - sine * sine).sqrt();
                let turning =
                    acceleration / cosine + sine * rate * rate / (cosine * cosine * cosine);
                let turned = chord.acceleration_rad_s2[k];
                *torque = (*torque - inertia * (turned + acceleration)) * cosine
                    + inertia * (turned + turning);
                hub_slope_rad[k] = libm::asin(sine);
                hub_rate = rate / cosine;
            }
            *torque += friction * (chord.rate_rad_s[k] + hub_rate);
        }
        (torque_n_m, hub_slope_rad)
    }

    /// Place of a carriage from the chord, in N of a force that bends the link so far; `None` for a hub.
    pub(super) fn place(&self, displacement_m: Vec<f64>) -> Option<Vec<f64>> {
        let mesh = self.model.mesh();
        let stiffness_n_m = softest(mesh) / mesh.length_m().powi(3);
        let of_force = displacement_m.into_iter().map(|place| stiffness_n_m * place);
        mesh.joint().slides().then(|| of_force.collect())
    }

    /// Force on the root along the chord and across it in N, without second order, at the chord's samples.
    ///
    /// ```text
    /// F_e = m a·e − S θ̇² − P_e,       S = Σ m s
    /// ```
    ///
    /// P is the force on the tip.
    pub(super) fn linear_ends(&self, answers: &[LoadedMotion<Complex64>]) -> [Vec<f64>; 2] {
        let link = BentLink::of(self.model, SecondOrder::None).straight();
        let chord = &self.chord.histories;
        let along = (0..self.chord.len()).map(|k| {
            let rate = chord.rate_rad_s[k];
            let on_tip = chord.tip.as_ref().map_or(0.0, |tip| tip.along_n[k]);
            link.mass_kg * chord.along_m_s2[k] - link.moment_kg_m * rate * rate - on_tip
        });
        [along.collect(), self.chord.pair.samples(self.across_n(&link, answers))]
    }

    /// Force on the root across the chord in N at each bin, for the linear link with these answers.
    ///
    /// ```text
    /// F_n = m a·n + S θ̈ + Σ m ẅ − P_n
    /// ```
    pub(super) fn across_n(
        &self,
        link: &Straight,
        answers: &[LoadedMotion<Complex64>],
    ) -> Vec<Complex64> {
        let tip = self.chord.tip.as_ref();
        let at = |(bin, answer): (usize, &LoadedMotion<Complex64>)| {
            let nodes = answer.deflections.iter().zip(&link.across_kg);
            let bent: Complex64 = nodes.map(|(node, kg)| node[0] * kg[0] + node[1] * kg[1]).sum();
            let omega = self.chord.omega_rad_s(bin);
            let (axis, turning) = (self.chord.across[bin], self.chord.turning[bin]);
            let on_tip = tip.map_or(Complex64::ZERO, |tip| tip.across_n[bin]);
            link.mass_kg * axis + link.moment_kg_m * turning - omega * omega * bent - on_tip
        };
        answers.iter().enumerate().map(at).collect()
    }

    /// Histories of these answers at the samples of a pair over the chord's period. With `nodes`, histories of other
    /// nodes are empty, except for the tip's slope. Without a node, shapes and largest slope are not computed.
    pub(super) fn motion(
        &self,
        answers: &[LoadedMotion<Complex64>],
        second_order: SecondOrder,
        (pair, nodes): (&FourierPair, Option<&[usize]>),
    ) -> ElasticaMotion {
        let (torque_n_m, hub_slope_rad) =
            self.hub(answers, second_order, pair, &self.chord.at(pair));
        let is_wanted = |node: usize| nodes.is_none_or(|nodes| nodes.contains(&node));
        let width = 2 * self.model.mesh().nodes_m().len();
        let deflections = (0..width).into_par_iter().map(|dof| {
            let is_wanted = dof == width - 1 || is_wanted(dof / 2);
            if is_wanted { self.history(answers, dof, 0, pair) } else { Vec::new() }
        });
        let deflections = deflections.collect();
        let ([shortenings_m, moments_n_m], largest_slope) = match nodes {
            Some([]) => <_>::default(),
            _ => self.shapes(answers, second_order, (pair, is_wanted)),
        };
        ElasticaMotion {
            torque_n_m,
            hub_slope_rad,
            deflections,
            shortenings_m,
            moments_n_m,
            largest_slope,
        }
    }

    /// Shortening and bending moment of each node in turn, empty if not wanted, and the largest slope. They are
    /// computed at as many samples as products of deflections need, then interpolated to the samples of a pair.
    pub(super) fn shapes(
        &self,
        answers: &[LoadedMotion<Complex64>],
        second_order: SecondOrder,
        (whole, is_wanted): (&FourierPair, impl Fn(usize) -> bool + Sync),
    ) -> ([Vec<Vec<f64>>; 2], f64) {
        let (link, band) = (
            BentLink::of(self.model, second_order),
            band(answers, ROUND_OFF, (self.model.mesh(), self.round_off_n_m)),
        );
        let pair = self.chord.pair_for(band);
        let chord = self.chord.at(&pair);
        let histories = self.histories(&answers[..band], 3, &pair);
        let states = (&histories[..], &chord);
        let columns = 2 * self.model.mesh().nodes_m().len();
        let (shapes, largest_slope) = link
            .at_each_instant(columns, states, |now, scratch, row| link.shape(now, scratch, row));
        let all = |(column, few): (usize, Vec<f64>)| match pair.len() {
            _ if !is_wanted(column / 2) => Vec::new(),
            len if len == whole.len() => few,
            // A link that bends very little has no shortening.
            _ if few.iter().all(|own| *own == 0.0) => vec![0.0; whole.len()],
            _ => whole.samples(pair.amplitudes(few)),
        };
        let nodes = shapes.into_par_iter().enumerate().map(all).collect::<Vec<_>>();
        let mut parts = [Vec::new(), Vec::new()];
        nodes.into_iter().enumerate().for_each(|(k, history)| parts[k % 2].push(history));
        (parts, largest_slope)
    }

    /// Number of bins up to the last one whose torque counts for the second order.
    ///
    /// # Errors
    /// [`ElasticaError::LongStep`] if the samples do not resolve them.
    pub(super) fn band_of_loads(
        &self,
        answers: &[LoadedMotion<Complex64>],
        negligible: f64,
    ) -> Result<usize, ElasticaError> {
        let band = band(answers, negligible, (self.model.mesh(), self.round_off_n_m));
        let most = (self.chord.len() / 4).max(2);
        let share = FINER * most as f64 / band as f64;
        if band < most { Ok(band) } else { Err(long_step(self.chord.step_s, share)) }
    }
}

/// True if a law takes no energy.
pub(super) fn is_undamped(law: &DampingLaw) -> bool {
    matches!(
        law,
        DampingLaw::Hysteretic { ratio: 0.0 }
            | DampingLaw::Rayleigh { alpha_per_s: 0.0, beta_s: 0.0 }
    )
}

/// Limit of iterations, even if they still converge.
pub(super) const MOST_ITERATIONS: usize = 100;

/// Largest share that an iteration leaves out. These terms grow with the square of the frequency, so that a larger share
/// may converge where a smaller one does not.
const MOST_NEGLIGIBLE: f64 = 1e-3;

/// Ratio of an iteration's change to the change before, above which a narrower band is tried, which may converge.
const SLOW: f64 = 0.9;

/// Number of bins of the loads over the number of bins of their deflections: products of three reach as far.
pub(super) const REACH: usize = 3;

/// Share of the longest resolved step that an error message suggests: more samples show faster parts of the motion.
/// With 0.7, most of 60 coarse paths were refused again.
const FINER: f64 = 0.2;

/// Share of a refused step that an error message suggests if the motion reaches the Nyquist frequency: a least-jerk
/// motion of 25 samples needs it.
pub(super) const OF_NYQUIST: f64 = 0.1;

/// The motion over the widest band of loads that converges and that the samples resolve, with levels from the widest to
/// the narrowest. Its error includes the change to the next narrower band, except for the widest level. Errors that are
/// not `of_band` do not lead to a narrower band.
pub(super) fn over_widest_band<L: Copy, T>(
    levels: &[L],
    iterated: impl Fn(L) -> Result<T, ElasticaError>,
    of_band: impl Fn(&ElasticaError) -> bool,
    add_error: impl Fn(&mut T, T),
) -> Result<T, ElasticaError> {
    let is_of_band = |error: &ElasticaError| {
        matches!(error, ElasticaError::Diverges { .. }) || error.is_of_step() && of_band(error)
    };
    let mut refused = ElasticaError::Diverges { iterations: 0, change: f64::NAN };
    for (number, level) in levels[..levels.len() - 1].iter().enumerate() {
        match iterated(*level) {
            Ok(motion) if number == 0 => return Ok(motion),
            Ok(mut motion) => match iterated(levels[number + 1]) {
                Ok(narrower) => {
                    add_error(&mut motion, narrower);
                    return Ok(motion);
                }
                Err(error) if is_of_band(&error) => refused = error,
                Err(error) => return Err(error),
            },
            Err(error) if is_of_band(&error) => refused = error,
            Err(error) => return Err(error),
        }
    }
    Err(refused)
}

/// Ratio of an iteration's change to the change before.
///
/// # Errors
/// [`ElasticaError::Diverges`] if the changes do not fall, or not fast enough for this band.
pub(super) fn factor_of(
    [last, change]: [f64; 2],
    iterations: usize,
    (tolerance, negligible): (f64, f64),
) -> Result<f64, ElasticaError> {
    let factor = if change == 0.0 { 0.0 } else { change / last };
    let most = if negligible < MOST_NEGLIGIBLE { SLOW } else { 1.0 };
    if !change.is_finite() || iterations > 3 && factor >= most && change > tolerance {
        return Err(ElasticaError::Diverges { iterations, change });
    }
    Ok(factor)
}

/// Sum of the changes by all further iterations, if each is `factor` times the one before.
pub(super) fn further(change: f64, factor: f64) -> f64 {
    change * factor / (1.0 - factor).max(0.01)
}

/// Refuses samples too far apart, and links that are not derived. `is_exact` means weight, second order or further
/// links, for which fewer links are derived.
pub(super) fn check(
    model: &dyn Model,
    chord: &ChordPeriod,
    is_exact: bool,
) -> Result<(), ElasticaError> {
    if chord.reaches_nyquist(model.mesh().length_m()) {
        return Err(long_step(chord.step_s, OF_NYQUIST));
    }
    if model.kept_modes() != KeptModes::All {
        let what = "the link is reduced to its first modes (analysis.modes)";
        return Err(ElasticaError::NotDerived { what, known: "with all modes" });
    }
    let underived = underived(model.link(), model.law(), is_exact);
    underived.map_or(Ok(()), |[what, known]| Err(ElasticaError::NotDerived { what, known }))
}

/// Names the property of a link for which no second-order terms are derived, and what is possible instead. Without
/// `is_exact` it checks drag alone.
pub(crate) fn underived(
    link: &Link,
    law: &DampingLaw,
    is_exact: bool,
) -> Option<[&'static str; 2]> {
    if is_exact && link.segments().iter().any(|segment| segment.timoshenko.is_some()) {
        Some(["the link has shear and rotary inertia", "without them"])
    } else if law.mass_rate_per_s() != 0.0 {
        Some(["the damping drags every mass (alpha)", "with alpha = 0"])
    } else if is_exact && law.is_modal() {
        Some(["the damping is set mode by mode", "with hysteretic or rayleigh damping"])
    } else {
        None
    }
}

/// Error for a step, with about this share of it as a remedy.
pub(super) fn long_step(step_s: f64, share: f64) -> ElasticaError {
    ElasticaError::LongStep { step_s, most_s: share * step_s }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::beam::{Mesh, MeshPlan};
    use crate::elastica::chord::TipLoad;
    use crate::elastica::loads::Place;
    use crate::elastica::points::dot;
    use crate::link::{Hub, Link, LumpedMass, Payload, Segment};
    use crate::model::{KeptModes, model_of};

    #[test]
    fn forces_from_amplitudes_are_those_of_all_masses_at_each_instant() {
        let link = Link::builder()
            .segment(Segment::uniform(0.7, 6.0, 0.8))
            .hub(Hub { inertia_kg_m2: 0.1, radius_m: 0.05, viscous_friction_n_m_s_rad: 0.0 })
            .mass(LumpedMass { at_m: 0.35, mass_kg: 0.2, inertia_kg_m2: 1e-3 })
            .payload(Payload { mass_kg: 0.3, inertia_kg_m2: 2e-3, offset_m: 0.04 })
            .damping_ratio(0.02)
            .build()
            .unwrap();
        let mesh = Mesh::new(&link, &MeshPlan::automatic(&link)).unwrap();
        let model = model_of(&link, mesh, KeptModes::All).unwrap();
        let history = |amplitude: f64, turns: f64| -> Vec<f64> {
            let angle = |k: usize| TAU * turns * k as f64 / 64.0;
            (0..64).map(|k| amplitude * libm::cos(angle(k) + amplitude)).collect()
        };
        let motion = [history(0.4, 1.0), history(1.7, 1.0), history(9.0, 2.0)];
        let [angle_rad, rate_rad_s, acceleration_rad_s2] = motion;
        let gravity = |across: f64| {
            let part = |angle: &f64| 9.81 * libm::sin(angle + across) - libm::cos(angle + across);
            angle_rad.iter().map(part).collect()
        };
        let histories = ChordHistories {
            rate_rad_s,
            acceleration_rad_s2,
            along_m_s2: gravity(0.0),
            across_m_s2: gravity(FRAC_PI_2),
            tip: None,
        };
        let mut chord = ChordPeriod::of(FourierPair::new(64), 0.01, angle_rad, histories);
        chord.load_tip(TipLoad {
            along_n: history(3.0, 1.0),
            across_n: history(-5.0, 3.0),
            torque_n_m: history(0.7, 2.0),
        });
        let on_chord = LinkOnChord {
            model: &*model,
            chord: &chord,
            sag: None,
            weighed: None,
            friction_n_m_s_rad: 0.0,
            round_off_n_m: 0.0,
        };
        let answers = on_chord.linear().unwrap();
        let all_of = |bent: &BentLink| {
            let histories = on_chord.histories(&answers, 3, &chord.pair);
            let states = (&histories[..], &chord.histories);
            let all = bent.at_each_instant(2, states, |now, scratch, row| {
                bent.place(now, scratch);
                row.copy_from_slice(&[-now.tip.along_n, -now.tip.across_n]);
                let mut add = |place: &Place, mass_kg: f64, w_acceleration: f64| {
                    let needed = bent.acceleration(now, place, w_acceleration);
                    row.iter_mut().zip(needed).for_each(|(row, needed)| *row += mass_kg * needed);
                };
                for (element, points) in bent.points.elements.iter().enumerate() {
                    let dofs = std::array::from_fn(|k| now.acceleration[2 * element + k]);
                    for (point, place) in points.iter().zip(&scratch.places[element]) {
                        add(place, point.mass_kg_m * point.weight_m, dot(&point.shape, &dofs));
                    }
                }
                for (body, place) in bent.bodies.iter().zip(&scratch.body_places) {
                    let [w, slope] = [0, 1].map(|part| now.acceleration[2 * body.node + part]);
                    add(place, body.mass_kg, w + body.arm_m * slope);
                }
                0.0
            });
            all.0
        };
        for order in [SecondOrder::None, SecondOrder::First, SecondOrder::Full] {
            let bent = BentLink::of(&*model, order);
            let own = if order == SecondOrder::None {
                on_chord.linear_ends(&answers)
            } else {
                let histories = on_chord.histories(&answers, bent.orders(), &chord.pair);
                let found = bent.loads((&histories, &chord.histories)).unwrap();
                let along = found.axial_n.iter().map(|axial| -axial).collect();
                let across = chord.pair.samples(on_chord.across_n(&bent.straight(), &answers));
                [
                    along,
                    across.iter().zip(&found.left_n).map(|(linear, left)| linear + left).collect(),
                ]
            };
            for (own, all) in own.iter().zip(&all_of(&bent)) {
                let largest = all.iter().map(|force| force.abs()).fold(0.0, f64::max);
                assert!(largest > 5.0, "{largest}");
                for (own, all) in own.iter().zip(all) {
                    assert!((own - all).abs() < 1e-11 * largest, "{order:?}: {own} {all}");
                }
            }
        }
    }
}
