//! Gauss points and bodies along a link's mesh: shapes of the elements, and integrals from the axis outward.

use crate::beam::{Inertia, Mesh};
use crate::link::Payload;

/// Number of points in an element.
pub(super) const POINTS: usize = 5;

/// Places of the five Gauss-Legendre points in (0, 1).
const PLACES: [f64; POINTS] = [
    0.046_910_077_030_668_0,
    0.230_765_344_947_158_45,
    0.5,
    0.769_234_655_052_841_6,
    0.953_089_922_969_332,
];

/// Weights of the points, with sum 1.
const WEIGHTS: [f64; POINTS] = [
    0.118_463_442_528_094_54,
    0.239_314_335_249_683_23,
    0.284_444_444_444_444_45,
    0.239_314_335_249_683_23,
    0.118_463_442_528_094_54,
];

/// One Gauss point of an element; all zero but its place on the spring of the root, which has no length.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Point {
    /// Distance from the axis along the link in m.
    pub(super) s_m: f64,
    /// Length in m that the point represents.
    pub(super) weight_m: f64,
    /// Mass per length in kg/m.
    pub(super) mass_kg_m: f64,
    /// Bending stiffness in N m².
    pub(super) stiffness_n_m2: f64,
    /// Hermite's cubics on (w, w') of both nodes.
    pub(super) shape: [f64; 4],
    /// Their first derivatives.
    pub(super) slope: [f64; 4],
    /// Their second derivatives.
    pub(super) curvature: [f64; 4],
}

/// A body at the end of an arm along the slope of a node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Body {
    pub(super) node: usize,
    pub(super) mass_kg: f64,
    pub(super) inertia_kg_m2: f64,
    pub(super) arm_m: f64,
}

impl Body {
    /// All bodies of a mesh with this payload, from the axis outward.
    pub(super) fn all_of(mesh: &Mesh, payload: &Payload) -> Vec<Self> {
        let last = mesh.elements().len();
        let lumped = (0..last).filter_map(|node| {
            let Inertia { vv, pp, .. } = mesh.lumped_inertia(node)?;
            Some(Self { node, mass_kg: vv, inertia_kg_m2: pp, arm_m: 0.0 })
        });
        // The payload's offset does not apply to a mass on the tip.
        let Inertia { vv, pp, .. } = mesh.tip_inertia();
        let arm_m = payload.offset_m;
        let carried = payload.mass_kg * arm_m * arm_m + payload.inertia_kg_m2;
        let on_tip = Self {
            node: last,
            mass_kg: vv - payload.mass_kg,
            inertia_kg_m2: pp - carried,
            arm_m: 0.0,
        };
        let payload = Self {
            node: last,
            mass_kg: payload.mass_kg,
            inertia_kg_m2: payload.inertia_kg_m2,
            arm_m,
        };
        lumped.chain([on_tip, payload]).collect()
    }
}

/// The points of a mesh, and the integration of functions within an element from their values at its points.
#[derive(Debug, Clone)]
pub(super) struct Points {
    /// Points of each element.
    pub(super) elements: Vec<[Point; POINTS]>,
    /// Weights of the values at the points in the integral from an element's inner end to each point, relative to its
    /// length.
    within: [[f64; POINTS]; POINTS],
}

impl Points {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let elements = mesh.elements().iter().zip(mesh.nodes_m());
        let points = elements.map(|(element, inner_m)| {
            let l = element.length_m;
            if element.is_spring() {
                return [Point { s_m: *inner_m, ..Point::default() }; POINTS];
            }
            [0, 1, 2, 3, 4].map(|k| {
                let x = PLACES[k];
                Point {
                    s_m: inner_m + l * x,
                    weight_m: l * WEIGHTS[k],
                    mass_kg_m: element.mass_per_length_kg_m.at(x),
                    stiffness_n_m2: element.bending_stiffness_n_m2.at(x),
                    shape: [
                        (1.0 - x) * (1.0 - x) * (1.0 + 2.0 * x),
                        l * x * (1.0 - x) * (1.0 - x),
                        x * x * (3.0 - 2.0 * x),
                        l * x * x * (x - 1.0),
                    ],
                    slope: [
                        -6.0 * x * (1.0 - x) / l,
                        (1.0 - x) * (1.0 - 3.0 * x),
                        6.0 * x * (1.0 - x) / l,
                        x * (3.0 * x - 2.0),
                    ],
                    curvature: [
                        (12.0 * x - 6.0) / (l * l),
                        (6.0 * x - 4.0) / l,
                        (6.0 - 12.0 * x) / (l * l),
                        (6.0 * x - 2.0) / l,
                    ],
                }
            })
        });
        Self { elements: points.collect(), within: within() }
    }

    /// Integral of a function up to each point of an element, from its integral up to the element's inner end, which it
    /// advances to the outer end.
    #[inline]
    pub(super) fn integrated(
        &self,
        element: usize,
        inner: &mut f64,
        values: &[f64; POINTS],
    ) -> [f64; POINTS] {
        let points = &self.elements[element];
        let length_m: f64 = points.iter().map(|point| point.weight_m).sum();
        let up_to = std::array::from_fn(|k| *inner + length_m * dot(&self.within[k], values));
        *inner +=
            points.iter().zip(values).map(|(point, value)| point.weight_m * value).sum::<f64>();
        up_to
    }

    /// Transpose of [`Self::integrated`]: the sum of `forces` outboard of each point, with the weights of the integral,
    /// so that force and displacement do the same work. `outer` is the sum beyond the element, and becomes the sum
    /// beyond its inner end.
    #[inline]
    pub(super) fn outboard(
        &self,
        element: usize,
        outer: &mut f64,
        forces: &[f64; POINTS],
    ) -> [f64; POINTS] {
        let points = &self.elements[element];
        let length_m: f64 = points.iter().map(|point| point.weight_m).sum();
        let beyond = *outer;
        if length_m == 0.0 {
            return [beyond; POINTS];
        }
        *outer += forces.iter().sum::<f64>();
        std::array::from_fn(|k| {
            let weighted: f64 = (0..POINTS).map(|j| self.within[j][k] * forces[j]).sum();
            beyond + weighted * length_m / points[k].weight_m
        })
    }
}

/// Integrals from 0 to each place of the polynomials that are 1 at one place and 0 at the others.
fn within() -> [[f64; POINTS]; POINTS] {
    let lagrange = |k: usize, x: f64| -> f64 {
        let others = (0..POINTS).filter(|j| *j != k);
        others.map(|j| (x - PLACES[j]) / (PLACES[k] - PLACES[j])).product()
    };
    // The five points are exact for polynomials of fourth order.
    PLACES.map(|end| {
        [0, 1, 2, 3, 4].map(|k| {
            let inner = PLACES.iter().zip(WEIGHTS);
            end * inner.map(|(place, weight)| weight * lagrange(k, end * place)).sum::<f64>()
        })
    })
}

/// Sum of products.
#[inline]
pub(super) fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
