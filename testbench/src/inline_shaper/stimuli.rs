//! A controller at the pins of an inline shaper: rides at every speed and at the limit, reversals, directions that change
//! with the step, rests until the axes are settled; bypass, enable, emergency stop and clears at rest and in motion; speeds
//! beyond the limit, and pulses that the filter must drop.
//!
//! A run begins with a list of acts that drives every flag.

use posicast_blocks::inline_axis::MOST_TICK_STEPS;
use posicast_blocks::inline_shaper::{InlineConfig, InlineShaperAxis};
use posicast_blocks::step_generator::StepMode;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Number of inputs before those of the axes.
const SHARED: usize = 5;

/// What an axis is told for the time of an act.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ride {
    Rest,
    /// A part of the fastest speed in 64ths, with its sign.
    Part(i64),
    /// Faster than the limit, if the lines can be.
    Beyond,
}

/// What the controller does for some ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Act {
    ticks: u64,
    /// All axes ride like this; `None`: each as it likes.
    ride: Option<Ride>,
    enable: bool,
    bypass: bool,
    emergency: bool,
    clear: bool,
}

impl Act {
    fn ride(ticks: u64, ride: Ride, bypass: bool) -> Self {
        Self {
            ticks,
            ride: Some(ride),
            enable: true,
            bypass,
            emergency: false,
            clear: false,
        }
    }
}

/// The acts that a run begins with; `rest` ticks let all axes settle.
fn first_acts(rest: u64) -> Vec<Act> {
    let act = Act::ride;
    let disabled = |ticks, ride| Act {
        enable: false,
        ..act(ticks, ride, false)
    };
    let cleared = Act {
        clear: true,
        ..act(2, Ride::Rest, false)
    };
    vec![
        disabled(3, Ride::Part(40)),
        act(3, Ride::Part(40), false),
        act(rest, Ride::Rest, false),
        act(3, Ride::Rest, true),
        act(2, Ride::Part(64), true),
        act(2, Ride::Part(-64), true),
        disabled(2, Ride::Part(-64)),
        act(2, Ride::Part(20), true),
        act(rest, Ride::Rest, true),
        act(3, Ride::Rest, false),
        act(3, Ride::Part(64), false),
        act(4, Ride::Part(-64), false),
        act(3, Ride::Part(-30), true),
        act(rest, Ride::Rest, false),
        act(3, Ride::Beyond, false),
        act(2, Ride::Rest, false),
        cleared,
        act(2, Ride::Part(-60), false),
        Act {
            emergency: true,
            ..act(1, Ride::Part(-60), false)
        },
        act(2, Ride::Part(-60), false),
        cleared,
        act(rest, Ride::Rest, false),
    ]
}

/// Ticks in which an axis that stands has settled: the longest shaper, and a few for the steps that are owed.
fn rest_ticks(config: &InlineConfig) -> u64 {
    let settle = config.axes.iter().map(|axis| u64::from(axis.follower.settle_ticks()));
    settle.max().unwrap_or(0) + 6
}

/// Clocks of the first acts.
pub(crate) fn first_acts_clocks(config: &InlineConfig) -> u64 {
    let ticks: u64 = first_acts(rest_ticks(config)).iter().map(|act| act.ticks).sum();
    (ticks + 3) * u64::from(config.tick.tick_clocks())
}

/// Fewest clocks from step to step that the input's filter takes.
fn least_interval(axis: &InlineShaperAxis) -> u64 {
    let level = u64::from(axis.filter_clocks) + 1;
    match axis.input {
        StepMode::Quadrature => level + 1,
        StepMode::StepDirection | StepMode::UpDown => 2 * level + 1,
    }
}

/// Whether the lines of an axis can be faster than its limit.
pub(super) fn exceeds_the_limit(axis: &InlineShaperAxis, tick_clocks: u64) -> bool {
    tick_clocks / least_interval(axis) > u64::from(axis.follower.limit_steps()) + 1
}

