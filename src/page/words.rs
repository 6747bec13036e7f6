//! Words of a page: a glossary, the formula behind each figure, and the meanings of kinds of warnings.

use maud::{Markup, html};

use crate::link::{Joint, Link};

/// Words of a run, a sweep and a fit.
pub(super) const GLOSSARY: [(&str, &str); 4] = [
    (
        "zero",
        "A number s, in 1/s, at which a torque that goes as exp(st) leaves the tip at rest. The page lists the real \
         ones, which come in pairs ±z: the one above 0 is why no torque that begins with the motion can make the tip \
         follow it. The torque begins earlier, and grows as exp(zt) until the tip sets out: the smaller the first z, \
         the longer the lead. Points of mass on a slender link without damping have real zeros alone. Rotary inertia, \
         a payload beyond the tip or shear can make some complex, ±a ± ib, or imaginary, ±ib: at that frequency, b \
         in the figure of torque per tip acceleration, no torque moves the tip. Damping moves all of them a little.",
    ),
    (
        "lead",
        "Time by which the torque acts before the tip sets out: from when it first {acts}. Below 0 it begins after the \
         tip has set out, as it does where a slow motion begins with little torque.",
    ),
    (
        "lag",
        "Time by which the torque acts after the tip has stopped: until it last does so. Below 0 it ends before the \
         tip stops.",
    ),
    (
        "hysteretic",
        "Damping that takes the same share of a vibration's energy in each cycle, whatever its frequency: the \
         stiffness is K(1 + 2iξ) with the ratio ξ, and a cycle takes about 4πξ. It is defined at one frequency at a time; an integration over time uses ξ as the viscous ratio of every mode instead.",
    ),
];

/// Words of a study of plants.
pub(super) const MEASURES: [(&str, &str); 4] = [
    (
        "tip error",
        "Largest |e| from the first sample of the command up to one period after the end of the motion; e: the tip \
         less the wanted motion. The period is that of the lowest mode that rings: of the held joint if positions are \
         played, of the free joint if torques are, of the loop with feedback.",
    ),
    ("rest vibration", "Half the range of e in the first period after the end of the motion."),
    (
        "drift",
        "Mean of e in this period. A wrong mass lets the tip drift, a wrong stiffness hardly does.",
    ),
    ("settling", "Time after the end of the motion from which e stays within the band."),
];

/// How a torque that acts is told from one at rest: `from_rest` is true for an arm and under gravity, where the torque at
/// rest is not 0, and `None` where gravity is not known.
pub(super) fn acts(from_rest: Option<bool>) -> &'static str {
    match from_rest {
        Some(true) => "differs from its value at rest by more than 2 % of its range",
        Some(false) => "exceeds 2 % of its peak",
        None => {
            "exceeds 2 % of its peak or, of an arm and under gravity, differs from its value at rest by more than \
             2 % of its range"
        }
    }
}

/// Folded glossary of a page, with the sign of a torque that [`acts`].
pub(super) fn glossary(words: &[(&str, &str)], acts: &str) -> Markup {
    let names: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
    html! {
        details {
            summary { (names.join(", ")) }
            dl { @for (word, meaning) in words { dt { (word) } dd { (meaning.replace("{acts}", acts)) } } }
        }
    }
}

