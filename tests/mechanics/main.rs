//! The mechanics against closed forms, published numbers and methods written separately: one program, so
//! that the library is linked once.

mod arms;
mod carriage;
mod common;
mod dense;
mod drives;
mod elastica;
mod fit;
mod identification;
mod laws;
mod literature;
mod outliers;
mod recordings;
mod response;
mod solve;
mod theory;
mod trajectories;
mod verification;
