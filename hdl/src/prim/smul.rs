//! Signed multiplier with registered inputs and output: one DSP block, product two clocks after the operands.
//!
//! It has no reset, because multiplier blocks do not have a synchronous one: its output is unknown in the first two
//! clocks.

use super::Clocked;
use crate::prelude::{from_i64, to_i64};
use rust_hdl_core::prelude::*;
use rust_hdl_macros::LogicBlock;

/// Sizes: A × B bits of operands, P = A + B ≤ 64 bits of product.
#[derive(LogicBlock, Default)]
pub(crate) struct SMul<const A: usize, const B: usize, const P: usize> {
    pub(crate) clk: Signal<In, Clock>,
    pub(crate) a: Signal<In, Signed<A>>,
    pub(crate) b: Signal<In, Signed<B>>,
    pub(crate) product: Signal<Out, Signed<P>>,
    _a: i64,
    _b: i64,
}

impl<const A: usize, const B: usize, const P: usize> Clocked for SMul<A, B, P> {
    fn clk(&mut self) -> &mut Signal<In, Clock> {
        &mut self.clk
    }
}

impl<const A: usize, const B: usize, const P: usize> Logic for SMul<A, B, P> {
    fn update(&mut self) {
        const { assert!(P == A + B && P <= 64) };
        if self.clk.pos_edge() {
            self.product.next = from_i64(self._a * self._b);
            self._a = to_i64(self.a.val());
            self._b = to_i64(self.b.val());
        }
    }

    fn connect(&mut self) {
        self.product.connect();
    }

    fn hdl(&self) -> Verilog {
        Verilog::Custom(format!(
            "\
// @leaf smul_{A}x{B} reg: product
// @about Signed multiplier, {A} x {B} bits, inputs and output registered: product two clocks after the operands.
// @about No reset and no enable, so that all three registers fit inside a multiplier block.
reg signed [{a_last}:0] a_q;
reg signed [{b_last}:0] b_q;
always @(posedge clk) begin
    a_q <= a;
    b_q <= b;
    product <= a_q * b_q;
end
",
            a_last = A - 1,
            b_last = B - 1,
        ))
    }
}