/// Formulas behind figures; each figure refers to one.
pub(super) mod formula {
    /// Formulas of a solution.
    pub(in crate::page) const TORQUE: &str = "\
        T(t) = 1/2π ∫ H(ω) A(ω) exp(iωt) dω. A: spectrum of the tip's acceleration; H = T/a: solution of (K + \
        iωC − ω²M) u = T e with a = −ω² v(L), where e is 1 at the hub's angle and 0 elsewhere. With hysteretic \
        damping K(1 + 2iξ) takes the place of K + iωC. Rigid link: T = (I a + c v̇)/L with its inertia I about \
        the hub and the friction c of the hub, and under gravity the moment of its weight.";
    pub(in crate::page) const TIP: &str = "\
        a(t) = d²v/dt², v: displacement of the tip along its arc, both as given; the solution follows them up to \
        the frequency that the tolerance of the tip needs.";
    pub(in crate::page) const HUB: &str = "\
        θ(t) = 1/2π ∫ G(ω) A(ω) exp(iωt) dω, G = θ/a of the equations of the torque. Rigid link: θ = v/L. \
        Bending of the tip: w = v − Lθ.";
    /// Formulas of a simulation with a target, and of one beside a solved run.
    pub(in crate::page) const TIP_ERROR: &str = "\
        v(t) − v_wanted(t) at the times of the target; between samples of the simulation v is a cubic spline.";
    pub(in crate::page) const TIP_ERROR_BESIDE: &str = "\
        v(t) − v_wanted(t) less its first value; v_wanted: the tip of the solved run, linear between its samples.";
    pub(in crate::page) const MOTOR: &str = "\
        Motor: T_m = T/n + J d²φ/dt², φ = n (θ + T/k): angle of the rotor, with the gear ratio n, the rotor's \
        inertia J and the stiffness k of the joint.";
    pub(in crate::page) const LOSSY_MOTOR: &str = "\
        Motor: T_m = f/n + J d²φ/dt², φ = n (θ + T/k): angle of the rotor, with the gear ratio n, the rotor's \
        inertia J and the stiffness k of the joint; f = a T' + b |T'| x, T' = T + τ x, x = tanh((dθ/dt)/friction rate), \
        a = (1/η + η)/2, b = (1/η − η)/2, with the Coulomb friction τ and the efficiency η.";
    /// Additions to the formulas of a solution with second order or weight.
    pub(in crate::page) const SECOND_ORDER: &str = "\
        Large slopes, axial and centripetal forces and the weight act as further loads, repeated until the torque no longer changes.";
    pub(in crate::page) const RIGID_TORQUE_PLAYED: &str = "\
        M d²u/dt² + C du/dt + K u = T(t) e with the torque T of the rigid link, from rest, each mode by its \
        exact solution between two samples.";
    /// Formulas of a simulation.
    pub(in crate::page) const TORQUE_PLAYED: &str =
        "T(t): the played torque, or the torque that moves the hub as played.";
    pub(in crate::page) const MODES_PLAYED: &str = "\
        M d²u/dt² + C du/dt + K u = T(t) e, where e is 1 at the hub's angle and 0 elsewhere; v = u at the tip, θ \
        = u at the hub, a = d²v/dt².";
    pub(in crate::page) const ELASTICA_PLAYED: &str = "\
        Lagrange's equations of a chain that approximates the inextensible elastica, refined until tip and hub \
        no longer change; v: displacement of the tip along its arc, θ: direction of the hub's tangent line, a = \
        d²v/dt².";
    /// Formulas of the waves along a link or a link of an arm.
    pub(in crate::page) const MOMENT: &str =
        "m(x, t) = EI ∂²w/∂x², w: deflection; with shear EI ∂ψ/∂x, ψ: rotation of the section.";
    pub(in crate::page) const MOMENT_ESTIMATED: &str = "\
        m(x, t) = ∫ m̄ (s − x) ∂²v/∂t² ds + Σ [M (x_M − x) ∂²v/∂t² + J ∂²φ/∂t²] over all that lies outboard of \
        x: mass per length m̄, masses M, their inertia J and rotation φ, the payload. ∂²/∂t²: second differences \
        of the displacements v = w + xθ that were written.";
    pub(in crate::page) const DEFLECTION: &str = "\
        w(x, t): distance of the link from the hub's tangent line; v − xθ of a link that bends little, v: its \
        displacement at x.";
    pub(in crate::page) const TRANSFER: &str = "\
        |T/a| at ω = 2πf, of (K + iωC − ω²M) u = T e and a = −ω² v(L). Rigid link: |I + c/(iω)|/L. Modes: det(K \
        − ω²M) = 0 with the hub free. Zeros: v(L) = 0 at ω = ±iz.";
    pub(in crate::page) const MODE_SHAPES: &str =
        "K φ = ω² M φ with the hub free, f = ω/2π; drawn is φ / max |φ|.";
    /// Formulas of an arm.
    pub(in crate::page) const ARM_TORQUE: &str = "\
        Of each link (K + iωC − ω²M) u = loads, in the frame of its chord, whose motion follows from the path; \
        the loads are the torques and forces of the joints, and those of large angles, of centripetal and axial \
        forces and of the weight, repeated until the torques no longer change. Rigid arm: T = M(q) d²q/dt² + \
        h(q, dq/dt) + g(q).";
    pub(in crate::page) const CARRIAGE_FORCE: &str = "\
        F = M (d²u/dt² − g·e) + b du/dt + R·e: carriage of mass M and friction b on a rail along e, R the force on the \
        first link.";
    pub(in crate::page) const JOINT_ANGLE: &str = "\
        q = direction of the link's root less that of the tip of the link before; each is the direction of the \
        chord and the slope of the deflection there.";
    pub(in crate::page) const BENDING_ANGLES: &str =
        "q(t) of the flexible arm less q(t) of the rigid arm.";
    pub(in crate::page) const ARM_TIP: &str = "x and y of the outer end of the last chord.";
    pub(in crate::page) const ARM_TIP_ERROR: &str = "√((x − x_wanted)² + (y − y_wanted)²).";
    pub(in crate::page) const ARM_MOMENT: &str = "\
        m(x, t) − m(x, t₀) with m = EI ∂²w/∂x², w: deflection from the chord, t₀: the first moment; with shear \
        EI ∂ψ/∂x, ψ: rotation of the section.";
    pub(in crate::page) const ARM_DEFLECTION: &str =
        "w(x, t) − w(x, t₀), w: distance of the link from its chord, t₀: the first moment.";
    pub(in crate::page) const ROOT_MOMENTS: &str =
        "m(0, t) = EI ∂²w/∂x² at the root; with shear EI ∂ψ/∂x.";
    /// Formulas of quantities with a limit.
    pub(in crate::page) const RATE: &str = "dθ/dt of the hub.";
    pub(in crate::page) const ACCELERATION: &str = "d²θ/dt² of the hub.";
    pub(in crate::page) const POWER: &str = "P = T dθ/dt.";
    pub(in crate::page) const MOTOR_RATE: &str = "\
        dφ/dt, φ = n (θ + T/k): angle of the rotor, with the gear ratio n and the stiffness k of the joint.";
    pub(in crate::page) const MOTOR_POWER: &str =
        "P = T_m dφ/dt, T_m: torque of the motor, φ: angle of the rotor.";
    pub(in crate::page) const MOTOR_CURRENT: &str =
        "i = T_m/k, T_m: torque of the motor, k: its torque constant.";
    pub(in crate::page) const MOTOR_VOLTAGE: &str =
        "u = R i + k dφ/dt, R: resistance, i: current, k: torque constant, φ: angle of the rotor.";
    pub(in crate::page) const TIP_DEFLECTION: &str = "\
        w(L, t): distance of the tip from the hub's tangent line; v − Lθ of a link that bends little.";
    pub(in crate::page) const LINK_DEFLECTION: &str = "\
        w = c sin β, c: length of the chord, β: its direction less that of the link's root, from the slope of the deflections \
        of the nodes.";
    /// Formulas of a study of plants.
    pub(in crate::page) const ENVELOPE: &str = "\
        Smallest and largest e(t) of the drawn plants, e = v − v_wanted; of an arm of √((x − x_wanted)² + (y − y_wanted)²).";
    pub(in crate::page) const STRAYS: &str = "\
        Tip error: max |e| up to the time t₁ + P. Rest vibration: (max e − min e)/2 over t₁ … t₁ + P, of an arm half the \
        largest distance of two e. Drift: |mean e| over t₁ … t₁ + P. e = v − v_wanted, t₁: end of the motion, P: period \
        of the lowest mode that rings; all over the travel.";
    pub(in crate::page) const SAMPLE: &str =
        "The k-th smallest of n tip errors stands at the share (k − 1)/(n − 1).";
    /// Formulas of a fit.
    pub(in crate::page) const DIFFERENCES: &str = "(fitted − measured) / measured.";
    pub(in crate::page) const OVERLAY: &str = "\
        The fit makes the sum of the squared differences smallest, each over its uncertainty where that is \
        known.";
}

