//! The stage of the example machine: its Verilog against its model, and what a host does with it.
#![allow(clippy::unwrap_used)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use posicast_model::control::{self, MachineStage};
use posicast_model::design::design_machine;
use posicast_model::motion::{TickLimits, plan_move};
use posicast_model::plant::axis::{AxisPlant, PlantOptions};
use posicast_model::rtl::component::Component;
use posicast_model::spec::{self, Machine};
use posicast_testbench::blocks::{ComponentBlock, Sources};
use posicast_testbench::lockstep::Device;
use posicast_testbench::stage_bench::{StageBench, state};

fn machine() -> Machine {
    let text = include_str!("../../examples/xy-stage.toml");
    spec::parse("xy-stage.toml", text).unwrap()
}

fn stage(machine: &Machine) -> MachineStage {
    control::stage(machine, &design_machine(machine).unwrap())
        .unwrap()
        .unwrap()
}

fn bench(machine: &Machine, with_rtl: bool) -> StageBench {
    let stage = stage(machine);
    let component = Component::stage(&stage.config).unwrap();
    let device = with_rtl.then(|| {
        let block = ComponentBlock::new(component.clone(), "xy_stage", "xy");
        let sources = Sources::write(&block).unwrap();
        assert_eq!(sources.lint(&block).unwrap(), [""; 0]);
        Box::new(sources.verilated(&block, 1).unwrap()) as Box<dyn Device>
    });
    let plant = |axis| AxisPlant::new(axis, &machine.clock, &PlantOptions::default()).unwrap();
    let plants = machine.axes.iter().map(plant).collect();
    StageBench::new(&stage.config, &component, plants, device, 1).unwrap()
}

/// Switches on, moves both axes by so many counts, and says how long that took.
fn move_both(machine: &Machine, bench: &mut StageBench, counts: i64) -> u64 {
    assert!(bench.switch_on(20_000_000).unwrap());
    bench.record();
    let start = bench.now();
    for (axis, spec) in ["x", "y"].into_iter().zip(&machine.axes) {
        let at = i64::from(bench.read(&format!("{axis}_command_position")).unwrap() as i32) << 24;
        let limits = TickLimits::of_axis(spec, &machine.clock);
        let end = ((at >> 24) + 256 * counts) as i32;
        for entry in plan_move(at, end, &limits).unwrap() {
            bench.segment(axis, &entry).unwrap();
        }
    }
    bench.write("start", 3).unwrap();
    bench.clocks(20_000).unwrap();
    for axis in ["x", "y"] {
        assert_eq!(bench.field(axis, "status", "state").unwrap(), state::RUN);
    }
    for axis in ["x", "y"] {
        assert!(bench.wait(axis, state::HOLD, 20_000_000).unwrap());
    }
    bench.clocks(500_000).unwrap();
    bench.now() - start
}

#[test]
fn unit_a_few_segments_and_one_bit_move_the_stage() {
    let machine = machine();
    let mut bench = bench(&machine, false);
    move_both(&machine, &mut bench, 5000);
    for axis in 0..2 {
        let at = bench.plant(axis).count();
        assert!((at - 5000).abs() <= 2, "{at}");
    }
}

#[test]
fn lockstep_a_move_from_reset_to_standstill() {
    let machine = machine();
    let mut bench = bench(&machine, true);
    move_both(&machine, &mut bench, 200);
    assert_eq!(bench.mismatches(), (0, None));
}
