//! `component.xml`: a core in IP-XACT 1685-2009, with the bus definitions of Vivado's catalogue.

use std::fmt::Write;

use posicast_blocks::Direction;
use posicast_blocks::registers::{Register, RegisterMap};

use super::{LIBRARY, VENDOR, VERSION};
use crate::bus_top::BusTop;
use crate::register_documents::{Software, WORD_BYTES, escaped, fields, meaning, software};

/// Name of the bus interface, and of its memory map.
const BUS: &str = "s_axi";
/// Signals of AXI4-Lite; the port of each is `s_axi_` and its name in small letters.
const SIGNALS: [&str; 17] = [
    "AWADDR", "AWVALID", "AWREADY", "WDATA", "WSTRB", "WVALID", "WREADY", "BRESP", "BVALID", "BREADY", "ARADDR",
    "ARVALID", "ARREADY", "RDATA", "RRESP", "RVALID", "RREADY",
];
/// Families in which the catalogue offers the core.
const FAMILIES: [&str; 8] = [
    "artix7",
    "kintex7",
    "spartan7",
    "virtex7",
    "zynq",
    "zynquplus",
    "kintexuplus",
    "artixuplus",
];

/// Elements, indented by their depth.
struct Elements {
    text: String,
    depth: usize,
}

impl Elements {
    fn line(&mut self, line: &str) {
        let _ = writeln!(self.text, "{:width$}{line}", "", width = 2 * self.depth);
    }

    /// A leaf of the standard's name space.
    fn leaf(&mut self, name: &str, value: impl std::fmt::Display) {
        self.line(&format!(
            "<spirit:{name}>{}</spirit:{name}>",
            escaped(&value.to_string())
        ));
    }

    /// An element with others in it.
    fn nest(&mut self, name: &str, inner: impl FnOnce(&mut Self)) {
        self.line(&format!("<spirit:{name}>"));
        self.depth += 1;
        inner(self);
        self.depth -= 1;
        self.line(&format!("</spirit:{name}>"));
    }

    fn parameter(&mut self, name: &str, value: &str) {
        self.nest("parameter", |of| {
            of.leaf("name", name);
            of.leaf("value", value);
        });
    }

    /// A bus interface: its kind in the catalogue, whether it is a master, and pairs of signal and port.
    fn bus(
        &mut self,
        name: &str,
        (library, kind, version): (&str, &str, &str),
        role: &str,
        ports: &[(String, String)],
        parameters: &[(&str, &str)],
    ) {
        let catalogue = |kind: &str| {
            format!(
                "spirit:vendor=\"xilinx.com\" spirit:library=\"{library}\" spirit:name=\"{kind}\" spirit:version=\"{version}\""
            )
        };
        self.nest("busInterface", |of| {
            of.leaf("name", name);
            of.line(&format!("<spirit:busType {}/>", catalogue(kind)));
            of.line(&format!(
                "<spirit:abstractionType {}/>",
                catalogue(&format!("{kind}_rtl"))
            ));
            if library == "interface" {
                of.nest("slave", |of| {
                    of.line(&format!("<spirit:memoryMapRef spirit:memoryMapRef=\"{BUS}\"/>"));
                });
            } else {
                of.line(&format!("<spirit:{role}/>"));
            }
            of.nest("portMaps", |of| {
                for (signal, port) in ports {
                    of.nest("portMap", |of| {
                        of.nest("logicalPort", |of| of.leaf("name", signal));
                        of.nest("physicalPort", |of| of.leaf("name", port));
                    });
                }
            });
            if !parameters.is_empty() {
                of.nest("parameters", |of| {
                    parameters.iter().for_each(|(name, value)| of.parameter(name, value));
                });
            }
        });
    }
}

/// The document of a core.
pub(super) fn document(core: &BusTop<'_>) -> String {
    let mut text = Elements {
        text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<spirit:component xmlns:xilinx=\"http://www.xilinx.com\" \
               xmlns:spirit=\"http://www.spiritconsortium.org/XMLSchema/SPIRIT/1685-2009\" \
               xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\">\n"
            .to_owned(),
        depth: 1,
    };
    text.leaf("vendor", VENDOR);
    text.leaf("library", LIBRARY);
    text.leaf("name", core.top);
    text.leaf("version", VERSION);
    text.nest("busInterfaces", |of| interfaces(of, core));
    text.nest("memoryMaps", |of| memory_map(of, core.map));
    text.nest("model", |of| model(of, core));
    text.nest("fileSets", |of| file_sets(of, core));
    text.leaf("description", core.map.about());
    text.nest("parameters", |of| {
        of.nest("parameter", |of| {
            of.leaf("name", "Component_Name");
            of.line(&format!(
                "<spirit:value spirit:resolve=\"user\" spirit:id=\"PARAM_VALUE.Component_Name\" spirit:order=\"1\">{}_v1_0</spirit:value>",
                core.top
            ));
        });
    });
    text.nest("vendorExtensions", |of| {
        of.line("<xilinx:coreExtensions>");
        of.line("  <xilinx:supportedFamilies>");
        for family in FAMILIES {
            of.line(&format!(
                "    <xilinx:family xilinx:lifeCycle=\"Pre-Production\">{family}</xilinx:family>"
            ));
        }
        of.line("  </xilinx:supportedFamilies>");
        of.line("  <xilinx:taxonomies>");
        of.line("    <xilinx:taxonomy>/Motion_Control</xilinx:taxonomy>");
        of.line("  </xilinx:taxonomies>");
        of.line(&format!("  <xilinx:displayName>{}</xilinx:displayName>", core.top));
        of.line("  <xilinx:coreRevision>1</xilinx:coreRevision>");
        of.line("</xilinx:coreExtensions>");
    });
    text.text.push_str("</spirit:component>\n");
    text.text
}

