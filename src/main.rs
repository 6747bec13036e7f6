//! The program `flexlink`.

fn main() {}
