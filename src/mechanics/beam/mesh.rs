//! A link's mesh of elements and its nodes; plans of meshes with nodes at places on the link, and through the nodes of
//! a table.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use super::element::{Element, RelativeElement};
use super::inertia::Inertia;
use super::plan::{MeshPlan, Piece, pieces, root_m};
use crate::link::{Joint, Link, POSITION_TOLERANCE, ParameterError, Taper};
use crate::numeric::Scalar;

/// Largest distance between a place and its node, as a share of the link's length.
const PLACE_TOLERANCE: f64 = 1e-8;

/// Largest number of elements of a mesh refined for a frequency instead of a torque.
const MOST_ELEMENTS: usize = 8192;

/// The finite-element link: n elements between n + 1 nodes, node 0 at the root, node n at the tip.
///
/// A spring between joint and root is element 0, without length; both its nodes are at the root.
///
/// Total displacement of node i: `v_i = x_i θ + w_i`, with `w_0 = 0` (Bayo 1987, eq 1). The degrees of freedom are θ
/// and (w, w') of nodes 1 … n, 2n + 1 in all.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    elements: Vec<Element>,
    relative: Vec<RelativeElement>,
    /// Segment of each element.
    segments: Vec<usize>,
    /// Distance of each node from the axis in m.
    nodes_m: Vec<f64>,
    bodies: Bodies,
    /// Number of the node whose motion is prescribed.
    output: usize,
    /// λ in 1/s² up to which the link is rigid to the last digit.
    pub(super) rigid_lambda: f64,
}

/// All inertia except the elements'.
#[derive(Debug, Clone, PartialEq)]
struct Bodies {
    /// Inertia lumped at each node except the tip.
    lumped: Vec<Option<Inertia<f64>>>,
    tip: Inertia<f64>,
    joint: Joint,
}

impl Mesh {
    /// Divides the link by `plan`; an automatic plan gives its coarsest mesh.
    ///
    /// Every segment border and every lumped mass has a node.
    ///
    /// # Errors
    /// [`ParameterError`] if the plan belongs to a link with other segments or other places of masses.
    pub fn new(link: &Link, plan: &MeshPlan) -> Result<Self, ParameterError> {
        plan.check(link)?;
        Ok(Self::planned(link, plan))
    }

    /// [`Mesh::new`] with a plan that is known to fit the link.
    pub(super) fn planned(link: &Link, plan: &MeshPlan) -> Self {
        let spring = link.root_stiffness_n_m_rad().map(Element::spring);
        let mut elements: Vec<_> = spring.into_iter().collect();
        let mut segments = vec![0; elements.len()];
        for (piece, count) in plan.shares() {
            let segment = &link.segments()[piece.segment];
            for k in 0..*count {
                let at = |k: usize| piece.from + (piece.to - piece.from) * k as f64 / *count as f64;
                let (from, to) = (at(k), at(k + 1));
                elements.push(Element {
                    length_m: segment.length_m * (piece.to - piece.from) / *count as f64,
                    bending_stiffness_n_m2: segment.bending_stiffness_n_m2.between(from, to),
                    mass_per_length_kg_m: segment.mass_per_length_kg_m.between(from, to),
                    timoshenko: segment.timoshenko.map(|own| own.between(from, to)),
                });
                segments.push(piece.segment);
            }
        }
        let nodes_m = node_positions(link.hub().radius_m, &elements);
        // Both nodes of a spring lie at the root; the link has the outer one.
        let springs = usize::from(spring.is_some());
        let node = |at_m: f64| springs + nearest_node(&nodes_m[springs..], at_m);
        let (bodies, output) = (Bodies::of(link, nodes_m.len(), node), node(link.output_m()));
        Self::assemble((elements, segments), nodes_m, bodies, output)
    }

    fn assemble(
        (elements, segments): (Vec<Element>, Vec<usize>),
        nodes_m: Vec<f64>,
        bodies: Bodies,
        output: usize,
    ) -> Self {
        let mut relative: Vec<_> = elements.iter().map(Element::relative).collect();
        let lumped = bodies.lumped.iter().flatten().chain([&bodies.tip]);
        let rigid_lambda = rigid_lambda((&elements, &relative), lumped, nodes_m[nodes_m.len() - 1]);
        limit_stiffness(&mut relative, rigid_lambda);
        Self { elements, relative, segments, nodes_m, bodies, output, rigid_lambda }
    }

