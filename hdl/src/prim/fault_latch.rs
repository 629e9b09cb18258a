//! Fault latch: set asynchronously by a raw line, cleared by the clock while the line is inactive.
//!
//! It is the one leaf with an asynchronous set. It stores the complement `armed`: the register is then low at
//! power-up and after reset, which flip-flops of every device can do, and low is the safe side. A pulse on the line
//! that is too short for the clock is kept. A cycle-based simulation samples the line once per clock.

use super::Clocked;
use rust_hdl_core::prelude::*;
use rust_hdl_macros::LogicBlock;

/// `armed` falls with `trip_n` at once; it rises in a clock with `clear` if `trip_n` is high.
#[derive(LogicBlock, Default)]
pub(crate) struct FaultLatch {
    pub(crate) clk: Signal<In, Clock>,
    pub(crate) rst: Signal<In, Bit>,
    pub(crate) trip_n: Signal<In, Bit>,
    pub(crate) clear: Signal<In, Bit>,
    pub(crate) armed: Signal<Out, Bit>,
}

impl Clocked for FaultLatch {
    fn clk(&mut self) -> &mut Signal<In, Clock> {
        &mut self.clk
    }

    fn rst(&mut self) -> Option<&mut Signal<In, Bit>> {
        Some(&mut self.rst)
    }
}

impl Logic for FaultLatch {
    fn update(&mut self) {
        if self.clk.pos_edge() {
            self.armed.next = !self.rst.val() && (self.armed.val() || self.clear.val());
        }
        if !self.trip_n.val() {
            self.armed.next = false;
        }
    }

    fn connect(&mut self) {
        self.armed.connect();
    }

    fn hdl(&self) -> Verilog {
        Verilog::Custom(
            "\
// @leaf fault_latch reg: armed
// @about Falls with trip_n, without a clock; rises in a clock with clear. Low at power-up and after reset.
// @about The path from trip_n needs no timing constraint: set_false_path -to [get_registers *|armed].
initial armed = 1'h0;
always @(posedge clk or negedge trip_n) begin
    if (!trip_n) armed <= 1'h0;
    else if (rst) armed <= 1'h0;
    else if (clear) armed <= 1'h1;
end
"
            .to_owned(),
        )
    }
}
