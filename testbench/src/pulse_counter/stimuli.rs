//! Seeded random inputs for the pulse counter: an encoder that turns at any speed in either direction, with bounce,
//! glitches of about the filter's length, lost edges and index pulses; pairs of lines that disagree; ticks; a
//! divider's answers that are late, early or missing; registers that change in any clock.

use posicast_blocks::divider::DividerConfig;
use posicast_blocks::pulse_counter::{Inputs, ports};
use posicast_blocks::{Direction, Port};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Quadrature states {B, A} in the order of counting up.
const STATES: [u8; 4] = [0b00, 0b01, 0b11, 0b10];
/// Number of steps of the encoder from index to index.
const STEPS_PER_TURN: i32 = 20;

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct PulseCounterRandom {
    rng: Xoshiro256PlusPlus,
    inputs: Inputs,
    clock: u64,
    angle: i32,
    forward: bool,
    clocks_per_step: u32,
    until_step: u32,
    /// Number of clocks left of a disturbance, and the lines that it inverts: A, B, Z and their complements.
    glitch: (u32, u8),
    tick_clocks: u32,
    until_tick: u32,
    until_answer: Option<u32>,
    /// Whether the encoder loses most edges while the host does not react, so that the count of illegal steps reaches
    /// its end.
    torn: bool,
}

impl PulseCounterRandom {
    /// Creates the generator. Equal seeds give equal inputs for equal outputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            inputs: Inputs::default(),
            clock: 0,
            angle: 0,
            forward: true,
            clocks_per_step: 10,
            until_step: 10,
            glitch: (0, 0),
            tick_clocks: 100,
            until_tick: 100,
            until_answer: None,
            torn: false,
        }
    }

    fn one_in(&mut self, clocks: u32) -> bool {
        self.rng.random_range(0..clocks) == 0
    }

    /// Changes the registers that a host writes, at any time and mostly to useful values.
    fn registers(&mut self) {
        if self.one_in(3000) {
            self.inputs.filter_clocks = *pick(&mut self.rng, &[0, 0, 1, 2, 3, 8, 63]);
            self.inputs.differential = self.one_in(2);
            self.tick_clocks = *pick(&mut self.rng, &[1, 2, 97, 97, 400, 400, 2000]);
        }
        if self.one_in(2000) {
            self.inputs.mode = *pick(&mut self.rng, &[0, 0, 0, 0, 1, 2, 3, 4, 7]);
        }
        if self.one_in(1000) {
            let bits = self.rng.next_u64();
            self.inputs.swap = bits & 3 == 0;
            self.inputs.invert = bits & 12 == 0;
            self.inputs.index_always = bits & 16 != 0;
            self.inputs.index_presets = bits & 32 != 0;
            self.inputs.index_gate = (bits >> 8) as u8;
            self.inputs.velocity_m = bits & 0x7_0000 == 0;
            self.inputs.smoothing = *pick(&mut self.rng, &[0, 0, 1, 2, 3]);
            self.inputs.timeout = *pick(&mut self.rng, &[0, 1, 2, 200, 255]);
            self.inputs.preset_value = bits as i32;
        }
        self.inputs.rst = self.clock < 3 || self.one_in(20_000);
        if self.one_in(4000) {
            self.torn = self.one_in(4);
        }
        self.inputs.clear_flags = self.one_in(if self.torn { 20_000 } else { 300 });
        self.inputs.index_arm = self.one_in(200);
        self.inputs.preset = self.one_in(1000);
    }

    fn turn(&mut self) {
        if self.one_in(1500) {
            let filter = u32::from(self.inputs.filter_clocks);
            let paces = [1, filter + 1, filter + 2, 20, 80, 500, 5000];
            self.clocks_per_step = *pick(&mut self.rng, &paces);
            self.until_step = self.until_step.min(self.clocks_per_step);
            self.forward = self.one_in(2);
        }
        self.until_step = self.until_step.saturating_sub(1);
        if self.until_step == 0 {
            self.until_step = self.clocks_per_step + self.rng.random_range(0..=self.clocks_per_step / 4);
            if self.one_in(12) {
                self.forward = !self.forward;
            }
            // When an edge is lost, both lines change together.
            let steps = if self.one_in(if self.torn { 2 } else { 40 }) {
                2
            } else {
                1
            };
            self.angle += if self.forward { steps } else { -steps };
        }
    }

    /// Returns the levels of the pins: those of the encoder with the disturbances.
    fn pins(&mut self) {
        if self.glitch.0 == 0 && self.one_in(60) {
            let filter = u32::from(self.inputs.filter_clocks);
            let lengths = [1, 2, filter.max(1), filter + 1, filter + 2];
            self.glitch = (*pick(&mut self.rng, &lengths), 1 << self.rng.random_range(0..6));
        }
        self.glitch.0 = self.glitch.0.saturating_sub(1);
        let bounced = if self.glitch.0 > 0 { self.glitch.1 } else { 0 };
        let state = STATES[self.angle.rem_euclid(4) as usize];
        let index = u8::from(self.angle.rem_euclid(STEPS_PER_TURN) < 3);
        let true_pins = state | index << 2;
        let pins = (true_pins | (!true_pins & 7) << 3) ^ bounced;
        let pin = |place: u32| pins >> place & 1 != 0;
        let inputs = &mut self.inputs;
        (inputs.a, inputs.b, inputs.z) = (pin(0), pin(1), pin(2));
        (inputs.a_n, inputs.b_n, inputs.z_n) = (pin(3), pin(4), pin(5));
    }

    fn time(&mut self, seen: &Seen) {
        self.inputs.time_stamp = (self.inputs.time_stamp + 1) & 0xff_ffff;
        // A jump of the time stamp gives a long pause without simulating it.
        if self.one_in(20_000) {
            self.inputs.time_stamp = self.rng.next_u32() & 0xff_ffff;
        }
        self.until_tick = self.until_tick.saturating_sub(1);
        self.inputs.tick = self.until_tick == 0;
        if self.inputs.tick {
            self.until_tick = self.tick_clocks;
            let late = self.rng.random_range(0..80);
            self.until_answer = *pick(&mut self.rng, &[Some(1), Some(71), Some(71), Some(late), None]);
        }
        self.inputs.quotient = self.rng.next_u32() as i32;
        self.inputs.quotient_valid = self.one_in(2000);
        match self.until_answer {
            Some(0) => {
                self.until_answer = None;
                self.inputs.quotient_valid = true;
                // The answer is mostly that of a divider, else an arbitrary word.
                if !self.one_in(10) {
                    self.inputs.quotient = seen.quotient(self.tick_clocks);
                }
            }
            Some(clocks) => self.until_answer = Some(clocks - 1),
            None => {}
        }
    }
}