    /// Number of springs at the root, 0 or 1: the first node of the link itself.
    pub fn springs(&self) -> usize {
        usize::from(self.elements[0].is_spring())
    }

    /// The mesh with every element halved, except the spring of the root.
    #[must_use]
    pub fn refined(&self) -> Self {
        let springs = self.springs();
        let (spring, beam) = self.elements.split_at(springs);
        let halves = beam.iter().flat_map(Element::halves);
        let elements: Vec<Element> = spring.iter().copied().chain(halves).collect();
        let mut lumped = vec![None; elements.len() + 1];
        for (node, inertia) in self.bodies.lumped.iter().enumerate().skip(springs) {
            lumped[self.refined_node(node)] = *inertia;
        }
        let segments = self.segments.iter().flat_map(|s| [*s, *s]).skip(springs).collect();
        let nodes_m = node_positions(self.nodes_m[0], &elements);
        let bodies = Bodies { lumped, ..self.bodies };
        Self::assemble((elements, segments), nodes_m, bodies, self.refined_node(self.output))
    }

    /// Number of a node of this mesh in [`Self::refined`].
    pub fn refined_node(&self, node: usize) -> usize {
        (2 * node).saturating_sub(self.springs())
    }

    /// Halves all elements until natural frequencies up to `omega_rad_s` are exact to `tolerance`, or the mesh has
    /// thousands of elements.
    ///
    /// The elements raise a natural frequency by `Δω/ω = (βh)⁴/1440` at most, with shear by `ω²h² m̄/(24 κGA)` more;
    /// both grow with ω².
    #[must_use]
    pub fn resolving(mut self, omega_rad_s: f64, tolerance: f64) -> Self {
        let error = |mesh: &Self| 0.01 * (omega_rad_s / mesh.resolved_frequency_rad_s()).powi(2);
        while error(&self) > tolerance && 2 * self.elements.len() <= MOST_ELEMENTS {
            self = self.refined();
        }
        self
    }

    /// Elements from the hub outward.
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// Elements in relative coordinates.
    pub fn relative_elements(&self) -> &[RelativeElement] {
        &self.relative
    }

    /// The mesh on another joint of the same kind and radius.
    pub(crate) fn with_joint(mut self, joint: Joint) -> Self {
        self.bodies.joint = joint;
        self
    }

    /// Segment of each element.
    pub fn element_segments(&self) -> &[usize] {
        &self.segments
    }

    /// Distance of each node from the axis in m: n + 1 values, the last one the length L.
    pub fn nodes_m(&self) -> &[f64] {
        &self.nodes_m
    }

    /// Distance L from the axis to the tip in m.
    pub fn length_m(&self) -> f64 {
        self.nodes_m[self.nodes_m.len() - 1]
    }

    /// Refuses node numbers that the mesh does not have.
    pub(crate) fn check_nodes(&self, nodes: &[usize]) -> Result<(), ParameterError> {
        let last = self.elements.len();
        let Some(node) = nodes.iter().find(|node| **node > last) else { return Ok(()) };
        Err(ParameterError::new(
            "nodes",
            node,
            "",
            format!("must be nodes of the mesh, 0 to {last}"),
        ))
    }

    /// Inertia lumped at a node, without payload and masses at the tip; `None` if the node does not exist or carries no
    /// inertia.
    pub fn lumped_inertia(&self, node: usize) -> Option<Inertia<f64>> {
        self.bodies.lumped.get(node).copied().flatten()
    }

    /// Payload and masses at the tip: the apparent inertia at the start of the recursion.
    ///
    /// ```text
    /// A_tip = [[m_t, m_t c], [m_t c, J_t + m_t c²]]
    /// ```
    pub fn tip_inertia(&self) -> Inertia<f64> {
        self.bodies.tip
    }

    /// The joint that moves the root.
    pub fn joint(&self) -> &Joint {
        &self.bodies.joint
    }

    /// Displacement and slope of a node of the rigid link per unit of the joint's position.
    #[inline(always)]
    pub fn rigid(&self, node: usize) -> [f64; 2] {
        self.bodies.joint.rigid(self.nodes_m[node])
    }

    /// Number of the node whose motion is prescribed: the tip, or that of a station on the link.
    #[inline(always)]
    pub fn output(&self) -> usize {
        self.output
    }

    /// Distance of the output from the axis in m.
    #[inline(always)]
    pub fn output_m(&self) -> f64 {
        self.nodes_m[self.output]
    }

