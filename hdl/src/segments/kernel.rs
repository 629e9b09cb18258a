//! Ticks, states and flags; the FIFO and the integrator do the rest.
//!
//! ```text
//! phase 0            1          2        3       4                 5 … 8
//!       tick taken   accelerate speed_up travel  outputs, decide   read an entry, if one is next
//! ```

use super::fifo::CommandFifo;
use super::integrator::Integrator;
use crate::prelude::*;
use posicast_model::rtl::segments::State;

#[derive(LogicBlock)]
pub(super) struct Segments {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) tick: Signal<In, Bit>,
    pub(super) enable: Signal<In, Bit>,
    pub(super) write: Signal<In, Bit>,
    pub(super) word: Signal<In, Bits<2>>,
    pub(super) data: Signal<In, Bits<32>>,
    pub(super) flush: Signal<In, Bit>,
    pub(super) quick_stop: Signal<In, Bit>,
    pub(super) restart: Signal<In, Bit>,
    pub(super) preset: Signal<In, Bit>,
    pub(super) preset_position: Signal<In, Signed<32>>,
    pub(super) stop_deceleration: Signal<In, Bits<31>>,
    pub(super) low_water: Signal<In, Bits<6>>,
    pub(super) clear_flags: Signal<In, Bit>,
    pub(super) position: Signal<Out, Signed<32>>,
    pub(super) velocity: Signal<Out, Signed<32>>,
    pub(super) acceleration: Signal<Out, Signed<32>>,
    pub(super) valid: Signal<Out, Bit>,
    pub(super) state: Signal<Out, Bits<2>>,
    pub(super) level: Signal<Out, Bits<7>>,
    pub(super) low: Signal<Out, Bit>,
    pub(super) empty: Signal<Out, Bit>,
    pub(super) notify: Signal<Out, Bit>,
    pub(super) done: Signal<Out, Bit>,
    pub(super) underrun: Signal<Out, Bit>,
    pub(super) overflow: Signal<Out, Bit>,
    pub(super) refused: Signal<Out, Bit>,
    pub(super) malformed: Signal<Out, Bit>,
    pub(super) tick_missed: Signal<Out, Bit>,

    fifo: CommandFifo,
    integrator: Integrator,

    phase: Dff<Bits<4>>,
    idle: Dff<Bit>,
    state_q: Dff<Bits<2>>,
    wants_flush: Dff<Bit>,
    wants_quick_stop: Dff<Bit>,
    wants_restart: Dff<Bit>,
    wants_preset: Dff<Bit>,
    enabled: Dff<Bit>,
    first: Dff<Bits<32>>,
    second: Dff<Bits<32>>,
    third: Dff<Bits<32>>,
    read_data: Dff<Bits<32>>,
    ticks_left: Dff<Bits<24>>,
    point: Dff<Bit>,
    notifies: Dff<Bit>,
    position_q: Dff<Signed<32>>,
    velocity_q: Dff<Signed<32>>,
    acceleration_q: Dff<Signed<32>>,
    valid_q: Dff<Bit>,
    notify_q: Dff<Bit>,
    done_q: Dff<Bit>,
    underrun_q: Dff<Bit>,
    overflow_q: Dff<Bit>,
    refused_q: Dff<Bit>,
    malformed_q: Dff<Bit>,
    tick_missed_q: Dff<Bit>,

    flush_now: Signal<Local, Bit>,
    quick_stop_now: Signal<Local, Bit>,
    restart_now: Signal<Local, Bit>,
    preset_now: Signal<Local, Bit>,
    takes_tick: Signal<Local, Bit>,
    moves: Signal<Local, Bit>,
    stops: Signal<Local, Bit>,
    stopped: Signal<Local, Bit>,
    waiting: Signal<Local, Bit>,
    ends: Signal<Local, Bit>,
    decides: Signal<Local, Bit>,
    reads: Signal<Local, Bit>,
    drops: Signal<Local, Bit>,

    idle_phase: Constant<Bits<4>>,
    accelerate_phase: Constant<Bits<4>>,
    speed_phase: Constant<Bits<4>>,
    travel_phase: Constant<Bits<4>>,
    decide_phase: Constant<Bits<4>>,
    last_word_phase: Constant<Bits<4>>,
    first_word_phase: Constant<Bits<4>>,
    second_word_phase: Constant<Bits<4>>,
    third_word_phase: Constant<Bits<4>>,
    one_phase: Constant<Bits<4>>,
    one_word: Constant<Bits<2>>,
    hold_state: Constant<Bits<2>>,
    move_state: Constant<Bits<2>>,
    stop_state: Constant<Bits<2>>,
    stopped_state: Constant<Bits<2>>,
    one_tick: Constant<Bits<24>>,
    no_level: Constant<Bits<7>>,
}