/// Whose words a text has: those of the hub of a single link, of a joint of an arm, or of a carriage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Of {
    Hub,
    Joint,
    Carriage,
}

impl Of {
    /// A text of a hub, such as a formula, in the words and symbols of another joint.
    pub(super) fn words(self, of_hub: &str) -> String {
        match self {
            Self::Hub => of_hub.to_owned(),
            Self::Joint => of_hub.replace('θ', "q").replace("the hub", "the joint"),
            Self::Carriage => of_joint(&Joint::CARRIAGE, of_hub, ""),
        }
    }
}

/// Encloses what [`worded`] leaves as it is; no text has this sign.
const OWN: char = '\u{fdd0}';

/// A text that no page may change: names, files and arguments of the user, and what has the words of its own joint.
pub(super) fn own(text: impl AsRef<str>) -> String {
    let text = text.as_ref().replace(OWN, "");
    if text.is_empty() { text } else { format!("{OWN}{text}{OWN}") }
}

/// Number of letters that a page shows of a text.
pub(super) fn letters(text: &str) -> usize {
    text.chars().filter(|letter| *letter != OWN).count()
}

/// Texts of a page of a hub, and those of a carriage in their place, before the words of the joint.
const ON_CARRIAGE: [(&str, &str); 35] = [
    ("T(t) = 1/2π ∫ H(ω)", "F(t) = 1/2π ∫ H(ω)"),
    (
        "H = T/a: solution of (K + iωC − ω²M) u = T e",
        "H = F/a: solution of (K + iωC − ω²M) u = F e",
    ),
    (
        "where e is 1 at the hub's angle and 0 elsewhere",
        "where e is 1 at the carriage and 0 elsewhere",
    ),
    (
        "T = (I a + c v̇)/L with its inertia I about the hub and the friction c of the hub, and under gravity the \
         moment of its weight",
        "F = m a + c v̇ with its mass m, that of the carriage included, and the friction c of the guide",
    ),
    ("θ(t) = 1/2π ∫ G(ω)", "u(t) = 1/2π ∫ G(ω)"),
    ("G = θ/a of the equations", "G = u/a of the equations"),
    ("θ = v/L. Bending of the tip: w = v − Lθ", "u = v. Bending of the tip: w = v − u"),
    ("T(t) e with the torque T of", "F(t) e with the force F of"),
    ("T(t): the played", "F(t): the played"),
    ("= T(t) e,", "= F(t) e,"),
    ("; v = u at the tip, θ = u at the hub,", "; v = u at the tip,"),
    ("v = w + xθ", "v = w + u"),
    (
        "v − xθ of a link that bends little, v: its displacement at x",
        "v − u, v: its displacement at x",
    ),
    ("v − Lθ of a link that bends little", "v − u"),
    (
        "|T/a| at ω = 2πf, of (K + iωC − ω²M) u = T e",
        "|F/a| at ω = 2πf, of (K + iωC − ω²M) u = F e",
    ),
    ("|I + c/(iω)|/L", "|m + c/(iω)|"),
    ("Rate of the hub", "Speed of the carriage"),
    ("displacement of the tip along its arc", "displacement of the tip"),
    ("|T / a|", "|F / a|"),
    ("dθ/dt of the hub", "du/dt of the carriage"),
    ("d²θ/dt² of the hub", "d²u/dt² of the carriage"),
    ("P = T dθ/dt", "P = F du/dt"),
    ("tanh((dθ/dt)", "tanh((du/dt)"),
    ("f = a T' + b |T'| x, T' = T + τ x", "f = a F' + b |F'| x, F' = F + τ x"),
    ("T_m = T/n + J", "T_m = F/n + J"),
    (
        "φ = n (θ + T/k): angle of the rotor, with the gear ratio n",
        "φ = n (u + F/k): angle of the rotor, n its rad per m",
    ),
    (
        "Angle that an encoder at the hub measures; the hub of a rigid link would turn as",
        "Position of the carriage; that of a rigid link would move as",
    ),
    ("Angle that an encoder at the hub measures", "Position of the carriage"),
    ("Rotation of the hub", "Position of the carriage"),
    (
        "from the hub's axis to the end, while it vibrates freely about its hub; each shape over its largest value. The \
         slope at the hub is the hub's own turning",
        "from the carriage to the end, while it vibrates with the carriage free; each shape over its largest value",
    ),
    ("Torque, tip and hub", "Force, tip and carriage"),
    ("displacement along the arc", "displacement"),
    ("Torque at the hub", "Force on the carriage"),
    ("Torque per tip", "Force per tip"),
    ("Torque that an", "Force that an"),
];

