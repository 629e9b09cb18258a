//! A stage with its simulated machine behind a line, for the checks in which a host acts.

use posicast_blocks::linked_stage::address_limit;
use posicast_closed_loop::linked_bench::{LinkedBench, Registered};
use posicast_closed_loop::stage_bench::StageBench;
use posicast_closed_loop::stage_run::StageRunError;
use posicast_machine::hardware::StageHardware;
use posicast_machine::machine_file::{LinkLine, LinkSection, Machine};
use posicast_machine::plant::axis::{AxisPlant, PlantOptions};

/// The line between host and stage, where the machine file has none.
const LINE: LinkSection = LinkSection {
    line: LinkLine::Uart { baud: 3_000_000 },
    timeout_s: 0.01,
    machine_crc: 0,
};

/// The stage on a machine whose axes have these options, behind its line.
pub(super) fn behind_a_line(
    machine: &Machine,
    stage: &StageHardware,
    options: impl Fn(usize) -> PlantOptions,
    seed: u64,
) -> Result<LinkedBench, StageRunError> {
    Ok(linked(on_machine(machine, stage, options, seed)?, machine, stage))
}

/// The stage on a machine whose axes have these options.
pub(super) fn on_machine(
    machine: &Machine,
    stage: &StageHardware,
    options: impl Fn(usize) -> PlantOptions,
    seed: u64,
) -> Result<StageBench, StageRunError> {
    let axes = machine.axes.iter().enumerate();
    let plants = axes.map(|(index, axis)| AxisPlant::new(axis, &machine.clock, &options(index)));
    let plants = plants.collect::<Result<Vec<_>, _>>()?;
    Ok(StageBench::new(
        &stage.of_machine.config,
        &stage.component,
        plants,
        None,
        seed,
    )?)
}

/// This bench behind the machine's line.
pub(super) fn linked<B: Registered>(bench: B, machine: &Machine, stage: &StageHardware) -> LinkedBench<B> {
    let link = machine.link.unwrap_or(LINE);
    LinkedBench::new(bench, &link, &machine.clock, address_limit(&stage.component))
}
