//! The pulse counter turns the signals of an encoder or scale into position, index and velocity.
//!
//! The datasheet is `docs/pulse_counter.md`; the hardware is compared with this reference model.
//!
//! | part | what it does |
//! |---|---|
//! | `lines` | synchronises and filters A, B and Z; compares differential pairs |
//! | `decode` | levels to steps: quadrature ×4 ×2 ×1, step and direction, up and down |
//! | [`PulseCounter`] | the count, which never jumps; `origin`; the index latch |
//! | `velocity` | M/T: selects steps and time for the divider; bounds and smooths its quotient |
//!
//! [`PulseCounter::step`] simulates one clock; [`PulseCounter::hold`] simulates many with the same inputs, and skips
//! those that change nothing but the time.
//!
//! ```
//! use posicast_blocks::pulse_counter::{Inputs, PulseCounter};
//!
//! let mut counter = PulseCounter::new();
//! counter.hold(&Inputs::default(), 10);
//! // A leads B: up. One clock more than `filter_clocks` lets a level pass.
//! for (a, b) in [(true, false), (true, true), (false, true), (false, false)] {
//!     counter.hold(&Inputs { a, b, filter_clocks: 3, ..Inputs::default() }, 20);
//! }
//! assert_eq!((counter.outputs().count, counter.outputs().illegal), (4, false));
//! ```

mod decode;
mod lines;
mod ports;
mod velocity;

pub use ports::{FILTER_CLOCKS_MAX, INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, ports};
pub use velocity::SMOOTHING_BITS;
pub(crate) use velocity::SmoothedVelocity;

use self::decode::decode;
pub(super) use self::lines::GlitchFilter;
use self::lines::Line;
use self::velocity::Velocity;
use super::{Moore, clocked_block, show_each};

/// Clocks after a reset until levels count as known: two for the synchroniser, one for the filter, one for the
/// decoder.
pub const PRIMING_CLOCKS: u32 = 4;

/// All registers.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct State {
    lines: [Line; 3],
    disagreement_filter: GlitchFilter,
    /// Clocks since the reset, at most [`PRIMING_CLOCKS`].
    primed: u32,
    before: [bool; 2],
    index_before: bool,
    count: i32,
    origin: i32,
    /// Whether there was a preset in the clock before, so that the origin moves in this one.
    presets: bool,
    index_count: i32,
    index_seen: bool,
    index_armed: bool,
    illegal_count: u8,
    illegal: bool,
    disagreement: bool,
    velocity: Velocity,
}

impl State {
    /// Whether the two states are equal except for the time.
    fn is_but_for_time(&self, other: &Self) -> bool {
        // If they differ, it is mostly in the lines or the velocity, so those are compared first.
        self.lines == other.lines
            && self.velocity.is_but_for_time(&other.velocity)
            && Self {
                velocity: other.velocity.clone(),
                ..self.clone()
            } == *other
    }

    /// The filtered levels of A, B and Z.
    fn levels(&self) -> [bool; 3] {
        let [a, b, z] = &self.lines;
        [a.level(), b.level(), z.level()]
    }

    fn disagree(&self, inputs: &Inputs) -> bool {
        self.lines.iter().any(|line| line.disagrees(inputs.differential))
    }

    /// Number of clocks with these inputs in which only filters and the time count.
    fn quiet_clocks(&self, inputs: &Inputs) -> u64 {
        let [level_a, level_b, index_level] = self.levels();
        let levels = [level_a, level_b];
        let arms = inputs.index_arm && !self.index_armed;
        let acts = inputs.rst || inputs.tick || inputs.preset || self.presets || inputs.quotient_valid || arms;
        let flags = self.illegal || self.disagreement || self.velocity.missed();
        let clears = inputs.clear_flags && (flags || self.illegal_count > 0);
        let steps = self.before != levels || self.index_before != (index_level && inputs.index_gate_open(levels));
        let disagrees = self.disagreement_filter.level() && !self.disagreement;
        let starts = self.primed != PRIMING_CLOCKS;
        if acts || clears || steps || self.index_seen || disagrees || starts || self.velocity.valid() {
            return 0;
        }
        let filter = &self.disagreement_filter;
        let of_filter = filter.quiet_clocks(self.disagree(inputs), inputs.filter_clocks);
        let lines = self.lines.iter().zip(inputs.pins());
        let of_lines = lines.map(|(line, (pin, complement))| line.quiet_clocks(pin, complement, inputs));
        of_lines.fold(of_filter, u64::min)
    }

