//! Files that accompany the Verilog in its folder: the C driver, documents of the registers, the FuseSoC core.

use crate::failure::Failure;
use crate::hardware::Stage;
use crate::verilog;
use posicast_blocks::component::Component;
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

/// Adds the whole driver if there is a stage, a header and documents for every component's registers, and the core.
pub(crate) fn add(
    package: &mut Package,
    machine: &Machine,
    modules: &[Module],
    components: &[ComponentBlock],
    (stage, link): (Option<&Stage>, Option<&LinkedStageBlock>),
) -> Result<(), Failure> {
    let mut add = |path: &str, text: &str| package.add(path, text.as_bytes()).map_err(Failure::because);
    for block in components {
        let header = driver::component_header(&block.top(), block.component().map());
        add(&header.path, &header.text)?;
    }
    for file in stage.into_iter().flat_map(|stage| stage_driver_files(machine, stage)) {
        add(&file.path, &file.text)?;
    }
    for block in components.iter().chain(stage.map(|stage| &stage.block)) {
        for (path, text) in register_documents::files(&block.top(), block.component().map()) {
            add(&path, &text)?;
        }
    }
    for (path, text) in core_files(machine, modules, stage, link) {
        add(&path, &text)?;
    }
    Ok(())
}

fn core_files(
    machine: &Machine,
    modules: &[Module],
    stage: Option<&Stage>,
    link: Option<&LinkedStageBlock>,
) -> Vec<(String, String)> {
    let files: Vec<String> = modules.iter().map(verilog::path).collect();
    let component: Option<&Component> = stage.map(|stage| stage.block.component());
    core_file::files(&Core {
        machine: &machine.name,
        top: &stage.map_or_else(|| machine.name.clone(), |stage| stage.block.top()),
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
