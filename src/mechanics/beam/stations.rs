//! Plans of meshes with nodes at places on the link, and through the nodes of a table.

use super::mesh::{Mesh, nearest_node};
use super::plan::{MeshPlan, Piece, pieces, root_m};
use crate::link::{Link, POSITION_TOLERANCE, ParameterError};

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

impl MeshPlan {
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
        let mut inner = 0;
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
