use crate::link::{Link, POSITION_TOLERANCE, ParameterError, Segment};

/// Number of elements of a link, all segments together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ElementCount {
    /// Refinement until the torque's discretisation error is below the tolerance.
    Auto,
    /// Total number of elements, at least 1.
    Total(usize),
}

/// Part of a segment between lumped masses, as fractions of the segment's length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Number of the segment.
    pub segment: usize,
    /// Start of the piece, 0 at the segment's inner end.
    pub from: f64,
    /// End of the piece, 1 at the segment's outer end.
    pub to: f64,
}

/// Number of elements of each part of a link, checked against the link.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshPlan {
    pub(super) shares: Vec<(Piece, usize)>,
    automatic: bool,
    tolerance: f64,
}

impl MeshPlan {
    /// Discretisation error of the torque, relative to its peak, at which `auto` stops refining.
    pub const DEFAULT_TOLERANCE: f64 = 1e-6;

    /// Largest number of elements of a link: more than any motion needs, and few enough for the memory.
    pub const MOST_ELEMENTS: usize = 100_000;

    /// Smallest number of elements at the start of an automatic mesh.
    const COARSEST: usize = 8;

    /// The plan that refines until the torque's error is below [`MeshPlan::DEFAULT_TOLERANCE`].
    pub fn automatic(link: &Link) -> Self {
        let pieces = pieces(link);
        let shares = divide(link, &pieces, Self::COARSEST.max(pieces.len()));
        Self { shares, automatic: true, tolerance: Self::DEFAULT_TOLERANCE }
    }

