//! What a run should have written: the exact link under the file's motion, on a period many times
//! as long as the program's.
//!
//! The motion is what its samples say: acceleration samples are the band-limited acceleration
//! itself, displacement samples its double integral, D̂ (ωΔt/2)²/sin²(ωΔt/2) with their second
//! differences D. It ends with the band of the run, a raised cosine from `f_c` to `1.5 f_c`.
//!
//! Sums over frequency are Simpson's rule, not rectangles: hysteretic damping makes |ω| of the hub's
//! angle and |ω|³ of the torque at ω = 0, from which every period has images, and Simpson's panels,
//! which meet there, are exact for both.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use num_complex::Complex64;
use rayon::prelude::*;
use realfft::RealFftPlanner;

use super::answer::{Exact, Transfers};
use super::link::{Drive, Link};
use super::motion::Samples;

/// What the truth needs to know of a run: where its band ends, and which rows it wrote.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    /// Frequency in Hz at which the roll-off begins; none where every frequency of the samples is solved.
    pub(crate) band_hz: Option<f64>,
    /// Rows, numbered from the first sample of the motion.
    pub(crate) rows: Range<i64>,
    /// Places of the nodes that are compared, in m from the axis.
    pub(crate) nodes_m: Vec<f64>,
    /// Period of the truth in steps, a power of two.
    pub(crate) period: usize,
    /// Every so many rows are compared, a power of two.
    pub(crate) every: usize,
}

/// True histories at the rows whose number is a multiple of [`Run::every`].
#[derive(Debug, Clone)]
pub(crate) struct Truth {
    /// Number of the first row that is compared.
    pub(crate) first: i64,
    pub(crate) torque_n_m: Vec<f64>,
    /// Largest torque, motor torque and moment outside of the rows.
    pub(crate) outside_n_m: [f64; 3],
    pub(crate) hub_angle_rad: Vec<f64>,
    pub(crate) hub_rate_rad_s: Vec<f64>,
    pub(crate) hub_acceleration_rad_s2: Vec<f64>,
    pub(crate) motor_torque_n_m: Option<Vec<f64>>,
    pub(crate) motor_rate_rad_s: Option<Vec<f64>>,
    /// One history a node.
    pub(crate) displacement_m: Vec<Vec<f64>>,
    pub(crate) moment_n_m: Vec<Vec<f64>>,
    /// Largest values between the first row and the last, on a fine grid.
    pub(crate) peaks: Peaks,
    /// The tip as the file wants it, and as the band leaves it.
    pub(crate) wanted_m: Vec<f64>,
    pub(crate) tip_m: Vec<f64>,
}

/// Largest values of histories, over all times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Peaks {
    pub(crate) torque_n_m: f64,
    pub(crate) hub_rate_rad_s: f64,
    pub(crate) deflection_m: f64,
    /// At the first of the places, where there is one.
    pub(crate) moment_n_m: Option<f64>,
    pub(crate) motor_torque_n_m: Option<f64>,
}

/// Samples of a fine grid in a cycle of the highest frequency.
const IN_A_CYCLE: f64 = 16.0;

/// The motion over frequency on the truth's period.
struct Spectrum {
    step_s: f64,
    len: usize,
    /// `Σ a_j e^{−iωjΔt}` of the wanted acceleration, from zero to the Nyquist frequency.
    wanted: Vec<Complex64>,
    band_hz: Option<f64>,
}

impl Spectrum {
    fn new(samples: &Samples, run: &Run) -> Self {
        let (len, step_s) = (run.period, samples.step_s);
        let mut planner = RealFftPlanner::<f64>::new();
        let transform = planner.plan_fft_forward(len);
        let mut input = transform.make_input_vec();
        let values = &samples.values;
        if samples.is_displacement {
            let last = values.len() - 1;
            for k in 0..=last {
                let (before, after) = (values[k.saturating_sub(1)], values[(k + 1).min(last)]);
                input[k] = (after - 2.0 * values[k] + before) / (step_s * step_s);
            }
        } else {
            input[..values.len()].copy_from_slice(values);
        }
        let mut wanted = transform.make_output_vec();
        transform.process(&mut input, &mut wanted).expect("lengths that fit");
        wanted[0] = Complex64::ZERO;
        if samples.is_displacement {
            for (k, amplitude) in wanted.iter_mut().enumerate().skip(1) {
                let half = PI * k as f64 / len as f64;
                *amplitude *= (half / half.sin()).powi(2);
            }
        }
        Self { step_s, len, wanted, band_hz: run.band_hz }
    }

