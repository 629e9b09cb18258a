//! Seeded random inputs for the drive command: a supervisor that is mostly in READY or beyond, ticks and controllers
//! at every pace, kicks in time and too late, duties at and around their limits, limit switches, faults; resets in
//! any clock.

use std::ops::Range;

use posicast_blocks::axis::SupervisorState;
use posicast_blocks::drive_command::{DUTY_BITS, INPUT_PORTS, OUTPUT_PORTS};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lockstep::Clock;
use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Number of clocks between changes of the slow inputs.
const MOOD_CLOCKS: u64 = 500;

/// Range of clocks of the single long self-test: the periods double, then a gate is on for longer than its counter
/// can count.
const LONG_TEST: Range<u64> = 350_000..466_500;
/// Range of clocks of the single long hold: a kick, and then as many ticks as direct mode can last, and some more. Elsewhere the
/// count of ticks never reaches its upper bits.
const LONG_HOLD: Range<u64> = 600_000..665_600;

/// Clock of the last valley of the long self-test.
const LONG_TEST_VALLEY: u64 = 466_000;

/// Returns whether a clock of the long self-test is a valley. Long periods have an odd number of clocks: a fault that
/// toggles in every clock would not show in an even number.
fn is_long_valley(clock: u64) -> bool {
    let since = clock - LONG_TEST.start;
    let doubled = (0..=14).any(|doubling| since == (3 << doubling) + doubling);
    clock == LONG_TEST_VALLEY || doubled
}

/// Settings that hold for a while.
#[derive(Debug, Clone, Copy, Default)]
struct Mood {
    state: u64,
    /// Enables of the PWM, the drive and the brake from the supervisor.
    outputs: [bool; 3],
    tick_pace: u32,
    kick_pace: u32,
    /// A line is low in one of this many clocks.
    line_pace: u32,
    hold_ticks: u64,
    limit: i64,
    self_test: bool,
    valley_pace: u32,
}

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct DriveCommandRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    mood: Mood,
    direct_duty: i64,
}

impl DriveCommandRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            mood: Mood::default(),
            direct_duty: 0,
        }
    }

    fn new_mood(&mut self) {
        let rng = &mut self.rng;
        let states = [
            SupervisorState::Ready,
            SupervisorState::Ready,
            SupervisorState::Ready,
            SupervisorState::Hold,
            SupervisorState::Run,
        ]
        .map(|state| state as u64);
        let any_state = rng.random_range(0..8);
        let state = *pick(rng, &[states[0], states[1], states[2], states[3], states[4], any_state]);
        let on = matches!(
            SupervisorState::from_value(state),
            Some(SupervisorState::Hold | SupervisorState::Run | SupervisorState::QuickStop)
        );
        // Now and then the outputs take values that no supervisor produces.
        let outputs = [(); 3].map(|()| on != (rng.random_range(0..12) == 0));
        let size = rng.random_range(0..=16);
        let any_limit: i64 = rng.random_range(0..=65_535);
        let one_bit = rng.random_range(3..16);
        self.mood = Mood {
            state,
            outputs,
            tick_pace: *pick(rng, &[1, 2, 7, 20]),
            kick_pace: *pick(rng, &[3, 10, 30, 100]),
            line_pace: *pick(rng, &[2, 20, 100_000, 100_000]),
            hold_ticks: *pick(rng, &[0, 1, 2, 3, 5, 1 << one_bit, 1 << one_bit, 65_535]),
            limit: *pick(rng, &[0, 65_535, any_limit, any_limit >> size]),
            self_test: rng.random_range(0..3) == 0,
            valley_pace: *pick(rng, &[1, 4, 20, 60]),
        };
    }

    /// Draws a manual duty of any size, also at the limits and one LSB beyond.
    fn new_direct_duty(&mut self) {
        let rng = &mut self.rng;
        let any: i64 = rng.random_range(-65_536..=65_535);
        let about = self.mood.limit + rng.random_range(-1..=2);
        let small = any >> rng.random_range(0..17);
        self.direct_duty = *pick(rng, &[any, small, small, about, -about, 0, -65_536, 65_535]);
    }
}

impl Stimuli for DriveCommandRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        let Ok(inputs) = <&mut [u64; INPUT_PORTS]>::try_from(inputs) else {
            return;
        };
        if self.clock.is_multiple_of(MOOD_CLOCKS) {
            self.new_mood();
        }
        if self.rng.random_range(0..20) == 0 {
            self.new_direct_duty();
        }
        let mood = self.mood;
        let rng = &mut self.rng;
        let any: i64 = rng.random_range(-131_072..=131_071);
        let about_the_end = rng.random_range(65_534..=65_537);
        let small = any >> rng.random_range(0..18);
        let controller_duty = *pick(rng, &[any, small, about_the_end, -about_the_end]);
        let mut once_in = |pace: u32| rng.random_range(0..pace) == 0;
        let state = if once_in(200) { self.clock % 8 } else { mood.state };
        let [pwm, drive, brake] = mood.outputs.map(|output| output != once_in(500));
        let lines = [(); 4].map(|()| u64::from(!once_in(mood.line_pace)));
        let self_test = mood.self_test != once_in(150);
        *inputs = [
            u64::from(self.clock < 2 || once_in(1000)),
            u64::from(once_in(mood.tick_pace)),
            controller_duty as u64,
            u64::from(once_in(6)),
            state,
            u64::from(pwm),
            u64::from(drive),
            u64::from(brake),
            lines[0],
            lines[1],
            lines[2],
            lines[3],
            u64::from(!once_in(300)),
            u64::from(once_in(mood.kick_pace)),
            mood.hold_ticks,
            self.direct_duty as u64,
            mood.limit as u64,
            u64::from(self_test),
            0,
            u64::from(once_in(mood.valley_pace)),
        ];
        inputs[18] = rng.random_range(0..16);
        if LONG_TEST.contains(&self.clock) {
            let valley = u64::from(is_long_valley(self.clock));
            (inputs[0], inputs[4], inputs[12]) = (0, SupervisorState::Ready as u64, 1);
            (inputs[13], inputs[14]) = (1, 65_535);
            (inputs[17], inputs[18], inputs[19]) = (1, 3, valley);
        }
        if LONG_HOLD.contains(&self.clock) {
            let kick = u64::from(self.clock == LONG_HOLD.start);
            (inputs[0], inputs[1], inputs[4], inputs[12]) = (0, 1, SupervisorState::Ready as u64, 1);
            (inputs[13], inputs[14], inputs[17]) = (kick, 65_535, 0);
        }
        self.clock += 1;
    }
}

