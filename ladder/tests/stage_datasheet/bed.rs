//! The emitted Verilog of a stage, its pins by name, its registers by the words of `docs/register-tables.md`. No model of the stage.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use std::collections::HashMap;

use posicast_blocks::component::Component;
use posicast_blocks::{ClockedBlock, Direction, Port};
use posicast_hdl::component::emit;
use posicast_hdl::emit::Module;
use posicast_machine::plan::design_machine;
use posicast_machine::{hardware, machine_file};
use posicast_testbench::blocks::Sources;
use posicast_testbench::verilator::{Verilated, VerilogSource};

/// `[clock]` of the example: 50 MHz, 10 kHz.
pub(super) const TICK: u64 = 5000;

// Words of window 0.
pub(super) const SNAPSHOT: u32 = 0x08;
pub(super) const COMMIT: u32 = 0x09;
pub(super) const START: u32 = 0x0a;
pub(super) const FLAGS: u32 = 0x0b;
pub(super) const INTERRUPT_STATE: u32 = 0x0c;
pub(super) const INTERRUPT_ENABLE: u32 = 0x0d;
pub(super) const FEED_HOLD: u32 = 0x0f;
pub(super) const TIME_STAMP: u32 = 0x20;
pub(super) const TICK_COUNT: u32 = 0x21;
pub(super) const SNAPSHOT_TIME_STAMP: u32 = 0x40;
pub(super) const SNAPSHOT_TICK_COUNT: u32 = 0x41;

// Words of an axis's window, which begins at 0x100 for the first axis.
pub(super) const CONTROL: u32 = 0x08;
pub(super) const STOP: u32 = 0x09;
pub(super) const CLEAR_FAULTS: u32 = 0x0a;
pub(super) const DIRECT: u32 = 0x0d;
pub(super) const FIFO_CONTROL: u32 = 0x0e;
pub(super) const SEGMENT: u32 = 0x10;
pub(super) const LAW: u32 = 0x19;
pub(super) const SOFT_LIMIT_PLUS: u32 = 0x1a;
pub(super) const SOFT_LIMIT_MINUS: u32 = 0x1b;
pub(super) const FOLLOWING_ERROR_LIMIT: u32 = 0x1c;
pub(super) const WATCHDOG: u32 = 0x1d;
pub(super) const STOP_DECELERATION: u32 = 0x1e;
pub(super) const SETTLE: u32 = 0x1f;
pub(super) const INDEX: u32 = 0x20;
pub(super) const INDEX_ARM: u32 = 0x21;
pub(super) const PRESET: u32 = 0x22;
pub(super) const PWM_TRIGGER: u32 = 0x25;
pub(super) const STATUS: u32 = 0x28;
pub(super) const CAUSES: u32 = 0x29;
pub(super) const POSITION: u32 = 0x30;
pub(super) const COUNT: u32 = 0x31;
pub(super) const VELOCITY: u32 = 0x32;
pub(super) const ORIGIN: u32 = 0x33;
pub(super) const INDEX_COUNT: u32 = 0x34;
pub(super) const COMMAND_POSITION: u32 = 0x35;
pub(super) const SHAPED_POSITION: u32 = 0x36;
pub(super) const ERROR: u32 = 0x38;
pub(super) const SNAPSHOT_POSITION: u32 = 0x40;

// States of `STATUS.state`.
pub(super) const READY: u32 = 1;
pub(super) const HOLD: u32 = 2;
pub(super) const RUN: u32 = 3;
pub(super) const QUICK_STOP: u32 = 4;
pub(super) const FAULT: u32 = 5;

/// The two axes: their names in front of pins.
pub(super) const AXES: [&str; 2] = ["x", "y"];

