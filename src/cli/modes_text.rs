//! The table that `modes` prints.

use flexlink::beam::Mesh;
use flexlink::link::Link;
use flexlink::tables::ModesResult;

use super::number::significant;

/// Modes, then zeros, lines of at most 80 columns.
pub(crate) fn modes_text(link: &Link, mesh: &Mesh, result: &ModesResult) -> String {
    let mut lines = Vec::new();
    if !link.title().is_empty() {
        lines.push(link.title().to_owned());
    }
    lines.push(format!(
        "{} m, {} elements, rigid inertia {} kg m²",
        significant(link.length_m(), 4),
        mesh.elements().len(),
        significant(link.rigid_inertia_kg_m2(), 4)
    ));
    lines.push(row(["mode", "omega [rad/s]", "frequency [Hz]", "period [s]", "damping"]));
    let (frequencies, periods) = (result.frequencies_hz(), result.periods_s());
    for (mode, omega) in result.omega_rad_s.iter().enumerate() {
        lines.push(row([
            &(mode + 1).to_string(),
            &significant(*omega, 8),
            &significant(frequencies[mode], 8),
            &significant(periods[mode], 8),
            &significant(result.damping_ratios[mode], 4),
        ]));
    }
    lines.push(row(["zero", "±[1/s]", "lead to 1 % [s]", "", ""]));
    for (number, (zero, lead)) in result.zeros_per_s.iter().zip(result.leads_s()).enumerate() {
        let number = (number + 1).to_string();
        lines.push(row([&number, &significant(*zero, 8), &significant(lead, 4), "", ""]));
    }
    for hertz in &result.blocked_hz {
        lines.push(format!("at {} Hz no torque moves the tip", significant(*hertz, 8)));
    }
    lines.join("\n") + "\n"
}

fn row(cells: [&str; 5]) -> String {
    let [number, a, b, c, d] = cells;
    format!("{number:<6} {a:>16} {b:>16} {c:>16} {d:>16}").trim_end().to_owned()
}
