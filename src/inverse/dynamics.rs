use num_complex::Complex64;

use super::error::InversionError;
use crate::beam::{Mesh, NodalTransfer, TipTransfer, nodal_transfer, tip_transfer};
use crate::link::Link;
use crate::modal::{AllModesError, DampingLaw, MOST_ELEMENTS_OF_ALL_MODES, ModalBasis, Shape};

/// The link on a mesh with its damping: what it answers at one frequency.
///
/// Local damping laws and a link with all its modes are condensed by the recursion; modal laws,
/// and a link reduced to few modes, are summed up mode by mode:
///
/// ```text
/// x/T = φ₀p₀/(−ω²) + Σ φ_k p_k/(ω_k² − ω² + 2iζ_kω_kω)            (Bayo 1987, eqs 11 and 12)
/// ```
#[derive(Debug, Clone)]
pub struct Dynamics {
    mesh: Mesh,
    law: DampingLaw,
    kept: KeptModes,
    modes: Option<Superposition>,
}

/// Elements that an automatic mesh is not refined beyond.
const MOST_ELEMENTS: usize = 8192;

/// How many modes of the mesh answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeptModes {
    /// All of them.
    All,
    /// The rigid rotation and the first flexible ones (Bayo 1987, section 5).
    First(usize),
}

impl Dynamics {
    /// Prepares the answers of a link on a mesh.
    ///
    /// # Errors
    /// Damping that cannot be, more modes than there are, or a mesh too large for all its modes
    /// where damping needs them.
    pub fn new(link: &Link, mesh: Mesh, kept: KeptModes) -> Result<Self, InversionError> {
        let law = DampingLaw::of(link.damping(), &mesh)?;
        Self::with_law(law, mesh, kept)
    }

    fn with_law(law: DampingLaw, mesh: Mesh, kept: KeptModes) -> Result<Self, InversionError> {
        let modes = match kept {
            KeptModes::All if !law.is_modal() => None,
            KeptModes::All => Some(Superposition::of_all(&mesh)?),
            KeptModes::First(count) => Some(Superposition::of_first(&mesh, count)?),
        };
        Ok(Self { mesh, law, kept, modes })
    }

    /// The same link and law on elements of half the length.
    ///
    /// # Errors
    /// [`InversionError::TooManyElements`] where damping needs all modes of the finer mesh.
    pub(super) fn refined(&self) -> Result<Self, InversionError> {
        let elements = self.mesh.elements().len();
        if 2 * elements > self.most_elements() {
            let limit = self.most_elements() / 2;
            return Err(InversionError::TooManyElements { elements, limit });
        }
        Self::with_law(self.law.clone(), self.mesh.refined(), self.kept)
    }

    /// The same link and law with all modes of the mesh.
    ///
    /// # Errors
    /// As [`Dynamics::new`].
    pub(super) fn unreduced(&self) -> Result<Self, InversionError> {
        Self::with_law(self.law.clone(), self.mesh.clone(), KeptModes::All)
    }

    /// How many modes answer.
    pub fn kept_modes(&self) -> KeptModes {
        self.kept
    }

    /// Elements that the mesh may be refined to.
    pub(super) fn most_elements(&self) -> usize {
        if self.law.is_modal() { MOST_ELEMENTS_OF_ALL_MODES } else { MOST_ELEMENTS }
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The damping law with all its numbers.
    pub fn law(&self) -> &DampingLaw {
        &self.law
    }

    /// Transfers from the tip to torque and hub angle at ω ≥ 0.
    pub fn tip_transfer(&self, omega_rad_s: f64) -> TipTransfer {
        match &self.modes {
            None => tip_transfer(&self.mesh, self.law.lambda(omega_rad_s)),
            Some(modes) => modes.tip_transfer(self, omega_rad_s),
        }
    }

    /// Transfers from the tip to every node at ω ≥ 0.
    pub fn nodal_transfer(&self, omega_rad_s: f64) -> NodalTransfer {
        match &self.modes {
            None => nodal_transfer(&self.mesh, self.law.lambda(omega_rad_s)),
            Some(modes) => modes.nodal_transfer(self, omega_rad_s),
        }
    }
}

/// Modes, and what their sum needs of them.
#[derive(Debug, Clone)]
struct Superposition {
    rigid: Share,
    modes: Vec<(f64, Share)>,
    /// Static answer of what the modes leave over, per torque; none where that is left out.
    residual: Option<Share>,
}

/// What one shape adds to the link's answer, per torque at the hub.
#[derive(Debug, Clone)]
struct Share {
    /// Hub angle p, which the torque acts on.
    hub_angle: f64,
    tip: f64,
    /// Deflections from the hub's tangent line.
    deflections: Vec<f64>,
    /// Moments that its acceleration needs.
    moments: Vec<f64>,
}

impl Share {
    fn of(mesh: &Mesh, shape: &Shape) -> Self {
        Self {
            hub_angle: shape.hub_angle,
            tip: shape.tip_displacement(mesh),
            deflections: shape.deflections.iter().map(|w| w[0]).collect(),
            moments: shape.moments(mesh),
        }
    }