    /// Checks the numbers against `link` and distributes the elements over its pieces.
    ///
    /// `own[k]` is the number of elements of segment k, if set, `count` the number for the whole link. Without `count`
    /// the mesh is automatic, unless every segment has a number. Segments without a number share the remaining elements
    /// by length · (m̄/EI)^¼, so that every element spans about the same part of a bending wave; every piece gets at
    /// least one.
    ///
    /// # Errors
    /// [`ParameterError`] names the first impossible number.
    pub fn new(
        link: &Link,
        own: &[Option<usize>],
        count: Option<ElementCount>,
        tolerance: f64,
    ) -> Result<Self, ParameterError> {
        if !(1e-12..=0.1).contains(&tolerance) {
            let must = "must lie in [1e-12, 0.1]";
            return Err(ParameterError::new("mesh.tolerance", tolerance, "", must));
        }
        if own.len() != link.segments().len() {
            let must = format!("must be {}, one for each segment", link.segments().len());
            return Err(ParameterError::new("numbers of elements", own.len(), "", must));
        }
        let pieces = pieces(link);
        // Every segment has a piece, and the pieces of a segment are adjacent.
        let of_segments = || pieces.chunk_by(|a, b| a.segment == b.segment).zip(own).enumerate();
        for (segment, (of_segment, count)) in of_segments() {
            let needed = of_segment.len();
            if let Some(count) = count.filter(|c| *c < needed) {
                let must = format!(
                    "must be at least {needed}: lumped masses or the output divide the segment"
                );
                let parameter = format!("segments.{segment}.elements");
                return Err(ParameterError::new(parameter, count, "", must));
            }
        }
        let fixed = own.iter().flatten().fold(0, |sum: usize, count| sum.saturating_add(*count));
        if fixed > Self::MOST_ELEMENTS {
            let must = format!("must be at most {}", Self::MOST_ELEMENTS);
            let found = format!("{fixed} elements in all");
            return Err(ParameterError::new("segments", found, "", must));
        }
        let open: Vec<Piece> =
            pieces.iter().filter(|p| own[p.segment].is_none()).copied().collect();
        let automatic = match count {
            Some(ElementCount::Auto) => true,
            Some(ElementCount::Total(_)) => false,
            None => !open.is_empty(),
        };
        let rest = match count {
            Some(ElementCount::Total(total)) => share_of_total(total, fixed, open.len())?,
            // If every segment has a number, nothing remains to share.
            _ if open.is_empty() => 0,
            _ => Self::COARSEST.saturating_sub(fixed).max(open.len()),
        };
        let mut shares = divide(link, &open, rest);
        for (_, (of_segment, count)) in of_segments() {
            if let Some(count) = count {
                shares.extend(divide(link, of_segment, *count));
            }
        }
        shares.sort_by(|(a, _), (b, _)| {
            (a.segment, a.from)
                .partial_cmp(&(b.segment, b.from))
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        Ok(Self { shares, automatic, tolerance })
    }

    /// A fixed plan with these numbers of elements.
    pub(super) fn shared(shares: Vec<(Piece, usize)>) -> Self {
        Self { shares, automatic: false, tolerance: Self::DEFAULT_TOLERANCE }
    }

    /// A fixed plan: the first mesh of this plan with its elements halved this many times.
    #[must_use]
    pub(crate) fn halved(&self, times: u32) -> Self {
        let halved = |(piece, count): &(Piece, usize)| (*piece, count << times);
        Self { shares: self.shares.iter().map(halved).collect(), automatic: false, ..*self }
    }

    /// Refuses a link whose pieces differ from the plan's.
    pub(super) fn check(&self, link: &Link) -> Result<(), ParameterError> {
        let mut own = self.shares.iter().map(|(piece, _)| piece);
        // Stations may divide a piece.
        let mut is_divided = |whole: &Piece| {
            let mut from = whole.from;
            while from < whole.to {
                match own.next() {
                    Some(p)
                        if p.segment == whole.segment
                            && p.from.total_cmp(&from).is_eq()
                            && p.to <= whole.to =>
                    {
                        from = p.to;
                    }
                    _ => return false,
                }
            }
            true
        };
        if pieces(link).iter().all(&mut is_divided) && own.next().is_none() {
            return Ok(());
        }
        let must = "must be that of this link: another has other segments, or masses elsewhere";
        Err(ParameterError::new("mesh plan", "that of another link", "", must))
    }

    /// Pieces of the link from the hub outward, with their numbers of elements.
    pub fn shares(&self) -> &[(Piece, usize)] {
        &self.shares
    }

    /// True if the mesh is refined until its error is below the tolerance.
    pub fn is_automatic(&self) -> bool {
        self.automatic
    }

    /// Discretisation error of the torque, relative to its peak, at which `auto` stops refining.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Smallest tolerance of the plans of an arm's links.
    pub fn smallest_tolerance(plans: &[Self]) -> f64 {
        plans.iter().map(Self::tolerance).fold(1.0, f64::min)
    }
}

/// Number of elements that a total leaves for the open pieces.
fn share_of_total(total: usize, fixed: usize, open: usize) -> Result<usize, ParameterError> {
    let refuse = |must: String| Err(ParameterError::new("mesh.elements", total, "", must));
    if total > MeshPlan::MOST_ELEMENTS {
        return refuse(format!("must be at most {}", MeshPlan::MOST_ELEMENTS));
    }
    if open == 0 && total != fixed {
        return refuse(format!("must be {fixed}, the sum of the segments' elements"));
    }
    if total < fixed + open {
        let least = fixed + open;
        return refuse(format!(
            "must be at least {least}: {fixed} of the segments, and one for each other stretch"
        ));
    }
    Ok(total - fixed)
}

/// Distance from the axis to the inner end of a segment in m.
pub(super) fn root_m(link: &Link, segment: usize) -> f64 {
    let before = link.segments()[..segment].iter();
    before.fold(link.hub().radius_m, |sum, segment| sum + segment.length_m)
}

/// Segments divided at the lumped masses and at the output inside them.
pub(super) fn pieces(link: &Link) -> Vec<Piece> {
    let slack_m = POSITION_TOLERANCE * link.length_m();
    let mut places_m: Vec<f64> = link.masses().iter().map(|mass| mass.at_m).collect();
    places_m.push(link.output_m());
    places_m.sort_by(f64::total_cmp);
    let mut pieces = Vec::new();
    let mut root_m = link.hub().radius_m;
    for (index, segment) in link.segments().iter().enumerate() {
        let tip_m = root_m + segment.length_m;
        let mut from_m = root_m;
        let fraction = |x_m: f64| (x_m - root_m) / segment.length_m;
        for at_m in &places_m {
            if *at_m > from_m + slack_m && *at_m < tip_m - slack_m {
                pieces.push(Piece { segment: index, from: fraction(from_m), to: fraction(*at_m) });
                from_m = *at_m;
            }
        }
        pieces.push(Piece { segment: index, from: fraction(from_m), to: 1.0 });
        root_m = tip_m;
    }
    pieces
}

/// Distributes `total` elements over the pieces, at least one each, by their length in bending wavelengths.
///
/// Each next element goes to the piece with the longest elements in wavelengths, which makes the longest element as
/// short as possible.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share of the total is a whole number from 0 to the total"
)]
fn divide(link: &Link, pieces: &[Piece], total: usize) -> Vec<(Piece, usize)> {
    let mut weights: Vec<f64> =
        pieces.iter().map(|p| wavelengths(&link.segments()[p.segment], p)).collect();
    if weights.iter().sum::<f64>() == 0.0 {
        // Without mass there are no waves: only the length counts.
        weights =
            pieces.iter().map(|p| link.segments()[p.segment].length_m * (p.to - p.from)).collect();
    }
    let sum: f64 = weights.iter().sum();
    let spare = total - pieces.len();
    // Most elements at once. Each is at least sum/spare long, unless it is alone in its piece, so no piece gets more
    // than by the rule.
    let bulk = |weight: &f64| ((weight / sum * spare as f64).floor() as usize).max(1);
    let mut counts: Vec<usize> = weights.iter().map(bulk).collect();
    for _ in counts.iter().sum::<usize>()..total {
        let longest = (0..counts.len())
            .max_by(|&a, &b| {
                (weights[a] / counts[a] as f64)
                    .total_cmp(&(weights[b] / counts[b] as f64))
                    .then(b.cmp(&a))
            })
            .unwrap_or(0);
        counts[longest] += 1;
    }
    pieces.iter().copied().zip(counts).collect()
}

