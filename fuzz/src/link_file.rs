use super::link_text::link_text;
use super::wording::check_words;
use flexlink::beam::{Mesh, MeshPlan};
use flexlink::spec::{Specification, read_specification};

/// Elements of a mesh at most that is made.
const WORTH_THE_TIME: usize = 10_000;

/// Laws: a link file is refused with words, or is a link that can move and be meshed, and that is the
/// same when it is written out in SI and read again.
///
/// # Panics
/// If one is broken.
pub fn link_file(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match read_specification("link.toml", text, &[]) {
        Err(error) => check_words("link.toml", &error, error.hint()),
        Ok(specification) => check(&specification),
    }
}

fn check(specification: &Specification) {
    let (link, plan) = (specification.link(), specification.mesh());
    let inertia = link.rigid_inertia_kg_m2();
    assert!(inertia.is_finite() && inertia > 0.0, "a rigid inertia of {inertia}");
    assert!(plan.shares().iter().all(|(piece, count)| *count > 0 && piece.from < piece.to));
    let elements: usize = plan.shares().iter().map(|(_, count)| count).sum();
    assert!(elements <= MeshPlan::MOST_ELEMENTS, "{elements} elements");
    if elements <= WORTH_THE_TIME {
        let mesh = Mesh::new(link, plan).expect("a plan of the link");
        assert_eq!(mesh.elements().len(), elements);
        let off = (mesh.length_m() / link.length_m() - 1.0).abs();
        assert!(off < 1e-12, "{} m are meshed of {} m", mesh.length_m(), link.length_m());
    }
    let written = link_text(specification);
    let again = read_specification("again.toml", &written, &[]).expect(&written);
    // Numbers in SI do not tell a section's shape, which only estimates need.
    assert_eq!(link_text(&again), written);
    assert_eq!(
        (&again.analysis, &again.limits[0]),
        (&specification.analysis, &specification.limits[0])
    );
}