    fn omega(&self, k: usize) -> f64 {
        TAU * k as f64 / (self.len as f64 * self.step_s)
    }

    /// What the band leaves of an amplitude.
    fn weight(&self, k: usize) -> f64 {
        let Some(cut) = self.band_hz else { return 1.0 };
        let beyond = (self.omega(k) / TAU - cut) / (0.5 * cut);
        if beyond <= 0.0 {
            1.0
        } else if beyond >= 1.0 {
            0.0
        } else {
            0.5 * (1.0 + (PI * beyond).cos())
        }
    }

    /// Number of amplitudes that the band leaves.
    fn band(&self) -> usize {
        let inside = |cut: f64| (1.5 * cut * self.len as f64 * self.step_s).ceil() as usize;
        self.band_hz.map_or(self.wanted.len(), |cut| inside(cut).min(self.wanted.len()))
    }

    /// Samples at the multiples of `every` steps, of amplitudes from zero frequency on.
    fn samples(&self, amplitudes: &[Complex64], every: usize) -> Vec<f64> {
        let len = self.len / every;
        let mut folded = vec![Complex64::ZERO; len / 2 + 1];
        for (k, amplitude) in amplitudes.iter().enumerate() {
            // An amplitude and its conjugate at −k, both taken to the shorter period's bins.
            let once = if k == 0 || 2 * k == self.len { 1.0 } else { 2.0 };
            let bin = k % len;
            let half = 0.5 * once * amplitude;
            if bin <= len / 2 {
                folded[bin] += half;
            } else {
                folded[len - bin] += half.conj();
            }
            // The bins at zero and at the half stand for both signs.
            if bin == 0 || 2 * bin == len {
                folded[bin] += half.conj();
            }
        }
        folded[0] = folded[0].re.into();
        folded[len / 2] = folded[len / 2].re.into();
        let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(len);
        let mut output = inverse.make_output_vec();
        let scale = 1.0 / self.len as f64;
        for amplitude in &mut folded {
            *amplitude *= scale;
        }
        inverse.process(&mut folded, &mut output).expect("lengths that fit");
        output
    }

    /// Largest value from the first of some rows to the last, by samples of a fine grid.
    fn largest_within(&self, amplitudes: &[Complex64], rows: &Range<i64>) -> f64 {
        let nyquist = 0.5 / self.step_s;
        let highest = self.band_hz.map_or(nyquist, |cut| nyquist.min(1.5 * cut));
        let finer = ((IN_A_CYCLE * highest * self.step_s).ceil() as usize).next_power_of_two();
        let len = finer * self.len;
        let mut padded = amplitudes.to_vec();
        padded.resize(len / 2 + 1, Complex64::ZERO);
        if finer > 1 && amplitudes.len() > self.len / 2 {
            // At the Nyquist frequency an amplitude stood for both signs.
            padded[self.len / 2] *= 0.5;
        }
        padded[len / 2] = padded[len / 2].re.into();
        let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(len);
        let mut period = inverse.make_output_vec();
        inverse.process(&mut padded, &mut period).expect("lengths that fit");
        let finer = finer as i64;
        let places = rows.start * finer..=(rows.end - 1) * finer;
        let at = |place: i64| period[place.rem_euclid(len as i64) as usize].abs();
        places.map(at).fold(0.0, f64::max) / self.len as f64
    }

    /// The displacement that the file wants, at the multiples of `every` steps of the period.
    fn displacement(&self, samples: &Samples, every: usize) -> Vec<f64> {
        if !samples.is_displacement {
            return self.integrated(samples, every);
        }
        let (values, half) = (&samples.values, self.len / 2);
        let at = |k: usize| if k < half { values[k.min(values.len() - 1)] } else { values[0] };
        (0..self.len / every).map(|j| at(j * every)).collect()
    }

