use super::frequencies::{HubSpring, held_frequencies};
use crate::beam::Mesh;
use crate::numeric::SECTIONS;

/// First natural frequency in rad/s of the link clamped at its hub, where it lies below
/// `limit_rad_s` > 0; counting tells cheaply where it does not.
pub fn clamped_frequency_below(mesh: &Mesh, limit_rad_s: f64) -> Option<f64> {
    if HubSpring::CLAMPED.modes_below(mesh, &[limit_rad_s; SECTIONS])[0] == 0 {
        return None;
    }
    held_frequencies(mesh, f64::INFINITY, 1).first().copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{Link, uniform};

    #[test]
    fn the_first_mode_of_a_cantilever_is_found_from_above_alone() {
        let mesh = Mesh::on(&Link::new(uniform()).unwrap(), 20);
        let first = (1.875_104_068_7_f64 / 1.5).powi(2) * (5.0_f64 / 0.8).sqrt();
        assert_eq!(clamped_frequency_below(&mesh, 0.999 * first), None);
        let found = clamped_frequency_below(&mesh, 1.001 * first).unwrap();
        assert!((found / first - 1.0).abs() < 1e-6, "{found} is not {first}");
    }
}
