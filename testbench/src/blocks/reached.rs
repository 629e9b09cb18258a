//! What the clocks of a row reached, and how much of it a verdict needs.
//!
//! | counted | bar |
//! |---|---|
//! | samples: clocks with `valid` of a shaper, in a stage of each axis | 1 |
//! | moves: times that an axis was in RUN and its command moved | 1 per axis, where the brake opens soon enough |
//! | taps: words other than 0 written to a table | 1 in a stage with short ticks and in its shapers |
//! | registers written, read: those at whose offset a word other than 0 was written or read | see [`REGISTERS_PER_CENT`] |
//! | words: changes of the outputs of more than one bit | 1, where there is such an output |
//!
//! A row below its bar has not exercised its block, even if every compared value was equal.

use std::collections::HashSet;

use posicast_blocks::registers::{Access, RegisterMap};
use posicast_blocks::{Direction, Port};
use schemars::JsonSchema;
use serde::Serialize;

use crate::lockstep::Clock;

/// Per cent of the registers that can be written, and of those that can be read, that a row of a component or a stage must
/// have seen with a word other than 0.
pub(crate) const REGISTERS_PER_CENT: u64 = 50;

/// RUN, of an axis's `state`.
const RUN: u64 = 3;

/// A count and its bar.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ReachedCount {
    /// What is counted.
    pub what: String,
    /// How many there were.
    pub count: u64,
    /// How many there must be; 0 for none.
    pub least: u64,
}

impl ReachedCount {
    fn new(what: impl Into<String>, count: u64, least: u64) -> Self {
        Self {
            what: what.into(),
            count,
            least,
        }
    }

    /// Whether it is below its bar.
    pub fn is_low(&self) -> bool {
        self.count < self.least
    }
}

/// Counts what a run reaches.
pub trait Reach {
    /// Adds a clock.
    fn observe(&mut self, clock: &Clock<'_>);

    /// Returns the counts, each with the instance of its row.
    fn reached(&self) -> Vec<(String, ReachedCount)>;
}

fn place(ports: &[Port], direction: Direction, name: &str) -> Option<usize> {
    let mut ports = ports.iter().filter(|port| port.direction == direction);
    ports.position(|port| port.name == name)
}

/// Counts at the ports of a block. The ports of several blocks side by side begin with the block's name.
#[derive(Debug, Clone)]
pub(crate) struct AtThePorts {
    instance: String,
    valid: Option<usize>,
    /// `tap_write` and `tap_coefficient`.
    taps: Option<[usize; 2]>,
    bus: Option<Bus>,
    words: Vec<(usize, u64)>,
    samples: u64,
    tap_writes: u64,
    changes: u64,
}

/// The bus of a component at its ports.
#[derive(Debug, Clone)]
struct Bus {
    /// Reset, address, read, write, byte enables, data.
    inputs: [usize; 6],
    read_data: usize,
    /// Address of a read in the clock before.
    asked: Option<u64>,
    written: HashSet<u64>,
    read: HashSet<u64>,
    bars: [u64; 2],
}

impl AtThePorts {
    /// Counts of the row `instance`, whose ports begin with `prefix`; a row of a component has a `map`.
    pub(crate) fn new(instance: &str, prefix: &str, ports: &[Port], map: Option<&RegisterMap>) -> Self {
        let input = |name: &str| place(ports, Direction::Input, &format!("{prefix}{name}"));
        let output = |name: &str| place(ports, Direction::Output, &format!("{prefix}{name}"));
        let outputs = ports.iter().filter(|port| port.direction == Direction::Output);
        let own = outputs
            .enumerate()
            .filter(|(_, port)| port.width > 1 && port.name.starts_with(prefix));
        let bus = map.and_then(|map| {
            let bus = [
                "rst",
                "avs_address",
                "avs_read",
                "avs_write",
                "avs_byteenable",
                "avs_writedata",
            ]
            .map(input);
            let [
                Some(reset),
                Some(address),
                Some(read),
                Some(write),
                Some(bytes),
                Some(data),
            ] = bus
            else {
                return None;
            };
            Some(Bus {
                inputs: [reset, address, read, write, bytes, data],
                read_data: output("avs_readdata")?,
                asked: None,
                written: HashSet::new(),
                read: HashSet::new(),
                bars: bars(map),
            })
        });
        Self {
            instance: instance.to_owned(),
            valid: output("valid"),
            taps: input("tap_write")
                .zip(input("tap_coefficient"))
                .map(|(write, word)| [write, word]),
            bus,
            words: own.map(|(at, _)| (at, 0)).collect(),
            samples: 0,
            tap_writes: 0,
            changes: 0,
        }
    }
}

impl Reach for AtThePorts {
    fn observe(&mut self, clock: &Clock<'_>) {
        let (inputs, outputs) = (clock.inputs, clock.expected);
        self.samples += self.valid.map_or(0, |at| outputs[at]);
        if let Some([write, word]) = self.taps {
            self.tap_writes += inputs[write] & u64::from(inputs[word] != 0);
        }
        for (at, before) in &mut self.words {
            self.changes += u64::from(outputs[*at] != *before);
            *before = outputs[*at];
        }
        if let Some(bus) = &mut self.bus {
            let [reset, address, read, write, bytes, data] = bus.inputs.map(|at| inputs[at]);
            if let Some(asked) = bus.asked.filter(|_| outputs[bus.read_data] != 0) {
                bus.read.insert(asked);
            }
            bus.asked = (read != 0 && reset == 0).then_some(address);
            if write != 0 && bytes != 0 && data != 0 {
                bus.written.insert(address);
            }
        }
    }

