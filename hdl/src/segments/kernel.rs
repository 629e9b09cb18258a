//! Ticks, states and flags of the command FIFO; memory and integrator are parts of it.
//!
//! ```text
//! phase 0            1 … 43          44               45 … 51
//!       tick taken   sums (passes)   outputs, decide  read the next entry's ticks and flags, if one is next
//! ```

use super::fifo::CommandFifo;
use super::integrator::Integrator;
use crate::prelude::*;
use posicast_blocks::segments::SegmentsState;

kernel! {
    pub(super) struct Segments;
    ports posicast_blocks::segments_ports;

    parts { fifo: CommandFifo, integrator: Integrator }
    registers {
        phase: Bits<6>,
        idle: Bit = true,
        state_q: Bits<2>, wants_flush: Bit, wants_quick_stop: Bit, wants_restart: Bit, wants_preset: Bit,
        enabled: Bit, point: Bit, cubic: Bit, first: Bit, extrapolates: Bit, late_q: Bits<8>, notifies: Bit, position_q: Signed<32>, velocity_q: Signed<32>,
        acceleration_q: Signed<32>, valid_q: Bit, notify_q: Bit, done_q: Bit, underrun_q: Bit, overflow_q: Bit,
        refused_q: Bit, malformed_q: Bit, tick_missed_q: Bit, out_of_range_q: Bit, rests_q: Bit, held_q: Bit,
    }
    wires {
        flush_now: Bit, quick_stop_now: Bit, restart_now: Bit, preset_now: Bit, takes_tick: Bit, moves: Bit,
        plays: Bit, held_now: Bit, stops: Bit, stopped: Bit, waiting: Bit, points: Bit, to_stop: Bit,
        reads: Bit, drops: Bit, ends: Bit, in_time: Bit,
    }
    constants {
        idle_phase: Bits<6> = from_u64(0),
        one_phase: Bits<6> = from_u64(1),
        hold_state: Bits<2> = from_u64(SegmentsState::Hold as u64),
        move_state: Bits<2> = from_u64(SegmentsState::Move as u64),
        stop_state: Bits<2> = from_u64(SegmentsState::Stop as u64),
        stopped_state: Bits<2> = from_u64(SegmentsState::Stopped as u64),
        no_level: Bits<7> = from_u64(0),
        one_late: Bits<8> = from_u64(1),
    }
    connect {
        integrator: takes_tick, modulo, points, preset_position, stop_deceleration;
        integrator from fifo: read_data;
        fifo from integrator: read_word;
        fifo: write, word, data;
    }
}

impl Logic for Segments {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module segments");
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
            comment!("Feed hold: at rest, nothing is played");
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

        comment!("The sums, and the entry that they use");
        self.held_q.d.next = self.held_now.val();
        self.plays.next = self.moves.val() & !self.held_now.val();
        self.points.next = self.plays.val() & self.point.q.val() & !self.extrapolates.q.val();
        self.integrator.phase.next = self.phase.q.val();
        self.integrator.preset.next = self.takes_tick.val() & self.preset_now.val();
        self.integrator.brakes.next =
            self.takes_tick.val() & !self.preset_now.val() & (self.stops.val() | self.to_stop.val());
        self.integrator.moves.next = self.plays.val();
        self.integrator.held.next = self.held_now.val();
        self.integrator.loads.next = self.points.val() | (self.plays.val() & self.cubic.q.val() & self.first.q.val());
        self.integrator.short_jerk.next = self.plays.val() & self.cubic.q.val() & !self.first.q.val();
        self.integrator.extrapolates.next = self.plays.val() & self.extrapolates.q.val();

        comment!("Outputs, and what the next tick does");
        self.reads.next = false;
        self.ends.next = self.integrator.entry_ends.val() | self.extrapolates.q.val();
        self.in_time.next = self.integrator.ticks_after.val() < self.extrapolation.val();
        if self.integrator.decides.val() {
            self.position_q.d.next = self.integrator.position.val();
            self.velocity_q.d.next = self.integrator.velocity.val();
            self.acceleration_q.d.next = self.integrator.acceleration.val();
            self.valid_q.d.next = true;
            self.rests_q.d.next = self.integrator.at_rest.val();
            if self.plays.val() {
                self.first.d.next = false;
                if self.integrator.overflowed.val() | self.integrator.leaves.val() {
                    if self.integrator.overflowed.val() {
                        self.overflow_q.d.next = true;
                    } else {
                        self.out_of_range_q.d.next = true;
                    }
                    self.state_q.d.next = self.stop_state.val();
                    self.drops.next = true;
                } else {
                    if self.ends.val() {
                        self.notify_q.d.next = self.notifies.q.val() & !self.extrapolates.q.val();
                        if self.waiting.val() {
                            self.reads.next = true;
                        } else {
                            if self.integrator.at_rest.val() {
                                self.state_q.d.next = self.hold_state.val();
                                self.done_q.d.next = true;
                            } else {
                                if self.in_time.val() {
                                    self.extrapolates.d.next = true;
                                    self.late_q.d.next = self.late_q.q.val() + self.one_late.val();
                                } else {
                                    self.underrun_q.d.next = true;
                                    self.state_q.d.next = self.stop_state.val();
                                    self.drops.next = true;
                                }
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
            if self.reads.val() {
                self.first.d.next = true;
                self.extrapolates.d.next = false;
            } else {
                self.phase.d.next = self.idle_phase.val();
                self.idle.d.next = true;
            }
        }

        comment!("The next entry: its ticks and flags");
        self.fifo.pop.next = self.reads.val();
        if self.integrator.reads_flags.val() {
            self.notifies.d.next = self.fifo.read_data.val().get_bit(30);
            self.point.d.next = self.fifo.read_data.val().get_bit(31);
            self.cubic.d.next = self.fifo.read_data.val().get_bit(29);
        }
        if self.integrator.ends.val() {
            self.phase.d.next = self.idle_phase.val();
            self.idle.d.next = true;
        }

        comment!("Words written by the host");
        self.fifo.closed.next = self.stops.val() | self.stopped.val();
        self.fifo.plays.next = self.moves.val();
        self.fifo.flush.next = self.drops.val();
        self.fifo.anew.next = self.takes_tick.val() & self.preset_now.val();

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
        self.late_ticks.next = self.late_q.q.val();
    }
}
