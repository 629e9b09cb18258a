//! What a run of a bank reached.

use posicast_blocks::Direction;
use posicast_blocks::registers::{Access, FlagSource, RegisterMap};

use super::stimuli::{ADDRESS, BUS_INPUTS, BYTE_ENABLE, READ, WRITE, WRITE_DATA};

/// Counts of what a run of a bank reached, by name.
#[derive(Debug, Clone)]
pub struct RegistersCoverage {
    map: RegisterMap,
    names: Vec<String>,
    counts: Vec<u64>,
    inputs_before: Vec<u64>,
    waits: bool,
}

impl RegistersCoverage {
    /// Creates counters at zero.
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

    /// Adds a clock, given its inputs in the order of the bank's ports.
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

    /// Returns the names of the events that never occurred.
    pub fn missing(&self) -> Vec<String> {
        let never = self.counts().into_iter().filter(|(_, count)| *count == 0);
        never.map(|(name, _)| name).collect()
    }

    /// Returns each event's name and count. The event of a flag that cannot be set in the clock in which it is
    /// cleared, because the bank itself sets it, is left out.
    pub fn counts(&self) -> Vec<(String, u64)> {
        let own = |name: &str| {
            let registers = self.map.registers().iter().filter(|r| r.access.is_sticky());
            registers
                .flat_map(|r| r.fields.iter().map(move |f| (r, f)))
                .any(|(register, field)| {
                    field.source != FlagSource::Input
                        && name == format!("{}.{}: set and cleared in one clock", register.name, field.name)
                })
        };
        let bins = self.names.iter().zip(&self.counts).filter(|(name, _)| !own(name));
        bins.map(|(name, count)| (name.clone(), *count)).collect()
    }
}
