//! The connections that `kernel!` makes without a statement of the logic.
//!
//! RustHDL takes a kernel's Verilog from its logic alone. So the kernel contains this block, which has no ports and
//! no module, and tells the emitter by its text what else is connected:
//!
//! ```text
//! // @connections
//! output state states.state            an output of the kernel, and its source
//! input states.enable enable           an input of a part, and its source
//! part states                          a part, connected to `clk` and `rst` where it has them
//! ```

use rust_hdl_core::prelude::*;

use crate::emit::CONNECTIONS_TAG;

/// A list of connections.
#[derive(Default)]
pub(crate) struct Connections {
    lines: String,
}

impl Connections {
    /// Adds an output of the kernel.
    pub(crate) fn output(&mut self, port: &str, source: &str) {
        self.lines.push_str(&format!("\noutput {port} {source}"));
    }

    /// Adds an input of a part.
    pub(crate) fn input(&mut self, port: &str, source: &str) {
        self.lines.push_str(&format!("\ninput {port} {source}"));
    }

    /// Adds a part that has the kernel's clock and reset.
    pub(crate) fn part(&mut self, name: &str) {
        self.lines.push_str(&format!("\npart {name}"));
    }
}

impl Logic for Connections {
    fn update(&mut self) {}

    fn hdl(&self) -> Verilog {
        Verilog::Custom(format!("{CONNECTIONS_TAG}{}", self.lines))
    }
}

impl Block for Connections {
    fn connect_all(&mut self) {}

    fn update_all(&mut self) {}

    fn has_changed(&self) -> bool {
        false
    }

    fn accept(&self, name: &str, probe: &mut dyn Probe) {
        probe.visit_start_scope(name, self);
        probe.visit_end_scope(name, self);
    }
}

/// A block with a clock, and a reset if it needs one.
pub(crate) trait Clocked {
    /// The clock input.
    fn clk(&mut self) -> &mut Signal<In, Clock>;

    /// The reset input.
    fn rst(&mut self) -> Option<&mut Signal<In, Bit>> {
        None
    }
}

/// Wiring of a part, or of an array of them, by `kernel!`.
pub(crate) trait Part {
    /// Wires clock and reset.
    fn wire(&mut self, clk: Clock, rst: Bit);

    /// Tells RustHDL that they are wired.
    fn claim(&mut self);
}

impl<T: Clocked> Part for T {
    fn wire(&mut self, clk: Clock, rst: Bit) {
        self.clk().next = clk;
        if let Some(input) = self.rst() {
            input.next = rst;
        }
    }

    fn claim(&mut self) {
        self.clk().connect();
        if let Some(input) = self.rst() {
            input.connect();
        }
    }
}

impl<T: Clocked, const N: usize> Part for [T; N] {
    fn wire(&mut self, clk: Clock, rst: Bit) {
        for part in self {
            part.wire(clk, rst);
        }
    }

    fn claim(&mut self) {
        self.iter_mut().for_each(Part::claim);
    }
}
