//! The absolute encoder: judges the readings, and turns their positions into the count.

use super::line::{AbsoluteLine, used};
use super::word::AbsoluteWord;
use crate::prelude::*;
use posicast_blocks::absolute_encoder::AbsoluteEncoderConfig;

kernel! {
    pub(super) struct AbsoluteEncoder(config: &AbsoluteEncoderConfig);
    ports posicast_blocks::absolute_encoder_ports;

    parts { line: AbsoluteLine = AbsoluteLine::new(config), word: AbsoluteWord = AbsoluteWord::new(config) }
    registers {
        differs: Bit, decides: Bit, failed: Bit, good: Bit, difference: Bits<40>, position: Bits<40>, count_q: Bits<32>,
        change: Bits<32>, missed: Bits<8>, allowed: Bits<32> = from_u64(config.limits().largest_jump), known_q: Bit,
        valid_q: Bit, extrapolated_q: Bit, lost_q: Bit, check_failed_q: Bit, silent_q: Bit, stuck_q: Bit, error_bit_q: Bit,
        warning_bit_q: Bit, jumped_q: Bit, overrun_q: Bit,
    }
    wires {
        is_busy: Bit, starts: Bit, whole: Bit, right: Bit, apart: Bits<40>, magnitude: Bits<40>, most: Bits<40>,
        is_below: Bit, exceeds: Bit, jumps: Bit, next_position: Bits<40>, accepts: Bit, refuses: Bit, loses: Bit,
        first_miss: Bit, last_miss: Bit,
    }
    constants {
        used_position: Bits<40> = from_u64((1 << config.frame().position_bits) - 1),
        unused_position: Bits<40> = from_u64(ALL_BITS ^ ((1 << config.frame().position_bits) - 1)),
        position_sign: Bits<40> = from_u64(1 << (config.frame().position_bits - 1)),
        largest_jump: Bits<32> = from_u64(config.limits().largest_jump),
        used_allowed: Bits<32> = from_u64(used(config.limits().largest_jump * (config.limits().tolerated + 1))),
        tolerated: Bits<8> = from_u64(config.limits().tolerated),
        used_missed: Bits<8> = from_u64(used(config.limits().tolerated)),
        no_misses: Bits<8> = from_u64(0),
        one_miss: Bits<8> = from_u64(1),
        no_change: Bits<32> = from_u64(0),
    }
    connect {
        line: data, starts;
        word: starts;
        word from line: takes, level, place;
        outputs from line: clock_out, line_delay;
    }
}

const ALL_BITS: u64 = (1 << 40) - 1;

impl Logic for AbsoluteEncoder {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module absolute_encoder");
        self.is_busy.next =
            !self.line.resting.val() | self.line.ended.val() | self.differs.q.val() | self.decides.q.val();
        self.starts.next = self.tick.val() & !self.is_busy.val();
        if self.clear_flags.val() {
            self.check_failed_q.d.next = false;
            self.silent_q.d.next = false;
            self.stuck_q.d.next = false;
            self.error_bit_q.d.next = false;
            self.warning_bit_q.d.next = false;
            self.jumped_q.d.next = false;
            self.overrun_q.d.next = false;
            self.lost_q.d.next = false;
        }
        if self.tick.val() & self.is_busy.val() {
            self.overrun_q.d.next = true;
        }

        comment!("First clock: the frame, and its difference to the last good position");
        self.whole.next = self.line.ended.val() & !self.line.silent.val() & !self.line.stuck.val();
        self.right.next = self.whole.val() & !self.word.wrong.val();
        if self.line.silent.val() {
            self.silent_q.d.next = true;
        }
        if self.line.stuck.val() {
            self.stuck_q.d.next = true;
        }
        if self.whole.val() & self.word.wrong.val() {
            self.check_failed_q.d.next = true;
        }
        if self.right.val() & self.word.error.val() {
            self.error_bit_q.d.next = true;
        }
        if self.right.val() & self.word.warning.val() {
            self.warning_bit_q.d.next = true;
        }
        self.differs.d.next = self.line.ended.val();
        self.failed.d.next = !self.right.val() | self.word.error.val();
        self.apart.next = (self.word.position.val() - self.position.q.val()) & self.used_position.val();
        self.difference.d.next = self.apart.val();
        if (self.apart.val() & self.position_sign.val()).any() {
            self.difference.d.next = self.apart.val() | self.unused_position.val();
        }

