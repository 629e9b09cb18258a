//! The example machine, and a stage with its simulated machine, for the tests of this crate.

use posicast_blocks::component::Component;
use posicast_closed_loop::stage_bench::StageBench;
use posicast_machine::hardware::{self, MachineStage};
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::motion::{TickLimits, plan_move};
use posicast_machine::plan::design_machine;
use posicast_machine::plant::axis::{AxisPlant, PlantOptions};
use posicast_testbench::blocks::Sources;
use posicast_testbench::component::ComponentBlock;
use posicast_testbench::lockstep::Device;

/// The file of the example machine; tests add to it.
pub(crate) const XY: &str = include_str!("../../../examples/xy-stage.toml");

/// Reads the example machine, or a changed text of it.
#[track_caller]
pub(crate) fn machine(text: &str) -> Machine {
    machine_file::parse("xy-stage.toml", text).unwrap_or_else(|error| panic!("{error:?}"))
}

/// The stage of a machine that has one.
#[track_caller]
pub(crate) fn stage(machine: &Machine) -> MachineStage {
    let design = design_machine(machine).unwrap();
    hardware::stage(machine, &design).unwrap().unwrap()
}

/// The stage's Verilog in Verilator; its lint has no warnings.
#[track_caller]
pub(crate) fn verilated(stage: &MachineStage) -> Box<dyn Device> {
    let component = Component::stage(&stage.config).unwrap();
    let block = ComponentBlock::new(component, "xy_stage", "xy");
    let sources = Sources::write(&block).unwrap();
    assert_eq!(sources.lint(&block).unwrap(), [""; 0]);
    Box::new(sources.verilated(&block, 1).unwrap())
}

/// A stage at reset with its simulated machine, and the RTL beside it if `device` has one.
#[track_caller]
pub(crate) fn bench(
    machine: &Machine,
    stage: &MachineStage,
    options: &PlantOptions,
    device: Option<Box<dyn Device>>,
    seed: u64,
) -> StageBench {
    let component = Component::stage(&stage.config).unwrap();
    let plant = |axis| AxisPlant::new(axis, &machine.clock, options).unwrap();
    let plants = machine.axes.iter().map(plant).collect();
    StageBench::new(&stage.config, &component, plants, device, seed).unwrap()
}

/// Queues a move of one axis by this many counts, from where its command is.
#[track_caller]
pub(crate) fn queue_move(bench: &mut StageBench, machine: &Machine, axis: usize, counts: i32) {
    let of_axis = &machine.axes[axis];
    let at = bench.read(&format!("{}_command_position", of_axis.name)).unwrap() as i32;
    let limits = TickLimits::of_axis(of_axis, &machine.clock);
    for entry in plan_move(i64::from(at) << 24, at + (counts << 8), &limits).unwrap() {
        bench.segment(&of_axis.name, &entry).unwrap();
    }
}
