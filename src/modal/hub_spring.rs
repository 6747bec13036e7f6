//! Modes below a frequency, counted, for a free, a sprung and a clamped hub.

use crate::beam::{Mesh, Pivots, pivots};
use crate::numeric::{SECTIONS, geometric_scan, next_places};

/// Highest angular frequency that is searched, in rad/s, far above any link's.
const SEARCH_LIMIT_RAD_S: f64 = 1e15;

/// A torsional spring between hub and ground, its stiffness k in N m/rad.
///
/// k = 0 is a free hub, k = ∞ a clamped one, so that one count and one search serve all three.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub(super) struct HubSpring(pub(super) f64);

impl HubSpring {
    /// No spring: the hub is free to turn.
    pub(super) const FREE: Self = Self(0.0);
    /// A spring that does not yield.
    pub(super) const CLAMPED: Self = Self(f64::INFINITY);

    /// Number of modes below each ω > 0, the rigid rotation of a free hub included.
    ///
    /// By Sylvester's law of inertia it is the number of negative pivots of the dynamic stiffness
    /// (Wittrick and Williams), here of the blocks `K_d − λ(M_dd + A)`, over λ, and of the hub's
    /// `k − λ(A_0[φφ] + I_H)`; so none is missed, however close two of them lie. For k = ∞ the
    /// hub's pivot is never negative, which leaves the modes of the clamped link.
    pub(super) fn modes_below(
        self,
        mesh: &Mesh,
        omegas_rad_s: &[f64; SECTIONS],
    ) -> [usize; SECTIONS] {
        counted(mesh, omegas_rad_s)
            .map(|Pivots { negative, hub_n_m }| negative + usize::from(hub_n_m > self.0))
    }

    /// Two frequencies in rad/s around mode number `sought`: fewer modes lie below the first, as many or
    /// more below the second, which is `from_rad_s` times a power of two. None where the search passes
    /// its limit.
    pub(super) fn bracket(self, mesh: &Mesh, sought: usize, from_rad_s: f64) -> Option<(f64, f64)> {
        let is_above = |modes: &usize| *modes >= sought;
        let mut before = None;
        let mut upwards = geometric_scan(from_rad_s, 2.0);
        let (low, high) = loop {
            let places = next_places(&mut upwards);
            match self.modes_below(mesh, &places).iter().position(is_above) {
                Some(first) => {
                    let low = if first > 0 { Some(places[first - 1]) } else { before };
                    break (low, places[first]);
                }
                None => before = places.last().copied(),
            }
            if places[0] > SEARCH_LIMIT_RAD_S {
                return None;
            }
        };
        if let Some(low) = low {
            return Some((low, high)).filter(|_| high <= SEARCH_LIMIT_RAD_S);
        }
        let (mut low, mut high) = (None, high);
        let mut downwards = geometric_scan(0.5 * from_rad_s, 0.5);
        while low.is_none() {
            let places = next_places(&mut downwards);
            for (place, modes) in places.iter().zip(self.modes_below(mesh, &places)) {
                if !is_above(&modes) {
                    low = Some(*place);
                    break;
                }
                high = *place;
            }
        }
        low.map(|low| (low, high))
    }
}

/// Negative pivots at each ω > 0.
pub(super) fn counted(mesh: &Mesh, omegas_rad_s: &[f64; SECTIONS]) -> [Pivots; SECTIONS] {
    // Exactly on a pole of the apparent inertia no number is finite, and a hair beside it all are;
    // numbers beyond double precision stay infinite, so the hairs are few.
    let mut found = [Pivots { negative: 0, hub_n_m: f64::NAN }; SECTIONS];
    for hairs in 0..4 {
        let beside = 1.0 + 4.0 * f64::from(hairs) * f64::EPSILON;
        let counted = pivots(mesh, &omegas_rad_s.map(|omega| (omega * beside).powi(2)));
        let open = found.iter_mut().zip(counted).filter(|(found, _)| found.hub_n_m.is_nan());
        open.filter(|(_, counted)| counted.hub_n_m.is_finite()).for_each(|(f, c)| *f = c);
        if found.iter().all(|found| found.hub_n_m.is_finite()) {
            break;
        }
    }
    found
}

/// Number of modes below `omega_rad_s` > 0 of the link on its free hub, the rigid rotation
/// included.
pub fn modes_below(mesh: &Mesh, omega_rad_s: f64) -> usize {
    HubSpring::FREE.modes_below(mesh, &[omega_rad_s; SECTIONS])[0]
}
