//! The command FIFO: segments of constant jerk, integrated exactly, tick by tick.
//!
//! The datasheet is `docs/segments.md`; the hardware is compared with this reference model.
//!
//! | part | what it is |
//! |---|---|
//! | [`Entry`] | what a host writes: a segment `{ticks, jerk}`, a point held for some ticks, or a cubic |
//! | [`Integrator`] | `a += j; v += a; p += v`, the extrapolation where entries are missing, and the quick stop |
//! | [`Segments`] | FIFO, states and integrator, cycle accurate at its ports |
//!
//! A tick always takes [`TICK_CLOCKS`] clocks:
//!
//! ```text
//! phase   0            1 … 43    44                       45 … 51
//!         tick taken   a, v, p   rounded, what comes next read an entry's ticks, if one is next
//! ```
//!
//! ```
//! use posicast_blocks::segments::{Entry, Inputs, EntryMotion, Segments, SegmentsState};
//!
//! // There and back in 4 ticks of jerk j, −j, −j, j: it ends at rest, 2·j further.
//! let jerk = 1i64 << 32;
//! let mut segments = Segments::new(1);
//! for (ticks, jerk) in [(1, jerk), (2, -jerk), (1, jerk)] {
//!     let entry = Entry { ticks, motion: EntryMotion::Jerk(jerk), notify: false };
//!     for (word, data) in (0..).zip(entry.words()) {
//!         segments.step(&Inputs { write: true, word, data, ..Inputs::default() });
//!     }
//! }
//! for _ in 0..6 {
//!     segments.step(&Inputs { tick: true, enable: true, ..Inputs::default() });
//!     segments.hold(&Inputs { enable: true, ..Inputs::default() }, 100);
//! }
//! let shown = segments.outputs(0);
//! assert_eq!((shown.position, shown.velocity, shown.state), (2 << 8, 0, SegmentsState::Hold));
//! ```

mod entry;
mod fifo;
mod integrator;
mod ports;

pub use entry::{
    ACCELERATION_BITS, CUBIC, CubicEntry, ENTRY_WORDS, Entry, EntryMotion, MORE, NOTIFY, POINT, Point, RESERVED,
    TICK_BITS,
};
pub use fifo::ENTRIES_MAX;
pub use integrator::{
    ACCELERATION_FRACTION, FRACTION_BITS, Integrator, Overflow, POSITION_FRACTION, REACH_COUNTS, STAND_COUNTS,
    VELOCITY_BITS, VELOCITY_FRACTION,
};
pub use ports::{INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, SegmentsState, ports};

use self::fifo::{Fifo, Pointers};
use super::{FOREVER, Moore, OutputKind, clocked_block, show_each};

/// Clocks from a tick until the next one is accepted.
pub const TICK_CLOCKS: u32 = 52;
/// Clocks from a tick to `valid`.
pub const LATENCY_CLOCKS: u32 = 45;

/// Phase that waits for a tick.
const IDLE: u8 = 0;
/// Phase in which the integration begins; the hardware computes its sums, a byte per clock, until the next phase.
const INTEGRATE: u8 = 1;
/// Phase that rounds and decides what comes next.
const DECIDE: u8 = LATENCY_CLOCKS as u8 - 1;
/// Phase that reads the last word of the next entry.
const READ: u8 = TICK_CLOCKS as u8 - 1;

/// Requests that wait for the next tick.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Requests {
    flush: bool,
    quick_stop: bool,
    restart: bool,
    preset: bool,
}

impl Requests {
    /// Adds the requests of a clock.
    fn with(self, inputs: &Inputs) -> Self {
        Self {
            flush: self.flush || inputs.flush,
            quick_stop: self.quick_stop || inputs.quick_stop,
            restart: self.restart || inputs.restart,
            preset: self.preset || inputs.preset,
        }
    }
}

/// All registers except the FIFO.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Registers {
    phase: u8,
    requests: Requests,
    enabled: bool,
    /// Deceleration as of the clock of the tick; 0 beyond [`STAND_COUNTS`].
    stop_deceleration: u32,
    at: Integrator,
    overflowed: bool,
    playing: Option<Entry>,
    /// The entry that plays has not begun.
    is_first: bool,
    /// The entry that plays has ended, and none came: so many ticks that were played since.
    extrapolated: Option<u8>,
    shown: Outputs,
}

/// The cycle-accurate model of the command FIFO.
pub struct Segments {
    fifo: Fifo,
    registers: Registers,
}

