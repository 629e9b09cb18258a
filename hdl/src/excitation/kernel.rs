//! The sum, and when there is a signal.

use super::wave::Wave;
use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Excitation {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) valid: Signal<In, Bit>,
    pub(super) y_0: Signal<In, Signed<32>>,
    pub(super) y_1: Signal<In, Signed<32>>,
    pub(super) y_2: Signal<In, Signed<32>>,
    pub(super) enable: Signal<In, Bit>,
    pub(super) allowed: Signal<In, Bit>,
    pub(super) kind: Signal<In, Bits<2>>,
    pub(super) amplitude: Signal<In, Bits<16>>,
    pub(super) amplitude_limit: Signal<In, Bits<16>>,
    pub(super) period_ticks: Signal<In, Bits<16>>,
    pub(super) sweep: Signal<In, Bits<16>>,
    pub(super) duration_ticks: Signal<In, Bits<24>>,
    pub(super) modulo: Signal<In, Bit>,
    pub(super) position_reference: Signal<Out, Signed<32>>,
    pub(super) velocity_reference: Signal<Out, Signed<32>>,
    pub(super) acceleration_reference: Signal<Out, Signed<32>>,
    pub(super) reference_valid: Signal<Out, Bit>,
    pub(super) excitation_value: Signal<Out, Signed<32>>,
    pub(super) excitation_active: Signal<Out, Bit>,
    pub(super) excitation_done: Signal<Out, Bit>,

    wave: Wave,
    position_q: Dff<Signed<32>>,
    velocity_q: Dff<Signed<32>>,
    acceleration_q: Dff<Signed<32>>,
    valid_q: Dff<Bit>,
    value_q: Dff<Signed<17>>,
    active: Dff<Bit>,
    done: Dff<Bit>,
    armed: Dff<Bit>,
    ticks: Dff<Bits<24>>,

    wide_position: Signal<Local, Signed<33>>,
    wide_value: Signal<Local, Signed<33>>,
    sum: Signal<Local, Signed<33>>,
    sum_bits: Signal<Local, Bits<33>>,
    beyond: Signal<Local, Bit>,
    bounded: Signal<Local, Bits<16>>,
    wanted: Signal<Local, Bit>,
    ended: Signal<Local, Bit>,
    starts: Signal<Local, Bit>,
    runs: Signal<Local, Bit>,

    prbs_kind: Constant<Bits<2>>,
    chirp_kind: Constant<Bits<2>>,
    largest: Constant<Signed<32>>,
    smallest: Constant<Signed<32>>,
    no_tick: Constant<Bits<24>>,
    one_tick: Constant<Bits<24>>,
}

impl Default for Excitation {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            valid: Signal::default(),
            y_0: Signal::default(),
            y_1: Signal::default(),
            y_2: Signal::default(),
            enable: Signal::default(),
            allowed: Signal::default(),
            kind: Signal::default(),
            amplitude: Signal::default(),
            amplitude_limit: Signal::default(),
            period_ticks: Signal::default(),
            sweep: Signal::default(),
            duration_ticks: Signal::default(),
            modulo: Signal::default(),
            position_reference: Signal::default(),
            velocity_reference: Signal::default(),
            acceleration_reference: Signal::default(),
            reference_valid: Signal::default(),
            excitation_value: Signal::default(),
            excitation_active: Signal::default(),
            excitation_done: Signal::default(),
            wave: Wave::default(),
            position_q: Dff::default(),
            velocity_q: Dff::default(),
            acceleration_q: Dff::default(),
            valid_q: Dff::default(),
            value_q: Dff::default(),
            active: Dff::default(),
            done: Dff::default(),
            armed: Dff::default(),
            ticks: Dff::default(),
            wide_position: Signal::default(),
            wide_value: Signal::default(),
            sum: Signal::default(),
            sum_bits: Signal::default(),
            beyond: Signal::default(),
            bounded: Signal::default(),
            wanted: Signal::default(),
            ended: Signal::default(),
            starts: Signal::default(),
            runs: Signal::default(),
            prbs_kind: Constant::new(from_u64(1)),
            chirp_kind: Constant::new(from_u64(2)),
            largest: Constant::new(from_i64(i64::from(i32::MAX))),
            smallest: Constant::new(from_i64(i64::from(i32::MIN))),
            no_tick: Constant::new(from_u64(0)),
            one_tick: Constant::new(from_u64(1)),
        }
    }
}

impl Logic for Excitation {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module excitation");
        dff_setup!(
            self,
            clk,
            position_q,
            velocity_q,
            acceleration_q,
            valid_q,
            value_q,
            active,
            done,
            armed,
            ticks
        );

        comment!("The sum stays at the ends of its word");
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
        self.wave.clk.next = self.clk.val();
        self.wave.rst.next = self.rst.val();
        self.wave.run.next = self.runs.val();
        self.wave.start.next = self.starts.val();
        self.wave.valid.next = self.valid.val();
        self.wave.chirp.next = self.kind.val() == self.chirp_kind.val();
        self.wave.prbs.next = self.kind.val() == self.prbs_kind.val();
        self.wave.amplitude.next = self.bounded.val();
        self.wave.period_ticks.next = self.period_ticks.val();
        self.wave.sweep.next = self.sweep.val();

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
