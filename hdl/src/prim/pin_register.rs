//! Pin register: one flip-flop in front of a synchroniser that is in another block.
//!
//! It may become metastable, so it must feed only a synchroniser. It has no reset, because a pin that stays high
//! through a reset must not look like an edge after it. It needs the same timing constraint as a synchroniser's first
//! flip-flop: `set_false_path -to [get_registers *|pin_register_q]`.

use super::Clocked;
use rust_hdl_core::prelude::*;
use rust_hdl_macros::LogicBlock;

/// One line, delayed by one clock; low at power-up.
#[derive(LogicBlock, Default)]
pub(crate) struct PinRegister {
    pub(crate) clk: Signal<In, Clock>,
    pub(crate) pin: Signal<In, Bit>,
    pub(crate) level: Signal<Out, Bit>,
}

impl Clocked for PinRegister {
    fn clk(&mut self) -> &mut Signal<In, Clock> {
        &mut self.clk
    }
}

impl Logic for PinRegister {
    fn update(&mut self) {
        if self.clk.pos_edge() {
            self.level.next = self.pin.val();
        }
    }

    fn connect(&mut self) {
        self.level.connect();
    }

    fn hdl(&self) -> Verilog {
        Verilog::Custom(
            "\
// @leaf pin_register
// @about One flip-flop for an asynchronous input, without reset; a synchroniser must follow. Constrain its path:
// @about set_false_path -to [get_registers *|pin_register_q]
(* preserve, keep, async_reg = \"true\", altera_attribute = \"-name SYNCHRONIZER_IDENTIFICATION FORCED\" *)
reg pin_register_q;
assign level = pin_register_q;
initial pin_register_q = 1'h0;
always @(posedge clk) pin_register_q <= pin;
"
            .to_owned(),
        )
    }
}
