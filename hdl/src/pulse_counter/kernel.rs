//! Joins the parts of the pulse counter: lines, decoder, count, index latch and velocity.
//!
//! An edge at a pin appears in the count `filter_clocks` + 4 clocks later: 2 for the synchroniser, `filter_clocks` +
//! 1 for the filter, 1 for the count.

use super::decoder::Decoder;
use super::glitch_filter::GlitchFilter;
use super::line::Line;
use super::velocity::Velocity;
use crate::prelude::*;

kernel! {
    pub(super) struct PulseCounter;
    ports posicast_blocks::pulse_counter_ports;

    parts {
        line_a: Line,
        line_b: Line,
        line_z: Line,
        disagreement_filter: GlitchFilter,
        decoder: Decoder,
        speed: Velocity,
    }
    registers {
        priming: Bits<2>, ready_q: Bit, count_q: Signed<32>, origin_q: Signed<32>, presets: Bit,
        index_count_q: Signed<32>, index_before: Bit, index_seen_q: Bit, index_armed_q: Bit,
        illegal_low: Bits<4>, illegal_high: Bits<4>, disagreement_q: Bit,
    }
    wires {
        ready: Bit, first_half: Bits<2>, low_full: Bit, counts_illegal: Bit, gate: Bit, gated: Bit,
        index: Bit, change: Signed<32>, counted: Signed<32>, count_bits: Bits<32>,
    }
    constants {
        no_half: Bits<2> = from_u64(0),
        one_half: Bits<2> = from_u64(1),
        last_clock: Bits<2> = from_u64(2),
        no_count: Signed<32> = from_i64(0),
        count_up: Signed<32> = from_i64(1),
        count_down: Signed<32> = from_i64(-1),
        no_illegal: Bits<4> = from_u64(0),
        one_illegal: Bits<4> = from_u64(1),
    }
    connect {
        line_a, line_b, line_z: differential, ready, filter_clocks;
        disagreement_filter: ready, filter_clocks;
        decoder: swap, invert, ready, mode;
        speed from decoder: step, up;
        speed: tick, velocity_m, quotient_valid, clear_flags, time_stamp, smoothing, timeout, quotient;
        outputs from speed: steps, elapsed, velocity_pending, velocity, velocity_valid, velocity_missed;
    }
}

impl Logic for PulseCounter {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pulse_counter");

        comment!("After reset, levels are taken as they are for");
        comment!("four clocks: 00, 01, 11, 10");
        self.first_half.next = self.no_half.val();
        if !self.priming.q.val().get_bit(1) {
            self.first_half.next = self.one_half.val();
        }
        self.priming.d.next = (self.priming.q.val() << 1) | self.first_half.val();
        if self.priming.q.val() == self.last_clock.val() {
            self.ready_q.d.next = true;
        }
        self.ready.next = self.ready_q.q.val();

        comment!("Lines, all with the same delay");
        self.line_a.pin.next = self.a.val();
        self.line_a.complement.next = self.a_n.val();
        self.line_b.pin.next = self.b.val();
        self.line_b.complement.next = self.b_n.val();
        self.line_z.pin.next = self.z.val();
        self.line_z.complement.next = self.z_n.val();
        self.disagreement_filter.input_level.next =
            self.line_a.disagrees.val() | self.line_b.disagrees.val() | self.line_z.disagrees.val();

        comment!("Steps, and the count after them");
        self.decoder.level_a.next = self.line_a.level.val();
        self.decoder.level_b.next = self.line_b.level.val();
        self.change.next = self.no_count.val();
        if self.decoder.step.val() {
            self.change.next = self.count_down.val();
            if self.decoder.up.val() {
                self.change.next = self.count_up.val();
            }
        }
        self.counted.next = self.count_q.q.val() + self.change.val();
        self.count_q.d.next = self.counted.val();

        comment!("Flags; setting wins over clearing");
        if self.clear_flags.val() {
            self.disagreement_q.d.next = false;
        }
        if self.disagreement_filter.level.val() {
            self.disagreement_q.d.next = true;
        }

        comment!("Illegal transitions, in two halves: such a short");
        comment!("sum needs no carry chain");
        self.low_full.next = self.illegal_low.q.val().all();
        self.counts_illegal.next =
            self.decoder.illegal.val() & !(self.low_full.val() & self.illegal_high.q.val().all());
        if self.counts_illegal.val() {
            self.illegal_low.d.next = self.illegal_low.q.val() + self.one_illegal.val();
        }
        if self.counts_illegal.val() & self.low_full.val() {
            self.illegal_high.d.next = self.illegal_high.q.val() + self.one_illegal.val();
        }
        if self.clear_flags.val() {
            self.illegal_low.d.next = self.no_illegal.val();
            self.illegal_high.d.next = self.no_illegal.val();
            if self.decoder.illegal.val() {
                self.illegal_low.d.next = self.one_illegal.val();
            }
        }

        comment!("The index: a rising edge behind its gate");
        self.gate.next = self.ready.val();
        if self.index_gate.val().get_bit(0) & (self.line_a.level.val() != self.index_gate.val().get_bit(1)) {
            self.gate.next = false;
        }
        if self.index_gate.val().get_bit(2) & (self.line_b.level.val() != self.index_gate.val().get_bit(3)) {
            self.gate.next = false;
        }
        self.gated.next = self.gate.val() & self.line_z.level.val();
        self.index_before.d.next = self.gated.val();
        self.index.next =
            self.gated.val() & !self.index_before.q.val() & (self.index_armed_q.q.val() | self.index_always.val());
        self.index_seen_q.d.next = self.index.val();
        if self.index.val() {
            self.index_count_q.d.next = self.counted.val();
            self.index_armed_q.d.next = false;
        }
        if self.index_arm.val() {
            self.index_armed_q.d.next = true;
        }

        comment!("Presets move the origin, not the count; a clock");
        comment!("later the count includes the step of their clock");
        self.presets.d.next = self.preset.val() | (self.index.val() & self.index_presets.val());
        if self.presets.q.val() {
            self.origin_q.d.next = self.count_q.q.val() - self.preset_value.val();
        }

        self.count_bits.next = unsigned_cast(self.count_q.q.val());
        comment!("Velocity, of the count before the step");
        self.speed.count.next = self.count_bits.val().get_bits::<18>(0);

        comment!("Outputs");
        self.count.next = self.count_q.q.val();
        self.origin.next = self.origin_q.q.val();
        self.position.next = self.count_q.q.val() - self.origin_q.q.val();
        self.index_count.next = self.index_count_q.q.val();
        self.index_seen.next = self.index_seen_q.q.val();
        self.index_armed.next = self.index_armed_q.q.val();
        self.illegal_count.next =
            (bit_cast::<8, 4>(self.illegal_high.q.val()) << 4) | bit_cast::<8, 4>(self.illegal_low.q.val());
        self.illegal.next = self.illegal_low.q.val().any() | self.illegal_high.q.val().any();
        self.disagreement.next = self.disagreement_q.q.val();
        self.level_a.next = self.line_a.level.val();
        self.level_b.next = self.line_b.level.val();
        self.level_z.next = self.line_z.level.val();
    }
}
