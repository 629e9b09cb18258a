//! The C driver of a machine's stage and components, in its folder.

use crate::failure::Failure;
use crate::stage::Stage;
use posicast_model::motion::TickLimits;
use posicast_model::spec::Machine;
use posicast_synth::driver::{self, AxisData, File, StageDriver};
use posicast_synth::package::Package;
use posicast_testbench::blocks::{Block, ComponentBlock};

/// Adds the driver: the whole of it where there is a stage, and a header of registers for every component.
pub(crate) fn add(
    package: &mut Package,
    machine: &Machine,
    components: &[ComponentBlock],
    stage: Option<&Stage>,
) -> Result<(), Failure> {
    let headers = components
        .iter()
        .map(|block| driver::component_header(&block.top(), block.component().map()));
    let files: Vec<File> = headers
        .chain(stage.into_iter().flat_map(|stage| of_stage(machine, stage)))
        .collect();
    for file in files {
        package
            .add(&file.path, file.text.as_bytes())
            .map_err(Failure::because)?;
    }
    Ok(())
}

fn of_stage(machine: &Machine, stage: &Stage) -> Vec<File> {
    let axes = machine.axes.iter().map(|axis| AxisData {
        counts_per_unit: axis.loop_counts_per_unit(),
        limits: TickLimits::of_axis(axis, &machine.clock),
    });
    driver::stage_files(&StageDriver {
        machine: &machine.name,
        top: &stage.block.top(),
        map: stage.block.component().map(),
        config: &stage.of_machine.config,
        tick_hz: machine.clock.sample_hz,
        axes: &axes.collect::<Vec<_>>(),
    })
}
