//! The processors: each a design in Verilog, in which it has the stage on its bus, and what its programs need.

use super::system::here;
use crate::driver::support::{Driver, run, stage};
use posicast_blocks::bus_component::{BridgedBus, BusComponent};
use posicast_blocks::component::Component;
use posicast_blocks::{ClockedBlock, Direction, Port, bus_component};
use posicast_synth::bus_top::BusTop;
use posicast_synth::litex;
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::bus_component::BusComponentBlock;
use posicast_testbench::component::ComponentBlock;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Name of the stage's top module.
const STAGE: &str = "slide_stage";
/// Ports of `processor.v` that the test sees: name, direction, width.
const CORE_PORTS: [(&str, Direction, u32); 8] = [
    ("load", Direction::Input, 1),
    ("load_word", Direction::Input, 13),
    ("load_data", Direction::Input, 32),
    ("seed", Direction::Input, 16),
    ("console_valid", Direction::Output, 1),
    ("console_data", Direction::Output, 32),
    ("stopped", Direction::Output, 1),
    ("in_interrupt", Direction::Output, 1),
];
/// Ports of the top of `litex_soc.py`, beside those of the stage.
const SOC_PORTS: [(&str, Direction, u32); 12] = [
    ("rst", Direction::Input, 1),
    ("load", Direction::Input, 1),
    ("load_word", Direction::Input, 13),
    ("load_data", Direction::Input, 32),
    ("serial_source_ready", Direction::Input, 1),
    ("serial_sink_valid", Direction::Input, 1),
    ("serial_sink_data", Direction::Input, 8),
    ("sim_trace", Direction::Input, 1),
    ("serial_source_valid", Direction::Output, 1),
    ("serial_source_data", Direction::Output, 8),
    ("serial_sink_ready", Direction::Output, 1),
    ("in_interrupt", Direction::Output, 1),
];
/// Prefix of the stage's ports at the top of `litex_soc.py`.
const SOC_PREFIX: &str = "stage_";
/// An output of the bridge that LiteX does not connect.
const STALL: &str = "wb_stall";

/// A processor with the stage.
pub(super) struct Core {
    /// Verilog files, and the name of the top.
    pub(super) files: Vec<PathBuf>,
    pub(super) top: &'static str,
    /// Ports of the top.
    pub(super) seen: Vec<Port>,
    /// What the names of the stage's ports begin with in the top.
    pub(super) prefix: &'static str,
    /// Ports of the stage on its bus, and those of its outputs that the top does not have.
    pub(super) ports: Vec<Port>,
    pub(super) unseen: &'static [&'static str],
    /// The model of the same.
    pub(super) model: Box<dyn ClockedBlock>,
    /// Outputs that are high for a character on the console, and with it.
    pub(super) console: [&'static str; 2],
    /// Outputs that are so in a clock with a read, and with a write.
    pub(super) read: &'static [(&'static str, bool)],
    pub(super) write: &'static [(&'static str, bool)],
    /// Options of the compiler, and the address of the memory.
    pub(super) options: Vec<String>,
    pub(super) ram_base: u32,
    /// The files behind these paths.
    _sources: Option<Sources>,
}

fn port(name: &str, direction: Direction, width: u32) -> Port {
    Port {
        name: name.to_owned(),
        direction,
        width,
        signed: false,
    }
}

/// The option by which a program includes what is particular to a core.
fn header(name: &str) -> String {
    format!("-DCORE=\"{}\"", here(name).display())
}

impl Core {
    /// A picorv32 with its memory, and a bridge to the stage on Avalon-MM.
    pub(super) fn picorv32(driver: &Driver) -> Self {
        let component = Component::stage(&stage(&driver.machine).config).unwrap();
        let block = ComponentBlock::new(component.clone(), STAGE, "xy");
        let ports = component.composition().ports();
        let (text, seen) = joined(ports);
        let system = driver.path().join("system.v");
        std::fs::write(&system, text).unwrap();
        let sources = Sources::write(&block).unwrap();
        Self {
            files: [sources.files(), &[system, here("processor.v"), core_file()]].concat(),
            top: "system",
            seen,
            prefix: "",
            ports: ports.to_vec(),
            unseen: &[],
            model: Box::new(component.model(1)),
            console: ["console_valid", "console_data"],
            read: &[("avs_read", true)],
            write: &[("avs_write", true)],
            options: vec![header("picorv32.h"), "-DSTAGE_BASE=0x40000000u".to_owned()],
            ram_base: 0,
            _sources: Some(sources),
        }
    }