    /// Displacement of the rigid link's output per unit of the joint's position: of the tip, the length L of a link that
    /// turns, 1 of one that slides.
    pub fn rigid_tip(&self) -> f64 {
        self.rigid(self.output)[0]
    }

    /// A mass in kg of the order of the link's mass, for comparing forces with motions.
    pub(super) fn reference_mass_kg(&self) -> f64 {
        let beam: f64 = self.relative.iter().map(|e| e.m_uu.m11).sum();
        let lumped: f64 = self.bodies.lumped.iter().flatten().map(|l| l.vv).sum();
        let hub = self.joint().inertia() / self.rigid_tip().powi(2);
        beam + lumped + self.bodies.tip.vv + hub
    }

    /// Ratio of the discretisation error to the change from halving all elements. The error falls with the fourth power
    /// of the element length: halving leaves a sixteenth, a change of 15/16. With shear in any element it falls with
    /// the second power at worst.
    pub fn error_per_change(&self) -> f64 {
        if self.has_shear() { 4.0 / 3.0 } else { 16.0 / 15.0 }
    }

    /// True if any element has shear and rotary inertia.
    pub fn has_shear(&self) -> bool {
        self.elements.iter().any(|element| element.timoshenko.is_some())
    }

    /// Frequency in rad/s up to which every element follows the bending waves; natural frequencies are off by 1 %
    /// there.
    pub fn resolved_frequency_rad_s(&self) -> f64 {
        let resolved = self.elements.iter().map(Element::resolved_frequency_rad_s);
        resolved.fold(f64::INFINITY, f64::min)
    }

    /// 1/λ in s², for the recursion. If λ is so small that the link is rigid to the last digit, for example 0, it is
    /// 1/λ of the largest such λ: finite, and with the same answers.
    #[inline(always)]
    pub fn per_lambda<S: Scalar>(&self, lambda: S) -> S {
        let least = lambda.lift(self.rigid_lambda).size();
        // The reciprocal of the larger λ would not do: for a nearly rigid link its square overflows.
        let of_rigid = lambda.lift(1.0 / self.rigid_lambda);
        S::choose(least, lambda.size(), of_rigid, lambda.reciprocal())
    }
}

impl Bodies {
    /// All inertia of a link on this many nodes; `node` finds the one at a place.
    fn of(link: &Link, nodes: usize, node: impl Fn(f64) -> usize) -> Self {
        let mut lumped: Vec<Option<Inertia<f64>>> = vec![None; nodes];
        for mass in link.masses() {
            // The plan puts a node at or next to every lumped mass.
            let there = &mut lumped[node(mass.at_m)];
            let there = there.get_or_insert(Inertia::rigid(0.0, 0.0, 0.0));
            there.vv += mass.mass_kg;
            there.pp += mass.inertia_kg_m2;
        }
        let payload = link.payload();
        let mut tip = Inertia::rigid(payload.mass_kg, payload.inertia_kg_m2, payload.offset_m);
        // The recursion starts from the sum of payload and masses at the tip.
        if let Some(last) = lumped.last_mut().and_then(Option::take) {
            tip.vv += last.vv;
            tip.pp += last.pp;
        }
        Self { lumped, tip, joint: link.joint() }
    }
}

/// Running sum of the element lengths, compensated so that many elements lose no digit.
fn node_positions(root_m: f64, elements: &[Element]) -> Vec<f64> {
    let (mut sum, mut rest) = (root_m, 0.0);
    let mut nodes = vec![root_m];
    for element in elements {
        let term = element.length_m - rest;
        let next = sum + term;
        rest = (next - sum) - term;
        sum = next;
        nodes.push(sum);
    }
    nodes
}

/// Number of the node at a distance from the axis in m, if the mesh has one.
pub fn node_at(nodes_m: &[f64], at_m: f64) -> Option<usize> {
    let node = nearest_node(nodes_m, at_m);
    let tip_m = nodes_m.last()?;
    ((nodes_m[node] - at_m).abs() <= PLACE_TOLERANCE * tip_m).then_some(node)
}

