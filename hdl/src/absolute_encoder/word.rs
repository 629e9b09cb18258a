//! The frame of a reading, bit by bit: position from Gray or binary code, status bits, parity and CRC.

use crate::prelude::*;
use posicast_blocks::absolute_encoder::{AbsoluteEncoderConfig, FrameCheck, FrameStatusBit};

kernel! {
    pub(super) struct AbsoluteWord(config: &AbsoluteEncoderConfig);

    inputs { rst: Bit, starts: Bit, takes: Bit, level: Bit, place: Bits<7> }
    outputs { position: Bits<40>, wrong: Bit, error: Bit, warning: Bit }
    registers { position_q: Bits<40>, crc: Bits<6>, odd: Bit, error_q: Bit, warning_q: Bit }
    wires { taken_bit: Bits<40>, is_position: Bit, is_check: Bit, feedback: Bit, term: Bits<6> }
    constants {
        gray: Bit = config.frame().gray,
        used_position: Bits<40> = from_u64((1 << config.frame().position_bits) - 1),
        position_bits: Bits<7> = from_u64(config.frame().position_bits.into()),
        check_place: Bits<7> = from_u64(u64::from(config.frame().position_bits + config.frame().trailing_bits)),
        error_place: Bits<7> = from_u64(status_place(config, config.frame().error)),
        error_low: Bit = config.frame().error.is_some_and(|bit| bit.active_low),
        warning_place: Bits<7> = from_u64(status_place(config, config.frame().warning)),
        warning_low: Bit = config.frame().warning.is_some_and(|bit| bit.active_low),
        even_parity: Bit = config.frame().check == FrameCheck::EvenParity,
        odd_parity: Bit = config.frame().check == FrameCheck::OddParity,
        crc6: Bit = config.frame().check == FrameCheck::Crc6,
        zero: Bits<40> = from_u64(0),
        one: Bits<40> = from_u64(1),
        no_term: Bits<6> = from_u64(0),
        polynomial: Bits<6> = from_u64(3),
    }
}

/// Place of a status bit in the frame; without it, a place that no frame has.
fn status_place(config: &AbsoluteEncoderConfig, bit: Option<FrameStatusBit>) -> u64 {
    const NO_PLACE: u64 = 63;
    bit.map_or(NO_PLACE, |bit| u64::from(config.frame().position_bits + bit.place))
}

impl Logic for AbsoluteWord {
    #[hdl_gen]
    fn update(&mut self) {
        comment!(
            "@module absolute_word_${value position_bits}x${value check_place}_${value gray}${value even_parity}${value odd_parity}${value crc6}_${value error_place}x${value error_low}_${value warning_place}x${value warning_low}"
        );
        comment!("Places before the position are the largest numbers");
        self.is_position.next = self.place.val() < self.position_bits.val();
        self.is_check.next = !self.place.val().get_bit(6) & (self.place.val() >= self.check_place.val());
        self.taken_bit.next = self.zero.val();
        if self.level.val() ^ (self.gray.val() & self.position_q.q.val().get_bit(0)) {
            self.taken_bit.next = self.one.val();
        }

        comment!("x^6 + x + 1; the CRC is sent inverted");
        self.feedback.next = self.crc.q.val().get_bit(5) ^ self.level.val() ^ self.is_check.val();
        self.term.next = self.no_term.val();
        if self.feedback.val() {
            self.term.next = self.polynomial.val();
        }
        if self.takes.val() {
            self.crc.d.next = (self.crc.q.val() << 1) ^ self.term.val();
            self.odd.d.next = self.odd.q.val() ^ self.level.val();
        }
        if self.takes.val() & self.is_position.val() {
            self.position_q.d.next = ((self.position_q.q.val() << 1) | self.taken_bit.val()) & self.used_position.val();
        }
        if self.takes.val() & (self.place.val() == self.error_place.val()) {
            self.error_q.d.next = self.level.val() ^ self.error_low.val();
        }
        if self.takes.val() & (self.place.val() == self.warning_place.val()) {
            self.warning_q.d.next = self.level.val() ^ self.warning_low.val();
        }
        if self.starts.val() {
            self.position_q.d.next = self.zero.val();
            self.crc.d.next = self.no_term.val();
            self.odd.d.next = false;
            self.error_q.d.next = false;
            self.warning_q.d.next = false;
        }

        self.position.next = self.position_q.q.val();
        self.wrong.next = (self.even_parity.val() & self.odd.q.val())
            | (self.odd_parity.val() & !self.odd.q.val())
            | (self.crc6.val() & self.crc.q.val().any());
        self.error.next = self.error_q.q.val();
        self.warning.next = self.warning_q.q.val();
    }
}