    fn tip_deflection(&self) -> f64 {
        self.deflections[self.deflections.len() - 1]
    }
}

impl Superposition {
    /// Every mode of the mesh; what they lose to round-off, and motions without mass, answer
    /// statically.
    fn of_all(mesh: &Mesh) -> Result<Self, InversionError> {
        let basis = ModalBasis::complete(mesh).map_err(|error| match error {
            AllModesError::TooManyElements { elements } => {
                InversionError::TooManyElements { elements, limit: MOST_ELEMENTS_OF_ALL_MODES }
            }
            AllModesError::NotFinite => InversionError::NotFinite { frequency_hz: 0.0 },
        })?;
        let residual = Share::of(mesh, &basis.static_residual(mesh));
        Ok(Self { residual: Some(residual), ..Self::of(mesh, &basis) })
    }

    /// The rigid rotation and the first `count` flexible modes.
    fn of_first(mesh: &Mesh, count: usize) -> Result<Self, InversionError> {
        let basis = ModalBasis::lowest(mesh, count);
        let found = basis.modes.len();
        if found < count {
            return Err(InversionError::NotSoManyModes { asked: count, found });
        }
        Ok(Self::of(mesh, &basis))
    }

    fn of(mesh: &Mesh, basis: &ModalBasis) -> Self {
        let share = |shape: &Shape| Share::of(mesh, shape);
        Self {
            rigid: share(&basis.rigid),
            modes: basis.modes.iter().map(|m| (m.omega_rad_s, share(&m.shape))).collect(),
            residual: None,
        }
    }

    /// Motions of the modes per torque: `p_k/(ω_k² − λ)`, times −κ/… of the law; all per λ.
    fn coordinates<'a>(
        &'a self,
        dynamics: &'a Dynamics,
        omega_rad_s: f64,
    ) -> impl Iterator<Item = (Complex64, &'a Share)> {
        let modes = self.modes.iter().enumerate().map(move |(k, (mode_rad_s, share))| {
            let denominator = dynamics.law.modal_denominator(k + 1, *mode_rad_s, omega_rad_s);
            (share.hub_angle / denominator, share)
        });
        modes.chain(self.residual.iter().map(|share| (Complex64::ONE, share)))
    }

    /// Per torque: acceleration of the tip `φ₀p₀ − λ Σ φ_k q_k`, and so on for what `of` reads.
    fn acceleration(
        &self,
        lambda: Complex64,
        coordinates: &[(Complex64, &Share)],
        of: impl Fn(&Share) -> f64,
    ) -> Complex64 {
        let bending: Complex64 = coordinates.iter().map(|(q, share)| q * of(share)).sum();
        self.rigid.hub_angle * of(&self.rigid) - lambda * bending
    }

    fn tip_transfer(&self, dynamics: &Dynamics, omega_rad_s: f64) -> TipTransfer {
        let coordinates: Vec<_> = self.coordinates(dynamics, omega_rad_s).collect();
        self.tip_of(dynamics, omega_rad_s, &coordinates)
    }

    fn tip_of(
        &self,
        dynamics: &Dynamics,
        omega_rad_s: f64,
        coordinates: &[(Complex64, &Share)],
    ) -> TipTransfer {
        let lambda = dynamics.law.lambda(omega_rad_s);
        let inertia_kg_m = self.acceleration(lambda, coordinates, |share| share.tip).inv();
        let deflection: Complex64 = coordinates.iter().map(|(q, s)| q * s.tip_deflection()).sum();
        let lag_s2 = -deflection * inertia_kg_m;
        TipTransfer {
            inertia_kg_m,
            root_inertia_kg_m: self.acceleration(lambda, coordinates, |share| share.moments[0])
                * inertia_kg_m,
            angle_rad_m: (1.0 - lambda * lag_s2) / dynamics.mesh.length_m(),
            lag_s2,
        }
    }

    fn nodal_transfer(&self, dynamics: &Dynamics, omega_rad_s: f64) -> NodalTransfer {
        let coordinates: Vec<_> = self.coordinates(dynamics, omega_rad_s).collect();
        let tip = self.tip_of(dynamics, omega_rad_s, &coordinates);
        let lambda = dynamics.law.lambda(omega_rad_s);
        let nodes = self.rigid.moments.len();
        let mut lags_s2 = vec![Complex64::ZERO; nodes];
        let rigid = self.rigid.hub_angle * tip.inertia_kg_m;
        let mut moments_kg_m: Vec<Complex64> =
            self.rigid.moments.iter().map(|m| rigid * *m).collect();
        for (q, share) in &coordinates {
            let lag = -q * tip.inertia_kg_m;
            let acceleration = lambda * lag;
            for node in 0..nodes {
                lags_s2[node] += lag * share.deflections[node];
                moments_kg_m[node] += acceleration * share.moments[node];
            }
        }
        NodalTransfer { tip, lags_s2, moments_kg_m }
    }
}
