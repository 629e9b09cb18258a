//! Kernels with sizes: compiled at a few of them, emitted at any, simulated at one that holds what is asked for.
//!
//! A size of a kernel is a const generic, and each combination is a type that takes its time to compile. So a kernel is
//! compiled at three: the largest that a machine can have; a second, from which and the first the emitter tells how each width
//! follows from the sizes; a third that proves it. Constants of a kernel come from the configuration and never from the sizes
//! that are compiled, so that a kernel also does what a smaller one would: so the first two serve the simulation of all.

use crate::emit::{self, EmitError, EmitOptions, Module};
use crate::simulation::Pins;

/// A kernel at one of the sizes that are compiled; `C` is what it is built from.
pub(crate) struct Compiled<C> {
    /// The sizes, the word's width first.
    pub(crate) sizes: &'static [u32],
    /// The kernel for a configuration. Sizes of the configuration beyond those of the kernel give a block that can be emitted
    /// from, and not simulated.
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

/// The kernel that stands for one of `sizes`: of words as wide where there is one, else, unless the word must be `exact`, of
/// wider ones.
pub(crate) fn holding<'a, C>(compiled: &'a [Compiled<C>], sizes: &[u32], exact: bool) -> Option<&'a Compiled<C>> {
    let holds = |kernel: &&Compiled<C>| kernel.sizes.iter().zip(sizes).all(|(there, wanted)| there >= wanted);
    let same_word = |kernel: &&Compiled<C>| kernel.sizes.first() == sizes.first();
    let wider = || compiled.iter().find(holds).filter(|_| !exact);
    compiled.iter().filter(same_word).find(holds).or_else(wider)
}
