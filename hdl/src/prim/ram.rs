//! Block RAM with one clock, one write port and one read port; data are read one clock after the address.
//!
//! It has no reset, and its contents are unknown before they are written. A word that is read in the clock in which
//! it is written is undefined, because devices differ. The simulation returns arbitrary contents for the former and
//! the complement of the written word for the latter, so that a block that uses either differs from its model.

use super::Clocked;
use crate::prelude::from_u64;
use rust_hdl_core::prelude::*;
use rust_hdl_macros::LogicBlock;

/// A RAM of 2^N words.
#[derive(LogicBlock)]
pub(crate) struct Ram<const D: usize, const N: usize> {
    pub(crate) clk: Signal<In, Clock>,
    pub(crate) write_enable: Signal<In, Bit>,
    pub(crate) write_address: Signal<In, Bits<N>>,
    pub(crate) write_data: Signal<In, Bits<D>>,
    pub(crate) read_address: Signal<In, Bits<N>>,
    pub(crate) read_data: Signal<Out, Bits<D>>,
    /// Bit patterns of the words; empty before the first clock, so that a block that is only emitted takes no memory.
    _words: Vec<u64>,
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
            _words: Vec::new(),
        }
    }
}

/// An arbitrary word (the multiplier is 2^64 over the golden ratio).
fn arbitrary(address: u64) -> u64 {
    (address + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 13
}

impl<const D: usize, const N: usize> Clocked for Ram<D, N> {
    fn clk(&mut self) -> &mut Signal<In, Clock> {
        &mut self.clk
    }
}

impl<const D: usize, const N: usize> Logic for Ram<D, N> {
    fn update(&mut self) {
        if self.clk.pos_edge() {
            if self._words.is_empty() {
                self._words = (0..1 << N).map(arbitrary).collect();
            }
            let (write, read) = (self.write_address.val(), self.read_address.val());
            self.read_data.next = from_u64(self._words[read.index()]);
            if self.write_enable.val() {
                self._words[write.index()] = self.write_data.val().into();
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
        Verilog::Custom(
            "\
// @leaf ram_${words write_address}x${width write_data} reg: read_data
// @about Block RAM, ${words write_address} words of ${width write_data} bits: one write port, one read port, read data one clock after the address.
// @about No reset: a word is unknown until it is written, and if it is read in the clock in which it is written.
// @about Synthesis infers block RAM from a registered read in the same clocked block. The attributes tell Yosys and
// @about Quartus that no word is read in the clock in which it is written; otherwise both would add bypass logic.
(* no_rw_check, ramstyle = \"no_rw_check\" *)
reg [${last_bit write_data}:0] words [0:${last_word write_address}];
always @(posedge clk) begin
    if (write_enable) words[write_address] <= write_data;
    read_data <= words[read_address];
end
"
            .to_owned(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Yosys needs the bare attribute, Quartus the value of `ramstyle`. Without it either builds logic around the
    /// memory for a word that is read in the clock in which it is written, which no block does.
    #[test]
    fn both_synthesisers_are_told_that_no_word_is_read_while_it_is_written() {
        let Verilog::Custom(text) = Ram::<8, 4>::default().hdl() else {
            panic!("a leaf has Verilog of its own");
        };
        assert!(
            text.contains("(* no_rw_check, ramstyle = \"no_rw_check\" *)\nreg [${last_bit write_data}:0] words"),
            "{text}"
        );
    }
}