/// Length of a piece in units of the bending wavelength, up to a common factor.
fn wavelengths(segment: &Segment, piece: &Piece) -> f64 {
    let middle = 0.5 * (piece.from + piece.to);
    let density =
        segment.mass_per_length_kg_m.at(middle) / segment.bending_stiffness_n_m2.at(middle);
    // Square roots round alike on every processor, powers do not; equal shares stay equal.
    segment.length_m * (piece.to - piece.from) * density.sqrt().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::test_links::of_stiffnesses as link;

    fn counts(link: &Link, own: &[Option<usize>], count: Option<ElementCount>) -> Vec<usize> {
        let plan = MeshPlan::new(link, own, count, 1e-6).unwrap();
        plan.shares().iter().map(|(_, count)| *count).collect()
    }

    #[test]
    fn a_number_for_a_segment_that_is_not_there_and_too_many_in_all_are_refused() {
        let link = link(&[1.0, 1.0], &[]);
        for own in [&[][..], &[None], &[None, None, Some(3)]] {
            let message = refusal(&link, own, 20);
            let must = format!("= {}, but must be 2, one for each segment", own.len());
            assert!(message.contains(&must), "{message}");
        }
        let most = "must be at most 100000";
        assert!(refusal(&link, &[None, None], usize::MAX).contains(most));
        assert!(refusal(&link, &[Some(usize::MAX), Some(2)], 20).contains(most));
    }

    fn refusal(link: &Link, own: &[Option<usize>], total: usize) -> String {
        let count = Some(ElementCount::Total(total));
        MeshPlan::new(link, own, count, 1e-6).unwrap_err().to_string()
    }

    #[test]
    fn an_automatic_plan_is_that_of_no_numbers() {
        let link = link(&[5.0, 500.0], &[0.2, 0.75]);
        let open = MeshPlan::new(&link, &[None, None], None, MeshPlan::DEFAULT_TOLERANCE);
        assert_eq!(Ok(MeshPlan::automatic(&link)), open);
    }

    #[test]
    fn segments_that_all_have_their_own_few_elements_get_just_those() {
        let link = link(&[5.0, 5.0], &[]);
        for count in [None, Some(ElementCount::Auto)] {
            assert_eq!(counts(&link, &[Some(1), Some(2)], count), [1, 2]);
        }
    }

    #[test]
    fn a_total_is_shared_by_wavelengths_and_kept() {
        // The fourth root of 16 is 2: a wave on the stiff half is twice as long.
        let link = link(&[16.0, 1.0], &[]);
        for (total, shares) in [(2, [1, 1]), (3, [1, 2]), (30, [10, 20]), (31, [11, 20])] {
            let total = Some(ElementCount::Total(total));
            assert_eq!(counts(&link, &[None, None], total), shares);
        }
        let rest = Some(ElementCount::Total(12));
        assert_eq!(counts(&link, &[Some(3), None], rest), [3, 9]);
    }

    #[test]
    fn a_lumped_mass_gets_its_node_and_one_on_a_border_needs_none() {
        let inside = link(&[5.0], &[0.1]);
        assert_eq!(counts(&inside, &[Some(10)], None), [2, 8]);
        let border = link(&[5.0, 5.0], &[0.5, 1.0]);
        assert_eq!(counts(&border, &[Some(1), Some(1)], None), [1, 1]);
    }

    #[test]
    fn numbers_that_contradict_each_other_are_refused() {
        let two = link(&[5.0, 5.0], &[]);
        assert_eq!(
            refusal(&two, &[Some(1), Some(9)], 20),
            "mesh.elements = 20, but must be 10, the sum of the segments' elements"
        );
        assert_eq!(
            refusal(&two, &[Some(9), None], 9),
            "mesh.elements = 9, but must be at least 10: 9 of the segments, and one for each other stretch"
        );
        let divided = link(&[5.0], &[0.1, 0.2]);
        assert_eq!(
            MeshPlan::new(&divided, &[Some(2)], None, 1e-6).unwrap_err().to_string(),
            "segments.0.elements = 2, but must be at least 3: lumped masses or the output divide the segment"
        );
    }
}
