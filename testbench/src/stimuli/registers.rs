//! Inputs for register banks and components, seeded: Avalon traffic, legal and not, among inputs that change at any pace.
//!
//! Traffic comes in phases: dense, sparse, and reads alone, so that what a register sets is also left alone for a while.
//! Addresses are mostly those of registers; words are random, single bits, small or full; bytes are mostly all enabled.

use std::collections::VecDeque;

use posicast_model::rtl::component::{Block, Component};
use posicast_model::rtl::registers::{Access, RegisterMap, Source};
use posicast_model::rtl::shaper::ShaperConfig;
use posicast_model::rtl::{Direction, Port};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::table::{Table, pick};
use super::{PulseCounterRandom, Stimuli};

/// Places of the bus among the input ports, behind `rst`.
const ADDRESS: usize = 1;
const READ: usize = 2;
const WRITE: usize = 3;
const BYTE_ENABLE: usize = 4;
const WRITE_DATA: usize = 5;
const BUS_INPUTS: usize = 6;

/// An input that is not of the bus, and how often it changes: once in so many clocks.
#[derive(Debug, Clone)]
struct Pin {
    at: usize,
    width: u32,
    pace: u32,
    value: u64,
}

/// A mixture of everything, without end.
#[derive(Debug, Clone)]
pub struct RegistersRandom {
    rng: Xoshiro256PlusPlus,
    offsets: Vec<u64>,
    /// Words at and below the minima of guarded registers, with their offsets.
    floors: Vec<(u64, u64)>,
    pins: Vec<Pin>,
    clock: u64,
    /// Clocks from access to access, and whether there are writes.
    phase: (u32, bool),
    /// Where a read goes that follows a write.
    last: u64,
}

impl RegistersRandom {
    /// For a block with these ports, the bus first, and these registers. Equal seeds give equal inputs.
    pub fn new(map: &RegisterMap, ports: &[Port], seed: u64) -> Self {
        let inputs = ports.iter().filter(|port| port.direction == Direction::Input);
        let pin = |(at, port): (usize, &Port)| Pin {
            at,
            width: port.width,
            pace: 2,
            value: 0,
        };
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            offsets: map.registers().iter().map(|register| register.offset.into()).collect(),
            floors: floors(map),
            pins: inputs.enumerate().skip(BUS_INPUTS).map(pin).collect(),
            clock: 0,
            phase: (1, true),
            last: 0,
        }
    }

    fn one_in(&mut self, clocks: u32) -> bool {
        self.rng.random_range(0..clocks) == 0
    }

    fn word(&mut self) -> u64 {
        let random = u64::from(self.rng.next_u32());
        let bit = 1u64 << self.rng.random_range(0..32);
        let small = random >> self.rng.random_range(0..32);
        *pick(
            &mut self.rng,
            &[random, random, random, small, bit, !bit & 0xffff_ffff, 0, 0xffff_ffff],
        )
    }

    fn access(&mut self, inputs: &mut [u64]) {
        let (pace, writes) = self.phase;
        let anywhere = u64::from(self.rng.next_u32() & 0xff);
        let again = self.last;
        let register = *pick(&mut self.rng, &self.offsets);
        inputs[ADDRESS] = *pick(
            &mut self.rng,
            &[register, register, register, register, again, anywhere],
        );
        inputs[WRITE_DATA] = self.word();
        let partial = u64::from(self.rng.next_u32() & 0xf);
        inputs[BYTE_ENABLE] = *pick(&mut self.rng, &[0xf, 0xf, 0xf, 0xf, partial]);
        inputs[READ] = 0;
        inputs[WRITE] = 0;
        if self.one_in(pace) {
            let write = writes && self.one_in(2);
            inputs[WRITE] = write.into();
            // Both at once is illegal, and must do no harm.
            inputs[READ] = (!write || self.one_in(20)).into();
            self.last = inputs[ADDRESS];
        }
        let near: Vec<(u64, u64)> = self
            .floors
            .iter()
            .copied()
            .filter(|floor| floor.0 == self.last)
            .collect();
        if !near.is_empty() && self.one_in(2) {
            (inputs[ADDRESS], inputs[WRITE_DATA]) = *pick(&mut self.rng, &near);
            inputs[BYTE_ENABLE] = 0xf;
        }
    }

    fn pins(&mut self, inputs: &mut [u64]) {
        for at in 0..self.pins.len() {
            if self.one_in(5000) {
                self.pins[at].pace = *pick(&mut self.rng, &[1, 2, 5, 40, 300, 3000]);
            }
            let pace = self.pins[at].pace;
            if self.one_in(pace) {
                let (random, pin) = (self.rng.next_u64(), &mut self.pins[at]);
                pin.value = match random & 7 {
                    // Counters and lines that turn over.
                    0..=3 => pin.value.wrapping_add(1),
                    _ => random >> 3,
                } & (u64::MAX >> (64 - pin.width));
            }
            inputs[self.pins[at].at] = self.pins[at].value;
        }
    }
}

