//! Lines to steps, steps to the count, the index latch, and the velocity: all that the pulse counter shows.
//!
//! An edge at a pin shows in the count `filter_clocks` + 4 clocks later: synchroniser 2, filter `filter_clocks` + 1, count 1.

use super::decoder::Decoder;
use super::glitch_filter::GlitchFilter;
use super::line::Line;
use super::velocity::Velocity;
use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct PulseCounter {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) a: Signal<In, Bit>,
    pub(super) b: Signal<In, Bit>,
    pub(super) z: Signal<In, Bit>,
    pub(super) a_n: Signal<In, Bit>,
    pub(super) b_n: Signal<In, Bit>,
    pub(super) z_n: Signal<In, Bit>,
    pub(super) differential: Signal<In, Bit>,
    pub(super) filter_clocks: Signal<In, Bits<6>>,
    pub(super) mode: Signal<In, Bits<3>>,
    pub(super) swap: Signal<In, Bit>,
    pub(super) invert: Signal<In, Bit>,
    pub(super) index_arm: Signal<In, Bit>,
    pub(super) index_always: Signal<In, Bit>,
    pub(super) index_presets: Signal<In, Bit>,
    pub(super) index_gate: Signal<In, Bits<4>>,
    pub(super) preset: Signal<In, Bit>,
    pub(super) preset_value: Signal<In, Signed<32>>,
    pub(super) clear_flags: Signal<In, Bit>,
    pub(super) tick: Signal<In, Bit>,
    pub(super) time_stamp: Signal<In, Bits<24>>,
    pub(super) velocity_m: Signal<In, Bit>,
    pub(super) smoothing: Signal<In, Bits<2>>,
    pub(super) timeout: Signal<In, Bits<8>>,
    pub(super) quotient_valid: Signal<In, Bit>,
    pub(super) quotient: Signal<In, Signed<32>>,
    pub(super) count: Signal<Out, Signed<32>>,
    pub(super) origin: Signal<Out, Signed<32>>,
    pub(super) position: Signal<Out, Signed<32>>,
    pub(super) index_count: Signal<Out, Signed<32>>,
    pub(super) index_seen: Signal<Out, Bit>,
    pub(super) index_armed: Signal<Out, Bit>,
    pub(super) illegal_count: Signal<Out, Bits<8>>,
    pub(super) illegal: Signal<Out, Bit>,
    pub(super) disagreement: Signal<Out, Bit>,
    pub(super) level_a: Signal<Out, Bit>,
    pub(super) level_b: Signal<Out, Bit>,
    pub(super) level_z: Signal<Out, Bit>,
    pub(super) steps: Signal<Out, Signed<18>>,
    pub(super) elapsed: Signal<Out, Bits<24>>,
    pub(super) velocity_pending: Signal<Out, Bit>,
    pub(super) velocity: Signal<Out, Signed<32>>,
    pub(super) velocity_valid: Signal<Out, Bit>,
    pub(super) velocity_missed: Signal<Out, Bit>,

    line_a: Line,
    line_b: Line,
    line_z: Line,
    disagreement_filter: GlitchFilter,
    decoder: Decoder,
    speed: Velocity,

    priming: Dff<Bits<2>>,
    ready_q: Dff<Bit>,
    count_q: Dff<Signed<32>>,
    origin_q: Dff<Signed<32>>,
    presets: Dff<Bit>,
    index_count_q: Dff<Signed<32>>,
    index_before: Dff<Bit>,
    index_seen_q: Dff<Bit>,
    index_armed_q: Dff<Bit>,
    illegal_low: Dff<Bits<4>>,
    illegal_high: Dff<Bits<4>>,
    disagreement_q: Dff<Bit>,

    ready: Signal<Local, Bit>,
    first_half: Signal<Local, Bits<2>>,
    low_full: Signal<Local, Bit>,
    counts_illegal: Signal<Local, Bit>,
    gate: Signal<Local, Bit>,
    gated: Signal<Local, Bit>,
    index: Signal<Local, Bit>,
    change: Signal<Local, Signed<32>>,
    counted: Signal<Local, Signed<32>>,
    count_bits: Signal<Local, Bits<32>>,

    no_half: Constant<Bits<2>>,
    one_half: Constant<Bits<2>>,
    last_clock: Constant<Bits<2>>,
    no_count: Constant<Signed<32>>,
    count_up: Constant<Signed<32>>,
    count_down: Constant<Signed<32>>,
    no_illegal: Constant<Bits<4>>,
    one_illegal: Constant<Bits<4>>,
}

