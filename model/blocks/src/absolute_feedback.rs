//! What an axis takes from an absolute encoder: its count, with sign and zero, and its velocity.
//!
//! The datasheet is `docs/absolute_encoder.md`, which has a chapter on it; the hardware is compared with this reference model.
//!
//! - The first reading places the axis: `count` is the reading less `offset`, modulo the range of the encoder, as a signed number.
//!   From then on the change of the reading moves it, so it goes on beyond the range. `invert` changes its sign.
//! - `velocity` is the change from reading to reading, which is that of a tick. It is smoothed as that of the
//!   [pulse counter](crate::pulse_counter), and saturates at 32,767 counts per tick.
//! - From the first tick on that begins with the axis placed, `start` lets the controller work, and `ready` lets the supervisor switch
//!   on: before, the command does not know where the axis stands.
//!
//! ```text
//! reading        --< r >-----------------
//! reading_valid  __/‾\___________________
//! count          ----------< ±(r − o) >--   two clocks later
//! velocity_valid __________/‾\___________
//! ```
//!
//! ```
//! use posicast_blocks::absolute_feedback::{AbsoluteFeedback, Inputs};
//!
//! // An encoder of 12 bits that stands at 4090 where the axis is at −2.
//! let tied = Inputs { reading_known: true, sign_bit: 1 << 11, offset: 4092, ..Inputs::default() };
//! let mut block = AbsoluteFeedback::new();
//! for reading in [4090, 4090 + 20] {
//!     block.step(&Inputs { reading, reading_valid: true, ..tied });
//!     block.step(&tied);
//! }
//! assert_eq!((block.outputs().count, block.outputs().velocity), (18, 20 << 16));
//! ```

use super::pulse_counter::SmoothedVelocity;
use super::{Moore, OutputKind, clocked_block, ports, quiet_at_rest, show_each};

/// Clocks from `reading_valid` to the new `count` and `velocity`.
pub const FEEDBACK_CLOCKS: u32 = 2;
/// Largest change of a reading that `velocity` shows, in counts.
pub const MOST_CHANGE: i32 = 32_767;

ports! {
    absolute_feedback_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: the tick.
        tick: Bit as bool;
        /// `count` of `absolute_encoder`.
        reading: Signed(32) as i32, "counts";
        /// `valid` of `absolute_encoder`.
        reading_valid: Bit as bool;
        /// `known` of `absolute_encoder`; low: the next reading places the axis anew.
        reading_known: Bit as bool;
        /// Constant: the highest bit of the encoder's range, 2^(bits − 1); 2^31 for more than 32 bits.
        sign_bit: Bits(32) as u32;
        /// Reading at which the axis is at 0, modulo the range.
        offset: Bits(32) as u32, "counts";
        /// Reverses the direction of count and velocity.
        invert: Bit as bool;
        /// k of the velocity's one-pole filter with coefficient 2^-k.
        smoothing: Bits(2) as u8;
        /// One clock: the controller is to start.
        control: Bit as bool;
        /// The drive is ready, asynchronous.
        drive_ready: Bit as bool;
        /// `lost` of `absolute_encoder`.
        lost: Bit as bool;
        /// One clock: a clock later, `position` is `preset_value`.
        preset: Bit as bool;
        /// Position of a preset, in the clock after `preset`.
        preset_value: Signed(32) as i32, "counts";
        /// Clears `velocity_missed`.
        clear_flags: Bit as bool;
    }

    /// The output ports. All but `start` and `ready` are registers or functions of registers.
    outputs Outputs {
        /// `control`, once a tick has begun with the axis placed.
        start: Bit as bool;
        /// `drive_ready`, once a tick has begun with the axis placed. It stays while the encoder is lost, which is a cause of its own.
        ready: Bit as bool;
        /// Position of the axis: the reading less the offset.
        count: Signed(32) as i32, "counts";
        /// A reading has placed the axis.
        placed: Bit as bool;
        /// `count` at which `position` is 0.
        origin: Signed(32) as i32, "counts";
        /// `count` less `origin`.
        position: Signed(32) as i32, "counts";
        /// Velocity at the last tick.
        velocity: Signed(32) as i32, "counts per tick, Q16.16";
        /// One clock: `count` and `velocity` are new.
        velocity_valid: Bit as bool;
        /// Sticky: between two ticks there was no new velocity, though `reading_known` was high.
        velocity_missed: Bit as bool;
    }
}

/// The cycle-accurate model of the block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AbsoluteFeedback {
    /// Position without the sign of `invert`.
    place: i32,
    /// The last reading.
    last: i32,
    is_placed: bool,
    /// Whether the last tick began with the axis placed.
    steady: bool,
    /// Change of the reading, in the clock after it.
    change: i32,
    is_new: bool,
    /// Whether the tick's velocity is still to come.
    pending: bool,
    /// Whether there was a preset in the clock before.
    presets: bool,
    smoothed: SmoothedVelocity,
    count: i32,
    placed: bool,
    origin: i32,
    valid: bool,
    missed: bool,
}

