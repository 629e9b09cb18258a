//! Files that `generate` adds for the user's own designs: file lists, datasheets, and for machines that have only
//! shapers an integration kit.

use crate::failure::Failure;
use crate::hardware::Built;
use crate::verilog;
use posicast_blocks::linked_stage::BridgeConfig;
use posicast_hdl::emit::Module;
use posicast_machine::machine_file::Machine;
use posicast_synth::datasheets::{self, BuiltBlocks};
use posicast_synth::kit::{self, Kit, KitShaper};
use posicast_synth::package::Package;
use posicast_testbench::bus_component::BusComponentBlock;

/// The files, as path in the folder and text.
pub(crate) fn files(machine: &Machine, modules: &[Module], built: &Built<'_>) -> Vec<(String, String)> {
    let files: Vec<String> = modules.iter().map(verilog::path).collect();
    let blocks = match (&built.stage, built.components.is_empty()) {
        (Some(_), _) => match built.link.as_ref().map(|link| link.config()) {
            Some(BridgeConfig::Spi(_)) => BuiltBlocks::SpiLinkedStage,
            Some(BridgeConfig::Uart(_)) => BuiltBlocks::LinkedStage,
            None => BuiltBlocks::Stage,
        },
        (None, _) if built.inline.is_some() => BuiltBlocks::Inline,
        (None, _) if built.inline_registers.is_some() => match built.link.as_ref().map(|link| link.config()) {
            Some(BridgeConfig::Spi(_)) => BuiltBlocks::SpiLinkedInline,
            _ => BuiltBlocks::LinkedInline,
        },
        (None, false) => BuiltBlocks::Components,
        (None, true) => BuiltBlocks::Shapers,
    };
    let shapers = built.shapers.iter().filter(|_| blocks == BuiltBlocks::Shapers);
    let shapers: Vec<KitShaper<'_>> = shapers
        .map(|shaper| KitShaper {
            axis: &shaper.axis,
            config: &shaper.config,
        })
        .collect();
    let kit = kit::files(&Kit {
        machine: &machine.name,
        clock_hz: machine.clock.frequency_hz,
        sample_clocks: machine.clock.clocks_per_sample(),
        command_fraction: machine.fixed_point.command_fraction,
        files: &files,
        shapers: &shapers,
    });
    let bus = built.buses.first().map(BusComponentBlock::bus);
    let has_cascade = built.shapers.iter().any(|shaper| shaper.config.taps().is_none());
    let pages = datasheets::files(blocks, bus, has_cascade);
    kit.into_iter().chain(pages).collect()
}

/// Adds the files to the folder.
pub(crate) fn add(package: &mut Package, files: &[(String, String)]) -> Result<(), Failure> {
    for (path, text) in files {
        package.add(path, text.as_bytes()).map_err(Failure::because)?;
    }
    Ok(())
}
