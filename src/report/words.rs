//! Words of a page: a glossary, the formula behind each figure, and what kinds of warnings say.

use maud::{Markup, html};

/// What a page is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Solved,
    Played,
    Arm,
    Sweep,
    Fit,
}

const GLOSSARY: [(&str, &str); 4] = [
    (
        "zero",
        "A number s = ±z, in 1/s, at which a torque that goes as exp(st) leaves the tip at rest. Those of a link \
         that is moved at its hub are real and come in pairs: the one above 0 is why no torque that begins with \
         the motion can make the tip follow it. The torque begins earlier, and grows as exp(zt) until the tip \
         sets out: the smaller the first z, the longer the lead.",
    ),
    (
        "lead",
        "How long before the tip sets out the torque acts: from when it first exceeds 2 % of its peak.",
    ),
    (
        "lag",
        "How long after the tip has stopped the torque acts: until it is last above 2 % of its peak.",
    ),
    (
        "hysteretic",
        "Damping that takes the same share of a vibration's energy in each cycle, whatever its frequency: the \
         stiffness is K(1 + 2iξ) with the ratio ξ, and a cycle takes about 4πξ. It is defined at one frequency \
         at a time; what is integrated over time has ξ as the viscous ratio of every mode instead.",
    ),
];

/// What the words of a page mean, folded.
pub(super) fn glossary() -> Markup {
    html! {
        details {
            summary { "zero, lead, lag, hysteretic" }
            dl { @for (word, meaning) in GLOSSARY { dt { (word) } dd { (meaning) } } }
        }
    }
}

/// The formula behind the figure with this `id`.
pub(super) fn formula(kind: Kind, id: &str) -> Option<&'static str> {
    // Numbers of joints, links and measurements do not matter.
    let id = id.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('-');
    let id = id.trim_end_matches("-joint");
    match kind {
        Kind::Solved => of_solved(id).or_else(|| of_link(id)),
        Kind::Played => of_played(id).or_else(|| of_link(id)),
        Kind::Arm => of_arm(id),
        Kind::Sweep => of_sweep(id),
        Kind::Fit => of_fit(id),
    }
}

fn of_solved(id: &str) -> Option<&'static str> {
    Some(match id {
        "torque" => {
            "T(t) = 1/2π ∫ H(ω) A(ω) exp(iωt) dω. A: spectrum of the tip's acceleration; H = T/a: solution of \
             (K + iωC − ω²M) u = T e with a = −ω² v(L), where e is 1 at the hub's angle and 0 elsewhere. With \
             hysteretic damping K(1 + 2iξ) takes the place of K + iωC. Rigid link: T = (I a + c v̇)/L with its \
             inertia I about the hub and the friction c of the hub."
        }
        "tip-displacement" | "tip-acceleration" => {
            "a(t) = d²v/dt², v: displacement of the tip along its arc, both as given; the solution follows them up \
             to the frequency that the tolerance of the tip needs."
        }
        "hub-angle" | "hub-rate" => {
            "θ(t) = 1/2π ∫ G(ω) A(ω) exp(iωt) dω, G = θ/a of the equations of the torque. Rigid link: θ = v/L. \
             Bending of the tip: w = v − Lθ."
        }
        "tip-under-rigid-torque" => {
            "M d²u/dt² + C du/dt + K u = T(t) e with the torque T of the rigid link, from rest, each mode by its \
             exact solution between two samples."
        }
        _ => return None,
    })
}

fn of_played(id: &str) -> Option<&'static str> {
    Some(match id {
        "torque" => "T(t): what is played, or what moves the hub as it is played.",
        "tip-displacement" | "tip-acceleration" | "hub-angle" | "hub-rate" => {
            "M d²u/dt² + C du/dt + K u = T(t) e, where e is 1 at the hub's angle and 0 elsewhere; v = u at the tip, \
             θ = u at the hub, a = d²v/dt²."
        }
        _ => return None,
    })
}