/// A page or a drawing in the words of the joint and the output of a link: its texts and the labels of its figures. Scripts,
/// styles and texts of [`own`] stay.
pub(super) fn worded(link: Option<&Link>, page: &str) -> String {
    let (mut kept, mut words) = (Vec::new(), String::with_capacity(page.len()));
    for (k, part) in page.split(OWN).enumerate() {
        if k % 2 == 0 {
            words += part;
        } else {
            words.push(OWN);
            kept.push(part);
        }
    }
    if let Some(link) = link.filter(|link| link.joint().slides() || link.has_station()) {
        words = reworded(link, &words);
    }
    let mut parts = words.split(OWN);
    let first = parts.next().unwrap_or_default().to_owned();
    kept.iter().zip(parts).fold(first, |whole, (own, part)| whole + own + part)
}

/// All texts and labels of a page or a drawing in the words of a link.
fn reworded(link: &Link, page: &str) -> String {
    let mut own = String::with_capacity(page.len());
    let (mut rest, mut before, mut last) = (page, "", "");
    // In a figure of a moment all texts keep its unit.
    let mut figure = "";
    let is_page = page.starts_with("<!DOCTYPE");
    while let Some(at) = rest.find('<') {
        let (text, tagged) = rest.split_at(at);
        own += &if last.starts_with("<code") {
            text.to_owned()
        } else {
            worded_text(link, text, if figure.is_empty() { before } else { figure })
        };
        if !text.trim().is_empty() {
            before = text;
        }
        let verbatim = ["script", "style"].into_iter().find(|own| tagged[1..].starts_with(own));
        let end = verbatim.map_or(">".to_owned(), |name| format!("</{name}>"));
        let end = tagged.find(&end).map_or(tagged.len(), |at| at + end.len());
        let (tag, after) = tagged.split_at(end);
        let is_drawing = !is_page && figure.is_empty() && tag.starts_with("<svg");
        if tag.starts_with("<figure") || is_drawing {
            let whole = after.find("</figure>").map_or(rest, |end| &after[..end]);
            figure = if whole.contains("data-y-name=\"moment\"") { "moment" } else { "" };
        } else if tag.starts_with("</figure") {
            (figure, before) = ("", "");
        }
        let is_label =
            verbatim.is_none() && tag.contains(" aria-label=\"") | tag.contains(" data-name=\"");
        own += &if is_label { worded_tag(link, tag, figure) } else { tag.to_owned() };
        (rest, last) = (after, tag);
    }
    own + rest
}

