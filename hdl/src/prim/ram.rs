//! Block RAM: one clock, one write port, one read port, read data one clock after the address.
//!
//! It has no reset, and nobody knows what it holds before it is written. A word that is read in the clock in which it is
//! written is undefined: devices differ. The simulation gives arbitrary contents for the one and the complement of the
//! written word for the other, so that a block that uses either differs from its model.

use rust_hdl_core::prelude::*;
use rust_hdl_macros::LogicBlock;

/// RAM of 2^N words.
#[derive(LogicBlock)]
pub(crate) struct Ram<const D: usize, const N: usize> {
    pub(crate) clk: Signal<In, Clock>,
    pub(crate) write_enable: Signal<In, Bit>,
    pub(crate) write_address: Signal<In, Bits<N>>,
    pub(crate) write_data: Signal<In, Bits<D>>,
    pub(crate) read_address: Signal<In, Bits<N>>,
    pub(crate) read_data: Signal<Out, Bits<D>>,
    _words: Vec<Bits<D>>,
}

impl<const D: usize, const N: usize> Default for Ram<D, N> {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            write_enable: Signal::default(),
            write_address: Signal::default(),
            write_data: Signal::default(),
            read_address: Signal::default(),
            read_data: Signal::default(),
            _words: (0..1 << N).map(arbitrary).collect(),
        }
    }
}

/// A word like any other (the multiplier is 2^64 over the golden ratio).
fn arbitrary<const D: usize>(address: u64) -> Bits<D> {
    let word = (address + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 13;
    Bits::from(word & (u64::MAX >> (64 - D)))
}

impl<const D: usize, const N: usize> Logic for Ram<D, N> {
    fn update(&mut self) {
        if self.clk.pos_edge() {
            let (write, read) = (self.write_address.val(), self.read_address.val());
            self.read_data.next = self._words[read.index()];
            if self.write_enable.val() {
                self._words[write.index()] = self.write_data.val();
                if write == read {
                    self.read_data.next = !self.write_data.val();
                }
            }
        }
    }

    fn connect(&mut self) {
        self.read_data.connect();
    }

    fn hdl(&self) -> Verilog {
        let (words, last_word, last_bit) = (1u64 << N, (1u64 << N) - 1, D - 1);
        Verilog::Custom(format!(
            "\
// @leaf ram_{words}x{D} reg: read_data
// @about Block RAM, {words} words of {D} bits: one write port, one read port, read data one clock after the address.
// @about No reset: what was not written is unknown, and so is a word read in the clock in which it is written.
(* no_rw_check, ramstyle = \"no_rw_check\" *)
reg [{last_bit}:0] words [0:{last_word}];
always @(posedge clk) begin
    if (write_enable) words[write_address] <= write_data;
    read_data <= words[read_address];
end
"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Yosys takes the bare attribute, Quartus the value of `ramstyle`. Without it either builds logic around the memory for a word
    /// that is read in the clock in which it is written, which no block does.
    #[test]
    fn unit_both_synthesisers_are_told_that_no_word_is_read_while_it_is_written() {
        let Verilog::Custom(text) = Ram::<8, 4>::default().hdl() else {
            panic!("a leaf has Verilog of its own");
        };
        assert!(
            text.contains("(* no_rw_check, ramstyle = \"no_rw_check\" *)\nreg [7:0] words"),
            "{text}"
        );
    }
}