impl Default for PulseCounter {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            a: Signal::default(),
            b: Signal::default(),
            z: Signal::default(),
            a_n: Signal::default(),
            b_n: Signal::default(),
            z_n: Signal::default(),
            differential: Signal::default(),
            filter_clocks: Signal::default(),
            mode: Signal::default(),
            swap: Signal::default(),
            invert: Signal::default(),
            index_arm: Signal::default(),
            index_always: Signal::default(),
            index_presets: Signal::default(),
            index_gate: Signal::default(),
            preset: Signal::default(),
            preset_value: Signal::default(),
            clear_flags: Signal::default(),
            tick: Signal::default(),
            time_stamp: Signal::default(),
            velocity_m: Signal::default(),
            smoothing: Signal::default(),
            timeout: Signal::default(),
            quotient_valid: Signal::default(),
            quotient: Signal::default(),
            count: Signal::default(),
            origin: Signal::default(),
            position: Signal::default(),
            index_count: Signal::default(),
            index_seen: Signal::default(),
            index_armed: Signal::default(),
            illegal_count: Signal::default(),
            illegal: Signal::default(),
            disagreement: Signal::default(),
            level_a: Signal::default(),
            level_b: Signal::default(),
            level_z: Signal::default(),
            steps: Signal::default(),
            elapsed: Signal::default(),
            velocity_pending: Signal::default(),
            velocity: Signal::default(),
            velocity_valid: Signal::default(),
            velocity_missed: Signal::default(),
            line_a: Line::default(),
            line_b: Line::default(),
            line_z: Line::default(),
            disagreement_filter: GlitchFilter::default(),
            decoder: Decoder::default(),
            speed: Velocity::default(),
            priming: Dff::default(),
            ready_q: Dff::default(),
            count_q: Dff::default(),
            origin_q: Dff::default(),
            presets: Dff::default(),
            index_count_q: Dff::default(),
            index_before: Dff::default(),
            index_seen_q: Dff::default(),
            index_armed_q: Dff::default(),
            illegal_low: Dff::default(),
            illegal_high: Dff::default(),
            disagreement_q: Dff::default(),
            ready: Signal::default(),
            first_half: Signal::default(),
            low_full: Signal::default(),
            counts_illegal: Signal::default(),
            gate: Signal::default(),
            gated: Signal::default(),
            index: Signal::default(),
            change: Signal::default(),
            counted: Signal::default(),
            count_bits: Signal::default(),
            no_half: Constant::new(from_u64(0)),
            one_half: Constant::new(from_u64(1)),
            last_clock: Constant::new(from_u64(2)),
            no_count: Constant::new(from_i64(0)),
            count_up: Constant::new(from_i64(1)),
            count_down: Constant::new(from_i64(-1)),
            no_illegal: Constant::new(from_u64(0)),
            one_illegal: Constant::new(from_u64(1)),
        }
    }
}

impl Logic for PulseCounter {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pulse_counter");
        dff_setup!(
            self,
            clk,
            priming,
            ready_q,
            count_q,
            origin_q,
            presets,
            index_count_q,
            index_before,
            index_seen_q,
            index_armed_q,
            illegal_low,
            illegal_high,
            disagreement_q
        );

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

