//! A top module on a bus other than Avalon-MM, from which the files for another system are written.

use posicast_blocks::Port;
use posicast_blocks::registers::RegisterMap;

/// A top module on AXI4-Lite or Wishbone.
#[derive(Debug, Clone)]
pub struct BusTop<'a> {
    /// Name of the module.
    pub top: &'a str,
    /// Its ports without `clk`, in the order of the Verilog.
    pub ports: &'a [Port],
    /// Its registers.
    pub map: &'a RegisterMap,
    /// Paths of its Verilog in the output folder, its own last.
    pub sources: Vec<String>,
}

impl BusTop<'_> {
    /// Whether it has an interrupt.
    pub(crate) fn has_interrupt(&self) -> bool {
        self.ports.iter().any(|port| port.name == INTERRUPT)
    }
}

/// Port of the interrupt.
pub(crate) const INTERRUPT: &str = "irq";
