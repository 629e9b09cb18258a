//! The value that every read must return, whatever the traffic is. It is derived from the register map alone, not
//! from the bank's model.
//!
//! ```text
//! unmapped, command, commands' words, snapshot, interrupt test      0
//! constant                                                          its value
//! configuration, interrupt enable                                   what the bytes written last make of it
//! guarded                                                           no field below its minimum
//! all others                                                        0 in the bits of no field
//! no read                                                           readdata as it was
//! ```

use posicast_blocks::registers::{Access, Register, RegisterMap};

use super::stimuli::{ADDRESS, BYTE_ENABLE, READ, WRITE, WRITE_DATA};

/// Value that a read must return.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Expected {
    Word(u32),
    /// Any value in the fields of the register, each at least its minimum.
    Fields(usize),
}

/// Checks the reads of a component, clock by clock.
#[derive(Debug, Clone)]
pub struct ReadPromises {
    map: RegisterMap,
    /// Words of registers that return what was written, by the register's index in the map.
    kept: Vec<u32>,
    /// Expected result of the previous clock's read; `None` if there was none, so that readdata must not change.
    pending: Option<Expected>,
    /// Last value of readdata.
    shown: Option<u32>,
    clock: u64,
    reads: u64,
    violation: Option<String>,
}

impl ReadPromises {
    /// Creates a checker for a component with this map, before its first reset.
    pub fn new(map: &RegisterMap) -> Self {
        Self {
            kept: map.registers().iter().map(Register::reset).collect(),
            map: map.clone(),
            pending: None,
            shown: None,
            clock: 0,
            reads: 0,
            violation: None,
        }
    }

    /// Adds a clock, given its inputs and its `avs_readdata`.
    pub fn observe(&mut self, inputs: &[u64], read_data: u64) {
        let data = read_data as u32;
        let wrong = match (self.pending, self.shown) {
            (Some(Expected::Word(word)), _) if word != data => Some(format!("{word:#010x} is promised")),
            (Some(Expected::Fields(at)), _) => self.fields_of(at, data),
            (None, Some(before)) if before != data => Some(format!("no read changed it from {before:#010x}")),
            _ => None,
        };
        if let (Some(wrong), None) = (wrong, &self.violation) {
            self.violation = Some(format!("clock {}: readdata {data:#010x}, but {wrong}", self.clock));
        }
        self.clock += 1;
        self.shown = Some(data);
        let register = self.at(inputs[ADDRESS] as u32);
        self.pending = (inputs[READ] & 1 == 1).then(|| self.expected(register));
        self.reads += inputs[READ] & 1;
        if inputs[WRITE] & 1 == 1
            && let Some(at) = register
        {
            self.write(at, inputs[WRITE_DATA] as u32, inputs[BYTE_ENABLE] as u32);
        }
        if inputs[0] & 1 == 1 {
            self.kept = self.map.registers().iter().map(Register::reset).collect();
            // The value of readdata after a reset is not specified.
            (self.pending, self.shown) = (None, None);
        }
    }

    /// Returns a description of the first wrong read.
    pub fn violation(&self) -> Option<&str> {
        self.violation.as_deref()
    }

    /// Returns the number of checked reads.
    pub fn reads(&self) -> u64 {
        self.reads
    }

    fn at(&self, offset: u32) -> Option<usize> {
        let covers = |register: &Register| (register.offset..register.offset + register.words()).contains(&offset);
        self.map.registers().iter().position(covers)
    }

    fn expected(&self, register: Option<usize>) -> Expected {
        let Some(at) = register else {
            return Expected::Word(0);
        };
        match &self.map.registers()[at].access {
            Access::Constant | Access::Configuration | Access::InterruptEnable => Expected::Word(self.kept[at]),
            Access::Command { .. } | Access::Words { .. } | Access::Snapshot | Access::InterruptTest => {
                Expected::Word(0)
            }
            _ => Expected::Fields(at),
        }
    }

    fn write(&mut self, at: usize, data: u32, byte_enable: u32) {
        let register = &self.map.registers()[at];
        if matches!(register.access, Access::Configuration | Access::InterruptEnable) {
            let bytes = (0..4).filter(|byte| byte_enable >> byte & 1 == 1);
            let mask = bytes.fold(0, |mask, byte| mask | 0xff << (8 * byte)) & register.mask();
            self.kept[at] = self.kept[at] & !mask | data & mask;
        }
    }

    /// Returns what is wrong with the word of this register.
    fn fields_of(&self, at: usize, data: u32) -> Option<String> {
        let register = &self.map.registers()[at];
        let fields = self.map.fields(register);
        let outside = fields.iter().fold(data, |data, field| data & !field.mask());
        if outside != 0 {
            return Some(format!("{} has no field in the bits {outside:#010x}", register.name));
        }
        let low = fields
            .iter()
            .find(|field| (data & field.mask()) >> field.low < field.minimum);
        low.map(|field| format!("{}.{} is at least {}", register.name, field.name, field.minimum))
    }
}
