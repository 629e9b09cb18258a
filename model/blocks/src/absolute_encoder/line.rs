//! The lines of the encoder: `clock_out`, the moments at which a bit is taken, and how a reading ends.

use super::config::AbsoluteEncoderConfig;
use super::frame::AbsoluteProtocol;

/// Clocks of the synchroniser.
const SYNCHRONISER_CLOCKS: u16 = 2;

/// What a reading waits for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum LineState {
    /// For a tick.
    #[default]
    Rest,
    /// For the first rising edge (SSI), or for the answer (BiSS).
    Answer,
    /// For the middle of the answer's first bit.
    Acknowledged,
    /// For the start bit.
    Start,
    /// For the bit 0 behind the start bit.
    Control,
    /// For the bits of the frame.
    Bits,
    /// For the line to be low behind the last bit (SSI).
    Low,
    /// For the encoder to be ready again.
    Pause,
}

/// A bit of the frame that is taken in this clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct TakenBit {
    pub(super) level: bool,
    /// 0 is the first bit of the position.
    pub(super) place: i32,
}

/// Registers of the lines.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct EncoderLine {
    synchroniser: [bool; 2],
    pub(super) clock_out: bool,
    runs: bool,
    half_timer: u64,
    pub(super) state: LineState,
    /// Whether the line has risen in this reading, and whether it has twice.
    rose: bool,
    rose_twice: bool,
    /// Clocks since the second rising edge, less those of the synchroniser.
    delay: u16,
    pub(super) line_delay: u16,
    /// Clocks of the present bit, up to a period.
    phase: u64,
    /// Clocks of the reading, then of the pause.
    elapsed: u64,
    place: i32,
    /// One clock: the reading has ended, without an answer or with a line that is stuck.
    pub(super) ended: bool,
    pub(super) silent: bool,
    pub(super) stuck: bool,
}

impl EncoderLine {
    pub(super) fn new() -> Self {
        Self {
            synchroniser: [false; 2],
            clock_out: true,
            runs: false,
            half_timer: 0,
            state: LineState::Rest,
            rose: false,
            rose_twice: false,
            delay: 0,
            line_delay: 0,
            phase: 0,
            elapsed: 0,
            place: 0,
            ended: false,
            silent: false,
            stuck: false,
        }
    }