/// The labels of a tag in the words of a link.
fn worded_tag(link: &Link, tag: &str, figure: &str) -> String {
    let labels = ["aria-label", "data-name", "data-y-name", "data-y-unit", "data-unit"];
    let each = tag.split_inclusive('"').scan("", |name, part| {
        let is_label = labels.iter().any(|own| name.ends_with(&format!(" {own}=\"")));
        let worded = if is_label {
            worded_text(link, part, if figure.is_empty() { tag } else { figure })
        } else {
            part.to_owned()
        };
        *name = part;
        Some(worded)
    });
    each.collect()
}

/// A text in the words of the joint and the output of a link.
pub(super) fn worded_text(link: &Link, text: &str, before: &str) -> String {
    link.of_output(of_joint(&link.joint(), text, before))
}

/// A text in the words of a joint. Moments and motors, which it or the text `before` names, keep their units.
fn of_joint(joint: &Joint, text: &str, before: &str) -> String {
    if !joint.slides() {
        return text.to_owned();
    }
    let replaced =
        ON_CARRIAGE.iter().fold(text.to_owned(), |text, (hub, own)| text.replace(hub, own));
    let names = |of: &str, word: &str| of.to_lowercase().contains(word);
    let is_value =
        text.trim_start().starts_with(|first: char| first.is_ascii_digit()) || text.len() < 12;
    let of = if is_value || before == "moment" { before } else { text };
    if names(of, "motor") || names(text, "motor") {
        return replaced.replace("hub", "carriage");
    }
    let keeps = names(of, "moment") || names(text, "moment") || text.contains("EI");
    let (hidden, shown) = ("N\u{2060}m", "N m");
    let replaced = if keeps { replaced.replace(shown, hidden) } else { replaced };
    let words = [("angle in rad", "position in m"), ("rate in rad/s", "speed in m/s")];
    let replaced = words.iter().fold(replaced, |text, (hub, own)| text.replace(hub, own));
    let replaced = match replaced.trim_end_matches('"') {
        "angle" => replaced.replace("angle", "position"),
        "rate" => replaced.replace("rate", "speed"),
        _ => replaced,
    };
    joint.worded(&replaced).replace(hidden, shown)
}

