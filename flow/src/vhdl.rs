//! Adds the declarations of the top modules for designs in VHDL.

use crate::failure::Failure;
use crate::hardware::Built;
use crate::observer::Observer;
use crate::warning::Warning;
use posicast_blocks::bus_component::BridgedBus;
use posicast_blocks::component::Component;
use posicast_hdl::emit::Module;
use posicast_machine::hardware::NAME_KEY;
use posicast_machine::machine_file::Machine;
use posicast_synth::package::Package;
use posicast_synth::vhdl::{self, VhdlTop};
use posicast_testbench::blocks::Block;
use std::path::Path;

/// Adds the files of every top module. One whose name VHDL does not allow has none, and a warning says so.
pub(crate) fn add(
    package: &mut Package,
    (machine, path): (&Machine, &Path),
    modules: &[Module],
    built: &Built<'_>,
    observer: &dyn Observer,
) -> Result<(), Failure> {
    for top in tops(machine, modules, built) {
        match vhdl::files(&top) {
            Ok(files) => {
                for (file, text) in files {
                    package.add(&file, text.as_bytes()).map_err(Failure::because)?;
                }
            }
            Err(error) => {
                let text = format!("no VHDL is written for the module {}: {error}", top.name);
                Warning::new(0, NAME_KEY, text).tell(path, observer);
            }
        }
    }
    Ok(())
}

/// The top modules with their ports.
fn tops<'a>(machine: &'a Machine, modules: &'a [Module], built: &'a Built<'_>) -> Vec<VhdlTop<'a>> {
    let top = |name: &str, component: Option<&'a Component>| {
        let module = modules.iter().find(|module| module.name == name)?;
        Some(VhdlTop {
            name: &module.name,
            ports: &module.ports,
            map: component.map(Component::map),
            tables: Vec::new(),
            parameters: Vec::new(),
        })
    };
    let shapers = top(&machine.name, None).map(|top| VhdlTop {
        tables: built
            .shapers
            .iter()
            .filter_map(|shaper| Some((shaper.axis.as_str(), shaper.config.taps()?.table())))
            .collect(),
        ..top
    });
    let stage = built.stage.as_ref().map(|stage| &stage.block);
    let components = built.components.iter().chain(stage).chain(&built.inline_registers);
    let components = components.filter_map(|of| top(&of.top(), Some(of.component())));
    let inline = built.inline.as_ref().and_then(|inline| top(&inline.top(), None));
    let link = built
        .link
        .as_ref()
        .and_then(|link| top(&link.top(), Some(link.component())));
    let buses = built.buses.iter().filter_map(|bus| {
        let of_bus = top(&bus.top(), Some(bus.component()))?;
        let parameters = match bus.bus() {
            BridgedBus::AxiLite => Vec::new(),
            BridgedBus::Wishbone { pipelined } => vec![("PIPELINED", pipelined.into())],
        };
        Some(VhdlTop { parameters, ..of_bus })
    });
    let all = shapers.into_iter().chain(components).chain(inline);
    all.chain(link).chain(buses).collect()
}