fn floors(map: &RegisterMap) -> Vec<(u64, u64)> {
    let mut floors = Vec::new();
    for register in map.registers() {
        for field in register.fields.iter().filter(|field| field.minimum > 0) {
            for value in [field.minimum, field.minimum - 1] {
                let word = register.reset() & !field.mask() | value << field.low;
                floors.push((register.offset.into(), word.into()));
            }
        }
    }
    floors
}

impl Stimuli for RegistersRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        if self.one_in(2000) {
            self.phase = *pick(
                &mut self.rng,
                &[(1, true), (2, true), (5, true), (60, true), (60, false), (4, false)],
            );
        }
        inputs[0] = (self.clock < 2 || self.one_in(10_000)).into();
        self.access(inputs);
        self.pins(inputs);
        self.clock += 1;
    }
}

/// Traffic for a component: as [`RegistersRandom`], with pins and transactions such that its block has something to do.
#[derive(Debug, Clone)]
pub struct ComponentRandom {
    registers: RegistersRandom,
    map: RegisterMap,
    core: Core,
    /// Writes to come: word and data.
    writes: VecDeque<(u32, u32)>,
}

#[derive(Debug, Clone)]
enum Core {
    Shaper(Box<ShaperConfig>, Table),
    PulseCounter(Box<PulseCounterRandom>, Vec<u64>),
    SlidingMode,
    /// Where `fault_n` is among the inputs, with the PLL's and the filtered faults behind it.
    Pwm(usize),
    Other,
}

impl ComponentRandom {
    /// Equal seeds give equal inputs for equal outputs.
    pub fn new(component: &Component, seed: u64) -> Self {
        let core = component.blocks().iter().find_map(|block| match block {
            Block::Shaper(config) => Some(Core::Shaper(Box::new(config.clone()), Table::with_capacity(256))),
            Block::SlidingMode => Some(Core::SlidingMode),
            Block::Pwm(_) => {
                let ports = component.composition().ports().iter();
                let mut inputs = ports.filter(|port| port.direction == Direction::Input);
                inputs.position(|port| port.name == "fault_n").map(Core::Pwm)
            }
            Block::PulseCounter => Some(Core::PulseCounter(Box::new(PulseCounterRandom::new(seed)), vec![0; 26])),
            _ => None,
        });
        Self {
            registers: RegistersRandom::new(component.map(), component.composition().ports(), seed),
            map: component.map().clone(),
            core: core.unwrap_or(Core::Other),
            writes: VecDeque::new(),
        }
    }

    fn write(&mut self, register: &str, data: u32) {
        self.writes
            .extend(self.map.register(register).map(|register| (register.offset, data)));
    }