/// The Verilog of the example's stage, without the monitors that a standing encoder trips.
pub(super) fn modules() -> Vec<Module> {
    let text = include_str!("../../../examples/xy-stage.toml");
    let kept = text
        .lines()
        .filter(|line| !line.starts_with("encoder_lost_s") && !line.starts_with("watchdog_s"));
    let text = kept.collect::<Vec<_>>().join("\n");
    let machine = machine_file::parse("xy-stage.toml", &text).unwrap();
    let stage = hardware::stage(&machine, &design_machine(&machine).unwrap());
    let component = Component::stage(&stage.unwrap().unwrap().config).unwrap();
    emit(&component, "xy_stage", "xy").unwrap()
}

/// The Verilog in Verilator, clock by clock.
pub(super) struct Bed {
    device: Verilated,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
    places: HashMap<String, usize>,
    /// Clocks since the end of the reset.
    pub(super) now: u64,
    /// Steps of each axis's encoder.
    steps: [i64; 2],
}

impl Bed {
    /// After a reset, with healthy lines.
    pub(super) fn new(modules: &[Module]) -> Self {
        let sources = Sources::of_modules(modules).unwrap();
        let top = modules.last().unwrap();
        let ports = top.ports.clone();
        let source = VerilogSource {
            files: sources.files(),
            top: &top.name,
            ports: &ports,
        };
        let of = |direction| ports.iter().filter(move |port: &&Port| port.direction == direction);
        let inputs = of(Direction::Input)
            .map(|port| port.name.as_str())
            .filter(|name| *name != "clk");
        let places = inputs
            .enumerate()
            .chain(of(Direction::Output).map(|port| port.name.as_str()).enumerate());
        let mut bed = Self {
            places: places.map(|(at, name)| (name.to_owned(), at)).collect(),
            inputs: vec![0; of(Direction::Input).filter(|port| port.name != "clk").count()],
            outputs: vec![0; of(Direction::Output).count()],
            device: Verilated::build(&source, 1).unwrap(),
            now: 0,
            steps: [0; 2],
        };
        for line in ["emergency_stop_n", "pll_locked"] {
            bed.set(line, 1);
        }
        for axis in AXES {
            for line in [
                "limit_plus_n",
                "limit_minus_n",
                "drive_ready",
                "drive_fault_n",
                "fault_n",
            ] {
                bed.set(&format!("{axis}_{line}"), 1);
            }
        }
        bed.set("rst", 1);
        bed.clocks(4);
        bed.set("rst", 0);
        bed.now = 0;
        bed
    }

    pub(super) fn set(&mut self, pin: &str, level: u64) {
        let at = self.places[pin];
        self.inputs[at] = level;
    }

    /// The level of a pin in the last clock.
    pub(super) fn pin(&self, pin: &str) -> u64 {
        self.outputs[self.places[pin]]
    }

    pub(super) fn clock(&mut self) {
        self.device.step(&self.inputs, &mut self.outputs).unwrap();
        self.now += 1;
    }

    pub(super) fn clocks(&mut self, clocks: u64) {
        (0..clocks).for_each(|_| self.clock());
    }

    /// As [`Self::clocks`] with levels that stay, a piece at a time: faster for millions of clocks.
    pub(super) fn idle(&mut self, clocks: u64) {
        const PIECE: usize = 4096;
        let inputs = self.inputs.repeat(PIECE);
        let mut outputs = vec![0; PIECE * self.outputs.len()];
        for _ in 0..clocks / PIECE as u64 {
            self.device.run(&inputs, &mut outputs).unwrap();
            self.now += PIECE as u64;
        }
        self.clocks(clocks % PIECE as u64);
    }

    /// Runs up to and including the clock of the next tick.
    pub(super) fn next_tick(&mut self) {
        self.clock();
        while self.pin("tick") == 0 {
            self.clock();
        }
    }

    pub(super) fn ticks(&mut self, ticks: u64) {
        (0..ticks).for_each(|_| self.next_tick());
    }

    pub(super) fn write(&mut self, word: u32, data: u32) {
        for (pin, level) in [
            ("avs_address", word),
            ("avs_writedata", data),
            ("avs_byteenable", 0xf),
            ("avs_write", 1),
        ] {
            self.set(pin, level.into());
        }
        self.clock();
        self.set("avs_write", 0);
    }