/// Figures that solutions and simulations have.
fn of_link(id: &str) -> Option<&'static str> {
    Some(match id {
        "waves" => {
            "m(x, t) = EI ∂²w/∂x², w: deflection from the hub's tangent line. By what lies outboard: \
             m(x) = ∫ m̄ (s − x) ∂²v/∂t² ds + Σ m (x_m − x) ∂²v/∂t² over the masses and the payload. \
             Colour: sign(m) √(|m| / max |m|)."
        }
        "transfer" => {
            "|T/a| at ω = 2πf, of (K + iωC − ω²M) u = T e and a = −ω² v(L). Rigid link: |I + c/(iω)|/L. Modes: \
             det(K − ω²M) = 0 with the hub free. Zeros: v(L) = 0 at ω = ±iz."
        }
        "mode-shapes" => "K φ = ω² M φ with the hub free, f = ω/2π; drawn is φ / max |φ|.",
        _ => return None,
    })
}

fn of_arm(id: &str) -> Option<&'static str> {
    Some(match id {
        "torque" => {
            "Of each link (K + iωC − ω²M) u = loads, in the frame of its chord, whose motion follows from the path; \
             the loads are the torques and forces of the joints, and those of large angles, of centripetal and \
             axial forces and of the weight, repeated until the torques no longer change. Rigid arm: \
             T = M(q) d²q/dt² + h(q, dq/dt) + g(q)."
        }
        "angle" => {
            "q = direction of the link's root less that of the tip of the link before; each is the direction of the \
             chord and the slope of the deflection there."
        }
        "bending-angles" => "q(t) of the flexible arm less q(t) of the rigid arm.",
        "tip" => "x and y of the outer end of the last chord.",
        "tip-error" => "√((x − x_wanted)² + (y − y_wanted)²).",
        "waves" => {
            "m(x, t) − m(x, t₀) with m = EI ∂²w/∂x², w: deflection from the chord, t₀: the first moment. \
             Colour: sign(m) √(|m| / max |m|)."
        }
        "root-moments" => "m(0, t) = EI ∂²w/∂x² at the root.",
        _ => return None,
    })
}

fn of_sweep(id: &str) -> Option<&'static str> {
    Some(match id {
        "torque-ratio" => "max |T(t)| / max |T_rigid(t)|.",
        "lead" => "Start of the tip's motion less the first t with |T(t)| > 0.02 max |T|.",
        "lag" => "The last t with |T(t)| > 0.02 max |T| less the end of the tip's motion.",
        "peak-torque" => "max |T(t)|.",
        "peak-motor-torque" => {
            "max |T_m(t)|; T_m: what the hub's torque and the rotor's inertia take, over the gear."
        }
        "residual" => "max |v(t) − mean of v| after the last sample of the torque.",
        "tip-error" => "max |v(t) − v_wanted(t)|.",
        "deflection" => "max |v(t) − L θ(t)|.",
        _ => return None,
    })
}

fn of_fit(id: &str) -> Option<&'static str> {
    Some(match id {
        "differences" => "(fitted − measured) / measured.",
        _ if id.starts_with("overlay") => {
            "The fit makes the sum of the squared differences smallest, each over its uncertainty where that is known."
        }
        _ => return None,
    })
}

/// What a kind of warning says.
pub(super) fn warning_meaning(kind: &str) -> Option<&'static str> {
    let (kind, _) = kind.split_once(':').unwrap_or((kind, ""));
    Some(match kind {
        "failed" => "The case has no numbers; the column error says why.",
        "limit_exceeded" => "A value exceeds its limit in the link file.",
        "large_deflection" => "The link bends further than the linear theory holds.",
        "coarse_mesh" => "Halved elements would change the answer by more than the tolerance.",
        "above_mesh" => "The motion has frequencies above those that the mesh resolves.",
        "thick_link" => "Shear and rotary inertia, which are left out, would change the answer.",
        "tip_missed" => "The samples of the motion do not bring the tip within its tolerance.",
        "inexact_window" | "unsettled_torque" | "wrap_around" => {
            "The time computed is too short for the tolerance."
        }
        _ => return None,
    })
}
