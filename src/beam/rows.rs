//! Which elements are equal and stand in a row, so that they can be condensed together.

use std::ops::Range;

use super::mesh::Mesh;

impl Mesh {
    /// The mesh with its rows told apart.
    pub(super) fn with_rows(mut self) -> Self {
        let mut rows: Vec<Range<usize>> = vec![];
        for (index, element) in self.elements().iter().enumerate() {
            let goes_on = self.lumped_inertia(index).is_none()
                && index.checked_sub(1).is_some_and(|before| self.elements()[before] == *element)
                && element.bending_stiffness_n_m2.is_constant()
                && element.mass_per_length_kg_m.is_constant();
            match rows.last_mut() {
                Some(row) if goes_on => row.end += 1,
                _ => rows.push(index..index + 1),
            }
        }
        self.rows = rows;
        self
    }

    /// Rows of elements that are equal and alike from end to end, with nothing lumped between them;
    /// any other element is a row by itself.
    pub(super) fn rows(&self) -> &[Range<usize>] {
        &self.rows
    }
}

#[cfg(test)]
mod tests {
    use crate::beam::{Mesh, MeshPlan};
    use crate::link::{Link, LinkParts, LumpedMass, Segment, Taper, uniform};

    #[test]
    fn equal_elements_stand_in_rows_between_masses() {
        let segment = |length_m, inner, outer| Segment {
            name: None,
            length_m,
            bending_stiffness_n_m2: Taper { inner, outer },
            mass_per_length_kg_m: Taper::constant(0.7),
        };
        let mass = LumpedMass { at_m: 0.75, mass_kg: 0.1, inertia_kg_m2: 0.0 };
        let link = Link::new(LinkParts {
            // The second is the first, gone on with; the last one tapers.
            segments: vec![
                segment(0.25, 4.1, 4.1),
                segment(1.0, 4.1, 4.1),
                segment(0.6, 5.0, 5.0),
                segment(0.2, 5.0, 2.0),
            ],
            masses: vec![mass],
            ..uniform()
        })
        .unwrap();
        let own = [1, 4, 3, 2].map(Some);
        let mesh = Mesh::new(&link, &MeshPlan::new(&link, &own, None, 1e-6).unwrap());
        assert_eq!(mesh.rows(), [0..3, 3..5, 5..8, 8..9, 9..10]);
        assert_eq!(mesh.refined().rows(), [0..6, 6..10, 10..16, 16..17, 17..18, 18..19, 19..20]);
    }
}