/// The lines of the controller to one axis.
#[derive(Debug, Clone)]
struct Lines {
    axis: InlineShaperAxis,
    /// Clocks from step to step: the fastest that is no fault, and one that is.
    fastest: u64,
    beyond: u64,
    ride: Ride,
    /// Clocks to the next step.
    to_step: u64,
    /// Clocks that the pulse still lasts.
    pulse_left: u64,
    /// Clocks that the direction must still stand before a step.
    setup_left: u64,
    up: bool,
    code: u64,
    /// Levels, before the polarity.
    levels: [bool; 2],
    /// A pulse that the filter drops, on this line.
    glitch: Option<usize>,
}

impl Lines {
    fn new(axis: &InlineShaperAxis, tick_clocks: u64) -> Self {
        let least = least_interval(axis);
        let limit = u64::from(axis.follower.limit_steps());
        let largest = u64::from(axis.steps.largest_difference()) >> axis.steps.fraction_bits();
        let overshoot = overshoot(axis);
        let allowed = if limit < u64::from(MOST_TICK_STEPS) {
            limit
        } else {
            largest
        };
        let shaped = (largest as f64 / overshoot).floor().max(1.0) as u64;
        Self {
            axis: axis.clone(),
            fastest: (tick_clocks / allowed.min(shaped).max(1)).max(least) + 1,
            beyond: (tick_clocks / (limit + 2)).max(least),
            ride: Ride::Rest,
            to_step: 0,
            pulse_left: 0,
            setup_left: 0,
            up: true,
            code: 0,
            levels: [false; 2],
            glitch: None,
        }
    }

    fn interval(&self) -> Option<(u64, bool)> {
        match self.ride {
            Ride::Rest | Ride::Part(0) => None,
            Ride::Part(part) => Some((self.fastest * 64 / part.unsigned_abs(), part > 0)),
            Ride::Beyond => Some((self.beyond, self.up)),
        }
    }

    /// Simulates a clock.
    fn clock(&mut self, rng: &mut Xoshiro256PlusPlus) {
        self.glitch = None;
        self.pulse_left = self.pulse_left.saturating_sub(1);
        self.setup_left = self.setup_left.saturating_sub(1);
        self.to_step = self.to_step.saturating_sub(1);
        let level_clocks = u64::from(self.axis.filter_clocks) + 1;
        if self.pulse_left == 0 {
            match self.axis.input {
                StepMode::StepDirection => self.levels[0] = false,
                StepMode::UpDown => self.levels = [false; 2],
                StepMode::Quadrature => {}
            }
        }
        let Some((interval, up)) = self.interval() else {
            if self.axis.filter_clocks > 0 && rng.random_range(0..200) == 0 {
                self.glitch = Some(rng.random_range(0..2));
            }
            return;
        };
        if up != self.up && self.pulse_left == 0 {
            self.up = up;
            self.setup_left = *pick(rng, &[0, 0, 1, 5, 30]);
        }
        if self.axis.input == StepMode::StepDirection && self.pulse_left == 0 {
            self.levels[1] = self.up;
        }
        if self.to_step > 0 || self.setup_left > 0 || self.pulse_left > 0 {
            return;
        }
        self.to_step = interval;
        self.pulse_left = level_clocks;
        match self.axis.input {
            StepMode::StepDirection => self.levels[0] = true,
            StepMode::UpDown => self.levels[usize::from(!self.up)] = true,
            StepMode::Quadrature => {
                self.code = if self.up { self.code + 1 } else { self.code + 3 } & 3;
                self.levels = [matches!(self.code, 1 | 2), self.code >= 2];
            }
        }
    }

    fn pins(&self) -> [u64; 2] {
        let low = self.axis.follower.lines_active_low();
        let mut levels = self.levels;
        if let Some(line) = self.glitch {
            levels[line] = !levels[line];
        }
        [levels[0] != low.a, levels[1] != low.b].map(u64::from)
    }
}