        comment!("Second clock: the limit. A negative difference is inverted, which is one less than its size");
        self.is_below.next = self.difference.q.val().get_bit(39);
        self.magnitude.next = self.difference.q.val();
        if self.is_below.val() {
            self.magnitude.next = !self.difference.q.val();
        }
        self.most.next = bit_cast::<40, 32>(self.allowed.q.val());
        self.exceeds.next = (self.magnitude.val() > self.most.val())
            | (self.is_below.val() & (self.magnitude.val() == self.most.val()));
        self.jumps.next = self.known_q.q.val() & self.exceeds.val();
        self.decides.d.next = self.differs.q.val();
        self.good.d.next = !self.failed.q.val() & !self.jumps.val();
        if self.differs.q.val() & !self.failed.q.val() & self.jumps.val() {
            self.jumped_q.d.next = true;
        }

        comment!("Third clock: the count");
        self.accepts.next = self.decides.q.val() & self.good.q.val() & !self.lost_q.q.val();
        self.refuses.next = self.decides.q.val() & !self.good.q.val() & !self.lost_q.q.val();
        self.first_miss.next = self.missed.q.val() == self.no_misses.val();
        self.last_miss.next = self.missed.q.val() == self.tolerated.val();
        self.loses.next = self.refuses.val() & self.last_miss.val();
        self.next_position.next = self.word.position.val();
        if self.known_q.q.val() {
            self.next_position.next = self.position.q.val() + self.difference.q.val();
        }
        self.valid_q.d.next = self.accepts.val() | (self.refuses.val() & !self.last_miss.val() & self.known_q.q.val());
        if self.refuses.val() & !self.last_miss.val() {
            self.missed.d.next = (self.missed.q.val() + self.one_miss.val()) & self.used_missed.val();
            self.allowed.d.next = (self.allowed.q.val() + self.largest_jump.val()) & self.used_allowed.val();
        }
        if self.refuses.val() & !self.last_miss.val() & self.known_q.q.val() {
            self.count_q.d.next = self.count_q.q.val() + self.change.q.val();
            self.extrapolated_q.d.next = true;
        }
        if self.accepts.val() {
            self.position.d.next = self.next_position.val();
            self.count_q.d.next = bit_cast::<32, 40>(self.next_position.val());
            self.extrapolated_q.d.next = false;
            self.known_q.d.next = true;
        }
        if self.accepts.val() & self.known_q.q.val() & self.first_miss.val() {
            self.change.d.next = bit_cast::<32, 40>(self.difference.q.val());
        }
        if self.accepts.val() & !self.known_q.q.val() {
            self.change.d.next = self.no_change.val();
        }
        if self.accepts.val() | (self.lost_q.q.val() & self.clear_flags.val()) {
            self.missed.d.next = self.no_misses.val();
            self.allowed.d.next = self.largest_jump.val();
        }
        if self.loses.val() {
            self.lost_q.d.next = true;
            self.known_q.d.next = false;
        }

        self.count.next = signed_cast(self.count_q.q.val());
        self.valid.next = self.valid_q.q.val();
        self.known.next = self.known_q.q.val();
        self.extrapolated.next = self.extrapolated_q.q.val();
        self.busy.next = self.is_busy.val();
        self.lost.next = self.lost_q.q.val();
        self.check_failed.next = self.check_failed_q.q.val();
        self.silent.next = self.silent_q.q.val();
        self.stuck.next = self.stuck_q.q.val();
        self.error_bit.next = self.error_bit_q.q.val();
        self.warning_bit.next = self.warning_bit_q.q.val();
        self.jumped.next = self.jumped_q.q.val();
        self.overrun.next = self.overrun_q.q.val();
    }
}
