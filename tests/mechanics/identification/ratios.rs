//! Damping ratios behind springs, with friction and held hubs, against all eigenvalues of matrices assembled apart.

use faer::Mat;
use flexlink::beam::Mesh;
use flexlink::fit::{HubEnd, Measured, Measurements, Observable};
use flexlink::modal::{DampingLaw, PoseHub};
use flexlink::response::{arm_modes, damping_ratios};
use flexlink::spec::read_specification;
use nalgebra::DMatrix;

use super::fitted;
use crate::dense::{assembly::Assembly, damping};

const ELEMENTS: usize = 10;
const LENGTH_M: f64 = 0.6;
const STIFFNESS_N_M2: f64 = 2.0;
const MASS_KG_M: f64 = 0.25;
const HUB_KG_M2: f64 = 0.003;
const PAYLOAD_KG: f64 = 0.05;

fn text(friction: f64, damping: &str, drive: &str) -> String {
    format!(
        "[[segments]]\nlength = {LENGTH_M}\nEI = {STIFFNESS_N_M2}\nmass_per_length = {MASS_KG_M}\n\
         elements = {ELEMENTS}\n[hub]\ninertia = {HUB_KG_M2}\nviscous_friction = {friction}\n\
         [payload]\nmass = {PAYLOAD_KG}\n[damping]\n{damping}\n{drive}"
    )
}

/// Of the other matrix type.
fn dense(matrix: &Mat<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |row, column| matrix[(row, column)])
}

/// Mass and stiffness on the hub's angle, then displacement and slope of each node, of elements integrated apart.
fn assembled() -> [Mat<f64>; 2] {
    let own = read_specification("link.toml", &text(0.0, "ratio = 0.0", ""), &[]).unwrap();
    let node_m = |k: usize| LENGTH_M * k as f64 / ELEMENTS as f64;
    let nodes_m: Vec<f64> = (0..=ELEMENTS).map(node_m).collect();
    Assembly::of_link(own.link(), &nodes_m).mass_and_stiffness()
}

fn matrices() -> [DMatrix<f64>; 2] {
    assembled().each_ref().map(dense)
}

/// `−Re s/|s|` of the modes that vibrate, the slowest first, from all eigenvalues of a companion matrix. In the coordinates
/// `Ωq, q̇` of the undamped modes its round-off is that of the largest rate, not of its square.
fn of_matrices(
    mass: &DMatrix<f64>,
    damping: &DMatrix<f64>,
    stiffness: &DMatrix<f64>,
) -> Vec<[f64; 2]> {
    let size = mass.nrows();
    let lower = mass.clone().cholesky().unwrap().l();
    let by_mass = |matrix: &DMatrix<f64>| {
        let half = lower.solve_lower_triangular(matrix).unwrap();
        lower.solve_lower_triangular(&half.transpose()).unwrap()
    };
    let modes = by_mass(stiffness).symmetric_eigen();
    let rates = DMatrix::from_diagonal(&modes.eigenvalues.map(|square| square.max(0.0).sqrt()));
    let damped = modes.eigenvectors.transpose() * by_mass(damping) * &modes.eigenvectors;
    let mut companion = DMatrix::zeros(2 * size, 2 * size);
    companion.view_mut((0, size), (size, size)).copy_from(&rates);
    companion.view_mut((size, 0), (size, size)).copy_from(&-rates);
    companion.view_mut((size, size), (size, size)).copy_from(&-damped);
    let found = companion.complex_eigenvalues();
    let vibrating = found.iter().filter(|s| s.im > 1e-3);
    let mut modes: Vec<[f64; 2]> = vibrating.map(|s| [s.norm(), -s.re / s.norm()]).collect();
    modes.sort_by(|a, b| a[0].total_cmp(&b[0]));
    modes
}