    fn reached(&self) -> Vec<(String, ReachedCount)> {
        let mut counts = Vec::new();
        if self.valid.is_some() {
            counts.push(ReachedCount::new("samples", self.samples, 1));
        }
        if self.taps.is_some() {
            counts.push(ReachedCount::new("taps", self.tap_writes, 1));
        }
        if let Some(bus) = &self.bus {
            let [written, read] = bus.bars;
            counts.push(ReachedCount::new(
                "registers written",
                bus.written.len() as u64,
                written,
            ));
            counts.push(ReachedCount::new("registers read", bus.read.len() as u64, read));
        }
        if !self.words.is_empty() {
            counts.push(ReachedCount::new("words", self.changes, 1));
        }
        counts.into_iter().map(|count| (self.instance.clone(), count)).collect()
    }
}

/// The bars for registers that can be written, and for those that can be read as another word than 0.
fn bars(map: &RegisterMap) -> [u64; 2] {
    let count = |of: fn(&Access) -> bool| {
        let registers = map.registers().iter().filter(|register| of(&register.access));
        registers.count() as u64 * REGISTERS_PER_CENT / 100
    };
    let is_written = |access: &Access| !matches!(access, Access::Constant | Access::Live | Access::Shadow { .. });
    let is_read = |access: &Access| {
        !matches!(
            access,
            Access::Command { .. } | Access::Words { .. } | Access::Snapshot | Access::InterruptTest
        )
    };
    [count(is_written), count(is_read)]
}

/// An axis of a stage, at nets inside the model.
#[derive(Debug, Clone)]
struct InsideAxis {
    name: String,
    /// `state`, `command_position`, `shaper_valid`, `tap_write`, `tap_coefficient`.
    nets: Vec<usize>,
    position: u64,
    /// Whether the axis has moved since it entered RUN.
    moved: bool,
    samples: u64,
    moves: u64,
    taps: u64,
}

/// Counts at the nets inside the model of a stage, so it serves a stage on any bus.
#[derive(Debug, Clone)]
pub(crate) struct InsideAStage {
    instance: String,
    axes: Vec<InsideAxis>,
    /// `avs_address`, `avs_read`, `avs_write`, `avs_writedata`, `avs_readdata`, once found.
    bus: Vec<usize>,
    written: HashSet<u64>,
    read: HashSet<u64>,
    bars: [u64; 2],
    /// Least number of moves per axis, and of taps.
    least: [u64; 2],
}

const BUS: [&str; 5] = ["avs_address", "avs_read", "avs_write", "avs_writedata", "avs_readdata"];
const AXIS: [&str; 5] = [
    "state",
    "command_position",
    "shaper_valid",
    "tap_write",
    "tap_coefficient",
];

/// Those of an axis of an inline shaper, which moves while it follows its input.
const INLINE_AXIS: [&str; 5] = ["follow", "input_steps", "valid", "tap_write", "tap_coefficient"];

impl InsideAStage {
    /// Counts of the row `instance`, which needs so many moves of each axis, taps of each axis, and per cent of the registers.
    pub(crate) fn new(instance: &str, axes: &[String], map: &RegisterMap, [moves, taps, per_cent]: [u64; 3]) -> Self {
        let axis = |name: &String| InsideAxis {
            name: name.clone(),
            nets: Vec::new(),
            position: 0,
            moved: false,
            samples: 0,
            moves: 0,
            taps: 0,
        };
        Self {
            instance: instance.to_owned(),
            axes: axes.iter().map(axis).collect(),
            bus: Vec::new(),
            written: HashSet::new(),
            read: HashSet::new(),
            bars: bars(map).map(|bar| bar * per_cent / REGISTERS_PER_CENT),
            least: [moves, taps],
        }
    }
}

/// Counts at the nets inside the model of an inline shaper with registers. An axis moves while its input counts.
#[derive(Debug, Clone)]
pub(crate) struct InsideAnInlineShaper(InsideAStage);

impl InsideAStage {
    /// Counts of the row `instance` of an inline shaper, which needs so many taps of each axis, and per cent of the registers.
    pub(crate) fn of_inline(
        instance: &str,
        axes: &[String],
        map: &RegisterMap,
        [taps, per_cent]: [u64; 2],
    ) -> InsideAnInlineShaper {
        InsideAnInlineShaper(Self::new(instance, axes, map, [1, taps, per_cent]))
    }
}

impl Reach for InsideAnInlineShaper {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.0.observe_at(clock, INLINE_AXIS, 1);
    }

