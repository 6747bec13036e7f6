//! Summary from `learn`.

use super::lines::{LABEL, labelled};
use crate::learn::LearnSummary;
use crate::link::Arm;
use crate::numeric::largest;
use crate::robust::Hold;
use crate::text::{counted, significant};

/// Offset before the motion, over the travel, that is told.
const TOLD: f64 = 1e-3;

/// The summary of a step; `applied` names the played table, `output` that of the next step.
pub(crate) fn learn_text(arm: &Arm, summary: &LearnSummary, applied: &str, output: &str) -> String {
    let labels = [
        ("played", played_line(arm, summary, applied)),
        ("measured", measured_line(summary)),
        ("band", band_line(summary)),
        ("shrinks", shrinks_line(summary)),
        ("next", next_line(summary)),
        ("written", written_line(summary, output)),
    ];
    labelled(arm, labels)
}

/// A length, and its share of the travel: `2.3 % (0.0115 m)`.
fn both(m: f64, summary: &LearnSummary) -> String {
    let share = significant(100.0 * m / summary.travel_m, 3);
    format!("{share} % ({} m)", significant(m, 3))
}

fn played_line(arm: &Arm, summary: &LearnSummary, applied: &str) -> String {
    let what = match summary.play {
        Hold::Position => {
            arm.pick(arm.joint().worded("hub angle"), "angles of the joints".to_owned())
        }
        Hold::Effort | Hold::Feedback => arm.joint().worded("torque"),
    };
    let travel = significant(summary.travel_m, 4);
    format!("{what} of {applied};\n{:LABEL$}the tip travels {travel} m", "")
}

fn measured_line(summary: &LearnSummary) -> String {
    let [rms, peak] = [summary.rms_m, summary.peak_m].map(|m| both(m, summary));
    let [from, until] = summary.measured_s;
    let offset_m = largest(&summary.offset_m);
    let offset = if offset_m > TOLD * summary.travel_m {
        format!("\n{:LABEL$}offset at rest {}, left out", "", both(offset_m, summary))
    } else {
        String::new()
    };
    format!("error rms {rms}, largest {peak},\n{:LABEL$}from {from} to {until} s{offset}", "")
}

fn band_line(summary: &LearnSummary) -> String {
    let why = if summary.is_limited {
        "where plants differ as much as they respond"
    } else {
        "as of the motion"
    };
    let plants = counted(summary.plants, "plant");
    let [whole, end] = [summary.whole_until_hz, summary.band_end_hz].map(|hz| significant(hz, 3));
    format!("up to {end} Hz, {why} ({plants});\n{:LABEL$}whole error up to {whole} Hz", "")
}

fn shrinks_line(summary: &LearnSummary) -> String {
    let [most, weighted] =
        [summary.contraction, summary.weighted_contraction].map(|own| significant(own, 3));
    let at = significant(summary.contraction_hz, 3);
    format!(
        "error times {most} at {at} Hz, the most;\n{:LABEL$}times {weighted} over its spectrum",
        ""
    )
}

fn next_line(summary: &LearnSummary) -> String {
    let most = both(summary.predicted_rms_m, summary);
    format!("error rms up to {most},\n{:LABEL$}without noise, of a link within the intervals", "")
}

fn written_line(summary: &LearnSummary, output: &str) -> String {
    let [from, until] = summary.next_s;
    format!("{} from {from} to {until} s in {output}", counted(summary.rows, "row"))
}
