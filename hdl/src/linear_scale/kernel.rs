//! Controls the bit-serial computation: requests, registers and references.

use super::serial_ratio::SerialRatio;
use crate::prelude::*;

kernel! {
    pub(super) struct LinearScale;
    ports posicast_blocks::linear_scale_ports;

    parts { serial: SerialRatio }
    registers {
        deviation_q: Bits<32>, valid_q: Bit, position_q: Bits<32>, velocity_q: Bits<32>, other: Bits<32>,
        operand_reference: Bits<32>, other_reference: Bits<32>, positions_wait: Bit, velocity_waits: Bit,
        runs: Bit, of_position: Bit, asked: Bit, aligning: Bit,
    }
    wires {
        takes_positions: Bit, takes_velocity: Bit, operand_position: Bits<32>, other_position: Bits<32>,
        ends_position: Bit, ends_velocity: Bit, positions_next: Bit, velocity_next: Bit, free: Bit,
        asked_now: Bit, silent: Bit, for_position: Bit, works_on_position: Bit, saturates: Bit,
        fills_deviation: Bit, low_deviation: Bit, deviation_filler: Bits<32>, fills_velocity: Bit,
        low_velocity: Bit, velocity_filler: Bits<32>, entering: Bits<32>, operand_entering: Bits<32>,
        other_entering: Bits<32>,
    }
    constants {
        nothing: Bits<32> = from_u64(0),
        largest: Bits<32> = from_u64(0x7fff_ffff),
        smallest: Bits<32> = from_u64(0x8000_0000),
    }
    connect {
        serial: use_scale, ratio_mantissa, ratio_shift;
    }
}

impl Logic for LinearScale {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module linear_scale");

        comment!("Counter of the loop, and counter to be multiplied");
        self.other_position.next = unsigned_cast(self.motor_position.val());
        self.operand_position.next = unsigned_cast(self.scale_position.val());
        if self.use_scale.val() {
            self.other_position.next = unsigned_cast(self.scale_position.val());
            self.operand_position.next = unsigned_cast(self.motor_position.val());
        }
        self.position_q.d.next = self.other_position.val();

        comment!("The computation; of the velocity only with use_scale");
        self.for_position.next = self.of_position.q.val() | !self.use_scale.val();
        self.serial.runs.next = self.runs.q.val();
        self.serial.of_position.next = self.for_position.val();
        self.serial.operand_bit.next = self.velocity_q.q.val().get_bit(0);
        if self.for_position.val() {
            self.serial.operand_bit.next = self.deviation_q.q.val().get_bit(0);
        }
        self.serial.operand_reference_bit.next = self.operand_reference.q.val().get_bit(0);
        self.serial.other_bit.next = self.other.q.val().get_bit(0);
        self.serial.other_reference_bit.next = self.other_reference.q.val().get_bit(0);
        self.works_on_position.next = self.runs.q.val() & self.for_position.val();
        self.ends_position.next = self.serial.last.val() & self.for_position.val();
        self.ends_velocity.next = self.serial.last.val() & !self.for_position.val();

        comment!("Waiting requests; positions come first");
        self.takes_positions.next = self.tick.val() & !self.positions_wait.q.val();
        self.takes_velocity.next = self.velocity_valid.val() & !(self.velocity_waits.q.val() & self.use_scale.val());
        self.positions_next.next =
            (self.positions_wait.q.val() & !self.ends_position.val()) | self.takes_positions.val();
        self.velocity_next.next = ((self.velocity_waits.q.val() & !self.ends_velocity.val())
            | self.takes_velocity.val())
            & self.use_scale.val();
        self.positions_wait.d.next = self.positions_next.val();
        self.velocity_waits.d.next = self.velocity_next.val();
        self.free.next = !self.runs.q.val() | self.serial.last.val();
        self.asked_now.next = self.asked.q.val() | self.align.val();
        self.asked.d.next = self.asked_now.val();
        if self.free.val() {
            self.runs.d.next = self.positions_next.val() | self.velocity_next.val();
            self.of_position.d.next = self.positions_next.val();
            if self.positions_next.val() {
                self.aligning.d.next = self.asked_now.val();
                self.asked.d.next = false;
            }
        }

