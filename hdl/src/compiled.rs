//! Kernels with sizes: compiled at a few sizes, emitted at any, simulated at one that is large enough.
//!
//! A size of a kernel is a const generic, and each combination is a type that takes time to compile. So a kernel is
//! compiled at three sizes. The first is the largest that a machine can have; from the first and the second the
//! emitter determines how each width depends on the sizes; the third verifies the result. Constants of a kernel come
//! from the configuration and never from the compiled sizes, so a large kernel behaves like a smaller one, and the
//! first two can simulate all sizes.

use crate::emit::{self, EmitError, EmitOptions, Module};
use crate::simulation::Pins;

/// A kernel at one of its compiled sizes; `C` is its configuration.
pub(crate) struct Compiled<C> {
    /// The sizes; the width of the word comes first if it is one of them.
    pub(crate) sizes: &'static [u32],
    /// Makes the kernel for a configuration. If the configuration exceeds the kernel's sizes, the block can be
    /// emitted but not simulated.
    pub(crate) build: fn(&C) -> Box<dyn Pins>,
}

/// The kernel's Verilog at `sizes`.
pub(crate) fn emit<C>(
    compiled: &[Compiled<C>],
    config: &C,
    sizes: &[u32],
    options: &EmitOptions,
) -> Result<Vec<Module>, EmitError> {
    let blocks: Vec<_> = compiled
        .iter()
        .map(|kernel| (kernel.sizes, (kernel.build)(config)))
        .collect();
    let samples: Vec<_> = blocks.iter().map(|(sizes, block)| (*sizes, block.as_ref())).collect();
    emit::emit_sized(&samples, sizes, options)
}

/// Returns a compiled kernel that is large enough for `sizes`, if possible one with the same first size. With `exact`
/// the first size must be the same.
pub(crate) fn holding<'a, C>(compiled: &'a [Compiled<C>], sizes: &[u32], exact: bool) -> Option<&'a Compiled<C>> {
    let holds = |kernel: &&Compiled<C>| kernel.sizes.iter().zip(sizes).all(|(there, wanted)| there >= wanted);
    let same_first = |kernel: &&Compiled<C>| kernel.sizes.first() == sizes.first();
    let larger = || compiled.iter().find(holds).filter(|_| !exact);
    compiled.iter().filter(same_first).find(holds).or_else(larger)
}
