//! Adds the cores for AMD's Vivado, where the registers are on AXI4-Lite.

use crate::failure::Failure;
use crate::hardware::Built;
use crate::verilog;
use posicast_blocks::bus_component::BridgedBus;
use posicast_hdl::emit::Module;
use posicast_machine::machine_file::Machine;
use posicast_synth::amd::{self, AmdCore};
use posicast_synth::package::Package;
use posicast_testbench::blocks::Block;

/// Adds the files of every top module on AXI4-Lite, the stage's first.
pub(crate) fn add(
    package: &mut Package,
    machine: &Machine,
    modules: &[Module],
    built: &Built<'_>,
) -> Result<(), Failure> {
    let on_axi = built.buses.iter().filter(|block| block.bus() == BridgedBus::AxiLite);
    let mut cores = Vec::new();
    // The stage is the last of them.
    for block in on_axi.rev() {
        let top = block.top();
        let Some(module) = modules.iter().find(|module| module.name == top) else {
            continue;
        };
        let sources = block.modules().map_err(Failure::because)?;
        cores.push(AmdCore {
            top: &module.name,
            ports: &module.ports,
            map: block.component().map(),
            sources: sources.iter().map(verilog::path).collect(),
        });
    }
    for (path, text) in amd::files(&machine.name, machine.clock.frequency_hz, &cores) {
        package.add(&path, text.as_bytes()).map_err(Failure::because)?;
    }
    Ok(())
}