impl Default for AbsoluteFeedback {
    fn default() -> Self {
        Self::new()
    }
}

impl AbsoluteFeedback {
    /// The block after reset.
    pub fn new() -> Self {
        Self {
            place: 0,
            last: 0,
            is_placed: false,
            steady: false,
            change: 0,
            is_new: false,
            pending: false,
            presets: false,
            smoothed: SmoothedVelocity::REST,
            count: 0,
            placed: false,
            origin: 0,
            valid: false,
            missed: false,
        }
    }

    /// The outputs in this clock, without those that depend on inputs.
    pub fn outputs(&self) -> Outputs {
        Outputs {
            start: false,
            ready: false,
            count: self.count,
            placed: self.placed,
            origin: self.origin,
            position: self.count.wrapping_sub(self.origin),
            velocity: self.smoothed.value(),
            velocity_valid: self.valid,
            velocity_missed: self.missed,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.shown(inputs);
        if inputs.rst {
            *self = Self::new();
        } else {
            self.clock(inputs);
        }
        outputs
    }

    /// The outputs in this clock, with these inputs.
    fn shown(&self, inputs: &Inputs) -> Outputs {
        Outputs {
            start: inputs.control && self.steady,
            ready: inputs.drive_ready && (self.steady || inputs.lost),
            ..self.outputs()
        }
    }

    fn clock(&mut self, inputs: &Inputs) {
        let signed = |value: i32| if inputs.invert { value.wrapping_neg() } else { value };
        // The second clock of a reading, and what follows it.
        if self.presets {
            self.origin = self.count.wrapping_sub(inputs.preset_value);
        }
        self.presets = inputs.preset;
        self.count = signed(self.place);
        self.placed = self.is_placed;
        self.valid = self.is_new;
        if inputs.clear_flags {
            self.missed = false;
        }
        self.missed |= inputs.tick && self.pending && !self.is_new && inputs.reading_known;
        self.pending = inputs.tick || (self.pending && !self.is_new);
        if self.is_new {
            let change = signed(self.change).clamp(-MOST_CHANGE, MOST_CHANGE);
            self.smoothed.close(change << 16, inputs.smoothing);
        }

        self.steady = self.is_placed && (self.steady || inputs.tick);

        // The first one.
        self.is_new = inputs.reading_valid;
        if inputs.reading_valid {
            self.change = if self.is_placed {
                inputs.reading.wrapping_sub(self.last)
            } else {
                0
            };
            self.place = if self.is_placed {
                self.place.wrapping_add(self.change)
            } else {
                within(inputs.reading as u32, inputs.offset, inputs.sign_bit)
            };
            self.last = inputs.reading;
        }
        self.is_placed = inputs.reading_known && (self.is_placed || inputs.reading_valid);
    }
}

/// The reading less the offset, modulo the range, as a signed number.
fn within(reading: u32, offset: u32, sign_bit: u32) -> i32 {
    let range = sign_bit | sign_bit.wrapping_sub(1);
    let apart = reading.wrapping_sub(offset) & range;
    (apart ^ sign_bit).wrapping_sub(sign_bit) as i32
}

clocked_block!(AbsoluteFeedback, "the feedback of an absolute encoder");

impl Moore for AbsoluteFeedback {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn output_kind(&self, output: &str) -> OutputKind {
        match output {
            "start" | "ready" => OutputKind::Combinational,
            _ => OutputKind::Register,
        }
    }

