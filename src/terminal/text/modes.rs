//! The table that `modes` prints.

use std::f64::consts::TAU;

use flexlink::beam::Mesh;
use flexlink::link::Link;
use flexlink::numeric::significant;
use flexlink::store::ModesResult;

use super::lines::{link_line, title};

/// Modes, zeros and the modes with the rotor held, lines of at most 80 columns.
pub(crate) fn modes_text(link: &Link, mesh: &Mesh, result: &ModesResult) -> String {
    let mut lines = vec![link_line(link, mesh)];
    let errors = &result.mesh_errors;
    lines.extend(mode_rows(&result.omega_rad_s, Some(&result.damping_ratios), errors));
    lines.push(row(["zero", "±[1/s]", "lead to 1 % [s]", "", "", MESH_ERROR]));
    let zeros = result.zeros_per_s.iter().zip(result.leads_s()).zip(&result.zero_mesh_errors);
    for (number, ((zero, lead), error)) in zeros.enumerate() {
        let [zero, lead] = [significant(*zero, 8), significant(lead, 4)];
        lines.push(row([&(number + 1).to_string(), &zero, &lead, "", "", &share(*error)]));
    }
    for (hertz, error) in result.blocked_hz.iter().zip(&result.blocked_mesh_errors) {
        let hertz = significant(*hertz, 8);
        let error = share(*error);
        let error = if error.is_empty() { error } else { format!(" (mesh error {error})") };
        lines.push(format!("at {hertz} Hz no torque moves the tip{error}"));
    }
    if let Some(held) = &result.held {
        lines.push(format!("rotor held, {}", joint(held.joint_stiffness_n_m_rad)));
        lines.extend(mode_rows(&held.omega_rad_s, None, &held.mesh_errors));
    }
    title(link) + &lines.join("\n") + "\n"
}

fn joint(stiffness_n_m_rad: f64) -> String {
    if stiffness_n_m_rad.is_finite() {
        format!("joint spring {} N m/rad", significant(stiffness_n_m_rad, 4))
    } else {
        "stiff joint".into()
    }
}

const MESH_ERROR: &str = "mesh error";

/// A heading, then a row a mode, with its damping ratio where these are given.
fn mode_rows(
    omega_rad_s: &[f64],
    damping_ratios: Option<&[f64]>,
    mesh_errors: &[f64],
) -> Vec<String> {
    let damping = damping_ratios.map_or("", |_| "damping");
    let heading = ["mode", "omega [rad/s]", "frequency [Hz]", "period [s]", damping, MESH_ERROR];
    let mut rows = vec![row(heading)];
    rows.extend(omega_rad_s.iter().zip(mesh_errors).enumerate().map(|(mode, (omega, error))| {
        row([
            &(mode + 1).to_string(),
            &significant(*omega, 8),
            &significant(omega / TAU, 8),
            &significant(TAU / omega, 8),
            &damping_ratios.map_or(String::new(), |ratios| significant(ratios[mode], 4)),
            &share(*error),
        ])
    }));
    rows
}

/// A relative error; below what the iterations leave open, a bound. Empty where it is not known.
fn share(error: f64) -> String {
    const KNOWN_TO: f64 = 1e-12;
    match error {
        _ if error.is_nan() => String::new(),
        _ if error < KNOWN_TO => format!("< {KNOWN_TO:e}"),
        _ => format!("{error:.1e}"),
    }
}

fn row(cells: [&str; 6]) -> String {
    let [number, a, b, c, d, e] = cells;
    format!("{number:<6} {a:>13} {b:>15} {c:>13} {d:>10} {e:>11}").trim_end().to_owned()
}
