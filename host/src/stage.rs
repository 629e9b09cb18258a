//! A stage at the other end of the link: its identity, the state of its axes, and how they are switched on and off.

use std::io::{Read, Write};

use posicast_blocks::axis::{Cause, KICK, SupervisorState};
use posicast_blocks::inline_shaper::INLINE_SHAPER;
use posicast_blocks::registers::{Access, Field, Register, RegisterMap};
use posicast_machine::hardware::StageHardware;
use posicast_machine::machine_file::{AxisSection, Machine};

use crate::{HostError, Link};

/// Ticks for which a change of state is awaited, beyond the times of brakes.
pub(crate) const PATIENCE_TICKS: u32 = 2000;
/// Number of reads after which time that stands still means that the stage has no clock.
const STILL_LOOKS: u32 = 8;
/// Causes that every stage has after a reset: they are cleared without a request.
pub(crate) const AFTER_RESET: u32 = Cause::PwmTripped.bit() | Cause::GroupStop.bit();

/// A stage, and the machine that it was made for.
#[derive(Debug)]
pub struct HostedStage<'m, L> {
    pub(crate) link: Link<L>,
    pub(crate) machine: &'m Machine,
    map: &'m RegisterMap,
}

/// The state of an axis. Positions are in counts of its loop since the stage's reset.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisStatus {
    /// Name of the axis.
    pub axis: String,
    /// State of its supervisor; `None` for a number that this version does not know.
    pub state: Option<SupervisorState>,
    /// Causes of a fault or a stop, one bit each; see [`causes`].
    pub causes: u32,
    /// Whether a start would lead to RUN.
    pub can_start: bool,
    /// Whether it was homed.
    pub homed: bool,
    /// Position since reset, minus the origin, in counts.
    pub position: f64,
    /// Velocity of the motor in counts per tick.
    pub velocity: f64,
    /// Command before the shaper.
    pub command: f64,
    /// Command after the shaper.
    pub shaped: f64,
    /// Difference of command and position; with steps, those that are owed.
    pub error: f64,
    /// Entries that wait.
    pub waiting: u32,
    /// Active tap table: 0 is the machine's, 1 and 2 are loaded ones.
    pub table_bank: u32,
}

/// Names of the causes in a word of causes.
pub fn causes(word: u32) -> Vec<&'static str> {
    let set = Cause::ALL.into_iter().filter(|cause| word & cause.bit() != 0);
    set.map(Cause::name).collect()
}

/// The time left for a wait, in ticks of the stage.
pub(crate) struct Patience {
    from: u32,
    ticks: u32,
    stamp: u32,
    still: u32,
}

impl<'m, L: Read + Write> HostedStage<'m, L> {
    /// Identifies the stage at the other end, and accepts only that of this machine file.
    ///
    /// # Errors
    /// [`HostError`] if there is no stage, or one with another version of the registers or of another machine, with the values found and
    /// expected.
    pub fn open(link: Link<L>, machine: &'m Machine, stage: &'m StageHardware) -> Result<Self, HostError> {
        Self::with_map(link, machine, stage.component.map())
    }

    /// The hardware with these registers, which also an inline shaper has.
    pub(crate) fn with_map(link: Link<L>, machine: &'m Machine, map: &'m RegisterMap) -> Result<Self, HostError> {
        let mut opened = Self { link, machine, map };
        opened.check()?;
        Ok(opened)
    }

    fn check(&mut self) -> Result<(), HostError> {
        let map = self.map;
        let constants: Vec<&Register> = map
            .registers()
            .iter()
            .take_while(|own| own.access == Access::Constant)
            .collect();
        let words = self.link.read(0, constants.len() as u16)?;
        let pairs = |name: &str| {
            let place = constants.iter().position(|register| register.name == name)?;
            Some((words[place], constants[place].reset()))
        };
        if let Some((found, expected)) = pairs("magic")
            && found != expected
        {
            return Err(match map.name() {
                INLINE_SHAPER => HostError::NoInlineShaper { found },
                _ => HostError::NoStage { found },
            });
        }
        if let Some((found, expected)) = pairs("version")
            // A larger minor version has registers that this one does not use.
            && (found >> 16 != expected >> 16 || found < expected)
        {
            return Err(HostError::Version { found, expected });
        }
        if let Some((found, expected)) = pairs("machine_crc")
            && found != expected
        {
            return Err(HostError::Machine { found, expected });
        }
        for (register, found) in constants.iter().zip(&words).skip(2) {
            if *found != register.reset() {
                return Err(HostError::Constant {
                    register: register.name.to_uppercase(),
                    found: *found,
                    expected: register.reset(),
                });
            }
        }
        Ok(())
    }

