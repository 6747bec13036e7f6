//! A table of positions, as a drive with a coarse encoder holds it, against a second integrator.

use std::f64::consts::TAU;

use faer::Mat;
use faer::linalg::solvers::Solve;
use flexlink::inverse::{Analysis, invert};
use flexlink::link::Damping;
use flexlink::motion::{Ends, Profile};
use flexlink::response::Interpolation;
use flexlink::result::{Held, SetPoint, SetPoints, Side, UnitChoice};
use flexlink::verify::table_error;

use super::assembly::Assembly;
use super::{link, plan_of};

const TRAVEL_M: f64 = 0.5;
const DURATION_S: f64 = 0.88;
const CYCLE_S: f64 = 2e-3;
const BETA_S: f64 = 1e-3;

/// The septic motion of the tip at a time.
fn wanted_m(time_s: f64) -> f64 {
    let u = (time_s / DURATION_S).clamp(0.0, 1.0);
    TRAVEL_M * u.powi(4) * (35.0 + u * (-84.0 + u * (70.0 - 20.0 * u)))
}

/// Rise of a hub between two positions: the place from 0 to 1, its first and its second derivative.
fn rise(u: f64) -> [f64; 3] {
    [
        u * u * u * (10.0 + u * (6.0 * u - 15.0)),
        30.0 * u * u * (1.0 - u) * (1.0 - u),
        60.0 * u * (1.0 - u) * (1.0 - 2.0 * u),
    ]
}

/// The assembled link on a moved hub, stepped by Newmark's average acceleration.
struct Stepper {
    /// Mass, damping, stiffness of the free coordinates, row by row, and of the hub's angle.
    own: [Vec<f64>; 3],
    hub: [Vec<f64>; 3],
    motion: [Vec<f64>; 3],
}

impl Stepper {
    fn new([mass, stiffness]: &[Mat<f64>; 2]) -> Self {
        let damping = faer::Scale(BETA_S) * stiffness;
        let all = [mass, &damping, stiffness];
        let free = mass.nrows() - 1;
        let own =
            all.map(|of| (0..free * free).map(|k| of[(1 + k / free, 1 + k % free)]).collect());
        let hub = all.map(|of| (0..free).map(|k| of[(1 + k, 0)]).collect());
        Self { own, hub, motion: [(); 3].map(|()| vec![0.0; free]) }
    }

    /// Inverse of the matrix of a step.
    fn inverse(&self, step_s: f64) -> Vec<f64> {
        let free = self.motion[0].len();
        let [mass, damping, stiffness] = &self.own;
        let whole = Mat::from_fn(free, free, |row, column| {
            let k = row * free + column;
            4.0 / step_s.powi(2) * mass[k] + 2.0 / step_s * damping[k] + stiffness[k]
        });
        let inverse = whole.partial_piv_lu().solve(Mat::<f64>::identity(free, free));
        (0..free * free).map(|k| inverse[(k / free, k % free)]).collect()
    }

    /// A step, at whose end the hub has this angle, rate and acceleration.
    fn step(&mut self, inverse: &[f64], step_s: f64, [angle, rate, acceleration]: [f64; 3]) {
        let ([x, v, a], free) = (&mut self.motion, self.hub[0].len());
        let times = |matrix: &[f64], of: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let row = |i: usize| (0..free).map(|j| matrix[i * free + j] * of(j)).sum();
            (0..free).map(row).collect()
        };
        let [mass, damping, _] = &self.own;
        let inert = times(mass, &|j| 4.0 / step_s.powi(2) * x[j] + 4.0 / step_s * v[j] + a[j]);
        let damped = times(damping, &|j| 2.0 / step_s * x[j] + v[j]);
        let [hub_mass, hub_damping, hub_stiffness] = &self.hub;
        let load: Vec<f64> = (0..free)
            .map(|i| {
                let of_hub = hub_mass[i] * acceleration + hub_damping[i] * rate;
                inert[i] + damped[i] - of_hub - hub_stiffness[i] * angle
            })
            .collect();
        let next = times(inverse, &|j| load[j]);
        for i in 0..free {
            let faster = 2.0 / step_s * (next[i] - x[i]) - v[i];
            a[i] = 2.0 / step_s * (faster - v[i]) - a[i];
            (x[i], v[i]) = (next[i], faster);
        }
    }

    fn tip_m(&self) -> f64 {
        self.motion[0][self.motion[0].len() - 2]
    }
}

