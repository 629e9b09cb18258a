//! The typed emitter (`posicast_emit`), with the documentation of this crate's kernels as heads of their modules.

pub use posicast_emit::{
    CONNECTIONS_TAG, EmitCause, EmitError, EmitOptions, Header, LIBRARY, Module, ModuleInstance, Parameter, Type, add,
    check_name, compose, connect, digest, own_name, print, shared_name,
};

use posicast_emit::Heads;
use rust_hdl_core::prelude::Block;

/// See `build.rs`.
const HEADS: Heads = include!(concat!(env!("OUT_DIR"), "/heads.rs"));

/// Writes a block as Verilog: [`posicast_emit::emit`].
///
/// # Errors
/// Those of [`posicast_emit::emit`].
pub fn emit<B: Block + ?Sized>(block: &B, options: &EmitOptions) -> Result<Vec<Module>, EmitError> {
    posicast_emit::emit(block, options, HEADS)
}

/// Writes a kernel at other sizes as Verilog: [`posicast_emit::emit_sized`].
///
/// # Errors
/// Those of [`posicast_emit::emit_sized`].
pub fn emit_sized<B: Block + ?Sized>(
    samples: &[(&[u32], &B)],
    wanted: &[u32],
    options: &EmitOptions,
) -> Result<Vec<Module>, EmitError> {
    posicast_emit::emit_sized(samples, wanted, options, HEADS)
}

#[cfg(test)]
mod tests {
    use super::HEADS;

    #[test]
    fn every_kernel_has_a_head() {
        assert!(HEADS.len() > 50, "{}", HEADS.len());
        for (name, head) in HEADS {
            assert!(head.lines().any(|line| !line.trim().is_empty()), "{name}");
        }
    }
}