    /// The displacement that the file's acceleration has, at the multiples of `every` steps.
    ///
    /// A bell of velocity with the same way is taken off, so that what is left is a pulse, and its
    /// own displacement added again.
    fn integrated(&self, samples: &Samples, every: usize) -> Vec<f64> {
        let (way, step) = (samples.way_m(), self.step_s);
        let duration = (samples.values.len() - 1) as f64 * step;
        let (middle, width) = (0.5 * duration, (duration / 8.0).max(3.0 * step));
        let second: f64 =
            (0..samples.values.len()).map(|k| (k as f64 * step).powi(2) * samples.values[k]).sum();
        let mut pulse: Vec<Complex64> = (0..self.wanted.len())
            .map(|k| {
                let omega = self.omega(k);
                let bell = Complex64::from_polar(
                    way * omega * (-0.5 * (omega * width).powi(2)).exp() / step,
                    0.5 * PI - omega * middle,
                );
                -(self.wanted[k] - bell) / (omega * omega)
            })
            .collect();
        pulse[0] = (0.5 * second + way * middle / step).into();
        let half = self.len as f64 / 2.0;
        let mut displacement = self.samples(&pulse, every);
        for (j, d) in displacement.iter_mut().enumerate() {
            let k = (j * every) as f64;
            let time = step * if k < half { k } else { k - self.len as f64 };
            *d += way * 0.5 * libm::erfc(-(time - middle) / (width * 2.0_f64.sqrt()));
        }
        displacement
    }
}

impl Truth {
    pub(crate) fn of(link: &Link, samples: &Samples, run: &Run) -> Self {
        let exact = Exact::new(link, &run.nodes_m);
        let spectrum = Spectrum::new(samples, run);
        let band = spectrum.band();
        let amplitude = |k: usize| spectrum.wanted[k] * spectrum.weight(k);
        let transfers: Vec<Transfers> =
            (1..band).into_par_iter().map(|k| exact.at(spectrum.omega(k))).collect();
        // Simpson's rule over frequency.
        let simpson = |k: usize| if k.is_multiple_of(2) { 2.0 / 3.0 } else { 4.0 / 3.0 };
        // At ω = 0 the acceleration is iω times the travel, and what friction and Rayleigh's α take from
        // the tip's velocity is left.
        let low = 1e-4 * spectrum.omega(1);
        let lowest = exact.at(low);
        let amplitudes = |of: &dyn Fn(f64, &Transfers) -> Complex64| -> Vec<Complex64> {
            let at_zero = -low * of(low, &lowest).im * samples.way_m();
            let rest = transfers.iter().enumerate().map(|(j, transfer)| {
                amplitude(j + 1) * of(spectrum.omega(j + 1), transfer) * simpson(j + 1)
            });
            let zero = Complex64::from(at_zero * simpson(0) / spectrum.step_s);
            std::iter::once(zero).chain(rest).collect()
        };
        let history = |of: &dyn Fn(f64, &Transfers) -> Complex64| {
            spectrum.samples(&amplitudes(of), run.every)
        };
        let wanted = spectrum.displacement(samples, run.every);
        let tip = spectrum.followed(&wanted, run.every);
        let torque = history(&|_, t| t.torque);
        let length = link.rigid_output();
        let above = |excess: Vec<f64>, share: f64| -> Vec<f64> {
            excess.iter().zip(&tip).map(|(e, d)| e + share * d).collect()
        };
        let hub_angle = above(history(&|_, t| t.excess_angle), 1.0 / length);
        let motor_torque =
            link.drive.map(|drive| history(&|omega, t| motor(drive, omega, length, t)));
        let peak = |of: &dyn Fn(f64, &Transfers) -> Complex64| {
            spectrum.largest_within(&amplitudes(of), &run.rows)
        };
        let rate = |omega: f64, t: &Transfers| {
            Complex64::I * (omega * t.excess_angle - 1.0 / (omega * length))
        };
        let motor_rate = link.drive.map(|Drive { gear, stiffness_n_m, .. }| {
            history(&|omega, t| {
                (rate(omega, t) + Complex64::I * omega * t.torque / stiffness_n_m) * gear
            })
        });
        let peaks = Peaks {
            torque_n_m: peak(&|_, t| t.torque),
            hub_rate_rad_s: peak(&rate),
            deflection_m: length * peak(&|_, t| t.excess_angle),
            moment_n_m: (!run.nodes_m.is_empty()).then(|| peak(&|_, t| t.moment[0])),
            motor_torque_n_m: link
                .drive
                .map(|drive| peak(&|omega, t| motor(drive, omega, length, t))),
        };
        let moments: Vec<Vec<f64>> =
            (0..run.nodes_m.len()).map(|i| history(&|_, t| t.moment[i])).collect();
        let outside = |periods: &mut dyn Iterator<Item = &Vec<f64>>| {
            periods.map(|period| run.largest_outside(period)).fold(0.0, f64::max)
        };
        let outside_n_m = [
            run.largest_outside(&torque),
            outside(&mut motor_torque.iter()),
            outside(&mut moments.iter()),
        ];
        let cut = |period: &[f64]| run.cut(period);
        Self {
            first: run.first(),
            outside_n_m,
            torque_n_m: cut(&torque),
            hub_angle_rad: cut(&hub_angle),
            hub_rate_rad_s: cut(&history(&rate)),
            hub_acceleration_rad_s2: cut(&history(&|omega, t| {
                1.0 / length - omega * omega * t.excess_angle
            })),
            motor_torque_n_m: motor_torque.as_deref().map(cut),
            motor_rate_rad_s: motor_rate.as_deref().map(cut),
            displacement_m: (0..run.nodes_m.len())
                .map(|i| {
                    let excess = history(&|_, t| t.excess[i]);
                    cut(&above(excess, link.joint.rigid(run.nodes_m[i])[0] / length))
                })
                .collect(),
            moment_n_m: moments.iter().map(|moment| cut(moment)).collect(),
            peaks,
            wanted_m: cut(&wanted),
            tip_m: cut(&tip),
        }
    }
}

