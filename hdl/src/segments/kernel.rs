//! Ticks, states and flags; the FIFO and the integrator do the rest.
//!
//! ```text
//! phase 0            1 … 43          44               45 … 51
//!       tick taken   sums (passes)   outputs, decide  read the next entry's ticks and flags, if one is next
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
    pub(super) modulo: Signal<In, Bit>,
    pub(super) feed_hold: Signal<In, Bit>,
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
    pub(super) out_of_range: Signal<Out, Bit>,
    pub(super) rests: Signal<Out, Bit>,
    pub(super) held: Signal<Out, Bit>,

    fifo: CommandFifo,
    integrator: Integrator,

    phase: Dff<Bits<6>>,
    idle: Dff<Bit>,
    state_q: Dff<Bits<2>>,
    wants_flush: Dff<Bit>,
    wants_quick_stop: Dff<Bit>,
    wants_restart: Dff<Bit>,
    wants_preset: Dff<Bit>,
    enabled: Dff<Bit>,
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
    out_of_range_q: Dff<Bit>,
    rests_q: Dff<Bit>,
    held_q: Dff<Bit>,

    flush_now: Signal<Local, Bit>,
    quick_stop_now: Signal<Local, Bit>,
    restart_now: Signal<Local, Bit>,
    preset_now: Signal<Local, Bit>,
    takes_tick: Signal<Local, Bit>,
    moves: Signal<Local, Bit>,
    plays: Signal<Local, Bit>,
    held_now: Signal<Local, Bit>,
    stops: Signal<Local, Bit>,
    stopped: Signal<Local, Bit>,
    waiting: Signal<Local, Bit>,
    points: Signal<Local, Bit>,
    to_stop: Signal<Local, Bit>,
    reads: Signal<Local, Bit>,
    drops: Signal<Local, Bit>,

    idle_phase: Constant<Bits<6>>,
    one_phase: Constant<Bits<6>>,
    hold_state: Constant<Bits<2>>,
    move_state: Constant<Bits<2>>,
    stop_state: Constant<Bits<2>>,
    stopped_state: Constant<Bits<2>>,
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
            modulo: Signal::default(),
            feed_hold: Signal::default(),
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
            out_of_range: Signal::default(),
            rests: Signal::default(),
            held: Signal::default(),
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
            out_of_range_q: Dff::default(),
            rests_q: Dff::default(),
            held_q: Dff::default(),
            flush_now: Signal::default(),
            quick_stop_now: Signal::default(),
            restart_now: Signal::default(),
            preset_now: Signal::default(),
            takes_tick: Signal::default(),
            moves: Signal::default(),
            plays: Signal::default(),
            held_now: Signal::default(),
            stops: Signal::default(),
            stopped: Signal::default(),
            waiting: Signal::default(),
            points: Signal::default(),
            to_stop: Signal::default(),
            reads: Signal::default(),
            drops: Signal::default(),
            idle_phase: Constant::new(from_u64(0)),
            one_phase: Constant::new(from_u64(1)),
            hold_state: Constant::new(from_u64(State::Hold as u64)),
            move_state: Constant::new(from_u64(State::Move as u64)),
            stop_state: Constant::new(from_u64(State::Stop as u64)),
            stopped_state: Constant::new(from_u64(State::Stopped as u64)),
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
            tick_missed_q,
            out_of_range_q,
            rests_q,
            held_q
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
            self.out_of_range_q.d.next = false;
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
        self.held_now.next = self.held_q.q.val();
        self.to_stop.next = self.moves.val() & (self.quick_stop_now.val() | !self.enable.val());
        if !self.idle.q.val() | self.tick.val() {
            self.phase.d.next = self.phase.q.val() + self.one_phase.val();
        }
        if !self.idle.q.val() & self.tick.val() {
            self.tick_missed_q.d.next = true;
        }
        if self.takes_tick.val() {
            self.idle.d.next = false;
            self.enabled.d.next = self.enable.val();
            self.wants_flush.d.next = false;
            self.wants_quick_stop.d.next = false;
            self.wants_restart.d.next = false;
            self.wants_preset.d.next = false;
            self.drops.next = self.flush_now.val();
            comment!("A feed hold: at rest, nothing is played");
            self.held_now.next = self.moves.val()
                & self.rests_q.q.val()
                & self.feed_hold.val()
                & !self.preset_now.val()
                & !self.to_stop.val();
            if self.preset_now.val() {
                self.state_q.d.next = self.hold_state.val();
                self.drops.next = true;
            } else {
                if self.to_stop.val() {
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

        comment!("The sums, and the entry that they take");
        self.held_q.d.next = self.held_now.val();
        self.plays.next = self.moves.val() & !self.held_now.val();
        self.points.next = self.plays.val() & self.point.q.val();
        self.integrator.phase.next = self.phase.q.val();
        self.integrator.takes_tick.next = self.takes_tick.val();
        self.integrator.preset.next = self.takes_tick.val() & self.preset_now.val();
        self.integrator.brakes.next =
            self.takes_tick.val() & !self.preset_now.val() & (self.stops.val() | self.to_stop.val());
        self.integrator.moves.next = self.plays.val();
        self.integrator.held.next = self.held_now.val();
        self.integrator.modulo.next = self.modulo.val();
        self.integrator.points.next = self.points.val();
        self.integrator.preset_position.next = self.preset_position.val();
        self.integrator.stop_deceleration.next = self.stop_deceleration.val();
        self.integrator.read_data.next = self.fifo.read_data.val();
        self.fifo.read_word.next = self.integrator.read_word.val();

        comment!("Outputs, and what the next tick does");
        self.reads.next = false;
        if self.integrator.decides.val() {
            self.position_q.d.next = self.integrator.position.val();
            self.velocity_q.d.next = self.integrator.velocity.val();
            self.acceleration_q.d.next = self.integrator.acceleration.val();
            self.valid_q.d.next = true;
            self.rests_q.d.next = self.integrator.at_rest.val();
            if self.plays.val() {
                if self.integrator.overflowed.val() | self.integrator.leaves.val() {
                    if self.integrator.overflowed.val() {
                        self.overflow_q.d.next = true;
                    } else {
                        self.out_of_range_q.d.next = true;
                    }
                    self.state_q.d.next = self.stop_state.val();
                    self.drops.next = true;
                } else {
                    if self.integrator.entry_ends.val() {
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
            if (self.state_q.q.val() == self.hold_state.val())
                & self.enabled.q.val()
                & self.enable.val()
                & self.waiting.val()
            {
                self.state_q.d.next = self.move_state.val();
                self.reads.next = true;
            }
            if !self.reads.val() {
                self.phase.d.next = self.idle_phase.val();
                self.idle.d.next = true;
            }
        }

        comment!("The next entry: its ticks and flags");
        self.fifo.pop.next = self.reads.val();
        if self.integrator.reads_flags.val() {
            self.notifies.d.next = self.fifo.read_data.val().get_bit(30);
            self.point.d.next = self.fifo.read_data.val().get_bit(31);
        }
        if self.integrator.ends.val() {
            self.phase.d.next = self.idle_phase.val();
            self.idle.d.next = true;
        }

        comment!("Words of a host");
        self.fifo.write.next = self.write.val();
        self.fifo.word.next = self.word.val();
        self.fifo.data.next = self.data.val();
        self.fifo.closed.next = self.stops.val() | self.stopped.val();
        self.fifo.plays.next = self.moves.val();
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
        self.out_of_range.next = self.out_of_range_q.q.val();
        self.rests.next = self.rests_q.q.val();
        self.held.next = self.held_q.q.val();
    }
}
