//! The bridge from the line to the host as a component for Platform Designer: a host of its own beside the processor.
//!
//! | interface | kind | ports |
//! |---|---|---|
//! | `clk`, `reset` | clock, synchronous reset | `clk`, `rst` |
//! | `avm` | Avalon-MM host, word addresses | `avm_*` |
//! | `line` | conduit | `uart_rx`, `uart_tx` or the four of SPI, `busy`, `frame_dropped` |
//!
//! The ports for the constants of the machine file belong to the conduit, which requires an interface for every port. They are terminated
//! by these constants, so that nobody sees or drives them.

use std::fmt::Write;

use posicast_blocks::Port;
use posicast_blocks::linked_stage::BridgeConfig;

use super::core::Line;
use super::hw_tcl;
use super::unit::{Interface, Kind, Signal, signal};

/// Name of the conduit.
const LINE: &str = "line";
/// Version of the component: that of its ports.
const VERSION: &str = "1.0";

/// The bridge of a machine.
#[derive(Debug, Clone)]
pub struct BridgeUnit {
    /// Its constants.
    pub config: BridgeConfig,
    /// Names of its Verilog modules, each a file `rtl/NAME.v` of the package, the top last.
    pub modules: Vec<String>,
}

impl BridgeUnit {
    /// Name of the component. It contains the machine's name because the constants are the machine's, although the Verilog is not.
    pub(super) fn name(&self, machine: &str) -> String {
        format!("{machine}_{}", self.config.block())
    }

    /// The kind of its line.
    pub(super) fn line(&self) -> Line {
        match self.config {
            BridgeConfig::Uart(_) => Line::Uart,
            BridgeConfig::Spi(_) => Line::Spi,
        }
    }

    /// The text of `MACHINE_uart_bridge_hw.tcl` or `MACHINE_spi_bridge_hw.tcl`.
    pub(super) fn text(&self, machine: &str) -> String {
        let name = self.name(machine);
        let about = match self.line() {
            Line::Uart => {
                "Bridge from a serial line to registers: a host at the line reads and writes words as an Avalon-MM host."
            }
            Line::Spi => {
                "Bridge from SPI to registers: a host at the lines reads and writes words as an Avalon-MM host."
            }
        };
        let mut text = String::new();
        hw_tcl::head(
            &mut text,
            (&name, VERSION),
            &format!("{}: {name}", self.config.block()),
            about,
        );
        let top = self.modules.last().map_or("", String::as_str);
        hw_tcl::file_sets(&mut text, top, &self.modules);
        let (speed, value, meaning) = self.config.speed();
        hw_tcl::parameter(&mut text, speed, value, meaning);
        hw_tcl::parameter(
            &mut text,
            "address_limit",
            self.config.address_limit().into(),
            "a request with a word address of this or above is refused: the words of the stage",
        );
        for interface in interfaces(self.config.ports()) {
            hw_tcl::interface(&mut text, &interface);
        }
        let _ = writeln!(text, "\n# Constants of the machine file");
        for (port, value) in self.config.constants() {
            let _ = writeln!(text, "set_port_property {port} TERMINATION true");
            let _ = writeln!(text, "set_port_property {port} TERMINATION_VALUE {value}");
        }
        text
    }
}

fn interfaces(ports: Vec<Port>) -> Vec<Interface> {
    let clk = Signal {
        port: "clk".to_owned(),
        role: "clk".to_owned(),
        is_input: true,
        width: 1,
    };
    let mut interfaces: Vec<Interface> = [
        ("clk", Kind::Clock, vec![clk]),
        ("reset", Kind::Reset, vec![]),
        ("avm", Kind::Host, vec![]),
        (LINE, Kind::Conduit, vec![]),
    ]
    .into_iter()
    .map(|(name, kind, signals)| Interface {
        name: name.to_owned(),
        kind,
        signals,
    })
    .collect();
    for port in ports {
        let (name, role) = match (port.name.as_str(), port.name.strip_prefix("avm_")) {
            ("rst", _) => ("reset", "reset"),
            (_, Some(role)) => ("avm", role),
            (name, None) => (LINE, name),
        };
        for interface in interfaces.iter_mut().filter(|interface| interface.name == name) {
            interface.signals.push(signal(&port, role));
        }
    }
    interfaces
}
