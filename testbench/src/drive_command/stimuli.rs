//! Seeded random inputs for the drive command: a supervisor that is mostly in READY or beyond, ticks and controllers
//! at every pace, kicks in time and too late, duties at and around their limits, limit switches, faults; resets in
//! any clock.

use std::ops::Range;

use posicast_blocks::axis::SupervisorState;
use posicast_blocks::drive_command::{INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs};
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
    state: u8,
    /// Enables of the PWM, the drive and the brake from the supervisor.
    outputs: [bool; 3],
    tick_pace: u32,
    kick_pace: u32,
    /// A line is low in one of this many clocks.
    line_pace: u32,
    hold_ticks: u16,
    limit: u16,
    self_test: bool,
    valley_pace: u32,
}

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct DriveCommandRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    mood: Mood,
    direct_duty: i32,
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
        .map(|state| state as u8);
        let any_state = rng.random_range(0..8_u64) as u8;
        let state = *pick(rng, &[states[0], states[1], states[2], states[3], states[4], any_state]);
        let on = matches!(
            SupervisorState::from_value(state.into()),
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
            limit: *pick(rng, &[0, 65_535, any_limit, any_limit >> size]) as u16,
            self_test: rng.random_range(0..3) == 0,
            valley_pace: *pick(rng, &[1, 4, 20, 60]),
        };
    }

    /// Draws a manual duty of any size, also at the limits and one LSB beyond.
    fn new_direct_duty(&mut self) {
        let rng = &mut self.rng;
        let any: i64 = rng.random_range(-65_536..=65_535);
        let about = i64::from(self.mood.limit) + rng.random_range(-1..=2);
        let small = any >> rng.random_range(0..17);
        self.direct_duty = *pick(rng, &[any, small, small, about, -about, 0, -65_536, 65_535]) as i32;
    }
}

impl Stimuli for DriveCommandRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        let Ok(raw) = <&mut [u64; INPUT_PORTS]>::try_from(inputs) else {
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
        let state = if once_in(200) {
            (self.clock % 8) as u8
        } else {
            mood.state
        };
        let [pwm, drive, brake] = mood.outputs.map(|output| output != once_in(500));
        let lines = [(); 4].map(|()| !once_in(mood.line_pace));
        let self_test = mood.self_test != once_in(150);
        let mut inputs = Inputs {
            rst: self.clock < 2 || once_in(1000),
            tick: once_in(mood.tick_pace),
            controller_duty: controller_duty as i32,
            controller_valid: once_in(6),
            axis_state: state,
            axis_pwm_enable: pwm,
            axis_drive_enable: drive,
            axis_brake_release: brake,
            axis_pwm_trip_n: lines[0],
            drive_fault_n: lines[1],
            limit_plus_ok: lines[2],
            limit_minus_ok: lines[3],
            direct_enable: !once_in(300),
            direct_kick: once_in(mood.kick_pace),
            direct_hold_ticks: mood.hold_ticks,
            direct_duty: self.direct_duty,
            direct_limit: mood.limit,
            self_test,
            gates: 0,
            valley: once_in(mood.valley_pace),
        };
        inputs.gates = rng.random_range(0..16_u64) as u8;
        let in_direct_mode = Inputs {
            rst: false,
            axis_state: SupervisorState::Ready as u8,
            direct_enable: true,
            direct_hold_ticks: 65_535,
            ..inputs
        };
        if LONG_TEST.contains(&self.clock) {
            inputs = Inputs {
                direct_kick: true,
                self_test: true,
                gates: 0b11,
                valley: is_long_valley(self.clock),
                ..in_direct_mode
            };
        }
        if LONG_HOLD.contains(&self.clock) {
            inputs = Inputs {
                tick: true,
                direct_kick: self.clock == LONG_HOLD.start,
                self_test: false,
                ..in_direct_mode
            };
        }
        *raw = inputs.to_raw();
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
    before: Option<(Inputs, Outputs)>,
}

impl DriveCommandCoverage {
    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok(inputs), Ok(shown)) = (
            <&[u64; INPUT_PORTS]>::try_from(clock.inputs),
            <&[u64; OUTPUT_PORTS]>::try_from(clock.expected),
        ) else {
            return;
        };
        let (inputs, shown) = (Inputs::from_raw(inputs), Outputs::from_raw(shown));
        if let Some((inputs, before)) = self.before.replace((inputs, shown)) {
            let seen = Self::seen(&inputs, &before, &shown);
            for (count, seen) in self.counts.iter_mut().zip(seen) {
                *count += u64::from(seen);
            }
        }
    }

    fn seen(inputs: &Inputs, before: &Outputs, shown: &Outputs) -> [bool; NAMES.len()] {
        let (duty, limit) = (shown.duty, i32::from(inputs.direct_limit));
        let (active, was_active) = (shown.direct_active, before.direct_active);
        let (masked, was_masked) = (shown.mask_pins, before.mask_pins);
        let (on, running) = (shown.pwm_enable, !inputs.rst);
        let controlled = running && on && !active && !was_active && inputs.controller_valid;
        let manual = running && active && was_active && inputs.tick;
        let held = running && active && was_active && !inputs.tick;
        let ready = inputs.axis_state == SupervisorState::Ready as u8;
        let flagged = ready && inputs.direct_enable;
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
            manual && before.duty != 0 && duty == 0 && inputs.limit_plus_ok && inputs.limit_minus_ok && limit > 0,
            held && before.duty > 0 && duty == 0 && !inputs.limit_plus_ok,
            held && before.duty < 0 && duty == 0 && !inputs.limit_minus_ok,
            shown.direct_expired,
            ended && !ready,
            ended && ready && !inputs.direct_enable,
            ended && on,
            running && active && masked && !was_masked,
            ended && was_masked && !inputs.self_test && flagged,
            ended && !was_masked && inputs.self_test && flagged,
            ended && was_masked && inputs.axis_pwm_enable,
            running && active && masked && !was_active && was_masked,
            was_masked && inputs.valley && shown.self_test_high > 1,
            was_masked && inputs.valley && shown.self_test_low > 1,
            shown.self_test_high == 65_535,
        ]
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); NAMES.len()] {
        std::array::from_fn(|bin| (NAMES[bin], self.counts[bin]))
    }
}
