//! The six classic register tests, derived from a register map: they check over the bus alone what a host may rely
//! on.
//!
//! | test | question |
//! |---|---|
//! | [`reset_values`] | does every register read as described after a reset, and again after a reset in mid-life? |
//! | [`read_write`] | does every writable register keep a word, and none of the others? |
//! | [`bit_bash`] | does every bit of a field go to one and to zero, and no other bit with it? |
//! | [`aliasing`] | is every register where it is described, and nowhere else in the window? |
//! | [`random_with_resets`] | do reads agree with the description after any writes, with resets in between? |
//! | [`byte_enables`] | does a write reach the enabled bytes, for all sixteen patterns? |
//!
//! They use only the description, so they test both the model and the Verilog against it. They leave out what the
//! hardware may change (live words, flags from outside, and registers that a pin guards) unless the test controls the
//! pins ([`RegisterHardware::Still`]): inputs are then 0, and guards open.

use posicast_blocks::registers::{Access, FlagSource, Register, RegisterMap};
use posicast_blocks::{ClockedBlock, Direction};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Who drives the inputs of the registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RegisterHardware {
    /// The test drives them: the bank is alone.
    Still,
    /// A block behind the bank drives them.
    Running,
}

/// A test; the error reports the register and the word that was found.
pub type Test = fn(&mut Host<'_>) -> Result<(), String>;

/// All six tests with their names.
pub const TESTS: [(&str, Test); 6] = [
    ("reset values", reset_values),
    ("read-write", read_write),
    ("bit bash", bit_bash),
    ("aliasing", aliasing),
    ("random with resets", random_with_resets),
    ("byte enables", byte_enables),
];

/// A host on the bus of a block, with its knowledge of the registers.
pub struct Host<'a> {
    map: &'a RegisterMap,
    block: &'a mut dyn ClockedBlock,
    hardware: RegisterHardware,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
    read_data: usize,
    /// Expected word of each register.
    expected: Vec<u32>,
}

impl<'a> Host<'a> {
    /// Makes a host for `block`, whose registers are those of `map`; it begins with a reset.
    ///
    /// # Errors
    /// A message, where the block cannot be stepped.
    pub fn new(
        map: &'a RegisterMap,
        block: &'a mut dyn ClockedBlock,
        hardware: RegisterHardware,
    ) -> Result<Self, String> {
        let names = |direction| -> Vec<String> {
            let ports = block.ports().iter().filter(|port| port.direction == direction);
            ports.map(|port| port.name.clone()).collect()
        };
        let (inputs, outputs) = (names(Direction::Input), names(Direction::Output));
        let read_data = outputs.iter().position(|name| name == "avs_readdata");
        let mut host = Self {
            inputs: vec![0; inputs.len()],
            outputs: vec![0; outputs.len()],
            read_data: read_data.ok_or("the block has no `avs_readdata`")?,
            expected: map.registers().iter().map(Register::reset).collect(),
            map,
            block,
            hardware,
        };
        host.reset()?;
        Ok(host)
    }

    fn clock(&mut self) -> Result<(), String> {
        let stepped = self.block.step(&self.inputs, &mut self.outputs);
        stepped.map_err(|error| error.to_string())
    }

    fn reset(&mut self) -> Result<(), String> {
        self.inputs[0] = 1;
        self.clock()?;
        self.inputs[0] = 0;
        self.expected = self.map.registers().iter().map(Register::reset).collect();
        Ok(())
    }

    /// Reads the word at `offset`.
    fn read(&mut self, offset: u32) -> Result<u32, String> {
        self.inputs[1..6].copy_from_slice(&[offset.into(), 1, 0, 0xf, 0]);
        self.clock()?;
        self.inputs[2] = 0;
        self.clock()?;
        Ok(self.outputs[self.read_data] as u32)
    }

