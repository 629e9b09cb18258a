//! The leaves: blocks with hand-written Verilog, each with the Rust that simulates it.
//!
//! The first line of a leaf's Verilog is its tag for the emitter: `// @dff INIT` for a flip-flop, which the emitter
//! writes into the module that owns it, or `// @leaf NAME reg: PORTS` for a module of its own.

mod connections;
mod dff;
mod fault_latch;
mod pin_register;
mod ram;
mod rom;
mod smul;
mod synchroniser;

pub(crate) use connections::{Clocked, Connections, Part};
pub(crate) use dff::{Dff, Keep};
pub(crate) use fault_latch::FaultLatch;
pub(crate) use pin_register::PinRegister;
pub(crate) use ram::Ram;
pub(crate) use rom::{Rom, RomWord};
pub(crate) use smul::SMul;
pub(crate) use synchroniser::Synchroniser;

use rust_hdl_core::prelude::*;

/// The literal `<width>'h<pattern>`; RustHDL prints enumerations and signed numbers without their width or with a sign.
fn sized<T: Synth>(value: T) -> String {
    let text = format!("{:x}", value.verilog());
    let digits = text.split("'h").nth(1).unwrap_or_default();
    format!("{}'h{digits}", T::BITS)
}
