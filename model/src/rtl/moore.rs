//! Blocks that can be composed, and how one says that nothing happens in it.
//!
//! In most clocks a block only waits, or counts towards what comes next. It is then *quiet*: it shows the same, clock after
//! clock. A block that says for how long lets a [composition](super::composition) leave those clocks out, exactly:
//!
//! ```text
//! clock         0    1    2    3    4    5    6         quiet_clocks at clock 2: 3
//! inputs        -----------< the same       >
//! shown         < .. >< .. >< the same      >< new >    pass(inputs of clock 4, 3) at clock 2
//!                                                       gives the block as it is at clock 5
//! ```
//!
//! Every default is right, and slow: a block that says nothing is never quiet. To make a block fast:
//!
//! 1. [`quiet_clocks`](Moore::quiet_clocks): 0 for whatever is not simple; [`FOREVER`] if it only waits.
//! 2. [`pass`](Moore::pass): what counts meanwhile, if anything does.
//! 3. [`ignores`](Moore::ignores): inputs that it reads only in clocks that are not quiet, such as the data beside a strobe.
//! 4. A line in `model/tests/quiet.rs`, which compares with clock by clock for random inputs.

use super::ClockedBlock;

/// Quiet for as long as the inputs stay.
pub const FOREVER: u64 = u64::MAX;

/// How an output gets its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputKind {
    /// From registers; it stays as it is while the block is quiet.
    Register,
    /// From registers; it goes up by one per clock, modulo its width, while the block is quiet.
    Counter,
    /// From registers and from inputs of the same clock.
    Combinational,
}

/// A block whose outputs are registers: they are known before its inputs are.
///
/// That is what lets blocks be [composed](super::composition) without looking for an order.
pub trait Moore: ClockedBlock {
    /// Writes what the outputs show now, in port order. What it writes for [combinational](OutputKind::Combinational) ones
    /// means nothing.
    fn show(&self, outputs: &mut [u64]);

    /// How the output of that name gets its value; always the same.
    fn output_kind(&self, _output: &str) -> OutputKind {
        OutputKind::Register
    }

    /// Writes what the outputs show in a clock with these inputs, in port order. Only
    /// [combinational](OutputKind::Combinational) ones differ from [`show`](Self::show).
    fn show_with(&mut self, _inputs: &[u64], outputs: &mut [u64]) {
        self.show(outputs);
    }

    /// How many clocks from now on are quiet, with these inputs in all of them: after each, the block shows what it shows
    /// now, but for [counters](OutputKind::Counter), and combinational outputs would be the same for any inputs. It may
    /// be fewer than there are.
    fn quiet_clocks(&self, _inputs: &[u64]) -> u64 {
        0
    }

    /// So many quiet clocks at once, from 1 to [`quiet_clocks`](Self::quiet_clocks). `inputs` are those of the last of them:
    /// inputs that the block ignores may have changed meanwhile. By default nothing: no register changes.
    fn pass(&mut self, _inputs: &[u64], _clocks: u64) {}

    /// Whether a quiet block stays quiet, and for as long, when the input of that name changes. Always the same.
    fn ignores(&self, _input: &str) -> bool {
        false
    }
}

/// For a block that only waits while a clock changes nothing: quiet for ever then, else not at all. `clock` is one of its
/// clocks with the inputs.
pub(crate) fn quiet_at_rest<B: Clone + PartialEq>(block: &B, clock: impl FnOnce(&mut B)) -> u64 {
    let mut next = block.clone();
    clock(&mut next);
    if next == *block { FOREVER } else { 0 }
}