/// Outputs of the counter for the divider.
struct Seen {
    steps: i32,
    elapsed: u32,
}

impl Seen {
    fn new(seen: &[u64]) -> Self {
        let (steps, elapsed) = (seen.get(12).copied(), seen.get(13).copied());
        Self {
            steps: steps.unwrap_or(0) as i32,
            elapsed: elapsed.unwrap_or(0) as u32,
        }
    }

    fn quotient(&self, tick_clocks: u32) -> i32 {
        let divider = DividerConfig::new(tick_clocks.into());
        divider.map_or(0, |divider| divider.divide(self.steps, self.elapsed).0 as i32)
    }
}

impl Stimuli for PulseCounterRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        self.registers();
        self.turn();
        self.pins();
        self.time(&Seen::new(seen));
        self.clock += 1;
        for (input, value) in inputs.iter_mut().zip(self.inputs.to_raw()) {
            *input = value;
        }
    }
}

/// Counts of the events in a lockstep run of the pulse counter, by name, in the order of
/// [`PulseCounterCoverage::counts`].
#[derive(Debug, Clone)]
pub struct PulseCounterCoverage {
    outputs: Vec<String>,
    before: Vec<u64>,
    /// Number of times that each output changed.
    changed: Vec<u64>,
    resets: u64,
    reversals: u64,
    held: u64,
}

impl Default for PulseCounterCoverage {
    fn default() -> Self {
        let is_output = |port: &Port| port.direction == Direction::Output;
        let outputs: Vec<String> = ports().into_iter().filter(is_output).map(|port| port.name).collect();
        Self {
            before: vec![0; outputs.len()],
            changed: vec![0; outputs.len()],
            outputs,
            resets: 0,
            reversals: 0,
            held: 0,
        }
    }
}

impl PulseCounterCoverage {
    /// Adds a clock, given its inputs and the model's outputs.
    pub fn observe(&mut self, inputs: &[u64], shown: &[u64]) {
        self.resets += inputs.first().copied().unwrap_or(0);
        let fell = |at: usize| shown[at] < self.before[at];
        // A velocity that becomes zero although there were steps: a reversal. One that a result leaves unchanged: it was held.
        self.reversals += u64::from(shown[16] != 0 && shown[15] == 0 && self.before[15] != 0);
        self.held += u64::from(shown[16] != 0 && shown[15] == self.before[15] && fell(14));
        for (at, (value, before)) in shown.iter().zip(&mut self.before).enumerate() {
            self.changed[at] += u64::from(value != before);
            *before = *value;
        }
    }

    /// Returns each event's name and count: changes of every output, and some combined events.
    pub fn counts(&self) -> Vec<(&str, u64)> {
        let outputs = self
            .outputs
            .iter()
            .map(String::as_str)
            .zip(self.changed.iter().copied());
        let more = [
            ("resets", self.resets),
            ("velocity to zero", self.reversals),
            ("velocity held", self.held),
        ];
        outputs.chain(more).collect()
    }
}
