//! An inline shaper at the other end of the link: its state and counts, the request for no shaping, and its tables.
//!
//! The controller at its pins moves the axes. No call here stops or starts one, and a host that dies changes nothing: there is no
//! watchdog to kick.

use std::io::{Read, Write};

use posicast_blocks::component::Component;
use posicast_machine::machine_file::Machine;
use posicast_taps::{Tap, TapTable};

use crate::stage::PATIENCE_TICKS;
use crate::{HostError, HostedStage, Link, RecordedTrace, TraceRequest};

/// An inline shaper, and the machine that it was made for.
#[derive(Debug)]
pub struct HostedInline<'m, L> {
    /// Registers are reached as those of a stage.
    registers: HostedStage<'m, L>,
}

/// The state of an inline shaper. The counts of all axes are those of one clock.
#[derive(Debug, Clone, PartialEq)]
pub struct InlineStatus {
    /// Whether the axes may follow their inputs: enabled, and no fault.
    pub run: bool,
    /// Whether every axis stands, and has given every step that it got.
    pub settled: bool,
    /// Whether no axis is shaped.
    pub bypassed: bool,
    /// Whether this register asks for no shaping; the pin may ask, too.
    pub bypass_requested: bool,
    /// Whether the axes have stopped with a cause. Without one on any axis there was an emergency stop.
    pub fault: bool,
    /// The axes.
    pub axes: Vec<InlineAxisStatus>,
}

/// The state of an axis of an inline shaper.
#[derive(Debug, Clone, PartialEq)]
pub struct InlineAxisStatus {
    /// Name of the axis.
    pub axis: String,
    /// Whether its steps follow the input.
    pub follows: bool,
    /// Whether it stands, and has given every step that it got.
    pub settled: bool,
    /// Names of the causes that have stopped it.
    pub causes: Vec<String>,
    /// Steps of the input since reset, modulo 2^32.
    pub input_steps: i32,
    /// Steps given since reset, modulo 2^32.
    pub given_steps: i32,
    /// Steps that the shaped position has demanded and that are still to come.
    pub owed_steps: i32,
    /// Transitions of a quadrature input in which both lines changed; stops at 255.
    pub illegal_count: u32,
    /// Active tap table: 0 is the machine's, 1 and 2 are loaded ones.
    pub table_bank: u32,
}

impl<'m, L: Read + Write> HostedInline<'m, L> {
    /// Identifies the inline shaper at the other end, and accepts only that of this machine file.
    ///
    /// # Errors
    /// [`HostError`] if there is no inline shaper, or one with another version of the registers or of another machine.
    pub fn open(link: Link<L>, machine: &'m Machine, component: &'m Component) -> Result<Self, HostError> {
        let registers = HostedStage::with_map(link, machine, component.map())?;
        Ok(Self { registers })
    }