    pub(super) fn read(&mut self, word: u32) -> u32 {
        self.set("avs_address", word.into());
        self.set("avs_read", 1);
        self.clock();
        self.set("avs_read", 0);
        self.clock();
        self.pin("avs_readdata") as u32
    }

    /// A word of an axis's window.
    pub(super) fn of(&mut self, axis: usize, word: u32) -> u32 {
        self.read(0x100 * (axis as u32 + 1) + word)
    }

    pub(super) fn write_of(&mut self, axis: usize, word: u32, data: u32) {
        self.write(0x100 * (axis as u32 + 1) + word, data);
    }

    pub(super) fn state(&mut self, axis: usize) -> u32 {
        self.of(axis, STATUS) & 7
    }

    pub(super) fn wait_for(&mut self, axis: usize, state: u32) {
        for _ in 0..400 {
            if self.state(axis) == state {
                return;
            }
            self.clocks(TICK / 4);
        }
        panic!(
            "{} does not come to state {state}: it is in {}",
            AXES[axis],
            self.state(axis)
        );
    }

    /// Moves the encoders of both axes by one step each, up, down or not, in the same clock.
    pub(super) fn step(&mut self, steps: [i64; 2]) {
        for (axis, step) in steps.into_iter().enumerate() {
            self.steps[axis] += step;
            let phase = self.steps[axis] & 3;
            self.set(&format!("{}_a", AXES[axis]), u64::from(phase == 1 || phase == 2));
            self.set(&format!("{}_b", AXES[axis]), u64::from(phase >= 2));
        }
        // The filter passes what lasts longer than 8 clocks.
        self.clocks(12);
    }

    /// Moves the encoder of one axis.
    pub(super) fn encoder(&mut self, axis: usize, counts: i64) {
        let mut steps = [0; 2];
        steps[axis] = counts.signum();
        (0..counts.abs()).for_each(|_| self.step(steps));
        self.clocks(20);
    }

    /// An entry: a point, Q24.8 counts, for so many ticks.
    pub(super) fn point(&mut self, axis: usize, position: i32, ticks: u32) {
        for (at, word) in [position as u32, 0, 0, 1 << 31 | ticks].into_iter().enumerate() {
            self.write_of(axis, SEGMENT + at as u32, word);
        }
    }

    /// An entry: a constant jerk, Q8.32.
    pub(super) fn jerk(&mut self, axis: usize, jerk: i64, ticks: u32) {
        for (at, word) in [jerk as u32, (jerk >> 32) as u32, 0, ticks].into_iter().enumerate() {
            self.write_of(axis, SEGMENT + at as u32, word);
        }
    }

    /// Moves at sixteen counts per tick for many ticks, after a tick of jerk and a tick of the opposite jerk.
    pub(super) fn long_move(&mut self, axis: usize, up: bool) {
        let jerk = if up { 16 << 32 } else { -(16 << 32) };
        self.jerk(axis, jerk, 1);
        self.jerk(axis, -jerk, 1);
        self.jerk(axis, 0, 100_000);
    }

    /// Brings both axes to HOLD. The monitors that a standing encoder would trip are off, and causes stop without switching off.
    pub(super) fn hold(&mut self) {
        self.clocks(1000);
        for axis in 0..2 {
            self.write_of(axis, CLEAR_FAULTS, 0);
            self.write_of(axis, WATCHDOG, 0);
            self.write_of(axis, FOLLOWING_ERROR_LIMIT, 0);
            self.write_of(axis, SETTLE, 2);
            // One count per tick².
            self.write_of(axis, STOP_DECELERATION, 1 << 24);
        }
        for axis in 0..2 {
            self.wait_for(axis, READY);
            self.write_of(axis, CONTROL, 1);
        }
        for axis in 0..2 {
            self.wait_for(axis, HOLD);
        }
        self.ticks(2);
        self.write(INTERRUPT_STATE, u32::MAX);
    }
}
