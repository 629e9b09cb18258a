//! Posicast: hdl.

pub mod emit;
