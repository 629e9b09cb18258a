//! Register: takes `d` at the rising edge, or its reset value while `rst` is high; it has the reset value at
//! power-up.

use super::sized;
use rust_hdl_core::prelude::*;
use rust_hdl_macros::LogicBlock;

/// A register with synchronous reset.
#[derive(LogicBlock, Clone, Debug)]
pub(crate) struct Dff<T: Synth> {
    pub(crate) clock: Signal<In, Clock>,
    pub(crate) rst: Signal<In, Bit>,
    pub(crate) d: Signal<In, T>,
    pub(crate) q: Signal<Out, T>,
    _reset_value: T,
}

/// Wiring of a register, or of an array of them, by `kernel!`.
pub(crate) trait Keep {
    /// Wires clock and reset; the register keeps its value unless the kernel assigns `d`.
    fn keep(&mut self, clock: Clock, rst: Bit);
}

impl<T: Synth> Dff<T> {
    /// Makes a register with this reset value.
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

impl<T: Synth> Keep for Dff<T> {
    fn keep(&mut self, clock: Clock, rst: Bit) {
        self.clock.next = clock;
        self.rst.next = rst;
        self.d.next = self.q.val();
    }
}

impl<T: Synth, const N: usize> Keep for [Dff<T>; N] {
    fn keep(&mut self, clock: Clock, rst: Bit) {
        for register in self {
            register.keep(clock, rst);
        }
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

    fn connect(&mut self) {
        self.clock.connect();
        self.rst.connect();
        self.d.connect();
        self.q.connect();
    }

    fn hdl(&self) -> Verilog {
        Verilog::Custom(format!("// @dff {} kept\n", sized(self._reset_value)))
    }
}