    /// Advances by this many such clocks. `inputs` are those of the last.
    fn pass(&mut self, inputs: &Inputs, clocks: u64) {
        let disagree = self.disagree(inputs);
        self.disagreement_filter.pass(disagree, clocks);
        for line in &mut self.lines {
            line.pass(inputs, clocks);
        }
        self.velocity.pass_time(inputs.time_stamp);
    }
}

/// The time stamp this many clocks after that of `inputs`.
fn time_after(inputs: &Inputs, clocks: u64) -> u32 {
    inputs.time_stamp.wrapping_add(clocks as u32)
}

/// The cycle-accurate model of the pulse counter.
pub struct PulseCounter {
    state: State,
}

impl Default for PulseCounter {
    fn default() -> Self {
        Self::new()
    }
}

impl PulseCounter {
    /// A counter after reset.
    pub fn new() -> Self {
        Self {
            state: State::default(),
        }
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        let state = &self.state;
        let [level_a, level_b, level_z] = state.levels();
        Outputs {
            count: state.count,
            origin: state.origin,
            position: state.count.wrapping_sub(state.origin),
            index_count: state.index_count,
            index_seen: state.index_seen,
            index_armed: state.index_armed,
            illegal_count: state.illegal_count,
            illegal: state.illegal,
            disagreement: state.disagreement,
            level_a,
            level_b,
            level_z,
            steps: state.velocity.steps(),
            elapsed: state.velocity.elapsed(),
            velocity_pending: state.velocity.pending(),
            velocity: state.velocity.velocity(),
            velocity_valid: state.velocity.valid(),
            velocity_missed: state.velocity.missed(),
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs();
        self.clock(inputs);
        outputs
    }

    /// Simulates this many clocks with the same inputs, except that the time stamp counts. Once a clock has changed
    /// nothing but the time, it jumps over the rest.
    pub fn hold(&mut self, inputs: &Inputs, clocks: u64) {
        let mut now = *inputs;
        for clock in 0..clocks {
            now.time_stamp = time_after(inputs, clock);
            let before = self.state.clone();
            self.clock(&now);
            if !inputs.tick && self.state.is_but_for_time(&before) {
                if !inputs.rst {
                    self.state.velocity.pass_time(time_after(inputs, clocks - 1));
                }
                return;
            }
        }
    }

    fn clock(&mut self, inputs: &Inputs) {
        if inputs.rst {
            self.state = State::default();
            return;
        }
        let state = &mut self.state;
        let [level_a, level_b, index_level] = state.levels();
        let levels = [level_a, level_b];
        let ready = state.primed == PRIMING_CLOCKS;

        let event = decode(inputs, levels, state.before);
        let step = event.step && ready;
        let count_before = state.count;
        if state.presets {
            state.origin = count_before.wrapping_sub(inputs.preset_value);
        }
        if step {
            state.count = state.count.wrapping_add(if event.up { 1 } else { -1 });
        }

        if inputs.clear_flags {
            state.illegal = false;
            state.illegal_count = 0;
            state.disagreement = false;
        }
        if event.illegal && ready {
            state.illegal = true;
            state.illegal_count = state.illegal_count.saturating_add(1);
        }
        state.disagreement |= state.disagreement_filter.level();

        let gated = ready && index_level && inputs.index_gate_open(levels);
        let index = gated && !state.index_before && (state.index_armed || inputs.index_always);
        state.index_seen = index;
        if index {
            state.index_count = state.count;
            state.index_armed = false;
        }
        state.index_armed |= inputs.index_arm;
        state.presets = inputs.preset || (index && inputs.index_presets);
        state.index_before = gated;

        state.velocity.clock(inputs, step.then_some(event.up), count_before);

        state.before = levels;
        let disagree = state.disagree(inputs);
        state.disagreement_filter.clock(disagree, inputs.filter_clocks, ready);
        for (line, (pin, complement)) in state.lines.iter_mut().zip(inputs.pins()) {
            line.clock(pin, complement, inputs, ready);
        }
        state.primed = (state.primed + 1).min(PRIMING_CLOCKS);
    }
}

clocked_block!(PulseCounter, "the pulse counter");

impl Moore for PulseCounter {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        <&[u64; INPUT_PORTS]>::try_from(inputs).map_or(0, |raw| self.state.quiet_clocks(&Inputs::from_raw(raw)))
    }

    fn pass(&mut self, inputs: &[u64], clocks: u64) {
        if let Ok(inputs) = <&[u64; INPUT_PORTS]>::try_from(inputs).map(Inputs::from_raw) {
            self.state.pass(&inputs, clocks);
        }
    }

    /// The time stamp matters when something happens, and in the clock before, which the inputs of the last clock
    /// include.
    fn ignores(&self, input: &str) -> bool {
        matches!(input, "time_stamp" | "quotient" | "preset_value")
    }
}