    /// A SoC of LiteX with a VexRiscv, and the stage on Wishbone as the package's module adds it.
    pub(super) fn litex(driver: &Driver) -> Self {
        let component = Component::stage(&stage(&driver.machine).config).unwrap();
        let bus = BridgedBus::Wishbone { pipelined: false };
        let top = format!("{STAGE}_{}", bus.suffix());
        let block = BusComponentBlock::new(component.clone(), bus, &[], [&top, STAGE, "xy"]);
        let ports = bus_component::ports(&component, bus);
        let modules = block.modules().unwrap();
        let path = |module: &str| format!("rtl/{module}.v");
        let of_stage = BusTop {
            top: &top,
            ports: &ports,
            map: component.map(),
            sources: modules.iter().map(|module| path(&module.name)).collect(),
        };
        let machine = &driver.machine;
        let module = litex::file(&machine.name, machine.clock.frequency_hz, &[of_stage], component.name()).unwrap();
        let folder = driver.path().join("package");
        let verilog = modules.iter().map(|module| (path(&module.name), module.text.clone()));
        for (path, text) in verilog.chain([module]) {
            let path = folder.join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        let said = run(Command::new(python())
            .arg(here("litex_soc.py"))
            .arg(folder.join(litex::FOLDER))
            .args([&format!("posicast_{}", machine.name), &top])
            .arg(folder.join("soc")));
        let of_kind = |kind: &'static str| said.lines().filter_map(move |line| line.strip_prefix(kind));
        // LiteX's headers want the word `asm`.
        let mut options = vec![header("vexriscv.h"), "-fasm".to_owned()];
        options.extend(of_kind("include ").map(|path| format!("-isystem{path}")));
        // The bus is shown beside the pins: all of it is an output.
        let of_stage = ports.iter().filter(|port| port.name != "rst" && port.name != STALL);
        let of_stage = of_stage.map(|port| Port {
            name: format!("{SOC_PREFIX}{}", port.name),
            direction: if port.name.starts_with("wb_") {
                Direction::Output
            } else {
                port.direction
            },
            ..port.clone()
        });
        let own = SOC_PORTS.map(|(name, direction, width)| port(name, direction, width));
        Self {
            files: of_kind("source ").map(PathBuf::from).collect(),
            top: "sim",
            seen: own.into_iter().chain(of_stage).collect(),
            prefix: SOC_PREFIX,
            ports,
            unseen: &[STALL],
            model: Box::new(BusComponent::new(&component, bus, 1)),
            console: ["serial_source_valid", "serial_source_data"],
            read: &[("wb_ack", true), ("wb_we", false)],
            write: &[("wb_ack", true), ("wb_we", true)],
            options,
            ram_base: 0x4000_0000,
            _sources: None,
        }
    }
}

/// Returns the Python of the tests' virtual environment.
fn python() -> PathBuf {
    let python = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.venv/bin/python");
    assert!(
        python.exists(),
        "{} is missing: scripts/install-tools makes it",
        python.display()
    );
    python
}

/// Returns the core's Verilog, from the Python package of the tests.
fn core_file() -> PathBuf {
    let said = run(Command::new(python()).args([
        "-c",
        "import pythondata_cpu_picorv32 as core; print(core.data_location)",
    ]));
    Path::new(said.trim()).join("picorv32.v")
}

/// Returns the module that connects processor and stage. Its ports are the stage's pins, its bus to observe, and the
/// test's side of the processor.
fn joined(ports: &[Port]) -> (String, Vec<Port>) {
    let mut seen = vec![port("rst", Direction::Input, 1)];
    seen.extend(CORE_PORTS.map(|(name, direction, width)| port(name, direction, width)));
    for other in ports.iter().filter(|port| port.name != "rst") {
        let direction = if other.name.starts_with("avs_") {
            Direction::Output
        } else {
            other.direction
        };
        seen.push(port(&other.name, direction, other.width));
    }
    let mut text = String::from("`default_nettype none\nmodule system (\n    input wire clk");
    for port in &seen {
        let direction = if port.direction == Direction::Input {
            "input"
        } else {
            "output"
        };
        let _ = write!(text, ",\n    {direction} wire [{}:0] {}", port.width - 1, port.name);
    }
    text.push_str("\n);\n");
    let mut instance = |module: &str, parameters: &str, names: &mut dyn Iterator<Item = &str>| {
        let connected: Vec<String> = names.map(|name| format!(".{name}({name})")).collect();
        let _ = writeln!(
            text,
            "    {module} {parameters}{module}_0 (.clk(clk), {});",
            connected.join(", ")
        );
    };
    let bus = seen
        .iter()
        .map(|port| port.name.as_str())
        .filter(|name| name.starts_with("avs_"));
    let own = ["rst", "irq"]
        .into_iter()
        .chain(CORE_PORTS.iter().map(|(name, ..)| *name));
    let bits = ports.iter().find(|port| port.name == "avs_address").unwrap().width;
    instance("processor", &format!("#(.ADDRESS_BITS({bits})) "), &mut own.chain(bus));
    instance(STAGE, "", &mut ports.iter().map(|port| port.name.as_str()));
    text.push_str("endmodule\n");
    (text, seen)
}
