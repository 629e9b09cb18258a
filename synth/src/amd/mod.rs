//! The top modules on AXI4-Lite as IP cores for AMD's Vivado.
//!
//! | file | what it is |
//! |---|---|
//! | `amd/TOP/component.xml` | IP-XACT (1685-2009) as Vivado writes it: bus, clock, reset, interrupt, register map, files |
//! | `amd/TOP/TOP.xdc` | timing exceptions for pins that change at any time, scoped to the core |
//! | `amd/package_ip.tcl` | makes the same cores by Vivado's own packager, from the Verilog |
//! | `amd/zynq7.tcl`, `amd/microblaze.tcl` | a block design each, with a processor and the first core |
//!
//! Vivado itself is not run: its packager and its checks have the last word.

mod component_xml;
mod scripts;

use crate::bus_top::BusTop;

/// Folder of the files.
pub const FOLDER: &str = "amd";
/// Vendor and library of the cores.
const VENDOR: &str = "posicast";
const LIBRARY: &str = "machines";
/// Version of a core: that of its interfaces.
const VERSION: &str = "1.0";

/// The files of a machine's cores, as path in the output folder and text. The first core is that of the block designs.
pub fn files(machine: &str, clock_hz: f64, cores: &[BusTop<'_>]) -> Vec<(String, String)> {
    let of_core = cores.iter().flat_map(|core| {
        let folder = format!("{FOLDER}/{}", core.top);
        [
            (format!("{folder}/component.xml"), component_xml::document(core)),
            (format!("{folder}/{}.xdc", core.top), scripts::constraints(core)),
        ]
    });
    let scripts = cores.first().into_iter().flat_map(|first| {
        [
            (format!("{FOLDER}/package_ip.tcl"), scripts::package(machine, cores)),
            (format!("{FOLDER}/zynq7.tcl"), scripts::zynq7(machine, clock_hz, first)),
            (
                format!("{FOLDER}/microblaze.tcl"),
                scripts::microblaze(machine, clock_hz, first),
            ),
        ]
    });
    of_core.chain(scripts).collect()
}