    /// The machine file of the stage.
    pub fn machine(&self) -> &'m Machine {
        self.machine
    }

    /// The link.
    pub fn link(&self) -> &Link<L> {
        &self.link
    }

    /// Returns the link.
    pub fn into_link(self) -> Link<L> {
        self.link
    }

    pub(crate) fn axis(&self, axis: usize) -> &'m AxisSection {
        &self.machine.axes[axis]
    }

    /// Name of an axis's register.
    pub(crate) fn of(&self, axis: usize, register: &str) -> String {
        format!("{}_{register}", self.axis(axis).name)
    }

    pub(crate) fn register(&self, name: &str) -> Result<&'m Register, HostError> {
        let found = self.map.register(name);
        found.ok_or_else(|| HostError::NoRegister(name.to_uppercase()))
    }

    pub(crate) fn address(&self, name: &str) -> Result<u16, HostError> {
        // All windows of a stage lie below 2^11.
        Ok(self.register(name)?.offset as u16)
    }

    /// A field of an axis's register; names are without the axis.
    pub(crate) fn field(&self, axis: usize, register: &str, field: &str) -> Result<&'m Field, HostError> {
        self.stage_field(&self.of(axis, register), &self.of(axis, field))
    }

    /// A field of a register of the stage's own window.
    pub(crate) fn stage_field(&self, register: &str, field: &str) -> Result<&'m Field, HostError> {
        let fields = self.map.fields(self.register(register)?);
        let found = fields.iter().find(|other| other.name == field);
        found.ok_or_else(|| HostError::NoRegister(format!("{}.{field}", register.to_uppercase())))
    }

    pub(crate) fn read(&mut self, names: &[String]) -> Result<Vec<u32>, HostError> {
        let addresses: Result<Vec<u16>, HostError> = names.iter().map(|name| self.address(name)).collect();
        Ok(self.link.read_list(&addresses?)?)
    }

    pub(crate) fn read_one(&mut self, axis: usize, register: &str) -> Result<u32, HostError> {
        let words = self.read(&[self.of(axis, register)])?;
        Ok(words.first().copied().unwrap_or(0))
    }

    /// Writes registers in this order, in requests of at most 40 words.
    pub(crate) fn write(&mut self, words: &[(String, u32)]) -> Result<(), HostError> {
        let pairs: Result<Vec<(u16, u32)>, HostError> = words
            .iter()
            .map(|(name, word)| Ok((self.address(name)?, *word)))
            .collect();
        for part in pairs?.chunks(posicast_blocks::link::MOST_WORDS.into()) {
            self.link.write_list(part)?;
        }
        Ok(())
    }

    pub(crate) fn write_one(&mut self, axis: usize, register: &str, word: u32) -> Result<(), HostError> {
        self.write(&[(self.of(axis, register), word)])
    }

    /// Reads the state of all axes; writes nothing.
    ///
    /// # Errors
    /// [`HostError`]
    pub fn status(&mut self) -> Result<Vec<AxisStatus>, HostError> {
        const WORDS: [&str; 7] = [
            "status",
            "causes",
            "position",
            "velocity",
            "command_position",
            "shaped_position",
            "fifo",
        ];
        let mut all = Vec::new();
        for (axis, section) in self.machine.axes.iter().enumerate() {
            let with_steps = section.steps.is_some();
            let behind = if with_steps { "owed_steps" } else { "error" };
            let names: Vec<String> = WORDS.iter().chain([&behind]).map(|word| self.of(axis, word)).collect();
            let words = self.read(&names)?;
            let [status, causes, position, velocity, command, shaped, fifo, behind] = words[..] else {
                continue;
            };
            let of_status = |stage: &Self, field| Ok::<u32, HostError>(stage.field(axis, "status", field)?.of(status));
            let signed = |word: u32, fraction: u32| f64::from(word as i32) / f64::from(1u32 << fraction);
            all.push(AxisStatus {
                axis: section.name.clone(),
                state: SupervisorState::from_value(of_status(self, "state")?.into()),
                causes,
                can_start: of_status(self, "can_start")? != 0,
                homed: of_status(self, "homed")? != 0,
                position: signed(position, 0),
                velocity: signed(velocity, 16),
                command: signed(command, 8),
                shaped: signed(shaped, 8),
                error: if with_steps {
                    f64::from(behind as u16 as i16)
                } else {
                    signed(behind, 16)
                },
                waiting: self.field(axis, "fifo", "fifo_level")?.of(fifo),
                table_bank: of_status(self, "table_bank")?,
            });
        }
        Ok(all)
    }

    /// Kicks the watchdogs of all axes that have one, to show that this host is alive.
    ///
    /// # Errors
    /// [`HostError`]
    pub fn kick(&mut self) -> Result<(), HostError> {
        let kicks = (0..self.machine.axes.len()).map(|axis| (self.of(axis, "kick"), KICK));
        let words: Vec<(String, u32)> = kicks.filter(|(name, _)| self.map.register(name).is_some()).collect();
        self.write(&words)
    }

    /// The bank that an axis's shaper uses.
    pub(crate) fn table_bank(&mut self, axis: usize) -> Result<u32, HostError> {
        let status = self.read_one(axis, "status")?;
        Ok(self.field(axis, "status", "table_bank")?.of(status))
    }

    fn time(&mut self) -> Result<[u32; 2], HostError> {
        let words = self.read(&["tick_count".to_owned(), "time_stamp".to_owned()])?;
        Ok([0, 1].map(|place| words.get(place).copied().unwrap_or(0)))
    }

    pub(crate) fn patience(&mut self, ticks: u32) -> Result<Patience, HostError> {
        let [from, stamp] = self.time()?;
        Ok(Patience {
            from,
            ticks,
            stamp,
            still: 0,
        })
    }

    /// Kicks the watchdogs; returns whether there is time left.
    pub(crate) fn pass(&mut self, left: &mut Patience) -> Result<bool, HostError> {
        self.kick()?;
        let [tick, stamp] = self.time()?;
        left.still = if stamp == left.stamp { left.still + 1 } else { 0 };
        left.stamp = stamp;
        if left.still < STILL_LOOKS {
            Ok(tick.wrapping_sub(left.from) <= left.ticks)
        } else {
            Err(HostError::Standstill)
        }
    }

    /// Waits for this many ticks.
    pub(crate) fn rest(&mut self, ticks: u32) -> Result<(), HostError> {
        let mut left = self.patience(ticks)?;
        while self.pass(&mut left)? {}
        Ok(())
    }

    /// Waits until `done` holds for each of these axes. A cause of any of them is an error.
    pub(crate) fn wait(
        &mut self,
        axes: &[usize],
        (wanted, ticks): (&'static str, u32),
        done: impl Fn(&AxisStatus) -> bool,
    ) -> Result<(), HostError> {
        let mut left = self.patience(ticks)?;
        loop {
            let all = self.status()?;
            let mut chosen = axes.iter().map(|axis| &all[*axis]);
            if let Some(status) = chosen.clone().find(|status| status.causes != 0) {
                return Err(fault(status));
            }
            let Some(waits) = chosen.find(|status| !done(status)).cloned() else {
                return Ok(());
            };
            if !self.pass(&mut left)? {
                return Err(HostError::Late {
                    axis: waits.axis,
                    wanted,
                    state: waits.state.map_or("an unknown state", SupervisorState::name),
                });
            }
        }
    }

    /// Ticks until a brake is open or applied, with a margin.
    fn brake_ticks(&self, axes: &[usize]) -> u32 {
        let limits = axes.iter().filter_map(|axis| self.axis(*axis).limits);
        let longest_s = limits
            .map(|limits| limits.brake_release_s.max(limits.brake_apply_s))
            .fold(0.0, f64::max);
        (longest_s * self.machine.clock.sample_hz) as u32 + PATIENCE_TICKS
    }

    /// Switches these axes on; axes in HOLD stay there. Causes that a reset leaves behind are cleared; faults are cleared only with
    /// `clears_faults`.
    ///
    /// # Errors
    /// [`HostError::Fault`] for a fault, [`HostError::Busy`] for an axis that moves, other errors for an axis that does not become ready in
    /// time.
    pub fn switch_on(&mut self, axes: &[usize], clears_faults: bool) -> Result<(), HostError> {
        let all = self.status()?;
        let mut off = Vec::new();
        for axis in axes {
            let status = &all[*axis];
            match status.state {
                Some(SupervisorState::Run | SupervisorState::QuickStop) => {
                    return Err(HostError::Busy(status.axis.clone()));
                }
                // Waiting entries of a previous host would be played before those of this one.
                Some(SupervisorState::Hold) if status.causes & !Cause::GroupStop.bit() == 0 && status.waiting == 0 => {}
                _ if status.causes & !AFTER_RESET != 0 && !clears_faults => return Err(fault(status)),
                _ => off.push(*axis),
            }
        }
        // READY must see `enable` low first, so that an axis whose fault is cleared does not switch on by itself.
        self.enable(&off, false)?;
        let ticks = self.brake_ticks(axes);
        let mut left = self.patience(ticks)?;
        loop {
            let all = self.status()?;
            let waiting = off.iter().map(|axis| &all[*axis]);
            let mut waiting = waiting.filter(|status| status.state != Some(SupervisorState::Ready));
            let Some(first) = waiting.next().cloned() else {
                break;
            };
            for axis in &off {
                self.write_one(*axis, "clear_faults", 0)?;
            }
            if !self.pass(&mut left)? {
                return Err(match first.causes {
                    0 => HostError::Late {
                        axis: first.axis,
                        wanted: "become ready",
                        state: first.state.map_or("an unknown state", SupervisorState::name),
                    },
                    _ => fault(&first),
                });
            }
        }
        // An axis in HOLD may still have the group stop of another.
        for axis in axes {
            self.write_one(*axis, "clear_faults", 0)?;
        }
        self.enable(&off, true)?;
        self.wait(axes, ("come to HOLD with its brake open", ticks), |status| {
            status.can_start
        })
    }

    fn enable(&mut self, axes: &[usize], on: bool) -> Result<(), HostError> {
        for axis in axes {
            let word = self.read_one(*axis, "control")?;
            let [enable, direct] = ["enable", "direct_enable"].map(|name| self.field(*axis, "control", name));
            // An axis with steps has no direct mode.
            let (enable, direct) = (enable?.mask(), direct.map_or(0, |field| field.mask()));
            self.write_one(
                *axis,
                "control",
                if on { word | enable } else { word & !(enable | direct) },
            )?;
        }
        Ok(())
    }

    /// Switches these axes off: after a quick stop and the brake.
    ///
    /// # Errors
    /// [`HostError`]; a fault is not an error here, because it has already switched the outputs off.
    pub fn switch_off(&mut self, axes: &[usize]) -> Result<(), HostError> {
        self.enable(axes, false)?;
        let mut left = self.patience(self.brake_ticks(axes))?;
        loop {
            let all = self.status()?;
            let on = axes.iter().map(|axis| &all[*axis]).find(|status| {
                !matches!(
                    status.state,
                    Some(SupervisorState::Off | SupervisorState::Ready | SupervisorState::Fault)
                )
            });
            let Some(on) = on.cloned() else {
                return Ok(());
            };
            if !self.pass(&mut left)? {
                return Err(HostError::Late {
                    axis: on.axis,
                    wanted: "switch off",
                    state: on.state.map_or("an unknown state", SupervisorState::name),
                });
            }
        }
    }
}

pub(crate) fn fault(status: &AxisStatus) -> HostError {
    HostError::Fault {
        axis: status.axis.clone(),
        state: status.state.map_or("an unknown state", SupervisorState::name),
        causes: causes(status.causes).join(", "),
    }
}