    fn reached(&self) -> Vec<(String, ReachedCount)> {
        self.0.reached()
    }
}

impl InsideAStage {
    /// Adds a clock. `names` are the nets of an axis, and `run` is the state in which it moves.
    fn observe_at(&mut self, clock: &Clock<'_>, names: [&str; 5], run: u64) {
        let Some(inside) = clock.inside else {
            return;
        };
        if self.bus.is_empty() {
            self.bus = BUS.iter().filter_map(|name| inside.net(name)).collect();
            for axis in &mut self.axes {
                let nets = names
                    .iter()
                    .filter_map(|net| inside.net(&format!("{}_{net}", axis.name)));
                axis.nets = nets.collect();
            }
        }
        if let [address, read, write, data, read_data] = self.bus.as_slice() {
            let [address, read, write, data, read_data] =
                [*address, *read, *write, *data, *read_data].map(|net| inside.value(net));
            // The nets are those after the clock's edge, when the word is there.
            if read != 0 && read_data != 0 {
                self.read.insert(address);
            }
            if write != 0 && data != 0 {
                self.written.insert(address);
            }
        }
        for axis in &mut self.axes {
            let [state, position, valid, tap_write, tap] = axis.nets.as_slice() else {
                continue;
            };
            let [state, position, valid, tap_write, tap] =
                [*state, *position, *valid, *tap_write, *tap].map(|net| inside.value(net));
            axis.samples += valid;
            axis.taps += tap_write & u64::from(tap != 0);
            let moves = state == run && position != axis.position;
            axis.moves += u64::from(moves && !axis.moved);
            axis.moved = state == run && (axis.moved || moves);
            axis.position = position;
        }
    }
}

impl Reach for InsideAStage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe_at(clock, AXIS, RUN);
    }

    fn reached(&self) -> Vec<(String, ReachedCount)> {
        let [moves, taps] = self.least;
        let of_axis = |axis: &InsideAxis| {
            [
                ReachedCount::new(format!("samples of {}", axis.name), axis.samples, 1),
                ReachedCount::new(format!("moves of {}", axis.name), axis.moves, moves),
                ReachedCount::new(format!("taps of {}", axis.name), axis.taps, taps),
            ]
        };
        let [written, read] = self.bars;
        let registers = [
            ReachedCount::new("registers written", self.written.len() as u64, written),
            ReachedCount::new("registers read", self.read.len() as u64, read),
        ];
        let counts = self.axes.iter().flat_map(of_axis).chain(registers);
        counts.map(|count| (self.instance.clone(), count)).collect()
    }
}