    /// Writes a word, and updates the expected words.
    fn write(&mut self, offset: u32, data: u32, bytes: u32) -> Result<(), String> {
        self.inputs[1..6].copy_from_slice(&[offset.into(), 0, 1, bytes.into(), data.into()]);
        self.clock()?;
        self.inputs[3] = 0;
        if let Some(at) = self
            .map
            .registers()
            .iter()
            .position(|register| (register.offset..register.offset + register.words()).contains(&offset))
        {
            self.expect(at, data, enabled(bytes));
        }
        Ok(())
    }

    /// Updates the expected words after a write, by the description.
    fn expect(&mut self, at: usize, data: u32, enabled: u32) {
        let register = &self.map.registers()[at];
        let merged = (self.expected[at] & !enabled | data & enabled) & register.mask();
        match &register.access {
            Access::Configuration | Access::InterruptEnable | Access::Staged => self.expected[at] = merged,
            Access::Guarded { .. } => {
                if register.fields.iter().all(|field| field.of(merged) >= field.minimum) {
                    self.expected[at] = merged;
                } else {
                    self.flag(FlagSource::GuardRefused);
                }
            }
            Access::Sticky | Access::InterruptState => self.expected[at] &= !(data & enabled),
            access if access.whole_words() && enabled != u32::MAX => self.flag(FlagSource::PartialWrite),
            Access::InterruptTest => {
                let state = self
                    .map
                    .registers()
                    .iter()
                    .position(|r| r.access == Access::InterruptState);
                if let Some(state) = state {
                    self.expected[state] |= data & register.mask();
                }
            }
            _ => {}
        }
    }

    fn flag(&mut self, source: FlagSource) {
        for (register, expected) in self.map.registers().iter().zip(&mut self.expected) {
            if register.access.is_sticky() {
                let own = register.fields.iter().filter(|field| field.source == source);
                *expected |= own.fold(0, |mask, field| mask | field.mask());
            }
        }
    }

    /// Mask of the bits that the host can predict.
    fn certain(&self, register: &Register) -> u32 {
        let running = self.hardware == RegisterHardware::Running;
        match &register.access {
            Access::Live | Access::Shadow { .. } | Access::Guarded { .. } if running => 0,
            Access::Sticky | Access::InterruptState if running => {
                let outside = register.fields.iter().filter(|field| field.source == FlagSource::Input);
                !outside.fold(0, |mask, field| mask | field.mask())
            }
            _ => !0,
        }
    }

    fn check(&mut self, at: usize, when: &str) -> Result<(), String> {
        let register = &self.map.registers()[at];
        let found = self.read(register.offset)?;
        let certain = self.certain(register);
        let expected = self.expected[at];
        if (found ^ expected) & certain == 0 {
            return Ok(());
        }
        Err(format!(
            "`{}` at {:#04x} reads {found:#010x} {when}; {expected:#010x} is right, in the bits {certain:#010x}",
            register.name, register.offset
        ))
    }

    fn check_all(&mut self, when: &str) -> Result<(), String> {
        (0..self.map.registers().len()).try_for_each(|at| self.check(at, when))
    }

    /// The registers that keep what is written, whatever the hardware does.
    fn keepers(&self) -> Vec<usize> {
        let keeps = |register: &Register| match register.access {
            Access::Configuration | Access::InterruptEnable | Access::Staged => true,
            Access::Guarded { .. } => self.hardware == RegisterHardware::Still,
            _ => false,
        };
        let registers = self.map.registers().iter().enumerate();
        registers.filter(|(_, r)| keeps(r)).map(|(at, _)| at).collect()
    }

    fn offset(&self, at: usize) -> u32 {
        self.map.registers()[at].offset
    }
}

/// A mask with ones in the enabled bytes.
fn enabled(bytes: u32) -> u32 {
    (0..4).fold(0, |mask, byte| mask | ((bytes >> byte & 1) * 0xff) << (8 * byte))
}

/// Checks that every register reads as described after a reset, and again after a later reset.
///
/// # Errors
/// A message that names the register, the condition and the word that was read.
pub fn reset_values(host: &mut Host<'_>) -> Result<(), String> {
    host.check_all("after a reset")?;
    for at in 0..host.map.registers().len() {
        host.write(host.offset(at), 0x5a5a_a5a5, 0xf)?;
    }
    host.reset()?;
    host.check_all("after a second reset")
}

