//! Blocks that can be composed, and report when they are idle.
//!
//! In most clocks a block only waits, or counts towards its next event. It is then *quiet*: its outputs stay the
//! same, clock after clock. If a block reports for how long, a [composition](super::composition) can skip those clocks
//! without changing a result:
//!
//! ```text
//! clock         0    1    2    3    4    5    6         quiet_clocks at clock 2: 3
//! inputs        -----------< the same       >
//! shown         < .. >< .. >< the same      >< new >    pass(inputs of clock 4, 3) at clock 2
//!                                                       gives the block as it is at clock 5
//! ```
//!
//! Every default is correct, but slow: a block that does not implement it is never quiet. To make a block fast:
//!
//! 1. Implement [`quiet_clocks`](Moore::quiet_clocks): 0 for anything that is not simple, [`FOREVER`] if the block
//!    only waits.
//! 2. Implement [`pass`](Moore::pass) if something counts meanwhile.
//! 3. Implement [`ignores`](Moore::ignores) for inputs that it reads only in clocks that are not quiet, such as the
//!    data beside a strobe.
//! 4. Add a line in `model/blocks/tests/quiet.rs`, which compares the result with a simulation clock by clock for random
//!    inputs.

use super::ClockedBlock;

/// Number of quiet clocks of a block that stays quiet as long as its inputs do not change.
pub const FOREVER: u64 = u64::MAX;

/// How an output gets its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputKind {
    /// The output comes from registers and does not change while the block is quiet.
    Register,
    /// The output comes from registers and goes up by one per clock, modulo its width, while the block is quiet.
    Counter,
    /// The output depends on registers and on inputs of the same clock.
    Combinational,
}

/// A block whose outputs come from registers: they are known before its inputs are.
///
/// Such blocks can be [composed](super::composition) without looking for an order of evaluation.
pub trait Moore: ClockedBlock {
    /// Writes the outputs of this clock, in port order. The values for [combinational](OutputKind::Combinational)
    /// outputs are meaningless.
    fn show(&self, outputs: &mut [u64]);

    /// How the output with this name gets its value. The answer never changes.
    fn output_kind(&self, _output: &str) -> OutputKind {
        OutputKind::Register
    }

    /// Writes the outputs of a clock with these inputs, in port order. Only
    /// [combinational](OutputKind::Combinational) ones differ from [`show`](Self::show).
    fn show_with(&mut self, _inputs: &[u64], outputs: &mut [u64]) {
        self.show(outputs);
    }

    /// Lower bound on the number of coming clocks that are quiet if the inputs stay as they are: after each of them
    /// all outputs are as now, except that [counters](OutputKind::Counter) have counted, and combinational outputs
    /// would be the same for any inputs.
    fn quiet_clocks(&self, _inputs: &[u64]) -> u64 {
        0
    }

    /// Advances by this many quiet clocks at once, 1 to [`quiet_clocks`](Self::quiet_clocks). `inputs` are those of
    /// the last of them: inputs that the block ignores may have changed meanwhile. The default changes no register.
    fn pass(&mut self, _inputs: &[u64], _clocks: u64) {}

    /// Whether a quiet block stays quiet, for the same number of clocks, when the input with this name changes. The
    /// answer never changes.
    fn ignores(&self, _input: &str) -> bool {
        false
    }
}

/// Writes the values of outputs, in port order.
#[inline]
pub(crate) fn show_each(outputs: &mut [u64], values: impl IntoIterator<Item = u64>) {
    for (output, value) in outputs.iter_mut().zip(values) {
        *output = value;
    }
}

/// Quiet clocks of a block that only waits while a clock changes nothing: [`FOREVER`] then, else 0. `clock` simulates
/// one of its clocks with the inputs, of which there are `N`.
pub(crate) fn quiet_at_rest<B: Clone + PartialEq, const N: usize>(
    block: &B,
    inputs: &[u64],
    clock: impl FnOnce(&mut B, &[u64; N]),
) -> u64 {
    let Ok(raw) = <&[u64; N]>::try_from(inputs) else {
        return 0;
    };
    let mut next = block.clone();
    clock(&mut next, raw);
    if next == *block { FOREVER } else { 0 }
}
