//! Places on a link that its mesh has nodes at.

use super::plan::{MeshPlan, Piece, root_m};
use crate::link::{Link, POSITION_TOLERANCE, ParameterError};

/// Largest distance between a place and its node, as a share of the link's length.
const PLACE_TOLERANCE: f64 = 1e-8;

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

#[cfg(test)]
mod tests {
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
