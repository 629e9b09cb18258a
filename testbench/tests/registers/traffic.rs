//! Adds arbitrary traffic on the bus, legal or not, to the stimuli of a bench: model and RTL must stay equal, every
//! read must return what the register map promises, and the pins must stay safe.
//!
//! Proptest makes the traffic and shortens it after a failure. `PROPTEST_CASES` sets the number of cases.

use posicast_blocks::Direction;
use posicast_blocks::component::Component;
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::pwm::{ActiveLow, BridgeMode, PwmConfig};
use posicast_blocks::registers::RegisterMap;
use posicast_machine::hardware;
use posicast_machine::machine_file;
use posicast_machine::plan::design_machine;
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::component::ComponentBlock;
use posicast_testbench::lockstep::{self, Clock, Instance, LockstepOptions};
use posicast_testbench::registers::ReadPromises;
use posicast_testbench::stage::StageBlock;
use posicast_testbench::stimuli::Stimuli;
use posicast_testbench::verilator::Verilated;
use proptest::prelude::*;
use proptest::sample::Index;
use std::cell::RefCell;

use crate::registers::components;
use crate::registers::everything::everything;
use crate::registers::pins::Pins;

/// Positions of address, read, write, byte enable and data among the inputs of every component.
const BUS: [usize; 5] = [1, 2, 3, 4, 5];

/// Activity of the bus for some clocks.
#[derive(Debug, Clone)]
enum Access {
    /// The bench's own driver uses the bus.
    Driver(usize),
    /// The bus is idle.
    Idle(usize),
    /// The same access in this many consecutive clocks.
    Register {
        at: Index,
        read: bool,
        write: bool,
        data: u32,
        bytes: u8,
        clocks: usize,
    },
    /// Returns the same access at any address.
    Anywhere {
        address: u16,
        write: bool,
        data: u32,
        bytes: u8,
    },
    Reset,
}

fn word() -> impl Strategy<Value = u32> {
    prop_oneof![
        any::<u32>(),
        any::<u32>(),
        (0..32u32).prop_map(|bit| 1 << bit),
        (any::<u32>(), 0..32u32).prop_map(|(word, shift)| word >> shift),
        Just(0),
        Just(u32::MAX),
    ]
}

fn access() -> impl Strategy<Value = Access> {
    let bytes = || prop_oneof![3 => Just(0xf), 1 => 0..16u8];
    let clocks = prop_oneof![8 => Just(1usize), 1 => 2..200usize];
    let register = (any::<Index>(), any::<bool>(), any::<bool>(), word(), bytes(), clocks);
    prop_oneof![
        4 => (1..400usize).prop_map(Access::Driver),
        4 => (0..40usize).prop_map(Access::Idle),
        24 => register.prop_map(|(at, read, write, data, bytes, clocks)| Access::Register { at, read, write, data, bytes, clocks }),
        4 => (any::<u16>(), any::<bool>(), word(), bytes()).prop_map(|(address, write, data, bytes)| Access::Anywhere { address, write, data, bytes }),
        1 => prop::bool::weighted(0.1).prop_map(|resets| if resets { Access::Reset } else { Access::Idle(1) }),
    ]
}

/// Traffic that replaces the bench's own inputs of the bus.
struct Traffic<'a> {
    base: Box<dyn Stimuli + 'a>,
    map: &'a RegisterMap,
    accesses: std::slice::Iter<'a, Access>,
    now: Option<&'a Access>,
    left: usize,
}

impl Stimuli for Traffic<'_> {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        self.base.fill(seen, inputs);
        while self.left == 0 {
            self.now = self.accesses.next();
            self.left = match self.now {
                Some(Access::Driver(clocks) | Access::Idle(clocks) | Access::Register { clocks, .. }) => *clocks,
                Some(_) => 1,
                None => usize::MAX,
            };
        }
        self.left -= 1;
        let bus = match self.now {
            None | Some(Access::Driver(_)) => return,
            Some(Access::Idle(_)) => [inputs[BUS[0]], 0, 0, 0, 0],
            Some(Access::Reset) => {
                inputs[0] = 1;
                return;
            }
            Some(Access::Register {
                at,
                read,
                write,
                data,
                bytes,
                ..
            }) => {
                let registers = self.map.registers();
                let register = &registers[at.index(registers.len())];
                let word = u32::from(*bytes) % register.words();
                let read = *read || !*write;
                [
                    (register.offset + word).into(),
                    read.into(),
                    (*write).into(),
                    (*bytes).into(),
                    (*data).into(),
                ]
            }
            Some(Access::Anywhere {
                address,
                write,
                data,
                bytes,
            }) => [
                (*address).into(),
                (!*write).into(),
                (*write).into(),
                (*bytes).into(),
                (*data).into(),
            ],
        };
        for (place, value) in BUS.into_iter().zip(bus) {
            inputs[place] = value;
        }
    }
}

