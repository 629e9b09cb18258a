//! A stage of a machine file at the other end: which one it is, its state, moves, traces and tap tables, on the model of the stage with its
//! machine.

use std::time::Duration;

use crate::faults::Line;
use posicast_blocks::axis::SupervisorState;
use posicast_blocks::component::Component;
use posicast_blocks::link::Bus;
use posicast_blocks::linked_stage::address_limit;
use posicast_blocks::registers::Access;
use posicast_closed_loop::linked_bench::LinkedBench;
use posicast_closed_loop::stage_bench::StageBench;
use posicast_host::{HostError, HostMove, HostedStage, Link, LinkOptions, Shake, TraceRequest};
use posicast_identify::log::{self, Log};
use posicast_identify::position;
use posicast_machine::hardware::{Hardware, StageHardware};
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plan::design_machine;
use posicast_machine::plant::axis::{AxisPlant, PlantOptions};
use posicast_taps::TapTable;

const OPTIONS: LinkOptions = LinkOptions {
    timeout: Duration::from_millis(20),
    attempts: 2,
};

/// The example with a line, and for X a scale at its load, a trace, and room for a test signal.
fn machine() -> Machine {
    let text = include_str!("../../examples/xy-stage.toml");
    let scale =
        "[axis.trace]\nsamples = 1024\n[axis.scale]\ncounts_per_unit = 10_000_000\nuse = \"monitor\"\n[axis.pwm]";
    let text = text.replacen("[axis.pwm]", scale, 1);
    let text = text.replacen(
        "[axis.limits]",
        "[axis.limits]\nexcitation = 100e-6\ndeviation = 500e-6\n",
        1,
    );
    machine_file::parse("xy-stage.toml", &format!("{text}[link]\nbaud = 3_000_000\n")).unwrap()
}

pub(crate) fn stage(machine: &Machine) -> StageHardware {
    let design = design_machine(machine).unwrap();
    Hardware::of(machine, &design)
        .unwrap()
        .stage()
        .unwrap()
        .unwrap()
        .clone()
}

/// The line of the stage with its machine.
fn line(machine: &Machine, stage: &StageHardware) -> LinkedBench {
    let plant = |axis| AxisPlant::new(axis, &machine.clock, &PlantOptions::default()).unwrap();
    let plants = machine.axes.iter().map(plant).collect();
    let bench = StageBench::new(&stage.of_machine.config, &stage.component, plants, None, 1).unwrap();
    let link = machine.link.unwrap();
    LinkedBench::new(bench, &link, &machine.clock, address_limit(&stage.component))
}

fn open<'m>(machine: &'m Machine, stage: &'m StageHardware) -> HostedStage<'m, LinkedBench> {
    HostedStage::open(Link::new(line(machine, stage), OPTIONS), machine, stage).unwrap()
}

#[test]
fn a_move_ends_on_its_target_and_the_axes_are_off() {
    let machine = machine();
    let stage = stage(&machine);
    let mut host = open(&machine, &stage);
    let before = host.status().unwrap();
    // After a reset the PWM has tripped.
    assert_eq!(before[0].state, Some(SupervisorState::Off));
    assert_eq!(posicast_host::causes(before[0].causes), ["pwm-tripped"]);
    host.switch_on(&[0, 1], false).unwrap();
    let of = |axis, distance| HostMove {
        axis,
        distance,
        speed: None,
    };
    host.move_axes(&[of(0, 0.002), of(1, -0.001)]).unwrap();
    let there = host.status().unwrap();
    assert_eq!(there[0].state, Some(SupervisorState::Hold));
    assert_eq!([there[0].command, there[1].command], [2000.0, -1000.0]);
    assert!(
        (there[0].position - 2000.0).abs() <= 2.0 && (there[1].position + 1000.0).abs() <= 2.0,
        "{there:?}"
    );
    let beyond = host.move_axes(&[of(0, 0.099)]).unwrap_err();
    assert!(
        matches!(
            beyond,
            HostError::Beyond {
                end: 101_000.0,
                plus: 100_000.0,
                ..
            }
        ),
        "{beyond}"
    );
    host.switch_off(&[0, 1]).unwrap();
    let off = host.status().unwrap();
    assert_eq!(off[0].state, Some(SupervisorState::Ready));
    let line = host.into_link().into_line();
    assert!((line.bench.plant(0).count() - 2000).abs() <= 2);
}

#[test]
fn a_host_that_dies_in_a_move_leaves_a_machine_that_stops() {
    let machine = machine();
    let stage = stage(&machine);
    let mut host = open(&machine, &stage);
    host.switch_on(&[0, 1], false).unwrap();
    let mut line = host.into_link().into_line();
    // watchdog_s is 0.5 s, and the brake has no time.
    line.idle(27_000_000).unwrap();
    assert!(!line.bench.pins(0).drive_enable && !line.bench.pins(1).drive_enable);
    let mut host = HostedStage::open(Link::new(line, OPTIONS), &machine, &stage).unwrap();
    let refused = host.switch_on(&[0], false).unwrap_err();
    assert!(
        matches!(&refused, HostError::Fault { causes, .. } if causes.contains("watchdog")),
        "{refused}"
    );
    host.switch_on(&[0, 1], true).unwrap();
}

