//! What halved elements change of the torque, found from as few frequencies as that takes.
//!
//! Torque per tip acceleration is a smooth function of frequency: its poles are the zeros of torque
//! → tip, which lie on the axis of real exponents, away from all frequencies. Between its zeros, the
//! natural frequencies, it follows the bending wave, whose phase grows with √ω. So the change that
//! halved elements make is solved for at few frequencies, evenly spaced in √ω, and interpolated
//! between them by quintics. At first there are no fewer intervals than the finer mesh has modes in
//! the band, of which each turns the wave by half a turn. Whether they suffice is measured: twice as
//! many are solved for, until what those before said of the new ones is right.
//!
//! ```text
//! wrong = 2 Σ_k |â_k| max |interpolated − solved|,   of the three solved frequencies nearest to ω_k
//! ```
//!
//! tells how far the interpolation from half as many frequencies may be off at any time: three,
//! because a wave's error vanishes somewhere. It must stay within four hundredths of the largest
//! change; from the frequencies as they are, quintics err by a fortieth of that or less, so that the
//! change is known to a thousandth of itself.
//!
//! Rotary inertia on the link, or a reduction to few modes, brings zeros of torque → tip near the
//! axis of frequencies: there every frequency is solved for.

mod change;
mod sampled;
#[cfg(test)]
mod tests;

pub(super) use change::change_n_m;
