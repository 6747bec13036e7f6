use std::f64::consts::TAU;
use std::num::NonZeroUsize;

use flexlink::beam::TipTransfer;
use flexlink::inverse::{NodalTable, Solution};
use flexlink::link::Link;
use flexlink::modal::natural_frequencies;
use flexlink::model::Model;
use flexlink::numeric::largest;
use flexlink::result::{Metrics, Peak};

use super::finite;

/// Rows of a nodal table that are computed.
const EVERY: NonZeroUsize = NonZeroUsize::MIN.saturating_add(4);

/// What a Fourier transform of N samples costs is this times ε log₂N of the root of the sum of
/// squares; the usual bound has about 3.
const TRANSFORM: f64 = 4.0;

/// By how much a displacement's noise grows on the way to the acceleration: (π/2)² at the Nyquist
/// frequency.
const DIFFERENCED: f64 = 2.5;

/// Law: histories, metrics, nodal tables and warnings hold no NaN and no infinity.
///
/// # Panics
/// If one does.
pub fn check_finite(solution: &Solution) {
    let tip = &solution.tip;
    let hub_acceleration_rad_s2 = solution.acceleration_rad_s2(0).into_owned();
    let histories = [
        ("torque", &solution.hub().torque_n_m),
        ("rigid torque", &solution.hub().rigid_torque_n_m),
        ("hub angle", &solution.hub().angle_rad),
        ("hub rate", &solution.hub().rate_rad_s),
        ("hub acceleration", &hub_acceleration_rad_s2),
        ("rigid hub angle", &solution.hub().rigid_angle_rad),
        ("root moment", &solution.links[0].root_moment_n_m),
        ("displacement", &tip[0].displacement_m),
        ("velocity", &tip[0].velocity_m_s),
        ("acceleration", &tip[0].acceleration_m_s2),
    ];
    for (name, samples) in histories {
        assert!(samples.len() == solution.grid.len && finite(samples), "{name}");
    }
    if let Some(motor) = &solution.hub().motor {
        for samples in [&motor.torque_n_m, &motor.angle_rad, &motor.rate_rad_s, &motor.power_w] {
            assert!(finite(samples), "a motor's history");
        }
    }
    let nodes: Vec<usize> = (0..solution.links[0].mesh().nodes_m().len()).collect();
    for table in [
        solution.displacements(&nodes, EVERY).expect("nodes of the mesh"),
        solution.moments(&nodes, EVERY).expect("nodes of the mesh"),
    ] {
        check_table(&table);
    }
    check_metrics(&Metrics::of(solution));
    let errors = solution.hub().errors;
    let shares = errors.iter().flat_map(|(_, errors)| {
        [Some(errors.mesh), Some(errors.window), errors.step, errors.modes]
    });
    let mut shares = shares.flatten().chain([solution.tip_error]);
    let are_shares = shares.all(|share| share.is_finite() && share >= 0.0);
    assert!(are_shares, "{errors:?}");
    for warning in &solution.warnings {
        let text = warning.to_string();
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
}

fn check_table(table: &NodalTable) {
    assert!(table.histories().samples.iter().all(|values| finite(values)), "a nodal table");
}

fn check_metrics(metrics: &Metrics) {
    let hub = metrics.hub();
    let numbers = [
        hub.rms_torque_n_m,
        hub.torque_ratio,
        hub.lead_s.expect("from rest to rest"),
        hub.lag_s.expect("from rest to rest"),
    ];
    assert!(finite(&numbers), "{metrics:?}");
    let peaks = [
        hub.peak_torque_n_m,
        hub.peak_rigid_torque_n_m,
        hub.peak_hub_angle_rad,
        hub.peak_hub_rate_rad_s,
        hub.peak_power_w,
        hub.peak_root_moment_n_m.expect("a link"),
        hub.peak_deflection_m.expect("a link"),
        metrics.peak_tip_velocity_m_s,
        metrics.peak_tip_acceleration_m_s2,
    ];
    let is_peak = |Peak { value, time_s }: &Peak| finite(&[*value, *time_s]) && *value >= 0.0;
    assert!(peaks.iter().all(is_peak), "{metrics:?}");
}

/// Law: `both`, of the sum of two motions, is the sum of their torques but for round-off, where all
/// three stand on the same period.
///
/// Each transform of a motion makes noise in every bin; the link's transfer makes it a torque:
///
/// ```text
/// |δT| ≤ 2/N Σ_k |G_k| |δÂ|,   |δÂ| ≤ 4 ε log₂N √N ‖a‖₂,   G = T̂/â
/// ```
///
/// and so does the transform back, of the torques. Bins that one band has and another has not hold
/// less than the noise.
///
/// # Panics
/// If it is not.
pub fn check_linear(first: &Solution, second: &Solution, both: &Solution) {
    let all = [first, second, both];
    let span = |solution: &Solution| (solution.band.fft_length, solution.band.cutoff_hz);
    if all.iter().any(|solution| span(solution) != span(both)) {
        return;
    }
    let period = both.band.fft_length as f64;
    let round_off = TRANSFORM * f64::EPSILON * period.log2() * period.sqrt();
    let norm = |solution: &&Solution| {
        let squares = solution.tip[0].acceleration_m_s2.iter().map(|a| a * a);
        squares.sum::<f64>().sqrt()
    };
    let way =
        all.iter().map(|solution| largest(&solution.tip[0].displacement_m)).fold(0.0, f64::max);
    let step_s = both.grid.step_s;
    // Displacements are rounded, too, before they are differenced twice.
    let rounded = 10.0 * f64::EPSILON * both.grid.len as f64 * way / step_s.powi(2);
    let noise = DIFFERENCED * (round_off * all.iter().map(norm).sum::<f64>() + rounded);
    let bins = all.iter().map(|solution| solution.band.frequencies).max().unwrap_or(0);
    let transfers: f64 = transfers(both, bins).iter().sum();
    let torques: f64 = all.iter().map(|solution| largest(&solution.hub().torque_n_m)).sum();
    let allowed = 2.0 / period * transfers * noise + round_off * torques;
    let sum = first.hub().torque_n_m.iter().zip(&second.hub().torque_n_m).map(|(a, b)| a + b);
    for (k, (both, sum)) in both.hub().torque_n_m.iter().zip(sum).enumerate() {
        let off = (both - sum).abs();
        assert!(off <= allowed, "{both:e} is not {sum:e} at {k}: off by {off:e} of {allowed:e}");
    }
}

/// Largest |T̂/â| of every bin above zero, in kg m; the first stands for the mean velocity, too.
fn transfers(solution: &Solution, bins: usize) -> Vec<f64> {
    let friction_n_m_s_rad = solution.links[0].link().joint().friction();
    let (law, length_m) = (solution.links[0].law(), solution.links[0].mesh().length_m());
    let omegas: Vec<f64> =
        (1..bins.max(2)).map(|k| TAU * k as f64 / solution.band.period_s).collect();
    let found = solution.links[0].model.tip_transfers(&omegas);
    let size = |(omega, tip): (&f64, TipTransfer)| {
        let factor = law.stiffness_factor(*omega);
        let bent = (tip.deflection_s2 / factor).norm() * omega * friction_n_m_s_rad / length_m;
        let drag = 1.0 + law.mass_rate_per_s() / omega;
        (tip.inertia_kg_m.norm() + bent) * drag + friction_n_m_s_rad / (length_m * omega)
    };
    let mut sizes: Vec<f64> = omegas.iter().zip(found).map(size).collect();
    // The travel sums up what the samples are off by, over up to the whole period.
    sizes[0] *= solution.band.fft_length as f64;
    sizes
}

/// How far a link's torque per acceleration lies from that of the rigid link, at most and relative to
/// it, for each unit of λ in 1/s²; none where nothing bends.
///
/// ```text
/// T/a_tip = I/L Π(1 − λ/ω_k²) / Π(1 + λ/z_k²)
/// |T/a_tip L/I − 1| < 2 |λ| (Σ 1/ω_k² + Σ 1/|z_k²|)        where that is below 1
/// ```
///
/// The first sum is at most the number of modes over `ω_1²`. The second, but for its signs, is how far
/// the tip lags at λ = 0; zeros off the real axis have other signs, which may hide all but a share of
/// it: here a thousandth.
pub fn bending(model: &dyn Model) -> Option<f64> {
    let first_rad_s = natural_frequencies(model.mesh(), 1).first().copied()?;
    let modes = 2 * model.mesh().elements().len();
    let deflection_s2 = model.tip_transfer(0.0).deflection_s2.norm();
    Some(2.0 * (modes as f64 / first_rad_s.powi(2) + 1e3 * deflection_s2))
}

/// Law: the torque is that of the rigid link, but for the little that the link still bends, as
/// [`bending`] has it, and for round-off.
///
/// # Panics
/// If it is not.
pub fn check_rigid(link: &Link, solution: &Solution, nyquist_rad_s: f64) {
    let Some(bending) = bending(&*solution.links[0].model) else { return };
    let law = solution.links[0].law();
    let bent = bending * law.lambda(nyquist_rad_s).norm();
    let period = solution.band.fft_length as f64;
    let round_off = TRANSFORM * f64::EPSILON * (period.log2() * period.sqrt() + period);
    let (length_m, inertia) = (link.length_m(), link.rigid_inertia_kg_m2());
    let drag = inertia * law.mass_rate_per_s() + link.hub().viscous_friction_n_m_s_rad;
    let acceleration = largest(&solution.tip[0].acceleration_m_s2);
    let moving = drag * largest(&solution.tip[0].velocity_m_s);
    // A payload that lies far inboard takes away most of what its mass adds at the tip; each is rounded.
    let payload = link.payload();
    let taken_away = payload.mass_kg * (length_m + payload.offset_m.abs()).powi(2);
    let allowed = (bent * period.sqrt() + round_off) * (inertia * acceleration + moving) / length_m
        + round_off * taken_away * acceleration / length_m;
    let pairs = solution.hub().torque_n_m.iter().zip(&solution.hub().rigid_torque_n_m);
    for (torque, rigid) in pairs {
        let off = (torque - rigid).abs();
        assert!(off <= allowed, "{torque:e} is not {rigid:e}: off by {off:e} of {allowed:e}");
    }
}