/// Names of the counted events.
const NAMES: [&str; 24] = [
    "resets",
    "clocks off",
    "duties of the controller",
    "duties of the controller saturated at the upper end",
    "duties of the controller saturated at the lower end",
    "direct mode begun",
    "manual duties at the limit, positive",
    "manual duties at the limit, negative",
    "manual duties below the limit",
    "manual duties that turn",
    "limit switch + on the way",
    "limit switch - on the way",
    "direct mode expired",
    "direct mode ended by READY left",
    "direct mode ended by direct_enable",
    "direct mode ended, the supervisor on",
    "self-test begun",
    "self-test ended by its flag",
    "direct mode ended by the self-test's flag",
    "self-test ended, the supervisor wants the PWM",
    "self-test begun again behind its mask",
    "clocks of a_high counted",
    "clocks of a_low counted",
    "clocks of a gate beyond the end of the counter",
];

/// Counts of the events in a lockstep run of the drive command.
#[derive(Debug, Clone, Copy, Default)]
pub struct DriveCommandCoverage {
    counts: [u64; NAMES.len()],
    /// Inputs and outputs of the previous clock.
    before: Option<([u64; INPUT_PORTS], [u64; OUTPUT_PORTS])>,
}

impl DriveCommandCoverage {
    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok(inputs), Ok(shown)) = (clock.inputs.try_into(), clock.expected.try_into()) else {
            return;
        };
        if let Some((inputs, before)) = self.before.replace((inputs, shown)) {
            let seen = Self::seen(&inputs, &before, &shown);
            for (count, seen) in self.counts.iter_mut().zip(seen) {
                *count += u64::from(seen);
            }
        }
    }

    fn seen(
        inputs: &[u64; INPUT_PORTS],
        before: &[u64; OUTPUT_PORTS],
        shown: &[u64; OUTPUT_PORTS],
    ) -> [bool; NAMES.len()] {
        let &[rst, tick, .., plus_ok, minus_ok, enable, _, _, _, limit, _, _, _] = inputs;
        let [controller_valid, state] = [inputs[3], inputs[4]].map(|value| value & 7);
        let signed = |duty: u64| (duty << (64 - DUTY_BITS)) as i64 >> (64 - DUTY_BITS);
        let (duty, duty_before) = (signed(shown[0]), signed(before[0]));
        let [on, active, was_active] = [shown[2], shown[6], before[6]].map(|value| value == 1);
        let running = rst == 0;
        let controlled = running && on && !active && !was_active && controller_valid == 1;
        let manual = running && active && was_active && tick == 1;
        let held = running && active && was_active && tick == 0;
        let limit = limit as i64;
        let [masked, was_masked] = [shown[8], before[8]].map(|value| value == 1);
        let [self_test, valley] = [inputs[17], inputs[19]].map(|value| value == 1);
        let flagged = state == SupervisorState::Ready as u64 && enable == 1;
        let ended = running && was_active && !active;
        [
            !running,
            running && !on,
            controlled,
            controlled && duty == 65_535,
            controlled && duty == -65_536,
            running && active && !was_active,
            manual && duty == limit && limit > 0,
            manual && duty == -limit && limit > 0,
            manual && duty != 0 && duty.abs() < limit,
            manual && duty_before != 0 && duty == 0 && plus_ok == 1 && minus_ok == 1 && limit > 0,
            held && duty_before > 0 && duty == 0 && plus_ok == 0,
            held && duty_before < 0 && duty == 0 && minus_ok == 0,
            shown[7] == 1,
            ended && state != SupervisorState::Ready as u64,
            ended && state == SupervisorState::Ready as u64 && enable == 0,
            ended && on,
            running && active && masked && !was_masked,
            ended && was_masked && !self_test && flagged,
            ended && !was_masked && self_test && flagged,
            ended && was_masked && inputs[5] == 1,
            running && active && masked && !was_active && was_masked,
            was_masked && valley && shown[9] > 1,
            was_masked && valley && shown[10] > 1,
            shown[9] == 65_535,
        ]
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); NAMES.len()] {
        std::array::from_fn(|bin| (NAMES[bin], self.counts[bin]))
    }
}
