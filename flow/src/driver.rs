//! Files that accompany the Verilog in its folder: the C driver, documents of the registers, the FuseSoC core.

use crate::failure::Failure;
use crate::hardware::{Built, COMPONENT_SUFFIX, Stage};
use crate::verilog;
use posicast_blocks::component::Component;
use posicast_blocks::registers::RegisterMap;
use posicast_hdl::emit::Module;
use posicast_machine::machine_file::Machine;
use posicast_machine::motion::TickLimits;
use posicast_synth::core_file::{self, Core};
use posicast_synth::driver::{self, AxisData, AxisFamily, DriverFile, StageDriver};
use posicast_synth::package::Package;
use posicast_synth::register_documents;
use posicast_testbench::blocks::Block;
use posicast_testbench::component::ComponentBlock;
use posicast_testbench::linked_stage::LinkedStageBlock;

/// Adds the whole driver if there is a stage, that of an inline shaper with a line, a header and documents for every component's
/// registers, and the core.
pub(crate) fn add(
    package: &mut Package,
    machine: &Machine,
    modules: &[Module],
    built: &Built<'_>,
) -> Result<(), Failure> {
    let (components, stage, link) = (&built.components, built.stage.as_ref(), built.link.as_ref());
    let inline = built.inline_registers.as_ref();
    let axes: Vec<&str> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
    let mut add = |path: &str, text: &str| package.add(path, text.as_bytes()).map_err(Failure::because);
    for block in components {
        let header = driver::component_header(&block.top(), block.component().map());
        add(&header.path, &header.text)?;
    }
    for file in stage.into_iter().flat_map(|stage| stage_driver_files(machine, stage)) {
        add(&file.path, &file.text)?;
    }
    if let Some(block) = inline {
        for file in driver::inline_files(&machine.name, &axes, block.component().map()) {
            add(&file.path, &file.text)?;
        }
    }
    for (name, tops, map) in documents(&machine.name, components, stage.map(|stage| &stage.block).or(inline)) {
        for (path, text) in register_documents::files(&name, &tops, map) {
            add(&path, &text)?;
        }
    }
    for (path, text) in core_files(machine, modules, stage.map(|stage| &stage.block).or(inline), link) {
        add(&path, &text)?;
    }
    Ok(())
}

/// Name, top modules and map of each document of registers. Components with the same map share one; it has the name
/// of their block, or of the first component where the axes differ in that block.
fn documents<'a>(
    machine: &str,
    components: &'a [ComponentBlock],
    whole: Option<&'a ComponentBlock>,
) -> Vec<(String, Vec<String>, &'a RegisterMap)> {
    let mut documents: Vec<(String, Vec<String>, &RegisterMap)> = Vec::new();
    for block in components {
        let map = block.component().map();
        match documents.iter_mut().find(|(_, _, known)| *known == map) {
            Some((_, tops, _)) => tops.push(block.top()),
            None => documents.push((block.top(), vec![block.top()], map)),
        }
    }
    for at in 0..documents.len() {
        let block = documents[at].2.name();
        if documents.iter().filter(|(_, _, map)| map.name() == block).count() == 1 {
            documents[at].0 = format!("{machine}_{block}{COMPONENT_SUFFIX}");
        }
    }
    documents.extend(whole.map(|block| (block.top(), vec![block.top()], block.component().map())));
    documents
}

fn core_files(
    machine: &Machine,
    modules: &[Module],
    whole: Option<&ComponentBlock>,
    link: Option<&LinkedStageBlock>,
) -> Vec<(String, String)> {
    let files: Vec<String> = modules.iter().map(verilog::path).collect();
    let component: Option<&Component> = whole.map(ComponentBlock::component);
    core_file::files(&Core {
        machine: &machine.name,
        top: &whole.map_or_else(|| machine.name.clone(), Block::top),
        link: link.map(Block::top).as_deref(),
        files: &files,
        bus: component.map(|component| (component.map(), component.composition().ports())),
    })
}

fn stage_driver_files(machine: &Machine, stage: &Stage) -> Vec<DriverFile> {
    let axes = machine.axes.iter().map(|axis| AxisData {
        unit: axis.unit,
        counts_per_unit: axis.loop_counts_per_file_unit(),
        limits: TickLimits::of_axis(axis, &machine.clock),
    });
    driver::stage_files(&StageDriver {
        machine: &machine.name,
        top: &stage.block.top(),
        map: stage.block.component().map(),
        config: &stage.of_machine.config,
        tick_hz: machine.clock.sample_hz,
        axes: &axes.collect::<Vec<_>>(),
        families: &AxisFamily::of_machine(machine, &stage.of_machine.families),
    })
}