/// The program's ratios of the first four modes.
fn found(text: &str, hub: PoseHub) -> Vec<f64> {
    let own = read_specification("link.toml", text, &[]).unwrap();
    let mesh = Mesh::new(own.link(), own.mesh()).unwrap();
    let law = DampingLaw::of(own.link(), &mesh).unwrap();
    damping_ratios((own.link(), &mesh, &law), hub, &hub.frequencies(&mesh, 4))
}

fn with(mut matrix: DMatrix<f64>, at_hub: f64) -> DMatrix<f64> {
    matrix[(0, 0)] += at_hub;
    matrix
}

fn assert_equal(found: &[f64], exact: &[[f64; 2]], what: &str) {
    assert_eq!(found.len(), 4, "{what}");
    for (found, [_, exact]) in found.iter().zip(exact) {
        assert!((found / exact - 1.0).abs() < 1e-6, "{what}: {found} is not {exact}");
    }
}

/// No friction, light and heavy friction, free and behind a spring: Rayleigh's damping of the bending.
#[test]
fn friction_of_the_hub_and_a_spring_without_loss_are_counted() {
    let [mass, bending] = matrices();
    let beta_s = 2e-4;
    for friction in [0.0, 0.001, 0.05] {
        for (hub, spring) in [(PoseHub::Free, 0.0), (PoseHub::Spring(5.0), 5.0)] {
            let damping = with(&bending * beta_s, friction);
            let exact = of_matrices(&mass, &damping, &with(bending.clone(), spring));
            let law = format!("model = 'rayleigh'\nalpha = 0.0\nbeta = {beta_s}");
            let found = found(&text(friction, &law, ""), hub);
            assert_equal(&found, &exact, &format!("{friction}, {hub:?}"));
        }
    }
}

/// The loss of hysteretic bending behind a spring, at each mode's own frequency, by a fixed point of it.
#[test]
fn a_spring_takes_its_share_of_the_strain_from_hysteretic_damping() {
    let [mass, bending] = matrices();
    let (ratio, stiffness) = (0.05, with(bending.clone(), 5.0));
    let exact: Vec<[f64; 2]> = (0..4)
        .map(|mode| {
            let viscous =
                |rate: f64| of_matrices(&mass, &(&bending * (2.0 * ratio / rate)), &stiffness);
            let start = of_matrices(&mass, &(&bending * 0.0), &stiffness)[mode];
            (0..6).fold(start, |known, _| viscous(known[0])[mode])
        })
        .collect();
    let link = text(0.0, "model = 'hysteretic'\nratio = 0.05", "");
    assert_equal(&found(&link, PoseHub::Spring(5.0)), &exact, "on a spring");
    for ratio in found(&link, PoseHub::Spring(f64::INFINITY)) {
        assert!((ratio - 0.05).abs() < 1e-9, "a clamped link is all bending: {ratio}");
    }
}

/// Ratios of the free hub's modes, of which a held hub mixes all.
#[test]
fn modal_ratios_are_those_of_the_free_hub() {
    let [mass, bending] = matrices();
    let [dense_mass, stiffness] = assembled();
    let damping = dense(&damping::modal(&dense_mass, &stiffness, |_, _| 0.02));
    let link = text(0.0, "model = 'modal'\nratio = 0.02", "");
    let inner = |whole: &DMatrix<f64>| whole.clone().remove_row(0).remove_column(0);
    let clamped = of_matrices(&inner(&mass), &inner(&damping), &inner(&bending));
    assert_equal(&found(&link, PoseHub::Spring(f64::INFINITY)), &clamped, "clamped");
    assert!(clamped[0][1] < 0.01, "far from the 0.02 of the file: {clamped:?}");
    let sprung = of_matrices(&mass, &damping, &with(bending, 30.0));
    assert_equal(&found(&link, PoseHub::Spring(30.0)), &sprung, "on a spring");
}