/// The mode of the machine file is found through the line.
#[test]
fn a_trace_of_a_shaken_axis_gives_its_mode() {
    let machine = machine();
    let stage = stage(&machine);
    let mut host = open(&machine, &stage);
    host.switch_on(&[0], false).unwrap();
    let request = TraceRequest {
        axis: 0,
        signals: ["captured_position", "deviation"].map(str::to_owned).to_vec(),
        every_ticks: 2,
        shake: Some(Shake {
            amplitude_counts: 60.0,
            bit_ticks: 15,
        }),
    };
    let trace = host.trace(&request).unwrap();
    assert_eq!((trace.rows(), trace.row_s), (512, 200e-6));
    let Log::Position(log) = log::read(trace.csv().as_bytes()).unwrap().log else {
        panic!()
    };
    let found = position::identify(&log).unwrap();
    let (truth, found) = (machine.axes[0].modes[0].mode, found.modes[0].mode);
    assert!(
        (found.frequency_hz / truth.frequency_hz - 1.0).abs() < 0.01,
        "{found:?}"
    );
    assert!((found.damping / truth.damping - 1.0).abs() < 0.15, "{found:?}");
    let mut vcd = Vec::new();
    trace.vcd(&mut vcd).unwrap();
    let vcd = String::from_utf8(vcd).unwrap();
    assert!(
        vcd.contains("$var real 64 ! captured_position $end") && vcd.contains("#102200000"),
        "{}",
        &vcd[..300]
    );
    let three = TraceRequest {
        signals: vec!["error".to_owned(); 3],
        ..request.clone()
    };
    assert!(
        host.trace(&three)
            .unwrap_err()
            .to_string()
            .contains("one, two or four of command_position")
    );
}

#[test]
fn a_table_is_loaded_read_back_and_used() {
    let machine = machine();
    let stage = stage(&machine);
    let mut host = open(&machine, &stage);
    let table = TapTable::bypass(16).unwrap();
    assert_eq!(host.load_table(0, &table).unwrap(), 1);
    assert_eq!(host.load_table(0, &table).unwrap(), 2);
    assert_eq!(host.status().unwrap()[0].table_bank, 2);
    let other = TapTable::bypass(14).unwrap();
    let refused = host.load_table(0, &other).unwrap_err().to_string();
    assert!(refused.contains("`coefficient_fraction = 16`"), "{refused}");
    let mut line = host.into_link().into_line();
    assert_eq!(line.bench.net("x_table_bank").unwrap(), 2);
    assert_eq!(line.bench.read("y_status").unwrap() >> 17 & 3, 0);
}

/// The clocks of `docs/hosts.md`, within 2 %.
#[test]
fn calls_take_the_clocks_of_the_page() {
    let machine = machine();
    let stage = stage(&machine);
    let clocks = |calls: fn(&mut HostedStage<'_, LinkedBench>)| {
        let mut host = open(&machine, &stage);
        calls(&mut host);
        host.into_link().into_line().bench.now()
    };
    let opened = clocks(|_| {});
    let status = clocks(|host| drop(host.status().unwrap())) - opened;
    let kick = clocks(|host| host.kick().unwrap()) - opened;
    let found = [opened, status, kick];
    let expected = [12_900, 23_000, 5_250];
    let near = |(found, expected): (&u64, &u64)| found.abs_diff(*expected) <= expected / 50;
    assert!(found.iter().zip(&expected).all(near), "{found:?}");
}

/// Hardware that has nothing but the constants at the beginning of its registers.
pub(crate) struct Constants(pub(crate) Vec<u32>);

impl Constants {
    /// The constants of this hardware.
    pub(crate) fn of(component: &Component) -> Vec<u32> {
        let registers = component.map().registers().iter();
        let constants = registers.take_while(|own| own.access == Access::Constant);
        constants.map(|register| register.reset()).collect()
    }
}

impl Bus for Constants {
    fn read(&mut self, address: u16) -> u32 {
        self.0.get(usize::from(address)).copied().unwrap_or(0)
    }

    fn write(&mut self, address: u16, word: u32) {
        panic!("{word:#x} was written to {address:#x} of another machine");
    }
}

#[test]
fn another_stage_is_refused_with_what_was_found_and_expected() {
    let machine = machine();
    let stage = stage(&machine);
    let constants = Constants::of(&stage.component);
    let opened = |place: usize, word: u32| {
        let mut words = constants.clone();
        words[place] = word;
        let line = Line::new(Constants(words), 768, 0);
        HostedStage::open(Link::new(line, OPTIONS), &machine, &stage).map(drop)
    };
    assert!(opened(0, constants[0]).is_ok());
    assert!(opened(1, constants[1] + 1).is_ok(), "a larger minor version");
    let crc = constants[6];
    for (place, word, expected) in [
        (
            0,
            0,
            "word 0 reads 0x00000000, but a stage has 0x45475453 (STGE)".to_owned(),
        ),
        (
            1,
            0x1_0005,
            "the hardware has version 1.5 of the registers, and this posicast needs 2.2".to_owned(),
        ),
        (1, 0x2_0001, "the hardware has version 2.1 of the registers".to_owned()),
        (
            2,
            3,
            "AXES of the hardware is 3, but the machine file gives 2".to_owned(),
        ),
        (
            6,
            0xabcd,
            format!("a machine file with the checksum 0000abcd, and this one has {crc:08x}"),
        ),
    ] {
        let refused = opened(place, word).unwrap_err().to_string();
        assert!(refused.contains(&expected), "{refused}");
    }
}