        comment!("A result's bit enters at the top");
        self.entering.next = self.nothing.val();
        if self.serial.result_bit.val() {
            self.entering.next = self.smallest.val();
        }

        comment!("The deviation is loaded with the operand, shifted,");
        comment!("and clamped at the end; align makes it 0");
        self.silent.next = self.asked_now.val() | self.aligning.q.val();
        self.saturates.next = self.ends_position.val() & self.serial.overflows.val() & !self.silent.val();
        self.fills_deviation.next = self.saturates.val()
            | (self.ends_position.val() & self.silent.val())
            | (self.align.val() & !self.positions_wait.q.val() & !self.tick.val());
        self.low_deviation.next = self.takes_positions.val() | (self.saturates.val() & !self.serial.negative.val());
        self.deviation_filler.next = self.nothing.val();
        if self.saturates.val() {
            self.deviation_filler.next = self.smallest.val();
        }
        if self.low_deviation.val() {
            self.deviation_filler.next = self.largest.val();
        }
        if self.low_deviation.val()
            | self.fills_deviation.val()
            | (self.works_on_position.val() & self.serial.moves.val())
        {
            self.deviation_q.d.next = (self.deviation_q.q.val() >> 1) | self.entering.val();
            if self.low_deviation.val() {
                self.deviation_q.d.next = self.operand_position.val();
            }
            if self.fills_deviation.val() {
                self.deviation_q.d.next = self.deviation_filler.val();
            }
        }
        self.valid_q.d.next = self.ends_position.val();

        comment!("The velocity, in the same way");
        self.fills_velocity.next = self.ends_velocity.val() & self.serial.overflows.val();
        self.low_velocity.next = self.takes_velocity.val() | (self.fills_velocity.val() & !self.serial.negative.val());
        self.velocity_filler.next = self.smallest.val();
        if self.low_velocity.val() {
            self.velocity_filler.next = self.largest.val();
        }
        if self.low_velocity.val()
            | self.fills_velocity.val()
            | (self.runs.q.val() & !self.for_position.val() & self.serial.moves.val())
        {
            self.velocity_q.d.next = (self.velocity_q.q.val() >> 1) | self.entering.val();
            if self.low_velocity.val() {
                self.velocity_q.d.next = unsigned_cast(self.motor_velocity.val());
            }
            if self.fills_velocity.val() {
                self.velocity_q.d.next = self.velocity_filler.val();
            }
        }

        comment!("References rotate, or take the present position");
        self.operand_entering.next = self.operand_reference.q.val() << 31;
        self.other_entering.next = self.other_reference.q.val() << 31;
        if self.aligning.q.val() {
            self.operand_entering.next = self.deviation_q.q.val() << 31;
            self.other_entering.next = self.other.q.val() << 31;
        }
        if self.works_on_position.val() & self.serial.takes_operand.val() {
            self.operand_reference.d.next = (self.operand_reference.q.val() >> 1) | self.operand_entering.val();
        }
        if self.takes_positions.val() | (self.works_on_position.val() & self.serial.takes_other.val()) {
            self.other.d.next = self.other.q.val() >> 1;
            if self.takes_positions.val() {
                self.other.d.next = self.other_position.val();
            }
        }
        if self.works_on_position.val() & self.serial.takes_other.val() {
            self.other_reference.d.next = (self.other_reference.q.val() >> 1) | self.other_entering.val();
        }

        comment!("Outputs");
        self.deviation.next = signed_cast(self.deviation_q.q.val());
        self.deviation_valid.next = self.valid_q.q.val();
        self.position.next = signed_cast(self.position_q.q.val());
        self.velocity.next = signed_cast(self.velocity_q.q.val());
    }
}