/// Largest speed of a shaper's output over that of its input, Σ|c| / 2^F.
fn overshoot(axis: &InlineShaperAxis) -> f64 {
    let table = axis.shaper.table();
    let sum: f64 = table.taps().iter().map(|tap| f64::from(tap.coefficient.abs())).sum();
    sum / f64::from(1_u32 << table.coefficient_fraction())
}

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct InlineShaperRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    tick_clocks: u64,
    rest_ticks: u64,
    lines: Vec<Lines>,
    first: std::vec::IntoIter<Act>,
    act: Act,
    clocks_left: u64,
    illegal: bool,
}

impl InlineShaperRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(config: &InlineConfig, seed: u64) -> Self {
        let tick_clocks = config.tick.tick_clocks().into();
        let rest_ticks = rest_ticks(config);
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            tick_clocks,
            rest_ticks,
            lines: config.axes.iter().map(|axis| Lines::new(axis, tick_clocks)).collect(),
            first: first_acts(rest_ticks).into_iter(),
            act: Act::ride(1, Ride::Rest, false),
            clocks_left: 4,
            illegal: false,
        }
    }

    fn one_in(&mut self, chances: u64) -> bool {
        self.rng.random_range(0..chances) == 0
    }

    fn next_act(&mut self) -> Act {
        if let Some(act) = self.first.next() {
            return act;
        }
        let few = self.rng.random_range(1..8);
        let rests = self.one_in(3);
        Act {
            ticks: if rests { self.rest_ticks } else { few },
            ride: rests.then_some(Ride::Rest),
            enable: !self.one_in(12),
            bypass: if self.one_in(4) {
                !self.act.bypass
            } else {
                self.act.bypass
            },
            emergency: self.one_in(25),
            clear: self.one_in(3),
        }
    }

    fn any_ride(&mut self) -> Ride {
        let any = self.rng.random_range(-64..=64);
        let sign = *pick(&mut self.rng, &[1, -1]);
        *pick(
            &mut self.rng,
            &[
                Ride::Rest,
                Ride::Part(any),
                Ride::Part(any),
                Ride::Part(sign),
                Ride::Part(64 * sign),
                Ride::Part(64 * sign),
                if self.clock.is_multiple_of(3) {
                    Ride::Beyond
                } else {
                    Ride::Rest
                },
            ],
        )
    }
}

impl Stimuli for InlineShaperRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        if self.clocks_left == 0 {
            self.act = self.next_act();
            // An act may end at any clock of a tick.
            let rest = self.rng.random_range(0..self.tick_clocks);
            self.clocks_left = self.act.ticks * self.tick_clocks + rest * u64::from(self.first.len() == 0);
            for axis in 0..self.lines.len() {
                let ride = self.act.ride.unwrap_or_else(|| self.any_ride());
                self.lines[axis].ride = ride;
            }
            self.illegal = self.first.len() == 0 && self.one_in(20);
        }
        self.clocks_left -= 1;
        for lines in &mut self.lines {
            lines.clock(&mut self.rng);
        }
        // Both lines of quadrature together, once at the end of the first acts, and now and then.
        let ends_first = self.first.len() == 2 && self.clocks_left == 0;
        if ends_first || (self.illegal && self.clocks_left == self.tick_clocks / 2) {
            for lines in self
                .lines
                .iter_mut()
                .filter(|lines| lines.axis.input == StepMode::Quadrature)
            {
                lines.code = (lines.code + 2) & 3;
                lines.levels = lines.levels.map(|level| !level);
            }
        }
        if let Some((shared, of_axes)) = inputs.split_at_mut_checked(SHARED) {
            if let [rst, enable, emergency_stop_n, bypass, clear_faults] = shared {
                *rst = u64::from(self.clock < 2 || (self.first.len() == 0 && self.one_in(200_000)));
                *enable = self.act.enable.into();
                *emergency_stop_n = (!self.act.emergency).into();
                *bypass = self.act.bypass.into();
                *clear_faults = self.act.clear.into();
            }
            let pins = self.lines.iter().flat_map(Lines::pins);
            for (input, pin) in of_axes.iter_mut().zip(pins) {
                *input = pin;
            }
        }
        self.clock += 1;
    }
}