impl Default for Segments {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            tick: Signal::default(),
            enable: Signal::default(),
            write: Signal::default(),
            word: Signal::default(),
            data: Signal::default(),
            flush: Signal::default(),
            quick_stop: Signal::default(),
            restart: Signal::default(),
            preset: Signal::default(),
            preset_position: Signal::default(),
            stop_deceleration: Signal::default(),
            low_water: Signal::default(),
            clear_flags: Signal::default(),
            position: Signal::default(),
            velocity: Signal::default(),
            acceleration: Signal::default(),
            valid: Signal::default(),
            state: Signal::default(),
            level: Signal::default(),
            low: Signal::default(),
            empty: Signal::default(),
            notify: Signal::default(),
            done: Signal::default(),
            underrun: Signal::default(),
            overflow: Signal::default(),
            refused: Signal::default(),
            malformed: Signal::default(),
            tick_missed: Signal::default(),
            fifo: CommandFifo::default(),
            integrator: Integrator::default(),
            phase: Dff::default(),
            idle: Dff::new(true),
            state_q: Dff::default(),
            wants_flush: Dff::default(),
            wants_quick_stop: Dff::default(),
            wants_restart: Dff::default(),
            wants_preset: Dff::default(),
            enabled: Dff::default(),
            first: Dff::default(),
            second: Dff::default(),
            third: Dff::default(),
            read_data: Dff::default(),
            ticks_left: Dff::default(),
            point: Dff::default(),
            notifies: Dff::default(),
            position_q: Dff::default(),
            velocity_q: Dff::default(),
            acceleration_q: Dff::default(),
            valid_q: Dff::default(),
            notify_q: Dff::default(),
            done_q: Dff::default(),
            underrun_q: Dff::default(),
            overflow_q: Dff::default(),
            refused_q: Dff::default(),
            malformed_q: Dff::default(),
            tick_missed_q: Dff::default(),
            flush_now: Signal::default(),
            quick_stop_now: Signal::default(),
            restart_now: Signal::default(),
            preset_now: Signal::default(),
            takes_tick: Signal::default(),
            moves: Signal::default(),
            stops: Signal::default(),
            stopped: Signal::default(),
            waiting: Signal::default(),
            ends: Signal::default(),
            decides: Signal::default(),
            reads: Signal::default(),
            drops: Signal::default(),
            idle_phase: Constant::new(from_u64(0)),
            accelerate_phase: Constant::new(from_u64(1)),
            speed_phase: Constant::new(from_u64(2)),
            travel_phase: Constant::new(from_u64(3)),
            decide_phase: Constant::new(from_u64(4)),
            last_word_phase: Constant::new(from_u64(6)),
            first_word_phase: Constant::new(from_u64(7)),
            second_word_phase: Constant::new(from_u64(8)),
            third_word_phase: Constant::new(from_u64(9)),
            one_phase: Constant::new(from_u64(1)),
            one_word: Constant::new(from_u64(1)),
            hold_state: Constant::new(from_u64(State::Hold as u64)),
            move_state: Constant::new(from_u64(State::Move as u64)),
            stop_state: Constant::new(from_u64(State::Stop as u64)),
            stopped_state: Constant::new(from_u64(State::Stopped as u64)),
            one_tick: Constant::new(from_u64(1)),
            no_level: Constant::new(from_u64(0)),
        }
    }
}

