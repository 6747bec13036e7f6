//! Cases from a seed.

use super::case::{Case, Mesh};
use super::link::{Body, Damping, Drive, Joint, Link, Payload, Segment};
use super::motion::{Column, Motion, Profile};

/// A generator of numbers, `SplitMix64`.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// From 0 to 1.
    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    /// Between two numbers above 0, every factor as likely.
    fn over(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn chance(&mut self, share: f64) -> bool {
        self.share() < share
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }
}

/// Case number `k` of a seed, its motion of so many steps.
pub(crate) fn drawn(seed: u64, k: usize, steps: [f64; 2]) -> Case {
    let mut own = Random(seed.wrapping_mul(1_000_003).wrapping_add(k as u64));
    case(&mut own, format!("{seed}-{k}"), steps)
}

/// Case number `k` of a seed with a carriage, a station, a spring at the root, or several of them.
pub(crate) fn drawn_otherwise(seed: u64, k: usize, steps: [f64; 2]) -> Case {
    let mut own = Random(seed.wrapping_mul(1_000_003).wrapping_add(k as u64) ^ 0xC0FF_EE00);
    let mut link = link(&mut own);
    if own.chance(0.7) {
        slide(&mut own, &mut link);
    }
    if own.chance(0.5) {
        let along_m = link.length_m() - link.radius_m;
        link.output_m = Some(link.radius_m + own.between(0.3, 0.98) * along_m);
    }
    if own.chance(0.3) {
        let Segment { length_m, stiffness_n_m2, .. } = link.segments[0];
        link.root_n_m_rad = own.over(0.5, 50.0) * stiffness_n_m2[0] / length_m;
    }
    case_of(&mut own, link, format!("other {seed}-{k}"), steps)
}

/// Puts the link on a carriage in place of its hub.
fn slide(random: &mut Random, link: &mut Link) {
    let length_m = link.length_m();
    link.joint = Joint::Carriage;
    // Of the same effect on the tip.
    link.hub_kg_m2 /= length_m * length_m;
    link.friction_n_m_s /= length_m * length_m;
    link.bodies.iter_mut().for_each(|body| body.at_m -= link.radius_m);
    link.radius_m = 0.0;
    if let Some(drive) = &mut link.drive {
        drive.stiffness_n_m /= length_m * length_m;
        drive.rotor_kg_m2 *= random.between(0.1, 1.0);
    }
}

fn case(random: &mut Random, name: String, steps: [f64; 2]) -> Case {
    let link = link(random);
    case_of(random, link, name, steps)
}

fn case_of(random: &mut Random, link: Link, name: String, steps: [f64; 2]) -> Case {
    let motion = motion(random, &link, steps);
    let mesh = match random.below(6) {
        0 => Mesh::Auto(10_f64.powi(-3 - random.below(4) as i32)),
        _ => Mesh::Elements(random.over(3.0, 50.0) as usize),
    };
    let is_modal = matches!(link.damping, Damping::Modal(_) | Damping::Caughey(_));
    Case::new(name, link, motion, mesh).with(|c| {
        c.tolerance = 10_f64.powi(-3 - random.below(5) as i32);
        c.tip_tolerance = match random.below(10) {
            0 => Some(0.0),
            1..=5 => None,
            _ => Some(10_f64.powi(-3 - random.below(5) as i32)),
        };
        if !is_modal && random.chance(0.1) {
            c.modes = Some(1 + random.below(2));
        }
    })
}

fn link(random: &mut Random) -> Link {
    let length = random.over(0.3, 2.0);
    let mass = random.over(0.2, 3.0);
    // Stiffness by the first frequency of the clamped link.
    let hz = random.over(0.8, 12.0);
    let stiffness = mass * (length * length * std::f64::consts::TAU * hz / 3.516).powi(2);
    let beam = mass * length.powi(3) / 3.0;
    let hub = random.over(0.01, 10.0) * beam;
    let mut link = Link::uniform(length, stiffness, mass, hub);
    if random.chance(0.3) {
        let share = random.between(0.1, 0.5);
        let factor = random.over(2.0, 20.0);
        let outer = link.segments[0].clone();
        link.segments[0].length_m = (1.0 - share) * length;
        let root = Segment {
            length_m: share * length,
            stiffness_n_m2: outer.stiffness_n_m2.map(|ei| ei * factor),
            mass_kg_m: outer.mass_kg_m.map(|m| m * factor.powf(0.3)),
        };
        link.segments.insert(0, root);
    } else if random.chance(0.1) {
        link.segments[0].stiffness_n_m2[1] *= 0.5;
        link.segments[0].mass_kg_m[1] *= 0.7;
    }
    if random.chance(0.6) {
        link.payload.mass_kg = random.over(0.02, 5.0) * mass * length;
        if random.chance(0.3) {
            let arm = random.over(0.005, 0.1) * length;
            let inertia_kg_m2 = link.payload.mass_kg * arm * arm;
            link.payload = Payload { inertia_kg_m2, offset_m: 0.5 * arm, ..link.payload };
        }
    }
    if random.chance(0.2) {
        let at_m = random.between(0.2, 0.9) * length;
        let mass_kg = random.over(0.1, 1.0) * mass * length;
        link.bodies.push(Body { at_m, mass_kg, inertia_kg_m2: 0.0 });
    }
    if random.chance(0.2) {
        link.radius_m = 0.1 * length;
        link.bodies.iter_mut().for_each(|body| body.at_m += 0.1 * length);
    }
    if random.chance(0.2) {
        link.friction_n_m_s = 0.1 * beam;
    }
    link.damping = damping(random, hz);
    if random.chance(0.3) {
        let rotor_kg_m2 = random.over(1e-5, 1e-2) * beam;
        let stiffness_n_m = random.over(10.0, 1000.0) * stiffness / length;
        link.drive = Some(Drive { stiffness_n_m, rotor_kg_m2, gear: random.over(1.0, 100.0) });
    }
    link
}

fn damping(random: &mut Random, hz: f64) -> Damping {
    match random.below(8) {
        0 => Damping::Rayleigh {
            alpha_per_s: random.over(0.01, 0.5),
            beta_s: random.over(1e-3, 1e-1) / (std::f64::consts::TAU * hz),
        },
        1 => Damping::RayleighThrough { modes: [1, 3], ratios: [0.02, random.over(0.02, 0.1)] },
        2 => Damping::Modal(vec![random.over(0.003, 0.1)]),
        3 => Damping::Modal(vec![0.02, random.over(0.01, 0.1), 0.05]),
        _ => Damping::Hysteretic(random.over(0.002, 0.1)),
    }
}

fn motion(random: &mut Random, link: &Link, [fewest, most]: [f64; 2]) -> Motion {
    let profile = Profile::ALL[random.below(8)];
    let length = link.length_m();
    let segment = link.segments.last().expect("a segment");
    let period = std::f64::consts::TAU / 3.516
        * length.powi(2)
        * (segment.mass_kg_m[0] / segment.stiffness_n_m2[0]).sqrt();
    let duration_s = period * random.over(1.0, 6.0);
    let steps = random.over(fewest, most).round();
    let distance_m = random.over(0.02, 0.3) * length;
    let column = match random.below(8) {
        0..=3 => Column::Displacement,
        4 => Column::Rounded(6),
        _ => Column::Acceleration,
    };
    Motion { profile, distance_m, duration_s, step_s: duration_s / steps, finer: 1, column }
}