    /// The machine file of the inline shaper.
    pub fn machine(&self) -> &'m Machine {
        self.registers.machine()
    }

    /// Returns the link.
    pub fn into_link(self) -> Link<L> {
        self.registers.into_link()
    }

    fn flag(&self, register: &str, field: &str, word: u32) -> Result<bool, HostError> {
        let fields = &self.registers.register(register)?.fields;
        let found = fields.iter().find(|other| other.name == field);
        let found = found.ok_or_else(|| HostError::NoRegister(format!("{}.{field}", register.to_uppercase())))?;
        Ok(found.of(word) != 0)
    }

    /// Reads the state of all axes; it writes nothing but the register that freezes the counts.
    ///
    /// # Errors
    /// [`HostError`]
    pub fn status(&mut self) -> Result<InlineStatus, HostError> {
        const WORDS: [&str; 6] = [
            "status",
            "causes",
            "snapshot_input_steps",
            "snapshot_given_steps",
            "snapshot_owed_steps",
            "illegal_count",
        ];
        self.registers.write(&[("snapshot".to_owned(), 0)])?;
        let words = self.registers.read(&["status".to_owned(), "bypass".to_owned()])?;
        let [status, bypass] = [0, 1].map(|place| words.get(place).copied().unwrap_or(0));
        let mut axes = Vec::new();
        for (axis, section) in self.machine().axes.iter().enumerate() {
            let names = WORDS.map(|word| self.registers.of(axis, word));
            let words = self.registers.read(&names)?;
            let [status, causes, input, given, owed, illegal] = words[..] else {
                continue;
            };
            let of_status = |field| Ok::<u32, HostError>(self.registers.field(axis, "status", field)?.of(status));
            let of_causes = &self.registers.register(&names[1])?.fields;
            let own = |name: &str| {
                name.strip_prefix(&format!("{}_", section.name))
                    .unwrap_or(name)
                    .replace('_', "-")
            };
            axes.push(InlineAxisStatus {
                axis: section.name.clone(),
                follows: of_status("follow")? != 0,
                settled: of_status("settled")? != 0,
                causes: of_causes
                    .iter()
                    .filter(|field| field.of(causes) != 0)
                    .map(|field| own(&field.name))
                    .collect(),
                input_steps: input as i32,
                given_steps: given as i32,
                owed_steps: i32::from(owed as u16 as i16),
                illegal_count: illegal,
                table_bank: of_status("table_bank")?,
            });
        }
        Ok(InlineStatus {
            run: self.flag("status", "run", status)?,
            settled: self.flag("status", "settled", status)?,
            bypassed: self.flag("status", "bypassed", status)?,
            bypass_requested: self.flag("bypass", "bypass_request", bypass)?,
            fault: self.flag("status", "fault", status)?,
            axes,
        })
    }

    /// Asks for no shaping, or withdraws the request, and waits until it holds: for as long as axes that stand need to be settled.
    ///
    /// # Errors
    /// [`HostError::Bypass`] if it does not hold in time, because an axis moves or the pin asks for no shaping. The request stays.
    pub fn bypass(&mut self, on: bool) -> Result<(), HostError> {
        let field = self.registers.register("bypass")?.fields.first();
        let word = field.map_or(1, |field| field.mask());
        self.registers
            .write(&[("bypass".to_owned(), if on { word } else { 0 })])?;
        let settle = (0..self.machine().axes.len())
            .map(|axis| self.registers.register(&self.registers.of(axis, "settle_ticks")));
        let settle = settle.collect::<Result<Vec<_>, _>>()?;
        let longest = settle.iter().map(|register| register.reset()).max().unwrap_or(0);
        let mut left = self.registers.patience(longest.saturating_add(PATIENCE_TICKS))?;
        loop {
            let words = self.registers.read(&["status".to_owned()])?;
            let status = words.first().copied().unwrap_or(0);
            if self.flag("status", "bypassed", status)? == on {
                return Ok(());
            }
            if !self.registers.pass(&mut left)? {
                return Err(HostError::Bypass {
                    wanted: if on { "end" } else { "begin" },
                    remedy: if on {
                        "let the controller stand"
                    } else {
                        "let the controller stand, and set the pin `bypass` low"
                    },
                });
            }
        }
    }

    /// Loads a table into the unused bank, reads it back, and hands over to it; the axis may stand or move. Returns the bank.
    ///
    /// # Errors
    /// Those of [`HostedStage::load_table`].
    pub fn load_table(&mut self, axis: usize, table: &TapTable) -> Result<u32, HostError> {
        self.registers.load_table(axis, table)
    }

    /// Reads the table in a bank: 0 is the machine's, 1 and 2 can be loaded.
    ///
    /// # Errors
    /// Those of [`HostedStage::read_table`].
    pub fn read_table(&mut self, axis: usize, bank: u32) -> Result<Vec<Tap>, HostError> {
        self.registers.read_table(axis, bank)
    }

    /// Records positions of an axis until its memory is full, and reads it. The recording begins immediately; the axes do what their
    /// controller wants meanwhile.
    ///
    /// # Errors
    /// [`HostError`]; [`HostError::Trace`] for a request that the hardware cannot fulfil: it makes no test signal.
    pub fn trace(&mut self, request: &TraceRequest) -> Result<RecordedTrace, HostError> {
        if request.shake.is_some() {
            return Err(HostError::Trace("an inline shaper makes no test signal".to_owned()));
        }
        self.registers.trace_while(request, |_| Ok(()))
    }
}
