//! The table that `modes` prints.

use std::f64::consts::TAU;

use flexlink::beam::Mesh;
use flexlink::link::Link;
use flexlink::numeric::significant;
use flexlink::tables::ModesResult;

use super::link_text::{link_line, title};

/// Modes, zeros and the modes with the rotor held, lines of at most 80 columns.
pub(crate) fn modes_text(link: &Link, mesh: &Mesh, result: &ModesResult) -> String {
    let mut lines = vec![link_line(link, mesh)];
    lines.extend(mode_rows(&result.omega_rad_s, Some(&result.damping_ratios)));
    lines.push(row(["zero", "±[1/s]", "lead to 1 % [s]", "", ""]));
    for (number, (zero, lead)) in result.zeros_per_s.iter().zip(result.leads_s()).enumerate() {
        let number = (number + 1).to_string();
        lines.push(row([&number, &significant(*zero, 8), &significant(lead, 4), "", ""]));
    }
    for hertz in &result.blocked_hz {
        lines.push(format!("at {} Hz no torque moves the tip", significant(*hertz, 8)));
    }
    if let Some(held) = &result.held {
        lines.push(format!("rotor held, {}", joint(held.joint_stiffness_n_m_rad)));
        lines.extend(mode_rows(&held.omega_rad_s, None));
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

/// A heading, then a row a mode, with its damping ratio where these are given.
fn mode_rows(omega_rad_s: &[f64], damping_ratios: Option<&[f64]>) -> Vec<String> {
    let damping = damping_ratios.map_or("", |_| "damping");
    let mut rows = vec![row(["mode", "omega [rad/s]", "frequency [Hz]", "period [s]", damping])];
    rows.extend(omega_rad_s.iter().enumerate().map(|(mode, omega)| {
        row([
            &(mode + 1).to_string(),
            &significant(*omega, 8),
            &significant(omega / TAU, 8),
            &significant(TAU / omega, 8),
            &damping_ratios.map_or(String::new(), |ratios| significant(ratios[mode], 4)),
        ])
    }));
    rows
}

fn row(cells: [&str; 5]) -> String {
    let [number, a, b, c, d] = cells;
    format!("{number:<6} {a:>16} {b:>16} {c:>16} {d:>16}").trim_end().to_owned()
}
