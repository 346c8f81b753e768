//! The command line of steadysweep.

fn main() {}
