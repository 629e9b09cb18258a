//! One axis of the inline shaper: it samples the counted command, and says what the step generator follows.
//!
//! The datasheet is `docs/inline_axis.md`; the hardware is compared with this reference model.
//!
//! - A line of the command goes through one flip-flop, off at 0, to the pulse counter.
//! - At every tick the count becomes the position `x` of the shaper. While the axis does not follow, every tick restarts
//!   the shaper there; so the first tick of `run` begins where the input stands.
//! - The step generator follows the shaped position, or `x` itself while `unshaped`.
//! - `settled`: the count has stood for the shaper's longest delay and one tick, and as many steps have come out as went in.
//! - Each cause stops the axis until `clear`: a tick with more steps than the limit, a cause of the step generator, an
//!   illegal transition of the input.
//!
//! ```text
//! clock      n   n+1  n+2            n+C    n+C+1
//! tick      ‾‾‾\_______________________________
//! x         ----< count · 2^8 >----------------
//! strobe    ____/‾‾‾\__________________________       the shaper's pass begins
//! position  ------------------< shaped or x >--       before the step generator's tick
//! ```
//!
//! ```
//! use posicast_blocks::inline_axis::{InlineAxis, InlineAxisConfig, Inputs};
//!
//! let mut axis = InlineAxis::new(&InlineAxisConfig::new(100, 40)?);
//! axis.step(&Inputs { run: true, tick: true, count: 3, ..Inputs::default() });
//! let outputs = axis.outputs();
//! assert_eq!((outputs.x, outputs.start, outputs.follow), (3 << 8, true, true));
//! # Ok::<(), posicast_blocks::inline_axis::InlineAxisConfigError>(())
//! ```

use super::{Moore, clocked_block, ports, quiet_at_rest, show_each};

/// Fraction bits of the positions: those of the shaper's words and of the step generator.
pub const INLINE_FRACTION: u32 = 8;
/// Largest limit of the steps per tick; a counter that gives a step in every other clock reaches half of it in the
/// longest tick.
pub const MOST_TICK_STEPS: u32 = 131_070;
/// Largest number of ticks until the axis is settled: the longest delay of a shaper, and one.
pub const MOST_SETTLE_TICKS: u32 = 16_383;
/// Clocks from the tick to the strobe of the shaper, and from the shaped position to `position`.
pub const LATENCY_CLOCKS: u32 = 1;

ports! {
    inline_axis_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// First line of the command: step, step up, or A; asynchronous.
        pin_a: Bit as bool;
        /// Second line of the command: direction, step down, or B; asynchronous.
        pin_b: Bit as bool;
        /// High: the axis follows the input from the next tick on. Low: it stops at once.
        run: Bit as bool;
        /// The step generator follows the input without shaping; it may change only while the axis is settled.
        unshaped: Bit as bool;
        /// One clock: clears the causes.
        clear: Bit as bool;
        /// One clock: the sample tick.
        tick: Bit as bool;
        /// Steps of the input, modulo 2^32: `count` of the pulse counter.
        count: Signed(32) as i32, "steps";
        /// One clock: the pulse counter saw an illegal transition.
        illegal: Bit as bool;
        /// Shaped position, from the shaper.
        shaped: Signed(32) as i32, "2^-8 steps";
        /// Steps of the output, modulo 2^32: `count` of the step generator.
        given: Signed(32) as i32, "steps";
        /// The step generator was to be faster than it can.
        too_fast: Bit as bool;
        /// The step generator owed more steps than its limit.
        owed_exceeded: Bit as bool;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// First line, high if it is active, for the pulse counter.
        a: Bit as bool;
        /// Second line, high if it is active, for the pulse counter.
        b: Bit as bool;
        /// One clock after each tick: the next sample of the shaper.
        strobe: Bit as bool;
        /// Beside `strobe` while the axis has not followed: the shaper restarts.
        start: Bit as bool;
        /// Position of the input at the tick, for the shaper.
        x: Signed(32) as i32, "2^-8 steps";
        /// Position for the step generator: the shaped one, or `x`.
        position: Signed(32) as i32, "2^-8 steps";
        /// `enable` of the step generator: the steps follow the input.
        follow: Bit as bool;
        /// The input has stood for the shaper's duration, and every step of it has come out.
        settled: Bit as bool;
        /// The axis has stopped with a cause: one of the next three.
        fault: Bit as bool;
        /// Sticky: a tick brought more steps than the limit.
        input_too_fast: Bit as bool;
        /// Sticky: the step generator stopped.
        steps_stopped: Bit as bool;
        /// Sticky: both lines of a quadrature input changed together.
        input_illegal: Bit as bool;
    }
}

/// Why an axis of the inline shaper cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum InlineAxisConfigError {
    /// The limit of the steps per tick.
    #[error(
        "at most {0} steps per tick: 1 to {MOST_TICK_STEPS} are possible; choose another velocity limit or sample rate"
    )]
    TickSteps(u64),
    /// The time until the axis is settled.
    #[error(
        "settled after {0} ticks: 1 to {MOST_SETTLE_TICKS} are possible; shorten the shaper or lower the sample rate"
    )]
    SettleTicks(u64),
}

/// The lines of the command that are active low.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct InlineLinesActiveLow {
    /// The first line.
    pub a: bool,
    /// The second line.
    pub b: bool,
}

/// Build parameters of an axis of the inline shaper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InlineAxisConfig {
    limit_steps: u32,
    settle_ticks: u32,
    active_low: InlineLinesActiveLow,
}

