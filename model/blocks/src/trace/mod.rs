//! The trace memory records up to four signals of an axis, tick by tick, around a trigger.
//!
//! The datasheet is `docs/trace.md`; the hardware is compared with this reference model.
//!
//! ```text
//! arm ─► filling: pre_trigger rows ─► waiting: the newest pre_trigger rows ─► taking: the trigger's row and the rest ─► idle
//!                                                                     trigger ┘
//! ```
//!
//! - A row holds the selected signals at one strobe. The first strobe gives a row, and then every (`decimation` +
//!   1)th.
//! - The memory has `samples` words, so a trace has `samples`, `samples / 2` or `samples / 4` rows of 1, 2 or 4 signals.
//! - The words of a trace are in order of time, row by row; they can be read when it is over.
//!
//! A row takes [`row_clocks`] clocks:
//!
//! ```text
//! clock     0    1         2         3    …  2 + signals  3 + signals
//! strobe   ‾‾\________________________________________________________
//!               trigger's  compared  first    last        rows is up, a strobe may come
//!               signal               word     word
//! ```
//!
//! ```
//! use posicast_blocks::trace::{Inputs, TraceState, Trace, TraceConfig};
//!
//! // A ramp on signal 5, taken from 100 rows before it passes 1000.
//! let mut trace = Trace::new(&TraceConfig::new(256)?);
//! let settings = Inputs {
//!     select_0: 5,
//!     trigger_select: 5,
//!     trigger_mode: 1,
//!     trigger_level: 1000,
//!     pre_trigger: 100,
//!     ..Inputs::default()
//! };
//! trace.step(&Inputs { arm: true, ..settings });
//! for tick in 0..2000 {
//!     let now = Inputs { signal: [tick; 16], ..settings };
//!     trace.step(&Inputs { strobe: true, ..now });
//!     trace.hold(&now, 20);
//! }
//! let shown = trace.outputs();
//! assert_eq!((shown.state, shown.rows, shown.trigger_row), (TraceState::Idle, 256, 100));
//! let word = |read_address| Inputs { read_address, ..settings };
//! trace.step(&word(100));
//! assert_eq!(trace.step(&word(255)).data, 1000);
//! assert_eq!(trace.outputs().data, 1155);
//! # Ok::<(), posicast_blocks::trace::TraceConfigError>(())
//! ```

mod config;
mod ports;

pub use config::{ROW_SIGNALS, SAMPLES, SIGNALS, TraceConfig, TraceConfigError, row_clocks, row_signals};
pub use ports::{INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, TraceState, ports};

use std::collections::VecDeque;

use super::{FOREVER, Moore, clocked_block, show_each};

/// Phase of a row.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Phase {
    /// Waits for a strobe.
    #[default]
    Ready,
    /// Takes the signal that the trigger compares.
    TakeTrigger,
    /// Compares it, and takes the row's first signal.
    Compare,
    /// Stores this word of the row, and takes the next.
    Store(u8),
}

/// All registers except the words.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Registers {
    active: bool,
    triggered: bool,
    halting: bool,
    phase: Phase,
    /// Value of the port `signals` at `arm`.
    signals: u8,
    /// Number of rows before the trigger.
    pre_trigger: u16,
    /// Number of strobes still to skip.
    skip: u16,
    /// Signal that the next clock takes.
    select: u8,
    /// Value of the signal that was taken in the clock before.
    taken: i32,
    /// Whether the trigger's signal was at or above the level in the row before; `None` without such a row.
    was_above: Option<bool>,
    event: bool,
    data: u32,
    missed: bool,
    done: bool,
}

/// The cycle-accurate model of the trace memory.
///
/// The words are kept in order of time. The hardware's memory is a ring with arbitrary words where nothing was
/// written, but this does not show at the ports.
#[derive(Debug, Clone)]
pub struct Trace {
    config: TraceConfig,
    registers: Registers,
    /// Words of complete rows, the oldest first.
    words: VecDeque<u32>,
    /// Words of the row that is being recorded.
    row: [u32; ROW_SIGNALS],
}

impl Trace {
    /// A trace memory after reset.
    pub fn new(config: &TraceConfig) -> Self {
        Self {
            config: *config,
            registers: Registers::default(),
            words: VecDeque::with_capacity(config.samples() as usize + ROW_SIGNALS),
            row: [0; ROW_SIGNALS],
        }
    }