    /// What a driver would do: now and then a whole sequence.
    fn plan(&mut self) {
        if !self.writes.is_empty() || !self.registers.one_in(400) {
            return;
        }
        let random = self.registers.rng.next_u32();
        match &mut self.core {
            Core::Shaper(config, table) => {
                let (fraction, address_bits) = (config.coefficient_fraction(), config.ring_address_bits());
                let reach = if random & 1 == 0 { 3 } else { address_bits };
                let count = (random >> 1 & 7) as usize + 1;
                table.draw(&mut self.registers.rng, count, fraction, reach);
                let bank = (random >> 8 & 1) + 1;
                let taps: Vec<(u32, u32)> = (0..)
                    .zip(&table.taps)
                    .map(|(index, (coefficient, delay))| {
                        (index, *coefficient as u32 & 0x3_ffff | (*delay as u32) << 18)
                    })
                    .collect();
                let host = random >> 12 & 3 != 0;
                self.write("control", (!host).into());
                for (index, tap) in taps {
                    self.write("tap_address", index | bank << 8);
                    self.write("tap", tap);
                }
                self.write("swap", bank | (random >> 16 & 3) << 4);
                for sample in 0..random >> 20 & 15 {
                    let x = self.registers.rng.next_u32();
                    for word in ["x", "x_0", "x_1", "x_2"] {
                        self.write(word, x >> (sample & 7));
                    }
                    self.write("strobe", 0);
                    self.writes.extend([(0x40, 0); 30]);
                }
            }
            Core::PulseCounter(..) => {
                self.write(
                    "lines",
                    (random & 0x3) | (((random >> 8) & 0x7) % 5) << 8 | (random & 0x2_0000),
                );
                self.write("index", random >> 24 & 0xff);
                self.write("velocity_filter", ((random >> 4) & 0xf013) | 0x0100);
                self.write("index_arm", 0);
                self.write("preset", 0);
            }
            Core::SlidingMode => {
                let bank = (random & 1) + 1;
                for row in 0..16 {
                    // Mantissas and shifts; the limit is a number of the same kind.
                    let setting = self.registers.word() as u32;
                    self.write("setting_address", row | bank << 8);
                    self.write("setting", setting);
                }
                self.write("law", random >> 2 & 3 | bank << 8 | random & 0x10);
                self.write("commit", 0);
                self.write("control", u32::from(random >> 12 & 3 != 0));
                self.write("start", 0);
            }
            Core::Pwm(_) => {
                // Off, a short period, times near the floors, on.
                self.write("control", 0);
                self.write("period", 20 + (random & 0x3f));
                self.write("times", (4 + ((random >> 6) & 3)) | ((3 + ((random >> 8) & 3)) << 16));
                self.write("max_duty", random >> 10 & 0x7f);
                self.write("phase", random >> 12 & 0x1f_001f);
                self.write(
                    "supervision",
                    if random >> 17 & 1 == 0 { 0 } else { random >> 18 & 0x703 },
                );
                self.write("clear_trip", 0);
                self.write("control", 1 | random >> 20 & 0x306);
                for _ in 0..random >> 28 {
                    let duty = self.registers.rng.next_u32() as i32 >> 24;
                    self.write("duty", duty as u32);
                    self.write("feed", 0);
                    self.writes.extend([(0x40, 0); 20]);
                    // Refused while it runs.
                    self.write("times", 0x1f | 0x1f << 16);
                }
            }
            Core::Other => {}
        }
    }
}

impl Stimuli for ComponentRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        self.registers.fill(seen, inputs);
        self.plan();
        if let Core::PulseCounter(encoder, row) = &mut self.core {
            encoder.fill(&[], row);
            // The lines are the same in both, behind `rst` and behind the bus.
            inputs[BUS_INPUTS..BUS_INPUTS + 6].copy_from_slice(&row[1..7]);
        }
        if let Core::Pwm(fault_n) = self.core {
            // Healthy, as a rule.
            for (input, healthy) in inputs[fault_n..].iter_mut().zip([1, 1, 3]) {
                if !self.registers.one_in(1000) {
                    *input = healthy;
                }
            }
        }
        if inputs[READ] == 0
            && !self.registers.one_in(4)
            && let Some((offset, data)) = self.writes.pop_front()
        {
            inputs[ADDRESS] = offset.into();
            inputs[WRITE_DATA] = data.into();
            inputs[BYTE_ENABLE] = 0xf;
            inputs[WRITE] = 1;
        }
    }
}

/// What a run of a bank reached, by name.
#[derive(Debug, Clone)]
pub struct RegistersCoverage {
    map: RegisterMap,
    names: Vec<String>,
    counts: Vec<u64>,
    inputs_before: Vec<u64>,
    waits: bool,
}

impl RegistersCoverage {
    /// Nothing yet.
    pub fn new(map: &RegisterMap) -> Self {
        Self {
            map: map.clone(),
            names: Vec::new(),
            counts: Vec::new(),
            inputs_before: Vec::new(),
            waits: false,
        }
        .with_bins()
    }

    fn with_bins(mut self) -> Self {
        let registers = self.map.registers().to_vec();
        for register in &registers {
            let name = &register.name;
            self.bin(format!("{name}: read"), 0);
            self.bin(format!("{name}: written"), 0);
            if register.access.whole_words() {
                self.bin(format!("{name}: partly written"), 0);
            }
            match &register.access {
                Access::Snapshot => self.bin("snapshot while an input changes".to_owned(), 0),
                Access::Commit { .. } => {
                    self.bin("commit while one waits".to_owned(), 0);
                    self.bin("commit in the clock of the tick".to_owned(), 0);
                    self.bin("staged write while a commit waits".to_owned(), 0);
                    self.bin("commit applied".to_owned(), 0);
                }
                Access::Guarded { .. } => {
                    self.bin(format!("{name}: guard open"), 0);
                    self.bin(format!("{name}: guard closed"), 0);
                }
                Access::Sticky | Access::InterruptState => {
                    for field in &register.fields {
                        self.bin(format!("{name}.{}: set and cleared in one clock", field.name), 0);
                    }
                }
                _ => {}
            }
        }
        for name in ["unmapped read", "unmapped write", "read and write at once", "reset"] {
            self.bin(name.to_owned(), 0);
        }
        self
    }

