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
    _is_kept: bool,
}

/// Wiring of a register, or of an array of them, by `kernel!`.
pub(crate) trait Keep {
    /// Wires clock and reset; the register keeps its value unless the kernel assigns `d`.
    fn keep(&mut self, clock: Clock, rst: Bit);
}

impl<T: Synth> Dff<T> {
    /// Makes a register that its kernel wires itself.
    pub(crate) fn new(reset_value: T) -> Self {
        Self {
            clock: Signal::default(),
            rst: Signal::default(),
            d: Signal::default(),
            q: Signal::new_with_default(reset_value),
            _reset_value: reset_value,
            _is_kept: false,
        }
    }

    /// Makes a register that `kernel!` wires.
    pub(crate) fn kept(reset_value: T) -> Self {
        Self {
            _is_kept: true,
            ..Self::new(reset_value)
        }
    }
}

impl<T: Synth> Default for Dff<T> {
    fn default() -> Self {
        Self::new(T::default())
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

    /// `#[hdl_gen]` leaves `clock` and `d` to `dff_setup!`, but does not know that `rst` is wired there too.
    fn connect(&mut self) {
        self.q.connect();
        self.rst.connect();
        if self._is_kept {
            self.clock.connect();
            self.d.connect();
        }
    }

    fn hdl(&self) -> Verilog {
        let kept = if self._is_kept { " kept" } else { "" };
        Verilog::Custom(format!("// @dff {}{kept}\n", sized(self._reset_value)))
    }
}
