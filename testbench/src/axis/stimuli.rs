//! Seeded random inputs for the supervisor of an axis: a host that enables, starts, stops and clears; segments that
//! obey the supervisor or ignore it; lines with glitches of about the filter's length; every
//! fault, rarely and often; registers that change in any clock.

use std::ops::Range;

use posicast_blocks::axis::{HARMLESS, Inputs, KICK, LEAST_TICK_CLOCKS, OUTPUT_PORTS, Outputs, SupervisorState};
use posicast_blocks::segments::{STAND_COUNTS, SegmentsState as Segments};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Number of clocks between changes of the slow inputs.
const MOOD_CLOCKS: u64 = 1_500;

/// Range of clocks in which nothing happens but ticks, so that the watchdog expires after [`CALM_TICKS`].
const CALM: Range<u64> = 300_000..350_000;
const CALM_TICKS: u16 = 1 << 12;

/// Settings that hold for a while.
#[derive(Debug, Clone, Copy, Default)]
struct Mood {
    /// One tick comes in about this many clocks.
    tick_pace: u32,
    /// The host makes one request in this many clocks.
    request_pace: u32,
    /// One fault comes in this many clocks.
    fault_pace: u32,
    /// A line has one glitch in this many clocks.
    glitch_pace: u32,
    /// The watchdog is kicked once in this many clocks.
    kick_pace: u32,
    /// Whether the segments ignore the supervisor.
    lawless: bool,
}

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct AxisRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    mood: Mood,
    inputs: Inputs,
    until_tick: u32,
    /// Number of clocks left of a glitch, per line.
    glitches: [u32; 5],
    /// Number of ticks for which the segments still play or slow down.
    busy_ticks: u32,
}