/// Meanings of the kinds of warnings of a sweep's cases.
const WARNINGS: [(&str, &str); 37] = [
    ("failed", "The case has no numbers; the column error says why."),
    ("limit_exceeded", "A value exceeds its limit in the link file."),
    (
        "end_velocity_corrected",
        "The samples leave the tip moving at the end; this velocity was removed.",
    ),
    ("tip_missed", "The samples of the motion do not bring the tip within its tolerance."),
    ("inexact_window", "The time computed is too short for the tolerance."),
    (
        "coarse_step",
        "The step is too long: a shorter one would change the answer, or show hidden vibration.",
    ),
    (
        "unsettled_torque",
        "The motion does not determine the torque: its peak depends on the tip's tolerance.",
    ),
    (
        "uncertain_input",
        "The digits, the noise or the spacing of the samples leave the torque uncertain.",
    ),
    ("torque_cut", "The torque still acts outside the time that was written."),
    ("wrap_around", "The torque has not decayed when the computed period ends."),
    ("long_window", "The torque hardly decays, so that the time computed is long."),
    ("blocked_tip", "The motion contains a frequency at which no torque moves the tip."),
    ("near_nyquist", "The motion has jumps or noise that its step does not resolve."),
    ("above_mesh", "The torque has frequencies above those that the mesh resolves."),
    ("inexact_model", "The link bends or turns more than the linear model allows."),
    ("slow_iteration", "The second-order terms hardly converge."),
    ("inexact_iteration", "The second-order terms are not as exact as the tolerance asks."),
    ("second_order_left_out", "Second-order terms, which are left out, would change the torque."),
    ("thick_link", "Shear and rotary inertia, which are left out, would change the answer."),
    ("coarse_losses", "The losses of the drive change their sign too fast for the steps."),
    ("coarse_mesh", "Halved elements would change the answer by more than a little."),
    ("few_modes", "The modes that are left out would change the answer."),
    (
        "nearly_stretched",
        "The arm is nearly stretched or folded, so that small errors turn its joints far.",
    ),
    (
        "near_buckling",
        "The weight nearly buckles the link, so that small errors of its data change the answer much.",
    ),
    (
        "fell_back_to_first_order",
        "The second-order terms do not converge: only those of first order are counted.",
    ),
    ("begins_with_jump", "The torque does not begin at zero: it jumps there."),
    ("ends_with_jump", "The torque does not end at zero: it drops there."),
    ("hub_begins_moving", "The hub moves at once, but the link is taken to start at rest."),
    ("hub_ends_moving", "The hub still moves in its last row, but is taken to stop there."),
    (
        "rough_torque",
        "The torque that moves the hub is rough: digits or noise of the hub's angle make it.",
    ),
    (
        "begins_unheld",
        "The torque does not begin with the torque that holds the link where it starts.",
    ),
    ("reference_apart", "The reference does not begin where the hub stands."),
    ("state_cut", "The modes leave out a part of the state from which the link starts."),
    ("unsettled", "A finer computation still changes the answer."),
    ("imbalance", "Work and energy do not balance."),
    ("falls", "The weight exceeds the weight that buckles the link."),
    ("late_target", "The target begins after the tip has begun to move."),
];