/// Checks that every writable register keeps a word, and that writes to others change nothing that can be read.
///
/// # Errors
/// A message that names the register, the condition and the word that was read.
pub fn read_write(host: &mut Host<'_>) -> Result<(), String> {
    for data in [0, u32::MAX, 0xaaaa_aaaa, 0x5555_5555, 0x0123_4567] {
        for at in 0..host.map.registers().len() {
            let commits = matches!(
                host.map.registers()[at].access,
                Access::Commit { .. } | Access::Snapshot
            );
            if !commits {
                host.write(host.offset(at), data, 0xf)?;
                host.check(at, "after a write")?;
            }
        }
    }
    host.check_all("after writes of all")
}

/// Checks that every bit of a field can be set and cleared, and that no other bit changes with it.
///
/// # Errors
/// A message that names the register, the condition and the word that was read.
pub fn bit_bash(host: &mut Host<'_>) -> Result<(), String> {
    for at in host.keepers() {
        for bit in 0..32 {
            for data in [1 << bit, !(1 << bit)] {
                host.write(host.offset(at), data, 0xf)?;
                host.check(at, &format!("after {data:#010x}"))?;
            }
        }
    }
    Ok(())
}

/// Checks that every register is where it is described, and nowhere else: each gets a word of its own, the rest of
/// the window another.
///
/// # Errors
/// A message that names the register, the condition and the word that was read.
pub fn aliasing(host: &mut Host<'_>) -> Result<(), String> {
    let word = |offset: u32| (offset + 1).wrapping_mul(0x9e37_79b9);
    for at in host.keepers() {
        host.write(host.offset(at), word(host.offset(at)), 0xf)?;
    }
    let registers = host.map.registers().iter();
    let mapped: Vec<u32> = registers
        .flat_map(|register| register.offset..register.offset + register.words())
        .collect();
    for offset in (0..1 << host.map.address_bits()).filter(|offset| !mapped.contains(offset)) {
        host.write(offset, !word(offset), 0xf)?;
        let found = host.read(offset)?;
        if found != 0 {
            return Err(format!("the unmapped word {offset:#04x} reads {found:#010x}, not 0"));
        }
    }
    host.check_all("after writes all over the window")
}

/// Checks that reads agree with the description after arbitrary writes, with resets in between.
///
/// # Errors
/// A message that names the register, the condition and the word that was read.
pub fn random_with_resets(host: &mut Host<'_>) -> Result<(), String> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(6);
    for turn in 0..3000 {
        let at = rng.random_range(0..host.map.registers().len());
        let (data, bytes) = (rng.next_u32(), if turn & 1 == 0 { 0xf } else { rng.next_u32() & 0xf });
        match host.map.registers()[at].access {
            // The effect of these depends on pins.
            Access::Commit { .. } | Access::Snapshot => {}
            _ => host.write(host.offset(at), data, bytes)?,
        }
        let other = rng.random_range(0..host.map.registers().len());
        host.check(other, &format!("in turn {turn}"))?;
        if rng.random_range(0..200) == 0 {
            host.reset()?;
        }
    }
    host.check_all("at the end")
}

/// Checks that a write reaches the enabled bytes, for all sixteen patterns, and registers that take only whole words
/// with the last pattern alone.
///
/// # Errors
/// A message that names the register, the condition and the word that was read.
pub fn byte_enables(host: &mut Host<'_>) -> Result<(), String> {
    for at in 0..host.map.registers().len() {
        let access = host.map.registers()[at].access.clone();
        let partly = access.whole_words();
        for bytes in 0..if partly { 0xf } else { 0x10 } {
            for data in [u32::MAX, 0, 0xa5c3_0f96] {
                host.write(host.offset(at), data, bytes)?;
                host.check(at, &format!("after bytes {bytes:#06b} of {data:#010x}"))?;
            }
        }
    }
    host.check_all("after partial writes of all")
}
