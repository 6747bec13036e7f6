//! Links under gravity and at large angles, and arms of them: the inextensible elastica, with second-order terms as
//! loads.
//!
//! The reference of a link is its chord, the line from the axis to the tip, with a prescribed motion. The recursion
//! answers to loads at every frequency ([`Model::loaded_motion`](crate::model::Model::loaded_motion)). Terms that the
//! linear link neglects (centripetal terms, axial force, large slopes) are computed in time from the last answer, and
//! act as loads on the next one. The fixed point is the exact motion of the inextensible elastica on the mesh.
//!
//! ```text
//! r(s) = e (s + u) + n w,   w(0) = w(L) = 0,   u' = √(1 − w'²) − 1,   ψ = asin w'
//! ```
//!
//! e and n are unit vectors along the chord and across it. Gravity counts as an upward acceleration of the axis.
//!
//! ```
//! use flexlink::beam::{Mesh, MeshPlan};
//! use flexlink::elastica::{ArmPeriod, Kept, SecondOrder, follow_arm};
//! use flexlink::link::{Link, Segment};
//! use flexlink::model::{KeptModes, model_of};
//!
//! let strip = Segment::uniform(1.0, 2.0, 0.3);
//! let link = Link::builder().segment(strip).damping_ratio(0.02).build()?;
//! let mesh = Mesh::new(&link, &MeshPlan::automatic(&link))?;
//! let model = model_of(&link, mesh, KeptModes::All)?;
//!
//! // At rest, its tip as high as its hub, so that its middle sags.
//! let at_rest = [vec![0.0; 8], vec![0.0; 8], vec![0.0; 8]];
//! let arm = ArmPeriod::new(0.01, vec![at_rest], Kept::Angles, [0.0, -9.81])?;
//! let held = &follow_arm(&[model], &arm, SecondOrder::Full, 1e-9)?.links[0].bent;
//! assert!(held.hub_slope_rad[0] > 0.15, "the hub is turned up");
//! assert!(held.torque_n_m[0] < 0.5 * 0.3 * 9.81, "and the weight lies nearer than half the length");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Several links
//!
//! In an arm every link has its chord from joint to joint, in the place of a rigid arm's link:
//!
//! ```text
//!         ⌒⌒ link 2
//!       o ------- * tip        o  joint
//!      /  chord 2             ---  chord, of length ℓ = L − Δ
//!     ( /                      Δ  by how much a bent link is shorter than it is long
//!     (/ chord 1
//!     o
//! ```
//!
//! The motion of each link's tip and the next link's load on it are known: the links are solved from the last inward,
//! each as a single link ([`follow_arm`]). When bending links pull their ends together, the first two chords turn so
//! that the tip stays on its path ([`Kept::Tip`]).
//!
//! ```
//! use flexlink::beam::{Mesh, MeshPlan};
//! use flexlink::elastica::{ArmPeriod, Kept, SecondOrder, follow_arm, reaching};
//! use flexlink::link::{Damping, Link, Segment};
//! use flexlink::model::{KeptModes, model_of};
//!
//! let strip = Link::builder()
//!     .segment(Segment::uniform(0.5, 20.0, 0.3))
//!     .damping(Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 1e-3 })
//!     .build()?;
//! let model = model_of(&strip, Mesh::new(&strip, &MeshPlan::automatic(&strip))?, KeptModes::All)?;
//!
//! // At rest, its tip 0.6 m in front of its first joint: the second link turns left of the first.
//! let tip = vec![[[0.6, 0.0], [0.0; 2], [0.0; 2]]; 8];
//! let chords = reaching(&tip, &[0.5, 0.5], &[], true)?;
//! let arm = ArmPeriod::new(0.01, chords, Kept::Tip, [0.0, -9.81])?;
//! let held = follow_arm(&[model.clone(), model], &arm, SecondOrder::Full, 1e-9)?;
//! let [shoulder, elbow] = [0, 1].map(|joint| held.links[joint].bent.torque_n_m[0]);
//! assert!((shoulder - 0.3 * 9.81 * 0.3).abs() < 1e-3, "both weigh as much, on both sides of 0.3 m");
//! assert!((elbow - 0.15 * 9.81 * 0.15).abs() < 2e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arm;
mod arm_links;
mod chord;
mod error;
mod kinematics;
mod loads;
mod on_chord;
mod points;
mod reaction;
mod sag;

pub use arm::follow_arm;
pub(crate) use arm::{estimate, estimate_arm, follow_arm_at};
pub use chord::returning;
pub use error::ElasticaError;
pub(crate) use kinematics::STRETCHED;
pub use kinematics::{AngleHistories, ArmPeriod, Kept, reaching};
pub use loads::SecondOrder;
pub use reaction::{ArmLinkMotion, ArmMotion, ElasticaMotion, Iteration};
