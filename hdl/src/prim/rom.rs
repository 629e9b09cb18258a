//! Block ROM; data are read one clock after the address.
//!
//! It is written as a memory with contents and a registered read, which becomes block RAM; a `case` would become logic.
//! Words above the last one given are undefined, and a block must not use them.

use super::Clocked;
use rust_hdl_core::prelude::*;
use rust_hdl_macros::LogicBlock;
use std::fmt::Write as _;

/// A word of a [`Rom`], with its comment in the Verilog.
#[derive(Clone, Debug)]
pub(crate) struct RomWord {
    pub(crate) pattern: u64,
    pub(crate) meaning: String,
}

/// A ROM of up to 2^N words.
#[derive(LogicBlock)]
pub(crate) struct Rom<const D: usize, const N: usize> {
    pub(crate) clk: Signal<In, Clock>,
    pub(crate) address: Signal<In, Bits<N>>,
    pub(crate) data: Signal<Out, Bits<D>>,
    _base_name: String,
    _words: Vec<RomWord>,
}

impl<const D: usize, const N: usize> Rom<D, N> {
    /// `base_name` is the module's name without those of machine and axis; two ROMs of one block need different ones.
    pub(crate) fn new(base_name: &str, words: Vec<RomWord>) -> Self {
        Self {
            clk: Signal::default(),
            address: Signal::default(),
            data: Signal::default(),
            _base_name: base_name.to_owned(),
            _words: words,
        }
    }
}

impl<const D: usize, const N: usize> Clocked for Rom<D, N> {
    fn clk(&mut self) -> &mut Signal<In, Clock> {
        &mut self.clk
    }
}

impl<const D: usize, const N: usize> Logic for Rom<D, N> {
    fn update(&mut self) {
        if self.clk.pos_edge() {
            let pattern = self
                ._words
                .get(self.address.val().index())
                .map_or(u64::MAX, |w| w.pattern);
            self.data.next = Bits::from(pattern & (u64::MAX >> (64 - D)));
        }
    }

    fn connect(&mut self) {
        self.data.connect();
    }

    fn hdl(&self) -> Verilog {
        let (name, used) = (&self._base_name, self._words.len());
        let mut contents = String::new();
        for (address, word) in self._words.iter().enumerate() {
            // Writing to a String cannot fail.
            let _ = writeln!(
                contents,
                "    words[{address}] = ${{pattern data {:x}}}; // {}",
                word.pattern, word.meaning,
            );
        }
        Verilog::Custom(format!(
            "\
// @leaf {name} reg: data
// @of_machine
// @about Block ROM, {used} of ${{words address}} words of ${{width data}} bits are used: data one clock after the address.
// @about Synthesis infers block RAM from a memory with contents and a registered read; a `case` would become logic.
reg [${{last_bit data}}:0] words [0:${{last_word address}}];
initial begin
{contents}end
always @(posedge clk) begin
    data <= words[address];
end
"
        ))
    }
}