        comment!("Lines, all delayed alike");
        self.line_a.clk.next = self.clk.val();
        self.line_a.rst.next = self.rst.val();
        self.line_a.pin.next = self.a.val();
        self.line_a.complement.next = self.a_n.val();
        self.line_a.differential.next = self.differential.val();
        self.line_a.ready.next = self.ready.val();
        self.line_a.filter_clocks.next = self.filter_clocks.val();
        self.line_b.clk.next = self.clk.val();
        self.line_b.rst.next = self.rst.val();
        self.line_b.pin.next = self.b.val();
        self.line_b.complement.next = self.b_n.val();
        self.line_b.differential.next = self.differential.val();
        self.line_b.ready.next = self.ready.val();
        self.line_b.filter_clocks.next = self.filter_clocks.val();
        self.line_z.clk.next = self.clk.val();
        self.line_z.rst.next = self.rst.val();
        self.line_z.pin.next = self.z.val();
        self.line_z.complement.next = self.z_n.val();
        self.line_z.differential.next = self.differential.val();
        self.line_z.ready.next = self.ready.val();
        self.line_z.filter_clocks.next = self.filter_clocks.val();
        self.disagreement_filter.clk.next = self.clk.val();
        self.disagreement_filter.rst.next = self.rst.val();
        self.disagreement_filter.input_level.next =
            self.line_a.disagrees.val() | self.line_b.disagrees.val() | self.line_z.disagrees.val();
        self.disagreement_filter.ready.next = self.ready.val();
        self.disagreement_filter.filter_clocks.next = self.filter_clocks.val();

        comment!("Steps, and the count after them");
        self.decoder.clk.next = self.clk.val();
        self.decoder.rst.next = self.rst.val();
        self.decoder.level_a.next = self.line_a.level.val();
        self.decoder.level_b.next = self.line_b.level.val();
        self.decoder.swap.next = self.swap.val();
        self.decoder.invert.next = self.invert.val();
        self.decoder.ready.next = self.ready.val();
        self.decoder.mode.next = self.mode.val();
        self.change.next = self.no_count.val();
        if self.decoder.step.val() {
            self.change.next = self.count_down.val();
            if self.decoder.up.val() {
                self.change.next = self.count_up.val();
            }
        }
        self.counted.next = self.count_q.q.val() + self.change.val();
        self.count_q.d.next = self.counted.val();

        comment!("Flags, set over clear");
        if self.clear_flags.val() {
            self.disagreement_q.d.next = false;
        }
        if self.disagreement_filter.level.val() {
            self.disagreement_q.d.next = true;
        }

        comment!("Illegal transitions, in two halves: so short a");
        comment!("sum takes no carry chain");
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
        comment!("later: the count has the step of their clock");
        self.presets.d.next = self.preset.val() | (self.index.val() & self.index_presets.val());
        if self.presets.q.val() {
            self.origin_q.d.next = self.count_q.q.val() - self.preset_value.val();
        }

        comment!("Velocity, of the count before the step");
        self.speed.clk.next = self.clk.val();
        self.speed.rst.next = self.rst.val();
        self.speed.step.next = self.decoder.step.val();
        self.speed.up.next = self.decoder.up.val();
        self.speed.tick.next = self.tick.val();
        self.speed.velocity_m.next = self.velocity_m.val();
        self.speed.quotient_valid.next = self.quotient_valid.val();
        self.speed.clear_flags.next = self.clear_flags.val();
        self.speed.time_stamp.next = self.time_stamp.val();
        self.speed.smoothing.next = self.smoothing.val();
        self.speed.timeout.next = self.timeout.val();
        self.speed.quotient.next = self.quotient.val();
        self.count_bits.next = unsigned_cast(self.count_q.q.val());
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
        self.steps.next = self.speed.steps.val();
        self.elapsed.next = self.speed.elapsed.val();
        self.velocity_pending.next = self.speed.velocity_pending.val();
        self.velocity.next = self.speed.velocity.val();
        self.velocity_valid.next = self.speed.velocity_valid.val();
        self.velocity_missed.next = self.speed.velocity_missed.val();
    }
}