/// Number of the node nearest to a place; 0 without nodes.
pub(crate) fn nearest_node(nodes_m: &[f64], place_m: f64) -> usize {
    let distance = |node: &usize| (nodes_m[*node] - place_m).abs();
    (0..nodes_m.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

/// Ratio of bending to rigid motion below which rounding of any sum hides it.
const NEGLIGIBLE: f64 = 1.0 / (1_u128 << 70) as f64;

/// Largest `K_d/λ` in kg or kg m²: finite, with room for further terms.
const STIFFEST: f64 = 1e280;

/// λ in 1/s² up to which a link of length L is rigid: all inertia, placed at the distance L from the axis, bends all
/// elements in series by a negligible angle.
///
/// ```text
/// λ Σ(|A_vv| L² + 2 |A_vφ| L + |A_φφ|) Σ(l/EI + l/(κGA L²)) = 2⁻⁷⁰
/// ```
fn rigid_lambda<'a>(
    (elements, relative): (&[Element], &[RelativeElement]),
    bodies: impl Iterator<Item = &'a Inertia<f64>>,
    length_m: f64,
) -> f64 {
    let flexibility = |element: &Element| {
        let Taper { inner, outer } = element.bending_stiffness_n_m2;
        let shear = element.timoshenko.map_or(0.0, |own| {
            let Taper { inner, outer } = own.shear_stiffness_n;
            element.length_m / (inner.min(outer) * length_m.powi(2))
        });
        // A spring turns by M/k, a beam by M l/EI.
        let length_m = if element.is_spring() { 1.0 } else { element.length_m };
        length_m / inner.min(outer) + shear
    };
    let beam = relative.iter().map(|element| {
        let mass = element.m_uu;
        Inertia { vv: mass.m11, vp: mass.m12, pp: mass.m22 }
    });
    let about_axis =
        |a: Inertia<f64>| (a.vv.abs() * length_m + 2.0 * a.vp.abs()) * length_m + a.pp.abs();
    let inertia: f64 = beam.chain(bodies.copied()).map(about_axis).sum();
    let slowness_s2 = inertia * elements.iter().map(flexibility).sum::<f64>();
    // Without any inertia nothing bends at any λ.
    if slowness_s2 > 0.0 { NEGLIGIBLE / slowness_s2 } else { 1.0 }
}

/// Lowers the stiffness of elements whose `K_d/λ` would overflow at the rigid limit: beside the others they do not bend
/// by any digit either way.
fn limit_stiffness(elements: &mut [RelativeElement], rigid_lambda: f64) {
    let most = STIFFEST * rigid_lambda;
    for element in elements {
        let largest = element.k_d.m11.max(element.k_d.m22);
        if largest > most {
            element.k_d *= most / largest;
        }
    }
}

impl MeshPlan {
    /// Adds a node at each of these distances from the axis in m: the places divide pieces as lumped masses do.
    ///
    /// # Errors
    /// [`ParameterError`] names the first place that is not on the link.
    pub fn with_nodes_at(
        mut self,
        link: &Link,
        stations_m: &[f64],
    ) -> Result<Self, ParameterError> {
        self.check(link)?;
        let slack_m = POSITION_TOLERANCE * link.length_m();
        let mut sorted_m = stations_m.to_vec();
        sorted_m.sort_by(f64::total_cmp);
        for at_m in sorted_m {
            link.check_place("stations", at_m)?;
            let cut = |(piece, count)| cut(link, (piece, count), at_m, slack_m);
            self.shares = self.shares.into_iter().flat_map(cut).collect();
        }
        Ok(self)
    }

    /// The plan of a mesh with nodes at these distances from the axis in m, which may be rounded as in tables.
    ///
    /// Every piece between segment borders, lumped masses and stations gets one element between neighbouring nodes.
    ///
    /// # Errors
    /// [`ParameterError`] names the first station that is not on the link, or the first node more than 1e-6 of the
    /// link's length away from the mesh's node.
    pub fn through(
        link: &Link,
        nodes_m: &[f64],
        stations_m: &[f64],
    ) -> Result<Self, ParameterError> {
        let mut inner = usize::from(link.root_stiffness_n_m_rad().is_some());
        let mut shares = Vec::new();
        let whole = pieces(link).into_iter().map(|piece| (piece, 1)).collect();
        let divided = Self::shared(whole).with_nodes_at(link, stations_m)?;
        for (piece, _) in divided.shares().iter().copied() {
            let segment = &link.segments()[piece.segment];
            let root_m = root_m(link, piece.segment);
            let end_m = root_m + segment.length_m * piece.to;
            let outer = nearest_node(nodes_m, end_m);
            if outer <= inner {
                let must = format!(
                    "must hold one at {end_m} m, where a segment ends, or a mass or a station is"
                );
                return Err(refused(nodes_m.get(outer).copied(), &must));
            }
            shares.push((piece, outer - inner));
            inner = outer;
        }
        let plan = Self::shared(shares);
        check(nodes_m, &Mesh::planned(link, &plan))?;
        Ok(plan)
    }
}

/// Cuts a piece in two at a place inside it and shares its elements, so that no element gets longer.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share of the elements is a whole number"
)]
fn cut(
    link: &Link,
    (piece, count): (Piece, usize),
    at_m: f64,
    slack_m: f64,
) -> Vec<(Piece, usize)> {
    let length_m = link.segments()[piece.segment].length_m;
    let at = (at_m - root_m(link, piece.segment)) / length_m;
    let slack = slack_m / length_m;
    if at <= piece.from + slack || at >= piece.to - slack {
        return vec![(piece, count)];
    }
    let element = (piece.to - piece.from) / count as f64;
    // If a node is there already, every element stays as it is.
    let elements = |from: f64, to: f64| ((to - from - slack) / element).ceil() as usize;
    let inner = Piece { to: at, ..piece };
    let outer = Piece { from: at, ..piece };
    [inner, outer].map(|own| (own, elements(own.from, own.to))).into()
}