    fn bin(&mut self, name: String, count: u64) {
        match self.names.iter().position(|other| *other == name) {
            Some(at) => self.counts[at] += count,
            None => {
                self.names.push(name);
                self.counts.push(count);
            }
        }
    }

    /// Adds a clock: its inputs, in the order of the bank's ports.
    pub fn observe(&mut self, inputs: &[u64]) {
        let changed = self.inputs_before.get(BUS_INPUTS..) != inputs.get(BUS_INPUTS..);
        self.inputs_before = inputs.to_vec();
        if inputs[0] != 0 {
            self.waits = false;
            self.bin("reset".to_owned(), 1);
            return;
        }
        let (read, write) = (inputs[READ] != 0, inputs[WRITE] != 0);
        let whole = inputs[BYTE_ENABLE] == 0xf;
        if read && write {
            self.bin("read and write at once".to_owned(), 1);
        }
        let tick = self.tick(inputs);
        let waits = self.waits;
        if waits && tick {
            self.waits = false;
            self.bin("commit applied".to_owned(), 1);
        }
        let addressed = self
            .map
            .registers()
            .iter()
            .find(|r| u64::from(r.offset) == inputs[ADDRESS]);
        let Some(register) = addressed.cloned() else {
            let what = if write { "unmapped write" } else { "unmapped read" };
            self.bin(what.to_owned(), u64::from(read || write));
            return;
        };
        let name = &register.name;
        self.bin(format!("{name}: read"), read.into());
        if !write {
            return;
        }
        if register.access.whole_words() && !whole {
            self.bin(format!("{name}: partly written"), 1);
            return;
        }
        self.bin(format!("{name}: written"), 1);
        match &register.access {
            Access::Snapshot => self.bin("snapshot while an input changes".to_owned(), changed.into()),
            Access::Commit { .. } => {
                self.bin("commit while one waits".to_owned(), waits.into());
                self.bin("commit in the clock of the tick".to_owned(), (!waits && tick).into());
                self.waits |= !waits;
            }
            Access::Staged => self.bin("staged write while a commit waits".to_owned(), waits.into()),
            Access::Guarded { while_low } => {
                let open = !self.input(inputs, while_low);
                let which = if open { "open" } else { "closed" };
                self.bin(format!("{name}: guard {which}"), 1);
            }
            Access::Sticky | Access::InterruptState => {
                for field in &register.fields {
                    let cleared = inputs[WRITE_DATA] >> field.low & 1 != 0 && whole;
                    if cleared && self.input(inputs, &field.name) {
                        self.bin(format!("{name}.{}: set and cleared in one clock", field.name), 1);
                    }
                }
            }
            _ => {}
        }
    }

    fn input(&self, inputs: &[u64], name: &str) -> bool {
        let ports = self
            .map
            .ports()
            .iter()
            .filter(|port| port.direction == Direction::Input);
        let value = ports
            .zip(inputs)
            .find(|(port, _)| port.name == name)
            .map(|(_, value)| *value);
        value.is_some_and(|value| value != 0)
    }

    fn tick(&self, inputs: &[u64]) -> bool {
        let commit = self.map.find(|access| matches!(access, Access::Commit { .. }));
        match commit.map(|register| &register.access) {
            Some(Access::Commit { tick }) => self.input(inputs, tick),
            _ => false,
        }
    }

    /// What was never reached.
    pub fn missing(&self) -> Vec<String> {
        let never = self.counts().into_iter().filter(|(_, count)| *count == 0);
        never.map(|(name, _)| name).collect()
    }

    /// What happened how often. A flag that the bank sets by itself cannot be set in the clock of its own clearing: that is
    /// left out.
    pub fn counts(&self) -> Vec<(String, u64)> {
        let own = |name: &str| {
            let registers = self.map.registers().iter().filter(|r| r.access.is_sticky());
            registers
                .flat_map(|r| r.fields.iter().map(move |f| (r, f)))
                .any(|(register, field)| {
                    field.source != Source::Input
                        && name == format!("{}.{}: set and cleared in one clock", register.name, field.name)
                })
        };
        let bins = self.names.iter().zip(&self.counts).filter(|(name, _)| !own(name));
        bins.map(|(name, count)| (name.clone(), *count)).collect()
    }
}
