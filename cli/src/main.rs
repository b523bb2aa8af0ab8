//! The kinopt command.
fn main() {}
