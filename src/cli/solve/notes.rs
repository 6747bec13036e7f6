//! Lines about a table for a controller, and its warning.

use super::write_args::{Hold, WriteArgs};
use crate::cli::help::wrapped;
use crate::link::Arm;
use crate::response::Interpolation;
use crate::result::{DriveUnit, Held, Notice, SetPoints, Side};
use crate::text::{plain, significant};
use crate::verify::TableError;

/// Largest error of the tip over its travel without a warning, unless the tolerance is looser: the bound of `verify`.
const TIP: f64 = 1e-3;

/// Share of an error below which its uncertainty needs no line.
const KNOWN: f64 = 0.05;

/// Letters of a line of a reason.
const REASON: usize = 70;

/// Words of a table of torques, or of set-points.
#[derive(Clone, Copy)]
struct Words {
    table: &'static str,
    /// Size of a column of which a cut is a share, and with weight.
    sizes: [&'static str; 2],
    /// Place of the columns if there is a motor.
    motor: &'static str,
    /// Warning of drift after a cut.
    drift: &'static str,
    /// Remedy for a cut of efforts that is too large.
    smaller: &'static str,
}

const OF_LINK: Words = Words {
    table: "the torque table",
    sizes: ["the torque's peak", "the torque's range"],
    motor: "torque at the hub, beyond the gear; with -o the motor's own is in motor.csv",
    drift: "; a free hub drifts on after a cut",
    smaller: "use a smaller --window, or feedback of the hub's angle",
};

const OF_ARM: Words = Words {
    sizes: ["every torque's peak", "every torque's range"],
    motor: "torques at the joints, beyond gears; motor.csv of -o has the motors'",
    drift: "; free joints drift on after a cut",
    smaller: "use a smaller --window, or feedback of the joints",
    ..OF_LINK
};

/// The words of set-points, from those of torques.
const fn of_set_points(torques: Words) -> Words {
    Words {
        table: "the table",
        sizes: ["every column's peak or range"; 2],
        motor: "at the joint, beyond the gear; --side motor writes the motor's",
        ..torques
    }
}

/// A table of an arm with these options, and what plays of it found.
pub(super) struct Told<'a> {
    pub(super) options: &'a WriteArgs,
    pub(super) arm: &'a Arm,
    pub(super) table: &'a SetPoints,
    pub(super) errors: &'a [(Held, TableError)],
    /// Reasons why a table is not played.
    pub(super) unknown: &'a [(Held, String)],
}