/// Meaning of a kind of warning.
pub(super) fn warning_meaning(kind: &str) -> Option<&'static str> {
    let (kind, _) = kind.split_once(':').unwrap_or((kind, ""));
    WARNINGS.into_iter().find(|(own, _)| *own == kind).map(|(_, meaning)| meaning)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{Carriage, Hub, LinkParts, uniform};
    use crate::result::Exceeded;

    #[test]
    fn texts_and_labels_of_a_page_become_those_of_a_carriage() {
        let [hub, carriage] = [None, Some(Carriage::default())].map(|carriage| {
            Link::new(LinkParts { carriage, hub: Hub::default(), ..uniform() }).unwrap()
        });
        let page = |text: &str| worded(Some(&carriage), text);
        for (of_hub, own_words) in [
            ("<code>A torque at the hub</code>", "<code>A torque at the hub</code>"),
            ("<p>At most 3 N m.</p>", "<p>At most 3 N.</p>"),
            (
                &format!("<td>{}</td><td>torque</td>", own("torque.csv at the hub")),
                "<td>torque.csv at the hub</td><td>force</td>",
            ),
            (
                &format!("<path data-name=\"torque, {0}\">torque of {0}</path>", own("hub_torque")),
                "<path data-name=\"force, hub_torque\">force of hub_torque</path>",
            ),
            ("<th>peak root moment</th><td>3 N m</td>", "<th>peak root moment</th><td>3 N m</td>"),
            (
                "<th>peak motor torque</th><td>3 N m</td>",
                "<th>peak motor torque</th><td>3 N m</td>",
            ),
            (
                "<svg aria-label=\"Torque at the hub: torque in N m\" data-y-unit=\"N m\" class=\"hub\">",
                "<svg aria-label=\"Force on the carriage: force in N\" data-y-unit=\"N\" class=\"hub\">",
            ),
            (
                "<figure><svg data-y-name=\"moment\" data-y-unit=\"N m\" aria-label=\"\"></svg>3 N m</figure><p>3 N m.</p>",
                "<figure><svg data-y-name=\"moment\" data-y-unit=\"N m\" aria-label=\"\"></svg>3 N m</figure><p>3 N.</p>",
            ),
            ("<script>torque(hub)</script>", "<script>torque(hub)</script>"),
            (
                "<svg><title>Torque at the hub</title><text>3 N m</text></svg>",
                "<svg><title>Force on the carriage</title><text>3 N</text></svg>",
            ),
            (
                "<svg data-y-name=\"moment\"><text>3 N m</text></svg>",
                "<svg data-y-name=\"moment\"><text>3 N m</text></svg>",
            ),
        ] {
            assert_eq!(page(of_hub), own_words);
            assert_eq!(worded(Some(&hub), of_hub), of_hub.replace(OWN, ""));
        }
    }

    /// Reads the kinds from the sources of all warnings that a case of a sweep can have.
    #[test]
    fn every_kind_of_warning_of_a_sweep_has_a_sentence() {
        let sources = [
            include_str!("../mechanics/inverse/warning.rs"),
            include_str!("../mechanics/response/error.rs"),
            include_str!("../study/result/tip_error.rs"),
        ];
        let mut kinds = vec!["failed", Exceeded::KIND];
        for source in sources {
            let body = source.split("pub fn kind(&self)").nth(1).unwrap();
            let body = body.split("    pub fn ").next().unwrap();
            let quoted = body.split('"').skip(1).step_by(2);
            let before = kinds.len();
            kinds.extend(quoted);
            assert!(kinds.len() > before, "{body}");
        }
        assert!(kinds.len() > 30, "{kinds:?}");
        for kind in &kinds {
            assert!(warning_meaning(kind).is_some(), "{kind}");
        }
        let known = |(kind, _): &&(&str, &str)| !kinds.contains(kind);
        assert_eq!(WARNINGS.iter().find(known), None, "a kind that no warning has");
    }
}
