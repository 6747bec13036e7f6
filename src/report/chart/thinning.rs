/// Stretches of x of which each keeps its lowest and its highest point: one for each pixel of a
/// figure's width.
pub(super) const STRETCHES: usize = 680;

/// The points that a figure can show of a line with ascending x: of each stretch the lowest and the
/// highest, so that no peak is lost; all where there are few.
pub(super) fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= 2 * STRETCHES {
        return points.to_vec();
    }
    let mut kept = Vec::with_capacity(2 * STRETCHES + 2);
    kept.push(points[0]);
    for stretch in points.chunks(points.len().div_ceil(STRETCHES)) {
        let by_height = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let lowest = stretch.iter().min_by(by_height);
        let highest = stretch.iter().max_by(by_height);
        let mut both: Vec<(f64, f64)> = lowest.into_iter().chain(highest).copied().collect();
        both.sort_by(|a, b| a.0.total_cmp(&b.0));
        kept.extend(both);
    }
    kept.extend(points.last());
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_line_keeps_its_ends_and_its_peaks() {
        let mut points: Vec<(f64, f64)> =
            (0..100_000).map(|k| (f64::from(k), libm::sin(f64::from(k) * 1e-4))).collect();
        points[54_321].1 = 7.0;
        points[54_322].1 = -9.0;
        let kept = thinned(&points);
        assert!(kept.len() <= 2 * STRETCHES + 2, "{}", kept.len());
        assert!(kept.windows(2).all(|pair| pair[0].0 < pair[1].0));
        assert_eq!((kept[0], kept[kept.len() - 1]), (points[0], points[99_999]));
        assert!(kept.contains(&points[54_321]) && kept.contains(&points[54_322]));
        assert_eq!(thinned(&points[..100]), points[..100]);
    }
}
