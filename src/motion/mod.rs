//! The wanted tip motion.

mod columns;

pub use columns::MotionColumns;