impl Logic for Segments {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module segments");
        dff_setup!(
            self,
            clk,
            phase,
            idle,
            state_q,
            wants_flush,
            wants_quick_stop,
            wants_restart,
            wants_preset,
            enabled,
            first,
            second,
            third,
            read_data,
            ticks_left,
            point,
            notifies,
            position_q,
            velocity_q,
            acceleration_q,
            valid_q,
            notify_q,
            done_q,
            underrun_q,
            overflow_q,
            refused_q,
            malformed_q,
            tick_missed_q
        );
        self.fifo.clk.next = self.clk.val();
        self.fifo.rst.next = self.rst.val();
        self.integrator.clk.next = self.clk.val();
        self.integrator.rst.next = self.rst.val();
        self.moves.next = self.state_q.q.val() == self.move_state.val();
        self.stops.next = self.state_q.q.val() == self.stop_state.val();
        self.stopped.next = self.state_q.q.val() == self.stopped_state.val();
        self.waiting.next = self.fifo.level.val() != self.no_level.val();

        comment!("Pulses end; flags are cleared, then set");
        self.valid_q.d.next = false;
        self.notify_q.d.next = false;
        self.done_q.d.next = false;
        if self.clear_flags.val() {
            self.underrun_q.d.next = false;
            self.overflow_q.d.next = false;
            self.refused_q.d.next = false;
            self.malformed_q.d.next = false;
            self.tick_missed_q.d.next = false;
        }
        if self.fifo.refused.val() {
            self.refused_q.d.next = true;
        }
        if self.fifo.malformed.val() {
            self.malformed_q.d.next = true;
        }

        comment!("Requests wait for the tick");
        self.flush_now.next = self.flush.val() | self.wants_flush.q.val();
        self.quick_stop_now.next = self.quick_stop.val() | self.wants_quick_stop.q.val();
        self.restart_now.next = self.restart.val() | self.wants_restart.q.val();
        self.preset_now.next = self.preset.val() | self.wants_preset.q.val();
        self.wants_flush.d.next = self.flush_now.val();
        self.wants_quick_stop.d.next = self.quick_stop_now.val();
        self.wants_restart.d.next = self.restart_now.val();
        self.wants_preset.d.next = self.preset_now.val();

        comment!("A tick: preset, else quick stop, else restart");
        self.takes_tick.next = self.tick.val() & self.idle.q.val();
        self.drops.next = false;
        if !self.idle.q.val() {
            self.phase.d.next = self.phase.q.val() + self.one_phase.val();
            if self.tick.val() {
                self.tick_missed_q.d.next = true;
            }
        }
        if self.takes_tick.val() {
            self.phase.d.next = self.accelerate_phase.val();
            self.idle.d.next = false;
            self.enabled.d.next = self.enable.val();
            self.wants_flush.d.next = false;
            self.wants_quick_stop.d.next = false;
            self.wants_restart.d.next = false;
            self.wants_preset.d.next = false;
            self.drops.next = self.flush_now.val();
            if self.preset_now.val() {
                self.state_q.d.next = self.hold_state.val();
                self.drops.next = true;
            } else {
                if self.moves.val() & (self.quick_stop_now.val() | !self.enable.val()) {
                    self.state_q.d.next = self.stop_state.val();
                    self.drops.next = true;
                }
                if (self.state_q.q.val() == self.hold_state.val()) & self.quick_stop_now.val() {
                    self.state_q.d.next = self.stopped_state.val();
                    self.drops.next = true;
                }
                if self.stopped.val() & self.restart_now.val() & !self.quick_stop_now.val() {
                    self.state_q.d.next = self.hold_state.val();
                }
            }
        }

        comment!("Three sums");
        self.integrator.preset.next = self.takes_tick.val() & self.preset_now.val();
        self.integrator.preset_position.next = self.preset_position.val();
        self.integrator.accelerate.next = self.phase.q.val() == self.accelerate_phase.val();
        self.integrator.speed_up.next = self.phase.q.val() == self.speed_phase.val();
        self.integrator.travel.next = self.phase.q.val() == self.travel_phase.val();
        self.integrator.play.next = self.moves.val();
        self.integrator.stop.next = self.stops.val();
        self.integrator.point.next = self.point.q.val();
        self.integrator.first.next = self.first.q.val();
        self.integrator.second.next = self.second.q.val();
        self.integrator.third.next = self.third.q.val();
        self.integrator.stop_deceleration.next = self.stop_deceleration.val();

