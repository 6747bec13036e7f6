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
        let constant = Taper::constant;
        let mesh = meshed(
            // The second is the first, gone on with; the last one tapers.
            vec![
                segment(0.25, constant(4.1), constant(0.7)),
                segment(1.0, constant(4.1), constant(0.7)),
                segment(0.6, constant(5.0), constant(0.7)),
                segment(0.2, Taper { inner: 5.0, outer: 2.0 }, constant(0.7)),
            ],
            &[1, 4, 3, 2],
            &[0.75],
        );
        assert_eq!(mesh.rows(), [0..3, 3..5, 5..8, 8..9, 9..10]);
        assert_eq!(mesh.refined().rows(), [0..6, 6..10, 10..16, 16..17, 17..18, 18..19, 19..20]);
    }

    #[test]
    fn equal_elements_that_taper_are_no_row() {
        let (taper, constant) = (Taper { inner: 6.0, outer: 4.0 }, Taper::constant(0.7));
        for (stiffness, density) in [(taper, constant), (constant, taper)] {
            let tooth = segment(0.5, stiffness, density);
            let mesh = meshed(vec![tooth.clone(), tooth], &[1, 1], &[]);
            assert_eq!(mesh.elements()[0], mesh.elements()[1]);
            assert_eq!(mesh.rows(), [0..1, 1..2]);
        }
    }

    #[test]
    fn a_mass_ends_a_row_where_segments_meet_and_not_at_the_ends_of_the_link() {
        let half = segment(0.5, Taper::constant(4.1), Taper::constant(0.7));
        let starts = |masses_at_m: &[f64]| -> Vec<usize> {
            let mesh = meshed(vec![half.clone(), half.clone()], &[2, 2], masses_at_m);
            mesh.rows().iter().map(|row| row.start).collect()
        };
        assert_eq!(starts(&[]), [0]);
        assert_eq!(starts(&[0.5]), [0, 2]);
        assert_eq!(starts(&[0.0, 1.0]), [0]);
    }

    fn segment(
        length_m: f64,
        bending_stiffness_n_m2: Taper,
        mass_per_length_kg_m: Taper,
    ) -> Segment {
        Segment {
            name: None,
            length_m,
            bending_stiffness_n_m2,
            mass_per_length_kg_m,
            cross_section: None,
        }
    }

    fn meshed(segments: Vec<Segment>, counts: &[usize], masses_at_m: &[f64]) -> Mesh {
        let mass = |at_m: &f64| LumpedMass { at_m: *at_m, mass_kg: 0.1, inertia_kg_m2: 0.0 };
        let masses = masses_at_m.iter().map(mass).collect();
        let link = Link::new(LinkParts { segments, masses, ..uniform() }).unwrap();
        let own: Vec<_> = counts.iter().copied().map(Some).collect();
        Mesh::new(&link, &MeshPlan::new(&link, &own, None, 1e-6).unwrap())
    }
}
