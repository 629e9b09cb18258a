//! The excitation: adds the signal to the reference, and controls its start and end.

use super::wave::Wave;
use crate::prelude::*;

kernel! {
    pub(super) struct Excitation;
    ports posicast_blocks::excitation_ports;

    parts { wave: Wave }
    registers {
        position_q: Signed<32>, velocity_q: Signed<32>, acceleration_q: Signed<32>, valid_q: Bit,
        value_q: Signed<17>, active: Bit, done: Bit, armed: Bit, ticks: Bits<24>,
    }
    wires {
        wide_position: Signed<33>, wide_value: Signed<33>, sum: Signed<33>, sum_bits: Bits<33>, beyond: Bit,
        bounded: Bits<16>, wanted: Bit, ended: Bit, starts: Bit, runs: Bit,
    }
    constants {
        prbs_kind: Bits<2> = from_u64(1),
        chirp_kind: Bits<2> = from_u64(2),
        largest: Signed<32> = from_i64(i64::from(i32::MAX)),
        smallest: Signed<32> = from_i64(i64::from(i32::MIN)),
        no_tick: Bits<24> = from_u64(0),
        one_tick: Bits<24> = from_u64(1),
    }
    connect {
        wave: valid, period_ticks, sweep;
    }
}

impl Logic for Excitation {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module excitation");

        comment!("The sum saturates at the ends of its word");
        self.wide_position.next = signed_bit_cast::<33, 32>(self.y_0.val());
        self.wide_value.next = signed_bit_cast::<33, 17>(self.wave.value.val());
        self.sum.next = self.wide_position.val() + self.wide_value.val();
        self.sum_bits.next = unsigned_cast(self.sum.val());
        self.beyond.next = !self.modulo.val() & (self.sum_bits.val().get_bit(32) ^ self.sum_bits.val().get_bit(31));
        self.valid_q.d.next = self.valid.val();
        if self.valid.val() {
            self.position_q.d.next = signed_bit_cast::<32, 33>(self.sum.val());
            if self.beyond.val() {
                self.position_q.d.next = self.largest.val();
                if self.sum_bits.val().get_bit(32) {
                    self.position_q.d.next = self.smallest.val();
                }
            }
            self.velocity_q.d.next = self.y_1.val();
            self.acceleration_q.d.next = self.y_2.val();
            self.value_q.d.next = self.wave.value.val();
        }

        comment!("Start at a tick, end, abort");
        self.wanted.next = self.enable.val() & self.allowed.val() & self.kind.val().any();
        self.ended.next = self.ticks.q.val() == self.duration_ticks.val();
        self.starts.next =
            self.valid.val() & self.wanted.val() & self.armed.q.val() & !self.active.q.val() & !self.ended.val();
        self.runs.next = self.active.q.val() & self.wanted.val() & !self.ended.val() & !self.wave.too_fast.val();
        self.active.d.next = self.starts.val() | self.runs.val();
        self.done.d.next = self.active.q.val() & self.wanted.val() & !self.runs.val();
        if self.starts.val() {
            self.armed.d.next = false;
        }
        if !self.enable.val() {
            self.armed.d.next = true;
        }
        if self.valid.val() {
            self.ticks.d.next = self.ticks.q.val() + self.one_tick.val();
        }
        if !self.runs.val() {
            self.ticks.d.next = self.no_tick.val();
        }

        comment!("The wave for the next tick");
        self.bounded.next = self.amplitude.val();
        if self.amplitude.val() > self.amplitude_limit.val() {
            self.bounded.next = self.amplitude_limit.val();
        }
        self.wave.run.next = self.runs.val();
        self.wave.start.next = self.starts.val();
        self.wave.chirp.next = self.kind.val() == self.chirp_kind.val();
        self.wave.prbs.next = self.kind.val() == self.prbs_kind.val();
        self.wave.amplitude.next = self.bounded.val();

        comment!("Outputs");
        self.position_reference.next = self.position_q.q.val();
        self.velocity_reference.next = self.velocity_q.q.val();
        self.acceleration_reference.next = self.acceleration_q.q.val();
        self.reference_valid.next = self.valid_q.q.val();
        self.excitation_value.next = signed_bit_cast::<32, 17>(self.value_q.q.val());
        self.excitation_active.next = self.active.q.val();
        self.excitation_done.next = self.done.q.val();
    }
}
