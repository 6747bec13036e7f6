use super::whole::Link;

/// Largest deflection of the tip over the length, and how far a geometrically exact link's tip then
/// strays along its arc, over its way: torques of this program played in a code of finite rotations.
const PLAYED: [(f64, f64); 4] = [(0.2, 0.004), (0.3, 0.013), (0.45, 0.04), (0.65, 0.16)];

impl Link {
    /// Tip deflection over length beyond which deflections are no longer small: the tip of a link
    /// that bends by a fifth of its length strays by 0.4 % of its way.
    pub const LARGE_DEFLECTION: f64 = 0.2;

    /// Tip deflection over length beyond which the answer is that of another link: the tip strays by
    /// more than 1.3 % of its way.
    pub const LARGEST_DEFLECTION: f64 = 0.3;

    /// How far the tip strays, over its way, where it deflects by this `share` of the length; none
    /// beyond what was played.
    pub fn large_deflection_error(share: f64) -> Option<f64> {
        let last = PLAYED.len() - 1;
        if share > PLAYED[last].0 {
            return None;
        }
        // The error grows as a power of the deflection: straight lines through logarithms.
        let next = PLAYED.iter().position(|(played, _)| share <= *played).unwrap_or(last).max(1);
        let ((x0, y0), (x1, y1)) = (PLAYED[next - 1], PLAYED[next]);
        let power = libm::log(y1 / y0) / libm::log(x1 / x0);
        Some(y0 * libm::pow(share / x0, power))
    }

    /// The same in words, for warnings.
    pub(crate) fn large_deflection_words(share: f64) -> String {
        let error = match Self::large_deflection_error(share) {
            Some(error) => format!("about {:.1} %", 100.0 * error),
            None => format!("more than {:.0} %", 100.0 * PLAYED[PLAYED.len() - 1].1),
        };
        format!(
            "the tip deflects by {:.0} % of the link's length, beyond the small deflections that the \
             method holds for: it strays by {error} of its way",
            100.0 * share
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_that_of_the_links_played_and_grows_in_between() {
        for (share, expected) in PLAYED {
            let found = Link::large_deflection_error(share).unwrap();
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} at {share}");
        }
        let shares: Vec<f64> = (1..=65).map(|k| 0.01 * f64::from(k)).collect();
        let errors = shares.iter().map(|share| Link::large_deflection_error(*share).unwrap());
        assert!(errors.collect::<Vec<_>>().is_sorted());
        assert_eq!(Link::large_deflection_error(0.66), None);
    }

    #[test]
    fn the_words_tell_a_number_as_far_as_links_were_played() {
        let end = |share: f64| {
            let words = Link::large_deflection_words(share);
            words.split_once(": ").unwrap().1.to_owned()
        };
        assert_eq!(end(0.36), "it strays by about 2.2 % of its way");
        assert_eq!(end(4.86), "it strays by more than 16 % of its way");
    }
}
