//! Synchroniser: two flip-flops that bring an asynchronous input into the clock's domain.
//!
//! The first may become metastable, and feeds only the second. Attributes tell synthesisers to keep the two, not to
//! merge them into shift registers, and to place them side by side. Only the first needs a timing constraint:
//! `set_false_path -to [get_registers *|synchroniser_first]`. In simulation the synchroniser is a delay of two
//! clocks.

use super::Clocked;
use rust_hdl_core::prelude::*;
use rust_hdl_macros::LogicBlock;

/// One line, delayed by two clocks; low in reset and at power-up.
#[derive(LogicBlock, Default)]
pub(crate) struct Synchroniser {
    pub(crate) clk: Signal<In, Clock>,
    pub(crate) rst: Signal<In, Bit>,
    pub(crate) pin: Signal<In, Bit>,
    pub(crate) level: Signal<Out, Bit>,
    _first: bool,
}

impl Clocked for Synchroniser {
    fn clk(&mut self) -> &mut Signal<In, Clock> {
        &mut self.clk
    }

    fn rst(&mut self) -> Option<&mut Signal<In, Bit>> {
        Some(&mut self.rst)
    }
}

impl Logic for Synchroniser {
    fn update(&mut self) {
        if self.clk.pos_edge() {
            let reset = self.rst.val();
            self.level.next = self._first && !reset;
            self._first = self.pin.val() && !reset;
        }
    }

    fn connect(&mut self) {
        self.level.connect();
    }

    fn hdl(&self) -> Verilog {
        Verilog::Custom(
            "\
// @leaf synchroniser
// @about Two flip-flops for an asynchronous input. Constrain only the path to the first:
// @about set_false_path -to [get_registers *|synchroniser_first]
// @about The attributes keep other logic away from both flip-flops, place them next to each other, and let the timing
// @about analyser report how long the first may take to settle.
(* preserve, keep, async_reg = \"true\", altera_attribute = \"-name SYNCHRONIZER_IDENTIFICATION FORCED\" *)
reg synchroniser_first;
(* preserve, keep, async_reg = \"true\" *)
reg synchroniser_second;
assign level = synchroniser_second;
initial begin
    synchroniser_first = 1'h0;
    synchroniser_second = 1'h0;
end
always @(posedge clk) begin
    if (rst) begin
        synchroniser_first <= 1'h0;
        synchroniser_second <= 1'h0;
    end else begin
        synchroniser_first <= pin;
        synchroniser_second <= synchroniser_first;
    end
end
"
            .to_owned(),
        )
    }
}