impl InlineAxisConfig {
    /// An axis that stops at more than `limit_steps` steps of the input in a tick, and whose shaper has come to rest
    /// `settle_ticks` ticks after its input, at the latest. Its lines are active high.
    ///
    /// # Errors
    /// [`InlineAxisConfigError`] for what does not fit the registers.
    pub fn new(limit_steps: u64, settle_ticks: u64) -> Result<Self, InlineAxisConfigError> {
        if !(1..=u64::from(MOST_TICK_STEPS)).contains(&limit_steps) {
            return Err(InlineAxisConfigError::TickSteps(limit_steps));
        }
        if !(1..=u64::from(MOST_SETTLE_TICKS)).contains(&settle_ticks) {
            return Err(InlineAxisConfigError::SettleTicks(settle_ticks));
        }
        Ok(Self {
            limit_steps: limit_steps as u32,
            settle_ticks: settle_ticks as u32,
            active_low: InlineLinesActiveLow::default(),
        })
    }

    /// The same with these lines active low.
    #[must_use]
    pub fn active_low(self, active_low: InlineLinesActiveLow) -> Self {
        Self { active_low, ..self }
    }

    /// The same, settled after this many ticks without a step, cut to 1 to [`MOST_SETTLE_TICKS`].
    #[must_use]
    pub fn settles_after(self, settle_ticks: u64) -> Self {
        let settle_ticks = settle_ticks.clamp(1, MOST_SETTLE_TICKS.into()) as u32;
        Self { settle_ticks, ..self }
    }

    /// Largest number of steps per tick that does not stop the axis.
    pub fn limit_steps(&self) -> u32 {
        self.limit_steps
    }

    /// Ticks without a step of the input after which the axis may be settled.
    pub fn settle_ticks(&self) -> u32 {
        self.settle_ticks
    }

    /// The lines that are active low.
    pub fn lines_active_low(&self) -> InlineLinesActiveLow {
        self.active_low
    }
}

/// The cycle-accurate model of an axis of the inline shaper.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InlineAxis {
    config: InlineAxisConfig,
    /// The lines of the clock before. A reset does not clear these registers.
    lines: [bool; 2],
    strobe: bool,
    start: bool,
    x: i32,
    position: i32,
    follow: bool,
    /// Ticks without a step of the input, at most `settle_ticks`.
    stood_ticks: u32,
    /// Steps of the input less those of the output when the axis began to follow.
    offset: i32,
    settled: bool,
    causes: Causes,
}

/// Why an axis has stopped.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Causes {
    input_too_fast: bool,
    steps_stopped: bool,
    input_illegal: bool,
}

impl Causes {
    fn any(self) -> bool {
        self != Self::default()
    }

    fn and(self, new: Self) -> Self {
        Self {
            input_too_fast: self.input_too_fast || new.input_too_fast,
            steps_stopped: self.steps_stopped || new.steps_stopped,
            input_illegal: self.input_illegal || new.input_illegal,
        }
    }
}

impl InlineAxis {
    /// An axis after power-up.
    pub fn new(config: &InlineAxisConfig) -> Self {
        Self {
            config: *config,
            lines: [false; 2],
            strobe: false,
            start: false,
            x: 0,
            position: 0,
            follow: false,
            stood_ticks: 0,
            offset: 0,
            settled: false,
            causes: Causes::default(),
        }
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        Outputs {
            a: self.lines[0],
            b: self.lines[1],
            strobe: self.strobe,
            start: self.start,
            x: self.x,
            position: self.position,
            follow: self.follow,
            settled: self.settled,
            fault: self.causes.any(),
            input_too_fast: self.causes.input_too_fast,
            steps_stopped: self.causes.steps_stopped,
            input_illegal: self.causes.input_illegal,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs();
        let low = self.config.active_low;
        let lines = [inputs.pin_a != low.a, inputs.pin_b != low.b];
        if inputs.rst {
            *self = Self::new(&self.config);
        } else {
            self.clock(inputs);
        }
        self.lines = lines;
        outputs
    }

    fn clock(&mut self, inputs: &Inputs) {
        let difference = inputs.count.wrapping_sub(self.x >> INLINE_FRACTION) << 14 >> 14;
        let new = Causes {
            input_too_fast: inputs.tick && self.follow && difference.unsigned_abs() > self.config.limit_steps,
            steps_stopped: self.follow && (inputs.too_fast || inputs.owed_exceeded),
            input_illegal: self.follow && inputs.illegal,
        };
        let goes = inputs.run && !self.causes.any() && !new.any();

        let behind = inputs.count.wrapping_sub(inputs.given);
        let stood = self.stood_ticks == self.config.settle_ticks;
        self.settled = self.follow && goes && stood && behind == self.offset;
        self.position = if inputs.unshaped { self.x } else { inputs.shaped };
        self.strobe = inputs.tick;
        self.start = inputs.tick && !self.follow;
        if inputs.tick {
            self.x = inputs.count << INLINE_FRACTION;
            if !self.follow {
                self.offset = behind;
            }
            if !self.follow || difference != 0 {
                self.stood_ticks = 0;
            } else if !stood {
                self.stood_ticks += 1;
            }
        }
        self.follow = goes && (self.follow || inputs.tick);
        self.causes = if inputs.clear { new } else { self.causes.and(new) };
    }
}

clocked_block!(InlineAxis, "the inline axis");

impl Moore for InlineAxis {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        quiet_at_rest(self, inputs, |axis, raw| {
            axis.step(&Inputs::from_raw(raw));
        })
    }
}