impl AxisRandom {
    /// Creates the generator. Equal seeds give equal inputs for equal outputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            mood: Mood::default(),
            inputs: Inputs::default(),
            until_tick: 1,
            glitches: [0; 5],
            busy_ticks: 0,
        }
    }

    fn one_in(&mut self, clocks: u32) -> bool {
        self.rng.random_range(0..clocks) == 0
    }

    /// Returns the mood of an axis that stays on while the host no longer kicks the watchdog.
    fn calm(&mut self, state: SupervisorState) {
        // The ticks must not come at a beat that hides a bit that toggles in every clock, nor too soon after the
        // previous tick.
        let least = u64::from(LEAST_TICK_CLOCKS);
        let ticks = self.clock.is_multiple_of(least) && self.clock >= CALM.start + least && !self.one_in(50);
        let inputs = &self.inputs;
        self.inputs = Inputs {
            tick: ticks,
            enable: inputs.enable || !matches!(state, SupervisorState::Off | SupervisorState::Fault),
            clear_faults: inputs.clear_faults,
            watchdog_ticks: CALM_TICKS,
            kick_word: KICK,
            emergency_stop_n: true,
            limit_plus_n: true,
            limit_minus_n: true,
            drive_ready: true,
            segments_empty: true,
            ..Inputs::default()
        };
    }

    fn new_mood(&mut self) {
        let rng = &mut self.rng;
        self.mood = Mood {
            tick_pace: *pick(rng, &[LEAST_TICK_CLOCKS, LEAST_TICK_CLOCKS, 11, 12, 15, 30]),
            request_pace: *pick(rng, &[5, 60, 300, 300]),
            fault_pace: *pick(rng, &[40, 500, 5_000, 50_000]),
            glitch_pace: *pick(rng, &[100, 3_000, 30_000]),
            kick_pace: *pick(rng, &[10, 40, 40, 5_000]),
            lawless: rng.random_range(0..4) == 0,
        };
        self.registers();
    }

    /// Changes the registers that a host writes and the numbers of other blocks.
    fn registers(&mut self) {
        let rng = &mut self.rng;
        let any = rng.next_u64();
        let mut ticks = || {
            let few = rng.random_range(0..6);
            let one_bit = 1 << rng.random_range(3..9);
            *pick(rng, &[0, few, few, few, few, few, few, one_bit])
        };
        let [release, apply, settle] = [ticks(), ticks(), ticks()];
        let inputs = &mut self.inputs;
        (inputs.brake_release_ticks, inputs.brake_apply_ticks) = (release, apply);
        inputs.settle_ticks = settle;
        inputs.filter_clocks = *pick(rng, &[0, 1, 2, 7, 7, 20, 63]);
        let off_causes = any as u16;
        inputs.off_causes = *pick(rng, &[0, 0, u16::MAX, off_causes]);
        let limit = rng.next_u32() >> rng.random_range(1..32);
        let watched = rng.random_range(0..4) == 0;
        inputs.modulo = any & 7 << 20 == 0;
        inputs.watches_direction = any & 1 << 23 == 0;
        inputs.limits_after_homing = any & 1 << 24 == 0;
        inputs.following_error_limit = if watched { limit } else { 0 };
        inputs.deviation_limit = if any & 1 << 16 == 0 { 0 } else { limit };
        inputs.lost_command = if any & 1 << 17 == 0 { limit } else { 0 };
        let few = rng.random_range(0..9);
        let one_bit = 1 << rng.random_range(0..9);
        inputs.lost_ticks = *pick(rng, &[0, few, one_bit, u16::MAX]);
        inputs.saturation_ticks = *pick(rng, &[0, few, one_bit, u16::MAX]);
        inputs.watchdog_ticks = *pick(rng, &[0, few * 10, one_bit, u16::MAX]);
        let (one, other) = (rng.next_u32() as i32 >> 8, rng.next_u32() as i32 >> 12);
        (inputs.soft_limit_plus, inputs.soft_limit_minus) = *pick(
            rng,
            &[
                (0, 0),
                (0, 0),
                (one, other),
                (i32::MAX, i32::MIN),
                (100, -100),
                (100, 0),
            ],
        );
    }

    /// Draws numbers at and around their limits.
    fn numbers(&mut self) {
        let rng = &mut self.rng;
        let inputs = &mut self.inputs;
        let near = |rng: &mut Xoshiro256PlusPlus, limit: i32| {
            let step = rng.random_range(-1..3);
            let size = limit.wrapping_add(step);
            let any = rng.next_u32() as i32 >> rng.random_range(0..32);
            *pick(rng, &[0, 0, 0, 0, size, size.wrapping_neg(), any, i32::MIN, i32::MAX])
        };
        match rng.random_range(0..9) {
            0 => inputs.error = near(rng, inputs.following_error_limit as i32),
            1 => inputs.deviation = near(rng, inputs.deviation_limit as i32),
            2 => inputs.command = near(rng, inputs.lost_command as i32),
            3 => inputs.command_velocity = near(rng, 1),
            4 => inputs.reference_velocity = near(rng, 1),
            5 => inputs.reference_position = near(rng, inputs.soft_limit_plus),
            6 => inputs.reference_position = near(rng, inputs.soft_limit_minus),
            7 => {
                let [step, few] = [rng.random_range(-1..2), rng.random_range(-6..7)];
                let (here, end) = (inputs.position, STAND_COUNTS + rng.random_range(-2..3));
                let any = rng.next_u32() as i32;
                let ends = *pick(rng, &[end, -end, any, 0, 0, 0]);
                let [step, few] = [step, few].map(|counts| here.wrapping_add(counts));
                inputs.position = *pick(rng, &[step, step, step, step, step, step, few, ends]);
            }
            _ => {
                let any = rng.next_u32() as u16;
                let limit = inputs.saturation_ticks;
                inputs.limited_ticks = *pick(rng, &[0, limit, limit.saturating_sub(1), any]);
            }
        }
    }

    fn lines(&mut self) {
        let longest = u32::from(self.inputs.filter_clocks) + 3;
        for at in 0..self.glitches.len() {
            self.glitches[at] = self.glitches[at].saturating_sub(1);
            if self.one_in(self.mood.glitch_pace) {
                let long = if at == 4 { 90 } else { 200 };
                let any = self.rng.random_range(1..=longest);
                self.glitches[at] = *pick(&mut self.rng, &[any, longest - 2, longest - 1, long]);
            }
        }
        let quiet = self.glitches.map(|left| left == 0);
        let inputs = &mut self.inputs;
        [inputs.emergency_stop_n, inputs.limit_plus_n, inputs.limit_minus_n, ..] = quiet;
        [.., inputs.drive_ready, inputs.home] = quiet;
    }

    fn host(&mut self, state: SupervisorState) {
        let pace = self.mood.request_pace;
        let (stop, clear) = (self.one_in(pace * 6), self.one_in(50));
        let toggles = self.one_in(pace * 4);
        let inputs = &mut self.inputs;
        (inputs.stop, inputs.clear_faults) = (stop, clear);
        // Without this an axis would soon stay in OFF for ever.
        inputs.enable = if toggles { !inputs.enable } else { inputs.enable };
        let (back, start) = (self.one_in(20), self.one_in(10));
        if back {
            self.inputs.enable = !matches!(state, SupervisorState::Off | SupervisorState::Fault);
        }
        self.inputs.start = start;
        self.inputs.write_homed = self.one_in(100);
        self.inputs.homed_value = !self.one_in(4);
        self.inputs.kick = self.one_in(self.mood.kick_pace);
        let wrong = KICK ^ 1 << self.rng.random_range(0..32);
        self.inputs.kick_word = *pick(&mut self.rng, &[KICK, KICK, KICK, wrong]);
    }

    fn faults(&mut self) {
        let pace = self.mood.fault_pace;
        let mut held = [false; 16];
        for is in &mut held {
            *is = self.rng.random_range(0..pace * 16) == 0;
        }
        let (asks, long) = (self.one_in(300), self.one_in(10));
        let any = self.rng.next_u32();
        let inputs = &mut self.inputs;
        // The flags of other blocks stay until they are cleared.
        for (flag, is) in [
            &mut inputs.segments_underrun,
            &mut inputs.segments_overflow,
            &mut inputs.segments_tick_missed,
            &mut inputs.shaper_overrun,
            &mut inputs.controller_overrun,
            &mut inputs.pwm_tripped,
            &mut inputs.encoder_illegal,
            &mut inputs.encoder_disagreement,
            &mut inputs.velocity_missed,
            &mut inputs.scale_illegal,
            &mut inputs.scale_disagreement,
            &mut inputs.segments_out_of_range,
            &mut inputs.shaper_saturated,
        ]
        .into_iter()
        .zip(held)
        {
            *flag = is || (*flag && !inputs.clear_faults);
        }
        for (flags, is, found) in [
            (&mut inputs.saturated_high, held[14], any),
            (&mut inputs.saturated_low, held[15], any >> 8),
        ] {
            let kept = if inputs.clear_faults { 0 } else { *flags };
            *flags = if is { kept | found as u8 & 0x7f } else { kept };
        }
        inputs.group_stop = asks || (inputs.group_stop && !long);
        inputs.group_emergency_stop = held[13];
    }

    /// Imitates the segments as the supervisor sees them.
    fn segments(&mut self, seen: &Outputs) {
        let any = self.rng.random_range(0..4);
        let busy = self.rng.random_range(1..12);
        let inputs = &mut self.inputs;
        if self.mood.lawless {
            if any == 0 {
                inputs.segments_state = self.rng.random_range(0..4);
                inputs.segments_empty = self.rng.random_range(0..2) == 0;
                inputs.segments_valid = self.rng.random_range(0..9) == 0;
            }
            return;
        }
        inputs.segments_valid = self.until_tick == self.mood.tick_pace / 2;
        if !inputs.tick {
            return;
        }
        self.busy_ticks = self.busy_ticks.saturating_sub(1);
        let moves = inputs.segments_state == Segments::Move as u8;
        let slows = inputs.segments_state == Segments::Stop as u8;
        let over = self.busy_ticks == 0;
        let state = match () {
            () if seen.segments_preset => Segments::Hold,
            () if seen.segments_quick_stop && moves => Segments::Stop,
            () if seen.segments_quick_stop && !slows => Segments::Stopped,
            () if seen.segments_restart => Segments::Hold,
            () if moves && over => Segments::Hold,
            () if slows && over => Segments::Stopped,
            () if seen.segments_enable && !inputs.segments_empty && !slows => Segments::Move,
            () => return,
        } as u8;
        if state != inputs.segments_state {
            self.busy_ticks = busy;
            inputs.segments_empty = any != 0;
        }
        inputs.segments_state = state;
    }
}