/// Largest distance between a listed node and the mesh's node, as a share of the link's length.
const NODE_TOLERANCE: f64 = 1e-6;

fn check(nodes_m: &[f64], mesh: &Mesh) -> Result<(), ParameterError> {
    let slack_m = NODE_TOLERANCE * mesh.length_m();
    for (node, (found_m, own_m)) in nodes_m.iter().zip(mesh.nodes_m()).enumerate() {
        let is_there = (found_m - own_m).abs() <= slack_m;
        if !is_there {
            let must = format!(
                "must be {own_m} m at node {node}: a mesh divides every stretch between borders of \
                 segments and lumped masses evenly"
            );
            return Err(refused(Some(*found_m), &must));
        }
    }
    match nodes_m.get(mesh.nodes_m().len()) {
        Some(beyond_m) => Err(refused(Some(*beyond_m), "must end at the tip")),
        None => Ok(()),
    }
}

fn refused(found_m: Option<f64>, must: &str) -> ParameterError {
    match found_m {
        Some(found_m) => ParameterError::new("nodes.x_m", found_m, "m", must),
        None => ParameterError::new("nodes.x_m", "nothing", "", must),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{
        Hub, LinkParts, LumpedMass, Payload, Segment, Taper, uniform, uniform_segment,
    };

    fn mesh() -> Mesh {
        let segment = |length_m, ei| Segment {
            length_m,
            bending_stiffness_n_m2: ei,
            mass_per_length_kg_m: Taper { inner: 0.8, outer: 0.5 },
            ..uniform_segment()
        };
        let mass = |at_m| LumpedMass { at_m, mass_kg: 0.1, inertia_kg_m2: 0.02 };
        let link = Link::new(LinkParts {
            segments: vec![
                segment(0.3, Taper::constant(50.0)),
                segment(1.2, Taper { inner: 8.0, outer: 2.0 }),
            ],
            hub: Hub { radius_m: 0.1, ..Hub::default() },
            masses: vec![mass(1.6), mass(0.7), mass(0.1), mass(0.7)],
            payload: Payload { mass_kg: 0.2, inertia_kg_m2: 0.01, offset_m: 0.1 },
            ..uniform()
        })
        .unwrap();
        Mesh::new(&link, &MeshPlan::new(&link, &[Some(1), Some(4)], None, 1e-6).unwrap()).unwrap()
    }

    #[test]
    fn borders_and_masses_have_nodes_and_these_their_inertia() {
        let mesh = mesh();
        let expected = [0.1, 0.4, 0.7, 1.0, 1.3, 1.6];
        for (x_m, expected) in mesh.nodes_m().iter().zip(expected) {
            assert!((x_m - expected).abs() < 1e-15);
        }
        let lumped = |node| mesh.lumped_inertia(node).map(|l| (l.vv, l.vp, l.pp));
        assert_eq!(lumped(0), Some((0.1, 0.0, 0.02)));
        assert_eq!(lumped(2), Some((0.2, 0.0, 0.04)));
        assert_eq!([1, 3, 4, 5].map(lumped), [None; 4]);
        // The mass at the tip joins the payload: 0.2 kg at 0.1 m, 0.01 + 0.02 kg m².
        let Inertia { vv, vp, pp } = mesh.tip_inertia();
        assert!((vv - 0.3).abs() < 1e-15 && (vp - 0.02).abs() < 1e-15);
        assert!((pp - 0.032).abs() < 1e-15);
    }

    #[test]
    fn a_mass_a_hair_beside_a_border_finds_a_node() {
        for hair in [0.0, 5e-10, 1.7e-9, 1.9e-9, 2.1e-9, 1e-8] {
            let segment = |length_m| Segment { length_m, ..uniform_segment() };
            let mass = LumpedMass { at_m: 0.7 + hair, mass_kg: 0.1, inertia_kg_m2: 0.0 };
            let (segments, masses) = (vec![segment(0.7), segment(1.2)], vec![mass]);
            let link = Link::new(LinkParts { segments, masses, ..uniform() }).unwrap();
            let mesh =
                Mesh::new(&link, &MeshPlan::new(&link, &[None; 2], None, 1e-6).unwrap()).unwrap();
            let node = (0..mesh.nodes_m().len()).find(|k| mesh.lumped_inertia(*k).is_some());
            assert!((mesh.nodes_m()[node.unwrap()] - 0.7).abs() < 2e-8, "hair {hair:e}");
        }
    }

    #[test]
    fn refining_keeps_tapers_masses_and_length() {
        let (coarse, fine) = (mesh(), mesh().refined());
        assert_eq!(fine.elements().len(), 10);
        assert_eq!(fine.lumped_inertia(4), coarse.lumped_inertia(2));
        assert!((fine.length_m() - 1.6).abs() < 1e-15);
        assert_eq!(fine.element_segments(), [0, 0, 1, 1, 1, 1, 1, 1, 1, 1]);
        assert!((fine.elements()[2].bending_stiffness_n_m2.outer - 7.25).abs() < 1e-14);
        let last = fine.elements()[9].bending_stiffness_n_m2;
        assert!((last.inner - 2.75).abs() < 1e-14 && (last.outer - 2.0).abs() < 1e-14);
    }

    #[test]
    fn four_thousand_nodes_end_where_the_link_does() {
        let mut mesh = mesh();
        for _ in 0..10 {
            mesh = mesh.refined();
        }
        assert!((mesh.length_m() - 1.6).abs() < 1e-15);
    }
}

#[cfg(test)]
mod tests_of_the_rigid_limit {
    use num_complex::Complex64;

    use crate::beam::test_links::mesh;
    use crate::beam::{Mesh, NodalTransfer, nodal_transfer};
    use crate::link::{
        Link, LinkParts, LumpedMass, Payload, Segment, Taper, uniform, uniform_segment,
    };

    /// The transfers at rest equal those of the lowest frequencies to the last digits, also the lags, which are per λ.
    #[test]
    fn a_link_at_rest_answers_as_one_that_hardly_moves() {
        let mesh = mesh(17);
        let NodalTransfer { tip, deflections_s2, moments_kg_m } =
            nodal_transfer(&mesh, Complex64::ZERO);
        assert!(
            tip.deflection_s2.re > 1e-4 || tip.deflection_s2.re < -1e-4,
            "{}",
            tip.deflection_s2
        );
        let rigid = mesh.rigid_lambda;
        let turned = Complex64::new(1.0, -0.04);
        for lambda in [1.1 * rigid, -1.1 * rigid, 1e-18, -1e-18]
            .map(Complex64::from)
            .into_iter()
            .chain([0.5 * rigid, 1.1 * rigid, 1e-18].map(|lambda| lambda * turned))
        {
            let slow = nodal_transfer(&mesh, lambda);
            let close = |a: &[Complex64], b: &[Complex64]| {
                a.iter().zip(b).all(|(a, b)| (a - b).norm() <= 1e-14 * b.norm())
            };
            assert!(close(&slow.deflections_s2, &deflections_s2), "λ = {lambda}");
            assert!(close(&slow.moments_kg_m, &moments_kg_m), "λ = {lambda}");
            let numbers = [slow.tip.inertia_kg_m, slow.tip.angle_rad_m, slow.tip.deflection_s2];
            assert!(close(&numbers, &[tip.inertia_kg_m, tip.angle_rad_m, tip.deflection_s2]));
        }
    }

    /// At the rigid limit no node bends by any digit of its travel, wherever the inertia is.
    #[test]
    fn a_link_at_its_rigid_limit_bends_by_no_digit() {
        let light = Payload::default();
        let heavy = Payload { mass_kg: 1e6, ..light };
        let turning = Payload { inertia_kg_m2: 1e6, ..light };
        let behind = Payload { mass_kg: 1e6, offset_m: -1.5, ..light };
        let mass = LumpedMass { at_m: 1.5, mass_kg: 1e6, inertia_kg_m2: 1e6 };
        for (payload, masses) in [
            (light, vec![]),
            (heavy, vec![]),
            (turning, vec![]),
            (behind, vec![]),
            (light, vec![LumpedMass { at_m: 0.75, ..mass }]),
        ] {
            let link = Link::new(LinkParts { masses, payload, ..uniform() }).unwrap();
            let mesh = Mesh::on(&link, 10);
            let transfer = nodal_transfer(&mesh, mesh.rigid_lambda.into());
            let bent = transfer.deflections_s2.iter().map(|lag| lag.norm() * mesh.rigid_lambda);
            let most = bent.fold(0.0, f64::max);
            assert!(most < 1e-4 * f64::EPSILON && most > 0.0, "{payload:?}: {most:e}");
        }
    }

    #[test]
    fn a_link_at_rest_is_rigid_however_soft_or_stiff() {
        for bending_stiffness in [1e-280, 1.0, 1e280, 1e305] {
            let bending_stiffness_n_m2 = Taper::constant(bending_stiffness);
            let segments = vec![Segment { bending_stiffness_n_m2, ..uniform_segment() }];
            let link = Link::new(LinkParts { segments, ..uniform() }).unwrap();
            let mesh = Mesh::on(&link, 3);
            let at_rest = nodal_transfer(&mesh, Complex64::ZERO).tip;
            let rigid = link.rigid_inertia_kg_m2() / mesh.length_m();
            let off = (at_rest.inertia_kg_m.re / rigid - 1.0).abs();
            assert!(off < 1e-14, "EI = {bending_stiffness} N m²: {off:e}");
        }
    }
}

#[cfg(test)]
mod tests_of_places {
    use super::*;
    use crate::beam::ElementCount;
    use crate::link::{Hub, LinkParts, LumpedMass, Segment, Taper, uniform, uniform_segment};

    fn rig(radius_m: f64, lengths_m: &[f64], masses_at_m: &[f64]) -> Link {
        let segment = |length_m: &f64| Segment {
            length_m: *length_m,
            bending_stiffness_n_m2: Taper { inner: 9.0, outer: 2.0 },
            mass_per_length_kg_m: Taper { inner: 0.8, outer: 0.3 },
            ..uniform_segment()
        };
        let mass = |at_m: &f64| LumpedMass { at_m: *at_m, mass_kg: 0.1, inertia_kg_m2: 0.0 };
        Link::new(LinkParts {
            segments: lengths_m.iter().map(segment).collect(),
            hub: Hub { radius_m, ..Hub::default() },
            masses: masses_at_m.iter().map(mass).collect(),
            ..uniform()
        })
        .unwrap()
    }

    /// Node positions rounded as in nodes.csv of a link of some metres.
    fn written(mesh: &Mesh) -> Vec<f64> {
        mesh.nodes_m().iter().map(|x_m| (x_m * 1e10).round() / 1e10).collect()
    }

    #[test]
    fn the_nodes_of_a_mesh_give_the_mesh_again() {
        for (link, stations_m) in [
            (rig(0.0, &[1.5], &[]), &[][..]),
            (rig(0.0, &[1.5], &[]), &[0.6, 0.75, 1.0 / 3.0]),
            (rig(0.1, &[0.3, 1.2], &[0.1, 0.7, 0.7, 1.0 / 1.7, 1.6]), &[]),
            (rig(0.1, &[0.3, 1.2], &[0.1, 0.7, 1.0 / 1.7, 1.6]), &[0.4, 0.7, 1.0 / 1.9, 1.6]),
            (rig(0.07, &[1.0 / 3.0, 0.001, 0.9], &[0.07 + 1.0 / 3.0 + 1e-8, 1.1]), &[]),
        ] {
            for count in [None, Some(ElementCount::Total(41)), Some(ElementCount::Auto)] {
                let own = vec![None; link.segments().len()];
                let plan = MeshPlan::new(&link, &own, count, 1e-6).unwrap();
                let plan = plan.with_nodes_at(&link, stations_m).unwrap();
                let mut mesh = Mesh::new(&link, &plan).unwrap();
                for refinement in 0..4 {
                    let through = MeshPlan::through(&link, &written(&mesh), stations_m).unwrap();
                    let again = Mesh::new(&link, &through).unwrap();
                    assert_eq!(again.element_segments(), mesh.element_segments());
                    for (k, (a, b)) in again.nodes_m().iter().zip(mesh.nodes_m()).enumerate() {
                        assert!((a - b).abs() < 1e-14, "node {k}, refined {refinement} times");
                        assert_eq!(again.lumped_inertia(k), mesh.lumped_inertia(k));
                    }
                    assert!(!through.is_automatic());
                    mesh = mesh.refined();
                }
            }
        }
    }

    #[test]
    fn nodes_of_no_mesh_of_the_link_are_refused() {
        let link = rig(0.0, &[0.5, 0.5], &[0.75]);
        let refusal =
            |nodes_m: &[f64]| MeshPlan::through(&link, nodes_m, &[]).unwrap_err().to_string();
        let even =
            "a mesh divides every stretch between borders of segments and lumped masses evenly";
        for (nodes_m, expected) in [
            (
                &[][..],
                "nothing, but must hold one at 0.5 m, where a segment ends, or a mass or a station is",
            ),
            (
                &[0.0, 0.5, 1.0],
                "0.5 m, but must hold one at 0.75 m, where a segment ends, or a mass or a station is",
            ),
            (&[0.0, 0.2, 0.5, 0.75, 1.0], &format!("0.2 m, but must be 0.25 m at node 1: {even}")),
            (&[0.0, 0.5, 0.75, 0.999], &format!("0.999 m, but must be 1 m at node 3: {even}")),
            (&[0.1, 0.5, 0.75, 1.0], &format!("0.1 m, but must be 0 m at node 0: {even}")),
            (
                &[0.0, f64::NAN, 0.5, 0.75, 1.0],
                &format!("NaN m, but must be 0.25 m at node 1: {even}"),
            ),
            (&[0.0, 0.5, 0.75, 1.0, 1.1], "1.1 m, but must end at the tip"),
        ] {
            assert_eq!(refusal(nodes_m), format!("nodes.x_m = {expected}"), "{nodes_m:?}");
        }
    }

    #[test]
    fn a_node_may_stand_a_millionth_of_the_length_off() {
        for length_m in [0.02, 300.0] {
            let link = rig(0.0, &[length_m], &[]);
            let takes = |share: f64| {
                let mut nodes_m: Vec<f64> =
                    (0..=4).map(|k| length_m * f64::from(k) / 4.0).collect();
                nodes_m[2] += share * length_m;
                MeshPlan::through(&link, &nodes_m, &[]).is_ok()
            };
            assert_eq!([-1.1e-6, -0.9e-6, 0.9e-6, 1.1e-6].map(takes), [false, true, true, false]);
        }
    }
}

#[cfg(test)]
mod tests_of_stations {
    use super::*;
    use crate::beam::Mesh;
    use crate::beam::test_links::of_stiffnesses as link;

    #[test]
    fn a_station_gets_a_node_and_no_element_gets_longer() {
        let link = link(&[5.0, 50.0], &[0.2]);
        let plan = MeshPlan::new(&link, &[Some(5), Some(4)], None, 1e-6).unwrap();
        let mesh = Mesh::new(&link, &plan).unwrap();
        let at = |stations_m: &[f64]| {
            Mesh::new(&link, &plan.clone().with_nodes_at(&link, stations_m).unwrap()).unwrap()
        };
        for (stations_m, elements) in [
            (mesh.nodes_m(), 9),
            (&[0.33], 10),
            (&[0.99, 0.01], 11),
            (&[0.55, 0.56, 0.33, 0.55], 12),
        ] {
            let cut = at(stations_m);
            assert_eq!(cut.elements().len(), elements, "{stations_m:?}");
            for station_m in stations_m {
                let off_m = |x_m: &f64| (x_m - station_m).abs();
                assert!(cut.nodes_m().iter().map(off_m).fold(1.0, f64::min) < 1e-15, "{station_m}");
            }
            let longest =
                |mesh: &Mesh| mesh.elements().iter().fold(0.0, |m, e| f64::max(m, e.length_m));
            assert!(longest(&cut) <= longest(&mesh) * (1.0 + 1e-7));
        }
    }

    #[test]
    fn a_station_beside_the_link_is_refused() {
        let link = link(&[5.0], &[]);
        for at_m in [-0.1, 0.501, f64::NAN] {
            let refused =
                MeshPlan::automatic(&link).with_nodes_at(&link, &[0.2, at_m]).unwrap_err();
            let must = "must lie on the link, from 0 m to 0.5 m from the axis";
            assert_eq!(refused.to_string(), format!("stations = {at_m} m, but {must}"));
        }
    }
}