    /// Its build parameters.
    pub fn config(&self) -> &TraceConfig {
        &self.config
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        let registers = &self.registers;
        let state = match (registers.active, registers.triggered) {
            (false, _) => TraceState::Idle,
            (true, true) => TraceState::Taking,
            (true, false) if self.waits() => TraceState::Waiting,
            (true, false) => TraceState::Filling,
        };
        Outputs {
            data: registers.data,
            state,
            rows: self.rows(),
            trigger_row: registers.pre_trigger,
            missed: registers.missed,
            done: registers.done,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs();
        self.clock(inputs);
        outputs
    }

    /// Simulates this many clocks with the same inputs. It ends early once a clock changes nothing, since no later
    /// one would.
    pub fn hold(&mut self, inputs: &Inputs, clocks: u64) {
        for _ in 0..clocks {
            let before = self.registers;
            self.clock(inputs);
            if self.registers == before {
                return;
            }
        }
    }

    fn rows(&self) -> u16 {
        (self.words.len() / row_signals(self.registers.signals)) as u16
    }

    /// Whether the rows before the trigger are complete and the trigger has not come.
    fn waits(&self) -> bool {
        !self.registers.triggered && self.rows() == self.registers.pre_trigger
    }

    /// The word at an address.
    fn read(&self, address: u16) -> u32 {
        let word = self.words.get(usize::from(address & 0x7ff));
        word.copied().filter(|_| !self.registers.active).unwrap_or(0)
    }

    fn clock(&mut self, inputs: &Inputs) {
        if inputs.rst {
            self.registers = Registers::default();
            self.words.clear();
            return;
        }
        let data = self.read(inputs.read_address);
        if inputs.arm {
            self.arm(inputs);
        } else {
            self.advance(inputs);
        }
        self.registers.data = data;
    }

    fn arm(&mut self, inputs: &Inputs) {
        let last_row = self.config.rows(inputs.signals) - 1;
        self.words.clear();
        self.registers = Registers {
            active: true,
            signals: inputs.signals,
            pre_trigger: (inputs.pre_trigger & 0x7ff).min(last_row as u16),
            ..Registers::default()
        };
    }

    fn advance(&mut self, inputs: &Inputs) {
        let complete = usize::from(self.rows()) == self.config.rows(self.registers.signals);
        let registers = &mut self.registers;
        let ends = complete || registers.halting;
        let phase = registers.phase;
        registers.done = false;
        registers.missed |= inputs.strobe && registers.active && phase != Phase::Ready;
        registers.halting |= inputs.halt;
        let event = registers.event;
        registers.event |= inputs.trigger_event;
        let taken = inputs.signal[usize::from(registers.select & 15)];
        registers.select = match phase {
            Phase::Ready => inputs.trigger_select,
            Phase::TakeTrigger => inputs.select_0,
            Phase::Compare => inputs.select_1,
            Phase::Store(0) => inputs.select_2,
            Phase::Store(_) => inputs.select_3,
        };
        match phase {
            Phase::Ready if !registers.active => {}
            Phase::Ready if ends => {
                registers.active = false;
                registers.done = complete;
            }
            Phase::Ready if !inputs.strobe => {}
            Phase::Ready if registers.skip > 0 => registers.skip -= 1,
            Phase::Ready => {
                registers.skip = inputs.decimation;
                registers.phase = Phase::TakeTrigger;
            }
            Phase::TakeTrigger => {
                registers.taken = taken;
                registers.phase = Phase::Compare;
            }
            Phase::Compare => {
                registers.event = inputs.trigger_event;
                self.compare(inputs, event);
                self.registers.taken = taken;
                self.registers.phase = Phase::Store(0);
            }
            Phase::Store(word) => {
                let place = usize::from(word);
                self.row[place] = registers.taken as u32;
                if place + 1 == row_signals(registers.signals) {
                    registers.phase = Phase::Ready;
                    self.add_row();
                } else {
                    registers.taken = taken;
                    registers.phase = Phase::Store(word + 1);
                }
            }
        }
    }

    /// Compares the trigger's signal for this row.
    fn compare(&mut self, inputs: &Inputs, event: bool) {
        let waits = self.waits();
        let registers = &mut self.registers;
        let above = registers.taken >= inputs.trigger_level;
        let comes = match (inputs.trigger_mode & 3, registers.was_above) {
            (0, _) => true,
            (1, was) => was == Some(false) && above,
            (2, was) => was == Some(true) && !above,
            _ => event,
        };
        registers.was_above = Some(above);
        registers.triggered |= waits && comes;
    }

    /// Adds a complete row; while waiting for the trigger the oldest one is dropped.
    fn add_row(&mut self) {
        let waits = self.waits();
        let signals = row_signals(self.registers.signals);
        self.words.extend(&self.row[..signals]);
        if waits {
            self.words.drain(..signals);
        }
    }
}

clocked_block!(Trace, "the trace memory");

impl Moore for Trace {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let Ok(raw) = <&[u64; INPUT_PORTS]>::try_from(inputs) else {
            return 0;
        };
        let (inputs, registers) = (Inputs::from_raw(raw), &self.registers);
        let called = inputs.rst || inputs.strobe || inputs.arm || registers.phase != Phase::Ready || registers.done;
        let complete = usize::from(self.rows()) == self.config.rows(registers.signals);
        let ends = registers.active && (complete || registers.halting);
        let noted = (!inputs.halt || registers.halting) && (!inputs.trigger_event || registers.event);
        let chosen = registers.select == inputs.trigger_select && registers.data == self.read(inputs.read_address);
        if called || ends || !noted || !chosen {
            0
        } else {
            FOREVER
        }
    }

    /// Inputs that are read only in the clocks of a row.
    fn ignores(&self, input: &str) -> bool {
        let settings = ["signals", "decimation", "trigger_mode", "trigger_level", "pre_trigger"];
        input.starts_with("signal_") || input.starts_with("select_") || settings.contains(&input)
    }
}