impl Stimuli for AxisRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        if self.clock.is_multiple_of(MOOD_CLOCKS) {
            self.new_mood();
        } else if self.one_in(400) {
            self.registers();
        }
        let seen = <&[u64; OUTPUT_PORTS]>::try_from(seen).map_or_else(|_| Outputs::default(), Outputs::from_raw);
        self.until_tick = self.until_tick.saturating_sub(1);
        self.inputs.tick = self.until_tick == 0;
        if self.inputs.tick {
            self.until_tick = self.mood.tick_pace + self.rng.random_range(0..2);
        }
        self.inputs.rst = self.clock < 2 || self.one_in(20_000);
        // A host commits new segments.
        if self.one_in(40) {
            self.inputs.segments_empty = false;
        }
        self.host(seen.state);
        self.lines();
        self.faults();
        self.segments(&seen);
        if self.one_in(6) {
            self.numbers();
        }
        // A cause that is over soon keeps a run from spending all its time in FAULT.
        if seen.causes & !HARMLESS != 0 {
            (self.inputs.error, self.inputs.deviation) = (0, 0);
            self.inputs.position %= STAND_COUNTS;
        }
        if CALM.contains(&self.clock) {
            self.calm(seen.state);
        }
        for (input, value) in inputs.iter_mut().zip(self.inputs.to_raw()) {
            *input = value;
        }
        self.clock += 1;
    }
}
