//! The `posicast` command.
fn main() {}
