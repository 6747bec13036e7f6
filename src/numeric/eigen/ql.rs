/// Most QL sweeps for one eigenvalue; two are usual.
const MOST_SWEEPS: usize = 60;

/// Plane rotations of neighbouring rows from the last of them upwards.
pub(super) struct Sweep {
    /// Lower row of the first rotation.
    pub(super) last: usize,
    /// Cosine and sine of each: `upper ← c upper − s lower, lower ← s upper + c lower`.
    pub(super) rotations: Vec<[f64; 2]>,
}

/// Makes a tridiagonal matrix diagonal in place, by the implicit QL iteration; gives what it turned
/// the matrix by, or none if that does not converge.
pub(super) fn diagonalise(diagonal: &mut [f64], off_diagonal: &mut [f64]) -> Option<Vec<Sweep>> {
    let mut sweeps = Vec::new();
    for first in 0..diagonal.len() {
        let mut left = MOST_SWEEPS;
        loop {
            let last = end_of_block(diagonal, off_diagonal, first);
            if last == first {
                break;
            }
            left = left.checked_sub(1)?;
            sweeps.push(sweep(diagonal, off_diagonal, first, last));
        }
    }
    Some(sweeps)
}

/// Last row that hangs together with `first` by more than round-off.
fn end_of_block(diagonal: &[f64], off_diagonal: &[f64], first: usize) -> usize {
    let is_cut = |k: usize| {
        let size = diagonal[k].abs() + diagonal[k + 1].abs();
        off_diagonal[k].abs() <= f64::EPSILON * size
    };
    (first..off_diagonal.len()).find(|k| is_cut(*k)).unwrap_or(off_diagonal.len())
}

/// One QL step on the rows `first ..= last`, shifted by the eigenvalue of the first two that is
/// nearest to the first.
fn sweep(d: &mut [f64], e: &mut [f64], first: usize, last: usize) -> Sweep {
    let half_gap = (d[first + 1] - d[first]) / (2.0 * e[first]);
    let root = libm::hypot(half_gap, 1.0).copysign(half_gap);
    let mut g = d[last] - d[first] + e[first] / (half_gap + root);
    let (mut c, mut s, mut p) = (1.0, 1.0, 0.0);
    let mut rotations = Vec::with_capacity(last - first);
    for k in (first..last).rev() {
        let (f, b) = (s * e[k], c * e[k]);
        let r = libm::hypot(f, g);
        if k + 1 < last {
            e[k + 1] = r;
        }
        if r == 0.0 {
            // The block falls apart here; the next step takes the parts.
            d[k + 1] -= p;
            cut(e, last);
            return Sweep { last, rotations };
        }
        (s, c) = (f / r, g / r);
        g = d[k + 1] - p;
        let t = (d[k] - g) * s + 2.0 * c * b;
        p = s * t;
        d[k + 1] = g + p;
        g = c * t - b;
        rotations.push([c, s]);
    }
    d[first] -= p;
    e[first] = g;
    cut(e, last);
    Sweep { last, rotations }
}

/// The rows down to `last` hang together with nothing below.
fn cut(off_diagonal: &mut [f64], last: usize) {
    if let Some(e) = off_diagonal.get_mut(last) {
        *e = 0.0;
    }
}
