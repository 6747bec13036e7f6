//! Lengths, factors and passes of a transform, computed once for each length.

use std::f64::consts::TAU;
use std::iter::repeat_n;
use std::sync::{Arc, Mutex, PoisonError};

use super::vector::Eight;

/// The plans used last: a sweep transforms the same few lengths thousands of times, and the factors of
/// a length take longer than one transform. Without it a sweep of small cases takes 4 % longer.
static LATEST: Mutex<Vec<Arc<Plan>>> = Mutex::new(Vec::new());

/// How many plans are kept, and of how many points at most: up to 4 MB each.
const KEPT: usize = 4;
const LONGEST_KEPT: usize = 1 << 19;

/// Of a real transform of 2M samples by a complex one of M = rows · columns points, which stand row
/// by row, each row filled up to whole eights.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) points: usize,
    pub(super) rows: Stages,
    pub(super) columns: Stages,
    /// e^{2πi 8jk/M}, by eights `j` of a row, then by row `k`.
    pub(super) turns: Vec<[f64; 2]>,
    /// e^{2πi lk/M} of the eight numbers `l` = 0 … 7, by row `k`.
    pub(super) turns_in_eight: Vec<Eight>,
    /// e^{2πi k/2M} of the first point `k` of each eight.
    pub(super) halves: Vec<[f64; 2]>,
    /// e^{2πi l/2M}.
    pub(super) halves_in_eight: Eight,
}

/// The passes of one transform along the rows or the columns.
#[derive(Debug)]
pub(super) struct Stages {
    pub(super) len: usize,
    pub(super) passes: Vec<Pass>,
}

/// `groups` times `stride` butterflies of `radix` points each.
#[derive(Debug)]
pub(super) struct Pass {
    pub(super) radix: usize,
    pub(super) groups: usize,
    pub(super) stride: usize,
    /// What the outputs are multiplied by: `radix` factors a group, the first of them 1.
    pub(super) turns: Vec<[f64; 2]>,
    /// e^{2πi k/radix}, where no butterfly is written out.
    pub(super) roots: Vec<[f64; 2]>,
}

impl Plan {
    /// The plan for `points` complex points, at least one: a kept one where there is.
    pub(super) fn of(points: usize) -> Arc<Self> {
        if points > LONGEST_KEPT {
            return Arc::new(Self::new(points));
        }
        let mut latest = LATEST.lock().unwrap_or_else(PoisonError::into_inner);
        let plan = match latest.iter().position(|plan| plan.points == points) {
            Some(at) => latest.remove(at),
            None => Arc::new(Self::new(points)),
        };
        latest.truncate(KEPT - 1);
        latest.insert(0, Arc::clone(&plan));
        plan
    }

    pub(super) fn new(points: usize) -> Self {
        let rows = number_of_rows(points);
        let columns = points / rows;
        let eights = columns.div_ceil(8);
        let turns = (0..eights).flat_map(|j| (0..rows).map(move |k| cis(8 * j * k, points)));
        let halves = (0..rows).flat_map(|row| (0..eights).map(move |j| row * columns + 8 * j));
        Self {
            points,
            rows: Stages::new(rows),
            columns: Stages::new(columns),
            turns: turns.collect(),
            turns_in_eight: (0..rows).map(|k| cis_of_eight(k, points)).collect(),
            halves: halves.map(|k| cis(k, 2 * points)).collect(),
            halves_in_eight: cis_of_eight(1, 2 * points),
        }
    }
}

impl Stages {
    fn new(len: usize) -> Self {
        let mut stride = 1;
        let mut passes = Vec::new();
        for radix in radices(len) {
            let groups = len / (stride * radix);
            let turns = (0..groups).flat_map(|p| (0..radix).map(move |j| cis(p * j * stride, len)));
            let roots = if radix > 8 || radix == 7 { 0..radix } else { 0..0 };
            let roots = roots.map(|k| cis(k, radix)).collect();
            passes.push(Pass { radix, groups, stride, turns: turns.collect(), roots });
            stride *= radix;
        }
        Self { len, passes }
    }
}

/// The divisor of `points` that makes the fewest idle lanes, along rows and along columns; of
/// those that make as few, the one nearest to the square root, so that a line fits the cache.
fn number_of_rows(points: usize) -> usize {
    let divisors = (1..=points.isqrt()).filter(|n| points.is_multiple_of(*n));
    let shapes = divisors.flat_map(|n| [(n, points / n), (points / n, n)]);
    let cost = |&(rows, columns): &(usize, usize)| {
        let lanes = rows * columns.next_multiple_of(8) + columns * rows.next_multiple_of(8);
        lanes + 8 * rows.max(columns)
    };
    shapes.min_by_key(cost).map_or(1, |(rows, _)| rows)
}

/// Numbers whose product is `len`: 8 as often as can be, and no 2 where two 4 do.
fn radices(len: usize) -> Vec<usize> {
    let twos = len.trailing_zeros() as usize;
    let mut odd = len >> twos;
    let mut found = Vec::new();
    let mut factor = 3;
    while odd > 1 {
        while odd.is_multiple_of(factor) {
            found.push(factor);
            odd /= factor;
        }
        // The rest has no factor up to its root: it is prime.
        factor = if factor * factor > odd { odd } else { factor + 2 };
    }
    let (two, fours) = match twos % 3 {
        0 => (0, 0),
        1 if twos == 1 => (1, 0),
        1 => (0, 2),
        _ => (0, 1),
    };
    let eights = (twos - two - 2 * fours) / 3;
    found.extend(repeat_n(2, two).chain(repeat_n(4, fours)).chain(repeat_n(8, eights)));
    found
}

fn cis_of_eight(k: usize, n: usize) -> Eight {
    let mut eight = Eight::ZERO;
    for l in 0..8 {
        [eight.re[l], eight.im[l]] = cis(k * l, n);
    }
    eight
}

/// e^{2πi k/n}, real and imaginary part. The angle is folded into an eighth of a turn by integers,
/// and its sine and cosine are those of a library in Rust, the same bits on every machine.
fn cis(k: usize, n: usize) -> [f64; 2] {
    let eighths = 8 * (k % n);
    let (octant, rest) = (eighths / n, eighths % n);
    let angle = |eighths: usize| TAU * (eighths as f64 / (8 * n) as f64);
    let (sin, cos) = if octant % 2 == 0 {
        libm::sincos(angle(rest))
    } else {
        let (sin, cos) = libm::sincos(angle(n - rest));
        (cos, sin)
    };
    match octant / 2 {
        0 => [cos, sin],
        1 => [-sin, cos],
        2 => [-cos, -sin],
        _ => [sin, -cos],
    }
}
