//! A component with the bridge of its bus in Verilog: a module that connects the two.
//!
//! The reference is `posicast_blocks::bus_component`. The module is written as text, not as a composition, because the buses
//! have addresses of different widths, and Wishbone a parameter.

use crate::component;
use crate::emit::print::{self, Lines};
use crate::emit::{EmitError, Header, Module, Type, add};
use posicast_blocks::bus_component::{BridgedBus, INNER_PREFIX, mapped, ports};
use posicast_blocks::component::Component;
use posicast_blocks::{Port, axi_lite_bridge, port_notes, wishbone_bridge};

/// Width of the bridges' word addresses.
const ADDRESS_BITS: u32 = 16;

/// All Verilog modules, sub-modules first, the top last. The top is called `name`, the component in it `component_name`. The
/// names of modules whose contents depend on the machine begin with `prefix`.
///
/// # Errors
/// [`EmitError`] where a name is not a valid Verilog name.
pub fn emit(
    component: &Component,
    bus: BridgedBus,
    (name, component_name, prefix): (&str, &str, &str),
) -> Result<Vec<Module>, EmitError> {
    let mut modules = component::emit(component, component_name, prefix)?;
    let bridge = emit_bridge(bus, prefix)?;
    let bridge_name = bridge.last().map_or_else(String::new, |module| module.name.clone());
    add(&mut modules, bridge)?;
    let top = Module {
        name: name.to_owned(),
        text: print::file(
            name,
            &header(name, component_name, bus),
            &body(component, bus, component_name, &bridge_name),
        ),
        ports: ports(component, bus),
        clocked: true,
        notes: Vec::new(),
    };
    add(&mut modules, vec![top])?;
    Ok(modules)
}

/// All Verilog modules of the bridge alone, the top last.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit_bridge(bus: BridgedBus, prefix: &str) -> Result<Vec<Module>, EmitError> {
    match bus {
        BridgedBus::AxiLite => crate::axi_lite_bridge::emit(prefix),
        BridgedBus::Wishbone { .. } => crate::wishbone_bridge::emit(prefix),
    }
}

fn header(name: &str, component: &str, bus: BridgedBus) -> String {
    let how = match bus {
        BridgedBus::AxiLite => "an AXI4-Lite bus of 32 bits, with byte addresses",
        BridgedBus::Wishbone { .. } => {
            "a Wishbone B4 bus of 32 bits, with word addresses;\nPIPELINED = 1 for a pipelined master, 0 for a classic one"
        }
    };
    let header = Header {
        about: format!("{component} with its registers on {how}.\nSee docs/{}.md.", bus.block()),
        ports: Vec::new(),
        parameters: Vec::new(),
    };
    print::data_header(name, &header, "machine file")
}

fn body(component: &Component, bus: BridgedBus, component_name: &str, bridge_name: &str) -> String {
    let parameters = match bus {
        BridgedBus::AxiLite => "",
        BridgedBus::Wishbone { pipelined: false } => "#(parameter PIPELINED = 0) ",
        BridgedBus::Wishbone { pipelined: true } => "#(parameter PIPELINED = 1) ",
    };
    let notes = match bus {
        BridgedBus::AxiLite => port_notes(axi_lite_bridge::PORTS),
        BridgedBus::Wishbone { .. } => port_notes(wishbone_bridge::PORTS),
    };
    let list = print::wire_port_list(true, &ports(component, bus), &notes);
    let list = format!("{parameters}{}", list.trim_end());
    let address_bits = component.map().address_bits();
    let widened = |port: &Port| match port.name.as_str() {
        "s_axi_awaddr" | "s_axi_araddr" | "wb_adr" => {
            format!("{{{}'d0, {}}}", ADDRESS_BITS - address_bits, port.name)
        }
        "pipelined" => "PIPELINED != 0".to_owned(),
        name => name.to_owned(),
    };
    let clock = ("clk".to_owned(), "clk".to_owned());
    let mut lines = Lines::default();
    lines.nest(&list, "endmodule", |lines| {
        let inner = bus.bridge_ports();
        for port in inner.iter().filter(|port| port.name.starts_with(INNER_PREFIX)) {
            match port.width {
                1 => lines.line(&format!("wire {};", port.name)),
                width => lines.line(&format!("wire [{}:0] {};", width - 1, port.name)),
            }
        }
        lines.line("");
        lines.line("// The words that have a register.");
        let address = format!("avm_address[{}:0]", address_bits - 1);
        let literal = |offset: u32| Type::bits(address_bits).literal(offset.into());
        let ranges = mapped(component.map());
        let terms: Vec<String> = ranges
            .iter()
            .map(|(first, last)| match (first, last) {
                (first, last) if first == last => format!("({address} == {})", literal(*first)),
                (0, last) => format!("({address} <= {})", literal(*last)),
                (first, last) => format!(
                    "(({address} >= {}) & ({address} <= {}))",
                    literal(*first),
                    literal(*last)
                ),
            })
            .collect();
        let terms = terms.join("\n        | ");
        lines.line(&format!("assign avm_mapped = {terms};"));
        lines.line("");
        let pins = inner.iter().map(|port| (port.name.clone(), widened(port)));
        let pins: Vec<_> = std::iter::once(clock.clone()).chain(pins).collect();
        print::instance(lines, bridge_name, &format!("u_{}", bus.block()), &pins);
        lines.line("");
        let pins = component.composition().ports().iter().map(|port| {
            let net = match port.name.strip_prefix("avs_") {
                Some("address") => address.clone(),
                Some(name) => format!("avm_{name}"),
                None => port.name.clone(),
            };
            (port.name.clone(), net)
        });
        let pins: Vec<_> = std::iter::once(clock).chain(pins).collect();
        print::instance(lines, component_name, &format!("u_{}", component.name()), &pins);
        lines.line("");
        lines.line("// The bus has no further address bits.");
        lines.line(&format!(
            "wire unused = &{{1'b0, avm_address[{}:{address_bits}]}};",
            ADDRESS_BITS - 1
        ));
    });
    lines.text
}
