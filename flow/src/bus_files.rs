//! Adds the files for other systems, where the registers are on a bus of theirs: cores for AMD's Vivado on AXI4-Lite, a module for LiteX
//! on Wishbone.

use crate::failure::Failure;
use crate::hardware::Built;
use crate::verilog;
use posicast_blocks::bus_component::BridgedBus;
use posicast_hdl::emit::Module;
use posicast_machine::machine_file::Machine;
use posicast_synth::bus_top::BusTop;
use posicast_synth::package::Package;
use posicast_synth::{amd, litex};
use posicast_testbench::blocks::Block;

/// Adds the files of every top module on the machine's bus, the stage's first.
pub(crate) fn add(
    package: &mut Package,
    machine: &Machine,
    modules: &[Module],
    built: &Built<'_>,
) -> Result<(), Failure> {
    // The stage is the last of them.
    let Some((first, others)) = built.buses.split_last() else {
        return Ok(());
    };
    let mut tops = Vec::new();
    for block in std::iter::once(first).chain(others) {
        let top = block.top();
        let Some(module) = modules.iter().find(|module| module.name == top) else {
            continue;
        };
        let sources = block.modules().map_err(Failure::because)?;
        tops.push(BusTop {
            top: &module.name,
            ports: &module.ports,
            map: block.component().map(),
            sources: sources.iter().map(verilog::path).collect(),
        });
    }
    let clock_hz = machine.clock.frequency_hz;
    let files = match first.bus() {
        BridgedBus::AxiLite => amd::files(&machine.name, clock_hz, &tops),
        BridgedBus::Wishbone { .. } => {
            let file = litex::file(&machine.name, clock_hz, &tops, first.component().name());
            file.into_iter().collect()
        }
    };
    for (path, text) in files {
        package.add(&path, text.as_bytes()).map_err(Failure::because)?;
    }
    Ok(())
}
