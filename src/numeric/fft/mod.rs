//! A real Fourier transform whose bits do not depend on the processor or the operating system.
//!
//! The usual libraries (rustfft, and realfft over it) take the factors `e^{2πi k/N}` from the system's
//! sine and cosine, and choose algorithm and rounding by processor. Here the order of operations
//! depends on the length alone, products and sums are rounded one by one, and sines come from `libm`.
//! The width of the processor's vectors only says how many columns are transformed at a time.
//!
//! `pair` is the door; `transform` holds the real transform by a complex one by rows and columns,
//! `passes` the butterflies along one of them, `vector` eight complex numbers side by side. The tests
//! hold it against the definition in 106 bits, and against realfft.

mod pair;
mod passes;
#[cfg(test)]
mod tests;
mod transform;
mod vector;

pub use pair::FourierPair;
pub(crate) use pair::{angular_frequency, fast_length};
pub(crate) use transform::Scratch;
