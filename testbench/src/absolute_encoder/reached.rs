//! Counts of the events in a lockstep run of the absolute encoder.

use posicast_blocks::absolute_encoder::{
    AbsoluteEncoderConfig, AbsoluteProtocol, INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs,
};

use crate::lockstep::Clock;

/// The events of every encoder, in the order of the counters.
const EVENTS: [&str; 20] = [
    "resets in a reading",
    "good readings upwards",
    "good readings downwards",
    "the same position again",
    "counts below zero",
    "counts beyond the range",
    "good readings at the limit upwards",
    "good readings at the limit downwards",
    "extrapolated counts",
    "good readings after an extrapolated one",
    "good readings after as many failed ones as tolerated",
    "lost",
    "known again after lost",
    "silent",
    "stuck",
    "jumped",
    "ticks while busy",
    "ticks in the first clock that takes one",
    "flags in the clock of a clear",
    "ticks while lost",
];

/// Counts of the events in a lockstep run of the absolute encoder.
#[derive(Debug, Clone)]
pub struct AbsoluteEncoderCoverage {
    largest: i32,
    tolerated: u64,
    range: i64,
    period_clocks: u16,
    is_biss: bool,
    has_check: bool,
    has_error: bool,
    has_warning: bool,
    before: Option<(Inputs, Outputs)>,
    last: Option<i32>,
    misses: u64,
    was_lost: bool,
    counts: [u64; EVENTS.len()],
    undelayed: u64,
    delayed: u64,
    check_failed: u64,
    error_bit: u64,
    warning_bit: u64,
}

impl AbsoluteEncoderCoverage {
    /// Creates the counters.
    pub fn new(config: &AbsoluteEncoderConfig) -> Self {
        let (frame, limits) = (config.frame(), config.limits());
        Self {
            largest: limits.largest_jump as i32,
            tolerated: limits.tolerated,
            range: 1 << frame.position_bits,
            period_clocks: config.period_clocks() as u16,
            is_biss: config.protocol() == AbsoluteProtocol::BissC,
            has_check: frame.check.bits() > 0,
            has_error: frame.error.is_some(),
            has_warning: frame.warning.is_some(),
            before: None,
            last: None,
            misses: 0,
            was_lost: false,
            counts: [0; EVENTS.len()],
            undelayed: 0,
            delayed: 0,
            check_failed: 0,
            error_bit: 0,
            warning_bit: 0,
        }
    }

    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok(inputs), Ok(outputs)) = (
            <&[u64; INPUT_PORTS]>::try_from(clock.inputs),
            <&[u64; OUTPUT_PORTS]>::try_from(clock.expected),
        ) else {
            return;
        };
        let (inputs, now) = (Inputs::from_raw(inputs), Outputs::from_raw(outputs));
        if let Some((asked, before)) = self.before {
            self.count(&inputs, &asked, &before, &now);
        }
        self.before = (!inputs.rst).then_some((inputs, now));
        if inputs.rst {
            (self.last, self.misses, self.was_lost) = (None, 0, false);
        }
    }

    fn count(&mut self, inputs: &Inputs, asked: &Inputs, before: &Outputs, now: &Outputs) {
        let good = now.valid && !now.extrapolated;
        let missed = now.valid && now.extrapolated;
        let change = self
            .last
            .filter(|_| good && before.known)
            .map(|last| now.count.wrapping_sub(last));
        let direct = change.filter(|_| self.misses == 0);
        let set = |of: fn(&Outputs) -> bool| of(now) && !of(before);
        let flags: [fn(&Outputs) -> bool; 7] = [
            |shown| shown.check_failed,
            |shown| shown.silent,
            |shown| shown.stuck,
            |shown| shown.error_bit,
            |shown| shown.warning_bit,
            |shown| shown.jumped,
            |shown| shown.overrun,
        ];
        let events = [
            inputs.rst && now.busy,
            change.is_some_and(|change| change > 0),
            change.is_some_and(|change| change < 0),
            change == Some(0),
            good && now.count < 0,
            good && i64::from(now.count) >= self.range,
            direct == Some(self.largest),
            direct == Some(-self.largest),
            missed,
            good && self.misses > 0,
            good && before.known && self.misses == self.tolerated,
            set(|shown| shown.lost),
            self.was_lost && set(|shown| shown.known),
            set(|shown| shown.silent),
            set(|shown| shown.stuck),
            set(|shown| shown.jumped),
            inputs.tick && now.busy,
            inputs.tick && !now.busy && before.busy,
            asked.clear_flags && flags.into_iter().any(set),
            inputs.tick && now.lost,
        ];
        for (count, event) in self.counts.iter_mut().zip(events) {
            *count += u64::from(event);
        }
        self.undelayed += u64::from(good && now.line_delay <= 1);
        self.delayed += u64::from(good && now.line_delay > self.period_clocks);
        self.check_failed += u64::from(set(|shown| shown.check_failed));
        self.error_bit += u64::from(set(|shown| shown.error_bit));
        self.warning_bit += u64::from(set(|shown| shown.warning_bit));
        self.was_lost |= now.lost;
        if good {
            (self.last, self.misses) = (Some(now.count), 0);
            self.was_lost = false;
        }
        self.misses += u64::from(missed);
    }

    /// Returns each event's name and count: those that this encoder can have.
    pub fn counts(&self) -> Vec<(&'static str, u64)> {
        let can_be = |name: &str| match name {
            "counts beyond the range" => self.range <= 1 << 16,
            "extrapolated counts" | "good readings after an extrapolated one" => self.tolerated > 0,
            _ => true,
        };
        let of_every = EVENTS.into_iter().zip(self.counts);
        let mut counts: Vec<_> = of_every.filter(|(name, _)| can_be(name)).collect();
        let special = [
            (self.is_biss, "good readings with the shortest delay", self.undelayed),
            (self.is_biss, "good readings with a delay above a period", self.delayed),
            (self.has_check, "frames with a wrong check", self.check_failed),
            (self.has_error, "frames with the error bit", self.error_bit),
            (self.has_warning, "frames with the warning bit", self.warning_bit),
        ];
        counts.extend(
            special
                .into_iter()
                .filter(|(has, ..)| *has)
                .map(|(_, name, count)| (name, count)),
        );
        counts
    }
}
