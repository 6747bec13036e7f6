//! Torques and shapes of links under gravity and at large deflections, one link or an arm: the inextensible elastica.
//!
//! The chord of a link is the straight line from its axis to its tip. The motion of the chord is prescribed. For this
//! motion and any loads the recursion computes the response of the linear link, frequency by frequency
//! ([`Model::loaded_motion`](crate::model::Model::loaded_motion)).
//!
//! The linear link neglects second-order terms: centripetal terms, the axial force and large slopes. An iteration adds
//! them: it computes these terms over time from the last response, and applies them as loads for the next one. It
//! converges to the exact motion of the inextensible elastica on the mesh.
//!
//! ```text
//! r(s) = e (s + u) + n w,   w(0) = w(L) = 0,   u' = √(1 − w'²) − 1,   ψ = asin w'
//! ```
//!
//! r is the place at the distance s along the link; e and n are unit vectors along the chord and across it. The place
//! lies s + u along the chord and w across it, and ψ is the link's angle from the chord there. Gravity enters as an
//! opposite acceleration of the axis.
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
//! // A link at rest with a horizontal chord: its middle sags.
//! let at_rest = [vec![0.0; 8], vec![0.0; 8], vec![0.0; 8]];
//! let arm = ArmPeriod::new(0.01, vec![at_rest], Kept::Angles, [0.0, -9.81])?;
//! let held = &follow_arm(&[model], &arm, SecondOrder::Full, 1e-9)?.links[0].bent;
//! assert!(held.hub_slope_rad[0] > 0.15, "the hub is turned up");
//! assert!(held.torque_n_m[0] < 0.5 * 0.3 * 9.81, "the centre of the weight is closer than half the length");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Several links
//!
//! In an arm the chord of each link runs from joint to joint. The chords take the place of a rigid arm's links:
//!
//! ```text
//!         ⌒⌒ link 2
//!       o ------- * tip        o  joint
//!      /  chord 2             ---  chord, of length ℓ = L − Δ
//!     ( /                      Δ  shortening of a link of length L by bending
//!     (/ chord 1
//!     o
//! ```
//!
//! The solver begins with the last link and ends with the first ([`follow_arm`]). At each link it knows the motion of the
//! chord and the load of the next link on the tip, and solves the link like a single one. Bending shortens the chords.
//! To keep the tip on its path, the first two chords turn ([`Kept::Tip`]).
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
//! // An arm at rest, its tip 0.6 m from its first joint along x, its second link turned left of the first.
//! let tip = vec![[[0.6, 0.0], [0.0; 2], [0.0; 2]]; 8];
//! let chords = reaching(&tip, &[0.5, 0.5], &[], true)?;
//! let arm = ArmPeriod::new(0.01, chords, Kept::Tip, [0.0, -9.81])?;
//! let held = follow_arm(&[model.clone(), model], &arm, SecondOrder::Full, 1e-9)?;
//! let [shoulder, elbow] = [0, 1].map(|joint| held.links[joint].bent.torque_n_m[0]);
//! assert!((shoulder - 0.3 * 9.81 * 0.3).abs() < 1e-3, "two equal weights, on both sides of 0.3 m");
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
pub(crate) use on_chord::underived;
pub use reaction::{ArmLinkMotion, ArmMotion, ElasticaMotion, Iteration};