    fn show_with(&mut self, inputs: &[u64], outputs: &mut [u64]) {
        if let Ok(raw) = <&[u64; INPUT_PORTS]>::try_from(inputs) {
            show_each(outputs, self.shown(&Inputs::from_raw(raw)).to_raw());
        }
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        quiet_at_rest(self, inputs, |block, raw| {
            block.step(&Inputs::from_raw(raw));
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An encoder of 10 bits.
    const TIED: Inputs = Inputs {
        rst: false,
        tick: false,
        reading: 0,
        reading_valid: false,
        reading_known: true,
        sign_bit: 1 << 9,
        offset: 0,
        invert: false,
        smoothing: 0,
        control: false,
        drive_ready: true,
        lost: false,
        preset: false,
        preset_value: 0,
        clear_flags: false,
    };

    /// Gives a reading, and waits for what follows from it.
    fn read(block: &mut AbsoluteFeedback, tied: Inputs, reading: i32) -> Outputs {
        block.step(&Inputs {
            reading,
            reading_valid: true,
            ..tied
        });
        block.step(&tied);
        block.step(&tied)
    }

    #[test]
    fn the_first_reading_is_placed_within_half_the_range() {
        // Reading, offset, and the position: its distance on the circle of 1024 counts.
        for (reading, offset, position) in [
            (0, 0, 0),
            (511, 0, 511),
            (512, 0, -512),
            (1023, 0, -1),
            (5, 1000, 29),
            (1000, 5, -29),
            (700, 700, 0),
        ] {
            for invert in [false, true] {
                let tied = Inputs { offset, invert, ..TIED };
                let shown = read(&mut AbsoluteFeedback::new(), tied, reading);
                assert_eq!(
                    shown.count,
                    if invert { -position } else { position },
                    "{reading} − {offset}"
                );
                assert_eq!((shown.placed, shown.velocity, shown.velocity_valid), (true, 0, true));
            }
        }
    }

    #[test]
    fn changes_move_it_beyond_the_range_and_are_the_velocity() {
        let mut block = AbsoluteFeedback::new();
        let tied = Inputs { invert: true, ..TIED };
        // The encoder's own count goes on over its end: 1023, 1030, 1530, 1500.
        let shown = [1023, 1030, 1530, 1500].map(|reading| read(&mut block, tied, reading));
        assert_eq!(shown.map(|of| of.count), [1, -6, -506, -476]);
        assert_eq!(shown.map(|of| of.velocity >> 16), [0, -7, -500, 30]);
    }

    #[test]
    fn an_axis_that_was_lost_is_placed_anew() {
        let mut block = AbsoluteFeedback::new();
        read(&mut block, TIED, 100);
        read(&mut block, TIED, 2100);
        assert_eq!(block.outputs().count, 2100);
        block.step(&Inputs {
            reading_known: false,
            ..TIED
        });
        block.step(&TIED);
        assert!(!block.outputs().placed);
        let shown = read(&mut block, TIED, 1000);
        assert_eq!((shown.count, shown.velocity), (-24, 0));
    }

    #[test]
    fn the_filter_closes_half_of_the_distance() {
        let mut block = AbsoluteFeedback::new();
        let tied = Inputs { smoothing: 1, ..TIED };
        let shown = [0, 100, 200, 300, 400].map(|reading| read(&mut block, tied, reading).velocity);
        let of = |counts: f64| (counts * 65_536.0) as i32;
        assert_eq!(shown, [0, of(50.0), of(75.0), of(87.5), of(93.75)]);
    }

    #[test]
    fn the_velocity_saturates_and_the_count_does_not() {
        let mut block = AbsoluteFeedback::new();
        read(&mut block, TIED, 0);
        let shown = read(&mut block, TIED, 1_000_000);
        assert_eq!((shown.count, shown.velocity), (1_000_000, MOST_CHANGE << 16));
        let shown = read(&mut block, TIED, 0);
        assert_eq!((shown.count, shown.velocity), (0, -MOST_CHANGE << 16));
    }

    #[test]
    fn a_preset_moves_the_origin_and_not_the_count() {
        let mut block = AbsoluteFeedback::new();
        read(&mut block, TIED, 70);
        block.step(&Inputs { preset: true, ..TIED });
        block.step(&Inputs {
            preset_value: 1000,
            ..TIED
        });
        let shown = block.outputs();
        assert_eq!((shown.count, shown.position, shown.origin), (70, 1000, -930));
    }

    #[test]
    fn a_tick_without_a_reading_is_flagged() {
        let mut block = AbsoluteFeedback::new();
        let tick = Inputs { tick: true, ..TIED };
        block.step(&tick);
        block.step(&Inputs {
            reading_known: false,
            ..tick
        });
        read(&mut block, TIED, 1);
        block.step(&tick);
        assert!(!block.outputs().velocity_missed);
        block.step(&tick);
        assert!(block.outputs().velocity_missed);
        block.step(&Inputs {
            clear_flags: true,
            ..TIED
        });
        assert!(!block.outputs().velocity_missed);
    }

    #[test]
    fn controller_and_supervisor_wait_for_a_tick_that_begins_with_the_axis_placed() {
        let mut block = AbsoluteFeedback::new();
        let [tick, control] = [(true, false), (false, true)].map(|(tick, control)| Inputs { tick, control, ..TIED });
        block.step(&tick);
        let shown = |block: &mut AbsoluteFeedback| {
            let shown = block.step(&control);
            (shown.start, shown.ready)
        };
        assert_eq!(shown(&mut block), (false, false));
        read(&mut block, TIED, 5);
        assert_eq!(shown(&mut block), (false, false));
        block.step(&tick);
        assert_eq!(shown(&mut block), (true, true));
        block.step(&Inputs {
            reading_known: false,
            ..TIED
        });
        block.step(&tick);
        assert_eq!(shown(&mut block), (false, false));
        let lost = block.step(&Inputs { lost: true, ..control });
        assert_eq!((lost.start, lost.ready), (false, true));
    }
}