fn interfaces(of: &mut Elements, core: &BusTop<'_>) {
    let one = |signal: &str, port: &str| vec![(signal.to_owned(), port.to_owned())];
    let signals = SIGNALS.map(|signal| (signal.to_owned(), format!("{BUS}_{}", signal.to_lowercase())));
    of.bus(BUS, ("interface", "aximm", "1.0"), "slave", &signals, &[]);
    let of_clock = [("ASSOCIATED_BUSIF", BUS), ("ASSOCIATED_RESET", "rst")];
    of.bus(
        "clk",
        ("signal", "clock", "1.0"),
        "slave",
        &one("CLK", "clk"),
        &of_clock,
    );
    let of_reset = [("POLARITY", "ACTIVE_HIGH")];
    of.bus(
        "rst",
        ("signal", "reset", "1.0"),
        "slave",
        &one("RST", "rst"),
        &of_reset,
    );
    if core.has_interrupt() {
        let of_irq = [("SENSITIVITY", "LEVEL_HIGH")];
        of.bus(
            "irq",
            ("signal", "interrupt", "1.0"),
            "master",
            &one("INTERRUPT", "irq"),
            &of_irq,
        );
    }
}

fn memory_map(of: &mut Elements, map: &RegisterMap) {
    of.nest("memoryMap", |of| {
        of.leaf("name", BUS);
        of.nest("addressBlock", |of| {
            of.leaf("name", "registers");
            of.leaf("baseAddress", "0x0");
            // What the address lines reach, a power of two.
            of.leaf("range", format!("{:#x}", WORD_BYTES << map.address_bits()));
            of.leaf("width", 32);
            of.leaf("usage", "register");
            for register in map.registers() {
                of.nest("register", |of| write_register(of, map, register));
            }
        });
    });
}

fn access_of(kind: Software) -> &'static str {
    match kind {
        Software::Read => "read-only",
        Software::Write => "write-only",
        Software::ReadWrite | Software::ReadClear => "read-write",
    }
}

fn write_register(of: &mut Elements, map: &RegisterMap, register: &Register) {
    let kind = software(&register.access);
    of.leaf("name", register.name.to_uppercase());
    of.leaf("description", &register.meaning);
    if register.words() > 1 {
        of.leaf("dim", register.words());
    }
    of.leaf("addressOffset", format!("{:#x}", register.offset * WORD_BYTES));
    of.leaf("size", 32);
    of.leaf("access", access_of(kind));
    for field in fields(map, register) {
        of.nest("field", |of| {
            of.leaf("name", &field.name);
            of.leaf("description", meaning(&field));
            of.leaf("bitOffset", field.low);
            of.leaf("bitWidth", field.width);
            of.leaf("access", access_of(kind));
            if kind == Software::ReadClear {
                of.leaf("modifiedWriteValue", "oneToClear");
            }
        });
    }
}

fn model(of: &mut Elements, core: &BusTop<'_>) {
    of.nest("views", |of| {
        for (view, title) in VIEWS {
            of.nest("view", |of| {
                of.leaf("name", format!("xilinx_anylanguage{view}"));
                of.leaf("displayName", title);
                of.leaf("envIdentifier", format!(":vivado.xilinx.com:{}", short(view)));
                of.leaf("language", "Verilog");
                of.leaf("modelName", core.top);
                of.nest("fileSetRef", |of| {
                    of.leaf("localName", format!("xilinx_anylanguage{view}_view_fileset"));
                });
            });
        }
    });
    of.nest("ports", |of| {
        let clock = ("clk", Direction::Input, 1);
        let ports = core.ports.iter();
        let ports = ports.map(|port| (port.name.as_str(), port.direction, port.width));
        for (name, direction, width) in std::iter::once(clock).chain(ports) {
            of.nest("port", |of| {
                of.leaf("name", name);
                of.nest("wire", |of| {
                    of.leaf(
                        "direction",
                        match direction {
                            Direction::Input => "in",
                            Direction::Output => "out",
                        },
                    );
                    if width > 1 {
                        of.nest("vector", |of| {
                            of.leaf("left", width - 1);
                            of.leaf("right", 0);
                        });
                    }
                });
            });
        }
    });
}

/// The views of the model, and their titles.
const VIEWS: [(&str, &str); 2] = [("synthesis", "Synthesis"), ("behavioralsimulation", "Simulation")];

/// What a view is for, in the name of its environment.
fn short(view: &str) -> &str {
    view.strip_prefix("behavioral").unwrap_or(view)
}

fn file_sets(of: &mut Elements, core: &BusTop<'_>) {
    for (view, _) in VIEWS {
        of.nest("fileSet", |of| {
            of.leaf("name", format!("xilinx_anylanguage{view}_view_fileset"));
            for source in &core.sources {
                of.nest("file", |of| {
                    of.leaf("name", format!("../../{source}"));
                    of.leaf("fileType", "verilogSource");
                });
            }
            if view == "synthesis" {
                of.nest("file", |of| {
                    of.leaf("name", format!("{}.xdc", core.top));
                    of.leaf("userFileType", "xdc");
                });
            }
        });
    }
}