impl Told<'_> {
    fn words(&self) -> Words {
        let torques = self.arm.pick(OF_LINK, OF_ARM);
        if self.options.is_plain() { torques } else { of_set_points(torques) }
    }

    /// The lines, in the words of the joint.
    pub(super) fn lines(&self, has_motor: bool) -> Vec<String> {
        let Self { options, table, errors, .. } = self;
        let (words, is_plain) = (self.words(), options.is_plain());
        let begins = format!("the motion begins at {} s", significant(table.moves_from_s(), 4));
        let columns = if is_plain { Vec::new() } else { described(table) };
        let cycle = options.cycle.map(|cycle_s| format!("a row each {} s", plain(cycle_s)));
        let cut = options.window.map(|share| {
            let size = words.sizes[usize::from(table.has_weight())];
            format!("cut below {} % of {size}", significant(100.0 * share, 3))
        });
        let held = options.hold.map(|hold| match hold {
            Hold::Zero => "values for a converter that holds each until the next".to_owned(),
            Hold::Linear => "values for a drive that draws straight lines between them".to_owned(),
        });
        let found = errors.iter().flat_map(|(held, error)| {
            let place = format!("{}:", where_held(*held, table.side()));
            (!is_plain).then_some(place).into_iter().chain(found(table, error))
        });
        let until = errors.last().filter(|_| options.window.is_some()).map(|(held, error)| {
            let until = significant(table.solved_until_s(), 3);
            let drifts = error.feedback.is_empty() && *held == Held::Effort;
            format!("measured to {until} s{}", if drifts { words.drift } else { "" })
        });
        let motor = has_motor && table.side() == Side::Joint;
        let unknown = self.unknown.iter().flat_map(|(held, reason)| {
            let place = format!("not played {}:", where_held(*held, table.side()));
            std::iter::once(place).chain(wrapped(reason, REASON))
        });
        let lines = std::iter::once(begins).chain(columns);
        let lines = lines.chain([cycle, cut, held].into_iter().flatten()).chain(found);
        let lines = lines.chain(until).chain(motor.then(|| words.motor.to_owned())).chain(unknown);
        lines.map(|line| self.arm.joint().worded(&line)).collect()
    }

    /// The warning of a table with a larger tip error than allowed.
    pub(super) fn warning(&self, tip_tolerance: f64) -> Option<Notice> {
        let (held, TableError { tip, change_m, .. }) = self.errors.first()?;
        let allowed = TIP.max(tip_tolerance);
        let share = tip.share * (1.0 + change_m / tip.worst_m.max(f64::MIN_POSITIVE));
        if share <= allowed {
            return None;
        }
        let (words, options) = (self.words(), self.options);
        let [share, allowed] = [share, allowed].map(|share| significant(share, 2));
        let table = words.table;
        let message =
            format!("{table} moves the tip off by {share} of its travel, more than {allowed}");
        let hint = match (options.window, options.counts.is_empty()) {
            (Some(_), false) => "use a smaller --window, finer counts or a shorter --cycle TIME",
            (None, false) if options.hold == Some(Hold::Linear) => {
                "use finer counts or a shorter --cycle TIME"
            }
            (None, false) => "use finer counts, a shorter --cycle TIME or --hold linear",
            (Some(_), true) if *held != Held::Effort => {
                "use a smaller --window or a shorter --cycle TIME"
            }
            (Some(_), true) => words.smaller,
            (None, true) if options.cycle.is_none() => "use a motion with a shorter step",
            (None, true) if options.hold.is_some() => "use a shorter --cycle TIME",
            (None, true) => "use a shorter --cycle TIME, or --hold as the drive has it",
        };
        Some(Notice::new("table_moves_tip", &message, hint).worded(self.arm))
    }
}

/// Where a drive holds a quantity.
fn where_held(held: Held, side: Side) -> String {
    let what = match held {
        Held::Position => "position",
        Held::Velocity => "velocity",
        Held::Effort => "effort",
    };
    let of_motor = if side == Side::Motor { " of its motor" } else { "" };
    format!("where the drive holds the {what}{of_motor}")
}

/// Units of the columns, a line each where they are counts.
fn described(table: &SetPoints) -> Vec<String> {
    let (mut units, mut counts) = (Vec::new(), Vec::new());
    for set_point in table.set_points() {
        let mut seen: Vec<&DriveUnit> = Vec::new();
        for own in table.columns_of(set_point) {
            if seen.contains(&&own.unit) {
                continue;
            }
            seen.push(&own.unit);
            let list = if own.unit.is_count { &mut counts } else { &mut units };
            list.push(own.unit.described(set_point, own.slides));
        }
    }
    let side = if table.side() == Side::Motor { "of the motors: " } else { "" };
    // Two quantities a line fit a terminal.
    let lines = units.chunks(2).map(|pair| format!("{side}{}", pair.join(", ")));
    lines.chain(counts.iter().map(|line| format!("{side}{line}"))).collect()
}

/// Results of playing a table, a line each.
fn found(table: &SetPoints, error: &TableError) -> Vec<String> {
    let TableError { tip, change_m, feedback } = error;
    let [worst, time, of] =
        [tip.worst_m, table.time_s(tip.time_s), tip.share].map(|number| significant(number, 3));
    let mut lines =
        vec![format!("tip off at the rows by up to {worst} m, {of} of its travel, at {time} s")];
    if *change_m > KNOWN * tip.worst_m {
        let change = significant(*change_m, 1);
        lines.push(format!(
            "known to {change} m, the change by the last refinements of the simulations"
        ));
    }
    if !feedback.is_empty() {
        let gains: Vec<String> = feedback.iter().flatten().map(|gain| plain(*gain)).collect();
        let falls = "nothing else holds the arm: played with feedback around its joints,";
        lines.push(falls.to_owned());
        lines.push(format!("{} (N m/rad and N m s/rad of each)", gains.join(",")));
        if table.interpolation() != Interpolation::Cubic {
            lines.push(
                "with a reference that is corrected for the hold as the torques are".to_owned(),
            );
        }
    }
    lines
}
