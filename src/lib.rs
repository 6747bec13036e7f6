//! flexlink: the hub torque, or the force on a carriage, that makes the tip of a flexible link follow a wanted motion.
//!
//! A straight link turns about a hub or slides on a carriage, in the horizontal plane or under gravity. From the wanted
//! motion of the link's *tip* this library computes the torque of the motor at the *hub*, or its force on the carriage
//! (E. Bayo, *A Finite-Element Approach to Control the End-Point Motion of a Single-Link Flexible Robot*, J. Robotic
//! Systems 4(1), 1987; "eq n" in these docs is an equation of this paper). The torque starts before the tip moves and
//! outlasts its motion, because bending waves travel at finite speed. Arms have up to nine such links,
//! and may stand on a carriage.
//!
//! # From a tip motion to a torque
//!
//! ```text
//! link.toml ─spec─► Link ─► Mesh ─► recursion ─► modes, zeros
//! arm.toml ─spec─► Arm, of one link or several
//! motion.csv ─csv─► TipMotion, path.csv ─csv─► ArmPath ─► inverse ─► Solution + warnings ─► result, store
//! torque.csv ─csv─► Torque ─► response ─► Played ─► result, store
//!                                   Solution, Played ─► verify
//! result folder ─store─► StoredResult ─► page
//! link.toml, measured.toml ─spec─► Measurements ─► fit ─► factors ─spec─► fitted.toml
//!                                                FitOutcome ─► page, store
//! ```
//!
//! The sources have five floors, and a floor has rooms. A room uses only rooms above it in this table (`tests/layers`
//! checks the imports).
//!
//! | floor | room | holds |
//! |---|---|---|
//! | `mechanics` | [`text`] | numbers and excerpts of an input as messages show them |
//! | | [`system`] | memory that this process may still take; the request to stop it |
//! | | [`numeric`] | time grids, Fourier pairs, roots, eigenvalues, splines, units, Student's t: mathematics that knows no beam |
//! | | [`link`] | the physical link, and arms of several links, checked at construction |
//! | | [`motion`] | the motion of a tip and the path of an arm, checked at construction; spectra, analytic profiles, input shapers and curves |
//! | | [`beam`] | mesh, one element, and the recursion that condenses the link to its hub |
//! | | [`recording`] | quality of a recorded motion: the digits and times of its samples, rests at its ends |
//! | | [`modal`] | natural frequencies, modes and zeros of torque → tip; damping laws |
//! | | [`model`] | response of a link to a motion of its tip at one frequency, computed in three ways: by recursion, by modes, by dense matrices |
//! | | [`elastica`] | links and arms under gravity and at large angles: second-order terms as loads, iterated |
//! | | [`response`] | direct dynamics, independent of the FFT: the motion under a torque or with a prescribed hub or joints; small motions of an arm about a pose |
//! | | [`inverse`] | the inversion of links and of arms: period and padding, errors, memory, warnings, motions of the nodes |
//! | `study` | [`compare`] | tables against tables, column by column; tolerances |
//! | | [`result`] | peaks and other numbers of a run, limits; a simulation beside a recording; a run read back |
//! | | [`sweep`] | many cases in parallel, in a fixed order; their numbers; shards |
//! | | [`robust`] | the tip of plants that differ from the model, over intervals of the link's values |
//! | | [`learn`] | the next effort of a repeated motion from the measured error of the tip |
//! | | [`verify`] | every approximation of a solution, measured by an independent method |
//! | | [`fit`] | parameters of a link from measured frequencies, zeros and damping ratios; which of them these do not determine |
//! | `files` | [`spec`] | link file and `--set` → [`link::Link`]; files of tolerances and of measured values |
//! | | [`csv`] | CSV → motion, torque, hub reference, any table; numbers as text |
//! | | [`measured`] | a file of measured values, with the files of responses and records that it names |
//! | | [`store`] | the folder of a run or a study, CSV files and summary.json, written and read; the file of a sweep; golden files |
//! | `page` | [`page`] | a result or a fit as figures, and as a page to look at |
//! | `cli` | `terminal` | printed text, exit codes, progress, memory, threads, signals |
//! | | `options` | options that several commands share, and the inputs that they name |
//! | | `cli` | the commands, each: load, compute, write, tell |
//!
//! All rooms but those of `cli` stand at the root of the library.
//!
//! ```
//! use flexlink::beam::MeshPlan;
//! use flexlink::inverse::{Analysis, invert};
//! use flexlink::link::{Link, Segment};
//! use flexlink::motion::Profile;
//! use flexlink::result::Metrics;
//!
//! let strip = Segment::uniform(1.5, 5.0, 0.8);
//! let link = Link::builder().segment(strip).hub_inertia_kg_m2(0.1).damping_ratio(0.02).build()?;
//! let motion = Profile::Sine.motion(0.5, 0.88, 220)?;
//! let solution = invert(&link, &MeshPlan::automatic(&link), &motion, &Analysis::default())?;
//!
//! let metrics = Metrics::of(&solution);
//! let hub = metrics.hub();
//! assert!(hub.lead_s.is_some_and(|lead_s| lead_s > 0.2), "the torque starts before the tip moves");
//! assert!(hub.torque_ratio < 0.6, "and is smaller than a rigid link's");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The features `cli` and `report` are on by default. Without them the library compiles neither a command line nor
//! fonts.
//!
//! # Notation
//!
//! | paper | here | unit |
//! |---|---|---|
//! | x, L | distance from the axis, length; `nodes_m`, `length_m` | m |
//! | v(x, t) | total displacement along the arc, `v = w + xθ` (eq 1) | m |
//! | w(x, t) | deflection from the hub's tangent line | m |
//! | θ | hub angle, `hub_angle_rad`, `theta` | rad |
//! | T | torque at the hub, `torque_n_m` | N m |
//! | EI, m̄ | `bending_stiffness_n_m2`, `mass_per_length_kg_m` | N m², kg/m |
//! | κ G A, ρI | shear stiffness, rotary inertia per length of [`link::Timoshenko`] | N, kg m |
//! | I_H, b | hub inertia, viscous friction | kg m², N m s/rad |
//! | m_t, J_t, c | payload mass, inertia about its centre, offset of that centre | kg, kg m², m |
//! | ω̄, P | angular frequency `omega`, period (eq 13) | rad/s, s |
//! | ξ | material damping ratio, `ratio` (eq 16) | |
//! | α, β | Rayleigh damping | 1/s, s |
//! | ζ | viscous damping ratio of one mode | |
//! | (v, φ) | displacement and slope of a node, the degrees of freedom of the mesh | m, rad |
//! | φ, q, p | shape of a mode, its coordinate, its hub angle: `q̈ + 2ζωq̇ + ω²q = pT` | 1/√kg, m √kg, 1/(m √kg) |
//! | w', ψ, u | slope of the link from its chord, its angle `asin w'`, shortening along the chord ([`elastica`]) | , rad, m |
//! | ℓ, Δ | length of the chord, and by how much it is shorter than the link: `−u` at the tip | m |
//! | g | gravity in the plane of motion, `gravity_m_s2` | m/s² |
//! | κ | relative complex stiffness, 1 + 2iξ or 1 + iωβ | |
//! | λ | ω²(1 + α/(iω))/κ, `lambda`: the recursion depends on frequency and damping through λ alone | 1/s² |
//! | A | apparent inertia of the part outboard of a node, [`beam::Inertia`] | kg, kg m, kg m² |
//! | d, R, G | deformation of an element, its rigid transfer, its gain [`beam::Gain`] | |
//! | e | deflection and slope for θ = 1; `deflections_s2` are `e/(λ(L + e_tip))` | |
//! | z | zero of torque → tip | 1/s |
//!
//! A caret in a comment marks a complex amplitude of e^{+iωt}. Three letters have further meanings. φ is also the angle
//! of a motor, `φ = n (θ + T/k)`, and in `response/chain.rs` that of the hub. κ is the shear coefficient in κ G A, the
//! curvature in [`elastica`] and the spring at the hub in `response/link_ratios.rs`. ψ is the rotation of a
//! cross-section with shear, in `response/chain.rs` the slope of the link from the hub's tangent line, and in
//! `response/shape.rs` a mode.
//!
//! # Where to change it
//!
//! | change | place |
//! |---|---|
//! | boundary condition of the hub | `mechanics/beam/recursion.rs`: `hub_response` moves the root along the joint's unit motion, `HubResponse::at_axis` adds the joint's inertia. `pivoted.rs` and `loaded.rs` beside it repeat both; so does `batch/mod.rs` for counting modes. `mechanics/model/dense.rs`, `modal` (`basis`, `pose`, `shape`) and `response/chain.rs` assemble separate matrices. The friction of the joint joins in `inverse/spectra.rs`, `elastica/on_chord.rs` (for arms `arm_links.rs`) and `response/play.rs`; `joint().friction()` and `friction_n_m_s_rad` find all places |
//! | a joint | [`link::Joint`]: its unit motion, inertia, friction and words. `Mesh::rigid` carries the unit motion to `mechanics/beam`, `modal`, `model`, `inverse` and `response/played.rs`. Names of files and columns stand in `files/store/names.rs` |
//! | a difference of one link and an arm | a pair of words, keys or columns in [`link::Arm::pick`], on a page in `View::pick`; names of files and their columns in `Form` of `files/store/names.rs`; mathematics in the variants of [`motion::Motion`] |
//! | the carriage of an arm | [`link::ArmCarriage`]. In [`inverse`] and [`response`] it is the last of the joints. `ArmPeriod::carried_by` moves the base of the inversion, `Linkage::base` that of the moved arm |
//! | a column of torque.csv | its name in `TORQUE` in `files/store/names.rs`; its history in `of_solution` and `of_played` in `run_tables.rs`. `read_run.rs` refuses a table without the column: raise `FORMAT` in `json.rs`. All columns of the file share the decimals of one peak |
//! | a number of each joint in summary.json, sweeps and limits | one entry in `study/result/quantities.rs` |
//! | a warning | a variant of [`inverse::Warning`] or [`response::SimulationWarning`], whose text, kind and hint the compiler demands, or a [`result::Notice`] of `study/fit/advice.rs`; all become a `Notice`. `Solution`, `Played` and `FitOutcome` return it, each command prints it, `store` writes it. Commands with `--deny-warnings` pass the number to `WarningArgs::refuse`, which ends with exit code 4; `tests/cli/warnings.rs` checks the commands |
//! | an option of several commands | `cli/options` |
//!
//! # Invariants
//!
//! * [`numeric`] knows no beam, [`link`] knows no file.
//! * Only the floor `files` reads and writes files of the user. Only `cli` prints.
//! * A [`link::Link`] or [`motion::TipMotion`] is valid from its construction. Input is refused, not repaired.
//! * Functions return warnings; they never print them.
//! * Everything inside is SI.
//! * The same input gives the same bytes, on any number of threads and on every processor. No sum depends on the
//!   sharing of work or on the width of vectors, no product is fused with a sum, and all functions beyond the square
//!   root come from `libm`. Two kinds of numbers have other last digits on other processors, since faer rounds
//!   differently there: [`model::Dense`], whose bound `verify` writes, and the fitted values of [`fit`], which have
//!   fewer digits in files.
//!
//! # References
//!
//! * E. Bayo, J. Robotic Systems 4(1), 63-75, 1987.
//! * K. J. Bathe, *Finite Element Procedures in Engineering Analysis*, 1982: Hermite elements.
//! * W. H. Wittrick, F. W. Williams, Q. J. Mech. Appl. Math. 24(3), 1971: counting modes.
//! * S. P. Timoshenko, Phil. Mag. 41, 1921; J. S. Przemieniecki, *Theory of Matrix Structural Analysis*, 1968;
//!   G. R. Cowper, J. Applied Mechanics 33, 1966: beams with shear.
//! * C. F. Van Loan, IEEE Trans. Automatic Control 23(3), 1978: integrals with the exponential.
//! * R. Featherstone, *Robot Dynamics Algorithms*, 1987: articulated-body inertia.

#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "cli")]
#[doc(hidden)] // the program, for `main.rs` and for Python: its names may change at any time
pub mod cli;
mod files;
mod mechanics;
#[cfg(feature = "report")]
pub mod page;
mod study;

pub use files::{csv, measured, spec, store};
pub use mechanics::{
    beam, elastica, inverse, link, modal, model, motion, numeric, recording, response, system, text,
};
pub use study::{compare, fit, learn, result, robust, sweep, verify};
