//! What `generate` adds for designs of one's own: file lists, datasheets, and for machines of shapers alone an integration kit.

use crate::failure::Failure;
use crate::hardware::Built;
use posicast_hdl::emit::Module;
use posicast_model::machine_file::Machine;
use posicast_synth::datasheets::{self, BuiltBlocks};
use posicast_synth::kit::{self, Kit, KitShaper};
use posicast_synth::package::Package;

/// The files, as path in the folder and text.
pub(crate) fn files(machine: &Machine, modules: &[Module], built: &Built<'_>) -> Vec<(String, String)> {
    let files: Vec<String> = modules.iter().map(|module| format!("rtl/{}.v", module.name)).collect();
    let has_shapers_alone = built.components.is_empty() && built.stage.is_none();
    let shapers = built.shapers.iter().filter(|_| has_shapers_alone);
    let shapers: Vec<KitShaper<'_>> = shapers
        .map(|shaper| KitShaper {
            axis: &shaper.axis,
            config: &shaper.config,
        })
        .collect();
    let datasheets = datasheets::files(match (&built.stage, built.components.is_empty()) {
        (Some(_), _) => BuiltBlocks::Stage,
        (None, false) => BuiltBlocks::Components,
        (None, true) => BuiltBlocks::Shapers,
    });
    let kit = kit::files(&Kit {
        machine: &machine.name,
        clock_hz: machine.clock.frequency_hz,
        sample_clocks: machine.clock.clocks_per_sample(),
        command_fraction: machine.fixed_point.command_fraction,
        files: &files,
        shapers: &shapers,
    });
    kit.into_iter().chain(datasheets).collect()
}

/// Adds the files to the folder.
pub(crate) fn add(package: &mut Package, files: &[(String, String)]) -> Result<(), Failure> {
    for (path, text) in files {
        package.add(path, text.as_bytes()).map_err(Failure::because)?;
    }
    Ok(())
}
