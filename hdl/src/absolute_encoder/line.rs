//! The lines of the encoder: the clock line, the moments at which a bit is taken, and how a reading ends.
//!
//! A bit is taken at the end of each period of `phase`. SSI starts the periods at the first rising edge of the clock line,
//! BiSS half a period after the edge of the answer: then a bit is taken in its middle, and the delay of the line drops out.

use crate::prelude::*;
use posicast_blocks::absolute_encoder::{AbsoluteEncoderConfig, AbsoluteProtocol};

kernel! {
    pub(super) struct AbsoluteLine(config: &AbsoluteEncoderConfig);

    inputs { rst: Bit, starts: Bit, data: Bit }
    outputs {
        clock_out: Bit, level: Bit, takes: Bit, place: Bits<7>, resting: Bit, ended: Bit, silent: Bit, stuck: Bit,
        line_delay: Bits<16>,
    }
    parts { pin: Synchroniser }
    registers {
        line: Bit = true, runs: Bit, half_timer: Bits<12>, state: Bits<3>, rose: Bit, rose_twice: Bit,
        delay: Bits<16>, line_delay_q: Bits<16>, phase: Bits<13>, elapsed: Bits<16>, place_q: Bits<7>, ended_q: Bit,
        silent_q: Bit, stuck_q: Bit,
    }
    wires {
        at_rest: Bit, in_answer: Bit, in_acknowledged: Bit, in_start: Bit, in_control: Bit, in_bits: Bit, in_low: Bit,
        in_pause: Bit, half_over: Bit, rises: Bit, next_line: Bit, samples: Bit, expired: Bit, heard: Bit, begins: Bit,
        rose_first: Bit, answers: Bit, falls_early: Bit, gives_up: Bit, acknowledges: Bit, keeps_low: Bit, begins_frame: Bit,
        takes_bit: Bit, takes_last: Bit, completes: Bit, is_silent: Bit, is_stuck: Bit, pauses: Bit, ready: Bit,
        stops: Bit, next_state: Bits<3>,
    }
    constants {
        biss: Bit = config.protocol() == AbsoluteProtocol::BissC,
        half: Bits<12> = from_u64(config.times().half_period_clocks),
        used_half: Bits<12> = from_u64(used(config.times().half_period_clocks)),
        period: Bits<13> = from_u64(config.period_clocks()),
        used_period: Bits<13> = from_u64(used(config.period_clocks())),
        past_half: Bits<13> = from_u64(config.times().half_period_clocks + 1),
        answer: Bits<16> = from_u64(config.times().answer_clocks.max(1)),
        pause: Bits<16> = from_u64(config.times().pause_clocks),
        used_elapsed: Bits<16> = from_u64(used(longest(config))),
        first_place: Bits<7> = from_u64(0u64.wrapping_sub(config.frame().leading_bits.into()) & 0x7f),
        last_place: Bits<7> = from_u64(last_place(config)),
        one_place: Bits<7> = from_u64(1),
        one_half: Bits<12> = from_u64(1),
        one_phase: Bits<13> = from_u64(1),
        one_clock: Bits<16> = from_u64(1),
        synchroniser_delay: Bits<16> = from_u64(0xfffe),
        rest_state: Bits<3> = from_u64(0),
        answer_state: Bits<3> = from_u64(1),
        acknowledged_state: Bits<3> = from_u64(2),
        start_state: Bits<3> = from_u64(3),
        control_state: Bits<3> = from_u64(4),
        bits_state: Bits<3> = from_u64(5),
        low_state: Bits<3> = from_u64(6),
        pause_state: Bits<3> = from_u64(7),
    }
}

/// The bits of a counter that goes up to this number.
pub(super) fn used(most: u64) -> u64 {
    (most + 1).next_power_of_two() - 1
}

/// Largest number of clocks that the timer of a reading must hold.
fn longest(config: &AbsoluteEncoderConfig) -> u64 {
    let times = config.times();
    // The answer may come in the last clock, and is looked at half a period later.
    times
        .pause_clocks
        .max(times.answer_clocks + times.half_period_clocks + 1)
}

fn last_place(config: &AbsoluteEncoderConfig) -> u64 {
    u64::from(config.frame().bits() - config.frame().leading_bits - 1)
}