/// The displacement that a file wants at some rows.
pub(crate) fn wanted_m(samples: &Samples, run: &Run) -> Vec<f64> {
    run.cut(&Spectrum::new(samples, run).displacement(samples, run.every))
}

impl Spectrum {
    /// The wanted displacement less what lies above the band.
    fn followed(&self, wanted: &[f64], every: usize) -> Vec<f64> {
        let lost = (0..self.wanted.len()).map(|k| match self.weight(k) {
            1.0 => Complex64::ZERO,
            weight => self.wanted[k] * (1.0 - weight) / self.omega(k).powi(2),
        });
        let lost: Vec<Complex64> = lost.collect();
        wanted.iter().zip(self.samples(&lost, every)).map(|(d, l)| d + l).collect()
    }
}

/// Motor torque over the tip's acceleration: T/n + J n (θ̈ + T̈/k).
fn motor(drive: Drive, omega: f64, length: f64, t: &Transfers) -> Complex64 {
    let square = omega * omega;
    let angle_acceleration = 1.0 / length - square * t.excess_angle;
    let twist = -square * t.torque / drive.stiffness_n_m;
    t.torque / drive.gear + drive.rotor_kg_m2 * drive.gear * (angle_acceleration + twist)
}

impl Run {
    /// The first row that is compared.
    fn first(&self) -> i64 {
        let every = self.every as i64;
        self.rows.start + (-self.rows.start).rem_euclid(every)
    }

    /// Places in a period of the rows that are compared.
    fn cut(&self, period: &[f64]) -> Vec<f64> {
        let rows = (self.first()..self.rows.end).step_by(self.every);
        let place = |row: i64| (row / self.every as i64).rem_euclid(period.len() as i64) as usize;
        rows.map(|row| period[place(row)]).collect()
    }

    fn largest_outside(&self, period: &[f64]) -> f64 {
        let len = period.len() as i64;
        // Within a quarter of the period on each side; beyond it stand the images.
        let near = (-len / 4..len / 4).filter(|j| !self.rows.contains(&(j * self.every as i64)));
        near.map(|j| period[j.rem_euclid(len) as usize].abs()).fold(0.0, f64::max)
    }
}