impl Segments {
    /// A FIFO after reset. `seed` fills its memory; no output may depend on these initial contents.
    pub fn new(seed: u64) -> Self {
        Self {
            fifo: Fifo::new(seed),
            registers: Registers::default(),
        }
    }

    /// The outputs in this clock, for this `low_water`.
    pub fn outputs(&self, low_water: u8) -> Outputs {
        let level = self.fifo.level();
        Outputs {
            level,
            low: level <= low_water,
            empty: level == 0,
            ..self.registers.shown
        }
    }

    /// The exact command; the outputs are rounded from it.
    pub fn command(&self) -> Integrator {
        self.registers.at
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs(inputs.low_water);
        self.clock(inputs);
        outputs
    }

    /// Simulates this many clocks with the same inputs. It ends early once a clock changes nothing, since no later
    /// one would.
    pub fn hold(&mut self, inputs: &Inputs, clocks: u64) {
        for _ in 0..clocks {
            let before: (Registers, Pointers) = (self.registers.clone(), self.fifo.pointers);
            self.clock(inputs);
            if self.registers == before.0 && self.fifo.pointers == before.1 {
                return;
            }
        }
    }

    fn clock(&mut self, inputs: &Inputs) {
        if inputs.rst {
            self.registers = Registers::default();
            self.fifo.reset();
            return;
        }
        let Registers { phase, shown, .. } = self.registers;
        let level = self.fifo.level();
        self.begin_clock(inputs);
        if inputs.write {
            let closed = matches!(shown.state, SegmentsState::Stop | SegmentsState::Stopped);
            let plays = shown.state == SegmentsState::Move;
            let written = self.fifo.write(inputs.word, inputs.data, closed, plays);
            self.registers.shown.refused |= written.refused;
            self.registers.shown.malformed |= written.malformed;
        }
        self.registers.phase = match phase {
            IDLE if !inputs.tick => IDLE,
            READ => IDLE,
            _ => phase + 1,
        };
        match phase {
            IDLE if inputs.tick => self.take_tick(inputs),
            INTEGRATE => self.integrate(),
            DECIDE => self.decide(shown.state, level > 0, inputs),
            _ => {}
        }
    }

    /// Ends pulses, clears and sets flags, and stores requests.
    fn begin_clock(&mut self, inputs: &Inputs) {
        let Registers {
            phase, requests, shown, ..
        } = &mut self.registers;
        (shown.valid, shown.notify, shown.done) = (false, false, false);
        if inputs.clear_flags {
            (shown.underrun, shown.overflow, shown.refused) = (false, false, false);
            (shown.malformed, shown.tick_missed) = (false, false);
            shown.out_of_range = false;
        }
        shown.tick_missed |= inputs.tick && *phase != IDLE;
        *requests = requests.with(inputs);
    }

    /// Begins a tick with the requests since the last one. A preset has priority over a quick stop, and that over a
    /// restart.
    fn take_tick(&mut self, inputs: &Inputs) {
        let requests = std::mem::take(&mut self.registers.requests);
        let registers = &mut self.registers;
        registers.enabled = inputs.enable;
        let stands = !inputs.modulo && registers.at.leaves(STAND_COUNTS);
        registers.stop_deceleration = if stands { 0 } else { inputs.stop_deceleration };
        let Outputs { state, rests, held, .. } = &mut registers.shown;
        *held = inputs.feed_hold && *rests && *state == SegmentsState::Move;
        let mut flush = requests.flush;
        if requests.preset {
            registers.at = Integrator::resting_at(inputs.preset_position);
            (*state, *held) = (SegmentsState::Hold, false);
        } else {
            let stops = requests.quick_stop || (!inputs.enable && *state == SegmentsState::Move);
            match *state {
                SegmentsState::Move if stops => (*state, flush, *held) = (SegmentsState::Stop, true, false),
                SegmentsState::Hold if stops => (*state, flush) = (SegmentsState::Stopped, true),
                SegmentsState::Stopped if requests.restart && !stops => *state = SegmentsState::Hold,
                _ => {}
            }
        }
        if requests.preset {
            self.fifo.begin_anew();
        } else if flush {
            self.fifo.flush();
        }
    }

