use num_complex::Complex64;

/// Absolute value |z|, with the same bits on every processor.
pub fn magnitude(z: Complex64) -> f64 {
    libm::hypot(z.re, z.im)
}