/// Tip errors in m at the cycles of a hub that goes to each position within a twentieth of a cycle.
fn replayed(matrices: &[Mat<f64>; 2], first_s: f64, angles_rad: &[f64]) -> Vec<f64> {
    let mut stepper = Stepper::new(matrices);
    let (rise_s, parts, rests) = (CYCLE_S / 20.0, 10, 19);
    let [fine_s, coarse_s] = [rise_s / f64::from(parts), (CYCLE_S - rise_s) / f64::from(rests)];
    let [fine, coarse] = [fine_s, coarse_s].map(|step_s| stepper.inverse(step_s));
    let mut before = 0.0;
    let mut errors = Vec::new();
    for (k, angle) in angles_rad.iter().enumerate() {
        // The rises come half their time late.
        let time_s = first_s + CYCLE_S * k as f64 - 0.5 * rise_s;
        errors.push(stepper.tip_m() - wanted_m(time_s));
        for part in 1..=parts {
            let [place, rate, acceleration] = rise(f64::from(part) / f64::from(parts));
            let by = angle - before;
            let hub = [before + by * place, by * rate / rise_s, by * acceleration / rise_s.powi(2)];
            stepper.step(&fine, fine_s, hub);
        }
        (0..rests).for_each(|_| stepper.step(&coarse, coarse_s, [*angle, 0.0, 0.0]));
        before = *angle;
    }
    errors
}

/// The claim of the table, and what the second integrator finds.
#[test]
fn positions_held_for_2_ms_by_a_drive_of_12_bits_move_the_tip_off_as_claimed() {
    let link = link(|parts| {
        parts.damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: BETA_S };
    });
    let plan = plan_of(&link, 10);
    let motion = Profile::Septic.motion(TRAVEL_M, DURATION_S, 880).unwrap();
    let solution = invert(&link, &plan, &motion, &Analysis::default()).unwrap();
    let nodes_m = solution.links[0].mesh().nodes_m();
    let matrices = Assembly::of_link(&link, nodes_m).mass_and_stiffness();
    for (counts, is_coarse) in
        [("position=4096/360 deg", true), ("position=-1048576/360 deg+9", false)]
    {
        let choice = UnitChoice::of_counts(counts).unwrap();
        let table = SetPoints::of(&solution, &[SetPoint::Position], Side::Joint).unwrap();
        let table = table.on_cycle(CYCLE_S, Ends::AtRest).unwrap();
        let table = table.held(Interpolation::Zero, Ends::AtRest).in_units(&[], &[choice]).unwrap();
        let column = &table.columns()[0];
        let (numbers, unit) = (table.numbers_of(column), &column.unit);
        assert!(numbers.iter().all(|number| number.fract() == 0.0));
        // Of the whole numbers alone, as a drive has them.
        let per_rad = if is_coarse { 4096.0 / TAU } else { -1_048_576.0 / TAU };
        let angles: Vec<f64> =
            numbers.iter().map(|number| (number - unit.zero) / per_rad).collect();
        let errors = replayed(&matrices, table.grid().time_s(0), &angles);
        let [largest, square] = errors.iter().fold([0.0_f64, 0.0], |[most, sum], error| {
            [most.max(error.abs()), sum + error * error]
        });
        let rms_m = (square / errors.len() as f64).sqrt();
        let claimed =
            table_error(&solution, std::slice::from_ref(&plan), (&table, Held::Position), None);
        let claimed = claimed.unwrap_or_else(|_| panic!("the table is not played")).tip;
        println!(
            "{counts}: {largest:e} and {:e}, rms {rms_m:e} and {:e}",
            claimed.worst_m, claimed.rms_m
        );
        if !is_coarse {
            // Of 20 bits the rises of the second integrator remain.
            assert!(largest < 3e-5 && claimed.worst_m < 1e-5, "{} {largest}", claimed.worst_m);
            continue;
        }
        assert!((1e-3..1e-2).contains(&claimed.share), "{}", claimed.share);
        assert!((claimed.worst_m / largest - 1.0).abs() < 0.03, "{} {largest}", claimed.worst_m);
        assert!((claimed.rms_m / rms_m - 1.0).abs() < 0.03, "{} {rms_m}", claimed.rms_m);
    }
}