    fn integrate(&mut self) {
        let Registers {
            at,
            playing,
            is_first,
            extrapolated,
            shown,
            overflowed,
            stop_deceleration,
            ..
        } = &mut self.registers;
        *overflowed = false;
        match (shown.state, playing) {
            _ if shown.held => {}
            (SegmentsState::Move, _) if extrapolated.is_some() => at.extrapolate(),
            (SegmentsState::Move, Some(entry)) => {
                *overflowed = at.play(&entry.motion, *is_first).is_err();
                *is_first = false;
            }
            (SegmentsState::Stop, _) => {
                at.stop(i64::from(*stop_deceleration) << (FRACTION_BITS - ACCELERATION_FRACTION))
            }
            _ => {}
        }
    }

    /// Sets the outputs of this tick, and decides what the next one does.
    fn decide(&mut self, state: SegmentsState, entry_waits: bool, inputs: &Inputs) {
        let Registers {
            phase,
            at,
            playing,
            is_first,
            extrapolated,
            shown,
            enabled,
            overflowed,
            ..
        } = &mut self.registers;
        [shown.position, shown.velocity, shown.acceleration] = at.rounded();
        shown.valid = true;
        shown.rests = at.at_rest();
        let mut next_is_read = false;
        let leaves = !inputs.modulo && at.leaves(REACH_COUNTS) && !at.at_rest();
        match (state, playing.as_mut()) {
            _ if shown.held => {}
            (SegmentsState::Move, Some(entry)) => {
                let passed = extrapolated.map(|ticks| ticks + 1);
                entry.ticks = entry.ticks.saturating_sub(1);
                let ended = entry.ticks == 0;
                shown.notify = ended && passed.is_none() && entry.notify && !*overflowed && !leaves;
                let is_missing = ended && !entry_waits && !at.at_rest();
                if *overflowed || leaves || (is_missing && passed.unwrap_or(0) >= inputs.extrapolation) {
                    shown.overflow |= *overflowed;
                    shown.out_of_range |= !*overflowed && leaves;
                    shown.underrun |= !*overflowed && !leaves;
                    shown.state = SegmentsState::Stop;
                    self.fifo.flush();
                } else if is_missing {
                    *extrapolated = Some(passed.unwrap_or(0));
                    shown.late_ticks = shown.late_ticks.wrapping_add(1);
                } else if ended && entry_waits {
                    next_is_read = true;
                } else if ended {
                    shown.state = SegmentsState::Hold;
                    shown.done = true;
                }
            }
            (SegmentsState::Stop, _) if at.at_rest() => {
                shown.state = SegmentsState::Stopped;
                shown.done = true;
            }
            (SegmentsState::Hold, _) if *enabled && inputs.enable && entry_waits => {
                shown.state = SegmentsState::Move;
                next_is_read = true;
            }
            _ => {}
        }
        if next_is_read {
            *playing = Some(self.fifo.pop());
            (*is_first, *extrapolated) = (true, None);
        } else {
            *phase = IDLE;
        }
    }
}

clocked_block!(Segments, "the command FIFO");

/// The output `low` depends on `low_water`, and may change in the same clock.
impl Moore for Segments {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs(0).to_raw());
    }

    fn output_kind(&self, output: &str) -> OutputKind {
        match output {
            "low" => OutputKind::Combinational,
            _ => OutputKind::Register,
        }
    }

    fn show_with(&mut self, inputs: &[u64], outputs: &mut [u64]) {
        let low_water = <&[u64; INPUT_PORTS]>::try_from(inputs).map_or(0, |raw| Inputs::from_raw(raw).low_water);
        show_each(outputs, self.outputs(low_water).to_raw());
    }

    /// The block is quiet only between two ticks.
    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let Ok(inputs) = <&[u64; INPUT_PORTS]>::try_from(inputs).map(Inputs::from_raw) else {
            return 0;
        };
        let Registers {
            phase, requests, shown, ..
        } = &self.registers;
        let acts = inputs.rst || inputs.tick || inputs.write || requests.with(&inputs) != *requests;
        let flags = [
            shown.underrun,
            shown.overflow,
            shown.refused,
            shown.malformed,
            shown.tick_missed,
            shown.out_of_range,
        ];
        let clears = inputs.clear_flags && flags.contains(&true);
        let pulses = shown.valid || shown.notify || shown.done;
        if acts || clears || pulses || *phase != IDLE {
            0
        } else {
            FOREVER
        }
    }

    fn ignores(&self, input: &str) -> bool {
        matches!(
            input,
            "enable"
                | "word"
                | "data"
                | "preset_position"
                | "stop_deceleration"
                | "modulo"
                | "feed_hold"
                | "extrapolation"
        )
    }
}
