//! Register: takes `d` at the rising edge, or its reset value while `rst`; has the reset value at power-up.

use super::sized;
use rust_hdl_core::prelude::*;
use rust_hdl_macros::LogicBlock;

/// Register with synchronous reset.
#[derive(LogicBlock, Clone, Debug)]
pub(crate) struct Dff<T: Synth> {
    pub(crate) clock: Signal<In, Clock>,
    pub(crate) rst: Signal<In, Bit>,
    pub(crate) d: Signal<In, T>,
    pub(crate) q: Signal<Out, T>,
    _reset_value: T,
}

impl<T: Synth> Dff<T> {
    pub(crate) fn new(reset_value: T) -> Self {
        Self {
            clock: Signal::default(),
            rst: Signal::default(),
            d: Signal::default(),
            q: Signal::new_with_default(reset_value),
            _reset_value: reset_value,
        }
    }
}

impl<T: Synth> Default for Dff<T> {
    fn default() -> Self {
        Self::new(T::default())
    }
}

impl<T: Synth> Logic for Dff<T> {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self.q.next = if self.rst.val() {
                self._reset_value
            } else {
                self.d.val()
            };
        }
    }

    /// `#[hdl_gen]` claims `clock` and `d` for `dff_setup!`, and does not know that ours wires `rst` too.
    fn connect(&mut self) {
        self.q.connect();
        self.rst.connect();
    }

    fn hdl(&self) -> Verilog {
        Verilog::Custom(format!("// @dff {}\n", sized(self._reset_value)))
    }
}