        comment!("Outputs, and what the next tick does");
        self.decides.next = self.phase.q.val() == self.decide_phase.val();
        self.ends.next = self.ticks_left.q.val() == self.one_tick.val();
        self.reads.next = false;
        if self.decides.val() {
            self.position_q.d.next = self.integrator.position.val();
            self.velocity_q.d.next = self.integrator.velocity.val();
            self.acceleration_q.d.next = self.integrator.acceleration.val();
            self.valid_q.d.next = true;
            if self.moves.val() {
                self.ticks_left.d.next = self.ticks_left.q.val() - self.one_tick.val();
                if self.integrator.overflowed.val() {
                    self.overflow_q.d.next = true;
                    self.state_q.d.next = self.stop_state.val();
                    self.drops.next = true;
                } else {
                    if self.ends.val() {
                        self.notify_q.d.next = self.notifies.q.val();
                        if self.waiting.val() {
                            self.reads.next = true;
                        } else {
                            if self.integrator.at_rest.val() {
                                self.state_q.d.next = self.hold_state.val();
                                self.done_q.d.next = true;
                            } else {
                                self.underrun_q.d.next = true;
                                self.state_q.d.next = self.stop_state.val();
                                self.drops.next = true;
                            }
                        }
                    }
                }
            }
            if self.stops.val() & self.integrator.at_rest.val() {
                self.state_q.d.next = self.stopped_state.val();
                self.done_q.d.next = true;
            }
            if (self.state_q.q.val() == self.hold_state.val()) & self.enabled.q.val() & self.waiting.val() {
                self.state_q.d.next = self.move_state.val();
                self.reads.next = true;
            }
            if !self.reads.val() {
                self.phase.d.next = self.idle_phase.val();
                self.idle.d.next = true;
            }
        }

        comment!("Read the next entry: words 3, 0, 1, 2");
        self.read_data.d.next = self.fifo.read_data.val();
        self.fifo.read_word.next = self.phase.q.val().get_bits::<2>(0) - self.one_word.val();
        if self.phase.q.val() == self.last_word_phase.val() {
            self.ticks_left.d.next = self.read_data.q.val().get_bits::<24>(0);
            self.notifies.d.next = self.read_data.q.val().get_bit(30);
            self.point.d.next = self.read_data.q.val().get_bit(31);
        }
        if self.phase.q.val() == self.first_word_phase.val() {
            self.first.d.next = self.read_data.q.val();
        }
        if self.phase.q.val() == self.second_word_phase.val() {
            self.second.d.next = self.read_data.q.val();
        }
        self.fifo.pop.next = self.phase.q.val() == self.third_word_phase.val();
        if self.phase.q.val() == self.third_word_phase.val() {
            self.third.d.next = self.read_data.q.val();
            self.phase.d.next = self.idle_phase.val();
            self.idle.d.next = true;
        }

        comment!("Words of a host");
        self.fifo.write.next = self.write.val();
        self.fifo.word.next = self.word.val();
        self.fifo.data.next = self.data.val();
        self.fifo.closed.next = self.stops.val() | self.stopped.val();
        self.fifo.flush.next = self.drops.val();

        comment!("Outputs");
        self.position.next = self.position_q.q.val();
        self.velocity.next = self.velocity_q.q.val();
        self.acceleration.next = self.acceleration_q.q.val();
        self.valid.next = self.valid_q.q.val();
        self.state.next = self.state_q.q.val();
        self.level.next = self.fifo.level.val();
        self.low.next = self.fifo.level.val() <= bit_cast::<7, 6>(self.low_water.val());
        self.empty.next = !self.waiting.val();
        self.notify.next = self.notify_q.q.val();
        self.done.next = self.done_q.q.val();
        self.underrun.next = self.underrun_q.q.val();
        self.overflow.next = self.overflow_q.q.val();
        self.refused.next = self.refused_q.q.val();
        self.malformed.next = self.malformed_q.q.val();
        self.tick_missed.next = self.tick_missed_q.q.val();
    }
}
