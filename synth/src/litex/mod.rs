//! The top modules on Wishbone as modules for LiteX: `litex/posicast_MACHINE.py`.
//!
//! The file has a class per top module, with the module's name. What all have in common is in `component.py`; ports, registers and
//! Verilog files are written behind it. The names of pins are strings in it, and those of classes end in `_wishbone`, so no name of a
//! machine or an axis can be one of Python's.

use std::fmt::Write;

use posicast_blocks::{Direction, Port};

use crate::bus_top::{BusTop, INTERRUPT};
use crate::register_documents::WORD_BYTES;

/// Folder of the file.
pub const FOLDER: &str = "litex";
/// What all classes have in common.
const COMPONENT: &str = include_str!("component.py");
/// Prefix of the ports of the bus.
const BUS_PREFIX: &str = "wb_";

/// The file of a machine, as path in the output folder and text. The example in it is the first top module, added as `name`.
pub fn file(machine: &str, clock_hz: f64, tops: &[BusTop<'_>], name: &str) -> Option<(String, String)> {
    let first = tops.first()?;
    let mut text = COMPONENT
        .replace("@MACHINE@", machine)
        .replace("@VERSION@", env!("CARGO_PKG_VERSION"))
        .replace("@FIRST@", first.top)
        .replace("@NAME@", name)
        .replace("@CAPITALS@", &name.to_uppercase())
        .replace("@CLOCK_HZ@", &clock_hz.to_string());
    for top in tops {
        write_class(&mut text, top);
    }
    Some((format!("{FOLDER}/posicast_{machine}.py"), text))
}

fn write_class(text: &mut String, top: &BusTop<'_>) {
    let about: Vec<&str> = top.map.about().lines().collect();
    let _ = write!(
        text,
        "\n\nclass {}(Component):\n    \"\"\"{}\"\"\"\n\n    SPAN_BYTES = {:#x}\n    HAS_INTERRUPT = {}\n",
        top.top,
        about.join("\n    "),
        WORD_BYTES << top.map.address_bits(),
        if top.has_interrupt() { "True" } else { "False" },
    );
    let (bus, pins): (Vec<&Port>, Vec<&Port>) = top
        .ports
        .iter()
        .filter(|port| port.name != INTERRUPT && port.name != "rst")
        .partition(|port| port.name.starts_with(BUS_PREFIX));
    let rows = |ports: Vec<&Port>| {
        let row = |port: &Port| {
            let direction = match port.direction {
                Direction::Input => "i",
                Direction::Output => "o",
            };
            let name = port.name.strip_prefix(BUS_PREFIX).unwrap_or(&port.name);
            format!("(\"{name}\", \"{direction}\", {})", port.width)
        };
        ports.into_iter().map(row).collect()
    };
    text.push_str("    # Name, direction and width.\n");
    tuple(text, "BUS", rows(bus));
    tuple(text, "PINS", rows(pins));
    text.push_str("    # Offsets in bytes.\n    REGISTERS = {\n");
    for register in top.map.registers() {
        let _ = writeln!(
            text,
            "        \"{}\": {:#x},",
            register.name,
            register.offset * WORD_BYTES
        );
    }
    text.push_str("    }\n");
    tuple(
        text,
        "SOURCES",
        top.sources.iter().map(|path| format!("\"{path}\"")).collect(),
    );
}

/// A constant of a class, a line per element.
fn tuple(text: &mut String, name: &str, elements: Vec<String>) {
    let _ = writeln!(text, "    {name} = (");
    for element in elements {
        let _ = writeln!(text, "        {element},");
    }
    text.push_str("    )\n");
}
