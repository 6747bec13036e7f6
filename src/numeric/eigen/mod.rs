//! Eigenvalues and eigenvectors of a symmetric matrix, all of them, with the same bits on every
//! processor: Householder's reduction to a tridiagonal matrix and the implicit QL iteration.
//!
//! Libraries of dense algebra choose fused multiply-add and the order of their sums by the
//! processor, which changes last digits. Here each product and sum is rounded by itself and the
//! order is fixed; only how many of them are worked on at a time is the processor's. With nalgebra's
//! solver, whose bits are fixed too, a solve with modal damping takes 15 % longer on 100 elements and
//! 35 % on 250.

mod symmetric;
mod tridiagonal;

pub(crate) use symmetric::SymmetricEigen;