/// A rod that does not bend, on a spring and with friction at its hub: `ζ = b/(2√(κ I))`, and none above 1.
#[test]
fn a_stiff_link_on_a_spring_is_an_oscillator() {
    let link = |friction: f64| {
        text(friction, "model = 'hysteretic'\nratio = 0.0", "").replace("EI = 2", "EI = 2e6")
    };
    let inertia = HUB_KG_M2 + MASS_KG_M * LENGTH_M.powi(3) / 3.0 + PAYLOAD_KG * LENGTH_M.powi(2);
    for ratio in [0.01, 0.3, 0.9] {
        let friction = 2.0 * ratio * (5.0 * inertia).sqrt();
        let found = found(&link(friction), PoseHub::Spring(5.0))[0];
        assert!((found / ratio - 1.0).abs() < 1e-4, "{found} is not {ratio}");
    }
    assert!(found(&link(3.0 * (5.0 * inertia).sqrt()), PoseHub::Spring(5.0))[0].is_nan());
}

fn measured(hub: HubEnd, value: f64) -> Measurements {
    let observable = Observable::Damping { mode: 1, hub };
    let value = Measured { observable, value, uncertainty: Some(0.01 * value) };
    Measurements::new(vec![value], vec![], vec![]).unwrap()
}

#[test]
fn the_fitted_damping_gives_the_measured_ratio_behind_a_spring_and_with_friction() {
    let [mass, bending] = matrices();
    let law = |beta: f64| format!("model = 'rayleigh'\nalpha = 0.0\nbeta = {beta}");
    let drive = "[drive]\njoint_stiffness = 5.0\n";
    for (hub, spring, drive) in [(HubEnd::Free, 0.0, ""), (HubEnd::Held, 5.0, drive)] {
        let damping = with(&bending * 3e-4, 0.01);
        let [_, ratio] = of_matrices(&mass, &damping, &with(bending.clone(), spring))[0];
        let found =
            fitted(&text(0.01, &law(2e-4), drive), &measured(hub, ratio), &["damping.beta"]);
        let factor = found.unwrap().values[0].factor;
        assert!((factor / 1.5 - 1.0).abs() < 1e-4, "{hub:?}: {factor}");
    }
}

/// An arm whose outer link is next to nothing has the ratios of its inner link: friction, a spring and both.
#[test]
fn joints_of_an_arm_rub_as_the_hub_of_a_link_does() {
    let [mass, bending] = matrices();
    for (friction, spring) in [(0.05, None), (0.05, Some(5.0)), (0.0, Some(5.0))] {
        let drive =
            spring.map_or(String::new(), |k| format!("drive = {{ joint_stiffness = {k} }}\n"));
        let arm = format!(
            "[[links]]\nsegments = [{{ length = {LENGTH_M}, EI = {STIFFNESS_N_M2}, mass_per_length = {MASS_KG_M} }}]\n\
             hub = {{ inertia = {HUB_KG_M2}, viscous_friction = {friction} }}\ntip = {{ mass = {PAYLOAD_KG} }}\n\
             damping = {{ model = 'rayleigh', beta = 2e-4 }}\n{drive}\
             [[links]]\nsegments = [{{ length = 0.01, EI = 1.0, mass_per_length = 1e-4 }}]\n"
        );
        let own = read_specification("arm.toml", &arm, &[]).unwrap();
        let modes = arm_modes(&own.arm, &[0.3, 0.3], 1, 1e-8).unwrap();
        // The two swings of the free joints come first.
        let mode = if spring.is_some() { &modes.held.modes[0] } else { &modes.free.modes[2] };
        let stiffness = with(bending.clone(), spring.unwrap_or(0.0));
        let [_, exact] = of_matrices(&mass, &with(&bending * 2e-4, friction), &stiffness)[0];
        let found = mode.damping_ratio.unwrap();
        assert!(
            (found / exact - 1.0).abs() < 1e-3,
            "{friction}, {spring:?}: {found} is not {exact}"
        );
    }
}
