//! The stage, or the inline shaper, with its bridge in Verilog: a module that connects the two.
//!
//! The reference is `posicast_blocks::linked_stage`. The module is written as text, not as a composition, because the
//! two buses have addresses of different widths.

use crate::emit::print::{self, Lines};
use crate::emit::{EmitError, Header, Module, Parameter, Type, add};
use crate::{component, spi_bridge, uart_bridge};
use posicast_blocks::component::Component;
use posicast_blocks::inline_shaper::INLINE_SHAPER;
use posicast_blocks::linked_stage::{BridgeConfig, ports};

/// Width of the bridge's addresses.
const ADDRESS_BITS: u32 = 16;

/// All Verilog modules, sub-modules first, the top last. The top is called `name`, the stage in it `stage_name`. The
/// names of modules whose contents depend on the machine begin with `prefix`.
///
/// # Errors
/// [`EmitError`] where a name is not a valid Verilog name.
pub fn emit(
    stage: &Component,
    config: &BridgeConfig,
    (name, stage_name, prefix): (&str, &str, &str),
) -> Result<Vec<Module>, EmitError> {
    let mut modules = component::emit(stage, stage_name, prefix)?;
    let bridge = emit_bridge(config, prefix)?;
    let bridge_name = bridge.last().map_or_else(String::new, |module| module.name.clone());
    add(&mut modules, bridge)?;
    let top = Module {
        name: name.to_owned(),
        text: print::file(
            name,
            &header(name, what(stage), config),
            &body(stage, config, stage_name, &bridge_name),
        ),
        ports: ports(stage, config),
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
pub fn emit_bridge(config: &BridgeConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    match config {
        BridgeConfig::Uart(_) => uart_bridge::emit(prefix),
        BridgeConfig::Spi(_) => spi_bridge::emit(prefix),
    }
}

/// The component in words.
fn what(component: &Component) -> &'static str {
    match component.name() {
        INLINE_SHAPER => "inline shaper",
        _ => "stage",
    }
}

fn header(name: &str, what: &str, config: &BridgeConfig) -> String {
    let about = match config {
        BridgeConfig::Uart(_) => format!(
            "The {what} with its serial line: a host reads and writes the registers through uart_rx and uart_tx.\n\
             See docs/uart_bridge.md."
        ),
        BridgeConfig::Spi(_) => format!(
            "The {what} with its SPI lines: a host reads and writes the registers through spi_sck, spi_cs_n, spi_mosi and spi_miso.\n\
             See docs/spi_bridge.md."
        ),
    };
    let (speed, value, meaning) = config.speed();
    let header = Header {
        about,
        ports: Vec::new(),
        parameters: vec![
            Parameter::new(speed, value, meaning),
            Parameter::new("address_limit", config.address_limit(), "word addresses below it exist"),
        ],
    };
    print::data_header(name, &header, "machine file")
}

fn body(stage: &Component, config: &BridgeConfig, stage_name: &str, bridge_name: &str) -> String {
    let bits = |width, value: u64| Type::bits(width).literal(value);
    let list = print::wire_port_list(true, &ports(stage, config), &[]);
    let address_bits = stage.map().address_bits();
    let pin = |port: &str, net: &str| (port.to_owned(), net.to_owned());
    let mut lines = Lines::default();
    lines.nest(list.trim_end(), "endmodule", |lines| {
        lines.line(&format!("wire [{}:0] avm_address;", ADDRESS_BITS - 1));
        lines.line("wire avm_read;");
        lines.line("wire avm_write;");
        lines.line("wire [31:0] avm_writedata;");
        lines.line("wire [31:0] avm_readdata;");
        lines.line("wire busy;");
        lines.line("wire frame_dropped;");
        lines.line("");
        lines.line("// The registers answer a read one clock later.");
        lines.line("reg read_before = 1'b0;");
        lines.line("always @(posedge clk) begin");
        lines.line("    read_before <= avm_read & ~rst;");
        lines.line("end");
        lines.line("");
        let constants = config.constants();
        let pins = config.ports().into_iter().map(|port| {
            let constant = constants.iter().find(|(name, _)| *name == port.name);
            let net = match (constant, port.name.as_str()) {
                (Some((_, value)), _) => bits(port.width, (*value).into()),
                (_, "avm_waitrequest") => "avm_read & ~read_before".to_owned(),
                (_, name) => name.to_owned(),
            };
            (port.name, net)
        });
        let pins: Vec<_> = std::iter::once(pin("clk", "clk")).chain(pins).collect();
        print::instance(lines, bridge_name, &format!("u_{}", config.block()), &pins);
        lines.line("");
        let pins = stage.composition().ports().iter().map(|port| {
            let net = match port.name.as_str() {
                "avs_address" => format!("avm_address[{}:0]", address_bits - 1),
                "avs_read" => "avm_read".to_owned(),
                "avs_write" => "avm_write".to_owned(),
                "avs_byteenable" => bits(4, 0xf),
                "avs_writedata" => "avm_writedata".to_owned(),
                "avs_readdata" => "avm_readdata".to_owned(),
                name => name.to_owned(),
            };
            (port.name.clone(), net)
        });
        let pins: Vec<_> = std::iter::once(pin("clk", "clk")).chain(pins).collect();
        print::instance(lines, stage_name, &format!("u_{}", stage.name()), &pins);
        lines.line("");
        lines.line("// No address beyond address_limit comes out of the bridge.");
        lines.line(&format!(
            "wire unused = &{{1'b0, busy, frame_dropped, avm_address[{}:{address_bits}]}};",
            ADDRESS_BITS - 1
        ));
    });
    lines.text
}