    /// Simulates one clock; `starts` is never set while a reading lasts. Returns a bit that is taken.
    pub(super) fn clock(&mut self, config: &AbsoluteEncoderConfig, starts: bool, data: bool) -> Option<TakenBit> {
        use LineState as State;

        let times = config.times();
        let (half, period) = (times.half_period_clocks, config.period_clocks());
        let is_biss = config.protocol() == AbsoluteProtocol::BissC;
        let level = self.synchroniser[1];
        self.synchroniser = [data, self.synchroniser[0]];

        let half_over = self.runs && self.half_timer == half;
        let rises = half_over && !self.clock_out;
        let samples = self.phase == period;
        let expired = is_biss && self.elapsed >= times.answer_clocks;
        let heard = self.delay < 1 << 15;
        let taken = (self.state == State::Bits && samples).then_some(TakenBit {
            level,
            place: self.place,
        });
        let is_last = taken.is_some() && self.place == last_place(config);

        (self.ended, self.silent, self.stuck) = (false, false, false);
        let mut next_phase = if samples { 1 } else { self.phase + 1 };
        let mut next = self.state;
        match self.state {
            State::Rest if starts && level => next = State::Answer,
            State::Rest => self.stuck = starts,
            State::Answer if !is_biss => {
                if rises {
                    (next, next_phase) = (State::Bits, 1);
                }
            }
            State::Answer if !level => {
                if heard {
                    (next, next_phase, self.line_delay) = (State::Acknowledged, half + 1, self.delay);
                } else {
                    self.stuck = true;
                }
            }
            State::Answer => self.silent = expired,
            State::Acknowledged if samples => {
                if level {
                    self.stuck = true;
                } else {
                    next = State::Start;
                }
            }
            State::Start if samples && level => next = State::Control,
            State::Start => self.stuck = expired,
            State::Control if samples => next = State::Bits,
            State::Bits if is_last && is_biss => self.ended = true,
            State::Bits if is_last => next = State::Low,
            State::Low if !level => self.ended = true,
            State::Low => self.silent = samples,
            State::Pause if !self.runs && self.elapsed == times.pause_clocks => next = State::Rest,
            State::Acknowledged | State::Control | State::Bits | State::Pause => {}
        }
        self.ended |= self.silent || self.stuck;
        if self.ended && self.state != State::Rest {
            next = State::Pause;
        }

        let (begins, ran) = (self.state == State::Rest && next == State::Answer, self.runs);
        self.clock_line(
            half_over,
            begins,
            matches!(next, State::Rest | State::Low | State::Pause),
        );
        if self.rose_twice {
            self.delay = self.delay.wrapping_add(1);
        }
        self.rose_twice |= is_biss && rises && self.rose;
        self.rose |= rises;
        self.place += i32::from(taken.is_some());
        let pauses = self.state != State::Pause && next == State::Pause;
        if begins || pauses || (ran && self.state == State::Pause) {
            self.elapsed = 1;
        } else if self.state != State::Rest {
            self.elapsed += 1;
        }
        if self.state != State::Rest {
            self.phase = next_phase;
        }
        if begins {
            (self.rose, self.rose_twice) = (false, false);
            self.delay = 0u16.wrapping_sub(SYNCHRONISER_CLOCKS);
            self.place = -(config.frame().leading_bits as i32);
        }
        self.state = next;
        taken
    }

    /// Number of coming clocks of a reading in which only timers count while `data` stays.
    pub(super) fn quiet_clocks(&self, config: &AbsoluteEncoderConfig, data: bool) -> u64 {
        let times = config.times();
        let level = self.synchroniser[1];
        if self.ended || self.synchroniser != [data; 2] {
            return 0;
        }
        let to_sample = config.period_clocks().saturating_sub(self.phase);
        let to_half = if self.runs {
            times.half_period_clocks.saturating_sub(self.half_timer)
        } else {
            u64::MAX
        };
        let to_answer = times.answer_clocks.saturating_sub(self.elapsed);
        match self.state {
            LineState::Answer if config.protocol() == AbsoluteProtocol::Ssi => to_half,
            LineState::Answer if level => to_half.min(to_answer),
            LineState::Start => to_half.min(to_answer).min(to_sample),
            LineState::Acknowledged | LineState::Control | LineState::Bits => to_half.min(to_sample),
            LineState::Low if level => to_half.min(to_sample),
            LineState::Pause if !self.runs => times.pause_clocks.saturating_sub(self.elapsed),
            LineState::Rest | LineState::Answer | LineState::Low | LineState::Pause => 0,
        }
    }

    /// Advances the timers by this many such clocks.
    pub(super) fn pass(&mut self, config: &AbsoluteEncoderConfig, clocks: u64) {
        self.phase = (self.phase + clocks - 1) % config.period_clocks() + 1;
        self.elapsed += clocks;
        if self.runs {
            self.half_timer += clocks;
        }
        if self.rose_twice {
            self.delay = self.delay.wrapping_add(clocks as u16);
        }
    }

    /// The clock line; it stops high.
    fn clock_line(&mut self, half_over: bool, begins: bool, stops: bool) {
        if half_over || begins {
            self.half_timer = 1;
        } else if self.runs {
            self.half_timer += 1;
        }
        self.clock_out = (self.clock_out ^ half_over) && !begins;
        self.runs = begins || (self.runs && !(stops && self.clock_out));
    }
}

/// Place of the last bit of a frame.
pub(super) fn last_place(config: &AbsoluteEncoderConfig) -> i32 {
    (config.frame().bits() - config.frame().leading_bits) as i32 - 1
}