/// A block whose Verilog is built once.
struct Bed {
    block: Box<dyn Block>,
    map: RegisterMap,
    sources: Sources,
    dead_time: u64,
}

/// Counts of a run: clocks with a gate on, and reads.
#[derive(Debug, Default)]
struct Reached {
    on: u64,
    reads: u64,
}

impl Bed {
    fn new(block: Box<dyn Block>, map: &RegisterMap, dead_time: u64) -> Self {
        Self {
            sources: Sources::write(block.as_ref()).unwrap(),
            map: map.clone(),
            block,
            dead_time,
        }
    }

    fn device(&self, seed: u64) -> Verilated {
        self.sources.verilated(self.block.as_ref(), seed).unwrap()
    }

    fn run(&self, accesses: &[Access], seed: u64, cycles: u64, reached: &mut Reached) -> Result<(), TestCaseError> {
        let mut model = self.block.model(seed);
        let ports = model.ports().to_vec();
        let read_data = ports.iter().filter(|port| port.direction == Direction::Output);
        let read_data = read_data
            .map(|port| port.name.as_str())
            .position(|name| name == "avs_readdata")
            .unwrap();
        let mut pins = Pins::of(&ports, self.dead_time);
        let mut promises = ReadPromises::new(&self.map);
        let mut traffic = Traffic {
            base: self.block.stimuli(cycles, seed),
            map: &self.map,
            accesses: accesses.iter(),
            now: None,
            left: 0,
        };
        let mut watch = |clock: &Clock<'_>| {
            promises.observe(clock.inputs, clock.actual[read_data]);
            pins.iter_mut().for_each(|pins| pins.observe(clock));
            reached.on += u64::from(pins.iter().any(|pins| pins.is_on(clock)));
        };
        let instances = [Instance::whole(self.block.name(), "traffic", &ports)];
        let options = LockstepOptions::cycles(cycles);
        let report = lockstep::run(
            model.as_mut(),
            &mut self.device(seed),
            &mut traffic,
            &instances,
            &options,
            &mut watch,
            &mut |_| {},
        );
        let report = report.unwrap();
        if let Some(first) = &report.blocks[0].first {
            return Err(TestCaseError::fail(format!("{} {first}", self.block.name())));
        }
        prop_assert_eq!(promises.violation(), None);
        for pins in &pins {
            prop_assert_eq!(pins.violation(), None, "{}", self.block.name());
        }
        reached.reads += promises.reads();
        Ok(())
    }
}

fn config(ordinary: u32) -> ProptestConfig {
    let wanted = std::env::var("PROPTEST_CASES")
        .ok()
        .and_then(|cases| cases.parse().ok());
    ProptestConfig {
        cases: wanted.unwrap_or(ordinary),
        failure_persistence: None,
        max_shrink_iters: 300,
        ..ProptestConfig::default()
    }
}

/// Runs the cases and returns what they reached.
#[track_caller]
fn holds(bed: &Bed, cases: u32, cycles: u64) -> Reached {
    let reached = RefCell::new(Reached::default());
    let mut runner = proptest::test_runner::TestRunner::new(config(cases));
    let result = runner.run(
        &(prop::collection::vec(access(), 1..150), any::<u64>()),
        |(accesses, seed)| bed.run(&accesses, seed, cycles, &mut reached.borrow_mut()),
    );
    if let Err(error) = result {
        panic!("{error}");
    }
    reached.into_inner()
}

fn component(component: Component, dead_time: u64) -> Bed {
    let map = component.map().clone();
    Bed::new(
        Box::new(ComponentBlock::new(component, "alone", "alone")),
        &map,
        dead_time,
    )
}

#[test]
fn prop_traffic_on_the_components_breaks_nothing() {
    for bed in [
        component(components::pulse_counter(), 0),
        component(components::shaper(32, Some(3)), 0),
        component(components::sliding_mode(), 0),
    ] {
        let reached = holds(&bed, 16, 6_000);
        assert!(reached.reads > 10_000, "{}: {reached:?}", bed.block.name());
    }
}

/// Mode 0 is left out: its `b_high` is a direction and not a side of a leg, and the mode of a stage is fixed. The proofs
/// of `pwm` cover the modes of the PWM's component.
#[test]
fn prop_traffic_on_the_pwm_leaves_the_pins_safe() {
    let config = PwmConfig::new(ActiveLow::default(), 4, 3).unwrap();
    let bed = component(Component::pwm(config, BridgeMode::HalfBridge, 60).unwrap(), 4);
    let reached = holds(&bed, 16, 8_000);
    assert!(reached.on > 100 && reached.reads > 10_000, "{reached:?}");
}