impl Logic for AbsoluteLine {
    #[hdl_gen]
    fn update(&mut self) {
        comment!(
            "@module absolute_line_${value biss}_${value half}x${value pause}x${value answer}_${value first_place}x${value last_place}"
        );
        self.pin.pin.next = self.data.val();

        self.at_rest.next = self.state.q.val() == self.rest_state.val();
        self.in_answer.next = self.state.q.val() == self.answer_state.val();
        self.in_acknowledged.next = self.state.q.val() == self.acknowledged_state.val();
        self.in_start.next = self.state.q.val() == self.start_state.val();
        self.in_control.next = self.state.q.val() == self.control_state.val();
        self.in_bits.next = self.state.q.val() == self.bits_state.val();
        self.in_low.next = self.state.q.val() == self.low_state.val();
        self.in_pause.next = self.state.q.val() == self.pause_state.val();

        comment!("Half periods of the clock line");
        self.half_over.next = self.runs.q.val() & (self.half_timer.q.val() == self.half.val());
        self.rises.next = self.half_over.val() & !self.line.q.val();
        self.next_line.next = self.line.q.val() ^ self.half_over.val();
        self.samples.next = self.phase.q.val() == self.period.val();
        self.expired.next = self.biss.val() & (self.elapsed.q.val() >= self.answer.val());

        comment!("From the tick to the first bit");
        self.begins.next = self.at_rest.val() & self.starts.val() & self.pin.level.val();
        self.rose_first.next = self.in_answer.val() & !self.biss.val() & self.rises.val();
        self.heard.next = !self.delay.q.val().get_bit(15);
        self.answers.next = self.in_answer.val() & self.biss.val() & !self.pin.level.val() & self.heard.val();
        self.falls_early.next = self.in_answer.val() & self.biss.val() & !self.pin.level.val() & !self.heard.val();
        self.gives_up.next = self.in_answer.val() & self.pin.level.val() & self.expired.val();
        self.acknowledges.next = self.in_acknowledged.val() & self.samples.val() & !self.pin.level.val();
        self.begins_frame.next = self.in_start.val() & self.samples.val() & self.pin.level.val();
        self.keeps_low.next = self.in_start.val() & !(self.samples.val() & self.pin.level.val()) & self.expired.val();

        comment!("The bits, and how the reading ends");
        self.takes_bit.next = self.in_bits.val() & self.samples.val();
        self.takes_last.next = self.takes_bit.val() & (self.place_q.q.val() == self.last_place.val());
        self.completes.next = (self.takes_last.val() & self.biss.val()) | (self.in_low.val() & !self.pin.level.val());
        self.is_silent.next = self.gives_up.val() | (self.in_low.val() & self.pin.level.val() & self.samples.val());
        self.is_stuck.next = (self.at_rest.val() & self.starts.val() & !self.pin.level.val())
            | self.falls_early.val()
            | (self.in_acknowledged.val() & self.samples.val() & self.pin.level.val())
            | self.keeps_low.val();
        self.ended_q.d.next = self.completes.val() | self.is_silent.val() | self.is_stuck.val();
        self.silent_q.d.next = self.is_silent.val();
        self.stuck_q.d.next = self.is_stuck.val();
        self.pauses.next = (self.completes.val() | self.is_silent.val() | self.is_stuck.val()) & !self.at_rest.val();
        self.ready.next = self.in_pause.val() & !self.runs.q.val() & (self.elapsed.q.val() == self.pause.val());

        self.next_state.next = self.state.q.val();
        if self.begins.val() {
            self.next_state.next = self.answer_state.val();
        }
        if self.answers.val() {
            self.next_state.next = self.acknowledged_state.val();
        }
        if self.acknowledges.val() {
            self.next_state.next = self.start_state.val();
        }
        if self.begins_frame.val() {
            self.next_state.next = self.control_state.val();
        }
        if self.rose_first.val() | (self.in_control.val() & self.samples.val()) {
            self.next_state.next = self.bits_state.val();
        }
        if self.takes_last.val() & !self.biss.val() {
            self.next_state.next = self.low_state.val();
        }
        if self.pauses.val() {
            self.next_state.next = self.pause_state.val();
        }
        if self.ready.val() {
            self.next_state.next = self.rest_state.val();
        }
        self.state.d.next = self.next_state.val();

        comment!("The clock line stops high");
        self.stops.next = (self.next_state.val() == self.rest_state.val())
            | (self.next_state.val() == self.low_state.val())
            | (self.next_state.val() == self.pause_state.val());
        self.runs.d.next = self.begins.val() | (self.runs.q.val() & !(self.stops.val() & self.next_line.val()));
        self.line.d.next = self.next_line.val() & !self.begins.val();
        if self.runs.q.val() {
            self.half_timer.d.next = (self.half_timer.q.val() + self.one_half.val()) & self.used_half.val();
        }
        if self.half_over.val() | self.begins.val() {
            self.half_timer.d.next = self.one_half.val();
        }

        comment!("Periods of the bits");
        if !self.at_rest.val() {
            self.phase.d.next = (self.phase.q.val() + self.one_phase.val()) & self.used_period.val();
            self.elapsed.d.next = (self.elapsed.q.val() + self.one_clock.val()) & self.used_elapsed.val();
        }
        if (self.samples.val() & !self.at_rest.val()) | self.rose_first.val() {
            self.phase.d.next = self.one_phase.val();
        }
        if self.answers.val() {
            self.phase.d.next = self.past_half.val();
            self.line_delay_q.d.next = self.delay.q.val();
        }
        if self.begins.val() | self.pauses.val() | (self.runs.q.val() & self.in_pause.val()) {
            self.elapsed.d.next = self.one_clock.val();
        }

        comment!("The delay, from the second rising edge on");
        if self.rose_twice.q.val() {
            self.delay.d.next = self.delay.q.val() + self.one_clock.val();
        }
        if self.rises.val() {
            self.rose.d.next = true;
            self.rose_twice.d.next = self.biss.val() & (self.rose.q.val() | self.rose_twice.q.val());
        }
        if self.takes_bit.val() {
            self.place_q.d.next = self.place_q.q.val() + self.one_place.val();
        }
        if self.begins.val() {
            self.rose.d.next = false;
            self.rose_twice.d.next = false;
            self.delay.d.next = self.synchroniser_delay.val();
            self.place_q.d.next = self.first_place.val();
        }

        self.clock_out.next = self.line.q.val();
        self.level.next = self.pin.level.val();
        self.takes.next = self.takes_bit.val();
        self.place.next = self.place_q.q.val();
        self.resting.next = self.at_rest.val();
        self.ended.next = self.ended_q.q.val();
        self.silent.next = self.silent_q.q.val();
        self.stuck.next = self.stuck_q.q.val();
        self.line_delay.next = self.line_delay_q.q.val();
    }
}