/// The example's stage with short ticks, periods and delays, so that it moves within a case.
fn stage() -> Bed {
    const PERIOD_CLOCKS: u32 = 80;
    let text = include_str!("../../../examples/xy-stage.toml");
    let machine = machine_file::parse("xy-stage.toml", text).unwrap();
    let designed = hardware::stage(&machine, &design_machine(&machine).unwrap()).unwrap();
    let mut config = designed.unwrap().config;
    for axis in &mut config.axes {
        axis.closed_loop_mut().unwrap().pwm = PwmConfig::new(ActiveLow::default(), 2, 3).unwrap();
        axis.closed_loop_mut().unwrap().pwm_period_clocks = PERIOD_CLOCKS;
        axis.closed_loop_mut().unwrap().encoder_filter_clocks = 2;
        (axis.supervision.brake_release_ticks, axis.supervision.filter_clocks) = (1, 3);
    }
    let periods = config.timing().duty_clocks() / PERIOD_CLOCKS + 1;
    config.tick = DividerConfig::new(u64::from(periods * PERIOD_CLOCKS)).unwrap();
    let block = StageBlock::new(&config, "short_stage").unwrap();
    let map = block.component().map().clone();
    Bed::new(Box::new(block), &map, 2)
}

#[test]
fn prop_traffic_on_the_stage_leaves_the_pins_safe() {
    let reached = holds(&stage(), 8, 25_000);
    assert!(reached.on > 100 && reached.reads > 10_000, "{reached:?}");
}

/// The traffic detects a bank that ignores a byte enable, and a PWM and a stage whose pins are not safe.
#[test]
fn prop_traffic_finds_what_is_broken() {
    let broken = |bed: Bed, from: &str, to: &str| {
        let modules = crate::support::broken(&bed.block.modules().unwrap(), from, to);
        let bed = Bed {
            sources: Sources::of_modules(&modules).unwrap(),
            ..bed
        };
        let without_shrinking = ProptestConfig {
            max_shrink_iters: 0,
            ..config(64)
        };
        let mut runner = proptest::test_runner::TestRunner::new(without_shrinking);
        let reached = RefCell::new(Reached::default());
        let found = runner.run(
            &(prop::collection::vec(access(), 1..150), any::<u64>()),
            |(accesses, seed)| bed.run(&accesses, seed, 6_000, &mut reached.borrow_mut()),
        );
        assert!(found.is_err(), "`{to}` is not found");
    };
    broken(component(components::sliding_mode(), 0), "written[0]", "1'd1");
    let config = PwmConfig::new(ActiveLow::default(), 4, 3).unwrap();
    let pwm = component(Component::pwm(config, BridgeMode::HalfBridge, 60).unwrap(), 4);
    broken(pwm, "lasts = dead_time;", "lasts = 10'd1;");
}

/// The check of reads alone, without a model, detects a word of another register, a bit outside all fields, and a word
/// that changes.
#[test]
fn reads_that_break_a_promise_are_noticed() {
    let map = everything();
    let mode = map.register("mode").unwrap();
    let write = |data: u32, bytes: u64| [0, mode.offset.into(), 0, 1, bytes, data.into()];
    let read = |offset: u32| [0, offset.into(), 1, 0, 0, 0];
    let idle = [0; 6];
    let seen = |rows: &[([u64; 6], u32)]| {
        let mut promises = ReadPromises::new(&map);
        rows.iter()
            .for_each(|(inputs, data)| promises.observe(inputs, (*data).into()));
        promises.violation().map(str::to_owned)
    };
    let word = mode.reset() & !0xff | 0x62;
    assert_eq!(
        seen(&[
            (write(0xffff_ff62, 1), 0),
            (read(mode.offset), 0),
            (idle, word),
            (idle, word)
        ]),
        None
    );
    let wrong = |rows: &[([u64; 6], u32)], words: &str| {
        let said = seen(rows).unwrap_or_default();
        assert!(said.contains(words), "{said}");
    };
    wrong(
        &[(write(0xffff_ff62, 1), 0), (read(mode.offset), 0), (idle, mode.reset())],
        "is promised",
    );
    wrong(&[(read(0x77), 0), (idle, 1)], "is promised");
    wrong(
        &[(read(map.register("start").unwrap().offset), 0), (idle, 1)],
        "is promised",
    );
    wrong(
        &[(read(map.register("status").unwrap().offset), 0), (idle, 1)],
        "no field",
    );
    wrong(
        &[(read(map.register("dead_time").unwrap().offset), 0), (idle, 24)],
        "at least 25",
    );
    wrong(&[(idle, 0), (idle, 1)], "no read changed it");
}
